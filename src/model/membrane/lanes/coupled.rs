//! The coupled law in lanes of four f32: the same tables as in f64, read four triangles at a time.
//!
//! With g the metric of a triangle's two edges and G that of the same edges at rest, I₁ = G⁻¹ : g,
//! s = √(det g / det G), t = √(I₁ + 2s) are all that is needed: no principal directions. The second
//! Piola–Kirchhoff tension is M = P·G⁻¹ + Q·adj(g)/det G with P = α + β/t, Q = β/(t s),
//! α = Σ sec/(1+ν), β = Σ sec·(ν(t−1) − 1)/(1−ν²), sec = h·Ef(ē)/ē.

use crate::mesh::vec3::{Block, Vec3, add, add_outer, scale};
use crate::springs::coupled::CoupledLaw;
use wide::f32x4;

/// Squared relative area below which a triangle counts as this much \[-\].
pub(super) const LEAST_AREA: f32 = 1e-10;

/// Energy of a quarter of a cell's square: the weight of a regular triangle, already in the tables.
const TRIANGLE_SHARE: f64 = 0.25;
/// Share of the tangential stiffness that the stiffness across the sheet is kept above.
const LEAST_NORMAL_STIFFNESS: f32 = 1e-4;
/// The same for the part of the tension that acts in all directions.
const LEAST_TENSION: f32 = 0.1;

/// The law, scaled so that its stiffness at small strain is 1.
#[derive(Clone, Debug, Default)]
pub(crate) struct CoupledLanes {
    groups: Vec<LaneGroup>,
}

/// Layers of one Poisson ratio; numbers as four equal lanes.
#[derive(Clone, Debug)]
pub(super) struct LaneGroup {
    /// `a + b·ē + c·max(ē − k, 0)` each; a power of two of them.
    buckets: Vec<[f32; 4]>,
    buckets_per_unit: f32x4,
    last_bucket: f32x4,
    end: f32x4,
    line_slope: f32x4,
    line_offset: f32x4,
    nu: f32x4,
    one_minus_nu: f32x4,
    /// 1/(1 − ν²).
    plane: f32x4,
    /// 1/(1 + ν).
    shear: f32x4,
}

/// What the second derivative of a triangle's energy needs; see [`CoupledLanes::stiffness`].
pub(super) struct LaneStiffness {
    /// Isotropic part P ≥ 0.
    pub(super) p: f32x4,
    /// β/t.
    pub(super) beta_t: f32x4,
    pub(super) t: f32x4,
    /// Least P + (β/t)·… across the sheet.
    pub(super) least_normal: f32x4,
    pub(super) vv: f32x4,
    pub(super) v_tau: f32x4,
    pub(super) tau_tau: f32x4,
}

impl CoupledLanes {
    /// The lanes of a law whose stiffness at small strain is `stiffness` \[kPa·mm\].
    pub(super) fn new(law: &CoupledLaw, stiffness: f64) -> Self {
        let scale = TRIANGLE_SHARE / stiffness;
        let groups = law
            .tables()
            .map(|table| {
                let scaled = |&[a, b, c, k]: &[f64; 4]| {
                    [(a * scale) as f32, (b * scale) as f32, (c * scale) as f32, k as f32]
                };
                let splat = |value: f64| f32x4::splat(value as f32);
                let (secant, nu) = (&table.secant, table.poisson_ratio);
                LaneGroup {
                    buckets: secant.buckets().iter().map(scaled).collect(),
                    buckets_per_unit: splat(secant.buckets_per_unit()),
                    last_bucket: splat((secant.buckets().len() - 1) as f64),
                    end: splat(secant.end()),
                    line_slope: splat(table.line_slope * scale),
                    line_offset: splat(table.line_offset * scale),
                    nu: splat(nu),
                    one_minus_nu: splat(1.0 - nu),
                    plane: splat(1.0 / (1.0 - nu * nu)),
                    shear: splat(1.0 / (1.0 + nu)),
                }
            })
            .collect();
        Self { groups }
    }

    /// Layers by their Poisson ratio: most sheets have one, which has a [`Law`] of its own.
    pub(super) fn groups(&self) -> &[LaneGroup] {
        &self.groups
    }

    /// The coefficients of the second derivative of the energy by one node,
    /// P(mᵀG⁻¹m) I + (β/t)(mᵀadj(g)m)/(s det G) nnᵀ + c_vv vvᵀ + c_vτ (vτᵀ + τvᵀ) + c_ττ ττᵀ,
    /// with v = −½∂I₁/∂x and τ = −∂t/∂x. Negative tension is left out.
    #[inline(always)]
    pub(super) fn stiffness(&self, i1: f32x4, s: f32x4) -> LaneStiffness {
        let t = (i1 + s + s).sqrt();
        let (mut alpha, mut beta) = (f32x4::ZERO, f32x4::ZERO);
        let (mut vv, mut v_tau, mut tau_tau) = (f32x4::ZERO, f32x4::ZERO, f32x4::ZERO);
        for group in &self.groups {
            let equivalent = group.equivalent_strain(i1, t);
            let (secant, slope) = group.secant_and_slope(equivalent);
            let b = ((t - 1.0) * group.nu - 1.0) * group.plane;
            alpha += secant * group.shear;
            beta += secant * b;
            // sec′/ē, kept finite at rest, where the vectors that it multiplies vanish.
            let bend = slope * equivalent / (equivalent * equivalent + 1e-6);
            vv += bend * (group.shear * group.shear);
            v_tau += bend * b * group.shear;
            tau_tau += bend * b * b + secant * (group.nu * group.plane);
        }
        let beta_t = beta / t;
        LaneStiffness {
            p: (alpha + beta_t).fast_max(alpha * LEAST_TENSION),
            beta_t,
            t,
            least_normal: alpha * LEAST_NORMAL_STIFFNESS,
            vv,
            v_tau,
            tau_tau: tau_tau - beta_t,
        }
    }
}

/// How four triangles answer to their stretch.
pub(super) trait Law {
    /// P and Q of triangles with the invariants I₁, s > 0 and t.
    fn tension(&self, i1: f32x4, s: f32x4, t: f32x4) -> (f32x4, f32x4);
}

impl Law for LaneGroup {
    #[inline(always)]
    fn tension(&self, i1: f32x4, s: f32x4, t: f32x4) -> (f32x4, f32x4) {
        let inverse = f32x4::ONE / (t * s);
        let secant = self.secant(self.equivalent_strain(i1, t));
        let beta = secant * (((t - 1.0) * self.nu - 1.0) * self.plane) * inverse;
        (secant * self.shear + beta * s, beta)
    }
}

impl Law for [LaneGroup] {
    #[inline(always)]
    fn tension(&self, i1: f32x4, s: f32x4, t: f32x4) -> (f32x4, f32x4) {
        let (mut p, mut q) = (f32x4::ZERO, f32x4::ZERO);
        for group in self {
            let (one, two) = group.tension(i1, s, t);
            p += one;
            q += two;
        }
        (p, q)
    }
}

impl LaneGroup {
    #[inline(always)]
    fn equivalent_strain(&self, i1: f32x4, t: f32x4) -> f32x4 {
        let over = t - 2.0;
        let squares = (i1 - over - over - 2.0).fast_max(f32x4::ZERO);
        ((squares * self.one_minus_nu + over * over * self.nu) * self.plane).sqrt()
    }

    #[inline(always)]
    fn bucket(&self, equivalent: f32x4) -> [f32x4; 4] {
        let place = (equivalent * self.buckets_per_unit).fast_min(self.last_bucket);
        // What is not a number may become any place: the mask keeps it in the table.
        let mask = self.buckets.len() - 1;
        let places = place.fast_trunc_int().to_array();
        f32x4::transpose(places.map(|k| f32x4::new(self.buckets[k as usize & mask])))
    }

    #[inline(always)]
    fn secant(&self, equivalent: f32x4) -> f32x4 {
        let [a, b, c, k] = self.bucket(equivalent);
        let inside = a + b * equivalent + c * (equivalent - k).fast_max(f32x4::ZERO);
        let beyond = equivalent.simd_gt(self.end);
        if beyond.any() {
            let line = self.line_offset / equivalent + self.line_slope;
            return beyond.bitselect(line, inside);
        }
        inside
    }

    #[inline(always)]
    fn secant_and_slope(&self, equivalent: f32x4) -> (f32x4, f32x4) {
        let [a, b, c, k] = self.bucket(equivalent);
        let over = equivalent - k;
        let inside = a + b * equivalent + c * over.fast_max(f32x4::ZERO);
        let slope = b + over.simd_gt(f32x4::ZERO).bitselect(c, f32x4::ZERO);
        let beyond = equivalent.simd_gt(self.end);
        let share = self.line_offset / equivalent;
        (
            beyond.bitselect(share + self.line_slope, inside),
            beyond.bitselect(-share / equivalent, slope),
        )
    }
}

/// Adds c_vv vvᵀ + c_vτ (vτᵀ + τvᵀ) + c_ττ ττᵀ.
#[inline(always)]
pub(super) fn add_stretch(block: &mut Block, k: &LaneStiffness, v: Vec3, tau: Vec3) {
    // (c_vv v + c_vτ τ) vᵀ + (c_vτ v + c_ττ τ) τᵀ
    add_outer(block, add(scale(v, k.vv), scale(tau, k.v_tau)), v);
    add_outer(block, add(scale(v, k.v_tau), scale(tau, k.tau_tau)), tau);
}

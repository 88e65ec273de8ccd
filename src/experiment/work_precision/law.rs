//! The coupled law of the baselines: forces in lanes of four f32, nodal stiffness in f64.
//!
//! Both are closed forms in the metric C of a triangle, without principal directions; see
//! [`CoupledLaw::second_piola_kirchhoff`]. Tensions are relative to the sheet's stiffness at small
//! strain.

use crate::springs::coupled::CoupledLaw;
use crate::springs::table::Table;
use glam::{DVec2, DVec3};
use wide::f32x4;

/// Lower bound of the squared relative area of a triangle \[-\].
const MIN_SQUARED_AREA: f32 = 1e-10;
/// Lower bound of the stiffness normal to the sheet \[fraction of the in-plane stiffness\].
const MIN_NORMAL_STIFFNESS: f64 = 1e-4;
/// Lower bound of the isotropic part of the tension \[fraction of the in-plane stiffness\].
const MIN_TENSION: f64 = 0.1;

/// The law of a sheet.
#[derive(Clone, Debug)]
pub(super) struct Law {
    groups: Vec<Group>,
    /// One over the stiffness at small strain, Σ h·dEf/dε \[kPa·mm\].
    compliance: f64,
}

/// Layers of one Poisson ratio.
#[derive(Clone, Debug)]
struct Group {
    lanes: Lanes,
    nu: f64,
    /// 1/(1 − ν²).
    plane: f64,
    /// 1/(1 + ν).
    shear: f64,
    secant: Table,
    line_slope: f64,
    line_offset: f64,
}

/// Coefficients of a group as f32, relative to the sheet's stiffness.
#[derive(Clone, Debug)]
struct Lanes {
    /// Coefficients a, b, c, k of `a + b·ē + c·max(ē − k, 0)` in each bucket.
    buckets: Vec<[f32; 4]>,
    per_unit: f32x4,
    last: f32x4,
    end: f32x4,
    line_slope: f32x4,
    line_offset: f32x4,
    nu: f32x4,
    plane: f32x4,
    shear: f32x4,
}

/// A corner of a triangle, relative to its node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Rest area times weight \[spacing²\].
    pub(super) area: f64,
    /// Gradients of the hat functions of the two other nodes \[1/spacing\].
    pub(super) gradients: [DVec2; 2],
}

/// A symmetric 3 × 3 matrix: xx, yy, zz, xy, xz, yz.
pub(super) type Symmetric = [f64; 6];

impl Law {
    pub(super) fn new(law: &CoupledLaw) -> Self {
        let stiffness = law.tension_and_energy([1e-6, 0.0]).0[0] * 1e6;
        let groups = law
            .tables()
            .map(|group| {
                let nu = group.poisson_ratio;
                let (plane, shear) = (1.0 / (1.0 - nu * nu), 1.0 / (1.0 + nu));
                let splat = |value: f64| f32x4::splat(value as f32);
                let relative = |value: f64| (value / stiffness) as f32;
                let secant = group.secant.clone();
                let lanes = Lanes {
                    buckets: secant
                        .buckets()
                        .iter()
                        .map(|&[a, b, c, k]| [relative(a), relative(b), relative(c), k as f32])
                        .collect(),
                    per_unit: splat(secant.buckets_per_unit()),
                    last: splat((secant.buckets().len() - 1) as f64),
                    end: splat(secant.end()),
                    line_slope: f32x4::splat(relative(group.line_slope)),
                    line_offset: f32x4::splat(relative(group.line_offset)),
                    nu: splat(nu),
                    plane: splat(plane),
                    shear: splat(shear),
                };
                let (line_slope, line_offset) = (group.line_slope, group.line_offset);
                Group { lanes, nu, plane, shear, secant, line_slope, line_offset }
            })
            .collect();
        Self { groups, compliance: 1.0 / stiffness }
    }

    /// Second Piola–Kirchhoff tension \[S₁₁, S₂₂, S₁₂\] of four triangles with the metrics
    /// \[C₁₁, C₂₂, C₁₂\].
    #[inline(always)]
    pub(super) fn tension(&self, [c11, c22, c12]: [f32x4; 3]) -> [f32x4; 3] {
        let trace = c11 + c22;
        let s = (c11 * c22 - c12 * c12).fast_max(f32x4::splat(MIN_SQUARED_AREA)).sqrt();
        let t = (trace + s + s).sqrt();
        let over = t - 2.0;
        let squares = (trace - over - over - 2.0).fast_max(f32x4::ZERO);
        let (mut alpha, mut beta) = (f32x4::ZERO, f32x4::ZERO);
        for Group { lanes, .. } in &self.groups {
            let squared = squares - squares * lanes.nu + over * over * lanes.nu;
            let secant = lanes.secant((squared * lanes.plane).sqrt());
            alpha += secant * lanes.shear;
            beta += secant * (((t - 1.0) * lanes.nu - 1.0) * lanes.plane);
        }
        let across = beta / (t * s);
        let along = alpha + across * s;
        [along + across * c22, along + across * c11, -across * c12]
    }

    /// Upper bound of the eigenvalues of a triangle's elasticity tensor \[-\] at the metric
    /// \[C₁₁, C₂₂, C₁₂\]: max(Ef(ē)/ē, Ef′(ē))/(1−ν), summed over the layers.
    ///
    /// By the principal strains ε the stiffness is Ef/ē·K + (Ef′ − Ef/ē)·(Kε)(Kε)ᵀ/ē² with
    /// K = \[1 ν; ν 1\]/(1−ν²) and ē² = εᵀKε. The eigenvalues are at most the greatest eigenvalue of K,
    /// 1/(1−ν), times the greater modulus; rotations of the principal directions are softer.
    pub(super) fn greatest_stiffness(&self, [c11, c22, c12]: [f64; 3]) -> f64 {
        let s = (c11 * c22 - c12 * c12).max(0.0).sqrt();
        let t = (c11 + c22 + 2.0 * s).sqrt();
        let of_group = |group: &Group| {
            let equivalent = group.equivalent_strain(c11 + c22, t);
            let (secant, slope) = group.secant(equivalent);
            secant.max(secant + slope * equivalent) / (1.0 - group.nu)
        };
        self.groups.iter().map(of_group).sum::<f64>() * self.compliance
    }

    /// Adds the contributions of one triangle to a node's force −∂W/∂x and to the positive part of
    /// ∂²W/∂x²; the edges point to the triangle's two other nodes \[spacings\].
    ///
    /// With g the node's own gradient, u = F g, τ = ∂t/∂x = (u + F adj(C) g/s)/t, n the triangle's
    /// normal, α = Σ sec/(1+ν), β = Σ sec·b, b = (ν(t−1) − 1)/(1−ν²):
    /// ∂W/∂x = α u + β τ and ∂²W/∂x² = α g² I + β/t·(g² I + g·adj(C) g/s·n nᵀ − τ τᵀ)
    /// + Σ \[sec·ν/(1−ν²)·τ τᵀ + sec′/ē·(u/(1+ν) + b τ)(…)ᵀ\], each times the rest area.
    #[inline]
    pub(super) fn add_corner(
        &self,
        corner: &Corner,
        [e1, e2]: [DVec3; 2],
        force: &mut DVec3,
        hessian: &mut Symmetric,
    ) {
        let [g1, g2] = corner.gradients;
        let g = -(g1 + g2);
        let (f1, f2) = (e1 * g1.x + e2 * g2.x, e1 * g1.y + e2 * g2.y);
        let (c11, c22, c12) = (f1.length_squared(), f2.length_squared(), f1.dot(f2));
        let s = (c11 * c22 - c12 * c12).max(f64::from(MIN_SQUARED_AREA)).sqrt();
        let t = (c11 + c22 + 2.0 * s).sqrt();
        let u = f1 * g.x + f2 * g.y;
        let adjugate_g = DVec2::new(c22 * g.x - c12 * g.y, c11 * g.y - c12 * g.x);
        let tau = (u + (f1 * adjugate_g.x + f2 * adjugate_g.y) / s) / t;
        let weight = corner.area * self.compliance;
        let (mut alpha, mut beta, mut tau_tau) = (0.0, 0.0, 0.0);
        for group in &self.groups {
            let equivalent = group.equivalent_strain(c11 + c22, t);
            let (secant, slope) = group.secant(equivalent);
            let b = (group.nu * (t - 1.0) - 1.0) * group.plane;
            alpha += secant * group.shear;
            beta += secant * b;
            tau_tau += secant * group.nu * group.plane;
            if equivalent > 1e-9 {
                let direction = u * group.shear + tau * b;
                add_outer(hessian, weight * slope / equivalent, direction);
            }
        }
        *force -= (u * alpha + tau * beta) * weight;
        let squared = g.length_squared();
        let isotropic = (alpha + beta / t).max(MIN_TENSION * alpha) * squared;
        let normal = (isotropic + beta / t * g.dot(adjugate_g) / s)
            .max(MIN_NORMAL_STIFFNESS * alpha * squared);
        add_outer(hessian, weight * (tau_tau - beta / t), tau);
        add_outer(hessian, weight * (normal - isotropic), f1.cross(f2) / s);
        for diagonal in &mut hessian[..3] {
            *diagonal += weight * isotropic;
        }
    }
}

impl Group {
    /// ē \[-\] of a metric with the trace I₁, and t = √(I₁ + 2√det C).
    #[inline]
    fn equivalent_strain(&self, trace: f64, t: f64) -> f64 {
        let (squares, sum) = ((trace - 2.0 * t + 2.0).max(0.0), t - 2.0);
        (((1.0 - self.nu) * squares + self.nu * sum * sum) * self.plane).sqrt()
    }

    /// Secant Σ h·Ef(ē)/ē \[kPa·mm\] and the secant's derivative by ē.
    #[inline]
    fn secant(&self, equivalent: f64) -> (f64, f64) {
        if equivalent > self.secant.end() {
            let offset = self.line_offset / equivalent;
            return (self.line_slope + offset, -offset / equivalent);
        }
        self.secant.value_and_slope(equivalent)
    }
}

impl Lanes {
    #[inline(always)]
    fn secant(&self, equivalent: f32x4) -> f32x4 {
        let position = (equivalent * self.per_unit).fast_min(self.last);
        // The index of a NaN is arbitrary; the bound keeps it in the table.
        let last = self.buckets.len() - 1;
        let indices = position.fast_trunc_int().to_array();
        let [a, b, c, k] =
            f32x4::transpose(indices.map(|k| f32x4::new(self.buckets[(k as usize).min(last)])));
        let inside = a + b * equivalent + c * (equivalent - k).fast_max(f32x4::ZERO);
        let beyond = equivalent.simd_gt(self.end);
        if beyond.any() {
            return beyond.bitselect(self.line_offset / equivalent + self.line_slope, inside);
        }
        inside
    }
}

#[inline]
fn add_outer(matrix: &mut Symmetric, factor: f64, v: DVec3) {
    let w = v * factor;
    matrix[0] += w.x * v.x;
    matrix[1] += w.y * v.y;
    matrix[2] += w.z * v.z;
    matrix[3] += w.x * v.y;
    matrix[4] += w.x * v.z;
    matrix[5] += w.y * v.z;
}

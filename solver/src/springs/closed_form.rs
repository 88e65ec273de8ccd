//! The coupled law in closed form, from the invariants of a triangle: no principal directions.
//!
//! With g the metric of a triangle's two edges and G that of the same edges at rest, I₁ = G⁻¹ : g,
//! s = √(det g / det G) and t = tr U = √(I₁ + 2s) are all that is needed: E:E = I₁ − 2t + 2 and tr E = t − 2 give
//! ē. The second Piola–Kirchhoff tension is P·G⁻¹ + Q·adj(g)/det G with
//!
//! P = α + β/t, Q = β/(t s), α = Σ sec/(1+ν), β = Σ sec·(ν(t−1) − 1)/(1−ν²), sec = h·Ef(ē)/ē.
//!
//! The membrane wrinkles instead of being compressed: S₂ = P + Q λ₁² < 0 is replaced by
//! uniaxial tension, S₂ = 0 and S₁ = Ef(λ₁ − 1)/λ₁, or by none. λ₁ − λ₂ = √D/t comes from the metric itself,
//! D = (λ₁² − λ₂²)²: the difference t² − 4s of the invariants would cancel in f32.
//!
//! One source for f64 and for four f32 lanes; [`super::coupled`] has the reference.

use super::table::Buckets;
use crate::number::Real;

/// Fraction of the tangential stiffness that the stiffness across the sheet is kept above \[-\].
const MIN_NORMAL_STIFFNESS: f64 = 1e-4;
/// The same for the isotropic part of the tension \[-\].
const MIN_TENSION: f64 = 0.1;
/// ē² below which the secant's slope over ē is damped \[-\]; the vectors that the quotient multiplies vanish there.
const SMALL_STRAIN: f64 = 1e-6;
/// Least D = (λ₁² − λ₂²)² of a wrinkled triangle \[-\], against a division by zero.
const MIN_SPREAD: f64 = 1e-30;
/// Fraction of the secant that a wrinkled triangle keeps in the blocks \[-\]: slack skin is taut again after a step.
const WRINKLED_SECANT: f64 = 0.2;
/// Least (λ₁² − λ₂²)² in the blocks \[-\], whose invariants cancel in f32.
const MIN_DIFFERENCE: f64 = 1e-10;
/// Squared relative area below which a triangle counts as this much \[-\].
const MIN_AREA: f64 = 1e-10;

/// Layers of one Poisson ratio. `T` has the table of the secant Σ h·Ef(ē)/ē.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Group<R: Real, T> {
    pub(crate) secant: T,
    end: R,
    /// Beyond `end`, Σ h·Ef = slope·ē + offset.
    line_slope: R,
    line_offset: R,
    nu: R,
    one_minus_nu: R,
    /// 1/(1 − ν²).
    plane: R,
    /// 1/(1 + ν).
    shear: R,
}

/// The numbers of a [`Group`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct GroupNumbers {
    pub(crate) poisson_ratio: f64,
    /// End of the table.
    pub(crate) end: f64,
    pub(crate) line_slope: f64,
    pub(crate) line_offset: f64,
}

/// Second derivative of a triangle's energy by one node,
/// P(mᵀG⁻¹m) I + (β/t)(mᵀadj(g)m)/(s det G) nnᵀ + c_vv vvᵀ + c_vτ (vτᵀ + τvᵀ) + c_ττ ττᵀ,
/// with v = −½∂I₁/∂x, τ = −∂t/∂x, n the normal. Negative tension is left out.
pub(crate) struct Stiffness<R> {
    /// Isotropic part P ≥ 0.
    pub(crate) p: R,
    pub(crate) beta_t: R,
    pub(crate) t: R,
    /// Lower bound of P + (β/t)·… across the sheet.
    pub(crate) min_normal: R,
    pub(crate) vv: R,
    pub(crate) v_tau: R,
    pub(crate) tau_tau: R,
    /// What wrinkled groups add; `None` if no triangle is wrinkled.
    pub(crate) fibre: Option<Fibre<R>>,
}

/// The same of wrinkled groups, uniaxial tension w(λ₁) with the principal directions v₁, v₂ at rest and f₁, f₂ deformed:
/// w″ p₁p₁ᵀ + c (|m|²(I − nnᵀ) − p₁p₁ᵀ − p₂p₂ᵀ) + (w′/λ₁)(m·v₁)² nnᵀ, pₖ = (m·vₖ) fₖ, c = w′ λ₁/(λ₁² − λ₂²). The product of both
/// directions is left out.
pub(crate) struct Fibre<R> {
    /// w″.
    pub(crate) along: R,
    /// c.
    pub(crate) turn: R,
    /// w′/λ₁.
    pub(crate) normal: R,
    /// λ₁², λ₂².
    pub(crate) squares: [R; 2],
    /// 1/(λ₁² − λ₂²).
    pub(crate) per_spread: R,
}

/// s = √det of a metric relative to that at rest, from the determinant.
#[inline(always)]
pub(crate) fn area_stretch<R: Real>(determinant: R) -> R {
    determinant.max(R::splat(MIN_AREA)).sqrt()
}

/// t = tr U.
#[inline(always)]
pub(crate) fn trace_of_stretch<R: Real>(i1: R, s: R) -> R {
    (i1 + s + s).sqrt()
}

impl<R: Real, T: AsRef<Buckets<R>>> Group<R, T> {
    /// A group whose tensions are those of the numbers times `scale`.
    pub(crate) fn new(numbers: GroupNumbers, secant: T, scale: f64) -> Self {
        let GroupNumbers { poisson_ratio: nu, end, line_slope, line_offset } = numbers;
        Self {
            secant,
            end: R::splat(end),
            line_slope: R::splat(line_slope * scale),
            line_offset: R::splat(line_offset * scale),
            nu: R::splat(nu),
            one_minus_nu: R::splat(1.0 - nu),
            plane: R::splat(1.0 / (1.0 - nu * nu)),
            shear: R::splat(1.0 / (1.0 + nu)),
        }
    }

    /// ē of triangles with the invariants I₁ and t.
    #[inline(always)]
    pub(crate) fn equivalent_strain(&self, i1: R, t: R) -> R {
        let over = t - R::splat(2.0);
        let squares = (i1 - over - over - R::splat(2.0)).max(R::default());
        ((squares * self.one_minus_nu + over * over * self.nu) * self.plane).sqrt()
    }

    #[inline(always)]
    fn secant(&self, equivalent: R) -> R {
        let inside = self.secant.as_ref().value(equivalent);
        let beyond = equivalent.is_above(self.end);
        if R::is_any(beyond) {
            let line = self.line_offset / equivalent + self.line_slope;
            return R::select(beyond, line, inside);
        }
        inside
    }

    /// Secant Σ h·Ef(ē)/ē and its slope by ē.
    #[inline(always)]
    pub(crate) fn secant_and_slope(&self, equivalent: R) -> (R, R) {
        let (inside, slope) = self.secant.as_ref().value_and_slope(equivalent);
        let beyond = equivalent.is_above(self.end);
        let line = self.line_offset / equivalent;
        (
            R::select(beyond, line + self.line_slope, inside),
            R::select(beyond, -line / equivalent, slope),
        )
    }

    /// P and Q of triangles with the invariants I₁, s > 0 and t; `spread` returns D = (λ₁² − λ₂²)² of the metric.
    #[inline(always)]
    pub(crate) fn tension(&self, i1: R, s: R, t: R, spread: impl Fn() -> R) -> (R, R) {
        let one = R::splat(1.0);
        let inverse = one / (t * s);
        let secant = self.secant(self.equivalent_strain(i1, t));
        let q = secant * (((t - one) * self.nu - one) * self.plane) * inverse;
        let p = secant * self.shear + q * s;
        self.relaxed([p, q], t, spread())
    }

    /// P and Q of triangles that are not compressed: where P + Q λ₁² < 0, those of uniaxial tension along the first direction,
    /// or zero.
    #[inline(always)]
    fn relaxed(&self, [p, q]: [R; 2], t: R, spread: R) -> (R, R) {
        let zero = R::default();
        let difference = spread.max(R::splat(MIN_SPREAD)).sqrt();
        let strain = (t - R::splat(2.0) + difference / t) * R::splat(0.5);
        let first = strain + R::splat(1.0);
        let square = first * first;
        let is_wrinkled = zero.is_above(p + q * square);
        if !R::is_any(is_wrinkled) {
            return (p, q);
        }
        let pulled = strain.max(zero);
        // Wrinkled, λ₁ − λ₂ is at least (1 + ν)ε₁: the bound is exact, and without it a triangle at rest would pull by its rounding.
        let secant = self.secant(pulled);
        let along = secant * pulled / (first * difference);
        let along = along.min(secant * self.shear / (first * t));
        (R::select(is_wrinkled, along * square, p), R::select(is_wrinkled, -along, q))
    }
}

/// D = (λ₁² − λ₂²)² of a metric relative to an orthonormal frame.
#[inline(always)]
pub(crate) fn spread<R: Real>(c11: R, c22: R, c12: R) -> R {
    let (difference, twice) = (c11 - c22, c12 + c12);
    difference * difference + twice * twice
}

/// P and Q of all groups.
#[inline(always)]
pub(crate) fn tension<R: Real, T: AsRef<Buckets<R>>>(
    groups: &[Group<R, T>],
    i1: R,
    s: R,
    t: R,
    spread: impl Fn() -> R,
) -> (R, R) {
    let (mut p, mut q) = (R::default(), R::default());
    for group in groups {
        let (one, two) = group.tension(i1, s, t, &spread);
        p += one;
        q += two;
    }
    (p, q)
}

/// The stiffness of all groups; wrinkled, that of uniaxial tension and [`WRINKLED_SECANT`].
#[inline(always)]
pub(crate) fn stiffness<R: Real, T: AsRef<Buckets<R>>>(
    groups: &[Group<R, T>],
    i1: R,
    s: R,
) -> Stiffness<R> {
    let one = R::splat(1.0);
    let t = trace_of_stretch(i1, s);
    let zero = R::default();
    let (mut alpha, mut beta) = (zero, zero);
    let (mut vv, mut v_tau, mut tau_tau) = (zero, zero, zero);
    let mut fibre = None;
    let difference = (i1 * i1 - R::splat(4.0) * s * s).max(R::splat(MIN_DIFFERENCE)).sqrt();
    let [greater, least] = [difference, -difference]
        .map(|difference| (t - R::splat(2.0) + difference / t) * R::splat(0.5));
    for group in groups {
        let equivalent = group.equivalent_strain(i1, t);
        let (mut secant, mut slope) = group.secant_and_slope(equivalent);
        let is_wrinkled = zero.is_above(least + greater * group.nu);
        if R::is_any(is_wrinkled) {
            let (first, pulled) = (greater + one, greater.max(zero));
            let (own, own_slope) = group.secant_and_slope(pulled);
            let pull = own * pulled;
            let turn = (pull * first / difference).min(own * group.shear * first / t);
            let tangent = R::select(zero.is_above(greater), zero, own + own_slope * pulled);
            let square = first * first;
            let fibre = fibre.get_or_insert_with(|| Fibre {
                along: zero,
                turn: zero,
                normal: zero,
                squares: [square, s * s / square],
                per_spread: one / difference,
            });
            fibre.along += R::select(is_wrinkled, tangent, zero);
            fibre.turn += R::select(is_wrinkled, turn, zero);
            fibre.normal += R::select(is_wrinkled, pull / first, zero);
            secant = R::select(is_wrinkled, own * R::splat(WRINKLED_SECANT), secant);
            slope = R::select(is_wrinkled, zero, slope);
        }
        let b = ((t - one) * group.nu - one) * group.plane;
        alpha += secant * group.shear;
        beta += secant * b;
        let bend = slope * equivalent / (equivalent * equivalent + R::splat(SMALL_STRAIN));
        vv += bend * (group.shear * group.shear);
        v_tau += bend * b * group.shear;
        tau_tau += bend * b * b + secant * (group.nu * group.plane);
    }
    let beta_t = beta / t;
    Stiffness {
        p: (alpha + beta_t).max(alpha * R::splat(MIN_TENSION)),
        beta_t,
        t,
        min_normal: alpha * R::splat(MIN_NORMAL_STIFFNESS),
        vv,
        v_tau,
        tau_tau: tau_tau - beta_t,
        fibre,
    }
}

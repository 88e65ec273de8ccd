//! The coupled law in closed form, from the invariants of a triangle: no principal directions.
//!
//! With g the metric of a triangle's two edges, G that of the same edges at rest and γ = g − G, all that is needed are
//! τ = tr U − 2, σ = √(det g / det G) − 1 and D = (λ₁² − λ₂²)², with s = 1 + σ, t = 2 + τ: tr E = τ and
//! E:E = (τ² + D/t²)/2 give ē. The second Piola–Kirchhoff tension is P·G⁻¹ + Q·adj(g)/det G = A·G⁻¹ + Q·adj(γ)/det G with
//!
//! P = α + β/t, Q = β/(t s), α = Σ sec/(1+ν), β = Σ sec·(ν(t−1) − 1)/(1−ν²), sec = h·Ef(ē)/ē,
//! A = P + Q = Σ sec·((1−ν)(τ + σ + τσ) + ντ(2 + σ))/((1−ν²) t s).
//!
//! Nothing is a difference of numbers near one, which in f32 would be rounding at a strain of 1e-5.
//!
//! The membrane wrinkles instead of being compressed: S₂ = A + Q (λ₁² − 1) < 0 is replaced by
//! uniaxial tension, S₂ = 0 and S₁ = Ef(λ₁ − 1)/λ₁, or by none; λ₁ − λ₂ = √D/t.
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
/// Least D in the blocks \[-\], whose vectors cancel in f32.
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

/// The change γ of a triangle's metric by its invariants.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Change<R> {
    /// G⁻¹ : γ = λ₁² + λ₂² − 2.
    pub(crate) trace: R,
    /// D = (λ₁² − λ₂²)².
    pub(crate) spread: R,
}

impl<R: Real> Change<R> {
    /// Of two edges that are orthonormal at rest: γ₁₁, γ₂₂, γ₁₂.
    #[inline(always)]
    pub(crate) fn of_square([c11, c22, c12]: [R; 3]) -> Self {
        let (difference, twice) = (c11 - c22, c12 + c12);
        Self { trace: c11 + c22, spread: difference * difference + twice * twice }
    }
}

/// What the law reads of a triangle's stretch.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stretch<R> {
    /// τ = tr U − 2.
    pub(crate) trace: R,
    /// σ = λ₁λ₂ − 1.
    pub(crate) area: R,
    /// E:E.
    squares: R,
    /// 1/(t s).
    inverse: R,
}

impl<R: Real> Stretch<R> {
    /// From the change of the metric and det γ/det G.
    #[inline(always)]
    pub(crate) fn new(Change { trace, spread }: Change<R>, determinant: R) -> Self {
        let one = R::splat(1.0);
        let determinant = trace + determinant;
        let s = (determinant + one).max(R::splat(MIN_AREA)).sqrt();
        let t = (trace + s + s + R::splat(2.0)).sqrt();
        let (over_s, over_t) = (s + one, t + R::splat(2.0));
        // One division for all.
        let (both, product) = (over_s * over_t, t * s);
        let quotient = one / (both * product);
        let (per_both, inverse) = (product * quotient, both * quotient);
        let area = determinant * over_t * per_both;
        let trace = (trace + area + area) * over_s * per_both;
        let per_t = s * inverse;
        let squares = (trace * trace + spread * per_t * per_t) * R::splat(0.5);
        Self { trace, area, squares, inverse }
    }

    /// Of two edges that are orthonormal at rest: γ₁₁, γ₂₂, γ₁₂.
    #[inline(always)]
    pub(crate) fn of_square(change @ [c11, c22, c12]: [R; 3]) -> Self {
        Self::new(Change::of_square(change), c11 * c22 - c12 * c12)
    }

    /// s.
    #[inline(always)]
    pub(crate) fn area_stretch(self) -> R {
        self.area + R::splat(1.0)
    }

    /// t.
    #[inline(always)]
    pub(crate) fn trace_of_stretch(self) -> R {
        self.trace + R::splat(2.0)
    }
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

    /// ē of triangles.
    #[inline(always)]
    fn equivalent_strain(&self, Stretch { trace, squares, .. }: Stretch<R>) -> R {
        ((squares * self.one_minus_nu + trace * trace * self.nu) * self.plane).sqrt()
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

    /// A and Q of triangles.
    #[inline(always)]
    pub(crate) fn tension(&self, at: Stretch<R>, change: Change<R>) -> [R; 2] {
        let one = R::splat(1.0);
        let Stretch { trace, area, inverse, .. } = at;
        let s = at.area_stretch();
        let scale = self.secant(self.equivalent_strain(at)) * self.plane * inverse;
        let bulk = trace * (s + one) * self.nu;
        let all = scale * ((trace * s + area) * self.one_minus_nu + bulk);
        let q = scale * (trace * self.nu - self.one_minus_nu);
        self.relaxed([all, q], at, change)
    }

    /// A and Q of triangles that are not compressed: where A + Q (λ₁² − 1) < 0, those of uniaxial tension along the first
    /// direction, or zero.
    #[inline(always)]
    fn relaxed(&self, [all, q]: [R; 2], at: Stretch<R>, change: Change<R>) -> [R; 2] {
        let zero = R::default();
        let difference = change.spread.max(R::splat(MIN_SPREAD)).sqrt();
        let square = (change.trace + difference) * R::splat(0.5);
        let is_wrinkled = zero.is_above(all + q * square);
        if !R::is_any(is_wrinkled) {
            return [all, q];
        }
        let strain = greatest_strain(at, difference);
        let pulled = strain.max(zero);
        let along = self.secant(pulled) * pulled / ((strain + R::splat(1.0)) * difference);
        [R::select(is_wrinkled, along * square, all), R::select(is_wrinkled, -along, q)]
    }
}

/// ε₁, or ε₂ of the negative difference λ₁² − λ₂².
#[inline(always)]
fn greatest_strain<R: Real>(at: Stretch<R>, difference: R) -> R {
    (at.trace + difference * at.inverse * at.area_stretch()) * R::splat(0.5)
}

/// A and Q of all groups.
#[inline(always)]
pub(crate) fn tension<R: Real, T: AsRef<Buckets<R>>>(
    groups: &[Group<R, T>],
    at: Stretch<R>,
    change: Change<R>,
) -> [R; 2] {
    let mut sum = [R::default(); 2];
    for group in groups {
        let [one, two] = group.tension(at, change);
        sum[0] += one;
        sum[1] += two;
    }
    sum
}

/// The stiffness of all groups; wrinkled, that of uniaxial tension and [`WRINKLED_SECANT`].
#[inline(always)]
pub(crate) fn stiffness<R: Real, T: AsRef<Buckets<R>>>(
    groups: &[Group<R, T>],
    at: Stretch<R>,
    change: Change<R>,
) -> Stiffness<R> {
    let one = R::splat(1.0);
    let (s, t) = (at.area_stretch(), at.trace_of_stretch());
    let zero = R::default();
    let (mut alpha, mut beta) = (zero, zero);
    let (mut vv, mut v_tau, mut tau_tau) = (zero, zero, zero);
    let mut fibre = None;
    let difference = change.spread.max(R::splat(MIN_DIFFERENCE)).sqrt();
    let [greater, least] = [difference, -difference].map(|one| greatest_strain(at, one));
    for group in groups {
        let equivalent = group.equivalent_strain(at);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::CurveSpec;
    use crate::springs::Material;
    use crate::springs::coupled::CoupledLaw;
    use wide::f32x4;

    /// The change of a metric by the principal strains about turned axes.
    fn change([a, b]: [f64; 2], turn: f64) -> [f64; 3] {
        let (sin, cos) = turn.sin_cos();
        let [a, b] = [a * (a + 2.0), b * (b + 2.0)];
        [a * cos * cos + b * sin * sin, a * sin * sin + b * cos * cos, (a - b) * sin * cos]
    }

    /// Taut, wrinkled and slack: f32 keeps a tension's digits, however small the strain is.
    #[test]
    fn the_tension_of_small_strains_keeps_its_digits_in_f32() {
        let law =
            CoupledLaw::new(&[Material::of(&CurveSpec::Linear { modulus_kpa: 50.0 }, 0.45, 2.0)]);
        let groups = law.closed_form::<f32x4>(1.0);
        for size in [1e-1, 1e-3, 1e-5, 1e-7] {
            for (one, two) in [(1.0, 0.8), (1.0, 0.0), (0.7, -0.2), (1.0, -0.6), (-0.3, -0.8)] {
                let strain = [one, two].map(|part: f64| part * size);
                for turn in [0.0, 0.4, 1.3] {
                    let change = change(strain, turn).map(<f32x4 as Real>::splat);
                    let [all, q] =
                        tension(&groups, Stretch::of_square(change), Change::of_square(change));
                    // Along the principal directions the second Piola–Kirchhoff tension is T/λ.
                    let response = law.response(strain).tension;
                    for (along, across) in [(0, 1), (1, 0)] {
                        let found = f64::from(
                            (all + q * f32x4::splat(
                                (strain[across] * (strain[across] + 2.0)) as f32,
                            ))
                            .to_array()[0],
                        );
                        let expected = response[along] / (1.0 + strain[along]);
                        let scale =
                            response[0].abs().max(response[1].abs()).max(1e-3 * 100.0 * size);
                        assert!(
                            (found - expected).abs() < 1e-5 * scale,
                            "{strain:?} {turn}: {found:e} {expected:e}"
                        );
                    }
                }
            }
        }
    }
}

//! The law of a tissue with a measured curve: an energy of one equivalent strain.
//!
//! * Equivalent logarithmic strain e² = g/(1+ν) + ln²J/(3(1−2ν)),
//! * energy per rest volume W = Ψ(exp(e) − 1), Ψ′ = Ef,
//! * nominal stress P = ∂W/∂F = sec·(½∂g/∂F/(1+ν) + ln J/(3(1−2ν) J)·cof F), sec = W′(e)/e.
//!
//! Uniaxial tension gives the nominal stress Ef(λ−1) and the transverse logarithmic strain −ν·ln λ exactly, for every
//! curve and ν < ½: at an axial logarithmic strain l the minimum of e over the transverse strain t is at t = −νl, where
//! e = l.

use super::{Curvature, Slopes, SolidLaw, Volume, WholeLaw};
use crate::curve::Curve;
use crate::number::Real;
use crate::springs::table::{Buckets, Table, Weight};
use wide::f32x4;

/// Poisson ratio up to which multigrid meets the whole stiffness to a change of volume; above, that of this ratio and the
/// rest as an augmented pressure, renewed after every cycle.
const AUGMENTED_ABOVE: f64 = 0.455;
/// e below which sec′/e is damped \[-\]; the vectors that the quotient multiplies vanish there.
const SMALL_STRAIN: f64 = 1e-3;
/// Least slope of the stress in the blocks, relative to the secant: a softening tissue keeps a fifth.
const MOST_SOFTENING: f64 = 0.8;

/// The law of one tissue. `T` has the table of sec against e.
#[derive(Clone, Debug)]
pub struct CurveLaw<R: Real, T> {
    secant: T,
    /// End of the table; beyond it Ef = slope·ε + offset.
    end: R,
    line_slope: R,
    line_offset: R,
    /// 1/(1+ν).
    shear: R,
    /// κ₀, stiffness to a change of volume: κ = 1/(3(1−2ν)), or less with an augmented pressure.
    bulk: R,
    /// 1/κ.
    compliance: R,
    /// 1 − κ₀/κ.
    renewal: R,
}

/// 1/(3(1−2ν)).
fn bulk(poisson_ratio: f64) -> f64 {
    1.0 / (3.0 * (1.0 - 2.0 * poisson_ratio))
}

impl WholeLaw for CurveLaw<f64, Table> {
    type Lanes = CurveLaw<f32x4, Buckets<f32x4>>;

    fn new(curve: &Curve, nu: f64) -> Self {
        let table_end = curve.table_end();
        let end = table_end.ln_1p();
        let mut breaks: Vec<f64> = curve.breaks().map(f64::ln_1p).filter(|b| *b < end).collect();
        breaks.sort_by(f64::total_cmp);
        let secant = |e: f64| {
            let per_strain = if e > 1e-12 { e.exp_m1() / e } else { 1.0 };
            curve.secant(e.exp_m1()) * per_strain * e.exp()
        };
        let line_slope = curve.slope(table_end);
        Self {
            secant: Table::new(secant, (0.0, end), &breaks, Weight::Argument),
            end,
            line_slope,
            line_offset: curve.stress(table_end) - line_slope * table_end,
            shear: 1.0 / (1.0 + nu),
            bulk: bulk(nu),
            compliance: 1.0 / bulk(nu),
            renewal: 0.0,
        }
    }

    fn is_augmented(&self) -> bool {
        self.bulk > bulk(AUGMENTED_ABOVE) * (1.0 + 1e-9)
    }

    fn in_lanes(&self, factor: f64) -> Self::Lanes {
        let kept = if self.is_augmented() { bulk(AUGMENTED_ABOVE) } else { self.bulk };
        let lanes = <f32x4 as Real>::splat;
        CurveLaw {
            secant: self.secant.buckets(factor),
            end: lanes(self.end),
            line_slope: lanes(self.line_slope * factor),
            line_offset: lanes(self.line_offset * factor),
            shear: lanes(self.shear),
            bulk: lanes(kept),
            compliance: lanes(self.compliance),
            renewal: lanes(1.0 - kept / self.bulk),
        }
    }

    fn energy(&self, g: f64, volume: Volume<f64>) -> f64 {
        let equivalent = self.equivalent(g, volume);
        if equivalent <= self.end {
            return self.secant.integral(equivalent);
        }
        let (to, from) = (equivalent.exp_m1(), self.end.exp_m1());
        let over = to - from;
        self.secant.integral(self.end)
            + over * (self.line_offset + 0.5 * self.line_slope * (to + from))
    }

    fn equivalent(&self, g: f64, volume: Volume<f64>) -> f64 {
        self.strain(g, self.pressure(volume.log, 0.0))
    }
}

impl<R: Real, T: AsRef<Buckets<R>>> SolidLaw<R> for CurveLaw<R, T> {
    #[inline(always)]
    fn slopes<const N: usize>(&self, g: [R; N], volume: Volume<R>, augmented: R) -> Slopes<R, N> {
        let pi = self.pressure(volume.log, augmented);
        let secants = g.map(|g| self.secant(self.strain(g, pi)));
        let pressure = mean(&secants) * (pi / volume.ratio);
        Slopes { shear: secants.map(|secant| secant * self.shear), pressure }
    }

    #[inline(always)]
    fn curvature(&self, g: R, volume: Volume<R>, augmented: R) -> Curvature<R> {
        let pi = self.pressure(volume.log, augmented);
        let e = self.strain(g, pi);
        let (secant, bend) = self.secant_and_bend(e);
        let per_volume = pi / volume.ratio;
        let bulk = secant * self.bulk;
        Curvature {
            shear: secant * self.shear,
            pressure: secant * per_volume,
            along: [self.shear, per_volume],
            bend,
            volumetric: bulk * (R::splat(1.0) - volume.log) / (volume.ratio * volume.ratio),
            least_bend: -secant * R::splat(MOST_SOFTENING) / (e * e).max(R::splat(1e-6)),
            bulk,
        }
    }

    /// The augmented pressure whose fixed point is π = κ ln J: (1 − κ₀/κ)·π.
    #[inline(always)]
    fn renewed(&self, volume: Volume<R>, augmented: R) -> R {
        self.renewal * self.pressure(volume.log, augmented)
    }
}

/// The mean over the points of a cell.
#[inline(always)]
fn mean<R: Real>(values: &[R]) -> R {
    match *values {
        [a, b, c, d] => R::splat(0.25) * ((a + b) + (c + d)),
        _ => {
            let sum = values.iter().copied().reduce(|a, b| a + b).unwrap_or_default();
            sum * R::splat(1.0 / values.len() as f64)
        }
    }
}

impl<R: Real, T: AsRef<Buckets<R>>> CurveLaw<R, T> {
    /// π = κ₀ ln J + p, the pressure per sec times J; `augmented` is p.
    #[inline(always)]
    fn pressure(&self, log_volume: R, augmented: R) -> R {
        self.bulk * log_volume + augmented
    }

    /// e of g and π: e² = g/(1+ν) + π²/κ.
    #[inline(always)]
    fn strain(&self, g: R, pi: R) -> R {
        (g * self.shear + pi * pi * self.compliance).sqrt()
    }

    /// W′(e)/e.
    #[inline(always)]
    fn secant(&self, e: R) -> R {
        let inside = self.secant.as_ref().value(e);
        let beyond = e.is_above(self.end);
        if R::is_any(beyond) { R::select(beyond, self.line(e), inside) } else { inside }
    }

    /// W′(e)/e and the quotient of its slope and e.
    #[inline(always)]
    fn secant_and_bend(&self, e: R) -> (R, R) {
        let (mut secant, mut slope) = self.secant.as_ref().value_and_slope(e);
        let beyond = e.is_above(self.end);
        if R::is_any(beyond) {
            let exp = e.exp();
            let line = self.line(e);
            secant = R::select(beyond, line, secant);
            let rise = (self.line_slope * exp * exp) / e + line - line / e;
            slope = R::select(beyond, rise, slope);
        }
        (secant, slope * e / (e * e + R::splat(SMALL_STRAIN * SMALL_STRAIN)))
    }

    /// sec on the line beyond the table: Ef·exp(e)/e.
    #[inline(always)]
    fn line(&self, e: R) -> R {
        let exp = e.exp();
        (self.line_slope * (exp - R::splat(1.0)) + self.line_offset) * exp / e
    }
}

#[cfg(test)]
mod tests {
    use crate::curve::CurveSpec;
    use crate::springs::Material;
    use crate::springs::solids::{ExactLaw, SolidKind};

    fn curves() -> [CurveSpec; 4] {
        [
            CurveSpec::Skin {},
            CurveSpec::Adipose {},
            CurveSpec::Linear { modulus_kpa: 10.0 },
            CurveSpec::Exponential { scale_kpa: 0.5, rate: 6.0 },
        ]
    }

    /// A block pulled at one end has the curve's nominal stress, and the sides are free of stress at −ν·ln λ.
    #[test]
    fn uniaxial_tension_returns_the_curve_and_the_poisson_ratio() {
        for spec in curves() {
            for poisson_ratio in [0.0, 0.2, 1.0 / 3.0, 0.45, 0.48, 0.495] {
                let material = Material::of(&spec, poisson_ratio, 1.0);
                let law = ExactLaw::new(&Material { solid: SolidKind::Curve, ..material.clone() });
                for strain in [0.01, 0.1, 0.3, 0.6, 0.95, 1.4] {
                    let axial = 1.0 + strain;
                    let pulled = |across: f64| {
                        law.response([[axial, 0.0, 0.0], [0.0, across, 0.0], [0.0, 0.0, across]]).0
                    };
                    // Bisection for sides without stress.
                    let (mut low, mut high) = (0.3_f64, 1.3_f64);
                    for _ in 0..60 {
                        let middle = 0.5 * (low + high);
                        if pulled(middle)[1][1] > 0.0 { high = middle } else { low = middle }
                    }
                    let expected = material.curve.stress(strain);
                    let stress = pulled(low)[0][0];
                    let context = format!("{spec:?} {poisson_ratio} {strain}");
                    assert!(
                        (stress / expected - 1.0).abs() < 1e-4,
                        "{context}: {stress} {expected}"
                    );
                    let error = low.ln() + poisson_ratio * axial.ln();
                    assert!(error.abs() < 1e-4, "{context}: {error:e}");
                }
            }
        }
    }
}

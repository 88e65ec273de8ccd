//! A slab of solid tissue under homogeneous loads: the law of the solver with its tables, and closed forms of the same law.
//!
//! Uses `model`, `springs` (the law). Used by `treloar`, `fat`, `verification`.

use implant_preview_core::curve::Curve;
use implant_preview_core::springs::Material;
use implant_preview_core::springs::solids::ExactLaw;

/// Steps of a bisection: 2⁻⁶⁰ of the interval.
const BISECTIONS: u32 = 60;
/// Logarithmic strain around the expected one in which a free strain is searched \[-\].
const SEARCH: f64 = 1.5;

/// A homogeneous slab of one solid.
#[derive(Debug)]
pub struct Slab {
    law: ExactLaw,
}

/// The zero of an increasing function in an interval.
fn zero([mut low, mut high]: [f64; 2], of: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        if of(middle) < 0.0 { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

impl Slab {
    /// A slab of a material; its thickness does not matter.
    #[must_use]
    pub fn new(material: &Material) -> Self {
        Self { law: ExactLaw::new(material) }
    }

    /// Nominal stresses \[kPa\] of principal stretches \[-\].
    #[must_use]
    pub fn stress(&self, [a, b, c]: [f64; 3]) -> [f64; 3] {
        let (stress, _) = self.law.response([[a, 0.0, 0.0], [0.0, b, 0.0], [0.0, 0.0, c]]);
        [0, 1, 2].map(|k| stress[k][k])
    }

    /// Nominal stress \[kPa\] at an equibiaxial stretch \[-\], free through the thickness.
    #[must_use]
    pub fn equibiaxial(&self, stretch: f64) -> f64 {
        let expected = -2.0 * stretch.ln();
        let across = zero([expected - SEARCH, expected + SEARCH], |log| {
            self.stress([stretch, stretch, log.exp()])[2]
        });
        self.stress([stretch, stretch, across.exp()])[0]
    }

    /// Nominal stress \[kPa\] and transverse logarithmic strain \[-\] at a uniaxial stretch \[-\], free across.
    #[must_use]
    pub fn uniaxial(&self, stretch: f64) -> (f64, f64) {
        let expected = -0.5 * stretch.ln();
        let across = zero([expected - SEARCH, expected + SEARCH], |log| {
            self.stress([stretch, log.exp(), log.exp()])[1]
        });
        (self.stress([stretch, across.exp(), across.exp()])[0], across)
    }
}

/// The invariant K \[-\] of an isochoric uniaxial stretch, for the weight β of the second invariant.
fn uniaxial_invariant(beta: f64, x: f64) -> f64 {
    (1.0 - beta) * (x * x + 2.0 / x - 3.0) + beta * (2.0 * x + 1.0 / (x * x) - 3.0)
}

/// The invariant K \[-\] of an isochoric equibiaxial stretch.
fn equibiaxial_invariant(beta: f64, m: f64) -> f64 {
    (1.0 - beta) * (2.0 * m * m + m.powi(-4) - 3.0) + beta * (m.powi(4) + 2.0 * m.powi(-2) - 3.0)
}

/// The isochoric uniaxial stretch with an invariant K.
fn uniaxial_stretch(beta: f64, invariant: f64) -> f64 {
    zero([1.0, 20.0], |x| uniaxial_invariant(beta, x) - invariant)
}

/// Nominal equibiaxial stress \[kPa\] of an incompressible solid in closed form, from the curve itself:
/// 2σ = Ef(λ_u − 1)·dλ_u/dλ.
#[must_use]
pub fn incompressible_equibiaxial(curve: &Curve, beta: f64, stretch: f64) -> f64 {
    if stretch <= 1.0 + 1e-9 {
        return 0.0;
    }
    let (m, x) = (stretch, uniaxial_stretch(beta, equibiaxial_invariant(beta, stretch)));
    let by_m = 4.0 * ((1.0 - beta) * (m - m.powi(-5)) + beta * (m.powi(3) - m.powi(-3)));
    let by_x = 2.0 * ((1.0 - beta) * (x - x.powi(-2)) + beta * (1.0 - x.powi(-3)));
    0.5 * curve.stress(x - 1.0) * by_m / by_x
}

/// Nominal equibiaxial stress \[kPa\] of a compressible solid from the curve itself: half the slope of the energy, least over
/// the thickness.
#[must_use]
pub fn closed_equibiaxial(curve: &Curve, poisson_ratio: f64, beta: f64, stretch: f64) -> f64 {
    let energy = |in_plane: f64, through: f64| {
        let iso = ((in_plane - through) / 3.0).exp();
        let log = uniaxial_stretch(beta, equibiaxial_invariant(beta, iso)).ln();
        let volume = 2.0 * in_plane + through;
        let square = 1.5 * log * log / (1.0 + poisson_ratio)
            + volume * volume / (3.0 * (1.0 - 2.0 * poisson_ratio));
        curve.energy(square.sqrt().exp_m1())
    };
    let least = |stretch: f64| {
        let log = stretch.ln();
        let (mut low, mut high) = (-2.5 * log, -log);
        for _ in 0..100 {
            let third = (high - low) / 3.0;
            if energy(log, low + third) < energy(log, high - third) {
                high -= third;
            } else {
                low += third;
            }
        }
        energy(log, 0.5 * (low + high))
    };
    let step = 1e-4;
    (least(stretch + step) - least(stretch - step)) / (4.0 * step)
}

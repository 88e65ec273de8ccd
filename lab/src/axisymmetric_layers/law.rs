//! The law of a solid layer in the invariants of an axisymmetric deformation, from the curve itself.
//!
//! With the deformation gradient's part F in the plane of the section and the hoop stretch h = r/R, the variables
//! are t = F:F, D = det F and h: tr C = t + h², ½(tr²C − tr C²) = D² + t h², J = D h. Then
//!
//! * Ī₁ = J^(−2/3)(t + h²), Ī₂ = J^(−4/3)(D² + t h²), K = (1−β)(Ī₁−3) + β(Ī₂−3), β = 0.2;
//! * λ_u(K) ≥ 1, the isochoric uniaxial stretch with that K: (λ−1)²\[(1−β)(λ+2)/λ + β(2λ+1)/λ²\] = K;
//! * equivalent logarithmic strain e² = 3/2·ln²λ_u/(1+ν) + ln²J̄/(3(1−2ν));
//! * energy per rest volume W = Ψ(exp e − 1), Ψ′ = Ef.
//!
//! Uniaxial tension gives the nominal stress Ef(λ−1) and the transverse logarithmic strain −ν ln λ exactly.
//!
//! Uses `curve`. Used by `element`.

use implant_preview_core::curve::Curve;

/// Weight β of the second invariant \[-\], from Treloar's rubber: uniaxial curve in, equibiaxial curve out.
const SECOND_INVARIANT_WEIGHT: f64 = 0.2;

/// Logarithmic strain below which the second derivatives by squares are zero \[-\]: their factors vanish there, the
/// quotients cancel.
const SMALL: f64 = 1e-8;

/// A function of (t, D, h) with its gradient and Hessian.
#[derive(Clone, Copy, Debug)]
pub(super) struct Expansion {
    pub(super) value: f64,
    pub(super) gradient: [f64; 3],
    pub(super) hessian: [[f64; 3]; 3],
}

/// The law of one solid.
#[derive(Clone, Debug)]
pub(super) struct SolidLaw {
    curve: Curve,
    poisson_ratio: f64,
}

impl SolidLaw {
    pub(super) fn new(curve: &Curve, poisson_ratio: f64) -> Self {
        Self { curve: curve.clone(), poisson_ratio }
    }

    /// Isochoric part of e² \[-\]. `None` for a state that is inverted or not finite.
    pub(super) fn isochoric_value(&self, [t, d, h]: [f64; 3]) -> Option<f64> {
        if !(d > 0.0 && h > 0.0 && t.is_finite()) {
            return None;
        }
        let q = (d * h).powf(-2.0 / 3.0);
        let beta = SECOND_INVARIANT_WEIGHT;
        let invariant =
            (1.0 - beta) * (q * (t + h * h) - 3.0) + beta * (q * q * (d * d + t * h * h) - 3.0);
        let log = uniaxial_log(invariant);
        Some(1.5 * log * log / (1.0 + self.poisson_ratio))
    }

    /// Isochoric part of e² with its derivatives. `None` for a state that is inverted or not finite.
    pub(super) fn isochoric(&self, state: [f64; 3]) -> Option<Expansion> {
        let [t, d, h] = state;
        if !(d > 0.0 && h > 0.0 && t.is_finite()) {
            return None;
        }
        let invariant = weighted_invariant(t, d, h);
        let log = uniaxial_log(invariant.value);
        let [slope, bend] = square_slopes(log).map(|x| x / (1.0 + self.poisson_ratio));
        let k = &invariant;
        Some(Expansion {
            value: 1.5 * log * log / (1.0 + self.poisson_ratio),
            gradient: k.gradient.map(|g| slope * g),
            hessian: std::array::from_fn(|i| {
                std::array::from_fn(|j| {
                    bend * k.gradient[i] * k.gradient[j] + slope * k.hessian[i][j]
                })
            }),
        })
    }

    /// Volumetric part θ(J̄) = ln²J̄/(3(1−2ν)) of e² and its two derivatives.
    pub(super) fn volumetric(&self, volume_ratio: f64) -> [f64; 3] {
        let factor = 1.0 / (3.0 * (1.0 - 2.0 * self.poisson_ratio));
        let log = volume_ratio.ln();
        [
            factor * log * log,
            2.0 * factor * log / volume_ratio,
            2.0 * factor * (1.0 - log) / (volume_ratio * volume_ratio),
        ]
    }

    /// W \[kPa\] of e².
    pub(super) fn energy(&self, square: f64) -> f64 {
        self.curve.energy(square.max(0.0).sqrt().exp_m1())
    }

    /// dW/d(e²), d²W/d(e²)² \[kPa\].
    pub(super) fn slopes(&self, square: f64) -> [f64; 2] {
        let e = square.max(0.0).sqrt();
        if e < SMALL {
            return [0.5 * self.curve.slope(0.0), 0.0];
        }
        let (strain, stretch) = (e.exp_m1(), e.exp());
        let by_log = self.curve.stress(strain) * stretch;
        let by_log_twice = self.curve.slope(strain) * stretch * stretch + by_log;
        [0.5 * by_log / e, (by_log_twice - by_log / e) / (4.0 * e * e)]
    }
}

/// K with its derivatives by (t, D, h): each invariant is a power of J times a polynomial.
fn weighted_invariant(t: f64, d: f64, h: f64) -> Expansion {
    let one = power_times(
        -2.0 / 3.0,
        [d, h],
        t + h * h,
        [1.0, 0.0, 2.0 * h],
        [[0.0; 3], [0.0; 3], [0.0, 0.0, 2.0]],
    );
    let two = power_times(
        -4.0 / 3.0,
        [d, h],
        d * d + t * h * h,
        [h * h, 2.0 * d, 2.0 * t * h],
        [[0.0, 0.0, 2.0 * h], [0.0, 2.0, 0.0], [2.0 * h, 0.0, 2.0 * t]],
    );
    let beta = SECOND_INVARIANT_WEIGHT;
    let mix = |a: f64, b: f64| (1.0 - beta) * a + beta * b;
    Expansion {
        value: mix(one.value, two.value) - 3.0,
        gradient: std::array::from_fn(|i| mix(one.gradient[i], two.gradient[i])),
        hessian: std::array::from_fn(|i| {
            std::array::from_fn(|j| mix(one.hessian[i][j], two.hessian[i][j]))
        }),
    }
}

/// (D h)^m · M(t, D, h) from the derivatives of M.
fn power_times(
    m: f64,
    [d, h]: [f64; 2],
    value: f64,
    by: [f64; 3],
    twice: [[f64; 3]; 3],
) -> Expansion {
    let q = (d * h).powf(m);
    let q_by = [0.0, m * q / d, m * q / h];
    let q_twice = [
        [0.0; 3],
        [0.0, m * (m - 1.0) * q / (d * d), m * m * q / (d * h)],
        [0.0, m * m * q / (d * h), m * (m - 1.0) * q / (h * h)],
    ];
    Expansion {
        value: q * value,
        gradient: std::array::from_fn(|i| q_by[i] * value + q * by[i]),
        hessian: std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                q_twice[i][j] * value + q_by[i] * by[j] + q_by[j] * by[i] + q * twice[i][j]
            })
        }),
    }
}

/// ln λ_u(K): Newton's method on √K, which is nearly linear in λ.
fn uniaxial_log(invariant: f64) -> f64 {
    let beta = SECOND_INVARIANT_WEIGHT;
    let root = invariant.max(0.0).sqrt();
    // x = λ − 1; √K = x·√b(λ).
    let mut x = root / 3.0_f64.sqrt();
    for _ in 0..50 {
        let l = 1.0 + x;
        let b = (1.0 - beta) * (1.0 + 2.0 / l) + beta * (2.0 / l + 1.0 / (l * l));
        let b_slope = -2.0 * (1.0 - beta) / (l * l) - beta * (2.0 / (l * l) + 2.0 / (l * l * l));
        let sqrt = b.sqrt();
        let step = (root - x * sqrt) / (sqrt + 0.5 * x * b_slope / sqrt);
        x = (x + step).max(0.0);
        if step.abs() <= 1e-15 * (1.0 + x) {
            break;
        }
    }
    x.ln_1p()
}

/// First and second derivative by K of 3/2·ln²λ_u, at ln λ_u.
fn square_slopes(log: f64) -> [f64; 2] {
    if log < SMALL {
        return [0.5, 0.0];
    }
    let beta = SECOND_INVARIANT_WEIGHT;
    // dK/dl and d²K/dl² with l = ln λ.
    let (a, b) = (log.exp_m1(), (-log).exp_m1());
    let (a2, b2) = ((2.0 * log).exp_m1(), (-2.0 * log).exp_m1());
    let first = 2.0 * ((1.0 - beta) * (a2 - b) + beta * (a - b2));
    let second = 6.0 + (1.0 - beta) * (4.0 * a2 + 2.0 * b) + beta * (2.0 * a + 4.0 * b2);
    [3.0 * log / first, 3.0 * (first - log * second) / first.powi(3)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use implant_preview_core::curve::CurveSpec;

    fn laws() -> Vec<SolidLaw> {
        let curve = |spec| Curve::new(&spec).unwrap();
        vec![
            SolidLaw::new(&curve(CurveSpec::Adipose {}), 0.45),
            SolidLaw::new(&curve(CurveSpec::Linear { modulus_kpa: 5.0 }), 1.0 / 3.0),
            SolidLaw::new(&curve(CurveSpec::Exponential { scale_kpa: 3.0, rate: 3.0 }), 0.3),
        ]
    }

    /// W of three principal stretches, the third around the axis.
    fn energy(law: &SolidLaw, [a, b, c]: [f64; 3]) -> f64 {
        let square = law.isochoric_value([a * a + b * b, a * b, c]).unwrap();
        law.energy(square + law.volumetric(a * b * c)[0])
    }

    #[test]
    fn uniaxial_tension_gives_the_curve_and_the_poisson_ratio() {
        for law in laws() {
            for stretch in [1.05_f64, 1.3, 1.6, 1.9] {
                let across = stretch.powf(-law.poisson_ratio);
                for axis in 0..3 {
                    let mut state = [across; 3];
                    state[axis] = stretch;
                    let step = 1e-5;
                    let stress = |k: usize| {
                        let at = |sign: f64| {
                            let mut moved = state;
                            moved[k] += sign * step;
                            energy(&law, moved)
                        };
                        (at(1.0) - at(-1.0)) / (2.0 * step)
                    };
                    let expected = law.curve.stress(stretch - 1.0);
                    assert!((stress(axis) / expected - 1.0).abs() < 1e-7, "{stretch} {axis}");
                    for k in (0..3).filter(|k| *k != axis) {
                        assert!(stress(k).abs() < 1e-7 * expected, "{stretch} {axis} {k}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_derivatives_are_those_of_the_value() {
        let step = 1e-5;
        for law in laws() {
            for state in [[2.3, 0.9, 1.2], [2.0, 0.6, 1.5], [5.0, 1.4, 0.7]] {
                let expansion = law.isochoric(state).unwrap();
                assert!((expansion.value - law.isochoric_value(state).unwrap()).abs() < 1e-14);
                for i in 0..3 {
                    let at = |sign: f64| {
                        let mut moved = state;
                        moved[i] += sign * step;
                        law.isochoric(moved).unwrap()
                    };
                    let (up, down) = (at(1.0), at(-1.0));
                    let slope = (up.value - down.value) / (2.0 * step);
                    assert!((slope - expansion.gradient[i]).abs() < 1e-8, "{state:?}");
                    for j in 0..3 {
                        let bend = (up.gradient[j] - down.gradient[j]) / (2.0 * step);
                        assert!((bend - expansion.hessian[i][j]).abs() < 1e-7, "{state:?}");
                    }
                }
            }
            for square in [1e-4, 0.02, 0.3, 1.1] {
                let step = 1e-5 * square;
                let slopes = law.slopes(square);
                let slope = (law.energy(square + step) - law.energy(square - step)) / (2.0 * step);
                let bend =
                    (law.slopes(square + step)[0] - law.slopes(square - step)[0]) / (2.0 * step);
                assert!((slope / slopes[0] - 1.0).abs() < 1e-7);
                assert!((bend - slopes[1]).abs() < 1e-5 * slopes[0] / square);
            }
        }
    }
}

//! The deformation of solid tissue: change of shape and volume ratio, without principal directions, and the stress of a law.
//!
//! With C = FᵀF, J = √det C, Ī₁ = J^(−2/3) tr C, Ī₂ = J^(−4/3) tr cof C and K = (1−β)(Ī₁−3) + β(Ī₂−3), the stretch
//! λ_u(K) ≥ 1 is the isochoric uniaxial stretch of the same K, and g = 3/2·ln²λ_u measures the change of shape.
//!
//! The nominal stress of a law's energy per rest volume W(g, J) ([`SolidLaw`]) is P = ∂W/∂F = 2W_g·½∂g/∂F + W_J·cof F, its second derivative 2W_g·½∂²g/∂F² + W_J·∂²J/∂F² and two squares of
//! ½∂g/∂F and cof F ([`Curvature`](crate::springs::solids::Curvature)): cells, blocks and tangent know these numbers alone.
//!
//! β = 0.2 from the equibiaxial stress of rubber (L. R. G. Treloar, Trans. Faraday Soc. 40, 1944) predicted from the
//! uniaxial curve: β = 0 is 9–22 % low, β = 0.2 −4 to +2 %, a law of the logarithmic strain up to 50 % high.
//!
//! One source for f64 and for four f32 lanes.

use crate::mesh::vec3::{add, cross, dot, scale, sub};
use crate::number::Real;
use crate::number::dual::Dual;
use crate::springs::solids::{ExactLaw, Slopes, SolidLaw, Volume, WholeLaw, of_law};
use glam::{DMat3, DVec3};

/// Part of the second invariant in K \[-\].
const BETA: f64 = 0.2;

/// Three columns.
pub(crate) type Matrix<R> = [[R; 3]; 3];

/// Shape and volume of a deformation gradient.
#[derive(Clone, Copy)]
pub(crate) struct Deformed<R> {
    pub(crate) columns: Matrix<R>,
    /// Cofactors, by columns: ∂J/∂F.
    pub(crate) cofactors: Matrix<R>,
    pub(crate) volume: R,
}

/// g and ½∂g/∂F = a F − b F C − c cof F.
#[derive(Clone, Copy)]
pub(crate) struct Isochoric<R> {
    pub(crate) g: R,
    pub(crate) i1: R,
    /// C: 11, 12, 13, 22, 23, 33.
    metric: [R; 6],
    a: R,
    b: R,
    c: R,
}

impl<R: Real> Deformed<R> {
    #[inline(always)]
    pub(crate) fn new(columns: Matrix<R>) -> Self {
        let [x, y, z] = columns;
        let cofactors = [cross(y, z), cross(z, x), cross(x, y)];
        Self { columns, cofactors, volume: dot(x, cofactors[0]) }
    }

    #[inline(always)]
    pub(crate) fn volume(&self) -> Volume<R> {
        Volume::new(self.volume)
    }

    #[inline(always)]
    pub(crate) fn isochoric(&self) -> Isochoric<R> {
        let [x, y, z] = self.columns;
        let metric = [dot(x, x), dot(x, y), dot(x, z), dot(y, y), dot(y, z), dot(z, z)];
        let [p, q, r] = self.cofactors;
        let (i1, i2) = (metric[0] + metric[3] + metric[5], dot(p, p) + dot(q, q) + dot(r, r));
        let volume = self.volume();
        // J^(−1/3).
        let root = (volume.log * R::splat(-1.0 / 3.0)).exp();
        let (two, four) = (root * root, root * root * root * root);
        let (first, second) = (R::splat(1.0 - BETA) * two, R::splat(BETA) * four);
        let (i1_bar, i2_bar) = (first * i1, second * i2);
        let k = (i1_bar + i2_bar - R::splat(3.0)).max(R::default());
        let (g, slope) = uniaxial(k);
        let inverse = R::splat(1.0) / volume.ratio;
        let third = R::splat(1.0 / 3.0);
        Isochoric {
            g,
            i1,
            metric,
            a: slope * (first + second * i1),
            b: slope * second,
            c: slope * third * (i1_bar + i2_bar + i2_bar) * inverse,
        }
    }

    /// `shear`·½∂g/∂F + `pressure`·cof F, in columns.
    #[inline(always)]
    pub(crate) fn stress(&self, shape: &Isochoric<R>, shear: R, pressure: R) -> Matrix<R> {
        let [x, y, z] = self.columns;
        let Isochoric { metric: [xx, xy, xz, yy, yz, zz], a, b, c, .. } = *shape;
        let (a, b, c) = (a * shear, b * shear, pressure - c * shear);
        let column = |k: usize, [p, q, r]: [R; 3]| {
            let own = sub(scale(self.columns[k], a), scale(combined([x, y, z], [p, q, r]), b));
            add(own, scale(self.cofactors[k], c))
        };
        [column(0, [xx, xy, xz]), column(1, [xy, yy, yz]), column(2, [xz, yz, zz])]
    }
}

/// ∂P/∂F of a stress: the columns p ≤ q of the derivative, 11, 12, 13, 22, 23, 33, each ∂P_p/∂F_q.
#[derive(Clone, Copy, Debug)]
pub(crate) struct StressSlopes([DMat3; 6]);

impl StressSlopes {
    /// The change of the stress by a change of the gradient, in columns.
    #[inline]
    pub(crate) fn product(&self, change: Matrix<f64>) -> Matrix<f64> {
        let [xx, xy, xz, yy, yz, zz] = &self.0;
        let [x, y, z] = change.map(DVec3::from);
        let back =
            |m: &DMat3, v: DVec3| DVec3::new(m.x_axis.dot(v), m.y_axis.dot(v), m.z_axis.dot(v));
        [
            *xx * x + *xy * y + *xz * z,
            back(xy, x) + *yy * y + *yz * z,
            back(xz, x) + back(yz, y) + *zz * z,
        ]
        .map(|v| v.to_array())
    }

    /// Σ n_p m_q ∂P_p/∂F_q: the stiffness of the nodes whose shape functions have the gradients n and m.
    pub(crate) fn block(&self, [n, m]: [DVec3; 2]) -> DMat3 {
        let [xx, xy, xz, yy, yz, zz] = &self.0;
        let crossed = |part: &DMat3, p: usize, q: usize| {
            *part * (n[p] * m[q]) + part.transpose() * (n[q] * m[p])
        };
        *xx * (n.x * m.x)
            + *yy * (n.y * m.y)
            + *zz * (n.z * m.z)
            + crossed(xy, 0, 1)
            + crossed(xz, 0, 2)
            + crossed(yz, 1, 2)
    }
}

/// The nominal stress of a homogeneous deformation, in columns \[kPa\].
pub(crate) fn nominal_stress(law: &ExactLaw, columns: Matrix<f64>) -> Matrix<f64> {
    let deformed = Deformed::new(columns);
    let shape = deformed.isochoric();
    let Slopes { shear: [shear], pressure } =
        of_law!(law, law => law.slopes([shape.g], deformed.volume(), 0.0));
    deformed.stress(&shape, shear, pressure)
}

impl ExactLaw {
    /// The nominal stress of a homogeneous deformation, in columns \[kPa\], and its equivalent strain.
    #[must_use]
    pub fn response(&self, columns: Matrix<f64>) -> (Matrix<f64>, f64) {
        let deformed = Deformed::new(columns);
        let (g, volume) = (deformed.isochoric().g, deformed.volume());
        (nominal_stress(self, columns), of_law!(self, law => law.equivalent(g, volume)))
    }

    /// The energy per rest volume of a homogeneous deformation \[kPa\].
    #[must_use]
    pub fn energy_of(&self, columns: Matrix<f64>) -> f64 {
        let deformed = Deformed::new(columns);
        of_law!(self, law => law.energy(deformed.isochoric().g, deformed.volume()))
    }
}

/// The derivative of the stress `shear`·½∂g/∂F + `pressure`·cof F by F, where `pressure` rises by `volumetric` with J.
pub(crate) fn stress_slopes(
    columns: Matrix<f64>,
    shear: f64,
    pressure: f64,
    volumetric: f64,
) -> StressSlopes {
    let variable = |c: usize, r: usize| Dual::<9>::variable(columns[c][r], 3 * c + r);
    let deformed = Deformed::new([0, 1, 2].map(|c| [0, 1, 2].map(|r| variable(c, r))));
    let rise = deformed.volume - Dual::splat(deformed.volume.value);
    let of_volume = Dual::splat(pressure) + Dual::splat(volumetric) * rise;
    let stress = deformed.stress(&deformed.isochoric(), Dual::splat(shear), of_volume);
    let part = |p: usize, q: usize| {
        let column = |c: usize| DVec3::from([0, 1, 2].map(|r| stress[p][r].slopes[3 * q + c]));
        DMat3::from_cols(column(0), column(1), column(2))
    };
    StressSlopes([part(0, 0), part(0, 1), part(0, 2), part(1, 1), part(1, 2), part(2, 2)])
}

/// The sum of columns times numbers.
#[inline(always)]
pub(crate) fn combined<R: Real>([x, y, z]: Matrix<R>, [p, q, r]: [R; 3]) -> [R; 3] {
    add(add(scale(x, p), scale(y, q)), scale(z, r))
}

/// Coefficients of √g = √K·q(√K), q = N/D; error of the value 7e-8, of the slope 8e-6 up to K = 19 (λ_u = 4.9).
const NUMERATOR: [f64; 5] = [
    0.707_106_753_857_798,
    0.555_965_588_543_969,
    0.210_670_508_832_717,
    0.044_259_724_778_411,
    0.000_400_555_629_081,
];
const DENOMINATOR: [f64; 5] = [
    1.0,
    0.843_986_313_137_404,
    0.380_025_052_574_960,
    0.104_453_832_514_53,
    0.010_441_660_710_868,
];

/// g = 3/2·ln²λ_u(K) and its slope by K.
#[inline(always)]
fn uniaxial<R: Real>(k: R) -> (R, R) {
    let s = k.sqrt();
    let (n, n_slope) = polynomial(&NUMERATOR, s);
    let (d, d_slope) = polynomial(&DENOMINATOR, s);
    let inverse = R::splat(1.0) / d;
    let q = n * inverse;
    let q_slope = (n_slope - q * d_slope) * inverse;
    // √g = s q, so that ∂g/∂K = √g·(q + s q′)/s.
    (k * q * q, q * (q + s * q_slope))
}

/// A polynomial and its slope.
#[inline(always)]
fn polynomial<R: Real>([a, b, c, d, e]: &[f64; 5], x: R) -> (R, R) {
    let value = |c: f64| R::splat(c);
    (
        value(*a) + x * (value(*b) + x * (value(*c) + x * (value(*d) + x * value(*e)))),
        value(*b) + x * (value(2.0 * c) + x * (value(3.0 * d) + x * value(4.0 * e))),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::CurveSpec;
    use crate::model::layered::cell;
    use crate::model::layered::modes::Modes;
    use crate::model::layered::shape::Plain;
    use crate::model::layered::sides::Upright;
    use crate::model::layered::variation::Variation;
    use crate::springs::Material;
    use crate::springs::solids::{Curvature, SolidKind};

    /// Mooney and Rivlin: W = ½μ·K + ½κ ln²J. K(g) = (1−β)(λ²+2/λ−3) + β(2λ+1/λ²−3) of λ = exp √(2g/3).
    struct MooneyRivlin {
        shear: f64,
        bulk: f64,
    }

    impl MooneyRivlin {
        /// K, K′ and K″ by g.
        fn invariant(g: f64) -> [f64; 3] {
            let s = (2.0 * g / 3.0).sqrt();
            let of = |power: f64, weight: f64| {
                [1.0, power, power * power].map(|f| f * weight * (power * s).exp())
            };
            let terms = [
                of(2.0, 1.0 - BETA),
                of(-1.0, 2.0 - 2.0 * BETA),
                of(1.0, 2.0 * BETA),
                of(-2.0, BETA),
            ];
            let [k, slope, bend] = [0, 1, 2].map(|n| terms.iter().map(|t| t[n]).sum::<f64>());
            // ds/dg = 1/(3s).
            [k - 3.0, slope / (3.0 * s), (bend - slope / s) / (9.0 * s * s)]
        }
    }

    impl SolidLaw<f64> for MooneyRivlin {
        fn slopes<const N: usize>(&self, g: [f64; N], v: Volume<f64>, _: f64) -> Slopes<f64, N> {
            let shear = g.map(|g| self.shear * Self::invariant(g)[1]);
            Slopes { shear, pressure: self.bulk * v.log / v.ratio }
        }

        fn curvature(&self, g: f64, v: Volume<f64>, augmented: f64) -> Curvature<f64> {
            let Slopes { shear: [shear], pressure } = self.slopes([g], v, augmented);
            Curvature {
                shear,
                pressure,
                along: [1.0, 0.0],
                bend: 2.0 * self.shear * Self::invariant(g)[2],
                volumetric: self.bulk * (1.0 - v.log) / (v.ratio * v.ratio),
                least_bend: 0.0,
                bulk: self.bulk,
            }
        }
    }

    impl MooneyRivlin {
        fn energy(&self, g: f64, v: Volume<f64>) -> f64 {
            0.5 * (self.shear * Self::invariant(g)[0] + self.bulk * v.log * v.log)
        }
    }

    /// All laws of a curve.
    fn laws(spec: &CurveSpec, poisson_ratio: f64) -> impl Iterator<Item = ExactLaw> {
        let material = Material::of(spec, poisson_ratio, 1.0);
        let law = move |&solid| ExactLaw::new(&Material { solid, ..material.clone() });
        SolidKind::ALL.iter().map(law)
    }

    const MOONEY_RIVLIN: MooneyRivlin = MooneyRivlin { shear: 2.0, bulk: 30.0 };

    fn check_derivatives(law: &impl SolidLaw<f64>, energy: impl Fn(f64, Volume<f64>) -> f64) {
        let (g, j, h) = (0.09, 1.1, 1e-5);
        let energy = |g: f64, j: f64| energy(g, Volume::new(j));
        let slopes = |g: f64, j: f64| {
            let Slopes { shear: [shear], pressure } = law.slopes([g], Volume::new(j), 0.0);
            [shear, pressure]
        };
        let near = |found: f64, expected: f64| {
            assert!((found - expected).abs() < 2e-3 * (1.0 + expected.abs()), "{found} {expected}");
        };
        let [shear, pressure] = slopes(g, j);
        near(shear, (energy(g + h, j) - energy(g - h, j)) / h);
        near(pressure, (energy(g, j + h) - energy(g, j - h)) / (2.0 * h));
        let c = law.curvature(g, Volume::new(j), 0.0);
        assert!((c.shear - shear).abs() < 1e-12 && (c.pressure - pressure).abs() < 1e-12);
        let by = |dg: f64, dj: f64| {
            let [after, before] = [1.0, -1.0].map(|sign| slopes(g + sign * dg, j + sign * dj));
            [0, 1].map(|k| (after[k] - before[k]) / (2.0 * h))
        };
        let [alpha, beta] = c.along;
        // ½∂g/∂F is half of a change of g.
        near(by(h, 0.0)[0], 0.5 * c.bend * alpha * alpha);
        near(by(0.0, h)[0], c.bend * alpha * beta);
        near(by(0.0, h)[1], c.bend * beta * beta + c.volumetric);
    }

    #[test]
    fn laws_have_the_derivatives_of_their_energy() {
        check_derivatives(&MOONEY_RIVLIN, |g, v| MOONEY_RIVLIN.energy(g, v));
        for law in laws(&CurveSpec::Exponential { scale_kpa: 2.0, rate: 3.0 }, 0.45) {
            of_law!(&law, law => check_derivatives(law, |g, v| law.energy(g, v)));
        }
    }

    #[test]
    fn stress_is_the_derivative_of_the_energy() {
        for spec in [
            CurveSpec::Skin {},
            CurveSpec::Adipose {},
            CurveSpec::Linear { modulus_kpa: 10.0 },
            CurveSpec::Exponential { scale_kpa: 0.5, rate: 6.0 },
        ] {
            for law in laws(&spec, 0.4) {
                let columns = [[1.3, 0.1, -0.2], [0.05, 0.9, 0.15], [-0.1, 0.2, 1.1]];
                let stress = law.response(columns).0;
                for (c, r) in (0..9).map(|k| (k / 3, k % 3)) {
                    let moved = |by: f64| {
                        let mut columns = columns;
                        columns[c][r] += by;
                        law.energy_of(columns)
                    };
                    let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                    let error = (stress[c][r] - slope).abs();
                    assert!(error < 2e-4 * stress[0][0].abs(), "{spec:?}: {error:e}");
                }
            }
        }
    }

    /// Patch test: cells of one and of four points under a homogeneous deformation have the closed form's stress.
    #[test]
    fn cells_of_another_law_have_the_stress_of_its_closed_form() {
        let MooneyRivlin { shear, bulk } = MOONEY_RIVLIN;
        let columns = [[1.3, 0.1, -0.2], [0.05, 0.9, 0.15], [-0.1, 0.2, 1.1]];
        let f = DMat3::from_cols(columns[0].into(), columns[1].into(), columns[2].into());
        let (j, c) = (f.determinant(), f.transpose() * f);
        let (i1, inverse) = (c.x_axis.x + c.y_axis.y + c.z_axis.z, f.inverse().transpose());
        let i2 = j
            * j
            * (inverse.x_axis.length_squared()
                + inverse.y_axis.length_squared()
                + inverse.z_axis.length_squared());
        let first = (f - inverse * (i1 / 3.0)) * j.powf(-2.0 / 3.0);
        let second = (f * i1 - f * c - inverse * (2.0 / 3.0 * i2)) * j.powf(-4.0 / 3.0);
        let expected = (first * (1.0 - BETA) + second * BETA) * shear + inverse * (bulk * j.ln());
        let slope = 0.7;
        let mut linear = columns;
        (0..3).for_each(|k| linear[k][k] -= 1.0);
        linear[2] = scale(linear[2], 1.0 / slope);
        let modes = Modes { linear, ..Modes::default() };
        let variation = Variation::new(slope);
        let sides = Upright { slope };
        for forces in [
            cell::center(&MOONEY_RIVLIN, &modes, &Plain { sides, variation }, 0.0),
            cell::four_points(&MOONEY_RIVLIN, &modes, &sides, 1.0, 0.0),
        ] {
            for (k, factor) in [1.0, 1.0, slope].into_iter().enumerate() {
                let error = (DVec3::from(forces.linear[k]) - expected.col(k) * factor).length();
                assert!(error < 5e-5 * shear, "{k}: {error:e}");
            }
        }
    }

    #[test]
    fn uniaxial_stretch_is_that_of_its_invariants() {
        for k in 1..1500 {
            let stretch = (f64::from(k) * 1e-3).exp();
            let i1 = stretch * stretch + 2.0 / stretch;
            let i2 = 2.0 * stretch + 1.0 / (stretch * stretch);
            let (g, _) = uniaxial((1.0 - BETA) * (i1 - 3.0) + BETA * (i2 - 3.0));
            let expected = 1.5_f64.sqrt() * stretch.ln();
            assert!((g.sqrt() - expected).abs() < 1e-6 * expected, "{stretch}");
        }
    }
}

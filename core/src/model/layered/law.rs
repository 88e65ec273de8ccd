//! Solid tissue: a hyperelastic isotropic law of the strain invariants, without principal directions.
//!
//! With C = FᵀF, J = √det C, Ī₁ = J^(−2/3) tr C, Ī₂ = J^(−4/3) tr cof C and K = (1−β)(Ī₁−3) + β(Ī₂−3), the stretch
//! λ_u(K) ≥ 1 is the isochoric uniaxial stretch of the same K, and g = 3/2·ln²λ_u.
//!
//! * Equivalent logarithmic strain e² = g/(1+ν) + ln²J/(3(1−2ν)),
//! * energy per rest volume W = Ψ(exp(e) − 1), Ψ′ = Ef,
//! * nominal stress P = ∂W/∂F = sec·(½∂g/∂F/(1+ν) + ln J/(3(1−2ν) J)·cof F), sec = W′(e)/e.
//!
//! Uniaxial tension gives the nominal stress Ef(λ−1) and the transverse logarithmic strain −ν·ln λ exactly, for every
//! curve and ν < ½: at an axial logarithmic strain l the minimum of e over the transverse strain t is at t = −νl, where
//! e = l.
//!
//! β = 0.2 from the equibiaxial stress of rubber (L. R. G. Treloar, Trans. Faraday Soc. 40, 1944) predicted from the
//! uniaxial curve: β = 0 is 9–22 % low, β = 0.2 −4 to +2 %, a law of the logarithmic strain up to 50 % high.
//!
//! One source for f64 and for four f32 lanes.

use crate::mesh::vec3::{add, cross, dot, scale, sub};
use crate::number::Real;
use crate::number::dual::Dual;
use crate::springs::Material;
use crate::springs::table::{Buckets, Table, Weight};
use glam::{DMat3, DVec3};

/// Part of the second invariant in K \[-\].
const BETA: f64 = 0.2;
/// Poisson ratio above which the law uses this one: the stiffness to a change of volume grows as 1/(1−2ν).
pub(crate) const MAX_POISSON_RATIO: f64 = 0.495;
/// Poisson ratio up to which multigrid meets the whole stiffness to a change of volume; above, that of this ratio and the
/// rest as an augmented pressure, renewed after every cycle.
const AUGMENTED_ABOVE: f64 = 0.455;
/// J below which the change of volume counts as this J \[-\].
pub(crate) const LEAST_VOLUME: f64 = 0.05;
/// e below which sec′/e is damped \[-\]; the vectors that the quotient multiplies vanish there.
const SMALL_STRAIN: f64 = 1e-3;

/// Three columns.
pub type Matrix<R> = [[R; 3]; 3];

/// The law of one tissue. `T` has the table of sec against e.
#[derive(Clone, Debug)]
pub struct SolidLaw<R: Real, T> {
    secant: T,
    /// End of the table; beyond it Ef = slope·ε + offset.
    end: R,
    line_slope: R,
    line_offset: R,
    /// 1/(1+ν).
    pub(crate) shear: R,
    /// κ₀, stiffness to a change of volume: κ = 1/(3(1−2ν)), or less with an augmented pressure.
    pub(crate) bulk: R,
    /// 1/κ.
    compliance: R,
    /// 1 − κ₀/κ.
    renewal: R,
}

/// 1/(3(1−2ν)).
fn bulk(poisson_ratio: f64) -> f64 {
    1.0 / (3.0 * (1.0 - 2.0 * poisson_ratio))
}

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

impl SolidLaw<f64, Table> {
    pub fn new(material: &Material) -> Self {
        let curve = &material.curve;
        let table_end = curve.table_end();
        let end = table_end.ln_1p();
        let mut breaks: Vec<f64> = curve.breaks().map(f64::ln_1p).filter(|b| *b < end).collect();
        breaks.sort_by(f64::total_cmp);
        let secant = |e: f64| {
            let per_strain = if e > 1e-12 { e.exp_m1() / e } else { 1.0 };
            curve.secant(e.exp_m1()) * per_strain * e.exp()
        };
        let nu = material.poisson_ratio.min(MAX_POISSON_RATIO);
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

    /// Is the tissue nearly incompressible, so that multigrid needs an augmented pressure?
    pub(crate) fn is_augmented(&self) -> bool {
        self.bulk > bulk(AUGMENTED_ABOVE) * (1.0 + 1e-9)
    }

    /// The law in other numbers, its stresses times `factor`; nearly incompressible tissue with an augmented pressure.
    pub(crate) fn scaled<R: Real>(&self, factor: f64) -> SolidLaw<R, Buckets<R>> {
        let kept = if self.is_augmented() { bulk(AUGMENTED_ABOVE) } else { self.bulk };
        SolidLaw {
            secant: self.secant.buckets(factor),
            end: R::splat(self.end),
            line_slope: R::splat(self.line_slope * factor),
            line_offset: R::splat(self.line_offset * factor),
            shear: R::splat(self.shear),
            bulk: R::splat(kept),
            compliance: R::splat(self.compliance),
            renewal: R::splat(1.0 - kept / self.bulk),
        }
    }

    /// W(e) \[kPa\].
    pub fn energy(&self, equivalent: f64) -> f64 {
        if equivalent <= self.end {
            return self.secant.integral(equivalent);
        }
        let (to, from) = (equivalent.exp_m1(), self.end.exp_m1());
        let over = to - from;
        self.secant.integral(self.end)
            + over * (self.line_offset + 0.5 * self.line_slope * (to + from))
    }

    /// The nominal stress of a homogeneous deformation, in columns \[kPa\], and e.
    pub fn response(&self, columns: Matrix<f64>) -> (Matrix<f64>, f64) {
        let deformed = Deformed::new(columns);
        let shape = deformed.isochoric();
        let log = deformed.log_volume();
        let pi = self.pressure(log, 0.0);
        let equivalent = self.equivalent(shape.g, pi);
        let secant = self.secant(equivalent);
        let pressure = secant * per_volume(pi, deformed.volume);
        (deformed.stress(&shape, secant * self.shear, pressure), equivalent)
    }
}

impl<R: Real, T: AsRef<Buckets<R>>> SolidLaw<R, T> {
    /// π = κ₀ ln J + p, the pressure per sec times J; `augmented` is p.
    #[inline(always)]
    pub(crate) fn pressure(&self, log_volume: R, augmented: R) -> R {
        self.bulk * log_volume + augmented
    }

    /// The augmented pressure whose fixed point is π = κ ln J: (1 − κ₀/κ)·π.
    #[inline(always)]
    pub(crate) fn renewed(&self, pi: R) -> R {
        self.renewal * pi
    }

    /// e of g and π: e² = g/(1+ν) + π²/κ.
    #[inline(always)]
    pub(crate) fn equivalent(&self, g: R, pi: R) -> R {
        (g * self.shear + pi * pi * self.compliance).sqrt()
    }

    /// W′(e)/e.
    #[inline(always)]
    pub(crate) fn secant(&self, e: R) -> R {
        let inside = self.secant.as_ref().value(e);
        let beyond = e.is_above(self.end);
        if R::is_any(beyond) { R::select(beyond, self.line(e), inside) } else { inside }
    }

    /// W′(e)/e and the quotient of its slope and e.
    #[inline(always)]
    pub(crate) fn secant_and_bend(&self, e: R) -> (R, R) {
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

impl<R: Real> Deformed<R> {
    #[inline(always)]
    pub(crate) fn new(columns: Matrix<R>) -> Self {
        let [x, y, z] = columns;
        let cofactors = [cross(y, z), cross(z, x), cross(x, y)];
        Self { columns, cofactors, volume: dot(x, cofactors[0]) }
    }

    #[inline(always)]
    pub(crate) fn log_volume(&self) -> R {
        log_volume(self.volume)
    }

    #[inline(always)]
    pub(crate) fn isochoric(&self) -> Isochoric<R> {
        let [x, y, z] = self.columns;
        let metric = [dot(x, x), dot(x, y), dot(x, z), dot(y, y), dot(y, z), dot(z, z)];
        let [p, q, r] = self.cofactors;
        let (i1, i2) = (metric[0] + metric[3] + metric[5], dot(p, p) + dot(q, q) + dot(r, r));
        // J^(−1/3).
        let root = (self.log_volume() * R::splat(-1.0 / 3.0)).exp();
        let (two, four) = (root * root, root * root * root * root);
        let (first, second) = (R::splat(1.0 - BETA) * two, R::splat(BETA) * four);
        let (i1_bar, i2_bar) = (first * i1, second * i2);
        let k = (i1_bar + i2_bar - R::splat(3.0)).max(R::default());
        let (g, slope) = uniaxial(k);
        let inverse = R::splat(1.0) / self.volume.max(R::splat(LEAST_VOLUME));
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
pub(crate) struct Slopes([DMat3; 6]);

impl Slopes {
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

/// The derivative of the stress `shear`·½∂g/∂F + Π·cof F by F, where Π is `pressure`, and `bulk`·ln J/J more.
pub(crate) fn stress_slopes(columns: Matrix<f64>, shear: f64, bulk: f64, pressure: f64) -> Slopes {
    let variable = |c: usize, r: usize| Dual::<9>::variable(columns[c][r], 3 * c + r);
    let deformed = Deformed::new([0, 1, 2].map(|c| [0, 1, 2].map(|r| variable(c, r))));
    let of_volume = Dual::splat(pressure)
        + Dual::splat(bulk) * per_volume(deformed.log_volume(), deformed.volume);
    let stress = deformed.stress(&deformed.isochoric(), Dual::splat(shear), of_volume);
    let part = |p: usize, q: usize| {
        let column = |c: usize| DVec3::from([0, 1, 2].map(|r| stress[p][r].slopes[3 * q + c]));
        DMat3::from_cols(column(0), column(1), column(2))
    };
    Slopes([part(0, 0), part(0, 1), part(0, 2), part(1, 1), part(1, 2), part(2, 2)])
}

/// The sum of columns times numbers.
#[inline(always)]
pub(crate) fn combined<R: Real>([x, y, z]: Matrix<R>, [p, q, r]: [R; 3]) -> [R; 3] {
    add(add(scale(x, p), scale(y, q)), scale(z, r))
}

#[inline(always)]
pub(crate) fn log_volume<R: Real>(volume: R) -> R {
    volume.max(R::splat(LEAST_VOLUME)).ln()
}

/// π/J: Π per sec.
#[inline(always)]
pub(crate) fn per_volume<R: Real>(pi: R, volume: R) -> R {
    pi / volume.max(R::splat(LEAST_VOLUME))
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
    use crate::curve::{Curve, CurveSpec};

    fn material(spec: &CurveSpec, poisson_ratio: f64) -> Material {
        Material { curve: Curve::new(spec).unwrap(), poisson_ratio, thickness_mm: 1.0 }
    }

    fn curves() -> [CurveSpec; 4] {
        [
            CurveSpec::Skin {},
            CurveSpec::Adipose {},
            CurveSpec::Linear { modulus_kpa: 10.0 },
            CurveSpec::Exponential { scale_kpa: 0.5, rate: 6.0 },
        ]
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

    /// A block pulled at one end has the curve's nominal stress, and the sides are free of stress at −ν·ln λ.
    #[test]
    fn uniaxial_tension_returns_the_curve_and_the_poisson_ratio() {
        for spec in curves() {
            for poisson_ratio in [0.0, 0.2, 1.0 / 3.0, 0.45, 0.48, 0.495] {
                let material = material(&spec, poisson_ratio);
                let law = SolidLaw::new(&material);
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

    #[test]
    fn stress_is_the_derivative_of_the_energy() {
        for spec in curves() {
            let law = SolidLaw::new(&material(&spec, 0.4));
            let columns = [[1.3, 0.1, -0.2], [0.05, 0.9, 0.15], [-0.1, 0.2, 1.1]];
            let energy = |columns| {
                let deformed = Deformed::new(columns);
                let pi = law.pressure(deformed.log_volume(), 0.0);
                law.energy(law.equivalent(deformed.isochoric().g, pi))
            };
            let stress = law.response(columns).0;
            for c in 0..3 {
                for r in 0..3 {
                    let moved = |by: f64| {
                        let mut columns = columns;
                        columns[c][r] += by;
                        energy(columns)
                    };
                    let slope = (moved(1e-5) - moved(-1e-5)) / 2e-5;
                    let error = (stress[c][r] - slope).abs();
                    assert!(error < 2e-4 * stress[0][0].abs(), "{spec:?}: {error:e}");
                }
            }
        }
    }
}

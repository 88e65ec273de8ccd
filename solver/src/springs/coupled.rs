//! The coupled springs: the tension of a spring depends on all springs of its triangle.
//!
//! After the idea of H. Delingette, "Triangular springs for modeling nonlinear membranes",
//! IEEE TVCG 14(2), 2008: the three lengths of a triangle give its metric C, U = √C, the Biot
//! strain E = U − I. With
//!
//! * equivalent strain ē² = \[(1−ν) E:E + ν (tr E)²\] / (1−ν²) = (ε₁² + ε₂² + 2ν ε₁ε₂) / (1−ν²),
//! * energy per reference area W = Σ h Ψ(ē), Ψ′ = Ef,
//! * Biot stress T = Ef(ē)/ē · \[(1−ν) E + ν tr(E) I\] / (1−ν²),
//!
//! uniaxial tension gives the stress Ef(ε) and the transverse strain −νε exactly and in every
//! direction; W is convex in E because Ef increases. A membrane wrinkles instead of being compressed: the law is a tension
//! field ([`relaxed`]).
//!
//! The reference: [`biot_stress`] and [`principal_response`], from the curve itself. [`CoupledLaw`]: a stack of layers
//! with tables, by principal strains here, by invariants in `closed_form`.
//!
//! Uses `curve`, `number`. Used by `model`, `measure`, the lab.

use super::Material;
use super::closed_form::{Change, Group, GroupNumbers, Stretch};
use super::table::{Buckets, Table, Weight};
use crate::curve::Curve;
use crate::number::Real;

/// Equivalent strain ē \[-\] of the principal Biot strains ε₁, ε₂ \[-\].
#[inline]
#[must_use]
pub fn equivalent_strain(strain: [f64; 2], poisson_ratio: f64) -> f64 {
    let [a, b] = strain;
    let nu = poisson_ratio;
    ((a * a + b * b + 2.0 * nu * a * b) / (1.0 - nu * nu)).max(0.0).sqrt()
}

/// Principal Biot (nominal) stresses \[kPa\] of the principal Biot strains \[-\].
#[must_use]
pub fn biot_stress(curve: &Curve, poisson_ratio: f64, strain: [f64; 2]) -> [f64; 2] {
    let [a, b] = strain;
    let nu = poisson_ratio;
    let modulus = curve.secant(equivalent_strain(strain, nu)) / (1.0 - nu * nu);
    [modulus * (a + nu * b), modulus * (b + nu * a)]
}

/// Stresses \[kPa\] of the principal Biot strains and their derivatives, from the curve itself: what
/// [`CoupledLaw::response`] reads off its tables, for one layer of thickness 1.
#[must_use]
pub fn principal_response(
    curve: &Curve,
    poisson_ratio: f64,
    strain: [f64; 2],
) -> PrincipalResponse {
    let equivalent = equivalent_strain(strain, poisson_ratio);
    let secant = curve.secant(equivalent);
    // The factor of `bend` in the stiffness vanishes as ē².
    let bend = if equivalent > 1e-9 {
        (curve.slope(equivalent) - secant) / (equivalent * equivalent)
    } else {
        0.0
    };
    PrincipalResponse::of(strain, poisson_ratio, [secant, bend, curve.energy(equivalent)])
}

/// The principal strains at which the law of a tension field is evaluated \[-\]: skin without bending stiffness wrinkles where
/// it would be compressed, and ever finer wrinkles leave no compressive stress (A. C. Pipkin, IMA J. Appl. Math. 36, 1986;
/// D. J. Steigmann, Proc. R. Soc. A 429, 1990). The greater strain is raised to 0, the other to −ν times the greater one: taut
/// as given, wrinkled in uniaxial tension, slack without stress.
#[inline]
#[must_use]
pub fn relaxed(strain: [f64; 2], poisson_ratio: f64) -> [f64; 2] {
    let [a, b] = strain;
    let greater = a.max(b).max(0.0);
    let least = -poisson_ratio * greater;
    if a >= b { [greater, b.max(least)] } else { [a.max(least), greater] }
}

/// [`principal_response`] of a tension field.
#[must_use]
pub fn relaxed_response(curve: &Curve, poisson_ratio: f64, strain: [f64; 2]) -> PrincipalResponse {
    let at = relaxed(strain, poisson_ratio);
    principal_response(curve, poisson_ratio, at).relaxed_from(strain, at)
}

/// The law of a stack of bonded layers. Layers of equal ν have the same ē, whatever their curves:
/// they are merged into one table.
#[derive(Clone, Debug, PartialEq)]
pub struct CoupledLaw {
    layers: Vec<Merged>,
}

/// Layers of one Poisson ratio.
#[derive(Clone, Debug, PartialEq)]
struct Merged {
    numbers: GroupNumbers,
    /// 1/(1 − ν²).
    plane: f64,
    /// Σ h·Ef(ē)/ē \[kPa·mm\] against ē, up to where every curve is a line.
    group: Group<f64, Table>,
}

/// Tensions of the sheet and their derivatives by the principal strains. All in kPa·mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PrincipalResponse {
    /// Energy per reference area.
    pub energy: f64,
    /// Principal tensions T₁, T₂ (Biot stress times thickness).
    pub tension: [f64; 2],
    /// ∂T₁/∂ε₁, ∂T₁/∂ε₂ = ∂T₂/∂ε₁, ∂T₂/∂ε₂.
    pub stiffness: [f64; 3],
    /// (T₁ − T₂)/(ε₁ − ε₂) = Σ secant/(1+ν): the stiffness against in-plane shear.
    pub shear: f64,
}

impl PrincipalResponse {
    /// Of layers with secant, its slope over ē and energy at these principal strains.
    #[inline]
    fn of([a, b]: [f64; 2], nu: f64, [secant, bend, energy]: [f64; 3]) -> Self {
        let plane = 1.0 / (1.0 - nu * nu);
        // ∂ē/∂ε = t/ē.
        let t = [(a + nu * b) * plane, (b + nu * a) * plane];
        Self {
            energy,
            tension: t.map(|t| secant * t),
            stiffness: [
                secant * plane + bend * t[0] * t[0],
                secant * plane * nu + bend * t[0] * t[1],
                secant * plane + bend * t[1] * t[1],
            ],
            shear: secant / (1.0 + nu),
        }
    }

    /// The response of a tension field at the `given` strains, from that at the relaxed ones: a tension whose strain was
    /// relaxed is zero, and so is its stiffness.
    #[inline]
    #[expect(clippy::float_cmp, reason = "strains that are not relaxed are the given ones")]
    fn relaxed_from(self, given: [f64; 2], relaxed: [f64; 2]) -> Self {
        if relaxed == given {
            return self;
        }
        let [one, coupling, two] = self.stiffness;
        let is_first = given[0] >= given[1];
        let (along, across) = if is_first { (one, two) } else { (two, one) };
        let is_slack = given[0].max(given[1]) <= 0.0;
        let own = if is_slack { 0.0 } else { along - coupling * coupling / across };
        let tension = if is_slack { 0.0 } else { self.tension[usize::from(!is_first)] };
        let (tensions, stiffness) = if is_first {
            ([tension, 0.0], [own, 0.0, 0.0])
        } else {
            ([0.0, tension], [0.0, 0.0, own])
        };
        let shear = if is_slack { 0.0 } else { tension / (given[0] - given[1]).abs() };
        Self { energy: self.energy, tension: tensions, stiffness, shear }
    }
}

impl CoupledLaw {
    /// The law of the given layers, which wrinkle instead of being compressed, each by itself: see [`relaxed`].
    #[must_use]
    pub fn new(layers: &[Material]) -> Self {
        let mut groups: Vec<(f64, Vec<&Material>)> = Vec::new();
        for layer in layers {
            match groups.iter_mut().find(|(nu, _)| nu.to_bits() == layer.poisson_ratio.to_bits()) {
                Some((_, members)) => members.push(layer),
                None => groups.push((layer.poisson_ratio, vec![layer])),
            }
        }
        let merged = |(nu, members): (f64, Vec<&Material>)| Merged::new(nu, &members);
        Self { layers: groups.into_iter().map(merged).collect() }
    }

    /// Number of tables that one triangle reads: different Poisson ratios.
    #[must_use]
    pub fn groups(&self) -> usize {
        self.layers.len()
    }

    /// The closed form in other numbers, its tensions times `scale`.
    pub(crate) fn closed_form<R: Real>(&self, scale: f64) -> Vec<Group<R, Buckets<R>>> {
        let lanes =
            |merged: &Merged| Group::new(merged.numbers, merged.group.secant.buckets(scale), scale);
        self.layers.iter().map(lanes).collect()
    }

    /// The greatest error of a table's stress, relative to its peak stress.
    #[must_use]
    pub fn table_error(&self) -> f64 {
        self.layers.iter().map(|m| m.group.secant.relative_error()).fold(0.0, f64::max)
    }

    /// Tension per small strain \[kPa·mm\], stretched one way and held across: Σ h·Ef′(0)/(1−ν²).
    #[must_use]
    pub fn small_strain_stiffness(&self) -> f64 {
        const STRAIN: f64 = 1e-6;
        let tension = |m: &Merged| {
            let equivalent = m.equivalent_strain([STRAIN, 0.0]);
            m.group.secant_and_slope(equivalent).0 * m.plane * STRAIN
        };
        self.layers.iter().map(tension).sum::<f64>() * 1e6
    }

    /// Energy per reference area \[kPa·mm\] at principal Biot strains.
    #[inline]
    #[must_use]
    pub fn energy(&self, strain: [f64; 2]) -> f64 {
        self.layers.iter().map(|m| m.energy(m.equivalent_strain(m.relaxed(strain)))).sum()
    }

    /// Second Piola–Kirchhoff tension S = \[S₁₁, S₂₂, S₁₂\] \[kPa·mm\] of a metric C = FᵀF, given as
    /// \[C₁₁, C₂₂, C₁₂\] \[-\]; F S is then the first Piola–Kirchhoff tension, which gives nodal forces. In
    /// closed form.
    #[inline]
    #[must_use]
    pub fn second_piola_kirchhoff(&self, [c11, c22, c12]: [f64; 3]) -> [f64; 3] {
        let change = [c11 - 1.0, c22 - 1.0, c12];
        let at = Stretch::of_square(change);
        let tension = |merged: &Merged| merged.group.tension(at, Change::of_square(change));
        let tensions = self.layers.iter().map(tension);
        let [all, q] = tensions.fold([0.0; 2], |[all, q], [one, two]| [all + one, q + two]);
        [all + q * change[1], all + q * change[0], -q * c12]
    }

    /// Tensions and their derivatives at principal Biot strains.
    #[inline]
    #[must_use]
    pub fn response(&self, strain: [f64; 2]) -> PrincipalResponse {
        let mut sum = PrincipalResponse::default();
        for m in &self.layers {
            let at = m.relaxed(strain);
            let equivalent = m.equivalent_strain(at);
            let (secant, slope) = m.group.secant_and_slope(equivalent);
            // The quotient stays finite as ē → 0 because t does.
            let bend = if equivalent > 1e-12 { slope / equivalent } else { 0.0 };
            let nu = m.numbers.poisson_ratio;
            let one = PrincipalResponse::of(at, nu, [secant, bend, m.energy(equivalent)])
                .relaxed_from(strain, at);
            sum.energy += one.energy;
            sum.tension = [0, 1].map(|k| sum.tension[k] + one.tension[k]);
            sum.stiffness = [0, 1, 2].map(|k| sum.stiffness[k] + one.stiffness[k]);
            sum.shear += one.shear;
        }
        sum
    }
}

impl Merged {
    fn new(poisson_ratio: f64, layers: &[&Material]) -> Self {
        let sum = |f: &dyn Fn(&Curve) -> f64| -> f64 {
            layers.iter().map(|layer| layer.thickness_mm * f(&layer.curve)).sum()
        };
        let end = layers.iter().map(|layer| layer.curve.table_end()).fold(0.0, f64::max);
        let mut breaks: Vec<f64> =
            layers.iter().flat_map(|layer| layer.curve.breaks()).filter(|b| *b < end).collect();
        breaks.sort_by(f64::total_cmp);
        let secant =
            Table::new(|e| sum(&|curve| curve.secant(e)), (0.0, end), &breaks, Weight::Argument);
        let line_slope = sum(&|curve| curve.slope(end));
        let line_offset = sum(&|curve| curve.stress(end)) - line_slope * end;
        let numbers = GroupNumbers { poisson_ratio, end, line_slope, line_offset };
        let plane = 1.0 / (1.0 - poisson_ratio * poisson_ratio);
        Self { numbers, plane, group: Group::new(numbers, secant, 1.0) }
    }

    /// The strains at which the law is evaluated.
    #[inline]
    fn relaxed(&self, strain: [f64; 2]) -> [f64; 2] {
        relaxed(strain, self.numbers.poisson_ratio)
    }

    #[inline]
    fn equivalent_strain(&self, [a, b]: [f64; 2]) -> f64 {
        let nu = self.numbers.poisson_ratio;
        ((a * a + b * b + 2.0 * nu * a * b) * self.plane).max(0.0).sqrt()
    }

    #[inline]
    fn energy(&self, equivalent: f64) -> f64 {
        let GroupNumbers { end, line_slope, line_offset, .. } = self.numbers;
        let secant = &self.group.secant;
        if equivalent > end {
            let over = equivalent - end;
            secant.integral(end) + over * (line_offset + 0.5 * line_slope * (equivalent + end))
        } else {
            secant.integral(equivalent)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::{CurveSpec, Interpolation, ScaledCurve, Section};
    use crate::springs::table::TABLE_ERROR;

    fn curves() -> Vec<Curve> {
        let points = vec![[0.0, 0.0], [0.08, 1.0], [0.1, 9.0], [0.55, 9.5], [0.9, 200.0]];
        let points = |interpolation| CurveSpec::Points { points: points.clone(), interpolation };
        [
            CurveSpec::Skin {},
            CurveSpec::Adipose {},
            CurveSpec::Linear { modulus_kpa: 10.0 },
            CurveSpec::Exponential { scale_kpa: 0.5, rate: 12.0 },
            CurveSpec::Arctangent { scale_kpa: 2.0, rate: 60.0 },
            points(Interpolation::Line),
            points(Interpolation::Spline),
            CurveSpec::Sections {
                sections: vec![
                    Section::Polynomial { from: 0.0, to: 0.3, coefficients_kpa: vec![0.1, 50.0] },
                    Section::Sine { from: 0.3, to: 0.5, scale_kpa: 3.0, rate: 5.0 },
                ],
            },
        ]
        .iter()
        .map(|spec| Curve::new(spec).unwrap())
        .collect()
    }

    /// The error of the table is relative to its peak stress: the table of a stack must not reach to the end of a
    /// formula of large strain scale.
    #[test]
    fn a_large_strain_scale_costs_no_accuracy_at_the_strains_of_tissue() {
        let scaled = |spec: CurveSpec, strain_scale| {
            Curve::scaled(&ScaledCurve { strain_scale, ..spec.into() }).unwrap()
        };
        let error = |strain_scale: f64| {
            let (skin, fat) =
                (scaled(CurveSpec::Skin {}, 1.0), scaled(CurveSpec::Adipose {}, strain_scale));
            let layers = [(&skin, 1.5), (&fat, 10.0)];
            let law =
                CoupledLaw::new(&layers.map(|(curve, h)| Material::new(curve.clone(), 0.45, h)));
            let errors = (1..=100).map(|k| {
                let strain = [0.01 * f64::from(k), -0.0045 * f64::from(k)];
                let exact = 1.5 * skin.stress(strain[0]) + 10.0 * fat.stress(strain[0]);
                (law.response(strain).tension[0] / exact - 1.0).abs()
            });
            errors.fold(0.0, f64::max)
        };
        for strain_scale in [1.0, 1.7, 5.0, 20.0] {
            let error = error(strain_scale);
            assert!(error < 2e-3, "{strain_scale}: {error:.1e}");
        }
    }

    #[test]
    fn the_table_is_the_law_within_its_stated_error() {
        for curve in &curves() {
            for poisson_ratio in [0.0, 0.3, 0.5] {
                let law = CoupledLaw::new(&[Material::new(curve.clone(), poisson_ratio, 2.0)]);
                assert!(law.table_error() <= TABLE_ERROR, "{:.1e}", law.table_error());
                let peak = curve.stress(curve.line_start());
                for k in 0..5000 {
                    let t = f64::from(k);
                    let strain = [1.3 * (0.37 * t).sin(), 0.9 * (0.11 * t).cos()];
                    if equivalent_strain(strain, poisson_ratio) > curve.line_start() {
                        continue;
                    }
                    let exact = biot_stress(curve, poisson_ratio, relaxed(strain, poisson_ratio));
                    let table = law.response(strain).tension;
                    for axis in 0..2 {
                        // ν raises a stress to at most 1/(1−ν) of Ef(ē).
                        let error = (table[axis] / 2.0 - exact[axis]).abs();
                        assert!(error <= 2.1 * TABLE_ERROR * peak, "{error:.1e} {strain:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn uniaxial_tension_gives_the_curve_and_the_poisson_ratio() {
        for curve in &curves() {
            for nu in [0.0, 0.1, 0.45, 0.5] {
                for strain in [0.01, 0.2, 0.39, 0.7, 1.0] {
                    let [along, across] = biot_stress(curve, nu, [strain, -nu * strain]);
                    assert!((along / curve.stress(strain) - 1.0).abs() < 1e-12);
                    assert!(across.abs() < 1e-12 * along);
                }
            }
        }
    }

    #[test]
    fn the_closed_form_of_the_tension_is_that_of_the_principal_strains() {
        let curves = curves();
        let layer = |k: usize, nu| Material::new(curves[k].clone(), nu, 1.5);
        let law = CoupledLaw::new(&[layer(0, 0.45), layer(1, 0.3), layer(5, 0.5)]);
        for k in 0..2000 {
            let t = f64::from(k);
            let stretch = [1.6 + 0.9 * (0.37 * t).sin(), 1.3 + 0.8 * (0.11 * t).cos()];
            let (sin, cos) = (0.7 * t).sin_cos();
            // λ² about turned axes, and the tension T/λ about the same axes.
            let turned = |[a, b]: [f64; 2]| {
                [a * cos * cos + b * sin * sin, a * sin * sin + b * cos * cos, (a - b) * sin * cos]
            };
            let tension = law.response(stretch.map(|l| l - 1.0)).tension;
            let expected = turned([tension[0] / stretch[0], tension[1] / stretch[1]]);
            let closed = law.second_piola_kirchhoff(turned(stretch.map(|l| l * l)));
            let scale = tension[0].abs() + tension[1].abs();
            for (a, b) in closed.iter().zip(expected) {
                assert!((a - b).abs() <= 1e-11 * scale, "{closed:?} {expected:?}");
            }
        }
    }

    #[test]
    fn tension_is_the_slope_of_the_energy_and_stiffness_of_the_tension() {
        let curves = curves();
        let layer = |k: usize, nu| Material::new(curves[k].clone(), nu, 1.5);
        let law = CoupledLaw::new(&[layer(0, 0.45), layer(1, 0.3), layer(5, 0.45)]);
        assert_eq!(law.groups(), 2);
        let step = 1e-6;
        for strain in [[0.21, 0.04], [0.6, -0.13], [1.4, 1.1], [0.3, -0.2]] {
            let [a, b] = strain;
            let response = law.response(strain);
            let energy = |a, b| law.energy([a, b]);
            let slopes = [
                (energy(a + step, b) - energy(a - step, b)) / (2.0 * step),
                (energy(a, b + step) - energy(a, b - step)) / (2.0 * step),
            ];
            let tension = |a, b| law.response([a, b]).tension;
            let scale = response.stiffness[0];
            for axis in 0..2 {
                assert!((slopes[axis] - response.tension[axis]).abs() < 1e-6 * scale);
                let along =
                    (tension(a + step, b)[axis] - tension(a - step, b)[axis]) / (2.0 * step);
                let across =
                    (tension(a, b + step)[axis] - tension(a, b - step)[axis]) / (2.0 * step);
                assert!((along - response.stiffness[axis]).abs() < 1e-4 * scale);
                assert!((across - response.stiffness[axis + 1]).abs() < 1e-4 * scale);
            }
            let shear = (response.tension[0] - response.tension[1]) / (a - b);
            assert!((shear / response.shear - 1.0).abs() < 1e-12);
        }
    }
}

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
//! direction; W is convex in E because Ef increases.
//!
//! Uses `curve`, `table`. Used by `solve`, `measure`, `experiment`.

use super::table::{Table, Weight};
use crate::curve::Curve;

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
    let [a, b] = strain;
    let nu = poisson_ratio;
    let plane = 1.0 / (1.0 - nu * nu);
    let equivalent = equivalent_strain(strain, nu);
    let secant = curve.secant(equivalent);
    let t = [(a + nu * b) * plane, (b + nu * a) * plane];
    // The secant's slope over ē; what it is multiplied with vanishes as ē².
    let bend = if equivalent > 1e-9 {
        (curve.slope(equivalent) - secant) / (equivalent * equivalent)
    } else {
        0.0
    };
    PrincipalResponse {
        energy: curve.energy(equivalent),
        tension: t.map(|t| secant * t),
        stiffness: [
            secant * plane + bend * t[0] * t[0],
            secant * plane * nu + bend * t[0] * t[1],
            secant * plane + bend * t[1] * t[1],
        ],
        shear: secant / (1.0 + nu),
    }
}

/// A layer as the law needs it.
#[derive(Clone, Copy, Debug)]
pub struct LawLayer<'a> {
    /// Stress–strain curve.
    pub curve: &'a Curve,
    /// Poisson ratio \[-\].
    pub poisson_ratio: f64,
    /// Thickness \[mm\].
    pub thickness_mm: f64,
}

/// The law of a stack of bonded layers. Layers of equal ν have the same ē, whatever their curves:
/// they are merged into one table.
#[derive(Clone, Debug, PartialEq)]
pub struct CoupledLaw {
    groups: Vec<Group>,
}

/// Layers of one Poisson ratio.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Group {
    pub(crate) poisson_ratio: f64,
    /// 1/(1 − ν²).
    plane: f64,
    /// Σ h·Ef(ē)/ē \[kPa·mm\] against ē, up to where every curve is a line.
    pub(crate) secant: Table,
    /// Beyond it Σ h·Ef = slope·ē + offset.
    pub(crate) line_slope: f64,
    pub(crate) line_offset: f64,
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

impl CoupledLaw {
    /// The law of the given layers.
    #[must_use]
    pub fn new(layers: &[LawLayer]) -> Self {
        let mut groups: Vec<(f64, Vec<LawLayer>)> = Vec::new();
        for layer in layers {
            match groups.iter_mut().find(|(nu, _)| nu.to_bits() == layer.poisson_ratio.to_bits()) {
                Some((_, members)) => members.push(*layer),
                None => groups.push((layer.poisson_ratio, vec![*layer])),
            }
        }
        Self { groups: groups.into_iter().map(|(nu, members)| Group::new(nu, &members)).collect() }
    }

    /// Number of tables that one triangle reads: different Poisson ratios.
    #[must_use]
    pub fn groups(&self) -> usize {
        self.groups.len()
    }

    /// The tables, one a Poisson ratio.
    pub(crate) fn tables(&self) -> impl Iterator<Item = &Group> {
        self.groups.iter()
    }

    /// The greatest error of a table's stress, relative to its peak stress.
    #[must_use]
    pub fn table_error(&self) -> f64 {
        self.groups.iter().map(|g| g.secant.relative_error()).fold(0.0, f64::max)
    }

    /// Energy per reference area \[kPa·mm\] at principal Biot strains.
    #[inline]
    #[must_use]
    pub fn energy(&self, strain: [f64; 2]) -> f64 {
        self.groups.iter().map(|g| g.energy(g.equivalent_strain(strain))).sum()
    }

    /// Principal tensions \[kPa·mm\] and energy per reference area at principal Biot strains.
    #[inline]
    #[must_use]
    pub fn tension_and_energy(&self, strain: [f64; 2]) -> ([f64; 2], f64) {
        let [a, b] = strain;
        let (mut tension, mut energy) = ([0.0; 2], 0.0);
        for group in &self.groups {
            let nu = group.poisson_ratio;
            let equivalent = group.equivalent_strain(strain);
            let modulus = group.secant(equivalent).0 * group.plane;
            tension[0] += modulus * (a + nu * b);
            tension[1] += modulus * (b + nu * a);
            energy += group.energy(equivalent);
        }
        (tension, energy)
    }

    /// Second Piola–Kirchhoff tension S = \[S₁₁, S₂₂, S₁₂\] \[kPa·mm\] of a metric C = FᵀF, given as
    /// \[C₁₁, C₂₂, C₁₂\] \[-\]; F S is then the first Piola–Kirchhoff tension, which gives nodal forces.
    ///
    /// In closed form, without principal directions: with s = √det C, t = tr U = √(tr C + 2s),
    /// E:E = tr C − 2t + 2 and tr E = t − 2 give ē, and with the secant modulus Ef(ē)/ē
    ///
    /// S = Σ h·Ef(ē)/ē · \[I/(1+ν) + (ν(t−1) − 1)/(1−ν²) · U⁻¹\],   U⁻¹ = (adj C + s I)/(t s).
    #[inline]
    #[must_use]
    pub fn second_piola_kirchhoff(&self, [c11, c22, c12]: [f64; 3]) -> [f64; 3] {
        let trace = c11 + c22;
        let s = (c11 * c22 - c12 * c12).max(1e-24).sqrt();
        let t = (trace + 2.0 * s).sqrt();
        let (squares, sum) = ((trace - 2.0 * t + 2.0).max(0.0), t - 2.0);
        let (mut alpha, mut beta) = (0.0, 0.0);
        for group in &self.groups {
            let nu = group.poisson_ratio;
            let squared = ((1.0 - nu) * squares + nu * sum * sum) * group.plane;
            let secant = group.secant(squared.sqrt()).0;
            alpha += secant / (1.0 + nu);
            beta += secant * (nu * (t - 1.0) - 1.0) * group.plane;
        }
        let along = alpha + beta / t;
        let across = beta / (t * s);
        [along + across * c22, along + across * c11, -across * c12]
    }

    /// Tensions and their derivatives at principal Biot strains.
    #[inline]
    #[must_use]
    pub fn response(&self, strain: [f64; 2]) -> PrincipalResponse {
        let [a, b] = strain;
        let mut sum = PrincipalResponse::default();
        for group in &self.groups {
            let nu = group.poisson_ratio;
            let plane = group.plane;
            let equivalent = group.equivalent_strain(strain);
            let (secant, slope) = group.secant(equivalent);
            // ∂ē/∂ε = t/ē; the quotient stays finite as ē → 0 because t does.
            let t = [(a + nu * b) * plane, (b + nu * a) * plane];
            let bend = if equivalent > 1e-12 { slope / equivalent } else { 0.0 };
            sum.energy += group.energy(equivalent);
            sum.tension[0] += secant * t[0];
            sum.tension[1] += secant * t[1];
            sum.stiffness[0] += secant * plane + bend * t[0] * t[0];
            sum.stiffness[1] += secant * plane * nu + bend * t[0] * t[1];
            sum.stiffness[2] += secant * plane + bend * t[1] * t[1];
            sum.shear += secant / (1.0 + nu);
        }
        sum
    }
}

impl Group {
    fn new(poisson_ratio: f64, layers: &[LawLayer]) -> Self {
        let sum = |f: &dyn Fn(&Curve) -> f64| -> f64 {
            layers.iter().map(|layer| layer.thickness_mm * f(layer.curve)).sum()
        };
        let end = layers.iter().map(|layer| layer.curve.line_start()).fold(0.0, f64::max);
        let mut breaks: Vec<f64> =
            layers.iter().flat_map(|layer| layer.curve.breaks()).filter(|b| *b < end).collect();
        breaks.sort_by(f64::total_cmp);
        let secant =
            Table::new(|e| sum(&|curve| curve.secant(e)), (0.0, end), &breaks, Weight::Argument);
        let line_slope = sum(&|curve| curve.slope(end));
        let line_offset = sum(&|curve| curve.stress(end)) - line_slope * end;
        let plane = 1.0 / (1.0 - poisson_ratio * poisson_ratio);
        Self { poisson_ratio, plane, secant, line_slope, line_offset }
    }

    #[inline]
    fn equivalent_strain(&self, [a, b]: [f64; 2]) -> f64 {
        ((a * a + b * b + 2.0 * self.poisson_ratio * a * b) * self.plane).max(0.0).sqrt()
    }

    /// Secant Σ h·Ef(ē)/ē and its slope by ē.
    #[inline]
    fn secant(&self, equivalent: f64) -> (f64, f64) {
        if equivalent > self.secant.end() {
            let share = self.line_offset / equivalent;
            (self.line_slope + share, -share / equivalent)
        } else {
            self.secant.value_and_slope(equivalent)
        }
    }

    #[inline]
    fn energy(&self, equivalent: f64) -> f64 {
        let end = self.secant.end();
        if equivalent > end {
            let over = equivalent - end;
            self.secant.integral(end)
                + over * (self.line_offset + 0.5 * self.line_slope * (equivalent + end))
        } else {
            self.secant.integral(equivalent)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::{CurveSpec, Interpolation, Section};
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

    #[test]
    fn the_table_is_the_law_within_its_stated_error() {
        for curve in &curves() {
            for poisson_ratio in [0.0, 0.3, 0.5] {
                let law = CoupledLaw::new(&[LawLayer { curve, poisson_ratio, thickness_mm: 2.0 }]);
                assert!(law.table_error() <= TABLE_ERROR, "{:.1e}", law.table_error());
                let peak = curve.stress(curve.line_start());
                for k in 0..5000 {
                    let t = f64::from(k);
                    let strain = [1.3 * (0.37 * t).sin(), 0.9 * (0.11 * t).cos()];
                    if equivalent_strain(strain, poisson_ratio) > curve.line_start() {
                        continue;
                    }
                    let exact = biot_stress(curve, poisson_ratio, strain);
                    let (table, _) = law.tension_and_energy(strain);
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
        let layer = |k: usize, poisson_ratio| LawLayer {
            curve: &curves[k],
            poisson_ratio,
            thickness_mm: 1.5,
        };
        let law = CoupledLaw::new(&[layer(0, 0.45), layer(1, 0.3), layer(5, 0.5)]);
        for k in 0..2000 {
            let t = f64::from(k);
            let stretch = [1.6 + 0.9 * (0.37 * t).sin(), 1.3 + 0.8 * (0.11 * t).cos()];
            let (sin, cos) = (0.7 * t).sin_cos();
            // λ² about turned axes, and the tension T/λ about the same axes.
            let turned = |[a, b]: [f64; 2]| {
                [a * cos * cos + b * sin * sin, a * sin * sin + b * cos * cos, (a - b) * sin * cos]
            };
            let (tension, _) = law.tension_and_energy(stretch.map(|l| l - 1.0));
            let expected = turned([tension[0] / stretch[0], tension[1] / stretch[1]]);
            let closed = law.second_piola_kirchhoff(turned(stretch.map(|l| l * l)));
            let scale = tension[0].abs() + tension[1].abs();
            for (a, b) in closed.iter().zip(expected) {
                assert!((a - b).abs() < 1e-11 * scale, "{closed:?} {expected:?}");
            }
        }
    }

    #[test]
    fn tension_is_the_slope_of_the_energy_and_stiffness_of_the_tension() {
        let curves = curves();
        let layer = |k: usize, poisson_ratio| LawLayer {
            curve: &curves[k],
            poisson_ratio,
            thickness_mm: 1.5,
        };
        let law = CoupledLaw::new(&[layer(0, 0.45), layer(1, 0.3), layer(5, 0.45)]);
        assert_eq!(law.groups(), 2);
        let step = 1e-6;
        for strain in [[0.21, 0.04], [0.6, -0.13], [1.4, 1.1], [-0.05, -0.02]] {
            let [a, b] = strain;
            let response = law.response(strain);
            let energy = |a, b| law.energy([a, b]);
            let slopes = [
                (energy(a + step, b) - energy(a - step, b)) / (2.0 * step),
                (energy(a, b + step) - energy(a, b - step)) / (2.0 * step),
            ];
            let tension = |a, b| law.tension_and_energy([a, b]).0;
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

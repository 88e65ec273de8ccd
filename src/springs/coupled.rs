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
struct Group {
    poisson_ratio: f64,
    /// Σ h·Ef(ē)/ē \[kPa·mm\] against ē, up to where every curve is a line.
    secant: Table,
    /// Beyond it Σ h·Ef = slope·ē + offset.
    line_slope: f64,
    line_offset: f64,
}

/// Tensions of the sheet and their derivatives by the principal strains. All in kPa·mm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PrincipalResponse {
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

    /// The greatest error of a table's stress, relative to its peak stress.
    #[must_use]
    pub fn table_error(&self) -> f64 {
        self.groups.iter().map(|g| g.secant.relative_error()).fold(0.0, f64::max)
    }

    /// Energy per reference area \[kPa·mm\] at principal Biot strains.
    #[inline]
    #[must_use]
    pub fn energy(&self, strain: [f64; 2]) -> f64 {
        self.groups.iter().map(|g| g.energy(equivalent_strain(strain, g.poisson_ratio))).sum()
    }

    /// Principal tensions \[kPa·mm\] at principal Biot strains.
    #[inline]
    #[must_use]
    pub fn tension(&self, strain: [f64; 2]) -> [f64; 2] {
        let [a, b] = strain;
        let mut sum = [0.0; 2];
        for group in &self.groups {
            let nu = group.poisson_ratio;
            let modulus = group.secant(equivalent_strain(strain, nu)).0 / (1.0 - nu * nu);
            sum[0] += modulus * (a + nu * b);
            sum[1] += modulus * (b + nu * a);
        }
        sum
    }

    /// Tensions and their derivatives at principal Biot strains.
    #[inline]
    #[must_use]
    pub fn response(&self, strain: [f64; 2]) -> PrincipalResponse {
        let [a, b] = strain;
        let mut sum = PrincipalResponse::default();
        for group in &self.groups {
            let nu = group.poisson_ratio;
            let plane = 1.0 / (1.0 - nu * nu);
            let equivalent = equivalent_strain(strain, nu);
            let (secant, slope) = group.secant(equivalent);
            // ∂ē/∂ε = t/ē; the quotient stays finite as ē → 0 because t does.
            let t = [(a + nu * b) * plane, (b + nu * a) * plane];
            let bend = if equivalent > 1e-12 { slope / equivalent } else { 0.0 };
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
        Self { poisson_ratio, secant, line_slope, line_offset }
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

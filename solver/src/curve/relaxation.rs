//! Stress, slope and energy of a curve whose stress above a strain has relaxed.

use super::Curve;

/// Relaxation of the stress above that of a strain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Relaxation {
    /// The strain \[-\].
    above: f64,
    /// Stress above that of the strain, relative to that of the given curve \[-\].
    factor: f64,
}

impl Curve {
    /// The curve after relaxation: up to a strain ε₀ \[-\] the curve itself, beyond it Ef(ε₀) + `factor` · (Ef(ε) − Ef(ε₀)), the factor
    /// being 0 (excluded) to 1.
    ///
    /// The strain where the curve turns steep ([`Self::knee`]) stays.
    #[must_use]
    pub fn relaxed(self, above: f64, factor: f64) -> Self {
        Self { relaxation: Some(Relaxation { above, factor }), ..self }
    }

    /// The strain of [`Self::relaxed`], if the curve is one.
    pub(super) fn relaxed_above(&self) -> Option<f64> {
        self.relaxation.map(|relaxation| relaxation.above)
    }

    /// Nominal stress \[kPa\] at an engineering strain. Finite for every finite strain.
    #[must_use]
    pub fn stress(&self, strain: f64) -> f64 {
        let stress = self.given_stress(strain);
        match self.relaxation {
            Some(Relaxation { above, factor }) if strain.abs() > above => {
                let kept = self.given_stress(above).copysign(strain);
                kept + factor * (stress - kept)
            }
            _ => stress,
        }
    }

    /// Slope dEf/dε \[kPa\]; at a kink the slope of the piece above the kink.
    #[must_use]
    pub fn slope(&self, strain: f64) -> f64 {
        let slope = self.given_slope(strain);
        match self.relaxation {
            Some(Relaxation { above, factor }) if strain.abs() >= above => factor * slope,
            _ => slope,
        }
    }

    /// Strain energy density Ψ(ε) = ∫₀^ε Ef \[kPa\] (even in ε).
    #[must_use]
    pub fn energy(&self, strain: f64) -> f64 {
        let energy = self.given_energy(strain);
        match self.relaxation {
            Some(Relaxation { above, factor }) if strain.abs() > above => {
                let over = strain.abs() - above;
                let kept = self.given_energy(above) + over * self.given_stress(above);
                kept + factor * (energy - kept)
            }
            _ => energy,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::CurveSpec;

    #[test]
    fn only_the_stress_above_the_strain_relaxes() {
        for spec in [CurveSpec::Skin {}, CurveSpec::Exponential { scale_kpa: 2.0, rate: 8.0 }] {
            let given = Curve::new(&spec).unwrap();
            for above in [0.0, 0.04, 0.55, 1.7] {
                let relaxed = given.clone().relaxed(above, 0.4);
                let kept = given.stress(above);
                let mut energy = 0.0;
                for k in 0..2000 {
                    let strain = 0.001 * f64::from(k);
                    let stress = given.stress(strain);
                    let expected =
                        if strain <= above { stress } else { kept + 0.4 * (stress - kept) };
                    assert!((relaxed.stress(strain) - expected).abs() <= 1e-12 * kept.max(stress));
                    let middle = strain + 0.0005;
                    energy += 0.001 * relaxed.stress(middle);
                    let next = relaxed.energy(strain + 0.001);
                    assert!((energy / next - 1.0).abs() < 1e-2, "{strain}: {energy} {next}");
                    let slope =
                        (relaxed.stress(middle + 1e-6) - relaxed.stress(middle - 1e-6)) / 2e-6;
                    assert!((relaxed.slope(middle) / slope - 1.0).abs() < 1e-3, "{strain}");
                }
                assert_eq!(relaxed.knee(), given.knee());
                assert!(relaxed.table_end() >= above);
                let is_break = |strain: f64| strain.to_bits() == above.to_bits();
                assert_eq!(relaxed.breaks().any(is_break), above > 0.0);
            }
        }
    }
}

//! One bonded layer of tissue: curve, Poisson ratio and thickness.

use super::solids::SolidKind;
use crate::curve::Curve;

/// One layer of the sheet.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Stress–strain curve.
    pub curve: Curve,
    /// Poisson ratio \[-\].
    pub poisson_ratio: f64,
    /// Thickness \[mm\].
    pub thickness_mm: f64,
    /// The law of a solid.
    pub solid: SolidKind,
}

impl Material {
    /// A layer with the curve's law.
    #[must_use]
    pub fn new(curve: Curve, poisson_ratio: f64, thickness_mm: f64) -> Self {
        Self { curve, poisson_ratio, thickness_mm, solid: SolidKind::Curve }
    }

    #[cfg(test)]
    pub(crate) fn of(
        spec: &crate::curve::CurveSpec,
        poisson_ratio: f64,
        thickness_mm: f64,
    ) -> Self {
        Self::new(Curve::new(spec).unwrap(), poisson_ratio, thickness_mm)
    }

    /// What determines the law of a solid: all but the thickness.
    pub(crate) fn law(&self) -> (&Curve, f64, SolidKind) {
        let Self { curve, poisson_ratio, thickness_mm: _, solid } = self;
        (curve, *poisson_ratio, *solid)
    }
}

//! One bonded layer of tissue: curve, Poisson ratio and thickness.

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
}

impl Material {
    /// What determines the law of a solid: all but the thickness.
    pub(crate) fn law(&self) -> (&Curve, f64) {
        let Self { curve, poisson_ratio, thickness_mm: _ } = self;
        (curve, *poisson_ratio)
    }
}

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

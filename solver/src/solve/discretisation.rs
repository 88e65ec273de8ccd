//! Estimated error of the discretisation, from the two finest grids of the nested iteration (L. F. Richardson, Phil. Trans. R.
//! Soc. A 210, 1911).
//!
//! The error along the tissue is of second order in the spacing h: a third of the change e = |u_h − u_2h| of the skin. Both grids
//! have the same cells through the thickness, whose error does not change: with cells as high as wide it is about half of the
//! error along the tissue, and it is of second order in the height of the cells:
//!
//! ```text
//! error = e/3 · (1 + ½ (height of a cell/h)²)
//! ```
//!
//! The solution of the coarser grid is a start only, with an error of its own, which adds to e. Against the limit of the
//! axisymmetric reference the estimate of random patients is 0.6 to 2.5 times the error at 33 nodes per side, 0.7 to 3.5 times
//! at 65, 0.5 to 2.0 times at 129; with 1, 2 or 4 cells whatever the spacing 0.6 to 2.6 times at 65. Off centre the error of the
//! start is 3 to 40 times that of the grid at 65 nodes and more: there is no estimate then.

use crate::mesh::Rest;

/// (2² − 1)⁻¹ of Richardson's extrapolation by second order with grids of ratio 2.
const EXTRAPOLATION: f64 = 1.0 / 3.0;
/// Error of cells as high as wide through the thickness relative to their error along the tissue \[-\].
const THROUGH_THICKNESS: f64 = 0.5;

/// The error in the unit of the change of the skin between the two finest grids; `rest` is on the finest grid.
pub(super) fn error(change: f64, rest: &Rest) -> f64 {
    let spacing_mm = rest.sheet().spacing_mm();
    let height_mm = rest.cells().iter().map(|cells| cells.height_mm).fold(0.0, f64::max);
    EXTRAPOLATION * change * (1.0 + THROUGH_THICKNESS * (height_mm / spacing_mm).powi(2))
}

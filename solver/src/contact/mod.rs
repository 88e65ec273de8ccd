//! Obstacles of the tissue, the implant's dome and the chest wall, and contact with both.
//!
//! `half_ball` (the implant's shape: gauge, gradient, curvature, projection, in f64 and for four f32 at a time), `fullness` (its map of heights) | `dome` (the implant in
//! place and its sizes), `lines` (on its surface), `distance` (of a point from it) | `wall` (the same of the chest wall) | `obstacle` (both together) | `lanes` (contact conditions of four nodes) | `active_set` (contact
//! conditions of Newton's method) | `contact_edge` (contact edge between two nodes).
//!
//! Uses `mesh`. Used by `model`, `solve` and all to their right.

pub(crate) mod active_set;
pub(crate) mod contact_edge;
mod distance;
mod dome;
mod fullness;
mod half_ball;
pub(crate) mod lanes;
mod lines;
mod obstacle;
mod wall;

pub use dome::Dome;
pub use fullness::{HALF_ELLIPSOID, dome_volume};
pub use obstacle::Obstacle;
pub use wall::Wall;

/// Distance from dome or wall up to which a node of a solution is in contact \[base radius\]: well above the
/// rounding of either precision, well below any tolerance.
pub(crate) const TOUCH: f64 = 1e-6;
/// [`TOUCH`] inside of an iteration in f64, whose active nodes are exactly on the surface \[base radius\].
pub(crate) const TOUCH_F64: f64 = 1e-9;
/// [`TOUCH`] inside of an iteration in f32, as a gauge \[-\].
pub(crate) const TOUCH_F32: f64 = 3e-6;

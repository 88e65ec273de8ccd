//! Obstacles of the tissue, the implant's dome and the chest wall, and contact with both.
//!
//! `shape` (shapes of implants, and the map to their place over the wall) | `dome` (the implant in place), `lines` (on its surface), `volume` (over the wall), `distance`
//! (of a point from it) | `wall` (the same of the chest wall) | `obstacle` (both together) | `lanes` (contact conditions of four nodes) | `active_set` (contact
//! conditions of Newton's method) | `contact_edge` (contact edge between two nodes).
//!
//! Uses `mesh`. Used by `model`, `solve` and all to their right.

pub(crate) mod active_set;
pub(crate) mod contact_edge;
mod distance;
mod dome;
pub(crate) mod lanes;
mod lines;
mod obstacle;
mod shape;
mod volume;
mod wall;

pub use dome::Dome;
pub use obstacle::Obstacle;
#[cfg(test)]
pub(crate) use shape::superellipse::Superellipse;
pub(crate) use shape::{Balance, Gel, MODES, Modes, ShapeGauge};
pub use shape::{Deformed, Geometry, HALF_ELLIPSOID, HalfBall, Shape, SoftHalfBall};
pub use wall::Wall;

/// Distance from dome or wall up to which a node of a solution is in contact \[base radius\]: well above the
/// rounding of either precision, well below any tolerance.
pub(crate) const TOUCH: f64 = 1e-6;
/// [`TOUCH`] inside of an iteration in f64, whose active nodes are exactly on the surface \[base radius\].
pub(crate) const TOUCH_F64: f64 = 1e-9;
/// [`TOUCH`] inside of an iteration in f32, as a gauge \[-\].
pub(crate) const TOUCH_F32: f64 = 3e-6;

//! Verification: is the discrete model the model that the equations describe? Every check has a figure and its bound.
//!
//! `check` (a row of the table) | `elements` (cells, membrane and laws under homogeneous states, rotation, gradient) |
//! `solutions` (energy balance, order of convergence, axisymmetric references) | `yielding` (implants that yield).
//!
//! Uses `accuracy`, `axisymmetric_layers`, `measurements::slab` and the core. Used by the
//! command line and the tests.

mod check;
mod elements;
mod solutions;
mod yielding;

pub use check::{Bound, Check, csv, markdown};

use implant_preview_core::scene::SceneError;

/// All checks. `is_quick`: the grids of 33 and 65 nodes per side; else also 129.
///
/// # Errors
/// A curve or a scene is out of its limits.
pub fn all(is_quick: bool) -> Result<Vec<Check>, SceneError> {
    let mut checks = of_elements()?;
    checks.extend(solutions::energy_balance()?);
    checks.extend(solutions::order(is_quick)?);
    checks.extend(solutions::references(if is_quick { &[33, 65] } else { &[33, 65, 129] })?);
    checks.extend(yielding::references()?);
    Ok(checks)
}

/// The checks without a solve.
///
/// # Errors
/// A curve is out of its limits.
pub fn of_elements() -> Result<Vec<Check>, SceneError> {
    elements::checks().map_err(SceneError::CurveFile)
}

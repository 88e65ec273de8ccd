//! The model held against measurements by others, whichever way the difference falls: rubber, skin, fat and expanders.
//!
//! `slab` (homogeneous solids) | `table` (rows, tables and plot of a comparison) | `treloar`, `fat`, `skin_pull`, `expander`
//! (the measurements). Judgements: `docs/validation-measurements.md`.
//!
//! Uses `curve`, `springs`, `model`, `measure`, `scene`, `simulate`. Used by the charts, the command line and the tests.

pub mod expander;
pub mod fat;
pub mod skin_pull;
pub mod slab;
mod table;
pub mod treloar;

pub use table::{Comparison, Mark, PlotAxis, Row, Series, json};

use implant_preview_core::scene::SceneError;

/// All comparisons; scenes on a grid with the given nodes per side.
///
/// # Errors
/// A curve or a scene is out of its limits.
pub fn all(nodes_per_side: usize) -> Result<Vec<Comparison>, SceneError> {
    Ok(vec![
        treloar::comparison().map_err(SceneError::CurveFile)?,
        fat::comparison().map_err(SceneError::CurveFile)?,
        skin_pull::comparison().map_err(SceneError::CurveFile)?,
        expander::pig(nodes_per_side)?,
        expander::filling(nodes_per_side)?,
    ])
}

//! The model held against measurements by others, whichever way the difference falls: rubber, skin, fat, expanders
//! and augmented breasts.
//!
//! `slab` (homogeneous solids) | `table` (rows, tables and plot of a comparison) | `treloar`, `fat`, `skin_pull`, `expander`,
//! `pressure_later`, `augmentation`, `plates`, `hole` (the measurements). Judgements: `docs/validation-measurements.md`.
//!
//! Uses `curve`, `springs`, `model`, `measure`, `scene`, `simulate`. Used by the charts, the command line and the tests.

pub mod augmentation;
pub mod expander;
pub mod fat;
pub mod hole;
pub mod plates;
pub mod pressure_later;
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
    let [projection, in_body] = augmentation::comparisons(nodes_per_side)?;
    Ok(vec![
        treloar::comparison().map_err(SceneError::CurveFile)?,
        fat::comparison().map_err(SceneError::CurveFile)?,
        skin_pull::comparison().map_err(SceneError::CurveFile)?,
        expander::pig(nodes_per_side)?,
        expander::filling(nodes_per_side)?,
        pressure_later::comparison(nodes_per_side)?,
        projection,
        in_body,
        plates::comparison(),
        hole::comparison(),
    ])
}

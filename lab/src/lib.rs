//! Experiments: the paper's tension test of a square sample, stability maps of the homogeneous sheet, the
//! axisymmetric reference solutions of the sheet and of layered tissue, errors of all nodes, the study of run time against
//! error, the comparisons with measurements, the opening plan part by part, verification, robustness tests, and charts.
//!
//! Uses the core and its solver (`curve` … `session`) and the charts' page and panels. No files, no clocks, no toolkit. Used by the
//! command line, the JavaScript API and the tests.

pub mod accuracy;
pub mod axisymmetric;
pub mod axisymmetric_layers;
pub mod charts;
mod dense;
pub mod measurements;
pub mod opening_plan;
pub mod robustness;
pub mod sample;
pub mod stability;
pub mod tension;
pub mod verification;
pub mod work_precision;

use implant_preview_core::measure::{Selection, Status};
use implant_preview_core::scene::{CheckedScene, Scene, SceneError};
use implant_preview_core::simulate::{Simulation, Simulator};
use implant_preview_core::solve::Options;

/// Solves a scene; `None` without convergence.
fn solved(simulator: &mut Simulator, scene: Scene) -> Result<Option<Simulation>, SceneError> {
    let checked = CheckedScene::new(scene)?;
    let found = simulator.run(&checked, Options::default(), &Selection::all(), None);
    Ok((found.outcome.status == Status::Converged).then_some(found))
}

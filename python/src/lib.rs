//! The native part of the Python module: scenes and results are JSON text, numbers of nodes are NumPy arrays.
//!
//! `implant_preview/__init__.py` has the functions that users call. Long calls hold no interpreter lock, and Ctrl+C ends them between
//! two scenes.

mod pool;
mod shape;
mod studies;

use implant_preview_core::measure::Selection;
use implant_preview_core::scene::{self, CheckedScene, Scene};
use implant_preview_core::simulate::{Simulation, Simulator};
use implant_preview_core::solve::Options;
use pyo3::create_exception;
use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use std::time::Instant;

create_exception!(
    implant_preview,
    SceneError,
    PyValueError,
    "A scene or an option that is not allowed: one line with the field, its value and what is allowed."
);

/// An error of one line.
fn refused(error: impl ToString) -> PyErr {
    SceneError::new_err(error.to_string())
}

/// An error of the machine or of the program.
fn failed(error: impl ToString) -> PyErr {
    PyRuntimeError::new_err(error.to_string())
}

/// The fields of a result by their paths; without: all.
fn selection(fields: Option<Vec<String>>) -> PyResult<Selection> {
    fields.map_or_else(|| Ok(Selection::all()), |paths| Selection::of(&paths).map_err(refused))
}

/// Solves the text of a scene, with the solve's time.
fn simulated(
    simulator: &mut Simulator,
    text: &str,
    selection: &Selection,
) -> Result<Simulation, String> {
    let scene = CheckedScene::from_json(text).map_err(|error| error.to_string())?;
    Ok(solved(simulator, &scene, selection))
}

fn solved(simulator: &mut Simulator, scene: &CheckedScene, selection: &Selection) -> Simulation {
    let start = Instant::now();
    let clock = move || start.elapsed().as_secs_f64() * 1e3;
    simulator.run(scene, Options::default(), selection, Some(&clock))
}

/// The text of a value that is always JSON.
fn json(value: &impl serde::Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

#[pymodule]
mod _native {
    #[pymodule_export]
    use super::SceneError;
    #[pymodule_export]
    use super::pool::Pool;
    #[pymodule_export]
    use super::shape::shape;
    #[pymodule_export]
    use super::studies::{bands, map, matrix};
    use super::{PyResult, Python, Scene, Simulator, json, refused, scene, selection, simulated};
    use implant_preview_core::study::Quantity;
    use pyo3::pyfunction;

    #[pyfunction]
    fn solve(py: Python<'_>, scene: &str, fields: Option<Vec<String>>) -> PyResult<String> {
        let selection = selection(fields)?;
        let solve = || simulated(&mut Simulator::default(), scene, &selection);
        let found = py.detach(solve).map_err(refused)?;
        Ok(json(&selection.of_outcome(&found.outcome)))
    }

    #[pyfunction]
    fn default_scene() -> String {
        Scene::default().to_json()
    }

    #[pyfunction]
    fn opening_scene() -> String {
        Scene::opening().to_json()
    }

    #[pyfunction]
    fn schema() -> String {
        scene::schema()
    }

    #[pyfunction]
    fn quantities() -> Vec<String> {
        Quantity::ALL.iter().map(|quantity| quantity.name().to_owned()).collect()
    }

    #[pyfunction]
    fn version() -> &'static str {
        env!("CARGO_PKG_VERSION")
    }
}

//! The native part of the Python module: scenes and results are JSON text, numbers of nodes are NumPy arrays.
//!
//! `implant_preview/__init__.py` has the functions that users call. Long calls hold no interpreter lock, and Ctrl+C ends them at once:
//! all solves run on threads of their own, and the calling thread asks for signals while it waits.

mod body;
mod curve;
mod interrupt;
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
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
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

/// A simulator whose solve ends at a stop.
fn stoppable(stop: Arc<AtomicBool>) -> Simulator {
    let mut simulator = Simulator::default();
    simulator.stop = Some(stop);
    simulator
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
    use super::body::{deform, fit_body, propose_marks, read_body};
    #[pymodule_export]
    use super::curve::curve;
    #[pymodule_export]
    use super::pool::Pool;
    #[pymodule_export]
    use super::shape::shape;
    #[pymodule_export]
    use super::studies::{bands, map, matrix, times};
    use super::{PyResult, Python, Scene, interrupt, json, refused, scene, selection};
    use super::{simulated, stoppable};
    use implant_preview_core::study::Quantity;
    use numpy::{PyArray1, PyArrayMethods};
    use pyo3::{Bound, pyfunction, types::PyModule};

    /// Loads the interface of NumPy, which a pending interrupt would make a panic later.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        let none = PyArray1::<f64>::zeros(module.py(), 0, false);
        none.try_readonly()?;
        Ok(())
    }

    #[pyfunction]
    fn solve(py: Python<'_>, scene: String, fields: Option<Vec<String>>) -> PyResult<String> {
        let selection = selection(fields)?;
        let solve = move |stop| -> Result<String, String> {
            let found = simulated(&mut stoppable(stop), &scene, &selection)?;
            Ok(json(&selection.of_outcome(&found.outcome)))
        };
        interrupt::run(py, solve)?.map_err(refused)
    }

    #[pyfunction]
    fn default_scene() -> String {
        Scene::default().to_json()
    }

    #[pyfunction]
    fn opening_scene() -> String {
        Scene::first_plan().to_json()
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

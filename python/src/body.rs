//! A body's surface: read, marked, fitted, deformed.

use super::{failed, interrupt, json, refused, solved, stoppable};
use implant_preview_core::body::deform::deform as deformed;
use implant_preview_core::body::fit::{Settings, fit};
use implant_preview_core::body::marks::{Marks, Side};
use implant_preview_core::body::propose::propose;
use implant_preview_core::body::read::{self, Unit};
use implant_preview_core::body::surface::Surface;
use implant_preview_core::measure::{Selection, Status};
use implant_preview_core::scene::{self, COVER_MM, CheckedScene, Scene};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The surface of arrays: positions \[mm\], vertices of the triangles.
fn surface(
    positions: &PyReadonlyArray2<'_, f64>,
    triangles: &PyReadonlyArray2<'_, i64>,
) -> PyResult<Surface> {
    let positions: Vec<f64> = positions.as_array().iter().copied().collect();
    let triangles: Vec<i64> = triangles.as_array().iter().copied().collect();
    Surface::of_arrays(&positions, &triangles).map_err(refused)
}

/// Positions as an array of shape (vertices, 3).
fn array<'py>(py: Python<'py>, surface: &Surface) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let flat: Vec<f64> = surface.positions.iter().flat_map(|p| p.to_array()).collect();
    PyArray1::from_vec(py, flat).reshape([surface.positions.len(), 3])
}

#[pyfunction]
pub(crate) fn read_body<'py>(
    py: Python<'py>,
    content: &[u8],
    name: &str,
) -> PyResult<Bound<'py, PyDict>> {
    let found = py.detach(|| read::read(content, name)).map_err(refused)?;
    let answer = PyDict::new(py);
    answer.set_item("positions", array(py, &found.surface)?)?;
    let triangles = found.surface.triangles.as_flattened().to_vec();
    let count = found.surface.triangles.len();
    answer.set_item("triangles", PyArray1::from_vec(py, triangles).reshape([count, 3])?)?;
    answer.set_item("unit", found.unit.name())?;
    answer.set_item("notes", found.cleaned.notes())?;
    Ok(answer)
}

#[pyfunction]
pub(crate) fn propose_marks(
    py: Python<'_>,
    positions: PyReadonlyArray2<'_, f64>,
    triangles: PyReadonlyArray2<'_, i64>,
) -> PyResult<String> {
    let surface = surface(&positions, &triangles)?;
    py.detach(|| propose(&surface)).map(|marks| json(&marks)).map_err(refused)
}

#[pyfunction]
pub(crate) fn fit_body<'py>(
    py: Python<'py>,
    positions: PyReadonlyArray2<'_, f64>,
    triangles: PyReadonlyArray2<'_, i64>,
    marks: &str,
    side: &str,
    cover_mm: f64,
) -> PyResult<Bound<'py, PyDict>> {
    let surface = surface(&positions, &triangles)?;
    let side: Side = side.parse().map_err(refused)?;
    let marks: Marks = scene::read::json(marks, "marks").map_err(refused)?;
    let (least, most) = COVER_MM;
    if !(least..=most).contains(&cover_mm) {
        return Err(refused(format!("cover_mm is {cover_mm}; allowed: {least} to {most} mm")));
    }
    let settings = Settings { cover_mm, ..Settings::default() };
    let fitted = py.detach(|| fit(&surface, &marks, side, &settings)).map_err(refused)?;
    let scene = Scene::of_body(&fitted, (&marks, side), cover_mm, Unit::Mm).map_err(refused)?;
    let quality = PyDict::new(py);
    let found = &fitted.quality;
    for (name, value) in found.figures() {
        quality.set_item(name, value)?;
    }
    quality.set_item("thickness_mm", found.thickness_mm)?;
    quality.set_item("warnings", found.warnings())?;
    let answer = PyDict::new(py);
    answer.set_item("scene", scene.to_json())?;
    answer.set_item("quality", quality)?;
    Ok(answer)
}

#[pyfunction]
pub(crate) fn deform<'py>(
    py: Python<'py>,
    scene: &str,
    positions: PyReadonlyArray2<'_, f64>,
    triangles: PyReadonlyArray2<'_, i64>,
) -> PyResult<Bound<'py, PyDict>> {
    let surface = surface(&positions, &triangles)?;
    let scene = py.detach(|| CheckedScene::from_json(scene)).map_err(refused)?;
    let Some(placement) = scene.scene().placement.as_ref() else {
        return Err(refused(
            "the scene has no member body; allowed: a scene of fit_body or of the command scan",
        ));
    };
    let frame = placement.frame();
    let solve = move |stop| {
        let found = solved(&mut stoppable(stop), &scene, &Selection::all());
        let has_shape =
            found.outcome.status != Status::Unstable && found.solution.report().invalid.is_none();
        let after = has_shape.then(|| deformed(&surface, &frame, &found.solution));
        (found.outcome, after)
    };
    let (outcome, after) = interrupt::run(py, solve)?;
    let Some(after) = after else {
        let why = outcome.warnings.first().map_or("the scene has no stable shape", String::as_str);
        return Err(failed(why));
    };
    let answer = PyDict::new(py);
    answer.set_item("result", json(&outcome))?;
    answer.set_item("positions", array(py, &after)?)?;
    Ok(answer)
}

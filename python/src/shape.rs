//! The deformed shape of a scene: faces, triangles and the fields at their vertices.

use super::{interrupt, json, refused, solved, stoppable};
use implant_preview_core::measure::{Field, Fields, Selection, surfaces};
use implant_preview_core::scene::CheckedScene;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The name of a field of a layer, and the field by the layer's index.
type OfLayer = (&'static str, fn(usize) -> Field);

const OF_LAYERS: [OfLayer; 3] = [
    ("layer_strain", Field::LayerStrain),
    ("thickness_stretch", Field::ThicknessStretch),
    ("stress_kpa", Field::Stress),
];
/// The fields of the sheet or the skin.
const OF_SKIN: [(&str, Field); 7] = [
    ("strain", Field::PrincipalStrain),
    ("area_stretch", Field::AreaStretch),
    ("contact_pressure_kpa", Field::ContactPressure),
    ("cover_mm", Field::Cover),
    ("traction_kpa", Field::Traction),
    ("wrinkle_state", Field::WrinkleState),
    ("wrinkle_strain", Field::WrinkleStrain),
];

#[pyfunction]
pub(crate) fn shape<'py>(py: Python<'py>, scene: &str) -> PyResult<Bound<'py, PyDict>> {
    let scene = py.detach(|| CheckedScene::from_json(scene)).map_err(refused)?;
    let solve = move |stop| {
        let found = solved(&mut stoppable(stop), &scene, &Selection::all());
        let all = surfaces(&found.solution);
        let all = if scene.scene().is_right() { all.mirrored() } else { all };
        (found.outcome, all, Fields::new(found.solution))
    };
    let (outcome, all, fields) = interrupt::run(py, solve)?;
    let answer = PyDict::new(py);
    answer.set_item("result", json(&outcome))?;
    let faces: Vec<f32> = all.positions.iter().flatten().flatten().copied().collect();
    let shape = [all.positions.len(), all.nodes.len(), 3];
    answer.set_item("points", PyArray1::from_vec(py, faces).reshape(shape)?)?;
    let triangles: Vec<u32> = all.triangles.iter().flatten().copied().collect();
    let triangles = PyArray1::from_vec(py, triangles).reshape([all.triangles.len(), 3])?;
    answer.set_item("triangles", triangles)?;
    let at_vertices = |field: Field| -> Option<Vec<f32>> {
        let values = fields.values(field);
        all.nodes.iter().map(|k| values.get(*k as usize).copied()).collect()
    };
    let by_name = PyDict::new(py);
    for (name, field) in OF_SKIN {
        if let Some(values) = at_vertices(field) {
            by_name.set_item(name, PyArray1::from_vec(py, values))?;
        }
    }
    let layers = all.positions.len() - 1;
    for (name, field) in OF_LAYERS {
        let values: Option<Vec<Vec<f32>>> =
            (0..layers).map(|layer| at_vertices(field(layer))).collect();
        if let Some(values) = values {
            let values: Vec<f32> = values.concat();
            let shape = [layers, all.nodes.len()];
            by_name.set_item(name, PyArray1::from_vec(py, values).reshape(shape)?)?;
        }
    }
    answer.set_item("fields", by_name)?;
    Ok(answer)
}

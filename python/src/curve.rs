//! The curve of a raw tensile test.

use super::{json, refused};
use implant_preview_core::tensile::{self, Given, StrainUnit, StressUnit};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;

#[pyfunction]
pub(crate) fn curve<'py>(
    py: Python<'py>,
    content: &[u8],
    unit: Option<&str>,
    strain: Option<&str>,
) -> PyResult<Bound<'py, PyDict>> {
    let stress = unit.map(StressUnit::of_name).transpose().map_err(refused)?;
    let strain = strain.map(StrainUnit::of_name).transpose().map_err(refused)?;
    let found = py.detach(|| tensile::read(content, Given { strain, stress })).map_err(refused)?;
    let form = found.form.map(|form| format!("Table: {form}."));
    let notes: Vec<String> =
        form.into_iter().chain(found.notes.clone()).chain([found.summary()]).collect();
    let answer = PyDict::new(py);
    answer.set_item("curve", json(&found.spec()))?;
    answer.set_item("notes", notes)?;
    answer.set_item("rms_kpa", found.rms_kpa)?;
    let samples = PyArray1::from_vec(py, found.samples.as_flattened().to_vec());
    answer.set_item("samples", samples.reshape([found.samples.len(), 2])?)?;
    Ok(answer)
}

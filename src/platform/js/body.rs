//! A body's surface: read, fitted, deformed.

use super::{SIMULATOR, clock};
use crate::body::deform::deform as deformed;
use crate::body::fit::{Settings, fit};
use crate::body::marks::{Marks, Side};
use crate::body::read::{self, Read, Unit};
use crate::body::surface::Surface;
use crate::measure::{Selection, Status};
use crate::platform::text::text;
use crate::platform::workers::object;
use crate::scene::read::json;
use crate::scene::{COVER_MM, CheckedScene, Scene};
use crate::solve::Options;
use glam::DVec3;
use js_sys::{Float64Array, Uint32Array};
use serde_json::{Map, Value};
use wasm_bindgen::prelude::*;

/// Positions of the vertices \[mm\] as one list.
fn positions(surface: &Surface) -> JsValue {
    let flat: Vec<f64> = surface.positions.iter().flat_map(DVec3::to_array).collect();
    Float64Array::from(flat.as_slice()).into()
}

/// Reads the surface of a body from the bytes of a file (PLY, STL, OBJ, GLB), cleaned; its name decides where the bytes do not.
///
/// Returns an object: `positions` of the vertices \[mm\], three numbers each; `triangles`, three vertices each from 0, counter-clockwise seen from
/// outside; `unit` of the file; `notes`, what was dropped, split or turned.
///
/// # Errors
/// Throws an `Error` of one line for a file that is no surface.
#[wasm_bindgen(
    unchecked_return_type = "{ positions: Float64Array, triangles: Uint32Array, unit: \"mm\" | \"cm\" | \"m\", notes: string[] }"
)]
pub fn read_body(content: &[u8], name: &str) -> Result<JsValue, JsError> {
    let Read { surface, unit, cleaned, .. } = read::read(content, name)?;
    Ok(object([
        ("positions", positions(&surface)),
        ("triangles", Uint32Array::from(surface.triangles.as_flattened()).into()),
        ("unit", unit.name().into()),
        ("notes", cleaned.notes().into()),
    ]))
}

/// Fits a side (`left`, `right`) of a body, in mm, with the marks of a surgeon (JSON text); `cover_mm`: thickness of the tissue beside the
/// breast, 6 to 30. Returns JSON text: `scene`, `quality`.
///
/// # Errors
/// Throws an `Error` of one line: arrays that are no surface, marks that are missing or in a wrong order, a surface without enough chest.
#[wasm_bindgen]
pub fn fit_body(
    coordinates: &[f64],
    triangles: &[u32],
    marks: &str,
    side: &str,
    cover_mm: f64,
) -> Result<String, JsError> {
    let surface = Surface::of_arrays(coordinates, triangles)?;
    let marks: Marks = json(marks, "marks")?;
    let side: Side = side.parse()?;
    let (least, most) = COVER_MM;
    if !(least..=most).contains(&cover_mm) {
        let line = format!("cover_mm is {cover_mm}; allowed: {least} to {most} mm");
        return Err(JsError::new(&line));
    }
    let settings = Settings { cover_mm, ..Settings::default() };
    let fitted = fit(&surface, &marks, side, &settings)?;
    let scene = Scene::of_body(&fitted, (&marks, side), cover_mm, Unit::Mm)?;
    let found = &fitted.quality;
    let figures = found.figures().into_iter().map(|(name, value)| (name.to_owned(), value.into()));
    let mut quality: Map<String, Value> = figures.collect();
    quality.insert("thickness_mm".to_owned(), found.thickness_mm.to_vec().into());
    quality.insert("warnings".to_owned(), found.warnings().into());
    Ok(format!("{{\"scene\":{},\"quality\":{}}}", scene.to_json(), Value::Object(quality)))
}

/// Solves a scene (JSON text) of [`fit_body`] and moves the vertices of its body over the implant. Returns an object: `positions` \[mm\] in the order of
/// those before, `result` (JSON text).
///
/// # Errors
/// Throws an `Error` of one line: an invalid scene, one without a place on a body or without a shape, arrays that are no surface.
#[wasm_bindgen(unchecked_return_type = "{ positions: Float64Array, result: string }")]
pub fn deform(
    #[wasm_bindgen(unchecked_param_type = "string")] scene_json: &JsValue,
    coordinates: &[f64],
    triangles: &[u32],
) -> Result<JsValue, JsError> {
    let surface = Surface::of_arrays(coordinates, triangles)?;
    let scene = CheckedScene::from_json(&text(scene_json, "scene")?)?;
    let Some(placement) = scene.scene().placement.as_ref() else {
        return Err(JsError::new(
            "the scene has no member body; allowed: a scene of fitBody or of the command scan",
        ));
    };
    let found = SIMULATOR.with_borrow_mut(|simulator| {
        simulator.run(&scene, Options::default(), &Selection::all(), Some(&clock()))
    });
    let (outcome, solution) = (found.outcome, found.solution);
    if outcome.status == Status::Unstable || solution.report().invalid.is_some() {
        let why = outcome.warnings.first().map_or("the scene has no stable shape", String::as_str);
        return Err(JsError::new(why));
    }
    let after = deformed(&surface, &placement.frame(), &solution);
    let result = serde_json::to_string(&outcome)?;
    Ok(object([("positions", positions(&after)), ("result", result.into())]))
}

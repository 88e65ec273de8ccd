//! The JavaScript API: for the page, for other pages, for the browser tests.
//!
//! Scenes and results are JSON text, as documented in the README and by [`schema`].

use crate::scene::{self, Scene};
use wasm_bindgen::prelude::*;

/// Solves a scene (JSON text) from scratch; returns the result (JSON text).
///
/// # Errors
/// Throws an `Error` with one line that names the field, what is wrong and what is allowed.
#[wasm_bindgen]
pub fn simulate(scene_json: &str) -> Result<String, JsError> {
    let scene = Scene::from_json(scene_json)?;
    let start = now_ms();
    let mut outcome = scene::simulate(&scene)?;
    outcome.solver.time_ms = Some(now_ms() - start);
    Ok(serde_json::to_string(&outcome)?)
}

/// The scene that the app opens on (JSON text).
#[wasm_bindgen]
#[must_use]
pub fn default_scene() -> String {
    Scene::default().to_json()
}

/// The JSON Schema of a scene (JSON text).
#[wasm_bindgen]
#[must_use]
pub fn schema() -> String {
    scene::schema()
}

/// The version of this package.
#[wasm_bindgen]
#[must_use]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

/// Milliseconds since some moment, in a window or a worker.
fn now_ms() -> f64 {
    js_sys::Reflect::get(&js_sys::global(), &"performance".into())
        .ok()
        .and_then(|performance| performance.dyn_into::<web_sys::Performance>().ok())
        .map_or_else(js_sys::Date::now, |performance| performance.now())
}

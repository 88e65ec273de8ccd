//! The JavaScript API of the page, of other pages and of the browser tests.
//!
//! Scenes and results are JSON text, as documented in `docs/formats.md`.

#[cfg(feature = "js-api")]
mod benchmark;
// The page has its own way to a body.
#[cfg(not(feature = "app"))]
pub mod body;
mod clock;
pub mod studies;

use crate::measure::Selection;
use crate::platform::text::text;
use crate::scene::{CheckedScene, Scene};
use crate::simulate::Simulator;
use crate::solve::Options;
#[cfg(feature = "js-api")]
pub use benchmark::Benchmark;
use clock::clock;
use std::cell::RefCell;
use wasm_bindgen::prelude::*;

thread_local! {
    /// Keeps the grids and tables that the scenes of a page share.
    static SIMULATOR: RefCell<Simulator> = RefCell::default();
}

/// Solves a scene (JSON text) from scratch; returns the result (JSON text).
///
/// # Errors
/// Throws an `Error` with one line that names the field, what is wrong and what is allowed.
#[wasm_bindgen]
pub fn simulate(
    #[wasm_bindgen(unchecked_param_type = "string")] scene_json: &JsValue,
) -> Result<String, JsError> {
    let scene = CheckedScene::from_json(&text(scene_json, "scene")?)?;
    let simulation = SIMULATOR.with_borrow_mut(|simulator| {
        simulator.run(&scene, Options::default(), &Selection::all(), Some(&clock()))
    });
    Ok(serde_json::to_string(&simulation.outcome)?)
}

/// The plan that the app opens on (JSON text).
#[wasm_bindgen]
#[must_use]
pub fn opening_scene() -> String {
    Scene::first_plan().to_json()
}

/// The scene of the defaults (JSON text): a hemisphere under layered tissue.
#[wasm_bindgen]
#[must_use]
pub fn default_scene() -> String {
    Scene::default().to_json()
}

/// The JSON Schema of a scene (JSON text).
#[cfg(feature = "js-api")]
#[wasm_bindgen]
#[must_use]
pub fn schema() -> String {
    crate::scene::schema()
}

/// The version of this package.
#[wasm_bindgen]
#[must_use]
pub fn version() -> String {
    env!("CARGO_PKG_VERSION").to_owned()
}

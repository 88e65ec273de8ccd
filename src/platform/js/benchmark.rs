//! The study of run time against error in the JavaScript API.

use super::clock::clock;
use crate::platform::text::text_or_nothing;
use implant_preview_lab::charts::work_precision::draw;
use implant_preview_lab::work_precision::{Plan, Study, axisymmetric};
use wasm_bindgen::prelude::*;

/// The study of run time against error of the command line's `bench`, in pieces: one method on one grid in
/// one scene per piece. A piece blocks its thread for up to some ten seconds: run the study in a worker.
#[wasm_bindgen]
pub struct Benchmark(Study);

#[wasm_bindgen]
impl Benchmark {
    /// Creates a study. Options (JSON text): `{"quick": true}` for the default scene on coarse grids; the
    /// lists `cases` (names of scenes), `nodes_per_side` (17 to 1025) and `methods` (names) replace the
    /// lists of the quick or the full study. Without options: the full study.
    ///
    /// # Errors
    /// Throws an `Error` with one line that names the field, what is wrong and what is allowed.
    #[wasm_bindgen(constructor)]
    pub fn new(
        #[wasm_bindgen(unchecked_optional_param_type = "string")] options_json: &JsValue,
    ) -> Result<Benchmark, JsError> {
        let plan = text_or_nothing(options_json, "options")?
            .map_or_else(|| Ok(Plan::full()), |json| Plan::from_json(&json))?;
        Ok(Self(Study::new(plan, Some(axisymmetric))))
    }

    /// Measures the next piece with the clock of `performance`. Returns `false` if no piece is left.
    ///
    /// # Errors
    /// Throws if a scene does not allow a grid of the plan.
    pub fn advance(&mut self) -> Result<bool, JsError> {
        Ok(self.0.advance(&mut clock())?)
    }

    /// Number of pieces done, number of all pieces, and the next piece or null (JSON text):
    /// `{"done":0,"all":15,"next":{"scene":"default","nodes_per_side":17,"method":"newton"}}`.
    #[must_use]
    pub fn progress(&self) -> String {
        self.0.progress_json()
    }

    /// The rows measured so far as the table of the command line: times in ms, errors as fractions of the
    /// dome's base radius, work in evaluations of all forces on the finest grid.
    #[must_use]
    pub fn csv(&self) -> String {
        self.0.csv()
    }

    /// The rows measured so far in a scene (by name; default: the study's first scene) as the chart of the
    /// command line (SVG text).
    ///
    /// # Errors
    /// Throws an `Error` of one line for an unknown scene.
    pub fn svg(
        &self,
        #[wasm_bindgen(unchecked_optional_param_type = "string")] scene: &JsValue,
    ) -> Result<String, JsError> {
        let case = self.0.case(text_or_nothing(scene, "scene")?.as_deref())?;
        draw(self.0.rows(), case).map_err(|error| JsError::new(&error.to_string()))
    }

    /// For each piece done so far the time \[ms\] from which on the method stays within an error
    /// (fraction of the dome's base radius) of the grid's own equilibrium, or null (JSON text):
    /// `[{"scene":"default","nodes_per_side":17,"method":"newton","time_ms":1.5}]`.
    #[wasm_bindgen(js_name = timesTo)]
    #[must_use]
    pub fn times_to(&self, error: f64) -> String {
        self.0.times_json(error)
    }
}

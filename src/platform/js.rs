//! The JavaScript API: for the page, for other pages, for the browser tests.
//!
//! Scenes and results are JSON text, as documented in `docs/formats.md` and by [`schema`].

use super::text::{text, text_or_nothing};
use crate::experiment::charts::work_precision::draw;
use crate::experiment::work_precision::{
    Case, Piece, Plan, Row, Study, axisymmetric, table, time_to,
};
use crate::scene::{self, Scene};
use crate::solve::{Progress, Solver};
use serde_json::json;
use wasm_bindgen::prelude::*;

/// Solves a scene (JSON text) from scratch; returns the result (JSON text).
///
/// # Errors
/// Throws an `Error` with one line that names the field, what is wrong and what is allowed.
#[wasm_bindgen]
pub fn simulate(
    #[wasm_bindgen(unchecked_param_type = "string")] scene_json: &JsValue,
) -> Result<String, JsError> {
    let scene = Scene::from_json(&text(scene_json, "scene")?)?;
    let clock = clock();
    let start = clock();
    let mut solver = Solver::new(scene.problem()?);
    while solver.advance(&mut || false) == Progress::Working {}
    let time_ms = clock() - start;
    let mut outcome = scene.measure(&solver);
    outcome.solver.time_ms = Some(time_ms);
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

/// The study of run time against error, as the command line's `bench` makes it, in pieces: one method
/// on one grid in one scene after the other. A piece takes up to some ten seconds in which nothing
/// else happens on its thread: run it in a worker.
#[wasm_bindgen]
pub struct Benchmark {
    study: Study,
    done: Vec<Piece>,
    rows: Vec<Row>,
    /// What is drawn unless another scene is asked for.
    first_scene: Case,
}

#[wasm_bindgen]
impl Benchmark {
    /// A study with everything to do. Options (JSON text): `{"quick": true}` for the default scene on
    /// coarse grids; `cases` (names of scenes), `nodes_per_side` (17 to 1025) and `methods` (names) are
    /// lists that take the place of the quick or the full study's. Without options: the full study.
    ///
    /// # Errors
    /// Throws an `Error` with one line that names the field, what is wrong and what is allowed.
    #[wasm_bindgen(constructor)]
    pub fn new(
        #[wasm_bindgen(unchecked_optional_param_type = "string")] options_json: &JsValue,
    ) -> Result<Benchmark, JsError> {
        let plan = text_or_nothing(options_json, "options")?
            .map_or_else(|| Ok(Plan::full()), |json| Plan::from_json(&json))?;
        let first_scene = plan.cases.first().copied().unwrap_or(Case::Default);
        let study = Study::new(plan, Some(axisymmetric));
        Ok(Self { study, done: Vec::new(), rows: Vec::new(), first_scene })
    }

    /// Does the next piece, against the clock of `performance`. Returns `false` if none was left.
    ///
    /// # Errors
    /// Throws if a scene does not allow a grid of the plan.
    pub fn advance(&mut self) -> Result<bool, JsError> {
        let piece = self.study.next_piece();
        let more = self.study.advance(&mut clock())?;
        self.done.extend(piece);
        let is_piece = more.is_some();
        self.rows.extend(more.into_iter().flatten());
        Ok(is_piece)
    }

    /// Pieces done, of how many, and the next one, or null (JSON text):
    /// `{"done":0,"all":24,"next":{"scene":"default","nodes_per_side":17,"method":"newton"}}`.
    #[must_use]
    pub fn progress(&self) -> String {
        let (done, all) = self.study.progress();
        json!({ "done": done, "all": all, "next": self.study.next_piece() }).to_string()
    }

    /// What was measured so far, as the table that the command line writes: times in ms, errors as
    /// shares of the dome's base radius, work in evaluations of all forces on the finest grid.
    #[must_use]
    pub fn csv(&self) -> String {
        table(&self.rows)
    }

    /// What was measured so far in a scene (its name; else the study's first one) as the picture that
    /// the command line draws (SVG text).
    ///
    /// # Errors
    /// Throws an `Error` of one line for a scene that there is not.
    pub fn svg(
        &self,
        #[wasm_bindgen(unchecked_optional_param_type = "string")] scene: &JsValue,
    ) -> Result<String, JsError> {
        let case = match text_or_nothing(scene, "scene")? {
            None => self.first_scene,
            Some(name) => {
                Case::ALL.into_iter().find(|case| case.name() == name).ok_or_else(|| {
                    let names = Case::ALL.map(Case::name).join(", ");
                    JsError::new(&format!("scene is {name:?}; allowed: {names}"))
                })?
            }
        };
        draw(&self.rows, case).map_err(|error| JsError::new(&error.to_string()))
    }

    /// For each piece done so far the time \[ms\] from which on its method stays within an error
    /// (share of the dome's base radius) of the grid's own equilibrium, or null (JSON text):
    /// `[{"scene":"default","nodes_per_side":17,"method":"newton","time_ms":1.5}]`.
    #[wasm_bindgen(js_name = timesTo)]
    #[must_use]
    pub fn times_to(&self, error: f64) -> String {
        let time = |piece: &Piece| {
            let mut rows: Vec<Row> =
                self.rows.iter().filter(|row| piece.has(row)).copied().collect();
            // A run to a finer tolerance may have been the quicker one.
            rows.sort_by(|a, b| a.time_ms.total_cmp(&b.time_ms));
            json!({
                "scene": piece.scene,
                "nodes_per_side": piece.nodes_per_side,
                "method": piece.method,
                "time_ms": time_to(&rows, error),
            })
        };
        self.done.iter().map(time).collect::<serde_json::Value>().to_string()
    }
}

/// Milliseconds since some moment, in a window or a worker.
fn clock() -> impl Fn() -> f64 {
    let performance = js_sys::Reflect::get(&js_sys::global(), &"performance".into())
        .ok()
        .and_then(|performance| performance.dyn_into::<web_sys::Performance>().ok());
    move || performance.as_ref().map_or_else(js_sys::Date::now, web_sys::Performance::now)
}

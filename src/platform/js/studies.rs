//! Studies of the JavaScript API: many scenes, maps and bands, computed in the workers of the page.
//!
//! Each function returns its handle `{ cancel(), done }` at once.

use crate::platform::text::text;
use crate::platform::workers::{Runner, Workers, object, runner};
use crate::scene::{Scene, read};
use crate::study::{Bands, BandsSettings, Cases, Map, MapOptions, PointFile, Runner as _, Study};
use js_sys::{Function, Promise};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::cell::RefCell;
use std::collections::HashMap;
use std::rc::Rc;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::{JsFuture, spawn_local};

#[wasm_bindgen(module = "/web/studies.js")]
extern "C" {
    #[wasm_bindgen(js_name = simulateMany)]
    fn simulate_in_workers(runner: &Runner, scenes: Vec<String>, on_result: &Function) -> JsValue;
}

/// Solves scenes (JSON text: a list of scenes, or one scene per line) in workers, as many as the machine has cores
/// less one. The workers start with the first call.
///
/// `onResult(index, resultJson)` receives each result as it comes, with the scene's index from 0; a scene without a
/// result has `{"error": LINE}`, and the others go on. Returns `{ cancel(), done }`: the promise `done` resolves after
/// the last result and rejects after `cancel()` with an `AbortError`.
///
/// # Errors
/// Throws an `Error` of one line if the text is not a list of scenes.
#[wasm_bindgen(js_name = simulateMany, unchecked_return_type = "{ cancel(): void, done: Promise<void> }")]
pub fn simulate_many(
    #[wasm_bindgen(unchecked_param_type = "string")] scenes_json: &JsValue,
    #[wasm_bindgen(unchecked_param_type = "(index: number, resultJson: string) => void")]
    on_result: &JsValue,
) -> Result<JsValue, JsError> {
    let texts = read::texts(&text(scenes_json, "scenes")?)?;
    Ok(simulate_in_workers(&runner(), texts, function(on_result, "onResult")?))
}

/// The runner of the page's workers, an object of the class `Runner` of `web/runner.js`, for other ways through many scenes than
/// [`simulate_many`].
#[must_use]
#[wasm_bindgen(unchecked_return_type = "unknown")]
pub fn workers() -> JsValue {
    runner().into()
}

/// Solves a map in workers: one or two numbers of a scene varied over a grid. Options (JSON text): `scene`, `x`, `y`
/// (optional), each `{"field", "from", "to", "count"}`, `grid` (optional: `nodes_per_side`, `tolerance`), and `show`
/// (optional), the quantity of the contour lines.
///
/// `onPoint(pointJson)` receives each point as it comes, from coarse to fine: `i`, `j` (along x and y, from 0), `at` (the
/// values of the axes), `status`, `pocket_radius_mm`, `values` by quantity, `error`. Returns `{ cancel(), done }`: the
/// promise `done` resolves with the map (JSON text) and rejects after `cancel()` with an `AbortError`.
///
/// # Errors
/// Throws an `Error` of one line that names the option, what is wrong and what is allowed.
#[wasm_bindgen(unchecked_return_type = "{ cancel(): void, done: Promise<string> }")]
pub fn map(
    #[wasm_bindgen(unchecked_param_type = "string")] options_json: &JsValue,
    #[wasm_bindgen(unchecked_param_type = "(pointJson: string) => void")] on_point: &JsValue,
) -> Result<JsValue, JsError> {
    let (scene, options): (_, MapOptions) = options(&text(options_json, "options")?)?;
    let map = options.map(&scene)?;
    let on_point = function(on_point, "onPoint")?.clone();
    let (columns, rows) = map.shape();
    let mut is_reported = vec![false; columns * rows];
    let report = move |map: &Map| {
        for (k, is_reported) in is_reported.iter_mut().enumerate() {
            let (i, j) = (k % columns, k / columns);
            if !*is_reported && map.case(i, j).is_some() {
                *is_reported = true;
                let point = Point { i, j, point: map.point(i, j) };
                on_point.call1(&JsValue::NULL, &json(&point))?;
            }
        }
        Ok(())
    };
    Ok(start(map, report, move |map| json(&map.file(options.show, None))))
}

/// Solves the bands of a scene in workers: how a result varies with what is unknown about a person. Options (JSON text):
/// `scene`, and optional `samples`, `seed`, `importance_rows`, `grid`, `unknowns`.
///
/// `onProgress(done, all)` receives the numbers of solved and of all scenes. Returns `{ cancel(), done }`: the promise
/// `done` resolves with the report (JSON text) and rejects after `cancel()` with an `AbortError`.
///
/// # Errors
/// Throws an `Error` of one line that names the option, what is wrong and what is allowed.
#[wasm_bindgen(unchecked_return_type = "{ cancel(): void, done: Promise<string> }")]
pub fn bands(
    #[wasm_bindgen(unchecked_param_type = "string")] options_json: &JsValue,
    #[wasm_bindgen(unchecked_param_type = "(done: number, all: number) => void")]
    on_progress: &JsValue,
) -> Result<JsValue, JsError> {
    let (scene, settings): (_, BandsSettings) = options(&text(options_json, "options")?)?;
    let bands = Bands::new(&scene, settings)?;
    let on_progress = function(on_progress, "onProgress")?.clone();
    let report = move |bands: &Bands| {
        let (done, all) = bands.progress();
        on_progress.call2(&JsValue::NULL, &(done as f64).into(), &(all as f64).into())?;
        Ok(())
    };
    Ok(start(bands, report, |bands| json(&bands.report())))
}

/// A point of a map, as in the map's file.
#[derive(Serialize)]
struct Point {
    i: usize,
    j: usize,
    #[serde(flatten)]
    point: PointFile,
}

/// Reads the scene and the other options of a study.
fn options<T: for<'de> Deserialize<'de>>(text: &str) -> Result<(Scene, T), JsError> {
    let mut options: serde_json::Map<String, Value> = read::json(text, "options")?;
    let scene = options.remove("scene").ok_or_else(|| {
        JsError::new("options: scene is missing; allowed: the scene around which the study varies")
    })?;
    let scene = Scene::from_json(&scene.to_string())?;
    Ok((scene, read::json(&Value::Object(options).to_string(), "options")?))
}

/// Text of a result; a result is always JSON.
fn json(value: &impl Serialize) -> JsValue {
    serde_json::to_string(value).unwrap_or_default().into()
}

/// Returns a function, or an `Error` that names the parameter.
fn function<'a>(value: &'a JsValue, name: &str) -> Result<&'a Function, JsError> {
    let error = || JsError::new(&format!("{name} is not a function; allowed: a function"));
    value.dyn_ref().ok_or_else(error)
}

/// Reports the progress of a study.
type ReportTo<S> = Box<dyn FnMut(&S) -> Result<(), JsValue>>;

/// A study on its way through the workers.
struct Running<S> {
    study: S,
    store: Cases,
    workers: Workers,
    /// Index of the study's job by the index of the workers' job.
    jobs: HashMap<usize, usize>,
    report: ReportTo<S>,
    finish: Box<dyn Fn(&S) -> JsValue>,
    resolve: Function,
    reject: Function,
}

/// Holds a study until its end; empty during a step of the study.
struct Place<S> {
    running: RefCell<Option<Running<S>>>,
    is_cancelled: std::cell::Cell<bool>,
}

/// Starts a study; returns its handle. `report` is called after each job, `finish` returns the study's result.
fn start<S: Study + 'static>(
    study: S,
    report: impl FnMut(&S) -> Result<(), JsValue> + 'static,
    finish: impl Fn(&S) -> JsValue + 'static,
) -> JsValue {
    let place = Rc::new(Place { running: RefCell::default(), is_cancelled: false.into() });
    let workers = Workers::new({
        let place = Rc::clone(&place);
        move || place.advance()
    });
    let mut parts = Some((study, workers, Box::new(report), Box::new(finish)));
    // The promise calls its function at once.
    let done = Promise::new(&mut |resolve, reject| {
        *place.running.borrow_mut() = parts.take().map(|(study, workers, report, finish)| {
            let (store, jobs) = (Cases::default(), HashMap::new());
            Running { study, store, workers, jobs, report, finish, resolve, reject }
        });
    });
    // A caller without use for `done` gets no message in the console.
    let (ignored, first) = (JsFuture::from(done.clone()), Rc::clone(&place));
    spawn_local(async move {
        first.advance();
        let _ = ignored.await;
    });
    let cancel = Closure::<dyn Fn()>::new(move || place.cancel());
    object([("cancel", cancel.into_js_value()), ("done", done.into())])
}

impl<S: Study> Place<S> {
    /// Takes the cases of finished jobs, reports, submits further jobs; ends the study after its last job.
    fn advance(&self) {
        let Some(mut running) = self.running.take() else { return };
        let end = running.step();
        // The receiver of the report may have cancelled the study. A drop of the workers cancels their jobs.
        if self.is_cancelled.get() {
            settle(&running.reject, &abort_error());
            return;
        }
        match end {
            Ok(None) => *self.running.borrow_mut() = Some(running),
            Ok(Some(result)) => settle(&running.resolve, &result),
            Err(error) => settle(&running.reject, &error),
        }
    }

    fn cancel(&self) {
        self.is_cancelled.set(true);
        if let Some(running) = self.running.take() {
            settle(&running.reject, &abort_error());
        }
    }
}

impl<S: Study> Running<S> {
    /// Returns the result at the end of the study.
    fn step(&mut self) -> Result<Option<JsValue>, JsValue> {
        while let Some(finished) = self.workers.poll() {
            if let Some(job) = self.jobs.remove(&finished.index) {
                self.study.receive(job, finished.result.unwrap_or_default(), &mut self.store);
            }
        }
        while self.jobs.len() < 2 * self.workers.workers()
            && let Some((index, job)) = self.study.next_job(&mut self.store)
        {
            self.jobs.insert(self.workers.submit(job), index);
        }
        (self.report)(&self.study)?;
        Ok(self.study.is_done().then(|| (self.finish)(&self.study)))
    }
}

/// Settles a promise.
fn settle(function: &Function, value: &JsValue) {
    // The functions of a promise throw nothing.
    let _ = function.call1(&JsValue::NULL, value);
}

fn abort_error() -> JsValue {
    let error =
        web_sys::DomException::new_with_message_and_name("The study was cancelled.", "AbortError");
    error.map_or_else(|error| error, Into::into)
}

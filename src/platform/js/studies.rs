//! Studies of the JavaScript API: many scenes, maps, bands and times, computed in the workers of the page.
//!
//! Each function returns its handle `{ cancel(), done }` at once.

use crate::platform::text::text;
use crate::platform::workers::{Runner, Workers, object, runner};
use crate::scene::{Scene, read};
use crate::study::{
    Bands, BandsSettings, Cases, Map, MapOptions, PointFile, PointStatus, Runner as _, Study, Times,
};
use js_sys::Function;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::cell::Cell;
use std::collections::HashMap;
use std::future::poll_fn;
use std::rc::Rc;
use std::task::{Poll, Waker};
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::{JsFuture, future_to_promise, spawn_local};

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
/// (optional), each `{"field", "from", "to", "count"}`, `grid` (optional: `nodes_per_side`, `tolerance`), `show`
/// (optional), the quantity of the contour lines, and `all` (optional): solves every point, else up to 70, and interpolates the others.
///
/// `onPoint(pointJson)` receives each point as it comes, from coarse to fine, the interpolated ones at the end: `i`, `j` (along x and y, from 0), `at` (the
/// values of the axes), `status`, `pocket_radius_mm`, `values` by quantity, `source`, `errors` by quantity, `error`. Returns `{ cancel(), done }`: the
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
            if !*is_reported && map.status(i, j) != PointStatus::Waiting {
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
    Ok(start(bands, progress(on_progress)?, |bands| json(&bands.report())))
}

/// Solves a scene of layered tissue (JSON text) in workers, on the table, a week and six months after its operation.
///
/// `onProgress(done, all)` receives the numbers of solved and of all scenes. Returns `{ cancel(), done }`: the promise
/// `done` resolves with the times (JSON text) and rejects after `cancel()` with an `AbortError`.
///
/// # Errors
/// Throws an `Error` of one line that names the field, what is wrong and what is allowed; so for a sheet.
#[wasm_bindgen(unchecked_return_type = "{ cancel(): void, done: Promise<string> }")]
pub fn times(
    #[wasm_bindgen(unchecked_param_type = "string")] scene_json: &JsValue,
    #[wasm_bindgen(unchecked_param_type = "(done: number, all: number) => void")]
    on_progress: &JsValue,
) -> Result<JsValue, JsError> {
    let scene = Scene::from_json(&text(scene_json, "scene")?)?;
    let times = Times::new(&scene).map_err(JsError::new)?;
    Ok(start(times, progress(on_progress)?, |times| json(&times.file())))
}

/// Reports the numbers of solved and of all scenes of a study.
fn progress<S: Study + 'static>(
    on_progress: &JsValue,
) -> Result<impl FnMut(&S) -> Result<(), JsValue> + use<S>, JsError> {
    let on_progress = function(on_progress, "onProgress")?.clone();
    Ok(move |study: &S| {
        let (done, all) = study.progress();
        on_progress.call2(&JsValue::NULL, &(done as f64).into(), &(all as f64).into())?;
        Ok(())
    })
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

/// Where a study waits for its workers or for its end from outside.
#[derive(Default)]
struct Wait {
    is_cancelled: Cell<bool>,
    waker: Cell<Option<Waker>>,
}

impl Wait {
    fn wake(&self) {
        self.waker.take().into_iter().for_each(Waker::wake);
    }
}

/// Starts a study; returns its handle. `report` is called after each job, `finish` returns the study's result.
fn start<S: Study + 'static>(
    study: S,
    report: impl FnMut(&S) -> Result<(), JsValue> + 'static,
    finish: impl Fn(&S) -> JsValue + 'static,
) -> JsValue {
    let wait = Rc::new(Wait::default());
    let woken = Rc::clone(&wait);
    let mut work = Box::pin(run(study, Workers::new(move || woken.wake()), report, finish));
    let waiting = Rc::clone(&wait);
    let done = future_to_promise(poll_fn(move |context| {
        waiting.waker.set(Some(context.waker().clone()));
        let is_cancelled = || waiting.is_cancelled.get();
        let result = if is_cancelled() { Poll::Pending } else { work.as_mut().poll(context) };
        // The receiver of a report may have cancelled the study. A drop of the workers cancels their jobs.
        if is_cancelled() { Poll::Ready(Err(abort_error())) } else { result }
    }));
    // A caller without use for `done` gets no message in the console.
    let ignored = JsFuture::from(done.clone());
    spawn_local(async move { _ = ignored.await });
    let cancel = Closure::<dyn Fn()>::new(move || {
        wait.is_cancelled.set(true);
        wait.wake();
    });
    object([("cancel", cancel.into_js_value()), ("done", done.into())])
}

/// Runs a study to its result.
async fn run<S: Study>(
    mut study: S,
    mut workers: Workers,
    mut report: impl FnMut(&S) -> Result<(), JsValue>,
    finish: impl Fn(&S) -> JsValue,
) -> Result<JsValue, JsValue> {
    // Index of the study's job by the index of the workers' job.
    let (mut jobs, mut store) = (HashMap::new(), Cases::default());
    loop {
        while jobs.len() < 2 * workers.workers()
            && let Some((index, job)) = study.next_job(&mut store)
        {
            jobs.insert(workers.submit(job), index);
        }
        report(&study)?;
        if study.is_done() {
            return Ok(finish(&study));
        }
        let finished = poll_fn(|_| workers.poll().map_or(Poll::Pending, Poll::Ready)).await;
        if let Some(job) = jobs.remove(&finished.index) {
            study.receive(job, finished.result.unwrap_or_default(), &mut store);
        }
    }
}

fn abort_error() -> JsValue {
    let error =
        web_sys::DomException::new_with_message_and_name("The study was cancelled.", "AbortError");
    error.map_or_else(|error| error, Into::into)
}

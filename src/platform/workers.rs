//! Workers of a page: the binding of `web/runner.js`, which starts and replaces workers, and the runner of studies.
//!
//! App and JavaScript API share the page's workers, so that a page has one worker per core less one.

use super::text::text;
use crate::scene::read;
use crate::study::{self, Case, Evaluator, Finished, Job};
use js_sys::{Object, Promise, Reflect};
use std::cell::RefCell;
use std::collections::{BTreeMap, VecDeque};
use std::rc::Rc;
use wasm_bindgen::prelude::*;
use wasm_bindgen_futures::{JsFuture, spawn_local};

// wasm-bindgen's test runner serves a snippet as a script only under a name that ends in .js.
#[wasm_bindgen(module = "/web/runner.js")]
extern "C" {
    /// The runner of the page.
    #[derive(Clone)]
    pub(super) type Runner;

    #[wasm_bindgen(constructor)]
    fn new(options: &JsValue) -> Runner;

    /// Queues a job.
    #[wasm_bindgen(method)]
    fn submit(this: &Runner, job: &JsValue, options: &JsValue) -> Submitted;

    #[wasm_bindgen(method)]
    fn stats(this: &Runner) -> JsValue;

    /// A job in the queue or in a worker.
    pub(super) type Submitted;

    #[wasm_bindgen(method, getter)]
    fn result(this: &Submitted) -> Promise;

    #[wasm_bindgen(method)]
    fn cancel(this: &Submitted);
}

#[wasm_bindgen(module = "/web/job_worker.js")]
extern "C" {
    // The import also puts the script beside `runner.js`.
    #[wasm_bindgen(thread_local_v2, js_name = address)]
    static WORKER: JsValue;
}

#[wasm_bindgen]
extern "C" {
    type Meta;

    #[wasm_bindgen(thread_local_v2, js_namespace = import, js_name = meta)]
    static META: Meta;

    #[wasm_bindgen(method, getter)]
    fn url(this: &Meta) -> JsValue;
}

/// The runner of this page. Its workers compile nothing: they share the compiled program of the page.
pub(super) fn runner() -> Runner {
    thread_local! {
        static RUNNER: Runner = Runner::new(&object([
            ("program", META.with(Meta::url)),
            ("wasm", wasm_bindgen::module()),
            ("address", WORKER.with(Clone::clone)),
        ]));
    }
    RUNNER.with(Clone::clone)
}

/// Creates a JavaScript object with these properties.
pub(super) fn object<const N: usize>(fields: [(&str, JsValue); N]) -> JsValue {
    let object = Object::new();
    for (name, value) in fields {
        // Setting a property of a new object does not fail.
        let _ = Reflect::set(&object, &name.into(), &value);
    }
    object.into()
}

thread_local! {
    static EVALUATOR: RefCell<Evaluator> = RefCell::default();
}

/// Solves the scenes of a study's job (JSON text) in a worker, with the tables and grids of the worker's previous job;
/// returns the cases (JSON text).
///
/// # Errors
/// Throws an `Error` of one line if the text is not a job.
#[wasm_bindgen]
pub fn evaluate(
    #[wasm_bindgen(unchecked_param_type = "string")] job_json: &JsValue,
) -> Result<String, JsError> {
    let job: Job = read::of_any_size(&text(job_json, "job")?, "job")?;
    let cases = EVALUATOR.with_borrow_mut(|evaluator| evaluator.evaluate(&job));
    Ok(serde_json::to_string(&cases)?)
}

/// Runs the jobs of studies in workers, scene by scene.
///
/// A scene that stops two workers has a case with an error. The page cannot wait: `next` is `poll`.
pub struct Workers {
    runner: Option<Runner>,
    wake: Rc<dyn Fn()>,
    submitted: usize,
    state: Rc<RefCell<State>>,
}

/// Unfinished and finished jobs.
#[derive(Default)]
struct State {
    running: BTreeMap<usize, Vec<Submitted>>,
    finished: VecDeque<Finished<Vec<Case>>>,
}

impl Workers {
    /// Creates a runner that calls `wake` after each job; the workers start with the first job.
    #[must_use]
    pub fn new(wake: impl Fn() + 'static) -> Self {
        Self { runner: None, wake: Rc::new(wake), submitted: 0, state: Rc::default() }
    }
}

impl study::Runner for Workers {
    type Job = Job;
    type Done = Vec<Case>;

    fn submit(&mut self, job: Job) -> usize {
        let index = self.submitted;
        self.submitted += 1;
        let runner = self.runner.get_or_insert_with(runner);
        let Job { scenes, .. } = job;
        let choices = Job { scenes: Vec::new(), ..job };
        let scenes = scenes.into_iter().enumerate();
        let tasks: Vec<Submitted> = scenes
            .map(|(k, scene)| {
                let job = Job { scenes: vec![scene], ..choices.clone() };
                submit(runner, &job, &format!("job {index}, scene {k}"))
            })
            .collect();
        // Every promise has its receiver at once: a rejection without one is an error of the page.
        let results: Vec<_> = tasks.iter().map(|task| JsFuture::from(task.result())).collect();
        self.state.borrow_mut().running.insert(index, tasks);
        let (state, wake) = (Rc::clone(&self.state), Rc::clone(&self.wake));
        spawn_local(async move {
            let mut cases = Vec::new();
            for result in results {
                cases.push(case(result.await));
            }
            let is_wanted = state.borrow_mut().running.remove(&index).is_some();
            if is_wanted {
                state.borrow_mut().finished.push_back(Finished { index, result: Ok(cases) });
                wake();
            }
        });
        index
    }

    fn cancel(&mut self, index: usize) {
        let mut state = self.state.borrow_mut();
        state.finished.retain(|finished| finished.index != index);
        state.running.remove(&index).iter().flatten().for_each(Submitted::cancel);
    }

    fn poll(&mut self) -> Option<Finished<Vec<Case>>> {
        self.state.borrow_mut().finished.pop_front()
    }

    fn next(&mut self) -> Option<Finished<Vec<Case>>> {
        self.poll()
    }

    fn workers(&self) -> usize {
        let count = Reflect::get(&runner().stats(), &"workers".into());
        count.ok().and_then(|count| count.as_f64()).map_or(1, |count| count as usize)
    }
}

impl Drop for Workers {
    fn drop(&mut self) {
        let running = std::mem::take(&mut self.state.borrow_mut().running);
        running.values().flatten().for_each(Submitted::cancel);
    }
}

fn submit(runner: &Runner, job: &Job, name: &str) -> Submitted {
    // A job is always JSON: a number that is not finite becomes null, which the worker rejects.
    let job = serde_json::to_string(job).unwrap_or_default();
    let job = object([("kind", "study".into()), ("job", job.into())]);
    runner.submit(&job, &object([("name", name.into())]))
}

/// The case of one scene; a job without a result is a case with an error.
fn case(result: Result<JsValue, JsValue>) -> Case {
    let read = |json: JsValue| {
        let cases = read::of_any_size::<Vec<Case>>(&json.as_string().unwrap_or_default(), "cases");
        let case = cases.map_err(|error| error.to_string())?.pop();
        case.ok_or_else(|| "the worker returned no case".to_owned())
    };
    result.map_err(|error| message(&error)).and_then(read).unwrap_or_else(Case::invalid)
}

/// The message of a JavaScript error.
pub(super) fn message(error: &JsValue) -> String {
    let message = Reflect::get(error, &"message".into()).ok();
    message.and_then(|message| message.as_string()).unwrap_or_else(|| format!("{error:?}"))
}

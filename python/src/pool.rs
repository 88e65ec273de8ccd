//! Scenes on threads, for as long as scenes come.

use super::interrupt::{self, Stop};
use super::{failed, json, selection, simulated};
use implant_preview_core::simulate::Simulator;
use implant_preview_core::study::many::{Many, ManySettings};
use pyo3::prelude::*;
use std::num::NonZeroUsize;
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Mutex};
use std::task::Poll;

/// A scene or its result, or the line of an error.
type Answer = Result<String, String>;

/// The index of a scene from 0, its result or the line of its error.
type Taken = (usize, Option<String>, Option<String>);

/// Threads that solve scenes, of the process that has started them.
#[pyclass(frozen)]
pub(crate) struct Pool {
    process: u32,
    /// `None` only while the pool is dropped.
    running: Option<Running>,
}

struct Running {
    /// A scene, or why an entry is none.
    scenes: Mutex<Option<Sender<Answer>>>,
    answers: Mutex<Many<Answer>>,
    _stop: Stop,
}

impl Drop for Pool {
    /// A forked child has the locks of the threads, but no threads.
    fn drop(&mut self) {
        if self.process != std::process::id() {
            std::mem::forget(self.running.take());
        }
    }
}

impl Pool {
    fn running(&self) -> PyResult<&Running> {
        let (here, process) = (std::process::id(), self.process);
        if here != process {
            return Err(failed(format!(
                "the results belong to process {process}, which has begun them; in process {here} call solve_many again"
            )));
        }
        self.running.as_ref().ok_or_else(|| failed("the pool is closed"))
    }

    fn send(&self, entry: Answer) -> PyResult<()> {
        let scenes = self.running()?.scenes.lock().ok();
        let is_sent = |sender: &Sender<Answer>| sender.send(entry).is_ok();
        let is_open = scenes.as_ref().and_then(|scenes| scenes.as_ref()).is_some_and(is_sent);
        if is_open { Ok(()) } else { Err(failed("the pool is closed")) }
    }
}

/// Greatest number of threads.
const MOST_THREADS: usize = 1024;

/// The threads that a caller wants, up to 1024, else one for each core.
pub(crate) fn threads(wanted: Option<usize>) -> NonZeroUsize {
    let cores = || std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    let wanted = wanted.map(|threads| threads.min(MOST_THREADS));
    wanted.and_then(NonZeroUsize::new).unwrap_or_else(cores)
}

#[pymethods]
impl Pool {
    #[new]
    #[pyo3(signature = (threads, in_order, fields))]
    fn new(threads: Option<usize>, in_order: bool, fields: Option<Vec<String>>) -> PyResult<Self> {
        let selection = selection(fields)?;
        let (sender, receiver) = channel::<Answer>();
        let settings = ManySettings { in_order, ..ManySettings::new(self::threads(threads)) };
        let stop = Stop::default();
        let flag = stop.flag();
        let solve = move |simulator: &mut Simulator, entry: Answer| {
            simulator.stop.get_or_insert_with(|| Arc::clone(&flag));
            let found = simulated(simulator, &entry?, &selection)?;
            Ok(json(&selection.of_outcome(&found.outcome)))
        };
        let answers = Many::new(receiver.into_iter(), settings, solve).map_err(failed)?;
        let (scenes, answers) = (Mutex::new(Some(sender)), Mutex::new(answers));
        let running = Some(Running { scenes, answers, _stop: stop });
        Ok(Self { process: std::process::id(), running })
    }

    /// Queues a scene.
    fn submit(&self, scene: String) -> PyResult<()> {
        self.send(Ok(scene))
    }

    /// Queues the line of an error in the place of an entry that is no scene.
    fn refuse(&self, line: String) -> PyResult<()> {
        self.send(Err(line))
    }

    /// No further scene comes.
    fn finish(&self) -> PyResult<()> {
        if let Ok(mut scenes) = self.running()?.scenes.lock() {
            *scenes = None;
        }
        Ok(())
    }

    /// Waits for a result (JSON text); `None` after the last one.
    fn take(&self, py: Python<'_>) -> PyResult<Option<Taken>> {
        let answers = &self.running()?.answers;
        let wait = |end| answers.lock().map_or(Poll::Ready(None), |mut all| all.next_until(end));
        let Some(finished) = interrupt::next(py, wait)? else { return Ok(None) };
        let answer = finished.result.unwrap_or_else(|panic| Err(panic.to_string()));
        Ok(Some(match answer {
            Ok(result) => (finished.index, Some(result), None),
            Err(line) => (finished.index, None, Some(line)),
        }))
    }
}

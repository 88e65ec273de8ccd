//! Scenes on threads, for as long as scenes come.

use super::{failed, json, selection, simulated};
use implant_preview_core::simulate::Simulator;
use implant_preview_core::study::many::{Many, ManySettings};
use pyo3::prelude::*;
use std::num::NonZeroUsize;
use std::sync::Mutex;
use std::sync::mpsc::{Sender, channel};

/// A result, or the line of an error.
type Answer = Result<String, String>;

/// Threads that solve scenes.
#[pyclass(frozen)]
pub(crate) struct Pool {
    scenes: Mutex<Option<Sender<String>>>,
    answers: Mutex<Many<Answer>>,
}

/// The threads that a caller wants, else one for each core.
pub(crate) fn threads(wanted: Option<usize>) -> NonZeroUsize {
    let cores = || std::thread::available_parallelism().unwrap_or(NonZeroUsize::MIN);
    wanted.and_then(NonZeroUsize::new).unwrap_or_else(cores)
}

#[pymethods]
impl Pool {
    #[new]
    #[pyo3(signature = (threads, in_order, fields))]
    fn new(threads: Option<usize>, in_order: bool, fields: Option<Vec<String>>) -> PyResult<Self> {
        let selection = selection(fields)?;
        let (sender, receiver) = channel::<String>();
        let settings = ManySettings { in_order, ..ManySettings::new(self::threads(threads)) };
        let solve = move |simulator: &mut Simulator, scene: String| {
            let found = simulated(simulator, &scene, &selection)?;
            Ok(json(&selection.of_outcome(&found.outcome)))
        };
        let answers = Many::new(receiver.into_iter(), settings, solve).map_err(failed)?;
        Ok(Self { scenes: Mutex::new(Some(sender)), answers: Mutex::new(answers) })
    }

    /// Queues a scene.
    fn submit(&self, scene: String) -> PyResult<()> {
        let is_sent = |sender: &Sender<String>| sender.send(scene).is_ok();
        let scenes = self.scenes.lock().ok();
        let is_open = scenes.as_ref().and_then(|scenes| scenes.as_ref()).is_some_and(is_sent);
        if is_open { Ok(()) } else { Err(failed("the pool is closed")) }
    }

    /// No further scene comes.
    fn finish(&self) {
        if let Ok(mut scenes) = self.scenes.lock() {
            *scenes = None;
        }
    }

    /// Waits for a result: the scene's index from 0, the result (JSON text) or `None`, and the line of an error or `None`.
    fn take(&self, py: Python<'_>) -> Option<(usize, Option<String>, Option<String>)> {
        let finished = py.detach(|| self.answers.lock().ok()?.next())?;
        let answer = finished.result.unwrap_or_else(|panic| Err(panic.to_string()));
        Some(match answer {
            Ok(result) => (finished.index, Some(result), None),
            Err(line) => (finished.index, None, Some(line)),
        })
    }
}

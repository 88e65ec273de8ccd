//! Work on other threads that a signal of the interpreter ends.

use super::failed;
use implant_preview_core::study::Finished;
use implant_preview_core::study::many::{Many, ManySettings};
use pyo3::prelude::*;
use std::num::NonZeroUsize;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::Poll;
use std::time::{Duration, Instant};

/// Time between two questions for signals.
const BETWEEN: Duration = Duration::from_millis(50);

/// A flag that ends the solves which know it as soon as its owner is dropped, by an interrupt too.
#[derive(Default)]
pub(crate) struct Stop(Arc<AtomicBool>);

impl Stop {
    pub(crate) fn flag(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.0)
    }
}

impl Drop for Stop {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// The next result of threads.
///
/// # Errors
/// The exception of a signal, as of Ctrl+C.
pub(crate) fn next<T: Send + 'static>(
    py: Python<'_>,
    mut wait: impl FnMut(Option<Instant>) -> Poll<Option<Finished<T>>> + Send,
) -> PyResult<Option<Finished<T>>> {
    loop {
        if let Poll::Ready(next) = py.detach(|| wait(Some(Instant::now() + BETWEEN))) {
            return Ok(next);
        }
        py.check_signals()?;
    }
}

/// The result of work on a thread of its own; the work knows a flag that ends it.
///
/// # Errors
/// The exception of a signal, as of Ctrl+C; a defect of the program.
pub(crate) fn run<T: Send + 'static>(
    py: Python<'_>,
    work: impl Fn(Arc<AtomicBool>) -> T + Send + Sync + 'static,
) -> PyResult<T> {
    let stop = Stop::default();
    let settings = ManySettings::new(NonZeroUsize::MIN);
    let work = move |(): &mut (), flag| work(flag);
    let mut one = Many::new(std::iter::once(stop.flag()), settings, work).map_err(failed)?;
    let found = next(py, |end| one.next_until(end))?;
    found.ok_or_else(|| failed("the solve has no result"))?.result.map_err(failed)
}

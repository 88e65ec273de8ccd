//! Runners compute independent jobs: threads natively, workers on the page.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Runs independent jobs and returns the results in the order of completion.
///
/// A drop cancels all jobs that have not begun; the result of a running job is discarded.
pub trait Runner {
    /// Input of a job.
    type Job;
    /// Result of a job.
    type Done;

    /// Queues a job; returns the index of the job, counted from 0.
    fn submit(&mut self, job: Self::Job) -> usize;

    /// Cancels a job: a job that has not begun never runs, the result of a running job is discarded. A job whose result
    /// was read stays as it is.
    fn cancel(&mut self, index: usize);

    /// Returns a finished job, or `None` if no further job has finished.
    fn poll(&mut self) -> Option<Finished<Self::Done>>;

    /// Waits for a finished job; returns `None` if no job is left. A runner that cannot wait returns `None` while jobs
    /// run, as [`Self::poll`].
    fn next(&mut self) -> Option<Finished<Self::Done>>;

    /// Number of jobs that run at the same time: a study keeps about twice as many submitted.
    fn workers(&self) -> usize {
        1
    }
}

/// A finished job.
#[derive(Debug)]
pub struct Finished<T> {
    /// Index of the job in the order of submission, from 0.
    pub index: usize,
    /// Result of the job, or the panic that ended the job.
    pub result: Result<T, JobPanic>,
}

/// The panic of a job, in one line.
#[derive(Debug, thiserror::Error)]
#[error("job {index}: internal error: {message}")]
pub struct JobPanic {
    index: usize,
    message: String,
}

impl JobPanic {
    /// The panic of the job of an index; the message becomes one line.
    #[must_use]
    pub fn new(index: usize, message: &str) -> Self {
        Self { index, message: one_line(message) }
    }

    /// The panic of the job of an index, from what the panic was called with.
    #[must_use]
    pub fn caught(index: usize, payload: &(dyn Any + Send)) -> Self {
        Self { index, message: panic_line(payload) }
    }
}

/// What a panic was called with, in one line.
#[must_use]
pub fn panic_line(payload: &(dyn Any + Send)) -> String {
    let text = payload.downcast_ref::<String>().map(String::as_str);
    one_line(text.or_else(|| payload.downcast_ref::<&str>().copied()).unwrap_or("panic"))
}

/// Runs `work` with what is kept from run to run; after a panic once more, with a new one. The error is the second panic in one
/// line.
///
/// # Errors
/// If both runs panic.
pub fn twice<S: Default, T>(kept: &mut S, work: impl Fn(&mut S) -> T) -> Result<T, String> {
    let mut attempt = || {
        let result = catch_unwind(AssertUnwindSafe(|| work(kept)));
        result.inspect_err(|_| *kept = S::default())
    };
    attempt().or_else(|_| attempt()).map_err(|panic| panic_line(&*panic))
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{Case, Job, evaluate};
    use std::collections::VecDeque;

    /// A runner that computes each job when its result is read.
    #[derive(Default)]
    struct Inline {
        waiting: VecDeque<(usize, Job)>,
        submitted: usize,
    }

    impl Runner for Inline {
        type Job = Job;
        type Done = Vec<Case>;

        fn submit(&mut self, job: Job) -> usize {
            self.waiting.push_back((self.submitted, job));
            self.submitted += 1;
            self.submitted - 1
        }

        fn cancel(&mut self, index: usize) {
            self.waiting.retain(|(waiting, _)| *waiting != index);
        }

        fn poll(&mut self) -> Option<Finished<Vec<Case>>> {
            let (index, job) = self.waiting.pop_front()?;
            Some(Finished { index, result: Ok(evaluate(&job)) })
        }

        fn next(&mut self) -> Option<Finished<Vec<Case>>> {
            self.poll()
        }
    }

    #[test]
    fn a_runner_is_used_as_an_object() {
        let mut runner: Box<dyn Runner<Job = Job, Done = Vec<Case>>> = Box::new(Inline::default());
        assert_eq!([(); 3].map(|()| runner.submit(Job::default())), [0, 1, 2]);
        runner.cancel(1);
        assert_eq!(runner.workers(), 1);
        let indices: Vec<usize> =
            std::iter::from_fn(|| runner.next()).map(|finished| finished.index).collect();
        assert_eq!(indices, [0, 2]);
    }

    #[test]
    fn a_panic_is_one_line() {
        let line = JobPanic::new(3, "a defect\n in two lines").to_string();
        assert_eq!(line, "job 3: internal error: a defect in two lines");
    }

    #[test]
    fn work_that_panics_runs_once_more_from_scratch_and_is_then_an_error() {
        let attempts = std::cell::Cell::new(0);
        let panics = |until: usize| {
            attempts.set(0);
            let mut kept = vec![7];
            let done = twice(&mut kept, |kept| {
                attempts.set(attempts.get() + 1);
                assert!(attempts.get() > until, "a defect\nin two lines");
                kept.clone()
            });
            (done, attempts.get())
        };
        assert_eq!(panics(0), (Ok(vec![7]), 1));
        assert_eq!(panics(1), (Ok(Vec::new()), 2));
        assert_eq!(panics(2), (Err("a defect in two lines".to_owned()), 2));
    }
}

//! Runners compute independent jobs: [`Threads`] natively, `web/runner.mjs` in workers of the page.
//!
//! The unit of work is a solve: [`crate::simulate::run`] on a [`crate::scene::CheckedScene`].

use std::collections::VecDeque;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

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

    /// Returns a finished job, or `None` if no further job has finished.
    fn poll(&mut self) -> Option<Finished<Self::Done>>;

    /// Waits for a finished job; returns `None` if no job is left.
    fn next(&mut self) -> Option<Finished<Self::Done>>;

    /// Runs jobs; returns the results in the order of the jobs.
    ///
    /// # Errors
    /// If a job panics. The other jobs are cancelled by the drop of the runner.
    fn run_all(
        mut self,
        jobs: impl IntoIterator<Item = Self::Job>,
    ) -> Result<Vec<Self::Done>, JobPanic>
    where
        Self: Sized,
    {
        let mut results = Vec::new();
        for job in jobs {
            let index = self.submit(job);
            results.resize_with(index + 1, || None);
        }
        while let Some(Finished { index, result }) = self.next() {
            results[index] = Some(result?);
        }
        Ok(results.into_iter().flatten().collect())
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

/// Runs jobs on rayon's threads.
///
/// The number of started jobs with unread results is bounded: a consumer that reads result by result
/// holds a few results at a time. `next` blocks its thread; the thread must not be one of rayon's.
pub struct Threads<J, T> {
    // Started jobs have a weak reference: a drop of the runner cancels started jobs that do not run yet.
    work: Arc<dyn Fn(J) -> T + Send + Sync>,
    waiting: VecDeque<J>,
    submitted: usize,
    unread: usize,
    sender: Sender<Finished<T>>,
    receiver: Receiver<Finished<T>>,
}

/// Greatest number of started jobs with unread results, per thread: one job runs, one is ready.
const UNREAD_PER_THREAD: usize = 2;

impl<J: Send + 'static, T: Send + 'static> Threads<J, T> {
    /// Creates a runner whose jobs are arguments of `work`.
    pub fn new(work: impl Fn(J) -> T + Send + Sync + 'static) -> Self {
        let (sender, receiver) = channel();
        let (waiting, submitted, unread) = (VecDeque::new(), 0, 0);
        Self { work: Arc::new(work), waiting, submitted, unread, sender, receiver }
    }

    /// Starts waiting jobs, up to the limit of unread results.
    fn start(&mut self) {
        while self.unread < UNREAD_PER_THREAD * rayon::current_num_threads() {
            let index = self.submitted - self.waiting.len();
            let Some(job) = self.waiting.pop_front() else { return };
            self.unread += 1;
            let (work, sender) = (Arc::downgrade(&self.work), self.sender.clone());
            rayon::spawn(move || {
                let Some(work) = work.upgrade() else { return };
                let result = catch_unwind(AssertUnwindSafe(|| work(job))).map_err(|payload| {
                    let text = payload.downcast_ref::<String>().map(String::as_str);
                    let text = text.or_else(|| payload.downcast_ref::<&str>().copied());
                    let words: Vec<&str> = text.unwrap_or("panic").split_whitespace().collect();
                    JobPanic { index, message: words.join(" ") }
                });
                // After the drop of the runner a result has no receiver.
                let _ = sender.send(Finished { index, result });
            });
        }
    }

    /// Counts a read result and starts a waiting job.
    fn read(&mut self, finished: Finished<T>) -> Finished<T> {
        self.unread -= 1;
        self.start();
        finished
    }
}

impl<J: Send + 'static, T: Send + 'static> Runner for Threads<J, T> {
    type Job = J;
    type Done = T;

    fn submit(&mut self, job: J) -> usize {
        self.waiting.push_back(job);
        self.submitted += 1;
        self.start();
        self.submitted - 1
    }

    fn poll(&mut self) -> Option<Finished<T>> {
        let finished = self.receiver.try_recv().ok()?;
        Some(self.read(finished))
    }

    fn next(&mut self) -> Option<Finished<T>> {
        if self.unread == 0 {
            return None;
        }
        let finished = self.receiver.recv().ok()?;
        Some(self.read(finished))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn a_panic_is_one_line_and_leaves_the_other_jobs() {
        let mut runner = Threads::new(|job: usize| assert_ne!(job, 1, "a defect\nin two lines"));
        assert_eq!([0, 1, 2].map(|job| runner.submit(job)), [0, 1, 2]);
        let mut finished: Vec<_> = std::iter::from_fn(|| runner.next()).collect();
        finished.sort_by_key(|finished| finished.index);
        let errors = finished.into_iter().map(|finished| finished.result.err());
        let lines: Vec<_> = errors.map(|error| error.map(|error| error.to_string())).collect();
        let line = lines[1].as_deref().unwrap();
        assert!(line.starts_with("job 1: internal error: ") && !line.contains('\n'), "{line}");
        assert!(lines[0].is_none() && lines[2].is_none());
    }

    #[test]
    fn unread_results_are_bounded_and_a_drop_cancels_the_rest() {
        let most = UNREAD_PER_THREAD * rayon::current_num_threads();
        let begun = Arc::new(AtomicUsize::new(0));
        let counter = Arc::clone(&begun);
        let mut runner = Threads::new(move |()| counter.fetch_add(1, Ordering::SeqCst));
        (0..10 * most).for_each(|_| _ = runner.submit(()));
        while begun.load(Ordering::SeqCst) < most {
            std::thread::yield_now();
        }
        while runner.poll().is_none() {}
        drop(runner);
        // The last running job releases the counter.
        while Arc::strong_count(&begun) > 1 {
            std::thread::yield_now();
        }
        assert!(begun.load(Ordering::SeqCst) <= most + 1);
    }
}

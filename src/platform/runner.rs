//! The native runner beside a window: threads. On the page `web/runner.js` runs jobs in workers.

use crate::study::runner::panic_line;
use crate::study::{Case, Evaluator, Finished, Job, JobPanic, Runner};
use rayon::{ThreadPool, ThreadPoolBuilder};
use std::cell::Cell;
use std::collections::{BTreeMap, VecDeque};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

/// Runs jobs on threads of its own, which start with the first job.
///
/// The number of started jobs with unread results is bounded: a consumer that reads result by result
/// holds a few results at a time. `next` blocks its thread.
pub struct Threads<J, T> {
    work: Arc<dyn Fn(J) -> T + Send + Sync>,
    pool: Option<ThreadPool>,
    threads: usize,
    /// Called after each job, by its thread.
    wake: Arc<dyn Fn() + Send + Sync>,
    waiting: VecDeque<(usize, J)>,
    submitted: usize,
    /// Jobs with unread results. A started job has a weak reference: if the strong one is dropped, a job that does not
    /// run yet never runs.
    started: BTreeMap<usize, Arc<()>>,
    sender: Sender<Finished<T>>,
    receiver: Receiver<Finished<T>>,
}

/// Greatest number of started jobs with unread results, per thread: one job runs, one is ready.
const UNREAD_PER_THREAD: usize = 2;

impl<J: Send + 'static, T: Send + 'static> Threads<J, T> {
    /// A runner whose jobs are arguments of `work`, on one thread per core less one, at least one.
    pub fn beside_window(
        work: impl Fn(J) -> T + Send + Sync + 'static,
        wake: Arc<dyn Fn() + Send + Sync>,
    ) -> Self {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let (sender, receiver) = channel();
        let (waiting, started) = (VecDeque::new(), BTreeMap::new());
        let (work, threads) = (Arc::new(work), (cores - 1).max(1));
        Self { work, pool: None, threads, wake, waiting, submitted: 0, started, sender, receiver }
    }

    /// Starts waiting jobs, up to the limit of unread results.
    fn start(&mut self) {
        while self.started.len() < UNREAD_PER_THREAD * self.workers() {
            let Some((index, job)) = self.waiting.pop_front() else { return };
            let token = Arc::new(());
            let is_wanted = Arc::downgrade(&token);
            self.started.insert(index, token);
            let (work, wake) = (Arc::clone(&self.work), Arc::clone(&self.wake));
            let sender = self.sender.clone();
            let run = move || {
                if is_wanted.strong_count() > 0 {
                    let result = catch_unwind(AssertUnwindSafe(|| work(job)))
                        .map_err(|payload| JobPanic::caught(index, &*payload));
                    // After the drop of the runner a result has no receiver.
                    let _ = sender.send(Finished { index, result });
                }
                wake();
            };
            self.spawn(run);
        }
    }

    fn spawn(&mut self, run: impl FnOnce() + Send + 'static) {
        if self.pool.is_none() {
            let pool = ThreadPoolBuilder::new().num_threads(self.threads);
            self.pool = pool.thread_name(|k| format!("job {k}")).build().ok();
        }
        match &self.pool {
            Some(pool) => pool.spawn(run),
            // The system starts no further threads.
            None => rayon::spawn(run),
        }
    }

    /// Counts a read result and starts a waiting job; `None` for the result of a cancelled job.
    fn read(&mut self, finished: Finished<T>) -> Option<Finished<T>> {
        self.started.remove(&finished.index)?;
        self.start();
        Some(finished)
    }
}

impl<J: Send + 'static, T: Send + 'static> Runner for Threads<J, T> {
    type Job = J;
    type Done = T;

    fn submit(&mut self, job: J) -> usize {
        let index = self.submitted;
        self.waiting.push_back((index, job));
        self.submitted += 1;
        self.start();
        index
    }

    fn cancel(&mut self, index: usize) {
        self.waiting.retain(|(waiting, _)| *waiting != index);
        self.started.remove(&index);
        self.start();
    }

    fn poll(&mut self) -> Option<Finished<T>> {
        while let Ok(finished) = self.receiver.try_recv() {
            if let Some(finished) = self.read(finished) {
                return Some(finished);
            }
        }
        None
    }

    fn next(&mut self) -> Option<Finished<T>> {
        while !self.started.is_empty() {
            let finished = self.receiver.recv().ok()?;
            if let Some(finished) = self.read(finished) {
                return Some(finished);
            }
        }
        None
    }

    fn workers(&self) -> usize {
        self.threads
    }
}

/// The runner of the jobs of studies beside a window.
#[cfg(feature = "app")]
#[must_use]
pub fn beside_window(wake: crate::app::Wake) -> Box<crate::app::JobRunner> {
    Box::new(Threads::beside_window(|job: Job| evaluate(&job), wake))
}

thread_local! {
    static EVALUATOR: Cell<Option<Evaluator>> = const { Cell::new(None) };
}

/// Solves the scenes of a job on this thread, with the tables and grids of the thread's previous job. A scene that
/// panics is solved once more from scratch; after a second panic its case is an error in one line.
#[must_use]
pub fn evaluate(job: &Job) -> Vec<Case> {
    job.scenes.iter().map(|scene| twice(|solver| solver.case(scene, job))).collect()
}

fn twice(solve: impl Fn(&mut Evaluator) -> Case) -> Case {
    let attempt = || {
        let mut evaluator = EVALUATOR.take().unwrap_or_default();
        // A panic drops the evaluator.
        let case = catch_unwind(AssertUnwindSafe(|| {
            let case = solve(&mut evaluator);
            (case, evaluator)
        }));
        case.map(|(case, evaluator)| {
            EVALUATOR.set(Some(evaluator));
            case
        })
    };
    attempt().or_else(|_| attempt()).unwrap_or_else(|payload| {
        Case::invalid(format!("internal error, twice: {}", panic_line(&*payload)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::study;
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn runner<J: Send + 'static, T: Send + 'static>(
        work: impl Fn(J) -> T + Send + Sync + 'static,
    ) -> Threads<J, T> {
        Threads::beside_window(work, Arc::new(|| ()))
    }

    #[test]
    fn a_panic_is_one_line_and_leaves_the_other_jobs() {
        let mut runner = runner(|job: usize| assert_ne!(job, 1, "a defect\nin two lines"));
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
        let most = UNREAD_PER_THREAD * runner(|()| ()).workers();
        let begun = Arc::new(AtomicUsize::new(0));
        let counter = Arc::clone(&begun);
        let mut runner = runner(move |()| counter.fetch_add(1, Ordering::SeqCst));
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

    #[test]
    fn a_cancelled_job_has_no_result_and_leaves_the_others() {
        let mut runner = runner(|job: usize| job);
        let count = 4 * UNREAD_PER_THREAD * runner.workers();
        (0..count).for_each(|job| _ = runner.submit(job));
        // A job that may be running or done, and a job that has not begun.
        runner.cancel(0);
        runner.cancel(count - 1);
        runner.cancel(count - 1);
        let mut indices: Vec<_> =
            std::iter::from_fn(|| runner.next()).map(|finished| finished.index).collect();
        indices.sort_unstable();
        assert_eq!(indices, (1..count - 1).collect::<Vec<_>>());
    }

    #[test]
    fn threads_beside_a_window_start_with_the_first_job_and_wake_after_each_job() {
        let (sender, woken) = channel();
        let wake = Arc::new(move || {
            sender.send(std::thread::current().name().map(str::to_owned)).unwrap();
        });
        let mut runner = Threads::beside_window(|job: usize| 2 * job, wake);
        assert!(runner.workers() >= 1);
        assert!(runner.pool.is_none());
        (0..3).for_each(|job| _ = runner.submit(job));
        let mut results = Vec::new();
        for _ in 0..3 {
            assert!(woken.recv().unwrap().unwrap().starts_with("job "));
            // A job waits until a result before is read.
            let finished = std::iter::from_fn(|| runner.poll());
            results.extend(finished.map(|finished| finished.result.unwrap()));
        }
        results.sort_unstable();
        assert_eq!(results, [0, 2, 4]);
    }

    #[test]
    fn a_scene_that_panics_is_solved_once_more_and_then_named() {
        let attempts = Cell::new(0);
        let panics = |until: usize| {
            attempts.set(0);
            twice(|_| {
                attempts.set(attempts.get() + 1);
                assert!(attempts.get() > until, "a defect\nin two lines");
                Case::default()
            })
        };
        assert_eq!((panics(0), attempts.get()), (Case::default(), 1));
        assert_eq!((panics(1), attempts.get()), (Case::default(), 2));
        let line = panics(2).error.unwrap();
        assert_eq!(attempts.get(), 2);
        assert_eq!(line, "internal error, twice: a defect in two lines");
    }

    #[test]
    fn jobs_of_studies_are_evaluated_as_on_one_thread() {
        let mut scene = Scene::default();
        scene.solver.nodes_per_side = 17;
        let mut invalid = scene.clone();
        invalid.pocket_radius_mm = 1.0;
        let job = Job { scenes: vec![scene, invalid], profile: true, full: false };
        let mut runner = runner(|job: Job| evaluate(&job));
        (0..2).for_each(|_| _ = runner.submit(job.clone()));
        let cases: Vec<_> =
            std::iter::from_fn(|| runner.next()).map(|finished| finished.result.unwrap()).collect();
        assert_eq!(cases.len(), 2);
        assert!(cases.iter().all(|cases| *cases == study::evaluate(&job)));
        assert!(cases[0][0].is_converged() && cases[0][1].error.is_some());
    }
}

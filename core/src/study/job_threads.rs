//! The jobs of studies on threads: beside a window that polls, or until an end from outside.

use super::many::{Many, ManySettings};
use super::{Case, Finished, Job, Runner};
use std::collections::BTreeMap;
use std::io;
use std::num::NonZeroUsize;
use std::sync::mpsc::{Sender, channel};
use std::sync::{Arc, Weak};
use std::task::Poll;
use std::time::{Duration, Instant};

/// Time between two questions whether the run is ended.
const BETWEEN: Duration = Duration::from_millis(50);

/// Runs the jobs of studies on threads of its own, in bounded memory.
///
/// An end leaves the study with the cases that were received before ([`run`](super::run)).
pub struct JobThreads<E> {
    jobs: Sender<(Weak<()>, Job)>,
    cases: Many<Vec<Case>>,
    threads: NonZeroUsize,
    submitted: usize,
    /// Jobs with unread cases. A thread has a weak reference: without the strong one it skips the job.
    unread: BTreeMap<usize, Arc<()>>,
    is_ended: E,
}

impl<E: FnMut() -> bool> JobThreads<E> {
    /// Starts threads that run `work`, each with an `S` of its own. No result is taken once `is_ended` returns true, which is
    /// asked before each result and while a job takes long.
    ///
    /// # Errors
    /// If the system starts no thread.
    pub fn new<S: Default>(
        threads: NonZeroUsize,
        work: impl Fn(&mut S, &Job) -> Vec<Case> + Send + Sync + 'static,
        is_ended: E,
    ) -> io::Result<Self> {
        let (jobs, receiver) = channel::<(Weak<()>, Job)>();
        let settings = ManySettings { in_order: false, ..ManySettings::new(threads) };
        let work = move |kept: &mut S, (is_wanted, job): (Weak<()>, Job)| {
            if is_wanted.strong_count() > 0 { work(kept, &job) } else { Vec::new() }
        };
        let cases = Many::new(receiver.into_iter(), settings, work)?;
        Ok(Self { jobs, cases, threads, submitted: 0, unread: BTreeMap::new(), is_ended })
    }

    /// Calls a function after each job, on its thread. Once.
    #[must_use]
    pub fn with_wake(self, wake: impl Fn() + Send + Sync + 'static) -> Self {
        self.cases.wakes(wake);
        self
    }

    /// A function that ends the run from any thread without the result of a running job.
    pub fn canceller(&self) -> impl Fn() + Send + Sync + 'static {
        self.cases.canceller()
    }
}

impl<E: FnMut() -> bool> Runner for JobThreads<E> {
    type Job = Job;
    type Done = Vec<Case>;

    fn submit(&mut self, job: Job) -> usize {
        let (index, token) = (self.submitted, Arc::new(()));
        // The receiver lives as long as the threads.
        let _ = self.jobs.send((Arc::downgrade(&token), job));
        self.unread.insert(index, token);
        self.submitted += 1;
        index
    }

    fn cancel(&mut self, index: usize) {
        self.unread.remove(&index);
    }

    fn poll(&mut self) -> Option<Finished<Vec<Case>>> {
        while let Poll::Ready(Some(finished)) = self.cases.next_until(Some(Instant::now())) {
            if self.unread.remove(&finished.index).is_some() {
                return Some(finished);
            }
        }
        None
    }

    fn next(&mut self) -> Option<Finished<Vec<Case>>> {
        while !self.unread.is_empty() && !(self.is_ended)() {
            if let Poll::Ready(next) = self.cases.next_until(Some(Instant::now() + BETWEEN)) {
                let finished = next?;
                if self.unread.remove(&finished.index).is_some() {
                    return Some(finished);
                }
            }
        }
        None
    }

    fn workers(&self) -> usize {
        self.threads.get()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Field, Scene};
    use crate::study::{Axis, Cases, Evaluator, Map, MapSettings, Parameter, Study, evaluate, run};
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn a_study_that_ends_early_keeps_its_cases() {
        let axis = Axis { field: Parameter::of(Field::Insertion), from: 0.1, to: 1.0, count: 40 };
        let settings = MapSettings { nodes_per_side: 17, tolerance: 1e-2 };
        let map = |most: usize| {
            let mut map = Map::new(&Scene::sheet(), &[axis], settings).unwrap();
            let work = |evaluator: &mut Evaluator, job: &Job| evaluator.evaluate(job);
            let mut taken = 0;
            let is_ended = || {
                taken += 1;
                taken > most
            };
            let mut threads =
                JobThreads::new(NonZeroUsize::new(2).unwrap(), work, is_ended).unwrap();
            run(&mut map, &mut Cases::default(), &mut threads).unwrap();
            map
        };
        let (part, whole) = (map(3), map(usize::MAX));
        let (done, all) = part.progress();
        assert!(done > 0 && done < all && whole.progress() == (all, all), "{done} of {all}");
        for (part, whole) in part.cases().iter().zip(whole.cases()) {
            assert!(part.is_none() || part == whole);
        }
    }

    fn two_threads<S: Default>(
        work: impl Fn(&mut S, &Job) -> Vec<Case> + Send + Sync + 'static,
    ) -> JobThreads<impl FnMut() -> bool> {
        JobThreads::new(NonZeroUsize::new(2).unwrap(), work, || false).unwrap()
    }

    #[test]
    fn a_cancelled_job_has_no_cases_and_leaves_the_others() {
        let mut runner = two_threads(|(): &mut (), _| Vec::new());
        let count = 8;
        (0..count).for_each(|_| _ = runner.submit(Job::default()));
        // A job that may be running or done, and a job that has perhaps not begun.
        runner.cancel(0);
        runner.cancel(count - 1);
        runner.cancel(count - 1);
        let mut indices: Vec<_> =
            std::iter::from_fn(|| runner.next()).map(|finished| finished.index).collect();
        indices.sort_unstable();
        assert_eq!(indices, (1..count - 1).collect::<Vec<_>>());
    }

    #[test]
    fn a_drop_cancels_the_jobs_that_have_not_begun() {
        let begun = Arc::new(AtomicUsize::new(0));
        let (sender, receiver) = channel::<()>();
        let (gate, counter) = (std::sync::Mutex::new(receiver), Arc::clone(&begun));
        let work = move |(): &mut (), _: &Job| {
            counter.fetch_add(1, Ordering::SeqCst);
            let _ = gate.lock().unwrap().recv();
            Vec::new()
        };
        let mut runner = JobThreads::new(NonZeroUsize::MIN, work, || false).unwrap();
        (0..9).for_each(|_| _ = runner.submit(Job::default()));
        while begun.load(Ordering::SeqCst) == 0 {
            std::thread::yield_now();
        }
        drop((runner, sender));
        // The thread releases the counter at its end.
        while Arc::strong_count(&begun) > 1 {
            std::thread::yield_now();
        }
        assert_eq!(begun.load(Ordering::SeqCst), 1);
    }

    #[test]
    fn a_thread_wakes_the_reader_after_each_job() {
        let (sender, woken) = channel();
        let mut runner =
            two_threads(|(): &mut (), _| Vec::new()).with_wake(move || sender.send(()).unwrap());
        (0..3).for_each(|_| _ = runner.submit(Job::default()));
        let mut read = 0;
        for _ in 0..3 {
            woken.recv().unwrap();
            read += std::iter::from_fn(|| runner.poll()).count();
        }
        assert_eq!(read, 3);
        assert!(runner.poll().is_none() && runner.next().is_none());
    }

    #[test]
    fn jobs_are_evaluated_as_on_one_thread() {
        let mut scene = Scene::default();
        scene.solver.nodes_per_side = 17;
        let mut invalid = scene.clone();
        invalid.pocket_radius_mm = 1.0;
        let job = Job { scenes: vec![scene, invalid], profile: true, full: false };
        let mut runner = two_threads(Evaluator::evaluate_guarded);
        (0..2).for_each(|_| _ = runner.submit(job.clone()));
        let cases: Vec<_> =
            std::iter::from_fn(|| runner.next()).map(|finished| finished.result.unwrap()).collect();
        assert_eq!(cases.len(), 2);
        assert!(cases.iter().all(|cases| *cases == evaluate(&job)));
        assert!(cases[0][0].is_converged() && cases[0][1].error.is_some());
    }
}

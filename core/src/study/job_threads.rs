//! The jobs of a study on threads, until an end from outside.

use super::many::{Many, ManySettings};
use super::{Case, Finished, Job, Runner};
use std::io;
use std::num::NonZeroUsize;
use std::sync::mpsc::{Sender, channel};
use std::task::Poll;
use std::time::{Duration, Instant};

/// Time between two questions whether the run is ended.
const BETWEEN: Duration = Duration::from_millis(50);

/// Runs the jobs of a study on threads of its own, in bounded memory.
///
/// An end leaves the study with the cases that were received before ([`run`](super::run)).
pub struct JobThreads<E> {
    jobs: Sender<Job>,
    cases: Many<Vec<Case>>,
    threads: NonZeroUsize,
    submitted: usize,
    taken: usize,
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
        let (jobs, receiver) = channel::<Job>();
        let settings = ManySettings { in_order: false, ..ManySettings::new(threads) };
        let work = move |kept: &mut S, job: Job| work(kept, &job);
        let cases = Many::new(receiver.into_iter(), settings, work)?;
        Ok(Self { jobs, cases, threads, submitted: 0, taken: 0, is_ended })
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
        // The receiver lives as long as the threads.
        let _ = self.jobs.send(job);
        self.submitted += 1;
        self.submitted - 1
    }

    /// A study that waits cancels no job.
    fn cancel(&mut self, _index: usize) {}

    fn poll(&mut self) -> Option<Finished<Vec<Case>>> {
        None
    }

    fn next(&mut self) -> Option<Finished<Vec<Case>>> {
        if self.taken == self.submitted {
            return None;
        }
        while !(self.is_ended)() {
            if let Poll::Ready(next) = self.cases.next_until(Some(Instant::now() + BETWEEN)) {
                self.taken += 1;
                return next;
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
    use crate::study::{Axis, Cases, Evaluator, Map, MapSettings, Parameter, Study, run};

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
}

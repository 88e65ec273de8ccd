//! Many jobs on threads, for as long as jobs come: an iterator of jobs in, an iterator of results out, in bounded memory.

use super::runner::{Finished, JobPanic};
use std::collections::BTreeMap;
use std::io;
use std::num::NonZeroUsize;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, OnceLock, PoisonError};
use std::task::Poll;
use std::thread::Builder;
use std::time::Instant;

/// How [`Many`] runs its jobs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ManySettings {
    /// Number of threads.
    pub threads: NonZeroUsize,
    /// Results in the order of the jobs? Else in the order of completion.
    pub in_order: bool,
    /// Greatest number of jobs that have begun and whose results are unread. In order a slow job holds up the results of this
    /// many jobs after it; threads wait beyond.
    pub window: NonZeroUsize,
}

impl ManySettings {
    /// In order on this many threads, with a window of 1024 jobs: at 90 scenes a second a scene may take 10 s.
    #[must_use]
    pub const fn new(threads: NonZeroUsize) -> Self {
        Self { threads, in_order: true, window: NonZeroUsize::new(1024).expect("positive") }
    }
}

/// The results of jobs that run on threads of their own.
///
/// The threads read the jobs one at a time, so that a source of jobs that waits holds no result up. [`Iterator::next`] waits for
/// a result. A drop begins no further job and does not wait for those that run.
pub struct Many<T>(Arc<Shared<T>>);

struct Shared<T> {
    state: Mutex<State<T>>,
    /// A result is ready, or no further one comes.
    is_ready: Condvar,
    /// A result was read, or the run was cancelled.
    has_room: Condvar,
    /// Called after each job, by its thread.
    wake: OnceLock<Box<dyn Fn() + Send + Sync>>,
    settings: ManySettings,
}

struct State<T> {
    begun: usize,
    read: usize,
    ready: BTreeMap<usize, Result<T, JobPanic>>,
    /// Have the jobs ended?
    is_last: bool,
    is_cancelled: bool,
}

impl<T: Send + 'static> Many<T> {
    /// Starts threads that run `work` on jobs; each thread passes its own `S` from job to job, a new one after a panic.
    ///
    /// # Errors
    /// If the system starts no thread.
    pub fn new<S: Default, J: Send + 'static>(
        jobs: impl Iterator<Item = J> + Send + 'static,
        settings: ManySettings,
        work: impl Fn(&mut S, J) -> T + Send + Sync + 'static,
    ) -> io::Result<Self> {
        let (begun, read, ready) = (0, 0, BTreeMap::new());
        let state = Mutex::new(State { begun, read, ready, is_last: false, is_cancelled: false });
        let (is_ready, has_room) = (Condvar::new(), Condvar::new());
        let wake = OnceLock::new();
        let shared = Arc::new(Shared { state, is_ready, has_room, wake, settings });
        let source = Arc::new((Mutex::new(jobs), work));
        for k in 0..settings.threads.get() {
            let (shared, source) = (Arc::clone(&shared), Arc::clone(&source));
            let run = move || {
                let mut kept = S::default();
                while let Some((index, job)) = shared.next_job(&source.0) {
                    let result = catch_unwind(AssertUnwindSafe(|| (source.1)(&mut kept, job)));
                    if result.is_err() {
                        kept = S::default();
                    }
                    shared.finish(index, result.map_err(|panic| JobPanic::caught(index, &*panic)));
                }
            };
            match Builder::new().name(format!("many {k}")).spawn(run) {
                Err(error) if k == 0 => return Err(error),
                Err(_) => break,
                Ok(_) => {}
            }
        }
        Ok(Self(shared))
    }

    /// Has a function called after each job, by its thread. The first one stays.
    pub fn wakes(&self, wake: impl Fn() + Send + Sync + 'static) {
        let _ = self.0.wake.set(Box::new(wake));
    }

    /// A function that ends the run from any thread: no further job begins; results that are ready are still read, in order with
    /// gaps, and those of running jobs are dropped.
    pub fn canceller(&self) -> impl Fn() + Send + Sync + 'static {
        let shared = Arc::clone(&self.0);
        move || shared.cancel()
    }
}

impl<T> Shared<T> {
    /// A panic while the state is locked leaves it whole.
    fn lock(&self) -> MutexGuard<'_, State<T>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for room in the window and for the next job.
    fn next_job<J>(&self, jobs: &Mutex<impl Iterator<Item = J>>) -> Option<(usize, J)> {
        let mut jobs = jobs.lock().unwrap_or_else(PoisonError::into_inner);
        let is_full = |state: &mut State<T>| {
            !state.is_cancelled && state.begun - state.read >= self.settings.window.get()
        };
        let state = self.has_room.wait_while(self.lock(), is_full);
        let state = state.unwrap_or_else(PoisonError::into_inner);
        if state.is_cancelled || state.is_last {
            return None;
        }
        drop(state);
        let job = catch_unwind(AssertUnwindSafe(|| jobs.next()));
        let mut state = self.lock();
        let index = state.begun;
        match job {
            Ok(Some(job)) => {
                state.begun += 1;
                return Some((index, job));
            }
            Ok(None) => {}
            Err(panic) => {
                state.begun += 1;
                state.ready.insert(index, Err(JobPanic::caught(index, &*panic)));
            }
        }
        state.is_last = true;
        self.is_ready.notify_all();
        None
    }

    fn finish(&self, index: usize, result: Result<T, JobPanic>) {
        self.lock().ready.insert(index, result);
        self.is_ready.notify_all();
        if let Some(wake) = self.wake.get() {
            wake();
        }
    }

    fn cancel(&self) {
        self.lock().is_cancelled = true;
        self.is_ready.notify_all();
        self.has_room.notify_all();
    }
}

impl<T> Many<T> {
    /// Waits for a result until a time, without one as long as it takes; `Pending` if none is ready then.
    pub fn next_until(&mut self, end: Option<Instant>) -> Poll<Option<Finished<T>>> {
        let Shared { is_ready, has_room, settings, .. } = &*self.0;
        let mut state = self.0.lock();
        loop {
            let State { read, begun, is_last, is_cancelled, .. } = *state;
            let is_next = |index: usize| !settings.in_order || is_cancelled || index == read;
            if let Some(entry) = state.ready.first_entry().filter(|entry| is_next(*entry.key())) {
                let (index, result) = entry.remove_entry();
                state.read += 1;
                has_room.notify_one();
                return Poll::Ready(Some(Finished { index, result }));
            }
            if is_cancelled || is_last && read == begun {
                return Poll::Ready(None);
            }
            let Some(end) = end else {
                state = is_ready.wait(state).unwrap_or_else(PoisonError::into_inner);
                continue;
            };
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Poll::Pending;
            }
            let waited = is_ready.wait_timeout(state, left);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }
}

impl<T> Iterator for Many<T> {
    type Item = Finished<T>;

    fn next(&mut self) -> Option<Finished<T>> {
        match self.next_until(None) {
            Poll::Ready(next) => next,
            // Without an end the wait has a result.
            Poll::Pending => None,
        }
    }
}

impl<T> Drop for Many<T> {
    fn drop(&mut self) {
        self.0.cancel();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::{Outcome, Selection};
    use crate::scene::{CheckedScene, Scene};
    use crate::simulate::{Simulator, simulate};
    use crate::solve::Options;
    use std::sync::atomic::{AtomicUsize, Ordering::SeqCst};
    use std::sync::mpsc::channel;
    use std::time::Duration;

    fn settings(threads: usize, in_order: bool, window: usize) -> ManySettings {
        let [threads, window] = [threads, window].map(|count| NonZeroUsize::new(count).unwrap());
        ManySettings { threads, in_order, window }
    }

    fn results<T: Send + 'static>(many: Many<T>) -> Vec<T> {
        many.map(|finished| finished.result.unwrap()).collect()
    }

    #[test]
    fn results_come_in_order_or_as_they_are_ready() {
        // The first job ends when it is released.
        let slow_first = |in_order| {
            let (release, released) = channel();
            let released = Mutex::new(released);
            let work = move |(): &mut (), job: usize| {
                if job == 0 {
                    released.lock().unwrap().recv().unwrap();
                }
                job
            };
            (Many::new(0..5, settings(2, in_order, 5), work).unwrap(), release)
        };
        let (mut many, release) = slow_first(false);
        let mut found: Vec<usize> =
            many.by_ref().take(4).map(|finished| finished.result.unwrap()).collect();
        found.sort_unstable();
        assert_eq!(found, [1, 2, 3, 4]);
        release.send(()).unwrap();
        assert_eq!(results(many), [0]);
        let (many, release) = slow_first(true);
        while many.0.lock().ready.len() < 4 {
            std::thread::yield_now();
        }
        release.send(()).unwrap();
        assert_eq!(results(many), [0, 1, 2, 3, 4]);
    }

    #[test]
    fn an_endless_source_runs_no_further_than_the_window() {
        let begun = Arc::new(AtomicUsize::new(0));
        let counter = Arc::clone(&begun);
        let work = move |(): &mut (), job: u64| {
            counter.fetch_add(1, SeqCst);
            job
        };
        let mut many = Many::new(0_u64.., settings(3, true, 7), work).unwrap();
        for k in 0..1000 {
            assert_eq!(many.next().unwrap().result.unwrap(), k);
            assert!(begun.load(SeqCst) as u64 <= k + 1 + 7);
        }
        many.canceller()();
        let rest = many.by_ref().count();
        assert!(rest <= 7 && many.next().is_none(), "{rest}");
    }

    #[test]
    fn a_result_does_not_wait_for_the_next_job() {
        let (sender, receiver) = channel::<usize>();
        let mut many =
            Many::new(receiver.into_iter(), settings(1, true, 9), |(): &mut (), job| job).unwrap();
        for job in 0..3 {
            sender.send(job).unwrap();
            assert_eq!(many.next().unwrap().result.unwrap(), job);
        }
        drop(sender);
        assert!(many.next().is_none());
    }

    #[test]
    fn a_wait_ends_at_its_time() {
        let (sender, receiver) = channel::<usize>();
        let mut many =
            Many::new(receiver.into_iter(), settings(1, true, 9), |(): &mut (), job| job).unwrap();
        let soon = || Some(Instant::now() + Duration::from_millis(20));
        let start = Instant::now();
        assert!(many.next_until(soon()).is_pending());
        assert!(start.elapsed() >= Duration::from_millis(20));
        sender.send(7).unwrap();
        let Poll::Ready(Some(found)) = many.next_until(None) else { panic!("no result") };
        assert_eq!(found.result.unwrap(), 7);
        drop(sender);
        let far = Some(Instant::now() + Duration::from_secs(60));
        assert!(matches!(many.next_until(far), Poll::Ready(None)));
    }

    #[test]
    fn a_panic_of_a_job_or_of_the_source_is_one_result() {
        let work = |kept: &mut usize, job: usize| {
            *kept += 1;
            assert_ne!(job, 1, "a defect");
            *kept
        };
        let jobs = (0..).inspect(|job| assert!(*job < 4, "a broken source"));
        let many = Many::new(jobs, settings(1, true, 2), work).unwrap();
        let found: Vec<_> =
            many.map(|finished| finished.result.map_err(|panic| panic.to_string())).collect();
        assert_eq!(found.len(), 5);
        assert_eq!([&found[0], &found[2], &found[3]], [&Ok(1), &Ok(1), &Ok(2)]);
        assert!(found[1].as_ref().unwrap_err().contains("a defect"));
        assert!(found[4].as_ref().unwrap_err().contains("a broken source"));
    }

    #[test]
    fn scenes_have_the_results_of_one_simulator() {
        let scenes: Vec<Scene> = (0..6)
            .map(|k| {
                let mut scene = if k % 2 == 0 { Scene::sheet() } else { Scene::default() };
                scene.solver.nodes_per_side = 17;
                scene.insertion = 0.5 + 0.05 * f64::from(k);
                scene
            })
            .collect();
        let expected: Vec<Outcome> = scenes.iter().map(|scene| simulate(scene).unwrap()).collect();
        let checked: Vec<_> =
            scenes.into_iter().map(|scene| CheckedScene::new(scene).unwrap()).collect();
        let solve = |simulator: &mut Simulator, scene: CheckedScene| {
            simulator.run(&scene, Options::default(), &Selection::all(), None).outcome
        };
        let many = Many::new(checked.into_iter(), settings(3, true, 2), solve).unwrap();
        assert_eq!(results(many), expected);
    }
}

//! The scenes of a study on their way through the jobs: waiting, running, solved.

use super::Study;
use super::cache::{Cases, Key};
use super::job::{Case, Job};
use crate::scene::Scene;
use std::collections::{BTreeMap, HashMap, VecDeque};

/// Greatest number of items in a call of `next_job`, so that a study whose cases are stored delays no frame.
const ITEMS_PER_CALL: usize = 100;

/// The cases of a study by item; an item is a number below the number of scenes.
#[derive(Debug, Default)]
pub(super) struct Queue {
    waiting: VecDeque<usize>,
    /// For each running job its scenes: key and items.
    running: BTreeMap<usize, Vec<(Key, Vec<usize>)>>,
    /// Job and position of the running scenes.
    places: HashMap<Key, (usize, usize)>,
    cases: Vec<Option<Case>>,
    jobs: usize,
    done: usize,
    all: usize,
}

impl Queue {
    /// The queue of these items in this order; another item has no case.
    pub(super) fn new(order: Vec<usize>) -> Self {
        let (all, end) = (order.len(), order.iter().max().map_or(0, |last| last + 1));
        Self { cases: vec![None; end], waiting: order.into(), all, ..Self::default() }
    }

    /// The next job and its index: up to `size` scenes that no job has computed. Items with a stored case, items out of
    /// their limits and items equal to a running scene enter no job. A call looks at [`ITEMS_PER_CALL`] items at most: if
    /// all of these enter no job, the job has no scenes.
    pub(super) fn next_job(
        &mut self,
        size: usize,
        profile: bool,
        store: &mut Cases,
        scene: impl Fn(usize) -> Result<Scene, String>,
    ) -> Option<(usize, Job)> {
        let index = self.jobs;
        let (mut scenes, mut places) = (Vec::new(), Vec::new());
        let mut items = self.waiting.len().min(ITEMS_PER_CALL);
        while scenes.len() < size
            && items > 0
            && let Some(item) = self.waiting.pop_front()
        {
            items -= 1;
            let scene = match scene(item) {
                Ok(scene) => scene,
                Err(error) => {
                    self.set(item, Case::invalid(error));
                    continue;
                }
            };
            let key = store.key(&scene);
            if let Some(case) = store.reuse(&key, profile) {
                let case = case.clone();
                self.set(item, case);
            } else if let Some(&(job, position)) = self.places.get(&key) {
                let of_job =
                    if job == index { Some(&mut places) } else { self.running.get_mut(&job) };
                if let Some((_, items)) = of_job.and_then(|places| places.get_mut(position)) {
                    items.push(item);
                }
            } else {
                self.places.insert(key.clone(), (index, places.len()));
                places.push((key, vec![item]));
                scenes.push(scene.for_job());
            }
        }
        if scenes.is_empty() && self.waiting.is_empty() {
            return None;
        }
        self.jobs += 1;
        self.running.insert(index, places);
        Some((index, Job { scenes, profile, full: false }))
    }

    /// Adds items behind those that wait.
    pub(super) fn extend(&mut self, items: impl Iterator<Item = usize>) {
        for item in items {
            self.all += 1;
            self.cases.resize(self.cases.len().max(item + 1), None);
            self.waiting.push_back(item);
        }
    }

    /// A job without scenes.
    fn empty_job(&mut self) -> (usize, Job) {
        let index = self.jobs;
        self.jobs += 1;
        self.running.insert(index, Vec::new());
        (index, Job::default())
    }

    /// Takes the cases of a job; an unknown job is ignored. Missing cases are those of a job that failed.
    pub(super) fn receive(&mut self, job: usize, cases: Vec<Case>, store: &mut Cases) {
        let Some(places) = self.running.remove(&job) else { return };
        let mut cases = cases.into_iter();
        for (key, items) in places {
            self.places.remove(&key);
            let case = cases.next();
            for item in items {
                self.set(item, case.clone().unwrap_or_else(|| Case::invalid("the job has failed")));
            }
            // A failure is no property of the scene.
            if let Some(case) = case.filter(|case| case.status.is_some()) {
                store.insert(key, case);
            }
        }
    }

    fn set(&mut self, item: usize, case: Case) {
        self.done += 1;
        self.cases[item] = Some(case);
    }

    /// Puts a better case in place of that of a solved item.
    pub(super) fn replace(&mut self, item: usize, case: Case) {
        if let Some(place) = self.cases.get_mut(item) {
            *place = Some(case);
        }
    }

    /// The case of an item, if the item is solved.
    pub(super) fn case(&self, item: usize) -> Option<&Case> {
        self.cases.get(item)?.as_ref()
    }

    /// The cases by item.
    pub(super) fn cases(&self) -> &[Option<Case>] {
        &self.cases
    }

    /// Numbers of solved items and of all items.
    pub(super) fn progress(&self) -> (usize, usize) {
        (self.done, self.all)
    }
}

/// A study whose items are the numbers of its scenes.
pub(super) trait Queued {
    /// Do the cases contain the profile of the skin?
    const HAS_PROFILE: bool = false;

    /// The items on their way.
    fn queue(&self) -> &Queue;

    /// Greatest number of scenes in a job; one where scenes take long or have different grids.
    fn scenes_per_job(&self) -> usize {
        1
    }

    /// [`Self::queue`].
    fn queue_mut(&mut self) -> &mut Queue;

    /// The scene of an item, or why there is none.
    fn scene_of(&self, item: usize) -> Result<Scene, String>;

    /// Is nothing left to do with the cases?
    fn is_concluded(&self) -> bool {
        true
    }

    /// A step of what is left to do with the cases once all are there, as long as a frame allows. May add items.
    fn conclude(&mut self) {}
}

impl<T: Queued> Study for T {
    fn next_job(&mut self, store: &mut Cases) -> Option<(usize, Job)> {
        // The scenes are made from the rest of the study.
        let mut queue = std::mem::take(self.queue_mut());
        let scene = |item: usize| self.scene_of(item);
        let job = queue.next_job(self.scenes_per_job(), T::HAS_PROFILE, store, scene);
        *self.queue_mut() = queue;
        let (done, all) = self.queue().progress();
        if job.is_none() && done == all && !self.is_concluded() {
            self.conclude();
            return Some(self.queue_mut().empty_job());
        }
        job
    }

    fn receive(&mut self, job: usize, cases: Vec<Case>, store: &mut Cases) {
        self.queue_mut().receive(job, cases, store);
    }

    fn progress(&self) -> (usize, usize) {
        let (done, all) = self.queue().progress();
        // A study ends with its conclusion.
        (if self.is_concluded() { done } else { done.min(all.saturating_sub(1)) }, all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::evaluate;

    /// Items 0 to 5 have three different scenes; item 3 is invalid.
    fn scene(item: usize) -> Result<Scene, String> {
        if item == 3 {
            return Err("item 3 is out of its limits".to_owned());
        }
        let mut scene = Scene::sheet();
        scene.solver.nodes_per_side = 17;
        scene.implant.projection_mm = [20.0, 30.0, 20.0, 0.0, 40.0, 30.0][item];
        Ok(scene)
    }

    #[test]
    fn equal_scenes_are_solved_once_and_jobs_end_in_any_order() {
        let (mut queue, mut store) = (Queue::new((0..6).collect()), Cases::default());
        let mut jobs = Vec::new();
        while let Some((index, job)) = queue.next_job(2, false, &mut store, scene) {
            assert_eq!(index, jobs.len());
            jobs.push((index, job));
        }
        let sizes: Vec<usize> = jobs.iter().map(|(_, job)| job.scenes.len()).collect();
        assert_eq!(sizes, [2, 1]);
        assert_eq!(queue.progress(), (1, 6));
        for (index, job) in jobs.into_iter().rev() {
            queue.receive(index, evaluate(&job), &mut store);
        }
        assert_eq!((queue.progress(), store.solved(), store.reused()), ((6, 6), 3, 0));
        assert_eq!(queue.case(0), queue.case(2));
        assert_eq!(queue.case(1), queue.case(5));
        assert!(queue.case(3).is_some_and(|case| case.error.is_some()));
        // A second study takes all of its cases from the store.
        let mut again = Queue::new((0..6).collect());
        assert!(again.next_job(2, false, &mut store, scene).is_none());
        assert_eq!((again.progress(), store.solved(), store.reused()), ((6, 6), 3, 5));
        assert_eq!(again.cases(), queue.cases());
    }

    #[test]
    fn a_call_looks_at_a_limited_number_of_items() {
        let (count, mut store) = (2 * ITEMS_PER_CALL + 1, Cases::default());
        let mut queue = Queue::new((0..count).collect());
        let invalid = |_| scene(3);
        for done in [ITEMS_PER_CALL, 2 * ITEMS_PER_CALL] {
            let (index, job) = queue.next_job(9, false, &mut store, invalid).unwrap();
            assert!(job.scenes.is_empty());
            queue.receive(index, Vec::new(), &mut store);
            assert_eq!(queue.progress(), (done, count));
        }
        assert!(queue.next_job(9, false, &mut store, invalid).is_none());
        assert_eq!(queue.progress(), (count, count));
    }

    #[test]
    fn a_failed_job_leaves_errors_and_no_stored_case() {
        let (mut queue, mut store) = (Queue::new(vec![1, 0]), Cases::default());
        let (index, job) = queue.next_job(9, false, &mut store, scene).unwrap();
        assert_eq!(job.scenes.len(), 2);
        queue.receive(index, Vec::new(), &mut store);
        queue.receive(index + 7, Vec::new(), &mut store);
        assert_eq!((queue.progress(), store.len()), ((2, 2), 0));
        assert!(queue.cases().iter().all(|case| case.as_ref().unwrap().error.is_some()));
    }
}

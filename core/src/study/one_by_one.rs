//! The scenes that a study asks for one by one: a stored case at once, another case by a job of one scene.

use super::cache::{Cases, Key};
use super::job::{Case, Job};
use crate::scene::Scene;
use std::collections::BTreeMap;

/// The running jobs of one scene each, by index, with what the study calls the scene.
#[derive(Debug)]
pub(super) struct OneByOne<T> {
    running: BTreeMap<usize, (T, Key)>,
    jobs: usize,
}

impl<T> OneByOne<T> {
    pub(super) fn new() -> Self {
        Self { running: BTreeMap::new(), jobs: 0 }
    }

    /// Does no job run?
    pub(super) fn is_idle(&self) -> bool {
        self.running.is_empty()
    }

    /// The stored case of a scene.
    ///
    /// # Errors
    /// Without a stored case the job of the scene, with its index.
    pub(super) fn ask(
        &mut self,
        name: T,
        scene: Scene,
        store: &mut Cases,
    ) -> Result<Case, (usize, Job)> {
        let key = store.key(&scene);
        if let Some(case) = store.reuse(&key, false) {
            return Ok(case.clone());
        }
        let index = self.jobs;
        self.jobs += 1;
        self.running.insert(index, (name, key));
        Err((index, Job { scenes: vec![scene.for_job()], ..Job::default() }))
    }

    /// Stores the case of a job and returns it with the name of its scene; `None` for an unknown job, no case for a job that has
    /// failed.
    pub(super) fn receive(
        &mut self,
        job: usize,
        cases: Vec<Case>,
        store: &mut Cases,
    ) -> Option<(T, Option<Case>)> {
        let (name, key) = self.running.remove(&job)?;
        let case = cases.into_iter().next().filter(|case| case.status.is_some());
        if let Some(case) = &case {
            store.insert(key, case.clone());
        }
        Some((name, case))
    }
}

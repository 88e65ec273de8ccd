//! An app whose studies wait: as many of their results arrive as a test lets pass, whatever the machine's speed.

use super::*;
use implant_preview::app::JobRunner;
use implant_preview::study::{Case, Finished, Job, Runner};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How many results may still arrive.
#[derive(Clone, Default)]
pub(super) struct Gate(Arc<AtomicUsize>);

impl Gate {
    /// Lets at most so many further results pass.
    pub(super) fn pass(&self, results: usize) {
        self.0.store(results, Ordering::Relaxed);
    }
}

struct Gated {
    runner: Box<JobRunner>,
    gate: Gate,
}

impl Runner for Gated {
    type Job = Job;
    type Done = Vec<Case>;

    fn submit(&mut self, job: Job) -> usize {
        self.runner.submit(job)
    }

    fn cancel(&mut self, index: usize) {
        self.runner.cancel(index);
    }

    fn poll(&mut self) -> Option<Finished<Vec<Case>>> {
        if self.gate.0.load(Ordering::Relaxed) == 0 {
            return None;
        }
        let finished = self.runner.poll()?;
        self.gate.0.fetch_sub(1, Ordering::Relaxed);
        Some(finished)
    }

    fn next(&mut self) -> Option<Finished<Vec<Case>>> {
        self.poll()
    }
}

/// The app with a scene, before its first frame, its gate closed.
pub(super) fn gated(scene: Scene) -> (Harness<'static, App>, Gate) {
    let gate = Gate::default();
    let start = |wake| -> Box<JobRunner> {
        Box::new(Gated { runner: beside_window(wake), gate: gate.clone() })
    };
    let app = App::new(&egui::Context::default(), None, scene, start).unwrap();
    (window(DESKTOP, 400, app), gate)
}

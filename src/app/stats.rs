//! Figures of the running app, and the answer in words for screen readers.

use super::{App, answer};
use crate::measure::Status;
use crate::session::Pin;

/// Figures of the running app, for the page and the tests.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stats {
    /// Frames drawn since the start.
    pub frames: u64,
    /// Median time of a frame \[ms\].
    pub frame_ms_p50: f64,
    /// 95th percentile of the time of a frame \[ms\].
    pub frame_ms_p95: f64,
    /// Solver time for the present scene \[ms\].
    pub solve_ms: f64,
    /// Median solver time of a frame that solved \[ms\].
    pub solver_ms_p50: f64,
    /// 95th percentile of the solver time of a frame that solved \[ms\].
    pub solver_ms_p95: f64,
    /// Greatest solver time of a frame after the solve of the opening scene \[ms\].
    pub solver_ms_max: f64,
    /// Does the picture show the converged shape of the present scene?
    pub converged: bool,
    /// Number of solves started.
    pub solves: u64,
    /// Solver work since the start, in evaluations of all nodal forces.
    pub work_units: f64,
    /// Number of tables of the spring law built.
    pub tables: u64,
    /// Number of shapes measured.
    pub measurements: u64,
    /// Number of computed plans of the range of implants; 0 without a chart.
    pub range_done: usize,
    /// Number of all plans of the range of implants; 0 without a chart.
    pub range_all: usize,
    /// Number of computed plans of the sampled patients; 0 without a study.
    pub samples_done: usize,
    /// Number of all plans of the sampled patients, with those of scenarios and importance; 0 without a study.
    pub samples_all: usize,
}

impl App {
    /// Figures of the running app.
    #[must_use]
    pub fn stats(&self) -> Stats {
        let is_converged =
            self.session.result().is_some_and(|outcome| outcome.status == Status::Converged);
        let counters = self.session.counters();
        let (range_done, range_all) = self.range.progress();
        let (samples_done, samples_all) = self.uncertainty.progress();
        Stats {
            frames: self.timing.frame_count,
            frame_ms_p50: self.timing.percentile(0.5),
            frame_ms_p95: self.timing.percentile(0.95),
            solve_ms: self.timing.solve_ms,
            solver_ms_p50: self.timing.slices.percentile(0.5),
            solver_ms_p95: self.timing.slices.percentile(0.95),
            solver_ms_max: self.timing.slice_max,
            converged: is_converged,
            solves: counters.solves,
            work_units: counters.work_units,
            tables: counters.tables,
            measurements: counters.measurements,
            range_done,
            range_all,
            samples_done,
            samples_all,
        }
    }

    /// The answer in a few sentences, for screen readers; before it the chosen point of the range of implants.
    #[must_use]
    pub fn summary(&self) -> String {
        let answer = answer::summary(&self.session, self.plan.device)
            + &self.nearest.summary(&self.session)
            + &self.largest_in_words()
            + &self.uncertainty.summary()
            + &self.pinned();
        self.range.summary().map_or(answer.clone(), |point| format!("{point} {answer}"))
    }

    /// The largest volume that stays usual, in a sentence; empty while that is not known.
    pub(super) fn largest_in_words(&self) -> String {
        let words = self.volume_marks.largest_usual();
        if words.is_empty() { words } else { format!(" {words}") }
    }

    /// The pins in a sentence; empty without pins.
    fn pinned(&self) -> String {
        let pin = |pin: &Pin| format!("{} {}", pin.letter(), pin.name()).trim_end().to_owned();
        let pins: Vec<String> = self.session.pins().iter().map(pin).collect();
        if pins.is_empty() { String::new() } else { format!(" Pinned: {}.", pins.join(", ")) }
    }
}

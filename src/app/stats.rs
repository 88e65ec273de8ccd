//! Figures of the running app, and the result in one sentence for screen readers.

use super::App;
use crate::measure::{Status, bands, no_shape};

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
}

impl App {
    /// Figures of the running app.
    #[must_use]
    pub fn stats(&self) -> Stats {
        let is_converged =
            self.session.result().is_some_and(|outcome| outcome.status == Status::Converged);
        let counters = self.session.counters();
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
        }
    }

    /// The result in a few sentences, for screen readers.
    #[must_use]
    pub fn summary(&self) -> String {
        if self.session.is_stopped() {
            return "Stopped: this scene has not been computed.".to_owned();
        }
        let Some(outcome) = self.session.result() else {
            return "Updating.".to_owned();
        };
        let figure = |name: &str, value: Option<f64>, decimals: usize, unit: &str| {
            value.map_or_else(String::new, |v| format!(" {name} {v:.decimals$}{unit}."))
        };
        let state = match outcome.status {
            Status::Unstable => return no_shape(self.session.invalid()).to_owned(),
            Status::NotConverged => "Not finished: do not use these numbers.",
            Status::Converged => "Up to date.",
        };
        let greatest = outcome.strain.as_ref().map(|strain| strain.max_principal);
        let strain = greatest.map_or_else(String::new, |strain| {
            let word = bands::strain_word(strain);
            format!(" Greatest strain {:.0} percent, {word}.", 100.0 * strain)
        });
        let pressure = outcome.contact_pressure_mmhg.map_or_else(String::new, |p| {
            let word = bands::pressure_word(p.max);
            format!(" Contact pressure {:.0} mmHg, at most {:.0}, {word}.", p.mean, p.max)
        });
        [
            state.to_owned(),
            figure("Skin projection", outcome.skin_projection_mm, 1, " mm"),
            figure("Area ratio", outcome.area_ratio, 2, ""),
            strain,
            pressure,
            outcome.warnings.iter().map(|warning| format!(" {warning}")).collect(),
        ]
        .concat()
    }
}

//! Figures of the running app.

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
    /// Number of jobs of all studies that are not finished.
    pub jobs: usize,
}

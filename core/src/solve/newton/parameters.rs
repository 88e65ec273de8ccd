//! Tuned constants of Newton's method, with their meaning, unit and evidence.
//!
//! Scenes are files of `tests/stress`; `docs/notes/solver.md` has the history. Constants of one safeguard stand in
//! the safeguard's file in `robust`.

/// The constants of the iteration on one grid.
pub(super) struct Parameters {
    /// Iterations after which the iteration ends, times [`crate::solve::Options::work_limit_factor`].
    pub(super) max_iterations: u32,
    /// Force evaluations times nodes after which the iteration ends: a few seconds.
    pub(super) max_node_work: f64,
    /// Lower bound of the limit of force evaluations on fine grids.
    pub(super) min_work_limit: f64,
    /// Rounds of sweeps and conjugate gradients in one iteration.
    pub(super) max_rounds: u32,
    /// Change of a round below which rounds end \[step\].
    pub(super) round_tolerance: f64,
    /// Change of a round below which rounds end \[tolerance of positions\].
    pub(super) round_floor: f64,

    /// Conjugate-gradient steps of a round.
    pub(super) max_cg_steps: u32,
    /// Residual drop of a round \[-\].
    pub(super) cg_drop: f64,
    /// Residual below which conjugate gradients are skipped, relative to the forces of all triangles \[-\].
    pub(super) cg_floor: f64,

    /// Greatest number of halvings of a step.
    pub(super) max_halvings: u32,
    /// Armijo's constant c₁: required fraction of the predicted decrease of the energy \[-\].
    pub(super) sufficient_decrease: f64,
    /// Rounding of an energy, relative to the energy \[-\]. Fixed by `no-convergence-at-small-insertion`, `rounding-on-shallow-dome`.
    pub(super) energy_rounding: f64,

    /// Upper bound of the assumed ratio of successive steps \[-\]; under compression the assumed ratio.
    /// Fixed by `near-zero-stiffness-after-small-step`, `premature-convergence-at-rim`.
    pub(super) max_convergence_factor: f64,
    /// Greatest relative residual before the last step \[-\]. Fixed by `small-steps-with-large-residual`.
    pub(super) max_residual_before_step: f64,
    /// Greatest relative residual before the last step under compression \[-\]: small steps may precede a wrinkle.
    pub(super) max_compressive_residual: f64,
    /// Greatest relative residual of a solution \[-\]. Fixed by `slow-final-steps`.
    pub(super) max_residual: f64,
}

pub(super) const PARAMETERS: Parameters = Parameters {
    max_iterations: 150,
    max_node_work: 6e7,
    min_work_limit: 400.0,
    max_rounds: 12,
    round_tolerance: 0.1,
    round_floor: 0.02,
    max_cg_steps: 12,
    cg_drop: 0.3,
    cg_floor: 1e-16,
    max_halvings: 12,
    sufficient_decrease: 1e-4,
    energy_rounding: 1e-13,
    max_convergence_factor: 0.98,
    max_residual_before_step: 0.05,
    max_compressive_residual: 1e-4,
    max_residual: 0.01,
};

/// Cells that one piece of work assembles: about two milliseconds.
pub(super) const CELLS_PER_PIECE: usize = 4096;

/// Costs in work units (one evaluation of all nodal forces), by floating-point operations.
pub(super) mod cost {
    pub(in crate::solve::newton) const LINEARIZE: f64 = 4.0;
    pub(in crate::solve::newton) const SWEEP: f64 = 0.6;
    pub(in crate::solve::newton) const CYCLE: f64 = 2.8;
    pub(in crate::solve::newton) const BUILD: f64 = 2.0;
    pub(in crate::solve::newton) const ENERGY: f64 = 0.7;
}

//! Tuned constants of the step of a sheet, with their meaning, unit and evidence.

/// The constants of rounds and final state.
pub(super) struct Parameters {
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
    /// Greatest relative residual of a solution \[-\]. Fixed by `slow-final-steps`.
    pub(super) max_residual: f64,
}

pub(super) const PARAMETERS: Parameters = Parameters {
    max_rounds: 12,
    round_tolerance: 0.1,
    round_floor: 0.02,
    max_cg_steps: 12,
    cg_drop: 0.3,
    cg_floor: 1e-16,
    max_residual: 0.01,
};

/// Cells that one piece of work assembles: about two milliseconds.
pub(super) const CELLS_PER_PIECE: usize = 4096;

/// Costs in work units (one evaluation of all nodal forces), by floating-point operations.
pub(super) mod cost {
    pub(in crate::solve::newton::sheet) const SWEEP: f64 = 0.6;
    pub(in crate::solve::newton::sheet) const CYCLE: f64 = 2.8;
    pub(in crate::solve::newton::sheet) const BUILD: f64 = 2.0;
}

//! Tuned constants of the step of layered tissue, with their meaning and unit.

/// The constants of rounds and conjugate gradients.
pub(super) struct Parameters {
    /// Rounds of conjugate gradients and active set in one iteration.
    pub(super) max_rounds: u32,
    /// Depth in the obstacle at which a node of a step becomes active \[spacings\].
    pub(super) depth: f64,
    /// Distance from the obstacle below which an active node stays so unless the obstacle pulls \[spacings\].
    pub(super) touch: f64,
    /// Conjugate-gradient steps of a round.
    pub(super) max_cg_steps: u32,
    /// Drop of √(r·z) in a round \[-\].
    pub(super) cg_drop: f64,
    /// Relative residual below which Newton's method converges quadratically \[-\], and the drop of √(r·z) from there on.
    pub(super) near: f64,
    pub(super) cg_drop_near: f64,
    /// Longest move of a node in one step \[spacings\].
    pub(super) max_move: f64,
}

pub(super) const PARAMETERS: Parameters = Parameters {
    max_rounds: 15,
    depth: 1e-9,
    touch: 1e-6,
    max_cg_steps: 600,
    cg_drop: 0.03,
    near: 1e-3,
    cg_drop_near: 1e-3,
    max_move: 0.5,
};

/// Cells whose second derivatives are one piece of work: a few milliseconds.
pub(super) const PLACES_PER_PIECE: usize = 1024;

//! The dome's curvature under active nodes, on and off.
//!
//! Symptom: steps of a sheet over a needle raise the energy, or one node oscillates across the tip. Cause: the
//! curvature makes the model indefinite. Remedy: a few iterations without curvature, whose steps lower the energy.
//! Without curvature the model may be much too stiff (`overstiff-model-on-needle`): a solution without curvature is
//! iterated with curvature again. A block that is indefinite at the solution marks a saddle point: the node would
//! slide off (`active-node-on-needle-tip`, `unstable-node-on-needle-tip`).

use super::{Phase, Piece, Robust, SheetNewton, State};

/// Number of iterations without curvature.
const ITERATIONS_OFF: u32 = 4;
/// Greatest number of returns to curvature from a solution without curvature.
const MAX_RETRIES: u32 = 2;

/// State of the curvature in the model.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Curvature {
    /// The iteration up to which curvature is off.
    off_until: Option<u32>,
    pub(super) retries: u32,
    /// Was a block with curvature indefinite in the last model with curvature?
    is_saddle: bool,
}

/// An accepted step of the line search.
#[derive(Clone, Copy, Debug)]
pub(in crate::solve::newton::sheet) struct AcceptedStep {
    /// Is the step the full step of the complete model?
    pub(in crate::solve::newton::sheet) is_whole: bool,
    pub(super) had_curvature: bool,
}

impl Curvature {
    /// Turns curvature on again after [`ITERATIONS_OFF`] iterations.
    pub(super) fn expire(&mut self, iterations: u32) {
        self.off_until = self.off_until.filter(|&until| iterations < until);
    }
}

impl Robust {
    pub(in crate::solve::newton::sheet) fn has_curvature(&self) -> bool {
        self.curvature.off_until.is_none()
    }

    /// The final state of an iteration that converged with this step; `None` if the solution has to be iterated with
    /// curvature first.
    pub(in crate::solve::newton::sheet) fn confirm(&mut self, step: AcceptedStep) -> Option<State> {
        let Curvature { off_until, retries, is_saddle } = &mut self.curvature;
        if step.had_curvature || *retries >= MAX_RETRIES {
            return Some(if *is_saddle { State::Saddle } else { State::Converged });
        }
        *retries += 1;
        *off_until = None;
        None
    }
}

impl SheetNewton {
    /// Keeps the curvature of a definite model; else begins a model without curvature and returns false.
    pub(in crate::solve::newton::sheet) fn accept_curvature(&mut self, is_definite: bool) -> bool {
        self.system.robust.curvature.is_saddle = !is_definite;
        is_definite || !self.turns_curvature_off()
    }

    /// Handles a model that is not positive along a conjugate direction: turns curvature off, or accepts the current
    /// correction if curvature is off.
    pub(in crate::solve::newton::sheet) fn turn_to_definite_model(&mut self) {
        if !self.turns_curvature_off() {
            self.phase = Phase::Own(Piece::Correct);
        }
    }

    /// Begins a model without curvature; false if curvature is off.
    pub(super) fn turns_curvature_off(&mut self) -> bool {
        if !self.system.robust.has_curvature() {
            return false;
        }
        self.system.robust.curvature.off_until = Some(self.iterations + ITERATIONS_OFF);
        self.system.robust.has_earlier = false;
        self.last_step = f64::INFINITY;
        self.phase = Phase::Linearize { piece: 0 };
        true
    }
}

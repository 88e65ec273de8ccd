//! The dome's curvature under active nodes, on and off.
//!
//! Symptom: steps of a sheet over a needle lead uphill, or one node slides back and forth over the tip. Cause: the
//! curvature makes the model indefinite. Remedy: iterations without curvature for a while; each of their steps
//! leads downhill. Without curvature the model may be far too stiff (`overstiff-model-on-needle`), so that a solution
//! found so is tried with curvature again. A block that is indefinite at the solution itself is a saddle point: the
//! node would slide off (`active-node-on-needle-tip`, `unstable-node-on-needle-tip`).

use super::{Newton, Robust, State};

/// Iterations for which curvature stays off.
const ITERATIONS_OFF: u32 = 4;
/// How often a solution found without curvature is tried with curvature.
const MAX_RETRIES: u32 = 2;

/// Whether the model has the dome's curvature.
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
pub(in crate::solve::newton) struct AcceptedStep {
    /// Is the step that of the whole model, at full length?
    pub(in crate::solve::newton) is_whole: bool,
    pub(super) had_curvature: bool,
}

impl Curvature {
    /// Turns curvature on again once its time is over.
    pub(super) fn expire(&mut self, iterations: u32) {
        self.off_until = self.off_until.filter(|&until| iterations < until);
    }
}

impl Robust {
    pub(in crate::solve::newton) fn has_curvature(&self) -> bool {
        self.curvature.off_until.is_none()
    }

    /// The ending of an iteration that converged with this step; none if the solution is tried with curvature first.
    pub(in crate::solve::newton) fn confirm(&mut self, step: AcceptedStep) -> Option<State> {
        let Curvature { off_until, retries, is_saddle } = &mut self.curvature;
        if step.had_curvature || *retries >= MAX_RETRIES {
            return Some(if *is_saddle { State::Saddle } else { State::Converged });
        }
        *retries += 1;
        *off_until = None;
        None
    }
}

impl Newton {
    /// Keeps the curvature of a model that is definite; else the model is made anew without.
    pub(in crate::solve::newton) fn keeps_curvature(&mut self, is_definite: bool) -> bool {
        if !self.robust.has_curvature() {
            return true;
        }
        self.robust.curvature.is_saddle = !is_definite;
        is_definite || !self.turns_curvature_off()
    }

    /// The model is not positive along a conjugate direction: without curvature the correction so far is taken.
    pub(in crate::solve::newton) fn has_indefinite_model(&mut self) {
        if !self.turns_curvature_off() {
            self.phase = super::super::Phase::Correct;
        }
    }

    /// Makes the model anew without curvature; false if it has none.
    pub(super) fn turns_curvature_off(&mut self) -> bool {
        if !self.robust.has_curvature() {
            return false;
        }
        self.robust.curvature.off_until = Some(self.iterations + ITERATIONS_OFF);
        self.robust.has_earlier = false;
        self.last_step = f64::INFINITY;
        self.phase = super::super::Phase::Linearize { row: 0 };
        true
    }
}

//! Line search along the step, projected out of the obstacle, and the error estimate from step sizes.

use super::{Case, Newton, Phase, Refinement, State, System};
use crate::contact::Obstacle;
use crate::contact::active_set::ON_DOME;
use glam::DVec3;

/// A trial step.
pub(in crate::solve) struct Trial {
    /// Energy after the step \[kPa·mm³\].
    pub(super) energy: f64,
    /// Greatest move of a node \[mm\].
    pub(super) largest: f64,
    /// Decrease of the energy to first order.
    pub(super) predicted: f64,
    /// Rounding of the energy.
    pub(super) rounding: f64,
    /// Does the energy fall by a sufficient fraction of the prediction?
    is_descent: bool,
}

impl<S: System> Newton<S> {
    /// Tries the step at a length; accepts the step if the energy falls, else halves the length.
    pub(super) fn line_search(&mut self, case: &Case<S::Law>, length: f64, halvings: u32) -> State {
        let trial = self.try_step(case, length, halvings);
        if !trial.is_descent {
            let is_uphill = self.system.is_uphill(&trial);
            if is_uphill || halvings >= S::PARAMETERS.max_halvings {
                return S::reject_step(self, is_uphill);
            }
            self.phase = Phase::LineSearch { length: 0.5 * length, halvings: halvings + 1 };
            return State::Working;
        }
        std::mem::swap(&mut self.x, &mut self.trial);
        self.energy = trial.energy;
        self.revision += 1;
        self.phase = Phase::Linearize { piece: 0 };
        S::accept_step(self, case, &trial, halvings == 0)
    }

    fn try_step(&mut self, case: &Case<S::Law>, length: f64, halvings: u32) -> Trial {
        self.work_units += S::PARAMETERS.cost.energy;
        let holds_active = halvings == 0 || S::PARAMETERS.holds_halved_steps;
        let (mut largest, mut predicted) = (0.0_f64, 0.0);
        for layer in 0..self.x.len() {
            self.trial[layer].copy_from_slice(&self.x[layer]);
            for k in self.grid.free() {
                let from = self.x[layer][k];
                let mut to = from + self.d[layer][k] * length;
                if layer == 0 {
                    to = self.projected(&case.obstacle, k, to, holds_active);
                }
                let moved = to - from;
                largest = largest.max(moved.length_squared());
                predicted += moved.dot(self.forces[layer][k]);
                self.trial[layer][k] = to;
            }
        }
        let energy = self.system.energy(&self.grid, case, &self.trial);
        let rounding = S::PARAMETERS.energy_rounding * self.energy.abs()
            + self.system.energy_of_rounding(&self.grid);
        let sufficient = S::PARAMETERS.sufficient_decrease * predicted.max(0.0);
        let is_descent = energy <= self.energy - sufficient + rounding && energy.is_finite();
        Trial { energy, largest: largest.sqrt(), predicted, rounding, is_descent }
    }

    /// The position `to` of a node of the inner face, projected out of the obstacle. A node with `is_held` and an active
    /// constraint is projected onto the dome, because a tangential step leaves the curved surface.
    pub(super) fn projected(
        &self,
        obstacle: &Obstacle,
        k: usize,
        to: DVec3,
        is_held: bool,
    ) -> DVec3 {
        let offset = self.system.offset(k).abs();
        let is_held = is_held && self.contact.active[k] & ON_DOME != 0;
        obstacle.project(if is_held { obstacle.dome.project(to, offset) } else { to }, offset)
    }

    /// Estimates the error as the sum of a geometric series of steps, each `growth` times too short at most. A shortened
    /// step gives no estimate; of a stiff model the ratio of the steps is assumed.
    pub(super) fn estimate_error(
        &mut self,
        trial: &Trial,
        is_whole: bool,
        growth: f64,
        is_stiff: bool,
    ) {
        let most = S::PARAMETERS.max_convergence_factor;
        let least = self.refinement.map_or(0.0, Refinement::least_rate);
        let rate =
            if is_stiff { most } else { (trial.largest / self.last_step).min(most).max(least) };
        self.error = if is_whole && self.last_step.is_finite() {
            growth * trial.largest * rate / (1.0 - rate)
        } else {
            f64::INFINITY
        };
        self.last_step = if is_whole { trial.largest } else { f64::INFINITY };
    }

    /// The state of an iteration that ends: an estimate within the tolerance is convergence, although the last step was longer.
    pub(super) fn ended(&self, case: &Case<S::Law>) -> State {
        let is_near = self.is_balanced() && self.error <= case.tolerance;
        if is_near { State::Converged } else { State::Stalled }
    }

    /// Was the residual before the last step small? Without a balance of forces the lengths of steps are no evidence.
    pub(super) fn is_balanced(&self) -> bool {
        self.relative_residual <= S::PARAMETERS.max_residual_before_step
    }

    /// Are error and step within the tolerance, and was the residual before the step small? Contact may shorten a step
    /// without a balance of forces.
    pub(super) fn has_converged(
        &self,
        trial: &Trial,
        case: &Case<S::Law>,
        max_residual: f64,
    ) -> bool {
        self.error.max(trial.largest) <= case.tolerance && self.relative_residual <= max_residual
    }
}

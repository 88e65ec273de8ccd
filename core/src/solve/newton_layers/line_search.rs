//! Line search along the step, projected out of the obstacle, and the error estimate from step sizes.

use super::{Newton, Phase, cost, exact};
use crate::contact::Obstacle;
use crate::contact::active_set::ON_DOME;
use crate::model::layered::LayeredLaw;
use crate::solve::newton::State;
use crate::solve::problem::Problem;
use glam::DVec3;

/// Greatest number of halvings of a step.
const MAX_HALVINGS: u32 = 12;
/// Armijo's constant: required fraction of the predicted decrease of the energy \[-\].
const SUFFICIENT_DECREASE: f64 = 1e-4;
/// Rounding of an energy, relative to the energy \[-\].
const ENERGY_ROUNDING: f64 = 1e-12;
/// Upper bound of the assumed ratio of successive steps \[-\].
const MAX_CONVERGENCE_FACTOR: f64 = 0.95;
/// Greatest relative residual before the last step \[-\].
const MAX_RESIDUAL: f64 = 1e-2;

impl Newton {
    /// Tries the step at a length; accepts the step if the energy falls, else halves the length.
    pub(super) fn line_search(
        &mut self,
        law: &LayeredLaw,
        problem: &Problem,
        obstacle: &Obstacle,
        tolerance: f64,
        length: f64,
        halvings: u32,
    ) -> State {
        self.work_units += cost::ENERGY;
        let (mut largest, mut predicted) = (0.0_f64, 0.0);
        for layer in 0..self.x.len() {
            self.trial[layer].copy_from_slice(&self.x[layer]);
            for &k in &self.free {
                let k = k as usize;
                let from = self.x[layer][k];
                let mut to = from + self.d[layer][k] * length;
                if layer == 0 {
                    to = self.projected(obstacle, k, to);
                }
                let moved = to - from;
                largest = largest.max(moved.length_squared());
                predicted += moved.dot(self.forces[layer][k]);
                self.trial[layer][k] = to;
            }
        }
        let largest = largest.sqrt();
        let energy = exact(&self.sheet, law, problem).energy(&self.places, &self.trial);
        let rounding = ENERGY_ROUNDING * self.energy.abs();
        let sufficient = SUFFICIENT_DECREASE * predicted.max(0.0);
        let is_descent = energy <= self.energy - sufficient + rounding;
        if !is_descent {
            if halvings >= MAX_HALVINGS {
                return State::Stalled;
            }
            self.phase = Phase::LineSearch { length: 0.5 * length, halvings: halvings + 1 };
            return State::Working;
        }
        std::mem::swap(&mut self.x, &mut self.trial);
        self.energy = energy;
        self.revision += 1;
        self.phase = Phase::Linearize { place: 0 };
        let is_whole = halvings == 0;
        let rate = (largest / self.last_step).min(MAX_CONVERGENCE_FACTOR);
        self.error = if is_whole && self.last_step.is_finite() {
            largest * rate / (1.0 - rate)
        } else {
            f64::INFINITY
        };
        self.last_step = if is_whole { largest } else { f64::INFINITY };
        let is_converged =
            self.error.max(largest) <= tolerance && self.relative_residual <= MAX_RESIDUAL;
        if is_converged { State::Converged } else { State::Working }
    }

    /// The position `to` of a node of the inner face, projected out of the obstacle, an active node onto the dome.
    fn projected(&self, obstacle: &Obstacle, k: usize, to: DVec3) -> DVec3 {
        let is_held = self.active[k] & ON_DOME != 0;
        obstacle.project(if is_held { obstacle.dome.project(to, 0.0) } else { to }, 0.0)
    }
}

//! Line search along the step, projected out of the obstacle, and the error estimate from step sizes.

use super::{Newton, PARAMETERS, Phase, State, cost};
use crate::contact::Obstacle;
use crate::contact::active_set::ON_DOME;
use crate::model::membrane::assembly;
use crate::model::membrane::law::SheetLaw;
use glam::DVec3;

/// A trial step.
pub(super) struct Trial {
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

impl Newton {
    /// Tries the step at a length; accepts the step if the energy falls, else halves the length.
    pub(super) fn line_search(
        &mut self,
        law: &SheetLaw,
        obstacle: &Obstacle,
        tolerance: f64,
        length: f64,
        halvings: u32,
    ) -> State {
        if halvings == 0 {
            self.symmetrize_step();
        }
        let trial = self.try_step(law, obstacle, length, halvings);
        if !trial.is_descent {
            // Contact may turn the exact Hessian's step into an ascent; a shorter step may still descend.
            let is_uphill = trial.predicted <= 0.0 && !self.robust.is_exact_step();
            if is_uphill || halvings >= PARAMETERS.max_halvings {
                return self.reject_step(is_uphill);
            }
            self.phase = Phase::LineSearch { length: 0.5 * length, halvings: halvings + 1 };
            return State::Working;
        }
        std::mem::swap(&mut self.x, &mut self.trial);
        self.revision += 1;
        let step = self.robust.accept_step(halvings == 0, self.iterations);
        self.phase = Phase::Linearize { row: 0 };
        let is_compressive = self.model.totals.is_compressive(self.force_scale(law));
        self.estimate_error(&trial, step.is_whole, is_compressive);
        let has_growth = step.is_whole && self.is_too_short(&trial);
        if self.is_converged(&trial, tolerance, is_compressive, has_growth)
            && let Some(ending) = self.robust.confirm(step)
        {
            return ending;
        }
        self.extend_step(step.is_whole, has_growth, trial.energy);
        State::Working
    }

    fn try_step(
        &mut self,
        law: &SheetLaw,
        obstacle: &Obstacle,
        length: f64,
        halvings: u32,
    ) -> Trial {
        self.work_units += cost::ENERGY;
        self.trial.copy_from_slice(&self.x);
        let (mut largest, mut predicted) = (0.0_f64, 0.0);
        for &k in &self.free {
            let k = k as usize;
            let to = self.projected(obstacle, k, self.x[k] + self.d[k] * length, halvings == 0);
            let moved = to - self.x[k];
            largest = largest.max(moved.length_squared());
            predicted += moved.dot(self.forces[k]);
            self.trial[k] = to;
        }
        let energy = assembly::energy(&self.sheet, law, &self.trial);
        // Rounding of the sum of energies and of the positions.
        let totals = &self.model.totals;
        let position = f64::EPSILON * self.sheet.radius_mm();
        let rounding =
            PARAMETERS.energy_rounding * totals.energy.abs() + position * totals.force_scale();
        let sufficient = PARAMETERS.sufficient_decrease * predicted.max(0.0);
        let is_descent = energy <= totals.energy - sufficient + rounding && energy.is_finite();
        Trial { energy, largest: largest.sqrt(), predicted, rounding, is_descent }
    }

    /// The position `to` of a node, projected out of the obstacle. A node with `is_held` and an active constraint is
    /// projected onto the dome, because a tangential step leaves the curved surface.
    pub(super) fn projected(
        &self,
        obstacle: &Obstacle,
        k: usize,
        to: DVec3,
        is_held: bool,
    ) -> DVec3 {
        let offset = self.contact.offset[k].abs();
        let is_held = is_held && self.contact.active[k] & ON_DOME != 0;
        obstacle.project(if is_held { obstacle.dome.project(to, offset) } else { to }, offset)
    }

    /// Estimates the error as the sum of a geometric series of steps.
    ///
    /// A shortened step gives no estimate. With a model that is too stiff, one small step is not evidence of
    /// convergence: near-zero stiffness may follow.
    fn estimate_error(&mut self, trial: &Trial, is_whole: bool, is_compressive: bool) {
        let most = PARAMETERS.max_convergence_factor;
        let growth = self.robust.step_growth;
        let is_stiff = growth > 1.0 || is_compressive;
        let rate = if is_stiff { most } else { (trial.largest / self.last_step).min(most) };
        self.error = if is_whole && self.last_step.is_finite() {
            growth * trial.largest * rate / (1.0 - rate)
                + self.last_round.min(trial.largest)
                + self.robust.extrapolation
        } else {
            f64::INFINITY
        };
        self.last_step = if is_whole { trial.largest } else { f64::INFINITY };
        self.robust.decay_extrapolation();
    }

    /// Are error and step within the tolerance, and was the residual before the step small? Contact may shorten a step
    /// without a balance of forces. The first step that was too short proves the estimate too small.
    fn is_converged(
        &self,
        trial: &Trial,
        tolerance: f64,
        is_compressive: bool,
        has_growth: bool,
    ) -> bool {
        let max_residual = if is_compressive {
            PARAMETERS.max_compressive_residual
        } else {
            PARAMETERS.max_residual_before_step
        };
        self.error.max(trial.largest) <= tolerance
            && self.relative_residual <= max_residual
            && (!has_growth || self.robust.step_growth > 1.0)
    }
}

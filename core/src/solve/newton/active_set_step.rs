//! The step under the linearised constraints: projected sweeps, coarse operators, corrections.

use super::{CgState, Model, Newton, PARAMETERS, Phase, cost};
use crate::contact::Obstacle;
use crate::solve::linear::galerkin::Finest;

impl Newton {
    /// Two projected Gauss–Seidel sweeps on the model find the active constraints.
    pub(super) fn find_active_set(&mut self) {
        self.contact.changed = 0;
        let count = self.free.len();
        for k in 0..count {
            self.relax(self.free[k] as usize);
        }
        for k in (0..count).rev() {
            self.relax(self.free[k] as usize);
        }
        self.work_units += 2.0 * cost::SWEEP;
        for k in 0..count {
            self.constrain(self.free[k] as usize);
        }
        self.phase = if self.model.is_built { self.begin_cg() } else { Phase::Build { piece: 0 } };
    }

    /// Minimises the model over one node's step under the node's constraints.
    #[inline]
    fn relax(&mut self, k: usize) {
        let Model { hessian, inverse, .. } = &self.model;
        let rhs = self.forces[k] - hessian.off_diagonal(k, &self.d);
        let constraint = &self.contact.constraint[k];
        let (d, active) = constraint.step(rhs, &hessian.diagonal[k], &inverse[k]);
        self.contact.changed += usize::from(self.contact.active[k] != active);
        self.contact.active[k] = active;
        self.d[k] = d;
    }

    /// Sets a node's projector onto the unconstrained directions, and the inverse block in these directions.
    pub(super) fn constrain(&mut self, k: usize) {
        let (constraint, active) = (&self.contact.constraint[k], self.contact.active[k]);
        let Model { hessian, inverse, tangent_inverse, projector, .. } = &mut self.model;
        projector[k] = constraint.projector(active);
        tangent_inverse[k] =
            constraint.constrained_inverse(active, inverse[k], &hessian.diagonal[k]);
    }

    pub(super) fn build(&mut self, piece: usize) {
        let Model { hessian, hierarchy, tangent_inverse, projector, .. } = &mut self.model;
        let finest =
            Finest { blocks: hessian, inverse: tangent_inverse, projector, free: &self.free };
        if !hierarchy.build(&finest, piece) {
            self.phase = Phase::Build { piece: piece + 1 };
            return;
        }
        self.work_units += cost::BUILD;
        self.model.is_built = true;
        self.phase = self.begin_cg();
    }

    /// Sets the residual of the model at the current step and a zero correction.
    fn begin_cg(&mut self) -> Phase {
        let start = self.set_residual();
        if self.robust.has_sweeps_only()
            || start <= PARAMETERS.cg_floor * self.model.totals.force_scale()
        {
            return Phase::Correct;
        }
        Phase::ConjugateGradients(CgState { step: 0, start, rho: 0.0 })
    }

    /// Ends a round: the next phase is another round or the line search.
    pub(super) fn correct(&mut self, obstacle: &Obstacle, tolerance: f64) {
        let (change, step) = self.add_correction(obstacle);
        self.last_round = change;
        self.rounds += 1;
        let is_settled = change <= PARAMETERS.round_tolerance * step && self.contact.changed == 0
            || change <= PARAMETERS.round_floor * tolerance;
        self.phase = if is_settled || self.rounds >= PARAMETERS.max_rounds {
            Phase::LineSearch { length: 1.0, halvings: 0 }
        } else {
            Phase::ActiveSet
        };
    }

    /// Adds the correction to the step, under the constraints; returns the greatest change and step of a node
    /// \[mm\].
    pub(super) fn add_correction(&mut self, obstacle: &Obstacle) -> (f64, f64) {
        let (mut largest, mut step) = (0.0_f64, 0.0_f64);
        for &k in &self.free {
            let k = k as usize;
            let constraint = &self.contact.constraint[k];
            let mut d = self.d[k] + self.vectors.q[k];
            let penetration = -constraint.gap - constraint.normal.dot(d);
            if penetration > 0.0 {
                d += constraint.normal * penetration;
            }
            let d = obstacle.wall.limited_step(self.x[k], d);
            largest = largest.max((d - self.d[k]).length_squared());
            step = step.max(d.length_squared());
            self.d[k] = d;
        }
        (largest.sqrt(), step.sqrt())
    }
}

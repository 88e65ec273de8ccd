//! The step under the linearised constraints: projected sweeps, coarse operators, corrections.

use super::{CgState, PARAMETERS, Phase, Piece, SheetCase, SheetNewton, SheetSystem, cost, finest};
use crate::solve::newton::conjugate_gradients::{add, project};
use glam::DVec3;

impl SheetNewton {
    /// Two projected Gauss–Seidel sweeps on the model find the active constraints.
    pub(super) fn find_active_set(&mut self) {
        self.system.changed = 0;
        let count = self.grid.free.len();
        for k in 0..count {
            self.relax(self.grid.free[k] as usize);
        }
        for k in (0..count).rev() {
            self.relax(self.grid.free[k] as usize);
        }
        self.work_units += 2.0 * cost::SWEEP;
        for k in 0..count {
            self.constrain(self.grid.free[k] as usize);
        }
        self.phase = if self.system.is_built {
            self.begin_cg()
        } else {
            Phase::Own(Piece::Build { piece: 0 })
        };
    }

    /// Minimises the model over one node's step under the node's constraints.
    #[inline]
    fn relax(&mut self, k: usize) {
        let SheetSystem { hessian, inverse, changed, .. } = &mut self.system;
        let d = &mut self.d[0];
        let rhs = self.forces[0][k] - hessian.off_diagonal(k, d);
        let constraint = &self.contact.constraint[k];
        let (step, active) = constraint.step(rhs, &hessian.diagonal[k], &inverse[k]);
        *changed += usize::from(self.contact.active[k] != active);
        self.contact.active[k] = active;
        d[k] = step;
    }

    pub(super) fn build(&mut self, piece: usize) {
        let SheetSystem { hessian, hierarchy, is_built, .. } = &mut self.system;
        if !hierarchy.build(&finest(hessian, &self.grid, &self.contact), piece) {
            self.phase = Phase::Own(Piece::Build { piece: piece + 1 });
            return;
        }
        self.work_units += cost::BUILD;
        *is_built = true;
        self.phase = self.begin_cg();
    }

    /// Sets the residual of the model at the current step and a zero correction.
    fn begin_cg(&mut self) -> Phase<Piece> {
        let start = self.begin_correction();
        if self.system.robust.has_sweeps_only()
            || start <= PARAMETERS.cg_floor * self.system.totals.force_scale()
        {
            return Phase::Own(Piece::Correct);
        }
        Phase::ConjugateGradients(CgState { step: 0, start, rho: 0.0 })
    }

    /// Sets `r` to the residual of the model at the current step, `q` to zero; returns the residual's norm.
    pub(super) fn begin_correction(&mut self) -> f64 {
        self.system.q[0].fill(DVec3::ZERO);
        self.set_residual();
        self.project_residual()
    }

    /// One step, added to `q`; returns r·z and the norm of the remaining residual. `None`, without a step, if the model
    /// is not positive along `p`.
    pub(super) fn cg_step(&mut self, step: u32, rho_before: f64) -> Option<(f64, f64)> {
        self.work_units += cost::CYCLE;
        let rho = self.precondition();
        self.turn(if step == 0 { 0.0 } else { rho / rho_before });
        project(&self.grid, &self.contact, &mut self.vectors.product[0]);
        let bend = self.bend();
        if !(bend > 0.0 && rho > 0.0) {
            return None;
        }
        let alpha = rho / bend;
        add(&self.grid.free, &mut self.system.q, &self.vectors.p, alpha);
        Some((rho, self.reduce_residual(alpha)))
    }

    /// Ends a round: the next phase is another round or the line search.
    pub(super) fn correct(&mut self, case: &SheetCase) {
        let (change, step) = self.add_correction(case);
        self.system.last_round = change;
        self.rounds += 1;
        let is_settled = change <= PARAMETERS.round_tolerance * step && self.system.changed == 0
            || change <= PARAMETERS.round_floor * case.tolerance;
        self.phase = if is_settled || self.rounds >= PARAMETERS.max_rounds {
            Phase::LineSearch { length: 1.0, halvings: 0 }
        } else {
            Phase::ActiveSet
        };
    }

    /// Adds the correction to the step, under the constraints; returns the greatest change and step of a node
    /// \[mm\].
    pub(super) fn add_correction(&mut self, case: &SheetCase) -> (f64, f64) {
        let (mut largest, mut step) = (0.0_f64, 0.0_f64);
        let (x, d, q) = (&self.x[0], &mut self.d[0], &self.system.q[0]);
        for k in self.grid.free() {
            let constraint = &self.contact.constraint[k];
            let mut next = d[k] + q[k];
            let penetration = -constraint.gap - constraint.normal.dot(next);
            if penetration > 0.0 {
                next += constraint.normal * penetration;
            }
            let next = case.obstacle.wall.limited_step(x[k], next);
            largest = largest.max((next - d[k]).length_squared());
            step = step.max(next.length_squared());
            d[k] = next;
        }
        (largest.sqrt(), step.sqrt())
    }
}

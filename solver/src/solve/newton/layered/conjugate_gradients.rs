//! Conjugate gradients along the step, as far as the quadratic model is trusted.

use super::{CgState, LayeredNewton, PARAMETERS, Phase};
use crate::solve::newton::Refinement;
use crate::solve::newton::conjugate_gradients::{add, longest};

impl LayeredNewton {
    /// Moves constrained nodes of the step onto the constraints and starts a round of linear solution.
    pub(super) fn begin_gradients(&mut self) {
        for k in self.grid.free() {
            let active = self.contact.active[k];
            self.d[0][k] = self.contact.constraint[k].onto(active, self.d[0][k]);
        }
        self.phase = Phase::ConjugateGradients(CgState { step: 0, start: 0.0, rho: 0.0 });
    }

    /// One step; after the last step the next phase is the active set. `start` is √(r·z) of the first step.
    pub(super) fn conjugate_gradients(&mut self, before: CgState) {
        let CgState { step, .. } = before;
        if step == 0 {
            self.set_residual();
            self.project_residual();
        }
        let rho = self.precondition();
        let norm = rho.max(0.0).sqrt();
        let start = if step == 0 { norm } else { before.start };
        let is_near = self.relative_residual < PARAMETERS.near;
        let usual = if is_near { PARAMETERS.cg_drop_near } else { PARAMETERS.cg_drop };
        let drop = self.refinement.map_or(usual, Refinement::drop);
        let is_small = step > 0 && norm <= drop * start;
        if rho <= 0.0 || !rho.is_finite() || is_small || step >= PARAMETERS.max_cg_steps {
            self.phase = Phase::ActiveSet;
            return;
        }
        self.turn(if step == 0 { 0.0 } else { rho / before.rho });
        let bend = self.bend();
        let has_negative_curvature = bend <= 0.0 || !bend.is_finite();
        let alpha = if has_negative_curvature { 1.0 } else { rho / bend };
        // Along negative curvature without a step so far: along the preconditioned forces.
        if !has_negative_curvature || step == 0 {
            add(&self.grid.free, &mut self.d, &self.vectors.p, alpha);
        }
        let far = PARAMETERS.max_move * self.grid.sheet().spacing_mm();
        let move_mm = longest(&self.grid.free, &self.d);
        if has_negative_curvature || move_mm > far {
            return self.end_gradients((far / move_mm).min(1.0));
        }
        self.reduce_residual(alpha);
        self.project_residual();
        self.phase = Phase::ConjugateGradients(CgState { step: step + 1, start, rho });
    }

    /// Ends conjugate gradients with a part of the step so far.
    fn end_gradients(&mut self, part: f64) {
        for d in &mut self.d {
            for k in self.grid.free() {
                d[k] *= part;
            }
        }
        // A shortened step is no step of Newton's method.
        self.phase = Phase::LineSearch { length: 1.0, halvings: u32::from(part < 1.0) };
    }
}

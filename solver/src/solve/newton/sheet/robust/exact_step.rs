//! The step of the exact Hessian, before a solution is accepted.
//!
//! Symptom: error estimates up to a thousand times too small under compression (`near-zero-stiffness-before-wrinkling`,
//! `premature-stall-before-wrinkling`). Cause: the positive semidefinite model is much too stiff near zero stiffness and
//! at a saddle point. Remedy: conjugate gradients on the exact Hessian give the exact step or a direction of
//! negative curvature. If contact blocks the exact step, the iteration continues, and ends after several consecutive
//! blocked steps (`path-blocked-before-wrinkling`).

use super::{
    CgState, HessianUse, Phase, Piece, Purpose, SafeguardPhase, SheetCase, SheetNewton, State,
};
use crate::model::membrane::law::SheetLaw;
use crate::solve::newton::conjugate_gradients::{add, longest};
use glam::DVec3;

/// Steps of conjugate gradients, and the drop of the residual.
const MAX_CG_STEPS: u32 = 60;
const CG_DROP: f64 = 1e-3;
/// Error of a solution \[lengths of the exact step\]: the exact Hessian is valid near one shape only.
const EXACT_STEP_SAFETY: f64 = 2.0;
/// Length of a step along a direction of negative curvature \[tolerances\].
const NEGATIVE_CURVATURE_STEP: f64 = 10.0;
/// Number of consecutive blocked exact steps that ends the iteration.
const MAX_BLOCKED: u32 = 3;

impl SheetNewton {
    /// Is an exact step required at this shape? True under compression unless evaluated; the paper's springs may be
    /// compressive anywhere.
    pub(in crate::solve::newton::sheet) fn needs_exact_step(&self, law: &SheetLaw) -> bool {
        let may_be_compressive = matches!(law, SheetLaw::Paper(_)) || self.is_compressive(law);
        !self.system.robust.is_exact_step() && may_be_compressive
    }

    /// Begins the evaluation of the exact step. [`Self::step`] ends in [`State::Converged`] if the step is short enough
    /// or blocked several times in a row, else the iteration continues along it.
    pub(in crate::solve::newton::sheet) fn begin_exact_step(&mut self) {
        let phase = SafeguardPhase::ExactHessian { row: 0, purpose: Purpose::Step };
        self.phase = Phase::Own(Piece::Robust(phase));
    }

    pub(super) fn begin_exact_cg(&mut self) {
        self.d[0].fill(DVec3::ZERO);
        let start = self.begin_correction();
        let cg = CgState { step: 0, start, rho: 0.0 };
        self.phase = Phase::Own(Piece::Robust(SafeguardPhase::ExactStep(cg)));
    }

    /// One step of conjugate gradients; after the last step tests the length of the exact step.
    pub(super) fn exact_cg(
        &mut self,
        case: &SheetCase,
        CgState { step, start, rho }: CgState,
    ) -> State {
        let next = self.cg_step(step, rho);
        if let Some((rho, left)) = next
            && step + 1 < MAX_CG_STEPS
            && left > CG_DROP * start
        {
            let cg = CgState { step: step + 1, start, rho };
            self.phase = Phase::Own(Piece::Robust(SafeguardPhase::ExactStep(cg)));
            return State::Working;
        }
        if next.is_none() && self.bend() < 0.0 {
            self.add_negative_curvature(case.tolerance);
        }
        self.symmetrize_correction();
        let (_, length) = self.add_correction(case);
        self.system.robust.hessian = HessianUse::Exact;
        if EXACT_STEP_SAFETY * length > case.tolerance {
            self.last_step = f64::INFINITY;
            self.phase = Phase::LineSearch { length: 1.0, halvings: 0 };
            return State::Working;
        }
        self.error = self.error.max(EXACT_STEP_SAFETY * length);
        State::Converged
    }

    /// Adds a descent step along the conjugate direction p of negative curvature.
    fn add_negative_curvature(&mut self, tolerance: f64) {
        let downhill = self.dot(&self.vectors.p, &self.forces).signum();
        let (p, q, free) = (&self.vectors.p, &mut self.system.q, &self.grid.free);
        let length = longest(free, q).max(NEGATIVE_CURVATURE_STEP * tolerance);
        add(free, q, p, downhill * length / longest(free, p));
    }

    /// Counts a failed line search along an exact step; true at [`MAX_BLOCKED`].
    pub(super) fn count_blocked_step(&mut self) -> bool {
        if !self.system.robust.is_exact_step() {
            return false;
        }
        self.system.robust.blocked += 1;
        self.system.robust.blocked >= MAX_BLOCKED
    }
}

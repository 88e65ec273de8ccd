//! The step of the exact Hessian, before a solution is accepted.
//!
//! Symptom: error estimates up to a thousand times too small under compression (`near-zero-stiffness-before-wrinkling`,
//! `premature-stall-before-wrinkling`). Cause: the positive semidefinite model is much too stiff near zero stiffness and
//! at a saddle point. Remedy: conjugate gradients on the exact Hessian give the exact step or a direction of
//! negative curvature. If contact blocks the exact step, the iteration continues, and ends after several consecutive
//! blocked steps (`path-blocked-before-wrinkling`).

use super::super::conjugate_gradients::dot;
use super::super::{CgState, Phase};
use super::{HessianUse, Newton, Purpose, SafeguardPhase, State};
use crate::contact::Obstacle;
use crate::model::membrane::law::SheetLaw;
use crate::springs::Springs;
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

impl Newton {
    /// Is an exact step required at this shape? True under compression unless evaluated; the paper's springs may be
    /// compressive anywhere.
    pub(in crate::solve::newton) fn needs_exact_step(
        &self,
        springs: Springs,
        law: &SheetLaw,
    ) -> bool {
        let may_be_compressive =
            springs == Springs::Nikolaev || self.model.totals.is_compressive(self.force_scale(law));
        !self.robust.is_exact_step() && may_be_compressive
    }

    /// Begins the evaluation of the exact step. [`Self::step`] ends in [`State::Converged`] if the step is short enough
    /// or blocked several times in a row, else the iteration continues along it.
    pub(in crate::solve::newton) fn begin_exact_step(&mut self) {
        let phase = SafeguardPhase::ExactHessian { row: 0, purpose: Purpose::Step };
        self.phase = Phase::Robust(phase);
    }

    pub(super) fn begin_exact_cg(&mut self) {
        self.free.iter().for_each(|&k| self.d[k as usize] = DVec3::ZERO);
        let start = self.set_residual();
        let cg = CgState { step: 0, start, rho: 0.0 };
        self.phase = Phase::Robust(SafeguardPhase::ExactStep(cg));
    }

    /// One step of conjugate gradients; after the last step tests the length of the exact step. `tolerance` \[mm\].
    pub(super) fn exact_cg(
        &mut self,
        obstacle: &Obstacle,
        CgState { step, start, rho }: CgState,
        tolerance: f64,
    ) -> State {
        let next = self.cg_step(step, rho);
        if let Some((rho, left)) = next
            && step + 1 < MAX_CG_STEPS
            && left > CG_DROP * start
        {
            let cg = CgState { step: step + 1, start, rho };
            self.phase = Phase::Robust(SafeguardPhase::ExactStep(cg));
            return State::Working;
        }
        // z contains H p here.
        if next.is_none() && dot(&self.free, &self.vectors.p, &self.vectors.z) < 0.0 {
            self.add_negative_curvature(tolerance);
        }
        self.symmetrize_correction();
        let (_, length) = self.add_correction(obstacle);
        self.robust.hessian = HessianUse::Exact;
        if EXACT_STEP_SAFETY * length > tolerance {
            self.last_step = f64::INFINITY;
            self.phase = Phase::LineSearch { length: 1.0, halvings: 0 };
            return State::Working;
        }
        self.error = self.error.max(EXACT_STEP_SAFETY * length);
        State::Converged
    }

    /// Adds a descent step along the conjugate direction p of negative curvature.
    fn add_negative_curvature(&mut self, tolerance: f64) {
        let (v, free) = (&mut self.vectors, &self.free);
        let longest = |v: &[DVec3]| {
            free.iter().map(|&k| v[k as usize].length_squared()).fold(0.0, f64::max).sqrt()
        };
        let downhill = dot(free, &v.p, &self.forces).signum();
        let length = longest(&v.q).max(NEGATIVE_CURVATURE_STEP * tolerance);
        let scale = downhill * length / longest(&v.p);
        for &k in free {
            let k = k as usize;
            v.q[k] += v.p[k] * scale;
        }
    }

    /// Counts a failed line search along an exact step; true at [`MAX_BLOCKED`].
    pub(super) fn count_blocked_step(&mut self) -> bool {
        if !self.robust.is_exact_step() {
            return false;
        }
        self.robust.blocked += 1;
        self.robust.blocked >= MAX_BLOCKED
    }
}

//! Saddle points of the paper's springs.
//!
//! Symptom: convergence to a saddle point. Cause: the energy of the paper's springs is not convex. Remedy: the least
//! eigenvalue of the exact Hessian, by preconditioned descent of the Rayleigh quotient (A. V. Knyazev, "Preconditioned
//! eigensolvers", ETNA 7, 1998).

use super::super::conjugate_gradients::{apply, dot};
use super::super::{Model, Phase, cost};
use super::{Newton, Purpose, SafeguardPhase, State};
use crate::model::membrane::law::SheetLaw;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// Steps of the search.
const MAX_STEPS: u32 = 60;
/// The negative eigenvalue that counts as instability \[small-strain stiffness\].
const UNSTABLE: f64 = 1e-3;
/// Norm of a search direction at the rounding level \[-\].
const ROUNDING: f64 = 1e-14;

impl Newton {
    /// Begins the search for the least eigenvalue; [`Self::step`] ends in `after` unless the eigenvalue is negative.
    pub(in crate::solve::newton) fn begin_stability(&mut self, after: State) {
        let purpose = Purpose::Stability(after);
        self.phase = Phase::Robust(SafeguardPhase::ExactHessian { row: 0, purpose });
    }

    /// Begins with a direction that contains all wavelengths.
    pub(super) fn begin_eigenvalue_search(&mut self, after: State) {
        self.vectors.p.fill(DVec3::ZERO);
        for &k in &self.free {
            let k = k as usize;
            let t = k as f64;
            let start = DVec3::new((12.9 * t).sin(), (78.2 * t).sin(), (37.7 * t).sin());
            self.vectors.p[k] = self.model.projector[k] * start;
        }
        self.phase = Phase::Robust(SafeguardPhase::Stability { step: 0, after });
    }

    /// One step towards the least eigenvalue, the V-cycle of the last model as preconditioner.
    pub(super) fn search_eigenvalue(&mut self, law: &SheetLaw, step: u32, after: State) -> State {
        self.work_units += 2.0 * cost::SWEEP + cost::CYCLE;
        let Model { hessian, projector, .. } = &self.model;
        let (v, free) = (&mut self.vectors, &self.free);
        let scale = dot(free, &v.p, &v.p).sqrt().recip();
        for &k in free {
            v.p[k as usize] *= scale;
        }
        apply(hessian, projector, free, &v.p, &mut v.q);
        let quotient = dot(free, &v.p, &v.q);
        if quotient < -UNSTABLE * law.stiffness() {
            return State::Unstable;
        }
        if step >= MAX_STEPS || !quotient.is_finite() {
            return after;
        }
        for &k in free {
            let k = k as usize;
            v.r[k] = v.q[k] - v.p[k] * quotient;
        }
        self.precondition();
        // The best combination of p and z, z made orthogonal to p.
        let Model { hessian, projector, .. } = &self.model;
        let (v, free) = (&mut self.vectors, &self.free);
        let overlap = dot(free, &v.p, &v.z);
        for &k in free {
            let k = k as usize;
            v.z[k] = projector[k] * (v.z[k] - v.p[k] * overlap);
        }
        let norm = dot(free, &v.z, &v.z).sqrt();
        if norm <= ROUNDING {
            return after;
        }
        apply(hessian, projector, free, &v.z, &mut self.d);
        let across = dot(free, &v.p, &self.d) / norm;
        let other = dot(free, &v.z, &self.d) / (norm * norm);
        let angle = 0.5 * (2.0 * across).atan2(quotient - other) + FRAC_PI_2;
        let (sin, cos) = angle.sin_cos();
        for &k in free {
            let k = k as usize;
            v.p[k] = v.p[k] * cos + v.z[k] * (sin / norm);
        }
        self.phase = Phase::Robust(SafeguardPhase::Stability { step: step + 1, after });
        State::Working
    }
}

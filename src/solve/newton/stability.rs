//! Is the shape a minimum or a saddle? The least eigenvalue of the true Hessian tells.

use super::conjugate::{apply, dot};
use super::{CYCLE_UNITS, Newton, Phase, Question, SWEEP_UNITS, State};
use crate::solve::law::SheetLaw;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// Steps of the search for a falling direction, and the eigenvalue that counts as falling
/// \[share of the springs' small-strain stiffness\].
const STABILITY_STEPS: u32 = 60;
const UNSTABLE_SHARE: f64 = 1e-3;

impl Newton {
    /// Begins the search for a direction in which the energy falls; [`Self::step`] goes on with it and
    /// ends in `after` when there is none.
    pub(crate) fn begin_stability(&mut self, after: State) {
        self.phase = Phase::Stiffen { row: 0, question: Question::IsStable(after) };
    }

    /// Begins with the direction.
    pub(super) fn begin_probe(&mut self, after: State) {
        self.p.fill(DVec3::ZERO);
        for &k in &self.free {
            let k = k as usize;
            // Any start will do that leaves no wave out.
            let t = k as f64;
            let start = DVec3::new((12.9 * t).sin(), (78.2 * t).sin(), (37.7 * t).sin());
            self.p[k] = self.projector[k] * start;
        }
        self.phase = Phase::Stability { step: 0, after };
    }

    /// One step towards the least eigenvalue of the true Hessian in the directions that may move:
    /// preconditioned descent of the Rayleigh quotient (A. V. Knyazev, "Preconditioned
    /// eigensolvers", ETNA 7, 1998), the last model's V-cycle as preconditioner.
    pub(super) fn probe(&mut self, law: &SheetLaw, step: u32, after: State) -> State {
        self.work_units += 2.0 * SWEEP_UNITS + CYCLE_UNITS;
        let scale = dot(&self.free, &self.p, &self.p).sqrt().recip();
        for &k in &self.free {
            self.p[k as usize] *= scale;
        }
        apply(&self.hessian, &self.projector, &self.free, &self.p, &mut self.q);
        let quotient = dot(&self.free, &self.p, &self.q);
        if quotient < -UNSTABLE_SHARE * law.stiffness() {
            return State::Unstable;
        }
        if step >= STABILITY_STEPS || !quotient.is_finite() {
            return after;
        }
        for &k in &self.free {
            let k = k as usize;
            self.r[k] = self.q[k] - self.p[k] * quotient;
        }
        self.precondition();
        // The best combination of p and z, z made orthogonal to p.
        let overlap = dot(&self.free, &self.p, &self.z);
        for &k in &self.free {
            let k = k as usize;
            self.z[k] = self.projector[k] * (self.z[k] - self.p[k] * overlap);
        }
        let norm = dot(&self.free, &self.z, &self.z).sqrt();
        if norm <= 1e-14 {
            return after;
        }
        apply(&self.hessian, &self.projector, &self.free, &self.z, &mut self.d);
        let across = dot(&self.free, &self.p, &self.d) / norm;
        let other = dot(&self.free, &self.z, &self.d) / (norm * norm);
        let angle = 0.5 * (2.0 * across).atan2(quotient - other) + FRAC_PI_2;
        let (sin, cos) = angle.sin_cos();
        for &k in &self.free {
            let k = k as usize;
            self.p[k] = self.p[k] * cos + self.z[k] * (sin / norm);
        }
        self.phase = Phase::Stability { step: step + 1, after };
        State::Working
    }
}

//! Saddle points of the paper's springs.
//!
//! Symptom: convergence to a saddle point. Cause: the energy of the paper's springs is not convex. Remedy: the least
//! eigenvalue of the exact Hessian, by preconditioned descent of the Rayleigh quotient (A. V. Knyazev, "Preconditioned
//! eigensolvers", ETNA 7, 1998).

use super::{Phase, Piece, SafeguardPhase, SheetNewton, State, System, cost};
use crate::model::membrane::law::SheetLaw;
use crate::solve::newton::conjugate_gradients::{Vectors, project};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// Steps of the search.
const MAX_STEPS: u32 = 60;
/// The negative eigenvalue that counts as instability \[small-strain stiffness\].
const UNSTABLE: f64 = 1e-3;
/// Norm of a search direction at the rounding level \[-\].
const ROUNDING: f64 = 1e-14;

impl SheetNewton {
    /// Begins the search for the least eigenvalue; [`Self::step`] ends in `after` unless the eigenvalue is negative.
    pub(in crate::solve::newton::sheet) fn begin_stability(&mut self, after: State) {
        self.phase = Phase::Own(Piece::Robust(SafeguardPhase::ExactHessian { row: 0, after }));
    }

    /// Begins with a direction that contains all wavelengths.
    pub(super) fn begin_eigenvalue_search(&mut self, after: State) {
        self.vectors.p[0].fill(DVec3::ZERO);
        for k in self.grid.free() {
            let t = k as f64;
            let start = DVec3::new((12.9 * t).sin(), (78.2 * t).sin(), (37.7 * t).sin());
            self.vectors.p[0][k] = self.contact.projector[k] * start;
        }
        self.phase = Phase::Own(Piece::Robust(SafeguardPhase::Stability { step: 0, after }));
    }

    /// One step towards the least eigenvalue, the V-cycle of the last model as preconditioner.
    pub(super) fn search_eigenvalue(&mut self, law: &SheetLaw, step: u32, after: State) -> State {
        self.work_units += 2.0 * cost::SWEEP + cost::CYCLE;
        let scale = self.dot(&self.vectors.p, &self.vectors.p).sqrt().recip();
        let (grid, contact) = (&self.grid, &self.contact);
        let (system, Vectors { p, product, .. }) = (&self.system, &mut self.vectors);
        for k in grid.free() {
            p[0][k] *= scale;
        }
        system.product(grid, contact, p, product);
        project(grid, contact, &mut product[0]);
        let quotient = self.dot(&self.vectors.p, &self.vectors.product);
        if quotient < -UNSTABLE * law.stiffness() {
            return State::Unstable;
        }
        if step >= MAX_STEPS || !quotient.is_finite() {
            return after;
        }
        let Vectors { r, p, product, .. } = &mut self.vectors;
        for k in self.grid.free() {
            r[0][k] = product[0][k] - p[0][k] * quotient;
        }
        self.precondition();
        // The best combination of p and z, z made orthogonal to p.
        let overlap = self.dot(&self.vectors.p, &self.vectors.z);
        let Vectors { z, p, product, .. } = &mut self.vectors;
        for k in self.grid.free() {
            z[0][k] = self.contact.projector[k] * (z[0][k] - p[0][k] * overlap);
        }
        self.system.product(&self.grid, &self.contact, z, product);
        project(&self.grid, &self.contact, &mut product[0]);
        let Vectors { z, p, product, .. } = &self.vectors;
        let norm = self.dot(z, z).sqrt();
        if norm <= ROUNDING {
            return after;
        }
        let across = self.dot(p, product) / norm;
        let other = self.dot(z, product) / (norm * norm);
        let angle = 0.5 * (2.0 * across).atan2(quotient - other) + FRAC_PI_2;
        let (sin, cos) = angle.sin_cos();
        let Vectors { z, p, .. } = &mut self.vectors;
        for k in self.grid.free() {
            p[0][k] = p[0][k] * cos + z[0][k] * (sin / norm);
        }
        self.phase = Phase::Own(Piece::Robust(SafeguardPhase::Stability { step: step + 1, after }));
        State::Working
    }
}

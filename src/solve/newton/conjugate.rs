//! Conjugate gradients on the model, in the directions that may move, a V-cycle as preconditioner.

use super::{CYCLE_UNITS, Newton, Phase, SWEEP_UNITS};
use crate::solve::blocks::Blocks;
use crate::solve::multigrid::Finest;
use glam::{DMat3, DVec3};

/// Conjugate-gradient steps in one round.
const MAX_CG: u32 = 12;
/// Residual drop asked of one round.
const CG_DROP: f64 = 0.3;

impl Newton {
    /// The residual of the model at the step so far, and no correction yet.
    pub(super) fn begin_cg(&mut self) -> Phase {
        let start = self.set_residual();
        if self.is_plain || start <= 1e-16 * self.totals.force_scale() {
            return Phase::Correct;
        }
        Phase::Cg { step: 0, start, rho: 0.0 }
    }

    /// Sets `r` to the residual of the model at the step so far, `q` to zero; gives the residual's norm.
    pub(super) fn set_residual(&mut self) -> f64 {
        self.work_units += SWEEP_UNITS;
        let mut squares = 0.0;
        for &k in &self.free {
            let k = k as usize;
            self.r[k] = self.projector[k] * (self.forces[k] - self.hessian.row(k, &self.d));
            squares += self.r[k].length_squared();
            self.q[k] = DVec3::ZERO;
        }
        squares.sqrt()
    }

    /// One step of conjugate gradients; the last one goes on to what comes after them.
    pub(super) fn cg(&mut self, step: u32, start: f64, rho: f64) {
        let Some((rho, left)) = self.cg_step(step, rho) else {
            if self.is_cautious {
                self.phase = Phase::Correct;
            } else {
                self.take_care();
            }
            return;
        };
        self.phase = if step + 1 >= MAX_CG || left <= CG_DROP * start {
            Phase::Correct
        } else {
            Phase::Cg { step: step + 1, start, rho }
        };
    }

    /// One step of conjugate gradients in the directions that may move, the sum kept in `q`: gives r·z and
    /// the norm of the residual left; none, and no step, where the model is not positive along `p`.
    pub(super) fn cg_step(&mut self, step: u32, rho_before: f64) -> Option<(f64, f64)> {
        self.work_units += CYCLE_UNITS + SWEEP_UNITS;
        self.precondition();
        let rho = dot(&self.free, &self.r, &self.z);
        let beta = if step == 0 { 0.0 } else { rho / rho_before };
        for &k in &self.free {
            let k = k as usize;
            self.p[k] = self.z[k] + self.p[k] * beta;
        }
        // z is free again: it takes H p.
        apply(&self.hessian, &self.projector, &self.free, &self.p, &mut self.z);
        let bend = dot(&self.free, &self.p, &self.z);
        if !(bend > 0.0 && rho > 0.0) {
            return None;
        }
        let alpha = rho / bend;
        let mut left = 0.0;
        for &k in &self.free {
            let k = k as usize;
            self.q[k] += self.p[k] * alpha;
            self.r[k] -= self.z[k] * alpha;
            left += self.r[k].length_squared();
        }
        Some((rho, left.sqrt()))
    }

    /// Sets `z` to a V-cycle's answer to `r`.
    pub(super) fn precondition(&mut self) {
        let finest = Finest {
            blocks: &self.hessian,
            inverse: &self.tangent_inverse,
            projector: &self.projector,
            free: &self.free,
        };
        self.hierarchy.cycle(&finest, &self.r, &mut self.z, &mut self.scratch);
    }
}

/// out = Π H v.
pub(super) fn apply(
    blocks: &Blocks,
    projector: &[DMat3],
    free: &[u32],
    v: &[DVec3],
    out: &mut [DVec3],
) {
    for &k in free {
        let k = k as usize;
        out[k] = projector[k] * blocks.row(k, v);
    }
}

pub(super) fn dot(free: &[u32], a: &[DVec3], b: &[DVec3]) -> f64 {
    free.iter().map(|&k| a[k as usize].dot(b[k as usize])).sum()
}

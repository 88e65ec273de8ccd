//! Conjugate gradients on the model in the unconstrained directions, with a V-cycle as preconditioner.

use super::{CgState, Model, Newton, PARAMETERS, Phase, cost};
use crate::mesh::stencil::BlockStencil9;
use crate::solve::linear::galerkin::Finest;
use glam::{DMat3, DVec3};

impl Newton {
    /// One step; after the last step the next phase is the correction.
    pub(super) fn conjugate_gradients(&mut self, CgState { step, start, rho }: CgState) {
        let Some((rho, left)) = self.cg_step(step, rho) else {
            return self.turn_to_definite_model();
        };
        self.phase = if step + 1 >= PARAMETERS.max_cg_steps || left <= PARAMETERS.cg_drop * start {
            Phase::Correct
        } else {
            Phase::ConjugateGradients(CgState { step: step + 1, start, rho })
        };
    }

    /// Sets `r` to the residual of the model at the current step, `q` to zero; returns the residual's norm.
    pub(super) fn set_residual(&mut self) -> f64 {
        self.work_units += cost::SWEEP;
        let mut squares = 0.0;
        let Model { hessian, projector, .. } = &self.model;
        for &k in &self.free {
            let k = k as usize;
            let r = projector[k] * (self.forces[k] - hessian.row(k, &self.d));
            squares += r.length_squared();
            self.vectors.r[k] = r;
            self.vectors.q[k] = DVec3::ZERO;
        }
        squares.sqrt()
    }

    /// One step, added to `q`; returns r·z and the norm of the remaining residual. `None`, without a step, if the model
    /// is not positive along `p`.
    pub(super) fn cg_step(&mut self, step: u32, rho_before: f64) -> Option<(f64, f64)> {
        self.work_units += cost::CYCLE + cost::SWEEP;
        self.precondition();
        let (model, v, free) = (&self.model, &mut self.vectors, &self.free);
        let rho = dot(free, &v.r, &v.z);
        let beta = if step == 0 { 0.0 } else { rho / rho_before };
        for &k in free {
            let k = k as usize;
            v.p[k] = v.z[k] + v.p[k] * beta;
        }
        // z contains H p from here on.
        apply(&model.hessian, &model.projector, free, &v.p, &mut v.z);
        let bend = dot(free, &v.p, &v.z);
        if !(bend > 0.0 && rho > 0.0) {
            return None;
        }
        let alpha = rho / bend;
        let mut left = 0.0;
        for &k in free {
            let k = k as usize;
            v.q[k] += v.p[k] * alpha;
            v.r[k] -= v.z[k] * alpha;
            left += v.r[k].length_squared();
        }
        Some((rho, left.sqrt()))
    }

    /// Sets `z` to one V-cycle on `r`.
    pub(super) fn precondition(&mut self) {
        let Model { hessian, hierarchy, tangent_inverse, projector, .. } = &mut self.model;
        let finest =
            Finest { blocks: hessian, inverse: tangent_inverse, projector, free: &self.free };
        let v = &mut self.vectors;
        hierarchy.cycle(&finest, &v.r, &mut v.z, &mut v.scratch);
    }
}

/// out = Π H v.
pub(super) fn apply(
    hessian: &BlockStencil9,
    projector: &[DMat3],
    free: &[u32],
    v: &[DVec3],
    out: &mut [DVec3],
) {
    for &k in free {
        let k = k as usize;
        out[k] = projector[k] * hessian.row(k, v);
    }
}

pub(super) fn dot(free: &[u32], a: &[DVec3], b: &[DVec3]) -> f64 {
    free.iter().map(|&k| a[k as usize].dot(b[k as usize])).sum()
}

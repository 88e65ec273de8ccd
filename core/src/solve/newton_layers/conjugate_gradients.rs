//! Conjugate gradients on the model in the unconstrained directions, preconditioned by column solves.

use super::{Layers, Newton, Phase, cost};
use glam::DVec3;

/// Steps of a round.
const MAX_STEPS: u32 = 600;
/// Drop of √(r·z) in a round \[-\], before and after the relative residual falls below [`NEAR`].
const DROP: [f64; 2] = [0.03, 1e-3];
/// Longest move of a node in one step \[spacings\].
const MAX_MOVE: f64 = 0.5;
/// Relative residual below which Newton's method converges quadratically \[-\].
const NEAR: f64 = 1e-3;

impl Newton {
    /// Moves constrained nodes of the step onto the constraints and starts a round of linear solution.
    pub(super) fn begin_gradients(&mut self) {
        for &k in &self.free {
            let k = k as usize;
            let active = self.active[k];
            self.d[0][k] = self.constraint[k].onto(active, self.d[0][k]);
        }
        self.phase = Phase::Gradients { step: 0, start: 0.0, rho: 0.0 };
    }

    /// Sets `r` to the residual of the model at the step, unprojected.
    pub(super) fn set_residual(&mut self) {
        let d = std::mem::take(&mut self.d);
        self.product_into_z(&d);
        self.d = d;
        for layer in 0..self.x.len() {
            for &k in &self.free {
                let k = k as usize;
                self.r[layer][k] = self.forces[layer][k] - self.z[layer][k];
            }
        }
    }

    /// Sets `z` to H v.
    fn product_into_z(&mut self, v: &Layers) {
        self.work_units += cost::PRODUCT;
        let top = v.len() - 1;
        for layer in &mut self.z {
            layer.fill(DVec3::ZERO);
        }
        self.tangent.add_product(v, &mut self.z);
        for &k in &self.free {
            let k = k as usize;
            self.z[top][k] += self.skin.row(k, &v[top]);
        }
        for (k, curvature) in &self.curvature {
            self.z[0][*k] -= *curvature * v[0][*k];
        }
    }

    /// One step; after the last step the next phase is the active set.
    pub(super) fn conjugate_gradients(&mut self, step: u32, start: f64, rho_before: f64) {
        if step == 0 {
            self.set_residual();
            self.project_inner_residual();
        }
        // z contains the preconditioned residual.
        for &k in &self.free {
            let k = k as usize;
            self.columns.solve(k, &self.constrained[k], &self.r, &mut self.z);
        }
        let rho = self.dot(&self.r, &self.z);
        let start = if step == 0 { rho.max(0.0).sqrt() } else { start };
        let near = usize::from(self.relative_residual < NEAR);
        let is_small = rho.max(0.0).sqrt() <= DROP[near] * start;
        if rho <= 0.0 || !rho.is_finite() || step > 0 && is_small || step >= MAX_STEPS {
            self.phase = Phase::ActiveSet;
            return;
        }
        let beta = if step == 0 { 0.0 } else { rho / rho_before };
        for (p, z) in self.p.iter_mut().zip(&self.z) {
            for &k in &self.free {
                let k = k as usize;
                p[k] = z[k] + p[k] * beta;
            }
        }
        let p = std::mem::take(&mut self.p);
        self.product_into_z(&p);
        self.p = p;
        let bend = self.dot(&self.p, &self.z);
        if bend <= 0.0 || !bend.is_finite() {
            // Without a step so far: along the preconditioned forces.
            if step == 0 {
                self.add_to_step(1.0);
            }
            return self.end_far_step();
        }
        let alpha = rho / bend;
        self.add_to_step(alpha);
        if self.longest_move() > self.far() {
            return self.end_far_step();
        }
        for (r, z) in self.r.iter_mut().zip(&self.z) {
            for &k in &self.free {
                let k = k as usize;
                r[k] -= z[k] * alpha;
            }
        }
        self.project_inner_residual();
        self.phase = Phase::Gradients { step: step + 1, start, rho };
    }

    /// Length of a step \[mm\] beyond which the quadratic model is not trusted.
    pub(super) fn far(&self) -> f64 {
        MAX_MOVE * self.sheet.spacing_mm()
    }

    /// The longest move of a node by the step \[mm\].
    pub(super) fn longest_move(&self) -> f64 {
        let longest = |d: &Vec<DVec3>| {
            let squares = self.free.iter().map(|&k| d[k as usize].length_squared());
            squares.fold(0.0, f64::max)
        };
        self.d.iter().map(longest).fold(0.0, f64::max).sqrt()
    }

    /// Ends conjugate gradients with the step so far, shortened to [`Self::far`].
    pub(super) fn end_far_step(&mut self) {
        let factor = (self.far() / self.longest_move()).min(1.0);
        for d in &mut self.d {
            for &k in &self.free {
                d[k as usize] *= factor;
            }
        }
        // A shortened step is no step of Newton's method.
        self.phase = Phase::LineSearch { length: 1.0, halvings: u32::from(factor < 1.0) };
    }

    pub(super) fn project_inner_residual(&mut self) {
        for &k in &self.free {
            let k = k as usize;
            self.r[0][k] = self.projector[k] * self.r[0][k];
        }
    }

    fn add_to_step(&mut self, alpha: f64) {
        for (d, p) in self.d.iter_mut().zip(&self.p) {
            for &k in &self.free {
                let k = k as usize;
                d[k] += p[k] * alpha;
            }
        }
    }

    fn dot(&self, a: &Layers, b: &Layers) -> f64 {
        let layer = |(a, b): (&Vec<DVec3>, &Vec<DVec3>)| {
            self.free.iter().map(|&k| a[k as usize].dot(b[k as usize])).sum::<f64>()
        };
        a.iter().zip(b).map(layer).sum()
    }
}

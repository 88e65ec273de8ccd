//! Conjugate gradients on the model in the unconstrained directions.

use super::{Contact, Grid, Layers, Newton, System};
use glam::DVec3;

/// Conjugate gradients between two steps.
#[derive(Clone, Copy)]
pub(in crate::solve) struct CgState {
    pub(super) step: u32,
    /// Norm of the residual at the start.
    pub(super) start: f64,
    /// r·z of the step before.
    pub(super) rho: f64,
}

/// Vectors of conjugate gradients.
pub(super) struct Vectors {
    /// The residual.
    pub(super) r: Layers,
    /// The preconditioned residual.
    pub(super) z: Layers,
    /// The direction.
    pub(super) p: Layers,
    /// The second derivative times a vector.
    pub(super) product: Layers,
}

impl<S: System> Newton<S> {
    /// Sets `r` to the residual of the model at the step `d`.
    pub(super) fn set_residual(&mut self) {
        self.work_units += S::PARAMETERS.cost.product;
        let Vectors { r, product, .. } = &mut self.vectors;
        self.system.product(&self.grid, &self.contact, &self.d, product);
        for ((r, product), forces) in r.iter_mut().zip(product).zip(&self.forces) {
            for k in self.grid.free() {
                r[k] = forces[k] - product[k];
            }
        }
    }

    /// Keeps the unconstrained directions of the residual; returns its norm.
    pub(super) fn project_residual(&mut self) -> f64 {
        project(&self.grid, &self.contact, &mut self.vectors.r[0]);
        self.dot(&self.vectors.r, &self.vectors.r).sqrt()
    }

    /// Sets `z` to the preconditioned residual; returns r·z.
    pub(super) fn precondition(&mut self) -> f64 {
        let Vectors { r, z, .. } = &mut self.vectors;
        self.system.precondition(&self.grid, &self.contact, r, z);
        self.dot(&self.vectors.r, &self.vectors.z)
    }

    /// Sets the direction p to z + β p, and the product to H p.
    pub(super) fn turn(&mut self, beta: f64) {
        let Vectors { z, p, .. } = &mut self.vectors;
        for (p, z) in p.iter_mut().zip(z) {
            for k in self.grid.free() {
                p[k] = z[k] + p[k] * beta;
            }
        }
        self.work_units += S::PARAMETERS.cost.product;
        let Vectors { p, product, .. } = &mut self.vectors;
        self.system.product(&self.grid, &self.contact, p, product);
    }

    /// p·H p.
    pub(super) fn bend(&self) -> f64 {
        self.dot(&self.vectors.p, &self.vectors.product)
    }

    /// Takes a multiple of H p from the residual; returns its norm.
    pub(super) fn reduce_residual(&mut self, alpha: f64) -> f64 {
        let Vectors { r, product, .. } = &mut self.vectors;
        add(&self.grid.free, r, product, -alpha);
        self.dot(&self.vectors.r, &self.vectors.r).sqrt()
    }

    pub(super) fn dot(&self, a: &Layers, b: &Layers) -> f64 {
        let layer = |(a, b): (&Vec<DVec3>, &Vec<DVec3>)| {
            self.grid.free().map(|k| a[k].dot(b[k])).sum::<f64>()
        };
        a.iter().zip(b).map(layer).sum()
    }
}

/// Keeps the unconstrained directions of a vector of the inner face.
pub(super) fn project(grid: &Grid, contact: &Contact, v: &mut [DVec3]) {
    for k in grid.free() {
        v[k] = contact.projector[k] * v[k];
    }
}

/// Adds a multiple of `b` to `a` at the free nodes.
pub(super) fn add(free: &[u32], a: &mut Layers, b: &Layers, factor: f64) {
    for (a, b) in a.iter_mut().zip(b) {
        for &k in free {
            a[k as usize] += b[k as usize] * factor;
        }
    }
}

/// The longest vector of a free node.
pub(super) fn longest(free: &[u32], v: &Layers) -> f64 {
    let squares =
        |v: &Vec<DVec3>| free.iter().map(|&k| v[k as usize].length_squared()).fold(0.0, f64::max);
    v.iter().map(squares).fold(0.0, f64::max).sqrt()
}

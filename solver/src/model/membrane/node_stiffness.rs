//! Second derivative of a triangle's energy by one of its nodes, from the closed form of the coupled law.

use crate::mesh::vec3::{Block, add, add_outer, scale};
use crate::number::Real;
use crate::springs::closed_form::Stiffness;

/// Adds c_vv vvᵀ + c_vτ (vτᵀ + τvᵀ) + c_ττ ττᵀ.
#[inline(always)]
pub(crate) fn add_stretch<R: Real>(block: &mut Block<R>, k: &Stiffness<R>, v: [R; 3], tau: [R; 3]) {
    // (c_vv v + c_vτ τ) vᵀ + (c_vτ v + c_ττ τ) τᵀ
    add_outer(block, add(scale(v, k.vv), scale(tau, k.v_tau)), v);
    add_outer(block, add(scale(v, k.v_tau), scale(tau, k.tau_tau)), tau);
}

/// The block of [`Stiffness`]: `rest` = mᵀG⁻¹m, `area` = (mᵀadj(g)m)/det G, `per_s` = 1/s, n the unit normal.
#[inline(always)]
pub(crate) fn node_stiffness<R: Real>(
    k: &Stiffness<R>,
    [rest, area, per_s]: [R; 3],
    [v, tau, normal]: [[R; 3]; 3],
) -> Block<R> {
    let isotropic = k.p * rest;
    let across = (k.beta_t * area * per_s).max(k.min_normal * rest - isotropic);
    let mut block = [R::default(); 6];
    add_outer(&mut block, scale(normal, across), normal);
    add_stretch(&mut block, k, v, tau);
    for diagonal in [0, 3, 5] {
        block[diagonal] += isotropic;
    }
    block
}

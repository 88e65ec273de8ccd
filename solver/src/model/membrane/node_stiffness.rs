//! Second derivative of a triangle's energy by one of its nodes, from the closed form of the coupled law.

use crate::mesh::vec3::{Block, add, add_outer, scale, sub};
use crate::number::Real;
use crate::springs::closed_form::{Fibre, Stiffness};

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
    [v, tau, normal, w]: [[R; 3]; 4],
) -> Block<R> {
    let isotropic = k.p * rest;
    let across = (k.beta_t * area * per_s).max(k.min_normal * rest - isotropic);
    let mut block = [R::default(); 6];
    add_outer(&mut block, scale(normal, across), normal);
    add_stretch(&mut block, k, v, tau);
    for diagonal in [0, 3, 5] {
        block[diagonal] += isotropic;
    }
    if let Some(fibre) = &k.fibre {
        add_fibre(&mut block, fibre, [rest, area], [v, w, normal]);
    }
    block
}

/// Adds the block of [`Fibre`]; v = F m and w = F adj(C) m have the parts λₖ pₖ and λₖ (λ₁λ₂/λₖ)² pₖ.
#[inline(always)]
pub(crate) fn add_fibre<R: Real>(
    block: &mut Block<R>,
    k: &Fibre<R>,
    [rest, area]: [R; 2],
    [v, w, normal]: [[R; 3]; 3],
) {
    let [one, two] = k.squares;
    let p1 = scale(sub(scale(v, one), w), k.per_spread / one.sqrt());
    let p2 = scale(sub(w, scale(v, two)), k.per_spread / two.sqrt());
    let along = (one * rest - area) * k.per_spread;
    let turn = k.turn * rest;
    add_outer(block, scale(p1, k.along - k.turn), p1);
    add_outer(block, scale(p2, -k.turn), p2);
    add_outer(block, scale(normal, k.normal * along - turn), normal);
    for diagonal in [0, 3, 5] {
        block[diagonal] += turn;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::CurveSpec;
    use crate::springs::Material;
    use crate::springs::closed_form::{self, Change, Stretch};
    use crate::springs::coupled::CoupledLaw;
    use glam::{DMat2, DVec2, DVec3};

    /// Along the principal directions and the normal the block of wrinkled skin is the second difference of its energy.
    #[test]
    fn the_block_of_wrinkled_skin_is_the_second_difference_of_its_energy() {
        let law = CoupledLaw::new(&[Material::of(&CurveSpec::Skin {}, 0.45, 1.0)]);
        let groups = law.closed_form::<f64>(1.0);
        for (stretches, turn) in [([1.3, 0.7], 0.4), ([1.05, 0.6], -0.9), ([1.2, 0.85], 0.1)] {
            let (v1, v2) = (DVec2::from_angle(turn), DVec2::from_angle(turn).perp());
            let f = |v: DVec2| {
                v.dot(v1) * stretches[0] * DVec3::X + v.dot(v2) * stretches[1] * DVec3::Y
            };
            let m = DVec2::new(0.8, -0.5);
            let energy = |d: DVec3| {
                let [a, b] = [DVec2::X, DVec2::Y].map(|axis| f(axis) + d * m.dot(axis));
                let metric = DMat2::from_cols(
                    DVec2::new(a.dot(a), a.dot(b)),
                    DVec2::new(a.dot(b), b.dot(b)),
                );
                let (half, det) = (0.5 * (a.dot(a) + b.dot(b)), metric.determinant());
                let root = (half * half - det).sqrt();
                law.energy([(half + root).sqrt() - 1.0, (half - root).sqrt() - 1.0])
            };
            let [one, two] = stretches;
            let (one_square, two_square) = (one * one, two * two);
            let change = [one_square - 1.0, two_square - 1.0, 0.0];
            let at = Stretch::of_square(change);
            let k = closed_form::stiffness(&groups, at, Change::of_square(change));
            let fibre = k.fibre.expect("wrinkled");
            let area = (two * m.dot(v1)).powi(2) + (one * m.dot(v2)).powi(2);
            let v = f(m);
            let stretched = f(v1) * one * one * m.dot(v1) + f(v2) * two * two * m.dot(v2);
            let w = v * (one * one + two * two) - stretched;
            let vectors = [v, w, DVec3::Z].map(|v| v.to_array());
            let mut block = [0.0; 6];
            add_fibre(&mut block, &fibre, [m.length_squared(), area], vectors);
            for (axis, diagonal) in
                [(DVec3::X, block[0]), (DVec3::Y, block[3]), (DVec3::Z, block[5])]
            {
                let h = 1e-4;
                let second =
                    (energy(axis * h) + energy(axis * -h) - 2.0 * energy(DVec3::ZERO)) / (h * h);
                assert!((diagonal - second).abs() < 1e-3 * block[0], "{axis}: {diagonal} {second}");
            }
        }
    }
}

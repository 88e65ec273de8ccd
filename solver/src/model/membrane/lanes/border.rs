//! Triangles with rest metrics of their own, at the border or on a surface that is not even, four at a time.
//!
//! Such triangles are few but scattered: their nodes are gathered first, one vector each, so that four triangles
//! read and write whole vectors.

use super::coupled::{CoupledLanes, Law};
use crate::mesh::lanes::{Field, OwnTriangle};
use crate::mesh::vec3::{Block, Vec3, add, cross, dot, scale, sub};
use crate::model::NodeBlocks;
use crate::model::membrane::node_stiffness::node_stiffness;
use crate::springs::closed_form::{area_stretch, trace_of_stretch};
use wide::f32x4;

/// All triangles at the border.
#[derive(Clone, Debug, Default)]
pub(super) struct Border {
    /// Their stored nodes.
    nodes: Vec<u32>,
    pub(super) fours: Vec<Four>,
}

/// Four triangles.
#[derive(Clone, Debug)]
pub(super) struct Four {
    /// Each triangle's three corners: places in [`Border::nodes`].
    pub(super) corners: [[u32; 4]; 3],
    /// The two edges from the first corner without displacement.
    pub(super) edges: [Vec3; 2],
    /// G⁻¹: 11, 12, 22.
    inverse_metric: [f32x4; 3],
    /// 1/det G.
    inverse_det: f32x4,
    /// Rest area times weight, in those of a regular triangle; zero in unused lanes.
    pub(super) weight: f32x4,
}

/// Fours that are evaluated together: single ones would wait for square roots.
const AT_ONCE: usize = 16;

/// Displacements and forces of the border's nodes, and the fours under evaluation.
#[derive(Clone, Debug)]
pub(super) struct BorderScratch {
    pub(super) u: Vec<f32x4>,
    pub(super) f: Vec<f32x4>,
    stretched: [Stretched; AT_ONCE],
}

impl BorderScratch {
    pub(super) fn new(border: &Border) -> Self {
        let zeros = vec![f32x4::ZERO; border.nodes.len()];
        Self { u: zeros.clone(), f: zeros, stretched: [Stretched::default(); AT_ONCE] }
    }
}

/// The edges of four triangles, their metric and invariants.
#[derive(Clone, Copy, Debug, Default)]
struct Stretched {
    e1: Vec3,
    e2: Vec3,
    g11: f32x4,
    g12: f32x4,
    g22: f32x4,
    i1: f32x4,
    s: f32x4,
    t: f32x4,
}

#[inline(always)]
pub(super) fn gathered(u: &[f32x4], places: &[u32; 4]) -> Vec3 {
    let [x, y, z, _] = f32x4::transpose(places.map(|k| u[k as usize]));
    [x, y, z]
}

impl Four {
    /// Of one to four triangles; `place` is the place of a stored node among the border's.
    fn new(triangles: &[OwnTriangle], place: impl Fn(u32) -> u32) -> Self {
        let mut corners = [[0_u32; 4]; 3];
        let mut numbers = [[0.0_f32; 4]; 11];
        for lane in 0..4 {
            // Unused lanes repeat the last triangle without weight.
            let OwnTriangle { nodes, places, rest, weight } =
                triangles[lane.min(triangles.len() - 1)];
            let weight = if lane < triangles.len() { weight } else { 0.0 };
            let [a, b, c] = places;
            let (e1, e2) = (b - a, c - a);
            let [a, b, c] = rest;
            let (r1, r2) = (b - a, c - a);
            let double_area = r1.perp_dot(r2);
            let det = double_area.powi(2);
            let (g11, g12, g22) = (r1.length_squared(), r1.dot(r2), r2.length_squared());
            let all = [
                e1.x,
                e1.y,
                e1.z,
                e2.x,
                e2.y,
                e2.z,
                g22 / det,
                -g12 / det,
                g11 / det,
                1.0 / det,
                // A regular triangle has half of half a cell.
                4.0 * weight * (0.5 * double_area),
            ];
            for (lanes, value) in numbers.iter_mut().zip(all) {
                lanes[lane] = value as f32;
            }
            for (lanes, k) in corners.iter_mut().zip(nodes) {
                lanes[lane] = place(k);
            }
        }
        let n = numbers.map(f32x4::new);
        Self {
            corners,
            edges: [[n[0], n[1], n[2]], [n[3], n[4], n[5]]],
            inverse_metric: [n[6], n[7], n[8]],
            inverse_det: n[9],
            weight: n[10],
        }
    }

    /// With the displacements of the border's nodes.
    #[inline(always)]
    fn stretched(&self, u: &[f32x4]) -> Stretched {
        let [a, b, c] = [0, 1, 2].map(|k| gathered(u, &self.corners[k]));
        let (e1, e2) = (add(sub(b, a), self.edges[0]), add(sub(c, a), self.edges[1]));
        let (g11, g12, g22) = (dot(e1, e1), dot(e1, e2), dot(e2, e2));
        let [i11, i12, i22] = self.inverse_metric;
        let det = (g11 * g22 - g12 * g12) * self.inverse_det;
        let i1 = i11 * g11 + i12 * g12 * 2.0 + i22 * g22;
        let s = area_stretch(det);
        Stretched { e1, e2, g11, g12, g22, i1, s, t: trace_of_stretch(i1, s) }
    }

    /// The tension along both edges of a metric: M e, M = P G⁻¹ + Q/det G · cof g, with `q` that of Q/det G.
    #[inline(always)]
    fn pulls(
        &self,
        [e1, e2]: [Vec3; 2],
        [g11, g12, g22]: [f32x4; 3],
        p: f32x4,
        q: f32x4,
    ) -> [Vec3; 2] {
        let [i11, i12, i22] = self.inverse_metric;
        let (m11, m12, m22) = (p * i11 + q * g22, p * i12 - q * g12, p * i22 + q * g11);
        [add(scale(e1, m11), scale(e2, m12)), add(scale(e1, m12), scale(e2, m22))]
    }

    /// (λ₁² − λ₂²)² of a metric: of M = G⁻¹g the square of M₁₁ − M₂₂ and 4 M₁₂M₂₁.
    #[inline(always)]
    fn spread(&self, [g11, g12, g22]: [f32x4; 3]) -> f32x4 {
        let [i11, i12, i22] = self.inverse_metric;
        let difference = i11 * g11 - i22 * g22;
        let product = (i11 * g12 + i12 * g22) * (i12 * g11 + i22 * g12);
        difference * difference + product * 4.0
    }
}

impl Border {
    pub(super) fn new(triangles: &[OwnTriangle]) -> Self {
        let mut nodes: Vec<u32> = triangles.iter().flat_map(|triangle| triangle.nodes).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes.shrink_to_fit();
        let place = |k: u32| nodes.partition_point(|&node| node < k) as u32;
        let fours = triangles.chunks(4).map(|four| Four::new(four, place)).collect();
        Self { nodes, fours }
    }

    pub(super) fn gather(&self, u: &Field, to: &mut [f32x4]) {
        for (place, &k) in to.iter_mut().zip(&self.nodes) {
            let [x, y, z] = u.at(k as usize);
            *place = f32x4::new([x, y, z, 0.0]);
        }
    }

    /// Adds the forces of the triangles.
    #[inline(always)]
    pub(super) fn add_forces<L: Law + ?Sized>(
        &self,
        law: &L,
        u: &Field,
        f: &mut Field,
        scratch: &mut BorderScratch,
    ) {
        let BorderScratch { u: at, f: pulls, stretched } = scratch;
        self.gather(u, at);
        pulls.fill(f32x4::ZERO);
        for fours in self.fours.chunks(AT_ONCE) {
            let stretched = &mut stretched[..fours.len()];
            for (four, out) in fours.iter().zip(&mut *stretched) {
                *out = four.stretched(at);
            }
            for (four, at) in fours.iter().zip(&mut *stretched) {
                let &mut Stretched { g11, g12, g22, i1, s, t, .. } = at;
                (at.i1, at.s) = law.tension(i1, s, t, || four.spread([g11, g12, g22]));
            }
            for (four, &Stretched { e1, e2, g11, g12, g22, i1: p, s: q, .. }) in
                fours.iter().zip(&*stretched)
            {
                let (p, q) = (p * four.weight, q * four.weight * four.inverse_det);
                let [p1, p2] = four.pulls([e1, e2], [g11, g12, g22], p, q);
                let on_corners = [add(p1, p2), p1.map(|p| -p), p2.map(|p| -p)];
                for (corner, [x, y, z]) in four.corners.iter().zip(on_corners) {
                    let lanes = f32x4::transpose([x, y, z, f32x4::ZERO]);
                    for (&k, pull) in corner.iter().zip(lanes) {
                        pulls[k as usize] += pull;
                    }
                }
            }
        }
        self.scatter(pulls, f);
    }

    /// Sum of the squares of what the sheet pulls at two edges of each triangle, in the measure of the regular cells.
    pub(super) fn squares<L: Law + ?Sized>(
        &self,
        law: &L,
        u: &Field,
        scratch: &mut BorderScratch,
    ) -> f64 {
        self.gather(u, &mut scratch.u);
        // A cell is four triangles of half weight.
        let share = 0.25;
        let squares = |four: &Four| {
            let Stretched { e1, e2, g11, g12, g22, i1, s, t } = four.stretched(&scratch.u);
            let (p, q) = law.tension(i1, s, t, || four.spread([g11, g12, g22]));
            let [p1, p2] = four.pulls([e1, e2], [g11, g12, g22], p, q * four.inverse_det);
            let pulls = dot(p1, p1) + dot(p2, p2);
            f64::from((four.weight.simd_gt(f32x4::ZERO) & pulls).reduce_add())
        };
        share * self.fours.iter().map(squares).sum::<f64>()
    }

    pub(super) fn scatter(&self, pulls: &[f32x4], f: &mut Field) {
        for (&k, pull) in self.nodes.iter().zip(pulls) {
            let [x, y, z, _] = pull.to_array();
            f.add(k as usize, [x, y, z]);
        }
    }

    pub(super) fn scatter_block(&self, places: &[u32; 4], block: Block, blocks: &mut NodeBlocks) {
        for (part, lanes) in blocks.parts.iter_mut().zip(block) {
            for (&place, value) in places.iter().zip(lanes.to_array()) {
                part[self.nodes[place as usize] as usize] += value;
            }
        }
    }

    /// Adds the blocks of the triangles.
    pub(super) fn add_blocks(
        &self,
        law: &CoupledLanes,
        u: &Field,
        blocks: &mut NodeBlocks,
        scratch: &mut BorderScratch,
    ) {
        self.gather(u, &mut scratch.u);
        let corners = [
            (f32x4::splat(-1.0), f32x4::splat(-1.0)),
            (f32x4::ONE, f32x4::ZERO),
            (f32x4::ZERO, f32x4::ONE),
        ];
        for four in &self.fours {
            let Stretched { e1, e2, g11, g12, g22, i1, s, .. } = four.stretched(&scratch.u);
            let [i11, i12, i22] = four.inverse_metric;
            let k = law.stiffness(i1, s);
            let per_s = f32x4::ONE / s;
            let per_t = f32x4::ONE / k.t;
            let n = scale(cross(e1, e2), per_s * four.inverse_det.sqrt());
            for (places, (m1, m2)) in four.corners.iter().zip(corners) {
                let rest = m1 * m1 * i11 + m1 * m2 * i12 * 2.0 + m2 * m2 * i22;
                let area = (g22 * m1 * m1 - g12 * m1 * m2 * 2.0 + g11 * m2 * m2) * four.inverse_det;
                let v = add(scale(e1, i11 * m1 + i12 * m2), scale(e2, i12 * m1 + i22 * m2));
                let w = scale(
                    add(scale(e1, g22 * m1 - g12 * m2), scale(e2, g11 * m2 - g12 * m1)),
                    four.inverse_det,
                );
                let tau = scale(add(v, scale(w, per_s)), per_t);
                let block = node_stiffness(&k, [rest, area, per_s], [v, tau, n, w]);
                self.scatter_block(places, block.map(|part| part * four.weight), blocks);
            }
        }
    }
}

//! Triangles with rest metrics of their own, at the border or on a surface that is not even, four at a time.
//!
//! Such triangles are few but scattered: their nodes are gathered first, one vector each, so that four triangles
//! read and write whole vectors.

use super::coupled::{CoupledLanes, Law};
use crate::mesh::lanes::{Field, OwnTriangle};
use crate::mesh::vec3::{Block, Vec3, add, cross, dot, scale, sub};
use crate::model::NodeBlocks;
use crate::model::membrane::node_stiffness::node_stiffness;
use crate::springs::closed_form::{Change, Stretch};
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
    /// Metric of these edges, less G: 11, 12, 22.
    added: [f32x4; 3],
    /// G⁻¹: 11, 12, 22.
    inverse_metric: [f32x4; 3],
    /// 1/det G.
    inverse_det: f32x4,
    /// Rest area times weight, in those of a regular triangle; zero in unused lanes.
    pub(super) weight: f32x4,
}

/// Fours that are evaluated together: single ones would wait for square roots.
const AT_ONCE: usize = 8;

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

/// Four triangles under evaluation.
#[derive(Clone, Copy, Debug, Default)]
struct Stretched {
    edges: [Vec3; 2],
    /// Metric of these edges, less G: 11, 12, 22.
    added: [f32x4; 3],
    change: Change<f32x4>,
    at: Stretch<f32x4>,
    /// A and Q.
    tension: [f32x4; 2],
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
        let mut numbers = [[0.0_f32; 4]; 14];
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
                e1.length_squared() - g11,
                e1.dot(e2) - g12,
                e2.length_squared() - g22,
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
            added: [n[6], n[7], n[8]],
            inverse_metric: [n[9], n[10], n[11]],
            inverse_det: n[12],
            weight: n[13],
        }
    }

    /// With the displacements of the border's nodes.
    #[inline(always)]
    fn stretched(&self, u: &[f32x4]) -> Stretched {
        let [a, b, c] = [0, 1, 2].map(|k| gathered(u, &self.corners[k]));
        let ([r1, r2], [d1, d2]) = (self.edges, [sub(b, a), sub(c, a)]);
        let edges @ [e1, e2] = [add(r1, d1), add(r2, d2)];
        let [c11, c12, c22] = self.added;
        let added @ [c11, c12, c22] = [
            c11 + dot(d1, add(r1, e1)),
            c12 + dot(r1, d2) + dot(d1, e2),
            c22 + dot(d2, add(r2, e2)),
        ];
        // M = G⁻¹γ: its trace, and the square of M₁₁ − M₂₂ and 4 M₁₂M₂₁.
        let [i11, i12, i22] = self.inverse_metric;
        let (one, two) = (i11 * c11, i22 * c22);
        let product = (i11 * c12 + i12 * c22) * (i12 * c11 + i22 * c12);
        let change = Change {
            trace: one + i12 * c12 * 2.0 + two,
            spread: (one - two) * (one - two) + product * 4.0,
        };
        let at = Stretch::new(change, (c11 * c22 - c12 * c12) * self.inverse_det);
        Stretched { edges, added, change, at, tension: Default::default() }
    }

    /// The tension along both edges: M e, M = A G⁻¹ + Q/det G · adj γ.
    #[inline(always)]
    fn pulls(
        &self,
        &Stretched { edges: [e1, e2], added: [c11, c12, c22], tension: [all, q], .. }: &Stretched,
    ) -> [Vec3; 2] {
        let q = q * self.inverse_det;
        let [i11, i12, i22] = self.inverse_metric;
        let (m11, m12, m22) = (all * i11 + q * c22, all * i12 - q * c12, all * i22 + q * c11);
        [add(scale(e1, m11), scale(e2, m12)), add(scale(e1, m12), scale(e2, m22))]
    }
}

impl Border {
    pub(super) fn new(triangles: &[OwnTriangle]) -> Self {
        let of_all = || triangles.iter().flat_map(|triangle| triangle.nodes);
        let mut places = vec![0_u32; of_all().max().map_or(0, |last| last as usize + 1)];
        of_all().for_each(|node| places[node as usize] = 1);
        let mut nodes = Vec::new();
        for (node, place) in places.iter_mut().enumerate().filter(|(_, place)| **place == 1) {
            *place = nodes.len() as u32;
            nodes.push(node as u32);
        }
        nodes.shrink_to_fit();
        let place = |node: u32| places[node as usize];
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
            for one in &mut *stretched {
                one.tension = law.tension(one.at, one.change);
            }
            for (four, one) in fours.iter().zip(&*stretched) {
                let [p1, p2] = four.pulls(one).map(|pull| scale(pull, four.weight));
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
            let mut one = four.stretched(&scratch.u);
            one.tension = law.tension(one.at, one.change);
            let [p1, p2] = four.pulls(&one);
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
            let Stretched { edges: [e1, e2], change, at, .. } = four.stretched(&scratch.u);
            let (g11, g12, g22) = (dot(e1, e1), dot(e1, e2), dot(e2, e2));
            let [i11, i12, i22] = four.inverse_metric;
            let k = law.stiffness(at, change);
            let per_s = f32x4::ONE / at.area_stretch();
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

//! Triangles at the border, whose rest shapes are not those of the grid, four at a time.
//!
//! They are few but scattered: their nodes are first brought together, one vector each, so that four
//! triangles read and write whole vectors.

use super::force::{Block, LEAST_AREA, Vec3, add, add_outer, add_stretch, cross, dot, scale, sub};
use super::grid::Field;
use super::law::{CoupledLanes, Law};
use super::springs::{LaneSprings, Rest};
use crate::sheet::Sheet;
use crate::springs::paper::Spring;
use wide::f32x4;

/// All triangles at the border.
#[derive(Clone, Debug, Default)]
pub(super) struct Border {
    /// The stored nodes that they have.
    nodes: Vec<u32>,
    fours: Vec<Four>,
}

/// Four triangles.
#[derive(Clone, Debug)]
struct Four {
    /// Each triangle's three corners: places in [`Border::nodes`].
    corners: [[u32; 4]; 3],
    /// The two edges from the first corner at rest: x and y of one, x and y of the other.
    edges: [f32x4; 4],
    /// G⁻¹: 11, 12, 22.
    inverse_metric: [f32x4; 3],
    /// 1/det G.
    inverse_det: f32x4,
    /// Rest area times weight, in those of a regular triangle; zero in unused lanes.
    weight: f32x4,
}

/// Fours on their way through the law together: one after the other would wait for square roots.
const AT_ONCE: usize = 32;

/// Displacements and forces of the border's nodes, and fours on their way.
#[derive(Clone, Debug)]
pub(super) struct BorderScratch {
    u: Vec<f32x4>,
    f: Vec<f32x4>,
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
fn gathered(u: &[f32x4], places: &[u32; 4]) -> Vec3 {
    let [x, y, z, _] = f32x4::transpose(places.map(|k| u[k as usize]));
    [x, y, z]
}

/// The paper's springs of a triangle, the right angle at its first corner.
const TRIANGLE_SPRINGS: [(usize, usize, Spring); 3] =
    [(0, 1, Spring::Edge), (0, 2, Spring::Edge), (1, 2, Spring::Diagonal)];

impl Four {
    /// `triangles` has one to four; `place` gives the place of a node of the sheet.
    fn new(
        sheet: &Sheet,
        triangles: &[([usize; 3], f64)],
        mut place: impl FnMut(usize) -> u32,
    ) -> Self {
        let mut corners = [[0_u32; 4]; 3];
        let mut numbers = [[0.0_f32; 4]; 9];
        for lane in 0..4 {
            // Unused lanes repeat the last triangle without weight.
            let (nodes, weight) = triangles[lane.min(triangles.len() - 1)];
            let weight = if lane < triangles.len() { weight } else { 0.0 };
            let [a, b, c] = nodes.map(|k| sheet.rest()[k]);
            let (e1, e2) = (b - a, c - a);
            let det = e1.perp_dot(e2).powi(2);
            let (g11, g12, g22) = (e1.length_squared(), e1.dot(e2), e2.length_squared());
            let all = [
                e1.x,
                e1.y,
                e2.x,
                e2.y,
                g22 / det,
                -g12 / det,
                g11 / det,
                1.0 / det,
                // A regular triangle has half of half a cell.
                4.0 * weight * sheet.rest_area(nodes),
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
            edges: [n[0], n[1], n[2], n[3]],
            inverse_metric: [n[4], n[5], n[6]],
            inverse_det: n[7],
            weight: n[8],
        }
    }

    /// With the displacements of the border's nodes.
    #[inline(always)]
    fn stretched(&self, u: &[f32x4]) -> Stretched {
        let [a, b, c] = [0, 1, 2].map(|k| gathered(u, &self.corners[k]));
        let (mut e1, mut e2) = (sub(b, a), sub(c, a));
        e1[0] += self.edges[0];
        e1[1] += self.edges[1];
        e2[0] += self.edges[2];
        e2[1] += self.edges[3];
        let (g11, g12, g22) = (dot(e1, e1), dot(e1, e2), dot(e2, e2));
        let [i11, i12, i22] = self.inverse_metric;
        let det = (g11 * g22 - g12 * g12) * self.inverse_det;
        let i1 = i11 * g11 + i12 * g12 * 2.0 + i22 * g22;
        let s = det.fast_max(f32x4::splat(LEAST_AREA)).sqrt();
        Stretched { e1, e2, g11, g12, g22, i1, s, t: (i1 + s + s).sqrt() }
    }
}

impl Border {
    /// Of triangles with their weights; `stored` gives where a node of the sheet is stored.
    pub(super) fn new(
        sheet: &Sheet,
        triangles: &[([usize; 3], f64)],
        stored: impl Fn(usize) -> usize,
    ) -> Self {
        let mut nodes: Vec<u32> =
            triangles.iter().flat_map(|(corners, _)| corners).map(|&k| stored(k) as u32).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let place = |k: usize| nodes.partition_point(|&node| (node as usize) < stored(k)) as u32;
        let fours = triangles.chunks(4).map(|four| Four::new(sheet, four, place)).collect();
        Self { nodes, fours }
    }

    fn gather(&self, u: &Field, to: &mut [f32x4]) {
        for (place, &k) in to.iter_mut().zip(&self.nodes) {
            let [x, y, z] = u.at(k as usize);
            *place = f32x4::new([x, y, z, 0.0]);
        }
    }

    /// Adds what the triangles pull at their nodes.
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
            for four in &mut *stretched {
                (four.i1, four.s) = law.tension(four.i1, four.s, four.t);
            }
            for (four, &Stretched { e1, e2, g11, g12, g22, i1: p, s: q, .. }) in
                fours.iter().zip(&*stretched)
            {
                let [i11, i12, i22] = four.inverse_metric;
                let (p, q) = (p * four.weight, q * four.weight * four.inverse_det);
                let (m11, m12, m22) = (p * i11 + q * g22, p * i12 - q * g12, p * i22 + q * g11);
                let p1 = add(scale(e1, m11), scale(e2, m12));
                let p2 = add(scale(e1, m12), scale(e2, m22));
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

    fn scatter(&self, pulls: &[f32x4], f: &mut Field) {
        for (&k, pull) in self.nodes.iter().zip(pulls) {
            let [x, y, z, _] = pull.to_array();
            f.add(k as usize, [x, y, z]);
        }
    }

    fn scatter_block(&self, places: &[u32; 4], block: Block, blocks: &mut [Vec<f32>; 6]) {
        for (part, lanes) in blocks.iter_mut().zip(block) {
            for (&place, value) in places.iter().zip(lanes.to_array()) {
                part[self.nodes[place as usize] as usize] += value;
            }
        }
    }

    /// Calls `visit` with the three springs of each four triangles: their ends, as places of the border's
    /// nodes, which of the paper's springs they are, their vectors at rest and now, their widths.
    #[inline(always)]
    fn springs(
        &self,
        u: &[f32x4],
        mut visit: impl FnMut([&[u32; 4]; 2], Spring, [f32x4; 2], Vec3, f32x4),
    ) {
        for four in &self.fours {
            let [x1, y1, x2, y2] = four.edges;
            let rests = [[x1, y1], [x2, y2], [x2 - x1, y2 - y1]];
            for ((a, b, spring), rest) in TRIANGLE_SPRINGS.into_iter().zip(rests) {
                let [from, to] = [&four.corners[a], &four.corners[b]];
                let mut now = sub(gathered(u, to), gathered(u, from));
                now[0] += rest[0];
                now[1] += rest[1];
                visit([from, to], spring, rest, now, four.weight);
            }
        }
    }

    /// Adds what the paper's springs of the triangles pull at their nodes.
    pub(super) fn add_spring_forces(
        &self,
        law: &LaneSprings,
        u: &Field,
        f: &mut Field,
        scratch: &mut BorderScratch,
    ) {
        let BorderScratch { u: at, f: pulls, .. } = scratch;
        self.gather(u, at);
        pulls.fill(f32x4::ZERO);
        self.springs(at, |[from, to], spring, rest, now, weight| {
            let [x, y, z] = law.pull(spring, Rest::of_triangle(spring, rest, weight), now);
            let lanes = f32x4::transpose([x, y, z, f32x4::ZERO]);
            for ((&a, &b), pull) in from.iter().zip(to).zip(lanes) {
                pulls[a as usize] += pull;
                pulls[b as usize] -= pull;
            }
        });
        self.scatter(pulls, f);
    }

    /// Adds the springs' shares of their nodes' blocks.
    pub(super) fn add_spring_blocks(
        &self,
        law: &LaneSprings,
        u: &Field,
        blocks: &mut [Vec<f32>; 6],
        scratch: &mut BorderScratch,
    ) {
        self.gather(u, &mut scratch.u);
        self.springs(&scratch.u, |ends, spring, rest, now, weight| {
            let block = law.block(spring, Rest::of_triangle(spring, rest, weight), now);
            for places in ends {
                self.scatter_block(places, block, blocks);
            }
        });
    }

    /// Adds the triangles' shares of their nodes' blocks.
    pub(super) fn add_blocks(
        &self,
        law: &CoupledLanes,
        u: &Field,
        blocks: &mut [Vec<f32>; 6],
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
                let isotropic = k.p * rest;
                let across = (k.beta_t * area * per_s).fast_max(k.least_normal * rest - isotropic);
                let mut block: Block = [f32x4::ZERO; 6];
                add_outer(&mut block, scale(n, across), n);
                add_stretch(&mut block, &k, v, tau);
                block[0] += isotropic;
                block[3] += isotropic;
                block[5] += isotropic;
                self.scatter_block(places, block.map(|part| part * four.weight), blocks);
            }
        }
    }
}

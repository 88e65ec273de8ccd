//! The sheet in flat f32 arrays, with forces of four cells at a time.
//!
//! Lengths in grid spacings, forces in spacings times the sheet's stiffness at small strain. The arrays
//! contain displacements from the square grid, which have smaller rounding errors than positions.

use super::law::Law;
use crate::mesh::{CellKind, NodeKind, Sheet};
use glam::{DVec2, DVec3};
use wide::f32x4;

/// Number of readable entries beyond the end of a row.
const PADDING: usize = 8;
/// Weight times rest area of a triangle of a whole cell \[spacing²\].
const REGULAR_AREA: f32 = 0.25;

pub(super) type Vec3 = [f32x4; 3];

/// A vector at every node, component by component; shape (rows × pitch, ).
#[derive(Clone, Debug)]
pub(super) struct Field {
    pub(super) parts: [Vec<f32>; 3],
}

impl Field {
    pub(super) fn new(length: usize) -> Self {
        Self { parts: [vec![0.0; length], vec![0.0; length], vec![0.0; length]] }
    }

    #[inline(always)]
    pub(super) fn load(&self, k: usize) -> Vec3 {
        let [x, y, z] = &self.parts;
        [load(x, k), load(y, k), load(z, k)]
    }

    #[inline(always)]
    pub(super) fn store(&mut self, k: usize, values: Vec3) {
        for (part, value) in self.parts.iter_mut().zip(values) {
            part[k..k + 4].copy_from_slice(&value.to_array());
        }
    }

    #[inline(always)]
    fn add(&mut self, k: usize, values: Vec3) {
        self.store(k, add(self.load(k), values));
    }
}

#[inline(always)]
pub(super) fn load(values: &[f32], k: usize) -> f32x4 {
    let lanes = &values[k..k + 4];
    f32x4::new([lanes[0], lanes[1], lanes[2], lanes[3]])
}

#[inline(always)]
pub(super) fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(super) fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn scale(a: Vec3, s: f32x4) -> Vec3 {
    [a[0] * s, a[1] * s, a[2] * s]
}

#[inline(always)]
pub(super) fn dot(a: Vec3, b: Vec3) -> f32x4 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Four triangles at the border, with rest shapes that differ from the grid.
#[derive(Clone, Debug)]
struct Border {
    /// Array indices of the three corners.
    nodes: [[usize; 4]; 3],
    /// Edges from the first corner on the square grid: x and y of the first, x and y of the second edge.
    edges: [f32x4; 4],
    /// Gradients of the hat functions of the second and third corner \[1/spacing\].
    gradients: [f32x4; 4],
    /// Rest area times weight \[spacing²\].
    area: f32x4,
}

/// Constant data of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    /// Indices of the nodes in the sheet.
    pub(super) nodes: [usize; 3],
    /// Rest area times weight \[spacing²\].
    pub(super) area: f64,
    /// Gradients of the hat functions \[1/spacing\].
    pub(super) gradients: [DVec2; 3],
}

impl Triangle {
    pub(super) fn new(sheet: &Sheet, nodes: [usize; 3], weight: f64) -> Self {
        let spacing = sheet.spacing_mm();
        let [p, q, r] = nodes.map(|k| sheet.rest()[k] / spacing);
        let (a, b) = (q - p, r - p);
        let inverse = 1.0 / a.perp_dot(b);
        let (g1, g2) = (DVec2::new(b.y, -b.x) * inverse, DVec2::new(-a.y, a.x) * inverse);
        Self { nodes, area: 0.5 * weight / inverse, gradients: [-(g1 + g2), g1, g2] }
    }
}

/// A sheet in lanes of four cells.
pub(super) struct LaneSheet {
    side: usize,
    pub(super) pitch: usize,
    /// Half-open ranges of the blocks of four columns with nodes of the sheet, row by row.
    pub(super) blocks: Vec<(usize, usize)>,
    /// 1/4 at the first node of a square cell, otherwise 0.
    weights: Vec<f32>,
    border: Vec<Border>,
}

impl LaneSheet {
    pub(super) fn new(sheet: &Sheet) -> Self {
        let side = sheet.nodes_per_side();
        let pitch = side.next_multiple_of(4) + PADDING;
        let mut weights = vec![0.0; side * pitch];
        let mut triangles = Vec::new();
        for (j, i) in (0..side - 1).flat_map(|j| (0..side - 1).map(move |i| (j, i))) {
            // A clamped corner lies on the circle: the cell is not square.
            let is_moved = sheet.corners(i, j).iter().any(|&k| sheet.kinds()[k] != NodeKind::Free);
            if sheet.cell(i, j) == CellKind::Whole && !is_moved {
                weights[j * pitch + i] = REGULAR_AREA;
            } else {
                triangles
                    .extend(sheet.cell_triangles(i, j).map(|(t, w)| Triangle::new(sheet, t, w)));
            }
        }
        let blocks =
            sheet.row_spans().iter().map(|&(from, to)| (from / 4, to.div_ceil(4))).collect();
        let border = triangles.chunks(4).map(|four| Border::new(four, side, pitch)).collect();
        Self { side, pitch, blocks, weights, border }
    }

    pub(super) fn len(&self) -> usize {
        self.side * self.pitch
    }

    /// Converts positions \[mm\] to displacements from the square grid \[spacings\].
    pub(super) fn read(&self, sheet: &Sheet, x: &[DVec3], u: &mut Field) {
        for (k, x) in x.iter().enumerate().filter(|(k, _)| sheet.kinds()[*k] != NodeKind::Outside) {
            let (i, j) = (k % self.side, k / self.side);
            let displacement = *x / sheet.spacing_mm() - self.grid_position(i, j).extend(0.0);
            for (part, value) in u.parts.iter_mut().zip(displacement.to_array()) {
                part[j * self.pitch + i] = value as f32;
            }
        }
    }

    /// Converts displacements of free nodes \[spacings\] to positions \[mm\].
    pub(super) fn write(&self, sheet: &Sheet, u: &Field, x: &mut [DVec3]) {
        for k in (0..x.len()).filter(|&k| sheet.kinds()[k] == NodeKind::Free) {
            let (i, j) = (k % self.side, k / self.side);
            let [a, b, c] = u.parts.each_ref().map(|part| f64::from(part[j * self.pitch + i]));
            x[k] =
                (self.grid_position(i, j).extend(0.0) + DVec3::new(a, b, c)) * sheet.spacing_mm();
        }
    }

    /// Position of a node on the square grid, relative to the centre \[spacings\].
    fn grid_position(&self, i: usize, j: usize) -> DVec2 {
        let half = (self.side / 2) as f64;
        DVec2::new(i as f64 - half, j as f64 - half)
    }

    /// Computes the forces of all nodes at the displacements `u`.
    pub(super) fn forces(&self, law: &Law, u: &Field, f: &mut Field) {
        f.parts.iter_mut().for_each(|part| part.fill(0.0));
        for j in 0..self.side - 1 {
            // A cell includes nodes of the next row: the union of both spans.
            let (here, above) = (self.blocks[j], self.blocks[j + 1]);
            for block in here.0.min(above.0)..here.1.max(above.1) {
                let k = j * self.pitch + 4 * block;
                let weight = load(&self.weights, k);
                if weight.simd_gt(f32x4::ZERO).any() {
                    self.add_cells(law, k, weight, u, f);
                }
            }
        }
        for four in &self.border {
            four.add_forces(law, u, f);
        }
    }

    /// Adds the forces of four whole cells: triangles at the four corners of each cell, with the edges
    /// bottom, top, left and right.
    #[inline(always)]
    fn add_cells(&self, law: &Law, k: usize, weight: f32x4, u: &Field, f: &mut Field) {
        let up = k + self.pitch;
        let (a, b, c, d) = (u.load(k), u.load(k + 1), u.load(up + 1), u.load(up));
        let along = |from: Vec3, to: Vec3, axis: usize| {
            let mut edge = sub(to, from);
            edge[axis] += f32x4::ONE;
            edge
        };
        let (bottom, top) = (along(a, b, 0), along(d, c, 0));
        let (left, right) = (along(a, d, 1), along(b, c, 1));
        let across = [dot(bottom, bottom), dot(top, top)];
        let upward = [dot(left, left), dot(right, right)];
        let bl = law.tension([across[0], upward[0], dot(bottom, left)]);
        let br = law.tension([across[0], upward[1], dot(bottom, right)]);
        let tl = law.tension([across[1], upward[0], dot(top, left)]);
        let tr = law.tension([across[1], upward[1], dot(top, right)]);
        // Force along each edge: the normal part and the shear parts of the adjacent triangles.
        let force =
            |edge: Vec3, normal: f32x4, (one, s): (Vec3, f32x4), (two, t): (Vec3, f32x4)| {
                scale(add(scale(edge, normal), add(scale(one, s), scale(two, t))), weight)
            };
        let on_bottom = force(bottom, bl[0] + br[0], (left, bl[2]), (right, br[2]));
        let on_top = force(top, tl[0] + tr[0], (left, tl[2]), (right, tr[2]));
        let on_left = force(left, bl[1] + tl[1], (bottom, bl[2]), (top, tl[2]));
        let on_right = force(right, br[1] + tr[1], (bottom, br[2]), (top, tr[2]));
        f.add(k, add(on_bottom, on_left));
        f.add(k + 1, sub(on_right, on_bottom));
        f.add(up, sub(on_top, on_left));
        f.add(up + 1, scale(add(on_top, on_right), -f32x4::ONE));
    }
}

impl Border {
    /// Creates a group of one to four triangles, padded with the first triangle at zero area.
    fn new(triangles: &[Triangle], side: usize, pitch: usize) -> Self {
        let triangle = |lane: usize| triangles.get(lane).unwrap_or(&triangles[0]);
        let lanes = |value: &dyn Fn(&Triangle) -> f64| {
            f32x4::new([0, 1, 2, 3].map(|lane| value(triangle(lane)) as f32))
        };
        let column = |t: &Triangle, c: usize| (t.nodes[c] % side) as f64;
        let row = |t: &Triangle, c: usize| (t.nodes[c] / side) as f64;
        let area = [0, 1, 2, 3]
            .map(|lane| triangles.get(lane).map_or(0.0, |triangle| triangle.area as f32));
        Self {
            nodes: [0, 1, 2].map(|c| {
                [0, 1, 2, 3].map(|lane| {
                    let k = triangle(lane).nodes[c];
                    k / side * pitch + k % side
                })
            }),
            edges: [
                lanes(&|t| column(t, 1) - column(t, 0)),
                lanes(&|t| row(t, 1) - row(t, 0)),
                lanes(&|t| column(t, 2) - column(t, 0)),
                lanes(&|t| row(t, 2) - row(t, 0)),
            ],
            gradients: [
                lanes(&|t| t.gradients[1].x),
                lanes(&|t| t.gradients[1].y),
                lanes(&|t| t.gradients[2].x),
                lanes(&|t| t.gradients[2].y),
            ],
            area: f32x4::new(area),
        }
    }

    fn add_forces(&self, law: &Law, u: &Field, f: &mut Field) {
        let corner = |c: usize| -> Vec3 {
            u.parts.each_ref().map(|part| f32x4::new(self.nodes[c].map(|k| part[k])))
        };
        let first = corner(0);
        let [x1, y1, x2, y2] = self.edges;
        let (mut e1, mut e2) = (sub(corner(1), first), sub(corner(2), first));
        (e1[0], e1[1], e2[0], e2[1]) = (e1[0] + x1, e1[1] + y1, e2[0] + x2, e2[1] + y2);
        let [a, b, c, d] = self.gradients;
        let f1 = add(scale(e1, a), scale(e2, c));
        let f2 = add(scale(e1, b), scale(e2, d));
        let [s11, s22, s12] = law.tension([dot(f1, f1), dot(f2, f2), dot(f1, f2)]);
        let p1 = scale(add(scale(f1, s11), scale(f2, s12)), self.area);
        let p2 = scale(add(scale(f1, s12), scale(f2, s22)), self.area);
        let second = add(scale(p1, a), scale(p2, b));
        let third = add(scale(p1, c), scale(p2, d));
        let forces = [add(second, third), scale(second, -f32x4::ONE), scale(third, -f32x4::ONE)];
        for (nodes, force) in self.nodes.iter().zip(forces) {
            for (part, lanes) in f.parts.iter_mut().zip(force) {
                for (k, value) in nodes.iter().zip(lanes.to_array()) {
                    part[*k] += value;
                }
            }
        }
    }
}

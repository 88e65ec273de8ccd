//! Cells at the border of the patch, whose nodes lie on its circle, four at a time.
//!
//! The gradient is that at the middle of the bilinear cell. A cell with a corner outside of the patch is half of a
//! parallelogram: the fourth corner is the linear continuation of the other three.

use super::cell;
use super::modes::{Corners, Modes, modes, on_faces};
use super::shape::{Even, InPlane, RestShape};
use super::sides::Oblique;
use super::stiffness::{CORNERS, CellStiffness};
use crate::mesh::lanes::{Field, Layout};
use crate::mesh::vec3::{Vec3, add, scale, sub};
use crate::mesh::{CellKind, Sheet};
use crate::model::columns::ColumnBlocks;
use crate::springs::solids::{SolidLaw, Volume};
use glam::{DMat2, DVec2, DVec3};
use wide::f32x4;

/// All cells at the border.
#[derive(Clone, Debug, Default)]
pub(super) struct Border {
    fours: Vec<Four>,
}

#[derive(Clone, Debug)]
pub(super) struct Four {
    /// Stored nodes at each corner; of a missing corner any node.
    corners: [[u32; 4]; 4],
    /// 1 where the corner is missing.
    missing: [f32x4; 4],
    /// The stored node of least x and y of each cell, inside or outside of the patch: the index of the cell.
    cells: [u32; 4],
    /// The slopes in the spacing's directions per slope along the cell's sides: ∂ξ/∂X, ∂η/∂X, ∂ξ/∂Y, ∂η/∂Y.
    sides: [f32x4; 4],
    /// Area over a flat wall, in those of a regular cell; zero in unused lanes.
    weight: f32x4,
}

/// A cell at the border.
#[derive(Clone, Copy, Debug)]
pub(super) struct BorderCell {
    /// Nodes of the sheet, counter-clockwise from the least x and y.
    pub(super) corners: [usize; 4],
    pub(super) missing: Option<usize>,
    /// Node of least x and y, on the patch or not.
    first: usize,
    /// The slopes along X and Y per slope along the sides, by columns.
    pub(super) sides: DMat2,
    /// Area \[rest units squared\].
    pub(super) area: f64,
}

impl BorderCell {
    /// The part of the parallelogram that belongs to the sheet.
    pub(super) fn share(&self) -> f64 {
        if self.missing.is_some() { 0.5 } else { 1.0 }
    }

    /// ∂ξ/∂X, ∂η/∂X, ∂ξ/∂Y, ∂η/∂Y.
    pub(super) fn sides(&self) -> [f64; 4] {
        let [x, y] = [self.sides.x_axis, self.sides.y_axis];
        [x.x, x.y, y.x, y.y]
    }

    /// The sums over the corners of a face of the vectors `at` the nodes; a missing corner continues the others.
    pub(super) fn gather(&self, at: impl Fn(usize) -> DVec3) -> Corners<f64> {
        let mut at = self.corners.map(|k| at(k).to_array());
        if let Some(k) = self.missing {
            let [next, opposite, last] = [1, 2, 3].map(|step| at[(k + step) % 4]);
            at[k] = [0, 1, 2].map(|a| next[a] + last[a] - opposite[a]);
        }
        Corners::new(at)
    }

    /// Calls `add` with the nodes and what the face pulls at each: the transpose of [`Self::gather`].
    pub(super) fn spread(&self, face: &Corners<f64>, mut add: impl FnMut(usize, DVec3)) {
        let mut pull = face.spread().map(DVec3::from);
        if let Some(k) = self.missing {
            let handed = std::mem::take(&mut pull[k]);
            pull[(k + 1) % 4] += handed;
            pull[(k + 2) % 4] -= handed;
            pull[(k + 3) % 4] += handed;
        }
        for (&k, pull) in self.corners.iter().zip(pull) {
            add(k, pull);
        }
    }

    /// Of cell (i, j) of a sheet; `None` outside of it.
    pub(super) fn new(sheet: &Sheet, i: usize, j: usize) -> Option<Self> {
        let mut corners = sheet.corners(i, j);
        let first = corners[0];
        let missing = match sheet.cell(i, j) {
            CellKind::Outside => return None,
            CellKind::Whole => None,
            CellKind::WithoutCorner(k) => Some(usize::from(k)),
        };
        let mut rest = corners.map(|k| sheet.rest()[k]);
        if let Some(k) = missing {
            let [next, opposite, last] = [1, 2, 3].map(|step| rest[(k + step) % 4]);
            rest[k] = next + last - opposite;
            corners[k] = corners[(k + 1) % 4];
        }
        let [a, b, c, d] = rest;
        let along_x: DVec2 = 0.5 * ((b - a) + (c - d));
        let along_y: DVec2 = 0.5 * ((d - a) + (c - b));
        let jacobian = DMat2::from_cols(along_x, along_y);
        let mut cell = Self { corners, missing, first, sides: jacobian.inverse(), area: 0.0 };
        cell.area = jacobian.determinant() * cell.share();
        Some(cell)
    }
}

impl Border {
    /// The cells of a layout that are not regular; four after four are a group.
    pub(super) fn cells(layout: &Layout) -> Vec<BorderCell> {
        let n = layout.nodes_per_side;
        let sheet = Sheet::new(n, (n / 2) as f64);
        let first = layout.first();
        let mut cells = Vec::new();
        for j in 0..layout.rows - 1 {
            let (from, to) = layout.regular[j];
            for i in (0..from as usize).chain(to as usize..layout.columns - 1) {
                cells.extend(BorderCell::new(&sheet, i + first[0], j + first[1]));
            }
        }
        cells
    }

    pub(super) fn new(layout: &Layout) -> Self {
        let stored = |k: usize| layout.stored(k) as u32;
        let cells = Self::cells(layout);
        let four = |cells: &[BorderCell]| {
            let cell = |lane: usize| cells[lane.min(cells.len() - 1)];
            let lanes = |value: &dyn Fn(BorderCell) -> f64| {
                f32x4::new([0, 1, 2, 3].map(|lane| value(cell(lane)) as f32))
            };
            let areas = [0, 1, 2, 3]
                .map(|lane| if lane < cells.len() { cells[lane].area as f32 } else { 0.0 });
            Four {
                corners: [0, 1, 2, 3]
                    .map(|corner| [0, 1, 2, 3].map(|lane| stored(cell(lane).corners[corner]))),
                missing: [0, 1, 2, 3].map(|corner| {
                    lanes(&|cell| if cell.missing == Some(corner) { 1.0 } else { 0.0 })
                }),
                cells: [0, 1, 2, 3].map(|lane| stored(cell(lane).first)),
                sides: [0, 1, 2, 3].map(|side| lanes(&|cell| cell.sides()[side])),
                weight: f32x4::new(areas),
            }
        };
        Self { fours: cells.chunks(4).map(four).collect() }
    }

    /// Number of groups of four cells in a layer.
    pub(super) fn len(&self) -> usize {
        self.fours.len()
    }

    /// Renews the augmented pressures of a layer of cells between the nodes of two layers.
    pub(super) fn renew<S: RestShape>(
        &self,
        law: &impl SolidLaw<f32x4>,
        shape: impl Fn(usize, &Four) -> S,
        layers: [usize; 2],
        u: &Field,
        pressure: &mut [f32x4],
    ) {
        for (k, (four, pressure)) in self.fours.iter().zip(pressure).enumerate() {
            let volume = cell::volume(&four.modes(u, layers), shape(k, four).sides());
            *pressure = law.renewed(Volume::new(volume), *pressure);
        }
    }

    /// Writes the cells' values of a layer to the indices of the cells.
    pub(super) fn leave(&self, values: &[f32x4], to: &mut [f32]) {
        for (four, values) in self.fours.iter().zip(values) {
            for (&cell, value) in four.cells.iter().zip(values.to_array()) {
                to[cell as usize] = value;
            }
        }
    }

    /// Reads the cells' values of a layer from the indices of the cells.
    pub(super) fn take(&self, from: &[f32], values: &mut [f32x4]) {
        for (four, values) in self.fours.iter().zip(values) {
            *values = f32x4::new(four.cells.map(|cell| from[cell as usize]));
        }
    }

    /// Adds the forces of a layer of cells between the nodes of two layers; `pressure` is empty without augmented
    /// pressures.
    pub(super) fn add_forces<S: RestShape>(
        &self,
        law: &impl SolidLaw<f32x4>,
        shape: impl Fn(usize, &Four) -> S,
        layers: [usize; 2],
        pressure: &[f32x4],
        u: &Field,
        f: &mut Field,
    ) {
        for (k, four) in self.fours.iter().enumerate() {
            let shape = shape(k, four);
            let augmented = pressure.get(k).copied().unwrap_or_default();
            let force = cell::center(law, &four.modes(u, layers), &shape, augmented);
            let force = force.weighted(four.weight);
            for (face, layer) in on_faces(&force).iter().zip(layers) {
                four.pull(face, layer, f);
            }
        }
    }

    /// Adds the blocks of a layer of cells.
    pub(super) fn add_blocks<S: RestShape>(
        &self,
        law: &impl SolidLaw<f32x4>,
        shape: impl Fn(usize) -> S,
        layers: [usize; 2],
        pressure: &[f32x4],
        u: &Field,
        blocks: &mut ColumnBlocks,
    ) {
        for (k, four) in self.fours.iter().enumerate() {
            let augmented = pressure.get(k).copied().unwrap_or_default();
            let shape = shape(k);
            let modes = shape.removed(&four.modes(u, layers));
            let stiffness = CellStiffness::new(law, &modes, &shape, augmented);
            for (corner, parts) in four.parts().into_iter().enumerate() {
                let weight = four.weight * shape.weight() * (f32x4::ONE - four.missing[corner]);
                let (diagonal, above) = stiffness.blocks_along(parts, weight);
                for (lane, &node) in four.corners[corner].iter().enumerate() {
                    let at = node as usize + layers[0];
                    for (layer, block) in layers.into_iter().zip(diagonal) {
                        let at = node as usize + layer;
                        for (part, value) in blocks.diagonal.parts.iter_mut().zip(block) {
                            part[at] += value.to_array()[lane];
                        }
                    }
                    for (part, value) in blocks.above.iter_mut().zip(above) {
                        part[at] += value.to_array()[lane];
                    }
                }
            }
        }
    }
}

impl Four {
    /// The modes of the cells between two layers of nodes.
    fn modes(&self, u: &Field, layers: [usize; 2]) -> Modes<f32x4> {
        let [inner, outer] = layers.map(|layer| self.gather(u, layer));
        modes(&inner, &outer)
    }

    /// The part of a face that each corner has at the middle, and its slopes along the sides; a missing corner's part belongs to the
    /// corners that it continues.
    fn parts(&self) -> [Vec3; 4] {
        let own = CORNERS.map(|[i, j]| {
            let sign = |bit: usize| f32x4::splat(if bit == 1 { 0.5 } else { -0.5 });
            [f32x4::splat(0.25), sign(i), sign(j)]
        });
        let mut parts = own;
        for (k, own) in own.into_iter().enumerate() {
            let handed = scale(own, self.missing[k]);
            for (step, sign) in [(1, 1.0), (2, -1.0), (3, 1.0)] {
                let to = &mut parts[(k + step) % 4];
                *to = add(*to, scale(handed, f32x4::splat(sign)));
            }
        }
        parts
    }

    /// The rest shape of the cells in a layer over a flat wall.
    pub(super) fn upright(&self, Even { sides, variation }: &Even) -> InPlane {
        InPlane { sides: Oblique::in_plane(self.sides, sides.slope), variation: *variation }
    }

    /// The sums over the corners of a face.
    fn gather(&self, u: &Field, layer: usize) -> Corners<f32x4> {
        let mut at = [[f32x4::ZERO; 3]; 4];
        for (nodes, at) in self.corners.iter().zip(&mut at) {
            *at = u.gather(*nodes, layer);
        }
        for k in 0..4 {
            let [next, opposite, last] = [1, 2, 3].map(|step| at[(k + step) % 4]);
            let continued = sub(add(next, last), opposite);
            at[k] = add(at[k], scale(sub(continued, at[k]), self.missing[k]));
        }
        Corners::new(at)
    }

    /// Subtracts what the cells pull at their corners.
    fn pull(&self, face: &Corners<f32x4>, layer: usize, f: &mut Field) {
        let mut pull = face.spread();
        for k in 0..4 {
            // The continuation hands its force on.
            let handed = scale(pull[k], self.missing[k]);
            pull[k] = sub(pull[k], handed);
            for (step, sign) in [(1, 1.0), (2, -1.0), (3, 1.0)] {
                let to = (k + step) % 4;
                pull[to] = add(pull[to], scale(handed, f32x4::splat(sign)));
            }
        }
        for (nodes, pull) in self.corners.iter().zip(pull) {
            let [x, y, z] = pull.map(f32x4::to_array);
            for (lane, &k) in nodes.iter().enumerate() {
                f.add(k as usize + layer, [-x[lane], -y[lane], -z[lane]]);
            }
        }
    }
}

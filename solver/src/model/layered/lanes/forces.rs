//! Forces of the regular cells and of the attachment.

use super::shapes::Layers;
use super::{CellLayer, Layered, Scratch};
use crate::mesh::lanes::{Field, Layout, load, shifted_right};
use crate::mesh::rest::MAX_LAYERS;
use crate::mesh::vec3::{Vec3, add, scale, sub};
use crate::model::layered::attachment::PAIRS;
use crate::model::layered::cell;
use crate::model::layered::deformed::Matrix;
use crate::model::layered::modes::{Corners, Modes, modes, on_faces};
use crate::model::layered::shape::RestShape;
use crate::model::layered::stiffness::CORNERS;
use crate::springs::solids::{SolidLaw, of_law};
use wide::f32x4;

/// The corners of four cells of a face.
#[inline(always)]
pub(super) fn at_corners(u: &Field, k: usize, pitch: usize) -> [Vec3; 4] {
    [u.load(k), u.load(k + 1), u.load(k + pitch + 1), u.load(k + pitch)]
}

/// What the last four cells pull at the next four nodes, of a face.
#[derive(Clone, Copy, Default)]
struct Carry {
    lower: Vec3,
    upper: Vec3,
}

impl Carry {
    /// Subtracts what four cells pull at their corners from the forces at k.
    #[inline(always)]
    fn pull(&mut self, f: &mut Field, k: usize, pitch: usize, [a, b, c, d]: [Vec3; 4]) {
        let shift = |before: Vec3, now: Vec3| [0, 1, 2].map(|p| shifted_right(before[p], now[p]));
        let lower = add(a, shift(self.lower, b));
        let upper = add(d, shift(self.upper, c));
        f.store(k, sub(f.load(k), lower));
        f.store(k + pitch, sub(f.load(k + pitch), upper));
        (self.lower, self.upper) = (b, c);
    }

    /// Subtracts what is left at the end of a row.
    #[inline(always)]
    fn finish(&mut self, f: &mut Field, k: usize, pitch: usize) {
        self.pull(f, k, pitch, [[f32x4::ZERO; 3]; 4]);
        *self = Self::default();
    }
}

impl Layered {
    /// Adds the forces of the regular cells.
    pub(super) fn add_cells(
        &self,
        layout: &Layout,
        shapes: &impl Layers,
        u: &Field,
        f: &mut Field,
        scratch: &Scratch,
    ) {
        let (length, pitch) = (layout.len(), layout.pitch);
        for row in layout.cell_rows() {
            let parity = first_parity(layout, row.start);
            let mut carries = [Carry::default(); MAX_LAYERS];
            for group in 0..row.groups {
                let k = row.start + 4 * group;
                let counts = row.counts(group);
                let points = load(&scratch.in_ring, k).simd_gt(f32x4::ZERO);
                let is_edge = group == 0 || group + 1 == row.groups;
                let mut inner = Corners::new(at_corners(u, k, pitch));
                let mut pull = Corners::<f32x4>::default();
                for (layer, cells) in self.cells.iter().enumerate() {
                    let at = k + layer * length;
                    let outer = Corners::new(at_corners(u, at + length, pitch));
                    let sign = if layer % 2 == 0 { parity } else { -parity };
                    let points = points & scratch.points[layer];
                    let augmented = cells.augmented(scratch, at);
                    let shape = shapes.regular(layer, k);
                    let modes = modes(&inner, &outer);
                    let points = [points, sign];
                    let forces =
                        of_law!(&cells.law, law => forces(law, &modes, &shape, points, augmented));
                    let [on_inner, on_outer] = on_faces(&forces);
                    pull.add(&on_inner);
                    carries[layer].pull(f, at, pitch, counted(pull.spread(), counts, is_edge));
                    (inner, pull) = (outer, on_outer);
                }
                let last = self.cells.len();
                let at = k + last * length;
                carries[last].pull(f, at, pitch, counted(pull.spread(), counts, is_edge));
            }
            let end = row.start + 4 * row.groups;
            for (layer, carry) in carries[..=self.cells.len()].iter_mut().enumerate() {
                carry.finish(f, end + layer * length, pitch);
            }
        }
    }

    /// Adds the forces of the attachment.
    pub(super) fn add_attachment(layout: &Layout, u: &Field, f: &mut Field, scratch: &Scratch) {
        attached_groups(layout, &scratch.attachment[0], |k| {
            let at = at_corners(u, k, layout.pitch);
            let mut pull = [[f32x4::ZERO; 3]; 4];
            for (values, [a, b]) in scratch.attachment.iter().zip(PAIRS) {
                let weight = load(values, k);
                pull[a] = add(pull[a], scale(at[b], weight));
                if a != b {
                    pull[b] = add(pull[b], scale(at[a], weight));
                }
            }
            for (corner, pull) in CORNERS.into_iter().zip(pull) {
                let to = k + corner[0] + corner[1] * layout.pitch;
                f.store(to, sub(f.load(to), pull));
            }
        });
    }
}

/// The parities of four cells from a stored cell on; alternating like a chessboard about the grid's centre.
pub(super) fn first_parity(layout: &Layout, start: usize) -> f32x4 {
    let [x, y] = layout.center();
    let (i, j) = (start % layout.pitch + x, start / layout.pitch + y);
    let sign = if (i + j).is_multiple_of(2) { 1.0 } else { -1.0 };
    f32x4::new([sign, -sign, sign, -sign])
}

#[inline(always)]
fn counted(corners: [Vec3; 4], counts: f32x4, is_edge: bool) -> [Vec3; 4] {
    if is_edge { corners.map(|corner| corner.map(|part| part & counts)) } else { corners }
}

/// Calls `visit` with the groups of four cells of which one is attached.
pub(super) fn attached_groups(layout: &Layout, stiffness: &[f32], mut visit: impl FnMut(usize)) {
    for j in 0..layout.rows - 1 {
        for k in (j * layout.pitch..j * layout.pitch + layout.columns - 1).step_by(4) {
            if stiffness[k..k + 4].iter().any(|k| *k > 0.0) {
                visit(k);
            }
        }
    }
}

impl CellLayer {
    /// The augmented pressure of four cells.
    #[inline(always)]
    pub(super) fn augmented(&self, scratch: &Scratch, k: usize) -> f32x4 {
        if self.is_augmented { load(&scratch.pressure, k) } else { f32x4::ZERO }
    }
}

/// The derivatives of the energy of four cells by their modes; `points` marks the cells with four points, of these parities.
#[inline(always)]
fn forces(
    law: &impl SolidLaw<f32x4>,
    modes: &Modes<f32x4>,
    shape: &impl RestShape,
    [points, parity]: [f32x4; 2],
    augmented: f32x4,
) -> Modes<f32x4> {
    let center = || cell::center(law, modes, shape, augmented);
    if !points.any() {
        return center();
    }
    let bare = shape.removed(modes);
    let four = cell::four_points(law, &bare, shape.sides(), parity, augmented);
    let four = shape.handed_back(four);
    if points.all() {
        return four;
    }
    let one = center();
    let pick = |a: Vec3, b: Vec3| [0, 1, 2].map(|k| points.bitselect(a[k], b[k]));
    let pick3 = |a: Matrix<f32x4>, b: Matrix<f32x4>| [0, 1, 2].map(|k| pick(a[k], b[k]));
    Modes {
        linear: pick3(four.linear, one.linear),
        twist: pick3(four.twist, one.twist),
        d: pick(four.d, one.d),
    }
}

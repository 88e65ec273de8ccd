//! Blocks of the stiffness of regular cells and of the attachment.

use super::forces::{at_corners, attached_groups, first_parity};
use super::shapes::Layers;
use super::{Layered, Scratch};
use crate::mesh::lanes::{Field, Layout, load, store};
use crate::model::columns::ColumnBlocks;
use crate::model::layered::attachment::PAIRS;
use crate::model::layered::modes::{Corners, modes};
use crate::model::layered::shape::RestShape;
use crate::model::layered::stiffness::{CORNERS, CellStiffness};
use crate::springs::solids::{SolidLaw, of_law};
use wide::f32x4;

impl Layered {
    /// Adds the blocks of the cells.
    pub(super) fn add_cell_blocks(
        &self,
        layout: &Layout,
        shapes: &impl Layers,
        u: &Field,
        blocks: &mut ColumnBlocks,
        scratch: &Scratch,
    ) {
        let length = layout.len();
        for (layer, cells) in self.cells.iter().enumerate() {
            for row in layout.cell_rows() {
                let parity = first_parity(layout, row.start);
                let parity = if layer % 2 == 0 { parity } else { -parity };
                for group in 0..row.groups {
                    let k = row.start + 4 * group;
                    let points = load(&scratch.in_ring, k).simd_gt(f32x4::ZERO);
                    let at = k + layer * length;
                    let augmented = cells.augmented(scratch, at);
                    let lanes =
                        [row.counts(group), points & scratch.points[layer], parity, augmented];
                    let shape = shapes.regular(layer, k);
                    of_law!(&cells.law, law => {
                        add_blocks(law, layout, u, at, &shape, lanes, blocks);
                    });
                }
            }
            let layers = [layer, layer + 1].map(|layer| layer * length);
            let pressure = scratch.border_pressure(layer);
            let shape = |group: usize| shapes.inverted_at_border(layer, group);
            of_law!(&cells.law, law => {
                scratch.border.add_blocks(law, shape, layers, pressure, u, blocks);
            });
        }
    }

    /// Adds the blocks of the attachment.
    pub(super) fn add_attachment_blocks(
        layout: &Layout,
        blocks: &mut ColumnBlocks,
        scratch: &Scratch,
    ) {
        // An upper bound: the sum of each row.
        attached_groups(layout, &scratch.attachment[0], |k| {
            let mut sums = [f32x4::ZERO; 4];
            for (values, [a, b]) in scratch.attachment.iter().zip(PAIRS) {
                let weight = load(values, k);
                sums[a] += weight;
                if a != b {
                    sums[b] += weight;
                }
            }
            for (corner, sum) in CORNERS.into_iter().zip(sums) {
                let zero = f32x4::ZERO;
                let to = k + corner[0] + corner[1] * layout.pitch;
                blocks.diagonal.add(to, [sum, zero, zero, sum, zero, sum]);
            }
        });
    }
}

/// Adds the blocks of four cells whose first corner is at k; `points` marks the cells with four points, of these parities.
fn add_blocks(
    law: &impl SolidLaw<f32x4>,
    layout: &Layout,
    u: &Field,
    k: usize,
    shape: &impl RestShape,
    [counts, points, parity, augmented]: [f32x4; 4],
    blocks: &mut ColumnBlocks,
) {
    let (length, pitch) = (layout.len(), layout.pitch);
    let faces = [k, k + length].map(|k| Corners::new(at_corners(u, k, pitch)));
    let modes = shape.removed(&modes(&faces[0], &faces[1]));
    let mut add = |stiffness: &CellStiffness<_>, weight: f32x4| {
        for [i, j] in CORNERS {
            let sign = |bit: usize| if bit == 1 { 1.0 } else { -1.0 };
            let (diagonal, above) = stiffness.blocks(sign(i), sign(j), weight);
            let at = k + i + j * pitch;
            blocks.diagonal.add(at, diagonal[0]);
            blocks.diagonal.add(at + length, diagonal[1]);
            for (part, lanes) in blocks.above.iter_mut().zip(above) {
                let total = load(part, at) + lanes;
                store(part, at, total);
            }
        }
    };
    let (one, zero) = (shape.weight() & counts, f32x4::ZERO);
    if points.any() {
        for stiffness in &CellStiffness::at_points(law, &modes, shape, parity, augmented) {
            add(stiffness, points.bitselect(one, zero));
        }
    }
    if !points.all() {
        let stiffness = CellStiffness::new(law, &modes, shape, augmented);
        add(&stiffness, points.bitselect(zero, one));
    }
}

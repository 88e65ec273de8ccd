//! The augmented pressure of nearly incompressible tissue: renewed once a cycle, mixed as the displacements, handed to the next finer grid.

use super::forces::{at_corners, first_parity};
use super::shapes::Layers;
use super::{Layered, Scratch};
use crate::mesh::lanes::{Field, Layout, load, store};
use crate::model::layered::border::Four;
use crate::model::layered::cell;
use crate::model::layered::modes::{Corners, modes};
use crate::model::layered::shape::RestShape;
use crate::springs::solids::{SolidLaw, Volume, of_law};
use wide::f32x4;

impl Scratch {
    /// The augmented pressures at the border of a layer of cells; empty without.
    pub(super) fn border_pressure(&self, layer: usize) -> &[f32x4] {
        let groups = self.border.len();
        self.border_pressure.get(layer * groups..(layer + 1) * groups).unwrap_or_default()
    }

    /// Mixes the pressures of the last cycles as the displacements.
    pub(super) fn mix_pressures(&mut self, [one, two]: [f32; 2]) {
        let Self { pressure, border_pressure, last_pressures, .. } = self;
        for (last, last_border) in last_pressures.iter_mut() {
            // After the first mixing nothing is allocated.
            last.resize(pressure.len(), 0.0);
            last_border.resize(border_pressure.len(), f32x4::ZERO);
        }
        let [(last, last_border), (older, older_border)] = last_pressures;
        // A number of another solve may not be finite.
        let part = |theta: f32, by: f32| if theta == 0.0 { 0.0 } else { theta * by };
        for ((p, last), older) in pressure.iter_mut().zip(last).zip(older) {
            let own = *p;
            *p = own - part(one, own - *last) - part(two, own - *older);
            (*last, *older) = (own, *last);
        }
        let parts = |theta: f32, by: f32x4| if theta == 0.0 { f32x4::ZERO } else { by * theta };
        let places = border_pressure.iter_mut().zip(last_border).zip(older_border);
        for ((p, last), older) in places {
            let own = *p;
            *p = own - parts(one, own - *last) - parts(two, own - *older);
            (*last, *older) = (own, *last);
        }
    }
}

impl Layered {
    /// Is a tissue nearly incompressible, with an augmented pressure?
    pub(crate) fn is_augmented(&self) -> bool {
        self.cells.iter().any(|cells| cells.is_augmented)
    }

    /// Renews the augmented pressures.
    pub(super) fn renew_pressure(
        &self,
        layout: &Layout,
        shapes: &impl Layers,
        u: &Field,
        scratch: &mut Scratch,
    ) {
        let (length, pitch) = (layout.len(), layout.pitch);
        for row in layout.cell_rows() {
            let parity = first_parity(layout, row.start);
            for group in 0..row.groups {
                let k = row.start + 4 * group;
                let in_ring = load(&scratch.in_ring, k).simd_gt(f32x4::ZERO);
                for (layer, cells) in self.cells.iter().enumerate() {
                    if !cells.is_augmented {
                        continue;
                    }
                    let (at, shape) = (k + layer * length, shapes.regular(layer, k));
                    let faces = [at, at + length].map(|k| Corners::new(at_corners(u, k, pitch)));
                    let modes = shape.removed(&modes(&faces[0], &faces[1]));
                    let sign = if layer % 2 == 0 { parity } else { -parity };
                    let points = in_ring & scratch.points[layer];
                    let mut volume = cell::volume(&modes, shape.sides());
                    if points.any() {
                        let mean = cell::deformed_points(&modes, shape.sides(), sign).1;
                        volume = points.bitselect(mean, volume);
                    }
                    let before = load(&scratch.pressure, at);
                    // Lanes beyond the row keep no pressure.
                    let volume = Volume::new(volume);
                    let renewed = of_law!(&cells.law, law => law.renewed(volume, before));
                    let renewed = renewed & row.counts(group);
                    store(&mut scratch.pressure, at, renewed);
                }
            }
        }
        let groups = scratch.border.len();
        let all = scratch.border_pressure.chunks_mut(groups.max(1));
        for (layer, (cells, pressure)) in self.cells.iter().zip(all).enumerate() {
            if cells.is_augmented {
                let layers = [layer, layer + 1].map(|layer| layer * length);
                let shape = |group: usize, four: &Four| shapes.at_border(layer, group, four);
                of_law!(&cells.law, law => scratch.border.renew(law, shape, layers, u, pressure));
                scratch.border.leave(pressure, &mut scratch.pressure[layers[0]..]);
            }
        }
    }

    /// Gives each cell the pressure of the coarser grid's cell around it.
    pub(super) fn hand_on_pressures(
        &self,
        (coarse_layout, coarse): (&Layout, &Scratch),
        layout: &Layout,
        scratch: &mut Scratch,
    ) {
        if scratch.pressure.is_empty() {
            return;
        }
        let (first, coarse_first) = (layout.first(), coarse_layout.first());
        for layer in 0..self.cells.len() {
            let from = &coarse.pressure[layer * coarse_layout.len()..];
            let to = &mut scratch.pressure[layer * layout.len()..];
            for j in 0..layout.rows - 1 {
                let parent = ((j + first[1]) / 2).saturating_sub(coarse_first[1]);
                for i in 0..layout.columns - 1 {
                    let column = ((i + first[0]) / 2).saturating_sub(coarse_first[0]);
                    to[j * layout.pitch + i] = from[parent * coarse_layout.pitch + column];
                }
            }
            let border = scratch.border_pressure.chunks_mut(scratch.border.len().max(1)).nth(layer);
            scratch.border.take(to, border.unwrap_or_default());
        }
    }
}

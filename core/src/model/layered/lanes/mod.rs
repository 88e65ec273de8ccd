//! The layered body in four f32 lanes: an [`ElasticModel`] of full multigrid.
//!
//! The outermost layer of nodes carries the skin, a [`Membrane`]; between two layers of nodes lies a layer of cells.
//!
//! `forces` (of the regular cells and the attachment).

mod forces;

use super::LayeredLaw;
use super::attachment::PAIRS;
use super::border::Border;
use super::cell::{self, Variation};
use super::law::{SolidLaw, Volume};
use super::modes::{Corners, modes};
use super::sides::Upright;
use super::stiffness::{CORNERS, CellStiffness, LaneLaw, Shape};
use crate::mesh::lanes::{BorderTriangle, Field, Layout, load, store};
use crate::mesh::vec3::dot;
use crate::mesh::{Attachment, Cells, Rest};
use crate::model::columns::ColumnBlocks;
use crate::model::membrane::lanes::{Membrane, Scratch as SkinScratch};
use crate::model::{ElasticModel, Tension};
use forces::{at_corners, attached_groups, first_parity};
use wide::f32x4;

/// The greatest change of a cell's height in one step \[cell heights\].
const MAX_COMPRESSION: f64 = 0.25;
/// Widths of the ring inside and outside of the pocket's edge in which cells have four points \[mm\]: a softening tissue
/// concentrates its strain there. Rings of 15 mm on either side change the skin by 0.01 % of the base radius.
const RING_MM: (f64, f64) = (4.0, 10.0);
/// The least of these widths \[spacings\].
const LEAST_RING: f64 = 1.5;
/// Spacing times height below which a cell has one point \[mm²\]: four points have no stable shape where the strain concentrates
/// within a fine cell.
const LEAST_SECTION_MM2: f64 = 9.0;

/// Is a cell at this distance from the pocket's centre in the ring in which cells have four points?
pub(super) fn is_in_ring(distance: f64, pocket_radius: f64, spacing: f64) -> bool {
    let least = LEAST_RING * spacing;
    (-RING_MM.0.max(least)..=RING_MM.1.max(least)).contains(&(distance - pocket_radius))
}

/// Is a cell large enough for four points?
pub(super) fn is_large(spacing: f64, height: f64) -> bool {
    spacing * height >= LEAST_SECTION_MM2
}

/// The layered body, scaled so that the skin's stiffness at small strain is one.
#[derive(Clone, Debug)]
pub(crate) struct Layered {
    skin: Membrane,
    /// Layers of cells, from the inner face outwards.
    cells: Vec<CellLayer>,
    pocket_radius: f64,
    attachment: Option<Attachment>,
    /// The skin's stiffness \[kPa·mm\].
    stiffness: f64,
}

#[derive(Clone, Debug)]
struct CellLayer {
    /// Stresses times the cells' height over the skin's stiffness.
    law: LaneLaw,
    height: f64,
    /// Is the tissue nearly incompressible, with an augmented pressure?
    is_augmented: bool,
}

/// The geometry of one grid.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    skin: SkinScratch,
    /// The layout of the layer that carries the skin.
    outer: Layout,
    border: Border,
    /// Of each layer of cells.
    shapes: Vec<Shape>,
    /// The augmented pressure of the cell at each stored node, shape (layers of cells, stored nodes) \[secants\]; empty unless a
    /// tissue is nearly incompressible.
    pressure: Vec<f32>,
    /// The same of the groups of four cells at the border, shape (layers of cells, groups).
    border_pressure: Vec<f32x4>,
    /// Of the cells at each stored node: 1 in the ring of four points, else 0.
    in_ring: Vec<f32>,
    /// Of the cell at each stored node: integrals of the attachment for [`PAIRS`], scaled.
    attachment: [Vec<f32>; 10],
    /// What the arrays above are computed for.
    geometry: Option<Geometry>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Geometry {
    spacing: f64,
    pocket_radius: f64,
    attachment: Option<Attachment>,
    stiffness: f64,
}

impl Layered {
    pub(crate) fn new(
        law: &LayeredLaw,
        rest: &Rest,
        pocket_radius: f64,
        attachment: Option<Attachment>,
    ) -> Self {
        let stiffness = law.skin.stiffness();
        let layer = |cells: &Cells| CellLayer {
            law: law.solids[cells.solid].scaled(cells.height_mm / stiffness),
            height: cells.height_mm,
            is_augmented: law.solids[cells.solid].is_augmented(),
        };
        Self {
            skin: Membrane::new(&law.skin),
            cells: rest.cells().iter().map(layer).collect(),
            pocket_radius,
            attachment,
            stiffness,
        }
    }
}

impl Scratch {
    /// The augmented pressures at the border of a layer of cells; empty without.
    fn border_pressure(&self, layer: usize) -> &[f32x4] {
        let groups = self.border.len();
        self.border_pressure.get(layer * groups..(layer + 1) * groups).unwrap_or_default()
    }
}

impl Layered {
    /// Is a tissue nearly incompressible, with an augmented pressure?
    pub(crate) fn is_augmented(&self) -> bool {
        self.cells.iter().any(|cells| cells.is_augmented)
    }
}

impl ElasticModel for Layered {
    type Scratch = Scratch;
    type Stiffness = ColumnBlocks;

    fn layers(&self) -> usize {
        self.cells.len() + 1
    }

    fn scratch(&self, layout: &Layout, border: &[BorderTriangle]) -> Scratch {
        let outer = layout.of_layer(self.cells.len());
        let shift = outer.origin();
        let triangles: Vec<BorderTriangle> = border
            .iter()
            .map(|triangle| BorderTriangle {
                nodes: triangle.nodes.map(|k| k + shift as u32),
                ..*triangle
            })
            .collect();
        Scratch {
            skin: self.skin.scratch(&outer, &triangles),
            border: Border::new(layout),
            shapes: vec![Shape::default(); self.cells.len()],
            pressure: Vec::new(),
            border_pressure: Vec::new(),
            in_ring: vec![0.0; layout.len()],
            attachment: [0; 10].map(|_| vec![0.0; layout.len()]),
            geometry: None,
            outer,
        }
    }

    fn place(&self, layout: &Layout, spacing: f64, scratch: &mut Scratch) {
        let geometry = Geometry {
            spacing,
            pocket_radius: self.pocket_radius,
            attachment: self.attachment,
            stiffness: self.stiffness,
        };
        scratch.pressure.clear();
        scratch.border_pressure.clear();
        if self.is_augmented() {
            scratch.pressure.resize(layout.len() * self.cells.len(), 0.0);
            let groups = scratch.border.len() * self.cells.len();
            scratch.border_pressure.resize(groups, f32x4::ZERO);
        }
        for (shape, cells) in scratch.shapes.iter_mut().zip(&self.cells) {
            let slope = spacing / cells.height;
            let zero = f32x4::ZERO;
            *shape = Shape {
                sides: Upright { slope: f32x4::splat(slope as f32) },
                variation: Variation::new(slope),
                points: if is_large(spacing, cells.height) { zero.simd_eq(zero) } else { zero },
            };
        }
        if scratch.geometry == Some(geometry) {
            return;
        }
        scratch.geometry = Some(geometry);
        let [x0, y0] = layout.center().map(|center| center as f64);
        // Forces are in units of the stiffness times the spacing.
        let unit = spacing * spacing / self.stiffness;
        for j in 0..layout.rows - 1 {
            for i in 0..layout.columns - 1 {
                let k = j * layout.pitch + i;
                let corner = [(i as f64 - x0) * spacing, (j as f64 - y0) * spacing];
                let distance = (corner[0] + 0.5 * spacing).hypot(corner[1] + 0.5 * spacing);
                let is_in_ring = is_in_ring(distance, self.pocket_radius, spacing);
                scratch.in_ring[k] = if is_in_ring { 1.0 } else { 0.0 };
                let integrals = self
                    .attachment
                    .filter(|_| layout.touches_free(i, j))
                    .and_then(|a| a.integrals(self.pocket_radius, corner, spacing));
                for (pair, values) in scratch.attachment.iter_mut().enumerate() {
                    values[k] = integrals.map_or(0.0, |all| (all[pair] * unit) as f32);
                }
            }
        }
    }

    fn forces(&self, layout: &Layout, u: &Field, f: &mut Field, scratch: &mut Scratch) {
        self.skin.forces(&scratch.outer, u, f, &mut scratch.skin);
        self.add_cells(layout, u, f, scratch);
        Self::add_attachment(layout, u, f, scratch);
        for (layer, (cells, shape)) in self.cells.iter().zip(&scratch.shapes).enumerate() {
            let layers = [layer, layer + 1].map(|layer| layer * layout.len());
            let pressure = scratch.border_pressure(layer);
            scratch.border.add_forces(&cells.law, shape, layers, pressure, u, f);
        }
    }

    fn blocks(&self, layout: &Layout, u: &Field, blocks: &mut ColumnBlocks, scratch: &mut Scratch) {
        blocks.fill_zero();
        self.skin.blocks(&scratch.outer, u, &mut blocks.diagonal, &mut scratch.skin);
        let length = layout.len();
        for (layer, (cells, shape)) in self.cells.iter().zip(&scratch.shapes).enumerate() {
            let height = f64::from(1.0 / shape.sides.slope.to_array()[0]);
            blocks.limits[layer] = (MAX_COMPRESSION * height) as f32;
            for row in layout.cell_rows() {
                let parity = first_parity(layout, row.start);
                let parity = if layer % 2 == 0 { parity } else { -parity };
                for group in 0..row.groups {
                    let k = row.start + 4 * group;
                    let points = load(&scratch.in_ring, k).simd_gt(f32x4::ZERO);
                    let at = k + layer * length;
                    let augmented = cells.augmented(scratch, at);
                    let lanes = [row.counts(group), points & shape.points, parity, augmented];
                    cells.add_blocks(layout, u, at, shape, lanes, blocks);
                }
            }
            let layers = [layer, layer + 1].map(|layer| layer * length);
            let pressure = scratch.border_pressure(layer);
            scratch.border.add_blocks(&cells.law, shape, layers, pressure, u, blocks);
        }
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

    fn tension(&self, layout: &Layout, u: &Field, scratch: &mut Scratch) -> Tension {
        let mut tension = self.skin.tension(&scratch.outer, u, &mut scratch.skin);
        let (length, pitch) = (layout.len(), layout.pitch);
        for row in layout.cell_rows() {
            for group in 0..row.groups {
                let k = row.start + 4 * group;
                for (layer, (cells, shape)) in self.cells.iter().zip(&scratch.shapes).enumerate() {
                    let at = k + layer * length;
                    let faces = [at, at + length].map(|k| Corners::new(at_corners(u, k, pitch)));
                    let modes = modes(&faces[0], &faces[1]);
                    let volume = cell::volume(&modes, &shape.sides);
                    let inverted = volume.simd_le(f32x4::ZERO) & row.counts(group);
                    tension.has_inverted_cell |= inverted.any();
                    let augmented = cells.augmented(scratch, at);
                    let force =
                        cell::center(&cells.law, &modes, &shape.sides, &shape.variation, augmented);
                    let squares = force.linear.map(|f| dot(f, f));
                    let squares = squares[0] + squares[1] + squares[2];
                    tension.squares += f64::from((squares & row.counts(group)).reduce_add());
                }
            }
        }
        // Only the skin may wrinkle, and its bending is not resolved: no other method does better.
        tension.least = 0.0;
        tension
    }

    fn renew(&self, layout: &Layout, u: &Field, scratch: &mut Scratch) {
        if scratch.pressure.is_empty() {
            return;
        }
        let (length, pitch) = (layout.len(), layout.pitch);
        for row in layout.cell_rows() {
            let parity = first_parity(layout, row.start);
            for group in 0..row.groups {
                let k = row.start + 4 * group;
                let in_ring = load(&scratch.in_ring, k).simd_gt(f32x4::ZERO);
                for (layer, (cells, shape)) in self.cells.iter().zip(&scratch.shapes).enumerate() {
                    if !cells.is_augmented {
                        continue;
                    }
                    let at = k + layer * length;
                    let faces = [at, at + length].map(|k| Corners::new(at_corners(u, k, pitch)));
                    let modes = modes(&faces[0], &faces[1]);
                    let sign = if layer % 2 == 0 { parity } else { -parity };
                    let points = in_ring & shape.points;
                    let mut volume = cell::volume(&modes, &shape.sides);
                    if points.any() {
                        let mean = cell::deformed_points(&modes, &shape.sides, sign).1;
                        volume = points.bitselect(mean, volume);
                    }
                    let before = load(&scratch.pressure, at);
                    // Lanes beyond the row keep no pressure.
                    let renewed =
                        cells.law.renewed(Volume::new(volume), before) & row.counts(group);
                    store(&mut scratch.pressure, at, renewed);
                }
            }
        }
        let groups = scratch.border.len();
        let all = scratch.border_pressure.chunks_mut(groups.max(1));
        for (layer, (cells, pressure)) in self.cells.iter().zip(all).enumerate() {
            if cells.is_augmented {
                let layers = [layer, layer + 1].map(|layer| layer * length);
                let shape = &scratch.shapes[layer];
                scratch.border.renew(&cells.law, shape, layers, u, pressure);
            }
        }
    }

    fn hand_on(
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
        }
    }

    fn has_contact_offsets(&self) -> bool {
        false
    }
}

impl CellLayer {
    /// Adds the blocks of four cells whose first corner is at k; `points` marks the cells with four points, of these parities.
    fn add_blocks(
        &self,
        layout: &Layout,
        u: &Field,
        k: usize,
        shape: &Shape,
        [counts, points, parity, augmented]: [f32x4; 4],
        blocks: &mut ColumnBlocks,
    ) {
        let (length, pitch) = (layout.len(), layout.pitch);
        let faces = [k, k + length].map(|k| Corners::new(at_corners(u, k, pitch)));
        let modes = modes(&faces[0], &faces[1]);
        let mut add = |stiffness: &CellStiffness, weight: f32x4| {
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
        let (one, zero) = (f32x4::ONE & counts, f32x4::ZERO);
        if points.any() {
            for stiffness in &CellStiffness::at_points(&self.law, &modes, shape, parity, augmented)
            {
                add(stiffness, points.bitselect(one, zero));
            }
        }
        if !points.all() {
            let stiffness = CellStiffness::new(&self.law, &modes, shape, augmented);
            add(&stiffness, points.bitselect(zero, one));
        }
    }
}

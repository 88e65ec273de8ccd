//! The layered body in four f32 lanes: an [`ElasticModel`] of full multigrid.
//!
//! The outermost layer of nodes carries the skin, a [`Membrane`]; between two layers of nodes lies a layer of cells.
//!
//! `shapes` (of the cells at rest) | `forces`, `blocks` (of the regular cells and the attachment) | `suction` (of a void).

mod blocks;
mod forces;
mod shapes;
mod suction;

use super::LayeredLaw;
use super::border::{Border, Four};
use super::cell;
use super::modes::{Corners, modes};
use super::shape::{Even, RestShape};
use crate::mesh::lanes::{Field, Layout, load, store};
use crate::mesh::vec3::dot;
use crate::mesh::{Attachment, Cells, Grown, NaturalStretch, Pocket, Rest};
use crate::model::columns::ColumnBlocks;
use crate::model::membrane::lanes::{Membrane, Scratch as SkinScratch};
use crate::model::{ElasticModel, Tension};
use crate::springs::solids::{LaneLaw, SolidLaw, Volume, WholeLaw, of_law};
use forces::{at_corners, first_parity};
use shapes::{CurvedLayers, Layers, Shapes};
use std::sync::Arc;
use suction::LaneSuction;
pub(crate) use suction::OnFinest;
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

/// Is a cell at this distance beyond the pocket's edge in the ring in which cells have four points?
pub(super) fn is_in_ring(beyond: f64, spacing: f64) -> bool {
    let least = LEAST_RING * spacing;
    (-RING_MM.0.max(least)..=RING_MM.1.max(least)).contains(&beyond)
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
    pocket: Pocket,
    attachment: Option<Attachment>,
    /// The stretch of the skin at rest.
    natural: Option<NaturalStretch>,
    /// What has grown of the skin, on the finest grid.
    grown: Option<Grown>,
    suction: Option<OnFinest>,
    /// The tissue on the finest grid, if its weight has changed.
    weighed: Option<Rest>,
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
    /// Forces at rest, on the skin's layer of nodes or on all: a dead load holds them. Empty where they are zero.
    at_rest: Field,
    border: Border,
    shapes: Shapes,
    /// May the cells of each layer have four points? As a mask.
    points: Vec<f32x4>,
    /// The augmented pressure of the cell at each stored node, shape (layers of cells, stored nodes) \[secants\]; empty unless a
    /// tissue is nearly incompressible.
    pressure: Vec<f32>,
    /// The same of the groups of four cells at the border, shape (layers of cells, groups).
    border_pressure: Vec<f32x4>,
    /// Both before the last two mixings, the last one first.
    last_pressures: [(Vec<f32>, Vec<f32x4>); 2],
    /// Of the cells at each stored node: 1 in the ring of four points, else 0.
    in_ring: Vec<f32>,
    /// Of the cell at each stored node: integrals of the attachment for [`super::attachment::PAIRS`], scaled.
    attachment: [Vec<f32>; 10],
    /// What the arrays above are computed for, and the tissue over a curved wall that skin and shapes are of.
    geometry: Option<Geometry>,
    rest: Option<Arc<Rest>>,
    /// The growth on the finest grid that the skin has.
    grown: Option<Grown>,
    suction: Option<LaneSuction>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Geometry {
    spacing: f64,
    pocket: Pocket,
    attachment: Option<Attachment>,
    natural: Option<NaturalStretch>,
    stiffness: f64,
}

impl Layered {
    pub(crate) fn new(
        law: &LayeredLaw,
        rest: &Rest,
        pocket: Pocket,
        attachment: Option<Attachment>,
    ) -> Self {
        let stiffness = law.skin.stiffness();
        let layer = |cells: &Cells| CellLayer {
            law: law.solids[cells.solid].in_lanes(cells.height_mm / stiffness),
            height: cells.height_mm,
            is_augmented: of_law!(&law.solids[cells.solid], law => law.is_augmented()),
        };
        Self {
            skin: Membrane::new(&law.skin),
            cells: rest.cells().iter().map(layer).collect(),
            pocket,
            attachment,
            natural: rest.natural().copied(),
            grown: rest.grown().cloned(),
            suction: None,
            weighed: (!rest.weight().is_none()).then(|| rest.clone()),
            stiffness,
        }
    }

    /// The skin at rest on a grid, `rest` being `None` over a flat wall, of which this has grown on the finest grid.
    fn skin_at_rest(
        &self,
        layout: &Layout,
        rest: Option<&Rest>,
        grown: Option<&Grown>,
    ) -> SkinScratch {
        let grown = grown.map(|grown| grown.restricted(layout.nodes_per_side));
        let skin = |rest: &Rest| {
            let surface = rest.outermost().stretched(self.natural.as_ref()).grown(grown.as_ref());
            SkinScratch::new(layout, surface, self.cells.len())
        };
        rest.map_or_else(|| skin(&layout.plane()), skin)
    }

    /// Sets the forces at rest: those of the skin, less the change of weight.
    fn load_at_rest(
        &self,
        (layout, spacing): (&Layout, f64),
        rest: Option<&Arc<Rest>>,
        scratch: &mut Scratch,
    ) {
        scratch.at_rest = match (&self.weighed, self.natural) {
            (None, None) => Field::default(),
            (None, Some(_)) => self.skin_forces_at_rest(layout, rest, scratch),
            (Some(finest), natural) => {
                let on_grid = finest.restricted(layout.nodes_per_side);
                let mut load = Field::new(layout.len(), self.layers());
                let unit = 1.0 / (self.stiffness * spacing);
                for (layer, weight) in on_grid.change_of_weight().iter().enumerate() {
                    layout.free_rows(|j, from, to| {
                        for i in from..to {
                            let at = layer * layout.len() + j * layout.pitch + i;
                            let force = weight[layout.node(i, j)] * -unit;
                            load.x[at] = force.x as f32;
                            load.y[at] = force.y as f32;
                            load.z[at] = force.z as f32;
                        }
                    });
                }
                if natural.is_some() {
                    // Minus the forces of the skin at rest, subtracted once more.
                    let mut of_skin = self.skin_forces_at_rest(layout, rest, scratch);
                    of_skin.planes_mut().for_each(|plane| plane.iter_mut().for_each(|v| *v = -*v));
                    load.subtract_from_last_plane(&of_skin);
                }
                load
            }
        };
    }

    /// Forces of the skin at rest, on its layer of nodes.
    fn skin_forces_at_rest(
        &self,
        layout: &Layout,
        rest: Option<&Arc<Rest>>,
        scratch: &mut Scratch,
    ) -> Field {
        let zero = Field::new(layout.len(), self.layers());
        let (mut forces, mut at_rest) = (zero.clone(), Field::new(layout.len(), 1));
        if self.grown.is_some() {
            let mut skin = self.skin_at_rest(layout, rest.map(Arc::as_ref), None);
            self.skin.forces(layout, &zero, &mut forces, &mut skin);
        } else {
            self.skin.forces(layout, &zero, &mut forces, &mut scratch.skin);
        }
        at_rest.copy_last_plane_from(&forces);
        at_rest
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

/// Calls a function of any [`Layers`] with those of a grid.
macro_rules! of_shapes {
    ($all:expr, $shapes:ident => $call:expr) => {
        match $all {
            Shapes::Flat($shapes) => $call,
            Shapes::Curved($shapes) => {
                let $shapes = &**$shapes;
                $call
            }
        }
    };
}

impl ElasticModel for Layered {
    type Scratch = Scratch;
    type Stiffness = ColumnBlocks;

    fn layers(&self) -> usize {
        self.cells.len() + 1
    }

    fn scratch(&self, layout: &Layout) -> Scratch {
        Scratch {
            skin: self.skin_at_rest(layout, None, None),
            at_rest: Field::default(),
            border: Border::new(layout),
            shapes: Shapes::default(),
            points: vec![f32x4::ZERO; self.cells.len()],
            pressure: Vec::new(),
            border_pressure: Vec::new(),
            last_pressures: Default::default(),
            in_ring: vec![0.0; layout.len()],
            attachment: [0; 10].map(|_| vec![0.0; layout.len()]),
            geometry: None,
            rest: None,
            grown: None,
            suction: None,
        }
    }

    fn place(
        &self,
        layout: &Layout,
        spacing: f64,
        rest: Option<&Arc<Rest>>,
        scratch: &mut Scratch,
    ) {
        let geometry = Geometry {
            spacing,
            pocket: self.pocket,
            attachment: self.attachment,
            natural: self.natural,
            stiffness: self.stiffness,
        };
        let augmented = if self.is_augmented() { self.cells.len() } else { 0 };
        scratch.pressure.resize(layout.len() * augmented, 0.0);
        let groups = scratch.border.len() * augmented;
        scratch.border_pressure.resize(groups, f32x4::ZERO);
        for (points, cells) in scratch.points.iter_mut().zip(&self.cells) {
            let zero = f32x4::ZERO;
            *points = if is_large(spacing, cells.height) { zero.simd_eq(zero) } else { zero };
        }
        if rest.is_none() {
            let even = |cells: &CellLayer| Even::new(spacing / cells.height);
            scratch.shapes = Shapes::Flat(self.cells.iter().map(even).collect());
        }
        // A level has the same tissue as long as it fits.
        let is_same_rest = rest.map(Arc::as_ptr) == scratch.rest.as_ref().map(Arc::as_ptr);
        let is_same_stretch = scratch.geometry.is_none_or(|known| known.natural == self.natural);
        let is_same_growth = match (&self.grown, &scratch.grown) {
            (Some(own), Some(known)) => own.is_same(known),
            (own, known) => own.is_none() && known.is_none(),
        };
        if !(is_same_rest && is_same_stretch && is_same_growth) {
            self.grow(layout, rest, scratch);
        }
        // The law may have changed.
        self.load_at_rest((layout, spacing), rest, scratch);
        self.draw((layout, spacing), scratch);
        if is_same_rest && scratch.geometry == Some(geometry) {
            return;
        }
        if !is_same_rest {
            if let Some(rest) = rest {
                scratch.shapes = Shapes::Curved(Box::new(CurvedLayers::new(layout, rest)));
            }
            scratch.rest = rest.cloned();
        }
        scratch.geometry = Some(geometry);
        let [x0, y0] = layout.center().map(|center| center as f64);
        let n = layout.nodes_per_side;
        // Forces are in units of the stiffness times the spacing.
        let unit = spacing * spacing / self.stiffness;
        for j in 0..layout.rows - 1 {
            for i in 0..layout.columns - 1 {
                let k = j * layout.pitch + i;
                let corner = [(i as f64 - x0) * spacing, (j as f64 - y0) * spacing];
                let [x, y] = corner.map(|at| at + 0.5 * spacing);
                let is_in_ring = is_in_ring(self.pocket.beyond(x.hypot(y), y), spacing);
                scratch.in_ring[k] = if is_in_ring { 1.0 } else { 0.0 };
                let integrals = self
                    .attachment
                    .filter(|_| layout.touches_free(i, j))
                    .and_then(|a| a.integrals(self.pocket, corner, spacing));
                let unit = rest.filter(|_| integrals.is_some()).map_or(unit, |rest| {
                    let node = layout.node(i, j);
                    rest.area([node, node + 1, node + n + 1, node + n]) / self.stiffness
                });
                for (pair, values) in scratch.attachment.iter_mut().enumerate() {
                    values[k] = integrals.map_or(0.0, |all| (all[pair] * unit) as f32);
                }
            }
        }
    }

    fn grow(&self, layout: &Layout, rest: Option<&Arc<Rest>>, scratch: &mut Scratch) {
        scratch.skin = self.skin_at_rest(layout, rest.map(Arc::as_ref), self.grown.as_ref());
        scratch.grown.clone_from(&self.grown);
        if let Some(geometry) = scratch.geometry {
            self.draw((layout, geometry.spacing), scratch);
        }
    }

    fn forces(&self, layout: &Layout, u: &Field, f: &mut Field, scratch: &mut Scratch) {
        self.skin.forces(layout, u, f, &mut scratch.skin);
        f.subtract_from_last_plane(&scratch.at_rest);
        of_shapes!(&scratch.shapes, shapes => self.add_cells(layout, shapes, u, f, scratch));
        Self::add_attachment(layout, u, f, scratch);
        of_shapes!(&scratch.shapes, shapes => self.add_border(layout, shapes, u, f, scratch));
        if let Some(suction) = &mut scratch.suction {
            suction.add_forces(layout, u, f);
        }
    }

    fn blocks(&self, layout: &Layout, u: &Field, blocks: &mut ColumnBlocks, scratch: &mut Scratch) {
        blocks.fill_zero();
        self.skin.blocks(layout, u, &mut blocks.diagonal, &mut scratch.skin);
        let spacing = scratch.geometry.as_ref().map_or(1.0, |geometry| geometry.spacing);
        for (cells, limit) in self.cells.iter().zip(&mut blocks.limits) {
            *limit = (MAX_COMPRESSION * cells.height / spacing) as f32;
        }
        of_shapes!(&scratch.shapes, shapes => {
            self.add_cell_blocks(layout, shapes, u, blocks, scratch);
        });
        Self::add_attachment_blocks(layout, blocks, scratch);
    }

    fn tension(&self, layout: &Layout, u: &Field, scratch: &mut Scratch) -> Tension {
        let mut tension = self.skin.tension(layout, u, &mut scratch.skin);
        of_shapes!(&scratch.shapes, shapes => {
            self.add_tension(layout, shapes, u, scratch, &mut tension);
        });
        // Only the skin may wrinkle, and its bending is not resolved: no other method does better.
        tension
    }

    fn renew(&self, layout: &Layout, u: &Field, scratch: &mut Scratch) {
        if scratch.pressure.is_empty() {
            return;
        }
        let shapes = std::mem::take(&mut scratch.shapes);
        of_shapes!(&shapes, shapes => self.renew_pressure(layout, shapes, u, scratch));
        scratch.shapes = shapes;
    }

    fn forget(&self, scratch: &mut Scratch) {
        scratch.pressure.fill(0.0);
        scratch.border_pressure.fill(f32x4::ZERO);
    }

    fn mix(&self, scratch: &mut Scratch, [one, two]: [f32; 2]) {
        let Scratch { pressure, border_pressure, last_pressures, .. } = scratch;
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
            let border = scratch.border_pressure.chunks_mut(scratch.border.len().max(1)).nth(layer);
            scratch.border.take(to, border.unwrap_or_default());
        }
    }

    fn stiffness(&self) -> f64 {
        self.stiffness
    }

    fn has_contact_offsets(&self) -> bool {
        false
    }
}

impl Layered {
    /// Adds the forces of the cells at the border.
    fn add_border(
        &self,
        layout: &Layout,
        shapes: &impl Layers,
        u: &Field,
        f: &mut Field,
        scratch: &Scratch,
    ) {
        for (layer, cells) in self.cells.iter().enumerate() {
            let layers = [layer, layer + 1].map(|layer| layer * layout.len());
            let pressure = scratch.border_pressure(layer);
            let shape = |group: usize, four: &Four| shapes.at_border(layer, group, four);
            of_law!(&cells.law, law => {
                scratch.border.add_forces(law, shape, layers, pressure, u, f);
            });
        }
    }

    /// Adds the squares of the cells' forces.
    fn add_tension(
        &self,
        layout: &Layout,
        shapes: &impl Layers,
        u: &Field,
        scratch: &Scratch,
        tension: &mut Tension,
    ) {
        let (length, pitch) = (layout.len(), layout.pitch);
        for row in layout.cell_rows() {
            for group in 0..row.groups {
                let k = row.start + 4 * group;
                for (layer, cells) in self.cells.iter().enumerate() {
                    let (at, shape) = (k + layer * length, shapes.regular(layer, k));
                    let faces = [at, at + length].map(|k| Corners::new(at_corners(u, k, pitch)));
                    let modes = modes(&faces[0], &faces[1]);
                    let volume = cell::volume(&modes, shape.sides());
                    let inverted = volume.simd_le(f32x4::ZERO) & row.counts(group);
                    tension.has_inverted_cell |= inverted.any();
                    let augmented = cells.augmented(scratch, at);
                    let force =
                        of_law!(&cells.law, law => cell::center(law, &modes, &shape, augmented));
                    let squares = force.linear.map(|f| dot(f, f));
                    let squares = squares[0] + squares[1] + squares[2];
                    tension.squares += f64::from((squares & row.counts(group)).reduce_add());
                }
            }
        }
    }

    /// Renews the augmented pressures.
    fn renew_pressure(
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
}

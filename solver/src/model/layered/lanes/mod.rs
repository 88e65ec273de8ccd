//! The layered body in four f32 lanes: an [`ElasticModel`] of full multigrid.
//!
//! The outermost layer of nodes carries the skin, a [`Membrane`]; between two layers of nodes lies a layer of cells.
//!
//! `shapes` (of the cells at rest) | `at_rest` (the dead load) | `pressure` (of nearly incompressible tissue) | `forces`, `blocks` (of the regular cells and the attachment) | `suction` (of a void).

mod at_rest;
mod blocks;
mod forces;
mod pressure;
mod shapes;
mod suction;

use super::LayeredLaw;
use super::border::{Border, Four};
use super::cell;
use super::modes::{Corners, modes};
use super::shape::{Even, RestShape};
use crate::mesh::lanes::{Field, Layout};
use crate::mesh::vec3::dot;
use crate::mesh::{Attachment, Cells, Grown, NaturalStretch, Pocket, Rest};
use crate::model::columns::ColumnBlocks;
use crate::model::membrane::lanes::{Membrane, Scratch as SkinScratch};
use crate::model::{ElasticModel, Tension};
use crate::springs::solids::{LaneLaw, WholeLaw, of_law};
use forces::at_corners;
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
            skin: SkinScratch::new(layout, layout.plane().membrane(), self.cells.len()),
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
        let known = scratch.geometry.as_ref().and_then(|known| known.natural);
        let is_same_stretch = known == self.natural;
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

    fn mix(&self, scratch: &mut Scratch, thetas: [f32; 2]) {
        scratch.mix_pressures(thetas);
    }

    fn hand_on(
        &self,
        (coarse_layout, coarse): (&Layout, &Scratch),
        layout: &Layout,
        scratch: &mut Scratch,
    ) {
        self.hand_on_pressures((coarse_layout, coarse), layout, scratch);
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
}

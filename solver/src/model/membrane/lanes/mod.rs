//! The membrane in four f32 lanes: an [`ElasticModel`] of full multigrid.
//!
//! `coupled`, `paper` (laws and their springs) | `forces` (regular cells) | `border` (triangles at the
//! border) | `tension`.

mod border;
mod coupled;
mod forces;
mod paper;
mod tension;

use super::law::SheetLaw;
use crate::mesh::Surface;
use crate::mesh::lanes::{Field, Layout};
use crate::model::{ElasticModel, NodeBlocks, Tension};
use border::{Border, BorderScratch};
use coupled::CoupledLanes;
use forces::CellLanes;
use paper::LaneSprings;

/// A membrane, scaled so that the stiffness at small strain is one.
#[derive(Clone, Debug)]
pub(crate) enum Membrane {
    Coupled(CoupledLanes),
    Paper(LaneSprings),
}

impl Membrane {
    pub(crate) fn new(law: &SheetLaw) -> Self {
        let stiffness = law.stiffness();
        match law {
            SheetLaw::Coupled(law) => Self::Coupled(CoupledLanes::new(law, stiffness)),
            SheetLaw::Paper(law) => Self::Paper(LaneSprings::new(law, stiffness)),
        }
    }
}

/// The triangles of a grid and the intermediate values of an evaluation of the forces.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    /// With the regular cells of the surface at rest.
    layout: Layout,
    /// All other triangles.
    border: Border,
    on_border: BorderScratch,
    row: Vec<CellLanes>,
}

impl Scratch {
    /// Of a layer of nodes that is this surface at rest.
    pub(crate) fn new(layout: &Layout, surface: Surface, layer: usize) -> Self {
        let (layout, triangles) = layout.of_surface(surface, layer);
        let border = Border::new(&triangles);
        Self {
            on_border: BorderScratch::new(&border),
            border,
            row: vec![CellLanes::default(); layout.pitch / 4 + 1],
            layout,
        }
    }
}

impl ElasticModel for Membrane {
    type Scratch = Scratch;
    type Stiffness = NodeBlocks;

    fn layers(&self) -> usize {
        1
    }

    fn scratch(&self, layout: &Layout) -> Scratch {
        Scratch::new(layout, layout.plane().membrane(), 0)
    }

    fn forces(&self, _layout: &Layout, u: &Field, f: &mut Field, scratch: &mut Scratch) {
        match self {
            Self::Coupled(law) => forces::forces(law, u, f, scratch),
            Self::Paper(law) => paper::forces(law, u, f, scratch),
        }
    }

    fn blocks(&self, _layout: &Layout, u: &Field, blocks: &mut NodeBlocks, scratch: &mut Scratch) {
        match self {
            Self::Coupled(law) => forces::blocks(law, u, blocks, scratch),
            Self::Paper(law) => paper::blocks(law, u, blocks, scratch),
        }
    }

    fn tension(&self, _layout: &Layout, u: &Field, scratch: &mut Scratch) -> Tension {
        match self {
            Self::Coupled(law) => tension::tension(law, u, scratch),
            Self::Paper(law) => paper::tension(law, u, scratch),
        }
    }

    fn stiffness(&self) -> f64 {
        match self {
            Self::Coupled(law) => law.unit,
            Self::Paper(law) => law.unit,
        }
    }

    fn has_contact_offsets(&self) -> bool {
        matches!(self, Self::Coupled(_))
    }
}

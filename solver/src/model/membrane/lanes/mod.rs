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
use crate::mesh::lanes::{BorderTriangle, Field, Layout};
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

/// The border of a grid and the intermediate values of an evaluation of the forces.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    border: Border,
    on_border: BorderScratch,
    row: Vec<CellLanes>,
}

impl ElasticModel for Membrane {
    type Scratch = Scratch;
    type Stiffness = NodeBlocks;

    fn layers(&self) -> usize {
        1
    }

    fn scratch(&self, layout: &Layout, border: &[BorderTriangle]) -> Scratch {
        let border = Border::new(border);
        Scratch {
            on_border: BorderScratch::new(&border),
            border,
            row: vec![CellLanes::default(); layout.pitch / 4 + 1],
        }
    }

    fn forces(&self, layout: &Layout, u: &Field, f: &mut Field, scratch: &mut Scratch) {
        match self {
            Self::Coupled(law) => forces::forces(layout, law, u, f, scratch),
            Self::Paper(law) => paper::forces(layout, law, u, f, scratch),
        }
    }

    fn blocks(&self, layout: &Layout, u: &Field, blocks: &mut NodeBlocks, scratch: &mut Scratch) {
        match self {
            Self::Coupled(law) => forces::blocks(layout, law, u, blocks, scratch),
            Self::Paper(law) => paper::blocks(layout, law, u, blocks, scratch),
        }
    }

    fn tension(&self, layout: &Layout, u: &Field, scratch: &mut Scratch) -> Tension {
        match self {
            Self::Coupled(law) => tension::tension(layout, law, u, scratch),
            Self::Paper(law) => paper::tension(layout, law, u),
        }
    }

    fn has_contact_offsets(&self) -> bool {
        matches!(self, Self::Coupled(_))
    }
}

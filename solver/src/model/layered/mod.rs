//! Tissue as a body: the skin, a membrane, on layers of solid tissue; one node a layer of cells and one more in a
//! column.
//!
//! `deformed` (change of shape and volume, stress) | `modes` (of a cell's displacement) | `sides`, `variation`, `shape` (of a cell at rest) | `cell` (energy and forces) | `attachment` (beyond the pocket) | `lanes` (the body in four f32 lanes) |
//! `stiffness` (blocks of four cells) | `border` (cells on the patch's circle) | `exact` (the body in f64) | `suction` (of a void) | `tangent`
//! (second derivatives in f64).

pub(crate) mod attachment;
mod border;
mod cell;
pub(crate) mod deformed;
pub mod exact;
pub(crate) mod lanes;
mod modes;
mod shape;
mod sides;
mod stiffness;
pub(crate) mod suction;
pub(crate) mod tangent;
mod variation;

use super::membrane::law::SheetLaw;
use crate::springs::solids::ExactLaw;
use crate::springs::{Material, Springs};

/// The laws of the layers.
#[derive(Clone, Debug)]
pub struct LayeredLaw {
    pub skin: SheetLaw,
    /// From the inner face outwards.
    pub solids: Vec<ExactLaw>,
}

impl LayeredLaw {
    /// The laws of materials from the skin inwards.
    pub fn new(materials: &[Material]) -> Self {
        let (skin, solids) = materials.split_at(materials.len().min(1));
        Self {
            skin: SheetLaw::new(Springs::Coupled, skin),
            solids: solids.iter().rev().map(ExactLaw::new).collect(),
        }
    }
}

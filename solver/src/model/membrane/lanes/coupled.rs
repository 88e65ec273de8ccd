//! The coupled law in lanes of four f32, scaled for the regular cells of a grid.

use crate::springs::closed_form::{self, Change, Group, Stiffness, Stretch};
use crate::springs::coupled::CoupledLaw;
use crate::springs::table::Buckets;
use wide::f32x4;

/// Weight of a regular triangle, a quarter of a cell's square; part of the tables.
const TRIANGLE_WEIGHT: f64 = 0.25;

type LaneGroup = Group<f32x4, Buckets<f32x4>>;

/// The law, scaled so that the stiffness at small strain is 1.
#[derive(Clone, Debug)]
pub(crate) struct CoupledLanes {
    groups: Vec<LaneGroup>,
    /// Stiffness at small strain \[kPa·mm\].
    pub(super) unit: f64,
}

impl CoupledLanes {
    /// The lanes of a law whose stiffness at small strain is `stiffness` \[kPa·mm\].
    pub(super) fn new(law: &CoupledLaw, stiffness: f64) -> Self {
        Self { groups: law.closed_form(TRIANGLE_WEIGHT / stiffness), unit: stiffness }
    }

    /// Layers by their Poisson ratio: most sheets have one, which has a [`Law`] of its own.
    pub(super) fn groups(&self) -> &[LaneGroup] {
        &self.groups
    }

    #[inline(always)]
    pub(super) fn stiffness(&self, at: Stretch<f32x4>, change: Change<f32x4>) -> Stiffness<f32x4> {
        closed_form::stiffness(&self.groups, at, change)
    }
}

/// The tension of four triangles.
pub(super) trait Law {
    /// A and Q of triangles.
    fn tension(&self, at: Stretch<f32x4>, change: Change<f32x4>) -> [f32x4; 2];
}

impl Law for LaneGroup {
    #[inline(always)]
    fn tension(&self, at: Stretch<f32x4>, change: Change<f32x4>) -> [f32x4; 2] {
        Group::tension(self, at, change)
    }
}

impl Law for [LaneGroup] {
    #[inline(always)]
    fn tension(&self, at: Stretch<f32x4>, change: Change<f32x4>) -> [f32x4; 2] {
        closed_form::tension(self, at, change)
    }
}

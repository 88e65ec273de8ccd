//! The coupled law in lanes of four f32, scaled for the regular cells of a grid.

use crate::springs::closed_form::{self, Group, Stiffness};
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
}

impl CoupledLanes {
    /// The lanes of a law whose stiffness at small strain is `stiffness` \[kPa·mm\].
    pub(super) fn new(law: &CoupledLaw, stiffness: f64) -> Self {
        Self { groups: law.closed_form(TRIANGLE_WEIGHT / stiffness) }
    }

    /// Layers by their Poisson ratio: most sheets have one, which has a [`Law`] of its own.
    pub(super) fn groups(&self) -> &[LaneGroup] {
        &self.groups
    }

    #[inline(always)]
    pub(super) fn stiffness(&self, i1: f32x4, s: f32x4) -> Stiffness<f32x4> {
        closed_form::stiffness(&self.groups, i1, s)
    }
}

/// The tension of four triangles.
pub(super) trait Law {
    /// P and Q of triangles with the invariants I₁, s > 0 and t; `spread` returns (λ₁² − λ₂²)².
    fn tension(&self, i1: f32x4, s: f32x4, t: f32x4, spread: impl Fn() -> f32x4) -> (f32x4, f32x4);
}

impl Law for LaneGroup {
    #[inline(always)]
    fn tension(&self, i1: f32x4, s: f32x4, t: f32x4, spread: impl Fn() -> f32x4) -> (f32x4, f32x4) {
        Group::tension(self, i1, s, t, spread)
    }
}

impl Law for [LaneGroup] {
    #[inline(always)]
    fn tension(&self, i1: f32x4, s: f32x4, t: f32x4, spread: impl Fn() -> f32x4) -> (f32x4, f32x4) {
        closed_form::tension(self, i1, s, t, spread)
    }
}

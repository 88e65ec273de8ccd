//! The void of layered tissue: what of the pocket neither implant nor tissue fills.
//!
//! It is the volume between the inner face over the pocket and the wall (`mesh/enclosed.rs`) less the implant's over the wall. The part of the implant
//! that is beside the pocket, as one that yields may be in a tight pocket, lies under tissue that is not counted, and is not subtracted.

use super::{Problem, Solution, Tissue};
use crate::mesh::NodeKind;
use crate::mesh::enclosed::{self, pocket_weight};
use crate::mesh::part::Part;
use glam::DVec3;
use std::f64::consts::TAU;

/// Area of the corner at the implant's rim that a grid leaves open \[spacing²\]: between the nodes the tissue is straight.
const OPEN_CORNER: f64 = 0.25;

impl Problem {
    /// The least void \[mm³\] that the grid resolves: the corner all around the implant.
    pub(crate) fn least_void_mm3(&self) -> f64 {
        let around = TAU * self.obstacle.dome.reference_length();
        OPEN_CORNER * self.sheet().spacing_mm().powi(2) * around
    }

    /// The void \[mm³\] under an inner face with the positions `x` \[mm\], shape (nodes_per_side², ), by its nodes of a part.
    pub(super) fn void_mm3(&self, x: &[DVec3], part: Part) -> f64 {
        let (sheet, dome, pocket) = (self.sheet(), &self.obstacle.dome, self.patch.pocket());
        let (n, spacing) = (sheet.nodes_per_side(), sheet.spacing_mm());
        let wall = self.obstacle.wall.0.heights::<f64>();
        let mut volume = -dome.volume_over_wall();
        for k in part.nodes().filter(|&k| sheet.kinds()[k] == NodeKind::Free) {
            let at_rest = sheet.rest()[k];
            let weight = pocket_weight(pocket.beyond(at_rest.length(), at_rest.y), spacing);
            let place = x[k].truncate();
            let mut height = 0.0;
            if weight > 0.0 {
                height = weight * (x[k].z - wall.at(place.to_array()).height);
            }
            if weight < 1.0 {
                height += (1.0 - weight) * dome.height_over(place);
            }
            if height != 0.0 {
                let area: f64 = enclosed::area(k, n, |k| x[k].truncate().to_array());
                volume += part.multiplicity(k) * area * height;
            }
        }
        volume
    }
}

impl Solution {
    /// The void between tissue, implant and wall within the pocket \[mm³\]; `None` of a sheet.
    #[must_use]
    pub fn void_mm3(&self) -> Option<f64> {
        let problem = self.problem();
        let is_layered = problem.tissue == Tissue::Layered;
        is_layered.then(|| problem.void_mm3(self.inner(), self.part()))
    }
}

//! Dome and wall together: the complement of the admissible set.

use super::active_set::Reaction;
use super::{Dome, Wall};
use crate::mesh::Chest;
use glam::{DMat3, DVec3};

/// The obstacle of the tissue.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// The implant.
    pub dome: Dome,
    /// The chest wall.
    pub wall: Wall,
}

impl Obstacle {
    /// A dome on the flat wall.
    #[must_use]
    pub fn on_flat_wall(dome: Dome) -> Self {
        Self { dome, wall: Wall::default() }
    }

    /// The dome draped over a wall: its heights count from the wall.
    #[must_use]
    pub fn over(self, chest: Chest) -> Self {
        Self { dome: self.dome.over(chest.clone()), wall: Wall(chest) }
    }

    /// The nearest admissible point along simple paths: up to the wall, then out of the dome to the given
    /// gauge \[-\] or more.
    #[must_use]
    pub fn project(&self, point: DVec3, gauge: f64) -> DVec3 {
        let point = self.wall.project(point);
        if self.dome.gauge(point) < gauge { self.dome.project(point, gauge) } else { point }
    }

    /// Second derivative of the constraints under a node, times their reactions \[kPa·mm\]: the part of the Hessian
    /// that curved surfaces take away.
    pub(crate) fn curvature(&self, point: DVec3, reaction: &Reaction) -> DMat3 {
        self.dome.contact_curvature(point) * reaction.per_gradient
            + self.wall.curvature(point) * reaction.by_wall
    }

    /// Is the obstacle its own image mirrored along x, along y, about the pocket's centre?
    #[must_use]
    pub fn mirrored(&self) -> [bool; 2] {
        let (dome, wall) = (self.dome.mirrored(), self.wall.mirrored());
        [0, 1].map(|axis| dome[axis] && wall[axis])
    }

    /// The obstacle in other units of length.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { dome: self.dome.scaled(factor), wall: self.wall.scaled(factor) }
    }
}

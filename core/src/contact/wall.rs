//! The chest wall, on which the tissue rests beside the implant.
//!
//! A node's gap to the wall is positive above the wall. A wall of another shape is another variant: its
//! gap and normal at a point, and the projection onto its surface.

use crate::mesh::vec3::Vec3;
use glam::{DMat3, DVec3};
use wide::f32x4;

/// A chest wall.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Wall {
    /// The plane z = 0.
    #[default]
    Plane,
}

impl Wall {
    /// Distance of a point from the wall \[mm\], negative below the wall.
    #[inline]
    #[must_use]
    pub fn gap(self, point: DVec3) -> f64 {
        match self {
            Self::Plane => point.z,
        }
    }

    /// The wall's unit normal at the foot of a point.
    #[inline]
    #[must_use]
    pub fn normal(self, _point: DVec3) -> DVec3 {
        match self {
            Self::Plane => DVec3::Z,
        }
    }

    /// The nearest point on or above the wall.
    #[inline]
    #[must_use]
    pub fn project(self, point: DVec3) -> DVec3 {
        match self {
            Self::Plane => DVec3::new(point.x, point.y, point.z.max(0.0)),
        }
    }

    /// Second derivative of the gap \[1/mm\].
    #[inline]
    #[must_use]
    pub fn curvature(self, _point: DVec3) -> DMat3 {
        match self {
            Self::Plane => DMat3::ZERO,
        }
    }

    /// Is the wall its own image mirrored along x, along y, about the pocket's centre?
    #[must_use]
    pub fn mirrored(self) -> [bool; 2] {
        match self {
            Self::Plane => [true; 2],
        }
    }

    /// The wall in other units of length.
    #[must_use]
    pub fn scaled(self, _factor: f64) -> Self {
        match self {
            Self::Plane => Self::Plane,
        }
    }

    /// The step from a point above the wall, shortened along the normal where the step would pass the wall.
    #[inline]
    #[must_use]
    pub(crate) fn limited_step(self, point: DVec3, step: DVec3) -> DVec3 {
        match self {
            Self::Plane => DVec3::new(step.x, step.y, step.z.max(-point.z)),
        }
    }

    /// The displacements of four nodes at the positions `rest` on the plane z = 0, on or above the wall. The wall is
    /// in the units of the grid.
    #[inline(always)]
    pub(crate) fn projected(self, _rest: [f32x4; 2], [x, y, z]: Vec3) -> Vec3 {
        match self {
            Self::Plane => [x, y, z.fast_max(f32x4::ZERO)],
        }
    }

    /// The forces on four nodes minus the reaction of the wall.
    #[inline(always)]
    pub(crate) fn unsupported(
        self,
        _rest: [f32x4; 2],
        displacement: Vec3,
        [x, y, z]: Vec3,
    ) -> Vec3 {
        match self {
            Self::Plane => {
                let zero = f32x4::ZERO;
                let is_pressing = displacement[2].simd_le(zero) & z.simd_lt(zero);
                [x, y, is_pressing.bitselect(zero, z)]
            }
        }
    }
}

//! The chest wall, on which the tissue rests beside the implant.
//!
//! A node's gap to the wall is positive above the wall. A wall of another shape is another variant: its
//! gap and normal at a point, and the projection onto its surface.

use crate::mesh::vec3::Vec3;
use glam::DVec3;
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

    /// The step from a point above the wall, shortened along the normal where the step would pass the wall.
    #[inline]
    #[must_use]
    pub(crate) fn limited_step(self, point: DVec3, step: DVec3) -> DVec3 {
        match self {
            Self::Plane => DVec3::new(step.x, step.y, step.z.max(-point.z)),
        }
    }

    /// The displacements of four nodes that rest on the plane z = 0, on or above the wall.
    #[inline(always)]
    pub(crate) fn projected(self, [x, y, z]: Vec3) -> Vec3 {
        match self {
            Self::Plane => [x, y, z.fast_max(f32x4::ZERO)],
        }
    }

    /// The forces on four nodes, without the normal part where a node presses on the wall.
    #[inline(always)]
    pub(crate) fn unsupported(self, displacement: Vec3, [x, y, z]: Vec3) -> Vec3 {
        match self {
            Self::Plane => {
                let zero = f32x4::ZERO;
                let is_pressing = displacement[2].simd_le(zero) & z.simd_lt(zero);
                [x, y, is_pressing.bitselect(zero, z)]
            }
        }
    }
}

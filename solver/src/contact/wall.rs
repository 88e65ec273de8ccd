//! The chest wall, on which the tissue rests beside the implant.
//!
//! A node's gap to the wall is positive above the wall: to first order its distance, exactly zero on the wall.

use crate::mesh::Chest;
use crate::mesh::height_field::{Ground, HeightField};
use crate::mesh::vec3::{Vec3, dot, scale, sub};
use glam::{DMat3, DVec3};
use wide::f32x4;

/// Height above a curved wall within which a node touches it, a hundred roundings of a coordinate \[grid spacings\].
const TOUCH_SPACINGS: f32 = 3e-4;

/// A chest wall.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wall(
    /// Its shape.
    pub Chest,
);

impl Wall {
    /// Distance of a point from the wall \[mm\], negative below the wall.
    #[inline]
    #[must_use]
    pub fn gap(&self, point: DVec3) -> f64 {
        match &self.0 {
            Chest::Flat => point.z,
            chest => (point.z - chest.height(point.truncate())) * self.normal(point).z,
        }
    }

    /// The wall's outer unit normal below a point.
    #[inline]
    #[must_use]
    pub fn normal(&self, point: DVec3) -> DVec3 {
        match &self.0 {
            Chest::Flat => DVec3::Z,
            chest => (-chest.slope(point.truncate())).extend(1.0).normalize(),
        }
    }

    /// The point, lifted onto the wall from below.
    #[inline]
    #[must_use]
    pub fn project(&self, point: DVec3) -> DVec3 {
        point.with_z(point.z.max(self.0.height(point.truncate())))
    }

    /// Second derivative of the gap at a point of the wall along the wall \[1/mm\].
    #[inline]
    #[must_use]
    pub fn curvature(&self, point: DVec3) -> DMat3 {
        match &self.0 {
            Chest::Flat => DMat3::ZERO,
            chest => {
                let [xx, xy, yy] = chest.heights::<f64>().curvature([point.x, point.y]);
                let columns = [[xx, xy, 0.0], [xy, yy, 0.0], [0.0; 3]];
                DMat3::from_cols_array_2d(&columns) * -self.normal(point).z
            }
        }
    }

    /// Is the wall its own image mirrored along x, along y, about the pocket's centre?
    #[must_use]
    pub fn mirrored(&self) -> [bool; 2] {
        self.0.mirrored()
    }

    /// The wall in other units of length.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self(self.0.scaled(factor))
    }

    /// The step from a point above the wall, lifted onto the wall where the step would pass the wall.
    #[inline]
    #[must_use]
    pub(crate) fn limited_step(&self, point: DVec3, step: DVec3) -> DVec3 {
        match &self.0 {
            Chest::Flat => DVec3::new(step.x, step.y, step.z.max(-point.z)),
            _ => self.project(point + step) - point,
        }
    }
}

/// The displacements of four nodes at `rest`, lifted onto the wall from below. The wall is in the units of the grid.
#[inline(always)]
pub(super) fn projected(wall: &HeightField<f32x4>, rest: Vec3, [x, y, z]: Vec3) -> Vec3 {
    if wall.is_flat() {
        return [x, y, z.fast_max(f32x4::ZERO)];
    }
    let least = wall.at([rest[0] + x, rest[1] + y]).height - rest[2];
    [x, y, z.fast_max(least)]
}

/// The step of four nodes at a height above a curved wall, kept above it: `compliance` is the move per force on the nodes.
#[inline(always)]
pub(super) fn limited(
    ground: &Ground<f32x4>,
    height: f32x4,
    step: Vec3,
    compliance: impl Fn(Vec3) -> Vec3,
) -> Vec3 {
    let normal = upwards(ground);
    let after = height - ground.height + dot(normal, step);
    let is_below = after.simd_lt(f32x4::ZERO);
    if !is_below.any() {
        return step;
    }
    let along = compliance(normal);
    let back = after / dot(normal, along).fast_max(f32x4::splat(1e-30));
    sub(step, scale(along, is_below.bitselect(back, f32x4::ZERO)))
}

/// The displacements of four nodes from the plane, kept above it but for their heights: see [`limited`].
#[inline(always)]
pub(super) fn limited_by_plane([x, y, z]: Vec3, compliance: impl Fn(Vec3) -> Vec3) -> Vec3 {
    let is_below = z.simd_lt(f32x4::ZERO);
    if !is_below.any() {
        return [x, y, z];
    }
    let along = compliance([f32x4::ZERO, f32x4::ZERO, f32x4::ONE]);
    let back = is_below.bitselect(z / along[2].fast_max(f32x4::splat(1e-30)), f32x4::ZERO);
    [x - along[0] * back, y - along[1] * back, z]
}

/// A normal of the ground, of unit height.
#[inline(always)]
fn upwards(ground: &Ground<f32x4>) -> Vec3 {
    let [slope_x, slope_y] = ground.slope;
    [-slope_x, -slope_y, f32x4::ONE]
}

/// The forces on four nodes at a height minus the reaction of the wall, of which the ground below them is known unless it is the
/// plane. `free` is the part of a vector in the directions that the dome leaves free.
#[inline(always)]
pub(super) fn unsupported(
    ground: Option<&Ground<f32x4>>,
    height: f32x4,
    force: Vec3,
    free: impl Fn(Vec3) -> Vec3,
) -> Vec3 {
    let zero = f32x4::ZERO;
    let Some(ground) = ground else {
        let [x, y, z] = force;
        let is_pressing = height.simd_le(zero) & z.simd_lt(zero);
        return [x, y, is_pressing.bitselect(zero, z)];
    };
    let normal = free(upwards(ground));
    let pressing = dot(force, normal);
    let touching = ground.height + f32x4::splat(TOUCH_SPACINGS);
    let is_pressing = height.simd_le(touching) & pressing.simd_lt(zero);
    let reaction = is_pressing.bitselect(pressing / dot(normal, normal), zero);
    sub(force, scale(normal, reaction))
}

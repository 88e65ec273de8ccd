//! What a shape is, from the centre of its base: x across, y along the body, z up from the base.

use crate::mesh::vec3::Block;
use crate::number::Real;
use glam::{DMat3, DVec2, DVec3};
use std::fmt::Debug;

/// The gauge of a shape, for one point in f64 or for four in f32, in any unit of length: negative inside, zero on the surface. A length is the
/// gauge plus one.
pub(crate) trait Gauge<R: Real> {
    /// The length at a position, squared: the gauge without a root.
    fn length_squared(&self, at: [R; 3]) -> R;

    /// The length at a position and its gradient, zero at the centre.
    fn length(&self, at: [R; 3]) -> (R, [R; 3]);

    /// Second derivative of the length at a position of this length and gradient. Where it grows without limit towards the base, it is
    /// that at a least height \[projection\].
    fn curvature(&self, at: [R; 3], length: R, gradient: [R; 3], least: f64) -> Block<R>;

    /// The multiple of a direction, near the gradient, that leads from a position to a length.
    fn distance_along(&self, at: [R; 3], direction: [R; 3], length: R) -> R;

    /// The way from a position, not below the base, of a length to another one: along the ray from the centre or along the axis,
    /// whichever is shorter. On a flat shape the ray leads far aside.
    fn way_to(&self, at: [R; 3], length: R, to: R) -> [R; 3];
}

/// Sizes of a shape, lines on its surface and bounds. Lengths in mm; the surface has a parameter θ from 0 at the apex, with heights projection × cos θ.
pub trait Geometry: Debug {
    /// Half of the base's width and of its height, and the projection \[mm\].
    fn half_axes(&self) -> DVec3;

    /// The length that tolerances and errors are relative to \[mm\]: half of the base's width at rest.
    fn reference_length(&self) -> f64 {
        self.half_axes().x
    }

    /// Volume \[mm³\].
    fn volume(&self) -> f64;

    /// The apex \[mm\].
    fn apex(&self) -> DVec3 {
        self.axis(self.half_axes().z).extend(self.half_axes().z)
    }

    /// Place of the axis, from the middle of the base to the apex, at a height \[mm\].
    fn axis(&self, _height: f64) -> DVec2 {
        DVec2::ZERO
    }

    /// Is it a solid of revolution?
    fn is_round(&self) -> bool;

    /// Is it its own image mirrored along x, along y?
    fn mirrored(&self) -> [bool; 2];

    /// The linear map onto the unit ball; `None` of a shape that is no half of an ellipsoid.
    fn onto_ball(&self) -> Option<DMat3> {
        None
    }

    /// Height of the highest point \[mm\].
    fn top(&self) -> f64 {
        self.half_axes().z
    }

    /// From the axis to the surface at a parameter θ \[mm\], in a direction of the image of a circle.
    fn reach(&self, angle: f64, direction: DVec2) -> DVec2;

    /// A point of the surface \[mm\] on a line from the apex, θ = 0, to the base.
    fn point(&self, angle: f64, direction: DVec2) -> DVec3 {
        let height = self.half_axes().z * angle.cos();
        (self.axis(height) + self.reach(angle, direction)).extend(height)
    }

    /// The parameter at which the line of [`Self::point`] is at a height \[mm\].
    fn angle_at(&self, height: f64, _direction: DVec2) -> f64 {
        (height / self.half_axes().z).clamp(0.0, 1.0).acos()
    }

    /// Half of the width and of the height of the section at a parameter θ \[mm\].
    fn half_widths(&self, angle: f64) -> DVec2 {
        DVec2::new(self.reach(angle, DVec2::X).x, self.reach(angle, DVec2::Y).y)
    }

    /// A length \[mm\]: a point outside, not above the apex, is no closer than this length times its gauge.
    fn least_length(&self) -> f64;

    /// A length \[mm\]: no point of the surface moves further than 1.01 times this length times a change of the gauge.
    fn greatest_length(&self) -> f64;

    /// May the gauge of a point above the apex grow faster than its distance?
    fn outgrows_distance(&self) -> bool {
        true
    }

    /// Least radius of curvature at the apex \[mm\].
    fn apex_radius(&self) -> f64;

    /// Least radius of curvature at the base of the sections along and across the body \[mm\].
    fn rim_radius(&self) -> f64;
}

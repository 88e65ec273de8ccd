//! The frame of a breast: where a scene lies on a body.

use crate::marks::Side;
use glam::{DMat3, DVec3};

/// A frame: x from the midline to the patient's side, y to the head, z outwards along the chest's normal. The frame of a right breast
/// is left-handed, so that its numbers are those of a left one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The origin \[mm\].
    pub origin: DVec3,
    /// Unit vectors x, y and z as columns.
    pub axes: DMat3,
}

impl Frame {
    /// The frame at a point with z along `outwards`, y towards `head` without its part along z; `None` where both are parallel.
    #[must_use]
    pub fn new(origin: DVec3, outwards: DVec3, head: DVec3, side: Side) -> Option<Self> {
        let z = outwards.try_normalize()?;
        let y = head.reject_from_normalized(z).try_normalize()?;
        Some(Self { origin, axes: DMat3::from_cols(y.cross(z) * side.sign(), y, z) })
    }

    /// Coordinates of a point in the frame.
    #[inline]
    #[must_use]
    pub fn local(&self, point: DVec3) -> DVec3 {
        self.axes.transpose() * (point - self.origin)
    }

    /// A direction of the frame in the surface's coordinates.
    #[inline]
    #[must_use]
    pub fn direction(&self, local: DVec3) -> DVec3 {
        self.axes * local
    }

    /// The point of the surface's coordinates at a place of the frame.
    #[inline]
    #[must_use]
    pub fn point(&self, local: DVec3) -> DVec3 {
        self.origin + self.axes * local
    }

    /// +1 for a right-handed frame, −1 for the mirrored one of a right breast.
    #[must_use]
    pub fn handedness(&self) -> f64 {
        self.axes.determinant().signum()
    }

    /// The frame moved along its z \[mm\].
    #[must_use]
    pub fn raised(&self, by_mm: f64) -> Self {
        Self { origin: self.point(DVec3::new(0.0, 0.0, by_mm)), ..*self }
    }
}

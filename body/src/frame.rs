//! The frame of a breast, where a scene lies on a body, and that of a whole body.

use crate::marks::{BodyAxes, Marks, MarksError, Side};
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

    /// The frame of a whole body by its marks: x to the patient's left, y to the head, z forwards; the origin in the midplane (through the notch, at right angles to
    /// x), at the level of the nipples' middle. A body after an operation is measured in the frame of its marks before: marks that move with
    /// the skin would tilt it.
    ///
    /// # Errors
    /// Marks at one place.
    pub fn of_body(marks: &Marks) -> Result<Self, MarksError> {
        let BodyAxes { across, head, front } = marks.axes()?;
        let middle = 0.5 * (marks.nipples[0] + marks.nipples[1]);
        let origin = middle - across * (middle - marks.sternal_notch).dot(across);
        Ok(Self { origin, axes: DMat3::from_cols(across, head, front) })
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
        Self { origin: self.point(DVec3::Z * by_mm), ..*self }
    }

    /// The frame moved along its x \[mm\].
    #[must_use]
    pub(crate) fn moved_across(&self, by_mm: f64) -> Self {
        Self { origin: self.point(DVec3::X * by_mm), ..*self }
    }
}

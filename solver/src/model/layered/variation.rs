//! What varies inside of a cell: the mean square of its displacement's modes beyond the gradient in the middle.

use super::deformed::Matrix;
use super::modes::Modes;
use super::sides::Oblique;
use crate::mesh::vec3::{dot, scale};
use crate::number::Real;

/// Weights of |b₁₂|², |b₁₃|² and |b₂₃|², |d|² in the mean square of what varies inside of a cell.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Variation<R> {
    pub(crate) in_plane: R,
    pub(crate) through: R,
    pub(crate) d: R,
}

impl<R: Real> Variation<R> {
    pub(crate) fn new(slope: f64) -> Self {
        let squared = slope * slope;
        Self {
            in_plane: R::splat(2.0 / 12.0),
            through: R::splat((1.0 + squared) / 12.0),
            d: R::splat((2.0 + squared) / 144.0),
        }
    }

    /// Of the sides of a cell at rest, a mean of the twists through the thickness.
    #[inline(always)]
    pub(super) fn of_sides(Oblique(columns): &Oblique<R>) -> Self {
        let [xi, eta, zeta] =
            [0, 1, 2].map(|k| columns.iter().fold(R::default(), |sum, c| sum + c[k] * c[k]));
        let in_plane = xi + eta;
        Self {
            in_plane: in_plane * R::splat(1.0 / 12.0),
            through: (in_plane * R::splat(0.5) + zeta) * R::splat(1.0 / 12.0),
            d: (in_plane + zeta) * R::splat(1.0 / 144.0),
        }
    }

    /// The weights times a number.
    #[inline(always)]
    pub(super) fn weighted(&self, weight: R) -> Self {
        Self {
            in_plane: self.in_plane * weight,
            through: self.through * weight,
            d: self.d * weight,
        }
    }

    /// Half of the derivatives of [`Self::mean_square`] by the modes; those by the linear modes are zero.
    #[inline(always)]
    pub(super) fn slopes(&self, modes: &Modes<R>) -> Modes<R> {
        let [xy, xz, yz] = modes.twist;
        Modes {
            linear: Matrix::default(),
            twist: [scale(xy, self.in_plane), scale(xz, self.through), scale(yz, self.through)],
            d: scale(modes.d, self.d),
        }
    }

    #[inline(always)]
    pub(crate) fn mean_square(&self, modes: &Modes<R>) -> R {
        let [xy, xz, yz] = modes.twist.map(|b| dot(b, b));
        xy * self.in_plane + (xz + yz) * self.through + dot(modes.d, modes.d) * self.d
    }
}

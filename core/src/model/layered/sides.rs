//! The sides of a cell at rest: how slopes along the sides become a deformation gradient.
//!
//! With the Jacobian 𝐉 = ∂X/∂(ξ, η, ζ) in the middle of the cell, slopes L along the sides are the displacement gradient L 𝐉⁻¹.

use super::law::{Matrix, combined};
use super::modes::Modes;
use crate::mesh::vec3::{dot, scale, sub};
use crate::number::Real;
use glam::{DMat3, DVec3};

/// The sides of a cell; lengths in spacings.
pub(crate) trait Sides<R: Real>: Copy {
    /// The deformation gradient of a displacement with slopes along the sides.
    fn gradient(&self, slopes: Matrix<R>) -> Matrix<R>;

    /// The transpose of [`Self::gradient`]: the stress along the sides.
    fn stress(&self, stress: Matrix<R>) -> Matrix<R>;
}

/// Sides along the axes: two of one spacing, the third of the cell's height.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Upright<R> {
    /// Spacing over height.
    pub(crate) slope: R,
}

/// Sides in any directions: 𝐉⁻¹ by columns, ∂(ξ, η, ζ)/∂X, ∂(ξ, η, ζ)/∂Y, ∂(ξ, η, ζ)/∂Z.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Oblique<R>(pub(crate) Matrix<R>);

impl<R: Real> Sides<R> for Upright<R> {
    #[inline(always)]
    fn gradient(&self, [x, y, z]: Matrix<R>) -> Matrix<R> {
        with_identity([x, y, scale(z, self.slope)])
    }

    #[inline(always)]
    fn stress(&self, [x, y, z]: Matrix<R>) -> Matrix<R> {
        [x, y, scale(z, self.slope)]
    }
}

impl<R: Real> Sides<R> for Oblique<R> {
    #[inline(always)]
    fn gradient(&self, slopes: Matrix<R>) -> Matrix<R> {
        with_identity(self.turned(slopes))
    }

    #[inline(always)]
    fn stress(&self, stress: Matrix<R>) -> Matrix<R> {
        let [a, b, c] = self.0;
        [0, 1, 2].map(|k| combined(stress, [a[k], b[k], c[k]]))
    }
}

impl<R: Real> Oblique<R> {
    /// The displacement gradient of slopes along the sides.
    #[inline(always)]
    pub(crate) fn turned(&self, slopes: Matrix<R>) -> Matrix<R> {
        self.0.map(|column| combined(slopes, column))
    }

    /// Two sides in the plane, with ∂ξ/∂X, ∂η/∂X, ∂ξ/∂Y, ∂η/∂Y, the third upright.
    #[inline(always)]
    pub(crate) fn in_plane([a, b, c, d]: [R; 4], slope: R) -> Self {
        let zero = R::default();
        Self([[a, b, zero], [c, d, zero], [zero, zero, slope]])
    }
}

/// I plus a displacement gradient.
#[inline(always)]
fn with_identity<R: Real>(mut columns: Matrix<R>) -> Matrix<R> {
    let one = R::splat(1.0);
    (0..3).for_each(|k| columns[k][k] += one);
    columns
}

/// What the sides of a cell at rest lack to a parallelepiped: its own modes b₁₂, b₁₃, b₂₃, d along its sides.
///
/// Of a displacement with the slopes L the twist of the deformed cell beyond that of the gradient alone is b − L·skew: without
/// this part a rotation of the cell would strain the cell.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Skew {
    twist: Matrix<f64>,
    d: [f64; 3],
}

impl Skew {
    /// The modes of a displacement without those of its gradient in the middle of the cell.
    pub(crate) fn removed(&self, modes: &Modes<f64>) -> Modes<f64> {
        let without = |b, skew| sub(b, combined(modes.linear, skew));
        let [p, q, r] = self.twist;
        let [xy, xz, yz] = modes.twist;
        Modes {
            linear: modes.linear,
            twist: [without(xy, p), without(xz, q), without(yz, r)],
            d: without(modes.d, self.d),
        }
    }

    /// The transpose of [`Self::removed`], for forces.
    pub(crate) fn handed_back(&self, forces: &Modes<f64>) -> Modes<f64> {
        let mut linear = forces.linear;
        let all = forces.twist.iter().zip(&self.twist).chain([(&forces.d, &self.d)]);
        for (force, skew) in all {
            for (to, part) in linear.iter_mut().zip(skew) {
                *to = sub(*to, scale(*force, *part));
            }
        }
        Modes { linear, ..*forces }
    }

    /// [`Self::removed`] of one component.
    pub(crate) fn removed_from(
        &self,
        linear: [f64; 3],
        twist: [f64; 3],
        d: f64,
    ) -> ([f64; 3], f64) {
        let [p, q, r] = self.twist.map(|skew| dot(linear, skew));
        (sub(twist, [p, q, r]), d - dot(linear, self.d))
    }
}

/// Sides, skew and volume \[spacings³\] of a cell with these modes of its positions at rest \[spacings\].
pub(crate) fn of_rest(rest: &Modes<f64>) -> (Oblique<f64>, Skew, f64) {
    let [x, y, z] = rest.linear.map(DVec3::from);
    let jacobian = DMat3::from_cols(x, y, z);
    let inverse = jacobian.inverse();
    let along = |b: [f64; 3]| (inverse * DVec3::from(b)).to_array();
    let skew = Skew { twist: rest.twist.map(along), d: along(rest.d) };
    (Oblique(inverse.to_cols_array_2d()), skew, jacobian.determinant())
}

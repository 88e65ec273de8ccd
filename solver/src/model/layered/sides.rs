//! The sides of a cell at rest: how slopes along the sides become a deformation gradient.
//!
//! With the Jacobian 𝐉 = ∂X/∂(ξ, η, ζ) in the middle of the cell, slopes L along the sides are the displacement gradient L 𝐉⁻¹.

use super::deformed::{Matrix, combined};
use super::modes::Modes;
use crate::mesh::vec3::{add, dot, scale, sub};
use crate::number::Real;
use glam::{DMat3, DVec3};

/// The sides of a cell; lengths in spacings.
pub(crate) trait Sides<R: Real>: Copy {
    /// The deformation gradient of a displacement with slopes along the sides.
    fn gradient(&self, slopes: Matrix<R>) -> Matrix<R>;

    /// The transpose of [`Self::gradient`]: the stress along the sides.
    fn stress(&self, stress: Matrix<R>) -> Matrix<R>;

    /// The gradient of a scalar with these slopes along the sides.
    fn of_scalar(&self, slopes: [R; 3]) -> [R; 3];
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

    #[inline(always)]
    fn of_scalar(&self, [x, y, z]: [R; 3]) -> [R; 3] {
        [x, y, z * self.slope]
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
        [
            combined(stress, [a[0], b[0], c[0]]),
            combined(stress, [a[1], b[1], c[1]]),
            combined(stress, [a[2], b[2], c[2]]),
        ]
    }

    #[inline(always)]
    fn of_scalar(&self, slopes: [R; 3]) -> [R; 3] {
        let [a, b, c] = self.0;
        [dot(a, slopes), dot(b, slopes), dot(c, slopes)]
    }
}

impl<R: Real> Oblique<R> {
    /// The displacement gradient of slopes along the sides.
    #[inline(always)]
    pub(crate) fn turned(&self, slopes: Matrix<R>) -> Matrix<R> {
        let [a, b, c] = self.0;
        [combined(slopes, a), combined(slopes, b), combined(slopes, c)]
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
pub(super) fn with_identity<R: Real>(mut columns: Matrix<R>) -> Matrix<R> {
    let one = R::splat(1.0);
    (0..3).for_each(|k| columns[k][k] += one);
    columns
}

/// What the sides of a cell at rest lack to a parallelepiped: the vectors b₁₂, b₁₃, b₂₃, d of its own modes \[spacings\].
///
/// Of a displacement with the gradient H in the middle of the cell the twist of the deformed cell beyond that of the gradient
/// alone is b − H·skew: without this part a rotation of the cell would strain the cell.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Skew<R> {
    pub(crate) twist: Matrix<R>,
    pub(crate) d: [R; 3],
}

impl<R: Real> Skew<R> {
    /// The modes of a displacement without those of its gradient H in the middle of the cell.
    #[inline(always)]
    pub(super) fn removed(&self, gradient: Matrix<R>, modes: &Modes<R>) -> Modes<R> {
        let ([p, q, r], [xy, xz, yz]) = (self.twist, modes.twist);
        Modes {
            linear: modes.linear,
            twist: [
                sub(xy, combined(gradient, p)),
                sub(xz, combined(gradient, q)),
                sub(yz, combined(gradient, r)),
            ],
            d: sub(modes.d, combined(gradient, self.d)),
        }
    }

    /// The transpose of [`Self::removed`]: what forces on the modes without skew take from the stress.
    #[inline(always)]
    pub(super) fn stress(&self, forces: &Modes<R>) -> Matrix<R> {
        let ([p, q, r], d) = (self.twist, self.d);
        let [xy, xz, yz] = forces.twist;
        let column = |p, q, r, d| {
            add(add(scale(xy, p), scale(xz, q)), add(scale(yz, r), scale(forces.d, d)))
        };
        [
            column(p[0], q[0], r[0], d[0]),
            column(p[1], q[1], r[1], d[1]),
            column(p[2], q[2], r[2], d[2]),
        ]
    }

    /// [`Self::removed`] of one component.
    pub(crate) fn removed_from(
        &self,
        sides: &Oblique<R>,
        linear: [R; 3],
        twist: [R; 3],
        d: R,
    ) -> ([R; 3], R) {
        let gradient = sides.0.map(|column| dot(linear, column));
        (sub(twist, self.twist.map(|skew| dot(gradient, skew))), d - dot(gradient, self.d))
    }
}

/// Sides, skew and volume \[spacings³\] of a cell with these modes of its positions at rest \[spacings\].
pub(crate) fn of_rest(rest: &Modes<f64>) -> (Oblique<f64>, Skew<f64>, f64) {
    let [x, y, z] = rest.linear.map(DVec3::from);
    let jacobian = DMat3::from_cols(x, y, z);
    let skew = Skew { twist: rest.twist, d: rest.d };
    (Oblique(jacobian.inverse().to_cols_array_2d()), skew, jacobian.determinant())
}

//! The displacement modes of a cell of eight nodes, from and to its two faces.
//!
//! The displacement of a cell on \[−½, ½\]³ is u = b₀ + b₁ξ + b₂η + b₃ζ + b₁₂ξη + b₁₃ξζ + b₂₃ηζ + dξηζ.

use super::deformed::Matrix;
use crate::mesh::vec3::{add, scale, sub};
use crate::number::Real;

/// The coefficients of a cell's displacement without the mean, or the forces on the coefficients.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Modes<R> {
    /// b₁, b₂, b₃.
    pub(crate) linear: Matrix<R>,
    /// b₁₂, b₁₃, b₂₃.
    pub(crate) twist: Matrix<R>,
    pub(crate) d: [R; 3],
}

/// The sums of a vector over the corners of a face, with the signs 1, ξ, η, ξη.
#[derive(Clone, Copy, Default)]
pub(super) struct Corners<R> {
    pub(super) sum: [R; 3],
    pub(super) x: [R; 3],
    pub(super) y: [R; 3],
    pub(super) xy: [R; 3],
}

impl<R: Real> Corners<R> {
    /// From the corners, counter-clockwise from the least x and y.
    #[inline(always)]
    pub(super) fn new([a, b, c, d]: [[R; 3]; 4]) -> Self {
        let (bottom, top) = (add(a, b), add(d, c));
        let (right, left) = (sub(b, a), sub(c, d));
        Self {
            sum: add(bottom, top),
            x: add(right, left),
            y: sub(top, bottom),
            xy: sub(left, right),
        }
    }

    /// The vectors at the corners whose products with displacements are those of the sums.
    #[inline(always)]
    pub(super) fn spread(&self) -> [[R; 3]; 4] {
        let Self { sum, x, y, xy } = *self;
        let (low, high) = (sub(sum, y), add(sum, y));
        let (minus, plus) = (sub(x, xy), add(x, xy));
        [sub(low, minus), add(low, minus), add(high, plus), sub(high, plus)]
    }

    #[inline(always)]
    pub(super) fn add(&mut self, other: &Self) {
        self.sum = add(self.sum, other.sum);
        self.x = add(self.x, other.x);
        self.y = add(self.y, other.y);
        self.xy = add(self.xy, other.xy);
    }
}

/// The modes of a cell between two faces.
#[inline(always)]
pub(super) fn modes<R: Real>(inner: &Corners<R>, outer: &Corners<R>) -> Modes<R> {
    let (quarter, half) = (R::splat(0.25), R::splat(0.5));
    Modes {
        linear: [
            scale(add(inner.x, outer.x), quarter),
            scale(add(inner.y, outer.y), quarter),
            scale(sub(outer.sum, inner.sum), quarter),
        ],
        twist: [
            scale(add(inner.xy, outer.xy), half),
            scale(sub(outer.x, inner.x), half),
            scale(sub(outer.y, inner.y), half),
        ],
        d: sub(outer.xy, inner.xy),
    }
}

/// What forces on the modes are on the two faces.
#[inline(always)]
pub(super) fn on_faces<R: Real>(f: &Modes<R>) -> [Corners<R>; 2] {
    let (quarter, half) = (R::splat(0.25), R::splat(0.5));
    let [x, y, z] = f.linear.map(|v| scale(v, quarter));
    let [xy, xz, yz] = f.twist.map(|v| scale(v, half));
    [
        Corners { sum: z.map(|z| -z), x: sub(x, xz), y: sub(y, yz), xy: sub(xy, f.d) },
        Corners { sum: z, x: add(x, xz), y: add(y, yz), xy: add(xy, f.d) },
    ]
}

impl<R: Real> Modes<R> {
    /// The modes times a number.
    #[inline(always)]
    pub(super) fn weighted(&self, weight: R) -> Self {
        Self {
            linear: self.linear.map(|v| scale(v, weight)),
            twist: self.twist.map(|v| scale(v, weight)),
            d: scale(self.d, weight),
        }
    }
}

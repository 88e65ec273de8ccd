//! Vectors and symmetric 3×3 blocks of one node, or of four neighbouring ones.

use crate::number::Real;
use wide::f32x4;

/// Vectors of four nodes.
pub(crate) type Vec3 = [f32x4; 3];

#[inline(always)]
pub(crate) fn dot<R: Real>(a: [R; 3], b: [R; 3]) -> R {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn sub<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(crate) fn add<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(crate) fn scale<R: Real>(a: [R; 3], s: R) -> [R; 3] {
    [a[0] * s, a[1] * s, a[2] * s]
}

#[inline(always)]
pub(crate) fn cross<R: Real>(a: [R; 3], b: [R; 3]) -> [R; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A symmetric 3×3 block: xx, xy, xz, yy, yz, zz.
pub(crate) type Block<R = f32x4> = [R; 6];

#[inline(always)]
pub(crate) fn add_outer<R: Real>(block: &mut Block<R>, a: [R; 3], b: [R; 3]) {
    block[0] += a[0] * b[0];
    block[1] += a[0] * b[1];
    block[2] += a[0] * b[2];
    block[3] += a[1] * b[1];
    block[4] += a[1] * b[2];
    block[5] += a[2] * b[2];
}

/// The product of a block and a vector.
#[inline(always)]
pub(crate) fn times<R: Real>([xx, xy, xz, yy, yz, zz]: Block<R>, v: [R; 3]) -> [R; 3] {
    [
        xx * v[0] + xy * v[1] + xz * v[2],
        xy * v[0] + yy * v[1] + yz * v[2],
        xz * v[0] + yz * v[1] + zz * v[2],
    ]
}

/// Determinant of a block that f32 resolves \[cube of the trace\].
const MIN_DETERMINANT: f32 = 1e-8;

/// The inverse; for an indefinite block the inverse of trace × identity.
#[inline(always)]
pub(crate) fn inverted([xx, xy, xz, yy, yz, zz]: Block) -> Block {
    let (axx, axy, axz) = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
    let (ayy, ayz, azz) = (xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy);
    let det = xx * axx + xy * axy + xz * axz;
    let trace = xx + yy + zz;
    let least = trace * trace * trace * MIN_DETERMINANT;
    let is_positive = det.simd_gt(least) & azz.simd_gt(f32x4::ZERO) & xx.simd_gt(f32x4::ZERO);
    let per_det = f32x4::ONE / det;
    let per_trace = f32x4::ONE / trace.fast_max(f32x4::splat(1e-20));
    let pick = |inverse: f32x4, other: f32x4| is_positive.bitselect(inverse * per_det, other);
    let zero = f32x4::ZERO;
    [
        pick(axx, per_trace),
        pick(axy, zero),
        pick(axz, zero),
        pick(ayy, per_trace),
        pick(ayz, zero),
        pick(azz, per_trace),
    ]
}

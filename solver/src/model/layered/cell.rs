//! A cell of eight nodes: energy and forces of its displacement modes.
//!
//! Lateral lengths are in spacings; [`Sides`] turns slopes along the sides into a gradient.
//!
//! ln J is one number of the cell: cells do not lock. Two rules of integration:
//!
//! * [`center`]: one point, J in the middle; what varies inside of the cell adds its mean square to g.
//! * [`four_points`]: four of the eight Gauss points, of alternating parity from cell to cell, J their mean. Accurate where a
//!   softening tissue concentrates strain; 2.3 times the work.

use super::deformed::{Deformed, Matrix};
use super::modes::Modes;
use super::shape::RestShape;
use super::sides::Sides;
use super::variation::Variation;
use crate::mesh::vec3::{add, scale};
use crate::number::Real;
use crate::springs::solids::{LEAST_VOLUME, Slopes, SolidLaw, Volume, WholeLaw};

/// Gauss point of two in one dimension, on \[−½, ½\].
const POINT: f64 = 0.288_675_134_594_812_9;

/// J in the middle of a cell.
#[inline(always)]
pub(super) fn volume<R: Real>(modes: &Modes<R>, sides: &impl Sides<R>) -> R {
    Deformed::new(sides.gradient(modes.linear)).volume
}

/// The derivatives of the energy by the modes, by the rule of one point, per volume of an even cell; `augmented` is p of
/// [`SolidLaw`].
#[inline(always)]
pub(super) fn center<R: Real>(
    law: &impl SolidLaw<R>,
    modes: &Modes<R>,
    rest: &impl RestShape<R>,
    augmented: R,
) -> Modes<R> {
    let (gradient, modes) = rest.deformed(modes);
    let deformed = Deformed::new(gradient);
    let shape = deformed.isochoric();
    let g = shape.g + rest.variation().mean_square(&modes);
    let Slopes { shear: [shear], pressure } = law.slopes([g], deformed.volume(), augmented);
    let (shear, pressure) = (shear * rest.weight(), pressure * rest.weight());
    let inside = rest.variation().weighted(shear).slopes(&modes);
    rest.forces(deformed.stress(&shape, shear, pressure), inside)
}

/// The deformation gradients at the four points of a parity, ±1.
#[inline(always)]
pub(super) fn at_points<R: Real>(
    modes: &Modes<R>,
    sides: &impl Sides<R>,
    parity: R,
) -> [Matrix<R>; 4] {
    let (point, square) = (R::splat(POINT), R::splat(POINT * POINT) * parity);
    let [xy, xz, yz] = modes.twist.map(|twist| scale(twist, point));
    // The product of the three signs is the parity: ηζ has the sign parity·sx.
    let d = scale(modes.d, square);
    let center = sides.gradient(modes.linear);
    let by_x = sides.turned([d, xy, xz]);
    let by_y = sides.turned([xy, d, yz]);
    let by_xy = sides.turned([xz, yz, d]);
    let mut points = [center; 4];
    for (c, r) in (0..9).map(|k| (k / 3, k % 3)) {
        let parts = [center[c][r], by_x[c][r], by_y[c][r], by_xy[c][r] * parity];
        for (point, value) in points.iter_mut().zip(at_signs(parts)) {
            point[c][r] = value;
        }
    }
    points
}

/// The deformation at a point, and the point's coordinates.
pub(super) type Placed<R> = (Deformed<R>, [R; 3]);

/// The deformation at the four points of a parity, and the mean of J.
#[inline(always)]
pub(super) fn deformed_points<R: Real>(
    modes: &Modes<R>,
    sides: &impl Sides<R>,
    parity: R,
) -> ([Placed<R>; 4], R) {
    let points = at_points(modes, sides, parity).map(Deformed::new);
    let volume = mean_volume(&points);
    let mut signs = SIGNS.into_iter();
    let with_place = points.map(|point| {
        let [sx, sy] = signs.next().unwrap_or_default();
        let at = [R::splat(POINT * sx), R::splat(POINT * sy), R::splat(POINT * sx * sy) * parity];
        (point, at)
    });
    (with_place, volume)
}

/// ξ and η of the four points over [`POINT`].
const SIGNS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];

/// The values at the four points of parts times 1 and the signs ξ, η and ξη.
#[inline(always)]
fn at_signs<R: Real>([all, x, y, xy]: [R; 4]) -> [R; 4] {
    let (lower, upper, left, right) = (all - y, all + y, x - xy, x + xy);
    [lower - left, lower + left, upper - right, upper + right]
}

/// The sums of the values at the four points, and of those times the signs ξ, η and ξη: the transpose of [`at_signs`].
#[inline(always)]
fn sums_of_signs<R: Real>([a, b, c, d]: [R; 4]) -> [R; 4] {
    let (lower, upper, below, above) = (a + b, c + d, b - a, d - c);
    [lower + upper, below + above, upper - lower, above - below]
}

/// The derivatives of the energy per rest volume by the modes, by the rule of four points.
#[inline(always)]
pub(crate) fn four_points<R: Real>(
    law: &impl SolidLaw<R>,
    modes: &Modes<R>,
    sides: &impl Sides<R>,
    parity: R,
    augmented: R,
) -> Modes<R> {
    let [a, b, c, d] = at_points(modes, sides, parity);
    let points = [Deformed::new(a), Deformed::new(b), Deformed::new(c), Deformed::new(d)];
    let volume = mean_volume(&points);
    let [a, b, c, d] = &points;
    let shapes = [a.isochoric(), b.isochoric(), c.isochoric(), d.isochoric()];
    let [a, b, c, d] = &shapes;
    let g = [a.g, b.g, c.g, d.g];
    let Slopes { shear, pressure } = law.slopes(g, Volume::new(volume), augmented);
    let mut sums = [Matrix::default(); 4];
    let stress = |k: usize| points[k].stress(&shapes[k], shear[k], pressure);
    let stresses = [stress(0), stress(1), stress(2), stress(3)];
    for (c, r) in (0..9).map(|k| (k / 3, k % 3)) {
        let parts = sums_of_signs([0, 1, 2, 3].map(|k: usize| stresses[k][c][r]));
        for (sum, value) in sums.iter_mut().zip(parts) {
            sum[c][r] = value;
        }
    }
    let [all, by_x, by_y, by_xy] = sums;
    let (point, square) = (R::splat(0.25 * POINT), R::splat(0.25 * POINT * POINT) * parity);
    let linear = sides.stress(all).map(|p| scale(p, R::splat(0.25)));
    let (by_x, by_y) = (sides.stress(by_x), sides.stress(by_y));
    let by_z = sides.stress(by_xy).map(|p| scale(p, parity));
    Modes {
        linear,
        twist: [
            scale(add(by_y[0], by_x[1]), point),
            scale(add(by_z[0], by_x[2]), point),
            scale(add(by_z[1], by_y[2]), point),
        ],
        d: scale(add(add(by_x[0], by_y[1]), by_z[2]), square),
    }
}

pub(super) fn mean_volume<R: Real>(points: &[Deformed<R>; 4]) -> R {
    let [a, b, c, d] = points;
    R::splat(0.25) * ((a.volume + b.volume) + (c.volume + d.volume))
}

/// The energy per rest volume by either rule \[kPa\]; infinite where J is at the law's least.
pub(crate) fn energy(
    law: &impl WholeLaw,
    modes: &Modes<f64>,
    sides: &impl Sides<f64>,
    variation: &Variation<f64>,
    parity: Option<f64>,
) -> f64 {
    let Some(parity) = parity else {
        let deformed = Deformed::new(sides.gradient(modes.linear));
        if deformed.volume <= LEAST_VOLUME {
            return f64::INFINITY;
        }
        let g = deformed.isochoric().g + variation.mean_square(modes);
        return law.energy(g, deformed.volume());
    };
    let points = at_points(modes, sides, parity).map(Deformed::new);
    if points.iter().any(|point| point.volume <= LEAST_VOLUME) {
        return f64::INFINITY;
    }
    let volume = Volume::new(mean_volume(&points));
    points.iter().map(|point| law.energy(point.isochoric().g, volume)).sum::<f64>() / 4.0
}

//! A cell of eight nodes: energy and forces of its displacement modes.
//!
//! Lateral lengths are in spacings; [`Sides`] turns slopes along the sides into a gradient.
//!
//! ln J is one number of the cell: cells do not lock. Two rules of integration:
//!
//! * [`center`]: one point, J in the middle; what varies inside of the cell adds its mean square to g.
//! * [`four_points`]: four of the eight Gauss points, of alternating parity from cell to cell, J their mean. Accurate where a
//!   softening tissue concentrates strain; 2.3 times the work.

use super::deformed::{Deformed, Matrix, combined};
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
    let ([xy, xz, yz], d) = (modes.twist, modes.d);
    let point = R::splat(POINT);
    let (xy, xz, yz) = (scale(xy, point), scale(xz, point), scale(yz, point));
    let d = scale(d, R::splat(POINT * POINT) * parity);
    let [x, y, z] = modes.linear;
    let [a, b, c, e] = SIGNS;
    let at = |[sx, sy]: [f64; 2]| {
        let (sx, sy) = (R::splat(sx), R::splat(sy));
        let sz = sx * sy * parity;
        // The product of the three signs is the parity: ηζ has the sign parity·sx.
        let x = add(x, add(add(scale(xy, sy), scale(xz, sz)), scale(d, sx)));
        let y = add(y, add(add(scale(xy, sx), scale(yz, sz)), scale(d, sy)));
        let z = add(z, add(add(scale(xz, sx), scale(yz, sy)), scale(d, sz)));
        sides.gradient([x, y, z])
    };
    [at(a), at(b), at(c), at(e)]
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

const SIGNS: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0]];

/// The derivatives of the energy per rest volume by the modes, by the rule of four points.
#[inline(always)]
pub(crate) fn four_points<R: Real>(
    law: &impl SolidLaw<R>,
    modes: &Modes<R>,
    sides: &impl Sides<R>,
    parity: R,
    augmented: R,
) -> Modes<R> {
    let quarter = R::splat(0.25);
    let [a, b, c, d] = at_points(modes, sides, parity);
    let points = [Deformed::new(a), Deformed::new(b), Deformed::new(c), Deformed::new(d)];
    let volume = mean_volume(&points);
    let [a, b, c, d] = &points;
    let shapes = [a.isochoric(), b.isochoric(), c.isochoric(), d.isochoric()];
    let [a, b, c, d] = &shapes;
    let g = [a.g, b.g, c.g, d.g];
    let Slopes { shear, pressure } = law.slopes(g, Volume::new(volume), augmented);
    let mut forces = Modes::default();
    let point = R::splat(0.25 * POINT);
    let square = R::splat(0.25 * POINT * POINT) * parity;
    for (k, [sx, sy]) in SIGNS.into_iter().enumerate() {
        let (sx, sy) = (R::splat(sx), R::splat(sy));
        let sz = sx * sy * parity;
        let [x, y, z] = sides.stress(points[k].stress(&shapes[k], shear[k], pressure));
        for (to, p) in forces.linear.iter_mut().zip([x, y, z]) {
            *to = add(*to, scale(p, quarter));
        }
        let (px, py, pz) = (sx * point, sy * point, sz * point);
        let [xy, xz, yz] = &mut forces.twist;
        *xy = add(*xy, add(scale(x, py), scale(y, px)));
        *xz = add(*xz, add(scale(x, pz), scale(z, px)));
        *yz = add(*yz, add(scale(y, pz), scale(z, py)));
        let along = combined([x, y, z], [sx * square, sy * square, sz * square]);
        forces.d = add(forces.d, along);
    }
    forces
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

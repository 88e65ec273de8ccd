//! The energy of a body that yields: nearly incompressible, neo-Hookean, over the body at rest.
//!
//! W = E/6 ∫ (tr FᵀF − 3) dV with Young's modulus E and the gradient F of the image, of determinant one, by Gauss's rule in the angle whose cosine is
//! the height, in the squared distance from the axis, and by equal steps around. A weight w per volume adds −w·∫ φ dV of the image φ.

use super::super::traits::Geometry;
use super::map::{MODES, Modes};
use crate::number::Real;
use crate::number::dual::Dual;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Nodes and weights of Gauss's rule of three points on [0, 1].
const GAUSS: [(f64, f64); 3] = [
    (0.112_701_665_379_258_31, 5.0 / 18.0),
    (0.5, 8.0 / 18.0),
    (0.887_298_334_620_741_7, 5.0 / 18.0),
];
/// Parts of the quarter circle of heights; steps around.
const PARTS: usize = 2;
const AROUND: usize = 6;

/// A point of the body at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Point {
    /// Position by the body's height.
    place: [f64; 3],
    /// Volume around the point \[mm³\].
    volume: f64,
}

/// A body that yields.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Gel {
    modulus_kpa: f64,
    /// Weight per volume times the height \[kPa\].
    weight: DVec3,
    /// Squares of the height by the half-axes.
    per_square: [f64; 2],
    points: Vec<Point>,
}

/// Of an image at a point: 1 − ε, 1 + 2νu, √(1 + νu), c and √c.
struct Parts<R> {
    left: R,
    steep: R,
    wide: R,
    c: R,
    root: R,
}

/// Energy with its derivatives \[kPa·mm³\].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Balance {
    pub(crate) forces: Modes<f64>,
    /// Second derivatives, of small strains: positive definite.
    pub(crate) stiffness: [Modes<f64>; MODES],
}

impl Gel {
    /// Of a shape whose sections are ellipses, of a modulus \[kPa\] and of a weight per volume \[kPa/mm\].
    pub(crate) fn new(shape: &impl Geometry, modulus_kpa: f64, weight: DVec3) -> Self {
        let DVec3 { x: a, y: b, z: height } = shape.half_axes();
        let mut points = Vec::with_capacity(PARTS * GAUSS.len() * GAUSS.len() * AROUND);
        let sections = (0..PARTS).flat_map(|part| GAUSS.map(|(at, weight)| (part, at, weight)));
        for (part, at, weight) in sections {
            let angle = (part as f64 + at) / PARTS as f64 * FRAC_PI_2;
            let half = DVec2::new(shape.reach(angle, DVec2::X).x, shape.reach(angle, DVec2::Y).y);
            let middle = shape.axis(height * angle.cos());
            let thickness = height * angle.sin() * weight * FRAC_PI_2 / PARTS as f64;
            for (square, share) in GAUSS {
                for k in 0..AROUND {
                    let turn = DVec2::from_angle(TAU * (k as f64 + 0.5) / AROUND as f64);
                    let place = middle + turn * half * square.sqrt();
                    let place = place.extend(height * angle.cos()) / height;
                    let volume = PI * half.x * half.y * thickness * share / AROUND as f64;
                    points.push(Point { place: place.to_array(), volume });
                }
            }
        }
        let per_square = [a, b].map(|axis| (height / axis).powi(2));
        Self { modulus_kpa, weight: weight * height, per_square, points }
    }

    /// Elastic energy \[kPa·mm³\].
    pub(crate) fn energy(&self, modes: Modes<f64>) -> f64 {
        let trace = |point: &Point| {
            let rows = self.gradient(point, modes);
            point.volume * (rows.iter().flatten().map(|f| f * f).sum::<f64>() - 3.0)
        };
        self.modulus_kpa / 6.0 * self.points.iter().map(trace).sum::<f64>()
    }

    /// Energy of the weight, zero in the plane of the base under the body's middle \[kPa·mm³\].
    #[cfg(test)]
    pub(crate) fn potential(&self, modes: Modes<f64>) -> f64 {
        let of = |point: &Point| -point.volume * self.lowered(point, modes);
        self.points.iter().map(of).sum()
    }

    /// The image of a point along the weight \[kPa\].
    #[inline(always)]
    fn lowered<R: Real>(&self, point: &Point, modes: Modes<R>) -> R {
        let upright = self.upright(point, modes);
        let [r, s] = self.rises(upright, modes);
        let (one, two) = (R::splat(1.0), R::splat(2.0));
        let [a, b, c] = self.weight.to_array().map(R::splat);
        let [x, y] = [(0, r), (1, s)].map(|(axis, rise)| {
            two * upright[axis] / (one + rise) + self.moved(axis, modes[MODES - 2 + axis])
        });
        a * x + b * y + c * upright[2] * r * s
    }

    /// The tilt's move of the sections along an axis.
    #[inline(always)]
    fn moved<R: Real>(&self, axis: usize, tilt: R) -> R {
        let (one, two) = (R::splat(1.0), R::splat(2.0));
        let side = |over: R| one / (one + (one + over).max(R::splat(0.01)).sqrt());
        (side(-(two * tilt)) - side(two * tilt)) / R::splat(self.per_square[axis].sqrt())
    }

    /// The image of a point before the tilt.
    #[inline(always)]
    fn upright<R: Real>(&self, point: &Point, modes: Modes<R>) -> [R; 3] {
        let [x, y, z] = point.place.map(R::splat);
        let Parts { left, steep, wide, c, root } = self.parts(point, modes);
        let up = left * R::splat(2.0) * z * steep / (R::splat(1.0) + c);
        let wide = root / (wide * left.sqrt());
        let [_, _, _, widening, across, along, ..] = modes;
        [x * wide * widening.exp() + across * up, y * wide * (-widening).exp() + along * up, up]
    }

    /// The tilt's factors r_x and r_y of the height of an image.
    #[inline(always)]
    fn rises<R: Real>(&self, upright: [R; 3], [.., across, along]: Modes<R>) -> [R; 2] {
        let rise = |tilt: R, at: R, square: f64| {
            let over = R::splat(2.0 * square.sqrt()) * tilt * at;
            (R::splat(1.0) + over).max(R::splat(0.01)).sqrt()
        };
        let [a, b] = self.per_square;
        [rise(across, upright[0], a), rise(along, upright[1], b)]
    }

    /// What the image of a point and its gradient have in common.
    #[inline(always)]
    fn parts<R: Real>(&self, point: &Point, modes: Modes<R>) -> Parts<R> {
        let [flattening, taper, shoulder, ..] = modes;
        let number = R::splat;
        let (one, two) = (number(1.0), number(2.0));
        let [x, y, z] = point.place;
        let far = x * (x * self.per_square[0]) + y * (y * self.per_square[1]);
        let u = two * number(far) / (one + (one + shoulder * number(4.0 * far)).sqrt());
        let (steep, wide) = (one + two * shoulder * u, (one + shoulder * u).sqrt());
        let c = (one + two * taper * number(z) * steep).max(number(0.01)).sqrt();
        Parts { left: one - flattening, steep, wide, c, root: c.sqrt() }
    }

    /// The gradient of the image at a point, by rows.
    #[inline(always)]
    fn gradient<R: Real>(&self, point: &Point, modes: Modes<R>) -> [[R; 3]; 3] {
        let [_, taper, shoulder, widening, across, along, tilts @ ..] = modes;
        let number = R::splat;
        let [x, y, z] = point.place;
        let [by_x, by_y] = [x * self.per_square[0], y * self.per_square[1]];
        let Parts { left, steep, wide, c, root } = self.parts(point, modes);
        // ∂(1/wide)/∂(far) times two, and ∂(steep)/∂(far) times two.
        let narrowing = shoulder / (wide * wide * wide * steep);
        let rise = number(4.0) * shoulder / steep;
        let per_wide = number(1.0) / wide;
        let upper = [rise * number(z * by_x), rise * number(z * by_y), steep];
        let bow = taper / (number(2.0) * c * root);
        let up = left / c;
        let row = |of: f64, own: usize, widening: R, shear: R| {
            let width = widening.exp() / left.sqrt();
            let lift = width * bow * number(of) * per_wide + shear * up;
            [0, 1, 2].map(|axis| {
                let by = [by_x, by_y, 0.0][axis];
                let own = if axis == own { per_wide } else { number(0.0) };
                width * root * (own - narrowing * number(of * by)) + lift * upper[axis]
            })
        };
        let rows =
            [row(x, 0, widening, across), row(y, 1, -widening, along), upper.map(|part| part * up)];
        // The tilt: rows by r_x and r_y, and the height's by their change.
        let upright = self.upright(point, modes);
        let [r, s] = self.rises(upright, modes);
        let [by_x, by_y] = [(0, r, s), (1, s, r)].map(|(axis, own, other)| {
            upright[2] * tilts[axis] * number(self.per_square[axis].sqrt()) * other / own
        });
        [
            rows[0].map(|part| part / r),
            rows[1].map(|part| part / s),
            [0, 1, 2].map(|k| rows[2][k] * r * s + rows[0][k] * by_x + rows[1][k] * by_y),
        ]
    }

    /// Derivatives of both energies by the numbers; the second ones are those of the elastic energy.
    pub(crate) fn balance(&self, modes: Modes<f64>) -> Balance {
        let variables = std::array::from_fn(|k| Dual::<MODES>::variable(modes[k], k));
        let shear_modulus = self.modulus_kpa / 3.0;
        let mut forces = [0.0; MODES];
        let mut stiffness = [[0.0; MODES]; MODES];
        for point in &self.points {
            if self.weight != DVec3::ZERO {
                let lowered = self.lowered(point, variables);
                for (force, slope) in forces.iter_mut().zip(lowered.slopes) {
                    *force -= point.volume * slope;
                }
            }
            let rows = self.gradient(point, variables);
            let weight = shear_modulus * point.volume;
            for i in 0..3 {
                for j in 0..3 {
                    let (own, other) = (&rows[i][j], &rows[j][i]);
                    for k in 0..MODES {
                        forces[k] += weight * own.value * own.slopes[k];
                        let both = weight * own.slopes[k];
                        for l in 0..MODES {
                            stiffness[k][l] += both * (own.slopes[l] + other.slopes[l]);
                        }
                    }
                }
            }
        }
        Balance { forces, stiffness }
    }
}

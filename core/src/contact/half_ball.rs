//! The shape of an implant: a half-ball's linear image, for one point in f64 or for four in f32.
//!
//! A point at p from the centre of the base is the image of s = (x/R, y/R, z/h) in the half-ball, R the base radius, h the
//! projection. The length |s| is one on the surface; the gauge is |s| − 1. An implant of another shape is another file with these functions.

use crate::mesh::vec3::{Block, dot, sub};
use crate::number::Real;

/// Lengths below which a point counts as the centre.
const LEAST_LENGTH: f64 = 1e-6;

/// A half-ball's image in place, in any unit of length.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct HalfBall<R> {
    /// Centre of the base.
    center: [R; 3],
    /// Reciprocal half-axes.
    per_axis: [R; 3],
}

/// A point beside the surface.
#[derive(Clone, Copy)]
pub(crate) struct Near<R> {
    /// Position from the centre of the base.
    pub(crate) position: [R; 3],
    /// Gauge plus one.
    pub(crate) length: R,
    /// Gradient of the gauge.
    pub(crate) gradient: [R; 3],
}

impl<R: Real> HalfBall<R> {
    pub(crate) fn new(center: [f64; 3], half_axes: [f64; 3]) -> Self {
        Self { center: center.map(R::splat), per_axis: half_axes.map(|axis| R::splat(1.0 / axis)) }
    }

    /// The source of a vector in the half-ball.
    #[inline(always)]
    fn source(&self, v: [R; 3]) -> [R; 3] {
        [v[0] * self.per_axis[0], v[1] * self.per_axis[1], v[2] * self.per_axis[2]]
    }

    /// Gauge plus one, squared: the gauge without a root.
    #[inline(always)]
    pub(crate) fn length_squared(&self, point: [R; 3]) -> R {
        let s = self.source(sub(point, self.center));
        dot(s, s)
    }

    /// Gauge and gradient at a point; the gradient is zero at the centre.
    #[inline(always)]
    pub(crate) fn near(&self, point: [R; 3]) -> Near<R> {
        let position = sub(point, self.center);
        let s = self.source(position);
        let length = dot(s, s).sqrt();
        let per = R::splat(1.0) / length.max(R::splat(LEAST_LENGTH));
        Near { position, length, gradient: self.source(s.map(|s| s * per)) }
    }

    /// Second derivative of the gauge.
    #[inline(always)]
    pub(crate) fn curvature(&self, Near { length, gradient: g, .. }: &Near<R>) -> Block<R> {
        let per = R::splat(1.0) / length.max(R::splat(LEAST_LENGTH));
        let [x, y, z] = self.source(self.per_axis);
        [
            (x - g[0] * g[0]) * per,
            -g[0] * g[1] * per,
            -g[0] * g[2] * per,
            (y - g[1] * g[1]) * per,
            -g[1] * g[2] * per,
            (z - g[2] * g[2]) * per,
        ]
    }

    /// The multiple of a direction, near the gradient, that leads from a position to a length: a root of a quadratic
    /// equation.
    #[inline(always)]
    pub(crate) fn distance_along(&self, position: [R; 3], direction: [R; 3], length: R) -> R {
        let (s, g) = (self.source(position), self.source(direction));
        let (a, b, c) = (dot(g, g), dot(s, g), dot(s, s) - length * length);
        let root = (b * b - a * c).max(R::splat(0.0)).sqrt();
        -c / (b + root).max(R::splat(1e-20))
    }

    /// The way of a point, not below the base, to a length: along the ray from the centre or upright, whichever is
    /// shorter. On a flat dome the ray leads far aside.
    #[inline(always)]
    pub(crate) fn way_to(&self, Near { position: p, length, .. }: &Near<R>, to: R) -> [R; 3] {
        let zero = R::splat(0.0);
        let ray = (to - *length) / length.max(R::splat(LEAST_LENGTH));
        let s = self.source(*p);
        let height = to * to - s[0] * s[0] - s[1] * s[1];
        let upright = (height.max(zero).sqrt() - s[2]) / self.per_axis[2];
        let most = R::select(height.is_above(zero), ray * ray * dot(*p, *p), zero);
        let is_upright = most.is_above(upright * upright);
        [
            R::select(is_upright, zero, p[0] * ray),
            R::select(is_upright, zero, p[1] * ray),
            R::select(is_upright, upright, p[2] * ray),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::vec3::{add, times};
    use wide::f32x4;

    const CENTER: [f64; 3] = [3.0, -2.0, -4.0];
    const HALF_AXES: [f64; 3] = [24.0, 24.0, 17.0];

    fn points() -> impl Iterator<Item = [f64; 3]> {
        (0..200).map(|k| {
            let t = f64::from(k);
            [30.0 * (t * 0.7).sin(), 28.0 * (t * 1.3).cos(), 20.0 * (t * 0.17).sin().abs()]
        })
    }

    #[test]
    fn both_precisions_agree_and_the_way_ends_at_its_length() {
        let one = HalfBall::<f64>::new(CENTER, HALF_AXES);
        let four = HalfBall::<f32x4>::new(CENTER, HALF_AXES);
        let first = |lanes: f32x4| f64::from(lanes.to_array()[0]);
        for point in points() {
            let (near, lanes) = (one.near(point), four.near(point.map(<f32x4 as Real>::splat)));
            assert!((near.length - first(lanes.length)).abs() < 1e-6);
            for (own, lanes) in near.gradient.into_iter().zip(lanes.gradient) {
                assert!((own - first(lanes)).abs() < 1e-6);
            }
            let way = one.way_to(&near, 1.1);
            assert!((one.near(add(point, way)).length - 1.1).abs() < 1e-12);
            for (own, lanes) in way.into_iter().zip(four.way_to(&lanes, f32x4::splat(1.1))) {
                assert!((own - first(lanes)).abs() < 1e-3, "{own} {lanes:?} at {point:?}");
            }
        }
    }

    #[test]
    fn the_curvature_is_the_derivative_of_the_gradient() {
        let shape = HalfBall::<f64>::new(CENTER, HALF_AXES);
        for point in points() {
            let block = shape.curvature(&shape.near(point));
            for axis in 0..3 {
                let mut along = [0.0; 3];
                along[axis] = 1e-5;
                let [after, before] =
                    [add(point, along), sub(point, along)].map(|p| shape.near(p).gradient);
                let expected = times(block, along.map(|a| a / 1e-5));
                for k in 0..3 {
                    let difference = (after[k] - before[k]) / 2e-5;
                    assert!((difference - expected[k]).abs() < 1e-8);
                }
            }
        }
    }
}

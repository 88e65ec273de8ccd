//! The shape of an implant: a half-ball's linear image draped over the wall, for one point in f64 or for four in f32.
//!
//! A point (x, y, z) from the centre of the base, z counted from the wall below the point, is the image of
//! s = (x/a, (y + σz)/b, z/p) in the half-ball: half-axes a and b of the base, projection p, and a shear σ that moves the apex by σp
//! towards −y; of another fullness than half of an ellipsoid the last number is mapped further ([`Fullness`]). The length |s| is one on the
//! surface; the gauge is |s| − 1. An implant of another shape is another file with these functions.

use super::fullness::Fullness;
use crate::mesh::height_field::{Ground, HeightField};
use crate::mesh::vec3::{Block, add, dot, sub};
use crate::number::Real;

/// Lengths below which a point counts as the centre.
const LEAST_LENGTH: f64 = 1e-6;
/// Steps of Newton's method along a direction: nodes in contact end within rounding in f32.
const STEPS_ALONG: usize = 4;

/// A half-ball's image in place, in any unit of length.
#[derive(Clone, Debug, Default)]
pub(crate) struct HalfBall<R> {
    /// Centre of the base: a place, and a height above the wall.
    center: [R; 3],
    /// Reciprocal half-axes.
    per_axis: [R; 3],
    /// Way of the axis towards −y per height; `None` for an upright axis.
    shear: Option<R>,
    /// The map of heights; `None` for half of an ellipsoid.
    fullness: Option<Fullness<R>>,
    wall: HeightField<R>,
}

/// A point beside the surface.
#[derive(Clone, Copy)]
pub(crate) struct Near<R> {
    /// Position from the centre of the base, above the wall below the point.
    pub(crate) position: [R; 3],
    /// Gauge plus one.
    pub(crate) length: R,
    /// Gradient of the gauge.
    pub(crate) gradient: [R; 3],
    ground: Ground<R>,
}

impl<R: Real> HalfBall<R> {
    /// With half-axes a, b, p and the way of the apex towards −y.
    pub(crate) fn new(
        center: [f64; 3],
        half_axes: [f64; 3],
        shift: f64,
        wall: HeightField<R>,
    ) -> Self {
        let per_axis = half_axes.map(|axis| R::splat(1.0 / axis));
        let shear = (shift != 0.0).then(|| R::splat(shift / half_axes[2]));
        Self { center: center.map(R::splat), per_axis, shear, fullness: None, wall }
    }

    /// The shape with an exponent m of its heights.
    pub(crate) fn with_exponent(self, exponent: f64) -> Self {
        Self { fullness: Some(Fullness::new(exponent)), ..self }
    }

    /// The linear part of the source of a vector: all of it for half of an ellipsoid.
    #[inline(always)]
    pub(super) fn linear(&self, [x, mut y, z]: [R; 3]) -> [R; 3] {
        if let Some(shear) = self.shear {
            y += shear * z;
        }
        [x * self.per_axis[0], y * self.per_axis[1], z * self.per_axis[2]]
    }

    /// The transposed map of [`Self::linear`]: the gradient of a function of that part.
    #[inline(always)]
    fn gradient(&self, of: [R; 3]) -> [R; 3] {
        let [x, y, mut z] = [0, 1, 2].map(|axis| of[axis] * self.per_axis[axis]);
        if let Some(shear) = self.shear {
            z += shear * y;
        }
        [x, y, z]
    }

    /// Position from the centre, and the wall below the point.
    #[inline(always)]
    fn position(&self, point: [R; 3]) -> ([R; 3], Ground<R>) {
        if self.wall.is_flat() {
            return (sub(point, self.center), Ground::default());
        }
        let ground = self.wall.at([point[0], point[1]]);
        (sub([point[0], point[1], point[2] - ground.height], self.center), ground)
    }

    /// Gauge plus one, squared: the gauge without a root.
    #[inline(always)]
    pub(crate) fn length_squared(&self, point: [R; 3]) -> R {
        let mut s = self.linear(self.position(point).0);
        if let Some(fullness) = &self.fullness {
            s[2] = fullness.source(s[2]).0;
        }
        dot(s, s)
    }

    /// Gauge and gradient at a point; the gradient is zero at the centre.
    #[inline(always)]
    pub(crate) fn near(&self, point: [R; 3]) -> Near<R> {
        let (position, ground) = self.position(point);
        let mut s = self.linear(position);
        // Half of the gradient of |s|² by the linear part.
        let mut pull = s;
        if let Some(fullness) = &self.fullness {
            (s[2], pull[2]) = fullness.source(s[2]);
        }
        let length = dot(s, s).sqrt();
        let per = R::splat(1.0) / length.max(R::splat(LEAST_LENGTH));
        let mut gradient = self.gradient(pull.map(|pull| pull * per));
        if !self.wall.is_flat() {
            let [x, y] = ground.slope.map(|slope| slope * gradient[2]);
            gradient = [gradient[0] - x, gradient[1] - y, gradient[2]];
        }
        Near { position, length, gradient, ground }
    }

    /// Second derivative of the gauge; of another fullness no nearer to the base than a least height \[projection\].
    #[inline(always)]
    pub(super) fn curvature(&self, near: &Near<R>, least: f64) -> Block<R> {
        let Near { position, length, gradient: g, ground } = near;
        let per = R::splat(1.0) / length.max(R::splat(LEAST_LENGTH));
        let [x, y, mut z] = self.per_axis.map(|axis| axis * axis);
        if let Some(fullness) = &self.fullness {
            z = z * fullness.bend(position[2] * self.per_axis[2], least);
        }
        let mut sum = [
            (x - g[0] * g[0]) * per,
            -g[0] * g[1] * per,
            -g[0] * g[2] * per,
            (y - g[1] * g[1]) * per,
            -g[1] * g[2] * per,
            (z - g[2] * g[2]) * per,
        ];
        let sheared = self.shear.map(|shear| shear * y);
        if let (Some(shear), Some(y)) = (self.shear, sheared) {
            z += shear * y;
            sum[4] += y * per;
            sum[5] += shear * y * per;
        }
        if !self.wall.is_flat() {
            // The square of the source of (0, 0, 1), with z − w in place of z.
            let [across, along] = ground.slope;
            let place = [position[0] + self.center[0], position[1] + self.center[1]];
            let [xx, xy, yy] = self.wall.curvature(place);
            let own = [
                z * across * across * per - g[2] * xx,
                z * across * along * per - g[2] * xy,
                -z * across * per,
                z * along * along * per - g[2] * yy,
                -z * along * per,
                R::splat(0.0),
            ];
            sum.iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
            if let Some(y) = sheared {
                sum[1] += -(y * across * per);
                sum[3] += -((y + y) * along * per);
            }
        }
        sum
    }

    /// The position after a move.
    #[inline(always)]
    pub(crate) fn moved(&self, near: &Near<R>, way: [R; 3]) -> [R; 3] {
        let [x, y, z] = add(near.position, way);
        if self.wall.is_flat() {
            return [x, y, z];
        }
        let after = self.wall.at([x + self.center[0], y + self.center[1]]);
        [x, y, z - (after.height - near.ground.height)]
    }

    /// The multiple of a direction, near the gradient, that leads from a position to a length: a root of a quadratic
    /// equation, with a map of heights by Newton's method; over a curved wall to first order of the way.
    #[inline(always)]
    pub(crate) fn distance_along(
        &self,
        near: &Near<R>,
        position: [R; 3],
        mut direction: [R; 3],
        length: R,
    ) -> R {
        if !self.wall.is_flat() {
            let [x, y] = near.ground.slope;
            direction[2] = direction[2] - (x * direction[0] + y * direction[1]);
        }
        let (s, g) = (self.linear(position), self.linear(direction));
        if let Some(fullness) = &self.fullness {
            return distance_to(fullness, s, g, length);
        }
        let (a, b, c) = (dot(g, g), dot(s, g), dot(s, s) - length * length);
        let root = (b * b - a * c).max(R::splat(0.0)).sqrt();
        -c / (b + root).max(R::splat(1e-20))
    }

    /// The way of a point, not below the base, to a length: along the ray from the centre or along the axis, whichever is
    /// shorter. On a flat dome the ray leads far aside.
    #[inline(always)]
    pub(crate) fn way_to(&self, near: &Near<R>, to: R) -> [R; 3] {
        let Near { position: p, length, ground, .. } = near;
        if let Some(fullness) = &self.fullness {
            return self.way_of_fullness(near, fullness, to);
        }
        let zero = R::splat(0.0);
        let ray = (to - *length) / length.max(R::splat(LEAST_LENGTH));
        let s = self.linear(*p);
        let height = to * to - s[0] * s[0] - s[1] * s[1];
        let upright = (height.max(zero).sqrt() - s[2]) / self.per_axis[2];
        let most = R::select(height.is_above(zero), ray * ray * dot(*p, *p), zero);
        let aside = self.shear.map_or(zero, |shear| -(shear * upright));
        let is_upright = most.is_above(upright * upright + aside * aside);
        let mut way = [
            R::select(is_upright, zero, p[0] * ray),
            R::select(is_upright, aside, p[1] * ray),
            R::select(is_upright, upright, p[2] * ray),
        ];
        if !self.wall.is_flat() {
            let place = [p[0] + way[0] + self.center[0], p[1] + way[1] + self.center[1]];
            way[2] += self.wall.at(place).height - ground.height;
        }
        way
    }

    /// [`Self::way_to`] with a map of heights: along the image of the half-ball's ray, or along the axis.
    #[inline(never)]
    fn way_of_fullness(&self, near: &Near<R>, fullness: &Fullness<R>, to: R) -> [R; 3] {
        let Near { position: p, length, ground, .. } = near;
        let zero = R::splat(0.0);
        let [x, y, z] = self.linear(*p);
        let factor = to / length.max(R::splat(LEAST_LENGTH));
        let left = to * to - x * x - y * y;
        // Sources and heights of both ends.
        let rise = |height: R| (height - z) / self.per_axis[2];
        let upright = rise(fullness.image(left.max(zero).sqrt()));
        let along = rise(fullness.image(factor * fullness.source(z).0));
        let lean = self.shear.unwrap_or_default();
        let aside = -(lean * upright);
        let [across, down] =
            [x / self.per_axis[0], y / self.per_axis[1]].map(|way| way * (factor - R::splat(1.0)));
        let ray = [across, down - lean * along, along];
        let most = R::select(left.is_above(zero), dot(ray, ray), zero);
        let is_upright = most.is_above(upright * upright + aside * aside);
        let mut way = [
            R::select(is_upright, zero, ray[0]),
            R::select(is_upright, aside, ray[1]),
            R::select(is_upright, upright, ray[2]),
        ];
        if !self.wall.is_flat() {
            let place = [p[0] + way[0] + self.center[0], p[1] + way[1] + self.center[1]];
            way[2] += self.wall.at(place).height - ground.height;
        }
        way
    }
}

/// The multiple of a direction that leads from a point to a length, both in the linear part of the source: |s|² is convex along the
/// direction, so that steps of Newton's method stay beyond the root after the first.
#[inline(never)]
fn distance_to<R: Real>(fullness: &Fullness<R>, from: [R; 3], direction: [R; 3], length: R) -> R {
    let half = R::splat(0.5);
    let most = R::splat(1.0) / dot(direction, direction).sqrt().max(R::splat(1e-20));
    let mut factor = R::splat(0.0);
    for _ in 0..STEPS_ALONG {
        let at = [0, 1, 2].map(|axis| from[axis] + direction[axis] * factor);
        let (s, pull) = fullness.source(at[2]);
        let over = half * (at[0] * at[0] + at[1] * at[1] + s * s - length * length);
        let slope = at[0] * direction[0] + at[1] * direction[1] + pull * direction[2];
        let step = over / slope.max(R::splat(1e-20));
        factor = factor - step.max(-most).min(most);
    }
    factor
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::vec3::times;
    use crate::mesh::{Chest, HeightGrid};
    use wide::f32x4;

    const CENTER: [f64; 3] = [3.0, -2.0, -4.0];

    /// Round and anatomical implants, as half of an ellipsoid, leaner and fuller, on the plane, over two radii and over a grid of heights.
    fn shapes<R: Real>() -> Vec<HalfBall<R>> {
        let heights = (0..17 * 17).map(|k| {
            let [x, y] = [k % 17, k / 17].map(|i| 6.0 * (f64::from(i) - 8.0));
            0.05 * x - 0.004 * x * x - 0.003 * y * y + 2.0 * (0.06 * x + 0.03 * y).sin()
        });
        let grid = Chest::Grid(HeightGrid::new(6.0, [17; 2], heights.collect()).unwrap());
        let radii = Chest::Curved { across_mm: 70.0, along_mm: 160.0 };
        [([24.0, 24.0, 17.0], 0.0), ([24.0, 28.0, 17.0], 11.0)]
            .into_iter()
            .flat_map(|(half_axes, shift)| {
                [&Chest::Flat, &radii, &grid].into_iter().flat_map(move |wall| {
                    let plain = || HalfBall::new(CENTER, half_axes, shift, wall.heights());
                    let of = [11.0 / 9.0, 1.5, 3.0, 4.0].map(|m| plain().with_exponent(m));
                    [plain()].into_iter().chain(of)
                })
            })
            .collect()
    }

    fn points() -> impl Iterator<Item = [f64; 3]> {
        (0..200).map(|k| {
            let t = f64::from(k);
            [30.0 * (t * 0.7).sin(), 28.0 * (t * 1.3).cos(), 20.0 * (t * 0.17).sin().abs()]
        })
    }

    #[test]
    fn both_precisions_agree_and_the_way_ends_at_its_length() {
        for (one, four) in shapes::<f64>().into_iter().zip(shapes::<f32x4>()) {
            let first = |lanes: f32x4| f64::from(lanes.to_array()[0]);
            for point in points() {
                let near = one.near(point);
                let lanes = four.near(point.map(<f32x4 as Real>::splat));
                assert!((near.length - first(lanes.length)).abs() < 1e-6);
                for (own, lanes) in near.gradient.into_iter().zip(lanes.gradient) {
                    assert!((own - first(lanes)).abs() < 1e-6);
                }
                let way = one.way_to(&near, 1.1);
                assert!((one.near(add(point, way)).length - 1.1).abs() < 1e-12);
                let position = one.near(add(point, way)).position;
                for (own, moved) in position.into_iter().zip(one.moved(&near, way)) {
                    assert!((own - moved).abs() < 1e-12);
                }
                for (own, lanes) in way.into_iter().zip(four.way_to(&lanes, f32x4::splat(1.1))) {
                    assert!((own - first(lanes)).abs() < 1e-3, "{own} {lanes:?} at {point:?}");
                }
            }
        }
    }

    /// Central differences of the gauge, then of the gradient; a short way along the gradient ends at its length.
    #[test]
    fn gradient_and_curvature_are_derivatives() {
        const STEP: f64 = 1e-5;
        for shape in shapes::<f64>() {
            for point in points() {
                let near = shape.near(point);
                let block = shape.curvature(&near, 0.0);
                for axis in 0..3 {
                    let mut along = [0.0; 3];
                    along[axis] = 1.0;
                    let [after, before] =
                        [STEP, -STEP].map(|step| shape.near(add(point, along.map(|a| a * step))));
                    let slope = (after.length - before.length) / (2.0 * STEP);
                    assert!((slope - near.gradient[axis]).abs() < 1e-8);
                    for (k, expected) in times(block, along).into_iter().enumerate() {
                        let difference = (after.gradient[k] - before.gradient[k]) / (2.0 * STEP);
                        assert!((difference - expected).abs() < 1e-8);
                    }
                }
                let to = near.length + 1e-3;
                let factor = shape.distance_along(&near, near.position, near.gradient, to);
                let end = shape.near(add(point, near.gradient.map(|g| g * factor)));
                assert!((end.length - to).abs() < 3e-5, "{} {to}", end.length);
            }
        }
    }
}

//! A shape in place: moved to its centre and draped over the wall, so that volume and heights stay.

use super::traits::Gauge;
use super::{Modes, Shape, ShapeGauge};
use crate::mesh::height_field::{Ground, HeightField};
use crate::mesh::vec3::{Block, add, sub};
use crate::number::Real;

/// The gauge of a shape in place, in any unit of length.
#[derive(Clone, Debug)]
pub(crate) struct Draped<R, G> {
    gauge: G,
    /// Centre of the base: a place, and a height above the wall.
    center: [R; 3],
    wall: HeightField<R>,
}

impl<R: Real> Draped<R, ShapeGauge<R>> {
    /// Replaces the shape in its place; returns the gauge before.
    pub(crate) fn reshape(&mut self, shape: &Shape) -> ShapeGauge<R> {
        std::mem::replace(&mut self.gauge, shape.gauge())
    }

    /// Derivatives of the length of a point by the numbers of the shape's deformation.
    pub(crate) fn variation(&self, near: &Near<R>) -> Modes<R> {
        self.gauge.variation(near.position)
    }

    /// The way of a point with the body from its deformation before.
    pub(crate) fn way_after(&self, before: &ShapeGauge<R>, near: &Near<R>) -> [R; 3] {
        let mut way = self.gauge.way_after(before, near.position);
        if !self.wall.is_flat() {
            let place = self.place(add(near.position, way));
            way[2] += self.wall.at(place).height - near.ground.height;
        }
        way
    }
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
    /// The wall below the point; zero for the plane.
    pub(crate) ground: Ground<R>,
}

impl<R: Real, G: Gauge<R>> Draped<R, G> {
    pub(crate) fn new(gauge: G, center: [f64; 3], wall: HeightField<R>) -> Self {
        Self { gauge, center: center.map(R::splat), wall }
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

    /// The wall's place at a position from the centre.
    #[inline(always)]
    fn place(&self, position: [R; 3]) -> [R; 2] {
        [position[0] + self.center[0], position[1] + self.center[1]]
    }

    /// Gauge plus one, squared: the gauge without a root.
    #[inline(always)]
    pub(crate) fn length_squared(&self, point: [R; 3]) -> R {
        self.gauge.length_squared(self.position(point).0)
    }

    /// Gauge and gradient at a point; the gradient is zero at the centre.
    #[inline(always)]
    pub(crate) fn near(&self, point: [R; 3]) -> Near<R> {
        let (position, ground) = self.position(point);
        let (length, mut gradient) = self.gauge.length(position);
        if !self.wall.is_flat() {
            let [x, y] = ground.slope.map(|slope| slope * gradient[2]);
            gradient = [gradient[0] - x, gradient[1] - y, gradient[2]];
        }
        Near { position, length, gradient, ground }
    }

    /// Second derivative of the gauge, as [`Gauge::curvature`].
    #[inline(always)]
    pub(crate) fn curvature(&self, point: [R; 3], least: f64) -> Block<R> {
        let (position, ground) = self.position(point);
        let (length, gradient) = self.gauge.length(position);
        let own = self.gauge.curvature(position, length, gradient, least);
        if self.wall.is_flat() {
            return own;
        }
        // The gauge's argument z − w in place of z.
        let ([xx, xy, xz, yy, yz, zz], [across, along]) = (own, ground.slope);
        let wall = self.wall.curvature(self.place(position)).map(|bend| bend * gradient[2]);
        let (xz_after, yz_after) = (xz - across * zz, yz - along * zz);
        [
            xx - across * (xz + xz_after) - wall[0],
            xy - along * xz - across * yz_after - wall[1],
            xz_after,
            yy - along * (yz + yz_after) - wall[2],
            yz_after,
            zz,
        ]
    }

    /// The position after a move.
    #[inline(always)]
    pub(crate) fn moved(&self, near: &Near<R>, way: [R; 3]) -> [R; 3] {
        let [x, y, z] = add(near.position, way);
        if self.wall.is_flat() {
            return [x, y, z];
        }
        let after = self.wall.at(self.place([x, y, z]));
        [x, y, z - (after.height - near.ground.height)]
    }

    /// The multiple of a direction, near the gradient, that leads from a position to a length; over a curved wall to first order of the way.
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
        self.gauge.distance_along(position, direction, length)
    }

    /// The way of a point to a length, as [`Gauge::way_to`].
    #[inline(always)]
    pub(crate) fn way_to(&self, near: &Near<R>, to: R) -> [R; 3] {
        let mut way = self.gauge.way_to(near.position, near.length, to);
        if !self.wall.is_flat() {
            let place = self.place(add(near.position, way));
            way[2] += self.wall.at(place).height - near.ground.height;
        }
        way
    }
}

#[cfg(test)]
mod tests {
    use super::super::superellipse::Superellipse;
    use super::super::{Deformed, HalfBall};
    use super::*;
    use crate::mesh::vec3::times;
    use crate::mesh::{Chest, HeightGrid};
    use wide::f32x4;

    const CENTER: [f64; 3] = [3.0, -2.0, -4.0];

    /// Round and anatomical implants, as half of an ellipsoid, leaner and fuller, and another shape, on the plane, over two radii and over a grid of heights.
    fn shapes<R: Real>() -> Vec<Draped<R, ShapeGauge<R>>> {
        let heights = (0..17 * 17).map(|k| {
            let [x, y] = [k % 17, k / 17].map(|i| 6.0 * (f64::from(i) - 8.0));
            0.05 * x - 0.004 * x * x - 0.003 * y * y + 2.0 * (0.06 * x + 0.03 * y).sin()
        });
        let grid = Chest::Grid(HeightGrid::new(6.0, [17; 2], heights.collect()).unwrap());
        let radii = Chest::Curved { across_mm: 70.0, along_mm: 160.0 };
        let plain = HalfBall::round(24.0, 17.0);
        [plain, plain.anatomical(28.0, 11.0)]
            .into_iter()
            .flat_map(|plain| {
                let filled = [0.55, 0.6, 0.75, 0.8].map(|fullness| plain.filled(fullness));
                [plain].into_iter().chain(filled)
            })
            .flat_map(|shape| {
                let mut soft = Deformed::at_rest(shape, 20.0);
                soft.modes = [0.12, -0.1, 0.06, 0.05, 0.06, -0.1, 0.03, -0.05];
                [Shape::from(shape), soft.into()]
            })
            .chain([Superellipse { radius: 24.0, projection: 17.0 }.into()])
            .flat_map(|shape| {
                [&Chest::Flat, &radii, &grid]
                    .map(|wall| Draped::new(shape.gauge(), CENTER, wall.heights()))
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
                let rounding = (5e-7 * near.length.max(1.0)).min(1e-6);
                assert!((near.length - first(lanes.length)).abs() < rounding);
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
                let block = shape.curvature(point, 0.0);
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

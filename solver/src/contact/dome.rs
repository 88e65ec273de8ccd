//! The implant in place: a shape, moved to its place and draped over the wall.
//!
//! Draping counts heights from the wall up and keeps volume and heights. Insertion t raises the dome: its base is at z₀ = (t − 1)·p above the wall, its
//! apex at t·p, p the projection. The gauge is negative inside and zero on the surface.

use super::shape::{Draped, Modes, Near, Shape, ShapeGauge};
use crate::mesh::Chest;
use crate::mesh::vec3::Block;
use crate::number::Real;
use glam::{DMat3, DVec2, DVec3};

/// Height for the Hessian of contact \[projection\], below which the gauge's second derivative is that at this height. That of a dome leaner than
/// half of an ellipsoid grows without limit towards the rim, as a sharp edge's, from which a node may slide: times the reaction it would outweigh the
/// tissue's stiffness. With the bound steps of Newton's method converge at a slower rate there.
const LEAST_OF_CONTACT: f64 = 0.01;

/// The gauge of a dome in place.
pub(super) type OwnGauge = Draped<f64, ShapeGauge<f64>>;

/// The matrix of a second derivative.
pub(super) fn symmetric([xx, xy, xz, yy, yz, zz]: Block<f64>) -> DMat3 {
    DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz])
}

/// A dome in place. Lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Dome {
    /// Its shape.
    pub shape: Shape,
    /// Centre of its base in the pocket \[mm\].
    pub center: DVec2,
    /// Height z₀ of its base above the wall \[mm\], −p to 0.
    pub base_height: f64,
    /// The wall that the dome is draped over.
    pub chest: Chest,
}

impl Dome {
    /// A shape raised by `insertion` (0: its apex at the wall; 1: its base on the wall).
    #[must_use]
    pub fn new(center: DVec2, shape: impl Into<Shape>, insertion: f64) -> Self {
        let shape = shape.into();
        let base_height = (insertion - 1.0) * shape.half_axes().z;
        Self { shape, center, base_height, chest: Chest::Flat }
    }

    /// The dome draped over a wall.
    #[must_use]
    pub fn over(self, chest: Chest) -> Self {
        Self { chest, ..self }
    }

    /// Is the dome a solid of revolution?
    #[must_use]
    pub fn is_round(&self) -> bool {
        self.shape.is_round()
    }

    /// Projection p \[mm\].
    #[must_use]
    pub fn projection(&self) -> f64 {
        self.shape.half_axes().z
    }

    /// Place of the axis, from the middle of the base to the apex, at a height above the wall \[mm\].
    #[must_use]
    pub fn axis(&self, height: f64) -> DVec2 {
        self.center + self.shape.axis(height - self.base_height)
    }

    /// Centre of its base \[mm\].
    #[must_use]
    pub fn origin(&self) -> DVec3 {
        self.center.extend(self.chest.height(self.center) + self.base_height)
    }

    /// Point highest above the wall \[mm\].
    #[must_use]
    pub fn apex(&self) -> DVec3 {
        let apex = self.shape.apex();
        let place = self.center + apex.truncate();
        let base = place.extend(self.chest.height(place) + self.base_height);
        base + DVec3::Z * apex.z
    }

    /// Height of the apex above the wall \[mm\].
    #[must_use]
    pub fn top(&self) -> f64 {
        self.base_height + self.projection()
    }

    /// Is it a hemisphere?
    #[must_use]
    pub fn is_hemisphere(&self) -> bool {
        let apart = self.reference_length() - self.projection();
        self.is_round()
            && self.shape.onto_ball().is_some()
            && apart.abs() <= 1e-9 * self.reference_length()
    }

    /// Volume of the whole implant \[mm³\].
    #[must_use]
    pub fn volume(&self) -> f64 {
        self.shape.volume()
    }

    /// Half of the width and of the height of the section in which the dome meets the wall \[mm\].
    #[must_use]
    pub fn wall_axes(&self) -> DVec2 {
        self.shape.half_widths(self.wall_angle())
    }

    /// The length that tolerances and errors are relative to \[mm\]: half of the base's width, of a round implant the base radius.
    #[must_use]
    pub fn reference_length(&self) -> f64 {
        self.shape.reference_length()
    }

    /// The dome in another unit of length.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            shape: self.shape.scaled(factor),
            center: self.center * factor,
            base_height: self.base_height * factor,
            chest: self.chest.scaled(factor),
        }
    }

    /// The dome with other numbers of its deformation; as it is unless it yields.
    pub(crate) fn set_modes(&mut self, modes: Modes<f64>) {
        self.shape.set_modes(modes);
    }

    /// Derivatives of the gauge at a fixed point by the numbers of the deformation; zero unless the dome yields.
    pub(crate) fn variation(&self, point: DVec3) -> Modes<f64> {
        let draped = self.draped::<f64>();
        draped.variation(&draped.near(point.to_array()))
    }

    /// The way of a point near the surface that follows the dome from its shape before, the length of the gauge from the surface to
    /// which it follows in part being given \[-\].
    pub(crate) fn way_after(&self, before: &Self, point: DVec3, within: f64) -> DVec3 {
        let draped = self.draped::<f64>();
        let near = draped.near(point.to_array());
        let share = (1.0 - (near.length - 1.0) / within).clamp(0.0, 1.0);
        DVec3::from(draped.way_after(&before.shape.gauge(), &near)) * share
    }

    /// The dome lowered until a part of its height is above the wall.
    pub(crate) fn lowered_to(&self, part: f64) -> Self {
        let base_height = self.base_height - (1.0 - part) * self.top();
        Self { base_height, ..self.clone() }
    }

    /// Distances \[mm\] that points outside are at least away, over the plane; no root but the gauge's.
    pub fn least_distances(&self) -> impl Fn(DVec3) -> f64 {
        let (least, top) = (self.shape.least_length(), self.base_height + self.shape.top());
        let (outgrows, draped) = (self.shape.outgrows_distance(), self.draped::<f64>());
        let gauge = move |point: DVec3| draped.near(point.to_array()).length - 1.0;
        move |point| {
            if !outgrows {
                return gauge(point) * least;
            }
            // The half-space below the highest point contains the dome.
            let over = (point.z - self.chest.height(point.truncate()) - top).max(0.0);
            (gauge(point - DVec3::Z * over) * least).max(over)
        }
    }

    /// The gauge in place, in numbers of one precision.
    pub(crate) fn draped<R: Real>(&self) -> Draped<R, ShapeGauge<R>> {
        let center = self.center.extend(self.base_height).to_array();
        Draped::new(self.shape.gauge(), center, self.chest.heights())
    }

    /// The gauge \[-\]: negative inside, zero on the surface.
    #[must_use]
    pub fn gauge(&self, point: DVec3) -> f64 {
        self.draped::<f64>().near(point.to_array()).length - 1.0
    }

    /// Gradient of [`Self::gauge`] \[1/mm\]; straight up at the centre of the base.
    #[must_use]
    pub fn gauge_gradient(&self, point: DVec3) -> DVec3 {
        self.gauge_and_gradient(point).1
    }

    /// [`Self::gauge`] and [`Self::gauge_gradient`] of one point.
    #[must_use]
    pub fn gauge_and_gradient(&self, point: DVec3) -> (f64, DVec3) {
        let Near { length, gradient, .. } = self.draped::<f64>().near(point.to_array());
        let upright = DVec3::new(0.0, 0.0, 1.0 / self.projection());
        (length - 1.0, if length > 0.0 { gradient.into() } else { upright })
    }

    /// Second derivative of [`Self::gauge`] \[1/mm²\] for the Hessian of contact: bounded at the rim.
    pub(super) fn contact_curvature(&self, point: DVec3) -> DMat3 {
        symmetric(self.draped::<f64>().curvature(point.to_array(), LEAST_OF_CONTACT))
    }

    /// Outer unit normal of the gauge's level surface through a point.
    #[must_use]
    pub fn normal(&self, point: DVec3) -> DVec3 {
        self.gauge_gradient(point).normalize()
    }

    /// The point moved onto the surface, as [`Self::project`] moves it.
    #[must_use]
    pub fn onto_surface(&self, point: DVec3) -> DVec3 {
        self.project(point, 0.0)
    }

    /// The point, not below the base, moved to where [`Self::gauge`] has the given value \[-\]: along the ray from the
    /// centre of the base, of another fullness along its image, or along the axis, whichever is the shorter way.
    #[must_use]
    pub fn project(&self, point: DVec3, gauge: f64) -> DVec3 {
        self.projected(&self.draped(), point, gauge)
    }

    /// [`Self::project`] with the dome's own gauge in place.
    pub(super) fn projected(&self, draped: &OwnGauge, point: DVec3, gauge: f64) -> DVec3 {
        let near = draped.near(point.to_array());
        if near.length < 1e-12 {
            return self.apex();
        }
        point + DVec3::from(draped.way_to(&near, 1.0 + gauge))
    }

    /// Is it its own image mirrored along x, along y, about the pocket's centre?
    #[must_use]
    pub fn mirrored(&self) -> [bool; 2] {
        let [along_x, along_y] = self.shape.mirrored();
        [along_x && self.center.x == 0.0, along_y && self.center.y == 0.0]
    }

    /// Is the point strictly inside the dome?
    #[must_use]
    pub fn contains(&self, point: DVec3) -> bool {
        self.is_above_base(point) && self.gauge(point) < 0.0
    }

    fn is_above_base(&self, point: DVec3) -> bool {
        point.z - self.chest.height(point.truncate()) >= self.base_height
    }

    /// A test: is a point above the base inside by more than a fraction of the half axes, and of the base radius
    /// as a distance? The gauge's gradient turns a gauge into a distance; near the tip of a needle it is small.
    pub(crate) fn is_deeper_than(&self, fraction: f64) -> impl Fn(DVec3) -> bool + use<> {
        let (dome, draped, unit) = (self.clone(), self.draped::<f64>(), self.reference_length());
        move |point| {
            // Most points need no root.
            if draped.length_squared(point.to_array()) >= 1.0 {
                return false;
            }
            let Near { length, gradient, .. } = draped.near(point.to_array());
            let steepness = DVec3::from(gradient).length() * unit;
            dome.is_above_base(point) && 1.0 - length > fraction * steepness.min(1.0)
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::contact::{Geometry, HalfBall, Superellipse};
    use crate::mesh::HeightGrid;
    use std::f64::consts::{FRAC_PI_2, PI};

    pub(in crate::contact) fn domes() -> [Dome; 3] {
        [
            Dome::new(DVec2::ZERO, HalfBall::round(55.0, 55.0), 1.0),
            Dome::new(DVec2::new(5.0, -3.0), HalfBall::round(60.0, 25.0), 0.6),
            Dome::new(DVec2::new(-8.0, 2.0), HalfBall::round(40.0, 70.0), 0.9),
        ]
    }

    /// The dome with another half-ball's image.
    fn reshaped(dome: &Dome, into: impl Fn(HalfBall) -> HalfBall) -> Dome {
        Dome { shape: into(dome.shape.half_ball().unwrap()).into(), ..dome.clone() }
    }

    /// Anatomical implants over a plane, two radii, a grid of heights.
    pub(in crate::contact) fn anatomical() -> [Dome; 4] {
        let heights = (0..41 * 41).map(|k| {
            let [x, y] = [k % 41, k / 41].map(|i| 5.0 * (f64::from(i) - 20.0));
            -x * x / 320.0 - y * y / 900.0 + 2.0 * (0.04 * x - 0.03 * y).sin()
        });
        let grid = Chest::Grid(HeightGrid::new(5.0, [41; 2], heights.collect()).unwrap());
        let radii = Chest::Curved { across_mm: 130.0, along_mm: 500.0 };
        let [first, second, third] = domes();
        [
            reshaped(&first, |shape| shape.anatomical(48.0, 20.0)),
            reshaped(&second, |shape| shape.anatomical(66.0, 18.0)),
            reshaped(&third, |shape| shape.anatomical(44.0, 12.0)).over(radii),
            reshaped(&first, |shape| shape.anatomical(62.0, 25.0)).over(grid),
        ]
    }

    /// Round and anatomical implants, leaner and fuller than half of an ellipsoid, and one of another shape.
    pub(in crate::contact) fn others() -> impl Iterator<Item = Dome> {
        let all = domes().into_iter().chain(anatomical());
        all.zip([0.55, 0.72, 0.8, 0.8, 0.6, 0.55, 0.75])
            .map(|(dome, fullness)| reshaped(&dome, |shape| shape.filled(fullness)))
            .chain([Dome::new(
                DVec2::new(3.0, 2.0),
                Superellipse { radius: 50.0, projection: 38.0 },
                0.9,
            )])
    }

    #[test]
    fn an_anatomical_dome_of_a_round_base_is_the_round_dome() {
        for dome in domes() {
            let radius = dome.reference_length();
            let anatomical = |along, shift| reshaped(&dome, |shape| shape.anatomical(along, shift));
            assert_eq!(anatomical(radius, 0.0), dome);
            assert!(dome.is_round() && !anatomical(radius, 1.0).is_round());
            assert!(!anatomical(radius + 1.0, 0.0).is_round());
        }
    }

    /// The area of the sections, integrated over the height by the tanh–sinh rule.
    #[test]
    fn the_volume_is_that_of_the_sections_to_rounding() {
        let anatomical = HalfBall::round(60.0, 35.0).anatomical(70.0, 20.0);
        let filled = [0.55, 0.58, 2.0 / 3.0, 0.72, 0.8].map(|fullness| {
            let shape = anatomical.filled(fullness);
            let closed = fullness * PI * 60.0 * 70.0 * 35.0;
            assert!((shape.volume() / closed - 1.0).abs() < 1e-15);
            Shape::from(shape)
        });
        let another = Superellipse { radius: 60.0, projection: 35.0 };
        for shape in filled.into_iter().chain([another.into()]) {
            let dome = Dome::new(DVec2::ZERO, shape, 1.0);
            let section = |share: f64| {
                let level = Dome { base_height: -share * dome.projection(), ..dome.clone() };
                PI * level.wall_axes().element_product()
            };
            let step = 1.0 / 64.0;
            let part = |k: i32| {
                let t = step * f64::from(k);
                let inner = FRAC_PI_2 * t.sinh();
                // (1 + tanh)/2 without cancellation.
                let share = 1.0 / (1.0 + (-2.0 * inner).exp());
                section(share) * 0.5 * FRAC_PI_2 * t.cosh() / inner.cosh().powi(2)
            };
            let volume = dome.projection() * step * (-220..=220).map(part).sum::<f64>();
            let error = volume / dome.volume() - 1.0;
            assert!(error.abs() < 1e-12, "{:?}: {error}", dome.shape);
        }
    }

    /// Midpoint rule over a box of 120³ points.
    #[test]
    fn draping_and_leaning_keep_the_volume() {
        for dome in anatomical().into_iter().chain(others()) {
            let dome = Dome { base_height: 0.0, ..dome };
            let half = DVec3::new(75.0, 100.0, 100.0);
            let step = half * 2.0 / 120.0;
            let at = |k: i32| f64::from(k) + 0.5;
            let points = (0..120_i32.pow(3)).map(|k| {
                dome.origin() - half
                    + step * DVec3::new(at(k % 120), at(k / 120 % 120), at(k / 14_400))
            });
            let inside = points.filter(|point| dome.contains(*point)).count();
            let ratio = inside as f64 * step.element_product() / dome.volume();
            assert!((ratio - 1.0).abs() < 2e-3, "{ratio}");
        }
    }

    #[test]
    fn gauges_and_half_axes_bound_distances() {
        for dome in domes().into_iter().chain(anatomical()).chain(others()) {
            let dome = dome.over(Chest::Flat);
            for point in dome.circles(20, 24) {
                let gradient = dome.gauge_gradient(point).length();
                assert!(gradient * dome.shape.greatest_length() > 0.989, "{gradient}");
                for away in [0.1, 2.0, 10.0, 50.0] {
                    let outside = point + dome.normal(point) * away + DVec3::Z * 0.2 * away;
                    let (distance, _) = dome.closest_point(outside);
                    let least = dome.least_distances()(outside);
                    assert!(least <= distance * (1.0 + 1e-9), "{least} {distance}");
                }
            }
        }
    }

    #[test]
    fn the_way_onto_a_level_is_no_longer_than_along_the_ray_and_a_few_times_the_nearest() {
        let flat = Dome::new(DVec2::new(3.0, 1.0), HalfBall::round(80.0, 2.4), 1.0);
        for dome in domes().into_iter().chain([flat]) {
            for k in 0..500 {
                let t = f64::from(k);
                let axes = dome.shape.half_axes();
                let share = DVec3::new((t * 0.7).sin(), (t * 1.3).cos(), (t * 0.17) % 1.0);
                let point = dome.origin() + axes * share * 0.7;
                for gauge in [0.0, 0.01] {
                    let moved = dome.project(point, gauge);
                    assert!((dome.gauge(moved) - gauge).abs() < 1e-12);
                    let ray =
                        (point - dome.origin()) * ((1.0 + gauge) / (1.0 + dome.gauge(point)) - 1.0);
                    let way = moved.distance(point);
                    assert!(way <= ray.length() * (1.0 + 1e-12));
                    if gauge == 0.0 {
                        let nearest = dome.closest_point(point).0.abs();
                        assert!(way <= 2.0 * nearest + 1e-9, "{way} of {nearest} at {point}");
                    }
                }
            }
        }
    }

    /// Surface area above the wall \[mm²\] (closed form for the hemisphere; else by Simpson's rule
    /// over the polar angle, relative error below 1e-9).
    fn area_above_wall(dome: &Dome) -> f64 {
        if dome.is_hemisphere() {
            return 2.0 * PI * dome.reference_length() * (dome.base_height + dome.projection());
        }
        let (r, p) = (dome.reference_length(), dome.projection());
        let last = dome.wall_angle();
        let ring = |angle: f64| {
            let (sin, cos) = angle.sin_cos();
            2.0 * PI * r * sin * (r * cos).hypot(p * sin)
        };
        let steps = 2000;
        let step = last / f64::from(steps);
        let weight = |k: i32| match k {
            0 => 1.0,
            k if k == steps => 1.0,
            k if k % 2 == 1 => 4.0,
            _ => 2.0,
        };
        (0..=steps).map(|k| weight(k) * ring(f64::from(k) * step)).sum::<f64>() * step / 3.0
    }

    #[test]
    fn areas_agree_with_closed_forms() {
        let cap = Dome::new(DVec2::ZERO, HalfBall::round(40.0, 40.0), 0.6);
        assert!((area_above_wall(&cap) - 2.0 * PI * 40.0 * 24.0).abs() < 1e-9);
        // Oblate half-spheroid: πR² (1 + (1−e²)/e · artanh e).
        let (r, p) = (60.0_f64, 25.0_f64);
        let e = (1.0 - (p / r).powi(2)).sqrt();
        let exact = PI * r * r * (1.0 + (1.0 - e * e) / e * e.atanh());
        let dome = Dome::new(DVec2::ZERO, HalfBall::round(r, p), 1.0);
        assert!((area_above_wall(&dome) / exact - 1.0).abs() < 1e-9);
        // Prolate: πR² (1 + p/(R e) · asin e).
        let (r, p) = (40.0_f64, 70.0_f64);
        let e = (1.0 - (r / p).powi(2)).sqrt();
        let exact = PI * r * r * (1.0 + p / (r * e) * e.asin());
        let dome = Dome::new(DVec2::ZERO, HalfBall::round(r, p), 1.0);
        assert!((area_above_wall(&dome) / exact - 1.0).abs() < 1e-9);
    }

    #[test]
    fn gradient_is_the_slope_of_the_level() {
        for dome in domes().into_iter().chain(anatomical()).chain(others()) {
            let point = dome.origin() + DVec3::new(13.0, -21.0, 34.0);
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let step = 1e-4;
                let slope = (dome.gauge(point + axis * step) - dome.gauge(point - axis * step))
                    / (2.0 * step);
                assert!((slope - dome.gauge_gradient(point).dot(axis)).abs() < 1e-9);
            }
        }
    }
}

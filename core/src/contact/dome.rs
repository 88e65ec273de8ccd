//! The implant: a half-ellipsoid of revolution, draped over the wall.
//!
//! (x²+y²)/R² + (z−z₀)²/p² = 1, z ≥ z₀, with z counted from the wall; a hemisphere over the plane when p = R. Insertion t raises the dome:
//! z₀ = (t − 1)·p, apex at t·p. The gauge √((x²+y²)/R² + (z−z₀)²/p²) − 1 is negative inside and zero on
//! the surface.

use super::half_ball::{HalfBall, Near};
use crate::mesh::Chest;
use crate::number::Real;
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Steps along the normal to the closest point over a curved wall: the error falls by distance over radius of curvature a step.
const MOST_FEET: usize = 20;

/// A dome in place. Lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dome {
    /// Centre of its base in the pocket \[mm\].
    pub center: DVec2,
    /// Base radius R \[mm\].
    pub base_radius: f64,
    /// Projection p \[mm\].
    pub projection: f64,
    /// Height z₀ of its base above the wall \[mm\], −p to 0.
    pub base_height: f64,
    /// The wall that the dome is draped over.
    pub chest: Chest,
}

impl Dome {
    /// A dome raised by `insertion` (0: its apex at the wall; 1: its base on the wall).
    #[must_use]
    pub fn new(center: DVec2, base_radius: f64, projection: f64, insertion: f64) -> Self {
        let base_height = (insertion - 1.0) * projection;
        Self { center, base_radius, projection, base_height, chest: Chest::Flat }
    }

    /// The dome draped over a wall.
    #[must_use]
    pub fn over(self, chest: Chest) -> Self {
        Self { chest, ..self }
    }

    /// Centre of the ellipsoid \[mm\].
    #[must_use]
    pub fn origin(&self) -> DVec3 {
        self.center.extend(self.chest.height(self.center) + self.base_height)
    }

    /// Point highest above the wall \[mm\].
    #[must_use]
    pub fn apex(&self) -> DVec3 {
        self.origin() + DVec3::Z * self.projection
    }

    /// Height of the apex above the wall \[mm\].
    #[must_use]
    pub fn top(&self) -> f64 {
        self.base_height + self.projection
    }

    /// Is it a hemisphere?
    #[must_use]
    pub fn is_hemisphere(&self) -> bool {
        (self.base_radius - self.projection).abs() <= 1e-9 * self.base_radius
    }

    /// Volume of the whole implant \[mm³\], ⅔πR²p.
    #[must_use]
    pub fn volume(&self) -> f64 {
        2.0 / 3.0 * PI * self.base_radius.powi(2) * self.projection
    }

    /// Radius of the circle in which the dome meets the wall \[mm\].
    #[must_use]
    pub fn wall_radius(&self) -> f64 {
        let height = self.base_height / self.projection;
        self.base_radius * (1.0 - height * height).max(0.0).sqrt()
    }

    /// The length that tolerances and errors are relative to \[mm\]: the base radius.
    #[must_use]
    pub fn reference_length(&self) -> f64 {
        self.base_radius
    }

    /// The dome in another unit of length.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            center: self.center * factor,
            base_radius: self.base_radius * factor,
            projection: self.projection * factor,
            base_height: self.base_height * factor,
            chest: self.chest.scaled(factor),
        }
    }

    /// The dome lowered until a part of its height is above the wall.
    pub(crate) fn lowered_to(&self, part: f64) -> Self {
        Self { base_height: self.base_height - (1.0 - part) * self.top(), ..*self }
    }

    /// The least half-axis \[mm\]: a point outside is no closer than this length times its gauge.
    #[must_use]
    pub fn least_half_axis(&self) -> f64 {
        self.base_radius.min(self.projection)
    }

    /// The greatest half-axis \[mm\]: no point of the surface moves further than this length times a change of the gauge.
    #[must_use]
    pub fn greatest_half_axis(&self) -> f64 {
        self.base_radius.max(self.projection)
    }

    /// Radius of curvature at the apex \[mm\].
    #[must_use]
    pub fn apex_radius(&self) -> f64 {
        self.base_radius * self.base_radius / self.projection
    }

    /// Radius of curvature of a meridian at the base \[mm\].
    #[must_use]
    pub fn base_curvature_radius(&self) -> f64 {
        self.projection * self.projection / self.base_radius
    }

    /// The shape in numbers of one precision.
    pub(crate) fn shape<R: Real>(&self) -> HalfBall<R> {
        let half_axes = [self.base_radius, self.base_radius, self.projection];
        let center = self.center.extend(self.base_height);
        HalfBall::new(center.to_array(), half_axes, self.chest.heights())
    }

    /// The gauge √((x²+y²)/R² + (z−z₀)²/p²) − 1 \[-\]: negative inside, zero on the surface.
    #[must_use]
    pub fn gauge(&self, point: DVec3) -> f64 {
        self.shape::<f64>().near(point.to_array()).length - 1.0
    }

    /// Gradient of [`Self::gauge`] \[1/mm\]; straight up at the ellipsoid's centre.
    #[must_use]
    pub fn gauge_gradient(&self, point: DVec3) -> DVec3 {
        self.gauge_and_gradient(point).1
    }

    /// [`Self::gauge`] and [`Self::gauge_gradient`] of one point.
    #[must_use]
    pub fn gauge_and_gradient(&self, point: DVec3) -> (f64, DVec3) {
        let Near { length, gradient, .. } = self.shape::<f64>().near(point.to_array());
        let upright = DVec3::new(0.0, 0.0, 1.0 / self.projection);
        (length - 1.0, if length > 0.0 { gradient.into() } else { upright })
    }

    /// Second derivative of [`Self::gauge`] \[1/mm²\].
    #[must_use]
    pub fn gauge_curvature(&self, point: DVec3) -> DMat3 {
        let shape: HalfBall<f64> = self.shape();
        let [xx, xy, xz, yy, yz, zz] = shape.curvature(&shape.near(point.to_array()));
        DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz])
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
    /// ellipsoid's centre or upright, whichever is the shorter way.
    #[must_use]
    pub fn project(&self, point: DVec3, gauge: f64) -> DVec3 {
        let shape: HalfBall<f64> = self.shape();
        let near = shape.near(point.to_array());
        if near.length < 1e-12 {
            return self.apex();
        }
        point + DVec3::from(shape.way_to(&near, 1.0 + gauge))
    }

    /// Is it its own image mirrored along x, along y, about the pocket's centre?
    #[must_use]
    pub fn mirrored(&self) -> [bool; 2] {
        self.center.to_array().map(|c| c == 0.0)
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
        let (dome, shape, unit) = (*self, self.shape::<f64>(), self.base_radius);
        move |point| {
            // Most points need no root.
            if shape.length_squared(point.to_array()) >= 1.0 {
                return false;
            }
            let Near { length, gradient, .. } = shape.near(point.to_array());
            let steepness = DVec3::from(gradient).length() * unit;
            dome.is_above_base(point) && 1.0 - length > fraction * steepness.min(1.0)
        }
    }

    /// The meridian at a polar angle of the ellipse's parameter, 0 at the apex: distance from the axis and height
    /// above the wall \[mm\].
    #[must_use]
    pub fn meridian(&self, angle: f64) -> DVec2 {
        DVec2::new(self.base_radius * angle.sin(), self.base_height + self.projection * angle.cos())
    }

    /// Points of the surface \[mm\]: circles from the apex, itself one, to the wall at equal steps of the parameter
    /// of [`Self::meridian`], each counter-clockwise from the direction of x.
    pub fn circles(&self, count: usize, around: usize) -> impl Iterator<Item = DVec3> {
        let turn = |step: usize| DVec2::from_angle(TAU * step as f64 / around as f64);
        let directions: Vec<DVec2> = (0..around).map(turn).collect();
        let (dome, last) = (*self, self.wall_angle());
        (0..=count).flat_map(move |circle| {
            let meridian = dome.meridian(last * circle as f64 / count as f64);
            let point = |across: &DVec2| {
                let place = dome.center + meridian.x * *across;
                place.extend(dome.chest.height(place) + meridian.y)
            };
            directions.iter().map(point).collect::<Vec<DVec3>>()
        })
    }

    /// Height of the surface above the wall \[mm\] at a horizontal position, zero beside the dome.
    #[must_use]
    pub fn height(&self, position: DVec2) -> f64 {
        let across = (position - self.center) / self.base_radius;
        let upright = (1.0 - across.length_squared()).max(0.0).sqrt();
        (self.base_height + self.projection * upright).max(0.0)
    }

    /// The dome's outline in the plane of a given y at a parameter from 0 (greatest x) to π: x and height above the
    /// wall \[mm\].
    #[must_use]
    pub fn outline(&self, y: f64, angle: f64) -> DVec2 {
        let offset = (y - self.center.y) / self.base_radius;
        let scale = (1.0 - offset * offset).max(0.0).sqrt();
        DVec2::new(
            self.center.x + scale * self.base_radius * angle.cos(),
            self.base_height + scale * self.projection * angle.sin(),
        )
    }

    /// Distance along a ray to the surface \[lengths of `direction`\], negative behind the origin.
    #[must_use]
    pub fn ray_distance(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let axes = DVec3::new(self.base_radius, self.base_radius, self.projection);
        let (from, along) = ((origin - self.origin()) / axes, direction / axes);
        let (a, b, c) = (along.length_squared(), from.dot(along), from.length_squared() - 1.0);
        let discriminant = b * b - a * c;
        (discriminant >= 0.0).then(|| (-b - discriminant.sqrt()) / a)
    }

    /// The parameter of [`Self::meridian`] where the dome meets the wall \[rad\].
    #[must_use]
    pub fn wall_angle(&self) -> f64 {
        (-self.base_height / self.projection).clamp(0.0, 1.0).acos()
    }

    /// Signed distance to the surface \[mm\] (negative inside) and the closest point of it, over a curved wall by repeated
    /// steps along the normal.
    ///
    /// The closest point of an ellipse, by Newton's method kept in its bracket (D. Eberly,
    /// "Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid", 2013).
    #[must_use]
    pub fn closest_point(&self, point: DVec3) -> (f64, DVec3) {
        if self.chest != Chest::Flat {
            let mut foot = self.onto_surface(point);
            for _ in 0..MOST_FEET {
                let normal = self.normal(foot);
                foot = self.onto_surface(point - normal * normal.dot(point - foot));
            }
            return (point.distance(foot).copysign(self.gauge(point)), foot);
        }
        let d = point - self.origin();
        let radial = d.truncate().length();
        let across = if radial > 0.0 { d.truncate() / radial } else { DVec2::X };
        let foot = closest_on_ellipse(
            DVec2::new(self.base_radius, self.projection),
            DVec2::new(radial, d.z.abs()),
        );
        let closest = self.origin() + (across * foot.x).extend(foot.y.copysign(d.z));
        (point.distance(closest).copysign(self.gauge(point)), closest)
    }
}

/// Closest point of the ellipse with the given half axes to a point of the first quadrant.
fn closest_on_ellipse(axes: DVec2, point: DVec2) -> DVec2 {
    // With the longer half axis first.
    let swap = axes.y > axes.x;
    let order = |v: DVec2| if swap { DVec2::new(v.y, v.x) } else { v };
    let (e, y) = (order(axes), order(point));
    if y.y <= 0.0 {
        // On the long axis: the foot leaves the axis inside the evolute.
        let numerator = e.x * y.x;
        let denominator = e.x * e.x - e.y * e.y;
        if numerator < denominator {
            let c = numerator / denominator;
            return order(DVec2::new(e.x * c, e.y * (1.0 - c * c).sqrt()));
        }
        return order(DVec2::new(e.x, 0.0));
    }
    if y.x <= 0.0 {
        return order(DVec2::new(0.0, e.y));
    }
    // Root of (e0 y0/(t+e0²))² + (e1 y1/(t+e1²))² = 1, decreasing and convex right of −e1²: Newton
    // steps from the left rise towards it and never pass it.
    let mut t = (e.y * (y.y - e.y)).max(e.x * (y.x - e.x));
    for _ in 0..100 {
        let (a, b) = (t + e.x * e.x, t + e.y * e.y);
        let (u, v) = ((e.x * y.x / a).powi(2), (e.y * y.y / b).powi(2));
        let next = t + 0.5 * (u + v - 1.0) / (u / a + v / b);
        if next <= t {
            break;
        }
        t = next;
    }
    order(DVec2::new(e.x * e.x * y.x / (t + e.x * e.x), e.y * e.y * y.y / (t + e.y * e.y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn domes() -> [Dome; 3] {
        [
            Dome::new(DVec2::ZERO, 55.0, 55.0, 1.0),
            Dome::new(DVec2::new(5.0, -3.0), 60.0, 25.0, 0.6),
            Dome::new(DVec2::new(-8.0, 2.0), 40.0, 70.0, 0.9),
        ]
    }

    #[test]
    fn the_closest_point_lies_on_the_surface_along_its_normal() {
        for dome in domes() {
            for k in 0..500 {
                let t = f64::from(k);
                let point = dome.origin()
                    + DVec3::new(90.0 * (t * 0.7).sin(), 80.0 * (t * 1.3).cos(), (t * 0.17) % 95.0);
                let (distance, closest) = dome.closest_point(point);
                assert!(dome.gauge(closest).abs() < 1e-9);
                assert_eq!(distance < 0.0, dome.gauge(point) < 0.0);
                let along = (point - closest).cross(dome.normal(closest)).length();
                assert!(along < 1e-6, "{along} at {point}");
                // No sampled point of the surface is closer.
                for j in 0..60 {
                    let (a, b) = (f64::from(j) * 0.4, f64::from(j) * 0.026);
                    let other = dome.onto_surface(
                        dome.origin() + DVec3::new(a.cos() * b.sin(), a.sin() * b.sin(), b.cos()),
                    );
                    assert!(point.distance(other) >= distance.abs() - 1e-9);
                }
            }
        }
    }

    #[test]
    fn the_way_onto_a_level_is_no_longer_than_along_the_ray_and_a_few_times_the_nearest() {
        let flat = Dome::new(DVec2::new(3.0, 1.0), 80.0, 2.4, 1.0);
        for dome in domes().into_iter().chain([flat]) {
            for k in 0..500 {
                let t = f64::from(k);
                let axes = DVec3::new(dome.base_radius, dome.base_radius, dome.projection);
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
            return 2.0 * PI * dome.base_radius * (dome.base_height + dome.projection);
        }
        let (r, p) = (dome.base_radius, dome.projection);
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
        let cap = Dome::new(DVec2::ZERO, 40.0, 40.0, 0.6);
        assert!((area_above_wall(&cap) - 2.0 * PI * 40.0 * 24.0).abs() < 1e-9);
        // Oblate half-spheroid: πR² (1 + (1−e²)/e · artanh e).
        let (r, p) = (60.0_f64, 25.0_f64);
        let e = (1.0 - (p / r).powi(2)).sqrt();
        let exact = PI * r * r * (1.0 + (1.0 - e * e) / e * e.atanh());
        let dome = Dome::new(DVec2::ZERO, r, p, 1.0);
        assert!((area_above_wall(&dome) / exact - 1.0).abs() < 1e-9);
        // Prolate: πR² (1 + p/(R e) · asin e).
        let (r, p) = (40.0_f64, 70.0_f64);
        let e = (1.0 - (r / p).powi(2)).sqrt();
        let exact = PI * r * r * (1.0 + p / (r * e) * e.asin());
        let dome = Dome::new(DVec2::ZERO, r, p, 1.0);
        assert!((area_above_wall(&dome) / exact - 1.0).abs() < 1e-9);
    }

    #[test]
    fn gradient_is_the_slope_of_the_level() {
        for dome in domes() {
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

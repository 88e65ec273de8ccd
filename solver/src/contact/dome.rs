//! The implant: a half-ball's image, draped over the wall.
//!
//! x²/a² + (y + σz)²/b² + z²/p² ≤ 1, z from 0 to p counted from the base, from the wall up: half-axes a across and b along the body,
//! projection p, and a shear σ that moves the apex towards −y, the feet. Round: a = b and σ = 0, a half-ellipsoid of revolution, a
//! hemisphere over the plane when p = a. Draping keeps volume and heights. Insertion t raises the dome: its base is at z₀ = (t − 1)·p, its
//! apex at t·p. A fullness f other than ⅔ has (z/p)^m in place of z²/p², m = f/(1 − f), and the volume fπabp ([`Fullness`]).
//! The gauge is the square root of the left side less one: negative inside and zero on the surface.
//!
//! [`Fullness`]: super::fullness::Fullness

use super::fullness::LEAST_OF_CONTACT;
use super::fullness::{HALF_ELLIPSOID, dome_volume};
use super::half_ball::{HalfBall, Near};
use crate::mesh::Chest;
use crate::number::Real;
use glam::{DMat3, DVec2, DVec3};

/// Greatest gradient of the gauge of a dome leaner than half of an ellipsoid by that of the half-ellipsoid, near the base \[-\].
const LEAN: f64 = 1.04;

/// A dome in place. Lengths in mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Dome {
    /// Centre of its base in the pocket \[mm\].
    pub center: DVec2,
    /// Half-axis a of the base across the body \[mm\]; of a round implant the base radius.
    pub base_radius: f64,
    /// Half-axis b of the base along the body \[mm\].
    pub base_along: f64,
    /// Way of the apex towards −y \[mm\].
    pub apex_shift: f64,
    /// Projection p \[mm\].
    pub projection: f64,
    /// Volume by πabp \[-\].
    pub fullness: f64,
    /// Height z₀ of its base above the wall \[mm\], −p to 0.
    pub base_height: f64,
    /// The wall that the dome is draped over.
    pub chest: Chest,
}

impl Dome {
    /// A round dome raised by `insertion` (0: its apex at the wall; 1: its base on the wall).
    #[must_use]
    pub fn new(center: DVec2, base_radius: f64, projection: f64, insertion: f64) -> Self {
        Self {
            center,
            base_radius,
            base_along: base_radius,
            apex_shift: 0.0,
            projection,
            fullness: HALF_ELLIPSOID,
            base_height: (insertion - 1.0) * projection,
            chest: Chest::Flat,
        }
    }

    /// The dome draped over a wall.
    #[must_use]
    pub fn over(self, chest: Chest) -> Self {
        Self { chest, ..self }
    }

    /// The dome with another half-axis along the body and its apex moved towards −y \[mm\].
    #[must_use]
    pub fn anatomical(self, base_along: f64, apex_shift: f64) -> Self {
        Self { base_along, apex_shift, ..self }
    }

    /// The dome with another fullness \[-\].
    #[must_use]
    pub fn filled(self, fullness: f64) -> Self {
        Self { fullness, ..self }
    }

    /// The exponent m of its heights; `None` for half of an ellipsoid.
    pub(crate) fn exponent(&self) -> Option<f64> {
        let is_other = (self.fullness - HALF_ELLIPSOID).abs() > 1e-9;
        is_other.then(|| self.fullness / (1.0 - self.fullness))
    }

    /// m/2: the slope of the half-ball's height by the dome's at the apex \[-\].
    fn steepness(&self) -> f64 {
        self.exponent().map_or(1.0, |exponent| 0.5 * exponent)
    }

    /// Is the dome a solid of revolution?
    #[must_use]
    pub fn is_round(&self) -> bool {
        let apart = (self.base_radius - self.base_along).abs().max(self.apex_shift.abs());
        apart <= 1e-9 * self.base_radius
    }

    /// Way of the axis along y per height \[-\].
    pub(super) fn lean(&self) -> f64 {
        -self.apex_shift / self.projection
    }

    /// Place of the axis, from the middle of the base to the apex, at a height above the wall \[mm\].
    #[must_use]
    pub fn axis(&self, height: f64) -> DVec2 {
        self.center + DVec2::new(0.0, self.lean() * (height - self.base_height))
    }

    /// Centre of its base \[mm\].
    #[must_use]
    pub fn origin(&self) -> DVec3 {
        self.center.extend(self.chest.height(self.center) + self.base_height)
    }

    /// Point highest above the wall \[mm\].
    #[must_use]
    pub fn apex(&self) -> DVec3 {
        let place = self.center - DVec2::new(0.0, self.apex_shift);
        let base = place.extend(self.chest.height(place) + self.base_height);
        base + DVec3::Z * self.projection
    }

    /// Height of the apex above the wall \[mm\].
    #[must_use]
    pub fn top(&self) -> f64 {
        self.base_height + self.projection
    }

    /// Is it a hemisphere?
    #[must_use]
    pub fn is_hemisphere(&self) -> bool {
        self.is_round()
            && self.exponent().is_none()
            && (self.base_radius - self.projection).abs() <= 1e-9 * self.base_radius
    }

    /// Volume of the whole implant \[mm³\] ([`dome_volume`]).
    #[must_use]
    pub fn volume(&self) -> f64 {
        dome_volume([self.base_radius, self.base_along, self.projection], self.fullness)
    }

    /// Radius of the circle in which the dome meets the wall \[mm\]; of an ellipse its least half-axis.
    #[must_use]
    pub fn wall_radius(&self) -> f64 {
        self.wall_axes().min_element()
    }

    /// Half-axes of the ellipse in which the dome meets the wall \[mm\].
    #[must_use]
    pub fn wall_axes(&self) -> DVec2 {
        let height = self.base_height / self.projection;
        let reach = match self.exponent() {
            Some(exponent) => reach_at(height.abs(), exponent),
            None => (1.0 - height * height).max(0.0).sqrt(),
        };
        self.base_axes() * reach
    }

    /// The length that tolerances and errors are relative to \[mm\]: the base radius, the half-axis across of any implant.
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
            base_along: self.base_along * factor,
            apex_shift: self.apex_shift * factor,
            projection: self.projection * factor,
            fullness: self.fullness,
            base_height: self.base_height * factor,
            chest: self.chest.scaled(factor),
        }
    }

    /// The dome lowered until a part of its height is above the wall.
    pub(crate) fn lowered_to(&self, part: f64) -> Self {
        let base_height = self.base_height - (1.0 - part) * self.top();
        Self { base_height, ..self.clone() }
    }

    /// The least half-axis \[mm\], of another fullness less: over the plane a point outside, not above the apex, is no closer than this length
    /// times its gauge.
    #[must_use]
    pub fn least_half_axis(&self) -> f64 {
        let least = self.half_axes().into_iter().fold(f64::INFINITY, f64::min);
        least / self.exponent().map_or(1.0, |exponent| (0.5 * exponent).max(LEAN))
    }

    /// The greatest half-axis \[mm\], of a lean dome more: over the plane no point of the surface moves further than this length times a
    /// change of the gauge, of a full dome than 1.01 times that.
    #[must_use]
    pub fn greatest_half_axis(&self) -> f64 {
        self.half_axes().into_iter().fold(0.0, f64::max) / self.steepness().min(1.0)
    }

    /// A distance \[mm\] that a point outside is at least away, over the plane; no root but the gauge's.
    #[must_use]
    pub fn least_distance(&self, point: DVec3) -> f64 {
        if self.steepness() <= 1.0 {
            return self.gauge(point) * self.least_half_axis();
        }
        // The gauge of a full dome grows without limit above the apex, and the half-space below the apex contains the dome.
        let over = (point.z - self.chest.height(point.truncate()) - self.top()).max(0.0);
        (self.gauge(point - DVec3::Z * over) * self.least_half_axis()).max(over)
    }

    /// Half-axes of half of an ellipsoid of this base and projection: stretches of the half-ball's map.
    fn half_axes(&self) -> [f64; 3] {
        let (b, p, shift) = (self.base_along, self.projection, self.apex_shift);
        if shift == 0.0 {
            return [self.base_radius, b, p];
        }
        let (sum, difference) = (shift.hypot(b + p), shift.hypot(b - p));
        [self.base_radius, 0.5 * (sum + difference), 0.5 * (sum - difference)]
    }

    /// Least radius of curvature at the apex over the plane \[mm\].
    #[must_use]
    pub fn apex_radius(&self) -> f64 {
        let across = self.base_radius.min(self.base_along);
        across * across / self.projection * self.steepness()
    }

    /// Least radius of curvature at the base of the sections along and across the body, over the plane \[mm\]; of another fullness
    /// the height at which, as on a circle of that radius, the section has turned from the vertical by 1 rad to first order.
    #[must_use]
    pub fn base_curvature_radius(&self) -> f64 {
        let p = self.projection;
        let [across, along] =
            [self.base_radius, self.base_along].map(|axis| match self.exponent() {
                Some(m) => p * (p / (0.5 * m * axis)).powf(1.0 / (m - 1.0)),
                None => p * p / axis,
            });
        across.min(along * (1.0 + self.lean() * self.lean()).powf(1.5))
    }

    /// The shape in numbers of one precision.
    pub(crate) fn shape<R: Real>(&self) -> HalfBall<R> {
        let half_axes = [self.base_radius, self.base_along, self.projection];
        let center = self.center.extend(self.base_height);
        let wall = self.chest.heights();
        let shape = HalfBall::new(center.to_array(), half_axes, self.apex_shift, wall);
        match self.exponent() {
            Some(exponent) => shape.with_exponent(exponent),
            None => shape,
        }
    }

    /// The gauge \[-\]: negative inside, zero on the surface.
    #[must_use]
    pub fn gauge(&self, point: DVec3) -> f64 {
        self.shape::<f64>().near(point.to_array()).length - 1.0
    }

    /// Gradient of [`Self::gauge`] \[1/mm\]; straight up at the centre of the base.
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
        self.curvature_from(point, 0.0)
    }

    /// [`Self::gauge_curvature`] for the Hessian of contact: bounded at the rim of a lean dome.
    pub(super) fn contact_curvature(&self, point: DVec3) -> DMat3 {
        self.curvature_from(point, LEAST_OF_CONTACT)
    }

    fn curvature_from(&self, point: DVec3, least: f64) -> DMat3 {
        let shape: HalfBall<f64> = self.shape();
        let [xx, xy, xz, yy, yz, zz] = shape.curvature(&shape.near(point.to_array()), least);
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
    /// centre of the base, of another fullness along its image, or along the axis, whichever is the shorter way.
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
        [self.center.x == 0.0, self.center.y == 0.0 && self.apex_shift == 0.0]
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
        let (dome, shape, unit) = (self.clone(), self.shape::<f64>(), self.base_radius);
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
}

/// Radius of the section at a height \[projection\], of an exponent of the heights \[base's\].
pub(super) fn reach_at(height: f64, exponent: f64) -> f64 {
    (1.0 - height.powf(exponent)).max(0.0).sqrt()
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::mesh::HeightGrid;
    use std::f64::consts::{FRAC_PI_2, PI};

    pub(in crate::contact) fn domes() -> [Dome; 3] {
        [
            Dome::new(DVec2::ZERO, 55.0, 55.0, 1.0),
            Dome::new(DVec2::new(5.0, -3.0), 60.0, 25.0, 0.6),
            Dome::new(DVec2::new(-8.0, 2.0), 40.0, 70.0, 0.9),
        ]
    }

    /// Anatomical implants over a plane, two radii, a grid of heights.
    pub(in crate::contact) fn anatomical() -> [Dome; 4] {
        let heights = (0..41 * 41).map(|k| {
            let [x, y] = [k % 41, k / 41].map(|i| 5.0 * (f64::from(i) - 20.0));
            -x * x / 320.0 - y * y / 900.0 + 2.0 * (0.04 * x - 0.03 * y).sin()
        });
        let grid = Chest::Grid(HeightGrid::new(5.0, [41; 2], heights.collect()).unwrap());
        let radii = Chest::Curved { across_mm: 130.0, along_mm: 500.0 };
        let of = |chest: Chest, dome: Dome| Dome { chest, ..dome };
        let [first, second, third] = domes();
        [
            first.clone().anatomical(48.0, 20.0),
            second.anatomical(66.0, 18.0),
            of(radii, third.anatomical(44.0, 12.0)),
            of(grid, first.anatomical(62.0, 25.0)),
        ]
    }

    /// Round and anatomical implants, leaner and fuller than half of an ellipsoid.
    pub(in crate::contact) fn filled() -> impl Iterator<Item = Dome> {
        let all = domes().into_iter().chain(anatomical());
        all.zip([0.55, 0.72, 0.8, 0.8, 0.6, 0.55, 0.75])
            .map(|(dome, fullness)| dome.filled(fullness))
    }

    #[test]
    fn an_anatomical_dome_of_a_round_base_is_the_round_dome() {
        for dome in domes() {
            let radius = dome.base_radius;
            assert_eq!(dome.clone().anatomical(radius, 0.0), dome);
            assert!(dome.is_round() && !dome.clone().anatomical(radius, 1.0).is_round());
            assert!(!dome.anatomical(radius + 1.0, 0.0).is_round());
        }
    }

    /// Midpoint rule over a box of 120³ points.
    /// The area of the sections, integrated over the height by the tanh–sinh rule.
    #[test]
    fn the_volume_is_that_of_the_sections_to_rounding() {
        for fullness in [0.55, 0.58, 2.0 / 3.0, 0.72, 0.8] {
            let dome =
                Dome::new(DVec2::ZERO, 60.0, 35.0, 1.0).anatomical(70.0, 20.0).filled(fullness);
            let section = |share: f64| {
                let level = Dome { base_height: -share * dome.projection, ..dome.clone() };
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
            let volume = dome.projection * step * (-220..=220).map(part).sum::<f64>();
            let closed = fullness * PI * 60.0 * 70.0 * 35.0;
            assert!((dome.volume() / closed - 1.0).abs() < 1e-15);
            let error = volume / closed - 1.0;
            assert!(error.abs() < 1e-12, "{fullness}: {error}");
        }
    }

    #[test]
    fn draping_and_leaning_keep_the_volume() {
        for dome in anatomical().into_iter().chain(filled()) {
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
        for dome in domes().into_iter().chain(anatomical()).chain(filled()) {
            let dome = dome.over(Chest::Flat);
            for point in dome.circles(20, 24) {
                let gradient = dome.gauge_gradient(point).length();
                assert!(gradient * dome.greatest_half_axis() > 0.989, "{gradient}");
                for away in [0.1, 2.0, 10.0, 50.0] {
                    let outside = point + dome.normal(point) * away + DVec3::Z * 0.2 * away;
                    let (distance, _) = dome.closest_point(outside);
                    let least = dome.least_distance(outside);
                    assert!(least <= distance * (1.0 + 1e-9), "{least} {distance}");
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
        for dome in domes().into_iter().chain(anatomical()).chain(filled()) {
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

//! A shape of the tests: a solid of revolution whose meridian is the superellipse (r/a)⁴ + (z/p)⁴ = 1.

use super::traits::{Gauge, Geometry};
use crate::mesh::vec3::{Block, dot};
use crate::number::Real;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

/// Volume by πa²p: the integral of √(1 − t⁴) from 0 to 1.
const FULLNESS: f64 = 0.874_019_184_764_04;
/// Lengths below which a point counts as the centre.
const LEAST_LENGTH: f64 = 1e-6;
/// Steps of Newton's method along a direction.
const STEPS_ALONG: usize = 4;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Superellipse {
    pub(crate) radius: f64,
    pub(crate) projection: f64,
}

impl Superellipse {
    pub(super) fn scaled(self, factor: f64) -> Self {
        Self { radius: self.radius * factor, projection: self.projection * factor }
    }

    pub(super) fn gauge<R: Real>(self) -> SuperellipseGauge<R> {
        let per = [self.radius, self.radius, self.projection];
        SuperellipseGauge { per_axis: per.map(|axis| R::splat(1.0 / axis)) }
    }
}

impl Geometry for Superellipse {
    fn half_axes(&self) -> DVec3 {
        DVec3::new(self.radius, self.radius, self.projection)
    }

    fn volume(&self) -> f64 {
        FULLNESS * PI * self.radius * self.radius * self.projection
    }

    fn is_round(&self) -> bool {
        true
    }

    fn mirrored(&self) -> [bool; 2] {
        [true; 2]
    }

    fn reach(&self, angle: f64, direction: DVec2) -> DVec2 {
        // 1 − cos⁴ without cancellation.
        let sin = angle.sin().powi(2);
        direction * self.radius * (sin * (2.0 - sin)).sqrt().sqrt()
    }

    /// The ball of the half-axes lies inside of the shape, whose corner is 2^¼ times as far.
    fn least_length(&self) -> f64 {
        self.radius.min(self.projection)
    }

    fn greatest_length(&self) -> f64 {
        self.radius.hypot(self.projection)
    }

    /// The meridian is flat at the apex.
    fn apex_radius(&self) -> f64 {
        f64::INFINITY
    }

    fn rim_radius(&self) -> f64 {
        f64::INFINITY
    }
}

#[derive(Clone, Debug)]
pub(crate) struct SuperellipseGauge<R> {
    per_axis: [R; 3],
}

impl<R: Real> SuperellipseGauge<R> {
    /// The place in the body of unit lengths, ρ² and ζ².
    #[inline(always)]
    fn source(&self, at: [R; 3]) -> ([R; 3], [R; 2]) {
        let s = [0, 1, 2].map(|axis| at[axis] * self.per_axis[axis]);
        (s, [s[0] * s[0] + s[1] * s[1], s[2] * s[2]])
    }
}

impl<R: Real> Gauge<R> for SuperellipseGauge<R> {
    #[inline(always)]
    fn length_squared(&self, at: [R; 3]) -> R {
        let (_, squares) = self.source(at);
        (squares[0] * squares[0] + squares[1] * squares[1]).sqrt()
    }

    #[inline(always)]
    fn length(&self, at: [R; 3]) -> (R, [R; 3]) {
        let (s, [across, up]) = self.source(at);
        let length = self.length_squared(at).sqrt();
        let least = length.max(R::splat(LEAST_LENGTH));
        let per = R::splat(1.0) / (least * least * least);
        let pulls = [across, across, up];
        (length, [0, 1, 2].map(|axis| pulls[axis] * s[axis] * per * self.per_axis[axis]))
    }

    /// 3 (∇½L² of the squares) / L³ − 3 g gᵀ / L.
    #[inline(always)]
    fn curvature(&self, at: [R; 3], length: R, g: [R; 3], _least: f64) -> Block<R> {
        let (s, [across, up]) = self.source(at);
        let least = length.max(R::splat(LEAST_LENGTH));
        let (two, three) = (R::splat(2.0), R::splat(3.0));
        let per = R::splat(1.0) / (least * least * least);
        let [a, b, p] = self.per_axis;
        let of_gradient = three / least;
        [
            (across + two * s[0] * s[0]) * per * a * a - g[0] * g[0] * of_gradient,
            two * s[0] * s[1] * per * a * b - g[0] * g[1] * of_gradient,
            -g[0] * g[2] * of_gradient,
            (across + two * s[1] * s[1]) * per * b * b - g[1] * g[1] * of_gradient,
            -g[1] * g[2] * of_gradient,
            three * up * per * p * p - g[2] * g[2] * of_gradient,
        ]
    }

    #[inline(always)]
    fn distance_along(&self, at: [R; 3], direction: [R; 3], length: R) -> R {
        let most = R::splat(1.0) / self.length_squared(direction).sqrt().max(R::splat(1e-20));
        let mut factor = R::splat(0.0);
        for _ in 0..STEPS_ALONG {
            let (own, gradient) = self.length([0, 1, 2].map(|k| at[k] + direction[k] * factor));
            let step = (own - length) / dot(gradient, direction).max(R::splat(1e-20));
            factor = factor - step.max(-most).min(most);
        }
        factor
    }

    #[inline(always)]
    fn way_to(&self, at: [R; 3], length: R, to: R) -> [R; 3] {
        let zero = R::splat(0.0);
        let (_, [across, _]) = self.source(at);
        let ray = (to - length) / length.max(R::splat(LEAST_LENGTH));
        let height = to * to * to * to - across * across;
        let upright = height.max(zero).sqrt().sqrt() / self.per_axis[2] - at[2];
        let most = R::select(height.is_above(zero), ray * ray * dot(at, at), zero);
        let is_upright = most.is_above(upright * upright);
        let along = |k: usize| R::select(is_upright, zero, at[k] * ray);
        [along(0), along(1), R::select(is_upright, upright, at[2] * ray)]
    }
}

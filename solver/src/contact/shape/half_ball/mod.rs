//! A half-ball's image: round and anatomical implants of any fullness.
//!
//! x²/a² + (y + σz)²/b² + z²/p² ≤ 1, z from 0 to p counted from the base: half-axes a across and b along the body, projection p, and a shear σ
//! that moves the apex towards −y, the feet. Round: a = b and σ = 0, a half-ellipsoid of revolution, a hemisphere when p = a. A fullness f
//! other than ⅔ has (z/p)^m in place of z²/p², m = f/(1 − f), and the volume fπabp. The gauge is the square root of the left side less one.
//!
//! `gauge` | `fullness` (its map of heights).

mod fullness;
mod gauge;

use super::traits::Geometry;
use crate::number::Real;
pub(crate) use gauge::HalfBallGauge;
use glam::{DMat3, DVec2, DVec3};
use std::f64::consts::PI;

/// Fullness of half of an ellipsoid \[-\].
pub const HALF_ELLIPSOID: f64 = 2.0 / 3.0;
/// Greatest gradient of the gauge of a dome leaner than half of an ellipsoid by that of the half-ellipsoid, near the base \[-\].
const LEAN: f64 = 1.04;

/// A half-ball's image. Lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HalfBall {
    /// Half-axes a and b of the base and projection p.
    half_axes: DVec3,
    /// Way of the apex towards −y.
    apex_shift: f64,
    /// Volume by πabp \[-\].
    fullness: f64,
}

impl HalfBall {
    /// Half of an ellipsoid of revolution.
    #[must_use]
    pub fn round(base_radius: f64, projection: f64) -> Self {
        let half_axes = DVec3::new(base_radius, base_radius, projection);
        Self { half_axes, apex_shift: 0.0, fullness: HALF_ELLIPSOID }
    }

    /// The shape with another half-axis along the body and its apex moved towards −y \[mm\].
    #[must_use]
    pub fn anatomical(self, base_along: f64, apex_shift: f64) -> Self {
        Self { half_axes: self.half_axes.with_y(base_along), apex_shift, ..self }
    }

    /// The shape with another fullness \[-\].
    #[must_use]
    pub fn filled(self, fullness: f64) -> Self {
        Self { fullness, ..self }
    }

    /// The shape in another unit of length.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        let (half_axes, apex_shift) = (self.half_axes * factor, self.apex_shift * factor);
        Self { half_axes, apex_shift, ..self }
    }

    /// The exponent m of its heights; `None` for half of an ellipsoid.
    fn exponent(&self) -> Option<f64> {
        let is_other = (self.fullness - HALF_ELLIPSOID).abs() > 1e-9;
        is_other.then(|| self.fullness / (1.0 - self.fullness))
    }

    pub(crate) fn gauge<R: Real>(&self) -> HalfBallGauge<R> {
        HalfBallGauge::new(self.half_axes.to_array(), self.apex_shift, self.exponent())
    }

    /// m/2: the slope of the half-ball's height by the dome's at the apex \[-\].
    fn steepness(&self) -> f64 {
        self.exponent().map_or(1.0, |exponent| 0.5 * exponent)
    }

    /// Way of the axis along y per height \[-\].
    fn lean(&self) -> f64 {
        -self.apex_shift / self.half_axes.z
    }

    /// Stretches of the map from the half-ball to half of an ellipsoid of this base and projection.
    fn stretches(&self) -> [f64; 3] {
        let (DVec3 { x: a, y: b, z: p }, shift) = (self.half_axes, self.apex_shift);
        if shift == 0.0 {
            return [a, b, p];
        }
        let (sum, difference) = (shift.hypot(b + p), shift.hypot(b - p));
        [a, 0.5 * (sum + difference), 0.5 * (sum - difference)]
    }
}

impl Geometry for HalfBall {
    fn half_axes(&self) -> DVec3 {
        self.half_axes
    }

    fn volume(&self) -> f64 {
        let DVec3 { x: a, y: b, z: p } = self.half_axes;
        self.fullness * PI * (a * b) * p
    }

    fn apex(&self) -> DVec3 {
        DVec3::new(0.0, -self.apex_shift, self.half_axes.z)
    }

    fn axis(&self, height: f64) -> DVec2 {
        DVec2::new(0.0, self.lean() * height)
    }

    fn is_round(&self) -> bool {
        let DVec3 { x: a, y: b, .. } = self.half_axes;
        (a - b).abs().max(self.apex_shift.abs()) <= 1e-9 * a
    }

    fn mirrored(&self) -> [bool; 2] {
        [true, self.apex_shift == 0.0]
    }

    fn onto_ball(&self) -> Option<DMat3> {
        let shear = DMat3::from_cols(DVec3::X, DVec3::Y, DVec3::new(0.0, -self.lean(), 1.0));
        let map = DMat3::from_diagonal(self.half_axes.recip()) * shear;
        self.exponent().is_none().then_some(map)
    }

    fn reach(&self, angle: f64, direction: DVec2) -> DVec2 {
        let share = match self.exponent() {
            Some(exponent) => (1.0 - angle.cos().max(0.0).powf(exponent)).max(0.0).sqrt(),
            None => angle.sin(),
        };
        self.half_axes.truncate() * share * direction
    }

    fn least_length(&self) -> f64 {
        let least = self.stretches().into_iter().fold(f64::INFINITY, f64::min);
        least / self.exponent().map_or(1.0, |exponent| (0.5 * exponent).max(LEAN))
    }

    fn greatest_length(&self) -> f64 {
        self.stretches().into_iter().fold(0.0, f64::max) / self.steepness().min(1.0)
    }

    /// Of a full dome.
    fn outgrows_distance(&self) -> bool {
        self.steepness() > 1.0
    }

    fn apex_radius(&self) -> f64 {
        let DVec3 { x: a, y: b, z: p } = self.half_axes;
        let across = a.min(b);
        across * across / p * self.steepness()
    }

    /// Of another fullness the height at which, as on a circle of that radius, the section has turned from the vertical by 1 rad to first order.
    fn rim_radius(&self) -> f64 {
        let DVec3 { x: a, y: b, z: p } = self.half_axes;
        let [across, along] = [a, b].map(|axis| match self.exponent() {
            Some(m) => p * (p / (0.5 * m * axis)).powf(1.0 / (m - 1.0)),
            None => p * p / axis,
        });
        across.min(along * (1.0 + self.lean() * self.lean()).powf(1.5))
    }
}

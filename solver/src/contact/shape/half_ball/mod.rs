//! A half-ball's image: round and anatomical implants of any fullness.
//!
//! x²/a² + y²/b² + z²/p² ≤ 1, z from 0 to p counted from the base: half-axes a across and b along the body, projection p. Round: a = b, a
//! half-ellipsoid of revolution, a hemisphere when p = a. A fullness f other than ⅔ has (z/p)^m in place of z²/p², m = f/(1 − f), and the volume
//! fπabp. With the apex lower, by s towards −y, the feet, the sections shrink towards its foot: the same volume, a fuller lower pole, no overhang.
//! The gauge is the square root of the left side less one.
//!
//! `gauge` | `fullness` (its map of heights) | `leaning` (the sections with the apex lower).

mod fullness;
mod gauge;
mod leaning;

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

    /// ρ of the section at a height: its half-axes by those of the base \[-\].
    fn share(&self, height: f64) -> f64 {
        let part = (height / self.half_axes.z).clamp(0.0, 1.0);
        (1.0 - part.powf(self.exponent().unwrap_or(2.0))).max(0.0).sqrt()
    }

    /// Least distance of the apex's foot from a line that touches the base, and the greatest one \[mm\].
    fn tangents(&self) -> [f64; 2] {
        let (DVec3 { x: a, y: b, .. }, shift) = (self.half_axes, self.apex_shift);
        let wider = b * b - a * a;
        let [down, up] = [-1.0, 1.0].map(|side| extreme(a * a, wider, side * shift.abs()));
        [down.min(a), up.max(a)]
    }

    /// Least distance of the apex's foot from the base's edge \[mm\].
    fn nearest(&self) -> f64 {
        let (DVec3 { x: a, y: b, .. }, shift) = (self.half_axes, self.apex_shift);
        let eccentricity = shift / b;
        let square = 1.0 - eccentricity * eccentricity;
        let (across, along) = (square / (a * a), 1.0 / (b * b));
        square / extreme(across, along - across, eccentricity.abs() / b).max(across.sqrt())
    }
}

/// √(α + βt²) + γt where its slope by t is zero between 0 and 1, else at 1.
fn extreme(alpha: f64, beta: f64, gamma: f64) -> f64 {
    let square = alpha * gamma * gamma / (beta * (beta - gamma * gamma));
    let turns = beta * gamma < 0.0 && square > 0.0 && square < 1.0;
    let t = if turns { square.sqrt() } else { 1.0 };
    (alpha + beta * t * t).max(0.0).sqrt() + gamma * t
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
        DVec2::new(0.0, -self.apex_shift * (1.0 - self.share(height)))
    }

    fn is_round(&self) -> bool {
        let DVec3 { x: a, y: b, .. } = self.half_axes;
        (a - b).abs().max(self.apex_shift.abs()) <= 1e-9 * a
    }

    fn mirrored(&self) -> [bool; 2] {
        [true, self.apex_shift == 0.0]
    }

    fn onto_ball(&self) -> Option<DMat3> {
        let is_ellipsoid = self.exponent().is_none() && self.apex_shift == 0.0;
        is_ellipsoid.then(|| DMat3::from_diagonal(self.half_axes.recip()))
    }

    fn reach(&self, angle: f64, direction: DVec2) -> DVec2 {
        let share = match self.exponent() {
            Some(exponent) => (1.0 - angle.cos().max(0.0).powf(exponent)).max(0.0).sqrt(),
            None => angle.sin(),
        };
        self.half_axes.truncate() * share * direction
    }

    fn least_length(&self) -> f64 {
        let least = self.tangents()[0].min(self.half_axes.z);
        least / self.exponent().map_or(1.0, |exponent| (0.5 * exponent).max(LEAN))
    }

    fn greatest_length(&self) -> f64 {
        self.tangents()[1].max(self.half_axes.z) / self.steepness().min(1.0)
    }

    /// Of a full dome.
    fn outgrows_distance(&self) -> bool {
        self.steepness() > 1.0
    }

    fn apex_radius(&self) -> f64 {
        let across = self.nearest();
        across * across / self.half_axes.z * self.steepness()
    }

    /// Of another fullness the height at which, as on a circle of that radius, the section has turned from the vertical by 1 rad to first order.
    fn rim_radius(&self) -> f64 {
        let DVec3 { x: a, y: b, z: p } = self.half_axes;
        let [across, along] = [a, b + self.apex_shift.abs()].map(|axis| match self.exponent() {
            Some(m) => p * (p / (0.5 * m * axis)).powf(1.0 / (m - 1.0)),
            None => p * p / axis,
        });
        across.min(along)
    }
}

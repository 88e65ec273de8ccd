//! The gauge of a half-ball's image.
//!
//! A position (x, y, z) is the image of s = (x/a, y/b, z/p) in the half-ball: half-axes a and b of the base, projection p; of another fullness than
//! half of an ellipsoid the last number is mapped further ([`Fullness`]), and with the apex lower the first two are replaced by the gauge of the
//! sections ([`Leaning`]). The length |s| is one on the surface; the gauge is |s| − 1.

use super::super::traits::Gauge;
use super::fullness::Fullness;
use super::leaning::{Leaning, Section};
use crate::mesh::vec3::{Block, dot};
use crate::number::Real;

/// Lengths below which a point counts as the centre.
const LEAST_LENGTH: f64 = 1e-6;
/// Steps of Newton's method along a direction: nodes in contact end within rounding in f32.
const STEPS_ALONG: usize = 4;

/// The gauge of a half-ball's image, in any unit of length.
#[derive(Clone, Debug)]
pub(crate) struct HalfBallGauge<R> {
    /// Reciprocal half-axes.
    per_axis: [R; 3],
    /// The sections with the apex lower; `None` of an upright dome.
    leaning: Option<Leaning<R>>,
    /// The map of heights; `None` for half of an ellipsoid.
    fullness: Option<Fullness<R>>,
}

impl<R: Real> HalfBallGauge<R> {
    /// With half-axes a, b, p, the way of the apex towards −y, and the exponent m of the heights, `None` for half of an ellipsoid.
    pub(super) fn new(half_axes: [f64; 3], shift: f64, exponent: Option<f64>) -> Self {
        Self {
            per_axis: half_axes.map(|axis| R::splat(1.0 / axis)),
            leaning: (shift != 0.0).then(|| Leaning::new([half_axes[0], half_axes[1]], shift)),
            fullness: exponent.map(Fullness::new),
        }
    }

    /// The source of a vector in the half-ball of an upright half of an ellipsoid.
    #[inline(always)]
    fn linear(&self, at: [R; 3]) -> [R; 3] {
        [0, 1, 2].map(|axis| at[axis] * self.per_axis[axis])
    }

    /// The place of a height z in the half-ball, and half of the slope of its square by z.
    #[inline(always)]
    fn height(&self, z: R) -> (R, R) {
        let height = z * self.per_axis[2];
        let (source, pull) = match &self.fullness {
            Some(fullness) => fullness.source(height),
            None => (height, height),
        };
        (source, pull * self.per_axis[2])
    }

    /// [`Gauge::length`] of a leaning dome.
    #[inline(never)]
    fn leaning_length(&self, leaning: &Leaning<R>, [x, y, z]: [R; 3]) -> (R, [R; 3]) {
        let section = leaning.section([x, y + leaning.shift]);
        let (source, pull) = self.height(z);
        let length = (section.length * section.length + source * source).sqrt();
        let per = R::splat(1.0) / length.max(R::splat(LEAST_LENGTH));
        let [across, along] = section.slope.map(|slope| slope * section.length * per);
        (length, [across, along, pull * per])
    }

    /// [`Gauge::distance_along`] of a leaning dome: |s|² is convex along the direction.
    #[inline(never)]
    fn leaning_distance(
        &self,
        leaning: &Leaning<R>,
        at: [R; 3],
        direction: [R; 3],
        length: R,
    ) -> R {
        let size = self.linear(direction);
        let most = R::splat(1.0) / dot(size, size).sqrt().max(R::splat(1e-20));
        newton(most, |factor| {
            let to = [0, 1, 2].map(|axis| at[axis] + direction[axis] * factor);
            let (found, gradient) = self.leaning_length(leaning, to);
            let over = R::splat(0.5) * (found - length) * (found + length);
            (over, found * dot(gradient, direction))
        })
    }

    /// [`Gauge::way_to`] of a leaning dome or one with a map of heights, from a place about the apex's foot and the square of its length in
    /// the base: along the image of the half-ball's ray, or upright.
    #[inline(never)]
    fn way_from(&self, place: [R; 2], flat: R, z: R, length: R, to: R) -> [R; 3] {
        let (zero, one) = (R::splat(0.0), R::splat(1.0));
        let factor = to / length.max(R::splat(LEAST_LENGTH));
        let left = to * to - flat;
        let rise = |source: R| {
            let height = self.fullness.as_ref().map_or(source, |fullness| fullness.image(source));
            height / self.per_axis[2] - z
        };
        let upright = rise(left.max(zero).sqrt());
        let along = rise(factor * self.height(z).0);
        let [across, down] = place.map(|way| way * (factor - one));
        shorter([across, down, along], upright, left)
    }
}

/// The way along a ray or upright, whichever is shorter; along the ray where nothing is `left` for an upright way.
#[inline(always)]
fn shorter<R: Real>(ray: [R; 3], upright: R, left: R) -> [R; 3] {
    let zero = R::splat(0.0);
    let most = R::select(left.is_above(zero), dot(ray, ray), zero);
    let is_upright = most.is_above(upright * upright);
    [
        R::select(is_upright, zero, ray[0]),
        R::select(is_upright, zero, ray[1]),
        R::select(is_upright, upright, ray[2]),
    ]
}

impl<R: Real> Gauge<R> for HalfBallGauge<R> {
    #[inline(always)]
    fn length_squared(&self, at: [R; 3]) -> R {
        if let Some(leaning) = &self.leaning {
            let flat = leaning.length([at[0], at[1] + leaning.shift]);
            let height = self.height(at[2]).0;
            return flat * flat + height * height;
        }
        let mut s = self.linear(at);
        if let Some(fullness) = &self.fullness {
            s[2] = fullness.source(s[2]).0;
        }
        dot(s, s)
    }

    #[inline(always)]
    fn length(&self, at: [R; 3]) -> (R, [R; 3]) {
        if let Some(leaning) = &self.leaning {
            return self.leaning_length(leaning, at);
        }
        let mut s = self.linear(at);
        // Half of the gradient of |s|² by the linear part.
        let mut pull = s;
        if let Some(fullness) = &self.fullness {
            (s[2], pull[2]) = fullness.source(s[2]);
        }
        let length = dot(s, s).sqrt();
        let per = R::splat(1.0) / length.max(R::splat(LEAST_LENGTH));
        (length, self.linear(pull.map(|pull| pull * per)))
    }

    #[inline(always)]
    fn curvature(&self, at: [R; 3], length: R, g: [R; 3], least: f64) -> Block<R> {
        let per = R::splat(1.0) / length.max(R::splat(LEAST_LENGTH));
        let [x, y, mut z] = self.per_axis.map(|axis| axis * axis);
        if let Some(fullness) = &self.fullness {
            z = z * fullness.bend(at[2] * self.per_axis[2], least);
        }
        let [xx, xy, yy] = match &self.leaning {
            None => [x, R::splat(0.0), y],
            Some(leaning) => {
                let Section { slope: [a, b], bend, .. } =
                    leaning.section([at[0], at[1] + leaning.shift]);
                [a * a + bend[0], a * b + bend[1], b * b + bend[2]]
            }
        };
        [
            (xx - g[0] * g[0]) * per,
            (xy - g[0] * g[1]) * per,
            -g[0] * g[2] * per,
            (yy - g[1] * g[1]) * per,
            -g[1] * g[2] * per,
            (z - g[2] * g[2]) * per,
        ]
    }

    /// A root of a quadratic equation, with a map of heights by Newton's method.
    #[inline(always)]
    fn distance_along(&self, at: [R; 3], direction: [R; 3], length: R) -> R {
        if let Some(leaning) = &self.leaning {
            return self.leaning_distance(leaning, at, direction, length);
        }
        let (s, g) = (self.linear(at), self.linear(direction));
        if let Some(fullness) = &self.fullness {
            return distance_to(fullness, s, g, length);
        }
        let (a, b, c) = (dot(g, g), dot(s, g), dot(s, s) - length * length);
        let root = (b * b - a * c).max(R::splat(0.0)).sqrt();
        -c / (b + root).max(R::splat(1e-20))
    }

    #[inline(always)]
    fn way_to(&self, p: [R; 3], length: R, to: R) -> [R; 3] {
        if let Some(leaning) = &self.leaning {
            let place = [p[0], p[1] + leaning.shift];
            let flat = leaning.length(place);
            return self.way_from(place, flat * flat, p[2], length, to);
        }
        if self.fullness.is_some() {
            let [x, y, _] = self.linear(p);
            return self.way_from([p[0], p[1]], x * x + y * y, p[2], length, to);
        }
        let zero = R::splat(0.0);
        let ray = (to - length) / length.max(R::splat(LEAST_LENGTH));
        let s = self.linear(p);
        let height = to * to - s[0] * s[0] - s[1] * s[1];
        let upright = (height.max(zero).sqrt() - s[2]) / self.per_axis[2];
        let most = R::select(height.is_above(zero), ray * ray * dot(p, p), zero);
        let is_upright = most.is_above(upright * upright);
        [
            R::select(is_upright, zero, p[0] * ray),
            R::select(is_upright, zero, p[1] * ray),
            R::select(is_upright, upright, p[2] * ray),
        ]
    }
}

/// The multiple of a direction that leads from a point to a length, both in the linear part of the source: |s|² is convex along the
/// direction.
#[inline(never)]
fn distance_to<R: Real>(fullness: &Fullness<R>, from: [R; 3], direction: [R; 3], length: R) -> R {
    let half = R::splat(0.5);
    let most = R::splat(1.0) / dot(direction, direction).sqrt().max(R::splat(1e-20));
    newton(most, |factor| {
        let at = [0, 1, 2].map(|axis| from[axis] + direction[axis] * factor);
        let (s, pull) = fullness.source(at[2]);
        let over = half * (at[0] * at[0] + at[1] * at[1] + s * s - length * length);
        let slope = at[0] * direction[0] + at[1] * direction[1] + pull * direction[2];
        (over, slope)
    })
}

/// The root of a convex function, given with its slope: steps of Newton's method, no longer than `most`, stay beyond the root after the first.
#[inline(always)]
fn newton<R: Real>(most: R, value: impl Fn(R) -> (R, R)) -> R {
    let mut factor = R::splat(0.0);
    for _ in 0..STEPS_ALONG {
        let (over, slope) = value(factor);
        let step = over / slope.max(R::splat(1e-20));
        factor = factor - step.max(-most).min(most);
    }
    factor
}

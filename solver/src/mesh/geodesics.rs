//! Geodesics from the pocket's centre over a wall, and a fan of them, between whose rays the places of a grid are interpolated.
//!
//! Along a ray between its steps by cubic polynomials of position and direction; between rays by polynomials through six rays, of what
//! a ray deviates from a straight one, so that a plane is exact. A patch has some thousand nodes, a fan [`RAYS`] rays.

use super::height_field::HeightField;
use glam::DVec2;
use std::sync::{Arc, OnceLock};

/// Rays of a fan.
const RAYS: usize = 128;
/// Rays that an interpolation reads.
const READ: usize = 6;

/// Position and direction over the plane after a length of a geodesic.
#[derive(Clone, Copy, Debug)]
pub(super) struct Way {
    pub(super) at: DVec2,
    pub(super) direction: DVec2,
}

impl Way {
    /// The start from the centre.
    pub(super) fn new(direction: DVec2) -> Self {
        Self { at: DVec2::ZERO, direction }
    }

    /// A step later (classic Runge–Kutta).
    pub(super) fn after(self, wall: &HeightField<f64>, step: f64) -> Self {
        let Self { at, direction } = self;
        let ahead = |velocity: DVec2, rate: DVec2, step: f64| {
            let ahead = direction + rate * step;
            (ahead, turn(wall, at + velocity * step, ahead))
        };
        let (v1, a1) = (direction, turn(wall, at, direction));
        let (v2, a2) = ahead(v1, a1, 0.5 * step);
        let (v3, a3) = ahead(v2, a2, 0.5 * step);
        let (v4, a4) = ahead(v3, a3, step);
        Self {
            at: at + (v1 + 2.0 * (v2 + v3) + v4) * (step / 6.0),
            direction: direction + (a1 + 2.0 * (a2 + a3) + a4) * (step / 6.0),
        }
    }
}

/// The fan of a wall.
#[derive(Debug)]
pub(super) struct Fan {
    /// Length of a step \[mm\].
    step: f64,
    /// Steps of a ray.
    steps: usize,
    /// In the axes of each ray, shape (rays, steps + 1).
    ways: Vec<Way>,
}

impl Fan {
    /// Of a wall, with steps of at most a length, up to a length \[mm\].
    pub(super) fn new(wall: &HeightField<f64>, longest_step: f64, reach: f64) -> Self {
        let steps = (reach / longest_step).ceil().max(1.0);
        let (step, steps) = (reach / steps, steps as usize);
        let mut ways = Vec::with_capacity(RAYS * (steps + 1));
        for ray in 0..RAYS {
            let axis = axis(ray);
            let mut way = Way::new(axis);
            for _ in 0..=steps {
                let Way { at, direction } = way;
                let own = |v: DVec2| DVec2::new(axis.dot(v), axis.perp_dot(v));
                ways.push(Way { at: own(at), direction: own(direction) });
                way = way.after(wall, step);
            }
        }
        Self { step, steps, ways }
    }

    /// The position over the plane at a place within the reach.
    pub(super) fn foot(&self, place: DVec2) -> DVec2 {
        let length = place.length();
        if length == 0.0 {
            return place;
        }
        let along = length / self.step;
        let first = (along as usize).min(self.steps - 1);
        let s = along - first as f64;
        let (ss, rest) = (s * s, 1.0 - s);
        // Hermite's polynomials.
        let ends = [(1.0 + 2.0 * s) * rest * rest, ss * (3.0 - 2.0 * s)];
        let slopes = [s * rest * rest * self.step, -ss * rest * self.step];
        let turns = place.to_angle() / std::f64::consts::TAU * RAYS as f64;
        let ray = turns.floor();
        let mut at = DVec2::ZERO;
        for (k, weight) in weights(turns - ray).into_iter().enumerate() {
            let ray = (ray as isize + k as isize - 2).rem_euclid(RAYS as isize) as usize;
            let [before, after] = [0, 1].map(|end| self.ways[ray * (self.steps + 1) + first + end]);
            let ends = before.at * ends[0] + after.at * ends[1];
            at += weight * (ends + before.direction * slopes[0] + after.direction * slopes[1]);
        }
        (place / length).rotate(at)
    }
}

/// The fan of a wall that was asked for first, shared by the wall's copies.
#[derive(Clone, Debug, Default)]
pub(super) struct SharedFan(Arc<OnceLock<(f64, Arc<Fan>)>>);

impl SharedFan {
    /// The fan up to a length \[mm\].
    pub(super) fn get(&self, reach: f64, make: impl Fn() -> Fan) -> Arc<Fan> {
        let (first, fan) = self.0.get_or_init(|| (reach, Arc::new(make())));
        if first.to_bits() == reach.to_bits() { Arc::clone(fan) } else { Arc::new(make()) }
    }
}

impl PartialEq for SharedFan {
    /// Equal walls have equal fans.
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

/// The direction of a ray at its start.
fn axis(ray: usize) -> DVec2 {
    DVec2::from_angle(std::f64::consts::TAU * ray as f64 / RAYS as f64)
}

/// The weights of six values at −2, −1, 0, 1, 2, 3 in the polynomial through them.
fn weights(t: f64) -> [f64; READ] {
    let from = [t + 2.0, t + 1.0, t, t - 1.0, t - 2.0, t - 3.0];
    let over = [-120.0, 24.0, -12.0, 12.0, -24.0, 120.0];
    let mut weights = [1.0; READ];
    for (k, weight) in weights.iter_mut().enumerate() {
        let others = from.iter().enumerate().filter(|(other, _)| *other != k);
        *weight = others.map(|(_, from)| from).product::<f64>() / over[k];
    }
    weights
}

/// Second derivative of a geodesic's position over the plane by its length: −∇w (∇∇w : v v)/(1 + |∇w|²).
fn turn(wall: &HeightField<f64>, at: DVec2, v: DVec2) -> DVec2 {
    let (ground, [xx, xy, yy]) = wall.bent(at.to_array());
    let slope = DVec2::from(ground.slope);
    let bend = xx * v.x * v.x + 2.0 * xy * v.x * v.y + yy * v.y * v.y;
    slope * (-bend / (1.0 + slope.length_squared()))
}

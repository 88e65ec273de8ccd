//! A shape that yields: a body at rest, its modulus and the numbers of its deformation.
//!
//! The maps keep the volume, point by point, and the plane of the base; the gauge of the deformed body is that of the body at rest at the source of a
//! point. Nothing of the deformation is on the grid: the equilibrium finds its few numbers from the forces on the surface.
//!
//! `map` (the deformation and its derivatives; its last part: `tilt`) | `gauge` | `gel` (the energy).

mod gauge;
mod gel;
mod map;
#[cfg(test)]
mod tests;
mod tilt;

use super::half_ball::{HalfBall, HalfBallGauge};
use super::traits::{Gauge, Geometry};
use crate::number::Real;
pub(crate) use gauge::DeformedGauge;
pub(crate) use gel::{Balance, Gel};
use glam::{DVec2, DVec3};
pub(crate) use map::{MODES, Map, Modes};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Halvings to a point of a line on the surface: to rounding.
const STEPS: usize = 50;
/// Circles and points on each of the surface's triangles.
const CIRCLES: usize = 24;
const AROUND: usize = 48;

/// A deformed shape.
#[derive(Clone, Debug, PartialEq)]
pub struct Deformed<S> {
    /// The shape at rest.
    pub(crate) rest: S,
    /// Young's modulus of the body, its shell included \[kPa\]; infinite: the deformation is given.
    pub(crate) modulus_kpa: f64,
    /// Weight per volume \[kPa/mm\].
    pub(crate) weight: DVec3,
    /// The numbers of the deformation.
    pub(crate) modes: [f64; MODES],
}

impl<S: Geometry> Deformed<S> {
    /// A body at rest, of Young's modulus \[kPa\] with the shell's part.
    #[must_use]
    pub fn at_rest(rest: S, modulus_kpa: f64) -> Self {
        Self { rest, modulus_kpa, weight: DVec3::ZERO, modes: [0.0; MODES] }
    }

    /// The same body with a weight per volume \[kPa/mm\].
    #[must_use]
    pub fn of_weight(self, weight: DVec3) -> Self {
        Self { weight, ..self }
    }

    /// The same body with other numbers of its deformation.
    #[must_use]
    pub fn with_modes(self, modes: [f64; MODES]) -> Self {
        Self { modes, ..self }
    }

    /// The shape at rest.
    #[must_use]
    pub fn rest(&self) -> &S {
        &self.rest
    }

    /// The numbers of the deformation: flattening, taper, shoulder, widening across, shears and tilts across and along the body \[-\].
    #[must_use]
    pub fn modes(&self) -> [f64; MODES] {
        self.modes
    }

    /// Young's modulus with the shell's part \[kPa\].
    #[must_use]
    pub fn modulus_kpa(&self) -> f64 {
        self.modulus_kpa
    }

    /// Elastic energy of the body \[kPa·mm³\].
    #[must_use]
    pub fn energy(&self) -> f64 {
        self.gel().energy(self.modes)
    }

    pub(crate) fn gel(&self) -> Gel {
        Gel::new(&self.rest, self.modulus_kpa, self.weight)
    }

    pub(crate) fn map<R: Real>(&self) -> Map<R> {
        Map::new(self.rest.half_axes().to_array(), self.modes)
    }

    fn image(&self, of: DVec3) -> DVec3 {
        self.map::<f64>().image(of.to_array()).into()
    }

    /// Share of the body's volume towards +y from the centre of its base \[-\]: above, on a standing body. The part's volume is ∮ x·nₓ over its surface,
    /// since the cut and the base have no normal along x; by triangles, to 1e-3.
    #[must_use]
    pub fn upper_share(&self) -> f64 {
        let directions = (0..AROUND).map(|k| DVec2::from_angle(TAU * k as f64 / AROUND as f64));
        let directions: Vec<DVec2> = directions.collect();
        let circle = |step: usize| -> Vec<DVec3> {
            let angle = FRAC_PI_2 * step as f64 / CIRCLES as f64;
            directions.iter().map(|way| self.image(self.rest.point(angle, *way))).collect()
        };
        let (mut upper, mut whole) = (0.0, 0.0);
        let mut above = circle(0);
        for step in 1..=CIRCLES {
            let below = circle(step);
            for k in 0..AROUND {
                let next = (k + 1) % AROUND;
                for triangle in
                    [[above[k], below[k], below[next]], [above[k], below[next], above[next]]]
                {
                    whole += volume_along_x(&triangle);
                    upper += volume_along_x(&towards_y(triangle));
                }
            }
            above = below;
        }
        upper / whole
    }

    /// Factors of the widths of the base before the tilt, and of lengths upright at the apex.
    fn at_base(&self) -> DVec2 {
        let [flattening, _, shoulder, widening, ..] = self.modes;
        // u of the edge: u + νu² = 1.
        let u = 2.0 / (1.0 + (1.0 + 4.0 * shoulder).max(0.0).sqrt());
        let wide = (1.0 + shoulder * u).max(0.1) * (1.0 - flattening);
        DVec2::new(widening.exp(), (-widening).exp()) / wide.sqrt()
    }

    /// Least and greatest factor of heights by the tilt, over a body with these parts of its half-axes.
    fn risen(&self, wide: f64) -> [f64; 2] {
        let [.., across, along] = self.modes;
        [-1.0, 1.0].map(|side| {
            let rise = |tilt: f64| (1.0 + side * 2.0 * wide * tilt.abs()).max(0.1).sqrt();
            rise(across) * rise(along)
        })
    }

    /// Greatest half of the width and of the height of the body \[mm\].
    #[must_use]
    pub fn greatest_half_axes(&self) -> DVec2
    where
        Self: Geometry,
    {
        let at = |k: i32| self.half_widths(FRAC_PI_2 * f64::from(k) / 45.0);
        (0..=45).map(at).fold(DVec2::ZERO, DVec2::max)
    }
}

/// ∫ x·nₓ over a plane polygon.
fn volume_along_x(polygon: &[DVec3]) -> f64 {
    let fan =
        (1..polygon.len().saturating_sub(1)).map(|k| [polygon[0], polygon[k], polygon[k + 1]]);
    fan.map(|[a, b, c]| (b - a).cross(c - a).x * (a.x + b.x + c.x) / 6.0).sum()
}

/// The part of a triangle with y ≥ 0, a polygon.
fn towards_y(triangle: [DVec3; 3]) -> Vec<DVec3> {
    let mut part = Vec::with_capacity(4);
    for k in 0..3 {
        let (from, to) = (triangle[k], triangle[(k + 1) % 3]);
        if from.y >= 0.0 {
            part.push(from);
        }
        if (from.y >= 0.0) != (to.y >= 0.0) {
            part.push(from.lerp(to, from.y / (from.y - to.y)));
        }
    }
    part
}

impl Deformed<HalfBall> {
    /// The shape in another unit of length.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        Self { rest: self.rest.scaled(factor), ..self.clone() }
    }

    pub(crate) fn gauge<R: Real>(&self) -> DeformedGauge<R, HalfBallGauge<R>> {
        DeformedGauge { rest: self.rest.gauge(), map: self.map() }
    }
}

impl Geometry for Deformed<HalfBall> {
    /// Of a tilted base, which reaches further on its thin side, the half of both.
    fn half_axes(&self) -> DVec3 {
        let [.., across, along] = self.modes;
        let reach = |wide: f64, tilt: f64| {
            let side = |tilt: f64| wide / (1.0 + (1.0 + 2.0 * tilt * wide).max(0.0).sqrt());
            side(tilt) + side(-tilt)
        };
        let wide = self.at_base();
        let wide = DVec2::new(reach(wide.x, across), reach(wide.y, along));
        (self.rest.half_axes().truncate() * wide).extend(self.apex().z)
    }

    fn reference_length(&self) -> f64 {
        self.rest.reference_length()
    }

    fn volume(&self) -> f64 {
        self.rest.volume()
    }

    fn apex(&self) -> DVec3 {
        self.image(self.rest.apex())
    }

    /// The image of the axis at rest.
    fn axis(&self, height: f64) -> DVec2 {
        let map = self.map::<f64>();
        let image = |at: f64| DVec3::from(map.image(self.rest.axis(at).extend(at).to_array()));
        let (mut below, mut above) = (0.0, self.rest.half_axes().z);
        for _ in 0..STEPS {
            let middle = 0.5 * (below + above);
            *(if image(middle).z < height { &mut below } else { &mut above }) = middle;
        }
        image(above).truncate()
    }

    fn is_round(&self) -> bool {
        self.rest.is_round() && self.modes[3..] == [0.0; MODES - 3]
    }

    fn mirrored(&self) -> [bool; 2] {
        let rest = self.rest.mirrored();
        [0, 1].map(|axis| {
            rest[axis]
                && self.modes[4 + axis] == 0.0
                && self.modes[6 + axis] == 0.0
                && self.weight[axis] == 0.0
        })
    }

    /// Over the unit disc of places at rest, from the best of some places by steps in eight directions that halve.
    fn top(&self) -> f64 {
        let height = |at: DVec2| {
            let way = at.normalize_or(DVec2::X);
            self.point(at.length().min(1.0).asin(), way).z
        };
        let higher = |best: (f64, DVec2), at: DVec2| {
            let found = height(at);
            if found > best.0 { (found, at) } else { best }
        };
        let way = |turn: u32, of: u32| DVec2::from_angle(TAU * f64::from(turn) / f64::from(of));
        let some = (0..48).map(|k| way(k % 12, 12) * f64::from(k / 12) * 0.25);
        let mut best = some.fold((0.0, DVec2::ZERO), higher);
        let mut step = 0.12;
        while step > 1e-6 {
            let from = best.0;
            best = (0..8).map(|turn| best.1 + step * way(turn, 8)).fold(best, higher);
            step *= if best.0 > from { 1.0 } else { 0.5 };
        }
        best.0
    }

    /// The image of the line at rest.
    fn point(&self, angle: f64, direction: DVec2) -> DVec3 {
        self.image(self.rest.point(angle, direction))
    }

    /// By bisection: below the highest point the line falls.
    fn angle_at(&self, height: f64, direction: DVec2) -> f64 {
        if height <= 0.0 {
            return FRAC_PI_2;
        }
        let (mut above, mut below) = (0.0, FRAC_PI_2);
        for _ in 0..STEPS {
            let middle = 0.5 * (above + below);
            let is_above = self.point(middle, direction).z > height;
            *(if is_above { &mut above } else { &mut below }) = middle;
        }
        below
    }

    /// Of a tilted body, which reaches further on its thin side, the half of both.
    fn half_widths(&self, angle: f64) -> DVec2 {
        let whole = |axis: DVec2| (self.reach(angle, axis) - self.reach(angle, -axis)).dot(axis);
        0.5 * DVec2::new(whole(DVec2::X), whole(DVec2::Y))
    }

    /// By bisection along the image of the direction.
    fn reach(&self, angle: f64, direction: DVec2) -> DVec2 {
        let height = self.half_axes().z * angle.cos();
        let (gauge, middle) = (self.gauge::<f64>(), self.axis(height));
        let way = self.rest.half_axes().truncate() * direction;
        let is_inside = |factor: f64| {
            gauge.length_squared((middle + way * factor).extend(height).to_array()) < 1.0
        };
        let (mut inside, mut outside) = (0.0, 4.0);
        for _ in 0..STEPS {
            let factor = 0.5 * (inside + outside);
            *(if is_inside(factor) { &mut inside } else { &mut outside }) = factor;
        }
        way * inside
    }

    fn least_length(&self) -> f64 {
        self.rest.least_length() * self.stretches()[0]
    }

    fn greatest_length(&self) -> f64 {
        self.rest.greatest_length() * self.stretches()[1]
    }

    /// About that of the deformed apex: of its widths squared by its height.
    fn apex_radius(&self) -> f64 {
        let [flattening, _, shoulder, ..] = self.modes;
        let wide = self.at_base().min_element();
        let section = self.sections()[2];
        let fuller = (1.0 - 4.0 * shoulder).max(0.1);
        self.rest.apex_radius() * wide * wide * section * section / (1.0 - flattening) / fuller
    }

    fn rim_radius(&self) -> f64 {
        let up = (1.0 - self.modes[0]) * self.risen(1.0)[0];
        self.rest.rim_radius() * up * up / self.at_base().max_element()
    }
}

impl Deformed<HalfBall> {
    /// Least and greatest c over the body, and c at its apex.
    fn sections(&self) -> [f64; 3] {
        let map = self.map::<f64>();
        let at = |part: f64| map.source([0.0, 0.0, part * self.half_axes().z]).section();
        let all = || (0..=8).map(|k| at(f64::from(k) / 8.0));
        [all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max), at(1.0)]
    }

    /// Bounds of the factor of lengths by the map, over the body: from the greatest parts of the gradient.
    fn stretches(&self) -> [f64; 2] {
        let [flattening, taper, shoulder, widening, lean @ ..] = self.modes;
        let left = 1.0 - flattening;
        let [least, most, _] = self.sections();
        let sections = [least, most];
        let steep = 1.0 + 2.0 * shoulder.abs();
        let widths = [
            (sections[0] / left).sqrt() / steep * (-widening.abs()).exp(),
            (sections[1] / left).sqrt() * steep * widening.abs().exp(),
        ];
        let ups = [left / sections[1] / steep, left / sections[0] * steep];
        let slender = self.rest.greatest_length() / self.rest.least_length();
        let bow = slender * (taper.abs() + 4.0 * shoulder.abs()) * widths[1];
        let lean = 1.0 + lean.iter().map(|part| part.abs()).sum::<f64>() + bow;
        let [low, high] = self.risen(widths[1]);
        let (least, most) =
            ((widths[0] / high).min(ups[0] * low), (widths[1] / low).max(ups[1] * high));
        [least / lean, most * lean]
    }
}

//! Lines on the surface of a dome: meridian, circles, sections.

use super::dome::{Dome, reach_at};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Bisections of an interval: to rounding.
const BISECTIONS: usize = 60;

impl Dome {
    /// The meridian of the round implant of this base radius at a parameter, the angle whose cosine is the height by the projection,
    /// 0 at the apex: distance from the axis and height above the wall \[mm\].
    #[must_use]
    pub fn meridian(&self, angle: f64) -> DVec2 {
        let height = self.base_height + self.projection * angle.cos();
        DVec2::new(self.base_radius * self.reach(angle), height)
    }

    /// Radius of the section at a parameter of [`Self::meridian`] \[base's\].
    fn reach(&self, angle: f64) -> f64 {
        self.exponent().map_or(angle.sin(), |m| reach_at(angle.cos().max(0.0), m))
    }

    /// Points of the surface \[mm\]: circles of the round implant from the apex, itself one, to the wall at equal steps of the
    /// parameter of [`Self::meridian`], each counter-clockwise from the direction of x.
    pub fn circles(&self, count: usize, around: usize) -> impl Iterator<Item = DVec3> {
        let turn = |step: usize| DVec2::from_angle(TAU * step as f64 / around as f64);
        let directions: Vec<DVec2> = (0..around).map(turn).collect();
        let (dome, last) = (self.clone(), self.wall_angle());
        (0..=count).flat_map(move |circle| {
            let angle = last * circle as f64 / count as f64;
            let height = dome.meridian(angle).y;
            let (axis, radii) = (dome.axis(height), dome.base_axes() * dome.reach(angle));
            let point = |across: &DVec2| {
                let place = axis + radii * *across;
                place.extend(dome.chest.height(place) + height)
            };
            directions.iter().map(point).collect::<Vec<DVec3>>()
        })
    }

    /// Half-axes of the base \[mm\].
    pub(super) fn base_axes(&self) -> DVec2 {
        DVec2::new(self.base_radius, self.base_along)
    }

    /// The dome's outline in the plane of a given y at a parameter from 0 (greatest x) to π: x and height above the
    /// wall \[mm\].
    #[must_use]
    pub fn outline(&self, y: f64, angle: f64) -> DVec2 {
        if let Some(exponent) = self.exponent() {
            return self.section(y - self.center.y, exponent, angle);
        }
        // The section of a leaning ellipsoid is an ellipse about another height, less high.
        let rate = self.apex_shift / self.base_along;
        let lower = 1.0 / (1.0 + rate * rate);
        let offset = (y - self.center.y) / self.base_along;
        let scale = (1.0 - offset * offset * lower).max(0.0).sqrt();
        let middle = self.base_height - self.projection * rate * offset * lower;
        DVec2::new(
            self.center.x + scale * self.base_radius * angle.cos(),
            middle + scale * (self.projection * lower.sqrt()) * angle.sin(),
        )
    }

    /// The dome's outline in the plane of a given x at a parameter from 0 (greatest y) to π: y and height above the wall \[mm\].
    #[must_use]
    pub fn outline_along(&self, x: f64, angle: f64) -> DVec2 {
        let exponent = self.exponent().unwrap_or(2.0);
        let offset = (x - self.center.x) / self.base_radius;
        let square = (1.0 - offset * offset).max(0.0);
        let share = square.powf(exponent.recip()) * angle.sin();
        let half = self.base_along * (square - share.abs().powf(exponent)).max(0.0).sqrt();
        let height = self.base_height + self.projection * share;
        DVec2::new(self.axis(height).y + half.copysign(angle.cos()), height)
    }

    /// [`Self::outline`] of a fuller or leaner dome in the plane of a distance from its centre along the body: from the height at which the
    /// section is widest to its top.
    fn section(&self, y: f64, exponent: f64, angle: f64) -> DVec2 {
        let (p, lean) = (self.projection, self.lean());
        let offset = |height: f64| (y - lean * height) / self.base_along;
        let power = |height: f64, exponent: f64| (height / p).abs().powf(exponent);
        let inside = |height: f64| 1.0 - offset(height).powi(2) - power(height, exponent);
        let widens = |height: f64| {
            let by_power = exponent / p * power(height, exponent - 1.0).copysign(height);
            2.0 * offset(height) * lean / self.base_along - by_power
        };
        let widest = if lean == 0.0 { 0.0 } else { root([-p, p], widens) };
        let top = root([widest, p], inside);
        let height = widest + (top - widest) * angle.sin();
        let half_width = self.base_radius * inside(height).max(0.0).sqrt();
        let x = self.center.x + half_width.copysign(angle.cos());
        DVec2::new(x, self.base_height + height)
    }

    /// The parameter of [`Self::meridian`] where the dome meets the wall \[rad\].
    #[must_use]
    pub fn wall_angle(&self) -> f64 {
        (-self.base_height / self.projection).clamp(0.0, 1.0).acos()
    }
}

/// Where a decreasing function of an interval is zero; the start of the interval if it is negative there.
fn root([mut from, mut to]: [f64; 2], of: impl Fn(f64) -> f64) -> f64 {
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (from + to);
        if of(middle) > 0.0 {
            from = middle;
        } else {
            to = middle;
        }
    }
    0.5 * (from + to)
}

#[cfg(test)]
mod tests {
    use super::super::dome::tests::{anatomical, filled};
    use super::*;
    use crate::mesh::Chest;
    use std::f64::consts::PI;

    #[test]
    fn lines_of_an_anatomical_dome_lie_on_its_surface() {
        for dome in anatomical().into_iter().chain(filled()) {
            let above = |point: DVec3| point.z - dome.chest.height(point.truncate());
            assert!(dome.gauge(dome.apex()).abs() < 1e-12);
            assert!((above(dome.apex()) - dome.top()).abs() < 1e-12);
            for point in dome.circles(12, 24) {
                assert!(dome.gauge(point).abs() < 1e-12);
                assert!((-1e-9..=dome.top() + 1e-9).contains(&above(point)));
            }
            for x in [-30.0, 4.0, 25.0] {
                let ends = [0.0, PI].map(|angle| dome.outline_along(x, angle));
                assert!(ends[0].x > ends[1].x && (ends[0].y - ends[1].y).abs() < 1e-9);
                for k in 0..=16 {
                    let place = dome.outline_along(x, PI * f64::from(k) / 16.0);
                    let point = DVec3::new(x, place.x, place.y);
                    let point = point + dome.chest.height(point.truncate()) * DVec3::Z;
                    assert!(dome.gauge(point).abs() < 1e-9, "{}", dome.gauge(point));
                }
            }
            for y in [-30.0, 4.0, 25.0] {
                for k in 0..=16 {
                    let place = dome.outline(y, PI * f64::from(k) / 16.0);
                    let point = DVec3::new(place.x, y, place.y);
                    let lifted = point + DVec3::Z * dome.chest.height(point.truncate());
                    // Just above the base the map of heights is linear.
                    let most = if dome.exponent().is_some() { 1e-9 } else { 1e-12 };
                    assert!(dome.gauge(lifted).abs() < most, "{}", dome.gauge(lifted));
                }
            }
            if dome.chest == Chest::Flat && dome.exponent().is_none() {
                let directions = (0..4000).map(|k| {
                    let z = f64::from(k) / 2000.0 - 1.0;
                    DVec2::from_angle(2.4 * f64::from(k)).extend(0.0) * (1.0 - z * z).sqrt()
                        + DVec3::Z * z
                });
                let lengths = directions.map(|d| 1.0 / (dome.gauge(dome.origin() + d) + 1.0));
                let ends = |(least, most): (f64, f64), l: f64| (least.min(l), most.max(l));
                let (least, most) = lengths.fold((f64::INFINITY, 0.0), ends);
                assert!((least / dome.least_half_axis() - 1.0).abs() < 1e-2, "{least}");
                assert!((most / dome.greatest_half_axis() - 1.0).abs() < 1e-2, "{most}");
            }
        }
    }
}

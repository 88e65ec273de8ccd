//! Lines on the surface of a dome: meridian, circles, sections.

use super::Dome;
use crate::mesh::Chest;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Halvings along a ray to the surface: to rounding.
const STEPS: usize = 54;
/// Where a ray is outside of every shape, in half axes.
const OUTSIDE: f64 = 3.0;

impl Dome {
    /// The meridian towards x at a parameter, the angle whose cosine is the height by the projection, 0 at the apex: distance from
    /// the axis and height above the wall \[mm\].
    #[must_use]
    pub fn meridian(&self, angle: f64) -> DVec2 {
        DVec2::new(self.shape.reach(angle, DVec2::X).x, self.height(angle))
    }

    /// Height above the wall at a parameter of [`Self::meridian`] \[mm\].
    fn height(&self, angle: f64) -> f64 {
        self.base_height + self.projection() * angle.cos()
    }

    /// Points of the surface \[mm\]: images of circles from the apex, itself one, to the wall at equal steps of the
    /// parameter of [`Self::meridian`], each counter-clockwise from the direction of x.
    pub fn circles(&self, count: usize, around: usize) -> impl Iterator<Item = DVec3> {
        let turn = |step: usize| DVec2::from_angle(TAU * step as f64 / around as f64);
        let directions: Vec<DVec2> = (0..around).map(turn).collect();
        let dome = self.clone();
        let last = |way: &DVec2| dome.shape.angle_at(-dome.base_height, *way);
        let lines: Vec<(DVec2, f64)> = directions.iter().map(|way| (*way, last(way))).collect();
        (0..=count).flat_map(move |circle| {
            let part = circle as f64 / count as f64;
            let point =
                |(way, last): &(DVec2, f64)| dome.placed(dome.shape.point(last * part, *way));
            lines.iter().map(point).collect::<Vec<DVec3>>()
        })
    }

    /// A point of the shape in place \[mm\].
    fn placed(&self, point: DVec3) -> DVec3 {
        let place = self.center + point.truncate();
        place.extend(self.chest.height(place) + self.base_height + point.z)
    }

    /// The dome's outline in the plane of a given y at a parameter from 0 (greatest x) to π: x and height above the
    /// wall \[mm\].
    #[must_use]
    pub fn outline(&self, y: f64, angle: f64) -> DVec2 {
        let DVec3 { x, z, .. } = self.section(self.center.with_y(y), DVec2::X, angle);
        DVec2::new(x, z)
    }

    /// The dome's outline in the plane of a given x at a parameter from 0 (greatest y) to π: y and height above the wall \[mm\].
    #[must_use]
    pub fn outline_along(&self, x: f64, angle: f64) -> DVec2 {
        let DVec3 { y, z, .. } = self.section(self.center.with_x(x), DVec2::Y, angle);
        DVec2::new(y, z)
    }

    /// The point of the surface over the plane that a ray from a place of the base meets; the place if the base ends before it.
    fn section(&self, place: DVec2, across: DVec2, angle: f64) -> DVec3 {
        let flat = self.clone().over(Chest::Flat).draped::<f64>();
        let half_axes = self.shape.half_axes();
        let direction =
            (across * half_axes.truncate() * angle.cos()).extend(half_axes.z * angle.sin());
        let start = place.extend(self.base_height);
        if flat.length_squared(start.to_array()) >= 1.0 {
            return start;
        }
        let at = |factor: f64| start + direction * factor;
        let halved = |(inside, outside): (f64, f64), _| {
            let middle = 0.5 * (inside + outside);
            let is_inside = flat.length_squared(at(middle).to_array()) < 1.0;
            if is_inside { (middle, outside) } else { (inside, middle) }
        };
        at((0..STEPS).fold((0.0, OUTSIDE), halved).0)
    }

    /// The parameter of [`Self::meridian`] where the dome meets the wall \[rad\].
    #[must_use]
    pub fn wall_angle(&self) -> f64 {
        (-self.base_height / self.projection()).clamp(0.0, 1.0).acos()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Deformed;
    use super::super::dome::tests::{anatomical, others};
    use super::*;
    use std::f64::consts::PI;

    /// Anatomical implants that yield: flatter, fuller at the shoulder, wider, leaning.
    fn yielding() -> impl Iterator<Item = Dome> {
        anatomical().into_iter().map(|dome| {
            let rest = dome.shape.half_ball().unwrap();
            let soft = Deformed::at_rest(rest, 20.0)
                .with_modes([0.1, 0.05, 0.04, 0.02, 0.03, -0.05, 0.04, -0.06]);
            Dome { shape: soft.into(), ..dome }
        })
    }

    #[test]
    fn lines_of_an_anatomical_dome_lie_on_its_surface() {
        for dome in anatomical().into_iter().chain(others()).chain(yielding()) {
            let above = |point: DVec3| point.z - dome.chest.height(point.truncate());
            assert!(dome.gauge(dome.apex()).abs() < 1e-12);
            assert!((above(dome.apex()) - dome.top()).abs() < 1e-12);
            for point in dome.circles(12, 24) {
                assert!(dome.gauge(point).abs() < 1e-12);
                let top = dome.base_height + dome.shape.top();
                assert!((-1e-9..=top + 1e-9).contains(&above(point)));
            }
            for x in [-30.0, 4.0, 25.0, dome.center.x] {
                let ends = [0.0, PI].map(|angle| dome.outline_along(x, angle));
                assert!(ends[0].x > ends[1].x && (ends[0].y - ends[1].y).abs() < 1e-9);
                for k in 0..=16 {
                    let place = dome.outline_along(x, PI * f64::from(k) / 16.0);
                    let point = DVec3::new(x, place.x, place.y);
                    let point = point + dome.chest.height(point.truncate()) * DVec3::Z;
                    assert!(dome.gauge(point).abs() < 1e-9, "{}", dome.gauge(point));
                }
            }
            for y in [-30.0, 4.0, 25.0, dome.center.y] {
                for k in 0..=16 {
                    let place = dome.outline(y, PI * f64::from(k) / 16.0);
                    let point = DVec3::new(place.x, y, place.y);
                    let lifted = point + DVec3::Z * dome.chest.height(point.truncate());
                    // Just above the base the map of heights is linear.
                    let most = if dome.shape.onto_ball().is_none() { 1e-9 } else { 1e-12 };
                    assert!(dome.gauge(lifted).abs() < most, "{}", dome.gauge(lifted));
                }
            }
            if dome.chest == Chest::Flat && dome.shape.onto_ball().is_some() {
                let directions = (0..4000).map(|k| {
                    let z = f64::from(k) / 2000.0 - 1.0;
                    DVec2::from_angle(2.4 * f64::from(k)).extend(0.0) * (1.0 - z * z).sqrt()
                        + DVec3::Z * z
                });
                let lengths = directions.map(|d| 1.0 / (dome.gauge(dome.origin() + d) + 1.0));
                let ends = |(least, most): (f64, f64), l: f64| (least.min(l), most.max(l));
                let (least, most) = lengths.fold((f64::INFINITY, 0.0), ends);
                assert!((least / dome.shape.least_length() - 1.0).abs() < 1e-2, "{least}");
                assert!((most / dome.shape.greatest_length() - 1.0).abs() < 1e-2, "{most}");
            }
        }
    }
}

//! Distances from the implant: of a point, along a ray.

use super::dome::{Dome, symmetric};
use super::shape::Near;
use crate::mesh::Chest;
use glam::{DMat3, DVec2, DVec3};

/// Steps of Newton's method to the closest point, and halvings of a step.
const MOST_STEPS: usize = 30;
const MOST_HALVINGS: usize = 8;
/// Length of a step at which the closest point is found \[base radius\].
const LEAST_STEP: f64 = 1e-12;
/// Parts of a ray within a sphere around the dome: a surface that the ray enters and leaves within a part is missed.
const PARTS: usize = 64;
/// Steps from one part to the surface.
const MOST_ROOT_STEPS: usize = 40;

impl Dome {
    /// Signed distance to the surface \[mm\] (negative inside) and the closest point of it.
    ///
    /// Of half of an ellipsoid of revolution on the flat wall the closest point of an ellipse, by Newton's method kept in its bracket (D. Eberly,
    /// "Distance from a Point to an Ellipse, an Ellipsoid, or a Hyperellipsoid", 2013). Else a closest point near
    /// [`Self::onto_surface`], by Newton's method on the surface.
    #[must_use]
    pub fn closest_point(&self, point: DVec3) -> (f64, DVec3) {
        let is_ellipsoid = self.chest == Chest::Flat && self.shape.onto_ball().is_some();
        let closest = if is_ellipsoid && self.is_round() {
            let d = point - self.origin();
            let radial = d.truncate().length();
            let across = if radial > 0.0 { d.truncate() / radial } else { DVec2::X };
            let foot = closest_on_ellipse(
                DVec2::new(self.reference_length(), self.projection()),
                DVec2::new(radial, d.z.abs()),
            );
            self.origin() + (across * foot.x).extend(foot.y.copysign(d.z))
        } else {
            self.foot(point)
        };
        (point.distance(closest).copysign(self.gauge(point)), closest)
    }

    /// A closest point of the surface.
    fn foot(&self, point: DVec3) -> DVec3 {
        let draped = self.draped::<f64>();
        let onto_surface = |at: DVec3| self.projected(&draped, at, 0.0);
        let mut foot = onto_surface(point);
        for _ in 0..MOST_STEPS {
            let gradient = DVec3::from(draped.near(foot.to_array()).gradient);
            let steepness = gradient.length();
            let normal = gradient / steepness;
            let away = point - foot;
            let height = normal.dot(away);
            // The distance along the surface to second order: 1 + height × curvature, 1 on its normal.
            let (a, b) = normal.any_orthonormal_pair();
            let curvature = symmetric(draped.curvature(foot.to_array(), 0.0));
            let bend = curvature * (height / steepness) + DMat3::IDENTITY;
            let (aa, ab, bb) = (a.dot(bend * a), a.dot(bend * b), b.dot(bend * b));
            let (along_a, along_b, det) = (a.dot(away), b.dot(away), aa * bb - ab * ab);
            let is_convex = aa > 0.0 && det > 1e-9 * aa * bb;
            let mut step = if is_convex {
                (a * (bb * along_a - ab * along_b) + b * (aa * along_b - ab * along_a)) / det
            } else {
                a * along_a + b * along_b
            };
            let before = away.length_squared();
            let moved = (0..MOST_HALVINGS).find_map(|_| {
                let to = onto_surface(foot + step);
                step *= 0.5;
                (point.distance_squared(to) < before).then_some(to)
            });
            let Some(to) = moved else { break };
            let length = to.distance(foot);
            foot = to;
            if length < LEAST_STEP * self.reference_length() {
                break;
            }
        }
        foot
    }

    /// Distance along a ray to the surface \[lengths of `direction`\], negative behind the origin.
    #[must_use]
    pub fn ray_distance(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let center = self.origin();
        if self.chest == Chest::Flat
            && let Some(map) = self.shape.onto_ball()
        {
            let crossings = crossings(map * (origin - center), map * direction);
            return crossings.map(|[first, _]| first);
        }
        // A sphere around the dome: half-axes, and the fall of the wall within their greatest.
        let reach = self.shape.greatest_length();
        let fall = self.circles(4, 16).map(|p| (p.z - center.z).abs()).fold(reach, f64::max);
        let radius = 1.1 * reach.hypot(fall);
        let [start, last] = crossings((origin - center) / radius, direction / radius)?;
        let draped = self.draped::<f64>();
        let near = |t: f64| draped.near((origin + direction * t).to_array());
        let part = (last - start) / PARTS as f64;
        let mut ends = (1..=PARTS).map(|k| start + part * k as f64);
        let mut to = ends.find(|t| near(*t).length < 1.0)?;
        let mut from = to - part;
        let mut at = to;
        for _ in 0..MOST_ROOT_STEPS {
            // Newton's method in its bracket.
            let Near { length, gradient, .. } = near(at);
            if length < 1.0 {
                to = at;
            } else {
                from = at;
            }
            let newton = at - (length - 1.0) / DVec3::from(gradient).dot(direction);
            let is_within = newton > from && newton < to;
            let next = if is_within { newton } else { 0.5 * (from + to) };
            let moved = next - at;
            at = next;
            if moved.abs() <= 1e-14 * part {
                break;
            }
        }
        Some(at)
    }
}

/// Where a ray enters and leaves the unit sphere.
fn crossings(from: DVec3, along: DVec3) -> Option<[f64; 2]> {
    let (a, b, c) = (along.length_squared(), from.dot(along), from.length_squared() - 1.0);
    let discriminant = b * b - a * c;
    let root = discriminant.max(0.0).sqrt();
    (discriminant >= 0.0).then(|| [(-b - root) / a, (-b + root) / a])
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
    use crate::contact::HalfBall;
    use crate::contact::dome::tests::{anatomical, domes as round, others};

    /// Anatomical domes, a round one over a curved wall, leaner and fuller ones.
    fn domes() -> impl Iterator<Item = Dome> {
        let round = Dome::new(DVec2::new(4.0, -6.0), HalfBall::round(60.0, 40.0), 1.0);
        let chest = Chest::Curved { across_mm: 150.0, along_mm: 150.0 };
        anatomical().into_iter().chain([Dome { chest, ..round }]).chain(others())
    }

    /// Points above the base, within and beside the dome up to 60 mm.
    fn points(dome: &Dome) -> Vec<DVec3> {
        let rim = dome.circles(7, 13).collect::<Vec<_>>();
        let beside = |(k, point): (usize, DVec3)| {
            let away = [-6.0, -1.0, 0.5, 5.0, 20.0, 60.0][k % 6];
            point + dome.normal(point) * away + DVec3::new(0.3, -0.2, 0.1) * away.max(0.0)
        };
        rim.into_iter().enumerate().skip(13).map(beside).collect()
    }

    #[test]
    fn the_closest_point_lies_on_the_surface_along_its_normal() {
        for dome in round() {
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
    fn no_point_of_the_surface_is_closer_than_the_closest() {
        for dome in domes() {
            let surface: Vec<DVec3> = dome.circles(60, 120).collect();
            for point in points(&dome) {
                let (distance, closest) = dome.closest_point(point);
                assert!(dome.gauge(closest).abs() < 1e-9);
                assert_eq!(distance < 0.0, dome.gauge(point) < 0.0);
                let along = (point - closest).cross(dome.normal(closest)).length();
                // At the sharp rim of a lean dome a step of this length changes no digit of the distance.
                let most = if dome.shape.onto_ball().is_none() { 1e-5 } else { 1e-6 };
                assert!(along < most, "{along} at {point}");
                let least = surface.iter().map(|p| p.distance(point)).fold(f64::MAX, f64::min);
                // Deep inside of a full dome another point of the surface may be closer by little.
                let is_deep = distance < -2.0 && dome.shape.onto_ball().is_none();
                let least = if is_deep { 1.03 * least } else { least };
                assert!(distance.abs() < least + 1e-9, "{distance} {least} at {point}");
            }
        }
    }

    #[test]
    fn a_ray_ends_where_it_first_meets_the_surface() {
        for dome in domes() {
            for (k, target) in points(&dome).into_iter().enumerate() {
                let eye = dome.origin() + DVec3::new(300.0, -400.0 + 9.0 * k as f64, 350.0);
                let direction = (target - eye) / 3.0;
                let first = (0..6000).map(|k| f64::from(k) / 1000.0);
                let is_inside = |t: &f64| dome.gauge(eye + direction * *t) < 0.0;
                match dome.ray_distance(eye, direction) {
                    Some(found) => {
                        assert!(dome.gauge(eye + direction * found).abs() < 1e-9);
                        let first = first.clone().find(is_inside).unwrap_or(found);
                        assert!(found <= first && first < found + 2e-3, "{found} {first}");
                    }
                    None => assert!(first.clone().filter(is_inside).count() < 30),
                }
            }
        }
    }

    #[test]
    fn over_a_wall_of_a_large_radius_distances_are_those_over_the_plane() {
        let flat = Dome::new(
            DVec2::new(4.0, -6.0),
            HalfBall::round(60.0, 40.0).anatomical(52.0, 15.0),
            0.8,
        );
        let chest = Chest::Curved { across_mm: 1e9, along_mm: 1e9 };
        let curved = Dome { chest, ..flat.clone() };
        for point in points(&flat) {
            assert!((flat.closest_point(point).0 - curved.closest_point(point).0).abs() < 1e-5);
            let eye = DVec3::new(200.0, 100.0, 150.0);
            let [a, b] = [&flat, &curved].map(|dome| dome.ray_distance(eye, point - eye));
            if let (Some(a), Some(b)) = (a, b) {
                assert!((a - b).abs() < 1e-5, "{a} {b}");
            }
        }
    }
}

//! Initial guess from geometry alone: in every vertical plane through the dome's axis the taut profile over
//! the dome and down to a circle, uniformly stretched along its length; of an anatomical dome the linear image of the guess of a round one;
//! over a curved wall the same heights above the wall, which may lie within the dome.

use crate::contact::Dome;
use crate::mesh::{NodeKind, Rest};
use glam::{DVec2, DVec3};

/// Points sampled along the dome's meridian.
const MERIDIAN: usize = 64;

/// Positions \[mm\] of every node; clamped and outside nodes at rest on the wall.
pub(crate) fn taut_profile(rest: &Rest, dome: &Dome) -> Vec<DVec3> {
    taut_within(rest, dome, rest.sheet().radius_mm())
}

/// [`taut_profile`] down to a circle of this radius \[mm\], beyond which nodes are at rest.
pub(crate) fn taut_within(rest: &Rest, dome: &Dome, radius: f64) -> Vec<DVec3> {
    let (sheet, meridian) = (rest.sheet(), meridian(dome));
    let half_axes = dome.shape.half_axes();
    let (axis, axes) = (dome.axis(0.0), DVec2::new(1.0, half_axes.y / half_axes.x));
    let mut profile = Vec::with_capacity(MERIDIAN + 2);
    sheet
        .rest()
        .iter()
        .zip(sheet.kinds())
        .enumerate()
        .map(|(k, (&place, kind))| {
            let from_axis = place - axis;
            // In the plane of a round implant, whose linear image the dome is.
            let round = from_axis / axes;
            let distance = round.length();
            if *kind != NodeKind::Free || place.length() >= radius {
                return rest.node(0, k);
            }
            let direction = if distance > 0.0 { round / distance } else { DVec2::X };
            let stretch = (direction * axes).length() / direction.length();
            let reach = distance_to_border(axis, direction * axes / stretch, radius) / stretch;
            pull_taut(&meridian, reach, &mut profile);
            let at = along(&profile, distance / reach);
            let place = dome.axis(at.y) + direction * axes * at.x;
            let (foot, _) = dome.chest.foot_and_normal(place);
            foot.with_z(foot.z + at.y)
        })
        .collect()
}

/// The dome's meridian above the wall as (distance from its axis, height), from the apex down.
fn meridian(dome: &Dome) -> Vec<DVec2> {
    let last = dome.wall_angle();
    (0..=MERIDIAN)
        .map(|k| {
            let point = dome.meridian(last * k as f64 / MERIDIAN as f64);
            DVec2::new(point.x, point.y.max(0.0))
        })
        .collect()
}

/// Length of the ray from a point inside the circle about the origin to the circle.
fn distance_to_border(from: DVec2, direction: DVec2, radius: f64) -> f64 {
    let b = from.dot(direction);
    (b * b + radius * radius - from.length_squared()).max(0.0).sqrt() - b
}

/// The upper convex hull of the meridian and the border point (reach, 0).
fn pull_taut(meridian: &[DVec2], reach: f64, profile: &mut Vec<DVec2>) {
    profile.clear();
    for &point in meridian.iter().chain([&DVec2::new(reach, 0.0)]) {
        while let [.., a, b] = profile[..] {
            if (b - a).perp_dot(point - b) < 0.0 {
                break;
            }
            profile.pop();
        }
        profile.push(point);
    }
}

/// The point at a fraction of a polyline's length.
fn along(profile: &[DVec2], fraction: f64) -> DVec2 {
    let length: f64 = profile.windows(2).map(|p| p[0].distance(p[1])).sum();
    let mut left = fraction.clamp(0.0, 1.0) * length;
    for pair in profile.windows(2) {
        let piece = pair[0].distance(pair[1]);
        if left <= piece && piece > 0.0 {
            return pair[0].lerp(pair[1], left / piece);
        }
        left -= piece;
    }
    profile[profile.len() - 1]
}

//! A first shape from geometry alone: in every vertical plane through the dome's axis, the string
//! pulled tight over the dome and down to the pocket's border, stretched evenly along its length.

use crate::implant::Dome;
use crate::sheet::{NodeKind, Sheet};
use glam::{DVec2, DVec3};

/// Points sampled along the dome's meridian.
const MERIDIAN: usize = 64;

/// Positions \[mm\] of every node; clamped and outside nodes at rest on the wall.
pub(crate) fn tight_string(sheet: &Sheet, dome: &Dome) -> Vec<DVec3> {
    let meridian = meridian(dome);
    let mut string = Vec::with_capacity(MERIDIAN + 2);
    sheet
        .rest()
        .iter()
        .zip(sheet.kinds())
        .map(|(&rest, kind)| {
            let from_axis = rest - dome.center;
            let distance = from_axis.length();
            if *kind != NodeKind::Free {
                return rest.extend(0.0);
            }
            let direction = if distance > 0.0 { from_axis / distance } else { DVec2::X };
            let reach = distance_to_border(dome.center, direction, sheet.radius_mm());
            pull_tight(&meridian, reach, &mut string);
            let at = along(&string, distance / reach);
            (dome.center + direction * at.x).extend(at.y)
        })
        .collect()
}

/// The dome's meridian above the wall as (distance from its axis, height), from the apex down.
fn meridian(dome: &Dome) -> Vec<DVec2> {
    let last = (-dome.base_height / dome.projection).clamp(0.0, 1.0).acos();
    (0..=MERIDIAN)
        .map(|k| {
            let angle = last * k as f64 / MERIDIAN as f64;
            DVec2::new(
                dome.base_radius * angle.sin(),
                (dome.base_height + dome.projection * angle.cos()).max(0.0),
            )
        })
        .collect()
}

/// Length of the ray from a point inside the circle about the origin to the circle.
fn distance_to_border(from: DVec2, direction: DVec2, radius: f64) -> f64 {
    let b = from.dot(direction);
    (b * b + radius * radius - from.length_squared()).max(0.0).sqrt() - b
}

/// The upper convex hull of the meridian and the border point (reach, 0).
fn pull_tight(meridian: &[DVec2], reach: f64, string: &mut Vec<DVec2>) {
    string.clear();
    for &point in meridian.iter().chain([&DVec2::new(reach, 0.0)]) {
        while let [.., a, b] = string[..] {
            if (b - a).perp_dot(point - b) < 0.0 {
                break;
            }
            string.pop();
        }
        string.push(point);
    }
}

/// The point at a fraction of a polyline's length.
fn along(string: &[DVec2], fraction: f64) -> DVec2 {
    let length: f64 = string.windows(2).map(|p| p[0].distance(p[1])).sum();
    let mut left = fraction.clamp(0.0, 1.0) * length;
    for pair in string.windows(2) {
        let piece = pair[0].distance(pair[1]);
        if left <= piece && piece > 0.0 {
            return pair[0].lerp(pair[1], left / piece);
        }
        left -= piece;
    }
    string[string.len() - 1]
}

//! What a node in contact may do: admissible places, directions that are left, constrained inverses.

use super::super::blocks::outer;
use crate::implant::Dome;
use glam::{DMat3, DVec3};

/// Touches nothing.
pub(super) const FREE: u8 = 0;
/// Pressed by the dome.
pub(super) const ON_DOME: u8 = 1;
/// Pressed by the wall; may be both.
pub(super) const ON_WALL: u8 = 2;

/// The nearest admissible point along simple paths: up to the wall, then out of the dome's given level.
pub(super) fn admissible(dome: &Dome, mut point: DVec3, level: f64) -> DVec3 {
    point.z = point.z.max(0.0);
    if dome.level(point) < level { dome.onto_level(point, level) } else { point }
}

/// Second derivative of the dome's level \[1/mm²\].
pub(super) fn curvature(dome: &Dome, point: DVec3) -> DMat3 {
    let scale = DVec3::new(
        1.0 / (dome.base_radius * dome.base_radius),
        1.0 / (dome.base_radius * dome.base_radius),
        1.0 / (dome.projection * dome.projection),
    );
    let gradient = dome.level_gradient(point);
    (DMat3::from_diagonal(scale) - outer(gradient, gradient)) * (1.0 / (dome.level(point) + 1.0))
}

/// The projector onto the directions that the given contacts leave.
pub(super) fn projector(flags: u8, normal: DVec3) -> DMat3 {
    match flags {
        FREE => DMat3::IDENTITY,
        ON_DOME => DMat3::IDENTITY - outer(normal, normal),
        ON_WALL => DMat3::from_diagonal(DVec3::new(1.0, 1.0, 0.0)),
        _ => {
            let t = edge_direction(normal);
            outer(t, t)
        }
    }
}

/// Along the circle where dome and wall meet.
pub(super) fn edge_direction(normal: DVec3) -> DVec3 {
    normal.cross(DVec3::Z).normalize_or(DVec3::X)
}

/// The least step that meets both constraints: n·d = −gap and d.z = −height.
pub(super) fn corner_step(normal: DVec3, gap: f64, height: f64) -> DVec3 {
    let across = normal.truncate();
    let length = across.length_squared();
    let share = if length > 1e-12 { (-gap + normal.z * height) / length } else { 0.0 };
    (across * share).extend(-height)
}

/// What dome and wall take of a force where both touch, if both press: force + d n + w z is along the
/// edge between them then.
pub(super) fn shares(force: DVec3, normal: DVec3) -> Option<[f64; 2]> {
    let (f, z) = (force.dot(normal), normal.z);
    let spread = 1.0 - z * z;
    let shares = [(z * force.z - f) / spread, (z * f - force.z) / spread];
    (spread > 1e-12 && shares.iter().all(|share| *share >= 0.0)).then_some(shares)
}

/// The inverse of a block restricted to the plane across `normal`.
pub(super) fn without(inverse: DMat3, normal: DVec3) -> DMat3 {
    let s = inverse * normal;
    inverse - outer(s, s) * (1.0 / normal.dot(s))
}

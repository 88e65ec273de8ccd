//! First shapes over a centred hemisphere, from geometry alone.

use crate::contact::Dome;
use crate::mesh::{NodeKind, Sheet};
use glam::{DVec2, DVec3};

/// The string pulled tight from the apex over the dome and down to the border, in every vertical
/// plane through the axis, stretched evenly: positions \[mm\], shape (nodes_per_side², ).
pub(super) fn tight_string(sheet: &Sheet, dome: &Dome) -> Vec<DVec3> {
    let (reach, radius, base) = (sheet.radius_mm(), dome.base_radius, dome.base_height);
    // From the centre of the sphere: the border point, and where the string leaves the dome.
    let distance = reach.hypot(base);
    let free = (distance * distance - radius * radius).max(0.0).sqrt();
    let last = reach.atan2(-base) - (radius / distance).min(1.0).acos();
    let length = radius * last + free;
    let border = DVec2::new(reach, 0.0);
    on_free_nodes(sheet, |rest| {
        let r = rest.length();
        let along = r / reach * length;
        let on_dome = |angle: f64| DVec2::new(radius * angle.sin(), base + radius * angle.cos());
        let at = if along <= radius * last {
            on_dome(along / radius)
        } else {
            on_dome(last).lerp(border, (along - radius * last) / free)
        };
        (rest.normalize_or_zero() * at.x).extend(at.y)
    })
}

/// The flat sheet lifted straight up onto the dome: positions \[mm\], shape (nodes_per_side², ).
pub(super) fn drape(sheet: &Sheet, dome: &Dome) -> Vec<DVec3> {
    on_free_nodes(sheet, |rest| {
        let squared = dome.base_radius * dome.base_radius - rest.length_squared();
        rest.extend((dome.base_height + squared.max(0.0).sqrt()).max(0.0))
    })
}

fn on_free_nodes(sheet: &Sheet, place: impl Fn(DVec2) -> DVec3) -> Vec<DVec3> {
    let place = |(rest, kind): (&DVec2, &NodeKind)| match kind {
        NodeKind::Free => place(*rest),
        _ => rest.extend(0.0),
    };
    sheet.rest().iter().zip(sheet.kinds()).map(place).collect()
}

//! Initial guesses over a centred hemisphere, from geometry alone.

use crate::contact::Dome;
use crate::mesh::{NodeKind, Sheet};
use glam::{DVec2, DVec3};

/// Taut profile from the apex over the dome to the border with uniform meridional stretch: positions
/// \[mm\], shape (nodes_per_side², ).
pub(super) fn taut_profile(sheet: &Sheet, dome: &Dome) -> Vec<DVec3> {
    let (pocket, radius, base) = (sheet.radius_mm(), dome.base_radius, dome.base_height);
    // Polar angle of the contact edge from the centre of the sphere, and length of the free part.
    let distance = pocket.hypot(base);
    let free = (distance * distance - radius * radius).max(0.0).sqrt();
    let last = pocket.atan2(-base) - (radius / distance).min(1.0).acos();
    let length = radius * last + free;
    let border = DVec2::new(pocket, 0.0);
    on_free_nodes(sheet, |rest| {
        let r = rest.length();
        let along = r / pocket * length;
        let on_dome = |angle: f64| DVec2::new(radius * angle.sin(), base + radius * angle.cos());
        let at = if along <= radius * last {
            on_dome(along / radius)
        } else {
            on_dome(last).lerp(border, (along - radius * last) / free)
        };
        (rest.normalize_or_zero() * at.x).extend(at.y)
    })
}

/// The flat sheet projected vertically onto the dome: positions \[mm\], shape (nodes_per_side², ).
pub(super) fn drape(sheet: &Sheet, dome: &Dome) -> Vec<DVec3> {
    on_free_nodes(sheet, |rest| {
        let squared = dome.base_radius * dome.base_radius - rest.length_squared();
        rest.extend((dome.base_height + squared.max(0.0).sqrt()).max(0.0))
    })
}

/// Positions of the free nodes by `position`; the other nodes stay at rest.
fn on_free_nodes(sheet: &Sheet, position: impl Fn(DVec2) -> DVec3) -> Vec<DVec3> {
    let of_node = |(rest, kind): (&DVec2, &NodeKind)| match kind {
        NodeKind::Free => position(*rest),
        _ => rest.extend(0.0),
    };
    sheet.rest().iter().zip(sheet.kinds()).map(of_node).collect()
}

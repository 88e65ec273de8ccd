//! Files of surfaces.

use crate::read::Unit;
use crate::surface::Surface;
use implant_preview_solver::export::{Axes, Body, Format, Part, Solid, srgb};

/// The file of a surface with its own vertices in their order and its own axes: PLY, STL and OBJ in the unit, glTF in metres.
/// Positions are rounded to 32 bits; STL has no colours.
#[must_use]
pub fn write(surface: &Surface, unit: Unit, format: Format) -> Vec<u8> {
    let unit = if format == Format::Glb { Unit::M } else { unit };
    let vertices =
        surface.positions.iter().map(|position| (*position / unit.factor()).as_vec3()).collect();
    let colors = surface.colors.iter().flatten().map(|color| color.map(srgb::to_linear));
    let solid = Solid {
        body: Body::Torso,
        vertices,
        parts: vec![Part { name: "surface", triangles: surface.triangles.clone() }],
        colours: colors.collect(),
    };
    let axes = Axes { unit: unit.name(), metres: unit.factor() as f32 / 1000.0, is_z_up: false };
    format.encode_in(axes, &[solid])
}

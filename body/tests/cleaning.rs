//! Cleaning: unusable vertices and faces, inside-out surfaces, units, parts.

#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

#[path = "common/files.rs"]
mod files;

use files::cube;
use glam::DVec3;
use implant_preview_body::read::{Format, Unit, read};
use implant_preview_body::surface::Surface;
use implant_preview_body::write::write;

/// A hemisphere of so many rings \[mm\], open at its base, outward.
fn shell(radius: f64, rings: u32) -> Surface {
    let around = 4 * rings;
    let at = |ring: u32, step: u32| ring * around + step % around;
    let mut surface = Surface::default();
    for (ring, step) in (0..=rings).flat_map(|ring| (0..around).map(move |step| (ring, step))) {
        let polar = (0.05 + 0.95 * f64::from(ring) / f64::from(rings)) * 0.5 * std::f64::consts::PI;
        let turn = f64::from(step) / f64::from(around) * std::f64::consts::TAU;
        let (sin, cos) = polar.sin_cos();
        surface.positions.push(DVec3::new(sin * turn.cos(), sin * turn.sin(), cos) * radius);
        if ring < rings {
            let [a, b, c, d] =
                [at(ring, step), at(ring + 1, step), at(ring + 1, step + 1), at(ring, step + 1)];
            surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    surface
}

#[test]
fn an_inside_out_surface_is_turned_closed_or_open() {
    for surface in [cube(), shell(200.0, 8)] {
        let mut inside_out = surface.clone();
        inside_out.turn();
        for shift in [DVec3::ZERO, DVec3::new(3000.0, -500.0, 9000.0)] {
            for (surface, is_turned) in [(&surface, false), (&inside_out, true)] {
                let mut moved = surface.clone();
                moved.positions.iter_mut().for_each(|position| *position += shift);
                let found = read(&write(&moved, Unit::Mm, Format::Ply), "").unwrap();
                assert_eq!(found.cleaned.is_turned, is_turned);
                assert!(found.surface.signed_volume() > 0.0);
            }
        }
    }
    // A plane has no side.
    let plane = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                 element face 1\nproperty list uchar int vertex_indices\nend_header\n\
                 0.1 0.7 0.3\n300.9 0.3 0.2\n0.6 300.1 0.1\n3 0 1 2\n";
    for face in ["3 0 1 2", "3 2 1 0"] {
        assert!(!read(plane.replace("3 0 1 2", face).as_bytes(), "").unwrap().cleaned.is_turned);
    }
}

#[test]
fn the_unit_is_that_in_which_the_extent_is_a_bodys() {
    let sizes = [
        (0.4, Unit::M),
        (1.75, Unit::M),
        (45.0, Unit::Cm),
        (175.0, Unit::Cm),
        (400.0, Unit::Mm),
        (1750.0, Unit::Mm),
    ];
    for (extent, unit) in sizes {
        let mut surface = cube();
        surface.positions.iter_mut().for_each(|position| *position *= extent / 300.0);
        // A vertex without a triangle has no part in the extent.
        surface.positions.push(DVec3::splat(5000.0));
        surface.colors = None;
        let mut found = read(&write(&surface, Unit::Mm, Format::Ply), "").unwrap();
        assert_eq!(found.unit, unit, "{extent}");
        let [least, most] = found.surface.bounds().unwrap();
        assert!(((most - least).max_element() / (extent * unit.factor()) - 1.0).abs() < 1e-6);
        // Another unit by hand.
        found.set_unit(Unit::Cm);
        let [least, most] = found.surface.bounds().unwrap();
        assert!(((most - least).max_element() / (extent * 10.0) - 1.0).abs() < 1e-6);
    }
}

#[test]
fn stray_parts_are_counted_and_kept() {
    let mut surface = shell(200.0, 8);
    let own = surface.triangles.len();
    // Seams of a texture: each triangle has its own vertices.
    let seams = Surface {
        positions: surface
            .triangles
            .as_flattened()
            .iter()
            .map(|k| surface.positions[*k as usize])
            .collect(),
        triangles: (0..own as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect(),
        colors: None,
    };
    let found = read(&write(&seams, Unit::Mm, Format::Obj), "").unwrap();
    assert_eq!((found.cleaned.parts, found.surface.positions.len()), (1, 3 * own));
    assert_eq!(found.cleaned.repeated_vertices, 3 * own - surface.positions.len());
    let first = surface.positions.len() as u32;
    surface.positions.extend([DVec3::ZERO, DVec3::X * 20.0, DVec3::Y * 20.0]);
    surface.triangles.push([first, first + 1, first + 2]);
    for format in Format::ALL {
        let found = read(&write(&surface, Unit::Mm, format), "").unwrap();
        assert_eq!((found.cleaned.parts, found.surface.triangles.len()), (2, own + 1));
        assert_eq!(found.cleaned.notes(), ["Parts that are not connected: 2."]);
        assert_eq!(found.surface.parts(), 2);
    }
}

#[test]
fn unusable_vertices_and_faces_are_dropped_and_counted() {
    let text = "ply\nformat ascii 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty float z\n\
                property uchar red\nproperty uchar green\nproperty uchar blue\n\
                element face 10\nproperty list uchar int vertex_indices\nend_header\n\
                nan 0 0 1 1 1\n0 0 0 2 2 2\n300 0 0 3 3 3\n300 300 0 4 4 4\n0 inf 0 5 5 5\n0 300 0 6 6 6\n150 0 0 7 7 7\n2e7 0 0 8 8 8\n\
                4 1 2 3 5\n3 0 1 2\n3 1 2 4\n3 1 2 7\n3 1 2 8\n3 1 2 -1\n3 1 2 4000000000\n3 1 1 2\n3 1 6 2\n2 1 2\n";
    let found = read(text.as_bytes(), "").unwrap();
    assert_eq!(found.surface.positions.len(), 5);
    assert_eq!(found.surface.colors.unwrap(), [[2; 3], [3; 3], [4; 3], [6; 3], [7; 3]]);
    assert_eq!(found.surface.triangles, [[0, 1, 2], [0, 2, 3]]);
    let notes = [
        "Vertices that are not finite, dropped: 3.",
        "Faces of such vertices, dropped: 3.",
        "Faces of vertices that the file does not have, dropped: 3 (the first is face 5).",
        "Triangles without an area, dropped: 3.",
        "Polygons split into triangles: 1.",
    ];
    assert_eq!(found.cleaned.notes(), notes);
    // A soup, whose corners are merged, drops them too.
    let mut bytes = write(&cube(), Unit::Mm, Format::Stl);
    bytes[84 + 12..84 + 16].copy_from_slice(&f32::NAN.to_le_bytes());
    let found = read(&bytes, "").unwrap();
    assert_eq!((found.surface.positions.len(), found.surface.triangles.len()), (8, 11));
    assert_eq!((found.cleaned.dropped_vertices, found.cleaned.dropped_faces), (1, 1));
}

#[test]
fn welding_maps_each_vertex_to_the_first_at_its_position() {
    let surface = Surface {
        positions: vec![DVec3::X, DVec3::ZERO, DVec3::X, -DVec3::ZERO, DVec3::Y, DVec3::ZERO],
        triangles: vec![[0, 1, 4], [2, 3, 4]],
        colors: None,
    };
    assert_eq!(surface.weld(), [0, 1, 0, 1, 4, 1]);
    assert_eq!(surface.parts(), 1);
    assert!(Surface::default().weld().is_empty());
    assert_eq!((Surface::default().parts(), Surface::default().bounds()), (0, None));
}

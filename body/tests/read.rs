//! Surfaces read from files: formats, damaged files, cleaning, limits.

#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

#[path = "common/files.rs"]
mod files;

use files::{cube, glb, phone_data, phone_json};
use glam::{DMat4, DVec2, DVec3, Vec3};
use implant_preview_body::read::{Format, Read, Unit, read};
use implant_preview_body::surface::Surface;
use implant_preview_body::write::write;
use implant_preview_solver::contact::{Dome, HalfBall};
use implant_preview_solver::export::Solid;
use std::fmt::Write as _;

fn ascii_ply(positions: &[DVec3], faces: &[&[u32]]) -> String {
    let (vertices, count) = (positions.len(), faces.len());
    let mut text = format!(
        "ply\nformat ascii 1.0\ncomment a cube\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nelement face {count}\nproperty list uchar int vertex_indices\nend_header\n"
    );
    positions.iter().for_each(|p| writeln!(text, "{} {} {}", p.x, p.y, p.z).unwrap());
    for face in faces {
        let corners: Vec<String> = face.iter().map(u32::to_string).collect();
        writeln!(text, "{} {}", face.len(), corners.join(" ")).unwrap();
    }
    text
}

fn cube_ply() -> String {
    let Surface { positions, triangles, .. } = cube();
    let faces: Vec<&[u32]> = triangles.iter().map(<[u32; 3]>::as_slice).collect();
    ascii_ply(&positions, &faces)
}

fn of(text: &str) -> Read {
    read(text.as_bytes(), "").unwrap()
}

fn line_of(bytes: &[u8], name: &str) -> String {
    let line = read(bytes, name).unwrap_err().to_string();
    assert!(line.len() > 5 && line.chars().count() < 200, "{line}");
    assert!(!line.chars().any(char::is_control), "{line:?}");
    line
}

#[test]
fn every_writer_of_closed_meshes_is_read_back() {
    let solid =
        Solid::implant(&Dome::new(DVec2::new(5.0, -3.0), HalfBall::round(160.0, 40.0), 1.0));
    let triangles: Vec<[u32; 3]> = solid.triangles().collect();
    for format in [Format::Ply, Format::Stl, Format::Obj] {
        // The content decides, not the name.
        let found = read(&format.encode(std::slice::from_ref(&solid)), "scan.dat").unwrap();
        assert_eq!((found.format, found.unit, found.cleaned.parts), (format, Unit::Mm, 1));
        assert!(!found.cleaned.is_turned && found.cleaned.notes().is_empty(), "{found:?}");
        assert_eq!(found.surface.triangles.len(), triangles.len());
        // A text has decimals of 32-bit numbers.
        let positions: Vec<Vec3> = found.surface.positions.iter().map(|p| p.as_vec3()).collect();
        for (own, other) in found.surface.triangles.iter().zip(&triangles) {
            let expected = other.map(|k| solid.vertices[k as usize]);
            assert_eq!(own.map(|k| positions[k as usize]), expected);
        }
        // Vertices of an STL file come back merged, none twice.
        assert_eq!(positions.len(), solid.vertices.len());
        if format != Format::Stl {
            assert_eq!((&positions, &found.surface.triangles), (&solid.vertices, &triangles));
        }
    }
}

#[test]
fn ply_is_the_same_in_ascii_and_both_byte_orders() {
    let expected = of(&cube_ply());
    let Surface { positions, triangles, .. } = cube();
    assert_eq!(
        (&expected.surface.positions, &expected.surface.triangles),
        (&positions, &triangles)
    );
    for is_big in [false, true] {
        let order = if is_big { "big" } else { "little" };
        let mut bytes = format!(
            "ply\r\nformat binary_{order}_endian 1.0\r\nelement material 1\r\nproperty list ushort double shine\r\n\
             element vertex 8\r\nproperty double x\r\nproperty short quality\r\nproperty double y\r\n\
             property double z\r\nproperty uchar red\r\nproperty uchar green\r\nproperty uchar blue\r\n\
             element face 12\r\nproperty uchar group\r\nproperty list ushort uint vertex_index\r\nend_header\r\n"
        )
        .into_bytes();
        let mut put = |value: &[u8]| {
            let mut value = value.to_vec();
            if is_big {
                value.reverse();
            }
            bytes.extend(value);
        };
        put(&2_u16.to_le_bytes());
        [1.0_f64, 2.0].iter().for_each(|shine| put(&shine.to_le_bytes()));
        for (k, p) in positions.iter().enumerate() {
            put(&p.x.to_le_bytes());
            put(&7_i16.to_le_bytes());
            put(&p.y.to_le_bytes());
            put(&p.z.to_le_bytes());
            [k as u8, 100, 255].iter().for_each(|value| put(&[*value]));
        }
        for triangle in &triangles {
            put(&[1]);
            put(&3_u16.to_le_bytes());
            triangle.iter().for_each(|k| put(&k.to_le_bytes()));
        }
        let found = read(&bytes, "cube.ply").unwrap();
        assert_eq!(found.surface.positions, positions);
        assert_eq!(found.surface.triangles, triangles);
        let colors: Vec<[u8; 3]> = (0..8).map(|k| [k, 100, 255]).collect();
        assert_eq!(found.surface.colors, Some(colors));
    }
}

#[test]
fn stl_is_read_as_text_and_as_binary_that_begins_with_solid() {
    let Surface { positions, triangles, .. } = cube();
    let mut text = "solid a cube of 300 mm\n".to_owned();
    let mut bytes = b"solid cube".to_vec();
    bytes.resize(80, b' ');
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for triangle in &triangles {
        text += "  facet normal 0 0 1\n outer loop\n";
        bytes.extend([0; 12]);
        for p in triangle.map(|k| positions[k as usize]) {
            writeln!(text, "vertex {:e} {} {}", p.x, p.y, p.z).unwrap();
            p.to_array().iter().for_each(|value| bytes.extend((*value as f32).to_le_bytes()));
        }
        text += "endloop\nendfacet\n";
        bytes.extend([0, 0]);
    }
    text += "endsolid a cube of 300 mm\n";
    for bytes in [text.as_bytes(), &bytes] {
        let found = read(bytes, "").unwrap();
        assert_eq!((found.format, found.surface.positions.len()), (Format::Stl, 8));
        assert_eq!((found.surface.triangles.len(), found.cleaned.parts), (12, 1));
        assert!((found.surface.signed_volume() - 300.0_f64.powi(3)).abs() < 1e-6);
    }
    // Bytes behind the last triangle are ignored; a cut file is an error.
    let longer = [bytes.as_slice(), b"tail"].concat();
    assert_eq!(read(&longer, "cube.stl").unwrap().surface.triangles.len(), 12);
    let line = line_of(&bytes[..600], "cube.stl");
    let fault = "byte 600: it ends after 10 of 12 triangles";
    let remedy = "export the surface again, as PLY or STL";
    assert_eq!(line, format!("the file is damaged: {fault}; {remedy}"));
    let line = line_of(&text.as_bytes()[..600], "cube.stl");
    assert!(line.starts_with("the file is damaged: line "), "{line}");
}

#[test]
fn obj_has_groups_polygons_textures_negative_indices_continued_lines_and_colours() {
    let text = "# exported\r\nmtllib a.mtl\r\ng front\r\nv 0 0 0 1 0 0\r\nv 300 0 0 0 1 0\r\nv 300 \\\r\n 300 0 0 0 0.5\r\n\
                v 0 300 0 1 1 1\r\nvt 0 0\r\nvn 0 0 1\r\nusemtl skin\r\nf 1/1/1 2/1/1 3/1/1 4/1/1\r\ng back\r\n\
                v 0 0 -9 0 0 0\r\nf 2//1 1//1 -1\r\n";
    let found = of(text);
    assert_eq!(found.surface.triangles, [[0, 1, 2], [0, 2, 3], [1, 0, 4]]);
    assert_eq!((found.format, found.cleaned.split_faces, found.cleaned.parts), (Format::Obj, 1, 1));
    let colors = vec![[255, 0, 0], [0, 255, 0], [0, 0, 128], [255; 3], [0; 3]];
    assert_eq!(found.surface.colors, Some(colors));
    // Colours of some vertices are none.
    assert_eq!(of(&text.replace("v 0 0 -9 0 0 0", "v 0 0 -9")).surface.colors, None);
    // Colours as bytes.
    let bytes = text.replace("v 0 0 0 1 0 0", "v 0 0 0 200 10 0");
    assert_eq!(of(&bytes).surface.colors.unwrap()[0], [200, 10, 0]);
    let line = line_of(text.replace("f 2//1", "f 0//1").as_bytes(), "");
    let start = "the file is damaged: line 15: \"0//1\" is no vertex; allowed: ";
    assert!(line.starts_with(start), "{line}");
}

#[test]
fn polygons_with_a_reflex_corner_are_split_inside() {
    // An arrowhead and an L of six corners: the area of the triangles is the polygon's, none is turned.
    let arrow = [[0.0, 0.0], [300.0, -100.0], [100.0, 0.0], [300.0, 100.0]];
    let angle =
        [[0.0, 0.0], [400.0, 0.0], [400.0, 100.0], [100.0, 100.0], [100.0, 400.0], [0.0, 400.0]];
    for (polygon, area) in [(arrow.as_slice(), 10_000.0), (&angle, 70_000.0)] {
        for turn in 0..polygon.len() {
            let positions: Vec<DVec3> =
                polygon.iter().map(|[x, y]| DVec3::new(*x, *y, 0.0)).collect();
            let n = polygon.len() as u32;
            let face: Vec<u32> = (0..n).map(|k| (k + turn as u32) % n).collect();
            let found = of(&ascii_ply(&positions, &[&face]));
            assert_eq!(found.surface.triangles.len(), polygon.len() - 2);
            assert!((found.surface.area() - area).abs() < 1e-9, "{:?}", found.surface);
        }
    }
}

#[test]
fn a_written_surface_has_its_own_vertices_in_their_order_in_its_unit() {
    let mut surface = cube();
    // A vertex without a triangle, and one at the place of another.
    surface.positions.extend([DVec3::new(0.3, 0.1, 0.7), surface.positions[0]]);
    surface.triangles[0][0] = 9;
    surface.colors.as_mut().unwrap().extend([[0, 1, 2], [9; 3]]);
    for (unit, format) in Unit::ALL.into_iter().flat_map(|unit| Format::ALL.map(|f| (unit, f))) {
        let found = read(&write(&surface, unit, format), "").unwrap();
        assert_eq!(found.format, format);
        assert_eq!(found.unit, if format == Format::Glb { Unit::M } else { unit });
        if format == Format::Stl {
            assert_eq!((found.surface.positions.len(), found.surface.colors), (8, None));
            continue;
        }
        assert_eq!(
            (&found.surface.triangles, &found.surface.colors),
            (&surface.triangles, &surface.colors)
        );
        assert_eq!((found.cleaned.repeated_vertices, found.cleaned.parts), (1, 1));
        for (own, expected) in found.surface.positions.iter().zip(&surface.positions) {
            assert!((*own - *expected).length() < 1e-4, "{own} {expected}");
        }
        // What was read is written to the last bit.
        let again = write(&found.surface, found.unit, format);
        assert_eq!(again, write(&surface, unit, format));
    }
}

/// Positions and triangles of a GLB file by another reader \[m\].
fn by_gltf(bytes: &[u8]) -> (Vec<DVec3>, Vec<u32>, Option<Vec<[u8; 3]>>) {
    fn walk(node: &gltf::Node, parent: DMat4, found: &mut Vec<(usize, DMat4)>) {
        let own = node.transform().matrix().map(|column| column.map(f64::from));
        let own = parent * DMat4::from_cols_array_2d(&own);
        found.extend(node.mesh().map(|mesh| (mesh.index(), own)));
        node.children().for_each(|child| walk(&child, own, found));
    }
    let file = gltf::Gltf::from_slice(bytes).unwrap();
    let blob = file.blob.as_deref().unwrap();
    let mut meshes = Vec::new();
    file.scenes().next().unwrap().nodes().for_each(|n| walk(&n, DMat4::IDENTITY, &mut meshes));
    let (mut positions, mut corners, mut colors) = (Vec::new(), Vec::new(), None);
    for (mesh, to_scene) in meshes {
        for primitive in file.meshes().nth(mesh).unwrap().primitives() {
            let reader = primitive.reader(|_| Some(blob));
            let first = positions.len() as u32;
            let own = reader.read_positions().unwrap().map(|p| Vec3::from(p).as_dvec3());
            positions.extend(own.map(|p| to_scene.transform_point3(p)));
            let all = first..positions.len() as u32;
            let indices = reader.read_indices().map(gltf::mesh::util::ReadIndices::into_u32);
            corners.extend(
                indices.map_or(all.collect::<Vec<_>>(), |own| own.map(|k| k + first).collect()),
            );
            colors = reader.read_colors(0).map(|colors| colors.into_rgb_u8().collect());
        }
    }
    (positions, corners, colors)
}

#[test]
fn glb_is_moved_by_its_nodes_as_another_reader_does() {
    let bytes = glb(&phone_json(), &phone_data());
    let found = read(&bytes, "scan.glb").unwrap();
    let (positions, corners, linear) = by_gltf(&bytes);
    assert_eq!((found.format, found.unit, found.cleaned.is_turned), (Format::Glb, Unit::M, false));
    assert_eq!(found.surface.triangles.as_flattened(), corners);
    for (own, expected) in found.surface.positions.iter().zip(&positions) {
        assert!((*own - *expected * 1000.0).length() < 1e-4, "{own} {expected}");
    }
    // Linear 55 of 255 is sRGB 128.
    assert_eq!(linear.unwrap()[2], [55; 3]);
    assert_eq!(found.surface.colors.unwrap(), [[0; 3], [255, 0, 0], [128; 3], [255; 3]]);
}

#[test]
fn glb_has_several_meshes_and_indices_of_any_width_or_none() {
    let mut json = phone_json();
    let mut data = phone_data();
    // The same triangles by bytes and by words, a strip, a fan, corners one by one; a part of points is skipped.
    data.extend([0_u8, 1, 2, 0, 2, 3, 0, 0]);
    data.extend([0_u32, 1, 2, 0, 2, 3].iter().flat_map(|k| k.to_le_bytes()));
    data.extend([1_u8, 2, 0, 3]);
    data.extend([0_u8, 1, 2, 3]);
    json["buffers"][0]["byteLength"] = data.len().into();
    for (kind, start, count) in [(5121, 76, 6), (5125, 84, 6), (5121, 108, 4), (5121, 112, 4)] {
        let view = json["bufferViews"].as_array().unwrap().len();
        let length = if kind == 5125 { 24 } else { count };
        json["bufferViews"]
            .as_array_mut()
            .unwrap()
            .push(serde_json::json!({ "buffer": 0, "byteOffset": start, "byteLength": length }));
        json["accessors"].as_array_mut().unwrap().push(
            serde_json::json!({ "bufferView": view, "componentType": kind, "type": "SCALAR", "count": count }));
    }
    let part = |indices: u32, mode: u32| serde_json::json!({ "attributes": { "POSITION": 0 }, "indices": indices, "mode": mode });
    let alone = serde_json::json!({ "attributes": { "POSITION": 0 } });
    json["meshes"] = serde_json::json!([
        { "primitives": [part(3, 4), part(4, 4), part(5, 5)] },
        { "primitives": [part(6, 6), alone, part(3, 0)] },
    ]);
    json["nodes"] = serde_json::json!([{ "mesh": 0 }, { "children": [0, 2] }, { "mesh": 1, "scale": [-1, 1, 1] }]);
    let mut found = read(&glb(&json, &data), "").unwrap();
    // Mirrored beside itself the surface has no side of its own.
    if found.cleaned.is_turned {
        found.surface.turn();
    }
    let own: Vec<[u32; 3]> = found.surface.triangles.iter().map(|t| t.map(|k| k % 4)).collect();
    // A strip turns every second triangle, a mirrored node all.
    let whole = [[0, 1, 2], [0, 2, 3]];
    let expected = [whole, whole, [[1, 2, 0], [2, 3, 0]], [[0, 2, 1], [0, 3, 2]]].concat();
    assert_eq!(own[..8], expected);
    assert_eq!(own[8..], [[0, 2, 1]]);
    // Parts of one mesh have their vertices in common.
    assert_eq!((found.surface.positions.len(), found.surface.colors), (8, None));
    assert_eq!(found.surface.positions[5], DVec3::new(-f64::from(0.3_f32) * 1000.0, 0.0, 0.0));
}

/// A file of a phone with a texture: colours of vertices are kept and written, a texture is left out with a line.
#[test]
fn glb_keeps_colours_of_vertices_and_leaves_a_texture_out() {
    let (mut json, data) = (phone_json(), phone_data());
    json["textures"] = serde_json::json!([{ "source": 0 }]);
    json["images"] = serde_json::json!([{ "uri": "skin.png" }]);
    let plain = "The colours of the texture are left out.";
    let has_line = |notes: &[String]| notes.iter().any(|note| note == plain);
    let attributes = json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap();
    attributes.remove("COLOR_0");
    let found = read(&glb(&json, &data), "").unwrap();
    assert_eq!((found.surface.colors, found.cleaned.has_texture), (None, true));
    assert!(has_line(&found.cleaned.notes()), "{:?}", found.cleaned.notes());
    // Bytes, words and numbers that stand for fractions of linear light, with and without an opacity.
    let count = found.surface.positions.len();
    let light = [1.0_f32, 0.5, 0.0, 0.25];
    for (kind, width) in [(5121, 3), (5121, 4), (5123, 4), (5126, 3)] {
        let (mut json, mut data) = (json.clone(), data.clone());
        data.resize(data.len().next_multiple_of(4), 0);
        let start = data.len();
        for part in (0..count).flat_map(|_| &light[..width]) {
            match kind {
                5121 => data.push((part * 255.0).round() as u8),
                5123 => data.extend(((part * 65535.0).round() as u16).to_le_bytes()),
                _ => data.extend(part.to_le_bytes()),
            }
        }
        let view = json["bufferViews"].as_array().unwrap().len();
        let length = data.len() - start;
        json["bufferViews"]
            .as_array_mut()
            .unwrap()
            .push(serde_json::json!({ "buffer": 0, "byteOffset": start, "byteLength": length }));
        let accessor = json["accessors"].as_array().unwrap().len();
        json["accessors"].as_array_mut().unwrap().push(serde_json::json!({
            "bufferView": view, "componentType": kind, "type": format!("VEC{width}"),
            "count": count, "normalized": kind != 5126,
        }));
        json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = accessor.into();
        json["buffers"][0]["byteLength"] = data.len().into();
        let found = read(&glb(&json, &data), "").unwrap();
        let colors = vec![[255, 188, 0]; count];
        assert_eq!(found.surface.colors.as_ref(), Some(&colors), "{kind} {width}");
        assert!(!has_line(&found.cleaned.notes()));
        for format in [Format::Ply, Format::Obj, Format::Glb] {
            let again = read(&write(&found.surface, found.unit, format), "").unwrap();
            assert_eq!(again.surface.colors.as_ref(), Some(&colors), "{format:?}");
        }
    }
}

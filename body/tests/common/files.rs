//! Surfaces and files of the tests; properties of any input, which the fuzz target checks too.

#![allow(dead_code, reason = "each test uses a part")]

use glam::DVec3;
use implant_preview_body::read::{Format, MAX_TRIANGLES, read};
use implant_preview_body::surface::Surface;
use implant_preview_body::write::write;
use serde_json::{Value, json};

/// Checks that a file is rejected with one short line, or is a surface within its limits that can be written. Returns whether it
/// is a surface.
pub(crate) fn check_surface(bytes: &[u8], name: &str) -> bool {
    let found = match read(bytes, name) {
        Ok(found) => found,
        Err(error) => {
            let line = error.to_string();
            assert!(line.len() > 5 && line.chars().count() < 200, "{line}");
            assert!(!line.chars().any(char::is_control), "{line:?}");
            return false;
        }
    };
    let surface = &found.surface;
    let count = surface.positions.len();
    assert!((1..=MAX_TRIANGLES).contains(&surface.triangles.len()));
    assert!(surface.triangles.iter().flatten().all(|k| (*k as usize) < count));
    assert!(surface.positions.iter().all(|position| position.is_finite()));
    assert!(surface.colors.as_ref().is_none_or(|colors| colors.len() == count));
    assert!(surface.area() > 0.0 && surface.signed_volume().is_finite());
    assert!((1..=surface.triangles.len()).contains(&found.cleaned.parts));
    assert!(found.cleaned.notes().iter().all(|note| !note.chars().any(char::is_control)));
    for format in Format::ALL {
        let written = write(surface, found.unit, format);
        assert!(written.len() > 3 * surface.triangles.len());
        if let Ok(again) = read(&written, "") {
            // Rounding to 32 bits may only flatten triangles.
            assert_eq!(again.format, format);
            assert!(again.surface.triangles.len() <= surface.triangles.len());
        }
    }
    true
}

/// A cube of 300 mm with outward triangles, coloured.
pub(crate) fn cube() -> Surface {
    let corner = |k: u32| DVec3::new(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2));
    let quads =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    Surface {
        positions: (0..8).map(|k| corner(k) * 300.0).collect(),
        triangles: quads.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect(),
        colors: Some((0..8).map(|k| [k, 100, 255]).collect()),
    }
}

/// A GLB file of JSON and data.
pub(crate) fn glb(json: &Value, data: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut data = data.to_vec();
    data.resize(data.len().next_multiple_of(4), 0);
    let length = 12 + 8 + text.len() + 8 + data.len();
    let mut bytes = b"glTF".to_vec();
    bytes.extend([2, length as u32].into_iter().flat_map(u32::to_le_bytes));
    for (kind, chunk) in [(b"JSON", &text), (b"BIN\0", &data)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

/// A scene of one mesh in the file: two triangles in m with indices of 16 bits, colours of 8 bits, moved by two nodes.
pub(crate) fn phone_json() -> Value {
    json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [1] }],
        "nodes": [
            { "mesh": 0, "translation": [0.1, 0.0, 0.0], "rotation": [0.0, 0.0, 0.6, 0.8], "scale": [1, 2, 1] },
            { "children": [0], "matrix": [1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0.5, 0, 1] } ],
        "meshes": [{ "primitives": [
            { "attributes": { "POSITION": 0, "COLOR_0": 2 }, "indices": 1, "material": 0 } ] }],
        "materials": [{}],
        "buffers": [{ "byteLength": 76 }],
        "bufferViews": [{ "buffer": 0, "byteLength": 48 }, { "buffer": 0, "byteOffset": 48, "byteLength": 12 },
            { "buffer": 0, "byteOffset": 60, "byteLength": 16 }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 4,
              "min": [0.0, 0.0, -0.1], "max": [0.3, 0.4, 0.0] },
            { "bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 6 },
            { "bufferView": 2, "componentType": 5121, "normalized": true, "type": "VEC4", "count": 4 } ],
    })
}

/// The data of [`phone_json`].
pub(crate) fn phone_data() -> Vec<u8> {
    let positions: [[f32; 3]; 4] = [[0.0; 3], [0.3, 0.0, 0.0], [0.3, 0.4, 0.0], [0.0, 0.4, -0.1]];
    let mut data: Vec<u8> = positions.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    data.extend([0_u16, 1, 2, 0, 2, 3].iter().flat_map(|k| k.to_le_bytes()));
    data.extend([[0, 0, 0, 255], [255, 0, 0, 255], [55, 55, 55, 255], [255; 4]].concat());
    data
}

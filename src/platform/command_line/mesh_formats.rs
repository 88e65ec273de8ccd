//! The four mesh formats: binary STL, Wavefront OBJ, binary PLY, binary glTF 2.0.
//!
//! STL, OBJ and PLY have no unit; the lengths are in mm. glTF requires metres and y up.

use super::InputError;
use super::mesh::Surface;
use super::output::input_error;
use std::fmt::Write;
use std::path::Path;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Stl,
    Obj,
    Ply,
    Glb,
}

impl Format {
    /// The format of a file name, by its extension.
    pub(super) fn of_file(path: &Path) -> Result<Self, InputError> {
        let extension = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        match extension.as_str() {
            "stl" => Ok(Self::Stl),
            "obj" => Ok(Self::Obj),
            "ply" => Ok(Self::Ply),
            "glb" => Ok(Self::Glb),
            _ => Err(input_error(
                path,
                "--mesh: unknown format; allowed: a file name ending in .stl, .obj, .ply or .glb",
            )),
        }
    }

    pub(super) fn encode(self, surface: &Surface) -> Vec<u8> {
        match self {
            Self::Stl => stl(surface),
            Self::Obj => obj(surface).into_bytes(),
            Self::Ply => ply(surface),
            Self::Glb => glb(surface),
        }
    }
}

fn stl(surface: &Surface) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    let title = b"implant-preview: deformed tissue, mm";
    bytes[..title.len()].copy_from_slice(title);
    bytes.extend((surface.triangles().count() as u32).to_le_bytes());
    for triangle in surface.triangles() {
        let [a, b, c] = triangle.map(|k| surface.vertices[k as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for value in [normal, a, b, c].into_iter().flat_map(|v| v.to_array()) {
            bytes.extend(value.to_le_bytes());
        }
        bytes.extend([0, 0]);
    }
    bytes
}

fn obj(surface: &Surface) -> String {
    let mut text = "# implant-preview: deformed tissue, mm\n".to_owned();
    // Writing to a String cannot fail.
    for v in &surface.vertices {
        let _ = writeln!(text, "v {} {} {}", v.x, v.y, v.z);
    }
    for part in &surface.parts {
        let _ = writeln!(text, "g {}", part.name);
        for [a, b, c] in part.triangles.iter().map(|t| t.map(|k| k + 1)) {
            let _ = writeln!(text, "f {a} {b} {c}");
        }
    }
    text
}

fn ply(surface: &Surface) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\ncomment implant-preview: deformed tissue, mm\n\
         element vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        surface.vertices.len(),
        surface.triangles().count()
    )
    .into_bytes();
    for value in surface.vertices.iter().flat_map(glam::Vec3::to_array) {
        bytes.extend(value.to_le_bytes());
    }
    for triangle in surface.triangles() {
        bytes.push(3);
        triangle.iter().for_each(|k| bytes.extend(k.to_le_bytes()));
    }
    bytes
}

/// One mesh per part; all meshes share one buffer of positions.
fn glb(surface: &Surface) -> Vec<u8> {
    // From mm with z up to m with y up: a rotation, which keeps the orientation of the triangles.
    let turned = |v: glam::Vec3| [v.x, v.z, -v.y];
    let positions: Vec<[f32; 3]> = surface.vertices.iter().map(|v| turned(*v * 0.001)).collect();
    let extreme = |pick: fn(f32, f32) -> f32, start: f32| {
        let mut found = [start; 3];
        for p in &positions {
            (0..3).for_each(|axis| found[axis] = pick(found[axis], p[axis]));
        }
        found
    };
    let (least, most) = (extreme(f32::min, f32::MAX), extreme(f32::max, f32::MIN));
    let mut buffer: Vec<u8> = Vec::new();
    for value in positions.iter().flatten() {
        buffer.extend(value.to_le_bytes());
    }
    let mut views = vec![serde_json::json!(
        { "buffer": 0, "byteOffset": 0, "byteLength": buffer.len(), "target": 34962 }
    )];
    let mut accessors = vec![serde_json::json!(
        { "bufferView": 0, "componentType": 5126, "count": positions.len(), "type": "VEC3",
          "min": least, "max": most }
    )];
    let (mut meshes, mut nodes) = (Vec::new(), Vec::new());
    for (k, part) in surface.parts.iter().enumerate() {
        let start = buffer.len();
        for index in part.triangles.iter().flatten() {
            buffer.extend(index.to_le_bytes());
        }
        let length = buffer.len() - start;
        views.push(serde_json::json!(
            { "buffer": 0, "byteOffset": start, "byteLength": length, "target": 34963 }
        ));
        accessors.push(serde_json::json!(
            { "bufferView": k + 1, "componentType": 5125, "count": length / 4, "type": "SCALAR" }
        ));
        meshes.push(serde_json::json!(
            { "name": part.name,
              "primitives": [{ "attributes": { "POSITION": 0 }, "indices": k + 1 }] }
        ));
        nodes.push(serde_json::json!({ "name": part.name, "mesh": k }));
    }
    let roots: Vec<usize> = (0..nodes.len()).collect();
    let mut text = serde_json::json!({
        "asset": { "version": "2.0", "generator": "implant-preview" },
        "scene": 0, "scenes": [{ "nodes": roots }], "nodes": nodes, "meshes": meshes,
        "accessors": accessors, "bufferViews": views, "buffers": [{ "byteLength": buffer.len() }],
    })
    .to_string()
    .into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    buffer.resize(buffer.len().next_multiple_of(4), 0);
    let mut bytes = b"glTF".to_vec();
    let total = 12 + 8 + text.len() + 8 + buffer.len();
    bytes.extend([2, total as u32].into_iter().flat_map(u32::to_le_bytes));
    for (kind, chunk) in [(b"JSON", text), (b"BIN\0", buffer)] {
        bytes.extend((chunk.len() as u32).to_le_bytes());
        bytes.extend(kind);
        bytes.extend(chunk);
    }
    bytes
}

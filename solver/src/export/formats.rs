//! The four mesh formats: binary STL, Wavefront OBJ, binary PLY, binary glTF 2.0.
//!
//! STL, OBJ and PLY have no unit; the lengths are in mm. glTF requires metres and y up.

use super::Solid;
use std::fmt::Write;

/// A format of meshes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Binary STL.
    Stl,
    /// Wavefront OBJ.
    Obj,
    /// Binary PLY.
    Ply,
    /// Binary glTF 2.0.
    Glb,
}

impl Format {
    /// All formats.
    pub const ALL: [Self; 4] = [Self::Stl, Self::Obj, Self::Ply, Self::Glb];

    /// Extension of the format's files.
    #[must_use]
    pub fn extension(self) -> &'static str {
        match self {
            Self::Stl => "stl",
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Glb => "glb",
        }
    }

    /// The format of an extension, in capitals or not.
    #[must_use]
    pub fn of_extension(extension: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|format| extension.eq_ignore_ascii_case(format.extension()))
    }

    /// The file of a mesh.
    #[must_use]
    pub fn encode(self, solid: &Solid) -> Vec<u8> {
        match self {
            Self::Stl => stl(solid),
            Self::Obj => obj(solid).into_bytes(),
            Self::Ply => ply(solid),
            Self::Glb => glb(solid),
        }
    }
}

fn title(solid: &Solid) -> String {
    format!("implant-preview: {}, mm", solid.name)
}

fn stl(solid: &Solid) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    let title = title(solid);
    bytes[..title.len()].copy_from_slice(title.as_bytes());
    bytes.extend((solid.triangles().count() as u32).to_le_bytes());
    for triangle in solid.triangles() {
        let [a, b, c] = triangle.map(|k| solid.vertices[k as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for value in [normal, a, b, c].into_iter().flat_map(|v| v.to_array()) {
            bytes.extend(value.to_le_bytes());
        }
        bytes.extend([0, 0]);
    }
    bytes
}

fn obj(solid: &Solid) -> String {
    let mut text = format!("# {}\n", title(solid));
    // Writing to a String cannot fail.
    for v in &solid.vertices {
        let _ = writeln!(text, "v {} {} {}", v.x, v.y, v.z);
    }
    for part in &solid.parts {
        let _ = writeln!(text, "g {}", part.name);
        for [a, b, c] in part.triangles.iter().map(|t| t.map(|k| k + 1)) {
            let _ = writeln!(text, "f {a} {b} {c}");
        }
    }
    text
}

fn ply(solid: &Solid) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\ncomment {}\n\
         element vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        title(solid),
        solid.vertices.len(),
        solid.triangles().count()
    )
    .into_bytes();
    for value in solid.vertices.iter().flat_map(glam::Vec3::to_array) {
        bytes.extend(value.to_le_bytes());
    }
    for triangle in solid.triangles() {
        bytes.push(3);
        triangle.iter().for_each(|k| bytes.extend(k.to_le_bytes()));
    }
    bytes
}

/// One mesh per part; all meshes share one buffer of positions.
fn glb(solid: &Solid) -> Vec<u8> {
    // From mm with z up to m with y up: a rotation, which keeps the orientation of the triangles.
    let turned = |v: glam::Vec3| [v.x, v.z, -v.y];
    let positions: Vec<[f32; 3]> = solid.vertices.iter().map(|v| turned(*v * 0.001)).collect();
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
    for (k, part) in solid.parts.iter().enumerate() {
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

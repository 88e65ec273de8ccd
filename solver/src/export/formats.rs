//! The four mesh formats: binary STL, Wavefront OBJ, binary PLY, binary glTF 2.0.
//!
//! STL, OBJ and PLY have no unit; the lengths are in mm. glTF requires metres and y up.

use super::{Solid, glb};
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

    /// The file of closed bodies, at least one.
    #[must_use]
    pub fn encode(self, solids: &[Solid]) -> Vec<u8> {
        match self {
            Self::Stl => stl(solids),
            Self::Obj => obj(solids).into_bytes(),
            Self::Ply => ply(solids),
            Self::Glb => glb::encode(solids),
        }
    }
}

fn title(solids: &[Solid]) -> String {
    let names: Vec<&str> = solids.iter().map(|solid| solid.body.name()).collect();
    format!("implant-preview: {}, mm", names.join(", "))
}

/// The triangles of all bodies, by the indices of all their vertices.
fn triangles(solids: &[Solid]) -> impl Iterator<Item = [u32; 3]> + '_ {
    solids
        .iter()
        .scan(0, |first, solid| {
            let own = *first;
            *first += solid.vertices.len() as u32;
            Some(solid.triangles().map(move |triangle| triangle.map(|k| k + own)))
        })
        .flatten()
}

fn stl(solids: &[Solid]) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
    let title = title(solids);
    bytes[..title.len()].copy_from_slice(title.as_bytes());
    bytes.extend((triangles(solids).count() as u32).to_le_bytes());
    for (solid, triangle) in solids.iter().flat_map(|s| s.triangles().map(move |t| (s, t))) {
        let [a, b, c] = triangle.map(|k| solid.vertices[k as usize]);
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for value in [normal, a, b, c].into_iter().flat_map(|v| v.to_array()) {
            bytes.extend(value.to_le_bytes());
        }
        bytes.extend([0, 0]);
    }
    bytes
}

fn obj(solids: &[Solid]) -> String {
    let mut text = format!("# {}\n", title(solids));
    // Writing to a String cannot fail.
    let mut first = 1;
    for solid in solids {
        let _ = writeln!(text, "o {}", solid.body.name());
        for v in &solid.vertices {
            let _ = writeln!(text, "v {} {} {}", v.x, v.y, v.z);
        }
        for part in &solid.parts {
            let _ = writeln!(text, "g {}", part.name);
            for [a, b, c] in part.triangles.iter().map(|t| t.map(|k| k + first)) {
                let _ = writeln!(text, "f {a} {b} {c}");
            }
        }
        first += solid.vertices.len() as u32;
    }
    text
}

fn ply(solids: &[Solid]) -> Vec<u8> {
    let vertices = || solids.iter().flat_map(|solid| &solid.vertices);
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\ncomment {}\n\
         element vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        title(solids),
        vertices().count(),
        triangles(solids).count()
    )
    .into_bytes();
    for value in vertices().flat_map(glam::Vec3::to_array) {
        bytes.extend(value.to_le_bytes());
    }
    for triangle in triangles(solids) {
        bytes.push(3);
        triangle.iter().for_each(|k| bytes.extend(k.to_le_bytes()));
    }
    bytes
}

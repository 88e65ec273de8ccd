//! The four mesh formats: binary STL, Wavefront OBJ, binary PLY, binary glTF 2.0.
//!
//! STL, OBJ and PLY have no unit; the lengths are in mm unless the caller has another unit. glTF requires metres and y up.
//! Colours of vertices are written where every solid has some; STL has none.

use super::{Solid, glb, srgb};
use std::fmt::Write;

/// Unit and axes of the vertices of solids.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axes {
    /// Symbol of the unit.
    pub unit: &'static str,
    /// Length of the unit \[m\].
    pub metres: f32,
    /// Whether z is up and a file in which y is up has turned vertices.
    pub is_z_up: bool,
}

impl Axes {
    /// Of tissue and implants: mm, z away from the wall.
    pub const TISSUE: Self = Self { unit: "mm", metres: 0.001, is_z_up: true };
}

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

    /// The file of tissue and implants, at least one of them.
    #[must_use]
    pub fn encode(self, solids: &[Solid]) -> Vec<u8> {
        self.encode_in(Axes::TISSUE, solids)
    }

    /// The file of solids, at least one, whose vertices have another unit and other axes.
    #[must_use]
    pub fn encode_in(self, axes: Axes, solids: &[Solid]) -> Vec<u8> {
        let names: Vec<&str> = solids.iter().map(|solid| solid.body.name()).collect();
        let title = format!("implant-preview: {}, {}", names.join(", "), axes.unit);
        match self {
            Self::Stl => stl(&title, solids),
            Self::Obj => obj(&title, solids).into_bytes(),
            Self::Ply => ply(&title, solids),
            Self::Glb => glb::encode(axes, solids),
        }
    }
}

/// sRGB of a vertex, where every solid has colours.
fn colour(solids: &[Solid], solid: &Solid, vertex: usize) -> Option<[u8; 3]> {
    let has_colours = solids.iter().all(|solid| !solid.colours.is_empty());
    has_colours.then(|| solid.colours[vertex].map(srgb::of_linear))
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

fn stl(title: &str, solids: &[Solid]) -> Vec<u8> {
    let mut bytes = vec![b' '; 80];
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

fn obj(title: &str, solids: &[Solid]) -> String {
    let mut text = format!("# {title}\n");
    // Writing to a String cannot fail.
    let mut first = 1;
    for solid in solids {
        let _ = writeln!(text, "o {}", solid.body.name());
        for (k, v) in solid.vertices.iter().enumerate() {
            let _ = write!(text, "v {} {} {}", v.x, v.y, v.z);
            for part in colour(solids, solid, k).into_iter().flatten() {
                let _ = write!(text, " {:.4}", f32::from(part) / 255.0);
            }
            text.push('\n');
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

fn ply(title: &str, solids: &[Solid]) -> Vec<u8> {
    let vertices: usize = solids.iter().map(|solid| solid.vertices.len()).sum();
    let has_colours = solids.iter().all(|solid| !solid.colours.is_empty());
    let colours = if has_colours {
        "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    } else {
        ""
    };
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\ncomment {title}\n\
         element vertex {vertices}\nproperty float x\nproperty float y\nproperty float z\n{colours}\
         element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        triangles(solids).count()
    )
    .into_bytes();
    for solid in solids {
        for (k, vertex) in solid.vertices.iter().enumerate() {
            vertex.to_array().iter().for_each(|value| bytes.extend(value.to_le_bytes()));
            bytes.extend(colour(solids, solid, k).into_iter().flatten());
        }
    }
    for triangle in triangles(solids) {
        bytes.push(3);
        triangle.iter().for_each(|k| bytes.extend(k.to_le_bytes()));
    }
    bytes
}

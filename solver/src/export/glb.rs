//! Binary glTF 2.0: each body one closed mesh with unit normals and its own material, and with the colours of its vertices if it has
//! any; lengths in m, y up.

use super::{Axes, Solid};
use glam::{DVec3, Vec3};
use serde_json::{Value, json};

/// How a body reflects light: metallic–roughness of glTF, not metallic.
pub(super) struct Material {
    /// Linear red, green and blue \[-\].
    pub(super) colour: [f32; 3],
    /// Roughness \[-\].
    pub(super) roughness: f32,
}

/// `componentType` of glTF.
const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;
/// `target` of glTF: attributes of vertices, indices.
const VERTICES: u32 = 34962;
const INDICES: u32 = 34963;

/// The bodies as nodes of one scene.
pub(super) fn encode(axes: Axes, solids: &[Solid]) -> Vec<u8> {
    let mut file = File::default();
    let turned = |v: Vec3| if axes.is_z_up { turned(v) } else { v };
    let (mut nodes, mut meshes, mut materials) = (Vec::new(), Vec::new(), Vec::new());
    for (k, solid) in solids.iter().enumerate() {
        let name = solid.body.name();
        let positions: Vec<[f32; 3]> =
            solid.vertices.iter().map(|v| turned(*v * axes.metres).to_array()).collect();
        let normals: Vec<[f32; 3]> =
            normals(solid).into_iter().map(|n| turned(n).to_array()).collect();
        let indices: Vec<u32> = solid.triangles().flatten().collect();
        let position = file.vectors(&positions, true);
        let normal = file.vectors(&normals, false);
        let indices = file.indices(&indices);
        let mut attributes = json!({ "POSITION": position, "NORMAL": normal });
        let Material { mut colour, roughness } = solid.body.material();
        if !solid.colours.is_empty() {
            attributes["COLOR_0"] = json!(file.vectors(&solid.colours, false));
            // The colour of the material is a factor of that of a vertex.
            colour = [1.0; 3];
        }
        meshes.push(json!({ "name": name, "primitives": [{
            "attributes": attributes, "indices": indices, "material": k,
        }]}));
        nodes.push(json!({ "name": name, "mesh": k }));
        let [r, g, b] = colour;
        materials.push(json!({ "name": name, "pbrMetallicRoughness": {
            "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": roughness,
        }}));
    }
    let roots: Vec<usize> = (0..nodes.len()).collect();
    file.finish(json!({
        "asset": { "version": "2.0", "generator": "implant-preview" },
        "scene": 0, "scenes": [{ "nodes": roots }],
        "nodes": nodes, "meshes": meshes, "materials": materials,
    }))
}

/// From z up to y up: a rotation, which keeps the orientation of the triangles.
fn turned(v: Vec3) -> Vec3 {
    Vec3::new(v.x, v.z, -v.y)
}

/// Unit normals of the vertices: those of the triangles around, weighted by their angles there.
fn normals(solid: &Solid) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; solid.vertices.len()];
    for triangle in solid.triangles() {
        let corners = triangle.map(|k| solid.vertices[k as usize].as_dvec3());
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        for k in 0..3 {
            let (next, last) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
            let angle = (next - corners[k]).angle_between(last - corners[k]);
            if angle.is_finite() {
                sums[triangle[k] as usize] += normal * angle;
            }
        }
    }
    sums.into_iter().map(|sum| sum.normalize_or(DVec3::Z).as_vec3()).collect()
}

/// The binary chunk and what describes its content.
#[derive(Default)]
struct File {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl File {
    /// Adds vectors at vertices, with their bounds if asked; returns the accessor.
    fn vectors(&mut self, vectors: &[[f32; 3]], has_bounds: bool) -> usize {
        let view = self.view(vectors.iter().flatten().map(|value| value.to_le_bytes()), VERTICES);
        let mut accessor = json!({ "bufferView": view, "componentType": FLOAT, "type": "VEC3",
            "count": vectors.len() });
        if has_bounds {
            let bound = |pick: fn(f32, f32) -> f32, start: f32| {
                [0, 1, 2].map(|axis| vectors.iter().fold(start, |found, v| pick(found, v[axis])))
            };
            accessor["min"] = json!(bound(f32::min, f32::MAX));
            accessor["max"] = json!(bound(f32::max, f32::MIN));
        }
        self.accessor(accessor)
    }

    /// Adds indices of vertices; returns the accessor.
    fn indices(&mut self, indices: &[u32]) -> usize {
        let view = self.view(indices.iter().map(|index| index.to_le_bytes()), INDICES);
        self.accessor(json!({ "bufferView": view, "componentType": UNSIGNED_INT,
            "type": "SCALAR", "count": indices.len() }))
    }

    fn view(&mut self, words: impl Iterator<Item = [u8; 4]>, target: u32) -> usize {
        let start = self.bytes.len();
        self.bytes.extend(words.flatten());
        self.views.push(json!({ "buffer": 0, "byteOffset": start,
            "byteLength": self.bytes.len() - start, "target": target }));
        self.views.len() - 1
    }

    fn accessor(&mut self, accessor: Value) -> usize {
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// The file: header, JSON and binary chunk, each chunk a multiple of 4 bytes.
    fn finish(self, mut description: Value) -> Vec<u8> {
        description["buffers"] = json!([{ "byteLength": self.bytes.len() }]);
        description["bufferViews"] = Value::Array(self.views);
        description["accessors"] = Value::Array(self.accessors);
        let mut text = description.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut bytes = b"glTF".to_vec();
        let total = 12 + 8 + text.len() + 8 + self.bytes.len();
        bytes.extend([2, total as u32].into_iter().flat_map(u32::to_le_bytes));
        for (kind, chunk) in [(b"JSON", text), (b"BIN\0", self.bytes)] {
            bytes.extend((chunk.len() as u32).to_le_bytes());
            bytes.extend(kind);
            bytes.extend(chunk);
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Dome, HalfBall};
    use crate::export::Format;
    use crate::mesh::Chest;
    use glam::DVec2;
    use std::collections::BTreeMap;

    #[test]
    fn a_foreign_reader_finds_one_closed_body_with_unit_normals_and_a_material() {
        let dome = Dome::new(DVec2::new(5.0, -3.0), HalfBall::round(60.0, 40.0), 1.0);
        let chest = Chest::Curved { across_mm: 110.0, along_mm: -300.0 };
        for dome in [dome.clone(), dome.over(chest)] {
            let volume = dome.volume();
            let bytes = Format::Glb.encode(&[Solid::implant(&dome)]);
            let file = gltf::Gltf::from_slice(&bytes).unwrap();
            let blob = file.blob.as_deref().unwrap();
            assert_eq!(
                file.buffers().map(|buffer| buffer.length()).collect::<Vec<_>>(),
                [blob.len()]
            );
            let mesh = file.nodes().next().unwrap().mesh().unwrap();
            assert_eq!((file.nodes().len(), mesh.name()), (1, Some("implant")));
            let primitive = mesh.primitives().next().unwrap();
            let material = primitive.material();
            assert_eq!((mesh.primitives().len(), material.name()), (1, Some("implant")));
            assert!(material.pbr_metallic_roughness().metallic_factor() == 0.0);
            let reader = primitive.reader(|_| Some(blob));
            let positions: Vec<DVec3> =
                reader.read_positions().unwrap().map(|p| Vec3::from(p).as_dvec3()).collect();
            let normals: Vec<DVec3> =
                reader.read_normals().unwrap().map(|n| Vec3::from(n).as_dvec3()).collect();
            let indices: Vec<usize> =
                reader.read_indices().unwrap().into_u32().map(|k| k as usize).collect();
            assert_eq!(normals.len(), positions.len());
            assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-6));
            let mut edges = BTreeMap::new();
            let mut enclosed = 0.0;
            for triangle in indices.chunks(3) {
                let [a, b, c] = [0, 1, 2].map(|k| positions[triangle[k]]);
                enclosed += a.dot(b.cross(c)) / 6.0;
                for k in 0..3 {
                    *edges.entry((triangle[k], triangle[(k + 1) % 3])).or_insert(0) += 1;
                }
                // A normal is on the outer side of its triangles.
                let face = (b - a).cross(c - a);
                assert!(triangle.iter().all(|k| normals[*k].dot(face) >= 0.0));
            }
            assert!(
                edges.iter().all(|(&(a, b), &count)| count == 1 && edges.contains_key(&(b, a)))
            );
            // Outward faces enclose a positive volume, here in m³; the dome is convex on a flat wall.
            assert!((enclosed * 1e9 / volume - 1.0).abs() < 0.002, "{enclosed} m³");
            // y is up: the apex is above the base, the head is at −z.
            let highest = positions.iter().copied().reduce(|a, b| if b.y > a.y { b } else { a });
            assert!((highest.unwrap() * 1e3 - DVec3::new(5.0, dome.apex().z, 3.0)).length() < 5.0);
        }
    }

    #[test]
    fn the_normals_of_a_dome_are_those_of_its_surface() {
        let dome = Dome::new(DVec2::ZERO, HalfBall::round(50.0, 50.0), 1.0);
        let solid = Solid::implant(&dome);
        for (at, normal) in solid.vertices.iter().zip(normals(&solid)) {
            // Above the rim, where dome and base share their vertices.
            if at.z > 1.0 {
                assert!(normal.dot(at.normalize()) > 0.9995, "{at}: {normal}");
            }
        }
    }
}

//! The deformed tissue as one closed surface: the sheet (inner face), the skin (outer face), and the
//! lateral face along the pocket's border.

use crate::measure::Surfaces;
use glam::Vec3;
use std::collections::BTreeMap;

/// A part of the surface; its triangles refer to [`Surface::vertices`].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part {
    /// `sheet`, `skin` or `border`.
    pub(super) name: &'static str,
    /// Vertex indices, counter-clockwise seen from outside the tissue.
    pub(super) triangles: Vec<[u32; 3]>,
}

/// A closed triangle mesh \[mm\].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Surface {
    pub(super) vertices: Vec<Vec3>,
    pub(super) parts: [Part; 3],
}

impl Surface {
    /// Creates the surface around all layers. Vertices: those of the sheet, then those of the skin in the
    /// same order.
    pub(super) fn new(surfaces: &Surfaces) -> Self {
        let (inner, outer) =
            (&surfaces.positions[0], &surfaces.positions[surfaces.positions.len() - 1]);
        // Border nodes without a triangle are omitted.
        let mut number = BTreeMap::new();
        for vertex in surfaces.triangles.iter().flatten() {
            let next = number.len() as u32;
            number.entry(*vertex).or_insert(next);
        }
        let count = number.len() as u32;
        let mut vertices = vec![Vec3::ZERO; 2 * number.len()];
        for (&vertex, &k) in &number {
            vertices[k as usize] = inner[vertex as usize].into();
            vertices[(k + count) as usize] = outer[vertex as usize].into();
        }
        let skin: Vec<[u32; 3]> =
            surfaces.triangles.iter().map(|t| t.map(|vertex| number[&vertex] + count)).collect();
        let sheet = skin.iter().map(|[a, b, c]| [a - count, c - count, b - count]).collect();
        let border = border_edges(&skin)
            .into_iter()
            .flat_map(|[a, b]| {
                let (low_a, low_b) = (a - count, b - count);
                [[low_a, low_b, b], [low_a, b, a]]
            })
            .collect();
        Self {
            vertices,
            parts: [
                Part { name: "sheet", triangles: sheet },
                Part { name: "skin", triangles: skin },
                Part { name: "border", triangles: border },
            ],
        }
    }

    /// All triangles of all parts.
    pub(super) fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.parts.iter().flat_map(|part| part.triangles.iter().copied())
    }
}

/// Directed edges of exactly one triangle.
fn border_edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut edges = BTreeMap::new();
    for &[a, b, c] in triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            if edges.remove(&[to, from]).is_none() {
                edges.insert([from, to], ());
            }
        }
    }
    edges.into_keys().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::{Stack, of_faces};
    use crate::mesh::Sheet;

    fn flat(thickness: f32) -> Surface {
        let sheet = Sheet::new(33, 50.0);
        let inner = sheet.rest().iter().map(|p| p.extend(0.0).as_vec3()).collect();
        let stack = Stack {
            between: Vec::new(),
            thickness_mm: vec![vec![thickness; sheet.len()]],
            normal: vec![Vec3::Z; sheet.len()],
        };
        let faces = stack.faces(inner);
        Surface::new(&of_faces(&sheet, &stack, &faces))
    }

    #[test]
    fn every_edge_belongs_to_two_triangles_that_run_it_in_opposite_directions() {
        assert!(border_edges(&flat(3.0).triangles().collect::<Vec<_>>()).is_empty());
    }

    #[test]
    fn the_enclosed_volume_is_positive_area_times_thickness() {
        let surface = flat(3.0);
        let volume: f64 = surface
            .triangles()
            .map(|t| {
                let [a, b, c] = t.map(|k| surface.vertices[k as usize].as_dvec3());
                a.dot(b.cross(c)) / 6.0
            })
            .sum();
        let disc = std::f64::consts::PI * 50.0 * 50.0 * 3.0;
        assert!((volume / disc - 1.0).abs() < 0.01, "{volume} instead of nearly {disc}");
    }
}

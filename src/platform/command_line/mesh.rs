//! The deformed tissue as one closed surface: the sheet (inner face), the skin (outer face), and
//! the wall that joins them along the pocket's border.

use crate::measure::Fields;
use crate::sheet::{CELL_TRIANGLES, CellKind, Sheet};
use glam::{DVec3, Vec3};
use std::collections::BTreeMap;

/// A part of the surface; its triangles use the vertices of [`Surface::vertices`].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Part {
    /// `sheet`, `skin` or `border`.
    pub(super) name: &'static str,
    /// Vertex numbers, counter-clockwise seen from outside the tissue.
    pub(super) triangles: Vec<[u32; 3]>,
}

/// A closed triangle mesh \[mm\].
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Surface {
    pub(super) vertices: Vec<Vec3>,
    pub(super) parts: [Part; 3],
}

impl Surface {
    /// The surface of a solved shape `x` \[mm\] with the fields measured on it.
    pub(super) fn new(sheet: &Sheet, x: &[DVec3], fields: &Fields) -> Self {
        let upward = triangles(sheet);
        let mut number = BTreeMap::new();
        for node in upward.iter().flatten() {
            let next = number.len() as u32;
            number.entry(*node).or_insert(next);
        }
        let count = number.len() as u32;
        let mut vertices = vec![Vec3::ZERO; 2 * number.len()];
        for (&node, &k) in &number {
            let thickness: f32 = fields.thickness_mm.iter().map(|layer| layer[node]).sum();
            let inner = x[node].as_vec3();
            vertices[k as usize] = inner;
            vertices[(k + count) as usize] = inner + thickness * Vec3::from(fields.normal[node]);
        }
        let skin: Vec<[u32; 3]> =
            upward.iter().map(|nodes| nodes.map(|node| number[&node] + count)).collect();
        let sheet: Vec<[u32; 3]> =
            skin.iter().map(|[a, b, c]| [a - count, c - count, b - count]).collect();
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

/// The sheet's cells as triangles that cover it once, counter-clockwise seen from the skin.
fn triangles(sheet: &Sheet) -> Vec<[usize; 3]> {
    let cells = sheet.nodes_per_side() - 1;
    let mut found = Vec::new();
    for j in 0..cells {
        for i in 0..cells {
            let corners = sheet.corners(i, j);
            let mut add = |k: usize| found.push(CELL_TRIANGLES[k].map(|c| corners[c]));
            match sheet.cell(i, j) {
                // Two triangles that share a diagonal, each diagonal in turn, so that the net has
                // no slant.
                CellKind::Whole if (i + j) % 2 == 0 => [0, 2].into_iter().for_each(add),
                CellKind::Whole => [1, 3].into_iter().for_each(add),
                CellKind::WithoutCorner(k) => add(usize::from(k)),
                CellKind::Outside => {}
            }
        }
    }
    found
}

/// Directed edges that only one triangle has.
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

    fn flat(thickness: f32) -> Surface {
        let sheet = Sheet::new(33, 50.0);
        let x: Vec<DVec3> = sheet.rest().iter().map(|p| p.extend(0.0)).collect();
        let fields = Fields {
            thickness_mm: vec![vec![thickness; sheet.len()]],
            normal: vec![[0.0, 0.0, 1.0]; sheet.len()],
            ..Fields::default()
        };
        Surface::new(&sheet, &x, &fields)
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

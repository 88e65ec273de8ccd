//! The deformed tissue as surfaces: the inner face, the faces between the layers, the skin.

use super::Stack;
use crate::mesh::{CELL_TRIANGLES, CellKind, NodeKind, Sheet};
use crate::solve::Solution;
use glam::Vec3;

/// Surfaces of the deformed tissue with a common order of vertices and common triangles.
#[derive(Clone, Debug, PartialEq)]
pub struct Surfaces {
    /// The sheet's node of each vertex.
    pub nodes: Vec<u32>,
    /// Vertex positions \[mm\] of the inner face, the faces between the layers (innermost first) and
    /// the outer skin, shape (layers + 1, vertices).
    pub positions: Vec<Vec<[f32; 3]>>,
    /// Unit normals of the inner face, pointing to the skin.
    pub normals: Vec<[f32; 3]>,
    /// Vertices of each triangle, counter-clockwise seen from the skin.
    pub triangles: Vec<[u32; 3]>,
}

impl Surfaces {
    /// The mirror image in x, of a left breast the right one: the triangles still face outwards.
    #[must_use]
    pub fn mirrored(mut self) -> Self {
        let vectors = self.positions.iter_mut().flatten().chain(&mut self.normals);
        vectors.for_each(|vector| vector[0] = -vector[0]);
        self.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
        self
    }
}

/// The surfaces of a solution.
#[must_use]
pub fn surfaces(solution: &Solution) -> Surfaces {
    let (stack, faces) = (solution.stack(), solution.faces());
    of_faces(solution.problem().sheet(), stack, &faces)
}

pub(crate) fn of_faces(sheet: &Sheet, stack: &Stack, faces: &[Vec<Vec3>]) -> Surfaces {
    let nodes: Vec<u32> = (0..sheet.len())
        .filter(|&k| sheet.kinds()[k] != NodeKind::Outside)
        .map(|k| k as u32)
        .collect();
    let mut vertex = vec![u32::MAX; sheet.len()];
    nodes.iter().enumerate().for_each(|(v, &k)| vertex[k as usize] = v as u32);
    let at_nodes = |values: &Vec<Vec3>| -> Vec<[f32; 3]> {
        nodes.iter().map(|&k| values[k as usize].to_array()).collect()
    };
    let normals = at_nodes(&stack.normal);
    let positions = faces.iter().map(at_nodes).collect();
    let mut triangles = Vec::with_capacity(2 * nodes.len());
    let cells = sheet.nodes_per_side() - 1;
    for c in 0..cells * cells {
        let (i, j) = (c % cells, c / cells);
        let corners = sheet.corners(i, j);
        let mut add = |local: [usize; 3]| {
            triangles.push(local.map(|c| vertex[corners[c]]));
        };
        match sheet.cell(i, j) {
            CellKind::Whole => {
                add([0, 1, 2]);
                add([0, 2, 3]);
            }
            CellKind::WithoutCorner(k) => add(CELL_TRIANGLES[usize::from(k)]),
            CellKind::Outside => {}
        }
    }
    Surfaces { nodes, positions, normals, triangles }
}

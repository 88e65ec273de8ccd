//! Normals of vertices from the triangles around them.

use super::position;
use crate::mesh::Vertex;
use glam::Vec3;

/// Sets the area-weighted unit normals of vertices from the triangles around them.
pub(super) fn turn(
    normals: &mut [Vec3],
    vertices: &[Vertex],
    triangles: &[[u32; 3]],
    of: impl Iterator<Item = usize>,
) {
    let mut sums = vec![Vec3::ZERO; vertices.len()];
    for triangle in triangles {
        let [a, b, c] = triangle.map(|k| position(&vertices[k as usize]));
        let normal = (b - a).cross(c - a);
        triangle.iter().for_each(|k| sums[*k as usize] += normal);
    }
    of.for_each(|k| normals[k] = sums[k].normalize_or(Vec3::Z));
}

/// Gives vertices the mean of the normals of the triangles around them: in the crease under a breast, where triangles are as long as the crease is wide, the
/// light would show each of them as a streak.
pub(super) fn soften(
    vertices: &mut [Vertex],
    normals: &[Vec3],
    triangles: &[[u32; 3]],
    of: impl Iterator<Item = usize>,
) {
    let mut sums = vec![Vec3::ZERO; vertices.len()];
    for triangle in triangles {
        let normal: Vec3 = triangle.iter().map(|k| normals[*k as usize]).sum();
        triangle.iter().for_each(|k| sums[*k as usize] += normal);
    }
    for k in of {
        let normal = sums[k].normalize_or(normals[k]);
        vertices[k][3..6].copy_from_slice(&normal.to_array());
    }
}

//! Strokes on the skin along the crests of its wrinkles.

use crate::body::Body;
use crate::color::Rgb;
use crate::mesh::{NO_VALUE, Vertex, vertex};
use glam::{Vec2, Vec3};

/// Distance of the strokes at rest \[mm\], at least one cell.
const SPACING_MM: f32 = 6.0;
/// Length and width of a stroke \[distance of the strokes\].
const SIZE: (f32, f32) = (0.75, 0.09);
/// Height of the strokes above the surface \[mm\]: the surface bends under a straight stroke.
const LIFT_MM: f32 = 0.4;
/// Colour of the strokes.
const COLOR: Rgb = [0.13, 0.16, 0.22];

/// Vertices and triangles of strokes along unit vectors at the nodes, in the plane at rest; zero: no stroke. `first` is the
/// index of the first vertex.
#[must_use]
pub fn along(
    body: &Body,
    directions: &[Vec2],
    spacing_mm: f32,
    first: u32,
) -> (Vec<Vertex>, Vec<u32>) {
    let (mut vertices, mut indices) = (Vec::new(), Vec::new());
    let n = body.nodes_per_side;
    let Some(skin) = body.levels.first() else {
        return (vertices, indices);
    };
    if n == 0 || directions.len() != n * n || skin.len() < n * n {
        return (vertices, indices);
    }
    let stride = ((SPACING_MM / spacing_mm).round() as usize).max(1);
    let apart = stride as f32 * spacing_mm;
    let (long, wide) = (0.5 * SIZE.0 * apart, 0.5 * SIZE.1 * apart);
    // Strokes lie symmetrically about the middle of the grid.
    let start = (n / 2) % stride;
    let inner = || (start..n - 1).step_by(stride).filter(|k| *k > 0);
    for k in inner().flat_map(|j| inner().map(move |i| j * n + i)) {
        let direction = directions[k];
        if direction == Vec2::ZERO {
            continue;
        }
        // Columns of the surface's deformation gradient.
        let slope = |step: usize| (skin[k + step] - skin[k - step]) / (2.0 * spacing_mm);
        let [x, y] = [slope(1), slope(n)];
        let normal = x.cross(y).normalize_or(Vec3::Z);
        let tangent = x * direction.x + y * direction.y;
        let side = normal.cross(tangent).normalize_or_zero() * wide;
        let middle = skin[k] + normal * LIFT_MM;
        let at = first + vertices.len() as u32;
        for (end, across) in [(-long, -1.0), (long, -1.0), (long, 1.0), (-long, 1.0)] {
            let point = middle + tangent * end + side * across;
            vertices.push(vertex(point, normal, [-1.0; 2], NO_VALUE, COLOR));
        }
        indices.extend([0, 1, 2, 0, 2, 3].map(|corner| at + corner));
    }
    (vertices, indices)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A flat square of 9 × 9 nodes 6 mm apart, stretched twofold along y.
    fn flat() -> Body {
        let n = 9;
        let point = |k: usize| Vec3::new(6.0 * (k % n) as f32, 12.0 * (k / n) as f32, 1.0);
        let mut body = Body::default();
        body.levels = vec![(0..n * n).map(point).collect()];
        (body.nodes_per_side, body.node_columns) = (n, n * n);
        body
    }

    #[test]
    fn a_stroke_lies_on_the_skin_along_its_direction() {
        let body = flat();
        let mut directions = vec![Vec2::ZERO; 81];
        directions[40] = Vec2::Y;
        // No neighbours on either side.
        directions[4] = Vec2::Y;
        let (vertices, indices) = along(&body, &directions, 6.0, 100);
        assert_eq!((vertices.len(), indices), (4, vec![100, 101, 102, 100, 102, 103]));
        let middle = body.levels[0][40];
        let corners: Vec<Vec3> =
            vertices.iter().map(|v| Vec3::new(v[0], v[1], v[2]) - middle).collect();
        for corner in &corners {
            // Stretched with the skin along y; no wider.
            assert!((corner.y.abs() - SIZE.0 * 6.0).abs() < 1e-4, "{corner}");
            assert!((corner.x.abs() - 0.5 * SIZE.1 * 6.0).abs() < 1e-4, "{corner}");
            assert!((corner.z - LIFT_MM).abs() < 1e-5, "{corner}");
        }
        let facing = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        assert!(facing.z > 0.0);
    }

    #[test]
    fn taut_skin_has_no_strokes() {
        assert_eq!(along(&flat(), &[Vec2::ZERO; 81], 6.0, 0), (Vec::new(), Vec::new()));
        assert_eq!(along(&Body::default(), &[], 6.0, 0), (Vec::new(), Vec::new()));
    }
}

//! A triangle at rest and its principal stretches; sums over triangles.

use crate::mesh::part::Part;
use crate::mesh::{CellKind, Surface};
use glam::{DVec2, DVec3};
use std::ops::AddAssign;

/// The rest metric of a triangle: corners in a plane \[mm\], weighted area \[mm²\], gradients of the nodes' hat functions \[1/mm\].
pub(crate) struct Rest {
    pub(crate) corners: [DVec2; 3],
    pub(crate) area: f64,
    pub(crate) gradients: [DVec2; 3],
}

impl Rest {
    #[inline]
    pub(crate) fn new(surface: Surface, nodes: [usize; 3], weight: f64) -> Self {
        let corners = surface.triangle(nodes);
        let (a, b) = (corners[1] - corners[0], corners[2] - corners[0]);
        let det = a.perp_dot(b);
        let inverse = 1.0 / det;
        let g1 = DVec2::new(b.y, -b.x) * inverse;
        let g2 = DVec2::new(-a.y, a.x) * inverse;
        Self { corners, area: 0.5 * det * weight, gradients: [-(g1 + g2), g1, g2] }
    }
}

/// Principal stretches and directions of a deformed triangle.
pub(crate) struct Principal {
    pub(crate) stretch: [f64; 2],
    /// Principal directions at rest.
    pub(crate) rest: [DVec2; 2],
    /// Deformed principal directions: unit vectors in the triangle's plane.
    pub(crate) deformed: [DVec3; 2],
}

impl Principal {
    /// The columns of F.
    #[inline]
    pub(crate) fn columns(rest: &Rest, x: [DVec3; 3]) -> [DVec3; 2] {
        let (a, b) = (x[1] - x[0], x[2] - x[0]);
        let [_, g1, g2] = rest.gradients;
        [a * g1.x + b * g2.x, a * g1.y + b * g2.y]
    }

    /// Principal stretches, the greater first.
    #[inline]
    pub(crate) fn stretches([f1, f2]: [DVec3; 2]) -> [f64; 2] {
        let (mean, half, off) = metric(f1, f2);
        let greater = mean + (half * half + off * off).sqrt();
        let area = f1.cross(f2).length();
        let first = greater.max(1e-300).sqrt();
        [first, area / first]
    }

    #[inline]
    pub(crate) fn new(columns: [DVec3; 2]) -> Self {
        let [f1, f2] = columns;
        let (_, half, off) = metric(f1, f2);
        let radius = (half * half + off * off).sqrt();
        let rest = if radius > 0.0 {
            // Half of the angle of (half, off)/radius, by the half-angle formula without cancellation.
            let (c, s) = if half >= 0.0 {
                let c = (0.5 * (1.0 + half / radius)).sqrt();
                (c, 0.5 * off / (radius * c))
            } else {
                let s = (0.5 * (1.0 - half / radius)).sqrt();
                (0.5 * off / (radius * s), s)
            };
            DVec2::new(c, s)
        } else {
            DVec2::X
        };
        let across = DVec2::new(-rest.y, rest.x);
        let stretch = Self::stretches(columns);
        // F N/λ are unit vectors; the second direction of a degenerate triangle is arbitrary.
        let first = (f1 * rest.x + f2 * rest.y) / stretch[0];
        let second = if stretch[1] > 1e-9 * stretch[0] {
            (f1 * across.x + f2 * across.y) / stretch[1]
        } else {
            first.normalize_or(DVec3::X).any_orthonormal_vector()
        };
        Self { stretch, rest: [rest, across], deformed: [first, second] }
    }
}

#[inline]
fn metric(f1: DVec3, f2: DVec3) -> (f64, f64, f64) {
    let (c11, c22) = (f1.length_squared(), f2.length_squared());
    (0.5 * (c11 + c22), 0.5 * (c11 - c22), f1.dot(f2))
}

/// Sums over the triangles around each node of a part, of the cells that are `wanted`. `triangle` returns what a triangle with
/// these positions adds to its nodes, `square` what a square cell adds to its corners, from its edges over the spacing: bottom,
/// top, left, right. The columns of F in the k-th of [`CELL_TRIANGLES`](crate::mesh::CELL_TRIANGLES) are
/// `(top, right)`, `(top, left)`, `(bottom, left)`, `(bottom, right)`.
#[inline]
pub(crate) fn sums<T: Copy + Default + AddAssign>(
    surface: Surface,
    x: &[DVec3],
    part: Part,
    wanted: impl Fn(usize, usize) -> bool,
    triangle: impl Fn(&Rest, [DVec3; 3]) -> [T; 3],
    square: impl Fn([DVec3; 4]) -> [T; 4],
) -> Vec<T> {
    let sheet = surface.sheet();
    let (n, per_spacing) = (sheet.nodes_per_side(), 1.0 / sheet.spacing_mm());
    // The cells across an axis of symmetry add to their own nodes' mirror images as well: with a margin of nodes
    // on the far side, no cell is a special case.
    let [first, first_row] = part.first_cell();
    let columns = n - first;
    let mut sums = vec![T::default(); columns * (n - first_row)];
    for j in first_row..n - 1 {
        let (from, to) = sheet.cell_span(j);
        for i in from.max(first)..to {
            if sheet.cell(i, j) == CellKind::Outside || !wanted(i, j) {
                continue;
            }
            let corners = sheet.corners(i, j);
            if surface.is_square(corners) {
                let [a, b, c, d] = corners.map(|k| x[k]);
                let edges = [b - a, c - d, d - a, c - b].map(|edge| edge * per_spacing);
                let low = (j - first_row) * columns + i - first;
                let at = [low, low + 1, low + columns + 1, low + columns];
                at.into_iter().zip(square(edges)).for_each(|(k, added)| sums[k] += added);
                continue;
            }
            for (nodes, weight) in sheet.cell_triangles(i, j) {
                let added = triangle(&Rest::new(surface, nodes, weight), nodes.map(|k| x[k]));
                for (k, added) in nodes.into_iter().zip(added) {
                    sums[(k / n - first_row) * columns + k % n - first] += added;
                }
            }
        }
    }
    let [margin, margin_row] = [0, 1].map(|k| part.first()[k] - part.first_cell()[k]);
    if margin + margin_row == 0 {
        return sums;
    }
    let own = sums.chunks_exact(columns).skip(margin_row);
    own.flat_map(|row| &row[margin..]).copied().collect()
}

//! The profile: the sheet along +x from the pocket's centre.

use super::{PROFILE_POINTS, ProfilePoint};
use crate::contact::TOUCH_F64;
use crate::mesh::{NodeKind, Sheet};
use crate::solve::Solution;
use glam::{DVec2, DVec3};

/// 41 points, material radius 0 … pocket radius in equal steps. Positions by cubic interpolation
/// between the nodes, stretches from central differences (second order).
///
/// The curvature of the sheet jumps at the contact edge: a point is interpolated from the nodes on its own side of
/// the edge. On the outer side the last node in contact has its position with contact offset, on the extension of the
/// free sheet.
pub(super) fn along_x(solution: &Solution) -> Vec<ProfilePoint> {
    let sheet = solution.problem().sheet();
    let row = sheet.nodes_per_side() / 2 * sheet.nodes_per_side();
    let pocket_radius = solution.problem().patch.pocket_radius_mm;
    beside_edges(sheet, solution.inner(), pocket_radius, &edges(solution, row))
}

/// 41 points of the skin's outer surface along +x, material radius 0 … patch radius in equal steps.
#[must_use]
pub fn skin_surface(solution: &Solution) -> Vec<ProfilePoint> {
    let faces = solution.faces();
    let outer: Vec<DVec3> = faces[faces.len() - 1].iter().map(|p| p.as_dvec3()).collect();
    along(solution.problem().sheet(), &outer, solution.problem().patch.radius_mm)
}

/// 41 points of a face, material radius 0 … `radius` in equal steps.
pub(super) fn along(sheet: &Sheet, x: &[DVec3], radius: f64) -> Vec<ProfilePoint> {
    beside_edges(sheet, x, radius, &[])
}

fn beside_edges(sheet: &Sheet, x: &[DVec3], radius: f64, edges: &[Edge]) -> Vec<ProfilePoint> {
    let n = sheet.nodes_per_side();
    let half = n / 2;
    let row = half * n;
    let (h, rest) = (sheet.spacing_mm(), sheet.rest());
    // Stretch along and across the row at its i-th node.
    let stretches = |i: usize| {
        let k = row + i;
        let along = if i + 1 < n {
            (x[k + 1] - x[k - 1]) / (2.0 * h)
        } else {
            (x[k] * 3.0 - x[k - 1] * 4.0 + x[k - 2]) / (2.0 * h)
        };
        let (up, down) = (k + n, k - n);
        let across = x[up].distance(x[down]) / rest[up].distance(rest[down]);
        (along.length(), across)
    };
    (0..PROFILE_POINTS)
        .map(|point| {
            let s = radius * point as f64 / (PROFILE_POINTS - 1) as f64;
            let column = s / h + half as f64;
            let middle = (column.floor() as usize).clamp(1, n - 3);
            let mut stretch = DVec2::ZERO;
            for (k, weight) in (middle - 1..=middle + 2).zip(cubic(column - middle as f64)) {
                let (along, across) = stretches(k);
                stretch += DVec2::new(along, across) * weight;
            }
            let (mut low, mut passed) = (middle, None);
            for edge in edges {
                let is_inside = (edge.position - column) * edge.outwards > 0.0;
                // Nodes low − 1 … low + 2 lie on the point's side of the edge's node, this node included.
                let is_right = is_inside != (edge.outwards > 0.0);
                if is_right && low < edge.node + 1 && low + 2 >= edge.node {
                    low = edge.node + 1;
                } else if !is_right && low + 2 > edge.node && low <= edge.node + 1 {
                    low = edge.node - 2;
                }
                if !is_inside {
                    passed = passed.or(Some(edge));
                }
            }
            let low = low.clamp(1, n - 3);
            let mut position = DVec3::ZERO;
            for (k, weight) in (low - 1..=low + 2).zip(cubic(column - low as f64)) {
                let own = edges.iter().find(|e| e.node == k && passed.is_some());
                position += own.map_or(x[row + k], |e| e.balanced) * weight;
            }
            ProfilePoint {
                s_mm: s,
                r_mm: position.truncate().length(),
                z_mm: position.z,
                stretch_meridional: stretch.x,
                stretch_hoop: stretch.y,
            }
        })
        .collect()
}

/// The contact edge on a row of nodes.
struct Edge {
    /// The last node in contact.
    node: usize,
    /// Position of this node with its contact offset \[mm\].
    balanced: DVec3,
    /// 1 if the free sheet lies to the right of the node, else −1.
    outwards: f64,
    /// Position of the edge \[columns\].
    position: f64,
}

fn edges(solution: &Solution, row: usize) -> Vec<Edge> {
    let problem = solution.problem();
    let (sheet, dome, x) = (problem.sheet(), &problem.obstacle.dome, solution.inner());
    let n = sheet.nodes_per_side();
    let is_offset = |k: usize| solution.offset_nodes().iter().any(|(node, _)| *node == k);
    // Free nodes without contact.
    let is_off = |k: usize| {
        sheet.kinds()[k] == NodeKind::Free && dome.gauge(x[k]) > TOUCH_F64 && !is_offset(k)
    };
    let mut edges = Vec::new();
    for &(k, balanced) in solution.offset_nodes() {
        if k / n != row / n {
            continue;
        }
        for (outwards, next, second) in [(1.0, k + 1, k + 2), (-1.0, k - 1, k - 2)] {
            if !(is_off(next) && is_off(second)) {
                continue;
            }
            // The gap in front of the node is own + slope·s + bend·s²/2; the edge is at the minimum of the gap.
            let [own, near, far] = [balanced, x[next], x[second]].map(|p| dome.gauge(p));
            let bend = far - 2.0 * near + own;
            let slope = near - own - 0.5 * bend;
            let node = k - row;
            if bend > 0.0 && !edges.iter().any(|e: &Edge| e.node == node) {
                let position = node as f64 - outwards * slope / bend;
                edges.push(Edge { node, balanced, outwards, position });
            }
        }
    }
    edges
}

/// Lagrange weights of the nodes −1, 0, 1, 2 at t.
fn cubic(t: f64) -> [f64; 4] {
    [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ]
}

//! The height field of a surface over the plane of a frame: every triangle is drawn into a grid, the highest counts (z-buffer).
//!
//! A triangle covers the nodes inside of it; of the nodes on a common side of two triangles one covers each, by a rule of ties on
//! edge functions that are equal to the last bit for both. So a node is hit once by each sheet of a closed surface.

use crate::frame::Frame;
use crate::grid::Grid;
use crate::surface::Surface;
use glam::{DVec2, DVec3};

/// Least z of the unit normal of a triangle that faces outwards \[-\].
pub(crate) const LEAST_UP: f64 = 0.05;

/// What is drawn: a surface in a frame, its normals turned by `orientation` (+1, or −1 for a surface that is inside out).
#[derive(Clone, Copy)]
pub struct View<'a> {
    /// The surface.
    pub surface: &'a Surface,
    /// The first vertex at the position of each vertex ([`Surface::weld`]).
    pub welded: &'a [u32],
    /// The frame whose plane the grid lies in.
    pub frame: &'a Frame,
    /// +1, or −1 for normals that point inwards.
    pub orientation: f64,
}

impl View<'_> {
    /// The triangle's area vector in the frame's direction z \[mm²\], and its length \[mm²\], both twice the area.
    fn up(&self, triangle: [u32; 3]) -> (f64, f64) {
        let [a, b, c] = triangle.map(|k| self.surface.positions[k as usize]);
        let normal = (b - a).cross(c - a);
        (normal.dot(self.frame.axes.z_axis) * self.orientation, normal.length())
    }

    /// Does a triangle face outwards?
    fn is_outwards(&self, triangle: [u32; 3]) -> bool {
        let (up, length) = self.up(triangle);
        up > LEAST_UP * length
    }

    /// Share of the triangles within a distance of the frame's origin \[mm\] that face inwards \[%\]; 0 without one.
    pub(crate) fn inwards_percent(&self, within_mm: f64) -> f64 {
        let (mut all, mut inwards) = (0_u32, 0_u32);
        for triangle in &self.surface.triangles {
            let at = self.surface.positions[triangle[0] as usize];
            if at.distance_squared(self.frame.origin) < within_mm * within_mm {
                let (up, length) = self.up(*triangle);
                all += 1;
                inwards += u32::from(up < -LEAST_UP * length);
            }
        }
        100.0 * f64::from(inwards) / f64::from(all.max(1))
    }

    /// Those of some triangles that face outwards.
    #[must_use]
    pub fn outwards(&self, triangles: &[u32]) -> Vec<u32> {
        let faces = |index: &u32| self.is_outwards(self.surface.triangles[*index as usize]);
        triangles.iter().copied().filter(faces).collect()
    }

    /// The triangles that hang together with the vertex nearest to the frame's origin through triangles that face outwards, each
    /// connected with those that have a vertex in common.
    #[must_use]
    pub fn connected(&self) -> Vec<u32> {
        let Surface { positions, triangles, .. } = self.surface;
        let mut parents: Vec<u32> = (0..positions.len() as u32).collect();
        let mut outwards = Vec::with_capacity(triangles.len() / 2);
        let (mut start, mut nearest) = (0, f64::INFINITY);
        for (index, triangle) in triangles.iter().enumerate() {
            if !self.is_outwards(*triangle) {
                continue;
            }
            outwards.push(index as u32);
            let [a, b, c] = triangle.map(|k| self.welded[k as usize]);
            join(&mut parents, a, b);
            join(&mut parents, a, c);
            let distance = positions[a as usize].distance_squared(self.frame.origin);
            if distance < nearest {
                (nearest, start) = (distance, a);
            }
        }
        let start = root(&mut parents, start);
        outwards.retain(|&index| {
            let vertex = self.welded[triangles[index as usize][0] as usize];
            root(&mut parents, vertex) == start
        });
        outwards
    }

    /// Heights of the highest of some triangles at the nodes of a grid \[mm\]; NaN where there is none.
    #[must_use]
    pub fn heights(&self, grid: Grid, triangles: &[u32]) -> Vec<f64> {
        let mut heights = vec![f64::NAN; grid.len()];
        for &index in triangles {
            self.draw(grid, self.surface.triangles[index as usize], |node, height| {
                // A maximum ignores NaN.
                heights[node] = heights[node].max(height);
            });
        }
        heights
    }

    /// Air between the highest sheet of a surface and the one behind it, where the surface overhangs: its depth at each node \[mm\],
    /// counted above a floor; zero elsewhere.
    ///
    /// The sum of all heights above the floor, those of inward triangles counted negative, is the highest sheet less the air.
    #[must_use]
    pub fn air(&self, grid: Grid, heights: &[f64], floor: &[f64]) -> Vec<f64> {
        let mut sums = vec![(0.0, 0_i32); grid.len()];
        for triangle in &self.surface.triangles {
            let sign = self.up(*triangle).0.signum();
            self.draw(grid, *triangle, |node, height| {
                if height > floor[node] && height <= heights[node] {
                    sums[node].0 += sign * height;
                    sums[node].1 += sign as i32;
                }
            });
        }
        let of = |((sum, count), top): (&(f64, i32), &f64)| {
            if *count == 1 { (top - sum).max(0.0) } else { 0.0 }
        };
        sums.iter().zip(heights).map(of).collect()
    }

    /// Calls `visit` with every node that a triangle covers and the height there \[mm\].
    #[inline]
    fn draw(&self, grid: Grid, triangle: [u32; 3], mut visit: impl FnMut(usize, f64)) {
        let (side, per, half) = (grid.side(), 1.0 / grid.spacing_mm, grid.half as f64);
        let triangle = triangle.map(|k| self.welded[k as usize]);
        let corners = triangle.map(|k| {
            let local = self.frame.local(self.surface.positions[k as usize]);
            DVec3::new(local.x * per + half, local.y * per + half, local.z)
        });
        let [a, b, c] = corners;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let most = (side - 1) as f64;
        if high.x < 0.0 || high.y < 0.0 || low.x > most || low.y > most {
            return;
        }
        // Truncated, which needs no call: a node left of the triangle is outside of it.
        let [first_x, first_y] = [low.x, low.y].map(|at| at.max(0.0) as usize);
        let [last_x, last_y] = [high.x, high.y].map(|at| at.min(most) as usize);
        let flat = corners.map(DVec3::truncate);
        let area = (flat[1] - flat[0]).perp_dot(flat[2] - flat[0]);
        if area == 0.0 {
            return;
        }
        let turn = area.signum();
        for row in first_y..=last_y {
            for column in first_x..=last_x {
                let at = DVec2::new(column as f64, row as f64);
                let mut weights = [0.0; 3];
                let is_inside = (0..3).all(|k| {
                    let (from, to) = ((k + 1) % 3, (k + 2) % 3);
                    let edge = edge((triangle[from], flat[from]), (triangle[to], flat[to]), at);
                    weights[k] = edge * turn;
                    let way = (flat[to] - flat[from]) * turn;
                    weights[k] > 0.0 || edge == 0.0 && (way.y > 0.0 || way.y == 0.0 && way.x < 0.0)
                });
                if is_inside {
                    let sum = weights[0] + weights[1] + weights[2];
                    let of = |k: usize| weights[k] / sum * corners[k].z;
                    visit(row * side + column, of(0) + of(1) + of(2));
                }
            }
        }
    }
}

/// Twice the area of a point's triangle with an edge; the edge turned round gives the opposite to the last bit.
#[inline]
fn edge(from: (u32, DVec2), to: (u32, DVec2), at: DVec2) -> f64 {
    if from.0 < to.0 {
        (to.1 - from.1).perp_dot(at - from.1)
    } else {
        -(from.1 - to.1).perp_dot(at - to.1)
    }
}

/// The representative of a set (path halving).
fn root(parents: &mut [u32], mut node: u32) -> u32 {
    while parents[node as usize] != node {
        let above = parents[parents[node as usize] as usize];
        parents[node as usize] = above;
        node = above;
    }
    node
}

/// Unites the sets of two vertices.
fn join(parents: &mut [u32], a: u32, b: u32) {
    let (a, b) = (root(parents, a), root(parents, b));
    let (low, high) = (a.min(b), a.max(b));
    parents[high as usize] = low;
}

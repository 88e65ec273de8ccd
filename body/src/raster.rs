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

/// What is drawn: a surface in a frame.
pub struct View<'a> {
    surface: &'a Surface,
    welded: &'a [u32],
    frame: &'a Frame,
    orientation: f64,
    /// The vertices in the frame \[mm\].
    places: Vec<DVec3>,
}

impl<'a> View<'a> {
    /// A surface in a frame whose plane the grids lie in. `welded` is the first vertex at the position of each vertex
    /// ([`Surface::weld`]), `orientation` +1, or −1 for a surface whose normals point inwards.
    #[must_use]
    pub fn new(
        surface: &'a Surface,
        welded: &'a [u32],
        frame: &'a Frame,
        orientation: f64,
    ) -> Self {
        let places = surface.positions.iter().map(|at| frame.local(*at)).collect();
        Self { surface, welded, frame, orientation, places }
    }

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
            let local = self.places[k as usize];
            DVec3::new(local.x * per + half, local.y * per + half, local.z)
        });
        let [a, b, c] = corners;
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let most = (side - 1) as f64;
        if high.x < 0.0 || high.y < 0.0 || low.x > most || low.y > most {
            return;
        }
        let [first_x, first_y] = [low.x, low.y].map(not_below);
        let [last_x, last_y] = [high.x, high.y].map(|at| at.min(most) as usize);
        let flat = corners.map(DVec3::truncate);
        let area = (flat[1] - flat[0]).perp_dot(flat[2] - flat[0]);
        if area == 0.0 || first_x > last_x || first_y > last_y {
            return;
        }
        let edges = [[1, 2], [2, 0], [0, 1]].map(|[from, to]| {
            Edge::new([triangle[from], triangle[to]], [flat[from], flat[to]], area.signum())
        });
        for row in first_y..=last_y {
            for column in first_x..=last_x {
                let at = DVec2::new(column as f64, row as f64);
                let weights = edges.map(|edge| edge.weight(at));
                // Without branches, which a processor would guess wrongly for every other node.
                let is_within =
                    |k: usize| (weights[k] > 0.0) | (weights[k] == 0.0) & edges[k].is_own;
                if is_within(0) & is_within(1) & is_within(2) {
                    let sum = weights[0] + weights[1] + weights[2];
                    let of = |k: usize| weights[k] / sum * corners[k].z;
                    visit(row * side + column, of(0) + of(1) + of(2));
                }
            }
        }
    }
}

/// The first node that is not below a coordinate, in nodes (its ceiling, which needs no call here).
#[inline]
fn not_below(at: f64) -> usize {
    let at = at.max(0.0);
    let node = at as usize;
    node + usize::from((node as f64) < at)
}

/// An edge of a triangle.
#[derive(Clone, Copy)]
struct Edge {
    start: DVec2,
    way: DVec2,
    /// Turns the weights: positive inside of the triangle.
    turn: f64,
    /// Do the nodes on the edge belong to the triangle?
    is_own: bool,
}

impl Edge {
    /// The edge between two vertices in a triangle that turns by `turn`. It starts at the vertex of the smaller number, so that turned
    /// round it gives the opposite weights to the last bit.
    #[inline]
    fn new([from, to]: [u32; 2], ends: [DVec2; 2], turn: f64) -> Self {
        let way = (ends[1] - ends[0]) * turn;
        let is_own = way.y > 0.0 || way.y == 0.0 && way.x < 0.0;
        if from < to {
            Self { start: ends[0], way: ends[1] - ends[0], turn, is_own }
        } else {
            Self { start: ends[1], way: ends[0] - ends[1], turn: -turn, is_own }
        }
    }

    /// Twice the area of a point's triangle with the edge, positive on the triangle's side.
    #[inline]
    fn weight(&self, at: DVec2) -> f64 {
        self.way.perp_dot(at - self.start) * self.turn
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

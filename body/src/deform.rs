//! A body's surface after a solve: the displacement of the tissue's columns, evaluated at the surface's own vertices and faded out
//! over the last 15 mm of the patch (by up to 0.4 mm), so that the skin has no kink there.

use crate::frame::Frame;
use crate::grid::smooth_step;
use crate::marks::Marks;
use crate::surface::Surface;
use glam::{DMat3, DVec2, DVec3};
use implant_preview_solver::mesh::{CellKind, Chest, NodeKind};
use implant_preview_solver::solve::{Problem, Solution};

/// Greatest number of steps of Newton's method for a vertex, and of full steps: 3 to 5 converge.
const STEPS: usize = 30;
const FULL_STEPS: usize = 8;
/// Steps from a place over the plane to a place along the wall.
const ALONG_STEPS: usize = 4;
/// Number of steps beyond the tissue after which a point is outside of it.
const MOST_BEYOND: usize = 4;
/// Length of the last step \[grid spacings, thicknesses\].
const LAST_STEP: f64 = 1e-10;
/// Distance from the patch's edge over which the displacement fades \[mm\]: the clamped edge would be a kink of 2° to 13° in the skin.
const FADE_MM: f64 = 15.0;
/// Depth below the wall over which the displacement fades \[mm\]: where the skin falls more steeply than a wall can, as over the flank of a narrow chest, it
/// passes below the wall.
const BELOW_MM: f64 = 15.0;

/// The surface after a solve. Vertices that the tissue does not move keep their bits: those outside of the patch, 15 mm below the wall, and all at rest.
#[must_use]
pub fn deform(surface: &Surface, frame: &Frame, solution: &Solution) -> Surface {
    deform_sides(surface, &[(*frame, solution)])
}

/// The surface after the solves of both sides, each in its frame, as [`deform`]: a point that both move goes both ways.
#[must_use]
pub fn deform_sides(surface: &Surface, sides: &[(Frame, &Solution)]) -> Surface {
    let (mut deformed, sides) = (surface.clone(), columns(sides));
    for position in &mut deformed.positions {
        *position = moved(*position, &sides);
    }
    deformed
}

/// Marks after the solves of one or both sides: material points, which move with the tissue.
#[must_use]
pub fn deform_marks(marks: &Marks, sides: &[(Frame, &Solution)]) -> Marks {
    let sides = columns(sides);
    marks.mapped(|point| moved(point, &sides))
}

/// The columns of the sides and how they move.
fn columns(sides: &[(Frame, &Solution)]) -> Vec<(Frame, Columns, Moves)> {
    let of = |(frame, solution): &(Frame, &Solution)| {
        (*frame, Columns::new(solution.problem()), Moves::new(solution))
    };
    sides.iter().map(of).collect()
}

/// A point after the solves of the sides \[mm\]; the same bits where no tissue moves.
fn moved(point: DVec3, sides: &[(Frame, Columns, Moves)]) -> DVec3 {
    let mut now = point;
    for (frame, columns, moves) in sides {
        let by = columns.weights(frame.local(point)).map_or(DVec3::ZERO, |at| moves.of(&at));
        if by != DVec3::ZERO {
            now += frame.direction(by);
        }
    }
    now
}

/// Volume that a surface gains between two shapes of equal triangles whose borders are equal \[ml\]: over an implant that of the
/// implant and of the void beside it.
#[must_use]
pub fn gained_ml(before: &Surface, after: &Surface) -> f64 {
    let origin = before.positions.first().copied().unwrap_or_default();
    let volume = |surface: &Surface, triangle: [u32; 3]| {
        let [a, b, c] = surface.corners(triangle).map(|p| p - origin);
        a.dot(b.cross(c))
    };
    let of = |triangle: &[u32; 3]| volume(after, *triangle) - volume(before, *triangle);
    before.triangles.iter().map(of).sum::<f64>() / 6e3
}

/// How a point moves with the nodes of a solution.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Weights {
    /// Nodes of the cell, and their weights \[-\].
    corners: [(u32, f64); 4],
    /// Layers of nodes below and above the point.
    layers: [usize; 2],
    /// The part of the upper layer \[-\].
    part: f64,
    /// Distance from the patch's edge, along the wall \[mm\]; infinite where the displacement does not fade.
    from_edge_mm: f64,
    /// Depth below the wall \[mm\].
    below_mm: f64,
    /// Share of the column's height \[-\].
    share: f64,
}

impl Weights {
    /// Height of the point in its column, from the wall (0) to the skin (1) \[-\].
    #[must_use]
    pub fn share(&self) -> f64 {
        self.share
    }

    /// Distance from the patch's edge, along the wall \[mm\]; infinite where the displacement does not fade.
    #[must_use]
    pub fn from_edge_mm(&self) -> f64 {
        self.from_edge_mm
    }

    /// The value at the point of values at the nodes of the skin; `None` without values.
    #[must_use]
    pub fn value(&self, values: &[f32]) -> Option<f32> {
        let of = |(k, weight): (u32, f64)| Some(weight * f64::from(*values.get(k as usize)?));
        self.corners.into_iter().map(of).sum::<Option<f64>>().map(|value| value as f32)
    }
}

/// Displacements of the nodes of a solution \[mm\], layer by layer.
#[derive(Clone, Debug)]
pub struct Moves(Vec<Vec<DVec3>>);

impl Moves {
    /// From rest to a shape.
    #[must_use]
    pub fn new(solution: &Solution) -> Self {
        let rest = &solution.problem().rest;
        let shapes =
            std::iter::once(solution.inner()).chain(solution.outer().iter().map(Vec::as_slice));
        let moves = |(layer, shape): (usize, &[DVec3])| {
            shape.iter().zip(rest.nodes(layer)).map(|(now, rest)| *now - rest).collect()
        };
        Self(shapes.enumerate().map(moves).collect())
    }

    /// From rest to a part of the way to a shape of the same grid \[-\].
    #[must_use]
    pub fn toward(mut self, to: &Self, part: f64) -> Self {
        for (own, to) in self.0.iter_mut().flatten().zip(to.0.iter().flatten()) {
            *own = own.lerp(*to, part);
        }
        self
    }

    /// Displacement of a point \[mm\].
    #[inline]
    #[must_use]
    pub fn of(&self, weights: &Weights) -> DVec3 {
        let [below, above] = weights.layers;
        let moved = |layer: usize| -> DVec3 {
            let of = |(k, weight): (u32, f64)| self.0[layer][k as usize] * weight;
            weights.corners.into_iter().map(of).sum()
        };
        let part = weights.part;
        (moved(below) * (1.0 - part) + moved(above) * part)
            * smooth_step(weights.from_edge_mm / FADE_MM)
            * smooth_step(1.0 - weights.below_mm / BELOW_MM)
    }
}

/// The columns of the tissue at rest.
#[derive(Clone, Debug)]
pub struct Columns {
    /// Nodes a side.
    side: usize,
    spacing_mm: f64,
    /// Radius of the patch \[mm\].
    radius_mm: f64,
    /// Foot of each column \[mm\].
    feet: Vec<DVec3>,
    /// From the foot to the skin \[mm\].
    ups: Vec<DVec3>,
    /// Heights of the layers of nodes \[column heights\].
    shares: Vec<f64>,
    /// The outermost nodes \[mm\].
    skin: Vec<DVec3>,
    /// Slope of the plane that the wall's heights count from \[-\].
    tilt: DVec2,
    /// Least height of a foot \[mm\] and greatest distance of a node from the z axis, squared \[mm²\].
    reach: (f64, f64),
}

impl Columns {
    /// The columns of a problem's tissue.
    #[must_use]
    pub fn new(problem: &Problem) -> Self {
        let (rest, sheet) = (&problem.rest, problem.sheet());
        let top = rest.layers() - 1;
        let skin: Vec<DVec3> = rest.nodes(top).collect();
        let mut feet: Vec<DVec3> = rest.nodes(0).collect();
        let mut ups: Vec<DVec3> = feet.iter().zip(&skin).map(|(foot, tip)| *tip - *foot).collect();
        // The outer corner of a cell on the patch's edge completes a parallelogram.
        let side = sheet.nodes_per_side();
        for (j, i) in (0..side - 1).flat_map(|j| (0..side - 1).map(move |i| (j, i))) {
            if let CellKind::WithoutCorner(corner) = sheet.cell(i, j) {
                let corners = sheet.corners(i, j);
                let [at, next, across, last] =
                    [0, 1, 2, 3].map(|k| corners[(usize::from(corner) + k) % 4]);
                feet[at] = feet[next] + feet[last] - feet[across];
                ups[at] = ups[next] + ups[last] - ups[across];
            }
        }
        let total = ups.iter().zip(sheet.kinds()).find(|(_, kind)| **kind == NodeKind::Free);
        let total = total.map_or(1.0, |(up, _)| up.length());
        let free = sheet.kinds().iter().position(|kind| *kind == NodeKind::Free).unwrap_or(0);
        let shares = (0..=top)
            .map(|layer| rest.node(layer, free).distance(rest.node(0, free)) / total)
            .collect();
        if top == 0 {
            // A sheet has no height: a column of one spacing.
            ups.fill(DVec3::Z * sheet.spacing_mm());
        }
        let tilt = match &problem.obstacle.wall.0 {
            Chest::Grid(heights) => DVec2::from(heights.tilt()),
            _ => DVec2::ZERO,
        };
        let low = feet.iter().map(|foot| foot.z).fold(f64::INFINITY, f64::min);
        let far = feet.iter().zip(&ups).map(|(foot, up)| {
            foot.truncate().length_squared().max((*foot + *up).truncate().length_squared())
        });
        let reach = (low - sheet.spacing_mm().max(BELOW_MM), far.fold(0.0, f64::max));
        let (spacing_mm, radius_mm) = (sheet.spacing_mm(), sheet.radius_mm());
        Self { side, spacing_mm, radius_mm, feet, ups, shares, skin, tilt, reach }
    }

    /// How a point of the frame moves; `None` where the tissue does not move.
    #[must_use]
    pub fn weights(&self, point: DVec3) -> Option<Weights> {
        let (low, far) = self.reach;
        let point = point.with_z(point.z - self.tilt.dot(point.truncate()));
        if point.z < low || point.truncate().length_squared() > far {
            return None;
        }
        let (place, share, below_mm) = self.place(point)?;
        let half = 0.5 * (self.side - 1) as f64;
        let (node, [a, b]) = self.cell(place + DVec2::splat(half))?;
        let share = share.clamp(0.0, 1.0);
        let above =
            self.shares.iter().position(|at| *at >= share)?.max(1).min(self.shares.len() - 1);
        let below = above.saturating_sub(1);
        let rise = self.shares[above] - self.shares[below];
        let part = if rise > 0.0 { (share - self.shares[below]) / rise } else { 0.0 };
        let from_edge_mm = (half - place.length()) * self.spacing_mm;
        let corners = self.corners(node, [a, b]);
        Some(Weights { corners, layers: [below, above], part, from_edge_mm, below_mm, share })
    }

    /// How the skin over a place of the plane moves \[mm\]; `None` beyond the patch.
    #[must_use]
    pub fn over(&self, place: DVec2) -> Option<Weights> {
        if place.length() >= self.radius_mm {
            return None;
        }
        let most = (self.side - 1) as f64;
        let cell = |along: DVec2| {
            let at = along / self.spacing_mm + DVec2::splat(0.5 * most);
            let at = at.clamp(DVec2::ZERO, DVec2::splat(most));
            let low = at.floor().min(DVec2::splat(most - 1.0));
            let node = low.y as usize * self.side + low.x as usize;
            self.corners(node, (at - low).to_array())
        };
        // The skin at rest over that place is another place along a curved wall.
        let mut along = place;
        for _ in 0..ALONG_STEPS {
            let above = |(k, weight): (u32, f64)| self.skin[k as usize] * weight;
            let above: DVec3 = cell(along).into_iter().map(above).sum();
            along += place - above.truncate();
        }
        let top = self.shares.len() - 1;
        let (corners, layers, from_edge_mm) = (cell(along), [top; 2], f64::INFINITY);
        Some(Weights { corners, layers, part: 1.0, from_edge_mm, below_mm: 0.0, share: 1.0 })
    }

    /// The nodes of a cell and their weights at a place in it.
    fn corners(&self, node: usize, [a, b]: [f64; 2]) -> [(u32, f64); 4] {
        let of = |by: usize, weight: f64| ((node + by) as u32, weight);
        [
            of(0, (1.0 - a) * (1.0 - b)),
            of(1, a * (1.0 - b)),
            of(self.side, (1.0 - a) * b),
            of(self.side + 1, a * b),
        ]
    }

    /// The cell of a place of the grid: its first node, and the place in the cell.
    #[inline]
    fn cell(&self, place: DVec2) -> Option<(usize, [f64; 2])> {
        let most = (self.side - 1) as f64;
        if !(0.0..=most).contains(&place.x) || !(0.0..=most).contains(&place.y) {
            return None;
        }
        let [i, j] = place.to_array().map(|at| (at as usize).min(self.side - 2));
        Some((j * self.side + i, [place.x - i as f64, place.y - j as f64]))
    }

    /// Place from the patch's centre \[grid spacings\] and share of the column's height that map to a point (Newton's method on the map that is bilinear in each
    /// cell and linear along the columns), and its depth below the wall \[mm\].
    fn place(&self, point: DVec3) -> Option<(DVec2, f64, f64)> {
        let half = 0.5 * (self.side - 1) as f64;
        // From the patch's centre \[grid spacings\]; at first under the point.
        let mut place = (point.truncate() / self.spacing_mm).clamp_length_max(half - 1.0);
        let (mut share, mut beyond) = (1.0, 0);
        for count in 0..STEPS {
            let (node, [a, b]) = self.cell(place + DVec2::splat(half))?;
            let [c00, c10, c01, c11] = [node, node + 1, node + self.side, node + self.side + 1];
            let at = |values: &[DVec3]| {
                let (low, high) = (values[c10] - values[c00], values[c11] - values[c01]);
                let left = values[c01] - values[c00];
                let along_x = low.lerp(high, b);
                let along_y = left.lerp(values[c11] - values[c10], a);
                (values[c00] + low * a + (left + (high - low) * a) * b, along_x, along_y)
            };
            let ((foot, foot_x, foot_y), (up, up_x, up_y)) = (at(&self.feet), at(&self.ups));
            let apart = point - (foot + up * share);
            let jacobian = DMat3::from_cols(foot_x + up_x * share, foot_y + up_y * share, up);
            let step = jacobian.inverse() * apart;
            if !step.is_finite() {
                return None;
            }
            // Full steps may go to and fro over the kink between two cells.
            let length = if count < FULL_STEPS { 1.0 } else { 0.6 };
            place += step.truncate() * length;
            share += step.z * length;
            let below_mm = (-share).max(0.0) * up.length();
            let is_beyond = place.length() >= half || below_mm >= BELOW_MM;
            if step.abs().max_element() < LAST_STEP {
                return (!is_beyond).then_some((place, share, below_mm));
            }
            // A point beyond the patch or far below the wall stays there.
            if is_beyond {
                beyond += 1;
                if beyond > MOST_BEYOND {
                    return None;
                }
            }
            (place, share) = (place.clamp_length_max(half), share.clamp(-3.0, 3.0));
        }
        None
    }
}

//! A body's surface after a solve: the displacement of the tissue's columns, evaluated at the surface's own vertices and faded out
//! over the last 15 mm of the patch (by up to 0.4 mm), so that the skin has no kink there.

use crate::frame::Frame;
use crate::grid::smooth_step;
use crate::marks::Marks;
use crate::surface::Surface;
use glam::{DMat3, DVec2, DVec3};
use implant_preview_solver::mesh::{CellKind, Chest, NodeKind};
use implant_preview_solver::solve::Solution;

/// Greatest number of steps of Newton's method for a vertex, and of full steps: 3 to 5 converge.
const STEPS: usize = 30;
const FULL_STEPS: usize = 8;
/// Number of steps beyond the tissue after which a point is outside of it.
const MOST_BEYOND: usize = 4;
/// Length of the last step \[grid spacings, thicknesses\].
const LAST_STEP: f64 = 1e-10;
/// Distance from the patch's edge over which the displacement fades \[mm\]: the clamped edge would be a kink of 2° to 13° in the skin.
const FADE_MM: f64 = 15.0;
/// Depth below the wall up to which a vertex belongs to the tissue \[thicknesses\].
const BELOW_WALL: f64 = 0.02;

/// The surface after a solve. Vertices that the tissue does not move keep their bits: those outside of the patch, below the wall, and all at rest.
#[must_use]
pub fn deform(surface: &Surface, frame: &Frame, solution: &Solution) -> Surface {
    let mut deformed = surface.clone();
    let columns = Columns::new(solution);
    for position in &mut deformed.positions {
        if let Some(by) = columns.displacement(frame.local(*position)) {
            *position += frame.direction(by);
        }
    }
    deformed
}

/// Marks after a solve: material points, which move with the tissue.
#[must_use]
pub fn deform_marks(marks: &Marks, frame: &Frame, solution: &Solution) -> Marks {
    let columns = Columns::new(solution);
    marks.mapped(|point| {
        let by = columns.displacement(frame.local(point)).unwrap_or_default();
        point + frame.direction(by)
    })
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

/// The columns of the tissue at rest, and how their nodes moved.
struct Columns<'a> {
    /// Nodes a side.
    side: usize,
    spacing_mm: f64,
    /// Foot of each column \[mm\].
    feet: Vec<DVec3>,
    /// From the foot to the skin \[mm\].
    ups: Vec<DVec3>,
    /// Heights of the layers of nodes \[column heights\].
    shares: Vec<f64>,
    /// Positions after the solve and at rest \[mm\], layer by layer.
    layers: Vec<(&'a [DVec3], Vec<DVec3>)>,
    /// Slope of the plane that the wall's heights count from \[-\].
    tilt: DVec2,
    /// Least height of a foot \[mm\] and greatest distance of a node from the z axis, squared \[mm²\].
    reach: (f64, f64),
}

impl<'a> Columns<'a> {
    fn new(solution: &'a Solution) -> Self {
        let problem = solution.problem();
        let (rest, sheet) = (&problem.rest, problem.sheet());
        let top = rest.layers() - 1;
        let mut feet: Vec<DVec3> = rest.nodes(0).collect();
        let mut ups: Vec<DVec3> =
            feet.iter().zip(rest.nodes(top)).map(|(foot, tip)| tip - *foot).collect();
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
        let shapes =
            std::iter::once(solution.inner()).chain(solution.outer().iter().map(Vec::as_slice));
        let layers =
            shapes.enumerate().map(|(layer, shape)| (shape, rest.nodes(layer).collect())).collect();
        let tilt = match &problem.obstacle.wall.0 {
            Chest::Grid(heights) => DVec2::from(heights.tilt()),
            _ => DVec2::ZERO,
        };
        let low = feet.iter().map(|foot| foot.z).fold(f64::INFINITY, f64::min);
        let far = feet.iter().zip(&ups).map(|(foot, up)| {
            foot.truncate().length_squared().max((*foot + *up).truncate().length_squared())
        });
        let reach = (low - sheet.spacing_mm(), far.fold(0.0, f64::max));
        let spacing_mm = sheet.spacing_mm();
        Self { side, spacing_mm, feet, ups, shares, layers, tilt, reach }
    }

    /// Displacement of a point of the frame \[mm\]; `None` where the tissue does not move.
    fn displacement(&self, point: DVec3) -> Option<DVec3> {
        let (low, far) = self.reach;
        let point = point.with_z(point.z - self.tilt.dot(point.truncate()));
        if point.z < low || point.truncate().length_squared() > far {
            return None;
        }
        let (place, share) = self.place(point)?;
        let half = 0.5 * (self.side - 1) as f64;
        let (node, [a, b]) = self.cell(place + DVec2::splat(half))?;
        let corners = [node, node + 1, node + self.side, node + self.side + 1];
        let weights = [(1.0 - a) * (1.0 - b), a * (1.0 - b), (1.0 - a) * b, a * b];
        let share = share.clamp(0.0, 1.0);
        let above =
            self.shares.iter().position(|at| *at >= share)?.max(1).min(self.shares.len() - 1);
        let below = above.saturating_sub(1);
        let moved = |layer: usize| {
            let (shape, rest) = &self.layers[layer];
            let of = |(k, weight): (&usize, f64)| (shape[*k] - rest[*k]) * weight;
            corners.iter().zip(weights).map(of).sum::<DVec3>()
        };
        let rise = self.shares[above] - self.shares[below];
        let part = if rise > 0.0 { (share - self.shares[below]) / rise } else { 0.0 };
        let fade = smooth_step((half - place.length()) * self.spacing_mm / FADE_MM);
        let by = (moved(below) * (1.0 - part) + moved(above) * part) * fade;
        (by != DVec3::ZERO).then_some(by)
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
    /// cell and linear along the columns).
    fn place(&self, point: DVec3) -> Option<(DVec2, f64)> {
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
            if step.abs().max_element() < LAST_STEP {
                let is_within = share >= -BELOW_WALL && place.length() < half;
                return is_within.then_some((place, share));
            }
            // A point beyond the patch or below the wall stays there.
            if place.length() > half || share < -BELOW_WALL {
                beyond += 1;
                if beyond > MOST_BEYOND {
                    return None;
                }
            }
            (place, share) = (place.clamp_length_max(half), share.clamp(-0.5, 3.0));
        }
        None
    }
}

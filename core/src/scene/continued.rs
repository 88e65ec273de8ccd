//! A chest wall continued where its scan has no heights: by a quadric into which the data blend.
//!
//! The quadric q minimises Σω(z − q)² with ω = min(1, 4 mm/|z − q|) (Huber, renewed 8 times); where one of its curvatures is out of bounds,
//! q is fitted again with the curvatures at their bounds. The difference r = z − q keeps its values at the data and minimises
//! ∫ |∇∇r|² + (2/ℓ²)|∇r|² + r²/ℓ⁴ elsewhere, a thin plate in tension on a foundation: beside a straight edge r falls as
//! (1 + d/ℓ) exp(−d/ℓ), with ℓ = 5 mm to 9 % within 20 mm, and the slope is continuous. ℓ grows up to 40 mm where the blend of a
//! smaller ℓ would be hollower than the tissue allows; gaps that data enclose always have that one, as their heights follow from those around, not from the quadric.

use super::grid::{self, COUNTS};
use super::open::Open;
use crate::body::chest::{Quadric, solved};
use crate::mesh::{Chest, HeightGrid};
use glam::DVec2;
use std::cell::LazyCell;
use std::f64::consts::TAU;

/// Lengths ℓ of the blend, tried in this order, and the one within holes of the data \[mm\].
const LENGTHS_MM: [f64; 6] = [5.0, 8.0, 12.0, 18.0, 27.0, LONGEST_MM];
const LONGEST_MM: f64 = 40.0;
/// Least radius of a hollow of the continuation at the nodes, by the heights, and of the quadric \[thicknesses of the tissue\]; a scene
/// allows 1.25, by the wall's curvature.
const HOLLOWS: (f64, f64) = (2.5, 3.0);
/// Least radius of curvature of the quadric outwards \[radii of the simulated tissue\], as of a chest by radii.
const LEAST_OF_PATCH: f64 = 0.75;
/// Nodes beside an open one at which the blend may make a hollow: the spline of the heights rings there by 0.27 a node.
const RINGING: usize = 3;
/// Part of the hollow of the longest blend up to which one at a known height is that of the data \[-\].
const OF_DATA: f64 = 1.25;
/// Difference from the quadric beyond which a height loses weight \[mm\], and renewals of the weights.
const HUBER: (f64, usize) = (4.0, 8);
/// Weight of curvatures at their bounds \[heights\].
const FIRM: f64 = 1e8;
/// Unit of length of the quadric's coefficients \[mm\].
const UNIT_MM: f64 = 100.0;
/// Directions in which the edges of pocket and tissue are traced.
const DIRECTIONS: usize = 48;
/// A grid of half as many nodes a side gives the first guess while spacings are below this \[ℓ\] and sides have more nodes than that.
const COARSEN: (f64, usize) = (0.5, 16);
/// Iterations of conjugate gradients, and the residual that ends these \[first residual\].
const ITERATIONS: (usize, f64) = (150, 1e-6);

/// Heights with gaps on a grid, and the quadric that continues them.
pub(super) struct Continuation {
    counts: [usize; 2],
    /// Columns and rows of them beyond the given grid on either side.
    more: [usize; 2],
    spacing_mm: f64,
    heights: Vec<Option<f64>>,
    quadric: Quadric,
}

impl Continuation {
    /// Of heights with a spacing, on a grid that is extended until it covers the simulated tissue of a radius \[mm\] but for a
    /// spacing; `tissue_mm` is the greatest thickness. `None` for a grid that is too small, and heights that determine no quadric.
    pub(super) fn new(
        (spacing_mm, counts): (f64, [usize; 2]),
        given: &[Option<f64>],
        patch_mm: f64,
        tissue_mm: f64,
    ) -> Option<Self> {
        let more = counts.map(|count| {
            let lacks = patch_mm / spacing_mm - 1.0 - 0.5 * (count - 1) as f64;
            lacks.ceil().max(0.0) as usize
        });
        let wide = [0, 1].map(|axis| counts[axis] + 2 * more[axis]);
        if wide.into_iter().max()? > COUNTS.1 {
            return None;
        }
        let at = |k: usize| {
            let (column, row) = ((k % wide[0]).checked_sub(more[0])?, k / wide[0]);
            let row = row.checked_sub(more[1])?;
            let is_given = column < counts[0] && row < counts[1];
            given[if is_given { row * counts[0] + column } else { return None }]
        };
        let heights = (0..wide[0] * wide[1]).map(at).collect();
        let quadric = Quadric::default();
        let mut found = Self { counts: wide, more, spacing_mm, heights, quadric };
        let least_mm = [LEAST_OF_PATCH * patch_mm, HOLLOWS.1 * tissue_mm];
        found.quadric = through(&found.data(), least_mm)?;
        Some(found)
    }

    /// The known heights at their places.
    fn data(&self) -> Vec<(DVec2, f64)> {
        let known = self.heights.iter().enumerate();
        known.filter_map(|(k, height)| Some((self.place(k), (*height)?))).collect()
    }

    fn place(&self, k: usize) -> DVec2 {
        grid::place(k, self.counts, self.spacing_mm)
    }

    /// Heights a row and a column.
    pub(super) fn counts(&self) -> [usize; 2] {
        self.counts
    }

    /// Shares of the nodes with data within lengths along the quadric \[-\]: with a height, and with one or within a gap that heights bridge.
    pub(super) fn shares<const N: usize>(&self, lengths_mm: [f64; N]) -> Option<[[f64; 2]; N]> {
        let nodes = || (0..self.heights.len()).map(|k| (k, self.place(k)));
        let smooth = nodes().map(|(_, place)| self.quadric.at(place)).collect();
        let wall = Chest::Grid(HeightGrid::new(self.spacing_mm, self.counts, smooth)?);
        let bridged = self.open().known_or_bridged();
        Some(lengths_mm.map(|length| {
            let edge = |k: usize| {
                let way = DVec2::from_angle(TAU * k as f64 / DIRECTIONS as f64);
                wall.foot_and_normal(way * length).0.truncate().length()
            };
            let edges: Vec<f64> = (0..DIRECTIONS).map(edge).collect();
            let is_within = |place: DVec2| {
                let turn = place.to_angle().rem_euclid(TAU) / TAU * DIRECTIONS as f64;
                let edge = edges[turn.round() as usize % DIRECTIONS];
                place.length() <= edge.max(self.spacing_mm)
            };
            let within = nodes().filter(|(_, place)| is_within(*place));
            let all = within.clone().count().max(1) as f64;
            let known = within.clone().filter(|(k, _)| self.heights[*k].is_some()).count();
            let bridged = within.filter(|(k, _)| bridged[*k]).count();
            [known, bridged].map(|count| count as f64 / all)
        }))
    }

    fn open(&self) -> Open<'_> {
        let Self { counts, spacing_mm, ref heights, .. } = *self;
        Open { counts, spacing_mm, heights }
    }

    /// Place and width of the widest gap in a region \[mm\]; `None` without a gap that is wider than heights bridge.
    pub(super) fn widest_gap(&self, is_within: impl Fn(DVec2) -> bool) -> Option<(DVec2, f64)> {
        let (node, width) = self.open().widest(|k| is_within(self.place(k)))?;
        Some((self.place(node), width))
    }

    /// Of values on the extended grid those on the grid as given.
    pub(super) fn given(&self, of: &[f64]) -> Vec<f64> {
        let [columns, rows] = self.more;
        let (width, height) = (self.counts[0] - 2 * columns, self.counts[1] - 2 * rows);
        let row = |j: usize| &of[(rows + j) * self.counts[0] + columns..][..width];
        (0..height).flat_map(row).copied().collect()
    }

    /// Replaces the known heights.
    pub(super) fn replace(&mut self, by: &[f64]) {
        for (known, by) in self.heights.iter_mut().zip(by) {
            if let Some(known) = known {
                *known = *by;
            }
        }
    }

    /// The wall with the shortest blend that is nowhere hollower than the tissue at a place allows, otherwise with the longest one.
    pub(super) fn wall(&self, patch_mm: f64, tissue_mm: impl Fn(DVec2) -> f64) -> Option<Chest> {
        let near: Vec<(DVec2, bool)> = (0..self.heights.len())
            .filter(|&k| self.is_near_open(k))
            .map(|k| (self.place(k), self.heights[k].is_some()))
            .filter(|(place, _)| place.length() <= patch_mm)
            .collect();
        let blended = |length: f64| {
            let grid = HeightGrid::new(self.spacing_mm, self.counts, self.continued(length));
            grid.map(Chest::Grid)
        };
        let longest = LazyCell::new(|| blended(LONGEST_MM));
        for length in LENGTHS_MM.into_iter().filter(|length| *length < LONGEST_MM) {
            let found = blended(length)?;
            let fits = |&(place, is_known): &(DVec2, bool)| {
                let bend = |wall: &Chest| bend(wall, place);
                let of_data = || longest.as_ref().map_or(0.0, |longest| OF_DATA * bend(longest));
                bend(&found) * HOLLOWS.0 * tissue_mm(place) <= 1.0
                    || is_known && bend(&found) <= of_data()
            };
            if near.iter().all(fits) {
                return Some(found);
            }
        }
        longest.clone()
    }

    /// Has a node, or one beside it to which the spline rings, no height?
    fn is_near_open(&self, k: usize) -> bool {
        let [columns, rows] = self.counts;
        let (i, j) = (k % columns, k / columns);
        let beside =
            |at: usize, count: usize| at.saturating_sub(RINGING)..(at + RINGING + 1).min(count);
        let open = |row: usize| {
            let row = &self.heights[row * columns..][..columns];
            row[beside(i, columns)].iter().any(Option::is_none)
        };
        beside(j, rows).any(open)
    }

    /// All heights, continued with a length of the blend \[mm\].
    fn continued(&self, length_mm: f64) -> Vec<f64> {
        let is_open: Vec<bool> = self.heights.iter().map(Option::is_none).collect();
        let smooth: Vec<f64> =
            (0..self.heights.len()).map(|k| self.quadric.at(self.place(k))).collect();
        let apart = self.heights.iter().zip(&smooth);
        let mut apart: Vec<f64> =
            apart.map(|(height, smooth)| height.map_or(0.0, |height| height - smooth)).collect();
        let plate = |length_mm: f64| {
            let tension = (self.spacing_mm / length_mm).powi(2);
            Plate { counts: self.counts, tension }
        };
        plate(length_mm).fill(&mut apart, &is_open);
        let enclosed = self.open().enclosed();
        if length_mm < LONGEST_MM && enclosed.contains(&true) {
            plate(LONGEST_MM).fill(&mut apart, &enclosed);
        }
        let filled = apart.iter().zip(&smooth).map(|(apart, smooth)| smooth + apart);
        self.heights.iter().zip(filled).map(|(height, filled)| height.unwrap_or(filled)).collect()
    }

    /// All heights with the shortest blend.
    pub(super) fn shortest(&self) -> Vec<f64> {
        self.continued(LENGTHS_MM[0])
    }
}

/// Greatest second derivative of a wall over all directions \[1/mm\], positive in a hollow.
pub(super) fn bend(wall: &Chest, place: DVec2) -> f64 {
    let [xx, xy, yy] = wall.curvature(place);
    0.5 * (xx + yy) + (0.5 * (xx - yy)).hypot(xy)
}

/// The quadric through heights, of least radii of curvature outwards and in a hollow \[mm\].
fn through(data: &[(DVec2, f64)], [outwards, hollow]: [f64; 2]) -> Option<Quadric> {
    let free = fitted(data, None)?;
    let [_, _, _, xx, xy, yy] = free.coefficients;
    let (mean, turned) = (xx + yy, (xx - yy).hypot(xy));
    let unit = UNIT_MM * UNIT_MM;
    let bends = [mean - turned, mean + turned];
    let (least, most) = (-unit / outwards, unit / hollow);
    if bends.into_iter().all(|bend| (least..=most).contains(&bend)) {
        return Some(free);
    }
    let held = bends.map(|bend| bend.clamp(least, most));
    let factor = 0.5 * (held[1] - held[0]) / turned.max(f64::MIN_POSITIVE);
    let (mean, apart) = (0.25 * (held[0] + held[1]), 0.5 * (xx - yy) * factor);
    fitted(data, Some([mean + apart, xy * factor, mean - apart]))
}

/// The quadric through heights, with free or given curvatures.
fn fitted(data: &[(DVec2, f64)], bends: Option<[f64; 3]>) -> Option<Quadric> {
    let mut found: Option<Quadric> = None;
    for _ in 0..=HUBER.1 {
        let (mut matrix, mut right) = ([[0.0; 6]; 6], [0.0; 6]);
        for (place, height) in data {
            let apart = found.map_or(0.0, |q| (height - q.at(*place)).abs());
            let weight = if apart > HUBER.0 { HUBER.0 / apart } else { 1.0 } / data.len() as f64;
            let DVec2 { x, y } = *place / UNIT_MM;
            let row = [1.0, x, y, x * x, x * y, y * y];
            for i in 0..6 {
                right[i] += weight * row[i] * height;
                for j in 0..6 {
                    matrix[i][j] += weight * row[i] * row[j];
                }
            }
        }
        for (k, bend) in bends.into_iter().flatten().enumerate() {
            matrix[3 + k][3 + k] += FIRM;
            right[3 + k] += FIRM * bend;
        }
        found = Some(Quadric { coefficients: solved(matrix, right)? });
    }
    found
}

/// A thin plate in tension on a foundation, on a grid of nodes.
struct Plate {
    counts: [usize; 2],
    /// Squared spacing \[ℓ²\].
    tension: f64,
}

impl Plate {
    /// Fills the open nodes.
    fn fill(&self, values: &mut [f64], is_open: &[bool]) {
        let [columns, rows] = self.counts;
        if self.tension < COARSEN.0 * COARSEN.0 && columns.min(rows) > COARSEN.1 {
            let counts = self.counts.map(|count| count / 2 + 1);
            let nodes = counts[0] * counts[1];
            // The last coarse node may stand beyond the grid: there it takes the edge's place.
            let fine = |k: usize| {
                let at = [2 * (k % counts[0]), 2 * (k / counts[0])];
                at[1].min(rows - 1) * columns + at[0].min(columns - 1)
            };
            let mut coarse: Vec<f64> = (0..nodes).map(|k| values[fine(k)]).collect();
            let open: Vec<bool> = (0..nodes).map(|k| is_open[fine(k)]).collect();
            Self { counts, tension: 4.0 * self.tension }.fill(&mut coarse, &open);
            for (k, value) in values.iter_mut().enumerate().filter(|(k, _)| is_open[*k]) {
                let at = [k % columns, k / columns];
                let four = [0, 1].map(|axis| [at[axis] / 2, at[axis].div_ceil(2)]);
                let sum = |j: usize| four[0].map(|i| coarse[j * counts[0] + i]).iter().sum::<f64>();
                *value = 0.25 * four[1].map(sum).iter().sum::<f64>();
            }
        }
        self.relax(values, is_open);
    }

    /// Conjugate gradients for the open nodes.
    fn relax(&self, values: &mut [f64], is_open: &[bool]) {
        let mut product = vec![0.0; values.len()];
        self.forces(values, is_open, &mut product);
        let mut residual: Vec<f64> = product.iter().map(|force| -force).collect();
        let mut way = residual.clone();
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut square = dot(&residual, &residual);
        let least = ITERATIONS.1 * ITERATIONS.1 * square;
        for _ in 0..ITERATIONS.0 {
            if square <= least {
                return;
            }
            self.forces(&way, is_open, &mut product);
            let step = square / dot(&way, &product);
            for k in 0..values.len() {
                values[k] += step * way[k];
                residual[k] -= step * product[k];
            }
            let next = dot(&residual, &residual);
            for (way, residual) in way.iter_mut().zip(&residual) {
                *way = residual + next / square * *way;
            }
            square = next;
        }
    }

    /// The energy's derivatives by the values of the open nodes, zero at the others.
    fn forces(&self, values: &[f64], is_open: &[bool], forces: &mut [f64]) {
        let [columns, rows] = self.counts;
        for (force, value) in forces.iter_mut().zip(values) {
            *force = self.tension * self.tension * value;
        }
        // Half the energy's derivative of a weighted square of a combination of values.
        let mut add = |nodes: &[usize], by: &[f64], weight: f64| {
            let sum: f64 = nodes.iter().zip(by).map(|(k, by)| by * values[*k]).sum();
            for (k, by) in nodes.iter().zip(by) {
                forces[*k] += weight * sum * by;
            }
        };
        for (j, i) in (0..rows).flat_map(|j| (0..columns).map(move |i| (j, i))) {
            let k = j * columns + i;
            for (at, count, step) in [(i, columns, 1), (j, rows, columns)] {
                if at + 1 < count {
                    add(&[k, k + step], &[-1.0, 1.0], 2.0 * self.tension);
                }
                if at + 2 < count {
                    add(&[k, k + step, k + 2 * step], &[1.0, -2.0, 1.0], 1.0);
                }
            }
            if i + 1 < columns && j + 1 < rows {
                let nodes = [k, k + 1, k + columns, k + columns + 1];
                add(&nodes, &[1.0, -1.0, -1.0, 1.0], 2.0);
            }
        }
        for (force, is_open) in forces.iter_mut().zip(is_open) {
            if !is_open {
                *force = 0.0;
            }
        }
    }
}

#[cfg(test)]
mod tests;

//! Numbers on a square grid of the plane of a frame, and the operations on them.

use glam::DVec2;

/// A square grid of nodes, centred on the frame's origin, row by row from −x, −y, x fastest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Nodes on each side of the centre.
    pub half: usize,
    /// Distance of neighbouring nodes \[mm\].
    pub spacing_mm: f64,
}

/// A step from 0 to 1 between 0 and 1, continuously differentiable.
#[inline]
#[must_use]
pub fn smooth_step(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

impl Grid {
    /// Nodes a side.
    #[must_use]
    pub fn side(&self) -> usize {
        2 * self.half + 1
    }

    /// Number of nodes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.side() * self.side()
    }

    /// Always false: a grid has a node.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Place of a node \[mm\].
    #[inline]
    #[must_use]
    pub fn place(&self, node: usize) -> DVec2 {
        let (side, half) = (self.side(), self.half as f64);
        DVec2::new((node % side) as f64 - half, (node / side) as f64 - half) * self.spacing_mm
    }

    /// Value at a place \[mm\], bilinear between the nodes; beyond the grid that of its edge.
    #[must_use]
    pub fn value(&self, values: &[f64], place: DVec2) -> f64 {
        let side = self.side();
        let most = (side - 1) as f64;
        let at = place / self.spacing_mm + DVec2::splat(self.half as f64);
        let at = at.clamp(DVec2::ZERO, DVec2::splat(most));
        let [column, row] = at.to_array().map(|at| (at as usize).min(side - 2));
        let (share, k) = (at - DVec2::new(column as f64, row as f64), row * side + column);
        let row = |k: usize| values[k] + (values[k + 1] - values[k]) * share.x;
        row(k) + (row(k + side) - row(k)) * share.y
    }

    /// Slope at a node by central differences, one-sided beside nodes without value \[-\].
    #[must_use]
    pub fn slope(&self, values: &[f64], node: usize) -> DVec2 {
        let side = self.side();
        let along = |at: usize, step: usize| {
            let before = (at > 0).then(|| values[node - step]).filter(|z| z.is_finite());
            let after = (at + 1 < side).then(|| values[node + step]).filter(|z| z.is_finite());
            let rise = match (before, after) {
                (Some(before), Some(after)) => 0.5 * (after - before),
                (Some(before), None) => values[node] - before,
                (None, Some(after)) => after - values[node],
                (None, None) => 0.0,
            };
            rise / self.spacing_mm
        };
        DVec2::new(along(node % side, 1), along(node / side, side))
    }

    /// The up to four neighbours of a node.
    pub(crate) fn neighbours(&self, node: usize) -> impl Iterator<Item = usize> + use<> {
        let side = self.side();
        let (i, j) = (node % side, node / side);
        let beside = [
            (i > 0).then(|| node - 1),
            (i + 1 < side).then(|| node + 1),
            (j > 0).then(|| node - side),
            (j + 1 < side).then(|| node + side),
        ];
        beside.into_iter().flatten()
    }

    /// Replaces the free values by the harmonic function of the others, without flux over the grid's edge. Values stay as given where no
    /// node is fixed.
    pub(crate) fn fill(&self, values: &mut [f64], is_free: &[bool]) {
        if self.spread(values, is_free) {
            let pull: Vec<Pull> =
                is_free.iter().map(|free| if *free { Pull::FREE } else { Pull::FIXED }).collect();
            self.settle(values, &pull);
        }
    }

    /// Solves value = (mean of the neighbours + weight·target)/(1 + weight) from the values on, without flux over the grid's edge
    /// (successive over-relaxation; after [`SWEEPS`] sweeps the error is below 1e-5 of the values' range for gaps of up to 30 nodes).
    pub(crate) fn settle(&self, values: &mut [f64], pull: &[Pull]) {
        let in_turn = self.in_turn(pull);
        for _ in 0..SWEEPS {
            for InTurn { node, beside, pull: Pull { share, target } } in &in_turn {
                let [left, right, below, above] = beside.map(|k| values[k as usize]);
                let settled = target + share * (0.25 * (left + right + below + above) - target);
                let value = &mut values[*node as usize];
                *value += RELAXATION * (settled - *value);
            }
        }
    }

    /// The free nodes in the order of a sweep: row after row, each row of a group a column behind the one before it. The values are those
    /// of a sweep along the rows, which wait less for each other.
    fn in_turn(&self, pull: &[Pull]) -> Vec<InTurn> {
        let side = self.side();
        let mut in_turn = Vec::with_capacity(pull.len());
        for first in (0..side).step_by(TOGETHER) {
            let rows = TOGETHER.min(side - first);
            for step in 0..side + rows - 1 {
                for behind in (step + 1).saturating_sub(side)..rows.min(step + 1) {
                    let (row, column) = (first + behind, step - behind);
                    let node = row * side + column;
                    if pull[node].share == 0.0 {
                        continue;
                    }
                    // At an edge the node itself stands for its neighbour beyond.
                    let beside = [
                        node - usize::from(column > 0),
                        node + usize::from(column + 1 < side),
                        if row > 0 { node - side } else { node },
                        if row + 1 < side { node + side } else { node },
                    ];
                    let beside = beside.map(|k| k as u32);
                    in_turn.push(InTurn { node: node as u32, beside, pull: pull[node] });
                }
            }
        }
        in_turn
    }

    /// Smooths values by a Gaussian mean of a standard deviation \[mm\]; beyond an edge the values go on, turned about it, so that planes stay.
    pub(crate) fn smooth(&self, values: &mut [f64], deviation_mm: f64) {
        let (side, deviation) = (self.side(), deviation_mm / self.spacing_mm);
        let reach = ((3.0 * deviation).ceil() as usize).min(side - 1);
        let weights: Vec<f64> =
            (0..=reach).map(|k| (-0.5 * (k as f64 / deviation).powi(2)).exp()).collect();
        let sum = 2.0 * weights.iter().sum::<f64>() - weights[0];
        let mut line = vec![0.0; side + 2 * reach];
        for (step, stride) in [(side, 1), (1, side)] {
            for first in (0..side).map(|k| k * step) {
                let (start, end) = (values[first], values[first + (side - 1) * stride]);
                for k in 0..side {
                    line[reach + k] = values[first + k * stride];
                }
                for k in 1..=reach {
                    line[reach - k] = 2.0 * start - line[reach + k];
                    line[reach + side - 1 + k] = 2.0 * end - line[reach + side - 1 - k];
                }
                for k in 0..side {
                    let pair = |j: usize| line[reach + k - j] + line[reach + k + j];
                    let around: f64 = (1..=reach).map(|j| weights[j] * pair(j)).sum();
                    values[first + k * stride] = (weights[0] * line[reach + k] + around) / sum;
                }
            }
        }
    }

    /// Gives each free node the value of a nearest fixed one; is there one?
    fn spread(&self, values: &mut [f64], is_free: &[bool]) -> bool {
        let mut is_set: Vec<bool> = is_free.iter().map(|free| !free).collect();
        let mut front: Vec<usize> = (0..values.len()).filter(|&node| is_set[node]).collect();
        let (is_any, mut next) = (!front.is_empty(), Vec::new());
        while !front.is_empty() {
            for &node in &front {
                for beside in self.neighbours(node) {
                    if !is_set[beside] {
                        is_set[beside] = true;
                        values[beside] = values[node];
                        next.push(beside);
                    }
                }
            }
            std::mem::swap(&mut front, &mut next);
            next.clear();
        }
        is_any
    }
}

/// What a value settles at: share·mean of the neighbours + (1 − share)·target; fixed for a share of zero.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pull {
    share: f64,
    target: f64,
}

impl Pull {
    /// The mean of the neighbours.
    pub(crate) const FREE: Self = Self { share: 1.0, target: 0.0 };
    /// The value as given.
    const FIXED: Self = Self { share: 0.0, target: 0.0 };

    /// Drawn to a target with a weight against the mean of the neighbours.
    pub(crate) fn to(target: f64, weight: f64) -> Self {
        Self { share: 1.0 / (1.0 + weight), target }
    }
}

/// A free node of a sweep with its neighbours left, right, below and above.
struct InTurn {
    node: u32,
    beside: [u32; 4],
    pull: Pull,
}

/// Rows of a sweep that are relaxed together.
const TOGETHER: usize = 8;
/// Sweeps of a harmonic fill.
const SWEEPS: usize = 100;
/// Over-relaxation of a harmonic fill: 2/(1 + sin(π/40)), the best for a gap of 40 nodes.
const RELAXATION: f64 = 1.85;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fill_is_harmonic_and_keeps_planes() {
        let grid = Grid { half: 20, spacing_mm: 4.0 };
        let plane = |at: DVec2| 3.0 + 0.2 * at.x - 0.1 * at.y;
        let exact: Vec<f64> = (0..grid.len()).map(|k| plane(grid.place(k))).collect();
        let is_free: Vec<bool> = (0..grid.len()).map(|k| grid.place(k).length() < 60.0).collect();
        let mut values = exact.clone();
        (0..grid.len()).filter(|&k| is_free[k]).for_each(|k| values[k] = f64::NAN);
        grid.fill(&mut values, &is_free);
        for (found, exact) in values.iter().zip(&exact) {
            assert!((found - exact).abs() < 1e-5, "{found} {exact}");
        }
        assert!((grid.value(&values, DVec2::new(3.0, -5.0)) - 4.1).abs() < 1e-5);
        assert!(grid.slope(&values, 3).distance(DVec2::new(0.2, -0.1)) < 1e-9);
    }
}

//! Level lines and level regions of values on a rectangular grid, by marching squares.
//!
//! Values are interpolated linearly along the grid's edges. Lines end at cells with a missing value (not a number).
//! Uses no other module of this crate. Used by `map` and by the charts of the lab.

use std::collections::BTreeMap;

/// Values on a grid.
#[derive(Clone, Copy, Debug)]
pub struct Field<'a> {
    /// Grid positions along x, rising.
    pub x: &'a [f64],
    /// Grid positions along y, rising.
    pub y: &'a [f64],
    /// Values, row by row: shape (y, x).
    pub values: &'a [f64],
}

/// A polyline in the plane.
pub type Path = Vec<(f64, f64)>;

/// An edge of a grid cell from a grid point to its right or upper neighbour.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Edge {
    from: (isize, isize),
    is_upward: bool,
}

impl Field<'_> {
    /// Level lines of the value `level`, none through cells with a missing value; values at or above `level` lie to the left of a line.
    pub fn lines(&self, level: f64) -> Vec<Path> {
        self.trace(level, 0)
    }

    /// Borders of the region at or above `level`: closed, counter-clockwise around the region, clockwise
    /// around holes, including the border of the grid.
    pub fn region(&self, level: f64) -> Vec<Path> {
        self.trace(level, 1)
    }

    /// Traces level lines; a `margin` of one surrounds the grid by points below every level.
    fn trace(&self, level: f64, margin: isize) -> Vec<Path> {
        let is_inside = |at: (isize, isize)| self.value(at).is_some_and(|value| value >= level);
        let mut next = BTreeMap::new();
        for j in -margin..self.y.len() as isize - 1 + margin {
            for i in -margin..self.x.len() as isize - 1 + margin {
                let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                if corners.iter().any(|at| self.value(*at).is_some_and(f64::is_nan)) {
                    continue;
                }
                // Counter-clockwise around the cell: a line starts at an edge that leaves the region
                // and ends at the next edge that enters the region.
                let crossing = |k: usize| {
                    let (a, b) = (corners[k % 4], corners[(k + 1) % 4]);
                    let edge = Edge { from: a.min(b), is_upward: a.0 == b.0 };
                    (edge, is_inside(a), is_inside(b))
                };
                for k in 0..4 {
                    if let (start, true, false) = crossing(k)
                        && let Some((end, ..)) =
                            (k + 1..k + 4).map(crossing).find(|(_, a, b)| !a && *b)
                    {
                        next.insert(start, end);
                    }
                }
            }
        }
        // Open lines from their first edge, then closed lines.
        let ends: Vec<Edge> = next.values().copied().collect();
        let firsts = next.keys().copied().filter(|edge| !ends.contains(edge)).collect::<Vec<_>>();
        let mut paths = Vec::new();
        let mut follow = |first: Edge, next: &mut BTreeMap<Edge, Edge>| {
            let (mut path, mut edge) = (vec![self.point(first, level)], first);
            while let Some(after) = next.remove(&edge) {
                path.push(self.point(after, level));
                edge = after;
            }
            paths.push(without_straight_points(path));
        };
        for first in firsts {
            follow(first, &mut next);
        }
        while let Some(first) = next.keys().next().copied() {
            follow(first, &mut next);
        }
        paths
    }

    /// Value at a grid point; `None` outside of the grid.
    fn value(&self, (i, j): (isize, isize)) -> Option<f64> {
        let [i, j] = [usize::try_from(i).ok()?, usize::try_from(j).ok()?];
        (i < self.x.len() && j < self.y.len()).then(|| self.values[j * self.x.len() + i])
    }

    /// Point of an edge with the value `level`; the border point on an edge that leaves the grid.
    fn point(&self, edge: Edge, level: f64) -> (f64, f64) {
        let position = |(i, j): (isize, isize)| {
            let within = |k: isize, n: usize| k.clamp(0, n as isize - 1) as usize;
            (self.x[within(i, self.x.len())], self.y[within(j, self.y.len())])
        };
        let (i, j) = edge.from;
        let to = if edge.is_upward { (i, j + 1) } else { (i + 1, j) };
        let (a, b) = (position(edge.from), position(to));
        match (self.value(edge.from), self.value(to)) {
            (Some(from), Some(to)) => {
                let t = (level - from) / (to - from);
                (a.0 + t * (b.0 - a.0), a.1 + t * (b.1 - a.1))
            }
            _ => a,
        }
    }
}

/// Removes points on the straight line between their neighbours and duplicate points.
fn without_straight_points(path: Path) -> Path {
    const ROUNDING: f64 = 1e-9;
    let step = |a: (f64, f64), b: (f64, f64)| (b.0 - a.0, b.1 - a.1);
    let mut kept: Path = Vec::new();
    for point in path {
        while let [.., a, b] = kept[..] {
            let (along, beyond) = (step(a, b), step(b, point));
            let turn = along.0 * beyond.1 - along.1 * beyond.0;
            let sizes = [along, beyond].map(|step| step.0.hypot(step.1));
            if sizes[1] > ROUNDING && turn.abs() > ROUNDING * sizes[0] * sizes[1] {
                break;
            }
            kept.pop();
        }
        kept.push(point);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    const N: usize = 81;

    fn grid() -> Vec<f64> {
        (0..N).map(|k| k as f64 / (N - 1) as f64).collect()
    }

    fn sampled(f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let grid = grid();
        grid.iter().flat_map(|&y| grid.iter().map(move |&x| (x, y))).map(|(x, y)| f(x, y)).collect()
    }

    /// Positive counter-clockwise.
    fn area(path: &Path) -> f64 {
        let sum: f64 = path.windows(2).map(|p| p[0].0 * p[1].1 - p[0].1 * p[1].0).sum();
        0.5 * sum
    }

    #[test]
    fn a_ring_has_an_outer_border_and_a_hole() {
        // Between the circles of radius 0.2 and 0.4.
        let (x, values) = (grid(), sampled(|x, y| 0.01 - ((x - 0.5).hypot(y - 0.5) - 0.3).powi(2)));
        let field = Field { x: &x, y: &x, values: &values };
        for paths in [field.lines(0.0), field.region(0.0)] {
            assert_eq!(paths.len(), 2);
            assert!(paths.iter().all(|path| path[0] == path[path.len() - 1]));
            let mut areas: Vec<f64> = paths.iter().map(area).collect();
            areas.sort_by(f64::total_cmp);
            let pi = std::f64::consts::PI;
            assert!((areas[0] + 0.04 * pi).abs() < 1e-3, "the hole, clockwise: {areas:?}");
            assert!((areas[1] - 0.16 * pi).abs() < 1e-3, "the outer border: {areas:?}");
        }
    }

    #[test]
    fn a_line_ends_at_a_cell_with_a_missing_value() {
        let (x, mut values) = (grid(), sampled(|x, _| x - 0.503));
        values[40 * N + 40] = f64::NAN;
        let lines = Field { x: &x, y: &x, values: &values }.lines(0.0);
        let mut ends: Vec<f64> = lines.iter().flatten().map(|point| point.1).collect();
        ends.sort_by(f64::total_cmp);
        assert_eq!(ends, [0.0, x[39], x[41], 1.0]);
        assert!(lines.iter().flatten().all(|point| (point.0 - 0.503).abs() < 1e-12));
    }

    #[test]
    fn a_region_ends_at_the_border_of_the_grid_and_a_line_does_not_follow_it() {
        let (x, values) = (grid(), sampled(|x, y| x - 0.25 - 0.5 * y));
        let field = Field { x: &x, y: &x, values: &values };
        let lines = field.lines(0.0);
        // The straight line keeps two points, with the region to the left.
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].len(), 2, "{lines:?}");
        assert!((lines[0][0].0 - 0.75).abs() < 1e-12 && lines[0][0].1 > lines[0][1].1);
        let region = field.region(0.0);
        assert_eq!(region.len(), 1);
        assert!((area(&region[0]) - 0.5).abs() < 1e-12 && region[0].len() <= 6, "{region:?}");
        assert!((area(&field.region(-9.0)[0]) - 1.0).abs() < 1e-12);
        assert!(field.region(9.0).is_empty() && field.lines(9.0).is_empty());
    }
}

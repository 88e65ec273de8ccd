//! Skin and wall over the whole patch, from the height field of the scan and the bare chest.

use crate::chest::Quadric;
use crate::grid::Grid;
use glam::DVec2;
use implant_preview_solver::mesh::{Chest, HeightGrid};
use std::f64::consts::SQRT_2;

/// Greatest slope of the wall \[-\].
const MOST_SLOPE: f64 = 1.7;
/// Greatest ratio of thicknesses along z and along the normal \[-\].
const MOST_STEEPNESS: f64 = 2.0;
/// Least radius of a hollow at the nodes \[thicknesses of the tissue\], of which a scene needs 1.25 by the wall's curvature between the nodes, too: with 3.5, 5 of 300 random bodies have less than 2.
const HOLLOW: f64 = 6.0;
/// Greatest number of sweeps that fill hollows, and the rise that ends them \[mm\].
const HOLLOW_SWEEPS: usize = 200;
const HOLLOW_MM: f64 = 1e-4;
/// Passes to and fro over the grid that limit the slope.
const SLOPE_PASSES: usize = 2;
/// Standard deviation of the mean that smooths the wall's distance from the quadric \[mm\].
const SMOOTH_MM: f64 = 8.0;
/// Least thickness beside a greater one \[-\].
const CLIFF: f64 = 0.3;
/// Step along a normal on the search for the skin \[mm\].
const STEP_MM: f64 = 3.0;
/// End of this search \[mm\].
const MOST_MM: f64 = 250.0;
/// Halvings of a step: to 1e-10 mm.
const BISECTIONS: usize = 35;
/// Greatest extent of a hole that is filled \[mm\].
const HOLE_MM: f64 = 40.0;

/// Fills the holes of a height field that are up to 40 mm across by harmonic functions; their number.
pub(crate) fn fill_holes(grid: Grid, heights: &mut [f64]) -> usize {
    let side = grid.side();
    let most = (HOLE_MM / grid.spacing_mm).floor() as usize;
    let mut is_seen: Vec<bool> = heights.iter().map(|height| height.is_finite()).collect();
    let mut is_hole = vec![false; grid.len()];
    let (mut holes, mut nodes) = (0, Vec::new());
    for start in 0..grid.len() {
        if is_seen[start] {
            continue;
        }
        nodes.clear();
        nodes.push(start);
        is_seen[start] = true;
        let (mut low, mut high, mut at) = ([side, side], [0, 0], 0);
        while at < nodes.len() {
            let place = [nodes[at] % side, nodes[at] / side];
            low = [0, 1].map(|axis| low[axis].min(place[axis]));
            high = [0, 1].map(|axis| high[axis].max(place[axis]));
            for beside in grid.neighbours(nodes[at]) {
                if !is_seen[beside] {
                    is_seen[beside] = true;
                    nodes.push(beside);
                }
            }
            at += 1;
        }
        let is_inside = low.iter().all(|k| *k > 0) && high.iter().all(|k| *k < side - 1);
        if is_inside && (0..2).all(|axis| high[axis] - low[axis] < most) {
            holes += 1;
            nodes.iter().for_each(|node| is_hole[*node] = true);
        }
    }
    if holes > 0 {
        grid.fill(heights, &is_hole);
    }
    holes
}

/// Skin and wall \[mm\] over the whole grid.
///
/// The wall lies a cover below the bare chest and at least a least thickness, or a thinner cover, below the skin; it falls by 60° at most, goes on so where the scan ends,
/// and its distance from the quadric is smoothed by a Gaussian mean of 8 mm; hollows below 6 times the tissue are filled. The skin is raised to this least thickness above the wall where
/// it is steeper, and its distance from the wall is harmonic where the scan ends.
pub(crate) fn skin_and_wall(
    grid: Grid,
    heights: &[f64],
    bare: &[f64],
    quadric: &Quadric,
    [cover_mm, least_mm]: [f64; 2],
) -> (Vec<f64>, Vec<f64>) {
    let steepness = |slope: DVec2| (1.0 + slope.length_squared()).sqrt().min(MOST_STEEPNESS);
    let least_mm = least_mm.min(cover_mm);
    let mut wall: Vec<f64> = (0..grid.len())
        .map(|node| {
            if heights[node].is_nan() {
                return f64::NEG_INFINITY;
            }
            let skin = heights[node] - least_mm * steepness(grid.slope(heights, node));
            skin.min(bare[node] - cover_mm)
        })
        .collect();
    limit_slope(grid, &mut wall);
    let deep = |node: usize| quadric.at(grid.place(node)) - cover_mm;
    for (node, height) in wall.iter_mut().enumerate() {
        *height = height.min(bare[node] - cover_mm) - deep(node);
    }
    grid.smooth(&mut wall, SMOOTH_MM);
    for (node, height) in wall.iter_mut().enumerate() {
        *height += deep(node);
    }
    let tissue: Vec<f64> = (0..grid.len())
        .map(|node| {
            let depth = heights[node] - wall[node];
            let depth = if depth.is_nan() { cover_mm } else { depth };
            (depth / steepness(grid.slope(&wall, node))).max(least_mm)
        })
        .collect();
    fill_hollows(grid, &mut wall, &tissue);
    // Thickness along z, with a least one along the normal; harmonic where the scan has none.
    let is_open: Vec<bool> = heights.iter().map(|height| height.is_nan()).collect();
    let mut depth: Vec<f64> = (0..grid.len())
        .map(|node| {
            let least = least_mm * steepness(grid.slope(&wall, node));
            (heights[node] - wall[node]).max(least)
        })
        .collect();
    grid.fill(&mut depth, &is_open);
    let skin = depth.iter().zip(&wall).map(|(depth, wall)| wall + depth);
    (skin.collect(), wall)
}

/// Raises heights until every hollow has a radius of 6 times the tissue there \[mm\], along the grid and its diagonals.
fn fill_hollows(grid: Grid, heights: &mut [f64], tissue: &[f64]) {
    let side = grid.side();
    // Rows that were raised when they were swept last: a row between others that were not stays.
    let mut is_raised = vec![true; side];
    for _ in 0..HOLLOW_SWEEPS {
        for row in 1..side - 1 {
            if !(is_raised[row - 1] || is_raised[row] || is_raised[row + 1]) {
                continue;
            }
            is_raised[row] = false;
            for node in row * side + 1..row * side + side - 1 {
                let most_sag = 0.5 * grid.spacing_mm.powi(2) / (HOLLOW * tissue[node]);
                // Squared length of a step \[spacings²\].
                let ways = [(1, 1.0), (side, 1.0), (side + 1, 2.0), (side - 1, 2.0)];
                let least = ways.into_iter().map(|(step, squared)| {
                    0.5 * (heights[node - step] + heights[node + step]) - squared * most_sag
                });
                let least = least.fold(f64::NEG_INFINITY, f64::max);
                if least > heights[node] + HOLLOW_MM {
                    heights[node] = least;
                    is_raised[row] = true;
                }
            }
        }
        is_raised[0] = false;
        is_raised[side - 1] = false;
        if !is_raised.contains(&true) {
            return;
        }
    }
}

/// Raises heights until none falls by more than 60° from a neighbour to the next.
fn limit_slope(grid: Grid, heights: &mut [f64]) {
    let (side, fall) = (grid.side(), MOST_SLOPE * grid.spacing_mm);
    let mut raise = |node: usize, way: [isize; 2], by: f64| {
        let [x, y] = [node % side, node / side].map(|k| k as isize);
        let (x, y, most) = (x + way[0], y + way[1], side as isize);
        if (0..most).contains(&x) && (0..most).contains(&y) {
            heights[node] = heights[node].max(heights[(y * most + x) as usize] - by);
        }
    };
    for _ in 0..SLOPE_PASSES {
        for (order, sign) in [(false, -1), (true, 1)] {
            for k in 0..side * side {
                let node = if order { side * side - 1 - k } else { k };
                for (way, length) in
                    [([1, 0], 1.0), ([0, 1], 1.0), ([1, 1], SQRT_2), ([-1, 1], SQRT_2)]
                {
                    raise(node, way.map(|step| step * sign), length * fall);
                }
            }
        }
    }
}

/// Thickness of the tissue along the wall's normals at lengths along the wall \[mm\], on the grid of the heights.
pub(crate) fn thickness(grid: Grid, skin: &[f64], wall: &[f64]) -> Option<Vec<f64>> {
    let heights = HeightGrid::new(grid.spacing_mm, [grid.side(); 2], wall.to_vec())?;
    // The wall counts from its tangent plane at the centre.
    let tilt = DVec2::from(heights.tilt());
    let chest = Chest::Grid(heights);
    let feet = chest.feet(grid.place(0).length());
    let of = |node: usize| {
        let (foot, normal) = feet(grid.place(node));
        let above = |length: f64| {
            let point = foot + normal * length;
            let at = point.truncate();
            point.z + tilt.dot(at) - grid.value(skin, at)
        };
        let (mut low, mut high) = (0.0, STEP_MM);
        while above(high) < 0.0 && high < MOST_MM {
            (low, high) = (high, high + STEP_MM);
        }
        for _ in 0..BISECTIONS {
            let middle = 0.5 * (low + high);
            if above(middle) < 0.0 { low = middle } else { high = middle }
        }
        0.5 * (low + high)
    };
    let found: Vec<f64> = (0..grid.len()).map(of).collect();
    // Beside a cliff a spline through the thickness falls below its lower side by a tenth of the cliff.
    let least = |node: usize| {
        let beside = grid.neighbours(node).map(|beside| found[beside]);
        found[node].max(CLIFF * beside.fold(0.0, f64::max))
    };
    Some((0..grid.len()).map(least).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Grid = Grid { half: 34, spacing_mm: 4.0 };

    #[test]
    fn flat_skin_over_a_flat_wall_has_the_cover_everywhere() {
        let quadric = Quadric { coefficients: [10.0, 0.0, 0.0, 0.0, 0.0, 0.0] };
        let heights = vec![10.0; GRID.len()];
        let (skin, wall) = skin_and_wall(GRID, &heights, &heights, &quadric, [10.0, 6.0]);
        let thickness = thickness(GRID, &skin, &wall).unwrap();
        for node in 0..GRID.len() {
            assert!(wall[node].abs() < 1e-12 && (skin[node] - 10.0).abs() < 1e-12);
            assert!((thickness[node] - 10.0).abs() < 1e-9, "{}", thickness[node]);
        }
    }

    #[test]
    fn the_wall_falls_by_60_degrees_at_most_and_goes_on_where_the_scan_ends() {
        // Flat skin that falls by 79° beyond 70 mm and ends at 90 mm.
        let height = |x: f64| if x > 90.0 { f64::NAN } else { -5.0 * (x - 70.0).max(0.0) };
        let heights: Vec<f64> = (0..GRID.len()).map(|node| height(GRID.place(node).x)).collect();
        let bare = vec![0.0; GRID.len()];
        let (skin, wall) = skin_and_wall(GRID, &heights, &bare, &Quadric::default(), [10.0, 6.0]);
        let mut steepest: f64 = 0.0;
        for node in 0..GRID.len() {
            let (x, slope) = (GRID.place(node).x, GRID.slope(&wall, node));
            steepest = steepest.max(slope.length());
            assert!(skin[node] - wall[node] > 6.0 - 1e-9);
            if x < 40.0 {
                assert!(
                    (wall[node] + 10.0).abs() < 1e-9 && (heights[node] - skin[node]).abs() < 1e-9
                );
            } else if x > 90.0 {
                assert!((slope.x + MOST_SLOPE).abs() < 0.02, "{x}: {slope}");
            }
        }
        assert!(steepest < MOST_SLOPE + 0.01, "{steepest}");
    }

    #[test]
    fn a_hollow_is_filled_until_it_carries_the_tissue() {
        let groove = |x: f64| -25.0 * (-(x / 9.0).powi(2)).exp();
        let mut heights: Vec<f64> =
            (0..GRID.len()).map(|node| groove(GRID.place(node).x)).collect();
        let before = heights.clone();
        fill_hollows(GRID, &mut heights, &vec![12.0; GRID.len()]);
        let (side, middle) = (GRID.side(), GRID.len() / 2);
        for node in middle - side / 2 + 1..middle + side / 2 {
            let sag = heights[node - 1] + heights[node + 1] - 2.0 * heights[node];
            assert!(sag / 16.0 < 1.0 / 42.0 + 1e-4, "{sag}");
            assert!(heights[node] >= before[node]);
        }
        assert!(heights[middle] > -20.0 && heights[middle + 20] > -1e-3);
    }

    #[test]
    fn a_small_hole_is_filled_and_a_large_one_stays() {
        let mut heights: Vec<f64> = (0..GRID.len()).map(|node| 0.1 * GRID.place(node).x).collect();
        let exact = heights.clone();
        for node in 0..GRID.len() {
            let place = GRID.place(node);
            let is_hole = place.distance(DVec2::new(30.0, 30.0)) < 18.0;
            if is_hole || place.distance(DVec2::new(-40.0, -40.0)) < 24.0 || place.x > 110.0 {
                heights[node] = f64::NAN;
            }
        }
        let before = heights.iter().filter(|height| height.is_nan()).count();
        assert_eq!(fill_holes(GRID, &mut heights), 1);
        let after = heights.iter().filter(|height| height.is_nan()).count();
        assert!(after < before && after > 100);
        let filled = heights.iter().zip(&exact).filter(|(height, _)| height.is_finite());
        assert!(filled.clone().all(|(height, exact)| (height - exact).abs() < 1e-4));
    }
}

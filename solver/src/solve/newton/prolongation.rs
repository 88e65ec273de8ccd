//! Prolongation of a solution to the next finer grid.
//!
//! Displacements divided by 1 − (r/a)², which is zero on the border, are interpolated and multiplied by the same
//! factor on the fine grid: plain interpolation would carry the coarse border's polygon into the fine grid.

use crate::mesh::{NodeKind, Rest, Sheet};
use glam::DVec3;

/// Fills the free nodes of `x` on the grid `fine` from the positions `coarse_x` on the grid `coarse` \[mm\], shapes
/// (nodes_per_side², ), of a layer of nodes. The fine grid has twice the cells a side. `scaled` is scratch.
pub(super) fn prolongate(
    (coarse, coarse_x): (&Rest, &[DVec3]),
    (fine, x): (&Rest, &mut [DVec3]),
    layer: usize,
    scaled: &mut Vec<DVec3>,
) {
    scale_displacements(coarse, coarse_x, layer, scaled);
    extend(coarse.sheet(), scaled);
    let sheet = fine.sheet();
    let (n, nc) = (sheet.nodes_per_side(), coarse.sheet().nodes_per_side());
    for k in 0..sheet.len() {
        if sheet.kinds()[k] != NodeKind::Free {
            continue;
        }
        let (i, j) = (k % n, k / n);
        let (low, right, up) = (j / 2 * nc + i / 2, i % 2, (j % 2) * nc);
        let mean = 0.25
            * (scaled[low] + scaled[low + right] + scaled[low + up] + scaled[low + up + right]);
        x[k] = fine.node(layer, k) + mean * rim_distance(sheet, k);
    }
}

fn rim_distance(sheet: &Sheet, k: usize) -> f64 {
    1.0 - sheet.rest()[k].length_squared() / sheet.radius_mm().powi(2)
}

/// Scaled displacements of the free nodes, zero elsewhere.
fn scale_displacements(rest: &Rest, x: &[DVec3], layer: usize, scaled: &mut Vec<DVec3>) {
    let sheet = rest.sheet();
    scaled.clear();
    scaled.extend((0..sheet.len()).map(|k| match sheet.kinds()[k] {
        NodeKind::Free => (x[k] - rest.node(layer, k)) / rim_distance(sheet, k),
        _ => DVec3::ZERO,
    }));
}

/// Sets the values of the nodes that are not free: linear extrapolation from two free nodes in a row, else the mean of
/// adjacent free nodes.
fn extend(sheet: &Sheet, values: &mut [DVec3]) {
    let n = sheet.nodes_per_side() as isize;
    for k in 0..n * n {
        if sheet.kinds()[k as usize] == NodeKind::Free {
            continue;
        }
        let at = |i: isize, j: isize| {
            let at = (j * n + i) as usize;
            let is_inside = (0..n).contains(&i) && (0..n).contains(&j);
            (is_inside && sheet.kinds()[at] == NodeKind::Free).then(|| values[at])
        };
        let (i, j) = (k % n, k / n);
        let (mut lines, mut means) = ((DVec3::ZERO, 0.0), (DVec3::ZERO, 0.0));
        for (di, dj) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)] {
            if let Some(one) = at(i + di, j + dj) {
                means = (means.0 + one, means.1 + 1.0);
                if let Some(two) = at(i + 2 * di, j + 2 * dj) {
                    lines = (lines.0 + one * 2.0 - two, lines.1 + 1.0);
                }
            }
        }
        let (sum, count) = if lines.1 > 0.0 { lines } else { means };
        if count > 0.0 {
            values[k as usize] = sum / count;
        }
    }
}

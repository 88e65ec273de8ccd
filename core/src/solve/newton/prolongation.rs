//! Prolongation of a solution to the next finer grid.
//!
//! Displacements divided by 1 − (r/a)², which is zero on the border, are interpolated and multiplied by the same
//! factor on the fine grid: plain interpolation would carry the coarse border's polygon into the fine grid.

use crate::mesh::{NodeKind, Sheet};
use glam::DVec3;

/// Fills the free nodes of `x` on the sheet `fine` from the positions `coarse_x` on the sheet `coarse`
/// \[mm\], shapes (nodes_per_side², ). The fine grid has twice the cells a side.
pub(in crate::solve) fn prolongate(
    coarse: &Sheet,
    coarse_x: &[DVec3],
    fine: &Sheet,
    x: &mut [DVec3],
) {
    let scaled = extended(coarse, &scaled_displacements(coarse, coarse_x));
    let (n, nc) = (fine.nodes_per_side(), coarse.nodes_per_side());
    for k in 0..fine.len() {
        if fine.kinds()[k] != NodeKind::Free {
            continue;
        }
        let (i, j) = (k % n, k / n);
        let (low, right, up) = (j / 2 * nc + i / 2, i % 2, (j % 2) * nc);
        let mean = 0.25
            * (scaled[low] + scaled[low + right] + scaled[low + up] + scaled[low + up + right]);
        x[k] = fine.rest_position(k) + mean * rim_distance(fine, k);
    }
}

fn rim_distance(sheet: &Sheet, k: usize) -> f64 {
    1.0 - sheet.rest()[k].length_squared() / sheet.radius_mm().powi(2)
}

fn scaled_displacements(sheet: &Sheet, x: &[DVec3]) -> Vec<Option<DVec3>> {
    (0..sheet.len())
        .map(|k| {
            (sheet.kinds()[k] == NodeKind::Free)
                .then(|| (x[k] - sheet.rest_position(k)) / rim_distance(sheet, k))
        })
        .collect()
}

/// Values at the nodes that are not free: linear extrapolation from two free nodes in a row, else the mean of
/// adjacent free nodes.
fn extended(sheet: &Sheet, values: &[Option<DVec3>]) -> Vec<DVec3> {
    let n = sheet.nodes_per_side() as isize;
    let at = |i: isize, j: isize| {
        ((0..n).contains(&i) && (0..n).contains(&j)).then(|| values[(j * n + i) as usize]).flatten()
    };
    (0..n * n)
        .map(|k| {
            let (i, j) = (k % n, k / n);
            if let Some(value) = values[k as usize] {
                return value;
            }
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
            if count > 0.0 { sum / count } else { DVec3::ZERO }
        })
        .collect()
}

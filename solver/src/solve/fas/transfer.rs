//! Transfer between grids: restriction of residuals, displacements and active sets, prolongation of corrections
//! and solutions. All layers of nodes have the same transfer.

use crate::mesh::lanes::{Extrapolated, Field, Layout};

/// Offset of the fine grid's row at row j of the coarse grid: coarse column i has the fine index `offset + 2i`. The
/// first row contains no free nodes.
#[inline(always)]
fn fine_row(coarse: &Layout, fine: &Layout, j: usize) -> usize {
    let [ghost_column, ghost_row] = coarse.ghost();
    (2 * j - ghost_row) * fine.pitch - ghost_column
}

/// The values around a fine node, weighted by bilinear interpolation from that node; the weights sum to four.
#[inline(always)]
fn weighted_sum(values: &[f32], node: usize, pitch: usize) -> f32 {
    let (below, above) = (node - pitch, node + pitch);
    let edges = values[node - 1] + values[node + 1] + values[below] + values[above];
    let corners = values[below - 1] + values[below + 1] + values[above - 1] + values[above + 1];
    values[node] + 0.5 * edges + 0.25 * corners
}

/// Restricts a residual by the transpose of bilinear interpolation; the residual is zero at nodes that are not free.
/// The factor ½ converts to spacings of the coarse grid.
pub(super) fn restrict(coarse: &Layout, fine: &Layout, from: &Field, to: &mut Field) {
    for (from, to) in from.planes().zip(to.planes_mut()) {
        coarse.free_rows(|j, first, last| {
            let row = fine_row(coarse, fine, j);
            for i in first..last {
                to[j * coarse.pitch + i] = 0.5 * weighted_sum(from, row + 2 * i, fine.pitch);
            }
        });
    }
}

/// Injects the displacements of the fine grid into the nodes of the coarse grid.
pub(super) fn inject(coarse: &Layout, fine: &Layout, from: &Field, to: &mut Field) {
    for (from, to) in from.planes().zip(to.planes_mut()) {
        coarse.free_rows(|j, first, last| {
            let row = fine_row(coarse, fine, j);
            for i in first..last {
                to[j * coarse.pitch + i] = 0.5 * from[row + 2 * i];
            }
        });
    }
}

/// Greatest distance between the fine grid's displacements and those of the coarse grid's own solution at a node of both, on the
/// outermost layer of nodes \[spacings of the coarse grid\].
pub(super) fn greatest_distance(coarse: &Layout, fine: &Layout, u: &Field, own: &Field) -> f32 {
    let outermost = |field: &Field| field.layers().last().unwrap_or(0);
    let (of_fine, of_coarse) = (outermost(u), outermost(own));
    let mut greatest = 0.0_f32;
    coarse.free_rows(|j, first, last| {
        let row = of_fine + fine_row(coarse, fine, j);
        for i in first..last {
            let (u, own) = (u.at(row + 2 * i), own.at(of_coarse + j * coarse.pitch + i));
            let square = [0, 1, 2].map(|k: usize| (0.5 * u[k] - own[k]).powi(2));
            greatest = greatest.max(square[0] + square[1] + square[2]);
        }
    });
    greatest.sqrt()
}

/// Restricts the active set: a coarse node is active if the weighted fraction of active fine nodes exceeds
/// `least_weight`.
pub(super) fn restrict_active_set(
    coarse: &Layout,
    fine: &Layout,
    from: &[f32],
    least_weight: f32,
    to: &mut [f32],
) {
    coarse.free_rows(|j, first, last| {
        let row = fine_row(coarse, fine, j);
        for i in first..last {
            let weight = 0.25 * weighted_sum(from, row + 2 * i, fine.pitch);
            to[j * coarse.pitch + i] = f32::from(u8::from(weight > least_weight));
        }
    });
}

/// Prolongates the correction `now` − `before` bilinearly, in spacings of the fine grid.
pub(super) fn correction(
    coarse: &Layout,
    fine: &Layout,
    now: &Field,
    before: &Field,
    to: &mut Field,
    row: &mut [f32],
) {
    let [ghost, ghost_row] = fine.ghost();
    for ((now, before), to) in now.planes().zip(before.planes()).zip(to.planes_mut()) {
        fine.free_rows(|j, first, last| {
            let low = (j + ghost_row) / 2 * coarse.pitch;
            let is_between = !(j + ghost_row).is_multiple_of(2);
            for i in (first + ghost) / 2..(last + ghost) / 2 + 1 {
                let k = low + i;
                let mut c = 2.0 * (now[k] - before[k]);
                if is_between {
                    let k = k + coarse.pitch;
                    c = 0.5 * c + (now[k] - before[k]);
                }
                row[i] = c;
            }
            let out = &mut to[j * fine.pitch..];
            for i in first..last {
                let k = (i + ghost) / 2;
                out[i] = if (i + ghost).is_multiple_of(2) {
                    row[k]
                } else {
                    0.5 * (row[k] + row[k + 1])
                };
            }
        });
    }
}

/// Prolongates a solution: displacements divided by 1 − (r/a)², which is zero on the border, are interpolated
/// cubically and multiplied by the same factor on the fine grid. Plain interpolation would carry the coarse border's
/// polygon into the fine grid. `scaled` is scratch of the coarse grid.
pub(super) fn prolongate_solution(
    coarse: &Layout,
    fine: &Layout,
    from: &Field,
    scaled: &mut Field,
    to: &mut Field,
    row: &mut [f32],
) {
    let per_area = 1.0 / (coarse.radius() * coarse.radius());
    for (from, scaled) in from.planes().zip(scaled.planes_mut()) {
        coarse.free_rows(|j, first, last| {
            for i in first..last {
                let [x, y] = coarse.rest(i, j);
                let scale = 2.0 / (1.0 - (x * x + y * y) * per_area);
                let k = j * coarse.pitch + i;
                scaled[k] = from[k] * scale;
            }
        });
    }
    // Ghosts are sources of the extrapolation beyond the border, whose values have ghosts in turn.
    coarse.mirror(scaled);
    for plane in scaled.planes_mut() {
        extrapolate(coarse, plane);
    }
    coarse.mirror(scaled);
    let per_area = 1.0 / (fine.radius() * fine.radius());
    let [ghost, ghost_row] = fine.ghost();
    for (scaled, to) in scaled.planes().zip(to.planes_mut()) {
        let at = |row: usize, i: usize| scaled[row * coarse.pitch + i];
        fine.free_rows(|j, first, last| {
            let low = (j + ghost_row) / 2;
            let is_between = !(j + ghost_row).is_multiple_of(2);
            let from = ((first + ghost) / 2).saturating_sub(1);
            for i in from..((last + ghost) / 2 + 2).min(coarse.columns) {
                row[i] = if is_between {
                    between(low, coarse.rows, |row| at(row, i))
                } else {
                    at(low, i)
                };
            }
            let out = &mut to[j * fine.pitch..];
            for i in first..last {
                let k = (i + ghost) / 2;
                let value = if (i + ghost).is_multiple_of(2) {
                    row[k]
                } else {
                    between(k, coarse.columns, |k| row[k])
                };
                let [x, y] = fine.rest(i, j);
                out[i] = value * (1.0 - (x * x + y * y) * per_area);
            }
        });
    }
}

/// Extrapolates values from free nodes to adjacent nodes that are not free.
fn extrapolate(layout: &Layout, values: &mut [f32]) {
    let mut next = 0;
    for &Extrapolated { node, count, is_mean } in &layout.extrapolated {
        let sources = &layout.sources[next..next + count as usize];
        next += count as usize;
        let at = |k: u32| values[k as usize];
        values[node as usize] = if is_mean {
            sources.iter().map(|&k| at(k)).sum::<f32>() / count as f32
        } else {
            let lines = sources.as_chunks::<2>().0;
            let sum: f32 = lines.iter().map(|&[near, far]| 2.0 * at(near) - at(far)).sum();
            sum / lines.len() as f32
        };
    }
}

/// Cubic interpolation midway between `low` and the next value; at the ends a parabola through three values.
#[inline(always)]
fn between(low: usize, count: usize, at: impl Fn(usize) -> f32) -> f32 {
    let middle = at(low) + at(low + 1);
    if low == 0 {
        0.375 * at(0) + 0.75 * at(1) - 0.125 * at(2)
    } else if low + 2 >= count {
        0.375 * at(low + 1) + 0.75 * at(low) - 0.125 * at(low - 1)
    } else {
        0.5625 * middle - 0.0625 * (at(low - 1) + at(low + 2))
    }
}

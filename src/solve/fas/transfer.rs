//! From grid to grid: residuals down, corrections up, shapes up.

use super::grid::{Extrapolated, Field, Layout};

/// What the finer grid's stored node at the place of a coarse one in row j is beyond twice its column;
/// free nodes lie in no first row.
#[inline(always)]
fn fine_row(coarse: &Layout, fine: &Layout, j: usize) -> usize {
    let [ghost_column, ghost_row] = coarse.ghost();
    (2 * j - ghost_row) * fine.pitch - ghost_column
}

/// The transpose of bilinear interpolation, from a residual that is zero at nodes that are not free.
/// A force in spacings of the coarse grid has half the number.
pub(super) fn restrict(coarse: &Layout, fine: &Layout, from: &Field, to: &mut Field) {
    let pitch = fine.pitch;
    coarse.free_rows(|j, first, last| {
        let row = fine_row(coarse, fine, j);
        let weigh = |from: &[f32], to: &mut [f32]| {
            for i in first..last {
                let f = row + 2 * i;
                let (below, above) = (f - pitch, f + pitch);
                let edges = from[f - 1] + from[f + 1] + from[below] + from[above];
                let corners = from[below - 1] + from[below + 1] + from[above - 1] + from[above + 1];
                to[j * coarse.pitch + i] = 0.5 * from[f] + 0.25 * edges + 0.125 * corners;
            }
        };
        weigh(&from.x, &mut to.x);
        weigh(&from.y, &mut to.y);
        weigh(&from.z, &mut to.z);
    });
}

/// Coarse displacements at the places that both grids have.
pub(super) fn inject(coarse: &Layout, fine: &Layout, from: &Field, to: &mut Field) {
    coarse.free_rows(|j, first, last| {
        let row = fine_row(coarse, fine, j);
        for i in first..last {
            let (f, k) = (row + 2 * i, j * coarse.pitch + i);
            to.x[k] = 0.5 * from.x[f];
            to.y[k] = 0.5 * from.y[f];
            to.z[k] = 0.5 * from.z[f];
        }
    });
}

/// Marks the coarse nodes around which more than a share of the fine ones is marked.
pub(super) fn inject_hold(
    coarse: &Layout,
    fine: &Layout,
    from: &[f32],
    share: f32,
    to: &mut [f32],
) {
    let pitch = fine.pitch;
    coarse.free_rows(|j, first, last| {
        let row = fine_row(coarse, fine, j);
        for i in first..last {
            let f = row + 2 * i;
            let (below, above) = (f - pitch, f + pitch);
            let edges = from[f - 1] + from[f + 1] + from[below] + from[above];
            let corners = from[below - 1] + from[below + 1] + from[above - 1] + from[above + 1];
            let weight = 0.25 * from[f] + 0.125 * edges + 0.0625 * corners;
            to[j * coarse.pitch + i] = f32::from(u8::from(weight > share));
        }
    });
}

/// The bilinear interpolation of coarse `now` − `before`, in spacings of the fine grid.
pub(super) fn correction(
    coarse: &Layout,
    fine: &Layout,
    now: &Field,
    before: &Field,
    to: &mut Field,
    row: &mut [f32],
) {
    let [ghost, ghost_row] = fine.ghost();
    fine.free_rows(|j, first, last| {
        let low = (j + ghost_row) / 2 * coarse.pitch;
        let is_between = !(j + ghost_row).is_multiple_of(2);
        let (from, until) = ((first + ghost) / 2, (last + ghost) / 2 + 1);
        let mut spread = |now: &[f32], before: &[f32], to: &mut [f32]| {
            for i in from..until {
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
        };
        spread(&now.x, &before.x, &mut to.x);
        spread(&now.y, &before.y, &mut to.y);
        spread(&now.z, &before.z, &mut to.z);
    });
}

/// A coarse shape as the start of the finer grid's: displacements divided by 1 − (r/a)², which is
/// zero on the border, interpolated cubically, and multiplied again. Plain interpolation would carry
/// the coarse border's polygon into the fine grid. `scaled` is scratch of the coarse grid.
pub(super) fn refine(
    coarse: &Layout,
    fine: &Layout,
    from: &Field,
    scaled: &mut Field,
    to: &mut Field,
    row: &mut [f32],
) {
    let per_area = 1.0 / (coarse.radius() * coarse.radius());
    coarse.free_rows(|j, first, last| {
        for i in first..last {
            let [x, y] = coarse.rest(i, j);
            let scale = 2.0 / (1.0 - (x * x + y * y) * per_area);
            let k = j * coarse.pitch + i;
            scaled.x[k] = from.x[k] * scale;
            scaled.y[k] = from.y[k] * scale;
            scaled.z[k] = from.z[k] * scale;
        }
    });
    // Ghosts first, which nodes beyond the border are extrapolated from; then theirs.
    super::smooth::mirror(coarse, scaled);
    let mut next = 0;
    for &Extrapolated { node, count, is_mean } in &coarse.extrapolated {
        let sources = &coarse.sources[next..next + count as usize];
        next += count as usize;
        for part in [&mut scaled.x, &mut scaled.y, &mut scaled.z] {
            let at = |k: u32| part[k as usize];
            part[node as usize] = if is_mean {
                sources.iter().map(|&k| at(k)).sum::<f32>() / count as f32
            } else {
                let lines = sources.as_chunks::<2>().0;
                let sum: f32 = lines.iter().map(|&[near, far]| 2.0 * at(near) - at(far)).sum();
                sum / lines.len() as f32
            };
        }
    }
    super::smooth::mirror(coarse, scaled);
    let per_area = 1.0 / (fine.radius() * fine.radius());
    let [ghost, ghost_row] = fine.ghost();
    fine.free_rows(|j, first, last| {
        let low = (j + ghost_row) / 2;
        let is_between = !(j + ghost_row).is_multiple_of(2);
        let (from, until) =
            (((first + ghost) / 2).saturating_sub(1), ((last + ghost) / 2 + 2).min(coarse.columns));
        let mut spread = |scaled: &[f32], to: &mut [f32]| {
            let at = |row: usize, i: usize| scaled[row * coarse.pitch + i];
            for i in from..until {
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
        };
        spread(&scaled.x, &mut to.x);
        spread(&scaled.y, &mut to.y);
        spread(&scaled.z, &mut to.z);
    });
}

/// The cubic through four values in a row, half-way between `low` and the next; the parabola through
/// three at the ends.
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

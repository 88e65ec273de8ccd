//! A Gaussian mean of the heights of a scan.

/// Reach of the mean \[standard deviations\].
const REACH: f64 = 3.0;

/// Heights of columns and rows after a Gaussian mean of a standard deviation \[distances of neighbours\]; beyond an edge the heights go on, turned about it:
/// planes stay.
pub(super) fn smoothed(
    [columns, rows]: [usize; 2],
    mut heights: Vec<f64>,
    deviation: f64,
) -> Vec<f64> {
    if deviation <= 0.0 {
        return heights;
    }
    let reach = (REACH * deviation).ceil() as usize;
    let weights: Vec<f64> =
        (0..=reach).map(|k| (-0.5 * (k as f64 / deviation).powi(2)).exp()).collect();
    let sum = 2.0 * weights.iter().sum::<f64>() - weights[0];
    let mut line = Vec::new();
    for (lines, count, step, stride) in [(rows, columns, columns, 1), (columns, rows, 1, columns)] {
        for first in (0..lines).map(|line| line * step) {
            line.clear();
            line.extend((0..count).map(|k| heights[first + k * stride]));
            let last = count - 1;
            let at = |k: isize| match usize::try_from(k) {
                Err(_) => 2.0 * line[0] - line[k.unsigned_abs().min(last)],
                Ok(k) if k <= last => line[k],
                Ok(k) => 2.0 * line[last] - line[last - (k - last).min(last)],
            };
            for k in 0..count {
                let pair = |j: usize| at(k as isize - j as isize) + at((k + j) as isize);
                let around: f64 = (1..=reach).map(|j| weights[j] * pair(j)).sum();
                heights[first + k * stride] = (weights[0] * line[k] + around) / sum;
            }
        }
    }
    heights
}

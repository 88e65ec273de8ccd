//! Percentiles of the samples.

/// 10th percentile, median and 90th percentile; `None` without values.
pub(super) fn band(mut values: Vec<f64>) -> Option<[f64; 3]> {
    values.sort_by(f64::total_cmp);
    let [low, median, high] = [0.1, 0.5, 0.9].map(|p| percentile(&values, p));
    Some([low?, median?, high?])
}

/// The percentile of sorted values, on a line between two values; `None` without values.
fn percentile(sorted: &[f64], p: f64) -> Option<f64> {
    let position = p * sorted.len().checked_sub(1)? as f64;
    let low = position as usize;
    let high = (low + 1).min(sorted.len() - 1);
    let part = position - low as f64;
    Some(sorted[low] * (1.0 - part) + sorted[high] * part)
}

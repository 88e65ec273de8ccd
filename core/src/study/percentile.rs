//! Percentiles of samples.

/// 10th percentile, median and 90th percentile; `None` without values.
pub(super) fn band(values: Vec<f64>) -> Option<[f64; 3]> {
    percentiles(values, [0.1, 0.5, 0.9])
}

/// The percentiles of values for some shares \[-\], each on a line between two values; `None` without values.
#[must_use]
pub fn percentiles<const N: usize>(mut values: Vec<f64>, shares: [f64; N]) -> Option<[f64; N]> {
    values.sort_by(f64::total_cmp);
    let last = values.len().checked_sub(1)?;
    Some(shares.map(|share| {
        let position = share * last as f64;
        let low = position as usize;
        let part = position - low as f64;
        values[low] * (1.0 - part) + values[(low + 1).min(last)] * part
    }))
}

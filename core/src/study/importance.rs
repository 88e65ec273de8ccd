//! Which unknown explains how much of the variance of a result: Sobol indices.
//!
//! First-order index Sᵢ = Var(E[f | xᵢ]) / Var(f): the part of the variance that xᵢ explains alone. Total index
//! Tᵢ = E[Var(f | all others)] / Var(f): the part that vanishes if all others are known; the difference is the effect
//! together with others. Samples and estimator of Sᵢ are those of Saltelli et al. (Comput. Phys. Commun. 181, 2010, 259–270):
//! rows of two independent matrices A and B, and rows of A whose i-th entry is that of B; Sᵢ is the mean of
//! f(B) (f(Aᵢ) − f(A)) / Var(f), exactly zero for an unknown without effect. Tᵢ is the estimator of Jansen (Comput. Phys.
//! Commun. 117, 1999, 35–43).

use schemars::JsonSchema;
use serde::Serialize;

/// Sobol indices of one unknown.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Index {
    /// First-order index \[-\].
    pub first_order: f64,
    /// Total index \[-\].
    pub total: f64,
    /// Standard errors of both \[-\], by resampling the rows.
    pub standard_error: [f64; 2],
}

/// Values of one row: f(A), f(B), and f(A with the unknown of B).
pub type Row = [f64; 3];

/// Fewest rows of an estimate.
pub const MIN_ROWS: usize = 16;
/// Resampled estimates of a standard error.
const RESAMPLES: usize = 100;

/// The indices of one unknown from rows; `None` for fewer than 16 rows or without variance.
#[must_use]
pub fn index(rows: &[Row]) -> Option<Index> {
    if rows.len() < MIN_ROWS {
        return None;
    }
    let [first_order, total] = estimates(rows.iter())?;
    let mut random = fastrand::Rng::with_seed(1);
    let mut sums = [[0.0; 2]; 2];
    let mut count = 0.0;
    for _ in 0..RESAMPLES {
        let picked: Vec<usize> = rows.iter().map(|_| random.usize(..rows.len())).collect();
        if let Some(estimates) = estimates(picked.iter().map(|k| &rows[*k])) {
            count += 1.0;
            for (sum, value) in sums.iter_mut().zip(estimates) {
                sum[0] += value;
                sum[1] += value * value;
            }
        }
    }
    let deviation = |[sum, squares]: [f64; 2]| {
        let mean = sum / f64::max(count, 1.0);
        (squares / f64::max(count, 1.0) - mean * mean).max(0.0).sqrt()
    };
    Some(Index { first_order, total, standard_error: sums.map(deviation) })
}

/// First-order and total index.
fn estimates<'a>(rows: impl Iterator<Item = &'a Row> + Clone) -> Option<[f64; 2]> {
    let count = rows.clone().count() as f64;
    let mean = |f: &dyn Fn(&Row) -> f64| rows.clone().map(f).sum::<f64>() / count;
    // Centred before products are formed: rounding would spoil a small variance beside a large mean.
    let center = mean(&|[a, b, _]| 0.5 * (a + b));
    let variance = mean(&|[a, b, _]| 0.5 * ((a - center).powi(2) + (b - center).powi(2)));
    if variance <= (1e-12 * center).powi(2) || !variance.is_finite() {
        return None;
    }
    let differences = mean(&|[a, _, mixed]| 0.5 * (a - mixed).powi(2));
    let products = mean(&|[a, b, mixed]| (b - center) * (mixed - a));
    Some([products / variance, differences / variance])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::unit_sample;
    use std::f64::consts::PI;

    /// The rows of each unknown of a function of the unit cube.
    fn rows_of(dimensions: usize, rows: usize, f: impl Fn(&[f64]) -> f64) -> Vec<Vec<Row>> {
        let row = |k: usize, shift: usize| -> Vec<f64> {
            (0..dimensions).map(|d| unit_sample(k, d + shift, 5)).collect()
        };
        let rows_of = |i: usize| {
            let values = |k: usize| {
                let (a, b) = (row(k, 0), row(k, dimensions));
                let mut mixed = a.clone();
                mixed[i] = b[i];
                [f(&a), f(&b), f(&mixed)]
            };
            (0..rows).map(values).collect()
        };
        (0..dimensions).map(rows_of).collect()
    }

    /// Compares both indices of each unknown with their exact values, within 5 % of the value (of 0.1 for less).
    fn compare(rows: &[Vec<Row>], first: &[f64], total: &[f64]) {
        for (k, rows) in rows.iter().enumerate() {
            let found = estimates(rows.iter()).unwrap();
            for (found, wanted) in found.into_iter().zip([first[k], total[k]]) {
                let allowed = 0.05 * wanted.max(0.1);
                assert!((found - wanted).abs() < allowed, "x{k}: {found} {wanted}");
            }
        }
    }

    #[test]
    fn the_ishigami_function_has_its_exact_indices() {
        let (a, b) = (7.0, 0.1);
        let f = |x: &[f64]| {
            let x: Vec<f64> = x.iter().map(|x| PI * (2.0 * x - 1.0)).collect();
            x[0].sin() + a * x[1].sin().powi(2) + b * x[2].powi(4) * x[0].sin()
        };
        let variance = a * a / 8.0 + b * PI.powi(4) / 5.0 + b * b * PI.powi(8) / 18.0 + 0.5;
        let first = [0.5 * (1.0 + b * PI.powi(4) / 5.0).powi(2), a * a / 8.0, 0.0];
        let both = 8.0 * b * b * PI.powi(8) / 225.0;
        let total = [first[0] + both, first[1], both];
        // The index of x₂ is zero: its estimate has an error of 0.013 with 4096 rows, 0.0001 with 16 384.
        compare(&rows_of(3, 16_384, f), &first.map(|s| s / variance), &total.map(|t| t / variance));
    }

    #[test]
    fn the_g_function_has_its_exact_indices() {
        let a = [0.0, 1.0, 4.5, 9.0];
        let f = |x: &[f64]| -> f64 {
            x.iter().zip(a).map(|(x, a)| ((4.0 * x - 2.0).abs() + a) / (1.0 + a)).product()
        };
        let parts = a.map(|a| 1.0 / (3.0 * (1.0 + a) * (1.0 + a)));
        let all: f64 = parts.iter().map(|part| 1.0 + part).product();
        let variance = all - 1.0;
        let total = parts.map(|part| part * all / (1.0 + part) / variance);
        compare(&rows_of(4, 8192, f), &parts.map(|part| part / variance), &total);
    }

    #[test]
    fn standard_errors_cover_the_error_and_a_constant_has_no_index() {
        let rows = rows_of(2, 64, |x| x[0] + 0.5 * x[1]);
        for (rows, wanted) in rows.iter().zip([0.8, 0.2]) {
            let index = index(rows).unwrap();
            let [first, total] = index.standard_error;
            assert!((index.first_order - wanted).abs() < 4.0 * first + 1e-9, "{index:?}");
            assert!((index.total - wanted).abs() < 4.0 * total + 1e-9, "{index:?}");
            assert!(first > 0.0 && first < 0.3 && total < 0.3, "{index:?}");
        }
        assert!(index(&[[2.0; 3]; 64]).is_none() && index(&[[1.0, 2.0, 3.0]; 3]).is_none());
    }
}

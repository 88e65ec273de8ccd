//! The monotone curve through the samples of a loading: least squares over a spline of as few knots as the noise allows.

use crate::curve::{Curve, CurveError, CurveSpec, Interpolation};
use crate::tensile::Row;

/// Greatest number of points of the curve, the origin among them.
pub(super) const MAX_KNOTS: usize = 40;
/// Samples below which scatter and shape cannot be told apart.
pub(super) const FEW: usize = 20;
/// Least slope of the curve, relative to its mean slope.
const LEAST_SLOPE: f64 = 1e-3;
/// Misfit that needs no further knot, relative to the greatest stress.
const EXACT: f64 = 5e-4;
/// Standard errors above which a misfit may be no noise.
const SIGNIFICANT: f64 = 1.0;
/// Samples between two knots below which no knot is added.
const LEAST_SAMPLES: usize = 5;
/// Corrections of the values for one set of knots.
const CORRECTIONS: usize = 8;

/// A curve and what is to be said about it.
pub(super) struct Fit {
    /// The points of the curve, the first one the origin.
    pub(super) points: Vec<Row>,
    pub(super) curve: Curve,
    /// Intervals of strain without a rise, where the curve has `least_slope` \[kPa\].
    pub(super) flat: Vec<[f64; 2]>,
    pub(super) least_slope: f64,
}

/// Fits samples of increasing, positive strain. `None` if nothing rises.
pub(super) fn fit(samples: &[Row]) -> Option<Result<Fit, CurveError>> {
    let end = samples.last()?[0];
    let stresses: Vec<f64> = samples.iter().map(|sample| sample[1]).collect();
    let rising = isotonic(&stresses);
    let greatest =
        rising.last().copied().filter(|last| *last > 0.0 && rises(&stresses, &rising))?;
    let rise = Rise { least: LEAST_SLOPE * greatest / end };
    let is_rising = stresses.is_sorted() && samples.len() < MAX_KNOTS;
    Some(if is_rising || samples.len() < FEW {
        rise.joined(samples, &rising)
    } else {
        rise.spline(samples, greatest)
    })
}

/// Isotonic regression: the non-decreasing values with the least sum of squared differences (pool adjacent violators).
fn isotonic(values: &[f64]) -> Vec<f64> {
    // Sum and number of each pool.
    let mut pools: Vec<(f64, usize)> = Vec::with_capacity(values.len());
    for &value in values {
        let mut pool = (value, 1);
        while let Some(&(sum, count)) = pools.last() {
            if sum / count as f64 <= pool.0 / pool.1 as f64 {
                break;
            }
            pools.pop();
            pool = (pool.0 + sum, pool.1 + count);
        }
        pools.push(pool);
    }
    let mean = |(sum, count): (f64, usize)| std::iter::repeat_n(sum / count as f64, count);
    pools.into_iter().flat_map(mean).collect()
}

/// Does the regression explain more of the values than it explains of noise? Of n values of noise it explains a share of about
/// (ln n + 0.6) / n. Few values show no noise: then any rise is one.
fn rises(values: &[f64], rising: &[f64]) -> bool {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let spread = |values: &[f64]| values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
    let (explained, all) = (spread(rising), spread(values));
    // Pools have the mean of their values.
    let of_noise = (3.0 * (count.ln() + 1.0) / count).min(0.5);
    // A sample alone rises from the origin.
    values.len() == 1 || explained > 0.0 && (values.len() < FEW || explained > of_noise * all)
}

/// Curves that rise everywhere.
struct Rise {
    /// The least slope \[kPa\].
    least: f64,
}

impl Rise {
    /// The curve through few samples. Samples that fall are one point, their mean.
    fn joined(&self, samples: &[Row], rising: &[f64]) -> Result<Fit, CurveError> {
        let mut points = vec![[0.0, 0.0]];
        let mut first = 0;
        for pool in rising.chunk_by(|a, b| a.to_bits() == b.to_bits()) {
            let rows = &samples[first..first + pool.len()];
            first += pool.len();
            if rows.iter().all(|row| row[1].to_bits() == pool[0].to_bits()) {
                points.extend(rows);
            } else {
                let strain = rows.iter().map(|row| row[0]).sum::<f64>() / rows.len() as f64;
                points.push([strain, pool[0]]);
            }
        }
        self.raised(points)
    }

    /// The spline of least squares. Intervals of knots are halved as long as their residuals hang together and the knots are worth it.
    fn spline(&self, samples: &[Row], greatest: f64) -> Result<Fit, CurveError> {
        let mut knots = vec![samples.len() - 1];
        let mut found = self.least_squares(samples, &knots)?;
        loop {
            let mut halves = halves(samples, &knots, &found.curve, EXACT * greatest);
            halves.truncate(MAX_KNOTS - 1 - knots.len());
            knots.extend(&halves);
            knots.sort_unstable();
            let finer = self.least_squares(samples, &knots)?;
            // Schwarz's criterion of the knots added.
            let gain =
                samples.len() as f64 * (squares(samples, &found) / squares(samples, &finer)).ln();
            if halves.is_empty() || gain < (samples.len() as f64).ln() * halves.len() as f64 {
                let rounded =
                    found.points.iter().map(|[strain, stress]| [digits(*strain), digits(*stress)]);
                return self.raised(rounded.collect()).or(Ok(found));
            }
            found = finer;
        }
    }

    /// The values at the knots that bring the spline next to the samples: Newton's method in the basis of hat functions, the
    /// values projected to those that rise.
    fn least_squares(&self, samples: &[Row], knots: &[usize]) -> Result<Fit, CurveError> {
        let mut found = self.raised(points_at(samples, knots))?;
        for _ in 0..CORRECTIONS {
            let residuals =
                samples.iter().map(|[strain, stress]| stress - found.curve.stress(*strain));
            let corrections = hats(samples, &found.points, residuals);
            let mut points = found.points.clone();
            points.iter_mut().skip(1).zip(corrections).for_each(|(point, more)| point[1] += more);
            found = self.raised(points)?;
        }
        Ok(found)
    }

    /// The nearest points that rise by the least slope or more from the origin on.
    fn raised(&self, mut points: Vec<Row>) -> Result<Fit, CurveError> {
        let above: Vec<f64> = points.iter().skip(1).map(|p| p[1] - self.least * p[0]).collect();
        for (point, (above, given)) in
            points.iter_mut().skip(1).zip(isotonic(&above).into_iter().zip(&above))
        {
            // A point that rises keeps its digits.
            if above.max(0.0).to_bits() != given.to_bits() {
                point[1] = above.max(0.0) + self.least * point[0];
            }
        }
        let is_flat =
            |pair: &[Row]| pair[1][1] - pair[0][1] < 1.01 * self.least * (pair[1][0] - pair[0][0]);
        let mut flat: Vec<[f64; 2]> = Vec::new();
        for pair in points.windows(2).filter(|pair| is_flat(pair)) {
            match flat.last_mut() {
                Some(last) if last[1].to_bits() == pair[0][0].to_bits() => last[1] = pair[1][0],
                _ => flat.push([pair[0][0], pair[1][0]]),
            }
        }
        let interpolation = Interpolation::Spline;
        let curve = Curve::new(&CurveSpec::Points { points: points.clone(), interpolation })?;
        Ok(Fit { points, curve, flat, least_slope: self.least })
    }
}

/// Sum of the squared residuals.
fn squares(samples: &[Row], fit: &Fit) -> f64 {
    samples.iter().map(|[strain, stress]| (stress - fit.curve.stress(*strain)).powi(2)).sum()
}

/// Seven significant digits.
fn digits(value: f64) -> f64 {
    format!("{value:.6e}").parse().unwrap_or(value)
}

/// The origin and the samples at the knots.
fn points_at(samples: &[Row], knots: &[usize]) -> Vec<Row> {
    std::iter::once([0.0, 0.0]).chain(knots.iter().map(|&k| samples[k])).collect()
}

/// The middle samples of the intervals whose residuals hang together, the worst first. Of noise the squares of the residuals
/// are half of those of their differences (von Neumann's ratio), of a misfit they are larger.
fn halves(samples: &[Row], knots: &[usize], curve: &Curve, exact: f64) -> Vec<usize> {
    let residual = |k: usize| samples[k][1] - curve.stress(samples[k][0]);
    let mut found = Vec::new();
    let mut from = 0;
    for &to in knots {
        let inside = from..to;
        from = to + 1;
        if inside.len() < LEAST_SAMPLES {
            continue;
        }
        let count = inside.len() as f64;
        let squares = inside.clone().map(|k| residual(k).powi(2)).sum::<f64>() / count;
        let differences = inside.clone().skip(1).map(|k| (residual(k) - residual(k - 1)).powi(2));
        let misfit = squares - 0.5 * differences.sum::<f64>() / (count - 1.0);
        let strain = |k: usize| samples[k][0];
        let middle = 0.5 * (strain(inside.start) + strain(to));
        let half = inside.start + samples[inside.clone()].partition_point(|s| s[0] < middle);
        if misfit > SIGNIFICANT * squares / count.sqrt() && misfit > exact * exact && half < to {
            found.push((misfit * count, half));
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.into_iter().map(|(_, half)| half).collect()
}

/// Values at the points but the origin of the piecewise linear function next to the residuals: normal equations, a tridiagonal
/// elimination.
fn hats(samples: &[Row], points: &[Row], residuals: impl Iterator<Item = f64>) -> Vec<f64> {
    let count = points.len();
    let (mut diagonal, mut beside, mut right) =
        (vec![0.0; count], vec![0.0; count], vec![0.0; count]);
    let mut k = 0;
    for ([strain, _], residual) in samples.iter().zip(residuals) {
        while k + 2 < count && *strain > points[k + 1][0] {
            k += 1;
        }
        let b = (strain - points[k][0]) / (points[k + 1][0] - points[k][0]);
        let a = 1.0 - b;
        diagonal[k] += a * a;
        diagonal[k + 1] += b * b;
        beside[k] += a * b;
        right[k] += a * residual;
        right[k + 1] += b * residual;
    }
    // The origin stays.
    for k in 2..count {
        let factor = beside[k - 1] / diagonal[k - 1];
        diagonal[k] -= factor * beside[k - 1];
        right[k] -= factor * right[k - 1];
    }
    let mut values = vec![0.0; count + 1];
    for k in (1..count).rev() {
        values[k] =
            (right[k] - if k + 1 < count { beside[k] * values[k + 1] } else { 0.0 }) / diagonal[k];
    }
    values[1..count].to_vec()
}

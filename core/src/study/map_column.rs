//! The values of one quantity at the solved points of a map, as numbers that a smooth function goes through.

use super::{Case, Quantity};

/// Smallest value that errors are relative to \[mean of the quantity\].
const LEAST: f64 = 0.05;
/// Room of interpolated values beyond the solved ones \[range of the quantity\].
const ROOM: f64 = 0.05;

/// Does a quantity change by factors? Then the function is that of its logarithm, where all values are positive.
fn is_factor(quantity: Quantity) -> bool {
    use Quantity as Q;
    matches!(
        quantity,
        Q::GreatestStrain
            | Q::SkinReserveUsed
            | Q::MeanPressureMmhg
            | Q::GreatestPressureMmhg
            | Q::MeanPressureKpa
            | Q::GreatestPressureKpa
            | Q::ForceN
            | Q::SkinStressKpa
            | Q::AttachmentTractionKpa
    )
}

/// What is smooth over a map: a quantity, or one of two values whose greater one is the quantity. The greatest pressure has a kink where
/// those over the middle of the implant and around it are equal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Series {
    pub(super) quantity: Quantity,
    part: Option<usize>,
}

impl Series {
    /// Those of all quantities; both of one quantity follow each other.
    pub(super) fn all() -> impl Iterator<Item = Self> {
        let of = |quantity| {
            let parts: &[_] = match quantity {
                Quantity::GreatestPressureKpa | Quantity::GreatestPressureMmhg => {
                    &[Some(0), Some(1)]
                }
                _ => &[None],
            };
            parts.iter().map(move |&part| Self { quantity, part })
        };
        Quantity::ALL.into_iter().flat_map(of)
    }

    /// The value of a case with an answer, if it has one.
    pub(super) fn value(self, case: &Case) -> Option<f64> {
        let value = case.values.get(self.quantity)?;
        let Some(part) = self.part else { return Some(value) };
        let peaks = case.pressure_peaks_kpa;
        Some(value * peaks[part] / peaks[0].max(peaks[1])).filter(|value| *value > 0.0)
    }
}

/// The values of a series at the solved points.
pub(super) struct Column {
    pub(super) series: Series,
    own: Vec<f64>,
    is_log: bool,
    /// Bounds of interpolated values, and the least number that errors are relative to.
    bounds: [f64; 2],
    least_scale: f64,
}

impl Column {
    pub(super) fn new(series: Series, own: Vec<f64>) -> Self {
        let least = own.iter().copied().fold(f64::INFINITY, f64::min);
        let most = own.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let room = ROOM * (most - least);
        // What is never negative stays so.
        let bounds =
            [if least < 0.0 { least - room } else { (least - room).max(0.0) }, most + room];
        let mean = own.iter().map(|value| value.abs()).sum::<f64>() / own.len() as f64;
        let least_scale = (LEAST * mean).max(f64::MIN_POSITIVE);
        let is_log = is_factor(series.quantity) && least > 0.0;
        Self { series, own, is_log, bounds, least_scale }
    }

    /// The number that the function goes through at a point.
    pub(super) fn fitted(&self, point: usize) -> f64 {
        if self.is_log { self.own[point].ln() } else { self.own[point] }
    }

    /// The value of such a number.
    pub(super) fn value(&self, fitted: f64) -> f64 {
        let [least, most] = self.bounds;
        (if self.is_log { fitted.exp() } else { fitted }).clamp(least, most)
    }

    /// What an error of a value is relative to.
    pub(super) fn scale(&self, value: f64) -> f64 {
        value.abs().max(self.least_scale)
    }

    /// What the points are missed by where they are left out, relative.
    pub(super) fn left_out(&self, missed: impl Iterator<Item = f64>) -> Vec<f64> {
        let relative = |(missed, own): (f64, &f64)| {
            if self.is_log { missed.abs() } else { missed.abs() / self.scale(*own) }
        };
        missed.zip(&self.own).map(relative).collect()
    }
}

/// Number of points near a place.
const NEAREST: usize = 4;
/// Distance up to which points are equally near \[half the length of an axis\].
const SAME: f64 = 1e-3;

/// The points nearest to a place, with weights by their nearness.
pub(super) struct Nearest([(usize, f64); NEAREST]);

impl Nearest {
    pub(super) fn of([x, y]: [f64; 2], points: &[[f64; 2]]) -> Self {
        let mut nearest = [(0, f64::INFINITY); NEAREST];
        for (k, [a, b]) in points.iter().enumerate() {
            let distance = (a - x).hypot(b - y);
            let place = nearest.partition_point(|(_, known)| *known <= distance);
            if place < NEAREST {
                nearest[place..].rotate_right(1);
                nearest[place] = (k, distance);
            }
        }
        Self(nearest.map(|(k, distance)| (k, 1.0 / (distance + SAME))))
    }

    /// The weighted mean of the values of these points.
    pub(super) fn mean(&self, values: &[f64]) -> f64 {
        let sum: f64 = self.0.iter().map(|(k, weight)| weight * values[*k]).sum();
        sum / self.0.iter().map(|(_, weight)| weight).sum::<f64>()
    }
}

/// The upper of both middle values; 0 of none.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

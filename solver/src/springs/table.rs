//! A function of strain as a table for the hot loops.
//!
//! Buckets of equal width, each holding a line with one bend, `a + b·x + c·max(x − k, 0)`, so that
//! a kink of the function inside a bucket is met exactly. The table is refined until its measured
//! error is small enough, and states that error.
//!
//! Uses `number`. Used by the spring laws.

use crate::number::Real;

/// The greatest error of a table's stress, relative to the peak stress of the tabulated range.
pub const TABLE_ERROR: f64 = 1e-5;

const LEAST_BUCKETS: usize = 512;
const MOST_BUCKETS: usize = 1 << 16;

/// What the table's integral is taken over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Weight {
    /// ∫ f dx: the table holds a force, its integral is the energy.
    One,
    /// ∫ f·x dx: the table holds a secant modulus, f·x is the stress.
    Argument,
}

/// Lines with one bend each, `a + b·x + c·max(x − k, 0)`, on buckets of equal width.
#[derive(Clone, Debug, PartialEq)]
#[doc(hidden)]
pub struct Buckets<R: Real> {
    start: R,
    buckets_per_unit: R,
    last: R,
    /// `[a, b, c, k]` each; a power of two of them.
    rows: Vec<[R::Scalar; 4]>,
}

impl<R: Real> AsRef<Self> for Buckets<R> {
    fn as_ref(&self) -> &Self {
        self
    }
}

impl<R: Real> Buckets<R> {
    /// The value at `x`, not below the range; above the range that of the last line.
    #[inline(always)]
    pub(crate) fn value(&self, x: R) -> R {
        let [a, b, c, k] = R::rows(&self.rows, self.index(x));
        a + b * x + c * (x - k).max(R::default())
    }

    /// The value and the slope at `x`.
    #[inline(always)]
    pub(crate) fn value_and_slope(&self, x: R) -> (R, R) {
        let [a, b, c, k] = R::rows(&self.rows, self.index(x));
        let over = x - k;
        let bend = R::select(over.is_above(R::default()), c, R::default());
        (a + b * x + bend * over, b + bend)
    }

    #[inline(always)]
    fn index(&self, x: R) -> R {
        ((x - self.start) * self.buckets_per_unit).min(self.last)
    }
}

/// A tabulated function on [start, end].
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    end: f64,
    buckets: Buckets<f64>,
    /// The weighted integral from `start` to each bucket's start.
    integrals: Vec<f64>,
    integral_at_zero: f64,
    weight: Weight,
    relative_error: f64,
}

impl AsRef<Buckets<f64>> for Table {
    fn as_ref(&self) -> &Buckets<f64> {
        &self.buckets
    }
}

impl Table {
    /// Tabulates `f` on [start, end]; `breaks` are the places where its slope may jump.
    ///
    /// The error is measured on the stress (`f` or `f·x`, as `weight` says), relative to its
    /// greatest magnitude on the range, and brought below [`TABLE_ERROR`] where 65 536 buckets can.
    #[must_use]
    pub fn new(
        f: impl Fn(f64) -> f64,
        (start, end): (f64, f64),
        breaks: &[f64],
        weight: Weight,
    ) -> Self {
        let mut count = LEAST_BUCKETS;
        loop {
            let table = Self::with_buckets(&f, (start, end), breaks, weight, count);
            if table.relative_error <= TABLE_ERROR || count >= MOST_BUCKETS {
                return table;
            }
            count *= 2;
        }
    }

    fn with_buckets(
        f: &impl Fn(f64) -> f64,
        (start, end): (f64, f64),
        breaks: &[f64],
        weight: Weight,
        count: usize,
    ) -> Self {
        let width = (end - start) / count as f64;
        let edge = |k: usize| if k == count { end } else { start + width * k as f64 };
        let mut buckets = Vec::with_capacity(count);
        let mut next_break = 0;
        let mut value = f(start);
        for k in 0..count {
            let (low, high) = (edge(k), edge(k + 1));
            while next_break < breaks.len() && breaks[next_break] <= low + 1e-6 * width {
                next_break += 1;
            }
            let is_inside = |at: f64| (low + 1e-6 * width..high - 1e-6 * width).contains(&at);
            // Where several breaks share a bucket, zero comes first: a sheet at rest pulls at nothing.
            let bend = if is_inside(0.0) {
                0.0
            } else {
                let next = breaks.get(next_break).copied();
                next.filter(|&at| is_inside(at)).unwrap_or(0.5 * (low + high))
            };
            let (at_bend, at_high) = (f(bend), f(high));
            let before = (at_bend - value) / (bend - low);
            let after = (at_high - at_bend) / (high - bend);
            buckets.push([value - before * low, before, after - before, bend]);
            value = at_high;
        }
        let last = (count - 1) as f64;
        let mut table = Self {
            end,
            integrals: Vec::with_capacity(count),
            buckets: Buckets { start, buckets_per_unit: 1.0 / width, last, rows: buckets },
            integral_at_zero: 0.0,
            weight,
            relative_error: 0.0,
        };
        let mut sum = 0.0;
        for k in 0..count {
            table.integrals.push(sum);
            sum += table.integral_within(k, edge(k), edge(k + 1));
        }
        table.integral_at_zero = table.integral(0.0);
        table.relative_error = table.measure_error(f);
        table
    }

    fn measure_error(&self, f: &impl Fn(f64) -> f64) -> f64 {
        let (mut error, mut peak) = (0.0_f64, 0.0_f64);
        let samples = 8 * self.buckets.rows.len();
        for k in 0..=samples {
            let start = self.buckets.start;
            let x = start + (self.end - start) * k as f64 / samples as f64;
            let scale = self.stress_scale(x);
            let exact = f(x);
            error = error.max((self.value(x) - exact).abs() * scale);
            peak = peak.max(exact.abs() * scale);
        }
        error / peak.max(f64::MIN_POSITIVE)
    }

    fn stress_scale(&self, x: f64) -> f64 {
        match self.weight {
            Weight::One => 1.0,
            Weight::Argument => x.abs(),
        }
    }

    /// The range's end \[argument\]: beyond it values follow the last straight line.
    #[must_use]
    pub fn end(&self) -> f64 {
        self.end
    }

    /// The table in other numbers, its values times `scale`.
    pub(crate) fn buckets<R: Real>(&self, scale: f64) -> Buckets<R> {
        let Buckets { start, buckets_per_unit, last, rows } = &self.buckets;
        let scaled = |&[a, b, c, k]: &[f64; 4]| {
            [R::scalar(a * scale), R::scalar(b * scale), R::scalar(c * scale), R::scalar(k)]
        };
        Buckets {
            start: R::splat(*start),
            buckets_per_unit: R::splat(*buckets_per_unit),
            last: R::splat(*last),
            rows: rows.iter().map(scaled).collect(),
        }
    }

    /// The measured error of the stress, relative to the peak stress.
    #[must_use]
    pub fn relative_error(&self) -> f64 {
        self.relative_error
    }

    /// The value at `x`.
    #[inline]
    #[must_use]
    pub fn value(&self, x: f64) -> f64 {
        self.buckets.value(x)
    }

    /// The value and the slope at `x`.
    #[inline]
    #[must_use]
    pub fn value_and_slope(&self, x: f64) -> (f64, f64) {
        self.buckets.value_and_slope(x)
    }

    /// The weighted integral from the range's start to `x`, exact for the tabulated function.
    #[inline]
    #[must_use]
    pub fn integral(&self, x: f64) -> f64 {
        let k = self.buckets.index(x) as usize;
        let low = self.buckets.start + k as f64 / self.buckets.buckets_per_unit;
        self.integrals[k] + self.integral_within(k, low, x)
    }

    /// The weighted integral from 0 to `x`, for a table whose range holds 0.
    #[inline]
    #[must_use]
    pub fn integral_from_zero(&self, x: f64) -> f64 {
        self.integral(x) - self.integral_at_zero
    }

    fn integral_within(&self, bucket: usize, low: f64, x: f64) -> f64 {
        let [a, b, c, k] = self.buckets.rows[bucket];
        let over = (x - k).max(0.0);
        match self.weight {
            Weight::One => (a + 0.5 * b * (x + low)) * (x - low) + 0.5 * c * over * over,
            // ∫ c (x−k) x dx from k to x = c·over²·(2x + k)/6.
            Weight::Argument => {
                0.5 * a * (x - low) * (x + low)
                    + b / 3.0 * (x - low) * (x * x + x * low + low * low)
                    + c / 6.0 * over * over * (2.0 * x + k)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kink_inside_a_bucket_is_met_exactly() {
        let f = |x: f64| if x < 0.3001 { x } else { 0.3001 + 50.0 * (x - 0.3001) };
        let table = Table::new(f, (-1.0, 1.0), &[0.3001], Weight::One);
        assert!(table.relative_error() < 1e-12);
        assert!((table.value_and_slope(0.3002).1 - 50.0).abs() < 1e-9);
    }

    #[test]
    fn breaks_close_to_zero_leave_nothing_at_zero() {
        let f = |x: f64| if x.abs() < 1e-5 { 1e3 * x } else { x + 999e-5 * x.signum() };
        let table = Table::new(f, (-1.0, 2.0), &[-1e-5, 0.0, 1e-5], Weight::One);
        assert!(table.value(0.0).abs() < 1e-15, "{:e}", table.value(0.0));
    }

    #[test]
    fn the_integral_is_that_of_the_tabulated_function() {
        for weight in [Weight::One, Weight::Argument] {
            let table = Table::new(|x: f64| (3.0 * x).cos() + 2.0, (0.0, 1.5), &[], weight);
            for x in [0.0, 0.01, 0.7, 1.4999] {
                let steps = 200_000;
                let sum: f64 = (0..steps)
                    .map(|k| {
                        let y = x * (f64::from(k) + 0.5) / f64::from(steps);
                        table.value(y) * if weight == Weight::Argument { y } else { 1.0 }
                    })
                    .sum::<f64>()
                    * x
                    / f64::from(steps);
                assert!((table.integral(x) - sum).abs() < 1e-9, "{weight:?} {x}");
            }
        }
    }
}

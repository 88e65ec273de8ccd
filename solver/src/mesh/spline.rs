//! A function of the plane through samples on a grid: the cubic B-spline, for one point in f64 or for four in f32.
//!
//! Twice continuously differentiable, with the samples' values at the samples; at the grid's edge the second derivative is that of the
//! cubic through four samples, so that the error is of fourth order everywhere. Beyond the edge the function is straight along each axis:
//! continuously differentiable.

use crate::number::{Real, Rows};

/// Least number of samples a side.
pub(crate) const LEAST_SAMPLES: usize = 4;

/// Difference of mirrored samples up to which the function counts as mirrored \[greatest sample\].
const MIRRORED: f64 = 1e-9;

/// The spline. Positions count in spacings from the grid's centre.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Spline {
    /// Samples a row and a column.
    counts: [usize; 2],
    /// Row-major, x fastest, from −x, −y.
    samples: Vec<f64>,
    /// Four neighbouring coefficients of a row each, row by row.
    coefficients: Rows,
}

/// Value and slope.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Tangent<R> {
    pub(crate) value: R,
    pub(crate) slope: [R; 2],
}

impl Spline {
    /// The spline through samples, row-major, x fastest; `None` for less than [`LEAST_SAMPLES`] a side, another number of samples than
    /// that of the sides, and samples that are not finite.
    pub(crate) fn new(counts: [usize; 2], samples: Vec<f64>) -> Option<Self> {
        let [columns, rows] = counts;
        let is_complete = columns.checked_mul(rows) == Some(samples.len());
        let is_large = columns.min(rows) >= LEAST_SAMPLES;
        if !is_complete || !is_large || !samples.iter().all(|sample| sample.is_finite()) {
            return None;
        }
        Some(Self::through(counts, samples))
    }

    fn through(counts: [usize; 2], samples: Vec<f64>) -> Self {
        let [columns, rows] = counts;
        let lines: Vec<Vec<f64>> = samples.chunks(columns).map(fitted).collect();
        let column = |k: usize| fitted(&lines.iter().map(|line| line[k]).collect::<Vec<_>>());
        let fitted: Vec<Vec<f64>> = (0..columns + 2).map(column).collect();
        let four = |(i, j): (usize, usize)| [0, 1, 2, 3].map(|k| fitted[i + k][j]);
        let places = (0..rows + 2).flat_map(|j| (0..columns - 1).map(move |i| (i, j)));
        Self { counts, coefficients: Rows::new(places.map(four).collect()), samples }
    }

    /// The spline less its tangent plane at the centre, and that plane's value and slope.
    pub(crate) fn based(self) -> (Self, Tangent<f64>) {
        let plane = self.at([0.0; 2]);
        let (columns, [i, j]) = (self.counts[0], self.center::<f64>());
        let mut samples = self.samples;
        for (k, sample) in samples.iter_mut().enumerate() {
            let [x, y] = [(k % columns) as f64 - i, (k / columns) as f64 - j];
            *sample -= plane.value + plane.slope[0] * x + plane.slope[1] * y;
        }
        (Self::through(self.counts, samples), plane)
    }

    /// Samples a row and a column.
    pub(crate) fn counts(&self) -> [usize; 2] {
        self.counts
    }

    /// Row-major, x fastest, from −x, −y.
    pub(crate) fn samples(&self) -> &[f64] {
        &self.samples
    }

    /// Is the function its own image mirrored along x, along y?
    pub(crate) fn mirrored(&self) -> [bool; 2] {
        let ([columns, rows], of) = (self.counts, &self.samples);
        let greatest = of.iter().fold(0.0_f64, |most, sample| most.max(sample.abs()));
        let is_image = |image: &dyn Fn(usize) -> usize| {
            (0..of.len()).all(|k| (of[k] - of[image(k)]).abs() <= MIRRORED * greatest)
        };
        [
            is_image(&|k| k - k % columns + (columns - 1 - k % columns)),
            is_image(&|k| (rows - 1 - k / columns) * columns + k % columns),
        ]
    }

    /// Value and slope at a position.
    #[inline(always)]
    pub(crate) fn at<R: Real>(&self, position: [R; 2]) -> Tangent<R> {
        let [x, y] = self.weights(position);
        let rows = self.rows(x.cell, y.cell);
        let (value, slope_x) = (sums(&rows, x.values), sums(&rows, x.slopes));
        Tangent {
            value: sum(value, y.values),
            slope: [sum(slope_x, y.values), sum(value, y.slopes)],
        }
    }

    /// Value, slope, and second derivatives at a position: xx, xy, yy.
    #[inline(always)]
    pub(crate) fn bent<R: Real>(&self, position: [R; 2]) -> (Tangent<R>, [R; 3]) {
        let [x, y] = self.weights(position);
        let rows = self.rows(x.cell, y.cell);
        let (value, slope) = (sums(&rows, x.values), sums(&rows, x.slopes));
        let bend = sums(&rows, x.bends);
        let tangent = Tangent {
            value: sum(value, y.values),
            slope: [sum(slope, y.values), sum(value, y.slopes)],
        };
        (tangent, [sum(bend, y.values), sum(slope, y.slopes), sum(value, y.bends)])
    }

    /// The centre in spacings from the first sample.
    #[inline(always)]
    fn center<R: Real>(&self) -> [R; 2] {
        self.counts.map(|count| R::splat(0.5 * (count - 1) as f64))
    }

    #[inline(always)]
    fn weights<R: Real>(&self, position: [R; 2]) -> [Weights<R>; 2] {
        let [x, y] = self.center();
        [
            Weights::new(position[0] + x, self.counts[0]),
            Weights::new(position[1] + y, self.counts[1]),
        ]
    }

    /// The coefficients around a cell.
    #[inline(always)]
    fn rows<R: Real>(&self, column: R, row: R) -> [[R; 4]; 4] {
        let (table, width) = (R::of(&self.coefficients), R::splat((self.counts[0] - 1) as f64));
        let four = |k: f64| R::rows(table, (row + R::splat(k)) * width + column);
        [four(0.0), four(1.0), four(2.0), four(3.0)]
    }
}

/// The weights of four coefficients along an axis, for the value and its derivatives.
struct Weights<R> {
    cell: R,
    values: [R; 4],
    slopes: [R; 4],
    bends: [R; 4],
}

impl<R: Real> Weights<R> {
    /// At a position in spacings from the first of some samples.
    #[inline(always)]
    fn new(position: R, samples: usize) -> Self {
        let (zero, last) = (R::splat(0.0), R::splat((samples - 1) as f64));
        let within = position.max(zero).min(last);
        let cell = within.trunc().min(last - R::splat(1.0));
        let (t, beyond) = (within - cell, position - within);
        let [half, sixth] = [0.5, 1.0 / 6.0].map(R::splat);
        let [two, three, four, six] = [2.0, 3.0, 4.0, 6.0].map(R::splat);
        let s = R::splat(1.0) - t;
        let (tt, ss) = (t * t, s * s);
        let slopes =
            [-(half * ss), (three * half * t - two) * t, (two - three * half * s) * s, half * tt];
        let values = [
            sixth * ss * s,
            sixth * (four + tt * (three * t - six)),
            sixth * (four + ss * (three * s - six)),
            sixth * tt * t,
        ];
        let is_beyond = (beyond * beyond).is_above(zero);
        let bends = [s, three * t - two, three * s - two, t];
        Self {
            cell,
            values: [0, 1, 2, 3].map(|k| values[k] + slopes[k] * beyond),
            slopes,
            bends: bends.map(|bend| R::select(is_beyond, zero, bend)),
        }
    }
}

/// The sums of four rows; written out, because a closure over an array is not always inlined.
#[inline(always)]
fn sums<R: Real>([a, b, c, d]: &[[R; 4]; 4], weights: [R; 4]) -> [R; 4] {
    [sum(*a, weights), sum(*b, weights), sum(*c, weights), sum(*d, weights)]
}

#[inline(always)]
fn sum<R: Real>(of: [R; 4], weights: [R; 4]) -> R {
    of[0] * weights[0] + of[1] * weights[1] + of[2] * weights[2] + of[3] * weights[3]
}

/// The coefficients of the cubic spline through samples at 0, 1, 2, …: one before the first sample, one after the last.
fn fitted(samples: &[f64]) -> Vec<f64> {
    let n = samples.len();
    let bend = |at: [usize; 4]| {
        let [a, b, c, d] = at.map(|k| samples[k]);
        2.0 * a - 5.0 * b + 4.0 * c - d
    };
    let (first, last) = (bend([0, 1, 2, 3]), bend([n - 1, n - 2, n - 3, n - 4]));
    let mut c = vec![0.0; n + 2];
    c[1] = samples[0] - first / 6.0;
    c[n] = samples[n - 1] - last / 6.0;
    // c[k − 1] + 4 c[k] + c[k + 1] = 6 samples[k − 1], eliminated from the first, then from the last.
    let mut ratio = vec![0.0; n + 1];
    for k in 2..n {
        let per = 1.0 / (4.0 - ratio[k - 1]);
        ratio[k] = per;
        c[k] = (6.0 * samples[k - 1] - c[k - 1]) * per;
    }
    for k in (2..n).rev() {
        c[k] -= ratio[k] * c[k + 1];
    }
    c[0] = 2.0 * c[1] - c[2] + first;
    c[n + 1] = 2.0 * c[n] - c[n - 1] + last;
    c
}

#[cfg(test)]
mod tests {
    use super::*;
    use wide::f32x4;

    fn cubic([x, y]: [f64; 2]) -> f64 {
        2.0 - 0.3 * x + 0.2 * y + 0.05 * x * y - 0.01 * x * x * x + 0.004 * x * y * y
    }

    fn spline(counts: [usize; 2], of: impl Fn([f64; 2]) -> f64) -> Spline {
        let [i, j] = counts.map(|count| 0.5 * (count - 1) as f64);
        let place = |k: usize| [(k % counts[0]) as f64 - i, (k / counts[0]) as f64 - j];
        let samples = (0..counts[0] * counts[1]).map(|k| of(place(k))).collect();
        Spline::new(counts, samples).unwrap()
    }

    #[test]
    fn a_cubic_is_its_own_spline_and_goes_on_straight() {
        let spline = spline([9, 6], cubic);
        for k in 0..200 {
            let t = f64::from(k);
            let [x, y] = [4.0 * (0.7 * t).sin(), 2.5 * (1.3 * t).cos()];
            assert!((spline.at([x, y]).value - cubic([x, y])).abs() < 1e-12);
            let (_, bend) = spline.bent([x, y]);
            for (found, exact) in bend.into_iter().zip([-0.06 * x, 0.05 + 0.008 * y, 0.008 * x]) {
                assert!((found - exact).abs() < 1e-12);
            }
            let [edge, after] = [4.0, 7.0].map(|x| spline.at([x, y]));
            assert!((after.value - edge.value - 3.0 * edge.slope[0]).abs() < 1e-12);
            assert!((after.slope[0] - edge.slope[0]).abs() < 1e-14);
        }
    }

    /// Central differences, within the grid, across its edges and at the edge itself.
    #[test]
    fn value_slope_and_bend_are_continuous_and_derivatives() {
        let spline = spline([7, 8], |[x, y]| (0.9 * x).sin() * (0.6 * y + 0.3).cos());
        let h = 1e-6;
        for k in 0..400 {
            let t = f64::from(k);
            let at = [5.0 * (0.7 * t).sin(), 5.5 * (1.3 * t).cos()];
            let at = if k % 3 == 0 { at.map(f64::round) } else { at };
            let (here, (_, bend)) = (spline.at(at), spline.bent(at));
            for axis in 0..2 {
                let moved = |by: f64| {
                    let mut to = at;
                    to[axis] += by;
                    spline.at(to)
                };
                let (after, before) = (moved(h), moved(-h));
                let slope = (after.value - before.value) / (2.0 * h);
                assert!((slope - here.slope[axis]).abs() < 1e-5, "{at:?}: {slope} {here:?}");
                let jump = [0, 1].map(|other| (after.slope[other] - before.slope[other]).abs());
                assert!(jump[0] < 1e-5 && jump[1] < 1e-5, "{at:?}: {jump:?}");
                if k % 3 != 0 {
                    for other in 0..2 {
                        let change = (after.slope[other] - before.slope[other]) / (2.0 * h);
                        assert!((change - bend[axis + other]).abs() < 1e-8, "{at:?}: {change}");
                    }
                }
            }
        }
    }

    #[test]
    fn four_numbers_at_a_time_are_those_of_one() {
        let spline = spline([12, 9], cubic);
        for k in 0..100 {
            let t = f64::from(k);
            let at = [7.0 * (0.7 * t).sin(), 5.0 * (1.3 * t).cos()];
            let lanes = at.map(|x| f32x4::new([x as f32, -x as f32, 0.5 * x as f32, 1.0]));
            let (found, (_, bend)) = (spline.at(lanes), spline.bent(lanes));
            for lane in 0..3 {
                let at = at.map(|x| x * [1.0, -1.0, 0.5][lane]);
                let close = |found: f32x4, exact: f64| {
                    let apart = f64::from(found.to_array()[lane]) - exact;
                    assert!(apart.abs() < 2e-5, "{apart} at {at:?}");
                };
                let exact = spline.at(at);
                close(found.value, exact.value);
                (0..2).for_each(|axis| close(found.slope[axis], exact.slope[axis]));
                bend.into_iter().zip(spline.bent(at).1).for_each(|(bend, e)| close(bend, e));
            }
        }
        let nowhere = spline.at([f32x4::splat(f32::NAN), f32x4::splat(f32::INFINITY)]);
        assert!(nowhere.value.to_array().into_iter().all(|value| !value.is_finite()));
    }

    #[test]
    fn the_tangent_plane_at_the_centre_is_taken_off() {
        for counts in [[9, 6], [8, 7]] {
            let (based, plane) = spline(counts, cubic).based();
            assert!((plane.value - 2.0).abs() < 1e-12 && (plane.slope[1] - 0.2).abs() < 1e-12);
            let center = based.at([0.0; 2]);
            assert!(center.value.abs() < 1e-12 && center.slope.map(f64::abs) < [1e-12; 2]);
            let rest = cubic([1.2, -0.7]) - 2.0 + 0.3 * 1.2 + 0.2 * 0.7;
            assert!((based.at([1.2, -0.7]).value - rest).abs() < 1e-12);
        }
    }

    #[test]
    fn mirror_images_are_found_and_incomplete_samples_are_none() {
        let of = |f: fn([f64; 2]) -> f64| spline([7, 6], f).mirrored();
        assert_eq!(of(|[x, y]| x * x + y), [true, false]);
        assert_eq!(of(|[x, y]| x * y * y), [false, true]);
        assert_eq!(of(|[x, y]| x * x - (0.3 * y).cos()), [true, true]);
        for (counts, samples) in [([3, 5], 15), ([5, 5], 24), ([usize::MAX, 4], 8)] {
            assert!(Spline::new(counts, vec![1.0; samples]).is_none());
        }
        assert!(Spline::new([4, 4], vec![f64::NAN; 16]).is_none());
    }
}

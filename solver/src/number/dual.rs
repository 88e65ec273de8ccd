//! Numbers with their derivatives by N variables (forward differentiation): the second derivatives of an energy from
//! the source of its first ones.

use super::{Real, Rows};
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// A number and its derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Dual<const N: usize> {
    pub(crate) value: f64,
    pub(crate) slopes: [f64; N],
}

impl<const N: usize> Dual<N> {
    /// The k-th variable.
    pub(crate) fn variable(value: f64, k: usize) -> Self {
        let mut slopes = [0.0; N];
        slopes[k] = 1.0;
        Self { value, slopes }
    }

    /// A function of the number with this value and derivative.
    #[inline(always)]
    fn map(self, value: f64, slope: f64) -> Self {
        Self { value, slopes: self.slopes.map(|s| s * slope) }
    }

    /// A function of both numbers with this value and these derivatives.
    #[inline(always)]
    fn with(self, other: Self, value: f64, [own, others]: [f64; 2]) -> Self {
        let mut slopes = self.slopes;
        for (s, t) in slopes.iter_mut().zip(other.slopes) {
            *s = *s * own + t * others;
        }
        Self { value, slopes }
    }
}

impl<const N: usize> Default for Dual<N> {
    fn default() -> Self {
        Self::splat(0.0)
    }
}

impl<const N: usize> Add for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.with(other, self.value + other.value, [1.0, 1.0])
    }
}

impl<const N: usize> AddAssign for Dual<N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<const N: usize> Sub for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.with(other, self.value - other.value, [1.0, -1.0])
    }
}

impl<const N: usize> Mul for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.with(other, self.value * other.value, [other.value, self.value])
    }
}

impl<const N: usize> Div for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        self.with(other, quotient, [1.0 / other.value, -quotient / other.value])
    }
}

impl<const N: usize> Neg for Dual<N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(-self.value, -1.0)
    }
}

impl<const N: usize> Real for Dual<N> {
    type Scalar = f64;
    type Mask = bool;

    #[inline(always)]
    fn scalar(value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self { value, slopes: [0.0; N] }
    }

    /// The derivative at zero counts as zero.
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        self.map(root, if root > 0.0 { 0.5 / root } else { 0.0 })
    }

    #[inline(always)]
    fn ln(self) -> Self {
        self.map(self.value.ln(), 1.0 / self.value)
    }

    #[inline(always)]
    fn exp(self) -> Self {
        let exp = self.value.exp();
        self.map(exp, exp)
    }

    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self.value < other.value { other } else { self }
    }

    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self.value > other.value { other } else { self }
    }

    #[inline(always)]
    fn is_above(self, other: Self) -> bool {
        self.value > other.value
    }

    #[inline(always)]
    fn is_any(mask: bool) -> bool {
        mask
    }

    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }

    #[inline(always)]
    fn trunc(self) -> Self {
        Self::splat(self.value.trunc())
    }

    #[inline(always)]
    fn rows(table: &[[f64; 4]], indices: Self) -> [Self; 4] {
        f64::rows(table, indices.value).map(Self::splat)
    }

    #[inline(always)]
    fn of(rows: &Rows) -> &[[f64; 4]] {
        f64::of(rows)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_are_the_derivatives_of_a_function() {
        fn f<R: Real>(x: R, y: R) -> R {
            let quotient = (x * y - x) / (y + R::splat(2.0));
            (quotient.exp() + x.sqrt() * y.ln()).max(R::splat(0.1)) - (-x).min(y)
        }
        let (x, y, h) = (1.7, 2.3, 1e-6);
        let dual = f(Dual::<2>::variable(x, 0), Dual::variable(y, 1));
        let slopes =
            [(f(x + h, y) - f(x - h, y)) / (2.0 * h), (f(x, y + h) - f(x, y - h)) / (2.0 * h)];
        assert!((dual.value - f(x, y)).abs() < 1e-14);
        for (slope, expected) in dual.slopes.into_iter().zip(slopes) {
            assert!((slope - expected).abs() < 1e-8, "{slope} {expected}");
        }
    }
}

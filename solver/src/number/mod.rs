//! Real numbers, one (`f64`) or four at a time (`f32x4`): what the laws and the obstacle are written in.
//!
//! `dual` (numbers with derivatives).
//!
//! Uses nothing of this crate. Used by `springs` and all to its right.

pub(crate) mod dual;

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};
use wide::f32x4;

/// A real number, or four of them.
pub trait Real:
    Copy
    + Debug
    + Default
    + Add<Output = Self>
    + AddAssign
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// One of the numbers.
    type Scalar: Copy + Debug + PartialEq;
    /// What a comparison gives.
    type Mask: Copy;

    /// A number of its own precision.
    fn scalar(value: f64) -> Self::Scalar;

    /// The same number in all lanes.
    fn splat(value: f64) -> Self;

    fn sqrt(self) -> Self;

    fn ln(self) -> Self;

    fn exp(self) -> Self;

    fn max(self, other: Self) -> Self;

    fn min(self, other: Self) -> Self;

    fn is_above(self, other: Self) -> Self::Mask;

    fn is_any(mask: Self::Mask) -> bool;

    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;

    /// The number without its fraction, of a number that `i32` holds.
    fn trunc(self) -> Self;

    /// The columns of the rows with these indices, rounded to zero. The number of rows is a power of two, so that an
    /// index that is not a number finds a row too.
    fn rows(table: &[[Self::Scalar; 4]], indices: Self) -> [Self; 4];

    /// Rows in this precision.
    fn of(rows: &Rows) -> &[[Self::Scalar; 4]];
}

/// Rows of four numbers in both precisions, a power of two of them: those after the given ones are zero.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    exact: Vec<[f64; 4]>,
    lanes: Vec<[f32; 4]>,
}

impl Rows {
    pub(crate) fn new(mut exact: Vec<[f64; 4]>) -> Self {
        exact.resize(exact.len().next_power_of_two(), [0.0; 4]);
        let lanes = exact.iter().map(|row| row.map(<f32x4 as Real>::scalar)).collect();
        Self { exact, lanes }
    }
}

impl Real for f64 {
    type Scalar = f64;
    type Mask = bool;

    #[inline(always)]
    fn scalar(value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn splat(value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn sqrt(self) -> f64 {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn ln(self) -> f64 {
        f64::ln(self)
    }

    #[inline(always)]
    fn exp(self) -> f64 {
        f64::exp(self)
    }

    #[inline(always)]
    fn max(self, other: f64) -> f64 {
        // f64::max is a call in WebAssembly.
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn min(self, other: f64) -> f64 {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn is_above(self, other: f64) -> bool {
        self > other
    }

    #[inline(always)]
    fn is_any(mask: bool) -> bool {
        mask
    }

    #[inline(always)]
    fn select(mask: bool, yes: f64, no: f64) -> f64 {
        if mask { yes } else { no }
    }

    #[inline(always)]
    fn trunc(self) -> f64 {
        f64::from(self as i32)
    }

    #[inline(always)]
    fn rows(table: &[[f64; 4]], index: f64) -> [f64; 4] {
        table[index as usize & (table.len() - 1)]
    }

    #[inline(always)]
    fn of(rows: &Rows) -> &[[f64; 4]] {
        &rows.exact
    }
}

impl Real for f32x4 {
    type Scalar = f32;
    type Mask = f32x4;

    #[inline(always)]
    fn scalar(value: f64) -> f32 {
        value as f32
    }

    #[inline(always)]
    fn splat(value: f64) -> f32x4 {
        f32x4::splat(value as f32)
    }

    #[inline(always)]
    fn sqrt(self) -> f32x4 {
        f32x4::sqrt(self)
    }

    #[inline(always)]
    fn ln(self) -> f32x4 {
        f32x4::ln(self)
    }

    #[inline(always)]
    fn exp(self) -> f32x4 {
        f32x4::exp(self)
    }

    #[inline(always)]
    fn max(self, other: f32x4) -> f32x4 {
        self.fast_max(other)
    }

    #[inline(always)]
    fn min(self, other: f32x4) -> f32x4 {
        self.fast_min(other)
    }

    #[inline(always)]
    fn is_above(self, other: f32x4) -> f32x4 {
        self.simd_gt(other)
    }

    #[inline(always)]
    fn is_any(mask: f32x4) -> bool {
        mask.any()
    }

    #[inline(always)]
    fn select(mask: f32x4, yes: f32x4, no: f32x4) -> f32x4 {
        mask.bitselect(yes, no)
    }

    #[inline(always)]
    fn trunc(self) -> f32x4 {
        f32x4::from_i32x4(self.fast_trunc_int())
    }

    #[inline(always)]
    fn rows(table: &[[f32; 4]], indices: f32x4) -> [f32x4; 4] {
        let mask = table.len() - 1;
        let indices = indices.fast_trunc_int().to_array();
        f32x4::transpose(indices.map(|k| f32x4::new(table[k as usize & mask])))
    }

    #[inline(always)]
    fn of(rows: &Rows) -> &[[f32; 4]] {
        &rows.lanes
    }
}

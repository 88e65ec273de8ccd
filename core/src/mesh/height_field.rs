//! The chest wall as a height field, for one point in f64 or for four in f32.
//!
//! w = −(κ₁x² + κ₂y²)/(1 + S), S = √(1 − κ₁(κ₁x² + κ₂y²)), with the curvatures κ₁ across (x) and κ₂ along the body (y): an
//! ellipsoid's patch, a sphere for equal curvatures, the plane for none.

use crate::number::Real;

/// Least S: the height field ends where the wall is upright.
const LEAST_ROOT: f64 = 1e-3;

/// A height field, in any unit of length.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct HeightField<R> {
    /// The plane needs no evaluation.
    is_flat: bool,
    curvatures: [R; 2],
}

/// Height and slope ∇w at a position of the plane.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Ground<R> {
    pub(crate) height: R,
    pub(crate) slope: [R; 2],
}

impl<R: Real> HeightField<R> {
    /// The plane without curvatures.
    pub(crate) fn new(curvatures: Option<[f64; 2]>) -> Self {
        let is_flat = curvatures.is_none();
        Self { is_flat, curvatures: curvatures.unwrap_or_default().map(R::splat) }
    }

    #[inline(always)]
    pub(crate) fn is_flat(&self) -> bool {
        self.is_flat
    }

    #[inline(always)]
    pub(crate) fn at(&self, [x, y]: [R; 2]) -> Ground<R> {
        if self.is_flat {
            return Ground::default();
        }
        let [across, along] = self.curvatures;
        let rates = [across * x, along * y];
        let share = rates[0] * x + rates[1] * y;
        let root = self.root(share);
        let height = -share / (R::splat(1.0) + root);
        Ground { height, slope: rates.map(|rate| -rate / root) }
    }

    /// Second derivatives of w: xx, xy, yy.
    #[inline(always)]
    pub(crate) fn curvature(&self, [x, y]: [R; 2]) -> [R; 3] {
        let [across, along] = self.curvatures;
        let rates = [across * x, along * y];
        let root = self.root(rates[0] * x + rates[1] * y);
        let bend = across / (root * root * root);
        [
            -across / root - bend * rates[0] * rates[0],
            -bend * rates[0] * rates[1],
            -along / root - bend * rates[1] * rates[1],
        ]
    }

    #[inline(always)]
    fn root(&self, share: R) -> R {
        let least = R::splat(LEAST_ROOT * LEAST_ROOT);
        (R::splat(1.0) - self.curvatures[0] * share).max(least).sqrt()
    }
}

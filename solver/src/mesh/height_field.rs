//! The chest wall as a height field, for one point in f64 or for four in f32.
//!
//! w = −(κ₁x² + κ₂y²)/(1 + S), S = √(1 − κ(κ₁x² + κ₂y²)), with the curvatures κ₁ across (x) and κ₂ along the body (y), and κ = κ₁, or κ₂
//! where κ₁ is zero: an ellipsoid's patch, a sphere for equal curvatures, a cylinder for one curvature. Or a [`Spline`] through heights.

use super::spline::Spline;
use crate::number::Real;
use std::sync::Arc;

/// Least S: the height field ends where the wall is upright.
const LEAST_ROOT: f64 = 1e-3;

/// A height field, in any unit of length.
#[derive(Clone, Debug, Default)]
pub(crate) enum HeightField<R> {
    /// The plane, which needs no evaluation.
    #[default]
    Flat,
    /// Two curvatures, and κ.
    Curved([R; 2], R),
    /// A grid of heights.
    Grid {
        heights: Arc<Spline>,
        /// Reciprocal spacing.
        per_spacing: R,
        /// The unit of the heights.
        unit: R,
    },
}

/// Height and slope ∇w at a position of the plane.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Ground<R> {
    pub(crate) height: R,
    pub(crate) slope: [R; 2],
}

impl<R: Real> HeightField<R> {
    /// Of two curvatures.
    pub(crate) fn curved(curvatures: [f64; 2]) -> Self {
        let main = if curvatures[0] == 0.0 { curvatures[1] } else { curvatures[0] };
        Self::Curved(curvatures.map(R::splat), R::splat(main))
    }

    #[inline(always)]
    pub(crate) fn is_flat(&self) -> bool {
        matches!(self, Self::Flat)
    }

    #[inline(always)]
    pub(crate) fn at(&self, position: [R; 2]) -> Ground<R> {
        match self {
            Self::Flat => Ground::default(),
            Self::Curved(curvatures, main) => {
                let rates = [curvatures[0] * position[0], curvatures[1] * position[1]];
                let share = rates[0] * position[0] + rates[1] * position[1];
                let root = Self::root(*main, share);
                let height = -share / (R::splat(1.0) + root);
                Ground { height, slope: rates.map(|rate| -rate / root) }
            }
            Self::Grid { heights, per_spacing, unit } => {
                Self::in_grid(heights, [*per_spacing, *unit], position)
            }
        }
    }

    /// Out of line: the other walls have short code.
    #[inline(never)]
    fn in_grid(heights: &Spline, [per_spacing, unit]: [R; 2], position: [R; 2]) -> Ground<R> {
        let tangent = heights.at(position.map(|x| x * per_spacing));
        let slope = tangent.slope.map(|slope| slope * (unit * per_spacing));
        Ground { height: tangent.value * unit, slope }
    }

    /// Second derivatives of w: xx, xy, yy.
    #[inline(always)]
    pub(crate) fn curvature(&self, position: [R; 2]) -> [R; 3] {
        match self {
            Self::Flat => Default::default(),
            Self::Curved(curvatures, main) => {
                let rates = [curvatures[0] * position[0], curvatures[1] * position[1]];
                let root = Self::root(*main, rates[0] * position[0] + rates[1] * position[1]);
                let bend = *main / (root * root * root);
                [
                    -curvatures[0] / root - bend * rates[0] * rates[0],
                    -bend * rates[0] * rates[1],
                    -curvatures[1] / root - bend * rates[1] * rates[1],
                ]
            }
            Self::Grid { .. } => self.bent(position).1,
        }
    }

    /// [`Self::at`] and [`Self::curvature`], of a grid at once.
    pub(crate) fn bent(&self, position: [R; 2]) -> (Ground<R>, [R; 3]) {
        let Self::Grid { heights, per_spacing, unit } = self else {
            return (self.at(position), self.curvature(position));
        };
        let (tangent, bend) = heights.bent(position.map(|x| x * *per_spacing));
        let rate = *unit * *per_spacing;
        let slope = tangent.slope.map(|slope| slope * rate);
        let bend = bend.map(|bend| bend * (rate * *per_spacing));
        (Ground { height: tangent.value * *unit, slope }, bend)
    }

    #[inline(always)]
    fn root(main: R, share: R) -> R {
        let least = R::splat(LEAST_ROOT * LEAST_ROOT);
        (R::splat(1.0) - main * share).max(least).sqrt()
    }
}

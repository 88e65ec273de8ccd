//! The map of heights that makes a dome fuller or leaner than half of an ellipsoid.
//!
//! x²/a² + y²/b² + (z/p)^m = 1 is the image of the half-ball x² + y² + s² = 1 under the monotone map s = ζ^(m/2) of the height ζ = z/p: sections
//! at equal heights are ellipses still. Their area πab (1 − ζ^m) integrates to the volume πabp m/(m + 1), so that a fullness f needs m = f/(1 − f);
//! m = 2 is half of an ellipsoid and has no map. For every m > 1 the dome is smooth at the apex, with radius of curvature a²m/(2p), and vertical
//! at its base. The map is odd, so that a point below the base has a place, too.

use crate::number::Real;

/// Heights ζ below which the map is linear \[-\]: beyond the rounding of f32, above its least numbers.
const LEAST: f64 = 1e-6;

/// The map of heights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fullness<R> {
    /// m/2.
    half: R,
    /// 2/m.
    inverse: R,
}

impl<R: Real> Fullness<R> {
    /// Of an exponent m.
    pub(super) fn new(exponent: f64) -> Self {
        Self { half: R::splat(0.5 * exponent), inverse: R::splat(2.0 / exponent) }
    }

    /// The place s in the half-ball of a height ζ, and s ds/dζ.
    #[inline(never)]
    pub(super) fn source(&self, height: R) -> (R, R) {
        let (size, share) = split(height);
        let source = power(size, self.half);
        (source * share, self.half * source * source / size * share)
    }

    /// The height ζ of a place s in the half-ball.
    #[inline(never)]
    pub(super) fn image(&self, source: R) -> R {
        let (size, share) = split(source);
        power(size, self.inverse) * share
    }

    /// Second derivative of s²/2 by the height ζ, no nearer to the base than a least height.
    #[inline(never)]
    pub(super) fn bend(&self, height: R, least: f64) -> R {
        let (one, two) = (R::splat(1.0), R::splat(2.0));
        let size = height.max(-height).max(R::splat(least.max(LEAST)));
        let exponent = self.half * two;
        self.half * (exponent - one) * power(size, exponent - two)
    }
}

/// The size of a number, at least [`LEAST`], and the number by it.
#[inline(always)]
fn split<R: Real>(of: R) -> (R, R) {
    let size = of.max(-of).max(R::splat(LEAST));
    (size, of / size)
}

#[inline(always)]
fn power<R: Real>(of: R, exponent: R) -> R {
    (of.ln() * exponent).exp()
}

#[cfg(test)]
mod tests {
    use super::*;
    use wide::f32x4;

    #[test]
    fn the_map_is_a_power_with_its_derivatives_and_its_inverse() {
        for exponent in [11.0 / 9.0, 1.5, 2.0, 2.6, 4.0] {
            let (one, four) = (Fullness::<f64>::new(exponent), Fullness::<f32x4>::new(exponent));
            let first = |lanes: f32x4| f64::from(lanes.to_array()[0]);
            for k in -60..=60 {
                let height = 0.02 * f64::from(k);
                let (source, pull) = one.source(height);
                let wanted = height.abs().powf(0.5 * exponent).copysign(height);
                assert!((source - wanted).abs() < 1e-9, "{source} {wanted}");
                assert!((one.image(source) - height).abs() < 1e-9);
                let lanes = four.source(<f32x4 as Real>::splat(height));
                assert!(
                    (first(lanes.0) - source).abs() < 2e-6 && (first(lanes.1) - pull).abs() < 4e-6
                );
                if k == 0 {
                    continue;
                }
                let step = 1e-6;
                let half_square = |height: f64| 0.5 * one.source(height).0.powi(2);
                let slope =
                    (half_square(height + step) - half_square(height - step)) / (2.0 * step);
                assert!((slope - pull).abs() < 1e-8, "{slope} {pull} at {height}");
                let bend =
                    (one.source(height + step).1 - one.source(height - step).1) / (2.0 * step);
                let error = (bend - one.bend(height, 0.0)).abs();
                assert!(error < 1e-5 * (1.0 + bend.abs()), "{bend} {error} at {height}");
            }
        }
    }
}

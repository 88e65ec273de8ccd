//! The sections of a dome whose apex lies towards the feet.
//!
//! The section at a height is the base's ellipse, shrunk towards the foot (0, −s) of the apex: with e = s/b and ρ² = 1 − (z/p)^m its middle lies at
//! −s(1 − ρ) and its half-axes are ρa and ρb. No section reaches beyond the base, the lower pole is fuller and steeper than the upper one, and the
//! areas, so the volume, are those of the upright dome. Seen from the apex's foot, q = (x, y + s), the ellipse is a conic about its focus: with
//! u = √(1 − e²) x/a and v = (y + s)/b its gauge is h = (√(u² + v²) − e v)/(1 − e²), of degree one, smooth but for the second derivative of h² on the
//! line below the apex.

use crate::number::Real;

/// Distances from the line below the apex that count as this one \[-\].
const LEAST: f64 = 1e-6;

/// The sections of a leaning dome, in any unit of length.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaning<R> {
    /// s.
    pub(super) shift: R,
    eccentricity: R,
    /// 1/(1 − e²).
    per_square: R,
    /// √(1 − e²)/a and 1/b.
    per_axis: [R; 2],
}

/// The gauge h of a place in the base, and its derivatives.
#[derive(Clone, Copy)]
pub(super) struct Section<R> {
    pub(super) length: R,
    /// ∇h.
    pub(super) slope: [R; 2],
    /// h times the second derivative of h: xx, xy, yy.
    pub(super) bend: [R; 3],
}

impl<R: Real> Leaning<R> {
    /// Of half-axes a and b and a way s of the apex.
    pub(super) fn new([a, b]: [f64; 2], shift: f64) -> Self {
        let eccentricity = shift / b;
        let square = 1.0 - eccentricity * eccentricity;
        Self {
            shift: R::splat(shift),
            eccentricity: R::splat(eccentricity),
            per_square: R::splat(1.0 / square),
            per_axis: [R::splat(square.sqrt() / a), R::splat(1.0 / b)],
        }
    }

    /// h at a place from the apex's foot.
    #[inline(always)]
    pub(super) fn length(&self, [x, y]: [R; 2]) -> R {
        let (u, v) = (x * self.per_axis[0], y * self.per_axis[1]);
        ((u * u + v * v).sqrt() - self.eccentricity * v) * self.per_square
    }

    /// h and its derivatives at a place from the apex's foot.
    #[inline(always)]
    pub(super) fn section(&self, [x, y]: [R; 2]) -> Section<R> {
        let [across, along] = self.per_axis;
        let (u, v) = (x * across, y * along);
        let distance = (u * u + v * v).sqrt();
        let per = R::splat(1.0) / distance.max(R::splat(LEAST));
        let (cos, sin) = (u * per, v * per);
        let length = (distance - self.eccentricity * v) * self.per_square;
        let slope =
            [cos * across * self.per_square, (sin - self.eccentricity) * along * self.per_square];
        let bend = length * per * self.per_square;
        Section {
            length,
            slope,
            bend: [
                bend * sin * sin * (across * across),
                -bend * sin * cos * (across * along),
                bend * cos * cos * (along * along),
            ],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::HalfBall;
    use super::*;
    use crate::contact::shape::traits::Geometry;
    use std::f64::consts::{PI, TAU};

    #[test]
    fn sections_are_the_base_shrunk_towards_the_foot_of_the_apex() {
        for (a, b, shift) in [(60.0, 54.0, 20.0), (50.0, 70.0, -30.0), (40.0, 40.0, 24.0)] {
            let sections = Leaning::<f64>::new([a, b], shift);
            let count = 400;
            let angles = (0..count).map(|k| TAU * f64::from(k) / f64::from(count));
            let mut area = 0.0;
            for angle in angles {
                let [x, y] = [a * angle.cos(), b * angle.sin()];
                for share in [0.1, 0.6, 1.0] {
                    let found = sections.length([x * share, (y + shift) * share]);
                    assert!((found - share).abs() < 1e-14, "{found} {share}");
                }
                // ½∮ dφ/h² by the rule of trapezoids, exact to rounding for a smooth periodic function.
                area += 0.5 * sections.length([angle.cos(), angle.sin()]).powi(-2);
            }
            area *= TAU / f64::from(count);
            assert!((area / (PI * a * b) - 1.0).abs() < 1e-12, "{area}");
        }
    }

    #[test]
    fn no_section_reaches_beyond_the_base_and_the_lower_pole_is_fuller() {
        for fullness in [0.6, 2.0 / 3.0, 0.75] {
            let (b, p, shift) = (54.0, 45.0, 20.0);
            let dome = HalfBall::round(60.0, p).anatomical(b, shift).filled(fullness);
            assert!(dome.apex().distance(glam::DVec3::new(0.0, -shift, p)) < 1e-12);
            let gauge = dome.gauge::<f64>();
            let length = |y: f64, z: f64| {
                crate::contact::shape::traits::Gauge::length_squared(&gauge, [0.0, y, z])
            };
            for k in 1..20 {
                let z = p * f64::from(k) / 20.0;
                for y in [-b - 1e-9, b + 1e-9] {
                    assert!(length(y, z) > 1.0);
                }
                // As high as at the same distance above the apex, the surface is farther below it.
                assert!(length(-0.6 * b, z) < length(0.6 * b, z));
            }
        }
    }
}

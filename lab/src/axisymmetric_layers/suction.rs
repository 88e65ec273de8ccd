//! The suction of a void: the energy p V of the volume V between wall and inner face over the pocket, by straight edges of the inner face.
//!
//! V = Σ 2π ∫ r z dr − 2π ∫₀ʳ r w dr: the wall's part depends on the last radius alone.
//!
//! Uses `wall`. Used by `assembly`.

use super::wall::Wall;
use std::f64::consts::TAU;

/// A suction on the innermost rings.
#[derive(Clone, Copy, Debug)]
pub(super) struct Suction {
    pub(super) kpa: f64,
    /// Number of rings over the pocket.
    pub(super) rings: usize,
    pub(super) wall: Wall,
}

impl Suction {
    /// ∫₀ʳ r w dr, and its first and second derivative.
    fn under(&self, r: f64) -> [f64; 3] {
        let Some(radius) = self.wall.radius_mm else { return [0.0; 3] };
        let [w, slope, _] = self.wall.height(r);
        let cube = radius.abs().powi(3) - (radius * radius - r * r).powf(1.5);
        [radius.signum() * cube / 3.0 - 0.5 * radius * r * r, r * w, w + r * slope]
    }

    /// V \[mm³\].
    pub(super) fn volume(&self, at: impl Fn(usize) -> [f64; 2]) -> f64 {
        let ring = |column: usize| {
            let ([r0, z0], [r1, z1]) = (at(column), at(column + 1));
            (r1 - r0) * (2.0 * (r0 * z0 + r1 * z1) + r0 * z1 + r1 * z0) / 6.0
        };
        let sum: f64 = (0..self.rings).map(ring).sum();
        TAU * (sum - self.under(at(self.rings)[0])[0])
    }

    pub(super) fn energy(&self, at: impl Fn(usize) -> [f64; 2]) -> f64 {
        if self.kpa > 0.0 { self.kpa * self.volume(at) } else { 0.0 }
    }

    /// Gradient and Hessian of a ring's part by r₀, z₀, r₁, z₁; `None` beside the pocket.
    pub(super) fn ring(
        &self,
        column: usize,
        [r0, z0, r1, z1]: [f64; 4],
    ) -> Option<([f64; 4], [[f64; 4]; 4])> {
        if self.kpa <= 0.0 || column >= self.rings {
            return None;
        }
        let unit = self.kpa * TAU / 6.0;
        let (d, s) = (r1 - r0, 2.0 * (r0 * z0 + r1 * z1) + r0 * z1 + r1 * z0);
        // Derivatives of s, of d, and second ones of s.
        let of_s = [2.0 * z0 + z1, 2.0 * r0 + r1, 2.0 * z1 + z0, 2.0 * r1 + r0];
        let of_d = [-1.0, 0.0, 1.0, 0.0];
        let bend = [
            [0.0, 2.0, 0.0, 1.0],
            [2.0, 0.0, 1.0, 0.0],
            [0.0, 1.0, 0.0, 2.0],
            [1.0, 0.0, 2.0, 0.0],
        ];
        let mut gradient = [0, 1, 2, 3].map(|i: usize| unit * (of_d[i] * s + d * of_s[i]));
        let mut hessian = [0, 1, 2, 3].map(|i: usize| {
            [0, 1, 2, 3]
                .map(|j: usize| unit * (of_d[i] * of_s[j] + of_s[i] * of_d[j] + d * bend[i][j]))
        });
        if column + 1 == self.rings {
            let [_, first, second] = self.under(r1);
            gradient[2] -= self.kpa * TAU * first;
            hessian[2][2] -= self.kpa * TAU * second;
        }
        Some((gradient, hessian))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_s_derivatives_are_those_of_the_energy() {
        let suction = Suction { kpa: 1.7, rings: 3, wall: Wall { radius_mm: Some(130.0) } };
        let at = [[0.0, 30.0], [21.0, 27.0], [44.0, 11.0], [66.0, -14.0]];
        let energy = |x: &[[f64; 2]; 4]| suction.energy(|column| x[column]);
        let slopes = |x: &[[f64; 2]; 4]| {
            let mut sum = [[0.0; 2]; 4];
            for column in 0..3 {
                let [a, b] = [x[column], x[column + 1]];
                let (pull, _) = suction.ring(column, [a[0], a[1], b[0], b[1]]).unwrap();
                for k in 0..2 {
                    sum[column][k] += pull[k];
                    sum[column + 1][k] += pull[2 + k];
                }
            }
            sum
        };
        let step = 1e-4;
        for (column, k) in (0..8).map(|i| (i / 2, i % 2)) {
            let moved = |sign: f64| {
                let mut moved = at;
                moved[column][k] += sign * step;
                moved
            };
            let slope = (energy(&moved(1.0)) - energy(&moved(-1.0))) / (2.0 * step);
            let own = slopes(&at)[column][k];
            assert!((slope - own).abs() < 1e-6 * (1.0 + own.abs()), "{column} {k}: {slope} {own}");
        }
        let [a, b] = [at[2], at[3]];
        let of = |x: [f64; 4]| suction.ring(2, x).unwrap();
        let here = [a[0], a[1], b[0], b[1]];
        for i in 0..4 {
            let moved = |sign: f64| {
                let mut moved = here;
                moved[i] += sign * step;
                of(moved).0
            };
            let (low, high) = (moved(-1.0), moved(1.0));
            for j in 0..4 {
                let bend = (high[j] - low[j]) / (2.0 * step);
                assert!((bend - of(here).1[i][j]).abs() < 1e-6, "{i} {j}");
            }
        }
    }
}

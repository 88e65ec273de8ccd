//! The elastic attachment of the inner face beyond the pocket: isotropic springs to the place at rest.
//!
//! The stiffness per area rises linearly from zero at the pocket's edge over the width of a ramp. The energy is
//! ½∫k|u|² of the bilinear displacement of each cell: lumped to the nodes the attachment would be too stiff at the
//! pocket's edge, where a lifted node feels its nearly unmoved neighbours.

use crate::mesh::{Attachment, Pocket};

/// Pairs of a cell's corners, counter-clockwise: (0, 0), (0, 1), …, (3, 3).
pub(crate) const PAIRS: [[usize; 2]; 10] =
    [[0, 0], [0, 1], [0, 2], [0, 3], [1, 1], [1, 2], [1, 3], [2, 2], [2, 3], [3, 3]];

/// ∫NₐN_b over a cell of side 1, for [`PAIRS`].
const CONSTANT: [f64; 10] = [4., 2., 1., 2., 4., 2., 1., 4., 2., 4.];
const PER_CONSTANT: f64 = 1.0 / 36.0;

/// Points of the quadrature in each direction where the stiffness varies.
const POINTS: usize = 8;

impl Attachment {
    /// Stiffness per area at a distance beyond the pocket's edge \[kPa/mm\].
    #[must_use]
    pub fn stiffness(&self, beyond_mm: f64) -> f64 {
        let ramp = (beyond_mm / self.ramp_mm).clamp(0.0, 1.0);
        self.stiffness_kpa_per_mm * ramp
    }

    /// ∫k NₐN_b over the cell whose least corner is at (x, y), in units of the side's square, for [`PAIRS`] \[kPa/mm\];
    /// `None` where the stiffness is zero.
    pub(crate) fn integrals(
        &self,
        pocket: Pocket,
        [x, y]: [f64; 2],
        side: f64,
    ) -> Option<[f64; 10]> {
        // The distances of the nearest and the farthest point.
        let near = |a: f64| if a > 0.0 { a } else { (-a - side).max(0.0) };
        let far = |a: f64| a.abs().max((a + side).abs());
        let (nearest, farthest) = (near(x).hypot(near(y)), far(x).hypot(far(y)));
        if farthest <= pocket.radius_mm {
            return None;
        }
        if nearest >= pocket.reach_mm() + self.ramp_mm {
            return Some(CONSTANT.map(|c| c * PER_CONSTANT * self.stiffness_kpa_per_mm));
        }
        let mut sum = [0.0; 10];
        for j in 0..POINTS {
            for i in 0..POINTS {
                let [s, t] = [i, j].map(|k| (k as f64 + 0.5) / POINTS as f64);
                let [x, y] = [x + s * side, y + t * side];
                let k = self.stiffness(pocket.beyond(x.hypot(y), y));
                let n = [(1. - s) * (1. - t), s * (1. - t), s * t, (1. - s) * t];
                for (sum, [a, b]) in sum.iter_mut().zip(PAIRS) {
                    *sum += k * n[a] * n[b];
                }
            }
        }
        Some(sum.map(|value| value / (POINTS * POINTS) as f64))
    }
}

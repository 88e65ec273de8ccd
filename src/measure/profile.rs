//! The profile: the sheet along +x from the pocket's centre.

use super::{PROFILE_POINTS, ProfilePoint};
use crate::sheet::Sheet;
use glam::{DVec2, DVec3};

/// 41 points, material radius 0 … pocket radius in equal steps. Positions by cubic interpolation
/// between the nodes, stretches from central differences (second order).
pub(super) fn along_x(sheet: &Sheet, x: &[DVec3]) -> Vec<ProfilePoint> {
    let n = sheet.nodes_per_side();
    let half = n / 2;
    let row = half * n;
    let (h, rest) = (sheet.spacing_mm(), sheet.rest());
    // Stretch along and across the row at its i-th node.
    let stretches = |i: usize| {
        let k = row + i;
        let along = if i + 1 < n {
            (x[k + 1] - x[k - 1]) / (2.0 * h)
        } else {
            (x[k] * 3.0 - x[k - 1] * 4.0 + x[k - 2]) / (2.0 * h)
        };
        let (up, down) = (k + n, k - n);
        let across = x[up].distance(x[down]) / rest[up].distance(rest[down]);
        (along.length(), across)
    };
    (0..PROFILE_POINTS)
        .map(|point| {
            let s = sheet.radius_mm() * point as f64 / (PROFILE_POINTS - 1) as f64;
            let place = s / h + half as f64;
            let low = (place.floor() as usize).clamp(1, n - 3);
            let (mut position, mut stretch) = (DVec3::ZERO, DVec2::ZERO);
            for (k, weight) in (low - 1..=low + 2).zip(cubic(place - low as f64)) {
                position += x[row + k] * weight;
                let (along, across) = stretches(k);
                stretch += DVec2::new(along, across) * weight;
            }
            ProfilePoint {
                s_mm: s,
                r_mm: position.truncate().length(),
                z_mm: position.z,
                stretch_meridional: stretch.x,
                stretch_hoop: stretch.y,
            }
        })
        .collect()
}

/// Lagrange weights of the nodes −1, 0, 1, 2 at t.
fn cubic(t: f64) -> [f64; 4] {
    [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ]
}

//! A torso by formula, with a known chest under its breasts.
//!
//! The chest is a stack of ellipses that narrows upwards and downwards, R₁ 156 mm across and R₂ about 800 mm along the body at the breasts. A
//! breast moves the points of the chest along the normal at its centre: over the plane of this normal the chest's heights stay known.

#![allow(dead_code, reason = "each test uses a part")]

use glam::DVec3;
use implant_preview_body::marks::{BreastMarks, Marks};
use implant_preview_body::surface::Surface;
use std::f64::consts::{PI, TAU};

/// Half-axes of the chest across and to the front \[mm\].
const HALVES: [f64; 2] = [148.0, 110.0];
/// Length over which the chest narrows \[mm\].
const LONG: f64 = 450.0;
/// Heights of the lower and the upper end over the breasts \[mm\].
const ENDS: [f64; 2] = [-300.0, 230.0];
/// Half-axes of a breast \[mm\].
pub(crate) const BREAST: [f64; 2] = [62.0, 68.0];
/// Angle of a breast's centre on the ellipse.
const ANGLE: f64 = 0.62;

/// The point of the chest at an angle from the front towards the left, and a height \[mm\].
fn chest(angle: f64, y: f64) -> DVec3 {
    let narrow = 1.0 - (y / LONG).powi(2);
    DVec3::new(HALVES[0] * angle.sin() * narrow, y, HALVES[1] * angle.cos() * narrow)
}

/// Centre, unit vector to the patient's left along the skin, and normal of the left breast.
fn breast_axes() -> (DVec3, DVec3, DVec3) {
    let left = DVec3::new(HALVES[0] * ANGLE.cos(), 0.0, -HALVES[1] * ANGLE.sin()).normalize();
    (chest(ANGLE, 0.0), left, left.cross(DVec3::Y))
}

/// Height of a breast over the chest \[mm\] at a share of its half-axes, for the projection of the breast.
fn bump(x: f64, y: f64, projection: f64) -> f64 {
    projection * (1.0 - (x / BREAST[0]).powi(2) - (y / BREAST[1]).powi(2)).max(0.0).powi(2)
}

/// Volume of a breast \[ml\].
pub(crate) fn volume_ml(projection: f64) -> f64 {
    projection * PI * BREAST[0] * BREAST[1] / 3e3
}

/// The skin over a point of the chest.
fn skin(point: DVec3, projection: f64) -> DVec3 {
    let sign = if point.x < 0.0 { -1.0 } else { 1.0 };
    let mirror = DVec3::new(sign, 1.0, 1.0);
    let (center, left, normal) = breast_axes();
    let from = point * mirror - center;
    // The back is far below the plane of the breast.
    let is_front = from.dot(normal) > -60.0;
    let height = if is_front { bump(from.dot(left), from.y, projection) } else { 0.0 };
    point + normal * mirror * height
}

/// A torso with breasts of a projection \[mm\], closed, `around` × `along` quads.
pub(crate) fn torso(projection: f64, around: usize, along: usize) -> Surface {
    let mut surface = Surface::default();
    for row in 0..=along {
        let y = ENDS[0] + (ENDS[1] - ENDS[0]) * row as f64 / along as f64;
        // Half a step off the midline, so that the torso has no vertices on it.
        let angle = |k: usize| TAU * (k as f64 + 0.5) / around as f64 - PI;
        surface.positions.extend((0..around).map(|k| skin(chest(angle(k), y), projection)));
    }
    let node = |row: usize, k: usize| (row * around + k % around) as u32;
    for row in 0..along {
        for k in 0..around {
            let [a, b, c, d] =
                [node(row, k), node(row, k + 1), node(row + 1, k + 1), node(row + 1, k)];
            surface.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    for (row, y) in [(0, ENDS[0]), (along, ENDS[1])] {
        let middle = surface.positions.len() as u32;
        surface.positions.push(DVec3::new(0.0, y, 0.0));
        surface.triangles.extend((0..around).map(|k| {
            let (a, b) = (node(row, k), node(row, k + 1));
            if row == 0 { [b, a, middle] } else { [a, b, middle] }
        }));
    }
    surface
}

/// The point of the skin at a place of the left breast's plane \[mm\], on the chest by Newton's method.
pub(crate) fn on_breast(x: f64, y: f64, projection: f64) -> DVec3 {
    let (center, left, normal) = breast_axes();
    let mut angle = ANGLE;
    for _ in 0..20 {
        let off = |angle: f64| (chest(angle, y) - center).dot(left) - x;
        angle -= off(angle) * 1e-6 / (off(angle + 1e-6) - off(angle));
    }
    chest(angle, y) + normal * bump(x, y, projection)
}

/// The marks of a torso.
pub(crate) fn marks(projection: f64) -> Marks {
    let at = |x: f64, y: f64| on_breast(x, y, projection);
    let breast = BreastMarks {
        fold: at(0.0, -BREAST[1]),
        upper: at(0.0, BREAST[1]),
        medial: at(-BREAST[0], 0.0),
        lateral: at(BREAST[0], 0.0),
        implant_centre: Some(at(0.0, 0.0)),
    };
    let mirrored = |p: DVec3| DVec3::new(-p.x, p.y, p.z);
    let nipple = at(0.0, 0.0);
    let other = BreastMarks {
        fold: mirrored(breast.fold),
        upper: mirrored(breast.upper),
        medial: mirrored(breast.medial),
        lateral: mirrored(breast.lateral),
        implant_centre: breast.implant_centre.map(mirrored),
    };
    Marks {
        sternal_notch: chest(0.0, 150.0),
        navel: chest(0.0, -230.0),
        nipples: [nipple, mirrored(nipple)],
        breasts: [Some(breast), Some(other)],
    }
}

//! Lines of a torso behind the tissue, which show where the breast lies: no patient's shape, and no part of the model.

use glam::{Vec2, Vec3, vec2};
use std::f32::consts::TAU;

/// Distance of the pocket's centre from the midline \[mm\].
const MIDLINE_MM: f32 = 100.0;
/// Height above the pocket's centre, half width and half depth of a section of the trunk \[mm\]: from the hips over the shoulders to
/// the neck.
const SECTIONS: [[f32; 3]; 11] = [
    [-310.0, 128.0, 90.0],
    [-210.0, 132.0, 96.0],
    [-120.0, 146.0, 106.0],
    [-40.0, 158.0, 114.0],
    [40.0, 164.0, 115.0],
    [110.0, 176.0, 100.0],
    [145.0, 182.0, 78.0],
    [168.0, 150.0, 62.0],
    [185.0, 92.0, 56.0],
    [202.0, 62.0, 56.0],
    [285.0, 56.0, 58.0],
];
/// Exponent of a section |x/w|ⁿ + |z/d|ⁿ = 1: flatter in front than an ellipse.
const EXPONENT: f32 = 2.6;
/// Points between two points of a line.
const STEPS: u32 = 8;

/// Outlines of one side \[mm\], from the midline and above the pocket's centre: neck, shoulder and arm; flank and waist; inner arm.
const OUTLINES: [&[[f32; 2]]; 3] = [
    &[
        [52.0, 262.0],
        [54.0, 215.0],
        [70.0, 192.0],
        [120.0, 176.0],
        [172.0, 158.0],
        [200.0, 128.0],
        [212.0, 80.0],
        [214.0, 0.0],
        [210.0, -90.0],
        [206.0, -170.0],
    ],
    &[
        [176.0, 78.0],
        [166.0, 30.0],
        [158.0, -40.0],
        [146.0, -120.0],
        [134.0, -205.0],
        [138.0, -260.0],
        [150.0, -310.0],
    ],
    &[[176.0, 78.0], [178.0, 0.0], [176.0, -90.0], [172.0, -170.0]],
];
/// Lines of one side on the front \[mm\]: collarbone, fold below the breast.
const FRONT: [&[[f32; 2]]; 2] = [
    &[[10.0, 150.0], [60.0, 158.0], [110.0, 168.0], [150.0, 160.0]],
    &[[34.0, -28.0], [60.0, -62.0], [100.0, -74.0], [138.0, -56.0], [152.0, -10.0], [150.0, 30.0]],
];
/// The breastbone, and the chin with its distance before the axis \[mm\].
const BREASTBONE: [[f32; 2]; 3] = [[0.0, 140.0], [0.0, 40.0], [0.0, -60.0]];
const CHIN: [[f32; 2]; 5] =
    [[-46.0, 285.0], [-30.0, 252.0], [0.0, 240.0], [30.0, 252.0], [46.0, 285.0]];
const CHIN_BEFORE_MM: f32 = 60.0;
/// Height of the navel and its half width and half height \[mm\].
const NAVEL: (f32, Vec2) = (-222.0, vec2(7.0, 9.0));

/// The lines \[mm\] in the coordinates of the tissue: x to the side, y to the head, z away from the wall. The chest's front touches
/// the wall at the pocket's centre.
pub fn lines() -> Vec<Vec<Vec3>> {
    let mut lines = Vec::new();
    for side in [-1.0, 1.0] {
        let of = |points: &[[f32; 2]]| -> Vec<Vec2> {
            smooth(points).into_iter().map(|p| vec2(side * p.x, p.y)).collect()
        };
        lines.extend(OUTLINES.map(|outline| before_axis(of(outline), 0.0)));
        lines.extend(FRONT.map(|line| on_front(of(line))));
    }
    lines.push(on_front(smooth(&BREASTBONE)));
    lines.push(before_axis(smooth(&CHIN), CHIN_BEFORE_MM));
    let (height, size) = NAVEL;
    let around = |k: u32| Vec2::from_angle(TAU * k as f32 / 12.0) * size + vec2(0.0, height);
    lines.push(on_front((0..=12).map(around).collect()));
    lines
}

/// A curve through points (Catmull–Rom).
fn smooth(points: &[[f32; 2]]) -> Vec<Vec2> {
    let at = |k: usize| Vec2::from(points[k.min(points.len() - 1)]);
    let mut curve = Vec::new();
    for k in 0..points.len() - 1 {
        let [a, b, c, d] = [at(k.saturating_sub(1)), at(k), at(k + 1), at(k + 2)];
        let point = |step: u32| {
            let t = step as f32 / STEPS as f32;
            let slope = (c - a) + t * (2.0 * a - 5.0 * b + 4.0 * c - d);
            b + 0.5 * t * (slope + t * t * (3.0 * (b - c) + d - a))
        };
        curve.extend((0..STEPS).map(point));
    }
    curve.push(at(points.len() - 1));
    curve
}

/// Points at a distance before the torso's axis \[mm\].
fn before_axis(points: Vec<Vec2>, distance: f32) -> Vec<Vec3> {
    points.into_iter().map(|p| Vec3::new(p.x - MIDLINE_MM, p.y, axis() + distance)).collect()
}

/// Points on the front of the trunk.
fn on_front(points: Vec<Vec2>) -> Vec<Vec3> {
    let at = |p: Vec2| Vec3::new(p.x - MIDLINE_MM, p.y, axis() + front(section(p.y), p.x));
    points.into_iter().map(at).collect()
}

/// Height of the torso's axis over the wall \[mm\], below 0.
fn axis() -> f32 {
    -front(section(0.0), MIDLINE_MM)
}

/// Half width and half depth at a height, between two sections \[mm\].
fn section(height: f32) -> [f32; 2] {
    let after = SECTIONS.partition_point(|section| section[0] < height);
    let after = after.clamp(1, SECTIONS.len() - 1);
    let [[y0, w0, d0], [y1, w1, d1]] = [SECTIONS[after - 1], SECTIONS[after]];
    let t = ((height - y0) / (y1 - y0)).clamp(0.0, 1.0);
    [w0 + t * (w1 - w0), d0 + t * (d1 - d0)]
}

/// Distance of the front of a section from the axis at a distance from the midline \[mm\].
fn front([width, depth]: [f32; 2], distance: f32) -> f32 {
    depth * (1.0 - (distance / width).abs().powf(EXPONENT)).max(0.0).powf(1.0 / EXPONENT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_touches_the_wall_at_the_pocket_and_both_sides_are_alike() {
        assert!((axis() + front(section(0.0), MIDLINE_MM)).abs() < 1e-4);
        let lines = lines();
        assert!(lines.iter().flatten().all(|p| p.is_finite() && p.z < 30.0));
        let of_a_side = OUTLINES.len() + FRONT.len();
        for (left, right) in lines[..of_a_side].iter().zip(&lines[of_a_side..]) {
            for (a, b) in left.iter().zip(right) {
                assert!((a.x + b.x + 2.0 * MIDLINE_MM).abs() < 1e-3 && (a.y - b.y).abs() < 1e-3);
            }
        }
    }

    #[test]
    fn a_curve_goes_through_its_points_and_the_parts_lie_from_the_navel_to_the_chin() {
        let points = FRONT[1];
        let curve = smooth(points);
        for point in points {
            assert!(curve.iter().any(|p| p.distance(Vec2::from(*point)) < 1e-3), "{point:?}");
        }
        let lines = lines();
        let heights = |line: &[Vec3]| {
            line.iter().fold([f32::MAX, f32::MIN], |[a, b], p| [a.min(p.y), b.max(p.y)])
        };
        let [.., breastbone, chin, navel] = &lines[..] else { panic!("lines") };
        let [navel, bone, chin] = [navel, breastbone, chin].map(|line| heights(line));
        assert!(navel[1] < bone[0] && bone[1] < chin[0], "{navel:?} {bone:?} {chin:?}");
        // The fold of the other breast is below that breast's middle, beside the tissue.
        let fold = &lines[OUTLINES.len() + 1];
        assert!(heights(fold)[0] < -60.0 && fold.iter().all(|p| p.x < -120.0), "{fold:?}");
    }
}

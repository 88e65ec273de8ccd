//! Lines of a torso behind the tissue, which show where the breast lies: no patient's shape, and no part of the model.

use glam::Vec3;
use std::f32::consts::PI;

/// Distance of the pocket's centre from the midline \[mm\].
const MIDLINE_MM: f32 = 100.0;
/// Height above the pocket's centre, half width and half depth of a section \[mm\]: from the waist over shoulders to the neck.
const SECTIONS: [[f32; 3]; 11] = [
    [-270.0, 132.0, 92.0],
    [-190.0, 138.0, 98.0],
    [-110.0, 150.0, 108.0],
    [-40.0, 158.0, 114.0],
    [40.0, 164.0, 115.0],
    [110.0, 178.0, 100.0],
    [145.0, 186.0, 78.0],
    [168.0, 158.0, 62.0],
    [185.0, 96.0, 56.0],
    [202.0, 62.0, 56.0],
    [250.0, 58.0, 58.0],
];
/// Sections that are drawn as lines.
const RINGS: [usize; 5] = [0, 1, 2, 3, 9];
/// Exponent of a section |x/w|ⁿ + |z/d|ⁿ = 1: flatter in front than an ellipse.
const EXPONENT: f32 = 2.6;
/// Points of half a section.
const POINTS: usize = 33;

/// The lines \[mm\] in the coordinates of the tissue: x to the side, y to the head, z away from the wall. The chest's front touches
/// the wall at the pocket's centre.
pub fn lines() -> Vec<Vec<Vec3>> {
    let rings = RINGS.map(|k| arc(SECTIONS[k]));
    let side = |sign: f32| {
        let point = |[y, width, _]: [f32; 3]| Vec3::new(sign * width - MIDLINE_MM, y, axis());
        SECTIONS.map(point).to_vec()
    };
    rings.into_iter().chain([side(-1.0), side(1.0)]).collect()
}

/// Height of the torso's axis over the wall \[mm\], below 0.
fn axis() -> f32 {
    let chest = SECTIONS[4];
    -front(chest, MIDLINE_MM)
}

/// Distance of the front of a section from the axis at a distance from the midline \[mm\].
fn front([_, width, depth]: [f32; 3], distance: f32) -> f32 {
    depth * (1.0 - (distance / width).abs().powf(EXPONENT)).max(0.0).powf(1.0 / EXPONENT)
}

/// The front half of a section.
fn arc(section: [f32; 3]) -> Vec<Vec3> {
    let [y, width, _] = section;
    let point = |k: usize| {
        let x = width * (PI * k as f32 / (POINTS - 1) as f32).cos();
        Vec3::new(x - MIDLINE_MM, y, axis() + front(section, x))
    };
    (0..POINTS).map(point).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_touches_the_wall_at_the_pocket_and_both_sides_are_alike() {
        assert!((axis() + front(SECTIONS[4], MIDLINE_MM)).abs() < 1e-4);
        let lines = lines();
        assert!(lines.iter().flatten().all(|p| p.is_finite() && p.z < 30.0));
        for line in &lines[..RINGS.len()] {
            for (a, b) in line.iter().zip(line.iter().rev()) {
                assert!((a.x + b.x + 2.0 * MIDLINE_MM).abs() < 1e-3 && (a.z - b.z).abs() < 1e-3);
            }
        }
        // The head is up.
        let [left, right] = [&lines[RINGS.len()], &lines[RINGS.len() + 1]];
        assert!(left.last().unwrap().y > 200.0 && right.windows(2).all(|p| p[0].y < p[1].y));
    }
}

//! The chest wall as drawn: the wall under the patch, and its tangents beyond.

use crate::camera::Ball;
use glam::{DVec2, DVec3, Vec3};
use implant_preview_core::mesh::Chest;
use implant_preview_core::solve::Problem;

/// The direction from a point of the wall outwards that is nearest to a direction over the plane.
pub(super) fn outwards(normal: Vec3, direction: Vec3) -> Vec3 {
    (direction - normal * normal.dot(direction)).normalize_or_zero()
}

/// The point of the wall at a place \[mm\], and the normal; beyond the patch's radius on the tangent to the wall there.
#[must_use]
pub fn at(chest: &Chest, patch_radius_mm: f64, place: DVec2) -> (Vec3, Vec3) {
    let within = place.clamp_length_max(patch_radius_mm);
    let (foot, normal): (DVec3, DVec3) = chest.foot_and_normal(within);
    let (foot, normal) = (foot.as_vec3(), normal.as_vec3());
    let beyond = (place - within).extend(0.0).as_vec3();
    (foot + outwards(normal, beyond) * beyond.length(), normal)
}

/// The ball around tissue and wall, for a camera.
#[must_use]
pub fn ball(problem: &Problem) -> Ball {
    let stack: f64 = problem.materials.iter().map(|m| m.thickness_mm).sum();
    let radius = problem.sheet().radius_mm();
    let block = radius + (0.2 * radius).max(2.0 * stack);
    // The rim of the drawn wall across and along the body.
    let chest = &problem.obstacle.wall.0;
    let height = |place: DVec2| at(chest, radius, block * place).0.z;
    let lowest = [DVec2::X, DVec2::Y].map(height).into_iter().fold(0.0, f32::min);
    let radius_mm = block.max(1.15 * problem.obstacle.dome.projection()) as f32;
    Ball { radius_mm, middle_mm: 0.5 * lowest }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_drawn_wall_is_the_wall_and_beyond_the_patch_its_tangent() {
        let radius = 120.0_f64;
        for chest in [
            Chest::Flat,
            Chest::Curved { across_mm: radius, along_mm: radius },
            Chest::Curved { across_mm: -radius, along_mm: f64::INFINITY },
        ] {
            for k in 0..40 {
                let place = DVec2::from_angle(0.7 * f64::from(k)) * (3.2 * f64::from(k));
                let (point, normal) = at(&chest, 130.0, place);
                let height = chest.height(point.truncate().as_dvec2()) as f32;
                assert!((point.z - height).abs() < 1e-2, "{point} {height}");
                assert!((normal.length() - 1.0).abs() < 1e-5);
            }
            // A step over the patch's border changes the point by as much.
            let [a, b] = [129.999, 130.001].map(|s| at(&chest, 130.0, DVec2::new(s, 0.0)).0);
            assert!((a.distance(b) - 0.002).abs() < 1e-3, "{a} {b}");
        }
        let (point, normal) = at(&Chest::Flat, 130.0, DVec2::new(0.0, 150.0));
        assert_eq!((point, normal), (Vec3::new(0.0, 150.0, 0.0), Vec3::Z));
    }
}

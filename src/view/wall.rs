//! The chest wall as drawn: the wall under the patch, and its tangents beyond.

use crate::mesh::Chest;
use crate::view::color::WALL;
use crate::view::mesh::{Mesh, NO_VALUE, Vertex, quad_indices, vertex};
use glam::{DVec2, DVec3, Vec3};

/// Drawn thickness of the wall \[mm\].
const THICKNESS: f32 = 5.0;
/// Distance of the drawn wall below the tissue's clamped border \[mm\].
const BELOW: f32 = 0.05;
/// Circles of vertices, and vertices of a circle.
const RINGS: usize = 12;
const AROUND: usize = 128;

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

/// The wall within a radius \[mm\], with a rim.
#[must_use]
pub fn mesh(chest: &Chest, patch_radius_mm: f64, radius_mm: f32) -> Mesh {
    let on = |ring: usize, step: usize| {
        let angle = std::f64::consts::TAU * step as f64 / AROUND as f64;
        let radius = f64::from(radius_mm) * ring as f64 / RINGS as f64;
        let (foot, normal) = at(chest, patch_radius_mm, DVec2::from_angle(angle) * radius);
        (foot - normal * BELOW, normal)
    };
    let plain = |point: Vec3, normal: Vec3| vertex(point, normal, [-1.0; 2], NO_VALUE, WALL);
    let grid = (0..=RINGS).flat_map(|ring| (0..AROUND).map(move |step| (ring, step)));
    let mut vertices: Vec<Vertex> = grid
        .map(|(ring, step)| on(ring, step))
        .map(|(point, normal)| plain(point, normal))
        .collect();
    let index = |ring: usize, step: usize| (ring * AROUND + step % AROUND) as u32;
    let cells = (0..RINGS).flat_map(|ring| (0..AROUND).map(move |step| (ring, step)));
    let mut indices: Vec<u32> = cells
        .flat_map(|(ring, step)| {
            let [a, b] = [index(ring, step), index(ring, step + 1)];
            let [c, d] = [index(ring + 1, step), index(ring + 1, step + 1)];
            [a, c, d, a, d, b]
        })
        .collect();
    let rim: Vec<(Vec3, Vec3)> = (0..AROUND).map(|step| on(RINGS, step)).collect();
    for step in 0..AROUND {
        let ((a, up_a), (b, up_b)) = (rim[step], rim[(step + 1) % AROUND]);
        let [low_a, low_b] = [a - up_a * THICKNESS, b - up_b * THICKNESS];
        let [out_a, out_b] = [a, b].map(|p| outwards(up_a, p.with_z(0.0)));
        indices.extend(quad_indices(vertices.len() as u32));
        vertices.extend([
            plain(low_a, out_a),
            plain(low_b, out_b),
            plain(b, out_b),
            plain(a, out_a),
        ]);
    }
    Mesh { vertices, indices: std::sync::Arc::new(indices) }
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
            let drawn = mesh(&chest, 130.0, 156.0);
            for vertex in &drawn.vertices[..AROUND * (RINGS + 1)] {
                let (point, normal) =
                    (Vec3::from_slice(&vertex[..3]), Vec3::from_slice(&vertex[3..6]));
                assert!((normal.length() - 1.0).abs() < 1e-5);
                let height = chest.height(point.truncate().as_dvec2()) as f32;
                let is_under_patch = point.truncate().length() < 90.0;
                assert!(!is_under_patch || (point.z - height).abs() < 0.2, "{point} {height}");
            }
            // A step over the patch's border changes the point by as much.
            let [a, b] = [129.999, 130.001].map(|s| at(&chest, 130.0, DVec2::new(s, 0.0)).0);
            assert!((a.distance(b) - 0.002).abs() < 1e-3, "{a} {b}");
        }
        let (point, normal) = at(&Chest::Flat, 130.0, DVec2::new(0.0, 150.0));
        assert_eq!((point, normal), (Vec3::new(0.0, 150.0, 0.0), Vec3::Z));
    }
}

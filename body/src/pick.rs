//! Points of a surface: where a ray meets it, which point of it is nearest. One pass over all triangles, no search tree.

use crate::surface::Surface;
use glam::{DVec2, DVec3};

/// A point of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnSurface {
    /// The point \[mm\].
    pub point: DVec3,
    /// Index of its triangle.
    pub triangle: u32,
    /// Unit normal of the triangle.
    pub normal: DVec3,
}

impl OnSurface {
    fn new(surface: &Surface, point: DVec3, triangle: u32) -> Self {
        let [a, b, c] = surface.corners(surface.triangles[triangle as usize]);
        Self { point, triangle, normal: (b - a).cross(c - a).normalize_or_zero() }
    }
}

/// The first point of a surface on a ray, on either side of a triangle; `None` for a ray beside the surface (Woop, Benthin and Wald 2013: no
/// ray passes between two triangles of one edge or corner).
#[must_use]
pub fn first_hit(surface: &Surface, origin: DVec3, direction: DVec3) -> Option<OnSurface> {
    let along = direction.abs().max_position();
    let [i, j] = [1, 2].map(|k| (along + k) % 3);
    let slope = DVec2::new(direction[i], direction[j]) / direction[along];
    // Along the ray: a corner has one place, the same in all of its triangles.
    let sheared = |corner: DVec3| {
        let from = corner - origin;
        (DVec2::new(from[i], from[j]) - slope * from[along], from[along] / direction[along])
    };
    let (mut nearest, mut hit) = (f64::INFINITY, None);
    for (index, triangle) in surface.triangles.iter().enumerate() {
        let [a, b, c] = surface.corners(*triangle).map(sheared);
        // Rounding makes a small area zero, of an edge's two triangles alike, but never changes its sign.
        let areas = [b.0.perp_dot(c.0), c.0.perp_dot(a.0), a.0.perp_dot(b.0)];
        if areas.iter().any(|area| *area < 0.0) && areas.iter().any(|area| *area > 0.0) {
            continue;
        }
        let [s, t, u] = areas;
        // A triangle along the ray has no finite way.
        let way = (s * a.1 + t * b.1 + u * c.1) / (s + t + u);
        if way >= 0.0 && way < nearest {
            (nearest, hit) = (way, Some(index as u32));
        }
    }
    hit.map(|index| OnSurface::new(surface, origin + direction * nearest, index))
}

/// The point of a surface that is nearest to a point; `None` for a surface without triangles.
#[must_use]
pub fn snap(surface: &Surface, point: DVec3) -> Option<OnSurface> {
    let [found] = snap_all(surface, [point]);
    found
}

/// The points of a surface that are nearest to each of some points.
#[must_use]
pub fn snap_all<const N: usize>(surface: &Surface, points: [DVec3; N]) -> [Option<OnSurface>; N] {
    let mut nearest = [(f64::INFINITY, DVec3::ZERO, u32::MAX); N];
    for (index, triangle) in surface.triangles.iter().enumerate() {
        let corners = surface.corners(*triangle);
        let (low, high) = corners
            .iter()
            .skip(1)
            .fold((corners[0], corners[0]), |(low, high), p| (low.min(*p), high.max(*p)));
        for (point, found) in points.iter().zip(&mut nearest) {
            if point.distance_squared(point.clamp(low, high)) < found.0 {
                let on = on_triangle(corners, *point);
                let distance = on.distance_squared(*point);
                if distance < found.0 {
                    *found = (distance, on, index as u32);
                }
            }
        }
    }
    nearest
        .map(|(_, point, index)| (index != u32::MAX).then(|| OnSurface::new(surface, point, index)))
}

/// The point of a triangle that is nearest to a point (Ericson, Real-Time Collision Detection, 5.1.5).
fn on_triangle([a, b, c]: [DVec3; 3], point: DVec3) -> DVec3 {
    let (u, v) = (b - a, c - a);
    let [from_a, from_b, from_c] = [point - a, point - b, point - c];
    let [a_u, a_v] = [u.dot(from_a), v.dot(from_a)];
    if a_u <= 0.0 && a_v <= 0.0 {
        return a;
    }
    let [b_u, b_v] = [u.dot(from_b), v.dot(from_b)];
    if b_u >= 0.0 && b_v <= b_u {
        return b;
    }
    let to_c = a_u * b_v - b_u * a_v;
    if to_c <= 0.0 && a_u >= 0.0 && b_u <= 0.0 {
        return a + u * (a_u / (a_u - b_u));
    }
    let [c_u, c_v] = [u.dot(from_c), v.dot(from_c)];
    if c_v >= 0.0 && c_u <= c_v {
        return c;
    }
    let to_b = c_u * a_v - a_u * c_v;
    if to_b <= 0.0 && a_v >= 0.0 && c_v <= 0.0 {
        return a + v * (a_v / (a_v - c_v));
    }
    let to_a = b_u * c_v - c_u * b_v;
    let (along, rest) = (b_v - b_u, c_u - c_v);
    if to_a <= 0.0 && along >= 0.0 && rest >= 0.0 {
        return b + (c - b) * (along / (along + rest));
    }
    let sum = to_a + to_b + to_c;
    a + u * (to_b / sum) + v * (to_c / sum)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::torso;

    #[test]
    fn the_nearest_point_is_that_of_all_triangles_and_lies_on_the_surface() {
        let surface = torso::builtin().surface;
        let mut random = fastrand::Rng::with_seed(4);
        for _ in 0..20 {
            let index = random.usize(0..surface.triangles.len());
            let [a, b, c] = surface.corners(surface.triangles[index]);
            let normal = (b - a).cross(c - a).normalize();
            let on = a * 0.2 + b * 0.5 + c * 0.3;
            let found = snap(&surface, on + normal * 0.4).unwrap();
            assert!(found.point.distance(on + normal * 0.4) <= 0.4 + 1e-12);
            // The nearest of many points of a triangle is no nearer.
            let point = on + normal * random.f64() * 30.0;
            let found = snap(&surface, point).unwrap();
            let least = surface.triangles.iter().flat_map(|triangle| {
                let [a, b, c] = surface.corners(*triangle);
                [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [0.3, 0.3, 0.4], [0.5, 0.5, 0.0]]
                    .map(|[x, y, z]| (a * x + b * y + c * z).distance(point))
            });
            let least = least.fold(f64::INFINITY, f64::min);
            assert!(found.point.distance(point) <= least + 1e-12);
        }
        assert_eq!(snap(&Surface::default(), DVec3::ZERO), None);
    }

    #[test]
    fn a_ray_hits_the_first_triangle() {
        let torso = torso::builtin();
        let nipple = torso.marks.nipples[0];
        let hit = first_hit(&torso.surface, nipple + DVec3::Z * 300.0, -DVec3::Z * 2.0).unwrap();
        assert!(hit.point.distance(nipple) < 1.0 && hit.normal.z > 0.5, "{hit:?}");
        let behind = first_hit(&torso.surface, nipple + DVec3::Z * 300.0, DVec3::Z);
        assert_eq!(behind, None);
    }

    #[test]
    fn a_ray_at_an_edge_or_a_corner_of_a_closed_surface_hits() {
        // An octahedron, turned and stretched, each of its triangles cut into 64.
        let mut random = fastrand::Rng::with_seed(6);
        let turn = glam::DMat3::from_euler(glam::EulerRot::XYZ, 0.4, -0.7, 1.3);
        let place = |p: DVec3| turn * (p.normalize() * DVec3::new(90.0, 140.0, 60.0));
        let mut faces: Vec<[DVec3; 3]> = (0..8)
            .map(|k| [1, 2, 4].map(|bit| if k & bit == 0 { 1.0 } else { -1.0 }))
            .map(|[x, y, z]| [DVec3::X * x, DVec3::Y * y, DVec3::Z * z])
            .collect();
        for _ in 0..3 {
            let cut = |[a, b, c]: [DVec3; 3]| {
                let [ab, bc, ca] = [a + b, b + c, c + a].map(|sum| sum * 0.5);
                [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
            };
            faces = faces.into_iter().flat_map(cut).collect();
        }
        let positions = faces.iter().flatten().map(|p| place(*p)).collect();
        let triangles = (0..faces.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect();
        let surface = Surface { positions, triangles, colors: None };
        for triangle in &surface.triangles {
            let [a, b, c] = surface.corners(*triangle);
            for (from, to) in [(a, b), (b, c), (c, a)] {
                let origin = DVec3::from([0; 3].map(|_| 30.0 * (random.f64() - 0.5)));
                for aim in [from, 0.5 * (from + to), from.lerp(to, random.f64())] {
                    let hit = first_hit(&surface, origin, aim - origin);
                    assert!(hit.is_some_and(|hit| hit.point.distance(aim) < 1e-9), "{hit:?}");
                }
            }
        }
        // A ray along an axis through the middle of an edge, exactly.
        let [low, high] = [0.0, 10.0];
        let positions = [(low, low), (high, low), (high, high), (low, high)];
        let positions = positions.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
        let surface = Surface { positions, triangles: vec![[0, 1, 2], [0, 2, 3]], colors: None };
        for (x, is_hit) in [(0.0, true), (5.0, true), (10.0, true), (10.001, false)] {
            let hit = first_hit(&surface, DVec3::new(x, x, 40.0), -DVec3::Z);
            assert_eq!(hit.is_some(), is_hit, "{x}");
        }
    }
}

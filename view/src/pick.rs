//! Picking: the target under the pointer and its values.

use crate::body::Body;
use crate::camera::Ray;
use crate::section::{CapTriangle, Opening, Section};
use glam::Vec3;
use implant_preview_core::contact::Obstacle;

/// The first intersection of a ray of sight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Position \[mm\].
    pub point: Vec3,
    /// Target at the position.
    pub target: Target,
}

/// A target under the pointer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Target {
    /// A point of the sheet: three nodes with their weights (they sum to 1).
    Sheet([(usize, f32); 3]),
    /// Tissue around the pocket, without simulation.
    Ring,
    /// A cut face through this layer, counted from the skin.
    Cut(usize),
    /// The implant.
    Implant,
}

impl Target {
    /// A nodal value at the point; `None` off the sheet.
    #[must_use]
    pub fn value(&self, values: &[f32]) -> Option<f32> {
        match self {
            Self::Sheet(nodes) => {
                nodes.iter().map(|&(k, w)| values.get(k).map(|v| v * w)).sum::<Option<f32>>()
            }
            _ => None,
        }
    }
}

/// Step of the search for the wall along a ray \[mm\], and the depth below the wall's surface that is within it \[mm\].
const WALL_STEP_MM: f32 = 2.0;
const WITHIN_WALL_MM: f64 = 1.0;

/// The first intersection of a ray; `None` where the underside of the drawn tissue or of the wall is in front.
#[must_use]
pub fn pick(
    ray: &Ray,
    body: &Body,
    section: &Section,
    caps: &[CapTriangle],
    obstacle: &Obstacle,
) -> Option<Hit> {
    // `None` is a face seen from within the tissue.
    let mut nearest: Option<(f32, Option<Target>)> = None;
    let mut offer = |distance: f32, target: Option<Target>| {
        if nearest.is_none_or(|(d, _)| distance < d) {
            nearest = Some((distance, target));
        }
    };
    let (Some(outer), Some(inner)) = (body.levels.first(), body.levels.last()) else { return None };
    let is_open = section.opening != Opening::Closed;
    for (points, is_outer) in [(outer, true), (inner, false)] {
        for triangle in &body.triangles {
            let corners = triangle.map(|c| points[c as usize]);
            if let Some((distance, weights)) = ray_triangle(ray, corners)
                && !section.removes(ray.origin + ray.direction * distance)
            {
                let [a, b, c] = corners;
                let is_from_outside = (b - a).cross(c - a).dot(ray.direction) < 0.0;
                let is_seen = is_from_outside == is_outer && (is_outer || is_open);
                let on_sheet = triangle.iter().all(|&c| (c as usize) < body.node_columns);
                let target = if on_sheet {
                    Target::Sheet(std::array::from_fn(|k| (triangle[k] as usize, weights[k])))
                } else {
                    Target::Ring
                };
                offer(distance, is_seen.then_some(target));
            }
        }
    }
    for cap in caps {
        if let Some((distance, _)) = ray_triangle(ray, cap.corners.map(|corner| corner.position)) {
            offer(distance, Some(Target::Cut(cap.layer)));
        }
    }
    if let Some(distance) = ray_dome(ray, obstacle) {
        offer(distance, Some(Target::Implant));
    }
    let (distance, target) = nearest?;
    let target = target.filter(|_| !is_behind_wall(ray, distance, body, obstacle))?;
    Some(Hit { point: ray.origin + ray.direction * distance, target })
}

/// Does the wall stand between the eye and a distance along the ray, as below the edge of a curved chest?
fn is_behind_wall(ray: &Ray, distance: f32, body: &Body, obstacle: &Obstacle) -> bool {
    // From above no ray passes through the wall before the tissue.
    if ray.direction.z <= 0.0 {
        return false;
    }
    let steps = (2.0 * body.block_radius / WALL_STEP_MM) as usize;
    let points = (1..=steps).map(|k| distance - k as f32 * WALL_STEP_MM).take_while(|d| *d > 0.0);
    points.map(|d| ray.origin + ray.direction * d).any(|point| {
        let is_over = point.truncate().length() < body.block_radius;
        is_over && obstacle.wall.gap(point.as_dvec3()) < -WITHIN_WALL_MM
    })
}

/// Distance along the ray and barycentric weights (T. Möller and B. Trumbore, 1997).
pub(crate) fn ray_triangle(ray: &Ray, [a, b, c]: [Vec3; 3]) -> Option<(f32, [f32; 3])> {
    let (ab, ac) = (b - a, c - a);
    let p = ray.direction.cross(ac);
    let determinant = ab.dot(p);
    if determinant.abs() < 1e-9 {
        return None;
    }
    let from_a = ray.origin - a;
    let u = from_a.dot(p) / determinant;
    if !(0.0..=1.0).contains(&u) {
        return None;
    }
    let q = from_a.cross(ab);
    let v = ray.direction.dot(q) / determinant;
    if v < 0.0 || u + v > 1.0 {
        return None;
    }
    let distance = ac.dot(q) / determinant;
    (distance > 0.0).then_some((distance, [1.0 - u - v, u, v]))
}

/// Distance along the ray to the dome's surface above the wall.
fn ray_dome(ray: &Ray, Obstacle { dome, wall }: &Obstacle) -> Option<f32> {
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let distance = dome.ray_distance(origin, direction)?;
    let is_visible = distance > 0.0 && wall.gap(origin + direction * distance) >= 0.0;
    is_visible.then_some(distance as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::tests::both;
    use glam::Vec2;

    #[test]
    fn from_above_the_apex_is_picked_and_through_the_wedge_the_implant() {
        for (session, body) in both() {
            let obstacle = &session.problem().obstacle;
            let mut section = Section { opening: Opening::Closed, angle: 0.0, axis: Vec2::ZERO };
            let down = Ray { origin: Vec3::new(20.0, 3.0, 400.0), direction: -Vec3::Z };
            let hit = pick(&down, &body, &section, &[], obstacle).expect("tissue is there");
            assert!(matches!(hit.target, Target::Sheet(_)), "{hit:?}");
            let x: Vec<f32> = session.shape().iter().map(|p| p.x as f32).collect();
            let at = hit.target.value(&x).expect("a sheet point has values");
            assert!((at - 20.0).abs() < 8.0, "{at}");

            section.opening = Opening::Wedge;
            let caps = section.caps(&body);
            let hit = pick(&down, &body, &section, &caps, obstacle).expect("the implant is there");
            assert_eq!(hit.target, Target::Implant);
            assert!((hit.point.z - (55f32 * 55.0 - 409.0).sqrt()).abs() < 0.01);
        }
    }

    #[test]
    fn from_below_nothing_is_picked() {
        for (session, body) in both() {
            let obstacle = &session.problem().obstacle;
            for opening in [Opening::Closed, Opening::Wedge, Opening::Half] {
                let section = Section { opening, angle: 0.0, axis: Vec2::ZERO };
                let caps = section.caps(&body);
                let ring = session.problem().sheet().radius_mm() as f32 + 5.0;
                for x in [-ring, -40.0, -10.0, 10.0, 40.0, ring] {
                    let up = Ray { origin: Vec3::new(x, 4.0, -200.0), direction: Vec3::Z };
                    assert_eq!(
                        pick(&up, &body, &section, &caps, obstacle),
                        None,
                        "{x} {opening:?}"
                    );
                    let down = Ray { origin: Vec3::new(x, 4.0, 200.0), direction: -Vec3::Z };
                    let hit = pick(&down, &body, &section, &caps, obstacle);
                    assert!(
                        hit.is_some() || section.removes(Vec3::new(x, 4.0, 0.0)),
                        "{x} {opening:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_cut_face_has_its_layer_and_the_ring_has_no_values() {
        for (session, body) in both() {
            let obstacle = &session.problem().obstacle;
            let section = Section { opening: Opening::Half, angle: 0.0, axis: Vec2::ZERO };
            let caps = section.caps(&body);
            let apex = |level: usize| body.levels[level][16 * 33 + 16].z;
            for layer in [0, 1] {
                let height = 0.5 * (apex(layer) + apex(layer + 1));
                let ray = Ray { origin: Vec3::new(300.0, 0.5, height), direction: -Vec3::X };
                let hit = pick(&ray, &body, &section, &caps, obstacle).expect("a face is there");
                assert_eq!(hit.target, Target::Cut(layer));
            }
            let beside = -8.0 - session.problem().sheet().radius_mm() as f32;
            let down = Ray { origin: Vec3::new(beside, 0.0, 400.0), direction: -Vec3::Z };
            let hit = pick(&down, &body, &section, &caps, obstacle).expect("the ring is there");
            assert_eq!(hit.target, Target::Ring);
            assert_eq!(hit.target.value(&[0.0; 9]), None);
            let miss = Ray { origin: Vec3::new(500.0, 0.0, 400.0), direction: -Vec3::Z };
            assert_eq!(pick(&miss, &body, &section, &caps, obstacle), None);
        }
    }
}

//! The plane of symmetry of a body by its mirror image, and the directions in it that a trunk may have.
//!
//! First guesses are the principal axes of the surface's area and of its normals, and the axes of the file; each is refined by the reflection
//! that maps a sample of points best to the sample's tangent planes (iterated closest points). On a shape with 0.5 mm of noise, holes and
//! a stray piece the plane's normal is within 0.5°.

use crate::chest::solved;
use crate::surface::Surface;
use glam::{DMat3, DVec3};

/// Points of the sample: of guesses, of the refinement.
const POINTS: [usize; 2] = [300, 900];
/// Iterations: of guesses, of the refinement.
const ROUNDS: [usize; 2] = [3, 8];
/// Distance from a tangent plane beyond which a point has no part, and what it counts \[mm\].
const APART_MM: f64 = 20.0;
/// Least cosine between the normals of a point and of that to which it is mapped.
const ALIKE: f64 = 0.4;
/// Cosine beyond which two guesses are one.
const SAME: f64 = 0.97;
/// A second plane is kept up to this multiple of the least mean distance.
const SECOND: f64 = 2.0;

/// A point of the sample and its unit normal.
type Sample = (DVec3, DVec3);

/// The plane of a reflection.
#[derive(Clone, Copy, Debug)]
struct Plane {
    normal: DVec3,
    /// normal · x of its points \[mm\].
    offset: f64,
}

/// A place on the plane of symmetry, and axes x (across), y, z of a body, in the surface's coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pose {
    pub(super) origin: DVec3,
    pub(super) axes: DMat3,
}

/// The poses that a trunk may have, four of each plane; none for a surface without area. `orientation`: +1, or −1 for normals inwards.
pub(super) fn poses(surface: &Surface, triangles: &[u32], orientation: f64) -> Vec<Pose> {
    let Some(moments) = Moments::new(surface, triangles) else { return Vec::new() };
    let [few, many] =
        POINTS.map(|count| sample(surface, triangles, moments.area / count as f64, orientation));
    let [points, normals] = [moments.spread, moments.normals].map(eigenvectors);
    let mut guesses: Vec<DVec3> = Vec::with_capacity(9);
    let axes = |m: DMat3| [m.x_axis, m.y_axis, m.z_axis];
    for normal in [points, normals, DMat3::IDENTITY].into_iter().flat_map(axes) {
        if guesses.iter().all(|guess| guess.dot(normal).abs() < SAME) {
            guesses.push(normal);
        }
    }
    let guessed = guesses.into_iter().map(|normal| {
        let mut plane = Plane { normal, offset: normal.dot(moments.centroid) };
        (0..ROUNDS[0]).for_each(|_| plane = plane.refined(&few, &few));
        (plane.distance(&few, &few), plane)
    });
    let mut planes: Vec<(f64, Plane)> = guessed.collect();
    planes.sort_by(|a, b| a.0.total_cmp(&b.0));
    let best = planes.first().map_or((0.0, DVec3::ZERO), |(off, plane)| (*off, plane.normal));
    let kept = planes.iter().enumerate().filter(|(k, (off, plane))| {
        *k == 0 || *off < SECOND * best.0 && plane.normal.dot(best.1).abs() < SAME
    });
    let kept: Vec<Plane> = kept.map(|(_, (_, plane))| *plane).take(2).collect();
    let of = |mut plane: Plane| {
        (0..ROUNDS[1]).for_each(|_| plane = plane.refined(&few, &many));
        let normal = plane.normal;
        // The trunk is a tube: its axis is the direction that the fewest normals have.
        let side = normal.any_orthonormal_vector();
        let other = normal.cross(side);
        let [a, b, c] =
            [(side, side), (side, other), (other, other)].map(|(u, v)| u.dot(moments.normals * v));
        let angle = 0.5 * (2.0 * b).atan2(a - c);
        let front = side * angle.cos() + other * angle.sin();
        let origin = moments.centroid + normal * (plane.offset - normal.dot(moments.centroid));
        let head = front.cross(normal);
        [(head, front), (head, -front), (-head, front), (-head, -front)].map(|(head, front)| Pose {
            origin,
            axes: DMat3::from_cols(head.cross(front), head, front),
        })
    };
    kept.into_iter().flat_map(of).collect()
}

/// Sums over the area of a surface.
struct Moments {
    /// \[mm²\].
    area: f64,
    centroid: DVec3,
    /// Second moments of the points about the centroid, and those of the unit normals.
    spread: DMat3,
    normals: DMat3,
}

impl Moments {
    fn new(surface: &Surface, triangles: &[u32]) -> Option<Self> {
        let corners = |index: &u32| surface.corners(surface.triangles[*index as usize]);
        let (mut area, mut centroid) = (0.0, DVec3::ZERO);
        for [a, b, c] in triangles.iter().map(corners) {
            let own = 0.5 * (b - a).cross(c - a).length();
            area += own;
            centroid += (a + b + c) * (own / 3.0);
        }
        if area.is_nan() || area <= 0.0 {
            return None;
        }
        centroid /= area;
        let (mut spread, mut normals) = (DMat3::ZERO, DMat3::ZERO);
        let square = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
        for [a, b, c] in triangles.iter().map(corners) {
            let normal = (b - a).cross(c - a);
            let own = normal.length();
            if own > 0.0 {
                normals += square(normal) * (0.5 / own);
                spread += square((a + b + c) / 3.0 - centroid) * (0.5 * own);
            }
        }
        Some(Self { area, centroid, spread, normals })
    }
}

/// Points of the surface, one of each area \[mm²\], and their normals.
fn sample(surface: &Surface, triangles: &[u32], each: f64, orientation: f64) -> Vec<Sample> {
    let (mut found, mut left) = (Vec::new(), 0.5 * each);
    for index in triangles {
        let [a, b, c] = surface.corners(surface.triangles[*index as usize]);
        let normal = (b - a).cross(c - a);
        left -= 0.5 * normal.length();
        if left <= 0.0 {
            found.push(((a + b + c) / 3.0, normal.normalize_or_zero() * orientation));
            // A triangle of many samples has one.
            left = left.max(-each) + each;
        }
    }
    found
}

impl Plane {
    fn image(&self, point: DVec3) -> DVec3 {
        point - self.normal * (2.0 * (self.normal.dot(point) - self.offset))
    }

    /// For each point the distance of its image from the tangent plane of the nearest point, signed, and the normal there; `None` far away.
    fn distances<'a>(
        &self,
        of: &'a [Sample],
        to: &'a [Sample],
    ) -> impl Iterator<Item = (DVec3, Option<(f64, DVec3)>)> + use<'a> {
        let plane = *self;
        of.iter().map(move |(point, normal)| {
            let image = plane.image(*point);
            let turned = *normal - plane.normal * (2.0 * plane.normal.dot(*normal));
            let (mut nearest, mut found) = (f64::INFINITY, None);
            for sample in to {
                let distance = sample.0.distance_squared(image);
                if distance < nearest {
                    (nearest, found) = (distance, Some(sample));
                }
            }
            let hit = found.filter(|(_, normal)| normal.dot(turned) > ALIKE);
            let hit = hit.map(|(at, normal)| ((image - *at).dot(*normal), *normal));
            (*point, hit.filter(|(apart, _)| apart.abs() < APART_MM))
        })
    }

    /// Mean distance of the images from the surface \[mm\].
    fn distance(&self, of: &[Sample], to: &[Sample]) -> f64 {
        let distances = self.distances(of, to).map(|(_, hit)| hit.map_or(APART_MM, |h| h.0.abs()));
        distances.sum::<f64>() / of.len().max(1) as f64
    }

    /// The plane after a step of Gauss and Newton of the sum of the squared distances.
    fn refined(&self, of: &[Sample], to: &[Sample]) -> Self {
        let side = self.normal.any_orthonormal_vector();
        let other = self.normal.cross(side);
        let (mut matrix, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
        for (point, hit) in self.distances(of, to) {
            let Some((apart, normal)) = hit else { continue };
            let off = self.normal.dot(point) - self.offset;
            // By the tilt of the plane's normal \[1/100 mm\] and by its offset.
            let along =
                |way: DVec3| -2.0 * (self.normal * way.dot(point) + way * off).dot(normal) / 100.0;
            let row = [along(side), along(other), 2.0 * self.normal.dot(normal)];
            for i in 0..3 {
                right[i] -= row[i] * apart;
                (0..3).for_each(|j| matrix[i][j] += row[i] * row[j]);
            }
        }
        (0..3).for_each(|k| matrix[k][k] += 1e-3);
        let Some([a, b, offset]) = solved(matrix, right) else { return *self };
        let tilted = self.normal + (side * a + other * b).clamp_length_max(20.0) / 100.0;
        let length = tilted.length();
        Self { normal: tilted / length, offset: (self.offset + offset) / length }
    }
}

/// Eigenvectors of a symmetric matrix as columns (Jacobi's rotations).
fn eigenvectors(mut matrix: DMat3) -> DMat3 {
    let mut vectors = DMat3::IDENTITY;
    for (p, q) in [(0, 1), (0, 2), (1, 2)].into_iter().cycle().take(24) {
        let off = matrix.col(p)[q];
        if off.abs() < 1e-300 {
            continue;
        }
        let angle = 0.5 * (2.0 * off).atan2(matrix.col(q)[q] - matrix.col(p)[p]);
        let (sin, cos) = angle.sin_cos();
        let mut turn = DMat3::IDENTITY;
        turn.col_mut(p)[p] = cos;
        turn.col_mut(q)[q] = cos;
        turn.col_mut(p)[q] = -sin;
        turn.col_mut(q)[p] = sin;
        matrix = turn.transpose() * matrix * turn;
        vectors *= turn;
    }
    vectors
}

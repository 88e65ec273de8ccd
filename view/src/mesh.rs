//! Triangle meshes for a graphics card.

use crate::body::Body;
use crate::color::{IMPLANT, Pattern, Rgb, WALL};
use crate::section::{CapTriangle, Corner};
use crate::wall;
use glam::{DVec2, DVec3, Vec3};
use implant_preview_core::contact::Dome;
use implant_preview_core::mesh::Chest;
use std::sync::Arc;

/// A vertex: position \[mm\] (3), unit normal (3), coordinates on the net \[cells\] (2; the second negative: no net): on the
/// skin those of the grid, on a cut face those of [`crate::section::Corner`], on a torso first the distance from the nipple \[mm\]; value of the displayed quantity (1, or [`NO_VALUE`]; on a cut face the depth at rest \[mm\]
/// plus 1000 for skin or 2000 for fat; on the implant the height above the wall \[mm\]), colour (3).
pub type Vertex = [f32; 12];

/// The value of a vertex without quantity, drawn in the vertex's colour.
pub const NO_VALUE: f32 = -1.0e9;

/// Step between the values of two patterns on cut faces \[mm\]; greater than every depth.
const PATTERN_STEP: f32 = 1000.0;

/// Neighbours on either side in the smoothing of normals on the seam.
const SEAM_REACH: usize = 4;

/// Drawn thickness of the chest wall \[mm\], and its distance below the tissue's clamped border.
const WALL_THICKNESS: f32 = 5.0;
const WALL_BELOW: f32 = 0.05;

/// Vertices and triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// Three indices per triangle, counter-clockwise seen from outside; shared by meshes of different vertices.
    pub indices: Arc<Vec<u32>>,
}

pub(super) fn vertex(position: Vec3, normal: Vec3, grid: [f32; 2], value: f32, c: Rgb) -> Vertex {
    let (p, n) = (position, normal);
    [p.x, p.y, p.z, n.x, n.y, n.z, grid[0], grid[1], value, c[0], c[1], c[2]]
}

impl Mesh {
    fn new(vertices: Vec<Vertex>, indices: Vec<u32>) -> Self {
        Self { vertices, indices: Arc::new(indices) }
    }
}

/// The two triangles of a quad; `first` is the index of its first corner.
fn quad_indices(first: u32) -> [u32; 6] {
    [0, 1, 2, 0, 2, 3].map(|k| first + k)
}

/// The tissue's outer surface with values and net, its inner face, and the block's side.
///
/// `values` at the sheet's nodes colour the surface; without values the surface has the colour of the tissue.
#[must_use]
pub fn tissue(body: &Body, colors: &[Rgb], values: Option<&[f32]>) -> Mesh {
    Mesh::new(tissue_vertices(Vec::new(), body, colors, values), tissue_indices(body))
}

/// The vertices of [`tissue`], in the memory of an unused list.
#[must_use]
pub fn tissue_vertices(
    room: Vec<Vertex>,
    body: &Body,
    colors: &[Rgb],
    values: Option<&[f32]>,
) -> Vec<Vertex> {
    let mut vertices = room;
    vertices.clear();
    let (Some(top), Some(bottom)) = (body.slabs.first(), body.slabs.last()) else {
        return vertices;
    };
    let (outer, inner) = (&body.levels[0], &body.levels[body.slabs.len()]);
    let count = 2 * outer.len() + 4 * body.rim.len() * body.slabs.len();
    // Frees the surplus memory of a much finer grid.
    vertices.shrink_to(2 * count);
    vertices.reserve_exact(count);
    let n = body.nodes_per_side;
    let on_grid = |k: usize| [(k % n) as f32, (k / n) as f32];
    let value = |k: usize| values.and_then(|v| v.get(k)).copied().unwrap_or(NO_VALUE);
    for (k, (&point, normal)) in outer.iter().zip(normals(body, outer)).enumerate() {
        let (grid, value) =
            if k < body.node_columns { (on_grid(k), value(k)) } else { ([-1.0; 2], NO_VALUE) };
        vertices.push(vertex(point, normal, grid, value, colors[top.layer]));
    }
    // The inner face has opposite normals and no net.
    let dim = colors[bottom.layer].map(|c| c * 0.82);
    for (&point, normal) in inner.iter().zip(normals(body, inner)) {
        vertices.push(vertex(point, -normal, [-1.0; 2], NO_VALUE, dim));
    }
    for (slab, pair) in body.slabs.iter().zip(body.levels.windows(2)) {
        let (high, low) = (&pair[0], &pair[1]);
        // Across the column, away from the pocket.
        let out = |k: usize| {
            let up = (high[k] - low[k]).normalize_or(Vec3::Z);
            wall::outwards(up, low[k].with_z(0.0))
        };
        for k in 0..body.rim.len() {
            let (a, b) = (body.rim[k] as usize, body.rim[(k + 1) % body.rim.len()] as usize);
            let (na, nb) = (out(a), out(b));
            for (point, normal) in [(low[a], na), (low[b], nb), (high[b], nb), (high[a], na)] {
                vertices.push(vertex(point, normal, [-1.0; 2], NO_VALUE, colors[slab.layer]));
            }
        }
    }
    vertices
}

/// The indices of [`tissue`], equal for all shapes of one triangulation.
#[must_use]
pub fn tissue_indices(body: &Body) -> Vec<u32> {
    let Some(inner) = body.levels.last() else { return Vec::new() };
    let columns = inner.len() as u32;
    let triangles = body.triangles.as_flattened();
    let sides = body.rim.len() * body.slabs.len();
    let mut indices = Vec::with_capacity(2 * triangles.len() + 6 * sides);
    indices.extend_from_slice(triangles);
    indices.extend(triangles.iter().map(|k| columns + k));
    indices.extend((0..sides as u32).flat_map(|k| quad_indices(2 * columns + 4 * k)));
    indices
}

/// Area-weighted normals, smooth across the seam between sheet and ring.
fn normals(body: &Body, points: &[Vec3]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::ZERO; points.len()];
    for triangle in &body.triangles {
        let [a, b, c] = triangle.map(|k| points[k as usize]);
        let normal = (b - a).cross(c - a);
        for &k in triangle {
            sums[k as usize] += normal;
        }
    }
    // Equal weights for both sides, because the ring's triangles are much larger than the sheet's; smoothing along
    // the seam, because some of the sheet's triangles are slivers.
    let both = |&(ring, node): &(u32, u32)| {
        sums[ring as usize].normalize_or_zero() + sums[node as usize].normalize_or_zero()
    };
    let across: Vec<Vec3> = body.seam.iter().map(both).collect();
    let count = across.len();
    for (k, &(ring, node)) in body.seam.iter().enumerate() {
        let sum: Vec3 = (0..=2 * SEAM_REACH)
            .map(|d| across[(k + count * SEAM_REACH + d - SEAM_REACH) % count])
            .sum();
        (sums[ring as usize], sums[node as usize]) = (sum, sum);
    }
    sums.iter().map(|sum| sum.normalize_or(Vec3::Z)).collect()
}

/// The cut faces in the colours and patterns of the layers.
#[must_use]
pub fn caps(caps: &[CapTriangle], colors: &[Rgb], patterns: &[Pattern]) -> Mesh {
    let vertices: Vec<Vertex> = caps
        .iter()
        .flat_map(|cap| {
            let color = colors.get(cap.layer).copied().unwrap_or(IMPLANT);
            let pattern = patterns.get(cap.layer).copied().unwrap_or_default();
            let first = PATTERN_STEP * f32::from(pattern as u8);
            cap.corners.map(|Corner { position, net, depth_mm }| {
                vertex(position, cap.normal, net.to_array(), first + depth_mm, color)
            })
        })
        .collect();
    let indices = (0..vertices.len() as u32).collect();
    Mesh::new(vertices, indices)
}

/// The dome above the wall.
#[must_use]
pub fn implant(dome: &Dome) -> Mesh {
    const RINGS: usize = 48;
    const AROUND: usize = 128;
    if dome.top() <= 1e-9 {
        return Mesh::default();
    }
    let of = |point: DVec3| {
        let normal = dome.normal(point + DVec3::Z * 1e-9);
        let above = point.z - dome.chest.height(point.truncate());
        vertex(point.as_vec3(), normal.as_vec3(), [-1.0; 2], above as f32, IMPLANT)
    };
    let at = |ring: usize, step: usize| (ring * AROUND + step % AROUND) as u32;
    let mut indices = Vec::with_capacity(6 * RINGS * AROUND);
    for ring in 0..RINGS {
        for step in 0..AROUND {
            let [a, b] = [at(ring, step), at(ring, step + 1)];
            let [c, d] = [at(ring + 1, step), at(ring + 1, step + 1)];
            indices.extend([a, c, d, a, d, b]);
        }
    }
    Mesh::new(dome.circles(RINGS, AROUND).map(of).collect(), indices)
}

/// The wall within a radius \[mm\], with a rim.
#[must_use]
pub fn wall(chest: &Chest, patch_radius_mm: f64, radius_mm: f32) -> Mesh {
    const RINGS: usize = 12;
    const AROUND: usize = 128;
    let on = |ring: usize, step: usize| {
        let angle = std::f64::consts::TAU * step as f64 / AROUND as f64;
        let radius = f64::from(radius_mm) * ring as f64 / RINGS as f64;
        let (foot, normal) = wall::at(chest, patch_radius_mm, DVec2::from_angle(angle) * radius);
        (foot - normal * WALL_BELOW, normal)
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
        let [low_a, low_b] = [a - up_a * WALL_THICKNESS, b - up_b * WALL_THICKNESS];
        let [out_a, out_b] = [a, b].map(|p| wall::outwards(up_a, p.with_z(0.0)));
        indices.extend(quad_indices(vertices.len() as u32));
        vertices.extend([
            plain(low_a, out_a),
            plain(low_b, out_b),
            plain(b, out_b),
            plain(a, out_a),
        ]);
    }
    Mesh::new(vertices, indices)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::tests::both;
    use crate::section::{Opening, Section};
    use glam::Vec2;
    use implant_preview_core::contact::HalfBall;
    use implant_preview_core::measure::Field;

    fn check(mesh: &Mesh) {
        assert!(!mesh.indices.is_empty());
        assert_eq!(mesh.indices.len() % 3, 0);
        assert!(mesh.indices.iter().all(|&k| (k as usize) < mesh.vertices.len()));
        for v in &mesh.vertices {
            assert!(v.iter().all(|x| x.is_finite()));
            let normal = Vec3::new(v[3], v[4], v[5]).length();
            assert!((normal - 1.0).abs() < 1e-3, "{normal}");
        }
    }

    #[test]
    fn every_mesh_has_valid_indices_and_unit_normals() {
        for (session, body) in both() {
            let colors = [[0.5; 3]; 2];
            let strain = session.values(Field::PrincipalStrain);
            check(&tissue(&body, &colors, Some(strain)));
            check(&tissue(&body, &colors, None));
            let section = Section { opening: Opening::Wedge, angle: 0.7, axis: Vec2::ZERO };
            check(&caps(&section.caps(&body), &colors, &[Pattern::Skin, Pattern::Fat]));
            let dome = &session.problem().obstacle.dome;
            check(&implant(dome));
            for fullness in [0.55, 0.8] {
                let shape = dome.shape.half_ball().unwrap().filled(fullness).into();
                check(&implant(&Dome { shape, ..dome.clone() }));
            }
            check(&wall(&Chest::Flat, 60.0, 80.0));
            check(&wall(&Chest::Curved { across_mm: 70.0, along_mm: 90.0 }, 60.0, 80.0));
        }
    }

    #[test]
    fn a_cut_face_has_the_pattern_of_its_layer() {
        let (_, body) = &both()[0];
        let section = Section { opening: Opening::Half, angle: 0.7, axis: Vec2::ZERO };
        let faces = section.caps(body);
        let mesh = caps(&faces, &[[0.5; 3]; 2], &[Pattern::Skin, Pattern::Fat]);
        for (face, corners) in faces.iter().zip(mesh.vertices.chunks_exact(3)) {
            let first = [1000.0, 2000.0][face.layer];
            for (corner, vertex) in face.corners.iter().zip(corners) {
                assert!((vertex[8] - first - corner.depth_mm).abs() < 1e-3);
            }
        }
        let plain = caps(&faces, &[[0.5; 3]; 2], &[]);
        assert!(plain.vertices.iter().all(|vertex| vertex[8] < 1000.0));
    }

    #[test]
    fn a_flat_implant_is_not_drawn() {
        let dome = Dome::new(DVec2::ZERO, HalfBall::round(55.0, 55.0), 0.0);
        assert!(implant(&dome).indices.is_empty());
    }
}

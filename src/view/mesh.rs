//! Triangles ready for a graphics card.

use crate::implant::Dome;
use crate::view::body::Body;
use crate::view::color::{IMPLANT, Rgb, WALL};
use crate::view::section::CapTriangle;
use glam::Vec3;

/// A vertex: position \[mm\] (3), unit normal (3), place on the sheet's grid \[cells\] (2; negative: no net), the
/// quantity shown (1, [`NO_VALUE`] where there is none), colour (3).
pub type Vertex = [f32; 12];

/// Marks a vertex that shows its own colour.
pub const NO_VALUE: f32 = -1.0e9;

/// Neighbours on either side over which normals on the seam are smoothed.
const SEAM_REACH: usize = 4;

/// Thickness of the chest wall as drawn \[mm\].
const WALL_THICKNESS: f32 = 5.0;

/// Vertices and the triangles that join them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// Three for a triangle, counter-clockwise seen from outside.
    pub indices: Vec<u32>,
}

fn vertex(position: Vec3, normal: Vec3, grid: [f32; 2], value: f32, c: Rgb) -> Vertex {
    let (p, n) = (position, normal);
    [p.x, p.y, p.z, n.x, n.y, n.z, grid[0], grid[1], value, c[0], c[1], c[2]]
}

impl Mesh {
    fn quad(&mut self, corners: [Vec3; 4], normals: [Vec3; 4], color: Rgb) {
        let first = self.vertices.len() as u32;
        for k in 0..4 {
            self.vertices.push(vertex(corners[k], normals[k], [-1.0; 2], NO_VALUE, color));
        }
        self.indices.extend([0, 1, 2, 0, 2, 3].map(|k| first + k));
    }
}

/// The tissue's outer surface with values and net, its inner face, and the block's side.
///
/// `values` are those of the sheet's nodes; without them the surface shows its tissue.
#[must_use]
pub fn tissue(body: &Body, colors: &[Rgb], first_layer: usize, values: Option<&[f32]>) -> Mesh {
    let layers = body.layers();
    let mut mesh = Mesh::default();
    if layers == 0 {
        return mesh;
    }
    let top = first_layer.min(layers - 1);
    surface(&mut mesh, body, top, colors[top], |k| match values {
        Some(values) => values.get(k).copied().unwrap_or(NO_VALUE),
        None => NO_VALUE,
    });
    let outer = mesh.vertices.len() as u32;
    let dim = colors[layers - 1].map(|c| c * 0.82);
    surface(&mut mesh, body, layers, dim, |_| NO_VALUE);
    // The inner face looks the other way and shows no net.
    for v in &mut mesh.vertices[outer as usize..] {
        (v[3], v[4], v[5]) = (-v[3], -v[4], -v[5]);
        (v[6], v[7]) = (-1.0, -1.0);
    }
    for layer in top..layers {
        for k in 0..body.rim.len() {
            let (a, b) = (body.rim[k] as usize, body.rim[(k + 1) % body.rim.len()] as usize);
            let (low, high) = (&body.levels[layer + 1], &body.levels[layer]);
            let out = |p: Vec3| Vec3::new(p.x, p.y, 0.0).normalize_or_zero();
            let (na, nb) = (out(low[a]), out(low[b]));
            mesh.quad([low[a], low[b], high[b], high[a]], [na, nb, nb, na], colors[layer]);
        }
    }
    mesh
}

fn surface(mesh: &mut Mesh, body: &Body, level: usize, color: Rgb, value: impl Fn(usize) -> f32) {
    let first = mesh.vertices.len() as u32;
    let points = &body.levels[level];
    let normals = normals(body, points);
    let n = body.nodes_per_side;
    for (k, (&point, &normal)) in points.iter().zip(&normals).enumerate() {
        let on_sheet = k < body.node_columns;
        let grid = if on_sheet { [(k % n) as f32, (k / n) as f32] } else { [-1.0; 2] };
        mesh.vertices.push(vertex(
            point,
            normal,
            grid,
            if on_sheet { value(k) } else { NO_VALUE },
            color,
        ));
    }
    mesh.indices.extend(body.triangles.iter().flatten().map(|k| first + k));
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
    // The ring's triangles are much larger than the sheet's: weigh both sides alike. Some of the
    // sheet's are slivers: smooth along the seam.
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

/// The cut faces, each layer in its colour.
#[must_use]
pub fn caps(caps: &[CapTriangle], colors: &[Rgb]) -> Mesh {
    let mut mesh = Mesh::default();
    for cap in caps {
        for corner in cap.corners {
            mesh.indices.push(mesh.vertices.len() as u32);
            let color = colors.get(cap.layer).copied().unwrap_or(IMPLANT);
            mesh.vertices.push(vertex(corner, cap.normal, [-1.0; 2], NO_VALUE, color));
        }
    }
    mesh
}

/// The dome above the wall.
#[must_use]
pub fn implant(dome: &Dome) -> Mesh {
    const RINGS: usize = 48;
    const AROUND: usize = 128;
    let mut mesh = Mesh::default();
    let last = (-dome.base_height / dome.projection).clamp(-1.0, 1.0).acos();
    if dome.apex().z <= 1e-9 {
        return mesh;
    }
    for ring in 0..=RINGS {
        let (sin, cos) = (last * ring as f64 / RINGS as f64).sin_cos();
        for step in 0..=AROUND {
            let (y, x) = (std::f64::consts::TAU * step as f64 / AROUND as f64).sin_cos();
            let from_origin = glam::DVec3::new(
                dome.base_radius * sin * x,
                dome.base_radius * sin * y,
                dome.projection * cos,
            );
            let point = dome.origin() + from_origin;
            let normal = dome.normal(point + glam::DVec3::Z * 1e-9);
            mesh.vertices.push(vertex(
                point.as_vec3(),
                normal.as_vec3(),
                [-1.0; 2],
                NO_VALUE,
                IMPLANT,
            ));
        }
    }
    let at = |ring: usize, step: usize| (ring * (AROUND + 1) + step) as u32;
    for ring in 0..RINGS {
        for step in 0..AROUND {
            let (a, b) = (at(ring, step), at(ring + 1, step));
            mesh.indices.extend([a, b, b + 1, a, b + 1, a + 1]);
        }
    }
    mesh
}

/// The chest wall: a disc with a rim.
#[must_use]
pub fn wall(radius: f32) -> Mesh {
    const AROUND: usize = 128;
    let mut mesh = Mesh::default();
    let at = |k: usize| {
        let (y, x) = (std::f32::consts::TAU * k as f32 / AROUND as f32).sin_cos();
        Vec3::new(x, y, 0.0)
    };
    // A hair below the sheet's clamped border, which lies at zero.
    let top = Vec3::new(0.0, 0.0, -0.05);
    let low = Vec3::new(0.0, 0.0, -WALL_THICKNESS);
    for k in 0..AROUND {
        let (a, b) = (at(k), at(k + 1));
        let first = mesh.vertices.len() as u32;
        for p in [top, top + a * radius, top + b * radius] {
            mesh.vertices.push(vertex(p, Vec3::Z, [-1.0; 2], NO_VALUE, WALL));
        }
        mesh.indices.extend([first, first + 1, first + 2]);
        let (ra, rb) = (a * radius, b * radius);
        mesh.quad([low + ra, low + rb, top + rb, top + ra], [a, b, b, a], WALL);
    }
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::body::tests::small;
    use crate::view::section::{Opening, Section};
    use glam::Vec2;

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
    fn every_mesh_is_whole() {
        let (session, body) = small();
        let colors = [[0.5; 3]; 2];
        let fields = session.fields();
        check(&tissue(&body, &colors, 0, Some(&fields.principal_strain)));
        check(&tissue(&body, &colors, 1, None));
        let section = Section { opening: Opening::Wedge, angle: 0.7, axis: Vec2::ZERO };
        check(&caps(&section.caps(&body, 0), &colors));
        check(&implant(&session.solver().problem().dome));
        check(&wall(80.0));
    }

    #[test]
    fn a_flat_implant_is_not_drawn() {
        let dome = Dome::new(glam::DVec2::ZERO, 55.0, 55.0, 0.0);
        assert!(implant(&dome).indices.is_empty());
    }
}

//! The tissue as a body: columns of points through all layers, over one triangulation.
//!
//! A column stands on every sheet node: its points are the inner face and, along the nodal normal,
//! the deformed thicknesses of the layers. Around the pocket a ring of tissue without simulation continues the stack
//! on the wall.

use crate::measure::Stack;
use crate::mesh::{CELL_TRIANGLES, CellKind, NodeKind, Sheet};
use crate::model::membrane::stack::offset;
use crate::solve::Problem;
use glam::{DVec3, Vec3};

/// Width of the ring of unsimulated tissue, relative to the pocket radius, at least twice the stack.
const RING_WIDTH: f32 = 0.2;
/// Positions of the ring's columns \[ring width\].
const RING_STEPS: [f32; 3] = [0.0, 0.35, 1.0];
/// Distance from the border over which the stack is mitred \[heights of the stack\]; without the mitre the outer face
/// would intersect itself at the crease.
const MITRE_REACH: f64 = 1.6;

/// Columns through the layers. Level 0 is the skin's outer surface, the last level the inner face.
#[derive(Clone, Debug, Default)]
pub struct Body {
    /// Points \[mm\], one list of all columns per level, layers + 1 of them.
    pub levels: Vec<Vec<Vec3>>,
    /// Triangles over the columns, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Number of columns on sheet nodes, with the nodes' indices; the ring's columns follow.
    pub node_columns: usize,
    /// Nodes per side of the sheet's grid.
    pub nodes_per_side: usize,
    /// Pairs of coincident columns: inner column of the ring, border column of the sheet.
    pub seam: Vec<(u32, u32)>,
    /// The ring's outer columns, counter-clockwise, closed.
    pub rim: Vec<u32>,
    /// Radius of the whole block on the wall \[mm\].
    pub block_radius: f32,
    /// The clamped nodes, counter-clockwise.
    border: Vec<usize>,
    /// The parameters of the current triangulation.
    made_for: Option<Grid>,
}

/// Parameters of a triangulation.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Grid {
    nodes_per_side: usize,
    radius_mm: f64,
    layers: usize,
}

impl Body {
    /// The body of a shape with its stack of layers.
    #[must_use]
    pub fn new(problem: &Problem, shape: &[DVec3], stack: &Stack) -> Self {
        let mut body = Self::default();
        body.update(problem, shape, stack);
        body
    }

    /// Updates the body to another shape. Returns whether the triangulation is new: with equal grid and number of
    /// layers only points move.
    pub fn update(&mut self, problem: &Problem, shape: &[DVec3], stack: &Stack) -> bool {
        let (sheet, layers) = (&problem.sheet, problem.materials.len());
        let grid =
            Grid { nodes_per_side: sheet.nodes_per_side(), radius_mm: sheet.radius_mm(), layers };
        let is_new = self.made_for != Some(grid);
        if is_new {
            *self = Self::triangulated(sheet, grid);
        }
        if !stack.between.is_empty() {
            self.set_computed_faces(shape, stack);
            self.add_ring_points(problem);
            return is_new;
        }
        let along = stack_directions(problem, &self.border, stack);
        let inner = &mut self.levels[layers];
        inner.clear();
        inner.extend(shape.iter().map(|p| p.as_vec3()));
        for (level, thickness) in stack.thickness_mm.iter().enumerate().rev() {
            let (above, below) = self.levels.split_at_mut(level + 1);
            let (above, below) = (&mut above[level], &below[0]);
            above.clear();
            above.extend(offset(below, &along, thickness));
        }
        self.add_ring_points(problem);
        is_new
    }

    /// Sets the levels to computed faces; the skin lies along the normals of its membrane.
    fn set_computed_faces(&mut self, shape: &[DVec3], stack: &Stack) {
        let layers = self.layers();
        let mut faces = stack.faces(shape.iter().map(|p| p.as_vec3()).collect());
        for level in &mut self.levels {
            level.clear();
        }
        for (level, face) in self.levels.iter_mut().rev().zip(faces.drain(..=layers)) {
            level.extend(face);
        }
    }

    /// Triangles and ring without points.
    fn triangulated(sheet: &Sheet, grid: Grid) -> Self {
        let columns = sheet.len();
        let border = border_loop(sheet);
        let mut body = Self {
            levels: vec![Vec::with_capacity(columns + 3 * border.len()); grid.layers + 1],
            triangles: sheet_triangles(sheet),
            node_columns: columns,
            nodes_per_side: grid.nodes_per_side,
            made_for: Some(grid),
            ..Self::default()
        };
        let (steps, around) = (RING_STEPS.len(), border.len());
        let at = |k: usize, step: usize| (columns + (k % around) * steps + step) as u32;
        for k in 0..around {
            body.seam.push((at(k, 0), border[k] as u32));
            body.rim.push(at(k, steps - 1));
            for step in 0..steps - 1 {
                let quad = [at(k, step), at(k, step + 1), at(k + 1, step + 1), at(k + 1, step)];
                body.triangles.push([quad[0], quad[1], quad[2]]);
                body.triangles.push([quad[0], quad[2], quad[3]]);
            }
        }
        body.border = border;
        body
    }

    /// Number of layers.
    #[must_use]
    pub fn layers(&self) -> usize {
        self.levels.len().saturating_sub(1)
    }

    fn add_ring_points(&mut self, problem: &Problem) {
        let sheet = &problem.sheet;
        let stack: f32 = problem.materials.iter().map(|m| m.thickness_mm as f32).sum();
        let radius = sheet.radius_mm() as f32;
        let width = (RING_WIDTH * radius).max(2.0 * stack);
        self.block_radius = radius + width;
        for k in 0..self.border.len() {
            let node = self.border[k];
            let outward = sheet.rest()[node].as_vec2().normalize_or_zero();
            for (step, fraction) in RING_STEPS.into_iter().enumerate() {
                let offset = (outward * fraction * width).extend(0.0);
                self.push_ring_column(problem, node, step, offset);
            }
        }
    }

    fn push_ring_column(&mut self, problem: &Problem, node: usize, step: usize, offset: Vec3) {
        let layers = self.layers();
        let foot = self.levels[layers][node] + offset;
        if step == 0 {
            for level in &mut self.levels {
                let point = level[node];
                level.push(point);
            }
            return;
        }
        let mut height = 0.0;
        self.levels[layers].push(foot);
        for level in (0..layers).rev() {
            height += problem.materials[level].thickness_mm as f32;
            self.levels[level].push(foot + Vec3::Z * height);
        }
    }
}

/// Two triangles of each whole cell, one triangle of each cut cell.
fn sheet_triangles(sheet: &Sheet) -> Vec<[u32; 3]> {
    let cells = sheet.nodes_per_side() - 1;
    let mut triangles = Vec::with_capacity(2 * cells * cells);
    for j in 0..cells {
        for i in 0..cells {
            let corners = sheet.corners(i, j);
            let mut push = |t: usize| triangles.push(CELL_TRIANGLES[t].map(|c| corners[c] as u32));
            match sheet.cell(i, j) {
                CellKind::Whole => {
                    push(0);
                    push(2);
                }
                CellKind::WithoutCorner(k) => push(usize::from(k)),
                CellKind::Outside => {}
            }
        }
    }
    triangles
}

/// Direction of the stack at every node: the normal, mitred near the border, with a length that keeps the thickness
/// of the layers.
fn stack_directions(problem: &Problem, border: &[usize], stack: &Stack) -> Vec<Vec3> {
    let sheet = &problem.sheet;
    let height: f64 = problem.materials.iter().map(|m| m.thickness_mm).sum();
    let reach = MITRE_REACH * height;
    // Squared radius beyond which the stack of a node is mitred.
    let inner = (sheet.radius_mm() - reach).max(0.0).powi(2);
    let mut along = stack.normal.clone();
    for (k, along) in along.iter_mut().enumerate() {
        let rest = sheet.rest()[k];
        let is_free = sheet.kinds()[k] == NodeKind::Free;
        if is_free && rest.length_squared() >= inner {
            let to_border = sheet.radius_mm() - rest.length();
            *along = mitred(*along, (1.0 - (to_border / reach).clamp(0.0, 1.0)) as f32);
        }
    }
    for (&node, normal) in border.iter().zip(border_normals(sheet, border, stack)) {
        along[node] = mitred(normal, 1.0);
    }
    along
}

/// The stack's direction for a nodal normal; `mitre`: 0 along the normal, 1 midway between the normal and the
/// wall's normal, as at the border.
fn mitred(normal: Vec3, mitre: f32) -> Vec3 {
    let between = (normal + Vec3::Z).normalize_or(Vec3::Z);
    normal.lerp(between / between.z.max(0.5), mitre)
}

/// Smoothed normals along the border, where small triangles have inaccurate normals.
fn border_normals(sheet: &Sheet, border: &[usize], stack: &Stack) -> Vec<Vec3> {
    const REACH: usize = 4;
    let count = border.len();
    // Outward and vertical component of each normal.
    let leans: Vec<(f32, f32)> = border
        .iter()
        .map(|&k| {
            let normal = stack.normal[k];
            (normal.truncate().dot(sheet.rest()[k].as_vec2().normalize_or_zero()), normal.z)
        })
        .collect();
    (0..count)
        .map(|k| {
            let near = (0..=2 * REACH).map(|d| leans[(k + count * REACH + d - REACH) % count]);
            let (lean, up) = near.fold((0.0, 0.0), |sum, n| (sum.0 + n.0, sum.1 + n.1));
            let outward = sheet.rest()[border[k]].as_vec2().normalize_or_zero();
            (outward * lean).extend(up.max(0.0)).normalize_or(Vec3::Z)
        })
        .collect()
}

/// The clamped nodes, counter-clockwise.
fn border_loop(sheet: &Sheet) -> Vec<usize> {
    let mut border: Vec<usize> =
        (0..sheet.len()).filter(|&k| sheet.kinds()[k] == NodeKind::Clamped).collect();
    let angle = |k: usize| sheet.rest()[k].y.atan2(sheet.rest()[k].x);
    border.sort_by(|&a, &b| angle(a).total_cmp(&angle(b)));
    border
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::session::Session;

    /// The default scene in both tissue models on a small grid, solved, with its body.
    pub(crate) fn both() -> [(Session, Body); 2] {
        [Scene::default(), Scene::sheet()].map(solved)
    }

    fn solved(mut scene: Scene) -> (Session, Body) {
        scene.solver.nodes_per_side = 33;
        let mut session = Session::new(scene).expect("the default scene is valid");
        while session.is_working() {
            session.advance(&mut || false);
        }
        let body = Body::new(session.problem(), session.shape(), session.solution().stack());
        (session, body)
    }

    #[test]
    fn adjacent_faces_are_one_layer_thickness_apart() {
        for (session, body) in both() {
            let stack = session.solution().stack();
            let sheet = &session.problem().sheet;
            let inside = |k: &usize| sheet.rest()[*k].length() < 50.0;
            for k in (0..sheet.len()).filter(inside) {
                for layer in 0..body.layers() {
                    let apart = body.levels[layer][k] - body.levels[layer + 1][k];
                    // The columns of layered tissue are sheared; their thickness is that along the skin's normal.
                    let is_column = session.scene().is_layered() && layer > 0;
                    let thickness =
                        if is_column { apart.dot(stack.normal[k]) } else { apart.length() };
                    assert!((thickness - stack.thickness_mm[layer][k]).abs() < 1e-3, "{k} {layer}");
                }
            }
        }
    }

    #[test]
    fn the_ring_continues_the_border_and_lies_flat() {
        for (session, body) in both() {
            assert!(!body.seam.is_empty());
            for level in &body.levels {
                for &(ring, node) in &body.seam {
                    assert_eq!(level[ring as usize], level[node as usize]);
                }
            }
            let stack: f64 = session.scene().layers.iter().map(|l| l.thickness_mm).sum();
            for &column in &body.rim {
                assert!((body.levels[0][column as usize].z - stack as f32).abs() < 1e-4);
            }
        }
    }

    #[test]
    fn every_triangle_faces_outwards() {
        for (_, body) in both() {
            let outer = &body.levels[0];
            let down = body
                .triangles
                .iter()
                .filter(|t| {
                    let [a, b, c] = t.map(|k| outer[k as usize]);
                    (b - a).cross(c - a).z < -1e-4
                })
                .count();
            assert_eq!(down, 0, "of {}", body.triangles.len());
        }
    }
}

//! The tissue as a body: columns of points through all layers, over one triangulation.
//!
//! A column stands on every grid node. In layered tissue its points are the nodes from the inner face to the skin, and the
//! skin's outer surface; in a sheet the inner face and, along the nodal normal, the deformed thicknesses of the layers.
//! Around the patch a ring of tissue without simulation continues the stack on the wall, along its tangents.

use crate::wall;
use glam::{Vec2, Vec3};
use implant_preview_core::measure::Stack;
use implant_preview_core::mesh::{CELL_TRIANGLES, CellKind, NodeKind, Sheet};
use implant_preview_core::model::membrane::stack::offset;
use implant_preview_core::solve::{Problem, Solution};

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
    /// Points \[mm\], one list of all columns per level, one level more than [`Self::slabs`].
    pub levels: Vec<Vec<Vec3>>,
    /// What lies between a level and the next: a layer of the tissue, or a layer of cells.
    pub slabs: Vec<Slab>,
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
    /// Radius of the whole block along the wall \[mm\].
    pub block_radius: f32,
    /// The clamped nodes, counter-clockwise.
    border: Vec<usize>,
    /// The parameters of the current triangulation.
    made_for: Option<Grid>,
}

/// Tissue between two levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slab {
    /// Index of the tissue's layer, counted from the skin.
    pub layer: usize,
    /// Thickness at rest \[mm\].
    pub height_mm: f32,
    /// Is the slab a layer of cells between computed nodes?
    pub has_cells: bool,
}

/// Parameters of a triangulation.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Grid {
    nodes_per_side: usize,
    radius_mm: f64,
}

impl Body {
    /// The body of a solution.
    #[must_use]
    pub fn new(solution: &Solution) -> Self {
        let mut body = Self::default();
        body.update(solution);
        body
    }

    /// Updates the body to another solution. Returns whether the triangulation is new: with equal grid and slabs only
    /// points move.
    pub fn update(&mut self, solution: &Solution) -> bool {
        let problem = solution.problem();
        let sheet = problem.sheet();
        let slabs = slabs(solution);
        let grid = Grid { nodes_per_side: sheet.nodes_per_side(), radius_mm: sheet.radius_mm() };
        let is_new = self.made_for != Some(grid) || self.slabs.len() != slabs.len();
        if is_new {
            *self = Self::triangulated(sheet, grid, slabs.len());
        }
        self.slabs = slabs;
        for level in &mut self.levels {
            level.clear();
        }
        // From the inner face outwards.
        let mut levels = self.levels.iter_mut().rev();
        let nodes = std::iter::once(solution.inner()).chain(solution.outer().iter().map(|l| &**l));
        for (level, nodes) in levels.by_ref().zip(nodes) {
            level.extend(nodes.iter().map(|p| p.as_vec3()));
        }
        // Layers that are not computed lie along the normals: all of a sheet's, the skin of layered tissue.
        let stack = solution.stack();
        let directions =
            (solution.outer().is_empty()).then(|| stack_directions(problem, &self.border, stack));
        let along = directions.as_ref().unwrap_or(&stack.normal);
        let first = solution.outer().len();
        for level in (0..self.slabs.len() - first).rev() {
            let (above, below) = self.levels.split_at_mut(level + 1);
            let thickness = &stack.thickness_mm[self.slabs[level].layer];
            above[level].extend(offset(&below[0], along, thickness));
        }
        self.add_ring_points(problem);
        is_new
    }

    /// Triangles and ring without points.
    fn triangulated(sheet: &Sheet, grid: Grid, slabs: usize) -> Self {
        let columns = sheet.len();
        let border = border_loop(sheet);
        let mut body = Self {
            levels: vec![Vec::with_capacity(columns + 3 * border.len()); slabs + 1],
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

    /// Moves every point by a part of the way to that of another body of the same triangulation \[-\].
    pub fn move_toward(&mut self, other: &Self, part: f32) {
        for (points, others) in self.levels.iter_mut().zip(&other.levels) {
            for (point, other) in points.iter_mut().zip(others) {
                *point = point.lerp(*other, part);
            }
        }
    }

    /// Is there nothing to draw?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.slabs.is_empty()
    }

    /// Height of the highest point of the skin above the wall \[mm\]; 0 without tissue.
    #[must_use]
    pub fn height(&self) -> f32 {
        self.levels.first().map_or(0.0, |skin| skin.iter().map(|p| p.z).fold(0.0, f32::max))
    }

    /// Place at rest of a column on a vertical plane of this normal \[cells\], from the middle of the grid; `None` in the ring.
    pub(super) fn cells_along(&self, column: usize, normal: Vec3) -> Option<f32> {
        let n = self.nodes_per_side;
        let from_middle = |k: usize| k as f32 - 0.5 * (n - 1) as f32;
        let place = Vec2::new(from_middle(column % n), from_middle(column / n));
        (column < self.node_columns).then(|| normal.truncate().perp().dot(place))
    }

    fn add_ring_points(&mut self, problem: &Problem) {
        let sheet = problem.sheet();
        let stack: f32 = problem.materials.iter().map(|m| m.thickness_mm as f32).sum();
        let radius = sheet.radius_mm() as f32;
        let width = (RING_WIDTH * radius).max(2.0 * stack);
        self.block_radius = radius + width;
        let computed = self.slabs.iter().filter(|slab| slab.has_cells).count();
        for k in 0..self.border.len() {
            let node = self.border[k];
            // The computed columns at the border stand on the wall's normals, at rest.
            let column = |level: usize| self.levels[level][node];
            let innermost = self.slabs.len();
            let up = (column(innermost - computed) - column(innermost)).normalize_or(Vec3::Z);
            let outward = wall::outwards(up, sheet.rest()[node].extend(0.0).as_vec3());
            for (step, fraction) in RING_STEPS.into_iter().enumerate() {
                self.push_ring_column(node, step, outward * (fraction * width), up);
            }
        }
    }

    fn push_ring_column(&mut self, node: usize, step: usize, offset: Vec3, up: Vec3) {
        if step == 0 {
            for level in &mut self.levels {
                let point = level[node];
                level.push(point);
            }
            return;
        }
        let innermost = self.slabs.len();
        let mut point = self.levels[innermost][node] + offset;
        self.levels[innermost].push(point);
        for (level, slab) in self.levels.iter_mut().zip(&self.slabs).rev() {
            point += up * slab.height_mm;
            level.push(point);
        }
    }
}

/// What lies between the levels, from the skin inwards.
fn slabs(solution: &Solution) -> Vec<Slab> {
    let cells = solution.cells();
    let slab = |(layer, height_mm): (usize, f64), has_cells| Slab {
        layer,
        height_mm: height_mm as f32,
        has_cells,
    };
    let layers = solution.problem().materials.iter().map(|m| m.thickness_mm).enumerate();
    let along_normals = if cells.is_empty() { usize::MAX } else { 1 };
    let mut slabs: Vec<Slab> = layers.take(along_normals).map(|layer| slab(layer, false)).collect();
    slabs.extend(cells.into_iter().rev().map(|cells| slab(cells, true)));
    slabs
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
    let sheet = problem.sheet();
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
    use implant_preview_core::scene::Scene;
    use implant_preview_core::session::Session;

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
        let body = Body::new(session.solution());
        (session, body)
    }

    #[test]
    fn adjacent_faces_are_one_layer_thickness_apart() {
        for (session, body) in both() {
            let stack = session.solution().stack();
            let sheet = session.problem().sheet();
            let inside = |k: &usize| sheet.rest()[*k].length() < 50.0;
            for k in (0..sheet.len()).filter(inside) {
                let mut thickness = vec![0.0; session.scene().layers.len()];
                for (slab, pair) in body.slabs.iter().zip(body.levels.windows(2)) {
                    let apart = pair[0][k] - pair[1][k];
                    // The columns of layered tissue are sheared; their thickness is that along the skin's normal.
                    thickness[slab.layer] +=
                        if slab.has_cells { apart.dot(stack.normal[k]) } else { apart.length() };
                }
                for (layer, thickness) in thickness.into_iter().enumerate() {
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

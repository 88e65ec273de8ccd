//! What a result of layered tissue adds: cover, skin area, traction of the attachment, loads of the solid layers.

use super::profile::{self, Direction, Layer};
use super::{Outcome, Selection};
use crate::mesh::{NodeKind, Pocket, Rest, Sheet, enclosed};
use crate::model::layered::exact::CellState;
use crate::solve::{Problem, Solution};
use glam::{DMat3, DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// Thickness of the tissue between implant and outer skin surface \[mm\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Cover {
    /// Above the implant's highest point, along the wall's normal there.
    pub apex: f64,
    /// The least distance of the skin's outer surface from the implant's dome.
    pub least: f64,
    /// Where the least cover is: x and y of the skin's outer surface \[mm\].
    pub least_at_mm: [f64; 2],
    /// The cover without the muscle over the implant, of a plan with a plane of the pocket; otherwise absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub without_muscle: Option<CoverWithoutMuscle>,
}

/// Thickness of the tissue between the muscle over the implant and the outer skin surface \[mm\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CoverWithoutMuscle {
    /// Above the implant's highest point.
    pub apex: f64,
    /// The least one: the distance from the implant's dome less the muscle's thickness.
    pub least: f64,
}

/// Area of the skin's membrane \[cm²\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SkinArea {
    /// Over the pocket, at rest.
    pub pocket_before_cm2: f64,
    /// The same skin, deformed.
    pub pocket_after_cm2: f64,
    /// Of the whole patch, at rest.
    pub patch_before_cm2: f64,
    /// Of the whole patch, deformed.
    pub patch_after_cm2: f64,
}

impl SkinArea {
    /// What the skin beyond the pocket gains \[cm²\].
    #[must_use]
    pub fn gained_beyond_cm2(&self) -> f64 {
        let patch = self.patch_after_cm2 - self.patch_before_cm2;
        patch - (self.pocket_after_cm2 - self.pocket_before_cm2)
    }
}

/// The attachment's greatest pull on the inner face \[kPa\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Traction {
    /// Force per area at rest.
    pub max: f64,
    /// Where the traction is greatest: x and y at rest \[mm\].
    pub at_mm: [f64; 2],
}

/// Least and greatest deformed thickness of a layer \[mm\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Thickness {
    /// Least.
    pub least: f64,
    /// Greatest.
    pub greatest: f64,
}

/// Weight of a node in sums over the pocket.
pub(super) fn pocket_weight(sheet: &Sheet, pocket: Pocket, node: usize) -> f64 {
    let place = sheet.rest()[node];
    enclosed::pocket_weight(pocket.beyond(place.length(), place.y), sheet.spacing_mm())
}

/// Area of the skin at rest over the pocket and of the whole patch \[mm²\]; of a sheet that of the sheet.
pub(super) fn rest_areas(problem: &Problem) -> [f64; 2] {
    let Problem { rest, patch, .. } = problem;
    let radius = patch.radius_mm;
    let flat = [patch.pocket().area_mm2(), PI * radius * radius];
    if rest.is_even() {
        return flat;
    }
    // The grid's sums over the curved surface, relative to those over the plane.
    let (sheet, skin) = (rest.sheet(), rest.layers() - 1);
    let (mut curved, mut plane) = ([0.0; 2], [0.0; 2]);
    for (nodes, weight) in sheet.triangles() {
        let [a, b, c] = nodes.map(|k| rest.node(skin, k));
        let areas = [0.5 * (b - a).cross(c - a).length(), sheet.rest_area(nodes)];
        let in_pocket = nodes.map(|k| pocket_weight(sheet, patch.pocket(), k));
        for (part, factor) in [in_pocket.iter().sum::<f64>() / 3.0, 1.0].into_iter().enumerate() {
            curved[part] += weight * factor * areas[0];
            plane[part] += weight * factor * areas[1];
        }
    }
    [0, 1].map(|part| flat[part] * curved[part] / plane[part])
}

/// The free nodes that determine a solution: of mirror images the first one.
fn free_nodes(solution: &Solution) -> impl Iterator<Item = usize> + '_ {
    let kinds = solution.problem().sheet().kinds();
    solution.part().first_images().filter(|&k| kinds[k] == NodeKind::Free)
}

impl Outcome {
    /// Adds the selected fields of layered tissue; `patch_area` is the skin's of the patch at rest \[mm²\].
    pub(super) fn measure_layers(
        &mut self,
        solution: &Solution,
        selection: &Selection,
        patch_area: f64,
    ) {
        let problem = solution.problem();
        let patch = &problem.patch;
        // That of a sheet.
        self.skin_projection_mm = None;
        if selection.wants_any(&["cover_mm", "skin_projection_mm"]) {
            let outer: Vec<(usize, DVec3)> = free_nodes(solution)
                .map(|k| (k, solution.outer_surface_at(k).as_dvec3()))
                .collect();
            self.skin_projection_mm = skin_over_apex(solution, &outer);
            self.cover_mm = cover(solution, &outer, self.skin_projection_mm);
        }
        let deformation = solution.deformation();
        let whole = patch_area / 100.0;
        let skin = deformation.summary([], |_| 1.0);
        self.skin_area = self.area_after_cm2.map(|pocket_after_cm2| SkinArea {
            pocket_before_cm2: self.area_before_cm2,
            pocket_after_cm2,
            patch_before_cm2: whole,
            patch_after_cm2: whole * skin.area_ratio,
        });
        if selection.wants("attachment_traction_kpa") {
            self.attachment_traction_kpa = traction(solution);
        }
        let skin_profile =
            |direction| profile::along(Layer::membrane(solution), direction, patch.radius_mm);
        if selection.wants("profile_skin") {
            self.profile_skin = skin_profile(Direction::Side);
        }
        if selection.wants("profile_y") {
            self.profile_y = profile::along_y(solution);
        }
        if selection.wants("profile_skin_y") {
            self.profile_skin_y = skin_profile(Direction::Head);
        }
        if !selection.wants_any(&["layers", "warnings"]) {
            return;
        }
        for (layer, range) in self.layers.iter_mut().zip(solution.thickness_ranges()) {
            let (least, greatest) = (range.0.into(), range.1.into());
            layer.thickness_mm = (least <= greatest).then_some(Thickness { least, greatest });
        }
        let skin = solution.elastic_deformation().summary([], |_| 1.0);
        self.layers[0].max_stretch = Some(1.0 + skin.greatest);
        let count = self.layers.len();
        for (solid, load) in solution.solid_loads().into_iter().enumerate() {
            // Solids are listed from the inner face outwards.
            let layer = count - 1 - solid;
            let curve = &problem.materials[layer].curve;
            self.layers[layer].max_stretch = Some(load.stretch);
            self.layers[layer].max_stress_kpa = Some(load.stress);
            self.layers[layer].beyond_curve_data = curve.is_beyond_data(load.strain);
        }
    }
}

/// The load of a solid layer.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SolidLoad {
    /// Greatest principal stretch \[-\].
    pub(crate) stretch: f64,
    /// Greatest principal nominal stress \[kPa\].
    pub(crate) stress: f64,
    /// Greatest equivalent strain exp(e) − 1 \[-\].
    pub(crate) strain: f64,
}

impl Solution {
    /// The loads of the solid layers, from the inner face outwards, at the middles of the cells.
    pub(crate) fn solid_loads(&self) -> Vec<SolidLoad> {
        let mut loads = Vec::new();
        self.visit_cells(|state: &CellState| {
            if loads.len() <= state.solid {
                loads.resize(state.solid + 1, SolidLoad::default());
            }
            let load = &mut loads[state.solid];
            load.strain = load.strain.max(state.equivalent);
            // Most cells are below the greatest values so far by bounds without eigenvalues.
            let (stretch, stress) = state.bounds();
            if stretch <= load.stretch && stress <= load.stress {
                return;
            }
            let (stretch, stress) = state.greatest_stretch_and_stress();
            load.stretch = load.stretch.max(stretch);
            load.stress = load.stress.max(stress);
        });
        loads.iter_mut().for_each(|load| load.strain = load.strain.exp_m1());
        loads
    }
}

/// Greatest principal strain \[-\] and nominal stress \[kPa\] of a solid layer at the nodes, means of the adjacent cells;
/// shape (nodes_per_side², ).
#[derive(Clone, Debug, Default)]
pub(super) struct NodalLoads {
    pub(super) strain: Vec<f32>,
    pub(super) stress: Vec<f32>,
}

impl Solution {
    /// The loads of the solid layers at the nodes, from the inner face outwards.
    pub(super) fn nodal_loads(&self) -> Vec<NodalLoads> {
        let part = self.part();
        let nodes = part.len();
        let mut loads: Vec<NodalLoads> = Vec::new();
        let mut cells: Vec<Vec<f32>> = Vec::new();
        self.visit_cells(|state: &CellState| {
            while loads.len() <= state.solid {
                loads.push(NodalLoads { strain: vec![0.0; nodes], stress: vec![0.0; nodes] });
                cells.push(vec![0.0; nodes]);
            }
            let (stretch, stress) = state.greatest_stretch_and_stress();
            let (strain, stress) = ((stretch - 1.0) as f32, stress as f32);
            for k in state.corners.map(|k| part.index(k)) {
                loads[state.solid].strain[k] += strain;
                loads[state.solid].stress[k] += stress;
                cells[state.solid][k] += 1.0;
            }
        });
        for (load, cells) in loads.iter_mut().zip(cells) {
            for (k, count) in cells.into_iter().enumerate().filter(|(_, count)| *count > 0.0) {
                load.strain[k] /= count;
                load.stress[k] /= count;
            }
            load.strain = part.on_grid(std::mem::take(&mut load.strain));
            load.stress = part.on_grid(std::mem::take(&mut load.stress));
        }
        loads
    }
}

/// Distance of the skin's outer surface from the dome at a node \[mm\].
pub(super) fn cover_at(solution: &Solution, node: usize) -> f64 {
    let stack = solution.stack();
    let outer =
        solution.membrane()[node] + (stack.normal[node] * stack.thickness_mm[0][node]).as_dvec3();
    solution.problem().obstacle.dome.closest_point(outer).0
}

/// Thickness of a layer at rest at a node \[mm\], the skin first: as the deformed thickness along the skin's normal.
#[must_use]
pub fn thickness_at_rest(problem: &Problem, layer: usize, node: usize) -> f64 {
    let rest = &problem.rest;
    if layer == 0 || rest.is_even() {
        return problem.materials[layer].thickness_mm;
    }
    // Solids count from the inner face outwards.
    let solid = problem.solids().len() - layer;
    let face = |solids: usize| rest.cells().iter().take_while(|cells| cells.solid < solids).count();
    along_normal(rest, node, [face(solid), face(solid + 1)])
}

/// Least thickness of all layers at rest at the nodes in a circle of the sheet \[mm\].
#[must_use]
pub fn least_thickness_at_rest(problem: &Problem, center_mm: [f64; 2], radius_mm: f64) -> f64 {
    let Problem { rest, materials, .. } = problem;
    if rest.is_even() {
        return materials.iter().map(|material| material.thickness_mm).sum();
    }
    let faces = [0, rest.layers() - 1];
    let places = rest.sheet().rest().iter().enumerate();
    let center = DVec2::from(center_mm);
    let near = places.filter(|(_, place)| place.distance(center) <= radius_mm);
    let least = near.fold(f64::INFINITY, |least, (node, _)| {
        let [inner, outer] = faces.map(|face| rest.node(face, node));
        // No column leans so far that its thickness is less than half its length.
        if inner.distance(outer) > 2.0 * least {
            return least;
        }
        least.min(along_normal(rest, node, faces))
    });
    materials[0].thickness_mm + least
}

/// Distance of two layers of nodes at rest along the skin's normal \[mm\]; at the rim the length of the column.
#[inline(never)]
fn along_normal(rest: &Rest, node: usize, layers: [usize; 2]) -> f64 {
    let column = rest.node(layers[1], node) - rest.node(layers[0], node);
    let (skin, row) = (rest.layers() - 1, rest.sheet().nodes_per_side());
    let kinds = rest.sheet().kinds();
    if kinds[node] != NodeKind::Free {
        return column.length();
    }
    let (above, below) = (node + row, node - row);
    let ring = [node + 1, above + 1, above, above - 1, node - 1, below - 1, below, below + 1];
    if ring.iter().any(|&k| kinds[k] == NodeKind::Outside) {
        return column.length();
    }
    let edges = ring.map(|k| rest.node(skin, k) - rest.node(skin, node));
    // The triangles of both diagonals, as those of [`crate::model::membrane::Deformation::normal`].
    let mut normal = DVec3::ZERO;
    for side in [0, 2, 4, 6] {
        let [first, corner, last] = [0, 1, 2].map(|k| edges[(side + k) % 8]);
        normal += corner.cross(last - first) + first.cross(last);
    }
    column.dot(normal.normalize())
}

/// Pull of the attachment at a node \[kPa\].
pub(super) fn traction_at(solution: &Solution, node: usize) -> f64 {
    let problem = solution.problem();
    let (rest, patch) = (&problem.rest, &problem.patch);
    patch.attachment().map_or(0.0, |attachment| {
        let place = rest.sheet().rest()[node];
        let moved = solution.inner()[node].distance(rest.node(0, node));
        attachment.stiffness(patch.pocket().beyond(place.length(), place.y)) * moved
    })
}

/// Part of its distance over the plane that a draped dome's is at least \[-\]: the shear of a wall as steep as a scene's may be under its
/// implant, 65°, shortens lengths to 0.39.
const LEAST_OF_DRAPED: f64 = 0.38;

/// The cover over the implant; `outer` is the skin's outer surface at the free nodes of the part, `height` that above the
/// apex \[mm\]. `None` without an implant above the wall.
fn cover(solution: &Solution, outer: &[(usize, DVec3)], height: Option<f64>) -> Option<Cover> {
    let dome = &solution.problem().obstacle.dome;
    let apex = dome.apex();
    if dome.top() <= 0.0 {
        return None;
    }
    let height = height?;
    let is_even = solution.problem().rest.is_even();
    let of_draped = if is_even { 1.0 } else { LEAST_OF_DRAPED };
    let mut least = (f64::INFINITY, [apex.x, apex.y]);
    let bound = dome.least_distances();
    for (_, point) in outer {
        // A bound without roots keeps far nodes out of the search.
        if bound(*point) * of_draped > least.0 {
            continue;
        }
        let distance = dome.closest_point(*point).0;
        if distance < least.0 {
            least = (distance, [point.x, point.y]);
        }
    }
    // The apex lies between the nodes.
    let over_apex = height - dome.top();
    if over_apex < least.0 {
        least = (over_apex, [apex.x, apex.y]);
    }
    let [x, y] = least.1;
    Some(Cover { apex: over_apex, least: least.0, least_at_mm: [x, y], without_muscle: None })
}

/// The cover of a solution without its innermost layer, the muscle.
#[must_use]
pub fn cover_without_innermost(solution: &Solution, cover: &Cover) -> Option<CoverWithoutMuscle> {
    let stack = solution.stack();
    let thickness = stack.thickness_mm.last()?;
    let dome = &solution.problem().obstacle.dome;
    let rest = &solution.problem().rest;
    let of_draped = if rest.is_even() { 1.0 } else { LEAST_OF_DRAPED };
    let apex = dome.apex();
    let mut at_apex = (f64::INFINITY, 0.0);
    let mut least = f64::INFINITY;
    let bound = dome.least_distances();
    for node in free_nodes(solution) {
        let own = rest.innermost_part(node) * f64::from(thickness[node]);
        let apart = solution.inner()[node].distance_squared(apex);
        if apart < at_apex.0 {
            at_apex = (apart, own);
        }
        let outer = solution.outer_surface_at(node).as_dvec3();
        if bound(outer) * of_draped - own <= least {
            least = least.min(dome.closest_point(outer).0 - own);
        }
    }
    let over_apex = cover.apex - at_apex.1;
    Some(CoverWithoutMuscle { apex: over_apex, least: least.min(over_apex) })
}

/// Height of the skin's outer surface over the apex above the wall \[mm\]: the apex's, and the tissue's along the wall's normal.
fn skin_over_apex(solution: &Solution, outer: &[(usize, DVec3)]) -> Option<f64> {
    let obstacle = &solution.problem().obstacle;
    let apex = obstacle.dome.apex();
    if solution.problem().rest.is_even() {
        return height_above(solution, outer, [apex.x, apex.y], |point| point);
    }
    let up = obstacle.wall.normal(apex);
    let along = (DVec3::X - up * up.x).normalize();
    let frame = DMat3::from_cols(along, up.cross(along), up).transpose();
    let cover = height_above(solution, outer, [0.0; 2], |point| frame * (point - apex))?;
    Some(obstacle.dome.top() + cover)
}

/// Height of the skin's outer surface in a frame above its point (px, py) \[mm\], by a parabola in each direction about the
/// nearest of the nodes `outer`.
fn height_above(
    solution: &Solution,
    outer: &[(usize, DVec3)],
    [px, py]: [f64; 2],
    frame: impl Fn(DVec3) -> DVec3,
) -> Option<f64> {
    let n = solution.problem().sheet().nodes_per_side();
    let apart = |x: DVec3| (x.x - px).powi(2) + (x.y - py).powi(2);
    let nodes = outer.iter().map(|(k, point)| (*k, frame(*point)));
    let (k, x) = nodes.min_by(|(_, a), (_, b)| apart(*a).total_cmp(&apart(*b)))?;
    let at = |k: usize| frame(solution.outer_surface_at(k).as_dvec3());
    let along = |[low, high]: [DVec3; 2], target: f64, axis: usize| {
        let (a, b, c) = (low[axis], x[axis], high[axis]);
        // Newton's divided differences through three points.
        let first = (x.z - low.z) / (b - a);
        let second = ((high.z - x.z) / (c - b) - first) / (c - a);
        (target - b) * (first + second * (target - a))
    };
    let height = x.z + along([at(k - 1), at(k + 1)], px, 0) + along([at(k - n), at(k + n)], py, 1);
    height.is_finite().then_some(height)
}

/// The greatest traction of the attachment.
fn traction(solution: &Solution) -> Option<Traction> {
    let problem = solution.problem();
    let rest = problem.sheet().rest();
    problem.patch.attachment()?;
    let mut greatest = Traction { max: 0.0, at_mm: [0.0; 2] };
    for k in free_nodes(solution) {
        let pull = traction_at(solution, k);
        if pull > greatest.max {
            greatest = Traction { max: pull, at_mm: rest[k].to_array() };
        }
    }
    Some(greatest)
}

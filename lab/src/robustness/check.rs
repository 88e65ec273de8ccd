//! Invariants of every displayed shape and of every converged solution.
//!
//! The checks use positions, dome and sheet alone; only energy and forces come from the solver's own
//! (f64) assembly.

use glam::DVec3;
use implant_preview_core::mesh::{NodeKind, Sheet};
use implant_preview_core::solve::validity::VIEWPOINT_DEPTH;
use implant_preview_core::solve::{Solver, Verdict};
use implant_preview_core::springs::Springs;
use serde::Serialize;

/// A failed check with its value and its bound.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// The name of the check.
    pub check: &'static str,
    /// The value.
    pub found: f64,
    /// The greatest allowed value.
    pub allowed: f64,
}

/// Greatest residual of a converged solution \[fraction of the forces of all triangles\].
pub const MAX_RESIDUAL: f64 = 2e-2;
/// Greatest work of one solve \[evaluations of all forces on the finest grid\].
pub const MAX_WORK_UNITS: f64 = 20_000.0;
/// Allowed rise of the energy above the initial energy by rounding \[fraction of the initial energy\].
const ENERGY_ROUNDING: f64 = 1e-6;
/// Allowed rise of the energy by a position error of one tolerance \[stiffness × error²\]; the initial
/// shape may already be the solution.
const ENERGY_PER_SQUARED_ERROR: f64 = 10.0;
/// Greatest cosine of a triangle that faces away from the skin's side; a wrinkled sheet is not flat.
const MAX_INWARD_COSINE: f64 = 0.3;

/// Adds a finding if the value exceeds its bound or is not a number.
pub(super) fn require_at_most(
    findings: &mut Vec<Finding>,
    check: &'static str,
    found: f64,
    allowed: f64,
) {
    if found.is_nan() || found > allowed {
        findings.push(Finding { check, found, allowed });
    }
}

/// Lists the invariants that a finished solve violates.
#[must_use]
pub fn check(solver: &Solver) -> Vec<Finding> {
    let mut findings = Vec::new();
    let problem = solver.problem();
    let (sheet, dome, x) = (problem.sheet(), &problem.obstacle.dome, solver.positions());
    let broken = x.iter().filter(|x| !x.is_finite()).count();
    require_at_most(&mut findings, "non-finite nodes", broken as f64, 0.0);
    require_at_most(&mut findings, "work units", solver.work_units(), MAX_WORK_UNITS);
    if broken > 0 || solver.verdict() == Verdict::Unstable || solver.invalid().is_some() {
        return findings;
    }
    let tolerance = problem.tolerance * dome.reference_length();
    require_at_most(&mut findings, "depth in the dome, mm", depth_in_dome(solver), tolerance);
    let depth = x.iter().map(|x| -x.z).fold(0.0, f64::max);
    require_at_most(&mut findings, "depth below the wall, mm", depth, tolerance);
    require_at_most(
        &mut findings,
        "inward normal, cosine",
        inward_cosine(sheet, x),
        MAX_INWARD_COSINE,
    );
    if solver.verdict() != Verdict::Converged {
        return findings;
    }
    require_at_most(
        &mut findings,
        "estimated error",
        solver.estimated_position_error(),
        problem.tolerance,
    );
    if problem.springs == Springs::Coupled {
        require_at_most(&mut findings, "asymmetry, mm", asymmetry(solver), tolerance);
    }
    // The initial shape, made admissible: outside of the dome, with the solution's contact offsets.
    let mut start = solver.start_shape();
    for x in start.iter_mut().filter(|x| dome.contains(**x)) {
        *x = dome.onto_surface(*x);
    }
    for (k, offset) in solver.offset_nodes() {
        let (x, level) = (&mut start[*k], dome.gauge(*offset));
        if dome.gauge(*x) < level {
            *x = dome.project(*x, level);
        }
    }
    let (before, now) = (solver.energy(&start), solver.energy(&solver.solution().balanced()));
    let allowed = ENERGY_ROUNDING * before.abs()
        + ENERGY_PER_SQUARED_ERROR * solver.stiffness() * tolerance * tolerance;
    require_at_most(&mut findings, "energy above the initial energy", now - before, allowed);
    require_at_most(&mut findings, "relative residual", relative_residual(solver), MAX_RESIDUAL);
    findings
}

/// Greatest distance of a node from its mirror image along each symmetric axis of the scene \[mm\].
fn asymmetry(solver: &Solver) -> f64 {
    let problem = solver.problem();
    let axes = problem.mirrored();
    asymmetry_of(solver.positions(), problem.sheet().nodes_per_side(), axes)
}

/// Greatest distance of a node from its mirror image along x and y, where symmetric \[mm\].
pub(super) fn asymmetry_of(x: &[DVec3], n: usize, [along_x, along_y]: [bool; 2]) -> f64 {
    let mut most = 0.0_f64;
    for (k, position) in x.iter().enumerate() {
        let (i, j) = (k % n, k / n);
        if along_x {
            let image = x[j * n + n - 1 - i] * DVec3::new(-1.0, 1.0, 1.0);
            most = most.max(position.distance(image));
        }
        if along_y {
            let image = x[(n - 1 - j) * n + i] * DVec3::new(1.0, -1.0, 1.0);
            most = most.max(position.distance(image));
        }
    }
    most
}

/// Greatest depth of a node in the dome \[mm\].
pub(super) fn depth_in_dome(solver: &Solver) -> f64 {
    let dome = &solver.problem().obstacle.dome;
    let inside = solver.positions().iter().filter(|x| dome.contains(**x));
    inside.map(|x| -dome.closest_point(*x).0).fold(0.0, f64::max)
}

/// Greatest inward component of the triangles' unit normals: minus the cosine of the angle between the
/// normal and the ray to the triangle from a point below the pocket's centre.
///
/// The cosine is negative for every triangle of a sheet stretched over a dome.
#[must_use]
pub fn inward_cosine(sheet: &Sheet, x: &[DVec3]) -> f64 {
    let eye = DVec3::new(0.0, 0.0, -VIEWPOINT_DEPTH * sheet.radius_mm());
    sheet
        .triangles()
        .map(|(nodes, _)| {
            let [a, b, c] = nodes.map(|k| x[k]);
            let normal = (b - a).cross(c - a);
            let middle = (a + b + c) / 3.0 - eye;
            -normal.dot(middle) / (normal.length() * middle.length()).max(f64::MIN_POSITIVE)
        })
        .fold(f64::NEG_INFINITY, f64::max)
}

/// Norm of the residual on free nodes without the reactions of dome and wall, relative to the forces of
/// all triangles.
fn relative_residual(solver: &Solver) -> f64 {
    let problem = solver.problem();
    let (dome, x, (forces, scale)) = (
        &problem.obstacle.dome,
        solver.solution().balanced().into_owned(),
        solver.forces_and_scale(),
    );
    let touch = 1e-5 * dome.reference_length();
    let mut has_offset = vec![false; x.len()];
    solver.offset_nodes().iter().for_each(|&(k, _)| has_offset[k] = true);
    let mut residual = 0.0;
    for (k, kind) in problem.sheet().kinds().iter().enumerate() {
        if *kind != NodeKind::Free {
            continue;
        }
        let normal = dome.normal(x[k]);
        let is_on_dome = has_offset[k] || dome.closest_point(x[k]).0 <= touch;
        let is_on_wall = problem.obstacle.wall.gap(x[k]) <= touch;
        residual +=
            unbalanced(forces[k], is_on_dome.then_some(normal), is_on_wall).length_squared();
    }
    // The lower bound keeps rounding errors of a sheet at rest small.
    let least = 1e-6 * solver.stiffness() * problem.sheet().spacing_mm();
    residual.sqrt() / scale.max(least)
}

/// The part of a force that reactions of the dome (its normal), of the wall or of both cannot balance.
fn unbalanced(force: DVec3, dome: Option<DVec3>, is_on_wall: bool) -> DVec3 {
    let without = |normal: DVec3| force - normal * force.dot(normal).min(0.0);
    let wall = if is_on_wall { without(DVec3::Z) } else { force };
    let Some(normal) = dome else { return wall };
    let mut least = without(normal);
    if is_on_wall {
        // Both obstacles: the component along their edge remains if both reactions are compressive.
        let (f, z) = (force.dot(normal), normal.z);
        let edge = normal.cross(DVec3::Z).normalize_or_zero();
        if z * force.z >= f && z * f >= force.z && edge != DVec3::ZERO {
            least = edge * force.dot(edge);
        } else if wall.length() < least.length() {
            least = wall;
        }
    }
    least
}

/// Greatest distance between the nodes of two shapes \[mm\].
pub(super) fn distance(x: &[DVec3], y: &[DVec3]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x.distance(*y)).fold(0.0, f64::max)
}

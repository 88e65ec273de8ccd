//! What must hold for every shape that is shown, and for every one that is called converged.
//!
//! Each check starts from positions, dome and sheet alone; only energy and forces come from the
//! solver's own (f64) assembly.

use crate::mesh::{NodeKind, Sheet};
use crate::solve::validity::VIEWPOINT_DEPTH;
use crate::solve::{Solver, Verdict};
use crate::springs::Springs;
use glam::DVec3;
use serde::Serialize;

/// A check that failed: what was found and what is allowed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Finding {
    /// The name of the check.
    pub check: &'static str,
    /// What was found.
    pub found: f64,
    /// The most that is allowed.
    pub allowed: f64,
}

/// Forces that nothing holds, as a share of those of all triangles \[-\].
pub const RESIDUAL: f64 = 2e-2;
/// Work of one solve \[evaluations of all forces on the finest grid\].
pub const WORK_UNITS: f64 = 20_000.0;
/// How much more energy than at its start a shape may have, for rounding \[-\], and for a position error
/// of the tolerance \[times stiffness × error²\]: there may be nothing to do.
const ENERGY_SLACK: f64 = 1e-6;
const ENERGY_OF_ERROR: f64 = 10.0;
/// How far a triangle may face away from the skin's side \[cosine\]: a slack sheet is not flat.
const FACING: f64 = 0.3;

/// Holds a value against what is allowed; what is not a number fails.
pub(super) fn hold(findings: &mut Vec<Finding>, check: &'static str, found: f64, allowed: f64) {
    if found.is_nan() || found > allowed {
        findings.push(Finding { check, found, allowed });
    }
}

/// What is wrong with the shape of a solve that has ended; empty if nothing is.
#[must_use]
pub fn check(solver: &Solver) -> Vec<Finding> {
    let mut findings = Vec::new();
    let problem = solver.problem();
    let (sheet, dome, x) = (&problem.sheet, &problem.obstacle.dome, solver.positions());
    let broken = x.iter().filter(|x| !x.is_finite()).count();
    hold(&mut findings, "nodes that are not finite", broken as f64, 0.0);
    hold(&mut findings, "work units", solver.work_units(), WORK_UNITS);
    if broken > 0 || solver.verdict() == Verdict::Unstable || solver.invalid().is_some() {
        return findings;
    }
    let tolerance = problem.tolerance * dome.base_radius;
    hold(&mut findings, "depth in the dome, mm", depth_in_dome(solver), tolerance);
    let depth = x.iter().map(|x| -x.z).fold(0.0, f64::max);
    hold(&mut findings, "depth below the wall, mm", depth, tolerance);
    hold(&mut findings, "facing inwards", faces_inwards(sheet, x), FACING);
    if solver.verdict() != Verdict::Converged {
        return findings;
    }
    hold(&mut findings, "estimated error", solver.estimated_position_error(), problem.tolerance);
    if problem.springs == Springs::Coupled {
        hold(&mut findings, "not its own mirror image, mm", lopsidedness(solver), tolerance);
    }
    // The start, made admissible: out of the dome, and where the sheet is lifted as far out as there.
    let mut start = solver.start_shape();
    for x in start.iter_mut().filter(|x| dome.contains(**x)) {
        *x = dome.onto_surface(*x);
    }
    for (k, place) in solver.offset_nodes() {
        let (x, gauge) = (&mut start[*k], dome.gauge(*place));
        if dome.gauge(*x) < gauge {
            *x = dome.project(*x, gauge);
        }
    }
    let (before, now) = (solver.energy(&start), solver.energy(&solver.solution().balanced()));
    let slack =
        ENERGY_SLACK * before.abs() + ENERGY_OF_ERROR * solver.stiffness() * tolerance * tolerance;
    hold(&mut findings, "energy above the start", now - before, slack);
    hold(&mut findings, "forces out of balance", imbalance(solver), RESIDUAL);
    findings
}

/// How far the shape of a scene that is its own mirror image along x or y is from being so too \[mm\].
fn lopsidedness(solver: &Solver) -> f64 {
    let (problem, x) = (solver.problem(), solver.positions());
    let n = problem.sheet.nodes_per_side();
    let [along_x, along_y] = problem.obstacle.dome.mirrored();
    let mut most = 0.0_f64;
    for (k, place) in x.iter().enumerate() {
        let (i, j) = (k % n, k / n);
        if along_x {
            let image = x[j * n + n - 1 - i] * DVec3::new(-1.0, 1.0, 1.0);
            most = most.max(place.distance(image));
        }
        if along_y {
            let image = x[(n - 1 - j) * n + i] * DVec3::new(1.0, -1.0, 1.0);
            most = most.max(place.distance(image));
        }
    }
    most
}

/// How deep a node lies in the dome \[mm\].
fn depth_in_dome(solver: &Solver) -> f64 {
    let dome = &solver.problem().obstacle.dome;
    let inside = solver.positions().iter().filter(|x| dome.contains(**x));
    inside.map(|x| -dome.closest_point(*x).0).fold(0.0, f64::max)
}

/// How much the worst triangle faces away from the skin's side: minus the cosine of the angle between
/// its normal and the way there from a point below the pocket's centre.
///
/// A sheet that is pulled over a dome is seen from there without a fold.
#[must_use]
pub fn faces_inwards(sheet: &Sheet, x: &[DVec3]) -> f64 {
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

/// Norm of the forces on free nodes that neither dome nor wall takes, relative to those of all triangles.
fn imbalance(solver: &Solver) -> f64 {
    let problem = solver.problem();
    let (dome, x, (forces, scale)) =
        (&problem.obstacle.dome, solver.solution().balanced(), solver.forces_and_scale());
    let touch = 1e-5 * dome.base_radius;
    let mut is_lifted = vec![false; x.len()];
    solver.offset_nodes().iter().for_each(|&(k, _)| is_lifted[k] = true);
    let mut left = 0.0;
    for (k, kind) in problem.sheet.kinds().iter().enumerate() {
        if *kind != NodeKind::Free {
            continue;
        }
        let normal = dome.normal(x[k]);
        let is_on_dome = is_lifted[k] || dome.closest_point(x[k]).0 <= touch;
        left += unheld(forces[k], is_on_dome.then_some(normal), x[k].z <= touch).length_squared();
    }
    // A sheet at rest has no forces: rounding is not measured against rounding.
    let least = 1e-6 * solver.stiffness() * problem.sheet.spacing_mm();
    left.sqrt() / scale.max(least)
}

/// What is left of a force where the dome (its normal), the wall or both can push against it.
fn unheld(force: DVec3, dome: Option<DVec3>, is_on_wall: bool) -> DVec3 {
    let without = |normal: DVec3| force - normal * force.dot(normal).min(0.0);
    let wall = if is_on_wall { without(DVec3::Z) } else { force };
    let Some(normal) = dome else { return wall };
    let mut least = without(normal);
    if is_on_wall {
        // Both: what is along the edge between them, if each pushes.
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

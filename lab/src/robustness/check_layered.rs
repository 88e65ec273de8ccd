//! Invariants of every displayed shape and of every converged solution of layered tissue.
//!
//! The checks use positions, dome and grid; the deformation gradients come from the solution's own (f64) cells.

use super::check::{
    Finding, MAX_RESIDUAL, MAX_WORK_UNITS, asymmetry_of, depth_in_dome, require_at_most,
};
use super::layers;
use glam::DVec3;
use implant_preview_core::mesh::CellKind;
use implant_preview_core::solve::{Solver, Verdict};

/// Greatest estimated error of a shape that did not converge \[base radius\].
const MAX_ERROR: f64 = 0.01;

/// Failed checks and the least volume of the cells.
pub(super) struct Checked {
    pub(super) findings: Vec<Finding>,
    /// Least determinant of the deformation gradient in the middle of a cell \[-\].
    pub(super) least_volume_ratio: Option<f64>,
    /// Cells with an inverted corner.
    pub(super) inverted_corners: usize,
}

/// Lists the invariants that a finished solve of layered tissue violates.
pub(super) fn check(solver: &Solver) -> Checked {
    let mut checked =
        Checked { findings: Vec::new(), least_volume_ratio: None, inverted_corners: 0 };
    let findings = &mut checked.findings;
    let problem = solver.problem();
    let broken = layers(solver).flatten().filter(|x| !x.is_finite()).count();
    require_at_most(findings, "non-finite nodes", broken as f64, 0.0);
    require_at_most(findings, "work units", solver.work_units(), MAX_WORK_UNITS);
    if broken > 0 || solver.invalid().is_some() {
        let is_converged = solver.verdict() == Verdict::Converged;
        let found = f64::from(u8::from(is_converged));
        require_at_most(findings, "converged without a valid shape", found, 0.0);
        return checked;
    }
    let tolerance = problem.tolerance * problem.obstacle.dome.reference_length();
    require_at_most(findings, "depth in the dome, mm", depth_in_dome(solver), tolerance);
    let wall = &problem.obstacle.wall;
    let depth = solver.positions().iter().map(|x| -wall.gap(*x)).fold(0.0, f64::max);
    require_at_most(findings, "depth below the wall, mm", depth, tolerance);
    let (mut least, mut inverted, mut cells) = (f64::INFINITY, 0, 0);
    solver.solution().visit_cells(|cell| {
        let ratio = cell.gradient.determinant();
        cells += 1;
        // A ratio that is not a number counts as inverted.
        inverted +=
            usize::from(!matches!(ratio.partial_cmp(&0.0), Some(std::cmp::Ordering::Greater)));
        least = least.min(ratio);
    });
    require_at_most(findings, "inverted cells", inverted as f64, 0.0);
    checked.least_volume_ratio = (cells > 0).then_some(least);
    checked.inverted_corners = inverted_corners(solver);
    let error = solver.estimated_position_error();
    if solver.verdict() != Verdict::Converged {
        require_at_most(findings, "estimated error without convergence", error, MAX_ERROR);
        return checked;
    }
    require_at_most(findings, "estimated error", error, problem.tolerance);
    let (n, axes) = (problem.sheet().nodes_per_side(), problem.mirrored());
    let asymmetry = layers(solver).map(|x| asymmetry_of(x, n, axes)).fold(0.0, f64::max);
    require_at_most(findings, "asymmetry, mm", asymmetry, tolerance);
    let residual = solver.report().relative_residual.unwrap_or(f64::NAN);
    require_at_most(findings, "relative residual", residual, MAX_RESIDUAL);
    checked
}

/// Number of cells inside of the patch with an inverted corner: the edges from a corner to its three neighbours span a
/// volume of the wrong sign.
fn inverted_corners(solver: &Solver) -> usize {
    let sheet = solver.problem().sheet();
    let n = sheet.nodes_per_side();
    let faces: Vec<&[DVec3]> = layers(solver).collect();
    let is_inverted = |corners: [usize; 4], below: &[DVec3], above: &[DVec3]| {
        (0..4).any(|c| {
            let [k, next, last] = [0, 1, 3].map(|step| corners[(c + step) % 4]);
            let height = above[k] - below[k];
            [below, above].iter().any(|x| (x[next] - x[k]).cross(x[last] - x[k]).dot(height) <= 0.0)
        })
    };
    let mut count = 0;
    for c in 0..(n - 1) * (n - 1) {
        let (i, j) = (c % (n - 1), c / (n - 1));
        if sheet.cell(i, j) != CellKind::Whole {
            continue;
        }
        let corners = sheet.corners(i, j);
        count += faces.windows(2).filter(|pair| is_inverted(corners, pair[0], pair[1])).count();
    }
    count
}

//! Small tolerances: Newton's method completes the solution of multigrid.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview_core::scene::Scene;
use implant_preview_core::solve::{Method, Solver, Verdict};
use implant_preview_lab::robustness::clinical::Clinical;

fn solved(scene: &Scene) -> Solver {
    let mut solver = Solver::new(scene.problem().unwrap());
    solver.advance(&mut || false);
    solver
}

fn body(case: u64, nodes_per_side: usize, tolerance: f64) -> Scene {
    let clinical = Clinical { has_terrain: true, nodes_per_side, ..Clinical::default() };
    let mut scene = clinical.scene(11, case);
    scene.solver.tolerance = tolerance;
    scene
}

/// Greatest distance of a node of the inner face \[base radius\].
fn distance(a: &Solver, b: &Solver) -> f64 {
    let apart = a.positions().iter().zip(b.positions()).map(|(a, b)| a.distance(*b));
    apart.fold(0.0, f64::max) / a.problem().obstacle.dome.reference_length()
}

/// Both had ended above a tolerance of 1e-6 although their errors were some 1e-8: the limit of work of a failed solve cut the step that
/// gives the estimate.
#[test]
fn a_tight_tolerance_has_the_work_that_it_needs() {
    for (case, tolerance) in [(1, 1e-6), (3, 1e-7)] {
        let solver = solved(&body(case, 65, tolerance));
        let (report, estimate) = (solver.report(), solver.estimated_position_error());
        assert_eq!((report.verdict, report.method), (Verdict::Converged, Method::Newton));
        assert!(report.work_units <= 700.0 && estimate <= tolerance, "{}", report.work_units);
        let fine = solver.refined(0.01 * tolerance, 10.0);
        assert_eq!(fine.verdict(), Verdict::Converged);
        let error = distance(&solver, &fine);
        assert!(error <= estimate, "{case}: {error:e} {estimate:e}");
    }
}

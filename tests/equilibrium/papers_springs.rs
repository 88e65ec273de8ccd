//! The paper's springs over a dome.

use super::*;

/// With compressive paper's springs the steps of the positive semidefinite model had been much too small.
#[test]
fn compressive_sheets_of_the_papers_springs_are_solved_within_their_error() {
    let scene = json!({ "tissue_model": "sheet", "springs": "nikolaev",
        "implant": { "base_radius_mm": 13.9, "projection_mm": 15.8, "center_mm": [0.0, 17.6] },
        "pocket_radius_mm": 31.52, "insertion": 0.8, "layers": [{ "tissue": "skin",
            "thickness_mm": 0.7, "poisson_ratio": 0.065, "curve": { "kind": "skin" } }] });
    let scene = Scene::from_json(&scene.to_string()).unwrap();
    for nodes in [65, 89] {
        let (exact, solver) = (solved(&scene, nodes, 1e-7), solved(&scene, nodes, 1e-4));
        assert_eq!(exact.verdict(), Verdict::Converged);
        assert_eq!(solver.verdict(), Verdict::Converged);
        let error = apart(&exact, &solver);
        assert!(error <= 2.0 * solver.estimated_position_error(), "{nodes}: {error:.1e}");
    }
}

/// The paper's springs of one layer over a half ellipsoid.
fn paper_scene(curve: &Value, poisson_ratio: f64, insertion: f64, center_mm: [f64; 2]) -> Scene {
    let scene = json!({
        "tissue_model": "sheet",
        "implant": { "base_radius_mm": 55, "projection_mm": 45, "center_mm": center_mm },
        "pocket_radius_mm": 75, "insertion": insertion, "springs": "nikolaev",
        "layers": [{ "tissue": "tissue", "thickness_mm": 2, "poisson_ratio": poisson_ratio,
            "curve": curve }],
    });
    Scene::from_json(&scene.to_string()).unwrap()
}

#[test]
fn the_papers_springs_over_a_dome_are_solved_by_the_same_cycles() {
    let (skin, linear) =
        (json!({ "kind": "skin" }), json!({ "kind": "linear", "modulus_kpa": 50 }));
    for (curve, nu, insertion, center) in [
        (&skin, 0.3, 1.0, [0.0, 0.0]),
        (&skin, 0.45, 0.5, [6.0, 4.0]),
        (&linear, 0.2, 1.0, [6.0, 4.0]),
    ] {
        let scene = paper_scene(curve, nu, insertion, center);
        let found = solved(&scene, 65, 1e-4);
        assert_eq!(found.verdict(), Verdict::Converged);
        assert!(!found.fell_back() && (1..10).contains(&found.cycles()), "{}", found.cycles());
        let [cycles, newton] = [Method::Multigrid { cycles: 14 }, Method::Newton].map(|method| {
            let mut problem = scene.problem().unwrap();
            problem.tolerance = 1e-8;
            problem.rest = found.problem().rest.clone();
            let mut solver =
                Solver::with_options(problem, Options { method, ..Options::default() });
            solver.advance(&mut || false);
            solver
        });
        assert_eq!(newton.verdict(), Verdict::Converged);
        for (a, b) in cycles.positions().iter().zip(newton.positions()) {
            let error = a.distance(*b) / scene.implant.base_radius_mm;
            assert!(error < 5e-6, "{curve} {nu}: {error:.1e}");
        }
    }
}

#[test]
fn the_papers_springs_without_a_stable_shape_end_soon() {
    let scene = paper_scene(&json!({ "kind": "adipose" }), 0.45, 1.0, [0.0, 0.0]);
    for nodes in [33, 65] {
        let solver = solved(&scene, nodes, 1e-4);
        assert_eq!(solver.verdict(), Verdict::Unstable);
        assert!(solver.work_units() < 2000.0, "{}", solver.work_units());
    }
}

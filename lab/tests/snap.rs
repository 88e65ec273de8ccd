//! Steep domes on coarse grids: large cells of the inner face, nodes that snap from one place to the next, skin in the dome.

use implant_preview_core::measure::Status;
use implant_preview_core::scene::Scene;
use implant_preview_core::simulate::simulate;
use implant_preview_core::solve::{Method, Solver, Verdict};
use implant_preview_lab::robustness::clinical::Clinical;

fn on(nodes: usize, scene: &Scene) -> Scene {
    let mut scene = scene.clone();
    scene.solver.nodes_per_side = nodes;
    scene
}

fn force(scene: &Scene) -> f64 {
    simulate(scene).expect("a scene within the limits").contact_force_n.expect("a shape")
}

/// Random patients without a shape on 33 nodes before: cells of two were deeper in the dome than those of a sheet may be, nodes of two
/// were still on their way after six slow cycles. The coarse grid is right within a tenth.
#[test]
fn fat_squeezed_off_the_apex_has_a_shape_on_a_coarse_grid() {
    let population = Clinical { nodes_per_side: 33, has_terrain: true, ..Clinical::default() };
    for case in [147, 264, 1437, 1769] {
        let scene = population.scene(7, case);
        let coarse = scene.clone();
        let mut solver =
            Solver::new(coarse.problem().expect("a random patient is within the limits"));
        solver.advance(&mut || false);
        assert_eq!(solver.verdict(), Verdict::Converged, "{case}");
        assert!(matches!(solver.report().method, Method::Multigrid { .. }), "{case}");
        let [coarse, fine] = [coarse, on(65, &scene)].map(|scene| force(&scene));
        println!("{case}: {:.3}", coarse / fine);
        assert!((coarse / fine - 1.0).abs() < 0.1, "{case}: {coarse} {fine} N");
    }
}

/// A converged cover below zero stood in results and spread over maps.
#[test]
fn a_skin_in_the_dome_is_no_shape() {
    let steep = r#"{ "implant": { "base_radius_mm": 41.37931034, "projection_mm": 64.82758621 }, "chest": { "radius_across_mm": 140 },
                     "pocket_radius_mm": 51.37931034, "solver": { "tolerance": 1e-3 },
                     "patient": { "base_width_mm": 120, "pinch_mm": 20, "skin_class": "normal" } }"#;
    let scene = Scene::from_json(steep).expect("a scene within the limits");
    let coarse = simulate(&on(33, &scene)).expect("a scene within the limits");
    assert_eq!(coarse.status, Status::Unstable);
    assert!(coarse.warnings.iter().any(|line| line.contains("protrudes")), "{:?}", coarse.warnings);
    let fine = simulate(&on(65, &scene)).expect("a scene within the limits");
    let cover = fine.cover_mm.expect("a shape");
    assert!(fine.status == Status::Converged && cover.least > 3.0, "{cover:?}");
}

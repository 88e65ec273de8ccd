//! Steep domes on coarse grids: large cells of the inner face, nodes that snap from one place to the next, skin in the dome.

use implant_preview_core::measure::{Outcome, SolverMethod, Status};
use implant_preview_core::scene::Scene;
use implant_preview_core::simulate::simulate;
use implant_preview_lab::robustness::clinical::Clinical;

fn on(nodes: usize, scene: &Scene) -> Outcome {
    let mut scene = scene.clone();
    scene.solver.nodes_per_side = nodes;
    simulate(&scene).expect("a scene within the limits")
}

/// Random patients without a shape on 33 nodes before: cells of two were deeper in the dome than those of a sheet may be, nodes of two
/// were still on their way after six slow cycles. The coarse grid is right within a tenth.
#[test]
fn fat_squeezed_off_the_apex_has_a_shape_on_a_coarse_grid() {
    let population = Clinical { nodes_per_side: 33, has_terrain: true, ..Clinical::default() };
    for case in [147, 264, 1437, 1769] {
        let scene = population.scene(7, case);
        let [coarse, fine] = [33, 65].map(|nodes| on(nodes, &scene));
        assert_eq!(coarse.status, Status::Converged, "{case}");
        assert_eq!(coarse.solver.method, SolverMethod::Multigrid, "{case}");
        let [coarse, fine] = [coarse, fine].map(|it| it.contact_force_n.expect("a shape"));
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
    let coarse = on(33, &scene);
    assert_eq!(coarse.status, Status::Unstable);
    assert!(coarse.warnings.iter().any(|line| line.contains("protrudes")), "{:?}", coarse.warnings);
    let fine = on(65, &scene);
    let cover = fine.cover_mm.expect("a shape");
    assert!(fine.status == Status::Converged && cover.least > 3.0, "{cover:?}");
}

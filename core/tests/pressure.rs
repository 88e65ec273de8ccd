//! The contact pressure: its mean, the force over a contact area that follows the contact's edge between the nodes, and the greatest.

#![allow(clippy::unwrap_used)]

use implant_preview_core::scene::{Fill, Scene};
use implant_preview_core::study::{Case, Job, Quantity, evaluate};

fn cases(scene: &Scene, nodes: usize, projections: impl Iterator<Item = f64>) -> Vec<Case> {
    let of = |projection_mm: f64| {
        let mut scene = scene.clone();
        scene.implant.projection_mm = projection_mm;
        (scene.solver.nodes_per_side, scene.solver.tolerance) = (nodes, 1e-4);
        scene
    };
    evaluate(&Job { scenes: projections.map(of).collect(), ..Job::default() })
}

fn mean(case: &Case) -> f64 {
    case.values.get(Quantity::MeanPressureKpa).unwrap()
}

/// Each value against the middle of both beside it. The contact's edge moves over two spacings of the grid; where the area
/// jumped from node to node the mean jumped by 0.2 to 0.65 %.
#[test]
fn the_mean_changes_without_jumps_while_the_projection_grows_by_tenths_of_a_millimetre() {
    let flat = Scene { chest: None, ..Scene::opening() };
    for (scene, least) in
        [(Scene::sheet(), 20.0), (Scene::sheet(), 40.0), (flat, 25.0), (Scene::opening(), 40.0)]
    {
        for nodes in [33, 65] {
            let steps = (0..60).map(|k| least + 0.1 * f64::from(k));
            let values: Vec<f64> = cases(&scene, nodes, steps).iter().map(mean).collect();
            for (k, v) in values.windows(3).enumerate() {
                let from_middle = 0.5 * (v[0] + v[2]) / v[1] - 1.0;
                let at = least + 0.1 * (k + 1) as f64;
                assert!(from_middle.abs() < 1e-3, "{nodes} nodes, {at:.1} mm: {from_middle:.1e}");
            }
        }
    }
}

/// The greatest pressure of layered tissue, at the shoulder and at the apex. Where the shoulder's and the apex' are equal the greatest
/// one has a kink on every grid, that of the opening plan at 32 mm.
#[test]
fn the_greatest_changes_without_jumps_while_the_projection_grows_by_tenths_of_a_millimetre() {
    let flat = Scene { chest: None, ..Scene::opening() };
    for (scene, least) in
        [(&flat, 25.0), (&flat, 43.0), (&Scene::opening(), 24.0), (&Scene::opening(), 36.0)]
    {
        for nodes in [33, 65] {
            let steps = (0..60).map(|k| least + 0.1 * f64::from(k));
            let of = |case: &Case| case.values.get(Quantity::GreatestPressureKpa).unwrap();
            let values: Vec<f64> = cases(scene, nodes, steps).iter().map(of).collect();
            for (k, v) in values.windows(3).enumerate() {
                let from_middle = 0.5 * (v[0] + v[2]) / v[1] - 1.0;
                let at = least + 0.1 * (k + 1) as f64;
                assert!(from_middle.abs() < 1e-3, "{nodes} nodes, {at:.1} mm: {from_middle:.1e}");
            }
        }
    }
}

/// The area of a contact that fine grids resolve: 257 nodes per side of sheets, 129 of layered tissue.
#[test]
fn the_mean_on_coarse_grids_is_that_of_fine_ones() {
    let bounds = |scene: Scene, projections: [f64; 2], fine: usize, bounds: [f64; 2]| {
        for projection in projections {
            let of = |nodes| mean(&cases(&scene, nodes, std::iter::once(projection))[0]);
            let exact = of(fine);
            for (nodes, bound) in [33, 65].into_iter().zip(bounds) {
                let error = of(nodes) / exact - 1.0;
                assert!(error.abs() < bound, "{projection} mm at {nodes} nodes: {error:.4}");
            }
        }
    };
    bounds(Scene::sheet(), [25.0, 30.0], 257, [0.04, 0.01]);
    bounds(Scene::sheet(), [40.0, 45.0], 257, [0.004, 0.002]);
    let flat = Scene { chest: None, ..Scene::opening() };
    let mut gel = Scene::opening();
    gel.implant.fill = Some(Fill::Cohesive);
    bounds(flat, [25.0, 40.0], 129, [0.015, 0.008]);
    bounds(Scene::opening(), [25.0, 40.0], 129, [0.015, 0.008]);
    bounds(gel, [25.0, 40.0], 129, [0.03, 0.008]);
}

/// Nodes beyond the disc have no area, and the coarsest grids have them near the contact's edge.
#[test]
fn the_coarsest_grids_have_a_mean_as_well() {
    for (scene, from) in [(Scene::sheet(), 5.0), (Scene::opening(), 5.0)] {
        let steps = (0..10).map(|k| from + 4.0 * f64::from(k));
        for case in cases(&scene, 17, steps) {
            let of = |quantity| case.values.get(quantity);
            let mean = of(Quantity::MeanPressureKpa);
            let greatest = of(Quantity::GreatestPressureKpa);
            assert!(mean > Some(0.0) && mean <= greatest, "{mean:?} {greatest:?}");
        }
    }
}

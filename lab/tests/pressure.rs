//! The contact pressure of layered tissue against axisymmetric elements.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview_core::measure::{Field, Fields, Pressure};
use implant_preview_core::scene::{CheckedScene, ChestShape, Scene};
use implant_preview_core::simulate;
use implant_preview_core::solve::Options;
use implant_preview_lab::axisymmetric_layers::{self, Input, Solution};
use std::sync::Arc;

/// The opening plan over a wall, a plane or a sphere.
fn scene(base_radius_mm: f64, projection_mm: f64, fat_mm: f64, chest_mm: Option<f64>) -> Scene {
    let chest = |radius| ChestShape { radius_across_mm: radius, radius_along_mm: Some(radius) };
    let mut scene = Scene { chest: chest_mm.map(chest), ..Scene::opening() };
    scene.implant.fill = None;
    (scene.implant.base_radius_mm, scene.implant.projection_mm) = (base_radius_mm, projection_mm);
    scene.layers[1].thickness_mm = fat_mm;
    scene.solver.tolerance = 1e-4;
    scene
}

/// Errors of the greatest and of the mean pressure, and root mean square of the differences at the nodes with pressure over the elements' greatest pressure.
fn errors(scene: &Scene, nodes: usize, elements: &Solution, expected_mean: f64) -> [f64; 3] {
    let mut scene = scene.clone();
    scene.solver.nodes_per_side = nodes;
    let found = simulate::run(&CheckedScene::new(scene).unwrap(), Options::default(), None);
    let fields = Fields::new(Arc::clone(&found.solution));
    let greatest = elements.greatest_pressure_kpa();
    let (mut squares, mut count) = (0.0, 0.0);
    let rest = found.solution.problem().sheet().rest();
    for (place, pressure) in rest.iter().zip(fields.values(Field::ContactPressure)) {
        let expected = elements.pressure_at(place.length());
        if expected > 0.0 || *pressure > 0.0 {
            squares += ((f64::from(*pressure) - expected) / greatest).powi(2);
            count += 1.0;
        }
    }
    let Pressure { mean, max } = found.outcome.contact_pressure_kpa.unwrap();
    [max / greatest - 1.0, mean / expected_mean - 1.0, f64::sqrt(squares / count)]
}

/// The greatest pressure is at the apex or over the shoulder, within a cell of the coarsest grid from the contact's edge.
#[test]
fn the_pressure_of_layered_tissue_is_that_of_the_elements() {
    for (radius, projection, fat, chest) in [
        (60.0, 20.0, 8.5, None),
        (60.0, 30.0, 8.5, None),
        (60.0, 40.0, 8.5, None),
        (60.0, 50.0, 8.5, None),
        (60.0, 25.0, 20.0, None),
        (60.0, 40.0, 20.0, None),
        (50.0, 30.0, 8.5, None),
        (60.0, 25.0, 8.5, Some(150.0)),
        (60.0, 45.0, 8.5, Some(150.0)),
    ] {
        let scene = scene(radius, projection, fat, chest);
        let problem = scene.problem().unwrap();
        let by = |cells| {
            axisymmetric_layers::solve(&Input::of(&scene, &problem, cells).unwrap()).unwrap()
        };
        let elements = by([216, 12]);
        let greatest = elements.greatest_pressure_kpa();
        assert!((by([144, 8]).greatest_pressure_kpa() / greatest - 1.0).abs() < 2e-3);
        // The mean depends on the contact's edge, which a finer mesh locates.
        let mean = by([324, 12]).mean_pressure_kpa().unwrap();
        assert!((elements.mean_pressure_kpa().unwrap() / mean - 1.0).abs() < 6e-3);
        for (nodes, bounds) in
            [(33, [0.04, 0.07, 0.09]), (65, [0.01, 0.02, 0.045]), (129, [0.004, 0.01, 0.018])]
        {
            let found = errors(&scene, nodes, &elements, mean);
            eprintln!(
                "{radius} {projection} {fat} {chest:?} {nodes}: {greatest:.3}, {mean:.3} kPa {found:.4?}"
            );
            assert!(
                found.iter().zip(bounds).all(|(error, bound)| error.abs() < bound),
                "{radius} {projection} {fat} {chest:?} {nodes}: {found:?}"
            );
        }
    }
}

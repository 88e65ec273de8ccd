//! Layered tissue over a curved wall compared with independent axisymmetric elements.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use glam::DVec2;
use implant_preview::measure::Fields;
use implant_preview::mesh::{Chest, HeightGrid, ThicknessField};
use implant_preview::scene::{CheckedScene, Scene};
use implant_preview::simulate;
use implant_preview::solve::{Progress, Solution, Solver, Verdict};
use serde_json::{Value, json};
use std::sync::Arc;

fn number(of: &Value, name: &str) -> f64 {
    of[name].as_f64().unwrap()
}

/// Samples row by row, spacing in mm, centred, 270 mm wide or more.
fn samples(spacing: f64, of: impl Fn(DVec2) -> f64) -> ([usize; 2], Vec<f64>) {
    let half = (135.0 / spacing).ceil();
    let count = 2 * half as usize + 1;
    let place = |k: usize| DVec2::new((k % count) as f64 - half, (k / count) as f64 - half);
    ([count; 2], (0..count * count).map(|k| of(place(k) * spacing)).collect())
}

/// The scene of a case without wall and mound.
fn scene(case: &Value, nodes: usize) -> CheckedScene {
    let cells = if case["mound"].is_null() { 2 } else { 4 };
    let scene = json!({
        "schema": "implant-preview/scene/2",
        "implant": { "base_radius_mm": case["base_radius_mm"],
                     "projection_mm": case["projection_mm"] },
        "pocket_radius_mm": case["pocket_radius_mm"],
        "patch_radius_mm": case["patch_radius_mm"],
        "layers": case["layers"],
        "tissue_model": "layered",
        "solver": { "nodes_per_side": nodes, "tolerance": 1e-4, "cells_through": cells },
    });
    CheckedScene::new(Scene::from_json(&scene.to_string()).unwrap()).unwrap()
}

/// Solves a case over a wall.
fn solve(case: &Value, nodes: usize, chest: Chest) -> Arc<Solution> {
    let mut problem = scene(case, nodes).problem();
    if let Some(mound) = case.get("mound") {
        let [height, width] = ["height_mm", "width_mm"].map(|name| number(mound, name));
        let solids = number(&case["layers"][1], "thickness_mm");
        let (counts, factors) = samples(3.0, |place| {
            1.0 + height / solids * (-place.length_squared() / (width * width)).exp()
        });
        let field = ThicknessField::new(3.0, counts, factors).unwrap();
        problem.rest = problem.rest.thickened(field);
    }
    problem.rest = problem.rest.over(chest.clone());
    problem.obstacle = problem.obstacle.over(chest);
    let mut solver = Solver::new(problem);
    while solver.advance(&mut || false) == Progress::Working {}
    let solution = Arc::new(solver.solution());
    assert_eq!(solution.report().verdict, Verdict::Converged);
    assert!(!solution.report().fell_back);
    solution
}

/// Greatest distance of the skin from the limit of both meshes [base radius], relative error of the force.
fn errors(meshes: &[Value], nodes: usize) -> [f64; 2] {
    let limit = |of: &dyn Fn(&Value) -> f64| {
        let [coarse, fine] = [0, 1].map(|k| of(&meshes[k]["result"]));
        (4.0 * fine - coarse) / 3.0
    };
    let case = &meshes[0];
    let wall = case["wall"]["radius_mm"].as_f64();
    let chest = wall.map_or(Chest::Flat, |r| Chest::Curved { across_mm: r, along_mm: r });
    let (scene, solution) = (scene(case, nodes), solve(case, nodes, chest));
    let found = simulate::measure(scene.scene(), &Fields::new(Arc::clone(&solution)));
    let skin = solution.membrane();
    let sheet = solution.problem().sheet();
    let n = sheet.nodes_per_side();
    let places: Vec<f64> =
        serde_json::from_value(meshes[0]["result"]["material_radius_mm"].clone()).unwrap();
    let profile: Vec<[f64; 2]> = (0..places.len())
        .map(|k| [0, 1].map(|i| limit(&|of| of["skin"][k][i].as_f64().unwrap())))
        .collect();
    let step = places[1];
    let mut greatest = 0.0_f64;
    for i in n / 2..n - 1 {
        let k = n / 2 * n + i;
        let s = sheet.rest()[k].x / step;
        let at = (s as usize).clamp(1, places.len() - 3);
        let t = s - at as f64;
        // Cubic interpolation of the reference.
        let weights = [
            -t * (t - 1.0) * (t - 2.0) / 6.0,
            (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
            -(t + 1.0) * t * (t - 2.0) / 2.0,
            (t + 1.0) * t * (t - 1.0) / 6.0,
        ];
        let [r, z] =
            [0, 1].map(|axis| (0..4).map(|j| weights[j] * profile[at + j - 1][axis]).sum::<f64>());
        let error = (skin[k].x - r).hypot(skin[k].z - z) / number(case, "base_radius_mm");
        greatest = greatest.max(error);
    }
    let force = found.contact_force_n.unwrap() / limit(&|of| number(of, "contact_force_n")) - 1.0;
    [greatest, force]
}

/// The cases of the reference, both meshes of each.
fn cases() -> Vec<Value> {
    let file: Value = serde_json::from_str(include_str!("reference/body.json")).unwrap();
    file["cases"].as_array().unwrap().clone()
}

#[test]
fn tissue_over_a_sphere_and_under_a_mound_agrees_with_independent_elements_as_flat_tissue_does() {
    for meshes in cases().chunks(2) {
        let [coarse, fine] = [33, 65].map(|nodes| errors(meshes, nodes));
        assert!(fine[0] < 1.2e-3 && fine[1].abs() < 5e-3, "{fine:?}");
        let order = (coarse[0] / fine[0]).log2();
        assert!(order > 1.25, "{order}");
    }
}

#[test]
fn a_grid_of_a_spheres_heights_gives_the_shape_over_the_sphere() {
    let cases = cases();
    let case = cases.iter().find(|case| case["name"] == "curved-mound").unwrap();
    let radius = number(&case["wall"], "radius_mm");
    let sphere = Chest::Curved { across_mm: radius, along_mm: radius };
    let (counts, heights) = samples(4.0, |at| 7.0 + sphere.height(at));
    let grid = Chest::Grid(HeightGrid::new(4.0, counts, heights).unwrap());
    let [exact, found] = [sphere, grid].map(|chest| solve(case, 33, chest));
    let base = number(case, "base_radius_mm");
    for (a, b) in exact.membrane().iter().zip(found.membrane()) {
        assert!(a.distance(*b) < 1e-4 * base, "{a} {b}");
    }
}

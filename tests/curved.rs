//! Layered tissue over a curved wall compared with independent axisymmetric elements.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview::measure::Fields;
use implant_preview::mesh::Chest;
use implant_preview::scene::{CheckedScene, Scene};
use implant_preview::simulate;
use implant_preview::solve::{Method, Options, Progress, Solver, Verdict};
use serde_json::{Value, json};
use std::sync::Arc;

fn number(of: &Value, name: &str) -> f64 {
    of[name].as_f64().unwrap()
}

/// Greatest distance of the skin from the limit of both meshes [base radius], relative error of the force; Newton's method.
fn errors(meshes: &[Value], nodes: usize) -> [f64; 2] {
    let limit = |of: &dyn Fn(&Value) -> f64| {
        let [coarse, fine] = [0, 1].map(|k| of(&meshes[k]["result"]));
        (4.0 * fine - coarse) / 3.0
    };
    let case = &meshes[0];
    let scene = json!({
        "schema": "implant-preview/scene/2",
        "implant": { "base_radius_mm": case["base_radius_mm"],
                     "projection_mm": case["projection_mm"] },
        "pocket_radius_mm": case["pocket_radius_mm"],
        "patch_radius_mm": case["patch_radius_mm"],
        "layers": case["layers"],
        "tissue_model": "layered",
        "solver": { "nodes_per_side": nodes, "tolerance": 1e-4, "cells_through": 2 },
    });
    let scene = CheckedScene::new(Scene::from_json(&scene.to_string()).unwrap()).unwrap();
    let mut problem = scene.problem();
    let wall = case["wall"]["radius_mm"].as_f64();
    let chest = wall.map_or(Chest::Flat, |r| Chest::Curved { across_mm: r, along_mm: r });
    problem.rest = problem.rest.over(chest.clone());
    problem.obstacle = problem.obstacle.over(chest);
    let options = Options { method: Method::Newton, ..Options::default() };
    let mut solver = Solver::with_options(problem, options);
    while solver.advance(&mut || false) == Progress::Working {}
    let solution = Arc::new(solver.solution());
    assert_eq!(solution.report().verdict, Verdict::Converged);
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

#[test]
fn tissue_over_a_sphere_agrees_with_independent_elements_as_flat_tissue_does() {
    let file: Value = serde_json::from_str(include_str!("reference/body.json")).unwrap();
    let cases = file["cases"].as_array().unwrap();
    for meshes in cases.chunks(2).filter(|meshes| meshes[0]["mound"].is_null()) {
        let [coarse, fine] = [33, 65].map(|nodes| errors(meshes, nodes));
        assert!(fine[0] < 1.2e-3 && fine[1].abs() < 5e-3, "{fine:?}");
        let order = (coarse[0] / fine[0]).log2();
        assert!(order > 1.25, "{order}");
    }
}

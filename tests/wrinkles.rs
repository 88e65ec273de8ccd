//! Wrinkles of the skin in results: the share of wrinkled skin, and the warning of visible folds.

#![allow(clippy::float_cmp, reason = "states are whole numbers")]

use implant_preview::curve::Curve;
use implant_preview::measure::{Field, Fields, Outcome, Status};
use implant_preview::scene::{CheckedScene, Scene};
use implant_preview::simulate::{Simulation, run, simulate};
use implant_preview::solve::Options;
use implant_preview::springs::Springs;
use serde_json::{Value, json};
use std::sync::Arc;

fn scene(fields: &Value) -> Scene {
    let mut scene = json!({ "implant": { "base_radius_mm": 60, "projection_mm": 45 },
                            "solver": { "nodes_per_side": 33, "tolerance": 1e-3 } });
    for (name, value) in fields.as_object().into_iter().flatten() {
        scene[name] = value.clone();
    }
    Scene::from_json(&scene.to_string()).expect("the scene is valid")
}

/// Fat of 50 mm: the implant moves the fat outwards, and the radii of the skin beyond the pocket shorten by up to a tenth.
fn thick() -> Scene {
    scene(&json!({ "pocket_radius_mm": 65,
                   "layers": [ { "tissue": "skin", "curve": { "kind": "skin" } },
                               { "tissue": "adipose", "thickness_mm": 50, "poisson_ratio": 0.49,
                                 "curve": { "kind": "fat" } } ] }))
}

/// An implant off centre in its pocket: skin gathers on the near side, by less than 1 %.
fn off_centre() -> Scene {
    scene(&json!({ "implant": { "base_radius_mm": 60, "projection_mm": 45, "center_mm": [15, 0] },
                   "pocket_radius_mm": 80 }))
}

fn warns(outcome: &Outcome) -> bool {
    outcome.warnings.iter().any(|warning| warning.contains("wrinkle"))
}

#[test]
fn the_opening_plan_has_no_warning_and_over_a_flat_chest_its_skin_is_taut() {
    let mut opening = Scene::opening();
    opening.solver.nodes_per_side = 65;
    let solve = |scene: Scene| run(&CheckedScene::new(scene).unwrap(), Options::default(), None);
    // Over a chest that is curved across, the skin that is pulled across shortens along the body.
    let outcome = solve(opening.clone()).outcome;
    assert!(outcome.wrinkled.unwrap() < 0.1 && outcome.warnings.is_empty(), "{outcome:?}");
    let Simulation { outcome, solution } = solve(Scene { chest: None, ..opening });
    assert_eq!(outcome.wrinkled, Some(0.0));
    assert!(outcome.warnings.is_empty(), "{:?}", outcome.warnings);
    let fields = Fields::new(Arc::clone(&solution));
    assert!(fields.values(Field::WrinkleState).iter().all(|state| *state == 0.0));
    assert!(fields.skin_state(solution.problem().sheet().len() / 2).is_some());
}

#[test]
fn visible_folds_beyond_the_pocket_are_a_warning_small_ones_are_none() {
    let folded = simulate(&thick()).unwrap();
    println!("{:?} {:?}", folded.wrinkled, folded.warnings);
    assert!((0.35..0.65).contains(&folded.wrinkled.unwrap()), "{:?}", folded.wrinkled);
    let warning = folded.warnings.iter().find(|warning| warning.contains("wrinkle")).unwrap();
    assert!(
        warning.contains("beyond the pocket") && warning.contains("0 % of the skin"),
        "{warning}"
    );
    let small = simulate(&off_centre()).unwrap();
    println!("{:?} {:?}", small.wrinkled, small.warnings);
    assert!((0.01..0.15).contains(&small.wrinkled.unwrap()), "{:?}", small.wrinkled);
    assert!(!warns(&small), "{:?}", small.warnings);
}

/// Around a centred implant fat moves outwards and shortens the radii of the skin: the crests are circles.
#[test]
fn crests_around_a_centred_implant_under_thick_fat_are_circles() {
    let solution = run(&CheckedScene::new(thick()).unwrap(), Options::default(), None).solution;
    let fields = Fields::new(solution);
    let sheet = fields.solution().problem().sheet();
    let mut count = 0;
    for (rest, crest) in sheet.rest().iter().zip(fields.wrinkle_directions()) {
        // The border's triangles are less regular.
        if crest.length() > 0.0 && rest.length() < 110.0 {
            let off = crest.as_dvec2().dot(rest.normalize()).abs();
            assert!(off < 0.1, "{crest} at {rest}");
            count += 1;
        }
    }
    assert!(count > 50, "{count}");
}

#[test]
fn results_of_layered_tissue_have_cells_and_wrinkles_and_a_centred_one_the_grids_error() {
    let result = serde_json::to_value(simulate(&off_centre()).unwrap()).unwrap();
    assert_eq!(result["solver"]["cells_through"], 2);
    assert!(result["wrinkled"].is_number());
    // Off centre the error of the grid has no estimate.
    assert!(result["solver"].get("estimated_discretisation_error").is_none());
    let skin = Curve::scaled(&off_centre().layers[0].curve).unwrap();
    let share = result["strain"]["max_principal"].as_f64().unwrap() / skin.knee().unwrap();
    assert_eq!(result["skin_reserve_used"].as_f64(), Some(share));
    let centred = serde_json::to_value(simulate(&scene(&json!({}))).unwrap()).unwrap();
    let error = centred["solver"]["estimated_discretisation_error"].as_f64().unwrap();
    assert!((1e-3..2e-2).contains(&error), "{error}");
}

#[test]
fn skin_in_folds_converges_at_the_default_accuracy_in_the_first_attempt() {
    // A patient whose skin folds beyond the pocket: the last cycles reduce the change by 4 % each.
    let patient = scene(&json!({
        "implant": { "base_radius_mm": 70.18460596129267, "projection_mm": 57.32437334916116 },
        "pocket_radius_mm": 81.74636683141682,
        "layers": [
            { "tissue": "skin", "thickness_mm": 1.0637013465067493, "poisson_ratio": 0.45,
              "curve": { "kind": "skin", "strain_scale": 1.173311834841927, "stress_scale": 1.4947462925722719 } },
            { "tissue": "adipose", "thickness_mm": 18.29894659246414, "poisson_ratio": 0.49,
              "curve": { "kind": "fat", "stress_scale": 1.4798353981141046 } } ],
        "solver": { "nodes_per_side": 129, "tolerance": 1e-4 } }));
    let outcome = simulate(&patient).unwrap();
    assert_eq!((outcome.status, outcome.solver.fell_back), (Status::Converged, false));
    assert!((0.1..0.3).contains(&outcome.wrinkled.unwrap()), "{:?}", outcome.wrinkled);
    assert!(outcome.solver.work_units < 700.0, "{}", outcome.solver.work_units);
}

#[test]
fn each_solid_counts_with_one_cell_at_least() {
    let mut scene = off_centre();
    let muscle =
        implant_preview::scene::Layer { tissue: "muscle".to_owned(), ..scene.layers[1].clone() };
    scene.layers.push(muscle);
    scene.solver.cells_through = Some(implant_preview::scene::CellsThrough::Count(1));
    assert_eq!(simulate(&scene).unwrap().solver.cells_through, Some(2));
}

#[test]
fn a_sheet_of_coupled_springs_wrinkles_and_one_of_the_papers_does_not() {
    // A small, tall dome far off centre: most of a sheet is pulled one way only.
    let mut sheet = scene(&json!({
        "implant": { "base_radius_mm": 20, "projection_mm": 35, "center_mm": [12, 0] },
        "pocket_radius_mm": 33, "tissue_model": "sheet",
        "layers": [{ "tissue": "skin", "poisson_ratio": 0, "curve": { "kind": "skin" } }],
        "insertion": 0.65 }));
    let outcome = simulate(&sheet).unwrap();
    println!("{:?}", outcome.wrinkled);
    assert!(outcome.wrinkled.unwrap() > 0.05 && outcome.solver.cells_through.is_none());
    assert!(outcome.layers.iter().all(|layer| layer.max_stress_kpa.unwrap() >= 0.0));
    sheet.springs = Springs::Nikolaev;
    assert_eq!(simulate(&sheet).unwrap().wrinkled, None);
}

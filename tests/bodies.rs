//! Walls, tissue and implants as bodies have them: multigrid alone, in the work of a smooth scene times two.

#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview::measure::{Outcome, Status};
use implant_preview::scene::Scene;
use implant_preview::simulate::simulate;
use implant_preview_lab::robustness::Ending;
use implant_preview_lab::robustness::clinical::{Clinical, ClinicalSummary};
use serde_json::{Value, json};

/// The most work of a scene \[evaluations of the forces of the finest grid\]: the opening plan takes 52.
const MOST_WORK: f64 = 110.0;

fn solve(file: &Value) -> Outcome {
    simulate(&Scene::from_json(&file.to_string()).unwrap()).unwrap()
}

/// An anatomical implant 12 cm wide under fat of a thickness.
fn anatomical(fat_mm: f64, projection_mm: f64, height_mm: f64, lower_mm: f64) -> Value {
    json!({
        "implant": { "base_radius_mm": 60, "projection_mm": projection_mm,
                     "base_height_mm": height_mm, "apex_shift_mm": lower_mm },
        "pocket_radius_mm": 70,
        "patch_radius_mm": 130,
        "chest": { "radius_across_mm": 140, "radius_along_mm": null },
        "layers": [
            { "tissue": "skin", "thickness_mm": 1.5, "poisson_ratio": 0.45,
              "curve": { "kind": "skin", "strain_scale": 0.5 } },
            { "tissue": "adipose", "thickness_mm": fat_mm, "poisson_ratio": 0.49,
              "curve": { "kind": "fat" } },
        ],
        "solver": { "nodes_per_side": 65, "tolerance": 1e-3 },
    })
}

fn check_work(outcome: &Outcome, of: &Value) {
    let solver = &outcome.solver;
    assert_eq!(outcome.status, Status::Converged, "{of}");
    assert!(!solver.fell_back && solver.work_units <= MOST_WORK, "{} {of}", solver.work_units);
}

/// Each left multigrid, or took twice the work, with blocks of skin that resists compression and a coarsest grid of 17 nodes per side.
#[test]
fn implants_with_a_lower_apex_need_multigrid_alone() {
    for (fat, projection, height, lower) in [
        (8.5, 55.0, 120.0, 20.0),
        (20.0, 45.0, 108.0, 20.0),
        (20.0, 55.0, 120.0, 10.0),
        (35.0, 30.0, 108.0, 20.0),
        (35.0, 45.0, 120.0, 20.0),
        (35.0, 55.0, 108.0, 10.0),
    ] {
        let file = anatomical(fat, projection, height, lower);
        check_work(&solve(&file), &file);
    }
}

/// Two thirds of the skin are in folds.
#[test]
fn skin_in_folds_over_a_hollow_converges_on_every_grid() {
    for nodes in [33, 65, 129] {
        let mut file = anatomical(17.5, 40.0, 120.0, 0.0);
        file["chest"] = json!({ "radius_across_mm": -200, "radius_along_mm": -200 });
        file["solver"]["nodes_per_side"] = nodes.into();
        let outcome = solve(&file);
        check_work(&outcome, &file);
        assert!(outcome.wrinkled.unwrap() > 0.5);
    }
}

/// Errors of second order: those of 33 and 65 nodes per side against the limit of 65 and 129.
#[test]
fn the_shape_over_a_lower_apex_converges_at_second_order() {
    let at = |nodes: usize| {
        let mut file = anatomical(20.0, 45.0, 108.0, 20.0);
        file["solver"] = json!({ "nodes_per_side": nodes, "tolerance": 1e-4, "cells_through": 3 });
        let outcome = solve(&file);
        assert_eq!(outcome.status, Status::Converged);
        [outcome.contact_force_n.unwrap(), outcome.skin_projection_mm.unwrap()]
    };
    let [coarse, middle, fine] = [33, 65, 129].map(at);
    for (quantity, most) in [(0, 5e-3), (1, 2e-3)] {
        let limit = fine[quantity] + (fine[quantity] - middle[quantity]) / 3.0;
        let [first, second] = [coarse, middle].map(|of| (of[quantity] / limit - 1.0).abs());
        assert!(second <= most, "{quantity}: {second:.1e}");
        assert!(second <= 0.5 * first + 2e-4, "{quantity}: {first:.1e} {second:.1e}");
    }
}

/// The inner face slopes by 27° towards the implant in the void beside its steep end: every path of multigrid once refused this shape as
/// inverted, although the least volume ratio of a cell is 0.89, and the scene had no answer.
#[test]
fn tight_skin_that_lifts_the_inner_face_beside_a_steep_implant_has_a_shape() {
    let clinical = Clinical { has_terrain: true, nodes_per_side: 97, ..Clinical::default() };
    let case = clinical.run(11, 1936, None);
    assert_eq!(case.case.ending, Ending::Converged);
    assert!(!case.by_newton && case.attempts == 3 && case.case.findings.is_empty());
    assert!(case.case.least_volume_ratio.unwrap() > 0.8);
}

/// Skin of a strain scale of 0.24 over 0.78 R: the second grid has shapes under the rising dome, all of which the third one loses in its first
/// cycles but one at 0.7 of the height. The scene had no answer.
#[test]
fn a_rise_goes_on_from_the_dome_that_a_finer_grid_does_not_lose() {
    let clinical = Clinical { has_terrain: true, nodes_per_side: 65, ..Clinical::default() };
    let case = clinical.run(11, 1504, None);
    assert_eq!(case.case.ending, Ending::Converged);
    assert!(!case.by_newton && case.attempts > 3 && case.case.findings.is_empty());
    assert!(case.case.work_units <= 1000.0, "{}", case.case.work_units);
}

#[test]
fn random_bodies_converge_by_multigrid() {
    let clinical = Clinical { has_terrain: true, nodes_per_side: 33, ..Clinical::default() };
    let cases: Vec<_> = (0..24).map(|case| clinical.run(7, case, None)).collect();
    let summary = ClinicalSummary::new(7, clinical, &cases);
    assert!(summary.all_converged() && summary.by_multigrid == 24, "{:?}", summary.worst);
    assert!(summary.work_units[0] <= MOST_WORK, "{:?}", summary.work_units);
    assert!(cases.iter().all(|case| case.case.findings.is_empty()));
}

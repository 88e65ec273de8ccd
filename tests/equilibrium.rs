//! The dome's equilibrium compared with an independent axisymmetric solution and closed forms, and its invariants.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview::measure::Fields;
use implant_preview::measure::{Outcome, Status};
use implant_preview::mesh::NodeKind;
use implant_preview::scene::Scene;
use implant_preview::simulate::{measure, simulate};
use implant_preview::solve::{Method, Options, Progress, Solver, Verdict};
use implant_preview::springs::coupled::CoupledLaw;
use implant_preview_lab::axisymmetric;
use serde_json::{Value, json};
use std::sync::Arc;

#[path = "common/membrane.rs"]
mod membrane;
use membrane::cases;

#[path = "equilibrium/papers_springs.rs"]
mod papers_springs;
#[path = "equilibrium/results.rs"]
mod results;

fn scene_of(case: &Value, nodes: usize) -> Scene {
    let mut scene = membrane::scene_of(case);
    (scene.solver.nodes_per_side, scene.solver.tolerance) = (nodes, 1e-6);
    scene
}

/// Greatest distance between the profiles, relative to the dome's radius.
fn profile_error(case: &Value, outcome: &Outcome) -> f64 {
    let column = |name: &str| -> Vec<f64> {
        let values = case["result"][name].as_array().unwrap();
        values.iter().map(|v| v.as_f64().unwrap()).collect()
    };
    let (s, r, z) = (column("s_mm"), column("r_mm"), column("z_mm"));
    assert_eq!(outcome.profile.len(), s.len());
    let radius = case["dome_radius_mm"].as_f64().unwrap();
    outcome
        .profile
        .iter()
        .enumerate()
        .map(|(k, point)| {
            assert!((point.s_mm - s[k]).abs() < 1e-9);
            (point.r_mm - r[k]).hypot(point.z_mm - z[k]) / radius
        })
        .fold(0.0, f64::max)
}

fn near(got: Option<f64>, reference: &Value, relative: f64, what: &str) {
    let (got, reference) = (got.unwrap(), reference.as_f64().unwrap());
    let error = (got / reference - 1.0).abs();
    assert!(error < relative, "{what}: {got} against {reference}, off by {error:.2e}");
}

#[test]
fn the_shape_converges_to_the_axisymmetric_reference_at_second_order() {
    for case in cases() {
        let errors = [33, 65, 129, 257]
            .map(|n| profile_error(&case, &simulate(&scene_of(&case, n)).unwrap()));
        let name = &case["name"];
        assert!(errors[1] < 2e-4 && errors[2] < 5e-5, "{name}: {errors:?}");
        let order = (errors[0] / errors[3]).log2() / 3.0;
        assert!(order > 1.8, "{name}: order {order:.2} from {errors:?}");
        assert!(errors.is_sorted_by(|a, b| a > b), "{name}: {errors:?}");
    }
}

#[test]
fn every_figure_agrees_with_the_reference() {
    for case in cases() {
        let outcome = simulate(&scene_of(&case, 129)).unwrap();
        let result = &case["result"];
        assert_eq!(outcome.status, Status::Converged);
        near(outcome.apex_stretch, &result["apex_stretch"], 1e-3, "apex stretch");
        near(outcome.contact_angle_deg, &result["contact_angle_deg"], 2e-3, "contact angle");
        near(
            outcome.contact_material_radius_mm,
            &result["contact_material_radius_mm"],
            3e-3,
            "contact material radius",
        );
        near(outcome.contact_force_n, &result["contact_force_n"], 1e-3, "contact force");
        near(outcome.area_ratio, &result["area_ratio"], 2e-4, "area ratio");
        // The pressure of a sphere under the nominal tension T, T/λ per deformed length, is 2T/(λR). At the
        // apex both principal stresses are equal and the pressure is greatest.
        let radius = case["dome_radius_mm"].as_f64().unwrap();
        let tension: f64 = outcome
            .layers
            .iter()
            .zip(case["layers"].as_array().unwrap())
            .map(|(layer, given)| {
                layer.max_stress_kpa.unwrap() * given["thickness_mm"].as_f64().unwrap()
            })
            .sum();
        if case["pocket_radius_mm"].as_f64().unwrap() > radius {
            let pressure = outcome.contact_pressure_kpa.unwrap().max;
            let stretch = outcome.apex_stretch.unwrap();
            let theory = 2.0 * tension / (stretch * radius);
            assert!((pressure / theory - 1.0).abs() < 2e-3, "{pressure} {theory}");
        }
    }
}

#[test]
fn the_figure_of_theory_for_a_linear_sheet() {
    // Theory of a linear sheet with ν = 1/3, a/R = 1.5 at full height: F/(E h R) = 1.056.
    let case = &cases()[0];
    let outcome = simulate(&scene_of(case, 129)).unwrap();
    let force = outcome.contact_force_n.unwrap() * 1000.0 / (10.0 * 1.5 * 40.0);
    assert!((force - 1.056).abs() < 1e-3, "{force}");
}

#[test]
fn areas_and_volumes_meet_closed_forms() {
    // A sheet clamped at the dome's rim covers the dome: a cap of the hemisphere.
    for insertion in [1.0_f64, 0.7] {
        let radius = 50.0;
        let wall = radius * (1.0 - (insertion - 1.0).powi(2)).sqrt();
        let scene = json!({
            "tissue_model": "sheet",
            "implant": { "base_radius_mm": radius }, "pocket_radius_mm": radius,
            "insertion": insertion, "solver": { "nodes_per_side": 129 },
        });
        let outcome = simulate(&Scene::from_json(&scene.to_string()).unwrap()).unwrap();
        let volume = outcome.implant_volume_ml;
        assert!((volume - 2.0 / 3.0 * std::f64::consts::PI * 125.0).abs() < 1e-9, "{volume}");
        let before = outcome.area_before_cm2;
        assert!((before - std::f64::consts::PI * 25.0).abs() < 1e-9);
        let cap = 2.0 * std::f64::consts::PI * radius * insertion * radius / 100.0;
        let ring = std::f64::consts::PI * (radius * radius - wall * wall) / 100.0;
        let after = outcome.area_after_cm2.unwrap();
        // At full height the sheet is the cap; below, the sheet bridges the corner between dome and wall
        // with an area less than cap and ring together.
        if insertion > 0.99 {
            assert!((after / cap - 1.0).abs() < 2e-4, "{after} {cap}");
        } else {
            assert!(after < cap + ring && after > 0.95 * (cap + ring), "{after} {cap} {ring}");
        }
        assert!((outcome.area_gain_cm2.unwrap() - (after - before)).abs() < 1e-9);
    }
}

/// Scenes unlike the references.
fn odd_scenes() -> Vec<Scene> {
    [
        json!({ "tissue_model": "sheet",
                "implant": { "base_radius_mm": 50, "center_mm": [12.0, -7.0] }, "pocket_radius_mm": 75 }),
        json!({ "tissue_model": "sheet", "implant": { "base_radius_mm": 60, "projection_mm": 25 } }),
        json!({ "tissue_model": "sheet",
                "implant": { "base_radius_mm": 45, "projection_mm": 60, "center_mm": [5, 5] },
                "insertion": 0.6 }),
        json!({ "tissue_model": "sheet", "implant": { "base_radius_mm": 40 }, "pocket_radius_mm": 120,
                "layers": [ { "poisson_ratio": 0.0 }, { "poisson_ratio": 0.5, "thickness_mm": 20,
                "curve": { "kind": "exponential", "scale_kpa": 1, "rate": 4 } } ] }),
    ]
    .iter()
    .map(|scene| Scene::from_json(&scene.to_string()).unwrap())
    .collect()
}

fn solved(scene: &Scene, nodes: usize, tolerance: f64) -> Solver {
    let mut scene = scene.clone();
    scene.solver.nodes_per_side = nodes;
    scene.solver.tolerance = tolerance;
    let mut solver = Solver::new(scene.problem().unwrap());
    assert_eq!(solver.advance(&mut || false), Progress::Done);
    solver
}

/// Greatest distance between the nodes of two solutions, relative to the base radius.
fn apart(a: &Solver, b: &Solver) -> f64 {
    let distances = a.positions().iter().zip(b.positions()).map(|(a, b)| a.distance(*b));
    distances.fold(0.0, f64::max) / a.problem().obstacle.dome.reference_length()
}

#[test]
fn contact_forces_are_the_reaction_of_the_border() {
    for scene in odd_scenes() {
        let solver = solved(&scene, 65, 1e-6);
        let forces = solver.forces_and_scale().0;
        let kinds = solver.problem().sheet().kinds();
        // The vertical reaction of the border equals the vertical force of dome and wall.
        let pull: f64 = (0..forces.len())
            .filter(|&k| kinds[k] == NodeKind::Clamped)
            .map(|k| forces[k].z)
            .sum::<f64>()
            / 1000.0;
        let outcome = measure(&scene, &Fields::new(Arc::new(solver.solution())));
        let force = outcome.contact_force_n.unwrap();
        assert!(force > 0.0);
        assert!((force / pull - 1.0).abs() < 1e-3, "{force} {pull}");
    }
}

#[test]
fn no_node_is_inside_the_dome_or_below_the_wall_and_no_contact_force_is_tensile() {
    for scene in odd_scenes() {
        let solver = solved(&scene, 65, 1e-6);
        let (problem, forces) = (solver.problem(), solver.forces_and_scale().0);
        let scale = forces.iter().map(|f| f.length()).fold(0.0, f64::max);
        for (k, &x) in solver.positions().iter().enumerate() {
            if problem.sheet().kinds()[k] != NodeKind::Free {
                continue;
            }
            let distance = problem.obstacle.dome.closest_point(x).0;
            assert!(distance > -1e-9 && x.z >= 0.0, "{x} {distance}");
            // A free node is in balance; a contact force is compressive. Nodes with a contact offset may be
            // slightly off the dome.
            let is_last = solver.offset_nodes().iter().any(|(last, _)| *last == k);
            assert!(!is_last || distance < 2e-3 * problem.obstacle.dome.reference_length());
            if distance > 1e-3 && x.z > 1e-3 && !is_last {
                assert!(forces[k].length() < 1e-4 * scale, "{x}: {}", forces[k]);
            } else {
                let along = forces[k].dot(problem.obstacle.dome.normal(x));
                assert!(along < 1e-4 * scale, "{x}: {along}");
            }
        }
    }
}

#[test]
fn the_estimated_error_bounds_the_error_against_the_grids_own_equilibrium() {
    let mut scenes = odd_scenes();
    scenes.extend(cases().iter().map(|case| scene_of(case, 65)));
    for scene in scenes {
        let exact = solved(&scene, 65, 1e-7);
        for tolerance in [1e-2, 1e-4] {
            let solver = solved(&scene, 65, tolerance);
            assert_eq!(solver.verdict(), Verdict::Converged);
            let error = apart(&exact, &solver);
            assert!(error <= tolerance, "{error:.1e} against {tolerance:.0e}");
            assert!(
                error <= 2.0 * solver.estimated_position_error() + 1e-7,
                "{error:.1e} against the estimate {:.1e}",
                solver.estimated_position_error()
            );
        }
    }
}

/// Small changes before wrinkling had been accepted as convergence.
#[test]
fn sheets_in_folds_off_centre_are_solved_within_their_error() {
    let skin = |thickness, poisson_ratio, curve| json!([{ "tissue": "skin", "thickness_mm": thickness, "poisson_ratio": poisson_ratio, "curve": curve }]);
    let dome = |radius, projection, center: [f64; 2]| json!({ "base_radius_mm": radius, "projection_mm": projection, "center_mm": center });
    let points = json!({ "kind": "points", "points": [[0, 0], [0.2, 12], [0.5, 60], [0.8, 240]],
        "interpolation": "line" });
    let rubbery = json!({ "kind": "exponential", "scale_kpa": 21.6, "rate": 0.4697 });
    for (implant, pocket, insertion, layers, nodes) in [
        (dome(30.6, 9.85, [12.2, 53.5]), 103.1, 1.0, skin(8.3, 0.0, points), 41),
        (
            dome(76.1, 15.0, [-54.7, 111.1]),
            200.0,
            0.457,
            skin(0.72, 0.0334, json!({ "kind": "skin" })),
            41,
        ),
        (dome(24.36, 3.067, [11.906, 0.0]), 36.27, 0.6674, skin(1.0, 0.0, rubbery), 97),
    ] {
        let scene = json!({ "tissue_model": "sheet", "implant": implant,
            "pocket_radius_mm": pocket, "insertion": insertion, "layers": layers });
        let scene = Scene::from_json(&scene.to_string()).unwrap();
        let (exact, solver) = (solved(&scene, nodes, 1e-7), solved(&scene, nodes, 1e-4));
        assert_eq!(exact.verdict(), Verdict::Converged);
        assert_eq!(solver.verdict(), Verdict::Converged);
        let error = apart(&exact, &solver);
        assert!(error <= solver.estimated_position_error(), "{error:.1e}");
    }
}

/// Contact offsets of a shape with one active node too many or too few had left an error of ten tolerances; a
/// free node close to the dome had counted as active.
#[test]
fn contact_offsets_are_computed_from_the_equilibrium() {
    let shell = |thickness, poisson_ratio, curve| {
        json!([{ "tissue": "skin", "thickness_mm": thickness,
        "poisson_ratio": poisson_ratio, "curve": curve }])
    };
    let soft = json!({ "kind": "exponential", "scale_kpa": 6.7, "rate": 1.7 });
    let straight = json!({ "kind": "linear", "modulus_kpa": 34 });
    let fat = json!({ "kind": "adipose" });
    for (implant, pocket, layers, nodes, tolerance) in [
        (
            json!({ "base_radius_mm": 71.8, "projection_mm": 27.8, "center_mm": [-5.1, 6.6] }),
            88.15494959114218,
            shell(1.87, 0.45, soft),
            129,
            1e-5,
        ),
        (
            json!({ "base_radius_mm": 67.8, "projection_mm": 73.1, "center_mm": [-26.4, -9.2] }),
            119.6963875100131,
            shell(2.55, 0.3, straight),
            129,
            1e-5,
        ),
        (
            json!({ "base_radius_mm": 70.23, "projection_mm": 63.82, "center_mm": [-0.56, -1.97] }),
            77.97,
            shell(18.12, 0.403, fat),
            65,
            1e-4,
        ),
    ] {
        let scene = json!({ "tissue_model": "sheet", "implant": implant,
            "pocket_radius_mm": pocket, "layers": layers });
        let scene = Scene::from_json(&scene.to_string()).unwrap();
        let (exact, solver) = (solved(&scene, nodes, 1e-7), solved(&scene, nodes, tolerance));
        let error = apart(&exact, &solver);
        assert!(error <= 2.0 * solver.estimated_position_error(), "{error:.1e}");
    }
}

/// Rounding of positions had appeared as an increase of the energy and rejected all steps.
#[test]
fn a_small_insertion_is_solved_to_the_least_tolerance() {
    let scene = json!({ "tissue_model": "sheet",
        "implant": { "base_radius_mm": 22, "projection_mm": 2, "center_mm": [6.4, 11.3] },
        "pocket_radius_mm": 54, "insertion": 0.0165,
        "layers": [{ "tissue": "skin", "thickness_mm": 8.7, "poisson_ratio": 0.15,
            "curve": { "kind": "linear", "modulus_kpa": 49 } }] });
    let scene = Scene::from_json(&scene.to_string()).unwrap();
    assert_eq!(solved(&scene, 97, 1e-7).verdict(), Verdict::Converged);
}

/// An insertion below the tolerance is solved if the dome would penetrate the sheet at rest.
#[test]
fn a_flat_dome_at_small_insertion_has_a_shape_at_every_tolerance() {
    let scene = json!({ "tissue_model": "sheet",
        "implant": { "base_radius_mm": 50, "projection_mm": 2 }, "insertion": 0.1 });
    let scene = Scene::from_json(&scene.to_string()).unwrap();
    for tolerance in [1e-2, 1e-3, 1e-4] {
        assert_eq!(solved(&scene, 33, tolerance).verdict(), Verdict::Converged, "{tolerance}");
    }
}

#[test]
fn a_mirrored_scene_has_the_mirrored_shape() {
    let mut scene = odd_scenes().remove(0);
    let right = solved(&scene, 33, 1e-7);
    scene.implant.center_mm[0] *= -1.0;
    let left = solved(&scene, 33, 1e-7);
    for (k, x) in right.positions().iter().enumerate() {
        let mirrored = left.positions()[k / 33 * 33 + (32 - k % 33)];
        let error = (x.x + mirrored.x).hypot(x.y - mirrored.y).hypot(x.z - mirrored.z);
        assert!(error < 1e-5 * scene.implant.base_radius_mm, "{error}");
    }
}

#[test]
fn the_same_scene_gives_the_same_bits() {
    let scene = odd_scenes().remove(2);
    let (a, b) = (solved(&scene, 65, 1e-4), solved(&scene, 65, 1e-4));
    assert_eq!(a.positions(), b.positions());
}

#[test]
fn a_restart_in_the_middle_of_a_cycle_leaves_no_trace() {
    let mut scene = Scene::sheet();
    scene.solver.nodes_per_side = 65;
    let problem = scene.problem().unwrap();
    scene.insertion = 0.7;
    let other = scene.problem().unwrap();
    let mut fresh = Solver::new(problem.clone());
    while fresh.advance(&mut || false) == Progress::Working {}
    for pieces in 1..60 {
        let mut solver = Solver::new(other.clone());
        let mut left = pieces;
        solver.advance(&mut || {
            left -= 1;
            left == 0
        });
        solver.restart(problem.clone());
        while solver.advance(&mut || false) == Progress::Working {}
        assert_eq!(solver.positions(), fresh.positions(), "after {pieces} pieces");
    }
}

#[test]
fn an_edited_scene_reaches_the_shape_of_a_fresh_one() {
    for scene in odd_scenes() {
        let target = solved(&scene, 65, 1e-6);
        let mut start = scene.clone();
        start.insertion = 0.8 * scene.insertion;
        start.implant.center_mm[0] -= 2.0;
        let mut solver = solved(&start, 65, 1e-6);
        let mut goal = scene.clone();
        (goal.solver.nodes_per_side, goal.solver.tolerance) = (65, 1e-6);
        solver.restart(goal.problem().unwrap());
        while solver.advance(&mut || true) == Progress::Working {}
        assert_eq!(solver.verdict(), Verdict::Converged);
        let error = solver
            .positions()
            .iter()
            .zip(target.positions())
            .map(|(a, b)| a.distance(*b))
            .fold(0.0, f64::max);
        assert!(error < 1e-5 * scene.implant.base_radius_mm, "{error}");
    }
}

/// A dome with an oscillation of the sheet at the contact edge from cycle to cycle, which mixing damps.
#[test]
fn an_oscillating_contact_edge_needs_few_cycles() {
    let scene = json!({
        "tissue_model": "sheet",
        "implant": { "base_radius_mm": 45, "projection_mm": 30, "center_mm": [8, 5] },
        "pocket_radius_mm": 65, "insertion": 0.8,
    });
    let scene = Scene::from_json(&scene.to_string()).unwrap();
    for nodes in [129, 257] {
        let solver = solved(&scene, nodes, 1e-4);
        assert_eq!(solver.verdict(), Verdict::Converged);
        assert!(!solver.fell_back() && solver.cycles() <= 7, "{}", solver.cycles());
    }
}

/// Steep domes on coarse grids, where steps beyond the stability limit had diverged.
#[test]
fn domes_off_centre_need_few_cycles() {
    for base_radius_mm in [45.0, 50.0, 51.0, 53.0, 55.0] {
        for distance in [0.01, 2.0, 6.0] {
            let mut scene = Scene::sheet();
            scene.implant.base_radius_mm = base_radius_mm;
            scene.implant.projection_mm = base_radius_mm;
            scene.implant.center_mm = [distance, -0.67 * distance];
            let solver = solved(&scene, 65, 1e-4);
            assert_eq!(solver.verdict(), Verdict::Converged);
            assert!(!solver.fell_back() && solver.cycles() <= 8, "{base_radius_mm} {distance}");
        }
    }
}

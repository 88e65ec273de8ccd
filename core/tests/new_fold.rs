//! A new fold below the old one: the pocket's lower edge moves down, its width stays.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use glam::DVec3;
use implant_preview_core::measure::{Direction, meridians};
use implant_preview_core::scene::{CheckedScene, Scene};
use implant_preview_core::simulate::{Simulation, run};
use implant_preview_core::solve::{Method, Options};
use serde_json::{Value, json};

const LOWER_MM: f64 = 14.0;

fn scene(members: &Value) -> Scene {
    let mut file = json!({
        "implant": { "base_radius_mm": 60, "projection_mm": 30 }, "pocket_radius_mm": 70, "patch_radius_mm": 144,
        "solver": { "nodes_per_side": 49, "tolerance": 1e-4 },
    });
    let members = members.as_object().unwrap().clone();
    file.as_object_mut().unwrap().extend(members);
    Scene::from_json(&file.to_string()).unwrap()
}

fn solved(scene: &Scene, options: Options) -> Simulation {
    let found = run(&CheckedScene::new(scene.clone()).unwrap(), options, None);
    assert!(found.outcome.solver.estimated_position_error.is_some());
    found
}

fn simulated(members: &Value) -> Simulation {
    solved(&scene(members), Options::default())
}

fn force(of: &Simulation) -> f64 {
    of.outcome.contact_force_n.unwrap()
}

/// Greatest distance of the inner faces \[base radius\].
fn distance(a: &Simulation, b: &Simulation) -> f64 {
    let pairs = a.solution.inner().iter().zip(b.solution.inner());
    pairs.map(|(a, b): (&DVec3, &DVec3)| a.distance(*b)).fold(0.0, f64::max) / 60.0
}

#[test]
fn no_new_fold_is_the_scene_without_one() {
    let (without, zero) = (scene(&json!({})), scene(&json!({ "pocket_lowered_mm": 0 })));
    assert_eq!(without, zero);
    assert!(!zero.to_json().contains("lowered"));
    let lowered = scene(&json!({ "pocket_lowered_mm": LOWER_MM }));
    assert_eq!(Scene::from_json(&lowered.to_json()).unwrap(), lowered);
}

#[test]
fn the_tissue_comes_off_the_wall_down_to_the_new_fold_and_nowhere_else() {
    let [round, lowered] = [0.0, LOWER_MM].map(|mm| simulated(&json!({ "pocket_lowered_mm": mm })));
    let lifted = |of: &Simulation, to: [f64; 2]| {
        let sheet = of.solution.problem().sheet();
        let near = |k: &usize| sheet.rest()[*k].distance_squared(to.into());
        let nodes = 0..sheet.len();
        of.solution.inner()[nodes.min_by(|a, b| near(a).total_cmp(&near(b))).unwrap()].z
    };
    let gain = |to| lifted(&lowered, to) - lifted(&round, to);
    assert!(gain([0.0, -72.0]) > 1.0, "{}", gain([0.0, -72.0]));
    for to in [[0.0, 72.0], [72.0, 0.0], [-72.0, 0.0]] {
        assert!(gain(to).abs() < 0.2, "{to:?}: {}", gain(to));
    }
    // Towards the feet the profile of the inner face ends at the new fold.
    let feet = meridians(&lowered.solution).into_iter().find(|it| it.direction == Direction::Feet);
    assert!((feet.unwrap().points[40].s_mm - 84.0).abs() < 1e-9);
    let [before, after] = [&round, &lowered].map(|it| it.outcome.void_ml.unwrap());
    assert!(after > before + 5.0, "{before} {after}");
}

#[test]
fn the_force_lies_between_those_of_the_round_pockets_within_and_around() {
    let within = force(&simulated(&json!({})));
    let lowered = force(&simulated(&json!({ "pocket_lowered_mm": LOWER_MM })));
    let around = force(&simulated(&json!({ "pocket_radius_mm": 70.0 + LOWER_MM })));
    assert!(around < lowered && lowered < within, "{around} {lowered} {within}");
    // Less than half of the edge moves.
    assert!(within - lowered < 0.5 * (within - around), "{around} {lowered} {within}");
}

#[test]
fn half_of_the_patch_the_whole_and_newtons_method_have_one_shape() {
    for members in [
        json!({ "pocket_lowered_mm": LOWER_MM }),
        json!({ "pocket_lowered_mm": LOWER_MM, "chest": { "radius_across_mm": 140 }, "pocket_plane": "dual_1" }),
    ] {
        let mut scene = scene(&members);
        scene.solver.nodes_per_side = 33;
        let half = solved(&scene, Options::default());
        assert!(!half.outcome.solver.fell_back);
        let whole = solved(&scene, Options { use_symmetry: false, ..Options::default() });
        scene.solver.tolerance = 1e-6;
        let newton = Options { method: Method::Newton, use_symmetry: false, ..Options::default() };
        let newton = solved(&scene, newton);
        for other in [&whole, &newton] {
            assert!(distance(&half, other) < 2e-4, "{}", distance(&half, other));
            assert!((force(&half) / force(other) - 1.0).abs() < 2e-3);
        }
        // One axis of symmetry is left.
        let nodes = [&half, &whole].map(|of| of.outcome.solver.nodes_solved as f64);
        assert!((1.8..2.1).contains(&(nodes[1] / nodes[0])), "{nodes:?}");
    }
}

#[test]
fn a_limit_of_the_void_counts_down_to_the_new_fold() {
    let limited = simulated(&json!({ "pocket_lowered_mm": LOWER_MM, "pocket_void_ml": 15 }));
    let found = limited.outcome.void_ml.unwrap();
    assert!((found / 15.0 - 1.0).abs() < 0.01 && limited.outcome.suction_kpa.unwrap() > 0.0);
}

#[test]
fn a_new_fold_is_refused_beyond_its_limits_and_in_a_sheet() {
    let refused = |members: &str| {
        let file = format!(
            r#"{{ "implant": {{ "base_radius_mm": 60 }}, "pocket_radius_mm": 70, {members} }}"#
        );
        Scene::from_json(&file).unwrap_err().to_string()
    };
    assert_eq!(
        refused(r#""pocket_lowered_mm": 41, "patch_radius_mm": 144"#),
        "pocket_lowered_mm is 41; allowed: 0 to 40 mm"
    );
    assert_eq!(
        refused(r#""pocket_lowered_mm": -1"#),
        "pocket_lowered_mm is -1; allowed: 0 to 40 mm"
    );
    assert_eq!(
        refused(r#""pocket_lowered_mm": 5, "tissue_model": "sheet""#),
        "pocket_lowered_mm is given; allowed: in layered tissue only"
    );
    assert_eq!(
        refused(r#""pocket_lowered_mm": 14, "patch_radius_mm": 100"#),
        "patch_radius_mm is 100; allowed: 104 to 260 mm"
    );
    let mut scene = scene(&json!({ "pocket_lowered_mm": 40, "patch_radius_mm": 130 }));
    scene.pocket_radius_mm = 80.0;
    assert_eq!((scene.repair(), scene.body.patch_radius_mm.to_bits()), (None, 140.0_f64.to_bits()));
}

#[test]
fn each_side_has_a_fold_of_its_own() {
    for [own, other] in [[LOWER_MM, 0.0], [0.0, LOWER_MM], [LOWER_MM, 7.0]] {
        let mut scene = scene(&json!({ "pocket_lowered_mm": own }));
        scene.add_other_side().unwrap();
        scene.other_side.as_mut().unwrap().body.pocket_lowered_mm = other;
        scene.align_other_side();
        let read = Scene::from_json(&scene.to_json()).unwrap();
        assert_eq!(read, scene);
        let lowered = read.other_side.unwrap().body.pocket_lowered_mm;
        assert!((lowered - other).abs() < 1e-12);
    }
}

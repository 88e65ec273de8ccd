//! Growth of the skin: the axisymmetric reference, tension without the implant's part, both methods, limits.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use glam::DVec3;
use implant_preview_core::measure::{Field, Fields, Outcome, ProfilePoint, SolverMethod, Status};
use implant_preview_core::mesh::NodeKind;
use implant_preview_core::scene::{CheckedScene, ChestShape, Scene};
use implant_preview_core::simulate::{self, simulate};
use implant_preview_core::solve::{Method, Options, Solution, Solver};
use implant_preview_lab::axisymmetric_layers::{self, Input};
use serde_json::{Value, json};
use std::sync::Arc;

/// The opening plan with a rigid implant on a grid over a wall, under a natural tension \[N/m\], with growth.
fn scene(nodes: usize, chest_mm: Option<f64>, tension: f64, grown: f64) -> Scene {
    let mut file: Value = serde_json::from_str(&Scene::opening().to_json()).unwrap();
    file["solver"] = json!({ "nodes_per_side": nodes, "tolerance": 1e-4 });
    file["skin_state"] = json!({ "natural_tension_n_per_m": tension, "grown": grown });
    let mut scene = Scene::from_json(&file.to_string()).unwrap();
    scene.implant.fill = None;
    let chest = |radius| ChestShape { radius_across_mm: radius, radius_along_mm: Some(radius) };
    scene.set_chest(chest_mm.map(chest));
    scene
}

fn force(outcome: &Outcome) -> f64 {
    outcome.contact_force_n.unwrap()
}

/// The solution by elements, of a mesh.
fn by_elements(scene: &Scene, cells: [usize; 2]) -> axisymmetric_layers::Solution {
    let problem = scene.problem().unwrap();
    axisymmetric_layers::solve(&Input::of(scene, &problem, cells).unwrap()).unwrap()
}

#[test]
fn growth_agrees_with_the_axisymmetric_elements() {
    for (chest_mm, tension, grown) in
        [(None, 0.0, 0.5), (None, 20.0, 0.8), (None, 20.0, 1.0), (Some(150.0), 20.0, 0.8)]
    {
        let scene = scene(129, chest_mm, tension, grown);
        let [coarse, fine] = [[72, 4], [144, 8]].map(|cells| by_elements(&scene, cells));
        let limit = |coarse: f64, fine: f64| fine + (fine - coarse) / 3.0;
        let outcome = simulate(&scene).unwrap();
        assert_eq!(outcome.status, Status::Converged);
        let expected = limit(coarse.contact_force_n, fine.contact_force_n);
        let off = force(&outcome) / expected - 1.0;
        let point = |point: &ProfilePoint| {
            let [a, b] = [&coarse, &fine].map(|mesh| mesh.point(point.s_mm).1);
            (point.r_mm - limit(a[0], b[0])).hypot(point.z_mm - limit(a[1], b[1]))
        };
        let skin = outcome.profile_skin.iter().map(point).fold(0.0, f64::max);
        let skin = skin / scene.implant.base_radius_mm;
        eprintln!(
            "{chest_mm:?} {tension} {grown}: {expected:.3} N, force {off:.1e}, skin {skin:.1e} R"
        );
        assert!(off.abs() < 0.01 && skin < 1.5e-3, "{chest_mm:?} {grown}: {off} {skin}");
    }
}

#[test]
fn skin_that_has_grown_wholly_has_its_natural_tension_everywhere() {
    for chest_mm in [None, Some(150.0)] {
        let scene = scene(65, chest_mm, 20.0, 1.0);
        let natural = 20.0 / scene.layers[0].thickness_mm;
        let found = simulate::run(&CheckedScene::new(scene).unwrap(), Options::default(), None);
        assert_eq!(found.outcome.status, Status::Converged);
        let fields = Fields::new(Arc::clone(&found.solution));
        let kinds = fields.solution().problem().sheet().kinds();
        for k in (0..kinds.len()).filter(|&k| kinds[k] == NodeKind::Free) {
            let stress = fields.at(Field::Stress(0), k).unwrap();
            assert!((stress / natural - 1.0).abs() < 0.01, "{stress} {natural}");
        }
    }
}

/// Force and pressure fall with the growth, the implant's stretch of the body rises; without a natural tension the fat's part alone is left.
#[test]
fn growth_takes_away_the_tension_of_the_skin() {
    let grown = [0.0, 0.3, 0.8, 1.0];
    for tension in [0.0, 20.0] {
        let results = grown.map(|grown| simulate(&scene(33, None, tension, grown)).unwrap());
        assert!(results.iter().all(|of| of.status == Status::Converged && !of.solver.fell_back));
        assert!(results.iter().all(|of| of.solver.method == SolverMethod::Multigrid));
        for pair in results.windows(2) {
            let mean = |of: &Outcome| of.contact_pressure_kpa.unwrap().mean;
            let area = |of: &Outcome| of.strain.as_ref().unwrap().added.unwrap().max_principal;
            assert!(force(&pair[1]) < 0.95 * force(&pair[0]) && mean(&pair[1]) < mean(&pair[0]));
            let has_added = pair.iter().all(|of| of.strain.as_ref().unwrap().added.is_some());
            assert!(!has_added || area(&pair[1]) > area(&pair[0]));
        }
        for of in &results[1..] {
            // What is added is the total less that at rest, which is the natural tension alone.
            let (skin, natural) = (&of.layers[0], tension / 1.5);
            let net = skin.max_stress_kpa.unwrap() - natural;
            assert!((skin.added_stress_kpa.unwrap() - net).abs() < 1e-6, "{net}");
            let (added, used) = (of.skin_reserve_added.unwrap(), of.skin_reserve_used.unwrap());
            assert!((added < used) == (tension > 0.0) && of.layers[1].added_stress_kpa.is_none());
        }
        if tension <= 0.0 {
            let mut soft = scene(33, None, 0.0, 0.0);
            soft.layers[0].curve.stress_scale = 0.05;
            soft.layers[0].thickness_mm = 0.2;
            let [soft, last] = [&simulate(&soft).unwrap(), &results[3]].map(force);
            assert!((0.9..1.1).contains(&(last / soft)), "{last} {soft}");
        } else {
            assert!(force(&results[3]) < 0.45 * force(&results[0]));
        }
    }
}

#[test]
fn a_coarser_tolerance_has_nearly_the_same_force() {
    for grown in [0.1, 0.25, 0.5] {
        let [coarse, fine] = [1e-3, 1e-4].map(|tolerance| {
            let mut scene = scene(65, None, 0.0, grown);
            (scene.implant.projection_mm, scene.solver.tolerance) = (40.0, tolerance);
            force(&simulate(&scene).unwrap())
        });
        assert!((coarse / fine - 1.0).abs() < 0.01, "{grown}: {coarse} {fine}");
    }
}

#[test]
fn both_methods_have_the_same_growth() {
    let mut scene = scene(33, None, 20.0, 0.8);
    let solved = |scene: &Scene, method: Method| {
        let options = Options { method, ..Options::default() };
        let mut solver = Solver::with_options(scene.problem().unwrap(), options);
        solver.advance(&mut || false);
        solver
    };
    scene.solver.tolerance = 1e-5;
    let multigrid = solved(&scene, Method::Automatic);
    scene.solver.tolerance = 1e-7;
    let newton = solved(&scene, Method::Newton);
    assert_eq!([&multigrid, &newton].map(|of| of.report().method == Method::Newton), [false, true]);
    let apart =
        |a: &[DVec3], b: &[DVec3]| a.iter().zip(b).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
    let skins = [&multigrid, &newton].map(|of| of.outer().last().unwrap());
    let error = apart(skins[0], skins[1]) / scene.implant.base_radius_mm;
    let [a, b] =
        [&multigrid, &newton].map(|of| of.solution().reactions().force.iter().sum::<f64>());
    eprintln!("{error:.1e} of the base radius, force {:.1e}", a / b - 1.0);
    assert!(error < 4e-4 && (a / b - 1.0).abs() < 1e-3, "{error} {a} {b}");
}

#[test]
fn without_an_implant_nothing_grows_and_a_record_keeps_what_has_grown() {
    let mut at_rest = scene(33, Some(150.0), 20.0, 1.0);
    at_rest.insertion = 0.0;
    let outcome = simulate(&at_rest).unwrap();
    assert!(force(&outcome).abs() < 1e-12 && (outcome.area_ratio.unwrap() - 1.0).abs() < 1e-9);

    let scene = CheckedScene::new(scene(33, None, 20.0, 0.6)).unwrap();
    let found = simulate::run(&scene, Options::default(), None);
    let json = serde_json::to_string(&found.solution.record()).unwrap();
    let record = serde_json::from_str(&json).unwrap();
    let restored = Arc::new(Solution::restore(scene.problem(), record).unwrap());
    let [one, other] = [&found.solution, &restored].map(|of| Fields::new(Arc::clone(of)));
    let middle = one.solution().problem().sheet().len() / 2;
    let stress = |of: &Fields| of.at(Field::Stress(0), middle).unwrap();
    assert_eq!(stress(&one).to_bits(), stress(&other).to_bits());
    let outside = Scene::from_json(&scene.scene().to_json().replace("0.6", "1.5")).unwrap_err();
    assert_eq!(outside.to_string(), "skin_state.grown is 1.5; allowed: 0 to 1");
}

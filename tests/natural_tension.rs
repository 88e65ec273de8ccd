//! Skin under tension at rest: balance, tension, both methods, the axisymmetric reference, and the contract of the scene.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use glam::DVec3;
use implant_preview::measure::{Field, Fields, Outcome, SolverMethod, Status};
use implant_preview::mesh::NodeKind;
use implant_preview::scene::{CheckedScene, ChestShape, Scene};
use implant_preview::simulate::{self, simulate};
use implant_preview::solve::{Method, Options, Solver};
use implant_preview::springs::coupled::biot_stress;
use implant_preview_lab::axisymmetric_layers::{self, Input};
use serde_json::{Value, json};
use std::sync::Arc;

/// The opening plan with a rigid implant on a grid, with members of the file replaced.
fn scene(nodes: usize, members: &Value) -> Scene {
    let mut file: Value = serde_json::from_str(&Scene::opening().to_json()).unwrap();
    file["solver"] = json!({ "nodes_per_side": nodes, "tolerance": 1e-4 });
    for (name, value) in members.as_object().unwrap() {
        file[name] = value.clone();
    }
    let mut scene = Scene::from_json(&file.to_string()).unwrap();
    scene.implant.fill = None;
    scene
}

fn skin_state(tension: f64, anisotropy: f64, direction_deg: f64) -> Value {
    json!({ "natural_tension_n_per_m": tension, "anisotropy": anisotropy, "direction_deg": direction_deg })
}

/// Factors or heights on a grid that carries the opening plan's patch.
fn grid(of: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    let at = |k: usize| (k as f64 - 34.0) * 4.0;
    (0..69 * 69).map(|k| of(at(k % 69), at(k / 69))).collect()
}

fn solved(scene: &Scene, options: Options) -> Solver {
    let mut solver = Solver::with_options(scene.problem().unwrap(), options);
    solver.advance(&mut || false);
    solver
}

fn layers(solver: &Solver) -> impl Iterator<Item = &DVec3> {
    solver.positions().iter().chain(solver.outer().iter().flatten())
}

/// Greatest distance of the nodes of two shapes \[base radius\].
fn apart(one: &Solver, other: &Solver) -> f64 {
    let radius = one.problem().obstacle.dome.reference_length();
    let distances = layers(one).zip(layers(other)).map(|(a, b)| a.distance(*b));
    distances.fold(0.0, f64::max) / radius
}

/// A flat wall, a curved one, a hollow, a mound off centre, a scanned wall, all but the first under an uneven tension.
fn bodies() -> [Value; 5] {
    let mound = |x: f64, y: f64| 1.0 + 1.5 * (-((x - 15.0).powi(2) + y * y) / 2500.0).exp();
    let bumps =
        |x: f64, y: f64| -(x * x + 0.5 * y * y) / 400.0 + 3.0 * (0.06 * x).sin() * (0.05 * y).cos();
    let form = |values: &str, of: &dyn Fn(f64, f64) -> f64| json!({ "spacing_mm": 4, "columns": 69, "rows": 69, values: grid(of) });
    let uneven = skin_state(30.0, 1.7, 35.0);
    let wall = |across: f64| json!({ "radius_across_mm": across, "radius_along_mm": 2.0 * across });
    [
        json!({ "chest": { "radius_across_mm": 1e6 }, "skin_state": skin_state(20.0, 1.0, 0.0) }),
        json!({ "chest": wall(140.0), "skin_state": uneven }),
        json!({ "chest": wall(-300.0), "skin_state": uneven }),
        json!({ "chest": wall(150.0), "skin_state": uneven, "thickness_field": form("factors", &mound) }),
        json!({ "chest": { "grid": form("heights_mm", &bumps) }, "skin_state": uneven }),
    ]
}

#[test]
fn without_an_implant_nothing_moves_by_either_method_whatever_the_body() {
    for (k, body) in bodies().into_iter().enumerate() {
        let mut scene = scene(33, &body);
        if k == 0 {
            scene.set_chest(None);
        }
        scene.insertion = 0.0;
        let rest = scene.problem().unwrap().rest;
        assert!(rest.natural().is_some() && rest.is_even() == (k == 0));
        let at_rest: Vec<DVec3> = (0..rest.layers()).flat_map(|l| rest.nodes(l)).collect();
        // Of forced cycles in f32 rounding remains: 1e-6 of the base radius.
        let cycles = Method::Multigrid { cycles: 3 };
        for (method, most) in [(Method::Automatic, 1e-9), (Method::Newton, 1e-9), (cycles, 6e-5)] {
            let solver = solved(&scene, Options { method, ..Options::default() });
            let moved = layers(&solver).zip(&at_rest).map(|(x, rest)| x.distance(*rest));
            let moved = moved.fold(0.0, f64::max);
            assert!(moved < most, "{k} {method:?}: {moved:e} mm");
            let force = solver.solution().reactions().force.iter().sum::<f64>();
            assert!(force.abs() < 1e-9, "{k} {method:?}: {force:e}");
        }
    }
}

#[test]
fn at_rest_the_skin_has_its_natural_tension_and_nothing_is_added() {
    for (anisotropy, direction) in [(1.0, 0.0), (1.5, 25.0), (2.0, 90.0)] {
        let mut scene =
            scene(33, &json!({ "skin_state": skin_state(24.0, anisotropy, direction) }));
        scene.insertion = 0.0;
        let (skin_mm, least) = (scene.layers[0].thickness_mm, 2.0 * 24.0 / (1.0 + anisotropy));
        let greatest = anisotropy * least / skin_mm;
        let checked = CheckedScene::new(scene.clone()).unwrap();
        let found = simulate::run(&checked, Options::default(), None);
        let outcome = found.outcome;
        let stress = outcome.layers[0].max_stress_kpa.unwrap();
        assert!((stress / greatest - 1.0).abs() < 1e-9, "{anisotropy}: {stress} {greatest}");
        let fields = Fields::new(Arc::clone(&found.solution));
        let kinds = fields.solution().problem().sheet().kinds();
        for k in (0..kinds.len()).filter(|&k| kinds[k] == NodeKind::Free) {
            let stress = fields.at(Field::Stress(0), k).unwrap();
            assert!((stress / greatest - 1.0).abs() < 1e-9);
            assert!((fields.at(Field::AreaStretch, k).unwrap() - 1.0).abs() < 1e-9);
            assert!((fields.at(Field::ThicknessStretch(0), k).unwrap() - 1.0).abs() < 1e-6);
        }
        let strain = outcome.strain.unwrap();
        let added = strain.added.unwrap();
        assert!(added.max_principal.abs() < 1e-9 && added.mean_area.abs() < 1e-9, "{added:?}");
        let (added, used) =
            (outcome.skin_reserve_added.unwrap(), outcome.skin_reserve_used.unwrap());
        assert!(added.abs() < 1e-9 && used > 0.05, "{added} {used}");
        assert!(
            outcome.layers[0].added_stress_kpa.unwrap().abs() < 1e-6
                && outcome.layers[1].added_stress_kpa.is_none()
        );
        assert!(strain.max_principal > 0.02 && strain.mean_area > 0.04, "{strain:?}");
        assert!((outcome.area_ratio.unwrap() - 1.0).abs() < 1e-9);
        assert_eq!(outcome.wrinkled, Some(0.0));
        assert!((outcome.contact_force_n.unwrap()).abs() < 1e-12);
    }
}

#[test]
fn the_opening_plan_converges_by_multigrid_to_the_shape_of_newtons_method() {
    for (nodes, state) in [
        (33, skin_state(20.0, 1.0, 0.0)),
        (33, skin_state(60.0, 1.5, 30.0)),
        (65, skin_state(20.0, 1.5, 90.0)),
    ] {
        let mut scene = scene(nodes, &json!({ "skin_state": state }));
        scene.solver.tolerance = 1e-5;
        let outcome = simulate(&scene).unwrap();
        assert_eq!(
            (outcome.status, outcome.solver.method),
            (Status::Converged, SolverMethod::Multigrid)
        );
        assert!(!outcome.solver.fell_back);
        if nodes > 33 {
            continue;
        }
        let multigrid = solved(&scene, Options::default());
        scene.solver.tolerance = 1e-7;
        let newton = solved(&scene, Options { method: Method::Newton, ..Options::default() });
        let force = |solver: &Solver| solver.solution().reactions().force.iter().sum::<f64>();
        let (error, force) = (apart(&multigrid, &newton), force(&multigrid) / force(&newton) - 1.0);
        println!("{nodes}: {error:.1e} of the base radius, force {force:.1e}");
        assert!(error < 1e-5 && force.abs() < 1e-4, "{error:e} {force:e}");
    }
}

/// Tension of the opening plan's skin under an even strain \[N/m\].
fn tension_at(scene: &Scene, strain: f64) -> f64 {
    let skin = &scene.problem().unwrap().materials[0];
    skin.thickness_mm * biot_stress(&skin.curve, skin.poisson_ratio, [strain; 2])[0]
}

/// Force and skin of a centred plan against the axisymmetric elements, whose rings are released by the same stretch.
#[test]
fn an_even_prestretch_agrees_with_the_axisymmetric_elements() {
    for chest_mm in [None, Some(150.0)] {
        let mut forces = Vec::new();
        for natural_strain in [0.0, 0.03, 0.08] {
            let mut scene = scene(129, &json!({}));
            let chest =
                |radius| ChestShape { radius_across_mm: radius, radius_along_mm: Some(radius) };
            scene.set_chest(chest_mm.map(chest));
            scene.body.skin_state.natural_tension_n_per_m = tension_at(&scene, natural_strain);
            let problem = scene.problem().unwrap();
            let on = |cells: [usize; 2]| {
                let mut input = Input::of(&scene, &problem, cells).unwrap();
                input.rest.natural_strain = natural_strain;
                axisymmetric_layers::solve(&input).unwrap()
            };
            let [coarse, fine] = [on([72, 4]), on([144, 8])];
            let limit = |coarse: f64, fine: f64| fine + (fine - coarse) / 3.0;
            let outcome = simulate(&scene).unwrap();
            assert_eq!(outcome.status, Status::Converged);
            let expected = limit(coarse.contact_force_n, fine.contact_force_n);
            let force = outcome.contact_force_n.unwrap() / expected - 1.0;
            let point = |point: &implant_preview::measure::ProfilePoint| {
                let [a, b] = [&coarse, &fine].map(|mesh| mesh.point(point.s_mm).1);
                (point.r_mm - limit(a[0], b[0])).hypot(point.z_mm - limit(a[1], b[1]))
            };
            let skin = outcome.profile_skin.iter().map(point).fold(0.0, f64::max);
            let skin = skin / scene.implant.base_radius_mm;
            println!(
                "{chest_mm:?} {natural_strain}: {expected:.3} N, force {force:.1e}, skin {skin:.1e} R"
            );
            assert!(force.abs() < 0.01 && skin < 1.5e-3, "{natural_strain}: {force} {skin}");
            forces.push(expected);
        }
        // Prestretch stiffens the skin.
        let ratios = [forces[1] / forces[0], forces[2] / forces[0]];
        println!("{chest_mm:?}: force × {ratios:.2?}");
        assert!(ratios[0] > 1.1 && ratios[1] > 1.3 * ratios[0], "{ratios:?}");
    }
}

/// The grid has no direction of its own.
#[test]
fn a_turned_tension_over_a_round_plan_has_the_same_force() {
    let outcome = |direction: f64| -> Outcome {
        let mut scene = scene(65, &json!({ "skin_state": skin_state(30.0, 1.8, direction) }));
        scene.set_chest(None);
        simulate(&scene).unwrap()
    };
    let (x, y, between) = (outcome(0.0), outcome(90.0), outcome(45.0));
    let force = |of: &Outcome| of.contact_force_n.unwrap();
    assert!((force(&y) / force(&x) - 1.0).abs() < 1e-4, "{} {}", force(&x), force(&y));
    assert!((force(&between) / force(&x) - 1.0).abs() < 3e-3, "{} {}", force(&x), force(&between));
    let width = |of: &Outcome, y: bool| {
        let profile = if y { &of.profile_skin_y } else { &of.profile_skin };
        profile[20].z_mm
    };
    // Along the greater tension the skin falls less steeply, in either direction.
    assert!((width(&x, false) - width(&y, true)).abs() < 1e-3);
    assert!((width(&x, false) - width(&x, true)).abs() > 1e-2);
}

#[test]
fn no_tension_is_todays_result_bit_for_bit() {
    let result = |scene: &Scene| {
        let mut outcome = simulate(scene).unwrap();
        outcome.solver.time_ms = None;
        serde_json::to_string(&outcome).unwrap()
    };
    let without = scene(33, &json!({}));
    let none = scene(33, &json!({ "skin_state": skin_state(0.0, 2.0, 40.0) }));
    assert_eq!(result(&none), result(&without));
    assert!(!without.to_json().contains("skin_state"));
    let read = Scene::from_json(&none.to_json()).unwrap();
    assert_eq!(read, none);
}

/// With linear skin the tension above the natural one is a factor of the modulus.
#[test]
fn relaxed_skin_keeps_its_natural_tension_and_carries_less_of_the_implant() {
    let relaxed = |tension: f64, relaxed: f64| {
        let mut state = skin_state(tension, 1.0, 0.0);
        state["relaxed"] = json!(relaxed);
        scene(33, &json!({ "skin_state": state }))
    };
    for tension in [0.0, 24.0] {
        let mut at_rest = relaxed(tension, 0.5);
        at_rest.insertion = 0.0;
        let stress = simulate(&at_rest).unwrap().layers[0].max_stress_kpa.unwrap();
        let natural = tension / at_rest.layers[0].thickness_mm;
        assert!((stress - natural).abs() < 1e-9, "{stress} {natural}");
        let results = [1.0, 0.5, 0.05].map(|g| simulate(&relaxed(tension, g)).unwrap());
        let [given, half, little] = results.each_ref().map(|of| of.contact_force_n.unwrap());
        println!("{tension} N/m: {given:.2}, {half:.2}, {little:.2} N");
        assert!(results.iter().all(|of| of.status == Status::Converged && !of.solver.fell_back));
        assert!(given > 1.1 * half && half > 1.05 * little, "{given} {half} {little}");
        let knee =
            results.map(|of| of.strain.unwrap().max_principal / of.skin_reserve_used.unwrap());
        assert!(knee.iter().all(|knee_of| (knee_of / knee[0] - 1.0).abs() < 1e-12), "{knee:?}");
    }
    // Without a natural tension all of the skin's stress relaxes.
    let mut soft = scene(33, &json!({}));
    soft.layers[0].curve.stress_scale = 0.5;
    let [soft, half] = [soft, relaxed(0.0, 0.5)].map(|scene| simulate(&scene).unwrap());
    let [soft, half] = [soft, half].map(|of| of.contact_force_n.unwrap());
    assert!((half / soft - 1.0).abs() < 1e-4, "{half} {soft}");
}

#[test]
fn a_state_of_the_skin_that_is_refused_is_refused_in_one_line() {
    let mut sheet: Value = serde_json::from_str(&Scene::sheet().to_json()).unwrap();
    sheet["skin_state"] = json!({ "natural_tension_n_per_m": 20 });
    let layered = |state: Value| {
        let mut file: Value = serde_json::from_str(&Scene::opening().to_json()).unwrap();
        file["skin_state"] = state;
        file
    };
    let mut lax = layered(json!({ "natural_tension_n_per_m": 200 }));
    lax["layers"][0]["curve"]["strain_scale"] = json!(2.0);
    for (file, expected) in [
        (sheet, "skin_state is given; allowed: in layered tissue only"),
        (
            layered(json!({ "natural_tension_n_per_m": -1 })),
            "skin_state.natural_tension_n_per_m is -1; allowed: 0 to 300 N/m",
        ),
        (
            layered(json!({ "natural_tension_n_per_m": 20, "anisotropy": 0.5 })),
            "skin_state.anisotropy is 0.5; allowed: 1 to 3",
        ),
        (
            layered(json!({ "natural_tension_n_per_m": 20, "direction_deg": 181 })),
            "skin_state.direction_deg is 181; allowed: -180 to 180 °",
        ),
        (lax, "skin_state.natural_tension_n_per_m is 200; allowed: 0 to "),
        (
            layered(json!({ "tension": 1 })),
            "skin_state.tension: unknown field `tension`; allowed: ",
        ),
        (layered(json!(20)), "skin_state: "),
    ] {
        let error = Scene::from_json(&file.to_string()).unwrap_err().to_string();
        assert!(error.starts_with(expected) && !error.contains('\n'), "{error}");
    }
}

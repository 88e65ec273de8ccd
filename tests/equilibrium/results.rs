//! Figures and warnings of a result.

use super::*;

#[test]
fn a_flat_sheet_stays_flat() {
    let scene =
        json!({ "tissue_model": "sheet", "implant": { "base_radius_mm": 50 }, "insertion": 0.0 });
    let outcome = simulate(&Scene::from_json(&scene.to_string()).unwrap()).unwrap();
    assert_eq!(outcome.status, Status::Converged);
    assert!((outcome.area_ratio.unwrap() - 1.0).abs() < 1e-12);
    assert!(outcome.contact_force_n.unwrap().abs() < 1e-12);
    assert!(outcome.contact_pressure_kpa.is_none() && outcome.contact_angle_deg.is_none());
}

fn outcome_of(scene: &Value) -> Outcome {
    simulate(&Scene::from_json(&scene.to_string()).unwrap()).unwrap()
}

#[test]
fn the_contact_angle_of_a_coarse_grid_lies_between_its_nodes() {
    let angle = |nodes: usize| {
        let scene = json!({ "tissue_model": "sheet",
                            "implant": { "base_radius_mm": 55 }, "pocket_radius_mm": 56,
            "layers": [{ "tissue": "skin", "thickness_mm": 2, "poisson_ratio": 0.3,
                "curve": { "kind": "linear", "modulus_kpa": 100 } }],
            "solver": { "nodes_per_side": nodes } });
        outcome_of(&scene).contact_angle_deg.unwrap()
    };
    // A cell is 3.6° wide at 33 nodes a side; the fit alone had given 90°.
    assert!((angle(33) - angle(257)).abs() < 1.8);
    assert!((angle(65) - angle(257)).abs() < 0.1);
}

#[test]
fn a_cap_between_nodes_is_a_penetration() {
    for (base_radius, projection, center, insertion, nodes) in
        [(10, 10, [12.5, 0.0], 1.0, 17), (10, 120, [1.5625, 0.0], 0.012, 129)]
    {
        let outcome = outcome_of(&json!({ "tissue_model": "sheet",
                                          "implant": { "base_radius_mm": base_radius,
            "projection_mm": projection, "center_mm": center }, "pocket_radius_mm": 200,
            "insertion": insertion, "solver": { "nodes_per_side": nodes } }));
        assert_eq!(outcome.status, Status::Unstable);
        assert!(outcome.warnings[0].contains("protrudes"), "{:?}", outcome.warnings);
    }
}

#[test]
fn a_result_reports_a_sheet_left_at_rest() {
    for (insertion, tolerance, is_reported) in
        [(0.0, 1e-2, false), (1e-3, 1e-2, true), (1e-3, 1e-5, false)]
    {
        let outcome = outcome_of(&json!({ "tissue_model": "sheet",
                                "implant": { "base_radius_mm": 50 }, "insertion": insertion,
            "solver": { "nodes_per_side": 33, "tolerance": tolerance } }));
        let found = outcome.warnings.iter().any(|warning| warning.contains("left undeformed"));
        assert_eq!(found, is_reported, "{insertion} {tolerance}: {:?}", outcome.warnings);
        assert_eq!(outcome.solver.work_units <= 0.0, insertion <= 0.0 || is_reported);
    }
}

#[test]
fn missing_estimates_are_null() {
    let scene =
        Scene::from_json(include_str!("../stress/needle-penetrating-soft-tissue.json")).unwrap();
    let outcome = simulate(&scene).unwrap();
    assert_eq!(outcome.status, Status::Unstable);
    let result = serde_json::to_value(&outcome).unwrap();
    assert_eq!(result["solver"]["estimated_position_error"], Value::Null);
    assert_eq!(serde_json::from_value::<Outcome>(result).unwrap(), outcome);
}

#[test]
fn a_result_warns_of_a_coarse_grid() {
    let beside = json!({ "base_radius_mm": 12.6, "center_mm": [-15.8, -21.9] });
    for (implant, pocket, insertion, part) in [
        (beside, 43, 0.05, Some("small contact area")),
        (json!({ "base_radius_mm": 55 }), 70, 1.0, None),
        (json!({ "base_radius_mm": 10, "projection_mm": 120 }), 200, 1.0, Some("tip")),
        (json!({ "base_radius_mm": 120, "projection_mm": 5 }), 120, 1.0, Some("rim")),
        (json!({ "base_radius_mm": 120, "projection_mm": 5 }), 200, 1.0, None),
        (json!({ "base_radius_mm": 55 }), 70, 1e-3, Some("inserted part of the implant")),
    ] {
        let outcome = outcome_of(&json!({ "tissue_model": "sheet",
                                          "implant": implant, "pocket_radius_mm": pocket,
            "insertion": insertion, "solver": { "nodes_per_side": 65, "tolerance": 1e-3 } }));
        let warning = outcome.warnings.iter().find(|warning| warning.contains("coarse"));
        match part {
            Some(part) => assert!(warning.unwrap().contains(part), "{warning:?}"),
            None => assert_eq!(warning, None),
        }
    }
}

#[test]
fn a_sheet_warns_of_compression_under_the_papers_springs_alone() {
    let warning = |springs: &str| {
        let scene = json!({
            "tissue_model": "sheet",
            "implant": { "base_radius_mm": 40, "center_mm": [25, 0] }, "pocket_radius_mm": 65,
            "springs": springs,
            "layers": [ { "poisson_ratio": 0.0, "curve": { "kind": "linear", "modulus_kpa": 50 } } ],
            "solver": { "nodes_per_side": 65 },
        });
        let outcome = simulate(&Scene::from_json(&scene.to_string()).unwrap()).unwrap();
        outcome.warnings.iter().any(|warning| warning.contains("under compression"))
    };
    assert!(!warning("coupled"));
    assert!(warning("nikolaev"));
}

/// Mean and greatest contact pressure \[kPa\] on a centred dome from the axisymmetric reference: κ₁T₁/λ₂ + κ₂T₂/λ₁ with the
/// curvatures of the half-ellipsoid.
fn exact_pressure(scene: &Scene) -> [f64; 2] {
    let problem = scene.problem().unwrap();
    let dome = &problem.obstacle.dome;
    let solution =
        axisymmetric::solve(dome, problem.patch.pocket_radius_mm, &problem.materials).unwrap();
    let law = CoupledLaw::new(&problem.materials);
    let (mut force, mut area, mut greatest) = (0.0, 0.0, 0.0_f64);
    let steps = 20_000;
    for k in 0..steps {
        let s = solution.contact_material_radius_mm * (f64::from(k) + 0.5) / f64::from(steps);
        let point = solution.point(s);
        let [one, two] = [point.stretch_meridional, point.stretch_hoop];
        let [t_one, t_two] = law.response([one - 1.0, two - 1.0]).tension;
        let sin = point.r_mm / dome.reference_length();
        let (across, along) = (dome.reference_length(), dome.projection());
        let speed = (across * across * (1.0 - sin * sin) + along * along * sin * sin).sqrt();
        let curvature = [across * along / speed.powi(3), along / (across * speed)];
        let pressure = curvature[0] * t_one / two + curvature[1] * t_two / one;
        let element = point.r_mm * one;
        force += pressure * element;
        area += element;
        greatest = greatest.max(pressure);
    }
    [force / area, greatest]
}

#[test]
fn mean_and_greatest_contact_pressure_are_those_of_the_reference() {
    let errors = |scene: &Scene| {
        let [mean, max] = exact_pressure(scene);
        let pressure = simulate(scene).unwrap().contact_pressure_kpa.unwrap();
        [pressure.mean / mean - 1.0, pressure.max / max - 1.0]
    };
    for case in cases() {
        if number_of(&case, "pocket_radius_mm") <= number_of(&case, "dome_radius_mm") {
            continue;
        }
        let [coarse, fine] = [65, 129].map(|nodes| errors(&scene_of(&case, nodes)));
        println!("{}: mean and greatest {coarse:.4?} at 65, {fine:.4?} at 129", case["name"]);
        assert!(coarse.iter().all(|error| error.abs() < 5e-3), "{coarse:?}");
        assert!(fine.iter().all(|error| error.abs() < 1e-3), "{fine:?}");
    }
    // A flat dome has its greatest pressure at the contact's edge.
    for (nodes, bounds) in [(65, [0.015, 0.1]), (129, [0.004, 0.02]), (257, [0.002, 0.01])] {
        let mut scene = Scene::sheet();
        scene.implant.projection_mm = 20.0;
        (scene.solver.nodes_per_side, scene.solver.tolerance) = (nodes, 1e-6);
        let [mean, max] = errors(&scene);
        println!("flat at {nodes}: mean {mean:.4}, greatest {max:.4}");
        assert!(mean.abs() < bounds[0] && max.abs() < bounds[1]);
    }
}

fn number_of(case: &Value, name: &str) -> f64 {
    case[name].as_f64().unwrap()
}

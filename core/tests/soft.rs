//! Implants that yield against axisymmetric elements of gel, shell and tissue in contact.
#![allow(clippy::unwrap_used)] // helpers of tests are tests

use implant_preview_core::measure::{Outcome, Status};
use implant_preview_core::scene::{Fill, Scene};
use implant_preview_core::simulate::simulate;
use serde_json::{Value, json};

fn number(of: &Value, name: &str) -> f64 {
    of[name].as_f64().unwrap()
}

/// The scene of a case.
fn scene(case: &Value, fill: &Value) -> Scene {
    let mut scene = json!({
        "tissue_model": "layered",
        "implant": {
            "base_radius_mm": case["base_radius_mm"], "projection_mm": case["projection_mm"], "fill": fill,
        },
        "pocket_radius_mm": case["pocket_radius_mm"], "patch_radius_mm": case["patch_radius_mm"],
        "attachment": {
            "stiffness_kpa_per_mm": case["attachment_kpa_per_mm"], "ramp_mm": case["attachment_ramp_mm"],
        },
        "layers": case["layers"],
        "solver": { "nodes_per_side": 65, "cells_through": 3 },
    });
    if let Some(radius) = case["wall"]["radius_mm"].as_f64() {
        scene["chest"] = json!({ "radius_across_mm": radius, "radius_along_mm": radius });
    }
    if let Some(height) = case["mound"]["height_mm"].as_f64() {
        let (width, fat) =
            (number(&case["mound"], "width_mm"), number(&case["layers"][1], "thickness_mm"));
        let factors: Vec<f64> = (0..67 * 67)
            .map(|k| {
                let [x, y] = [k % 67, k / 67].map(|i| 4.0 * (f64::from(i) - 33.0));
                1.0 + height / fat * (-(x * x + y * y) / (width * width)).exp()
            })
            .collect();
        scene["thickness_field"] =
            json!({ "spacing_mm": 4, "columns": 67, "rows": 67, "factors": factors });
    }
    Scene::from_json(&scene.to_string()).unwrap()
}

fn skin_apex(of: &Outcome) -> f64 {
    of.profile_skin[0].z_mm
}

#[test]
fn implants_that_yield_follow_elements() {
    let cases: Vec<Value> =
        serde_json::from_str(include_str!("../../tests/reference/soft.json")).unwrap();
    assert_eq!(cases.len(), 6);
    // The finer mesh of each scene.
    for case in cases.iter().skip(1).step_by(2) {
        let expected = &case["result"];
        let found = simulate(&scene(case, &case["gel"])).unwrap();
        let rigid = simulate(&scene(case, &json!("rigid"))).unwrap();
        let body = found.implant_in_body.unwrap();
        let force = found.contact_force_n.unwrap();
        let relative = |value: f64, name: &str| value / number(expected, name) - 1.0;
        let expected_skin: Vec<[f64; 2]> =
            serde_json::from_value(expected["skin"].clone()).unwrap();
        let apart = found.profile_skin.iter().zip(&expected_skin);
        let apart = apart.map(|(a, [r, z])| (a.r_mm - r).hypot(a.z_mm - z)).fold(0.0, f64::max);
        println!(
            "{}: height {:.2} mm ({:+.2} %), half width {:.2} ({:.2}), force {:+.2} %, skin {:.2} ({:+.2} mm), skin apart {apart:.2} mm; rigid force {:+.2} %, skin {:+.2} mm; cycles {} {}, work {:.1} {:.1}",
            case["name"],
            body.height_mm,
            100.0 * relative(body.height_mm, "implant_height_mm"),
            body.half_width_mm[0],
            number(expected, "implant_half_width_mm"),
            100.0 * relative(force, "force_n"),
            skin_apex(&found),
            skin_apex(&found) - number(expected, "skin_apex_mm"),
            100.0 * (rigid.contact_force_n.unwrap() / number(&case["rigid"], "force_n") - 1.0),
            skin_apex(&rigid) - number(&case["rigid"], "skin_apex_mm"),
            found.solver.cycles,
            rigid.solver.cycles,
            found.solver.work_units,
            rigid.solver.work_units,
        );
        assert!(relative(body.height_mm, "implant_height_mm").abs() < 0.02);
        assert!(relative(force, "force_n").abs() < 0.02);
        assert!((skin_apex(&found) - number(expected, "skin_apex_mm")).abs() < 0.3);
        assert!(apart < 0.01 * number(case, "base_radius_mm"));
        assert!(rigid.implant_in_body.is_none());
        assert!(found.solver.cycles <= rigid.solver.cycles + 2);
        assert!(found.solver.work_units <= 1.4 * rigid.solver.work_units);
    }
}

/// The opening plan with one fill after the other, from the stiffest: lower, wider, under less pressure, and the same volume.
#[test]
fn a_softer_implant_is_lower_and_presses_less() {
    let mut opening = Scene::opening();
    opening.solver.nodes_per_side = 65;
    let solved = |fill: Option<Fill>| {
        let mut scene = opening.clone();
        scene.implant.fill = fill;
        simulate(&scene).unwrap()
    };
    let rigid = solved(None);
    let fills = Fill::NAMED.map(|(name, fill)| (name, solved(Some(fill))));
    let all = [("rigid", rigid.clone())].into_iter().chain(fills);
    let (mut height, mut width) = (opening.implant.projection_mm + 1e-9, 0.0);
    let mut force = f64::INFINITY;
    for (name, found) in all {
        let body = found.implant_in_body;
        println!(
            "| {name} | {:.1} | {:.2} | {:.2} | {:.1}, {:.1} | {:.1} % | {:.3} | {:.1} | {:.1} | {:.2} | {} | {:.0} |",
            body.map_or(f64::INFINITY, |body| body.modulus_kpa),
            found.projection_mm.unwrap(),
            body.map_or(opening.implant.base_radius_mm, |body| body.half_width_mm[0]),
            found.contact_pressure_mmhg.unwrap().mean,
            found.contact_pressure_mmhg.unwrap().max,
            100.0 * found.strain.as_ref().unwrap().max_principal,
            found.area_ratio.unwrap(),
            found.contact_force_n.unwrap(),
            found.skin_projection_mm.unwrap(),
            found.cover_mm.unwrap().apex,
            found.solver.cycles,
            found.solver.work_units,
        );
        assert_eq!(found.status, Status::Converged);
        assert!((found.implant_volume_ml / rigid.implant_volume_ml - 1.0).abs() < 1e-12);
        assert!(found.contact_force_n.unwrap() < force && found.projection_mm.unwrap() < height);
        (force, height) = (found.contact_force_n.unwrap(), found.projection_mm.unwrap());
        let own = body.map_or(opening.implant.base_radius_mm, |body| body.half_width_mm[0]);
        assert!(own > width);
        width = own;
        if let Some(body) = body {
            let pi = std::f64::consts::PI;
            assert!((body.height_mm - height).abs() < 1e-9 && body.energy_mj > 0.0);
            // The dome that stays a cap of this volume and width would be as high within a few per cent.
            let volume = 1000.0 * rigid.implant_volume_ml;
            let [a, b] = body.half_width_mm;
            assert!(
                (volume / (opening.implant.fullness() * pi * a * b) / height - 1.0).abs() < 0.06
            );
            assert!(body.deformation.shear.iter().all(|shear| shear.abs() <= 0.0));
        }
    }
}

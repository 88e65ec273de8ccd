//! The axisymmetric reference of layered tissue compared with an independent finite-element solution.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview::springs::Material;
use implant_preview_lab::axisymmetric_layers::{self, Input, Solution};
use serde_json::Value;

#[path = "common/reference_case.rs"]
mod reference_case;
use reference_case::{input, number};

fn points(of: &Value, name: &str) -> Vec<[f64; 2]> {
    serde_json::from_value(of[name].clone()).unwrap()
}

/// The cases of `tests/reference/layered.json`, one for each mesh.
fn cases() -> Vec<Value> {
    let file: Value = serde_json::from_str(include_str!("reference/layered.json")).unwrap();
    file["cases"].as_array().unwrap().clone()
}

/// Greatest distance of two profiles \[mm\].
fn distance(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1])).fold(0.0, f64::max)
}

fn solve(case: &Value) -> Solution {
    axisymmetric_layers::solve(&input(case)).unwrap()
}

/// Limit of the force \[N\] on ever finer meshes from those with 2/3 and 1 of the finest mesh's cells, of first order.
fn limit([coarse, fine]: [f64; 2]) -> f64 {
    fine + 2.0 * (fine - coarse)
}

#[test]
fn every_mesh_agrees_with_the_independent_solution_and_so_does_the_limit() {
    let cases = cases();
    assert_eq!(cases.len(), 12);
    for meshes in cases.chunks(3) {
        let mut own = Vec::new();
        for case in meshes {
            let expected = &case["result"];
            let found = solve(case);
            let scale = number(case, "base_radius_mm");
            let off = |value: f64, name: &str| (value - number(expected, name)).abs();
            let relative = |value: f64, name: &str| off(value, name) / number(expected, name);
            let force = relative(found.contact_force_n, "contact_force_n");
            let inner = distance(&found.inner, &points(expected, "inner")) / scale;
            let skin = distance(&found.skin, &points(expected, "skin")) / scale;
            println!(
                "{} {}: force {force:.1e}, inner face {inner:.1e} R, skin {skin:.1e} R",
                case["name"], expected["nr"]
            );
            assert!(force < 3e-5 && inner < 3e-5 && skin < 5e-6);
            assert!(off(found.apex_inner_mm, "apex_inner_mm") < 1e-6);
            assert!(off(found.apex_skin_mm, "apex_skin_mm") < 1e-4);
            let cover = found.apex_skin_mm - found.apex_inner_mm;
            assert!(off(cover, "cover_at_apex_mm") < 1e-4);
            assert!(relative(found.skin_apex_stretch, "skin_apex_stretch") < 2e-6);
            let ratio = found.skin_area_ratio_over_pocket;
            assert!(relative(ratio, "skin_area_ratio_over_pocket") < 3e-6);
            own.push(found.contact_force_n);
        }
        let forces: Vec<f64> =
            meshes.iter().map(|case| number(&case["result"], "contact_force_n")).collect();
        let expected = limit([forces[1], forces[2]]);
        assert!((limit([own[1], own[2]]) / expected - 1.0).abs() < 3e-5);
        let errors: Vec<f64> = own.iter().map(|force| force / expected - 1.0).collect();
        println!("{}: limit {expected:.3} N, errors {errors:.5?}", meshes[0]["name"]);
        assert!(errors[0].abs() < 0.013 && errors[1].abs() < 0.007 && errors[2].abs() < 0.0045);
    }
}

#[test]
fn a_mesh_of_its_own_is_nearer_the_finest_one_than_a_coarser_mesh() {
    for meshes in cases().chunks(3) {
        let [coarse, finest] = [&meshes[0]["result"], &meshes[2]["result"]];
        let found = axisymmetric_layers::solve(&Input { cells: [100, 6], ..input(&meshes[0]) });
        let found = found.unwrap();
        let far = |name: &str| distance(&points(coarse, name), &points(finest, name));
        let inner = distance(&found.inner, &points(finest, "inner"));
        let skin = distance(&found.skin, &points(finest, "skin"));
        let [coarse, finest] = [coarse, finest].map(|mesh| number(mesh, "contact_force_n"));
        let force = found.contact_force_n - finest;
        println!("{}: {inner:.3} mm, {skin:.3} mm, {force:.3} N", meshes[0]["name"]);
        assert!(inner < far("inner") && skin < far("skin"));
        assert!(force.abs() < (coarse - finest).abs());
    }
}

#[test]
fn a_dome_at_the_wall_leaves_the_tissue_at_rest_and_a_low_one_lifts_it() {
    let flat = Input { insertion: 0.0, ..input(&cases()[0]) };
    let found = axisymmetric_layers::solve(&flat).unwrap();
    assert!(found.contact_force_n.abs() < 1e-12 && found.apex_inner_mm.abs() < 1e-12);
    assert!((found.apex_skin_mm - 10.0).abs() < 1e-12);
    assert!((found.skin_area_ratio_over_pocket - 1.0).abs() < 1e-12);
    let low = axisymmetric_layers::solve(&Input { insertion: 0.2, ..flat }).unwrap();
    assert!(low.contact_force_n > 0.1 && (low.apex_inner_mm - 11.0).abs() < 1e-6);
}

#[test]
fn a_folded_inner_face_is_no_solution() {
    let needle = Input { projection_mm: 110.0, cells: [40, 2], ..input(&cases()[0]) };
    let line = axisymmetric_layers::solve(&needle).unwrap_err().to_string();
    assert!(line.starts_with("no equilibrium"), "{line}");
}

#[test]
fn invalid_input_is_rejected_in_one_line() {
    let valid = input(&cases()[0]);
    let invalid = [
        Input { patch_radius_mm: 60.0, ..valid.clone() },
        Input { projection_mm: f64::NAN, ..valid.clone() },
        Input { insertion: 1.5, ..valid.clone() },
        Input { layers: valid.layers[..1].to_vec(), ..valid.clone() },
        Input { cells: [1, 4], ..valid.clone() },
        Input {
            layers: vec![
                valid.layers[0].clone(),
                Material { poisson_ratio: 0.5, ..valid.layers[1].clone() },
            ],
            ..valid
        },
    ];
    for input in invalid {
        let line = axisymmetric_layers::solve(&input).unwrap_err().to_string();
        assert!(line.contains("allowed") && !line.contains('\n') && line.len() < 120, "{line}");
    }
}

//! The axisymmetric reference solution compared with an independent solution, theory, virtual work and the grid.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use glam::DVec2;
use implant_preview::contact::{Dome, HalfBall};
use implant_preview::curve::Curve;
use implant_preview::scene::Scene;
use implant_preview::simulate::simulate;
use implant_preview::solve::Problem;
use implant_preview::springs::Material;
use implant_preview::springs::coupled::equivalent_strain;
use implant_preview_lab::axisymmetric::{self, AxisymmetricError, Solution};
use serde_json::{Value, json};
use std::f64::consts::{FRAC_PI_2, PI};

#[path = "common/membrane.rs"]
mod membrane;

/// Without the grid.
fn solve(scene: &Scene) -> Result<Solution, AxisymmetricError> {
    let Problem { obstacle, patch, materials, .. } = scene.problem().unwrap();
    let dome = obstacle.dome;
    axisymmetric::solve(&dome, patch.pocket_radius_mm, &materials)
}

fn position(solution: &Solution, s_mm: f64) -> (f64, f64) {
    let point = solution.point(s_mm);
    (point.r_mm, point.z_mm)
}

fn stretches(solution: &Solution, s_mm: f64) -> [f64; 2] {
    let point = solution.point(s_mm);
    [point.stretch_meridional, point.stretch_hoop]
}

/// A sheet.
fn scene(json: &Value) -> Scene {
    let mut json = json.clone();
    json["tissue_model"] = "sheet".into();
    Scene::from_json(&json.to_string()).unwrap()
}

fn solved(json: &Value) -> Solution {
    solve(&scene(json)).unwrap()
}

/// Strain energy of the whole sheet \[mN·mm\], by Simpson's rule on the dome and on the free part.
fn strain_energy(scene: &Scene, membrane: &Solution) -> f64 {
    let curves: Vec<Curve> =
        scene.layers.iter().map(|l| Curve::scaled(&l.curve).unwrap()).collect();
    let density = |s: f64| -> f64 {
        let strain = stretches(membrane, s).map(|l| l - 1.0);
        let layers = scene.layers.iter().zip(&curves);
        let sum: f64 = layers
            .map(|(l, curve)| {
                l.thickness_mm * curve.energy(equivalent_strain(strain, l.poisson_ratio))
            })
            .sum();
        2.0 * PI * s * sum
    };
    let simpson = |from: f64, to: f64| {
        let steps = 1000;
        let at = |k: u32| from + (to - from) * f64::from(k) / f64::from(steps);
        let pair = |k: u32| density(at(k)) + 4.0 * density(at(k + 1)) + density(at(k + 2));
        (0..steps).step_by(2).map(pair).sum::<f64>() * (to - from) / f64::from(3 * steps)
    };
    // Next to the edge: the meridional strain is continuous at the edge, its slope is not.
    let edge = membrane.contact_material_radius_mm;
    simpson(0.0, edge) + simpson(edge, scene.pocket_radius_mm)
}

#[test]
fn the_solution_agrees_with_an_independent_reference_in_every_figure_and_point() {
    for case in membrane::cases() {
        let membrane = solve(&membrane::scene_of(&case)).unwrap();
        let radius = case["dome_radius_mm"].as_f64().unwrap();
        let result = &case["result"];
        for (name, got) in [
            ("apex_stretch", membrane.apex_stretch),
            ("contact_angle_deg", membrane.contact_angle.to_degrees()),
            ("contact_material_radius_mm", membrane.contact_material_radius_mm),
            ("contact_force_n", membrane.contact_force_n),
            ("area_ratio", membrane.area_ratio),
        ] {
            let error = (got / result[name].as_f64().unwrap() - 1.0).abs();
            println!("{} {name}: {error:.1e}", case["name"]);
            assert!(error < 1e-6, "{} {name}: {got}, off by {error:.1e}", case["name"]);
        }
        let column = |name: &str| -> Vec<f64> {
            result[name].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect()
        };
        let (s, r, z) = (column("s_mm"), column("r_mm"), column("z_mm"));
        assert_eq!(s.len(), 41);
        for k in 0..s.len() {
            let (r_mm, z_mm) = position(&membrane, s[k]);
            let error = (r_mm - r[k]).hypot(z_mm - z[k]) / radius;
            assert!(error < 1e-6, "{} at {}: off by {error:.1e}", case["name"], s[k]);
        }
    }
}

#[test]
fn the_figures_of_theory_for_a_linear_sheet() {
    let (radius, modulus, thickness) = (40.0, 10.0, 1.5);
    let membrane = solved(&json!({
        "implant": { "base_radius_mm": radius }, "pocket_radius_mm": 1.5 * radius,
        "layers": [ { "thickness_mm": thickness, "poisson_ratio": 1.0 / 3.0,
                      "curve": { "kind": "linear", "modulus_kpa": modulus } } ],
    }));
    let force = membrane.contact_force_n * 1000.0 / (modulus * thickness * radius);
    for (got, theory) in
        [(force, 1.056), (membrane.apex_stretch, 1.283), (membrane.area_ratio, 1.291)]
    {
        assert!((got - theory).abs() <= 0.000_5, "{got} against {theory}");
    }
}

#[test]
fn the_force_is_the_slope_of_the_strain_energy() {
    let layers = json!([
        { "thickness_mm": 2, "poisson_ratio": 0.3,
          "curve": { "kind": "exponential", "scale_kpa": 2, "rate": 4 } },
        { "thickness_mm": 12, "poisson_ratio": 0.5, "curve": { "kind": "adipose" } } ]);
    for (projection, insertion) in [(30.0, 0.7), (75.0, 0.6), (50.0, 0.97)] {
        let at = |insertion: f64| {
            let scene = scene(&json!({
                "implant": { "base_radius_mm": 50, "projection_mm": projection },
                "pocket_radius_mm": 65, "insertion": insertion, "layers": layers,
            }));
            let membrane = solve(&scene).unwrap();
            (strain_energy(&scene, &membrane), membrane)
        };
        let step = 1e-3;
        let slope = (at(insertion + step).0 - at(insertion - step).0) / (2.0 * step * projection);
        let force = at(insertion).1.contact_force_n * 1000.0;
        let error = (slope / force - 1.0).abs();
        println!("virtual work {projection} {insertion}: {error:.1e}");
        assert!(error < 2e-5, "{slope} against {force}: {error:.1e}");
    }
}

#[test]
fn the_shape_is_continuous_clamped_and_tangent_to_the_dome() {
    for (projection, pocket, insertion) in
        [(55.0, 70.0, 1.0), (25.0, 56.0, 0.4), (90.0, 120.0, 0.9), (55.0, 55.000_1, 1.0)]
    {
        let scene = scene(&json!({
            "implant": { "base_radius_mm": 55, "projection_mm": projection },
            "pocket_radius_mm": pocket, "insertion": insertion,
        }));
        let membrane = solve(&scene).unwrap();
        let (r, z) = position(&membrane, pocket);
        assert!((r - pocket).abs() < 1e-8 * 55.0 && z.abs() < 1e-8 * 55.0, "{r} {z}");
        let (r, z) = position(&membrane, 0.0);
        assert!(r.abs() < 1e-12 && (z - insertion * projection).abs() < 1e-12);
        let edge = membrane.contact_material_radius_mm;
        let (small, wide) = (1e-7 * edge, 1e-4 * edge);
        let (below, above) = (position(&membrane, edge - small), position(&membrane, edge + small));
        assert!((below.0 - above.0).hypot(below.1 - above.1) < 1e-5 * edge);
        let stretch = [-small, small].map(|d| stretches(&membrane, edge + d)[0]);
        assert!((stretch[0] - stretch[1]).abs() < 1e-5, "{stretch:?}");
        // Steps on both sides of the edge have the same direction.
        let middle = position(&membrane, edge);
        let [before, after] = [-wide, wide].map(|d| {
            let (r, z) = position(&membrane, edge + d);
            ((z - middle.1) / (r - middle.0)).atan()
        });
        if pocket - edge > wide {
            assert!((before - after).abs() < 1e-3, "{before} {after}");
        }
        // The integrated stretches equal the stretches of the positions.
        for share in [0.01, 0.3, 0.6, 0.9, 0.99] {
            let (s, step) = (share * pocket, 1e-4 * pocket);
            if (s - edge).abs() < 2.0 * step {
                continue;
            }
            let (low, high) = (position(&membrane, s - step), position(&membrane, s + step));
            let along = (high.0 - low.0).hypot(high.1 - low.1) / (2.0 * step);
            let [meridional, hoop] = stretches(&membrane, s);
            assert!((along - meridional).abs() < 1e-5, "{along} {meridional} at {s}");
            assert!((position(&membrane, s).0 / s - hoop).abs() < 1e-9);
        }
        let area = membrane.area_ratio;
        let steps = 20_000;
        let rings: f64 = (0..steps)
            .map(|k| {
                let s = pocket * (f64::from(k) + 0.5) / f64::from(steps);
                let [meridional, hoop] = stretches(&membrane, s);
                2.0 * s * meridional * hoop
            })
            .sum::<f64>()
            / (f64::from(steps) * pocket);
        assert!((area / rings - 1.0).abs() < 1e-7, "{area} {rings}");
    }
}

#[test]
fn a_pocket_as_wide_as_the_dome_is_in_contact_everywhere() {
    let at = |pocket: f64| {
        solved(&json!({ "implant": { "base_radius_mm": 50, "projection_mm": 35 },
                        "pocket_radius_mm": pocket }))
    };
    let full = at(50.0);
    assert!((full.contact_angle - FRAC_PI_2).abs() < 1e-8);
    assert!((full.contact_material_radius_mm - 50.0).abs() < 1e-8);
    // The half-spheroid's area in closed form.
    let e = (1.0 - 0.7_f64 * 0.7).sqrt();
    let ratio = 1.0 + (1.0 - e * e) / e * e.atanh();
    assert!((full.area_ratio / ratio - 1.0).abs() < 1e-8, "{}", full.area_ratio);
    // The solution is the limit of wider pockets; the edge moves with the root of the gap.
    for gap in [1e-4, 1e-6, 1e-7] {
        let near = at(50.0 * (1.0 + gap));
        assert!((near.apex_stretch / full.apex_stretch - 1.0).abs() < 3.0 * gap);
        let turned = (FRAC_PI_2 - near.contact_angle) / gap.sqrt();
        assert!((0.5..3.0).contains(&turned), "{turned} at {gap:e}");
    }
}

#[test]
fn the_opening_scene_as_a_sheet_and_real_proportions_have_a_solution() {
    assert!(solve(&Scene::sheet()).unwrap().contact_force_n > 0.0);
    let mut solved = 0;
    for base in [40.0, 90.0_f64] {
        for projection in [0.4 * base, base, 1.2 * base] {
            for pocket in [base, base * 1.01, 1.5 * base] {
                for insertion in [0.1, 0.5, 1.0] {
                    for curve in ["skin", "adipose"] {
                        let scene = scene(&json!({
                            "implant": { "base_radius_mm": base, "projection_mm": projection },
                            "pocket_radius_mm": pocket, "insertion": insertion,
                            "layers": [ { "poisson_ratio": 0.45, "curve": { "kind": curve } } ],
                        }));
                        match solve(&scene) {
                            Ok(membrane) => {
                                solved += 1;
                                let (r, z) = position(&membrane, pocket);
                                let off = (r - pocket).hypot(z) / base;
                                assert!(
                                    off < 1e-8,
                                    "{base} {projection} {pocket} {insertion}: {off:e}"
                                );
                            }
                            Err(error) => {
                                println!(
                                    "{base} {projection} {pocket} {insertion} {curve}: {error}"
                                );
                            }
                        }
                    }
                }
            }
        }
    }
    assert_eq!(solved, 108);
}

#[test]
fn the_grid_solver_agrees_on_an_ellipsoid() {
    for (projection, insertion) in [(35.0, 1.0), (75.0, 0.7)] {
        let scene = scene(&json!({
            "implant": { "base_radius_mm": 50, "projection_mm": projection },
            "pocket_radius_mm": 68, "insertion": insertion,
            "solver": { "nodes_per_side": 129, "tolerance": 1e-5 },
        }));
        let membrane = solve(&scene).unwrap();
        let outcome = simulate(&scene).unwrap();
        let error = outcome
            .profile
            .iter()
            .map(|point| {
                let (r, z) = position(&membrane, point.s_mm);
                (point.r_mm - r).hypot(point.z_mm - z) / 50.0
            })
            .fold(0.0, f64::max);
        let force = outcome.contact_force_n.unwrap() / membrane.contact_force_n - 1.0;
        println!("grid {projection}: {error:.1e}, force {force:.1e}");
        assert!(error < 0.000_2, "{error:.1e}");
        assert!(force.abs() < 1e-3, "{force:.1e}");
        let edge = outcome.contact_material_radius_mm.unwrap();
        assert!((edge - membrane.contact_material_radius_mm).abs() < 2e-3 * edge, "{edge}");
    }
}

#[test]
fn scenes_that_are_not_axisymmetric_are_rejected_in_one_line() {
    let Problem { obstacle, patch, materials, .. } = Scene::sheet().problem().unwrap();
    let dome = obstacle.dome;
    let refused = |dome: Dome, materials: &[Material]| {
        axisymmetric::solve(&dome, patch.pocket_radius_mm, materials).unwrap_err()
    };
    let none = refused(dome.clone(), &[]);
    assert_eq!(none, AxisymmetricError::NoLayers);
    let off = refused(Dome { center: DVec2::new(3.0, 4.0), ..dome.clone() }, &materials);
    assert_eq!(off, AxisymmetricError::OffCentre { distance_mm: 5.0 });
    let reshaped =
        |shape: HalfBall| refused(Dome { shape: shape.into(), ..dome.clone() }, &materials);
    let round = HalfBall::round(dome.reference_length(), dome.projection());
    let tall = reshaped(round.anatomical(1.2 * dome.reference_length(), 0.0));
    assert_eq!(tall, AxisymmetricError::NotRound);
    let wide = reshaped(HalfBall::round(1.1 * patch.pocket_radius_mm, dome.projection()));
    for error in [none, off, tall, wide] {
        let line = error.to_string();
        assert!(line.contains("allowed") && !line.contains('\n') && line.len() < 120, "{line}");
    }
}

#[test]
fn a_sheet_at_zero_insertion_stays_flat() {
    let flat = solved(&json!({ "implant": { "base_radius_mm": 50 }, "insertion": 0.0 }));
    assert_eq!((flat.apex_stretch, flat.contact_force_n, flat.area_ratio), (1.0, 0.0, 1.0));
    assert_eq!(position(&flat, 20.0), (20.0, 0.0));
}

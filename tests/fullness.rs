//! Domes of another fullness: volume / (π a b p), half of an ellipsoid of ⅔.

#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview::clinical::{Dimension, Size};
use implant_preview::contact::HALF_ELLIPSOID;
use implant_preview::measure::{ProfilePoint, SolverMethod, Status};
use implant_preview::scene::{Field, Scene};
use implant_preview::session::{Command, Session};
use implant_preview::simulate::simulate;
use implant_preview::study::{Parameter, with_values};
use implant_preview_lab::axisymmetric;
use implant_preview_lab::axisymmetric_layers::{self, Input};
use serde_json::{Value, json};
use std::f64::consts::PI;

fn file(implant: &Value) -> Value {
    let mut file = json!({
        "implant": { "base_radius_mm": 60, "projection_mm": 40 },
        "solver": { "nodes_per_side": 17 }
    });
    for (name, value) in implant.as_object().into_iter().flatten() {
        file["implant"][name] = value.clone();
    }
    file
}

fn read(implant: &Value) -> Result<Scene, String> {
    Scene::from_json(&file(implant).to_string()).map_err(|error| error.to_string())
}

/// Volume of the elliptic cylinder around the implant of [`file`] \[ml\].
const CYLINDER_ML: f64 = PI * 6.0 * 6.0 * 4.0;

#[test]
fn two_thirds_is_the_half_ellipsoid_and_is_not_written() {
    let plain = read(&json!({})).unwrap();
    for same in [json!({ "fullness": 2.0 / 3.0 }), json!({ "volume_ml": CYLINDER_ML * 2.0 / 3.0 })]
    {
        let scene = read(&same).unwrap();
        assert_eq!(scene, plain);
        assert_eq!(scene.to_json(), plain.to_json());
    }
    assert!((plain.implant.fullness() - HALF_ELLIPSOID).abs() < 1e-15);
}

#[test]
fn a_reference_is_kept_and_copied_to_the_result_until_the_size_changes() {
    let name = "Round 300, „moderate plus“ 12.0 × 4.0 cm";
    let scene = read(&json!({ "reference": name })).unwrap();
    assert_eq!(scene.implant_reference, name);
    let written: Value = serde_json::from_str(&scene.to_json()).unwrap();
    assert_eq!(written["implant"]["reference"], name);
    assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
    let plain = read(&json!({})).unwrap();
    assert!(scene.same_physics(&plain) && !scene.is_same_plan(&plain));
    let outcome = simulate(&scene).unwrap();
    assert_eq!(outcome.implant_reference, name);
    let result = serde_json::to_value(&outcome).unwrap();
    assert_eq!(result["implant_reference"], name);
    // A map over the insertion is of the same size, a map over the projection is not.
    let kept = with_values(&scene, &[(Parameter::of(Field::Insertion), 0.5)]).unwrap();
    assert_eq!(kept.implant_reference, name);
    let other = with_values(&scene, &[(Parameter::of(Field::Projection), 41.0)]).unwrap();
    assert_eq!(other.implant_reference, "");
    // An edit, likewise; the name of a result follows the name of its scene without a solve.
    let mut session = Session::new(plain.clone()).unwrap();
    while session.advance(&mut || false) == implant_preview::solve::Progress::Working {}
    let mut edit = |scene: &Scene| {
        session.apply(Command::Edit { scene: Box::new(scene.clone()), gesture: 1 }).unwrap();
        (session.scene().implant_reference.clone(), session.is_working())
    };
    assert_eq!(edit(&scene), (name.to_owned(), false));
    let mut moved = scene.clone();
    moved.implant.center_mm = [3.0, 0.0];
    assert_eq!(edit(&moved), (name.to_owned(), true));
    moved.implant.projection_mm = 42.0;
    assert_eq!(edit(&moved), (String::new(), true));
}

#[test]
fn bad_values_are_one_line() {
    let long = "x".repeat(61);
    for (implant, wanted) in [
        (json!({ "fullness": 0.54 }), "implant.fullness is 0.54; allowed: 0.55 to 0.8"),
        (json!({ "fullness": 0.81 }), "implant.fullness is 0.81; allowed: 0.55 to 0.8"),
        (
            json!({ "volume_ml": 400 }),
            "implant.volume_ml: 400 ml on a base of 120 mm at a projection of 40 mm gives a fullness of 0.884; allowed: 0.55 to 0.8",
        ),
        (
            json!({ "volume_ml": 200, "base_height_mm": 130 }),
            "implant.volume_ml: 200 ml on a base of 120 × 130 mm at a projection of 40 mm gives a fullness of 0.408; allowed: 0.55 to 0.8",
        ),
        (
            json!({ "volume_ml": -3 }),
            "implant.volume_ml: the volume is -3 ml; allowed: 0.3 to 4350 ml",
        ),
        (
            json!({ "volume_ml": 310, "fullness": 0.7 }),
            "implant.volume_ml: 310 ml, and implant.fullness gives 316.7 ml; allowed: one of the two, or equal volumes",
        ),
        (
            json!({ "reference": long }),
            "implant.reference is 61 characters long; allowed: up to 60 characters",
        ),
        (
            json!({ "reference": "a\nb" }),
            "implant.reference is a b; allowed: text without line breaks and control characters",
        ),
    ] {
        assert_eq!(read(&implant).unwrap_err(), wanted);
    }
}

#[test]
fn any_two_dimensions_give_the_third_at_the_same_fullness() {
    let size = Size::of_width_and_projection(120.0, 40.0).unwrap();
    let full = size.filled_to(320.0).unwrap();
    assert!((full.fullness() - 320.0 / CYLINDER_ML).abs() < 1e-15);
    assert!((full.volume_ml() - 320.0).abs() < 1e-10);
    use Dimension::{BaseWidth, Projection, Volume};
    for (dimension, value, locked) in [
        (BaseWidth, 130.0, Projection),
        (BaseWidth, 130.0, Volume),
        (Projection, 44.0, BaseWidth),
        (Projection, 44.0, Volume),
        (Volume, 350.0, BaseWidth),
        (Volume, 350.0, Projection),
    ] {
        let full = full.with_aspect(1.1).changed(dimension, value, locked).unwrap();
        assert!((full.fullness() - 320.0 / CYLINDER_ML).abs() < 1e-15);
        let [a, p] = [0.05 * full.base_width_mm(), full.projection_cm()];
        let volume = full.fullness() * PI * a * (1.1 * a) * p;
        assert!((full.volume_ml() / volume - 1.0).abs() < 1e-14);
    }
    for follows in [BaseWidth, Projection, Volume] {
        let tall = full.with_base_height(135.0, follows).unwrap();
        assert!((tall.fullness() - full.fullness()).abs() < 1e-15);
    }
    let half = size.filled_to(size.volume_ml()).unwrap();
    assert!((half.fullness() - HALF_ELLIPSOID).abs() < 1e-15);
}

/// The fullness of the comparisons with the axisymmetric references.
const THREE: [f64; 3] = [0.58, 0.72, 0.8];

/// Greatest distance of a profile from another one \[mm\].
fn apart(profile: &[ProfilePoint], of: impl Fn(f64) -> (f64, f64)) -> f64 {
    let distance = |point: &ProfilePoint| {
        let (r, z) = of(point.s_mm);
        (point.r_mm - r).hypot(point.z_mm - z)
    };
    profile.iter().map(distance).fold(0.0, f64::max)
}

#[test]
fn a_sheet_agrees_with_the_axisymmetric_solution() {
    for (fullness, pocket, insertion) in [
        (0.58, 75.0, 1.0),
        (0.72, 70.0, 0.7),
        (0.8, 75.0, 1.0),
        (0.55, 63.0, 1.0),
        (0.8, 60.0, 1.0),
        (HALF_ELLIPSOID, 75.0, 1.0),
    ] {
        let mut scene = file(&json!({ "fullness": fullness }));
        scene["tissue_model"] = json!("sheet");
        scene["pocket_radius_mm"] = json!(pocket);
        scene["insertion"] = json!(insertion);
        scene["solver"]["nodes_per_side"] = json!(129);
        let scene = Scene::from_json(&scene.to_string()).unwrap();
        let problem = scene.problem().unwrap();
        let reference =
            axisymmetric::solve(&problem.obstacle.dome, pocket, &problem.materials).unwrap();
        let found = simulate(&scene).unwrap();
        let skin = apart(&found.profile, |s| {
            let point = reference.point(s);
            (point.r_mm, point.z_mm)
        }) / scene.implant.base_radius_mm;
        let force = found.contact_force_n.unwrap() / reference.contact_force_n - 1.0;
        println!(
            "sheet, fullness {fullness}, pocket {pocket}: skin {:.3} %, force {:.2} %, {:.1} work units",
            100.0 * skin,
            100.0 * force,
            found.solver.work_units
        );
        assert_eq!(found.status, Status::Converged);
        assert!(skin < 1.5e-3 && force.abs() < 0.01, "{fullness}: {skin} {force}");
    }
}

#[test]
fn layered_tissue_agrees_with_the_axisymmetric_reference() {
    for fullness in [HALF_ELLIPSOID].into_iter().chain(THREE) {
        let mut scene = file(&json!({ "fullness": fullness, "projection_mm": 38 }));
        scene["solver"] = json!({ "nodes_per_side": 129, "cells_through": 4 });
        let scene = Scene::from_json(&scene.to_string()).unwrap();
        let problem = scene.problem().unwrap();
        let on = |cells: [usize; 2]| {
            let input = Input { fullness, ..Input::of(&scene, &problem, cells).unwrap() };
            axisymmetric_layers::solve(&input).unwrap()
        };
        let [coarse, fine] = [on([72, 4]), on([144, 8])];
        let limit = |coarse: f64, fine: f64| fine + (fine - coarse) / 3.0;
        let found = simulate(&scene).unwrap();
        let skin = apart(&found.profile_skin, |s| {
            let [a, b] = [&coarse, &fine].map(|mesh| mesh.point(s).1);
            (limit(a[0], b[0]), limit(a[1], b[1]))
        }) / scene.implant.base_radius_mm;
        let reference = limit(coarse.contact_force_n, fine.contact_force_n);
        let force = found.contact_force_n.unwrap() / reference - 1.0;
        println!(
            "layered, fullness {fullness:.3}: {reference:.2} N, skin {:.3} %, force {:.2} %, {:.1} work units, {} cycles, fell back {}",
            100.0 * skin,
            100.0 * force,
            found.solver.work_units,
            found.solver.cycles,
            found.solver.fell_back
        );
        assert_eq!(found.status, Status::Converged);
        assert!(skin < 1.5e-3 && force.abs() < 0.01, "{fullness}: {skin} {force}");
    }
}

/// Multigrid in f32 and Newton's method in f64, whose contact is other code.
#[test]
fn both_methods_find_the_same_shape() {
    for (fullness, height, shift) in
        [(0.55, 120, 0), (0.8, 120, 0), (0.6, 132, 12), (0.75, 110, 10)]
    {
        let mut scene = file(&json!({
            "fullness": fullness, "base_height_mm": height, "apex_shift_mm": shift, "center_mm": [2, -3]
        }));
        scene["tissue_model"] = json!("sheet");
        let mut solve = |tolerance: f64| {
            scene["solver"] = json!({ "nodes_per_side": 65, "tolerance": tolerance });
            simulate(&Scene::from_json(&scene.to_string()).unwrap()).unwrap()
        };
        let [multigrid, newton] = [1e-4, 1e-7].map(&mut solve);
        assert_eq!((multigrid.status, newton.status), (Status::Converged, Status::Converged));
        assert_eq!(newton.solver.method, SolverMethod::Newton);
        let points = multigrid.profile.iter().zip(&newton.profile);
        let apart = points.map(|(a, b)| (a.r_mm - b.r_mm).hypot(a.z_mm - b.z_mm));
        let most = apart.fold(0.0, f64::max) / 60.0;
        assert!(most < 2e-4, "{fullness}: {most}");
    }
}

//! From a body's surface over its scene to the surface over the implant.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

#[path = "common/tissue.rs"]
mod tissue;
#[path = "../../body/tests/common/torso.rs"]
mod torso;

use glam::DVec3;
use implant_preview_core::body::deform::deform;
use implant_preview_core::body::fit::{BodyFit, Settings, fit};
use implant_preview_core::body::marks::Side;
use implant_preview_core::body::pick::snap;
use implant_preview_core::body::read::Unit;
use implant_preview_core::body::reduce::reduced;
use implant_preview_core::body::surface::Surface;
use implant_preview_core::scene::{self, CheckedScene, KeptSurface, Scene};
use implant_preview_core::simulate::{self, Simulation};
use implant_preview_core::solve::Options;
use tissue::inner_gain;

const PROJECTION: f64 = 62.3;

/// A body, its fit and its scene on a coarse grid.
fn subject(side: Side) -> (Surface, BodyFit, Scene) {
    let (surface, marks) = (torso::torso(PROJECTION, 140, 110), torso::marks(PROJECTION));
    let fitted = fit(&surface, &marks, side, &Settings::default()).unwrap();
    let mut scene = Scene::of_body(&fitted, (&marks, side), 10.0, Unit::Mm).unwrap();
    (scene.solver.nodes_per_side, scene.solver.tolerance) = (33, 1e-3);
    (surface, fitted, scene)
}

fn solved(scene: &Scene) -> Simulation {
    simulate::run(&CheckedScene::new(scene.clone()).unwrap(), Options::default(), None)
}

#[test]
fn a_body_over_an_implant_keeps_its_tissue_and_has_no_seam() {
    for side in [Side::Left, Side::Right] {
        let (surface, fitted, scene) = subject(side);
        assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
        assert_eq!(scene.placement.as_ref().unwrap().frame(), fitted.frame);
        let Simulation { outcome, solution } = solved(&scene);
        assert!(solution.report().verdict == implant_preview_core::solve::Verdict::Converged);
        assert!(
            !solution.report().fell_back
                && outcome.warnings.iter().all(|line| !line.contains("tilted"))
        );
        let deformed = deform(&surface, &fitted.frame, &solution);
        assert_eq!(deformed.triangles, surface.triangles);

        let inside = inner_gain([&surface, &deformed], &solution, &fitted);
        let implant = 225.0;
        assert!(inside > implant && inside < 1.4 * implant, "{inside}");

        // Normals of the triangles between moved and other vertices, the rim of the patch; and no triangle is turned over.
        let mut most: f64 = 0.0;
        for triangle in &surface.triangles {
            let normal = |surface: &Surface| {
                let [a, b, c] = surface.corners(*triangle);
                (b - a).cross(c - a).normalize()
            };
            let (before, after) = (normal(&surface), normal(&deformed));
            assert!(before.dot(after) > 0.2);
            let is_moved =
                triangle.map(|k| surface.positions[k as usize] != deformed.positions[k as usize]);
            if is_moved.contains(&true) && is_moved.contains(&false) {
                most = most.max(before.angle_between(after).to_degrees());
            }
        }
        println!("normals at the rim turn by up to {most:.2}°");
        assert!(most < 2.0, "{most}");
        // The nipple moves outwards, and nothing else than the patch moves.
        let moved = |p: &(&DVec3, &DVec3)| p.0.distance(*p.1);
        let pairs = || surface.positions.iter().zip(&deformed.positions);
        assert!(pairs().map(|pair| moved(&pair)).fold(0.0, f64::max) > 15.0);
        for (before, after) in pairs() {
            let local = fitted.frame.local(*before);
            assert!(local.truncate().length() < 150.0 && local.z > -140.0 || before == after);
        }
    }
}

#[test]
fn at_zero_insertion_every_vertex_keeps_its_bits() {
    let (surface, fitted, mut scene) = subject(Side::Left);
    scene.insertion = 0.0;
    let after = deform(&surface, &fitted.frame, &solved(&scene).solution);
    let bits = |surface: &Surface| -> Vec<[u64; 3]> {
        surface.positions.iter().map(|p| p.to_array().map(f64::to_bits)).collect()
    };
    assert_eq!(bits(&after), bits(&surface));
}

#[test]
fn a_flat_body_is_the_flat_scene() {
    let (_, fitted, _) = subject(Side::Left);
    let flat = |height: f64| vec![height; fitted.grid.len()];
    let fitted = BodyFit {
        skin_mm: flat(10.0),
        bare_mm: flat(10.0),
        wall_mm: flat(0.0),
        thickness_mm: flat(10.0),
        ..fitted
    };
    let marks = torso::marks(PROJECTION);
    let mut scene = Scene::of_body(&fitted, (&marks, Side::Left), 10.0, Unit::Mm).unwrap();
    let field = scene.thickness_field.as_ref().unwrap();
    assert!(field.factors.iter().all(|factor| factor.to_bits() == 1.0_f64.to_bits()));
    (scene.solver.nodes_per_side, scene.solver.tolerance) = (33, 1e-4);
    let mut flat =
        Scene { placement: None, chest_grid: None, thickness_field: None, ..scene.clone() };
    flat.side = None;
    let [of_body, of_flat] = [&scene, &flat].map(|scene| solved(scene).outcome);
    let force = |outcome: &implant_preview_core::measure::Outcome| outcome.contact_force_n.unwrap();
    let ratio = force(&of_body) / force(&of_flat);
    assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
}

#[test]
fn a_scene_of_a_body_is_one_for_all_edits_and_its_place_stays_in_the_file() {
    let (_, _, scene) = subject(Side::Right);
    assert!(scene.is_right() && scene.same_physics(&scene.without_visit()));
    assert_eq!(scene.without_visit().placement, None);
    let text = scene.to_json();
    let line = |from: &str, to: &str| {
        let edited = text.replacen(from, to, 1);
        assert_ne!(edited, text, "{from}");
        let line = Scene::from_json(&edited).unwrap_err().to_string();
        assert!(!line.contains('\n') && line.len() < 300, "{line}");
        line
    };
    for (from, to, expected) in [
        ("\"cover_mm\": 10.0", "\"cover_mm\": 3", "body.cover_mm is 3; allowed: 6 to 30 mm"),
        ("\"unit\": \"mm\"", "\"unit\": \"in\"", "body.unit: unknown variant `in`"),
        ("\"navel\"", "\"nabel\"", "body.marks"),
        ("\"origin_mm\": [", "\"origin_mm\": [null, ", "body.origin_mm"),
        ("\"axes\": [\n      [", "\"axes\": [\n      [0.5, ", "body.axes"),
    ] {
        let found = line(from, to);
        assert!(found.starts_with(expected), "{found}");
    }
    let mut tilted = scene.clone();
    tilted.placement.as_mut().unwrap().axes[0][0] += 0.1;
    let line = tilted.validate().unwrap_err().to_string();
    assert!(line.starts_with("body.axes is off by "), "{line}");
    assert_eq!(scene::COVER_MM, (6.0, 30.0));
}

/// The scene of a body with its surface, and the text of the surface in its file.
fn kept() -> (Surface, Scene, String) {
    let (_, _, mut scene) = subject(Side::Left);
    let surface = torso::torso(PROJECTION, 228, 228);
    scene.keep_surface(&surface).unwrap();
    let json = serde_json::to_string(&scene).unwrap();
    (surface, scene, json)
}

#[test]
fn a_file_keeps_a_reduced_surface_that_nothing_else_takes() {
    let (surface, scene, json) = kept();
    let found = scene.placement.as_ref().unwrap().surface.clone().unwrap();
    let text = serde_json::to_string(&found).unwrap();
    println!("{} bytes, {} vertices", text.len(), found.surface().positions.len());
    assert!(text.len() <= 300_000);
    // Reading and writing again changes no bit.
    let again = Scene::from_json(&json).unwrap();
    assert!(again == scene && serde_json::to_string(&again).unwrap() == json);
    // Within 0.05 mm of the reduced surface, which is within 1 mm root mean square of the body.
    let exact = reduced(&surface, 12_000, 24_000);
    let pairs = found.surface().positions.iter().zip(&exact.positions);
    let apart = pairs.map(|(a, b)| (*a - *b).abs().max_element()).fold(0.0, f64::max);
    assert!(apart <= 0.05 && found.surface().triangles == exact.triangles, "{apart}");
    let off = surface.positions.iter().step_by(97);
    let off = off.map(|p| snap(found.surface(), *p).unwrap().point.distance_squared(*p));
    let off: Vec<f64> = off.collect();
    let rms = (off.iter().sum::<f64>() / off.len() as f64).sqrt();
    println!("{rms:.3} mm root mean square, quantised by {apart:.4} mm");
    assert!(rms < 1.0, "{rms}");
    // A copy has the same surface, a link and a store have none, and no equilibrium depends on it.
    let copy = scene.clone().placement.unwrap().surface.unwrap();
    assert!(std::ptr::eq(copy.surface().as_ref(), found.surface().as_ref()));
    assert!(!serde_json::to_string(&scene.without_visit()).unwrap().contains("triangles"));
    assert!(scene.same_physics(&scene.without_visit()));
    // A small surface keeps its vertices.
    let small = torso::torso(PROJECTION, 60, 40);
    let own = KeptSurface::of(&small).unwrap();
    assert_eq!(own.surface().triangles, small.triangles);
    assert_eq!(KeptSurface::of(&Surface::default()), None);
}

#[test]
fn a_damaged_kept_surface_is_one_line() {
    let (_, scene, _) = kept();
    let value = serde_json::to_value(&scene).unwrap();
    let line = |member: &str, with: serde_json::Value| {
        let mut value = value.clone();
        value["body"]["surface"][member] = with;
        let line = Scene::from_json(&value.to_string()).unwrap_err().to_string();
        assert!(!line.contains('\n') && line.len() < 300, "{line}");
        line
    };
    for (member, with, expected) in [
        ("step_mm", serde_json::json!(2), "step_mm is 2; allowed: 0.000001 to 1 mm"),
        ("step_mm", serde_json::json!(0), "step_mm is 0; allowed"),
        (
            "least_mm",
            serde_json::json!([0, 2e7, 0]),
            "least_mm has 2e7; allowed: up to 10000000 mm",
        ),
        (
            "vertices",
            "AAA".into(),
            "vertices: Invalid padding; allowed: base64 of 6 bytes each, 3 to 12000",
        ),
        ("vertices", "A!AA".into(), "vertices: Invalid symbol 33, offset 1"),
        ("vertices", "AAAA".into(), "vertices has 3 bytes"),
        ("vertices", "AAAAAAAA".into(), "vertices has 6 bytes"),
        (
            "triangles",
            "".into(),
            "triangles has 0 bytes; allowed: base64 of 6 bytes each, 1 to 24000",
        ),
        ("triangles", "AAAAAAD/".into(), "triangles: triangle 0 has vertex 65280; allowed: 0 to "),
        ("triangles", "A".repeat(200_000).into(), "triangles has 200000 characters"),
        ("colors", 1.into(), "unknown field `colors`"),
    ] {
        let found = line(member, with);
        assert!(found.starts_with("body.surface") && found.contains(expected), "{found}");
    }
    assert!(line("triangles", serde_json::Value::Null).starts_with("body.surface"));
    // Random bytes in place of the text end in a surface within its numbers or in one line.
    let mut random = fastrand::Rng::with_seed(9);
    let text = value["body"]["surface"]["triangles"].as_str().unwrap();
    for _ in 0..20 {
        let mut bytes = text.as_bytes().to_vec();
        for _ in 0..random.usize(1..4) {
            let at = random.usize(0..bytes.len());
            bytes[at] = random.u8(32..127);
        }
        bytes.truncate(random.usize(bytes.len() / 2..=bytes.len()));
        let mut value = value.clone();
        value["body"]["surface"]["triangles"] = String::from_utf8(bytes).unwrap().into();
        match Scene::from_json(&value.to_string()) {
            Ok(scene) => {
                let found = scene.placement.unwrap().surface.unwrap();
                let count = found.surface().positions.len();
                assert!(found.surface().triangles.iter().flatten().all(|k| (*k as usize) < count));
            }
            Err(error) => assert!(!error.to_string().contains('\n')),
        }
    }
}

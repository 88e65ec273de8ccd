//! From a body's surface over its scene to the surface over the implant.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

#[path = "../../body/tests/common/torso.rs"]
mod torso;

use glam::DVec3;
use implant_preview_core::body::deform::{deform, gained_ml};
use implant_preview_core::body::fit::{BodyFit, Settings, fit};
use implant_preview_core::body::marks::Side;
use implant_preview_core::body::read::Unit;
use implant_preview_core::body::surface::Surface;
use implant_preview_core::mesh::CELL_TRIANGLES;
use implant_preview_core::scene::{self, CheckedScene, Scene};
use implant_preview_core::simulate::{self, Simulation};
use implant_preview_core::solve::Options;

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

        // The skin gains what the inner face gains: the tissue keeps its volume.
        let sheet = solution.problem().sheet();
        let n = sheet.nodes_per_side();
        let mut inner =
            Surface { positions: solution.problem().rest.nodes(0).collect(), ..Surface::default() };
        for (j, i) in (0..n - 1).flat_map(|j| (0..n - 1).map(move |i| (j, i))) {
            let corners = sheet.corners(i, j);
            inner.triangles.extend([1, 3].map(|k| CELL_TRIANGLES[k].map(|c| corners[c] as u32)));
        }
        let lifted = Surface { positions: solution.inner().to_vec(), ..inner.clone() };
        let (skin, inside) = (gained_ml(&surface, &deformed), gained_ml(&inner, &lifted));
        let grid = fitted.grid;
        let within = (0..grid.len()).filter(|node| grid.place(*node).length() <= 110.0);
        let depth = within.map(|node| fitted.skin_mm[node] - fitted.wall_mm[node]).sum::<f64>();
        let tissue = depth * grid.spacing_mm.powi(2) / 1e3;
        println!(
            "{side:?}: skin gains {skin:.1} ml, inner face {inside:.1} ml, tissue {tissue:.0} ml"
        );
        assert!((skin - inside).abs() < 0.01 * tissue, "{skin} {inside} {tissue}");
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

//! Random bodies: the built-in torso shaped by random tapes, fitted with marks that are off, over random implants.
//!
//! All 300: `cargo test --release -p implant-preview-core --test random_bodies -- --ignored --nocapture`.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test stops where something is missing"
)]

mod common;

use common::turned_over;
use glam::DVec3;
use implant_preview_core::body::deform::deform;
use implant_preview_core::body::fit::{Settings, fit};
use implant_preview_core::body::marks::{Marks, Side};
use implant_preview_core::body::pick::snap;
use implant_preview_core::body::read::Unit;
use implant_preview_core::body::surface::Surface;
use implant_preview_core::body::torso::{Tape, Torso, shaped};
use implant_preview_core::scene::{CheckedScene, Implant, Plane, Scene};
use implant_preview_core::simulate::{self, Simulation};
use implant_preview_core::solve::{Options, Verdict};
use std::f64::consts::{FRAC_PI_3, TAU};

/// Distance of a mark from its place \[mm\].
const OFF_MM: f64 = 8.0;

/// A random body, its marks, a side and a cover \[mm\]: tape, marks and cover within their ranges.
fn body(random: &mut fastrand::Rng) -> (Torso, Side, f64) {
    let mut between = |least: f64, most: f64| least + (most - least) * random.f64();
    let tape = Tape {
        chest_width_mm: between(235.0, 300.0),
        breast_width_mm: between(120.0, 145.0),
        notch_nipple_mm: between(190.0, 235.0),
        nipple_fold_mm: None,
        nipple_nipple_mm: between(195.0, 235.0),
        breast_volume_ml: between(150.0, 450.0),
    };
    let cover_mm = between(6.0, 17.0);
    let side = if between(0.0, 1.0) < 0.5 { Side::Left } else { Side::Right };
    let (mut torso, _) = shaped(&tape).unwrap();
    let mut off = |p: DVec3| {
        let angle = between(0.0, TAU);
        let moved = p + DVec3::new(angle.cos(), angle.sin(), 0.0) * OFF_MM;
        snap(&torso.surface, moved).unwrap().point
    };
    let mut breast = torso.marks.breasts[side as usize].unwrap();
    for mark in [&mut breast.fold, &mut breast.upper, &mut breast.medial, &mut breast.lateral] {
        *mark = off(*mark);
    }
    torso.marks.breasts[side as usize] = Some(breast);
    (torso, side, cover_mm)
}

/// A random implant of 150 to 450 ml, one in two anatomical.
fn implant(random: &mut fastrand::Rng) -> Implant {
    let mut between = |least: f64, most: f64| least + (most - least) * random.f64();
    let volume_ml = between(150.0, 450.0);
    let base_radius_mm = 50.0 + 15.0 * (volume_ml - 150.0) / 300.0 + between(-2.0, 3.0);
    let is_anatomical = between(0.0, 1.0) < 0.5;
    let high = if is_anatomical { between(0.85, 1.0) } else { 1.0 };
    Implant {
        base_radius_mm,
        base_height_mm: is_anatomical.then_some(2.0 * high * base_radius_mm),
        apex_shift_mm: if is_anatomical { between(0.1, 0.3) * high * base_radius_mm } else { 0.0 },
        // ⅔ π a b p.
        projection_mm: volume_ml * 1e3 / (2.0 * FRAC_PI_3 * high * base_radius_mm.powi(2)),
        ..Implant::default()
    }
}

/// What became of some random bodies.
#[derive(Debug, Default)]
struct Count {
    refused: Vec<String>,
    converged: usize,
    by_multigrid: usize,
    turned_triangles: usize,
    bodies_with_turned: usize,
    work_units: Vec<f64>,
}

/// The scene of a body, or why there is none.
fn scene(
    Torso { surface, marks }: &Torso,
    (side, cover_mm): (Side, f64),
    implant: Implant,
) -> Result<Scene, String> {
    let settings = Settings { cover_mm, ..Settings::default() };
    let fitted = fit(surface, marks, side, &settings).map_err(|error| error.to_string())?;
    let mut scene = Scene::of_body(&fitted, (marks, side), cover_mm, Unit::Mm)
        .map_err(|error| error.to_string())?;
    scene.implant = implant;
    scene.pocket_radius_mm = scene.pocket_radius_mm.max(implant.base_radius_mm + 5.0);
    let mut below = scene.clone();
    below.set_plane(Some(Plane::Below));
    below.validate().map_err(|error| error.to_string())?;
    Ok(scene)
}

fn run(count: usize, nodes_per_side: usize, seed: u64) -> Count {
    let mut random = fastrand::Rng::with_seed(seed);
    let mut found = Count::default();
    for index in 0..count {
        let ((torso, side, cover_mm), implant) = (body(&mut random), implant(&mut random));
        let scene = scene(&torso, (side, cover_mm), implant).and_then(|mut scene| {
            scene.solver.nodes_per_side = nodes_per_side;
            let frame = scene.placement.as_ref().map(|placement| placement.frame());
            let checked = CheckedScene::new(scene).map_err(|error| error.to_string())?;
            Ok((checked, frame.unwrap()))
        });
        let (scene, frame) = match scene {
            Ok(found) => found,
            Err(line) => {
                println!("{index}: {line}");
                found.refused.push(line);
                continue;
            }
        };
        let Simulation { solution, .. } = simulate::run(&scene, Options::default(), None);
        let report = solution.report();
        let is_converged = report.verdict == Verdict::Converged;
        found.converged += usize::from(is_converged);
        found.by_multigrid += usize::from(is_converged && !report.fell_back);
        found.work_units.push(report.work_units);
        let turned = turned_over(&torso.surface, &deform(&torso.surface, &frame, &solution));
        found.turned_triangles += turned;
        found.bodies_with_turned += usize::from(turned > 0);
        if !is_converged || report.fell_back || turned > 0 {
            println!(
                "{index}: {:?}, fell back: {}, {turned} triangles turned over, {cover_mm:.1} mm, {implant:?}",
                report.verdict, report.fell_back
            );
        }
    }
    found.work_units.sort_by(f64::total_cmp);
    found
}

/// Work units of the opening plan.
fn opening(nodes_per_side: usize) -> f64 {
    let mut scene = Scene::opening();
    scene.solver.nodes_per_side = nodes_per_side;
    let scene = CheckedScene::new(scene).unwrap();
    simulate::run(&scene, Options::default(), None).solution.report().work_units
}

#[test]
fn random_bodies_converge_and_turn_no_triangle_over() {
    let found = run(12, 33, 7);
    assert!(found.refused.is_empty(), "{:?}", found.refused);
    assert_eq!((found.converged, found.turned_triangles), (12, 0), "{found:?}");
}

#[test]
#[ignore = "some minutes"]
fn three_hundred_random_bodies() {
    let found = run(300, 65, 44);
    let median = found.work_units[found.work_units.len() / 2];
    let of = |share: f64| found.work_units[(share * (found.work_units.len() - 1) as f64) as usize];
    println!(
        "refused {}, converged {}, by multigrid {}, work units: median {median:.0}, 95 % {:.0}, most {:.0}; opening plan {:.0}; {} triangles turned over on {} bodies",
        found.refused.len(),
        found.converged,
        found.by_multigrid,
        of(0.95),
        of(1.0),
        opening(65),
        found.turned_triangles,
        found.bodies_with_turned
    );
    assert!(found.refused.is_empty() && found.converged >= 299);
    assert_eq!(found.turned_triangles, 0, "{} bodies", found.bodies_with_turned);
}

/// Any rigid motion of file and marks gives the same scene.
#[test]
fn a_rigid_motion_gives_the_same_scene() {
    let mut random = fastrand::Rng::with_seed(3);
    let (torso, side, cover_mm) = body(&mut random);
    let still = scene(&torso, (side, cover_mm), Implant { ..Scene::opening().implant }).unwrap();
    let turn = glam::DMat3::from_euler(glam::EulerRot::XYZ, 2.1, -0.7, 1.3);
    let moved = |p: DVec3| turn * p + DVec3::new(900.0, -350.0, 120.0);
    let Torso { surface, marks } = torso;
    let positions = surface.positions.iter().map(|p| moved(*p)).collect();
    let marks: Marks = marks.mapped(moved);
    let torso = Torso { surface: Surface { positions, ..surface }, marks };
    let mut found = scene(&torso, (side, cover_mm), still.implant).unwrap();
    let heights = |scene: &Scene| scene.chest_grid.as_ref().unwrap().grid.heights_mm.clone();
    // Heights are rounded to 0.1 µm: a value on the boundary may differ by one.
    let (turned, own) = (heights(&found), heights(&still));
    let apart = turned.iter().zip(own.iter()).map(|(a, b)| (a.unwrap() - b.unwrap()).abs());
    assert!(apart.fold(0.0, f64::max) < 1.01e-4);
    let frame = found.placement.as_ref().unwrap().frame();
    let origin = still.placement.as_ref().unwrap().frame().origin;
    assert!(frame.origin.distance(moved(origin)) < 1e-9);
    (found.placement, found.chest_grid) = (still.placement.clone(), still.chest_grid.clone());
    let factors = |scene: &Scene| scene.thickness_field.as_ref().unwrap().factors.clone();
    let (turned, own) = (factors(&found), factors(&still));
    let apart = turned.iter().zip(own.iter()).map(|(a, b)| (a - b).abs());
    assert!(apart.fold(0.0, f64::max) < 1.01e-5);
    found.thickness_field = still.thickness_field.clone();
    assert_eq!(found, still);
}

//! The suction that holds a void of the pocket at its greatest volume.
#![allow(clippy::unwrap_used)] // helpers of tests are tests

mod common;

use common::scene;
use glam::DVec3;
use implant_preview_core::measure::{Outcome, Status};
use implant_preview_core::scene::{ChestShape, Scene};
use implant_preview_core::simulate::simulate;
use implant_preview_core::solve::{Method, Options, Problem, Solver, Verdict};
use implant_preview_lab::axisymmetric_layers::{Input, solve};
use implant_preview_lab::robustness::clinical::Clinical;
use serde_json::{Value, json};

fn solved(scene: &Scene) -> Outcome {
    let found = simulate(scene).unwrap();
    assert_eq!(found.status, Status::Converged);
    found
}

#[test]
fn the_void_is_as_large_as_it_may_be_and_the_skin_gains_that_much_less() {
    let round =
        |radius: f64| json!({ "radius_across_mm": radius, "radius_along_mm": 2.0 * radius });
    let implant = |member: (&str, Value)| {
        let mut implant = json!({ "base_radius_mm": 55.0, "projection_mm": 30.0 });
        implant[member.0] = member.1;
        implant
    };
    for (members, most_ml) in [
        (json!({}), 12.0),
        (json!({ "chest": round(140.0) }), 5.0),
        (json!({ "implant": implant(("center_mm", json!([5.0, 3.0]))) }), 15.0),
        (json!({ "implant": implant(("fill", json!("soft"))) }), 10.0),
        (json!({ "implant": implant(("apex_shift_mm", json!(9.0))), "chest": round(160.0) }), 8.0),
        (json!({ "insertion": 0.7 }), 4.0),
        (json!({ "skin_state": { "natural_tension_n_per_m": 20.0, "grown": 0.3 } }), 12.0),
    ] {
        let free = scene(&members);
        let mut limited = free.clone();
        limited.body.pocket_void_ml = Some(most_ml);
        let [free, limited] = [free, limited].map(|scene| {
            let mut solver = Solver::new(scene.problem().unwrap());
            solver.advance(&mut || false);
            assert_eq!(solver.verdict(), Verdict::Converged, "{members}");
            solver.into_solution()
        });
        let of_void = limited.void_mm3().unwrap() / 1000.0;
        assert!((of_void / most_ml - 1.0).abs() < 0.01, "{members}: {of_void}");
        assert!(limited.problem().suction_kpa() > 0.0);
        let problem = limited.problem();
        let gained = |x: &[DVec3]| {
            let rest: Vec<DVec3> = problem.rest.nodes(problem.rest.layers() - 1).collect();
            (under(problem, x, 0.0) - under(problem, &rest, 0.0)) / 1000.0
        };
        // What is lifted beyond the pocket is no void.
        let lifted = |x: &[DVec3]| {
            let wall = &problem.obstacle.wall.0;
            let x: Vec<DVec3> = x.iter().map(|x| wall.flattened(*x)).collect();
            under(problem, &x, problem.patch.pocket_radius_mm) / 1000.0
        };
        let filled = problem.obstacle.dome.volume_over_wall() / 1000.0 + most_ml;
        let expected = filled + lifted(limited.inner());
        let skin = gained(limited.membrane());
        assert!((skin / expected - 1.0).abs() < 0.01, "{members}: {skin} of {expected}");
        assert!(skin < gained(free.membrane()) - 2.0, "{members}");
    }
}

/// Volume between a layer of nodes and the plane [mm³], by the triangles of the sheet whose middle at rest is farther out than `beyond`.
fn under(problem: &Problem, x: &[DVec3], beyond: f64) -> f64 {
    let sheet = problem.sheet();
    let of = |(nodes, weight): ([usize; 3], f64)| {
        let [a, b, c] = nodes.map(|k| x[k]);
        let area = 0.5 * (b - a).truncate().perp_dot((c - a).truncate());
        let [p, q, r] = nodes.map(|k| sheet.rest()[k]);
        let is_counted = (p + q + r).length() > 3.0 * beyond;
        if is_counted { weight * area * (a.z + b.z + c.z) / 3.0 } else { 0.0 }
    };
    sheet.triangles().map(of).sum()
}

#[test]
fn a_limited_void_is_that_of_elements() {
    for (radius_mm, most_ml) in
        [(None, 15.0), (None, 10.0), (Some(200.0), 10.0), (Some(200.0), 5.0)]
    {
        let mut scene = scene(&json!({ "pocket_void_ml": most_ml }));
        scene.solver.nodes_per_side = 129;
        if let Some(radius) = radius_mm {
            scene.chest =
                Some(ChestShape { radius_across_mm: radius, radius_along_mm: Some(radius) });
        }
        let input = Input::of(&scene, &scene.problem().unwrap(), [216, 12]).unwrap();
        let (expected, found) = (solve(&input).unwrap(), solved(&scene));
        let off = |point: &implant_preview_core::measure::ProfilePoint| {
            let (_, [r, z]) = expected.point(point.s_mm);
            (point.r_mm - r).hypot(point.z_mm - z) / 60.0
        };
        let skin = found.profile_skin.iter().map(off).fold(0.0, f64::max);
        let force = found.contact_force_n.unwrap() / expected.contact_force_n - 1.0;
        let suction = found.suction_kpa.unwrap() / expected.suction_kpa - 1.0;
        let all = format!("{radius_mm:?} {most_ml}: {skin} {force} {suction}");
        assert!(skin < 0.002 && force.abs() < 0.02 && suction.abs() < 0.035, "{all}");
    }
}

#[test]
fn a_void_that_is_smaller_by_itself_and_no_limit_are_the_same() {
    let [free, slack] =
        [json!({}), json!({ "pocket_void_ml": 100.0 })].map(|members| solved(&scene(&members)));
    assert!(free.suction_kpa.is_none() && slack.suction_kpa.is_some_and(|kpa| kpa.abs() < 1e-12));
    assert_eq!(Outcome { suction_kpa: None, ..slack }, free);
}

#[test]
fn newtons_method_finds_the_same_suction() {
    let mut scene = scene(&json!({ "pocket_void_ml": 12.0 }));
    scene.solver.nodes_per_side = 33;
    let suctions = [Method::Automatic, Method::Newton].map(|method| {
        let options = Options { method, ..Options::default() };
        let mut solver = Solver::with_options(scene.problem().unwrap(), options);
        solver.advance(&mut || false);
        assert_eq!(solver.verdict(), Verdict::Converged);
        let solution = solver.into_solution();
        assert!((solution.void_mm3().unwrap() / 12_000.0 - 1.0).abs() < 0.01);
        solution.problem().suction_kpa()
    });
    assert!((suctions[0] / suctions[1] - 1.0).abs() < 0.01, "{suctions:?}");
}

#[test]
fn a_whole_patch_has_the_suction_of_its_quarter() {
    let suctions = [0.0, 0.02].map(|shift| {
        let implant =
            json!({ "base_radius_mm": 60.0, "projection_mm": 29.842, "center_mm": [shift, shift] });
        solved(&scene(&json!({ "implant": implant, "pocket_void_ml": 10.0 }))).suction_kpa.unwrap()
    });
    assert!((suctions[0] / suctions[1] - 1.0).abs() < 0.01, "{suctions:?}");
}

/// Random patients, the void limited to a random part of the free one.
#[test]
fn random_patients_converge_and_a_void_that_stays_larger_is_told() {
    let base = Clinical::default();
    let populations = [
        base,
        Clinical { has_chest: true, ..base },
        Clinical { has_terrain: true, ..base },
        Clinical { has_fill: true, has_chest: true, ..base },
        Clinical { has_tension: true, ..base },
        Clinical { has_plane: true, has_chest: true, ..base },
    ];
    let mut told = 0;
    for (number, population) in (0..).zip(populations) {
        for case in 0..10 {
            let mut scene = population.scene(7, case);
            scene.solver.nodes_per_side = 33;
            let free = solved(&scene).void_ml.unwrap();
            let share = ((case * 7 + 3 * number) % 10) as f64 / 10.0;
            let most_ml = (share * share * free).clamp(0.0, 200.0);
            scene.body.pocket_void_ml = Some(most_ml);
            let found = solved(&scene);
            let of_void = found.void_ml.unwrap();
            let is_larger = of_void > 1.01 * most_ml + 0.05;
            let is_told = found.warnings.iter().any(|warning| warning.starts_with("The void of"));
            assert_eq!(is_larger, is_told, "{number} {case}: {of_void} of {most_ml}");
            told += u32::from(is_told);
        }
    }
    // Most of them since the grid does not resolve a corner of that volume.
    assert!(told < 30, "{told}");
}

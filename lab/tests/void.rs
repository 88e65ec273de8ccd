//! The void of the pocket against closed forms, against axisymmetric elements and against the volume that the skin encloses.
#![allow(clippy::unwrap_used)] // helpers of tests are tests

mod common;

use common::scene;
use glam::{DVec2, DVec3};
use implant_preview_core::measure::Outcome;
use implant_preview_core::simulate::simulate;
use implant_preview_core::solve::{Problem, Solution, Solver};
use implant_preview_lab::axisymmetric_layers::{Input, solve};
use serde_json::json;
use std::f64::consts::PI;

fn void_ml(outcome: &Outcome) -> f64 {
    outcome.void_ml.unwrap()
}

/// The problem's solution with another inner face over the pocket: a height over the wall and a way outwards by the distance over the
/// pocket's radius.
fn shaped(problem: Problem, height_mm: f64, way_mm: f64) -> Solution {
    let mut record = Solver::new(problem.clone()).into_solution().record();
    let radius = problem.patch.pocket_radius_mm;
    let wall = problem.obstacle.wall.0.clone();
    for (x, place) in record.inner.iter_mut().zip(problem.sheet().rest()) {
        let share = place.length() / radius;
        if share < 1.0 {
            let bump = 1.0 - share * share;
            let to = *place * (1.0 + way_mm * bump / radius);
            *x = to.extend(wall.height(to) + height_mm * bump).to_array();
        }
    }
    record.mirrored = [false; 2];
    Solution::restore(problem, record).unwrap()
}

#[test]
fn the_void_under_a_paraboloid_is_its_volume_less_the_implants() {
    // On a flat wall: ∫ h 2πr dr with r = ϱ(1 + c(1 − ϱ²)), h = H(1 − ϱ²), ϱ in pocket radii: half of πa²H, and a part of c.
    let (radius, height) = (70.0, 45.0);
    for (members, way) in [
        (json!({}), 0.0),
        (json!({}), 9.0),
        (json!({ "insertion": 0.6 }), 0.0),
        (
            json!({ "implant": { "base_radius_mm": 50.0, "projection_mm": 30.0, "center_mm": [12.0, -7.0] } }),
            5.0,
        ),
    ] {
        let mut scene = scene(&members);
        scene.solver.nodes_per_side = 129;
        let problem = scene.problem().unwrap();
        let implant = problem.obstacle.dome.volume_over_wall();
        // ∫ H(1 − r²)·½ d(r²(1 + c(1 − r²))²), by t = r².
        let c = way / radius;
        let steps = 2000;
        let square = |t: f64| t * (1.0 + c * (1.0 - t)).powi(2);
        let volume: f64 = (0..steps)
            .map(|k| {
                let [a, b] = [k, k + 1].map(|k| f64::from(k) / f64::from(steps));
                height * (1.0 - 0.5 * (a + b)) * (square(b) - square(a))
            })
            .sum::<f64>()
            * PI
            * radius
            * radius;
        let found = shaped(problem, height, way).void_mm3().unwrap();
        let error = found / (volume - implant) - 1.0;
        assert!(error.abs() < 2e-3, "{members} {way}: {error}");
    }
}

#[test]
fn the_void_of_solutions_is_that_of_elements() {
    for (members, nodes, most_ml) in [
        (json!({}), 65, 0.3),
        (json!({}), 129, 0.15),
        (json!({ "chest": { "radius_across_mm": 200.0, "radius_along_mm": 200.0 } }), 129, 0.15),
        (
            json!({ "implant": { "base_radius_mm": 50.0, "projection_mm": 35.0, "fullness": 0.75 } }),
            129,
            0.25,
        ),
        (json!({ "insertion": 0.7 }), 129, 0.15),
    ] {
        let mut scene = scene(&members);
        scene.solver.nodes_per_side = nodes;
        let problem = scene.problem().unwrap();
        let input = Input::of(&scene, &problem, [144, 8]).unwrap();
        let expected = solve(&input).unwrap().void_mm3 / 1000.0;
        let found = void_ml(&simulate(&scene).unwrap());
        assert!((found - expected).abs() < most_ml, "{members} {nodes}: {found} of {expected}");
    }
}

/// Volume between a layer of nodes and the plane [mm³], by the triangles of the sheet whose middle at rest is farther out than `beyond`.
fn under(problem: &Problem, x: &[DVec3], beyond: f64) -> f64 {
    let sheet = problem.sheet();
    let of = |(nodes, weight): ([usize; 3], f64)| {
        let [a, b, c] = nodes.map(|k| x[k]);
        let area = 0.5 * (b - a).truncate().perp_dot((c - a).truncate());
        let middle = nodes.map(|k| sheet.rest()[k]).iter().sum::<DVec2>() / 3.0;
        let is_counted = middle.length() > beyond;
        if is_counted { weight * area * (a.z + b.z + c.z) / 3.0 } else { 0.0 }
    };
    sheet.triangles().map(of).sum()
}

/// The attachment stretches: the tissue beyond the pocket's edge is lifted, too, by some 3 % of the implant's volume.
#[test]
fn the_skin_gains_implant_void_and_what_is_lifted_beyond_the_pocket() {
    for members in [
        json!({}),
        json!({ "chest": { "radius_across_mm": 130.0, "radius_along_mm": 260.0 } }),
        json!({ "implant": { "base_radius_mm": 50.0, "projection_mm": 40.0, "center_mm": [9.0, 4.0] } }),
        json!({ "implant": { "base_radius_mm": 60.0, "projection_mm": 29.842, "fill": "soft" } }),
        json!({ "insertion": 0.6 }),
    ] {
        let mut solver = Solver::new(scene(&members).problem().unwrap());
        solver.advance(&mut || false);
        let solution = solver.into_solution();
        let problem = solution.problem();
        let rest: Vec<DVec3> = problem.rest.nodes(problem.rest.layers() - 1).collect();
        let skin = under(problem, solution.membrane(), 0.0) - under(problem, &rest, 0.0);
        let wall = &problem.obstacle.wall.0;
        let inner: Vec<DVec3> = solution.inner().iter().map(|x| wall.flattened(*x)).collect();
        let lifted = under(problem, &inner, problem.patch.pocket_radius_mm);
        let filled = problem.obstacle.dome.volume_over_wall() + solution.void_mm3().unwrap();
        assert!(
            (skin / (filled + lifted) - 1.0).abs() < 0.005,
            "{members}: {skin} {filled} {lifted}"
        );
        assert!(lifted > 0.0 && lifted < 0.05 * filled, "{members}: {lifted} {filled}");
    }
}

#[test]
fn the_void_does_not_depend_on_the_part_that_is_solved() {
    let found = [0.0, 0.02].map(|shift| {
        let implant =
            json!({ "base_radius_mm": 60.0, "projection_mm": 29.842, "center_mm": [shift, shift] });
        void_ml(&simulate(&scene(&json!({ "implant": implant }))).unwrap())
    });
    assert!((found[0] - found[1]).abs() < 0.05, "{found:?}");
}

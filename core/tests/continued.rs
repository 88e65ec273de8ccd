//! Solves that continue from the solution of another scene, against solves from nothing.
#![allow(clippy::unwrap_used)] // helpers of tests are tests

use implant_preview_core::scene::{Fill, Scene};
use implant_preview_core::solve::{Options, Progress, Solver, Verdict};

type Change = fn(&mut Scene, f64);

/// The values that are dragged, at a place from 0 to 1 of the drag.
const DRAGS: [(&str, Change); 5] = [
    ("insertion", |scene, at| scene.insertion = 0.7 + 0.3 * at),
    ("radius", |scene, at| scene.implant.base_radius_mm = 54.0 + 8.0 * at),
    ("volume", |scene, at| scene.implant.projection_mm = 24.0 + 10.0 * at),
    ("position", |scene, at| scene.implant.center_mm = [0.1 + 4.0 * at, -0.1 - 3.0 * at]),
    ("pinch", |scene, at| scene.layers[1].thickness_mm = 8.0 + 3.0 * at),
];

fn base(nodes: usize, chest: bool) -> Scene {
    let mut scene = Scene::opening();
    (scene.solver.nodes_per_side, scene.solver.tolerance) = (nodes, 1e-3);
    scene.chest = scene.chest.filter(|_| chest);
    scene
}

fn solved(mut solver: Solver) -> Solver {
    while solver.advance(&mut || false) == Progress::Working {}
    assert_eq!(solver.verdict(), Verdict::Converged);
    solver
}

fn cold(scene: &Scene) -> Solver {
    solved(Solver::with_options(scene.problem().unwrap(), Options::default()))
}

/// The solution of a scene after another one, and whether it was continued.
fn after(mut solver: Solver, scene: &Scene) -> (Solver, bool) {
    let is_continued = solver.continue_with(scene.problem().unwrap());
    (solved(solver), is_continued)
}

/// Greatest distance of a node of any layer \[base radius\].
fn apart(a: &Solver, b: &Solver) -> f64 {
    let of = |solver: &Solver| [&[solver.positions().to_vec()][..], solver.outer()].concat();
    let pairs = of(a).concat().into_iter().zip(of(b).concat());
    let most = pairs.map(|(a, b)| a.distance(b)).fold(0.0, f64::max);
    most / a.problem().obstacle.dome.reference_length()
}

/// Work of the edits of a drag, one a frame, continued and from nothing.
#[test]
fn drags_take_two_thirds_of_the_work_of_solves_from_nothing() {
    for chest in [true, false] {
        let (scene, mut all) = (base(65, chest), [0.0; 2]);
        for (name, change) in DRAGS {
            let mut work = [0.0; 2];
            let of = |edit: u32| {
                let mut scene = scene.clone();
                change(&mut scene, f64::from(edit) / 24.0);
                scene
            };
            let mut solver = cold(&of(0));
            for edit in 1..=8 {
                let scene = of(edit);
                solver = after(solver, &scene).0;
                let other = cold(&scene);
                work[0] += solver.work_units();
                work[1] += other.work_units();
                let distance = apart(&solver, &other);
                assert!(distance <= scene.solver.tolerance, "{name} {edit}: {distance:.1e}");
                let [own, new] = [&solver, &other].map(Solver::estimated_discretisation_error);
                assert_eq!(own.is_some(), new.is_some(), "{name} {edit}");
                if let Some((own, new)) = own.zip(new) {
                    assert!((0.5..2.0).contains(&(own / new)), "{name} {edit}: {own} {new}");
                }
            }
            let ratio = work[0] / work[1];
            assert!(ratio < 0.75, "{name}, chest {chest}: {ratio:.2}");
            all = [0, 1].map(|k| all[k] + work[k]);
        }
        let ratio = all[0] / all[1];
        assert!(ratio < 0.67, "chest {chest}: {ratio:.2}");
    }
}

/// The numbers of the deformation of an implant that yields.
fn modes(solver: &Solver) -> [f64; 8] {
    solver.problem().obstacle.dome.shape.soft().unwrap().modes()
}

/// Implants that yield continue from their last deformation, over half and whole patches too.
#[test]
fn drags_of_implants_that_yield_take_two_thirds_of_the_work_of_solves_from_nothing() {
    for fill in [Fill::Cohesive, Fill::Soft, Fill::Saline] {
        let mut work = [0.0; 2];
        for (name, change) in DRAGS {
            let of = |edit: u32| {
                let mut scene = base(33, true);
                scene.implant.fill = Some(fill);
                change(&mut scene, f64::from(edit) / 24.0);
                scene
            };
            let mut solver = cold(&of(0));
            for edit in 1..=5 {
                let scene = of(edit);
                let is_continued;
                (solver, is_continued) = after(solver, &scene);
                let other = cold(&scene);
                assert!(is_continued, "{fill:?}, {name} {edit}");
                work[0] += solver.work_units();
                work[1] += other.work_units();
                let distance = apart(&solver, &other);
                let most = scene.solver.tolerance;
                assert!(distance <= most, "{fill:?}, {name} {edit}: {distance:.1e}");
                for (own, new) in modes(&solver).into_iter().zip(modes(&other)) {
                    assert!((own - new).abs() < 2.0 * most, "{fill:?}, {name} {edit}: {own} {new}");
                }
            }
        }
        let ratio = work[0] / work[1];
        println!("{fill:?}: {ratio:.2}");
        assert!(ratio < 0.67, "{fill:?}: {ratio:.2}");
    }
}

/// A walk of edits of one value each, small as those of a drag or as large as those of a typed number.
#[test]
fn a_hundred_random_edits_have_the_shapes_of_solves_from_nothing() {
    let mut random = fastrand::Rng::with_seed(5);
    let (mut places, mut count) = ([0.5; 5], 0);
    let mut solver = cold(&base(33, true));
    for edit in 0..100 {
        let value = random.usize(0..5);
        let step = if random.u8(0..4) == 0 { 0.6 } else { 0.1 };
        let place: f64 = places[value] + step * (2.0 * random.f64() - 1.0);
        places[value] = place.clamp(0.0, 1.0);
        let mut scene = base(33, true);
        for ((_, change), at) in DRAGS.iter().zip(places) {
            change(&mut scene, at);
        }
        let is_continued;
        (solver, is_continued) = after(solver, &scene);
        count += usize::from(is_continued);
        let distance = apart(&solver, &cold(&scene));
        assert!(distance <= scene.solver.tolerance, "{edit}: {distance:.1e}");
    }
    assert!(count > 60, "{count}");
}

/// A shape that is far away costs one cycle of the finest grid and no more.
#[test]
fn a_solve_that_begins_too_far_away_starts_from_nothing() {
    let scene = base(33, true);
    let of = |insertion: f64| Scene { insertion, ..scene.clone() };
    let (solver, is_continued) = after(cold(&of(1.0)), &of(0.5));
    let other = cold(&of(0.5));
    assert!(!is_continued && apart(&solver, &other) < 1e-12);
    // Another law, and other symmetry, too.
    let mut softer = scene.clone();
    softer.layers[1].poisson_ratio = 0.45;
    let mut aside = scene.clone();
    aside.implant.center_mm = [1.0, 0.0];
    for other in [softer, aside] {
        assert!(!after(cold(&scene), &other).1);
    }
}

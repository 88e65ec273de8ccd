//! Implants that yield, against rigid ones, against Newton's method and against the work of the tissue.

use super::*;
use crate::contact::{Deformed, Dome, HalfBall, MODES, Obstacle};
use crate::curve::{Curve, CurveSpec, Fat, ScaledCurve};
use crate::mesh::{Attachment, Chest, Edge, NaturalStretch, Patch, Rest, Sheet};
use crate::solve::Verdict;
use crate::solve::{Method, Options, Problem, Progress, Tissue, samples};
use crate::springs::{Material, Springs};
use glam::DVec2;

/// Skin and fat over a flat wall or a curved one.
fn tissue(nodes: usize, chest: &Chest) -> Problem {
    let attachment = Attachment::default();
    let patch = Patch {
        radius_mm: 130.0,
        pocket_radius_mm: 70.0,
        pocket_lowered_mm: 0.0,
        edge: Edge::Attached(attachment),
    };
    let skin = ScaledCurve { strain_scale: 0.5, ..CurveSpec::Skin {}.into() };
    let skin = Material::new(Curve::scaled(&skin).unwrap(), 0.45, 1.5);
    let fat = Material::of(&CurveSpec::Exponential { scale_kpa: 0.6, rate: 5.0 }, 0.45, 8.5);
    let dome = Dome::new(DVec2::ZERO, HalfBall::round(60.0, 40.0), 1.0);
    Problem {
        rest: Rest::layered(Sheet::new(nodes, 130.0), &[8.5], 3).over(chest.clone()),
        patch,
        obstacle: Obstacle::on_flat_wall(dome).over(chest.clone()),
        materials: vec![skin, fat],
        springs: Springs::Coupled,
        tissue: Tissue::Layered,
        tolerance: 1e-4,
        void: None,
    }
}

const TORSO: Chest = Chest::Curved { across_mm: 140.0, along_mm: 400.0 };

/// The problem with its implant yielding.
fn soft(problem: &Problem, modulus_kpa: f64) -> Problem {
    let mut problem = problem.clone();
    let rest = problem.obstacle.dome.shape.half_ball().unwrap();
    problem.obstacle.dome.shape = Deformed::at_rest(rest, modulus_kpa).into();
    problem
}

/// Off centre, with the apex lower and of another fullness.
fn anatomical(mut problem: Problem) -> Problem {
    let dome = &mut problem.obstacle.dome;
    let shape = HalfBall::round(55.0, 36.0).anatomical(60.0, 12.0).filled(0.62);
    (dome.shape, dome.center) = (shape.into(), DVec2::new(4.0, -3.0));
    problem
}

fn solved_by(problem: Problem, method: Method) -> Solver {
    let options = Options { method, max_newton_cells: usize::MAX, ..Options::default() };
    let mut solver = Solver::with_options(problem, options);
    while solver.advance(&mut || false) == Progress::Working {}
    assert_eq!(solver.verdict(), Verdict::Converged, "{:?}", solver.report());
    solver
}

fn solved(problem: Problem) -> Solver {
    solved_by(problem, Method::Automatic)
}

fn modes(solver: &Solver) -> Modes<f64> {
    solver.problem().obstacle.dome.shape.soft().unwrap().modes()
}

fn force(solver: &Solver) -> f64 {
    solver.solution().part_reactions().vertical_force()
}

/// The error of the rigid implant falls as the reciprocal of the modulus.
#[test]
fn a_stiff_implant_is_the_rigid_one() {
    let rigid = tissue(33, &Chest::Flat);
    let moduli = [1e3, 1e4];
    let [softer, stiffer] = moduli.map(|modulus| solved(soft(&rigid, modulus)));
    let rigid = solved(rigid);
    let apart = |solver: &Solver| {
        let skin = solver.outer()[2].iter().zip(&rigid.outer()[2]);
        skin.map(|(a, b)| a.distance(*b)).fold(0.0, f64::max)
    };
    assert!(apart(&softer) < 1e-3 * 60.0 && apart(&stiffer) < 0.2 * apart(&softer));
    assert!((force(&softer) / force(&rigid) - 1.0).abs() < 3e-3);
    assert!(softer.cycles() <= rigid.cycles() + 1);
}

/// Of a symmetric shape, of one off centre, of a sheet: multigrid in f32 and Newton's method end in the same numbers.
#[test]
fn multigrid_and_newtons_method_balance_alike() {
    let round = soft(&tissue(33, &Chest::Flat), 20.0);
    let apart = soft(&anatomical(tissue(33, &TORSO)), 40.0);
    let mut sheet = samples::sheet(33, [6.0, 0.0], 1.0);
    sheet.obstacle.dome.shape = HalfBall::round(50.0, 40.0).into();
    for (problem, symmetric) in [(round, 4), (apart, 0), (soft(&sheet, 60.0), 2)] {
        let multigrid = solved_by(problem.clone(), Method::Automatic);
        let newton = solved_by(problem, Method::Newton);
        assert!(!multigrid.fell_back() && multigrid.cycles() > 0);
        let (own, other) = (modes(&multigrid), modes(&newton));
        let apart = own.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(own[0] > 0.01 && apart < 1e-3, "{own:?} {other:?}");
        let fixed = own[4..].iter().filter(|lean| **lean == 0.0).count();
        assert_eq!(fixed, symmetric, "{own:?}");
        assert!((force(&multigrid) / force(&newton) - 1.0).abs() < 5e-3);
    }
}

/// Under a sheet that is stiffer than its reactions show, clamped so near to the implant that the edge's nodes are beside its surface: in a few cycles and
/// few solutions of Newton's method, with the edge in its place.
#[test]
fn an_implant_balances_under_a_tight_sheet() {
    let skin = ScaledCurve { strain_scale: 0.12, stress_scale: 1.3, ..CurveSpec::Skin {}.into() };
    let skin = Material::new(Curve::scaled(&skin).unwrap(), 0.48, 1.8);
    let dome = Dome::new(DVec2::ZERO, HalfBall::round(60.0, 30.0), 1.0);
    let rigid = Problem {
        rest: Rest::of_sheet(Sheet::new(33, 70.0)),
        patch: Patch::clamped_at_pocket(70.0),
        obstacle: Obstacle::on_flat_wall(dome),
        materials: vec![skin, Material::of(&CurveSpec::Fat { variant: Fat::Mid }, 0.48, 9.5)],
        ..samples::sheet(33, [0.0; 2], 1.0)
    };
    let problem = soft(&rigid, 49.0);
    let multigrid = solved(problem.clone());
    let newton = solved_by(problem, Method::Newton);
    assert!(!multigrid.fell_back() && multigrid.work_units() < 200.0, "{:?}", multigrid.report());
    assert!(newton.balances <= 12, "{}", newton.balances);
    let (own, other) = (modes(&multigrid), modes(&newton));
    let apart = own.iter().zip(other).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(own[0] > 0.1 && apart < 2e-3, "{own:?} {other:?}");
    assert!((force(&multigrid) / force(&newton) - 1.0).abs() < 5e-3);
    for (k, kind) in newton.problem().sheet().kinds().iter().enumerate() {
        let is_free = *kind == NodeKind::Free;
        assert!(is_free || newton.positions()[k] == newton.problem().rest.node(0, k), "{k}");
    }
}

/// The energy of tissue beside fixed shapes, by differences of the numbers, against the work of the reactions; in the balance they are the forces
/// of the body.
#[test]
fn reactions_work_as_the_energy_of_the_tissue_falls() {
    let problem = soft(&anatomical(tissue(33, &TORSO)), 25.0);
    // Newton's method from the solution of multigrid.
    let balanced = solved(Problem { tolerance: 5e-6, ..problem.clone() });
    let at = modes(&balanced);
    let own = problem.obstacle.dome.shape.soft().unwrap().gel().balance(at);
    let work = balanced.solution().part_reactions().work(&balanced.solution());
    for k in 0..MODES {
        let energy = |step: f64| {
            let mut fixed = soft(&anatomical(tissue(33, &TORSO)), f64::INFINITY);
            let mut moved = at;
            moved[k] += step;
            fixed.obstacle.dome.set_modes(moved);
            fixed.tolerance = 5e-6;
            solved(fixed).solution().elastic_energy()
        };
        let slope = (energy(5e-3) - energy(-5e-3)) / 1e-2;
        let scale = own.stiffness[0][0] * 0.01;
        assert!((slope + work.forces[k]).abs() < 0.02 * scale, "{k} {slope} {:?}", work.forces);
        assert!((own.forces[k] - work.forces[k]).abs() < 0.02 * scale, "{k} {own:?} {work:?}");
    }
}

/// The work of the vertical force on the way of insertion is the energy of tissue and implant.
#[test]
fn the_work_of_the_insertion_is_the_energy_of_tissue_and_implant() {
    let total = |insertion: f64| {
        let mut problem = soft(&tissue(33, &Chest::Flat), 15.0);
        problem.obstacle.dome.base_height = (insertion - 1.0) * 40.0;
        let solver = solved_by(Problem { tolerance: 1e-5, ..problem }, Method::Newton);
        let body = solver.problem().obstacle.dome.shape.soft().unwrap().energy();
        (solver.solution().elastic_energy() + body, force(&solver))
    };
    let (from, to) = (0.9, 1.0);
    // Simpson's rule.
    let [start, middle, end] = [from, 0.5 * (from + to), to].map(total);
    let work = (to - from) * 40.0 * (start.1 + 4.0 * middle.1 + end.1) / 6.0;
    assert!((work / (end.0 - start.0) - 1.0).abs() < 5e-3, "{work} {start:?} {end:?}");
}

/// Skin under tension that grows over an implant that yields: with the force a part of the flattening goes, the implant is in balance with the skin as it has
/// grown, and the same implant as a given shape has the same force.
#[test]
fn the_skin_grows_and_the_implant_yields_together() {
    let grown = |growth: f64, modulus_kpa: f64| {
        let mut problem = soft(&tissue(33, &TORSO), modulus_kpa);
        let natural = NaturalStretch::new([1.04, 1.04], 0.0);
        problem.rest = problem.rest.stretched(natural).growing(growth);
        problem
    };
    let [table, later] = [0.0, 0.8].map(|growth| solved(grown(growth, 20.0)));
    assert!(!later.fell_back() && force(&later) < 0.7 * force(&table));
    assert!(modes(&later)[0] > 0.01 && modes(&later)[0] < 0.8 * modes(&table)[0]);

    let mut given = grown(0.8, f64::INFINITY);
    given.obstacle.dome.set_modes(modes(&later));
    let given = solved(given);
    let difference = force(&given) / force(&later) - 1.0;
    assert!(difference.abs() < 5e-3, "{difference}");
    let own = later.problem().obstacle.dome.shape.soft().unwrap().gel().balance(modes(&later));
    let work = given.solution().part_reactions().work(&given.solution());
    for k in 0..4 {
        let apart = (own.forces[k] - work.forces[k]).abs();
        assert!(apart < 0.02 * 0.01 * own.stiffness[0][0], "{k} {own:?} {work:?}");
    }
}

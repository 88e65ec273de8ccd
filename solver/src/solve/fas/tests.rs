//! Properties of the scheme as a whole.

use super::convergence::Offsets;
use super::*;
use crate::contact::{Deformed, Dome, HalfBall, Obstacle, Superellipse};
use crate::curve::CurveSpec;
use crate::mesh::{Chest, NaturalStretch, Patch, Pocket, Rest, Sheet};
use crate::model::layered::LayeredLaw;
use crate::model::layered::lanes::Layered;
use crate::model::membrane::assembly;
use crate::model::membrane::lanes::Membrane;
use crate::model::membrane::law::SheetLaw;
use crate::solve::{Method, Options, Progress, Solver, Verdict, samples};
use crate::springs::Springs;
use glam::{DVec2, DVec3};

/// The dead load holds skin under tension on every grid, to the last bit; of the forces of solids over a curved wall rounding remains.
#[test]
fn skin_under_tension_has_no_forces_at_rest_in_lanes() {
    let materials = [(&CurveSpec::Skin {}, 0.45), (&CurveSpec::Adipose {}, 0.45)];
    let law = LayeredLaw::new(&materials.map(|(spec, nu)| samples::layer(spec, nu)));
    for chest in [Chest::Flat, Chest::Curved { across_mm: 130.0, along_mm: -400.0 }] {
        let natural = NaturalStretch::new([1.08, 1.03], 0.6);
        let rest =
            Rest::layered(Sheet::new(33, 80.0), &[8.0], 2).over(chest.clone()).stretched(natural);
        let model = Layered::new(&law, &rest, Pocket::round(40.0), None);
        for n in [17, 33] {
            let mut level = Level::new(n, [false; 2], true, 0, &model);
            level.fit(&model, 160.0 / (n - 1) as f64, &rest);
            let greatest = |level: &mut Level<Layered>| {
                level.find_forces(&model);
                let Level { layout, f, .. } = &*level;
                f.layers().map(|at| layout.greatest_length(|k| f.at(at + k))).fold(0.0, f32::max)
            };
            let at_rest = greatest(&mut level);
            let most = if rest.is_even() { 0.0 } else { 1e-8 };
            assert!(at_rest <= most, "{n} {chest:?}: {at_rest:e}");
            let middle = n / 2 * (level.layout.pitch + 1);
            level.u.z[2 * level.layout.len() + middle] = 1e-3;
            assert!(greatest(&mut level) > 1e-7, "{n}");
        }
    }
}

/// Every cycle of the finest grid without contact offsets lowers the energy, within rounding of f32.
#[test]
fn the_energy_falls_in_every_cycle() {
    let (skin, adipose) = (CurveSpec::Skin {}, CurveSpec::Adipose {});
    for (center, projection, springs, layers) in [
        ([0.0, 0.0], 50.0, Springs::Coupled, vec![(&skin, 0.45), (&adipose, 0.3)]),
        ([8.0, -5.0], 35.0, Springs::Coupled, vec![(&adipose, 0.45)]),
        ([0.0, 0.0], 40.0, Springs::Nikolaev, vec![(&skin, 0.3)]),
    ] {
        let problem = Problem {
            rest: Rest::of_sheet(Sheet::new(65, 75.0)),
            patch: Patch::clamped_at_pocket(75.0),
            obstacle: Obstacle::on_flat_wall(Dome::new(
                DVec2::from(center),
                HalfBall::round(50.0, projection),
                1.0,
            )),
            materials: layers.into_iter().map(|(spec, nu)| samples::layer(spec, nu)).collect(),
            springs,
            tissue: crate::solve::Tissue::Sheet,
            tolerance: MEMBRANE.least_tolerance,
            void: None,
        };
        let law = SheetLaw::new(springs, &problem.materials);
        let mirrored = problem.mirrored();
        let mut scheme = FullMultigrid::new(65, mirrored, Membrane::new(&law), &MEMBRANE);
        scheme.start(&problem, Stop::Tolerance, None);
        let mut x: Vec<DVec3> = problem.rest.nodes(0).collect();
        let mut energies = Vec::new();
        while scheme.step() == State::Working
            && !matches!(scheme.convergence.offsets, Offsets::Neglected | Offsets::Applied)
        {
            let is_after_cycle =
                scheme.is_on_finest() && scheme.convergence.cycles as usize == energies.len() + 1;
            if is_after_cycle {
                scheme.write_positions(&problem, &mut x, &mut Vec::new());
                energies.push(assembly::energy(problem.rest.membrane(), &law, &x));
            }
        }
        println!("{energies:?}");
        assert!(energies.len() >= 2);
        for pair in energies.windows(2) {
            assert!(pair[1] <= pair[0] * (1.0 + 1e-6), "{energies:?}");
        }
        assert!(energies[energies.len() - 1] < energies[0]);
    }
}

/// A sheet, and layered tissue over a curved wall.
#[test]
fn another_shape_is_solved_as_by_newtons_method() {
    let shape = Superellipse { radius: 48.0, projection: 30.0 };
    let on = |problem: Problem, insertion, chest: Chest| {
        let dome = Dome::new(DVec2::new(3.0, -2.0), shape, insertion);
        let obstacle = Obstacle::on_flat_wall(dome).over(chest.clone());
        Problem { rest: problem.rest.over(chest), obstacle, ..problem }
    };
    let chest = Chest::Curved { across_mm: 140.0, along_mm: 400.0 };
    for problem in [
        on(samples::sheet(65, [0.0; 2], 1.0), 0.8, Chest::Flat),
        on(samples::layered_at_rest(33), 1.0, chest),
    ] {
        let [multigrid, newton] = [Method::Automatic, Method::Newton].map(|method| {
            let options = Options { method, ..Options::default() };
            let mut solver = Solver::with_options(problem.clone(), options);
            while solver.advance(&mut || false) == Progress::Working {}
            assert_eq!(solver.verdict(), Verdict::Converged);
            solver
        });
        assert!(!multigrid.fell_back() && multigrid.cycles() > 0);
        let dome = &problem.obstacle.dome;
        let apart = multigrid.positions().iter().zip(newton.positions());
        let apart = apart.map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        assert!(apart < 2.0 * problem.tolerance * dome.reference_length(), "{apart}");
        let touching = multigrid.positions().iter().filter(|x| dome.gauge(**x).abs() < 1e-6);
        assert!(touching.count() > 50);
    }
}

/// What an implant that yields moves is no sign of slow cycles: nodal blocks are not renewed for it.
#[test]
fn an_implant_that_yields_leaves_the_mode_of_fast_cycles() {
    for modulus_kpa in [44.0, 4.0] {
        let mut problem = samples::layered_at_rest(65);
        let shape = Deformed::at_rest(HalfBall::round(50.0, 40.0), modulus_kpa);
        problem.obstacle = Obstacle::on_flat_wall(Dome::new(DVec2::ZERO, shape, 1.0));
        let law = LayeredLaw::new(&problem.materials);
        let (rest, patch) = (&problem.rest, &problem.patch);
        let model = Layered::new(&law, rest, patch.pocket(), patch.attachment());
        let mut scheme = FullMultigrid::new(65, problem.mirrored(), model, &LAYERED);
        scheme.start(&problem, Stop::Tolerance, None);
        while scheme.step() == State::Working {}
        assert_eq!(scheme.mode, Mode::Fast, "{modulus_kpa}");
    }
}

//! Compares the solver with Newton's method by sparse Cholesky factorisation, both from a cold start to 0.1 % of the base
//! radius, on one thread.
//!
//! Newton's method starts on nested grids under the rising dome, with the exact second derivatives, active set and line search of
//! [`implant_preview::solve`]; the matrix of every step is factorised, shifted where it is not positive definite. Its time ends with
//! the first step of the finest grid after which all errors stay below 0.1 %: no stopping test, no later step is counted.

mod factor;

use factor::{Cost, take_cost};
use glam::DVec3;
use implant_preview::curve::CurveSpec;
use implant_preview::experiment::work_precision::Case;
use implant_preview::scene::{CellsThrough, Scene};
use implant_preview::solve::{Method, Options, Problem, Progress, Solver, Verdict};
use std::time::Instant;

/// Greatest distance of a node from the grid's own equilibrium \[base radius\].
const GOAL: f64 = 1e-3;
const RUNS: usize = 5;

/// Positions of all nodes, layer by layer \[mm\].
fn nodes(solver: &Solver) -> Vec<DVec3> {
    solver.positions().iter().chain(solver.outer().iter().flatten()).copied().collect()
}

fn scene(nodes_per_side: usize, cells: u32, is_linear: bool) -> Scene {
    let mut scene = Case::LayeredDefault.scene(nodes_per_side, GOAL);
    scene.solver.cells_through = Some(CellsThrough::Count(cells as usize));
    if is_linear {
        // The initial moduli of the presets.
        for (layer, modulus_kpa) in scene.layers.iter_mut().zip([100.0, 3.0]) {
            layer.curve = CurveSpec::Linear { modulus_kpa }.into();
        }
    }
    scene
}

struct Run {
    time_ms: f64,
    error: f64,
}

/// A cold start of the solver to its own end, grids and tables included.
fn product(problem: &Problem, options: Options, error: &dyn Fn(&Solver) -> f64) -> Run {
    let start = Instant::now();
    let mut solver = Solver::with_options(problem.clone(), options);
    while solver.advance(&mut || false) == Progress::Working {}
    let time_ms = 1e3 * start.elapsed().as_secs_f64();
    assert_eq!(solver.verdict(), Verdict::Converged);
    Run { time_ms, error: error(&solver) }
}

/// A cold start of Newton's method up to the last step with an error above the goal and one step more.
fn cholesky(
    problem: &Problem,
    options: Options,
    error: &dyn Fn(&Solver) -> f64,
) -> (Run, Run, Cost) {
    take_cost();
    let start = Instant::now();
    let mut paused = 0.0;
    let mut solver = Solver::with_factorization(problem.clone(), options, factor::new);
    let mut revision = solver.revision();
    let mut samples: Vec<Run> = Vec::new();
    while solver.advance(&mut || true) == Progress::Working {
        if solver.revision() != revision {
            revision = solver.revision();
            let time_ms = 1e3 * start.elapsed().as_secs_f64() - paused;
            let pause = Instant::now();
            samples.push(Run { time_ms, error: error(&solver) });
            paused += 1e3 * pause.elapsed().as_secs_f64();
        }
    }
    let time_ms = 1e3 * start.elapsed().as_secs_f64() - paused;
    samples.push(Run { time_ms, error: error(&solver) });
    assert_eq!(solver.verdict(), Verdict::Converged);
    if std::env::var_os("TRACE").is_some() {
        for Run { time_ms, error } in &samples {
            eprintln!("  {time_ms:.1} ms  {error:.2e}");
        }
    }
    let last = samples.pop().expect("the end");
    let first = samples.iter().rposition(|sample| sample.error > GOAL).map_or(0, |k| k + 1);
    let first = samples.into_iter().nth(first).unwrap_or(Run { ..last });
    (first, last, take_cost())
}

fn median(runs: impl Iterator<Item = f64>) -> f64 {
    let mut values: Vec<f64> = runs.collect();
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let mut arguments = std::env::args().skip(1).map(|text| text.parse::<u32>());
    let mut number = |default: u32| match arguments.next() {
        None => default,
        Some(Ok(number)) => number,
        Some(Err(error)) => {
            eprintln!("arguments: nodes per side, cells through the thickness: {error}");
            std::process::exit(2);
        }
    };
    let (nodes_per_side, cells) = (number(65) as usize, number(4));
    println!(
        "| scene | patch | multigrid | error | Newton, Cholesky, to 0.1 % | error | ratio | to its own end | factorisations (finest) | not positive | unknowns | entries of the factor | symbolic | numeric | triangular |"
    );
    println!(
        "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
    );
    for is_linear in [false, true] {
        let scene = scene(nodes_per_side, cells, is_linear);
        let problem = scene.problem().expect("a valid scene");
        let radius = problem.obstacle.dome.base_radius;
        let mut own = Solver::with_options(
            Problem { tolerance: 1e-9, ..problem.clone() },
            Options { method: Method::Newton, ..Options::default() },
        );
        while own.advance(&mut || false) == Progress::Working {}
        assert_eq!(own.verdict(), Verdict::Converged);
        let own = nodes(&own);
        let error = |solver: &Solver| {
            let squares =
                nodes(solver).into_iter().zip(&own).map(|(x, own)| x.distance_squared(*own));
            squares.fold(0.0, f64::max).sqrt() / radius
        };
        for use_symmetry in [true, false] {
            let options = Options { use_symmetry, ..Options::default() };
            let runs: Vec<_> = (0..RUNS)
                .map(|_| (product(&problem, options, &error), cholesky(&problem, options, &error)))
                .collect();
            let product_ms = median(runs.iter().map(|(product, _)| product.time_ms));
            let first_ms = median(runs.iter().map(|(_, (first, _, _))| first.time_ms));
            let last_ms = median(runs.iter().map(|(_, (_, last, _))| last.time_ms));
            let ratio =
                median(runs.iter().map(|(product, (first, _, _))| first.time_ms / product.time_ms));
            let (product, (first, _, cost)) = &runs[0];
            println!(
                "| {} | {} | {product_ms:.1} ms | {:.1e} | {first_ms:.0} ms | {:.1e} | {ratio:.0} | {last_ms:.0} ms | {} ({}) | {} | {} | {:.1e} | {:.0} ms | {:.0} ms | {:.0} ms |",
                if is_linear { "linear" } else { "softening" },
                if use_symmetry { "quarter" } else { "whole" },
                product.error,
                first.error,
                cost.all[0],
                cost.largest,
                cost.all[1],
                cost.unknowns,
                cost.entries as f64,
                median(runs.iter().map(|(_, (_, _, cost))| cost.symbolic_ms)),
                median(runs.iter().map(|(_, (_, _, cost))| cost.numeric_ms)),
                median(runs.iter().map(|(_, (_, _, cost))| cost.solve_ms)),
            );
        }
    }
}

//! What a call costs: a scene's JSON text in, its result's JSON text out, split into its phases.
//!
//! `cargo bench --no-default-features --bench call` prints the table of `docs/performance.md`, in milliseconds: fastest of
//! [`ROUNDS`] cold calls, each with a new solver, and of as many calls of a simulator that keeps its grids and tables.
//! `-- SCENE.json …` measures these scenes instead; `-- --once SCENE.json` calls once, for a profiler that counts
//! instructions.

#![allow(clippy::print_stdout, reason = "a benchmark prints its report")]
#![allow(clippy::unwrap_used, reason = "a benchmark ends at an invalid scene")]

use implant_preview::measure::{Fields, Selection};
use implant_preview::scene::CheckedScene;
use implant_preview::simulate::{self, Simulator};
use implant_preview::solve::{Options, Progress, Solver};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

/// Calls of each scene; the fastest counts.
const ROUNDS: usize = 60;

/// The phases of a call.
const PHASES: [&str; 6] = ["read", "problem", "set-up", "solve", "measure", "write"];

/// Times of the phases \[ms\].
fn call(json: &str) -> [f64; PHASES.len()] {
    let mut last = Instant::now();
    let mut lap = || {
        let now = Instant::now();
        let ms = now.duration_since(last).as_secs_f64() * 1e3;
        last = now;
        ms
    };
    let scene = CheckedScene::from_json(json).unwrap();
    let read = lap();
    let problem = scene.problem();
    let build = lap();
    let mut solver = Solver::new(problem);
    let set_up = lap();
    while solver.advance(&mut || false) == Progress::Working {}
    let solution = Arc::new(solver.into_solution());
    let solve = lap();
    let outcome = simulate::measure(scene.scene(), &Fields::new(solution));
    let measure = lap();
    black_box(serde_json::to_string(&outcome).unwrap());
    [read, build, set_up, solve, measure, lap()]
}

/// Time of a call of a simulator that has computed a similar scene, and the solver's part \[ms\].
fn next_call(simulator: &mut Simulator, json: &str) -> [f64; 2] {
    let start = Instant::now();
    let clock = || start.elapsed().as_secs_f64() * 1e3;
    let scene = CheckedScene::from_json(json).unwrap();
    let all = Selection::all();
    let outcome = simulator.run(&scene, Options::default(), &all, Some(&clock)).outcome;
    black_box(serde_json::to_string(&outcome).unwrap());
    [clock(), outcome.solver.time_ms.unwrap()]
}

/// Skin and the paper's adipose.
const PAPERS_LAYERS: &str =
    r#"[{}, { "tissue": "adipose", "thickness_mm": 10, "curve": { "kind": "adipose" } }]"#;

/// The scenes of the report: the default scene with the paper's adipose, as a sheet and as layered tissue.
fn scenes() -> Vec<(String, String)> {
    let mut scenes = Vec::new();
    let places = [("quarter", [0.0, 0.0]), ("half", [6.0, 0.0]), ("whole", [6.0, 3.0])];
    for model in ["sheet", "layered"] {
        for nodes in [129, 257] {
            for (part, [x, y]) in places {
                let json = format!(
                    r#"{{ "tissue_model": "{model}", "pocket_radius_mm": 70.0, "layers": {PAPERS_LAYERS},
                        "implant": {{ "base_radius_mm": 55.0, "center_mm": [{x}, {y}] }},
                        "solver": {{ "nodes_per_side": {nodes}, "tolerance": 1e-3, "cells_through": 2 }} }}"#
                );
                scenes.push((format!("{model}, {part}, {nodes}"), json));
            }
        }
    }
    scenes
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|a| a != "--bench").collect();
    let is_once = arguments.iter().any(|a| a == "--once");
    let given: Vec<(String, String)> = arguments
        .iter()
        .filter(|a| !a.starts_with("--"))
        .map(|path| (path.clone(), std::fs::read_to_string(path).unwrap()))
        .collect();
    if is_once {
        given.iter().for_each(|(_, json)| _ = call(json));
        return;
    }
    println!("| scene | {} | call | its solver | next call | its solver |", PHASES.join(" | "));
    println!("|{}", " --- |".repeat(PHASES.len() + 5));
    for (name, json) in if given.is_empty() { scenes() } else { given } {
        let calls: Vec<_> = (0..ROUNDS).map(|_| call(&json)).collect();
        let total = |times: &[f64; PHASES.len()]| times.iter().sum::<f64>();
        let fastest = |of: &dyn Fn(&[f64; PHASES.len()]) -> f64| {
            calls.iter().map(of).fold(f64::INFINITY, f64::min)
        };
        let phases: Vec<String> =
            (0..PHASES.len()).map(|k| format!("{:.3}", fastest(&|call| call[k]))).collect();
        let (all, solver) = (fastest(&total), fastest(&|call| call[1] + call[2] + call[3]));
        let mut simulator = Simulator::default();
        let next: Vec<_> = (0..ROUNDS).map(|_| next_call(&mut simulator, &json)).collect();
        let [next, next_solver] =
            [0, 1].map(|k| next.iter().map(|times| times[k]).fold(f64::INFINITY, f64::min));
        println!(
            "| {name} | {} | {all:.2} | {solver:.2} | {next:.2} | {next_solver:.2} |",
            phases.join(" | ")
        );
    }
}

//! Allocations of a solve; growth of work and memory with the grid.
//!
//! One test: the profiler counts the allocations of the whole process.

#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use dhat::HeapStats;
use implant_preview::measure::bands::SkinLimits;
use implant_preview::scene::Scene;
use implant_preview::session::Session;
use implant_preview::solve::{Method, Options, Problem, Progress, Solver, Verdict};
use implant_preview::view::picture::Picture;
use implant_preview::view::quantity::{Colouring, Quantity};
use implant_preview::view::section::{Opening, Section};
use serde_json::json;
use std::sync::Arc;

#[global_allocator]
static ALLOCATOR: dhat::Alloc = dhat::Alloc;

/// Measurements of an off-centre dome, on the whole sheet.
fn sheet(nodes: usize) -> Problem {
    let scene = json!({
        "tissue_model": "sheet",
        "implant": { "base_radius_mm": 45, "projection_mm": 30, "center_mm": [8, 5] },
        "pocket_radius_mm": 65, "insertion": 0.8,
        "solver": { "nodes_per_side": nodes, "tolerance": 1e-4 },
    });
    Scene::from_json(&scene.to_string()).unwrap().problem().unwrap()
}

/// The same of layered tissue with two cells through the thickness, on the whole patch.
fn layered(nodes: usize) -> Problem {
    let scene = json!({
        "tissue_model": "layered",
        "implant": { "base_radius_mm": 45, "projection_mm": 30, "center_mm": [8, 5] },
        "pocket_radius_mm": 65, "insertion": 0.8,
        "solver": { "nodes_per_side": nodes, "tolerance": 1e-3, "cells_through": 2 },
    });
    Scene::from_json(&scene.to_string()).unwrap().problem().unwrap()
}

struct Use {
    /// Memory of a solver besides the sheet \[bytes\]: all levels, the displayed shape, and the law's tables, whose size
    /// is independent of the grid.
    bytes: usize,
    /// Node evaluations of a solve.
    evaluations: f64,
    /// Free nodes of all layers of the finest grid.
    nodes: usize,
}

fn measured(problem: &Problem) -> Use {
    let before = HeapStats::get().curr_bytes;
    let mut solver = Solver::new(problem.clone());
    while solver.advance(&mut || true) == Progress::Working {}
    assert!(!solver.fell_back());
    let held = HeapStats::get().curr_bytes - before;
    let evaluations = solver.work_units() * solver.nodes_solved() as f64;

    check_second_solve(&mut solver, problem);
    let before = HeapStats::get().curr_bytes;
    let sheet = problem.sheet().clone();
    let bytes = held - (HeapStats::get().curr_bytes - before);
    let layers = 1 + solver.outer().len();
    Use { bytes, evaluations, nodes: layers * sheet.free_nodes() }
}

/// The second solve reuses all memory.
fn check_second_solve(solver: &mut Solver, problem: &Problem) {
    solver.restart(problem.clone());
    let mut pieces = 0;
    let before = HeapStats::get().total_blocks;
    while solver.advance(&mut || true) == Progress::Working {
        pieces += 1;
    }
    let allocated = HeapStats::get().total_blocks - before;
    assert!(pieces > 10);
    assert_eq!(allocated, 0, "{allocated} allocations in {pieces} pieces");
}

/// Newton's method: the second solve of layered tissue starts on the coarsest grid under a rising dome, that of a sheet from the
/// last solution.
fn check_newtons_method(problem: &Problem) {
    let options = Options { method: Method::Newton, ..Options::default() };
    let mut solver = Solver::with_options(problem.clone(), options);
    while solver.advance(&mut || true) == Progress::Working {}
    assert_eq!(solver.verdict(), Verdict::Converged);
    check_second_solve(&mut solver, problem);
    assert_eq!(solver.verdict(), Verdict::Converged);
}

/// Memory and work of solves on ever finer grids.
struct Growth {
    problem: fn(usize) -> Problem,
    nodes: &'static [usize],
    /// Nodes per side from which [`Self::most_bytes`] holds; tables matter on coarser grids.
    from: usize,
    /// The most bytes per node of the finest grid, over all grids.
    most_bytes: f64,
    /// The most memory and work for twice the nodes per side \[-\].
    most: [f64; 2],
}

fn check_growth(growth: &Growth) -> Vec<String> {
    let mut lines = Vec::new();
    let tables = measured(&(growth.problem)(17)).bytes;
    let mut last: Option<Use> = None;
    for &nodes in growth.nodes {
        let now = measured(&(growth.problem)(nodes));
        let per_node = (now.bytes - tables) as f64 / now.nodes as f64;
        let evaluations = now.evaluations;
        lines.push(format!("{nodes}: {per_node:.0} bytes a node, {evaluations:.1e} evaluations"));
        if nodes >= growth.from {
            assert!(per_node <= growth.most_bytes, "{per_node:.0} bytes a node at {nodes}");
        }
        if let Some(last) = last {
            let memory = now.bytes as f64 / last.bytes as f64;
            assert!(memory <= growth.most[0], "{memory:.2} times the memory of {nodes} / 2");
            let work = now.evaluations / last.evaluations;
            assert!(work <= growth.most[1], "{work:.2} times the work of {nodes} / 2");
        }
        last = Some(now);
    }
    lines
}

/// Repeated updates of a picture while the renderer still owns the previous meshes.
fn draw_in_the_room_of_an_older_picture() {
    let scene = json!({ "tissue_model": "sheet",
        "implant": { "base_radius_mm": 55 }, "pocket_radius_mm": 70 });
    let mut session = Session::new(Scene::from_json(&scene.to_string()).unwrap()).unwrap();
    while session.advance(&mut || false) == Progress::Working {}
    let section = Section { opening: Opening::Closed, angle: 0.0, axis: glam::Vec2::ZERO };
    let mut picture = Picture::default();
    let mut held = Arc::default();
    for k in 0..12 {
        let quantity = [Quantity::Strain, Quantity::AreaStretch][k % 2];
        let before = HeapStats::get();
        assert!(picture.update(
            &session,
            Colouring { quantity, skin: SkinLimits::Tearing },
            section,
            &|| 0.0
        ));
        let after = HeapStats::get();
        let vertices = size_of_val(picture.meshes[0].vertices.as_slice()) as u64;
        assert!(vertices > 1_000_000);
        if k >= 4 {
            let taken = after.total_bytes - before.total_bytes;
            assert!(taken < vertices, "{taken} bytes taken for {vertices} bytes of vertices");
            assert!(after.curr_bytes <= before.curr_bytes + 1000, "the pictures add up");
        }
        held = Arc::clone(&picture.meshes[0]);
    }
    drop(held);
}

#[test]
fn memory_and_work_are_linear_a_cycle_allocates_nothing_and_pictures_reuse_memory() {
    let _profiler = dhat::Profiler::builder().testing().build();
    draw_in_the_room_of_an_older_picture();
    check_newtons_method(&layered(33));
    check_newtons_method(&sheet(33));
    let sheet = Growth {
        problem: sheet,
        nodes: &[65, 129, 257, 513],
        from: 129,
        most_bytes: 220.0,
        most: [4.4, 4.5],
    };
    println!("sheet: {:#?}", check_growth(&sheet));
    let layered = Growth {
        problem: layered,
        nodes: &[65, 129, 257],
        from: 129,
        most_bytes: 350.0,
        most: [4.4, 4.6],
    };
    println!("layered tissue: {:#?}", check_growth(&layered));
}

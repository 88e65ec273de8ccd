//! Allocations of a solve; growth of work and memory with the grid.
//!
//! One test: the profiler counts the allocations of the whole process.

#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use dhat::HeapStats;
use implant_preview::scene::Scene;
use implant_preview::session::Session;
use implant_preview::solve::{Problem, Progress, Solver};
use implant_preview::view::color::Quantity;
use implant_preview::view::picture::Picture;
use implant_preview::view::section::{Opening, Section};
use serde_json::json;
use std::sync::Arc;

#[global_allocator]
static ALLOCATOR: dhat::Alloc = dhat::Alloc;

/// Measurements of an off-centre dome, on the whole sheet.
fn problem(nodes: usize) -> Problem {
    let scene = json!({
        "tissue_model": "sheet",
        "implant": { "base_radius_mm": 45, "projection_mm": 30, "center_mm": [8, 5] },
        "pocket_radius_mm": 65, "insertion": 0.8,
        "solver": { "nodes_per_side": nodes, "tolerance": 1e-4 },
    });
    Scene::from_json(&scene.to_string()).unwrap().problem().unwrap()
}

struct Use {
    /// Memory of a solver besides the sheet \[bytes\]: all levels, the displayed shape, and the law's tables, whose size
    /// is independent of the grid.
    bytes: usize,
    /// Node evaluations of a solve.
    evaluations: f64,
    nodes: usize,
}

fn measured(nodes: usize) -> Use {
    let problem = problem(nodes);
    let before = HeapStats::get().curr_bytes;
    let mut solver = Solver::new(problem.clone());
    while solver.advance(&mut || true) == Progress::Working {}
    assert!(!solver.fell_back());
    let held = HeapStats::get().curr_bytes - before;
    let evaluations = solver.work_units() * solver.nodes_solved() as f64;

    // The second solve reuses all memory.
    solver.restart(problem.clone());
    let mut pieces = 0;
    let before = HeapStats::get().total_blocks;
    while solver.advance(&mut || true) == Progress::Working {
        pieces += 1;
    }
    let allocated = HeapStats::get().total_blocks - before;
    assert!(pieces > 10);
    assert_eq!(allocated, 0, "{allocated} allocations in {pieces} pieces");
    let before = HeapStats::get().curr_bytes;
    let sheet = problem.sheet.clone();
    let bytes = held - (HeapStats::get().curr_bytes - before);
    Use { bytes, evaluations, nodes: sheet.free_nodes() }
}

/// Repeated updates of a picture while the renderer still owns the previous meshes.
fn draw_in_the_room_of_an_older_picture() {
    let mut session = Session::new(Scene::default()).unwrap();
    while session.advance(&mut || false) == Progress::Working {}
    let section = Section { opening: Opening::Closed, angle: 0.0, axis: glam::Vec2::ZERO };
    let mut picture = Picture::default();
    let mut held = Arc::default();
    for k in 0..12 {
        let quantity = [Quantity::Strain, Quantity::AreaStretch][k % 2];
        let before = HeapStats::get();
        assert!(picture.update(&session, quantity, section, &|| 0.0));
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
    let tables = measured(17).bytes;
    let mut last: Option<Use> = None;
    for nodes in [65, 129, 257, 513] {
        let now = measured(nodes);
        let per_node = (now.bytes - tables) as f64 / now.nodes as f64;
        if nodes >= 129 {
            assert!(per_node <= 200.0, "{per_node:.0} bytes a node at {nodes}");
        }
        if let Some(last) = last {
            let memory = now.bytes as f64 / last.bytes as f64;
            assert!(memory <= 4.4, "{memory:.2} times the memory of {nodes} / 2");
            let work = now.evaluations / last.evaluations;
            assert!(work <= 4.4, "{work:.2} times the work of {nodes} / 2");
        }
        println!("{nodes}: {per_node:.0} bytes a node, {:.1e} evaluations", now.evaluations);
        last = Some(now);
    }
}

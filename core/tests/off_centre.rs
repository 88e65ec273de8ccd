//! A dome off centre costs what its area costs: the whole patch in place of a quarter, with the cycles of the symmetric scene.
#![allow(clippy::unwrap_used)] // helpers of tests are tests
#![allow(clippy::float_cmp, reason = "equal to the last bit")]

use implant_preview_core::scene::Scene;
use implant_preview_core::simulate::simulate;

/// Cycles, and work \[evaluations of the forces of a node\].
fn cost(base: &Scene, nodes: usize, center_mm: [f64; 2]) -> (u32, f64) {
    let mut scene = base.clone();
    scene.solver.nodes_per_side = nodes;
    scene.implant.center_mm = center_mm;
    let solver = simulate(&scene).unwrap().solver;
    assert!(!solver.fell_back);
    (solver.cycles, solver.work_units * solver.nodes_solved as f64)
}

#[test]
fn half_a_millimetre_both_ways_costs_four_quarters() {
    let flat = Scene { chest: None, ..Scene::opening() };
    for (name, base) in [("sheet", Scene::sheet()), ("flat", flat), ("curved", Scene::opening())] {
        for nodes in [33, 65, 129] {
            let (cycles, quarter) = cost(&base, nodes, [0.0; 2]);
            let (cycles_off, whole) = cost(&base, nodes, [0.5; 2]);
            let ratio = whole / quarter;
            // Of three mixed results the quarter at 33 nodes takes one cycle less.
            assert!(cycles_off <= cycles + 1, "{name} {nodes}: {cycles_off} {cycles}");
            assert!((2.5..=4.3).contains(&ratio), "{name} {nodes}: {ratio}");
        }
    }
}

#[test]
fn a_shift_that_is_negligible_beside_the_tolerance_is_solved_as_symmetric() {
    let base = Scene::opening();
    let (tolerance, radius) = (base.solver.tolerance, base.implant.base_radius_mm);
    let solved = |center_mm| cost(&base, 33, center_mm);
    let (_, quarter) = solved([0.0; 2]);
    let least = 0.1 * tolerance * radius;
    assert_eq!(solved([0.99 * least, -0.99 * least]).1, quarter);
    // One axis of symmetry is left: half of the patch.
    let (_, half) = solved([0.5, 0.99 * least]);
    assert!((1.5..2.2).contains(&(half / quarter)), "{}", half / quarter);
    assert!(solved([1.01 * least; 2]).1 > 3.0 * quarter);
}

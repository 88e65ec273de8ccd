//! The estimated error of the discretisation against the limit of the axisymmetric reference.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview::mesh::NodeKind;
use implant_preview::scene::{CellsThrough, Scene};
use implant_preview::solve::{Solver, Verdict};
use implant_preview_lab::robustness::clinical::Clinical;
use implant_preview_lab::work_precision::{Face, axisymmetric};

/// The estimate over the greatest distance of a node of the skin from the limit; `None` without a reference.
fn ratio(scene: &Scene) -> Option<f64> {
    let mut solver = Solver::new(scene.problem().unwrap());
    solver.advance(&mut || false);
    assert_eq!(solver.verdict(), Verdict::Converged);
    let limit = axisymmetric(scene, None)?;
    let skin = solver.outer().last().unwrap();
    let (sheet, radius) = (solver.problem().sheet(), scene.implant.base_radius_mm);
    let distance = |k: usize| {
        let rest = sheet.rest()[k];
        let (r, z) = limit(Face::Skin, rest.length());
        skin[k].distance((rest * (r / rest.length().max(1e-300))).extend(z)) / radius
    };
    let free = (0..sheet.len()).filter(|&k| sheet.kinds()[k] == NodeKind::Free);
    let error = free.map(distance).fold(0.0, f64::max);
    Some(solver.estimated_discretisation_error().unwrap() / error)
}

/// A random patient: `case` decides the grid and, of every third patient, the cells through the thickness.
fn patient(case: u64) -> Scene {
    let nodes_per_side = if case.is_multiple_of(2) { 33 } else { 65 };
    let clinical = Clinical {
        fat_poisson_ratio: [0.45, 0.49, 0.495][case as usize % 3],
        nodes_per_side,
        ..Clinical::default()
    };
    let mut scene = clinical.scene(11, case);
    if case.is_multiple_of(3) {
        scene.solver.cells_through = Some(CellsThrough::Count(1 + case as usize / 3 % 2));
    }
    scene
}

#[test]
fn of_random_patients_it_is_right_within_a_factor_of_three() {
    let ratios: Vec<f64> = (0..40).filter_map(|case| ratio(&patient(case))).collect();
    assert!(ratios.len() >= 38, "{}", ratios.len());
    let right = ratios.iter().filter(|ratio| (1.0 / 3.0..3.0).contains(*ratio)).count();
    assert!(right * 100 >= 95 * ratios.len(), "{right} of {}: {ratios:.2?}", ratios.len());
}

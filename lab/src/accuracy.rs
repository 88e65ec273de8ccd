//! Greatest error of all nodes against a reference, for tables of the accuracy.
//!
//! Over a centred dome the reference of every node is the axisymmetric solution at its material radius
//! ([`crate::work_precision::axisymmetric`]). Over a dome off centre the reference of a sheet is the solution on 513
//! nodes per side, extrapolated by second order from 257 and 513: the free nodes of a grid are nodes of its finer grids.
//!
//! Uses `work_precision`, `solve`, `scene`. Used by the command line and the tests.

use super::work_precision::{Case, Face, axisymmetric};
use glam::DVec3;
use implant_preview_core::mesh::NodeKind;
use implant_preview_core::scene::{Scene, SceneError};
use implant_preview_core::solve::{Progress, Solver, Tissue, Verdict};
use std::fmt::Write;

/// Tolerance of the solutions \[base radius\]: of a sheet, of layered tissue, whose errors of discretisation are larger.
const TOLERANCE: (f64, f64) = (1e-7, 1e-4);
/// Tolerance on the two finest grids \[base radius\].
const REFERENCE_TOLERANCE: f64 = 1e-6;
/// Nodes per side of the grids behind the reference of a dome off centre.
const REFERENCE_GRIDS: [usize; 2] = [257, 513];
/// Centre of a dome off centre \[base radius\].
const OFF_CENTRE: [f64; 2] = [0.06, 0.04];

/// Errors of a solution on one grid.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The scene.
    pub case: Case,
    /// Is the dome off centre?
    pub is_off_centre: bool,
    /// Nodes per side.
    pub nodes_per_side: usize,
    /// Cells through the thickness of layered tissue.
    pub cells_through: Option<usize>,
    /// Errors of the inner face and, of layered tissue, of the skin.
    pub faces: Vec<(Face, Errors)>,
}

/// Errors of the nodes of a face \[base radius\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Greatest distance of a node on the row through the pocket's centre from its reference.
    pub profile: f64,
    /// Greatest distance of any node from its reference.
    pub greatest: f64,
    /// Root of the mean squared distance of all nodes.
    pub mean: f64,
    /// Material radius of the node with the greatest distance, over the pocket's radius \[-\].
    pub at: f64,
}

/// Measures a scene on a grid; `None` without a reference or a converged solution.
///
/// # Errors
/// The scene does not allow the grid.
pub fn measure(
    case: Case,
    is_off_centre: bool,
    nodes_per_side: usize,
) -> Result<Option<Row>, SceneError> {
    let (of_sheet, of_layers) = TOLERANCE;
    let tolerance = if case.is_layered() { of_layers } else { of_sheet };
    let scene = placed(case, is_off_centre, nodes_per_side, tolerance);
    let problem = scene.problem()?;
    let Some(solver) = solved(&scene)? else { return Ok(None) };
    let cells_through = match problem.tissue {
        Tissue::Sheet => None,
        Tissue::Layered => Some(problem.rest.cells().len()),
    };
    let faces: Vec<(Face, &[DVec3])> = match solver.outer().last() {
        None => vec![(Face::Inner, solver.positions())],
        Some(skin) => vec![(Face::Inner, solver.positions()), (Face::Skin, skin)],
    };
    let references = if is_off_centre {
        finer(case, nodes_per_side)?.map(|reference| vec![reference])
    } else {
        axisymmetric(&scene, case.mound()).map(|profile| {
            let at = |face: Face, k: usize| {
                let rest = problem.sheet().rest()[k];
                let s_mm = rest.length();
                let (r, z) = profile(face, s_mm);
                (rest * (r / s_mm.max(f64::MIN_POSITIVE))).extend(z)
            };
            let nodes = 0..problem.sheet().len();
            faces.iter().map(|(face, _)| nodes.clone().map(|k| at(*face, k)).collect()).collect()
        })
    };
    let Some(references) = references else { return Ok(None) };
    let radius = problem.obstacle.dome.reference_length();
    let (n, sheet) = (nodes_per_side, problem.sheet());
    let errors = |x: &[DVec3], reference: &[DVec3]| {
        let mut errors = Errors::default();
        let mut count = 0.0;
        for k in (0..sheet.len()).filter(|&k| sheet.kinds()[k] == NodeKind::Free) {
            let distance = x[k].distance(reference[k]) / radius;
            count += 1.0;
            errors.mean += distance * distance;
            if k / n == n / 2 {
                errors.profile = errors.profile.max(distance);
            }
            if distance > errors.greatest {
                errors.greatest = distance;
                errors.at = sheet.rest()[k].length() / problem.patch.pocket_radius_mm;
            }
        }
        errors.mean = (errors.mean / f64::max(count, 1.0)).sqrt();
        errors
    };
    let pairs = faces.iter().zip(&references);
    let faces = pairs.map(|((face, x), reference)| (*face, errors(x, reference))).collect();
    Ok(Some(Row { case, is_off_centre, nodes_per_side, cells_through, faces }))
}

fn placed(case: Case, is_off_centre: bool, nodes_per_side: usize, tolerance: f64) -> Scene {
    let mut scene = case.scene(nodes_per_side, tolerance);
    if is_off_centre {
        let radius = scene.implant.base_radius_mm;
        scene.implant.center_mm = OFF_CENTRE.map(|part| part * radius);
        // The base stays inside of the pocket.
        let reach = OFF_CENTRE[0].hypot(OFF_CENTRE[1]) * radius;
        scene.pocket_radius_mm = scene.pocket_radius_mm.max(radius + reach);
    }
    scene
}

fn solved(scene: &Scene) -> Result<Option<Solver>, SceneError> {
    let mut solver = Solver::new(scene.problem()?);
    while solver.advance(&mut || false) == Progress::Working {}
    Ok((solver.verdict() == Verdict::Converged).then_some(solver))
}

/// The limit of the grids at the nodes of a grid.
fn finer(case: Case, nodes_per_side: usize) -> Result<Option<Vec<DVec3>>, SceneError> {
    let [coarse, fine] = REFERENCE_GRIDS;
    let on = |n: usize| solved(&placed(case, true, n, REFERENCE_TOLERANCE));
    let (Some(a), Some(b)) = (on(coarse)?, on(fine)?) else { return Ok(None) };
    let at = |solver: &Solver, n: usize, k: usize| {
        let ratio = (n - 1) / (nodes_per_side - 1);
        let [i, j] = [k % nodes_per_side, k / nodes_per_side].map(|index| index * ratio);
        solver.positions()[j * n + i]
    };
    let limit = |k: usize| {
        let [a, b] = [at(&a, coarse, k), at(&b, fine, k)];
        b + (b - a) / 3.0
    };
    Ok(Some((0..nodes_per_side * nodes_per_side).map(limit).collect()))
}

fn name(face: Face, row: &Row) -> &'static str {
    match (face, row.cells_through) {
        (_, None) => "sheet",
        (Face::Inner, _) => "inner",
        (Face::Skin, _) => "skin",
    }
}

/// Writes the rows as CSV with a line of column names; errors relative to the base radius.
#[must_use]
pub fn csv(rows: &[Row]) -> String {
    let mut csv = String::from(
        "scene,off_centre,nodes_per_side,cells_through,face,profile_error,greatest_error,mean_error,\
         at_pocket_radius\n",
    );
    for row in rows {
        for (face, errors) in &row.faces {
            let cells = row.cells_through.map(|cells| cells.to_string()).unwrap_or_default();
            let Errors { profile, greatest, mean, at } = errors;
            // Writing to a String cannot fail.
            let _ = writeln!(
                csv,
                "{},{},{},{cells},{},{profile:.3e},{greatest:.3e},{mean:.3e},{at:.3}",
                row.case.name(),
                row.is_off_centre,
                row.nodes_per_side,
                name(*face, row),
            );
        }
    }
    csv
}

/// Writes the rows as a table in Markdown; errors in per cent of the base radius.
#[must_use]
pub fn markdown(rows: &[Row]) -> String {
    let mut text = String::from(
        "| scene | dome | face | nodes per side | cells | row through the centre | all nodes | root mean square | greatest at / \
         pocket's radius |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for row in rows {
        for (face, errors) in &row.faces {
            let cells = row.cells_through.map_or("–".to_owned(), |cells| cells.to_string());
            let [profile, greatest, mean] =
                [errors.profile, errors.greatest, errors.mean].map(|error| 100.0 * error);
            let _ = writeln!(
                text,
                "| `{}` | {} | {} | {} | {cells} | {profile:.4} % | {greatest:.4} % | {mean:.4} % | {:.2} |",
                row.case.name(),
                if row.is_off_centre { "off centre" } else { "centred" },
                name(*face, row),
                row.nodes_per_side,
                errors.at,
            );
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_all_nodes_contain_those_of_the_profile_and_fall_with_the_spacing() {
        let row = |nodes: usize| measure(Case::LinearThird, false, nodes).unwrap().unwrap();
        let rows = [row(33), row(65)];
        let [coarse, fine] = [&rows[0], &rows[1]].map(|row| row.faces[0].1);
        for errors in [coarse, fine] {
            assert!(errors.profile <= errors.greatest && errors.mean < errors.greatest);
        }
        assert!(fine.greatest < 0.5 * coarse.greatest && coarse.greatest < 5e-3, "{coarse:?}");
        let layered = measure(Case::LayeredLinear, false, 33).unwrap().unwrap();
        assert_eq!((layered.faces.len(), layered.cells_through), (2, Some(2)));
        assert!(layered.faces[1].1.greatest < 0.01, "{layered:?}");
        let rows = [rows[0].clone(), layered];
        assert!(csv(&rows).lines().all(|line| line.split(',').count() == 9));
        assert_eq!(markdown(&rows).lines().count(), 2 + 1 + 2);
    }
}

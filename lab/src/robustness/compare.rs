//! Other solution paths to the equilibrium of a scene.

use super::check::{Finding, distance, require_at_most};
use super::{MAX_DISTANCE, nodes};
use glam::{DVec2, DVec3};
use implant_preview_core::scene::Scene;
use implant_preview_core::solve::{Method, Options, Solver, Verdict};

/// Tolerance of a confirming solve \[fraction of the tolerance\]. Two distant solutions are two equilibria if
/// each confirming solve ends within half of the greatest distance, its own estimated error included.
const CONFIRMATION_TOLERANCE: f64 = 0.1;
/// Factor on the work limits of a confirming solve.
const CONFIRMATION_WORK_FACTOR: f64 = 10.0;
/// Least tolerance of layered tissue, the resolution of f32 \[base radius\].
const MIN_LAYERED_TOLERANCE: f64 = 2e-6;
/// Slices of each interrupted solve before an edit.
const SLICES_BEFORE_EDIT: u32 = 12;

/// Another solution path.
struct Path {
    check: &'static str,
    /// Is the scene mirrored? A centred dome has the same scene.
    is_mirrored: bool,
    /// Had the solver interrupted solves of other scenes before?
    is_used: bool,
    options: Options,
    /// Factor on the tolerance.
    factor: f64,
}

impl Path {
    fn all(is_layered: bool) -> [Self; 2] {
        let whole = Options { use_symmetry: false, ..Options::default() };
        let path = |check, options| Self {
            check,
            is_mirrored: false,
            is_used: false,
            options,
            factor: 1.0,
        };
        let mirrored = Self {
            is_mirrored: true,
            ..path("distance to the solution of the mirrored scene, mm", whole)
        };
        if is_layered {
            let check = "distance to the solution with a tenth of the tolerance after edits, mm";
            let after_edits = Self {
                is_used: true,
                factor: CONFIRMATION_TOLERANCE,
                ..path(check, Options::default())
            };
            [after_edits, mirrored]
        } else {
            let newton = Options { method: Method::Newton, ..whole };
            [path("distance to Newton's solution, mm", newton), mirrored]
        }
    }

    /// Solves a scene on this path; `None` if the scene is invalid.
    fn solve(&self, scene: &Scene) -> Option<Solver> {
        if !self.is_used {
            return solve_to(scene, self.options, self.factor);
        }
        let mut edited = scene.clone();
        edited.insertion = 1.0 - 0.5 * scene.insertion;
        let mut solver = Solver::with_options(edited.problem().ok()?, self.options);
        edited.implant.projection_mm = 0.5 * (scene.implant.projection_mm + 10.0);
        for scene in [Some(&edited), None] {
            let mut slices = 0;
            solver.advance(&mut || {
                slices += 1;
                slices >= SLICES_BEFORE_EDIT
            });
            if let Some(scene) = scene {
                solver.restart(scene.problem().ok()?);
            }
        }
        let mut problem = scene.problem().ok()?;
        problem.tolerance = to(scene, self.factor);
        solver.restart(problem);
        solver.advance(&mut || false);
        Some(solver)
    }
}

/// The tolerance of a scene times `factor`.
fn to(scene: &Scene, factor: f64) -> f64 {
    let tolerance = scene.solver.tolerance;
    let least = if scene.is_layered() { MIN_LAYERED_TOLERANCE.min(tolerance) } else { 0.0 };
    (tolerance * factor).max(least)
}

/// Solves a scene with its tolerance times `factor`; `None` if the scene is invalid.
fn solve_to(scene: &Scene, options: Options, factor: f64) -> Option<Solver> {
    let mut problem = scene.problem().ok()?;
    problem.tolerance = to(scene, factor);
    let mut solver = Solver::with_options(problem, options);
    solver.advance(&mut || false);
    Some(solver)
}

/// Compares the solution with those of two other solution paths: of a sheet Newton's solution, of layered tissue the
/// solution of a solver after edits, with a tenth of the tolerance; of either the solution of the mirrored scene on the
/// whole grid.
///
/// Returns `true` if confirming solves show several equilibria, and the number of converged comparisons.
pub(super) fn compare_solutions(
    scene: &Scene,
    solver: &Solver,
    findings: &mut Vec<Finding>,
) -> (bool, u32) {
    let tolerance = MAX_DISTANCE * solver.problem().tolerance * scene.implant.base_radius_mm;
    // A node at the contact edge may have a contact offset in one solution and none in the other.
    let offsets =
        solver.offset_nodes().iter().map(|&(k, offset)| offset.distance(solver.positions()[k]));
    let allowed = tolerance + offsets.fold(0.0, f64::max);
    // The confirming solve may end above its own tolerance. From scratch it may end in another equilibrium; from the shape itself
    // it stays on its branch.
    let is_confirmed = |scene: &Scene, options: Options, ended: &Solver| {
        let options = Options { work_limit_factor: CONFIRMATION_WORK_FACTOR, ..options };
        let is_close = |confirming: &Solver| {
            let error = confirming.estimated_position_error() * scene.implant.base_radius_mm;
            2.0 * (error + distance(&nodes(confirming), &nodes(ended))) <= tolerance
        };
        solve_to(scene, options, CONFIRMATION_TOLERANCE).is_some_and(|other| is_close(&other))
            || scene.is_layered()
                && is_close(
                    &ended.refined(to(scene, CONFIRMATION_TOLERANCE), CONFIRMATION_WORK_FACTOR),
                )
    };
    // The scene mirrored about the diagonal, over a chest, whose radii differ, about the body's axis; for a centred dome the
    // same scene on the whole sheet.
    let mut mirrored = scene.clone();
    let has_axis = scene.chest.is_some() || !scene.implant.is_round();
    if has_axis {
        mirrored.implant.center_mm[0] *= -1.0;
        if let Some(field) = &mut mirrored.thickness_field {
            let rows = field.factors.chunks(field.columns);
            field.factors = rows.flat_map(|row| row.iter().rev().copied()).collect();
        }
    } else {
        mirrored.implant.center_mm.reverse();
    }
    let n = solver.problem().sheet().nodes_per_side();
    let mirror = |x: &[DVec3]| -> Vec<DVec3> {
        let image = |layer: &[DVec3], k: usize| {
            let (i, j) = (k % n, k / n);
            let at = layer[if has_axis { j * n + n - 1 - i } else { i * n + j }];
            if has_axis { at.with_x(-at.x) } else { DVec2::new(at.y, at.x).extend(at.z) }
        };
        x.chunks(n * n).flat_map(|layer| (0..n * n).map(move |k| image(layer, k))).collect()
    };
    let solution = nodes(solver);
    let (mut is_one_of_several, mut compared) = (false, 0);
    for path in Path::all(scene.is_layered()) {
        let compared_scene = if path.is_mirrored { &mirrored } else { scene };
        let other = path.solve(compared_scene);
        let Some(other) = other.filter(|other| other.verdict() == Verdict::Converged) else {
            continue;
        };
        compared += 1;
        let at = nodes(&other);
        let apart = distance(&solution, &if path.is_mirrored { mirror(&at) } else { at });
        if apart > allowed
            && is_confirmed(scene, Options::default(), solver)
            && is_confirmed(compared_scene, path.options, &other)
        {
            is_one_of_several = true;
        } else {
            require_at_most(findings, path.check, apart, allowed);
        }
    }
    (is_one_of_several, compared)
}

//! Robustness tests: random scenes and edit sequences checked against invariants.
//!
//! `scenes` (random sheets) | `layered_scenes` (random layered tissue) | `chest` (chests with other implants and mounds, and the fullness) |
//! `terrain` (walls and mounds of bodies) | `check`, `check_layered` (invariants) | `clinical` (random patients) | `compare` (other solution paths) | `edits` (random sessions) | `shrink` (reduction of a failing scene) | `summary`.
//! A case depends on population, seed and number alone: equal on every machine and in every order.

pub mod check;
mod check_layered;
mod chest;
pub mod clinical;
mod compare;
mod edits;
mod layered_scenes;
mod scenes;
mod shrink;
mod summary;
mod terrain;

pub use summary::{Endings, LayeredSummary, PopulationSummary, Summary};

use check::Finding;
use fastrand::Rng;
use glam::DVec3;
use implant_preview_core::scene::{Scene, Springs};
use implant_preview_core::solve::{Invalid, Options, Solver, Verdict};
use serde::Serialize;

/// Greatest number of nodes per side of a scene that is solved by other solution paths as well.
const MAX_NODES_COMPARED: usize = 129;
/// Number of cases per session of random edits.
const CASES_PER_SESSION: u64 = 10;
/// Greatest distance between two solutions of one equilibrium \[tolerances\]; the estimated error of each
/// solution is at most one.
const MAX_DISTANCE: f64 = 4.0;

/// The kind of random scenes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Population {
    /// Sheets within all limits.
    #[default]
    Sheet,
    /// Layered tissue within the ranges of patients and implants.
    Realistic,
    /// Layered tissue within all limits.
    Extreme,
    /// [`Self::Realistic`] over the chests of patients.
    RealisticChest,
    /// [`Self::Extreme`] over chests within all limits.
    ExtremeChest,
}

impl Population {
    /// The population of a case of layered tissue: realistic and extreme in turn, with and without a session.
    #[must_use]
    pub fn of_layered(case: u64, has_chest: bool) -> Self {
        match ((case + case / CASES_PER_SESSION) % 2 == 1, has_chest) {
            (false, false) => Self::Realistic,
            (true, false) => Self::Extreme,
            (false, true) => Self::RealisticChest,
            (true, true) => Self::ExtremeChest,
        }
    }

    fn is_sheet(&self) -> bool {
        *self == Self::Sheet
    }

    fn is_extreme(self) -> bool {
        matches!(self, Self::Extreme | Self::ExtremeChest)
    }

    /// A random scene.
    fn scene(self, rng: &mut Rng) -> Scene {
        let mut scene = match self {
            Self::Sheet => scenes::scene(rng),
            Self::Realistic | Self::RealisticChest => layered_scenes::realistic(rng),
            Self::Extreme | Self::ExtremeChest => layered_scenes::extreme(rng),
        };
        self.put_on_chest(rng, &mut scene);
        chest::fullness(rng, &mut scene);
        scene
    }

    /// Gives layered tissue another chest, where scenes have one.
    fn put_on_chest(self, rng: &mut Rng, scene: &mut Scene) {
        match self {
            Self::RealisticChest if scene.is_layered() => chest::patient(rng, scene),
            Self::ExtremeChest if scene.is_layered() => chest::any(rng, scene),
            _ => {}
        }
    }
}

/// Outcome of the solve of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// The solution is within the tolerance and satisfies every check.
    Converged,
    /// As [`Self::Converged`], to one of several equilibria: another solution path converges to another
    /// equilibrium, both confirmed with a smaller tolerance. Compressive sheets wrinkle to either side.
    Several,
    /// The solver reports an error above the tolerance.
    NotConverged,
    /// The solver reports loss of stability (the paper's springs), or found no shape (layered tissue).
    Unstable,
    /// The solver reports a penetrated sheet: the grid is too coarse, or soft tissue yields at the tip.
    Pierced,
    /// A check failed.
    Failed,
}

/// One case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Case {
    /// The number of the case.
    pub case: u64,
    /// The kind of scenes; omitted for sheets.
    #[serde(skip_serializing_if = "Population::is_sheet")]
    pub population: Population,
    /// Outcome of the solve.
    pub ending: Ending,
    /// Failed checks.
    pub findings: Vec<Finding>,
    /// `true` if Newton's method, or the second attempt of layered tissue, replaced full multigrid.
    pub fell_back: bool,
    /// Work \[evaluations of all forces on the finest grid\].
    pub work_units: f64,
    /// Time of the solve \[ms\]; omitted without a clock.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_ms: Option<f64>,
    /// Least volume ratio in the middle of a cell of layered tissue \[-\]; omitted without cells or without a shape.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub least_volume_ratio: Option<f64>,
    /// Cells of layered tissue with an inverted corner; omitted where no cell has one.
    #[serde(skip_serializing_if = "is_zero")]
    pub inverted_corners: usize,
    /// The solver's estimated position error, relative to the base radius; `None` without an estimate.
    pub estimated_position_error: Option<f64>,
    /// Number of other solution paths that converged (at most two).
    pub ways: u32,
    /// `true` if the case includes a session of random edits.
    pub in_session: bool,
    /// The scene; the scene of a failure is reduced.
    pub scene: Scene,
}

/// The random number generator of a case.
fn random(seed: u64, case: u64) -> Rng {
    Rng::with_seed(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(case))
}

/// The random sheet of a case with at most `most_nodes` nodes per side.
#[must_use]
pub fn scene(seed: u64, case: u64, most_nodes: usize) -> Scene {
    scene_of(Population::Sheet, seed, case, most_nodes)
}

/// The random scene of a case of a population with at most `most_nodes` nodes per side.
#[must_use]
pub fn scene_of(population: Population, seed: u64, case: u64, most_nodes: usize) -> Scene {
    let mut scene = population.scene(&mut random(seed, case));
    scene.solver.nodes_per_side = scene.solver.nodes_per_side.min(most_nodes);
    scene
}

/// Runs a case of a sheet; see [`run_of`].
#[must_use]
pub fn run(seed: u64, case: u64, most_nodes: usize) -> Case {
    run_of(Population::Sheet, seed, case, most_nodes, None)
}

/// A clock \[ms\].
pub type Clock<'a> = Option<&'a dyn Fn() -> f64>;

/// Runs a case: its scene by several solution paths, and in every tenth case a session of random edits.
#[must_use]
pub fn run_of(
    population: Population,
    seed: u64,
    case: u64,
    most_nodes: usize,
    clock: Clock,
) -> Case {
    let mut outcome = examine_timed(scene_of(population, seed, case, most_nodes), clock);
    (outcome.case, outcome.population) = (case, population);
    if outcome.ending == Ending::Failed {
        outcome.scene =
            shrink::shrink(&outcome.scene, |scene| examine(scene.clone()).ending == Ending::Failed);
    }
    if case.is_multiple_of(CASES_PER_SESSION) {
        outcome.in_session = true;
        let findings = edits::run(&mut random(!seed, case), population);
        if !findings.is_empty() {
            outcome.ending = Ending::Failed;
            outcome.findings.extend(findings);
        }
    }
    outcome
}

/// The failed case whose run panicked; its session may be the cause.
#[must_use]
pub fn panicked(population: Population, seed: u64, case: u64, most_nodes: usize) -> Case {
    Case {
        case,
        population,
        findings: vec![Finding { check: "panic", found: 1.0, allowed: 0.0 }],
        in_session: case.is_multiple_of(CASES_PER_SESSION),
        ..Case::of(scene_of(population, seed, case, most_nodes))
    }
}

impl Case {
    /// A failed case without findings.
    fn of(scene: Scene) -> Self {
        Self {
            case: 0,
            population: Population::default(),
            ending: Ending::Failed,
            findings: Vec::new(),
            fell_back: false,
            work_units: 0.0,
            time_ms: None,
            least_volume_ratio: None,
            inverted_corners: 0,
            estimated_position_error: None,
            ways: 0,
            in_session: false,
            scene,
        }
    }

    /// Sets what a solver reports; a case with findings has failed.
    fn end(&mut self, solver: &Solver, is_one_of_several: bool) {
        let error = solver.estimated_position_error();
        let is_pierced = solver.invalid() == Some(Invalid::Penetrated);
        self.ending = match (self.findings.is_empty(), solver.verdict()) {
            (false, _) => Ending::Failed,
            (_, Verdict::Converged) if is_one_of_several => Ending::Several,
            (_, Verdict::Converged) => Ending::Converged,
            (_, Verdict::NotConverged) => Ending::NotConverged,
            (_, Verdict::Unstable) if is_pierced => Ending::Pierced,
            (_, Verdict::Unstable) => Ending::Unstable,
        };
        self.fell_back = solver.fell_back();
        self.work_units = solver.work_units();
        self.estimated_position_error = error.is_finite().then_some(error);
    }
}

/// Solves a scene and checks the solution against all invariants.
#[must_use]
pub fn examine(scene: Scene) -> Case {
    examine_timed(scene, None)
}

/// As [`examine`]; with a clock the case contains the time of the solve.
#[must_use]
pub fn examine_timed(scene: Scene, clock: Clock) -> Case {
    let start = clock.map(|clock| clock());
    let solver = solve(&scene, Options::default());
    let time_ms = clock.zip(start).map(|(clock, start)| clock() - start);
    let mut case = Case { time_ms, ..Case::of(scene) };
    let Some(solver) = solver else {
        case.findings = vec![Finding { check: "valid scene rejected", found: 1.0, allowed: 0.0 }];
        return case;
    };
    if case.scene.is_layered() {
        let checked = check_layered::check(&solver);
        case.findings = checked.findings;
        case.least_volume_ratio = checked.least_volume_ratio;
        case.inverted_corners = checked.inverted_corners;
    } else {
        case.findings = check::check(&solver);
    }
    let mut is_one_of_several = false;
    if solver.verdict() == Verdict::Converged
        && case.scene.springs == Springs::Coupled
        && solver.problem().sheet().nodes_per_side() <= MAX_NODES_COMPARED
        && solver.work_units() > 0.0
    {
        (is_one_of_several, case.ways) =
            compare::compare_solutions(&case.scene, &solver, &mut case.findings);
    }
    case.end(&solver, is_one_of_several);
    case
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "the signature that serde calls")]
fn is_zero(count: &usize) -> bool {
    *count == 0
}

/// Solves a scene to the end; `None` if the scene is invalid.
fn solve(scene: &Scene, options: Options) -> Option<Solver> {
    let mut solver = Solver::with_options(scene.problem().ok()?, options);
    solver.advance(&mut || false);
    Some(solver)
}

/// The layers of nodes of a solver, the inner face first \[mm\], shape (layers, nodes_per_side²); one layer for a sheet.
fn layers(solver: &Solver) -> impl Iterator<Item = &[DVec3]> {
    std::iter::once(solver.positions()).chain(solver.outer().iter().map(Vec::as_slice))
}

/// Positions of all nodes, layer by layer \[mm\].
fn nodes(solver: &Solver) -> Vec<DVec3> {
    layers(solver).flatten().copied().collect()
}

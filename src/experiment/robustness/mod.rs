//! Robustness tests: random scenes and edit sequences checked against invariants.
//!
//! `scenes` (random scenes) | `check` (invariants) | `edits` (random sessions) | `shrink` (reduction of a
//! failing scene). A case depends on seed and number alone: equal on every machine and in every order.

pub mod check;
mod edits;
mod scenes;
mod shrink;

use crate::scene::{Scene, Springs};
use crate::solve::{Invalid, Method, Options, Solver, Verdict};
use check::{Finding, distance, require_at_most};
use fastrand::Rng;
use glam::{DVec2, DVec3};
use serde::Serialize;

/// Greatest number of nodes per side of a scene that is solved by other solution paths as well.
const MAX_NODES_COMPARED: usize = 129;
/// Number of cases per session of random edits.
const CASES_PER_SESSION: u64 = 10;
/// Greatest distance between two solutions of one equilibrium \[tolerances\]; the estimated error of each
/// solution is at most one.
const MAX_DISTANCE: f64 = 4.0;
/// Tolerance of a confirming solve \[fraction of the tolerance\]. Two distant solutions are two equilibria if
/// each confirming solve ends within half of the greatest distance, its own estimated error included.
const CONFIRMATION_TOLERANCE: f64 = 0.1;
/// Factor on the work limits of a confirming solve.
const CONFIRMATION_WORK_FACTOR: f64 = 10.0;

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
    /// The solver reports loss of stability (the paper's springs).
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
    /// Outcome of the solve.
    pub ending: Ending,
    /// Failed checks.
    pub findings: Vec<Finding>,
    /// `true` if Newton's method replaced full multigrid.
    pub fell_back: bool,
    /// Work \[evaluations of all forces on the finest grid\].
    pub work_units: f64,
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

/// The random scene of a case with at most `most_nodes` nodes per side.
#[must_use]
pub fn scene(seed: u64, case: u64, most_nodes: usize) -> Scene {
    let mut scene = scenes::scene(&mut random(seed, case));
    scene.solver.nodes_per_side = scene.solver.nodes_per_side.min(most_nodes);
    scene
}

/// Runs a case: its scene by several solution paths, and in every tenth case a session of random edits.
#[must_use]
pub fn run(seed: u64, case: u64, most_nodes: usize) -> Case {
    let mut outcome = examine(scene(seed, case, most_nodes));
    outcome.case = case;
    if outcome.ending == Ending::Failed {
        outcome.scene =
            shrink::shrink(&outcome.scene, |scene| examine(scene.clone()).ending == Ending::Failed);
    }
    if case.is_multiple_of(CASES_PER_SESSION) {
        outcome.in_session = true;
        let findings = edits::run(&mut random(!seed, case));
        if !findings.is_empty() {
            outcome.ending = Ending::Failed;
            outcome.findings.extend(findings);
        }
    }
    outcome
}

/// Solves a scene and checks the solution against all invariants.
#[must_use]
pub fn examine(scene: Scene) -> Case {
    let Some(solver) = solve(&scene, Options::default()) else {
        let rejected = Finding { check: "valid scene rejected", found: 1.0, allowed: 0.0 };
        return Case {
            case: 0,
            ending: Ending::Failed,
            findings: vec![rejected],
            fell_back: false,
            work_units: 0.0,
            estimated_position_error: None,
            ways: 0,
            in_session: false,
            scene,
        };
    };
    let mut findings = check::check(&solver);
    let (mut is_one_of_several, mut ways) = (false, 0);
    if solver.verdict() == Verdict::Converged
        && scene.springs == Springs::Coupled
        && solver.problem().sheet.nodes_per_side() <= MAX_NODES_COMPARED
        && solver.work_units() > 0.0
    {
        (is_one_of_several, ways) = compare_solutions(&scene, &solver, &mut findings);
    }
    let error = solver.estimated_position_error();
    Case {
        case: 0,
        ending: match (findings.is_empty(), solver.verdict()) {
            (false, _) => Ending::Failed,
            (_, Verdict::Converged) if is_one_of_several => Ending::Several,
            (_, Verdict::Converged) => Ending::Converged,
            (_, Verdict::NotConverged) => Ending::NotConverged,
            (_, Verdict::Unstable) if solver.invalid() == Some(Invalid::Penetrated) => {
                Ending::Pierced
            }
            (_, Verdict::Unstable) => Ending::Unstable,
        },
        findings,
        fell_back: solver.fell_back(),
        work_units: solver.work_units(),
        estimated_position_error: error.is_finite().then_some(error),
        ways,
        in_session: false,
        scene,
    }
}

/// Solves a scene to the end; `None` if the scene is invalid.
fn solve(scene: &Scene, options: Options) -> Option<Solver> {
    solve_to(scene, options, 1.0)
}

/// Solves a scene with its tolerance times `factor`; `None` if the scene is invalid.
fn solve_to(scene: &Scene, options: Options, factor: f64) -> Option<Solver> {
    let mut problem = scene.problem().ok()?;
    problem.tolerance *= factor;
    let mut solver = Solver::with_options(problem, options);
    solver.advance(&mut || false);
    Some(solver)
}

/// Compares the solution with Newton's solution and with the solution of the mirrored scene.
///
/// Returns `true` if confirming solves show several equilibria, and the number of converged comparisons.
fn compare_solutions(scene: &Scene, solver: &Solver, findings: &mut Vec<Finding>) -> (bool, u32) {
    let tolerance = MAX_DISTANCE * solver.problem().tolerance * scene.implant.base_radius_mm;
    // A node at the contact edge may have a contact offset in one solution and none in the other.
    let offsets =
        solver.offset_nodes().iter().map(|&(k, offset)| offset.distance(solver.positions()[k]));
    let allowed = tolerance + offsets.fold(0.0, f64::max);
    // The confirming solve may end above its own tolerance.
    let is_confirmed = |scene: &Scene, options: Options, ended: &Solver| {
        let options = Options { work_limit_factor: CONFIRMATION_WORK_FACTOR, ..options };
        solve_to(scene, options, CONFIRMATION_TOLERANCE).is_some_and(|confirming| {
            let error = confirming.estimated_position_error() * scene.implant.base_radius_mm;
            2.0 * (error + distance(confirming.positions(), ended.positions())) <= tolerance
        })
    };
    let whole = Options { use_symmetry: false, ..Options::default() };
    let newton = Options { method: Method::Newton, ..whole };
    // The scene mirrored about the diagonal; for a centred dome the same scene on the whole sheet.
    let mut mirrored = scene.clone();
    mirrored.implant.center_mm.reverse();
    let n = solver.problem().sheet.nodes_per_side();
    let mirror = |x: &[DVec3]| -> Vec<DVec3> {
        let at = |k: usize| x[(k % n) * n + k / n];
        (0..n * n).map(|k| DVec2::new(at(k).y, at(k).x).extend(at(k).z)).collect()
    };
    let paths = [
        ("distance to Newton's solution, mm", false, newton),
        ("distance to the solution of the mirrored scene, mm", true, whole),
    ];
    let (mut is_one_of_several, mut compared) = (false, 0);
    for (check, is_mirrored, options) in paths {
        let compared_scene = if is_mirrored { &mirrored } else { scene };
        let other = solve(compared_scene, options);
        let Some(other) = other.filter(|other| other.verdict() == Verdict::Converged) else {
            continue;
        };
        compared += 1;
        let apart = if is_mirrored {
            distance(solver.positions(), &mirror(other.positions()))
        } else {
            distance(solver.positions(), other.positions())
        };
        if apart > allowed
            && is_confirmed(scene, Options::default(), solver)
            && is_confirmed(compared_scene, options, &other)
        {
            is_one_of_several = true;
        } else {
            require_at_most(findings, check, apart, allowed);
        }
    }
    (is_one_of_several, compared)
}

/// Numbers of cases by outcome.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Endings {
    /// All cases.
    pub cases: u64,
    /// [`Ending::Converged`].
    pub converged: u64,
    /// [`Ending::Several`].
    pub several: u64,
    /// [`Ending::NotConverged`].
    pub not_converged: u64,
    /// [`Ending::Unstable`].
    pub unstable: u64,
    /// [`Ending::Pierced`].
    pub pierced: u64,
    /// [`Ending::Failed`].
    pub failed: u64,
    /// Cases in which Newton's method replaced full multigrid.
    pub fell_back: u64,
    /// Cases with two converged comparisons.
    pub held_both_ways: u64,
}

impl Endings {
    fn add(&mut self, case: &Case) {
        self.cases += 1;
        self.fell_back += u64::from(case.fell_back);
        self.held_both_ways += u64::from(case.ways == 2);
        *match case.ending {
            Ending::Converged => &mut self.converged,
            Ending::Several => &mut self.several,
            Ending::NotConverged => &mut self.not_converged,
            Ending::Unstable => &mut self.unstable,
            Ending::Pierced => &mut self.pierced,
            Ending::Failed => &mut self.failed,
        } += 1;
    }

    /// Fraction of converged cases among the cases without a penetrated sheet \[-\].
    #[must_use]
    pub fn converged_share(&self) -> f64 {
        self.converged as f64 / (self.cases - self.pierced).max(1) as f64
    }
}

/// The summary of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// The seed.
    pub seed: u64,
    /// Scenes with coupled springs.
    pub coupled: Endings,
    /// [`Endings::converged_share`] of the scenes with coupled springs.
    pub coupled_converged_share: f64,
    /// Scenes with the paper's springs.
    pub nikolaev: Endings,
    /// Number of sessions of random edits.
    pub sessions: u64,
    /// Failed cases.
    pub failures: Vec<Case>,
    /// The ten cases with the most work, up to ten cases with several equilibria, up to ten cases that did
    /// not converge.
    pub worst: Vec<Case>,
}

/// Number of cases of each kind in [`Summary::worst`].
const WORST_CASES: usize = 10;

impl Summary {
    /// Summarises cases in their order.
    #[must_use]
    pub fn new(seed: u64, cases: &[Case]) -> Self {
        let mut summary = Self { seed, ..Self::default() };
        for case in cases {
            match case.scene.springs {
                Springs::Coupled => summary.coupled.add(case),
                Springs::Nikolaev => summary.nikolaev.add(case),
            }
            summary.sessions += u64::from(case.in_session);
        }
        summary.coupled_converged_share = summary.coupled.converged_share();
        let is = |ending: Ending| move |case: &&Case| case.ending == ending;
        summary.failures = cases.iter().filter(is(Ending::Failed)).cloned().collect();
        let mut by_work: Vec<&Case> = cases.iter().collect();
        by_work.sort_by(|a, b| b.work_units.total_cmp(&a.work_units));
        let several = cases.iter().filter(is(Ending::Several)).take(WORST_CASES);
        let unfinished = cases.iter().filter(is(Ending::NotConverged)).take(WORST_CASES);
        let worst = by_work.into_iter().take(WORST_CASES).chain(several).chain(unfinished);
        summary.worst = worst.cloned().collect();
        summary
    }
}

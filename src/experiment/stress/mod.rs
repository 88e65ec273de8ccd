//! Stress runs: random scenes and a user's random work, each held against what must always be true.
//!
//! `scenes` (what may be asked) | `check` (what must hold) | `edits` (a user's work) | `shrink` (the
//! smallest scene that still fails). A case depends on seed and number alone: the same on every machine
//! and in every order.

pub mod check;
mod edits;
mod scenes;
mod shrink;

use crate::scene::{Scene, Springs};
use crate::solve::{Invalid, Method, Options, Solver, Verdict};
use check::{Finding, distance, hold};
use fastrand::Rng;
use glam::{DVec2, DVec3};
use serde::Serialize;

/// Grids up to this many nodes a side are solved in other ways too.
const MOST_NODES_TWICE: usize = 129;
/// Every so many cases, the scene is one of a user's session.
const SESSION_EVERY: u64 = 10;
/// How far two ways to one shape may end from each other \[tolerances\]: each is within one, by estimate.
const WAYS: f64 = 4.0;
/// Two ways that end farther apart have found two equilibria if each, asked for this share of the tolerance,
/// stays within half of that of where it was, its new estimate included.
const PROOF: f64 = 0.1;
/// … and may go on this many times as long.
const PATIENCE: f64 = 10.0;

/// How the solve of a scene ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Ending {
    /// Within the tolerance, and every check holds.
    Converged,
    /// As [`Self::Converged`], to one of several equilibria: another way leads to another one, as is
    /// proven by a tighter tolerance. Slack sheets fold one way or the other.
    Several,
    /// Said to be above the tolerance.
    NotConverged,
    /// Said to have no stable shape: the paper's springs.
    Unstable,
    /// Said to be pierced: the grid too coarse for the dome, or the tissue gives way under its tip.
    Pierced,
    /// A check does not hold.
    Failed,
}

/// One case.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Case {
    /// Its number.
    pub case: u64,
    /// How the solve ended.
    pub ending: Ending,
    /// Checks that do not hold.
    pub findings: Vec<Finding>,
    /// Did Newton's method take over?
    pub fell_back: bool,
    /// Evaluations of all forces on the finest grid.
    pub work_units: f64,
    /// The solver's estimate, relative to the base radius; `None` if it has none.
    pub estimated_position_error: Option<f64>,
    /// Other ways to the shape that it was held against: of two, those that converged.
    pub ways: u32,
    /// Was it part of a session with random edits too?
    pub in_session: bool,
    /// The scene; that of a failure is shrunk.
    pub scene: Scene,
}

/// The random numbers of a case.
fn random(seed: u64, case: u64) -> Rng {
    Rng::with_seed(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(case))
}

/// The random scene of a case, of at most so many nodes a side.
#[must_use]
pub fn scene(seed: u64, case: u64, most_nodes: usize) -> Scene {
    let mut scene = scenes::scene(&mut random(seed, case));
    scene.solver.nodes_per_side = scene.solver.nodes_per_side.min(most_nodes);
    scene
}

/// Runs a case: its scene, in several ways, and every tenth time a session with random edits.
#[must_use]
pub fn run(seed: u64, case: u64, most_nodes: usize) -> Case {
    let mut of_scene = examine(scene(seed, case, most_nodes));
    of_scene.case = case;
    if of_scene.ending == Ending::Failed {
        of_scene.scene = shrink::shrink(&of_scene.scene, |scene| {
            examine(scene.clone()).ending == Ending::Failed
        });
    }
    if case.is_multiple_of(SESSION_EVERY) {
        of_scene.in_session = true;
        let findings = edits::run(&mut random(!seed, case));
        if !findings.is_empty() {
            of_scene.ending = Ending::Failed;
            of_scene.findings.extend(findings);
        }
    }
    of_scene
}

/// Solves a scene and holds the shape against everything.
#[must_use]
pub fn examine(scene: Scene) -> Case {
    let Some(solver) = solve(&scene, Options::default()) else {
        let refused =
            Finding { check: "a scene within all limits is refused", found: 1.0, allowed: 0.0 };
        return Case {
            case: 0,
            ending: Ending::Failed,
            findings: vec![refused],
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
        && solver.problem().sheet.nodes_per_side() <= MOST_NODES_TWICE
        && solver.work_units() > 0.0
    {
        (is_one_of_several, ways) = find_other_ways(&scene, &solver, &mut findings);
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

/// Solves a scene to the end; `None` if it is refused.
fn solve(scene: &Scene, options: Options) -> Option<Solver> {
    solve_to(scene, options, 1.0)
}

/// The same to a share of its tolerance.
fn solve_to(scene: &Scene, options: Options, share: f64) -> Option<Solver> {
    let mut problem = scene.problem().ok()?;
    problem.tolerance *= share;
    let mut solver = Solver::with_options(problem, options);
    solver.advance(&mut || false);
    Some(solver)
}

/// Looks for the same shape by another method and of the mirrored scene; true if they prove that the scene has
/// several; and how many of the two ways led to one.
fn find_other_ways(scene: &Scene, solver: &Solver, findings: &mut Vec<Finding>) -> (bool, u32) {
    let tolerance = WAYS * solver.problem().tolerance * scene.implant.base_radius_mm;
    // Where a node just touches or just does not, so does its lift.
    let lift =
        solver.offset_nodes().iter().map(|&(k, place)| place.distance(solver.positions()[k]));
    let allowed = tolerance + lift.fold(0.0, f64::max);
    // Does the same way end in the same place for a far smaller tolerance? It may end above that.
    let is_proven = |scene: &Scene, options: Options, ended: &Solver| {
        let options = Options { work_limit_factor: PATIENCE, ..options };
        solve_to(scene, options, PROOF).is_some_and(|proof| {
            let left = proof.estimated_position_error() * scene.implant.base_radius_mm;
            2.0 * (left + distance(proof.positions(), ended.positions())) <= tolerance
        })
    };
    let whole = Options { use_symmetry: false, ..Options::default() };
    let newton = Options { method: Method::Newton, ..whole };
    // Mirrored about the diagonal; a centred dome is then the same scene, solved on the whole sheet.
    let mut mirrored = scene.clone();
    mirrored.implant.center_mm.reverse();
    let n = solver.problem().sheet.nodes_per_side();
    let mirror = |x: &[DVec3]| -> Vec<DVec3> {
        let at = |k: usize| x[(k % n) * n + k / n];
        (0..n * n).map(|k| DVec2::new(at(k).y, at(k).x).extend(at(k).z)).collect()
    };
    let ways = [
        ("Newton's method ends elsewhere, mm", false, newton),
        ("the mirrored scene ends elsewhere, mm", true, whole),
    ];
    let (mut is_one_of_several, mut tried) = (false, 0);
    for (check, is_mirrored, options) in ways {
        let way = if is_mirrored { &mirrored } else { scene };
        let other = solve(way, options);
        let Some(other) = other.filter(|other| other.verdict() == Verdict::Converged) else {
            continue;
        };
        tried += 1;
        let apart = if is_mirrored {
            distance(solver.positions(), &mirror(other.positions()))
        } else {
            distance(solver.positions(), other.positions())
        };
        if apart > allowed
            && is_proven(scene, Options::default(), solver)
            && is_proven(way, options, &other)
        {
            is_one_of_several = true;
        } else {
            hold(findings, check, apart, allowed);
        }
    }
    (is_one_of_several, tried)
}

/// Cases that ended alike.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Endings {
    /// All of them.
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
    /// Those in which Newton's method took over.
    pub fell_back: u64,
    /// Those whose shape was held against both other ways to it.
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

    /// Converged cases among those in which the dome does not stick out of the sheet \[-\].
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
    /// [`Endings::converged_share`] of them.
    pub coupled_converged_share: f64,
    /// Scenes with the paper's springs.
    pub nikolaev: Endings,
    /// Sessions with random edits.
    pub sessions: u64,
    /// What failed.
    pub failures: Vec<Case>,
    /// The ten that took the most work, up to ten with several equilibria, up to ten that did not
    /// converge.
    pub worst: Vec<Case>,
}

/// How many cases of each kind [`Summary::worst`] has.
const WORST: usize = 10;

impl Summary {
    /// Of cases in order.
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
        let several = cases.iter().filter(is(Ending::Several)).take(WORST);
        let unfinished = cases.iter().filter(is(Ending::NotConverged)).take(WORST);
        let worst = by_work.into_iter().take(WORST).chain(several).chain(unfinished);
        summary.worst = worst.cloned().collect();
        summary
    }
}

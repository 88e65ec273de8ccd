//! Robustness tests: random scenes and sessions, and scenes that failed once.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview::scene::Scene;
use implant_preview::solve::{Progress, Solver, Verdict};
use implant_preview_lab::robustness::{
    Ending, LayeredSummary, Population, Summary, check, examine, run, run_of, scene_of,
};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

const CONTACT_OF_ONE_NODE: &str = include_str!("stress/contact-of-one-node.json");

/// Scenes that once failed, converged to a wrong position or converged prematurely, with their outcome.
const ONCE_FAILED: [(&str, &str, Ending); 37] = [
    (
        "a grid whose rows end inside a group of lanes",
        include_str!("stress/partial-lanes-on-41-node-grid.json"),
        Ending::Converged,
    ),
    (
        "slow convergence of nearly tensionless tissue beside a dome",
        include_str!("stress/slow-convergence-beside-dome.json"),
        Ending::Converged,
    ),
    (
        "slow convergence of nearly tensionless tissue beside a dome at the rim",
        include_str!("stress/slow-convergence-beside-dome-at-rim.json"),
        Ending::Converged,
    ),
    (
        "a needle that penetrates soft tissue",
        include_str!("stress/needle-penetrating-soft-tissue.json"),
        Ending::Pierced,
    ),
    (
        "a cap that penetrates the sheet between nodes",
        include_str!("stress/penetration-between-nodes.json"),
        Ending::Converged,
    ),
    ("a dome at zero insertion", include_str!("stress/zero-insertion.json"), Ending::Converged),
    (
        "no convergence at a small insertion",
        include_str!("stress/no-convergence-at-small-insertion.json"),
        Ending::Converged,
    ),
    (
        "contact lost on a dome as wide as a cell",
        include_str!("stress/lost-contact-on-narrow-dome.json"),
        Ending::Converged,
    ),
    ("a contact of one node", CONTACT_OF_ONE_NODE, Ending::Converged),
    ("slow final steps", include_str!("stress/slow-final-steps.json"), Ending::Converged),
    (
        "rounding errors of the energy on a shallow dome under a stiff toe region",
        include_str!("stress/rounding-on-shallow-dome.json"),
        Ending::Converged,
    ),
    (
        "an underestimated error of soft tissue on a steep dome",
        include_str!("stress/underestimated-error-on-steep-dome.json"),
        Ending::Converged,
    ),
    (
        "a free node at the dome that counts as active",
        include_str!("stress/free-node-counted-as-active.json"),
        Ending::Converged,
    ),
    (
        "an active node on a needle's tip",
        include_str!("stress/active-node-on-needle-tip.json"),
        Ending::Pierced,
    ),
    (
        "small steps with a large residual",
        include_str!("stress/small-steps-with-large-residual.json"),
        Ending::Converged,
    ),
    (
        "convergence reported with an error estimate above the tolerance",
        include_str!("stress/error-estimate-above-tolerance.json"),
        Ending::Converged,
    ),
    (
        "slow convergence of a compressive sheet",
        include_str!("stress/slow-convergence-under-compression.json"),
        Ending::Converged,
    ),
    (
        "an inverted corner of a cell under the paper's springs",
        include_str!("stress/inverted-cell-corner.json"),
        Ending::Converged,
    ),
    (
        "a compressive sheet with a premature stall before it wrinkles",
        include_str!("stress/premature-stall-before-wrinkling.json"),
        Ending::Converged,
    ),
    (
        "a model without the needle's curvature, far too stiff",
        include_str!("stress/overstiff-model-on-needle.json"),
        Ending::Converged,
    ),
    (
        "an unstable active node on a needle's tip",
        include_str!("stress/unstable-node-on-needle-tip.json"),
        Ending::Pierced,
    ),
    (
        "steps that raise the energy",
        include_str!("stress/steps-that-raise-the-energy.json"),
        Ending::Converged,
    ),
    (
        "a sheet that slides off a needle to either side",
        include_str!("stress/sheet-sliding-off-needle.json"),
        Ending::Pierced,
    ),
    (
        "an asymmetric shape on a centred needle",
        include_str!("stress/asymmetric-shape-on-needle.json"),
        Ending::Pierced,
    ),
    (
        "a compressive sheet that stalls before it wrinkles",
        include_str!("stress/stall-before-wrinkling.json"),
        Ending::Converged,
    ),
    (
        "near-zero stiffness after a small step",
        include_str!("stress/near-zero-stiffness-after-small-step.json"),
        Ending::Converged,
    ),
    (
        "kinks of a curve near zero strain under the paper's springs",
        include_str!("stress/kinks-near-zero-strain.json"),
        Ending::Converged,
    ),
    (
        "premature convergence of a compressive sheet beside a dome at the rim",
        include_str!("stress/premature-convergence-at-rim.json"),
        Ending::Converged,
    ),
    (
        "fallback on a flat dome by oblique projections",
        include_str!("stress/slow-fallback-on-flat-dome.json"),
        Ending::Converged,
    ),
    (
        "contact offsets that raise the energy above the initial energy",
        include_str!("stress/contact-offsets-above-initial-energy.json"),
        Ending::Converged,
    ),
    (
        "two equilibria of soft tissue on a needle",
        include_str!("stress/two-equilibria-on-needle.json"),
        Ending::Several,
    ),
    (
        "near-zero stiffness of a compressive sheet before it wrinkles",
        include_str!("stress/near-zero-stiffness-before-wrinkling.json"),
        Ending::Converged,
    ),
    (
        "a path to wrinkling that contact blocks",
        include_str!("stress/path-blocked-before-wrinkling.json"),
        Ending::Converged,
    ),
    (
        "a path through strains outside of the paper's law",
        include_str!("stress/path-outside-of-the-law.json"),
        Ending::Converged,
    ),
    (
        "a shape of layered tissue without convergence, with inverted cells",
        include_str!("stress/layered-inverted-cells.json"),
        Ending::Unstable,
    ),
    (
        "150 000 force evaluations of Newton's method in layered tissue",
        include_str!("stress/layered-long-newton.json"),
        Ending::Converged,
    ),
    (
        "tight skin over a steep dome on a chest, lost after the coarsest grid",
        include_str!("stress/lost-tight-skin-over-chest.json"),
        Ending::Converged,
    ),
];

/// The cases 0 to `count` - 1, computed on all cores: their times differ a hundredfold.
fn computed<T: Send>(count: usize, case: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let next = AtomicUsize::new(0);
    let work = || -> Vec<(usize, T)> {
        let mine = || Some(next.fetch_add(1, Ordering::Relaxed)).filter(|k| *k < count);
        std::iter::from_fn(mine).map(|k| (k, case(k))).collect()
    };
    let mut cases: Vec<(usize, T)> = thread::scope(|scope| {
        let cores = thread::available_parallelism().map_or(1, usize::from);
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(work)).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap()).collect()
    });
    cases.sort_by_key(|(k, _)| *k);
    cases.into_iter().map(|(_, case)| case).collect()
}

#[test]
fn scenes_that_once_failed_have_their_expected_outcome() {
    let cases =
        computed(ONCE_FAILED.len(), |k| examine(Scene::from_json(ONCE_FAILED[k].1).unwrap()));
    for ((name, _, ending), case) in ONCE_FAILED.into_iter().zip(cases) {
        assert_eq!(case.ending, ending, "{name}: {:?}", case.findings);
    }
}

/// On coarser grids the contact is none, and their corrections lift the sheet off it.
#[test]
fn a_contact_of_one_node_needs_few_cycles() {
    let scene = Scene::from_json(CONTACT_OF_ONE_NODE).unwrap();
    let mut solver = Solver::new(scene.problem().unwrap());
    assert_eq!(solver.advance(&mut || false), Progress::Done);
    assert!(solver.verdict() == Verdict::Converged && !solver.fell_back());
    let work = solver.report().work_units;
    assert!(work < 250.0, "{work}");
}

#[test]
fn random_scenes_and_sessions_satisfy_all_invariants() {
    let cases = computed(100, |case| run(11, case as u64, 33));
    let summary = Summary::new(11, &cases);
    assert_eq!(summary.failures, []);
    assert_eq!(summary.sessions, 10);
    let coupled = summary.coupled;
    assert_eq!(coupled.cases + summary.nikolaev.cases, 100);
    assert!(coupled.converged > 60, "{coupled:?}");
    assert!(summary.coupled_converged_share >= 0.98, "{coupled:?}");
}

#[test]
fn random_layered_scenes_and_sessions_satisfy_all_invariants() {
    let of = |case| Population::of_layered(case, false);
    let cases = computed(30, |case| run_of(of(case as u64), 12, case as u64, 33, None));
    let summary = LayeredSummary::new(12, &cases);
    assert_eq!(summary.failures, []);
    assert_eq!(summary.sessions, 3);
    let (realistic, extreme) = (summary.realistic, summary.extreme);
    assert_eq!((realistic.endings.cases, extreme.endings.cases), (15, 15));
    assert!(realistic.converged_share >= 0.98, "{realistic:?}");
    assert!(realistic.endings.held_both_ways >= 12, "{realistic:?}");
    assert_eq!(realistic.max_time_ms, None);
}

#[test]
fn random_scenes_and_sessions_over_chests_satisfy_all_invariants() {
    let of = |case| Population::of_layered(case, true);
    let cases = computed(20, |case| run_of(of(case as u64), 13, case as u64, 33, None));
    let summary = LayeredSummary::new(13, &cases);
    assert_eq!(summary.failures, []);
    assert_eq!(summary.sessions, 2);
    let realistic = summary.realistic;
    assert!(realistic.endings.converged >= 9, "{realistic:?}");
    assert!(realistic.endings.held_both_ways >= 8, "{realistic:?}");
}

#[test]
fn a_random_layered_scene_depends_on_population_seed_and_number_alone() {
    for population in [Population::Realistic, Population::Extreme] {
        let of = |case| scene_of(population, 3, case, 33);
        assert_eq!(of(7), of(7));
        assert_ne!(of(7), of(8));
        assert!((0..50).all(|case| of(case).is_layered() && of(case).solver.nodes_per_side <= 33));
    }
    let sheet = scene_of(Population::Sheet, 3, 7, 33);
    assert_eq!(sheet, implant_preview_lab::robustness::scene(3, 7, 33));
    assert!(!sheet.is_layered());
}

#[test]
fn the_checks_detect_invalid_shapes() {
    let mut scene = Scene::sheet();
    scene.solver.nodes_per_side = 33;
    let solver = Solver::new(scene.problem().unwrap());
    let (sheet, dome) = (solver.problem().sheet(), &solver.problem().obstacle.dome);
    // A sheet over the dome faces outwards, an inverted sheet inwards.
    let mut x = solver.start_shape();
    assert!(check::inward_cosine(sheet, &x) < 0.0);
    x.iter_mut().for_each(|x| x.x = -x.x);
    assert!(check::inward_cosine(sheet, &x) > 0.5);
    // Before the first slice the flat sheet lies in the dome.
    assert!(solver.positions().iter().any(|x| dome.contains(*x)));
    let names: Vec<_> = check::check(&solver).iter().map(|finding| finding.check).collect();
    assert_eq!(names, ["depth in the dome, mm"]);
}

//! Robustness tests: random scenes and sessions, and scenes that failed once.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview::experiment::robustness::{Ending, Summary, check, examine, run};
use implant_preview::scene::Scene;
use implant_preview::solve::Solver;

/// Scenes that once failed, converged to a wrong position or converged prematurely, with their outcome.
const ONCE_FAILED: [(&str, &str, Ending); 33] = [
    (
        "a grid whose rows are not whole lanes",
        include_str!("stress/grid-of-41-nodes.json"),
        Ending::Converged,
    ),
    ("nearly slack tissue", include_str!("stress/slack-beside-the-dome.json"), Ending::Converged),
    (
        "nearly slack tissue, a dome at the rim",
        include_str!("stress/slack-beside-a-dome-at-the-rim.json"),
        Ending::Converged,
    ),
    (
        "tissue that gives way on a needle",
        include_str!("stress/soft-tissue-on-a-needle.json"),
        Ending::Pierced,
    ),
    ("a cap between nodes", include_str!("stress/cap-between-nodes.json"), Ending::Converged),
    ("a dome that is not in", include_str!("stress/not-in-at-all.json"), Ending::Converged),
    ("a dome that is hardly in", include_str!("stress/hardly-in.json"), Ending::Converged),
    (
        "a dome as wide as a cell",
        include_str!("stress/dome-as-wide-as-a-cell.json"),
        Ending::Converged,
    ),
    ("slow steps at last", include_str!("stress/slow-steps-at-last.json"), Ending::Converged),
    (
        "a shallow dome under a stiff toe",
        include_str!("stress/shallow-dome-stiff-toe.json"),
        Ending::Converged,
    ),
    (
        "soft tissue that slides on a steep dome",
        include_str!("stress/soft-on-a-steep-dome.json"),
        Ending::Converged,
    ),
    (
        "a node that just touches",
        include_str!("stress/node-that-just-touches.json"),
        Ending::Converged,
    ),
    (
        "a node held on a needle's tip",
        include_str!("stress/held-on-a-needles-tip.json"),
        Ending::Pierced,
    ),
    (
        "small steps while forces do not balance",
        include_str!("stress/small-steps-out-of-balance.json"),
        Ending::Converged,
    ),
    (
        "an error above the tolerance, called converged",
        include_str!("stress/estimate-above-the-tolerance.json"),
        Ending::Converged,
    ),
    (
        "a long way down a flat valley",
        include_str!("stress/valley-of-slack.json"),
        Ending::Converged,
    ),
    (
        "a corner folded under the paper's springs",
        include_str!("stress/corner-folded.json"),
        Ending::Converged,
    ),
    (
        "a slack sheet that lies still on its way to a fold",
        include_str!("stress/still-on-the-way-to-a-fold.json"),
        Ending::Converged,
    ),
    (
        "a needle for which the model without its curvature is far too stiff",
        include_str!("stress/stiff-model-on-a-needle.json"),
        Ending::Converged,
    ),
    (
        "a node that would slide off a needle's tip",
        include_str!("stress/node-that-would-slide-off.json"),
        Ending::Pierced,
    ),
    (
        "steps that lead uphill",
        include_str!("stress/steps-that-lead-uphill.json"),
        Ending::Converged,
    ),
    (
        "a sheet that slides off a needle to either side",
        include_str!("stress/slides-off-a-needle.json"),
        Ending::Pierced,
    ),
    (
        "a centred needle that came out lopsided",
        include_str!("stress/lopsided-on-a-needle.json"),
        Ending::Pierced,
    ),
    (
        "a slack sheet that halts before it folds",
        include_str!("stress/halt-before-a-fold.json"),
        Ending::Converged,
    ),
    (
        "a valley behind a quick step",
        include_str!("stress/valley-behind-a-quick-step.json"),
        Ending::Converged,
    ),
    (
        "breaks of a curve close to zero under the paper's springs",
        include_str!("stress/breaks-close-to-zero.json"),
        Ending::Converged,
    ),
    (
        "a slack sheet without a push, beside a dome at the rim",
        include_str!("stress/slack-at-the-rim.json"),
        Ending::Converged,
    ),
    (
        "a dome so flat that the way to it led far aside",
        include_str!("stress/flat-dome.json"),
        Ending::Converged,
    ),
    (
        "lifts that cost more than the start did without them",
        include_str!("stress/lifts-above-the-start.json"),
        Ending::Converged,
    ),
    (
        "soft tissue that leans to one side of a needle",
        include_str!("stress/needle-that-leans.json"),
        Ending::Several,
    ),
    (
        "a slack sheet in a valley far softer than the model",
        include_str!("stress/soft-valley-before-a-fold.json"),
        Ending::Several,
    ),
    (
        "contact in the way to a fold",
        include_str!("stress/way-blocked-before-a-fold.json"),
        Ending::Converged,
    ),
    (
        "a way through stretches that the paper's springs do not know",
        include_str!("stress/way-outside-of-the-law.json"),
        Ending::Converged,
    ),
];

#[test]
fn scenes_that_once_failed_end_as_they_should() {
    for (name, json, ending) in ONCE_FAILED {
        let case = examine(Scene::from_json(json).unwrap());
        assert_eq!(case.ending, ending, "{name}: {:?}", case.findings);
    }
}

#[test]
fn random_scenes_and_sessions_end_soundly() {
    let cases: Vec<_> = (0..100).map(|case| run(11, case, 33)).collect();
    let summary = Summary::new(11, &cases);
    assert_eq!(summary.failures, []);
    assert_eq!(summary.sessions, 10);
    let coupled = summary.coupled;
    assert_eq!(coupled.cases + summary.nikolaev.cases, 100);
    assert!(coupled.converged > 60, "{coupled:?}");
    assert!(summary.coupled_converged_share >= 0.98, "{coupled:?}");
}

#[test]
fn the_checks_see_what_is_wrong() {
    let mut scene = Scene::default();
    scene.solver.nodes_per_side = 33;
    let solver = Solver::new(scene.problem().unwrap());
    let (sheet, dome) = (&solver.problem().sheet, &solver.problem().dome);
    // A sheet over the dome faces outwards, one turned over does not.
    let mut x = solver.start_shape();
    assert!(check::inward_cosine(sheet, &x) < 0.0);
    x.iter_mut().for_each(|x| x.x = -x.x);
    assert!(check::inward_cosine(sheet, &x) > 0.5);
    // A solve that has not begun: its flat sheet lies in the dome.
    assert!(solver.positions().iter().any(|x| dome.contains(*x)));
    let names: Vec<_> = check::check(&solver).iter().map(|finding| finding.check).collect();
    assert_eq!(names, ["depth in the dome, mm"]);
}

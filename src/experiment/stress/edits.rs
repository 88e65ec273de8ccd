//! A user's random work: edits, drags there and back, jumps, undo, files good and bad, at any moment of a
//! solve.

use super::check::{Finding, distance, hold};
use super::{WAYS, scenes};
use crate::scene::{Scene, Springs};
use crate::session::{Command, Session};
use crate::solve::{Progress, Solver, Verdict};
use fastrand::Rng;

/// Commands of a session.
const COMMANDS: usize = 16;
/// Nodes a side: a session is about states, not about size.
const MOST_NODES: usize = 49;
/// Slices before a solve must have ended.
const MOST_SLICES: usize = 100_000;

/// Runs a session; gives what did not hold.
pub(super) fn run(rng: &mut Rng) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut scene = scenes::scene(rng);
    scene.solver.nodes_per_side = scene.solver.nodes_per_side.min(MOST_NODES);
    let Ok(mut session) = Session::new(scene) else {
        hold(&mut findings, "a session's first scene is refused", 1.0, 0.0);
        return findings;
    };
    for gesture in 0..COMMANDS as u64 {
        work(rng, &mut session, 2 * gesture, &mut findings);
    }
    finish(&mut session, &mut findings);
    findings
}

/// One thing that a user does.
fn work(rng: &mut Rng, session: &mut Session, gesture: u64, findings: &mut Vec<Finding>) {
    let mut scene = session.scene().clone();
    match rng.u8(0..12) {
        0 => refuse(rng, session, findings),
        1 => accept(session, Command::Undo, findings),
        2 => accept(session, Command::Redo, findings),
        3 => {
            scene = scenes::scene(rng);
            scene.solver.nodes_per_side = scene.solver.nodes_per_side.min(MOST_NODES);
            accept(session, Command::Open(scene.to_json()), findings);
        }
        // Back and forth, a slice a frame.
        4 | 5 => {
            let (middle, swing) = (rng.f64(), 0.5 * rng.f64());
            for frame in 0..20 {
                let t = middle + swing * (0.8 * f64::from(frame)).sin();
                scene.insertion = t.clamp(0.0, 1.0);
                edit(session, &scene, gesture, findings);
                slice(rng, session, findings);
            }
        }
        // Jumps.
        6 => {
            for t in [0.0, 1.0, 0.0, 1.0] {
                scene.insertion = t;
                edit(session, &scene, gesture, findings);
                slice(rng, session, findings);
            }
        }
        7 => {
            scenes::place(rng, &mut scene);
            edit(session, &scene, gesture, findings);
        }
        8 => {
            scene.layers = scenes::layers(rng);
            edit(session, &scene, gesture, findings);
        }
        9 => {
            scene.solver.nodes_per_side = scenes::nodes(rng).min(MOST_NODES);
            edit(session, &scene, gesture, findings);
        }
        10 => {
            scene.springs = if rng.bool() { Springs::Coupled } else { Springs::Nikolaev };
            edit(session, &scene, gesture, findings);
        }
        _ => {
            scene.insertion = scenes::insertion(rng);
            edit(session, &scene, gesture, findings);
        }
    }
    slice(rng, session, findings);
}

fn edit(session: &mut Session, scene: &Scene, gesture: u64, findings: &mut Vec<Finding>) {
    accept(session, Command::Edit { scene: Box::new(scene.clone()), gesture }, findings);
}

fn accept(session: &mut Session, command: Command, findings: &mut Vec<Finding>) {
    let is_refused = session.apply(command).is_err();
    hold(findings, "a good command is refused", f64::from(u8::from(is_refused)), 0.0);
}

/// What is no scene changes nothing.
fn refuse(rng: &mut Rng, session: &mut Session, findings: &mut Vec<Finding>) {
    let before = session.scene().clone();
    let mut bad = before.clone();
    let value = [f64::NAN, f64::INFINITY, -1.0, 1e308][rng.usize(0..4)];
    let command = match rng.u8(0..6) {
        0 => Command::Open("{\"implant\":{\"base_radius_mm\":".to_owned()),
        1 => {
            bad.insertion = value;
            Command::Edit { scene: Box::new(bad), gesture: 1 }
        }
        2 => {
            bad.implant.projection_mm = value;
            Command::Edit { scene: Box::new(bad), gesture: 1 }
        }
        3 => {
            bad.implant.center_mm[1] = 2.0 * bad.pocket_radius_mm;
            Command::Edit { scene: Box::new(bad), gesture: 1 }
        }
        4 => {
            bad.layers[0].poisson_ratio = value;
            Command::Edit { scene: Box::new(bad), gesture: 1 }
        }
        _ => {
            bad.layers.clear();
            Command::Edit { scene: Box::new(bad), gesture: 1 }
        }
    };
    let is_taken = session.apply(command).is_ok() || *session.scene() != before;
    hold(findings, "a bad command is taken", f64::from(u8::from(is_taken)), 0.0);
}

/// Some solving, then a look.
fn slice(rng: &mut Rng, session: &mut Session, findings: &mut Vec<Finding>) {
    let mut pieces = rng.u32(0..60);
    let (springs, before) = (session.scene().springs, session.counters().taken_back);
    session.advance(&mut || {
        pieces = pieces.saturating_sub(1);
        pieces == 0
    });
    let broken = session.shape().iter().filter(|x| !x.is_finite()).count();
    hold(findings, "nodes shown that are not finite", broken as f64, 0.0);
    // The paper's springs do fold.
    if springs == Springs::Coupled {
        let taken_back = session.counters().taken_back - before;
        hold(findings, "scenes taken back", taken_back as f64, 0.0);
    }
}

/// The shape at the end is that of the scene alone, whatever was before.
fn finish(session: &mut Session, findings: &mut Vec<Finding>) {
    let mut slices = 0;
    while session.advance(&mut || false) == Progress::Working && slices < MOST_SLICES {
        slices += 1;
    }
    hold(findings, "slices to the end", slices as f64, (MOST_SLICES - 1) as f64);
    let scene = session.scene();
    let Ok(problem) = scene.problem() else {
        return hold(findings, "a scene on the table is refused", 1.0, 0.0);
    };
    let mut cold = Solver::new(problem);
    cold.advance(&mut || false);
    let verdicts = (session.solver().verdict(), cold.verdict());
    if scene.springs == Springs::Coupled && verdicts == (Verdict::Converged, Verdict::Converged) {
        let allowed = WAYS * scene.solver.tolerance * scene.implant.base_radius_mm;
        let apart = distance(session.shape(), cold.positions());
        hold(findings, "the session ends elsewhere, mm", apart, allowed);
    }
}

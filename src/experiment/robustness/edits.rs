//! Random sessions: edits, drags, jumps, undo, valid and invalid files, at any moment of a solve.

use super::check::{Finding, distance, require_at_most};
use super::{MAX_DISTANCE, scenes};
use crate::scene::{Scene, Springs};
use crate::session::{Command, Session};
use crate::solve::{Progress, Solver, Verdict};
use fastrand::Rng;

/// Number of commands of a session.
const COMMANDS_PER_SESSION: usize = 16;
/// Greatest number of nodes per side; session states do not depend on the size of the grid.
const MAX_NODES: usize = 49;
/// Greatest number of slices of a solve.
const MAX_SLICES: usize = 100_000;

/// Runs a session and returns its failed checks.
pub(super) fn run(rng: &mut Rng) -> Vec<Finding> {
    let mut findings = Vec::new();
    let mut scene = scenes::scene(rng);
    scene.solver.nodes_per_side = scene.solver.nodes_per_side.min(MAX_NODES);
    let Ok(mut session) = Session::new(scene) else {
        require_at_most(&mut findings, "first scene of the session rejected", 1.0, 0.0);
        return findings;
    };
    for gesture in 0..COMMANDS_PER_SESSION as u64 {
        execute(rng, &mut session, 2 * gesture, &mut findings);
    }
    finish(&mut session, &mut findings);
    findings
}

/// Executes one random gesture of a user.
fn execute(rng: &mut Rng, session: &mut Session, gesture: u64, findings: &mut Vec<Finding>) {
    let mut scene = session.scene().clone();
    match rng.u8(0..12) {
        0 => apply_invalid(rng, session, findings),
        1 => apply(session, Command::Undo, findings),
        2 => apply(session, Command::Redo, findings),
        3 => {
            scene = scenes::scene(rng);
            scene.solver.nodes_per_side = scene.solver.nodes_per_side.min(MAX_NODES);
            apply(session, Command::Open(scene.to_json()), findings);
        }
        // A drag back and forth, one slice per frame.
        4 | 5 => {
            let (middle, amplitude) = (rng.f64(), 0.5 * rng.f64());
            for frame in 0..20 {
                let t = middle + amplitude * (0.8 * f64::from(frame)).sin();
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
            scenes::dome_and_pocket(rng, &mut scene);
            edit(session, &scene, gesture, findings);
        }
        8 => {
            scene.layers = scenes::layers(rng);
            edit(session, &scene, gesture, findings);
        }
        9 => {
            scene.solver.nodes_per_side = scenes::nodes(rng).min(MAX_NODES);
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
    apply(session, Command::Edit { scene: Box::new(scene.clone()), gesture }, findings);
}

fn apply(session: &mut Session, command: Command, findings: &mut Vec<Finding>) {
    let is_rejected = session.apply(command).is_err();
    require_at_most(findings, "valid command rejected", f64::from(u8::from(is_rejected)), 0.0);
}

/// Applies an invalid command, which must not change the scene.
fn apply_invalid(rng: &mut Rng, session: &mut Session, findings: &mut Vec<Finding>) {
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
    let is_accepted = session.apply(command).is_ok() || *session.scene() != before;
    require_at_most(findings, "invalid command accepted", f64::from(u8::from(is_accepted)), 0.0);
}

/// Runs a random number of solver slices and checks the displayed shape.
fn slice(rng: &mut Rng, session: &mut Session, findings: &mut Vec<Finding>) {
    let mut pieces = rng.u32(0..60);
    let (springs, before) = (session.scene().springs, session.counters().reverted);
    session.advance(&mut || {
        pieces = pieces.saturating_sub(1);
        pieces == 0
    });
    let broken = session.shape().iter().filter(|x| !x.is_finite()).count();
    require_at_most(findings, "displayed non-finite nodes", broken as f64, 0.0);
    // The paper's springs may have inverted shapes.
    if springs == Springs::Coupled {
        let reverted = session.counters().reverted - before;
        require_at_most(findings, "reverted edits", reverted as f64, 0.0);
    }
}

/// Checks that the final shape is path independent: equal to the shape of a cold solve.
fn finish(session: &mut Session, findings: &mut Vec<Finding>) {
    let mut slices = 0;
    while session.advance(&mut || false) == Progress::Working && slices < MAX_SLICES {
        slices += 1;
    }
    require_at_most(findings, "slices until the end", slices as f64, (MAX_SLICES - 1) as f64);
    let scene = session.scene();
    let Ok(problem) = scene.problem() else {
        return require_at_most(findings, "current scene rejected", 1.0, 0.0);
    };
    let mut cold = Solver::new(problem);
    cold.advance(&mut || false);
    let verdicts = (session.solver().verdict(), cold.verdict());
    if scene.springs == Springs::Coupled && verdicts == (Verdict::Converged, Verdict::Converged) {
        let allowed = MAX_DISTANCE * scene.solver.tolerance * scene.implant.base_radius_mm;
        let apart = distance(session.shape(), cold.positions());
        require_at_most(findings, "distance to the cold solve, mm", apart, allowed);
    }
}

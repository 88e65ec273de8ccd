//! Random sessions: edits, drags, jumps, undo, valid and invalid files, at any moment of a solve.

use super::check::{Finding, distance, require_at_most};
use super::{MAX_DISTANCE, Population, layered_scenes, nodes, scenes};
use fastrand::Rng;
use implant_preview_core::scene::{Layer, Scene, Springs, TissueModel};
use implant_preview_core::session::{Command, Session};
use implant_preview_core::solve::{Progress, Solver, Verdict};

/// Number of commands of a session.
const COMMANDS_PER_SESSION: usize = 16;
/// Greatest number of nodes per side; session states do not depend on the size of the grid.
const MAX_NODES: usize = 49;
/// As [`MAX_NODES`], of layered tissue.
const MAX_LAYERED_NODES: usize = 25;
/// Greatest number of slices of a solve.
const MAX_SLICES: usize = 100_000;

impl Population {
    /// Greatest number of nodes per side in a session.
    fn most_nodes(self) -> usize {
        if self == Self::Sheet { MAX_NODES } else { MAX_LAYERED_NODES }
    }

    /// A random scene of a session.
    fn session_scene(self, rng: &mut Rng) -> Scene {
        let mut scene = self.scene(rng);
        scene.solver.nodes_per_side = scene.solver.nodes_per_side.min(self.most_nodes());
        scene
    }

    fn replace_dome(self, rng: &mut Rng, scene: &mut Scene) {
        match self {
            Self::Sheet => scenes::dome_and_pocket(rng, scene),
            _ if self.is_extreme() => layered_scenes::extreme_dome(rng, scene),
            _ => layered_scenes::realistic_dome(rng, scene),
        }
        self.put_on_chest(rng, scene);
    }

    fn layers(self, rng: &mut Rng) -> Vec<Layer> {
        match self {
            Self::Sheet => scenes::layers(rng),
            _ if self.is_extreme() => layered_scenes::extreme_layers(rng),
            _ => layered_scenes::realistic_layers(rng),
        }
    }

    fn insertion(self, rng: &mut Rng) -> f64 {
        match self {
            Self::Realistic | Self::RealisticChest => layered_scenes::realistic_insertion(rng),
            Self::Sheet | Self::Extreme | Self::ExtremeChest => scenes::insertion(rng),
        }
    }

    /// Replaces the springs of a sheet; of layered tissue patch, attachment and cells, or the tissue model.
    fn replace_model(self, rng: &mut Rng, scene: &mut Scene) {
        match self {
            Self::Sheet => {
                scene.springs = if rng.bool() { Springs::Coupled } else { Springs::Nikolaev };
            }
            _ if self.is_extreme() && rng.bool() => {
                layered_scenes::body(rng, scene);
                self.put_on_chest(rng, scene);
            }
            _ => scene.set_tissue_model(if scene.is_layered() {
                TissueModel::Sheet
            } else {
                TissueModel::Layered
            }),
        }
    }
}

/// Runs a session and returns its failed checks.
pub(super) fn run(rng: &mut Rng, population: Population) -> Vec<Finding> {
    let mut findings = Vec::new();
    let scene = population.session_scene(rng);
    let Ok(mut session) = Session::new(scene) else {
        require_at_most(&mut findings, "first scene of the session rejected", 1.0, 0.0);
        return findings;
    };
    for gesture in 0..COMMANDS_PER_SESSION as u64 {
        execute(rng, population, &mut session, 2 * gesture, &mut findings);
    }
    finish(&mut session, &mut findings);
    findings
}

/// Executes one random gesture of a user.
fn execute(
    rng: &mut Rng,
    population: Population,
    session: &mut Session,
    gesture: u64,
    findings: &mut Vec<Finding>,
) {
    let mut scene = session.scene().clone();
    match rng.u8(0..12) {
        0 => apply_invalid(rng, session, findings),
        1 => apply(session, Command::Undo, findings),
        2 => apply(session, Command::Redo, findings),
        3 => {
            scene = population.session_scene(rng);
            apply(session, Command::Open(scene.to_json()), findings);
        }
        // A drag back and forth, one slice per frame.
        4 | 5 => {
            let (middle, amplitude) = (rng.f64(), 0.5 * rng.f64());
            for frame in 0..20 {
                let t = middle + amplitude * (0.8 * f64::from(frame)).sin();
                scene.insertion = t.clamp(0.0, 1.0);
                edit(session, &scene, gesture, findings);
                slice(rng, population, session, findings);
            }
        }
        // Jumps.
        6 => {
            for t in [0.0, 1.0, 0.0, 1.0] {
                scene.insertion = t;
                edit(session, &scene, gesture, findings);
                slice(rng, population, session, findings);
            }
        }
        7 => {
            population.replace_dome(rng, &mut scene);
            edit(session, &scene, gesture, findings);
        }
        8 => {
            scene.layers = population.layers(rng);
            population.put_on_chest(rng, &mut scene);
            edit(session, &scene, gesture, findings);
        }
        9 => {
            scene.solver.nodes_per_side = scenes::nodes(rng).min(population.most_nodes());
            edit(session, &scene, gesture, findings);
        }
        10 => {
            population.replace_model(rng, &mut scene);
            edit(session, &scene, gesture, findings);
        }
        _ => {
            scene.insertion = population.insertion(rng);
            edit(session, &scene, gesture, findings);
        }
    }
    slice(rng, population, session, findings);
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
fn slice(
    rng: &mut Rng,
    population: Population,
    session: &mut Session,
    findings: &mut Vec<Finding>,
) {
    let mut pieces = rng.u32(0..60);
    let (springs, before) = (session.scene().springs, session.counters().reverted);
    session.advance(&mut || {
        pieces = pieces.saturating_sub(1);
        pieces == 0
    });
    let shape = nodes(session.solver());
    let broken = shape.iter().filter(|x| !x.is_finite()).count();
    require_at_most(findings, "displayed non-finite nodes", broken as f64, 0.0);
    // The paper's springs, and layered tissue beyond physics, may have inverted shapes.
    if springs == Springs::Coupled && !population.is_extreme() {
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
        let apart = distance(&nodes(session.solver()), &nodes(&cold));
        require_at_most(findings, "distance to the cold solve, mm", apart, allowed);
    }
}

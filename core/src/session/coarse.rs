//! The solve on a coarser grid before that on the scene's own: a result within a frame while a value is dragged.
//!
//! After an edit of layered tissue with more than 65 nodes per side the grid with up to 65 is solved first, continued from its last
//! solution. Its shape and result, with the estimated error of the discretisation, are displayed until the scene's own grid has a
//! draft, which is solved from nothing: what stays on the screen does not depend on the drag.

use super::{Measured, Session, Shown, State};
use crate::measure::Fields;
use crate::scene::{CheckedScene, Scene};
use crate::simulate;
use crate::solve::{Options, Problem, Progress, Solver, Tissue, Verdict};
use std::rc::Rc;
use std::sync::Arc;

/// The most nodes per side of the coarser grid.
const MOST_NODES: usize = 65;
/// The least tolerance of the coarser grid \[base radius\]: below it the error of the grid is the greater one.
const LEAST_TOLERANCE: f64 = 1e-3;

/// The coarser grid of a session.
#[derive(Default)]
pub(super) struct Coarse {
    solver: Option<Solver>,
    /// The scene on the coarser grid, while its solve runs or its shape is displayed.
    scene: Option<Scene>,
    /// The problem on the scene's own grid, which waits for the end of the solve on the coarser one.
    pub(super) waiting: Option<Problem>,
}

impl Coarse {
    /// Ends the solve on the coarser grid and the display of its shape.
    pub(super) fn clear(&mut self) {
        (self.scene, self.waiting) = (None, None);
    }

    /// The scene on the coarser grid whose shape is displayed.
    fn displayed(&self) -> Option<&Scene> {
        self.scene.as_ref().filter(|_| self.waiting.is_none())
    }
}

/// Is a problem solved on a coarser grid first?
fn needs_coarser(problem: &Problem) -> bool {
    problem.tissue == Tissue::Layered && problem.sheet().nodes_per_side() > MOST_NODES
}

/// The scene on the coarser grid.
fn coarser(scene: &CheckedScene, problem: &Problem) -> CheckedScene {
    let mut nodes = problem.sheet().nodes_per_side();
    while nodes > MOST_NODES {
        nodes = (nodes - 1) / 2 + 1;
    }
    scene.on_grid(nodes, problem.tolerance.max(LEAST_TOLERANCE))
}

impl Session {
    /// Starts the solve of a problem: on the coarser grid first, if there is one.
    pub(super) fn start_solve(&mut self, scene: &CheckedScene, problem: Problem) {
        self.coarse.clear();
        if !needs_coarser(&problem) {
            self.solver.restart(problem);
            return;
        }
        let scene = coarser(scene, &problem);
        let own = scene.problem();
        match &mut self.coarse.solver {
            Some(solver) => drop(solver.continue_with(own)),
            None => self.coarse.solver = Some(Solver::with_options(own, Options::default())),
        }
        self.coarse.scene = Some(scene.into_scene());
        self.coarse.waiting = Some(problem);
    }

    /// Is the scene solved on a coarser grid before its own, after an edit?
    #[must_use]
    pub fn has_coarser_grid(&self) -> bool {
        needs_coarser(self.problem())
    }

    /// Is the coarser grid being solved?
    #[must_use]
    pub fn is_on_coarser_grid(&self) -> bool {
        self.is_working() && self.coarse.waiting.is_some()
    }

    /// Nodes per side of the coarser grid whose solution and result are displayed.
    #[must_use]
    pub fn coarser_nodes_per_side(&self) -> Option<usize> {
        let scene = self.coarse.displayed().filter(|_| self.is_working())?;
        Some(scene.solver.nodes_per_side)
    }

    /// Solves on the coarser grid; its end starts the solve on the scene's own.
    pub(super) fn solve_coarse(&mut self, pause: &mut dyn FnMut() -> bool) {
        let Some(solver) = &mut self.coarse.solver else { return };
        let work = solver.work_units();
        let progress = solver.advance(pause);
        let work = solver.work_units() - work;
        let is_solved = solver.verdict() == Verdict::Converged;
        let solution = (progress == Progress::Done && is_solved).then(|| solver.solution());
        self.count(|c| {
            c.slices += 1;
            c.coarse_work_units += work;
        });
        if progress == Progress::Working {
            return;
        }
        if let Some(problem) = self.coarse.waiting.take() {
            self.solver.restart(problem);
        }
        let Some(solution) = solution else { return self.coarse.clear() };
        self.reshaped();
        self.fields = Rc::new(Fields::new(Arc::new(solution))).into();
        self.count(|c| {
            c.solutions += 1;
            c.previews += 1;
        });
        self.state = State::Solving(Shown::NewDraft);
    }

    /// Measures the displayed shape.
    pub(super) fn measure(&mut self) {
        let scene = self.coarse.displayed().unwrap_or(&self.scene);
        let outcome = simulate::measure(scene, self.fields());
        self.measured = Some(Measured { outcome, previous: None });
        self.count(|c| c.measurements += 1);
    }
}

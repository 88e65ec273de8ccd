//! The solve on a coarser grid before that on the scene's own: a result within a frame while a value is dragged.
//!
//! After an edit of layered tissue with more than 65 nodes per side the grid with up to 65 is solved first, continued from its last
//! solution. Its shape and result, with the estimated error of the discretisation, are displayed until the scene's own grid has a
//! draft, which is solved from nothing: what stays on the screen does not depend on the drag.

use super::pace::Pace;
use super::{Measured, Session, Shown, State};
use crate::measure::Fields;
use crate::mesh::Sheet;
use crate::scene::{CheckedScene, Scene};
use crate::simulate;
use crate::solve::{Options, Problem, Progress, Solver, Tissue, Verdict};
use std::rc::Rc;
use std::sync::Arc;

/// The most and the least nodes per side of the coarser grid.
const MOST_NODES: usize = 65;
const LEAST_NODES: usize = 33;
/// The least tolerance of the coarser grid \[base radius\]: below it the error of the grid is the greater one.
const LEAST_TOLERANCE: f64 = 1e-3;

/// Distance of two nodes at rest up to which they are one \[mm\].
const SAME_PLACE_MM: f64 = 1e-6;

/// The coarser grid of a session.
#[derive(Default)]
pub(super) struct Coarse {
    solver: Option<Solver>,
    pub(super) pace: Pace,
    /// Nodes per side of the grid of the last solve; 0 before it.
    nodes: usize,
    /// Nodes per side of a grid and the error of its discretisation, of the last plan with one \[base radius\].
    known_error: Option<(usize, f64)>,
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

    /// The scene on the finest coarser grid whose solve is expected to fit a frame, else on the coarsest one, and its problem.
    fn fitting(&mut self, scene: &CheckedScene, problem: &Problem) -> (CheckedScene, Problem) {
        let coarser = |nodes: usize| (nodes - 1) / 2 + 1;
        let tolerance = problem.tolerance.max(LEAST_TOLERANCE);
        let mut nodes = problem.sheet().nodes_per_side();
        while nodes > MOST_NODES {
            nodes = coarser(nodes);
        }
        loop {
            let scene = scene.on_grid(nodes, tolerance);
            let own = scene.problem();
            if coarser(nodes) < LEAST_NODES || self.pace.fits(&own, nodes <= self.nodes) {
                self.nodes = nodes;
                return (scene, own);
            }
            nodes = coarser(nodes);
        }
    }

    /// Error of the discretisation of a grid, of second order in the spacing, as that of the last plan \[base radius\].
    fn error(&self, nodes_per_side: usize) -> Option<f64> {
        let (nodes, error) = self.known_error?;
        Some(error * ((nodes - 1) as f64 / (nodes_per_side - 1) as f64).powi(2))
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

impl Session {
    /// Starts the solve of a problem: on the coarser grid first, if there is one.
    pub(super) fn start_solve(&mut self, scene: &CheckedScene, problem: Problem) {
        if let (Some(solver), true) = (&self.coarse.solver, self.is_on_coarser_grid()) {
            // A solve that no frame has advanced shows nothing.
            let work = solver.work_units();
            if work > 0.0 {
                self.coarse.pace.note_work(work);
            }
        }
        self.coarse.clear();
        if !needs_coarser(&problem) {
            self.solver.restart(problem);
            return;
        }
        let (scene, own) = self.coarse.fitting(scene, &problem);
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
        let all = solver.work_units();
        let work = all - work;
        self.coarse.pace.add(work, solver.problem());
        let is_solved = solver.verdict() == Verdict::Converged;
        let solution = (progress == Progress::Done && is_solved).then(|| solver.solution());
        self.count(|c| {
            c.slices += 1;
            c.coarse_work_units += work;
        });
        if progress == Progress::Working {
            return;
        }
        self.coarse.pace.note_work(all);
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

    /// Notes the time of the last call of [`Self::solve`] \[s\]: an edit is solved first on the finest grid, of up to 65 nodes per side, whose solve is
    /// expected to fit a frame.
    pub fn note_time(&mut self, seconds: f64) {
        self.coarse.pace.note(seconds);
    }

    /// Notes the error of the displayed solution of the coarser grid, from the distance of its skin from that of the scene's own grid: both
    /// errors are of second order in the spacing.
    pub(super) fn note_error(&mut self) {
        let (Some(_), Some(fields)) = (self.coarse.displayed(), self.fields.get()) else { return };
        let coarse = fields.solution();
        let sheets = [coarse.problem(), self.solver.problem()].map(Problem::sheet);
        let (Some(skin), Some(fine)) = (coarse.outer().last(), self.solver.outer().last()) else {
            return;
        };
        let [n, all] = sheets.map(Sheet::nodes_per_side);
        let step = (all - 1) / (n - 1);
        // Nodes at the edge of the patch lie elsewhere on every grid.
        let places = sheets.map(Sheet::rest);
        let apart = |k: usize| {
            let own = step * (k / n * all + k % n);
            let is_same = places[0][k].distance(places[1][own]) <= SAME_PLACE_MM;
            is_same.then(|| skin[k].distance(fine[own]))
        };
        let greatest = (0..n * n).filter_map(apart).fold(0.0, f64::max);
        let error = greatest / (1.0 - (step as f64).powi(-2));
        self.coarse.known_error =
            Some((n, error / coarse.problem().obstacle.dome.reference_length()));
    }

    /// Measures the displayed shape.
    pub(super) fn measure(&mut self) {
        let scene = self.coarse.displayed().unwrap_or(&self.scene);
        let mut outcome = simulate::measure(scene, self.fields());
        let solver = &mut outcome.solver;
        if self.coarse.displayed().is_some() {
            // Off centre a solve has no estimate of its own.
            let known = self.coarse.error(solver.nodes_per_side);
            solver.estimated_discretisation_error = solver.estimated_discretisation_error.or(known);
        } else if let (None, Some(error)) =
            (self.coarse.known_error, solver.estimated_discretisation_error)
        {
            self.coarse.known_error = Some((solver.nodes_per_side, error));
        }
        self.measured = Some(Measured { outcome, previous: None });
        self.count(|c| c.measurements += 1);
    }
}

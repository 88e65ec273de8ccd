//! Newton's method on nested grids: each grid starts from the prolongated solution of the coarser grid.

use super::robust::symmetry::Mirrors;
use super::{Newton, State, prolongation};
use crate::contact::Obstacle;
use crate::mesh::Sheet;
use crate::model::membrane::law::SheetLaw;
use crate::solve::initial_guess;
use crate::springs::Springs;
use glam::DVec3;

/// Tolerance of the coarser grids, whose solutions are only starts \[base radius\].
const COARSE_TOLERANCE: f64 = 1e-3;
/// Greatest number of exact steps with the paper's springs: near an instability exact steps may continue without end.
const MAX_EXACT_STEPS: u32 = 10;
/// Iterations after which a solve from a given solution restarts on the coarsest grid.
const MAX_WARM_ITERATIONS: u32 = 8;

/// Start of a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::solve) enum Start {
    /// Initial guess on the coarsest grid.
    Cold,
    /// The current solution.
    FromSolution,
}

/// Completed checks of a converged solution.
#[derive(Clone, Copy, Debug)]
struct Checks {
    /// Has the stability of the paper's springs been checked?
    is_stability_checked: bool,
    /// Have contact offsets been computed?
    are_offsets_searched: bool,
    /// Number of exact steps.
    exact_steps: u32,
}

const UNCHECKED: Checks =
    Checks { is_stability_checked: false, are_offsets_searched: false, exact_steps: 0 };

/// Newton's method on a grid and its coarser grids.
pub(in crate::solve) struct NestedNewton {
    /// From the coarsest grid to the finest.
    levels: Vec<Newton>,
    /// The grid being solved.
    grid: usize,
    start: Start,
    mirrors: Mirrors,
    checks: Checks,
}

impl NestedNewton {
    /// Allocates the grids of a sheet and its coarser sheets. The factor multiplies iteration and work limits.
    pub(in crate::solve) fn new(sheet: &Sheet, work_limit_factor: f64) -> Self {
        let mut sheets = vec![sheet.clone()];
        while let Some(coarser) = sheets[sheets.len() - 1].coarser() {
            sheets.push(coarser);
        }
        let newton = |sheet| Newton::new(sheet, work_limit_factor);
        let levels = sheets.into_iter().rev().map(newton).collect();
        let (start, mirrors) = (Start::Cold, Mirrors::None);
        Self { levels, grid: 0, start, mirrors, checks: UNCHECKED }
    }

    /// Starts from the initial guess on the coarsest grid.
    pub(in crate::solve) fn start_cold(&mut self, obstacle: &Obstacle, mirrors: Mirrors) {
        self.mirrors = mirrors;
        self.start = Start::Cold;
        self.checks = UNCHECKED;
        self.grid = 0;
        let coarsest = &mut self.levels[0];
        coarsest.x = initial_guess::taut_profile(&coarsest.sheet, &obstacle.dome);
        coarsest.start(obstacle, mirrors);
    }

    /// Starts from positions on the finest grid.
    pub(in crate::solve) fn start_from(
        &mut self,
        x: &[DVec3],
        obstacle: &Obstacle,
        mirrors: Mirrors,
    ) {
        self.mirrors = mirrors;
        self.start = Start::FromSolution;
        self.checks = UNCHECKED;
        self.grid = self.levels.len() - 1;
        let finest = &mut self.levels[self.grid];
        finest.x.copy_from_slice(x);
        finest.start(obstacle, mirrors);
    }

    /// Does the next piece of work; `tolerance` of the finest grid \[mm\]. A state other than [`State::Working`] is the
    /// final state of the finest grid, or [`State::Unstable`] on any grid.
    pub(in crate::solve) fn step(
        &mut self,
        springs: Springs,
        law: &SheetLaw,
        obstacle: &Obstacle,
        tolerance: f64,
    ) -> State {
        let is_finest = self.is_on_finest();
        let tolerance =
            if is_finest { tolerance } else { COARSE_TOLERANCE * obstacle.dome.reference_length() };
        let level = &mut self.levels[self.grid];
        let state = level.step(law, obstacle, tolerance);
        if self.start == Start::FromSolution {
            let is_slow = state == State::Working && level.iterations > MAX_WARM_ITERATIONS;
            let has_failed = matches!(state, State::Stalled | State::Unstable | State::Saddle);
            if is_slow || has_failed {
                self.start_cold(obstacle, self.mirrors);
                return State::Working;
            }
        }
        match state {
            State::Working => State::Working,
            State::Unstable => State::Unstable,
            State::Converged | State::Stalled | State::Saddle if !is_finest => {
                self.refine(obstacle);
                State::Working
            }
            State::Saddle => State::Saddle,
            State::Converged | State::Stalled => {
                self.check(springs, law, obstacle, tolerance, state)
            }
        }
    }

    /// Prolongates the solution to the next finer grid.
    fn refine(&mut self, obstacle: &Obstacle) {
        let (coarser, finer) = self.levels.split_at_mut(self.grid + 1);
        let (coarse, fine) = (&coarser[self.grid], &mut finer[0]);
        prolongation::prolongate(&coarse.sheet, &coarse.x, &fine.sheet, &mut fine.x);
        fine.start(obstacle, self.mirrors);
        self.grid += 1;
    }

    /// Checks the final state of the finest grid; returns [`State::Working`] if the iteration has to continue.
    fn check(
        &mut self,
        springs: Springs,
        law: &SheetLaw,
        obstacle: &Obstacle,
        tolerance: f64,
        state: State,
    ) -> State {
        let level = &mut self.levels[self.grid];
        let checks = &mut self.checks;
        let is_paper = springs == Springs::Nikolaev;
        let is_converged = state == State::Converged;
        // The energy of the paper's springs has saddle points.
        if is_paper && !checks.is_stability_checked && !level.has_exact_step() {
            checks.is_stability_checked = true;
            level.begin_stability(state);
            return State::Working;
        }
        if is_converged && level.needs_exact_step(springs, law) {
            checks.exact_steps += 1;
            if is_paper && checks.exact_steps > MAX_EXACT_STEPS {
                return level.finish(law, obstacle, tolerance, State::Stalled);
            }
            // The exact step changes the shape.
            checks.is_stability_checked = false;
            level.begin_exact_step();
            return State::Working;
        }
        if is_converged && !is_paper && !checks.are_offsets_searched {
            checks.are_offsets_searched = true;
            if level.find_contact_offsets(obstacle, tolerance) {
                return State::Working;
            }
        }
        // Without convergence with contact offsets, the equilibrium without offsets is the solution.
        if !is_converged && level.drop_contact_offsets(obstacle) {
            return State::Working;
        }
        level.finish(law, obstacle, tolerance, state)
    }

    /// The finest grid.
    pub(in crate::solve) fn finest(&self) -> &Newton {
        &self.levels[self.levels.len() - 1]
    }

    /// The grid being solved, counted from 1 for the coarsest, and the number of grids.
    pub(in crate::solve) fn grid(&self) -> (usize, usize) {
        (self.grid + 1, self.levels.len())
    }

    /// Is the finest grid being solved?
    pub(in crate::solve) fn is_on_finest(&self) -> bool {
        self.grid + 1 == self.levels.len()
    }

    /// Work since the last [`Self::clear_work`] \[evaluations of all nodal forces on the finest grid\].
    pub(in crate::solve) fn work_units(&self) -> f64 {
        let finest = self.finest().sheet.len() as f64;
        let scaled = |level: &Newton| level.work_units * level.sheet.len() as f64 / finest;
        self.levels.iter().map(scaled).sum()
    }

    /// Resets the work counters.
    pub(in crate::solve) fn clear_work(&mut self) {
        self.levels.iter_mut().for_each(|level| level.work_units = 0.0);
    }
}

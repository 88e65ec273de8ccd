//! Newton's method on nested grids: each starts from the interpolated solution of the grid before.

use super::robust::symmetry::Mirrors;
use super::{Newton, State, prolongation};
use crate::contact::Obstacle;
use crate::mesh::Sheet;
use crate::model::membrane::law::SheetLaw;
use crate::solve::initial_guess;
use crate::springs::Springs;
use glam::DVec3;

/// The tolerance of coarser grids, whose solutions are starts \[base radius\].
const COARSE_TOLERANCE: f64 = 1e-3;
/// How often the exact step is followed with the paper's springs: at an instability at rest it may lead on and on.
const MAX_EXACT_STEPS: u32 = 10;
/// Iterations after which a solve from a given solution begins anew on the coarsest grid.
const MAX_WARM_ITERATIONS: u32 = 8;

/// What a solve starts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::solve) enum Start {
    /// Geometry alone, on the coarsest grid.
    Cold,
    /// The present solution.
    FromSolution,
}

/// What is left to be checked of a converged solution.
#[derive(Clone, Copy, Debug)]
struct Checks {
    /// Has the stability of the paper's springs been checked?
    is_stability_checked: bool,
    /// Have contact offsets been searched?
    are_offsets_searched: bool,
    /// How often the exact step was evaluated.
    exact_steps: u32,
}

const UNCHECKED: Checks =
    Checks { is_stability_checked: false, are_offsets_searched: false, exact_steps: 0 };

/// Newton's method on a grid and the coarser ones.
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
    /// Room for a sheet and the coarser ones. The factor multiplies iteration and work limits.
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

    /// Starts from geometry alone on the coarsest grid.
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

    /// Does the next piece of work; `tolerance` is that of the finest grid \[mm\]. The last state is
    /// the finest grid's.
    pub(in crate::solve) fn step(
        &mut self,
        springs: Springs,
        law: &SheetLaw,
        obstacle: &Obstacle,
        tolerance: f64,
    ) -> State {
        let is_finest = self.is_on_finest();
        let tolerance =
            if is_finest { tolerance } else { COARSE_TOLERANCE * obstacle.dome.base_radius };
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

    /// Interpolates the solution to the next finer grid.
    fn refine(&mut self, obstacle: &Obstacle) {
        let (coarser, finer) = self.levels.split_at_mut(self.grid + 1);
        let (coarse, fine) = (&coarser[self.grid], &mut finer[0]);
        prolongation::prolongate(&coarse.sheet, &coarse.x, &fine.sheet, &mut fine.x);
        fine.start(obstacle, self.mirrors);
        self.grid += 1;
    }

    /// Checks what the finest grid's iteration ended with; continues where a check says so.
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
            // The shape after the exact step is another one.
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
        // Where there is no equilibrium with the contact offsets, that without is the solution.
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

    /// Counts work anew.
    pub(in crate::solve) fn clear_work(&mut self) {
        self.levels.iter_mut().for_each(|level| level.work_units = 0.0);
    }
}

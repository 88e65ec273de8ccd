//! Newton's method on nested grids: each grid starts from the prolongated solution of the coarser grid. On the coarsest
//! grid the dome may rise step by step. A refinement of a solution to a small tolerance has the finest grid alone, and goes on as long
//! as its residual falls.

use super::{Case, Newton, Problem, State, System, prolongation};
use crate::contact::Obstacle;
use crate::solve::validity::{self, Invalid};
use glam::DVec3;

/// Start of a solve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::solve) enum Start {
    /// First guess on the coarsest grid.
    Cold,
    /// The current solution.
    FromSolution,
    /// The current solution, to a smaller tolerance than its own.
    Refining,
}

/// The most iterations of a refinement in which its residual falls to a tenth.
const ITERATIONS_PER_DECADE: u32 = 4;

/// Newton's method on a grid and its coarser grids.
pub(in crate::solve) struct NestedNewton<S: System> {
    /// From the coarsest grid to the finest.
    levels: Vec<Newton<S>>,
    /// The grid being solved.
    grid: usize,
    start: Start,
    /// Of a refinement: the last relative residual \[-\] that was a tenth of such a one before, and its iteration.
    decade: (f64, u32),
    /// Part of the dome's height above the wall that stands on the coarsest grid \[-\].
    raised: f64,
    checks: S::Checks,
    /// Work on all grids after which the solve ends, in the unit of [`Self::work_units`].
    max_work: f64,
    /// Scratch of the prolongation.
    scaled: Vec<DVec3>,
}

impl<S: System> NestedNewton<S> {
    /// Allocates the grids of a problem and its coarser grids. The factor multiplies iteration and work limits.
    pub(in crate::solve) fn new(problem: &Problem, work_limit_factor: f64) -> Self {
        let mut grids = vec![problem.rest.clone()];
        while let Some(coarser) = grids[grids.len() - 1].coarser()
            && coarser.sheet().nodes_per_side() > S::PARAMETERS.least_cells
        {
            grids.push(coarser);
        }
        let newton = |rest| Newton::new(rest, work_limit_factor);
        let levels: Vec<Newton<S>> = grids.into_iter().rev().map(newton).collect();
        let elements = S::elements(&levels[levels.len() - 1].grid);
        Self {
            levels,
            grid: 0,
            start: Start::Cold,
            decade: (f64::INFINITY, 0),
            raised: 1.0,
            checks: S::Checks::default(),
            max_work: S::PARAMETERS.work_of_all_grids.of(elements) * work_limit_factor,
            scaled: Vec::new(),
        }
    }

    /// Starts from the first guess on the coarsest grid.
    pub(in crate::solve) fn start_cold(&mut self, law: &S::Law, problem: &Problem) {
        self.start = Start::Cold;
        self.checks = S::Checks::default();
        self.grid = 0;
        self.raised = S::PARAMETERS.raise;
        let Newton { grid, x, .. } = &mut self.levels[0];
        S::set_first_guess(grid, &problem.obstacle, x);
        self.start_grid(law, problem);
    }

    /// Starts from positions on the finest grid, of the inner face and of the layers of nodes above.
    pub(in crate::solve) fn start_from(
        &mut self,
        start: Start,
        (inner, outer): (&[DVec3], &[Vec<DVec3>]),
        law: &S::Law,
        problem: &Problem,
    ) {
        self.start = start;
        self.decade = (f64::INFINITY, 0);
        self.checks = S::Checks::default();
        self.grid = self.levels.len() - 1;
        self.raised = 1.0;
        let [x, above @ ..] = &mut *self.levels[self.grid].x else { return };
        x.copy_from_slice(inner);
        above.iter_mut().zip(outer).for_each(|(x, outer)| x.copy_from_slice(outer));
        self.start_grid(law, problem);
    }

    /// Starts the grid being solved from its positions.
    fn start_grid(&mut self, law: &S::Law, problem: &Problem) {
        let case = self.case(law, problem);
        self.levels[self.grid].start(&case);
    }

    /// The problem on the grid being solved.
    fn case<'a>(&self, law: &'a S::Law, problem: &Problem) -> Case<'a, S::Law> {
        let (patch, mut obstacle) = (problem.patch, problem.obstacle.clone());
        let tolerance = match self.is_on_finest() {
            _ if self.raised < 1.0 => S::PARAMETERS.rising_tolerance,
            true => problem.tolerance,
            false => S::PARAMETERS.coarse_tolerance,
        };
        let tolerance = tolerance * obstacle.dome.reference_length();
        if self.raised < 1.0 {
            raise(&mut obstacle, self.raised);
        }
        let (suction_kpa, refines) = (problem.suction_kpa(), self.start == Start::Refining);
        Case { law, patch, obstacle, suction_kpa, tolerance, refines }
    }

    /// Does the next piece of work. A state other than [`State::Working`] is the final state of the finest grid, or
    /// [`State::Unstable`] on any grid.
    pub(in crate::solve) fn step(&mut self, law: &S::Law, problem: &Problem) -> State {
        if self.start == Start::Refining {
            return self.refine_solution(law, problem);
        }
        let (case, is_finest) = (self.case(law, problem), self.is_on_finest());
        if self.work_units() > self.max_work {
            return if is_finest { self.levels[self.grid].ended(&case) } else { State::Stalled };
        }
        let level = &mut self.levels[self.grid];
        let state = level.step(&case);
        if self.raised < 1.0 {
            if state != State::Working {
                self.raised = (self.raised + S::PARAMETERS.raise).min(1.0);
                self.start_grid(law, problem);
            }
            return State::Working;
        }
        let is_slow = level.iterations > S::PARAMETERS.max_warm_iterations;
        let has_failed = match state {
            State::Working => is_slow,
            State::Converged => false,
            State::Stalled | State::Unstable | State::Saddle => true,
        };
        if self.start == Start::FromSolution && has_failed {
            self.start_cold(law, problem);
            return State::Working;
        }
        match state {
            State::Working | State::Unstable => state,
            _ if !is_finest => {
                self.refine(law, problem);
                State::Working
            }
            State::Saddle => state,
            State::Converged | State::Stalled => S::check(level, &mut self.checks, &case, state),
        }
    }

    /// Does the next piece of work of a refinement. No limit of work: the solution is known, and a tolerance costs what it costs.
    fn refine_solution(&mut self, law: &S::Law, problem: &Problem) -> State {
        let case = self.case(law, problem);
        let level = &mut self.levels[self.grid];
        let state = level.step(&case);
        let Newton { relative_residual, iterations, .. } = *level;
        if relative_residual <= 0.1 * self.decade.0 {
            self.decade = (relative_residual, iterations);
        }
        let is_idle = iterations > self.decade.1 + ITERATIONS_PER_DECADE;
        match state {
            State::Working if !is_idle => state,
            State::Working | State::Stalled => level.ended(&case),
            State::Converged | State::Unstable | State::Saddle => state,
        }
    }

    /// Prolongates the solution to the next finer grid.
    fn refine(&mut self, law: &S::Law, problem: &Problem) {
        let (coarser, finer) = self.levels.split_at_mut(self.grid + 1);
        let (coarse, fine) = (&coarser[self.grid], &mut finer[0]);
        for (layer, (from, to)) in coarse.x.iter().zip(&mut fine.x).enumerate() {
            let (from, to) = ((&coarse.grid.rest, &**from), (&fine.grid.rest, &mut **to));
            prolongation::prolongate(from, to, layer, &mut self.scaled);
        }
        self.grid += 1;
        self.start_grid(law, problem);
    }

    fn finest(&self) -> &Newton<S> {
        &self.levels[self.levels.len() - 1]
    }

    /// Is the finest grid being solved?
    pub(in crate::solve) fn is_on_finest(&self) -> bool {
        self.grid + 1 == self.levels.len()
    }

    /// The grid being solved, counted from 1 for the coarsest, and the number of grids.
    pub(in crate::solve) fn grid(&self) -> (usize, usize) {
        (self.grid + 1, self.levels.len())
    }

    /// Number of changes of the finest grid's positions.
    pub(in crate::solve) fn revision(&self) -> u64 {
        self.finest().revision
    }

    pub(in crate::solve) fn relative_residual(&self) -> f64 {
        self.finest().relative_residual
    }

    /// Estimated greatest node position error of the finest grid \[mm\].
    pub(in crate::solve) fn error(&self) -> f64 {
        self.finest().error
    }

    /// See [`Newton::is_balanced`].
    pub(in crate::solve) fn is_balanced(&self) -> bool {
        self.finest().is_balanced()
    }

    /// Work since the last [`Self::clear_work`] \[evaluations of all nodal forces on the finest grid\].
    pub(in crate::solve) fn work_units(&self) -> f64 {
        let nodes = |level: &Newton<S>| level.grid.sheet().len() as f64;
        let finest = nodes(self.finest());
        self.levels.iter().map(|level| level.work_units * nodes(level) / finest).sum()
    }

    /// Resets the work counters.
    pub(in crate::solve) fn clear_work(&mut self) {
        self.levels.iter_mut().for_each(|level| level.work_units = 0.0);
    }

    /// Why the finest grid's shape is invalid; `None` for a valid shape.
    pub(in crate::solve) fn invalid(&self, problem: &Problem) -> Option<Invalid> {
        let Newton { grid, x, .. } = self.finest();
        let (of, n) = ((grid.sheet(), problem.tissue), grid.sheet().nodes_per_side());
        let at = |i: usize, j: usize| x[0][j * n + i];
        validity::invalid(of, &problem.obstacle.dome, problem.tolerance, [0; 2], at)
            .or_else(|| S::is_inverted(grid, x).then_some(Invalid::Inverted))
    }

    /// Writes the positions \[mm\] of the inner face, nodes in contact projected onto the dome, of the nodes with contact
    /// offsets, and of the layers of nodes above.
    pub(in crate::solve) fn write_positions(
        &self,
        problem: &Problem,
        inner: &mut [DVec3],
        offset_nodes: &mut Vec<(usize, DVec3)>,
        outer: &mut [Vec<DVec3>],
    ) {
        let finest = self.finest();
        inner.copy_from_slice(&finest.x[0]);
        offset_nodes.clear();
        S::write_offsets(finest, &problem.obstacle, inner, offset_nodes);
        outer.iter_mut().zip(&finest.x[1..]).for_each(|(outer, x)| outer.copy_from_slice(x));
    }
}

/// Keeps a part of the dome's height above the wall.
fn raise(obstacle: &mut Obstacle, part: f64) {
    obstacle.dome = obstacle.dome.lowered_to(part);
}

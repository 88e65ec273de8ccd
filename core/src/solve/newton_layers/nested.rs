//! Newton's method for layered tissue on nested grids: each grid starts from the prolongated solution of the coarser
//! grid.

use super::Newton;
use crate::contact::{Dome, Obstacle};
use crate::mesh::Sheet;
use crate::model::layered::LayeredLaw;
use crate::solve::newton::{State, prolongation};
use crate::solve::problem::Problem;
use crate::solve::validity::{self, Invalid};
use glam::DVec3;

/// Tolerance on the coarser grids, whose solutions are only starts \[base radius\].
const COARSE_TOLERANCE: f64 = 3e-3;
/// Tolerance while the dome rises \[base radius\].
const RISING_TOLERANCE: f64 = 3e-2;
/// Iterations after which a solve from a given solution restarts on the coarsest grid.
const MAX_WARM_ITERATIONS: u32 = 12;
/// Cells a side that the coarsest grid has at least.
const LEAST_CELLS: usize = 16;
/// Part of the dome's height that it rises at once \[-\].
const RAISE: f64 = 1.0 / 16.0;

/// Force evaluations times cells of the finest grid after which the solve ends: 4 seconds.
const MAX_CELL_WORK: f64 = 1.8e7;
/// Bounds of that limit as force evaluations: on fine grids, on coarse grids.
const WORK_LIMITS: (f64, f64) = (800.0, 15_000.0);

/// Newton's method on a grid and its coarser grids.
pub(in crate::solve) struct NestedLayers {
    /// From the coarsest grid to the finest.
    levels: Vec<Newton>,
    /// The grid being solved.
    grid: usize,
    /// Part of the dome's height above the wall that stands on the coarsest grid \[-\].
    raised: f64,
    /// Did the solve start from a solution?
    is_warm: bool,
    /// Work on all grids after which the solve ends, in the unit of [`Self::work_units`].
    max_work: f64,
}

impl NestedLayers {
    /// Allocates the grids of a sheet and its coarser sheets. The factor multiplies iteration and work limits.
    pub(in crate::solve) fn new(sheet: &Sheet, law: &LayeredLaw, work_limit_factor: f64) -> Self {
        let mut sheets = vec![sheet.clone()];
        while let Some(coarser) = sheets[sheets.len() - 1].coarser()
            && coarser.nodes_per_side() > LEAST_CELLS
        {
            sheets.push(coarser);
        }
        let newton = |sheet| Newton::new(sheet, law, work_limit_factor);
        let levels: Vec<Newton> = sheets.into_iter().rev().map(newton).collect();
        let cells = levels[levels.len() - 1].cells();
        let (least, most) = WORK_LIMITS;
        Self {
            levels,
            grid: 0,
            raised: 1.0,
            is_warm: false,
            max_work: (MAX_CELL_WORK / cells).clamp(least, most) * work_limit_factor,
        }
    }

    /// Starts at rest on the coarsest grid, where the dome rises step by step.
    pub(in crate::solve) fn start_cold(&mut self, law: &LayeredLaw, problem: &Problem) {
        self.grid = 0;
        self.raised = RAISE;
        self.is_warm = false;
        self.levels[0].put_at_rest();
        self.levels[0].start(law, problem, &raised(problem.obstacle, self.raised));
    }

    /// Starts from positions on the finest grid.
    pub(in crate::solve) fn start_from(
        &mut self,
        inner: &[DVec3],
        outer: &[Vec<DVec3>],
        law: &LayeredLaw,
        problem: &Problem,
    ) {
        self.grid = self.levels.len() - 1;
        self.raised = 1.0;
        self.is_warm = true;
        let finest = &mut self.levels[self.grid];
        finest.x[0].copy_from_slice(inner);
        for (x, outer) in finest.x[1..].iter_mut().zip(outer) {
            x.copy_from_slice(outer);
        }
        finest.start(law, problem, &problem.obstacle);
    }

    /// Does the next piece of work; `tolerance` of the finest grid \[mm\]. A state other than [`State::Working`] is the
    /// final state of the finest grid.
    pub(in crate::solve) fn step(&mut self, law: &LayeredLaw, problem: &Problem) -> State {
        if self.levels[self.grid].is_between_iterations() && self.work_units() > self.max_work {
            return State::Stalled;
        }
        let is_finest = self.is_on_finest();
        let length = problem.obstacle.dome.reference_length();
        if self.raised < 1.0 {
            let obstacle = raised(problem.obstacle, self.raised);
            let level = &mut self.levels[0];
            let tolerance = RISING_TOLERANCE * length;
            if level.step(law, problem, &obstacle, tolerance) != State::Working {
                self.raised = (self.raised + RAISE).min(1.0);
                level.start(law, problem, &raised(problem.obstacle, self.raised));
            }
            return State::Working;
        }
        let tolerance = length * if is_finest { problem.tolerance } else { COARSE_TOLERANCE };
        let level = &mut self.levels[self.grid];
        let state = level.step(law, problem, &problem.obstacle, tolerance);
        let is_slow = state == State::Working && level.iterations > MAX_WARM_ITERATIONS;
        if self.is_warm && (is_slow || state == State::Stalled) {
            self.start_cold(law, problem);
            return State::Working;
        }
        match state {
            State::Working => State::Working,
            state if is_finest => state,
            _ => {
                self.refine(law, problem);
                State::Working
            }
        }
    }

    /// Prolongates the solution to the next finer grid.
    fn refine(&mut self, law: &LayeredLaw, problem: &Problem) {
        let (coarser, finer) = self.levels.split_at_mut(self.grid + 1);
        let (coarse, fine) = (&coarser[self.grid], &mut finer[0]);
        for (layer, height) in coarse.heights.iter().enumerate() {
            let up = DVec3::new(0.0, 0.0, *height);
            let lowered: Vec<DVec3> = coarse.x[layer].iter().map(|x| *x - up).collect();
            let x = &mut fine.x[layer];
            x.copy_from_slice(&fine.sheet.rest_positions());
            prolongation::prolongate(&coarse.sheet, &lowered, &fine.sheet, x);
            x.iter_mut().for_each(|x| *x += up);
        }
        fine.start(law, problem, &problem.obstacle);
        self.grid += 1;
    }

    /// The finest grid.
    pub(in crate::solve) fn finest(&self) -> &Newton {
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

/// The obstacle with a part of the dome's height above the wall.
fn raised(mut obstacle: Obstacle, part: f64) -> Obstacle {
    obstacle.dome.base_height -= (1.0 - part) * obstacle.dome.apex().z;
    obstacle
}

impl Newton {
    pub(in crate::solve) fn revision(&self) -> u64 {
        self.revision
    }

    pub(in crate::solve) fn relative_residual(&self) -> f64 {
        self.relative_residual
    }

    /// Estimated greatest node position error \[mm\].
    pub(in crate::solve) fn error(&self) -> f64 {
        self.error
    }

    /// Why the shape is invalid; `None` for a valid shape. `tolerance` is relative to the base radius.
    pub(in crate::solve) fn invalid(&self, dome: &Dome, tolerance: f64) -> Option<Invalid> {
        let n = self.sheet.nodes_per_side();
        validity::invalid(&self.sheet, dome, tolerance, [0; 2], |i, j| self.x[0][j * n + i])
    }

    /// Writes the positions of the inner face and of the layers of nodes above.
    pub(in crate::solve) fn write_positions(&self, inner: &mut [DVec3], outer: &mut [Vec<DVec3>]) {
        inner.copy_from_slice(&self.x[0]);
        for (outer, x) in outer.iter_mut().zip(&self.x[1..]) {
            outer.copy_from_slice(x);
        }
    }
}

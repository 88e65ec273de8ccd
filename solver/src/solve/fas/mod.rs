//! Full multigrid by the full approximation scheme, in lanes of four f32.
//!
//! Nested iteration: the coarsest grid starts from a taut profile, every finer grid from the prolongated solution
//! of the coarser grid; V-cycles reduce the error. Every grid is fitted to the patch's circle. No matrix is
//! assembled: a cycle evaluates forces and nodal blocks. The grid being solved determines the active set; coarser
//! grids inherit the set by restriction.
//!
//! `cycle` (the V-cycle as a schedule) | `convergence` (error estimate, endings) | `parameters` | `level` (one
//! grid) | `smoother` | `transfer` | `positions` (the solution in mm) | `rise` (a dome that rises) | `shape` (an implant that yields) |
//! `continuation` (from the solution of another problem).

mod continuation;
mod convergence;
mod cycle;
mod level;
mod parameters;
mod positions;
mod rise;
mod shape;
mod smoother;
#[cfg(test)]
mod tests;
mod transfer;

use super::Problem;
use super::initial_guess;
use crate::contact::{Dome, Obstacle};
use crate::mesh::coarser_nodes_per_side;
use crate::mesh::lanes::{Field, Mirrored};
use crate::model::ElasticModel;
use convergence::Convergence;
pub(super) use convergence::Ending;
use cycle::Step;
use glam::DVec3;
use level::Level;
use parameters::Parameters;
pub(super) use parameters::{
    LAYERED, LAYERED_FRESH, LAYERED_GENTLE, LAYERED_RISING, MEMBRANE, MEMBRANE_GENTLE,
};
use rise::{Ascent, Landing, standing};
use shape::Yielded;
use std::iter::successors;

/// State of the scheme.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum State {
    Working,
    /// The error is below the draft tolerance for the first time; the tolerance is not reached.
    Draft,
    Converged,
    /// The scheme does not converge.
    Failed,
}

/// Stopping criterion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Stop {
    /// At the problem's tolerance.
    Tolerance,
    /// After this number of cycles of the finest grid, for studies.
    Cycles(u32),
}

/// Mode of the cycles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mode {
    Fast,
    /// Nodal blocks renewed in every cycle, larger coarse active sets: slower, convergent at small contacts and
    /// near zero stiffness.
    Robust,
}

/// The scheme for one problem after the other.
#[derive(Clone, Debug)]
pub(super) struct FullMultigrid<M: ElasticModel> {
    /// From the coarsest to the finest.
    levels: Vec<Level<M>>,
    model: M,
    parameters: &'static Parameters,
    /// [`Dome::reference_length`](crate::contact::Dome::reference_length) \[mm\].
    reference_length: f64,
    /// Of the finest grid \[mm\].
    spacing: f64,
    /// Relative to the base radius.
    tolerance: f64,
    stop: Stop,
    /// Error of a draft to display \[base radius\].
    draft_tolerance: Option<f64>,
    /// The grid being solved.
    grid: usize,
    /// The steps of the current cycle, and the index of the next step.
    steps: Vec<Step>,
    next_step: usize,
    mode: Mode,
    convergence: Convergence,
    /// The solution of the second finest grid in its outermost layer of nodes \[its spacings\]; empty with one grid and of a
    /// sheet.
    coarse_solution: Field,
    /// Has this solve set [`Self::coarse_solution`]?
    has_coarse_solution: bool,
    /// Scratch of a row.
    row: Vec<f32>,
    work_units: f64,
    /// Before the model grew: cycles of the finest grid, and [`Self::change_by_refinement`].
    before_growth: (u32, Option<f64>),
    /// See [`Self::is_continued`].
    is_continued: bool,
    /// The grid on which a dome rises.
    rising_grid: usize,
    /// The rest of the way of a rising dome, the last step first.
    ascent: Vec<Ascent>,
    /// The solutions of coarser grids under lower domes of this rise.
    landings: Vec<Landing>,
    /// The implant, if it yields.
    yielded: Option<Yielded>,
}

impl<M: ElasticModel> FullMultigrid<M> {
    /// Grids of up to `nodes_per_side` nodes a side.
    pub(super) fn new(
        nodes_per_side: usize,
        mirrored: Mirrored,
        model: M,
        parameters: &'static Parameters,
    ) -> Self {
        let coarser = |&n: &usize| {
            coarser_nodes_per_side(n).filter(|coarse| *coarse > parameters.least_cells)
        };
        let sides: Vec<usize> = successors(Some(nodes_per_side), coarser).collect();
        let levels: Vec<Level<M>> = sides
            .iter()
            .rev()
            .enumerate()
            .map(|(grid, &n)| {
                let is_finest = n == nodes_per_side;
                // Three results are mixed where many cycles are: on the first grid and the finest one.
                let kept_cycles = match model.layers() {
                    1 => usize::from(is_finest),
                    _ => 1 + usize::from(is_finest || grid <= parameters.first_grid),
                };
                Level::new(n, mirrored, is_finest, kept_cycles, &model)
            })
            .collect();
        Self {
            parameters,
            reference_length: 1.0,
            spacing: 1.0,
            tolerance: 0.0,
            stop: Stop::Tolerance,
            draft_tolerance: None,
            grid: 0,
            steps: Vec::with_capacity(8 * levels.len() + 2),
            next_step: 0,
            mode: Mode::Fast,
            convergence: Convergence::NEW,
            coarse_solution: levels
                .iter()
                .nth_back(1)
                .filter(|_| model.layers() > 1)
                .map_or_else(Field::default, |coarse| Field::new(coarse.layout.len(), 1)),
            has_coarse_solution: false,
            row: vec![0.0; nodes_per_side + 8],
            work_units: 0.0,
            before_growth: (0, None),
            is_continued: false,
            rising_grid: 0,
            ascent: Vec::new(),
            landings: Vec::new(),
            yielded: None,
            levels,
            model,
        }
    }

    /// Do the grids fit a problem of this size and symmetry, with this number of nodes in a column?
    pub(super) fn fits(&self, nodes_per_side: usize, mirrored: Mirrored, layers: usize) -> bool {
        let layout = &self.finest().layout;
        (layout.nodes_per_side, layout.mirrored) == (nodes_per_side, mirrored)
            && self.model.layers() == layers
    }

    fn finest(&self) -> &Level<M> {
        &self.levels[self.levels.len() - 1]
    }

    fn is_on_finest(&self) -> bool {
        self.grid + 1 == self.levels.len()
    }

    /// Cycles of the finest grid under the whole dome so far.
    pub(super) fn finest_cycles(&self) -> u32 {
        let is_last = self.is_on_finest() && self.ascent.is_empty();
        self.before_growth.0 + if is_last { self.convergence.cycles } else { 0 }
    }

    /// Free nodes of the finest grid that are solved for.
    pub(super) fn nodes(&self) -> usize {
        self.finest().layout.free_nodes()
    }

    /// Is the shape mirrored along x, along y?
    pub(super) fn mirrored(&self) -> Mirrored {
        self.finest().layout.mirrored
    }

    /// Lanes that a pass over the finest grid computes: whole groups of four, row by row.
    pub(super) fn lanes(&self) -> usize {
        self.finest().layout.lanes()
    }

    /// Work so far \[evaluations of the forces of the finest grid\].
    pub(super) fn work_units(&self) -> f64 {
        self.work_units
    }

    /// Output of the last convergence test.
    pub(super) fn ending(&self) -> Ending {
        self.convergence.ending
    }

    /// Greatest distance between the solutions of the two finest grids at a node of both, on the skin \[mm\]; `None` without a
    /// solution of both.
    pub(super) fn change_by_refinement(&self) -> Option<f64> {
        if self.before_growth.1.is_some() {
            return self.before_growth.1;
        }
        if !(self.has_coarse_solution && self.is_on_finest()) {
            return None;
        }
        let [.., coarse, fine] = &*self.levels else { return None };
        let (u, own) = (&fine.u, &self.coarse_solution);
        let change = transfer::greatest_distance(&coarse.layout, &fine.layout, u, own);
        Some(2.0 * self.spacing * f64::from(change))
    }

    /// Starts again with other constants; the work of the attempt before counts.
    pub(super) fn start_again(
        &mut self,
        parameters: &'static Parameters,
        problem: &Problem,
        stop: Stop,
    ) {
        let work_units = self.work_units;
        self.parameters = parameters;
        self.start(problem, stop, None);
        self.work_units = work_units;
    }

    /// Did the last attempt end near its solution, after all its cycles of the finest grid?
    pub(super) fn is_slow(&self) -> bool {
        let near = self.parameters.start_tolerance * self.reference_length;
        let is_last = self.is_on_finest() && self.ascent.is_empty();
        is_last
            && self.convergence.cycles >= self.parameters.max_cycles
            && self.convergence.ending.error <= near
    }

    /// See [`Parameters::least_tolerance`].
    pub(super) fn least_tolerance(&self) -> f64 {
        self.parameters.least_tolerance
    }

    /// Replaces the constants of the scheme.
    pub(super) fn set_parameters(&mut self, parameters: &'static Parameters) {
        self.parameters = parameters;
    }

    /// Replaces the elastic model.
    pub(super) fn set_model(&mut self, model: M) {
        self.model = model;
    }

    /// Starts on the coarsest grid.
    pub(super) fn start(&mut self, problem: &Problem, stop: Stop, draft_tolerance: Option<f64>) {
        self.yielded = Yielded::of(problem, self.mirrored());
        let obstacle = &match &self.yielded {
            Some(yielded) => yielded.in_place(&problem.obstacle),
            None => problem.obstacle.clone(),
        };
        self.set_up(problem, stop, draft_tolerance);
        self.is_continued = false;
        self.before_growth = (0, None);
        for level in &mut self.levels {
            level.forget(&self.model);
            // A failed solve may leave numbers that are not finite at clamped nodes.
            level.u.fill_zero();
        }
        let finest = self.levels.len() - 1;
        let first = self.parameters.first_grid.min(finest);
        let lowest = standing(obstacle, self.parameters.rise[0]);
        self.place(&lowest);
        for level in &mut self.levels[..=first] {
            level.start_from_geometry(problem, &lowest.dome);
        }
        self.landings.clear();
        self.rising_grid = self.parameters.rising_grid.min(finest);
        self.plan_ascent(problem, obstacle, self.parameters.rise);
        for level in &mut self.levels[..first] {
            // Later cycles use the blocks of the start on grids that are not solved by themselves.
            level.invert_blocks(&self.model);
        }
        self.begin_grid(first);
    }

    /// Fits the grids to a problem, before its first cycle.
    fn set_up(&mut self, problem: &Problem, stop: Stop, draft_tolerance: Option<f64>) {
        let Problem { rest, obstacle, tolerance, .. } = problem;
        self.stop = stop;
        self.draft_tolerance = draft_tolerance;
        self.reference_length = obstacle.dome.reference_length();
        self.spacing = rest.sheet().spacing_mm();
        self.tolerance = tolerance.max(self.parameters.least_tolerance);
        let finest = self.levels.len() - 1;
        for (l, level) in self.levels.iter_mut().enumerate() {
            let spacing = self.spacing * f64::from(1 << (finest - l));
            level.fit(&self.model, spacing, rest);
        }
        self.work_units = 0.0;
        self.has_coarse_solution = false;
        self.mode = Mode::Fast;
    }

    /// Continues from the solution with a model under another suction or with skin that has grown; the coarser grids are solved for no other.
    pub(super) fn grow(&mut self, model: M, stop: Stop, has_grown: bool) {
        self.before_growth = (self.finest_cycles(), self.change_by_refinement());
        self.model = model;
        self.stop = stop;
        for level in &mut self.levels {
            level.grow(&self.model);
        }
        self.begin_grid(self.grid);
        self.convergence.has_grown = has_grown;
    }

    /// Places the obstacle on every grid.
    fn place(&mut self, obstacle: &Obstacle) {
        let obstacle = match &self.yielded {
            Some(yielded) => &yielded.in_place(obstacle),
            None => obstacle,
        };
        let finest = self.levels.len() - 1;
        for (l, level) in self.levels.iter_mut().enumerate() {
            let spacing = self.spacing * f64::from(1 << (finest - l));
            level.place(obstacle.scaled(1.0 / spacing));
        }
    }

    fn begin_grid(&mut self, grid: usize) {
        self.grid = grid;
        if let Some(yielded) = &mut self.yielded {
            yielded.begin_grid();
        }
        self.convergence = Convergence::NEW;
        self.levels[grid].contact_offset.fill(0.0);
        self.begin_cycle();
    }

    /// Continues on the next finer grid.
    fn refine(&mut self) {
        if self.grid + 2 == self.levels.len() && self.model.layers() > 1 {
            self.coarse_solution.copy_last_plane_from(&self.levels[self.grid].u);
            self.has_coarse_solution = true;
        }
        self.prolongate(self.grid);
        self.begin_grid(self.grid + 1);
    }

    /// Interpolates the solution of a grid to the next finer one.
    fn prolongate(&mut self, grid: usize) {
        let (coarser, finer) = self.levels.split_at_mut(grid + 1);
        finer[0].start_from(&mut coarser[grid], &mut self.row);
        finer[0].take_over(&self.model, &coarser[grid]);
    }

    /// Does the next piece of work: a few evaluations of the forces of one grid at most.
    pub(super) fn step(&mut self) -> State {
        let step = self.steps[self.next_step];
        self.next_step += 1;
        if step == Step::CheckConvergence {
            return self.check_convergence();
        }
        self.execute(step);
        State::Working
    }

    /// Spacing of the grid being solved \[mm\].
    fn grid_spacing(&self) -> f64 {
        self.spacing * f64::from(1 << (self.levels.len() - 1 - self.grid))
    }
}

impl<M: ElasticModel> Level<M> {
    /// Displacements of the taut profile over a dome \[spacings\], one a node.
    fn guess(&self, problem: &Problem, dome: &Dome) -> Vec<DVec3> {
        let rest = problem.rest.restricted(self.layout.nodes_per_side);
        let guess = initial_guess::taut_within(&rest, dome, problem.patch.reach_mm());
        let per_spacing = 1.0 / rest.sheet().spacing_mm();
        let displacement = |(k, x): (usize, DVec3)| (x - rest.node(0, k)) * per_spacing;
        guess.into_iter().enumerate().map(displacement).collect()
    }

    /// Sets the state to the taut profile over the dome.
    fn start_from_geometry(&mut self, problem: &Problem, dome: &Dome) {
        self.u.fill_zero();
        self.move_columns(&self.guess(problem, dome));
    }

    /// Moves every column \[spacings\].
    fn move_columns(&mut self, moves: &[DVec3]) {
        let Self { layout, u, .. } = self;
        for layer in u.layers() {
            layout.free_rows(|j, from, to| {
                for i in from..to {
                    let way = moves[layout.node(i, j)];
                    let to = layer + j * layout.pitch + i;
                    u.x[to] += way.x as f32;
                    u.y[to] += way.y as f32;
                    u.z[to] += way.z as f32;
                }
            });
        }
        layout.mirror(u);
        if self.rest.is_some() {
            self.project_feasible();
        }
    }
}

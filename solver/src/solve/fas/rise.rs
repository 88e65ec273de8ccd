//! A dome that rises in steps on one of the grids and, where the rise fails, goes on from its last solution on the next finer grid.
//!
//! The solution under a dome that is to rise further is a start only: three cycles. Each one on a coarser grid is kept. A rise
//! fails where a grid has no shape under the next dome, or the first cycles of a finer grid lose the shape; it goes on
//! there from the highest dome with a solution, the next time from the one below.

use super::level::Level;
use super::parameters::Parameters;
use super::transfer;
use super::{FullMultigrid, Stop};
use crate::contact::{Modes, Obstacle};
use crate::mesh::lanes::Field;
use crate::model::ElasticModel;
use crate::solve::Problem;
use glam::DVec3;

/// A step of a rising dome.
#[derive(Clone, Debug)]
pub(super) struct Ascent {
    /// The obstacle after the step \[mm\].
    obstacle: Obstacle,
    /// Move of every column of the rising grid by the initial guesses before and after the step \[spacings\].
    moves: Vec<DVec3>,
}

/// A solution under a dome that was to rise further.
#[derive(Clone, Debug)]
pub(super) struct Landing {
    grid: usize,
    /// Displacements \[spacings\].
    u: Field,
    /// The numbers of an implant that yields.
    modes: Option<Modes<f64>>,
    /// Number of steps to the whole dome.
    steps: usize,
}

/// The obstacle with a part of the dome's height.
pub(super) fn standing(obstacle: &Obstacle, part: f64) -> Obstacle {
    match part {
        1.0 => obstacle.clone(),
        part => Obstacle { dome: obstacle.dome.lowered_to(part), ..obstacle.clone() },
    }
}

impl<M: ElasticModel> FullMultigrid<M> {
    /// Plans the steps between parts of the dome's height on the rising grid.
    pub(super) fn plan_ascent(&mut self, problem: &Problem, obstacle: &Obstacle, parts: &[f64]) {
        self.ascent.clear();
        let level = &self.levels[self.rising_grid];
        for pair in parts.windows(2).rev() {
            let [before, obstacle] = [pair[0], pair[1]].map(|part| standing(obstacle, part));
            let [from, to] = [&before, &obstacle].map(|at| level.guess(problem, &at.dome));
            let moves = to.iter().zip(from).map(|(to, from)| *to - from).collect();
            self.ascent.push(Ascent { obstacle, moves });
        }
    }

    /// Raises the dome by a step on its grid.
    pub(super) fn raise(&mut self) {
        let steps = self.ascent.len();
        let Some(Ascent { obstacle, moves }) = self.ascent.pop() else { return };
        if !self.is_on_finest() {
            let u = self.levels[self.grid].u.clone();
            self.landings.push(Landing { grid: self.grid, u, modes: self.modes(), steps });
        }
        self.place(&obstacle);
        self.levels[self.grid].move_columns(&moves);
        // That of a lower dome.
        self.has_coarse_solution = false;
        self.begin_grid(self.grid);
    }

    /// Goes on after a failed rise, from the last solution under a lower dome, on the next finer grid; false without such a solution.
    /// The work before counts.
    pub(in crate::solve) fn rise_on(&mut self, problem: &Problem, stop: Stop) -> bool {
        let Some(Landing { grid, u, modes, steps }) = self.landings.pop() else { return false };
        let work_units = self.work_units;
        self.set_up(problem, stop, None);
        self.work_units = work_units;
        if let (Some(yielded), Some(modes)) = (&mut self.yielded, modes) {
            yielded.set_modes(modes);
        }
        let Parameters { rise, .. } = self.parameters;
        let parts = &rise[rise.len() - 1 - steps..];
        self.rising_grid = grid + 1;
        self.plan_ascent(problem, &problem.obstacle, parts);
        self.place(&standing(&problem.obstacle, parts[0]));
        for level in &mut self.levels {
            level.forget(&self.model);
            // A failed solve may leave numbers that are not finite at clamped nodes.
            level.u.fill_zero();
        }
        self.levels[grid].u.copy_from(&u);
        for coarse in (0..grid).rev() {
            let (coarser, finer) = self.levels.split_at_mut(coarse + 1);
            coarser[coarse].start_below(&finer[0]);
        }
        for level in &mut self.levels[..=grid] {
            level.invert_blocks(&self.model);
        }
        self.levels[grid].renew(&self.model);
        self.prolongate(grid);
        self.begin_grid(grid + 1);
        true
    }
}

impl<M: ElasticModel> Level<M> {
    /// Starts from the state of the finer grid.
    fn start_below(&mut self, fine: &Self) {
        transfer::inject(&self.layout, &fine.layout, &fine.u, &mut self.u);
        self.layout.mirror(&mut self.u);
        self.project_feasible();
    }
}

//! An implant that yields: the numbers of its deformation, renewed once a cycle and mixed like the displacements.
//!
//! At the start of a cycle, but the first of a grid, the forces that the first step needs give the work of the reactions; the numbers move by one step
//! towards their balance (`yielding`), on all grids, and the tissue near the implant follows its surface. The change of the cycle contains that move, so
//! that the estimate of the error does. Forces of tissue that has not followed the last step mislead the next one under tight skin: where all
//! attempts fail, those of further rounds let the numbers wait for it.

use super::FullMultigrid;
use crate::contact::{MODES, Modes, Obstacle};
use crate::model::ElasticModel;
use crate::solve::Problem;
use crate::solve::yielding::{Work, Yielding};

/// The most cycles in a row in which the numbers wait for the tissue.
const MOST_WAITED: u32 = 6;

/// The implant of a problem, and its numbers in the cycles before.
#[derive(Clone, Debug)]
pub(super) struct Yielded {
    own: Yielding,
    /// The numbers after the last two cycles of the grid, the last one first.
    last: [Modes<f64>; 2],
    /// Change of the tissue in a cycle, by the last move of the surface, up to which the numbers step \[-\]; `None`: once a cycle.
    patience: Option<f64>,
    /// The last move of the surface \[mm\], and the cycles since.
    moved: f64,
    waited: u32,
}

impl Yielded {
    /// At rest at the start of a solve; `None` of an implant that does not yield.
    pub(super) fn of(problem: &Problem, mirrored: [bool; 2]) -> Option<Self> {
        let mut own = Yielding::of(problem, mirrored)?;
        own.modes = [0.0; MODES];
        let last = [[0.0; MODES]; 2];
        Some(Self { own, last, patience: None, moved: f64::INFINITY, waited: 0 })
    }

    /// The implant of another problem with the same symmetry, as deformed.
    pub(super) fn in_problem(self, problem: &Problem) -> Option<Self> {
        Some(Self { own: self.own.in_problem(problem)?, ..self })
    }

    pub(super) fn modes(&self) -> Modes<f64> {
        self.own.modes
    }

    pub(super) fn set_modes(&mut self, modes: Modes<f64>) {
        self.own.modes = modes;
    }

    /// The obstacle with the present numbers of the implant.
    pub(super) fn in_place(&self, obstacle: &Obstacle) -> Obstacle {
        let mut obstacle = obstacle.clone();
        obstacle.dome.set_modes(self.own.modes);
        obstacle
    }

    /// Do the numbers wait in this cycle, after one with a change \[mm\]?
    fn waits(&mut self, change: f64) -> bool {
        let Some(part) = self.patience else { return false };
        let waits = change > part * self.moved && self.waited < MOST_WAITED;
        self.waited = if waits { self.waited + 1 } else { 0 };
        waits
    }

    pub(super) fn begin_grid(&mut self) {
        self.last = [self.own.modes; 2];
        self.own.begin_grid();
    }
}

impl<M: ElasticModel> FullMultigrid<M> {
    /// The numbers of the deformation of an implant that yields.
    pub(in crate::solve) fn modes(&self) -> Option<Modes<f64>> {
        self.yielded.as_ref().map(Yielded::modes)
    }

    /// The work of the forces at the present displacements of the grid being solved by the numbers; `None` of an implant that does not yield.
    fn work_on_shape(&mut self) -> Option<Work> {
        self.yielded.as_ref()?;
        let spacing = self.grid_spacing();
        let work = self.levels[self.grid].work(&self.model);
        Some(work.scaled(self.model.stiffness() * spacing * spacing, spacing))
    }

    /// Lets the numbers wait for the tissue, by the part [`Yielded::patience`] of their last move, or not.
    pub(in crate::solve) fn wait_for_tissue(&mut self, patience: Option<f64>) {
        if let Some(yielded) = &mut self.yielded {
            yielded.patience = patience;
        }
    }

    /// Moves the numbers by a step towards the balance, on all grids.
    pub(super) fn yield_to_tissue(&mut self) {
        let change = self.convergence.last_change;
        self.convergence.moved = 0.0;
        if self.yielded.as_mut().is_some_and(|yielded| yielded.waits(change)) {
            return;
        }
        let Some(work) = self.work_on_shape() else { return };
        let Some(yielded) = &mut self.yielded else { return };
        let step = yielded.own.next_step(&work);
        yielded.own.advance(&step);
        yielded.moved = yielded.own.greatest_move(&step);
        // Under a tight sheet steps that go too far are slow cycles: robust mode ends them.
        if self.model.layers() > 1 {
            self.convergence.moved = yielded.moved;
        }
        let modes = yielded.own.modes;
        for (grid, level) in self.levels.iter_mut().enumerate() {
            if grid == self.grid {
                level.reshape_with_tissue(modes);
            } else {
                level.reshape(modes);
            }
        }
    }

    /// Mixes the numbers after the last cycles as the displacements.
    pub(super) fn mix_shape(&mut self, thetas: [f32; 2]) {
        let Some(yielded) = &mut self.yielded else { return };
        let result = yielded.own.modes;
        for (theta, last) in thetas.into_iter().zip(yielded.last) {
            for ((own, of_cycle), last) in yielded.own.modes.iter_mut().zip(result).zip(last) {
                *own -= f64::from(theta) * (of_cycle - last);
            }
        }
        yielded.last = [result, yielded.last[0]];
        let modes = yielded.own.modes;
        if thetas.iter().any(|theta| *theta != 0.0) {
            self.levels.iter_mut().for_each(|level| level.reshape(modes));
        }
    }

    /// Computes the move of the implant's surface by the next step of its numbers; false for an implant that does not yield.
    pub(super) fn find_imbalance(&mut self) -> bool {
        let Some(work) = self.work_on_shape() else { return false };
        let Some(yielded) = &self.yielded else { return false };
        self.convergence.imbalance = yielded.own.greatest_move(&yielded.own.step(&work));
        true
    }
}

//! Newton's method on nested grids: each starts from the equilibrium of the grid before.

use super::{Newton, State};
use crate::implant::Dome;
use crate::sheet::Sheet;
use crate::solve::law::SheetLaw;
use crate::solve::{guess, transfer};
use crate::springs::Springs;
use glam::DVec3;

/// Coarse grids only have to be good starts \[share of the base radius\].
const COARSE_TOLERANCE: f64 = 1e-3;
/// How often the paper's springs are followed along their true model's step: where they break, at rest, it
/// may lead on and on.
const MAX_ASKED: u32 = 10;
/// Iterations after which a solve from a given shape is begun anew on the coarsest grid.
const WARM_ITERATIONS: u32 = 8;

/// Newton's method on a grid and the coarser ones below it.
pub(crate) struct NestedNewton {
    /// From the coarsest grid to the finest.
    levels: Vec<Newton>,
    current: usize,
    /// Keep the shape of a symmetric scene symmetric?
    is_symmetric: bool,
    is_warm: bool,
    is_probed: bool,
    is_lifted: bool,
    /// How often the true model was asked for its step.
    asked: u32,
}

impl NestedNewton {
    /// Room for a sheet and the coarser ones. `patience`: how many times as long as usual each may go on.
    pub(crate) fn new(sheet: &Sheet, patience: f64) -> Self {
        let mut sheets = vec![sheet.clone()];
        while let Some(coarser) = sheets[sheets.len() - 1].coarser() {
            sheets.push(coarser);
        }
        let levels = sheets.into_iter().rev().map(|sheet| Newton::new(sheet, patience)).collect();
        Self {
            levels,
            current: 0,
            is_symmetric: false,
            is_warm: false,
            is_probed: false,
            is_lifted: false,
            asked: 0,
        }
    }

    /// Starts from geometry alone on the coarsest grid; keeps the shape of a symmetric scene symmetric, if
    /// that is wanted.
    pub(crate) fn start_cold(&mut self, dome: &Dome, is_symmetric: bool) {
        self.is_symmetric = is_symmetric;
        self.is_warm = false;
        self.is_probed = false;
        self.is_lifted = false;
        self.asked = 0;
        self.current = 0;
        let coarsest = &mut self.levels[0];
        coarsest.x = guess::tight_string(&coarsest.sheet, dome);
        coarsest.start(dome, is_symmetric);
    }

    /// Starts from a shape of the finest grid.
    pub(crate) fn start_from(&mut self, x: &[DVec3], dome: &Dome, is_symmetric: bool) {
        self.is_symmetric = is_symmetric;
        self.is_warm = true;
        self.is_probed = false;
        self.is_lifted = false;
        self.asked = 0;
        self.current = self.levels.len() - 1;
        let finest = &mut self.levels[self.current];
        finest.x.copy_from_slice(x);
        finest.start(dome, is_symmetric);
    }

    /// Does the next piece of work; `tolerance` is that of the finest grid \[mm\]. The last state is
    /// the finest grid's.
    pub(crate) fn step(
        &mut self,
        springs: Springs,
        law: &SheetLaw,
        dome: &Dome,
        tolerance: f64,
    ) -> State {
        let last = self.levels.len() - 1;
        let is_finest = self.current == last;
        let tolerance = if is_finest { tolerance } else { COARSE_TOLERANCE * dome.base_radius };
        let level = &mut self.levels[self.current];
        let state = level.step(law, dome, tolerance);
        let is_slow = self.is_warm && level.iterations > WARM_ITERATIONS;
        match state {
            State::Working if is_slow => self.start_cold(dome, self.is_symmetric),
            State::Working => {}
            State::Stalled | State::Unstable | State::Saddle if self.is_warm => {
                self.start_cold(dome, self.is_symmetric);
            }
            State::Converged | State::Stalled | State::Saddle if !is_finest => {
                let (coarser, finer) = self.levels.split_at_mut(self.current + 1);
                let (coarse, fine) = (&coarser[self.current], &mut finer[0]);
                transfer::refine(&coarse.sheet, &coarse.x, &fine.sheet, &mut fine.x);
                fine.start(dome, self.is_symmetric);
                self.current += 1;
            }
            // The energy of the paper's springs has saddles: see whether this is one.
            State::Converged | State::Stalled
                if springs == Springs::Nikolaev && !self.is_probed && !level.is_asked =>
            {
                self.is_probed = true;
                level.begin_stability(state);
            }
            State::Converged if level.is_doubtful(springs, law) => {
                self.asked += 1;
                if springs == Springs::Nikolaev && self.asked > MAX_ASKED {
                    return level.finish(law, dome, tolerance, State::Stalled);
                }
                self.is_probed = false; // Where its step leads, the shape is another one.
                level.begin_true_step();
            }
            State::Converged
                if springs == Springs::Coupled && !std::mem::replace(&mut self.is_lifted, true) =>
            {
                if !level.find_lifts(dome, tolerance) {
                    return level.finish(law, dome, tolerance, state);
                }
            }
            // Lifts are of the shape without them: where it cannot be had with them, it is taken as it was.
            State::Stalled if level.drop_lifts(dome) => {}
            State::Unstable | State::Saddle => return state,
            State::Stalled | State::Converged => {
                return level.finish(law, dome, tolerance, state);
            }
        }
        State::Working
    }

    /// The finest grid.
    pub(crate) fn finest(&self) -> &Newton {
        &self.levels[self.levels.len() - 1]
    }

    /// Grid at work, counted from 1 for the coarsest, and how many there are.
    pub(crate) fn grid(&self) -> (usize, usize) {
        (self.current + 1, self.levels.len())
    }

    /// Is the finest grid being solved?
    pub(crate) fn is_on_finest(&self) -> bool {
        self.current + 1 == self.levels.len()
    }

    /// Work since the last [`Self::clear_work`], in units of one evaluation of all nodal forces on the
    /// finest grid.
    pub(crate) fn work_units(&self) -> f64 {
        let finest = self.finest().sheet.len() as f64;
        let scaled = |level: &Newton| level.work_units * level.sheet.len() as f64 / finest;
        self.levels.iter().map(scaled).sum()
    }

    /// Begins to count anew.
    pub(crate) fn clear_work(&mut self) {
        self.levels.iter_mut().for_each(|level| level.work_units = 0.0);
    }
}

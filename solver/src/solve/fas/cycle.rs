//! The V-cycle of the full approximation scheme, as a schedule.
//!
//! On every grid l the problem is f(u) + τ = 0 outside of the obstacle; τ = 0 on the grid being solved.
//!
//! 1. Smooth: for each ω of `smoothing.before`, u ← u + ω D⁻¹ (f(u) + τ) under the contact constraints; the first cycle
//!    of a grid uses `first_smoothing` on this grid.
//! 2. Restrict: û = I u and τ = R r − f(û) on the next coarser grid, r the residual without contact forces. A coarse
//!    node is active, and keeps its gauge, where the weighted fraction of active fine nodes exceeds a threshold; the
//!    other nodes stay one-sided.
//! 3. Solve the coarse problem: by steps 1 to 5, on the coarsest grid by smoothing alone.
//! 4. Correct: u ← u + P (u_coarse − û), along the dome at active nodes; in layered tissue scaled to the least energy up to the first
//!    grid, whose coarser grid is too coarse for the contact, and once a cycle of the grid being solved was slow (W. Hackbusch
//!    and A. Reusken, Numer. Math. 55, 1989).
//! 5. Smooth as in step 1, with each ω of `smoothing.after`.
//!
//! After the cycle the check of convergence mixes the results of the last two cycles.
//!
//! A. Brandt, "Multi-level adaptive solutions to boundary-value problems", Math. Comp. 31, 1977.

use super::parameters::{Parameters, Smoothing};
use super::smoother::{Contact, Damping};
use super::{FullMultigrid, Mode};
use crate::model::ElasticModel;

/// A step of a cycle: one piece of work, a few passes over one grid. Grids count from the coarsest, 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    /// Computes D⁻¹.
    InvertBlocks {
        grid: usize,
    },
    Smooth {
        grid: usize,
        omega: f32,
    },
    /// From a grid to the next coarser one.
    Restrict {
        grid: usize,
    },
    SolveCoarsest,
    /// From the next coarser grid to this one.
    Correct {
        grid: usize,
    },
    CheckConvergence,
}

/// The next cycle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    /// The grid being solved.
    pub(super) top: usize,
    /// Number of previous cycles of this grid.
    pub(super) cycles: u32,
    pub(super) mode: Mode,
    /// See [`FullMultigrid::is_continued`].
    pub(super) is_continued: bool,
    pub(super) parameters: &'static Parameters,
}

impl Plan {
    /// Sets `steps` to one V-cycle.
    pub(super) fn v_cycle(self, steps: &mut Vec<Step>) {
        steps.clear();
        for grid in (1..=self.top).rev() {
            if self.renews_blocks(grid) {
                steps.push(Step::InvertBlocks { grid });
            }
            let smooth = |&omega: &f32| Step::Smooth { grid, omega };
            steps.extend(self.smoothing(grid).before.iter().map(smooth));
            steps.push(Step::Restrict { grid });
        }
        steps.push(Step::SolveCoarsest);
        for grid in 1..=self.top {
            steps.push(Step::Correct { grid });
            let smooth = |&omega: &f32| Step::Smooth { grid, omega };
            steps.extend(self.smoothing(grid).after.iter().map(smooth));
        }
        steps.push(Step::CheckConvergence);
    }

    /// Blocks are recomputed in the first cycles of their own grid only, in robust mode in every cycle. The coarsest grid:
    /// [`FullMultigrid::solve_coarsest`].
    fn renews_blocks(self, grid: usize) -> bool {
        let is_new = self.cycles < self.parameters.block_cycles && !self.is_continued;
        let is_own = grid == self.top && is_new;
        is_own || self.mode == Mode::Robust
    }

    fn is_first(self, grid: usize) -> bool {
        grid == self.top && self.cycles == 0
    }

    fn smoothing(self, grid: usize) -> Smoothing {
        let Parameters { first_smoothing, smoothing, .. } = self.parameters;
        if self.is_first(grid) { *first_smoothing } else { *smoothing }
    }
}

impl Parameters {
    fn damping(&self, omega: f32) -> Damping {
        let &Self { has_hardening, block_growth, .. } = self;
        Damping { omega, has_hardening, block_growth }
    }
}

impl<M: ElasticModel> FullMultigrid<M> {
    /// Begins a cycle of the grid being solved.
    pub(super) fn begin_cycle(&mut self) {
        let Self { levels, model, grid, convergence, mode, steps, parameters, .. } = self;
        let level = &mut levels[*grid];
        if convergence.cycles > 0 {
            level.renew(model);
        }
        level.before.copy_from(&level.u);
        let is_yielding = self.yielded.is_some() && convergence.cycles > 0;
        let (top, cycles, mode, is_continued) =
            (*grid, convergence.cycles, *mode, self.is_continued);
        Plan { top, cycles, mode, is_continued, parameters }.v_cycle(steps);
        self.next_step = 0;
        if is_yielding {
            self.yield_to_tissue();
        }
    }

    /// Executes a step of a cycle, except the convergence test.
    pub(super) fn execute(&mut self, step: Step) {
        match step {
            Step::InvertBlocks { grid } => {
                self.levels[grid].invert_blocks(&self.model);
                self.count(grid, 1.0);
            }
            Step::Smooth { grid, omega } => {
                let contact = self.contact(grid);
                let damping = self.parameters.damping(omega);
                let evaluations = self.levels[grid].smooth(&self.model, contact, damping);
                self.count(grid, evaluations);
            }
            Step::Restrict { grid } => {
                let contact = self.contact(grid);
                let weight = match self.mode {
                    Mode::Fast => self.parameters.coarse_active_weight,
                    Mode::Robust => self.parameters.robust_active_weight,
                };
                let (coarser, finer) = self.levels.split_at_mut(grid);
                let (coarse, fine) = (&mut coarser[grid - 1], &mut finer[0]);
                fine.find_residual(&self.model, contact);
                coarse.restrict_from(&self.model, fine, weight);
                self.count(grid, 1.25);
            }
            Step::SolveCoarsest => self.solve_coarsest(),
            Step::Correct { grid } => {
                let contact = self.contact(grid);
                let Parameters { correction_scale, first_grid, .. } = self.parameters;
                let may_scale = self.model.layers() > 1;
                let is_scaled = may_scale && (grid <= *first_grid || self.convergence.was_slow);
                let least = correction_scale.filter(|_| is_scaled);
                let (coarser, finer) = self.levels.split_at_mut(grid);
                let (coarse, fine) = (&coarser[grid - 1], &mut finer[0]);
                let Some(least) = least else { return fine.correct(coarse, &mut self.row) };
                fine.correct_scaled(&self.model, contact, coarse, least, &mut self.row);
                self.count(grid, 1.0);
            }
            Step::CheckConvergence => {}
        }
    }

    fn solve_coarsest(&mut self) {
        let contact = self.contact(0);
        let parameters = self.parameters;
        let smoothing = match self.grid {
            0 => self.parameters.coarsest_start,
            _ => self.parameters.coarsest_smoothing,
        };
        let level = &mut self.levels[0];
        if self.grid == 0 || self.mode == Mode::Robust {
            level.invert_blocks(&self.model);
        }
        let mut evaluations = 0.0;
        for _ in 0..parameters.coarsest_rounds {
            for &omega in smoothing {
                evaluations += level.smooth(&self.model, contact, parameters.damping(omega));
            }
        }
        self.count(0, evaluations);
    }

    fn contact(&self, grid: usize) -> Contact {
        if grid == self.grid { Contact::OneSided } else { Contact::Inherited }
    }

    /// Counts evaluations of the forces of a grid.
    pub(super) fn count(&mut self, grid: usize, evaluations: f64) {
        let coarser = (self.levels.len() - 1 - grid) as i32;
        self.work_units += evaluations * 0.25_f64.powi(coarser);
    }
}

#[cfg(test)]
mod tests {
    use super::super::parameters::MEMBRANE;
    use super::*;

    #[test]
    fn a_later_cycle_of_three_grids_smooths_twice_on_the_way_down_and_up() {
        let mut steps = Vec::new();
        let plan = Plan {
            top: 2,
            cycles: 3,
            mode: Mode::Fast,
            is_continued: false,
            parameters: &MEMBRANE,
        };
        plan.v_cycle(&mut steps);
        let smooth = |grid: usize| [1.6, 0.5].map(|omega| Step::Smooth { grid, omega });
        let mut expected = Vec::new();
        for grid in [2, 1] {
            expected.extend(smooth(grid));
            expected.push(Step::Restrict { grid });
        }
        expected.push(Step::SolveCoarsest);
        for grid in [1, 2] {
            expected.push(Step::Correct { grid });
            expected.extend(smooth(grid));
        }
        expected.push(Step::CheckConvergence);
        assert_eq!(steps, expected);
    }
}

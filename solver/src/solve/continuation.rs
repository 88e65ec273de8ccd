//! A problem that continues from the solution of the one before: see `fas/continuation.rs`.

use super::multigrid::Multigrid;
use super::yielding::Yielding;
use super::{Displayed, Method, Problem, Progress, Solver, Stage, Verdict, above_at_rest};
use std::sync::Arc;

/// Solves in a row that continue: the estimated error of the discretisation is that of the last solve from nothing.
const MOST_IN_A_ROW: u32 = 16;

impl Solver {
    /// Starts another problem from the last solution, moved along with the dome, where that is possible and worth while, else as
    /// [`Self::restart`]; returns whether it does. Of layered tissue with a converged solution, the same law, grid and symmetry. An implant
    /// that yields continues from the numbers of its last deformation.
    ///
    /// A solve that begins too far from its solution starts from nothing after the first cycle. The estimated error of the discretisation is
    /// that of the last solve from nothing, at most 16 solves before.
    pub fn continue_with(&mut self, problem: Problem) -> bool {
        if !self.may_continue(&problem) {
            self.restart(problem);
            return false;
        }
        let (stop, draft) = (self.stop(), self.options.draft_tolerance);
        let does_continue = self.multigrid.as_mut().is_some_and(|multigrid| {
            multigrid.continue_from(&self.problem, &problem, &self.law, stop, draft)
        });
        if !does_continue {
            self.restart(problem);
            return false;
        }
        let before = std::mem::replace(&mut self.problem, Arc::new(problem));
        if self.problem.rest != before.rest {
            self.x = self.problem.rest.nodes(0).collect();
            self.outer = above_at_rest(&self.problem.rest);
        }
        self.continued += 1;
        self.verdict = Verdict::NotConverged;
        self.progress = Progress::Working;
        self.displayed = Displayed::Previous;
        true
    }

    fn may_continue(&self, problem: &Problem) -> bool {
        let mirrored = problem.mirrored().map(|holds| self.options.use_symmetry && holds);
        let fits = |multigrid: &Multigrid| multigrid.fits(problem, mirrored, &self.law);
        let yields = |problem: &Problem| Yielding::of(problem, mirrored).is_some();
        let is_like_before = self.has_law_of(problem)
            && yields(problem) == yields(&self.problem)
            && problem.void.is_none()
            && self.problem.void.is_none()
            && problem.rest.growth() <= 0.0
            && self.problem.rest.growth() <= 0.0;
        self.options.method == Method::Automatic
            && (self.stage, self.verdict) == (Stage::Multigrid, Verdict::Converged)
            && self.attempts == 1
            && self.continued < MOST_IN_A_ROW
            && is_like_before
            && self.multigrid.as_ref().is_some_and(fits)
    }

    /// Starts the present problem from nothing if it was continued.
    pub(super) fn starts_from_nothing(&mut self) -> bool {
        let stop = self.stop();
        let Some(multigrid) = self.multigrid.as_mut().filter(|multigrid| multigrid.is_continued())
        else {
            return false;
        };
        multigrid.start_from_nothing(&self.problem, stop);
        self.continued = 0;
        true
    }
}

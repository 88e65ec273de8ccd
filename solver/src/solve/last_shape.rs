//! The shape of a solve that ends without convergence: the valid shape with the least estimated error.

use super::multigrid::Multigrid;
use super::{Displayed, Invalid, Progress, Solver, Stage, Verdict, fas};

/// Estimated error below which the last shape of a failed multigrid solve of layered tissue is a start of Newton's method,
/// and a shape to display \[base radius\].
const MAX_ERROR_OF_SHAPE: f64 = 0.01;

impl Solver {
    /// Displays the last shape of a failed attempt on the finest grid if its estimated error is the least so far; the shape of a
    /// coarse grid is far from the finest grid's.
    pub(super) fn keep_shape(&mut self) {
        let Some(ending) = self.multigrid.as_ref().map(Multigrid::ending) else { return };
        let most = MAX_ERROR_OF_SHAPE * self.problem.obstacle.dome.reference_length();
        let most = self.kept.map_or(most, |kept| kept.error);
        let is_candidate = self.law.layered().is_some() && self.cycles() > 0 && ending.error < most;
        if is_candidate && self.display_multigrid(Displayed::Draft) {
            self.kept = Some(ending);
        }
    }

    /// Makes the last shape of layered tissue admissible: a step of Newton's method ends beside the dome by the square of
    /// its length. A shape with an inverted cell is no shape.
    pub(super) fn admit_last_shape(&mut self) {
        let obstacle = &self.problem.obstacle;
        for x in &mut self.x {
            *x = obstacle.project(*x, 0.0);
        }
        if self.solution().has_inverted_cell() {
            self.invalid = Some(Invalid::NotFound);
            self.verdict = Verdict::Unstable;
        }
    }

    /// Ends without convergence: with the last valid shape of either method, if there is one.
    pub(super) fn end_with_last_shape(&mut self) {
        if self.displayed == Displayed::Draft && self.multigrid.is_some() {
            // Newton's method ended without a shape.
            self.stage = Stage::Multigrid;
        }
        let has_shape = matches!(self.displayed, Displayed::Draft | Displayed::Final);
        self.invalid = (!has_shape).then_some(Invalid::NotFound);
        self.end(if has_shape { Verdict::NotConverged } else { Verdict::Unstable });
    }

    /// Ends the solve as not converged, with the last valid shape of the finest grid; without one [`Self::invalid`] is
    /// [`Invalid::NotFound`].
    pub fn give_up(&mut self) {
        if self.progress == Progress::Done {
            return;
        }
        let ending = self.multigrid.as_ref().map(Multigrid::ending);
        let is_better = |kept: fas::Ending| ending.is_some_and(|own| own.error <= kept.error);
        if self.stage == Stage::Multigrid
            && self.cycles() > 0
            && self.kept.is_none_or(is_better)
            && self.display_multigrid(Displayed::Draft)
        {
            self.kept = ending;
        }
        self.end_with_last_shape();
        self.verdict = Verdict::NotConverged;
    }
}

//! The shape of a solve that ends without convergence: the valid shape with the least estimated error, if that is small.

use super::multigrid::Multigrid;
use super::{Displayed, Invalid, Progress, Solver, Stage, Verdict, fas};
use crate::mesh::part::Part;

/// Estimated error up to which the last shape of a failed solve of layered tissue is a start of Newton's method, and a shape to display: beyond, or
/// without an estimate, it is no approximation of an equilibrium, and its forces are those of no tissue \[base radius\].
const MAX_ERROR_OF_SHAPE: f64 = 0.01;

impl Solver {
    /// Displays the last shape of a failed attempt on the finest grid if its estimated error is the least so far; the shape of a
    /// coarse grid is far from the finest grid's.
    pub(super) fn keep_shape(&mut self) {
        if self.law.layered().is_none() || self.cycles() == 0 {
            return;
        }
        let Some(multigrid) = &mut self.multigrid else { return };
        let ending = multigrid.ending_by_balance();
        let is_least = self.kept.is_none_or(|kept| ending.error < kept.error);
        if is_least
            && self.is_approximation(ending.error)
            && self.display_multigrid(Displayed::Draft)
        {
            self.kept = Some(ending);
        }
    }

    /// Is a shape with an estimated error \[mm\] an approximation of the equilibrium?
    pub(super) fn is_approximation(&self, error: f64) -> bool {
        error <= MAX_ERROR_OF_SHAPE * self.problem.obstacle.dome.reference_length()
    }

    /// A shape of layered tissue whose skin lies in the dome, on a grid that is too coarse for it, or with an inverted cell, is no shape.
    pub(super) fn admit_shape(&mut self) {
        if self.verdict == Verdict::Unstable {
            return;
        }
        let is_last = self.verdict == Verdict::NotConverged;
        self.invalid = if is_last && self.last_shape_is_inverted() {
            Some(Invalid::NotFound)
        } else if self.is_skin_pierced() {
            Some(Invalid::Penetrated)
        } else {
            return;
        };
        self.verdict = Verdict::Unstable;
    }

    /// Does the outer surface of the skin lie in the dome at a node?
    fn is_skin_pierced(&self) -> bool {
        let part = Part::new(self.problem.sheet().nodes_per_side(), self.mirrored);
        let Some(membrane) = self.outer.last().filter(|_| self.error_at_rest() > 0.0) else {
            return false;
        };
        let dome = &self.problem.obstacle.dome;
        let draped = dome.draped::<f64>();
        // The membrane is deeper than the outer surface: most skins need no normals.
        part.nodes().any(|k| draped.length_squared(membrane[k].to_array()) < 1.0) && {
            let solution = self.solution();
            part.nodes().any(|k| dome.gauge(solution.outer_surface_at(k).as_dvec3()) < 0.0)
        }
    }

    /// Projects the last shape: a step of Newton's method ends beside the dome by the square of its length. Has it an inverted cell?
    fn last_shape_is_inverted(&mut self) -> bool {
        let obstacle = &self.problem.obstacle;
        for x in &mut self.x {
            *x = obstacle.project(*x, 0.0);
        }
        self.solution().has_inverted_cell()
    }

    /// Is a shape that of the problem, not one on the way there: before the skin has grown, or under a void that is still to be smaller?
    fn has_grown_and_is_sealed(&self) -> bool {
        self.problem.rest.growth() <= 0.0 && self.is_sealed()
    }

    /// Ends without convergence: with the last valid shape of either method, if there is one.
    pub(super) fn end_with_last_shape(&mut self) {
        if self.displayed == Displayed::Draft && self.multigrid.is_some() {
            // Newton's method ended without a shape.
            self.stage = Stage::Multigrid;
        }
        let is_shown = matches!(self.displayed, Displayed::Draft | Displayed::Final);
        let is_near = self.kept.is_some() && self.has_grown_and_is_sealed();
        let has_shape = is_shown && (is_near || self.law.layered().is_none());
        self.invalid = (!has_shape).then_some(Invalid::NotFound);
        self.end(if has_shape { Verdict::NotConverged } else { Verdict::Unstable });
    }

    /// Ends the solve as not converged, with the last valid shape of the finest grid; without one [`Self::invalid`] is
    /// [`Invalid::NotFound`].
    pub fn give_up(&mut self) {
        if self.progress == Progress::Done {
            return;
        }
        let is_begun = self.stage == Stage::Multigrid && self.cycles() > 0;
        let multigrid = self.multigrid.as_mut().filter(|_| is_begun);
        let ending = multigrid.map(Multigrid::ending_by_balance);
        let is_better = |kept: fas::Ending| ending.is_some_and(|own| own.error <= kept.error);
        let is_near = ending.is_some_and(|own| self.is_approximation(own.error));
        if is_begun
            && (is_near || self.law.layered().is_none())
            && self.kept.is_none_or(is_better)
            && self.display_multigrid(Displayed::Draft)
        {
            self.kept = ending;
        }
        self.end_with_last_shape();
        self.verdict = Verdict::NotConverged;
    }

    /// Ends the solve as if the last shape were invalid, for tests of what follows.
    #[doc(hidden)]
    pub fn end_with(&mut self, invalid: Invalid) {
        self.invalid = Some(invalid);
        self.end(Verdict::NotConverged);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Dome, HalfBall, Obstacle};
    use crate::solve::{Method, Options, samples};
    use glam::DVec2;

    /// Newton's method that ends after any part of its work, against its solution.
    #[test]
    fn a_failed_solve_has_a_shape_near_the_solution_or_none() {
        let mut problem = samples::layered_at_rest(17);
        let dome = Dome::new(DVec2::ZERO, HalfBall::round(50.0, 45.0), 1.0);
        problem.obstacle = Obstacle::on_flat_wall(dome);
        problem.tolerance = 1e-6;
        let solved = |work_limit_factor: f64| {
            let method = Method::Newton;
            let options = Options { method, work_limit_factor, ..Options::default() };
            let mut solver = Solver::with_options(problem.clone(), options);
            solver.advance(&mut || false);
            solver
        };
        let whole = solved(1.0);
        assert_eq!(whole.verdict(), Verdict::Converged);
        let mut endings = [0; 3];
        for k in 0..24 {
            // The limit on a grid this coarse.
            let part = 0.72 + 0.0125 * f64::from(k);
            let solver = solved(part * whole.work_units() / 7500.0);
            let error = solver.estimated_position_error();
            let found = solver.positions().iter().zip(whole.positions());
            let most = found.map(|(x, y)| x.distance(*y)).fold(0.0, f64::max) / 50.0;
            match (solver.verdict(), solver.invalid()) {
                (Verdict::Converged, None) => endings[0] += 1,
                (Verdict::NotConverged, None) => {
                    assert!(error <= 0.01 && most <= 3.0 * error, "{part}: {error} {most}");
                    endings[1] += 1;
                }
                (Verdict::Unstable, Some(_)) => endings[2] += 1,
                other => panic!("{part}: {other:?}"),
            }
        }
        assert!(endings.iter().all(|count| *count > 0), "{endings:?}");
    }
}

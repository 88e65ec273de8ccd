//! Newton's method for either tissue model; the equilibrium on the branch of a shape.

use super::multigrid::{Law, Multigrid};
use super::newton::{LayeredSystem, NestedNewton, SheetSystem, Start, State};
use super::validity::Invalid;
use super::{Method, Options, Problem, Solver};
use glam::DVec3;

/// Newton's method for one tissue model.
pub(super) enum NewtonMethod {
    Sheet(Box<NestedNewton<SheetSystem>>),
    Layered(Box<NestedNewton<LayeredSystem>>),
}

macro_rules! delegate {
    ($self:ident, $newton:ident => $call:expr) => {
        match $self {
            Self::Sheet($newton) => $call,
            Self::Layered($newton) => $call,
        }
    };
    ($self:ident, $law:ident, $newton:ident => $call:expr) => {
        match ($self, $law) {
            (Self::Sheet($newton), Law::Sheet($law)) => Some($call),
            (Self::Layered($newton), Law::Layered($law)) => Some($call),
            _ => None,
        }
    };
}

impl NewtonMethod {
    /// Allocates the grids. The factor multiplies iteration and work limits.
    pub(super) fn new(problem: &Problem, law: &Law, factor: f64) -> Self {
        match law {
            Law::Sheet(_) => {
                Self::Sheet(Box::new(NestedNewton::<SheetSystem>::new(problem, factor)))
            }
            Law::Layered(_) => {
                Self::Layered(Box::new(NestedNewton::<LayeredSystem>::new(problem, factor)))
            }
        }
    }

    /// Starts on the coarsest grid, of a sheet from the initial guess, of layered tissue from rest under a rising dome.
    pub(super) fn start_cold(&mut self, problem: &Problem, law: &Law) {
        delegate!(self, law, newton => newton.start_cold(law, problem));
    }

    /// Starts from the positions of the inner face and of the layers of nodes above.
    pub(super) fn start_from(
        &mut self,
        start: Start,
        shape: (&[DVec3], &[Vec<DVec3>]),
        problem: &Problem,
        law: &Law,
    ) {
        delegate!(self, law, newton => newton.start_from(start, shape, law, problem));
    }

    pub(super) fn step(&mut self, problem: &Problem, law: &Law) -> State {
        delegate!(self, law, newton => newton.step(law, problem)).unwrap_or(State::Stalled)
    }

    pub(super) fn is_on_finest(&self) -> bool {
        delegate!(self, newton => newton.is_on_finest())
    }

    /// The grid being solved, counted from 1 for the coarsest, and the number of grids.
    pub(super) fn grid(&self) -> (usize, usize) {
        delegate!(self, newton => newton.grid())
    }

    /// Number of changes of the finest grid's positions.
    pub(super) fn revision(&self) -> u64 {
        delegate!(self, newton => newton.revision())
    }

    pub(super) fn relative_residual(&self) -> f64 {
        delegate!(self, newton => newton.relative_residual())
    }

    /// Estimated greatest node position error of the finest grid \[mm\]; infinite for layered tissue without a balance of forces.
    pub(super) fn error(&self) -> f64 {
        match self {
            Self::Layered(newton) if !newton.is_balanced() => f64::INFINITY,
            Self::Layered(newton) => newton.error(),
            Self::Sheet(newton) => newton.error(),
        }
    }

    /// Work since the last [`Self::clear_work`] \[evaluations of all nodal forces on the finest grid\].
    pub(super) fn work_units(&self) -> f64 {
        delegate!(self, newton => newton.work_units())
    }

    pub(super) fn clear_work(&mut self) {
        delegate!(self, newton => newton.clear_work());
    }

    /// Why the finest grid's shape is invalid.
    pub(super) fn invalid(&self, problem: &Problem) -> Option<Invalid> {
        delegate!(self, newton => newton.invalid(problem))
    }

    /// Writes the positions \[mm\] of the inner face, of nodes with contact offsets and of the layers of nodes above.
    pub(super) fn write_positions(
        &self,
        problem: &Problem,
        inner: &mut [DVec3],
        offset_nodes: &mut Vec<(usize, DVec3)>,
        outer: &mut [Vec<DVec3>],
    ) {
        delegate!(self, newton => newton.write_positions(problem, inner, offset_nodes, outer));
    }
}

impl Solver {
    /// Starts Newton's method from the solution of multigrid.
    pub(super) fn complete_multigrid(&mut self) {
        let ending = self.multigrid.as_ref().map(Multigrid::ending);
        let is_layered = self.law.layered().is_some();
        // A shape with a greater error replaces it only where Newton's method converges.
        self.kept = ending.filter(|_| is_layered);
        let is_rounding = ending.is_some_and(|ending| ending.has_rounded_forces);
        self.start_newton(match () {
            // From rounding it would stall.
            () if is_rounding => Start::Cold,
            () if is_layered => Start::Refining,
            () => Start::FromSolution,
        });
    }

    /// The solution of the same problem with another tolerance \[base radius\] by Newton's method from the present shape: an
    /// equilibrium on the branch of that shape, where a solve from rest may end on another branch. A factor multiplies the limits of
    /// work.
    #[must_use]
    pub fn refined(&self, tolerance: f64, work_limit_factor: f64) -> Self {
        let problem = Problem { tolerance, ..Problem::clone(&self.problem) };
        let options = Options { method: Method::Newton, work_limit_factor, ..self.options };
        let mut refined = Self::with_options(problem, options);
        refined.x.clone_from(&self.x);
        refined.outer.clone_from(&self.outer);
        refined.start_newton(Start::FromSolution);
        refined.advance(&mut || false);
        refined
    }
}

//! Newton's method for either tissue model.

use super::Problem;
use super::multigrid::Law;
use super::newton::{LayeredSystem, NestedNewton, SheetSystem, State};
use super::validity::Invalid;
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
        shape: (&[DVec3], &[Vec<DVec3>]),
        problem: &Problem,
        law: &Law,
    ) {
        delegate!(self, law, newton => newton.start_from(shape, law, problem));
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

    /// Estimated greatest node position error of the finest grid \[mm\].
    pub(super) fn error(&self) -> f64 {
        delegate!(self, newton => newton.error())
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

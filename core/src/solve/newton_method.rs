//! Newton's method for either tissue model.

use super::Problem;
use super::multigrid::Law;
use super::newton::{Mirrors, NestedNewton, State};
use super::newton_layers::NestedLayers;
use super::validity::Invalid;
use glam::DVec3;

/// Newton's method for one tissue model.
pub(super) enum NewtonMethod {
    Sheet(Box<NestedNewton>),
    Layered(Box<NestedLayers>),
}

macro_rules! delegate {
    ($self:ident, $newton:ident => $call:expr) => {
        match $self {
            Self::Sheet($newton) => $call,
            Self::Layered($newton) => $call,
        }
    };
}

impl NewtonMethod {
    /// Allocates the grids. The factor multiplies iteration and work limits.
    pub(super) fn new(problem: &Problem, law: &Law, work_limit_factor: f64) -> Self {
        let sheet = &problem.sheet;
        match law.layered() {
            None => Self::Sheet(Box::new(NestedNewton::new(sheet, work_limit_factor))),
            Some(law) => Self::Layered(Box::new(NestedLayers::new(sheet, law, work_limit_factor))),
        }
    }

    /// Starts on the coarsest grid, of a sheet from the initial guess, of layered tissue from rest under a rising dome.
    pub(super) fn start_cold(&mut self, problem: &Problem, law: &Law, mirrors: Mirrors) {
        match (self, law.layered()) {
            (Self::Sheet(newton), _) => newton.start_cold(&problem.obstacle, mirrors),
            (Self::Layered(newton), Some(law)) => newton.start_cold(law, problem),
            (Self::Layered(_), None) => {}
        }
    }

    /// Starts from the positions of the inner face and of the layers of nodes above.
    pub(super) fn start_from(
        &mut self,
        inner: &[DVec3],
        outer: &[Vec<DVec3>],
        problem: &Problem,
        law: &Law,
        mirrors: Mirrors,
    ) {
        match (self, law.layered()) {
            (Self::Sheet(newton), _) => newton.start_from(inner, &problem.obstacle, mirrors),
            (Self::Layered(newton), Some(law)) => newton.start_from(inner, outer, law, problem),
            (Self::Layered(_), None) => {}
        }
    }

    pub(super) fn step(&mut self, problem: &Problem, law: &Law) -> State {
        let Problem { springs, obstacle, tolerance, .. } = problem;
        match (self, law.layered()) {
            (Self::Sheet(newton), _) => {
                let tolerance_mm = tolerance * obstacle.dome.reference_length();
                newton.step(*springs, law.membrane(), obstacle, tolerance_mm)
            }
            (Self::Layered(newton), Some(law)) => newton.step(law, problem),
            (Self::Layered(_), None) => State::Stalled,
        }
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
        delegate!(self, newton => newton.finest().revision())
    }

    pub(super) fn relative_residual(&self) -> f64 {
        delegate!(self, newton => newton.finest().relative_residual())
    }

    /// Estimated greatest node position error of the finest grid \[mm\].
    pub(super) fn error(&self) -> f64 {
        delegate!(self, newton => newton.finest().error())
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
        let (dome, tolerance) = (&problem.obstacle.dome, problem.tolerance);
        delegate!(self, newton => newton.finest().invalid(dome, tolerance))
    }

    /// Writes the positions \[mm\] of the inner face and of the layers of nodes above.
    pub(super) fn write_positions(
        &self,
        problem: &Problem,
        inner: &mut [DVec3],
        offset_nodes: &mut Vec<(usize, DVec3)>,
        outer: &mut [Vec<DVec3>],
    ) {
        match self {
            Self::Sheet(newton) => {
                newton.finest().write_positions(&problem.obstacle.dome, inner, offset_nodes);
            }
            Self::Layered(newton) => {
                offset_nodes.clear();
                newton.finest().write_positions(inner, outer);
            }
        }
    }
}

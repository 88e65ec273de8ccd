//! The equilibrium: the minimum of the sheet's energy outside the dome and above the wall.

mod guess;

use crate::curve::Curve;
use crate::implant::Dome;
use crate::measure::Status;
use crate::sheet::Sheet;
use glam::DVec3;

/// One layer as the solver needs it.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Stress–strain curve.
    pub curve: Curve,
    /// Poisson ratio \[-\].
    pub poisson_ratio: f64,
    /// Thickness \[mm\].
    pub thickness_mm: f64,
}

/// What is to be solved.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The finest grid.
    pub sheet: Sheet,
    /// The obstacle.
    pub dome: Dome,
    /// Layers from the skin inwards.
    pub materials: Vec<Material>,
}

/// Is there more to do?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Call again.
    Working,
    /// The solve has ended; its status tells how.
    Done,
}

/// Finds the equilibrium of one problem after the other, in slices.
pub struct Solver {
    problem: Problem,
    positions: Vec<DVec3>,
}

impl Solver {
    /// A solver at its first guess.
    #[must_use]
    pub fn new(problem: Problem) -> Self {
        let positions = guess::tight_string(&problem.sheet, &problem.dome);
        Self { problem, positions }
    }

    /// Takes up another problem, from the present shape where that helps.
    pub fn restart(&mut self, problem: Problem) {
        *self = Self::new(problem);
    }

    /// Does steps until `pause` says so or the solve ends.
    pub fn advance(&mut self, _pause: &mut dyn FnMut() -> bool) -> Progress {
        Progress::Done
    }

    /// The problem being solved.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// How the solve stands.
    #[must_use]
    pub fn status(&self) -> Status {
        Status::NotConverged
    }

    /// Node positions \[mm\], shape (nodes_per_side², ).
    #[must_use]
    pub fn positions(&self) -> &[DVec3] {
        &self.positions
    }

    /// Force evaluations so far, in work units of the finest grid.
    #[must_use]
    pub fn work_units(&self) -> f64 {
        0.0
    }
}

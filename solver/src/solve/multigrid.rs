//! Full multigrid for either tissue model.

use super::Problem;
use super::fas::{
    Ending, FullMultigrid, LAYERED, LAYERED_FRESH, LAYERED_GENTLE, LAYERED_RISING, MEMBRANE,
    MEMBRANE_GENTLE, State, Stop,
};
use super::problem::Tissue;
use super::validity::Invalid;
use crate::contact::Modes;
use crate::mesh::lanes::Mirrored;
use crate::model::layered::LayeredLaw;
use crate::model::layered::lanes::{Layered, OnFinest};
use crate::model::membrane::lanes::Membrane;
use crate::model::membrane::law::SheetLaw;
use crate::springs::Springs;
use glam::DVec3;
use std::sync::Arc;

/// The most attempts for layered tissue over a chest or of uneven thickness.
const MOST_ATTEMPTS: u32 = 10;

/// Change of the tissue in a cycle, by the last move of an implant that yields, up to which its numbers step in the second and third round of
/// attempts \[-\]. Saline under tight skin: of four patients two need the one, one the other.
const PATIENCE: [f64; 2] = [1.0, 0.6];

/// Work after which no further attempt begins \[force evaluations times cells: two seconds of a core\], and the least limit, on fine grids
/// \[force evaluations\].
const MOST_WORK: (f64, f64) = (36e6, 400.0);

/// An attempt: how many rounds are over, and its number in the round, from 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Attempt {
    round: usize,
    number: u32,
}

impl Attempt {
    pub(super) const FIRST: Self = Self { round: 0, number: 1 };
}

/// The laws of a problem.
#[derive(Clone, Debug)]
pub(super) enum Law {
    Sheet(Arc<SheetLaw>),
    Layered(Arc<LayeredLaw>),
}

impl Law {
    pub(super) fn new(problem: &Problem) -> Self {
        match problem.tissue {
            Tissue::Sheet => {
                Self::Sheet(Arc::new(SheetLaw::new(problem.springs, &problem.materials)))
            }
            Tissue::Layered => {
                let law = LayeredLaw::new(&problem.materials);
                Self::Layered(Arc::new(law))
            }
        }
    }

    /// The law of the sheet, or of the skin.
    pub(super) fn membrane(&self) -> &SheetLaw {
        match self {
            Self::Sheet(law) => law,
            Self::Layered(law) => &law.skin,
        }
    }

    pub(super) fn layered(&self) -> Option<&LayeredLaw> {
        match self {
            Self::Sheet(_) => None,
            Self::Layered(law) => Some(law),
        }
    }
}

/// The scheme for one tissue model.
#[derive(Clone)]
pub(super) enum Multigrid {
    Sheet(Box<FullMultigrid<Membrane>>),
    Layered(Box<FullMultigrid<Layered>>),
}

macro_rules! delegate {
    ($self:ident, $scheme:ident => $call:expr) => {
        match $self {
            Self::Sheet($scheme) => $call,
            Self::Layered($scheme) => $call,
        }
    };
}

fn layered(problem: &Problem, law: &LayeredLaw) -> Layered {
    let Problem { rest, patch, obstacle, .. } = problem;
    let tissue = Layered::new(law, rest, patch.pocket(), patch.attachment());
    let (kpa, wall) = (problem.suction_kpa(), obstacle.wall.0.clone());
    tissue.under(OnFinest { kpa, wall, nodes_per_side: problem.sheet().nodes_per_side() })
}

impl Multigrid {
    pub(super) fn new(problem: &Problem, law: &Law, mirrored: Mirrored) -> Self {
        let n = problem.sheet().nodes_per_side();
        match law {
            Law::Sheet(law) => Self::Sheet(Box::new(FullMultigrid::new(
                n,
                mirrored,
                Membrane::new(law),
                &MEMBRANE,
            ))),
            Law::Layered(law) => Self::Layered(Box::new(FullMultigrid::new(
                n,
                mirrored,
                layered(problem, law),
                &LAYERED,
            ))),
        }
    }

    /// Do the grids fit a problem, its symmetry and law?
    pub(super) fn fits(&self, problem: &Problem, mirrored: Mirrored, law: &Law) -> bool {
        let (nodes_per_side, layers) = (problem.sheet().nodes_per_side(), problem.rest.layers());
        matches!((self, law), (Self::Sheet(_), Law::Sheet(_)) | (Self::Layered(_), Law::Layered(_)))
            && delegate!(self, scheme => scheme.fits(nodes_per_side, mirrored, layers))
    }

    /// Replaces the model, of the same kind.
    pub(super) fn set_model(&mut self, problem: &Problem, law: &Law) {
        match (self, law) {
            (Self::Sheet(scheme), Law::Sheet(law)) => scheme.set_model(Membrane::new(law)),
            (Self::Layered(scheme), Law::Layered(law)) => scheme.set_model(layered(problem, law)),
            _ => {}
        }
    }

    /// Continues from the solution with skin that has grown, or under another suction.
    pub(super) fn grow(&mut self, problem: &Problem, law: &Law, stop: Stop) {
        if let (Self::Layered(scheme), Law::Layered(law)) = (self, law) {
            scheme.grow(layered(problem, law), stop, problem.rest.growth() > 0.0);
        }
    }

    pub(super) fn start(&mut self, problem: &Problem, stop: Stop, draft: Option<f64>) {
        // An earlier solve may have ended in another attempt.
        match self {
            Self::Sheet(scheme) => scheme.set_parameters(&MEMBRANE),
            Self::Layered(scheme) => scheme.set_parameters(&LAYERED),
        }
        delegate!(self, scheme => scheme.start(problem, stop, draft));
    }

    /// Continues from the solution of layered tissue of another problem with the same law; false where that is not possible, and nothing is
    /// changed.
    pub(super) fn continue_from(
        &mut self,
        before: &Problem,
        problem: &Problem,
        law: &Law,
        stop: Stop,
        draft: Option<f64>,
    ) -> bool {
        let (Self::Layered(scheme), Law::Layered(law)) = (self, law) else { return false };
        let Some(moves) = scheme.moves(before, problem) else { return false };
        if problem.rest != before.rest || problem.patch != before.patch {
            scheme.set_model(layered(problem, law));
        }
        scheme.continue_by(&moves, problem, stop, draft);
        true
    }

    /// Does the solve continue from the solution of another problem?
    pub(super) fn is_continued(&self) -> bool {
        delegate!(self, scheme => scheme.is_continued())
    }

    /// See [`FullMultigrid::start_from_nothing`].
    pub(super) fn start_from_nothing(&mut self, problem: &Problem, stop: Stop) {
        delegate!(self, scheme => scheme.start_from_nothing(problem, stop));
    }

    /// Starts the next attempt; false after the last one. An implant that yields has further rounds of attempts, in which its numbers wait for the
    /// tissue.
    pub(super) fn start_again(
        &mut self,
        problem: &Problem,
        stop: Stop,
        attempt: &mut Attempt,
    ) -> bool {
        if self.has_worked_enough(problem) {
            return false;
        }
        attempt.number += 1;
        if !self.start_attempt(problem, stop, attempt.number) {
            if attempt.round == PATIENCE.len() || self.modes().is_none() || self.is_slow() {
                return false;
            }
            *attempt = Attempt { round: attempt.round + 1, number: 2 };
            if !self.start_attempt(problem, stop, attempt.number) {
                return false;
            }
        }
        let patience = attempt.round.checked_sub(1).map(|round| PATIENCE[round]);
        delegate!(self, scheme => scheme.wait_for_tissue(patience));
        true
    }

    fn has_worked_enough(&self, problem: &Problem) -> bool {
        let (most, least) = MOST_WORK;
        let cells = self.nodes() * problem.rest.cells().len().max(1);
        self.work_units() > (most / cells as f64).max(least)
    }

    fn is_slow(&self) -> bool {
        delegate!(self, scheme => scheme.is_slow())
    }

    /// Starts an attempt of a round, by other constants; false after the last attempt: of a sheet the second, of the paper's springs the
    /// first; of layered tissue over even tissue on a flat wall the second, else the third and those that go on from a dome of its rise, unless one
    /// ended slowly near its solution, as skin in folds does in a hollow.
    pub(super) fn start_attempt(&mut self, problem: &Problem, stop: Stop, attempt: u32) -> bool {
        let scheme = match self {
            Self::Sheet(scheme) => {
                let has_another = attempt == 2 && problem.springs == Springs::Coupled;
                if has_another {
                    scheme.start_again(&MEMBRANE_GENTLE, problem, stop);
                }
                return has_another;
            }
            Self::Layered(scheme) => scheme,
        };
        let (solids, is_even) = (problem.solids(), problem.rest.is_even());
        let only_stiffens = solids.iter().any(|solid| solid.curve.stiffens())
            && !solids.iter().any(|solid| solid.curve.softens());
        let parameters = match attempt {
            1 => &LAYERED,
            _ if !is_even && scheme.is_slow() => return false,
            2 if only_stiffens => &LAYERED_FRESH,
            2 => &LAYERED_GENTLE,
            3 if !is_even => &LAYERED_RISING,
            4..=MOST_ATTEMPTS if !is_even => return scheme.rise_on(problem, stop),
            _ => return false,
        };
        scheme.start_again(parameters, problem, stop);
        true
    }

    pub(super) fn step(&mut self) -> State {
        delegate!(self, scheme => scheme.step())
    }

    pub(super) fn finest_cycles(&self) -> u32 {
        delegate!(self, scheme => scheme.finest_cycles())
    }

    pub(super) fn nodes(&self) -> usize {
        delegate!(self, scheme => scheme.nodes())
    }

    /// Is the shape mirrored along x, along y?
    pub(super) fn mirrored(&self) -> Mirrored {
        delegate!(self, scheme => scheme.mirrored())
    }

    pub(super) fn lanes(&self) -> usize {
        delegate!(self, scheme => scheme.lanes())
    }

    pub(super) fn work_units(&self) -> f64 {
        delegate!(self, scheme => scheme.work_units())
    }

    /// The least tolerance of node positions that f32 resolves \[base radius\].
    pub(super) fn least_tolerance(&self) -> f64 {
        delegate!(self, scheme => scheme.least_tolerance())
    }

    pub(super) fn ending(&self) -> Ending {
        delegate!(self, scheme => scheme.ending())
    }

    /// See [`FullMultigrid::ending_by_balance`].
    pub(super) fn ending_by_balance(&mut self) -> Ending {
        delegate!(self, scheme => scheme.ending_by_balance())
    }

    /// See [`FullMultigrid::change_by_refinement`].
    pub(super) fn change_by_refinement(&self) -> Option<f64> {
        delegate!(self, scheme => scheme.change_by_refinement())
    }

    pub(super) fn preview(&mut self) -> usize {
        delegate!(self, scheme => scheme.preview())
    }

    pub(super) fn invalid(&self, problem: &Problem) -> Option<Invalid> {
        delegate!(self, scheme => scheme.invalid(problem))
    }

    /// See [`FullMultigrid::modes`].
    pub(super) fn modes(&self) -> Option<Modes<f64>> {
        delegate!(self, scheme => scheme.modes())
    }

    /// Writes the positions \[mm\] of the inner face and of the layers of nodes above.
    pub(super) fn write_positions(
        &self,
        problem: &Problem,
        x: &mut [DVec3],
        offset_nodes: &mut Vec<(usize, DVec3)>,
        outer: &mut [Vec<DVec3>],
    ) {
        delegate!(self, scheme => scheme.write_positions(problem, x, offset_nodes));
        if let Self::Layered(scheme) = self {
            scheme.write_layers(&problem.rest, outer);
        }
    }
}

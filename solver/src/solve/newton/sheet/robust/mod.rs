//! Safeguards near singular stiffness; skip on first reading.
//!
//! Each file is one safeguard with symptom, cause, remedy and its scene in `tests/stress`. No safeguard acts in
//! scenes that full multigrid solves.
//!
//! `curvature` (the dome's curvature makes the model indefinite) | `sweeps` (no step lowers the energy) | `step_extension`, `partan` (the model is too stiff) | `domain`
//! (springs outside of their law's domain) | `stability` (saddle points of the paper's springs).

mod curvature;
mod domain;
mod partan;
mod stability;
mod step_extension;
mod sweeps;

use super::{Phase, Piece, SheetCase, SheetNewton, SheetSystem, State, System, Trial, cost};
use crate::contact::TOUCH_F64;
use crate::model::membrane::assembly::Stiffness;
use curvature::{AcceptedStep, Curvature};
use glam::DVec3;

/// Methods of one iteration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum StepMethod {
    SweepsAndGradients,
    SweepsOnly,
}

/// State of the safeguards of one grid.
pub(super) struct Robust {
    curvature: Curvature,
    step_method: StepMethod,
    /// Number of consecutive iterations with springs outside of their law's domain.
    outside: u32,
    /// Greatest accepted extension of a step so far \[-\].
    pub(super) step_growth: f64,
    /// Decaying distance of step extensions \[mm\].
    pub(super) extrapolation: f64,
    /// Positions before the last two steps; valid with `has_earlier`.
    earlier: Vec<DVec3>,
    has_earlier: bool,
}

/// A safeguard's piece of work.
#[derive(Clone, Copy)]
pub(in crate::solve) enum SafeguardPhase {
    /// Extends a step or the sum of the last two steps; `energy` is the energy to undercut.
    Extend { length: f64, energy: f64, direction: Direction },
    /// Assembles rows of the exact Hessian from `row` on; the iteration of a stable shape ends in `after`.
    ExactHessian { row: usize, after: State },
    /// Searches the least eigenvalue of the exact Hessian; ends in `after` unless the eigenvalue is negative.
    Stability { step: u32, after: State },
}

/// Direction of an extension.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(in crate::solve) enum Direction {
    Step,
    /// The sum of the last two steps.
    TwoSteps,
}

impl Robust {
    pub(super) fn new(size: usize) -> Self {
        Self {
            curvature: Curvature::default(),
            step_method: StepMethod::SweepsAndGradients,
            outside: 0,
            step_growth: 1.0,
            extrapolation: 0.0,
            earlier: vec![DVec3::ZERO; size],
            has_earlier: false,
        }
    }

    /// Resets the state for another solve.
    pub(super) fn start(&mut self) {
        self.curvature = Curvature::default();
        self.step_method = StepMethod::SweepsAndGradients;
        self.outside = 0;
        self.step_growth = 1.0;
        self.extrapolation = 0.0;
        self.has_earlier = false;
    }

    pub(super) fn has_sweeps_only(&self) -> bool {
        self.step_method == StepMethod::SweepsOnly
    }

    /// Records an accepted step of the line search; `is_full` at length one.
    pub(super) fn accept_step(&mut self, is_full: bool, iterations: u32) -> AcceptedStep {
        let had_curvature = self.has_curvature();
        let is_whole = is_full && !self.has_sweeps_only();
        if is_full {
            self.step_method = StepMethod::SweepsAndGradients;
        }
        self.curvature.expire(iterations);
        AcceptedStep { is_whole, had_curvature }
    }
}

impl SheetNewton {
    /// Does a safeguard's piece of work.
    pub(super) fn robust_step(&mut self, case: &SheetCase, phase: SafeguardPhase) -> State {
        match phase {
            SafeguardPhase::Extend { length, energy, direction } => {
                self.extend(case, length, energy, direction);
                State::Working
            }
            SafeguardPhase::ExactHessian { row, after } => {
                self.assemble_exact_hessian(case, row, after);
                State::Working
            }
            SafeguardPhase::Stability { step, after } => {
                self.search_eigenvalue(case.law, step, after)
            }
        }
    }

    /// Assembles rows of the exact Hessian; after the last row adds the contact and begins the search of the least eigenvalue.
    fn assemble_exact_hessian(&mut self, case: &SheetCase, row: usize, after: State) {
        if row == 0 {
            self.work_units += SheetSystem::PARAMETERS.cost.linearize;
        }
        if let Some(row) = self.add_rows(case.law, row, Stiffness::True) {
            let phase = SafeguardPhase::ExactHessian { row, after };
            self.phase = Phase::Own(Piece::Robust(phase));
            return;
        }
        self.find_contact(&case.obstacle, TOUCH_F64);
        self.add_curvature();
        (0..self.grid.free.len()).for_each(|k| self.constrain(self.grid.free[k] as usize));
        self.begin_eigenvalue_search(after);
    }

    /// Ends a line search without a decrease of the energy.
    pub(super) fn reject_step(&mut self, is_uphill: bool) -> State {
        if self.turns_to_sweeps(is_uphill) || self.turns_curvature_off() {
            State::Working
        } else {
            State::Stalled
        }
    }

    /// Continues from a slightly changed shape with the previous error and the previous stiffness of the model.
    pub(super) fn keep_error(&mut self) {
        self.last_step = f64::INFINITY;
        self.system.robust.extrapolation = self.error;
        self.system.robust.has_earlier = false;
        self.system.robust.curvature.retries = 0;
    }
}

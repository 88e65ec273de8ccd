//! Steps longer than the model's.
//!
//! Symptom: many small steps beside a dome at the pocket's rim (`slow-convergence-beside-dome`,
//! `slow-convergence-beside-dome-at-rim`). Cause: without tension the positive semidefinite model of the
//! sheet is too stiff. Remedy: a step that lowers the energy by nearly the whole first-order prediction is extended,
//! by doubling, while the energy falls.

use super::{
    Direction, Phase, Piece, Robust, SafeguardPhase, SheetCase, SheetNewton, SheetSystem, System,
    Trial,
};

/// Fraction of the first-order prediction above which a step was less than half of the optimal length \[-\].
const MIN_DECREASE: f64 = 0.75;
/// Least significant prediction \[roundings of the energy\].
const ROUNDINGS: f64 = 10.0;
/// The first length of an extended step \[steps\], and the greatest.
const FIRST_LENGTH: f64 = 2.0;
const MAX_LENGTH: f64 = 64.0;
/// Per-iteration decay of the extension distance kept in the error estimate \[-\].
const EXTRAPOLATION_DECAY: f64 = 0.5;

impl Robust {
    pub(in crate::solve::newton::sheet) fn decay_extrapolation(&mut self) {
        self.extrapolation *= EXTRAPOLATION_DECAY;
    }
}

impl SheetNewton {
    /// Was a full step less than half of the optimal length?
    pub(in crate::solve::newton::sheet) fn is_too_short(&self, trial: &Trial) -> bool {
        self.system.totals.energy - trial.energy > MIN_DECREASE * trial.predicted
            && trial.predicted > ROUNDINGS * trial.rounding
    }

    /// Extends an accepted step that was too short, or the sum of the last two steps.
    pub(in crate::solve::newton::sheet) fn extend_step(
        &mut self,
        is_whole: bool,
        is_too_short: bool,
        energy: f64,
    ) {
        if !is_whole {
            self.system.robust.has_earlier = false;
        } else if is_too_short {
            let (length, direction) = (FIRST_LENGTH, Direction::Step);
            self.phase =
                Phase::Own(Piece::Robust(SafeguardPhase::Extend { length, energy, direction }));
        } else {
            self.extend_two_steps(energy);
        }
    }

    /// Tries an extended length from `trial` along `d`; accepts the length if the energy falls.
    pub(super) fn extend(
        &mut self,
        case: &SheetCase,
        length: f64,
        energy_before: f64,
        direction: Direction,
    ) {
        self.work_units += SheetSystem::PARAMETERS.cost.energy;
        self.phase = Phase::Linearize { piece: 0 };
        self.system.q[0].copy_from_slice(&self.trial[0]);
        let mut farthest = 0.0_f64;
        for k in self.grid.free() {
            farthest = farthest.max(self.d[0][k].length_squared());
            let to = self.trial[0][k] + self.d[0][k] * length;
            self.system.q[0][k] = self.projected(&case.obstacle, k, to, true);
        }
        let energy = self.system.energy(&self.grid, case, &self.system.q);
        let falls = energy < energy_before;
        if falls {
            std::mem::swap(&mut self.x, &mut self.system.q);
            self.revision += 1;
            let robust = &mut self.system.robust;
            robust.extrapolation = robust.extrapolation.max((length - 1.0) * farthest.sqrt());
            if direction == Direction::Step {
                robust.step_growth = robust.step_growth.max(length);
            }
        }
        if falls && length < MAX_LENGTH {
            let length = 2.0 * length - 1.0;
            self.phase =
                Phase::Own(Piece::Robust(SafeguardPhase::Extend { length, energy, direction }));
        } else if direction == Direction::Step {
            self.extend_two_steps(energy.min(energy_before));
        }
    }
}

//! Iterations by sweeps alone.
//!
//! Symptom: no length of a step lowers the energy (`steps-that-raise-the-energy`). Cause: contact changes at many nodes in
//! one step. Remedy: one iteration by projected sweeps alone, whose steps lower the energy.

use super::{Phase, SheetNewton, StepMethod};

impl SheetNewton {
    /// Repeats the iteration by sweeps alone; false after sweeps alone, or if curvature has to be turned off first.
    pub(super) fn turns_to_sweeps(&mut self, is_uphill: bool) -> bool {
        let robust = &mut self.system.robust;
        if robust.has_sweeps_only() || !is_uphill && robust.has_curvature() {
            return false;
        }
        robust.step_method = StepMethod::SweepsOnly;
        self.phase = Phase::Linearize { piece: 0 };
        true
    }
}

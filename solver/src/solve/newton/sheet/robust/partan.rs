//! Acceleration by parallel tangents.
//!
//! Symptom: steps zigzag in a narrow valley of the energy (`slow-convergence-under-compression`). Cause: the model is too stiff along the
//! valley. Remedy: the sum of the last two steps, in which the parts across the valley cancel, is extended (B. V. Shah,
//! R. J. Buehler and O. Kempthorne, "Some algorithms for minimizing a function of several variables", J. SIAM 12(1),
//! 1964).

use super::{Direction, Phase, Piece, SafeguardPhase, SheetNewton};

/// First length of an extension \[sum of two steps\].
const PARTAN_LENGTH: f64 = 1.5;

impl SheetNewton {
    /// Extends the sum of the last two steps if an earlier step was too short.
    pub(super) fn extend_two_steps(&mut self, energy: f64) {
        if self.system.robust.step_growth <= 1.0 {
            return;
        }
        if self.system.robust.has_earlier {
            for k in self.grid.free() {
                self.d[0][k] = self.x[0][k] - self.system.robust.earlier[k];
            }
            std::mem::swap(&mut self.trial[0], &mut self.system.robust.earlier);
            let (length, direction) = (PARTAN_LENGTH, Direction::TwoSteps);
            self.phase =
                Phase::Own(Piece::Robust(SafeguardPhase::Extend { length, energy, direction }));
        } else {
            self.system.robust.earlier.copy_from_slice(&self.trial[0]);
        }
        self.system.robust.has_earlier = true;
    }
}

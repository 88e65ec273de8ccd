//! Acceleration by parallel tangents.
//!
//! Symptom: steps zigzag in a narrow valley of the energy (`slow-convergence-under-compression`). Cause: the model is too stiff along the
//! valley. Remedy: the sum of the last two steps, in which the parts across the valley cancel, is extended (B. V. Shah,
//! R. J. Buehler and O. Kempthorne, "Some algorithms for minimizing a function of several variables", J. SIAM 12(1),
//! 1964).

use super::super::Phase;
use super::{Direction, Newton, SafeguardPhase};

/// First length of an extension \[sum of two steps\].
const PARTAN_LENGTH: f64 = 1.5;

impl Newton {
    /// Extends the sum of the last two steps if an earlier step was too short.
    pub(super) fn extend_two_steps(&mut self, energy: f64) {
        if self.robust.step_growth <= 1.0 {
            return;
        }
        if self.robust.has_earlier {
            for &k in &self.free {
                let k = k as usize;
                self.d[k] = self.x[k] - self.robust.earlier[k];
            }
            std::mem::swap(&mut self.trial, &mut self.robust.earlier);
            let (length, direction) = (PARTAN_LENGTH, Direction::TwoSteps);
            self.phase = Phase::Robust(SafeguardPhase::Extend { length, energy, direction });
        } else {
            self.robust.earlier.copy_from_slice(&self.trial);
        }
        self.robust.has_earlier = true;
    }
}

//! Is a slack sheet where it seems to be? A step of the true model tells.
//!
//! The iteration's model is made positive, which makes it far too stiff where the sheet pushes: its steps
//! may be small on a long way to a fold. The true model has its own step there, or bends down.

use super::conjugate::dot;
use super::symmetry::symmetrize;
use super::{Newton, Phase, Question, State};
use crate::solve::law::SheetLaw;
use crate::springs::Springs;
use glam::DVec3;

/// Steps of conjugate gradients at most, and the drop of the residual asked of them.
const MOST_STEPS: u32 = 60;
const DROP: f64 = 1e-3;
/// The error left, in lengths of the true model's step: it too holds at one place only.
const WAY: f64 = 2.0;
/// How far to try where the true model bends down \[tolerances\].
const TRIED: f64 = 10.0;

impl Newton {
    /// May the iteration's model be far too stiff, and was the true one not asked about this shape yet? The
    /// paper's springs may push across the sheet anywhere.
    pub(crate) fn is_doubtful(&self, springs: Springs, law: &SheetLaw) -> bool {
        let may_push = springs == Springs::Nikolaev || self.totals.is_slack(self.force_scale(law));
        !self.is_asked && may_push
    }

    /// Begins the search for the true model's step. [`Self::step`] goes on with it: it ends in
    /// [`State::Converged`] if the step is short enough or once the energy fell nowhere along it several
    /// times in a row (contact is in the way), else the iteration goes on.
    pub(crate) fn begin_true_step(&mut self) {
        self.phase = Phase::Stiffen { row: 0, question: Question::Step };
    }

    /// Begins conjugate gradients on the true model.
    pub(super) fn begin_true_cg(&mut self) {
        self.free.iter().for_each(|&k| self.d[k as usize] = DVec3::ZERO);
        let start = self.set_residual();
        self.phase = Phase::TrueCg { step: 0, start, rho: 0.0 };
    }

    /// One step of them; after the last one, sees how far they lead. `tolerance` \[mm\].
    pub(super) fn true_cg(&mut self, step: u32, start: f64, rho: f64, tolerance: f64) -> State {
        let next = self.cg_step(step, rho);
        if let Some((rho, left)) = next
            && step + 1 < MOST_STEPS
            && left > DROP * start
        {
            self.phase = Phase::TrueCg { step: step + 1, start, rho };
            return State::Working;
        }
        // Where it bends down along p (z is H p), there is no telling how far that leads.
        if next.is_none() && dot(&self.free, &self.p, &self.z) < 0.0 {
            let longest = |v: &[DVec3]| {
                self.free.iter().map(|&k| v[k as usize].length_squared()).fold(0.0, f64::max).sqrt()
            };
            let downhill = dot(&self.free, &self.p, &self.forces).signum();
            let scale = downhill * longest(&self.q).max(TRIED * tolerance) / longest(&self.p);
            for &k in &self.free {
                let k = k as usize;
                self.q[k] += self.p[k] * scale;
            }
        }
        symmetrize(&self.mirrors, &self.sheet, &self.free, &mut self.q);
        let (_, length) = self.add_correction();
        self.is_asked = true;
        if WAY * length > tolerance {
            self.last_step = f64::INFINITY;
            self.phase = Phase::Search { length: 1.0, halvings: 0 };
            return State::Working;
        }
        self.error = self.error.max(WAY * length);
        State::Converged
    }
}

//! What an iteration gives away when it has ended.

use super::contact::ON_DOME;
use super::{Newton, Phase, State};
use crate::implant::Dome;
use crate::solve::assemble;
use crate::solve::law::SheetLaw;
use crate::solve::soundness::{self, Fault};
use glam::DVec3;

/// The greatest relative residual after the last step.
const MOST_RESIDUAL_LEFT: f64 = 0.01;

impl Newton {
    /// What is wrong with the shape, if anything is. `tolerance` relative to the base radius.
    pub(crate) fn fault(&self, dome: &Dome, tolerance: f64) -> Option<Fault> {
        let n = self.sheet.nodes_per_side();
        soundness::fault(&self.sheet, dome, tolerance, [0; 2], |i, j| self.x[j * n + i])
            .or_else(|| soundness::has_fold(&self.sheet, &self.x).then_some(Fault::InsideOut))
    }

    /// Writes the shape, the nodes that touch on the dome itself, and where those stand that are lifted.
    pub(crate) fn write_positions(
        &self,
        dome: &Dome,
        x: &mut [DVec3],
        lifted: &mut Vec<(usize, DVec3)>,
    ) {
        x.copy_from_slice(&self.x);
        lifted.clear();
        for &k in &self.free {
            let k = k as usize;
            let lift = if self.contact[k] & ON_DOME != 0 { self.lift[k] } else { 0.0 };
            if lift.abs() > 0.0 {
                lifted.push((k, x[k]));
            }
            if lift > 0.0 {
                x[k] = dome.onto_surface(x[k]);
            }
        }
    }

    /// Forces, contact and residual at the present shape, for what is measured; gives how the iteration
    /// ended, or that it goes on: a shape that stays where it is without a balance of forces is none to
    /// go by. `tolerance` \[mm\].
    pub(crate) fn finish(
        &mut self,
        law: &SheetLaw,
        dome: &Dome,
        tolerance: f64,
        state: State,
    ) -> State {
        self.work_units += 1.0;
        self.totals = assemble::forces(&self.sheet, law, &self.x, &mut self.forces);
        if self.totals.outside_law {
            return State::Unstable;
        }
        let touch = 1e-6 * dome.base_radius;
        for k in 0..self.free.len() {
            let k = self.free[k] as usize;
            self.find_contact(dome, k, touch);
        }
        self.relative_residual = self.residual(law);
        let has_room = self.error + self.missed <= tolerance;
        let is_there = has_room && self.relative_residual <= MOST_RESIDUAL_LEFT;
        if state == State::Converged && !is_there && self.missed < tolerance {
            self.phase = Phase::Linearize { row: 0 };
            return State::Working;
        }
        self.error += self.missed;
        if state == State::Converged && !is_there { State::Stalled } else { state }
    }
}

//! Checks of a converged solution; output of a finished solve: positions, final residual.

use super::{PARAMETERS, Phase, SheetCase, SheetNewton, State};
use crate::contact::active_set::ON_DOME;
use crate::contact::{Dome, TOUCH};
use crate::model::membrane::assembly;
use crate::model::membrane::law::SheetLaw;
use glam::DVec3;

/// Completed checks of a converged solution.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::solve) struct Checks {
    /// Has the stability of the paper's springs been checked?
    is_stability_checked: bool,
    /// Have contact offsets been computed?
    are_offsets_searched: bool,
}

impl SheetNewton {
    /// Checks the final state of the finest grid; returns [`State::Working`] if the iteration has to continue.
    pub(super) fn check(&mut self, checks: &mut Checks, case: &SheetCase, state: State) -> State {
        let is_paper = matches!(case.law, SheetLaw::Paper(_));
        let is_converged = state == State::Converged;
        // The energy of the paper's springs has saddle points.
        if is_paper && !checks.is_stability_checked {
            checks.is_stability_checked = true;
            self.begin_stability(state);
            return State::Working;
        }
        if is_converged && !is_paper && !checks.are_offsets_searched {
            checks.are_offsets_searched = true;
            if self.find_contact_offsets(case) {
                return State::Working;
            }
        }
        // Without convergence with contact offsets, the equilibrium without offsets is the solution.
        if !is_converged && self.drop_contact_offsets(case) {
            return State::Working;
        }
        self.finish(case, state)
    }

    /// Projects nodes in contact onto the dome, and lists the balanced positions of the nodes with contact offsets.
    pub(super) fn write_offsets(
        &self,
        dome: &Dome,
        x: &mut [DVec3],
        offset_nodes: &mut Vec<(usize, DVec3)>,
    ) {
        for k in self.grid.free() {
            let is_active = self.contact.active[k] & ON_DOME != 0;
            let offset = if is_active { self.system.offset[k] } else { 0.0 };
            if offset.abs() > 0.0 {
                offset_nodes.push((k, x[k]));
            }
            if offset > 0.0 {
                x[k] = dome.onto_surface(x[k]);
            }
        }
    }

    /// Evaluates forces, contact and residual at the solution; returns the final state, or [`State::Working`] if the
    /// shape is stationary without a balance of forces.
    fn finish(&mut self, case: &SheetCase, state: State) -> State {
        self.work_units += 1.0;
        let (surface, forces) = (self.grid.rest.membrane(), &mut self.forces[0]);
        self.system.totals = assembly::forces(surface, case.law, &self.x[0], forces);
        if self.system.totals.outside_law {
            return State::Unstable;
        }
        self.find_contact(&case.obstacle, TOUCH);
        self.relative_residual = self.residual(case);
        let neglected = self.system.neglected_offset;
        let is_solved = self.error + neglected <= case.tolerance
            && self.relative_residual <= PARAMETERS.max_residual;
        if state == State::Converged && !is_solved && neglected < case.tolerance {
            self.phase = Phase::Linearize { piece: 0 };
            return State::Working;
        }
        self.error += neglected;
        if state == State::Converged && !is_solved { State::Stalled } else { state }
    }
}

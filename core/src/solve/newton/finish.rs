//! Output of a finished solve: validity, positions, final residual.

use super::{Newton, PARAMETERS, Phase, State};
use crate::contact::active_set::ON_DOME;
use crate::contact::{Dome, Obstacle, TOUCH};
use crate::model::membrane::assembly;
use crate::model::membrane::law::SheetLaw;
use crate::solve::validity::{self, Invalid};
use glam::DVec3;

impl Newton {
    /// Why the shape is invalid; `None` for a valid shape. `tolerance` is relative to the base radius.
    pub(in crate::solve) fn invalid(&self, dome: &Dome, tolerance: f64) -> Option<Invalid> {
        let n = self.sheet.nodes_per_side();
        validity::invalid(&self.sheet, dome, tolerance, [0; 2], |i, j| self.x[j * n + i]).or_else(
            || validity::has_inverted_triangle(&self.sheet, &self.x).then_some(Invalid::Inverted),
        )
    }

    /// Writes the positions, nodes in contact projected onto the dome, and the positions of the nodes with contact
    /// offsets.
    pub(in crate::solve) fn write_positions(
        &self,
        dome: &Dome,
        x: &mut [DVec3],
        offset_nodes: &mut Vec<(usize, DVec3)>,
    ) {
        x.copy_from_slice(&self.x);
        offset_nodes.clear();
        for &k in &self.free {
            let k = k as usize;
            let is_active = self.contact.active[k] & ON_DOME != 0;
            let offset = if is_active { self.contact.offset[k] } else { 0.0 };
            if offset.abs() > 0.0 {
                offset_nodes.push((k, x[k]));
            }
            if offset > 0.0 {
                x[k] = dome.onto_surface(x[k]);
            }
        }
    }

    /// Evaluates forces, contact and residual at the solution; returns the final state, or [`State::Working`] if the
    /// shape is stationary without a balance of forces. `tolerance` \[mm\].
    pub(super) fn finish(
        &mut self,
        law: &SheetLaw,
        obstacle: &Obstacle,
        tolerance: f64,
        state: State,
    ) -> State {
        self.work_units += 1.0;
        self.model.totals = assembly::forces(&self.sheet, law, &self.x, &mut self.forces);
        if self.model.totals.outside_law {
            return State::Unstable;
        }
        let touch = TOUCH * obstacle.dome.reference_length();
        for k in 0..self.free.len() {
            let k = self.free[k] as usize;
            self.find_contact(obstacle, k, touch);
        }
        self.relative_residual = self.residual(law);
        let neglected = self.contact.neglected_offset;
        let is_solved = self.error + neglected <= tolerance
            && self.relative_residual <= PARAMETERS.max_residual;
        if state == State::Converged && !is_solved && neglected < tolerance {
            self.phase = Phase::Linearize { row: 0 };
            return State::Working;
        }
        self.error += neglected;
        if state == State::Converged && !is_solved { State::Stalled } else { state }
    }
}

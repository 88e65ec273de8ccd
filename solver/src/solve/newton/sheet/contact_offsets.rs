//! The equilibrium with contact offsets: contact ends between nodes.

use super::{Phase, SheetCase, SheetNewton, SheetSystem};
use crate::contact::active_set::ON_DOME;
use crate::contact::contact_edge;
use crate::mesh::NodeKind;

impl SheetNewton {
    /// Computes the contact offsets. If the offsets are significant at the tolerance, restarts the iteration with
    /// offsets and returns true.
    pub(super) fn find_contact_offsets(&mut self, case: &SheetCase) -> bool {
        let (sheet, dome, x) = (self.grid.sheet(), &case.obstacle.dome, &mut self.x[0]);
        let n = sheet.nodes_per_side();
        let SheetSystem { offset, neglected_offset, .. } = &mut self.system;
        let is_active = |k: usize| self.contact.active[k] & ON_DOME != 0;
        let mut greatest = 0.0_f64;
        for k in self.grid.free().filter(|&k| is_active(k)) {
            let gap = |i: isize, j: isize| {
                let (i, j) = ((k % n).checked_add_signed(i)?, (k / n).checked_add_signed(j)?);
                let at = j * n + i;
                let is_off =
                    i < n && j < n && sheet.kinds()[at] == NodeKind::Free && !is_active(at);
                is_off.then(|| dome.gauge(x[at]))
            };
            offset[k] = contact_edge::offset(gap);
            greatest = greatest.max(offset[k].abs() * dome.shape.greatest_length());
        }
        let length = dome.reference_length();
        let fraction = contact_edge::fraction(greatest / length, case.tolerance / length);
        offset.iter_mut().for_each(|offset| *offset *= fraction);
        if fraction <= 0.0 {
            *neglected_offset = contact_edge::neglected(greatest / length) * length;
            return false;
        }
        for k in self.grid.free() {
            x[k] = case.obstacle.project(x[k], offset[k].abs());
        }
        self.revision += 1;
        self.phase = Phase::Linearize { piece: 0 };
        self.keep_error();
        true
    }

    /// Restarts the iteration without contact offsets; returns false if no offset exists.
    pub(super) fn drop_contact_offsets(&mut self, case: &SheetCase) -> bool {
        let offsets = self.system.offset.iter();
        let greatest = offsets.fold(0.0_f64, |most, offset| most.max(offset.abs()));
        if greatest <= 0.0 {
            return false;
        }
        let iterations = self.iterations;
        self.start(case);
        self.iterations = iterations.min(self.max_iterations / 2);
        self.system.neglected_offset = greatest * case.obstacle.dome.shape.greatest_length();
        true
    }
}

//! The equilibrium with contact offsets: contact ends between nodes.

use super::{Newton, Phase};
use crate::contact::Obstacle;
use crate::contact::active_set::ON_DOME;
use crate::contact::contact_edge;
use crate::mesh::NodeKind;

impl Newton {
    /// Computes the contact offsets. If the offsets are significant at `tolerance` \[mm\], restarts the iteration with
    /// offsets and returns true.
    pub(super) fn find_contact_offsets(&mut self, obstacle: &Obstacle, tolerance: f64) -> bool {
        let (n, dome) = (self.sheet.nodes_per_side(), &obstacle.dome);
        let is_active = |k: usize| self.contact.active[k] & ON_DOME != 0;
        let mut greatest = 0.0_f64;
        for &k in &self.free {
            let k = k as usize;
            if !is_active(k) {
                continue;
            }
            let gap = |i: isize, j: isize| {
                let (i, j) = ((k % n).checked_add_signed(i)?, (k / n).checked_add_signed(j)?);
                let at = j * n + i;
                let is_off =
                    i < n && j < n && self.sheet.kinds()[at] == NodeKind::Free && !is_active(at);
                is_off.then(|| dome.gauge(self.x[at]))
            };
            let offset = contact_edge::offset(gap);
            self.contact.offset[k] = offset;
            greatest = greatest.max(offset.abs() * dome.greatest_half_axis());
        }
        let length = dome.reference_length();
        let fraction = contact_edge::fraction(greatest / length, tolerance / length);
        self.contact.offset.iter_mut().for_each(|offset| *offset *= fraction);
        if fraction <= 0.0 {
            self.contact.neglected_offset = contact_edge::neglected(greatest / length) * length;
            return false;
        }
        for &k in &self.free {
            let k = k as usize;
            self.x[k] = obstacle.project(self.x[k], self.contact.offset[k].abs());
        }
        self.revision += 1;
        self.phase = Phase::Linearize { row: 0 };
        self.keep_error();
        true
    }

    /// Restarts the iteration without contact offsets; returns false if no offset exists.
    pub(super) fn drop_contact_offsets(&mut self, obstacle: &Obstacle) -> bool {
        let offsets = self.contact.offset.iter();
        let greatest = offsets.fold(0.0_f64, |most, offset| most.max(offset.abs()));
        if greatest <= 0.0 {
            return false;
        }
        let iterations = self.iterations;
        self.start(obstacle, self.mirrors());
        self.iterations = iterations.min(self.max_iterations / 2);
        let dome = &obstacle.dome;
        self.contact.neglected_offset = greatest * dome.greatest_half_axis();
        true
    }
}

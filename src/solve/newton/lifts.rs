//! The equilibrium in which contact ends between nodes.

use super::contact::{ON_DOME, admissible};
use super::{Newton, Phase};
use crate::implant::Dome;
use crate::sheet::NodeKind;
use crate::solve::lift;

impl Newton {
    /// Finds where contact ends between nodes. If that matters to `tolerance` \[mm\], begins the
    /// iteration to the equilibrium with lifts; else false.
    pub(crate) fn find_lifts(&mut self, dome: &Dome, tolerance: f64) -> bool {
        let n = self.sheet.nodes_per_side();
        let touches = |k: usize| self.contact[k] & ON_DOME != 0;
        let mut greatest = 0.0_f64;
        for &k in &self.free {
            let k = k as usize;
            if !touches(k) {
                continue;
            }
            let gap = |i: isize, j: isize| {
                let (i, j) = ((k % n).checked_add_signed(i)?, (k / n).checked_add_signed(j)?);
                let at = j * n + i;
                let is_off =
                    i < n && j < n && self.sheet.kinds()[at] == NodeKind::Free && !touches(at);
                is_off.then(|| dome.level(self.x[at]))
            };
            self.lift[k] = lift::lift(gap);
            greatest = greatest.max(self.lift[k].abs() * dome.base_radius.max(dome.projection));
        }
        let radius = dome.base_radius;
        let share = lift::share(greatest / radius, tolerance / radius);
        self.lift.iter_mut().for_each(|lift| *lift *= share);
        if share <= 0.0 {
            self.missed = lift::missed(greatest / radius) * radius;
            return false;
        }
        for &k in &self.free {
            let k = k as usize;
            self.x[k] = admissible(dome, self.x[k], self.lift[k].abs());
        }
        self.moves += 1;
        self.phase = Phase::Linearize { row: 0 };
        self.keep_error();
        true
    }

    /// Goes on without lifts; false if there are none.
    pub(crate) fn drop_lifts(&mut self, dome: &Dome) -> bool {
        let greatest = self.lift.iter().fold(0.0_f64, |most, lift| most.max(lift.abs()));
        if greatest <= 0.0 {
            return false;
        }
        let iterations = self.iterations;
        self.start(dome, !self.mirrors.is_empty());
        self.iterations = iterations.min(self.most_iterations / 2);
        self.missed = greatest * dome.base_radius.max(dome.projection);
        true
    }
}

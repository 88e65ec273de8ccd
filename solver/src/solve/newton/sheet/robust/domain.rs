//! Iterates outside of the law's domain.
//!
//! Symptom: a stable shape is reported unstable (`path-outside-of-the-law`). Cause: iterates leave the domain of the
//! paper's springs temporarily. Remedy: divergence is declared after several consecutive iterations outside,
//! or once a node is too far from pocket and dome.

use super::SheetNewton;
use crate::contact::Obstacle;

/// Consecutive iterations outside of the domain before divergence is declared.
const MAX_OUTSIDE: u32 = 4;
/// Distance of a node from the pocket's centre at which divergence is declared \[patch radius and dome's height\].
const MAX_DISTANCE: f64 = 1.5;

impl SheetNewton {
    /// Has the iteration diverged?
    pub(in crate::solve::newton::sheet) fn has_diverged(&mut self, obstacle: &Obstacle) -> bool {
        let totals = &self.system.totals;
        let outside = &mut self.system.robust.outside;
        *outside = if totals.outside_law { *outside + 1 } else { 0 };
        let outside = *outside;
        outside > MAX_OUTSIDE
            || outside > 0 && self.has_distant_node(obstacle)
            || !totals.energy.is_finite()
    }

    fn has_distant_node(&self, obstacle: &Obstacle) -> bool {
        let most = MAX_DISTANCE * (self.grid.sheet().radius_mm() + obstacle.dome.top());
        self.grid.free().any(|k| self.x[0][k].length_squared() > most * most)
    }
}

//! Completed work, for the figures of a running app and for tests.

use super::Session;
use crate::measure::Fields;

/// Counters of completed work.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counters {
    /// Solves started.
    pub solves: u64,
    /// Calls of [`Session::advance`](super::Session::advance) that did solver work.
    pub slices: u64,
    /// Force evaluations, in work units of the finest grid.
    pub work_units: f64,
    /// The same on the coarser grid that is solved first, in its own work units.
    pub coarse_work_units: f64,
    /// Results measured.
    pub measurements: u64,
    /// Solutions copied from the solver for results or display.
    pub solutions: u64,
    /// Solutions with a recovered deformation at the nodes: the basis of results and fields.
    pub recoveries: u64,
    /// Nodal fields computed for display.
    pub fields: u64,
    /// Tabulations of the spring law.
    pub tables: u64,
    /// Allocations of the solver's nested grids.
    pub grids: u64,
    /// Edits reverted because the solution was invalid.
    pub reverted: u64,
    /// Stacks of layers with computed stability limits of the paper's springs.
    pub stability_limits: u64,
    /// Displayed shapes before convergence: drafts and solutions of coarser grids.
    pub previews: u64,
    /// Solutions shared by pins and the current scene instead of a solve.
    pub shared: u64,
}

impl Session {
    /// Counts the work of fields that are not used any more.
    pub(super) fn count_fields(&self, fields: &Fields) {
        let (recoveries, computed) = work_of(fields);
        self.count(|c| {
            c.recoveries += recoveries;
            c.fields += computed;
        });
    }

    pub(super) fn count(&self, add: impl FnOnce(&mut Counters)) {
        let mut counters = self.counters.get();
        add(&mut counters);
        self.counters.set(counters);
    }
}

/// Numbers of recovered deformations and computed fields of one solution.
pub(super) fn work_of(fields: &Fields) -> (u64, u64) {
    (u64::from(fields.solution().has_deformation()), fields.computed())
}

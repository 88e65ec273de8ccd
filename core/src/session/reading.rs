//! What of a session is read: shape, fields, result, counters.

use super::{Counters, Session, Shown, State};
use crate::measure::{Field, Fields, Outcome, Status};
use crate::scene::Scene;
use crate::solve::{Displayed, Invalid, Problem, Solution, Solver};
use crate::springs::Springs;
use crate::springs::stability::Limits;
use glam::DVec3;
use std::rc::Rc;
use std::sync::Arc;

impl Session {
    /// Is a solve running?
    #[must_use]
    pub fn is_working(&self) -> bool {
        matches!(self.state, State::Solving(_))
    }

    /// Is the displayed shape one of the current scene or a previous one?
    pub(super) fn is_shape_known(&self) -> bool {
        !matches!(self.state, State::Solving(Shown::Nothing) | State::Stopped)
    }

    fn is_held(&self) -> bool {
        self.state == State::Held
    }

    /// The problem of the displayed shape: of the previous scene until the solver has a shape of the current scene;
    /// `None` before the first shape.
    #[must_use]
    pub fn displayed_problem(&self) -> Option<&Problem> {
        self.is_shape_known().then(|| self.fields().solution().problem())
    }

    /// The problem being solved: grid, patch, obstacle, layers.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        match (self.fields.get(), &self.coarse.waiting) {
            (Some(fields), _) if self.is_held() => fields.solution().problem(),
            (_, Some(waiting)) => waiting,
            _ => self.solver.problem(),
        }
    }

    /// Why the last shape of the current solve was invalid.
    #[must_use]
    pub fn invalid(&self) -> Option<Invalid> {
        self.solver.invalid().filter(|_| !self.is_held() && !self.is_on_coarser_grid())
    }

    /// Origin of the displayed shape.
    #[must_use]
    pub fn displayed(&self) -> Displayed {
        match self.coarser_nodes_per_side() {
            _ if self.is_held() => Displayed::Final,
            _ if self.is_on_coarser_grid() => Displayed::Previous,
            Some(nodes_per_side) => Displayed::Coarse { nodes_per_side },
            None => self.solver.displayed(),
        }
    }

    /// Completed fraction of the current solve, 0 to 1.
    #[must_use]
    pub fn fraction_done(&self) -> f64 {
        match self.is_held() {
            true => 1.0,
            false if self.is_on_coarser_grid() => 0.0,
            false => self.solver.fraction_done(),
        }
    }

    /// The solver, for tests; with the solution of a pin the solver still has its previous problem.
    #[must_use]
    pub fn solver(&self) -> &Solver {
        &self.solver
    }

    /// The solution to display; copied from the solver once per shape, at its first use.
    #[must_use]
    pub fn solution(&self) -> &Arc<Solution> {
        self.fields().solution()
    }

    /// Positions of the displayed solution's inner face \[mm\], shape (nodes_per_side², ); nodes outside of
    /// the pocket lie on the wall.
    #[must_use]
    pub fn shape(&self) -> &[DVec3] {
        self.solution().inner()
    }

    /// Number of changes of [`Self::shape`].
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// The fields of [`Self::solution`].
    #[must_use]
    pub fn fields(&self) -> &Rc<Fields> {
        self.fields.get_or_init(|| {
            self.count(|c| c.solutions += 1);
            Rc::new(Fields::new(Arc::new(self.solver.solution())))
        })
    }

    /// Values of a field at the nodes of the displayed solution, shape (nodes_per_side², ), zero outside of the sheet;
    /// computed at the first use.
    #[must_use]
    pub fn values(&self, field: Field) -> &[f32] {
        self.fields().values(field)
    }

    /// Stability limits of a homogeneously stretched sheet of the current layers under the paper's springs; `None`
    /// for other springs. Computed at the first use, without a solve.
    #[must_use]
    pub fn stability_limits(&self) -> Option<&Limits> {
        (self.scene.springs == Springs::Nikolaev).then(|| {
            self.stability_limits.get_or_init(|| {
                self.count(|c| c.stability_limits += 1);
                Limits::new(Springs::Nikolaev, &self.problem().materials)
            })
        })
    }

    /// The greatest principal strain of the last result with a shape \[-\].
    #[must_use]
    pub fn greatest_strain(&self) -> Option<f64> {
        let strain = self.outcome()?.strain.as_ref()?;
        Some(strain.max_principal.max(0.0))
    }

    /// The last result; `None` before the first result. During a solve the result belongs to the previous scene or,
    /// with [`Self::is_outcome_present`], to a draft of the current scene.
    #[must_use]
    pub fn outcome(&self) -> Option<&Outcome> {
        self.measured.as_ref().map(|measured| &measured.outcome)
    }

    /// Does [`Self::outcome`] belong to the current scene, draft included?
    #[must_use]
    pub fn is_outcome_present(&self) -> bool {
        self.measured.as_ref().is_some_and(|measured| measured.previous.is_none())
    }

    /// The scene of [`Self::outcome`]: during a solve the previous scene, until there is a draft of the current one.
    #[must_use]
    pub fn outcome_scene(&self) -> &Scene {
        let previous = self.measured.as_ref().and_then(|measured| measured.previous.as_ref());
        previous.unwrap_or(&self.scene)
    }

    /// The result of the current scene; `None` until the solve has ended.
    #[must_use]
    pub fn result(&self) -> Option<&Outcome> {
        self.outcome().filter(|_| !self.is_working())
    }

    /// Has the solve ended without a stable shape, or was the solve cancelled? [`Self::shape`] is then not
    /// displayed.
    #[must_use]
    pub fn has_no_shape(&self) -> bool {
        self.is_stopped() || self.result().is_some_and(|outcome| outcome.status == Status::Unstable)
    }

    /// Counters of completed work.
    #[must_use]
    pub fn counters(&self) -> Counters {
        let mut counters = self.counters.get();
        counters.tables = self.solver.tables_built();
        counters.grids = self.solver.grids_built();
        let (recoveries, computed) = self.work_of_fields();
        counters.recoveries += recoveries;
        counters.fields += computed;
        counters
    }
}

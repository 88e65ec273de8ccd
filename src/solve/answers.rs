//! What a solver tells: how it stands, its shape, forces and energy, what it did.

use super::law::SheetLaw;
use super::newton::NestedNewton;
use super::soundness::Fault;
use super::{Method, Problem, Shown, Solver, Stage, Verdict, assemble, guess};
use crate::springs::coupled::CoupledLaw;
use glam::DVec3;

impl Solver {
    /// The problem being solved.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// How the solve stands.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        self.verdict
    }

    /// What was wrong with the shape that the solve led to; [`Self::positions`] is the last sound one.
    #[must_use]
    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    /// What [`Self::positions`] shows.
    #[must_use]
    pub fn shown(&self) -> Shown {
        self.shown
    }

    /// Times that the law's tables were made since the solver was.
    #[must_use]
    pub fn tables_built(&self) -> u64 {
        self.tables_built
    }

    /// Times that room for the nested grids was made since the solver was.
    #[must_use]
    pub fn grids_built(&self) -> u64 {
        self.grids_built
    }

    /// Did Newton's method take over because full multigrid did not get there?
    #[must_use]
    pub fn fell_back(&self) -> bool {
        self.fell_back
    }

    /// The method that the present shape comes from.
    #[must_use]
    pub fn method(&self) -> Method {
        match self.stage {
            Stage::Rest => Method::Multigrid { cycles: 0 },
            Stage::Multigrid => Method::Multigrid { cycles: self.cycles() },
            Stage::Newton => Method::Newton,
        }
    }

    /// Free nodes solved for: those of one quarter or half where symmetry allows it.
    #[must_use]
    pub fn nodes_solved(&self) -> usize {
        match (self.stage, &self.multigrid) {
            (Stage::Multigrid, Some(multigrid)) => multigrid.nodes(),
            _ => self.problem.sheet.free_nodes(),
        }
    }

    /// Nodes that one pass over the finest grid computes: [`Self::nodes_solved`] and what fills rows up
    /// to whole groups of four. Nodes outside of the pocket are not among them.
    #[must_use]
    pub fn nodes_swept(&self) -> usize {
        match (self.stage, &self.multigrid) {
            (Stage::Multigrid, Some(multigrid)) => multigrid.lanes(),
            _ => self.problem.sheet.free_nodes(),
        }
    }

    /// Node positions \[mm\] on the finest grid, shape (nodes_per_side², ).
    #[must_use]
    pub fn positions(&self) -> &[DVec3] {
        &self.x
    }

    /// The last nodes that touch, and where they stand in the balance of forces \[mm\]: a little above
    /// the dome, because contact ends between nodes. Where it ends beyond the node,
    /// [`Self::positions`] has it on the dome.
    #[must_use]
    pub fn lifted(&self) -> &[(usize, DVec3)] {
        &self.lifted
    }

    /// Is the dome in by so little that the sheet at rest is within the tolerance, and was left there?
    #[must_use]
    pub fn is_left_at_rest(&self) -> bool {
        self.stage == Stage::Rest && self.problem.dome.apex().z > 0.0
    }

    /// Work of this solve, in units of one evaluation of all nodal forces on the finest grid (of
    /// those nodes that are solved for).
    #[must_use]
    pub fn work_units(&self) -> f64 {
        if self.stage == Stage::Rest {
            return 0.0;
        }
        self.multigrid.as_ref().map_or(0.0, |m| m.work_units)
            + self.newton.as_ref().map_or(0.0, NestedNewton::work_units)
    }

    /// V-cycles of the finest grid.
    #[must_use]
    pub fn cycles(&self) -> u32 {
        match (self.stage, &self.multigrid) {
            (Stage::Rest, _) | (_, None) => 0,
            (_, Some(multigrid)) => multigrid.finest_cycles(),
        }
    }

    /// Counts the changes of [`Self::positions`].
    #[must_use]
    pub fn moves(&self) -> u64 {
        self.moves
    }

    /// Spring forces on every node at the present shape \[kPa·mm²\], shape (nodes_per_side², ): what
    /// is not zero is taken by the dome, the wall or the border.
    #[must_use]
    pub fn forces(&self) -> Vec<DVec3> {
        self.forces_and_scale().0
    }

    /// The same with the root of the sum of squares of all that single triangles pull with: what is left
    /// of forces that should balance is measured against it.
    #[must_use]
    pub fn forces_and_scale(&self) -> (Vec<DVec3>, f64) {
        let mut forces = vec![DVec3::ZERO; self.problem.sheet.len()];
        let x = self.balanced();
        let totals = assemble::forces(&self.problem.sheet, &self.law, &x, &mut forces);
        (forces, totals.force_scale())
    }

    /// Tension of all layers per small strain \[kPa·mm\]: Σ h·Ef′(0)/(1−ν²) for coupled springs (stretched
    /// one way, held across), Σ h·Ef′(0) for the paper's.
    #[must_use]
    pub fn stiffness(&self) -> f64 {
        self.law.stiffness()
    }

    /// Elastic energy \[kPa·mm³\] of a shape of this problem's sheet, shape (nodes_per_side², ).
    #[must_use]
    pub fn energy(&self, x: &[DVec3]) -> f64 {
        assemble::energy(&self.problem.sheet, &self.law, x)
    }

    /// A shape of this problem's sheet \[mm\] that is made of geometry alone: where solving starts.
    #[must_use]
    pub fn start_shape(&self) -> Vec<DVec3> {
        guess::tight_string(&self.problem.sheet, &self.problem.dome)
    }

    /// The shape in which forces balance: [`Self::positions`] with the nodes of [`Self::lifted`].
    #[must_use]
    pub fn balanced(&self) -> Vec<DVec3> {
        let mut x = self.x.clone();
        for &(k, place) in &self.lifted {
            x[k] = place;
        }
        x
    }

    /// Norm of the forces that no contact takes, relative to the forces they are the sum of \[-\].
    #[must_use]
    pub fn relative_residual(&self) -> f64 {
        match (self.stage, &self.multigrid, &self.newton) {
            (Stage::Rest, ..) => 0.0,
            (Stage::Multigrid, Some(multigrid), _) => multigrid.relative_residual,
            (_, _, Some(newton)) => newton.finest().relative_residual,
            _ => f64::INFINITY,
        }
    }

    /// Estimated greatest node position error against this grid's own equilibrium, relative to the
    /// base radius \[-\]; infinite while there is no estimate.
    #[must_use]
    pub fn estimated_position_error(&self) -> f64 {
        let error = match (self.stage, &self.multigrid, &self.newton) {
            (Stage::Rest, ..) => return self.error_at_rest(),
            (Stage::Multigrid, Some(multigrid), _) => multigrid.error,
            (_, _, Some(newton)) => newton.finest().error,
            _ => f64::INFINITY,
        };
        error / self.problem.dome.base_radius
    }

    /// How far the solve has come, 0 to 1: nested grids count for a third, the finest grid's estimated
    /// error for the rest. It may fall back where a grid is begun anew.
    #[must_use]
    pub fn share_done(&self) -> f64 {
        let (grid, grids) = match (self.stage, &self.newton) {
            (Stage::Newton, Some(newton)) => newton.grid(),
            _ => (1, 1),
        };
        let nested = (grid as f64 / grids as f64) / 3.0;
        if grid < grids {
            return nested;
        }
        let error = self.estimated_position_error().clamp(self.problem.tolerance, 1.0);
        let least = self.problem.tolerance.min(0.1);
        nested + (error.ln() / least.ln()).clamp(0.0, 1.0) * 2.0 / 3.0
    }

    /// The coupled springs' law with its tables; `None` for the paper's springs.
    #[must_use]
    pub fn coupled_law(&self) -> Option<&CoupledLaw> {
        match &self.law {
            SheetLaw::Coupled(law) => Some(law),
            SheetLaw::Paper(_) => None,
        }
    }

    /// Tables that one triangle (coupled springs) or spring reads: layers of equal Poisson ratio share
    /// one.
    #[must_use]
    pub fn tables(&self) -> usize {
        self.coupled_law().map_or(1, CoupledLaw::groups)
    }

    /// The greatest error of the spring law's tables, relative to their peak stress \[-\].
    #[must_use]
    pub fn table_error(&self) -> f64 {
        self.law.table_error()
    }
}

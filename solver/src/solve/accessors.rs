//! Accessors of the solver: status, positions, forces, energy, work counters.

use super::fas::Ending;
use super::multigrid::Multigrid;
use super::newton_method::NewtonMethod;
use super::{
    Displayed, Invalid, Method, Problem, Progress, Report, Shape, Solution, Solver, Stage, Verdict,
    discretisation, initial_guess,
};
use crate::model::membrane::assembly;
use crate::model::membrane::law::SheetLaw;
use crate::springs::coupled::CoupledLaw;
use glam::DVec3;

impl Solver {
    /// The problem being solved.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// A copy of the current state as a solution.
    #[must_use]
    pub fn solution(&self) -> Solution {
        let shape = Shape {
            inner: self.x.clone(),
            offset_nodes: self.offset_nodes.clone(),
            outer: self.outer.clone(),
            mirrored: self.mirrored,
        };
        Solution::new(&self.problem, &self.law, shape, self.report())
    }

    /// The current state as a solution; consumes the solver.
    #[must_use]
    pub fn into_solution(self) -> Solution {
        let report = self.report();
        let Self { x: inner, offset_nodes, outer, mirrored, .. } = self;
        let shape = Shape { inner, offset_nodes, outer, mirrored };
        Solution::new(&self.problem, &self.law, shape, report)
    }

    /// The current state as a solution; leaves a solver without a shape, for another start.
    pub fn take_solution(&mut self) -> Solution {
        let report = self.report();
        let shape = Shape {
            inner: std::mem::take(&mut self.x),
            offset_nodes: std::mem::take(&mut self.offset_nodes),
            outer: std::mem::take(&mut self.outer),
            mirrored: self.mirrored,
        };
        Solution::new(&self.problem, &self.law, shape, report)
    }

    /// Method, status, work and accuracy of the current state.
    #[must_use]
    pub fn report(&self) -> Report {
        let finite = |value: f64| value.is_finite().then_some(value);
        Report {
            verdict: self.verdict,
            invalid: self.invalid,
            displayed: self.displayed,
            method: self.method(),
            cycles: self.cycles(),
            nodes_solved: self.nodes_solved(),
            nodes_swept: self.nodes_swept(),
            fell_back: self.fell_back(),
            is_left_at_rest: self.stage == Stage::Rest && self.error_at_rest() > 0.0,
            work_units: self.work_units(),
            relative_residual: finite(self.relative_residual()),
            estimated_position_error: finite(self.estimated_position_error()),
            estimated_discretisation_error: self.estimated_discretisation_error(),
        }
    }

    /// Status of the solve.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        self.verdict
    }

    /// Why the last shape of the solve was invalid; [`Self::positions`] contains the last valid shape.
    #[must_use]
    pub fn invalid(&self) -> Option<Invalid> {
        self.invalid
    }

    /// Origin of the shape in [`Self::positions`].
    #[must_use]
    pub fn displayed(&self) -> Displayed {
        self.displayed
    }

    /// Number of times the law was tabulated.
    #[must_use]
    pub fn tables_built(&self) -> u64 {
        self.tables_built
    }

    /// Number of times the nested grids were allocated.
    #[must_use]
    pub fn grids_built(&self) -> u64 {
        self.grids_built
    }

    /// See [`Report::fell_back`].
    #[must_use]
    pub fn fell_back(&self) -> bool {
        self.attempts > 1
    }

    /// Attempts of this solve, 1 if the first one succeeded: multigrid with one set of constants after the other, then Newton's
    /// method.
    #[must_use]
    pub fn attempts(&self) -> u32 {
        self.attempts
    }

    fn method(&self) -> Method {
        match self.stage {
            Stage::Rest => Method::Multigrid { cycles: 0 },
            Stage::Multigrid => Method::Multigrid { cycles: self.cycles() },
            Stage::Newton => Method::Newton,
        }
    }

    /// Free nodes solved for: of one quarter or half of the sheet under symmetry.
    #[must_use]
    pub fn nodes_solved(&self) -> usize {
        match (self.stage, &self.multigrid) {
            (Stage::Multigrid, Some(multigrid)) => multigrid.nodes(),
            _ => self.problem.sheet().free_nodes(),
        }
    }

    fn nodes_swept(&self) -> usize {
        match (self.stage, &self.multigrid) {
            (Stage::Multigrid, Some(multigrid)) => multigrid.lanes(),
            _ => self.problem.sheet().free_nodes(),
        }
    }

    /// Positions of the inner face \[mm\], shape (nodes_per_side², ).
    #[must_use]
    pub fn positions(&self) -> &[DVec3] {
        &self.x
    }

    /// See [`Solution::offset_nodes`].
    #[must_use]
    pub fn offset_nodes(&self) -> &[(usize, DVec3)] {
        &self.offset_nodes
    }

    /// Work of this solve \[evaluations of all nodal forces on the finest grid, of the nodes solved for\].
    #[must_use]
    pub fn work_units(&self) -> f64 {
        if self.stage == Stage::Rest {
            return 0.0;
        }
        self.multigrid.as_ref().map_or(0.0, Multigrid::work_units)
            + self.newton_work_before_growth
            + self.newton_work()
    }

    /// Work of Newton's method since the skin grew last.
    pub(super) fn newton_work(&self) -> f64 {
        self.newton.as_ref().map_or(0.0, NewtonMethod::work_units)
    }

    /// V-cycles of the finest grid.
    #[must_use]
    pub fn cycles(&self) -> u32 {
        match (self.stage, &self.multigrid) {
            (Stage::Rest, _) | (_, None) => 0,
            (_, Some(multigrid)) => multigrid.finest_cycles(),
        }
    }

    /// Number of changes of [`Self::positions`].
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Positions of the layers of nodes above the inner face \[mm\], shape (layers, nodes_per_side²); empty for a sheet.
    #[must_use]
    pub fn outer(&self) -> &[Vec<DVec3>] {
        &self.outer
    }

    /// Spring forces at every node of [`Solution::balanced`] \[kPa·mm²\], shape (nodes_per_side², ), and the root of
    /// the sum of squares of the forces of single triangles. Dome, wall and edge balance the nodal forces.
    #[must_use]
    pub fn forces_and_scale(&self) -> (Vec<DVec3>, f64) {
        let mut forces = vec![DVec3::ZERO; self.problem.sheet().len()];
        let solution = self.solution();
        let x = solution.balanced();
        let totals =
            assembly::forces(self.problem.rest.membrane(), self.law.membrane(), &x, &mut forces);
        (forces, totals.force_scale())
    }

    /// Small-strain stiffness of all layers \[kPa·mm\]: Σ h·Ef′(0)/(1−ν²) for coupled springs (no transverse
    /// strain), Σ h·Ef′(0) for the paper's springs.
    #[must_use]
    pub fn stiffness(&self) -> f64 {
        self.law.membrane().stiffness()
    }

    /// Elastic energy \[kPa·mm³\] of a shape of this problem's sheet, shape (nodes_per_side², ).
    #[must_use]
    pub fn energy(&self, x: &[DVec3]) -> f64 {
        assembly::energy(self.problem.rest.membrane(), self.law.membrane(), x)
    }

    /// The initial guess: a shape from geometry alone \[mm\], shape (nodes_per_side², ).
    #[must_use]
    pub fn start_shape(&self) -> Vec<DVec3> {
        initial_guess::taut_profile(&self.problem.rest, &self.problem.obstacle.dome)
    }

    /// The ending of the attempt that computed the shape of a failed solve; `None`: the last one.
    fn kept_ending(&self) -> Option<Ending> {
        let is_kept = self.progress == Progress::Done && self.verdict != Verdict::Converged;
        self.kept.filter(|_| is_kept)
    }

    fn relative_residual(&self) -> f64 {
        match (self.kept_ending(), self.stage, &self.multigrid, &self.newton) {
            (Some(kept), ..) => kept.relative_residual,
            (_, Stage::Rest, ..) => 0.0,
            (_, Stage::Multigrid, Some(multigrid), _) => multigrid.ending().relative_residual,
            (.., Some(newton)) => newton.relative_residual(),
            _ => f64::INFINITY,
        }
    }

    /// Estimated greatest node position error against this grid's own equilibrium \[base radius\]; infinite
    /// while there is no estimate.
    #[must_use]
    pub fn estimated_position_error(&self) -> f64 {
        let error = match (self.kept_ending(), self.stage, &self.multigrid, &self.newton) {
            (Some(kept), ..) => kept.error,
            (_, Stage::Rest, ..) => return self.error_at_rest(),
            (_, Stage::Multigrid, Some(multigrid), _) => multigrid.ending().error,
            (.., Some(newton)) => newton.error(),
            _ => f64::INFINITY,
        };
        (error / self.problem.obstacle.dome.reference_length()).max(self.left)
    }

    /// See [`Report::estimated_discretisation_error`].
    #[must_use]
    pub fn estimated_discretisation_error(&self) -> Option<f64> {
        if self.stage != Stage::Multigrid || self.verdict != Verdict::Converged {
            return None;
        }
        let Problem { rest, obstacle, .. } = &*self.problem;
        // Off centre the start grids end far from their own solutions: the change would be theirs.
        if self.problem.mirrored() != [true; 2] {
            return None;
        }
        let change = self.multigrid.as_ref()?.change_by_refinement()?;
        Some(discretisation::error(change, rest) / obstacle.dome.reference_length())
    }

    /// Completed fraction of the solve, 0 to 1: nested grids count for a third, the finest grid's estimated
    /// error for the rest. The fraction falls where the solve restarts on the coarsest grid.
    #[must_use]
    pub fn fraction_done(&self) -> f64 {
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
        match self.law.membrane() {
            SheetLaw::Coupled(law) => Some(law),
            SheetLaw::Paper(_) => None,
        }
    }

    /// Number of tables of one triangle (coupled springs) or spring: layers of equal Poisson ratio share a table.
    #[must_use]
    pub fn tables(&self) -> usize {
        self.coupled_law().map_or(1, CoupledLaw::groups)
    }

    /// The greatest error of the law's tables, relative to their peak stress \[-\].
    #[must_use]
    pub fn table_error(&self) -> f64 {
        self.law.membrane().table_error()
    }
}

//! A sheet in Newton's method: one layer of nodes, an assembled positive semidefinite Hessian, Galerkin coarse grids.
//!
//! The step of an iteration: projected block Gauss–Seidel sweeps find the active set (`active_set_step`); conjugate
//! gradients, a truncated V-cycle as preconditioner, correct the inactive directions; both repeat until neither changes
//! the step. Cf. C. Gräser and R. Kornhuber, "Multigrid methods for obstacle problems", J. Comput. Math. 27(1), 2009.
//!
//! `robust`: safeguards near singular stiffness, skip on first reading. `contact_offsets` (contact that ends between
//! nodes) | `finish` (checks of a converged solution, output) | `parameters`.

mod active_set_step;
mod contact_offsets;
mod finish;
mod parameters;
mod robust;

use super::conjugate_gradients::CgState;
use super::parameters::{self as shared, Parameters};
use super::{Case, Contact, Grid, Layers, Newton, Phase, State, System, Trial};
use crate::contact::{Obstacle, TOUCH_F64};
use crate::mesh::stencil::BlockStencil9;
use crate::model::membrane::assembly::{self, Stiffness, Totals};
use crate::model::membrane::law::SheetLaw;
use crate::solve::initial_guess;
use crate::solve::linear::galerkin::{Finest, Hierarchy, safe_inverse};
use crate::solve::validity;
use finish::Checks;
use glam::{DMat3, DVec3};
use parameters::{CELLS_PER_PIECE, PARAMETERS, cost};
use robust::{Robust, SafeguardPhase};

/// Least scale of forces \[small-strain stiffness × spacing\]: in a sheet at rest the forces are rounding.
const MIN_FORCE_SCALE: f64 = 1e-9;

pub(super) type SheetNewton = Newton<SheetSystem>;
type SheetCase<'a> = Case<'a, SheetLaw>;

/// The quadratic model of the energy of a sheet, and the state of its step. Arrays of shape (n², ).
pub(in crate::solve) struct SheetSystem {
    hessian: BlockStencil9,
    hierarchy: Hierarchy,
    /// Do the coarse operators belong to the current Hessian?
    is_built: bool,
    /// Inverse diagonal blocks, unconstrained.
    inverse: Vec<DMat3>,
    totals: Totals,
    /// The correction of conjugate gradients.
    q: Layers,
    /// Residuals inside a V-cycle; zero at nodes that are not free.
    scratch: Vec<DVec3>,
    /// Number of nodes with active constraints changed by the last sweeps.
    changed: usize,
    /// Greatest change of a node in the last round \[mm\].
    last_round: f64,
    /// Contact offset of each node, as a gauge \[-\]; negative if contact ends before the node.
    offset: Vec<f64>,
    /// Error of neglected contact offsets \[mm\].
    neglected_offset: f64,
    robust: Robust,
}

/// A piece of work of a sheet alone.
#[derive(Clone, Copy)]
pub(in crate::solve) enum Piece {
    /// Builds a piece of the coarse operators.
    Build {
        piece: usize,
    },
    /// Ends a round of active set and conjugate gradients.
    Correct,
    Robust(SafeguardPhase),
}

impl System for SheetSystem {
    type Law = SheetLaw;
    type Piece = Piece;
    type Checks = Checks;
    const PARAMETERS: Parameters = shared::SHEET;

    fn elements(grid: &Grid) -> usize {
        grid.sheet().len()
    }

    fn new(grid: &Grid) -> Self {
        let (size, n) = (grid.sheet().len(), grid.sheet().nodes_per_side());
        Self {
            hessian: BlockStencil9::new(n),
            hierarchy: Hierarchy::new(n, &grid.free),
            is_built: false,
            inverse: vec![DMat3::ZERO; size],
            totals: Totals::default(),
            q: vec![vec![DVec3::ZERO; size]],
            scratch: vec![DVec3::ZERO; size],
            changed: 0,
            last_round: 0.0,
            offset: vec![0.0; size],
            neglected_offset: 0.0,
            robust: Robust::new(size),
        }
    }

    fn set_first_guess(grid: &Grid, obstacle: &Obstacle, x: &mut Layers) {
        x[0] = initial_guess::taut_profile(&grid.rest, &obstacle.dome);
    }

    fn start(newton: &mut SheetNewton, case: &SheetCase) {
        newton.system.robust.start();
        newton.system.offset.fill(0.0);
        newton.system.neglected_offset = 0.0;
        for k in newton.grid.free() {
            newton.x[0][k] = case.obstacle.project(newton.x[0][k], 0.0);
        }
    }

    fn energy(&self, grid: &Grid, case: &SheetCase, x: &Layers) -> f64 {
        assembly::energy(grid.rest.membrane(), case.law, &x[0])
    }

    fn linearize(newton: &mut SheetNewton, case: &SheetCase, row: usize) -> Option<usize> {
        newton.add_rows(case.law, row, Stiffness::Positive)
    }

    fn complete(newton: &mut SheetNewton, case: &SheetCase) -> Option<State> {
        if newton.has_diverged(&case.obstacle) {
            return Some(State::Unstable);
        }
        newton.find_contact(&case.obstacle, TOUCH_F64);
        if newton.system.robust.has_curvature() {
            let is_definite = newton.add_curvature();
            if !newton.accept_curvature(is_definite) {
                return Some(State::Working);
            }
        }
        let SheetSystem { hessian, inverse, is_built, .. } = &mut newton.system;
        for k in newton.grid.free() {
            inverse[k] = safe_inverse(hessian.diagonal[k]);
        }
        *is_built = false;
        None
    }

    /// The lower bound keeps rounding from being compared with rounding in a sheet at rest.
    fn force_scale(&self, grid: &Grid, law: &SheetLaw) -> f64 {
        let rounding = MIN_FORCE_SCALE * law.stiffness() * grid.sheet().spacing_mm();
        self.totals.force_scale().max(rounding)
    }

    fn block(&self, k: usize) -> [&DMat3; 2] {
        [&self.hessian.diagonal[k], &self.inverse[k]]
    }

    fn product(&self, grid: &Grid, _contact: &Contact, v: &Layers, out: &mut Layers) {
        for k in grid.free() {
            out[0][k] = self.hessian.row(k, &v[0]);
        }
    }

    /// One V-cycle.
    fn precondition(&mut self, grid: &Grid, contact: &Contact, r: &Layers, z: &mut Layers) {
        let Self { hessian, hierarchy, scratch, .. } = self;
        hierarchy.cycle(&finest(hessian, grid, contact), &r[0], &mut z[0], scratch);
    }

    fn begin_rounds(newton: &mut SheetNewton) {
        newton.phase = Phase::ActiveSet;
    }

    fn update_active_set(newton: &mut SheetNewton) {
        newton.find_active_set();
    }

    /// One step; after the last step the next phase is the correction.
    fn conjugate_gradients(newton: &mut SheetNewton, CgState { step, start, rho }: CgState) {
        let Some((rho, left)) = newton.cg_step(step, rho) else {
            return newton.turn_to_definite_model();
        };
        newton.phase = if step + 1 >= PARAMETERS.max_cg_steps || left <= PARAMETERS.cg_drop * start
        {
            Phase::Own(Piece::Correct)
        } else {
            Phase::ConjugateGradients(CgState { step: step + 1, start, rho })
        };
    }

    fn own_piece(newton: &mut SheetNewton, case: &SheetCase, piece: Piece) -> State {
        match piece {
            Piece::Build { piece } => newton.build(piece),
            Piece::Correct => newton.correct(case),
            Piece::Robust(phase) => return newton.robust_step(case, phase),
        }
        State::Working
    }

    fn offset(&self, k: usize) -> f64 {
        self.offset[k]
    }

    fn energy_of_rounding(&self, grid: &Grid) -> f64 {
        f64::EPSILON * grid.sheet().radius_mm() * self.totals.force_scale()
    }

    fn is_uphill(&self, trial: &Trial) -> bool {
        trial.predicted <= 0.0
    }

    fn reject_step(newton: &mut SheetNewton, is_uphill: bool) -> State {
        newton.reject_step(is_uphill)
    }

    /// With a model that is too stiff, one small step is not evidence of convergence: near-zero stiffness may follow. The
    /// first step that was too short proves the estimate too small.
    fn accept_step(
        newton: &mut SheetNewton,
        case: &SheetCase,
        trial: &Trial,
        is_full: bool,
    ) -> State {
        let step = newton.system.robust.accept_step(is_full, newton.iterations);
        let growth = newton.system.robust.step_growth;
        newton.estimate_error(trial, step.is_whole, growth, growth > 1.0);
        newton.error += newton.system.last_round.min(trial.largest);
        newton.error += newton.system.robust.extrapolation;
        newton.system.robust.decay_extrapolation();
        let has_growth = step.is_whole && newton.is_too_short(trial);
        if newton.has_converged(trial, case, Self::PARAMETERS.max_residual_before_step)
            && (!has_growth || growth > 1.0)
            && let Some(ending) = newton.system.robust.confirm(step)
        {
            return ending;
        }
        newton.extend_step(step.is_whole, has_growth, trial.energy);
        State::Working
    }

    fn check(
        newton: &mut SheetNewton,
        checks: &mut Checks,
        case: &SheetCase,
        state: State,
    ) -> State {
        newton.check(checks, case, state)
    }

    fn is_inverted(grid: &Grid, x: &Layers) -> bool {
        validity::has_inverted_triangle(grid.sheet(), &x[0])
    }

    fn write_offsets(
        newton: &SheetNewton,
        obstacle: &Obstacle,
        x: &mut [DVec3],
        offset_nodes: &mut Vec<(usize, DVec3)>,
    ) {
        newton.write_offsets(&obstacle.dome, x, offset_nodes);
    }
}

/// The operators of the finest grid of a V-cycle.
fn finest<'a>(hessian: &'a BlockStencil9, grid: &'a Grid, contact: &'a Contact) -> Finest<'a> {
    let Contact { projector, inverse, .. } = contact;
    Finest { blocks: hessian, inverse, projector, free: &grid.free }
}

impl SheetNewton {
    /// Adds rows of cells to energy, forces and Hessian; returns the next row, `None` at the end.
    fn add_rows(&mut self, law: &SheetLaw, row: usize, stiffness: Stiffness) -> Option<usize> {
        let surface = self.grid.rest.membrane();
        let rows = surface.sheet().nodes_per_side() - 1;
        let SheetSystem { hessian, totals, .. } = &mut self.system;
        if row == 0 {
            self.forces[0].fill(DVec3::ZERO);
            hessian.clear();
            *totals = Totals::default();
        }
        let piece = (CELLS_PER_PIECE / (rows + 1)).max(1);
        let end = (row + piece).min(rows);
        let sums = assembly::Sums { forces: &mut self.forces[0], hessian, totals };
        assembly::linearize_rows(surface, law, &self.x[0], row..end, stiffness, sums);
        self.energy = self.system.totals.energy;
        (end < rows).then_some(row + piece)
    }

    /// Takes the dome's curvature from the blocks of nodes under a reaction; are all these blocks positive definite?
    fn add_curvature(&mut self) -> bool {
        let mut is_definite = true;
        for (k, curvature) in &self.contact.curvature {
            let block = &mut self.system.hessian.diagonal[*k];
            *block -= *curvature;
            is_definite &= is_positive_definite(block);
        }
        is_definite
    }
}

fn is_positive_definite(m: &DMat3) -> bool {
    let minor = m.x_axis.x * m.y_axis.y - m.x_axis.y * m.x_axis.y;
    m.x_axis.x > 0.0 && minor > 0.0 && m.determinant() > 0.0
}

//! Newton's method with contact on one grid.
//!
//! An iteration minimises the quadratic model of the energy under the linearised constraints (not into the dome,
//! not below the wall):
//!
//! 1. Linearise: forces, positive semidefinite Hessian, the obstacle's curvature at nodes under a reaction
//!    (`linearize`).
//! 2. Active set: projected block Gauss–Seidel sweeps (`active_set_step`).
//! 3. Step of the inactive directions: conjugate gradients, a truncated V-cycle as preconditioner
//!    (`conjugate_gradients`); 2 and 3 repeat until neither changes the step.
//! 4. Line search: the step, projected out of the obstacle, shortened until the energy falls; error estimate
//!    (`line_search`).
//!
//! Cf. C. Gräser and R. Kornhuber, "Multigrid methods for obstacle problems", J. Comput. Math. 27(1), 2009.
//!
//! `robust`: safeguards near singular stiffness, skip on first reading. `contact_offsets` (contact that ends
//! between nodes) | `finish` (output) | `nested` (nested grids) | `prolongation`.

mod active_set_step;
mod conjugate_gradients;
mod contact_offsets;
mod finish;
mod line_search;
mod nested;
mod parameters;
pub(super) mod prolongation;
mod robust;

use super::linear::galerkin::Hierarchy;
use crate::contact::active_set::{Constraint, FREE, Reaction};
use crate::contact::{Obstacle, TOUCH_F64};
use crate::mesh::stencil::BlockStencil9;
use crate::mesh::{NodeKind, Sheet};
use crate::model::membrane::assembly::{self, Stiffness, Totals};
use crate::model::membrane::law::SheetLaw;
use crate::solve::linear::galerkin::safe_inverse;
use glam::{DMat3, DVec3};
pub(super) use nested::{NestedNewton, Start};
use parameters::{CELLS_PER_PIECE, PARAMETERS, cost};
pub(super) use robust::symmetry::Mirrors;
use robust::{HessianUse, Robust, SafeguardPhase};

/// Least scale of forces \[small-strain stiffness × spacing\]: in a sheet at rest the forces are rounding.
const MIN_FORCE_SCALE: f64 = 1e-9;

/// State of the iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum State {
    Working,
    Converged,
    /// Iterations or work are exhausted, or no step lowers the energy.
    Stalled,
    /// A spring left the domain of its law, or the shape is a saddle point.
    Unstable,
    /// Forces balance, but an active node is in unstable equilibrium on the dome.
    Saddle,
}

/// The next piece of work.
#[derive(Clone, Copy)]
enum Phase {
    /// Adds rows of cells to forces and Hessian, from `row` on.
    Linearize {
        row: usize,
    },
    ActiveSet,
    /// Builds a piece of the coarse operators.
    Build {
        piece: usize,
    },
    ConjugateGradients(CgState),
    /// Ends a round of active set and conjugate gradients.
    Correct,
    LineSearch {
        length: f64,
        halvings: u32,
    },
    Robust(SafeguardPhase),
}

/// A conjugate-gradient iteration between two steps.
#[derive(Clone, Copy)]
struct CgState {
    step: u32,
    /// Norm of the residual at the start.
    start: f64,
    /// r·z of the step before.
    rho: f64,
}

/// The quadratic model of the energy at `x`. Arrays of shape (n², ).
struct Model {
    hessian: BlockStencil9,
    hierarchy: Hierarchy,
    /// Do the coarse operators belong to the current Hessian?
    is_built: bool,
    /// Inverse diagonal blocks, unconstrained.
    inverse: Vec<DMat3>,
    /// Inverse diagonal blocks in the unconstrained directions.
    tangent_inverse: Vec<DMat3>,
    /// Projectors onto the unconstrained directions.
    projector: Vec<DMat3>,
    totals: Totals,
}

/// Contact conditions at every node; arrays of shape (n², ).
struct Contact {
    /// Active constraints, see [`crate::contact::active_set`].
    active: Vec<u8>,
    constraint: Vec<Constraint>,
    /// Number of nodes with active constraints changed by the last sweeps.
    changed: usize,
    /// Contact offset of each node, as a gauge \[-\]; negative if contact ends before the node.
    offset: Vec<f64>,
    /// Error of neglected contact offsets \[mm\].
    neglected_offset: f64,
}

/// Vectors of conjugate gradients; arrays of shape (n², ).
struct Vectors {
    r: Vec<DVec3>,
    z: Vec<DVec3>,
    p: Vec<DVec3>,
    /// The correction.
    q: Vec<DVec3>,
    /// Residuals inside a V-cycle; zero at nodes that are not free.
    scratch: Vec<DVec3>,
}

/// The iteration on one grid. Arrays of shape (n², ).
pub(super) struct Newton {
    sheet: Sheet,
    /// Free nodes.
    free: Vec<u32>,
    /// Positions \[mm\].
    x: Vec<DVec3>,
    /// Number of changes of `x`.
    revision: u64,
    forces: Vec<DVec3>,
    model: Model,
    contact: Contact,
    /// The step.
    d: Vec<DVec3>,
    /// Positions after the step; after an accepted step the positions before the step.
    trial: Vec<DVec3>,
    vectors: Vectors,
    phase: Phase,
    robust: Robust,
    iterations: u32,
    /// Rounds of this iteration, and the greatest change of a node in the last round \[mm\].
    rounds: u32,
    last_round: f64,
    /// Length of the last whole step \[mm\].
    last_step: f64,
    relative_residual: f64,
    /// Estimated greatest node position error \[mm\].
    error: f64,
    work_units: f64,
    max_iterations: u32,
    max_work: f64,
}

impl Newton {
    pub(super) fn new(sheet: Sheet, work_limit_factor: f64) -> Self {
        let (size, n) = (sheet.len(), sheet.nodes_per_side());
        let max_work = (PARAMETERS.max_node_work / size as f64).max(PARAMETERS.min_work_limit);
        let free: Vec<u32> =
            (0..size).filter(|&k| sheet.kinds()[k] == NodeKind::Free).map(|k| k as u32).collect();
        let vectors = || vec![DVec3::ZERO; size];
        let matrices = || vec![DMat3::ZERO; size];
        Self {
            x: sheet.rest_positions(),
            revision: 0,
            forces: vectors(),
            model: Model {
                hessian: BlockStencil9::new(n),
                hierarchy: Hierarchy::new(n, &free),
                is_built: false,
                inverse: matrices(),
                tangent_inverse: matrices(),
                projector: matrices(),
                totals: Totals::default(),
            },
            contact: Contact {
                active: vec![FREE; size],
                constraint: vec![Constraint::default(); size],
                changed: 0,
                offset: vec![0.0; size],
                neglected_offset: 0.0,
            },
            d: vectors(),
            trial: vectors(),
            vectors: Vectors {
                r: vectors(),
                z: vectors(),
                p: vectors(),
                q: vectors(),
                scratch: vectors(),
            },
            phase: Phase::Linearize { row: 0 },
            robust: Robust::new(size),
            iterations: 0,
            rounds: 0,
            last_round: 0.0,
            last_step: f64::INFINITY,
            relative_residual: f64::INFINITY,
            error: f64::INFINITY,
            work_units: 0.0,
            max_iterations: (f64::from(PARAMETERS.max_iterations) * work_limit_factor) as u32,
            max_work: max_work * work_limit_factor,
            free,
            sheet,
        }
    }

    /// Starts from the positions in `x`, projected out of the obstacle.
    pub(super) fn start(&mut self, obstacle: &Obstacle, mirrors: Mirrors) {
        self.robust.start(mirrors, &obstacle.dome);
        self.symmetrize_positions();
        for &k in &self.free {
            let k = k as usize;
            self.contact.offset[k] = 0.0;
            self.x[k] = obstacle.project(self.x[k], 0.0);
        }
        self.phase = Phase::Linearize { row: 0 };
        self.revision += 1;
        self.iterations = 0;
        self.contact.neglected_offset = 0.0;
        self.last_step = f64::INFINITY;
        self.error = f64::INFINITY;
        self.relative_residual = f64::INFINITY;
    }

    /// Does the next piece of work, a few passes over the grid at most. `tolerance` \[mm\].
    pub(super) fn step(&mut self, law: &SheetLaw, obstacle: &Obstacle, tolerance: f64) -> State {
        match self.phase {
            Phase::Linearize { row } => return self.linearize(law, obstacle, row),
            Phase::ActiveSet => self.find_active_set(),
            Phase::Build { piece } => self.build(piece),
            Phase::ConjugateGradients(cg) => self.conjugate_gradients(cg),
            Phase::Correct => self.correct(obstacle, tolerance),
            Phase::LineSearch { length, halvings } => {
                return self.line_search(law, obstacle, tolerance, length, halvings);
            }
            Phase::Robust(phase) => return self.robust_step(law, obstacle, tolerance, phase),
        }
        State::Working
    }

    fn linearize(&mut self, law: &SheetLaw, obstacle: &Obstacle, row: usize) -> State {
        if self.iterations >= self.max_iterations || self.work_units > self.max_work {
            return State::Stalled;
        }
        if let Some(row) = self.add_rows(law, row, Stiffness::Positive) {
            self.phase = Phase::Linearize { row };
            return State::Working;
        }
        self.iterations += 1;
        self.robust.hessian = HessianUse::Positive;
        if self.has_diverged(obstacle) {
            return State::Unstable;
        }
        let is_definite = self.add_contact(obstacle);
        if !self.accept_curvature(is_definite) {
            return State::Working;
        }
        for &k in &self.free {
            let k = k as usize;
            self.d[k] = DVec3::ZERO;
            self.model.inverse[k] = safe_inverse(self.model.hessian.diagonal[k]);
        }
        self.relative_residual = self.residual(law);
        self.rounds = 0;
        self.model.is_built = false;
        self.phase = Phase::ActiveSet;
        State::Working
    }

    /// Adds rows of cells to forces and Hessian; returns the next row, `None` at the end.
    fn add_rows(&mut self, law: &SheetLaw, row: usize, stiffness: Stiffness) -> Option<usize> {
        let rows = self.sheet.nodes_per_side() - 1;
        let Model { hessian, totals, .. } = &mut self.model;
        if row == 0 {
            self.work_units += cost::LINEARIZE;
            self.forces.fill(DVec3::ZERO);
            hessian.clear();
            *totals = Totals::default();
        }
        let piece = (CELLS_PER_PIECE / self.sheet.nodes_per_side()).max(1);
        let end = (row + piece).min(rows);
        let sums = assembly::Sums { forces: &mut self.forces, hessian, totals };
        assembly::linearize_rows(&self.sheet, law, &self.x, row..end, stiffness, sums);
        (end < rows).then_some(row + piece)
    }

    /// Finds the active constraints, and adds the dome's curvature under active nodes to the model unless
    /// curvature is off; returns whether all diagonal blocks with curvature are positive definite.
    fn add_contact(&mut self, obstacle: &Obstacle) -> bool {
        let touch = TOUCH_F64 * obstacle.dome.reference_length();
        let mut is_definite = true;
        for k in 0..self.free.len() {
            let k = self.free[k] as usize;
            let reaction = self.find_contact(obstacle, k, touch);
            if self.robust.has_curvature() && reaction.per_gradient > 0.0 {
                let block = &mut self.model.hessian.diagonal[k];
                *block -= obstacle.curvature(self.x[k], &reaction);
                is_definite &= is_positive_definite(block);
            }
        }
        is_definite
    }

    /// Finds the active constraints of a node, of surfaces nearer than `touch` \[mm\], and their reactions.
    fn find_contact(&mut self, obstacle: &Obstacle, k: usize, touch: f64) -> Reaction {
        let offset = self.contact.offset[k].abs();
        let constraint = Constraint::new(&obstacle.dome, obstacle.wall, self.x[k], offset);
        let reaction = constraint.reaction(self.forces[k], touch);
        self.contact.constraint[k] = constraint;
        self.contact.active[k] = reaction.active;
        reaction
    }

    /// Norm of the nodal forces without contact forces, relative to the forces of all triangles.
    fn residual(&self, law: &SheetLaw) -> f64 {
        let square = |&k: &u32| {
            let k = k as usize;
            let projector = self.contact.constraint[k].projector(self.contact.active[k]);
            (projector * self.forces[k]).length_squared()
        };
        let squares: f64 = self.free.iter().map(square).sum();
        squares.sqrt() / self.force_scale(law)
    }

    /// The scale of forces \[kPa·mm²\]. The lower bound keeps rounding from being compared with rounding in a sheet at
    /// rest.
    fn force_scale(&self, law: &SheetLaw) -> f64 {
        let rounding = MIN_FORCE_SCALE * law.stiffness() * self.sheet.spacing_mm();
        self.model.totals.force_scale().max(rounding)
    }

    pub(super) fn revision(&self) -> u64 {
        self.revision
    }

    pub(super) fn relative_residual(&self) -> f64 {
        self.relative_residual
    }

    /// Estimated greatest node position error \[mm\].
    pub(super) fn error(&self) -> f64 {
        self.error
    }
}

fn is_positive_definite(m: &DMat3) -> bool {
    let minor = m.x_axis.x * m.y_axis.y - m.x_axis.y * m.x_axis.y;
    m.x_axis.x > 0.0 && minor > 0.0 && m.determinant() > 0.0
}

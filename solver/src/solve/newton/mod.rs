//! Newton's method with contact on one grid, in f64, for either tissue model.
//!
//! An iteration minimises the quadratic model of the energy under the linearised constraints of the inner face (not into
//! the dome, not below the wall):
//!
//! 1. Linearise: energy, forces, second derivatives, the obstacle's curvature at nodes under a reaction (`linearize`).
//! 2. The step under the constraints, in rounds of active set and conjugate gradients (`conjugate_gradients`), by the
//!    tissue model's own schedule: `sheet`, `layered`.
//! 3. Line search: the step, projected out of the obstacle, shortened until the energy falls; error estimate
//!    (`line_search`).
//!
//! `system`: the trait of a tissue model. `nested`: nested grids, rising dome. `prolongation` | `parameters`. No iteration
//! but the first allocates.

mod conjugate_gradients;
mod layered;
mod line_search;
mod nested;
mod parameters;
mod prolongation;
mod sheet;
mod system;

use super::Problem;
use crate::contact::Obstacle;
use crate::contact::active_set::{Constraint, FREE};
use crate::mesh::{NodeKind, Patch, Rest, Sheet};
use conjugate_gradients::{CgState, Vectors};
use glam::{DMat3, DVec3};
pub(super) use layered::LayeredSystem;
use line_search::Trial;
pub(super) use nested::{NestedNewton, Start};
pub(super) use sheet::SheetSystem;
use system::System;

/// One vector a node, shape (layers, nodes_per_side²).
type Layers = Vec<Vec<DVec3>>;

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

/// The problem on one grid.
pub(super) struct Case<'a, L> {
    law: &'a L,
    patch: Patch,
    obstacle: Obstacle,
    /// Suction of a void on the inner face \[kPa\].
    suction_kpa: f64,
    /// Tolerance of positions \[mm\].
    tolerance: f64,
    /// Is a solution refined?
    refines: bool,
}

/// A step from a solution to a smaller tolerance.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Refinement {
    Improving,
    /// By the fall of the residual within the tolerance: for the estimate of the error alone.
    Confirming,
}

impl Refinement {
    /// Drop of √(r·z) in a round of conjugate gradients \[-\].
    fn drop(self) -> f64 {
        match self {
            Self::Improving => 1e-2,
            Self::Confirming => 0.1,
        }
    }

    /// The least ratio of the step after this one to this one \[-\].
    fn least_rate(self) -> f64 {
        3.0 * self.drop()
    }
}

/// The grid's nodes.
pub(super) struct Grid {
    rest: Rest,
    /// Free nodes of a layer.
    free: Vec<u32>,
}

impl Grid {
    fn sheet(&self) -> &Sheet {
        self.rest.sheet()
    }

    fn free(&self) -> impl DoubleEndedIterator<Item = usize> + '_ {
        self.free.iter().map(|&k| k as usize)
    }

    /// Puts all nodes at rest.
    fn put_at_rest(&self, x: &mut Layers) {
        for (layer, x) in x.iter_mut().enumerate() {
            x.iter_mut().zip(self.rest.nodes(layer)).for_each(|(x, rest)| *x = rest);
        }
    }
}

/// Contact conditions of the inner face; arrays of shape (n², ).
pub(super) struct Contact {
    constraint: Vec<Constraint>,
    /// Active constraints, see [`crate::contact::active_set`].
    active: Vec<u8>,
    /// Projectors onto the unconstrained directions; zero at nodes that are not free.
    projector: Vec<DMat3>,
    /// Inverse blocks in the unconstrained directions.
    inverse: Vec<DMat3>,
    /// The obstacle's curvature at nodes under a reaction, which the model's blocks lose \[kPa·mm\].
    curvature: Vec<(usize, DMat3)>,
}

/// The next piece of work.
#[derive(Clone, Copy)]
enum Phase<P> {
    /// Adds a piece of energy, forces and second derivatives.
    Linearize {
        piece: usize,
    },
    ActiveSet,
    ConjugateGradients(CgState),
    LineSearch {
        length: f64,
        halvings: u32,
    },
    Own(P),
}

/// The iteration on one grid.
pub(super) struct Newton<S: System> {
    grid: Grid,
    /// Positions \[mm\].
    x: Layers,
    /// Number of changes of `x`.
    revision: u64,
    forces: Layers,
    /// Energy at `x` \[kPa·mm³\].
    energy: f64,
    system: S,
    contact: Contact,
    /// The step.
    d: Layers,
    /// Positions after the step; after an accepted step the positions before the step.
    trial: Layers,
    vectors: Vectors,
    phase: Phase<S::Piece>,
    iterations: u32,
    /// Rounds of this iteration.
    rounds: u32,
    /// Length of the last whole step \[mm\].
    last_step: f64,
    relative_residual: f64,
    /// Of the next step.
    refinement: Option<Refinement>,
    /// Estimated greatest node position error \[mm\].
    error: f64,
    work_units: f64,
    max_iterations: u32,
    max_work: f64,
}

impl<S: System> Newton<S> {
    fn new(rest: Rest, work_limit_factor: f64) -> Self {
        let size = rest.sheet().len();
        let is_free = |k: &u32| rest.sheet().kinds()[*k as usize] == NodeKind::Free;
        let free: Vec<u32> = (0..size as u32).filter(is_free).collect();
        let grid = Grid { free, rest };
        let vectors = || vec![vec![DVec3::ZERO; size]; grid.rest.layers()];
        let mut x = vectors();
        grid.put_at_rest(&mut x);
        let limits = S::PARAMETERS;
        Self {
            x,
            revision: 0,
            forces: vectors(),
            energy: f64::INFINITY,
            system: S::new(&grid),
            contact: Contact {
                constraint: vec![Constraint::default(); size],
                active: vec![FREE; size],
                projector: vec![DMat3::ZERO; size],
                inverse: vec![DMat3::ZERO; size],
                curvature: Vec::with_capacity(grid.free.len()),
            },
            d: vectors(),
            trial: vectors(),
            vectors: Vectors { r: vectors(), z: vectors(), p: vectors(), product: vectors() },
            phase: Phase::Linearize { piece: 0 },
            iterations: 0,
            rounds: 0,
            last_step: f64::INFINITY,
            relative_residual: f64::INFINITY,
            refinement: None,
            error: f64::INFINITY,
            work_units: 0.0,
            max_iterations: (f64::from(limits.max_iterations) * work_limit_factor) as u32,
            max_work: limits.work_of_grid.of(S::elements(&grid)) * work_limit_factor,
            grid,
        }
    }

    /// Starts from the positions in `x`, moved until the inner face is outside of the obstacle.
    fn start(&mut self, case: &Case<S::Law>) {
        S::start(self, case);
        self.phase = Phase::Linearize { piece: 0 };
        self.revision += 1;
        self.iterations = 0;
        self.last_step = f64::INFINITY;
        self.error = f64::INFINITY;
        self.relative_residual = f64::INFINITY;
    }

    /// Does the next piece of work, a few passes over the grid at most.
    fn step(&mut self, case: &Case<S::Law>) -> State {
        match self.phase {
            Phase::Linearize { piece } => return self.linearize(case, piece),
            Phase::ActiveSet => S::update_active_set(self),
            Phase::ConjugateGradients(step) => S::conjugate_gradients(self, step),
            Phase::LineSearch { length, halvings } => {
                return self.line_search(case, length, halvings);
            }
            Phase::Own(piece) => return S::own_piece(self, case, piece),
        }
        State::Working
    }

    fn linearize(&mut self, case: &Case<S::Law>, piece: usize) -> State {
        if self.iterations >= self.max_iterations || self.work_units > self.max_work {
            return State::Stalled;
        }
        if piece == 0 {
            self.work_units += S::PARAMETERS.cost.linearize;
        }
        if let Some(piece) = S::linearize(self, case, piece) {
            self.phase = Phase::Linearize { piece };
            return State::Working;
        }
        self.iterations += 1;
        if let Some(state) = S::complete(self, case) {
            return state;
        }
        let residual = self.residual(case);
        let expected = self.last_step * residual / self.relative_residual;
        self.relative_residual = residual;
        let is_confirmed = expected <= case.tolerance;
        let refinement = if is_confirmed { Refinement::Confirming } else { Refinement::Improving };
        self.refinement = case.refines.then_some(refinement);
        self.d.iter_mut().for_each(|layer| layer.fill(DVec3::ZERO));
        self.rounds = 0;
        S::begin_rounds(self);
        State::Working
    }

    /// Finds the active constraints, of surfaces nearer than `touch` \[base radius\], their reactions and the curvature
    /// under the reactions.
    fn find_contact(&mut self, obstacle: &Obstacle, touch: f64) {
        let touch = touch * obstacle.dome.reference_length();
        let Contact { constraint, active, curvature, .. } = &mut self.contact;
        curvature.clear();
        for k in self.grid.free() {
            let (x, offset) = (self.x[0][k], self.system.offset(k).abs());
            constraint[k] = Constraint::new(&obstacle.dome, &obstacle.wall, x, offset);
            let reaction = constraint[k].reaction(self.forces[0][k], touch);
            active[k] = reaction.active;
            let bend = obstacle.curvature(x, &reaction);
            if bend != DMat3::ZERO {
                curvature.push((k, bend));
            }
        }
    }

    /// Sets a node's projector onto the unconstrained directions, and the inverse block in these directions.
    fn constrain(&mut self, k: usize) {
        let (constraint, active) = (&self.contact.constraint[k], self.contact.active[k]);
        let [block, inverse] = self.system.block(k);
        self.contact.projector[k] = constraint.projector(active);
        self.contact.inverse[k] = constraint.constrained_inverse(active, *inverse, block);
    }

    /// Norm of the nodal forces without contact forces, relative to the scale of forces.
    fn residual(&self, case: &Case<S::Law>) -> f64 {
        let mut squares = 0.0;
        for (layer, forces) in self.forces.iter().enumerate() {
            for k in self.grid.free() {
                let projector = self.contact.constraint[k].projector(self.contact.active[k]);
                let force = if layer == 0 { projector * forces[k] } else { forces[k] };
                squares += force.length_squared();
            }
        }
        squares.sqrt() / self.system.force_scale(&self.grid, case.law)
    }
}

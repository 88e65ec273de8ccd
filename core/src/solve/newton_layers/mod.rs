//! Newton's method for layered tissue on one grid, in f64, without an assembled matrix.
//!
//! An iteration minimises the quadratic model of the energy under the linearised constraints of the inner face:
//!
//! 1. Linearise: forces, second derivatives of the cells, column blocks, the obstacle's curvature (`linearize`).
//! 2. Conjugate gradients in the inactive directions; column solves precondition (`conjugate_gradients`). A direction of
//!    negative curvature ends them (T. Steihaug, SIAM J. Numer. Anal. 20(3), 1983).
//! 3. Active set of the step: nodes that pass the obstacle become active, nodes that the obstacle would pull leave;
//!    2 and 3 repeat until the set rests (`update_active_set`; M. Hintermüller, K. Ito and K. Kunisch, SIAM J. Optim. 13(3),
//!    2002).
//! 4. Line search along the step, projected out of the obstacle (`line_search`).
//!
//! `nested`: nested grids, rising dome.

mod conjugate_gradients;
mod line_search;
mod nested;

use super::newton::State;
use super::problem::Problem;
use crate::contact::active_set::{Constraint, FREE, ON_DOME, ON_WALL};
use crate::contact::{Obstacle, TOUCH_F64};
use crate::mesh::stencil::BlockStencil9;
use crate::mesh::{NodeKind, Sheet};
use crate::model::layered::LayeredLaw;
use crate::model::layered::exact::{Exact, Place};
use crate::model::layered::tangent::Tangent;
use crate::model::membrane::assembly::{self, Stiffness, Sums, Totals};
use crate::solve::linear::columns::Columns;
use glam::{DMat3, DVec3};
pub(super) use nested::NestedLayers;

/// Iterations after which the iteration ends, times [`crate::solve::Options::work_limit_factor`].
const MAX_ITERATIONS: f64 = 60.0;
/// Cells whose second derivatives are one piece of work: a few milliseconds.
const PLACES_PER_PIECE: usize = 1024;
/// Rounds of conjugate gradients and active set in one iteration.
const MAX_ROUNDS: u32 = 15;
/// Depth in the obstacle at which a node of a step becomes active, and distance from the obstacle below which an active
/// node stays so unless the obstacle pulls \[spacings\].
const ON_SURFACE: (f64, f64) = (1e-9, 1e-6);

/// Costs in work units (one evaluation of all forces), by measured times.
mod cost {
    pub(super) const LINEARIZE: f64 = 12.0;
    pub(super) const PRODUCT: f64 = 1.0;
    pub(super) const ENERGY: f64 = 0.7;
}

/// One vector a node, shape (layers, nodes_per_side²).
type Layers = Vec<Vec<DVec3>>;

/// The next piece of work.
#[derive(Clone, Copy)]
enum Phase {
    /// Adds the cells at places from `place` on.
    Linearize {
        place: usize,
    },
    /// `start`: √(r·z) of the first step; `rho`: r·z of the step before.
    Gradients {
        step: u32,
        start: f64,
        rho: f64,
    },
    ActiveSet,
    LineSearch {
        length: f64,
        halvings: u32,
    },
}

/// The iteration on one grid.
pub(in crate::solve) struct Newton {
    sheet: Sheet,
    places: Vec<Place>,
    /// Heights of the layers of nodes at rest \[mm\].
    heights: Vec<f64>,
    /// Free nodes of a layer.
    free: Vec<u32>,
    /// Positions \[mm\].
    x: Layers,
    /// Number of changes of `x`.
    revision: u64,
    forces: Layers,
    tangent: Tangent,
    skin: BlockStencil9,
    totals: Totals,
    columns: Columns,
    /// Blocks of the inner face and their inverses, the nodes above being free to follow.
    inner: Vec<[DMat3; 2]>,
    /// Inverse blocks and projectors of the inner face in the unconstrained directions.
    constrained: Vec<DMat3>,
    projector: Vec<DMat3>,
    constraint: Vec<Constraint>,
    active: Vec<u8>,
    /// What the obstacle's curvature takes from the blocks of nodes under a reaction.
    curvature: Vec<(usize, DMat3)>,
    /// Energy at `x` \[kPa·mm³\].
    energy: f64,
    /// The step.
    d: Layers,
    /// Positions after the step.
    trial: Layers,
    r: Layers,
    z: Layers,
    p: Layers,
    phase: Phase,
    iterations: u32,
    rounds: u32,
    /// Length of the last whole step \[mm\].
    last_step: f64,
    relative_residual: f64,
    /// Estimated greatest node position error \[mm\].
    error: f64,
    work_units: f64,
    max_iterations: u32,
}

fn exact<'a>(sheet: &'a Sheet, law: &'a LayeredLaw, problem: &Problem) -> Exact<'a> {
    let patch = &problem.patch;
    Exact { sheet, law, pocket_radius: patch.pocket_radius_mm, attachment: patch.attachment() }
}

impl Newton {
    fn new(sheet: Sheet, law: &LayeredLaw, work_limit_factor: f64) -> Self {
        let (size, n, heights) = (sheet.len(), sheet.nodes_per_side(), law.heights());
        let layers = heights.len();
        let free: Vec<u32> =
            (0..size).filter(|&k| sheet.kinds()[k] == NodeKind::Free).map(|k| k as u32).collect();
        let vectors = || vec![vec![DVec3::ZERO; size]; layers];
        Self {
            places: Vec::new(),
            x: vectors(),
            revision: 0,
            forces: vectors(),
            tangent: Tangent::default(),
            skin: BlockStencil9::new(n),
            totals: Totals::default(),
            columns: Columns::new(size, layers),
            inner: vec![[DMat3::ZERO; 2]; size],
            constrained: vec![DMat3::ZERO; size],
            projector: vec![DMat3::ZERO; size],
            constraint: vec![Constraint::default(); size],
            active: vec![FREE; size],
            curvature: Vec::new(),
            energy: f64::INFINITY,
            d: vectors(),
            trial: vectors(),
            r: vectors(),
            z: vectors(),
            p: vectors(),
            phase: Phase::Linearize { place: 0 },
            iterations: 0,
            rounds: 0,
            last_step: f64::INFINITY,
            relative_residual: f64::INFINITY,
            error: f64::INFINITY,
            work_units: 0.0,
            max_iterations: (MAX_ITERATIONS * work_limit_factor) as u32,
            free,
            heights,
            sheet,
        }
    }

    /// Does the next piece of work start an iteration?
    fn is_between_iterations(&self) -> bool {
        matches!(self.phase, Phase::Linearize { place: 0 })
    }

    /// Number of cells between free nodes.
    fn cells(&self) -> f64 {
        (self.free.len() * (self.heights.len() - 1)).max(1) as f64
    }

    /// Puts all nodes at rest.
    fn put_at_rest(&mut self) {
        for (x, height) in self.x.iter_mut().zip(&self.heights) {
            for (x, rest) in x.iter_mut().zip(self.sheet.rest()) {
                *x = rest.extend(*height);
            }
        }
    }

    /// Starts from the positions in `x`, whole columns moved until the inner face is outside of the obstacle.
    fn start(&mut self, law: &LayeredLaw, problem: &Problem, obstacle: &Obstacle) {
        let exact = exact(&self.sheet, law, problem);
        self.places = exact.places();
        self.tangent.attach(&exact);
        for &k in &self.free {
            let k = k as usize;
            let shift = obstacle.project(self.x[0][k], 0.0) - self.x[0][k];
            self.x.iter_mut().for_each(|layer| layer[k] += shift);
        }
        self.phase = Phase::Linearize { place: 0 };
        self.revision += 1;
        self.iterations = 0;
        self.last_step = f64::INFINITY;
        self.error = f64::INFINITY;
        self.relative_residual = f64::INFINITY;
    }

    /// Does the next piece of work. `tolerance` \[mm\].
    fn step(
        &mut self,
        law: &LayeredLaw,
        problem: &Problem,
        obstacle: &Obstacle,
        tolerance: f64,
    ) -> State {
        match self.phase {
            Phase::Linearize { place } => return self.linearize(law, problem, obstacle, place),
            Phase::Gradients { step, start, rho } => self.conjugate_gradients(step, start, rho),
            Phase::ActiveSet => self.update_active_set(),
            Phase::LineSearch { length, halvings } => {
                return self.line_search(law, problem, obstacle, tolerance, length, halvings);
            }
        }
        State::Working
    }

    fn linearize(
        &mut self,
        law: &LayeredLaw,
        problem: &Problem,
        obstacle: &Obstacle,
        place: usize,
    ) -> State {
        if self.iterations >= self.max_iterations {
            return State::Stalled;
        }
        let exact = exact(&self.sheet, law, problem);
        if place == 0 {
            self.work_units += cost::LINEARIZE;
            self.forces = exact.forces(&self.x);
            if self.iterations == 0 {
                self.energy = exact.energy(&self.places, &self.x);
                if !self.energy.is_finite() {
                    return State::Stalled;
                }
            }
            self.tangent.clear();
        }
        let end = (place + PLACES_PER_PIECE).min(self.places.len());
        self.tangent.linearize(&exact, &self.places[place..end], &self.x);
        if end < self.places.len() {
            self.phase = Phase::Linearize { place: end };
            return State::Working;
        }
        self.iterations += 1;
        self.linearize_skin(law);
        self.find_contact(obstacle);
        self.eliminate_columns();
        self.relative_residual = self.residual();
        self.d.iter_mut().for_each(|layer| layer.fill(DVec3::ZERO));
        self.rounds = 0;
        self.begin_gradients();
        State::Working
    }

    fn linearize_skin(&mut self, law: &LayeredLaw) {
        self.skin.clear();
        self.totals = Totals::default();
        let top = self.x.len() - 1;
        // `trial` is scratch: `forces` contains the skin's forces already.
        let sums = Sums {
            forces: &mut self.trial[top],
            hessian: &mut self.skin,
            totals: &mut self.totals,
        };
        let rows = 0..self.sheet.nodes_per_side() - 1;
        let (sheet, x) = (&self.sheet, &self.x[top]);
        assembly::linearize_rows(sheet, &law.skin, x, rows, Stiffness::Positive, sums);
    }

    /// Finds the active constraints, their reactions and the curvature under the reactions.
    fn find_contact(&mut self, obstacle: &Obstacle) {
        let touch = TOUCH_F64 * obstacle.dome.reference_length();
        self.curvature.clear();
        for &k in &self.free {
            let k = k as usize;
            let x = self.x[0][k];
            let constraint = Constraint::new(&obstacle.dome, obstacle.wall, x, 0.0);
            let reaction = constraint.reaction(self.forces[0][k], touch);
            if reaction.active != FREE {
                self.curvature.push((k, obstacle.curvature(x, &reaction)));
            }
            self.constraint[k] = constraint;
            self.active[k] = reaction.active;
        }
    }

    fn eliminate_columns(&mut self) {
        let columns = &mut self.columns;
        columns.clear();
        let Columns { diagonal, above } = columns;
        self.tangent.visit_blocks(
            |layer, k, block| diagonal[layer][k] += block,
            |layer, k, block| above[layer][k] += block,
        );
        let top = self.x.len() - 1;
        for &k in &self.free {
            columns.diagonal[top][k as usize] += self.skin.diagonal[k as usize];
        }
        for (k, curvature) in &self.curvature {
            columns.diagonal[0][*k] -= *curvature;
        }
        for &k in &self.free {
            self.inner[k as usize] = columns.eliminate(k as usize);
        }
        for k in 0..self.free.len() {
            self.constrain(self.free[k] as usize);
        }
    }

    /// Sets the projector and the inverse block of a node of the inner face in the unconstrained directions.
    fn constrain(&mut self, k: usize) {
        let (constraint, active) = (&self.constraint[k], self.active[k]);
        let [block, inverse] = self.inner[k];
        self.projector[k] = constraint.projector(active);
        self.constrained[k] = constraint.constrained_inverse(active, inverse, &block);
    }

    /// Adds nodes that the step moves into the obstacle to the active set, and takes nodes out that the obstacle would
    /// pull.
    fn update_active_set(&mut self) {
        self.rounds += 1;
        self.set_residual();
        let mut changed = 0;
        let (depth, touch) = ON_SURFACE;
        let [depth, touch] = [depth, touch].map(|part| part * self.sheet.spacing_mm());
        for index in 0..self.free.len() {
            let k = self.free[index] as usize;
            let (d, was) = (self.d[0][k], self.active[k]);
            let Constraint { normal, gap, wall_normal, height, .. } = self.constraint[k];
            let (over_dome, over_wall) = (gap + normal.dot(d), height + wall_normal.dot(d));
            let mut now = was;
            if over_dome < -depth {
                now |= ON_DOME;
            }
            if over_wall < -depth {
                now |= ON_WALL;
            }
            if now == was && was != FREE {
                // A constraint of a step is as one of a node on the surface.
                let mut moved = self.constraint[k];
                (moved.gap, moved.height) = (over_dome, over_wall);
                now &= moved.reaction(self.r[0][k], touch).active;
            }
            if now != was {
                changed += 1;
                self.active[k] = now;
                self.constrain(k);
            }
        }
        if changed == 0 || self.rounds >= MAX_ROUNDS {
            self.phase = Phase::LineSearch { length: 1.0, halvings: 0 };
        } else {
            self.begin_gradients();
        }
    }

    /// Norm of the nodal forces without contact forces, relative to the forces of cells and triangles.
    fn residual(&self) -> f64 {
        let mut squares = 0.0;
        for (layer, forces) in self.forces.iter().enumerate() {
            for &k in &self.free {
                let k = k as usize;
                let force = if layer == 0 { self.projector[k] * forces[k] } else { forces[k] };
                squares += force.length_squared();
            }
        }
        let scale = self.totals.force_scale().powi(2) + self.tangent.squared_forces();
        (squares / scale.max(f64::MIN_POSITIVE)).sqrt()
    }
}

//! Newton's method on one grid, with contact.
//!
//! Each iteration minimises the quadratic model of the energy under the linearised constraints
//! "not into the dome, not below the wall": projected block Gauss–Seidel finds which nodes press,
//! conjugate gradients with a truncated V-cycle move the others (cf. C. Gräser and R. Kornhuber,
//! "Multigrid methods for obstacle problems", J. Comput. Math. 27(1), 2009). The model holds the
//! dome's curvature under the pressing nodes. The step is put back onto the dome and shortened until
//! the energy falls. Where the sheet is nearly slack the model is far too stiff: there the iteration
//! goes on along a step, and across two of them, as long as the energy falls.
//!
//! `conjugate` (gradients) | `contact` (what a node there may do) | `search` (how far to go) | `lifts`
//! (contact that ends between nodes) | `ending` (what is given away) | `symmetry` | `stability` and
//! `true_step` (what the true Hessian tells) | `nested` (grids one after the other); here the model and
//! its minimum.

mod conjugate;
mod contact;
mod ending;
mod lifts;
mod nested;
mod search;
mod stability;
mod symmetry;
mod true_step;

use super::assemble::{self, Stiffness, Totals};
use super::blocks::{Blocks, outer};
use super::law::SheetLaw;
use super::multigrid::{Finest, Hierarchy, safe_inverse};
use crate::implant::Dome;
use crate::sheet::{NodeKind, Sheet};
use contact::{
    FREE, ON_DOME, ON_WALL, admissible, corner_step, curvature, edge_direction, projector, without,
};
use glam::{DMat3, DVec3};
pub(crate) use nested::NestedNewton;
use symmetry::{Mirror, symmetrize};

/// Newton iterations before a grid is given up.
const MAX_ITERATIONS: u32 = 150;
/// Iterations in a row with springs outside of their law before the sheet is taken to run away: the way to
/// a shape may lead there and back.
const MAX_OUTSIDE: u32 = 4;
/// A node this far from the pocket's centre is on its way away \[pocket's radius and dome's height\].
const RUNS_AWAY: f64 = 1.5;
/// Force evaluations times nodes before a grid is given up, a few seconds; on fine grids the least
/// number of force evaluations that is allowed all the same.
const MAX_NODE_WORK: f64 = 6e7;
const MAX_FINE_WORK: f64 = 400.0;
/// Rounds of (sweeps, conjugate gradients) in one iteration.
const MAX_ROUNDS: u32 = 12;
/// A round that moves less than this share of the step ends the iteration.
const ROUND_SHARE: f64 = 0.1;
/// A node this close to the dome counts as touching it \[share of the base radius\].
const TOUCH: f64 = 1e-9;

/// Cells that one piece of work adds up: two milliseconds or so.
const CELLS_PER_PIECE: usize = 4096;

/// Costs in work units (one evaluation of all nodal forces), by their flops.
const LINEARIZE_UNITS: f64 = 4.0;
const SWEEP_UNITS: f64 = 0.6;
const CYCLE_UNITS: f64 = 2.8;
const BUILD_UNITS: f64 = 2.0;

/// How a grid's iteration stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum State {
    Working,
    Converged,
    /// Out of iterations, or no step lowers the energy.
    Stalled,
    /// A spring left the range where its law has a meaning, or the shape is a saddle.
    Unstable,
    /// Forces balance, but a node would slide off the dome where it is held.
    Saddle,
}

enum Phase {
    /// The next row of cells to add.
    Linearize {
        row: usize,
    },
    Smooth,
    /// The next piece of the coarse operators.
    Build {
        piece: usize,
    },
    Cg {
        step: u32,
        start: f64,
        rho: f64,
    },
    Correct,
    Search {
        length: f64,
        halvings: u32,
    },
    /// Goes on along a step for which the model was too stiff, or across the last two, from an energy.
    Extend {
        length: f64,
        energy: f64,
        is_across: bool,
    },
    /// The next row of cells of the true Hessian.
    Stiffen {
        row: usize,
        question: Question,
    },
    Stability {
        step: u32,
        after: State,
    },
    /// As [`Self::Cg`], of the true model.
    TrueCg {
        step: u32,
        start: f64,
        rho: f64,
    },
}

/// What the true Hessian is asked.
#[derive(Clone, Copy)]
enum Question {
    /// Is the shape stable? If it is, the iteration ends so.
    IsStable(State),
    /// Where does its own step lead?
    Step,
}

/// Iteration on one grid: its shape, its model and scratch. Arrays of shape (n², ).
pub(crate) struct Newton {
    pub(crate) sheet: Sheet,
    pub(crate) x: Vec<DVec3>,
    pub(crate) forces: Vec<DVec3>,
    pub(crate) contact: Vec<u8>,
    free: Vec<u32>,
    /// In which the shape is its own image.
    mirrors: Vec<Mirror>,
    hessian: Blocks,
    hierarchy: Hierarchy,
    /// Inverse diagonal blocks, unconstrained.
    inverse: Vec<DMat3>,
    /// The same in the directions that may move.
    tangent_inverse: Vec<DMat3>,
    projector: Vec<DMat3>,
    normal: Vec<DVec3>,
    gap: Vec<f64>,
    /// Level of the dome at which each node touches \[-\]; negative where it is off the dome indeed.
    lift: Vec<f64>,
    /// Error of leaving lifts out \[mm\].
    missed: f64,
    /// The step, and the step before the last correction.
    d: Vec<DVec3>,
    r: Vec<DVec3>,
    z: Vec<DVec3>,
    p: Vec<DVec3>,
    q: Vec<DVec3>,
    trial: Vec<DVec3>,
    /// The shape before the last step but one, if there is one.
    earlier: Vec<DVec3>,
    has_earlier: bool,
    /// Residuals inside a V-cycle; zero at nodes that are not free.
    scratch: Vec<DVec3>,
    phase: Phase,
    pub(crate) iterations: u32,
    /// How often `x` was changed.
    pub(crate) moves: u64,
    rounds: u32,
    is_built: bool,
    /// Leaves the dome's curvature out of the model: slower, but every step leads downhill.
    is_cautious: bool,
    /// The iteration up to which it stays so.
    cautious_to: u32,
    /// How often a shape found so was tried with the dome's curvature.
    tries: u32,
    /// Would a node slide off the dome where it is held, by the last model with the dome's curvature?
    is_saddle: bool,
    /// Was the true model asked for its step from this shape?
    is_asked: bool,
    /// How often in a row contact was in the way of its step.
    blocked: u32,
    /// For how many iterations springs were outside of the range where their law has a meaning.
    outside: u32,
    /// Steps by sweeps alone: where contact changes everywhere, they are sure to lead downhill.
    is_plain: bool,
    changed: usize,
    totals: Totals,
    last_step: f64,
    /// How far the last iterations went on after their steps \[mm\], those before the last by less.
    travelled: f64,
    /// The greatest length of a step so far, in those of the model: how much too stiff it was.
    stretch: f64,
    last_round: f64,
    pub(crate) relative_residual: f64,
    /// Estimated greatest node position error \[mm\].
    pub(crate) error: f64,
    pub(crate) work_units: f64,
    /// Where the grid is given up.
    most_iterations: u32,
    most_work: f64,
}

impl Newton {
    pub(crate) fn new(sheet: Sheet, patience: f64) -> Self {
        let size = sheet.len();
        let most_work = (MAX_NODE_WORK / size as f64).max(MAX_FINE_WORK);
        let free: Vec<u32> =
            (0..size).filter(|&k| sheet.kinds()[k] == NodeKind::Free).map(|k| k as u32).collect();
        let n = sheet.nodes_per_side();
        let vectors = || vec![DVec3::ZERO; size];
        let matrices = || vec![DMat3::ZERO; size];
        Self {
            x: sheet.rest().iter().map(|p| p.extend(0.0)).collect(),
            forces: vectors(),
            contact: vec![FREE; size],
            hessian: Blocks::new(n),
            hierarchy: Hierarchy::new(n, &free),
            inverse: matrices(),
            tangent_inverse: matrices(),
            projector: matrices(),
            normal: vectors(),
            gap: vec![0.0; size],
            lift: vec![0.0; size],
            missed: 0.0,
            d: vectors(),
            r: vectors(),
            z: vectors(),
            p: vectors(),
            q: vectors(),
            trial: vectors(),
            earlier: vectors(),
            has_earlier: false,
            scratch: vectors(),
            free,
            mirrors: Vec::new(),
            sheet,
            phase: Phase::Linearize { row: 0 },
            iterations: 0,
            moves: 0,
            rounds: 0,
            is_built: false,
            is_cautious: false,
            cautious_to: 0,
            tries: 0,
            is_saddle: false,
            is_asked: false,
            blocked: 0,
            outside: 0,
            is_plain: false,
            changed: 0,
            totals: Totals::default(),
            last_step: f64::INFINITY,
            travelled: 0.0,
            stretch: 1.0,
            last_round: 0.0,
            relative_residual: f64::INFINITY,
            error: f64::INFINITY,
            work_units: 0.0,
            most_iterations: (f64::from(MAX_ITERATIONS) * patience) as u32,
            most_work: most_work * patience,
        }
    }

    /// Starts from the positions in `x`, made admissible; keeps the shape its own image in every mirror in
    /// which the dome is, if that is wanted.
    pub(crate) fn start(&mut self, dome: &Dome, is_symmetric: bool) {
        self.mirrors = if is_symmetric { Mirror::of(dome) } else { Vec::new() };
        symmetrize(&self.mirrors, &self.sheet, &self.free, &mut self.x);
        for &k in &self.free {
            let k = k as usize;
            self.lift[k] = 0.0;
            self.x[k] = admissible(dome, self.x[k], 0.0);
        }
        self.phase = Phase::Linearize { row: 0 };
        self.moves += 1;
        self.iterations = 0;
        self.is_cautious = false;
        self.is_saddle = false;
        self.is_plain = false;
        self.blocked = 0;
        self.outside = 0;
        self.missed = 0.0;
        self.forget_steps();
        self.error = f64::INFINITY;
        self.relative_residual = f64::INFINITY;
    }

    /// Does the next piece of work, a few passes over the grid at most. `tolerance` \[mm\].
    pub(crate) fn step(&mut self, law: &SheetLaw, dome: &Dome, tolerance: f64) -> State {
        match self.phase {
            Phase::Linearize { row } => return self.linearize(law, dome, row),
            Phase::Smooth => self.smooth(),
            Phase::Build { piece } => self.build(piece),
            Phase::Cg { step, start, rho } => self.cg(step, start, rho),
            Phase::Correct => self.correct(tolerance),
            Phase::Search { length, halvings } => {
                return self.search(law, dome, tolerance, length, halvings);
            }
            Phase::Extend { length, energy, is_across } => {
                self.extend(law, dome, (length, energy), is_across);
            }
            Phase::Stiffen { row, question } => self.stiffen(law, dome, row, question),
            Phase::Stability { step, after } => return self.probe(law, step, after),
            Phase::TrueCg { step, start, rho } => {
                return self.true_cg(step, start, rho, tolerance);
            }
        }
        State::Working
    }

    /// Adds rows of cells to forces and Hessian; true when the last one is in.
    fn add_rows(&mut self, law: &SheetLaw, row: usize, stiffness: Stiffness) -> bool {
        let rows = self.sheet.nodes_per_side() - 1;
        if row == 0 {
            self.work_units += LINEARIZE_UNITS;
            self.forces.fill(DVec3::ZERO);
            self.hessian.clear();
            self.totals = Totals::default();
        }
        let end = (row + self.rows_per_piece()).min(rows);
        assemble::linearize_rows(
            &self.sheet,
            law,
            &self.x,
            row..end,
            stiffness,
            (&mut self.forces, &mut self.hessian),
            &mut self.totals,
        );
        end == rows
    }

    fn rows_per_piece(&self) -> usize {
        (CELLS_PER_PIECE / self.sheet.nodes_per_side()).max(1)
    }

    fn linearize(&mut self, law: &SheetLaw, dome: &Dome, row: usize) -> State {
        if self.iterations >= self.most_iterations || self.work_units > self.most_work {
            return State::Stalled;
        }
        if !self.add_rows(law, row, Stiffness::Positive) {
            self.phase = Phase::Linearize { row: row + self.rows_per_piece() };
            return State::Working;
        }
        self.iterations += 1;
        self.is_asked = false;
        self.outside = if self.totals.outside_law { self.outside + 1 } else { 0 };
        let runs_away = self.outside > 0 && self.runs_away(dome);
        if runs_away || self.outside > MAX_OUTSIDE || !self.totals.energy.is_finite() {
            return State::Unstable;
        }
        let touch = TOUCH * dome.base_radius;
        let mut is_saddle = false;
        for k in 0..self.free.len() {
            let k = self.free[k] as usize;
            let pressing = self.find_contact(dome, k, touch);
            if !self.is_cautious && pressing > 0.0 {
                self.hessian.diagonal[k] -= curvature(dome, self.x[k]) * pressing;
                is_saddle |= !is_positive(&self.hessian.diagonal[k]);
            }
            self.d[k] = DVec3::ZERO;
            self.inverse[k] = safe_inverse(self.hessian.diagonal[k]);
        }
        if !self.is_cautious {
            self.is_saddle = is_saddle;
            if is_saddle {
                self.take_care();
                return State::Working;
            }
        }
        self.relative_residual = self.residual(law);
        self.rounds = 0;
        self.is_built = false;
        self.phase = Phase::Smooth;
        State::Working
    }

    /// Has a node left the surroundings of pocket and dome?
    fn runs_away(&self, dome: &Dome) -> bool {
        let far = RUNS_AWAY * (self.sheet.radius_mm() + dome.apex().z);
        self.free.iter().any(|&k| self.x[k as usize].length_squared() > far * far)
    }

    /// Adds rows of cells to the true Hessian; after the last one, the contact. Then begins with the question.
    fn stiffen(&mut self, law: &SheetLaw, dome: &Dome, row: usize, question: Question) {
        if !self.add_rows(law, row, Stiffness::True) {
            self.phase = Phase::Stiffen { row: row + self.rows_per_piece(), question };
            return;
        }
        let touch = TOUCH * dome.base_radius;
        for k in 0..self.free.len() {
            let k = self.free[k] as usize;
            let pressing = self.find_contact(dome, k, touch);
            self.hessian.diagonal[k] -= curvature(dome, self.x[k]) * pressing;
            self.constrain(k);
        }
        match question {
            Question::IsStable(after) => self.begin_probe(after),
            Question::Step => self.begin_true_cg(),
        }
    }

    /// Sees whether dome and wall press the node k, which touches what is nearer than `touch` \[mm\];
    /// gives the dome's force per gradient of its level, zero where it does not press.
    fn find_contact(&mut self, dome: &Dome, k: usize, touch: f64) -> f64 {
        let gradient = dome.level_gradient(self.x[k]);
        let steepness = gradient.length();
        self.normal[k] = gradient / steepness;
        self.gap[k] = (dome.level(self.x[k]) - self.lift[k].abs()) / steepness;
        let (force, normal) = (self.forces[k], self.normal[k]);
        let mut pressing = -force.dot(normal);
        let (by_dome, by_wall) = (self.gap[k] <= touch, self.x[k].z <= touch);
        let mut is_on_dome = by_dome && pressing >= 0.0;
        let mut is_on_wall = by_wall && force.z <= 0.0;
        if by_dome
            && by_wall
            && let Some([dome, wall]) = contact::shares(force, normal)
        {
            (pressing, is_on_dome, is_on_wall) = (dome, dome >= 0.0, wall >= 0.0);
        }
        self.contact[k] =
            if is_on_dome { ON_DOME } else { FREE } | if is_on_wall { ON_WALL } else { FREE };
        if is_on_dome { pressing / steepness } else { 0.0 }
    }

    /// Norm of the forces that no contact takes, relative to the forces they are the sum of.
    fn residual(&self, law: &SheetLaw) -> f64 {
        let squares: f64 = self
            .free
            .iter()
            .map(|&k| {
                let k = k as usize;
                let movable = projector(self.contact[k], self.normal[k]);
                (movable * self.forces[k]).length_squared()
            })
            .sum();
        squares.sqrt() / self.force_scale(law)
    }

    /// What forces are measured against \[kPa·mm²\]. A sheet at rest has none: rounding is not measured
    /// against rounding.
    fn force_scale(&self, law: &SheetLaw) -> f64 {
        self.totals.force_scale().max(1e-9 * law.stiffness() * self.sheet.spacing_mm())
    }

    /// Two projected Gauss–Seidel sweeps on the model: they find which nodes press.
    fn smooth(&mut self) {
        self.changed = 0;
        let count = self.free.len();
        for k in 0..count {
            self.relax(self.free[k] as usize);
        }
        for k in (0..count).rev() {
            self.relax(self.free[k] as usize);
        }
        self.work_units += 2.0 * SWEEP_UNITS;
        for k in 0..count {
            self.constrain(self.free[k] as usize);
        }
        self.phase = if self.is_built { self.begin_cg() } else { Phase::Build { piece: 0 } };
    }

    /// Sets the directions in which the node k may move, and the inverse in them.
    fn constrain(&mut self, k: usize) {
        let (flags, normal, inverse) = (self.contact[k], self.normal[k], self.inverse[k]);
        self.projector[k] = projector(flags, normal);
        self.tangent_inverse[k] = match flags {
            FREE => inverse,
            ON_DOME => without(inverse, normal),
            ON_WALL => without(inverse, DVec3::Z),
            _ => {
                let t = edge_direction(normal);
                let stiffness = t.dot(self.hessian.diagonal[k] * t);
                outer(t, t) * if stiffness > 0.0 { 1.0 / stiffness } else { 0.0 }
            }
        };
    }

    /// Minimises the model over one node's step, under its constraints.
    #[inline]
    fn relax(&mut self, k: usize) {
        let rhs = self.forces[k] - self.hessian.off_diagonal(k, &self.d);
        let inverse = &self.inverse[k];
        let (normal, gap, height) = (self.normal[k], self.gap[k], self.x[k].z);
        let mut d = *inverse * rhs;
        let mut flags = FREE;
        if normal.dot(d) < -gap || d.z < -height {
            // One constraint at a time; both where neither is enough.
            let s = *inverse * normal;
            let on_dome = d + s * ((-gap - normal.dot(d)) / normal.dot(s));
            let t = inverse.z_axis;
            let on_wall = d + t * ((-height - d.z) / t.z);
            if normal.dot(d) < -gap && on_dome.z >= -height - 1e-12 {
                (d, flags) = (on_dome, ON_DOME);
            } else if d.z < -height && normal.dot(on_wall) >= -gap - 1e-12 {
                (d, flags) = (on_wall, ON_WALL);
            } else {
                let along = edge_direction(normal);
                let corner = corner_step(normal, gap, height);
                let block = &self.hessian.diagonal[k];
                let stiffness = along.dot(*block * along);
                let move_along = if stiffness > 0.0 {
                    along.dot(rhs - *block * corner) / stiffness
                } else {
                    0.0
                };
                (d, flags) = (corner + along * move_along, ON_DOME | ON_WALL);
            }
        }
        self.changed += usize::from(self.contact[k] != flags);
        self.contact[k] = flags;
        self.d[k] = d;
    }

    fn build(&mut self, piece: usize) {
        let finest = Finest {
            blocks: &self.hessian,
            inverse: &self.tangent_inverse,
            projector: &self.projector,
            free: &self.free,
        };
        if !self.hierarchy.build(&finest, piece) {
            self.phase = Phase::Build { piece: piece + 1 };
            return;
        }
        self.work_units += BUILD_UNITS;
        self.is_built = true;
        self.phase = self.begin_cg();
    }

    /// Ends a round: on to the next one, or to the search.
    fn correct(&mut self, tolerance: f64) {
        let (change, step) = self.add_correction();
        self.last_round = change;
        self.rounds += 1;
        let settled =
            change <= ROUND_SHARE * step && self.changed == 0 || change <= 0.02 * tolerance;
        self.phase = if settled || self.rounds >= MAX_ROUNDS {
            Phase::Search { length: 1.0, halvings: 0 }
        } else {
            Phase::Smooth
        };
    }

    /// Adds the correction `q` to the step, as far as no constraint is passed by much; gives the greatest
    /// change and step of a node \[mm\].
    fn add_correction(&mut self) -> (f64, f64) {
        let (mut largest, mut step) = (0.0_f64, 0.0_f64);
        for &k in &self.free {
            let k = k as usize;
            let mut d = self.d[k] + self.q[k];
            let short = -self.gap[k] - self.normal[k].dot(d);
            if short > 0.0 {
                d += self.normal[k] * short;
            }
            d.z = d.z.max(-self.x[k].z);
            largest = largest.max((d - self.d[k]).length_squared());
            step = step.max(d.length_squared());
            self.d[k] = d;
        }
        (largest.sqrt(), step.sqrt())
    }
}

/// Is a symmetric matrix positive definite?
fn is_positive(m: &DMat3) -> bool {
    let minor = m.x_axis.x * m.y_axis.y - m.x_axis.y * m.x_axis.y;
    m.x_axis.x > 0.0 && minor > 0.0 && m.determinant() > 0.0
}

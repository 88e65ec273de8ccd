//! Full multigrid by the full approximation scheme, in lanes of four f32.
//!
//! Grids are nested and each is fitted to the pocket's circle itself. The coarsest starts from a
//! shape made of geometry alone; every finer one from the interpolated shape of the grid before, and
//! is then improved by V-cycles. On the way down a coarse grid gets the residual of the finer one and
//! its own force at the injected shape as right-hand side (A. Brandt, "Multi-level adaptive solutions
//! to boundary-value problems", Math. Comp. 31, 1977), so that no matrix is ever put together: all
//! that is evaluated is the force. The finest grid decides which nodes the dome holds; coarser ones
//! keep them on it.
//!
//! `grid` (what is stored) | `law` | `force`, `border`, `springs` (the paper's) | `smooth` (with contact) | `transfer` |
//! `level` (one grid at work) | `shown` (the shape in mm); here the order in which grids work.

mod border;
mod force;
mod grid;
pub mod kernels;
mod law;
mod level;
mod shown;
mod smooth;
mod springs;
#[cfg(test)]
mod tests;
mod transfer;

use super::Problem;
use super::guess;
use super::law::SheetLaw;
use super::lift;
use crate::implant::Dome;
use crate::sheet::Sheet;
use grid::{Field, Mirrored};
use law::CoupledLanes;
use level::{LaneLaw, Level};
use smooth::{Contact, LaneDome};

/// Damped steps that take out the upper part of the spectrum of D⁻¹H: close to the inverse roots of a
/// Chebyshev polynomial, the longest step first.
const SMOOTHING: [f32; 2] = [1.6, 0.5];
/// In the first cycle of a grid, whose shape comes smooth from a coarser one, one is enough.
const FIRST_SMOOTHING: [f32; 1] = [0.9];
/// The same for the spectrum of the coarsest grid, and how often they are repeated there. Shorter than
/// the spectrum of a small lift asks for: over a steep dome it reaches farther.
const COARSEST: [f32; 4] = [2.9, 0.3, 0.82, 0.4];
const COARSEST_ROUNDS: usize = 3;

/// The most V-cycles of the finest grid.
const MAX_CYCLES: u32 = 16;
/// The greatest lift, in tolerances, that is left to f32: a node that touches or not changes the shape by
/// about as much.
const MOST_LIFT: f64 = 10.0;
/// Coarser grids are starts: the most cycles of each, and the error that is enough
/// \[share of the base radius\].
const START_CYCLES: u32 = 4;
const START_TOLERANCE: f64 = 3e-3;
/// Cycles of a grid before which its nodal blocks are computed anew.
const BLOCK_CYCLES: u32 = 2;
/// The most rounds over the coarsest grid.
const MAX_COARSEST: u32 = 60;
/// The least share of the error that a cycle is taken to leave: the first ones take out what is rough
/// and promise more than the next will keep.
const LEAST_RATE: f64 = 0.4;
/// Rates grow a little from cycle to cycle: the estimate allows for this much.
const SAFETY: f64 = 1.5;
/// A cycle that changes more than this share of what the last one did is slow.
const SLOW_RATE: f64 = 0.7;
/// Slow cycles on the finest grid, one after the other, that end the scheme.
const MAX_SLOW: u32 = 3;
/// A cycle that takes back more than this share of the last one's change swings.
const SWING: f64 = -0.25;
/// Bounds of the relative residual that a solution may have, between them the tolerance: smooth errors
/// leave about as much, on a flat dome somewhat less. Up to the greater bound it may be what f32 rounds.
const MOST_RESIDUAL: (f64, f64) = (3e-4, 5e-3);
/// The least error \[share of the base radius\] that a relative residual tells of.
const RESIDUAL_SHARE: f64 = 0.05;
/// How often the scheme may come to rest above it with more than this share of the residual before.
const MAX_DOUBTS: u32 = 2;
const DOUBT_RATE: f64 = 0.7;
/// A coarse node is held on the dome if the fine nodes around it are, by this share of their weight.
/// The lesser share holds more: slower, but it does not lift the sheet off a small contact. It is
/// taken after a slow cycle.
const HOLD_SHARES: [f32; 2] = [0.45, 0.15];
/// A node whose level is below this is on the dome, up to rounding \[-\].
const TOUCH: f64 = 3e-6;
/// The least tolerance that f32 can promise \[share of the base radius\].
pub(super) const LEAST_TOLERANCE: f64 = 2e-6;

/// How the scheme stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum State {
    Working,
    /// The draft tolerance is met for the first time; there is more to do.
    Draft,
    Converged,
    /// A cycle does not lead to the solution: another method has to take over.
    Failed,
}

/// What becomes of the lifts of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Lifts {
    /// They do not matter to the tolerance.
    LeftOut,
    Taken,
    /// Which nodes touch is not clear yet.
    Unclear,
}

/// What is done next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Task {
    /// The given part of the way down from this grid.
    Down(usize, usize),
    /// The given part of the way up to this grid.
    Up(usize, usize),
    /// The cycle of the grid being solved has ended.
    Judge,
}

/// The scheme for one problem after the other.
#[derive(Clone, Debug)]
pub(super) struct FullMultigrid {
    /// From the coarsest to the finest.
    levels: Vec<Level>,
    law: LaneLaw,
    base_radius: f64,
    /// Of the finest grid \[mm\].
    spacing: f64,
    tolerance: f64,
    /// Cycles of the finest grid, where they are given.
    asked_cycles: Option<u32>,
    /// An error at which the shape is worth to be shown \[share of the base radius\].
    draft_tolerance: Option<f64>,
    /// The grid being solved.
    current: usize,
    task: Task,
    /// Cycles of the grid being solved.
    cycles: u32,
    slow_cycles: u32,
    /// How often it came to rest without a balance of forces, and the residual at the last of these times.
    doubts: u32,
    doubted_residual: f64,
    /// Have the lifts of the finest grid been found?
    is_lifted: bool,
    /// Error of leaving them out \[mm\].
    missed: f64,
    /// Sum of squares of the residual, where it was found with the lifts.
    residual_squares: Option<f64>,
    last_change: f64,
    /// What the last cycle of the finest grid changed, where it was left as it was.
    last_step: Field,
    has_last_step: bool,
    /// Slower, but sure where contact is small or the sheet nearly slack.
    is_wary: bool,
    /// Does the sheet push somewhere? There it may lie nearly still for some cycles on its way to a fold.
    pub(super) is_slack: bool,
    /// Do lifts matter so much that f64 has to tell which nodes touch?
    pub(super) leaves_lifts: bool,
    row: Vec<f32>,
    /// Estimated greatest node position error \[mm\].
    pub(super) error: f64,
    /// Forces that no contact takes, relative to those they are the sum of \[-\].
    pub(super) relative_residual: f64,
    pub(super) work_units: f64,
}

impl FullMultigrid {
    /// Room for grids of up to `nodes_per_side` nodes a side.
    pub(super) fn new(nodes_per_side: usize, mirrored: Mirrored) -> Self {
        let mut sides = vec![nodes_per_side];
        let mut cells = nodes_per_side - 1;
        while cells >= 16 && cells.is_multiple_of(4) {
            cells /= 2;
            sides.push(cells + 1);
        }
        let levels: Vec<Level> =
            sides.iter().rev().map(|&n| Level::new(n, mirrored, n == nodes_per_side)).collect();
        Self {
            law: LaneLaw::Coupled(CoupledLanes::default()),
            base_radius: 1.0,
            spacing: 1.0,
            tolerance: 0.0,
            asked_cycles: None,
            draft_tolerance: None,
            current: 0,
            task: Task::Judge,
            cycles: 0,
            slow_cycles: 0,
            doubts: 0,
            doubted_residual: f64::INFINITY,
            is_lifted: false,
            missed: 0.0,
            residual_squares: None,
            last_change: f64::INFINITY,
            last_step: Field::new(levels[sides.len() - 1].layout.len()),
            has_last_step: false,
            is_wary: false,
            is_slack: false,
            leaves_lifts: false,
            row: vec![0.0; nodes_per_side + 8],
            error: f64::INFINITY,
            relative_residual: f64::INFINITY,
            work_units: 0.0,
            levels,
        }
    }

    /// Does it fit a grid of this size?
    pub(super) fn fits(&self, nodes_per_side: usize, mirrored: Mirrored) -> bool {
        let layout = &self.levels[self.levels.len() - 1].layout;
        layout.nodes_per_side == nodes_per_side && layout.mirrored == mirrored
    }

    /// Cycles of the finest grid so far.
    pub(super) fn finest_cycles(&self) -> u32 {
        if self.current + 1 == self.levels.len() { self.cycles } else { 0 }
    }

    /// Free nodes of the finest grid that are solved for.
    pub(super) fn nodes(&self) -> usize {
        self.levels[self.levels.len() - 1].layout.free_nodes()
    }

    /// Lanes that a pass over the finest grid computes: whole groups of four, row by row.
    pub(super) fn lanes(&self) -> usize {
        self.levels[self.levels.len() - 1].layout.lanes()
    }

    /// Reads the law's tables; needed once for every law.
    pub(super) fn set_law(&mut self, law: &SheetLaw) {
        self.law = LaneLaw::new(law);
    }

    /// Begins anew on the coarsest grid. `tolerance` is relative to the base radius.
    pub(super) fn start(
        &mut self,
        problem: &Problem,
        cycles: Option<u32>,
        draft_tolerance: Option<f64>,
    ) {
        self.asked_cycles = cycles;
        self.draft_tolerance = draft_tolerance;
        let dome = &problem.dome;
        self.base_radius = dome.base_radius;
        self.spacing = problem.sheet.spacing_mm();
        self.tolerance = problem.tolerance.max(LEAST_TOLERANCE);
        let finest = self.levels.len() - 1;
        for (l, level) in self.levels.iter_mut().enumerate() {
            let per_spacing = 1.0 / (self.spacing * f64::from(1 << (finest - l)));
            level.exact_dome = Dome {
                center: dome.center * per_spacing,
                base_radius: dome.base_radius * per_spacing,
                projection: dome.projection * per_spacing,
                base_height: dome.base_height * per_spacing,
            };
            level.dome = LaneDome::new(&level.exact_dome);
        }
        let coarsest = &mut self.levels[0];
        let layout = &coarsest.layout;
        let n = layout.nodes_per_side;
        let sheet = Sheet::new(n, problem.sheet.radius_mm());
        let guess = guess::tight_string(&sheet, dome);
        let per_spacing = 1.0 / sheet.spacing_mm();
        let first = layout.first();
        layout.free_rows(|j, from, to| {
            for i in from..to {
                let k = (j + first[1]) * n + i + first[0];
                let u = (guess[k] - sheet.rest()[k].extend(0.0)) * per_spacing;
                let to = j * layout.pitch + i;
                coarsest.u.x[to] = u.x as f32;
                coarsest.u.y[to] = u.y as f32;
                coarsest.u.z[to] = u.z as f32;
            }
        });
        smooth::mirror(layout, &mut coarsest.u);
        self.work_units = 0.0;
        self.is_wary = false;
        self.begin_grid(0);
    }

    fn begin_grid(&mut self, l: usize) {
        self.current = l;
        self.cycles = 0;
        self.slow_cycles = 0;
        self.doubts = 0;
        self.doubted_residual = f64::INFINITY;
        self.is_slack = false;
        self.leaves_lifts = false;
        self.is_lifted = false;
        self.missed = 0.0;
        self.residual_squares = None;
        self.last_change = f64::INFINITY;
        self.has_last_step = false;
        self.error = f64::INFINITY;
        self.levels[l].lift.fill(0.0);
        self.task = Task::Down(l, 0);
    }

    /// Does the next piece of work: a few evaluations of the forces of one grid at most.
    pub(super) fn step(&mut self) -> State {
        match self.task {
            Task::Down(0, _) => {
                self.solve_coarsest();
                self.task = if self.current == 0 { Task::Judge } else { Task::Up(1, 0) };
            }
            Task::Down(l, part) => self.go_down(l, part),
            Task::Up(l, part) => self.go_up(l, part),
            Task::Judge => return self.judge(),
        }
        State::Working
    }

    fn contact(&self, l: usize) -> Contact {
        if l == self.current { Contact::OneSided } else { Contact::Held }
    }

    fn smoothing(&self, l: usize) -> &'static [f32] {
        if l == self.current && self.cycles == 0 { &FIRST_SMOOTHING } else { &SMOOTHING }
    }

    fn count(&mut self, l: usize, evaluations: f64) {
        let coarser = (self.levels.len() - 1 - l) as i32;
        self.work_units += evaluations * 0.25_f64.powi(coarser);
    }

    fn solve_coarsest(&mut self) {
        let contact = self.contact(0);
        let level = &mut self.levels[0];
        if self.current == 0 {
            level.before.copy_from(&level.u);
        }
        if self.current == 0 || self.is_wary {
            level.invert_blocks(&self.law);
        }
        for round in 0..COARSEST_ROUNDS {
            for (part, omega) in COARSEST.into_iter().enumerate() {
                if self.current == 0 || (round, part) != (0, 0) {
                    level.forces(&self.law);
                }
                level.step(contact, omega);
            }
        }
        self.count(0, (COARSEST_ROUNDS * COARSEST.len()) as f64);
    }

    /// Smooths, then hands the residual to the next coarser grid.
    fn go_down(&mut self, l: usize, part: usize) {
        let (contact, smoothing) = (self.contact(l), self.smoothing(l));
        let (coarser, finer) = self.levels.split_at_mut(l);
        let (coarse, level) = (&mut coarser[l - 1], &mut finer[0]);
        if part == 0 {
            if l == self.current {
                level.before.copy_from(&level.u);
            }
            // A grid keeps its blocks for all cycles but its own first ones.
            if l == self.current && self.cycles < BLOCK_CYCLES || self.is_wary {
                level.invert_blocks(&self.law);
                self.count(l, 1.0);
            }
        } else if part <= smoothing.len() {
            // A coarse grid has just had its forces found, for its right-hand side.
            let is_known = part == 1 && l != self.current;
            if !is_known {
                level.forces(&self.law);
            }
            level.step(contact, smoothing[part - 1]);
            self.count(l, f64::from(u8::from(!is_known)));
        } else {
            level.find_residual(&self.law, contact);
            coarse.take_over(&self.law, level, HOLD_SHARES[usize::from(self.is_wary)]);
            self.task = Task::Down(l - 1, 0);
            self.count(l, 1.25);
            return;
        }
        self.task = Task::Down(l, part + 1);
    }

    /// Takes the correction of the next coarser grid, then smooths.
    fn go_up(&mut self, l: usize, part: usize) {
        let (contact, smoothing) = (self.contact(l), self.smoothing(l));
        let (coarser, finer) = self.levels.split_at_mut(l);
        let (coarse, level) = (&coarser[l - 1], &mut finer[0]);
        if part == 0 {
            level.add_correction(coarse, &mut self.row);
        }
        level.forces(&self.law);
        level.step(contact, smoothing[part]);
        self.count(l, 1.0);
        self.task = if part + 1 < smoothing.len() {
            Task::Up(l, part + 1)
        } else if l == self.current {
            Task::Judge
        } else {
            Task::Up(l + 1, 0)
        };
    }

    /// Estimates the error from how much the cycle has changed, and chooses what follows.
    fn judge(&mut self) -> State {
        let (l, finest) = (self.current, self.levels.len() - 1);
        let level = &self.levels[l];
        let spacing = self.spacing * f64::from(1 << (finest - l));
        let change = spacing
            * f64::from(smooth::greatest_difference(&level.layout, &level.u, &level.before));
        self.cycles += 1;
        if !change.is_finite() {
            return State::Failed;
        }
        let mut rate = LEAST_RATE;
        if self.last_change.is_finite() {
            rate = (change / self.last_change.max(f64::MIN_POSITIVE)).clamp(LEAST_RATE, 0.95);
            if change > SLOW_RATE * self.last_change {
                self.slow_cycles += 1;
                self.is_wary |= l > 0 && change > START_TOLERANCE * self.base_radius;
            } else {
                self.slow_cycles = 0;
            }
        }
        self.last_change = change;
        self.error = SAFETY * change * rate / (1.0 - rate);
        if l < finest {
            let is_start = self.error <= START_TOLERANCE * self.base_radius;
            let most = if l == 0 { MAX_COARSEST } else { START_CYCLES };
            if l == 0 && self.cycles >= most && !is_start {
                // What is slow even there, cycles will not find: tissue that slides on a steep dome.
                return State::Failed;
            }
            if is_start || self.cycles >= most {
                self.refine();
            } else {
                self.task = Task::Down(l, 0);
            }
            return State::Working;
        }
        let is_enough = match self.asked_cycles {
            Some(cycles) => self.cycles >= cycles,
            None => self.has_room(),
        };
        // Where contact ends between nodes matters once the nodes are in place.
        let is_settled = match self.asked_cycles {
            Some(cycles) => cycles > 1 && 2 * self.cycles >= cycles,
            None => is_enough,
        };
        let mut is_clear = true;
        if is_settled && !self.is_lifted && self.law.has_lifts() {
            let found = self.find_lifts();
            is_clear = found != Lifts::Unclear;
            self.is_lifted = is_clear;
            if found == Lifts::Taken {
                self.last_change = f64::INFINITY;
                self.has_last_step = false;
                self.slow_cycles = 0;
                self.task = Task::Down(l, 0);
                return State::Working;
            }
        }
        if is_clear && is_enough && (self.asked_cycles.is_some() || self.has_room()) {
            self.find_relative_residual();
            let left = RESIDUAL_SHARE * self.relative_residual * self.base_radius;
            self.error = self.error.max(left) + self.missed;
            let (least, most) = MOST_RESIDUAL;
            let is_balanced = self.error <= self.tolerance * self.base_radius
                && (self.relative_residual <= self.tolerance.clamp(least, most)
                    || self.relative_residual <= most && self.levels[l].is_rounded());
            if is_balanced || self.asked_cycles.is_some() {
                return State::Converged;
            }
            // It stopped changing, but not in balance.
            let is_stuck = self.relative_residual > DOUBT_RATE * self.doubted_residual;
            self.doubts += u32::from(!is_balanced && is_stuck);
            self.doubted_residual = self.relative_residual;
            if self.doubts >= MAX_DOUBTS {
                return State::Failed;
            }
        }
        self.residual_squares = None;
        if self.asked_cycles.is_none()
            && (self.cycles >= MAX_CYCLES || self.slow_cycles >= MAX_SLOW)
        {
            return State::Failed;
        }
        self.accelerate();
        self.task = Task::Down(l, 0);
        if self.draft_tolerance.is_some_and(|draft| self.error <= draft * self.base_radius) {
            self.draft_tolerance = None;
            return State::Draft;
        }
        State::Working
    }

    /// Takes out of the last change what the one before says it will take back: coarse grids are a
    /// little too soft where contact ends, so that the sheet there swings about its place (A. C. Aitken,
    /// Proc. Roy. Soc. Edinburgh 46, 1926, for one vector).
    fn accelerate(&mut self) {
        let level = &mut self.levels[self.current];
        let (product, square) =
            smooth::products_of_steps(&level.layout, &level.u, &level.before, &self.last_step);
        let rho = if self.has_last_step && square > 0.0 { product / square } else { 0.0 };
        self.has_last_step = rho > SWING;
        if self.has_last_step {
            smooth::difference(&level.u, &level.before, &mut self.last_step);
        } else {
            let share = (rho / (rho - 1.0)) as f32;
            smooth::blend(&level.before, share, &mut level.u);
            smooth::settle(&level.layout, &level.dome, &mut level.u);
            self.last_change = f64::INFINITY;
            self.slow_cycles = 0;
        }
    }

    /// Finds where contact ends between nodes of the grid being solved, and takes the lifts if they change
    /// its equilibrium by what matters.
    fn find_lifts(&mut self) -> Lifts {
        let l = self.current;
        let spacing = self.spacing * f64::from(1 << (self.levels.len() - 1 - l));
        let level = &mut self.levels[l];
        let squares = level.find_residual(&self.law, Contact::OneSided);
        let greatest = level.find_lifts() * spacing / self.base_radius;
        self.missed = lift::missed(greatest) * self.base_radius;
        // A cycle more is not due for what the tolerance has room for.
        let is_study = self.asked_cycles.is_some();
        let mut share =
            if self.has_room() && !is_study { 0.0 } else { lift::share(greatest, self.tolerance) };
        self.leaves_lifts = !is_study && share * greatest > MOST_LIFT * self.tolerance;
        if self.leaves_lifts {
            (share, self.missed) = (0.0, 0.0);
        }
        self.count(l, 1.0);
        if share <= 0.0 {
            self.levels[l].lift.fill(0.0);
            self.residual_squares = Some(squares);
            return Lifts::LeftOut;
        }
        self.missed = 0.0;
        let is_clear = is_study
            || lift::is_clear(self.error / self.base_radius, greatest)
            || self.slow_cycles > 0;
        if !is_clear {
            self.levels[l].lift.fill(0.0);
            return Lifts::Unclear;
        }
        self.levels[l].lift.iter_mut().for_each(|lift| *lift *= share as f32);
        Lifts::Taken
    }

    /// Has the tolerance room for the error, and for that of leaving lifts out?
    fn has_room(&self) -> bool {
        self.error + self.missed <= self.tolerance * self.base_radius
    }

    /// Finds it, and whether the sheet is slack.
    fn find_relative_residual(&mut self) {
        let l = self.current;
        let level = &mut self.levels[l];
        // The search for lifts has it, if it found none.
        let known = self.residual_squares.take();
        let squares = known.unwrap_or_else(|| level.find_residual(&self.law, Contact::OneSided));
        let tension = level.tension(&self.law);
        // A sheet at rest has no forces: rounding is not measured against rounding.
        self.relative_residual = (squares / tension.squares.max(1e-18)).sqrt();
        self.is_slack = tension.is_slack(level.layout.free_nodes());
        self.count(l, if known.is_some() { 0.5 } else { 1.5 });
    }

    /// Goes on to the next finer grid.
    fn refine(&mut self) {
        self.raise(self.current);
        self.begin_grid(self.current + 1);
    }

    /// Interpolates the shape of a grid to the next finer one.
    fn raise(&mut self, l: usize) {
        let (coarser, finer) = self.levels.split_at_mut(l + 1);
        let (coarse, fine) = (&mut coarser[l], &mut finer[0]);
        let Level { layout, u, f, .. } = coarse;
        transfer::refine(layout, &fine.layout, u, f, &mut fine.u, &mut self.row);
        smooth::settle(&fine.layout, &fine.dome, &mut fine.u);
    }
}

//! Growth of the skin under the implant: solves one after the other, each from the last shape with the rest metric that its stretch asks for.
//!
//! With C the metric of a triangle against the body at rest and φ the growth, the triangle without stress becomes Γ = C^(φ/2) times as
//! large: of the net stretch the part C^((1−φ)/2) stays elastic, above the natural stretch. At φ = 1 the skin has its natural tension
//! everywhere. The solution is the fixed point, the growth that its own stretch asks for. Stiff skin on soft tissue slides towards it
//! slowly: growths are mixed (Anderson acceleration), and solves are rough at first.

use super::fas::Stop;
use super::initial_guess::taut_profile;
use super::newton::Start;
use super::seal::Pull;
use super::{Problem, Solver, Stage, Verdict};
use crate::mesh::{Grown, Rest};
use crate::model::membrane::triangle::{Principal, Rest as RestTriangle};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// Bounds of the greatest change of Γ that another solve asks for at the end \[-\], which is the tolerance of positions between the bounds: a
/// change of Γ is one of positions by 0.2 to 0.7 of it \[base radius\]. The upper one makes the tension of the opening plan's skin at φ = 1 even to
/// 1 %, the lower one is above the rounding of Γ.
const TOLERANCE: (f64, f64) = (2e-6, 3e-4);

/// Change of Γ above which the next solve is rough \[-\].
const ROUGH: f64 = 2e-3;

/// Cycles of the finest grid of a rough solve: at first, and at most.
const ROUGH_CYCLES: (u32, u32) = (2, 8);

/// Part of the least change of Γ so far above which a solve has brought nothing: what the rough solve left is mixed with the growth.
const STALLED: f64 = 0.85;

/// Solves after the first one at most, and the change of Γ up to which the last one is accepted \[tolerance of Γ\].
const MOST_SOLVES: (u32, f64) = (48, 3.3);

/// Solves whose growths are mixed.
const DEPTH: usize = 4;

/// Regularisation of the mixing \[-\].
const LEAST_PART: f64 = 1e-6;

/// Least stretch that counts \[-\]: of a triangle in a fold.
const LEAST_STRETCH: f64 = 0.3;

/// Growths of one problem, as numbers of all triangles.
#[derive(Debug, Default)]
pub(super) struct Growths {
    /// Number of solves so far.
    solves: u32,
    /// Has a solve started from a guess of the growth?
    is_guessed: bool,
    /// Was the last solve rough?
    is_rough: bool,
    /// Doublings of the cycles of a rough solve.
    doubled: u32,
    /// The least change of Γ so far; `None` before the first solve.
    least: Option<f64>,
    /// Γ that the last solve asked for, and its difference from the Γ of that solve.
    last: Option<[Vec<f32>; 2]>,
    /// Changes of both from solve to solve, the last one first.
    changes: Vec<[Vec<f32>; 2]>,
}

impl Growths {
    /// The next Γ after one whose solution asks for another one: g − Σ θ_i Δg_i with the least square of r − Σ θ_i Δr_i, g being what is
    /// asked for and r its difference from the present one.
    fn mixed(&mut self, present: &[f32], asked: Vec<f32>) -> Vec<f32> {
        let residual = difference(&asked, present);
        if let Some([before, residual_before]) = self.last.take() {
            self.changes.truncate(DEPTH - 1);
            let change = [difference(&asked, &before), difference(&residual, &residual_before)];
            self.changes.insert(0, change);
        }
        let mut next = asked.clone();
        for (theta, [change, _]) in self.least_squares(&residual).iter().zip(&self.changes) {
            next.iter_mut().zip(change).for_each(|(next, g)| *next -= *theta as f32 * g);
        }
        self.last = Some([asked, residual]);
        next
    }

    /// Cycles of the next rough solve; `None` for one to the tolerance.
    fn rough_cycles(&mut self, change: f64) -> Option<u32> {
        let least = self.least.unwrap_or(f64::INFINITY);
        let cycles = ROUGH_CYCLES.0 << self.doubled;
        if cycles > ROUGH_CYCLES.1 {
            return None;
        }
        self.least = Some(least.min(change));
        if change > STALLED * least {
            self.doubled += 1;
            (self.last, self.changes) = (None, Vec::new());
        }
        let cycles = ROUGH_CYCLES.0 << self.doubled;
        (cycles <= ROUGH_CYCLES.1).then_some(cycles)
    }

    /// The factors θ, by the normal equations.
    fn least_squares(&self, residual: &[f32]) -> [f64; DEPTH] {
        let count = self.changes.len();
        let mut rows = [[0.0; DEPTH + 1]; DEPTH];
        for (i, [_, one]) in self.changes.iter().enumerate() {
            for (j, [_, other]) in self.changes.iter().enumerate() {
                rows[i][j] = product(one, other);
            }
            rows[i][i] *= 1.0 + LEAST_PART;
            rows[i][DEPTH] = product(one, residual);
        }
        let mut theta = [0.0; DEPTH];
        for k in 0..count {
            for i in k + 1..count {
                let part = rows[i][k] / rows[k][k];
                let above = rows[k];
                rows[i].iter_mut().zip(above).for_each(|(value, above)| *value -= part * above);
            }
        }
        for k in (0..count).rev() {
            let known: f64 = (k + 1..count).map(|j| rows[k][j] * theta[j]).sum();
            theta[k] = (rows[k][DEPTH] - known) / rows[k][k];
        }
        if theta.iter().all(|theta| theta.is_finite()) { theta } else { [0.0; DEPTH] }
    }
}

fn difference(a: &[f32], b: &[f32]) -> Vec<f32> {
    a.iter().zip(b).map(|(a, b)| a - b).collect()
}

fn product(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(a, b)| f64::from(*a) * f64::from(*b)).sum()
}

impl Solver {
    /// After the first attempt failed with skin that has not grown: starts with the growth that a taut profile asks for, since tight skin may have a shape
    /// only once it has grown. The failure of that attempt takes its growth back; false then, and of skin that does not grow.
    pub(super) fn starts_grown(&mut self) -> bool {
        if self.problem.rest.growth() <= 0.0 || self.outer.is_empty() || self.growths.solves > 0 {
            return false;
        }
        let starts = !std::mem::replace(&mut self.growths.is_guessed, true);
        if !starts && self.problem.rest.grown().is_none() {
            return false;
        }
        self.unseal();
        let grown = starts.then(|| guessed(&self.problem));
        let problem = Arc::make_mut(&mut self.problem);
        problem.rest = problem.rest.clone().with_grown(grown);
        let stop = self.stop();
        if let Some(multigrid) = &mut self.multigrid {
            multigrid.set_model(&self.problem, &self.law);
            if starts {
                multigrid.start_attempt(&self.problem, stop, 1);
            }
        }
        self.attempts += u32::from(starts);
        starts
    }

    /// Ends a solve that has converged, unless the skin is to grow by it.
    pub(super) fn grow_or_end(&mut self) {
        let rest = &self.problem.rest;
        let asked = match self.outer.last() {
            Some(skin) if rest.growth() > 0.0 => asked(rest, skin),
            _ => return self.seal_or_end(Verdict::Converged),
        };
        let change = asked.greatest_difference(rest.grown());
        let is_rough = self.growths.is_rough || self.seal.is_rough;
        let pull = self.pull_beside_growth(is_rough);
        if matches!(pull, Pull::Unknown) {
            return self.seal_or_end(Verdict::Converged);
        }
        let is_sealed = matches!(pull, Pull::Enough);
        let (most, accepted) = MOST_SOLVES;
        let is_last = self.growths.solves >= most;
        let (least_tolerance, most_tolerance) = TOLERANCE;
        let tolerance = self.problem.tolerance.clamp(least_tolerance, most_tolerance);
        let is_enough = change < tolerance && !is_rough && is_sealed;
        if is_enough || is_last {
            self.growths = Growths::default();
            self.left = change;
            let accepted = (accepted * tolerance).min(self.problem.tolerance);
            let is_converged = is_enough || change < accepted && is_sealed;
            let verdict = if is_converged { Verdict::Converged } else { Verdict::NotConverged };
            return self.end_sealed(verdict);
        }
        let rest = &self.problem.rest;
        let cells = rest.sheet().nodes_per_side() - 1;
        let present = rest.grown().map_or_else(|| Grown::none(cells), Clone::clone);
        let grown = self.growths.mixed(&present.numbers(), asked.numbers());
        let problem = Arc::make_mut(&mut self.problem);
        problem.rest = problem.rest.clone().with_grown(Grown::of_numbers(cells, &grown));
        self.growths.solves += 1;
        let may_be_rough = change > ROUGH && self.growths.solves < most;
        let cycles = self.growths.rough_cycles(change).filter(|_| may_be_rough);
        self.growths.is_rough = self.solve_again(cycles);
        self.seal.is_rough = false;
    }

    /// Solves a changed problem from the last shape; of multigrid for so many cycles of the finest grid, if any. Is that solve rough?
    pub(super) fn solve_again(&mut self, rough_cycles: Option<u32>) -> bool {
        self.is_multigrid_law_stale = true;
        let stop = rough_cycles.map_or_else(|| self.stop(), Stop::Cycles);
        match (self.stage, &mut self.multigrid) {
            (Stage::Multigrid, Some(multigrid)) => {
                multigrid.grow(&self.problem, &self.law, stop);
                rough_cycles.is_some()
            }
            _ => {
                self.newton_work_before_growth += self.newton_work();
                self.newton = None;
                self.start_newton(Start::FromSolution);
                false
            }
        }
    }
}

/// The growth that the taut profile over the implant asks for.
fn guessed(problem: &Problem) -> Grown {
    let rest = &problem.rest;
    let inner = taut_profile(rest, &problem.obstacle.dome);
    let at_rest = rest.nodes(0).zip(rest.nodes(rest.layers() - 1));
    let skin: Vec<DVec3> =
        inner.into_iter().zip(at_rest).map(|(x, (from, to))| x + to - from).collect();
    asked(rest, &skin)
}

/// The growth that the stretch of a skin with its nodes at `x` \[mm\], shape (nodes_per_side², ), asks for.
fn asked(rest: &Rest, x: &[DVec3]) -> Grown {
    let (sheet, skin) = (rest.sheet(), rest.outermost());
    let cells = sheet.nodes_per_side() - 1;
    let mut grown = Grown::none(cells);
    grown.set(sheet, |nodes| {
        let triangle = RestTriangle::new(skin, nodes, 1.0);
        power(Principal::columns(&triangle, nodes.map(|k| x[k])), rest.growth())
    });
    grown
}

/// U^φ of the stretch tensor U of a deformation gradient's columns: xx, xy, yy.
fn power(columns: [DVec3; 2], growth: f64) -> [f32; 3] {
    let principal = Principal::new(columns);
    let [one, two] = principal.stretch.map(|stretch| stretch.max(LEAST_STRETCH).powf(growth));
    let DVec2 { x, y } = principal.rest[0];
    [one * x * x + two * y * y, (one - two) * x * y, one * y * y + two * x * x].map(|v| v as f32)
}

#[cfg(test)]
mod tests;

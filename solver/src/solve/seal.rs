//! The suction of a void that is limited: solves one after the other, each from the last shape with the suction p that its void asks for.
//!
//! Fluid that neither flows in nor stretches holds the void V at its greatest volume, by a pressure p below that around the tissue: the minimum of
//! E + p (V − V_f), p ≥ 0, V ≤ V_f, p (V − V_f) = 0. V falls with p, and √V is convex and nearly linear in p: a secant there finds p from below.
//! Solves are rough at first.

use super::multigrid::Multigrid;
use super::{Displayed, Solver, Stage, Verdict, Void};
use crate::contact::{Modes, SoftHalfBall};
use crate::mesh::lanes::Mirrored;
use crate::mesh::part::Part;
use glam::DVec3;
use std::sync::Arc;

/// Greatest difference of the void from its greatest volume at the end \[greatest volume; mm³\]; less where positions would move by more
/// than their tolerance.
const TOLERANCE: (f64, f64) = (3e-3, 20.0);
/// The same of a void without a suction \[tolerance\].
const SLACK: f64 = 0.02;
/// The same beside growth, whose own tolerance moves the void \[tolerance\].
const BESIDE_GROWTH: f64 = 3.0;
/// Difference above which the next solve is rough \[tolerance\].
const ROUGH: f64 = 8.0;
/// Cycles of the finest grid of a rough solve.
const ROUGH_CYCLES: u32 = 3;
/// Solves with a suction that may be rough.
const MOST_ROUGH: u32 = 12;
/// Greatest suction \[kPa\]: the void that is left under it is the corner at the implant's rim.
const MOST_KPA: f64 = 20.0;
/// The first suction \[kPa\], and the greatest factor from one to the next \[-\].
const FIRST_KPA: f64 = 0.2;
const MOST_FACTOR: f64 = 3.0;
/// The same after a suction without a solution \[-\].
const CAREFUL_FACTOR: f64 = 1.5;
/// Least and greatest ratio of slopes across a growth of the skin, which moves the void, too \[-\].
const SLOPES: [f64; 2] = [0.4, 2.0];
/// Least step between suctions that a slope across a growth of the skin is learnt from, after a solve to the tolerance and after a rough one
/// \[suction\]: growth moves the void by more than a shorter step does.
const LEAST_STEP: [f64; 2] = [0.015, 0.1];
/// The greatest suction beside one without a solution \[that suction\]: skin that has grown since bears less.
const MOST_LEFT: f64 = 0.9;
/// Way to a suction without a solution that is not worth a solve \[that suction\].
const NEAR_FAILED: f64 = 0.02;
/// Solves with a suction at most, and halvings of the way to a suction without a solution.
const MOST_SOLVES: u32 = 24;
const MOST_HALVINGS: u32 = 3;

impl Void {
    /// Is the suction the greatest one?
    pub(crate) fn has_greatest_suction(self) -> bool {
        is_greatest(self.suction_kpa)
    }
}

fn is_greatest(suction_kpa: f64) -> bool {
    suction_kpa >= MOST_KPA
}

/// The search for a suction.
#[derive(Default)]
pub(super) struct Seal {
    solves: u32,
    halvings: u32,
    /// Was the last solve rough?
    pub(super) is_rough: bool,
    /// Suction and √V of the last solve, and the slope of the last two.
    last: Option<[f64; 2]>,
    slope: Option<f64>,
    /// The least suction without a solution.
    failed: Option<f64>,
    /// The last solution to the tolerance.
    kept: Option<Kept>,
    /// The last rough one since.
    rough: Option<Kept>,
    /// Is the suction the greatest one with a solution?
    is_greatest: bool,
}

/// The void of a solution, and its limit \[mm³\].
#[derive(Clone, Copy)]
struct Held {
    suction_kpa: f64,
    volume: f64,
    most: f64,
    tolerance: f64,
}

impl Held {
    fn off(self) -> f64 {
        (self.volume - self.most).abs()
    }

    fn is_enough(self) -> bool {
        if self.suction_kpa <= 0.0 {
            return self.volume <= self.most + SLACK * self.tolerance;
        }
        self.off() <= self.tolerance || self.is_at_most()
    }

    /// Is the void above its limit under the greatest suction?
    fn is_at_most(self) -> bool {
        is_greatest(self.suction_kpa) && self.volume > self.most
    }

    /// √V, of a negative volume −√−V.
    fn root(self) -> f64 {
        self.volume.abs().sqrt().copysign(self.volume)
    }
}

/// What a solve beside the growth of the skin needs.
pub(super) enum Pull {
    /// The void is at its limit, or there is none.
    Enough,
    /// The suction is a step nearer to that of the limit.
    Nearer,
    /// Nothing is known of the slope.
    Unknown,
}

/// A solution with its suction.
struct Kept {
    suction_kpa: f64,
    volume: f64,
    multigrid: Option<Multigrid>,
    x: Vec<DVec3>,
    outer: Vec<Vec<DVec3>>,
    mirrored: Mirrored,
    modes: Option<Modes<f64>>,
}

impl Seal {
    /// Learns the slope from a suction with a void and the one before, which are this far apart at least \[suction\].
    fn learn(&mut self, held: Held, least_step: f64) {
        let (suction, root) = (held.suction_kpa, held.root());
        if let Some([before, root_before]) = self.last.replace([suction, root]) {
            let step = suction - before;
            let slope = (root - root_before) / step;
            // A solve under the same suction, to the tolerance, has no slope.
            let is_slope = slope < 0.0 && slope.is_finite() && step.abs() >= least_step * suction;
            self.slope = Some(slope).filter(|_| is_slope).or(self.slope);
        }
    }

    /// The next suction after one with a void, by the slope that is known.
    fn next(&self, held: Held) -> f64 {
        let suction = held.suction_kpa;
        let next = match self.slope {
            Some(slope) => suction + (held.most.sqrt() - held.root()) / slope,
            None if suction <= 0.0 => FIRST_KPA,
            None => suction * MOST_FACTOR,
        };
        let factor = if self.failed.is_some() { CAREFUL_FACTOR } else { MOST_FACTOR };
        let next = next.clamp(suction / factor, (suction * factor).max(FIRST_KPA)).min(MOST_KPA);
        self.failed.map_or(next, |failed| next.min(0.5 * (suction + failed)))
    }
}

impl Solver {
    /// The void of the solution; `None` of a void without a limit.
    fn held(&self) -> Option<Held> {
        let void = self.problem.void.filter(|_| self.law.layered().is_some())?;
        let part = Part::new(self.problem.sheet().nodes_per_side(), self.mirrored);
        let most = void.most_mm3.max(self.problem.least_void_mm3());
        let (relative, least) = TOLERANCE;
        Some(Held {
            suction_kpa: void.suction_kpa,
            volume: self.problem.void_mm3(&self.x, part),
            most,
            tolerance: (relative * most).max(least),
        })
    }

    /// Is the void at its limit, or without one?
    pub(super) fn is_sealed(&self) -> bool {
        self.held().is_none_or(Held::is_enough)
    }

    /// Is a void at its limit, and what is left of it within the tolerance of positions?
    fn is_enough(&self, held: Held) -> bool {
        held.is_enough() && self.left_by_void() <= self.problem.tolerance
    }

    /// Draws the void nearer to its limit, beside the growth of the skin.
    pub(super) fn pull_beside_growth(&mut self, is_rough: bool) -> Pull {
        let Some(mut held) = self.held() else { return Pull::Enough };
        held.tolerance *= BESIDE_GROWTH;
        let suction = held.suction_kpa;
        let is_near = |failed: f64| failed - suction < NEAR_FAILED * failed;
        self.seal.is_greatest |= self.seal.failed.is_some_and(is_near);
        // A void below its limit asks for less.
        self.seal.is_greatest &= held.volume > held.most;
        if self.seal.is_greatest || self.is_enough(held) {
            return Pull::Enough;
        }
        let Some(slope) = self.seal.slope else { return Pull::Unknown };
        self.keep_solution(held.volume, is_rough);
        self.seal.learn(held, LEAST_STEP[usize::from(is_rough)]);
        let learnt = self.seal.slope.unwrap_or(slope);
        let without = held.root() - learnt * suction;
        let next = if without <= held.most.sqrt() { 0.0 } else { self.seal.next(held) };
        let [least, most] = SLOPES;
        self.seal.slope = Some(slope * (learnt / slope).clamp(least, most));
        self.set_suction(next);
        Pull::Nearer
    }

    /// Ends a solve with the void that it has; without convergence if it leaves more than the tolerance.
    pub(super) fn end_sealed(&mut self, verdict: Verdict) {
        let by_void = self.left_by_void();
        self.left = self.left.max(by_void);
        self.seal = Seal::default();
        let is_left = by_void > self.problem.tolerance;
        self.end(if is_left { Verdict::NotConverged } else { verdict });
    }

    /// Position error by the difference of the void from its limit, as the solutions so far moved by the void \[base radius\].
    fn left_by_void(&self) -> f64 {
        let (Some(held), Some(kept)) = (self.held(), &self.seal.kept) else { return 0.0 };
        if held.suction_kpa <= 0.0 || held.is_at_most() || self.seal.is_greatest {
            return 0.0;
        }
        let moved = self.x.iter().zip(&kept.x).map(|(x, before)| x.distance(*before));
        let moved = moved.fold(0.0, f64::max) / self.problem.obstacle.dome.reference_length();
        let by = (kept.volume - held.volume).abs();
        if by > held.off() { moved * held.off() / by } else { moved }
    }

    /// Ends a solve, unless its void is to be smaller.
    pub(super) fn seal_or_end(&mut self, verdict: Verdict) {
        let Some(held) = self.held() else { return self.end(verdict) };
        let was_rough = self.seal.is_rough;
        let is_enough = self.is_enough(held);
        if is_enough && !was_rough || verdict != Verdict::Converged {
            return self.end_sealed(verdict);
        }
        if self.seal.solves >= MOST_SOLVES {
            return self.end_sealed(if was_rough { Verdict::NotConverged } else { verdict });
        }
        self.keep_solution(held.volume, was_rough);
        let next = if is_enough {
            held.suction_kpa
        } else {
            self.seal.learn(held, 0.0);
            self.seal.next(held)
        };
        self.seal.solves += 1;
        let is_far = held.off() > ROUGH * held.tolerance && next < MOST_KPA;
        let is_new = self.seal.failed.is_none() && self.seal.solves <= MOST_ROUGH;
        self.draw(next, is_far && is_new);
    }

    /// Solves again under a suction \[kPa\].
    fn draw(&mut self, suction_kpa: f64, may_be_rough: bool) {
        self.set_suction(suction_kpa);
        self.seal.is_rough = self.solve_again(may_be_rough.then_some(ROUGH_CYCLES));
    }

    fn set_suction(&mut self, suction_kpa: f64) {
        if let Some(void) = &mut Arc::make_mut(&mut self.problem).void {
            void.suction_kpa = suction_kpa;
        }
    }

    /// Keeps the solution to go back to; one to the tolerance replaces a rough one.
    fn keep_solution(&mut self, volume: f64, is_rough: bool) {
        let own = Some(Kept {
            suction_kpa: self.problem.suction_kpa(),
            volume,
            multigrid: self.multigrid.clone().filter(|_| self.stage == Stage::Multigrid),
            x: self.x.clone(),
            outer: self.outer.clone(),
            mirrored: self.mirrored,
            modes: self.problem.obstacle.dome.shape.soft().map(SoftHalfBall::modes),
        });
        if is_rough {
            self.seal.rough = own;
        } else {
            (self.seal.kept, self.seal.rough) = (own, None);
        }
    }

    /// Goes back to a solution; false of one by Newton's method.
    fn restore(&mut self, kept: &Kept) -> bool {
        let Some(multigrid) = &kept.multigrid else { return false };
        self.multigrid = Some(multigrid.clone());
        self.x.clone_from(&kept.x);
        self.outer.clone_from(&kept.outer);
        self.mirrored = kept.mirrored;
        self.displayed = Displayed::Draft;
        self.revision += 1;
        if let Some(modes) = kept.modes {
            self.deform(modes);
        }
        true
    }

    /// Goes back from a suction without a solution: to the last rough solution since the last one to the tolerance, else half of the way to that one;
    /// false without one. After some halvings that solution is the end, with a void that is larger.
    pub(super) fn draws_less(&mut self) -> bool {
        let failed = self.problem.suction_kpa();
        if failed <= 0.0 {
            return false;
        }
        // A rough solution is on the way: one to the tolerance starts there.
        let rough = self.seal.rough.take().filter(|rough| rough.suction_kpa < failed);
        if let Some(rough) = rough.filter(|rough| self.restore(rough)) {
            self.seal.failed = Some(failed);
            self.draw(rough.suction_kpa, false);
            return true;
        }
        let Some(kept) = self.seal.kept.take() else { return false };
        if !self.restore(&kept) {
            return false;
        }
        let last = kept.suction_kpa.min(MOST_LEFT * failed);
        self.seal.halvings += 1;
        if self.seal.halvings > MOST_HALVINGS && self.problem.rest.growth() > 0.0 {
            self.seal.is_greatest = true;
            self.draw(last, false);
            return true;
        }
        if self.seal.halvings > MOST_HALVINGS {
            self.set_suction(last);
            self.seal = Seal::default();
            self.end(Verdict::Converged);
            return true;
        }
        self.seal.kept = Some(kept);
        self.seal.failed = Some(failed);
        self.draw(0.5 * (last + failed), false);
        true
    }

    /// Starts without a suction.
    pub(super) fn unseal(&mut self) {
        self.seal = Seal::default();
        if self.problem.suction_kpa() > 0.0 {
            self.set_suction(0.0);
        }
    }
}

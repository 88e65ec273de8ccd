//! How far an iteration goes: along its step, on along it or across two of them, and what the way tells
//! about the error.

use super::contact::{ON_DOME, admissible};
use super::symmetry::{share_flags, symmetrize};
use super::{Newton, Phase, State};
use crate::implant::Dome;
use crate::solve::assemble;
use crate::solve::law::SheetLaw;
use glam::DVec3;

/// Halvings of a step before the grid is given up.
const MAX_HALVINGS: u32 = 12;
/// A step that lowers the energy by more than this share of what its first part promised is less than
/// half as long as it could be.
const LEAST_FALL: f64 = 0.75;
/// The first length that is tried of a step that was too short, and across two of them; and the length
/// from which on none is.
const LONGER: f64 = 2.0;
const ACROSS: f64 = 1.5;
const MOST_LENGTH: f64 = 64.0;
/// The share of the way gone on after a step that still counts as error after each further iteration.
const CALM: f64 = 0.5;
/// The greatest share of a step that the next one is taken to leave.
const MOST_RATE: f64 = 0.98;
/// Iterations for which the dome's curvature stays out of the model where it made it indefinite, and how
/// often a shape found without it is tried with it: without, the model may be far too stiff.
const CARE: u32 = 4;
const MAX_TRIES: u32 = 2;
/// How often in a row the energy falls nowhere along the true model's step before the shape stays where
/// it is: from there the iteration may still find the way.
const MAX_BLOCKED: u32 = 3;
/// The greatest relative residual before the last step.
const MOST_RESIDUAL: f64 = 0.05;
/// The same of a sheet that pushes somewhere: small steps may lie before its fold.
const SLACK_RESIDUAL: f64 = 1e-4;
/// Cost of the energy in work units.
const ENERGY_UNITS: f64 = 0.7;

impl Newton {
    /// Tries the step at a length; takes it if the energy falls, else halves it.
    pub(super) fn search(
        &mut self,
        law: &SheetLaw,
        dome: &Dome,
        tolerance: f64,
        length: f64,
        halvings: u32,
    ) -> State {
        self.work_units += ENERGY_UNITS;
        if halvings == 0 {
            symmetrize(&self.mirrors, &self.sheet, &self.free, &mut self.d);
            share_flags(&self.mirrors, &self.sheet, &self.free, &mut self.contact);
        }
        self.trial.copy_from_slice(&self.x);
        let (mut largest, mut expected) = (0.0_f64, 0.0);
        for &k in &self.free {
            let k = k as usize;
            let to = self.place(dome, k, self.x[k] + self.d[k] * length, halvings == 0);
            let moved = to - self.x[k];
            largest = largest.max(moved.length_squared());
            expected += moved.dot(self.forces[k]);
            self.trial[k] = to;
        }
        let largest = largest.sqrt();
        let energy = assemble::energy(&self.sheet, law, &self.trial);
        // What sums round, and what positions do: a spring's end moved by so much.
        let rounded = f64::EPSILON * self.sheet.radius_mm();
        let noise = 1e-13 * self.totals.energy.abs() + rounded * self.totals.force_scale();
        let falls = energy <= self.totals.energy - 1e-4 * expected.max(0.0) + noise;
        if !(falls && energy.is_finite()) {
            // The true model's step may be turned uphill by contact; a part of it need not be.
            let is_uphill = expected <= 0.0 && !self.is_asked;
            if is_uphill || halvings >= MAX_HALVINGS {
                if self.is_asked {
                    self.blocked += 1;
                    if self.blocked >= MAX_BLOCKED {
                        return State::Converged;
                    }
                }
                if !self.is_plain && (is_uphill || self.is_cautious) {
                    self.is_plain = true;
                    self.phase = Phase::Linearize { row: 0 };
                } else if !self.is_cautious {
                    self.take_care();
                } else {
                    return State::Stalled;
                }
                return State::Working;
            }
            self.phase = Phase::Search { length: 0.5 * length, halvings: halvings + 1 };
            return State::Working;
        }
        std::mem::swap(&mut self.x, &mut self.trial);
        self.moves += 1;
        if self.is_asked {
            self.blocked = 0;
        }
        let was_cautious = self.is_cautious;
        // Part of a step tells nothing about those to come.
        let is_whole = halvings == 0 && !std::mem::take(&mut self.is_plain);
        self.is_cautious &= self.iterations < self.cautious_to;
        // Steps shrink at least geometrically: what is left is the sum of the next ones. Once one was too
        // short, the sheet is nearly slack somewhere: a quick step in front of slow ones tells nothing.
        let pushes = self.totals.is_slack(self.force_scale(law));
        let is_slack = self.stretch > 1.0 || pushes;
        let rate = if is_slack { MOST_RATE } else { (largest / self.last_step).min(MOST_RATE) };
        self.error = if is_whole && self.last_step.is_finite() {
            self.stretch * largest * rate / (1.0 - rate)
                + self.last_round.min(largest)
                + self.travelled
        } else {
            f64::INFINITY
        };
        self.last_step = if is_whole { largest } else { f64::INFINITY };
        self.travelled *= CALM;
        self.phase = Phase::Linearize { row: 0 };
        // The residual is that before the step: a step that small may also be one that was held up.
        let most_residual = if pushes { SLACK_RESIDUAL } else { MOST_RESIDUAL };
        let is_balanced = self.relative_residual <= most_residual;
        // One quick step proves little: where the sheet is nearly slack, slow ones may follow it.
        let is_near = self.error.max(largest) <= tolerance;
        let is_short = is_whole
            && self.totals.energy - energy > LEAST_FALL * expected
            && expected > 10.0 * noise;
        // What is near is farther than it seems where the model is too stiff: that shows first.
        if is_near && is_balanced && (!is_short || self.stretch > 1.0) {
            if !was_cautious || self.tries >= MAX_TRIES {
                return if self.is_saddle { State::Saddle } else { State::Converged };
            }
            self.tries += 1;
            self.is_cautious = false;
        }
        if !is_whole {
            self.has_earlier = false;
        } else if is_short {
            self.phase = Phase::Extend { length: LONGER, energy, is_across: false };
        } else {
            self.go_across(energy);
        }
        State::Working
    }

    /// Where the node k comes to lie that would go to a place; held on the dome if it presses: its tangent
    /// step leads off the surface.
    fn place(&self, dome: &Dome, k: usize, to: DVec3, is_held: bool) -> DVec3 {
        let lift = self.lift[k].abs();
        let is_held = is_held && self.contact[k] & ON_DOME != 0;
        admissible(dome, if is_held { dome.onto_level(to, lift) } else { to }, lift)
    }

    /// Tries the way from `trial` along `d` at a greater length than that taken; takes it if the energy
    /// falls on.
    pub(super) fn extend(
        &mut self,
        law: &SheetLaw,
        dome: &Dome,
        (length, energy_before): (f64, f64),
        is_across: bool,
    ) {
        self.work_units += ENERGY_UNITS;
        self.phase = Phase::Linearize { row: 0 };
        self.q.copy_from_slice(&self.trial);
        let mut farthest = 0.0_f64;
        for &k in &self.free {
            let k = k as usize;
            farthest = farthest.max(self.d[k].length_squared());
            self.q[k] = self.place(dome, k, self.trial[k] + self.d[k] * length, true);
        }
        let energy = assemble::energy(&self.sheet, law, &self.q);
        let falls = energy < energy_before;
        if falls {
            std::mem::swap(&mut self.x, &mut self.q);
            self.moves += 1;
            self.travelled = self.travelled.max((length - 1.0) * farthest.sqrt());
            if !is_across {
                self.stretch = self.stretch.max(length);
            }
        }
        if falls && length < MOST_LENGTH {
            self.phase = Phase::Extend { length: 2.0 * length - 1.0, energy, is_across };
        } else if !is_across {
            self.go_across(energy.min(energy_before));
        }
    }

    /// Where steps were too short, goes on along the last two of them at once: of a step and the next
    /// one the greater part undoes the other, what is left leads down the valley (B. V. Shah, R. J.
    /// Buehler and O. Kempthorne, "Some algorithms for minimizing a function of several variables",
    /// J. SIAM 12(1), 1964: parallel tangents).
    fn go_across(&mut self, energy: f64) {
        if self.stretch <= 1.0 {
            return;
        }
        if self.has_earlier {
            for &k in &self.free {
                let k = k as usize;
                self.d[k] = self.x[k] - self.earlier[k];
            }
            std::mem::swap(&mut self.trial, &mut self.earlier);
            self.phase = Phase::Extend { length: ACROSS, energy, is_across: true };
        } else {
            self.earlier.copy_from_slice(&self.trial);
        }
        self.has_earlier = true;
    }

    /// Goes on from a shape that was moved a little: how stiff the model is remains, and so does the error,
    /// for a while.
    pub(super) fn keep_error(&mut self) {
        self.last_step = f64::INFINITY;
        self.travelled = self.error;
        self.has_earlier = false;
        self.tries = 0;
    }

    /// Steps before this tell nothing about those to come.
    pub(super) fn forget_steps(&mut self) {
        self.keep_error();
        self.travelled = 0.0;
        self.stretch = 1.0;
    }

    /// Does the iteration again without the dome's curvature, and keeps to that for a while.
    pub(super) fn take_care(&mut self) {
        self.is_cautious = true;
        self.cautious_to = self.iterations + CARE;
        self.last_step = f64::INFINITY;
        self.has_earlier = false;
        self.phase = Phase::Linearize { row: 0 };
    }
}

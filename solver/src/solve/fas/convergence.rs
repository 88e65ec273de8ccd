//! Convergence of full multigrid: error estimate, balance of forces, contact offsets, mixing of cycles.
//!
//! The error after a cycle is estimated from the change of the cycle and the ratio ρ of the last two changes, as
//! the sum of a geometric series; constants of [`Parameters`], R the base radius, `residual` the relative residual:
//!
//! ```text
//! ρ     = change/previous change, clamped to [min_convergence_factor, max_convergence_factor];
//!         min_convergence_factor without a previous change (skin that has grown: no estimate)
//! error = max(error_safety·change·ρ/(1 − ρ), error_per_residual·residual·R) + neglected contact offset
//! ```
//!
//! A small change alone is no evidence: the relative residual is bounded too (`check_balance`).

use super::level::Level;
use super::parameters::Parameters;
use super::smoother::Contact;
use super::{FullMultigrid, Mode, State, Stop};
use crate::contact::contact_edge;
use crate::model::ElasticModel;

/// Change of a cycle below which slow cycles do not end the attempt \[tolerance\]: of 40 patients at 129 nodes per side with
/// tolerance 1e-4 four ended above the tolerance without, none with it.
const NEAR_END: f64 = 0.1;

/// Slow cycles of a sheet on a grid from which on they are robust. Fixed by `contact-of-one-node`.
const SLOW_AGAIN: u32 = 3;

/// Least squared sine of the angle between the differences of changes that are mixed \[-\].
const LEAST_SINE_SQUARED: f64 = 0.01;

/// Length of the step D⁻¹r of a residual that is negligible \[tolerance\].
const NEGLIGIBLE_STEP: f64 = 0.1;

/// Output of a convergence test.
#[derive(Clone, Copy, Debug)]
pub(in crate::solve) struct Ending {
    /// Estimated greatest node position error \[mm\].
    pub(in crate::solve) error: f64,
    /// Norm of the nodal forces without contact forces, relative to the forces of the cells \[-\].
    pub(in crate::solve) relative_residual: f64,
    /// Are the forces of a nearly slack sheet rounding, at positions within the tolerance?
    pub(in crate::solve) has_rounded_forces: bool,
    /// Is a cell of layered tissue inverted?
    pub(in crate::solve) has_inverted_cell: bool,
    /// Do contact offsets exceed `max_contact_offset`, so that the active set has to be found in f64?
    pub(in crate::solve) leaves_contact_offsets: bool,
}

impl Ending {
    const NONE: Self = Self {
        error: f64::INFINITY,
        relative_residual: f64::INFINITY,
        has_rounded_forces: false,
        has_inverted_cell: false,
        leaves_contact_offsets: false,
    };

    /// Of a shape of another method \[mm; -\].
    pub(in crate::solve) fn of(error: f64, relative_residual: f64) -> Self {
        Self { error, relative_residual, ..Self::NONE }
    }
}

/// Result of a search for contact offsets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Offsets {
    NotSearched,
    /// The offsets are negligible at the tolerance.
    Neglected,
    Applied,
    /// The active set is not clear yet.
    Unclear,
}

/// The convergence of the grid being solved.
#[derive(Clone, Debug)]
pub(super) struct Convergence {
    /// Is the start the solution before the skin grew? A single cycle leaves up to 6 % of the force there.
    pub(super) has_grown: bool,
    /// Cycles of the grid.
    pub(super) cycles: u32,
    /// Slow cycles in a row.
    slow_cycles: u32,
    /// All slow cycles of the grid.
    all_slow_cycles: u32,
    /// Was a cycle slow?
    pub(super) was_slow: bool,
    /// Balance tests whose residual fell by less than `stagnation_factor` since the previous test.
    stagnations: u32,
    /// Relative residual of the last balance test \[-\].
    stagnation_residual: f64,
    pub(super) offsets: Offsets,
    /// Error of neglected contact offsets \[mm\].
    neglected_offset: f64,
    /// Sum of squares of the residual, if the search for contact offsets computed the residual.
    residual_squares: Option<f64>,
    /// The change of the last cycle \[mm\].
    pub(super) last_change: f64,
    /// Number of cycles before whose changes the grid has.
    updates: u32,
    /// ⟨r′, r″⟩ of the changes of the last two cycles.
    last_product: f64,
    /// Convergence factors of the last two cycles without mixing \[-\], zero while unknown.
    unmixed_rates: [f64; 2],
    /// Move of the surface of an implant that yields under layers by the step of its numbers in this cycle \[mm\].
    pub(super) moved: f64,
    /// The same of any by the next step of its numbers \[mm\].
    pub(super) imbalance: f64,
    pub(super) ending: Ending,
}

impl Convergence {
    /// Before the first cycle of a grid.
    pub(super) const NEW: Self = Self {
        has_grown: false,
        cycles: 0,
        slow_cycles: 0,
        all_slow_cycles: 0,
        was_slow: false,
        stagnations: 0,
        stagnation_residual: f64::INFINITY,
        offsets: Offsets::NotSearched,
        neglected_offset: 0.0,
        residual_squares: None,
        last_change: f64::INFINITY,
        updates: 0,
        last_product: 0.0,
        unmixed_rates: [0.0; 2],
        moved: 0.0,
        imbalance: 0.0,
        ending: Ending::NONE,
    };

    /// Discards the last change: the state changed by other means than a cycle.
    fn forget_changes(&mut self) {
        self.last_change = f64::INFINITY;
        self.slow_cycles = 0;
    }

    /// The estimated error by the last cycle, by the residual and by the balance of an implant that yields, with that of neglected
    /// contact offsets \[mm\].
    fn bounded_error(&self, parameters: &Parameters, reference_length: f64) -> f64 {
        let Ending { error, relative_residual, .. } = self.ending;
        let least = parameters.error_per_residual * relative_residual * reference_length;
        error.max(least).max(self.imbalance) + self.neglected_offset
    }

    /// Estimates the error from the change of a cycle \[mm\]; returns whether the cycle was slow.
    fn estimate_error(&mut self, change: f64, parameters: &Parameters) -> bool {
        let least = parameters.min_convergence_factor;
        let mut rate = least;
        let mut is_slow = false;
        if self.last_change.is_finite() {
            // Mixing lowers the ratio of changes, but the result of a cycle is not mixed yet.
            let [one, two] = self.unmixed_rates;
            rate = (change / self.last_change.max(f64::MIN_POSITIVE))
                .max(one)
                .max(two)
                .clamp(least, parameters.max_convergence_factor);
            // What the implant moves says nothing about the tissue's cycles.
            is_slow = change - self.moved > parameters.slow_factor * self.last_change;
            self.slow_cycles = if is_slow { self.slow_cycles + 1 } else { 0 };
            self.was_slow |= is_slow;
            self.all_slow_cycles += u32::from(is_slow);
        }
        self.last_change = change;
        self.ending.error = if self.has_grown && self.cycles == 1 {
            f64::INFINITY
        } else {
            parameters.error_safety * change * rate / (1.0 - rate)
        };
        is_slow
    }
}

impl<M: ElasticModel> FullMultigrid<M> {
    /// The ending of an attempt that has failed or was stopped, its error by the balance of forces, too.
    pub(in crate::solve) fn ending_by_balance(&mut self) -> Ending {
        self.find_relative_residual();
        let error = self.convergence.bounded_error(self.parameters, self.reference_length);
        Ending { error, ..self.convergence.ending }
    }

    /// Ends a cycle: converged, failed, another cycle, or the next finer grid.
    pub(super) fn check_convergence(&mut self) -> State {
        let Level { layout, u, before, .. } = &self.levels[self.grid];
        let change = self.grid_spacing() * f64::from(layout.greatest_difference(u, before));
        self.convergence.cycles += 1;
        if !change.is_finite() {
            return State::Failed;
        }
        if self.is_too_far(change) {
            return State::Failed;
        }
        let is_slow = self.convergence.estimate_error(change, self.parameters);
        // Skin in folds has a slow mode, and slack skin hardly moves: close to the end further cycles cost less than another attempt.
        if change <= NEAR_END * self.tolerance * self.reference_length {
            self.convergence.slow_cycles = 0;
        }
        let parameters = self.parameters;
        let is_far = change > parameters.start_tolerance * self.reference_length;
        if is_slow && self.grid > 0 && (is_far || self.is_slow_again()) {
            self.mode = Mode::Robust;
        }
        if self.grid == self.rising_grid && !self.ascent.is_empty() {
            self.check_step()
        } else if self.is_on_finest() {
            self.check_solution()
        } else {
            self.check_start()
        }
    }

    /// Have cycles of a sheet been slow before? A contact of one or two nodes is none on coarser grids, which lift the sheet off it.
    fn is_slow_again(&self) -> bool {
        self.model.layers() == 1 && self.convergence.all_slow_cycles >= SLOW_AGAIN
    }

    /// Ends a cycle of a coarser grid, whose solution is only a start.
    fn check_start(&mut self) -> State {
        let Self { convergence, grid, reference_length, parameters, .. } = self;
        let (tolerance, most) = match grid {
            grid if *grid == parameters.first_grid => {
                (parameters.coarsest_tolerance, parameters.max_coarsest_cycles)
            }
            _ => (parameters.start_tolerance, parameters.max_start_cycles),
        };
        let is_layered = self.model.layers() > 1;
        let is_enough = convergence.ending.error <= tolerance * *reference_length;
        if is_enough || convergence.cycles >= most {
            // No convergence on the first grid, as with tissue that slides on a steep dome: finer grids fail as well. A sheet on
            // a few nodes may wander where finer grids converge.
            if self.grid == self.parameters.first_grid && !is_enough && is_layered {
                return State::Failed;
            }
            self.refine();
        } else {
            if is_layered {
                self.mix();
            }
            self.begin_cycle();
        }
        State::Working
    }

    /// Ends a cycle of the rising grid under a dome that is to rise further, whose solution is only a start.
    fn check_step(&mut self) -> State {
        let Self { convergence, reference_length, parameters, .. } = self;
        let &mut Convergence { cycles, last_change, .. } = convergence;
        let is_near = last_change <= parameters.rising_change * *reference_length;
        if is_near && cycles >= parameters.cycles_of_step {
            self.raise();
        } else if cycles >= parameters.max_cycles_of_step {
            return State::Failed;
        } else {
            self.mix();
            self.begin_cycle();
        }
        State::Working
    }

    /// Ends a cycle of the finest grid.
    fn check_solution(&mut self) -> State {
        let is_enough = match self.stop {
            Stop::Cycles(cycles) => self.convergence.cycles >= cycles,
            Stop::Tolerance => self.is_error_tolerable(),
        };
        if self.is_settled(is_enough)
            && matches!(self.convergence.offsets, Offsets::NotSearched | Offsets::Unclear)
            && self.model.has_contact_offsets()
        {
            self.convergence.offsets = self.find_contact_offsets();
            if self.convergence.offsets == Offsets::Applied {
                self.convergence.forget_changes();
                self.convergence.updates = 0;
                self.begin_cycle();
                return State::Working;
            }
        }
        let is_clear = self.convergence.offsets != Offsets::Unclear;
        // The error is tested again: `find_contact_offsets` changed the neglected offset.
        if is_enough && is_clear && (self.stop != Stop::Tolerance || self.is_error_tolerable()) {
            let ending = self.check_balance();
            if ending != State::Working {
                return ending;
            }
        }
        self.convergence.residual_squares = None;
        let Convergence { cycles, slow_cycles, .. } = self.convergence;
        let parameters = self.parameters;
        let is_exhausted =
            cycles >= parameters.max_cycles || slow_cycles >= parameters.max_slow_cycles;
        if self.stop == Stop::Tolerance && is_exhausted {
            return State::Failed;
        }
        self.mix();
        self.begin_cycle();
        let error = self.convergence.ending.error;
        if self.draft_tolerance.is_some_and(|draft| error <= draft * self.reference_length) {
            self.draft_tolerance = None;
            return State::Draft;
        }
        State::Working
    }

    /// Is the active set accurate enough for a search of contact offsets?
    fn is_settled(&self, is_enough: bool) -> bool {
        match self.stop {
            Stop::Cycles(cycles) => cycles > 1 && 2 * self.convergence.cycles >= cycles,
            Stop::Tolerance => is_enough,
        }
    }

    /// Is the error, including neglected contact offsets, within the tolerance?
    fn is_error_tolerable(&self) -> bool {
        let Convergence { ending, neglected_offset, .. } = &self.convergence;
        ending.error + neglected_offset <= self.tolerance * self.reference_length
    }

    /// Tests the balance of forces: a small residual is convergence; `max_stagnations` tests whose residual fell by
    /// less than `stagnation_factor` since the previous test are the end. It is convergence if the residual moves no node of a
    /// sheet by a fraction of the tolerance: the forces of a nearly slack sheet are rounding.
    fn check_balance(&mut self) -> State {
        self.find_relative_residual();
        let is_at_rest = self.is_residual_negligible();
        let Self { convergence, reference_length, tolerance, parameters, .. } = self;
        let residual = convergence.ending.relative_residual;
        let by_change = convergence.ending.error + convergence.neglected_offset;
        convergence.ending.error = convergence.bounded_error(parameters, *reference_length);
        let (low, high) = parameters.residual_bounds;
        let is_shape_balanced = convergence.imbalance <= *tolerance * *reference_length;
        if convergence.ending.has_inverted_cell && self.stop == Stop::Tolerance {
            return State::Failed;
        }
        let is_balanced = convergence.ending.error <= *tolerance * *reference_length
            && (residual <= tolerance.clamp(low, high)
                || residual <= high && self.levels[self.grid].is_rounded(parameters.roundings));
        if is_balanced || self.stop != Stop::Tolerance {
            return State::Converged;
        }
        if !is_shape_balanced {
            return State::Working;
        }
        let is_stagnant = residual > parameters.stagnation_factor * convergence.stagnation_residual;
        convergence.stagnations += u32::from(is_stagnant);
        convergence.stagnation_residual = residual;
        let is_end = convergence.stagnations >= parameters.max_stagnations;
        if is_stagnant && !is_at_rest && self.grid > 0 && self.model.layers() == 1 {
            // The correction of a coarser grid with another active set may undo what the smoother does.
            self.mode = Mode::Robust;
        }
        if !is_end {
            return State::Working;
        }
        if is_at_rest && by_change <= *tolerance * *reference_length {
            convergence.ending.error = by_change;
            convergence.ending.has_rounded_forces = true;
            return State::Converged;
        }
        State::Failed
    }

    /// Does D⁻¹r of a sheet move no node by more than [`NEGLIGIBLE_STEP`]?
    fn is_residual_negligible(&self) -> bool {
        let step = || self.grid_spacing() * f64::from(self.levels[self.grid].greatest_step());
        let most = NEGLIGIBLE_STEP * self.tolerance * self.reference_length;
        self.model.layers() == 1 && step() <= most
    }

    /// Computes the relative residual.
    fn find_relative_residual(&mut self) {
        let grid = self.grid;
        let known = self.convergence.residual_squares.take();
        // The work of the reactions needs the forces, which the residual replaces.
        let known = if self.find_imbalance() { None } else { known };
        let level = &mut self.levels[grid];
        let squares = known.unwrap_or_else(|| level.find_residual(&self.model, Contact::OneSided));
        let tension = level.tension(&self.model);
        let ending = &mut self.convergence.ending;
        // The lower bound keeps rounding from being compared with rounding in a sheet at rest.
        ending.relative_residual = (squares / tension.squares.max(1e-18)).sqrt();
        ending.has_inverted_cell = tension.has_inverted_cell;
        self.count(grid, if known.is_some() { 0.5 } else { 1.5 });
    }

    /// Computes the contact offsets, and applies the offsets that are significant at the tolerance.
    fn find_contact_offsets(&mut self) -> Offsets {
        let (grid, is_study) = (self.grid, self.stop != Stop::Tolerance);
        let spacing = self.grid_spacing();
        let level = &mut self.levels[grid];
        let squares = level.find_residual(&self.model, Contact::OneSided);
        let greatest = level.find_contact_offsets() * spacing / self.reference_length;
        self.convergence.neglected_offset =
            contact_edge::neglected(greatest) * self.reference_length;
        // Offsets within the tolerance are neglected without another cycle.
        let mut fraction = if self.is_error_tolerable() && !is_study {
            0.0
        } else {
            contact_edge::fraction(greatest, self.tolerance)
        };
        let is_large = fraction * greatest > self.parameters.max_contact_offset * self.tolerance;
        let leaves_offsets = !is_study && is_large;
        self.convergence.ending.leaves_contact_offsets = leaves_offsets;
        if leaves_offsets {
            (fraction, self.convergence.neglected_offset) = (0.0, 0.0);
        }
        self.count(grid, 1.0);
        let offsets = &mut self.levels[grid].contact_offset;
        if fraction <= 0.0 {
            offsets.fill(0.0);
            self.convergence.residual_squares = Some(squares);
            return Offsets::Neglected;
        }
        self.convergence.neglected_offset = 0.0;
        let error = self.convergence.ending.error / self.reference_length;
        let is_clear =
            is_study || contact_edge::is_clear(error, greatest) || self.convergence.slow_cycles > 0;
        if !is_clear {
            offsets.fill(0.0);
            return Offsets::Unclear;
        }
        offsets.iter_mut().for_each(|offset| *offset *= fraction as f32);
        Offsets::Applied
    }

    /// Mixes the results g of the last cycles so that the change r = g − u, linear between them, is least:
    /// u ← g − θ₁(g − g′) − θ₂(g − g″), of two cycles θ₁ = ⟨r, r − r′⟩/⟨r − r′, r − r′⟩.
    fn mix(&mut self) {
        let level = &mut self.levels[self.grid];
        let Level { layout, u, before, last_cycles, .. } = level;
        let Convergence { updates, cycles, last_product, unmixed_rates, .. } =
            &mut self.convergence;
        let [product, square, own] = layout.products(u, before, &last_cycles[0].change);
        let theta = (own - product) / (own - 2.0 * product + square);
        // θ = ρ/(ρ − 1) for changes that fall by a factor ρ.
        if *updates > 0 && theta < 0.0 {
            unmixed_rates[1] = unmixed_rates[0];
            unmixed_rates[0] = theta / (theta - 1.0);
        }
        let (least, most) = self.parameters.mixing_bounds;
        let is_known = *updates > 0 && theta.is_finite();
        let mut thetas = [if is_known { theta.clamp(least, most) } else { 0.0 }, 0.0];
        let has_many = *updates > 1 && *cycles >= self.parameters.three_mixed_from;
        if let Some(older) = last_cycles.get(1).filter(|_| has_many) {
            let [older, older_square, _] = layout.products(u, before, &older.change);
            // Products of r − r′ and r − r″ with each other, and with r.
            let squares = [own - 2.0 * product + square, own - 2.0 * older + older_square];
            let mixed = own - product - older + *last_product;
            let both = least_change(squares, mixed, [own - product, own - older]);
            thetas = both.filter(|t| (least..=most).contains(&(t[0] + t[1]))).unwrap_or(thetas);
        }
        *last_product = product;
        *updates += 1;
        let thetas = thetas.map(|theta| theta as f32);
        // The place of the oldest cycle becomes that of this one.
        let last = last_cycles.len() - 1;
        last_cycles[last].change.set_difference(u, before);
        // The result of this cycle, which the next ones need.
        before.copy_from(u);
        for (&theta, cycle) in thetas.iter().zip(&*last_cycles).filter(|(t, _)| **t != 0.0) {
            u.add_scaled_difference(&cycle.result, before, theta);
        }
        last_cycles[last].result.copy_from(before);
        last_cycles.rotate_right(1);
        let is_mixed = *updates > 1;
        self.mix_shape(thetas);
        let level = &mut self.levels[self.grid];
        if is_mixed {
            level.project_feasible();
        }
        level.mix_constraints(&self.model, thetas);
    }
}

/// The factors θ of the least square of r − θ₁ d₁ − θ₂ d₂ from the squares of d₁ and d₂, their product and their products with r;
/// `None` of differences that are nearly parallel.
fn least_change([a, b]: [f64; 2], mixed: f64, [p, q]: [f64; 2]) -> Option<[f64; 2]> {
    let determinant = a * b - mixed * mixed;
    let is_regular = determinant > LEAST_SINE_SQUARED * a * b;
    is_regular.then(|| [(b * p - mixed * q) / determinant, (a * q - mixed * p) / determinant])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_differences_take_away_their_part_of_the_change() {
        // r = (3, −2, 5), d₁ = (1, 0, 0), d₂ = (1, 1, 0): what remains is (0, 0, 5).
        let thetas = least_change([1.0, 2.0], 1.0, [3.0, 1.0]);
        assert_eq!(thetas, Some([5.0, -2.0]));
        assert_eq!(least_change([1.0, 4.0], 2.0, [3.0, 6.0]), None);
        assert_eq!(least_change([f64::NAN, 4.0], 2.0, [3.0, 6.0]), None);
    }
}

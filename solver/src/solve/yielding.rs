//! The balance of an implant that yields: the numbers of its deformation at which its energy and the tissue's are least together.
//!
//! With the tissue in equilibrium beside a fixed shape, −∂E/∂q = Q = Σ λ ∂g/∂q over the nodes in contact: λ their reaction per gradient of the gauge
//! g (the envelope theorem: no derivative of the displacements). The balance is W′(q) = Q. A step is (W″ + B)⁻¹(Q − W′) with B instead of the
//! tissue's own −∂Q/∂q: each node's reaction as a spring of the length of the implant's height, and what steps that went too far have shown. Tight skin
//! is up to 30 times as stiff as its reactions: a flattened implant is wider, and its base stretches the skin towards the pocket's edge.

use super::{Problem, Tissue};
use crate::contact::{Balance, Gel, Geometry, MODES, Modes};

/// Stiffness of a node's reaction to its move \[reactions/height of the implant\]: above that of most tissue, which converges without oscillation.
const STIFFENING: f64 = 2.0;
/// Most change of the numbers in a step \[-\].
const MOST_CHANGE: Modes<f64> = [0.15, 0.2, 0.05, 0.1, 0.1, 0.1, 0.1, 0.1];
/// Greatest change of a number of a step that shows nothing of the tissue's stiffness: rounding \[-\].
const LEAST_SHOWN: f64 = 1e-4;
/// Stiffness along a step beyond that of the model that is learned, or below it is forgotten \[model\].
const DEVIATION: f64 = 0.4;
/// The least part of the learned stiffness that a step leaves \[-\].
const LEAST_PART: f64 = 0.25;
/// Least and greatest of the numbers \[-\]: beyond the maps describe no implant.
const RANGE: [(f64, f64); MODES] = [
    (-0.3, 0.6),
    (-0.42, 1.0),
    (-0.15, 0.2),
    (-0.4, 0.4),
    (-0.5, 0.5),
    (-0.5, 0.5),
    (-0.3, 0.3),
    (-0.3, 0.3),
];

type Matrix = [Modes<f64>; MODES];

/// Work of the reactions of the tissue by the numbers of a deformation.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Work {
    /// Q \[kPa·mm³\].
    pub(super) forces: Modes<f64>,
    /// Σ f n nᵀ of reactions f and moves n of the surface along its normal by the numbers \[kPa·mm⁴\].
    moved: Matrix,
}

impl Work {
    /// Adds a node's reaction per gradient \[kPa·mm³\], the length of the gradient
    /// \[1/mm\] and the derivatives of the gauge by the numbers.
    pub(super) fn add(&mut self, per_gradient: f64, steepness: f64, variation: Modes<f64>) {
        for (i, own) in variation.into_iter().enumerate() {
            self.forces[i] += per_gradient * own;
            let along = per_gradient * own / steepness;
            for (sum, other) in self.moved[i].iter_mut().zip(variation) {
                *sum += along * other;
            }
        }
    }

    /// The same in other units of force times length and of length.
    pub(super) fn scaled(mut self, energy: f64, length: f64) -> Self {
        self.forces = self.forces.map(|force| force * energy);
        self.moved = self.moved.map(|row| row.map(|sum| sum * energy * length));
        self
    }
}

/// The start of a step of the numbers.
#[derive(Clone, Copy, Debug)]
struct Before {
    modes: Modes<f64>,
    /// Q and W′ \[kPa·mm³\].
    forces: [Modes<f64>; 2],
    /// B \[kPa·mm³\].
    tissue: Matrix,
}

/// An implant that yields, in a problem.
#[derive(Clone, Debug)]
pub(super) struct Yielding {
    gel: Gel,
    /// Height at rest \[mm\].
    height: f64,
    /// Numbers that the symmetry leaves at zero.
    fixed: [bool; MODES],
    pub(super) modes: Modes<f64>,
    /// The part of B that steps have shown, symmetric and without a negative eigenvalue \[kPa·mm³\].
    learned: Matrix,
    /// The last step; `None` at the start of a grid.
    before: Option<Before>,
}

impl Yielding {
    /// Of the implant of a problem whose solution is mirrored along x, along y; `None` of one that does not yield.
    pub(super) fn of(problem: &Problem, mirrored: [bool; 2]) -> Option<Self> {
        let dome = &problem.obstacle.dome;
        let soft = dome.shape.soft().filter(|soft| soft.modulus_kpa().is_finite())?;
        let height = soft.rest().half_axes().z;
        let [across, along] = mirrored;
        // A quarter turn maps the grid and a round sheet onto themselves: as wide across as along.
        let is_round = problem.tissue == Tissue::Sheet
            && problem.rest.is_even()
            && soft.rest().is_round()
            && problem.mirrored() == [true; 2];
        let fixed = [false, false, false, is_round, across, along, across, along];
        let learned = [[0.0; MODES]; MODES];
        Some(Self { gel: soft.gel(), height, fixed, modes: soft.modes(), learned, before: None })
    }

    /// The implant of another problem with the same symmetry: its numbers, and what is learned of the tissue, are those so far.
    pub(super) fn in_problem(self, problem: &Problem) -> Option<Self> {
        let Self { gel, height, .. } = Self::of(problem, [false; 2])?;
        Some(Self { gel, height, before: None, ..self })
    }

    /// Forgets the last step, which belongs to another grid.
    pub(super) fn begin_grid(&mut self) {
        self.before = None;
    }

    /// The step of the numbers towards the balance, once the one before has shown the tissue's stiffness.
    pub(super) fn next_step(&mut self, work: &Work) -> Modes<f64> {
        let balance = self.gel.balance(self.modes);
        let (modes, forces) = (self.modes, [work.forces, balance.forces]);
        if let Some(before) = self.before {
            self.learn(&before, &forces);
        }
        self.before = Some(Before { modes, forces, tissue: self.tissue(work) });
        self.towards(balance, work)
    }

    /// The step of the numbers towards the balance.
    pub(super) fn step(&self, work: &Work) -> Modes<f64> {
        self.towards(self.gel.balance(self.modes), work)
    }

    /// B.
    fn tissue(&self, work: &Work) -> Matrix {
        let mut matrix = self.learned;
        for (row, moved) in matrix.iter_mut().zip(work.moved) {
            row.iter_mut().zip(moved).for_each(|(b, sum)| *b += STIFFENING / self.height * sum);
        }
        matrix
    }

    /// Compares the change of Q along a step with B. Tissue that is stiffer adds the update of rank one with which B has the change of Q; softer
    /// tissue takes from what is learned.
    fn learn(&mut self, before: &Before, [forces, own]: &[Modes<f64>; 2]) {
        let step = difference(&self.modes, &before.modes);
        if step.iter().all(|change| change.abs() < LEAST_SHOWN) {
            return;
        }
        let change = difference(&before.forces[0], forces);
        let expected = before.tissue.map(|row| dot(&row, &step));
        let excess = difference(&change, &expected);
        let beyond = dot(&excess, &step);
        let model = dot(&expected, &step) + dot(&difference(own, &before.forces[1]), &step);
        if beyond > DEVIATION * model {
            for (row, one) in self.learned.iter_mut().zip(excess) {
                row.iter_mut().zip(excess).for_each(|(b, other)| *b += one * other / beyond);
            }
        } else if -beyond > DEVIATION * model {
            let learned = dot(&self.learned.map(|row| dot(&row, &step)), &step);
            let part = (1.0 + beyond / learned.max(f64::MIN_POSITIVE)).max(LEAST_PART);
            self.learned.iter_mut().flatten().for_each(|b| *b *= part);
        }
    }

    /// The step of the numbers from the forces of the body and the work of the tissue.
    fn towards(&self, balance: Balance, work: &Work) -> Modes<f64> {
        let mut matrix = balance.stiffness;
        for (row, tissue) in matrix.iter_mut().zip(self.tissue(work)) {
            row.iter_mut().zip(tissue).for_each(|(own, tissue)| *own += tissue);
        }
        let forces = difference(&work.forces, &balance.forces);
        let mut fixed = self.fixed;
        loop {
            let step = self.limited(matrix, forces, &fixed);
            // A number at its bound that the step would take beyond stays, and the others move without it.
            let stays = std::array::from_fn(|k| {
                let (least, most) = RANGE[k];
                let towards = step[k];
                towards < 0.0 && self.modes[k] <= least || towards > 0.0 && self.modes[k] >= most
            });
            if stays == [false; MODES] {
                return step;
            }
            fixed.iter_mut().zip(stays).for_each(|(fixed, stays)| *fixed |= stays);
        }
    }

    /// The step by a stiffness and forces, without the fixed numbers, as long as a step may be.
    fn limited(
        &self,
        mut matrix: Matrix,
        mut forces: Modes<f64>,
        fixed: &[bool; MODES],
    ) -> Modes<f64> {
        for i in 0..MODES {
            for j in 0..MODES {
                if (fixed[i] || fixed[j]) && i != j {
                    matrix[i][j] = 0.0;
                }
            }
            if fixed[i] {
                forces[i] = 0.0;
            }
        }
        let Some(step) = solved(matrix, forces) else { return [0.0; MODES] };
        let excess = step.iter().zip(MOST_CHANGE).map(|(s, most)| s.abs() / most);
        let shorter = 1.0 / excess.fold(1.0, f64::max);
        step.map(|change| shorter * change)
    }

    /// The greatest move of the surface by a step of the numbers, about \[mm\].
    pub(super) fn greatest_move(&self, step: &Modes<f64>) -> f64 {
        self.height * step.iter().map(|change| change.abs()).fold(0.0, f64::max)
    }

    /// Moves the numbers by a step, at most to their bounds.
    pub(super) fn advance(&mut self, step: &Modes<f64>) {
        for ((own, change), (least, most)) in self.modes.iter_mut().zip(step).zip(RANGE) {
            *own = (*own + change).clamp(least, most);
        }
    }
}

fn difference(a: &Modes<f64>, b: &Modes<f64>) -> Modes<f64> {
    std::array::from_fn(|k| a[k] - b[k])
}

fn dot(a: &Modes<f64>, b: &Modes<f64>) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// The solution of a system with a positive definite matrix; `None` of another one.
fn solved(mut a: Matrix, mut b: Modes<f64>) -> Option<Modes<f64>> {
    for k in 0..MODES {
        if a[k][k] <= 0.0 {
            return None;
        }
        for i in k + 1..MODES {
            let factor = a[i][k] / a[k][k];
            for j in k..MODES {
                a[i][j] -= factor * a[k][j];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..MODES).rev() {
        for j in k + 1..MODES {
            b[k] -= a[k][j] * b[j];
        }
        b[k] /= a[k][k];
    }
    b.iter().all(|value| value.is_finite()).then_some(b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Deformed, HalfBall};

    /// Tissue with Q = Q₀ − K q around a body of 40 kPa, 30 mm high; its reactions show 1 % of the mean of K.
    struct Linear {
        at_rest: Modes<f64>,
        stiffness: Matrix,
    }

    impl Linear {
        fn yielding() -> Yielding {
            let body = Deformed::at_rest(HalfBall::round(60.0, 30.0), 40.0);
            Yielding {
                gel: body.gel(),
                height: 30.0,
                fixed: [false, false, false, true, true, true, true, true],
                modes: [0.0; MODES],
                learned: [[0.0; MODES]; MODES],
                before: None,
            }
        }

        fn work(&self, modes: &Modes<f64>) -> Work {
            let back = self.stiffness.map(|row| dot(&row, modes));
            let mut moved = [[0.0; MODES]; MODES];
            (0..MODES).for_each(|k| moved[k][k] = 1e7);
            Work { forces: difference(&self.at_rest, &back), moved }
        }
    }

    /// The first three numbers, the others zero.
    fn first([flattening, taper, shoulder]: [f64; 3]) -> Modes<f64> {
        [flattening, taper, shoulder, 0.0, 0.0, 0.0, 0.0, 0.0]
    }

    fn greatest(step: &Modes<f64>) -> f64 {
        step.iter().fold(0.0, |most, change| most.max(change.abs()))
    }

    #[test]
    fn steps_learn_the_stiffness_of_tight_tissue_and_forget_it() {
        let mut stiffness = [[0.0; MODES]; MODES];
        for (k, of) in [6e7, 3e7, 8e7].into_iter().enumerate() {
            stiffness[k][k] = of;
        }
        (stiffness[0][2], stiffness[2][0]) = (-2e7, -2e7);
        let tight = Linear { at_rest: first([8e6, -4e6, -6e6]), stiffness };
        let (mut learning, mut plain) = (Linear::yielding(), Linear::yielding());
        let mut left = [0.0; 2];
        for _ in 0..20 {
            let step = learning.next_step(&tight.work(&learning.modes));
            learning.advance(&step);
            let unlearned = plain.step(&tight.work(&plain.modes));
            plain.advance(&unlearned);
            left = [greatest(&step), greatest(&unlearned)];
        }
        assert!(left[0] < 1e-4 && left[1] > 0.03, "{left:?}");

        // Soft tissue takes the learned stiffness back.
        let soft = Linear { at_rest: first([3e5, 0.0, 0.0]), stiffness: [[0.0; MODES]; MODES] };
        learning.begin_grid();
        for _ in 0..20 {
            let step = learning.next_step(&soft.work(&learning.modes));
            learning.advance(&step);
            left[0] = greatest(&step);
        }
        assert!(left[0] < 1e-4, "{left:?}");
    }

    #[test]
    fn numbers_balance_while_another_one_is_at_its_bound() {
        let at_rest = first([-8.6e5, -4.7e5, 1e9]);
        let tissue = Linear { at_rest, stiffness: [[0.0; MODES]; MODES] };
        let mut yielding = Linear::yielding();
        for _ in 0..60 {
            let step = yielding.next_step(&tissue.work(&yielding.modes));
            yielding.advance(&step);
        }
        assert!(yielding.modes[2] >= RANGE[2].1, "{:?}", yielding.modes);
        let own = yielding.gel.balance(yielding.modes).forces;
        for k in [0, 1] {
            let (least, most) = RANGE[k];
            assert!(least < yielding.modes[k] && yielding.modes[k] < most, "{:?}", yielding.modes);
            assert!((own[k] / at_rest[k] - 1.0).abs() < 1e-3, "{own:?}");
        }
    }
}

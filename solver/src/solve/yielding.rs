//! The balance of an implant that yields: the numbers of its deformation at which its energy and the tissue's are least together.
//!
//! With the tissue in equilibrium beside a fixed shape, −∂E/∂q = Q = Σ λ ∂g/∂q over the nodes in contact: λ their reaction per gradient of the gauge
//! g (the envelope theorem: no derivative of the displacements). The balance is W′(q) = Q. A step is (W″ + B)⁻¹(Q − W′) with B instead of the
//! tissue's own −∂Q/∂q: each node's reaction as a spring of the length of the implant's height.

use crate::contact::{Balance, Dome, Gel, Geometry, MODES, Modes};

/// Stiffness of a node's reaction to its move \[reactions/height of the implant\]: above that of tissue, which converges without oscillation.
const STIFFENING: f64 = 2.0;
/// Most change of the numbers in a step \[-\].
const MOST_CHANGE: Modes<f64> = [0.15, 0.2, 0.05, 0.1, 0.1, 0.1];
/// Least and greatest of the numbers \[-\]: beyond the maps describe no implant.
const RANGE: [(f64, f64); MODES] =
    [(-0.3, 0.6), (-0.42, 1.0), (-0.15, 0.2), (-0.4, 0.4), (-0.5, 0.5), (-0.5, 0.5)];

/// Work of the reactions of the tissue by the numbers of a deformation.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Work {
    /// Q \[kPa·mm³\].
    pub(super) forces: Modes<f64>,
    /// Σ f n nᵀ of reactions f and moves n of the surface along its normal by the numbers \[kPa·mm⁴\].
    moved: [Modes<f64>; MODES],
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

/// An implant that yields, in a problem.
#[derive(Clone, Debug)]
pub(super) struct Yielding {
    gel: Gel,
    /// Height at rest \[mm\].
    height: f64,
    /// Numbers that the symmetry leaves at zero.
    fixed: [bool; MODES],
    pub(super) modes: Modes<f64>,
}

impl Yielding {
    /// Of the implant of a problem whose solution is mirrored along x, along y; `None` of one that does not yield.
    pub(super) fn of(dome: &Dome, mirrored: [bool; 2]) -> Option<Self> {
        let soft = dome.shape.soft().filter(|soft| soft.modulus_kpa().is_finite())?;
        let height = soft.rest().half_axes().z;
        let [across, along] = mirrored;
        let fixed = [false, false, false, false, across, along];
        Some(Self { gel: soft.gel(), height, fixed, modes: soft.modes() })
    }

    /// The step of the numbers towards the balance.
    pub(super) fn step(&self, work: &Work) -> Modes<f64> {
        let Balance { forces: own, stiffness: mut matrix } = self.gel.balance(self.modes);
        let mut right = [0, 1, 2, 3, 4, 5].map(|i| work.forces[i] - own[i]);
        for i in 0..MODES {
            for j in 0..MODES {
                matrix[i][j] += STIFFENING / self.height * work.moved[i][j];
                if (self.fixed[i] || self.fixed[j]) && i != j {
                    matrix[i][j] = 0.0;
                }
            }
            if self.fixed[i] {
                right[i] = 0.0;
            }
        }
        let Some(step) = solved(matrix, right) else { return [0.0; MODES] };
        let excess = step.iter().zip(MOST_CHANGE).map(|(s, most)| s.abs() / most);
        let shorter = 1.0 / excess.fold(1.0, f64::max);
        [0, 1, 2, 3, 4, 5].map(|k| {
            let (least, most) = RANGE[k];
            (self.modes[k] + shorter * step[k]).clamp(least, most) - self.modes[k]
        })
    }

    /// The greatest move of the surface by a step of the numbers, about \[mm\].
    pub(super) fn greatest_move(&self, step: &Modes<f64>) -> f64 {
        self.height * step.iter().map(|change| change.abs()).fold(0.0, f64::max)
    }

    /// Moves the numbers by a step.
    pub(super) fn advance(&mut self, step: &Modes<f64>) {
        self.modes.iter_mut().zip(step).for_each(|(own, change)| *own += change);
    }
}

/// The solution of a system with a positive definite matrix; `None` of another one.
fn solved(mut a: [Modes<f64>; MODES], mut b: Modes<f64>) -> Option<Modes<f64>> {
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

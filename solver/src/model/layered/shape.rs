//! Cells at rest: even cells of one shape over a flat wall, cells of their own shapes over a curved wall.

use super::deformed::Matrix;
use super::modes::Modes;
use super::sides::{Oblique, Sides, Skew, Upright, with_identity};
use super::variation::Variation;
use crate::mesh::vec3::{add, sub};
use crate::number::Real;
use wide::f32x4;

/// The rest shape of cells, in spacings of a grid.
pub(super) trait RestShape<R: Real = f32x4>: Copy {
    type Sides: Sides<R>;

    fn sides(&self) -> &Self::Sides;

    fn variation(&self) -> &Variation<R>;

    /// The volume over that of an even cell.
    fn weight(&self) -> R;

    /// The deformation gradient in the middle of the cell, and the modes of a displacement without those of that gradient.
    fn deformed(&self, modes: &Modes<R>) -> (Matrix<R>, Modes<R>);

    /// The transpose of [`Self::deformed`]: forces on the modes, of a stress in the middle and forces on the modes without skew.
    fn forces(&self, stress: Matrix<R>, forces: Modes<R>) -> Modes<R>;

    /// The modes of a displacement without those of its gradient in the middle of the cell.
    #[inline(always)]
    fn removed(&self, modes: &Modes<R>) -> Modes<R> {
        self.deformed(modes).1
    }

    /// Forces on the modes of the cell, from the derivatives of the energy per rest volume by its modes without skew.
    #[inline(always)]
    fn handed_back(&self, forces: Modes<R>) -> Modes<R> {
        let forces = forces.weighted(self.weight());
        let linear = forces.linear;
        let all = self.forces(Matrix::default(), forces);
        Modes { linear: [0, 1, 2].map(|k| add(linear[k], all.linear[k])), ..all }
    }
}

/// Cells without skew of one volume.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Plain<R, S> {
    pub(super) sides: S,
    pub(super) variation: Variation<R>,
}

/// Upright cells of one height and spacing.
pub(super) type Even = Plain<f32x4, Upright<f32x4>>;

/// Upright cells of one height with any sides in the plane.
pub(super) type InPlane = Plain<f32x4, Oblique<f32x4>>;

/// Cells of any rest shape.
#[derive(Clone, Copy, Debug)]
pub(super) struct Own {
    pub(super) sides: Oblique<f32x4>,
    pub(super) variation: Variation<f32x4>,
    pub(super) weight: f32x4,
    pub(super) skew: Skew<f32x4>,
}

impl Even {
    pub(super) fn new(slope: f64) -> Self {
        let sides = Upright { slope: f32x4::splat(slope as f32) };
        Self { sides, variation: Variation::new(slope) }
    }
}

impl<R: Real, S: Sides<R>> RestShape<R> for Plain<R, S> {
    type Sides = S;

    #[inline(always)]
    fn sides(&self) -> &S {
        &self.sides
    }

    #[inline(always)]
    fn variation(&self) -> &Variation<R> {
        &self.variation
    }

    #[inline(always)]
    fn weight(&self) -> R {
        R::splat(1.0)
    }

    #[inline(always)]
    fn deformed(&self, modes: &Modes<R>) -> (Matrix<R>, Modes<R>) {
        (self.sides.gradient(modes.linear), *modes)
    }

    #[inline(always)]
    fn forces(&self, stress: Matrix<R>, forces: Modes<R>) -> Modes<R> {
        Modes { linear: self.sides.stress(stress), ..forces }
    }

    #[inline(always)]
    fn handed_back(&self, forces: Modes<R>) -> Modes<R> {
        forces
    }
}

impl RestShape for Own {
    type Sides = Oblique<f32x4>;

    #[inline(always)]
    fn sides(&self) -> &Self::Sides {
        &self.sides
    }

    #[inline(always)]
    fn variation(&self) -> &Variation<f32x4> {
        &self.variation
    }

    #[inline(always)]
    fn weight(&self) -> f32x4 {
        self.weight
    }

    #[inline(always)]
    fn deformed(&self, modes: &Modes<f32x4>) -> (Matrix<f32x4>, Modes<f32x4>) {
        let gradient = self.sides.turned(modes.linear);
        (with_identity(gradient), self.skew.removed(gradient, modes))
    }

    #[inline(always)]
    fn forces(&self, stress: Matrix<f32x4>, forces: Modes<f32x4>) -> Modes<f32x4> {
        let [p, q, r] = self.skew.stress(&forces);
        let [x, y, z] = stress;
        Modes { linear: self.sides.stress([sub(x, p), sub(y, q), sub(z, r)]), ..forces }
    }
}

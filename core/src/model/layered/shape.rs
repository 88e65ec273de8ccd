//! Four cells at rest: even cells of one shape over a flat wall, cells of their own shapes over a curved wall.

use super::cell::Variation;
use super::modes::Modes;
use super::sides::{Oblique, Sides, Skew, Upright};
use wide::f32x4;

/// The rest shape of four cells, in spacings of a grid.
pub(super) trait RestShape: Copy {
    type Sides: Sides<f32x4>;

    fn sides(&self) -> &Self::Sides;

    fn variation(&self) -> &Variation<f32x4>;

    /// The volume over that of an even cell.
    fn weight(&self) -> f32x4;

    /// The modes of a displacement without those of its gradient in the middle of the cell.
    fn removed(&self, modes: Modes<f32x4>) -> Modes<f32x4>;

    /// Forces on the modes of the cell, from the derivatives of the energy per rest volume by its modes without skew.
    fn handed_back(&self, forces: Modes<f32x4>) -> Modes<f32x4>;
}

/// Upright cells of one height and spacing.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Even {
    pub(super) sides: Upright<f32x4>,
    pub(super) variation: Variation<f32x4>,
}

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

impl RestShape for Even {
    type Sides = Upright<f32x4>;

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
        f32x4::ONE
    }

    #[inline(always)]
    fn removed(&self, modes: Modes<f32x4>) -> Modes<f32x4> {
        modes
    }

    #[inline(always)]
    fn handed_back(&self, forces: Modes<f32x4>) -> Modes<f32x4> {
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
    fn removed(&self, modes: Modes<f32x4>) -> Modes<f32x4> {
        self.skew.removed(&self.sides, &modes)
    }

    #[inline(always)]
    fn handed_back(&self, forces: Modes<f32x4>) -> Modes<f32x4> {
        self.skew.handed_back(&self.sides, &forces).weighted(self.weight)
    }
}

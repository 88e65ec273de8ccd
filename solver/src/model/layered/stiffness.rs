//! The diagonal blocks of four cells' stiffness, positive by construction, at the middle of the cells.
//!
//! With g = F⁻ᵀ∇N and t = (α·½∂g/∂F + β·∂J/∂F)∇N of the nodes a and b, and the law's [`Curvature`],
//!
//! K_ab = shear·{½(3/I₁)(∇Nₐ·∇N_b) I + ½min(1, 3/I₁) g_b gₐᵀ − ⅓ gₐ g_bᵀ + variation} + bulk·gₐ g_bᵀ + bend·tₐ t_bᵀ,
//!
//! where a negative bend is bounded.

use super::cell;
use super::deformed::{Deformed, Isochoric, Matrix, combined};
use super::modes::Modes;
use super::shape::RestShape;
use super::sides::Sides;
use crate::mesh::vec3::{Block, Vec3, add_outer, dot, scale};
use crate::springs::solids::{Curvature, SolidLaw, Volume};
use wide::f32x4;

/// Column and row of the corners, counter-clockwise.
pub(super) const CORNERS: [[usize; 2]; 4] = [[0, 0], [1, 0], [1, 1], [0, 1]];

/// What the stiffness of four cells is made of.
pub(super) struct CellStiffness<S> {
    /// J and its derivative along the sides.
    volume: f32x4,
    cofactors: Matrix<f32x4>,
    /// α·½∂g/∂F + β·∂J/∂F along the sides.
    pull: Matrix<f32x4>,
    /// 2W_g.
    shear: f32x4,
    /// Coefficients of I (∇Nₐ·∇N_b), g_b gₐᵀ, gₐ g_bᵀ, tₐ t_bᵀ.
    isotropic: f32x4,
    crossed: f32x4,
    straight: f32x4,
    bend: f32x4,
    /// Isotropic part of what varies inside of the cell: for one node, for a node and the node above.
    variation: [f32x4; 2],
    /// The point of the cell on \[−½, ½\]³.
    at: Vec3,
    sides: S,
}

impl<S: Sides<f32x4>> CellStiffness<S> {
    #[inline(always)]
    pub(super) fn new(
        law: &impl SolidLaw<f32x4>,
        modes: &Modes<f32x4>,
        shape: &impl RestShape<Sides = S>,
        augmented: f32x4,
    ) -> Self {
        let deformed = Deformed::new(shape.sides().gradient(modes.linear));
        let v = shape.variation();
        let iso = deformed.isochoric();
        let g = iso.g + v.mean_square(modes);
        let curvature = law.curvature(g, deformed.volume(), augmented);
        let mut new = Self::of(deformed, &iso, &curvature, *shape.sides());
        let (quarter, half) = (f32x4::splat(0.25), f32x4::HALF);
        let along = v.through * half + v.d;
        new.variation = [
            new.shear * (v.in_plane * quarter + along),
            new.shear * (v.in_plane * quarter - along),
        ];
        new
    }

    /// Of cells with four points: the points' stiffness to changes of shape, a quarter each, and the middle's to changes of volume,
    /// which is that of the mean.
    pub(super) fn at_points(
        law: &impl SolidLaw<f32x4>,
        modes: &Modes<f32x4>,
        shape: &impl RestShape<Sides = S>,
        parity: f32x4,
        augmented: f32x4,
    ) -> [Self; 5] {
        let zero = f32x4::ZERO;
        let (points, volume) = cell::deformed_points(modes, shape.sides(), parity);
        let log = Volume::new(volume).log;
        let quarter = f32x4::splat(0.25);
        let [a, b, c, d] = points.map(|(deformed, at)| {
            let iso = deformed.isochoric();
            // The cell's change of volume at the point's own J.
            let volume = Volume { log, ..deformed.volume() };
            let curvature = law.curvature(iso.g, volume, augmented);
            let mut point = Self::of(deformed, &iso, &curvature, *shape.sides());
            point.straight = -point.shear * f32x4::splat(1.0 / 3.0);
            for part in
                [&mut point.isotropic, &mut point.crossed, &mut point.straight, &mut point.bend]
            {
                *part *= quarter;
            }
            Self { at, ..point }
        });
        let mut middle = Self::new(law, modes, shape, augmented);
        middle.straight += middle.shear * f32x4::splat(1.0 / 3.0);
        (middle.isotropic, middle.crossed, middle.bend) = (zero, zero, zero);
        middle.variation = [zero; 2];
        [a, b, c, d, middle]
    }

    #[inline(always)]
    fn of(
        deformed: Deformed<f32x4>,
        iso: &Isochoric<f32x4>,
        curvature: &Curvature<f32x4>,
        sides: S,
    ) -> Self {
        let Curvature { shear, along, bend, least_bend, bulk, .. } = *curvature;
        let one = f32x4::ONE;
        let relief = f32x4::splat(3.0) / iso.i1;
        let limited = relief.fast_min(one);
        let softening = bend.fast_min(f32x4::ZERO).fast_max(least_bend) * limited;
        Self {
            pull: sides.stress(deformed.stress(iso, along[0], along[1])),
            shear,
            isotropic: shear * f32x4::HALF * relief,
            crossed: shear * f32x4::HALF * limited,
            straight: bulk - shear * f32x4::splat(1.0 / 3.0),
            bend: bend.fast_max(f32x4::ZERO) + softening,
            variation: [f32x4::ZERO; 2],
            at: [f32x4::ZERO; 3],
            volume: deformed.volume,
            cofactors: sides.stress(deformed.cofactors),
            sides,
        }
    }

    /// g, t and ∇N of a node, from the signs of its corner.
    #[inline(always)]
    fn vectors(&self, [sx, sy, sz]: [f32; 3]) -> [Vec3; 3] {
        let half = f32x4::HALF;
        // N is the product of these; its slopes have one factor replaced by the sign.
        let [p, q, r] = [0, 1, 2].map(|axis| self.at[axis] * [sx, sy, sz][axis] + half);
        self.vectors_along([q * r * sx, p * r * sy, p * q * sz])
    }

    /// g, t and ∇N of a node, from the slopes of N along the sides.
    #[inline(always)]
    fn vectors_along(&self, slopes: Vec3) -> [Vec3; 3] {
        let inverse = f32x4::ONE / self.volume.fast_max(f32x4::splat(0.05));
        let g = combined(self.cofactors, slopes.map(|s| s * inverse));
        [g, combined(self.pull, slopes), self.sides.of_scalar(slopes)]
    }

    /// The blocks of the lower node, of the upper node, and of the pair, for a corner; times `weight`.
    #[inline(always)]
    pub(super) fn blocks(&self, sx: f32, sy: f32, weight: f32x4) -> ([Block; 2], [f32x4; 9]) {
        self.blocks_of([-1.0, 1.0].map(|sz| self.vectors([sx, sy, sz])), weight)
    }

    /// The same at the middle of cells, from a corner's part of a face, and its slopes.
    #[inline(always)]
    pub(super) fn blocks_along(&self, [n, x, y]: Vec3, weight: f32x4) -> ([Block; 2], [f32x4; 9]) {
        let half = f32x4::HALF;
        let nodes = [-1.0, 1.0].map(|sz| self.vectors_along([x * half, y * half, n * sz]));
        self.blocks_of(nodes, weight)
    }

    #[inline(always)]
    fn blocks_of(&self, nodes: [[Vec3; 3]; 2], weight: f32x4) -> ([Block; 2], [f32x4; 9]) {
        let (both, bend) = ((self.crossed + self.straight) * weight, self.bend * weight);
        let diagonal = nodes.map(|[g, t, n]| {
            let own = (self.isotropic * dot(n, n) + self.variation[0]) * weight;
            let mut block = [f32x4::ZERO; 6];
            add_outer(&mut block, scale(g, both), g);
            add_outer(&mut block, scale(t, bend), t);
            for part in [0, 3, 5] {
                block[part] += own;
            }
            block
        });
        let [[ga, ta, na], [gb, tb, nb]] = nodes;
        let pair = (self.isotropic * dot(na, nb) + self.variation[1]) * weight;
        let mut above = [f32x4::ZERO; 9];
        let (crossed, straight) = (self.crossed * weight, self.straight * weight);
        for r in 0..3 {
            for c in 0..3 {
                above[3 * r + c] =
                    gb[r] * ga[c] * crossed + ga[r] * gb[c] * straight + ta[r] * tb[c] * bend;
            }
            above[4 * r] += pair;
        }
        (diagonal, above)
    }
}

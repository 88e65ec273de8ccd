//! Elastic bodies over a grid: energy, forces, stiffness.
//!
//! `ElasticModel` is the interface between a body and full multigrid. `membrane`: a sheet of bonded layers
//! without bending stiffness, one node in a column. `layered`: skin on solid layers. `columns`: what a smoother inverts.
//!
//! Uses `number`, `springs`, `mesh`, `contact` (the dome's apex). Used by `solve`, `measure`, the lab and `view`.

pub(crate) mod columns;
pub mod layered;
pub mod membrane;

use crate::mesh::Rest;
use crate::mesh::lanes::{Field, Layout, load, store};
use crate::mesh::vec3::{Block, inverted};
use columns::Stiffness;
use std::sync::Arc;

/// An elastic body over a grid, in four f32 lanes. Lengths are in grid spacings; the stiffness at small
/// strain is one.
pub(crate) trait ElasticModel {
    /// Precomputed geometry and scratch arrays of one grid.
    type Scratch: Clone + std::fmt::Debug;

    /// Diagonal blocks of the stiffness, of nodes or columns.
    type Stiffness: Stiffness;

    /// Nodes in a column through the thickness; the first node lies on the inner face.
    fn layers(&self) -> usize;

    /// The scratch of a grid over a flat wall.
    fn scratch(&self, layout: &Layout) -> Self::Scratch;

    /// Fits the scratch to a grid of the given spacing \[mm\]; `rest` is the tissue at rest on that grid, `None` over a flat
    /// wall.
    fn place(
        &self,
        _layout: &Layout,
        _spacing: f64,
        _rest: Option<&Arc<Rest>>,
        _scratch: &mut Self::Scratch,
    ) {
    }

    /// Fits the scratch to the present growth of the model, and to nothing else.
    fn grow(&self, _layout: &Layout, _rest: Option<&Arc<Rest>>, _scratch: &mut Self::Scratch) {}

    /// Sets `f` to −∂E/∂u; entries of ghost and clamped nodes are unspecified.
    fn forces(&self, layout: &Layout, u: &Field, f: &mut Field, scratch: &mut Self::Scratch);

    /// Sets `blocks` to the diagonal blocks of the stiffness, without negative modes; entries of nodes
    /// that are not free are unspecified.
    fn blocks(
        &self,
        layout: &Layout,
        u: &Field,
        blocks: &mut Self::Stiffness,
        scratch: &mut Self::Scratch,
    );

    /// The tension of the body: scale of residuals.
    fn tension(&self, layout: &Layout, u: &Field, scratch: &mut Self::Scratch) -> Tension;

    /// Renews what stands for constraints of the model, such as the pressure of nearly incompressible tissue, after a cycle.
    fn renew(&self, _layout: &Layout, _u: &Field, _scratch: &mut Self::Scratch) {}

    /// Discards what [`Self::renew`] has renewed.
    fn forget(&self, _scratch: &mut Self::Scratch) {}

    /// Mixes what [`Self::renew`] renews as the displacements of the last cycles are mixed: p ← p − θ₁(p − p′) − θ₂(p − p″), p′ and p″
    /// those before the last two mixings; a factor without that many mixings is zero.
    fn mix(&self, _scratch: &mut Self::Scratch, _thetas: [f32; 2]) {}

    /// Interpolates what [`Self::renew`] renews to a grid of half the spacing.
    fn hand_on(
        &self,
        _coarse: (&Layout, &Self::Scratch),
        _layout: &Layout,
        _scratch: &mut Self::Scratch,
    ) {
    }

    /// The stiffness at small strain \[kPa·mm\]: the unit of stresses times lengths.
    fn stiffness(&self) -> f64;

    /// Does the model support contact offsets? Without offsets contact ends at the last active node.
    fn has_contact_offsets(&self) -> bool;
}

/// The tension of a body.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tension {
    /// Sum of squares of the cells' forces: the scale of residuals.
    pub(crate) squares: f64,
    /// Is a cell inverted?
    pub(crate) has_inverted_cell: bool,
}

/// A symmetric 3×3 block at every stored node: arrays of xx, xy, xz, yy, yz, zz.
#[derive(Clone, Debug)]
pub(crate) struct NodeBlocks {
    pub(crate) parts: [Vec<f32>; 6],
}

impl NodeBlocks {
    pub(crate) fn zeros(length: usize) -> Self {
        Self { parts: [0; 6].map(|_| vec![0.0; length]) }
    }

    pub(crate) fn fill_zero(&mut self) {
        for part in &mut self.parts {
            part.fill(0.0);
        }
    }

    /// The blocks of four neighbouring nodes.
    #[inline(always)]
    pub(crate) fn load(&self, k: usize) -> Block {
        [0, 1, 2, 3, 4, 5].map(|p| load(&self.parts[p], k))
    }

    /// Adds to the blocks of four neighbouring nodes.
    #[inline(always)]
    pub(crate) fn add(&mut self, k: usize, block: Block) {
        for (part, lanes) in self.parts.iter_mut().zip(block) {
            let total = load(part, k) + lanes;
            store(part, k, total);
        }
    }

    /// The product of a node's block with a vector.
    #[inline(always)]
    pub(crate) fn times(&self, k: usize, [x, y, z]: [f32; 3]) -> [f32; 3] {
        let [xx, xy, xz, yy, yz, zz] = [0, 1, 2, 3, 4, 5].map(|p| self.parts[p][k]);
        [xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z]
    }

    /// Inverts the block of every free node; sets the other blocks to zero.
    pub(crate) fn invert(&mut self, layout: &Layout) {
        let mut last = 0;
        layout.free_groups(|group| {
            let (k, count) = (group.first, group.count);
            if group.is_row_start {
                for part in &mut self.parts {
                    part[last..k].fill(0.0);
                }
            }
            let inverse = inverted(self.load(k));
            for (part, lanes) in self.parts.iter_mut().zip(inverse) {
                if count == 4 {
                    store(part, k, lanes);
                } else {
                    part[k..k + count].copy_from_slice(&lanes.to_array()[..count]);
                }
            }
            last = k + count;
        });
        for part in &mut self.parts {
            part[last..].fill(0.0);
        }
    }
}

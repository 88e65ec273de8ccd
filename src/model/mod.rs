//! Elastic bodies over a grid: energy, forces, stiffness.
//!
//! [`ElasticModel`] is a body as full multigrid sees it. `membrane`: a sheet of bonded layers without
//! bending stiffness, one node in a column.
//!
//! Uses `springs`, `mesh`. Used by `solve` and `measure`.

pub(crate) mod membrane;

use crate::mesh::lanes::{BorderTriangle, Field, Layout, load, store};
use crate::mesh::vec3::{Block, inverted};

/// An elastic body over a grid, in four f32 lanes. Lengths are in grid spacings; the stiffness at small
/// strain is one.
pub(crate) trait ElasticModel {
    /// What one grid needs besides its layout: precomputed geometry and scratch.
    type Scratch: Clone + std::fmt::Debug;

    /// Nodes of a column through the thickness; the first one is on the inner face.
    const LAYERS: usize;

    /// The scratch of a grid with these triangles at the border.
    fn scratch(layout: &Layout, border: &[BorderTriangle]) -> Self::Scratch;

    /// Sets `f` to −∂E/∂u; entries of ghost and clamped nodes are unspecified.
    fn forces(&self, layout: &Layout, u: &Field, f: &mut Field, scratch: &mut Self::Scratch);

    /// Sets `blocks` to the diagonal 3×3 blocks of the stiffness, without negative modes; entries of nodes
    /// that are not free are unspecified.
    fn blocks(
        &self,
        layout: &Layout,
        u: &Field,
        blocks: &mut NodeBlocks,
        scratch: &mut Self::Scratch,
    );

    /// The tension of the body: the scale of residuals, and the most compressive one.
    fn tension(&self, layout: &Layout, u: &Field, scratch: &mut Self::Scratch) -> Tension;

    /// Does contact end between nodes? Else at the last node that touches.
    fn has_contact_offsets(&self) -> bool;
}

/// The tension of a body.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tension {
    /// Sum of squares of the forces that cells exert: the scale of residuals.
    pub(crate) squares: f64,
    /// The most compressive tension, zero where the body is in tension everywhere.
    pub(crate) least: f32,
}

/// Compression that counts, as a fraction of the mean tension \[-\].
pub(crate) const COMPRESSIVE: f64 = 1e-2;

impl Tension {
    /// Is the compression more than a fraction of the mean tension over so many nodes? The body may wrinkle
    /// there.
    pub(crate) fn is_compressive(&self, nodes: usize) -> bool {
        f64::from(self.least).powi(2) * nodes as f64 > COMPRESSIVE * COMPRESSIVE * self.squares
    }
}

/// A symmetric 3×3 block at every stored node: arrays of xx, xy, xz, yy, yz, zz.
#[derive(Clone, Debug)]
pub(crate) struct NodeBlocks {
    pub(crate) parts: [Vec<f32>; 6],
}

impl NodeBlocks {
    pub(crate) fn new(length: usize) -> Self {
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

    /// Inverts the block of every free node; the others get zero.
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

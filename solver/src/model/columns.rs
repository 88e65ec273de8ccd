//! Diagonal blocks of the stiffness: of a node, or of a column of nodes through the thickness.

use super::NodeBlocks;
use crate::mesh::lanes::{Layout, load};
use crate::mesh::rest::MAX_LAYERS;
use crate::mesh::vec3::{Block, Vec3, add, inverted, scale, sub, times};
use wide::f32x4;

/// The part of the stiffness that a smoother inverts.
pub(crate) trait Stiffness: Clone + std::fmt::Debug {
    /// Zeros for `length` stored nodes in each of `layers` layers.
    fn new(length: usize, layers: usize) -> Self;

    /// Inverts the part of every free node; sets other nodes to zero.
    fn invert(&mut self, layout: &Layout);

    /// The inverse blocks of the inner face, the nodes above being free to follow.
    fn inner(&self) -> &NodeBlocks;

    /// The step of four neighbouring columns. `residual` returns the residual at an index of a field; `inner` turns
    /// the residual and the inverse block of the inner face into that face's step; `outer` receives the index and the
    /// step of every other node, `omega` times the exact solution where the inner face's step is.
    fn solve(
        &self,
        k: usize,
        omega: f32,
        residual: impl Fn(usize) -> Vec3,
        inner: impl FnOnce(Vec3, Block) -> Vec3,
        outer: impl FnMut(usize, Vec3),
    );
}

impl Stiffness for NodeBlocks {
    fn new(length: usize, _layers: usize) -> Self {
        Self::zeros(length)
    }

    fn invert(&mut self, layout: &Layout) {
        NodeBlocks::invert(self, layout);
    }

    fn inner(&self) -> &NodeBlocks {
        self
    }

    #[inline(always)]
    fn solve(
        &self,
        k: usize,
        _omega: f32,
        residual: impl Fn(usize) -> Vec3,
        inner: impl FnOnce(Vec3, Block) -> Vec3,
        _outer: impl FnMut(usize, Vec3),
    ) {
        inner(residual(k), self.load(k));
    }
}

/// The block-tridiagonal stiffness of columns; its inverse by elimination from the skin inwards.
#[derive(Clone, Debug)]
pub(crate) struct ColumnBlocks {
    /// Diagonal blocks D of all nodes, then S⁻¹ with Sₖ = Dₖ − Eₖ Sₖ₊₁⁻¹ Eₖᵀ.
    pub(crate) diagonal: NodeBlocks,
    /// Blocks E of a node and the node above, row by row, then G = Sₖ₊₁⁻¹ Eₖᵀ.
    pub(crate) above: [Vec<f32>; 9],
    /// The greatest change of a cell's height in one step, of each layer of cells \[spacings\].
    pub(crate) limits: [f32; MAX_LAYERS],
    length: usize,
    layers: usize,
}

type Full = [[f32x4; 3]; 3];

/// The product of a full block and a vector.
#[inline(always)]
fn product(block: &Full, v: Vec3) -> Vec3 {
    block.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

/// The product of the transpose of a full block and a vector.
#[inline(always)]
fn transposed_product(block: &Full, v: Vec3) -> Vec3 {
    add(add(scale(block[0], v[0]), scale(block[1], v[1])), scale(block[2], v[2]))
}

impl ColumnBlocks {
    pub(crate) fn fill_zero(&mut self) {
        self.diagonal.fill_zero();
        for part in &mut self.above {
            part.fill(0.0);
        }
    }

    #[inline(always)]
    fn above(&self, k: usize) -> Full {
        let part = |p: usize| load(&self.above[p], k);
        [[part(0), part(1), part(2)], [part(3), part(4), part(5)], [part(6), part(7), part(8)]]
    }
}

/// Stores the first lanes of a value.
#[inline(always)]
fn store(values: &mut [f32], k: usize, count: usize, lanes: f32x4) {
    values[k..k + count].copy_from_slice(&lanes.to_array()[..count]);
}

impl Stiffness for ColumnBlocks {
    fn new(length: usize, layers: usize) -> Self {
        Self {
            diagonal: NodeBlocks::zeros(length * layers),
            above: [0; 9].map(|_| vec![0.0; length * (layers - 1)]),
            limits: [0.0; MAX_LAYERS],
            length,
            layers,
        }
    }

    fn invert(&mut self, layout: &Layout) {
        let (length, layers) = (self.length, self.layers);
        let mut last = 0;
        layout.free_groups(|group| {
            let (k, count) = (group.first, group.count);
            if group.is_row_start {
                self.clear(last, k);
            }
            last = k + count;
            let mut schur = self.diagonal.load(k + (layers - 1) * length);
            for layer in (0..layers).rev() {
                let at = k + layer * length;
                let inverse = inverted(schur);
                for (part, lanes) in self.diagonal.parts.iter_mut().zip(inverse) {
                    store(part, at, count, lanes);
                }
                if layer == 0 {
                    break;
                }
                let below = at - length;
                let e = self.above(below);
                // Columns of G = S⁻¹ Eᵀ are S⁻¹ times the rows of E.
                let columns = e.map(|row| times(inverse, row));
                schur = self.diagonal.load(below);
                // E G, symmetric: entry (r, c) is row r of E times column c of G.
                let entry = |r: usize, c: usize| {
                    e[r][0] * columns[c][0] + e[r][1] * columns[c][1] + e[r][2] * columns[c][2]
                };
                for (part, (r, c)) in
                    [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].into_iter().enumerate()
                {
                    schur[part] -= entry(r, c);
                }
                for r in 0..3 {
                    for (c, column) in columns.iter().enumerate() {
                        store(&mut self.above[3 * r + c], below, count, column[r]);
                    }
                }
            }
        });
        self.clear(last, length);
    }

    fn inner(&self) -> &NodeBlocks {
        &self.diagonal
    }

    #[inline(always)]
    fn solve(
        &self,
        k: usize,
        omega: f32,
        residual: impl Fn(usize) -> Vec3,
        inner: impl FnOnce(Vec3, Block) -> Vec3,
        mut outer: impl FnMut(usize, Vec3),
    ) {
        let mut reduced = [[f32x4::ZERO; 3]; MAX_LAYERS];
        let mut above = [f32x4::ZERO; 3];
        for layer in (0..self.layers).rev() {
            let at = k + layer * self.length;
            let mut r = residual(at);
            if layer + 1 < self.layers {
                r = sub(r, transposed_product(&self.above(at), above));
            }
            reduced[layer] = r;
            above = r;
        }
        let mut step = inner(reduced[0], self.diagonal.load(k));
        for layer in 1..self.layers {
            let at = k + layer * self.length;
            let own = scale(times(self.diagonal.load(at), reduced[layer]), f32x4::splat(omega));
            let next = sub(own, product(&self.above(at - self.length), step));
            let most = f32x4::splat(self.limits[layer - 1]);
            step = [0, 1, 2].map(|a| step[a] + (next[a] - step[a]).fast_max(-most).fast_min(most));
            outer(at, step);
        }
    }
}

impl ColumnBlocks {
    /// Sets the stored nodes of a range to zero, in every layer.
    fn clear(&mut self, from: usize, to: usize) {
        for layer in 0..self.layers {
            let range = from + layer * self.length..to + layer * self.length;
            for part in &mut self.diagonal.parts {
                part[range.clone()].fill(0.0);
            }
            if layer + 1 < self.layers {
                for part in &mut self.above {
                    part[range.clone()].fill(0.0);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The step of a column without contact solves the block-tridiagonal system.
    #[test]
    fn a_column_is_solved_exactly() {
        let layout = Layout::new(9, [false; 2]);
        let layers = 3;
        let length = layout.len();
        let mut blocks = ColumnBlocks::new(length, layers);
        blocks.limits = [1e9; MAX_LAYERS];
        let number = |k: usize| ((k * 7919 % 101) as f32 / 101.0) - 0.5;
        for (p, part) in blocks.diagonal.parts.iter_mut().enumerate() {
            for (k, value) in part.iter_mut().enumerate() {
                *value = if [0, 3, 5].contains(&p) { 4.0 } else { 0.3 } + 0.2 * number(k + 13 * p);
            }
        }
        for (p, part) in blocks.above.iter_mut().enumerate() {
            for (k, value) in part.iter_mut().enumerate() {
                *value = number(3 * k + p);
            }
        }
        let before = blocks.clone();
        blocks.invert(&layout);
        let r = |at: usize| {
            [0, 1, 2].map(|a| f32x4::from([0, 1, 2, 3].map(|l| number(5 * at + a + l))))
        };
        let k = 4 * layout.pitch + 2;
        let mut steps = vec![[f32x4::ZERO; 3]; layers];
        let mut inner = [f32x4::ZERO; 3];
        blocks.solve(
            k,
            1.0,
            r,
            |r, inverse| {
                inner = times(inverse, r);
                inner
            },
            |at, step| steps[(at - k) / length] = step,
        );
        steps[0] = inner;
        for layer in 0..layers {
            let at = k + layer * length;
            let mut sum = times(before.diagonal.load(at), steps[layer]);
            if layer + 1 < layers {
                sum = add(sum, product(&before.above(at), steps[layer + 1]));
            }
            if layer > 0 {
                sum = add(sum, transposed_product(&before.above(at - length), steps[layer - 1]));
            }
            for (sum, r) in sum.into_iter().zip(r(at)) {
                for (sum, r) in sum.to_array().into_iter().zip(r.to_array()) {
                    assert!((sum - r).abs() < 1e-4, "{layer}: {sum} {r}");
                }
            }
        }
    }
}

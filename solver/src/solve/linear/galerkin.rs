//! A V-cycle for the linear systems inside a Newton step: bilinear interpolation on the grid's
//! indices, Galerkin coarse operators, symmetric block Gauss–Seidel. Symmetric positive definite,
//! so that it preconditions conjugate gradients.
//!
//! Constrained directions of the finest grid (clamped nodes, normals of active nodes) are removed from its
//! interpolation: truncated multigrid (R. Kornhuber, "Monotone multigrid methods
//! for elliptic variational inequalities I", Numer. Math. 69, 1994).

use crate::mesh::stencil::{BlockStencil9, OFFSETS};
use glam::{DMat3, DVec3};

/// Cells a side below which a grid is solved by sweeps alone.
const COARSEST_CELLS: usize = 8;
const COARSEST_SWEEPS: usize = 8;
/// Finest nodes in one piece of [`Hierarchy::build`].
const NODES_PER_PIECE: usize = 8192;

/// The coarse grids below a finest grid.
#[derive(Clone, Debug)]
pub(crate) struct Hierarchy {
    levels: Vec<Level>,
}

/// One coarse grid with its operator and scratch.
#[derive(Clone, Debug)]
struct Level {
    blocks: BlockStencil9,
    inverse: Vec<DMat3>,
    free: Vec<u32>,
    is_free: Vec<bool>,
    rhs: Vec<DVec3>,
    x: Vec<DVec3>,
    residual: Vec<DVec3>,
}

/// Operators of the finest grid. Arrays of shape (n², ).
pub(crate) struct Finest<'a> {
    pub(crate) blocks: &'a BlockStencil9,
    /// Inverse of the diagonal block in the unconstrained directions, zero in the others.
    pub(crate) inverse: &'a [DMat3],
    /// The projector onto the unconstrained directions; zero at nodes that are not free.
    pub(crate) projector: &'a [DMat3],
    pub(crate) free: &'a [u32],
}

impl Hierarchy {
    /// Allocates the grids below a grid of n nodes a side with the given free nodes.
    pub(crate) fn new(n: usize, free: &[u32]) -> Self {
        let mut levels: Vec<Level> = Vec::new();
        let mut fine_n = n;
        let mut fine_free = vec![false; n * n];
        free.iter().for_each(|&k| fine_free[k as usize] = true);
        while (fine_n - 1).is_multiple_of(2) && (fine_n - 1) / 2 >= COARSEST_CELLS / 2 {
            let coarse_n = (fine_n - 1) / 2 + 1;
            let is_free: Vec<bool> = (0..coarse_n * coarse_n)
                .map(|k| fine_free[2 * (k / coarse_n) * fine_n + 2 * (k % coarse_n)])
                .collect();
            levels.push(Level::new(coarse_n, is_free.clone()));
            (fine_n, fine_free) = (coarse_n, is_free);
        }
        Self { levels }
    }

    /// Computes a piece of the coarse operators PᵀHP: pieces 0, 1, … until the function returns true.
    pub(crate) fn build(&mut self, finest: &Finest, piece: usize) -> bool {
        let Some((first, others)) = self.levels.split_first_mut() else { return true };
        let from = piece * NODES_PER_PIECE;
        if from < finest.free.len() {
            if piece == 0 {
                first.blocks.clear();
            }
            let nodes = &finest.free[from..finest.free.len().min(from + NODES_PER_PIECE)];
            let projector = Some(finest.projector);
            galerkin(finest.blocks, nodes, projector, &first.is_free, &mut first.blocks);
            return false;
        }
        let mut fine = &mut *first;
        for level in others {
            level.blocks.clear();
            galerkin(&fine.blocks, &fine.free, None, &level.is_free, &mut level.blocks);
            fine = level;
        }
        for level in &mut self.levels {
            for &k in &level.free {
                let k = k as usize;
                level.inverse[k] = safe_inverse(level.blocks.diagonal[k]);
            }
        }
        true
    }

    /// One V-cycle: `x` ≈ H⁻¹ `rhs` in the unconstrained directions. `residual` is scratch.
    pub(crate) fn cycle(
        &mut self,
        finest: &Finest,
        rhs: &[DVec3],
        x: &mut [DVec3],
        residual: &mut [DVec3],
    ) {
        x.fill(DVec3::ZERO);
        sweep(finest.blocks, finest.inverse, finest.free.iter(), rhs, x);
        if self.levels.is_empty() {
            sweep(finest.blocks, finest.inverse, finest.free.iter().rev(), rhs, x);
            return;
        }
        for &k in finest.free {
            let k = k as usize;
            residual[k] = finest.projector[k] * (rhs[k] - finest.blocks.row(k, x));
        }
        let n = finest.blocks.n;
        self.levels[0].restrict_from(n, residual);
        self.descend(0);
        self.levels[0].interpolate_to(n, finest.free, |k, correction| {
            x[k] += finest.projector[k] * correction;
        });
        sweep(finest.blocks, finest.inverse, finest.free.iter().rev(), rhs, x);
    }

    fn descend(&mut self, l: usize) {
        let (upper, below) = self.levels.split_at_mut(l + 1);
        let level = &mut upper[l];
        level.x.fill(DVec3::ZERO);
        if below.is_empty() {
            for _ in 0..COARSEST_SWEEPS {
                sweep(&level.blocks, &level.inverse, level.free.iter(), &level.rhs, &mut level.x);
                let back = level.free.iter().rev();
                sweep(&level.blocks, &level.inverse, back, &level.rhs, &mut level.x);
            }
            return;
        }
        sweep(&level.blocks, &level.inverse, level.free.iter(), &level.rhs, &mut level.x);
        for &k in &level.free {
            let k = k as usize;
            level.residual[k] = level.rhs[k] - level.blocks.row(k, &level.x);
        }
        below[0].restrict_from(level.blocks.n, &level.residual);
        self.descend(l + 1);
        let (upper, below) = self.levels.split_at_mut(l + 1);
        let level = &mut upper[l];
        below[0].interpolate_to(level.blocks.n, &level.free, |k, correction| {
            level.x[k] += correction;
        });
        let back = level.free.iter().rev();
        sweep(&level.blocks, &level.inverse, back, &level.rhs, &mut level.x);
    }
}

impl Level {
    fn new(n: usize, is_free: Vec<bool>) -> Self {
        let free = (0..n * n).filter(|&k| is_free[k]).map(|k| k as u32).collect();
        let zeros = || vec![DVec3::ZERO; n * n];
        Self {
            blocks: BlockStencil9::new(n),
            inverse: vec![DMat3::ZERO; n * n],
            free,
            is_free,
            rhs: zeros(),
            x: zeros(),
            residual: zeros(),
        }
    }

    /// rhs = Pᵀ fine residual; the fine residual is zero at nodes that are not free.
    fn restrict_from(&mut self, fine_n: usize, fine: &[DVec3]) {
        let n = self.blocks.n;
        for &k in &self.free {
            let k = k as usize;
            let f = 2 * (k / n) * fine_n + 2 * (k % n);
            let edges = fine[f - 1] + fine[f + 1] + fine[f - fine_n] + fine[f + fine_n];
            let corners = fine[f - fine_n - 1]
                + fine[f - fine_n + 1]
                + fine[f + fine_n - 1]
                + fine[f + fine_n + 1];
            self.rhs[k] = fine[f] + 0.5 * edges + 0.25 * corners;
        }
    }

    /// Calls `add` with every free fine node and the bilinear interpolation of x there.
    fn interpolate_to(&self, fine_n: usize, fine_free: &[u32], mut add: impl FnMut(usize, DVec3)) {
        let n = self.blocks.n;
        for &k in fine_free {
            let k = k as usize;
            let (i, j) = (k % fine_n, k / fine_n);
            let (low, right, up) = (j / 2 * n + i / 2, i % 2, (j % 2) * n);
            let x = &self.x;
            add(k, 0.25 * (x[low] + x[low + right] + x[low + up] + x[low + up + right]));
        }
    }
}

/// One Gauss–Seidel sweep over the given nodes.
fn sweep<'a>(
    blocks: &BlockStencil9,
    inverse: &[DMat3],
    nodes: impl Iterator<Item = &'a u32>,
    rhs: &[DVec3],
    x: &mut [DVec3],
) {
    for &k in nodes {
        let k = k as usize;
        x[k] = inverse[k] * (rhs[k] - blocks.off_diagonal(k, x));
    }
}

/// The inverse of a positive semidefinite block, regularised where the block is singular.
pub(crate) fn safe_inverse(block: DMat3) -> DMat3 {
    let trace = block.x_axis.x + block.y_axis.y + block.z_axis.z;
    if !(trace > 0.0 && trace.is_finite()) {
        return DMat3::ZERO;
    }
    let shifted = block + DMat3::from_diagonal(DVec3::splat(1e-9 * trace));
    let inverse = shifted.inverse();
    if inverse.is_finite() { inverse } else { DMat3::from_diagonal(DVec3::splat(1.0 / trace)) }
}

/// Coarse nodes that a fine index interpolates from along one axis, with their weights.
#[inline]
fn parents(index: usize) -> ([usize; 2], [f64; 2], usize) {
    let low = index / 2;
    if index.is_multiple_of(2) {
        ([low, low], [1.0, 0.0], 1)
    } else {
        ([low, low + 1], [0.5, 0.5], 2)
    }
}

/// coarse += Pᵀ Π H Π P for the stored half of the stencil, the rows of the given nodes.
fn galerkin(
    fine: &BlockStencil9,
    free: &[u32],
    projector: Option<&[DMat3]>,
    coarse_free: &[bool],
    coarse: &mut BlockStencil9,
) {
    let (n, nc) = (fine.n, coarse.n);
    let strides = BlockStencil9::strides(n);
    for &a in free {
        let a = a as usize;
        let (i, j) = (a % n, a / n);
        let mut add = |b: usize, to: (usize, usize), block: &DMat3| {
            let mut block = *block;
            if let Some(projector) = projector {
                block = projector[a] * block * projector[b];
            }
            spread((i, j), to, a == b, &block, nc, coarse_free, coarse);
        };
        add(a, (i, j), &fine.diagonal[a]);
        for ((stride, (di, dj)), blocks) in strides.into_iter().zip(OFFSETS).zip(&fine.upper) {
            let b = a + stride;
            let to = (i.wrapping_add_signed(di), j.wrapping_add_signed(dj));
            add(b, to, &blocks[a]);
        }
    }
}

/// Adds a fine block H(a, b) (and, off the diagonal, its transpose H(b, a)) to the coarse stencil.
#[inline]
fn spread(
    from: (usize, usize),
    to: (usize, usize),
    is_diagonal: bool,
    block: &DMat3,
    nc: usize,
    coarse_free: &[bool],
    coarse: &mut BlockStencil9,
) {
    let ((ai, wai, nai), (aj, waj, naj)) = (parents(from.0), parents(from.1));
    let ((bi, wbi, nbi), (bj, wbj, nbj)) = (parents(to.0), parents(to.1));
    for p in 0..naj {
        for q in 0..nai {
            let a = aj[p] * nc + ai[q];
            if !coarse_free[a] {
                continue;
            }
            for r in 0..nbj {
                for s in 0..nbi {
                    let b = bj[r] * nc + bi[s];
                    if !coarse_free[b] {
                        continue;
                    }
                    let weight = waj[p] * wai[q] * wbj[r] * wbi[s];
                    let column = bi[s] as isize - ai[q] as isize;
                    let row = bj[r] as isize - aj[p] as isize;
                    add_coarse(coarse, a, b, (column, row), *block * weight, is_diagonal);
                }
            }
        }
    }
}

#[inline]
fn add_coarse(
    coarse: &mut BlockStencil9,
    a: usize,
    b: usize,
    offset: (isize, isize),
    block: DMat3,
    is_diagonal: bool,
) {
    if offset == (0, 0) {
        coarse.diagonal[a] += if is_diagonal { block } else { block + block.transpose() };
        return;
    }
    let is_stored = offset.1 > 0 || (offset.1 == 0 && offset.0 > 0);
    if is_stored {
        if let Some(place) = OFFSETS.iter().position(|o| *o == offset) {
            coarse.upper[place][a] += block;
        }
    } else if !is_diagonal {
        let back = (-offset.0, -offset.1);
        if let Some(place) = OFFSETS.iter().position(|o| *o == back) {
            coarse.upper[place][b] += block.transpose();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A shifted Laplacian in every direction, as blocks, on the inner nodes of a square.
    fn laplacian(n: usize) -> (BlockStencil9, Vec<u32>) {
        let mut blocks = BlockStencil9::new(n);
        let mut free = Vec::new();
        for k in 0..n * n {
            let (i, j) = (k % n, k / n);
            if (1..n - 1).contains(&i) && (1..n - 1).contains(&j) {
                free.push(k as u32);
            }
            blocks.diagonal[k] = DMat3::IDENTITY * 4.0;
            blocks.upper[0][k] = -DMat3::IDENTITY;
            blocks.upper[1][k] = -DMat3::IDENTITY;
        }
        (blocks, free)
    }

    fn free_projector(n: usize, free: &[u32]) -> Vec<DMat3> {
        let mut projector = vec![DMat3::ZERO; n * n];
        free.iter().for_each(|&k| projector[k as usize] = DMat3::IDENTITY);
        projector
    }

    #[test]
    fn coarse_operators_are_the_energy_of_interpolated_vectors() {
        let n = 17;
        let (mut blocks, free) = laplacian(n);
        for k in 0..n * n {
            // An asymmetric part of the off-diagonal blocks.
            let t = k as f64;
            blocks.upper[2][k] = DMat3::from_cols_array(&[
                t.sin(),
                0.3,
                0.0,
                0.1,
                t.cos(),
                0.2,
                0.0,
                (2.0 * t).sin(),
                0.5,
            ]);
            blocks.upper[3][k] = DMat3::IDENTITY * (3.0 * t).cos();
        }
        let mut hierarchy = Hierarchy::new(n, &free);
        let projector = free_projector(n, &free);
        let finest =
            Finest { blocks: &blocks, inverse: &projector, projector: &projector, free: &free };
        let _ = (0..).find(|&piece| hierarchy.build(&finest, piece));
        let level = &mut hierarchy.levels[0];
        for &k in &level.free {
            let t = f64::from(k);
            level.x[k as usize] = DVec3::new((1.7 * t).sin(), (2.3 * t).cos(), (0.9 * t).sin());
        }
        let coarse: f64 = level
            .free
            .iter()
            .map(|&k| level.x[k as usize].dot(level.blocks.row(k as usize, &level.x)))
            .sum();
        let mut v = vec![DVec3::ZERO; n * n];
        level.interpolate_to(n, &free, |k, x| v[k] = x);
        let fine: f64 = free.iter().map(|&k| v[k as usize].dot(blocks.row(k as usize, &v))).sum();
        assert!((coarse - fine).abs() < 1e-10 * fine.abs(), "{coarse} {fine}");
    }

    #[test]
    fn a_cycle_shrinks_the_error_at_a_rate_that_does_not_depend_on_the_grid() {
        for n in [17, 33, 65] {
            let (blocks, free) = laplacian(n);
            let mut hierarchy = Hierarchy::new(n, &free);
            let inverse: Vec<DMat3> = blocks.diagonal.iter().map(|d| safe_inverse(*d)).collect();
            let projector = free_projector(n, &free);
            let finest =
                Finest { blocks: &blocks, inverse: &inverse, projector: &projector, free: &free };
            let _ = (0..).find(|&piece| hierarchy.build(&finest, piece));
            let mut error = vec![DVec3::ZERO; n * n];
            for &k in &free {
                error[k as usize] = DVec3::new((7.3 * f64::from(k)).sin(), 1.0, 0.5);
            }
            let norm = |v: &[DVec3]| v.iter().map(|x| x.length_squared()).sum::<f64>().sqrt();
            let (mut rhs, mut x, mut scratch) = (error.clone(), error.clone(), error.clone());
            let start = norm(&error);
            for _ in 0..5 {
                for &k in &free {
                    rhs[k as usize] = blocks.row(k as usize, &error);
                }
                hierarchy.cycle(&finest, &rhs, &mut x, &mut scratch);
                for k in 0..n * n {
                    error[k] -= x[k];
                }
            }
            let rate = (norm(&error) / start).powf(0.2);
            assert!(rate < 0.2, "{n}: {rate}");
        }
    }
}

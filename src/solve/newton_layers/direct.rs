//! The step from a factorised matrix in place of conjugate gradients: assembles the second derivatives in the unconstrained
//! directions.
//!
//! The matrix is P H P + s(I − P), P being the projector of the inner face: its pattern does not depend on the active set. Over a
//! centred dome the unknowns are those of a quarter of the patch, over a dome moved along an axis those of half.

use super::{FREE, Newton, Phase};
use crate::mesh::stencil::OFFSETS;
use crate::solve::linear::factorization::{Factorization, LowerTriangle};
use glam::{DMat3, DVec3};

/// First shift of a matrix that is not positive definite \[mean diagonal\], and ratio of two shifts.
const SHIFT: (f64, f64) = (1e-2, 10.0);
/// Greatest number of shifts.
const MAX_SHIFTS: u32 = 5;
/// An unknown that does not exist: of a fixed node, or across a plane of symmetry.
const NONE: u32 = u32::MAX;

/// The assembled matrix and its factorisation.
pub(super) struct Direct {
    factorization: Box<dyn Factorization>,
    matrix: LowerTriangle,
    /// Unknowns along x, y and z of each node, shape (layers × nodes, ).
    unknowns: Vec<[u32; 3]>,
    /// The node of the simulated part that mirrors to a node, and the signs of its components.
    mirror_image: Vec<(u32, DVec3)>,
    /// The first entry of a node's rows in each column of another node, for 27 neighbours; shape (layers × nodes, 27).
    entries: Vec<[[u32; 3]; 27]>,
    /// Nodes per side, nodes of a layer.
    n: usize,
    size: usize,
    mirrored: [bool; 2],
    solution: Vec<f64>,
}

impl Direct {
    /// Finds the pattern of a grid; `free` nodes of a layer move.
    pub(super) fn new(
        factorization: Box<dyn Factorization>,
        n: usize,
        layers: usize,
        free: &[u32],
        mirrored: [bool; 2],
    ) -> Self {
        let (size, half) = (n * n, n / 2);
        let mirror_image: Vec<(u32, DVec3)> = (0..size)
            .map(|k| {
                let mut at = [k % n, k / n];
                let mut signs = DVec3::ONE;
                for axis in 0..2 {
                    if mirrored[axis] && at[axis] < half {
                        at[axis] = n - 1 - at[axis];
                        signs[axis] = -1.0;
                    }
                }
                ((at[1] * n + at[0]) as u32, signs)
            })
            .collect();
        let mut unknowns = vec![[NONE; 3]; layers * size];
        let mut places = Vec::new();
        // Column by column of the tissue.
        for &k in free {
            let k = k as usize;
            let at = [k % n, k / n];
            if mirror_image[k].0 as usize != k {
                continue;
            }
            for layer in 0..layers {
                for axis in 0..3 {
                    if axis < 2 && mirrored[axis] && at[axis] == half {
                        continue;
                    }
                    unknowns[layer * size + k][axis] = places.len() as u32;
                    places.push(at);
                }
            }
        }
        let mut new = Self {
            factorization,
            solution: vec![0.0; places.len()],
            matrix: LowerTriangle { places, ..LowerTriangle::default() },
            entries: vec![[[NONE; 3]; 27]; unknowns.len()],
            unknowns,
            mirror_image,
            n,
            size,
            mirrored,
        };
        new.find_pattern(layers, free);
        new
    }

    fn find_pattern(&mut self, layers: usize, free: &[u32]) {
        let Self { matrix, unknowns, entries, n, size, .. } = self;
        for &k in free {
            let k = k as usize;
            for layer in 0..layers {
                let node = layer * *size + k;
                // Neighbours in the order of their unknowns.
                let mut neighbours: Vec<(u32, usize, usize)> = Vec::new();
                for slot in 0..27 {
                    let [di, dj, dl] = [slot % 3, slot / 3 % 3, slot / 9];
                    let Some(l) = (layer + dl).checked_sub(1).filter(|l| *l < layers) else {
                        continue;
                    };
                    let other = l * *size + k + di + dj * *n - 1 - *n;
                    let first = unknowns[other].into_iter().min().unwrap_or(NONE);
                    if first != NONE {
                        neighbours.push((first, slot, other));
                    }
                }
                neighbours.sort_unstable();
                for axis in 0..3 {
                    let column = unknowns[node][axis];
                    if column == NONE {
                        continue;
                    }
                    matrix.starts.push(matrix.rows.len());
                    for &(_, slot, other) in &neighbours {
                        let mut is_first = true;
                        for row in unknowns[other].into_iter().filter(|&row| row != NONE) {
                            if row < column {
                                continue;
                            }
                            if is_first {
                                entries[node][slot][axis] = matrix.rows.len() as u32;
                                is_first = false;
                            }
                            matrix.rows.push(row as usize);
                        }
                    }
                }
            }
        }
        matrix.starts.push(matrix.rows.len());
        matrix.values = vec![0.0; matrix.rows.len()];
    }

    /// Adds a block of two nodes, (layer, node) of the simulated part.
    fn add(&mut self, [(row_layer, row), (layer, column)]: [(usize, usize); 2], block: &DMat3) {
        let Self { matrix, unknowns, entries, n, size, .. } = self;
        let node = layer * *size + column;
        let slot = (row + 1 + *n - column) % *n + (row + 1 + *n - column) / *n * 3;
        let slot = slot + 9 * (row_layer + 1 - layer);
        let rows = unknowns[row_layer * *size + row];
        for axis in 0..3 {
            let mut entry = entries[node][slot][axis] as usize;
            if entry == NONE as usize {
                continue;
            }
            let column = unknowns[node][axis];
            for (component, &row) in rows.iter().enumerate() {
                if row != NONE && row >= column {
                    matrix.values[entry] += block.col(axis)[component];
                    entry += 1;
                }
            }
        }
    }

    /// Adds a block of any two nodes, and its images.
    fn add_folded(&mut self, [a, b]: [(usize, usize); 2], block: &DMat3) {
        let [(p, of_p), (q, of_q)] = [a, b].map(|(_, k)| self.mirror_image[k]);
        let folded = DMat3::from_diagonal(of_p) * *block * DMat3::from_diagonal(of_q);
        self.add([(a.0, p as usize), (b.0, q as usize)], &folded);
    }

    /// Factorises, with a shift if the matrix is not positive definite; false without success.
    fn factorize(&mut self) -> bool {
        let Self { factorization, matrix, .. } = self;
        let mut added = 0.0;
        let count = matrix.len();
        let trace: f64 = (0..count).map(|c| matrix.values[matrix.starts[c]]).sum();
        let mut shift = SHIFT.0 * (trace / count as f64).abs();
        for _ in 0..MAX_SHIFTS {
            if factorization.factorize(matrix) {
                return true;
            }
            for c in 0..count {
                matrix.values[matrix.starts[c]] += shift - added;
            }
            (added, shift) = (shift, SHIFT.1 * shift);
        }
        false
    }
}

impl Newton {
    /// Adds the step in the unconstrained directions that a factorisation yields.
    pub(super) fn direct_step(&mut self) {
        let Some(mut direct) = self.direct.take() else { return };
        self.set_residual();
        self.project_inner_residual();
        self.assemble(&mut direct);
        if direct.factorize() {
            direct.solution.fill(0.0);
            for (layer, r) in self.r.iter().enumerate() {
                for &k in &self.free {
                    let (image, signs) = direct.mirror_image[k as usize];
                    let force = r[k as usize] * signs;
                    let unknowns = direct.unknowns[layer * direct.size + image as usize];
                    for axis in (0..3).filter(|&axis| unknowns[axis] != NONE) {
                        direct.solution[unknowns[axis] as usize] += force[axis];
                    }
                }
            }
            direct.factorization.solve(&mut direct.solution);
            for (layer, d) in self.d.iter_mut().enumerate() {
                for &k in &self.free {
                    let (image, signs) = direct.mirror_image[k as usize];
                    let unknowns = direct.unknowns[layer * direct.size + image as usize];
                    let part = |axis: usize| match unknowns[axis] {
                        NONE => 0.0,
                        unknown => direct.solution[unknown as usize],
                    };
                    d[k as usize] += signs * DVec3::new(part(0), part(1), part(2));
                }
            }
        }
        self.direct = Some(direct);
        if self.longest_move() > self.far() {
            self.end_far_step();
        } else {
            self.phase = Phase::ActiveSet;
        }
    }

    /// Assembles P H P + s(I − P).
    fn assemble(&self, direct: &mut Direct) {
        direct.matrix.values.fill(0.0);
        let (n, size, top) = (direct.n, direct.size, self.x.len() - 1);
        let inside: Vec<bool> = (0..size).map(|k| direct.mirror_image[k].0 as usize == k).collect();
        let is_constrained = |layer: usize, k: usize| layer == 0 && self.active[k] != FREE;
        // A constrained node's block is projected.
        let projected = |[(l, a), (m, b)]: [(usize, usize); 2], block: DMat3| {
            let block = if is_constrained(l, a) { self.projector[a] * block } else { block };
            if is_constrained(m, b) { block * self.projector[b] } else { block }
        };
        let copies = direct.mirrored.iter().filter(|holds| **holds).count() as u32;
        let copies = f64::from(2_u32.pow(copies));
        // Cells lie on one side of a plane of symmetry, the attachment's pairs and the skin's may lie on it.
        self.tangent.visit_pairs(
            |corners| corners.iter().all(|&k| inside[k]),
            |pair, block| direct.add(pair, &(projected(pair, block) * copies)),
        );
        self.tangent.visit_attached(|pair, block| direct.add_folded(pair, &projected(pair, block)));
        for &k in &self.free {
            let k = k as usize;
            let at = (top, k);
            direct.add_folded([at, at], &projected([at, at], self.skin.diagonal[k]));
            for ((di, dj), blocks) in OFFSETS.iter().zip(&self.skin.upper) {
                let other = (k as isize + di + dj * n as isize) as usize;
                let pair = [at, (top, other)];
                let block = projected(pair, blocks[k]);
                direct.add_folded(pair, &block);
                direct.add_folded([pair[1], pair[0]], &block.transpose());
            }
        }
        for (k, curvature) in &self.curvature {
            let at = (0, *k);
            direct.add_folded([at, at], &-projected([at, at], *curvature));
        }
        for &k in &self.free {
            let k = k as usize;
            if is_constrained(0, k) && inside[k] {
                let block = self.inner[k][0];
                let trace = block.x_axis.x + block.y_axis.y + block.z_axis.z;
                let held = (DMat3::IDENTITY - self.projector[k]) * (copies * trace / 3.0);
                direct.add([(0, k), (0, k)], &held);
            }
        }
    }
}

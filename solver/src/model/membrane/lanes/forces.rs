//! Forces of the sheet and the diagonal blocks of its stiffness, four cells at a time.
//!
//! A regular cell has four right-angled triangles on the edges B (bottom), T (top), L (left) and R
//! (right); the tension along its edges e₁, e₂ is M₁₁e₁ + M₁₂e₂ and M₁₂e₁ + M₂₂e₂ (see
//! [`crate::springs::closed_form`]). Cells at the border, whose rest shapes differ, are in [`super::border`].

use super::Scratch;
use super::coupled::{CoupledLanes, Law};
use crate::mesh::lanes::{CellRow, Field, shifted_right};
use crate::mesh::vec3::{Block, Vec3, add, add_outer, cross, dot, scale, sub};
use crate::model::NodeBlocks;
use crate::model::membrane::node_stiffness::{add_fibre, add_stretch};
use crate::springs::closed_form::{Change, Stretch};
use wide::f32x4;

/// Lanes shifted to the left; the last one is the first of the following four.
#[inline(always)]
fn shifted_left(now: f32x4, next: f32x4) -> f32x4 {
    let (a, b) = (now.to_array(), next.to_array());
    f32x4::new([a[1], a[2], a[3], b[0]])
}

/// A row of nodes in blocks of four.
#[derive(Clone, Copy)]
pub(super) struct Row<'a> {
    x: &'a [[f32; 4]],
    y: &'a [[f32; 4]],
    z: &'a [[f32; 4]],
}

impl<'a> Row<'a> {
    /// `count` blocks of the row that begins at node `start`.
    #[inline(always)]
    pub(super) fn new(field: &'a Field, start: usize, count: usize) -> Self {
        let cut = |part: &'a [f32]| &part[start..start + 4 * count].as_chunks().0[..count];
        Self { x: cut(&field.x), y: cut(&field.y), z: cut(&field.z) }
    }

    #[inline(always)]
    fn block(&self, b: usize) -> Vec3 {
        [f32x4::new(self.x[b]), f32x4::new(self.y[b]), f32x4::new(self.z[b])]
    }
}

/// The same, to be added to.
struct Sums<'a> {
    x: &'a mut [[f32; 4]],
    y: &'a mut [[f32; 4]],
    z: &'a mut [[f32; 4]],
}

impl<'a> Sums<'a> {
    /// Two rows, one after the other.
    #[inline(always)]
    fn pair(field: &'a mut Field, start: usize, pitch: usize, count: usize) -> (Self, Self) {
        let cut = |part: &'a mut [f32]| {
            let (lower, upper) = part[start..].split_at_mut(pitch);
            (
                &mut lower[..4 * count].as_chunks_mut().0[..count],
                &mut upper[..4 * count].as_chunks_mut().0[..count],
            )
        };
        let ((x, x2), (y, y2), (z, z2)) = (cut(&mut field.x), cut(&mut field.y), cut(&mut field.z));
        (Self { x, y, z }, Self { x: x2, y: y2, z: z2 })
    }

    #[inline(always)]
    fn add(&mut self, b: usize, v: Vec3) {
        self.x[b] = (f32x4::new(self.x[b]) + v[0]).to_array();
        self.y[b] = (f32x4::new(self.y[b]) + v[1]).to_array();
        self.z[b] = (f32x4::new(self.z[b]) + v[2]).to_array();
    }
}

/// The edges of four neighbouring cells, or what the displacement adds to them.
struct Cells {
    bottom: Vec3,
    top: Vec3,
    left: Vec3,
    right: Vec3,
}

impl Cells {
    /// What the displacements of the lower and the upper row of nodes add: these four, the next four.
    #[inline(always)]
    fn added(a: Vec3, a_next: Vec3, d: Vec3, d_next: Vec3) -> Self {
        let shift = |now: Vec3, next: Vec3| [0, 1, 2].map(|k| shifted_left(now[k], next[k]));
        let (b, c) = (shift(a, a_next), shift(d, d_next));
        Self { bottom: sub(b, a), top: sub(c, d), left: sub(d, a), right: sub(c, b) }
    }

    /// With the edges at rest.
    #[inline(always)]
    fn edges(mut self) -> Self {
        let one = f32x4::ONE;
        self.bottom[0] += one;
        self.top[0] += one;
        self.left[1] += one;
        self.right[1] += one;
        self
    }
}

/// −∂E/∂u of every stored node; entries of ghost and clamped nodes are unspecified.
pub(super) fn forces(law: &CoupledLanes, u: &Field, f: &mut Field, scratch: &mut Scratch) {
    match law.groups() {
        [one] => all_forces(one, u, f, scratch),
        many => all_forces(many, u, f, scratch),
    }
}

fn all_forces<L: Law + ?Sized>(
    law: &L,
    u: &Field,
    f: &mut Field,
    Scratch { layout, border, on_border, row }: &mut Scratch,
) {
    f.fill_zero();
    for cells in layout.cell_rows() {
        let (start, count) = (cells.start, cells.groups);
        // One block more: the nodes to the right of the last cells.
        let lower = Row::new(u, start, count + 1);
        let upper = Row::new(u, start + layout.pitch, count + 1);
        let sums = Sums::pair(f, start, layout.pitch, count + 1);
        let row = &mut row[..count];
        // Three short loops: one long one would wait for its own square roots.
        measure_row(lower, upper, row);
        for four in row.iter_mut() {
            let [bb, tt, ll, rr, bl, br, tl, tr] = four.changes;
            let changes = [[bb, ll, bl], [bb, rr, br], [tt, rr, tr], [tt, ll, tl]];
            for (at, change) in four.triangles.iter_mut().zip(changes) {
                [at.trace, at.area] = law.tension(*at, Change::of_square(change));
            }
        }
        pull_row(lower, upper, row, sums, cells);
    }
    border.add_forces(law, u, f, on_border);
}

/// Four neighbouring cells under evaluation.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct CellLanes {
    /// B·B − 1, T·T − 1, L·L − 1, R·R − 1, B·L, B·R, T·L, T·R.
    pub(super) changes: [f32x4; 8],
    /// The triangles at the four corners; then A and Q stand for τ and σ.
    pub(super) triangles: [Stretch<f32x4>; 4],
}

/// The invariants of a row of cells.
#[inline(always)]
pub(super) fn measure_row(lower: Row, upper: Row, row: &mut [CellLanes]) {
    let (mut a, mut d) = (lower.block(0), upper.block(0));
    for (b, out) in row.iter_mut().enumerate() {
        let (a_next, d_next) = (lower.block(b + 1), upper.block(b + 1));
        let added = Cells::added(a, a_next, d, d_next);
        (a, d) = (a_next, d_next);
        // Two edges that meet at right angles at rest.
        let squared = |axis: usize, v: Vec3| v[axis] + v[axis] + dot(v, v);
        let product = |e1: Vec3, e2: Vec3| e1[1] + e2[0] + dot(e1, e2);
        let Cells { bottom, top, left, right } = added;
        let (bb, tt) = (squared(0, bottom), squared(0, top));
        let (ll, rr) = (squared(1, left), squared(1, right));
        let (bl, br) = (product(bottom, left), product(bottom, right));
        let (tl, tr) = (product(top, left), product(top, right));
        out.changes = [bb, tt, ll, rr, bl, br, tl, tr];
        let changes = [[bb, ll, bl], [bb, rr, br], [tt, rr, tr], [tt, ll, tl]];
        out.triangles = changes.map(Stretch::of_square);
    }
}

/// Adds the forces of a row of cells on the rows of nodes below and above.
#[inline(always)]
fn pull_row(
    lower: Row,
    upper: Row,
    row: &[CellLanes],
    (mut f_lower, mut f_upper): (Sums, Sums),
    counted: CellRow,
) {
    let count = row.len();
    let (mut a, mut d) = (lower.block(0), upper.block(0));
    let mut before_lower = [f32x4::ZERO; 3];
    let mut before_upper = [f32x4::ZERO; 3];
    for (b, cells) in row.iter().enumerate() {
        let [bb, tt, ll, rr, bl, br, tl, tr] = cells.changes;
        let [[pa, qa], [pb, qb], [pc, qc], [pd, qd]] =
            cells.triangles.map(|at| [at.trace, at.area]);
        let (a_next, d_next) = (lower.block(b + 1), upper.block(b + 1));
        let Cells { bottom, top, left, right } = Cells::added(a, a_next, d, d_next).edges();
        (a, d) = (a_next, d_next);
        let (la, lb, lc, ld) = (qa * bl, qb * br, qc * tr, qd * tl);
        let edge = |own: f32x4, e: Vec3, one: f32x4, e1: Vec3, two: f32x4, e2: Vec3| {
            sub(scale(e, own), add(scale(e1, one), scale(e2, two)))
        };
        let mut on_bottom = edge(pa + pb + qa * ll + qb * rr, bottom, la, left, lb, right);
        let mut on_top = edge(pc + pd + qc * rr + qd * ll, top, lc, right, ld, left);
        let mut on_left = edge(pa + pd + qa * bb + qd * tt, left, la, bottom, ld, top);
        let mut on_right = edge(pb + pc + qb * bb + qc * tt, right, lb, bottom, lc, top);
        if b == 0 || b + 1 == count {
            let counts = counted.counts(b);
            for force in [&mut on_bottom, &mut on_top, &mut on_left, &mut on_right] {
                *force = force.map(|part| part & counts);
            }
        }
        let (on_a, on_b) = (add(on_bottom, on_left), sub(on_right, on_bottom));
        let (on_d, minus_c) = (sub(on_top, on_left), add(on_top, on_right));
        let shift = |before: Vec3, now: Vec3| [0, 1, 2].map(|k| shifted_right(before[k], now[k]));
        f_lower.add(b, add(on_a, shift(before_lower, on_b)));
        f_upper.add(b, sub(on_d, shift(before_upper, minus_c)));
        (before_lower, before_upper) = (on_b, minus_c);
    }
    let rest = |before: Vec3| before.map(|part| shifted_right(part, f32x4::ZERO));
    f_lower.add(count, rest(before_lower));
    f_upper.add(count, sub([f32x4::ZERO; 3], rest(before_upper)));
}

/// The diagonal blocks of the stiffness; entries of nodes that are not free are unspecified.
///
/// The stiffness is taken at the middle of each cell: around a node the differences cancel.
pub(super) fn blocks(
    law: &CoupledLanes,
    u: &Field,
    blocks: &mut NodeBlocks,
    Scratch { layout, border, on_border, .. }: &mut Scratch,
) {
    blocks.fill_zero();
    for cells in layout.cell_rows() {
        block_row(law, u, cells, layout.pitch, blocks);
    }
    border.add_blocks(law, u, blocks, on_border);
}

fn block_row(law: &CoupledLanes, u: &Field, cells: CellRow, pitch: usize, blocks: &mut NodeBlocks) {
    let (start, count) = (cells.start, cells.groups);
    let (lower, upper) = (Row::new(u, start, count + 1), Row::new(u, start + pitch, count + 1));
    let (mut a, mut d) = (lower.block(0), upper.block(0));
    let mut before = [f32x4::ZERO; 6];
    for b in 0..=count {
        let mut block = [f32x4::ZERO; 6];
        if b < count {
            let (a_next, d_next) = (lower.block(b + 1), upper.block(b + 1));
            let counts = cells.counts(b);
            block = cell_block(law, &Cells::added(a, a_next, d, d_next).edges())
                .map(|part| part & counts);
            (a, d) = (a_next, d_next);
        }
        // Each cell adds the same to its four corners.
        let sum = [0, 1, 2, 3, 4, 5].map(|p| block[p] + shifted_right(before[p], block[p]));
        blocks.add(start + 4 * b, sum);
        blocks.add(start + 4 * b + pitch, sum);
        before = block;
    }
}

/// The block that each of four neighbouring cells adds to each of its corners.
#[inline(always)]
fn cell_block(law: &CoupledLanes, cells: &Cells) -> Block {
    let half = f32x4::HALF;
    let e1 = scale(add(cells.bottom, cells.top), half);
    let e2 = scale(add(cells.left, cells.right), half);
    let (g11, g12, g22) = (dot(e1, e1), dot(e1, e2), dot(e2, e2));
    let change = [g11 - f32x4::ONE, g22 - f32x4::ONE, g12];
    let at = Stretch::of_square(change);
    let k = law.stiffness(at, Change::of_square(change));
    let per_s = f32x4::ONE / at.area_stretch();
    let per_t = f32x4::ONE / k.t;
    let n = scale(cross(e1, e2), per_s);
    let all = k.p + k.p;
    let across = (k.beta_t * (g11 + g22) * per_s).fast_max(k.min_normal - all);
    let mut block = [f32x4::ZERO; 6];
    add_outer(&mut block, scale(n, across), n);
    let (w1, w2) = (sub(scale(e1, g22), scale(e2, g12)), sub(scale(e2, g11), scale(e1, g12)));
    let tau1 = scale(add(e1, scale(w1, per_s)), per_t);
    let tau2 = scale(add(e2, scale(w2, per_s)), per_t);
    if let Some(fibre) = &k.fibre {
        let one = f32x4::ONE;
        add_fibre(&mut block, fibre, [one, g22], [e1, w1, n]);
        add_fibre(&mut block, fibre, [one, g11], [e2, w2, n]);
    }
    add_stretch(&mut block, &k, e1, tau1);
    add_stretch(&mut block, &k, e2, tau2);
    block[0] += all;
    block[3] += all;
    block[5] += all;
    // A regular triangle's share is in the law: a cell gives each corner twice its block.
    block.map(|part| part + part)
}

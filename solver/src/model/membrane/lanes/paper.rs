//! The paper's springs in lanes of four f32: the edges and both diagonals of every cell. The tension of a spring
//! depends on its own strain alone.

use super::Scratch;
use super::border::{Border, BorderScratch, gathered};
use crate::mesh::lanes::{Field, Layout};
use crate::mesh::vec3::{Block, Vec3, add_outer, dot, scale, sub};
use crate::model::membrane::law::PaperLaw;
use crate::model::{NodeBlocks, Tension};
use crate::springs::paper::Spring;
use crate::springs::table::Buckets;
use wide::f32x4;

/// Lower bound of the stiffness along and across a spring, relative to the greater of them \[-\].
const MIN_STIFFNESS: f32 = 1e-4;

/// The springs, scaled so that the sheet's stiffness at small strain is 1.
#[derive(Clone, Debug)]
pub(crate) struct LaneSprings {
    /// Tension against strain.
    edge: Buckets<f32x4>,
    diagonal: Buckets<f32x4>,
    /// Stiffness at small strain \[kPa·mm\].
    pub(super) unit: f64,
}

/// Four springs at rest.
#[derive(Clone, Copy)]
struct Rest {
    length: f32x4,
    width: f32x4,
}

impl Rest {
    /// One cell's share of a spring of the regular grid: half a spacing wide.
    fn regular(spring: Spring) -> Self {
        let length = match spring {
            Spring::Edge => 1.0,
            Spring::Diagonal => std::f32::consts::SQRT_2,
        };
        Self { length: f32x4::splat(length), width: f32x4::HALF }
    }

    /// Of triangles with the given area times weight, relative to a regular triangle of half weight; the rule of the
    /// width is that of the assembly in f64.
    fn of_triangle(spring: Spring, [x, y]: [f32x4; 2], weight: f32x4) -> Self {
        let length = (x * x + y * y).sqrt();
        let area = match spring {
            Spring::Edge => 0.25,
            Spring::Diagonal => 0.25 * std::f32::consts::SQRT_2,
        };
        Self { length, width: weight * area / length }
    }
}

impl LaneSprings {
    /// The lanes of a law whose stiffness at small strain is `stiffness` \[kPa·mm\].
    pub(super) fn new(law: &PaperLaw, stiffness: f64) -> Self {
        let scale = 1.0 / stiffness;
        let (edge, diagonal) = (law.edge.buckets(scale), law.diagonal.buckets(scale));
        Self { edge, diagonal, unit: stiffness }
    }

    fn table(&self, spring: Spring) -> &Buckets<f32x4> {
        match spring {
            Spring::Edge => &self.edge,
            Spring::Diagonal => &self.diagonal,
        }
    }

    /// Length of four springs, their tension and its slope against strain.
    #[inline(always)]
    fn response(&self, spring: Spring, rest: Rest, now: Vec3) -> (f32x4, f32x4, f32x4) {
        let length = dot(now, now).sqrt().fast_max(f32x4::splat(1e-6));
        let (tension, slope) = self.table(spring).value_and_slope(length / rest.length - 1.0);
        (length, tension, slope)
    }

    /// The forces of four springs on their first ends.
    #[inline(always)]
    fn pull(&self, spring: Spring, rest: Rest, now: Vec3) -> Vec3 {
        let (length, tension, _) = self.response(spring, rest, now);
        scale(now, tension * rest.width / length)
    }

    /// The second derivative of the springs' energy by one of their ends, kept positive.
    #[inline(always)]
    fn block(&self, spring: Spring, rest: Rest, now: Vec3) -> Block {
        let (length, tension, slope) = self.response(spring, rest, now);
        let least = (slope.abs() + tension.abs()) * rest.width / rest.length * MIN_STIFFNESS;
        let along = (slope * rest.width / rest.length).fast_max(least);
        let across = (tension * rest.width / length).fast_max(least);
        let direction = scale(now, f32x4::ONE / length);
        let mut block = [across, f32x4::ZERO, f32x4::ZERO, across, f32x4::ZERO, across];
        add_outer(&mut block, scale(direction, along - across), direction);
        block
    }
}

/// Calls `visit` with the six springs of each four neighbouring cells: stored nodes of the first of
/// their ends, vectors now, and which lanes count.
#[inline(always)]
fn springs(layout: &Layout, u: &Field, mut visit: impl FnMut([usize; 2], Spring, Vec3, f32x4)) {
    let pitch = layout.pitch;
    let of_cell = [
        ([0, 1], Spring::Edge, [1.0, 0.0]),
        ([pitch, pitch + 1], Spring::Edge, [1.0, 0.0]),
        ([0, pitch], Spring::Edge, [0.0, 1.0]),
        ([1, pitch + 1], Spring::Edge, [0.0, 1.0]),
        ([0, pitch + 1], Spring::Diagonal, [1.0, 1.0]),
        ([1, pitch], Spring::Diagonal, [-1.0, 1.0]),
    ];
    for cells in layout.cell_rows() {
        for group in 0..cells.groups {
            let (k, counts) = (cells.start + 4 * group, cells.counts(group));
            for (ends, spring, [x, y]) in of_cell {
                let ends = ends.map(|end| k + end);
                let (p, q) = (u.load(ends[0]), u.load(ends[1]));
                visit(ends, spring, [q[0] - p[0] + x, q[1] - p[1] + y, q[2] - p[2]], counts);
            }
        }
    }
}

/// The paper's springs of a triangle, the right angle at its first corner.
const TRIANGLE_SPRINGS: [(usize, usize, Spring); 3] =
    [(0, 1, Spring::Edge), (0, 2, Spring::Edge), (1, 2, Spring::Diagonal)];

impl Border {
    /// Calls `visit` with the three springs of each four triangles: their ends, as places of the border's
    /// nodes, which of the paper's springs they are, their vectors at rest and now, their widths.
    #[inline(always)]
    fn springs(
        &self,
        u: &[f32x4],
        mut visit: impl FnMut([&[u32; 4]; 2], Spring, [f32x4; 2], Vec3, f32x4),
    ) {
        for four in &self.fours {
            let [[x1, y1, _], [x2, y2, _]] = four.edges;
            let rests = [[x1, y1], [x2, y2], [x2 - x1, y2 - y1]];
            for ((a, b, spring), rest) in TRIANGLE_SPRINGS.into_iter().zip(rests) {
                let [from, to] = [&four.corners[a], &four.corners[b]];
                let mut now = sub(gathered(u, to), gathered(u, from));
                now[0] += rest[0];
                now[1] += rest[1];
                visit([from, to], spring, rest, now, four.weight);
            }
        }
    }

    /// Adds the forces of the paper's springs of the triangles.
    fn add_spring_forces(
        &self,
        law: &LaneSprings,
        u: &Field,
        f: &mut Field,
        scratch: &mut BorderScratch,
    ) {
        let BorderScratch { u: at, f: pulls, .. } = scratch;
        self.gather(u, at);
        pulls.fill(f32x4::ZERO);
        self.springs(at, |[from, to], spring, rest, now, weight| {
            let [x, y, z] = law.pull(spring, Rest::of_triangle(spring, rest, weight), now);
            let lanes = f32x4::transpose([x, y, z, f32x4::ZERO]);
            for ((&a, &b), pull) in from.iter().zip(to).zip(lanes) {
                pulls[a as usize] += pull;
                pulls[b as usize] -= pull;
            }
        });
        self.scatter(pulls, f);
    }

    /// Adds the blocks of the paper's springs of the triangles.
    fn add_spring_blocks(
        &self,
        law: &LaneSprings,
        u: &Field,
        blocks: &mut NodeBlocks,
        scratch: &mut BorderScratch,
    ) {
        self.gather(u, &mut scratch.u);
        self.springs(&scratch.u, |ends, spring, rest, now, weight| {
            let block = law.block(spring, Rest::of_triangle(spring, rest, weight), now);
            for places in ends {
                self.scatter_block(places, block, blocks);
            }
        });
    }
}

/// −∂E/∂u of every stored node; entries of ghost and clamped nodes are unspecified.
pub(super) fn forces(
    law: &LaneSprings,
    u: &Field,
    f: &mut Field,
    Scratch { layout, border, on_border, .. }: &mut Scratch,
) {
    f.fill_zero();
    springs(layout, u, |[from, to], spring, now, counts| {
        let pull = law.pull(spring, Rest::regular(spring), now).map(|part| part & counts);
        let [x, y, z] = f.load(from);
        f.store(from, [x + pull[0], y + pull[1], z + pull[2]]);
        let [x, y, z] = f.load(to);
        f.store(to, [x - pull[0], y - pull[1], z - pull[2]]);
    });
    border.add_spring_forces(law, u, f, on_border);
}

/// The diagonal blocks of the stiffness; entries of nodes that are not free are unspecified.
pub(super) fn blocks(
    law: &LaneSprings,
    u: &Field,
    blocks: &mut NodeBlocks,
    Scratch { layout, border, on_border, .. }: &mut Scratch,
) {
    blocks.fill_zero();
    springs(layout, u, |ends, spring, now, counts| {
        let block = law.block(spring, Rest::regular(spring), now).map(|part| part & counts);
        for k in ends {
            blocks.add(k, block);
        }
    });
    border.add_spring_blocks(law, u, blocks, on_border);
}

/// The tension of the springs of whole cells: the sum of squares of their forces.
pub(super) fn tension(law: &LaneSprings, u: &Field, scratch: &Scratch) -> Tension {
    let mut sum = 0.0;
    springs(&scratch.layout, u, |_, spring, now, counts| {
        let pull = law.pull(spring, Rest::regular(spring), now);
        sum += f64::from((dot(pull, pull) & counts).reduce_add());
    });
    Tension { squares: sum, ..Tension::default() }
}

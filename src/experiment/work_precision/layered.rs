//! Baselines for layered tissue: relaxation on nested grids without multigrid, with the forces, blocks and contact of
//! full multigrid (f32 lanes).
//!
//! Every step is u += γ D⁻¹ f under the contact conditions. [`Scheme::ColumnJacobi`] inverts the blocks of whole columns,
//! as the smoother of multigrid does, and [`Scheme::GaussSeidel`] does so in four colours of columns, with the forces of the columns
//! moved before; [`Scheme::Explicit`] inverts the blocks of single nodes and adds a part of the last
//! step, until the forces oppose it (dynamic relaxation with restarts). The step length follows from the greatest eigenvalue of D⁻¹H, measured by
//! power iteration. Coarser grids provide the start of both.

use super::watch::{End, Watch};
use crate::contact::lanes::{LaneObstacle, Touch};
use crate::mesh::lanes::{Field, Layout, load, store_first};
use crate::mesh::vec3::{Block, Vec3, add, dot, inverted, scale, sub, times};
use crate::mesh::{NodeKind, Sheet};
use crate::model::columns::{ColumnBlocks, Stiffness};
use crate::model::layered::LayeredLaw;
use crate::model::layered::lanes::{Layered, Scratch};
use crate::model::{ElasticModel, NodeBlocks};
use crate::solve::{Problem, Tissue, initial_guess};
use glam::DVec3;
use wide::f32x4;

/// Greatest nodal step of the last iteration on a coarser grid \[fraction of the base radius\].
const COARSE_STEP: f64 = 1e-5;
/// Greatest number of iterations on a coarser grid.
const MAX_COARSE_STEPS: u32 = 400;
/// Least number of cells a side of a coarser grid, as of multigrid.
const LEAST_CELLS: usize = 16;
/// Safety factor on the greatest stable step.
const SAFETY: f64 = 0.9;
/// First iterations with an update of blocks and step length.
const UPDATES: [u32; 4] = [5, 15, 40, 100];
/// Iterations between two later updates.
const UPDATE_INTERVAL: u32 = 200;
/// Factor of successive over-relaxation of Gauss–Seidel \[-\]: the fastest of 0.8, 1, 1.15, 1.25, 1.3, 1.5 and 1.7 over all scenes;
/// the blocks are no upper bounds, and from 1.25 on it fails.
const OVER_RELAXATION: f64 = 1.0;
/// Gauss–Seidel sweeps between two updates of the blocks and of the augmented pressure.
const SWEEPS_PER_UPDATE: u32 = 5;
/// Steps between two updates of the augmented pressure.
const STEPS_PER_PRESSURE: u32 = 20;
/// Greatest disturbance of a node by the power iteration, and greatest explicit step of a node \[height of the lowest cell\]. More
/// inverts flat cells: the measured eigenvalue was 1e4 in `layered-muscle`, the steps too short, and cells inverted.
const OF_HEIGHT: (f64, f64) = (0.05, 0.2);
/// Power iterations of an update; more of them amplify the rounding of f32, and the steps get too short.
const POWER_ITERATIONS: u32 = 12;
/// Length of the disturbance of the power iteration \[spacings, root mean square\].
const DISTURBANCE: f64 = 1e-2;
/// Ratio of the assumed to the measured eigenvalue \[-\]: power iteration bounds it from below.
const EIGENVALUE_SAFETY: f64 = 1.15;
/// Greatest step of a node along each axis \[spacings\].
const MAX_STEP: f32 = 0.2;
/// k in the velocity factor n/(n + k) of the n-th step after a restart \[-\].
const RESTART_DELAY: f64 = 3.0;

/// What a relaxation inverts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scheme {
    /// The blocks of columns; no memory of the last step.
    ColumnJacobi,
    /// The blocks of nodes; momentum with restarts.
    Explicit,
    /// The blocks of columns, column after column, with over-relaxation.
    GaussSeidel,
}

/// Relaxation on nested grids.
pub(super) struct Relaxation<'a> {
    problem: &'a Problem,
    model: Layered,
    /// Positions at rest of all nodes, layer by layer \[mm\].
    rest: &'a [DVec3],
    /// From the coarsest to the finest.
    grids: Vec<Grid>,
}

/// One grid.
struct Grid {
    scheme: Scheme,
    sheet: Sheet,
    layout: Layout,
    scratch: Scratch,
    obstacle: LaneObstacle,
    /// Displacements \[spacings\].
    u: Field,
    f: Field,
    /// Forces at `u`, for the power iteration.
    forces: Field,
    /// The last step, or scratch of the power iteration.
    step: Field,
    /// Scratch of the power iteration.
    disturbed: Field,
    blocks: ColumnBlocks,
    /// Inverse blocks of nodes.
    inverse: NodeBlocks,
    /// Step length γ.
    gain: f64,
    /// Height of the lowest cell \[spacings\].
    least_height: f64,
    /// Steps since the last restart of the momentum.
    since_restart: u32,
    /// 1 at nodes of the inner face that contact does not hold, else 0.
    untouched: Vec<f32>,
    /// Force evaluations on this grid.
    evaluations: u32,
}

impl<'a> Relaxation<'a> {
    pub(super) fn new(problem: &'a Problem, rest: &'a [DVec3], scheme: Scheme) -> Self {
        let (cells_through, skin_wrinkles) = match problem.tissue {
            Tissue::Layered { cells_through, skin_wrinkles } => (cells_through, skin_wrinkles),
            Tissue::Sheet => (1, false),
        };
        let law = LayeredLaw::new(&problem.materials, cells_through, skin_wrinkles);
        let model = Layered::new(&law, problem.patch.pocket_radius_mm, problem.patch.attachment());
        let mut sheets = vec![problem.sheet.clone()];
        while let Some(coarser) = sheets.last().and_then(Sheet::coarser)
            && coarser.nodes_per_side() > LEAST_CELLS
        {
            sheets.push(coarser);
        }
        let least = law.cells.iter().map(|cells| cells.height_mm).fold(f64::INFINITY, f64::min);
        let grid = |sheet: Sheet| Grid::new(sheet, problem, &model, scheme, least);
        let grids = sheets.into_iter().rev().map(grid).collect();
        Self { problem, grids, model, rest }
    }

    /// Runs until the watch ends the run.
    pub(super) fn run(&mut self, watch: &mut Watch) -> End {
        let Self { problem, model, grids, rest } = self;
        let finest_nodes = problem.sheet.free_nodes() as f64;
        let finest = grids.len() - 1;
        let mut work = 0.0;
        grids[0].start_from_geometry(problem);
        for l in 0..finest {
            let (coarser, finer) = grids.split_at_mut(l + 1);
            let (grid, finer) = (&mut coarser[l], &mut finer[0]);
            let greatest = COARSE_STEP * problem.obstacle.dome.base_radius;
            grid.begin();
            for steps in 0..MAX_COARSE_STEPS {
                let moved = grid.iterate(model, steps);
                if moved * grid.sheet.spacing_mm() <= greatest || watch.is_out_of_time() {
                    break;
                }
            }
            let share = grid.sheet.free_nodes() as f64 / finest_nodes;
            work += share * f64::from(grid.evaluations);
            finer.prolongate_from(grid);
            model.hand_on((&grid.layout, &grid.scratch), &finer.layout, &mut finer.scratch);
        }
        let grid = &mut grids[finest];
        grid.begin();
        for steps in 0..u32::MAX {
            grid.iterate(model, steps);
            let steps = steps + 1;
            if watch.is_due(steps) {
                let work_units = work + f64::from(grid.evaluations);
                if let Some(end) = watch.sample(steps, work_units, |x| grid.write(x, rest)) {
                    return end;
                }
            }
        }
        End::Finished
    }
}

impl Grid {
    fn new(
        sheet: Sheet,
        problem: &Problem,
        model: &Layered,
        scheme: Scheme,
        least_height_mm: f64,
    ) -> Self {
        let spacing = sheet.spacing_mm();
        let (layout, border) = Layout::new(sheet.nodes_per_side(), [false; 2]);
        let (length, layers) = (layout.len(), model.layers());
        let mut scratch = model.scratch(&layout, &border);
        model.place(&layout, spacing, &mut scratch);
        let field = || Field::new(length, layers);
        Self {
            scheme,
            scratch,
            obstacle: LaneObstacle::new(&problem.obstacle.scaled(1.0 / spacing)),
            u: field(),
            f: field(),
            forces: field(),
            step: field(),
            disturbed: field(),
            blocks: ColumnBlocks::new(length, layers),
            inverse: NodeBlocks::zeros(length * layers),
            gain: 0.0,
            least_height: least_height_mm / spacing,
            since_restart: 0,
            untouched: vec![1.0; length],
            evaluations: 0,
            sheet,
            layout,
        }
    }

    /// The taut profile over the dome, every column moved as a whole: the start of multigrid.
    fn start_from_geometry(&mut self, problem: &Problem) {
        let Self { sheet, layout, u, .. } = self;
        let reach = problem.patch.reach_mm();
        let guess = initial_guess::taut_within(sheet, &problem.obstacle.dome, reach);
        let n = layout.nodes_per_side;
        u.fill_zero();
        for layer in u.layers() {
            layout.free_rows(|j, from, to| {
                for i in from..to {
                    let k = j * n + i;
                    let moved = (guess[k] - sheet.rest_position(k)) / sheet.spacing_mm();
                    let to = layer + j * layout.pitch + i;
                    (u.x[to], u.y[to], u.z[to]) = moved.as_vec3().into();
                }
            });
        }
    }

    /// Interpolates the solution of the next coarser grid linearly.
    fn prolongate_from(&mut self, coarse: &Self) {
        let Self { layout, obstacle, u, .. } = self;
        u.fill_zero();
        for (to, from_layer) in u.layers().zip(coarse.u.layers()) {
            layout.free_rows(|j, from, end| {
                for i in from..end {
                    let pitch = coarse.layout.pitch;
                    let low = from_layer + j / 2 * pitch + i / 2;
                    let (right, up) = (i % 2, (j % 2) * pitch);
                    let corners = [low, low + right, low + up, low + up + right];
                    // The mean of four, in spacings of half the length.
                    for k in corners {
                        u.add(to + j * layout.pitch + i, coarse.u.at(k).map(|x| 0.5 * x));
                    }
                }
            });
        }
        layout.free_groups(|group| {
            let at = u.load(group.first);
            let shift = sub(obstacle.projected(group.rest, at, f32x4::ONE), at);
            for layer in u.layers() {
                let k = layer + group.first;
                let moved = add(u.load(k), shift);
                store_first(u, k, group.count, moved);
            }
        });
    }

    fn begin(&mut self) {
        self.step.fill_zero();
        self.since_restart = 0;
        self.evaluations = 0;
    }

    /// One iteration; returns the greatest step of a node \[spacings\].
    fn iterate(&mut self, model: &Layered, steps: u32) -> f64 {
        let interval = match self.scheme {
            Scheme::GaussSeidel => SWEEPS_PER_UPDATE,
            _ => UPDATE_INTERVAL,
        };
        if steps == 0 || UPDATES.contains(&steps) || steps.is_multiple_of(interval) {
            self.update(model);
        }
        let interval = match self.scheme {
            Scheme::GaussSeidel => SWEEPS_PER_UPDATE,
            _ => STEPS_PER_PRESSURE,
        };
        if steps > 0 && steps.is_multiple_of(interval) {
            model.renew(&self.layout, &self.u, &mut self.scratch);
        }
        if self.scheme == Scheme::GaussSeidel {
            // Columns of one colour share no cell: the order is that of a sweep, colour after colour.
            let colours = if steps.is_multiple_of(2) { [0, 1, 2, 3] } else { [3, 2, 1, 0] };
            return colours.into_iter().fold(0.0, |greatest, colour| {
                self.evaluate(model);
                greatest.max(self.step_columns(Some([colour % 2, colour / 2])))
            });
        }
        self.evaluate(model);
        if self.scheme == Scheme::Explicit { self.step_nodes() } else { self.step_columns(None) }
    }

    fn evaluate(&mut self, model: &Layered) {
        model.forces(&self.layout, &self.u, &mut self.f, &mut self.scratch);
        self.evaluations += 1;
    }

    /// Renews the blocks, and the step length from the greatest eigenvalue of D⁻¹H.
    fn update(&mut self, model: &Layered) {
        let Self { layout, u, blocks, inverse, scratch, .. } = self;
        model.blocks(layout, u, blocks, scratch);
        if self.scheme == Scheme::Explicit {
            inverse.fill_zero();
            for layer in u.layers() {
                layout.free_groups(|group| {
                    let k = layer + group.first;
                    let lanes = inverted(blocks.diagonal.load(k));
                    for (part, lanes) in inverse.parts.iter_mut().zip(lanes) {
                        let lanes = &lanes.to_array()[..group.count];
                        part[k..k + group.count].copy_from_slice(lanes);
                    }
                });
            }
        }
        blocks.invert(layout);
        if self.scheme == Scheme::GaussSeidel {
            self.gain = OVER_RELAXATION;
            return;
        }
        let greatest = EIGENVALUE_SAFETY * self.greatest_eigenvalue(model);
        self.gain = SAFETY * 2.0 / greatest.max(1.0);
    }

    /// The greatest eigenvalue of D⁻¹H at `u` by power iteration on differences of forces.
    fn greatest_eigenvalue(&mut self, model: &Layered) -> f64 {
        let last = self.step.clone();
        let Self { layout, u, forces, step, scratch, .. } = self;
        model.forces(layout, u, forces, scratch);
        // Any rough start.
        step.fill_zero();
        let mut seed = 1_u32;
        for layer in u.layers() {
            layout.free_rows(|j, from, to| {
                for i in from..to {
                    let number = [0; 3].map(|_| {
                        seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                        (seed >> 8) as f32 / (1 << 23) as f32 - 1.0
                    });
                    step.add(layer + j * layout.pitch + i, number);
                }
            });
        }
        let nodes = (layout.free_nodes() * u.layers().count()) as f64;
        let mut eigenvalue = 1.0;
        for _ in 0..POWER_ITERATIONS {
            let length = (square(&self.step) / nodes).sqrt().max(1e-30);
            let greatest = self.step.planes().flatten().fold(1e-30, |a: f32, b| a.max(b.abs()));
            let disturbance =
                (OF_HEIGHT.0 * self.least_height * length / f64::from(greatest)).min(DISTURBANCE);
            let factor = (disturbance / length) as f32;
            self.disturbed.copy_from(&self.u);
            for (to, from) in self.disturbed.planes_mut().zip(self.step.planes()) {
                to.iter_mut().zip(from).for_each(|(to, from)| *to += factor * from);
            }
            let Self { layout, f, forces, disturbed, scratch, .. } = self;
            model.forces(layout, disturbed, f, scratch);
            for (to, from) in f.planes_mut().zip(forces.planes()) {
                to.iter_mut().zip(from).for_each(|(to, from)| *to = from - *to);
            }
            self.precondition();
            eigenvalue = (square(&self.step) / nodes).sqrt() / disturbance;
        }
        self.evaluations += POWER_ITERATIONS + 1;
        self.step = last;
        eigenvalue
    }

    /// Sets `step` to D⁻¹f at free nodes.
    fn precondition(&mut self) {
        let Self { scheme, layout, f, step, blocks, inverse, .. } = self;
        step.fill_zero();
        layout.free_groups(|group| {
            let k = group.first;
            match scheme {
                Scheme::ColumnJacobi | Scheme::GaussSeidel => {
                    let mut first = [f32x4::ZERO; 3];
                    let inner = |r: Vec3, block: Block| {
                        first = times(block, r);
                        first
                    };
                    blocks.solve(
                        k,
                        1.0,
                        |at| f.load(at),
                        inner,
                        |to, lanes| {
                            store_first(step, to, group.count, lanes);
                        },
                    );
                    store_first(step, k, group.count, first);
                }
                Scheme::Explicit => {
                    for layer in f.layers() {
                        let at = layer + k;
                        let lanes = times(inverse.load(at), f.load(at));
                        store_first(step, at, group.count, lanes);
                    }
                }
            }
        });
    }

    /// A damped step with the blocks of columns, as the smoother of multigrid; of one colour or of all columns. A colour is the
    /// parity of column and row in the grid.
    fn step_columns(&mut self, colour: Option<[usize; 2]>) -> f64 {
        let omega = self.gain as f32;
        let Self { layout, obstacle, u, f, blocks, .. } = self;
        let mut greatest = 0.0_f32;
        layout.free_groups(|group| {
            let k = group.first;
            let (i, j) = (k % layout.pitch, k / layout.pitch);
            let is_moved = match colour {
                Some([_, row]) if j % 2 != row => return,
                Some([column, _]) if i % 2 == column => EVEN_LANES,
                Some(_) => f32x4::ONE - EVEN_LANES,
                None => f32x4::ONE,
            };
            let at = u.load(k);
            let mut moved = at;
            let inner = |r: Vec3, block: Block| {
                let d = scale(times(block, r), f32x4::splat(omega));
                let step = sub(obstacle.step(group.rest, at, d, block, FREE), at);
                let bounded = limited(step, MAX_STEP).map(|step| step * is_moved);
                moved = add(at, bounded);
                bounded
            };
            blocks.solve(
                k,
                omega,
                |at| f.load(at),
                inner,
                |to, step| {
                    let step = step.map(|step| step * is_moved);
                    greatest =
                        greatest.max(dot(step, step).to_array().into_iter().fold(0.0, f32::max));
                    let x = u.load(to);
                    u.store(to, add(x, step));
                },
            );
            u.store(k, moved);
        });
        f64::from(greatest.sqrt())
    }

    /// A step with the blocks of nodes and a part of the last step; without that part where the forces oppose the last
    /// step (adaptive restart: B. O'Donoghue, E. Candès, Found. Comput. Math. 15, 2015).
    fn step_nodes(&mut self) -> f64 {
        let most = (OF_HEIGHT.1 * self.least_height).min(f64::from(MAX_STEP)) as f32;
        let Self { layout, obstacle, u, f, step, inverse, since_restart, untouched, .. } = self;
        let mut power = 0.0;
        for layer in u.layers() {
            layout.free_groups(|group| {
                let k = layer + group.first;
                let mut is_free = inverse.load(k)[0].simd_gt(f32x4::ZERO);
                if layer == 0 {
                    // The reaction of the dome does no work.
                    is_free &= load(untouched, k).simd_gt(f32x4::ZERO);
                }
                let work = dot(f.load(k), step.load(k));
                power += f64::from(is_free.bitselect(work, f32x4::ZERO).reduce_add());
            });
        }
        *since_restart = if power < 0.0 { 0 } else { *since_restart + 1 };
        let count = f64::from(*since_restart);
        let keep = f32x4::splat((count / (count + RESTART_DELAY)) as f32);
        let gain = f32x4::splat(self.gain as f32);
        let mut greatest = 0.0_f32;
        for layer in u.layers() {
            layout.free_groups(|group| {
                let k = layer + group.first;
                let compliance = inverse.load(k);
                let is_free = compliance[0].simd_gt(f32x4::ZERO);
                let (at, force, last) = (u.load(k), f.load(k), step.load(k));
                let d = add(scale(last, keep), scale(times(compliance, force), gain));
                let mut d = limited(d, most);
                if layer == 0 {
                    let held = sub(obstacle.step(group.rest, at, d, compliance, FREE), at);
                    let change = sub(held, d);
                    let is_held = dot(change, change).simd_gt(f32x4::splat(1e-6) * dot(d, d));
                    let marks = is_held.bitselect(f32x4::ZERO, f32x4::ONE).to_array();
                    untouched[k..k + group.count].copy_from_slice(&marks[..group.count]);
                    d = held;
                }
                let d = d.map(|d| is_free.bitselect(d, f32x4::ZERO));
                greatest = greatest.max(dot(d, d).to_array().into_iter().fold(0.0, f32::max));
                store_first(u, k, group.count, add(at, d));
                store_first(step, k, group.count, d);
            });
        }
        f64::from(greatest.sqrt())
    }

    /// Writes the positions \[mm\] of the free nodes, layer by layer.
    fn write(&self, x: &mut [DVec3], rest: &[DVec3]) {
        let Self { sheet, layout, u, .. } = self;
        let (n, nodes) = (layout.nodes_per_side, sheet.len());
        for (l, layer) in u.layers().enumerate() {
            for k in (0..nodes).filter(|&k| sheet.kinds()[k] == NodeKind::Free) {
                let moved = u.at(layer + k / n * layout.pitch + k % n).map(f64::from);
                let k = l * nodes + k;
                x[k] = rest[k] + DVec3::from(moved) * sheet.spacing_mm();
            }
        }
    }
}

/// 1 in the even lanes.
const EVEN_LANES: f32x4 = f32x4::new([1.0, 0.0, 1.0, 0.0]);

/// One-sided contact at the dome's surface.
const FREE: Touch = Touch { length: f32x4::ONE, active: f32x4::ZERO };

/// A step bounded along each axis.
#[inline(always)]
fn limited(step: Vec3, most: f32) -> Vec3 {
    let most = f32x4::splat(most);
    step.map(|step| step.fast_max(-most).fast_min(most))
}

/// Sum of the squares of a field.
fn square(field: &Field) -> f64 {
    field.planes().flatten().map(|x| f64::from(*x).powi(2)).sum()
}

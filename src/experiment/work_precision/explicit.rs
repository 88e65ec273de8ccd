//! Explicit time steps with damping (dynamic relaxation), four f32 lanes at a time.
//!
//! Every node moves by Δ ← keep·Δ + γ f/k, k a bound on its row of the stiffness: masses k/λ and a time
//! step of Δt²λ = γ, stable up to γ = 2(1 + keep). Then it is put back outside of the
//! dome and above the wall. Steps like these are what the paper relaxes its springs with.

use super::guess;
use super::lanes::{Field, LaneSheet, Triangle, Vec3, add, dot, load, scale, sub};
use super::law::Law;
use super::watch::{End, Watch};
use crate::contact::Dome;
use crate::mesh::NodeKind;
use crate::solve::Problem;
use glam::DVec3;
use wide::f32x4;

/// Share of the greatest stable γ that is taken from a good start: strain may stiffen between two
/// renewals of the masses.
const SAFETY: f64 = 0.9;
/// γ of the paper's experiment (see [`crate::experiment::tension`]), and the share of velocity that it
/// keeps: from the draped sheet, a step close to the limit of stability breaks the sheet.
const PAPER_GAIN: f64 = 0.5;
const PAPER_KEPT: f64 = 0.95;
/// Steps after which the nodes' masses are computed anew: often at first, then this often.
const RENEWED_AT: [u32; 4] = [10, 30, 80, 200];
const RENEWED_EVERY: u32 = 500;
/// The least damping that is taken for critical, how fast steps are forgotten, and how far the
/// frequency may rise above the least so far.
const MOST_KEPT: f64 = 0.9995;
const QUOTIENT_MEMORY: f64 = 0.9;
const LEAST_FREQUENCY: f64 = 1e-3;
const MOST_RISE: f64 = 2.0;

/// How much of a step the next one keeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Damping {
    /// As in the paper's experiment: always the same share of velocity.
    Paper,
    /// Critical for the softest frequency that is at work, estimated from the last step by Rayleigh's
    /// quotient (P. Underwood, "Dynamic relaxation", 1983).
    Critical,
}

/// The dome in lanes \[spacings\].
struct LaneDome {
    center: Vec3,
    squared_axes: Vec3,
}

/// A sheet on its way to rest.
pub(super) struct Explicit<'a> {
    problem: &'a Problem,
    law: &'a Law,
    sheet: LaneSheet,
    dome: LaneDome,
    triangles: Vec<Triangle>,
    damping: Damping,
    u: Field,
    /// The last step, and what rounding kept back of it.
    step: Field,
    carry: Field,
    f: Field,
    /// Forces one step before.
    before: Field,
    /// 1/k at free nodes, else 0.
    mobility: Vec<f32>,
    /// Square of the dome's level plus 1 at which each node touches.
    touch: Vec<f32>,
    keep: f64,
    /// Running sums of Rayleigh's quotient, and the least frequency so far.
    quotient: [f64; 2],
    least_frequency: f64,
}

impl<'a> Explicit<'a> {
    /// `touch`: the dome's levels at which nodes touch, where that is not zero.
    pub(super) fn new(
        problem: &'a Problem,
        law: &'a Law,
        touch: &[(usize, f64)],
        damping: Damping,
    ) -> Self {
        let sheet = LaneSheet::new(&problem.sheet);
        let field = || Field::new(sheet.len());
        let triangles =
            problem.sheet.triangles().map(|(t, w)| Triangle::new(&problem.sheet, t, w)).collect();
        let mut new = Self {
            dome: LaneDome::new(&problem.obstacle.dome, problem.sheet.spacing_mm()),
            u: field(),
            step: field(),
            carry: field(),
            f: field(),
            before: field(),
            mobility: vec![0.0; sheet.len()],
            touch: vec![1.0; sheet.len()],
            keep: 0.0,
            quotient: [0.0; 2],
            least_frequency: f64::INFINITY,
            sheet,
            triangles,
            problem,
            law,
            damping,
        };
        let side = problem.sheet.nodes_per_side();
        for &(k, level) in touch {
            new.touch[k / side * new.sheet.pitch + k % side] = (1.0 + level).powi(2) as f32;
        }
        new
    }

    /// Goes on until the watch, or the number of steps, ends it.
    pub(super) fn run(&mut self, most_steps: u32, watch: &mut Watch) -> End {
        let problem = self.problem;
        let first = match self.damping {
            Damping::Paper => guess::drape(&problem.sheet, &problem.obstacle.dome),
            Damping::Critical => guess::tight_string(&problem.sheet, &problem.obstacle.dome),
        };
        self.sheet.read(&problem.sheet, &first, &mut self.u);
        for field in [&mut self.step, &mut self.carry] {
            field.parts.iter_mut().for_each(|part| part.fill(0.0));
        }
        self.keep = match self.damping {
            Damping::Paper => PAPER_KEPT,
            Damping::Critical => 0.0,
        };
        (self.quotient, self.least_frequency) = ([0.0; 2], f64::INFINITY);
        for steps in 0..most_steps {
            if steps == 0 || RENEWED_AT.contains(&steps) || steps % RENEWED_EVERY == 0 {
                self.renew_masses();
            }
            std::mem::swap(&mut self.f, &mut self.before);
            self.sheet.forces(self.law, &self.u, &mut self.f);
            self.move_nodes(steps == 0);
            let steps = steps + 1;
            if watch.is_due(steps) || steps == most_steps {
                let (sheet, u) = (&self.sheet, &self.u);
                let write = |x: &mut [DVec3]| sheet.write(&problem.sheet, u, x);
                if let Some(end) = watch.look(steps, f64::from(steps), write) {
                    return end;
                }
            }
        }
        End::Finished
    }

    /// Gershgorin's bound on every node's row of the stiffness, triangle by triangle.
    fn renew_masses(&mut self) {
        let pitch = self.sheet.pitch;
        let side = self.problem.sheet.nodes_per_side();
        let place = |k: usize| k / side * pitch + k % side;
        self.mobility.fill(0.0);
        for triangle in &self.triangles {
            let x = triangle.nodes.map(|k| {
                let [a, b, c] = self.u.parts.each_ref().map(|part| f64::from(part[place(k)]));
                DVec3::new((k % side) as f64 + a, (k / side) as f64 + b, c)
            });
            let [_, g1, g2] = triangle.gradients;
            let (e1, e2) = (x[1] - x[0], x[2] - x[0]);
            let (f1, f2) = (e1 * g1.x + e2 * g2.x, e1 * g1.y + e2 * g2.y);
            let metric = [f1.length_squared(), f2.length_squared(), f1.dot(f2)];
            let stiffness = triangle.area * self.law.greatest_stiffness(metric);
            for (k, g) in triangle.nodes.into_iter().zip(triangle.gradients) {
                let row: f64 = triangle.gradients.iter().map(|other| g.dot(*other).abs()).sum();
                self.mobility[place(k)] += (stiffness * row) as f32;
            }
        }
        for (k, kind) in self.problem.sheet.kinds().iter().enumerate() {
            let mobility = &mut self.mobility[place(k)];
            *mobility = if *kind == NodeKind::Free { 1.0 / *mobility } else { 0.0 };
        }
    }

    /// One step of all nodes; then the damping of the next one.
    fn move_nodes(&mut self, is_first: bool) {
        let gain = match self.damping {
            Damping::Paper => PAPER_GAIN,
            Damping::Critical => SAFETY * 2.0 * (1.0 + self.keep),
        };
        let (keep, gain_lanes) = (f32x4::splat(self.keep as f32), f32x4::splat(gain as f32));
        let side = self.problem.sheet.nodes_per_side();
        let half = (side / 2) as f32;
        let (mut stiffness, mut mass) = (0.0, 0.0);
        for j in 0..side {
            let (from, to) = self.sheet.blocks[j];
            let y = f32x4::splat(j as f32 - half);
            let (mut row_stiffness, mut row_mass) = (f32x4::ZERO, f32x4::ZERO);
            for block in from..to {
                let k = j * self.sheet.pitch + 4 * block;
                let mobility = load(&self.mobility, k);
                let is_free = mobility.simd_gt(f32x4::ZERO);
                let (u, f) = (self.u.load(k), self.f.load(k));
                let last = self.step.load(k);
                row_stiffness += dot(last, sub(self.before.load(k), f));
                row_mass += is_free.bitselect(dot(last, last) / mobility, f32x4::ZERO);
                let step = add(scale(last, keep), scale(f, gain_lanes * mobility));
                let first = 4.0 * block as f32 - half;
                let grid =
                    [f32x4::new([first, first + 1.0, first + 2.0, first + 3.0]), y, f32x4::ZERO];
                let wanted = add(step, self.carry.load(k));
                let (moved, is_put_back) =
                    self.dome.outside(grid, add(u, wanted), load(&self.touch, k), is_free);
                self.u.store(k, moved);
                let done = sub(moved, u);
                let keep_step = |a: f32x4, b: f32x4| is_put_back.bitselect(a, b);
                self.step.store(k, [0, 1, 2].map(|axis| keep_step(done[axis], step[axis])));
                let left = sub(wanted, done);
                self.carry.store(k, left.map(|left| keep_step(f32x4::ZERO, left)));
            }
            stiffness += f64::from(row_stiffness.reduce_add());
            mass += f64::from(row_mass.reduce_add());
        }
        if self.damping == Damping::Critical && !is_first {
            self.estimate_damping(stiffness, mass);
        }
    }

    /// Critical damping for Rayleigh's quotient of the last steps; rounding, which makes it grow once
    /// the steps are small, is kept out.
    fn estimate_damping(&mut self, stiffness: f64, mass: f64) {
        for (sum, new) in self.quotient.iter_mut().zip([stiffness, mass]) {
            *sum = QUOTIENT_MEMORY * *sum + new;
        }
        let [stiffness, mass] = self.quotient;
        let squared = (stiffness / mass.max(f64::MIN_POSITIVE)).max(0.0);
        let frequency = (SAFETY * 4.0 * squared).sqrt();
        self.least_frequency = self.least_frequency.min(frequency.max(LEAST_FREQUENCY));
        let frequency = frequency.min(MOST_RISE * self.least_frequency);
        self.keep = ((2.0 - frequency) / (2.0 + frequency)).clamp(0.0, MOST_KEPT);
    }
}

impl LaneDome {
    fn new(dome: &Dome, spacing: f64) -> Self {
        let origin = dome.origin() / spacing;
        let axes = DVec3::new(dome.base_radius, dome.base_radius, dome.projection) / spacing;
        let splat = |v: DVec3| v.to_array().map(|value| f32x4::splat(value as f32));
        Self { center: splat(origin), squared_axes: splat(axes * axes) }
    }

    /// Displacements `u` from the places `grid`, put above the wall and then out of the dome along the
    /// ray from its centre (for a hemisphere the shortest way), and which of them were.
    #[inline(always)]
    fn outside(&self, grid: Vec3, u: Vec3, touch: f32x4, is_free: f32x4) -> (Vec3, f32x4) {
        let is_below = u[2].simd_lt(f32x4::ZERO) & is_free;
        let u = [u[0], u[1], is_below.bitselect(f32x4::ZERO, u[2])];
        let ray = sub(add(grid, u), self.center);
        let [a, b, c] = self.squared_axes;
        let level = ray[0] * ray[0] / a + ray[1] * ray[1] / b + ray[2] * ray[2] / c;
        let is_inside = level.simd_lt(touch) & is_free;
        if !is_inside.any() {
            return (u, is_below);
        }
        let out = sub(add(scale(ray, (touch / level).sqrt()), self.center), grid);
        ([0, 1, 2].map(|axis| is_inside.bitselect(out[axis], u[axis])), is_below | is_inside)
    }
}

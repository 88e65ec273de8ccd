//! Explicit time steps with damping (dynamic relaxation), four f32 lanes at a time.
//!
//! Every node moves by Δ ← keep·Δ + γ f/k, with k a bound on the node's row of the stiffness: masses k/λ
//! and a time step of Δt²λ = γ, stable up to γ = 2(1 + keep). Then the node is projected out of the dome
//! and above the wall. The paper relaxes its springs by the same scheme.

use super::initial_guess;
use super::lanes::{Field, LaneSheet, Triangle, Vec3, add, dot, load, scale, sub};
use super::law::Law;
use super::watch::{End, Watch};
use crate::contact::Dome;
use crate::mesh::NodeKind;
use crate::solve::Problem;
use glam::DVec3;
use wide::f32x4;

/// Safety factor on the greatest stable γ from the taut profile; the sheet may stiffen between two updates
/// of the masses.
const SAFETY: f64 = 0.9;
/// γ of the paper's experiment (see [`crate::experiment::tension`]); from the draped sheet a step close to
/// the stability limit diverges.
const PAPER_GAIN: f64 = 0.5;
/// Velocity factor of the paper's experiment \[-\].
const PAPER_VELOCITY_FACTOR: f64 = 0.95;
/// First steps with an update of the nodal masses.
const MASS_UPDATES: [u32; 4] = [10, 30, 80, 200];
/// Steps between two later updates of the nodal masses.
const MASS_UPDATE_INTERVAL: u32 = 500;
/// Greatest velocity factor of critical damping \[-\].
const MAX_VELOCITY_FACTOR: f64 = 0.9995;
/// Weight of the previous steps in Rayleigh's quotient \[-\].
const QUOTIENT_MEMORY: f64 = 0.9;
/// Lower bound of the frequency \[1/step\].
const MIN_FREQUENCY: f64 = 1e-3;
/// Greatest ratio of the frequency to the smallest frequency so far \[-\].
const MAX_FREQUENCY_RATIO: f64 = 2.0;

/// Damping: the fraction of a step added to the next step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Damping {
    /// Constant velocity factor of the paper's experiment.
    Paper,
    /// Critical damping of the lowest active frequency, estimated from the last step by Rayleigh's quotient
    /// (P. Underwood, "Dynamic relaxation", 1983).
    Critical,
}

/// The dome in lanes \[spacings\].
struct LaneDome {
    center: Vec3,
    squared_axes: Vec3,
}

/// Dynamic relaxation of a sheet.
pub(super) struct Explicit<'a> {
    problem: &'a Problem,
    law: &'a Law,
    sheet: LaneSheet,
    dome: LaneDome,
    triangles: Vec<Triangle>,
    damping: Damping,
    u: Field,
    /// The last step.
    step: Field,
    /// Rounding error of the last step (compensated summation).
    carry: Field,
    f: Field,
    /// Forces of the previous step.
    previous_f: Field,
    /// 1/k at free nodes, else 0.
    mobility: Vec<f32>,
    /// Square of the dome's gauge plus 1 at contact of each node.
    touch: Vec<f32>,
    keep: f64,
    /// Running sums of Rayleigh's quotient: stiffness and mass.
    quotient: [f64; 2],
    /// Smallest frequency so far.
    least_frequency: f64,
}

impl<'a> Explicit<'a> {
    /// Creates the scheme; `touch` contains the nodes with a non-zero gauge of the dome at contact.
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
            previous_f: field(),
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

    /// Runs until the watch ends the run or for the greatest number of steps.
    pub(super) fn run(&mut self, max_steps: u32, watch: &mut Watch) -> End {
        let problem = self.problem;
        let first = match self.damping {
            Damping::Paper => initial_guess::drape(&problem.sheet, &problem.obstacle.dome),
            Damping::Critical => {
                initial_guess::taut_profile(&problem.sheet, &problem.obstacle.dome)
            }
        };
        self.sheet.read(&problem.sheet, &first, &mut self.u);
        for field in [&mut self.step, &mut self.carry] {
            field.parts.iter_mut().for_each(|part| part.fill(0.0));
        }
        self.keep = match self.damping {
            Damping::Paper => PAPER_VELOCITY_FACTOR,
            Damping::Critical => 0.0,
        };
        (self.quotient, self.least_frequency) = ([0.0; 2], f64::INFINITY);
        for steps in 0..max_steps {
            if steps == 0 || MASS_UPDATES.contains(&steps) || steps % MASS_UPDATE_INTERVAL == 0 {
                self.update_masses();
            }
            std::mem::swap(&mut self.f, &mut self.previous_f);
            self.sheet.forces(self.law, &self.u, &mut self.f);
            self.move_nodes(steps == 0);
            let steps = steps + 1;
            if watch.is_due(steps) || steps == max_steps {
                let (sheet, u) = (&self.sheet, &self.u);
                let write = |x: &mut [DVec3]| sheet.write(&problem.sheet, u, x);
                if let Some(end) = watch.sample(steps, f64::from(steps), write) {
                    return end;
                }
            }
        }
        End::Finished
    }

    /// Updates the mobilities from Gershgorin's bound on every node's row of the stiffness.
    fn update_masses(&mut self) {
        let pitch = self.sheet.pitch;
        let side = self.problem.sheet.nodes_per_side();
        let index = |k: usize| k / side * pitch + k % side;
        self.mobility.fill(0.0);
        for triangle in &self.triangles {
            let x = triangle.nodes.map(|k| {
                let [a, b, c] = self.u.parts.each_ref().map(|part| f64::from(part[index(k)]));
                DVec3::new((k % side) as f64 + a, (k / side) as f64 + b, c)
            });
            let [_, g1, g2] = triangle.gradients;
            let (e1, e2) = (x[1] - x[0], x[2] - x[0]);
            let (f1, f2) = (e1 * g1.x + e2 * g2.x, e1 * g1.y + e2 * g2.y);
            let metric = [f1.length_squared(), f2.length_squared(), f1.dot(f2)];
            let stiffness = triangle.area * self.law.greatest_stiffness(metric);
            for (k, g) in triangle.nodes.into_iter().zip(triangle.gradients) {
                let row: f64 = triangle.gradients.iter().map(|other| g.dot(*other).abs()).sum();
                self.mobility[index(k)] += (stiffness * row) as f32;
            }
        }
        for (k, kind) in self.problem.sheet.kinds().iter().enumerate() {
            let mobility = &mut self.mobility[index(k)];
            *mobility = if *kind == NodeKind::Free { 1.0 / *mobility } else { 0.0 };
        }
    }

    /// Moves all nodes by one step and computes the damping of the next step.
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
                row_stiffness += dot(last, sub(self.previous_f.load(k), f));
                row_mass += is_free.bitselect(dot(last, last) / mobility, f32x4::ZERO);
                let step = add(scale(last, keep), scale(f, gain_lanes * mobility));
                let first = 4.0 * block as f32 - half;
                let grid =
                    [f32x4::new([first, first + 1.0, first + 2.0, first + 3.0]), y, f32x4::ZERO];
                let target = add(step, self.carry.load(k));
                let (moved, is_projected) =
                    self.dome.outside(grid, add(u, target), load(&self.touch, k), is_free);
                self.u.store(k, moved);
                let done = sub(moved, u);
                let keep_step = |a: f32x4, b: f32x4| is_projected.bitselect(a, b);
                self.step.store(k, [0, 1, 2].map(|axis| keep_step(done[axis], step[axis])));
                let left = sub(target, done);
                self.carry.store(k, left.map(|left| keep_step(f32x4::ZERO, left)));
            }
            stiffness += f64::from(row_stiffness.reduce_add());
            mass += f64::from(row_mass.reduce_add());
        }
        if self.damping == Damping::Critical && !is_first {
            self.estimate_damping(stiffness, mass);
        }
    }

    /// Computes the critical damping from Rayleigh's quotient of the last steps. The frequency ratio is
    /// bounded, because rounding raises the quotient of small steps.
    fn estimate_damping(&mut self, stiffness: f64, mass: f64) {
        for (sum, new) in self.quotient.iter_mut().zip([stiffness, mass]) {
            *sum = QUOTIENT_MEMORY * *sum + new;
        }
        let [stiffness, mass] = self.quotient;
        let squared = (stiffness / mass.max(f64::MIN_POSITIVE)).max(0.0);
        let frequency = (SAFETY * 4.0 * squared).sqrt();
        self.least_frequency = self.least_frequency.min(frequency.max(MIN_FREQUENCY));
        let frequency = frequency.min(MAX_FREQUENCY_RATIO * self.least_frequency);
        self.keep = ((2.0 - frequency) / (2.0 + frequency)).clamp(0.0, MAX_VELOCITY_FACTOR);
    }
}

impl LaneDome {
    fn new(dome: &Dome, spacing: f64) -> Self {
        let origin = dome.origin() / spacing;
        let axes = DVec3::new(dome.base_radius, dome.base_radius, dome.projection) / spacing;
        let splat = |v: DVec3| v.to_array().map(|value| f32x4::splat(value as f32));
        Self { center: splat(origin), squared_axes: splat(axes * axes) }
    }

    /// Projects the displacements `u` from the positions `grid` above the wall, then out of the dome along
    /// the ray from the dome's centre (the closest point for a hemisphere); returns the mask of the
    /// projected nodes as well.
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

//! Explicit time steps with damping (dynamic relaxation), four f32 lanes at a time.
//!
//! Every node moves by Δ ← keep·Δ + γ f/k, with k a bound on the node's row of the stiffness: masses k/λ
//! and a time step of Δt²λ = γ, stable up to γ = 2(1 + keep). Then the node is projected out of the dome
//! and above the wall. The paper relaxes its springs by the same scheme.

use super::law::Law;
use super::watch::{End, Watch};
use crate::contact::Obstacle;
use crate::contact::lanes::LaneObstacle;
use crate::mesh::lanes::{Field, Layout, load, store_first};
use crate::mesh::vec3::{add, dot, scale, sub};
use crate::mesh::{NodeKind, Sheet};
use crate::model::ElasticModel;
use crate::model::membrane::lanes::{Membrane, Scratch};
use crate::model::membrane::law::SheetLaw;
use crate::model::membrane::triangle::{Principal, Rest};
use crate::solve::{Problem, initial_guess};
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

/// Dynamic relaxation of a sheet, with the forces of full multigrid.
pub(super) struct Explicit<'a> {
    problem: &'a Problem,
    law: &'a Law,
    model: Membrane,
    layout: Layout,
    scratch: Scratch,
    obstacle: LaneObstacle,
    /// Nodes and shapes at rest \[spacings\].
    triangles: Vec<([usize; 3], Rest)>,
    damping: Damping,
    /// Displacements \[spacings\].
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
    /// Gauge of the dome plus 1 at contact of each node.
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
        let Problem { sheet, obstacle, springs, materials, .. } = problem;
        let (layout, border) = Layout::new(sheet.nodes_per_side(), [false; 2]);
        let length = layout.len();
        let model = Membrane::new(&SheetLaw::new(*springs, materials));
        let field = || Field::new(length, model.layers());
        let per_spacing = 1.0 / sheet.spacing_mm();
        let rest = |(nodes, weight): ([usize; 3], f64)| {
            (nodes, Rest::new(nodes.map(|k| sheet.rest()[k] * per_spacing), weight))
        };
        let mut new = Self {
            scratch: model.scratch(&layout, &border),
            obstacle: LaneObstacle::new(&obstacle.scaled(per_spacing)),
            triangles: sheet.triangles().map(rest).collect(),
            u: field(),
            step: field(),
            carry: field(),
            f: field(),
            previous_f: field(),
            mobility: vec![0.0; length],
            touch: vec![1.0; length],
            keep: 0.0,
            quotient: [0.0; 2],
            least_frequency: f64::INFINITY,
            layout,
            model,
            problem,
            law,
            damping,
        };
        for &(k, gauge) in touch {
            let stored = new.stored(k);
            new.touch[stored] = (1.0 + gauge) as f32;
        }
        new
    }

    /// Where a node of the sheet is stored.
    fn stored(&self, k: usize) -> usize {
        let side = self.layout.nodes_per_side;
        k / side * self.layout.pitch + k % side
    }

    /// Runs until the watch ends the run or for the greatest number of steps.
    pub(super) fn run(&mut self, max_steps: u32, watch: &mut Watch) -> End {
        let Problem { sheet, obstacle, .. } = self.problem;
        let first = match self.damping {
            Damping::Paper => drape(sheet, obstacle),
            Damping::Critical => initial_guess::taut_profile(sheet, &obstacle.dome),
        };
        for (k, x) in first.iter().enumerate() {
            if sheet.kinds()[k] == NodeKind::Free {
                let u = (*x - sheet.rest_position(k)) / sheet.spacing_mm();
                let k = self.stored(k);
                (self.u.x[k], self.u.y[k], self.u.z[k]) = u.as_vec3().into();
            }
        }
        self.step.fill_zero();
        self.carry.fill_zero();
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
            self.model.forces(&self.layout, &self.u, &mut self.f, &mut self.scratch);
            self.move_nodes(steps == 0);
            let steps = steps + 1;
            if watch.is_due(steps) || steps == max_steps {
                let write = |x: &mut [DVec3]| self.write(x);
                if let Some(end) = watch.sample(steps, f64::from(steps), write) {
                    return end;
                }
            }
        }
        End::Finished
    }

    /// Writes the positions of the free nodes \[mm\].
    fn write(&self, x: &mut [DVec3]) {
        let sheet = &self.problem.sheet;
        for k in (0..x.len()).filter(|&k| sheet.kinds()[k] == NodeKind::Free) {
            x[k] = sheet.rest_position(k) + self.displacement(k) * sheet.spacing_mm();
        }
    }

    fn displacement(&self, k: usize) -> DVec3 {
        DVec3::from(self.u.at(self.stored(k)).map(f64::from))
    }

    /// Updates the mobilities from Gershgorin's bound on every node's row of the stiffness.
    fn update_masses(&mut self) {
        let sheet = &self.problem.sheet;
        let per_spacing = 1.0 / sheet.spacing_mm();
        let mut bounds = vec![0.0; sheet.len()];
        for (nodes, rest) in &self.triangles {
            let x = nodes.map(|k| sheet.rest_position(k) * per_spacing + self.displacement(k));
            let [f1, f2] = Principal::columns(rest, x);
            let stiffness = rest.area * self.law.greatest_stiffness(f1, f2);
            for (k, g) in nodes.iter().zip(rest.gradients) {
                let row: f64 = rest.gradients.iter().map(|other| g.dot(*other).abs()).sum();
                bounds[*k] += stiffness * row;
            }
        }
        self.mobility.fill(0.0);
        for (k, bound) in bounds.into_iter().enumerate() {
            if sheet.kinds()[k] == NodeKind::Free {
                let stored = self.stored(k);
                self.mobility[stored] = (1.0 / bound) as f32;
            }
        }
    }

    /// Moves all nodes by one step and computes the damping of the next step.
    fn move_nodes(&mut self, is_first: bool) {
        let gain = match self.damping {
            Damping::Paper => PAPER_GAIN,
            Damping::Critical => SAFETY * 2.0 * (1.0 + self.keep),
        };
        let (keep, gain) = (f32x4::splat(self.keep as f32), f32x4::splat(gain as f32));
        let (mut stiffness, mut mass) = (0.0, 0.0);
        let Self { layout, obstacle, u, f, previous_f, step, carry, mobility, touch, .. } = self;
        layout.free_groups(|group| {
            let (k, count) = (group.first, group.count);
            let mobility = load(mobility, k);
            let is_free = mobility.simd_gt(f32x4::ZERO);
            let (at, force, last) = (u.load(k), f.load(k), step.load(k));
            let work = dot(last, sub(previous_f.load(k), force));
            stiffness += f64::from(is_free.bitselect(work, f32x4::ZERO).reduce_add());
            let inertia = is_free.bitselect(dot(last, last) / mobility, f32x4::ZERO);
            mass += f64::from(inertia.reduce_add());
            let next = add(scale(last, keep), scale(force, gain * mobility));
            let wanted = add(next, carry.load(k));
            let target = add(at, wanted);
            let moved = obstacle.projected(group.rest, target, load(touch, k));
            let projection = sub(moved, target);
            let is_projected = dot(projection, projection).simd_gt(f32x4::ZERO);
            let done = sub(moved, at);
            let left = sub(wanted, done);
            store_first(u, k, count, moved);
            let kept = [0, 1, 2].map(|a| is_projected.bitselect(done[a], next[a]));
            store_first(step, k, count, kept);
            let left = left.map(|left| is_projected.bitselect(f32x4::ZERO, left));
            store_first(carry, k, count, left);
        });
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

/// The sheet at rest projected vertically onto the dome: positions \[mm\], shape (nodes_per_side², ).
fn drape(sheet: &Sheet, obstacle: &Obstacle) -> Vec<DVec3> {
    let mut x = sheet.rest_positions();
    for (k, x) in x.iter_mut().enumerate() {
        if sheet.kinds()[k] == NodeKind::Free {
            x.z = obstacle.dome.height(sheet.rest()[k]);
        }
    }
    x
}

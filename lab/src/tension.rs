//! The paper's tension test (Nikolaev 2013, "Elongation deformation modeling results"): the stress–strain
//! curve and the Poisson ratio of a square sample under forces on its border.
//!
//! The loads are the stresses `Ef` at the strains 1/50 to 1. A load of σ \[kPa\] is a nominal stress: every
//! border edge of a cell carries σ·L·h, half on each of the edge's two nodes, twice the force on a node of
//! two cells, as in the paper.
//!
//! * [`Protocol::Paper`] relaxes by the paper's method: 15 000 damped explicit iterations per load from the
//!   shape of the previous load. Without a stable shape the sample diverges or ends in another,
//!   inhomogeneous shape.
//! * [`Protocol::Equilibrium`] follows the equilibrium path by Newton's method with the true Hessian, also
//!   through unstable intervals; the Hessian determines the stability.
//!
//! A row with an unstable shape has no measured values.

use super::dense::Matrix;
use super::sample::{Sample, rigid_modes};
use glam::{DMat2, DVec2};
use implant_preview_core::curve::Curve;
use implant_preview_core::springs::Springs;

/// Iterations per load in the paper.
pub const PAPER_ITERATIONS: u32 = 15_000;
/// Number of loads between strain 0 and 1.
pub const LOADS: u32 = 50;
/// Tolerance of the equilibrium: greatest residual of a node \[fraction of the greatest load\].
const EQUILIBRIUM_TOLERANCE: f64 = 1e-11;

/// Solution method under each load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Protocol {
    /// 15 000 damped explicit iterations per load.
    Paper,
    /// Newton's method for the equilibrium, stability from the Hessian.
    Equilibrium,
}

/// A tension test: material, sample and protocol.
#[derive(Clone, Debug)]
pub struct Test {
    /// The spring law.
    pub springs: Springs,
    /// Stress–strain curve of the sample.
    pub curve: Curve,
    /// Prescribed Poisson ratio ν \[-\], 0 to 0.5.
    pub poisson_ratio: f64,
    /// Cells per side of the sample, ≥ 1 (the paper: 4).
    pub cells: usize,
    /// Angle of the tension to the grid \[rad\].
    pub angle: f64,
    /// Solution method.
    pub protocol: Protocol,
}

/// Outcome under one load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// A stable equilibrium.
    Converged,
    /// The shape is stable but not at rest after all iterations, or no equilibrium was found.
    NotConverged,
    /// No stable equilibrium: the Hessian has a negative eigenvalue, or the sample diverged.
    Unstable,
}

/// Strains measured on the sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Axial strain \[-\].
    pub strain: f64,
    /// Transverse strain \[-\].
    pub transverse_strain: f64,
}

impl Measured {
    /// Measured Poisson ratio \[-\].
    #[must_use]
    pub fn poisson_ratio(&self) -> f64 {
        -self.transverse_strain / self.strain
    }
}

/// One load of the experiment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// Applied nominal stress \[kPa\].
    pub load_kpa: f64,
    /// The strain with this stress on the curve Ef \[-\].
    pub strain_expected: f64,
    /// Measured strains; `None` if the shape is unstable or no shape was found.
    pub measured: Option<Measured>,
    /// Outcome.
    pub status: Status,
}

/// The whole experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// One row per load, loads rising.
    pub rows: Vec<Row>,
    /// The expected strain at the first loss of stability \[-\]: accurate to 0.001 in
    /// [`Protocol::Equilibrium`], the first unstable row in [`Protocol::Paper`]; `None` without a loss.
    pub stability_lost_at: Option<f64>,
}

impl Report {
    /// Greatest relative error of the measured Poisson ratio \[-\] over all stable rows.
    #[must_use]
    pub fn greatest_poisson_error(&self, poisson_ratio: f64) -> Option<f64> {
        let error = |m: Measured| (m.poisson_ratio() / poisson_ratio - 1.0).abs();
        self.rows.iter().filter_map(|row| row.measured).map(error).reduce(f64::max)
    }
}

/// Name of a spring law in tables.
#[must_use]
pub fn springs_name(springs: Springs) -> &'static str {
    match springs {
        Springs::Coupled => "coupled",
        Springs::Nikolaev => "nikolaev",
    }
}

/// Runs the tension test.
#[must_use]
pub fn run(test: &Test) -> Report {
    let sample = Sample::new(test.cells, test.springs, &test.curve, test.poisson_ratio);
    let pull = Pull { sample: &sample, direction: DVec2::from_angle(test.angle) };
    match test.protocol {
        Protocol::Paper => relax_all(&pull),
        Protocol::Equilibrium => follow_all(&pull),
    }
}

/// A sample and the direction of the tension.
struct Pull<'a> {
    sample: &'a Sample,
    direction: DVec2,
}

impl Pull<'_> {
    fn stress(&self, strain: f64) -> f64 {
        self.sample.curve().stress(strain)
    }

    /// Border loads \[mN\] of the nominal stress Ef(strain) in the direction of the tension.
    fn loads(&self, strain: f64) -> Vec<DVec2> {
        let d = self.direction;
        let stress = self.stress(strain) * DMat2::from_cols(d * d.x, d * d.y);
        self.sample.border_loads(stress)
    }

    /// The homogeneous shape with the axial strain and −ν times as much transverse strain.
    fn homogeneous(&self, strain: f64) -> Vec<DVec2> {
        let (along, across) = (self.direction, self.direction.perp());
        let [a, b] = [1.0 + strain, 1.0 - self.sample.poisson_ratio() * strain];
        let stretch = |x: &DVec2| along * (a * along.dot(*x)) + across * (b * across.dot(*x));
        self.sample.rest().iter().map(stretch).collect()
    }

    /// The row of a load, with measured strains if a stable shape was found.
    fn row(&self, strain: f64, x: Option<&[DVec2]>, status: Status) -> Row {
        let measured = x.filter(|_| status != Status::Unstable).map(|x| self.measure(x));
        Row { load_kpa: self.stress(strain), strain_expected: strain, measured, status }
    }

    /// Strains of the bounding box for tension along a grid axis, as in the paper; at an angle the axial and
    /// transverse strains of the affine map that fits the shape by least squares.
    fn measure(&self, x: &[DVec2]) -> Measured {
        let rest = self.sample.rest();
        let [along, across] = if self.direction.y.abs() < 1e-12 {
            let size = |x: &[DVec2]| {
                let least = x.iter().copied().fold(DVec2::INFINITY, DVec2::min);
                x.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max) - least
            };
            (size(x) / size(rest)).to_array()
        } else {
            let fit = affine_fit(rest, x);
            [self.direction, self.direction.perp()].map(|d| d.dot(fit * d))
        };
        Measured { strain: along - 1.0, transverse_strain: across - 1.0 }
    }
}

/// Deformation gradient F of the affine map that fits `x` by least squares.
fn affine_fit(rest: &[DVec2], x: &[DVec2]) -> DMat2 {
    let n = rest.len() as f64;
    let (c, d) = (rest.iter().sum::<DVec2>() / n, x.iter().sum::<DVec2>() / n);
    let outer = |a: DVec2, b: DVec2| DMat2::from_cols(a * b.x, a * b.y);
    let (mut now, mut before) = (DMat2::ZERO, DMat2::ZERO);
    for (rest, x) in rest.iter().zip(x) {
        now += outer(*x - d, *rest - c);
        before += outer(*rest - c, *rest - c);
    }
    now * before.inverse()
}

fn expected_strains() -> impl Iterator<Item = f64> {
    (1..=LOADS).map(|k| f64::from(k) / f64::from(LOADS))
}

// --- Protocol `equilibrium` ---------------------------------------------------------------------

/// Follows the equilibrium path from load to load.
fn follow_all(pull: &Pull) -> Report {
    let mut rows: Vec<Row> = Vec::new();
    let (mut shape, mut at) = (pull.sample.rest().to_vec(), 0.0);
    let mut stability_lost_at = None;
    for strain in expected_strains() {
        let Some(next) = reach(pull, &shape, at, strain) else {
            rows.push(pull.row(strain, None, Status::NotConverged));
            continue;
        };
        let status =
            if pull.sample.is_stable(&next) { Status::Converged } else { Status::Unstable };
        if status == Status::Unstable && stability_lost_at.is_none() {
            stability_lost_at = Some(stability_limit(pull, &shape, at, strain));
        }
        rows.push(pull.row(strain, Some(&next), status));
        (shape, at) = (next, strain);
    }
    Report { rows, stability_lost_at }
}

/// Bisects the expected strain at the loss of stability between a stable and an unstable strain.
fn stability_limit(pull: &Pull, stable: &[DVec2], from: f64, to: f64) -> f64 {
    let (mut shape, mut stable_at, mut unstable_at) = (stable.to_vec(), from, to);
    while unstable_at - stable_at > 1e-3 {
        let middle = 0.5 * (stable_at + unstable_at);
        match reach(pull, &shape, stable_at, middle) {
            Some(next) if pull.sample.is_stable(&next) => (shape, stable_at) = (next, middle),
            _ => unstable_at = middle,
        }
    }
    unstable_at
}

/// The equilibrium at the load of strain `to`, from the equilibrium at `from`, otherwise from the
/// homogeneous shape (Newton's method may fail at a jump of the curve's slope).
fn reach(pull: &Pull, start: &[DVec2], from: f64, to: f64) -> Option<Vec<DVec2>> {
    follow(pull, start, from, to, 0).or_else(|| newton(pull, &pull.homogeneous(to), to))
}

/// The equilibrium at the load of strain `to`, from the equilibrium at `from`, with smaller load steps
/// where Newton's method does not converge. `None` without convergence in the smallest step.
fn follow(pull: &Pull, start: &[DVec2], from: f64, to: f64, depth: u32) -> Option<Vec<DVec2>> {
    const MAX_DEPTH: u32 = 5;
    newton(pull, start, to).or_else(|| {
        (depth < MAX_DEPTH).then_some(())?;
        let middle = 0.5 * (from + to);
        let shape = follow(pull, start, from, middle, depth + 1)?;
        follow(pull, &shape, middle, to, depth + 1)
    })
}

/// Newton's method for springs + loads = 0, with the true Hessian and a line search on the residual (not
/// on the energy: the path includes unstable equilibria).
fn newton(pull: &Pull, start: &[DVec2], strain: f64) -> Option<Vec<DVec2>> {
    const MAX_ITERATIONS: u32 = 40;
    let sample = pull.sample;
    let loads = pull.loads(strain);
    let greatest_load = loads.iter().map(|load| load.length()).fold(0.0, f64::max);
    let residual_of = |x: &[DVec2]| {
        let mut residual = loads.clone();
        sample.add_forces(x, &mut residual);
        residual
    };
    let norm = |r: &[DVec2]| r.iter().map(|r| r.length_squared()).sum::<f64>().sqrt();
    let mut x = start.to_vec();
    let mut residual = residual_of(&x);
    for _ in 0..MAX_ITERATIONS {
        let greatest = residual.iter().map(|r| r.length()).fold(0.0, f64::max);
        if greatest <= EQUILIBRIUM_TOLERANCE * greatest_load {
            return (!sample.is_outside_domain(&x)).then_some(x);
        }
        let step = regularised_hessian(sample, &x)
            .solve(residual.iter().flat_map(DVec2::to_array).collect())?;
        let before = norm(&residual);
        let mut length = 1.0;
        loop {
            let moved: Vec<DVec2> = x
                .iter()
                .zip(step.chunks_exact(2))
                .map(|(x, step)| *x + length * DVec2::new(step[0], step[1]))
                .collect();
            let found = residual_of(&moved);
            if norm(&found) < before * (1.0 - 0.1 * length) {
                (x, residual) = (moved, found);
                break;
            }
            length *= 0.5;
            if length < 1e-3 {
                return None;
            }
        }
    }
    None
}

/// The Hessian plus a weak stiffness of the rigid motions, which is regular also at rest. (The loads have
/// no component along rigid motions; the solution does not change.)
fn regularised_hessian(sample: &Sample, x: &[DVec2]) -> Matrix {
    let mut matrix = sample.hessian(x);
    let [along, up, turn] = rigid_modes(x);
    let stiffness = sample.edge_stiffness();
    for (mode, factor) in [(along, 1.0), (up, 1.0), (turn, 1e-6)] {
        matrix.add_outer(factor * stiffness, &mode);
    }
    matrix
}

// --- Protocol `paper` ---------------------------------------------------------------------------

/// Relaxes the sample under the loads in rising order.
fn relax_all(pull: &Pull) -> Report {
    let mut rows: Vec<Row> = Vec::new();
    let mut shape = perturbed(pull.sample.rest());
    let (mut stability_lost_at, mut lost) = (None, false);
    for strain in expected_strains() {
        let status = if lost { Status::Unstable } else { relax(pull, &mut shape, strain) };
        if status == Status::Unstable {
            stability_lost_at.get_or_insert(strain);
            // A diverged sample does not recover under a greater load.
            lost =
                lost || pull.sample.is_outside_domain(&shape) || has_diverged(pull.sample, &shape);
        }
        rows.push(pull.row(strain, Some(&shape), status));
    }
    Report { rows, stability_lost_at }
}

/// The rest shape with a perturbation of about 1e-7 of a cell, the rounding error of single precision.
/// Without the perturbation symmetry alone could preserve an unstable shape.
fn perturbed(rest: &[DVec2]) -> Vec<DVec2> {
    const PERTURBATION_MM: f64 = 1e-7;
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        2.0 * f64::from(state) / f64::from(u32::MAX) - 1.0
    };
    rest.iter().map(|x| *x + PERTURBATION_MM * DVec2::new(random(), random())).collect()
}

/// Returns `true` if the sample has grown to more than four times its size.
fn has_diverged(sample: &Sample, x: &[DVec2]) -> bool {
    let size = sample.rest()[sample.rest().len() - 1].length();
    x.iter().any(|p| p.distance(x[0]).is_nan() || p.distance(x[0]) > 4.0 * size)
}

/// Relaxes the sample by 15 000 damped explicit iterations under one load.
///
/// All nodes have mass 1. The time step obeys Δt²·λ = 1/2 with λ Gershgorin's bound on the greatest
/// eigenvalue of the true Hessian, renewed every 100 iterations (explicit steps are stable up to 4);
/// every iteration keeps 95 % of the velocity, nearly critical damping of the softest mode of the 4 × 4
/// sample. The iterations end early at rest.
fn relax(pull: &Pull, x: &mut [DVec2], strain: f64) -> Status {
    const VELOCITY_FACTOR: f64 = 0.95;
    const REST_RESIDUAL: f64 = 1e-13;
    const TIME_STEP_INTERVAL: u32 = 100;
    let sample = pull.sample;
    let loads = pull.loads(strain);
    let greatest_load = loads.iter().map(|load| load.length()).fold(0.0, f64::max);
    let mut velocity = vec![DVec2::ZERO; x.len()];
    let mut force = loads.clone();
    let mut time_step = 0.0;
    let mut residual = f64::INFINITY;
    for iteration in 0..PAPER_ITERATIONS {
        if iteration % TIME_STEP_INTERVAL == 0 {
            if sample.is_outside_domain(x) || has_diverged(sample, x) {
                return Status::Unstable;
            }
            time_step = (0.5 / sample.hessian(x).greatest_row_sum()).sqrt();
        }
        force.copy_from_slice(&loads);
        sample.add_forces(x, &mut force);
        residual = force.iter().map(|f| f.length()).fold(0.0, f64::max) / greatest_load;
        if residual < REST_RESIDUAL {
            break;
        }
        for ((x, v), f) in x.iter_mut().zip(&mut velocity).zip(&force) {
            *v = VELOCITY_FACTOR * *v + time_step * *f;
            *x += time_step * *v;
        }
    }
    if !sample.is_stable(x) {
        Status::Unstable
    } else if residual > 1e-6 {
        Status::NotConverged
    } else {
        Status::Converged
    }
}

//! The paper's experiment (Nikolaev 2013, "Elongation deformation modeling results"): a square
//! sample is pulled apart by forces on its border; what stress–strain curve and what Poisson ratio
//! does it show?
//!
//! Loads rise so that the strain that `Ef` gives for them goes from 1/50 to 1. A load of σ \[kPa\]
//! is a nominal stress: every border cell edge carries σ·L·h, half on each of its two nodes, so
//! that a node of two cells carries twice, as in the paper.
//!
//! * [`Protocol::Paper`] relaxes as the paper does: 15 000 damped explicit iterations per load,
//!   each load starting from the shape of the last. If the springs have no stable shape there, the
//!   sample runs away or ends in another, uneven shape.
//! * [`Protocol::Equilibrium`] follows the equilibrium by Newton's method with the true Hessian,
//!   through unstable stretches too, and tells from the Hessian whether it is stable.
//!
//! A row whose shape is not stable has no measured values.

use super::dense::Matrix;
use super::sample::{Sample, rigid_modes};
use crate::curve::Curve;
use crate::springs::Springs;
use glam::{DMat2, DVec2};

/// Iterations per load in the paper.
pub const PAPER_ITERATIONS: u32 = 15_000;
/// Number of loads between strain 0 and 1.
pub const LOADS: u32 = 50;
/// A shape is in equilibrium when no node's residual exceeds this share of the greatest load.
const EQUILIBRIUM_TOLERANCE: f64 = 1e-11;

/// How the sample is brought to rest under each load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Protocol {
    /// 15 000 damped explicit iterations per load.
    Paper,
    /// Newton's method on the equilibrium, stability from the Hessian.
    Equilibrium,
}

/// What to pull, and how.
#[derive(Clone, Debug)]
pub struct Test {
    /// The spring law.
    pub springs: Springs,
    /// Stress–strain curve of the sample.
    pub curve: Curve,
    /// Poisson ratio ν asked for \[-\], 0 to 0.5.
    pub poisson_ratio: f64,
    /// Cells per side of the sample, ≥ 1 (the paper: 4).
    pub cells: usize,
    /// Angle of the pull to the grid \[rad\].
    pub angle: f64,
    /// How it is brought to rest.
    pub protocol: Protocol,
}

/// What became of the sample under one load.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// A stable equilibrium.
    Converged,
    /// Not at rest after all iterations, but stable; or no equilibrium was found.
    NotConverged,
    /// No stable equilibrium: the Hessian has a negative direction, or the sample ran away.
    Unstable,
}

/// Strains measured on the sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// Along the pull \[-\].
    pub strain: f64,
    /// Across the pull \[-\].
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
    /// Nominal stress applied \[kPa\].
    pub load_kpa: f64,
    /// The strain at which Ef gives this stress \[-\].
    pub strain_expected: f64,
    /// What was measured; `None` when the shape is not stable, or none was found.
    pub measured: Option<Measured>,
    /// What became of the sample.
    pub status: Status,
}

/// The whole experiment.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// One row per load, loads rising.
    pub rows: Vec<Row>,
    /// The expected strain at which stability is lost first \[-\]: to 0.001 in
    /// [`Protocol::Equilibrium`], the first unstable row in [`Protocol::Paper`]; `None` if it never is.
    pub stability_lost_at: Option<f64>,
}

impl Report {
    /// The greatest relative error of the measured Poisson ratio \[-\] over all stable rows.
    #[must_use]
    pub fn greatest_poisson_error(&self, poisson_ratio: f64) -> Option<f64> {
        let error = |m: Measured| (m.poisson_ratio() / poisson_ratio - 1.0).abs();
        self.rows.iter().filter_map(|row| row.measured).map(error).reduce(f64::max)
    }

    /// The greatest relative error of the stress \[-\]: load against Ef at the measured strain.
    #[must_use]
    pub fn greatest_stress_error(&self, curve: &Curve) -> Option<f64> {
        let error =
            |row: &Row| Some((row.load_kpa / curve.stress(row.measured?.strain) - 1.0).abs());
        self.rows.iter().filter_map(error).reduce(f64::max)
    }
}

/// Pulls the sample.
#[must_use]
pub fn run(test: &Test) -> Report {
    let sample = Sample::new(test.cells, test.springs, &test.curve, test.poisson_ratio);
    let pull = Pull { sample: &sample, direction: DVec2::from_angle(test.angle) };
    match test.protocol {
        Protocol::Paper => relax_all(&pull),
        Protocol::Equilibrium => follow_all(&pull),
    }
}

/// A sample and the direction in which it is pulled.
struct Pull<'a> {
    sample: &'a Sample,
    direction: DVec2,
}

impl Pull<'_> {
    fn stress(&self, strain: f64) -> f64 {
        self.sample.curve().stress(strain)
    }

    /// Border loads \[mN\] of the nominal stress Ef(strain) along the pull.
    fn loads(&self, strain: f64) -> Vec<DVec2> {
        let d = self.direction;
        let stress = self.stress(strain) * DMat2::from_cols(d * d.x, d * d.y);
        self.sample.border_loads(stress)
    }

    /// The shape stretched evenly by the strain along the pull and by −ν times as much across.
    fn even(&self, strain: f64) -> Vec<DVec2> {
        let (along, across) = (self.direction, self.direction.perp());
        let [a, b] = [1.0 + strain, 1.0 - self.sample.poisson_ratio() * strain];
        let stretch = |x: &DVec2| along * (a * along.dot(*x)) + across * (b * across.dot(*x));
        self.sample.rest().iter().map(stretch).collect()
    }

    /// What is measured on a shape, if one was found and is stable.
    fn row(&self, strain: f64, x: Option<&[DVec2]>, status: Status) -> Row {
        let measured = x.filter(|_| status != Status::Unstable).map(|x| self.measure(x));
        Row { load_kpa: self.stress(strain), strain_expected: strain, measured, status }
    }

    /// Along a grid axis the bounding box, as in the paper; at an angle the stretches along and
    /// across the pull of the affine map that fits the shape best.
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

/// The deformation gradient F of the affine map that fits `x` best, by least squares.
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

/// Follows the equilibrium from load to load.
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

/// Bisects the expected strain at which stability is lost, between a stable and an unstable one.
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

/// The equilibrium at the load of strain `to`: from that at `from`, else from the even stretch that it
/// should be (a curve whose slope jumps leads Newton's method astray).
fn reach(pull: &Pull, start: &[DVec2], from: f64, to: f64) -> Option<Vec<DVec2>> {
    follow(pull, start, from, to, 0).or_else(|| newton(pull, &pull.even(to), to))
}

/// The equilibrium at the load of strain `to`, from that at `from`; smaller steps where Newton's
/// method does not get there in one. `None` if it never does.
fn follow(pull: &Pull, start: &[DVec2], from: f64, to: f64, depth: u32) -> Option<Vec<DVec2>> {
    const DEEPEST: u32 = 5;
    newton(pull, start, to).or_else(|| {
        (depth < DEEPEST).then_some(())?;
        let middle = 0.5 * (from + to);
        let shape = follow(pull, start, from, middle, depth + 1)?;
        follow(pull, &shape, middle, to, depth + 1)
    })
}

/// Newton's method on springs + loads = 0, with the true Hessian and a line search on the residual
/// (not on the energy: an unstable equilibrium is to be found as well, and then told as such).
fn newton(pull: &Pull, start: &[DVec2], strain: f64) -> Option<Vec<DVec2>> {
    const ITERATIONS: u32 = 40;
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
    for _ in 0..ITERATIONS {
        let greatest = residual.iter().map(|r| r.length()).fold(0.0, f64::max);
        if greatest <= EQUILIBRIUM_TOLERANCE * greatest_load {
            return (!sample.is_outside_domain(&x)).then_some(x);
        }
        let step = held(sample, &x).solve(residual.iter().flat_map(DVec2::to_array).collect())?;
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

/// The Hessian with the rigid motions, which no load resists at rest, held by weak springs. (The
/// loads have no component along them, so this slows Newton's method a little but moves nothing.)
fn held(sample: &Sample, x: &[DVec2]) -> Matrix {
    let mut matrix = sample.hessian(x);
    let [along, up, turn] = rigid_modes(x);
    let stiffness = sample.edge_stiffness();
    for (mode, share) in [(along, 1.0), (up, 1.0), (turn, 1e-6)] {
        matrix.add_outer(share * stiffness, &mode);
    }
    matrix
}

// --- Protocol `paper` ---------------------------------------------------------------------------

/// Relaxes the sample under one load after the other.
fn relax_all(pull: &Pull) -> Report {
    let mut rows: Vec<Row> = Vec::new();
    let mut shape = nudged(pull.sample.rest());
    let (mut stability_lost_at, mut lost) = (None, false);
    for strain in expected_strains() {
        let status = if lost { Status::Unstable } else { relax(pull, &mut shape, strain) };
        if status == Status::Unstable {
            stability_lost_at.get_or_insert(strain);
            // A sample that ran away does not come back under a greater load.
            lost = lost || pull.sample.is_outside_domain(&shape) || ran_away(pull.sample, &shape);
        }
        rows.push(pull.row(strain, Some(&shape), status));
    }
    Report { rows, stability_lost_at }
}

/// The rest shape with every node moved by about 1e-7 of a cell, the rounding error of the single
/// precision that such programs computed in: an unstable shape must not live by symmetry alone.
fn nudged(rest: &[DVec2]) -> Vec<DVec2> {
    const NUDGE_MM: f64 = 1e-7;
    let mut state = 1_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        2.0 * f64::from(state) / f64::from(u32::MAX) - 1.0
    };
    rest.iter().map(|x| *x + NUDGE_MM * DVec2::new(random(), random())).collect()
}

/// Has the sample grown to more than four times its size?
fn ran_away(sample: &Sample, x: &[DVec2]) -> bool {
    let size = sample.rest()[sample.rest().len() - 1].length();
    x.iter().any(|p| p.distance(x[0]).is_nan() || p.distance(x[0]) > 4.0 * size)
}

/// 15 000 damped explicit iterations under one load.
///
/// All nodes have mass 1. The time step obeys Δt²·λ = 1/2 with λ Gershgorin's bound on the greatest
/// eigenvalue of the true Hessian, renewed every 100 iterations (explicit steps are stable up to 4);
/// every iteration keeps 95 % of the velocity, which damps the softest mode of the 4 × 4 sample near
/// critically. Iterations that would change nothing any more are left out.
fn relax(pull: &Pull, x: &mut [DVec2], strain: f64) -> Status {
    const KEPT_VELOCITY: f64 = 0.95;
    const AT_REST: f64 = 1e-13;
    const RENEWED_EVERY: u32 = 100;
    let sample = pull.sample;
    let loads = pull.loads(strain);
    let greatest_load = loads.iter().map(|load| load.length()).fold(0.0, f64::max);
    let mut velocity = vec![DVec2::ZERO; x.len()];
    let mut force = loads.clone();
    let mut time_step = 0.0;
    let mut residual = f64::INFINITY;
    for iteration in 0..PAPER_ITERATIONS {
        if iteration % RENEWED_EVERY == 0 {
            if sample.is_outside_domain(x) || ran_away(sample, x) {
                return Status::Unstable;
            }
            time_step = (0.5 / sample.hessian(x).greatest_row_sum()).sqrt();
        }
        force.copy_from_slice(&loads);
        sample.add_forces(x, &mut force);
        residual = force.iter().map(|f| f.length()).fold(0.0, f64::max) / greatest_load;
        if residual < AT_REST {
            break;
        }
        for ((x, v), f) in x.iter_mut().zip(&mut velocity).zip(&force) {
            *v = KEPT_VELOCITY * *v + time_step * *f;
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

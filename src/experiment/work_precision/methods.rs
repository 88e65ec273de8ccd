//! Measurement of one method on one grid.

use super::explicit::{Damping, Explicit};
use super::gauss_seidel::GaussSeidel;
use super::law::Law;
use super::watch::{End, Errors, Sample, Schedule, Watch};
use super::{Case, GOAL, Method, PAPER_STEPS, Plan, Profile, Reference, Row, Status};
use crate::mesh::{NodeKind, Sheet};
use crate::model::membrane::law::coupled_law;
use crate::scene::SceneError;
use crate::solve::{self, Options, Problem, Progress, Solver, Verdict};
use glam::{DVec2, DVec3};

/// Tolerance of the grid's own equilibrium \[fraction of the base radius\].
const OWN_TOLERANCE: f64 = 1e-9;
/// Tolerances of the rows of Newton's method \[fraction of the base radius\].
const NEWTON_TOLERANCES: [f64; 3] = [1e-3, 1e-5, 1e-7];
/// Greatest time of a run that is repeated \[ms\].
const SHORT_MS: f64 = 50.0;

/// Data common to all methods of one scene and grid.
pub(super) struct Ground {
    case: Case,
    nodes_per_side: usize,
    problem: Problem,
    law: Law,
    /// Positions of the grid's own equilibrium \[mm\], shape (nodes_per_side², ).
    own: Vec<DVec3>,
    /// Nodes at the contact edge and the gauge of the dome at their contact offsets (see
    /// [`Solver::offset_nodes`]). The baselines do not compute contact offsets and use these.
    touch: Vec<(usize, f64)>,
    /// Nodes of `touch` with positions on the dome.
    lowered: Vec<usize>,
    /// The axisymmetric solution at every node \[mm\], shape (nodes_per_side², ).
    reference: Option<Vec<DVec3>>,
    /// Indices of the free nodes.
    free: Vec<usize>,
}

impl Ground {
    pub(super) fn new(
        case: Case,
        nodes_per_side: usize,
        reference: Option<Reference>,
    ) -> Result<Self, SceneError> {
        let scene = case.scene(nodes_per_side, 1e-7);
        let problem = scene.problem()?;
        let mut solver = newton(&problem, OWN_TOLERANCE);
        while solver.advance(&mut || false) == Progress::Working {}
        let dome = &problem.obstacle.dome;
        let touch =
            solver.offset_nodes().iter().map(|&(k, offset)| (k, dome.gauge(offset))).collect();
        let shown = solver.positions();
        let is_lowered = |&(k, offset): &(usize, DVec3)| (shown[k] != offset).then_some(k);
        let lowered = solver.offset_nodes().iter().filter_map(is_lowered).collect();
        let own = shown.to_vec();
        let kinds = problem.sheet.kinds();
        let free = (0..problem.sheet.len()).filter(|k| kinds[*k] == NodeKind::Free).collect();
        Ok(Self {
            case,
            nodes_per_side,
            own,
            touch,
            lowered,
            reference: reference
                .and_then(|reference| reference(&scene))
                .map(|profile| revolved(&profile, &problem.sheet)),
            free,
            law: Law::new(&coupled_law(&problem.materials)),
            problem,
        })
    }

    pub(super) fn is_for(&self, case: Case, nodes_per_side: usize) -> bool {
        self.case == case && self.nodes_per_side == nodes_per_side
    }

    /// Greatest distances of the nodes from the grid's own equilibrium and from the reference
    /// \[fraction of the base radius\]; NaN if a position is not a number.
    fn errors(&self, x: &[DVec3]) -> (f64, Option<f64>) {
        let greatest = |solution: &[DVec3]| {
            let greater = |a: f64, b: f64| if b > a || b.is_nan() { b } else { a };
            let squares = self.free.iter().map(|&k| x[k].distance_squared(solution[k]));
            squares.fold(0.0, greater).sqrt() / self.problem.obstacle.dome.base_radius
        };
        (greatest(&self.own), self.reference.as_deref().map(greatest))
    }

    /// Projects the nodes of `lowered` from their contact offsets onto the dome.
    fn lower(&self, x: &mut [DVec3]) {
        for &k in &self.lowered {
            x[k] = self.problem.obstacle.dome.onto_surface(x[k]);
        }
    }

    fn row(&self, method: Method, sample: Sample, status: Status) -> Row {
        Row {
            method,
            springs: self.problem.springs,
            scene: self.case,
            nodes_per_side: self.problem.sheet.nodes_per_side(),
            work_units: sample.work_units,
            time_ms: sample.time_ms,
            error_vs_own_grid: sample.own_error,
            error_vs_reference: sample.reference_error,
            status,
        }
    }
}

/// Positions of a profile at every node \[mm\], shape (nodes_per_side², ).
fn revolved(profile: &Profile, sheet: &Sheet) -> Vec<DVec3> {
    let position = |(rest, kind): (&DVec2, &NodeKind)| {
        if *kind != NodeKind::Free {
            return rest.extend(0.0);
        }
        let (r, z) = profile(rest.length());
        (rest.normalize_or_zero() * r).extend(z)
    };
    sheet.rest().iter().zip(sheet.kinds()).map(position).collect()
}

/// Measures the rows of one method.
pub(super) fn measure(
    method: Method,
    ground: &Ground,
    plan: &Plan,
    clock: &mut dyn FnMut() -> f64,
) -> Vec<Row> {
    match method {
        Method::ExplicitPaper | Method::ExplicitCritical | Method::GaussSeidel => {
            baseline(method, ground, plan, clock)
        }
        Method::Multigrid1 => multigrid(method, 1, ground, plan, clock),
        Method::Multigrid2 => multigrid(method, 2, ground, plan, clock),
        Method::Multigrid4 => multigrid(method, 4, ground, plan, clock),
        Method::Multigrid8 => multigrid(method, 8, ground, plan, clock),
        Method::Newton => NEWTON_TOLERANCES
            .into_iter()
            .map(|tolerance| {
                solved(method, ground, plan, clock, &|_| newton(&ground.problem, tolerance))
            })
            .collect(),
    }
}

fn baseline(
    method: Method,
    ground: &Ground,
    plan: &Plan,
    clock: &mut dyn FnMut() -> f64,
) -> Vec<Row> {
    let is_paper = method == Method::ExplicitPaper;
    let schedule = Schedule {
        budget_ms: plan.budget_ms,
        first: if method == Method::GaussSeidel { 1 } else { 8 },
        growth: 1.3,
        // The paper's method has a number of steps, not a tolerance.
        goal: if is_paper { 0.0 } else { GOAL },
    };
    let problem = &ground.problem;
    let errors: Errors = &|x| {
        let mut shown = x.to_vec();
        ground.lower(&mut shown);
        ground.errors(&shown)
    };
    let rest = problem.sheet.rest_positions();
    let once = |clock: &mut dyn FnMut() -> f64| {
        let watched = |run: &mut dyn FnMut(&mut Watch) -> End, clock: &mut dyn FnMut() -> f64| {
            let mut watch = Watch::start(clock, errors, schedule, rest.clone());
            let end = run(&mut watch);
            (watch.samples, end)
        };
        if method == Method::GaussSeidel {
            let mut sweeps = GaussSeidel::new(problem, &ground.law, &ground.touch);
            return watched(&mut |watch| sweeps.run(watch), clock);
        }
        let (damping, most) =
            if is_paper { (Damping::Paper, PAPER_STEPS) } else { (Damping::Critical, u32::MAX) };
        let mut steps = Explicit::new(problem, &ground.law, &ground.touch, damping);
        watched(&mut |watch| steps.run(most, watch), clock)
    };
    let (mut samples, end) = once(clock);
    if samples.last().is_some_and(|last| last.time_ms < SHORT_MS) {
        let others: Vec<Vec<Sample>> = (1..plan.repeats).map(|_| once(clock).0).collect();
        for (k, sample) in samples.iter_mut().enumerate() {
            let times = others.iter().filter_map(|run| run.get(k)).map(|other| other.time_ms);
            sample.time_ms = median(times.chain([sample.time_ms]).collect());
        }
    }
    let count = samples.len();
    let status = |k: usize| match end {
        _ if k + 1 < count => Status::Running,
        End::Finished => Status::Finished,
        End::Budget => Status::Budget,
        End::Failed => Status::Failed,
    };
    samples.into_iter().enumerate().map(|(k, s)| ground.row(method, s, status(k))).collect()
}

/// Measures full multigrid with memory and tables of a previous run.
fn multigrid(
    method: Method,
    cycles: u32,
    ground: &Ground,
    plan: &Plan,
    clock: &mut dyn FnMut() -> f64,
) -> Vec<Row> {
    let options = Options {
        method: solve::Method::Multigrid { cycles },
        use_symmetry: false,
        ..Options::default()
    };
    let prepare = |used: Option<Solver>| {
        let mut solver = used.unwrap_or_else(|| {
            let mut solver = Solver::with_options(ground.problem.clone(), options);
            while solver.advance(&mut || false) == Progress::Working {}
            solver
        });
        // Full multigrid is a cold start: it begins on the coarsest grid.
        solver.restart(ground.problem.clone());
        solver
    };
    vec![solved(method, ground, plan, clock, &prepare)]
}

fn newton(problem: &Problem, tolerance: f64) -> Solver {
    let options =
        Options { method: solve::Method::Newton, use_symmetry: false, ..Options::default() };
    Solver::with_options(Problem { tolerance, ..problem.clone() }, options)
}

/// Measures the row of a solver; short runs are repeated. `prepare` returns a solver at the start, if
/// possible from the previous solver.
fn solved(
    method: Method,
    ground: &Ground,
    plan: &Plan,
    clock: &mut dyn FnMut() -> f64,
    prepare: &dyn Fn(Option<Solver>) -> Solver,
) -> Row {
    let mut solver = prepare(None);
    let mut times = vec![finish(&mut solver, plan.budget_ms, clock)];
    if times[0] < SHORT_MS {
        for _ in 1..plan.repeats {
            solver = prepare(Some(solver));
            times.push(finish(&mut solver, plan.budget_ms, clock));
        }
    }
    let time_ms = median(times);
    let (own_error, reference_error) = ground.errors(solver.positions());
    let status = match solver.verdict() {
        Verdict::Converged => Status::Finished,
        Verdict::NotConverged if time_ms >= plan.budget_ms => Status::Budget,
        _ => Status::Failed,
    };
    let work_units = solver.work_units();
    ground.row(method, Sample { work_units, time_ms, own_error, reference_error }, status)
}

/// Solves to the end or up to the budget; returns the time \[ms\].
fn finish(solver: &mut Solver, budget_ms: f64, clock: &mut dyn FnMut() -> f64) -> f64 {
    let start = clock();
    let mut time_ms = 0.0;
    while time_ms < budget_ms {
        let progress = solver.advance(&mut || clock() - start >= budget_ms);
        time_ms = clock() - start;
        if progress == Progress::Done {
            break;
        }
    }
    time_ms
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}

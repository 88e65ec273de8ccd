//! Measurement of one method on one grid.

use super::explicit::{Damping, Explicit};
use super::gauss_seidel::GaussSeidel;
use super::law::Law;
use super::layered::{Relaxation, Scheme};
use super::watch::{Deviation, End, Errors, Sample, Schedule, Watch};
use super::{
    Case, Face, GOAL, LAYERED_GOAL, Method, PAPER_STEPS, Plan, Profile, Reference, Row, Status,
};
use crate::mesh::{NodeKind, Sheet};
use crate::model::membrane::law::coupled_law;
use crate::scene::SceneError;
use crate::solve::{self, Options, Problem, Progress, Solver, Verdict};
use glam::{DVec2, DVec3};

/// Tolerance of the grid's own equilibrium \[fraction of the base radius\].
const OWN_TOLERANCE: f64 = 1e-9;
/// Tolerances of the rows of Newton's method \[fraction of the base radius\].
const NEWTON_TOLERANCES: [f64; 3] = [1e-3, 1e-5, 1e-7];
/// Tolerances of the rows of [`Method::Automatic`] \[fraction of the base radius\].
const AUTOMATIC_TOLERANCES: [f64; 3] = [1e-2, 1e-3, 1e-4];
/// Greatest time of a run that is repeated \[ms\].
const SHORT_MS: f64 = 50.0;

/// Data common to all methods of one scene and grid.
pub(super) struct Ground {
    case: Case,
    nodes_per_side: usize,
    problem: Problem,
    /// Positions at rest of all nodes, layer by layer \[mm\], shape (layers, nodes_per_side²); a sheet has one layer.
    rest: Vec<DVec3>,
    /// Positions of the grid's own equilibrium \[mm\], as `rest`.
    own: Vec<DVec3>,
    /// `None` for layered tissue.
    sheet: Option<SheetGround>,
    /// The axisymmetric solution of the sheet or the skin at every node \[mm\], shape (nodes_per_side², ).
    reference: Option<Vec<DVec3>>,
    /// The same of the inner face of layered tissue.
    inner_reference: Option<Vec<DVec3>>,
    /// Indices of the free nodes of a layer.
    free: Vec<usize>,
}

/// What the baselines of a sheet need.
struct SheetGround {
    law: Law,
    /// Nodes at the contact edge and the gauge of the dome at their contact offsets (see
    /// [`Solver::offset_nodes`]). The baselines do not compute contact offsets and use these.
    touch: Vec<(usize, f64)>,
    /// Nodes of `touch` with positions on the dome.
    lowered: Vec<usize>,
}

impl SheetGround {
    fn new(problem: &Problem, own: &Solver) -> Self {
        let dome = &problem.obstacle.dome;
        let touch = own.offset_nodes().iter().map(|&(k, offset)| (k, dome.gauge(offset))).collect();
        let shown = own.positions();
        let is_lowered = |&(k, offset): &(usize, DVec3)| (shown[k] != offset).then_some(k);
        let lowered = own.offset_nodes().iter().filter_map(is_lowered).collect();
        Self { law: Law::new(&coupled_law(&problem.materials)), touch, lowered }
    }
}

/// Positions of all nodes, layer by layer \[mm\].
fn nodes(solver: &Solver) -> Vec<DVec3> {
    let outer = solver.outer().iter().flatten();
    solver.positions().iter().chain(outer).copied().collect()
}

impl Ground {
    pub(super) fn new(
        case: Case,
        nodes_per_side: usize,
        reference: Option<Reference>,
    ) -> Result<Self, SceneError> {
        let scene = case.scene(nodes_per_side, 1e-7);
        let problem = scene.problem()?;
        // A solver at its start contains the positions at rest.
        let rest = nodes(&automatic(&problem, 1e-3));
        let mut solver = newton(&problem, OWN_TOLERANCE);
        while solver.advance(&mut || false) == Progress::Working {}
        let kinds = problem.sheet.kinds();
        let free = (0..problem.sheet.len()).filter(|k| kinds[*k] == NodeKind::Free).collect();
        let profile = reference.and_then(|reference| reference(&scene));
        let of_face = |face: Face, rest: &[DVec3]| {
            profile.as_ref().map(|profile| revolved(profile, face, rest, &problem.sheet))
        };
        let length = problem.sheet.len();
        let skin = &rest[rest.len() - length..];
        Ok(Self {
            case,
            nodes_per_side,
            own: nodes(&solver),
            sheet: (!case.is_layered()).then(|| SheetGround::new(&problem, &solver)),
            reference: of_face(Face::Skin, skin),
            inner_reference: of_face(Face::Inner, &rest[..length]).filter(|_| case.is_layered()),
            free,
            rest,
            problem,
        })
    }

    pub(super) fn is_for(&self, case: Case, nodes_per_side: usize) -> bool {
        self.case == case && self.nodes_per_side == nodes_per_side
    }

    /// Greatest distances of the nodes from the grid's own equilibrium and from the reference; NaN if a position is not
    /// a number.
    fn errors(&self, x: &[DVec3]) -> Deviation {
        let radius = self.problem.obstacle.dome.base_radius;
        let length = self.problem.sheet.len();
        let greater = |a: f64, b: f64| if b > a || b.is_nan() { b } else { a };
        let greatest = |x: &[DVec3], solution: &[DVec3]| {
            let squares = self.free.iter().map(|&k| x[k].distance_squared(solution[k]));
            squares.fold(0.0, greater).sqrt() / radius
        };
        let layers = x.chunks(length).zip(self.own.chunks(length));
        let skin = &x[x.len() - length..];
        Deviation {
            own: layers.map(|(x, own)| greatest(x, own)).fold(0.0, greater),
            reference: self.reference.as_deref().map(|reference| greatest(skin, reference)),
            inner_reference: self
                .inner_reference
                .as_deref()
                .map(|reference| greatest(&x[..length], reference)),
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
            inner_error_vs_reference: sample.inner_reference_error,
            status,
        }
    }
}

/// Positions of a face of a profile at every node \[mm\], shape (nodes_per_side², ).
fn revolved(profile: &Profile, face: Face, at_rest: &[DVec3], sheet: &Sheet) -> Vec<DVec3> {
    let position = |((rest, kind), at_rest): ((&DVec2, &NodeKind), &DVec3)| {
        if *kind != NodeKind::Free {
            return *at_rest;
        }
        let (r, z) = profile(face, rest.length());
        (rest.normalize_or_zero() * r).extend(z)
    };
    sheet.rest().iter().zip(sheet.kinds()).zip(at_rest).map(position).collect()
}

/// Measures the rows of one method.
pub(super) fn measure(
    method: Method,
    ground: &Ground,
    plan: &Plan,
    clock: &mut dyn FnMut() -> f64,
) -> Vec<Row> {
    match method {
        Method::ExplicitPaper
        | Method::ExplicitCritical
        | Method::GaussSeidel
        | Method::ColumnJacobi
        | Method::ExplicitMomentum => baseline(method, ground, plan, clock),
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
        Method::Automatic => AUTOMATIC_TOLERANCES
            .into_iter()
            .map(|tolerance| {
                let options = Options { use_symmetry: false, ..Options::default() };
                let problem = Problem { tolerance, ..ground.problem.clone() };
                solved(method, ground, plan, clock, &again(&problem, options))
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
        first: match method {
            Method::GaussSeidel | Method::ColumnJacobi => 1,
            _ => 8,
        },
        growth: 1.3,
        // The paper's method has a number of steps, not a tolerance.
        goal: match (is_paper, &ground.sheet) {
            (true, _) => 0.0,
            (false, Some(_)) => GOAL,
            (false, None) => LAYERED_GOAL,
        },
    };
    let problem = &ground.problem;
    let errors: Errors = &|x| {
        let Some(sheet) = &ground.sheet else { return ground.errors(x) };
        let mut shown = x.to_vec();
        // From their contact offsets onto the dome.
        for &k in &sheet.lowered {
            shown[k] = problem.obstacle.dome.onto_surface(shown[k]);
        }
        ground.errors(&shown)
    };
    let once = |clock: &mut dyn FnMut() -> f64| {
        let watched = |run: &mut dyn FnMut(&mut Watch) -> End, clock: &mut dyn FnMut() -> f64| {
            let mut watch = Watch::start(clock, errors, schedule, ground.rest.clone());
            let end = run(&mut watch);
            (watch.samples, end)
        };
        let Some(SheetGround { law, touch, .. }) = &ground.sheet else {
            let scheme = match method {
                Method::ColumnJacobi => Scheme::ColumnJacobi,
                Method::GaussSeidel => Scheme::GaussSeidel,
                _ => Scheme::Explicit,
            };
            let mut relaxation = Relaxation::new(problem, &ground.rest, scheme);
            return watched(&mut |watch| relaxation.run(watch), clock);
        };
        if method == Method::GaussSeidel {
            let mut sweeps = GaussSeidel::new(problem, law, touch);
            return watched(&mut |watch| sweeps.run(watch), clock);
        }
        let (damping, most) =
            if is_paper { (Damping::Paper, PAPER_STEPS) } else { (Damping::Critical, u32::MAX) };
        let mut steps = Explicit::new(problem, law, touch, damping);
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
    vec![solved(method, ground, plan, clock, &again(&ground.problem, options))]
}

/// A solver at the start of a problem, with memory and tables of a previous run.
fn again(problem: &Problem, options: Options) -> impl Fn(Option<Solver>) -> Solver {
    move |used| {
        let mut solver = used.unwrap_or_else(|| {
            let mut solver = Solver::with_options(problem.clone(), options);
            while solver.advance(&mut || false) == Progress::Working {}
            solver
        });
        // Full multigrid is a cold start: it begins on the coarsest grid.
        solver.restart(problem.clone());
        solver
    }
}

/// A solver of the whole grid with the method of a result.
fn automatic(problem: &Problem, tolerance: f64) -> Solver {
    let options = Options { use_symmetry: false, ..Options::default() };
    Solver::with_options(Problem { tolerance, ..problem.clone() }, options)
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
    let errors = ground.errors(&nodes(&solver));
    let status = match solver.verdict() {
        Verdict::Converged => Status::Finished,
        // A fixed number of cycles has no tolerance.
        Verdict::NotConverged if solver.invalid().is_none() && method.has_fixed_cycles() => {
            Status::Finished
        }
        Verdict::NotConverged if time_ms >= plan.budget_ms => Status::Budget,
        _ => Status::Failed,
    };
    let work_units = solver.work_units();
    ground.row(method, errors.sample(work_units, time_ms), status)
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

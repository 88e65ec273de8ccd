//! Measurement of one method on one grid.

use super::{Case, Face, Method, Plan, Profile, Reference, Row, Status};
use glam::{DVec2, DVec3};
use implant_preview_core::mesh::{NodeKind, Sheet};
use implant_preview_core::scene::SceneError;
use implant_preview_core::solve::{self, Options, Problem, Progress, Solver, Verdict};

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
    /// Positions of the grid's own equilibrium, layer by layer \[mm\], shape (layers, nodes_per_side²); a sheet has one layer.
    own: Vec<DVec3>,
    /// The axisymmetric solution of the sheet or the skin at every node \[mm\], shape (nodes_per_side², ).
    reference: Option<Vec<DVec3>>,
    /// The same of the inner face of layered tissue.
    inner_reference: Option<Vec<DVec3>>,
    /// Indices of the free nodes of a layer.
    free: Vec<usize>,
}

/// Greatest distances of the nodes \[fraction of the base radius\].
struct Errors {
    /// From the grid's own equilibrium.
    own: f64,
    /// From the axisymmetric reference: of the sheet, or the skin.
    reference: Option<f64>,
    /// From the axisymmetric reference: of the inner face of layered tissue.
    inner_reference: Option<f64>,
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
        let kinds = problem.sheet().kinds();
        let free = (0..problem.sheet().len()).filter(|k| kinds[*k] == NodeKind::Free).collect();
        let profile = reference.and_then(|reference| reference(&scene, case.mound()));
        let of_face = |face: Face, rest: &[DVec3]| {
            profile.as_ref().map(|profile| revolved(profile, face, rest, problem.sheet()))
        };
        let length = problem.sheet().len();
        let skin = &rest[rest.len() - length..];
        Ok(Self {
            case,
            nodes_per_side,
            own: nodes(&solver),
            reference: of_face(Face::Skin, skin),
            inner_reference: of_face(Face::Inner, &rest[..length]).filter(|_| case.is_layered()),
            free,
            problem,
        })
    }

    pub(super) fn is_for(&self, case: Case, nodes_per_side: usize) -> bool {
        self.case == case && self.nodes_per_side == nodes_per_side
    }

    /// Greatest distances of the nodes from the grid's own equilibrium and from the reference; NaN if a position is not
    /// a number.
    fn errors(&self, x: &[DVec3]) -> Errors {
        let radius = self.problem.obstacle.dome.reference_length();
        let length = self.problem.sheet().len();
        let greater = |a: f64, b: f64| if b > a || b.is_nan() { b } else { a };
        let greatest = |x: &[DVec3], solution: &[DVec3]| {
            let squares = self.free.iter().map(|&k| x[k].distance_squared(solution[k]));
            squares.fold(0.0, greater).sqrt() / radius
        };
        let layers = x.chunks(length).zip(self.own.chunks(length));
        let skin = &x[x.len() - length..];
        Errors {
            own: layers.map(|(x, own)| greatest(x, own)).fold(0.0, greater),
            reference: self.reference.as_deref().map(|reference| greatest(skin, reference)),
            inner_reference: self
                .inner_reference
                .as_deref()
                .map(|reference| greatest(&x[..length], reference)),
        }
    }

    fn row(&self, method: Method, solver: &Solver, time_ms: f64, status: Status) -> Row {
        let errors = self.errors(&nodes(solver));
        Row {
            method,
            springs: self.problem.springs,
            scene: self.case,
            nodes_per_side: self.problem.sheet().nodes_per_side(),
            work_units: solver.work_units(),
            time_ms,
            error_vs_own_grid: errors.own,
            error_vs_reference: errors.reference,
            inner_error_vs_reference: errors.inner_reference,
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
    let status = match solver.verdict() {
        Verdict::Converged => Status::Finished,
        // A fixed number of cycles has no tolerance.
        Verdict::NotConverged if solver.invalid().is_none() && method.has_fixed_cycles() => {
            Status::Finished
        }
        Verdict::NotConverged if time_ms >= plan.budget_ms => Status::Budget,
        _ => Status::Failed,
    };
    ground.row(method, &solver, time_ms, status)
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

//! The equilibrium: the minimum of the tissue's energy outside of the implant and above the wall.
//!
//! Full multigrid in f32 lanes (`fas`) solves a centred dome on one quarter of the patch, a dome moved along an axis
//! on half of the patch, for either tissue model (`multigrid`). Newton's method on nested grids in f64 is the fallback
//! and refines solutions below the resolution of f32 (`newton_method`; of layered tissue after further attempts of multigrid
//! with other constants). It also checks the stability of the paper's springs, whose energy has saddle points. A piece of work is a few passes over the grid, so that a page can respond between two pieces.
//!
//! Public interface: [`Problem`], [`Options`], [`Solver`] (state: `accessors`), [`Solution`]. `initial_guess` |
//! `fas` | `multigrid` | `newton` | `newton_method` | `linear` (systems of Newton's method) |
//! `validity` | `last_shape` (ends without convergence) | `discretisation` | `reactions` | `growth` (of the skin, by further solves) |
//! `continuation` (from the solution of another problem) | `yielding` (an implant that yields), `balance` (with a solution) |
//! `void` (what neither implant nor tissue fills), `seal` (the suction of a void that is limited, by further solves).
//!
//! Uses `springs`, `mesh`, `contact`, `model`. Used by `measure` and all to its right.

mod accessors;
mod balance;
mod continuation;
mod discretisation;
mod fas;
mod growth;
pub(crate) mod initial_guess;
mod last_shape;
pub(crate) mod linear;
mod multigrid;
mod newton;
mod newton_method;
mod problem;
pub(crate) mod reactions;
#[cfg(test)]
pub(crate) mod samples;
mod seal;
mod solution;
pub mod validity;
mod void;
mod yielding;

pub use problem::{Method, Options, Problem, Progress, Tissue, Void};
pub use reactions::Reactions;
use solution::Shape;
pub use solution::{Displayed, Record, Report, Solution, Verdict};
pub use validity::Invalid;

use crate::mesh::Rest;
use crate::mesh::lanes::Mirrored;
use crate::springs::{Material, Springs};
use fas::Stop;
use glam::DVec3;
use multigrid::{Attempt, Law, Multigrid};
use newton::Start;
use newton_method::NewtonMethod;
use std::sync::Arc;

/// Solver of one problem after the other, in slices of work.
pub struct Solver {
    problem: Arc<Problem>,
    options: Options,
    law: Law,
    /// Does the multigrid have another law than [`Self::law`]?
    is_multigrid_law_stale: bool,
    multigrid: Option<Multigrid>,
    newton: Option<NewtonMethod>,
    stage: Stage,
    /// Attempts of this solve: multigrid with one set of constants after the other, Newton's method as the fallback.
    attempts: u32,
    /// The present one of multigrid.
    attempt: Attempt,
    /// Solves in a row that continued from the one before.
    continued: u32,
    growths: growth::Growths,
    seal: seal::Seal,
    /// Work of Newton's method before the skin grew \[see [`Report::work_units`]\].
    newton_work_before_growth: f64,
    /// Steps of the numbers of an implant that yields, between solutions by Newton's method.
    balances: u32,
    /// The implant that yields, once Newton's method has had a solution.
    yielding: Option<yielding::Yielding>,
    /// Positions of the inner face \[mm\], shape (nodes_per_side², ).
    x: Vec<DVec3>,
    /// Positions of the layers of nodes above the inner face \[mm\], shape (layers, nodes_per_side²); none in a sheet.
    outer: Vec<Vec<DVec3>>,
    offset_nodes: Vec<(usize, DVec3)>,
    /// Is the shape mirrored along x, along y, to the last bit?
    mirrored: Mirrored,
    invalid: Option<Invalid>,
    displayed: Displayed,
    /// Position error of a solution by what growth of the skin and void are still to change \[base radius\].
    left: f64,
    /// The ending of the failed attempt of layered tissue whose shape is displayed.
    kept: Option<fas::Ending>,
    /// Number of changes of [`Self::x`].
    revision: u64,
    tables_built: u64,
    grids_built: u64,
    verdict: Verdict,
    progress: Progress,
}

/// The method at work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// None: the insertion is below the tolerance.
    Rest,
    Multigrid,
    Newton,
}

/// Height of the dome's apex up to which the sheet stays at rest \[tolerances\].
const REST_TOLERANCE: f64 = 0.5;

impl Solver {
    /// A solver at the start of a problem.
    #[must_use]
    pub fn new(problem: Problem) -> Self {
        Self::with_options(problem, Options::default())
    }

    /// A solver with options at the start of a problem.
    #[must_use]
    pub fn with_options(problem: Problem, options: Options) -> Self {
        let law = Law::new(&problem);
        let mut solver = Self {
            x: problem.rest.nodes(0).collect(),
            outer: above_at_rest(&problem.rest),
            offset_nodes: Vec::new(),
            mirrored: [false; 2],
            invalid: None,
            law,
            is_multigrid_law_stale: true,
            options,
            multigrid: None,
            newton: None,
            stage: Stage::Newton,
            attempts: 1,
            attempt: Attempt::FIRST,
            continued: 0,
            growths: growth::Growths::default(),
            seal: seal::Seal::default(),
            newton_work_before_growth: 0.0,
            balances: 0,
            yielding: None,
            displayed: Displayed::Previous,
            left: 0.0,
            kept: None,
            revision: 0,
            tables_built: 1,
            grids_built: 0,
            verdict: Verdict::NotConverged,
            progress: Progress::Working,
            problem: Arc::new(problem),
        };
        solver.start();
        solver
    }

    /// Starts another problem with the tables and grids that both problems share.
    pub fn restart(&mut self, problem: Problem) {
        let same_law = self.has_law_of(&problem);
        let same_rest = problem.rest == self.problem.rest && problem.tissue == self.problem.tissue;
        let same_patch = problem.patch == self.problem.patch;
        if !same_law {
            self.law = Law::new(&problem);
            self.tables_built += 1;
        }
        let is_layered = self.law.layered().is_some();
        if !same_rest || !same_law && is_layered {
            self.put_at_rest(&problem.rest);
            self.newton = None;
        }
        let before = std::mem::replace(&mut self.problem, Arc::new(problem));
        let is_warm = same_rest && self.verdict == Verdict::Converged;
        self.is_multigrid_law_stale |= !same_law || is_layered && !(same_patch && same_rest);
        self.start();
        // Newton's method of a sheet continues from the last solution, moved as the dome's geometry moved.
        if self.stage == Stage::Newton && is_warm && !is_layered && self.newton.is_some() {
            let Problem { rest, obstacle, .. } = &*self.problem;
            if *obstacle != before.obstacle {
                self.mirrored = [false; 2];
                let old = initial_guess::taut_profile(rest, &before.obstacle.dome);
                let new = initial_guess::taut_profile(rest, &obstacle.dome);
                for k in 0..self.x.len() {
                    self.x[k] += new[k] - old[k];
                }
            }
            self.start_newton(Start::FromSolution);
        }
    }

    /// Starts another problem as a new solver with these options does, with the tables and grids that both problems share.
    pub fn start_anew(&mut self, problem: Problem, options: Options) {
        if !self.has_law_of(&problem) {
            self.law = Law::new(&problem);
            self.tables_built += 1;
        }
        self.is_multigrid_law_stale = true;
        self.newton = None;
        self.options = options;
        self.put_at_rest(&problem.rest);
        self.problem = Arc::new(problem);
        self.start();
    }

    fn put_at_rest(&mut self, rest: &Rest) {
        self.x = rest.nodes(0).collect();
        self.outer = above_at_rest(rest);
        self.offset_nodes.clear();
        self.mirrored = [false; 2];
    }

    /// Is the law of the problem the present one? The thickness of solids is no part of the law.
    fn has_law_of(&self, problem: &Problem) -> bool {
        problem.springs == self.problem.springs
            && problem.tissue == self.problem.tissue
            && problem.membrane() == self.problem.membrane()
            && problem.solids().iter().map(Material::law).eq(self
                .problem
                .solids()
                .iter()
                .map(Material::law))
    }

    fn start(&mut self) {
        self.verdict = Verdict::NotConverged;
        self.progress = Progress::Working;
        (self.attempts, self.attempt, self.continued) = (1, Attempt::FIRST, 0);
        self.growths = growth::Growths::default();
        self.unseal();
        self.newton_work_before_growth = 0.0;
        self.balances = 0;
        self.yielding = None;
        self.invalid = None;
        self.displayed = Displayed::Previous;
        self.left = 0.0;
        self.kept = None;
        if let Some(newton) = &mut self.newton {
            newton.clear_work();
        }
        match self.options.method {
            Method::Automatic if self.may_rest() => {
                self.stage = Stage::Rest;
                let problem = Arc::clone(&self.problem);
                self.put_at_rest(&problem.rest);
                self.revision += 1;
                self.end(Verdict::Converged);
            }
            Method::Multigrid { cycles } => self.start_multigrid(Stop::Cycles(cycles)),
            Method::Newton => self.start_newton(Start::Cold),
            Method::Automatic => self.start_multigrid(Stop::Tolerance),
        }
    }

    fn start_multigrid(&mut self, stop: Stop) {
        self.stage = Stage::Multigrid;
        let mirrored = self.problem.mirrored().map(|holds| self.options.use_symmetry && holds);
        let multigrid = match self.multigrid.take() {
            Some(mut multigrid) if multigrid.fits(&self.problem, mirrored, &self.law) => {
                if self.is_multigrid_law_stale {
                    multigrid.set_model(&self.problem, &self.law);
                }
                multigrid
            }
            _ => {
                self.grids_built += 1;
                Multigrid::new(&self.problem, &self.law, mirrored)
            }
        };
        self.is_multigrid_law_stale = false;
        let multigrid = self.multigrid.insert(multigrid);
        multigrid.start(&self.problem, stop, self.options.draft_tolerance);
    }

    /// The stopping criterion of the options.
    fn stop(&self) -> Stop {
        match self.options.method {
            Method::Multigrid { cycles } => Stop::Cycles(cycles),
            Method::Automatic | Method::Newton => Stop::Tolerance,
        }
    }

    fn start_newton(&mut self, start: Start) {
        self.stage = Stage::Newton;
        let (problem, law) = (&*self.problem, &self.law);
        let factor = self.options.work_limit_factor;
        let newton = self.newton.get_or_insert_with(|| NewtonMethod::new(problem, law, factor));
        match start {
            Start::Cold => newton.start_cold(problem, law),
            Start::FromSolution | Start::Refining => {
                newton.start_from(start, (&self.x, &self.outer), problem, law);
            }
        }
    }

    /// Upper bound of the distance between the sheet at rest and the equilibrium \[base radius\]: no node of the
    /// equilibrium is above the dome's apex.
    fn error_at_rest(&self) -> f64 {
        let dome = &self.problem.obstacle.dome;
        dome.top().max(0.0) / dome.reference_length()
    }

    /// Is the sheet at rest a solution?
    fn may_rest(&self) -> bool {
        let Problem { rest, obstacle, tissue, tolerance, .. } = &*self.problem;
        let (sheet, n) = (rest.sheet(), rest.sheet().nodes_per_side());
        let at = |i: usize, j: usize| rest.node(0, j * n + i);
        rest.weight().is_none()
            && self.error_at_rest() <= REST_TOLERANCE * tolerance
            && validity::invalid((sheet, *tissue), &obstacle.dome, *tolerance, [0; 2], at).is_none()
    }

    /// Does pieces of work until `pause` returns true or the solve ends. A piece is a few passes over the grid (a few
    /// milliseconds at 129 nodes a side).
    pub fn advance(&mut self, pause: &mut dyn FnMut() -> bool) -> Progress {
        while self.progress == Progress::Working {
            match self.stage {
                Stage::Rest => {}
                Stage::Multigrid => {
                    if self.multigrid_piece() == fas::State::Draft {
                        break;
                    }
                }
                Stage::Newton => self.newton_piece(),
            }
            if pause() {
                self.display_coarse();
                break;
            }
        }
        self.progress
    }

    /// Displays the solution of a coarser grid unless a draft of this problem exists.
    fn display_coarse(&mut self) {
        let is_wanted = self.options.draft_tolerance.is_some()
            && self.stage == Stage::Multigrid
            && self.progress == Progress::Working
            && self.displayed != Displayed::Draft;
        if let (true, Some(multigrid)) = (is_wanted, &mut self.multigrid) {
            let nodes_per_side = multigrid.preview();
            self.display_multigrid(Displayed::Coarse { nodes_per_side });
        }
    }

    /// Displays the multigrid solution; false, and no change, if the solution is invalid.
    fn display_multigrid(&mut self, displayed: Displayed) -> bool {
        self.deform_as_multigrid();
        let Some(multigrid) = &self.multigrid else { return false };
        if multigrid.invalid(&self.problem).is_some() {
            return false;
        }
        let (x, offset_nodes, outer) = (&mut self.x, &mut self.offset_nodes, &mut self.outer);
        multigrid.write_positions(&self.problem, x, offset_nodes, outer);
        self.mirrored = multigrid.mirrored();
        self.displayed = displayed;
        self.revision += 1;
        true
    }

    fn multigrid_piece(&mut self) -> fas::State {
        let Some(multigrid) = &mut self.multigrid else {
            self.start_newton(Start::Cold);
            return fas::State::Failed;
        };
        let mut state = multigrid.step();
        if matches!(state, fas::State::Draft | fas::State::Converged)
            && !self.display_multigrid(Displayed::Draft)
        {
            state = match state {
                fas::State::Draft => fas::State::Working,
                _ if self.is_pierced() => {
                    self.invalid = Some(Invalid::Penetrated);
                    self.end(Verdict::Unstable);
                    return state;
                }
                _ => fas::State::Failed,
            };
        }
        match state {
            fas::State::Working | fas::State::Draft => {}
            fas::State::Converged => {
                let needs_newton = self.options.method == Method::Automatic && self.needs_newton();
                if needs_newton && self.is_in_reach_of_newton() {
                    self.complete_multigrid();
                } else if needs_newton {
                    self.end(Verdict::NotConverged);
                } else {
                    self.grow_or_end();
                }
            }
            fas::State::Failed
                if self.starts_from_nothing() || self.draws_less() || self.starts_grown() => {}
            fas::State::Failed => {
                self.attempts += 1;
                self.keep_shape();
                let stop = self.stop();
                if let Some(multigrid) = &mut self.multigrid
                    && multigrid.start_again(&self.problem, stop, &mut self.attempt)
                {
                    return state;
                }
                if self.is_in_reach_of_newton() {
                    let has_shape = self.kept.is_some();
                    self.start_newton(if has_shape { Start::FromSolution } else { Start::Cold });
                } else {
                    self.end_with_last_shape();
                }
            }
        }
        state
    }

    /// Does the dome protrude from the multigrid solution of a sheet, other than by rounding? Newton's method would find the same:
    /// the energy of coupled springs has no other minimum nearby.
    fn is_pierced(&self) -> bool {
        let is_coupled_sheet =
            self.law.layered().is_none() && self.problem.springs == Springs::Coupled;
        is_coupled_sheet
            && self.multigrid.as_ref().is_some_and(|multigrid| {
                !multigrid.ending().has_rounded_forces
                    && multigrid.invalid(&self.problem) == Some(Invalid::Penetrated)
            })
    }

    /// Does Newton's method continue from the multigrid solution? True below the resolution of f32, of positions or forces; with
    /// contact offsets far above the tolerance; for the paper's springs, whose stationary shape may be a saddle point.
    fn needs_newton(&self) -> bool {
        let is_left = self.multigrid.as_ref().is_some_and(|multigrid| {
            let ending = multigrid.ending();
            self.problem.tolerance < multigrid.least_tolerance()
                || ending.has_rounded_forces
                || self.law.layered().is_none() && ending.leaves_contact_offsets
        });
        is_left || self.problem.springs == Springs::Nikolaev
    }

    fn newton_piece(&mut self) {
        let Some(newton) = &mut self.newton else { return self.start_newton(Start::Cold) };
        let (problem, revision) = (&*self.problem, newton.revision());
        let state = newton.step(problem, &self.law);
        if newton.is_on_finest() && newton.revision() != revision {
            self.invalid = newton.invalid(problem);
            let is_better = self.kept.is_none_or(|kept| newton.error() <= kept.error);
            if self.invalid.is_none() && (is_better || state == newton::State::Converged) {
                let ending = fas::Ending::of(newton.error(), newton.relative_residual());
                let is_end = state == newton::State::Converged || self.law.layered().is_none();
                let offset_nodes = &mut self.offset_nodes;
                newton.write_positions(problem, &mut self.x, offset_nodes, &mut self.outer);
                self.mirrored = [false; 2];
                self.revision += 1;
                self.displayed = Displayed::Final;
                let is_kept = !is_end && self.is_approximation(ending.error);
                self.kept = is_kept.then_some(ending);
            }
        }
        match (state, self.invalid) {
            (newton::State::Working, _) => {}
            (newton::State::Stalled, _) if self.law.layered().is_some() => {
                self.end_with_last_shape();
            }
            (newton::State::Unstable, _) | (_, Some(Invalid::Penetrated)) => {
                if self.kept.is_some() {
                    self.end_with_last_shape();
                } else {
                    self.end(Verdict::Unstable);
                }
            }
            // A node that slides off the dome lets the dome protrude.
            (newton::State::Saddle, _) => {
                self.invalid = Some(Invalid::Penetrated);
                self.end(Verdict::Unstable);
            }
            (newton::State::Converged, None) if self.rebalance() => {}
            (newton::State::Converged, None) => self.grow_or_end(),
            (newton::State::Converged | newton::State::Stalled, _) => {
                self.end(Verdict::NotConverged);
            }
        }
    }

    /// Would Newton's method end within seconds?
    fn is_in_reach_of_newton(&self) -> bool {
        let cells = self.problem.rest.cells().len();
        cells * self.problem.sheet().free_nodes() <= self.options.max_newton_cells
    }

    fn end(&mut self, verdict: Verdict) {
        self.verdict = verdict;
        if self.law.layered().is_some() {
            self.admit_shape();
        }
        self.progress = Progress::Done;
        self.displayed = Displayed::Final;
    }
}

/// The layers of nodes above the inner face.
fn above_at_rest(rest: &Rest) -> Vec<Vec<DVec3>> {
    (1..rest.layers()).map(|layer| rest.nodes(layer).collect()).collect()
}

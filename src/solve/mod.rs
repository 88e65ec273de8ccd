//! The equilibrium: the minimum of the sheet's energy outside the dome and above the wall.
//!
//! Full multigrid in f32 lanes (`fas`) solves it, for a centred dome on one quarter of the sheet,
//! for one moved along an axis on half of it.
//! Where a cycle does not lead to the solution, Newton's method on nested grids in f64 takes over
//! (`newton`). It also refines a shape where f32 is not enough, follows a slack sheet to its fold, and sees
//! whether a shape of the paper's springs, whose energy has saddles, is stable. Work is cut into pieces of a few passes over the grid, so that a
//! page can answer between them.
//!
//! The seam: [`Solver`] is what others see of it, `answers` what it tells. `law` | `fas` (full multigrid) |
//! `stretch` (of one triangle) | `assemble` (energy, forces, Hessian) | `newton` (one grid, contact) | `multigrid` (its linear systems) | `transfer`
//! (grid to grid) | `soundness` (what may be shown).
//!
//! Uses `curve`, `springs`, `sheet`, `implant`. Used by `measure` and all to its right.

mod answers;
mod assemble;
mod blocks;
mod fas;
mod guess;
mod law;
mod lift;
mod multigrid;
mod newton;
mod soundness;
mod stretch;
mod transfer;

use crate::implant::Dome;
use crate::sheet::Sheet;
use crate::springs::{Material, Springs};
use fas::FullMultigrid;
pub use fas::kernels;
use glam::DVec3;
use law::SheetLaw;
pub(crate) use law::coupled_law;
use newton::{NestedNewton, State};
pub use soundness::Fault;

/// What is to be solved.
#[derive(Clone, Debug)]
pub struct Problem {
    /// The finest grid.
    pub sheet: Sheet,
    /// The obstacle.
    pub dome: Dome,
    /// Layers from the skin inwards.
    pub materials: Vec<Material>,
    /// The spring law.
    pub springs: Springs,
    /// Greatest node position error allowed \[share of the dome's base radius\].
    pub tolerance: f64,
}

/// Is there more to do?
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Progress {
    /// Call again.
    Working,
    /// The solve has ended; [`Solver::verdict`] tells how.
    Done,
}

/// How a solve stands or ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// Still working, or ended above the tolerance.
    NotConverged,
    /// The estimated position error is within the tolerance.
    Converged,
    /// The springs have no stable shape here.
    Unstable,
}

/// Which method is to find the equilibrium.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Full multigrid; Newton's method where that does not get there.
    #[default]
    Automatic,
    /// Full multigrid with this many V-cycles on the finest grid, whatever the tolerance: for
    /// studies of run time against error. The paper's springs are not asked whether they are stable.
    Multigrid {
        /// V-cycles on the finest grid.
        cycles: u32,
    },
    /// Newton's method on nested grids.
    Newton,
}

/// How a problem is to be solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The method.
    pub method: Method,
    /// Solve a centred dome on one quarter of the sheet, one moved along an axis on half of it; where that
    /// takes Newton's method, keep the shape its own mirror image.
    pub use_symmetry: bool,
    /// A position error \[share of the base radius\] at which [`Solver::advance`] returns once with a
    /// shape to show, if the tolerance is smaller. A pause before shows what a coarser grid has.
    pub draft_tolerance: Option<f64>,
    /// How many times as long as usual Newton's method may go on before it is given up \[-\].
    pub patience: f64,
}

impl Default for Options {
    fn default() -> Self {
        Self { method: Method::Automatic, use_symmetry: true, draft_tolerance: None, patience: 1.0 }
    }
}

/// What [`Solver::positions`] shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shown {
    /// The shape of the problem before, or the sheet at rest.
    Before,
    /// The shape that a coarser grid has so far.
    Coarse {
        /// Nodes a side of that grid.
        nodes_per_side: usize,
    },
    /// This problem's shape, with an estimated error below the draft tolerance.
    Draft,
    /// Newton's method at work, or the end of the solve.
    Latest,
}

/// Finds the equilibrium of one problem after the other, in slices.
pub struct Solver {
    problem: Problem,
    options: Options,
    law: SheetLaw,
    /// Are the law's tables other than those that the multigrid has read?
    is_law_new: bool,
    multigrid: Option<FullMultigrid>,
    newton: Option<NestedNewton>,
    stage: Stage,
    /// Did Newton's method take over because full multigrid did not get there?
    fell_back: bool,
    /// Node positions \[mm\] on the finest grid, shape (nodes_per_side², ).
    x: Vec<DVec3>,
    lifted: Vec<(usize, DVec3)>,
    fault: Option<Fault>,
    shown: Shown,
    moves: u64,
    tables_built: u64,
    grids_built: u64,
    verdict: Verdict,
    progress: Progress,
}

/// Which method is at work.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Nothing to do: the dome is not in.
    Rest,
    Multigrid,
    Newton,
}

/// A dome whose apex is no higher than this share of the tolerated error moves nothing that matters.
const REST_SHARE: f64 = 0.5;

impl Solver {
    /// A solver at rest, with everything to do.
    #[must_use]
    pub fn new(problem: Problem) -> Self {
        Self::with_options(problem, Options::default())
    }

    /// The same with a method of choice.
    #[must_use]
    pub fn with_options(problem: Problem, options: Options) -> Self {
        let law = SheetLaw::new(problem.springs, &problem.materials);
        let mut solver = Self {
            x: at_rest(&problem.sheet),
            lifted: Vec::new(),
            fault: None,
            law,
            is_law_new: true,
            options,
            multigrid: None,
            newton: None,
            stage: Stage::Newton,
            fell_back: false,
            shown: Shown::Before,
            moves: 0,
            tables_built: 1,
            grids_built: 0,
            verdict: Verdict::NotConverged,
            progress: Progress::Working,
            problem,
        };
        solver.start();
        solver
    }

    /// Takes up another problem; what it has in common with the last one is kept.
    pub fn restart(&mut self, problem: Problem) {
        let same_law =
            problem.springs == self.problem.springs && problem.materials == self.problem.materials;
        let same_grid = problem.sheet == self.problem.sheet;
        if !same_law {
            self.law = SheetLaw::new(problem.springs, &problem.materials);
            self.tables_built += 1;
        }
        if !same_grid {
            self.x = at_rest(&problem.sheet);
            self.lifted.clear();
            self.newton = None;
        }
        let before = std::mem::replace(&mut self.problem, problem);
        let is_warm = same_grid && self.verdict == Verdict::Converged;
        let dome = self.problem.dome;
        self.is_law_new |= !same_law;
        self.start();
        let is_symmetric = self.is_symmetric();
        // Newton's method goes on from the last shape, moved as the dome's geometry moved.
        if let (Stage::Newton, Some(newton), true) = (self.stage, &mut self.newton, is_warm) {
            if dome != before.dome {
                let old = guess::tight_string(&self.problem.sheet, &before.dome);
                let new = guess::tight_string(&self.problem.sheet, &dome);
                for k in 0..self.x.len() {
                    self.x[k] += new[k] - old[k];
                }
            }
            newton.start_from(&self.x, &dome, is_symmetric);
        }
    }

    fn start(&mut self) {
        self.verdict = Verdict::NotConverged;
        self.progress = Progress::Working;
        self.fell_back = false;
        self.fault = None;
        self.shown = Shown::Before;
        if let Some(newton) = &mut self.newton {
            newton.clear_work();
        }
        match self.options.method {
            Method::Automatic if self.may_rest() => {
                self.stage = Stage::Rest;
                self.x = at_rest(&self.problem.sheet);
                self.lifted.clear();
                self.moves += 1;
                self.end(Verdict::Converged);
            }
            Method::Automatic | Method::Multigrid { .. } => {
                self.stage = Stage::Multigrid;
                let n = self.problem.sheet.nodes_per_side();
                let dome = &self.problem.dome;
                let mirrored = dome.mirrored().map(|holds| self.options.use_symmetry && holds);
                let multigrid = match self.multigrid.take() {
                    Some(mut multigrid) if multigrid.fits(n, mirrored) => {
                        if self.is_law_new {
                            multigrid.set_law(&self.law);
                        }
                        multigrid
                    }
                    _ => {
                        let mut multigrid = FullMultigrid::new(n, mirrored);
                        self.grids_built += 1;
                        multigrid.set_law(&self.law);
                        multigrid
                    }
                };
                // A sheet at rest reads no law: the next one to be solved has to.
                self.is_law_new = false;
                let multigrid = self.multigrid.insert(multigrid);
                let cycles = match self.options.method {
                    Method::Multigrid { cycles } => Some(cycles),
                    _ => None,
                };
                multigrid.start(&self.problem, cycles, self.options.draft_tolerance);
            }
            Method::Newton => self.start_newton(false),
        }
    }

    /// How far the sheet at rest is from the grid's equilibrium at most, relative to the base radius \[-\]:
    /// no node comes to lie above the dome's apex.
    fn error_at_rest(&self) -> f64 {
        let dome = &self.problem.dome;
        dome.apex().z.max(0.0) / dome.base_radius
    }

    /// Is the sheet at rest near enough to the equilibrium, and does the dome not stick out of it?
    fn may_rest(&self) -> bool {
        let Problem { sheet, dome, tolerance, .. } = &self.problem;
        let (n, rest) = (sheet.nodes_per_side(), sheet.rest());
        let at = |i: usize, j: usize| rest[j * n + i].extend(0.0);
        self.error_at_rest() <= REST_SHARE * tolerance
            && soundness::fault(sheet, dome, *tolerance, [0; 2], at).is_none()
    }

    /// Does Newton's method keep a symmetric scene's shape symmetric? The paper's springs may settle in an
    /// uneven one.
    fn is_symmetric(&self) -> bool {
        self.options.use_symmetry && self.problem.springs == Springs::Coupled
    }

    /// Lets Newton's method begin, from the present shape if that `is_start`.
    fn start_newton(&mut self, is_start: bool) {
        self.stage = Stage::Newton;
        let (is_symmetric, patience) = (self.is_symmetric(), self.options.patience);
        let Problem { sheet, dome, .. } = &self.problem;
        let newton = self.newton.get_or_insert_with(|| NestedNewton::new(sheet, patience));
        if is_start {
            newton.start_from(&self.x, dome, is_symmetric);
        } else {
            newton.start_cold(dome, is_symmetric);
        }
    }

    /// Does pieces of work until `pause` says so or the solve ends. A piece is a few passes over the
    /// grid (a few milliseconds at 129 nodes a side).
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
                self.show_coarse();
                break;
            }
        }
        self.progress
    }

    /// Shows what a coarser grid has, where there is nothing better of this problem.
    fn show_coarse(&mut self) {
        let is_wanted = self.options.draft_tolerance.is_some()
            && self.stage == Stage::Multigrid
            && self.progress == Progress::Working
            && self.shown != Shown::Draft;
        if let (true, Some(multigrid)) = (is_wanted, &mut self.multigrid) {
            let nodes_per_side = multigrid.preview();
            self.take_multigrid(Shown::Coarse { nodes_per_side });
        }
    }

    /// Shows what full multigrid has if it is sound, and tells so; else leaves what is shown.
    fn take_multigrid(&mut self, shown: Shown) -> bool {
        let is_sound = self.multigrid.as_ref().is_some_and(|multigrid| {
            let is_sound = multigrid.fault(&self.problem).is_none();
            if is_sound {
                multigrid.write_positions(&self.problem, &mut self.x, &mut self.lifted);
            }
            is_sound
        });
        if is_sound {
            self.shown = shown;
            self.moves += 1;
        }
        is_sound
    }

    fn multigrid_piece(&mut self) -> fas::State {
        let Some(multigrid) = &mut self.multigrid else {
            self.start_newton(false);
            return fas::State::Failed;
        };
        let mut state = multigrid.step();
        let is_study = matches!(self.options.method, Method::Multigrid { .. });
        if matches!(state, fas::State::Draft | fas::State::Converged) {
            let is_sound = self.take_multigrid(Shown::Draft);
            state = match state {
                _ if is_sound => state,
                fas::State::Draft => fas::State::Working,
                _ => fas::State::Failed,
            };
        }
        match state {
            fas::State::Working | fas::State::Draft => {}
            fas::State::Converged => {
                if !is_study && self.needs_newton() {
                    self.start_newton(true);
                } else {
                    self.end(Verdict::Converged);
                }
            }
            fas::State::Failed => {
                self.fell_back = true;
                self.start_newton(false);
            }
        }
        state
    }

    /// Is Newton's method to go on from what full multigrid found: below what f32 resolves; where contact
    /// ends between nodes and the tolerance is far smaller than that; for a slack sheet, to see whether it
    /// only halts on its way to a fold; and for the paper's springs, whose energy has saddles, to see
    /// whether it is stable.
    fn needs_newton(&self) -> bool {
        let is_left = |multigrid: &FullMultigrid| multigrid.is_slack || multigrid.leaves_lifts;
        self.problem.tolerance < fas::LEAST_TOLERANCE
            || self.multigrid.as_ref().is_some_and(is_left)
            || self.problem.springs == Springs::Nikolaev
    }

    fn newton_piece(&mut self) {
        let Some(newton) = &mut self.newton else { return self.start_newton(false) };
        let moves = newton.finest().moves;
        let dome = &self.problem.dome;
        let tolerance = self.problem.tolerance * dome.base_radius;
        let state = newton.step(self.problem.springs, &self.law, dome, tolerance);
        if newton.is_on_finest() && newton.finest().moves != moves {
            self.fault = newton.finest().fault(dome, self.problem.tolerance);
            if self.fault.is_none() {
                newton.finest().write_positions(dome, &mut self.x, &mut self.lifted);
                self.moves += 1;
                self.shown = Shown::Latest;
            }
        }
        match (state, self.fault) {
            (State::Working, _) => {}
            (State::Unstable, _) | (_, Some(Fault::Pierced)) => self.end(Verdict::Unstable),
            // Once it has slid off, the dome sticks out.
            (State::Saddle, _) => {
                self.fault = Some(Fault::Pierced);
                self.end(Verdict::Unstable);
            }
            (State::Converged, None) => self.end(Verdict::Converged),
            (State::Converged | State::Stalled, _) => self.end(Verdict::NotConverged),
        }
    }

    fn end(&mut self, verdict: Verdict) {
        self.verdict = verdict;
        self.progress = Progress::Done;
        self.shown = Shown::Latest;
    }

    /// Ends the solve as if it had led to a faulty shape.
    #[cfg(test)]
    pub(crate) fn end_with(&mut self, fault: Fault) {
        self.fault = Some(fault);
        self.end(Verdict::NotConverged);
    }
}

/// The sheet flat on the wall.
fn at_rest(sheet: &Sheet) -> Vec<DVec3> {
    sheet.rest().iter().map(|p| p.extend(0.0)).collect()
}

//! The equilibrium: the minimum of the sheet's energy outside the dome and above the wall.
//!
//! Grids are nested: the coarsest starts from a shape made of geometry alone, every finer one from
//! the equilibrium of the grid before. On each grid Newton's method with contact runs until the
//! estimated position error is within the tolerance. Work is cut into pieces of a few passes over
//! the grid, so that a page can answer between them.
//!
//! The seam: [`Solver`] is what others see of it. `law` | `assemble` (energy, forces, Hessian) |
//! `newton` (one grid, contact) | `multigrid` (its linear systems) | `transfer` (grid to grid).
//!
//! Uses `curve`, `springs`, `sheet`, `implant`. Used by `measure` and all to its right.

mod assemble;
mod blocks;
mod guess;
mod law;
mod multigrid;
mod newton;
mod transfer;

use crate::curve::Curve;
use crate::implant::Dome;
use crate::sheet::Sheet;
use crate::springs::Springs;
use glam::DVec3;
use law::SheetLaw;
use newton::{Newton, State};

/// Coarse grids only have to be good starts \[share of the base radius\].
const COARSE_TOLERANCE: f64 = 1e-3;
/// Iterations after which a solve from the present shape is begun anew on the coarsest grid.
const WARM_ITERATIONS: u32 = 8;

/// One layer as the solver needs it.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Stress–strain curve.
    pub curve: Curve,
    /// Poisson ratio \[-\].
    pub poisson_ratio: f64,
    /// Thickness \[mm\].
    pub thickness_mm: f64,
}

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

/// How one triangle of a sheet is deformed.
#[derive(Clone, Copy, Debug)]
pub struct TriangleGradient {
    /// Rest area times the triangle's weight \[mm²\].
    pub rest_area: f64,
    /// Columns of the deformation gradient F, ∂x/∂X and ∂x/∂Y \[-\].
    pub columns: [DVec3; 2],
}

impl TriangleGradient {
    /// The gradient in a triangle of nodes under the positions `x` \[mm\] of all nodes.
    #[must_use]
    pub fn new(sheet: &Sheet, nodes: [usize; 3], weight: f64, x: &[DVec3]) -> Self {
        let rest = assemble::Rest::new(nodes.map(|k| sheet.rest()[k]), weight);
        let columns = assemble::Principal::columns(&rest, nodes.map(|k| x[k]));
        Self { rest_area: rest.area, columns }
    }
}

/// Finds the equilibrium of one problem after the other, in slices.
pub struct Solver {
    problem: Problem,
    law: SheetLaw,
    /// From the coarsest grid to the finest.
    levels: Vec<Newton>,
    current: usize,
    is_warm: bool,
    is_probed: bool,
    verdict: Verdict,
    progress: Progress,
}

impl Solver {
    /// A solver at its first guess.
    #[must_use]
    pub fn new(problem: Problem) -> Self {
        let mut sheets = vec![problem.sheet.clone()];
        while let Some(coarser) = sheets[sheets.len() - 1].coarser() {
            sheets.push(coarser);
        }
        let levels = sheets.into_iter().rev().map(Newton::new).collect();
        let law = SheetLaw::new(problem.springs, &problem.materials);
        let mut solver = Self {
            problem,
            law,
            levels,
            current: 0,
            is_warm: false,
            is_probed: false,
            verdict: Verdict::NotConverged,
            progress: Progress::Working,
        };
        solver.finest_mut().x = guess::tight_string(&solver.problem.sheet, &solver.problem.dome);
        solver.start_cold();
        solver
    }

    /// Takes up another problem. On an equal grid it goes on from the present shape, moved as the
    /// dome's geometry moved; on another one it starts anew.
    pub fn restart(&mut self, problem: Problem) {
        let same_grid = problem.sheet == self.problem.sheet;
        if !same_grid || self.verdict != Verdict::Converged {
            *self = Self::new(problem);
            return;
        }
        let law = SheetLaw::new(problem.springs, &problem.materials);
        if problem.dome != self.problem.dome {
            let before = guess::tight_string(&self.problem.sheet, &self.problem.dome);
            let after = guess::tight_string(&problem.sheet, &problem.dome);
            let x = &mut self.levels[self.current].x;
            for k in 0..x.len() {
                x[k] += after[k] - before[k];
            }
        }
        (self.problem, self.law) = (problem, law);
        self.verdict = Verdict::NotConverged;
        self.progress = Progress::Working;
        self.levels.iter_mut().for_each(|level| level.work_units = 0.0);
        self.is_warm = true;
        self.is_probed = false;
        self.current = self.levels.len() - 1;
        let dome = self.problem.dome;
        self.finest_mut().start(&dome);
    }

    fn start_cold(&mut self) {
        self.is_warm = false;
        self.is_probed = false;
        self.current = 0;
        let dome = self.problem.dome;
        let coarsest = &mut self.levels[0];
        coarsest.x = guess::tight_string(&coarsest.sheet, &dome);
        coarsest.start(&dome);
    }

    /// Does pieces of work until `pause` says so or the solve ends. A piece is a few passes over the
    /// grid (a few milliseconds at 129 nodes a side).
    pub fn advance(&mut self, pause: &mut dyn FnMut() -> bool) -> Progress {
        while self.progress == Progress::Working {
            self.piece();
            if pause() {
                break;
            }
        }
        self.progress
    }

    fn piece(&mut self) {
        let (dome, last) = (self.problem.dome, self.levels.len() - 1);
        let is_finest = self.current == last;
        let tolerance =
            dome.base_radius * if is_finest { self.problem.tolerance } else { COARSE_TOLERANCE };
        let level = &mut self.levels[self.current];
        let state = level.step(&self.law, &dome, tolerance);
        let is_slow = self.is_warm && level.iterations > WARM_ITERATIONS;
        match state {
            State::Working if is_slow => self.start_cold(),
            State::Working => {}
            State::Stalled | State::Unstable if self.is_warm => self.start_cold(),
            State::Unstable => self.end(Verdict::Unstable),
            State::Converged | State::Stalled if !is_finest => {
                let (coarser, finer) = self.levels.split_at_mut(self.current + 1);
                transfer::refine(&coarser[self.current], &mut finer[0]);
                finer[0].start(&dome);
                self.current += 1;
            }
            // The energy of the paper's springs has saddles: see whether this is one.
            State::Converged | State::Stalled
                if self.problem.springs == Springs::Nikolaev && !self.is_probed =>
            {
                self.is_probed = true;
                self.levels[last].begin_stability(state);
            }
            State::Stalled => self.end(Verdict::NotConverged),
            State::Converged => self.end(Verdict::Converged),
        }
    }

    fn end(&mut self, verdict: Verdict) {
        self.verdict = verdict;
        self.progress = Progress::Done;
        let (law, dome) = (&self.law, self.problem.dome);
        if let Some(finest) = self.levels.last_mut() {
            finest.finish(law, &dome);
        }
    }

    fn finest(&self) -> &Newton {
        &self.levels[self.levels.len() - 1]
    }

    fn finest_mut(&mut self) -> &mut Newton {
        let last = self.levels.len() - 1;
        &mut self.levels[last]
    }

    /// The problem being solved.
    #[must_use]
    pub fn problem(&self) -> &Problem {
        &self.problem
    }

    /// How the solve stands.
    #[must_use]
    pub fn verdict(&self) -> Verdict {
        self.verdict
    }

    /// Node positions \[mm\] on the finest grid, shape (nodes_per_side², ).
    #[must_use]
    pub fn positions(&self) -> &[DVec3] {
        &self.finest().x
    }

    /// Work of this solve, in units of one evaluation of all nodal forces on the finest grid.
    #[must_use]
    pub fn work_units(&self) -> f64 {
        let finest = self.finest().sheet.len() as f64;
        let scaled = |level: &Newton| level.work_units * level.sheet.len() as f64 / finest;
        self.levels.iter().map(scaled).sum()
    }

    /// Counts the changes of [`Self::positions`] since the grid was made.
    #[must_use]
    pub fn moves(&self) -> u64 {
        self.finest().moves
    }

    /// Spring forces on every node at the present shape \[kPa·mm²\], shape (nodes_per_side², ): what
    /// is not zero is taken by the dome, the wall or the border.
    #[must_use]
    pub fn forces(&self) -> Vec<DVec3> {
        let mut forces = vec![DVec3::ZERO; self.problem.sheet.len()];
        assemble::forces(&self.problem.sheet, &self.law, self.positions(), &mut forces);
        forces
    }

    /// Norm of the forces that no contact takes, relative to the forces they are the sum of \[-\].
    #[must_use]
    pub fn relative_residual(&self) -> f64 {
        self.finest().relative_residual
    }

    /// Estimated greatest node position error against this grid's own equilibrium, relative to the
    /// base radius \[-\]; infinite while there is no estimate.
    #[must_use]
    pub fn estimated_position_error(&self) -> f64 {
        self.finest().error / self.problem.dome.base_radius
    }

    /// The greatest error of the spring law's tables, relative to their peak stress \[-\].
    #[must_use]
    pub fn table_error(&self) -> f64 {
        self.law.table_error()
    }

    /// Newton iterations of each grid, the coarsest first.
    #[must_use]
    pub fn iterations(&self) -> Vec<u32> {
        self.levels.iter().map(|level| level.iterations).collect()
    }
}

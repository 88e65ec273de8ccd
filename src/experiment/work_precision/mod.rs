//! Run time against error: what it costs to come near to the equilibrium, method by method.
//!
//! For each scene and grid Newton's method at tolerance 1e-9 gives the grid's own equilibrium, and an
//! axisymmetric solution what every grid should come to. Each method is then run from a cold start and
//! its error measured: at the end, or, for the baselines, at many moments of their way. All methods
//! solve the whole sheet, symmetric or not, on one thread; tables, memory and what depends on the
//! grid alone are made before the clock starts, and it stands still while an error is measured.
//!
//! The baselines are what the same energy is commonly relaxed with: damped explicit steps with nodal
//! masses that suit the grid, in lanes of four f32 ([`Method::ExplicitPaper`],
//! [`Method::ExplicitCritical`]), and block Gauss–Seidel on nested grids in f64, which lanes do not
//! help ([`Method::GaussSeidel`]).
//!
//! Knows no clock and no files: the clock is handed in, so that a page can run the same study.
//!
//! Uses `sheet`, `implant`, `solve`, `springs`, `scene`. Used by the command line and the page.

mod cases;
mod choice;
mod explicit;
mod gauss_seidel;
mod guess;
mod lanes;
mod law;
mod methods;
mod table;
mod watch;

pub use cases::Case;
pub use table::{Row, Status, table, time_to};

use super::axisymmetric;
use crate::scene::{Scene, SceneError};
use crate::solve::Problem;
use crate::springs::Springs;
use methods::Ground;
use serde::{Deserialize, Serialize};

/// Explicit steps of the paper.
pub const PAPER_STEPS: u32 = 15_000;
/// An own error at which baselines end \[share of the base radius\]: their f32 shows below it.
pub const GOAL: f64 = 1e-5;

/// How the equilibrium is sought.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// 15 000 damped explicit steps that each keep 95 % of the last one, from the sheet lifted
    /// straight onto the dome.
    ExplicitPaper,
    /// Critically damped explicit steps, from a string pulled tight over the dome.
    ExplicitCritical,
    /// Nested nodal block Gauss–Seidel.
    GaussSeidel,
    /// Full multigrid with one V-cycle on the finest grid.
    #[serde(rename = "multigrid_1")]
    Multigrid1,
    /// The same with two.
    #[serde(rename = "multigrid_2")]
    Multigrid2,
    /// The same with four.
    #[serde(rename = "multigrid_4")]
    Multigrid4,
    /// The same with eight.
    #[serde(rename = "multigrid_8")]
    Multigrid8,
    /// Newton's method on nested grids, to tolerances from 1e-2 to 1e-7.
    Newton,
}

impl Method {
    /// All of them, slow ones first.
    pub const ALL: [Self; 8] = [
        Self::ExplicitPaper,
        Self::ExplicitCritical,
        Self::GaussSeidel,
        Self::Newton,
        Self::Multigrid1,
        Self::Multigrid2,
        Self::Multigrid4,
        Self::Multigrid8,
    ];

    /// Its name in the table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::ExplicitPaper => "explicit_paper",
            Self::ExplicitCritical => "explicit_critical",
            Self::GaussSeidel => "gauss_seidel",
            Self::Multigrid1 => "multigrid_1",
            Self::Multigrid2 => "multigrid_2",
            Self::Multigrid4 => "multigrid_4",
            Self::Multigrid8 => "multigrid_8",
            Self::Newton => "newton",
        }
    }
}

/// What is to be measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Scenes.
    pub cases: Vec<Case>,
    /// Nodes a side, rising; see [`crate::mesh::rounded_nodes_per_side`].
    pub nodes_per_side: Vec<usize>,
    /// Methods.
    pub methods: Vec<Method>,
    /// Time that one run may take \[ms\]. A method that needed more is left out on finer grids.
    pub budget_ms: f64,
    /// Runs whose median time is given where one takes less than 50 ms, ≥ 1.
    pub repeats: usize,
}

impl Plan {
    /// Everything: 17 to 513 nodes a side, all scenes, 10 s a run (some minutes in all).
    #[must_use]
    pub fn full() -> Self {
        Self {
            cases: Case::ALL.to_vec(),
            nodes_per_side: vec![17, 33, 65, 129, 257, 513],
            methods: Method::ALL.to_vec(),
            budget_ms: 10_000.0,
            repeats: 7,
        }
    }

    /// A look: the default scene on coarse grids, 2 s a run.
    #[must_use]
    pub fn quick() -> Self {
        Self {
            cases: vec![Case::Default],
            nodes_per_side: vec![17, 33, 65],
            budget_ms: 2_000.0,
            repeats: 3,
            ..Self::full()
        }
    }
}

/// Deformed (r, z) \[mm\] of the material radius s \[mm\].
pub type Profile = Box<dyn Fn(f64) -> (f64, f64)>;

/// Finds what every grid should come to, where it is known.
pub type Reference = fn(&Scene) -> Option<Profile>;

/// The reference of a centred dome under coupled springs; see [`super::axisymmetric`].
#[must_use]
pub fn axisymmetric(scene: &Scene) -> Option<Profile> {
    let Problem { patch, obstacle, materials, springs, .. } = scene.problem().ok()?;
    if springs != Springs::Coupled {
        return None;
    }
    let solution = axisymmetric::solve(&obstacle.dome, patch.pocket_radius_mm, &materials).ok()?;
    Some(Box::new(move |s_mm| {
        let point = solution.point(s_mm);
        (point.r_mm, point.z_mm)
    }))
}

/// A piece of a study: one method on one grid in one scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Piece {
    /// The scene.
    pub scene: Case,
    /// Nodes a side.
    pub nodes_per_side: usize,
    /// The method.
    pub method: Method,
}

impl Piece {
    /// Was a row measured in this piece?
    #[must_use]
    pub fn has(self, row: &Row) -> bool {
        self == Self { scene: row.scene, nodes_per_side: row.nodes_per_side, method: row.method }
    }
}

/// A study in pieces: one method on one grid in one scene after the other.
pub struct Study {
    plan: Plan,
    reference: Option<Reference>,
    /// Pieces begun so far.
    done: usize,
    /// What the methods of one scene and grid have in common.
    ground: Option<Ground>,
    /// Scenes and methods that ran out of time.
    exhausted: Vec<(Case, Method)>,
}

impl Study {
    /// A study with everything to do; without a reference, errors against it are left empty.
    #[must_use]
    pub fn new(plan: Plan, reference: Option<Reference>) -> Self {
        Self { plan, reference, done: 0, ground: None, exhausted: Vec::new() }
    }

    /// Pieces done, of how many.
    #[must_use]
    pub fn progress(&self) -> (usize, usize) {
        let plan = &self.plan;
        (self.done, plan.cases.len() * plan.nodes_per_side.len() * plan.methods.len())
    }

    /// The piece that comes next; `None` when all is done.
    #[must_use]
    pub fn next_piece(&self) -> Option<Piece> {
        let plan = &self.plan;
        let (methods, grids) = (plan.methods.len(), plan.nodes_per_side.len());
        let (done, all) = self.progress();
        (done < all).then(|| Piece {
            scene: plan.cases[done / (methods * grids)],
            nodes_per_side: plan.nodes_per_side[done / methods % grids],
            method: plan.methods[done % methods],
        })
    }

    /// Does the next piece and returns its rows; `None` when all is done. `clock` gives milliseconds
    /// since some moment.
    ///
    /// # Errors
    /// If the plan asks for a grid that scenes do not allow.
    pub fn advance(
        &mut self,
        clock: &mut dyn FnMut() -> f64,
    ) -> Result<Option<Vec<Row>>, SceneError> {
        let Some(piece) = self.next_piece() else {
            return Ok(None);
        };
        self.done += 1;
        let Piece { scene: case, nodes_per_side: nodes, method } = piece;
        if self.exhausted.contains(&(case, method)) {
            return Ok(Some(Vec::new()));
        }
        let ground = match self.ground.take() {
            Some(ground) if ground.is_for(case, nodes) => ground,
            _ => Ground::new(case, nodes, self.reference)?,
        };
        let ground = self.ground.insert(ground);
        let rows = methods::measure(method, ground, &self.plan, clock);
        if rows.last().is_some_and(|row| row.status == Status::Budget) {
            self.exhausted.push((case, method));
        }
        Ok(Some(rows))
    }
}

/// Does a whole study; see [`Study::advance`].
///
/// # Errors
/// If the plan asks for a grid that scenes do not allow.
pub fn run(
    plan: &Plan,
    reference: Option<Reference>,
    clock: &mut dyn FnMut() -> f64,
) -> Result<Vec<Row>, SceneError> {
    let mut study = Study::new(plan.clone(), reference);
    let mut rows = Vec::new();
    while let Some(more) = study.advance(clock)? {
        rows.extend(more);
    }
    Ok(rows)
}

//! Run time against error of the solution methods (work–precision study).
//!
//! Newton's method with tolerance 1e-9 computes the grid's own equilibrium of each scene and grid, and an
//! axisymmetric solution the limit of all grids. Each method runs from a cold start. The error is measured
//! at the end. All methods solve the whole sheet, symmetric or not, on one thread. The clock runs neither during the
//! set-up of tables and memory nor during the measurement of errors.
//!
//! `assets/bench` contains what explicit steps, block Gauss–Seidel and column Jacobi once needed, measured together with these
//! methods; `docs/performance.md` names machine and commit.
//!
//! The module uses no clock and no files: the clock is an argument, and the page runs the same study.
//!
//! Uses `sheet`, `implant`, `solve`, `springs`, `scene`. Used by the command line and the page.

mod cases;
mod choice;
mod limit;
mod methods;
mod table;

pub use cases::Case;
pub use limit::{Face, Profile, Reference, axisymmetric};
pub use table::{Row, Status, table, time_to};

use implant_preview_core::scene::SceneError;
use methods::Ground;
use serde::{Deserialize, Serialize};
use serde_json::json;

/// Solution method.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Method {
    /// Full multigrid with one V-cycle on the finest grid.
    #[serde(rename = "multigrid_1")]
    Multigrid1,
    /// Full multigrid with two V-cycles on the finest grid.
    #[serde(rename = "multigrid_2")]
    Multigrid2,
    /// Full multigrid with four V-cycles on the finest grid.
    #[serde(rename = "multigrid_4")]
    Multigrid4,
    /// Full multigrid with eight V-cycles on the finest grid.
    #[serde(rename = "multigrid_8")]
    Multigrid8,
    /// Newton's method on nested grids, to tolerances from 1e-2 to 1e-7.
    Newton,
    /// The method of a result, of layered tissue: full multigrid and its fallback, to tolerances from 1e-2 to 1e-4.
    Automatic,
}

impl Method {
    /// All methods for a sheet, slow methods first.
    pub const ALL: [Self; 5] =
        [Self::Newton, Self::Multigrid1, Self::Multigrid2, Self::Multigrid4, Self::Multigrid8];

    /// All methods for layered tissue, slow methods first.
    pub const LAYERED: [Self; 6] = [
        Self::Newton,
        Self::Automatic,
        Self::Multigrid1,
        Self::Multigrid2,
        Self::Multigrid4,
        Self::Multigrid8,
    ];

    /// Does the method solve the scene's tissue model?
    #[must_use]
    pub fn solves(self, case: Case) -> bool {
        if case.is_layered() { Self::LAYERED.contains(&self) } else { Self::ALL.contains(&self) }
    }

    /// Does the method end after a number of cycles, whatever the error?
    fn has_fixed_cycles(self) -> bool {
        matches!(self, Self::Multigrid1 | Self::Multigrid2 | Self::Multigrid4 | Self::Multigrid8)
    }

    /// Name of the method in the table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Multigrid1 => "multigrid_1",
            Self::Multigrid2 => "multigrid_2",
            Self::Multigrid4 => "multigrid_4",
            Self::Multigrid8 => "multigrid_8",
            Self::Newton => "newton",
            Self::Automatic => "automatic",
        }
    }
}

/// Plan of a study: scenes, grids and methods.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Scenes.
    pub cases: Vec<Case>,
    /// Nodes per side, rising; see [`implant_preview_core::mesh::rounded_nodes_per_side`].
    pub nodes_per_side: Vec<usize>,
    /// Methods.
    pub methods: Vec<Method>,
    /// Time budget of one run \[ms\]. A method that exceeds the budget is skipped on finer grids.
    pub budget_ms: f64,
    /// Number of runs for the median time of runs below 50 ms, ≥ 1.
    pub repeats: usize,
}

impl Plan {
    /// The full plan: 17 to 513 nodes per side, all scenes, 10 s per run (some minutes in total).
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

    /// The full plan for layered tissue: 33 to 129 nodes per side, all scenes of layered tissue, 10 s per run.
    #[must_use]
    pub fn layered() -> Self {
        Self {
            cases: Case::LAYERED.to_vec(),
            nodes_per_side: vec![33, 65, 129],
            methods: Method::LAYERED.to_vec(),
            ..Self::full()
        }
    }

    /// The quick plan for layered tissue: the default scene on 33 and 65 nodes per side, 2 s per run.
    #[must_use]
    pub fn layered_quick() -> Self {
        Self {
            cases: vec![Case::LayeredDefault],
            nodes_per_side: vec![33, 65],
            methods: Method::LAYERED.to_vec(),
            ..Self::quick()
        }
    }

    /// The quick plan: the default scene on coarse grids, 2 s per run.
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

/// A piece of a study: one method on one grid in one scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Piece {
    /// The scene.
    pub scene: Case,
    /// Nodes per side.
    pub nodes_per_side: usize,
    /// The method.
    pub method: Method,
}

impl Piece {
    /// Returns `true` if the row belongs to this piece.
    #[must_use]
    pub fn has(self, row: &Row) -> bool {
        self == Self { scene: row.scene, nodes_per_side: row.nodes_per_side, method: row.method }
    }
}

/// The time that a method needs to an error.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TimeTo {
    /// Scene, grid and method.
    #[serde(flatten)]
    pub piece: Piece,
    /// Time from a cold start after which the error stays within the bound \[ms\]; `None` if the method
    /// does not reach the bound.
    pub time_ms: Option<f64>,
}

/// A study of run time against error: the plan, the rows measured so far and the pieces left.
pub struct Study {
    plan: Plan,
    reference: Option<Reference>,
    /// Number of pieces begun.
    begun: usize,
    /// Pieces measured without an error, in order.
    done: Vec<Piece>,
    rows: Vec<Row>,
    /// Data common to the methods of one scene and grid.
    ground: Option<Ground>,
    /// Scenes and methods that exceeded their time budget.
    exhausted: Vec<(Case, Method)>,
}

impl Study {
    /// Creates a study without rows; without a reference, errors against the reference stay empty.
    #[must_use]
    pub fn new(plan: Plan, reference: Option<Reference>) -> Self {
        Self {
            plan,
            reference,
            begun: 0,
            done: Vec::new(),
            rows: Vec::new(),
            ground: None,
            exhausted: Vec::new(),
        }
    }

    /// Rows measured so far, in the order of the plan.
    #[must_use]
    pub fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// Rows measured so far as CSV; see [`table`].
    #[must_use]
    pub fn csv(&self) -> String {
        table(&self.rows)
    }

    /// Number of pieces begun and number of pieces of the plan.
    #[must_use]
    pub fn progress(&self) -> (usize, usize) {
        let plan = &self.plan;
        (self.begun, plan.cases.len() * plan.nodes_per_side.len() * plan.methods.len())
    }

    /// Progress and next piece as JSON text; `next` is null after the last piece:
    /// `{"done":0,"all":15,"next":{"scene":"default","nodes_per_side":17,"method":"newton"}}`.
    #[must_use]
    pub fn progress_json(&self) -> String {
        let (done, all) = self.progress();
        json!({ "done": done, "all": all, "next": self.next_piece() }).to_string()
    }

    /// The next piece; `None` after the last piece.
    #[must_use]
    pub fn next_piece(&self) -> Option<Piece> {
        let plan = &self.plan;
        let (methods, grids) = (plan.methods.len(), plan.nodes_per_side.len());
        let (begun, all) = self.progress();
        (begun < all).then(|| Piece {
            scene: plan.cases[begun / (methods * grids)],
            nodes_per_side: plan.nodes_per_side[begun / methods % grids],
            method: plan.methods[begun % methods],
        })
    }

    /// Measures the next piece; returns `false` if no piece is left. `clock` returns the time in
    /// milliseconds since an arbitrary moment.
    ///
    /// # Errors
    /// A scene does not allow a grid of the plan.
    pub fn advance(&mut self, clock: &mut dyn FnMut() -> f64) -> Result<bool, SceneError> {
        let Some(piece) = self.next_piece() else {
            return Ok(false);
        };
        self.begun += 1;
        let Piece { scene: case, nodes_per_side: nodes, method } = piece;
        if method.solves(case) && !self.exhausted.contains(&(case, method)) {
            let ground = match self.ground.take() {
                Some(ground) if ground.is_for(case, nodes) => ground,
                _ => Ground::new(case, nodes, self.reference)?,
            };
            let ground = self.ground.insert(ground);
            let rows = methods::measure(method, ground, &self.plan, clock);
            if rows.last().is_some_and(|row| row.status == Status::Budget) {
                self.exhausted.push((case, method));
            }
            self.rows.extend(rows);
        }
        self.done.push(piece);
        Ok(true)
    }

    /// The time of each measured piece to an error against the grid's own equilibrium \[fraction of the base
    /// radius\].
    #[must_use]
    pub fn times_to(&self, error: f64) -> Vec<TimeTo> {
        let time = |piece: &Piece| {
            let mut rows: Vec<Row> =
                self.rows.iter().filter(|row| piece.has(row)).copied().collect();
            // A run with a smaller tolerance may take less time.
            rows.sort_by(|a, b| a.time_ms.total_cmp(&b.time_ms));
            TimeTo { piece: *piece, time_ms: time_to(&rows, error) }
        };
        self.done.iter().map(time).collect()
    }

    /// [`Study::times_to`] as JSON text; `time_ms` is null for a method that does not reach the error:
    /// `[{"scene":"default","nodes_per_side":17,"method":"newton","time_ms":1.5}]`.
    #[must_use]
    pub fn times_json(&self, error: f64) -> String {
        json!(self.times_to(error)).to_string()
    }

    /// The scene with this name, or the first scene of the plan.
    ///
    /// # Errors
    /// One line with the allowed names if no scene has this name.
    pub fn case(&self, name: Option<&str>) -> Result<Case, SceneError> {
        let Some(name) = name else {
            return Ok(self.plan.cases.first().copied().unwrap_or(Case::Default));
        };
        Case::all().find(|case| case.name() == name).ok_or_else(|| SceneError::OutOfRange {
            field: "scene".to_owned(),
            value: format!("{name:?}"),
            allowed: Case::all().map(Case::name).collect::<Vec<_>>().join(", "),
        })
    }
}

/// Measures all pieces of a plan; see [`Study::advance`].
///
/// # Errors
/// A scene does not allow a grid of the plan.
pub fn run(
    plan: &Plan,
    reference: Option<Reference>,
    clock: &mut dyn FnMut() -> f64,
) -> Result<Vec<Row>, SceneError> {
    let mut study = Study::new(plan.clone(), reference);
    while study.advance(clock)? {}
    Ok(study.rows)
}

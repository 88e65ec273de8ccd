//! Tuned constants of Newton's method, with their meaning, unit and evidence.
//!
//! Scenes are files of `tests/stress`; `docs/notes/solver.md` has the history. Constants of the step of one tissue model
//! stand in that model's `parameters.rs`, of one safeguard in the safeguard's file in `sheet/robust`.

/// The constants of iteration, line search, error estimate and nested grids.
pub(in crate::solve) struct Parameters {
    /// Iterations after which a grid's iteration ends, times [`crate::solve::Options::work_limit_factor`].
    pub(super) max_iterations: u32,
    /// Work of a grid, and of all grids, after which the solve ends, times that factor.
    pub(super) work_of_grid: WorkLimit,
    pub(super) work_of_all_grids: WorkLimit,
    /// Work units of forces and second derivatives, of a product with them, of an energy.
    pub(super) cost: Cost,

    /// Greatest number of halvings of a step.
    pub(super) max_halvings: u32,
    /// Does a halved step keep active nodes on the dome?
    pub(super) holds_halved_steps: bool,
    /// Armijo's constant c₁: required fraction of the predicted decrease of the energy \[-\].
    pub(super) sufficient_decrease: f64,
    /// Rounding of an energy, relative to the energy \[-\]. Of the sheet fixed by `no-convergence-at-small-insertion`,
    /// `rounding-on-shallow-dome`.
    pub(super) energy_rounding: f64,
    /// Upper bound of the assumed ratio of successive steps \[-\]; of a sheet under compression the assumed ratio.
    /// Fixed by `near-zero-stiffness-after-small-step`, `premature-convergence-at-rim`.
    pub(super) max_convergence_factor: f64,
    /// Greatest relative residual before the last step \[-\]. Of the sheet fixed by `small-steps-with-large-residual`.
    pub(super) max_residual_before_step: f64,

    /// Tolerance on the coarser grids, whose solutions are only starts \[base radius\].
    pub(super) coarse_tolerance: f64,
    /// Part of the dome's height that it rises at once on the coarsest grid \[-\]; 1: the dome stands at once.
    pub(super) raise: f64,
    /// Tolerance while the dome rises \[base radius\].
    pub(super) rising_tolerance: f64,
    /// Iterations after which a solve from a given solution restarts on the coarsest grid.
    pub(super) max_warm_iterations: u32,
    /// Cells a side that the coarsest grid has at least.
    pub(super) least_cells: usize,
}

/// A limit of work, in evaluations of all forces.
#[derive(Clone, Copy)]
pub(in crate::solve) struct WorkLimit {
    /// Force evaluations times elements of the grid: a time.
    elements: f64,
    /// Least limit, on fine grids, and greatest, on coarse grids.
    least: f64,
    most: f64,
}

impl WorkLimit {
    const NONE: Self = Self { elements: f64::INFINITY, least: 0.0, most: f64::INFINITY };

    /// The limit of a grid with this number of elements.
    pub(super) fn of(self, elements: usize) -> f64 {
        (self.elements / elements as f64).clamp(self.least, self.most)
    }
}

/// Costs in work units: evaluations of all nodal forces.
pub(in crate::solve) struct Cost {
    pub(super) linearize: f64,
    pub(super) product: f64,
    pub(super) energy: f64,
}

/// Costs by floating-point operations; a limit of a few seconds a grid.
pub(super) const SHEET: Parameters = Parameters {
    max_iterations: 150,
    work_of_grid: WorkLimit { elements: 6e7, least: 400.0, most: f64::INFINITY },
    work_of_all_grids: WorkLimit::NONE,
    cost: Cost { linearize: 4.0, product: 0.6, energy: 0.7 },
    max_halvings: 12,
    holds_halved_steps: false,
    sufficient_decrease: 1e-4,
    energy_rounding: 1e-13,
    max_convergence_factor: 0.98,
    max_residual_before_step: 0.05,
    coarse_tolerance: 1e-3,
    raise: 1.0,
    rising_tolerance: 1.0,
    max_warm_iterations: 8,
    least_cells: 0,
};

/// Costs by measured times; a limit of two seconds of a core on every grid. Fixed by `layered-long-newton`.
pub(super) const LAYERED: Parameters = Parameters {
    max_iterations: 60,
    work_of_grid: WorkLimit::NONE,
    work_of_all_grids: WorkLimit { elements: 9e6, least: 0.0, most: 7500.0 },
    cost: Cost { linearize: 12.0, product: 1.0, energy: 0.7 },
    max_halvings: 12,
    holds_halved_steps: true,
    sufficient_decrease: 1e-4,
    energy_rounding: 1e-12,
    max_convergence_factor: 0.95,
    max_residual_before_step: 1e-2,
    coarse_tolerance: 3e-3,
    raise: 1.0 / 16.0,
    rising_tolerance: 3e-2,
    max_warm_iterations: 12,
    least_cells: 16,
};

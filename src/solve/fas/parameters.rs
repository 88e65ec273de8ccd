//! Tuned constants of full multigrid, with their meaning, unit and evidence.
//!
//! Scenes are files of `tests/stress`; `docs/notes/solver.md` has the history.

/// The constants of the scheme.
pub(super) struct Parameters {
    /// Damping factors of the smoothing steps of a cycle \[-\]: close to the inverse roots of a Chebyshev
    /// polynomial on the upper part of the spectrum of D⁻¹H, the longest step first. Change them together
    /// with the smoother or the blocks.
    pub(super) smoothing: &'static [f32],
    /// The same in the first cycle of a grid, whose start is smooth: interpolated from a coarser grid \[-\].
    pub(super) first_smoothing: &'static [f32],
    /// Damping factors on the coarsest grid, for its whole spectrum \[-\]. Shorter than the spectrum of a small
    /// insertion needs: over a steep dome the spectrum is wider (test `domes_off_the_centre_need_few_cycles`).
    pub(super) coarsest_smoothing: &'static [f32],
    /// Repetitions of [`Self::coarsest_smoothing`] in one solve on the coarsest grid.
    pub(super) coarsest_rounds: usize,
    /// Cycles of a grid before each of which its nodal blocks are computed anew.
    pub(super) block_cycles: u32,
    /// Fraction of the weights of the fine nodes around a coarse one that have to be active for the coarse one
    /// to be so \[-\].
    pub(super) coarse_active_weight: f32,
    /// The same in robust mode: more coarse nodes are active, so that the correction does not lift the sheet off
    /// a small contact. Fixed by `penetration-between-nodes`, `lost-contact-on-narrow-dome`.
    pub(super) robust_active_weight: f32,

    /// The most V-cycles of the finest grid.
    pub(super) max_cycles: u32,
    /// The most V-cycles of a coarser grid, whose solution is a start only.
    pub(super) max_start_cycles: u32,
    /// The error of a coarser grid that is enough for a start \[base radius\].
    pub(super) start_tolerance: f64,
    /// The most cycles on the coarsest grid; the scheme fails if the error there is above
    /// [`Self::start_tolerance`] then. Fixed by `underestimated-error-on-steep-dome`.
    pub(super) max_coarsest_cycles: u32,

    /// Lower bound of the assumed convergence factor \[-\]: the first cycles remove high frequencies and overstate
    /// the asymptotic rate.
    pub(super) min_convergence_factor: f64,
    /// Upper bound of the assumed convergence factor \[-\].
    pub(super) max_convergence_factor: f64,
    /// Factor of the error estimate for rates that grow from cycle to cycle \[-\].
    pub(super) error_safety: f64,
    /// Ratio of the changes of two cycles above which the cycle is slow \[-\].
    pub(super) slow_factor: f64,
    /// Slow cycles in a row on the finest grid that end the scheme.
    pub(super) max_slow_cycles: u32,
    /// Projection of a change on the one before \[-\] below which the change is relaxed (Aitken). Fixed by test
    /// `a_swinging_contact_edge_is_calmed`.
    pub(super) oscillation: f64,

    /// Bounds of the relative residual of a solution \[-\]; between them it is the tolerance. Up to the greater
    /// one the residual may be rounding of f32. Fixed by `slow-fallback-on-flat-dome`.
    pub(super) residual_bounds: (f64, f64),
    /// Position error \[base radius\] per relative residual \[-\], at least.
    pub(super) error_per_residual: f64,
    /// Roundings of the greatest displacement up to which a step is one of rounding \[-\].
    pub(super) roundings: f32,
    /// Stagnations out of balance that end the scheme.
    pub(super) max_stagnations: u32,
    /// Fraction of the residual of the last stagnation above which the residual stagnates again \[-\].
    pub(super) stagnation_factor: f64,
    /// The greatest contact offset \[tolerances\] that f32 decides: an active node more or less changes the shape
    /// by about as much. Fixed by `free-node-counted-as-active`.
    pub(super) max_contact_offset: f64,
}

pub(super) const PARAMETERS: Parameters = Parameters {
    smoothing: &[1.6, 0.5],
    first_smoothing: &[0.9],
    coarsest_smoothing: &[2.9, 0.3, 0.82, 0.4],
    coarsest_rounds: 3,
    block_cycles: 2,
    coarse_active_weight: 0.45,
    robust_active_weight: 0.15,
    max_cycles: 16,
    max_start_cycles: 4,
    start_tolerance: 3e-3,
    max_coarsest_cycles: 60,
    min_convergence_factor: 0.4,
    max_convergence_factor: 0.95,
    error_safety: 1.5,
    slow_factor: 0.7,
    max_slow_cycles: 3,
    oscillation: -0.25,
    residual_bounds: (3e-4, 5e-3),
    error_per_residual: 0.05,
    roundings: 16.0,
    max_stagnations: 2,
    stagnation_factor: 0.7,
    max_contact_offset: 10.0,
};

/// The least tolerance of node positions that f32 resolves \[base radius\].
pub(in crate::solve) const LEAST_TOLERANCE: f64 = 2e-6;

//! Tuned constants of full multigrid, with their meaning, unit and evidence.
//!
//! Scenes are files of `tests/stress`; `docs/notes/solver.md` has the history.

/// Damping factors of the steps before and after the correction of the coarser grid \[-\].
#[derive(Clone, Copy, Debug)]
pub(super) struct Smoothing {
    pub(super) before: &'static [f32],
    pub(super) after: &'static [f32],
}

/// The constants of the scheme.
#[derive(Debug)]
pub(in crate::solve) struct Parameters {
    /// Damping factors of the smoothing steps of a cycle \[-\]: close to the inverse roots of a Chebyshev
    /// polynomial on the upper part of the spectrum of D⁻¹H. Change them together with the smoother or the blocks.
    pub(super) smoothing: Smoothing,
    /// The same in the first cycle of a grid, whose start is smooth: interpolated from a coarser grid \[-\].
    pub(super) first_smoothing: Smoothing,
    /// Least factor of a coarser grid's correction \[-\], up to the first grid and once a cycle of the grid being solved was
    /// slow; `None`: no scaling.
    pub(super) correction_scale: Option<f32>,
    /// Bounds of the factor θ by which the results of two cycles are mixed, of the sum of both of three cycles \[-\] (D. G. Anderson,
    /// J. ACM 12, 1965).
    pub(super) mixing_bounds: (f64, f64),
    /// Cycles of the first and the finest grid from which on three results are mixed instead of two. Cycles before change their
    /// active set: from the third on a torso takes 112 work units instead of 91.
    pub(super) three_mixed_from: u32,
    /// Is a step shortened by the hardening of the adjacent springs?
    pub(super) has_hardening: bool,
    /// Parts of the dome's height that stand one after the other on the rising grid, the last one 1 \[-\].
    pub(super) rise: &'static [f64],
    /// The rising grid, counted from the coarsest; at most the finest. Where the rise fails, it goes on a grid finer.
    pub(super) rising_grid: usize,
    /// The least cycles under a dome that is to rise further. Of 30 bodies at 129 nodes a side that need it, none is lost by two or
    /// three cycles; solved to an error of 2 % they take 1.1 of the work.
    pub(super) cycles_of_step: u32,
    /// Change of a cycle up to which such a dome rises \[base radius\].
    pub(super) rising_change: f64,
    /// The most cycles under such a dome; the attempt fails if the change is above [`Self::rising_change`] afterwards.
    pub(super) max_cycles_of_step: u32,
    /// The grid on which the solve starts, counted from the coarsest.
    pub(super) first_grid: usize,
    /// The least number of cells a side of a grid with a finer one.
    pub(super) least_cells: usize,
    /// Damping factors on the coarsest grid, for its whole spectrum \[-\]. The interval is wider than the
    /// spectrum at a small insertion: over a steep dome the spectrum is wider (test `domes_off_centre_need_few_cycles`).
    pub(super) coarsest_smoothing: &'static [f32],
    /// The same while the coarsest grid is solved by itself, from a start far from its solution \[-\].
    pub(super) coarsest_start: &'static [f32],
    /// Repetitions of [`Self::coarsest_smoothing`] or [`Self::coarsest_start`] in one solve on the coarsest grid.
    pub(super) coarsest_rounds: usize,
    /// Number of first cycles of a grid that recompute the grid's nodal blocks. The coarsest grid recomputes them in every
    /// cycle of its own.
    pub(super) block_cycles: u32,
    /// Growth of the residual above the inner face since the last blocks at which the blocks are renewed before the next
    /// step \[-\]: the tissue has stiffened.
    pub(super) block_growth: f64,
    /// Weighted fraction of active fine nodes around a coarse node above which the coarse node is active \[-\].
    pub(super) coarse_active_weight: f32,
    /// [`Self::coarse_active_weight`] in robust mode: with more active coarse nodes the correction does not lift the
    /// sheet off a small contact. Fixed by `penetration-between-nodes`, `lost-contact-on-narrow-dome`.
    pub(super) robust_active_weight: f32,

    /// The least tolerance of node positions that f32 resolves \[base radius\].
    pub(in crate::solve) least_tolerance: f64,
    /// The most V-cycles of the finest grid.
    pub(super) max_cycles: u32,
    /// The most V-cycles of a coarser grid, whose solution is a start only.
    pub(super) max_start_cycles: u32,
    /// Error of a coarser grid's solution that is sufficient for a start \[base radius\].
    pub(super) start_tolerance: f64,
    /// The same of the first grid \[base radius\].
    pub(super) coarsest_tolerance: f64,
    /// The most cycles on the first grid; the scheme fails if the error is above [`Self::coarsest_tolerance`]
    /// afterwards. Fixed by `underestimated-error-on-steep-dome`.
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

    /// Bounds of the greatest relative residual of a solution \[-\], which is the tolerance between the bounds. Below
    /// the upper bound the residual may be rounding of f32. Fixed by `slow-fallback-on-flat-dome`.
    pub(super) residual_bounds: (f64, f64),
    /// Lower bound of the position error \[base radius\] per relative residual \[-\].
    pub(super) error_per_residual: f64,
    /// Length of a step at the rounding level \[roundings of the greatest displacement\].
    pub(super) roundings: f32,
    /// Number of stagnations that ends the scheme: balance tests whose residual fell by less than
    /// [`Self::stagnation_factor`] since the previous test.
    pub(super) max_stagnations: u32,
    /// Fraction of the residual of the last balance test above which the residual stagnates \[-\].
    pub(super) stagnation_factor: f64,
    /// The greatest contact offset for f32 \[tolerances\]: one active node more or less changes the shape by about
    /// the offset. Fixed by `free-node-counted-as-active`.
    pub(super) max_contact_offset: f64,
}

/// Damping factors of a membrane on the coarsest grid, at the start as later \[-\].
const MEMBRANE_COARSEST: &[f32] = &[2.9, 0.3, 0.82, 0.4];

/// The constants for a membrane.
pub(in crate::solve) const MEMBRANE: Parameters = Parameters {
    smoothing: Smoothing { before: &[1.6, 0.5], after: &[1.6, 0.5] },
    first_smoothing: Smoothing { before: &[0.9], after: &[0.9] },
    correction_scale: None,
    mixing_bounds: (-4.0, 0.5),
    three_mixed_from: u32::MAX,
    has_hardening: true,
    rise: &[1.0],
    rising_grid: 0,
    cycles_of_step: 3,
    rising_change: 5e-2,
    max_cycles_of_step: 20,
    first_grid: 0,
    least_cells: 8,
    coarsest_smoothing: MEMBRANE_COARSEST,
    coarsest_start: MEMBRANE_COARSEST,
    coarsest_rounds: 3,
    block_cycles: 2,
    block_growth: f64::INFINITY,
    coarse_active_weight: 0.45,
    robust_active_weight: 0.15,
    least_tolerance: 2e-6,
    max_cycles: 80,
    max_start_cycles: 4,
    start_tolerance: 3e-3,
    coarsest_tolerance: 3e-3,
    max_coarsest_cycles: 60,
    min_convergence_factor: 0.4,
    max_convergence_factor: 0.95,
    error_safety: 3.0,
    slow_factor: 0.9,
    max_slow_cycles: 10,
    residual_bounds: (3e-4, 5e-3),
    error_per_residual: 0.05,
    roundings: 16.0,
    max_stagnations: 6,
    stagnation_factor: 0.9,
    max_contact_offset: 10.0,
};

/// Steps of a membrane whose curve turns steep or flat within a step.
const GENTLE_MEMBRANE_SMOOTHING: Smoothing =
    Smoothing { before: &[0.25, 0.35, 0.9], after: &[0.25, 0.35, 0.9] };

/// The constants of the second attempt for a membrane: smaller steps, blocks renewed in every cycle.
pub(in crate::solve) const MEMBRANE_GENTLE: Parameters = Parameters {
    smoothing: GENTLE_MEMBRANE_SMOOTHING,
    first_smoothing: GENTLE_MEMBRANE_SMOOTHING,
    coarsest_smoothing: &[0.25, 0.3, 0.5, 0.9, 0.25, 0.4],
    coarsest_start: &[0.25, 0.3, 0.5, 0.9, 0.25, 0.4],
    block_cycles: u32::MAX,
    ..MEMBRANE
};

/// Inverse roots of a Chebyshev polynomial on [0.6, 6] \[-\], the shortest step first: a long step amplifies the stiff modes
/// until shorter ones follow, and a tissue that stiffens by as much does not return (order of the steps: V. I. Lebedev and
/// S. A. Finogenov, USSR Comput. Math. Math. Phys. 11(2), 1971).
const LAYERED_SMOOTHING: Smoothing =
    Smoothing { before: &[0.1774, 0.3030, 1.0398], after: &[0.1774, 0.3030, 1.0398] };

/// Inverse roots of Chebyshev polynomials on [0.45, 10] \[-\].
const FRESH_SMOOTHING: Smoothing =
    Smoothing { before: &[0.1163, 0.5410], after: &[0.1038, 0.1418, 0.2943, 1.2293] };

/// Inverse roots of Chebyshev polynomials on [0.8, 20] \[-\].
const GENTLE_SMOOTHING: Smoothing = Smoothing {
    before: &[0.0534, 0.0962, 0.4794],
    after: &[0.0512, 0.0623, 0.0962, 0.2102, 0.7875],
};

/// The constants of the second attempt for layered tissue that stiffens too fast for [`LAYERED`], or whose spectrum of D⁻¹H
/// reaches farther: blocks renewed before every step.
pub(in crate::solve) const LAYERED_FRESH: Parameters = Parameters {
    smoothing: FRESH_SMOOTHING,
    first_smoothing: FRESH_SMOOTHING,
    block_growth: 0.0,
    min_convergence_factor: 0.6,
    error_safety: 8.0,
    ..LAYERED
};

/// The constants of the second attempt for layered tissue with a solid that softens, or with none that stiffens: smaller
/// steps, blocks renewed in every cycle.
pub(in crate::solve) const LAYERED_GENTLE: Parameters = Parameters {
    coarsest_tolerance: 3e-3,
    smoothing: GENTLE_SMOOTHING,
    first_smoothing: GENTLE_SMOOTHING,
    coarsest_smoothing: &[0.2; 24],
    coarsest_start: &[0.2; 24],
    first_grid: 2,
    block_cycles: u32::MAX,
    max_start_cycles: 4,
    max_slow_cycles: 16,
    max_stagnations: 6,
    min_convergence_factor: 0.6,
    error_safety: 8.0,
    ..LAYERED
};

/// The constants of the third attempt for layered tissue over a chest or of uneven thickness: the dome rises on the second grid. Tight
/// skin over a steep dome stiffens so fast that the first grid has no shape under all of it, or that the first cycle after a refinement
/// loses the shape, although shapes near the solution converge in a few cycles. Steps of a quarter of the height are too long.
/// On 33 nodes a node of the inner face snaps from one place to the next in 20 slow cycles, which at first grow by up to a tenth each.
pub(in crate::solve) const LAYERED_RISING: Parameters = Parameters {
    rise: &[0.5, 0.6, 0.7, 0.8, 0.87, 0.94, 1.0],
    rising_grid: LAYERED.first_grid + 1,
    max_slow_cycles: 24,
    ..LAYERED
};

/// The constants for layered tissue. The spectrum of D⁻¹H reaches 3.4 at rest, 4 to 5 on the dome, 7 on steep domes
/// and 10 where four points meet a strain that concentrates in softening tissue: the stiff modes are smooth changes of
/// thickness, the soft ones checkerboards. The solution of the coarsest grid is several per cent of the base radius away from
/// the finer one: an error of 3 % is sufficient for a start. Random patients take 64, 44 and 40 force evaluations in the median
/// at 33, 65 and 129 nodes per side; at 33 the error is at most 0.9 of its estimate, in 95 % of the patients 0.75, over chests 1.3.
pub(in crate::solve) const LAYERED: Parameters = Parameters {
    smoothing: LAYERED_SMOOTHING,
    first_smoothing: LAYERED_SMOOTHING,
    // Longer corrections lose the shape of tight skin under a rising dome: 2 of 2000 random patients.
    correction_scale: Some(0.1),
    mixing_bounds: (-4.0, 0.5),
    three_mixed_from: 4,
    has_hardening: false,
    rise: &[1.0],
    rising_grid: 0,
    cycles_of_step: 3,
    rising_change: 5e-2,
    max_cycles_of_step: 20,
    // Thick tissue holds a smooth change of thickness at 1/1200 of the stiffest mode on 17 nodes per side: steps there do not
    // reach it, steps on 9 do.
    first_grid: 1,
    least_cells: 8,
    // Inverse roots of a Chebyshev polynomial on [0.3, 8]. From a start far away the longest step loses shapes of soft fat
    // under tight skin: of 256 samples of the opening plan 24 have none, 21 with the shorter steps of the start, 19 with
    // steps of at most 1.2 throughout, which need a second attempt twice as often at 97 nodes per side.
    coarsest_smoothing: &[0.1271, 0.1455, 0.1943, 0.3171, 0.7005, 2.3192],
    coarsest_start: &[0.13, 0.15, 0.25, 0.2, 0.4, 1.2],
    coarsest_rounds: 2,
    block_cycles: 2,
    block_growth: 1.5,
    coarse_active_weight: 0.45,
    robust_active_weight: 0.15,
    least_tolerance: 1e-5,
    max_cycles: 80,
    max_start_cycles: 3,
    start_tolerance: 3e-3,
    coarsest_tolerance: 3e-2,
    max_coarsest_cycles: 60,
    // A low bound and a great safety let the observed rate decide: random patients converge at 0.2 to 0.5 a cycle.
    min_convergence_factor: 0.3,
    max_convergence_factor: 0.95,
    error_safety: 6.0,
    slow_factor: 0.9,
    max_slow_cycles: 6,
    // At 33 nodes per side the residual of some solved scenes stays at 2e-3 to 3e-3: of 2000 random patients four went to Newton's
    // method with a bound of 2e-3, none with 4e-3, and no error is above the tolerance.
    residual_bounds: (4e-3, 1e-2),
    error_per_residual: 0.05,
    roundings: 16.0,
    max_stagnations: 3,
    stagnation_factor: 0.9,
    max_contact_offset: 10.0,
};

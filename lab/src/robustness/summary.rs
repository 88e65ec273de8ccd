//! Numbers of cases by outcome, failures and slowest cases of a run.

use super::{Case, Ending};
use implant_preview_core::scene::Springs;
use serde::Serialize;

/// Numbers of cases by outcome.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Endings {
    /// All cases.
    pub cases: u64,
    /// [`Ending::Converged`].
    pub converged: u64,
    /// [`Ending::Several`].
    pub several: u64,
    /// [`Ending::NotConverged`].
    pub not_converged: u64,
    /// [`Ending::Unstable`].
    pub unstable: u64,
    /// [`Ending::Pierced`].
    pub pierced: u64,
    /// [`Ending::Failed`].
    pub failed: u64,
    /// Cases in which Newton's method, or the second attempt of layered tissue, replaced full multigrid.
    pub fell_back: u64,
    /// Cases with two converged comparisons.
    pub held_both_ways: u64,
}

impl Endings {
    pub(super) fn add(&mut self, case: &Case) {
        self.cases += 1;
        self.fell_back += u64::from(case.fell_back);
        self.held_both_ways += u64::from(case.ways == 2);
        *match case.ending {
            Ending::Converged => &mut self.converged,
            Ending::Several => &mut self.several,
            Ending::NotConverged => &mut self.not_converged,
            Ending::Unstable => &mut self.unstable,
            Ending::Pierced => &mut self.pierced,
            Ending::Failed => &mut self.failed,
        } += 1;
    }

    /// Fraction of converged cases among the cases without a penetrated sheet \[-\].
    #[must_use]
    pub fn converged_share(&self) -> f64 {
        self.converged as f64 / (self.cases - self.pierced).max(1) as f64
    }
}

/// The summary of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Summary {
    /// The seed.
    pub seed: u64,
    /// Scenes with coupled springs.
    pub coupled: Endings,
    /// [`Endings::converged_share`] of the scenes with coupled springs.
    pub coupled_converged_share: f64,
    /// Scenes with the paper's springs.
    pub nikolaev: Endings,
    /// Number of sessions of random edits.
    pub sessions: u64,
    /// Failed cases.
    pub failures: Vec<Case>,
    /// The ten cases with the most work, up to ten cases with several equilibria, up to ten cases that did
    /// not converge.
    pub worst: Vec<Case>,
}

/// Number of cases of each kind in [`Summary::worst`].
const WORST_CASES: usize = 10;

impl Summary {
    /// Summarises cases in their order.
    #[must_use]
    pub fn new(seed: u64, cases: &[Case]) -> Self {
        let mut summary = Self { seed, ..Self::default() };
        for case in cases {
            match case.scene.springs {
                Springs::Coupled => summary.coupled.add(case),
                Springs::Nikolaev => summary.nikolaev.add(case),
            }
            summary.sessions += u64::from(case.in_session);
        }
        summary.coupled_converged_share = summary.coupled.converged_share();
        let is = |ending: Ending| move |case: &&Case| case.ending == ending;
        summary.failures = cases.iter().filter(is(Ending::Failed)).cloned().collect();
        let mut by_work: Vec<&Case> = cases.iter().collect();
        by_work.sort_by(|a, b| b.work_units.total_cmp(&a.work_units));
        let several = cases.iter().filter(is(Ending::Several)).take(WORST_CASES);
        let unfinished = cases.iter().filter(is(Ending::NotConverged)).take(WORST_CASES);
        let worst = by_work.into_iter().take(WORST_CASES).chain(several).chain(unfinished);
        summary.worst = worst.cloned().collect();
        summary
    }
}

/// Outcomes and costs of one population of layered tissue.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct PopulationSummary {
    /// Numbers of cases by outcome.
    #[serde(flatten)]
    pub endings: Endings,
    /// [`Endings::converged_share`].
    pub converged_share: f64,
    /// Greatest work of a case \[evaluations of all forces on the finest grid\].
    pub max_work_units: f64,
    /// Greatest time of a solve \[ms\]; `None` without a clock.
    pub max_time_ms: Option<f64>,
    /// Median time of a solve \[ms\]; `None` without a clock.
    pub median_time_ms: Option<f64>,
    /// Cases with a cell that has an inverted corner.
    pub with_inverted_corners: u64,
}

impl PopulationSummary {
    fn new(cases: &[&Case]) -> Self {
        let mut summary = Self::default();
        let mut times: Vec<f64> = cases.iter().filter_map(|case| case.time_ms).collect();
        times.sort_by(f64::total_cmp);
        for case in cases {
            summary.endings.add(case);
            summary.max_work_units = summary.max_work_units.max(case.work_units);
            summary.with_inverted_corners += u64::from(case.inverted_corners > 0);
        }
        summary.converged_share = summary.endings.converged_share();
        summary.max_time_ms = times.last().copied();
        summary.median_time_ms = times.get(times.len() / 2).copied();
        summary
    }
}

/// The summary of a run over layered tissue.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LayeredSummary {
    /// The seed.
    pub seed: u64,
    /// `Population::Realistic` or `Population::RealisticChest`.
    pub realistic: PopulationSummary,
    /// `Population::Extreme` or `Population::ExtremeChest`.
    pub extreme: PopulationSummary,
    /// Number of sessions of random edits.
    pub sessions: u64,
    /// Failed cases.
    pub failures: Vec<Case>,
    /// The ten slowest cases (of most work without a clock), up to ten cases with several equilibria, up to ten
    /// realistic cases that did not converge.
    pub worst: Vec<Case>,
}

impl LayeredSummary {
    /// Summarises cases in their order.
    #[must_use]
    pub fn new(seed: u64, cases: &[Case]) -> Self {
        let of = |is_extreme: bool| {
            let cases: Vec<&Case> =
                cases.iter().filter(|c| c.population.is_extreme() == is_extreme).collect();
            PopulationSummary::new(&cases)
        };
        let cost = |case: &Case| case.time_ms.unwrap_or(case.work_units);
        let mut by_cost: Vec<&Case> = cases.iter().collect();
        by_cost.sort_by(|a, b| cost(b).total_cmp(&cost(a)));
        let is = |ending: Ending| move |case: &&Case| case.ending == ending;
        let several = cases.iter().filter(is(Ending::Several)).take(WORST_CASES);
        let is_unfinished = |case: &&Case| {
            !case.population.is_extreme()
                && matches!(case.ending, Ending::NotConverged | Ending::Unstable | Ending::Pierced)
        };
        let unfinished = cases.iter().filter(is_unfinished).take(WORST_CASES);
        let worst = by_cost.into_iter().take(WORST_CASES).chain(several).chain(unfinished);
        Self {
            seed,
            realistic: of(false),
            extreme: of(true),
            sessions: cases.iter().map(|case| u64::from(case.in_session)).sum(),
            failures: cases.iter().filter(is(Ending::Failed)).cloned().collect(),
            worst: worst.cloned().collect(),
        }
    }
}

//! A plan at the times after its operation: pressure and stretch on the table, shape after six months, with what the spread of relaxation
//! and growth does to them.

use super::one_by_one::OneByOne;
use super::{Case, Cases, Job, Quantity, Study};
use crate::clinical::{Expected, When};
use crate::scene::{Field, Scene};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// Schema of a file with times.
pub const TIMES_SCHEMA: &str = "implant-preview/times/1";

/// Skin that has relaxed and grown as expected, by a standard deviation less of both, or more.
const STATES: usize = 3;

/// The plan at its times as a state machine, a [`Study`] of one scene on the table and three at every later time, on the plan's own grid.
#[derive(Debug)]
pub struct Times {
    scenes: Vec<(When, usize, Scene)>,
    /// The cases of the scenes; `None` before, a case without values without an answer.
    cases: Vec<Option<Case>>,
    asked: usize,
    jobs: OneByOne<usize>,
}

/// A quantity at a time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct AtTime {
    /// With relaxation and growth as expected.
    pub value: f64,
    /// Least and greatest value within a standard deviation of both; equal to the value on the table.
    pub range: [f64; 2],
}

impl Times {
    /// The times of a plan of layered tissue. What the plan itself has relaxed and grown does not count.
    ///
    /// # Errors
    /// One line for a sheet.
    pub fn new(plan: &Scene) -> Result<Self, &'static str> {
        if !plan.is_layered() {
            return Err("times: a sheet; allowed: layered tissue");
        }
        let state = |when: When, state: usize| {
            let mut scene = plan.at(when);
            scene.patient = None;
            let [least, most] = when.grown().range(Field::Grown.limits);
            let [softest, stiffest] = when.relaxed().range(Field::Relaxed.limits);
            let own = &mut scene.body.skin_state;
            match state {
                0 => {}
                1 => (own.grown, own.relaxed) = (least, stiffest),
                _ => (own.grown, own.relaxed) = (most, softest),
            }
            (when, state, scene)
        };
        let states = |when: When| match when {
            When::OnTheTable => 0..1,
            When::Week | When::SixMonths => 0..STATES,
        };
        let all = When::ALL.into_iter().flat_map(|when| states(when).map(move |k| (when, k)));
        let scenes: Vec<_> = all.map(|(when, k)| state(when, k)).collect();
        let cases = vec![None; scenes.len()];
        Ok(Self { scenes, cases, asked: 0, jobs: OneByOne::new() })
    }

    /// The cases of a time, first the expected one; `None` of one before its end.
    fn cases(&self, when: When) -> impl Iterator<Item = Option<&Case>> {
        let own = self.scenes.iter().zip(&self.cases).filter(move |((at, ..), _)| *at == when);
        own.map(|(_, case)| case.as_ref())
    }

    /// A quantity at a time; `None` before the end of its scenes, and if the expected one has no answer. The range leaves out deviations
    /// without an answer.
    #[must_use]
    pub fn value(&self, when: When, quantity: Quantity) -> Option<AtTime> {
        let cases: Vec<&Case> = self.cases(when).collect::<Option<_>>()?;
        let of = |case: &Case| case.values.get(quantity).filter(|_| case.is_converged());
        let value = of(cases.first()?)?;
        let range = [f64::min as fn(f64, f64) -> f64, f64::max]
            .map(|least| cases.iter().filter_map(|case| of(case)).fold(value, least));
        Some(AtTime { value, range })
    }

    /// Number of deviations at a time that have no answer.
    #[must_use]
    pub fn left_out(&self, when: When) -> usize {
        let deviations = self.cases(when).skip(1).flatten();
        deviations.filter(|case| !case.is_converged()).count()
    }

    /// The times with all their quantities, as a file.
    #[must_use]
    pub fn file(&self) -> TimesFile {
        let time = |when: When| TimeFile {
            when,
            relaxed: when.relaxed(),
            grown: when.grown(),
            fold_drop_mm: when.fold_drop_mm(),
            source: when.source(),
            left_out: self.left_out(when),
            values: Quantity::ALL
                .into_iter()
                .filter_map(|quantity| Some((quantity.name(), self.value(when, quantity)?)))
                .collect(),
        };
        TimesFile { schema: TIMES_SCHEMA, times: When::ALL.map(time).to_vec() }
    }
}

impl Study for Times {
    fn next_job(&mut self, store: &mut Cases) -> Option<(usize, Job)> {
        while let Some((_, _, scene)) = self.scenes.get(self.asked) {
            let number = self.asked;
            self.asked += 1;
            match self.jobs.ask(number, scene.clone(), store) {
                Ok(case) => self.cases[number] = Some(case),
                Err(job) => return Some(job),
            }
        }
        None
    }

    fn receive(&mut self, job: usize, cases: Vec<Case>, store: &mut Cases) {
        if let Some((number, case)) = self.jobs.receive(job, cases, store) {
            self.cases[number] = Some(case.unwrap_or_default());
        }
    }

    fn progress(&self) -> (usize, usize) {
        (self.cases.iter().flatten().count(), self.cases.len())
    }
}

/// A plan at its times, as a file.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct TimesFile {
    /// `implant-preview/times/1`.
    schema: &'static str,
    /// On the table, after a week, after six months.
    times: Vec<TimeFile>,
}

/// A time in a file.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
struct TimeFile {
    when: When,
    /// What is left of the tension above the natural one \[-\].
    relaxed: Expected,
    /// Fraction of the stretch that has become growth \[-\].
    grown: Expected,
    /// How far the fold has moved down, of no computed shape \[mm\].
    fold_drop_mm: Expected,
    /// Where these three are from.
    source: &'static str,
    /// Number of deviations without an answer, which the ranges leave out.
    left_out: usize,
    /// The quantities of `map`, by their names; without an answer none.
    #[schemars(with = "BTreeMap<Quantity, AtTime>")]
    values: BTreeMap<&'static str, AtTime>,
}

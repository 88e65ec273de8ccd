//! Stopwatch of a running method: pauses the clock, measures the error, continues.

use glam::DVec3;

/// Number of steps between two readings of the clock.
const STEPS_PER_READING: u32 = 8;

/// Error of a method at one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    pub(super) work_units: f64,
    pub(super) time_ms: f64,
    /// Error against the grid's own equilibrium \[fraction of the base radius\].
    pub(super) own_error: f64,
    /// Error against the axisymmetric reference, of layered tissue that of the skin \[fraction of the base radius\].
    pub(super) reference_error: Option<f64>,
    /// Error of the inner face of layered tissue against the axisymmetric reference \[fraction of the base radius\].
    pub(super) inner_reference_error: Option<f64>,
}

/// Errors of positions \[fraction of the base radius\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Deviation {
    /// Against the grid's own equilibrium.
    pub(super) own: f64,
    /// Against the axisymmetric reference: of the sheet, or the skin.
    pub(super) reference: Option<f64>,
    /// Against the axisymmetric reference: of the inner face of layered tissue.
    pub(super) inner_reference: Option<f64>,
}

impl Deviation {
    /// The sample of these errors.
    pub(super) fn sample(self, work_units: f64, time_ms: f64) -> Sample {
        Sample {
            work_units,
            time_ms,
            own_error: self.own,
            reference_error: self.reference,
            inner_reference_error: self.inner_reference,
        }
    }
}

/// Termination of a method.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// The method ended by its own criterion or reached the goal of the study.
    Finished,
    /// The method exceeded the time budget.
    Budget,
    /// A position is not a number, or the method did not converge.
    Failed,
}

/// Errors of positions \[mm\].
pub(super) type Errors<'a> = &'a dyn Fn(&[DVec3]) -> Deviation;

/// Steps of the samples and limits of a run.
#[derive(Clone, Copy, Debug)]
pub(super) struct Schedule {
    /// Time budget \[ms\].
    pub(super) budget_ms: f64,
    /// Step of the first sample.
    pub(super) first: u32,
    /// Ratio of the steps of two consecutive samples.
    pub(super) growth: f64,
    /// Error against the grid's own equilibrium that ends a method.
    pub(super) goal: f64,
}

/// A stopwatch with the samples of a run.
pub(super) struct Watch<'a> {
    clock: &'a mut dyn FnMut() -> f64,
    errors: Errors<'a>,
    schedule: Schedule,
    /// Time so far without pauses \[ms\].
    elapsed_ms: f64,
    /// Clock reading after the last pause \[ms\].
    started: f64,
    next: u32,
    positions: Vec<DVec3>,
    pub(super) samples: Vec<Sample>,
}

impl<'a> Watch<'a> {
    /// Starts a watch; `positions` \[mm\] contain the fixed nodes.
    pub(super) fn start(
        clock: &'a mut dyn FnMut() -> f64,
        errors: Errors<'a>,
        schedule: Schedule,
        positions: Vec<DVec3>,
    ) -> Self {
        let started = clock();
        let next = schedule.first;
        let samples = Vec::new();
        Self { clock, errors, schedule, elapsed_ms: 0.0, started, next, positions, samples }
    }

    /// Returns `true` if a sample is due after a step.
    #[inline]
    pub(super) fn is_due(&mut self, steps: u32) -> bool {
        steps >= self.next || (steps.is_multiple_of(STEPS_PER_READING) && self.is_out_of_time())
    }

    pub(super) fn is_out_of_time(&mut self) -> bool {
        self.elapsed_ms + (self.clock)() - self.started >= self.schedule.budget_ms
    }

    /// Pauses the clock and samples the error of the shape that `write` stores; returns the reason if the
    /// method ends.
    pub(super) fn sample(
        &mut self,
        steps: u32,
        work_units: f64,
        write: impl FnOnce(&mut [DVec3]),
    ) -> Option<End> {
        self.elapsed_ms += (self.clock)() - self.started;
        write(&mut self.positions);
        let errors = (self.errors)(&self.positions);
        let (own_error, time_ms) = (errors.own, self.elapsed_ms);
        let is_number = own_error.is_finite();
        if is_number {
            self.samples.push(errors.sample(work_units, time_ms));
        }
        self.next = (f64::from(steps) * self.schedule.growth).ceil() as u32;
        self.next = self.next.max(steps + 1);
        self.started = (self.clock)();
        if !is_number {
            Some(End::Failed)
        } else if own_error <= self.schedule.goal {
            Some(End::Finished)
        } else {
            (time_ms >= self.schedule.budget_ms).then_some(End::Budget)
        }
    }
}

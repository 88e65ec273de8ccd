//! Watches a method at work: stops the clock, measures the error, goes on.

use glam::DVec3;

/// Steps between two looks at the clock.
const STEPS_PER_LOOK: u32 = 8;

/// A method's error at one moment of its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sample {
    pub(super) work_units: f64,
    pub(super) time_ms: f64,
    /// Against the grid's own equilibrium \[share of the base radius\].
    pub(super) own_error: f64,
    /// Against the axisymmetric reference \[share of the base radius\].
    pub(super) reference_error: Option<f64>,
}

/// How a method's way ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// By its own rule, or as near to the equilibrium as the study looks.
    Finished,
    /// Out of time.
    Budget,
    /// Not a number any more, or not converged.
    Failed,
}

/// Own and reference error of positions \[mm\].
pub(super) type Judge<'a> = &'a dyn Fn(&[DVec3]) -> (f64, Option<f64>);

/// When to look, and for how long.
#[derive(Clone, Copy, Debug)]
pub(super) struct Schedule {
    /// Time allowed \[ms\].
    pub(super) budget_ms: f64,
    /// The step of the first sample, and the ratio of one sample's step to the last one's.
    pub(super) first: u32,
    pub(super) growth: f64,
    /// The own error that is near enough to end a method.
    pub(super) goal: f64,
}

/// A stopwatch with a notebook.
pub(super) struct Watch<'a> {
    clock: &'a mut dyn FnMut() -> f64,
    judge: Judge<'a>,
    schedule: Schedule,
    /// Time so far without pauses \[ms\], and when the clock was started last.
    elapsed_ms: f64,
    started: f64,
    next: u32,
    positions: Vec<DVec3>,
    pub(super) samples: Vec<Sample>,
}

impl<'a> Watch<'a> {
    /// A running watch; `positions` \[mm\] are where the nodes that never move are.
    pub(super) fn start(
        clock: &'a mut dyn FnMut() -> f64,
        judge: Judge<'a>,
        schedule: Schedule,
        positions: Vec<DVec3>,
    ) -> Self {
        let started = clock();
        let next = schedule.first;
        let samples = Vec::new();
        Self { clock, judge, schedule, elapsed_ms: 0.0, started, next, positions, samples }
    }

    /// After a step: is there reason to stop and look?
    #[inline]
    pub(super) fn is_due(&mut self, steps: u32) -> bool {
        steps >= self.next || (steps.is_multiple_of(STEPS_PER_LOOK) && self.is_out_of_time())
    }

    pub(super) fn is_out_of_time(&mut self) -> bool {
        self.elapsed_ms + (self.clock)() - self.started >= self.schedule.budget_ms
    }

    /// Stops the clock, measures the shape that `write` puts down, and starts the clock again; tells
    /// if this is the end.
    pub(super) fn look(
        &mut self,
        steps: u32,
        work_units: f64,
        write: impl FnOnce(&mut [DVec3]),
    ) -> Option<End> {
        self.elapsed_ms += (self.clock)() - self.started;
        write(&mut self.positions);
        let (own_error, reference_error) = (self.judge)(&self.positions);
        let time_ms = self.elapsed_ms;
        let is_number = own_error.is_finite();
        if is_number {
            self.samples.push(Sample { work_units, time_ms, own_error, reference_error });
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

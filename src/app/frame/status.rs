//! The status line: state of the computation, accuracy and cost.

use crate::app::plan::advanced;
use crate::app::texts::{fixed, localized, tr};
use crate::app::widgets::theme;
use crate::measure::{Outcome, Status, no_shape};
use crate::scene::Scene;
use crate::session::Session;
use crate::solve::Displayed;
use crate::springs::Springs;
use eframe::egui::{RichText, Ui};
use std::collections::VecDeque;

/// Times of frames and solves \[ms\].
#[derive(Clone, Debug, Default)]
pub(crate) struct Timing {
    /// Times of frames \[ms\].
    frames: Recent,
    /// Solver times of the frames that solved \[ms\].
    pub(crate) slices: Recent,
    /// Greatest solver time of a frame after the opening scene \[ms\].
    pub(crate) slice_max: f64,
    /// Number of frames since the start.
    pub(crate) frame_count: u64,
    /// Solver time for the present scene \[ms\].
    pub(crate) solve_ms: f64,
}

/// The scene that a slice of solving belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SliceOf {
    /// The first scene, which has one long slice.
    OpeningScene,
    EditedScene,
}

/// The most recent times \[ms\], at most [`TIMES_KEPT`].
#[derive(Clone, Debug, Default)]
pub(crate) struct Recent(VecDeque<f64>);

const TIMES_KEPT: usize = 240;

impl Recent {
    pub(crate) fn add(&mut self, ms: f64) {
        if self.0.len() == TIMES_KEPT {
            self.0.pop_front();
        }
        self.0.push_back(ms);
    }

    /// The percentile of a fraction \[-\], 0 to 1.
    pub(crate) fn percentile(&self, fraction: f64) -> f64 {
        let mut sorted: Vec<f64> = self.0.iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        let rank = (fraction * sorted.len().saturating_sub(1) as f64).round() as usize;
        sorted.get(rank).copied().unwrap_or(0.0)
    }
}

impl Timing {
    pub(crate) fn add_frame(&mut self, ms: f64) {
        self.frame_count += 1;
        self.frames.add(ms);
    }

    /// Adds the time of a slice of solving \[ms\].
    pub(crate) fn add_slice(&mut self, ms: f64, scene: SliceOf) {
        self.solve_ms += ms;
        if scene == SliceOf::EditedScene {
            self.slice_max = self.slice_max.max(ms);
        }
        self.slices.add(ms);
    }

    /// The percentile of the frame times \[ms\] for a fraction \[-\].
    pub(crate) fn percentile(&self, fraction: f64) -> f64 {
        self.frames.percentile(fraction)
    }
}

/// State of the computation, with details. Its text has no colour of a tissue limit.
struct StatusText {
    text: &'static str,
    details: String,
    is_warning: bool,
}

/// What is computed beside the figures of a solved plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pending {
    /// The stretch under practice's volumes.
    Practice,
    /// The largest volume within it.
    LargestVolume,
    /// The ranges over sampled patients.
    Ranges,
}

impl Pending {
    fn words(self) -> &'static str {
        tr(match self {
            Self::Practice => "Comparing with practice…",
            Self::LargestVolume => "Computing the largest volume…",
            Self::Ranges => "Computing the ranges…",
        })
    }

    /// The state of the answer in a sentence, for screen readers.
    pub(crate) fn sentence(self) -> &'static str {
        tr(match self {
            Self::Practice => "The comparison with practice is still being computed.",
            Self::LargestVolume => "The largest volume is still being computed.",
            Self::Ranges => "The ranges over patients are still being computed.",
        })
    }
}

fn status_text(session: &Session) -> StatusText {
    let quiet = |text, details: String| StatusText { text, details, is_warning: false };
    let warning = |text, details: String| StatusText { text, details, is_warning: true };
    if session.is_stopped() {
        return warning(
            tr("Stopped: not computed"),
            tr("The computation was cancelled.").to_owned(),
        );
    }
    let Some(outcome) = session.result() else {
        let details = match session.displayed() {
            Displayed::Draft if session.scene().springs == Springs::Nikolaev => {
                tr("Provisional shape; the stability test is running.").to_owned()
            }
            Displayed::Draft => {
                tr("Provisional shape: position error below 0.1 % of the base radius.").to_owned()
            }
            Displayed::Coarse { nodes_per_side } => {
                let shape = tr!(
                    "Provisional shape on a coarse grid: {nodes_per_side} of {all} nodes per side.",
                    nodes_per_side,
                    all = session.problem().sheet().nodes_per_side()
                );
                let of_coarser = session.outcome().filter(|_| session.is_outcome_present());
                shape + &error_of_grid(of_coarser)
            }
            Displayed::Previous | Displayed::Final => {
                tr("The previous shape is still shown.").to_owned()
            }
        };
        return quiet(tr("Updating…"), details);
    };
    let error = outcome.solver.estimated_position_error;
    let percent = |error: f64| percent_text(100.0 * error);
    match outcome.status {
        Status::Converged => {
            let error = error.map_or_else(
                || tr("below the tolerance").to_owned(),
                |error| tr!("at most {error} of the base radius", error = percent(error)),
            );
            let of_grid = error_of_grid(Some(outcome));
            let details = tr!(
                "Converged: the position error on this grid is {error}.{of_grid}",
                error,
                of_grid
            );
            quiet(tr("Up to date"), details)
        }
        Status::NotConverged => {
            let error = match error {
                Some(error) if error < 10.0 => {
                    tr!(
                        "the estimated position error is {error} of the base radius",
                        error = percent(error)
                    )
                }
                _ => tr("there is no error estimate").to_owned(),
            };
            let text = tr("Not finished: do not use these numbers");
            warning(text, tr!("The solver stopped above its tolerance; {error}.", error))
        }
        Status::Unstable => warning(tr("No answer"), tr(no_shape(session.invalid())).to_owned()),
    }
}

/// What a finer grid would change, in a sentence; empty where it is not known.
fn error_of_grid(outcome: Option<&Outcome>) -> String {
    let error = outcome.and_then(|outcome| outcome.solver.estimated_discretisation_error);
    error.map_or_else(String::new, |error| {
        tr!(
            " A finer grid would move the skin by about {distance}.",
            distance = percent_text(100.0 * error)
        )
    })
}

/// Formats an error with one significant digit, rounded up.
fn percent_text(percent: f64) -> String {
    if percent <= 1e-4 {
        return localized("0.0001 %");
    }
    let unit = 10f64.powf(percent.log10().floor());
    let rounded = (percent / unit).ceil() * unit;
    let decimals = (-rounded.log10().floor()).max(0.0) as usize;
    format!("{} %", fixed(rounded, decimals))
}

/// Shows the status line. `sampling`: numbers of computed and of all plans of sampled patients, while they are computed; `pending`: what
/// else is.
pub(crate) fn show(
    ui: &mut Ui,
    session: &Session,
    timing: &Timing,
    (sampling, pending): (Option<(usize, usize)>, Option<Pending>),
) {
    let StatusText { text, mut details, is_warning } = status_text(session);
    let mut text = text.to_owned();
    let is_converged = session.result().is_some_and(|it| it.status == Status::Converged);
    if let Some(pending) = pending.filter(|_| is_converged) {
        pending.words().clone_into(&mut text);
    }
    if let Some((done, all)) = sampling.filter(|_| is_converged) {
        text = tr!("Computing patients: {done} of {all} plans", done, all);
    }
    if let Some(outcome) = session.result() {
        let solver = &outcome.solver;
        details += &tr!(
            "\nSolve: {time:.0} ms, {work:.0} work units (evaluations of all nodal forces), {nodes} nodes. Frame: {frame:.1} ms.",
            time = timing.solve_ms,
            work = solver.work_units,
            nodes = solver.nodes_solved,
            frame = timing.percentile(0.5)
        );
    }
    let text = if is_warning {
        RichText::new(format!("! {text}")).strong().color(theme::palette(ui.visuals()).bad)
    } else {
        RichText::new(text).color(ui.visuals().weak_text_color())
    };
    ui.label(text).on_hover_text(details);
}

/// The model and the accuracy of a scene in a few words; without `is_research` what differs from the usual ones.
pub(crate) fn model(scene: &Scene, is_research: bool) -> String {
    let law = match (scene.springs, scene.is_layered()) {
        (Springs::Nikolaev, _) => tr("model of 2013"),
        (Springs::Coupled, true) => tr("standard model"),
        (Springs::Coupled, false) => tr("one sheet"),
    };
    let name = advanced::accuracy_name(scene);
    let accuracy = name.map_or_else(
        || tr!("{nodes} nodes per side", nodes = scene.solver.nodes_per_side),
        |name| tr!("{accuracy} accuracy", accuracy = name.to_lowercase()),
    );
    let is_usual = [
        scene.springs == Springs::Coupled && scene.is_layered(),
        advanced::has_usual_accuracy(scene),
    ];
    let words = [law.to_owned(), accuracy].into_iter().zip(is_usual);
    let words = words.filter(|(_, is_usual)| is_research || !is_usual).map(|(words, _)| words);
    words.collect::<Vec<_>>().join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_is_rounded_up_to_one_digit() {
        assert_eq!(percent_text(0.0), "0.0001 %");
        assert_eq!(percent_text(0.0031), "0.004 %");
        assert_eq!(percent_text(0.02), "0.02 %");
        assert_eq!(percent_text(0.97), "1 %");
        assert_eq!(percent_text(34.0), "40 %");
    }

    #[test]
    fn the_longest_slice_is_not_that_of_the_opening_scene() {
        let mut timing = Timing::default();
        for (ms, scene) in [
            (300.0, SliceOf::OpeningScene),
            (12.0, SliceOf::EditedScene),
            (9.0, SliceOf::EditedScene),
        ] {
            timing.add_slice(ms, scene);
        }
        assert_eq!((timing.slice_max, timing.solve_ms), (12.0, 321.0));
    }

    #[test]
    fn percentiles_are_of_the_frames_kept() {
        let mut timing = Timing::default();
        (1..=100).for_each(|k| timing.add_frame(f64::from(k)));
        assert!((timing.percentile(0.95) - 95.0).abs() <= 1.0);
        assert_eq!(timing.frame_count, 100);
    }
}

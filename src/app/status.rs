//! The status line: is the picture true, what did it cost.

use super::theme::{self, SPACE};
use crate::measure::Status;
use crate::session::Session;
use crate::solve::Shown;
use crate::springs::Springs;
use eframe::egui::{self, Color32, RichText, Ui};
use std::collections::VecDeque;

/// Times of the frames and solves so far \[ms\].
#[derive(Clone, Debug, Default)]
pub(super) struct Timing {
    /// Times spent in the app's own frames.
    frames: Recent,
    /// Times in the solver in the frames that solved.
    pub(super) slices: Recent,
    /// Greatest time in the solver of a frame, after the opening scene \[ms\].
    pub(super) slice_max: f64,
    /// Frames drawn since the start.
    pub(super) frame_count: u64,
    /// Time spent in the solver for the present scene.
    pub(super) solve_ms: f64,
}

/// The newest times \[ms\], at most [`TIMES_KEPT`].
#[derive(Clone, Debug, Default)]
pub(super) struct Recent(VecDeque<f64>);

const TIMES_KEPT: usize = 240;

impl Recent {
    pub(super) fn add(&mut self, ms: f64) {
        if self.0.len() == TIMES_KEPT {
            self.0.pop_front();
        }
        self.0.push_back(ms);
    }

    /// The time that a share of them stays below.
    pub(super) fn percentile(&self, share: f64) -> f64 {
        let mut sorted: Vec<f64> = self.0.iter().copied().collect();
        sorted.sort_by(f64::total_cmp);
        let place = (share * sorted.len().saturating_sub(1) as f64).round() as usize;
        sorted.get(place).copied().unwrap_or(0.0)
    }
}

impl Timing {
    pub(super) fn add_frame(&mut self, ms: f64) {
        self.frame_count += 1;
        self.frames.add(ms);
    }

    /// A slice of solving; the opening scene may take long ones.
    pub(super) fn add_slice(&mut self, ms: f64, is_opening: bool) {
        self.solve_ms += ms;
        if !is_opening {
            self.slice_max = self.slice_max.max(ms);
        }
        self.slices.add(ms);
    }

    /// The frame time that a share of the frames stays below \[ms\].
    pub(super) fn percentile(&self, share: f64) -> f64 {
        self.frames.percentile(share)
    }
}

/// State of the picture in words and as a colour.
pub(super) fn state(ui: &Ui, session: &Session) -> (String, Color32) {
    let palette = theme::palette(ui.visuals());
    if session.is_working() {
        let text = match session.solver().shown() {
            Shown::Draft if session.scene().springs == Springs::Nikolaev => {
                "Following: whether this shape is stable is still to be seen".to_owned()
            }
            Shown::Draft => "Following: within 0.1 % of the base radius".to_owned(),
            Shown::Coarse { nodes_per_side } => format!(
                "Following on a coarse grid: {nodes_per_side} of {} nodes a side",
                session.solver().problem().sheet.nodes_per_side()
            ),
            Shown::Before | Shown::Latest => "Solving…".to_owned(),
        };
        return (text, palette.caution);
    }
    match session.outcome() {
        None => ("Solving…".to_owned(), palette.caution),
        Some(outcome) => match outcome.status {
            Status::Converged => {
                let error = outcome.solver.estimated_position_error.map_or_else(
                    || "the tolerance".to_owned(),
                    |error| percent_text(100.0 * error),
                );
                (format!("Converged: within {error} of this grid's equilibrium"), palette.good)
            }
            Status::NotConverged => {
                let error = match outcome.solver.estimated_position_error {
                    Some(error) if error < 10.0 => {
                        format!("estimated position error {}", percent_text(100.0 * error))
                    }
                    _ => "no error estimate".to_owned(),
                };
                (format!("Not converged: {error}"), palette.bad)
            }
            Status::Unstable => ("No stable shape".to_owned(), palette.bad),
        },
    }
}

/// One significant digit, rounded up: an error is not promised better than it is.
fn percent_text(percent: f64) -> String {
    if percent <= 1e-4 {
        return "0.0001 %".to_owned();
    }
    let unit = 10f64.powf(percent.log10().floor());
    let rounded = (percent / unit).ceil() * unit;
    let decimals = (-rounded.log10().floor()).max(0.0) as usize;
    format!("{rounded:.decimals$} %")
}

/// The line itself.
pub(super) fn show(ui: &mut Ui, session: &Session, timing: &Timing) {
    let (text, color) = state(ui, session);
    let caution = theme::palette(ui.visuals()).caution;
    ui.horizontal_wrapped(|ui| {
        let (dot, _) = ui.allocate_exact_size(egui::vec2(10.0, 10.0), egui::Sense::hover());
        ui.painter().circle_filled(dot.center(), 4.0, color);
        ui.label(RichText::new(text).color(color));
        if let Some(outcome) = session.outcome()
            && !session.is_working()
        {
            ui.add_space(SPACE);
            let solver = &outcome.solver;
            let figures = format!(
                "solve {:.0} ms · {:.0} work units · {} nodes · frame {:.1} ms",
                timing.solve_ms,
                solver.work_units,
                solver.nodes_solved,
                timing.percentile(0.5),
            );
            ui.label(RichText::new(figures).small().weak()).on_hover_text(
                "Time in the solver for this scene, in evaluations of all nodal forces, and the \
                 middle time of a frame",
            );
            for warning in &outcome.warnings {
                ui.add(egui::Label::new(RichText::new(warning).small().color(caution)).wrap());
            }
        }
    });
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
        for (ms, is_opening) in [(300.0, true), (12.0, false), (9.0, false)] {
            timing.add_slice(ms, is_opening);
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

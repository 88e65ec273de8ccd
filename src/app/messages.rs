//! Messages over or in place of the picture: notices, progress of a long solve, the pages "Stopped" and
//! "No stable shape".

use super::widgets::set_accessible_name;
use super::{App, theme};
use crate::scene::{Scene, Springs};
use eframe::egui::{self, RichText, Ui};

/// Severity of a notice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Severity {
    Info,
    Caution,
    Error,
}

/// An alternative scene that a notice offers.
#[derive(Clone, Debug)]
pub(super) struct Offer {
    pub(super) label: String,
    pub(super) scene: Box<Scene>,
}

/// A line of text to the user.
#[derive(Clone, Debug)]
pub(super) struct Notice {
    pub(super) text: String,
    pub(super) severity: Severity,
    pub(super) offer: Option<Offer>,
}

/// The user's action on a notice.
pub(super) enum NoticeAction {
    Close,
    Accept(Box<Scene>),
}

impl Notice {
    pub(super) fn info(text: impl Into<String>) -> Self {
        Self { text: text.into(), severity: Severity::Info, offer: None }
    }

    pub(super) fn caution(text: impl Into<String>) -> Self {
        Self { severity: Severity::Caution, ..Self::info(text) }
    }

    pub(super) fn error(text: impl Into<String>) -> Self {
        Self { severity: Severity::Error, ..Self::info(text) }
    }

    fn show(&self, ui: &mut Ui) -> Option<NoticeAction> {
        let palette = theme::palette(ui.visuals());
        // A word besides the colour: some users do not see the colour.
        let (color, word) = match self.severity {
            Severity::Info => (palette.text, ""),
            Severity::Caution => (palette.caution, "Note: "),
            Severity::Error => (palette.bad, "Error: "),
        };
        let mut action = None;
        strip("notice", ui).show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                let close = ui.button("×");
                set_accessible_name(&close, egui::Role::Button, "Close message");
                if close.clicked() {
                    action = Some(NoticeAction::Close);
                }
                let text = RichText::new(format!("{word}{}", self.text)).color(color);
                ui.add(egui::Label::new(text).wrap());
                if let Some(offer) = &self.offer
                    && ui.button(&offer.label).clicked()
                {
                    action = Some(NoticeAction::Accept(offer.scene.clone()));
                }
            });
        });
        action
    }
}

impl App {
    /// Shows the last notice until the user closes it.
    pub(super) fn show_notice(&mut self, ui: &mut Ui) {
        if self.shots.is_for_report() {
            return;
        }
        match self.notice.as_ref().and_then(|notice| notice.show(ui)) {
            None => {}
            Some(NoticeAction::Close) => self.notice = None,
            Some(NoticeAction::Accept(scene)) => self.accept(scene),
        }
    }

    /// Shows the progress of a long solve with a button to cancel.
    pub(super) fn progress_bar(&mut self, ui: &mut Ui) {
        let Some(running) = self.solving else { return };
        let mut is_cancelled = false;
        strip("progress", ui).show(ui, |ui| {
            ui.horizontal(|ui| {
                is_cancelled = ui.button("Cancel").clicked();
                let seconds = running.start.elapsed().as_secs();
                let bar = egui::ProgressBar::new(running.fraction as f32)
                    .desired_width((ui.available_width() - 270.0).clamp(40.0, 320.0))
                    .fill(theme::palette(ui.visuals()).accent)
                    .animate(true);
                let bar = ui.add(bar);
                let role = egui::Role::ProgressIndicator;
                set_accessible_name(&bar, role, "Progress of the solve");
                ui.label(format!("Computing for {seconds} s; the picture is provisional"));
            });
        });
        if is_cancelled || ui.input(|input| input.key_pressed(egui::Key::Escape)) {
            self.cancel();
        }
    }

    /// Shows that the solve was cancelled, with a button to continue.
    pub(super) fn stopped_page(&mut self, ui: &mut Ui) {
        message_page(ui, "Stopped", |ui| {
            ui.label("This plan has not been computed, so there are no results.");
            ui.add_space(theme::SPACE);
            if ui.button("Continue computing").clicked() {
                self.session.resume();
            }
        });
    }
}

/// Shows the reason why the scene has no shape, and a remedy: the standard model in place of the paper's springs, and what
/// `offer` adds.
pub(super) fn no_shape_page(
    ui: &mut Ui,
    words: &str,
    scene: &mut Scene,
    offer: impl FnOnce(&mut Ui),
) {
    message_page(ui, "No answer for this plan", |ui| {
        ui.label(words);
        ui.add_space(theme::SPACE);
        offer(ui);
        if scene.springs != Springs::Nikolaev {
            return;
        }
        ui.small(
            "At these strains and this Poisson ratio the springs of Nikolaev 2013 are unstable: their \
             energy has no minimum, so no shape can be computed.",
        );
        ui.add_space(theme::SPACE);
        if ui.button("Use the standard model").clicked() {
            scene.springs = Springs::Coupled;
        }
    });
}

/// A panel of one line above the picture.
fn strip(name: &'static str, ui: &Ui) -> egui::Panel {
    let frame = egui::Frame::new().inner_margin(theme::SPACE).fill(ui.visuals().panel_fill);
    egui::Panel::top(name).frame(frame).resizable(false)
}

/// A page with a heading in place of the picture.
fn message_page(ui: &mut Ui, heading: &str, add: impl FnOnce(&mut Ui)) {
    let frame = egui::Frame::new().inner_margin(2.0 * theme::SPACE).fill(ui.visuals().panel_fill);
    egui::CentralPanel::default().frame(frame).show(ui, |ui| {
        ui.vertical_centered(|ui| {
            ui.add_space(0.3 * ui.available_height());
            ui.heading(heading);
            add(ui);
        });
    });
}

//! A line to the user over the picture: what was done, what does not fit, what failed, and a way on.

use super::theme;
use super::widgets::set_accessible_name;
use crate::scene::Scene;
use eframe::egui::{self, RichText, Ui};

/// How much a line matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Severity {
    Info,
    Caution,
    Error,
}

/// A scene that the user may want instead.
#[derive(Clone, Debug)]
pub(super) struct Offer {
    pub(super) label: String,
    pub(super) scene: Box<Scene>,
}

/// A line to the user.
#[derive(Clone, Debug)]
pub(super) struct Notice {
    pub(super) text: String,
    pub(super) severity: Severity,
    pub(super) offer: Option<Offer>,
}

/// What the user did with a line.
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

    pub(super) fn show(&self, ui: &mut Ui) -> Option<NoticeAction> {
        let palette = theme::palette(ui.visuals());
        // Never by colour alone.
        let (color, word) = match self.severity {
            Severity::Info => (palette.text, ""),
            Severity::Caution => (palette.caution, "Note: "),
            Severity::Error => (palette.bad, "Not done: "),
        };
        let mut action = None;
        let frame = egui::Frame::new().inner_margin(theme::SPACE).fill(ui.visuals().panel_fill);
        egui::Panel::top("notice").frame(frame).resizable(false).show(ui, |ui| {
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

//! A line to the user over the picture: what was done, what does not fit, what failed, and a way on.

use super::theme;
use super::widgets::name_it;
use crate::scene::Scene;
use eframe::egui::{self, RichText, Ui};

/// How much a line matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Weight {
    Done,
    Caution,
    Failed,
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
    pub(super) weight: Weight,
    pub(super) offer: Option<Offer>,
}

/// What the user did with a line.
pub(super) enum Reply {
    Close,
    Accept(Box<Scene>),
}

impl Notice {
    pub(super) fn done(text: impl Into<String>) -> Self {
        Self { text: text.into(), weight: Weight::Done, offer: None }
    }

    pub(super) fn caution(text: impl Into<String>) -> Self {
        Self { weight: Weight::Caution, ..Self::done(text) }
    }

    pub(super) fn failed(text: impl Into<String>) -> Self {
        Self { weight: Weight::Failed, ..Self::done(text) }
    }

    pub(super) fn show(&self, ui: &mut Ui) -> Option<Reply> {
        let palette = theme::palette(ui.visuals());
        // Never by colour alone.
        let (color, word) = match self.weight {
            Weight::Done => (palette.text, ""),
            Weight::Caution => (palette.caution, "Note: "),
            Weight::Failed => (palette.bad, "Not done: "),
        };
        let mut reply = None;
        let frame = egui::Frame::new().inner_margin(theme::SPACE).fill(ui.visuals().panel_fill);
        egui::Panel::top("notice").frame(frame).resizable(false).show(ui, |ui| {
            ui.horizontal_wrapped(|ui| {
                let close = ui.button("×");
                name_it(&close, egui::Role::Button, "Close message");
                if close.clicked() {
                    reply = Some(Reply::Close);
                }
                let text = RichText::new(format!("{word}{}", self.text)).color(color);
                ui.add(egui::Label::new(text).wrap());
                if let Some(offer) = &self.offer
                    && ui.button(&offer.label).clicked()
                {
                    reply = Some(Reply::Accept(offer.scene.clone()));
                }
            });
        });
        reply
    }
}

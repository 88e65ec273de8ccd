//! The side of the breast.

use super::{Hand, chip, chips, named};
use crate::app::texts::tr;
use crate::scene::Side;
use eframe::egui::Ui;

/// The choice of the side in a row. No side is chosen at first; the pictures are then those of a left breast.
pub(in crate::app) fn side(ui: &mut Ui, side: &mut Option<Side>, hand: Hand) {
    named(ui, tr("Breast"), |ui| {
        chips(ui, |ui| {
            for choice in Side::ALL {
                let tooltip = tr("The pictures are those of a left breast until right is chosen");
                if chip(ui, hand, *side == Some(choice), tr(choice.word()), tooltip) {
                    *side = Some(choice);
                }
            }
        });
    });
}

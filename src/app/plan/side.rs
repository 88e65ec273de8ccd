//! The side of the breast.

use super::{Hand, chip, chips};
use crate::app::texts::tr;
use crate::app::widgets::theme::SPACE;
use crate::scene::Side;
use eframe::egui::{RichText, Ui};

/// Its name says that there is one plan.
const BOTH: &str = "both alike";

/// The choice of the side in a row; a side that is fixed by the scan of a body stands alone. No side is chosen at first; the pictures are then those of a left breast.
pub(crate) fn side(ui: &mut Ui, side: &mut Option<Side>, is_fixed: bool, hand: Hand) {
    chips(ui, |ui| {
        ui.label(RichText::new(tr("Breast")).color(ui.visuals().weak_text_color()));
        ui.add_space(SPACE);
        let now = *side;
        for choice in Side::ALL.into_iter().filter(|choice| !is_fixed || now == Some(*choice)) {
            let (name, tooltip) = match choice {
                Side::Both => {
                    (BOTH, "One plan for both breasts; breasts that differ need a plan each")
                }
                one => {
                    (one.word(), "The pictures are those of a left breast until right is chosen")
                }
            };
            if chip(ui, hand, *side == Some(choice), tr(name), tr(tooltip)) {
                *side = Some(choice);
            }
        }
    });
}

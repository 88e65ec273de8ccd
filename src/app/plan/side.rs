//! The side of the breast, and whether each side has a plan of its own.

use super::{Hand, chip, chip_button, chips};
use crate::app::texts::{shown, tr};
use crate::app::widgets::drop_typed_number;
use crate::app::widgets::theme::SPACE;
use crate::scene::{Scene, Side};
use eframe::egui::{RichText, Ui};

/// One plan for both breasts, and one for each: states of one chip.
const BOTH: (&str, &str) =
    ("both alike", "One plan for both breasts; pressed again, each breast has a plan of its own");
pub(super) const OWN: (&str, &str) = (
    "each own",
    "A plan for each breast: implant, pocket, pinch and base are those of the chosen side, all else is that of both",
);

/// The choice of the side in a row; a side that is fixed stands alone. No side is chosen at first; the pictures are then those of a left breast.
pub(crate) fn side(ui: &mut Ui, side: &mut Option<Side>, is_fixed: bool, hand: Hand) {
    let now = *side;
    chips(ui, |ui| {
        let offered = Side::ALL.into_iter().filter(|choice| !is_fixed || now == Some(*choice));
        *side = choices(ui, now, offered, hand);
    });
}

/// The choice of the side whose plan is shown and edited, in a row; both sides have one plan or, after a second press, one each. Returns why they have not.
pub(crate) fn sides(ui: &mut Ui, scene: &mut Scene, hand: Hand) -> Option<String> {
    let (now, is_own) = (scene.side, scene.other_side.is_some());
    // Without a plan of its own the other side of a scan has none.
    let is_scanned = scene.placement.is_some();
    let is_offered =
        |side: &Side| *side != Side::Both && (is_own || !is_scanned || now == Some(*side));
    let mut refused = None;
    chips(ui, |ui| {
        let chosen = choices(ui, now, Side::ALL.into_iter().filter(is_offered), hand);
        if chosen != now {
            scene.set_side(chosen);
            drop_typed_number(ui.ctx());
        }
        let is_both = is_own || now == Some(Side::Both);
        let (name, about) = if is_own || is_scanned { OWN } else { BOTH };
        if !chip_button(ui, hand, is_both, tr(name), tr(about)) {
            return;
        }
        if is_own {
            let one = if is_scanned { now } else { Some(Side::Both) };
            (scene.side, scene.other_side) = (one, None);
        } else if is_both || is_scanned {
            refused = scene.add_other_side().err().map(|error| shown(&error.to_string()));
        } else {
            scene.side = Some(Side::Both);
        }
    });
    refused
}

/// The chips of the sides behind their name. Returns the chosen one.
fn choices(
    ui: &mut Ui,
    now: Option<Side>,
    offered: impl Iterator<Item = Side>,
    hand: Hand,
) -> Option<Side> {
    ui.label(RichText::new(tr("Breast")).color(ui.visuals().weak_text_color()));
    ui.add_space(SPACE);
    let mut chosen = now;
    for choice in offered {
        let (name, tooltip) = match choice {
            Side::Both => BOTH,
            one => (one.word(), "The pictures are those of a left breast until right is chosen"),
        };
        if chip(ui, hand, now == Some(choice), tr(name), tr(tooltip)) {
            chosen = Some(choice);
        }
    }
    chosen
}

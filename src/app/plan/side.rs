//! The side of the breast, and whether each side has a plan of its own.

use super::{Hand, chip, chip_button, chips};
use crate::app::frame::messages::Notice;
use crate::app::texts::{shown, tr};
use crate::app::widgets::drop_typed_number;
use crate::app::widgets::theme::SPACE;
use crate::scene::{Scene, Side};
use eframe::egui::{Id, RichText, Ui};

/// One plan for both breasts, and one for each, which is offered once both have one.
const BOTH: (&str, &str) = ("both alike", "One plan for both breasts");
pub(super) const OWN: (&str, &str) = (
    "each own",
    "A plan for each breast: implant, pocket, pinch and base are those of the chosen side, all else is that of both",
);

/// The choice of the side in a row, or what is `fixed`. No side is chosen at first; the pictures are then those of a left breast.
pub(crate) fn side(ui: &mut Ui, side: &mut Option<Side>, fixed: Option<&str>, hand: Hand) {
    chips(ui, |ui| match fixed {
        Some(words) => {
            name(ui);
            ui.label(words);
        }
        None => *side = choices(ui, *side, Side::ALL.into_iter(), hand),
    });
}

/// The choice of the side whose plan is shown and edited, and of one plan for both sides or one each, in a row. Returns why they have not,
/// or that a plan went.
pub(crate) fn sides(ui: &mut Ui, scene: &mut Scene, hand: Hand) -> Option<Notice> {
    let (now, is_own) = (scene.side, scene.other_side.is_some());
    // Without a plan of its own the other side of a scan has none.
    let is_scanned = scene.placement.is_some();
    let is_offered =
        |side: &Side| *side != Side::Both && (is_own || !is_scanned || now == Some(*side));
    let mut notice = None;
    chips(ui, |ui| {
        let chosen = choices(ui, now, Side::ALL.into_iter().filter(is_offered), hand);
        // In the frame of the click a number that is typed becomes one of the side before.
        let waiting = Id::unique("side to show");
        if let Some(chosen) = ui.data_mut(|data| data.remove_temp::<Option<Side>>(waiting)) {
            scene.set_side(chosen);
            drop_typed_number(ui.ctx());
        } else if chosen != now {
            ui.data_mut(|data| data.insert_temp(waiting, chosen));
            ui.ctx().request_repaint();
        }
        let is_both = now == Some(Side::Both) && !is_own;
        if !is_scanned && chip(ui, hand, is_both, tr(BOTH.0), tr(BOTH.1)) {
            (scene.side, scene.other_side) = (Some(Side::Both), None);
        }
        if !(is_both || is_own || is_scanned)
            || !chip_button(ui, hand, is_own, tr(OWN.0), tr(OWN.1))
        {
            return;
        }
        if !is_own {
            let refused = scene.add_other_side().err();
            notice = refused.map(|error| Notice::error(shown(&error.to_string())));
        } else if is_scanned {
            scene.other_side = None;
        }
    });
    if is_own && scene.other_side.is_none() {
        notice = Some(Notice::info(tr("The other side's plan was removed; Undo brings it back.")));
    }
    notice
}

/// The chips of the sides behind their name. Returns the chosen one.
fn choices(
    ui: &mut Ui,
    now: Option<Side>,
    offered: impl Iterator<Item = Side>,
    hand: Hand,
) -> Option<Side> {
    name(ui);
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

fn name(ui: &mut Ui) {
    ui.label(RichText::new(tr("Breast")).color(ui.visuals().weak_text_color()));
    ui.add_space(SPACE);
}

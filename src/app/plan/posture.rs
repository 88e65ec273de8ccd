//! The posture: in which direction weight acts.

use crate::app::plan::{Hand, chip, chips};
use crate::app::texts::tr;
use crate::app::widgets::group;
use crate::scene::{Posture, Scene};
use eframe::egui::Ui;

/// A posture: its word in a form, its name and what it means.
pub(super) const POSTURES: [(Posture, &str, &str, &str); 3] = [
    (
        Posture::None,
        "none",
        "As measured",
        "Standing: the tissue hangs as it was measured. The weight of the implant is left out.",
    ),
    (
        Posture::Standing,
        "standing",
        "Standing",
        "The tissue hangs as it was measured. The implant sags by its own weight, unless it is rigid.",
    ),
    (
        Posture::Lying,
        "lying",
        "Lying",
        "On the back: the tissue, measured standing, moves towards the head and bears on the implant. The picture stays upright.",
    ),
];

/// The posture in words.
pub(crate) fn posture_in_words(scene: &Scene) -> String {
    let present = scene.body.posture;
    let own = POSTURES.into_iter().find(|(posture, ..)| *posture == present);
    own.map_or_else(String::new, |(.., name, _)| tr(name).to_lowercase())
}

/// Shows the choice; nothing for a sheet.
pub(super) fn show(ui: &mut Ui, scene: &mut Scene, hand: Hand) {
    if !scene.is_layered() {
        return;
    }
    group(ui, tr("Posture"), |ui| {
        chips(ui, |ui| {
            for (posture, _, name, about) in POSTURES {
                if chip(ui, hand, scene.body.posture == posture, tr(name), tr(about)) {
                    scene.body.posture = posture;
                }
            }
        });
    });
}

//! The pocket: its margin around the implant, and its plane.

use super::{Hand, chip, chips, cm, mm, row, title};
use crate::app::texts::tr;
use crate::app::widgets::{Control, group, quantity};
use crate::scene::{Field, Plane, Scene, limits};
use eframe::egui::{RichText, Ui};

/// A plane: its name on a chip and what it means.
const PLANES: [(Option<Plane>, &str, &str); 5] = [
    (None, "Above", "Above the muscle: skin, fat and gland cover the implant."),
    (
        Some(Plane::DualPlaneI),
        "Dual I",
        "Dual plane I: the muscle covers the implant down to the fold.",
    ),
    (
        Some(Plane::DualPlaneIi),
        "II",
        "Dual plane II: the muscle covers the implant down to the lower edge of the areola.",
    ),
    (
        Some(Plane::DualPlaneIii),
        "III",
        "Dual plane III: the muscle covers the implant down to the upper edge of the areola.",
    ),
    (
        Some(Plane::Below),
        "Below",
        "Below the muscle, 8 mm of 5 kPa at rest: an estimate (6–12 mm, 3–30 kPa). It does not contract here.",
    ),
];

/// The plane in words, of a plan below the muscle.
pub(super) fn plane_in_words(scene: &Scene) -> Option<&'static str> {
    scene.body.plane.map(|plane| tr(plane.words()))
}

/// Shows the margin of the pocket.
pub(crate) fn pocket(ui: &mut Ui, scene: &mut Scene, hand: Hand) {
    let width = quantity::format_at_most(cm(2.0 * scene.pocket_radius_mm), 1, 1);
    title(ui, tr("Pocket"), |ui| {
        let words = tr!("{width} cm wide", width);
        ui.label(RichText::new(words).small().color(ui.visuals().weak_text_color()));
    });
    let (control, mut margin) = margin(scene);
    if row(ui, hand, control, &mut margin, (0.0, |_: &mut Ui| {})).is_changed {
        set_margin(scene, margin);
    }
}

/// Shows the plane of the pocket; nothing for a sheet.
pub(crate) fn plane(ui: &mut Ui, scene: &mut Scene, hand: Hand) {
    if !scene.is_layered() {
        return;
    }
    group(ui, tr("Plane of the pocket"), |ui| {
        chips(ui, |ui| {
            for (plane, name, about) in PLANES {
                if chip(ui, hand, scene.body.plane == plane, tr(name), tr(about)) {
                    scene.set_plane(plane);
                }
            }
        });
    });
}

/// The control of the margin, and the margin \[cm\].
pub(super) fn margin(scene: &Scene) -> (Control<'static>, f64) {
    let radius = scene.implant.greatest_half_axis_mm();
    let [x, y] = scene.implant.center_mm;
    // A displayed limit is itself allowed.
    let least = cm((10.0 * x.hypot(y) - 1e-6).ceil() / 10.0);
    let most = cm(limits::POCKET_RADIUS_MAX_MM - radius);
    let margin = cm(scene.pocket_radius_mm - radius);
    let control = Control {
        range: 0.0..=4.0_f64.max(least),
        allowed: Some(least.min(margin)..=most),
        limit_reason: tr!(
            "{least} to {most} cm at this position",
            least = quantity::format(least, 1),
            most = quantity::format(most, 1)
        ),
        reset: 1.0_f64.max(least),
        tooltip: tr(
            "How much wider than the implant the pocket is, all round. Outside of the pocket the tissue \
                  stays attached to the chest wall.",
        ),
        label: tr("Margin"),
        ..Control::of(Field::PocketRadius)
    };
    (control, margin)
}

/// Sets the margin \[cm\].
pub(super) fn set_margin(scene: &mut Scene, margin: f64) {
    let radius = scene.implant.greatest_half_axis_mm();
    scene.set_pocket_radius(quantity::significant(radius + mm(margin)));
}

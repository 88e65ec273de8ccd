//! The pocket: its margin around the implant, its plane, how much lower the new fold is, and the fluid beside the implant.

use super::device::Device;
use super::{Hand, chip, chips, cm, mm, plain, row, title};
use crate::app::texts::{fixed, tr};
use crate::app::widgets::{Control, group, quantity};
use crate::scene::{Field, Plane, Scene, limits};
use eframe::egui::{RichText, Ui};

/// A plane: its word in a form, its name on a chip and what it means.
pub(super) const PLANES: [(Option<Plane>, &str, &str, &str); 5] = [
    (None, "above", "Above", "Above the muscle: skin, fat and gland cover the implant."),
    (
        Some(Plane::DualPlaneI),
        "dual_1",
        "Dual I",
        "Dual plane I: the muscle covers the implant down to the fold.",
    ),
    (
        Some(Plane::DualPlaneIi),
        "dual_2",
        "II",
        "Dual plane II: the muscle covers the implant down to the lower edge of the areola.",
    ),
    (
        Some(Plane::DualPlaneIii),
        "dual_3",
        "III",
        "Dual plane III: the muscle covers the implant down to the upper edge of the areola.",
    ),
    (
        Some(Plane::Below),
        "below",
        "Below",
        "Below the muscle, 8 mm of 5 kPa at rest: an estimate (6–12 mm, 3–30 kPa). It does not contract here.",
    ),
];

/// A plane in words, in English.
pub(super) fn words_of(plane: Option<Plane>) -> &'static str {
    plane.map_or("above the muscle", Plane::words)
}

/// The plane in words.
pub(crate) fn plane_in_words(scene: &Scene) -> String {
    tr(words_of(scene.body.plane)).to_owned()
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

/// Shows the plane of the pocket, and how much lower the new fold is; nothing for a sheet.
pub(crate) fn plane(ui: &mut Ui, scene: &mut Scene, hand: Hand) {
    if !scene.is_layered() {
        return;
    }
    group(ui, tr("Plane of the pocket"), |ui| {
        chips(ui, |ui| {
            for (plane, _, name, about) in PLANES {
                if chip(ui, hand, scene.body.plane == plane, tr(name), tr(about)) {
                    scene.set_plane(plane);
                }
            }
        });
        let lowered = plain::control(scene, Field::PocketLowered, Device::of(ui.ctx()));
        if let Some((control, mut lower)) = lowered
            && row(ui, hand, control, &mut lower, (0.0, |_: &mut Ui| {})).is_changed
        {
            plain::set(scene, Field::PocketLowered, lower);
        }
    });
}

/// The fluid beside the implant: the word of a choice, its name on a chip and what it means.
pub(super) const FLUIDS: [(&str, &str, &str); 2] = [
    (
        "free",
        "Not limited",
        "The tissue bridges the ring between the implant's rim and the pocket's edge; the void stands in the details.",
    ),
    (
        "limited",
        "Limited",
        "The ring holds so much fluid at most: a few ml on the table, later none. The tissue is drawn into it, which raises force and \
         pressure; the computation takes several times as long.",
    ),
];

/// Greatest void of a plan that limits it \[ml\]: what fluid is left after days.
const FLUID_ML: f64 = 10.0;

/// Is the void of the pocket limited?
pub(super) fn is_limited(scene: &Scene) -> bool {
    scene.body.pocket_void_ml.is_some()
}

/// The word of the present choice.
pub(super) fn fluid_choice(scene: &Scene) -> &'static str {
    FLUIDS[usize::from(is_limited(scene))].0
}

/// Limits the void of the pocket or frees it; a limit stays.
pub(super) fn limit_fluid(scene: &mut Scene, is_limited: bool) {
    let present = scene.body.pocket_void_ml;
    scene.body.pocket_void_ml = is_limited.then(|| present.unwrap_or(FLUID_ML));
}

/// The fluid beside the implant in words.
pub(crate) fn fluid_in_words(scene: &Scene) -> String {
    match scene.body.pocket_void_ml {
        Some(volume) => tr!("{volume} ml at most", volume = fixed(volume, 0)),
        None => tr("not limited").to_owned(),
    }
}

/// The control of the greatest void and the void \[ml\]; `None` of a plan that does not limit it.
pub(super) fn fluid_control(scene: &Scene) -> Option<(Control<'static>, f64)> {
    let control = Control { reset: FLUID_ML, ..Control::of(Field::PocketVoid) };
    // A pocket of this model has some 20 to 80 ml beside the implant.
    Some((control.with_rail(0.0..=50.0), scene.body.pocket_void_ml?))
}

/// Shows whether the void of the pocket is limited, and by how much; nothing for a sheet.
pub(crate) fn fluid(ui: &mut Ui, scene: &mut Scene, hand: Hand) {
    if !scene.is_layered() {
        return;
    }
    let device = Device::of(ui.ctx());
    group(ui, tr("Fluid in the pocket"), |ui| {
        chips(ui, |ui| {
            for (k, (_, name, about)) in FLUIDS.into_iter().enumerate() {
                let about = device.words(tr(about));
                if chip(ui, hand, is_limited(scene) == (k == 1), tr(name), &about) {
                    limit_fluid(scene, k == 1);
                }
            }
        });
        if let Some((control, mut volume)) = fluid_control(scene)
            && row(ui, hand, control, &mut volume, (0.0, |_: &mut Ui| {})).is_changed
        {
            Field::PocketVoid.set(scene, 0, volume);
        }
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

//! The pocket as a margin around the implant.

use super::{Hand, cm, mm, row, title};
use crate::app::texts::tr;
use crate::app::widgets::{Control, quantity};
use crate::scene::{Field, Scene, limits};
use eframe::egui::{RichText, Ui};

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

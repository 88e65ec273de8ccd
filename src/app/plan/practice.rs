//! The volume that practice takes, and what corrects it beside the pull: how much of the envelope the breast fills, and the
//! nipple–fold distance. The base of the breast is among the measurements of the patient.

use super::{Hand, chip, chips, cm, mm, patient, row};
use crate::app::answer::practice::{Practices, rule_in_short};
use crate::app::texts::tr;
use crate::app::widgets::quantity::Kind;
use crate::app::widgets::{Control, remark};
use crate::clinical::{EnvelopeFill, Measurements, limits};
use crate::scene::Scene;
use eframe::egui::{self, Ui};

/// Distance of a new measurement \[mm\].
const USUAL_FOLD_MM: f64 = 90.0;

/// The fold with rule and measurements; a plan that is not compared with practice has none.
pub(crate) fn practice(ui: &mut Ui, scene: &mut Scene, practices: &Practices, hand: Hand) {
    let takes = practices.takes(scene);
    if takes.is_empty() {
        return;
    }
    egui::CollapsingHeader::new(takes).id_salt("practice").show_unindented(ui, |ui| {
        remark(ui, tr("The stretch of the skin is compared with that of a round implant of this volume, by the same model in the same tissue."));
        remark(ui, rule_in_short(practices, scene).trim_end());
        let before = scene.measured();
        let mut now = before;
        remark(ui, tr("The present breast fills the stretched skin"));
        chips(ui, |ui| {
            let none = tr("not said");
            if chip(ui, hand, now.envelope_fill.is_none(), none, none) {
                now.envelope_fill = None;
            }
            for fill in EnvelopeFill::ALL {
                let is_chosen = now.envelope_fill == Some(fill);
                if chip(ui, hand, is_chosen, name_of(fill), about(fill)) {
                    now.envelope_fill = Some(fill);
                }
            }
        });
        let mut is_measured = now.fold_stretched_mm.is_some();
        let tooltip = fold_control().tooltip;
        if ui
            .checkbox(&mut is_measured, tr("Nipple–fold measured"))
            .on_hover_text(tooltip)
            .changed()
        {
            now.fold_stretched_mm = is_measured.then_some(USUAL_FOLD_MM);
        }
        fold(ui, &mut now, hand);
        if now != before {
            patient::measure(scene, now);
        }
    });
}

fn fold(ui: &mut Ui, measured: &mut Measurements, hand: Hand) {
    let Some(distance) = measured.fold_stretched_mm else { return };
    let mut distance = cm(distance);
    if row(ui, hand, fold_control(), &mut distance, (0.0, |_: &mut Ui| {})).is_changed {
        measured.fold_stretched_mm = Some(mm(distance));
    }
}

/// The control of the nipple–fold distance \[cm\].
pub(super) fn fold_control() -> Control<'static> {
    let (least, most) = limits::FOLD_STRETCHED_MM;
    Control {
        label: tr("Nipple–fold"),
        unit: "cm",
        kind: Kind::of_unit("cm"),
        range: 5.0..=14.0,
        allowed: Some(cm(least)..=cm(most)),
        reset: cm(USUAL_FOLD_MM),
        decimals: 1,
        most_decimals: 2,
        step: 0.1,
        tooltip: tr(
            "Distance from the nipple to the fold under the breast, with the skin stretched. Practice takes more volume for a long one.",
        ),
        ..Control::default()
    }
}

/// How much of the stretched skin the breast fills, in words.
pub(super) fn name_of(fill: EnvelopeFill) -> &'static str {
    match fill {
        EnvelopeFill::Little => tr("little"),
        EnvelopeFill::Usual => tr("partly"),
        EnvelopeFill::Much => tr("nearly all"),
    }
}

fn about(fill: EnvelopeFill) -> &'static str {
    match fill {
        EnvelopeFill::Little => tr("Less than 20 %: practice takes more volume"),
        EnvelopeFill::Usual => tr("20 to 80 %"),
        EnvelopeFill::Much => tr("More than 80 %: practice takes less volume"),
    }
}

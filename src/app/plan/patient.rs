//! What was measured on the patient, base of the breast, pinch, skin and chest, and what the measurements become.

use super::device::Device;
use super::{Hand, chest, chip, chips, cm, mm, row, title, visit, when};
use crate::app::answer::practice::Practices;
use crate::app::texts::{self, localized, tr};
use crate::app::widgets::quantity::format_at_most;
use crate::app::widgets::{Control, remark};
use crate::clinical::{Measurements, SkinClass, cover, limits};
use crate::measure::PatientValue;
use crate::scene::{Field, Scene};
use eframe::egui::{Id, Ui};

/// Pull of a new measurement \[mm\], in the middle of the class "normal".
const USUAL_PULL_MM: f64 = 25.0;

/// Shows base of the breast, pinch, skin and chest, and the entries for the file. Returns the text field with the focus.
pub(crate) fn patient(
    ui: &mut Ui,
    scene: &mut Scene,
    practices: &Practices,
    hand: Hand,
) -> Option<Id> {
    title(ui, tr("Patient"), |ui| visit::switch(ui, hand));
    let before = scene.measured();
    let mut now = before;
    base(ui, scene, practices, &mut now, hand);
    pinch(ui, scene, &mut now, hand);
    thickness(ui, scene);
    skin(ui, scene, &mut now, hand);
    if now != before {
        measure(scene, now);
    }
    chest::chest(ui, scene);
    chest::radii(ui, scene, hand);
    chest::torso(ui, scene, hand);
    visit::visit(ui, scene, hand)
}

/// Derives the values of the scene from the measurements, under a lower natural tension where the skin does not bear its own.
pub(super) fn measure(scene: &mut Scene, measured: Measurements) {
    let present = scene.body.skin_state.natural_tension_n_per_m;
    let under = |tension: f64| {
        let mut changed = scene.clone();
        if tension < present {
            changed.set_natural_tension(tension).ok()?;
        }
        changed.apply_patient(measured).ok()?;
        changed.check_tension().ok()?;
        Some(changed)
    };
    // The controls allow the ranges of the measurements only; otherwise the scene is unchanged.
    if let Some(changed) = when::tensions_up_to(present).find_map(under) {
        *scene = changed;
    }
}

/// The base of the breast, kept while the implant changes, of a plan that is compared with practice or has the measurement. A measured pull has it among its
/// own controls.
fn base(
    ui: &mut Ui,
    scene: &Scene,
    practices: &Practices,
    measured: &mut Measurements,
    hand: Hand,
) {
    let is_of_use = practices.volume(scene).is_some() || measured.base_width_mm.is_some();
    if measured.skin_pull_mm.is_some() || !is_of_use {
        return;
    }
    let mut is_set = measured.base_width_mm.is_some();
    let check = ui.checkbox(&mut is_set, tr("Keep the breast's base"));
    if check
        .on_hover_text(tr("Else practice's volume is that of a breast as wide as the implant"))
        .changed()
    {
        measured.base_width_mm = is_set.then(|| new_base(scene));
    }
    if measured.base_width_mm.is_some() {
        base_width(ui, measured, hand);
        let origin = tr("Begins as the implant's width: measure it.");
        remark(ui, Device::of(ui.ctx()).words(origin));
    }
}

/// Base width of a breast until it is measured \[mm\]: that of the implant.
pub(crate) fn new_base(scene: &Scene) -> f64 {
    let (least, most) = limits::MEASURED_WIDTH_MM;
    (2.0 * scene.implant.base_radius_mm).clamp(least, most)
}

/// The row of the breast's base.
fn base_width(ui: &mut Ui, measured: &mut Measurements, hand: Hand) {
    let mut width = cm(measured.base_width_mm.unwrap_or(120.0));
    let control = Control::of(Field::BreastWidth).with_rail(8.0..=18.0);
    let control = Control { reset: 12.0, ..control };
    if row(ui, hand, control, &mut width, (0.0, |_: &mut Ui| {})).is_changed {
        measured.base_width_mm = Some(mm(width));
    }
}

fn pinch(ui: &mut Ui, scene: &Scene, measured: &mut Measurements, hand: Hand) {
    let (control, mut pinch) = pinch_control(scene, measured);
    if row(ui, hand, control, &mut pinch, (0.0, |_: &mut Ui| {})).is_changed {
        measured.pinch_mm = Some(mm(pinch));
    }
}

/// The control of the pinch, and the pinch \[cm\].
pub(super) fn pinch_control(scene: &Scene, measured: &Measurements) -> (Control<'static>, f64) {
    // Without a measurement: the pinch of the layers.
    let layers = scene.tissue_mm();
    let (least, most) = limits::PINCH_MM;
    let pinch = cm(measured.pinch_mm.unwrap_or((2.0 * layers).clamp(least, most)));
    let control = Control { reset: 2.0, ..Control::of(Field::Pinch).with_rail(0.5..=6.0) };
    (control, pinch)
}

/// The thickness over the implant that follows from the pinch, or the values set by hand.
fn thickness(ui: &mut Ui, scene: &mut Scene) {
    let thickness = |mm: f64| format_at_most((10.0 * mm).round() / 10.0, 0, 1);
    let layers: Vec<String> = scene
        .layers
        .iter()
        .map(|layer| {
            let name: String = texts::tissue(&layer.tissue).chars().take(12).collect();
            format!("{name} {}", thickness(layer.thickness_mm))
        })
        .collect();
    let whole = scene.tissue_mm();
    let pinch = scene.measured().pinch_mm;
    let derived = pinch.and_then(|pinch| cover(pinch).ok());
    let (range, source) = derived.map_or_else(Default::default, |derived| {
        // 95 % of the people of this pinch.
        let (least, most) = derived.whole.range(2.0);
        // The pinch holds no muscle.
        let muscle = scene.muscle_mm();
        let range = format!(" ({:.0}–{:.0})", least + muscle, most + muscle);
        (range, tr!("Range of 95 %. {source}", source = tr(derived.whole.source)))
    });
    let text = tr!(
        "Cover {whole} mm{range}: {layers}",
        whole = thickness(whole),
        range,
        layers = layers.join(" + ")
    );
    let line = remark(ui, text);
    if !source.is_empty() {
        line.on_hover_text(source);
    }
    let by_hand: Vec<PatientValue> =
        scene.patient_values().into_iter().filter(|value| value.set_by_hand).collect();
    if !by_hand.is_empty() {
        ui.horizontal_wrapped(|ui| {
            let count = if by_hand.len() == 1 { tr("1 value is") } else { tr("Values are") };
            remark(ui, tr!("{count} set by hand.", count));
            let values: Vec<String> = by_hand
                .iter()
                .map(|v| {
                    tr!(
                        "{field}: {value}; {measured} gives {derived}",
                        field = v.field,
                        value = localized(v.value.to_string()),
                        measured = texts::shown(&v.measured),
                        derived = localized(v.derived.to_string())
                    )
                })
                .collect();
            if ui
                .small_button(tr("Use the measurements"))
                .on_hover_text(values.join("\n"))
                .clicked()
                && let Some(patient) = scene.patient.take()
            {
                measure(scene, patient.measured);
            }
        });
    }
}

/// Class of the skin, or a measured pull.
fn skin(ui: &mut Ui, scene: &mut Scene, measured: &mut Measurements, hand: Hand) {
    let scale = scene.layers.first().map_or(1.0, |skin| skin.curve.strain_scale);
    let is_pulled = measured.skin_pull_mm.is_some();
    let word =
        if measured.skin_class.is_none() && !is_pulled { tr(" (set under Tissue)") } else { "" };
    let about = tr!(
        "How far the skin stretches under a pull, as a factor of the preset's stretch: {scale:.2}. Tight: \
         pulled less than 2 cm; normal: 2–3 cm; lax: 3–4 cm; very lax: more than 4 cm. Within a factor 2 \
         (1 standard deviation).",
        scale
    );
    remark(ui, tr!("Skin feels{word}", word)).on_hover_text(about);
    chips(ui, |ui| {
        for class in SkinClass::ALL {
            let tooltip = tr("Class of the skin by its anterior pull");
            if chip(ui, hand, measured.skin_class == Some(class), tr(class.word()), tooltip) {
                (measured.skin_class, measured.skin_pull_mm) = (Some(class), None);
            }
        }
        let tooltip = tr("How far a grip of the fingertips lifts the skin, measured");
        if chip(ui, hand, is_pulled, tr("pull…"), tooltip) {
            measured.skin_class = None;
            measured.skin_pull_mm = Some(USUAL_PULL_MM);
            measured.base_width_mm = measured.base_width_mm.or(Some(new_base(scene)));
        }
    });
    if let Some(pull) = measured.skin_pull_mm {
        let mut pull = cm(pull);
        let control = Control::of(Field::SkinPull).with_rail(1.0..=5.0);
        let control = Control { reset: cm(USUAL_PULL_MM), ..control };
        if row(ui, hand, control, &mut pull, (0.0, |_: &mut Ui| {})).is_changed {
            measured.skin_pull_mm = Some(mm(pull));
        }
        base_width(ui, measured, hand);
    }
}

//! The plan: what a surgeon decides, in centimetres and millilitres. Each function edits a copy of the scene; the app
//! turns the difference into a command.
//!
//! `chest` (its curvature) | `fill` (what the implant is filled with) | `implant` (width, volume, projection, profile, expander) | `patient` (pinch, skin) | `practice` (what practice's volume needs) | `pocket` (margin, plane, fluid) | `plain` (numbers shown by their rows alone) | `posture` (the direction of weight) | `position`
//! (the implant in its pocket) | `shape` (round or anatomical) | `side` (of the breast) | `insertion` (in place) | `form` (all of these by name, for forms and scripts; a `field` each, choices in `form_choice`) | `visit`
//! (patient and visit in words, with the `date`) | `when` (the skin at rest, and the time after the operation).

pub(crate) mod advanced;
mod chest;
mod date;
pub(crate) mod device;
pub(crate) mod fat;
mod field;
mod fill;
mod form;
mod form_choice;
mod implant;
mod insertion;
mod patient;
pub(crate) mod plain;
mod pocket;
mod position;
mod posture;
mod practice;
mod shape;
mod side;
mod visit;
pub(crate) mod volume_band;
pub(crate) mod volume_marks;
pub(crate) mod volumes;
pub(crate) mod when;

pub(super) use chest::{chest_in_words, is_waiting as is_torso_waiting};
pub(super) use fill::{fill_in_words, show as fill};
pub(super) use form::{fields, set};
pub(super) use implant::{implant, projection_in_words, set_projection};
pub(super) use insertion::{insertion, set_insertion};
pub(super) use patient::patient;
pub(super) use pocket::{fluid, fluid_in_words, plane, plane_in_words, pocket};
pub(super) use position::{hand_of, move_to, position, position_in_words};
pub(super) use posture::posture_in_words;
pub(super) use practice::practice;
pub(super) use shape::{is_anatomical, shape_in_words, usual_apex};
pub(super) use side::sides;
pub(super) use visit::{
    entries_of_report, missing_for_file, patient_in_words, patient_number, set_fill_steps,
    set_visit, visit_in_words,
};

pub(super) use crate::app::plan::device::Device;
use crate::app::texts::{self, fixed, tr};
use crate::app::widgets::quantity::{format_at_most, significant};
use crate::app::widgets::theme;
use crate::app::widgets::{Control, ControlResponse};
use crate::clinical::{Dimension, Size};
use crate::curve::number;
use crate::scene::{Field, Layer, Posture, Scene};
use eframe::egui::{self, RichText, Ui};
pub(super) use patient::new_base;
use serde::{Deserialize, Serialize};

/// The plan of a device in words: names and values.
pub(super) fn rows(scene: &Scene, device: Device) -> Vec<(&'static str, String)> {
    let implant = &scene.implant;
    let width = 2.0 * implant.base_radius_mm;
    let size = implant.size().ok();
    let centimetres = |mm: f64| format!("{} cm", format_at_most(cm(mm), 1, 1));
    let layer = |layer: &Layer| {
        format!("{} {} mm", texts::tissue(&layer.tissue), fixed(layer.thickness_mm, 1))
    };
    let measured = scene.measured();
    let length = |name, mm: Option<f64>| mm.map(|mm| (name, centimetres(mm)));
    let class = measured.skin_class.map(|class| (tr("Skin"), tr(class.word()).to_owned()));
    let fill = measured
        .envelope_fill
        .map(|fill| (tr("Skin filled by the breast"), practice::name_of(fill).to_owned()));
    let [x, y] = implant.center_mm;
    let layers: Vec<String> = scene.layers.iter().map(layer).collect();
    let margin = scene.pocket_radius_mm - implant.greatest_half_axis_mm();
    let volume = if device == Device::Expander { tr("Fill") } else { tr("Volume") };
    let lowered = scene.body.pocket_lowered_mm;
    let size = [
        Some((tr("Width"), centimetres(width))),
        (!implant.is_round()).then(|| (tr("Shape"), shape_in_words(scene))),
        (device == Device::Implant).then(|| (tr("Filled with"), fill_in_words(scene))),
        size.map(|size| (volume, format!("{:.0} ml", size.volume_ml()))),
        Some((tr("Projection"), centimetres(implant.projection_mm))),
        size.map(|size| (tr("Profile"), tr(size.profile_in_words()).to_owned())),
    ];
    let [rest, time] = when::rows(scene);
    let after_size = [
        length(tr("Pinch"), measured.pinch_mm),
        class,
        length(tr("Pull of the skin"), measured.skin_pull_mm),
        length(tr("Breast base"), measured.base_width_mm),
        length(tr("Nipple–fold, stretched"), measured.fold_stretched_mm),
        fill,
        Some((tr("Tissue"), layers.join(", "))),
        rest,
        time,
        (scene.body.posture != Posture::None).then(|| (tr("Posture"), posture_in_words(scene))),
        scene.is_layered().then(|| (tr("Chest"), chest_in_words(scene))),
        Some((tr("Pocket"), format!("{} + {}", device.words(tr("implant")), centimetres(margin)))),
        length(
            tr("New fold lower"),
            Some(lowered).filter(|_| Field::PocketLowered.is_stated(scene)),
        ),
        scene.body.plane.map(|_| (tr("Plane of the pocket"), plane_in_words(scene))),
        pocket::is_limited(scene).then(|| (tr("Fluid in the pocket"), fluid_in_words(scene))),
        Some((
            tr("Position"),
            tr!("{side} to the side, {up} up", side = centimetres(x), up = centimetres(y)),
        )),
        Some((tr("In place"), format!("{:.0} %", 100.0 * scene.insertion))),
    ];
    let plain = plain::rows(scene).map(Some);
    size.into_iter().chain(plain).chain(after_size).flatten().collect()
}

/// The plan as [`rows`], with the values of the other side's plan beside those that differ.
pub(super) fn rows_of_sides(scene: &Scene, device: Device) -> Vec<(&'static str, String)> {
    let mut all = rows(scene, device);
    if let Some(other) = &scene.other_side {
        for (name, value) in rows(other, device) {
            let of_other = format!("{} {value}", side_in_a_word(other));
            match all.iter_mut().find(|(own, _)| *own == name) {
                Some((_, own)) if *own == value => {}
                Some((_, own)) => {
                    *own = format!("{} {own} · {of_other}", side_in_a_word(scene));
                }
                None => all.push((name, of_other)),
            }
        }
    }
    all
}

/// The side of a plan in a word.
pub(super) fn side_in_a_word(scene: &Scene) -> &'static str {
    scene.side.map_or("–", |side| tr(side.word()))
}

/// The implant of a device in a line with the maker's name, as "Implant RD-275: round, 12 cm wide, 275 ml, projection 4.3 cm".
pub(super) fn implant_in_words(scene: &Scene, device: Device) -> String {
    let implant = &scene.implant;
    let words = |mm: f64| format_at_most(cm(mm), 0, 1);
    let name = [device.words(tr("Implant")), scene.implant_reference.trim().to_owned()].join(" ");
    tr!(
        "{name}: {shape}, {width} cm wide, {volume:.0} ml, projection {projection} cm",
        name = name.trim_end(),
        shape = shape_in_words(scene),
        width = words(2.0 * implant.base_radius_mm),
        volume = implant.size().map_or(0.0, Size::volume_ml),
        projection = words(implant.projection_mm)
    )
}

/// The implant in a line, or that of each side behind its name.
pub(super) fn implants_in_words(scene: &Scene, device: Device) -> Vec<String> {
    let Some(other) = &scene.other_side else { return vec![implant_in_words(scene, device)] };
    let line = |scene| format!("{}: {}", side_in_a_word(scene), implant_in_words(scene, device));
    [scene, other].map(line).to_vec()
}

/// The Poisson ratios of the layers in a sentence, for the technical details.
pub(super) fn poisson_ratios(scene: &Scene) -> String {
    let ratio =
        |layer: &Layer| format!("{} {}", texts::tissue(&layer.tissue), number(layer.poisson_ratio));
    let layers: Vec<String> = scene.layers.iter().map(ratio).collect();
    tr!("Poisson ratio: {layers}.", layers = layers.join(", "))
}

/// What moves the controls.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Hand {
    /// A mouse: sliders.
    Mouse,
    /// A finger: steppers, because a swipe over a slider should scroll.
    Finger,
}

/// Choices of the plan that are not part of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Choices {
    pub(super) device: Device,
    /// The dimension that follows the other two.
    pub(super) follows: Dimension,
    /// The dimension changed last, which stays beside the next one; `None`: [`Self::follows`] rules.
    #[serde(skip)]
    pub(super) last: Option<Dimension>,
}

impl Choices {
    /// An anatomical plan that comes back by the history, a pin or a file is no expander's.
    pub(super) fn fit(&mut self, scene: &Scene) {
        if is_anatomical(&scene.implant) {
            self.device = Device::Implant;
        }
    }
}

impl Default for Choices {
    fn default() -> Self {
        Self { device: Device::Implant, follows: Dimension::Projection, last: None }
    }
}

/// Millimetres as centimetres, without the digits of rounding.
fn cm(mm: f64) -> f64 {
    significant(0.1 * mm)
}

/// Centimetres as millimetres, without the digits of rounding.
fn mm(cm: f64) -> f64 {
    significant(10.0 * cm)
}

/// Shows a control in a row with a slider or a stepper. `trailing`: a width \[points\] and what is added in it.
fn row(
    ui: &mut Ui,
    hand: Hand,
    control: Control<'_>,
    value: &mut f64,
    trailing: (f32, impl FnOnce(&mut Ui)),
) -> ControlResponse {
    match hand {
        Hand::Mouse => control.row(ui, value, trailing),
        Hand::Finger => control.stepper(ui, value, trailing.1),
    }
}

/// The title of a part of the plan, with what `add` puts at the end of its line.
fn title(ui: &mut Ui, text: &str, add: impl FnOnce(&mut Ui)) {
    ui.add_space(theme::SPACE_SMALL);
    ui.horizontal(|ui| {
        ui.add(egui::Label::new(RichText::new(text).heading()));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            // Room for the scroll bar that appears with unfolded parts.
            ui.add_space(theme::SPACE_SMALL);
            add(ui);
        });
    });
}

/// Width of the names of the fields \[points\].
const NAMES: f32 = 68.0;

/// A field behind its name.
pub(super) fn named<R>(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui) -> R) -> R {
    let row = ui.horizontal(|ui| {
        let place = egui::vec2(NAMES, ui.spacing().interact_size.y);
        let middle = egui::Layout::left_to_right(egui::Align::Center);
        ui.allocate_ui_with_layout(place, middle, |ui| {
            ui.set_min_width(NAMES);
            ui.label(RichText::new(name).color(ui.visuals().weak_text_color()));
        });
        add(ui)
    });
    row.inner
}

/// A choice out of a few that are all visible; returns whether this one was chosen.
pub(super) fn chip(ui: &mut Ui, hand: Hand, is_chosen: bool, text: &str, tooltip: &str) -> bool {
    chip_button(ui, hand, is_chosen, text, tooltip) && !is_chosen
}

/// A chip; returns whether it was clicked.
fn chip_button(ui: &mut Ui, hand: Hand, is_chosen: bool, text: &str, tooltip: &str) -> bool {
    let least = match hand {
        Hand::Mouse => egui::vec2(0.0, 24.0),
        Hand::Finger => egui::vec2(36.0, theme::FINGER),
    };
    let chip = egui::Button::selectable(is_chosen, text)
        .frame(true)
        .frame_when_inactive(true)
        .min_size(least);
    let chip = ui.add(chip);
    let is_clicked = chip.clicked();
    if !tooltip.is_empty() {
        chip.on_hover_text(tooltip);
    }
    is_clicked
}

/// A row of chips close to each other.
pub(super) fn chips(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    ui.horizontal_wrapped(|ui| {
        let spacing = ui.spacing_mut();
        spacing.item_spacing.x = 3.0;
        spacing.button_padding.x = 4.0;
        add(ui);
    });
}

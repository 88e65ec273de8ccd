//! The left side: what the surgeon chooses. Each function edits a copy of the scene; the app turns
//! what changed into a command.

use super::curve_editor;
use super::stability;
use super::theme::{SPACE, SPACE_SMALL};
use crate::scene::{Implant, Layer, Scene, Springs, limits};
use crate::session::Session;
use eframe::egui::{self, Response, RichText, Ui};
use std::ops::RangeInclusive;

/// A slider with label, unit, typed value, double-click to reset and a tooltip.
pub(super) struct Control<'a> {
    pub(super) label: &'a str,
    pub(super) unit: &'a str,
    pub(super) range: RangeInclusive<f64>,
    pub(super) reset: f64,
    pub(super) decimals: usize,
    pub(super) step: f64,
    pub(super) logarithmic: bool,
    pub(super) tooltip: &'a str,
}

impl Default for Control<'_> {
    fn default() -> Self {
        Self {
            label: "",
            unit: "",
            range: 0.0..=1.0,
            reset: 0.0,
            decimals: 1,
            step: 0.5,
            logarithmic: false,
            tooltip: "",
        }
    }
}

impl Control<'_> {
    pub(super) fn show(self, ui: &mut Ui, value: &mut f64) -> Response {
        let name = match self.unit {
            "" => self.label.to_owned(),
            unit => format!("{} ({unit})", self.label),
        };
        let text = ui.label(RichText::new(&name).color(ui.visuals().weak_text_color()));
        // The value stands right of the rail, at the same place in every row.
        ui.spacing_mut().slider_width = (ui.available_width() - 78.0).max(60.0);
        // The slider rounds what it holds: only what a hand has set goes into the scene.
        let mut shown = *value;
        let slider = egui::Slider::new(&mut shown, self.range)
            .clamping(egui::SliderClamping::Edits)
            .fixed_decimals(self.decimals)
            .step_by(self.step)
            .logarithmic(self.logarithmic);
        let response = ui.add(slider).labelled_by(text.id);
        let tooltip =
            format!("{}\nDouble-click the name to reset to {}.", self.tooltip, self.reset);
        let text = text.interact(egui::Sense::click()).on_hover_text(&tooltip);
        let mut response = response.on_hover_text(tooltip);
        if text.double_clicked() || response.double_clicked() {
            shown = self.reset;
            response.mark_changed();
        }
        if response.changed() {
            *value = shown;
        }
        response
    }
}

/// A titled group that can be folded.
pub(super) fn group(ui: &mut Ui, title: &str, add: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(RichText::new(title).strong()).default_open(true).show_unindented(
        ui,
        |ui| {
            add(ui);
            ui.add_space(SPACE);
        },
    );
}

/// Implant and pocket.
pub(super) fn implant(ui: &mut Ui, scene: &mut Scene, is_hemisphere: &mut bool) {
    let usual = Scene::default();
    let Implant { base_radius_mm: radius, projection_mm: projection, center_mm: center } =
        &mut scene.implant;
    group(ui, "Implant", |ui| {
        let (least, most) = limits::BASE_RADIUS_MM;
        Control {
            label: "Base radius",
            unit: "mm",
            range: least..=most,
            reset: usual.implant.base_radius_mm,
            tooltip: "Half of the implant's width. Round implants are 78–180 mm across.",
            ..Control::default()
        }
        .show(ui, radius);
        ui.checkbox(is_hemisphere, "Hemisphere (projection = base radius)").on_hover_text(
            "The highest dome over a base: the paper's bound, under which the covered area doubles.",
        );
        let (least, most) = limits::PROJECTION_MM;
        ui.add_enabled_ui(!*is_hemisphere, |ui| {
            Control {
                label: "Projection",
                unit: "mm",
                range: least..=most,
                reset: *radius,
                tooltip: "Height of the implant above its base. Round implants: 20–75 mm, \
                          0.39–1.07 of the base radius.",
                ..Control::default()
            }
            .show(ui, projection);
        });
        for (label, value, side) in [
            ("Position across", 0, "patient's left or right"),
            ("Position along", 1, "head or feet"),
        ] {
            Control {
                label,
                unit: "mm",
                range: -60.0..=60.0,
                reset: 0.0,
                tooltip: &format!("Offset of the implant in its pocket towards the {side}."),
                ..Control::default()
            }
            .show(ui, &mut center[value]);
        }
    });
    let least =
        scene.implant.base_radius_mm + scene.implant.center_mm[0].hypot(scene.implant.center_mm[1]);
    group(ui, "Pocket", |ui| {
        Control {
            label: "Pocket radius",
            unit: "mm",
            range: least.min(limits::POCKET_RADIUS_MAX_MM)..=limits::POCKET_RADIUS_MAX_MM,
            reset: (least + 15.0).min(limits::POCKET_RADIUS_MAX_MM),
            tooltip: "The dissected disc under the tissue. Outside of it the tissue stays on the \
                      chest wall. At least as wide as the implant where it lies.",
            ..Control::default()
        }
        .show(ui, &mut scene.pocket_radius_mm);
    });
}

/// The layers, from the skin inwards.
pub(super) fn layers(ui: &mut Ui, scene: &mut Scene) {
    let mut action = None;
    let count = scene.layers.len();
    for (k, layer) in scene.layers.iter_mut().enumerate() {
        let title = format!("Layer {}: {}", k + 1, layer.tissue);
        let header = egui::CollapsingHeader::new(RichText::new(title).strong())
            .id_salt(("layer", k))
            .default_open(k < 2);
        header.show_unindented(ui, |ui| {
            ui.push_id(k, |ui| one_layer(ui, layer));
            ui.horizontal(|ui| {
                let named = |text: &str| format!("{text} layer {}", k + 1);
                for (icon, name, tooltip, enabled, what) in [
                    ("Up", "Move up", "Move this layer towards the skin", k > 0, Action::Up(k)),
                    (
                        "Down",
                        "Move down",
                        "Move this layer inwards",
                        k + 1 < count,
                        Action::Up(k + 1),
                    ),
                    ("Remove", "Remove", "Remove this layer", count > 1, Action::Remove(k)),
                ] {
                    let button = ui.add_enabled(enabled, egui::Button::new(icon));
                    let label = named(name);
                    name_it(&button, egui::Role::Button, &label);
                    if button.on_hover_text(tooltip).clicked() {
                        action = Some(what);
                    }
                }
            });
            ui.add_space(SPACE);
        });
    }
    ui.horizontal_wrapped(|ui| {
        let room = count < limits::LAYERS.1;
        for (name, make) in
            [("Add skin", Layer::skin as fn() -> Layer), ("Add adipose", Layer::adipose)]
        {
            if ui
                .add_enabled(room, egui::Button::new(name))
                .on_hover_text("Added innermost; up to 8 layers")
                .clicked()
            {
                action = Some(Action::Add(make()));
            }
        }
    });
    match action {
        Some(Action::Up(k)) => scene.layers.swap(k - 1, k),
        Some(Action::Remove(k)) => {
            scene.layers.remove(k);
        }
        Some(Action::Add(layer)) => scene.layers.push(layer),
        None => {}
    }
}

enum Action {
    /// Exchange with the layer above.
    Up(usize),
    Remove(usize),
    Add(Layer),
}

fn one_layer(ui: &mut Ui, layer: &mut Layer) {
    let usual = if layer.tissue == "adipose" { Layer::adipose() } else { Layer::skin() };
    ui.horizontal(|ui| {
        let label = ui.label(RichText::new("Tissue").color(ui.visuals().weak_text_color()));
        ui.add(
            egui::TextEdit::singleline(&mut layer.tissue)
                .char_limit(40)
                .desired_width(ui.available_width() - SPACE),
        )
        .labelled_by(label.id)
        .on_hover_text("Free text; skin and adipose have their own colours");
    });
    let (least, most) = limits::THICKNESS_MM;
    Control {
        label: "Thickness",
        unit: "mm",
        range: least..=most,
        reset: usual.thickness_mm,
        step: 0.1,
        logarithmic: true,
        tooltip: "Thickness at rest. Breast skin is about 1–3 mm, the adipose layer 5–40 mm.",
        ..Control::default()
    }
    .show(ui, &mut layer.thickness_mm);
    let (least, most) = limits::POISSON_RATIO;
    Control {
        label: "Poisson ratio",
        range: least..=most,
        reset: usual.poisson_ratio,
        decimals: 2,
        step: 0.01,
        tooltip: "How much the tissue narrows when stretched. Soft tissues: 0.35–0.50; 0.50 keeps \
                  its volume.",
        ..Control::default()
    }
    .show(ui, &mut layer.poisson_ratio);
    curve_editor::show(ui, &mut layer.curve);
}

/// Spring law and resolution.
pub(super) fn method(ui: &mut Ui, scene: &mut Scene, session: &Session) {
    group(ui, "Method", |ui| {
        let label = ui.label(RichText::new("Springs").color(ui.visuals().weak_text_color()));
        let name = |springs: Springs| match springs {
            Springs::Coupled => "Coupled (exact, isotropic)",
            Springs::Nikolaev => "Nikolaev 2013, as published",
        };
        egui::ComboBox::from_id_salt("springs")
            .width(ui.available_width() - SPACE)
            .selected_text(name(scene.springs))
            .show_ui(ui, |ui| {
                for springs in [Springs::Coupled, Springs::Nikolaev] {
                    ui.selectable_value(&mut scene.springs, springs, name(springs));
                }
            })
            .response
            .labelled_by(label.id)
            .on_hover_text(
                "Coupled springs meet the measured curve and Poisson ratio exactly, in every \
                 direction. The paper's springs are for comparison: with large strains and Poisson \
                 ratios they have no stable shape.",
            );
        if let Some(limits) = session.stability_limits() {
            stability::show(ui, scene, limits, session.greatest_strain());
        }
        ui.add_space(SPACE_SMALL);
        let label = ui.label(RichText::new("Resolution").color(ui.visuals().weak_text_color()));
        let nodes = &mut scene.solver.nodes_per_side;
        egui::ComboBox::from_id_salt("resolution")
            .width(ui.available_width() - SPACE)
            .selected_text(format!("{nodes} nodes a side"))
            .show_ui(ui, |ui| {
                for choice in [33, 65, 129, 193, 257] {
                    ui.selectable_value(nodes, choice, format!("{choice} nodes a side"));
                }
            })
            .response
            .labelled_by(label.id)
            .on_hover_text("Finer grids are slower; 129 is within 0.02 % of the exact membrane");
        let mut percent = scene.solver.tolerance * 100.0;
        let (least, most) = limits::TOLERANCE;
        Control {
            label: "Tolerance",
            unit: "% of the base radius",
            range: 100.0 * least.max(1e-6)..=100.0 * most,
            reset: 0.01,
            decimals: 4,
            step: 0.0,
            logarithmic: true,
            tooltip: "The greatest position error of a node that the solver may leave.",
        }
        .show(ui, &mut percent);
        let tolerance = (percent / 100.0).clamp(least, most);
        if (tolerance / scene.solver.tolerance - 1.0).abs() > 1e-9 {
            scene.solver.tolerance = tolerance;
        }
    });
}

/// Makes a scene that a drag has made impossible possible again, and says what it moved.
pub(super) fn repair(scene: &mut Scene, is_hemisphere: bool) -> Option<String> {
    let radius = scene.implant.base_radius_mm;
    if is_hemisphere {
        scene.implant.projection_mm = radius;
    }
    let mut notice = None;
    let [x, y] = scene.implant.center_mm;
    let (distance, room) = (x.hypot(y), limits::POCKET_RADIUS_MAX_MM - radius);
    if distance > room {
        let share = (room / distance) * (1.0 - 1e-12);
        scene.implant.center_mm = [x * share, y * share];
        notice = Some("The implant was moved inwards: a pocket is at most 200 mm in radius.");
    }
    let [x, y] = scene.implant.center_mm;
    let least = (radius + x.hypot(y)).min(limits::POCKET_RADIUS_MAX_MM);
    if scene.pocket_radius_mm < least {
        scene.pocket_radius_mm = least;
        notice = Some("The pocket was widened to hold the implant.");
    }
    notice.map(str::to_owned)
}

/// A heading with room above it.
pub(super) fn heading(ui: &mut Ui, text: &str) {
    ui.add_space(SPACE_SMALL);
    ui.heading(text);
    ui.add_space(SPACE_SMALL);
}

/// Gives a widget whose text is an icon or a number its name for screen readers and tests.
pub(super) fn name_it(response: &Response, role: egui::Role, name: &str) {
    response.widget_info(|| egui::WidgetInfo::labeled(role, response.enabled(), name));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slider_that_no_hand_moves_leaves_its_value_alone() {
        // Finer than the step, and outside of the range that the slider offers.
        for given in [55.3, 1.234_567, 130.0] {
            let mut value = given;
            let mut changed = false;
            egui::__run_test_ui(|ui| {
                let control =
                    Control { label: "Base radius", range: 10.0..=120.0, ..Control::default() };
                changed |= control.show(ui, &mut value).changed();
            });
            assert!(!changed && value.to_bits() == given.to_bits(), "{given} became {value}");
        }
    }
}

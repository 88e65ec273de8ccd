//! The controls of the range of implants: colours, axes with their ends, number of plans.

use super::axes::{self, Words};
use super::{FINENESS, Range, readout};
use crate::app::frame::commands::PICTURE;
use crate::app::frame::research;
use crate::app::frame::toolbar::Layout;
use crate::app::plan::{Hand, chip};
use crate::app::texts::tr;
use crate::app::widgets::theme;
use crate::app::widgets::{NumberField, button_if, choice, list, set_accessible_name};
use crate::scene::Scene;
use crate::study::{Parameter, Quantity};
use eframe::egui::{self, Button, RichText, Ui};

/// The choice of no second axis.
const NOTHING: &str = "Nothing: a curve";

fn quiet(ui: &mut Ui, words: &str) {
    ui.label(RichText::new(words).color(ui.visuals().weak_text_color()));
}

/// The button of the chart around the plan.
const AROUND: &str = "Around the plan";

impl Range {
    /// The controls of the chart.
    pub(super) fn controls(&mut self, ui: &mut Ui, scene: &Scene, layout: Layout) -> Vec<String> {
        let mut rejections = Vec::new();
        let is_research = research::is_on(ui.ctx());
        let has_axes = is_research || !self.has_usual_axes();
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = theme::SPACE_SMALL + 2.0;
            if layout == Layout::Narrow && chip(ui, Hand::Mouse, false, tr(PICTURE), "") {
                self.is_open = false;
            }
            self.quantity_box(ui, scene, layout);
            if layout == Layout::Narrow {
                let name = if has_axes { tr("Axes") } else { tr("Stock and files") };
                let more = Button::selectable(self.shows_more, name).frame_when_inactive(true);
                if ui.add(more).clicked() {
                    self.shows_more = !self.shows_more;
                }
                if !self.shows_more {
                    return;
                }
            }
            if self.up.is_some() && (is_research || self.fineness != FINENESS[0].1) {
                self.fineness_box(ui);
            }
            if !has_axes {
                self.around_button(ui, scene);
                return;
            }
            ui.end_row();
            self.field_box(ui, scene, true);
            self.ends(ui, scene, true, &mut rejections);
            if layout == Layout::Narrow {
                ui.end_row();
            }
            self.field_box(ui, scene, false);
            if self.up.is_some() {
                self.ends(ui, scene, false, &mut rejections);
            }
            self.around_button(ui, scene);
        });
        rejections
    }

    fn around_button(&mut self, ui: &mut Ui, scene: &Scene) {
        let is_able = !self.is_around(scene);
        let tip = tr("Sizes 2 cm around the plan, usual values of other numbers");
        if button_if(ui, is_able, tr(AROUND), tr(AROUND), tip) {
            self.go_around(scene);
        }
    }

    fn quantity_box(&mut self, ui: &mut Ui, scene: &Scene, layout: Layout) {
        if !readout::applies(self.quantity, scene.is_layered()) {
            self.quantity = Quantity::GreatestStrain;
        }
        if layout == Layout::Wide {
            quiet(ui, if self.up.is_some() { tr("Colour") } else { tr("Curve") });
        }
        let response = list(ui, "range quantity")
            .width(if layout == Layout::Wide { 170.0 } else { 150.0 })
            .truncate()
            .selected_text(tr(self.quantity.title()))
            .show_ui(ui, |ui| {
                for quantity in readout::quantities() {
                    if readout::applies(quantity, scene.is_layered())
                        && choice(ui, self.quantity == quantity, tr(quantity.title())).clicked()
                    {
                        self.quantity = quantity;
                    }
                }
            })
            .response;
        set_accessible_name(&response, egui::Role::ComboBox, tr("Colour"));
        response.on_hover_text(tr("The result shown by the colours, or by the curve"));
    }

    fn field_box(&mut self, ui: &mut Ui, scene: &Scene, is_across: bool) {
        let name = if is_across { tr("Across") } else { tr("Upwards") };
        let present = if is_across { Some(self.across.field) } else { self.up.map(|up| up.field) };
        let selected = present.map_or(tr(NOTHING), |field| Words::of(field).name);
        quiet(ui, name);
        let mut chosen = None;
        let response = list(ui, name)
            .width(112.0)
            .truncate()
            .selected_text(selected)
            .show_ui(ui, |ui| {
                if !is_across && choice(ui, present.is_none(), tr(NOTHING)).clicked() {
                    chosen = Some(None);
                }
                let is_free =
                    |field: &Parameter| is_across || !field.excludes(self.across.field, scene);
                for field in axes::FIELDS.into_iter().filter(is_free) {
                    if axes::applies(field, scene)
                        && choice(ui, present == Some(field), Words::of(field).name).clicked()
                    {
                        chosen = Some(Some(field));
                    }
                }
            })
            .response;
        set_accessible_name(&response, egui::Role::ComboBox, name);
        response.on_hover_text(if is_across {
            tr("The number of the plan that varies from left to right")
        } else {
            tr("The number of the plan that varies upwards; without one the chart is a curve")
        });
        if let Some(field) = chosen.filter(|field| *field != present) {
            self.set_field(is_across, field, scene);
        }
    }

    /// First and last value of an axis; reasons of rejected numbers go to `rejections`.
    fn ends(&mut self, ui: &mut Ui, scene: &Scene, is_across: bool, rejections: &mut Vec<String>) {
        let middle = self.middle.unwrap_or(scene.implant);
        let axis = if is_across { Some(&mut self.across) } else { self.up.as_mut() };
        let Some(axis) = axis else { return };
        let words = Words::of(axis.field);
        let (least, most) = axes::allowed(axis.field);
        let before = axis.ends(scene, middle);
        let mut ends = [before.0, before.1].map(|value| words.display(value));
        let name = if is_across { tr("Across") } else { tr("Upwards") };
        let mut is_changed = false;
        for (end, side) in ends.iter_mut().zip([tr("from"), tr("to")]) {
            let field = NumberField {
                name: &format!("{name}, {side}"),
                kind: words.kind,
                allowed: words.display(least)..=words.display(most),
                decimals: 0,
                step: if words.unit == "cm" { 0.5 } else { 0.1 * most.min(100.0) },
                width: 40.0,
                ..NumberField::default()
            };
            let typed = field.show(ui, end);
            is_changed |= typed.is_changed;
            rejections.extend(typed.rejection.map(|reason| format!("{name}, {side}: {reason}")));
            if side == tr("from") {
                quiet(ui, "–");
            }
        }
        quiet(ui, words.unit);
        if is_changed {
            let [from, to] = ends.map(|end| words.value(end));
            axis.ends = Some((from.min(to), from.max(to)));
        }
    }

    fn fineness_box(&mut self, ui: &mut Ui) {
        let present = FINENESS.iter().find(|(_, count)| *count == self.fineness);
        let response = list(ui, "fineness")
            .width(70.0)
            .selected_text(present.map_or("", |(name, _)| tr(name)))
            .show_ui(ui, |ui| {
                for (name, count) in FINENESS {
                    if choice(ui, self.fineness == count, tr(name)).clicked() {
                        self.fineness = count;
                    }
                }
            })
            .response;
        set_accessible_name(&response, egui::Role::ComboBox, tr("Points"));
        response.on_hover_text(tr("Number of plans: about 20 × 20, 40 × 40 or 60 × 60"));
    }
}

//! The composed picture of a plan: answer, picture with legend and scale, plan, cards, date.

use crate::app::texts::tr;
use crate::app::theme::{SPACE, SPACE_SMALL};
use eframe::egui::{self, Margin, RichText, Ui, Vec2, vec2};

/// Size of the composed picture \[points\].
pub(super) const SIZE: Vec2 = vec2(1000.0, 840.0);
/// Height of the 3-D view in it \[points\].
const VIEW: f32 = 480.0;
/// Size of the title and width of the plan's names \[points\].
const TITLE: f32 = 20.0;
const NAMES: f32 = 90.0;

/// The texts of the composed picture.
pub(super) struct Figure {
    /// The answer in one sentence.
    pub(super) headline: String,
    /// Reference and side; may be empty.
    pub(super) patient: String,
    /// The plan: names and values.
    pub(super) plan: Vec<(&'static str, String)>,
    /// The cards: title, figure, word, further line.
    pub(super) cards: Vec<[String; 4]>,
    /// Warnings, or what a missing answer means.
    pub(super) remarks: Vec<String>,
    /// Date, version and model.
    pub(super) origin: String,
}

impl Figure {
    /// Arranges the texts around the 3-D view.
    pub(super) fn show(&self, ui: &mut Ui, view: impl FnOnce(&mut Ui)) {
        ui.spacing_mut().item_spacing.y = SPACE_SMALL;
        // Lines of text only: none is as high as a button.
        ui.spacing_mut().interact_size.y = 0.0;
        egui::Frame::new().inner_margin(Margin::same(24)).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.label(RichText::new(&self.headline).size(TITLE).strong());
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    ui.add(egui::Label::new(&self.patient).truncate());
                });
            });
            ui.add_space(SPACE);
            ui.allocate_ui(vec2(ui.available_width(), VIEW), view);
            ui.add_space(SPACE);
            ui.columns_const(|[left, right]: &mut [Ui; 2]| {
                // A column would justify its texts.
                left.vertical(|ui| self.plan(ui));
                right.vertical(|ui| self.answer(ui));
            });
            ui.with_layout(egui::Layout::bottom_up(egui::Align::Min), |ui| {
                ui.label(RichText::new(&self.origin).small());
                ui.label(RichText::new(super::DISCLAIMER).small());
            });
        });
    }

    fn plan(&self, ui: &mut Ui) {
        ui.heading(tr("Plan"));
        for (name, value) in &self.plan {
            ui.horizontal_top(|ui| {
                let place = vec2(NAMES, ui.text_style_height(&egui::TextStyle::Body));
                let left = egui::Layout::left_to_right(egui::Align::Min);
                ui.allocate_ui_with_layout(place, left, |ui| {
                    ui.set_min_width(NAMES);
                    ui.label(RichText::new(*name).weak());
                });
                ui.add(egui::Label::new(value).wrap());
            });
        }
    }

    fn answer(&self, ui: &mut Ui) {
        ui.heading(tr("What happens"));
        for [title, figure, word, line] in &self.cards {
            ui.horizontal_wrapped(|ui| {
                ui.label(RichText::new(title).weak());
                ui.label(figure);
                ui.label(RichText::new(word).strong());
            });
            ui.label(RichText::new(line).small());
        }
        for remark in &self.remarks {
            ui.label(format!("! {remark}"));
        }
    }
}

//! The composed picture of a plan: answer, picture with legend and scale, plan, cards, date.

use super::offscreen;
use crate::app::plan::device::Device;
use crate::app::texts::tr;
use crate::app::widgets::theme::{SPACE, SPACE_SMALL};
use eframe::egui::{self, Margin, RichText, Ui, Vec2, vec2};

/// Width of the composed picture \[points\]; its height follows from its texts.
const WIDTH: f32 = 1000.0;
/// Pixels per point of the composed picture.
pub(super) const SCALE: f32 = 2.0;
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
    /// The heading of the cards.
    pub(super) heading: String,
    /// The cards: title, figure, word, further line.
    pub(super) cards: Vec<[String; 4]>,
    /// Warnings, or what a missing answer means.
    pub(super) remarks: Vec<String>,
    /// Date, version and model.
    pub(super) origin: String,
}

impl Figure {
    /// Size of the picture about a device, with a view or without \[points\].
    pub(super) fn size(&self, device: Device, has_view: bool) -> Vec2 {
        let fill = |ui: &mut Ui| {
            if has_view {
                ui.allocate_space(ui.available_size());
            }
        };
        vec2(WIDTH, offscreen::height(device, (WIDTH, SCALE), |ui| self.show(ui, fill)))
    }

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
            ui.add_space(SPACE);
            ui.label(RichText::new(super::DISCLAIMER).small());
            ui.label(RichText::new(&self.origin).small());
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
        ui.heading(&self.heading);
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::plan;
    use crate::clinical::Measurements;
    use crate::scene::Scene;
    use eframe::egui::{Pos2, Rect, Shape};

    /// Takes the room of a view.
    fn take(ui: &mut Ui) {
        ui.allocate_space(ui.available_size());
    }

    /// Places of the texts of a picture.
    fn texts(size: Vec2, figure: &Figure) -> Vec<(String, Rect)> {
        let ctx = offscreen::context(Device::Implant);
        let mut output = ctx.run_ui(offscreen::input(size, SCALE), |ui| figure.show(ui, take));
        output.textures_delta.clear();
        let texts = output.shapes.into_iter().filter_map(|shape| match shape.shape {
            Shape::Text(text) => Some((text.galley.text().to_owned(), text.visual_bounding_rect())),
            _ => None,
        });
        texts.collect()
    }

    #[test]
    fn no_text_of_the_picture_is_over_another_one_and_all_are_within() {
        let device = Device::Implant;
        let mut scene = Scene::opening();
        let all = Measurements {
            pinch_mm: Some(20.0),
            base_width_mm: Some(120.0),
            fold_stretched_mm: Some(85.0),
            ..Measurements::default()
        };
        scene.apply_patient(all).unwrap();
        for remarks in [0, 12] {
            let figure = Figure {
                headline: "Answer".to_owned(),
                patient: "4711".to_owned(),
                plan: plan::rows(&scene, device),
                heading: "What happens".to_owned(),
                cards: vec![["Card", "1 cm", "usual", "A further line"].map(str::to_owned); 5],
                remarks: vec!["A warning of this plan in a line".to_owned(); remarks],
                origin: "Date".to_owned(),
            };
            let size = figure.size(device, true);
            let texts = texts(size, &figure);
            assert!(texts.iter().any(|(text, _)| text == "In place"), "{texts:?}");
            let picture = Rect::from_min_size(Pos2::ZERO, size);
            for (k, (text, place)) in texts.iter().enumerate() {
                assert!(picture.contains_rect(*place), "{text} {place} in {picture}");
                for (other, beside) in &texts[..k] {
                    let both = place.intersect(*beside);
                    assert!(!both.is_positive(), "{text} {place} over {other} {beside}");
                }
            }
            // No empty room below.
            let lowest = texts.iter().map(|(_, place)| place.bottom()).fold(0.0, f32::max);
            assert!(size.y - lowest < 32.0, "{lowest} of {size}");
        }
    }
}

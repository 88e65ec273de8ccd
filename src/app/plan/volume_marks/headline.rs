//! The largest usual volume on the screen, as a link that takes the volume.

use super::VolumeMarks;
use crate::app::answer::practice::Practices;
use crate::app::plan::device::Device;
use crate::scene::Scene;
use eframe::egui::{self, RichText, TextStyle, Ui, vec2};

/// Lines of the sentence in a narrow column and in a broader room, and least width of that \[points\].
const LINES: (f32, f32) = (4.0, 3.0);
const BROAD: f32 = 280.0;

/// Shows the sentence in a room that it always has; returns the plan of the volume if the link is pressed.
pub(crate) fn headline(
    ui: &mut Ui,
    plan: &Scene,
    marks: &VolumeMarks,
    practices: &Practices,
) -> Option<Scene> {
    let lines = if ui.available_width() < BROAD { LINES.0 } else { LINES.1 };
    // A link is a little higher than a text.
    let height = lines * ui.text_style_height(&TextStyle::Body) + 1.0;
    let room = vec2(ui.available_width(), height);
    let layout = egui::Layout::top_down(egui::Align::Min);
    let response = ui.allocate_ui_with_layout(room, layout, |ui| {
        ui.set_min_size(room);
        let words = marks.largest_usual(practices);
        if words.is_empty() {
            return None;
        }
        let about = Device::of(ui.ctx()).words(&marks.about_largest_usual());
        let words = RichText::new(words);
        let Some((largest, _)) = marks.largest_plan(plan) else {
            ui.add(egui::Label::new(words).wrap()).on_hover_text(about);
            return None;
        };
        ui.link(words).on_hover_text(about).clicked().then_some(largest)
    });
    response.inner
}

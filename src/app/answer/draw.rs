//! The cards on the screen: figure, word with its level, bar with limits and mark.

use super::bar::Bar;
use super::cards::{BarScale, Card};
use super::text_of;
use super::uncertainty::{FEW, Findings, without_answer};
use crate::app::plan::device::Device;
use crate::app::texts::tr;
use crate::app::widgets::set_accessible_name;
use crate::app::widgets::theme::{self, SPACE};
use crate::measure::bands;
use eframe::egui::{
    self, Align2, Color32, FontId, Rangef, Rect, RichText, Sense, Shape, Stroke, StrokeKind,
    TextStyle, Ui, pos2, vec2,
};

pub(super) fn show_card(ui: &mut Ui, card: &Card, findings: Option<&Findings>) {
    let frame = egui::Frame::group(ui.style()).inner_margin(SPACE).corner_radius(8);
    let response = frame
        .show(ui, |ui| {
            ui.set_width(ui.available_width());
            ui.spacing_mut().item_spacing.y = 2.0;
            ui.horizontal(|ui| {
                ui.label(RichText::new(Device::of(ui.ctx()).words(card.title)).strong());
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    verdict(ui, card);
                });
            });
            // Two rows each with and without sampled patients: nothing below moves.
            ui.horizontal(|ui| {
                ui.set_min_height(2.0 * ui.text_style_height(&TextStyle::Body));
                ui.label(RichText::new(&card.figure).size(theme::FIGURE));
                let beside = with_its_number(&card.beside);
                let beside = RichText::new(beside).color(ui.visuals().weak_text_color());
                let label = ui.add(egui::Label::new(beside).wrap());
                set_accessible_name(&label, egui::Role::Label, &card.beside);
            });
            draw(ui, &Bar::of(card));
            let line = match &card.shares {
                Some(shares) => shares_in(ui, with_its_number(shares)),
                None => {
                    let line = Device::of(ui.ctx()).words(&card.line);
                    RichText::new(line).small().color(ui.visuals().weak_text_color())
                }
            };
            // Room of two lines of shares.
            let font = note(ui);
            let height = 2.0 * ui.ctx().fonts_mut(|fonts| fonts.row_height(&font)).ceil();
            let room = vec2(ui.available_width(), height);
            ui.allocate_ui(room, |ui| {
                ui.set_min_height(height);
                ui.add(egui::Label::new(line).wrap());
            });
        })
        .response;
    let mut tooltip = match &card.scale {
        BarScale::Bands { limits, .. } => text_of(limits),
        BarScale::Part { .. } => tr(bands::COVER).to_owned(),
    };
    if let Some(findings) = findings.filter(|_| card.range.is_some()) {
        let count = findings.answers();
        tooltip = tr!(
            "In brackets: 10th to 90th percentile of {count} sampled patients{median}. The word is that of this plan; the \
             bar has a line over the range.\n{tooltip}",
            count,
            median = card
                .median
                .as_ref()
                .map_or_else(String::new, |median| tr!(", median {median}", median)),
            tooltip
        );
        let line = card.shares.as_ref().map(|_| card.line.clone());
        let patients = card.shares.as_ref().map(|_| such_patients(card, findings));
        let further = [line, patients, without_answer(findings)].into_iter().flatten();
        tooltip = further.chain([tooltip]).collect::<Vec<_>>().join("\n");
    }
    response.on_hover_text(Device::of(ui.ctx()).words(&tooltip));
}

/// Size of the numbers of patients: a calm word of the plan is not that of all of them \[points\].
const NOTE: f32 = 13.0;

fn note(ui: &Ui) -> FontId {
    FontId { size: NOTE, ..TextStyle::Small.resolve(ui.style()) }
}

/// The numbers of patients, in small letters where they would take a third line.
fn shares_in(ui: &Ui, shares: String) -> RichText {
    let (font, color) = (note(ui), ui.visuals().text_color());
    let galley = ui.painter().layout(shares.clone(), font.clone(), color, ui.available_width());
    let words = RichText::new(shares);
    if galley.rows.len() > 2 { words.small() } else { words.font(font) }
}

/// A text whose signs of percent stay on the line of their numbers.
fn with_its_number(text: &str) -> String {
    text.replace(" %", "\u{a0}%")
}

/// Who the patients of a card's line are, and what their words are against.
fn such_patients(card: &Card, findings: &Findings) -> String {
    let count = if card.is_of_practice { FEW } else { findings.solved() };
    let who = tr!(
        "Such patients: {count} computed ones, with the spread of what is not known about a patient.",
        count
    );
    match card.is_of_practice {
        true => format!(
            "{who} {}",
            tr(
                "Each of them is compared with practice's volume in their own tissue, not in that of this plan."
            )
        ),
        false => who,
    }
}

/// Shows the word of a band with its level, as one to four strokes: colour is not the only sign.
fn verdict(ui: &mut Ui, card: &Card) {
    let Some((band, word)) = card.verdict else {
        let words = if card.value.is_some() { card.no_verdict } else { "" };
        ui.label(RichText::new(words).small().color(ui.visuals().weak_text_color()));
        return;
    };
    let color = band_color(ui, band);
    ui.label(RichText::new(word).size(theme::VERDICT).strong().color(color));
    let (rect, _) = ui.allocate_exact_size(vec2(18.0, 14.0), Sense::hover());
    for k in 0..4 {
        let at = rect.left() + 5.0 * k as f32;
        let height = 5.0 + 3.0 * k as f32;
        let stroke =
            Rect::from_min_max(pos2(at, rect.bottom() - height), pos2(at + 3.0, rect.bottom()));
        if k <= band {
            ui.painter().rect_filled(stroke, 1.0, color);
        } else {
            let line = Stroke::new(1.0, theme::palette(ui.visuals()).edge);
            ui.painter().rect_stroke(stroke, 1.0, line, StrokeKind::Inside);
        }
    }
}

/// Draws a bar: its parts, its limits with their texts, the line of the sampled patients, the value's mark.
fn draw(ui: &mut Ui, of: &Bar) {
    let (rect, _) = ui.allocate_exact_size(vec2(ui.available_width(), 28.0), Sense::hover());
    let bar = Rect::from_min_size(rect.min + vec2(0.0, 7.0), vec2(rect.width(), 8.0));
    let (palette, painter) = (theme::palette(ui.visuals()), ui.painter());
    let quiet = ui.visuals().weak_text_color();
    let font = TextStyle::Small.resolve(ui.style());
    let at = |part: f64| bar.left() + bar.width() * part as f32;
    painter.rect_filled(bar, 0.0, ui.visuals().extreme_bg_color);
    let mut from = 0.0;
    for (to, color) in &of.parts {
        let part = Rect::from_x_y_ranges(at(from)..=at(*to), bar.y_range());
        painter.rect_filled(part, 0.0, theme::color32(*color));
        from = *to;
    }
    let line = if of.has_bands { ui.visuals().panel_fill } else { quiet };
    let mut taken: Vec<Rangef> = Vec::new();
    for (limit, text) in &of.limits {
        painter.vline(at(*limit), bar.y_range(), Stroke::new(1.0, line));
        let galley = painter.layout_no_wrap(text.clone(), font.clone(), quiet);
        let width = galley.size().x;
        let left = (at(*limit) - 0.5 * width).clamp(bar.left(), bar.right() - width);
        // Another limit may be too close for its text.
        let own = Rangef::new(left - 4.0, left + width);
        if taken.iter().all(|other| other.max < own.min || own.max < other.min) {
            painter.galley(pos2(left, bar.bottom() + 1.0), galley, quiet);
            taken.push(own);
        }
    }
    let end = pos2(bar.right(), bar.bottom() + 1.0);
    painter.text(end, Align2::RIGHT_TOP, of.unit, font, quiet);
    painter.rect_stroke(bar, 1.0, Stroke::new(1.0, palette.edge), StrokeKind::Outside);
    if let Some([low, high]) = of.range {
        let line = Stroke::new(2.5, palette.text);
        painter.hline(at(low)..=at(high), bar.top() - 4.0, line);
    }
    if let Some(value) = of.value {
        let (x, top) = (at(value), bar.top());
        let mark = vec![pos2(x, top + 3.0), pos2(x - 5.0, top - 6.0), pos2(x + 5.0, top - 6.0)];
        let line = Stroke::new(1.0, ui.visuals().panel_fill);
        painter.add(Shape::convex_polygon(mark, palette.text, line));
    }
}

/// Colour of the words of a band, counted from the lowest.
pub(crate) fn band_color(ui: &Ui, band: usize) -> Color32 {
    let palette = theme::palette(ui.visuals());
    [palette.text, palette.caution, palette.bad, palette.bad][band.min(3)]
}

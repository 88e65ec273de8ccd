//! The legend of a picture: the colour bar with title, unit, limits, words of the bands and a mark at the greatest value.

use super::overlay::{MARGIN, SCALE_BAR, backdrop, font};
use crate::app::texts::{self, tr};
use crate::app::widgets::theme::{self, SPACE};
use crate::view::color::Scale;
use eframe::egui::{
    Align2, CornerRadius, Mesh, Painter, Rect, Shape, Stroke, StrokeKind, Ui, pos2, vec2,
};

const BAR_WIDTH: f32 = 12.0;

/// Draws the colour bar with title, unit, limits, words of the bands and a mark at the greatest value: at the right
/// edge, in a narrow area along the bottom, beside the scale bar. Returns the place of the legend.
pub(crate) fn legend(
    ui: &Ui,
    painter: &Painter,
    area: Rect,
    scale_bar: Rect,
    scale: &Scale,
) -> Rect {
    if area.width() < NARROW {
        let low = area.with_min_x(scale_bar.right()).with_min_y(area.bottom() - STRIP - SPACE);
        strip(ui, painter, low, scale)
    } else {
        column(ui, painter, area, scale)
    }
}

/// Width of an area below which the legend is a strip \[points\].
const NARROW: f32 = 460.0;

fn title(scale: &Scale) -> String {
    if scale.unit.is_empty() {
        return texts::shown(&scale.title);
    }
    format!("{} [{}]", texts::shown(&scale.title), tr(scale.unit))
}

/// Position of a value in the bar, 0 to 1.
fn fraction(scale: &Scale, value: f32) -> f32 {
    (value - scale.low) / (scale.high - scale.low)
}

/// The scale's colours between two corners, low at `from`.
fn colours(painter: &Painter, bar: Rect, scale: &Scale, is_upright: bool) {
    let mut mesh = Mesh::default();
    let steps = scale.table.len() as f32;
    for (k, &c) in scale.table.iter().enumerate() {
        let (a, b) = (k as f32 / steps, (k + 1) as f32 / steps);
        let band = if is_upright {
            let at = |t: f32| bar.bottom() - bar.height() * t;
            Rect::from_min_max(pos2(bar.left(), at(b)), pos2(bar.right(), at(a)))
        } else {
            let at = |t: f32| bar.left() + bar.width() * t;
            Rect::from_min_max(pos2(at(a), bar.top()), pos2(at(b), bar.bottom()))
        };
        mesh.add_colored_rect(band, theme::color32(c));
    }
    painter.add(Shape::mesh(mesh));
}

/// The legend at the right edge.
fn column(ui: &Ui, painter: &Painter, area: Rect, scale: &Scale) -> Rect {
    let (font, text) = (font(ui), ui.visuals().text_color());
    let height = (area.height() * 0.42).clamp(70.0, 200.0);
    let layout = |words: &str| painter.layout_no_wrap(words.to_owned(), font.clone(), text);
    let words: Vec<_> =
        scale.words.iter().map(|(value, word)| (*value, layout(tr(word)))).collect();
    let labels: Vec<_> =
        scale.ticks.iter().map(|(_, label)| layout(&texts::localized(tr(label)))).collect();
    let width = |of: &mut dyn Iterator<Item = f32>| of.fold(0.0, f32::max);
    let word_width = width(&mut words.iter().map(|(_, galley)| galley.size().x));
    let label_width = width(&mut labels.iter().map(|galley| galley.size().x));
    let title = layout(&title(scale));
    // From the right: numbers, bar, mark, words.
    let (right, top) = (area.right() - MARGIN, area.top() + MARGIN);
    let bar_right = right - label_width - 8.0;
    let bar_top = top + title.size().y + 10.0;
    let bar = Rect::from_min_size(pos2(bar_right - BAR_WIDTH, bar_top), vec2(BAR_WIDTH, height));
    let words_right = bar.left() - 14.0;
    let left = (words_right - word_width).min(right - title.size().x);
    let ground = Rect::from_min_max(pos2(left, top), pos2(right, bar.bottom() + 4.0));
    let place = backdrop(ui, painter, ground);
    let title_size = title.size();
    painter.galley(pos2(right - title_size.x, top - 2.0), title, text);
    colours(painter, bar, scale, true);
    let outline = Stroke::new(1.0, ui.visuals().weak_text_color());
    painter.rect_stroke(bar, CornerRadius::ZERO, outline, StrokeKind::Outside);
    let spacing = font.size + 1.0;
    for (((value, _), y), label) in
        scale.ticks.iter().zip(label_heights(scale, bar, spacing)).zip(labels)
    {
        let tick = height_of(scale, bar, *value);
        painter.line_segment([pos2(bar.right(), tick), pos2(bar.right() + 4.0, y)], outline);
        painter.galley(pos2(bar.right() + 7.0, y - 0.5 * label.size().y), label, text);
    }
    let mut lowest = f32::INFINITY;
    for (value, galley) in words {
        // A narrow band's word is moved up from the word below.
        let y = (height_of(scale, bar, value)).min(lowest - spacing);
        lowest = y;
        painter.galley(
            pos2(words_right - galley.size().x, y - 0.5 * galley.size().y),
            galley,
            text,
        );
    }
    if let Some(greatest) = scale.greatest {
        let y = height_of(scale, bar, greatest.clamp(scale.low, scale.high));
        let tip = pos2(bar.left() - 1.0, y);
        let mark = vec![tip, tip + vec2(-8.0, -5.0), tip + vec2(-8.0, 5.0)];
        painter.add(Shape::convex_polygon(mark, text, Stroke::NONE));
    }
    place
}

/// Height of the legend along an edge \[points\].
pub(crate) const STRIP: f32 = 50.0;

/// The legend along the top of an area.
pub(crate) fn strip(ui: &Ui, painter: &Painter, area: Rect, scale: &Scale) -> Rect {
    let (font, text) = (font(ui), ui.visuals().text_color());
    let left = area.left() + MARGIN;
    let bar = Rect::from_min_size(
        pos2(left, area.top() + MARGIN + 12.0),
        vec2(area.width() - 2.0 * MARGIN, 8.0),
    );
    let ground = Rect::from_min_max(bar.min - vec2(0.0, 16.0), bar.max + vec2(0.0, 14.0));
    let place = backdrop(ui, painter, ground);
    colours(painter, bar, scale, false);
    let outline = Stroke::new(1.0, ui.visuals().weak_text_color());
    painter.rect_stroke(bar, CornerRadius::ZERO, outline, StrokeKind::Outside);
    let at = |value: f32| bar.left() + bar.width() * fraction(scale, value).clamp(0.0, 1.0);
    let above = pos2(left, bar.top() - 2.0);
    let title = painter.text(above, Align2::LEFT_BOTTOM, title(scale), font.clone(), text);
    // Words above, as far as there is room to the right of the title; numbers below.
    let mut free = title.right() + 6.0;
    for (value, word) in &scale.words {
        let galley = painter.layout_no_wrap(tr(word).to_owned(), font.clone(), text);
        let start = at(*value) - 0.5 * galley.size().x;
        if start > free && start + galley.size().x <= bar.right() {
            free = start + galley.size().x + 6.0;
            painter.galley(pos2(start, bar.top() - 2.0 - galley.size().y), galley, text);
        }
    }
    let mut free = f32::NEG_INFINITY;
    for (value, label) in &scale.ticks {
        let galley = painter.layout_no_wrap(texts::localized(tr(label)), font.clone(), text);
        // A bar narrower than the number has the number at its left end.
        let start = (at(*value) - 0.5 * galley.size().x).min(bar.right() - galley.size().x);
        let start = start.max(bar.left());
        if start > free {
            free = start + galley.size().x + 4.0;
            painter.galley(pos2(start, bar.bottom() + 1.0), galley, text);
        }
    }
    if let Some(greatest) = scale.greatest {
        // On the bar: the words stand above it, the numbers below.
        let tip = pos2(at(greatest), bar.bottom() + 0.5);
        let mark = vec![tip, tip - vec2(-5.0, 9.0), tip - vec2(5.0, 9.0)];
        painter.add(Shape::convex_polygon(mark, text, Stroke::new(1.0, ui.visuals().panel_fill)));
    }
    place
}

/// Height at the lower edge of the picture that scale bar, word of the direction and legend of a narrow picture take \[points\].
pub(crate) fn lower_edge(area: Rect) -> f32 {
    if area.width() < NARROW { STRIP + SPACE } else { MARGIN + SCALE_BAR }
}

fn height_of(scale: &Scale, bar: Rect, value: f32) -> f32 {
    bar.bottom() - bar.height() * fraction(scale, value)
}

/// Heights of the labels without overlap: raised from low to high, then pushed down from the top.
fn label_heights(scale: &Scale, bar: Rect, spacing: f32) -> Vec<f32> {
    let mut heights: Vec<f32> =
        scale.ticks.iter().map(|(value, _)| height_of(scale, bar, *value)).collect();
    for k in 1..heights.len() {
        heights[k] = heights[k].min(heights[k - 1] - spacing);
    }
    if let Some(last) = heights.last_mut() {
        *last = last.max(bar.top());
    }
    for k in (1..heights.len()).rev() {
        heights[k - 1] = heights[k - 1].max(heights[k] + spacing);
    }
    heights
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{self, Pos2};

    #[test]
    fn labels_of_close_ticks_do_not_cover_each_other() {
        let marks = [0.0, 0.25, 0.5, 0.54, 0.8];
        let scale = Scale {
            title: String::new(),
            unit: "%",
            low: 0.0,
            high: 0.8,
            ticks: marks.map(|m| (m, String::new())).to_vec(),
            words: Vec::new(),
            greatest: None,
            table: Vec::new(),
        };
        for height in [70.0, 220.0] {
            let bar = Rect::from_min_size(Pos2::ZERO, vec2(12.0, height));
            let heights = label_heights(&scale, bar, 12.0);
            assert!(heights.windows(2).all(|h| h[0] - h[1] >= 12.0 - 1e-3), "{heights:?}");
        }
    }

    #[test]
    fn the_mark_of_the_greatest_value_covers_no_word_and_no_number() {
        let area = Rect::from_min_size(Pos2::ZERO, vec2(400.0, 300.0));
        let scale = |greatest: f32| Scale {
            title: "Skin stretch".to_owned(),
            unit: "%",
            low: 0.0,
            high: 50.0,
            ticks: [0.0, 10.0, 20.0, 50.0].map(|at| (at, format!("{at}"))).to_vec(),
            words: vec![(10.0, "usual"), (35.0, "high")],
            greatest: Some(greatest),
            table: vec![[1.0; 3]; 4],
        };
        type Draw = fn(&Ui, &Painter, Rect, &Scale) -> Rect;
        let draws: [Draw; 2] = [strip, column];
        for (draw, k) in draws.into_iter().flat_map(|draw| (0..=10).map(move |k| (draw, k))) {
            let greatest = 5.0 * k as f32;
            let ctx = egui::Context::default();
            theme::install(&ctx);
            let mut output = ctx.run_ui(egui::RawInput::default(), |ui| {
                draw(ui, ui.painter(), area, &scale(greatest));
            });
            output.textures_delta.clear();
            let shapes = output.shapes.iter().map(|shape| &shape.shape);
            let texts: Vec<Rect> = shapes
                .clone()
                .filter(|shape| matches!(shape, Shape::Text(_)))
                .map(Shape::visual_bounding_rect)
                .collect();
            let mut marks = shapes.filter(|shape| matches!(shape, Shape::Path(_)));
            let mark = marks.next().map(Shape::visual_bounding_rect).expect("a mark");
            assert!(texts.len() > 4 && marks.next().is_none());
            assert!(
                texts.iter().all(|text| !text.intersects(mark)),
                "{greatest}: {mark} {texts:?}"
            );
        }
    }
}

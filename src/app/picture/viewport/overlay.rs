//! Overlays of the picture: legend, directions, scale bar, box at the pointer.

use super::Outline;
use super::directions::Edge;
use crate::app::texts::{self, tr};
use crate::app::widgets::theme::{self, SPACE};
use crate::view::color::Scale;
use eframe::egui::{
    Align2, Color32, CornerRadius, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, StrokeKind,
    TextStyle, Ui, Vec2, pos2, vec2,
};

const BAR_WIDTH: f32 = 12.0;
const MARGIN: f32 = 16.0;

fn font(ui: &Ui) -> FontId {
    TextStyle::Small.resolve(ui.style())
}

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
        let tip = pos2(at(greatest), bar.bottom() + 1.0);
        let mark = vec![tip, tip + vec2(-5.0, 8.0), tip + vec2(5.0, 8.0)];
        painter.add(Shape::convex_polygon(mark, text, Stroke::new(1.0, ui.visuals().panel_fill)));
    }
    place
}

/// Height at the lower edge of the picture that scale bar, word of the direction and legend of a narrow picture take \[points\].
pub(crate) fn lower_edge(area: Rect) -> f32 {
    if area.width() < NARROW { STRIP + SPACE } else { MARGIN + SCALE_BAR }
}

/// Draws the words for the directions of the patient at the middles of an area's edges, beside what has `taken` a place.
/// Returns all places that are taken then.
pub(crate) fn directions(
    ui: &Ui,
    painter: &Painter,
    area: Rect,
    words: &[(Edge, &'static str)],
    taken: &[Rect],
) -> Vec<Rect> {
    let mut taken = taken.to_vec();
    let inner = area.shrink(SPACE);
    for &(edge, word) in words {
        let galley = painter.layout_no_wrap(word.to_owned(), font(ui), ui.visuals().text_color());
        let (anchor, at) = match edge {
            Edge::Top => (Align2::CENTER_TOP, inner.center_top()),
            Edge::Bottom => (Align2::CENTER_BOTTOM, inner.center_bottom()),
            Edge::Left => (Align2::LEFT_CENTER, inner.left_center() + vec2(4.0, 0.0)),
            Edge::Right => (Align2::RIGHT_CENTER, inner.right_center() - vec2(4.0, 0.0)),
        };
        let rect = anchor.anchor_size(at, galley.size()).expand2(vec2(4.0, 0.0));
        let Some(rect) = moved_beside(rect, area, &taken) else { continue };
        taken.push(rect);
        let fill = ui.visuals().panel_fill.gamma_multiply(0.75);
        painter.rect_filled(rect, CornerRadius::same(4), fill);
        painter.galley(rect.min + vec2(4.0, 0.0), galley, ui.visuals().text_color());
    }
    taken
}

/// The place beside those that are taken, inside of an area, that is nearest to a wanted one; `None` without room.
fn moved_beside(rect: Rect, area: Rect, taken: &[Rect]) -> Option<Rect> {
    const GAP: f32 = 2.0;
    let is_free = |rect: &Rect| {
        area.contains_rect(*rect) && !taken.iter().any(|other| other.intersects(*rect))
    };
    let beside = taken.iter().filter(|other| other.is_positive()).flat_map(|other| {
        [
            vec2(0.0, other.top() - GAP - rect.bottom()),
            vec2(0.0, other.bottom() + GAP - rect.top()),
            vec2(other.left() - GAP - rect.right(), 0.0),
            vec2(other.right() + GAP - rect.left(), 0.0),
        ]
    });
    let places = [Vec2::ZERO].into_iter().chain(beside).map(|by| (by.length(), rect.translate(by)));
    places
        .filter(|(_, rect)| is_free(rect))
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, rect)| rect)
}

/// Draws a background that keeps text readable over the body; returns its place.
fn backdrop(ui: &Ui, painter: &Painter, rect: Rect) -> Rect {
    let fill = ui.visuals().panel_fill.gamma_multiply(0.6);
    let place = rect.expand(6.0);
    painter.rect_filled(place, CornerRadius::same(4), fill);
    place
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

/// Draws a line of an envelope: outer solid, inner dashed, on a light ground over any colour.
pub(crate) fn envelope(ui: &Ui, painter: &Painter, points: Vec<Pos2>, is_outer: bool) {
    let (line, ground) = (ui.visuals().text_color(), ui.visuals().panel_fill.gamma_multiply(0.6));
    painter.add(Shape::line(points.clone(), Stroke::new(4.0, ground)));
    let stroke = Stroke::new(1.5, line);
    if is_outer {
        painter.add(Shape::line(points, stroke));
    } else {
        painter.extend(Shape::dashed_line(&points, stroke, 6.0, 4.0));
    }
}

/// Draws a line of a pin's outline with the pin's letter, on a light ground over any colour.
pub(crate) fn outline(ui: &Ui, painter: &Painter, points: Vec<Pos2>, outline: &Outline) {
    // Each letter at a place of its own: similar outlines lie over each other.
    let at = 0.24 + 0.09 * outline.letter as usize as f32;
    let Some(&end) = points.get((at * points.len() as f32) as usize) else { return };
    let ground = ui.visuals().panel_fill.gamma_multiply(0.6);
    let (dash, gap) = outline.dashes;
    painter.add(Shape::line(points.clone(), Stroke::new(4.0, ground)));
    painter.extend(Shape::dashed_line(&points, Stroke::new(2.0, outline.color), dash, gap));
    let galley = painter.layout_no_wrap(outline.letter.to_string(), font(ui), outline.color);
    let place = Align2::CENTER_BOTTOM.anchor_size(end - vec2(0.0, 4.0), galley.size());
    painter.rect_filled(place.expand(2.0), CornerRadius::same(3), ground);
    painter.galley(place.min, galley, outline.color);
}

/// Height of the scale bar with its number and ground \[points\].
const SCALE_BAR: f32 = 22.0;

/// Draws a bar of a round length in mm; the scale holds at the camera's target. Returns the place of the bar.
pub(crate) fn scale_bar(ui: &Ui, painter: &Painter, area: Rect, points_per_mm: f32) -> Rect {
    let length_mm = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0]
        .into_iter()
        .find(|mm| mm * points_per_mm >= 48.0)
        .unwrap_or(500.0);
    let start = pos2(area.left() + MARGIN, area.bottom() - MARGIN);
    let end = start + vec2(length_mm * points_per_mm, 0.0);
    let stroke = Stroke::new(1.5, ui.visuals().text_color());
    let ground = Rect::from_two_pos(start - vec2(0.0, 16.0), end + vec2(0.0, 3.0));
    let place = backdrop(ui, painter, ground);
    painter.line_segment([start, end], stroke);
    for p in [start, end] {
        painter.line_segment([p - vec2(0.0, 3.0), p + vec2(0.0, 3.0)], stroke);
    }
    let label = if length_mm < 10.0 {
        format!("{length_mm} mm")
    } else {
        format!("{} cm", 0.1 * length_mm)
    };
    let at = start.lerp(end, 0.5) - vec2(0.0, 5.0);
    painter.text(
        at,
        Align2::CENTER_BOTTOM,
        texts::localized(label),
        font(ui),
        ui.visuals().text_color(),
    );
    place
}

/// Height of a caption of two lines with its margin \[points\].
pub(crate) const CAPTION: f32 = 58.0;

/// Draws the name of a picture at the left of its upper edge; long lines go on below.
pub(crate) fn caption(ui: &Ui, painter: &Painter, area: Rect, title: &str) {
    let font = TextStyle::Button.resolve(ui.style());
    let (color, width) = (ui.visuals().strong_text_color(), area.width() - 2.0 * MARGIN);
    let galley = painter.layout(title.to_owned(), font, color, width);
    let at = area.left_top() + vec2(MARGIN, MARGIN);
    backdrop(ui, painter, Rect::from_min_size(at, galley.size()));
    painter.galley(at, galley, ui.visuals().strong_text_color());
}

/// Draws a small box beside the pointer, inside the area, beside what has `taken` a place where there is room. Returns the place
/// of the box.
pub(crate) fn pointer_box(
    ui: &Ui,
    painter: &Painter,
    area: Rect,
    pointer: Pos2,
    lines: &[String],
    taken: &[Rect],
) -> Rect {
    let galley = painter.layout_no_wrap(lines.join("\n"), font(ui), ui.visuals().text_color());
    let padding = Vec2::splat(8.0);
    let size = galley.size() + 2.0 * padding;
    let rect = beside_pointer(area, pointer, size, taken);
    let visuals = ui.visuals();
    painter.rect(
        rect,
        CornerRadius::same(4),
        visuals.window_fill.gamma_multiply(0.94),
        visuals.window_stroke,
        StrokeKind::Inside,
    );
    painter.galley(rect.min + padding, galley, visuals.text_color());
    rect
}

/// The place of a box of a size beside the pointer: below at the right, else on another side that covers less of what is `taken`,
/// else the nearest free place.
fn beside_pointer(area: Rect, pointer: Pos2, size: Vec2, taken: &[Rect]) -> Rect {
    const AWAY: f32 = 16.0;
    // The side behind the pointer first, unless the area ends there.
    let sides = |at: f32, length: f32, from: f32, to: f32| {
        let (behind, before) = (at + AWAY, (at - AWAY - length).max(from));
        if behind + length > to { [before, behind.min(to - length)] } else { [behind, before] }
    };
    let x = sides(pointer.x, size.x, area.left(), area.right());
    let y = sides(pointer.y, size.y, area.top(), area.bottom());
    let places = [(0, 0), (0, 1), (1, 0), (1, 1)];
    let places = places.map(|(i, j)| Rect::from_min_size(pos2(x[i], y[j]), size));
    let is_covered = |place: &Rect| taken.iter().filter(|other| other.intersects(*place)).count();
    let best = places.into_iter().min_by_key(is_covered).unwrap_or(places[0]);
    moved_beside(best, area, taken).unwrap_or(best)
}

/// Draws a gradient behind the body, lighter at the top.
pub(crate) fn background(ui: &Ui, painter: &Painter, area: Rect) {
    let (top, bottom) = if ui.visuals().dark_mode {
        (Color32::from_rgb(40, 43, 47), Color32::from_rgb(22, 24, 27))
    } else {
        (Color32::from_rgb(247, 248, 249), Color32::from_rgb(219, 223, 227))
    };
    let mut mesh = Mesh::default();
    for (corner, color) in [
        (area.left_top(), top),
        (area.right_top(), top),
        (area.right_bottom(), bottom),
        (area.left_bottom(), bottom),
    ] {
        mesh.colored_vertex(corner, color);
    }
    mesh.add_triangle(0, 1, 2);
    mesh.add_triangle(0, 2, 3);
    painter.add(Shape::mesh(mesh));
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn a_box_stands_beside_the_pointer_and_covers_nothing_that_is_taken() {
        let area = Rect::from_min_size(Pos2::ZERO, vec2(400.0, 300.0));
        let size = vec2(120.0, 50.0);
        let place = |at: Pos2, taken: &[Rect]| beside_pointer(area, at, size, taken);
        let middle = pos2(200.0, 150.0);
        assert_eq!(place(middle, &[]).min, pos2(216.0, 166.0));
        assert_eq!(place(pos2(390.0, 290.0), &[]).max, pos2(374.0, 274.0));
        // Another box at the usual place, and boxes at several.
        let mut taken = vec![place(middle, &[])];
        for _ in 0..4 {
            let next = place(middle, &taken);
            assert!(area.contains_rect(next), "{next}");
            assert!(taken.iter().all(|other| !other.intersects(next)), "{next} {taken:?}");
            taken.push(next);
        }
        // Without room the box stands at a side.
        assert!(area.contains_rect(place(middle, &[area])));
    }

    #[test]
    fn a_word_moves_beside_what_has_taken_its_place() {
        let area = Rect::from_min_size(Pos2::ZERO, vec2(100.0, 100.0));
        let taken = [Rect::from_min_size(pos2(60.0, 0.0), vec2(40.0, 50.0)), Rect::NOTHING];
        let word = Rect::from_center_size(pos2(80.0, 45.0), vec2(20.0, 10.0));
        let moved = moved_beside(word, area, &taken).unwrap();
        assert_eq!((moved.left(), moved.top()), (word.left(), 52.0));
        let free = Rect::from_center_size(pos2(20.0, 20.0), vec2(20.0, 10.0));
        assert_eq!(moved_beside(free, area, &taken), Some(free));
        assert_eq!(moved_beside(word, area, &[area]), None);
    }
}

//! Overlays of the picture: directions, scale bar, box at the pointer.

use super::Outline;
use super::directions::Edge;
use crate::app::texts;
use crate::app::widgets::theme::SPACE;
use eframe::egui::{
    Align2, Color32, CornerRadius, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, StrokeKind,
    TextStyle, Ui, Vec2, pos2, vec2,
};
use glam::Vec3;

pub(super) const MARGIN: f32 = 16.0;

pub(super) fn font(ui: &Ui) -> FontId {
    TextStyle::Small.resolve(ui.style())
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
pub(super) fn backdrop(ui: &Ui, painter: &Painter, rect: Rect) -> Rect {
    let fill = ui.visuals().panel_fill.gamma_multiply(0.6);
    let place = rect.expand(6.0);
    painter.rect_filled(place, CornerRadius::same(4), fill);
    place
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
pub(super) const SCALE_BAR: f32 = 22.0;

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

/// Height of the strip of the scale below a picture on paper, and how far its bar is above the strip's end \[points\].
const SCALE_STRIP: f32 = 26.0;
const ABOVE_END: f32 = 7.0;

/// A picture on paper and the strip below it, on which its scale covers no body.
pub(crate) fn above_scale(area: Rect) -> [Rect; 2] {
    let end = area.bottom() - SCALE_STRIP.min(0.5 * area.height());
    [area.with_max_y(end), area.with_min_y(end)]
}

/// Draws the bar of [`scale_bar`] on the strip below a picture.
pub(crate) fn scale_below(ui: &Ui, strip: Rect, points_per_mm: f32) -> Rect {
    let place = strip.translate(vec2(SPACE - MARGIN, MARGIN - ABOVE_END));
    scale_bar(ui, &ui.painter_at(strip), place, points_per_mm)
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
    let [bottom, top] = ends(ui);
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

/// Its colours at the lower and at the upper edge.
fn ends(ui: &Ui) -> [Color32; 2] {
    match ui.visuals().dark_mode {
        true => [Color32::from_rgb(22, 24, 27), Color32::from_rgb(40, 43, 47)],
        false => [Color32::from_rgb(219, 223, 227), Color32::from_rgb(247, 248, 249)],
    }
}

/// The same, from 0 to 1.
pub(crate) fn behind(ui: &Ui) -> [Vec3; 2] {
    ends(ui).map(|color| Vec3::new(color.r().into(), color.g().into(), color.b().into()) / 255.0)
}

#[cfg(test)]
mod tests {
    use super::*;

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

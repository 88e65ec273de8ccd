//! Overlays of the picture: colour bar, scale bar, values at the pointer.

use crate::measure::Field;
use crate::session::Session;
use crate::view::color::{Rgb, Scale};
use crate::view::pick::{Hit, Target};
use crate::view::picture::Picture;
use eframe::egui::{
    Align2, Color32, CornerRadius, FontId, Mesh, Painter, Pos2, Rect, Shape, Stroke, StrokeKind,
    TextStyle, Ui, Vec2, pos2, vec2,
};

const BAR_WIDTH: f32 = 12.0;
const MARGIN: f32 = 16.0;

fn color32(c: Rgb) -> Color32 {
    let byte = |v: f32| (v.clamp(0.0, 1.0) * 255.0).round() as u8;
    Color32::from_rgb(byte(c[0]), byte(c[1]), byte(c[2]))
}

fn font(ui: &Ui) -> FontId {
    TextStyle::Small.resolve(ui.style())
}

/// Draws the colour bar at the right edge with title, unit and ticks.
pub(crate) fn color_bar(ui: &Ui, painter: &Painter, area: Rect, scale: &Scale) {
    let font = font(ui);
    let text = ui.visuals().text_color();
    let height = (area.height() * 0.42).min(area.width() * 0.36).clamp(70.0, 220.0);
    let right = area.right() - MARGIN - 34.0;
    let top = area.top() + MARGIN + 22.0;
    let bar = Rect::from_min_size(pos2(right - BAR_WIDTH, top), vec2(BAR_WIDTH, height));
    let title = format!("{} [{}]", scale.title, scale.unit);
    let at = pos2(area.right() - MARGIN, top - 8.0);
    let title = painter.layout_no_wrap(title, font.clone(), text);
    let title_rect = Align2::RIGHT_BOTTOM.anchor_size(at, title.size());
    let ground = title_rect.union(bar).union(Rect::from_pos(pos2(at.x, bar.bottom() + 4.0)));
    backdrop(ui, painter, ground);
    painter.galley(title_rect.min, title, text);

    let mut mesh = Mesh::default();
    let steps = scale.table.len();
    for (k, &c) in scale.table.iter().enumerate() {
        let at = |s: usize| bar.bottom() - bar.height() * s as f32 / steps as f32;
        let band = Rect::from_min_max(pos2(bar.left(), at(k + 1)), pos2(bar.right(), at(k)));
        mesh.add_colored_rect(band, color32(c));
    }
    painter.add(Shape::mesh(mesh));
    let outline = Stroke::new(1.0, ui.visuals().weak_text_color());
    painter.rect_stroke(bar, CornerRadius::ZERO, outline, StrokeKind::Outside);

    let spacing = font.size + 1.0;
    for ((value, label), y) in scale.ticks.iter().zip(label_heights(scale, bar, spacing)) {
        let tick = height_of(scale, bar, *value);
        let line = [pos2(bar.right(), tick), pos2(bar.right() + 4.0, y)];
        painter.line_segment(line, outline);
        let at = pos2(bar.right() + 7.0, y);
        painter.text(at, Align2::LEFT_CENTER, label, font.clone(), text);
    }
}

/// Draws a background that keeps text readable over the body.
fn backdrop(ui: &Ui, painter: &Painter, rect: Rect) {
    let fill = ui.visuals().panel_fill.gamma_multiply(0.6);
    painter.rect_filled(rect.expand(6.0), CornerRadius::same(4), fill);
}

fn height_of(scale: &Scale, bar: Rect, value: f32) -> f32 {
    bar.bottom() - bar.height() * (value - scale.low) / (scale.high - scale.low)
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

/// Draws a bar of a round length in mm; the scale holds at the camera's target.
pub(crate) fn scale_bar(ui: &Ui, painter: &Painter, area: Rect, points_per_mm: f32) {
    let length_mm = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0]
        .into_iter()
        .find(|mm| mm * points_per_mm >= 48.0)
        .unwrap_or(500.0);
    let start = pos2(area.left() + MARGIN, area.bottom() - MARGIN);
    let end = start + vec2(length_mm * points_per_mm, 0.0);
    let stroke = Stroke::new(1.5, ui.visuals().text_color());
    backdrop(ui, painter, Rect::from_two_pos(start - vec2(0.0, 16.0), end + vec2(0.0, 3.0)));
    painter.line_segment([start, end], stroke);
    for p in [start, end] {
        painter.line_segment([p - vec2(0.0, 3.0), p + vec2(0.0, 3.0)], stroke);
    }
    let label = format!("{length_mm} mm");
    let at = start.lerp(end, 0.5) - vec2(0.0, 5.0);
    painter.text(at, Align2::CENTER_BOTTOM, label, font(ui), ui.visuals().text_color());
}

/// The values at a hit, one per line.
pub(crate) fn readout(hit: &Hit, picture: &Picture, session: &Session) -> Vec<String> {
    let layers = &session.scene().layers;
    let name = |k: usize| layers.get(k).map_or("tissue", |l| l.tissue.as_str());
    match &hit.target {
        Target::Implant => vec![format!("Implant, {:.1} mm above the chest wall", hit.point.z)],
        Target::Ring => vec!["Outside the pocket (not computed)".to_owned()],
        Target::Cut(layer) => vec![format!("Cut through {}", name(*layer))],
        Target::Sheet(nodes) => {
            let Some(fields) = &picture.fields else { return Vec::new() };
            // Interpolated between three nodes; fields that are not displayed are not computed.
            let value = |field: Field| -> f32 {
                let at = |&(node, weight)| fields.at(field, node).map(|v| v as f32 * weight);
                nodes.iter().map(at).sum::<Option<f32>>().unwrap_or(0.0)
            };
            let mut lines = vec![
                format!("Strain {:.0} %", 100.0 * value(Field::PrincipalStrain)),
                format!("Area ratio {:.2}", value(Field::AreaStretch)),
            ];
            if session.scene().is_layered() {
                lines.push(format!("Cover {:.1} mm", value(Field::Cover)));
            }
            let pressure = value(Field::ContactPressure);
            if pressure > 0.0 {
                lines.push(format!("Pressure {} kPa", three_figures(pressure)));
            }
            for (k, thickness) in fields.solution().stack().thickness_mm.iter().enumerate() {
                let thickness = hit.target.value(thickness).unwrap_or(0.0);
                let stress = three_figures(value(Field::Stress(k)));
                lines.push(format!("{}: {stress} kPa, {thickness:.1} mm thick", name(k)));
            }
            lines
        }
    }
}

/// Formats a value with at most three digits.
fn three_figures(value: f32) -> String {
    match value.abs() {
        v if v >= 100.0 => format!("{value:.0}"),
        v if v >= 10.0 => format!("{value:.1}"),
        _ => format!("{value:.2}"),
    }
}

/// Draws a small box beside the pointer, inside the area.
pub(crate) fn pointer_box(ui: &Ui, painter: &Painter, area: Rect, pointer: Pos2, lines: &[String]) {
    let galley = painter.layout_no_wrap(lines.join("\n"), font(ui), ui.visuals().text_color());
    let padding = Vec2::splat(8.0);
    let size = galley.size() + 2.0 * padding;
    let mut corner = pointer + vec2(16.0, 16.0);
    if corner.x + size.x > area.right() {
        corner.x = (pointer.x - 16.0 - size.x).max(area.left());
    }
    if corner.y + size.y > area.bottom() {
        corner.y = (pointer.y - 16.0 - size.y).max(area.top());
    }
    let rect = Rect::from_min_size(corner, size);
    let visuals = ui.visuals();
    painter.rect(
        rect,
        CornerRadius::same(4),
        visuals.window_fill.gamma_multiply(0.94),
        visuals.window_stroke,
        StrokeKind::Inside,
    );
    painter.galley(corner + padding, galley, visuals.text_color());
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
            table: Vec::new(),
        };
        for height in [70.0, 220.0] {
            let bar = Rect::from_min_size(Pos2::ZERO, vec2(12.0, height));
            let heights = label_heights(&scale, bar, 12.0);
            assert!(heights.windows(2).all(|h| h[0] - h[1] >= 12.0 - 1e-3), "{heights:?}");
        }
    }

    #[test]
    fn values_have_at_most_three_figures() {
        let shown = [0.1234_f32, 1.234, 12.34, 123.4].map(three_figures);
        assert_eq!(shown, ["0.12", "1.23", "12.3", "123"]);
    }
}

//! Drawing of the chart of the range: axes, colours, lines, sizes, the present implant, legend.

use super::axes::Words;
use super::colours::Scale;
use super::plane::{Plane, marks};
use crate::app::texts::tr;
use crate::app::widgets::quantity::format_at_most;
use crate::app::widgets::theme::{self, SPACE};
use crate::study::{Axis, JudgedMap, Map, Quantity};
use eframe::egui::{
    self, Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, TextStyle,
    TextureHandle, Ui, pos2, vec2,
};
use web_time::Instant;

/// Space around the plane: numbers of the axes, titles \[points\].
pub(super) const LEFT: f32 = 40.0;
pub(super) const BOTTOM: f32 = 36.0;

/// Lines with the text at their middle.
pub(super) type Labelled = Vec<(String, Vec<Vec<(f64, f64)>>)>;

/// What is drawn of a map until its values or its colours change.
pub(super) struct Drawn {
    pub(super) key: (u64, Quantity, bool),
    pub(super) time: Instant,
    pub(super) axes: Vec<Axis>,
    /// Is this the chart of the previous plan?
    pub(super) is_previous: bool,
    pub(super) texture: Option<TextureHandle>,
    pub(super) scale: Scale,
    pub(super) contours: Labelled,
    pub(super) volumes: Labelled,
    pub(super) sizes: Vec<(f64, f64)>,
    /// Words and places of the bands.
    pub(super) areas: Vec<(&'static str, (f64, f64))>,
}

/// The plane of a map; up stands the second axis, or the displayed quantity of a curve.
pub(super) fn plane(map: &Map, drawn: &Drawn, rect: Rect) -> Plane {
    let range = |k: usize| map.axes().get(k).map(|axis| (axis.from, axis.to));
    let values = || {
        let (least, most) = drawn.scale.ends;
        let (factor, _) = drawn.key.1.display();
        let greatest = map.range(drawn.key.1).map_or(most, |(_, greatest)| factor * greatest);
        match &drawn.scale.limits {
            // Values may lie above the bar of colours.
            Some(_) => (least, most.max(1.05 * greatest)),
            None => (least - 0.08 * (most - least), most + 0.08 * (most - least)),
        }
    };
    Plane { rect, x: range(0).unwrap_or((0.0, 1.0)), y: range(1).unwrap_or_else(values) }
}

fn small(ui: &Ui) -> FontId {
    TextStyle::Small.resolve(ui.style())
}

/// Draws colours, lines, sizes and the present implant; no text covers the `marks`.
pub(super) fn paint(
    ui: &Ui,
    painter: &Painter,
    map: JudgedMap<'_>,
    drawn: &Drawn,
    plane: &Plane,
    (has_shelf, marks): (bool, Vec<Rect>),
) {
    let palette = theme::palette(ui.visuals());
    let rect = plane.rect;
    let path =
        |points: &[(f64, f64)]| -> Vec<Pos2> { points.iter().map(|p| plane.at(*p)).collect() };
    let mut labels = Labels { ui, painter, placed: marks };
    if let Some(texture) = &drawn.texture {
        let all = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        let mut mesh = egui::Mesh::with_texture(texture.id());
        let opacity = if drawn.is_previous { 0.5 } else { 1.0 };
        mesh.add_rect_with_uv(rect, all, Color32::WHITE.gamma_multiply(opacity));
        painter.add(Shape::mesh(mesh));
        // Bands have the same colours in both themes, the ground of points without a value has not: a halo parts a line from both.
        let visuals = ui.visuals();
        let halo = Stroke::new(2.5, visuals.extreme_bg_color.gamma_multiply(0.5));
        let thin = Stroke::new(1.0, visuals.text_color().gamma_multiply(0.7));
        for line in &drawn.volumes {
            for points in &line.1 {
                for stroke in [halo, thin] {
                    painter.extend(Shape::dashed_line(&path(points), stroke, 3.0, 4.0));
                }
            }
        }
        // The sizes of the clinic stand in place of typical ones.
        for size in drawn.sizes.iter().filter(|_| !has_shelf) {
            let at = plane.at(*size);
            let ring = Stroke::new(1.0, Color32::from_black_alpha(170));
            painter.circle(at, DOT, Color32::WHITE, ring);
            labels.placed.push(Rect::from_center_size(at, egui::Vec2::splat(2.0 * DOT)));
        }
        for line in &drawn.contours {
            for points in &line.1 {
                painter.add(Shape::line(
                    path(points),
                    Stroke::new(3.0, Color32::from_white_alpha(120)),
                ));
                painter.add(Shape::line(path(points), Stroke::new(1.6, Color32::BLACK)));
            }
        }
    } else {
        curve(ui, painter, map, drawn, plane, drawn.key.1);
    }
    let beside = present(ui, painter, &map, plane, &mut labels);
    for (text, lines) in &drawn.contours {
        let longest = lines.iter().max_by_key(|line| line.len());
        if let Some(points) = longest {
            labels.add_along(text, &path(points), 5, true);
        }
    }
    labels.add_at_one_of(tr("this plan"), &beside);
    for (word, at) in &drawn.areas {
        let at = plane.at(*at);
        NEAR.iter().any(|by| labels.add(word, at + vec2(0.0, *by), true));
    }
    for (text, lines) in &drawn.volumes {
        for points in lines {
            labels.add_along(text, &path(points), 8, false);
        }
    }
    painter.rect_stroke(rect, 0.0, Stroke::new(1.0, palette.edge), StrokeKind::Inside);
}

/// Draws a curve over one axis with the limits of its quantity.
fn curve(
    ui: &Ui,
    painter: &Painter,
    map: JudgedMap<'_>,
    drawn: &Drawn,
    plane: &Plane,
    quantity: Quantity,
) {
    let palette = theme::palette(ui.visuals());
    let Some(axis) = map.axes().first() else { return };
    let dashes = Stroke::new(1.0, palette.edge);
    let factor = quantity.display().0;
    let of_practice = drawn.scale.is_practice();
    for line in map.practice_lines().into_iter().filter(|_| of_practice) {
        let line: Vec<Pos2> = line.iter().map(|(x, v)| plane.at((*x, factor * v))).collect();
        painter.extend(Shape::dashed_line(&line, dashes, 5.0, 4.0));
    }
    if drawn.scale.limits.is_some() && !of_practice {
        for (limit, _) in drawn.scale.marks() {
            let y = plane.at((axis.from, limit)).y;
            let ends = [pos2(plane.rect.left(), y), pos2(plane.rect.right(), y)];
            painter.extend(Shape::dashed_line(&ends, dashes, 5.0, 4.0));
        }
    }
    let point = |i: usize| {
        let (value, is_solved) = map.displayed(quantity, i, 0)?;
        Some((plane.at((axis.value(i), factor * value)), is_solved))
    };
    for i in 0..axis.count {
        let Some((at, is_solved)) = point(i) else { continue };
        if let Some((next, is_next_solved)) = point(i + 1).filter(|_| i + 1 < axis.count) {
            let color = if is_solved && is_next_solved { palette.accent } else { palette.edge };
            painter.line_segment([at, next], Stroke::new(2.0, color));
        }
        if is_solved {
            painter.circle_filled(at, 2.5, palette.accent);
        }
    }
}

/// Where the words of the present implant may stand beside its mark, the best first \[points\].
const BESIDE: [(f32, f32); 8] = [
    (0.0, -18.0),
    (0.0, 18.0),
    (42.0, 0.0),
    (-42.0, 0.0),
    (42.0, -18.0),
    (-42.0, -18.0),
    (42.0, 18.0),
    (-42.0, 18.0),
];
/// Radius of the mark, and of the dot of a typical size \[points\].
const MARK: f32 = 8.0;
const DOT: f32 = 2.5;
/// Where the word of a band may stand above and below its place, the best first \[points\].
const NEAR: [f32; 5] = [0.0, -10.0, 10.0, -20.0, 20.0];

/// Marks the present implant; returns the places of its words.
fn present(
    ui: &Ui,
    painter: &Painter,
    map: &Map,
    plane: &Plane,
    labels: &mut Labels<'_>,
) -> Vec<Pos2> {
    let palette = theme::palette(ui.visuals());
    let Some([x, y]) = map.present() else { return Vec::new() };
    if map.axes().len() == 1 {
        let at = plane.at((x, 0.0)).x;
        painter.vline(at, plane.rect.y_range(), Stroke::new(1.5, palette.accent));
        return vec![pos2(at, plane.rect.top() + 10.0)];
    }
    let at = plane.at((x, y));
    for (width, color) in [(5.0, palette.on_accent), (2.5, palette.accent)] {
        painter.circle_stroke(at, MARK, Stroke::new(width, color));
    }
    painter.circle_filled(at, 2.5, palette.on_accent);
    labels.placed.push(Rect::from_center_size(at, egui::Vec2::splat(2.0 * MARK)));
    BESIDE.map(|(x, y)| at + vec2(x, y)).to_vec()
}

/// Texts on the chart; a text that would cover another one or a mark is left out.
struct Labels<'a> {
    ui: &'a Ui,
    painter: &'a Painter,
    placed: Vec<Rect>,
}

impl Labels<'_> {
    /// Adds a text at the first place that is free, else at the first one.
    fn add_at_one_of(&mut self, text: &str, places: &[Pos2]) {
        let is_placed = places.iter().any(|at| self.add(text, *at, true));
        if let Some(first) = places.first().filter(|_| !is_placed) {
            self.placed.clear();
            self.add(text, *first, true);
        }
    }

    /// Adds a text on a line, at the free place nearest to a number of tenths of its points.
    fn add_along(&mut self, text: &str, line: &[Pos2], tenths: usize, is_strong: bool) {
        let mut places: Vec<usize> = (1..10).collect();
        places.sort_by_key(|place| place.abs_diff(tenths));
        let at = |place: &usize| line.get(line.len() * place / 10).copied();
        places.iter().filter_map(at).any(|at| self.add(text, at, is_strong));
    }

    /// Adds a text; returns whether there is room.
    fn add(&mut self, text: &str, at: Pos2, is_strong: bool) -> bool {
        let visuals = self.ui.visuals();
        let color = if is_strong { visuals.strong_text_color() } else { visuals.text_color() };
        let galley = self.painter.layout_no_wrap(text.to_owned(), small(self.ui), color);
        let clip = self.painter.clip_rect().shrink(3.0);
        let size = galley.size() + vec2(6.0, 0.0);
        let mut rect = Rect::from_center_size(at, size);
        // Within the chart.
        rect = rect.translate(vec2(
            (clip.left() - rect.left()).max(0.0) + (clip.right() - rect.right()).min(0.0),
            (clip.top() - rect.top()).max(0.0) + (clip.bottom() - rect.bottom()).min(0.0),
        ));
        if self.placed.iter().any(|other| other.expand(1.0).intersects(rect)) {
            return false;
        }
        self.placed.push(rect);
        self.painter.rect_filled(rect, 3.0, visuals.panel_fill.gamma_multiply(0.85));
        self.painter.galley(rect.min + vec2(3.0, 0.0), galley, color);
        true
    }
}

/// Draws ground, marks and titles of the axes.
pub(super) fn paint_axes(
    ui: &Ui,
    painter: &Painter,
    map: &Map,
    drawn: &Drawn,
    plane: &Plane,
    quantity: Quantity,
) {
    let (visuals, rect) = (ui.visuals(), plane.rect);
    let (font, quiet) = (small(ui), visuals.weak_text_color());
    painter.rect_filled(rect, 0.0, visuals.extreme_bg_color);
    let words = |k: usize| map.axes().get(k).map(|axis| Words::of(axis.field));
    let tick = Stroke::new(1.0, theme::palette(visuals).edge);
    if let Some(words) = words(0) {
        let count = (rect.width() / 55.0) as usize;
        for mark in marks((words.display(plane.x.0), words.display(plane.x.1)), count) {
            let x = plane.at((words.value(mark), plane.y.0)).x;
            painter.vline(x, rect.bottom()..=rect.bottom() + 4.0, tick);
            let text = words.number(words.value(mark));
            painter.text(
                pos2(x, rect.bottom() + 5.0),
                Align2::CENTER_TOP,
                text,
                font.clone(),
                quiet,
            );
        }
        let at = pos2(rect.center().x, rect.bottom() + BOTTOM);
        painter.text(at, Align2::CENTER_BOTTOM, words.title(), font.clone(), visuals.text_color());
    }
    let count = (rect.height() / 40.0) as usize;
    let (texts, title): (Vec<(f64, String)>, String) = match words(1) {
        Some(words) => {
            let marks = marks((words.display(plane.y.0), words.display(plane.y.1)), count);
            let text = |mark: f64| (words.value(mark), words.number(words.value(mark)));
            (marks.into_iter().map(text).collect(), words.title())
        }
        None => {
            let marks = marks(plane.y, count);
            let text = |mark: f64| (mark, format_at_most(mark, 0, 6));
            let title = format!("{} ({})", tr(quantity.title()), drawn.scale.unit);
            (marks.into_iter().map(text).collect(), title)
        }
    };
    for (value, text) in texts {
        let y = plane.at((plane.x.0, value)).y;
        painter.hline(rect.left() - 4.0..=rect.left(), y, tick);
        painter.text(pos2(rect.left() - 6.0, y), Align2::RIGHT_CENTER, text, font.clone(), quiet);
    }
    let at = pos2(rect.left() - LEFT + SPACE, rect.top() - 5.0);
    painter.text(at, Align2::LEFT_BOTTOM, title, font, visuals.text_color());
}

/// Widths of bar, space and mark of the legend before its texts, and of the numbers before words beside them \[points\].
const BEFORE_TEXTS: f32 = 2.0 * SPACE + 19.0;
const NUMBERS: f32 = 22.0;
/// Least width of the legend on wide and on narrow charts \[points\], and its greatest share of the chart's width for its words \[-\].
const LEGEND: (f32, f32) = (112.0, 84.0);
const NARROW_CHART: f32 = 440.0;
const MOST_LEGEND: f32 = 0.24;

/// Width of the legend of a chart of a width \[points\].
pub(super) fn legend_width(ui: &Ui, scale: &Scale, width: f32) -> f32 {
    let of_word = |word: &str| {
        let color = ui.visuals().text_color();
        ui.painter().layout_no_wrap(word.to_owned(), small(ui), color).size().x
    };
    let words = scale.words().into_iter().map(|(_, word)| of_word(word)).fold(0.0, f32::max);
    let to_come = scale.words_to_come().iter().map(|word| of_word(tr(word))).fold(0.0, f32::max);
    let numbers = if scale.is_practice() { 0.0 } else { NUMBERS };
    let least = if width < NARROW_CHART { LEGEND.1 } else { LEGEND.0 };
    (BEFORE_TEXTS + (numbers + words).max(to_come) + 1.0).min(MOST_LEGEND * width).max(least)
}

/// Draws the bar of colours with numbers and words, whole ones only.
pub(super) fn paint_legend(ui: &Ui, painter: &Painter, drawn: &Drawn, rect: Rect, area: Rect) {
    let (visuals, scale) = (ui.visuals(), &drawn.scale);
    let (font, quiet) = (small(ui), visuals.weak_text_color());
    let bar = Rect::from_min_size(
        pos2(rect.right() + 2.0 * SPACE, rect.top()),
        vec2(14.0, rect.height()),
    );
    let bar = bar.with_max_y(bar.top() + bar.height().min(260.0));
    let (least, most) = scale.ends;
    let at = |value: f64| bar.bottom() - bar.height() * ((value - least) / (most - least)) as f32;
    const STRIPS: usize = 120;
    for k in 0..STRIPS {
        let value = |k: usize| least + (most - least) * k as f64 / STRIPS as f64;
        let strip = Rect::from_x_y_ranges(bar.x_range(), at(value(k + 1)) - 0.5..=at(value(k)));
        painter.rect_filled(strip, 0.0, scale.displayed(0.5 * (value(k) + value(k + 1))));
    }
    painter.rect_stroke(
        bar,
        0.0,
        Stroke::new(1.0, theme::palette(visuals).edge),
        StrokeKind::Outside,
    );
    let left = rect.right() + BEFORE_TEXTS;
    let unit = pos2(bar.left(), rect.top() - 5.0);
    painter.text(unit, Align2::LEFT_BOTTOM, scale.unit, font.clone(), quiet);
    // Words stand beside the numbers where there is room, else between them.
    let is_beside = area.right() - left > 70.0 && !scale.is_practice();
    let text = |taken: &mut Vec<f32>, y: f32, x: f32, text: &str, color: Color32| {
        let galley = painter.layout_no_wrap(text.to_owned(), font.clone(), color);
        let is_whole = x + galley.size().x <= area.right();
        if is_whole && taken.iter().all(|other| (other - y).abs() > 11.0) {
            painter.galley(pos2(x, y - 0.5 * galley.size().y), galley, color);
            taken.push(y);
        }
    };
    let words_left = left + if is_beside { NUMBERS } else { 0.0 };
    let mut taken = Vec::new();
    for (value, word) in scale.words() {
        text(&mut taken, at(value), words_left, word, visuals.text_color());
    }
    if is_beside {
        taken.clear();
    }
    for (value, number) in scale.marks() {
        painter.hline(bar.right()..=bar.right() + 3.0, at(value), Stroke::new(1.0, quiet));
        text(&mut taken, at(value), left, &number, quiet);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_words_of_the_present_implant_cover_no_other_text_where_there_is_room() {
        egui::__run_test_ui(|ui| {
            let at = pos2(200.0, 200.0);
            let beside = BESIDE.map(|(x, y)| at + vec2(x, y));
            let taken = |places: &[Pos2]| -> Vec<Rect> {
                places.iter().map(|at| Rect::from_center_size(*at, vec2(16.0, 16.0))).collect()
            };
            for count in 0..=2 {
                let (painter, placed) = (ui.painter(), taken(&beside[..count]));
                let mut labels = Labels { ui, painter, placed };
                labels.add_at_one_of("this plan", &beside);
                assert!((labels.placed[count].center() - beside[count]).length() < 1.0);
            }
            // A text on a line keeps off the dots of sizes.
            let line: Vec<Pos2> = (0..100).map(|k| pos2(50.0 + 4.0 * k as f32, 100.0)).collect();
            let dots: Vec<Rect> = [0, 150, 180, 210, 230, 250]
                .map(|x| Rect::from_center_size(pos2(x as f32, 100.0), vec2(7.0, 7.0)))
                .to_vec();
            let mut labels = Labels { ui, painter: ui.painter(), placed: dots.clone() };
            labels.add_along("+30 ml", &line, 5, true);
            let placed = labels.placed[dots.len()];
            assert!(dots.iter().all(|dot| !dot.intersects(placed)), "{placed}");
            // Without room the words stand at the best place.
            let mut labels = Labels { ui, painter: ui.painter(), placed: taken(&beside) };
            labels.add_at_one_of("this plan", &beside);
            assert!((labels.placed[0].center() - beside[0]).length() < 1.0);
        });
    }
}

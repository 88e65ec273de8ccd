//! The chart of the range of implants: one texture of colours, contour lines, lines of equal volume, typical sizes, the
//! present implant; a curve where one number varies. A pointer or the arrow keys choose a point.

use super::axes::Words;
use super::colours::{Scale, picture};
use super::plane::{Plane, marks, nearest};
use super::readout;
use crate::app::device::Device;
use crate::app::theme::{self, SPACE};
use crate::app::viewport::pointer_box;
use crate::app::widgets::{arrow_keys, set_accessible_name};
use crate::study::{Axis, Map, Quantity, Study};
use eframe::egui::{
    self, Align2, Color32, ColorImage, FontId, Key, Modifiers, Painter, Pos2, Rect, Response,
    Sense, Shape, Stroke, StrokeKind, TextStyle, TextureHandle, TextureOptions, Ui, pos2, vec2,
};
use web_time::{Duration, Instant};

/// The name of the chart for screen readers and tests.
pub(super) const NAME: &str = "Range of implants, chart";
/// Space around the plane: numbers of the axes, titles \[points\].
const LEFT: f32 = 40.0;
const TOP: f32 = 22.0;
const BOTTOM: f32 = 36.0;
/// Width of the legend on wide and on narrow charts \[points\].
const LEGEND: (f32, f32) = (112.0, 84.0);
const NARROW_CHART: f32 = 440.0;
/// A tap chooses a point, a click takes it: a finger cannot hover. A click this long after a touch is that of a mouse.
const TOUCH_TIME: Duration = Duration::from_millis(700);
/// Least time between two pictures of a chart that fills.
const REDRAW: Duration = Duration::from_millis(50);
/// Greatest number of values in the box at the pointer: the chart stays in sight.
const LINES: usize = 5;

/// Lines with the text at their middle.
type Labelled = Vec<(String, Vec<Vec<(f64, f64)>>)>;

/// What is drawn of a map until its values or its colours change.
struct Drawn {
    key: (u64, Quantity, bool),
    time: Instant,
    axes: Vec<Axis>,
    /// Is this the chart of the previous plan?
    is_previous: bool,
    texture: Option<TextureHandle>,
    scale: Scale,
    contours: Labelled,
    volumes: Labelled,
    sizes: Vec<(f64, f64)>,
}

/// State of the chart between frames.
#[derive(Default)]
pub(super) struct Chart {
    drawn: Option<Drawn>,
    /// The chosen point, and what has chosen it.
    cursor: Option<((usize, usize), Means)>,
    touched: Option<Instant>,
}

/// What chooses a point.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Means {
    Keys,
    Tap,
    Click,
}

impl Chart {
    /// Forgets the texture, which belongs to a lost context.
    pub(super) fn forget_texture(&mut self) {
        self.drawn = None;
    }

    /// Forgets the chosen point, which belongs to another map.
    pub(super) fn forget_cursor(&mut self) {
        self.cursor = None;
    }

    /// The point chosen by keys, while the chart has the keyboard focus, or by a tap.
    pub(super) fn cursor(&self) -> Option<(usize, usize)> {
        self.cursor.filter(|(_, means)| *means != Means::Click).map(|(point, _)| point)
    }

    /// Shows a map in the remaining space; returns the point of an implant to take. `revision` counts the changes of the
    /// map's values.
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        map: &Map,
        quantity: Quantity,
        revision: u64,
    ) -> Option<(usize, usize)> {
        let size = ui.available_size().max(vec2(160.0, 120.0));
        let (_, area) = ui.allocate_space(size);
        let legend = if area.width() < NARROW_CHART { LEGEND.1 } else { LEGEND.0 };
        let rect = Rect::from_min_max(area.min + vec2(LEFT, TOP), area.max - vec2(legend, BOTTOM));
        let id = ui.scope_id().with("range chart");
        let response = ui.interact(rect, id, Sense::click());
        self.update(ui, map, quantity, revision);
        let drawn = self.drawn.as_ref()?;
        let plane = plane(map, drawn, rect);
        let painter = ui.painter().with_clip_rect(area);
        paint_axes(ui, &painter, map, drawn, &plane, quantity);
        paint(ui, &painter.with_clip_rect(rect.expand(1.0)), map, drawn, &plane, quantity);
        paint_legend(ui, &painter, drawn, rect, area);
        let taken = self.choose(ui, &response, map, &plane);
        self.point(ui, &response, map, &plane, quantity);
        taken
    }

    /// Draws texture and lines anew after a change of values or colours.
    fn update(&mut self, ui: &Ui, map: &Map, quantity: Quantity, revision: u64) {
        let key = (revision, quantity, ui.visuals().dark_mode);
        if self.drawn.as_ref().is_some_and(|drawn| drawn.key == key) {
            return;
        }
        // While the chart fills, some pictures a second are enough.
        if let Some(drawn) = &self.drawn
            && (drawn.key.1, drawn.key.2) == (key.1, key.2)
            && !map.is_done()
            && drawn.axes == map.axes()
            && drawn.time.elapsed() < REDRAW
        {
            return;
        }
        // Before the first values of an edited plan the previous chart stays, faint.
        let range = map.range(quantity);
        if range.is_none()
            && let Some(drawn) = &mut self.drawn
            && drawn.axes == map.axes()
            && drawn.key.1 == quantity
        {
            drawn.is_previous = true;
            return;
        }
        let scale = Scale::new(quantity, range);
        let texture = (map.axes().len() == 2).then(|| {
            let stripes = theme::palette(ui.visuals()).edge;
            let image: ColorImage = picture(map, quantity, &scale, stripes);
            let kept = self.drawn.take().and_then(|drawn| drawn.texture);
            match kept {
                Some(mut texture) => {
                    texture.set(image, TextureOptions::LINEAR);
                    texture
                }
                None => ui.ctx().load_texture("range of implants", image, TextureOptions::LINEAR),
            }
        });
        let level = |level: f64| (readout::text(quantity, level), map.contours(quantity, level));
        let volume = |(ml, path): (f64, Vec<(f64, f64)>)| (format!("{ml:.0} ml"), vec![path]);
        // A map of the volume itself has its volumes as contour lines.
        let has_volumes = quantity != Quantity::ImplantVolumeMl;
        let volumes = if has_volumes { map.equal_volumes() } else { Vec::new() };
        self.drawn = Some(Drawn {
            key,
            time: Instant::now(),
            axes: map.axes().to_vec(),
            is_previous: false,
            texture,
            scale,
            contours: map.levels(quantity).into_iter().map(level).collect(),
            volumes: volumes.into_iter().map(volume).collect(),
            sizes: map.typical_sizes(),
        });
    }

    /// Moves the cursor by keys, chooses by a tap, takes by a click or the Enter key.
    fn choose(
        &mut self,
        ui: &Ui,
        response: &Response,
        map: &Map,
        plane: &Plane,
    ) -> Option<(usize, usize)> {
        let (columns, rows) = map.shape();
        if ui.input(|input| input.events.iter().any(|e| matches!(e, egui::Event::Touch { .. }))) {
            self.touched = Some(Instant::now());
        }
        let mut taken = None;
        let pointer = response.interact_pointer_pos();
        if response.clicked_by(egui::PointerButton::Primary)
            && let Some(pointer) = pointer
        {
            response.request_focus();
            let point = nearest_point(map, plane, pointer);
            if self.is_touch() {
                let is_again = self.cursor() == Some(point);
                self.cursor = (!is_again).then_some((point, Means::Tap));
            } else {
                self.cursor = Some((point, Means::Click));
                taken = Some(point);
            }
        } else if response.clicked() {
            // The Enter key.
            taken = self.cursor();
        }
        if response.has_focus() {
            ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrow_keys()));
            let count = |key| {
                ui.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key)) as isize
            };
            let right = count(Key::ArrowRight) - count(Key::ArrowLeft);
            let up = count(Key::ArrowUp) - count(Key::ArrowDown);
            if right != 0 || up != 0 {
                let moved = |k: usize, by: isize, n: usize| {
                    (k as isize + by).clamp(0, n as isize - 1) as usize
                };
                // From the present implant, or from the middle.
                let start = || {
                    let present = map.present().map(|[x, y]| plane.at((x, y)));
                    present.map_or((columns / 2, rows / 2), |at| nearest_point(map, plane, at))
                };
                let point = match self.cursor {
                    Some(((i, j), _)) => (moved(i, right, columns), moved(j, up, rows)),
                    None => start(),
                };
                self.cursor = Some((point, Means::Keys));
            }
        } else if self.cursor.is_some_and(|(_, means)| means == Means::Keys) {
            self.cursor = None;
        }
        taken
    }

    fn is_touch(&self) -> bool {
        self.touched.is_some_and(|touched| touched.elapsed() < TOUCH_TIME)
    }

    /// Marks the point at the pointer or the cursor, with its values.
    fn point(&self, ui: &Ui, response: &Response, map: &Map, plane: &Plane, quantity: Quantity) {
        let (columns, rows) = map.shape();
        let hovered = response.hover_pos().filter(|_| !self.is_touch());
        let hovered = hovered.map(|pointer| nearest_point(map, plane, pointer));
        let chosen = self.cursor().filter(|(i, j)| *i < columns && *j < rows);
        // A key counts until the pointer moves.
        let is_still = ui.input(|input| input.pointer.delta() == egui::Vec2::ZERO);
        let by_keys = chosen.filter(|_| is_still && response.has_focus());
        let shown = by_keys.or(hovered).or(chosen);
        let device = Device::of(ui.ctx());
        set_accessible_name(response, egui::Role::Canvas, &device.words(NAME));
        let sentence = shown.map_or_else(
            || device.words("Arrow keys choose an implant, Enter takes the implant."),
            |(i, j)| readout::sentence(map, i, j, quantity),
        );
        response.ctx.accesskit_node_builder(response.id, |node| node.set_value(sentence));
        let Some((i, j)) = shown else { return };
        let x = map.axes().first().map_or(0.0, |axis| axis.value(i));
        let y = match map.axes().get(1) {
            Some(axis) => axis.value(j),
            None => match map.displayed(quantity, i, j) {
                Some((value, _)) => value * quantity.display().0,
                None => plane.y.0,
            },
        };
        let at = plane.at((x, y));
        let painter = ui.painter();
        painter.circle_stroke(at, 6.0, Stroke::new(3.0, ui.visuals().panel_fill));
        painter.circle_stroke(at, 6.0, Stroke::new(1.5, theme::palette(ui.visuals()).text));
        let mut lines = readout::lines(map, i, j, quantity);
        let area = ui.max_rect();
        lines.truncate(LINES);
        lines.insert(0, readout::place(map, i, j));
        if hovered.is_some() && by_keys.is_none() {
            lines.push(device.words("Click takes this implant"));
        }
        pointer_box(ui, painter, area, at, &lines);
    }
}

/// The point of the map nearest to a point of the screen.
fn nearest_point(map: &Map, plane: &Plane, at: Pos2) -> (usize, usize) {
    let (columns, rows) = map.shape();
    let (x, y) = plane.values(at);
    let j = if rows > 1 { nearest(y, plane.y, rows) } else { 0 };
    (nearest(x, plane.x, columns), j)
}

/// The plane of a map; up stands the second axis, or the displayed quantity of a curve.
fn plane(map: &Map, drawn: &Drawn, rect: Rect) -> Plane {
    let range = |k: usize| map.axes().get(k).map(|axis| (axis.from, axis.to));
    let values = || {
        let (least, most) = drawn.scale.ends;
        let (factor, _) = drawn.key.1.display();
        let greatest = map.range(drawn.key.1).map_or(most, |(_, greatest)| factor * greatest);
        match drawn.scale.limits {
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

/// Draws colours, lines, sizes and the present implant.
fn paint(ui: &Ui, painter: &Painter, map: &Map, drawn: &Drawn, plane: &Plane, quantity: Quantity) {
    let palette = theme::palette(ui.visuals());
    let rect = plane.rect;
    let path =
        |points: &[(f64, f64)]| -> Vec<Pos2> { points.iter().map(|p| plane.at(*p)).collect() };
    let mut labels = Labels { ui, painter, placed: Vec::new() };
    if let Some(texture) = &drawn.texture {
        let all = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
        let mut mesh = egui::Mesh::with_texture(texture.id());
        let opacity = if drawn.is_previous { 0.5 } else { 1.0 };
        mesh.add_rect_with_uv(rect, all, Color32::WHITE.gamma_multiply(opacity));
        painter.add(Shape::mesh(mesh));
        let thin = Stroke::new(1.0, Color32::from_black_alpha(110));
        for line in &drawn.volumes {
            for points in &line.1 {
                painter.extend(Shape::dashed_line(&path(points), thin, 3.0, 4.0));
            }
        }
        for size in &drawn.sizes {
            let at = plane.at(*size);
            painter.circle(
                at,
                2.5,
                Color32::WHITE,
                Stroke::new(1.0, Color32::from_black_alpha(170)),
            );
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
        curve(ui, painter, map, drawn, plane, quantity);
    }
    present(ui, painter, map, plane, &mut labels);
    for (text, lines) in &drawn.contours {
        let longest = lines.iter().max_by_key(|line| line.len());
        if let Some(points) = longest {
            labels.add(text, plane.at(points[points.len() / 2]), true);
        }
    }
    for (text, lines) in &drawn.volumes {
        for points in lines {
            labels.add(text, plane.at(points[points.len() * 4 / 5]), false);
        }
    }
    painter.rect_stroke(rect, 0.0, Stroke::new(1.0, palette.edge), StrokeKind::Inside);
}

/// Draws a curve over one axis with the limits of its quantity.
fn curve(ui: &Ui, painter: &Painter, map: &Map, drawn: &Drawn, plane: &Plane, quantity: Quantity) {
    let palette = theme::palette(ui.visuals());
    let Some(axis) = map.axes().first() else { return };
    if drawn.scale.limits.is_some() {
        for (limit, _) in drawn.scale.marks() {
            let y = plane.at((axis.from, limit)).y;
            let ends = [pos2(plane.rect.left(), y), pos2(plane.rect.right(), y)];
            painter.extend(Shape::dashed_line(&ends, Stroke::new(1.0, palette.edge), 5.0, 4.0));
        }
    }
    let factor = quantity.display().0;
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

/// Marks the present implant.
fn present(ui: &Ui, painter: &Painter, map: &Map, plane: &Plane, labels: &mut Labels<'_>) {
    let palette = theme::palette(ui.visuals());
    let Some([x, y]) = map.present() else { return };
    if map.axes().len() == 1 {
        let at = plane.at((x, 0.0)).x;
        painter.vline(at, plane.rect.y_range(), Stroke::new(1.5, palette.accent));
        labels.add("present", pos2(at, plane.rect.top() + 10.0), true);
        return;
    }
    let at = plane.at((x, y));
    for (width, color) in [(5.0, palette.on_accent), (2.5, palette.accent)] {
        painter.circle_stroke(at, 8.0, Stroke::new(width, color));
    }
    painter.circle_filled(at, 2.5, palette.on_accent);
    labels.add("present", at + vec2(0.0, -18.0), true);
}

/// Texts on the chart; a text that would cover another one is left out.
struct Labels<'a> {
    ui: &'a Ui,
    painter: &'a Painter,
    placed: Vec<Rect>,
}

impl Labels<'_> {
    fn add(&mut self, text: &str, at: Pos2, is_strong: bool) {
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
            return;
        }
        self.placed.push(rect);
        self.painter.rect_filled(rect, 3.0, visuals.panel_fill.gamma_multiply(0.85));
        self.painter.galley(rect.min + vec2(3.0, 0.0), galley, color);
    }
}

/// Draws ground, marks and titles of the axes.
fn paint_axes(
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
            let text = |mark: f64| (mark, format!("{}", (mark * 1e6).round() / 1e6));
            let title = format!("{} ({})", readout::name(quantity), drawn.scale.unit);
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

/// Draws the bar of colours with numbers and words.
fn paint_legend(ui: &Ui, painter: &Painter, drawn: &Drawn, rect: Rect, area: Rect) {
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
    let left = bar.right() + 5.0;
    let unit = pos2(bar.left(), rect.top() - 5.0);
    painter.text(unit, Align2::LEFT_BOTTOM, scale.unit, font.clone(), quiet);
    // Words stand beside the numbers where there is room, else between them.
    let is_beside = area.right() - left > 70.0;
    let text = |taken: &mut Vec<f32>, y: f32, x: f32, text: &str, color: Color32| {
        if taken.iter().all(|other| (other - y).abs() > 11.0) {
            painter.text(pos2(x, y), Align2::LEFT_CENTER, text, font.clone(), color);
            taken.push(y);
        }
    };
    let words_left = left + if is_beside { 22.0 } else { 0.0 };
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

//! The chart of the range of implants: one texture of colours, contour lines, lines of equal volume, typical sizes, the
//! present implant; a curve where one number varies. A pointer or the arrow keys choose a point.

use super::areas::areas;
use super::colours::{Scale, picture};
use super::paint::{BOTTOM, Drawn, LEFT, legend_width, paint, paint_axes, paint_legend, plane};
use super::pins::Pins;
use super::plane::{Plane, nearest};
use super::readout;
use super::shelf::Sizes;
use crate::app::picture::viewport::pointer_box;
use crate::app::plan::device::Device;
use crate::app::texts::tr;
use crate::app::widgets::theme;
use crate::app::widgets::{arrow_keys, set_accessible_name};
use crate::study::{JudgedMap, Map, Quantity, Study};
use eframe::egui::{
    self, ColorImage, Key, Modifiers, Pos2, Rect, Response, Sense, Stroke, TextureOptions, Ui, vec2,
};
use web_time::{Duration, Instant};

/// The name of the chart for screen readers and tests.
pub(super) const NAME: &str = "Range of implants, chart";
const TOP: f32 = 22.0;
/// A tap chooses a point, a click takes it: a finger cannot hover. A click this long after a touch is that of a mouse.
const TOUCH_TIME: Duration = Duration::from_millis(700);
/// Least time between two pictures of a chart that fills.
const REDRAW: Duration = Duration::from_millis(50);

/// State of the chart between frames.
#[derive(Default)]
pub(super) struct Chart {
    drawn: Option<Drawn>,
    /// The chosen point, and what has chosen it.
    cursor: Option<((usize, usize), Means)>,
    touched: Option<Instant>,
    /// The point with its values in sight, or the last one.
    shown: Option<(usize, usize)>,
}

/// What the user takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Taken {
    /// The implant of a point of the map.
    Point((usize, usize)),
    /// A size of the shelf, by its index.
    Size(usize),
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
        self.shown = None;
    }

    /// The last point of the pointer or the keys.
    pub(super) fn shown(&self) -> Option<(usize, usize)> {
        self.shown
    }

    /// The point chosen by keys, while the chart has the keyboard focus, or by a tap.
    pub(super) fn cursor(&self) -> Option<(usize, usize)> {
        self.cursor.filter(|(_, means)| *means != Means::Click).map(|(point, _)| point)
    }

    /// Shows a map in the remaining space; returns the point of an implant to take. `revision` counts the changes of the
    /// map's values; `is_pending`: the words of the stretch are not known yet.
    pub(super) fn show(
        &mut self,
        ui: &mut Ui,
        (map, is_pending): (JudgedMap<'_>, bool),
        quantity: Quantity,
        revision: u64,
        (pins, sizes): (&Pins, &Sizes),
    ) -> Option<Taken> {
        let size = ui.available_size().max(vec2(160.0, 120.0));
        let (_, area) = ui.allocate_space(size);
        let has_words = !is_pending || quantity != Quantity::GreatestStrain;
        self.update(ui, (map, has_words), quantity, revision);
        let drawn = self.drawn.as_ref()?;
        let legend = legend_width(ui, &drawn.scale, area.width());
        let rect = Rect::from_min_max(area.min + vec2(LEFT, TOP), area.max - vec2(legend, BOTTOM));
        let id = ui.scope_id().with("range chart");
        let response = ui.interact(rect, id, Sense::click());
        let plane = plane(&map, drawn, rect);
        let painter = ui.painter().with_clip_rect(area);
        paint_axes(ui, &painter, &map, drawn, &plane, quantity);
        let inside = painter.with_clip_rect(rect.expand(1.0));
        let marks = pins.marks(&plane).into_iter().chain(sizes.marks(&plane)).collect();
        paint(ui, &inside, map, drawn, &plane, (sizes.is_in_use(), marks));
        if map.axes().len() == 2 {
            sizes.paint(&inside, &plane);
        }
        pins.show(ui, &plane);
        paint_legend(ui, &painter, drawn, rect, area);
        let taken = self.choose(ui, &response, &map, &plane, sizes);
        self.point(ui, &response, map, (&plane, quantity), (pins, sizes));
        taken
    }

    /// Draws texture and lines anew after a change of values or colours.
    fn update(
        &mut self,
        ui: &Ui,
        (map, has_words): (JudgedMap<'_>, bool),
        quantity: Quantity,
        revision: u64,
    ) {
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
        let scale = match has_words {
            true => Scale::new(quantity, map.limits(quantity), range),
            false => Scale::waiting(quantity, range),
        };
        let levels = if has_words { map.levels(quantity) } else { Vec::new() };
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
        let level = |level: f64| (scale.text(level), map.contours(quantity, level));
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
            contours: levels.into_iter().map(level).collect(),
            scale,
            volumes: volumes.into_iter().map(volume).collect(),
            sizes: map.typical_sizes(),
            areas: if has_words { areas(map, quantity) } else { Vec::new() },
        });
    }

    /// Moves the cursor by keys, chooses by a tap, takes by a click or the Enter key.
    fn choose(
        &mut self,
        ui: &Ui,
        response: &Response,
        map: &Map,
        plane: &Plane,
        sizes: &Sizes,
    ) -> Option<Taken> {
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
            if let Some(index) = sizes.at(plane, pointer) {
                self.cursor = None;
                taken = Some(Taken::Size(index));
            } else if self.is_touch() {
                let is_again = self.cursor() == Some(point);
                self.cursor = (!is_again).then_some((point, Means::Tap));
            } else {
                self.cursor = Some((point, Means::Click));
                taken = Some(Taken::Point(point));
            }
        } else if response.clicked() {
            // The Enter key.
            taken = self.cursor().map(Taken::Point);
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
                // The first press chooses the start; a slow frame has further ones.
                let ((i, j), [right, up]) = match self.cursor {
                    Some((point, _)) => (point, [right, up]),
                    None if right != 0 => (start(), [right - right.signum(), up]),
                    None => (start(), [0, up - up.signum()]),
                };
                let point = (moved(i, right, columns), moved(j, up, rows));
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
    fn point(
        &mut self,
        ui: &Ui,
        response: &Response,
        map: JudgedMap<'_>,
        (plane, quantity): (&Plane, Quantity),
        (pins, sizes): (&Pins, &Sizes),
    ) {
        let (columns, rows) = map.shape();
        let hovered = response.hover_pos().filter(|_| !self.is_touch());
        let hovered = hovered.map(|pointer| nearest_point(&map, plane, pointer));
        let chosen = self.cursor().filter(|(i, j)| *i < columns && *j < rows);
        // A key counts until the pointer moves.
        let is_still = ui.input(|input| input.pointer.delta() == egui::Vec2::ZERO);
        let by_keys = chosen.filter(|_| is_still && response.has_focus());
        let shown = by_keys.or(hovered).or(chosen);
        self.shown = shown.or(self.cursor.map(|(point, _)| point)).or(self.shown);
        let device = Device::of(ui.ctx());
        set_accessible_name(response, egui::Role::Canvas, &device.words(tr(NAME)));
        let sentence = shown.map_or_else(
            || device.words(tr("Arrow keys choose an implant, Enter takes the implant.")),
            |(i, j)| readout::sentence(map, i, j, quantity),
        );
        response.ctx.accesskit_node_builder(response.id, |node| node.set_value(sentence));
        let Some((i, j)) = shown else { return };
        let pointer = response.hover_pos();
        let size = pointer.and_then(|pointer| sizes.at(plane, pointer));
        if let Some(index) = size.filter(|_| by_keys.is_none())
            && let Some((at, mut lines)) = sizes.readout(map, plane, index)
        {
            response
                .ctx
                .accesskit_node_builder(response.id, |node| node.set_value(lines.join("; ")));
            ring(ui, at);
            lines.push(tr("Click takes this size").to_owned());
            pointer_box(ui, ui.painter(), ui.max_rect(), at, &lines, &sizes.marks(plane));
            return;
        }
        let x = map.axes().first().map_or(0.0, |axis| axis.value(i));
        let y = match map.axes().get(1) {
            Some(axis) => axis.value(j),
            None => match map.displayed(quantity, i, j) {
                Some((value, _)) => value * quantity.display().0,
                None => plane.y.0,
            },
        };
        let at = plane.at((x, y));
        ring(ui, at);
        let mut lines = readout::short(map, i, j, quantity);
        let pin = pointer.and_then(|pointer| pins.at(plane, pointer));
        if let Some(pin) = pin.filter(|_| by_keys.is_none()) {
            lines = vec![pin.to_owned()];
        } else if hovered.is_some() && by_keys.is_none() {
            lines.push(device.words(tr("Click takes this implant")));
        }
        pointer_box(ui, ui.painter(), ui.max_rect(), at, &lines, &[]);
    }
}

/// A ring around the point whose values are shown.
fn ring(ui: &Ui, at: Pos2) {
    ui.painter().circle_stroke(at, 6.0, Stroke::new(3.0, ui.visuals().panel_fill));
    ui.painter().circle_stroke(at, 6.0, Stroke::new(1.5, theme::palette(ui.visuals()).text));
}

/// The point of the map nearest to a point of the screen.
fn nearest_point(map: &Map, plane: &Plane, at: Pos2) -> (usize, usize) {
    let (columns, rows) = map.shape();
    let (x, y) = plane.values(at);
    let j = if rows > 1 { nearest(y, plane.y, rows) } else { 0 };
    (nearest(x, plane.x, columns), j)
}

//! Pictures of the current scene and of the pins side by side, with one camera, each skin in the colours of its limits.

use super::marks::Marked;
use super::{
    CURRENT, Drawn, Shown, Viewport, colouring, legend, of_legend, overlay, range_of, section_of,
};
use crate::app::answer::differing;
use crate::app::plan::device::Device;
use crate::app::plan::when;
use crate::app::texts::{self, tr};
use crate::app::widgets::keep_press;
use crate::scene::Scene;
use crate::session::{Pin, Session};
use crate::solve::Problem;
use crate::study::{SectionBand, name_in_words};
use crate::view::camera::Ball;
use crate::view::color::Rgb;
use crate::view::picture::Picture;
use crate::view::quantity::Quantity;
use crate::view::section::Section;
use crate::view::side_by_side::{Colours, Limited};
use crate::view::subject::{PinnedShape, Subject};
use crate::view::torso::Torso;
use crate::view::wall;
use eframe::egui::{self, Id, Rect, Response, Sense, StrokeKind, Ui, WidgetInfo, pos2, vec2};
use std::rc::Rc;
use std::sync::Arc;

/// Space between two pictures \[points\].
const GAP: f32 = 2.0;

/// The picture of a pin.
pub(super) struct Pane {
    /// The pin's number.
    number: u64,
    pub(super) picture: Picture,
}

/// The colours of all pictures, and their numbers.
struct Common<'a> {
    colours: Colours,
    numbers: Arc<[u64]>,
    shown: Shown<'a>,
}

/// One of the pictures, with words at its top and lines over its skin.
struct Cell<'a> {
    number: u64,
    picture: &'a Picture,
    scene: &'a Scene,
    problem: &'a Problem,
    area: Rect,
    caption: String,
    envelope: &'a [SectionBand],
}

impl Viewport {
    /// Shows the pins with a shape and the session side by side in the remaining space.
    pub(crate) fn show_side_by_side(&mut self, ui: &mut Ui, shown: Shown<'_>) {
        let Shown { session, options, practices, envelope, bar, is_on_paper, .. } = shown;
        self.leave_scan();
        let (_, area) = ui.allocate_space(ui.available_size().max(egui::Vec2::splat(1.0)));
        let [area, strip] = shown.parted(area);
        let is_shown = |pin: &&Pin| !(is_on_paper && pin.scene().is_same_plan(session.scene()));
        let pins: Vec<PinnedShape<'_>> =
            session.pins().iter().filter(is_shown).filter_map(PinnedShape::of).collect();
        // The cells without a picture.
        overlay::background(ui, &ui.painter_at(area), area);
        self.keep_panes(&pins);
        // Below the controls of the picture.
        // The legend of all pictures has a strip of its own: no tissue is below it.
        let has_legend = options.quantity != Quantity::Tissue;
        let top = area.top() + bar + if has_legend { legend::STRIP } else { 0.0 };
        let areas = divided(area.with_min_y(top), pins.len() + 1);
        let Some((&own_area, pin_areas)) = areas.split_last() else { return };
        let ball = self.ball_to_fit(session);
        if self.fitted.is_some_and(|(fitted, _)| fitted.radius_mm < ball.radius_mm) {
            self.is_placed = false;
        }
        let torso = self.torso(options, session.scene());
        let aspect = own_area.width() / own_area.height();
        self.place_camera(ball, aspect, torso.as_deref(), shown.standing);

        let own = self.interact(ui, own_area);
        let responses: Vec<Response> =
            pins.iter().zip(pin_areas).map(|(shape, area)| pane(ui, shape.pin, *area)).collect();
        // One camera: a drag in any picture moves all of them.
        let mut moved = false;
        let scenes = pins.iter().map(Subject::scene).chain([session.scene()]);
        for (response, scene) in responses.iter().chain([&own]).zip(scenes) {
            self.camera.mirror(scene.is_right());
            moved |= self.move_camera(ui, response, response.rect);
        }
        let up_to_date = self.update_pictures(session, &pins, shown);
        if moved || self.camera.is_easing() || !up_to_date {
            ui.ctx().request_repaint();
        }
        let numbers = self.panes.iter().map(|pane| pane.number).chain([CURRENT]).collect();
        let common = Common { colours: self.common_colours(&pins, shown), numbers, shown };
        let captions = captions(ui, &pins, session);
        let mut clicked = None;
        for ((pane, shape), response) in self.panes.iter().zip(&pins).zip(&responses) {
            self.camera.mirror(shape.scene().is_right());
            let cell = Cell {
                number: pane.number,
                picture: &pane.picture,
                scene: shape.scene(),
                problem: shape.problem(),
                area: response.rect,
                caption: captions(title(shape.pin), shape.scene()),
                envelope: &[],
            };
            let section = self.draw_cell(ui, &cell, &common);
            let marked = Marked { picture: &pane.picture, subject: shape, section, taken: &[] };
            clicked = clicked.or(self.show_marks(ui, response, &marked));
        }
        let line = ui.visuals().widgets.noninteractive.bg_stroke;
        for area in &areas {
            ui.painter().rect_stroke(*area, 0.0, line, StrokeKind::Outside);
        }
        self.camera.mirror(session.scene().is_right());
        let title = tr!("this plan · {size}", size = texts::shown(&name_in_words(session.scene())));
        let cell = Cell {
            number: CURRENT,
            picture: &self.picture,
            scene: session.scene(),
            problem: Subject::problem(session),
            area: own_area,
            caption: captions(title, session.scene()),
            envelope,
        };
        let section = self.draw_cell(ui, &cell, &common);
        if let Colours::Common(Some(scale)) | Colours::Own(Some(scale)) = &common.colours {
            let strip = area.with_min_y(area.top() + bar);
            let scale = of_legend(scale, session.scene(), practices);
            legend::strip(ui, &ui.painter_at(strip), strip, &scale);
        }
        let bar = self.show_scale(ui, own_area, strip);
        self.handles = Some(ui.painter_at(own_area).add(egui::Shape::Noop));
        let marked = Marked { picture: &self.picture, subject: session, section, taken: &[bar] };
        let clicked = clicked.or(self.show_marks(ui, &own, &marked));
        self.click(clicked);
    }

    /// The colours of the session and of the pins, and the table of those that all have in common.
    fn common_colours(&mut self, pins: &[PinnedShape<'_>], shown: Shown<'_>) -> Colours {
        let Shown { session, options, practices, .. } = shown;
        let limited = |picture: &Picture, scene: &Scene, problem: &Problem| Limited {
            greatest: picture.greatest,
            skin: practices.skin(scene, problem.skin_knee()),
        };
        let own = limited(&self.picture, session.scene(), Subject::problem(session));
        let panes = self.panes.iter().zip(pins);
        let limits =
            panes.map(|(pane, shape)| limited(&pane.picture, shape.scene(), shape.problem()));
        let limits: Vec<Limited> = limits.chain([own]).collect();
        let colours = Colours::new(options.quantity, &limits, &session.scene().layers);
        if let Colours::Common(scale) = &colours {
            let table = scale.as_ref().map_or(&[[1.0; 3]][..], |scale| &scale.table);
            if self.common_table.as_slice() != table {
                self.common_table = Arc::new(table.to_vec());
            }
        }
        colours
    }

    /// Draws one of the pictures, with its caption and, without colours in common, its legend. Returns its cut.
    fn draw_cell(
        &self,
        ui: &Ui,
        cell: &Cell<'_>,
        Common { colours, numbers, shown }: &Common<'_>,
    ) -> Section {
        let &Cell { number, picture, scene, problem, area, ref caption, envelope } = cell;
        let painter = ui.painter_at(area);
        overlay::background(ui, &painter, area);
        let table = colours_of(&self.common_table, colours, picture);
        let drawn = Drawn::of(number, Arc::clone(numbers), picture, table, problem, shown.options);
        let section = drawn.section;
        self.draw(ui, &painter, area, drawn);
        self.draw_envelope(ui, &painter, area, (scene, section), envelope);
        overlay::caption(ui, &painter, area, caption);
        if let (Colours::Own(None), Some(scale)) = (colours, &picture.scale) {
            let scale = of_legend(scale, scene, shown.practices);
            legend::strip(ui, &painter, area.with_min_y(area.top() + overlay::CAPTION), &scale);
        }
        section
    }

    /// The ball around the bodies of the session and of the pins beside it.
    pub(super) fn ball_to_fit(&self, session: &Session) -> Ball {
        let is_beside = |pin: &&Pin| self.panes.iter().any(|pane| pane.number == pin.number());
        let pins = session.pins().iter().filter(is_beside).filter_map(Pin::solution);
        let problems = pins.map(|solution| solution.problem()).chain([session.problem()]);
        problems.map(wall::ball).fold(Ball::default(), |all, ball| Ball {
            radius_mm: all.radius_mm.max(ball.radius_mm),
            middle_mm: all.middle_mm.min(ball.middle_mm),
        })
    }

    /// Drops the pictures of other pins and adds the missing ones, in the order of the pins.
    fn keep_panes(&mut self, pins: &[PinnedShape<'_>]) {
        let mut before = std::mem::take(&mut self.panes);
        self.panes = pins
            .iter()
            .map(|shape| {
                let number = shape.pin.number();
                let known = before.iter().position(|pane| pane.number == number);
                known.map_or_else(
                    || Pane { number, picture: Picture::default() },
                    |k| before.swap_remove(k),
                )
            })
            .collect();
    }

    /// Updates all pictures; returns whether they are current.
    fn update_pictures(
        &mut self,
        session: &Session,
        pins: &[PinnedShape<'_>],
        Shown { options, practices, .. }: Shown<'_>,
    ) -> bool {
        let start = self.start;
        let clock = || start.elapsed().as_secs_f64();
        let bodies: Vec<Option<Rc<Torso>>> = pins
            .iter()
            .map(Subject::scene)
            // A pin has no body of its own: on the same wall it is the present one.
            .map(|scene| if scene.is_on_wall_of(session.scene()) { session.scene() } else { scene })
            .map(|scene| self.torso(options, scene))
            .collect();
        for ((pane, shape), body) in self.panes.iter_mut().zip(pins).zip(&bodies) {
            // A quantity of layered tissue has no values in a sheet.
            let is_known = options.quantity.is_of(shape.scene());
            let quantity = if is_known { options.quantity } else { Quantity::Tissue };
            let section = section_of(options, shape.problem());
            let colouring = colouring(shape, quantity, practices);
            pane.picture.update(shape, colouring, section, &clock);
            pane.picture.update_torso(shape, body.as_ref());
        }
        let torso = self.torso(options, session.scene());
        let section = section_of(options, Subject::problem(session));
        let colouring = colouring(session, options.quantity, practices);
        let up_to_date = self.picture.update(session, colouring, section, &clock);
        self.picture.update_torso(session, torso.as_ref());
        up_to_date
    }
}

/// Colours of a picture and the field values at their ends.
fn colours_of<'a>(
    common_table: &'a Arc<Vec<Rgb>>,
    colours: &Colours,
    picture: &'a Picture,
) -> (&'a Arc<Vec<Rgb>>, [f32; 2]) {
    match colours {
        Colours::Common(scale) => (common_table, range_of(scale.as_ref())),
        Colours::Own(_) => (&picture.table, range_of(picture.scale.as_ref())),
    }
}

/// The widget of a pin's picture.
fn pane(ui: &Ui, pin: &Pin, area: Rect) -> Response {
    let id: Id = ui.scope_id().with(("3-D view", pin.number()));
    // Without focus: the keys act on the picture of the current scene.
    let response = ui.interact(area, id, Sense::CLICK | Sense::DRAG);
    keep_press(&response);
    let name = tr!("3-D view of {letter}", letter = pin.letter());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Canvas, true, &name));
    response
}

/// The caption of a scene with a title: the time, if any has one, and what differs beside the size in a line below.
fn captions(
    ui: &Ui,
    pins: &[PinnedShape<'_>],
    session: &Session,
) -> impl Fn(String, &Scene) -> String {
    let differs = differing::in_words(session, Device::of(ui.ctx()));
    let mut scenes = pins.iter().map(Subject::scene).chain([session.scene()]);
    let has_times = scenes.any(when::has_state);
    move |title, scene| {
        let title = match has_times.then(|| when::time_in_words(scene)) {
            Some(time) => format!("{title} · {}", time.to_lowercase()),
            None => title,
        };
        match differs(scene) {
            words if words.is_empty() => title,
            words => format!("{title}\n{words}"),
        }
    }
}

/// Letter of a pin with its name, or with its size.
fn title(pin: &Pin) -> String {
    let words = if pin.name().is_empty() {
        texts::shown(&name_in_words(pin.scene()))
    } else {
        pin.name().to_owned()
    };
    format!("{} · {words}", pin.letter())
}

/// Divides an area into rows and columns of equal areas, as near to squares as possible: two areas are side by side where the
/// area is wider than high.
fn divided(area: Rect, count: usize) -> Vec<Rect> {
    let fit = |columns: &usize| {
        let (columns, rows) = (*columns as f32, count.div_ceil(*columns) as f32);
        (area.width() / columns).min(area.height() / rows)
    };
    let columns = (1..=count).max_by(|a, b| fit(a).total_cmp(&fit(b))).unwrap_or(1);
    let rows = count.div_ceil(columns);
    let size = vec2(
        (area.width() - GAP * (columns - 1) as f32) / columns as f32,
        (area.height() - GAP * (rows - 1) as f32) / rows as f32,
    );
    let at = |k: usize| {
        let (column, row) = ((k % columns) as f32, (k / columns) as f32);
        pos2(area.left() + column * (size.x + GAP), area.top() + row * (size.y + GAP))
    };
    (0..count).map(|k| Rect::from_min_size(at(k), size.max(vec2(1.0, 1.0)))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_share_the_area_without_overlap_in_equal_sizes() {
        for (width, height) in [(700.0, 600.0), (390.0, 400.0), (1400.0, 500.0)] {
            let area = Rect::from_min_size(pos2(10.0, 20.0), vec2(width, height));
            for count in 1..=5 {
                let areas = divided(area, count);
                assert_eq!(areas.len(), count);
                for (k, one) in areas.iter().enumerate() {
                    assert!(area.expand(0.01).contains_rect(*one));
                    assert!((one.size() - areas[0].size()).length() < 1e-3);
                    assert!(areas[..k].iter().all(|other| !other.shrink(0.01).intersects(*one)));
                }
            }
        }
        let side_by_side = divided(Rect::from_min_size(pos2(0.0, 0.0), vec2(700.0, 400.0)), 2);
        assert!((side_by_side[0].top() - side_by_side[1].top()).abs() < 1e-3);
        let nearly_square = divided(Rect::from_min_size(pos2(0.0, 0.0), vec2(640.0, 600.0)), 2);
        assert!((nearly_square[0].top() - nearly_square[1].top()).abs() < 1e-3);
        let stacked = divided(Rect::from_min_size(pos2(0.0, 0.0), vec2(390.0, 420.0)), 2);
        assert!((stacked[0].left() - stacked[1].left()).abs() < 1e-3);
    }
}

//! The body of a scan with its marks: turned by a drag beside them, the marks moved along the skin by pointer and keys.

use super::renderer::Areola;
use super::{Drawn, Viewport, overlay};
use crate::app::widgets::{arrow_keys, theme};
use crate::session::Session;
use crate::view::camera::{Ray, Standing};
use crate::view::section::{Opening, Section};
use crate::view::torso::Torso;
use eframe::egui::{
    self, Align2, Color32, Key, Modifiers, Pos2, Rect, Sense, Stroke, Ui, WidgetInfo,
};
use glam::{Vec2, Vec3};
use std::rc::Rc;
use std::sync::Arc;

/// Number of the picture; those of pins count from 1.
const SCAN: u64 = u64::MAX;
/// Radius of a dot, and of what takes a pointer for it \[points\].
const DOT: f32 = 5.0;
const REACH: f32 = 15.0;
/// Steps of the arrow keys \[mm\]; a key without Shift counts those with it, which are taken first.
const STEPS: [(Modifiers, f32); 2] = [(Modifiers::SHIFT, 10.0), (Modifiers::NONE, 1.0)];
/// Depth up to which a mark is in sight \[mm\].
const IN_SIGHT_MM: f32 = 4.0;
/// Turns of the body from the front, in the order in which they are tried for a mark that is out of sight \[°\].
const TURNS: [f32; 5] = [0.0, 40.0, -40.0, 80.0, -80.0];

/// The body of a scan that was shown last.
pub(super) struct Scanned {
    pub(super) torso: Rc<Torso>,
    /// Eye and place of each dot, and whether it is in sight.
    seen: Vec<([Vec3; 2], bool)>,
    /// Name of the mark in use.
    chosen: Option<&'static str>,
    /// Has its dot yet to get the focus? The click that chose the mark takes it from all that is not clicked.
    is_to_focus: bool,
}

/// A mark in the picture.
pub(crate) struct Dot {
    /// Place in the coordinates of the drawn body \[mm\].
    pub(crate) at: Vec3,
    pub(crate) name: &'static str,
    /// A word beside the dot.
    pub(crate) label: &'static str,
    /// Is this the mark of the panel's row in use?
    pub(crate) is_chosen: bool,
}

/// What the user did to a mark; places in the coordinates of the drawn body \[mm\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Touched {
    /// A click on the skin beside the dots.
    Skin(Vec3),
    /// A dot was clicked, or has got the focus.
    Chosen(usize),
    /// A dot was moved: its number, the new place, and whether that begins a movement.
    Moved(usize, Vec3, bool),
}

impl Viewport {
    /// Shows the body of a scan from the front at first, and its marks.
    pub(crate) fn show_scan(
        &mut self,
        ui: &mut Ui,
        session: &Session,
        torso: &Rc<Torso>,
        dots: &[Dot],
    ) -> Option<Touched> {
        let (_, area) = ui.allocate_space(ui.available_size().max(egui::Vec2::splat(1.0)));
        let response = self.interact(ui, area);
        let aspect = area.width() / area.height();
        let is_new = self.scanned.as_ref().is_none_or(|known| !Rc::ptr_eq(&known.torso, torso));
        if is_new || (aspect - self.aspect).abs() > 1e-4 {
            self.camera = super::torso::standing(torso, aspect, Standing::Front);
            let chosen = chosen(dots).map(|dot| dot.name);
            let scanned =
                Scanned { torso: Rc::clone(torso), seen: Vec::new(), chosen, is_to_focus: false };
            (self.aspect, self.scanned) = (aspect, Some(scanned));
        }
        self.camera.mirror(false);
        self.face_chosen(torso, dots);
        let takes_focus = self.takes_focus(ui);
        if self.move_camera(ui, &response, area) {
            ui.ctx().request_repaint();
        }
        let painter = ui.painter_at(area);
        overlay::background(ui, &painter, area);
        let none = Arc::default;
        let drawn = Drawn {
            number: SCAN,
            numbers: Arc::new([SCAN]),
            meshes: [none(), none(), none(), none(), Arc::clone(torso.before())],
            nodes_per_side: 0,
            table: &self.picture.table,
            range: [0.0, 1.0],
            problem: session.problem(),
            section: Section { opening: Opening::Closed, angle: 0.0, axis: Vec2::ZERO },
            net: false,
            areola: Areola::Hidden,
            pocket_line: false,
            end: None,
        };
        self.draw(ui, &painter, area, drawn);
        overlay::scale_bar(ui, &painter, area, self.points_per_mm(area));
        let mut touched = None;
        for (k, dot) in dots.iter().enumerate() {
            let is_in_sight = self.is_in_sight(torso, (k, dot.at));
            let of = (is_in_sight, takes_focus && dot.is_chosen);
            touched = self.dot(ui, area, torso, (k, dot), of).or(touched);
        }
        if touched.is_none() && response.clicked() {
            let at = response.interact_pointer_pos()?;
            touched = self.on_skin(area, torso, at).map(Touched::Skin);
        }
        touched
    }

    /// The next picture of a plan begins with its own view.
    pub(super) fn leave_scan(&mut self) {
        if self.scanned.take().is_some() {
            (self.is_placed, self.fitted) = (false, None);
        }
    }

    /// The point of the skin under a point of the screen.
    fn on_skin(&self, area: Rect, torso: &Torso, at: Pos2) -> Option<Vec3> {
        torso.picked(&self.camera.ray(super::moves::viewport_point(area, at), self.aspect))
    }

    /// Turns the body when a mark comes into use that is out of sight.
    fn face_chosen(&mut self, torso: &Torso, dots: &[Dot]) {
        let chosen = chosen(dots);
        let Some(scanned) = &mut self.scanned else { return };
        let before = std::mem::replace(&mut scanned.chosen, chosen.map(|dot| dot.name));
        let Some(at) = chosen.filter(|dot| before != Some(dot.name)).map(|dot| dot.at) else {
            return;
        };
        scanned.is_to_focus = true;
        if sees(torso, self.camera.eye(), at) {
            return;
        }
        let front = super::torso::standing(torso, self.aspect, Standing::Front);
        let mut turned = TURNS.map(|degrees| front.turned_by(degrees.to_radians())).into_iter();
        if let Some(camera) = turned.find(|camera| sees(torso, camera.eye(), at)) {
            self.camera = camera;
        }
    }

    /// Does the dot of the mark in use get the focus in this frame?
    fn takes_focus(&mut self, ui: &Ui) -> bool {
        let Some(scanned) = self.scanned.as_mut().filter(|scanned| scanned.is_to_focus) else {
            return false;
        };
        ui.ctx().request_repaint();
        scanned.is_to_focus = ui.input(|input| input.pointer.any_released());
        !scanned.is_to_focus
    }

    /// Is a dot on the side of the body towards the eye? Found once for a place and an eye.
    fn is_in_sight(&mut self, torso: &Torso, (k, at): (usize, Vec3)) -> bool {
        let eye = self.camera.eye();
        let known = self.scanned.as_ref().and_then(|scanned| scanned.seen.get(k));
        if let Some((_, is)) = known.filter(|(of, _)| *of == [eye, at]) {
            return *is;
        }
        let is = sees(torso, eye, at);
        if let Some(Scanned { seen, .. }) = &mut self.scanned {
            seen.resize(seen.len().max(k + 1), ([Vec3::NAN; 2], true));
            seen[k] = ([eye, at], is);
        }
        is
    }

    fn dot(
        &self,
        ui: &Ui,
        area: Rect,
        torso: &Torso,
        (k, dot): (usize, &Dot),
        (is_in_sight, takes_focus): (bool, bool),
    ) -> Option<Touched> {
        let at = self.point(dot.at, area).filter(|at| area.contains(*at))?;
        let id = ui.scope_id().with(("mark", k));
        let around = Rect::from_center_size(at, egui::Vec2::splat(2.0 * REACH));
        let response = ui.interact(around, id, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Button, true, dot.name));
        paint(ui, area, at, dot, (response.has_focus(), is_in_sight));
        if takes_focus || response.clicked() || response.drag_started() {
            response.request_focus();
        }
        if response.dragged() || response.drag_started() {
            let pointer = response.interact_pointer_pos()?;
            let place = self.on_skin(area, torso, pointer)?;
            return Some(Touched::Moved(k, place, response.drag_started()));
        }
        if response.has_focus() {
            ui.memory_mut(|memory| memory.set_focus_lock_filter(id, arrow_keys()));
            if let Some(place) = self.stepped(ui, torso, dot.at) {
                return Some(Touched::Moved(k, place, true));
            }
        }
        (response.clicked() || response.gained_focus()).then_some(Touched::Chosen(k))
    }

    /// A place moved along the skin by the arrow keys pressed since the previous frame.
    fn stepped(&self, ui: &Ui, torso: &Torso, from: Vec3) -> Option<Vec3> {
        let (right, up) = self.camera.right_and_up();
        let mut by = Vec3::ZERO;
        ui.input_mut(|input| {
            for (modifiers, step) in STEPS {
                for (key, way) in [
                    (Key::ArrowLeft, -right),
                    (Key::ArrowRight, right),
                    (Key::ArrowUp, up),
                    (Key::ArrowDown, -up),
                ] {
                    by += way * step * input.count_and_consume_key(modifiers, key) as f32;
                }
            }
        });
        if by == Vec3::ZERO {
            return None;
        }
        let at = self.camera.project(from + by, self.aspect)?;
        torso.picked(&self.camera.ray(at, self.aspect))
    }
}

/// The mark in use, once it is set.
fn chosen(dots: &[Dot]) -> Option<&Dot> {
    dots.iter().find(|dot| dot.is_chosen)
}

/// Is a place of the skin on the side of the body towards the eye?
fn sees(torso: &Torso, eye: Vec3, at: Vec3) -> bool {
    let ray = Ray { origin: eye, direction: (at - eye).normalize_or(Vec3::NEG_Z) };
    let seen = torso.picked(&ray);
    seen.is_none_or(|seen| eye.distance(at) < eye.distance(seen) + IN_SIGHT_MM)
}

/// Paints a dot with its word; paler where the body hides the mark.
fn paint(ui: &Ui, area: Rect, at: Pos2, dot: &Dot, (has_focus, in_sight): (bool, bool)) {
    let painter = ui.painter_at(area);
    let palette = theme::palette(ui.visuals());
    let alpha = if in_sight { 1.0 } else { 0.35 };
    let fill = if dot.is_chosen || has_focus { palette.accent } else { Color32::WHITE };
    let edge = Stroke::new(1.5, Color32::from_black_alpha(200).gamma_multiply(alpha));
    painter.circle(at, DOT, fill.gamma_multiply(alpha), edge);
    if has_focus {
        painter.circle_stroke(at, DOT + 3.5, Stroke::new(2.0, palette.accent));
    }
    let font = egui::TextStyle::Small.resolve(ui.style());
    let place = at + egui::vec2(DOT + 4.0, 0.0);
    let text = painter.layout_no_wrap(dot.label.to_owned(), font, Color32::WHITE);
    let is_right = place.x + text.size().x > area.right();
    let anchor = if is_right { Align2::RIGHT_CENTER } else { Align2::LEFT_CENTER };
    let place = if is_right { at - egui::vec2(DOT + 4.0, 0.0) } else { place };
    let ground = anchor.anchor_size(place, text.size());
    let shade = Color32::from_black_alpha(150).gamma_multiply(alpha);
    painter.rect_filled(ground.expand2(egui::vec2(3.0, 1.0)), 3.0, shade);
    painter.galley(ground.min, text, Color32::WHITE.gamma_multiply(alpha));
}

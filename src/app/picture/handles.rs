//! Handles on the picture, over the implant's highest point: drags move the implant in its pocket and change its projection.
//!
//! Uses `plan`, `theme`, `viewport`, `widgets`. Used by `logic`, `ui`.

use super::viewport::{Viewport, labelled_box};
use crate::app::plan::device::Device;
use crate::app::plan::{self, Choices};
use crate::app::texts::tr;
use crate::app::widgets::theme;
use crate::app::widgets::{arrow_keys, keep_press, set_accessible_name};
use crate::scene::{Implant, Scene};
use crate::view::body::Body;
use eframe::egui::{
    self, CursorIcon, Key, Modifiers, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, vec2,
};
use glam::{Vec2, Vec3};

/// Radius of a handle \[points\].
const RADIUS: f32 = 9.0;
/// Radius around a handle in which the mouse takes the handle, and a finger \[points\].
const REACH: [f32; 2] = [12.0, 0.5 * theme::TOUCH];
/// Distance of the handle of the projection outwards from that of the position, for a mouse and a finger \[points\].
const ABOVE: [f32; 2] = [30.0, theme::TOUCH];
/// Least length on the screen of a millimetre up for the handle of the projection \[points\].
const LEAST_UP: f32 = 0.5;
/// Share of the longest direction below which a direction on the wall counts as one of sight \[-\].
const SIGHT: f32 = 0.15;

/// What a handle changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Position,
    Projection,
}

/// The handles.
#[derive(Default)]
pub(crate) struct Handles {
    /// The running drag.
    drag: Option<Drag>,
}

/// A drag of a handle.
struct Drag {
    kind: Kind,
    /// Plan and choices at the start of the drag.
    before: Box<Scene>,
    choices: Choices,
    pointer: Pos2,
    axes: Axes,
}

/// One millimetre to the side, towards the head and away from the wall on the screen \[points\].
#[derive(Clone, Copy, Debug)]
struct Axes([Vec2; 3]);

impl Axes {
    /// Millimetres on the wall of a movement on the screen, without those along the line of sight: damped least squares.
    fn on_wall(self, movement: Vec2) -> Vec2 {
        let [x, y, _] = self.0;
        let (a, b, c) = (x.length_squared(), x.dot(y), y.length_squared());
        // Square of the longest direction.
        let longest = 0.5 * (a + c) + (0.25 * (a - c).powi(2) + b * b).sqrt();
        let shortest = (a + c - longest).max(0.0);
        let least = SIGHT * SIGHT * longest;
        let damping = if shortest < least { least } else { 0.0 };
        let (a, c) = (a + damping, c + damping);
        let (p, q) = (x.dot(movement), y.dot(movement));
        let determinant = a * c - b * b;
        if determinant > 0.0 {
            Vec2::new(c * p - b * q, a * q - b * p) / determinant
        } else {
            Vec2::ZERO
        }
    }

    /// Millimetres away from the wall of a movement on the screen.
    fn up(self, movement: Vec2) -> f32 {
        let up = self.0[2];
        up.dot(movement) / up.length_squared().max(1e-6)
    }
}

impl Handles {
    /// Is a drag running?
    pub(crate) fn is_dragged(&self) -> bool {
        self.drag.is_some()
    }

    /// Shows the handles while the pointer is over the picture, on a touch screen always, and follows their drags. After a
    /// cancelled press a drag changes nothing.
    pub(crate) fn show(
        &mut self,
        ui: &Ui,
        viewport: &mut Viewport,
        is_cancelled: bool,
        scene: &mut Scene,
        choices: &mut Choices,
    ) {
        let Some(area) = viewport.area().filter(|_| !viewport.has_ruler()) else { return };
        let Some(apex) = apex(viewport.body(), &scene.implant) else { return };
        let Some((at, axes)) = on_screen(viewport, apex, area) else { return };
        let finger = usize::from(ui.input(egui::InputState::has_touch_screen));
        let is_shown = finger > 0 || self.drag.is_some() || ui.rect_contains_pointer(area);
        // Away from the wall on the screen: up, or to the side before a standing patient.
        let outwards = axes.0[2].normalize_or(-Vec2::Y);
        let outwards = vec2(outwards.x, outwards.y);
        let kinds = [(Kind::Position, at), (Kind::Projection, at + ABOVE[finger] * outwards)];
        let mut shapes = Vec::new();
        for (kind, at) in kinds {
            let is_implant = choices.device == Device::Implant;
            let is_able = kind == Kind::Position || (is_implant && axes.0[2].length() > LEAST_UP);
            if !is_able || !area.shrink(RADIUS).contains(at) {
                continue;
            }
            let rect = Rect::from_center_size(at, egui::Vec2::splat(2.0 * REACH[finger]));
            let response = handle(ui, rect, kind);
            if is_shown || response.has_focus() {
                let is_active = response.hovered() || response.dragged();
                shapes.extend(disc(ui, at, (kind, outwards), is_active));
            }
            self.start(ui, &response, kind, axes, (scene, choices));
            let drag = self.drag.as_ref().filter(|drag| drag.kind == kind && !is_cancelled);
            if let Some(drag) = drag {
                drag.follow(&response, scene, choices);
            }
            step_by_keys(ui, &response, kind, scene, choices);
            if drag.is_some() {
                let painter = ui.painter_at(area);
                let lines = about_drag(scene, kind, choices);
                labelled_box(ui, (&painter, area, &[]), (at, tr("Drag")), &lines);
            }
        }
        viewport.paint_handles(ui, shapes);
        if !ui.input(|input| input.pointer.any_down()) {
            self.drag = None;
        }
    }

    /// Starts the drag of a handle.
    fn start(
        &mut self,
        ui: &Ui,
        response: &Response,
        kind: Kind,
        axes: Axes,
        (scene, choices): (&Scene, &Choices),
    ) {
        if !response.dragged() || (self.drag.is_some() && !response.drag_started()) {
            return;
        }
        let Some(pointer) = response.interact_pointer_pos() else { return };
        let pointer = ui.input(|input| input.pointer.press_origin()).unwrap_or(pointer);
        let (before, choices) = (Box::new(scene.clone()), *choices);
        self.drag = Some(Drag { kind, before, choices, pointer, axes });
    }
}

impl Drag {
    /// Changes the plan by the drag.
    fn follow(&self, response: &Response, scene: &mut Scene, choices: &mut Choices) {
        let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) else {
            return;
        };
        let movement = Vec2::new(pointer.x - self.pointer.x, pointer.y - self.pointer.y);
        if movement == Vec2::ZERO {
            return;
        }
        match self.kind {
            Kind::Position => {
                let by = self.axes.on_wall(movement);
                let [x, y] = self.before.implant.center_mm;
                plan::move_to(scene, [x + f64::from(by.x), y + f64::from(by.y)]);
            }
            Kind::Projection => {
                let mm = self.before.implant.projection_mm + f64::from(self.axes.up(movement));
                let mut changed = self.choices;
                let mut dragged = Scene { implant: self.before.implant, ..scene.clone() };
                if plan::set_projection(&mut dragged, &mut changed, mm) {
                    (*scene, *choices) = (dragged, changed);
                }
            }
        }
    }
}

/// A point on the screen with the axes there.
fn on_screen(viewport: &Viewport, point: Vec3, area: Rect) -> Option<(Pos2, Axes)> {
    let at = viewport.point(point, area)?;
    let axis = |step: Vec3| {
        let end = viewport.point(point + step, area)?;
        Some(Vec2::new(end.x - at.x, end.y - at.y))
    };
    Some((at, Axes([axis(Vec3::X)?, axis(Vec3::Y)?, axis(Vec3::Z)?])))
}

/// Changes the plan by the arrow keys of a focused handle: 1 mm a key.
fn step_by_keys(
    ui: &Ui,
    response: &Response,
    kind: Kind,
    scene: &mut Scene,
    choices: &mut Choices,
) {
    if !response.has_focus() {
        return;
    }
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrow_keys()));
    let steps = |less, more| {
        ui.input_mut(|input| {
            let mut count = |key| input.count_and_consume_key(Modifiers::NONE, key) as f64;
            count(more) - count(less)
        })
    };
    let up = steps(Key::ArrowDown, Key::ArrowUp);
    let to_the_side = plan::hand_of(scene) * steps(Key::ArrowLeft, Key::ArrowRight);
    match kind {
        Kind::Position if up != 0.0 || to_the_side != 0.0 => {
            let [x, y] = scene.implant.center_mm;
            plan::move_to(scene, [x + to_the_side, y + up]);
        }
        Kind::Projection if up != 0.0 => {
            let mm = scene.implant.projection_mm + up;
            plan::set_projection(scene, choices, mm);
        }
        _ => {}
    }
}

/// What a drag has reached, and why the implant goes no further.
fn about_drag(scene: &Scene, kind: Kind, choices: &Choices) -> Vec<String> {
    match kind {
        Kind::Position => plan::position_in_words(scene),
        Kind::Projection => plan::projection_in_words(scene, choices),
    }
}

/// The point of the skin over an implant's apex.
fn apex(body: &Body, implant: &Implant) -> Option<Vec3> {
    let [x, y] = implant.center_mm;
    let place = Vec2::new(x as f32, (y - implant.apex_shift_mm) as f32);
    let columns = body.levels.first()?.iter().take(body.node_columns);
    let far = |p: &Vec3| p.truncate().distance_squared(place);
    columns.copied().min_by(|a, b| far(a).total_cmp(&far(b)))
}

/// The widget of a handle.
fn handle(ui: &Ui, rect: Rect, kind: Kind) -> Response {
    let (name, tooltip, icon) = match kind {
        Kind::Position => (
            tr("Move the implant"),
            tr(
                "Drag the implant in its pocket, or use the arrow keys (1 mm); Esc during a drag restores the plan",
            ),
            CursorIcon::Move,
        ),
        Kind::Projection => (
            tr("Raise the implant"),
            tr(
                "Drag away from the chest or towards it, or use the arrow keys (1 mm): projection; Esc during a drag restores the plan",
            ),
            CursorIcon::ResizeVertical,
        ),
    };
    let response = ui.interact(rect, ui.scope_id().with(name), Sense::DRAG | Sense::FOCUSABLE);
    keep_press(&response);
    let device = Device::of(ui.ctx());
    set_accessible_name(&response, Role::Button, &device.words(name));
    response.on_hover_cursor(icon).on_hover_text(device.words(tooltip))
}

/// A disc with arrows in the directions of the drag.
fn disc(ui: &Ui, at: Pos2, (kind, outwards): (Kind, egui::Vec2), is_active: bool) -> Vec<Shape> {
    let palette = theme::palette(ui.visuals());
    let (fill, line) = if is_active {
        (palette.accent, palette.on_accent)
    } else {
        (ui.visuals().panel_fill.gamma_multiply(0.85), palette.accent)
    };
    let mut shapes = vec![
        Shape::circle_filled(at, RADIUS, fill),
        Shape::circle_stroke(at, RADIUS, Stroke::new(1.5, palette.accent)),
    ];
    let stroke = Stroke::new(1.5, line);
    let directions: &[egui::Vec2] = match kind {
        Kind::Position => &[vec2(1.0, 0.0), vec2(-1.0, 0.0), vec2(0.0, 1.0), vec2(0.0, -1.0)],
        Kind::Projection => &[outwards, -outwards],
    };
    for direction in directions {
        let tip = at + 6.0 * *direction;
        let back = |side: f32| tip - 2.5 * *direction + side * 2.5 * direction.rot90();
        shapes.extend([at, back(1.0), back(-1.0)].map(|p| Shape::line_segment([p, tip], stroke)));
    }
    shapes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_movement_on_the_screen_is_one_on_the_wall_as_far_as_it_is_seen() {
        let oblique = Axes([Vec2::new(2.0, 0.5), Vec2::new(-0.6, -1.4), Vec2::new(0.0, -1.0)]);
        let wanted = Vec2::new(3.0, -4.0);
        let movement = oblique.0[0] * wanted.x + oblique.0[1] * wanted.y;
        assert!((oblique.on_wall(movement) - wanted).length() < 1e-3);
        // From the side: x is the line of sight.
        let side = Axes([Vec2::new(0.01, 0.0), Vec2::new(2.0, 0.0), Vec2::new(0.0, -2.0)]);
        let seen = side.on_wall(Vec2::new(10.0, 7.0));
        assert!(seen.x.abs() < 0.5 && (seen.y - 5.0).abs() < 0.2, "{seen}");
        assert!((side.up(Vec2::new(10.0, -6.0)) - 3.0).abs() < 1e-4);
        let nothing = Axes([Vec2::ZERO; 3]);
        assert_eq!(nothing.on_wall(Vec2::new(1.0, 1.0)), Vec2::ZERO);
    }
}

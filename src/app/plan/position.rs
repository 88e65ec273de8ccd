//! Position of the implant in its pocket: a pad and two numbers. The implant stays in its pocket, because a larger
//! pocket would reduce the strain.

use super::Device;
use super::{Hand, cm, mm};
use crate::app::frame::messages::{Notice, Offer};
use crate::app::texts::tr;
use crate::app::widgets::theme;
use crate::app::widgets::{Control, arrow_keys, keep_press, quantity, set_accessible_name};
use crate::scene::{Field, Scene, limits};
use eframe::egui::{
    self, Align2, Color32, Key, Modifiers, Pos2, Rect, Sense, Shape, Stroke, StrokeKind, TextStyle,
    Ui, epaint::EllipseShape, pos2, vec2,
};
use std::f32::consts::TAU;

/// Size of the pad \[points\].
const PAD: egui::Vec2 = vec2(120.0, 104.0);
/// Radius of the pocket in the pad \[points\].
const POCKET: f32 = 36.0;
/// Points of the line of the pocket's edge.
const EDGE_POINTS: usize = 72;
/// Step of an arrow key \[mm\].
const STEP_MM: f64 = 1.0;

/// Shows the position. Returns a notice about a number that does not fit the pocket.
pub(crate) fn position(ui: &mut Ui, scene: &mut Scene, hand: Hand) -> Option<Notice> {
    let mut notice = None;
    ui.horizontal(|ui| {
        pad(ui, scene);
        ui.vertical(|ui| {
            for axis in [0, 1] {
                notice = number(ui, scene, axis, hand).or(notice.take());
            }
        });
    });
    notice
}

/// The centre inside of its pocket that is nearest to the requested one \[mm\].
fn inside(scene: &Scene, [x, y]: [f64; 2]) -> [f64; 2] {
    // A centre on the rim is allowed; rounding must not put it beyond.
    let (room, distance) = (scene.room_mm() * (1.0 - 1e-12), x.hypot(y));
    let factor = if distance > room { room / distance } else { 1.0 };
    let tidy = |v: f64| if factor < 1.0 { v * factor } else { v };
    [tidy(x), tidy(y)]
}

/// Moves the centre to a place \[mm\], in tenths of a millimetre, as far as the pocket allows.
pub(crate) fn move_to(scene: &mut Scene, place: [f64; 2]) {
    // Tenths of a millimetre follow the hand closely enough.
    scene.implant.center_mm = inside(scene, place.map(|v| (10.0 * v).round() / 10.0));
}

/// Where the implant is, and at the pocket's edge why the implant goes no further.
pub(crate) fn position_in_words(scene: &Scene) -> Vec<String> {
    let [x, y] = scene.implant.center_mm;
    let room = scene.room_mm();
    let words = |mm: f64| quantity::format_at_most(cm((10.0 * mm).round() / 10.0), 1, 2);
    let place = tr!("{side} cm to the side, {up} cm up", side = words(x), up = words(y));
    let is_at_edge = x.hypot(y) >= room * (1.0 - 1e-9);
    let edge = is_at_edge.then(|| {
        tr!(
            "At the pocket's edge, {distance} cm from the centre: a wider pocket has more room",
            distance = words(room)
        )
    });
    [place].into_iter().chain(edge).collect()
}

/// +1: the patient's side is at the right, as one looks at the patient; of a right breast −1.
pub(crate) fn hand_of(scene: &Scene) -> f64 {
    if scene.is_right() { -1.0 } else { 1.0 }
}

/// The pad: pocket and implant from the front; the implant follows pointer and arrow keys.
fn pad(ui: &mut Ui, scene: &mut Scene) {
    let (rect, response) = ui.allocate_exact_size(PAD, Sense::click_and_drag());
    keep_press(&response);
    let centre = rect.center() - vec2(0.0, 2.0);
    let points_per_mm = POCKET / scene.pocket_radius_mm as f32;
    let (before, hand) = (scene.implant.center_mm, hand_of(scene));
    if response.dragged() {
        // The implant moves with the pointer from where the pointer took it.
        let grab = response.id.with("grab");
        let at = |point: Pos2| {
            let offset = (point - centre) / points_per_mm;
            [hand * f64::from(offset.x), -f64::from(offset.y)]
        };
        if let Some(pointer) = response.interact_pointer_pos() {
            let [x, y] = at(pointer);
            let kept = ui.data(|data| data.get_temp::<[f64; 2]>(grab));
            let offset = kept.filter(|_| !response.drag_started());
            let [dx, dy] = offset.unwrap_or([before[0] - x, before[1] - y]);
            ui.data_mut(|data| data.insert_temp(grab, [dx, dy]));
            if response.drag_delta() != egui::Vec2::ZERO {
                move_to(scene, [x + dx, y + dy]);
            }
        }
    }
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    if response.has_focus() {
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrow_keys()));
        for (key, x, y) in [
            (Key::ArrowLeft, -STEP_MM, 0.0),
            (Key::ArrowRight, STEP_MM, 0.0),
            (Key::ArrowUp, 0.0, STEP_MM),
            (Key::ArrowDown, 0.0, -STEP_MM),
        ] {
            let count = ui.input_mut(|i| i.count_and_consume_key(Modifiers::NONE, key)) as f64;
            if count > 0.0 {
                let [a, b] = scene.implant.center_mm;
                scene.implant.center_mm = inside(scene, [a + hand * count * x, b + count * y]);
            }
        }
    }
    if response.double_clicked() {
        scene.implant.center_mm = [0.0, 0.0];
    }
    let device = Device::of(ui.ctx());
    let name = device.words(tr("Position of the implant"));
    set_accessible_name(&response, egui::Role::Canvas, &name);
    if ui.is_rect_visible(rect) {
        paint(ui, rect, centre, scene);
    }
    response.on_hover_text(device.words(
        tr("Drag the implant in its pocket, or use the arrow keys (1 mm). A double-click centres the implant."),
    ));
}

fn paint(ui: &Ui, rect: Rect, centre: Pos2, scene: &Scene) {
    let (palette, visuals, painter) = (theme::palette(ui.visuals()), ui.visuals(), ui.painter());
    let border = Stroke::new(1.0, palette.edge);
    painter.rect(rect, 6.0, visuals.extreme_bg_color, border, StrokeKind::Inside);
    let line = Stroke::new(1.0, palette.edge);
    for cross in [vec2(POCKET + 4.0, 0.0), vec2(0.0, POCKET + 4.0)] {
        painter.line_segment([centre - cross, centre + cross], Stroke::new(0.5, palette.edge));
    }
    let points_per_mm = POCKET / scene.pocket_radius_mm as f32;
    let lower = POCKET + scene.body.pocket_lowered_mm as f32 * points_per_mm;
    let edge = (0..EDGE_POINTS).map(|k| {
        let (sin, cos) = (TAU * k as f32 / EDGE_POINTS as f32).sin_cos();
        centre + vec2(POCKET * cos, if sin > 0.0 { lower } else { POCKET } * sin)
    });
    // Beyond the pad the edge is cut.
    painter
        .with_clip_rect(rect.intersect(ui.clip_rect()))
        .add(Shape::closed_line(edge.collect(), line));
    let [x, y] = scene.implant.center_mm.map(|v| v as f32 * points_per_mm);
    let hand = hand_of(scene) as f32;
    let at = centre + vec2(hand * x, -y);
    let implant = &scene.implant;
    let half_axes = [implant.base_radius_mm, 0.5 * implant.base_height()];
    let [across, along] = half_axes.map(|half| half as f32 * points_per_mm);
    painter.add(Shape::Ellipse(EllipseShape {
        fill: palette.accent.gamma_multiply(0.25),
        stroke: Stroke::new(1.5, palette.accent),
        ..EllipseShape::filled(at, vec2(across, along), Color32::TRANSPARENT)
    }));
    let apex = at + vec2(0.0, implant.apex_shift_mm as f32 * points_per_mm);
    painter.circle_filled(apex, 2.5, palette.accent);
    let (font, color) = (TextStyle::Small.resolve(ui.style()), visuals.weak_text_color());
    let text = |at: Pos2, align, words: &str| {
        painter.text(at, align, words, font.clone(), color);
    };
    let inner = rect.shrink(4.0);
    text(pos2(centre.x, inner.top() - 3.0), Align2::CENTER_TOP, tr("head"));
    text(pos2(centre.x, inner.bottom() + 3.0), Align2::CENTER_BOTTOM, tr("feet"));
    let words = [tr("midline"), tr("side")];
    let [left, right] = if hand > 0.0 { words } else { [words[1], words[0]] };
    text(inner.left_bottom() + vec2(0.0, 3.0), Align2::LEFT_BOTTOM, left);
    text(inner.right_bottom() + vec2(0.0, 3.0), Align2::RIGHT_BOTTOM, right);
}

/// Position along one axis. A number outside of the pocket is rejected, with the offer of a larger pocket.
fn number(ui: &mut Ui, scene: &mut Scene, axis: usize, hand: Hand) -> Option<Notice> {
    let (control, mut value) = offset(scene, axis);
    let (label, reason) = (control.label, control.limit_reason.clone());
    let change = control.number(ui, &mut value, hand == Hand::Finger);
    if change.is_changed {
        scene.implant.center_mm[axis] = mm(value);
    }
    let requested = mm(change.out_of_range?);
    let offer = larger_pocket(scene, axis, requested);
    Some(Notice { offer, ..Notice::caution(format!("{label}: {reason}.")) })
}

/// The control of the position along an axis (0: to the side, 1: up), and the position \[cm\].
pub(super) fn offset(scene: &Scene, axis: usize) -> (Control<'static>, f64) {
    let (room, other) = (scene.room_mm(), scene.implant.center_mm[1 - axis]);
    let most = (room * room - other * other).max(0.0).sqrt();
    // A displayed limit is itself allowed.
    let shown = cm((10.0 * most + 1e-6).floor() / 10.0);
    let limit_reason = tr!("at most {most} cm in this pocket", most = quantity::format(shown, 1));
    let value = cm(scene.implant.center_mm[axis]);
    // The position of a file may lie on the pocket's rim by rounding.
    let reach = cm(most).max(value.abs());
    let control = Control {
        range: -reach..=reach,
        allowed: Some(-reach..=reach),
        limit_reason,
        most_decimals: 2,
        ..Control::of([Field::CenterX, Field::CenterY][axis])
    };
    (control, value)
}

/// The offer of a pocket, in steps of 1 mm of its width, that contains the implant at the requested position \[mm\].
fn larger_pocket(scene: &Scene, axis: usize, requested: f64) -> Option<Offer> {
    let offset = requested.hypot(scene.implant.center_mm[1 - axis]);
    let pocket_radius_mm = (2.0 * (scene.implant.greatest_half_axis_mm() + offset)).ceil() / 2.0;
    (pocket_radius_mm <= limits::POCKET_RADIUS_MAX_MM).then(|| {
        let mut scene = scene.clone();
        scene.set_pocket_radius(pocket_radius_mm);
        scene.implant.center_mm[axis] = requested;
        let width = quantity::format(cm(2.0 * pocket_radius_mm), 1);
        Offer { label: tr!("Make the pocket {width} cm wide", width), scene: Box::new(scene) }
    })
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "stated values hold to the last bit")]
mod tests {
    use super::*;

    #[test]
    fn a_centre_beyond_the_pocket_is_moved_to_its_rim() {
        let mut scene = Scene::opening();
        assert_eq!(inside(&scene, [3.0, -4.0]), [3.0, -4.0]);
        scene.implant.center_mm = inside(&scene, [60.0, 80.0]);
        let words = position_in_words(&scene);
        assert_eq!(words[0], "0.6 cm to the side, 0.8 cm up");
        assert!(words[1].starts_with("At the pocket's edge, 1.0 cm"), "{words:?}");
        let [x, y] = scene.implant.center_mm;
        assert!((x - 6.0).abs() < 1e-9 && (y - 8.0).abs() < 1e-9);
        assert_eq!((scene.repair(), scene.validate()), (None, Ok(())));
    }
}

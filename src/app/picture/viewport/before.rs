//! The body before, beside the body after or in a part of its picture; the time that a picture shows.

use super::{CURRENT, Drawn, Viewport, overlay};
use crate::app::plan::when;
use crate::app::texts::tr;
use crate::app::widgets::{arrow_keys, keep_press, theme};
use crate::scene::Scene;
use crate::view::mesh::Mesh;
use eframe::egui::{
    self, Align2, Key, Modifiers, Rect, Response, Sense, Stroke, Ui, WidgetInfo, pos2, vec2,
};
use std::sync::Arc;

/// How the body before is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Before {
    #[default]
    Off,
    /// Before and after beside each other.
    Beside,
    /// Before in the left part of the picture.
    Wipe,
}

/// Number of the picture of the body before.
const BEFORE: u64 = u64::MAX - 1;
/// Space between two pictures, width of the handle's reach, radius of its grip \[points\].
const GAP: f32 = 2.0;
const REACH: f32 = 26.0;
const GRIP: f32 = 9.0;
/// Step of the wipe by an arrow key \[-\].
const STEP: f32 = 0.02;

/// The areas of the pictures before and after: beside each other, or in a high area one over the other.
pub(super) fn halves(area: Rect) -> [Rect; 2] {
    if area.width() >= 0.9 * area.height() {
        let half = 0.5 * (area.width() - GAP);
        [area.with_max_x(area.left() + half), area.with_min_x(area.right() - half)]
    } else {
        let half = 0.5 * (area.height() - GAP);
        [area.with_max_y(area.top() + half), area.with_min_y(area.bottom() - half)]
    }
}

/// Draws a word at a corner of a picture. Returns its place.
fn word(ui: &Ui, area: Rect, (anchor, at): (Align2, egui::Pos2), words: &str) -> Rect {
    let painter = ui.painter_at(area);
    let font = egui::TextStyle::Button.resolve(ui.style());
    let galley = painter.layout_no_wrap(words.to_owned(), font, ui.visuals().strong_text_color());
    let rect = anchor.anchor_size(at, galley.size());
    let ground = rect.expand2(vec2(5.0, 2.0));
    painter.rect_filled(ground, 4.0, ui.visuals().panel_fill.gamma_multiply(0.85));
    painter.galley(rect.min, galley, ui.visuals().strong_text_color());
    let id = ui.scope_id().with((words, "of a picture"));
    let response = ui.interact(ground, id, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(egui::Role::Label, true, words));
    ground
}

/// The place of a word at the left of a picture's upper edge, below `top`.
fn corner(area: Rect, top: f32) -> (Align2, egui::Pos2) {
    let margin = theme::SPACE;
    (Align2::LEFT_TOP, pos2(area.left() + margin, area.top().max(top) + margin))
}

/// Draws the time after the operation that a picture shows, of skin with a state. Returns its place.
pub(super) fn time(ui: &Ui, area: Rect, top: f32, scene: &Scene) -> Vec<Rect> {
    let words = when::in_words(scene);
    words.iter().map(|words| word(ui, area, corner(area, top), words)).collect()
}

impl Viewport {
    /// The widget of the picture before; a drag there turns both.
    pub(super) fn interact_before(&mut self, ui: &Ui, area: Rect) -> Response {
        let response = ui.interact(area, ui.scope_id().with("before"), Sense::CLICK | Sense::DRAG);
        keep_press(&response);
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Canvas, true, tr("Before")));
        response
    }

    /// Draws the body before in its area, and the words of both pictures, that of the plan with its time. Returns the places of the words, and that of the
    /// border.
    pub(super) fn draw_before(
        &self,
        ui: &Ui,
        (mesh, drawn): (&Arc<Mesh>, Drawn<'_>),
        [before, after]: [Rect; 2],
        (way, top): (Before, f32),
        plan: &Scene,
    ) -> (Vec<Rect>, f32) {
        let none = Arc::default;
        let meshes = [none(), none(), none(), none(), Arc::clone(mesh)];
        let drawn = Drawn { number: BEFORE, meshes, ..drawn };
        let time = when::in_words(plan).unwrap_or_else(|| tr("after").to_owned());
        if way == Before::Beside {
            let between = before.union(after);
            ui.painter_at(between).line_segment(
                match before.right() < after.left() {
                    true => [between.center_top(), between.center_bottom()],
                    false => [between.left_center(), between.right_center()],
                },
                Stroke::new(2.0 * GAP, ui.visuals().panel_fill),
            );
            let painter = ui.painter_at(before);
            overlay::background(ui, &painter, before);
            self.draw(ui, &painter, before, drawn);
            let words = vec![
                word(ui, before, corner(before, top), tr("before")),
                word(ui, after, corner(after, top), &time),
            ];
            return (words, self.wipe);
        }
        let wipe = self.wipe_handle(ui, after, top);
        let x = after.left() + wipe * after.width();
        let painter = ui.painter_at(after.with_max_x(x));
        overlay::background(ui, &painter, after);
        self.draw(ui, &painter, after, drawn);
        let palette = theme::palette(ui.visuals());
        let line = Stroke::new(2.0, palette.accent);
        let all = ui.painter_at(after);
        all.vline(x, after.y_range(), line);
        all.circle(pos2(x, after.center().y), GRIP, ui.visuals().panel_fill, line);
        let below = after.top().max(top) + theme::SPACE;
        let beside = theme::SPACE + 2.0;
        let words = vec![
            word(ui, after, (Align2::RIGHT_TOP, pos2(x - beside, below)), tr("before")),
            word(ui, after, (Align2::LEFT_TOP, pos2(x + beside, below)), &time),
        ];
        (words, wipe)
    }

    /// The handle of the border between before and after. Returns its place \[-\].
    fn wipe_handle(&self, ui: &Ui, area: Rect, top: f32) -> f32 {
        let mut wipe = self.wipe;
        let around = egui::Vec2::new(REACH, (area.bottom() - top).max(1.0));
        let middle = pos2(area.left() + wipe * area.width(), 0.5 * (area.bottom() + top));
        let id = ui.scope_id().with("wipe");
        let response =
            ui.interact(Rect::from_center_size(middle, around), id, Sense::click_and_drag());
        keep_press(&response);
        let name = tr("Border between before and after");
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Slider, true, name));
        if response.hovered() || response.dragged() {
            ui.ctx().set_cursor_icon(egui::CursorIcon::ResizeHorizontal);
        }
        if response.clicked() || response.drag_started() {
            response.request_focus();
        }
        if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            wipe = (pointer.x - area.left()) / area.width();
        }
        if response.has_focus() {
            ui.memory_mut(|memory| memory.set_focus_lock_filter(id, arrow_keys()));
            ui.input_mut(|input| {
                for (key, step) in [(Key::ArrowLeft, -STEP), (Key::ArrowRight, STEP)] {
                    let count = input.count_and_consume_key(Modifiers::NONE, key);
                    wipe += step * count as f32;
                }
            });
        }
        wipe.clamp(0.0, 1.0)
    }
}

/// The numbers of the pictures in use.
pub(super) fn numbers(way: Before) -> Arc<[u64]> {
    match way {
        Before::Off => Arc::new([CURRENT]),
        Before::Beside | Before::Wipe => Arc::new([CURRENT, BEFORE]),
    }
}

//! Widgets of the panels: exact number fields, sliders, groups, names for screen readers.
//!
//! Uses `texts`, `theme`. Used by all panels.

mod control;
mod number_field;
pub(super) mod quantity;
mod rail;
pub(crate) mod theme;

pub(super) use control::{Control, ControlResponse, rejection_label};
pub(super) use number_field::{NumberField, drop_typed_number};
pub(super) use quantity::Kind;

use crate::app::texts::tr;
use eframe::egui::{self, EventFilter, Id, Key, Modifiers, Response, RichText, Ui};
use egui::accesskit::{Action, ActionData};
use egui::containers::menu::{MenuButton, MenuConfig, menu_style};
use std::fmt::Debug;
use std::hash::Hash;
use std::ops::RangeInclusive;
use theme::{SPACE, SPACE_SMALL};

/// A collapsible group with a title.
pub(super) fn group(ui: &mut Ui, title: &str, add: impl FnOnce(&mut Ui)) {
    egui::CollapsingHeader::new(RichText::new(title).strong()).default_open(true).show_unindented(
        ui,
        |ui| {
            add(ui);
            ui.add_space(SPACE_SMALL);
        },
    );
}

/// A part of the screen whose controls stay themselves while lines above come and go: a press before such a change and the release
/// behind it are a click. A name stands for one part of a frame.
pub(super) fn steady<R>(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui) -> R) -> R {
    let builder = egui::UiBuilder::new().scope_id(Id::unique(("steady", name)));
    ui.scope_builder(builder, add).inner
}

/// A quiet line of small text that wraps.
pub(super) fn remark(ui: &mut Ui, text: impl Into<String>) -> Response {
    ui.add(egui::Label::new(RichText::new(text).small().weak()).wrap())
}

/// The room of some lines of small text, whatever stands in it: words that come and go move no control.
pub(super) fn kept_lines<R>(ui: &mut Ui, lines: usize, add: impl FnOnce(&mut Ui) -> R) -> R {
    let height = (lines as f32 * ui.text_style_height(&egui::TextStyle::Small)).ceil();
    let room = egui::vec2(ui.available_width(), height);
    let shown = ui.allocate_ui(room, |ui| {
        ui.set_min_height(height);
        ui.spacing_mut().item_spacing.y = 0.0;
        add(ui)
    });
    shown.inner
}

/// The frame of a field for text: with the focus, too, its edge is in sight.
pub(super) fn field_frame(ui: &Ui) -> egui::Frame {
    egui::Frame::new()
        .fill(ui.visuals().extreme_bg_color)
        .stroke(egui::Stroke::new(1.0, theme::palette(ui.visuals()).edge))
        .corner_radius(ui.visuals().widgets.inactive.corner_radius)
        .inner_margin(egui::Margin::symmetric(5, 2))
}

/// Says how many characters a text field has of those allowed, while it is being typed into near its limit: over the page, so that
/// nothing moves. Further signs have no effect.
pub(super) fn characters_left(field: &Response, text: &str, most: usize) {
    let count = text.chars().count();
    if field.has_focus() && 10 * count >= 9 * most {
        field.show_tooltip_text(tr!("{count} of {most} characters", count, most));
    }
}

/// Notes for the menus and lists of a context whether the screen is one for fingers.
pub(super) fn note_fingers(ctx: &egui::Context, is_for_fingers: bool) {
    ctx.data_mut(|data| data.insert_temp(fingers_key(), is_for_fingers));
}

fn is_for_fingers(ctx: &egui::Context) -> bool {
    ctx.data(|data| data.get_temp(fingers_key())).unwrap_or_default()
}

fn fingers_key() -> Id {
    Id::unique("screen for fingers")
}

/// Buttons of a row at the size of a finger, on a screen for fingers.
pub(super) fn fit_fingers(ui: &mut Ui) {
    if is_for_fingers(ui.ctx()) {
        ui.spacing_mut().interact_size.y = theme::FINGER;
    }
}

/// A drop-down box: on a screen for fingers its rows have the size of a finger.
pub(super) fn list<'a>(ui: &Ui, salt: impl Hash + Debug) -> egui::ComboBox<'a> {
    let list = egui::ComboBox::from_id_salt(salt);
    if is_for_fingers(ui.ctx()) { list.popup_style(rows_for_fingers.into()) } else { list }
}

fn rows_for_fingers(style: &mut egui::Style) {
    style.spacing.interact_size.y = theme::FINGER;
    // A row ends where the next one begins.
    style.spacing.item_spacing.y = 0.0;
}

/// A menu: on a screen for fingers its rows, and those of the menus in it, have the size of a finger; a menu higher than the screen scrolls.
pub(super) fn menu(ui: &mut Ui, name: &str, add: impl FnOnce(&mut Ui)) -> Response {
    if !is_for_fingers(ui.ctx()) {
        return ui.menu_button(name, add).response;
    }
    let style = |style: &mut egui::Style| {
        menu_style(style);
        rows_for_fingers(style);
    };
    let most = ui.ctx().content_rect().height() - 2.0 * theme::FINGER;
    let scrolled = |ui: &mut Ui| {
        egui::ScrollArea::vertical().max_height(most).min_scrolled_height(most).show(ui, add);
    };
    let button = MenuButton::new(name).config(MenuConfig::new().style(style));
    button.ui(ui, scrolled).0
}

/// Sets the name of a widget, for screen readers and tests, in place of its icon or number.
pub(super) fn set_accessible_name(response: &Response, role: egui::Role, name: &str) {
    response.widget_info(|| egui::WidgetInfo::labeled(role, response.enabled(), name));
}

/// A button that is inactive but focusable without `is_able`; a disabled button would lose the keyboard
/// focus. Returns whether the button was pressed.
pub(super) fn button_if(ui: &mut Ui, is_able: bool, text: &str, name: &str, tip: &str) -> bool {
    let color = if is_able { ui.visuals().text_color() } else { ui.visuals().weak_text_color() };
    let text = RichText::new(text).color(color);
    let button =
        if is_able { egui::Button::new(text) } else { egui::Button::new(text).frame(false) };
    let response = ui.add(button);
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, is_able, name));
    let is_pressed = response.clicked();
    if !tip.is_empty() {
        response.on_hover_text(tip);
    }
    is_able && is_pressed
}

/// A drop-down box of full width under its label; `add` shows the choices.
pub(super) fn labelled_box(
    ui: &mut Ui,
    label: &str,
    selected: &str,
    add: impl FnOnce(&mut Ui),
) -> Response {
    let text = ui.label(RichText::new(label).color(ui.visuals().weak_text_color()));
    let response = list(ui, label)
        .width(ui.available_width() - SPACE)
        .selected_text(selected)
        .show_ui(ui, add)
        .response
        .labelled_by(text.id);
    set_accessible_name(&response, egui::Role::ComboBox, label);
    response
}

/// A choice of a drop-down box; the box closes after a click or a key on the choice.
pub(super) fn choice(ui: &mut Ui, is_present: bool, text: impl Into<egui::WidgetText>) -> Response {
    let response = ui.selectable_label(is_present, text.into());
    if response.clicked() {
        ui.close();
    }
    response
}

/// Keeps the press of a finger that rests before it drags: egui ends the press of a widget of clicks and drags after
/// 0.8 s of rest, for a context menu.
pub(super) fn keep_press(response: &Response) {
    if response.long_touched() {
        response.ctx.set_dragged_id(response.id);
    }
}

/// Notes whether the press of the pointer is cancelled: a rail then stays where it is.
pub(super) fn note_cancelled_press(ctx: &egui::Context, is_cancelled: bool) {
    ctx.data_mut(|data| data.insert_temp(Id::unique("cancelled press"), is_cancelled));
}

/// Is the press of the pointer cancelled?
pub(super) fn is_press_cancelled(ctx: &egui::Context) -> bool {
    ctx.data(|data| data.get_temp(Id::unique("cancelled press"))).unwrap_or_default()
}

/// Filter of a focused widget that receives the arrow keys; otherwise the keys move the focus.
pub(super) fn arrow_keys() -> EventFilter {
    EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() }
}

/// Keys that step a number, with their numbers of steps.
const STEP_KEYS: [(Key, f64); 4] =
    [(Key::ArrowUp, 1.0), (Key::ArrowDown, -1.0), (Key::PageUp, 10.0), (Key::PageDown, -10.0)];

/// Sum of the steps of the keys pressed since the previous frame.
fn key_steps(ui: &Ui, keys: impl IntoIterator<Item = (Key, f64)>) -> f64 {
    ui.input_mut(|input| {
        let mut steps =
            |(key, steps)| steps * input.count_and_consume_key(Modifiers::NONE, key) as f64;
        keys.into_iter().map(&mut steps).sum()
    })
}

/// Values that a screen reader has requested for a widget since the previous frame.
fn set_value_requests(ui: &Ui, id: Id) -> Vec<ActionData> {
    ui.input(|input| {
        let requests = input.accesskit_action_requests(id, Action::SetValue);
        requests.filter_map(|request| request.data.clone()).collect()
    })
}

/// Describes range and step of a number to screen readers, which may then request a value.
fn describe_range(response: &Response, range: &RangeInclusive<f64>, step: f64) {
    response.ctx.accesskit_node_builder(response.id, |node| {
        node.set_min_numeric_value(*range.start());
        node.set_max_numeric_value(*range.end());
        node.set_numeric_value_step(step);
        node.add_action(Action::SetValue);
    });
}

/// Does a number field have the keyboard focus? A touch screen should then show a numeric keyboard.
pub(super) fn has_number_focus(ctx: &egui::Context) -> bool {
    let focused = ctx.memory(egui::Memory::focused);
    let number = ctx.data(|data| data.get_temp::<Id>(number_field::focus_key()));
    focused.is_some() && focused == number
}

/// The texts of what is shown on a screen of this size in its second frame, once sizes are known.
#[cfg(test)]
pub(super) fn texts_of(size: egui::Vec2, mut show: impl FnMut(&mut Ui)) -> Vec<String> {
    use egui::{Pos2, RawInput, Rect, Shape};

    let ctx = egui::Context::default();
    theme::install(&ctx);
    let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, size));
    let input = RawInput { screen_rect, ..RawInput::default() };
    let mut output = ctx.run_ui(input.clone(), &mut show);
    output.append(ctx.run_ui(input, show));
    output.textures_delta.clear();
    let text = |clipped: egui::epaint::ClippedShape| match clipped.shape {
        Shape::Text(text) => Some(text.galley.text().to_owned()),
        _ => None,
    };
    output.shapes.into_iter().filter_map(text).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Context, Event, Modifiers, PointerButton, RawInput, pos2};

    /// Presses a button, adds a line without a height above it, and lets go: is that a click?
    fn is_click(show: impl Fn(&mut Ui) -> bool) -> bool {
        let ctx = Context::default();
        let (mut place, mut is_clicked) = (pos2(0.0, 0.0), false);
        for (frame, pressed) in [None, None, Some(true), None, Some(false)].into_iter().enumerate()
        {
            let button = pressed.map(|pressed| Event::PointerButton {
                pos: place,
                button: PointerButton::Primary,
                pressed,
                modifiers: Modifiers::NONE,
            });
            let events = [Event::PointerMoved(place)].into_iter().chain(button).collect();
            let mut output = ctx.run_ui(RawInput { events, ..RawInput::default() }, |ui| {
                ui.skip_ahead_auto_ids(usize::from(frame >= 3));
                is_clicked |= show(ui);
                place = ui.min_rect().right_bottom() - egui::vec2(3.0, 3.0);
            });
            output.textures_delta.clear();
        }
        is_clicked
    }

    #[test]
    fn a_press_in_a_steady_part_is_a_click_although_lines_above_come_or_go() {
        let button = |ui: &mut Ui| ui.button("Pin as A").clicked();
        assert!(!is_click(button));
        assert!(is_click(|ui| steady(ui, "part", button)));
    }
}

//! The keyboard's focus: a ring that is always seen, a way into the app and out of it, and a place to go
//! back to when what had the focus is gone.

use super::theme;
use eframe::egui::output::OutputEvent;
use eframe::egui::{
    self, Context, Event, FocusDirection, Id, Key, LayerId, Modifiers, Order, Rect, Sense, Stroke,
    StrokeKind, Ui,
};

/// Who has the keyboard, and how the focus got there.
#[derive(Default)]
pub(super) struct Focus {
    /// Did the focus come by a key? A click needs no ring.
    is_by_keyboard: bool,
    /// The last widget of the panels that had the focus: not one of a menu.
    return_target: Option<Id>,
    return_name: String,
    /// What had the focus in the frame before.
    previous: Option<Id>,
    /// Name of what has the focus, and where it was drawn \[points\].
    name: String,
    rect: Option<Rect>,
    /// What was scrolled to last.
    scrolled_to: Option<Id>,
    /// Times that it was tried for what has the focus now.
    scrolls: u32,
    /// Are there places before and behind the app that the Tab key leads to, as in a page?
    is_in_page: bool,
    /// The focus is to come in with the next frame, and comes in with this one.
    pending_entry: Option<FocusDirection>,
    is_entering: bool,
    exit: Option<FocusDirection>,
}

/// The two ends of the order in which the Tab key goes through the app.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Boundary {
    First,
    Last,
}

impl Boundary {
    fn id(self) -> Id {
        Id::unique(match self {
            Self::First => "before the first control",
            Self::Last => "behind the last control",
        })
    }
}

impl Focus {
    /// From now on the Tab key leads out of the app at its last control, and at its first one backwards.
    pub(super) fn enable_page_navigation(&mut self) {
        self.is_in_page = true;
    }

    /// The focus comes in from outside, to the first control or the last one.
    pub(super) fn enter(&mut self, direction: FocusDirection) {
        self.pending_entry = Some(direction);
        self.is_by_keyboard = true;
    }

    /// Did the Tab key lead out of the app in this frame?
    pub(super) fn take_exit(&mut self) -> Option<FocusDirection> {
        self.exit.take()
    }

    /// Before the first widget of a frame.
    pub(super) fn begin_frame(&mut self, ctx: &Context) {
        ctx.input(|input| {
            for event in &input.events {
                match event {
                    Event::Key { key, pressed: true, .. } if is_moving(*key) => {
                        self.is_by_keyboard = true;
                    }
                    Event::PointerButton { pressed: true, .. } => self.is_by_keyboard = false,
                    _ => {}
                }
            }
        });
        let direction = self.pending_entry.take();
        self.is_entering = direction.is_some();
        if let Some(direction) = direction {
            let boundary =
                if direction == FocusDirection::Next { Boundary::First } else { Boundary::Last };
            ctx.memory_mut(|memory| {
                memory.request_focus(boundary.id());
                memory.move_focus(direction);
            });
        }
    }

    /// An end of the order: where there are surroundings, it leads to them.
    pub(super) fn boundary(&mut self, ui: &Ui, boundary: Boundary) {
        if !self.is_in_page {
            return;
        }
        let place = Rect::from_min_size(ui.max_rect().min, egui::Vec2::ZERO);
        let response = ui.interact(place, boundary.id(), Sense::FOCUSABLE);
        if self.is_entering || !response.has_focus() {
            return;
        }
        // From nowhere inwards, or outwards?
        let (inwards, modifiers) = match boundary {
            Boundary::First => (FocusDirection::Next, Modifiers::NONE),
            Boundary::Last => (FocusDirection::Previous, Modifiers::SHIFT),
        };
        let is_inwards = ui.input(|input| {
            input.events.iter().any(|event| {
                matches!(event, Event::Key { key: Key::Tab, pressed: true, modifiers: with, .. }
                    if *with == modifiers)
            })
        });
        ui.memory_mut(|memory| memory.surrender_focus(boundary.id()));
        if is_inwards {
            self.pending_entry = Some(inwards);
        } else {
            self.exit = Some(match boundary {
                Boundary::First => FocusDirection::Previous,
                Boundary::Last => FocusDirection::Next,
            });
        }
        ui.ctx().request_repaint();
    }

    /// Behind the widgets of a scrolled panel: brings what has got the focus by a key into sight.
    pub(super) fn scroll_into_view(&mut self, ui: &Ui) {
        let Some(id) = ui.memory(egui::Memory::focused).filter(|_| self.is_by_keyboard) else {
            return;
        };
        if self.scrolled_to == Some(id) {
            return;
        }
        let Some(response) = ui.ctx().read_response(id) else { return };
        if !ui.min_rect().contains(response.rect.center()) || response.layer_id != ui.layer_id() {
            return;
        }
        // The place is that of the frame before: a scroll under way is not yet in it.
        if self.rect != Some(response.rect) {
            return;
        }
        let (wanted, seen) = (response.rect.expand(theme::SPACE), ui.clip_rect());
        let is_seen = wanted.top() >= seen.top() && wanted.bottom() <= seen.bottom();
        let is_at_end = self.scrolls >= 4;
        if is_seen || is_at_end {
            (self.scrolled_to, self.scrolls) = (Some(id), 0);
        } else {
            self.scrolls += 1;
            let none = egui::style::ScrollAnimation::none();
            ui.scroll_to_rect_animation(wanted.expand(theme::SPACE), None, none);
            ui.ctx().request_repaint();
        }
    }

    /// Name of what has the focus, and where it is \[points\].
    pub(super) fn focused(&self) -> Option<(&str, Rect)> {
        Some((&self.name, self.rect?))
    }

    /// Behind the last widget of a frame. `picture`: the widget that a click gives the focus without a word.
    pub(super) fn end_frame(&mut self, ctx: &Context, picture: Option<Id>) {
        let focused = ctx.memory(egui::Memory::focused);
        if focused != self.previous {
            // What gets the focus back does not say its name again.
            let is_back = focused.is_some() && focused == self.return_target;
            self.name = if is_back { self.return_name.clone() } else { String::new() };
        }
        ctx.output(|output| {
            for event in &output.events {
                if let OutputEvent::FocusGained(info) = event {
                    let words = info.label.as_ref().or(info.current_text_value.as_ref());
                    self.name = words.cloned().unwrap_or_default();
                }
            }
        });
        if focused.is_some() && focused == picture {
            "3-D view".clone_into(&mut self.name);
        }
        let response = focused.and_then(|id| ctx.read_response(id));
        let place = response.as_ref().map(|response| response.rect);
        if std::mem::replace(&mut self.rect, place) != place {
            ctx.request_repaint();
        }
        if let Some(response) = &response
            && response.layer_id.order == Order::Background
        {
            self.return_target = focused;
            self.return_name.clone_from(&self.name);
        }
        // A menu that closes, or Escape, takes the focus: it goes back to where it came from.
        let is_pressed = ctx.input(|input| input.pointer.any_pressed());
        if focused.is_none()
            && self.previous.is_some()
            && self.is_by_keyboard
            && !is_pressed
            && self.exit.is_none()
            && let Some(return_target) = self.return_target
            && ctx.read_response(return_target).is_some()
            && !ctx.input(|input| input.key_pressed(Key::Tab))
        {
            ctx.memory_mut(|memory| memory.request_focus(return_target));
            ctx.request_repaint();
        }
        self.previous = focused;
        if focused.is_none() {
            self.scrolled_to = None;
        }
        if let Some(response) = response.filter(|_| self.is_by_keyboard) {
            let seen = response.rect.intersect(response.interact_rect);
            if seen.is_positive() {
                let style = ctx.global_style();
                let painter =
                    ctx.layer_painter(LayerId::new(Order::Tooltip, Id::unique("focus ring")));
                // Inside of what is as large as the picture, around all else.
                let ring = if seen.area() > 0.1 * ctx.content_rect().area() {
                    seen.shrink(2.0)
                } else {
                    seen.expand(3.0)
                };
                let outside = Stroke::new(1.0, style.visuals.panel_fill);
                painter.rect_stroke(ring.expand(2.0), 6.0, outside, StrokeKind::Inside);
                let line = Stroke::new(2.0, style.visuals.text_color());
                painter.rect_stroke(ring, 5.0, line, StrokeKind::Middle);
            }
        }
    }
}

/// Keys that move the focus or what has it.
fn is_moving(key: Key) -> bool {
    matches!(
        key,
        Key::Tab
            | Key::ArrowUp
            | Key::ArrowDown
            | Key::ArrowLeft
            | Key::ArrowRight
            | Key::Space
            | Key::Enter
    )
}

//! Keyboard focus: a visible ring, entry into the app and exit from it, and return to the previous
//! control when the focused widget disappears.

use crate::app::texts::tr;
use crate::app::widgets::theme;
use eframe::egui::output::OutputEvent;
use eframe::egui::{
    self, Context, Event, FocusDirection, Id, Key, LayerId, Modifiers, Order, Rect, Response,
    Sense, Stroke, StrokeKind, Ui,
};

/// State of the keyboard focus.
#[derive(Default)]
pub(crate) struct Focus {
    /// Did a key move the focus? After a click there is no ring.
    is_by_keyboard: bool,
    /// The panel widget that had the focus last, without the widgets of menus.
    return_target: Option<Id>,
    return_name: String,
    /// The focused widget of the previous frame.
    previous: Option<Id>,
    /// Name of the focused widget, and its rectangle \[points\].
    name: String,
    rect: Option<Rect>,
    /// The widget that was last scrolled into view.
    scrolled_to: Option<Id>,
    /// Number of scroll attempts for the focused widget.
    scrolls: u32,
    /// Is the app part of a page, with elements before and after it in the Tab order?
    is_in_page: bool,
    /// Direction in which the focus enters the app with the next frame, and whether it enters with this
    /// frame.
    pending_entry: Option<FocusDirection>,
    is_entering: bool,
    exit: Option<FocusDirection>,
}

/// The two ends of the app's Tab order.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Boundary {
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
    /// Lets the Tab key leave the app after its last control, and before its first control backwards.
    pub(crate) fn enable_page_navigation(&mut self) {
        self.is_in_page = true;
    }

    /// Marks that the focus moves as by a key: with a ring, into view.
    pub(crate) fn mark_keyboard(&mut self) {
        self.is_by_keyboard = true;
    }

    /// Moves the focus from outside to the first control or to the last.
    pub(crate) fn enter(&mut self, direction: FocusDirection) {
        self.pending_entry = Some(direction);
        self.is_by_keyboard = true;
    }

    /// Returns the direction in which the Tab key has left the app in this frame.
    pub(crate) fn take_exit(&mut self) -> Option<FocusDirection> {
        self.exit.take()
    }

    /// Starts a frame; called before its first widget.
    pub(crate) fn begin_frame(&mut self, ctx: &Context) {
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

    /// Adds an end of the Tab order. In a page, the focus passes through it to the elements outside.
    pub(crate) fn boundary(&mut self, ui: &Ui, boundary: Boundary) {
        if !self.is_in_page {
            return;
        }
        let rect = Rect::from_min_size(ui.max_rect().min, egui::Vec2::ZERO);
        let response = ui.interact(rect, boundary.id(), Sense::FOCUSABLE);
        if self.is_entering || !response.has_focus() {
            return;
        }
        // Inwards if nothing had the focus, otherwise outwards.
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

    /// Scrolls the widget focused by a key into view; called after the widgets of a scrolled panel.
    pub(crate) fn scroll_into_view(&mut self, ui: &Ui) {
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
        // The stored rectangle is that of the previous frame, before a scroll in progress.
        if self.rect != Some(response.rect) {
            return;
        }
        let (target, visible) = (response.rect.expand(theme::SPACE), ui.clip_rect());
        let is_visible = target.top() >= visible.top() && target.bottom() <= visible.bottom();
        let is_at_end = self.scrolls >= 4;
        if is_visible || is_at_end {
            (self.scrolled_to, self.scrolls) = (Some(id), 0);
        } else {
            self.scrolls += 1;
            let none = egui::style::ScrollAnimation::none();
            ui.scroll_to_rect_animation(target.expand(theme::SPACE), None, none);
            ui.ctx().request_repaint();
        }
    }

    /// Name of the focused widget, and its rectangle \[points\].
    pub(crate) fn focused(&self) -> Option<(&str, Rect)> {
        Some((&self.name, self.rect?))
    }

    /// Had nothing the focus in the previous frame?
    pub(crate) fn is_nowhere(&self) -> bool {
        self.previous.is_none()
    }

    /// Had a widget the focus in the previous frame?
    pub(crate) fn is_on(&self, widget: Option<Id>) -> bool {
        widget.is_some() && self.previous == widget
    }

    /// Ends a frame; called after its last widget. `picture`: the widget that gets its focus by a click,
    /// without an event.
    pub(crate) fn end_frame(&mut self, ctx: &Context, picture: Option<Id>) {
        let focused = ctx.memory(egui::Memory::focused);
        if focused != self.previous {
            // A widget that gets the focus back does not repeat its name.
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
            tr("3-D view").clone_into(&mut self.name);
        }
        let response = focused.and_then(|id| ctx.read_response(id));
        let rect = response.as_ref().map(|response| response.rect);
        if std::mem::replace(&mut self.rect, rect) != rect {
            ctx.request_repaint();
        }
        if let Some(response) = &response
            && response.layer_id.order == Order::Background
        {
            self.return_target = focused;
            self.return_name.clone_from(&self.name);
        }
        // A closed menu or Escape removes the focus: it returns to the widget that had it before.
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
            draw_ring(ctx, &response);
        }
    }
}

/// Draws the ring around the focused widget.
fn draw_ring(ctx: &Context, response: &Response) {
    let visible = response.rect.intersect(response.interact_rect);
    if !visible.is_positive() {
        return;
    }
    // Inside large widgets such as the picture, around all others.
    let is_large = visible.area() > 0.1 * ctx.content_rect().area();
    let ring = if is_large { visible.shrink(2.0) } else { visible.expand(3.0) };
    let style = ctx.global_style();
    let painter = ctx.layer_painter(LayerId::new(Order::Tooltip, Id::unique("focus ring")));
    let outline = Stroke::new(1.0, style.visuals.panel_fill);
    painter.rect_stroke(ring.expand(2.0), 6.0, outline, StrokeKind::Inside);
    let line = Stroke::new(2.0, style.visuals.text_color());
    painter.rect_stroke(ring, 5.0, line, StrokeKind::Middle);
}

/// Keys that move the focus or change the focused widget.
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

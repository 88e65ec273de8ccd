//! The rail of a slider. A mouse moves the handle from anywhere on the rail. A finger moves it from the
//! handle, or after dragging along the rail; a swipe across the rail scrolls the panel.

use super::theme;
use super::{
    STEP_KEYS, arrow_keys, describe_range, is_press_cancelled, keep_press, key_steps, quantity,
    set_value_requests,
};
use eframe::egui::{
    self, Key, Modifiers, Pos2, Rect, Response, Sense, Stroke, Ui, lerp, pos2, remap_clamp, vec2,
};
use egui::accesskit::ActionData;
use std::ops::RangeInclusive;

/// Radius of the handle \[points\].
const HANDLE: f32 = 7.0;
/// Distance from the handle within which a finger grabs it \[points\].
const TOUCH_REACH: f32 = 24.0;
/// Travel that decides between dragging and scrolling \[points\].
const DRAG_THRESHOLD: f32 = 8.0;
const LINE: f32 = 5.0;
/// Distance of the marks below the line \[points\].
const MARK: f32 = 6.0;

/// A rail with a handle.
pub(super) struct Rail<'a> {
    pub(super) name: &'a str,
    /// Range of the rail.
    pub(super) range: RangeInclusive<f64>,
    /// Allowed values.
    pub(super) allowed: RangeInclusive<f64>,
    /// Rounding step of dragging and keys; 0: three significant digits.
    pub(super) step: f64,
    pub(super) logarithmic: bool,
    /// Values above which the rail is marked as high, as more than high, and as without an answer.
    pub(super) marks: [Option<f64>; 3],
    /// Width \[points\].
    pub(super) width: f32,
}

/// Response of a rail.
pub(super) struct RailResponse {
    pub(super) response: Response,
    /// Has the value changed?
    pub(super) is_changed: bool,
    /// A value outside the allowed range, requested in this frame.
    pub(super) out_of_range: Option<f64>,
}

/// State of a press on the rail. No state depends on the number of frames of a gesture: frames may be slow.
#[derive(Clone, Copy)]
enum Press {
    /// The press is new; in a page its touch event arrives one frame later.
    New { from: Pos2 },
    /// A finger, still undecided between dragging and scrolling.
    Undecided { from: Pos2 },
    /// The handle follows the pointer at this distance.
    Drag { offset: f32 },
    /// The panel scrolls; the pointer's last height.
    Scroll { y: f32 },
}

impl Rail<'_> {
    pub(super) fn show(self, ui: &mut Ui, value: &mut f64) -> RailResponse {
        let size = vec2(self.width, ui.spacing().interact_size.y);
        let (rect, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
        let track = rect.x_range().shrink(HANDLE);
        let before = *value;
        let mut requested = None;
        if let Some(x) =
            self.pointer(ui, &response, lerp(track.min..=track.max, self.fraction(*value)))
        {
            requested =
                Some(self.rounded(self.value_at(remap_clamp(x, track.min..=track.max, 0.0..=1.0))));
        }
        if response.has_focus() {
            ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrow_keys()));
            requested = self.keys(ui, *value).or(requested);
        }
        for request in set_value_requests(ui, response.id) {
            if let ActionData::NumericValue(number) = request {
                requested = Some(number);
            }
        }
        let mut out_of_range = None;
        if let Some(requested) = requested {
            *value = requested.max(*self.allowed.start()).min(*self.allowed.end());
            let is_beyond = (requested - *value).abs() > 1e-9 * (1.0 + requested.abs());
            out_of_range = is_beyond.then_some(requested);
        }
        self.describe(&response, *value);
        if ui.is_rect_visible(rect) {
            self.paint(ui, &response, rect, lerp(track.min..=track.max, self.fraction(*value)));
        }
        RailResponse { is_changed: value.to_bits() != before.to_bits(), response, out_of_range }
    }

    /// Position of the handle requested by the pointer.
    fn pointer(&self, ui: &Ui, response: &Response, handle: f32) -> Option<f32> {
        let id = response.id.with("press");
        let kept = ui.data_mut(|data| {
            let kept = data.get_temp::<Press>(id);
            data.remove::<Press>(id);
            kept
        });
        keep_press(response);
        if is_press_cancelled(ui.ctx()) {
            return None;
        }
        let is_held = response.is_pointer_button_down_on() || response.long_touched();
        let is_released = response.clicked() || response.drag_stopped();
        let at = response.interact_pointer_pos().filter(|_| is_held || is_released)?;
        let (origin, delta, has_fingers, has_touch) = ui.input(|input| {
            let pointer = &input.pointer;
            (pointer.press_origin(), pointer.delta(), input.any_touches(), input.has_touch_screen())
        });
        let is_touch = has_fingers || is_released && has_touch;
        let mut press = match kept {
            None if is_held => Press::New { from: origin.unwrap_or(at) },
            // A mouse button pressed and released within one frame.
            None => return (!is_touch).then_some(at.x),
            Some(Press::New { from }) => {
                let reach = if is_touch { TOUCH_REACH } else { HANDLE };
                let is_on_handle = (from.x - handle).abs() <= reach;
                match (is_touch, is_on_handle) {
                    (_, true) => Press::Drag { offset: handle - from.x },
                    (false, false) => Press::Drag { offset: 0.0 },
                    (true, false) => Press::Undecided { from },
                }
            }
            Some(press) => press,
        };
        if let Press::Undecided { from } = press {
            let travel = at - from;
            let (x, y) = (travel.x.abs(), travel.y.abs());
            if x >= DRAG_THRESHOLD && x >= y {
                press = Press::Drag { offset: handle - from.x - DRAG_THRESHOLD.copysign(travel.x) };
            } else if y >= DRAG_THRESHOLD {
                press = Press::Scroll { y: from.y + DRAG_THRESHOLD.copysign(travel.y) };
            }
        }
        let begins = !matches!(kept, Some(Press::Drag { .. }));
        if matches!(kept, Some(Press::New { .. })) && !is_touch {
            response.request_focus();
        }
        let requested = match press {
            Press::New { .. } => {
                ui.ctx().request_repaint();
                None
            }
            Press::Undecided { .. } => None,
            Press::Scroll { y } => {
                let none = egui::style::ScrollAnimation::none();
                ui.scroll_with_delta_animation(vec2(0.0, at.y - y), none);
                press = Press::Scroll { y: at.y };
                None
            }
            // A handle pressed without motion stays, so that the value keeps its last digit.
            Press::Drag { offset } => {
                let x = at.x + offset;
                ((begins || delta.x != 0.0) && (x - handle).abs() > 1e-3).then_some(x)
            }
        };
        if is_held {
            ui.data_mut(|data| data.insert_temp(id, press));
        }
        requested
    }

    fn keys(&self, ui: &Ui, value: f64) -> Option<f64> {
        let sideways = [(Key::ArrowRight, 1.0), (Key::ArrowLeft, -1.0)];
        let steps = key_steps(ui, STEP_KEYS.into_iter().chain(sideways));
        let is_pressed = |key| ui.input_mut(|input| input.consume_key(Modifiers::NONE, key));
        let start = is_pressed(Key::Home).then_some(*self.range.start());
        let end = is_pressed(Key::End).then_some(*self.range.end()).or(start);
        if end.is_some() || steps == 0.0 {
            return end;
        }
        let moved = quantity::stepped(value, self.step_at(value), steps);
        Some(moved.max(*self.range.start()).min(*self.range.end()))
    }

    /// The step at a value; without a given step a tenth of the leading digit's unit.
    fn step_at(&self, value: f64) -> f64 {
        if self.step > 0.0 {
            return self.step;
        }
        10f64.powf(value.abs().max(1e-12).log10().floor() - 1.0)
    }

    fn rounded(&self, value: f64) -> f64 {
        let step = if self.step > 0.0 { self.step } else { 0.1 * self.step_at(value) };
        let value = (value / step).round() * step;
        // 3 × 0.1 is 0.30000000000000004.
        let value = quantity::significant(value);
        value.max(*self.range.start()).min(*self.range.end())
    }

    /// Position of a value on the rail \[-\], 0 to 1.
    fn fraction(&self, value: f64) -> f32 {
        let [low, high, value] = [*self.range.start(), *self.range.end(), value]
            .map(|v| if self.logarithmic { v.max(f64::MIN_POSITIVE).ln() } else { v });
        if high > low { ((value - low) / (high - low)).clamp(0.0, 1.0) as f32 } else { 0.0 }
    }

    fn value_at(&self, fraction: f32) -> f64 {
        let (low, high) = (*self.range.start(), *self.range.end());
        let fraction = f64::from(fraction);
        if self.logarithmic {
            low * (high / low).powf(fraction)
        } else {
            low + (high - low) * fraction
        }
    }

    fn describe(&self, response: &Response, value: f64) {
        response.widget_info(|| egui::WidgetInfo::slider(response.enabled(), value, self.name));
        describe_range(response, &self.range, self.step_at(value));
    }

    fn paint(&self, ui: &Ui, response: &Response, rect: Rect, handle: f32) {
        let palette = theme::palette(ui.visuals());
        let painter = ui.painter();
        let line = Rect::from_center_size(rect.center(), vec2(rect.width(), LINE));
        painter.rect_filled(line, 0.5 * LINE, palette.rail);
        let trailing = line.with_max_x(handle);
        painter.rect_filled(trailing, 0.5 * LINE, palette.accent);
        let track = rect.x_range().shrink(HANDLE);
        let at = |value: f64| lerp(track.min..=track.max, self.fraction(value));
        let [high, beyond, none] = self.marks.map(|mark| mark.map(at));
        let end = none.unwrap_or(track.max);
        for (from, to, color) in [
            (high, beyond.unwrap_or(end), palette.caution),
            (beyond, end, palette.bad),
            (none, track.max, palette.edge),
        ] {
            if let Some(from) = from {
                painter.hline(from..=to, rect.center().y + MARK, Stroke::new(3.0, color));
            }
        }
        let fill = ui.visuals().panel_fill;
        let width = if response.hovered() || response.has_focus() { 3.0 } else { 2.0 };
        let centre = pos2(handle, rect.center().y);
        painter.circle(centre, HANDLE - 1.0, fill, Stroke::new(width, palette.accent));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Context, Event, PointerButton, RawInput, TouchPhase};

    /// The value after a finger has gone through positions, each with its time \[s\] and one frame.
    fn after_gesture(positions: &[(f64, Pos2)]) -> f64 {
        let ctx = Context::default();
        let (mut value, mut is_down) = (1.0, false);
        let mut frame = |time: f64, events: Vec<Event>| {
            let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, vec2(300.0, 100.0)));
            let input = RawInput { time: Some(time), events, screen_rect, ..RawInput::default() };
            let mut output = ctx.run_ui(input, |ui| {
                ui.put(Rect::from_min_size(pos2(100.0, 40.0), vec2(114.0, 24.0)), |ui: &mut Ui| {
                    let (range, allowed) = (0.0..=1.0, 0.0..=1.0);
                    let (step, logarithmic, width) = (0.01, false, 114.0);
                    let marks = [None; 3];
                    let name = "In place";
                    let rail = Rail { name, range, allowed, step, logarithmic, marks, width };
                    rail.show(ui, &mut value).response
                });
            });
            output.textures_delta.clear();
        };
        let touch = |phase, pos| Event::Touch {
            device_id: egui::TouchDeviceId(0),
            id: egui::TouchId(0),
            phase,
            pos,
            force: None,
        };
        let button = |pos, pressed| Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        frame(0.0, vec![]);
        for &(time, pos) in positions {
            if is_down {
                frame(time, vec![Event::PointerMoved(pos), touch(TouchPhase::Move, pos)]);
            } else {
                frame(time, vec![button(pos, true), touch(TouchPhase::Start, pos)]);
            }
            is_down = true;
        }
        if let Some(&(time, pos)) = positions.last() {
            let up = vec![button(pos, false), Event::PointerGone, touch(TouchPhase::End, pos)];
            frame(time + 0.1, up);
        }
        value
    }

    /// A finger that travels from the middle of the rail by `travel`, with a pause \[s\] between the frames.
    fn swiped(travel: egui::Vec2, pause: f64) -> f64 {
        let at = |k: u32| (0.1 + pause * f64::from(k), pos2(150.0, 52.0) + travel * k as f32 / 8.0);
        after_gesture(&(0..=8).map(at).collect::<Vec<_>>())
    }

    #[test]
    fn a_finger_moves_the_handle_however_slow_the_frames_and_long_the_rest() {
        // 40 of 100 points, 8 of them for the decision.
        for pause in [0.01, 0.06, 0.3, 0.5, 1.0] {
            let value = swiped(vec2(-40.0, 3.0), pause);
            assert!((value - 0.68).abs() < 0.011, "{value} at {pause} s a frame");
        }
        let from = pos2(150.0, 52.0);
        let rest = [(0.1, from), (0.5, from), (1.0, from), (2.0, from)];
        assert_eq!(after_gesture(&rest).to_bits(), 1f64.to_bits());
        let drag = (1..=4).map(|k| (2.0 + 0.02 * f64::from(k), from - vec2(10.0 * k as f32, 0.0)));
        let value = after_gesture(&rest.into_iter().chain(drag).collect::<Vec<_>>());
        assert!((value - 0.68).abs() < 0.011, "{value} after a rest");
    }

    #[test]
    fn a_finger_across_the_rail_keeps_the_value() {
        for pause in [0.01, 0.3, 1.0] {
            assert_eq!(swiped(vec2(4.0, 40.0), pause).to_bits(), 1f64.to_bits());
        }
    }
}

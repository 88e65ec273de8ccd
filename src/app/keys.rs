//! Keyboard shortcuts, and playback of the insertion.

use super::App;
use crate::scene::Scene;
use crate::session::Command;
use eframe::egui::{self, Key, Modifiers};

/// Duration of the playback from flat to full height \[s\].
const PLAY_SECONDS: f64 = 5.0;
/// Step of the insertion by a key \[-\].
const INSERTION_STEP: f64 = 0.02;

impl App {
    /// Executes the shortcuts pressed since the previous frame.
    pub(super) fn handle_keys(&mut self, ctx: &egui::Context) {
        ctx.input_mut(|input| self.palette.hold_typing(input));
        for command in ctx.input_mut(take_history_keys) {
            self.execute(command);
        }
        self.run_keys(ctx, false);
        self.escape(ctx);
        // Single keys act on the picture while it has the focus. Elsewhere they are text.
        let focused = ctx.memory(egui::Memory::focused);
        if focused.is_none() || focused != self.viewport.id() {
            return;
        }
        // A slow frame may contain several presses of a key.
        let presses =
            |modifiers, key| ctx.input_mut(|input| input.count_and_consume_key(modifiers, key));
        for (key, step) in [
            (Key::OpenBracket, -INSERTION_STEP),
            (Key::CloseBracket, INSERTION_STEP),
            (Key::ArrowDown, -INSERTION_STEP),
            (Key::ArrowUp, INSERTION_STEP),
        ] {
            let count = presses(Modifiers::NONE, key);
            if count > 0 {
                let mut scene = self.session.scene().clone();
                // Rounded to whole percent: steps of 0.02 accumulate rounding errors.
                let percent = (100.0 * (scene.insertion + count as f64 * step)).round();
                scene.insertion = (percent / 100.0).clamp(0.0, 1.0);
                self.gesture += 1;
                self.execute(Command::Edit { scene: Box::new(scene), gesture: self.gesture });
            }
        }
        self.run_keys(ctx, true);
    }

    /// Escape cancels a drag of a handle or a slider, or removes a mark of the picture, unless Escape belongs to another control.
    fn escape(&mut self, ctx: &egui::Context) {
        let is_pressed = ctx.input(|input| input.key_pressed(Key::Escape));
        let is_elsewhere = self.show_help || self.curve_window.is_some() || self.palette.is_open();
        if !is_pressed || is_elsewhere || egui::Popup::is_any_open(ctx) {
            return;
        }
        let picture = self.viewport.id();
        let has_focus = self.focus.is_on(picture);
        let is_free = has_focus || self.focus.is_nowhere();
        let is_taken =
            self.cancel_press(ctx) || (is_free && !self.is_long() && self.viewport.remove_mark());
        if is_taken {
            // Escape has removed the focus; the next key is one for the picture too.
            if let Some(picture) = picture.filter(|_| has_focus) {
                ctx.memory_mut(|memory| memory.request_focus(picture));
            }
            ctx.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, Key::Escape));
        }
    }

    /// Cancels the drag of a handle or a slider: plan and history are as before, and the rest of the drag changes nothing. Returns
    /// whether there was one.
    fn cancel_press(&mut self, ctx: &egui::Context) -> bool {
        let is_held = ctx.input(|input| input.pointer.any_down());
        if !is_held || self.is_playing || self.press.is_cancelled {
            return false;
        }
        let before = self.session.scene().clone();
        self.execute(Command::CancelGesture(self.gesture));
        let is_edited = before != *self.session.scene();
        if is_edited || self.drag.is_some() {
            self.press.is_cancelled = true;
            self.plan = self.press.choices;
        }
        self.press.is_cancelled
    }

    pub(super) fn toggle_playback(&mut self) {
        self.is_playing = !self.is_playing;
        self.gesture += 1;
    }

    /// Advances the insertion during playback by one step, once the previous step is solved.
    pub(super) fn advance_playback(&mut self, ctx: &egui::Context, scene: &mut Scene) {
        if !self.is_playing || self.session.is_working() {
            return;
        }
        let since = if self.was_paused { 0.0 } else { ctx.input(|input| input.stable_dt) };
        let seconds = f64::from(since).clamp(0.01, 0.2);
        scene.insertion = if scene.insertion >= 1.0 {
            0.0
        } else {
            (scene.insertion + seconds / PLAY_SECONDS).min(1.0)
        };
        self.is_playing = scene.insertion < 1.0;
    }
}

/// Undo and redo of the keys pressed since the previous frame, in their order.
fn take_history_keys(input: &mut egui::InputState) -> Vec<Command> {
    let mut commands = Vec::new();
    input.events.retain(|event| {
        let egui::Event::Key { key, pressed: true, modifiers, .. } = event else { return true };
        let command = match key {
            Key::Z if modifiers.matches_exact(Modifiers::COMMAND) => Command::Undo,
            Key::Z if modifiers.matches_exact(Modifiers::COMMAND | Modifiers::SHIFT) => {
                Command::Redo
            }
            Key::Y if modifiers.matches_exact(Modifiers::COMMAND) => Command::Redo,
            _ => return true,
        };
        commands.push(command);
        false
    });
    commands
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn undo_and_redo_of_a_frame_keep_their_order() {
        let press = |modifiers, key| egui::Event::Key {
            key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers,
        };
        let [undo, redo] = [Modifiers::COMMAND, Modifiers::COMMAND | Modifiers::SHIFT];
        let other = press(undo, Key::S);
        let mut input = egui::InputState::default();
        input.events = vec![
            press(undo, Key::Z),
            press(redo, Key::Z),
            other.clone(),
            press(undo, Key::Z),
            press(undo, Key::Y),
            press(undo, Key::Z),
        ];
        let is_undo: Vec<bool> =
            take_history_keys(&mut input).iter().map(|c| matches!(c, Command::Undo)).collect();
        assert_eq!(is_undo, [true, false, true, false, true]);
        assert_eq!(input.events, [other]);
    }
}

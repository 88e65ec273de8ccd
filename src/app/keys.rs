//! Keyboard shortcuts, and playback of the insertion.

use super::{App, view_bar};
use crate::scene::Scene;
use crate::session::Command;
use crate::view::camera::View;
use eframe::egui::{self, Key, Modifiers};

/// Duration of the playback from flat to full height \[s\].
const PLAY_SECONDS: f64 = 5.0;
/// Step of the insertion by a key \[-\].
const INSERTION_STEP: f64 = 0.02;

impl App {
    /// Executes the shortcuts pressed since the previous frame.
    pub(super) fn handle_keys(&mut self, ctx: &egui::Context) {
        // A slow frame may contain several presses of a key.
        let presses =
            |modifiers, key| ctx.input_mut(|input| input.count_and_consume_key(modifiers, key));
        let shortcut = |modifiers, key| presses(modifiers, key) > 0;
        for command in ctx.input_mut(take_history_keys) {
            self.execute(command);
        }
        if shortcut(Modifiers::COMMAND, Key::O) {
            self.files.open(ctx);
        }
        if shortcut(Modifiers::COMMAND, Key::S) {
            self.save_scene(ctx);
        }
        // Single keys act on the picture while it has the focus. Elsewhere they are text.
        let focused = ctx.memory(egui::Memory::focused);
        if focused.is_none() || focused != self.viewport.id() {
            return;
        }
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
        (0..presses(Modifiers::NONE, Key::Space)).for_each(|_| self.toggle_playback());
        if shortcut(Modifiers::NONE, Key::F) {
            self.viewport.fit(&self.session, View::All);
        }
        for (key, quantity) in [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5]
            .into_iter()
            .zip(view_bar::QUANTITIES)
        {
            if shortcut(Modifiers::NONE, key) {
                self.options.quantity = quantity;
            }
        }
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

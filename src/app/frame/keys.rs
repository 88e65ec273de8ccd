//! Keys of history and insertion.

use crate::session::Command;
use eframe::egui::{self, Key, Modifiers};

/// Step of the insertion by a key \[-\].
const INSERTION_STEP: f64 = 0.02;

/// Step of the insertion by the keys of the picture pressed since the previous frame \[-\].
pub(crate) fn insertion_steps(ctx: &egui::Context) -> impl Iterator<Item = f64> {
    // A slow frame may contain several presses of a key.
    let presses = |key| ctx.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, key));
    let steps = [
        (Key::OpenBracket, -INSERTION_STEP),
        (Key::CloseBracket, INSERTION_STEP),
        (Key::ArrowDown, -INSERTION_STEP),
        (Key::ArrowUp, INSERTION_STEP),
    ];
    steps.map(|(key, step)| presses(key) as f64 * step).into_iter().filter(|step| *step != 0.0)
}

/// Undo and redo of the keys pressed since the previous frame, in their order.
pub(crate) fn take_history_keys(input: &mut egui::InputState) -> Vec<Command> {
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

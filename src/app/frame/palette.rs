//! The list "Commands" (Ctrl+K): all commands, found by typing.
//!
//! Uses `action`, `commands`, `shared`, `theme`, `widgets`. Used by `logic`, `perform`.

use super::action::Action;
use super::commands::{COMMANDS, Entry, LIST_KEY, is_hidden, refusal, why_not};
use super::shared::Shared;
use crate::app::plan::device::Device;
use crate::app::texts::tr;
use crate::app::widgets::set_accessible_name;
use crate::app::widgets::theme;
use eframe::egui::{self, Event, InputState, Key, Modifiers, RichText, Ui};

/// Title of the list.
const TITLE: &str = "Commands";
/// Name of the field.
const SEARCH: &str = "Search a command";
/// Width and greatest height of the list \[points\].
const SIZE: egui::Vec2 = egui::vec2(420.0, 300.0);

/// State of the list.
#[derive(Debug, Default)]
pub(crate) struct Palette {
    is_open: bool,
    /// Is this the first frame?
    is_new: bool,
    text: String,
    /// Place of the chosen command among the found ones.
    chosen: usize,
    /// What was typed after the key of the list in the frame of that key.
    typed: Vec<Event>,
}

impl Palette {
    pub(crate) fn is_open(&self) -> bool {
        self.is_open
    }

    /// Opens the list with an empty field, or closes the list.
    pub(crate) fn toggle(&mut self) {
        let is_open = !self.is_open;
        let typed = std::mem::take(&mut self.typed);
        *self = Self { is_open, is_new: is_open, typed, ..Self::default() };
    }

    /// Keeps what follows the key of the list in a slow frame for the frame in which the field of the list has the focus.
    pub(crate) fn hold_typing(&mut self, input: &mut InputState) {
        input.events.splice(0..0, std::mem::take(&mut self.typed));
        let is_key = |event: &Event| {
            matches!(event, Event::Key { key: LIST_KEY, pressed: true, modifiers, .. }
                if modifiers.matches_logically(Modifiers::COMMAND))
        };
        if self.is_open {
            return;
        }
        if let Some(at) = input.events.iter().position(is_key) {
            let is_typing = |event: &mut Event| {
                matches!(event, Event::Text(_) | Event::Key { pressed: true, .. })
            };
            self.typed = input.events.extract_if(at + 1.., is_typing).collect();
        }
    }
}

/// What the keys of a frame do.
#[derive(Default)]
struct Keys {
    steps: isize,
    is_entered: bool,
    is_escaped: bool,
}

impl Keys {
    fn take(ctx: &egui::Context) -> Self {
        ctx.input_mut(|input| {
            let mut count = |key| input.count_and_consume_key(Modifiers::NONE, key);
            let steps = count(Key::ArrowDown) as isize - count(Key::ArrowUp) as isize;
            Self { steps, is_entered: count(Key::Enter) > 0, is_escaped: count(Key::Escape) > 0 }
        })
    }
}

impl Palette {
    /// Shows the list; adds the chosen command, or why that does nothing.
    pub(crate) fn show(&mut self, ctx: &egui::Context, shared: &Shared, actions: &mut Vec<Action>) {
        if !self.is_open {
            return;
        }
        // The keys of the frame that opens the list are those before the key of the list: another control's.
        let keys = if self.is_new { Keys::default() } else { Keys::take(ctx) };
        let mut picked = None;
        let screen = ctx.content_rect().width().max(theme::LEAST_WINDOW.x);
        let width = SIZE.x.min(screen - 6.0 * theme::SPACE);
        let mut is_open = !keys.is_escaped;
        egui::Window::new(tr(TITLE))
            .open(&mut is_open)
            .collapsible(false)
            .resizable(false)
            .anchor(egui::Align2::CENTER_TOP, [0.0, 8.0 * theme::SPACE])
            .show(ctx, |ui| {
                ui.set_width(width);
                self.search_field(ui);
                // What a slow frame has typed counts before its Enter key.
                let mut found = found(&self.text, shared.choices.device);
                found.retain(|entry| !is_hidden(shared, entry.task));
                let (most, chosen) = (found.len().saturating_sub(1), &mut self.chosen);
                *chosen = chosen.saturating_add_signed(keys.steps).min(most);
                picked = found.get(*chosen).copied().filter(|_| keys.is_entered);
                let list = egui::ScrollArea::vertical().max_height(SIZE.y);
                list.auto_shrink([false, true]).show(ui, |ui| {
                    for (k, entry) in found.iter().enumerate() {
                        if self.row(ui, shared, entry, k, keys.steps != 0) {
                            picked = Some(entry);
                        }
                    }
                    if found.is_empty() {
                        ui.weak(tr("No command has these words in its name."));
                    }
                });
            });
        self.is_new = false;
        if !self.typed.is_empty() {
            ctx.request_repaint();
        }
        if picked.is_some() || !is_open {
            *self = Self::default();
            ctx.request_repaint();
        }
        actions.extend(picked.map(|entry| match why_not(shared, entry.task) {
            Some(why) => Action::Notify(refusal(entry, why)),
            None => Action::Run(entry.task),
        }));
    }

    fn search_field(&mut self, ui: &mut Ui) {
        let field = egui::TextEdit::singleline(&mut self.text)
            .hint_text(tr(SEARCH))
            .char_limit(60)
            .desired_width(f32::INFINITY);
        let response = ui.add(field);
        // Before the name: only a frame in which the field gains the focus reports it.
        if self.is_new {
            response.request_focus();
        }
        set_accessible_name(&response, egui::Role::TextInput, tr(SEARCH));
        if response.changed() {
            self.chosen = 0;
        }
    }

    /// A command of the list with its keys; returns whether the command was clicked.
    fn row(&self, ui: &mut Ui, shared: &Shared, entry: &Entry, k: usize, is_moved: bool) -> bool {
        let is_chosen = self.chosen == k;
        let is_able = why_not(shared, entry.task).is_none();
        let words = shared.choices.device.words(tr(entry.name));
        let name = RichText::new(&words);
        let name = if is_able { name } else { name.weak() };
        let keys = entry.keys(ui.ctx().os());
        let button = egui::Button::selectable(is_chosen, name)
            .right_text(RichText::new(&keys).small())
            .min_size(egui::vec2(ui.available_width(), 24.0));
        let response = ui.add(button);
        let name = format!("{words} {keys}");
        set_accessible_name(&response, egui::Role::MenuItem, name.trim_end());
        if is_chosen && is_moved {
            response.scroll_to_me(None);
        }
        let is_clicked = response.clicked();
        if !entry.tooltip.is_empty() {
            response.on_hover_text(tr(entry.tooltip));
        }
        is_clicked
    }
}

/// Commands with all words of a text in their name or description; first those with the text in the name.
fn found(text: &str, device: Device) -> Vec<&'static Entry> {
    let text = text.trim().to_lowercase();
    let has = |entry: &&Entry| {
        let words = format!("{} {}", tr(entry.name), tr(entry.tooltip));
        let words = device.words(&words).to_lowercase();
        text.split_whitespace().all(|word| words.contains(word))
    };
    let mut found: Vec<&Entry> = COMMANDS.iter().filter(has).collect();
    found.sort_by_key(|entry| tr(entry.name).to_lowercase().find(&text).unwrap_or(usize::MAX));
    if text.is_empty() {
        return COMMANDS.iter().collect();
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(text: &str) -> Vec<&'static str> {
        found(text, Device::Implant).into_iter().map(|entry| entry.name).collect()
    }

    #[test]
    fn words_in_any_order_find_a_command_and_names_come_before_descriptions() {
        assert_eq!(names("").len(), COMMANDS.len());
        assert_eq!(names("")[0], "Open plan or scan…");
        assert_eq!(names("  RULER ")[0], "Ruler");
        assert_eq!(names("picture save")[0], "Save picture (PNG)…");
        assert_eq!(names("plan")[0], "Open plan or scan…");
        assert!(names("undo")[0] == "Undo" && names("undo").contains(&"Start over"));
        assert!(
            ["stock", "table of sizes"].iter().all(|text| names(text)[0] == "Open sizes in stock…")
        );
        assert!(names("no such thing").is_empty());
    }
}

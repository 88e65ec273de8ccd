//! The commands of menus, keys, the list "Commands" and the help: one table.
//!
//! Uses `messages`, `report`, `strip`. Used by `keys`, `palette`, `range`, `toolbar`, `view_bar`.

use super::messages::Notice;
use super::report::Purpose;
use super::strip::CROSS_SECTION;
use super::texts::{Language, tr};
use super::{App, plan};
use crate::export;
use crate::scene::Scene;
use crate::session::Command;
use crate::view::camera::View;
use crate::view::color::Quantity;
use eframe::egui::os::OperatingSystem;
use eframe::egui::{self, Key, Modifiers, Ui};

/// Quantities of the keys 1 to 5.
const QUANTITIES: [Quantity; 5] = [
    Quantity::Tissue,
    Quantity::Strain,
    Quantity::AreaStretch,
    Quantity::Stress(0),
    Quantity::Pressure,
];

/// What a command does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Action {
    OpenPlan,
    SavePlan,
    SaveNumbers,
    SaveTable,
    TakeHome(Purpose),
    CopyLink,
    SaveProfile,
    UsualImplant,
    HalfSphere,
    Undo,
    Redo,
    StartOver,
    Pin,
    Look(View),
    /// Cut open; in half.
    Cut(bool, bool),
    /// Number of the quantity.
    Colour(usize),
    Grid,
    Areola,
    CrossSection,
    Torso,
    Ruler,
    Play,
    /// The range of implants in place of the picture?
    ShowRange(bool),
    Theme(egui::ThemePreference),
    Language(Language),
    List,
    Help,
}

/// Where a key counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Keyed {
    No,
    /// With Ctrl (Cmd on a Mac), everywhere.
    Everywhere(Key),
    /// While the picture has the focus; elsewhere the key is text.
    OnPicture(Key),
    /// A key that another part of the program takes: its words.
    Elsewhere(&'static str),
}

/// A command.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub(super) action: Action,
    pub(super) name: &'static str,
    pub(super) tooltip: &'static str,
    pub(super) keyed: Keyed,
}

const fn entry(action: Action, name: &'static str, tooltip: &'static str) -> Entry {
    Entry { action, name, tooltip, keyed: Keyed::No }
}

const fn keyed(action: Action, name: &'static str, tooltip: &'static str, keyed: Keyed) -> Entry {
    Entry { action, name, tooltip, keyed }
}

/// The key of the list of commands, with Ctrl (Cmd on a Mac).
pub(super) const LIST_KEY: Key = Key::K;

/// Names of the switch in the middle of the screen.
pub(super) const PICTURE: &str = "Picture";
const RANGE: &str = "Range of implants";

const COMPOSED: &str = "Picture with title, plan, answers, legend, scale and date";
const REPORT: &str = "One or two pages with pictures, plan, numbers, pins and limits, and the chart of the range once that is computed; prints on \
     paper";
const TABLE: &str =
    "All results of plan and pins, with percentiles where bands are on, for a spreadsheet";
const LINK: &str =
    "The whole plan as an address, without the entries for the file; no server gets it";
const AREOLA: &str = "A circle of 4 cm on the skin at rest, over the middle of the pocket; the circle stretches with the skin";
const NO_RESULT: &str = "No result yet: the plan is being computed";

/// All commands, in the order of the list.
pub(super) const COMMANDS: [Entry; 41] = [
    keyed(Action::OpenPlan, "Open plan…", "", Keyed::Everywhere(Key::O)),
    keyed(Action::SavePlan, "Save plan…", "", Keyed::Everywhere(Key::S)),
    entry(Action::SaveNumbers, "Save numbers (JSON)…", ""),
    entry(Action::SaveTable, "Save numbers (CSV)…", TABLE),
    entry(Action::TakeHome(Purpose::File), "Save picture (PNG)…", COMPOSED),
    entry(Action::TakeHome(Purpose::Clipboard), "Copy picture", COMPOSED),
    entry(Action::TakeHome(Purpose::Report), "Save report (HTML)…", REPORT),
    entry(Action::CopyLink, "Copy link", LINK),
    entry(Action::SaveProfile, "Save profile (CSV)…", ""),
    entry(Action::UsualImplant, "Usual implant", "12 cm, 300 ml, pinch 2 cm, normal skin"),
    entry(
        Action::HalfSphere,
        "Half sphere of 11 cm",
        "The scene of the defaults of a file: much projection, lax skin, cover 11.5 mm",
    ),
    keyed(Action::Undo, "Undo", "", Keyed::Elsewhere("Ctrl+Z")),
    keyed(Action::Redo, "Redo", "", Keyed::Elsewhere("Ctrl+Shift+Z")),
    entry(Action::StartOver, "Start over", "Open the opening plan; Undo brings this plan back"),
    entry(Action::Pin, "Pin this plan", "Keep this plan and its result for comparison"),
    entry(Action::Look(View::Front), "Front", "From the front, the head up"),
    entry(Action::Look(View::Side), "Side", "From the patient's side"),
    entry(Action::Look(View::Top), "Top", "From the head"),
    keyed(
        Action::Look(View::All),
        "All",
        "Three-quarter view of everything (F)",
        Keyed::OnPicture(Key::F),
    ),
    entry(Action::Cut(false, false), "No cut", "The whole tissue"),
    entry(Action::Cut(true, false), "Cut a quarter", "Cut the tissue open to show its layers"),
    entry(Action::Cut(true, true), "Cut in half", "Cut the tissue open to show its layers"),
    keyed(Action::Colour(0), "Natural colours", "Colours", Keyed::OnPicture(Key::Num1)),
    keyed(Action::Colour(1), "Skin stretch", "Colours", Keyed::OnPicture(Key::Num2)),
    keyed(Action::Colour(2), "Skin area", "Colours", Keyed::OnPicture(Key::Num3)),
    keyed(Action::Colour(3), "Stress of the skin", "Colours", Keyed::OnPicture(Key::Num4)),
    keyed(Action::Colour(4), "Pressure", "Colours", Keyed::OnPicture(Key::Num5)),
    entry(Action::Grid, "Grid", "Lines show how the skin is pulled"),
    entry(Action::Areola, "Areola", AREOLA),
    entry(
        Action::CrossSection,
        CROSS_SECTION,
        "Skin, fat, implant and pocket under the picture, where there is room",
    ),
    entry(
        Action::Torso,
        "Torso",
        "Lines of a torso behind the tissue: which side is up, where the breast lies. No patient's shape",
    ),
    keyed(
        Action::Ruler,
        "Ruler",
        "Straight and along the skin between two points of the picture (R)",
        Keyed::OnPicture(Key::R),
    ),
    keyed(Action::Play, "Show insertion", "Show insertion (space)", Keyed::OnPicture(Key::Space)),
    entry(Action::ShowRange(false), PICTURE, "This plan in three dimensions"),
    entry(
        Action::ShowRange(true),
        RANGE,
        "A chart of many plans: width by projection, or any two numbers",
    ),
    entry(Action::Theme(egui::ThemePreference::Light), "Light theme", ""),
    entry(Action::Theme(egui::ThemePreference::Dark), "Dark theme", ""),
    entry(Action::Language(Language::English), "Language: English", ""),
    entry(Action::Language(Language::Spanish), "Language: Spanish (español)", ""),
    keyed(Action::List, "Commands…", "Find a command by its name", Keyed::Everywhere(LIST_KEY)),
    entry(Action::Help, "Help", ""),
];

/// The entry of an action.
pub(super) fn entry_of(action: Action) -> Entry {
    let known = COMMANDS.iter().find(|entry| entry.action == action);
    known.copied().unwrap_or(entry(action, "", ""))
}

impl Entry {
    /// The keys in words; empty without keys.
    pub(super) fn keys(&self, system: OperatingSystem) -> String {
        let words = match self.keyed {
            Keyed::No => String::new(),
            Keyed::Everywhere(key) => format!("Ctrl+{}", key.name()),
            Keyed::OnPicture(key) => key.name().to_owned(),
            Keyed::Elsewhere(words) => words.to_owned(),
        };
        let is_mac = matches!(system, OperatingSystem::Mac | OperatingSystem::IOS);
        if is_mac { words.replace("Ctrl", "Cmd") } else { words }
    }
}

impl App {
    /// Why a command does nothing at present; `None` for one that works.
    pub(super) fn why_not(&self, action: Action) -> Option<&'static str> {
        let unless = |works: bool, why| (!works).then_some(why);
        match action {
            Action::SaveNumbers | Action::SaveTable | Action::TakeHome(_) => {
                unless(self.session.result().is_some(), tr(NO_RESULT))
            }
            Action::SaveProfile => unless(self.has_shape(), tr(NO_RESULT)),
            Action::CopyLink => unless(self.page_address.is_some(), tr("Only in the page")),
            Action::Undo => unless(self.session.can_undo(), tr("Nothing to undo")),
            Action::Redo => unless(self.session.can_redo(), tr("Nothing to redo")),
            Action::Pin => {
                unless(self.session.free_letter().is_some(), tr("All four pins are in use"))
            }
            _ => None,
        }
    }

    /// Has the present plan a result with a shape?
    pub(super) fn has_shape(&self) -> bool {
        self.session.result().is_some() && !self.session.has_no_shape()
    }

    /// Is a switch on? `None` for a command that is no switch.
    pub(super) fn is_on(&self, action: Action) -> Option<bool> {
        match action {
            Action::Grid => Some(self.options.net),
            Action::Areola => Some(self.options.has_areola()),
            Action::CrossSection => Some(self.show_strip),
            Action::Torso => Some(self.options.torso),
            Action::Ruler => Some(self.viewport.has_ruler()),
            _ => None,
        }
    }

    /// Executes a command that works.
    pub(super) fn run(&mut self, ctx: &egui::Context, action: Action) {
        if self.why_not(action).is_some() {
            return;
        }
        match action {
            Action::OpenPlan => self.files.open(ctx),
            Action::SavePlan => self.save_scene(ctx),
            Action::SaveNumbers => self.save_result(ctx),
            Action::SaveTable => self.save_numbers(ctx),
            Action::TakeHome(purpose) => self.take_home(ctx, purpose),
            Action::CopyLink => {
                if let Some(address) = self.page_address.clone() {
                    self.copy_link(ctx, &address);
                }
            }
            Action::SaveProfile => {
                if let Some(outcome) = self.session.result() {
                    self.files.save(ctx, "profile.csv", export::profile(outcome));
                }
            }
            Action::UsualImplant | Action::StartOver => self.open_example(Scene::opening()),
            Action::HalfSphere => self.open_example(Scene::default()),
            Action::Undo => self.execute(Command::Undo),
            Action::Redo => self.execute(Command::Redo),
            Action::Pin => self.execute(Command::Pin),
            Action::Look(view) => self.viewport.fit(&self.session, view),
            Action::Cut(section, half) => {
                (self.options.section, self.options.half) = (section, half);
            }
            Action::Colour(k) => {
                self.options.quantity = QUANTITIES.get(k).copied().unwrap_or(Quantity::Tissue);
            }
            Action::Grid => self.options.net = !self.options.net,
            Action::Areola => {
                let areola = self.options.areola_mut();
                *areola = !*areola;
            }
            Action::CrossSection => self.show_strip = !self.show_strip,
            Action::Torso => {
                self.options.torso = !self.options.torso;
                self.viewport.look_at_torso(&self.session, self.options.torso);
            }
            Action::Ruler => {
                self.range.is_open = false;
                self.viewport.toggle_ruler();
            }
            Action::Play => self.toggle_playback(),
            Action::ShowRange(is_open) => self.range.is_open = is_open,
            Action::Theme(theme) => ctx.set_theme(theme),
            Action::Language(language) => self.choose_language(language),
            Action::List => self.palette.toggle(),
            Action::Help => self.show_help = !self.show_help,
        }
        self.request_frame();
    }

    fn open_example(&mut self, scene: Scene) {
        self.gesture += 1;
        self.execute(Command::Edit { scene: Box::new(scene), gesture: self.gesture });
        self.plan = plan::Choices::default();
        self.viewport.fit(&self.session, View::All);
    }

    /// An item of a menu.
    pub(super) fn menu_item(&mut self, ui: &mut Ui, action: Action) {
        if self.item(ui, action) {
            ui.close();
        }
    }

    /// The control of a command: a button, or a box with a tick for a switch. Returns whether the command was executed.
    pub(super) fn item(&mut self, ui: &mut Ui, action: Action) -> bool {
        let (entry, why_not) = (entry_of(action), self.why_not(action));
        let name = self.plan.device.words(tr(entry.name));
        let response = match self.is_on(action) {
            Some(mut is_on) => ui.checkbox(&mut is_on, name),
            None => ui.add_enabled(why_not.is_none(), egui::Button::new(name)),
        };
        let response = response.on_disabled_hover_text(why_not.unwrap_or_default());
        let is_clicked = response.clicked();
        if !entry.tooltip.is_empty() {
            response.on_hover_text(tr(entry.tooltip));
        }
        if is_clicked {
            self.run(&ui.ctx().clone(), action);
        }
        is_clicked
    }

    /// Executes the commands whose keys were pressed. `on_picture`: those of the picture, otherwise those of all places.
    pub(super) fn run_keys(&mut self, ctx: &egui::Context, on_picture: bool) {
        for entry in COMMANDS {
            let (modifiers, key) = match entry.keyed {
                Keyed::Everywhere(key) if !on_picture => (Modifiers::COMMAND, key),
                Keyed::OnPicture(key) if on_picture => (Modifiers::NONE, key),
                _ => continue,
            };
            // A slow frame may contain several presses of a key: a switch takes each, other commands run once.
            let presses = ctx.input_mut(|input| input.count_and_consume_key(modifiers, key));
            let is_switch = matches!(entry.action, Action::Play | Action::Ruler | Action::List);
            let times = if is_switch { presses } else { presses.min(1) };
            (0..times).for_each(|_| self.run(ctx, entry.action));
        }
    }
}

/// What of a notice a command without effect shows.
pub(super) fn refusal(entry: &Entry, why: &str) -> Notice {
    Notice::info(format!("{}: {why}.", tr(entry.name)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_command_has_one_name_and_every_key_one_command() {
        let names: HashSet<&str> = COMMANDS.iter().map(|entry| entry.name).collect();
        assert_eq!(names.len(), COMMANDS.len());
        let keys = COMMANDS.iter().map(|entry| entry.keys(OperatingSystem::Nix));
        let keys: Vec<String> = keys.filter(|keys| !keys.is_empty()).collect();
        assert_eq!(keys.iter().collect::<HashSet<_>>().len(), keys.len(), "{keys:?}");
        for entry in COMMANDS {
            assert_eq!(entry_of(entry.action).name, entry.name);
        }
    }

    #[test]
    fn a_mac_has_cmd_in_place_of_ctrl() {
        let keys = |system| entry_of(Action::List).keys(system);
        assert_eq!(keys(OperatingSystem::Nix), "Ctrl+K");
        assert_eq!(keys(OperatingSystem::Mac), "Cmd+K");
    }
}

//! The commands of menus, keys, the list "Commands" and the help: one table.
//!
//! Uses `action`, `messages`, `shared`, `strip`. Used by `logic`, `palette`, `perform`, `range`, `toolbar`, `view_bar`, `view_menu`.

use super::action::{Action, Purpose, Task};
use super::messages::Notice;
use super::shared::Shared;
use crate::app::picture::strip::CROSS_SECTION;
use crate::app::picture::viewport::{Before, PictureSubject};
use crate::app::texts::{Language, tr};
use crate::view::camera::View;
use crate::view::quantity::Quantity;
use eframe::egui::os::OperatingSystem;
use eframe::egui::{self, Key, Modifiers, Ui};

/// Quantities of the keys 1 to 5.
pub(crate) const QUANTITIES: [Quantity; 5] = [
    Quantity::Tissue,
    Quantity::Strain,
    Quantity::AreaStretch,
    Quantity::Stress(0),
    Quantity::Pressure,
];

/// Where a key counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Keyed {
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
pub(crate) struct Entry {
    pub(crate) task: Task,
    pub(crate) name: &'static str,
    pub(crate) tooltip: &'static str,
    pub(crate) keyed: Keyed,
}

const fn entry(task: Task, name: &'static str, tooltip: &'static str) -> Entry {
    Entry { task, name, tooltip, keyed: Keyed::No }
}

const fn keyed(task: Task, name: &'static str, tooltip: &'static str, keyed: Keyed) -> Entry {
    Entry { task, name, tooltip, keyed }
}

/// The key of the list of commands, with Ctrl (Cmd on a Mac).
pub(crate) const LIST_KEY: Key = Key::K;

/// Names of the switch in the middle of the screen.
pub(crate) const PICTURE: &str = "Picture";
const RANGE: &str = "Range of implants";

const OPEN: &str =
    "A plan, or a scan of her body (PLY, STL, OBJ, GLB); dropping the file does the same";
const SHELF: &str = "The clinic's table of sizes (CSV); dropping the file does the same";
const COMPOSED: &str = "Picture with title, plan, answers, legend, scale and date";
const REPORT: &str = "One or two pages with pictures, plan, numbers, pins and limits, and the chart of the range once that is computed; prints on \
     paper";
const TABLE: &str =
    "All results of plan and pins, with percentiles where bands are on, for a spreadsheet";
const LINK: &str =
    "The whole plan as an address, without the entries for the file; no server gets it";
const AREOLA: &str = "A circle of 4 cm on the skin at rest, over the middle of the pocket; the circle stretches with the skin";
const SURFACE: &str = "The plan's file then holds her body's surface, up to 300 kB; links and the browser's store never do";
const BEFORE: &str = "The body before, beside the body after, with one camera";
const WIPE: &str = "The body before in the left part of the picture; drag the border";
const RESEARCH: &str = "What physics and developers need: the grid, all colours, accuracy and model, numbers in N and kPa, formats of programs";
const NO_RESULT: &str = "No result yet: the plan is being computed";

/// All commands, in the order of the list.
pub(crate) const COMMANDS: [Entry; 49] = [
    keyed(Task::OpenPlan, "Open plan or scan…", OPEN, Keyed::Everywhere(Key::O)),
    entry(Task::OpenTable, "Open sizes in stock…", SHELF),
    keyed(Task::SavePlan, "Save plan…", "", Keyed::Everywhere(Key::S)),
    entry(Task::KeepSurface, "Keep her surface in the file", SURFACE),
    entry(Task::SaveNumbers, "Save numbers (JSON)…", ""),
    entry(Task::SaveTable, "Save numbers (CSV)…", TABLE),
    entry(Task::TakeHome(Purpose::File), "Save picture (PNG)…", COMPOSED),
    entry(Task::TakeHome(Purpose::Clipboard), "Copy picture", COMPOSED),
    entry(Task::TakeHome(Purpose::Report), "Save report (HTML)…", REPORT),
    entry(Task::CopyLink, "Copy link", LINK),
    entry(Task::SaveProfile, "Save profile (CSV)…", ""),
    entry(Task::UsualImplant, "Usual implant", "12 cm, 225 ml, pinch 2 cm, normal skin"),
    entry(
        Task::HalfSphere,
        "Half sphere of 11 cm",
        "The scene of the defaults of a file: much projection, lax skin, cover 11.5 mm",
    ),
    keyed(Task::Undo, "Undo", "", Keyed::Elsewhere("Ctrl+Z")),
    keyed(Task::Redo, "Redo", "", Keyed::Elsewhere("Ctrl+Shift+Z")),
    entry(Task::StartOver, "Start over", "Open the opening plan; Undo brings this plan back"),
    entry(Task::Pin, "Pin this plan", "Keep this plan and its result for comparison"),
    entry(Task::Look(View::Front), "Front", "From the front, the head up"),
    entry(Task::Look(View::Side), "Side", "From the patient's side, the head up"),
    entry(Task::Look(View::Top), "Top", "From the head"),
    keyed(
        Task::Look(View::All),
        "All",
        "Three-quarter view of everything (F)",
        Keyed::OnPicture(Key::F),
    ),
    entry(Task::Show(PictureSubject::Look), "Look", "The skin as it looks"),
    entry(Task::Show(PictureSubject::Inside), "Inside", "Cut open: skin, fat and implant"),
    entry(
        Task::Show(PictureSubject::Stretch),
        "Stretch",
        "How far the skin is stretched, by colours",
    ),
    entry(Task::Cut(false, false), "No cut", "The whole tissue"),
    entry(Task::Cut(true, false), "Cut a quarter", "Cut the tissue open to show its layers"),
    entry(Task::Cut(true, true), "Cut in half", "Cut the tissue open to show its layers"),
    keyed(Task::Colour(0), "Natural colours", "Colours", Keyed::OnPicture(Key::Num1)),
    keyed(Task::Colour(1), "Skin stretch", "Colours", Keyed::OnPicture(Key::Num2)),
    keyed(Task::Colour(2), "Skin area", "Colours", Keyed::OnPicture(Key::Num3)),
    keyed(Task::Colour(3), "Stress of the skin", "Colours", Keyed::OnPicture(Key::Num4)),
    keyed(Task::Colour(4), "Pressure", "Colours", Keyed::OnPicture(Key::Num5)),
    entry(Task::Grid, "Grid", "Lines show how the skin is pulled"),
    entry(Task::Areola, "Areola", AREOLA),
    entry(
        Task::CrossSection,
        CROSS_SECTION,
        "Skin, fat, implant and pocket under the picture, where there is room",
    ),
    entry(
        Task::Torso,
        "Torso",
        "A body with both breasts as the plan makes them, uncut. No patient's shape",
    ),
    entry(Task::ShowBefore(Before::Beside), "Before | after", BEFORE),
    entry(Task::ShowBefore(Before::Wipe), "Wipe", WIPE),
    keyed(
        Task::Ruler,
        "Ruler",
        "Straight and along the skin between two points of the picture (R)",
        Keyed::OnPicture(Key::R),
    ),
    entry(Task::Research, "Research", RESEARCH),
    keyed(Task::Play, "Show insertion", "Show insertion (space)", Keyed::OnPicture(Key::Space)),
    entry(Task::ShowRange(false), PICTURE, "This plan in three dimensions"),
    entry(
        Task::ShowRange(true),
        RANGE,
        "A chart of many plans: width by projection, or any two numbers",
    ),
    entry(Task::Theme(egui::ThemePreference::Light), "Light theme", ""),
    entry(Task::Theme(egui::ThemePreference::Dark), "Dark theme", ""),
    entry(Task::Language(Language::English), "Language: English", ""),
    entry(Task::Language(Language::Spanish), "Language: Spanish (español)", ""),
    keyed(Task::List, "Commands…", "Find a command by its name", Keyed::Everywhere(LIST_KEY)),
    entry(Task::Help, "Help", ""),
];

/// The entry of a task.
pub(crate) fn entry_of(task: Task) -> Entry {
    let known = COMMANDS.iter().find(|entry| entry.task == task);
    known.copied().unwrap_or(entry(task, "", ""))
}

impl Entry {
    /// The keys in words; empty without keys.
    pub(crate) fn keys(&self, system: OperatingSystem) -> String {
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

/// Why a command does nothing at present; `None` for one that works.
pub(crate) fn why_not(shared: &Shared, task: Task) -> Option<&'static str> {
    let session = &shared.session;
    let unless = |works: bool, why| (!works).then_some(why);
    match task {
        Task::SaveNumbers | Task::SaveTable | Task::TakeHome(_) => {
            unless(session.result().is_some(), tr(NO_RESULT))
        }
        Task::SaveProfile => unless(shared.has_shape(), tr(NO_RESULT)),
        Task::CopyLink => unless(shared.page_address.is_some(), tr("Only in the page")),
        Task::Undo => unless(session.can_undo(), tr("Nothing to undo")),
        Task::Redo => unless(session.can_redo(), tr("Nothing to redo")),
        Task::KeepSurface => unless(shared.has_surface(), tr("The plan has no scanned body")),
        Task::ShowBefore(_) => {
            unless(shared.options.has_torso(), tr("Only where the body is drawn uncut"))
        }
        Task::Pin => unless(session.free_letter().is_some(), tr("All four pins are in use")),
        _ => None,
    }
}

/// Is a switch on? `None` for a command that is no switch.
pub(crate) fn is_on(shared: &Shared, task: Task) -> Option<bool> {
    match task {
        Task::Grid => Some(shared.options.net),
        Task::Areola => Some(shared.options.has_areola()),
        Task::CrossSection => Some(shared.show_strip),
        Task::Torso => Some(shared.options.torso),
        Task::KeepSurface => Some(shared.keep_surface),
        Task::ShowBefore(way) => Some(shared.options.before == way),
        Task::Ruler => Some(shared.viewport.has_ruler()),
        Task::Research => Some(shared.research),
        _ => None,
    }
}

/// Is a command behind the switch "Research"? A switch that is on stays in sight.
pub(crate) fn is_hidden(shared: &Shared, task: Task) -> bool {
    let is_for_research = matches!(
        task,
        Task::SaveNumbers
            | Task::SaveProfile
            | Task::HalfSphere
            | Task::Look(View::Top)
            | Task::Colour(2 | 3)
            | Task::Grid
    );
    is_for_research && !shared.research && is_on(shared, task) != Some(true)
}

/// An item of a menu.
pub(crate) fn menu_item(ui: &mut Ui, shared: &Shared, task: Task, actions: &mut Vec<Action>) {
    if item(ui, shared, task, actions) {
        ui.close();
    }
}

/// The control of a command, unless that is hidden: a button, or a box with a tick for a switch. Returns whether it was clicked.
pub(crate) fn item(ui: &mut Ui, shared: &Shared, task: Task, actions: &mut Vec<Action>) -> bool {
    if is_hidden(shared, task) {
        return false;
    }
    let (entry, why_not) = (entry_of(task), why_not(shared, task));
    let name = shared.choices.device.words(tr(entry.name));
    let response = match is_on(shared, task) {
        Some(mut is_on) => ui.checkbox(&mut is_on, name),
        None => ui.add_enabled(why_not.is_none(), egui::Button::new(name)),
    };
    let response = response.on_disabled_hover_text(why_not.unwrap_or_default());
    let is_clicked = response.clicked();
    if !entry.tooltip.is_empty() {
        response.on_hover_text(tr(entry.tooltip));
    }
    if is_clicked {
        actions.push(Action::Run(task));
    }
    is_clicked
}

/// The commands whose keys were pressed. `on_picture`: those of the picture, otherwise those of all places.
pub(crate) fn pressed(ctx: &egui::Context, on_picture: bool) -> Vec<Task> {
    let mut tasks = Vec::new();
    for entry in COMMANDS {
        let (modifiers, key) = match entry.keyed {
            Keyed::Everywhere(key) if !on_picture => (Modifiers::COMMAND, key),
            Keyed::OnPicture(key) if on_picture => (Modifiers::NONE, key),
            _ => continue,
        };
        // A slow frame may contain several presses of a key: a switch takes each, other commands run once.
        let presses = ctx.input_mut(|input| input.count_and_consume_key(modifiers, key));
        let is_switch = matches!(entry.task, Task::Play | Task::Ruler | Task::List);
        let times = if is_switch { presses } else { presses.min(1) };
        tasks.extend((0..times).map(|_| entry.task));
    }
    tasks
}

/// What of a notice a command without effect shows.
pub(crate) fn refusal(entry: &Entry, why: &str) -> Notice {
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
            assert_eq!(entry_of(entry.task).name, entry.name);
        }
    }

    #[test]
    fn a_mac_has_cmd_in_place_of_ctrl() {
        let keys = |system| entry_of(Task::List).keys(system);
        assert_eq!(keys(OperatingSystem::Nix), "Ctrl+K");
        assert_eq!(keys(OperatingSystem::Mac), "Cmd+K");
    }
}

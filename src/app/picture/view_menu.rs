//! The menu "View": on a narrow screen standard views and range; cut, colours and switches of the picture; theme, language, "Research".
//!
//! Uses `action`, `commands`, `shared`, `texts`, `viewport`, `widgets`. Used by `toolbar`, `view_bar`.

use super::viewport::{Before, Options};
use crate::app::frame::action::{Action, Task};
use crate::app::frame::commands::{entry_of, menu_item};
use crate::app::frame::shared::Shared;
use crate::app::texts::{self, tr};
use crate::app::widgets::{choice, menu, set_accessible_name};
use crate::view::camera::View;
use crate::view::quantity::Quantity;
use eframe::egui::{self, Ui};

/// How the tissue is cut open: cut; in half. The names are those of the commands.
const CUTS: [(bool, bool); 3] = [(false, false), (true, false), (true, true)];
/// The colours without "Research".
const OFTEN: [Quantity; 4] =
    [Quantity::Tissue, Quantity::Strain, Quantity::Cover, Quantity::Pressure];
/// The standard views.
pub(crate) const VIEWS: [View; 4] = [View::Front, View::Side, View::Top, View::All];

/// The menu of the picture, of preferences and of all commands; on a narrow screen on the picture, with the standard views and the range.
pub(crate) fn view_menu(ui: &mut Ui, is_narrow: bool, shared: &Shared, actions: &mut Vec<Action>) {
    let name = if is_narrow { "…" } else { tr("View") };
    let button = menu(ui, name, |ui| {
        if is_narrow {
            ui.horizontal(|ui| {
                for view in VIEWS {
                    menu_item(ui, shared, Task::Look(view), actions);
                }
            });
            menu_item(ui, shared, Task::ShowRange(true), actions);
        } else {
            menu_item(ui, shared, Task::CrossSection, actions);
        }
        ui.menu_button(tr("Cut"), |ui| cuts(ui, &shared.options, actions));
        ui.menu_button(tr("Colours"), |ui| colours(ui, shared, actions));
        if is_narrow && shared.options.has_torso() {
            for way in [Before::Beside, Before::Wipe] {
                menu_item(ui, shared, Task::ShowBefore(way), actions);
            }
        }
        for task in [Task::Areola, Task::Torso, Task::Grid, Task::Ruler] {
            menu_item(ui, shared, task, actions);
        }
        ui.separator();
        theme_menu(ui);
        language_item(ui, actions);
        menu_item(ui, shared, Task::Research, actions);
        ui.separator();
        menu_item(ui, shared, Task::List, actions);
    });
    set_accessible_name(&button, egui::Role::Button, tr("View"));
}

fn cuts(ui: &mut Ui, options: &Options, actions: &mut Vec<Action>) {
    let present = (options.section, options.section && options.half);
    for cut in CUTS {
        let task = Task::Cut(cut.0, cut.1);
        if choice(ui, cut == present, tr(entry_of(task).name)).clicked() {
            actions.push(Action::Run(task));
        }
    }
}

fn colours(ui: &mut Ui, shared: &Shared, actions: &mut Vec<Action>) {
    let present = shared.options.quantity;
    for quantity in Quantity::of_scene(shared.session.scene()) {
        if !(shared.research || quantity == present || OFTEN.contains(&quantity)) {
            continue;
        }
        if choice(ui, present == quantity, name_of(quantity, shared)).clicked() {
            actions.push(Action::ColourBy(quantity));
        }
    }
}

/// The choice of the theme.
fn theme_menu(ui: &mut Ui) {
    ui.menu_button(tr("Theme"), |ui| {
        let mut preference = ui.ctx().options(|options| options.theme_preference);
        for (choice, name) in [
            (egui::ThemePreference::System, tr("System")),
            (egui::ThemePreference::Light, tr("Light")),
            (egui::ThemePreference::Dark, tr("Dark")),
        ] {
            if ui.radio_value(&mut preference, choice, name).clicked() {
                ui.ctx().set_theme(choice);
                ui.close();
            }
        }
    });
}

/// The item of the other language, with that language's own name.
fn language_item(ui: &mut Ui, actions: &mut Vec<Action>) {
    let other = texts::language().other();
    if ui.button(other.name()).clicked() {
        actions.push(Action::Run(Task::Language(other)));
        ui.close();
    }
}

/// The name of a quantity of the plan in the menu.
fn name_of(quantity: Quantity, shared: &Shared) -> String {
    let layers = &shared.session.scene().layers;
    let layer = quantity.layer().and_then(|layer| layers.get(layer));
    let tissue = layer.map_or(tr("layer"), |layer| texts::tissue(&layer.tissue));
    let name = shared.choices.device.words(tr(quantity.name()));
    texts::filled(&name, &[("tissue", &tissue)])
}

//! Commands by their names: the list, its keys, the help.

use super::hands::{Screen, desktop, scene};
use super::{DESKTOP, flat_plan, press, researching, settle};
use eframe::egui::{self, Key, Modifiers, Role};
use egui_kittest::kittest::{NodeT, Queryable};

fn open_list(harness: &mut Screen) {
    harness.key_press_modifiers(Modifiers::COMMAND, Key::K);
    harness.run();
}

#[test]
fn a_command_is_found_by_typing_and_executed_by_enter() {
    let mut harness = desktop();
    open_list(&mut harness);
    assert!(harness.get_by_role_and_label(Role::TextInput, "Search a command").is_focused());
    harness.get_by_role_and_label(Role::MenuItem, "Open plan or scan… Ctrl+O");
    harness.event(egui::Event::Text("range".to_owned()));
    harness.run();
    assert!(harness.query_by_role_and_label(Role::MenuItem, "Open plan or scan… Ctrl+O").is_none());
    harness.key_press(Key::Enter);
    harness.run();
    assert!(harness.query_by_label("Search a command").is_none());
    assert!(harness.query_by_role_and_label(Role::Canvas, "3-D view").is_none());
}

#[test]
fn arrows_choose_a_command_and_escape_closes_the_list() {
    let mut harness = researching(DESKTOP, |scene| *scene = flat_plan());
    let grid = |harness: &mut Screen| {
        press(harness, "View");
        let grid = harness.get_by_role_and_label(Role::CheckBox, "Grid").accesskit_node().toggled();
        harness.key_press(Key::Escape);
        harness.run();
        grid
    };
    let before = grid(&mut harness);
    open_list(&mut harness);
    // First "Usual implant", then "Range of implants".
    harness.event(egui::Event::Text("implant".to_owned()));
    harness.run();
    harness.key_press(Key::ArrowDown);
    harness.key_press(Key::Enter);
    harness.run();
    assert!(harness.query_by_role_and_label(Role::Canvas, "3-D view").is_none());
    open_list(&mut harness);
    harness.event(egui::Event::Text("picture three".to_owned()));
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
    harness.get_by_role_and_label(Role::Canvas, "3-D view");
    open_list(&mut harness);
    harness.event(egui::Event::Text("grid".to_owned()));
    harness.run();
    harness.key_press(Key::Enter);
    harness.run();
    assert_ne!(grid(&mut harness), before);
    open_list(&mut harness);
    harness.event(egui::Event::Text("half sphere".to_owned()));
    harness.run();
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert_eq!(scene(&harness).implant.base_radius_mm, 55.0);
    press(&mut harness, "Undo");
    open_list(&mut harness);
    harness.key_press(Key::Escape);
    harness.run();
    assert!(harness.query_by_label("Search a command").is_none());
    // A command without effect has a reason.
    open_list(&mut harness);
    harness.event(egui::Event::Text("undo".to_owned()));
    harness.run();
    harness.get_by_role_and_label(Role::MenuItem, "Undo Ctrl+Z").click();
    harness.run();
    harness.get_by_label("Undo: Nothing to undo.");
}

#[test]
fn the_help_lists_the_keys_of_commands() {
    let mut harness = desktop();
    press(&mut harness, "Help");
    for words in ["Ctrl+K", "commands", "Ctrl+Z", "on the picture: ruler"] {
        harness.get_by_label(words);
    }
}

#[test]
fn the_list_opens_from_a_number_field_also_in_the_frame_of_its_enter_key() {
    let mut harness = desktop();
    let volume = harness.get_by_role_and_label(Role::SpinButton, "Volume (ml)").value().unwrap();
    harness.get_by_role_and_label(Role::SpinButton, "Volume (ml)").focus();
    harness.run();
    harness.event(egui::Event::Text("340".to_owned()));
    harness.run();
    // One slow frame: Enter for the number, then the list, words and Enter for the list.
    let press = |key, modifiers| egui::Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers,
    };
    let events = &mut harness.input_mut().events;
    events.push(press(Key::Enter, Modifiers::NONE));
    events.push(press(Key::K, Modifiers::COMMAND));
    events.push(egui::Event::Text("range".to_owned()));
    settle(&mut harness);
    assert!(harness.get_by_role_and_label(Role::TextInput, "Search a command").is_focused());
    let now = harness.get_by_role_and_label(Role::SpinButton, "Volume (ml)").value().unwrap();
    assert!(volume != "340" && now == "340", "{volume} {now}");
    let field = harness.get_by_role_and_label(Role::TextInput, "Search a command");
    assert_eq!(field.value().as_deref(), Some("range"));
    let events = &mut harness.input_mut().events;
    events.push(egui::Event::Text(" of".to_owned()));
    events.push(press(Key::Enter, Modifiers::NONE));
    settle(&mut harness);
    assert!(harness.query_by_role_and_label(Role::Canvas, "3-D view").is_none());
}

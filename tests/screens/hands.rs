//! Hands on the picture: cross-section in sight, values at a point, ruler, handles of the implant, commands by their names.

use super::{
    DESKTOP, PHONE, app, flat_plan, focus_picture, painted_texts, press, researching, settle,
    type_into, unfold,
};
use eframe::egui::{self, Key, Modifiers, Pos2, Role, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use implant_preview::app::App;
use implant_preview::scene::Scene;

type Screen = Harness<'static, App>;

fn desktop() -> Screen {
    app(DESKTOP, |scene| {
        *scene = flat_plan();
        scene.solver.nodes_per_side = 33;
    })
}

/// A choice of the menu "View".
fn choose(harness: &mut Screen, name: &str) {
    press(harness, "View");
    harness.get_by_role_and_label(Role::CheckBox, name).click();
    harness.run();
}

fn has_strip(harness: &Screen) -> bool {
    harness.query_by_role_and_label(Role::Canvas, "Cross-section").is_some()
}

/// Is the cross-section among the details?
fn has_plot(harness: &Screen) -> bool {
    harness
        .query_all_by_label("Cross-section")
        .any(|node| node.accesskit_node().role() != Role::Canvas)
}

fn picture(harness: &Screen) -> egui::Rect {
    harness.get_by_role_and_label(Role::Canvas, "3-D view").rect()
}

/// The tissue on the chest wall, without the torso.
fn lying() -> Screen {
    let mut harness = desktop();
    press(&mut harness, "Inside");
    harness.run_steps(40);
    harness
}

#[test]
fn the_torso_is_a_switch_and_on_at_first() {
    let mut harness = desktop();
    // A body has its own sides: only head and feet have words.
    let words = |harness: &Screen| super::pictures::directions(harness).len();
    assert_eq!(words(&harness), 2);
    choose(&mut harness, "Torso");
    press(&mut harness, "Front");
    harness.run_steps(40);
    assert_eq!(words(&harness), 4);
    choose(&mut harness, "Torso");
    harness.run_steps(40);
    assert_eq!(words(&harness), 2);
    // The cut tissue has no body around it.
    press(&mut harness, "Inside");
    harness.run_steps(40);
    assert_eq!(words(&harness), 4);
}

/// A point of the skin over the implant on the picture, left of the cut and of the handles.
fn on_skin(harness: &Screen) -> Pos2 {
    let handle = harness.get_by_role_and_label(Role::Button, "Move the implant").rect();
    handle.center() + vec2(-32.0, 6.0)
}

/// The accessible name that starts with some words.
fn reading(harness: &Screen, start: &str) -> Option<String> {
    let node = harness.query_by_label_contains(start)?;
    let node = node.accesskit_node();
    node.label().or_else(|| node.value())
}

/// Is a text with these words painted?
fn is_painted(harness: &Screen, words: &str) -> bool {
    painted_texts(harness).iter().any(|text| text.contains(words))
}

fn click(harness: &mut Screen, at: Pos2) {
    harness.hover_at(at);
    harness.step();
    harness.drag_at(at);
    harness.step();
    harness.drop_at(at);
    harness.run();
}

#[test]
fn the_cross_section_is_in_sight_once_and_its_switch_is_kept() {
    let mut harness = desktop();
    unfold(&mut harness, "Details");
    assert!(has_strip(&harness) && !has_plot(&harness));
    let picture_before = picture(&harness);
    let strip = harness.get_by_role_and_label(Role::Canvas, "Cross-section").rect();
    assert!(strip.top() >= picture_before.bottom() - 0.5 && strip.height() > 100.0);
    choose(&mut harness, "Cross-section");
    assert!(!has_strip(&harness) && has_plot(&harness));
    assert!(picture(&harness).height() > picture_before.height() + 100.0);

    let kept = harness.state_mut().take_plan_to_store(true).unwrap();
    let mut next = desktop();
    next.state_mut().restore_plan(&kept);
    settle(&mut next);
    assert!(!has_strip(&next));
}

/// The chosen plane of the cross-section.
fn section_plane(harness: &Harness<'static, App>) -> &'static str {
    let is_chosen = |name: &&str| {
        let switch = harness.get_by_role_and_label(Role::Button, name).accesskit_node();
        switch.toggled() == Some(egui::accesskit::Toggled::True)
    };
    let mut chosen = ["midline to side", "feet to head"].into_iter().filter(is_chosen);
    chosen.next().filter(|_| chosen.next().is_none()).unwrap()
}

#[test]
fn the_cross_section_has_the_plane_of_the_implants_shape_or_a_chosen_one() {
    for size in [DESKTOP, vec2(1440.0, 700.0)] {
        let mut harness = app(size, |_| {});
        unfold(&mut harness, "Details");
        assert_eq!(section_plane(&harness), "midline to side");
        let mut anatomical = harness.state().session().scene().clone();
        anatomical.implant.base_height_mm = Some(130.0);
        anatomical.implant.apex_shift_mm = 15.0;
        anatomical.pocket_radius_mm = 75.0;
        harness.state_mut().open(anatomical.to_json()).unwrap();
        settle(&mut harness);
        assert_eq!(section_plane(&harness), "feet to head");
        harness.get_by_role_and_label(Role::Button, "midline to side").scroll_to_me();
        harness.run();
        press(&mut harness, "midline to side");
        assert_eq!(section_plane(&harness), "midline to side");
        press(&mut harness, "feet to head");
        assert_eq!(section_plane(&harness), "feet to head");
        if size == DESKTOP {
            // The words of the pointer are those of the section along the body.
            let read = read_upwards(&mut harness);
            assert!(read.iter().any(|line| line.contains("Implant, ")), "{read:?}");
            assert!(read.iter().any(|line| line.contains("In fat")), "{read:?}");
        }
    }
}

#[test]
fn without_room_the_cross_section_is_among_the_details() {
    for size in [vec2(1440.0, 700.0), PHONE] {
        let mut harness = app(size, |scene| *scene = flat_plan());
        assert!(!has_strip(&harness), "{size}");
        if size == PHONE {
            press(&mut harness, "More");
        }
        unfold(&mut harness, "Details");
        assert!(has_plot(&harness), "{size}");
    }
}

#[test]
fn the_pointer_reads_every_layer_and_a_click_keeps_the_values() {
    let mut harness = researching(DESKTOP, |scene| *scene = flat_plan());
    let at = on_skin(&harness);
    harness.hover_at(at);
    harness.run();
    let read = reading(&harness, "Values at the pointer").unwrap();
    for words in ["Skin stretch ", "skin ", "fat ", "(at rest ", "pull ", "Cover ", "essure "] {
        assert!(read.contains(words), "{words} in {read}");
    }
    assert!(is_painted(&harness, ", area "));
    click(&mut harness, at);
    let kept = reading(&harness, "Kept values").unwrap();
    assert!(kept.contains("Cover "), "{kept}");
    // The values stay without the pointer, and follow the plan.
    harness.remove_cursor();
    harness.run();
    assert_eq!(reading(&harness, "Kept values"), Some(kept.clone()));
    assert!(is_painted(&harness, ", area "));
    type_into(&mut harness, "Volume (ml)", "400");
    let after = reading(&harness, "Kept values").unwrap();
    assert_ne!(after, kept);
    focus_picture(&mut harness);
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(reading(&harness, "Kept values"), None);
    assert!(!is_painted(&harness, ", area "));
}

#[test]
fn a_second_click_removes_the_kept_values() {
    let mut harness = desktop();
    let at = on_skin(&harness);
    click(&mut harness, at);
    assert!(reading(&harness, "Kept values").is_some());
    click(&mut harness, at);
    assert_eq!(reading(&harness, "Kept values"), None);
}

/// The values at the pointer over the cross-section, from the middle of the wall upwards: implant, then tissue.
fn read_upwards(harness: &mut Harness<'static, App>) -> Vec<String> {
    let strip = harness.get_by_role_and_label(Role::Canvas, "Cross-section").rect();
    let mut read = Vec::new();
    for up in 0..40 {
        harness.hover_at(strip.center_bottom() - vec2(-51.0, 26.0 + 2.5 * up as f32));
        harness.run();
        read.extend(reading(harness, "Values at the pointer"));
    }
    read
}

#[test]
fn the_cross_section_has_values_too() {
    let mut harness = desktop();
    let read = read_upwards(&mut harness);
    for words in ["Implant, ", "In fat", "In skin"] {
        let is_read = |line: &String| line.contains(words) && line.contains("; Cover ");
        assert!(read.iter().any(is_read), "{words} in {read:?}");
    }
}

#[test]
fn the_values_over_the_cross_section_leave_the_switch_of_its_plane() {
    let mut harness = desktop();
    let strip = harness.get_by_role_and_label(Role::Canvas, "Cross-section").rect();
    let switch = ["midline to side", "feet to head"]
        .map(|name| harness.get_by_role_and_label(Role::Button, name).rect());
    let mut boxes = 0;
    for across in 0..60 {
        for up in 0..10 {
            harness.hover_at(strip.center_bottom() + vec2(6.0 * across as f32, -15.0 * up as f32));
            harness.step();
            let Some(node) = harness.query_by_label_contains("Values at the pointer") else {
                continue;
            };
            boxes += 1;
            let place = node.rect();
            assert!(!switch.iter().any(|rect| rect.intersects(place)), "{place} {switch:?}");
        }
    }
    assert!(boxes > 20, "{boxes}");
}

#[test]
fn the_ruler_measures_straight_along_the_skin_and_at_rest() {
    let mut harness = desktop();
    let [a, b] = [vec2(-60.0, 30.0), vec2(20.0, -2.0)].map(|by| on_skin(&harness) + by);
    focus_picture(&mut harness);
    harness.key_press(Key::R);
    harness.run();
    harness.get_by_label("Ruler: click a point of the skin");
    click(&mut harness, a);
    harness.get_by_label("Ruler: click the second point");
    click(&mut harness, b);
    let read = reading(&harness, "Ruler: Straight").unwrap();
    let number = |after: &str| -> f64 {
        let (_, rest) = read.split_once(after).unwrap();
        rest.split(' ').next().unwrap().parse().unwrap()
    };
    let (straight, along, rest) = (number("Straight "), number("skin "), number("rest "));
    assert!(straight > 1.0 && along >= straight && rest > 1.0 && rest < along, "{read}");
    assert!(is_painted(&harness, "Straight "));
    // No values are kept meanwhile, and the command ends the ruler.
    assert_eq!(reading(&harness, "Kept values"), None);
    choose(&mut harness, "Ruler");
    assert_eq!(reading(&harness, "Ruler: "), None);
    choose(&mut harness, "Ruler");
    assert!(reading(&harness, "Ruler: ").is_some());
    focus_picture(&mut harness);
    harness.key_press(Key::Escape);
    harness.run();
    assert_eq!(reading(&harness, "Ruler: "), None);
    assert!(!is_painted(&harness, "Straight "));
}

#[test]
fn a_click_of_the_ruler_beyond_the_computed_skin_says_where_the_ruler_works() {
    const ONLY: &str = "Ruler: only on the computed skin, which Stretch colours";
    let mut harness = desktop();
    let skin = on_skin(&harness);
    let outside = (1..60).map(|k| skin + vec2(0.0, 6.0 * k as f32)).find(|at| {
        harness.hover_at(*at);
        harness.run();
        reading(&harness, "Values at the pointer").is_some_and(|read| read.contains("Outside"))
    });
    let outside = outside.unwrap();
    focus_picture(&mut harness);
    harness.key_press(Key::R);
    harness.run();
    click(&mut harness, skin);
    assert!(harness.query_by_label(ONLY).is_none());
    click(&mut harness, outside);
    harness.get_by_label(ONLY);
    harness.hover_at(outside);
    harness.run();
    assert_eq!(
        reading(&harness, "Ruler: Outside").as_deref(),
        Some("Ruler: Outside the pocket (not computed)")
    );
    // The hint stays without a pointer, as after a tap, until the next end.
    harness.remove_cursor();
    harness.run();
    harness.get_by_label(ONLY);
    click(&mut harness, skin + vec2(20.0, -2.0));
    assert!(harness.query_by_label(ONLY).is_none());
    assert!(reading(&harness, "Ruler: Straight").is_some());
}

/// Presses a handle and moves the pointer in steps.
fn drag(harness: &mut Screen, name: &str, by: Vec2) -> Pos2 {
    harness.hover_at(picture(harness).center());
    harness.run();
    let at = harness.get_by_role_and_label(Role::Button, name).rect().center();
    harness.hover_at(at);
    harness.step();
    harness.drag_at(at);
    harness.step();
    for k in 1..=6 {
        harness.hover_at(at + by * (k as f32 / 6.0));
        settle(harness);
    }
    at + by
}

fn scene(harness: &Screen) -> Scene {
    harness.state().session().scene().clone()
}

#[test]
fn a_drag_moves_the_implant_in_its_pocket_in_one_step() {
    let mut harness = desktop();
    let before = scene(&harness);
    let end = drag(&mut harness, "Move the implant", vec2(300.0, 0.0));
    let words = reading(&harness, "Drag: ").unwrap();
    assert!(words.contains("At the pocket's edge"), "{words}");
    harness.drop_at(end);
    settle(&mut harness);
    let [x, y] = scene(&harness).implant.center_mm;
    assert!((x.hypot(y) - before.room_mm()).abs() < 1e-6, "{x} {y}");
    assert_eq!(reading(&harness, "Drag: "), None);
    press(&mut harness, "Undo");
    settle(&mut harness);
    assert_eq!(scene(&harness), before);
    assert!(!harness.state().session().can_undo());
    // Escape takes back what the tissue has followed so far, and ends the drag.
    let end = drag(&mut harness, "Move the implant", vec2(40.0, 0.0));
    assert_ne!(scene(&harness), before);
    harness.key_press(Key::Escape);
    settle(&mut harness);
    harness.hover_at(end + vec2(0.0, 30.0));
    harness.drop_at(end + vec2(0.0, 30.0));
    settle(&mut harness);
    assert_eq!(scene(&harness), before);
}

#[test]
fn arrow_keys_move_and_raise_the_implant_too() {
    let mut harness = lying();
    let before = scene(&harness).implant;
    for (name, key) in [("Move the implant", Key::ArrowLeft), ("Raise the implant", Key::ArrowUp)] {
        harness.get_by_role_and_label(Role::Button, name).focus();
        harness.run();
        harness.key_press(key);
        settle(&mut harness);
    }
    let after = scene(&harness).implant;
    assert_eq!(after.center_mm, [before.center_mm[0] - 1.0, before.center_mm[1]]);
    assert_eq!(after.projection_mm, before.projection_mm.round() + 1.0);
}

#[test]
fn a_drag_up_raises_the_implant_and_escape_restores_the_plan() {
    let mut harness = lying();
    let before = scene(&harness);
    let end = drag(&mut harness, "Raise the implant", vec2(0.0, -30.0));
    assert!(reading(&harness, "Drag: ").unwrap().contains("Projection "));
    let raised = scene(&harness).implant;
    assert!(raised.projection_mm > before.implant.projection_mm + 2.0);
    assert_eq!(raised.base_radius_mm, before.implant.base_radius_mm);
    harness.key_press(Key::Escape);
    settle(&mut harness);
    assert_eq!(scene(&harness), before);
    // The rest of the drag changes nothing.
    harness.hover_at(end - vec2(0.0, 30.0));
    settle(&mut harness);
    harness.drop_at(end - vec2(0.0, 30.0));
    settle(&mut harness);
    assert_eq!(scene(&harness), before);
    assert!(!harness.state().session().can_undo() && !harness.state().session().can_redo());
}

#[test]
fn escape_during_a_drag_of_a_slider_leaves_no_step() {
    let mut harness = desktop();
    let before = scene(&harness);
    let rail = harness.get_by_role_and_label(Role::Slider, "Volume (ml)").rect();
    let at = rail.center();
    harness.hover_at(at);
    harness.step();
    harness.drag_at(at);
    harness.step();
    for k in 1..=4 {
        harness.hover_at(at + vec2(6.0 * k as f32, 0.0));
        settle(&mut harness);
    }
    assert_ne!(scene(&harness), before);
    harness.key_press(Key::Escape);
    settle(&mut harness);
    assert_eq!(scene(&harness), before);
    harness.hover_at(at + vec2(40.0, 0.0));
    settle(&mut harness);
    harness.drop_at(at + vec2(40.0, 0.0));
    settle(&mut harness);
    assert_eq!(scene(&harness), before);
    assert!(!harness.state().session().can_undo() && !harness.state().session().can_redo());
    // The next press is a new one.
    click(&mut harness, at + vec2(20.0, 0.0));
    settle(&mut harness);
    assert_ne!(scene(&harness), before);
}

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

#[test]
fn the_reading_of_the_ruler_keeps_off_that_of_the_kept_point() {
    let mut harness = desktop();
    let skin = on_skin(&harness);
    for (kept, ends) in [
        (vec2(-20.0, 10.0), [vec2(-60.0, 30.0), vec2(20.0, -2.0)]),
        (vec2(-40.0, 30.0), [vec2(-60.0, 30.0), vec2(-20.0, 20.0)]),
        (vec2(10.0, -2.0), [vec2(-30.0, 10.0), vec2(-10.0, 5.0)]),
    ] {
        click(&mut harness, skin + kept);
        focus_picture(&mut harness);
        harness.key_press(Key::R);
        harness.run();
        for end in ends {
            click(&mut harness, skin + end);
        }
        let [kept, ruler] = ["Kept values: ", "Ruler: Straight"]
            .map(|name| harness.get_by_label_contains(name).rect());
        assert!(!kept.intersects(ruler), "{kept} {ruler}");
        assert!(picture(&harness).contains_rect(ruler), "{ruler}");
        harness.key_press(Key::R);
        harness.key_press(Key::Escape);
        harness.run();
    }
}

#[test]
fn the_reading_of_the_ruler_covers_neither_of_its_ends() {
    let mut harness = desktop();
    let skin = on_skin(&harness);
    for [a, b] in [
        [vec2(-60.0, -2.0), vec2(20.0, 50.0)],
        [vec2(20.0, 50.0), vec2(-60.0, -2.0)],
        [vec2(-60.0, 30.0), vec2(20.0, -2.0)],
    ] {
        focus_picture(&mut harness);
        harness.key_press(Key::R);
        harness.run();
        for end in [a, b] {
            click(&mut harness, skin + end);
        }
        let ruler = harness.get_by_label_contains("Ruler: Straight").rect();
        for end in [a, b] {
            assert!(!ruler.expand(4.0).contains(skin + end), "{ruler} {}", skin + end);
        }
        assert!(picture(&harness).contains_rect(ruler), "{ruler}");
        harness.key_press(Key::R);
        harness.run();
    }
}

//! Hands on the picture: cross-section in sight, values at a point, handles of the implant.

use super::{
    DESKTOP, PHONE, app, flat_plan, focus_picture, painted_texts, press, researching, settle,
    type_into, unfold,
};
use eframe::egui::{self, Key, Pos2, Role, Vec2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use implant_preview::app::App;
use implant_preview::scene::Scene;

pub(super) type Screen = Harness<'static, App>;

pub(super) fn desktop() -> Screen {
    app(DESKTOP, |scene| {
        *scene = flat_plan();
        scene.solver.nodes_per_side = 33;
    })
}

/// A choice of the menu "View".
pub(super) fn choose(harness: &mut Screen, name: &str) {
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

pub(super) fn picture(harness: &Screen) -> egui::Rect {
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
pub(super) fn on_skin(harness: &Screen) -> Pos2 {
    let handle = harness.get_by_role_and_label(Role::Button, "Move the implant").rect();
    handle.center() + vec2(-32.0, 6.0)
}

/// The accessible name that starts with some words.
pub(super) fn reading(harness: &Screen, start: &str) -> Option<String> {
    let node = harness.query_by_label_contains(start)?;
    let node = node.accesskit_node();
    node.label().or_else(|| node.value())
}

/// Is a text with these words painted?
pub(super) fn is_painted(harness: &Screen, words: &str) -> bool {
    painted_texts(harness).iter().any(|text| text.contains(words))
}

pub(super) fn click(harness: &mut Screen, at: Pos2) {
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

pub(super) fn scene(harness: &Screen) -> Scene {
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

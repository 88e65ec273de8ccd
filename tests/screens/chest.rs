//! The chest of the plan: its list, its radii, the report and the comparison.

use super::*;
use egui::{Key, vec2};
use implant_preview::scene::{ChestShape, Torso};

/// The flat plan on the coarsest grid.
fn flat(scene: &mut Scene) {
    *scene = flat_plan();
    scene.solver.nodes_per_side = 17;
    scene.solver.tolerance = 1e-3;
}

fn choose(harness: &mut Harness<'static, App>, name: &'static str) {
    harness.get_by_role_and_label(Role::ComboBox, "Chest").click();
    harness.run();
    // The selected text of the list has the name of a choice.
    harness.get_all_by_label(name).last().unwrap().click();
    settle(harness);
}

#[test]
fn a_chest_is_chosen_from_a_list_or_by_its_radii() {
    let mut harness = app(DESKTOP, flat);
    let chest = |harness: &Harness<'static, App>| harness.state().session().scene().chest;
    for (name, shape) in [
        ("round chest", Some(ChestShape::ROUND)),
        ("usual chest", Some(ChestShape::USUAL)),
        ("flat chest", None),
        ("chest by its radii…", Some(ChestShape::USUAL)),
    ] {
        choose(&mut harness, name);
        assert_eq!(chest(&harness), shape, "{name}");
        let shown = harness.get_by_role_and_label(Role::ComboBox, "Chest").value();
        assert_eq!(shown.as_deref(), Some(name));
    }
    // The usual radius stays in its field while it is edited.
    type_into(&mut harness, "Radius across (cm)", "15");
    settle(&mut harness);
    type_into(&mut harness, "Radius across (cm)", "14");
    settle(&mut harness);
    harness.get_by_role_and_label(Role::Button, "curved along").click();
    settle(&mut harness);
    type_into(&mut harness, "Radius along (cm)", "30,5");
    settle(&mut harness);
    let own = ChestShape { radius_across_mm: 140.0, radius_along_mm: Some(305.0) };
    assert_eq!(chest(&harness), Some(own));
    // Below the least radius.
    type_into(&mut harness, "Radius across (cm)", "5");
    assert_eq!(chest(&harness), Some(own));
    harness.get_by_role_and_label(Role::Button, "Undo").click();
    settle(&mut harness);
    assert_eq!(chest(&harness).unwrap().radius_along_mm, Some(600.0));
}

#[test]
fn a_torso_is_the_chest_shaped_by_its_numbers() {
    let mut harness = app(DESKTOP, flat);
    let torso = |harness: &Harness<'static, App>| harness.state().session().scene().torso;
    assert!(harness.query_by_label("Breast volume (ml)").is_none());
    choose(&mut harness, "torso by a tape…");
    assert_eq!(torso(&harness), Some(Torso::default()));
    let force = |harness: &Harness<'static, App>| {
        harness.state().session().result().unwrap().contact_force_n.unwrap()
    };
    let before = force(&harness);
    type_into(&mut harness, "Breast volume (ml)", "250");
    type_into(&mut harness, "Notch to nipple (cm)", "20,5");
    settle(&mut harness);
    let now = torso(&harness).unwrap();
    assert_eq!((now.breast_volume_ml, now.notch_nipple_mm), (250.0, 205.0));
    assert!((force(&harness) - before).abs() > 1e-3 * before);
    // No such breast: the torso says what it has.
    type_into(&mut harness, "Breast volume (ml)", "500");
    type_into(&mut harness, "Notch to nipple (cm)", "17");
    settle(&mut harness);
    assert!(text_with(&harness, "Nearest torso: ").is_some());
    choose(&mut harness, "usual chest");
    assert_eq!(torso(&harness), None);
    let chest = harness.state().session().scene().chest;
    assert_eq!(chest, Some(ChestShape::USUAL));
}

#[test]
fn a_sheet_has_no_chest() {
    let harness = app(DESKTOP, |scene: &mut Scene| scene.set_tissue_model(TissueModel::Sheet));
    assert_eq!(harness.query_all_by_label("Chest").count(), 0);
}

#[test]
fn a_number_of_the_torso_waits_until_its_slider_pauses() {
    let mut harness = app(DESKTOP, flat);
    choose(&mut harness, "torso by a tape…");
    let volume = |harness: &Harness<'static, App>| {
        harness.state().session().scene().torso.unwrap().breast_volume_ml
    };
    let shown = |harness: &Harness<'static, App>| {
        let rail = harness.get_by_role_and_label(Role::Slider, "Breast volume (ml)");
        rail.accesskit_node().numeric_value().unwrap()
    };
    let before = volume(&harness);
    harness.get_by_role_and_label(Role::Slider, "Breast volume (ml)").scroll_to_me();
    settle(&mut harness);
    let at = harness.get_by_role_and_label(Role::Slider, "Breast volume (ml)").rect().center();
    let move_to = |harness: &mut Harness<'static, App>, right: f32| {
        harness.hover_at(at + vec2(right, 0.0));
        harness.step();
    };
    move_to(&mut harness, 0.0);
    harness.drag_at(at);
    harness.step();
    for k in 1..=3 {
        move_to(&mut harness, 4.0 * k as f32);
    }
    // The slider follows at once, the torso after a pause.
    assert!(shown(&harness) > before);
    assert_eq!(volume(&harness), before);
    for _ in 0..30 {
        harness.step();
    }
    assert_eq!(volume(&harness), shown(&harness));
    // Released, it is shaped at once.
    move_to(&mut harness, 20.0);
    assert_ne!(volume(&harness), shown(&harness));
    harness.drop_at(at + vec2(20.0, 0.0));
    harness.step();
    assert_eq!(volume(&harness), shown(&harness));
    settle(&mut harness);
    harness.get_by_role_and_label(Role::Button, "Undo").click();
    settle(&mut harness);
    assert_eq!((volume(&harness), shown(&harness)), (before, before));
    // Escape drops a number that waits.
    move_to(&mut harness, 0.0);
    harness.drag_at(at);
    harness.step();
    move_to(&mut harness, 12.0);
    harness.key_press(Key::Escape);
    harness.step();
    harness.drop_at(at + vec2(12.0, 0.0));
    settle(&mut harness);
    assert_eq!((volume(&harness), shown(&harness)), (before, before));
}

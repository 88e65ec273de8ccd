//! A plan for each breast: switched on and off, edited one by one, on the built-in torso and on her body.

use super::window::plan_on_a_body;
use super::{DESKTOP, PHONE, WIDE, app, cut_texts, flat_plan, press, settle, type_into, unfold};
use eframe::egui::{Key, Modifiers, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use implant_preview::app::App;
use implant_preview::scene::{Scene, Side};
use serde_json::Value;

type Screen = Harness<'static, App>;

const BOTH: &str = "both alike";
const OWN: &str = "each own";

fn scene(harness: &Screen) -> Scene {
    harness.state().session().scene().clone()
}

/// Volumes of the implants \[ml\]: of the chosen side, and of the other one.
fn volumes(harness: &Screen) -> [f64; 2] {
    let session = harness.state().session();
    let other = session.other_side().unwrap().outcome().unwrap();
    [session.result().unwrap(), other].map(|outcome| outcome.implant_volume_ml.round())
}

fn is_chosen(harness: &Screen, name: &str) -> bool {
    let chip = harness.get_by_role_and_label(Role::Button, name);
    chip.accesskit_node().toggled() == Some(eframe::egui::accesskit::Toggled::True)
}

#[test]
fn a_plan_for_each_breast_is_edited_on_its_own_and_comes_back_by_undo() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    let solves = |harness: &Screen| harness.state().session().counters().solves;
    let before = solves(&harness);
    // One plan for both, then one for each.
    press(&mut harness, BOTH);
    press(&mut harness, OWN);
    assert_eq!((solves(&harness), volumes(&harness)), (before, [300.0; 2]));
    assert!(is_chosen(&harness, OWN) && is_chosen(&harness, "left"));
    harness.get_by_label("· left");
    harness.get_by_label_contains("right: 300 ml, 12 cm: ");
    // The right side alone.
    press(&mut harness, "right");
    assert_eq!(solves(&harness), before);
    type_into(&mut harness, "Volume (ml)", "250");
    assert_eq!(volumes(&harness), [250.0, 300.0]);
    assert!(scene(&harness).is_right());
    harness.get_by_label("· right");
    harness.get_by_label_contains("left: 300 ml, 12 cm: ");
    assert!(
        harness.state().summary().contains(" left: 300 ml, 12 cm: "),
        "{}",
        harness.state().summary()
    );
    assert!(cut_texts(&harness).is_empty(), "{:?}", cut_texts(&harness));
    // The shapes on the torso differ: it moves by the session's fields of each side.
    let session = harness.state().session();
    let tops = [session.fields(), session.other_side().unwrap().fields().unwrap()]
        .map(|fields| fields.solution().inner().iter().map(|p| p.z).fold(0.0, f64::max));
    assert!(tops[1] > tops[0] + 4.0, "{tops:?}");
    press(&mut harness, "left");
    assert_eq!(volumes(&harness), [300.0, 250.0]);
    assert_eq!(solves(&harness), before + 1, "only the edited side is solved");
    // A file, a link and the store keep both.
    let session = harness.state().session();
    for json in [session.document_json(), session.shared_document_json()] {
        assert_eq!(Scene::from_json(&json).unwrap(), scene(&harness));
    }
    let now = scene(&harness);
    let json = session.document_json();
    let numbers: Value = serde_json::from_str(&harness.state().result_json().unwrap()).unwrap();
    assert_eq!(numbers["other_side"]["implant_volume_ml"].as_f64().unwrap().round(), 250.0);
    for volume in [[250.0, 300.0], [300.0, 300.0], [300.0, 300.0]] {
        harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
        settle(&mut harness);
        assert_eq!(volumes(&harness), volume);
    }
    harness.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    settle(&mut harness);
    assert!(scene(&harness).other_side.is_none() && scene(&harness).side == Some(Side::Both));
    harness.state_mut().open(json).unwrap();
    settle(&mut harness);
    assert_eq!(scene(&harness), now);
    // One plan again: that of the chosen side.
    press(&mut harness, BOTH);
    assert_eq!((scene(&harness).side, scene(&harness).other_side), (Some(Side::Both), None));
    assert!(harness.query_by_label("· left").is_none());
    harness.get_by_label_contains("Undo brings it back");
}

#[test]
fn the_comparison_has_a_column_for_each_side() {
    let mut harness = app(WIDE, |scene| {
        *scene = flat_plan();
        scene.add_other_side().unwrap();
        scene.other_side.as_mut().unwrap().implant.projection_mm += 5.0;
    });
    let fold = harness.get_by_role_and_label(Role::Button, "Pin as A");
    assert!(fold.rect().bottom() < WIDE.y);
    for head in ["left", "right"] {
        // The chip of the side and the head of its column.
        assert_eq!(harness.get_all_by_label(head).count(), 2, "{head}");
    }
    press(&mut harness, "Pin as A");
    assert!(cut_texts(&harness).is_empty(), "{:?}", cut_texts(&harness));
}

#[test]
fn on_her_body_the_other_side_gets_its_own_wall_and_both_are_measured() {
    let mut harness = app(WIDE, |scene| *scene = plan_on_a_body());
    assert!(harness.query_by_role_and_label(Role::Button, "right").is_none());
    press(&mut harness, OWN);
    let plan = scene(&harness);
    let other = plan.other_side.as_deref().unwrap();
    assert_eq!((plan.side, other.side), (Some(Side::Left), Some(Side::Right)));
    assert!(other.chest_grid.is_some() && other.placement != plan.placement);
    press(&mut harness, "right");
    type_into(&mut harness, "Volume (ml)", "300");
    assert_eq!(volumes(&harness)[0], 300.0);
    unfold(&mut harness, "Details");
    for head in ["left: before", "right: gain"] {
        harness.get_by_label(head);
    }
    let numbers: Value = serde_json::from_str(&harness.state().result_json().unwrap()).unwrap();
    let gain = |side: &str| {
        let rows = numbers["measures"][side].as_array().unwrap();
        let row = rows.iter().find(|row| row["name"] == "Volume gained").unwrap();
        row["gain"].as_f64().unwrap()
    };
    assert!(gain("right") > gain("left") + 40.0, "{} {}", gain("right"), gain("left"));
    // One side again: that of the plan.
    press(&mut harness, OWN);
    assert_eq!((scene(&harness).side, scene(&harness).other_side), (Some(Side::Right), None));
}

#[test]
fn a_number_that_is_typed_when_the_side_is_changed_is_one_of_the_side_before() {
    let mut harness = app(WIDE, |scene| {
        *scene = flat_plan();
        scene.add_other_side().unwrap();
    });
    press(&mut harness, "left");
    let [_, right] = volumes(&harness);
    harness.get_by_role_and_label(Role::SpinButton, "Volume (ml)").focus();
    harness.run();
    harness.event(eframe::egui::Event::Text("280".to_owned()));
    harness.run();
    harness.get_by_role_and_label(Role::Button, "right").click();
    settle(&mut harness);
    assert!(scene(&harness).is_right());
    assert_eq!(volumes(&harness), [right, 280.0]);
}

#[test]
fn the_switch_has_room_on_a_phone() {
    let mut harness = app(PHONE, |scene| *scene = flat_plan());
    press(&mut harness, BOTH);
    press(&mut harness, OWN);
    let chip = harness.get_by_role_and_label(Role::Button, OWN).rect();
    assert!(harness.ctx.content_rect().contains_rect(chip));
    press(&mut harness, "right");
    assert!(scene(&harness).is_right());
    // The other side's answer stands below the three figures.
    let words = harness.get_by_label_contains("left: 300 ml, 12 cm: ").rect();
    let figure = harness.get_by_role_and_label(Role::Label, "Stretch").rect();
    assert!(words.top() > figure.bottom() && words.bottom() < chip.top(), "{words} {figure}");
    assert!(cut_texts(&harness).is_empty(), "{:?}", cut_texts(&harness));
}

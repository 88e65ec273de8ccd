//! The plan's fields by name, as the form of the page and scripts set them.

use super::*;

/// The text of a field.
fn text(harness: &Harness<'static, App>, name: &str) -> String {
    let fields: serde_json::Value = serde_json::from_str(&harness.state().plan_json()).unwrap();
    let field = fields.as_array().unwrap().iter().find(|field| field["name"] == name).unwrap();
    field["text"].as_str().unwrap().to_owned()
}

#[test]
fn a_field_is_one_step_of_the_history_and_has_the_text_of_its_control() {
    let mut harness = app(WIDE, |scene| *scene = flat_plan());
    unfold(&mut harness, "Tissue");
    let before = harness.state().session().scene().clone();
    for (name, value, control) in [
        ("width_cm", "13", "Width (cm)"),
        ("volume_ml", "350 cc", "Volume (ml)"),
        ("pinch_cm", "2,5", "Pinch (cm)"),
        ("up_cm", "0.5", "Up (cm)"),
        ("in_place_percent", "80", "In place (%)"),
    ] {
        harness.state_mut().set_plan(name, value).unwrap();
        settle(&mut harness);
        let shown = harness.get_by_role_and_label(Role::SpinButton, control).value().unwrap();
        assert_eq!(text(&harness, name), shown, "{name}");
        assert_ne!(harness.state().session().scene(), &before, "{name}");
        harness.get_by_role_and_label(Role::Button, "Undo").click();
        settle(&mut harness);
        assert_eq!(harness.state().session().scene(), &before, "{name}");
    }
}

#[test]
fn a_refused_or_an_equal_field_is_no_step() {
    let mut harness = app(WIDE, |scene| *scene = flat_plan());
    let refusal = harness.state_mut().set_plan("in_place_percent", "101").unwrap_err();
    assert_eq!(refusal, "In place: at most 100 %");
    harness.state_mut().set_plan("width_cm", "120 mm").unwrap();
    settle(&mut harness);
    assert!(!harness.state().session().can_undo());
}

#[test]
fn another_plan_ends_the_push() {
    let mut harness = app(WIDE, |scene| *scene = flat_plan());
    unfold(&mut harness, "Tissue");
    harness.get_by_role_and_label(Role::Button, "Show insertion").click();
    harness.step();
    harness.step();
    harness.get_by_label("Pause");
    harness.state_mut().set_plan("in_place_percent", "55").unwrap();
    harness.step();
    harness.step();
    harness.get_by_label("Show insertion");
    assert_eq!(harness.state().session().scene().insertion, 0.55);
}

#[test]
fn a_typed_number_is_dropped_when_another_plan_opens() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    // Another plan of the same width.
    let mut other = flat_plan();
    other.implant.projection_mm = 40.0;
    harness.get_by_role_and_label(Role::SpinButton, "Width (cm)").focus();
    harness.run();
    harness.event(egui::Event::Text("13".to_owned()));
    harness.run();
    harness.state_mut().open(other.to_json()).unwrap();
    harness.run();
    harness.get_by_role_and_label(Role::SpinButton, "Pinch (cm)").focus();
    settle(&mut harness);
    assert_eq!(harness.state().session().scene().implant, other.implant);
}

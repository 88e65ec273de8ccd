//! What fills the implant: its list, undo, pins, details, an expander.

use super::*;
use implant_preview::scene::Fill;

fn fill_of(harness: &Harness<'static, App>) -> Option<Fill> {
    harness.state().session().scene().implant.fill
}

fn choose(harness: &mut Harness<'static, App>, name: &'static str) {
    harness.get_by_role_and_label(Role::ComboBox, "Filled with").click();
    harness.run();
    // The selected text of the list has the name of a choice.
    harness.get_all_by_label(name).last().unwrap().click();
    settle(harness);
}

fn cohesive(scene: &mut Scene) {
    *scene = flat_plan();
    scene.implant.fill = Some(Fill::Cohesive);
}

#[test]
fn a_fill_is_chosen_from_a_list_and_undone() {
    let mut harness = app(WIDE, cohesive);
    unfold(&mut harness, "Tissue");
    let height = |harness: &Harness<'static, App>| {
        harness.state().session().result().unwrap().projection_mm.unwrap()
    };
    let mut lower = 0.0;
    for (name, fill) in [
        ("saline", Some(Fill::Saline)),
        ("soft gel", Some(Fill::Soft)),
        ("cohesive gel", Some(Fill::Cohesive)),
        ("form-stable gel", Some(Fill::FormStable)),
        ("rigid", None),
    ] {
        choose(&mut harness, name);
        assert_eq!(fill_of(&harness), fill, "{name}");
        let shown = harness.get_by_role_and_label(Role::ComboBox, "Filled with").value();
        assert_eq!(shown.as_deref(), Some(name));
        assert!(height(&harness) > lower, "{name}");
        lower = height(&harness);
    }
    press(&mut harness, "Undo");
    assert_eq!(fill_of(&harness), Some(Fill::FormStable));
}

#[test]
fn pins_of_other_fills_differ_and_the_details_have_both_projections() {
    let mut harness = app(WIDE, cohesive);
    unfold(&mut harness, "Tissue");
    press(&mut harness, "Pin as A");
    choose(&mut harness, "soft gel");
    assert!(text_with(&harness, "Filled with: this plan soft gel; A cohesive gel").is_some());
    unfold(&mut harness, "Details");
    for name in ["Projection in the catalogue", "Projection in the body", "Width in the body"] {
        assert!(harness.query_by_label(name).is_some(), "{name}");
    }
}

#[test]
fn an_expander_is_rigid_and_has_no_fill_to_choose() {
    let mut harness = app(WIDE, cohesive);
    unfold(&mut harness, "Tissue");
    choose(&mut harness, "soft gel");
    press(&mut harness, "expander");
    assert_eq!(fill_of(&harness), None);
    assert!(harness.query_by_role_and_label(Role::ComboBox, "Filled with").is_none());
    // An implant is one of cohesive gel again.
    press(&mut harness, "round");
    assert!(harness.query_by_role_and_label(Role::ComboBox, "Filled with").is_some());
    assert_eq!(fill_of(&harness), Some(Fill::Cohesive));
}

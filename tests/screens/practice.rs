//! Words against practice: the card, the table of a clinic, the measurements of its corrections, plans that are not compared.

use super::gated::gated;
use super::*;
use std::sync::Arc;

/// A table of one rule: 100 ml more than the built-in one for 12 cm.
const TABLE: &str = "measure;is;value;unit;volume_ml;source\nbase width;at;11;cm;350;our clinic\nbase width;at;13;cm;450;\nfold;above;9,5;cm;30;\n";

/// The switch of the base of the breast.
const BASE: &str = "Keep the breast's base";

/// Drops a table, and waits for the notice, which fades.
fn drop_table(harness: &mut Harness<'static, App>, text: &str, notice: &str) {
    let file = Dropped { path: "rule.csv".into(), text: text.to_owned() };
    harness.input_mut().dropped_files.push(Arc::new(file));
    wait_until(harness, "the notice", |harness| text_with(harness, notice));
}

fn line(harness: &mut Harness<'static, App>) -> String {
    wait_until(harness, "practice", |harness| text_with(harness, "practice's "))
}

#[test]
fn the_table_of_a_clinic_changes_the_words_and_is_kept() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    assert!(line(&mut harness).contains("practice's 300 ml: 14 %"));
    harness.get_by_label("as practice");
    let is_used = "The practice table of rule.csv is in use: 2 base widths.";
    drop_table(&mut harness, TABLE, is_used);
    let of_clinic =
        wait_until(&mut harness, "the table", |harness| text_with(harness, "practice's 400 ml: "));
    harness.get_by_label("below practice");
    unfold(&mut harness, "Where limits come from");
    harness.get_by_label_contains("Source of the table: our clinic.");
    // A damaged table changes nothing.
    let is_refused = "rule.csv was not read; the practice table is unchanged. line 3: ";
    drop_table(&mut harness, &TABLE.replace("450", "4500000"), is_refused);
    assert_eq!(line(&mut harness), of_clinic);
    let kept = harness.state_mut().take_practice_table_to_store(true).unwrap();
    let mut next = app(DESKTOP, |scene| *scene = flat_plan());
    next.state_mut().restore_practice_table(&kept);
    next.run();
    assert_eq!(line(&mut next), of_clinic);
    assert_eq!(next.state_mut().take_practice_table_to_store(true), None);
    // Back to the built-in one, which is kept as no text.
    unfold(&mut next, "Where limits come from");
    next.get_by_label("Built-in practice table").scroll_to_me();
    next.run();
    next.get_by_label("Built-in practice table").click();
    next.run();
    wait_until(&mut next, "the table", |harness| text_with(harness, "practice's 300 ml: "));
    assert_eq!(next.state_mut().take_practice_table_to_store(true).as_deref(), Some(""));
}

#[test]
fn measurements_correct_the_volume_that_practice_takes() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    unfold(&mut harness, "Practice takes 300 ml");
    press(&mut harness, "little");
    harness.get_by_label("Practice takes 330 ml");
    press(&mut harness, "not said");
    harness.get_by_label("Nipple–fold measured").click();
    harness.run();
    harness.get_by_label("Practice takes 300 ml");
    type_into(&mut harness, "Nipple–fold (cm)", "9,6");
    harness.get_by_label("Practice takes 330 ml");
    let measured = harness.state().session().scene().patient.clone().unwrap().measured;
    assert_eq!(measured.fold_stretched_mm, Some(96.0));
    press(&mut harness, "lax");
    settle(&mut harness);
    harness.get_by_label("Practice takes 360 ml");
    wait_until(&mut harness, "practice", |harness| text_with(harness, "practice's 360 ml: "));
    // The largest volume is that of practice and a step of the rule, which the skin decides.
    let words = largest_usual(&mut harness);
    assert!(
        words.starts_with(
            "12 cm: practice takes 360 ± 30 ml for the breast's base, 12 cm; this skin carries up to 39"
        ),
        "{words}"
    );
}

#[test]
fn an_opened_pin_keeps_the_measured_base_of_the_same_patient() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    press(&mut harness, "Pin as A");
    harness.get_by_label(BASE).click();
    harness.run();
    type_into(&mut harness, "Breast base (cm)", "13");
    type_into(&mut harness, "Volume (ml)", "340");
    let base = |harness: &Harness<'static, App>| {
        harness.state().session().scene().patient.clone().unwrap().measured.base_width_mm
    };
    press(&mut harness, "Open A");
    assert_eq!(base(&harness), Some(130.0));
    harness.get_by_label("Practice takes 325 ml");
    // Another skin is another patient.
    press(&mut harness, "lax");
    press(&mut harness, "Open A");
    assert_eq!(base(&harness), None);
}

#[test]
fn the_measured_base_of_the_breast_keeps_practices_volume_while_the_implant_gets_narrower() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    // Among the patient's measurements, with the fold of practice closed.
    let bottom = |label| harness.get_by_label(label).rect().bottom();
    let (base, pinch) = (bottom(BASE), bottom("Pinch"));
    assert!(bottom("Patient") < base && base < pinch && pinch < base + 40.0, "{base} {pinch}");
    harness.get_by_label(BASE).click();
    harness.run();
    harness.get_by_label("Practice takes 300 ml");
    type_into(&mut harness, "Breast base (cm)", "13");
    harness.get_by_label("Practice takes 325 ml");
    type_into(&mut harness, "Width (cm)", "11");
    harness.get_by_label("Practice takes 325 ml");
    wait_until(&mut harness, "practice", |harness| text_with(harness, "practice's 325 ml: "));
    let words = largest_usual(&mut harness);
    assert!(
        words.starts_with("11 cm: practice takes 325 ± 30 ml for the breast's base, 13 cm; "),
        "{words}"
    );
    harness.get_by_label(BASE).click();
    harness.run();
    harness.get_by_label("Practice takes 250 ml");
    // A measured pull has the base in its own row.
    press(&mut harness, "pull…");
    assert_eq!(harness.query_all_by_label(BASE).count(), 0);
    let rows = harness.query_all_by_role_and_label(Role::SpinButton, "Breast base (cm)");
    assert_eq!(rows.count(), 1);
}

#[test]
fn a_plan_without_practice_has_no_base_of_the_breast_but_a_measured_one() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    harness.get_by_label(BASE).click();
    harness.run();
    press(&mut harness, "expander");
    settle(&mut harness);
    harness.get_by_label(BASE).click();
    harness.run();
    assert_eq!(harness.query_all_by_label(BASE).count(), 0);
}

#[test]
fn a_plan_that_practice_does_not_know_has_the_words_of_its_skin_and_the_reason() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    unfold(&mut harness, "Where limits come from");
    line(&mut harness);
    harness.get_by_label_contains(
        "Practice takes 300 ml here: 300 ml for a base of 12 cm. By the same model",
    );
    type_into(&mut harness, "Width (cm)", "10");
    wait_until(&mut harness, "the reason", |harness| {
        text_with(
            harness,
            "Not compared with practice: its table has base widths of 10.5 to 15 cm.",
        )
    });
    assert!(text_with(&harness, "Practice takes ").is_none());
    harness.get_by_label_contains(" % of its reserve");
    // A tissue expander has no practice.
    type_into(&mut harness, "Width (cm)", "12");
    line(&mut harness);
    press(&mut harness, "expander");
    settle(&mut harness);
    for words in ["Practice takes ", "practice's ", "The table of practice"] {
        assert_eq!(text_with(&harness, words), None);
    }
}

#[test]
fn a_legend_has_no_words_before_practice_is_known() {
    for (page, unit) in [("Stretch", "Skin stretch [%]"), ("Range of implants", "%")] {
        let (mut harness, gate) = gated(flat_plan());
        harness.get_by_role_and_label(Role::Button, page).click();
        let has = |harness: &Harness<'static, App>, text: &str| {
            painted_texts(harness).iter().any(|painted| painted == text)
        };
        wait_until(&mut harness, "the legend", |harness| has(harness, unit).then_some(()));
        assert!(!has(&harness, "above practice"), "{page}");
        gate.pass(1000);
        wait_until(&mut harness, "a word of practice", |harness| {
            // A word of the skin by itself.
            assert!(!has(harness, "high"), "{page}");
            has(harness, "above practice").then_some(())
        });
    }
}

#[test]
fn a_sign_of_percent_stays_with_its_number() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    wait_for_practice(&mut harness);
    harness.run();
    let texts = painted_texts(&harness);
    assert!(texts.iter().any(|text| text.contains("practice's 300 ml: 14\u{a0}%")), "{texts:?}");
    // The accessible name is plain.
    harness.get_by_label_contains("practice's 300 ml: 14 %");
}

//! The clinic's shelf outside of its list: the menu, a table that was taken, the largest size in a sentence.

use super::*;
use implant_preview::clinical::Measurements;

const SIZES: &str = "name;width_cm;volume_ml\nLow;11,5;200\nWide;13;300\n";

#[test]
fn the_menu_file_opens_the_shelf_and_a_taken_table_is_in_sight() {
    for size in [DESKTOP, PHONE] {
        let mut harness = app(size, |scene| *scene = flat_plan());
        press(&mut harness, "File");
        harness.get_by_role_and_label(Role::Button, "Open sizes in stock…");
        harness.key_press(egui::Key::Escape);
        harness.run();
        let file = Dropped { path: "sizes.csv".into(), text: SIZES.to_owned() };
        harness.input_mut().dropped_files.push(std::sync::Arc::new(file));
        wait_until(&mut harness, "the preview", |harness| text_with(harness, "Take 2 sizes"));
        assert_eq!(text_with(&harness, "Sizes in stock: 2"), None);
        harness.get_by_role_and_label(Role::Button, "Take 2 sizes").click();
        wait_until(&mut harness, "the list", |harness| text_with(harness, "Take Low"));
        harness.get_by_label("Sizes in stock: 2");
        // The user may fold it.
        harness.run_steps(20);
        unfold(&mut harness, "Sizes in stock: 2");
        harness.run_steps(20);
        assert_eq!(text_with(&harness, "Take Low"), None);
    }
}

#[test]
fn the_largest_size_of_the_shelf_is_a_link_that_takes_it_as_the_plan() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    harness.state_mut().restore_shelf(SIZES);
    let words =
        "Largest in stock up to 12 cm within practice's stretch: Low · 200 cc (200 ml on 11.5 cm).";
    wait_until(&mut harness, "the size", |harness| text_with(harness, words));
    let before = harness.state().session().scene().clone();
    let link = harness.get_by_role_and_label(Role::Link, words);
    // The lines of a remark.
    let line = harness.ctx.global_style().text_styles[&egui::TextStyle::Small].size;
    assert!(link.rect().height() < 3.0 * line, "{}", link.rect());
    link.click();
    harness.run_steps(2);
    settle(&mut harness);
    let scene = harness.state().session().scene();
    assert_eq!((scene.implant.base_radius_mm, &*scene.implant_reference), (57.5, "Low · 200 cc"));
    // The breast keeps its base, and with it practice its volume.
    assert_eq!(scene.patient.as_ref().unwrap().measured.base_width_mm, Some(120.0));
    wait_until(&mut harness, "practice", |harness| {
        text_with(harness, "practice takes 300 ± 30 ml for the breast's base, 12 cm; ")
    });
    // Nobody measured the base.
    harness.get_by_label("Begins as the implant's width: measure it.");
    assert!(harness.query_by_label("Breast base measured").is_none());
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::Z);
    settle(&mut harness);
    assert_eq!(harness.state().session().scene(), &before);
}

#[test]
fn the_largest_size_of_the_shelf_is_as_wide_as_the_measured_breast_at_most() {
    let mut harness = app(DESKTOP, |scene| {
        *scene = flat_plan();
        let measured = scene.measured();
        scene.apply_patient(Measurements { base_width_mm: Some(130.0), ..measured }).unwrap();
    });
    harness.state_mut().restore_shelf(SIZES);
    let words = "Largest in stock up to 13 cm within practice's stretch: Wide · 300 cc";
    wait_until(&mut harness, "the size", |harness| text_with(harness, words));
}

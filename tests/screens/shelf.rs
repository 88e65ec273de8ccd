//! The clinic's shelf outside of its list: the menu, a table that was taken, the largest size in a sentence.

use super::*;
use implant_preview::clinical::Measurements;
use std::f64::consts::PI;

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

/// Drops the table and takes its sizes.
fn take_table(harness: &mut Harness<'static, App>, text: &str, take: &'static str) {
    let file = Dropped { path: "sizes.csv".into(), text: text.to_owned() };
    harness.input_mut().dropped_files.push(std::sync::Arc::new(file));
    wait_until(harness, "the preview", |harness| text_with(harness, take));
    harness.get_by_role_and_label(Role::Button, take).click();
    wait_until(harness, "the list", |harness| text_with(harness, "Take Low"));
}

#[test]
fn sizes_beside_an_expander_are_compared_as_expanders_which_the_import_says() {
    const AS_EXPANDERS: &str = "The plan is an expander: the sizes are compared as expanders.";
    for (device, page) in [("round", "Range of implants"), ("expander", "Range of expanders")] {
        let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
        press(&mut harness, device);
        let file = Dropped { path: "sizes.csv".into(), text: SIZES.to_owned() };
        harness.input_mut().dropped_files.push(std::sync::Arc::new(file));
        wait_until(&mut harness, "the preview", |harness| text_with(harness, "Take 2 sizes"));
        let is_said = harness.query_by_label(AS_EXPANDERS).is_some();
        assert_eq!(is_said, device == "expander");
        harness.get_by_role_and_label(Role::Button, "Take 2 sizes").click();
        wait_until(&mut harness, "the list", |harness| text_with(harness, "Take Low"));
        let notice = harness.state().notice_in_words();
        let words = format!("2 sizes of sizes.csv are in stock, on the page {page}.");
        assert!(notice.starts_with(&words), "{notice}");
        assert_eq!(notice.ends_with(AS_EXPANDERS), device == "expander", "{notice}");
        harness.get_by_role_and_label(Role::Button, page);
    }
}

#[test]
fn six_sizes_of_the_list_are_in_sight_on_a_usual_screen() {
    let sizes: Vec<String> = (0..8).map(|k| format!("S{k};12;{}", 200 + 20 * k)).collect();
    let text = format!("name;width_cm;volume_ml\nLow;11,5;200\n{}\n", sizes.join("\n"));
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    take_table(&mut harness, &text, "Take 9 sizes");
    harness.run_steps(5);
    let clipped = |words: &str| {
        let shapes = harness.output().shapes.iter();
        let is_text = |shape: &&egui::epaint::ClippedShape| match &shape.shape {
            egui::Shape::Text(text) => text.galley.text().starts_with(words),
            _ => false,
        };
        let found = shapes.filter(is_text).filter(|shape| {
            shape.clip_rect.expand(1.0).contains_rect(shape.shape.visual_bounding_rect())
        });
        found.count()
    };
    for name in ["Low · 200 cc", "S0 · 200 cc", "S1 ", "S2 ", "S3 ", "S4 "] {
        assert_eq!(clipped(name), 1, "{name}");
    }
    // The chart keeps half of the page.
    let chart = harness.get_by_role_and_label(Role::Canvas, "Range of implants, chart").rect();
    assert!(chart.height() > 300.0, "{chart}");
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
    let notice = harness.state().notice_in_words();
    assert!(notice.starts_with("The breast's base stays 12 cm, "), "{notice}");
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

#[test]
fn each_size_of_the_list_has_the_worst_word_of_its_cards() {
    // Half an ellipsoid of a width and a volume, solved by itself.
    let of = |width_mm: f64, volume_ml: f64| {
        let (mut plan, radius) = (flat_plan(), 0.5 * width_mm);
        plan.implant.base_radius_mm = radius;
        plan.implant.projection_mm = 1500.0 * volume_ml / (PI * radius * radius);
        plan.pocket_radius_mm = radius + 10.0;
        simulate(&plan).unwrap()
    };
    let low = of(115.0, 200.0).strain.unwrap().max_principal;
    let full = of(120.0, 500.0).contact_pressure_mmhg.unwrap().max;
    let low = format!("Skin stretch: {:.0} %, below practice", 100.0 * low);
    let full = format!("Pressure, greatest: {full:.0} mmHg, very high");
    for size in [DESKTOP, PHONE] {
        let mut harness = app(size, |scene| *scene = flat_plan());
        take_table(
            &mut harness,
            "name;width_cm;volume_ml\nLow;11,5;200\nFull;12;500\n",
            "Take 2 sizes",
        );
        for words in [&low, &full] {
            wait_until(&mut harness, words, |harness| text_with(harness, words));
        }
    }
}

#[test]
fn a_second_table_is_added_to_the_sizes_in_stock_or_replaces_them() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    take_table(&mut harness, SIZES, "Take 2 sizes");
    let more = "name;width_cm;volume_ml\nLow;11,5;200\nTall;12;320\n";
    let file = Dropped { path: "more.csv".into(), text: more.to_owned() };
    harness.input_mut().dropped_files.push(std::sync::Arc::new(file));
    wait_until(&mut harness, "the preview", |harness| text_with(harness, "Add 2 sizes"));
    assert!(harness.query_by_label("Take 2 sizes").is_none());
    harness.get_by_role_and_label(Role::Button, "Add 2 sizes").click();
    // The one that is there already is there once.
    wait_until(&mut harness, "three", |harness| text_with(harness, "Sizes in stock: 3"));
    for name in ["Take Low", "Take Wide", "Take Tall"] {
        assert!(text_with(&harness, name).is_some(), "{name}");
    }
    let other = Dropped { path: "other.csv".into(), text: more.replace("Low", "Flat") };
    harness.input_mut().dropped_files.push(std::sync::Arc::new(other));
    let replace = "Replace the 3 in stock";
    wait_until(&mut harness, "the preview", |harness| text_with(harness, replace));
    harness.get_by_role_and_label(Role::Button, replace).click();
    wait_until(&mut harness, "two", |harness| text_with(harness, "Sizes in stock: 2"));
    assert!(
        text_with(&harness, "Take Low").is_none() && text_with(&harness, "Take Flat").is_some()
    );
}

//! A tissue expander is called an expander in every text of the screen.

use super::*;
use egui_kittest::kittest::By;

/// Texts that name the implant, by label or value, without the name of the program.
fn about_implants(harness: &Harness<'static, App>) -> Vec<String> {
    let everything = By::new().predicate(|_| true).recursive(true);
    let mut found = Vec::new();
    for node in harness.query_all(everything) {
        let node = node.accesskit_node();
        for text in [node.label(), node.value()].into_iter().flatten() {
            if text.to_lowercase().contains("implant") {
                found.push(text);
            }
        }
    }
    found.retain(|text| text != "Implant preview");
    found
}

#[test]
fn an_expander_is_called_an_expander_throughout() {
    let mut harness = unfolded(|scene| *scene = flat_plan());
    harness.get_by_label("Keep the breast's base").click();
    harness.run();
    assert!(about_implants(&harness).len() > 5, "{:?}", about_implants(&harness));
    press(&mut harness, "expander");
    harness.run();
    for text in
        ["Cover over expander", "Expander volume", "Position of the expander", "Range of expanders"]
    {
        assert!(harness.query_all_by_label(text).count() > 0, "{text}");
    }
    assert_eq!(about_implants(&harness), Vec::<String>::new());
    assert!(harness.state().summary().starts_with("300 ml expander, 12 cm wide."));
    press(&mut harness, "File");
    press(&mut harness, "Save shape (3-D)");
    harness.get_by_role_and_label(Role::Button, "Expander as made as STL");
    harness.key_press(egui::Key::Escape);
    harness.run();
    // The chart and its captions too.
    press(&mut harness, "Range of expanders");
    harness.run();
    harness.get_by_role_and_label(Role::Canvas, "Range of expanders, chart");
    assert_eq!(about_implants(&harness), Vec::<String>::new());
    press(&mut harness, "Picture");
    press(&mut harness, "round");
    harness.run();
    assert!(harness.query_by_label("Cover over expander").is_none());
    assert!(harness.query_all_by_label("Cover over implant").count() > 0);
}

#[test]
fn the_tab_of_a_phone_names_the_device() {
    let mut harness = app(PHONE, |scene| *scene = flat_plan());
    press(&mut harness, "expander");
    harness.run();
    assert!(harness.query_by_role_and_label(Role::Button, "Implant").is_none());
    harness.get_by_role_and_label(Role::Button, "Expander");
}

#[test]
fn the_words_of_an_expander_are_those_of_a_fill_at_once_everywhere() {
    let mut harness = researching(DESKTOP, |scene| *scene = flat_plan());
    press(&mut harness, "expander");
    harness.run();
    harness.get_by_label("Stretch, at once");
    harness.get_by_label("Pressure, at once");
    harness.get_by_label(
        "By the skin’s own limits; filled by week the skin grows, which the model leaves out.",
    );
    harness.get_by_label_contains("300 ml, 12 cm: if filled at once, ");
    let summary = harness.state().summary();
    assert!(summary.contains("12 cm wide. If filled at once: Skin stretch "), "{summary}");
    press(&mut harness, "round");
    harness.run();
    assert!(harness.query_by_label_contains("at once").is_none());
}

#[test]
fn the_word_of_an_expander_names_the_reserve_beside_the_title() {
    for size in [DESKTOP, egui::vec2(1024.0, 768.0)] {
        let mut harness = app(size, |scene| *scene = flat_plan());
        press(&mut harness, "tight");
        press(&mut harness, "expander");
        settle(&mut harness);
        let rect = |label| harness.get_by_label(label).rect();
        let (title, word) = (rect("Stretch, at once"), rect("no reserve"));
        // The strokes of the word are between both.
        assert!(title.right() + 20.0 < word.left(), "{size}: {title:?} {word:?}");
    }
}

#[test]
fn undo_brings_an_anatomical_implant_back_from_an_expander() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    press(&mut harness, "anatomical");
    settle(&mut harness);
    let anatomical = harness.state().session().scene().clone();
    press(&mut harness, "expander");
    settle(&mut harness);
    harness.get_by_label("Stretch, at once");
    press(&mut harness, "Undo");
    settle(&mut harness);
    assert_eq!(harness.state().session().scene(), &anatomical);
    assert!(harness.query_by_label("Stretch, at once").is_none());
    harness.get_by_role_and_label(Role::SpinButton, "Height (cm)");
}

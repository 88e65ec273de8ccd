//! Windows of any size: no panic, and a comparison whose numbers stay in sight.

use super::*;

/// Widths and heights of windows \[points\], from a frame that is dragged shut to a screen.
const WIDTHS: [f32; 12] = [1.0, 3.0, 8.0, 16.0, 24.0, 30.0, 37.0, 46.0, 64.0, 120.0, 300.0, 770.0];
const HEIGHTS: [f32; 9] = [1.0, 8.0, 24.0, 60.0, 140.0, 300.0, 505.0, 765.0, 900.0];

/// Draws frames in every size.
fn in_all_sizes(harness: &mut Harness<'static, App>) {
    for width in WIDTHS {
        for height in HEIGHTS {
            harness.set_size(egui::vec2(width, height));
            harness.run_steps(2);
        }
    }
    harness.set_size(DESKTOP);
    harness.run_steps(2);
}

#[test]
fn no_window_is_too_small() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    in_all_sizes(&mut harness);
    // Natural colours have no legend, the expander has charts.
    press(&mut harness, "expander");
    in_all_sizes(&mut harness);
    press(&mut harness, "round");
    press(&mut harness, "Pin as A");
    type_into(&mut harness, "Volume (ml)", "320");
    harness.get_by_label("Side by side").click();
    // The sliders of layers and curves too.
    unfold(&mut harness, "Advanced");
    settle(&mut harness);
    in_all_sizes(&mut harness);
    harness.get_by_label("Help").click();
    harness.run_steps(2);
    in_all_sizes(&mut harness);
    harness.key_press(egui::Key::Escape);
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::K);
    harness.run_steps(2);
    in_all_sizes(&mut harness);
    harness.key_press(egui::Key::Escape);
    harness.run_steps(2);
    press(&mut harness, "Range of implants");
    in_all_sizes(&mut harness);
    harness.state_mut().notify("A notice of a few words, over the picture.");
    in_all_sizes(&mut harness);
}

#[test]
fn every_tab_of_a_phone_fits_a_window_of_any_size() {
    let mut harness = app(PHONE, |scene| *scene = flat_plan());
    for tab in ["Patient", "Pocket", "More", "Implant"] {
        harness.set_size(PHONE);
        harness.run_steps(2);
        press(&mut harness, tab);
        in_all_sizes(&mut harness);
    }
}

/// The numbers to the right of a left end, between two heights, which are whole.
fn numbers(harness: &Harness<'static, App>, left: f32, heights: std::ops::Range<f32>) -> usize {
    let texts = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
        egui::Shape::Text(text) if text.galley.text().parse::<f64>().is_ok() => {
            Some((text.visual_bounding_rect(), shape.clip_rect))
        }
        _ => None,
    });
    let is_there = |rect: &egui::Rect| rect.left() > left && heights.contains(&rect.center().y);
    let found = texts.filter(|(rect, _)| is_there(rect));
    found.filter(|(rect, clip)| clip.expand(1.0).contains_rect(*rect)).count()
}

/// The whole numbers of a row of the comparison: beside its name or below a name with a line of its own.
fn numbers_of(harness: &Harness<'static, App>, name: &str) -> usize {
    let row = harness.get_by_label(name).rect();
    match numbers(harness, row.right(), row.top()..row.bottom()) {
        0 => numbers(harness, row.left() - 2.0, row.bottom()..row.bottom() + 20.0),
        beside => beside,
    }
}

#[test]
fn long_words_leave_the_numbers_of_the_comparison_in_sight() {
    for width in [1440.0, 1024.0, 800.0] {
        let mut harness = app(egui::vec2(width, 2600.0), |scene| *scene = flat_plan());
        press(&mut harness, "Pin as A");
        press(&mut harness, "anatomical");
        harness.get_by_label("Volume, ml");
        assert_eq!(numbers_of(&harness, "Volume, ml"), 2, "{width}");
        let is_usual = width > 1000.0;
        assert!(!is_usual || cut_texts(&harness).is_empty(), "{width}");
        harness.get_by_label_contains("Shape: this plan anatomical, ");
        for volume in ["310", "320", "330"] {
            type_into(&mut harness, "Volume (ml)", volume);
            harness.get_by_label_contains("Pin as ").click();
            settle(&mut harness);
        }
        type_into(&mut harness, "Volume (ml)", "340");
        assert_eq!(numbers_of(&harness, "Volume, ml"), 5, "{width}");
        assert_eq!(numbers_of(&harness, "Most pressure, mmHg"), 5, "{width}");
        assert!(!is_usual || cut_texts(&harness).is_empty(), "{width}");
    }
}

#[test]
fn the_legends_have_whole_words_of_practice_at_every_width() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    wait_for_practice(&mut harness);
    press(&mut harness, "Stretch");
    let look = |harness: &mut Harness<'static, App>| {
        for step in 0..24 {
            harness.set_size(egui::vec2(300.0 + 60.0 * step as f32, 844.0));
            harness.run_steps(3);
            let cut: Vec<String> = cut_texts(harness);
            assert!(!cut.iter().any(|text| text.contains("practice")), "{step}: {cut:?}");
        }
        harness.set_size(DESKTOP);
        harness.run_steps(3);
        assert!(painted_texts(harness).iter().any(|text| text == "above practice"));
    };
    look(&mut harness);
    press(&mut harness, "Range of implants");
    wait_until(&mut harness, "the chart", |harness| {
        painted_texts(harness).iter().any(|text| text == "practice +30 ml").then_some(())
    });
    look(&mut harness);
}

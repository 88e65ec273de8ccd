//! Pinned plans: comparison, pictures side by side, names, what is kept.

use super::*;

#[test]
fn the_comparison_of_two_pins_and_the_answer_are_whole_on_a_small_desktop() {
    let mut harness = researching(egui::vec2(1024.0, 768.0), |scene| *scene = flat_plan());
    for (pin, volume) in [("Pin as A", "380"), ("Pin as B", "640")] {
        press(&mut harness, pin);
        type_into(&mut harness, "Volume (ml)", volume);
    }
    // Columns and sentence: all in sight.
    let heads: Vec<_> = ["this plan", "A", "B"]
        .map(|head| harness.query_all_by_label(head).last().unwrap().rect())
        .to_vec();
    assert!(heads.windows(2).all(|pair| pair[0].right() < pair[1].left()), "{heads:?}");
    assert!(heads[2].right() < 1024.0 - 8.0, "{heads:?}");
    assert_eq!(cut_texts(&harness), Vec::<String>::new());
    let sentence = harness.get_by_label_contains("640 ml, 12 cm: ");
    let [text, rect] = [sentence.value().unwrap(), format!("{:?}", sentence.rect())];
    let painted = painted_texts(&harness);
    assert!(text.ends_with(" mmHg.") && painted.contains(&text), "{text} {rect}");
    let is_elided = harness.output().shapes.iter().any(|shape| match &shape.shape {
        egui::Shape::Text(shape) => shape.galley.text() == text && shape.galley.elided,
        _ => false,
    });
    assert!(!is_elided, "the sentence is cut");
}

#[test]
fn the_legend_of_pictures_side_by_side_is_above_all_of_them() {
    for size in [DESKTOP, egui::vec2(844.0, 390.0)] {
        let mut harness = app(size, |scene| *scene = flat_plan());
        press(&mut harness, "Stretch");
        if size != DESKTOP {
            press(&mut harness, "More");
        }
        // The limits of the legend are those of practice.
        wait_for_practice(&mut harness);
        unfold(&mut harness, "Pin as A");
        unfold(&mut harness, "Side by side");
        let places = |words: &str| -> Vec<egui::Rect> {
            let texts = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
                egui::Shape::Text(text) => Some((text.galley.text(), text.visual_bounding_rect())),
                _ => None,
            });
            texts.filter(|(text, _)| text.contains(words)).map(|(_, rect)| rect).collect()
        };
        let [title] = places("Skin stretch [%]")[..] else { panic!("one legend") };
        let numbers = places("54").into_iter().map(|rect| rect.bottom()).fold(0.0, f32::max);
        for caption in ["A · ", "this plan · "] {
            let [caption] = places(caption)[..] else { panic!("{caption}") };
            assert!(caption.top() > title.bottom() + 8.0, "{size}: {title} {caption}");
            assert!(numbers > title.bottom(), "{size}");
        }
    }
}

#[test]
fn a_pinned_scene_is_compared_opened_and_removed_without_a_solve() {
    let mut harness = app(WIDE, |_| {});
    assert!(harness.query_by_label("Volume, ml").is_none());
    press(&mut harness, "Pin as A");
    focus_picture(&mut harness);
    harness.key_press(egui::Key::OpenBracket);
    settle(&mut harness);
    let (solves, edited) =
        (harness.state().session().counters().solves, harness.state().session().scene().clone());
    for label in ["Volume, ml", "Most stretch, %", "Least cover, mm", "Most pressure, mmHg"] {
        harness.get_by_label(label);
    }
    unfold(&mut harness, "More numbers");
    harness.get_by_label("Width, cm");
    // The values of the pin and of the present scene.
    let of = |outcome: &Outcome| format!("{:.1}", outcome.skin_projection_mm.unwrap());
    let session = harness.state().session();
    let values = [of(session.pins()[0].outcome().unwrap()), of(session.result().unwrap())];
    assert_ne!(values[0], values[1]);
    for value in &values {
        assert!(harness.query_all_by_label(value).count() > 0, "{value}");
    }
    harness.get_by_label("Differences in the table").click();
    harness.run();
    harness.get_by_label("− A");
    // The pin's own values stay beside the differences.
    for value in &values {
        assert!(harness.query_all_by_label(value).count() > 0, "{value}");
    }
    press(&mut harness, "Open A");
    assert!((harness.state().session().scene().insertion - 1.0).abs() < 1e-9);
    assert_eq!(harness.state().session().counters().solves, solves);
    press(&mut harness, "Undo");
    assert_eq!(harness.state().session().scene(), &edited);
    assert_eq!(pins(&harness), ["A "]);
    assert!(harness.state().summary().ends_with("Pinned: A."));
    press(&mut harness, "Remove A");
    assert!(pins(&harness).is_empty());
    harness.get_by_role_and_label(Role::Button, "Pin as A");
}

#[test]
fn the_columns_of_the_comparison_are_as_wide_as_their_numbers_when_the_results_come() {
    let mut harness = app(DESKTOP, |_| {});
    let places = |harness: &Harness<'static, App>, name: &str| {
        let found = harness.query_all_by_label(name);
        found.map(|node| node.rect()).collect::<Vec<egui::Rect>>()
    };
    press(&mut harness, "Pin as A");
    // The figures of the answer are in sight without a scroll.
    for name in ["Volume, ml", "Most stretch, %", "Least cover, mm", "Most pressure, mmHg"] {
        let [place] = places(&harness, name)[..] else { panic!("{name}") };
        assert!(place.bottom() < DESKTOP.y - 30.0, "{name}: {place}");
    }
    // Another plan, whose result is missing at first.
    type_into(&mut harness, "Volume (ml)", "320");
    press(&mut harness, "Pin as B");
    let outcome = harness.state().session().pins()[1].outcome().unwrap();
    let volume = format!("{:.0}", outcome.implant_volume_ml);
    let name = places(&harness, "Volume, ml")[0];
    let numbers = places(&harness, &volume);
    let in_row = numbers.iter().filter(|it| (it.center().y - name.center().y).abs() < 4.0);
    // Of the plan and of B, each in one line of its own column.
    let in_row: Vec<&egui::Rect> = in_row.collect();
    assert_eq!(in_row.len(), 2, "{numbers:?} {name}");
    assert!(in_row.iter().all(|it| it.height() < 20.0), "{in_row:?}");
    assert!((in_row[0].left() - in_row[1].left()).abs() > in_row[0].width() + 8.0, "{in_row:?}");
    // The switch of the differences moves nothing.
    let switch = places(&harness, "Differences in the table");
    harness.get_by_label("Differences in the table").click();
    harness.run();
    assert_eq!(places(&harness, "Differences in the table"), switch);
    assert_eq!(places(&harness, "Volume, ml")[0], name);
}

#[test]
fn pins_of_another_skin_have_a_line_with_their_skin() {
    let mut harness = app(WIDE, |_| {});
    press(&mut harness, "Stretch");
    press(&mut harness, "tight");
    settle(&mut harness);
    press(&mut harness, "Pin as A");
    assert!(harness.query_by_label_contains("Skin: this plan").is_none());
    press(&mut harness, "lax");
    settle(&mut harness);
    harness.get_by_label("Skin: this plan lax; A tight");
    harness.get_by_label("Side by side").click();
    harness.run();
    let texts = painted_texts(&harness);
    let caption = |words: &str| texts.iter().any(|text| text.ends_with(words));
    assert!(caption("\nSkin tight") && caption("\nSkin lax"), "{texts:?}");
    wait_for_practice(&mut harness);
    harness.run();
    let texts = painted_texts(&harness);
    assert!(texts.iter().any(|text| text == "Skin stretch [%]"), "{texts:?}");
}

#[test]
fn a_pin_has_the_typed_name_and_esc_restores_the_name() {
    let mut harness = app(WIDE, |_| {});
    press(&mut harness, "Pin as A");
    let name = |harness: &mut Harness<'static, App>, text: &str, key| {
        harness.get_by_role_and_label(Role::TextInput, "Name of A").focus();
        harness.run();
        harness.event(egui::Event::Text(text.to_owned()));
        harness.run();
        harness.key_press(key);
        harness.run();
    };
    name(&mut harness, "before", egui::Key::Enter);
    assert_eq!(pins(&harness), ["A before"]);
    name(&mut harness, " and after", egui::Key::Escape);
    assert_eq!(pins(&harness), ["A before"]);
    assert!(harness.state().summary().ends_with("Pinned: A before."));
}

#[test]
fn four_pins_are_the_most_and_are_shown_side_by_side() {
    let mut harness = app(WIDE, |_| {});
    for letter in ["A", "B", "C", "D"] {
        press(&mut harness, &format!("Pin as {letter}"));
        focus_picture(&mut harness);
        harness.key_press(egui::Key::OpenBracket);
        settle(&mut harness);
    }
    harness.get_by_label("All four pins are in use. Remove a pin to pin this plan.");
    assert!(harness.query_by_label("Pin as A").is_none());
    let views = |harness: &Harness<'static, App>| {
        let is_view = |name: &str| harness.query_by_role_and_label(Role::Canvas, name).is_some();
        ["3-D view of A", "3-D view of D", "3-D view"].map(is_view)
    };
    assert_eq!(views(&harness), [false, false, true]);
    harness.get_by_label("Side by side").click();
    harness.run();
    assert_eq!(views(&harness), [true, true, true]);
    press(&mut harness, "Remove D");
    assert_eq!(views(&harness), [true, false, true]);
    // The keys still act on the picture of the present scene.
    focus_picture(&mut harness);
    let before = harness.state().session().scene().insertion;
    harness.key_press(egui::Key::OpenBracket);
    settle(&mut harness);
    assert!(harness.state().session().scene().insertion < before);
    harness.get_by_label("Overlay").click();
    harness.run();
    assert_eq!(views(&harness), [false, false, true]);
}

#[test]
fn a_second_pin_of_one_scene_is_refused_in_one_line() {
    let mut harness = app(WIDE, |_| {});
    press(&mut harness, "Pin as A");
    press(&mut harness, "Pin as B");
    harness.get_by_label("This plan is pinned already, as A.");
    assert_eq!(pins(&harness), ["A "]);
}

#[test]
fn pins_of_a_file_are_solved_by_the_frames_that_the_app_requests() {
    let mut harness = app(WIDE, |_| {});
    let scene = |insertion| Scene { insertion, ..harness.state().session().scene().clone() };
    let pinned = |insertion| json!({ "scene": serde_json::to_value(scene(insertion)).unwrap() });
    let mut file = serde_json::to_value(scene(0.6)).unwrap();
    file["pins"] = json!([pinned(0.5), pinned(0.7)]);
    let solves = harness.state().session().counters().solves;
    harness.state_mut().open(file.to_string()).unwrap();
    harness.run();
    assert!(!harness.state().session().is_solving_pins());
    assert_eq!(harness.state().session().counters().solves, solves + 3);
}

#[test]
fn kept_pins_are_restored_and_an_invalid_text_is_one_notice() {
    let mut first = app(WIDE, |_| {});
    press(&mut first, "Pin as A");
    let text = first.state_mut().take_pins_to_store(true).unwrap();
    assert!(first.state_mut().take_pins_to_store(true).is_none());
    let mut harness = app(WIDE, |scene| scene.insertion = 0.5);
    harness.state_mut().restore_pins(&text);
    for _ in 0..400 {
        harness.step();
        if !harness.state().session().is_solving_pins() {
            break;
        }
    }
    assert_eq!(pins(&harness), ["A "]);
    assert!(harness.state().session().pins()[0].has_shape());
    // Restored pins are stored already.
    assert!(harness.state_mut().take_pins_to_store(true).is_none());
    harness.state_mut().restore_pins("no list of pins");
    harness.run();
    harness.get_by_label_contains("Note: The kept pins were not read: pins:");
    assert_eq!(pins(&harness), ["A "]);
    harness.state_mut().report_storage_failure();
    harness.run();
    harness.get_by_label_contains("Plan and pins cannot be kept here");
    press(&mut harness, "Close message");
    harness.state_mut().report_storage_failure();
    harness.run();
    assert!(harness.query_by_label_contains("Plan and pins cannot be kept here").is_none());
}

#[test]
fn the_comparison_is_below_the_answer_of_a_phone() {
    let mut harness = app(PHONE, |_| {});
    harness.get_by_role_and_label(Role::Button, "More").click();
    harness.run();
    harness.get_by_role_and_label(Role::Button, "Pin as A").scroll_to_me();
    harness.run();
    press(&mut harness, "Pin as A");
    harness.get_by_label("Side by side").scroll_to_me();
    harness.run();
    harness.get_by_label("Side by side").click();
    harness.run();
    let screen = harness.ctx.content_rect();
    let view = harness.get_by_role_and_label(Role::Canvas, "3-D view of A").rect();
    assert!(screen.contains_rect(view));
}

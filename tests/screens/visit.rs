//! The fold "For the file": patient and visit in words, in the plan's file only, without a solve.

use super::*;
use implant_preview::scene::{Side, Visit};

/// Focuses a field of text and types.
fn write(harness: &mut Harness<'static, App>, role: Role, field: &str, text: &str) {
    harness.get_by_role_and_label(role, field).focus();
    harness.run();
    for sign in text.chars() {
        // The Enter key of a field of several lines.
        if sign == '\n' {
            harness.key_press(egui::Key::Enter);
        } else {
            harness.event(egui::Event::Text(sign.to_string()));
        }
        harness.run();
    }
}

fn visit(harness: &Harness<'static, App>) -> Visit {
    harness.state().session().scene().visit.clone().unwrap_or_default()
}

/// An app with a filled visit.
fn filled(size: egui::Vec2) -> Harness<'static, App> {
    let mut harness = app(size, |scene| {
        *scene = flat_plan();
        scene.solver.nodes_per_side = 33;
    });
    if size == PHONE {
        press(&mut harness, "Patient");
    }
    unfold(&mut harness, "For the file");
    write(&mut harness, Role::TextInput, "Patient no.", "K. M. 4711");
    harness.state_mut().set_plan("side", "left").unwrap();
    settle(&mut harness);
    write(&mut harness, Role::TextInput, "Date of the visit", "2026-01-31");
    write(&mut harness, Role::TextInput, "Surgeon", "Dr A");
    write(&mut harness, Role::MultilineTextInput, "Remarks", "one\ntwo");
    settle(&mut harness);
    harness
}

fn known() -> Visit {
    Visit {
        reference: "K. M. 4711".to_owned(),
        date: "2026-01-31".to_owned(),
        surgeon: "Dr A".to_owned(),
        remarks: "one\ntwo".to_owned(),
        fill_steps: None,
    }
}

#[test]
fn a_visit_is_written_without_a_solve_and_a_field_is_one_step_of_the_history() {
    for size in [DESKTOP, PHONE] {
        let mut harness = filled(size);
        assert_eq!(visit(&harness), known());
        assert_eq!(harness.state().session().scene().side, Some(Side::Left));
        assert_eq!(harness.state().session().counters().solves, 1);
        assert!(harness.state().session().result().is_some());
        harness.get_by_label_contains("These entries stay in this plan's file and in the report.");
        press(&mut harness, "Undo");
        assert_eq!(visit(&harness), Visit { remarks: String::new(), ..known() });
        for _ in 0..4 {
            press(&mut harness, "Undo");
        }
        assert!(harness.state().session().scene().visit.is_none());
        assert!(!harness.state().session().can_undo());
        for _ in 0..5 {
            press(&mut harness, "Redo");
        }
        assert_eq!(visit(&harness), known());
        assert_eq!(harness.state().session().counters().solves, 1);
    }
}

#[test]
fn a_text_that_is_no_date_stays_with_its_reason_and_moves_nothing() {
    let mut harness = filled(DESKTOP);
    let place = |harness: &Harness<'static, App>| {
        harness.get_by_role_and_label(Role::TextInput, "Surgeon").rect()
    };
    let before = place(&harness);
    harness.get_by_label("25.11.2026 or 25/11/2026 (day first), or 2026-11-25");
    write(&mut harness, Role::TextInput, "Date of the visit", "9 of a long month");
    // No reason while it is being typed.
    assert!(harness.query_by_label_contains("is no date").is_none());
    write(&mut harness, Role::TextInput, "Patient no.", "x");
    harness.get_by_label_contains(
        "Not accepted: \"2026-01-319 of a lon\" is no date: 25.11.2026 or 25/11/2026 (day first)",
    );
    assert_eq!(visit(&harness).date, "2026-01-31");
    assert_eq!(place(&harness), before);
}

#[test]
fn a_text_near_its_limit_says_how_long_it_is_and_moves_nothing() {
    let mut harness = filled(DESKTOP);
    press(&mut harness, "Pin as A");
    let place = |harness: &Harness<'static, App>| {
        ["Pin as B", "Surgeon", "Remarks"]
            .map(|name| harness.get_all_by_label(name).last().unwrap().rect())
    };
    let before = place(&harness);
    for (role, field, most) in [
        (Role::MultilineTextInput, "Remarks", 500),
        (Role::TextInput, "Surgeon", 60),
        (Role::TextInput, "Name of A", 25),
    ] {
        harness.get_by_role_and_label(role, field).focus();
        harness.run();
        assert!(harness.query_by_label_contains(" characters").is_none(), "{field}");
        let typed = |harness: &mut Harness<'static, App>, length: usize| {
            harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
            harness.event(egui::Event::Paste("x".repeat(length)));
            harness.run();
        };
        typed(&mut harness, 9 * most / 10 - 1);
        assert!(harness.query_by_label_contains(" characters").is_none(), "{field}");
        for length in [most - 1, most, most + 20] {
            typed(&mut harness, length);
            harness.get_by_label(&format!("{} of {most} characters", length.min(most)));
        }
        // The field of the remarks grows with its lines.
        if field != "Remarks" {
            assert_eq!(place(&harness), before, "{field}");
        }
        typed(&mut harness, 3);
    }
}

/// Selects the text of the focused field and types over it.
fn type_over(harness: &mut Harness<'static, App>, text: &str) {
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.run();
    for sign in text.chars() {
        harness.event(egui::Event::Text(sign.to_string()));
        harness.run();
    }
}

#[test]
fn a_date_is_read_as_a_person_writes_it_and_today_is_a_button() {
    let mut harness = filled(DESKTOP);
    let field = |harness: &Harness<'static, App>| {
        harness.get_by_role_and_label(Role::TextInput, "Date of the visit").value().unwrap()
    };
    for (text, date) in
        [("25.11.2026", "2026-11-25"), ("3/4/2026", "2026-04-03"), ("2026-11-26", "2026-11-26")]
    {
        harness.get_by_role_and_label(Role::TextInput, "Date of the visit").focus();
        harness.run();
        type_over(&mut harness, text);
        assert_eq!(visit(&harness).date, date, "{text}");
        harness.get_by_role_and_label(Role::TextInput, "Patient no.").focus();
        harness.run();
        assert_eq!(field(&harness), date, "{text}");
    }
    press(&mut harness, "Today");
    let today = visit(&harness).date;
    assert!(implant_preview::scene::visit::is_date(&today) && field(&harness) == today, "{today}");
    // The form takes the same texts.
    harness.state_mut().set_plan("date", "1.2.2026").unwrap();
    settle(&mut harness);
    assert_eq!(visit(&harness).date, "2026-02-01");
    let error = harness.state_mut().set_plan("date", "1.2.26").unwrap_err();
    assert!(error.contains("25.11.2026 or 25/11/2026 (day first)"), "{error}");
}

#[test]
fn a_visit_is_in_the_plans_file_only() {
    let mut harness = filled(DESKTOP);
    press(&mut harness, "Pin as A");
    type_into(&mut harness, "Volume (ml)", "340");
    press(&mut harness, "Pin as B");
    let is_in = |text: &str| text.contains("K. M. 4711") || text.contains("visit");
    let state = harness.state_mut();
    assert!(is_in(&state.session().document_json()));
    assert!(!is_in(&state.session().shared_document_json()));
    assert!(!is_in(&state.take_plan_to_store(true).unwrap()), "kept for the next start");
    assert!(!is_in(&state.take_pins_to_store(true).unwrap()), "kept with the pins");
    assert!(!is_in(&state.result_json().unwrap()), "in the numbers");

    // A change of the visit is no other plan: nothing to store, nothing to pin.
    write(&mut harness, Role::TextInput, "Surgeon", "B");
    assert_eq!(visit(&harness).surgeon, "Dr AB");
    assert!(harness.state_mut().take_plan_to_store(true).is_none());
    press(&mut harness, "Open A");
    assert_eq!(visit(&harness).surgeon, "Dr AB");
    // The file brings the visit back, a link's text does not.
    let json = harness.state().session().document_json();
    press(&mut harness, "Start over");
    assert!(harness.state().session().scene().visit.is_none());
    harness.state_mut().open(json).unwrap();
    settle(&mut harness);
    assert_eq!(visit(&harness), Visit { surgeon: "Dr AB".to_owned(), ..known() });
}

#[test]
fn the_link_says_that_it_leaves_out_the_visit() {
    let mut harness = filled(DESKTOP);
    harness.state_mut().set_page_address("https://a.example/".to_owned());
    press(&mut harness, "File");
    press(&mut harness, "Copy link");
    harness.get_by_label_contains("the whole plan, without the entries for the file.");
}

#[test]
fn a_report_asks_for_its_entries_first_and_with_them_enter_saves() {
    for size in [DESKTOP, PHONE] {
        let mut harness = app(size, |scene| {
            *scene = flat_plan();
            scene.solver.nodes_per_side = 33;
        });
        // Without graphics a report ends with this notice.
        let is_saved = |harness: &Harness<'static, App>| {
            harness.state().notice_in_words().contains("No picture was made")
        };
        let is_asked = |harness: &Harness<'static, App>| {
            harness.query_by_role_and_label(Role::Button, "Save report").is_some()
        };
        press(&mut harness, "Report");
        assert!(is_asked(&harness) && !is_saved(&harness), "{size}");
        assert_eq!(cut_texts(&harness), Vec::<String>::new(), "{size}");
        let screen = harness.ctx.content_rect();
        for button in ["Save report", "Cancel"] {
            let rect = harness.get_by_role_and_label(Role::Button, button).rect();
            assert!(screen.contains_rect(rect), "{size}: {rect}");
        }
        // What is typed first is the number, which Escape and Cancel drop.
        for sign in "47".chars() {
            harness.event(egui::Event::Text(sign.to_string()));
            harness.run();
        }
        harness.key_press(egui::Key::Escape);
        harness.run();
        assert!(!is_asked(&harness) && !is_saved(&harness), "{size}");
        press(&mut harness, "Report");
        press(&mut harness, "Cancel");
        assert!(!is_asked(&harness) && !is_saved(&harness), "{size}");
        assert_eq!(visit(&harness), Visit::default());

        press(&mut harness, "Report");
        for sign in "4711".chars() {
            harness.event(egui::Event::Text(sign.to_string()));
            harness.run();
        }
        harness.get_all_by_role_and_label(Role::Button, "right").last().unwrap().click();
        harness.run();
        press(&mut harness, "Save report");
        assert!(!is_asked(&harness) && is_saved(&harness), "{size}");
        assert_eq!(visit(&harness).reference, "4711");
        assert_eq!(harness.state().session().scene().side, Some(Side::Right));
        // The next press shows what was entered, and Enter saves.
        press(&mut harness, "Start over");
        harness.state_mut().set_plan("reference", "4711").unwrap();
        settle(&mut harness);
        press(&mut harness, "Report");
        assert!(is_asked(&harness) && !is_saved(&harness), "{size}");
        let fields = harness.get_all_by_role_and_label(Role::TextInput, "Patient no.");
        assert_eq!(fields.last().unwrap().value().unwrap(), "4711");
        harness.get_by_label_contains("after the next start they are gone here");
        harness.key_press(egui::Key::Enter);
        settle(&mut harness);
        assert!(!is_asked(&harness) && is_saved(&harness), "{size}");
    }
}

#[test]
fn a_saved_report_says_what_of_number_and_side_is_missing() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    let save = |harness: &mut Harness<'static, App>, name: &str| {
        harness.state_mut().notify_saved(name);
        harness.run();
        harness.state().notice_in_words()
    };
    assert_eq!(save(&mut harness, "a.png"), "Saved a.png.");
    let words = save(&mut harness, "a.html");
    assert_eq!(words, "Note: Saved a.html. No patient number and no side in it.");
    press(&mut harness, "left");
    let words = save(&mut harness, "a.html");
    assert_eq!(words, "Note: Saved a.html. No patient number in it.");
    harness.state_mut().set_plan("reference", "4711").unwrap();
    assert_eq!(save(&mut harness, "a.html"), "Saved a.html.");
}

#[test]
fn entries_of_the_report_leave_the_ranges_of_the_cards_which_the_report_has() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    wait_until(&mut harness, "the ranges", |harness| {
        harness.query_by_label("Up to date").map(|_| ())
    });
    harness.run();
    // The numbers of patients, and the ranges in brackets: on the cards, and so in a report of the frame.
    let cards = |harness: &Harness<'static, App>| {
        let words = [" patients", " such patients", "–"].map(|words| text_with(harness, words));
        (words, harness.state().summary())
    };
    let before = cards(&harness);
    assert!(before.1.contains(" such patients"), "{}", before.1);
    press(&mut harness, "Report");
    for sign in "4711".chars() {
        harness.event(egui::Event::Text(sign.to_string()));
        harness.run();
    }
    harness.get_all_by_role_and_label(Role::Button, "right").last().unwrap().click();
    harness.run();
    harness.get_by_role_and_label(Role::Button, "Save report").click();
    for frame in 0..20 {
        harness.step();
        assert_eq!(cards(&harness), before, "{frame}");
    }
    assert_eq!(harness.state().session().scene().side, Some(Side::Right));
    assert!(harness.state().notice_in_words().contains("No picture was made"));
}

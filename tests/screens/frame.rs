//! The frame of the app: every control by its name, panels, toolbar, messages, frames at rest, small screens.

use super::*;

#[test]
fn every_control_and_reading_has_its_name() {
    // A table of names.
    let harness = unfolded(|_| {});
    for slider in [
        "Width (cm)",
        "Volume (ml)",
        "Projection (cm)",
        "Pinch (cm)",
        "Margin (cm)",
        "In place (%)",
        "Tolerance (% of the base radius)",
    ] {
        harness.get_by_role_and_label(Role::Slider, slider);
        harness.get_by_role_and_label(Role::SpinButton, slider);
    }
    for field in ["To the side (cm)", "Up (cm)", "Direction of the cut"] {
        harness.get_by_role_and_label(Role::SpinButton, field);
    }
    harness.get_by_role_and_label(Role::Canvas, "Position of the implant");
    // One control per layer.
    for slider in ["Thickness (mm)", "Poisson ratio"] {
        let count = harness.get_all_by_role_and_label(Role::Slider, slider).count();
        assert_eq!(count, 2, "{slider}");
    }
    for button in [
        "File",
        "Undo",
        "Redo",
        "Start over",
        "View",
        "Help",
        "Report",
        "Look",
        "Inside",
        "Stretch",
        "round",
        "anatomical",
        "expander",
        "Let the width follow",
        "Let the volume follow",
        "Let the projection follow",
        "Low",
        "Moderate",
        "High",
        "Half sphere",
        "tight",
        "normal",
        "lax",
        "very lax",
        "pull…",
        "Front",
        "Side",
        "Top",
        "All",
        "Show insertion",
        "Fast",
        "Normal",
        "Fine",
        "Add skin",
        "Add fat",
        "Move inward layer 1",
        "Move outward layer 2",
        "Remove layer 2",
    ] {
        harness.get_by_role_and_label(Role::Button, button);
    }
    for list in ["Tissue model", "Law of the tissue", "Resolution"] {
        harness.get_by_role_and_label(Role::ComboBox, list);
    }
    for reading in [
        "What happens",
        "Skin stretch",
        "Cover over implant",
        "not thin",
        "Pressure on the tissue",
        "Height of the breast mound",
        "Skin area gained",
        "Skin area gained, of the pocket",
        "Skin stretch, of its reserve",
        "Greatest stress, skin",
        "Greatest stress, fat",
        "Area stretched above 54 %",
        "Force, vertical",
        "Implant volume",
        "Contact radius, at rest",
        "Cover over the apex",
        "Least cover",
        "Pull at the pocket's edge",
    ] {
        assert!(harness.query_all_by_label(reading).count() > 0, "{reading}");
    }
    // In kPa and in mmHg.
    for reading in ["Pressure, mean", "Pressure, greatest"] {
        assert_eq!(harness.query_all_by_label(reading).count(), 2, "{reading}");
    }
    solved_status(&harness);
    harness.get_by_label_contains("Not a medical device");
}

#[test]
fn plan_and_cards_fit_on_the_screen_without_a_scroll_bar() {
    for size in [DESKTOP, egui::vec2(1280.0, 800.0), egui::vec2(1024.0, 768.0)] {
        let mut harness = app(size, |scene| {
            *scene = flat_plan();
            scene.solver = Scene::opening().solver;
        });
        // The expander's and the pull's rows too.
        for chips in [&[][..], &["pull…"][..], &["expander"][..]] {
            for chip in chips {
                harness.get_by_role_and_label(Role::Button, chip).click();
                settle(&mut harness);
            }
            let tissue = harness.get_by_label("Tissue").rect();
            let sources = harness.get_by_label("Where limits come from").rect();
            let status = solved_status(&harness);
            assert!(tissue.bottom() < status.top(), "{size} {chips:?}: {tissue:?} {status:?}");
            assert!(sources.bottom() < status.top(), "{size} {chips:?}: {sources:?}");
            assert_eq!(cut_texts(&harness), Vec::<String>::new(), "{size} {chips:?}");
        }
        let picture = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
        assert!(picture.width() > 0.46 * size.x, "{size}: {picture:?}");
    }
}

#[test]
fn an_edit_is_solved_in_its_own_frame() {
    for (size, field) in [
        (DESKTOP, "Width (cm)"),
        (DESKTOP, "In place (%)"),
        (PHONE, "Width (cm)"),
        (PHONE, "In place (%)"),
    ] {
        let mut harness = app(size, |_| {});
        if field == "In place (%)" {
            open_push(&mut harness);
        }
        harness.get_by_role_and_label(Role::SpinButton, field).focus();
        harness.run();
        let session = harness.state().session();
        let (scene, before) = (session.scene().clone(), session.counters());
        let revision = session.revision();
        // The press alone: the release is a frame of its own.
        harness.event(egui::Event::Key {
            key: egui::Key::ArrowDown,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: egui::Modifiers::NONE,
        });
        harness.step();
        let session = harness.state().session();
        assert_ne!(*session.scene(), scene, "{field}");
        let after = session.counters();
        assert_eq!((after.solves, after.slices), (before.solves + 1, before.slices + 1), "{field}");
        assert!(session.revision() > revision, "{field}");
        // The panels before the slice show its result in a further frame.
        settle(&mut harness);
        solved_status(&harness);
    }
}

#[test]
fn a_message_stays_until_closed() {
    let mut harness = app(WIDE, |_| {});
    harness.state_mut().notify("This is the scene that was open.");
    harness.run();
    harness.get_by_label("This is the scene that was open.");
    harness.get_by_role_and_label(Role::Button, "Close message").click();
    harness.run();
    assert!(harness.query_by_label("This is the scene that was open.").is_none());
}

#[test]
fn the_picture_keeps_its_width_while_parts_are_folded_and_unfolded() {
    let mut harness = app(WIDE, |_| {});
    let picture = |harness: &Harness<'static, App>| {
        harness.get_by_role_and_label(Role::Canvas, "3-D view").rect().x_range()
    };
    let before = picture(&harness);
    for fold in ["Advanced", "Details", "Advanced", "Details"] {
        harness.get_by_label(fold).click();
        harness.run();
        (0..20).for_each(|_| harness.step());
        assert_eq!(picture(&harness), before);
    }
}

#[test]
fn a_long_name_does_not_displace_the_picture() {
    let mut harness = app(WIDE, |_| {});
    let left = |harness: &Harness<'static, App>| {
        harness.get_by_role_and_label(Role::Canvas, "3-D view").rect().width()
    };
    let before = left(&harness);
    let mut scene = harness.state().session().scene().clone();
    scene.layers[0].tissue = "skin of the lower pole ".repeat(4);
    harness.state_mut().open(scene.to_json()).unwrap();
    settle(&mut harness);
    let after = left(&harness);
    assert!(after > 0.8 * before, "the picture is {after} wide, before {before}");
}

#[test]
fn an_idle_app_solves_nothing_and_requests_no_repaint() {
    let mut harness = app(WIDE, |scene| *scene = flat_plan());
    largest_usual(&mut harness);
    wait_for_studies(&mut harness);
    let counters = harness.state().session().counters();
    let revision = harness.state().session().revision();
    for _ in 0..5 {
        harness.step();
        let output = &harness.output().viewport_output;
        for viewport in output.values() {
            assert!(viewport.repaint_delay > std::time::Duration::from_secs(1));
        }
    }
    assert_eq!(harness.state().session().counters(), counters);
    assert_eq!(harness.state().session().revision(), revision);
}

#[test]
fn a_rejected_scene_changes_nothing_and_shows_the_reason() {
    let mut harness = app(WIDE, |_| {});
    let before = harness.state().session().scene().clone();
    let error = harness
        .state_mut()
        .open(r#"{"implant":{"base_radius_mm":500}}"#.to_owned())
        .unwrap_err()
        .to_string();
    assert_eq!(error, "implant.base_radius_mm is 500; allowed: 10 to 120 mm");
    harness.run();
    assert_eq!(harness.state().session().scene(), &before);
}

#[test]
fn on_a_phone_the_answer_stays_above_the_tabs_and_the_picture_keeps_half() {
    let mut harness = app(PHONE, |scene| *scene = flat_plan());
    let picture = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
    assert!(picture.height() > 0.45 * PHONE.y, "{picture:?}");
    for (name, control) in [
        ("Implant", "Width (cm)"),
        ("Patient", "Pinch (cm)"),
        ("Pocket", "Margin (cm)"),
        ("More", "Tolerance (% of the base radius)"),
    ] {
        let tab = harness.get_by_role_and_label(Role::Button, name);
        let tab_rect = tab.rect();
        assert!(tab_rect.height() >= 48.0, "{name}: {tab_rect:?}");
        tab.click();
        harness.run();
        for answer in ["Stretch", "Cover", "Pressure"] {
            let rect = harness.get_by_role_and_label(Role::Label, answer).rect();
            assert!(rect.top() > picture.bottom() && rect.bottom() <= tab_rect.top(), "{answer}");
        }
        let words = harness.get_by_label("Not a medical device").rect();
        assert!(words.bottom() <= PHONE.y && words.right() <= PHONE.x, "{words:?}");
        if name == "More" {
            harness.get_by_label("Cover over implant");
            unfold(&mut harness, "Advanced");
            harness.get_by_role_and_label(Role::Slider, control);
        } else {
            // No sliders under a scrolling finger.
            harness.get_by_role_and_label(Role::SpinButton, control);
            assert!(harness.query_by_role_and_label(Role::Slider, control).is_none(), "{control}");
            assert_eq!(cut_texts(&harness), Vec::<String>::new(), "{name}");
        }
    }
}

#[test]
fn the_toolbar_fits_in_320_points() {
    let harness = app(egui::vec2(320.0, 568.0), |scene| *scene = flat_plan());
    let buttons = ["File", "Undo", "Redo", "Start over", "Help", "Report"];
    let rects = buttons.map(|name| harness.get_by_role_and_label(Role::Button, name).rect());
    for (pair, names) in rects.windows(2).zip(buttons.windows(2)) {
        assert!(pair[0].right() < pair[1].left(), "{names:?} overlap: {pair:?}");
    }
    assert!(rects[5].right() <= 320.0);
}

#[test]
fn a_turned_phone_has_the_picture_beside_the_answer() {
    let screen = egui::vec2(844.0, 390.0);
    let harness = app(screen, |scene| *scene = flat_plan());
    let picture = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
    assert!(picture.width() > 380.0 && picture.height() > 280.0, "{picture:?}");
    let window = egui::Rect::from_min_size(egui::Pos2::ZERO, screen);
    for name in ["Stretch", "Cover", "Pressure"] {
        let figure = harness.get_by_role_and_label(Role::Label, name).rect();
        assert!(window.contains_rect(figure) && figure.left() >= picture.right(), "{name}");
    }
    for tab in ["Implant", "Patient", "Pocket", "More"] {
        let tab = harness.query_all_by_role_and_label(Role::Button, tab).next().unwrap().rect();
        assert!(window.contains_rect(tab) && tab.left() >= picture.right(), "{tab:?}");
    }
}

#[test]
fn the_side_panels_can_be_made_wider() {
    let mut harness = app(DESKTOP, |_| {});
    let picture = |harness: &Harness<'static, App>| {
        harness.get_by_role_and_label(Role::Canvas, "3-D view").rect()
    };
    let before = picture(&harness);
    let edge = egui::pos2(before.left(), before.center().y);
    let drag = |harness: &mut Harness<'static, App>, from: egui::Pos2, to: egui::Pos2| {
        harness.hover_at(from);
        harness.run();
        harness.drag_at(from);
        harness.run();
        harness.hover_at(to);
        harness.run();
        harness.drop_at(to);
        harness.run();
    };
    drag(&mut harness, edge, edge + egui::vec2(60.0, 0.0));
    let wider = picture(&harness);
    assert!((wider.left() - before.left() - 60.0).abs() < 4.0, "{before} became {wider}");
    assert!((wider.right() - before.right()).abs() < 1.0, "{before} became {wider}");
    // The picture keeps a third of the window, the panel its content.
    drag(&mut harness, wider.left_center(), wider.right_center());
    assert!(picture(&harness).width() > 0.3 * DESKTOP.x);
    let far = picture(&harness).left_center();
    drag(&mut harness, far, egui::pos2(5.0, far.y));
    assert!(picture(&harness).left() > 260.0);
}

#[test]
fn undo_and_redo_count_every_press_within_a_frame() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    let volumes = ["310", "320", "330", "340"];
    for volume in volumes {
        type_into(&mut harness, "Volume (ml)", volume);
    }
    let volume = |harness: &Harness<'static, App>| {
        harness.state().session().scene().implant.size().unwrap().volume_ml().round()
    };
    let press = |harness: &mut Harness<'static, App>, modifiers| {
        for pressed in [true, false, true, false, true, false] {
            let event = egui::Event::Key {
                key: egui::Key::Z,
                physical_key: None,
                pressed,
                repeat: false,
                modifiers,
            };
            harness.event_modifiers(event, modifiers);
        }
        settle(harness);
    };
    press(&mut harness, egui::Modifiers::COMMAND);
    assert_eq!(volume(&harness), 310.0);
    press(&mut harness, egui::Modifiers::COMMAND | egui::Modifiers::SHIFT);
    assert_eq!(volume(&harness), 340.0);
}

#[test]
fn the_scroll_bar_of_the_answer_stands_beside_the_cards() {
    let mut harness = app(egui::vec2(1280.0, 800.0), |scene| *scene = flat_plan());
    unfold(&mut harness, "Where limits come from");
    harness.run_steps(10);
    let screen = harness.ctx.content_rect();
    let rects = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
        egui::Shape::Rect(rect) if rect.rect.left() > 0.5 * screen.width() => Some(rect.clone()),
        _ => None,
    });
    let rects: Vec<egui::epaint::RectShape> = rects.collect();
    let is_bar = |of: &&egui::epaint::RectShape| of.rect.width() < 11.0 && of.rect.height() > 100.0;
    let bar = rects.iter().find(is_bar).unwrap();
    // The frames of the cards.
    let is_card = |of: &&egui::epaint::RectShape| {
        of.corner_radius == egui::CornerRadius::same(8) && of.rect.width() > 200.0
    };
    let cards: Vec<egui::Rect> = rects.iter().filter(is_card).map(|of| of.rect).collect();
    assert_eq!(cards.len(), 3, "{cards:?}");
    for card in cards {
        assert!(card.right() + 1.0 < bar.rect.left(), "{card} {}", bar.rect);
    }
}

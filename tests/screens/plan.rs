//! The plan: sizes, patient, pocket, position; what is typed, dragged and kept.

use super::*;

#[test]
fn any_two_of_width_volume_and_projection_give_the_third() {
    let mut harness = researching(DESKTOP, |scene| *scene = flat_plan());
    let size = |harness: &Harness<'static, App>| {
        let implant = harness.state().session().scene().implant;
        let (radius, projection) = (implant.base_radius_mm, implant.projection_mm);
        let volume = 2.0 / 3.0 * std::f64::consts::PI * radius * radius * projection / 1000.0;
        [0.2 * radius, volume, 0.1 * projection]
    };
    let near = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3 * b);
    harness.get_by_label("Projection follows width and volume.");
    type_into(&mut harness, "Volume (ml)", "350 cc");
    assert!(near(size(&harness), [12.0, 350.0, 4.6420]), "{:?}", size(&harness));
    // The pocket keeps its margin.
    type_into(&mut harness, "Width (cm)", "13");
    assert!(near(size(&harness), [13.0, 350.0, 3.9554]), "{:?}", size(&harness));
    assert_eq!(harness.state().session().scene().pocket_radius_mm, 75.0);
    // The one that follows can be typed too: then another one follows.
    type_into(&mut harness, "Projection (cm)", "45 mm");
    assert!(near(size(&harness), [13.0, 398.2, 4.5]), "{:?}", size(&harness));
    harness.get_by_label("Volume follows width and projection.");
    harness.get_by_role_and_label(Role::Button, "Let the width follow").click();
    harness.run();
    type_into(&mut harness, "Volume (ml)", "300");
    assert!(near(size(&harness), [11.284, 300.0, 4.5]), "{:?}", size(&harness));
    // A profile is chosen for the present width.
    harness.get_by_role_and_label(Role::Button, "Half sphere").click();
    settle(&mut harness);
    let [width, _, projection] = size(&harness);
    assert!((0.5 * width - projection).abs() < 1e-9);
    type_into(&mut harness, "Volume (ml)", "9000");
    harness.get_by_label_contains("Not accepted: at most ");
}

#[test]
fn an_expander_is_filled_on_a_base_of_fixed_width() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    harness.get_by_role_and_label(Role::Button, "expander").click();
    settle(&mut harness);
    for name in ["Volume (ml)", "Projection (cm)"] {
        assert!(harness.query_by_role_and_label(Role::SpinButton, name).is_none(), "{name}");
    }
    type_into(&mut harness, "Fill (ml)", "150");
    let implant = harness.state().session().scene().implant;
    assert_eq!(implant.base_radius_mm, 60.0);
    assert!((implant.projection_mm - 19.894).abs() < 1e-3);
    harness.get_by_label("The fill raises the dome to 2.0 cm.");
}

#[test]
fn pinch_and_skin_become_thicknesses_and_a_strain_scale() {
    let mut harness = app(WIDE, |scene| *scene = flat_plan());
    let scene = |harness: &Harness<'static, App>| harness.state().session().scene().clone();
    let thicknesses = |harness: &Harness<'static, App>| {
        scene(harness).layers.iter().map(|layer| layer.thickness_mm).collect::<Vec<_>>()
    };
    type_into(&mut harness, "Pinch (cm)", "3");
    assert_eq!(thicknesses(&harness), [1.5, 13.5]);
    harness.get_by_role_and_label(Role::Button, "very lax").click();
    settle(&mut harness);
    assert!((scene(&harness).layers[0].curve.strain_scale - 1.7).abs() < 1e-12);
    harness.get_by_role_and_label(Role::Button, "pull…").click();
    settle(&mut harness);
    let measured = scene(&harness).patient.unwrap().measured;
    assert_eq!((measured.skin_pull_mm, measured.base_width_mm), (Some(25.0), Some(120.0)));
    type_into(&mut harness, "Pull (cm)", "3,5");
    assert!((scene(&harness).layers[0].curve.strain_scale - 1.0).abs() < 0.05);
    // A value set by hand stays, is marked, and can be given back to the measurements.
    unfold(&mut harness, "Tissue");
    let fields = harness.get_all_by_role_and_label(Role::SpinButton, "Thickness (mm)");
    fields.last().unwrap().focus();
    harness.run();
    harness.event(egui::Event::Text("20".to_owned()));
    harness.run();
    harness.key_press(egui::Key::Enter);
    settle(&mut harness);
    type_into(&mut harness, "Pinch (cm)", "4");
    assert_eq!(thicknesses(&harness), [1.5, 20.0]);
    harness.get_by_label("1 value is set by hand.");
    harness.get_by_role_and_label(Role::Button, "Use the measurements").click();
    settle(&mut harness);
    assert_eq!(thicknesses(&harness), [1.5, 18.5]);
    assert_eq!(harness.query_all_by_label_contains("set by hand").count(), 0);
}

#[test]
fn a_sheet_gets_a_patient_and_stays_a_sheet() {
    let mut harness = app(DESKTOP, |scene| *scene = Scene::sheet());
    type_into(&mut harness, "Pinch (cm)", "3");
    let scene = harness.state().session().scene().clone();
    assert!(!scene.is_layered());
    assert_eq!(scene.layers[1].thickness_mm, 13.5);
    // Without solid layers there is no cover.
    harness.get_by_label("needs “Skin on solid layers” (Advanced)");
}

#[test]
fn a_dragged_slider_changes_the_scene_and_undo_reverts_the_change() {
    let mut harness = app(DESKTOP, |_| {});
    let before = harness.state().session().scene().clone();
    let solves = harness.state().session().counters().solves;
    let rect = harness.get_by_role_and_label(Role::Slider, "Width (cm)").rect();
    let at = |share: f32| egui::pos2(rect.left() + share * rect.width(), rect.center().y);
    harness.drag_at(at(0.5));
    for share in [0.5, 0.4, 0.25] {
        harness.hover_at(at(share));
        harness.step();
    }
    harness.drop_at(at(0.25));
    settle(&mut harness);
    let scene = harness.state().session().scene().clone();
    assert!(scene.implant.base_radius_mm < before.implant.base_radius_mm - 1.0);
    assert!(harness.state().session().counters().solves > solves);
    harness.get_by_role_and_label(Role::Button, "Undo").click();
    settle(&mut harness);
    assert_eq!(harness.state().session().scene(), &before);
    assert!(!harness.state().session().can_undo());
}

#[test]
fn the_half_sphere_is_an_example_of_the_menu_and_the_plan_comes_back() {
    let mut harness = researching(DESKTOP, |scene| scene.set_tissue_model(TissueModel::Sheet));
    for (example, scene) in
        [("Half sphere of 11 cm", Scene::default()), ("Usual implant", Scene::first_plan())]
    {
        harness.get_by_role_and_label(Role::Button, "File").click();
        harness.run();
        harness.get_by_label(example).click();
        settle(&mut harness);
        assert_eq!(harness.state().session().scene(), &scene);
    }
    for _ in 0..2 {
        harness.get_by_role_and_label(Role::Button, "Undo").click();
        settle(&mut harness);
    }
    assert!(!harness.state().session().scene().is_layered());
}

#[test]
fn steppers_of_a_phone_step_and_have_the_size_of_a_finger() {
    let mut harness = app(PHONE, |scene| *scene = flat_plan());
    let button = harness.get_by_role_and_label(Role::Button, "More Volume");
    assert!(button.rect().width() >= 44.0 && button.rect().height() >= 44.0);
    button.click();
    settle(&mut harness);
    let value = harness.get_by_role_and_label(Role::SpinButton, "Volume (ml)").value().unwrap();
    assert_eq!(value, "305");
    harness.get_by_role_and_label(Role::Button, "Less Width").click();
    settle(&mut harness);
    let scene = harness.state().session().scene();
    assert_eq!((scene.implant.base_radius_mm, scene.pocket_radius_mm), (59.5, 69.5));
}

#[test]
fn typed_numbers_are_stored_exactly_or_rejected_with_a_message() {
    let mut harness = researching(WIDE, |_| {});
    let radius =
        |harness: &Harness<'static, App>| harness.state().session().scene().implant.base_radius_mm;
    let field = "Width (cm)";
    harness.get_by_role_and_label(Role::Button, "Let the volume follow").click();
    harness.run();
    for (text, value) in [
        ("7.96", 39.8),
        ("9.28", 46.4),
        ("92.84 mm", 46.42),
        ("9,0 cm", 45.0),
        ("90 mm", 45.0),
        ("9cm", 45.0),
        ("10,1", 50.5),
    ] {
        type_into(&mut harness, field, text);
        assert_eq!(radius(&harness).to_bits(), f64::to_bits(value), "{text}");
    }
    for (text, reason) in [
        ("-5", "Not accepted: at least 2 cm"),
        ("500", "Not accepted: at most 24 cm"),
        ("abc", "Not accepted: “abc” is not a number"),
    ] {
        type_into(&mut harness, field, text);
        harness.get_by_label(&format!("{reason}; 10.1 cm counts"));
        assert_eq!(radius(&harness).to_bits(), f64::to_bits(50.5), "{text}");
    }
    // Escape restores the value and removes the message.
    harness.key_press(egui::Key::Escape);
    harness.run();
    assert_eq!(harness.query_all_by_label_contains("Not accepted").count(), 0);
    // Enter keeps the focus.
    type_into(&mut harness, field, "8");
    assert!(harness.get_by_role_and_label(Role::SpinButton, field).is_focused());
}

#[test]
fn a_shifted_implant_stays_in_its_pocket_and_a_larger_pocket_is_offered() {
    let mut harness = app(DESKTOP, |_| {});
    let scene = |harness: &Harness<'static, App>| harness.state().session().scene().clone();
    let before = scene(&harness);
    type_into(&mut harness, "To the side (cm)", "2.5");
    harness.get_by_label_contains("Not accepted: at most 1.5 cm in this pocket");
    assert_eq!(scene(&harness), before);
    let offer = "Make the pocket 16.0 cm wide";
    harness.get_by_role_and_label(Role::Button, offer).click();
    settle(&mut harness);
    assert_eq!(
        (scene(&harness).pocket_radius_mm, scene(&harness).implant.center_mm),
        (80.0, [25.0, 0.0])
    );
    // A margin that would leave the implant outside is rejected.
    type_into(&mut harness, "Margin (cm)", "1");
    harness.get_by_label_contains("Not accepted: 2.5 to ");
    assert_eq!(scene(&harness).pocket_radius_mm, 80.0);
    // A drag on the pad stops at the pocket's rim.
    harness.state_mut().open(before.to_json()).unwrap();
    settle(&mut harness);
    let pad = harness.get_by_role_and_label(Role::Canvas, "Position of the implant").rect();
    harness.drag_at(pad.center());
    harness.step();
    for travel in [20.0, 60.0, 200.0] {
        harness.hover_at(pad.center() + egui::vec2(travel, 0.0));
        harness.step();
    }
    harness.drop_at(pad.center() + egui::vec2(200.0, 0.0));
    settle(&mut harness);
    assert_eq!(scene(&harness).pocket_radius_mm, 70.0);
    let [x, y] = scene(&harness).implant.center_mm;
    assert!((x - 15.0).abs() < 1e-6 && y.abs() < 1e-9, "{x} {y}");
    // Arrow keys move the implant too.
    harness.get_by_role_and_label(Role::Canvas, "Position of the implant").focus();
    harness.run();
    harness.key_press(egui::Key::ArrowLeft);
    settle(&mut harness);
    let [x, _] = scene(&harness).implant.center_mm;
    assert!((x - 14.0).abs() < 1e-6, "{x}");
}

#[test]
fn a_slider_responds_to_the_keys_of_its_role() {
    let mut harness = app(DESKTOP, |_| {});
    let pocket =
        |harness: &Harness<'static, App>| harness.state().session().scene().pocket_radius_mm;
    harness.get_by_role_and_label(Role::Slider, "Margin (cm)").focus();
    harness.run();
    for (key, value) in [
        (egui::Key::ArrowRight, 71.0),
        (egui::Key::ArrowDown, 70.0),
        (egui::Key::PageUp, 80.0),
        (egui::Key::PageDown, 70.0),
        (egui::Key::End, 95.0),
        (egui::Key::Home, 55.0),
    ] {
        harness.key_press(key);
        settle(&mut harness);
        assert!((pocket(&harness) - value).abs() < 1e-9, "{key:?}: {}", pocket(&harness));
    }
    // A value between two steps moves to the next step.
    type_into(&mut harness, "Margin (cm)", "1.142");
    harness.get_by_role_and_label(Role::Slider, "Margin (cm)").focus();
    harness.run();
    harness.key_press(egui::Key::ArrowRight);
    settle(&mut harness);
    assert!((pocket(&harness) - 67.0).abs() < 1e-9, "{}", pocket(&harness));
}

#[test]
fn a_kept_plan_is_the_first_plan_of_the_next_start() {
    let mut first = app(DESKTOP, |scene| *scene = flat_plan());
    // The plan of the start is nobody's work.
    assert!(first.state_mut().take_plan_to_store(true).is_none());
    type_into(&mut first, "Volume (ml)", "340");
    press(&mut first, "expander");
    let text = first.state_mut().take_plan_to_store(true).unwrap();
    assert!(first.state_mut().take_plan_to_store(true).is_none());

    let mut second = app(DESKTOP, |scene| *scene = flat_plan());
    second.state_mut().restore_plan(&text);
    settle(&mut second);
    assert_eq!(second.state().session().scene(), first.state().session().scene());
    assert_eq!(second.state().session().counters().solves, 1);
    assert!(!second.state().session().can_undo());
    second.get_by_role_and_label(Role::SpinButton, "Fill (ml)");
    assert!(second.state_mut().take_plan_to_store(true).is_none());
    // A text of nobody is ignored with one line.
    let kept = second.state().session().scene().clone();
    for text in [
        "no plan",
        "{}",
        r#"{"scene":{"insertion":7},"choices":{"device":"implant","follows":"volume"},"cross_section":true}"#,
        r#"{"scene":{"schema":"implant-preview/scene/2","implant":{"base_radius_mm":60}},"choices":{"device":"implant","follows":"volume"},"cross_section":true}"#,
    ] {
        second.state_mut().restore_plan(text);
        second.run();
        second.get_by_label_contains("Note: The kept plan was not read: ");
        assert_eq!(second.state().session().scene(), &kept);
    }
    press(&mut second, "Start over");
    assert_eq!(second.state().session().scene(), &Scene::first_plan());
}

#[test]
fn the_profile_beyond_a_half_sphere_is_no_half_sphere() {
    let mut harness = researching(DESKTOP, |scene| *scene = flat_plan());
    let is_chosen = |harness: &Harness<'static, App>| {
        let chip = harness.get_by_role_and_label(Role::Button, "Half sphere");
        chip.accesskit_node().toggled() == Some(egui::accesskit::Toggled::True)
    };
    for (projection, chosen) in [("6.0", true), ("6.2", true), ("7.3", false), ("5.6", false)] {
        type_into(&mut harness, "Projection (cm)", projection);
        assert_eq!(is_chosen(&harness), chosen, "{projection}");
    }
}

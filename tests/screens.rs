//! The app's screens by accessible name, without a GPU: panels, controls, rejected files, no work without a change.

#![cfg(all(feature = "app", not(target_arch = "wasm32")))]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use eframe::egui::{self, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use implant_preview::app::App;
use implant_preview::curve::{Curve, CurveSpec, Interpolation};
use implant_preview::measure::Status;
use implant_preview::scene::{Scene, Springs, TissueModel};
use implant_preview::session::Counters;

const WIDE: egui::Vec2 = egui::Vec2::new(1280.0, 1600.0);
const PHONE: egui::Vec2 = egui::Vec2::new(390.0, 844.0);

/// The app on a small grid, solved and at rest.
fn app(size: egui::Vec2, change: impl FnOnce(&mut Scene)) -> Harness<'static, App> {
    let mut scene = Scene::default();
    scene.solver.nodes_per_side = 33;
    change(&mut scene);
    let ctx = egui::Context::default();
    let app = App::new(&ctx, None, scene).unwrap();
    let mut harness = Harness::builder()
        .with_size(size)
        .with_max_steps(400)
        .build_ui_state(|ui, app: &mut App| app.show(ui), app);
    // The harness has a context of its own with the app's theme.
    drop(App::new(&harness.ctx, None, Scene::default()));
    settle(&mut harness);
    harness
}

/// Runs until no repaint is requested and no solve is running.
fn settle(harness: &mut Harness<'static, App>) {
    for _ in 0..400 {
        harness.step();
        if !harness.state().session().is_working() {
            break;
        }
    }
    harness.run();
    assert!(!harness.state().session().is_working());
}

/// Focuses the picture, which then receives single keys.
fn focus_picture(harness: &mut Harness<'static, App>) {
    harness.get_by_role_and_label(Role::Canvas, "3-D view").focus();
    harness.run();
}

/// Focuses a field, replaces its text and presses Enter.
fn type_into(harness: &mut Harness<'static, App>, field: &str, text: &str) {
    harness.get_by_role_and_label(Role::SpinButton, field).focus();
    harness.run();
    harness.event(egui::Event::Text(text.to_owned()));
    harness.run();
    harness.key_press(egui::Key::Enter);
    settle(harness);
}

#[test]
fn every_control_and_reading_has_its_name() {
    let harness = app(WIDE, |_| {});
    for slider in [
        "Base radius (mm)",
        "Position across (mm)",
        "Position along (mm)",
        "Pocket radius (mm)",
        "Insertion (%)",
        "Tolerance (% of the base radius)",
    ] {
        harness.get_by_role_and_label(Role::Slider, slider);
    }
    // One control per layer.
    for slider in ["Thickness (mm)", "Poisson ratio"] {
        let count = harness.get_all_by_role_and_label(Role::Slider, slider).count();
        assert_eq!(count, 2, "{slider}");
    }
    for button in [
        "Play",
        "Undo",
        "Redo",
        "Fit",
        "About",
        "Theme",
        "File",
        "Add skin",
        "Add adipose",
        "Move down layer 1",
        "Move up layer 2",
        "Remove layer 2",
    ] {
        harness.get_by_role_and_label(Role::Button, button);
    }
    for reading in [
        "Results",
        "Projection of the skin",
        "Area gained",
        "Pressure, mean",
        "Greatest strain",
        "Greatest stress, skin",
        "Greatest stress, adipose",
        "Area strained above 54 %",
    ] {
        harness.get_by_label(reading);
    }
    harness.get_by_label("Up to date");
}

#[test]
fn a_dragged_slider_changes_the_scene_and_undo_reverts_the_change() {
    let mut harness = app(WIDE, |_| {});
    let before = harness.state().session().scene().clone();
    let solves = harness.state().session().counters().solves;
    let rect = harness.get_by_role_and_label(Role::Slider, "Base radius (mm)").rect();
    // The rail is the left part; the value stands to the right of the rail.
    let y = rect.center().y;
    harness.drag_at(egui::pos2(rect.left() + 0.5 * 150.0, y));
    for share in [0.5, 0.4, 0.3] {
        harness.hover_at(egui::pos2(rect.left() + share * 150.0, y));
        harness.step();
    }
    harness.drop_at(egui::pos2(rect.left() + 0.3 * 150.0, y));
    settle(&mut harness);
    let scene = harness.state().session().scene().clone();
    assert!(scene.implant.base_radius_mm < before.implant.base_radius_mm - 1.0);
    // The hemisphere lock holds.
    assert!((scene.implant.projection_mm - scene.implant.base_radius_mm).abs() < 1e-9);
    assert!(harness.state().session().counters().solves > solves);
    harness.get_by_role_and_label(Role::Button, "Undo").click();
    settle(&mut harness);
    assert_eq!(harness.state().session().scene(), &before);
    assert!(!harness.state().session().can_undo());
}

#[test]
fn keys_step_the_insertion() {
    let mut harness = app(WIDE, |_| {});
    focus_picture(&mut harness);
    harness.key_press(egui::Key::OpenBracket);
    settle(&mut harness);
    assert!((harness.state().session().scene().insertion - 0.98).abs() < 1e-9);
    harness.key_press(egui::Key::CloseBracket);
    settle(&mut harness);
    assert!((harness.state().session().scene().insertion - 1.0).abs() < 1e-9);
}

#[test]
fn each_press_of_a_slow_frame_counts() {
    let mut harness = app(WIDE, |_| {});
    focus_picture(&mut harness);
    for pressed in [true, false, true, false, true, false] {
        harness.input_mut().events.push(egui::Event::Key {
            key: egui::Key::OpenBracket,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: egui::Modifiers::NONE,
        });
    }
    settle(&mut harness);
    assert!((harness.state().session().scene().insertion - 0.94).abs() < 1e-9);
}

#[test]
fn playback_continues_after_an_idle_time_without_a_jump() {
    let insertion = |harness: &Harness<'static, App>| harness.state().session().scene().insertion;
    // The time step of the first frame after five idle seconds.
    let step = |is_rested: bool| {
        let mut harness = app(WIDE, |scene| scene.insertion = 0.5);
        focus_picture(&mut harness);
        harness.key_press(egui::Key::Space);
        let mut time = 100.0;
        while insertion(&harness) < 0.52 || harness.state().session().is_working() {
            time += 0.02;
            harness.input_mut().time = Some(time);
            harness.step();
        }
        let before = insertion(&harness);
        if is_rested {
            harness.state_mut().mark_paused();
        }
        harness.input_mut().time = Some(time + 5.0);
        harness.step();
        insertion(&harness) - before
    };
    assert!((step(false) - 0.04).abs() < 1e-9, "a slow frame's step is {}", step(false));
    let rested = step(true);
    assert!(0.0 < rested && rested < 0.005, "the step after a rest is {rested}");
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
fn the_picture_keeps_its_width_while_panels_are_folded_and_unfolded() {
    let mut harness = app(WIDE, |_| {});
    let picture = |harness: &Harness<'static, App>| {
        harness.get_by_role_and_label(Role::Canvas, "3-D view").rect().x_range()
    };
    let before = picture(&harness);
    for _ in 0..2 {
        harness.get_by_label("Implant").click();
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
fn layers_are_added_exchanged_and_removed() {
    let mut harness = app(WIDE, |_| {});
    let tissues = |harness: &Harness<'static, App>| -> Vec<String> {
        harness.state().session().scene().layers.iter().map(|l| l.tissue.clone()).collect()
    };
    harness.get_by_role_and_label(Role::Button, "Move down layer 1").click();
    settle(&mut harness);
    assert_eq!(tissues(&harness), ["adipose", "skin"]);
    harness.get_by_role_and_label(Role::Button, "Add adipose").click();
    settle(&mut harness);
    assert_eq!(tissues(&harness), ["adipose", "skin", "adipose"]);
    harness.get_by_role_and_label(Role::Button, "Remove layer 1").click();
    settle(&mut harness);
    assert_eq!(tissues(&harness), ["skin", "adipose"]);
    assert_eq!(harness.state().outcome().unwrap().layers.len(), 2);
}

#[test]
fn the_tissue_model_is_chosen_and_layered_tissue_adds_its_controls_and_readings() {
    let mut harness = app(WIDE, |_| {});
    let force = |harness: &Harness<'static, App>| {
        harness.state().outcome().unwrap().contact_force_n.unwrap()
    };
    let choose = |harness: &mut Harness<'static, App>, model: &'static str| {
        harness.get_by_role_and_label(Role::ComboBox, "Tissue model").click();
        harness.run();
        harness.get_by_label(model).click();
        settle(harness);
    };
    assert!(harness.state().session().scene().is_layered());
    let layered = force(&harness);
    choose(&mut harness, "One sheet");
    assert!(harness.query_by_label("Cover over the apex").is_none());
    let sheet = force(&harness);
    // A sheet is more than twice as stiff.
    assert!(layered < 0.5 * sheet, "{layered} of {sheet}");
    choose(&mut harness, "Skin on solid layers");
    assert!(harness.state().session().scene().is_layered());
    assert!((force(&harness) - layered).abs() < 1e-9);
    for name in ["Cover over the apex", "Least cover", "Pull at the pocket's edge"] {
        assert!(harness.query_by_label(name).is_some(), "{name}");
    }
    let stiffness = "Attachment stiffness (kPa/mm)";
    for name in ["Computed radius (mm)", stiffness, "Attachment ramp (mm)"] {
        assert!(harness.query_by_role_and_label(Role::Slider, name).is_some(), "{name}");
    }
    type_into(&mut harness, stiffness, "5");
    let attachment = harness.state().session().scene().body.unwrap().attachment;
    assert!((attachment.stiffness_kpa_per_mm - 5.0).abs() < 1e-12);
    choose(&mut harness, "One sheet");
    assert!((force(&harness) - sheet).abs() < 1e-9);
    assert!(harness.query_by_role_and_label(Role::Slider, stiffness).is_none());
}

#[test]
fn the_papers_springs_are_chosen_with_their_tissue_model_in_one_step() {
    let mut harness = app(WIDE, |_| {});
    let scene = |harness: &Harness<'static, App>| harness.state().session().scene().clone();
    let before = scene(&harness);
    harness.get_by_role_and_label(Role::ComboBox, "Springs").click();
    harness.run();
    harness.get_by_label("Nikolaev 2013, in one sheet").click();
    settle(&mut harness);
    assert_eq!((scene(&harness).springs, scene(&harness).is_layered()), (Springs::Nikolaev, false));
    // The other model has the coupled springs.
    harness.get_by_role_and_label(Role::ComboBox, "Tissue model").click();
    harness.run();
    harness.get_by_label("Skin on solid layers").click();
    settle(&mut harness);
    assert_eq!(scene(&harness), before);
    for is_layered in [false, true] {
        harness.get_by_role_and_label(Role::Button, "Undo").click();
        settle(&mut harness);
        assert_eq!(scene(&harness).is_layered(), is_layered);
    }
    assert!(!harness.state().session().can_undo());
}

#[test]
fn the_default_scene_of_the_menu_is_layered_tissue() {
    let mut harness = app(WIDE, |scene| scene.set_tissue_model(TissueModel::Sheet));
    harness.get_by_role_and_label(Role::Button, "File").click();
    harness.run();
    harness.get_by_label("Default scene").click();
    settle(&mut harness);
    assert_eq!(harness.state().session().scene(), &Scene::default());
}

#[test]
fn the_computed_radius_follows_the_pocket_until_set() {
    let mut harness = app(WIDE, |_| {});
    let patch = |harness: &Harness<'static, App>| {
        harness.state().session().scene().body.unwrap().patch_radius_mm
    };
    type_into(&mut harness, "Pocket radius (mm)", "80");
    assert!((patch(&harness) - 140.0).abs() < 1e-9);
    type_into(&mut harness, "Computed radius (mm)", "120");
    type_into(&mut harness, "Pocket radius (mm)", "70");
    assert!((patch(&harness) - 120.0).abs() < 1e-9);
}

#[test]
fn an_idle_app_solves_nothing_and_requests_no_repaint() {
    let mut harness = app(WIDE, |_| {});
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
fn a_colour_the_section_and_the_theme_solve_nothing() {
    let mut harness = app(WIDE, |_| {});
    let counters = harness.state().session().counters();
    focus_picture(&mut harness);
    for key in [egui::Key::Num1, egui::Key::Num3, egui::Key::Num5] {
        harness.key_press(key);
        harness.step();
    }
    harness.get_by_label("Section").click();
    harness.get_by_label("Net").click();
    harness.run();
    // Drawing computes fields; all other counters are unchanged.
    let drawn = harness.state().session().counters();
    assert_eq!(Counters { fields: counters.fields, ..drawn }, counters);
    assert_eq!(drawn.fields - counters.fields, 2);
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
fn springs_without_a_stable_shape_are_reported_and_coupled_springs_offered() {
    let mut harness = app(WIDE, |scene| {
        scene.set_springs(Springs::Nikolaev);
        scene.layers = vec![implant_preview::scene::Layer::adipose()];
    });
    assert_eq!(harness.state().outcome().unwrap().status, Status::Unstable);
    assert!(harness.get_all_by_label("No stable shape").count() > 0);
    harness.get_by_role_and_label(Role::Button, "Use the coupled springs").click();
    settle(&mut harness);
    assert_eq!(harness.state().session().scene().springs, Springs::Coupled);
    assert_eq!(harness.state().outcome().unwrap().status, Status::Converged);
}

#[test]
fn the_papers_springs_are_marked_before_the_solve() {
    // The first frame of a fine grid is drawn before the solve ends.
    let mut scene = Scene { springs: Springs::Nikolaev, ..Scene::sheet() };
    scene.solver.nodes_per_side = 1025;
    let app = App::new(&egui::Context::default(), None, scene).unwrap();
    let mut harness = Harness::builder()
        .with_size(WIDE)
        .with_max_steps(1)
        .build_ui_state(|ui, app: &mut App| app.show(ui), app);
    assert!(harness.state().session().is_working(), "solved already: the test shows nothing");
    harness.get_by_label("Springs unstable, first at 23 % strain");
    harness.get_by_label("Uniaxial stretch: unstable at 23–42 %");
    harness.get_by_label("Equibiaxial stretch: unstable at 33–41 %");
    harness.get_by_role_and_label(Role::Button, "Switch to coupled springs").click();
    for _ in 0..4 {
        harness.step();
    }
    assert_eq!(harness.state().session().scene().springs, Springs::Coupled);
    assert_eq!(harness.query_all_by_label_contains("Springs unstable").count(), 0);
}

#[test]
fn the_mark_of_the_papers_springs_is_computed_once_per_stack_of_layers() {
    let mut harness = app(WIDE, |scene| scene.set_springs(Springs::Nikolaev));
    let asked =
        |harness: &Harness<'static, App>| harness.state().session().counters().stability_limits;
    assert_eq!(asked(&harness), 1);
    focus_picture(&mut harness);
    harness.key_press(egui::Key::OpenBracket);
    settle(&mut harness);
    assert_eq!(asked(&harness), 1);
    harness.get_by_role_and_label(Role::Button, "Remove layer 1").click();
    settle(&mut harness);
    assert_eq!(asked(&harness), 2);
    harness.get_by_label("Uniaxial stretch: unstable from 11 %");
}

#[test]
fn layers_that_stay_stable_under_the_papers_springs_are_reported() {
    let harness = app(WIDE, |scene| {
        scene.set_springs(Springs::Nikolaev);
        scene.insertion = 0.2;
        scene.layers.truncate(1);
        scene.layers[0].poisson_ratio = 0.3;
    });
    harness.get_by_label_contains("stable at all strains up to 100 %");
    let offers = harness.query_all_by_label("Switch to coupled springs");
    assert_eq!(offers.count(), 0);
}

#[test]
fn on_a_phone_the_panels_are_tabs_and_the_picture_keeps_half() {
    let mut harness = app(PHONE, |_| {});
    harness.get_by_role_and_label(Role::Slider, "Insertion (%)");
    let tab = |harness: &Harness<'static, App>, name: &'static str| {
        harness.get_by_role_and_label(Role::Button, name).click();
    };
    let top = harness.get_by_role_and_label(Role::Button, "Results").rect().top();
    assert!(top > 0.5 * PHONE.y, "the sheet starts at {top}");
    tab(&harness, "Results");
    harness.run();
    harness.get_by_label("Area gained");
    tab(&harness, "Tissue");
    harness.run();
    harness.get_by_role_and_label(Role::Button, "Add skin");
    tab(&harness, "Plots");
    harness.run();
    harness.get_by_label_contains("Cross-section");
}

#[test]
fn the_summary_describes_the_picture() {
    let harness = app(WIDE, |_| {});
    let summary = harness.state().summary();
    assert!(summary.starts_with("Up to date. Skin projection 62."), "{summary}");
    assert!(summary.contains("mmHg"), "{summary}");
    let stats = harness.state().stats();
    assert!(stats.converged && stats.frames > 0 && stats.solves == 1 && stats.work_units > 0.0);
}

#[test]
fn the_last_point_of_a_measured_curve_can_be_entered() {
    let mut harness = app(WIDE, |scene| {
        scene.layers[0].curve = CurveSpec::Points {
            points: vec![[0.0, 0.0], [0.4, 100.0], [1.0, 500.0]],
            interpolation: Interpolation::Line,
        }
        .into();
    });
    let points = |harness: &Harness<'static, App>| match &harness.state().session().scene().layers
        [0]
    .curve
    .spec
    {
        CurveSpec::Points { points, .. } => points.clone(),
        other => panic!("{other:?}"),
    };
    type_into(&mut harness, "Strain of point 3", "0,5");
    assert_eq!(points(&harness), [[0.0, 0.0], [0.4, 100.0], [0.5, 500.0]]);
    type_into(&mut harness, "Stress of point 3", "220");
    assert_eq!(points(&harness), [[0.0, 0.0], [0.4, 100.0], [0.5, 220.0]]);
    // Points out of order are reported; nothing is stored or clamped.
    type_into(&mut harness, "Stress of point 3", "90");
    harness.get_by_label_contains("must be greater than that of point 2 (100 kPa)");
    assert_eq!(points(&harness), [[0.0, 0.0], [0.4, 100.0], [0.5, 220.0]]);
    // The points of such a table can be corrected in any sequence.
    type_into(&mut harness, "Stress of point 2", "50");
    assert_eq!(points(&harness), [[0.0, 0.0], [0.4, 50.0], [0.5, 90.0]]);
}

#[test]
fn choosing_measured_points_moves_no_point_of_a_preset() {
    let mut harness = app(WIDE, |_| {});
    harness
        .get_all_by_role_and_label(Role::ComboBox, "Stress–strain curve")
        .next()
        .unwrap()
        .click();
    harness.run();
    harness.get_by_label("Measured points").click();
    settle(&mut harness);
    (0..5).for_each(|_| harness.step());
    let CurveSpec::Points { points, .. } = &harness.state().session().scene().layers[0].curve.spec
    else {
        panic!("no points")
    };
    let skin = Curve::new(&CurveSpec::Skin {}).unwrap();
    // The points include every strain where the preset changes its form.
    assert_eq!(points.len(), 7);
    for [strain, stress] in points {
        assert_eq!(stress.to_bits(), skin.stress(*strain).to_bits(), "at {strain}");
    }
}

#[test]
fn typed_numbers_are_stored_exactly_or_rejected_with_a_message() {
    let mut harness = app(WIDE, |_| {});
    let radius =
        |harness: &Harness<'static, App>| harness.state().session().scene().implant.base_radius_mm;
    let field = "Base radius (mm)";
    for (text, value) in [
        ("39.8", 39.8),
        ("46.4", 46.4),
        ("46.42", 46.42),
        ("4,5 cm", 45.0),
        ("45 mm", 45.0),
        ("4.5cm", 45.0),
        ("50,5", 50.5),
    ] {
        type_into(&mut harness, field, text);
        assert_eq!(radius(&harness).to_bits(), f64::to_bits(value), "{text}");
    }
    for (text, reason) in [
        ("-5", "Not accepted: at least 10 mm"),
        ("500", "Not accepted: at most 120 mm"),
        ("abc", "Not accepted: “abc” is not a number"),
    ] {
        type_into(&mut harness, field, text);
        harness.get_by_label(reason);
        assert_eq!(radius(&harness).to_bits(), f64::to_bits(50.5), "{text}");
    }
    // Escape restores the value and removes the message.
    harness.key_press(egui::Key::Escape);
    harness.run();
    assert_eq!(harness.query_all_by_label_contains("Not accepted").count(), 0);
    // Enter keeps the focus.
    type_into(&mut harness, field, "40");
    assert!(harness.get_by_role_and_label(Role::SpinButton, field).is_focused());
}

#[test]
fn digits_change_the_colouring_only_with_the_focus_on_the_picture() {
    let mut harness = app(WIDE, |_| {});
    let drawn = |harness: &Harness<'static, App>| harness.state().session().counters().fields;
    let before = drawn(&harness);
    for key in [egui::Key::Num5, egui::Key::Num0, egui::Key::Num3] {
        harness.key_press(key);
        harness.run();
    }
    harness.key_press(egui::Key::OpenBracket);
    settle(&mut harness);
    assert_eq!(drawn(&harness), before);
    assert!((harness.state().session().scene().insertion - 1.0).abs() < 1e-12);
}

#[test]
fn a_shifted_implant_stays_in_its_pocket_and_a_larger_pocket_is_offered() {
    let mut harness = app(WIDE, |_| {});
    let scene = |harness: &Harness<'static, App>| harness.state().session().scene().clone();
    let before = scene(&harness);
    type_into(&mut harness, "Position across (mm)", "25");
    harness.get_by_label("Not accepted: at most 15 mm in this pocket");
    assert_eq!(scene(&harness), before);
    let offer = "Enlarge the pocket to a radius of 80 mm";
    harness.get_by_role_and_label(Role::Button, offer).click();
    settle(&mut harness);
    assert_eq!(
        (scene(&harness).pocket_radius_mm, scene(&harness).implant.center_mm),
        (80.0, [25.0, 0.0])
    );
    // A drag stops at the pocket's rim with a message.
    harness.state_mut().open(before.to_json()).unwrap();
    settle(&mut harness);
    let rect = harness.get_by_role_and_label(Role::Slider, "Position across (mm)").rect();
    harness.drag_at(rect.center());
    harness.hover_at(rect.right_center() - egui::vec2(10.0, 0.0));
    harness.step();
    harness.drop_at(rect.right_center() - egui::vec2(10.0, 0.0));
    settle(&mut harness);
    assert_eq!(
        (scene(&harness).pocket_radius_mm, scene(&harness).implant.center_mm),
        (70.0, [15.0, 0.0])
    );
    harness.get_by_label_contains("at most 15 mm in this pocket");
}

#[test]
fn a_slider_responds_to_the_keys_of_its_role() {
    let mut harness = app(WIDE, |_| {});
    let pocket =
        |harness: &Harness<'static, App>| harness.state().session().scene().pocket_radius_mm;
    harness.get_by_role_and_label(Role::Slider, "Pocket radius (mm)").focus();
    harness.run();
    for (key, value) in [
        (egui::Key::ArrowRight, 70.5),
        (egui::Key::ArrowDown, 70.0),
        (egui::Key::PageUp, 75.0),
        (egui::Key::PageDown, 70.0),
        (egui::Key::End, 200.0),
        // The least radius of a pocket for the implant.
        (egui::Key::Home, 55.0),
    ] {
        harness.key_press(key);
        settle(&mut harness);
        assert!((pocket(&harness) - value).abs() < 1e-9, "{key:?}: {}", pocket(&harness));
    }
    // A value between two steps moves to the next step.
    type_into(&mut harness, "Pocket radius (mm)", "66.42");
    harness.get_by_role_and_label(Role::Slider, "Pocket radius (mm)").focus();
    harness.run();
    harness.key_press(egui::Key::ArrowRight);
    settle(&mut harness);
    assert!((pocket(&harness) - 66.5).abs() < 1e-9, "{}", pocket(&harness));
}

/// A touch of one finger: start and path.
fn swipe(harness: &mut Harness<'static, App>, from: egui::Pos2, travel: egui::Vec2) {
    let touch = |phase, pos| egui::Event::Touch {
        device_id: egui::TouchDeviceId(0),
        id: egui::TouchId(1),
        phase,
        pos,
        force: None,
    };
    let press = |pos, pressed| egui::Event::PointerButton {
        pos,
        button: egui::PointerButton::Primary,
        pressed,
        modifiers: egui::Modifiers::NONE,
    };
    // The page sends the events of a mouse with every touch.
    let events = &mut harness.input_mut().events;
    events.extend([press(from, true), touch(egui::TouchPhase::Start, from)]);
    harness.step();
    // A tap is down and up within a frame.
    let is_tap = travel == egui::Vec2::ZERO;
    if !is_tap {
        harness.step();
    }
    for k in 1..=if is_tap { 0 } else { 10 } {
        let at = from + travel * (k as f32 / 10.0);
        let events = &mut harness.input_mut().events;
        events.extend([egui::Event::PointerMoved(at), touch(egui::TouchPhase::Move, at)]);
        harness.step();
    }
    let at = from + travel;
    let events = &mut harness.input_mut().events;
    events.extend([press(at, false), egui::Event::PointerGone, touch(egui::TouchPhase::End, at)]);
    settle(harness);
}

#[test]
fn a_swipe_across_a_slider_scrolls_and_one_along_it_moves_the_handle() {
    let mut harness = app(PHONE, |_| {});
    let scene = |harness: &Harness<'static, App>| harness.state().session().scene().clone();
    let before = scene(&harness);
    let slider = |harness: &Harness<'static, App>| {
        harness.get_by_role_and_label(Role::Slider, "Base radius (mm)").rect()
    };
    // A slider with the focus behaves equally.
    harness.get_by_role_and_label(Role::Slider, "Base radius (mm)").focus();
    harness.run();
    let at = slider(&harness);
    let away_from_the_handle = at.left_center() + egui::vec2(0.85 * at.width(), 0.0);
    swipe(&mut harness, away_from_the_handle, egui::vec2(3.0, -90.0));
    assert_eq!(scene(&harness), before, "a swipe across the slider moved it");
    let moved = at.center().y - slider(&harness).center().y;
    assert!(moved > 40.0, "the panel was scrolled by {moved}");
    swipe(&mut harness, away_from_the_handle, egui::vec2(3.0, 120.0));
    // A tap beside the handle does not move the handle.
    let at = slider(&harness);
    let away_from_the_handle = at.left_center() + egui::vec2(0.85 * at.width(), 0.0);
    swipe(&mut harness, away_from_the_handle, egui::Vec2::ZERO);
    assert_eq!(scene(&harness), before, "a tap beside the handle moved it");
    swipe(&mut harness, away_from_the_handle, egui::vec2(-40.0, 2.0));
    let (radius, was) = (scene(&harness).implant.base_radius_mm, before.implant.base_radius_mm);
    assert!(radius < was - 5.0, "a swipe along the slider left it at {radius}");
}

#[test]
fn a_tap_on_the_picture_shows_values_until_the_next() {
    let mut harness = app(PHONE, |_| {});
    let picture = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
    let boxes = |harness: &Harness<'static, App>| {
        let texts = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
            egui::Shape::Text(text) => Some(text.galley.text().to_owned()),
            _ => None,
        });
        texts.filter(|text| text.starts_with("Strain ") || text.starts_with("Outside ")).count()
    };
    assert_eq!(boxes(&harness), 0);
    let at = picture.left_center() + egui::vec2(0.35 * picture.width(), 0.0);
    swipe(&mut harness, at, egui::Vec2::ZERO);
    harness.step();
    assert_eq!(boxes(&harness), 1);
    // A second tap at the same position hides the values.
    swipe(&mut harness, at, egui::Vec2::ZERO);
    harness.step();
    assert_eq!(boxes(&harness), 0);
}

#[test]
fn the_tab_key_goes_through_all_controls_and_back() {
    let mut harness = app(WIDE, |_| {});
    let mut ways = Vec::new();
    for modifiers in [egui::Modifiers::NONE, egui::Modifiers::SHIFT] {
        let mut seen = Vec::new();
        for _ in 0..120 {
            harness.key_press_modifiers(modifiers, egui::Key::Tab);
            harness.run();
            let focused = harness.ctx.memory(egui::Memory::focused);
            assert!(focused.is_some(), "the focus is lost after {} controls", seen.len());
            if seen.first() == focused.as_ref() {
                break;
            }
            assert!(!focused.is_some_and(|id| seen.contains(&id)), "a circle after {}", seen.len());
            seen.extend(focused);
        }
        ways.push(seen);
    }
    // All sliders with their fields, buttons, boxes and folds, equal in both directions.
    assert!(ways[0].len() > 45, "{} controls", ways[0].len());
    let sorted = |ids: &[egui::Id]| ids.iter().copied().collect::<std::collections::HashSet<_>>();
    assert_eq!(sorted(&ways[0]), sorted(&ways[1]));
}

#[test]
fn a_control_focused_by_a_key_is_scrolled_into_view() {
    for size in [egui::vec2(1000.0, 500.0), egui::vec2(1000.0, 700.0), PHONE] {
        for is_page in [false, true] {
            let mut harness = app(size, |_| {});
            if is_page {
                harness.state_mut().enable_page_navigation();
            }
            for _ in 0..40 {
                harness.key_press(egui::Key::Tab);
                harness.run();
                let Some(id) = harness.ctx.memory(egui::Memory::focused) else { break };
                let response = harness.ctx.read_response(id).unwrap();
                let seen = response.rect.intersect(response.interact_rect);
                let rect = response.rect;
                assert!(
                    seen.height() > 0.9 * rect.height(),
                    "{size} {is_page}: {seen:?} of {rect:?}"
                );
                assert!(rect.bottom() <= size.y, "{size} {is_page}: {rect:?}");
            }
        }
    }
}

#[test]
fn escape_and_a_choice_return_the_focus() {
    let mut harness = app(WIDE, |_| {});
    let about = |harness: &Harness<'static, App>| {
        harness.query_all_by_label("A preview, not a medical device.").count()
    };
    let button = |harness: &Harness<'static, App>| {
        harness.get_by_role_and_label(Role::Button, "About").is_focused()
    };
    harness.get_by_role_and_label(Role::Button, "About").focus();
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.run();
    assert_eq!(about(&harness), 1);
    harness.key_press(egui::Key::Escape);
    harness.run();
    assert_eq!((about(&harness), button(&harness)), (0, true));
    harness.step();
    assert_eq!(harness.state().focused().unwrap().0, "About");
    // Open a box and choose an entry.
    harness.get_by_role_and_label(Role::ComboBox, "Resolution").focus();
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.run();
    harness.key_press(egui::Key::Tab);
    harness.run();
    harness.key_press(egui::Key::Enter);
    settle(&mut harness);
    for _ in 0..3 {
        harness.step();
    }
    assert!(harness.get_by_role_and_label(Role::ComboBox, "Resolution").is_focused());
}

#[test]
fn a_result_is_saved_only_with_its_own_scene() {
    let mut harness = app(WIDE, |scene| scene.solver.nodes_per_side = 33);
    let record: serde_json::Value =
        serde_json::from_str(&harness.state().result_json().unwrap()).unwrap();
    let scene = serde_json::to_value(harness.state().session().scene()).unwrap();
    assert_eq!(record["scene"], scene);
    assert_eq!(record["program_version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(record["status"], "converged");
    let date = record["date"].as_str().unwrap();
    assert!(date.len() == 20 && date.ends_with('Z') && date.starts_with("20"), "{date}");
    // Another scene before the end of its solve has no result to save or to read.
    let mut other = harness.state().session().scene().clone();
    other.set_pocket_radius(178.0);
    harness.state_mut().open(other.to_json()).unwrap();
    let app = harness.state();
    assert!(app.session().is_working());
    assert_eq!((app.result_json(), app.outcome()), (None, None));
    assert_eq!(app.summary(), "Updating.");
    settle(&mut harness);
    let record: serde_json::Value =
        serde_json::from_str(&harness.state().result_json().unwrap()).unwrap();
    assert_eq!(record["scene"]["pocket_radius_mm"], 178.0);
    let area = record["area_before_cm2"].as_f64().unwrap();
    assert!((area - 0.01 * std::f64::consts::PI * 178.0 * 178.0).abs() < 1e-9);
}

#[test]
fn the_state_of_the_solve_is_unobtrusive_and_limits_are_stated() {
    let mut harness = app(WIDE, |scene| {
        scene.set_tissue_model(TissueModel::Sheet);
        scene.insertion = 0.5;
    });
    harness.get_by_label("Up to date");
    let mut scene = harness.state().session().scene().clone();
    // Far beyond the failure strain of skin.
    scene.insertion = 1.0;
    scene.implant.base_radius_mm = 70.0;
    scene.implant.projection_mm = 120.0;
    scene.layers[0].curve = CurveSpec::Points {
        points: vec![[0.0, 0.0], [0.3, 60.0]],
        interpolation: Interpolation::Line,
    }
    .into();
    harness.state_mut().open(scene.to_json()).unwrap();
    settle(&mut harness);
    harness.get_by_label("Up to date");
    harness.get_by_label("beyond what excised skin withstood");
    // Warnings stand beside the numbers.
    let warning = harness
        .get_by_label_contains("skin: strains exceed the data of the stress–strain curve")
        .rect();
    let numbers = harness.get_by_label("Projection of the skin").rect();
    assert!(
        (warning.left() - numbers.left()).abs() < 40.0 && warning.bottom() <= numbers.top() + 1.0
    );
}

#[test]
fn a_long_solve_shows_its_progress_and_can_be_cancelled() {
    let mut harness = app(WIDE, |_| {});
    let before = harness.state().session().scene().clone();
    let mut long = before.clone();
    long.set_springs(Springs::Nikolaev);
    long.solver.nodes_per_side = 513;
    let edit = |harness: &mut Harness<'static, App>, scene: &Scene| {
        harness.state_mut().open(scene.to_json()).unwrap();
        let start = std::time::Instant::now();
        while harness.query_all_by_role_and_label(Role::Button, "Cancel").count() == 0 {
            harness.step();
            assert!(start.elapsed().as_secs() < 60, "no progress is shown");
        }
    };
    edit(&mut harness, &long);
    harness.get_by_role_and_label(Role::ProgressIndicator, "Progress of the solve");
    // The previous figures are removed.
    harness.step();
    assert_eq!(harness.query_all_by_label("Greatest strain").count(), 0);
    harness.get_by_role_and_label(Role::Button, "Cancel").click();
    settle(&mut harness);
    assert_eq!(harness.state().session().scene(), &before);
    assert!(harness.state().outcome().is_some() && harness.state().session().can_redo());
    // Without a previous valid scene the solve stops and can be continued.
    let app = App::new(&egui::Context::default(), None, long.clone()).unwrap();
    let mut harness = Harness::builder()
        .with_size(WIDE)
        .with_max_steps(1)
        .build_ui_state(|ui, app: &mut App| app.show(ui), app);
    edit(&mut harness, &long);
    harness.get_by_role_and_label(Role::Button, "Cancel").click();
    (0..3).for_each(|_| harness.step());
    assert!(!harness.state().session().is_working());
    assert_eq!(harness.state().outcome(), None);
    assert!(harness.state().summary().starts_with("Stopped"));
    harness.get_by_role_and_label(Role::Button, "Continue computing").click();
    (0..3).for_each(|_| harness.step());
    assert!(harness.state().session().is_working());
}

//! The app's screens by accessible name, without a GPU: every panel is there, a moved control
//! changes the scene, a refused file changes nothing, and at rest nothing happens.

#![cfg(all(feature = "app", not(target_arch = "wasm32")))]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use eframe::egui::{self, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use implant_preview::app::App;
use implant_preview::measure::Status;
use implant_preview::scene::{Scene, Springs};
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
    settle(&mut harness);
    harness
}

/// Runs until no repaint is asked for and nothing is left to solve.
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
    // One for each layer.
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
    harness.get_by_label_contains("Converged");
}

#[test]
fn a_dragged_slider_changes_the_scene_and_undo_takes_it_back() {
    let mut harness = app(WIDE, |_| {});
    let before = harness.state().session().scene().clone();
    let solves = harness.state().session().counters().solves;
    let rect = harness.get_by_role_and_label(Role::Slider, "Base radius (mm)").rect();
    // The rail is the left part; the value stands right of it.
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
fn play_goes_on_after_a_rest_without_a_jump() {
    let insertion = |harness: &Harness<'static, App>| harness.state().session().scene().insertion;
    // The step of the first frame after five seconds without any.
    let step = |is_rested: bool| {
        let mut harness = app(WIDE, |scene| scene.insertion = 0.5);
        harness.key_press(egui::Key::Space);
        let mut time = 100.0;
        while insertion(&harness) < 0.52 || harness.state().session().is_working() {
            time += 0.02;
            harness.input_mut().time = Some(time);
            harness.step();
        }
        let before = insertion(&harness);
        if is_rested {
            harness.state_mut().rested();
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
fn a_message_is_there_until_it_is_closed() {
    let mut harness = app(WIDE, |_| {});
    harness.state_mut().tell("This is the scene that was open.");
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
fn a_long_name_does_not_take_the_place_of_the_picture() {
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
fn at_rest_nothing_is_solved_and_no_repaint_is_asked_for() {
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
    for key in [egui::Key::Num1, egui::Key::Num3, egui::Key::Num5] {
        harness.key_press(key);
        harness.step();
    }
    harness.get_by_label("Section").click();
    harness.get_by_label("Net").click();
    harness.run();
    // Drawing costs fields and meshes; all else is as before.
    let drawn = harness.state().session().counters();
    assert_eq!(Counters { fields: counters.fields, meshes: counters.meshes, ..drawn }, counters);
    assert_eq!(drawn.fields - counters.fields, 2);
}

#[test]
fn a_refused_scene_changes_nothing_and_says_why() {
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
fn springs_without_a_stable_shape_are_said_so_and_coupled_ones_offered() {
    let mut harness = app(WIDE, |scene| {
        scene.springs = Springs::Nikolaev;
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
fn the_papers_springs_are_marked_before_they_are_solved() {
    // A grid too fine for the first frame: nothing is solved when it is drawn.
    let mut scene = Scene { springs: Springs::Nikolaev, ..Scene::default() };
    scene.solver.nodes_per_side = 1025;
    let app = App::new(&egui::Context::default(), None, scene).unwrap();
    let mut harness = Harness::builder()
        .with_size(WIDE)
        .with_max_steps(1)
        .build_ui_state(|ui, app: &mut App| app.show(ui), app);
    assert!(harness.state().session().is_working(), "solved already: the test shows nothing");
    harness.get_by_label("No stable even shape, first at 23 % strain");
    harness.get_by_label("Stretched one way: no stable shape at 23–42 %");
    harness.get_by_label("Stretched both ways: no stable shape at 33–41 %");
    harness.get_by_role_and_label(Role::Button, "Switch to coupled springs").click();
    for _ in 0..4 {
        harness.step();
    }
    assert_eq!(harness.state().session().scene().springs, Springs::Coupled);
    assert_eq!(harness.query_all_by_label_contains("No stable even shape").count(), 0);
}

#[test]
fn the_mark_at_the_papers_springs_is_found_once_for_each_stack_of_layers() {
    let mut harness = app(WIDE, |scene| scene.springs = Springs::Nikolaev);
    let asked =
        |harness: &Harness<'static, App>| harness.state().session().counters().stability_limits;
    assert_eq!(asked(&harness), 1);
    harness.key_press(egui::Key::OpenBracket);
    settle(&mut harness);
    assert_eq!(asked(&harness), 1);
    harness.get_by_role_and_label(Role::Button, "Remove layer 1").click();
    settle(&mut harness);
    assert_eq!(asked(&harness), 2);
    harness.get_by_label("Stretched one way: no stable shape from 11 % on");
}

#[test]
fn layers_that_stay_stable_under_the_papers_springs_are_said_so() {
    let harness = app(WIDE, |scene| {
        scene.springs = Springs::Nikolaev;
        scene.insertion = 0.2;
        scene.layers.truncate(1);
        scene.layers[0].poisson_ratio = 0.3;
    });
    harness.get_by_label_contains("stable at every strain to 100 %");
    let offers = harness.query_all_by_label("Switch to coupled springs");
    assert_eq!(offers.count(), 0);
}

#[test]
fn on_a_phone_the_panels_are_a_sheet_and_the_picture_keeps_half() {
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
fn the_summary_says_what_the_picture_shows() {
    let harness = app(WIDE, |_| {});
    let summary = harness.state().summary();
    assert!(summary.starts_with("Converged. Skin projection 62."), "{summary}");
    assert!(summary.contains("mmHg"), "{summary}");
    let stats = harness.state().stats();
    assert!(stats.converged && stats.frames > 0 && stats.solves == 1 && stats.work_units > 0.0);
}

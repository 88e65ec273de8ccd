//! The range of implants by accessible name, without a GPU: filling, values, taking an implant, edits, axes, phone.

#![cfg(all(feature = "app", not(target_arch = "wasm32")))]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

#[path = "common/window.rs"]
mod window;

use eframe::egui::{self, Pos2, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use implant_preview::app::App;
use implant_preview::clinical::{Shelf, Size};
use implant_preview::platform::desktop::beside_window;
use implant_preview::scene::{Scene, TissueModel};
use implant_preview::study::{Axis, Case, Job, Map, MapSettings, Quantity, evaluate};
use std::time::{Duration, Instant};
use window::{flat_plan, window};

#[path = "range/shelf.rs"]
mod shelf;

const DESKTOP: egui::Vec2 = egui::Vec2::new(1440.0, 900.0);
const PHONE: egui::Vec2 = egui::Vec2::new(390.0, 844.0);
const CHART: &str = "Range of implants, chart";
/// Columns and rows of the first chart: width from 10 to 14 cm, projection from 2 to 6 cm, in steps of 2.5 mm.
const POINTS: (usize, usize) = (17, 17);

fn sheet() -> Scene {
    let mut scene = flat_plan();
    scene.set_tissue_model(TissueModel::Sheet);
    scene
}

fn layered() -> Scene {
    let mut scene = flat_plan();
    scene.solver.nodes_per_side = 17;
    scene
}

/// The app with the switch "Research", solved, with the range open.
fn range_of(scene: Scene, size: egui::Vec2) -> Harness<'static, App> {
    let mut app = App::new(&egui::Context::default(), None, scene, beside_window).unwrap();
    app.restore_research(Some("on"));
    let mut harness = window(size, 400, app);
    settle(&mut harness);
    open_range(&mut harness, size);
    harness
}

fn open_range(harness: &mut Harness<'static, App>, size: egui::Vec2) {
    if size == PHONE {
        harness.get_by_role_and_label(Role::Button, "View").click();
        harness.run_steps(2);
    }
    harness.get_by_role_and_label(Role::Button, "Range of implants").click();
    harness.step();
    harness.step();
}

/// Runs until no solve of the app is running.
fn settle(harness: &mut Harness<'static, App>) {
    harness.step();
    while harness.state().session().is_working() {
        harness.step();
    }
    harness.step();
}

/// Draws the requested frames until a label contains these words. A finished job requests a frame.
fn wait_for(harness: &mut Harness<'static, App>, words: &str) {
    let start = Instant::now();
    while harness.query_all_by_label_contains(words).count() == 0 {
        assert!(start.elapsed() < Duration::from_secs(240), "no label contains {words:?}");
        if harness.ctx.has_requested_repaint() {
            harness.step();
        } else {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

/// The place on the screen of a point of the first chart.
fn place(harness: &Harness<'static, App>, i: usize, j: usize) -> Pos2 {
    let rect = harness.get_by_role_and_label(Role::Canvas, CHART).rect();
    let part = |k: usize, count: usize| k as f32 / (count - 1) as f32;
    egui::pos2(
        rect.left() + rect.width() * part(i, POINTS.0),
        rect.bottom() - rect.height() * part(j, POINTS.1),
    )
}

fn click(harness: &mut Harness<'static, App>, at: Pos2) {
    harness.drag_at(at);
    harness.step();
    harness.drop_at(at);
    harness.step();
    settle(harness);
}

/// The words of the chart for screen readers.
fn words(harness: &Harness<'static, App>) -> String {
    harness.get_by_role_and_label(Role::Canvas, CHART).value().unwrap()
}

fn choose(harness: &mut Harness<'static, App>, list: &str, name: &str) {
    harness.get_by_role_and_label(Role::ComboBox, list).click();
    harness.run_steps(2);
    // A long list is scrolled.
    harness.get_by_role_and_label(Role::Button, name).scroll_to_me();
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::Button, name).click();
    harness.run_steps(3);
}

fn type_into(harness: &mut Harness<'static, App>, field: &str, text: &str) {
    harness.get_by_role_and_label(Role::SpinButton, field).focus();
    harness.run_steps(2);
    harness.event(egui::Event::Text(text.to_owned()));
    harness.run_steps(2);
    harness.key_press(egui::Key::Enter);
    harness.run_steps(2);
    settle(harness);
}

/// The case of a point of the first chart around a scene.
fn case(scene: &Scene, i: usize, j: usize) -> Case {
    let axes = ["base_width_mm=100:140:17", "projection_mm=20:60:17"];
    let axes = axes.map(|axis| Axis::parse(axis).unwrap());
    let map = Map::new(scene, &axes, MapSettings::default()).unwrap();
    let scenes = vec![map.scene(i, j).unwrap()];
    evaluate(&Job { scenes, ..Job::default() }).swap_remove(0)
}

#[test]
fn the_range_fills_and_is_compared_with_the_fine_grid() {
    let mut harness = range_of(sheet(), DESKTOP);
    let solves = harness.state().session().counters().solves;
    harness.get_by_label_contains(" of 289 plans computed.");
    assert_eq!(harness.query_all_by_role_and_label(Role::Canvas, "3-D view").count(), 0);
    wait_for(&mut harness, "A quick, coarse computation");
    wait_for(&mut harness, "A quick, coarse computation, within ");
    harness.get_by_label_contains(" of a fine one.");
    // The app's own solver has nothing to do, and the complete chart is at rest.
    assert_eq!(harness.state().session().counters().solves, solves);
    harness.run();
    harness.get_by_role_and_label(Role::Button, "Save chart");
    harness.get_by_role_and_label(Role::Button, "Picture").click();
    harness.run();
    harness.get_by_role_and_label(Role::Canvas, "3-D view");
}

#[test]
fn until_practice_is_known_the_chart_is_without_words_and_numbers_and_says_so() {
    let mut harness = range_of(layered(), DESKTOP);
    let numbers_and_words = |harness: &Harness<'static, App>| {
        let chart = harness.get_by_label(CHART).rect();
        let end = harness.get_by_label("What happens").rect().left();
        let texts = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
            egui::Shape::Text(text) => {
                Some((text.galley.text().to_owned(), text.visual_bounding_rect()))
            }
            _ => None,
        });
        let beside = texts.filter(|(_, rect)| {
            let is_beside = rect.left() > chart.right() && rect.right() < end;
            is_beside && chart.y_range().contains(rect.center().y)
        });
        beside.map(|(text, _)| text).collect::<Vec<_>>()
    };
    // The chart says so, the status line too once the plan is solved.
    let is_comparing = |harness: &Harness<'static, App>| {
        harness.query_all_by_label_contains("Comparing with practice…").next().is_some()
    };
    assert!(is_comparing(&harness));
    let legend = |text: &String| text.contains("practice") || text.parse::<f64>().is_ok();
    assert!(!numbers_and_words(&harness).iter().any(legend), "{:?}", numbers_and_words(&harness));
    wait_for(&mut harness, "plans computed");
    while is_comparing(&harness) {
        harness.step();
    }
    for _ in 0..200 {
        harness.step();
        std::thread::sleep(Duration::from_millis(5));
    }
    assert!(numbers_and_words(&harness).iter().any(legend));
}

#[test]
fn the_progress_goes_when_the_chart_is_computed_and_nothing_moves() {
    for size in [DESKTOP, PHONE] {
        let mut app = App::new(&egui::Context::default(), None, sheet(), beside_window).unwrap();
        let shelf = Shelf::from_csv("Name;Width (cm);Projection (cm)\nMM-240;11.5;3.9").unwrap();
        app.restore_shelf(&shelf.to_csv());
        let mut harness = window(size, 400, app);
        settle(&mut harness);
        open_range(&mut harness, size);
        let chart = |harness: &Harness<'static, App>| {
            harness.get_by_role_and_label(Role::Canvas, CHART).rect()
        };
        // The longest words of a phone.
        wait_for(&mut harness, " of 289 plans computed. The pocket keeps its margin. White dots");
        harness.run_steps(3);
        let before = chart(&harness);
        let start = Instant::now();
        while harness.query_by_label_contains(" plans computed.").is_some() {
            assert!(start.elapsed() < Duration::from_secs(240), "the chart is not computed");
            harness.step();
            std::thread::sleep(Duration::from_millis(5));
        }
        assert_eq!(chart(&harness), before);
    }
}

#[test]
fn volume_lines_stand_out_in_both_themes() {
    let mut harness = range_of(sheet(), DESKTOP);
    wait_for(&mut harness, "A quick, coarse computation");
    for theme in [egui::Theme::Light, egui::Theme::Dark] {
        harness.ctx.set_theme(theme);
        harness.run_steps(3);
        let chart = harness.get_by_role_and_label(Role::Canvas, CHART).rect();
        // Of all lines in the chart only those of the volumes are segments, each with its halo.
        let strokes = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
            egui::Shape::LineSegment { points, stroke } => {
                points.iter().all(|point| chart.contains(*point)).then_some(*stroke)
            }
            _ => None,
        });
        let brightness = |color: egui::Color32| {
            let [r, g, b, a] = color.to_srgba_unmultiplied().map(f32::from);
            (a > 100.0).then_some((r + g + b) / 3.0).unwrap()
        };
        let (lines, halos): (Vec<_>, Vec<_>) = strokes.partition(|stroke| stroke.width < 2.0);
        let [line, halo] = [&lines, &halos].map(|strokes| brightness(strokes[0].color));
        assert!((line < halo) == (theme == egui::Theme::Light), "{theme:?}: {line} {halo}");
        assert!((line - halo).abs() > 150.0, "{theme:?}: {line} {halo}");
        assert_eq!(lines.len(), halos.len());
    }
}

#[test]
fn the_values_at_the_pointer_are_those_of_the_case() {
    for (scene, name, word) in
        [(sheet(), "Pressure, greatest", "usual"), (layered(), "Least cover", "below practice")]
    {
        let mut harness = range_of(scene.clone(), DESKTOP);
        // The first of two points is among the first lattices.
        wait_for(&mut harness, " of 289 plans computed.");
        let case = case(&scene, 16, 0);
        let start = Instant::now();
        loop {
            harness.hover_at(place(&harness, 16, 0));
            harness.run_steps(2);
            if words(&harness).contains("Skin stretch: ") && !words(&harness).contains("about") {
                break;
            }
            assert!(start.elapsed() < Duration::from_secs(60), "{}", words(&harness));
            std::thread::sleep(Duration::from_millis(5));
        }
        let strain = case.values.get(Quantity::GreatestStrain).unwrap();
        let place = "Width 14 cm, projection 2 cm: ";
        let expected = format!("{place}Skin stretch: {:.0} percent, {word}; ", 100.0 * strain);
        let found = words(&harness);
        assert!(found.starts_with(&expected) && found.contains(name), "{found}");
        if let Some(cover) = case.values.get(Quantity::LeastCoverMm) {
            assert!(found.contains(&format!("Least cover: {cover:.1} mm")), "{found}");
        }
    }
}

#[test]
fn a_click_and_the_enter_key_take_the_implant_in_one_step() {
    let mut harness = range_of(sheet(), DESKTOP);
    wait_for(&mut harness, "A quick, coarse computation");
    let before = harness.state().session().scene().clone();
    let at = place(&harness, 10, 10);
    click(&mut harness, at);
    let taken = harness.state().session().scene().clone();
    assert_eq!((taken.implant.base_radius_mm, taken.implant.projection_mm), (62.5, 45.0));
    let margin = |scene: &Scene| scene.pocket_radius_mm - scene.implant.base_radius_mm;
    assert!((margin(&taken) - margin(&before)).abs() < 1e-9);
    // The points of the chart are the same: none is computed again.
    harness.get_by_label_contains("289 plans computed. ");
    harness.get_by_label_contains("A quick, coarse computation");
    harness.get_by_role_and_label(Role::Button, "Undo").click();
    settle(&mut harness);
    assert_eq!(harness.state().session().scene(), &before);
    assert!(!harness.state().session().can_undo());
    // Arrows move from the clicked point, the Enter key takes.
    harness.get_by_role_and_label(Role::Canvas, CHART).focus();
    harness.run_steps(2);
    harness.remove_cursor();
    for key in [egui::Key::ArrowRight, egui::Key::ArrowRight, egui::Key::ArrowDown] {
        harness.key_press(key);
        harness.run_steps(2);
    }
    let sentence = words(&harness);
    assert!(sentence.starts_with("Width 13 cm, projection 4.25 cm: Skin stretch: "), "{sentence}");
    assert!(harness.state().summary().starts_with(&sentence));
    harness.key_press(egui::Key::Enter);
    harness.run_steps(2);
    settle(&mut harness);
    let implant = harness.state().session().scene().implant;
    assert_eq!((implant.base_radius_mm, implant.projection_mm), (65.0, 42.5));
}

#[test]
fn each_arrow_of_a_slow_frame_counts() {
    let mut harness = range_of(sheet(), DESKTOP);
    wait_for(&mut harness, "A quick, coarse computation");
    harness.get_by_role_and_label(Role::Canvas, CHART).focus();
    harness.run_steps(2);
    // The first one chooses the present implant.
    for key in [egui::Key::ArrowRight, egui::Key::ArrowRight, egui::Key::ArrowUp] {
        harness.input_mut().events.push(egui::Event::Key {
            key,
            physical_key: None,
            pressed: true,
            repeat: false,
            modifiers: egui::Modifiers::NONE,
        });
    }
    harness.run_steps(2);
    let sentence = words(&harness);
    assert!(sentence.starts_with("Width 12.25 cm, projection 4.25 cm: "), "{sentence}");
}

#[test]
fn an_edit_restarts_the_chart_and_its_values_follow() {
    let mut harness = range_of(sheet(), DESKTOP);
    wait_for(&mut harness, "A quick, coarse computation");
    let at = place(&harness, 8, 10);
    harness.hover_at(at);
    harness.run_steps(2);
    let before = words(&harness);
    type_into(&mut harness, "Margin (cm)", "2.5");
    // Other pockets are other scenes.
    assert_eq!(harness.query_all_by_label_contains("A quick, coarse").count(), 0);
    wait_for(&mut harness, "A quick, coarse computation");
    harness.hover_at(at);
    harness.run_steps(2);
    let scene = harness.state().session().scene().clone();
    assert_ne!(words(&harness), before);
    let strain = case(&scene, 8, 10).values.get(Quantity::GreatestStrain).unwrap();
    let expected = format!("Skin stretch: {:.0} percent", 100.0 * strain);
    assert!(words(&harness).contains(&expected), "{} {expected}", words(&harness));
    // Undo: all cases are stored.
    harness.get_by_role_and_label(Role::Button, "Undo").click();
    settle(&mut harness);
    wait_for(&mut harness, "A quick, coarse computation");
    harness.hover_at(at);
    harness.run_steps(2);
    assert_eq!(words(&harness), before);
    // An unfinished chart is cancelled with the page.
    type_into(&mut harness, "Margin (cm)", "2");
    harness.get_by_role_and_label(Role::Button, "Picture").click();
    harness.run();
    harness.get_by_role_and_label(Role::Canvas, "3-D view");
}

#[test]
fn an_impossible_axis_is_one_line_and_the_plan_stays() {
    let mut harness = range_of(sheet(), DESKTOP);
    let scene = harness.state().session().scene().clone();
    type_into(&mut harness, "Across, from", "wide");
    harness.get_by_label_contains("Across, from: “wide” is not a number");
    type_into(&mut harness, "Across, from", "99");
    harness.get_by_label_contains("Across, from: at most 24 cm");
    type_into(&mut harness, "Across, from", "14");
    harness.get_by_label("Width from 14 cm to 14 cm; allowed: two different numbers.");
    type_into(&mut harness, "Across, from", "10");
    wait_for(&mut harness, "A quick, coarse computation");
    assert_eq!(harness.query_all_by_label_contains("allowed:").count(), 0);
    assert_eq!(harness.state().session().scene(), &scene);
}

#[test]
fn the_chart_has_the_pins_and_returns_to_the_plan() {
    let mut harness = range_of(sheet(), DESKTOP);
    harness.get_by_role_and_label(Role::Button, "Pin as A").click();
    harness.run_steps(2);
    let words = "Pin A: width 12 cm, projection 3.98 cm";
    let pin = harness.get_by_role_and_label(Role::Image, words).rect();
    assert!(pin.center().distance(place(&harness, 8, 8)) < 4.0, "{pin:?}");
    // For another pocket the colours are not those of the pin.
    type_into(&mut harness, "Margin (cm)", "2.5");
    harness.get_by_label_contains("Pin A: width 12 cm, projection 3.98 cm; other numbers");
    // Typed ends stay, until the button.
    type_into(&mut harness, "Across, from", "13");
    assert_eq!(harness.query_all_by_role(Role::Image).count(), 0);
    harness.get_by_label_contains("Pin A is not on this chart.");
    harness.get_by_label_contains("This plan is not on this chart.");
    harness.get_by_role_and_label(Role::Button, "Around the plan").click();
    harness.run_steps(3);
    let from = harness.get_by_role_and_label(Role::SpinButton, "Across, from").value();
    assert_eq!(from.as_deref(), Some("10"));
    harness.get_by_label_contains(words);
}

#[test]
fn axes_and_colours_are_chosen_and_one_number_gives_a_curve() {
    let mut harness = range_of(layered(), DESKTOP);
    choose(&mut harness, "Colour", "Least cover");
    choose(&mut harness, "Across", "Pinch");
    choose(&mut harness, "Upwards", "Nothing: a curve");
    wait_for(&mut harness, "A quick, coarse computation");
    let before = harness.state().session().scene().clone();
    let rect = harness.get_by_role_and_label(Role::Canvas, CHART).rect();
    // The thickest pinch: 5 cm.
    harness.hover_at(rect.right_center() - egui::vec2(1.0, 0.0));
    harness.run_steps(2);
    assert!(words(&harness).starts_with("Pinch 5 cm: Least cover: "), "{}", words(&harness));
    click(&mut harness, rect.right_center() - egui::vec2(1.0, 0.0));
    let taken = harness.state().session().scene();
    assert_eq!(taken.patient.as_ref().unwrap().measured.pinch_mm, Some(50.0));
    assert!(taken.layers[1].thickness_mm > before.layers[1].thickness_mm);
    assert_eq!(taken.implant, before.implant);
}

#[test]
fn a_sheet_has_no_cover_to_show() {
    let mut harness = range_of(sheet(), DESKTOP);
    harness.get_by_role_and_label(Role::ComboBox, "Colour").click();
    harness.run_steps(2);
    assert_eq!(harness.query_all_by_label("Least cover").count(), 0);
    assert_eq!(harness.query_all_by_label("Skin area gained").count(), 1);
}

#[test]
fn on_a_phone_a_tap_shows_the_values_and_a_button_takes_the_implant() {
    let mut harness = range_of(sheet(), PHONE);
    wait_for(&mut harness, "A quick, coarse computation");
    let chart = harness.get_by_role_and_label(Role::Canvas, CHART).rect();
    assert!(chart.width() > 220.0 && chart.height() > 170.0, "{chart:?}");
    let before = harness.state().session().scene().clone();
    let at = place(&harness, 10, 10);
    let touch = |harness: &mut Harness<'static, App>, phase| {
        harness.event(egui::Event::Touch {
            device_id: egui::TouchDeviceId(1),
            id: egui::TouchId(1),
            phase,
            pos: at,
            force: None,
        });
    };
    touch(&mut harness, egui::TouchPhase::Start);
    harness.drag_at(at);
    harness.step();
    touch(&mut harness, egui::TouchPhase::End);
    harness.drop_at(at);
    harness.run_steps(3);
    assert_eq!(harness.state().session().scene(), &before);
    assert!(words(&harness).starts_with("Width 12.5 cm, projection 4.5 cm"), "{}", words(&harness));
    harness.get_by_role_and_label(Role::Button, "Take this implant").click();
    harness.run_steps(2);
    settle(&mut harness);
    assert!((harness.state().session().scene().implant.base_radius_mm - 62.5).abs() < 1e-9);
    assert_eq!(harness.query_all_by_role_and_label(Role::ComboBox, "Across").count(), 0);
    harness.get_by_role_and_label(Role::Button, "Axes").click();
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::ComboBox, "Across");
    harness.get_by_role_and_label(Role::Button, "Picture").click();
    harness.run_steps(2);
    harness.get_by_role_and_label(Role::Canvas, "3-D view");
}

//! The app's screens by accessible name, without a GPU: panels, controls, rejected files, no work without a change.

#![cfg(all(feature = "app", not(target_arch = "wasm32")))]
#![allow(clippy::float_cmp, reason = "typed values hold to the last bit")]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use eframe::egui::{self, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use frames::{cut_texts, painted_texts, settle};
use implant_preview::app::App;
use implant_preview::clinical::{PracticeTable, Size};
use implant_preview::curve::{Curve, CurveSpec, Interpolation, ScaledCurve};
use implant_preview::measure::{Outcome, Status, bands};
use implant_preview::platform::runner::beside_window;
use implant_preview::scene::{Scene, Springs, TissueModel};
use implant_preview::session::Counters;
use implant_preview::simulate::simulate;
use implant_preview::study::Practice;
use serde_json::json;
use window::{flat_plan, window};

#[path = "screens/anatomical.rs"]
mod anatomical;
#[path = "screens/chest.rs"]
mod chest;
#[path = "screens/device.rs"]
mod device;
#[path = "screens/filling.rs"]
mod filling;
#[path = "screens/focus.rs"]
mod focus;
#[path = "screens/form.rs"]
mod form;
#[path = "common/frames.rs"]
mod frames;
#[path = "screens/hands.rs"]
mod hands;
#[path = "screens/long_solve.rs"]
mod long_solve;
#[path = "screens/no_answer.rs"]
mod no_answer;
#[path = "screens/notices.rs"]
mod notices;
#[path = "screens/pictures.rs"]
mod pictures;
#[path = "screens/practice.rs"]
mod practice;
#[path = "screens/research.rs"]
mod research;
#[path = "screens/shelf.rs"]
mod shelf;
#[path = "screens/side.rs"]
mod side;
#[path = "screens/sizes.rs"]
mod sizes;
#[path = "screens/uncertainty.rs"]
mod uncertainty;
#[path = "screens/visit.rs"]
mod visit;
#[path = "common/window.rs"]
mod window;

/// Tall enough for all folds.
const WIDE: egui::Vec2 = egui::Vec2::new(1280.0, 2600.0);
/// A usual screen.
const DESKTOP: egui::Vec2 = egui::Vec2::new(1440.0, 900.0);
const PHONE: egui::Vec2 = egui::Vec2::new(390.0, 844.0);

/// The app on a small grid, solved and at rest.
fn app(size: egui::Vec2, change: impl FnOnce(&mut Scene)) -> Harness<'static, App> {
    start(size, change, None)
}

/// [`app`] with the switch "Research".
fn researching(size: egui::Vec2, change: impl FnOnce(&mut Scene)) -> Harness<'static, App> {
    start(size, change, Some("on"))
}

fn start(
    size: egui::Vec2,
    change: impl FnOnce(&mut Scene),
    is_research: Option<&str>,
) -> Harness<'static, App> {
    let mut scene = Scene::default();
    scene.solver.nodes_per_side = 33;
    change(&mut scene);
    let ctx = egui::Context::default();
    let mut app = App::new(&ctx, None, scene, beside_window).unwrap();
    app.restore_research(is_research);
    let mut harness = window(size, 400, app);
    settle(&mut harness);
    harness
}

/// The app with the switch "Research" and its folds open: all controls and numbers.
fn unfolded(change: impl FnOnce(&mut Scene)) -> Harness<'static, App> {
    let mut harness = researching(WIDE, change);
    for fold in ["Tissue", "Advanced", "Details", "Where limits come from"] {
        unfold(&mut harness, fold);
    }
    harness
}

/// Draws frames until something is found: a study computes beside the frames.
fn wait_until<T>(
    harness: &mut Harness<'static, App>,
    what: &str,
    mut find: impl FnMut(&Harness<'static, App>) -> Option<T>,
) -> T {
    let start = std::time::Instant::now();
    loop {
        if let Some(found) = find(harness) {
            return found;
        }
        assert!(start.elapsed().as_secs() < 300, "{what} does not come");
        harness.step();
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
}

/// Draws frames until practice's volumes of the plan are solved.
fn wait_for_practice(harness: &mut Harness<'static, App>) {
    wait_until(harness, "practice", |harness| text_with(harness, "practice's "));
}

/// Draws frames until the studies of a plan at rest are done: none begins for a second.
fn wait_for_studies(harness: &mut Harness<'static, App>) {
    let mut last = std::time::Instant::now();
    wait_until(harness, "the end of the studies", |harness| {
        if harness.state().stats().jobs > 0 {
            last = std::time::Instant::now();
        }
        (last.elapsed().as_secs() >= 1).then_some(())
    });
    harness.run();
}

/// The text of the first label that contains these words.
fn text_with(harness: &Harness<'static, App>, words: &str) -> Option<String> {
    let mut labels = harness.query_all_by_label_contains(words);
    labels.find_map(|node| node.accesskit_node().label().or(node.value()))
}

/// Opens or closes a fold, which may be scrolled out of sight.
fn unfold(harness: &mut Harness<'static, App>, fold: &'static str) {
    harness.get_by_label(fold).focus();
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.run();
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
    harness.get_by_label("Up to date");
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
            let status = harness.get_by_label("Up to date").rect();
            assert!(tissue.bottom() < status.top(), "{size} {chips:?}: {tissue:?} {status:?}");
            assert!(sources.bottom() < status.top(), "{size} {chips:?}: {sources:?}");
            assert_eq!(cut_texts(&harness), Vec::<String>::new(), "{size} {chips:?}");
        }
        let picture = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
        assert!(picture.width() > 0.46 * size.x, "{size}: {picture:?}");
    }
}

/// Visible texts of the last frame that end in "…" for want of room.
fn shortened_texts(harness: &Harness<'static, App>) -> Vec<String> {
    let texts = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
        egui::Shape::Text(text) if text.galley.elided => Some(text.galley.text().to_owned()),
        _ => None,
    });
    texts.collect()
}

#[test]
fn the_texts_of_the_cards_are_whole_with_and_without_sampled_patients() {
    for size in [DESKTOP, egui::vec2(1280.0, 800.0), egui::vec2(1024.0, 768.0), PHONE] {
        // A pressure whose range ends above 100 mmHg has the longest words.
        let mut harness = app(size, |scene| *scene = flat_plan());
        harness.state_mut().set_plan("skin", "tight").unwrap();
        if size == PHONE {
            press(&mut harness, "More");
        }
        wait_for_practice(&mut harness);
        for _ in 0..2 {
            let shortened = shortened_texts(&harness);
            let is_disclaimer = |text: &&String| text.starts_with("Not a medical device");
            assert!(shortened.iter().all(|text| is_disclaimer(&text)), "{size}: {shortened:?}");
            assert_eq!(cut_texts(&harness), Vec::<String>::new(), "{size}");
            wait_for_studies(&mut harness);
        }
        assert!(text_with(&harness, " of 10 patients").is_some(), "{size}");
        assert!(text_with(&harness, "over the implant's highest point").is_none(), "{size}");
    }
}

#[test]
fn the_opening_plan_is_a_usual_one_with_every_card_computed() {
    let mut harness = researching(DESKTOP, |scene| *scene = Scene::opening());
    let scene = harness.state().session().scene().clone();
    assert_eq!((scene.implant.base_radius_mm, scene.pocket_radius_mm), (60.0, 70.0));
    let value = |harness: &Harness<'static, App>, name: &'static str| {
        harness.get_by_role_and_label(Role::SpinButton, name).value().unwrap()
    };
    for (field, text) in [
        ("Width (cm)", "12.0"),
        ("Volume (ml)", "225"),
        ("Projection (cm)", "3.0"),
        ("Pinch (cm)", "2.0"),
        ("Margin (cm)", "1.0"),
    ] {
        assert_eq!(value(&harness, field), text, "{field}");
    }
    harness.get_by_label("Cover 10 mm (6–17): skin 1.5 + fat 8.5");
    wait_for_practice(&mut harness);
    // A cover that is not thin has no level.
    assert_eq!(harness.query_all_by_label("usual").count(), 1);
    harness.get_by_label("below practice");
    harness.get_by_label("not thin");
    harness.get_by_label_contains("225 ml, 12 cm: below practice. Stretch 16 %, cover 8.");
    harness.get_by_label_contains("practice's 300 ml: 21 %");
    harness.get_by_label("Practice takes 300 ml");
    harness.get_by_label("standard model, normal accuracy");
    // The hint is gone after the first edit.
    let hint = "Change width, volume or pinch · drag the picture to turn it";
    harness.get_by_label(hint);
    type_into(&mut harness, "Width (cm)", "12,5");
    assert_eq!(harness.query_all_by_label(hint).count(), 0);
    harness.get_by_role_and_label(Role::Button, "Start over").click();
    settle(&mut harness);
    assert_eq!(harness.state().session().scene(), &scene);
}

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
        assert!(harness.query_by_label("Up to date").is_some(), "{field}");
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
fn layers_are_added_exchanged_and_removed() {
    let mut harness = unfolded(|_| {});
    let tissues = |harness: &Harness<'static, App>| -> Vec<String> {
        harness.state().session().scene().layers.iter().map(|l| l.tissue.clone()).collect()
    };
    harness.get_by_role_and_label(Role::Button, "Move inward layer 1").click();
    settle(&mut harness);
    assert_eq!(tissues(&harness), ["adipose", "skin"]);
    harness.get_by_role_and_label(Role::Button, "Add fat").click();
    settle(&mut harness);
    assert_eq!(tissues(&harness), ["adipose", "skin", "adipose"]);
    harness.get_by_role_and_label(Role::Button, "Remove layer 1").click();
    settle(&mut harness);
    assert_eq!(tissues(&harness), ["skin", "adipose"]);
    assert_eq!(harness.state().outcome().unwrap().layers.len(), 2);
}

#[test]
fn the_tissue_model_is_chosen_and_layered_tissue_adds_its_controls_and_readings() {
    let mut harness = unfolded(|_| {});
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
    // A sheet is nearly twice as stiff.
    assert!(layered < 0.6 * sheet, "{layered} of {sheet}");
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
    let attachment = harness.state().session().scene().body.attachment;
    assert!((attachment.stiffness_kpa_per_mm - 5.0).abs() < 1e-12);
    choose(&mut harness, "One sheet");
    assert!((force(&harness) - sheet).abs() < 1e-9);
    assert!(harness.query_by_role_and_label(Role::Slider, stiffness).is_none());
}

#[test]
fn the_papers_springs_are_chosen_with_their_tissue_model_in_one_step() {
    let mut harness = unfolded(|_| {});
    let scene = |harness: &Harness<'static, App>| harness.state().session().scene().clone();
    let before = scene(&harness);
    harness.get_by_role_and_label(Role::ComboBox, "Law of the tissue").click();
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
fn the_half_sphere_is_an_example_of_the_menu_and_the_plan_comes_back() {
    let mut harness = researching(DESKTOP, |scene| scene.set_tissue_model(TissueModel::Sheet));
    for (example, scene) in
        [("Half sphere of 11 cm", Scene::default()), ("Usual implant", Scene::opening())]
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
fn the_computed_radius_follows_the_pocket_until_set() {
    let mut harness = unfolded(|_| {});
    let patch =
        |harness: &Harness<'static, App>| harness.state().session().scene().body.patch_radius_mm;
    type_into(&mut harness, "Margin (cm)", "2.5");
    assert!((patch(&harness) - 140.0).abs() < 1e-9);
    type_into(&mut harness, "Computed radius (mm)", "120");
    type_into(&mut harness, "Margin (cm)", "15 mm");
    assert!((patch(&harness) - 120.0).abs() < 1e-9);
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
fn a_colour_the_section_and_the_theme_solve_nothing() {
    let mut harness = researching(WIDE, |_| {});
    let counters = harness.state().session().counters();
    focus_picture(&mut harness);
    for key in [egui::Key::Num1, egui::Key::Num3, egui::Key::Num5] {
        harness.key_press(key);
        harness.step();
    }
    press(&mut harness, "Inside");
    for item in ["Grid", "Areola"] {
        press(&mut harness, "View");
        harness.get_by_role_and_label(Role::CheckBox, item).click();
        harness.run();
    }
    harness.get_by_label("Front").click();
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
        scene.layers = vec![implant_preview::scene::Layer::paper_adipose()];
    });
    assert_eq!(harness.state().outcome().unwrap().status, Status::Unstable);
    assert!(harness.get_all_by_label("No answer").count() > 0);
    harness.get_by_role_and_label(Role::Button, "Use the standard model").click();
    settle(&mut harness);
    assert_eq!(harness.state().session().scene().springs, Springs::Coupled);
    assert_eq!(harness.state().outcome().unwrap().status, Status::Converged);
}

#[test]
fn the_papers_springs_are_marked_before_the_solve() {
    // The first frame of a fine grid is drawn before the solve ends.
    let mut scene = Scene { springs: Springs::Nikolaev, ..Scene::sheet() };
    scene.solver.nodes_per_side = 1025;
    let app = App::new(&egui::Context::default(), None, scene, beside_window).unwrap();
    let mut harness = window(WIDE, 1, app);
    harness.get_by_label("Advanced").click();
    (0..8).for_each(|_| harness.step());
    assert!(harness.state().session().is_working(), "solved already: the test shows nothing");
    harness.get_by_label("The 2013 model breaks down, first at 23 % stretch");
    harness.get_by_label("Uniaxial stretch: unstable at 23–42 %");
    harness.get_by_label("Equibiaxial stretch: unstable at 33–41 %");
    harness.get_by_role_and_label(Role::Button, "Use the standard model").click();
    for _ in 0..4 {
        harness.step();
    }
    assert_eq!(harness.state().session().scene().springs, Springs::Coupled);
    assert_eq!(harness.query_all_by_label_contains("breaks down").count(), 0);
}

#[test]
fn the_mark_of_the_papers_springs_is_computed_once_per_stack_of_layers() {
    let mut harness = unfolded(|scene| {
        scene.set_springs(Springs::Nikolaev);
        scene.layers[1] = implant_preview::scene::Layer::paper_adipose();
    });
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
    let harness = unfolded(|scene| {
        scene.set_springs(Springs::Nikolaev);
        scene.insertion = 0.2;
        scene.layers.truncate(1);
        scene.layers[0].poisson_ratio = 0.3;
    });
    harness.get_by_label_contains("stable at all strains up to 100 %");
    let offers = harness.query_all_by_label("Use the standard model");
    assert_eq!(offers.count(), 0);
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
fn the_summary_describes_the_answer() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    wait_for_practice(&mut harness);
    let summary = harness.state().summary();
    assert!(summary.starts_with("300 ml implant, 12 cm wide. Skin stretch "), "{summary}");
    for words in [" percent, as practice.", ", at rest 10.0 mm.", " mmHg, usual.", " Up to date."] {
        assert!(summary.contains(words), "{summary}");
    }
    let stats = harness.state().stats();
    assert!(stats.converged && stats.frames > 0 && stats.solves == 1 && stats.work_units > 0.0);
}

#[test]
fn the_last_point_of_a_measured_curve_can_be_entered() {
    let mut harness = unfolded(|scene| {
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
    harness.get_by_role_and_label(Role::Button, "Edit points").click();
    harness.run();
    let apply = |harness: &mut Harness<'static, App>| {
        harness.get_by_role_and_label(Role::Button, "Apply the curve").click();
        settle(harness);
    };
    type_into(&mut harness, "Strain of point 3", "0,5");
    // The layer takes the points on request only.
    assert_eq!(points(&harness), [[0.0, 0.0], [0.4, 100.0], [1.0, 500.0]]);
    type_into(&mut harness, "Stress of point 3", "220");
    apply(&mut harness);
    assert_eq!(points(&harness), [[0.0, 0.0], [0.4, 100.0], [0.5, 220.0]]);
    // Points out of order are reported; nothing is stored or clamped.
    type_into(&mut harness, "Stress of point 3", "90");
    harness.get_by_label_contains("must be greater than that of point 2 (100 kPa)");
    apply(&mut harness);
    assert_eq!(points(&harness), [[0.0, 0.0], [0.4, 100.0], [0.5, 220.0]]);
    // The points of such a table can be corrected in any sequence.
    type_into(&mut harness, "Stress of point 2", "50");
    apply(&mut harness);
    assert_eq!(points(&harness), [[0.0, 0.0], [0.4, 50.0], [0.5, 90.0]]);
    harness.get_by_label("percent").click();
    harness.run();
    type_into(&mut harness, "Strain of point 2", "30");
    apply(&mut harness);
    assert_eq!(points(&harness), [[0.0, 0.0], [0.3, 50.0], [0.5, 90.0]]);
    // Escape closes the window without a draft; Undo takes the last curve back.
    harness.key_press(egui::Key::Escape);
    harness.run();
    assert!(harness.query_by_label("Apply the curve").is_none());
    harness.get_by_role_and_label(Role::Button, "Undo").click();
    settle(&mut harness);
    assert_eq!(points(&harness), [[0.0, 0.0], [0.4, 50.0], [0.5, 90.0]]);
}

#[test]
fn entered_points_are_those_that_the_plan_uses() {
    let mut harness = unfolded(|scene| {
        *scene = flat_plan();
        let points = vec![[0.0, 0.0], [0.4, 50.0], [1.0, 250.0]];
        let spec = CurveSpec::Points { points, interpolation: Interpolation::Line };
        scene.layers[0].curve = ScaledCurve { spec, strain_scale: 0.5, stress_scale: 2.0 };
    });
    harness.get_by_role_and_label(Role::Button, "Edit points").click();
    harness.run();
    let value = |harness: &Harness<'static, App>, name: &'static str| {
        harness.get_by_role_and_label(Role::SpinButton, name).value().unwrap()
    };
    // The scales are multiplied in; without a change there is nothing to take.
    assert_eq!(value(&harness, "Strain of point 2"), "0.20");
    assert_eq!(value(&harness, "Stress of point 3"), "500.0");
    type_into(&mut harness, "Stress of point 3", "220");
    harness.get_by_role_and_label(Role::Button, "Apply the curve").click();
    settle(&mut harness);
    let curve =
        |harness: &Harness<'static, App>| harness.state().session().scene().layers[0].curve.clone();
    assert_eq!((curve(&harness).strain_scale, curve(&harness).stress_scale), (1.0, 1.0));
    let stress = |harness: &Harness<'static, App>, strain| {
        Curve::scaled(&curve(harness)).unwrap().stress(strain)
    };
    assert!((stress(&harness, 0.5) - 220.0).abs() < 1e-9);
    // The class of the skin does not bend what was measured.
    harness.key_press(egui::Key::Escape);
    harness.run();
    press(&mut harness, "lax");
    settle(&mut harness);
    assert!((stress(&harness, 0.5) - 220.0).abs() < 1e-9);
    harness.get_by_label_contains("The pull of the skin has no effect");
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

/// The app with the points of a measured skin open in their window.
fn with_points_open() -> Harness<'static, App> {
    let mut harness = unfolded(|scene| {
        scene.layers[0].curve = CurveSpec::Points {
            points: vec![[0.0, 0.0], [1.0, 500.0]],
            interpolation: Interpolation::Line,
        }
        .into();
    });
    harness.get_by_role_and_label(Role::Button, "Edit points").click();
    harness.run();
    harness
}

/// Applies the points of the window; the points of the plan.
fn applied(harness: &mut Harness<'static, App>) -> Vec<[f64; 2]> {
    harness.get_by_role_and_label(Role::Button, "Apply the curve").click();
    settle(harness);
    match &harness.state().session().scene().layers[0].curve.spec {
        CurveSpec::Points { points, .. } => points.clone(),
        _ => panic!("no points"),
    }
}

#[test]
fn a_pasted_table_becomes_the_curve_of_its_layer() {
    let mut harness = with_points_open();
    let paste = |harness: &mut Harness<'static, App>, text: &str| {
        harness.get_by_role_and_label(Role::MultilineTextInput, "Table to read").focus();
        harness.run();
        harness.event(egui::Event::Paste(text.to_owned()));
        harness.run();
        harness.get_by_role_and_label(Role::Button, "Use the table").click();
        harness.run();
    };
    paste(&mut harness, "strain stress\nx 3\n");
    harness.get_by_label_contains("no row has two numbers; allowed: a strain and a stress in each row. The points are unchanged.");
    harness.get_by_role_and_label(Role::MultilineTextInput, "Table to read").focus();
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::A);
    harness.run();
    paste(&mut harness, "strain;stress (kPa)\n0,1;2,5\n45 %;0,12 MPa\n");
    assert_eq!(applied(&mut harness), [[0.0, 0.0], [0.1, 2.5], [0.45, 120.0]]);
}

#[test]
fn the_clipboard_is_read_by_a_button_and_a_bad_line_leaves_the_others() {
    let mut harness = with_points_open();
    // Nothing in the clipboard: the field has the focus, and the window says how to paste.
    harness.get_by_role_and_label(Role::Button, "Paste table").click();
    harness.run();
    harness.get_by_label_contains("paste the table into this field");
    let field = harness.get_by_role_and_label(Role::MultilineTextInput, "Table to read");
    assert!(field.is_focused());
    harness.get_by_role_and_label(Role::Button, "Paste table").click();
    harness.step();
    harness.step();
    harness.event(egui::Event::Paste("0,1;2,5\nx;3\n45 %;0,12 MPa\n".to_owned()));
    harness.run();
    assert!(harness.query_by_label_contains("paste the table into this field").is_none());
    harness.get_by_label_contains("left out: 1; the first: line 2.");
    let text = |harness: &Harness<'static, App>| {
        harness.get_by_role_and_label(Role::MultilineTextInput, "Table to read").value().unwrap()
    };
    assert_eq!(text(&harness), "0,1;2,5\nx;3\n45 %;0,12 MPa\n");
    assert_eq!(applied(&mut harness), [[0.0, 0.0], [0.1, 2.5], [0.45, 120.0]]);
}

/// A file dropped on the window.
#[derive(Debug)]
struct Dropped {
    path: std::path::PathBuf,
    text: String,
}

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &std::path::Path {
        &self.path
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        Ok(self.text.clone().into_bytes())
    }
}

#[test]
fn a_dropped_tensile_test_becomes_a_curve_in_the_unit_that_is_chosen() {
    let mut harness = with_points_open();
    // 60 kPa a strain of 1 and an offset, in MPa; the unloading behind.
    let row = |k: u32| format!("{};{}\n", 0.5 * f64::from(k), 0.01 + 0.0003 * f64::from(k));
    let loading: String = (0..=80).map(row).collect();
    let unloading: String = (0..80).rev().map(row).collect();
    let text = format!("ε;σ\n{loading}{unloading}").replace('.', ",");
    let file = Dropped { path: "test.csv".into(), text };
    harness.input_mut().dropped_files.push(std::sync::Arc::new(file));
    wait_until(&mut harness, "the notice", |harness| text_with(harness, "test.csv was read"));
    for sentence in [
        "Strain: “ε”, in percent, guessed by the size of the numbers.",
        "Stress: “σ”, in MPa, guessed by the size of the numbers.",
        "The loading is 81 of 161 rows; the other rows are unloading, cycles or rest.",
        "Stress at the start, subtracted: 10 kPa.",
        "2 points fit 80 samples; root mean square of the distances: 0 kPa, 0 % of the greatest stress.",
    ] {
        harness.get_by_label(sentence);
    }
    // The window stays on a low screen, too.
    harness.set_size(egui::vec2(1000.0, 520.0));
    harness.run();
    let button = harness.get_by_role_and_label(Role::Button, "Apply the curve").rect();
    assert!(button.bottom() < 520.0 && button.top() > 0.0, "{button:?}");
    harness.set_size(DESKTOP);
    harness.run();
    harness.get_by_role_and_label(Role::ComboBox, "Stress in").click();
    harness.run();
    harness.get_by_role_and_label(Role::Button, "kPa").click();
    harness.run();
    harness.get_by_label("Stress: “σ”, in kPa, as asked.");
    harness.get_by_label_contains("more than 30 times softer than every preset");
    let points = applied(&mut harness);
    assert_eq!(points.len(), 2, "{points:?}");
    assert!((points[1][0] - 0.4).abs() < 1e-9 && (points[1][1] - 0.024).abs() < 1e-9, "{points:?}");
}

/// Starts of the marks on the rail of the volume \[points\].
fn volume_marks(model: TissueModel) -> Vec<f32> {
    let mut harness = app(DESKTOP, |scene| {
        *scene = flat_plan();
        scene.set_tissue_model(model);
    });
    let rail = harness.get_by_role_and_label(Role::Slider, "Volume (ml)").rect();
    let marks = |harness: &Harness<'static, App>| -> Vec<f32> {
        let lines = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
            egui::Shape::LineSegment { points, stroke } => Some((*points, stroke.width)),
            _ => None,
        });
        let is_mark = |points: &[egui::Pos2; 2], width: f32| {
            (width - 3.0).abs() < 1e-3 && points.iter().all(|point| rail.contains(*point))
        };
        lines
            .filter(|(points, width)| is_mark(points, *width))
            .map(|(points, _)| points[0].x)
            .collect()
    };
    harness.hover_at(rail.center());
    wait_until(&mut harness, "a mark", |harness| {
        Some(marks(harness)).filter(|marks| !marks.is_empty())
    })
}

/// The sentence with the largest volume that stays usual on 12 cm and the next width, once that is known.
fn largest_usual(harness: &mut Harness<'static, App>) -> String {
    wait_until(harness, "the largest volume", |harness| {
        text_with(harness, " with the same stretch; ")
    })
}

/// The volume of the sentence \[ml\].
fn volume_of(words: &str) -> f64 {
    words.to_lowercase().split_once("up to ").unwrap().1.split(' ').next().unwrap().parse().unwrap()
}

#[test]
fn the_largest_volume_that_stays_usual_is_known_without_an_edit_and_is_taken_by_a_press() {
    for size in [DESKTOP, PHONE] {
        let mut harness = app(size, |scene| *scene = flat_plan());
        let below = if size == PHONE { "Projection (cm)" } else { "Pinch (cm)" };
        let place = |harness: &Harness<'static, App>| {
            harness.get_by_role_and_label(Role::SpinButton, below).rect()
        };
        let before = place(&harness);
        let words = largest_usual(&mut harness);
        assert_eq!(place(&harness), before, "{size}: the plan moves");
        assert!(harness.state().summary().contains(&words), "{words}");
        // On a phone the line may be scrolled out of sight.
        harness.get_by_label(&words).focus();
        harness.run();
        harness.key_press(egui::Key::Enter);
        settle(&mut harness);
        let volume = harness.state().outcome().unwrap().implant_volume_ml;
        assert!((volume - volume_of(&words)).abs() < 1e-6, "{words}: {volume}");
        // The volume alone changes; one step of the history.
        assert_eq!(harness.state().session().scene().implant.base_radius_mm, 60.0);
        harness.get_by_role_and_label(Role::Button, "Undo").click();
        settle(&mut harness);
        assert!(!harness.state().session().can_undo());
        // An expander is not compared with practice, and the sentence has its reason.
        press(&mut harness, "expander");
        harness.run();
        let words = wait_until(&mut harness, "the largest volume", |harness| {
            text_with(harness, " stays usual on 12 cm; ")
        });
        assert!(words.starts_with("Filled at once, up to "), "{words}");
        assert!(words.ends_with(" on 13 cm (no practice for expanders)."), "{words}");
    }
}

#[test]
fn the_largest_volume_that_stays_usual_is_that_of_single_solves() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    press(&mut harness, "tight");
    settle(&mut harness);
    let words = largest_usual(&mut harness);
    let largest = volume_of(&words);
    let practice = |plan: &Scene| {
        let practice = Practice::new(plan, &PracticeTable::default()).unwrap();
        let strain = |scene: &Scene| simulate(scene).unwrap().strain.unwrap().max_principal;
        practice.scenes().each_ref().map(strain)[2]
    };
    let is_usual = |width: f64, volume: f64| {
        let mut scene = harness.state().session().scene().clone();
        scene.solver.nodes_per_side = 65;
        scene.pocket_radius_mm += 0.5 * width - scene.implant.base_radius_mm;
        scene.implant.base_radius_mm = 0.5 * width;
        let size = Size::of_width_and_volume(width, volume).unwrap();
        scene.implant.projection_mm = size.projection_mm();
        let outcome = simulate(&scene).unwrap();
        let strain = outcome.strain.unwrap().max_principal;
        let is_above = strain > practice(&scene);
        let is_thin = outcome.cover_mm.is_some_and(|cover| bands::cover(cover.least).is_some());
        !is_thin
            && !is_above
            && bands::pressure_band(outcome.contact_pressure_mmhg.unwrap().max) == 0
    };
    assert!(is_usual(120.0, largest - 10.0) && !is_usual(120.0, largest + 15.0), "{words}");
    // At the next width, with the same margin of the pocket.
    let wider = words.rsplit_once("; ").unwrap().1.strip_suffix(" ml on 13 cm.").unwrap();
    let wider: f64 = wider.parse().unwrap();
    assert!(is_usual(130.0, wider - 10.0) && !is_usual(130.0, wider + 15.0), "{words}");
}

#[test]
fn the_sentence_of_the_answer_has_size_and_figures_of_one_plan() {
    let mut harness = researching(DESKTOP, |scene| *scene = flat_plan());
    let sentence = |harness: &Harness<'static, App>| {
        let found = harness.get_by_label_contains(" ml, 12 cm: ");
        found.accesskit_node().label().or(found.accesskit_node().value()).unwrap()
    };
    wait_for_practice(&mut harness);
    let before = sentence(&harness);
    assert!(before.starts_with("300 ml, 12 cm: as practice. Stretch 14 %"), "{before}");
    harness.state_mut().set_plan("volume_ml", "400").unwrap();
    // Frame by frame, a draft included.
    let mut sentences = Vec::new();
    while harness.state().session().is_working() || sentences.len() < 3 {
        harness.step();
        sentences.push(sentence(&harness));
    }
    settle(&mut harness);
    let last = sentence(&harness);
    assert!(last.starts_with("400 ml, 12 cm: ") && last.contains("Stretch "), "{last}");
    for words in &sentences {
        let is_updating = words.ends_with("updating…");
        let is_old_figure = words.contains("Stretch 14 %");
        let is_old_size = words.starts_with("300 ml");
        assert!(is_updating || is_old_figure == is_old_size, "{words}");
    }
    assert!(!last.contains("Stretch 14 %"), "{last}");
}

#[test]
fn the_rail_of_the_volume_marks_where_the_words_change() {
    // Skin on fat has no answer beyond a volume; a sheet is high, then very high from smaller volumes on.
    let (layered, sheet) = (volume_marks(TissueModel::Layered), volume_marks(TissueModel::Sheet));
    assert!(
        sheet.len() >= 2 && sheet[0] < sheet[1] && sheet[0] < layered[0],
        "{layered:?}, {sheet:?}"
    );
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
fn choosing_measured_points_moves_no_point_of_a_preset() {
    let mut harness = unfolded(|_| {});
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

/// A touch of one finger: start and path, in quick frames.
fn swipe(harness: &mut Harness<'static, App>, from: egui::Pos2, travel: egui::Vec2) {
    swipe_within(harness, from, travel, 10);
}

/// A touch of one finger whose path takes so many frames.
fn swipe_within(
    harness: &mut Harness<'static, App>,
    from: egui::Pos2,
    travel: egui::Vec2,
    frames: usize,
) {
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
    // A tap is down and up within a frame.
    let is_tap = travel == egui::Vec2::ZERO;
    harness.step();
    if !is_tap {
        harness.step();
    }
    for k in 1..=if is_tap { 0 } else { 10 } {
        let at = from + travel * (k as f32 / 10.0);
        let events = &mut harness.input_mut().events;
        events.extend([egui::Event::PointerMoved(at), touch(egui::TouchPhase::Move, at)]);
        if k * frames / 10 > (k - 1) * frames / 10 {
            harness.step();
        }
    }
    let at = from + travel;
    let events = &mut harness.input_mut().events;
    events.extend([press(at, false), egui::Event::PointerGone, touch(egui::TouchPhase::End, at)]);
    settle(harness);
}

/// Opens the fold of the push of the implant; on a phone it is in a tab.
fn open_push(harness: &mut Harness<'static, App>) {
    if harness.query_by_role_and_label(Role::Button, "Patient").is_some() {
        press(harness, "Patient");
    }
    unfold(harness, "Tissue");
}

#[test]
fn a_swipe_across_a_slider_scrolls_and_one_along_it_moves_the_handle() {
    let mut harness = app(PHONE, |_| {});
    let insertion = |harness: &Harness<'static, App>| harness.state().session().scene().insertion;
    let slider = |harness: &Harness<'static, App>| {
        harness.get_by_role_and_label(Role::Slider, "In place (%)").rect()
    };
    open_push(&mut harness);
    // The Tab key scrolls the slider into view; a slider with the focus behaves equally.
    harness.get_by_role_and_label(Role::Button, "Show insertion").focus();
    harness.run();
    harness.key_press(egui::Key::Tab);
    (0..8).for_each(|_| harness.step());
    let away_from_the_handle =
        |at: egui::Rect| at.left_center() + egui::vec2(0.3 * at.width(), 0.0);
    let at = slider(&harness);
    assert!(at.bottom() < PHONE.y - 20.0, "{at:?}");
    swipe(&mut harness, away_from_the_handle(at), egui::vec2(3.0, 50.0));
    assert_eq!(insertion(&harness), 1.0, "a swipe across the slider moved it");
    let moved = slider(&harness).center().y - at.center().y;
    assert!(moved > 20.0, "the panel was scrolled by {moved}");
    swipe(&mut harness, away_from_the_handle(at), egui::vec2(3.0, -90.0));
    (0..8).for_each(|_| harness.step());
    // A tap beside the handle does not move the handle.
    let at = slider(&harness);
    swipe(&mut harness, away_from_the_handle(at), egui::Vec2::ZERO);
    assert_eq!(insertion(&harness), 1.0, "a tap beside the handle moved it");
    swipe(&mut harness, away_from_the_handle(at), egui::vec2(-40.0, 2.0));
    assert!(
        insertion(&harness) < 0.9,
        "a swipe along the slider left it at {}",
        insertion(&harness)
    );
}

#[test]
fn a_swipe_along_a_slider_moves_the_handle_as_far_in_slow_frames() {
    let travelled = |frames: usize| {
        let mut harness = app(PHONE, |_| {});
        open_push(&mut harness);
        harness.get_by_role_and_label(Role::Button, "Show insertion").focus();
        harness.run();
        harness.key_press(egui::Key::Tab);
        (0..8).for_each(|_| harness.step());
        let at = harness.get_by_role_and_label(Role::Slider, "In place (%)").rect();
        let from = at.left_center() + egui::vec2(0.5 * at.width(), 0.0);
        swipe_within(&mut harness, from, egui::vec2(-40.0, 2.0), frames);
        1.0 - harness.state().session().scene().insertion
    };
    let quick = travelled(10);
    assert!(quick > 0.1, "{quick}");
    for frames in [1, 2, 5] {
        let slow = travelled(frames);
        assert!((slow - quick).abs() < 1e-9, "{frames} frames: {slow} {quick}");
    }
}

#[test]
fn a_tap_on_the_picture_shows_values_until_the_next() {
    let mut harness = app(PHONE, |_| {});
    let picture = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
    let boxes = |harness: &Harness<'static, App>| {
        let is_box = |text: &&String| {
            text.starts_with("Skin stretch ") && text.contains(", area ")
                || text.starts_with("Outside ")
        };
        painted_texts(harness).iter().filter(is_box).count()
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
    let mut harness = unfolded(|_| {});
    // The sentence with the largest volume is a button.
    wait_for_studies(&mut harness);
    let mut ways = Vec::new();
    for modifiers in [egui::Modifiers::NONE, egui::Modifiers::SHIFT] {
        let mut seen = Vec::new();
        for _ in 0..200 {
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
    let mut harness = unfolded(|_| {});
    let about = |harness: &Harness<'static, App>| {
        harness.query_all_by_label("A preview, not a medical device.").count()
    };
    let button = |harness: &Harness<'static, App>| {
        harness.get_by_role_and_label(Role::Button, "Help").is_focused()
    };
    harness.get_by_role_and_label(Role::Button, "Help").focus();
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.run();
    assert_eq!(about(&harness), 1);
    harness.key_press(egui::Key::Escape);
    harness.run();
    assert_eq!((about(&harness), button(&harness)), (0, true));
    harness.step();
    assert_eq!(harness.state().focused().unwrap().0, "Help");
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
    let mut harness = unfolded(|scene| {
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
    harness.get_by_label("beyond");
    for source in [
        "skin tore at 54 ± 17 % (mean of 56 samples of excised back skin; Ní Annaidh and others, ",
        "Standing alone stretches the skin of the breast by up to 60 % in places (39 women; Norris",
        "(Tebbetts and Adams, Plast Reconstr Surg 116, 2005)",
        "30–60 mmHg were measured right after clinical filling of expanders.",
    ] {
        harness.get_by_label_contains(source);
    }
    // Warnings stand between the cards and the numbers.
    let warning =
        harness.get_by_label_contains("The stress–strain curve of skin was extrapolated").rect();
    let numbers = harness.get_by_label("Height of the breast mound").rect();
    assert!(
        (warning.left() - numbers.left()).abs() < 40.0 && warning.bottom() <= numbers.top() + 1.0
    );
}

fn press(harness: &mut Harness<'static, App>, button: &str) {
    harness.get_by_role_and_label(Role::Button, button).click();
    settle(harness);
}

fn pins(harness: &Harness<'static, App>) -> Vec<String> {
    let pins = harness.state().session().pins().iter();
    pins.map(|pin| format!("{} {}", pin.letter(), pin.name())).collect()
}

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
    assert_eq!(second.state().session().scene(), &Scene::opening());
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

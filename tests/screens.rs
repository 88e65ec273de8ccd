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
use implant_preview::platform::desktop::beside_window;
use implant_preview::scene::{Scene, Springs, TissueModel};
use implant_preview::session::Counters;
use implant_preview::simulate::simulate;
use implant_preview::study::Practice;
use serde_json::json;
use window::{flat_plan, window};

#[path = "screens/anatomical.rs"]
mod anatomical;
#[path = "screens/answer.rs"]
mod answer;
#[path = "screens/both_sides.rs"]
mod both_sides;
#[path = "screens/chest.rs"]
mod chest;
#[path = "screens/commands.rs"]
mod commands;
#[path = "screens/curve_editor.rs"]
mod curve_editor;
#[path = "screens/device.rs"]
mod device;
#[path = "screens/fill.rs"]
mod fill;
#[path = "screens/filling.rs"]
mod filling;
#[path = "screens/focus.rs"]
mod focus;
#[path = "screens/form.rs"]
mod form;
#[path = "screens/frame.rs"]
mod frame;
#[path = "common/frames.rs"]
mod frames;
#[path = "screens/gated.rs"]
mod gated;
#[path = "screens/hands.rs"]
mod hands;
#[path = "screens/long_solve.rs"]
mod long_solve;
#[path = "screens/no_answer.rs"]
mod no_answer;
#[path = "screens/notices.rs"]
mod notices;
#[path = "screens/paper.rs"]
mod paper;
#[path = "screens/pictures.rs"]
mod pictures;
#[path = "screens/pins.rs"]
mod pins;
#[path = "screens/plan.rs"]
mod plan;
#[path = "screens/practice.rs"]
mod practice;
#[path = "screens/research.rs"]
mod research;
#[path = "screens/ruler.rs"]
mod ruler;
#[path = "screens/scan.rs"]
mod scan;
#[path = "screens/shelf.rs"]
mod shelf;
#[path = "screens/side.rs"]
mod side;
#[path = "screens/sizes.rs"]
mod sizes;
#[path = "screens/tissue.rs"]
mod tissue;
#[path = "screens/touch.rs"]
mod touch;
#[path = "screens/uncertainty.rs"]
mod uncertainty;
#[path = "screens/unknowns.rs"]
mod unknowns;
#[path = "screens/visit.rs"]
mod visit;
#[path = "screens/volumes.rs"]
mod volumes;
#[path = "common/window.rs"]
mod window;

/// Tall enough for all folds.
const WIDE: egui::Vec2 = egui::Vec2::new(1280.0, 2800.0);
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

/// The status of a solved plan, of which more may be computed.
fn solved_status(harness: &Harness<'static, App>) -> egui::Rect {
    let words = ["Up to date", "Comparing with practice…", "Computing the largest volume…"];
    let mut words = words.into_iter().chain(["Computing the ranges…"]);
    words.find_map(|words| harness.query_by_label(words)).unwrap().rect()
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

/// The sentence with the largest volume that stays usual on 12 cm and the next width, once that is known.
fn largest_usual(harness: &mut Harness<'static, App>) -> String {
    wait_until(harness, "the largest volume", |harness| {
        text_with(harness, " within that stretch; ")
    })
}

/// Opens the fold of the push of the implant; on a phone it is in a tab.
fn open_push(harness: &mut Harness<'static, App>) {
    if harness.query_by_role_and_label(Role::Button, "Patient").is_some() {
        press(harness, "Patient");
    }
    unfold(harness, "Tissue");
}

fn press(harness: &mut Harness<'static, App>, button: &str) {
    harness.get_by_role_and_label(Role::Button, button).click();
    settle(harness);
}

fn pins(harness: &Harness<'static, App>) -> Vec<String> {
    let pins = harness.state().session().pins().iter();
    pins.map(|pin| format!("{} {}", pin.letter(), pin.name())).collect()
}

/// The volume of the sentence \[ml\].
fn volume_of(words: &str) -> f64 {
    words.to_lowercase().split_once("up to ").unwrap().1.split(' ').next().unwrap().parse().unwrap()
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

//! The app in a window without a GPU.

use eframe::egui;
use egui_kittest::Harness;
use implant_preview::app::App;
use implant_preview::body::fit::{Settings, fit};
use implant_preview::body::marks::Side;
use implant_preview::body::read::Unit;
use implant_preview::body::torso::{Torso, builtin};
use implant_preview::clinical::Size;
use implant_preview::scene::Scene;

/// The opening patient with a flat chest and an implant of 12 cm and 300 ml, on a small grid: quick to solve.
pub(crate) fn flat_plan() -> Scene {
    let mut scene = Scene { chest: None, ..Scene::opening() };
    scene.implant.projection_mm =
        Size::of_width_and_volume(120.0, 300.0).map_or(40.0, Size::projection_mm);
    scene.solver.nodes_per_side = 33;
    scene
}

/// The built-in torso as her body, on a small grid.
#[allow(dead_code, reason = "a program of tests uses a part")]
pub(crate) fn plan_on_a_body() -> Scene {
    let Torso { surface, marks } = builtin();
    let (settings, side) = (Settings::default(), Side::Left);
    let fitted = fit(&surface, &marks, side, &settings).expect("the built-in torso has a chest");
    let scene = Scene::of_body(&fitted, (&marks, side), settings.cover_mm, Unit::Mm);
    let mut scene = scene.expect("its wall carries the tissue");
    scene.keep_surface(&surface).expect("the torso is small");
    (scene.solver.nodes_per_side, scene.solver.tolerance) = (33, 1e-3);
    scene
}

/// An app in a window of a size; `steps`: greatest number of frames of `run`.
pub(crate) fn window(size: egui::Vec2, steps: u64, app: App) -> Harness<'static, App> {
    let mut is_moved = false;
    let frame = move |ui: &mut egui::Ui, app: &mut App| {
        // The harness has a context of its own, without fonts.
        if !std::mem::replace(&mut is_moved, true) {
            app.move_to(ui.ctx(), None);
        }
        app.show(ui);
    };
    Harness::builder().with_size(size).with_max_steps(steps).build_ui_state(frame, app)
}

//! The app in a window without a GPU.

use eframe::egui;
use egui_kittest::Harness;
use implant_preview::app::App;
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

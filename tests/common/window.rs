//! The app in a window without a GPU.

use eframe::egui;
use egui_kittest::Harness;
use implant_preview::app::App;

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

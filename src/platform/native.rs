//! The desktop window.

use crate::app::App;
use crate::scene::Scene;
use eframe::egui;

/// Opens the desktop app; returns after its window is closed.
///
/// # Errors
/// Returns an error without a window system or OpenGL.
pub fn run() -> eframe::Result {
    let viewport = egui::ViewportBuilder::default()
        .with_title("implant-preview")
        .with_app_id("implant-preview")
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size([360.0, 480.0]);
    let options = eframe::NativeOptions {
        viewport,
        renderer: eframe::Renderer::Glow,
        depth_buffer: 24,
        multisampling: 4,
        ..Default::default()
    };
    eframe::run_native(
        "implant-preview",
        options,
        Box::new(|cc| Ok(Box::new(App::new(&cc.egui_ctx, cc.gl.as_ref(), Scene::default())?))),
    )
}

//! The desktop window, and the files that keep plan and pins for the next start.

use super::keep::{self, Store};
use crate::app::{App, JobRunner, Wake};
use crate::scene::{MAX_SCENE_BYTES, Scene};
use crate::study::{Evaluator, JobThreads};
use eframe::{egui, glow};
use std::fs;
use std::io::{self, ErrorKind, Read as _};
use std::num::NonZeroUsize;
use std::path::PathBuf;

/// Opens the desktop app; returns after its window is closed.
///
/// # Errors
/// Returns an error without a window system or OpenGL.
pub fn run() -> eframe::Result {
    let mut viewport = egui::ViewportBuilder::default()
        .with_title("Implant preview")
        .with_app_id("implant-preview")
        .with_inner_size([1280.0, 800.0])
        .with_min_inner_size([360.0, 480.0]);
    if let Ok(icon) = icon() {
        viewport = viewport.with_icon(icon);
    }
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
        Box::new(|cc| {
            let (ctx, gl) = (&cc.egui_ctx, cc.gl.as_ref());
            let app = App::new(ctx, gl, Scene::first_plan(), beside_window)?;
            Ok(Box::new(Window::new(app, Folder::of_user())))
        }),
    )
}

/// The runner of the jobs of studies beside a window, on one thread per core less one, at least one.
///
/// # Panics
/// If the system starts no thread.
#[must_use]
pub fn beside_window(wake: Wake) -> Box<JobRunner> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = NonZeroUsize::new(cores - 1).unwrap_or(NonZeroUsize::MIN);
    let runner = JobThreads::new(threads, Evaluator::evaluate_guarded, || false);
    Box::new(runner.expect("the system starts a thread").with_wake(move || wake()))
}

/// The icon of the window, which is that of the page; without an icon the window would have that of the toolkit.
fn icon() -> Result<egui::IconData, impl std::error::Error> {
    eframe::icon_data::from_png_bytes(include_bytes!("../../assets/icon-192.png"))
}

/// The app in its window.
struct Window {
    app: App,
    store: Folder,
}

impl Window {
    fn new(mut app: App, store: Folder) -> Self {
        keep::restore_preferences(&mut app, &store);
        keep::restore(&mut app, &store);
        Self { app, store }
    }

    fn keep(&mut self, is_closing: bool) {
        keep::keep(&mut self.app, &self.store, is_closing);
    }
}

impl eframe::App for Window {
    fn ui(&mut self, ui: &mut egui::Ui, frame: &mut eframe::Frame) {
        self.app.ui(ui, frame);
        self.keep(false);
    }

    fn on_exit(&mut self, gl: Option<&glow::Context>) {
        self.keep(true);
        self.app.on_exit(gl);
    }
}

/// The folder of the kept texts, a file each; `None`: the system has no folder for data of programs.
struct Folder(Option<PathBuf>);

impl Folder {
    /// The folder in the user's folder for data of programs.
    fn of_user() -> Self {
        Self(dirs::data_dir().map(|folder| folder.join("implant-preview")))
    }
}

impl Store for Folder {
    const PLAN: &'static str = "plan.json";
    const PINS: &'static str = "pins.json";
    const SHELF: &'static str = "shelf.csv";
    const PRACTICE: &'static str = "practice-table.csv";
    const LANGUAGE: &'static str = "language.txt";
    const RESEARCH: &'static str = "research.txt";
    type Error = io::Error;

    fn read(&self, name: &str) -> io::Result<Option<String>> {
        let Some(folder) = &self.0 else { return Ok(None) };
        let file = match fs::File::open(folder.join(name)) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            file => file?,
        };
        let mut bytes = Vec::new();
        // One byte more than allowed: the reader rejects the text.
        file.take(MAX_SCENE_BYTES as u64 + 1).read_to_end(&mut bytes)?;
        Ok(Some(String::from_utf8_lossy(&bytes).into_owned()))
    }

    /// Replaces the text of a file as a whole: another start never reads a part of the text.
    fn write(&self, name: &str, text: &str) -> io::Result<()> {
        let folder = self.0.as_ref().ok_or(ErrorKind::NotFound)?;
        fs::create_dir_all(folder)?;
        let temporary = folder.join(format!("{name}.{}.tmp", std::process::id()));
        fs::write(&temporary, text)?;
        fs::rename(&temporary, folder.join(name))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// The path of a new folder.
    fn folder(name: &str) -> PathBuf {
        let name = format!("implant-preview-pins-{name}-{}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        let _ = fs::remove_dir_all(&folder);
        folder.join("data")
    }

    fn window(folder: &Path) -> Window {
        let app =
            App::new(&egui::Context::default(), None, Scene::default(), beside_window).unwrap();
        Window::new(app, Folder(Some(folder.to_owned())))
    }

    /// Draws a frame.
    fn frame(window: &mut Window) {
        let ctx = egui::Context::default();
        let mut output = ctx.run_ui(egui::RawInput::default(), |ui| {
            window.app.show(ui);
            window.keep(false);
        });
        output.textures_delta.clear();
    }

    #[test]
    fn the_window_has_the_icon_of_the_page() {
        let icon = icon().unwrap();
        assert_eq!((icon.width, icon.height), (192, 192));
    }

    #[test]
    fn plan_and_pins_are_in_the_next_window_and_an_invalid_file_is_not_touched() {
        let folder = folder("next");
        let mut first = window(&folder);
        assert!(first.app.session().pins().is_empty() && !folder.join(Folder::PINS).exists());
        let scene = Scene::default();
        let json = serde_json::json!({ "implant": { "base_radius_mm": 50.0 },
            "pins": [{ "name": "before", "scene": scene }] });
        first.app.open(json.to_string()).unwrap();
        frame(&mut first);
        first.keep(true);
        let second = window(&folder);
        assert_eq!(second.app.session().scene().implant.base_radius_mm.to_bits(), 50f64.to_bits());
        let pins = second.app.session().pins();
        assert_eq!((pins.len(), pins[0].name(), pins[0].scene()), (1, "before", &scene));

        fs::write(folder.join(Folder::PINS), [0xff; 9]).unwrap();
        let mut third = window(&folder);
        frame(&mut third);
        third.keep(true);
        assert!(third.app.session().pins().is_empty());
        assert_eq!(fs::read(folder.join(Folder::PINS)).unwrap(), [0xff; 9]);
        fs::remove_dir_all(folder.parent().unwrap()).unwrap();
    }

    #[test]
    fn a_folder_in_place_of_the_file_is_reported_once() {
        let folder = folder("folder");
        fs::create_dir_all(folder.join(Folder::PINS)).unwrap();
        let mut window = window(&folder);
        frame(&mut window);
        window.keep(true);
        assert!(window.app.session().pins().is_empty());
        fs::remove_dir_all(folder.parent().unwrap()).unwrap();
    }
}

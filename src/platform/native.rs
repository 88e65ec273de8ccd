//! The desktop window, and the files that keep plan and pins for the next start.

use super::runner;
use crate::app::App;
use crate::scene::{MAX_SCENE_BYTES, Scene};
use eframe::{egui, glow};
use std::fs;
use std::io::{self, ErrorKind, Read as _};
use std::path::PathBuf;

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
        Box::new(|cc| {
            let (ctx, gl) = (&cc.egui_ctx, cc.gl.as_ref());
            let app = App::new(ctx, gl, Scene::opening(), runner::beside_window)?;
            Ok(Box::new(Window::new(app, Store::of_user())))
        }),
    )
}

/// The app in its window.
struct Window {
    app: App,
    store: Option<Store>,
}

impl Window {
    fn new(mut app: App, store: Option<Store>) -> Self {
        // The texts of the notices below are in this language.
        let kept = store.as_ref().and_then(|store| store.read(LANGUAGE).ok().flatten());
        app.restore_language(kept.as_deref());
        for file in [PLAN, PINS, SHELF] {
            match store.as_ref().map(|store| store.read(file)) {
                Some(Ok(Some(text))) if file == PLAN => app.restore_plan(&text),
                Some(Ok(Some(text))) if file == SHELF => app.restore_shelf(&text),
                Some(Ok(Some(text))) => app.restore_pins(&text),
                Some(Ok(None)) | None => {}
                Some(Err(_)) => app.report_storage_failure(),
            }
        }
        Self { app, store }
    }

    fn keep(&mut self, is_closing: bool) {
        for (file, text) in [
            (PLAN, self.app.take_plan_to_store(is_closing)),
            (PINS, self.app.take_pins_to_store(is_closing)),
            (SHELF, self.app.take_shelf_to_store(is_closing)),
            (LANGUAGE, self.app.take_language_to_store()),
        ] {
            if let Some(text) = text
                && self.store.as_ref().is_none_or(|store| store.write(file, &text).is_err())
            {
                self.app.report_storage_failure();
            }
        }
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

/// Names of the files of the kept plan, pins, shelf and language.
const PLAN: &str = "plan.json";
const PINS: &str = "pins.json";
const SHELF: &str = "shelf.csv";
const LANGUAGE: &str = "language.txt";

/// The folder of the kept texts.
struct Store(PathBuf);

impl Store {
    /// The folder in the user's folder for data of programs, if the system has such a folder.
    fn of_user() -> Option<Self> {
        Some(Self(dirs::data_dir()?.join("implant-preview")))
    }

    /// The stored text of a file; `None` without the file.
    fn read(&self, file: &str) -> io::Result<Option<String>> {
        let file = match fs::File::open(self.0.join(file)) {
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            file => file?,
        };
        let mut bytes = Vec::new();
        // One byte more than allowed: the reader rejects the text.
        file.take(MAX_SCENE_BYTES as u64 + 1).read_to_end(&mut bytes)?;
        Ok(Some(String::from_utf8_lossy(&bytes).into_owned()))
    }

    /// Replaces the text of a file as a whole: another start never reads a part of the text.
    fn write(&self, file: &str, text: &str) -> io::Result<()> {
        fs::create_dir_all(&self.0)?;
        let temporary = self.0.join(format!("{file}.{}.tmp", std::process::id()));
        fs::write(&temporary, text)?;
        fs::rename(&temporary, self.0.join(file))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A store in a new folder.
    fn store(name: &str) -> Store {
        let name = format!("implant-preview-pins-{name}-{}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        let _ = fs::remove_dir_all(&folder);
        Store(folder.join("data"))
    }

    fn window(store: &Store) -> Window {
        let app =
            App::new(&egui::Context::default(), None, Scene::default(), runner::beside_window)
                .unwrap();
        Window::new(app, Some(Store(store.0.clone())))
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
    fn plan_and_pins_are_in_the_next_window_and_an_invalid_file_is_not_touched() {
        let store = store("next");
        let mut first = window(&store);
        assert!(first.app.session().pins().is_empty() && store.read(PINS).unwrap().is_none());
        let scene = Scene::default();
        let json = serde_json::json!({ "implant": { "base_radius_mm": 50.0 },
            "pins": [{ "name": "before", "scene": scene }] });
        first.app.open(json.to_string()).unwrap();
        frame(&mut first);
        first.keep(true);
        let second = window(&store);
        assert_eq!(second.app.session().scene().implant.base_radius_mm.to_bits(), 50f64.to_bits());
        let pins = second.app.session().pins();
        assert_eq!((pins.len(), pins[0].name(), pins[0].scene()), (1, "before", &scene));

        fs::write(store.0.join(PINS), [0xff; 9]).unwrap();
        let mut third = window(&store);
        frame(&mut third);
        third.keep(true);
        assert!(third.app.session().pins().is_empty());
        assert_eq!(fs::read(store.0.join(PINS)).unwrap(), [0xff; 9]);
        fs::remove_dir_all(store.0.parent().unwrap()).unwrap();
    }

    #[test]
    fn a_folder_in_place_of_the_file_is_reported_once() {
        let store = store("folder");
        fs::create_dir_all(store.0.join(PINS)).unwrap();
        let mut window = window(&store);
        frame(&mut window);
        window.keep(true);
        assert!(window.app.session().pins().is_empty());
        fs::remove_dir_all(store.0.parent().unwrap()).unwrap();
    }
}

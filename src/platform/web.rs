//! The page: starts the app on the canvas and gives it to JavaScript as `window.implantPreview`.

use crate::app::App;
use crate::scene::Scene;
use eframe::WebRunner;
use std::cell::RefCell;
use std::rc::Rc;
use wasm_bindgen::prelude::*;

/// The canvas that the page has for the app.
const CANVAS: &str = "implant-preview-canvas";

/// Starts the app, where there is a page for it: a worker only calls the functions of the API. What
/// goes wrong is shown by the page.
pub fn run() {
    std::panic::set_hook(Box::new(|info| crashed(&info.to_string())));
    if web_sys::window().is_none() {
        return;
    }
    wasm_bindgen_futures::spawn_local(async {
        if let Err(error) = start(Scene::default()).await {
            let text = error.as_string().unwrap_or_else(|| format!("{error:?}"));
            crashed(&text);
        }
    });
}

/// Shows the page's crash message.
fn crashed(message: &str) {
    let hook = js_sys::Reflect::get(&js_sys::global(), &"implantPreviewCrashed".into());
    if let Ok(Ok(hook)) = hook.map(JsCast::dyn_into::<js_sys::Function>) {
        // Nothing is left to tell it to if this fails too.
        let _ = hook.call1(&JsValue::NULL, &message.into());
    }
}

fn document() -> Result<web_sys::Document, JsValue> {
    web_sys::window()
        .and_then(|window| window.document())
        .ok_or_else(|| JsValue::from_str("there is no document"))
}

async fn start(scene: Scene) -> Result<(), JsValue> {
    let canvas: web_sys::HtmlCanvasElement = document()?
        .get_element_by_id(CANVAS)
        .ok_or_else(|| JsValue::from_str("the page has no canvas"))?
        .dyn_into()?;
    let runner = WebRunner::new();
    // The runner installs a hook of its own: ours comes after it.
    std::panic::set_hook(Box::new(|info| crashed(&info.to_string())));
    let options = eframe::WebOptions {
        renderer: eframe::Renderer::Glow,
        depth_buffer: 24,
        ..Default::default()
    };
    let create: eframe::AppCreator<'static> = Box::new(move |cc| {
        Ok(Box::new(Page {
            app: App::new(&cc.egui_ctx, cc.gl.as_ref(), scene)?,
            summary: String::new(),
            is_loading: true,
        }))
    });
    runner.start(canvas.clone(), options, create).await?;
    restart_on_context_loss(&canvas, &runner)?;
    let handle = Handle { runner };
    js_sys::Reflect::set(&js_sys::global(), &"implantPreview".into(), &handle.into())?;
    Ok(())
}

/// A lost WebGL context takes the picture with it; when it is back, the app starts again on the
/// scene it had.
fn restart_on_context_loss(
    canvas: &web_sys::HtmlCanvasElement,
    runner: &WebRunner,
) -> Result<(), JsValue> {
    let kept: Rc<RefCell<Option<Scene>>> = Rc::default();
    let (keep, lost_runner) = (Rc::clone(&kept), runner.clone());
    let lost = Closure::<dyn FnMut(web_sys::Event)>::new(move |event: web_sys::Event| {
        // Without this the browser does not give a new context.
        event.prevent_default();
        let scene = lost_runner.app_mut::<Page>().map(|page| page.app.session().scene().clone());
        if let Some(scene) = scene {
            keep.replace(Some(scene));
        }
        lost_runner.destroy();
    });
    let restored = Closure::<dyn FnMut()>::new(move || {
        if let Some(scene) = kept.take() {
            wasm_bindgen_futures::spawn_local(async move {
                if let Err(error) = start(scene).await {
                    crashed(&format!("{error:?}"));
                }
            });
        }
    });
    canvas.add_event_listener_with_callback("webglcontextlost", lost.as_ref().unchecked_ref())?;
    canvas.add_event_listener_with_callback(
        "webglcontextrestored",
        restored.as_ref().unchecked_ref(),
    )?;
    // They live as long as the page.
    lost.forget();
    restored.forget();
    Ok(())
}

/// The app and what the page around it shows.
struct Page {
    app: App,
    summary: String,
    is_loading: bool,
}

impl eframe::App for Page {
    fn ui(&mut self, ui: &mut eframe::egui::Ui, frame: &mut eframe::Frame) {
        self.app.ui(ui, frame);
        // The second frame proves that the first one was painted.
        if self.is_loading && self.app.stats().frames > 1 {
            self.is_loading = false;
            if let Some(loading) = document().ok().and_then(|d| d.get_element_by_id("loading")) {
                loading.remove();
            }
        } else if self.is_loading {
            ui.ctx().request_repaint();
        }
        let summary = self.app.summary();
        if summary != self.summary
            && let Some(element) =
                document().ok().and_then(|d| d.get_element_by_id("implant-preview-summary"))
        {
            element.set_text_content(Some(&summary));
            self.summary = summary;
        }
    }

    fn on_exit(&mut self, gl: Option<&eframe::glow::Context>) {
        self.app.on_exit(gl);
    }

    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }
}

/// `window.implantPreview`: the running app, for scripts and tests.
#[wasm_bindgen]
pub struct Handle {
    runner: WebRunner,
}

#[wasm_bindgen]
impl Handle {
    fn page<T>(&self, read: impl FnOnce(&mut App) -> T) -> Result<T, JsError> {
        let mut page =
            self.runner.app_mut::<Page>().ok_or_else(|| JsError::new("the app is not running"))?;
        Ok(read(&mut page.app))
    }

    /// The scene on the table (JSON text).
    ///
    /// # Errors
    /// Throws if the app is not running.
    pub fn scene(&self) -> Result<String, JsError> {
        self.page(|app| app.session().scene().to_json())
    }

    /// Puts a scene (JSON text) on the table.
    ///
    /// # Errors
    /// Throws an `Error` with one line that names the field; the scene is then as before.
    #[wasm_bindgen(js_name = setScene)]
    pub fn set_scene(&self, json: String) -> Result<(), JsError> {
        self.page(|app| app.open(json))??;
        if let Some(page) = self.runner.app_mut::<Page>() {
            page.app.wake();
        }
        Ok(())
    }

    /// The result of the last finished solve (JSON text), or `undefined` before the first.
    ///
    /// # Errors
    /// Throws if the app is not running.
    pub fn result(&self) -> Result<Option<String>, JsError> {
        self.page(|app| app.outcome().and_then(|o| serde_json::to_string(&o).ok()))
    }

    /// `{ frames, frame_ms_p50, frame_ms_p95, solve_ms, solver_ms_p50, solver_ms_p95, converged, solves,
    /// work_units, tables, measurements }`.
    ///
    /// # Errors
    /// Throws if the app is not running.
    pub fn stats(&self) -> Result<JsValue, JsError> {
        let stats = self.page(|app| app.stats())?;
        let object = js_sys::Object::new();
        for (name, value) in [
            ("frames", JsValue::from(stats.frames as f64)),
            ("frame_ms_p50", stats.frame_ms_p50.into()),
            ("frame_ms_p95", stats.frame_ms_p95.into()),
            ("solve_ms", stats.solve_ms.into()),
            ("solver_ms_p50", stats.solver_ms_p50.into()),
            ("solver_ms_p95", stats.solver_ms_p95.into()),
            ("converged", stats.converged.into()),
            ("solves", JsValue::from(stats.solves as f64)),
            ("work_units", stats.work_units.into()),
            ("tables", JsValue::from(stats.tables as f64)),
            ("measurements", JsValue::from(stats.measurements as f64)),
        ] {
            // Setting a field of a fresh object does not fail.
            let _ = js_sys::Reflect::set(&object, &name.into(), &value);
        }
        Ok(object.into())
    }
}

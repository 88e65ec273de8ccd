//! The page: runs the app on the canvas, restores it after the loss of the WebGL context, suspends it
//! while the tab is hidden, and exports it to JavaScript as `window.implantPreview`.
//!
//! Plan and pins are kept in the browser's storage of the tab and in that of the page's origin, with which a new tab starts; shelf and
//! language are those of the origin.
//!
//! After a crash of the app only JavaScript remains: `web/crash.js`, which gets every new scene and
//! every panic message.

mod handle;

use crate::app::App;
use crate::platform::keep::{self, Store, Texts};
use crate::platform::workers::Workers;
use crate::scene::Scene;
use eframe::WebRunner;
use eframe::egui::FocusDirection;
use handle::{Handle, Host};
use std::cell::{Cell, RefCell, RefMut};
use wasm_bindgen::prelude::*;

/// Id of the canvas of the app.
const CANVAS: &str = "implant-preview-canvas";
/// Id of the result in words; in the Tab order it follows the app's last control.
const SUMMARY: &str = "implant-preview-summary";
const NOTICE: &str = "implant-preview-notice";
/// Time without a change after which the result in words is passed to the page \[s\].
const SUMMARY_REST_S: f64 = 0.6;
/// Id of the link before the app; in the Tab order it precedes the app's first control.
const SKIP: &str = "implant-preview-skip";

/// Initial size of the heap \[bytes\], above that of a session at 129 nodes per side.
const HEAP: usize = 26 << 20;

/// Starts the app if there is a page; a worker only calls the functions of the API. The page shows
/// errors.
pub fn run() {
    std::panic::set_hook(Box::new(|info| {
        let message = info.payload_as_str().unwrap_or("panic");
        let location =
            info.location().map(|at| format!(" ({}:{})", source_path(at.file()), at.line()));
        call("implantPreviewCrashed", &format!("{message}{}", location.unwrap_or_default()));
    }));
    if web_sys::window().is_none() {
        return;
    }
    reserve_heap();
    wasm_bindgen_futures::spawn_local(async {
        match PageHost::new() {
            Ok(host) => host.start().await,
            Err(error) => show_crash(&error),
        }
    });
}

/// Grows the memory once at the start. Otherwise it would grow in steps for minutes, and each step
/// detaches the array views of scripts.
fn reserve_heap() {
    let mut room = Vec::<u8>::new();
    // Without so much memory, the heap grows on demand.
    let _ = room.try_reserve_exact(HEAP);
    std::hint::black_box(&room);
}

/// Shortens a source path to the part below the folders of the build machine.
fn source_path(path: &str) -> &str {
    path.rsplit_once("/registry/src/")
        .and_then(|(_, path)| path.split_once('/'))
        .map_or(path, |(_, path)| path)
}

/// Calls a function of the page, if it exists; errors cannot be reported any further.
fn call(function: &str, text: &str) -> JsValue {
    js_sys::Reflect::get(&js_sys::global(), &function.into())
        .and_then(JsCast::dyn_into::<js_sys::Function>)
        .and_then(|function| function.call1(&JsValue::NULL, &text.into()))
        .unwrap_or_default()
}

/// Shows the crash message of the page.
fn show_crash(error: &JsValue) {
    let text = error.as_string().unwrap_or_else(|| format!("{error:?}"));
    call("implantPreviewCrashed", &text);
}

/// The storage of the page's origin on this machine. Some browsers refuse the storage in private windows.
struct Origin;

impl Store for Origin {
    const PLAN: &'static str = "implant-preview/plan/1";
    const PINS: &'static str = "implant-preview/pins/1";
    const SHELF: &'static str = "implant-preview/shelf/1";
    const PRACTICE: &'static str = "implant-preview/practice/1";
    /// `web/language.js` reads this text.
    const LANGUAGE: &'static str = "implant-preview/language/1";
    const RESEARCH: &'static str = "implant-preview/research/1";
    type Error = JsValue;

    /// A missing storage is reported with the first change.
    fn read(&self, name: &str) -> Result<Option<String>, JsValue> {
        let text = storages().and_then(|[tab, shared]| {
            if is_of_tab(name) { keep::read_of_tab(&tab, &shared, name) } else { shared.get(name) }
        });
        Ok(text.ok().flatten())
    }

    fn write(&self, name: &str, text: &str) -> Result<(), JsValue> {
        let [tab, shared] = storages()?;
        if is_of_tab(name) {
            return keep::write_of_tab(&tab, &shared, name, text);
        }
        shared.set(name, text)
    }
}

impl Texts for web_sys::Storage {
    type Error = JsValue;

    fn get(&self, name: &str) -> Result<Option<String>, JsValue> {
        self.get_item(name)
    }

    fn set(&self, name: &str, text: &str) -> Result<(), JsValue> {
        self.set_item(name, text)
    }
}

/// Does a text belong to the tab rather than to all tabs of the origin?
fn is_of_tab(name: &str) -> bool {
    [Origin::PLAN, Origin::PINS].contains(&name)
}

/// The storages of the tab and of the origin.
fn storages() -> Result<[web_sys::Storage; 2], JsValue> {
    let window = web_sys::window().ok_or("the page has no window")?;
    let none = "the browser has no storage";
    Ok([window.session_storage()?.ok_or(none)?, window.local_storage()?.ok_or(none)?])
}

/// Opens the plan of a link, if the page's address has one, and drops it from the address: a reload opens the kept plan.
fn open_link(app: &mut App) -> Result<(), JsValue> {
    let window = web_sys::window().ok_or("the page has no window")?;
    let location = window.location();
    let page = format!("{}{}", location.pathname()?, location.search()?);
    app.set_page_address(format!("{}{page}", location.origin()?));
    if app.open_link(&location.hash()?) {
        window.history()?.replace_state_with_url(&JsValue::NULL, "", Some(&page))?;
    }
    Ok(())
}

fn document() -> Result<web_sys::Document, JsValue> {
    web_sys::window()
        .and_then(|window| window.document())
        .ok_or_else(|| JsValue::from_str("the page has no document"))
}

/// Moves the keyboard focus to an element of the page after this frame; during the frame the runner would
/// take the focus back.
fn focus(id: &'static str) {
    let callback = Closure::once_into_js(move || {
        let element = document().ok().and_then(|document| document.get_element_by_id(id));
        if let Some(element) = element.and_then(|e| e.dyn_into::<web_sys::HtmlElement>().ok()) {
            let _ = element.focus();
        }
    });
    if let Some(window) = web_sys::window() {
        let _ = window.set_timeout_with_callback(callback.unchecked_ref());
    }
}

/// State with the lifetime of the page. The app outlives the runner, which ends with its WebGL context.
struct PageHost {
    canvas: web_sys::HtmlCanvasElement,
    runner: WebRunner,
    app: RefCell<Option<App>>,
    /// Borrowed while the tab is hidden: the runner finds no app, draws nothing and sets no timer.
    paused_app: RefCell<Option<RefMut<'static, PageApp>>>,
    /// Is the WebGL context lost? There is no runner then.
    is_lost: Cell<bool>,
}

impl PageHost {
    fn new() -> Result<&'static Self, JsValue> {
        let canvas = document()?
            .get_element_by_id(CANVAS)
            .ok_or_else(|| JsValue::from_str("the page has no canvas"))?
            .dyn_into()?;
        let host: &Self = Box::leak(Box::new(Self {
            canvas,
            runner: WebRunner::new(),
            app: RefCell::default(),
            paused_app: RefCell::default(),
            is_lost: Cell::default(),
        }));
        let listen =
            |target: &web_sys::EventTarget, name, handler: fn(&'static Self, web_sys::Event)| {
                let closure = Closure::<dyn FnMut(_)>::new(move |event| handler(host, event));
                let handler = closure.into_js_value();
                target.add_event_listener_with_callback(name, handler.unchecked_ref())
            };
        listen(&host.canvas, "webglcontextlost", Self::on_context_lost)?;
        listen(&*document()?, "focusin", Self::on_focus_in)?;
        listen(&host.canvas, "webglcontextrestored", Self::on_context_restored)?;
        let window = web_sys::window().ok_or("the page has no window")?;
        // The runner listens on the document. Its handler must run before the app is borrowed, and after
        // the app is returned: the window's handlers run last and first.
        listen(&window, "visibilitychange", |host, _| host.update_pause())?;
        listen(&window, "hashchange", |host, _| {
            if let Ok(mut app) = host.app() {
                let _ = open_link(&mut app);
            }
        })?;
        let closure = Closure::<dyn FnMut()>::new(move || drop(host.paused_app.take()));
        let handler = closure.into_js_value();
        window.add_event_listener_with_callback_and_bool(
            "visibilitychange",
            handler.unchecked_ref(),
            true,
        )?;
        Ok(host)
    }

    /// Starts the runner with the scene kept from a crash, with the opening plan, or with the app that
    /// has lost its context.
    async fn start(&'static self) {
        let options = eframe::WebOptions {
            renderer: eframe::Renderer::Glow,
            depth_buffer: 24,
            ..Default::default()
        };
        let create: eframe::AppCreator<'static> = Box::new(move |cc| {
            let mut app = self.app.borrow_mut();
            if let Some(app) = &mut *app {
                app.move_to(&cc.egui_ctx, cc.gl.as_ref());
            } else {
                let before = call("implantPreviewKept", "").as_string();
                // A kept text may be no valid scene.
                let before = before.and_then(|json| Scene::from_json(&json).ok());
                let is_kept = before.is_some();
                let (ctx, gl) = (&cc.egui_ctx, cc.gl.as_ref());
                let scene = before.unwrap_or_else(Scene::first_plan);
                let new = App::new(ctx, gl, scene, |wake| Box::new(Workers::new(move || wake())))?;
                let new = app.insert(new);
                keep::restore_preferences(new, &Origin);
                new.enable_page_navigation();
                if is_kept {
                    new.notify_restart();
                } else {
                    keep::restore(new, &Origin);
                    // Without a location, in some embedded views, there is no link.
                    let _ = open_link(new);
                }
            }
            Ok(Box::new(PageApp {
                host: self,
                summary: String::new(),
                next_summary: (String::new(), 0.0),
                notice: String::new(),
                scene: None,
                plan: String::new(),
                language: "",
                is_loading: true,
                has_still: true,
                is_decimal_keyboard: false,
            }))
        });
        if let Err(error) = self.runner.start(self.canvas.clone(), options, create).await {
            show_crash(&error);
            return;
        }
        self.update_pause();
        let handle = JsValue::from(Handle::new(self));
        // Setting a property of the global object does not fail.
        let _ = js_sys::Reflect::set(&js_sys::global(), &"implantPreview".into(), &handle);
    }

    /// Handles a focus change to the canvas, or to the hidden input field, from an element before or
    /// after the app.
    fn on_focus_in(&'static self, event: web_sys::Event) {
        let id = |target: Option<web_sys::EventTarget>| {
            target.and_then(|t| t.dyn_into::<web_sys::Element>().ok()).map(|element| element.id())
        };
        let from = event.unchecked_ref::<web_sys::FocusEvent>().related_target();
        let direction = match id(from).as_deref() {
            Some(SKIP) => FocusDirection::Next,
            Some(SUMMARY) => FocusDirection::Previous,
            _ => return,
        };
        let is_app = id(event.target()).is_some_and(|id| id == CANVAS || id.is_empty());
        if is_app
            && let Ok(mut app) = self.app.try_borrow_mut()
            && let Some(app) = &mut *app
        {
            app.enter(direction);
        }
    }

    /// The hidden input field beside the canvas, which receives typed text.
    fn key_field(&self) -> Option<web_sys::Element> {
        self.canvas.next_element_sibling().filter(|element| element.tag_name() == "INPUT")
    }

    fn on_context_lost(&'static self, event: web_sys::Event) {
        // Otherwise the browser does not restore the context.
        event.prevent_default();
        self.is_lost.set(true);
        self.paused_app.take();
        self.runner.destroy();
    }

    fn on_context_restored(&'static self, _: web_sys::Event) {
        self.is_lost.set(false);
        wasm_bindgen_futures::spawn_local(self.start());
    }

    /// Suspends the app while the tab is hidden.
    fn update_pause(&'static self) {
        self.paused_app.take();
        if document().is_ok_and(|document| document.hidden()) && !self.is_lost.get() {
            *self.paused_app.borrow_mut() = self.runner.app_mut::<PageApp>();
            if let Ok(mut app) = self.app.try_borrow_mut()
                && let Some(app) = &mut *app
            {
                app.mark_paused();
                // A tab is hidden before a reload or its end.
                keep::keep(app, &Origin, true);
            }
        }
    }
}

impl Host for PageHost {
    fn app(&self) -> Result<RefMut<'_, App>, JsError> {
        let has_runner = self.is_lost.get()
            || self.paused_app.borrow().is_some()
            || self.runner.app_mut::<PageApp>().is_some();
        let app = self.app.try_borrow_mut().ok().filter(|_| has_runner);
        app.and_then(|app| RefMut::filter_map(app, Option::as_mut).ok())
            .ok_or_else(|| JsError::new("the app is not running"))
    }

    fn focus_picture(&self) {
        let _ = self.canvas.focus();
    }
}

/// The app in its runner, and the state of the page around it.
struct PageApp {
    host: &'static PageHost,
    /// The words of the page, and those that replace them once they have not changed for a while, with the time of
    /// their last change \[s\].
    summary: String,
    next_summary: (String, f64),
    /// The words of the notice last passed to the page.
    notice: String,
    /// The last scene passed to the page.
    scene: Option<Scene>,
    /// The fields of the plan last passed to the page's form.
    plan: String,
    /// The language last passed to the page.
    language: &'static str,
    is_loading: bool,
    /// Does the page show the still picture of the opening plan?
    has_still: bool,
    /// Does the touch screen show a numeric keyboard?
    is_decimal_keyboard: bool,
}

impl eframe::App for PageApp {
    fn ui(&mut self, ui: &mut eframe::egui::Ui, frame: &mut eframe::Frame) {
        let mut app = self.host.app.borrow_mut();
        let Some(app) = &mut *app else { return };
        app.ui(ui, frame);
        // A second frame shows that the first frame was painted.
        if self.is_loading && app.stats().frames > 1 {
            self.is_loading = false;
            remove_element("loading");
        } else if self.is_loading {
            ui.ctx().request_repaint();
        }
        // The still picture stays until the app has drawn a shape, or draws none.
        let session = app.session();
        let has_picture = session.displayed_problem().is_some() || !session.is_working();
        if self.has_still && !self.is_loading && has_picture {
            self.has_still = false;
            remove_element("still");
        }
        if app.has_number_focus() != self.is_decimal_keyboard
            && let Some(field) = self.host.key_field()
        {
            self.is_decimal_keyboard = !self.is_decimal_keyboard;
            let mode = if self.is_decimal_keyboard { "decimal" } else { "text" };
            // Setting an attribute with a valid name does not fail.
            let _ = field.set_attribute("inputmode", mode);
        }
        if let Some(direction) = app.take_focus_exit() {
            focus(if direction == FocusDirection::Next { SUMMARY } else { SKIP });
        }
        // After the frame: a scene that crashes the app in its first frame is not kept.
        let scene = app.session().scene();
        let is_edited = self.scene.as_ref().is_some_and(|before| !before.is_same_plan(scene));
        if self.scene.as_ref() != Some(scene) {
            // For a start after a crash, in the browser's storage: the visit is in the plan's file only.
            call("implantPreviewKeep", &scene.without_visit().to_json());
            self.scene = Some(scene.clone());
        }
        let language = app.language();
        if self.language != language {
            call("implantPreviewLanguage", language);
            self.language = language;
        }
        let plan = app.plan_json();
        if self.plan != plan {
            call("implantPreviewPlan", &plan);
            self.plan = plan;
        }
        keep::keep(app, &Origin, false);
        let notice = app.notice_in_words();
        if self.notice != notice {
            set_text(NOTICE, &notice);
            self.notice = notice;
        }
        self.update_summary(ui, app.summary(), is_edited.then(|| app.updating()));
    }

    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }
}

/// Removes an element of the page, if present.
fn remove_element(id: &str) {
    if let Some(element) = document().ok().and_then(|d| d.get_element_by_id(id)) {
        element.remove();
    }
}

/// Sets the text of an element of the page, if present.
fn set_text(id: &str, text: &str) {
    if let Some(element) = document().ok().and_then(|d| d.get_element_by_id(id)) {
        element.set_text_content(Some(text));
    }
}

impl PageApp {
    /// Passes the words of the answer to screen readers, once the words rest: an edit would be read as many changes. `updating`: the
    /// words in their place from an edit on, which the words of the plan before do not outlive.
    fn update_summary(
        &mut self,
        ui: &eframe::egui::Ui,
        summary: String,
        updating: Option<&'static str>,
    ) {
        if let Some(updating) = updating.filter(|words| self.summary != *words) {
            set_text(SUMMARY, updating);
            updating.clone_into(&mut self.summary);
        }
        let now = ui.input(|input| input.time);
        let (next, since) = &mut self.next_summary;
        if *next != summary {
            (*next, *since) = (summary, now);
        }
        if *next == self.summary {
            return;
        }
        let wait = SUMMARY_REST_S - (now - *since);
        if wait > 0.0 {
            ui.ctx().request_repaint_after_secs(wait as f32);
        } else {
            set_text(SUMMARY, next);
            self.summary.clone_from(next);
        }
    }
}

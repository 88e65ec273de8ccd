//! The app: panels around the 3-D view, on the desktop and in the page.
//!
//! Panels edit a copy of the scene; the app turns the difference into one [`Command`] for the
//! [`Session`], and solves for one slice of a few milliseconds between the plan and what shows its results.
//! At rest the app neither solves nor draws.
//!
//! This file contains the state of the app and its interface to `platform` and the tests. `logic` runs
//! frames, `ui` arranges the screen: `plan` with `volume_marks`, `volume_band` and `shelf_largest`, `advanced` with `fat` and `curve_editor` on the left, `viewport` with
//! `view_bar` or `range` in the middle, `answer` or `no_answer`, `filling` with `fill_steps`, `uncertainty`, `details` and `plots` on the right.
//! `commands` is the table of all commands, for menus, keys and `palette`; `strip` is the cross-section under the picture, `handles` drags the
//! implant on it.
//! `messages` shows notices and the pages without a picture; `report` saves picture and report, `numbers` all results as a table; `controls` finds controls by
//! name for scripts; `clipboard` reads a pasted table.
//!
//! Uses all modules to its left. Used by `platform`.

mod advanced;
mod answer;
mod clipboard;
mod commands;
mod compare;
mod controls;
mod curve_editor;
mod details;
mod device;
mod differing;
mod fat;
mod files;
mod fill_steps;
mod filling;
mod focus;
mod handles;
mod keys;
mod link;
mod logic;
mod messages;
mod no_answer;
mod numbers;
mod palette;
mod plan;
mod plots;
mod range;
mod report;
mod shelf_largest;
mod stability;
mod stats;
mod status;
mod strip;
mod studies;
mod texts;
mod theme;
mod toolbar;
mod ui;
mod uncertainty;
mod view_bar;
mod viewport;
mod volume_band;
mod volume_marks;
mod volumes;
mod widgets;

pub use stats::Stats;
pub use studies::{JobRunner, Wake};

use crate::measure::Outcome;
use crate::scene::{Scene, SceneError};
use crate::session::{Command, CommandError, Record, Session};
use compare::{Compare, Keep};
use curve_editor::CurveWindow;
use eframe::{egui, glow};
use egui::FocusDirection;
use files::Files;
use filling::Filling;
use focus::Focus;
use logic::{Press, RunningSolve};
use messages::Notice;
use no_answer::NearestSearch;
use palette::Palette;
use range::Range;
use shelf_largest::ShelfLargest;
use status::Timing;
use std::sync::Arc;
use studies::Studies;
use texts::{LanguageChoice, tr};
use ui::{NarrowTab, PanelWidths};
use uncertainty::Uncertainty;
use viewport::Viewport;
use volume_marks::VolumeMarks;

/// The app.
pub struct App {
    ctx: egui::Context,
    session: Session,
    viewport: Viewport,
    options: viewport::Options,
    compare: Compare,
    keep: Keep,
    files: Files,
    timing: Timing,
    studies: Studies,
    range: Range,
    filling: Filling,
    volume_marks: VolumeMarks,
    shelf_largest: ShelfLargest,
    uncertainty: Uncertainty,
    nearest: NearestSearch,
    language: LanguageChoice,
    notice: Option<Notice>,
    /// Notice about a position requested in this frame that does not fit the pocket.
    position_notice: Option<Notice>,
    focus: Focus,
    /// The running drag of a handle on the picture.
    drag: Option<handles::Drag>,
    press: Press,
    solving: Option<RunningSolve>,
    /// Copy of the scene that the panels edit, kept between frames.
    draft: Option<Scene>,
    /// Did a command replace the session's scene after the draft was made? The draft is then outdated.
    is_scene_replaced: bool,
    /// Has this frame solved for a slice?
    has_solved: bool,
    /// Was the slider of the insertion moved in the previous frame? The slice then waits for the slider.
    is_inserting: bool,
    plan: plan::Choices,
    /// Was the plan edited since the start? Then the hint is gone.
    is_edited: bool,
    is_playing: bool,
    /// Was drawing suspended since the previous frame?
    was_paused: bool,
    /// Number of the present gesture; edits of one gesture are one step of the history.
    gesture: u64,
    /// The text field of the visit with the focus, in this frame and in the previous one.
    typing: (Option<egui::Id>, Option<egui::Id>),
    narrow_tab: NarrowTab,
    panel_widths: PanelWidths,
    show_help: bool,
    palette: Palette,
    /// Is the cross-section shown under the picture where there is room?
    show_strip: bool,
    curve_window: Option<CurveWindow>,
    /// Address of the page without its fragment; `None` on the desktop.
    page_address: Option<String>,
    /// Height of the controls on the picture in the previous frame \[points\].
    view_bar_height: f32,
}

impl App {
    /// Creates the app with its first scene. Without `gl`, as in tests, the 3-D view stays empty. `runner` creates the
    /// runner of the studies' jobs.
    ///
    /// # Errors
    /// Returns an error if the scene exceeds its limits.
    pub fn new(
        ctx: &egui::Context,
        gl: Option<&Arc<glow::Context>>,
        scene: Scene,
        runner: impl FnOnce(Wake) -> Box<JobRunner>,
    ) -> Result<Self, SceneError> {
        theme::install(ctx);
        Ok(Self {
            ctx: ctx.clone(),
            keep: Keep::new(scene.clone()),
            session: Session::new(scene)?,
            viewport: Viewport::new(gl),
            options: viewport::Options::default(),
            compare: Compare::default(),
            files: Files::new(),
            timing: Timing::default(),
            studies: Studies::new(ctx, runner),
            range: Range::default(),
            filling: Filling::default(),
            volume_marks: VolumeMarks::default(),
            shelf_largest: ShelfLargest::default(),
            uncertainty: Uncertainty::default(),
            nearest: NearestSearch::default(),
            language: LanguageChoice::default(),
            notice: None,
            position_notice: None,
            focus: Focus::default(),
            drag: None,
            press: Press::default(),
            solving: None,
            draft: None,
            is_scene_replaced: false,
            has_solved: false,
            is_inserting: false,
            plan: plan::Choices::default(),
            is_edited: false,
            is_playing: false,
            was_paused: false,
            gesture: 0,
            typing: (None, None),
            narrow_tab: NarrowTab::Implant,
            panel_widths: PanelWidths::default(),
            show_help: false,
            palette: Palette::default(),
            show_strip: true,
            curve_window: None,
            page_address: None,
            view_bar_height: 40.0,
        })
    }

    /// Moves the app to a new window and graphics context after the loss of the previous one.
    /// Scene, history, camera and choices stay.
    pub fn move_to(&mut self, ctx: &egui::Context, gl: Option<&Arc<glow::Context>>) {
        // The memory of egui: theme, widths of panels, scroll positions. It has no fonts, and would drop those set before.
        let memory = self.ctx.memory(Clone::clone);
        ctx.memory_mut(|own| *own = memory);
        theme::install(ctx);
        self.ctx = ctx.clone();
        self.viewport.move_to(gl);
        self.range.forget_texture();
        self.mark_paused();
    }

    /// Marks that drawing was suspended, for example in a hidden tab: animations ignore the elapsed time.
    pub fn mark_paused(&mut self) {
        self.was_paused = true;
    }

    /// Shows a notice to the user.
    pub fn notify(&mut self, text: &str) {
        self.notice = Some(Notice::info(text));
    }

    /// Shows that the app restarted after a crash.
    pub fn notify_restart(&mut self) {
        // The pins may be the cause of the error.
        self.notice = Some(Notice::caution(tr(
            "The preview restarted after an error, with the scene that was open. A reload opens the kept pins.",
        )));
    }

    /// Lets the Tab key leave the app after its last control, and before its first control backwards.
    pub fn enable_page_navigation(&mut self) {
        self.focus.enable_page_navigation();
    }

    /// Moves the keyboard focus into the app: to the first control (`Next`) or to the last (`Previous`).
    pub fn enter(&mut self, direction: FocusDirection) {
        self.focus.enter(direction);
        self.request_frame();
    }

    /// Returns the direction in which the Tab key has left the app, once.
    pub fn take_focus_exit(&mut self) -> Option<FocusDirection> {
        self.focus.take_exit()
    }

    /// Name of the control with the keyboard focus, and its rectangle \[points\]: left, top, width, height.
    #[must_use]
    pub fn focused(&self) -> Option<(String, [f32; 4])> {
        let (name, rect) = self.focus.focused()?;
        Some((name.to_owned(), [rect.left(), rect.top(), rect.width(), rect.height()]))
    }

    /// Does a number field have the keyboard focus?
    #[must_use]
    pub fn has_number_focus(&self) -> bool {
        widgets::has_number_focus(&self.ctx)
    }

    /// The session: scene, history and shape.
    #[must_use]
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The result of the present scene with the solver's time; `None` during a solve.
    #[must_use]
    pub fn outcome(&self) -> Option<Outcome> {
        let mut outcome = self.session.result()?.clone();
        outcome.solver.time_ms = Some(self.timing.solve_ms);
        Some(outcome)
    }

    /// The result as it is saved (JSON text), with its scene without the visit, the program's version and the date;
    /// `None` during a solve.
    #[must_use]
    pub fn result_json(&self) -> Option<String> {
        let record = Record {
            outcome: self.outcome()?,
            scene: self.session.scene().without_visit(),
            program_version: env!("CARGO_PKG_VERSION"),
            date: files::date(),
        };
        serde_json::to_string_pretty(&record).ok()
    }

    /// The fields of the plan as a list (JSON text): `name`, `label`, `unit`, `text` (the value as shown), `hint`, `range` (the allowed
    /// values in words), and `least` and `most` of a number, the `choices` of a word with their `words` on the screen, or `characters` and `lines` of a text.
    #[must_use]
    pub fn plan_json(&self) -> String {
        let fields = plan::fields(self.session.scene(), &self.plan);
        serde_json::to_string(&fields).unwrap_or_default()
    }

    /// Opens the text of a scene file.
    ///
    /// # Errors
    /// Returns one line that names the invalid field; the scene is then unchanged.
    pub fn open(&mut self, json: String) -> Result<(), CommandError> {
        self.apply(Command::Open(json))
    }

    /// Requests a frame after a change from outside.
    pub fn request_frame(&self) {
        self.ctx.request_repaint();
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        self.show(ui);
    }

    fn on_exit(&mut self, gl: Option<&glow::Context>) {
        self.viewport.destroy(gl);
    }

    #[cfg(target_arch = "wasm32")]
    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }
}

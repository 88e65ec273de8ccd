//! The app: panels around the 3-D view, on the desktop and in the page.
//!
//! Panels read `Shared`, edit a copy of the scene and their own state, and add an `Action` for all else. The app performs the
//! actions, turns the difference of the scenes into one [`Command`] for the [`Session`], and solves for one slice of a few
//! milliseconds between the plan and what shows its results. At rest the app neither solves nor draws.
//!
//! The rooms: `frame` runs frames and arranges the screen; `plan` with the `curve_editor` on the left, `picture` or `range` in the
//! middle, `answer` on the right; `scan` the step in which a body gets its marks; `paper` is what leaves the screen. All use `widgets` and `texts`. This file contains the state of the app.
//!
//! Uses all modules to its left. Used by `platform`.

mod answer;
mod curve_editor;
mod frame;
mod paper;
mod picture;
mod plan;
mod range;
mod scan;
mod texts;
mod widgets;

pub use frame::stats::Stats;
pub use frame::studies::{JobRunner, Wake};

use crate::measure::Outcome;
use crate::scene::{Scene, SceneError, Side};
use crate::session::{Command, CommandError, OtherSide, Record, Session};
use answer::compare::{Compare, Keep};
use answer::filling::Filling;
use answer::measured::Measured;
use answer::no_answer::NearestSearch;
use answer::practice::Practices;
use answer::times::PlanTimes;
use answer::uncertainty::Uncertainty;
use eframe::{egui, glow};
use egui::FocusDirection;
use frame::action::Action;
use frame::files::Files;
use frame::focus::Focus;
use frame::logic::Edits;
use frame::messages::Notice;
use frame::shared::Shared;
use frame::status::Timing;
use frame::studies::Studies;
use frame::ui::{Screen, Windows};
use picture::handles::Handles;
use picture::insertion::Insertion;
use picture::viewport::Viewport;
use plan::volume_marks::VolumeMarks;
use range::Range;
use range::shelf_largest::ShelfLargest;
use scan::Scan;
use std::sync::Arc;
use texts::tr;

/// The app: the state that all panels read, the panels with a state of their own, their actions.
pub struct App {
    ctx: egui::Context,
    shared: Shared,
    /// Actions that are not performed yet.
    actions: Vec<Action>,
    edits: Edits,
    studies: Studies,
    panels: Panels,
    handles: Handles,
    insertion: Insertion,
    screen: Screen,
    windows: Windows,
    /// The scan whose marks are being set, in place of plan and answer.
    scan: Option<Scan>,
    /// Marks that were dropped with a scan, which is still being read.
    early_marks: Option<frame::scan::EarlyMarks>,
    notice: Option<Notice>,
    focus: Focus,
    files: Files,
    keep: Keep,
}

/// The panels with studies of their own.
#[derive(Default)]
struct Panels {
    range: Range,
    filling: Filling,
    times: PlanTimes,
    nearest: NearestSearch,
    shelf_largest: ShelfLargest,
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
        widgets::theme::install(ctx);
        Ok(Self {
            ctx: ctx.clone(),
            keep: Keep::new(scene.clone()),
            shared: Shared {
                session: Session::new(scene)?,
                choices: plan::Choices::default(),
                viewport: Viewport::new(gl),
                options: picture::viewport::Options::default(),
                compare: Compare::default(),
                uncertainty: Uncertainty::default(),
                volume_marks: VolumeMarks::default(),
                measured: Measured::default(),
                practices: Practices::default(),
                timing: Timing::default(),
                solving: None,
                show_strip: true,
                keep_surface: true,
                chosen_plane: None,
                research: false,
                page_address: None,
            },
            actions: Vec::new(),
            edits: Edits::default(),
            studies: Studies::new(ctx, runner),
            panels: Panels::default(),
            handles: Handles::default(),
            insertion: Insertion::default(),
            screen: Screen::default(),
            windows: Windows::default(),
            scan: None,
            early_marks: None,
            notice: None,
            focus: Focus::default(),
            files: Files::new(),
        })
    }

    /// Moves the app to a new window and graphics context after the loss of the previous one.
    /// Scene, history, camera and choices stay.
    pub fn move_to(&mut self, ctx: &egui::Context, gl: Option<&Arc<glow::Context>>) {
        // The memory of egui: theme, widths of panels, scroll positions. It has no fonts, and would drop those set before.
        let memory = self.ctx.memory(Clone::clone);
        ctx.memory_mut(|own| *own = memory);
        widgets::theme::install(ctx);
        self.ctx = ctx.clone();
        self.shared.viewport.move_to(gl);
        self.panels.range.forget_texture();
        self.mark_paused();
    }

    /// Marks that drawing was suspended, for example in a hidden tab: animations ignore the elapsed time.
    pub fn mark_paused(&mut self) {
        self.edits.was_paused = true;
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
        &self.shared.session
    }

    /// The result of the present scene with the solver's time; `None` during a solve.
    #[must_use]
    pub fn outcome(&self) -> Option<Outcome> {
        let mut outcome = self.shared.session.result()?.clone();
        outcome.solver.time_ms = Some(self.shared.timing.solve_ms);
        Some(outcome)
    }

    /// The result as it is saved (JSON text), with its scene without the visit, the program's version and the date;
    /// `None` during a solve.
    #[must_use]
    pub fn result_json(&self) -> Option<String> {
        let Shared { session, measured, .. } = &self.shared;
        let other = session.other_side();
        let sides = [
            (Some(session.scene()), measured.of_plan(session)),
            (other.map(OtherSide::scene), measured.of_other_side(session)),
        ];
        let measures = sides.into_iter().filter_map(|(scene, rows)| {
            let side = if scene?.is_right() { Side::Right } else { Side::Left };
            Some((side.word(), rows?.to_vec()))
        });
        let record = Record {
            outcome: self.outcome()?,
            other_side: other.and_then(OtherSide::outcome).cloned(),
            measures: measures.collect(),
            scene: self.shared.session.scene().without_visit(),
            program_version: env!("CARGO_PKG_VERSION"),
            date: frame::files::date(),
        };
        serde_json::to_string_pretty(&record).ok()
    }

    /// The fields of the plan as a list (JSON text): `name`, `label`, `unit`, `text` (the value as shown), `hint`, `range` (the allowed
    /// values in words), and `least` and `most` of a number, the `choices` of a word with their `words` on the screen, or `characters` and `lines` of a text.
    #[must_use]
    pub fn plan_json(&self) -> String {
        let fields = plan::fields(self.shared.session.scene(), &self.shared.choices);
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
        self.shared.viewport.destroy(gl);
    }

    #[cfg(target_arch = "wasm32")]
    fn as_any_mut(&mut self) -> Option<&mut dyn std::any::Any> {
        Some(self)
    }
}

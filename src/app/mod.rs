//! The window: panels around the 3-D view. The same on the desktop and in the page.
//!
//! Panels edit a copy of the scene; what changed becomes one [`Command`], carried out by the
//! [`Session`]. Solving is cut into slices, so that a frame answers; at rest nothing is solved and
//! nothing is drawn.
//!
//! Uses everything to its left. Used by `platform`.

mod controls;
mod curve_editor;
mod files;
mod focus;
mod keys;
mod notice;
mod plots;
mod readings;
mod stability;
mod status;
mod theme;
mod toolbar;
mod viewport;
mod widgets;

use crate::measure::{Outcome, Status, bands, no_shape as no_shape_reason};
use crate::scene::{Scene, SceneError, Springs};
use crate::session::{Command, Record, Session};
use crate::solve::{Fault, Progress};
use eframe::{egui, glow};
use egui::{FocusDirection, Ui};
use files::{FileEvent, Files};
use focus::{Boundary, Focus};
use notice::{Notice, NoticeAction};
use readings::PreviousResults;
use status::{SliceOf, Timing};
use std::sync::Arc;
use toolbar::Layout;
use viewport::Viewport;
use web_time::{Duration, Instant};
use widgets::{Control, Kind};

/// A frame goes on with solving until this time is over, and the step under way done.
const SLICE: Duration = Duration::from_millis(10);
/// A solve that takes longer than this shows its progress, and the results of before are gone.
const LONG: Duration = Duration::from_millis(400);
/// The longest slice of a long solve, where frames are slow for other reasons than solving.
const LONG_SLICE: Duration = Duration::from_millis(60);
/// The opening scene is solved at once, where that takes no longer.
const FIRST_SLICE: Duration = Duration::from_millis(400);

/// What the page and the tests read off the running app.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stats {
    /// Frames drawn since the start.
    pub frames: u64,
    /// Middle time spent in a frame \[ms\].
    pub frame_ms_p50: f64,
    /// Time that 95 % of the frames stay below \[ms\].
    pub frame_ms_p95: f64,
    /// Time in the solver for the present scene \[ms\].
    pub solve_ms: f64,
    /// Middle time in the solver of a frame that solved \[ms\].
    pub solver_ms_p50: f64,
    /// Time in the solver that 95 % of such frames stay below \[ms\].
    pub solver_ms_p95: f64,
    /// Greatest time in the solver of a frame since the opening scene was solved \[ms\].
    pub solver_ms_max: f64,
    /// Does the picture show the converged shape of the present scene?
    pub converged: bool,
    /// Solves started.
    pub solves: u64,
    /// Solver work so far, in evaluations of all nodal forces.
    pub work_units: f64,
    /// Times that the spring law's tables were made.
    pub tables: u64,
    /// Times that a shape was measured.
    pub measurements: u64,
}

/// A tab of the bottom sheet on narrow screens.
#[derive(Clone, Copy, PartialEq, Eq)]
enum NarrowTab {
    Implant,
    Tissue,
    Results,
    Plots,
}

/// The app.
pub struct App {
    ctx: egui::Context,
    session: Session,
    viewport: Viewport,
    options: viewport::Options,
    files: Files,
    timing: Timing,
    notice: Option<Notice>,
    /// Notice about a position requested in this frame that does not fit the pocket.
    position_notice: Option<Notice>,
    focus: Focus,
    /// When the solve under way was begun, and how far it has come.
    solving: Option<(Instant, f64)>,
    /// The copy of the scene that the panels edit, kept between frames.
    draft: Option<Scene>,
    /// Did a command take the session's scene away from the draft in this frame?
    is_scene_replaced: bool,
    is_hemisphere: bool,
    is_playing: bool,
    /// Has the app been kept from drawing since the frame before?
    was_paused: bool,
    gesture: u64,
    narrow_tab: NarrowTab,
    show_left: bool,
    show_right: bool,
    show_about: bool,
}

impl App {
    /// The app on its opening scene. `gl` is missing in tests: then nothing is drawn in 3-D.
    ///
    /// # Errors
    /// If the scene is out of its limits.
    pub fn new(
        ctx: &egui::Context,
        gl: Option<&Arc<glow::Context>>,
        scene: Scene,
    ) -> Result<Self, SceneError> {
        theme::install(ctx);
        let is_hemisphere = is_hemisphere(&scene);
        Ok(Self {
            ctx: ctx.clone(),
            session: Session::new(scene)?,
            viewport: Viewport::new(gl),
            options: viewport::Options::default(),
            files: Files::new(),
            timing: Timing::default(),
            notice: None,
            position_notice: None,
            focus: Focus::default(),
            solving: None,
            draft: None,
            is_scene_replaced: false,
            is_hemisphere,
            is_playing: false,
            was_paused: false,
            gesture: 0,
            narrow_tab: NarrowTab::Implant,
            show_left: true,
            show_right: true,
            show_about: false,
        })
    }

    /// Goes on in another window system, when the one before has lost its graphics: with its scene,
    /// history, camera and everything that was chosen or opened.
    pub fn move_to(&mut self, ctx: &egui::Context, gl: Option<&Arc<glow::Context>>) {
        // The theme chosen, widths of panels, what is scrolled where.
        let memory = self.ctx.memory(Clone::clone);
        ctx.memory_mut(|own| *own = memory);
        self.ctx = ctx.clone();
        self.viewport.move_to(gl);
        self.mark_paused();
    }

    /// Tells that nothing could be drawn since the frame before, in a hidden tab say: the time that
    /// has passed does not count for what moves by itself.
    pub fn mark_paused(&mut self) {
        self.was_paused = true;
    }

    /// A line to the user.
    pub fn notify(&mut self, text: &str) {
        self.notice = Some(Notice::info(text));
    }

    /// From now on the Tab key leads out of the app behind its last control, and before its first one
    /// backwards, as on a page.
    pub fn enable_page_navigation(&mut self) {
        self.focus.enable_page_navigation();
    }

    /// The keyboard's focus comes in from what is before the app (`true`) or behind it.
    pub fn enter(&mut self, direction: FocusDirection) {
        self.focus.enter(direction);
        self.request_frame();
    }

    /// Has the Tab key led out of the app: to what is behind it (`true`) or before it?
    pub fn take_focus_exit(&mut self) -> Option<FocusDirection> {
        self.focus.take_exit()
    }

    /// Name of the control that has the keyboard's focus, and where it is \[points\]: left, top, width and
    /// height.
    #[must_use]
    pub fn focused(&self) -> Option<(String, [f32; 4])> {
        let (name, rect) = self.focus.focused()?;
        Some((name.to_owned(), [rect.left(), rect.top(), rect.width(), rect.height()]))
    }

    /// Has a field for a number the keyboard?
    #[must_use]
    pub fn has_number_focus(&self) -> bool {
        widgets::has_number_focus(&self.ctx)
    }

    /// The scene, its history and its shape.
    #[must_use]
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The result of the present scene, with its time; `None` while it is being solved.
    #[must_use]
    pub fn outcome(&self) -> Option<Outcome> {
        let mut outcome = self.session.result()?.clone();
        outcome.solver.time_ms = Some(self.timing.solve_ms);
        Some(outcome)
    }

    /// The result as it is saved (JSON text): with its scene, this program's version and the date; `None`
    /// while the scene is being solved.
    #[must_use]
    pub fn result_json(&self) -> Option<String> {
        let record = Record {
            outcome: self.outcome()?,
            scene: self.session.scene().clone(),
            program_version: env!("CARGO_PKG_VERSION"),
            date: files::date(),
        };
        serde_json::to_string_pretty(&record).ok()
    }

    /// Opens a scene file's text.
    ///
    /// # Errors
    /// One line that names the field; nothing has changed then.
    pub fn open(&mut self, json: String) -> Result<(), SceneError> {
        self.apply(Command::Open(json))
    }

    /// Asks for a frame, after something was changed from outside.
    pub fn request_frame(&self) {
        self.ctx.request_repaint();
    }

    /// Figures of the running app.
    #[must_use]
    pub fn stats(&self) -> Stats {
        let is_converged =
            self.session.result().is_some_and(|outcome| outcome.status == Status::Converged);
        let counters = self.session.counters();
        Stats {
            frames: self.timing.frame_count,
            frame_ms_p50: self.timing.percentile(0.5),
            frame_ms_p95: self.timing.percentile(0.95),
            solve_ms: self.timing.solve_ms,
            solver_ms_p50: self.timing.slices.percentile(0.5),
            solver_ms_p95: self.timing.slices.percentile(0.95),
            solver_ms_max: self.timing.slice_max,
            converged: is_converged,
            solves: counters.solves,
            work_units: counters.work_units,
            tables: counters.tables,
            measurements: counters.measurements,
        }
    }

    /// One sentence on what the picture shows, for screen readers.
    #[must_use]
    pub fn summary(&self) -> String {
        if self.session.is_stopped() {
            return "Stopped: this scene has not been computed.".to_owned();
        }
        let Some(outcome) = self.session.result() else {
            return "Updating.".to_owned();
        };
        let figure = |name: &str, value: Option<f64>, decimals: usize, unit: &str| {
            value.map_or_else(String::new, |v| format!(" {name} {v:.decimals$}{unit}."))
        };
        let state = match outcome.status {
            Status::Unstable => return no_shape_reason(self.session.solver().fault()).to_owned(),
            Status::NotConverged => "Not finished: do not use these numbers.",
            Status::Converged => "Up to date.",
        };
        let greatest = outcome.strain.as_ref().map(|strain| strain.max_principal);
        let stretch = greatest.map_or_else(String::new, |strain| {
            let word = bands::strain_word(strain);
            format!(" Greatest strain {:.0} percent, {word}.", 100.0 * strain)
        });
        let pressure = outcome.contact_pressure_mmhg.map_or_else(String::new, |p| {
            let word = bands::pressure_word(p.max);
            format!(" Contact pressure {:.0} mmHg, at most {:.0}, {word}.", p.mean, p.max)
        });
        [
            state.to_owned(),
            figure("Skin projection", outcome.skin_projection_mm, 1, " mm"),
            figure("Area ratio", outcome.area_ratio, 2, ""),
            stretch,
            pressure,
            outcome.warnings.iter().map(|warning| format!(" {warning}")).collect(),
        ]
        .concat()
    }

    /// Draws a frame and does a slice of work. Knows nothing of the window around it.
    pub fn show(&mut self, ui: &mut Ui) {
        let start = Instant::now();
        let ctx = ui.ctx().clone();
        self.poll_files(&ctx);
        self.focus.begin_frame(&ctx);
        self.handle_keys(&ctx);
        let mut scene = self.draft.take().unwrap_or_default();
        if scene != *self.session.scene() {
            scene.clone_from(self.session.scene());
        }
        self.is_scene_replaced = false;
        self.advance_playback(&ctx, &mut scene);
        self.solve_slice(&ctx);
        self.focus.boundary(ui, Boundary::First);
        if ui.available_width() < theme::NARROW {
            self.narrow(ui, &mut scene);
        } else {
            self.wide(ui, &mut scene);
        }
        self.about_window(&ctx);
        self.focus.boundary(ui, Boundary::Last);
        self.submit_edits(&ctx, &mut scene);
        // An edit takes the line of before away; this one is of the edit.
        self.notice = self.position_notice.take().or(self.notice.take());
        self.focus.end_frame(&ctx, self.viewport.id());
        self.draft = Some(scene);
        self.was_paused = false;
        if self.session.is_working() || self.is_playing {
            ctx.request_repaint();
        }
        self.timing.add_frame(1000.0 * start.elapsed().as_secs_f64());
    }

    /// A slice of solving.
    fn solve_slice(&mut self, ctx: &egui::Context) {
        if !self.session.is_working() {
            self.solving = None;
            return;
        }
        let start = Instant::now();
        let (since, share) = self.solving.unwrap_or((start, 0.0));
        // Nothing can be used before the first shape is there.
        let is_opening = self.session.outcome().is_none() && since == start;
        let slice = if is_opening {
            FIRST_SLICE
        } else if since.elapsed() > LONG {
            // Slow frames would stretch a long solve: it takes as much time as they do.
            let frame = Duration::from_secs_f32(ctx.input(|input| input.stable_dt.clamp(0.0, 1.0)));
            (frame / 2).clamp(SLICE, LONG_SLICE)
        } else {
            SLICE
        };
        let progress = self.session.solve(&mut || start.elapsed() >= slice);
        let scene = if is_opening { SliceOf::OpeningScene } else { SliceOf::EditedScene };
        self.timing.add_slice(1000.0 * start.elapsed().as_secs_f64(), scene);
        self.session.conclude();
        self.solving = Some((since, share.max(self.session.solver().share_done())));
        if let Some(fault) = self.session.taken_back() {
            self.notice = Some(Notice::error(format!(
                "the last change was taken back. {} Redo tries it again.",
                no_shape_reason(Some(fault))
            )));
            self.is_playing = false;
        }
        if progress == Progress::Done && self.session.has_no_shape() {
            self.is_playing = false;
        }
    }

    /// Is the present solve a long one?
    fn is_long(&self) -> bool {
        self.session.is_working() && self.solving.is_some_and(|(since, _)| since.elapsed() > LONG)
    }

    /// What the panels do with the results of the previous scene.
    fn previous_results(&self) -> PreviousResults {
        if self.is_long() { PreviousResults::Hidden } else { PreviousResults::Shown }
    }

    fn cancel(&mut self) {
        self.session.cancel();
        self.is_scene_replaced = true;
        self.is_playing = false;
        self.solving = None;
        self.timing.solve_ms = 0.0;
        self.is_hemisphere = is_hemisphere(self.session.scene());
        self.notice = (!self.session.is_stopped()).then(|| {
            Notice::info("Cancelled: this is the scene of before. Redo tries the other one again.")
        });
    }

    fn apply(&mut self, command: Command) -> Result<(), SceneError> {
        let before = self.session.counters().solves;
        self.session.apply(command)?;
        self.notice = None;
        self.is_scene_replaced = true;
        if self.session.counters().solves != before {
            self.timing.solve_ms = 0.0;
            self.solving = None;
        }
        self.is_hemisphere = is_hemisphere(self.session.scene());
        Ok(())
    }

    /// Carries out a command; what is refused is told.
    fn execute(&mut self, command: Command) {
        if let Err(error) = self.apply(command) {
            self.notice = Some(Notice::error(error.to_string()));
        }
    }

    /// Turns what a panel changed in its copy of the scene into a command. A command of this frame
    /// (undo) goes first: the copy is of the scene before.
    fn submit_edits(&mut self, ctx: &egui::Context, scene: &mut Scene) {
        let is_new = ctx.input(|input| {
            let pointer = &input.pointer;
            pointer.any_pressed() || !(pointer.any_down() || pointer.any_released())
        });
        if is_new {
            // From press to release is one gesture; each key is its own.
            self.gesture += u64::from(!self.is_playing);
        }
        let is_hemisphere = self.is_hemisphere;
        let is_same = scene == self.session.scene()
            && (!is_hemisphere || self::is_hemisphere(self.session.scene()));
        if self.is_scene_replaced || is_same {
            return;
        }
        if is_hemisphere {
            scene.implant.projection_mm = scene.implant.base_radius_mm;
        }
        let repair = scene.repair();
        self.execute(Command::Edit { scene: Box::new(scene.clone()), gesture: self.gesture });
        if let Some(repair) = repair {
            self.notice = Some(Notice::caution(repair.to_string()));
        }
        self.is_hemisphere = is_hemisphere;
        ctx.request_repaint();
    }

    fn poll_files(&mut self, ctx: &egui::Context) {
        for file in ctx.input(|input| input.raw.dropped_files.clone()) {
            self.files.dropped(ctx, file);
        }
        while let Some(event) = self.files.next() {
            self.notice = Some(match event {
                FileEvent::Opened { name, text } => match self.open(text) {
                    Ok(()) => {
                        self.viewport.fit(&self.session);
                        Notice::info(format!("Opened {name}."))
                    }
                    Err(error) => Notice::error(format!("{name}: {error}")),
                },
                FileEvent::Saved(name) => Notice::info(format!("Saved {name}.")),
                FileEvent::Failed(error) => Notice::error(error),
            });
        }
    }

    fn save_scene(&mut self, ctx: &egui::Context) {
        self.files.save(ctx, "scene.json", self.session.scene().to_json());
    }

    fn save_result(&mut self, ctx: &egui::Context) {
        if let Some(text) = self.result_json() {
            self.files.save(ctx, "result.json", text);
        }
    }

    fn wide(&mut self, ui: &mut Ui, scene: &mut Scene) {
        egui::Panel::top("toolbar").resizable(false).show(ui, |ui| self.toolbar(ui, Layout::Wide));
        egui::Panel::bottom("status").resizable(false).show(ui, |ui| {
            ui.add_space(theme::SPACE_SMALL);
            status::show(ui, &self.session, &self.timing);
            ui.add_space(theme::SPACE_SMALL);
        });
        let mut is_open = self.show_left;
        side_panel(egui::Panel::left("controls")).show_collapsible(ui, &mut is_open, |ui| {
            column("controls").show(ui, |ui| {
                widgets::heading(ui, "Scene");
                self.position_notice = controls::implant(ui, scene, &mut self.is_hemisphere);
                controls::layers(ui, scene);
                ui.add_space(theme::SPACE);
                controls::method(ui, scene, &self.session);
                self.focus.scroll_into_view(ui);
            });
        });
        self.show_left = is_open;
        let mut is_open = self.show_right;
        side_panel(egui::Panel::right("results")).show_collapsible(ui, &mut is_open, |ui| {
            column("results").show(ui, |ui| {
                readings::show(ui, &self.session, self.previous_results());
                plots::section(ui, &self.session);
                plots::curves(ui, &self.session, self.previous_results());
                self.focus.scroll_into_view(ui);
            });
        });
        self.show_right = is_open;
        let insertion = egui::Panel::bottom("insertion").resizable(false);
        insertion.show(ui, |ui| self.insertion_row(ui, scene));
        egui::CentralPanel::no_frame().show(ui, |ui| self.picture(ui, scene));
    }

    fn narrow(&mut self, ui: &mut Ui, scene: &mut Scene) {
        egui::Panel::top("toolbar")
            .resizable(false)
            .show(ui, |ui| self.toolbar(ui, Layout::Narrow));
        // The picture keeps half of the screen.
        let height = 0.42 * ui.ctx().content_rect().height();
        let sheet = egui::Panel::bottom("sheet").exact_size(height).resizable(false);
        sheet.show(ui, |ui| {
            status::show(ui, &self.session, &self.timing);
            ui.horizontal(|ui| {
                for (tab, name) in [
                    (NarrowTab::Implant, "Implant"),
                    (NarrowTab::Tissue, "Tissue"),
                    (NarrowTab::Results, "Results"),
                    (NarrowTab::Plots, "Plots"),
                ] {
                    ui.selectable_value(&mut self.narrow_tab, tab, name);
                }
            });
            ui.separator();
            egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
                match self.narrow_tab {
                    NarrowTab::Implant => {
                        self.insertion_row(ui, scene);
                        self.position_notice =
                            controls::implant(ui, scene, &mut self.is_hemisphere);
                    }
                    NarrowTab::Tissue => {
                        controls::layers(ui, scene);
                        controls::method(ui, scene, &self.session);
                    }
                    NarrowTab::Results => {
                        readings::show(ui, &self.session, self.previous_results());
                    }
                    NarrowTab::Plots => {
                        plots::section(ui, &self.session);
                        plots::curves(ui, &self.session, self.previous_results());
                    }
                }
                self.focus.scroll_into_view(ui);
            });
        });
        egui::CentralPanel::no_frame().show(ui, |ui| self.picture(ui, scene));
    }

    fn insertion_row(&mut self, ui: &mut Ui, scene: &mut Scene) {
        ui.add_space(theme::SPACE_SMALL);
        ui.horizontal(|ui| {
            let name = if self.is_playing { "Pause" } else { "Play" };
            let button = ui.add_sized([56.0, 24.0], egui::Button::new(name));
            if button.on_hover_text(format!("{name} the insertion (space)")).clicked() {
                self.toggle_playback();
            }
            ui.vertical(|ui| {
                let mut percent = 100.0 * scene.insertion;
                let slider = Control {
                    label: "Insertion",
                    unit: "%",
                    kind: Kind::Percent,
                    range: 0.0..=100.0,
                    reset: 100.0,
                    decimals: 0,
                    step: 1.0,
                    tooltip: "How far the implant is pushed under the tissue, from flat to full height.",
                    ..Control::default()
                };
                if slider.show(ui, &mut percent).is_changed {
                    scene.insertion = (percent / 100.0).clamp(0.0, 1.0);
                    self.is_playing = false;
                }
            });
        });
        ui.add_space(theme::SPACE_SMALL);
    }

    fn picture(&mut self, ui: &mut Ui, scene: &mut Scene) {
        self.show_notice(ui);
        if self.session.is_stopped() {
            self.stopped_page(ui);
            return;
        }
        if self.session.has_no_shape() {
            no_shape_page(ui, self.session.solver().fault(), scene);
            return;
        }
        if self.is_long() {
            self.progress_bar(ui);
        }
        self.viewport.show(ui, &self.session, &mut self.options);
    }

    /// The last line to the user, until it is closed.
    fn show_notice(&mut self, ui: &mut Ui) {
        match self.notice.as_ref().and_then(|notice| notice.show(ui)) {
            None => {}
            Some(NoticeAction::Close) => self.notice = None,
            Some(NoticeAction::Accept(scene)) => {
                self.gesture += 1;
                self.execute(Command::Edit { scene, gesture: self.gesture });
            }
        }
    }

    /// How far a long solve has come, and the way out of it.
    fn progress_bar(&mut self, ui: &mut Ui) {
        let Some((since, share)) = self.solving else { return };
        let mut is_cancelled = false;
        let frame = egui::Frame::new().inner_margin(theme::SPACE).fill(ui.visuals().panel_fill);
        egui::Panel::top("progress").frame(frame).resizable(false).show(ui, |ui| {
            ui.horizontal(|ui| {
                is_cancelled = ui.button("Cancel").clicked();
                let seconds = since.elapsed().as_secs();
                let bar = egui::ProgressBar::new(share as f32)
                    .desired_width((ui.available_width() - 270.0).clamp(40.0, 320.0))
                    .fill(theme::palette(ui.visuals()).accent)
                    .animate(true);
                let bar = ui.add(bar);
                widgets::set_accessible_name(
                    &bar,
                    egui::Role::ProgressIndicator,
                    "Progress of the solve",
                );
                ui.label(format!("Computing, {seconds} s so far: the picture is a draft"));
            });
        });
        if is_cancelled || ui.input(|input| input.key_pressed(egui::Key::Escape)) {
            self.cancel();
        }
    }

    /// Says that a solve was stopped, and how it goes on.
    fn stopped_page(&mut self, ui: &mut Ui) {
        message_page(ui, "Stopped", |ui| {
            ui.label("This scene has not been computed: there is nothing to show or to read off.");
            ui.add_space(theme::SPACE);
            if ui.button("Compute it").clicked() {
                self.session.go_on();
            }
        });
    }
}

/// A message in place of the picture.
fn message_page(ui: &mut Ui, heading: &str, add: impl FnOnce(&mut Ui)) {
    let frame = egui::Frame::new().inner_margin(2.0 * theme::SPACE).fill(ui.visuals().panel_fill);
    egui::CentralPanel::default().frame(frame).show(ui, |ui| {
        ui.vertical_centered(|ui| {
            ui.add_space(0.3 * ui.available_height());
            ui.heading(heading);
            add(ui);
        });
    });
}

/// Says why there is no shape, and what can be done.
fn no_shape_page(ui: &mut Ui, fault: Option<Fault>, scene: &mut Scene) {
    message_page(ui, "No stable shape", |ui| {
        if fault.is_some() {
            ui.label(no_shape_reason(fault));
            return;
        }
        ui.label(
            "The paper's springs lose stability at these strains and this Poisson ratio: \
             their energy has no lower bound, so that no shape can be shown.",
        );
        ui.add_space(theme::SPACE);
        if ui.button("Use the coupled springs").clicked() {
            scene.springs = Springs::Coupled;
        }
    });
}

/// A wide line or figure widens its panel, which never gives that back: not at the picture's cost.
fn side_panel(panel: egui::Panel) -> egui::Panel {
    panel.default_size(theme::PANEL_WIDTH).max_size(1.15 * theme::PANEL_WIDTH).resizable(false)
}

/// What a side panel holds, as wide as the panel: one that shrinks takes the panel with it, some points
/// in every frame.
fn column(name: &str) -> egui::ScrollArea {
    egui::ScrollArea::vertical().id_salt(name).auto_shrink([false, true])
}

fn is_hemisphere(scene: &Scene) -> bool {
    let implant = &scene.implant;
    (implant.projection_mm - implant.base_radius_mm).abs() < 1e-9 * implant.base_radius_mm
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
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

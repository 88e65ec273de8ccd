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
mod keys;
mod plots;
mod readings;
mod stability;
mod status;
mod theme;
mod toolbar;
mod viewport;

use crate::measure::{Outcome, Status, no_shape as no_shape_text};
use crate::scene::{Scene, SceneError, Springs};
use crate::session::{Command, Session};
use crate::solve::{Fault, Progress};
use controls::{Control, name_it};
use eframe::{egui, glow};
use egui::{RichText, Ui};
use files::{FileEvent, Files};
use status::Timing;
use std::sync::Arc;
use viewport::Viewport;
use web_time::{Duration, Instant};

/// A frame goes on with solving until this time is over, and the step under way done.
const SLICE: Duration = Duration::from_millis(10);
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

/// A line to the user.
struct Notice {
    text: String,
    is_error: bool,
}

/// A tab of the bottom sheet on narrow screens.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Sheet {
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
    /// The copy of the scene that the panels edit, kept between frames.
    draft: Option<Scene>,
    /// Did a command take the session's scene away from the draft in this frame?
    is_replaced: bool,
    is_hemisphere: bool,
    is_playing: bool,
    /// Has the app been kept from drawing since the frame before?
    is_rested: bool,
    gesture: u64,
    sheet: Sheet,
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
            draft: None,
            is_replaced: false,
            is_hemisphere,
            is_playing: false,
            is_rested: false,
            gesture: 0,
            sheet: Sheet::Implant,
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
        self.rested();
    }

    /// Tells that nothing could be drawn since the frame before, in a hidden tab say: the time that
    /// has passed does not count for what moves by itself.
    pub fn rested(&mut self) {
        self.is_rested = true;
    }

    /// A line to the user.
    pub fn tell(&mut self, text: &str) {
        self.notice = Some(Notice { text: text.to_owned(), is_error: false });
    }

    /// The scene, its history and its shape.
    #[must_use]
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The result of the last finished solve, with its time.
    #[must_use]
    pub fn outcome(&self) -> Option<Outcome> {
        let mut outcome = self.session.outcome()?.clone();
        outcome.solver.time_ms = Some(self.timing.solve_ms);
        Some(outcome)
    }

    /// Opens a scene file's text.
    ///
    /// # Errors
    /// One line that names the field; nothing has changed then.
    pub fn open(&mut self, json: String) -> Result<(), SceneError> {
        self.command(Command::Open(json))
    }

    /// Asks for a frame, after something was changed from outside.
    pub fn wake(&self) {
        self.ctx.request_repaint();
    }

    /// Figures of the running app.
    #[must_use]
    pub fn stats(&self) -> Stats {
        let is_converged =
            self.session.outcome().is_some_and(|outcome| outcome.status == Status::Converged);
        let counters = self.session.counters();
        Stats {
            frames: self.timing.frame_count,
            frame_ms_p50: self.timing.percentile(0.5),
            frame_ms_p95: self.timing.percentile(0.95),
            solve_ms: self.timing.solve_ms,
            solver_ms_p50: self.timing.slices.percentile(0.5),
            solver_ms_p95: self.timing.slices.percentile(0.95),
            solver_ms_max: self.timing.slice_max,
            converged: is_converged && !self.session.is_working(),
            solves: counters.solves,
            work_units: counters.work_units,
            tables: counters.tables,
            measurements: counters.measurements,
        }
    }

    /// One sentence on what the picture shows, for screen readers.
    #[must_use]
    pub fn summary(&self) -> String {
        let Some(outcome) = self.session.outcome().filter(|_| !self.session.is_working()) else {
            return "Solving.".to_owned();
        };
        let figure = |value: Option<f64>, decimals: usize, unit: &str| {
            value.map_or_else(|| "unknown".to_owned(), |v| format!("{v:.decimals$} {unit}"))
        };
        match outcome.status {
            Status::Unstable => no_shape_text(self.session.solver().fault()).to_owned(),
            status => format!(
                "{}. Skin projection {}, area ratio {}, greatest strain {}, mean contact pressure {}.",
                if status == Status::Converged { "Converged" } else { "Not converged" },
                figure(outcome.skin_projection_mm, 1, "mm"),
                figure(outcome.area_ratio, 2, ""),
                figure(outcome.strain.as_ref().map(|s| 100.0 * s.max_principal), 0, "percent"),
                figure(outcome.contact_pressure_mmhg.map(|p| p.mean), 0, "mmHg"),
            ),
        }
    }

    /// Draws a frame and does a slice of work. Knows nothing of the window around it.
    pub fn show(&mut self, ui: &mut Ui) {
        let start = Instant::now();
        let ctx = ui.ctx().clone();
        self.take_files(&ctx);
        self.keys(&ctx);
        let mut scene = self.draft.take().unwrap_or_default();
        if scene != *self.session.scene() {
            scene.clone_from(self.session.scene());
        }
        self.is_replaced = false;
        self.play(&ctx, &mut scene);
        self.work();
        if ui.available_width() < theme::NARROW {
            self.narrow(ui, &mut scene);
        } else {
            self.wide(ui, &mut scene);
        }
        self.about(&ctx);
        self.edited(&ctx, &mut scene);
        self.draft = Some(scene);
        self.is_rested = false;
        if self.session.is_working() || self.is_playing {
            ctx.request_repaint();
        }
        self.timing.add_frame(1000.0 * start.elapsed().as_secs_f64());
    }

    /// A slice of solving.
    fn work(&mut self) {
        if !self.session.is_working() {
            return;
        }
        // Nothing can be used before the first shape is there.
        let is_opening = self.session.outcome().is_none();
        let slice = if is_opening { FIRST_SLICE } else { SLICE };
        let start = Instant::now();
        let progress = self.session.solve(&mut || start.elapsed() >= slice);
        self.timing.add_slice(1000.0 * start.elapsed().as_secs_f64(), is_opening);
        self.session.conclude();
        if let Some(fault) = self.session.taken_back() {
            let text = format!(
                "The last change was taken back: {} Redo tries it again.",
                no_shape_text(Some(fault))
            );
            self.notice = Some(Notice { text, is_error: true });
            self.is_playing = false;
        }
        if progress == Progress::Done && self.session.has_no_shape() {
            self.is_playing = false;
        }
    }

    fn command(&mut self, command: Command) -> Result<(), SceneError> {
        let before = self.session.counters().solves;
        self.session.apply(command)?;
        self.is_replaced = true;
        if self.session.counters().solves != before {
            self.timing.solve_ms = 0.0;
        }
        self.is_hemisphere = is_hemisphere(self.session.scene());
        Ok(())
    }

    /// Carries out a command; what is refused is told.
    fn run(&mut self, command: Command) {
        match self.command(command) {
            Ok(()) => self.notice = None,
            Err(error) => {
                self.notice = Some(Notice { text: error.to_string(), is_error: true });
            }
        }
    }

    /// Turns what a panel changed in its copy of the scene into a command. A command of this frame
    /// (undo) goes first: the copy is of the scene before.
    fn edited(&mut self, ctx: &egui::Context, scene: &mut Scene) {
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
        if self.is_replaced || is_same {
            return;
        }
        let notice = controls::repair(scene, is_hemisphere);
        self.run(Command::Edit { scene: Box::new(scene.clone()), gesture: self.gesture });
        if let Some(text) = notice {
            self.notice = Some(Notice { text, is_error: false });
        }
        self.is_hemisphere = is_hemisphere;
        ctx.request_repaint();
    }

    fn take_files(&mut self, ctx: &egui::Context) {
        for file in ctx.input(|input| input.raw.dropped_files.clone()) {
            self.files.dropped(ctx, file);
        }
        while let Some(event) = self.files.next() {
            let (text, is_error) = match event {
                FileEvent::Opened { name, text } => match self.open(text) {
                    Ok(()) => {
                        self.viewport.fit(&self.session);
                        (format!("Opened {name}."), false)
                    }
                    Err(error) => (format!("{name}: {error}"), true),
                },
                FileEvent::Saved(name) => (format!("Saved {name}."), false),
                FileEvent::Failed(error) => (error, true),
            };
            self.notice = Some(Notice { text, is_error });
        }
    }

    fn save_scene(&mut self, ctx: &egui::Context) {
        self.files.save(ctx, "scene.json", self.session.scene().to_json());
    }

    fn save_result(&mut self, ctx: &egui::Context) {
        if let Some(outcome) = self.outcome()
            && let Ok(text) = serde_json::to_string_pretty(&outcome)
        {
            self.files.save(ctx, "result.json", text);
        }
    }

    fn wide(&mut self, ui: &mut Ui, scene: &mut Scene) {
        egui::Panel::top("toolbar").show(ui, |ui| self.toolbar(ui, false));
        egui::Panel::bottom("status").show(ui, |ui| {
            ui.add_space(theme::SPACE_SMALL);
            status::show(ui, &self.session, &self.timing);
            ui.add_space(theme::SPACE_SMALL);
        });
        let mut is_open = self.show_left;
        side_panel(egui::Panel::left("controls")).show_collapsible(ui, &mut is_open, |ui| {
            column("controls").show(ui, |ui| {
                controls::heading(ui, "Scene");
                controls::implant(ui, scene, &mut self.is_hemisphere);
                controls::layers(ui, scene);
                ui.add_space(theme::SPACE);
                controls::method(ui, scene, &self.session);
            });
        });
        self.show_left = is_open;
        let mut is_open = self.show_right;
        side_panel(egui::Panel::right("results")).show_collapsible(ui, &mut is_open, |ui| {
            column("results").show(ui, |ui| {
                readings::show(ui, self.session.outcome(), self.session.is_working());
                plots::section(ui, &self.session);
                plots::curves(ui, &self.session);
            });
        });
        self.show_right = is_open;
        egui::Panel::bottom("insertion").show(ui, |ui| self.insertion(ui, scene));
        egui::CentralPanel::no_frame().show(ui, |ui| self.picture(ui, scene));
    }

    fn narrow(&mut self, ui: &mut Ui, scene: &mut Scene) {
        egui::Panel::top("toolbar").show(ui, |ui| self.toolbar(ui, true));
        // The picture keeps half of the screen.
        let height = 0.42 * ui.ctx().content_rect().height();
        egui::Panel::bottom("sheet").exact_size(height).show(ui, |ui| {
            status::show(ui, &self.session, &self.timing);
            ui.horizontal(|ui| {
                for (sheet, name) in [
                    (Sheet::Implant, "Implant"),
                    (Sheet::Tissue, "Tissue"),
                    (Sheet::Results, "Results"),
                    (Sheet::Plots, "Plots"),
                ] {
                    ui.selectable_value(&mut self.sheet, sheet, name);
                }
            });
            ui.separator();
            egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
                match self.sheet {
                    Sheet::Implant => {
                        self.insertion(ui, scene);
                        controls::implant(ui, scene, &mut self.is_hemisphere);
                    }
                    Sheet::Tissue => {
                        controls::layers(ui, scene);
                        controls::method(ui, scene, &self.session);
                    }
                    Sheet::Results => {
                        readings::show(ui, self.session.outcome(), self.session.is_working());
                    }
                    Sheet::Plots => {
                        plots::section(ui, &self.session);
                        plots::curves(ui, &self.session);
                    }
                }
            });
        });
        egui::CentralPanel::no_frame().show(ui, |ui| self.picture(ui, scene));
    }

    fn insertion(&mut self, ui: &mut Ui, scene: &mut Scene) {
        ui.add_space(theme::SPACE_SMALL);
        ui.horizontal(|ui| {
            let name = if self.is_playing { "Pause" } else { "Play" };
            let button = ui.add_sized([56.0, 24.0], egui::Button::new(name));
            if button.on_hover_text(format!("{name} the insertion (space)")).clicked() {
                self.toggle_play();
            }
            let mut percent = 100.0 * scene.insertion;
            let slider = Control {
                label: "Insertion",
                unit: "%",
                range: 0.0..=100.0,
                reset: 100.0,
                decimals: 0,
                step: 1.0,
                tooltip: "How far the implant is pushed under the tissue, from flat to full height.",
                ..Control::default()
            };
            if slider.show(ui, &mut percent).changed() {
                scene.insertion = (percent / 100.0).clamp(0.0, 1.0);
                self.is_playing = false;
            }
        });
        ui.add_space(theme::SPACE_SMALL);
    }

    fn picture(&mut self, ui: &mut Ui, scene: &mut Scene) {
        self.notices(ui);
        if self.session.has_no_shape() {
            no_shape(ui, self.session.solver().fault(), scene);
            return;
        }
        let is_dark = ui.visuals().dark_mode;
        self.viewport.show(ui, &self.session, &mut self.options, is_dark);
    }

    /// The last line to the user, until it is closed.
    fn notices(&mut self, ui: &mut Ui) {
        let Some(notice) = &self.notice else { return };
        let palette = theme::palette(ui.visuals());
        let color = if notice.is_error { palette.bad } else { palette.good };
        let mut is_closed = false;
        let line = egui::Frame::new().inner_margin(theme::SPACE).fill(ui.visuals().panel_fill);
        egui::Panel::top("notice").frame(line).show(ui, |ui| {
            ui.horizontal(|ui| {
                let close = ui.button("×");
                name_it(&close, egui::Role::Button, "Close message");
                is_closed = close.clicked();
                ui.add(egui::Label::new(RichText::new(&notice.text).color(color)).wrap());
            });
        });
        if is_closed {
            self.notice = None;
        }
    }
}

/// Says why there is no shape, and what can be done.
fn no_shape(ui: &mut Ui, fault: Option<Fault>, scene: &mut Scene) {
    let frame = egui::Frame::new().inner_margin(2.0 * theme::SPACE).fill(ui.visuals().panel_fill);
    egui::CentralPanel::default().frame(frame).show(ui, |ui| {
        ui.vertical_centered(|ui| {
            ui.add_space(0.3 * ui.available_height());
            ui.heading("No stable shape");
            if fault.is_some() {
                ui.label(no_shape_text(fault));
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
    });
}

/// A wide line or figure widens its panel, which never gives that back: not at the picture's cost.
fn side_panel(panel: egui::Panel) -> egui::Panel {
    panel.default_size(theme::PANEL_WIDTH).max_size(1.15 * theme::PANEL_WIDTH)
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

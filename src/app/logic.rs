//! The logic of a frame: slices of solving, commands, edits of the panels, files.

use super::answer::PreviousResults;
use super::files::{FileEvent, is_table};
use super::focus::Boundary;
use super::messages::Notice;
use super::status::SliceOf;
use super::texts::tr;
use super::widgets::note_cancelled_press;
use super::{App, plan, theme};
use crate::measure::no_shape;
use crate::scene::Scene;
use crate::session::{Command, CommandError};
use crate::solve::Progress;
use crate::view::camera::View;
use eframe::egui::{self, Ui};
use web_time::{Duration, Instant};

/// Time limit of a slice of solving; the running step is finished.
const SLICE: Duration = Duration::from_millis(10);
/// Time of a solve after which the app shows its progress and hides the previous results.
const LONG: Duration = Duration::from_millis(400);
/// Upper limit of a slice of a long solve or of a pin, for slow frames.
const LONG_SLICE: Duration = Duration::from_millis(200);
/// Time limit of the first slice, which solves most opening scenes.
const FIRST_SLICE: Duration = Duration::from_millis(400);

/// A solve in progress.
#[derive(Clone, Copy)]
pub(super) struct RunningSolve {
    pub(super) start: Instant,
    /// Completed fraction \[-\], 0 to 1.
    pub(super) fraction: f64,
}

/// The last press of the pointer.
#[derive(Default)]
pub(super) struct Press {
    /// The choices of the plan before the press.
    pub(super) choices: plan::Choices,
    /// Cancelled by a key: until its release the pointer changes no plan.
    pub(super) is_cancelled: bool,
}

/// Half of the time of a frame: slow frames would prolong a long solve.
fn long_slice(ctx: &egui::Context) -> Duration {
    let frame = Duration::from_secs_f32(ctx.input(|input| input.stable_dt.clamp(0.0, 1.0)));
    (frame / 2).clamp(SLICE, LONG_SLICE)
}

impl App {
    /// Runs a frame: keys, the panel of the plan, its edits with one slice of solving, the other panels, their edits. Independent
    /// of the surrounding window.
    pub fn show(&mut self, ui: &mut Ui) {
        let start = Instant::now();
        let ctx = ui.ctx().clone();
        self.poll_files(&ctx);
        self.focus.begin_frame(&ctx);
        self.plan.device.note(&ctx);
        if ctx.input(|input| input.pointer.any_pressed()) {
            self.press = Press { choices: self.plan, is_cancelled: false };
        }
        self.handle_keys(&ctx);
        note_cancelled_press(&ctx, self.press.is_cancelled);
        let mut scene = self.draft.take().unwrap_or_default();
        if scene != *self.session.scene() {
            scene.clone_from(self.session.scene());
        }
        (self.is_scene_replaced, self.has_solved) = (false, false);
        self.advance_playback(&ctx, &mut scene);
        self.poll_studies(&ctx);
        self.focus.boundary(ui, Boundary::First);
        if ui.available_width() < theme::NARROW || ui.available_height() < theme::LOW {
            self.narrow(ui, &mut scene);
        } else {
            self.wide(ui, &mut scene);
        }
        self.help_window(&ctx);
        self.palette_window(&ctx);
        if self.curve_window.as_mut().is_some_and(|window| !window.show(&ctx, &mut scene)) {
            self.curve_window = None;
        }
        self.focus.boundary(ui, Boundary::Last);
        self.submit_edits(&mut scene);
        self.press.is_cancelled &= ctx.input(|input| input.pointer.any_down());
        self.focus.end_frame(&ctx, self.viewport.id());
        self.draft = Some(scene);
        self.was_paused = false;
        // The panels before the slice show its result in the next frame, as do the studies.
        let is_solving = self.session.is_working() || self.session.is_solving_pins();
        if is_solving || self.has_solved || self.is_playing {
            ctx.request_repaint();
        }
        self.note_changes();
        self.timing.add_frame(1000.0 * start.elapsed().as_secs_f64());
    }

    /// Submits the edits so far and solves for one slice, once a frame: the rest of the frame shows the edited shape.
    pub(super) fn take_edits(&mut self, ctx: &egui::Context, scene: &mut Scene) {
        self.submit_edits(scene);
        // An edit clears the previous notice, so a notice about this edit is stored after it.
        self.notice = self.position_notice.take().or(self.notice.take());
        if !self.has_solved {
            self.has_solved = self.session.is_working() || self.session.is_solving_pins();
            self.solve_slice(ctx);
        }
        if scene != self.session.scene() {
            scene.clone_from(self.session.scene());
        }
        self.is_scene_replaced = false;
    }

    /// Solves for one slice.
    fn solve_slice(&mut self, ctx: &egui::Context) {
        if !self.session.is_working() {
            self.solving = None;
            self.solve_pin(ctx);
            return;
        }
        let now = Instant::now();
        let running = self.solving.unwrap_or(RunningSolve { start: now, fraction: 0.0 });
        // The app is of no use before its first shape.
        let is_opening = self.session.outcome().is_none() && running.start == now;
        let slice = if is_opening {
            FIRST_SLICE
        } else if running.start.elapsed() > LONG {
            long_slice(ctx)
        } else {
            SLICE
        };
        let mut progress = self.session.solve(&mut || now.elapsed() >= slice);
        // A draft to display would cost the opening scene a frame more: the first frames are slow.
        while is_opening && progress == Progress::Working && now.elapsed() < slice {
            progress = self.session.solve(&mut || now.elapsed() >= slice);
        }
        let scene = if is_opening { SliceOf::OpeningScene } else { SliceOf::EditedScene };
        self.timing.add_slice(1000.0 * now.elapsed().as_secs_f64(), scene);
        self.session.conclude();
        let fraction = running.fraction.max(self.session.fraction_done());
        self.solving = Some(RunningSolve { fraction, ..running });
        if let Some(fault) = self.session.reverted() {
            let reason = tr(no_shape(Some(fault)));
            self.notice = Some(Notice::error(tr!(
                "The last change was undone. {reason} Redo repeats the change.",
                reason
            )));
            self.is_playing = false;
        }
        if progress == Progress::Done && self.session.has_no_shape() {
            self.is_playing = false;
        }
    }

    /// Advances the studies. New jobs wait for a solve of the app, unless that takes long.
    fn poll_studies(&mut self, ctx: &egui::Context) {
        self.studies.poll(ctx, self.session.is_working() && !self.is_long());
        self.studies.share(&self.session);
        self.range.advance(ctx, self.session.scene(), &mut self.studies);
        // What is not known is sampled after an edit and its solve.
        let is_held = ctx.input(|input| input.pointer.any_down());
        let is_busy = self.session.is_working() || self.is_playing || is_held;
        self.filling.advance(self.session.scene(), self.plan.device, &mut self.studies, is_busy);
        let shelf = &self.range.sizes.shelf;
        let bands = self.uncertainty.choices(self.session.scene());
        let plan = (self.session.scene(), shelf);
        self.volume_marks.want_after_rest(ctx, is_busy);
        self.volume_marks.advance(plan, bands, &mut self.studies, is_busy);
        let sizes = &self.range.sizes;
        self.shelf_largest.advance(self.session.scene(), sizes, &mut self.studies, is_busy);
        self.uncertainty.advance(&self.session, &mut self.studies, ctx, is_busy);
        self.nearest.advance(&self.session, &mut self.studies, is_busy);
    }

    /// Solves a pin for one slice.
    fn solve_pin(&mut self, ctx: &egui::Context) {
        let (now, slice) = (Instant::now(), long_slice(ctx));
        self.session.advance_pins(&mut || now.elapsed() >= slice);
    }

    /// Is a long solve in progress?
    pub(super) fn is_long(&self) -> bool {
        self.session.is_working()
            && self.solving.is_some_and(|running| running.start.elapsed() > LONG)
    }

    /// Visibility of the results of the previous scene.
    pub(super) fn previous_results(&self) -> PreviousResults {
        if self.is_long() { PreviousResults::Hidden } else { PreviousResults::Shown }
    }

    /// Cancels the running solve and restores the previous scene, if there is one.
    pub(super) fn cancel(&mut self) {
        self.session.cancel();
        self.is_scene_replaced = true;
        self.is_playing = false;
        self.solving = None;
        self.timing.solve_ms = 0.0;
        self.notice = (!self.session.is_stopped()).then(|| {
            Notice::info(tr(
                "Cancelled. The previous plan is open; Redo computes the cancelled one again.",
            ))
        });
    }

    /// Applies a command to the session.
    pub(super) fn apply(&mut self, command: Command) -> Result<(), CommandError> {
        let before = self.session.revision();
        self.session.apply(command)?;
        self.notice = None;
        self.is_scene_replaced = true;
        if self.session.revision() != before {
            self.timing.solve_ms = 0.0;
            self.solving = None;
        }
        Ok(())
    }

    /// Executes a command and reports its error, if any.
    pub(super) fn execute(&mut self, command: Command) {
        if let Err(error) = self.apply(command) {
            self.notice = Some(Notice::error(error.to_string()));
        }
    }

    /// Counts the gesture of this frame's edits, once the panel of the plan is shown.
    pub(super) fn count_gesture(&mut self, ctx: &egui::Context) {
        let is_new = ctx.input(|input| {
            let pointer = &input.pointer;
            pointer.any_pressed() || !(pointer.any_down() || pointer.any_released())
        });
        // The typing in one field of text is one gesture.
        let typing = self.typing.0.take();
        let is_typing_on = typing.is_some() && typing == self.typing.1;
        self.typing.1 = typing;
        if is_new && !is_typing_on {
            // From press to release is one gesture; each key is its own.
            self.gesture += u64::from(!self.is_playing);
        }
    }

    /// Turns the panels' changes of the draft into a command. After another command (undo, say) the draft is outdated and
    /// dropped.
    fn submit_edits(&mut self, scene: &mut Scene) {
        if self.is_scene_replaced || scene == self.session.scene() {
            return;
        }
        if self.press.is_cancelled {
            // The panels show the changed copy of the scene.
            return self.request_frame();
        }
        if let Err(error) = self.edit(scene) {
            self.notice = Some(Notice::error(error.to_string()));
        }
    }

    /// Submits an edited scene as a step of the present gesture. A position outside of the pocket is repaired first.
    fn edit(&mut self, scene: &mut Scene) -> Result<(), CommandError> {
        let repair = scene.repair();
        self.is_edited = true;
        if !scene.is_same_plan(self.session.scene()) {
            self.volume_marks.want();
        }
        self.request_frame();
        self.apply(Command::Edit { scene: Box::new(scene.clone()), gesture: self.gesture })?;
        if let Some(repair) = repair {
            self.notice = Some(Notice::caution(self.plan.device.words(&repair.to_string())));
        }
        Ok(())
    }

    /// Sets a field of the plan by its name, as one step of the history. A number may have a decimal comma and a unit.
    ///
    /// # Errors
    /// Returns one line with what is wrong and what is allowed; the plan is then unchanged.
    pub fn set_plan(&mut self, name: &str, text: &str) -> Result<(), String> {
        let (mut scene, mut choices) = (self.session.scene().clone(), self.plan);
        plan::set(&mut scene, &mut choices, name, text)?;
        if scene == *self.session.scene() {
            return Ok(());
        }
        self.gesture += 1;
        self.is_playing &= scene.insertion.to_bits() == self.session.scene().insertion.to_bits();
        self.edit(&mut scene).map_err(|error| error.to_string())?;
        self.plan = choices;
        Ok(())
    }

    /// Reads dropped files and reports finished dialogs.
    fn poll_files(&mut self, ctx: &egui::Context) {
        for file in ctx.input(|input| input.raw.dropped_files.clone()) {
            self.files.dropped(ctx, file);
        }
        while let Some(event) = self.files.next() {
            self.notice = Some(match event {
                FileEvent::Opened { name, text } if is_table(&name) => {
                    self.read_shelf(&name, &text)
                }
                FileEvent::Opened { name, text } => {
                    let opened = self.open(text).map_err(|error| error.to_string());
                    self.show_opened(opened, &name, tr!("Opened {name}.", name))
                }
                FileEvent::Saved(name) => Notice::info(tr!("Saved {name}.", name)),
                FileEvent::Failed(error) => Notice::error(error),
            });
        }
    }

    /// Shows all of an opened plan. Returns the notice: `done`, or why what has the `name` was not opened.
    pub(super) fn show_opened(
        &mut self,
        opened: Result<(), String>,
        name: &str,
        done: String,
    ) -> Notice {
        match opened {
            Ok(()) => {
                self.viewport.fit(&self.session, View::All);
                Notice::info(done)
            }
            Err(error) => Notice::error(tr!(
                "{name} was not opened; the plan is unchanged. {error}",
                name,
                error
            )),
        }
    }

    pub(super) fn save_scene(&mut self, ctx: &egui::Context) {
        let name = self.name_of_file("", "json");
        self.files.save(ctx, &name, self.session.document_json());
    }

    pub(super) fn save_result(&mut self, ctx: &egui::Context) {
        if let Some(text) = self.result_json() {
            self.files.save(ctx, &self.name_without_visit("numbers", "json"), text);
        }
    }
}

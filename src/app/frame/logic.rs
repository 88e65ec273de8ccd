//! The logic of a frame: slices of solving, commands, edits of the panels, files.

use super::files::{FileEvent, is_table};
use super::focus::Boundary;
use super::messages::Notice;
use super::scan::is_marks;
use super::shared::{LONG, RunningSolve, Shared};
use super::status::SliceOf;
use super::toolbar::Layout;
use super::{commands, keys, opened, research, toolbar};
use crate::app::texts::{self, tr};
use crate::app::widgets::theme;
use crate::app::widgets::{drop_typed_number, note_cancelled_press, note_fingers};
use crate::app::{App, Panels, plan};
use crate::measure::no_shape;
use crate::scene::Scene;
use crate::session::{Command, CommandError, Pin, Session};
use crate::solve::Progress;
use eframe::egui::{self, Key, Modifiers, Rect, Ui};
use web_time::{Duration, Instant};

/// Time limit of a slice of solving; the running step is finished.
const SLICE: Duration = Duration::from_millis(10);
/// The same of the solve on a coarser grid: the first one of a drag starts from nothing and takes twice as long as the next ones.
const SLICE_OF_EDIT: Duration = Duration::from_millis(60);
/// The same of the scene's own grid after a coarser one: at first, at most while a pointer is pressed, and at most when none is. Between
/// two slices the time of a frame is lost.
const FIRST_AT_REST: Duration = Duration::from_millis(30);
const LONGEST_HELD: Duration = Duration::from_millis(60);
const LONGEST_AT_REST: Duration = Duration::from_millis(120);
/// Upper limit of a slice of a long solve or of a pin, for slow frames.
const LONG_SLICE: Duration = Duration::from_millis(200);
/// Time limit of the first slice, which solves most opening scenes.
const FIRST_SLICE: Duration = Duration::from_millis(400);

/// The edits of the panels, their gesture and the playback.
#[derive(Default)]
pub(crate) struct Edits {
    /// Copy of the scene that the panels edit, kept between frames.
    draft: Option<Scene>,
    /// Did a command replace the session's scene after the draft was made? The draft is then outdated.
    is_scene_replaced: bool,
    /// Has this frame solved for a slice?
    has_solved: bool,
    /// Was the plan edited since the start? Then the hint is gone.
    pub(crate) is_edited: bool,
    /// Was drawing suspended since the previous frame?
    pub(crate) was_paused: bool,
    /// Number of the present gesture; edits of one gesture are one step of the history.
    pub(crate) gesture: u64,
    /// The text field of the visit with the focus, in this frame and in the previous one.
    pub(crate) typing: (Option<egui::Id>, Option<egui::Id>),
    pub(crate) press: Press,
    /// Notice about an edit of this frame: a position that does not fit the pocket, a side's plan that went or was refused.
    pub(crate) notice: Option<Notice>,
}

/// The last press of the pointer.
#[derive(Default)]
pub(crate) struct Press {
    /// The choices of the plan before the press.
    pub(crate) choices: plan::Choices,
    /// Cancelled by a key: until its release the pointer changes no plan.
    pub(crate) is_cancelled: bool,
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
        self.shared.choices.fit(self.shared.session.scene());
        self.shared.choices.device.note(&ctx);
        research::note(&ctx, self.shared.research);
        if ctx.input(|input| input.pointer.any_pressed()) {
            self.edits.press = Press { choices: self.shared.choices, is_cancelled: false };
        }
        self.handle_keys(&ctx);
        note_cancelled_press(&ctx, self.edits.press.is_cancelled);
        let mut scene = self.edits.draft.take().unwrap_or_default();
        if scene != *self.shared.session.scene() {
            scene.clone_from(self.shared.session.scene());
        }
        self.edits.is_scene_replaced = false;
        self.advance_playback(&ctx);
        self.poll_studies(&ctx);
        // A smaller window shows the upper left part: no control has room in less.
        let room = ui.available_rect_before_wrap();
        let room = Rect::from_min_size(room.min, room.size().max(theme::LEAST_WINDOW));
        let ui = &mut ui.new_child(egui::UiBuilder::new().max_rect(room));
        self.focus.boundary(ui, Boundary::First);
        let is_narrow = ui.available_width() < theme::NARROW || ui.available_height() < theme::LOW;
        let layout = if is_narrow { Layout::Narrow } else { Layout::Wide };
        note_fingers(&ctx, is_narrow);
        if !self.scan_step(ui, &mut scene, layout) {
            match layout {
                Layout::Narrow => self.narrow(ui, &mut scene),
                Layout::Wide => self.wide(ui, &mut scene),
            }
        }
        let hand = if is_narrow { plan::Hand::Finger } else { plan::Hand::Mouse };
        self.show_report_dialog(&ctx, hand);
        toolbar::help(&ctx, &mut self.windows.show_help);
        self.windows.palette.show(&ctx, &self.shared, &mut self.actions);
        if let Some(notice) = self.panels.range.shelf_preview(&ctx) {
            self.notice = Some(notice);
        }
        if self
            .windows
            .curve_window
            .as_mut()
            .is_some_and(|window| !window.show(&ctx, &mut scene, &mut self.actions))
        {
            self.windows.curve_window = None;
        }
        self.focus.boundary(ui, Boundary::Last);
        self.submit_edits(&ctx, &mut scene);
        self.edits.press.is_cancelled &= ctx.input(|input| input.pointer.any_down());
        self.focus.end_frame(&ctx, self.shared.viewport.id());
        self.edits.draft = Some(scene);
        self.edits.was_paused = false;
        // The panels before the slice show its result in the next frame, as do the studies.
        if self.is_solving() || self.edits.has_solved || self.insertion.is_playing() {
            ctx.request_repaint();
        }
        self.note_changes();
        self.shared.timing.add_frame(1000.0 * start.elapsed().as_secs_f64());
    }

    /// Submits the edits so far and solves for one slice, once a frame: the rest of the frame shows the edited shape.
    pub(crate) fn take_edits(&mut self, ctx: &egui::Context, scene: &mut Scene) {
        self.submit_edits(ctx, scene);
        // An edit clears the previous notice, so a notice about this edit is stored after it.
        self.notice = self.edits.notice.take().or(self.notice.take());
        self.edits.has_solved = self.is_solving();
        self.solve_slice(ctx);
        if scene != self.shared.session.scene() {
            scene.clone_from(self.shared.session.scene());
        }
        self.edits.is_scene_replaced = false;
    }

    /// Is there a scene or a pin to solve?
    fn is_solving(&self) -> bool {
        self.shared.session.is_working() || self.shared.session.is_solving_pins()
    }

    /// Solves for one slice.
    fn solve_slice(&mut self, ctx: &egui::Context) {
        if !self.shared.session.is_working() {
            self.shared.solving = None;
            self.solve_pin(ctx);
            return;
        }
        let now = Instant::now();
        let first = RunningSolve { since: now, start: now, fraction: 0.0 };
        let running = self.shared.solving.unwrap_or(first);
        // The app is of no use before its first shape.
        let is_opening = self.shared.session.outcome().is_none() && running.since == now;
        let session = &mut self.shared.session;
        let slice = if is_opening {
            FIRST_SLICE
        } else if session.is_on_coarser_grid() {
            SLICE_OF_EDIT
        } else if running.since.elapsed() > LONG {
            long_slice(ctx)
        } else if session.has_coarser_grid() {
            let is_held = ctx.input(|input| input.pointer.any_down());
            let most = if is_held { LONGEST_HELD } else { LONGEST_AT_REST };
            (2 * running.start.elapsed()).clamp(FIRST_AT_REST, most)
        } else {
            SLICE
        };
        let mut progress = session.solve(&mut || now.elapsed() >= slice);
        // A draft to display would cost the opening scene a frame more: the first frames are slow.
        while is_opening && progress == Progress::Working && now.elapsed() < slice {
            progress = session.solve(&mut || now.elapsed() >= slice);
        }
        session.note_time(now.elapsed().as_secs_f64());
        let scene = if is_opening { SliceOf::OpeningScene } else { SliceOf::EditedScene };
        self.shared.timing.add_slice(1000.0 * now.elapsed().as_secs_f64(), scene);
        self.shared.session.conclude();
        let session = &self.shared.session;
        let fraction = running.fraction.max(session.fraction_done());
        // The solution of a coarser grid is a shape with its numbers: no edit of the drag waits for the ones before.
        let has_solution = session.coarser_nodes_per_side().is_some();
        let since = if has_solution { running.start } else { running.since };
        self.shared.solving = Some(RunningSolve { since, fraction, ..running });
        if let Some(fault) = self.shared.session.reverted() {
            let reason = tr(no_shape(Some(fault)));
            self.notice = Some(Notice::error(tr!(
                "The last change was undone. {reason} Redo repeats the change.",
                reason
            )));
        }
    }

    /// Advances the studies. New jobs wait for a solve of the app, unless that takes long. At rest the nearest plans with an answer come
    /// first, then the largest usual volume, then a few sampled patients.
    fn poll_studies(&mut self, ctx: &egui::Context) {
        let is_working = self.shared.session.is_working();
        self.studies.poll(ctx, is_working && !self.shared.is_long());
        let Self { shared, studies, panels, .. } = self;
        let Shared { session, choices, uncertainty, volume_marks, practices, .. } = shared;
        let Panels { range, filling, times, nearest, shelf_largest } = panels;
        let scene = session.scene();
        studies.share(session);
        // What is not known is sampled after an edit and its solve.
        let is_held = ctx.input(|input| input.pointer.any_down());
        let is_busy = is_working || self.insertion.is_playing() || is_held;
        let pins = session.pins().iter().map(Pin::scene);
        let wanted = std::iter::once(scene).chain(scene.other_side.as_deref());
        let wanted = wanted.chain(volume_marks.beside()).chain(pins);
        let wanted: Vec<&Scene> =
            wanted.chain(range.wanted()).chain(shelf_largest.wanted()).collect();
        practices.advance(&wanted, choices.device, studies, is_busy);
        range.advance(ctx, scene, practices, studies);
        filling.advance(scene, choices.device, studies, is_busy);
        times.advance(scene, studies, is_busy);
        nearest.advance(session, studies, is_busy);
        range.judge_sizes(scene, practices, studies, is_busy);
        let sizes = &range.sizes;
        // The largest usual volume comes after the nearest plans with an answer.
        let is_searched = is_busy || !nearest.is_at_rest(session);
        volume_marks.want_after_rest(ctx, is_searched);
        let bands = uncertainty.choices(scene);
        volume_marks.advance(scene, bands, practices, studies, is_searched);
        shelf_largest.advance(scene, sizes, practices, studies, is_busy);
        let is_known = volume_marks.is_known(scene);
        uncertainty.advance(session, studies, ctx, practices, is_busy, is_known);
    }

    /// Solves a pin for one slice.
    fn solve_pin(&mut self, ctx: &egui::Context) {
        let (now, slice) = (Instant::now(), long_slice(ctx));
        self.shared.session.advance_pins(&mut || now.elapsed() >= slice);
    }

    /// Cancels the running solve and restores the previous scene, if there is one. A pin that waits for this solve is removed.
    pub(crate) fn cancel(&mut self) {
        let session = &mut self.shared.session;
        let waits =
            |pin: &&Pin| pin.outcome().is_none() && pin.scene().same_physics(session.scene());
        let waiting = session.pins().iter().find(waits).map(Pin::letter);
        session.cancel();
        let removed = waiting.filter(|letter| session.apply(Command::Unpin(*letter)).is_ok());
        self.edits.is_scene_replaced = true;
        self.insertion.stop();
        self.shared.solving = None;
        self.shared.timing.solve_ms = 0.0;
        let mut words = Vec::new();
        if !self.shared.session.is_stopped() {
            words.push(
                tr("Cancelled. The previous plan is open; Redo computes the cancelled one again.")
                    .to_owned(),
            );
        }
        words.extend(
            removed.map(|letter| tr!("Pin {letter} of the cancelled plan is removed.", letter)),
        );
        self.notice = (!words.is_empty()).then(|| Notice::info(words.join(" ")));
    }

    /// Applies a command to the session.
    pub(crate) fn apply(&mut self, command: Command) -> Result<(), CommandError> {
        let counted = |session: &Session| (session.revision(), session.counters().solves);
        let before = counted(&self.shared.session);
        let is_other_plan = matches!(command, Command::Open(_) | Command::OpenPin(_));
        self.shared.session.apply(command)?;
        if is_other_plan {
            drop_typed_number(&self.ctx);
        }
        self.notice = None;
        self.edits.is_scene_replaced = true;
        let now = counted(&self.shared.session);
        if now != before {
            self.shared.timing.solve_ms = 0.0;
        }
        if now.0 != before.0 {
            self.shared.solving = None;
        } else if now.1 != before.1
            && let Some(running) = &mut self.shared.solving
        {
            (running.start, running.fraction) = (Instant::now(), 0.0);
        }
        Ok(())
    }

    /// Counts the gesture of this frame's edits, once the panel of the plan is shown.
    pub(crate) fn count_gesture(&mut self, ctx: &egui::Context) {
        let is_new = ctx.input(|input| {
            let pointer = &input.pointer;
            pointer.any_pressed() || !(pointer.any_down() || pointer.any_released())
        });
        // The typing in one field of text is one gesture.
        let typing = self.edits.typing.0.take();
        let is_typing_on = typing.is_some() && typing == self.edits.typing.1;
        self.edits.typing.1 = typing;
        if is_new && !is_typing_on {
            // From press to release is one gesture; each key is its own.
            self.edits.gesture += 1;
        }
    }

    /// Performs the panels' actions, then turns their changes of the draft into a command. After another command (undo, say) the
    /// draft is outdated and dropped.
    fn submit_edits(&mut self, ctx: &egui::Context, scene: &mut Scene) {
        self.perform_all(ctx);
        if self.edits.is_scene_replaced || scene == self.shared.session.scene() {
            return;
        }
        if self.edits.press.is_cancelled {
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
        self.edits.is_edited = true;
        if !scene.is_same_plan(self.shared.session.scene()) {
            self.shared.volume_marks.want();
        }
        self.request_frame();
        self.apply(Command::Edit { scene: Box::new(scene.clone()), gesture: self.edits.gesture })?;
        if let Some(repair) = repair {
            self.notice = Some(Notice::caution(
                self.shared.choices.device.words(&texts::shown(&repair.to_string())),
            ));
        }
        Ok(())
    }

    /// Sets a field of the plan by its name, as one step of the history. A number may have a decimal comma and a unit.
    ///
    /// # Errors
    /// Returns one line with what is wrong and what is allowed; the plan is then unchanged.
    pub fn set_plan(&mut self, name: &str, text: &str) -> Result<(), String> {
        let (mut scene, mut choices) = (self.shared.session.scene().clone(), self.shared.choices);
        plan::set(&mut scene, &mut choices, name, text)?;
        if scene == *self.shared.session.scene() {
            return Ok(());
        }
        self.edits.gesture += 1;
        self.edit(&mut scene).map_err(|error| error.to_string())?;
        self.shared.choices = choices;
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
                    match &mut self.windows.curve_window {
                        Some(window) => window.read_file(&name, text),
                        None => match self.read_table(&name, &text) {
                            Some(notice) => notice,
                            None => continue,
                        },
                    }
                }
                FileEvent::Opened { name, text } if is_marks(&text) => {
                    match self.read_marks(&name, &text) {
                        Some(notice) => notice,
                        None => continue,
                    }
                }
                FileEvent::Opened { name, text } => {
                    let opened = opened::plan_of(text)
                        .and_then(|plan| self.open(plan).map_err(|error| error.to_string()));
                    self.show_opened(opened, &name, tr!("Opened {name}.", name))
                }
                FileEvent::Surface { name, read, proposed } => {
                    self.open_scan(name, *read, proposed.map(|marks| *marks));
                    continue;
                }
                FileEvent::Saved(name) => {
                    self.notify_saved(&name);
                    continue;
                }
                FileEvent::Failed(error) => Notice::error(error),
            });
        }
    }

    /// Executes the shortcuts pressed since the previous frame.
    fn handle_keys(&mut self, ctx: &egui::Context) {
        ctx.input_mut(|input| self.windows.palette.hold_typing(input));
        for command in ctx.input_mut(keys::take_history_keys) {
            match command {
                Command::Undo => self.undo(),
                Command::Redo => self.redo(),
                command => self.execute(command),
            }
        }
        self.run_keys(ctx, false);
        self.escape(ctx);
        // Single keys act on the picture while it has the focus. Elsewhere they are text.
        let focused = ctx.memory(egui::Memory::focused);
        if focused.is_none() || focused != self.shared.viewport.id() || self.scan.is_some() {
            return;
        }
        for step in keys::insertion_steps(ctx) {
            let mut scene = self.shared.session.scene().clone();
            // Rounded to whole percent: steps of 0.02 accumulate rounding errors.
            let percent = (100.0 * (scene.insertion + step)).round();
            scene.insertion = (percent / 100.0).clamp(0.0, 1.0);
            self.replace(scene);
        }
        self.run_keys(ctx, true);
    }

    fn run_keys(&mut self, ctx: &egui::Context, on_picture: bool) {
        for task in commands::pressed(ctx, on_picture) {
            self.run(ctx, task);
        }
    }

    /// Escape cancels a drag of a handle or a slider, or removes a mark of the picture, unless Escape belongs to another control.
    fn escape(&mut self, ctx: &egui::Context) {
        let is_pressed = ctx.input(|input| input.key_pressed(Key::Escape));
        let is_elsewhere = self.windows.show_help
            || self.windows.curve_window.is_some()
            || self.windows.report_dialog.is_some()
            || self.windows.palette.is_open()
            || self.panels.range.has_preview();
        if !is_pressed || is_elsewhere || egui::Popup::is_any_open(ctx) {
            return;
        }
        let picture = self.shared.viewport.id();
        let has_focus = self.focus.is_on(picture);
        let is_free = has_focus || self.focus.is_nowhere();
        let is_taken = self.cancel_press(ctx)
            || (is_free && !self.shared.is_long() && self.shared.viewport.remove_mark());
        if is_taken {
            // Escape has removed the focus; the next key is one for the picture too.
            if let Some(picture) = picture.filter(|_| has_focus) {
                ctx.memory_mut(|memory| memory.request_focus(picture));
            }
            ctx.input_mut(|input| input.count_and_consume_key(Modifiers::NONE, Key::Escape));
        }
    }

    /// Cancels the drag of a handle or a slider: plan and history are as before, and the rest of the drag changes nothing. Returns
    /// whether there was one.
    fn cancel_press(&mut self, ctx: &egui::Context) -> bool {
        let is_held = ctx.input(|input| input.pointer.any_down());
        if !is_held || self.edits.press.is_cancelled {
            return false;
        }
        let before = self.shared.session.scene().clone();
        self.execute(Command::CancelGesture(self.edits.gesture));
        let is_edited = before != *self.shared.session.scene();
        if is_edited || self.handles.is_dragged() || plan::is_torso_waiting(ctx) {
            self.edits.press.is_cancelled = true;
            self.shared.choices = self.edits.press.choices;
        }
        self.edits.press.is_cancelled
    }

    pub(crate) fn toggle_playback(&mut self) {
        self.insertion.toggle(self.shared.session.scene());
    }

    /// Advances the playback of the insertion by a frame.
    fn advance_playback(&mut self, ctx: &egui::Context) {
        let since = if self.edits.was_paused { 0.0 } else { ctx.input(|input| input.stable_dt) };
        let (now, slice) = (Instant::now(), long_slice(ctx));
        let scene = self.shared.session.scene();
        let mut pause = || now.elapsed() >= slice;
        if self.insertion.advance(scene, since.clamp(0.0, 0.2), &mut pause).is_err() {
            let words = tr("The insertion is not shown: a step of it has no answer.");
            self.notice = Some(Notice::caution(words));
        }
    }
}

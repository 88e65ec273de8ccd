//! Executes the actions of panels and the commands of keys.

use super::action::{Action, Purpose, Task};
use super::commands::{QUANTITIES, why_not};
use super::messages::Notice;
use super::shared::{LONG, Shared};
use super::ui::Windows;
use super::{files, link};
use crate::app::paper::report::{Choice, ReportDialog};
use crate::app::paper::{numbers, report};
use crate::app::picture::viewport::Before;
use crate::app::texts::{self, Language, language, set_language, tr};
use crate::app::{App, plan};
use crate::clinical::{Dimension, is_practice_table};
use crate::export;
use crate::measure::meridians;
use crate::scene::Scene;
use crate::session::{Command, CommandError};
use crate::view::camera::View;
use crate::view::quantity::Quantity;
use eframe::egui;

/// What an opened plan with her chest, but without her surface, does not show.
const STAND_IN: &str =
    "Her body is not in it: the picture is that of a usual torso, the numbers are hers.";

impl App {
    /// Executes the actions of the panels so far.
    pub(crate) fn perform_all(&mut self, ctx: &egui::Context) {
        for action in std::mem::take(&mut self.actions) {
            self.perform(ctx, action);
        }
    }

    fn perform(&mut self, ctx: &egui::Context, action: Action) {
        match action {
            Action::Run(task) => self.run(ctx, task),
            Action::Session(command) => self.execute(command),
            Action::Replace(scene) => self.replace(scene),
            Action::Accept(scene) => self.accept(*scene),
            Action::TakeNearest(scene) => {
                // The projection follows a smaller volume.
                if scene.implant != self.shared.session.scene().implant {
                    self.shared.choices.follows = Dimension::Projection;
                }
                self.accept(scene);
            }
            Action::Cancel => self.cancel(),
            Action::EndScan(choice) => self.end_scan(choice),
            Action::Resume => self.shared.session.resume(),
            Action::ColourBy(quantity) => self.shared.options.quantity = quantity,
            Action::CutAt(degrees) => self.shared.options.section_azimuth_deg = degrees,
            Action::ShowSection(plane) => self.shared.chosen_plane = Some(plane),
            Action::KeepValues(place) => self.shared.viewport.keep_values(place),
            Action::Save(name, content) => self.files.save(ctx, &name, content),
            Action::ReadShelf(name, text) => {
                self.notice = self.read_table(&name, &text).or(self.notice.take());
            }
            Action::Notify(notice) => self.notice = Some(notice),
            Action::CloseNotice => self.notice = None,
        }
        self.request_frame();
    }

    /// Executes a command that works.
    pub(crate) fn run(&mut self, ctx: &egui::Context, task: Task) {
        if why_not(&self.shared, task).is_some() {
            return;
        }
        let Shared { session, options, viewport, show_strip, research, choices, .. } =
            &mut self.shared;
        let Windows { palette, show_help, .. } = &mut self.windows;
        match task {
            Task::OpenPlan => self.files.open(ctx),
            Task::OpenTable => self.files.open_table(ctx),
            Task::SavePlan => {
                let text = self.shared.document();
                self.files.save(ctx, &self.name_with_visit("json"), text);
            }
            Task::SaveNumbers => {
                if let Some(text) = self.result_json() {
                    self.save_numbers(ctx, "json", text);
                }
            }
            Task::SaveTable => {
                let sampled = |scene: &Scene| self.shared.uncertainty.values(scene);
                let seen = (&self.shared.session, &self.shared.measured);
                let text = export::csv(&numbers::table(seen, &sampled));
                self.save_numbers(ctx, "csv", text);
            }
            Task::TakeHome(Purpose::Report) => {
                self.windows.report_dialog = Some(ReportDialog::new(session.scene()));
            }
            Task::TakeHome(purpose) => self.take_home(ctx, purpose),
            Task::CopyLink => self.copy_link(ctx),
            Task::SaveProfile => {
                let table = export::profile(&meridians(session.solution()));
                let name = files::name_with_size(session.scene(), choices.device, "profile", "csv");
                self.files.save(ctx, &name, table);
            }
            Task::UsualImplant | Task::StartOver => self.open_example(Scene::first_plan()),
            Task::HalfSphere => self.open_example(Scene::default()),
            Task::Undo => self.undo(),
            Task::Redo => self.redo(),
            Task::Pin => self.execute(Command::Pin),
            Task::Look(view) => viewport.look(session, options, view),
            Task::Show(subject) => viewport.change(session, options, |o| o.set_subject(subject)),
            Task::Cut(section, half) => viewport.change(session, options, |options| {
                (options.section, options.half) = (section, half);
            }),
            Task::Colour(k) => {
                options.quantity = QUANTITIES.get(k).copied().unwrap_or(Quantity::Tissue);
            }
            Task::Grid => options.net = !options.net,
            Task::Areola => *options.areola_mut() = !options.has_areola(),
            Task::CrossSection => *show_strip = !*show_strip,
            Task::Torso => viewport.change(session, options, |o| o.torso = !o.torso),
            Task::KeepSurface => self.shared.keep_surface = !self.shared.keep_surface,
            Task::ShowBefore(way) => {
                options.before = if options.before == way { Before::Off } else { way };
            }
            Task::Ruler => {
                self.panels.range.is_open = false;
                viewport.toggle_ruler();
            }
            Task::Research => {
                *research = !*research;
                self.keep.is_research_due = true;
            }
            Task::Play => self.toggle_playback(),
            Task::ShowRange(is_open) => self.panels.range.is_open = is_open,
            Task::Theme(theme) => ctx.set_theme(theme),
            Task::Language(language) => self.choose_language(language),
            Task::List => palette.toggle(),
            Task::Help => *show_help = !*show_help,
        }
        self.request_frame();
    }

    fn open_example(&mut self, scene: Scene) {
        self.replace(scene);
        self.shared.choices = plan::Choices::default();
        self.look_at_all();
    }

    /// The camera's first view.
    fn look_at_all(&mut self) {
        let Shared { viewport, session, options, .. } = &mut self.shared;
        viewport.look(session, options, View::All);
    }

    /// Takes an offered plan.
    fn accept(&mut self, mut scene: Scene) {
        // Side and visit may be newer than the offer.
        let now = self.shared.session.scene();
        (scene.side, scene.visit) = (now.side, now.visit.clone());
        scene.other_side.clone_from(&now.other_side);
        self.edits.is_edited = true;
        self.replace(scene);
    }

    /// Opens a scene as one step of the history.
    pub(crate) fn replace(&mut self, scene: Scene) {
        self.edits.gesture += 1;
        self.execute(Command::Edit { scene: Box::new(scene), gesture: self.edits.gesture });
    }

    /// Takes a practice table, or opens the preview of a table of sizes. Returns what there is to say.
    pub(crate) fn read_table(&mut self, name: &str, text: &str) -> Option<Notice> {
        if is_practice_table(text) {
            let practices = &mut self.shared.practices;
            return Some(match practices.read(text) {
                Ok(()) => Notice::info(tr!(
                    "The practice table of {name} is in use: {rows} base widths.",
                    name,
                    rows = practices.table().starts().len()
                )),
                Err(error) => Notice::error(tr!(
                    "{name} was not read; the practice table is unchanged. {error}.",
                    name,
                    error = texts::shown(&error)
                )),
            });
        }
        self.panels.range.read_shelf(name, text)
    }

    /// Shows all of an opened plan. Returns the notice: `done`, or why what has the `name` was not opened.
    pub(crate) fn show_opened(
        &mut self,
        opened: Result<(), String>,
        name: &str,
        done: String,
    ) -> Notice {
        match opened {
            Ok(()) => {
                self.look_at_all();
                match self.shared.has_stand_in() {
                    true => Notice::caution(format!("{done} {}", tr(STAND_IN))),
                    false => Notice::info(done),
                }
            }
            Err(error) => Notice::error(tr!(
                "{name} was not opened; the plan is unchanged. {error}",
                name,
                error
            )),
        }
    }

    /// Executes a command of the session and reports its error, if any.
    pub(crate) fn execute(&mut self, command: Command) {
        let is_pin = matches!(command, Command::Pin);
        match self.apply(command) {
            Ok(()) if is_pin && self.shared.session.is_working() => {
                let words = tr("The plan is pinned; its numbers come once it is solved.");
                self.notice = Some(Notice::info(words));
            }
            Ok(()) => {}
            Err(error @ CommandError::Pinned(_)) => {
                self.notice = Some(Notice::info(error.to_string()));
            }
            Err(error) => self.notice = Some(Notice::error(error.to_string())),
        }
    }

    /// Shows the texts in a language, which the platform keeps.
    fn choose_language(&mut self, choice: Language) {
        if choice != language() {
            set_language(choice);
            self.keep.is_language_due = true;
        }
    }

    fn name_with_visit(&self, extension: &str) -> String {
        let (scene, device) = (self.shared.session.scene(), self.shared.choices.device);
        files::name_with_visit(scene, device, "", extension)
    }

    fn save_numbers(&self, ctx: &egui::Context, extension: &str, text: String) {
        let (scene, device) = (self.shared.session.scene(), self.shared.choices.device);
        let name = files::name_without_visit(scene, device, "numbers", extension);
        self.files.save(ctx, &name, text);
    }

    /// Shows the dialog in front of a report; saves the report once the user says so.
    pub(crate) fn show_report_dialog(&mut self, ctx: &egui::Context, hand: plan::Hand) {
        let Some(mut dialog) = self.windows.report_dialog.take() else { return };
        match dialog.show(ctx, hand) {
            None => self.windows.report_dialog = Some(dialog),
            Some(Choice::Cancel) => {}
            Some(Choice::Save) => {
                let mut scene = self.shared.session.scene().clone();
                dialog.write_to(&mut scene);
                if scene != *self.shared.session.scene() {
                    self.replace(scene);
                }
                self.take_home(ctx, Purpose::Report);
            }
        }
    }

    /// Saves or copies a picture or the report, or shows why not.
    fn take_home(&mut self, ctx: &egui::Context, purpose: Purpose) {
        if let Err(error) = self.try_to_take_home(ctx, purpose) {
            let words = tr!("No picture was made: {error}.", error);
            self.notice = Some(Notice::error(words));
        }
    }

    /// Needs the graphics of a frame.
    fn try_to_take_home(&mut self, ctx: &egui::Context, purpose: Purpose) -> Result<(), String> {
        let Self { shared, panels, .. } = self;
        // The words on paper are those against practice, unless its volumes take long.
        let Shared { session, practices, timing, .. } = shared;
        if timing.solve_ms < LONG.as_secs_f64() * 1000.0 && !session.is_working() {
            practices.know(session.scene());
        }
        let (extension, content) = match purpose {
            Purpose::File => ("png", report::png_of(&report::figure(shared)?)?),
            Purpose::Report => (
                files::REPORT,
                report::report(shared, &mut panels.range, (&panels.filling, &panels.times))?
                    .into_bytes(),
            ),
            Purpose::Clipboard => {
                ctx.copy_image(report::figure(shared)?);
                self.notice = Some(Notice::info(tr("The picture is in the clipboard.")));
                return Ok(());
            }
        };
        self.files.save(ctx, &self.name_with_visit(extension), content);
        Ok(())
    }

    /// Shows that a file was saved; of a report without patient's number or side what is missing.
    pub fn notify_saved(&mut self, name: &str) {
        let is_report = name.rsplit_once('.').is_some_and(|(_, end)| end == files::REPORT);
        let missing = plan::missing_for_file(self.shared.session.scene()).filter(|_| is_report);
        self.notice = Some(match missing {
            None => Notice::info(tr!("Saved {name}.", name)),
            Some(missing) => Notice::caution(tr!("Saved {name}. {missing}.", name, missing)),
        });
    }

    /// Copies the link of the plan, in a page.
    fn copy_link(&mut self, ctx: &egui::Context) {
        let Some(address) = &self.shared.page_address else { return };
        let session = &self.shared.session;
        let link = link::link(address, session);
        let length = link.len();
        ctx.copy_text(link);
        let left_out = match session.scene().visit {
            Some(_) => tr(", without the entries for the file"),
            None => "",
        };
        self.notice = Some(Notice::info(tr!(
            "The link is in the clipboard: {length} characters, which hold the whole plan{left_out}. Nothing is stored \
             elsewhere.",
            length,
            left_out
        )));
    }
}

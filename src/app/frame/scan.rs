//! The step of a scan in place of plan and answer: opened by a file, ended by the panel.

use super::action::Action;
use super::messages::Notice;
use super::toolbar::{self, Layout};
use super::ui::{column, side_panel};
use crate::app::plan::Hand;
use crate::app::scan::{Choice, Scan};
use crate::app::texts::tr;
use crate::app::{App, widgets::theme};
use crate::body::marks::Marks;
use crate::body::read::Read;
use crate::scene::Scene;
use crate::session::Command;
use crate::view::camera::View;
use eframe::egui::{self, Ui};
use web_time::{Duration, Instant};

/// Time within which a scan that was dropped with its marks is read.
const READING: Duration = Duration::from_secs(20);

/// Marks that came before their scan: time, name and text of the file.
pub(crate) struct EarlyMarks(Instant, String, String);

/// Is a text the marks of a body?
pub(super) fn is_marks(text: &str) -> bool {
    text.trim_start().starts_with('{')
        && text.contains("\"sternal_notch\"")
        && !text.contains("\"implant\"")
}

impl App {
    /// Opens the step for the surface of a file.
    pub(crate) fn open_scan(&mut self, name: String, read: Read, proposed: Option<Marks>) {
        let plan = self.shared.session.scene();
        self.notice = None;
        self.insertion.stop();
        self.panels.range.is_open = false;
        self.scan = Some(Scan::new(name, read, proposed, plan));
        let early = self.early_marks.take().filter(|early| early.0.elapsed() < READING);
        if let Some(EarlyMarks(_, name, text)) = early {
            self.notice = self.read_marks(&name, &text);
        }
    }

    /// Takes the marks of a file. Returns what there is to say.
    pub(crate) fn read_marks(&mut self, name: &str, text: &str) -> Option<Notice> {
        let Some(scan) = &mut self.scan else {
            self.early_marks = Some(EarlyMarks(Instant::now(), name.to_owned(), text.to_owned()));
            let words = tr("These are marks of a body: open its scan (PLY, STL, OBJ, GLB) first.");
            return Some(Notice::info(words));
        };
        Some(match scan.take_marks(text) {
            Ok(()) => Notice::info(tr!("The marks are those of {name}.", name)),
            Err(error) => Notice::error(tr!("{name} cannot be read: {error}", name, error)),
        })
    }

    /// Takes the last step back: of the marks while they are set, else of the plan.
    pub(crate) fn undo(&mut self) {
        match &mut self.scan {
            Some(scan) => scan.undo(),
            None => self.execute(Command::Undo),
        }
    }

    /// Takes the step again that was taken back last: of a scan's marks while they are set, otherwise of the plan.
    pub(crate) fn redo(&mut self) {
        match &mut self.scan {
            Some(scan) => scan.redo(),
            None => self.execute(Command::Redo),
        }
    }

    /// Ends the step: the plan has the body as one step of its history, or is as it was.
    pub(crate) fn end_scan(&mut self, choice: Choice) {
        let Some(mut scan) = self.scan.take() else { return };
        self.notice = None;
        if choice == Choice::Cancel {
            return;
        }
        match scan.plan(self.shared.session.scene()) {
            Ok((scene, words)) => {
                self.edits.is_edited = true;
                self.shared.viewport.keep_scan(&scene, scan.surface());
                self.replace(scene);
                self.shared.viewport.look(&self.shared.session, &self.shared.options, View::All);
                if self.notice.is_none() {
                    let done = tr("The plan has her body.");
                    self.notice = Some(match words.is_empty() {
                        true => Notice::info(done),
                        false => Notice::caution(format!("{done} {words}")),
                    });
                }
            }
            Err(error) => {
                self.notice = Some(Notice::error(error));
                self.scan = Some(scan);
            }
        }
    }

    /// Arranges the step on the screen; `false` without a scan.
    pub(crate) fn scan_step(&mut self, ui: &mut Ui, scene: &mut Scene, layout: Layout) -> bool {
        if self.scan.is_none() {
            return false;
        }
        let bar = egui::Panel::top("toolbar").resizable(false);
        bar.show(ui, |ui| toolbar::show(ui, layout, &self.shared, &mut self.actions));
        match layout {
            Layout::Wide => {
                let [width, _] = self.screen.panel_widths.fitting(ui.available_width());
                side_panel(ui, egui::Panel::left("scan"), width).show(ui, |ui| {
                    column("scan").show(ui, |ui| {
                        self.scan_controls(ui, Hand::Mouse);
                        self.scan_buttons(ui);
                        self.focus.scroll_into_view(ui);
                    });
                });
            }
            Layout::Narrow => {
                let screen = ui.ctx().content_rect().size().max(theme::LEAST_WINDOW);
                let sheet = if screen.x > screen.y {
                    egui::Panel::right("scan beside").exact_size(0.5 * screen.x)
                } else {
                    egui::Panel::bottom("scan below").exact_size(0.46 * screen.y)
                };
                sheet.resizable(false).show(ui, |ui| {
                    // In sight however far the controls are scrolled.
                    egui::Panel::bottom("scan buttons")
                        .resizable(false)
                        .show(ui, |ui| self.scan_buttons(ui));
                    let column = egui::ScrollArea::vertical().auto_shrink([false, false]);
                    column.show(ui, |ui| {
                        self.scan_controls(ui, Hand::Finger);
                        self.focus.scroll_into_view(ui);
                    });
                });
            }
        }
        self.take_edits(ui.ctx(), scene);
        egui::CentralPanel::no_frame().show(ui, |ui| {
            let area = ui.available_rect_before_wrap();
            if let Some(scan) = &mut self.scan {
                let dots = scan.dots();
                let torso = scan.drawn();
                let Self { shared, .. } = self;
                let touched = shared.viewport.show_scan(ui, &shared.session, torso, &dots);
                if let Some(touched) = touched {
                    scan.touch(touched);
                    ui.ctx().request_repaint();
                }
            }
            self.show_notice(ui, area);
        });
        true
    }

    fn scan_controls(&mut self, ui: &mut Ui, hand: Hand) {
        if let Some(scan) = &mut self.scan {
            scan.show(ui, self.shared.session.scene(), hand);
        }
    }

    fn scan_buttons(&mut self, ui: &mut Ui) {
        if let Some(scan) = &mut self.scan {
            let choice = scan.buttons(ui, self.shared.session.scene());
            self.actions.extend(choice.map(Action::EndScan));
        }
    }
}

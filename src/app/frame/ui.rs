//! Layout of the screen. Wide: plan, picture, answer side by side. Narrow: the picture over a sheet with the three
//! figures of the answer and tabs.

use super::action::{Action, Task};
use super::messages;
use super::messages::NoticeAction;
use super::palette::Palette;
use super::panel_widths::PanelWidths;
use super::shared::Shared;
use super::toolbar::{Layout, disclaimer};
use super::{status, toolbar};
use crate::app::answer::uncertainty::Findings;
use crate::app::answer::{compare, details, no_answer, plots};
use crate::app::curve_editor::CurveWindow;
use crate::app::paper::report::ReportDialog;
use crate::app::picture::insertion::Insertion;
use crate::app::picture::viewport::{Before, Shown};
use crate::app::picture::{strip, view_bar};
use crate::app::plan::advanced;
use crate::app::plan::volume_marks::headline;
use crate::app::texts::tr;
use crate::app::widgets::{steady, theme};
use crate::app::{App, answer, plan};
use crate::measure::Status;
use crate::scene::Scene;
use eframe::egui::{self, Rect, RichText, Ui};
use plan::Hand;

/// A tab of the bottom sheet on narrow screens.
#[derive(Clone, Copy, Default, PartialEq, Eq)]
enum NarrowTab {
    #[default]
    Implant,
    Patient,
    Pocket,
    More,
}

/// What of the arrangement lasts.
pub(crate) struct Screen {
    narrow_tab: NarrowTab,
    pub(super) panel_widths: PanelWidths,
    /// Height of the controls on the picture in the previous frame \[points\].
    view_bar_height: f32,
}

impl Default for Screen {
    fn default() -> Self {
        let (narrow_tab, panel_widths) = Default::default();
        Self { narrow_tab, panel_widths, view_bar_height: 40.0 }
    }
}

/// The windows over the screen.
#[derive(Default)]
pub(crate) struct Windows {
    pub(crate) palette: Palette,
    pub(crate) show_help: bool,
    pub(crate) curve_window: Option<CurveWindow>,
    pub(crate) report_dialog: Option<ReportDialog>,
}

/// Width in which the answer takes one line \[points\].
const ONE_LINE: f32 = 620.0;

const TABS: [(NarrowTab, &str); 4] = [
    (NarrowTab::Implant, "Implant"),
    (NarrowTab::Patient, "Patient"),
    (NarrowTab::Pocket, "Pocket"),
    (NarrowTab::More, "More"),
];

impl App {
    /// Arranges the panels of a wide screen.
    pub(crate) fn wide(&mut self, ui: &mut Ui, scene: &mut Scene) {
        let [plan, answer] = self.screen.panel_widths.fitting(ui.available_width());
        egui::Panel::top("toolbar")
            .resizable(false)
            .show(ui, |ui| toolbar::show(ui, Layout::Wide, &self.shared, &mut self.actions));
        egui::Panel::bottom("status").resizable(false).show(ui, |ui| {
            self.status_row(ui, Layout::Wide);
        });
        let left = side_panel(ui, egui::Panel::left("plan"), plan).show(ui, |ui| {
            column("plan").show(ui, |ui| {
                self.plan(ui, scene);
                self.focus.scroll_into_view(ui);
            });
        });
        self.count_gesture(ui.ctx());
        self.take_edits(ui.ctx(), scene);
        let right = side_panel(ui, egui::Panel::right("answer"), answer).show(ui, |ui| {
            column("answer").show(ui, |ui| {
                self.answer(ui, Layout::Wide);
                self.focus.scroll_into_view(ui);
            });
        });
        if self.shared.research {
            let below = egui::Panel::bottom("headline").resizable(false);
            below.show(ui, |ui| self.headline(ui));
        }
        egui::CentralPanel::no_frame().show(ui, |ui| self.central(ui, scene, Layout::Wide));
        self.screen.panel_widths.drag(ui, left.response.rect, right.response.rect);
    }

    /// Arranges picture and sheet of a narrow or low screen: the sheet is below the picture of an upright phone, beside the
    /// picture of a turned one.
    pub(crate) fn narrow(&mut self, ui: &mut Ui, scene: &mut Scene) {
        let toolbar = egui::Panel::top("toolbar").resizable(false);
        toolbar.show(ui, |ui| toolbar::show(ui, Layout::Narrow, &self.shared, &mut self.actions));
        // The picture keeps half of the screen.
        let screen = ui.ctx().content_rect().size().max(theme::LEAST_WINDOW);
        let sheet = if screen.x > screen.y {
            egui::Panel::right("sheet beside").exact_size(0.5 * screen.x)
        } else {
            egui::Panel::bottom("sheet").exact_size(0.46 * screen.y)
        };
        sheet.resizable(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = theme::SPACE_SMALL;
            let findings = self.shared.uncertainty.of_cards(self.shared.session.scene());
            let seen = (&self.shared.session, &self.shared.practices);
            answer::show_short(ui, seen, self.shared.previous_results(), findings);
            self.tabs(ui);
            egui::Panel::bottom("sheet status")
                .resizable(false)
                .show_separator_line(false)
                .show(ui, |ui| self.status_row(ui, Layout::Narrow));
            // Each tab has a place of its own.
            let area = egui::ScrollArea::vertical().id_salt(self.screen.narrow_tab as u8);
            area.auto_shrink([false, false]).show(ui, |ui| {
                self.narrow_tab(ui, scene);
                self.focus.scroll_into_view(ui);
            });
        });
        self.count_gesture(ui.ctx());
        self.take_edits(ui.ctx(), scene);
        egui::CentralPanel::no_frame().show(ui, |ui| self.central(ui, scene, Layout::Narrow));
    }

    /// The parts of the plan, for a mouse.
    fn plan(&mut self, ui: &mut Ui, scene: &mut Scene) {
        let of_sides = plan::sides(ui, scene, Hand::Mouse);
        plan::implant(ui, scene, &mut self.shared.choices, &self.shared.volume_marks, Hand::Mouse);
        self.panels.shelf_largest.show(ui, scene, &mut self.actions);
        steady(ui, "patient and pocket", |ui| {
            self.edits.typing.0 = plan::patient(ui, scene, &self.shared.practices, Hand::Mouse);
            plan::practice(ui, scene, &self.shared.practices, Hand::Mouse);
            plan::pocket(ui, scene, Hand::Mouse);
            self.edits.notice = plan::position(ui, scene, Hand::Mouse).or(of_sides);
            self.tissue(ui, scene, Hand::Mouse);
            advanced::show(ui, scene, &self.shared.session, Hand::Mouse);
        });
    }

    /// The fold of the tissue with its push, which opens the window of a curve.
    fn tissue(&mut self, ui: &mut Ui, scene: &mut Scene, hand: Hand) {
        let Self { insertion, actions, .. } = self;
        let push = |ui: &mut Ui, scene: &mut Scene| {
            insertion_rows(ui, scene, insertion, actions);
        };
        if let Some(layer) = advanced::tissue(ui, scene, hand, push) {
            self.windows.curve_window = CurveWindow::new(scene, layer);
        }
    }

    /// The tabs of the sheet, at the size of a finger.
    fn tabs(&mut self, ui: &mut Ui) {
        ui.columns_const(|columns: &mut [Ui; 4]| {
            for (ui, (tab, name)) in columns.iter_mut().zip(TABS) {
                let name = self.shared.choices.device.words(tr(name));
                let size = egui::vec2(ui.available_width(), theme::TOUCH);
                let button = egui::Button::selectable(self.screen.narrow_tab == tab, name)
                    .frame_when_inactive(true);
                if ui.add_sized(size, button).clicked() {
                    self.screen.narrow_tab = tab;
                }
            }
        });
    }

    fn narrow_tab(&mut self, ui: &mut Ui, scene: &mut Scene) {
        match self.screen.narrow_tab {
            NarrowTab::Implant => {
                self.largest_usual(ui);
                self.edits.notice = plan::sides(ui, scene, Hand::Finger);
                let Shared { choices, volume_marks, .. } = &mut self.shared;
                plan::implant(ui, scene, choices, volume_marks, Hand::Finger);
                plan::fill(ui, scene);
                self.panels.shelf_largest.show(ui, scene, &mut self.actions);
            }
            NarrowTab::Patient => {
                self.edits.typing.0 =
                    plan::patient(ui, scene, &self.shared.practices, Hand::Finger);
                plan::practice(ui, scene, &self.shared.practices, Hand::Finger);
                self.tissue(ui, scene, Hand::Finger);
            }
            NarrowTab::Pocket => {
                plan::pocket(ui, scene, Hand::Finger);
                self.edits.notice = plan::position(ui, scene, Hand::Finger);
                plan::plane(ui, scene, Hand::Finger);
                plan::fluid(ui, scene, Hand::Finger);
            }
            NarrowTab::More => {
                self.answer(ui, Layout::Narrow);
                advanced::show(ui, scene, &self.shared.session, Hand::Finger);
            }
        }
    }

    /// The cards or the missing answer in words, the plan's times, the filling of an expander, what is not known, the comparison and the details.
    fn answer(&mut self, ui: &mut Ui, layout: Layout) {
        answer::heading(ui, &self.shared.session);
        if layout == Layout::Wide {
            self.largest_usual(ui);
        }
        if let Some(words) =
            answer::other_side_in_words(&self.shared.session, &self.shared.practices)
        {
            ui.add(egui::Label::new(RichText::new(words).small()).wrap());
        }
        let Self { shared, panels, actions, .. } = self;
        let (device, palette) = (shared.choices.device, theme::palette(ui.visuals()));
        if no_answer::applies(&shared.session) {
            let largest = shared.volume_marks.largest_plan(shared.session.scene());
            let taken = panels.nearest.card(ui, &shared.session, largest);
            actions.extend(taken.map(Action::TakeNearest));
        } else {
            let scene = shared.session.scene();
            if let Some(words) =
                no_answer::beyond_sold(scene).filter(|_| shared.session.is_working())
            {
                let words = RichText::new(device.words(&words)).color(palette.caution);
                ui.add(egui::Label::new(words.strong()).wrap());
            }
            let near_end = shared.volume_marks.near_end(scene);
            let findings = shared.uncertainty.of_cards(shared.session.scene());
            let previous = shared.previous_results();
            let seen = (&shared.session, &shared.practices);
            answer::show(ui, seen, previous, findings, &near_end);
        }
        steady(ui, "sources", |ui| {
            answer::sources(ui, &shared.session, &mut shared.practices, actions);
        });
        panels.times.section(ui, shared.session.scene());
        panels.filling.section(ui, shared, actions);
        steady(ui, "uncertainty", |ui| shared.uncertainty.show(ui, &shared.session));
        steady(ui, "compare", |ui| {
            let Shared { session, measured, uncertainty, compare, practices, .. } = shared;
            let sampled = |scene: &Scene| uncertainty.values(scene);
            let seen = (&*session, &*measured);
            let command = compare::section(ui, seen, compare, &sampled, practices);
            actions.extend(command.map(Action::Session));
        });
        steady(ui, "details", |ui| self.details(ui, layout));
    }

    /// The largest usual volume in a sentence, which is a link to its plan.
    fn largest_usual(&mut self, ui: &mut Ui) {
        let Shared { session, volume_marks, practices, .. } = &self.shared;
        let taken = headline(ui, session.scene(), volume_marks, practices);
        self.actions.extend(taken.map(|plan| Action::Accept(Box::new(plan))));
    }

    /// The fold with numbers, cross-section and curves.
    fn details(&mut self, ui: &mut Ui, layout: Layout) {
        let shared = &self.shared;
        let (previous, findings) = (shared.previous_results(), shared.uncertainty.findings());
        let (mut chosen, body) = (None, (&shared.session, &shared.measured));
        egui::CollapsingHeader::new(tr("Details")).id_salt("details").show_unindented(ui, |ui| {
            let outcome = answer::visible(&shared.session, previous);
            match outcome.filter(|outcome| outcome.status != Status::Unstable) {
                Some(outcome) => details::show(ui, outcome, findings, body),
                None => {
                    ui.label(
                        RichText::new(tr("No numbers yet.")).color(ui.visuals().weak_text_color()),
                    );
                }
            }
            let band = findings.map_or(&[][..], Findings::section);
            // In sight under the picture where there is room.
            if !self.has_strip(ui.ctx(), layout) {
                let (session, plane) = (&shared.session, shared.section_plane());
                chosen = plots::section(ui, session, &shared.compare, band, plane);
            }
            if shared.research {
                plots::curves(ui, &shared.session, previous);
            }
        });
        self.actions.extend(chosen.map(Action::ShowSection));
    }

    /// State of the computation and model; on a narrow screen the words that are always in sight.
    fn status_row(&mut self, ui: &mut Ui, layout: Layout) {
        let shared = &self.shared;
        ui.horizontal(|ui| {
            // As high with the button of a long solve as without.
            ui.set_min_height(ui.spacing().interact_size.y);
            if let Some(running) = shared.solving.filter(|_| shared.is_long()) {
                let so_far = (running.start.elapsed(), running.fraction);
                // On a narrow screen the words that are always in sight stay.
                let end = |ui: &mut Ui, words| match layout {
                    Layout::Wide => drop(ui.label(words)),
                    Layout::Narrow => disclaimer(ui, layout),
                };
                if messages::progress(ui, so_far, shared.session.displayed(), end) {
                    self.actions.push(Action::Cancel);
                }
                return;
            }
            let beside = (shared.uncertainty.running(), shared.pending());
            status::show(ui, &shared.session, &shared.timing, beside);
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| match layout {
                Layout::Narrow => disclaimer(ui, layout),
                Layout::Wide => {
                    let text = status::model(shared.session.scene(), shared.research);
                    ui.label(RichText::new(text).color(ui.visuals().weak_text_color()));
                }
            });
        });
    }

    /// The answer in one sentence.
    fn headline(&self, ui: &mut Ui) {
        let Shared { session, volume_marks, .. } = &self.shared;
        let mut text =
            answer::headline(session, &self.shared.practices, self.shared.previous_results());
        if self.shared.is_long() {
            // A plan without an answer takes the longest.
            text = format!("{text} {}", volume_marks.near_end(session.scene()));
        }
        // The picture keeps its place whether the sentence takes one line or two.
        let lines = if ui.available_width() < ONE_LINE { 2.0 } else { 1.0 };
        let height = lines * ui.text_style_height(&egui::TextStyle::Body);
        let height = height.max(ui.spacing().interact_size.y);
        ui.add_space(theme::SPACE_SMALL);
        ui.allocate_ui(egui::vec2(ui.available_width(), height), |ui| {
            ui.set_min_height(height);
            ui.add(egui::Label::new(RichText::new(text).strong()).wrap());
        });
        ui.add_space(theme::SPACE_SMALL);
    }

    /// The middle of the screen: the picture of this plan or the range of implants.
    fn central(&mut self, ui: &mut Ui, scene: &mut Scene, layout: Layout) {
        if layout == Layout::Wide {
            self.panels.range.switch(ui, &self.shared, &mut self.actions);
        }
        if self.panels.range.is_open {
            let area = ui.available_rect_before_wrap();
            self.panels.range.page(ui, scene, layout, &self.shared, &mut self.actions);
            self.show_notice(ui, area);
        } else {
            self.picture(ui, scene, layout);
        }
    }

    /// The page of a plan without a shape, or a box over the picture of the last plan with an answer. On a narrow screen
    /// the answer with the nearest plan is behind a tab.
    fn no_shape(&mut self, ui: &mut Ui, area: Rect, scene: &mut Scene, layout: Layout) {
        let Shared { session, choices, volume_marks, .. } = &self.shared;
        let words = choices.device.words(&no_answer::words(session));
        let about_picture = no_answer::about_picture(session);
        let mut accepted = None;
        let add = |ui: &mut Ui| {
            // On a wide screen the card beside the picture has the sentence.
            if about_picture.is_none() || layout == Layout::Narrow {
                ui.label(words);
            }
            if let Some(words) = &about_picture {
                ui.label(words);
            }
            ui.add_space(theme::SPACE_SMALL);
            if layout == Layout::Narrow {
                let largest = volume_marks.largest_plan(session.scene());
                accepted = self.panels.nearest.offer(ui, session, largest, Hand::Finger);
            }
            messages::standard_model(ui, scene);
        };
        match about_picture {
            Some(_) => messages::no_shape_box(ui, area, add),
            None => messages::no_shape_page(ui, add),
        }
        self.actions.extend(accepted.map(Action::TakeNearest));
    }

    /// Is the strip in sight, so that "Details" does without a cross-section?
    fn has_strip(&self, ctx: &egui::Context, layout: Layout) -> bool {
        let has_room = strip::has_room(ctx, layout == Layout::Wide);
        has_room && self.shared.show_strip && !self.panels.range.is_open
    }

    /// Shows the last notice over an area until the user closes it, or until it has faded.
    pub(super) fn show_notice(&mut self, ui: &Ui, area: Rect) {
        let Some(notice) = &mut self.notice else { return };
        if self.edits.was_paused {
            // The time of a hidden tab is no time to read.
            notice.since = None;
        }
        self.actions.extend(notice.show(ui, area).map(|action| match action {
            NoticeAction::Close => Action::CloseNotice,
            NoticeAction::Accept(scene) => Action::Accept(scene),
        }));
    }

    /// The 3-D view with its controls and notices, or the page that replaces the view.
    fn picture(&mut self, ui: &mut Ui, scene: &mut Scene, layout: Layout) {
        let whole = ui.available_rect_before_wrap();
        let session = &self.shared.session;
        let has_page = session.is_stopped() || !no_answer::has_picture(session);
        let has_strip = !has_page && self.has_strip(ui.ctx(), layout);
        let strip = has_strip.then(|| strip::area(whole));
        let area = strip.map_or(whole, |strip| whole.with_max_y(strip.top()));
        let builder = egui::UiBuilder::new().id_salt("picture").max_rect(area);
        let ui = &mut ui.new_child(builder);
        if self.shared.session.is_stopped() {
            if messages::stopped_page(ui) {
                self.actions.push(Action::Resume);
            }
        } else if !no_answer::has_picture(&self.shared.session) {
            self.no_shape(ui, area, scene, layout);
        } else {
            let envelope = self.shared.uncertainty.envelope().unwrap_or_default();
            let (session, options) = (&self.shared.session, &self.shared.options);
            let bar = self.screen.view_bar_height;
            let practices = &self.shared.practices;
            let shown = Shown { envelope, bar, ..Shown::new(session, options, practices) };
            if let Some(between) = self.insertion.shown() {
                self.shared.viewport.show_between(ui, &between, shown);
            } else if session.has_no_shape() {
                self.shared.viewport.show(ui, shown);
                self.no_shape(ui, area, scene, layout);
            } else if self.shared.compare.is_side_by_side(session) {
                self.shared.viewport.show_side_by_side(ui, shown);
            } else {
                let palette = theme::palette(ui.visuals());
                let outlines = plots::outlines(session, &self.shared.compare, palette);
                self.shared.viewport.show(ui, Shown { outlines: &outlines, ..shown });
            }
            let has_shape = !self.shared.session.has_no_shape() && self.insertion.shown().is_none();
            if self.insertion.is_solving() {
                messages::over_picture(ui, area, tr("Computing the insertion…"));
            } else if has_shape && self.shared.is_provisional() {
                messages::provisional(ui, area, self.shared.session.displayed());
            }
            // Beside the body before, a handle would lie on the breast.
            if has_shape && self.shared.options.before == Before::Off {
                let Shared { viewport, choices, .. } = &mut self.shared;
                let is_cancelled = self.edits.press.is_cancelled;
                self.handles.show(ui, viewport, is_cancelled, scene, choices);
            }
            self.screen.view_bar_height =
                view_bar::show(ui, area, layout, &self.shared, &mut self.actions);
            let is_free = self.shared.options.has_free_edge() && layout == Layout::Wide;
            if has_shape && !self.edits.is_edited && is_free {
                messages::hint(ui, area);
            }
        }
        if let Some(strip) = strip {
            let done = strip::show(ui, strip, &self.shared, self.insertion.shown());
            self.actions.extend(done.kept.map(Action::KeepValues));
            self.actions.extend(done.plane.map(Action::ShowSection));
        }
        self.show_notice(ui, area);
    }
}

/// The button that plays the insertion, and the slider of the insertion in the picture.
fn insertion_rows(
    ui: &mut Ui,
    scene: &mut Scene,
    insertion: &Insertion,
    actions: &mut Vec<Action>,
) {
    let name = if insertion.is_playing() { tr("Pause") } else { tr("Show insertion") };
    if ui.button(name).on_hover_text(tr!("{name} (space)", name)).clicked() {
        actions.push(Action::Run(Task::Play));
    }
    let (slider, percent) = plan::insertion(scene);
    let mut percent = insertion.percent().unwrap_or(percent);
    if slider.row(ui, &mut percent, (0.0, |_: &mut Ui| {})).is_changed {
        plan::set_insertion(scene, percent);
    }
}

/// A side panel of a given width. A width that follows the content would grow for good with a wide line or figure, and
/// the picture would pay.
pub(super) fn side_panel(ui: &Ui, panel: egui::Panel, width: f32) -> egui::Panel {
    let frame = egui::Frame::side_top_panel(ui.style());
    let margin =
        egui::Margin { right: frame.inner_margin.right - SCROLL_BAR, ..frame.inner_margin };
    panel.frame(frame.inner_margin(margin)).exact_size(width).resizable(false)
}

/// Room of the scroll bar beside the content of a side panel, of the panel's margin \[points\].
const SCROLL_BAR: i8 = 6;

/// The scrolled content of a side panel, at the panel's full width. A content that shrinks would make
/// the panel narrower by some points in every frame.
pub(super) fn column(name: &str) -> egui::ScrollArea {
    let beside = egui::Margin { right: SCROLL_BAR, ..egui::Margin::ZERO };
    egui::ScrollArea::vertical().id_salt(name).auto_shrink([false, true]).content_margin(beside)
}

//! Layout of the screen. Wide: plan, picture, answer side by side. Narrow: the picture over a sheet with the three
//! figures of the answer and tabs.

use super::curve_editor::CurveWindow;
use super::texts::tr;
use super::toolbar::{Layout, disclaimer};
use super::uncertainty::Findings;
use super::viewport::Shown;
use super::{App, advanced, answer, details, messages, no_answer, plan, plots, status, theme};
use crate::measure::Status;
use crate::scene::Scene;
use eframe::egui::{self, Rect, RichText, Ui};
use plan::Hand;

/// A tab of the bottom sheet on narrow screens.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum NarrowTab {
    Implant,
    Patient,
    Pocket,
    More,
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
    pub(super) fn wide(&mut self, ui: &mut Ui, scene: &mut Scene) {
        let [plan, answer] = self.panel_widths.fitting(ui.available_width());
        egui::Panel::top("toolbar").resizable(false).show(ui, |ui| self.toolbar(ui, Layout::Wide));
        egui::Panel::bottom("status").resizable(false).show(ui, |ui| {
            ui.add_space(theme::SPACE_SMALL);
            self.status_row(ui, Layout::Wide);
            ui.add_space(theme::SPACE_SMALL);
        });
        let left = side_panel(egui::Panel::left("plan"), plan).show(ui, |ui| {
            column("plan").show(ui, |ui| {
                ui.add_space(theme::SPACE_SMALL);
                ui.heading(tr("Plan"));
                self.plan(ui, scene);
                self.focus.scroll_into_view(ui);
            });
        });
        self.count_gesture(ui.ctx());
        if !self.is_inserting {
            self.take_edits(ui.ctx(), scene);
        }
        let right = side_panel(egui::Panel::right("answer"), answer).show(ui, |ui| {
            column("answer").show(ui, |ui| {
                self.answer(ui, Layout::Wide);
                self.focus.scroll_into_view(ui);
            });
        });
        let below = egui::Panel::bottom("insertion").resizable(false);
        below.show(ui, |ui| {
            self.insertion_row(ui, scene);
            self.headline(ui);
        });
        self.take_edits(ui.ctx(), scene);
        egui::CentralPanel::no_frame().show(ui, |ui| self.central(ui, scene, Layout::Wide));
        self.panel_widths.drag(ui, left.response.rect, right.response.rect);
    }

    /// Arranges picture and sheet of a narrow or low screen: the sheet is below the picture of an upright phone, beside the
    /// picture of a turned one.
    pub(super) fn narrow(&mut self, ui: &mut Ui, scene: &mut Scene) {
        let toolbar = egui::Panel::top("toolbar").resizable(false);
        toolbar.show(ui, |ui| self.toolbar(ui, Layout::Narrow));
        // The picture keeps half of the screen.
        let screen = ui.ctx().content_rect();
        let sheet = if screen.width() > screen.height() {
            egui::Panel::right("sheet beside").exact_size(0.5 * screen.width())
        } else {
            egui::Panel::bottom("sheet").exact_size(0.46 * screen.height())
        };
        sheet.resizable(false).show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = theme::SPACE_SMALL;
            let findings = self.uncertainty.findings();
            answer::show_short(ui, &self.session, self.previous_results(), findings);
            self.tabs(ui);
            egui::Panel::bottom("sheet status")
                .resizable(false)
                .show_separator_line(false)
                .show(ui, |ui| self.status_row(ui, Layout::Narrow));
            egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
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
        plan::implant(ui, scene, &mut self.plan, &self.volume_marks, Hand::Mouse);
        self.shelf_line(ui, scene);
        self.typing.0 = plan::patient(ui, scene, Hand::Mouse);
        plan::pocket(ui, scene, Hand::Mouse);
        self.position_notice = plan::position(ui, scene, Hand::Mouse);
        ui.add_space(theme::SPACE);
        self.advanced(ui, scene, Hand::Mouse);
    }

    /// The folded part of the plan, which opens the window of a curve.
    fn advanced(&mut self, ui: &mut Ui, scene: &mut Scene, hand: Hand) {
        if let Some(layer) = advanced::show(ui, scene, &self.session, hand) {
            self.curve_window = CurveWindow::new(scene, layer);
        }
    }

    /// The tabs of the sheet, at the size of a finger.
    fn tabs(&mut self, ui: &mut Ui) {
        ui.columns_const(|columns: &mut [Ui; 4]| {
            for (ui, (tab, name)) in columns.iter_mut().zip(TABS) {
                let name = self.plan.device.words(tr(name));
                let size = egui::vec2(ui.available_width(), theme::TOUCH);
                let button = egui::Button::selectable(self.narrow_tab == tab, name)
                    .frame_when_inactive(true);
                if ui.add_sized(size, button).clicked() {
                    self.narrow_tab = tab;
                }
            }
        });
    }

    fn narrow_tab(&mut self, ui: &mut Ui, scene: &mut Scene) {
        match self.narrow_tab {
            NarrowTab::Implant => {
                plan::implant(ui, scene, &mut self.plan, &self.volume_marks, Hand::Finger);
                self.shelf_line(ui, scene);
                self.insertion_row(ui, scene);
            }
            NarrowTab::Patient => self.typing.0 = plan::patient(ui, scene, Hand::Finger),
            NarrowTab::Pocket => {
                plan::pocket(ui, scene, Hand::Finger);
                self.position_notice = plan::position(ui, scene, Hand::Finger);
            }
            NarrowTab::More => {
                self.answer(ui, Layout::Narrow);
                self.advanced(ui, scene, Hand::Finger);
            }
        }
    }

    /// The cards or the missing answer in words, the filling of an expander, what is not known, the comparison and the details.
    fn answer(&mut self, ui: &mut Ui, layout: Layout) {
        answer::heading(ui, &self.session);
        if !self.no_answer(ui) {
            let findings = self.uncertainty.findings();
            let near_end = self.volume_marks.near_end(self.session.scene());
            answer::show(ui, &self.session, self.previous_results(), findings, &near_end);
        }
        answer::sources(ui, &self.session);
        self.filling(ui);
        self.uncertainty.show(ui, &self.session);
        self.compare(ui);
        self.details(ui, layout);
    }

    /// The fold with numbers, cross-section and curves.
    fn details(&self, ui: &mut Ui, layout: Layout) {
        let (previous, findings) = (self.previous_results(), self.uncertainty.findings());
        egui::CollapsingHeader::new(tr("Details")).id_salt("details").show_unindented(ui, |ui| {
            let outcome = answer::visible(&self.session, previous);
            match outcome.filter(|outcome| outcome.status != Status::Unstable) {
                Some(outcome) => details::show(ui, outcome, findings),
                None => {
                    ui.label(
                        RichText::new(tr("No numbers yet.")).color(ui.visuals().weak_text_color()),
                    );
                }
            }
            let band = findings.map_or(&[][..], Findings::section);
            // In sight under the picture where there is room.
            if !self.has_strip(ui.ctx(), layout == Layout::Wide) {
                plots::section(ui, &self.session, &self.compare, band);
            }
            plots::curves(ui, &self.session, previous);
        });
    }

    /// State of the computation and model; on a narrow screen the words that are always in sight.
    fn status_row(&mut self, ui: &mut Ui, layout: Layout) {
        ui.horizontal(|ui| {
            // As high with the button of a long solve as without.
            ui.set_min_height(ui.spacing().interact_size.y);
            if self.is_long() {
                // On a narrow screen the words that are always in sight stay.
                self.progress(ui, |ui, words| match layout {
                    Layout::Wide => drop(ui.label(words)),
                    Layout::Narrow => disclaimer(ui, layout),
                });
                return;
            }
            status::show(ui, &self.session, &self.timing, self.uncertainty.running());
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| match layout {
                Layout::Narrow => disclaimer(ui, layout),
                Layout::Wide => {
                    let text = status::model(self.session.scene());
                    ui.label(RichText::new(text).color(ui.visuals().weak_text_color()));
                }
            });
        });
    }

    /// The answer in one sentence.
    fn headline(&self, ui: &mut Ui) {
        let mut text =
            answer::headline(&self.session, self.previous_results(), self.uncertainty.findings());
        if self.is_long() {
            // A plan without an answer takes the longest.
            text = format!("{text} {}", self.volume_marks.near_end(self.session.scene()));
        }
        // The picture keeps its place whether the sentence takes one line or two.
        let lines = if ui.available_width() < ONE_LINE { 2.0 } else { 1.0 };
        let height = lines * ui.text_style_height(&egui::TextStyle::Body);
        let height = height.max(ui.spacing().interact_size.y);
        ui.allocate_ui(egui::vec2(ui.available_width(), height), |ui| {
            ui.set_min_height(height);
            ui.add(egui::Label::new(RichText::new(text).strong()).wrap());
        });
        ui.add_space(theme::SPACE_SMALL);
    }

    /// The slider of the insertion with its play button.
    fn insertion_row(&mut self, ui: &mut Ui, scene: &mut Scene) {
        ui.add_space(theme::SPACE_SMALL);
        ui.horizontal(|ui| {
            let name = if self.is_playing { tr("Pause") } else { tr("Show insertion") };
            let button = ui.add_sized([108.0, 24.0], egui::Button::new(name));
            if button.on_hover_text(tr!("{name} (space)", name)).clicked() {
                self.toggle_playback();
            }
            let (slider, mut percent) = plan::insertion(scene);
            self.is_inserting = slider.row(ui, &mut percent, (0.0, |_: &mut Ui| {})).is_changed;
            if self.is_inserting {
                plan::set_insertion(scene, percent);
                self.is_playing = false;
            }
        });
        ui.add_space(theme::SPACE_SMALL);
    }

    /// The middle of the screen: the picture of this plan or the range of implants.
    fn central(&mut self, ui: &mut Ui, scene: &mut Scene, layout: Layout) {
        if layout == Layout::Wide {
            self.middle_switch(ui);
        }
        if self.range.is_open {
            self.range_page(ui, scene, layout);
        } else {
            self.picture(ui, scene, layout);
        }
    }

    /// The page of a plan without a shape, or a box over the picture of the last plan with an answer. On a narrow screen
    /// the answer with the nearest plan is behind a tab.
    fn no_shape(&mut self, ui: &mut Ui, area: Rect, scene: &mut Scene, layout: Layout) {
        let words = self.plan.device.words(&no_answer::words(&self.session));
        let about_picture = no_answer::about_picture(&self.session);
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
                let largest = self.volume_marks.largest_plan(self.session.scene());
                accepted = self.nearest.offer(ui, &self.session, largest, Hand::Finger);
            }
            messages::standard_model(ui, scene);
        };
        match about_picture {
            Some(_) => messages::no_shape_box(ui, area, add),
            None => messages::no_shape_page(ui, add),
        }
        if let Some(scene) = accepted {
            self.take_nearest(scene);
        }
    }

    /// The 3-D view with its controls and notices, or the page that replaces the view.
    fn picture(&mut self, ui: &mut Ui, scene: &mut Scene, layout: Layout) {
        let whole = ui.available_rect_before_wrap();
        let has_page = self.session.is_stopped() || !no_answer::has_picture(&self.session);
        let strip = self.strip_area(ui.ctx(), whole, layout == Layout::Wide).filter(|_| !has_page);
        let area = strip.map_or(whole, |strip| whole.with_max_y(strip.top()));
        let builder = egui::UiBuilder::new().id_salt("picture").max_rect(area);
        let ui = &mut ui.new_child(builder);
        if self.session.is_stopped() {
            self.stopped_page(ui);
        } else if !no_answer::has_picture(&self.session) {
            self.no_shape(ui, area, scene, layout);
        } else {
            let envelope = self.uncertainty.envelope().unwrap_or_default();
            let (session, options) = (&self.session, &self.options);
            let bar = self.view_bar_height;
            let shown =
                Shown { session, options, envelope, outlines: &[], bar, is_on_paper: false };
            if session.has_no_shape() {
                self.viewport.show(ui, shown);
                self.no_shape(ui, area, scene, layout);
            } else if self.compare.is_side_by_side(session) {
                self.viewport.show_side_by_side(ui, shown);
            } else {
                let palette = theme::palette(ui.visuals());
                let outlines = plots::outlines(session, &self.compare, palette);
                self.viewport.show(ui, Shown { outlines: &outlines, ..shown });
            }
            if !self.session.has_no_shape() {
                self.handles(ui, scene);
            }
            self.view_bar_height = self.view_bar(ui, area, layout);
            if !self.is_edited && layout == Layout::Wide && !self.session.has_no_shape() {
                hint(ui, area);
            }
        }
        if let Some(strip) = strip {
            self.strip(ui, strip);
        }
        self.show_notice(ui, area);
    }
}

/// Greatest width of the scale bar on the lower edge of the picture \[points\].
const SCALE_BAR: f32 = 140.0;

/// What to do first, on the lower edge of the picture.
fn hint(ui: &mut Ui, area: Rect) {
    let layout = egui::Layout::bottom_up(egui::Align::Max);
    let inner = area.shrink(2.0 * theme::SPACE);
    // To the right of the scale bar.
    let inner = inner.with_min_x(inner.left() + SCALE_BAR);
    let builder = egui::UiBuilder::new().id_salt("hint").max_rect(inner).layout(layout);
    let words = tr("Change width, volume or pinch · drag the picture to turn it");
    let words = RichText::new(words).color(ui.visuals().weak_text_color());
    ui.new_child(builder)
        .add(egui::Label::new(words).selectable(false).wrap().halign(egui::Align::Max));
}

/// A side panel of a given width. A width that follows the content would grow for good with a wide line or figure, and
/// the picture would pay.
fn side_panel(panel: egui::Panel, width: f32) -> egui::Panel {
    panel.exact_size(width).resizable(false)
}

/// Widths of the side panels that the user has chosen, plan and answer \[points\].
#[derive(Default)]
pub(super) struct PanelWidths([Option<f32>; 2]);

impl PanelWidths {
    /// The widths in a window: the picture keeps a third.
    fn fitting(&self, window: f32) -> [f32; 2] {
        let (least, most) = theme::PANEL_WIDTH;
        let usual = (0.24 * window).clamp(least, most);
        self.0.map(|width| width.unwrap_or(usual).min(window / 3.0).max(least))
    }

    /// Moves the inner edges of the panels with the pointer; a double-click restores the usual width.
    fn drag(&mut self, ui: &Ui, plan: Rect, answer: Rect) {
        for (k, (panel, edge)) in
            [(plan, plan.right()), (answer, answer.left())].into_iter().enumerate()
        {
            let area = Rect::from_x_y_ranges(edge - 3.0..=edge + 3.0, panel.y_range());
            let id = ui.scope_id().with(("panel edge", k));
            let response = ui.interact(area, id, egui::Sense::CLICK | egui::Sense::DRAG);
            if response.hovered() || response.dragged() {
                ui.set_cursor_icon(egui::CursorIcon::ResizeHorizontal);
                let stroke = egui::Stroke::new(2.0, theme::palette(ui.visuals()).accent);
                ui.painter().vline(edge, panel.y_range(), stroke);
            }
            if response.double_clicked() {
                self.0[k] = None;
            } else if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged())
            {
                let width = if k == 0 { at.x - panel.left() } else { panel.right() - at.x };
                self.0[k] = Some(width);
            }
        }
    }
}

/// The scrolled content of a side panel, at the panel's full width. A content that shrinks would make
/// the panel narrower by some points in every frame.
fn column(name: &str) -> egui::ScrollArea {
    egui::ScrollArea::vertical().id_salt(name).auto_shrink([false, true])
}

//! The page of the range of implants: switch, files, chart, captions, taking an implant.

use super::chart::Taken;
use super::shelf::take_size;
use super::{Range, readout};
use crate::app::frame::action::{Action, Task};
use crate::app::frame::commands::entry_of;
use crate::app::frame::files::name_with_size;
use crate::app::frame::messages::Notice;
use crate::app::frame::research;
use crate::app::frame::shared::Shared;
use crate::app::frame::toolbar::Layout;
use crate::app::plan::{Hand, chip};
use crate::app::texts::{fixed, tr};
use crate::app::widgets::theme;
use crate::app::widgets::{menu, rejection_label, remark};
use crate::scene::Scene;
use crate::study::{CHECK, JudgedMap, Map, Parameter, PointStatus, Quantity, with_values};
use eframe::egui::{self, Button, RichText, Ui};
use implant_preview_charts::scene_map;

impl Range {
    /// The lines below the chart: progress, accuracy, pocket, points without an answer, failures.
    fn captions(&self, ui: &mut Ui) {
        let palette = theme::palette(ui.visuals());
        if let Some(error) = &self.error {
            ui.add(egui::Label::new(RichText::new(error).color(palette.bad)).wrap());
            return;
        }
        let Some(map) = self.map.study() else { return };
        let grids = tr!(
            "The plans are computed with {nodes} nodes per side, some of them again with {fine}.",
            nodes = map.settings().nodes_per_side,
            fine = CHECK.nodes_per_side
        );
        let accuracy = research::is_on(ui.ctx()).then(|| self.accuracy_in_words(map));
        let caption = remark(ui, self.caption_in_words(map, accuracy.as_deref()));
        if accuracy.is_some() {
            caption.on_hover_text(grids);
        }
        if let Some(failure) = self.map.failure().or_else(|| self.check.failure()) {
            let line = RichText::new(failure).small().color(palette.bad);
            ui.add(egui::Label::new(line).wrap());
        }
    }

    /// Accuracy of the points once they are computed, in a sentence; empty before.
    pub(super) fn accuracy_in_words(&self, map: &Map) -> String {
        if map.is_complete() { self.accuracy(map) } else { String::new() }
    }

    /// Progress; number and `accuracy` of the plans, which may be empty, if that is given; pocket, points without an answer, pins beyond the chart, in sentences.
    pub(super) fn caption_in_words(&self, map: &Map, accuracy: Option<&str>) -> String {
        let in_full = map.solved_in_full();
        let (done, all) = (self.map.progress().0 - in_full, map.cases().len());
        let mut words = Vec::new();
        if self.quantity == Quantity::GreatestStrain && self.practice.is_pending() {
            words.push(tr("Comparing with practice…").to_owned());
        }
        let is_complete = map.is_complete();
        if !is_complete {
            words.push(tr!("{done} of {all} plans computed.", done, all));
        } else {
            words.extend(accuracy.map(|_| match done < all {
                true => {
                    tr!("{done} of {all} plans computed. The others are interpolated.", done, all)
                }
                false => tr!("{all} plans computed.", all),
            }));
            words.extend(accuracy.filter(|words| !words.is_empty()).map(str::to_owned));
        }
        if self.map.is_running() && is_complete {
            words.push(tr!("The border of no answer is solved in full: {in_full} plans.", in_full));
        }
        let [not_computed, none] = missing(map);
        if none > 0 {
            words.push(tr!("Crossed: {none} without an answer.", none));
        }
        if not_computed > 0 {
            words.push(tr!(
                "Striped: {not_computed} not computed here; a click computes one.",
                not_computed
            ));
        }
        if self.quantity == Quantity::GreatestStrain && self.practice.has_gaps() {
            words.push(tr("No colour: practice's table does not have this width.").to_owned());
        }
        if map.pocket_follows() {
            words.push(tr("The pocket keeps its margin.").to_owned());
        }
        if map.present().is_none() {
            words.push(tr("This plan is not on this chart.").to_owned());
        }
        words.extend(Some(self.sizes.legend().to_owned()).filter(|words| !words.is_empty()));
        words.extend(Some(self.pins.beyond()).filter(|beyond| !beyond.is_empty()));
        words.join(" ")
    }

    /// All values of the last point of pointer or keys, folded.
    fn values(&self, ui: &mut Ui) {
        // The header is always there, so that nothing moves.
        egui::CollapsingHeader::new(tr("All values")).id_salt("range values").show(ui, |ui| {
            let Some((map, (i, j))) = self.judged().zip(self.chart.shown()) else {
                remark(ui, tr("Those of the plan at the pointer, or chosen by the arrow keys."));
                return;
            };
            remark(ui, format!("{}:", readout::place(&map, i, j)));
            remark(ui, readout::lines(map, i, j, self.quantity).join(" · "));
        });
    }

    /// Grid of the points, and the greatest difference from a finer grid once it is known.
    fn accuracy(&self, map: &Map) -> String {
        let within = self.check.finished().and_then(|check| {
            let differences = map.differences(check);
            differences.into_iter().find(|found| found.quantity == self.quantity)
        });
        match within {
            Some(found) => tr!(
                "A quick, coarse computation, within {difference} of a fine one.",
                difference = within_text(self.quantity, found.difference)
            ),
            None if self.check.is_running() => {
                tr("A quick, coarse computation; a fine one is being compared.").to_owned()
            }
            None => tr("A quick, coarse computation.").to_owned(),
        }
    }
}

/// Numbers of the points that are not computed, and of those that have no answer at all.
fn missing(map: &Map) -> [usize; 2] {
    let (columns, rows) = map.shape();
    let mut counts = [0; 2];
    for (i, j) in (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))) {
        match map.status(i, j) {
            PointStatus::Converged | PointStatus::Waiting => {}
            PointStatus::Invalid => counts[1] += 1,
            _ => counts[usize::from(readout::is_final(map, i, j))] += 1,
        }
    }
    counts
}

/// A difference with one significant digit, rounded up, in the displayed unit.
pub(crate) fn within_text(quantity: Quantity, difference: f64) -> String {
    let (factor, unit) = quantity.display();
    let shown = (factor * difference).max(1e-3);
    let power = 10f64.powf(shown.log10().floor());
    let rounded = (shown / power - 1e-9).ceil() * power;
    let decimals = (-power.log10().round()).max(0.0) as usize;
    let points = if unit == "%" { tr("% (points)") } else { unit };
    format!("{} {points}", fixed(rounded, decimals))
}

impl Range {
    /// The switch between picture and range, above the middle of a wide screen.
    pub(crate) fn switch(&mut self, ui: &mut Ui, shared: &Shared, actions: &mut Vec<Action>) {
        let device = shared.choices.device;
        let frame = egui::Frame::new()
            .inner_margin(egui::Margin::symmetric(theme::SPACE as i8, theme::SPACE_SMALL as i8))
            .fill(ui.visuals().panel_fill);
        egui::Panel::top("middle").frame(frame).resizable(false).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = theme::SPACE_SMALL;
                let is_open = self.is_open;
                for range in [false, true] {
                    let entry = entry_of(Task::ShowRange(range));
                    let name = device.words(tr(entry.name));
                    if chip(ui, Hand::Mouse, is_open == range, &name, tr(entry.tooltip)) {
                        self.is_open = range;
                    }
                }
                if is_open {
                    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                        self.files(ui, shared, actions);
                    });
                }
            });
        });
    }

    /// The files of the chart.
    fn files(&self, ui: &mut Ui, shared: &Shared, actions: &mut Vec<Action>) {
        let Some(map) = self.map.study() else { return };
        let is_done = !self.map.is_running();
        let (quantity, check) = (self.quantity, self.check.finished());
        let file = |extension: &str, text: String| {
            let (scene, device) = (shared.session.scene(), shared.choices.device);
            Action::Save(name_with_size(scene, device, "range", extension), text.into())
        };
        let button = menu(ui, tr("Save chart"), |ui| {
            let mut item = |name: &str| {
                let item = ui.add_enabled(is_done, Button::new(name));
                let is_clicked = item.clicked();
                item.on_disabled_hover_text(tr("The chart is being computed"));
                if is_clicked {
                    ui.close();
                }
                is_clicked
            };
            if item(tr("Table (CSV)…")) {
                actions.push(file("csv", map.csv()));
            }
            if item(tr("Numbers (JSON)…"))
                && let Ok(text) = serde_json::to_string_pretty(&map.file(quantity, check))
            {
                actions.push(file("json", text + "\n"));
            }
            if item(tr("Picture (SVG)…")) {
                actions.push(match scene_map::draw(map, quantity) {
                    Ok(text) => file("svg", text),
                    Err(error) => Action::Notify(Notice::error(tr!(
                        "The chart was not drawn: {error}",
                        error
                    ))),
                });
            }
        });
        button.on_hover_text(tr("Save all values of the chart, or its picture"));
    }

    /// The chart with its controls, in place of the picture.
    pub(crate) fn page(
        &mut self,
        ui: &mut Ui,
        scene: &mut Scene,
        layout: Layout,
        shared: &Shared,
        actions: &mut Vec<Action>,
    ) {
        let Self { map, pins, sizes, starts, .. } = self;
        if let Some(map) = map.study() {
            pins.update(map, *starts, &shared.session);
            sizes.update(map, *starts);
        }
        let margin = egui::Margin::symmetric(theme::SPACE as i8, theme::SPACE_SMALL as i8);
        let frame = egui::Frame::new().inner_margin(margin).fill(ui.visuals().panel_fill);
        let top = egui::Panel::top("range controls").frame(frame).resizable(false);
        top.show_separator_line(false).show(ui, |ui| {
            for reason in self.controls(ui, scene, layout) {
                rejection_label(ui, &reason);
            }
            if layout == Layout::Narrow && self.shows_more {
                self.files(ui, shared, actions);
            }
        });
        let bottom = egui::Panel::bottom("range captions").frame(frame).resizable(false);
        let mut taken = None;
        bottom.show_separator_line(false).show(ui, |ui| {
            if layout == Layout::Narrow && self.chart.cursor().is_some() {
                let button = Button::new(shared.choices.device.words(tr("Take this implant")));
                let size = egui::vec2(ui.available_width(), theme::TOUCH - 8.0);
                if ui.add_sized(size, button).clicked() {
                    taken = self.chart.cursor().map(Taken::Point);
                }
            }
            self.captions(ui);
            // A phone has room for the chart alone, unless more is wanted.
            if layout == Layout::Wide || self.shows_more {
                self.values(ui);
                taken = self.shelf_list(ui, layout, actions).map(Taken::Size).or(taken.take());
            }
        });
        egui::CentralPanel::default().frame(frame).show(ui, |ui| {
            let Self { map, practice, chart, quantity, revision, pins, sizes, .. } = self;
            if let Some(map) = map.study() {
                let map = (JudgedMap { map, practice: practice.found() }, practice.is_pending());
                taken = chart.show(ui, map, *quantity, *revision, (pins, sizes)).or(taken);
            }
        });
        match taken {
            Some(Taken::Point((i, j))) => self.take(i, j, scene, actions),
            Some(Taken::Size(index)) => {
                if let Some(size) = self.sizes.shelf.sizes().get(index) {
                    take_size(size, scene, actions);
                }
            }
            None => {}
        }
    }

    /// Takes the implant of a point: one step of the history, as an edit of the plan.
    fn take(&self, i: usize, j: usize, scene: &mut Scene, actions: &mut Vec<Action>) {
        let Some(map) = self.judged() else { return };
        let values: Vec<(Parameter, f64)> =
            map.axes().iter().zip([i, j]).map(|(a, k)| (a.field, a.value(k))).collect();
        let taken = match map.status(i, j) {
            PointStatus::Invalid => Err(readout::lines(map, i, j, self.quantity).swap_remove(0)),
            _ => with_values(scene, &values).map_err(|error| error.to_string()),
        };
        match taken {
            Ok(taken) => *scene = taken,
            Err(reason) => {
                let place = readout::place(&map, i, j);
                let words = tr!("{place} was not taken. {reason}", place, reason);
                actions.push(Action::Notify(Notice::caution(words)));
            }
        }
    }
}

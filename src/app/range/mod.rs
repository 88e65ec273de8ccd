//! The range of implants at a glance: a chart over one or two numbers of the plan, each point one solved scene.
//!
//! `axes` (the numbers on offer, their words and units) | `plane` (values to points of the screen) | `colours` (scale and
//! picture) | `readout` (values of a point in words) | `chart` (drawing, pointer and keys). This file contains the choices, the
//! studies behind the chart, and the controls around it.

mod axes;
mod chart;
mod colours;
mod plane;
mod readout;

pub(super) use plane::marks;
pub(super) use readout::name as quantity_name;

use super::commands::{PICTURE, RANGE};
use super::messages::Notice;
use super::plan::{Hand, chip};
use super::studies::{Driver, Studies};
use super::toolbar::Layout;
use super::widgets::{NumberField, choice, rejection_label, remark, set_accessible_name};
use super::{App, theme};
use crate::experiment::charts::scene_map;
use crate::scene::Scene;
use crate::study::{
    Axis, CHECK, Map, MapCheck, MapSettings, Parameter, PointStatus, Quantity, with_values,
};
use axes::Words;
use chart::Chart;
use eframe::egui::{self, Button, RichText, Ui};
use web_time::{Duration, Instant};

/// Numbers of values of an axis: coarse, medium, fine; and of a curve.
const FINENESS: [(&str, usize); 3] = [("Coarse", 20), ("Medium", 40), ("Fine", 60)];
const CURVE_POINTS: usize = 41;
/// Rest after which a complete map is compared with a finer grid: an edit would wait for a fine scene that runs.
const REST: Duration = Duration::from_secs(1);

/// An axis as chosen.
#[derive(Clone, Copy, Debug, PartialEq)]
struct AxisChoice {
    field: Parameter,
    /// Typed ends; `None`: the usual ones.
    ends: Option<(f64, f64)>,
}

impl AxisChoice {
    fn of(field: Parameter) -> Self {
        Self { field, ends: None }
    }

    fn ends(&self, scene: &Scene) -> (f64, f64) {
        self.ends.unwrap_or_else(|| axes::usual(self.field, scene))
    }
}

/// The range of implants.
pub(super) struct Range {
    /// Does the chart take the place of the picture?
    pub(super) is_open: bool,
    across: AxisChoice,
    up: Option<AxisChoice>,
    quantity: Quantity,
    fineness: usize,
    /// On a narrow screen: are the axes shown?
    shows_axes: bool,
    map: Driver<Map>,
    check: Driver<MapCheck>,
    /// Scene and axes of the present map.
    started: Option<(Scene, Vec<Axis>)>,
    /// Why the axes give no map.
    error: Option<String>,
    /// Time of the last value of a complete map.
    done: Option<Instant>,
    /// Number of changes of the map's values.
    revision: u64,
    chart: Chart,
}

impl Default for Range {
    fn default() -> Self {
        Self {
            is_open: false,
            across: AxisChoice::of(Parameter::BaseWidth),
            up: Some(AxisChoice::of(Parameter::Projection)),
            quantity: Quantity::GreatestStrain,
            fineness: FINENESS[0].1,
            shows_axes: false,
            map: Driver::default(),
            check: Driver::default(),
            started: None,
            error: None,
            done: None,
            revision: 0,
            chart: Chart::default(),
        }
    }
}

impl Range {
    /// Follows the scene and the choices, once a frame: starts a map for another scene, passes on finished jobs, compares a
    /// complete map with a finer grid.
    pub(super) fn advance(&mut self, ctx: &egui::Context, scene: &Scene, studies: &mut Studies) {
        if !self.is_open {
            // A closed chart costs nothing; solved cases stay stored.
            if self.map.is_running() || self.check.is_running() {
                self.map.cancel(studies);
                self.check.cancel(studies);
                self.started = None;
            }
            return;
        }
        let axes = self.axes(scene);
        if self.started.as_ref().is_none_or(|(s, a)| s != scene || *a != axes) {
            self.restart(scene, axes, studies);
        }
        if self.map.advance(studies) {
            self.revision += 1;
            self.done = None;
        }
        self.check.advance(studies);
        let Some(map) = self.map.study().filter(|_| !self.map.is_running()) else { return };
        if self.check.study().is_some() {
            return;
        }
        let rest = self.done.get_or_insert_with(Instant::now).elapsed();
        if rest < REST {
            ctx.request_repaint_after(REST - rest);
        } else if let Some(check) = map.check() {
            self.check.start(check, studies);
            self.check.advance(studies);
        }
    }

    /// Moves the present map to the scene if its points stay the same, or starts a map.
    fn restart(&mut self, scene: &Scene, axes: Vec<Axis>, studies: &mut Studies) {
        let has_axes = self.started.as_ref().is_some_and(|(_, started)| *started == axes);
        let is_moved = has_axes && self.map.study_mut().is_some_and(|map| map.move_to(scene));
        self.started = Some((scene.clone(), axes.clone()));
        self.revision += 1;
        if is_moved {
            return;
        }
        if !has_axes {
            self.chart.forget_cursor();
        }
        self.check.cancel(studies);
        self.done = None;
        self.error = empty_axis(&axes);
        if self.error.is_none() {
            match Map::new(scene, &axes, MapSettings::default()) {
                Ok(map) => return self.map.start(map, studies),
                Err(error) => self.error = Some(error.to_string()),
            }
        }
        self.map.cancel(studies);
    }

    fn axes(&self, scene: &Scene) -> Vec<Axis> {
        let target = if self.up.is_some() { self.fineness } else { CURVE_POINTS };
        let axis = |choice: &AxisChoice| axes::axis(choice.field, choice.ends(scene), target);
        [Some(self.across), self.up].iter().flatten().map(axis).collect()
    }

    /// Chooses the number of an axis. The other axis changes if both set the same field.
    fn set_field(&mut self, is_across: bool, field: Option<Parameter>, scene: &Scene) {
        let before = self.across;
        match (is_across, field) {
            (true, Some(field)) => {
                self.across = AxisChoice::of(field);
                if self.up.is_some_and(|up| up.field.excludes(field, scene)) {
                    // The axes change places, or the first number that goes with this one stands up.
                    let free = |other: &Parameter| !other.excludes(field, scene);
                    let first = [before.field].into_iter().chain(axes::FIELDS).find(free);
                    self.up = first.map(AxisChoice::of);
                }
            }
            (_, field) => self.up = field.map(AxisChoice::of),
        }
    }

    /// Forgets what belongs to a lost graphics context.
    pub(super) fn forget_texture(&mut self) {
        self.chart.forget_texture();
    }

    /// Numbers of computed and of all plans.
    pub(super) fn progress(&self) -> (usize, usize) {
        self.map.progress()
    }

    /// The chosen point in words, for screen readers; `None` without one.
    pub(super) fn summary(&self) -> Option<String> {
        let map = self.map.study().filter(|_| self.is_open)?;
        let (i, j) = self.chart.cursor()?;
        Some(readout::sentence(map, i, j, self.quantity))
    }

    /// The controls of the chart.
    fn controls(&mut self, ui: &mut Ui, scene: &Scene, layout: Layout) -> Vec<String> {
        let mut rejections = Vec::new();
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing.x = theme::SPACE_SMALL + 2.0;
            if layout == Layout::Narrow && chip(ui, Hand::Mouse, false, PICTURE, "") {
                self.is_open = false;
            }
            self.quantity_box(ui, scene, layout);
            if layout == Layout::Narrow {
                let axes = Button::selectable(self.shows_axes, "Axes").frame_when_inactive(true);
                if ui.add(axes).clicked() {
                    self.shows_axes = !self.shows_axes;
                }
                if !self.shows_axes {
                    return;
                }
            }
            if self.up.is_some() {
                self.fineness_box(ui);
            }
            ui.end_row();
            self.field_box(ui, scene, true);
            self.ends(ui, scene, true, &mut rejections);
            if layout == Layout::Narrow {
                ui.end_row();
            }
            self.field_box(ui, scene, false);
            if self.up.is_some() {
                self.ends(ui, scene, false, &mut rejections);
            }
        });
        rejections
    }

    fn quantity_box(&mut self, ui: &mut Ui, scene: &Scene, layout: Layout) {
        if !readout::applies(self.quantity, scene.is_layered()) {
            self.quantity = Quantity::GreatestStrain;
        }
        if layout == Layout::Wide {
            quiet(ui, if self.up.is_some() { "Colour" } else { "Curve" });
        }
        let response = egui::ComboBox::from_id_salt("range quantity")
            .width(if layout == Layout::Wide { 170.0 } else { 150.0 })
            .truncate()
            .selected_text(readout::name(self.quantity))
            .show_ui(ui, |ui| {
                for (quantity, name) in readout::QUANTITIES {
                    if readout::applies(quantity, scene.is_layered())
                        && choice(ui, self.quantity == quantity, name).clicked()
                    {
                        self.quantity = quantity;
                    }
                }
            })
            .response;
        set_accessible_name(&response, egui::Role::ComboBox, "Colour");
        response.on_hover_text("The result shown by the colours, or by the curve");
    }

    fn field_box(&mut self, ui: &mut Ui, scene: &Scene, is_across: bool) {
        let name = if is_across { "Across" } else { "Up" };
        let present = if is_across { Some(self.across.field) } else { self.up.map(|up| up.field) };
        let selected = present.map_or(NOTHING, |field| Words::of(field).name);
        quiet(ui, name);
        let mut chosen = None;
        let response = egui::ComboBox::from_id_salt(name)
            .width(112.0)
            .truncate()
            .selected_text(selected)
            .show_ui(ui, |ui| {
                if !is_across && choice(ui, present.is_none(), NOTHING).clicked() {
                    chosen = Some(None);
                }
                let is_free =
                    |field: &Parameter| is_across || !field.excludes(self.across.field, scene);
                for field in axes::FIELDS.into_iter().filter(is_free) {
                    if axes::applies(field, scene)
                        && choice(ui, present == Some(field), Words::of(field).name).clicked()
                    {
                        chosen = Some(Some(field));
                    }
                }
            })
            .response;
        set_accessible_name(&response, egui::Role::ComboBox, name);
        response.on_hover_text(if is_across {
            "The number of the plan that varies from left to right"
        } else {
            "The number of the plan that varies upwards; without one the chart is a curve"
        });
        if let Some(field) = chosen.filter(|field| *field != present) {
            self.set_field(is_across, field, scene);
        }
    }

    /// First and last value of an axis; reasons of rejected numbers go to `rejections`.
    fn ends(&mut self, ui: &mut Ui, scene: &Scene, is_across: bool, rejections: &mut Vec<String>) {
        let axis = if is_across { Some(&mut self.across) } else { self.up.as_mut() };
        let Some(axis) = axis else { return };
        let words = Words::of(axis.field);
        let (least, most) = axes::allowed(axis.field);
        let before = axis.ends(scene);
        let mut ends = [before.0, before.1].map(|value| words.display(value));
        let name = if is_across { "Across" } else { "Up" };
        let mut is_changed = false;
        for (end, side) in ends.iter_mut().zip(["from", "to"]) {
            let field = NumberField {
                name: &format!("{name}, {side}"),
                kind: words.kind,
                allowed: words.display(least)..=words.display(most),
                decimals: 0,
                step: if words.unit == "cm" { 0.5 } else { 0.1 * most.min(100.0) },
                width: 40.0,
                ..NumberField::default()
            };
            let typed = field.show(ui, end);
            is_changed |= typed.is_changed;
            rejections.extend(typed.rejection.map(|reason| format!("{name}, {side}: {reason}")));
            if side == "from" {
                quiet(ui, "–");
            }
        }
        quiet(ui, words.unit);
        if is_changed {
            let [from, to] = ends.map(|end| words.value(end));
            axis.ends = Some((from.min(to), from.max(to)));
        }
    }

    fn fineness_box(&mut self, ui: &mut Ui) {
        let present = FINENESS.iter().find(|(_, count)| *count == self.fineness);
        let response = egui::ComboBox::from_id_salt("fineness")
            .width(70.0)
            .selected_text(present.map_or("", |(name, _)| name))
            .show_ui(ui, |ui| {
                for (name, count) in FINENESS {
                    if choice(ui, self.fineness == count, name).clicked() {
                        self.fineness = count;
                    }
                }
            })
            .response;
        set_accessible_name(&response, egui::Role::ComboBox, "Points");
        response.on_hover_text("Number of plans: about 20 × 20, 40 × 40 or 60 × 60");
    }

    /// The lines below the chart: progress, accuracy, pocket, points without an answer, failures.
    fn captions(&self, ui: &mut Ui) {
        let palette = theme::palette(ui.visuals());
        if let Some(error) = &self.error {
            ui.add(egui::Label::new(RichText::new(error).color(palette.bad)).wrap());
            return;
        }
        let Some(map) = self.map.study() else { return };
        let (done, all) = self.map.progress();
        let mut words = Vec::new();
        if done < all {
            words.push(format!("{done} of {all} plans computed."));
        } else {
            words.push(format!("{all} plans computed. {}", self.accuracy(map)));
        }
        let has_answer =
            |s: PointStatus| matches!(s, PointStatus::Converged | PointStatus::Waiting);
        let counts = map.counts();
        let missing: usize = counts.iter().filter(|(s, _)| !has_answer(*s)).map(|(_, n)| n).sum();
        if missing > 0 {
            words.push(format!(
                "Striped: {missing} not computed here; a point there has the reason."
            ));
        }
        if map.pocket_follows() {
            words.push("The pocket keeps its margin.".to_owned());
        }
        if map.present().is_none() {
            words.push("The present plan is not on this chart.".to_owned());
        }
        remark(ui, words.join(" "));
        if let Some(failure) = self.map.failure().or_else(|| self.check.failure()) {
            let line = RichText::new(failure).small().color(palette.bad);
            ui.add(egui::Label::new(line).wrap());
        }
    }

    /// Grid of the points, and the greatest difference from a finer grid once it is known.
    fn accuracy(&self, map: &Map) -> String {
        let nodes = map.settings().nodes_per_side;
        let within = self.check.study().filter(|_| !self.check.is_running()).and_then(|check| {
            let differences = map.differences(check);
            differences.into_iter().find(|found| found.quantity == self.quantity)
        });
        match within {
            Some(found) => format!(
                "{nodes} nodes a side, within {} of the fine grid ({} nodes).",
                within_text(self.quantity, found.difference),
                CHECK.nodes_per_side
            ),
            None if self.check.is_running() => {
                format!("{nodes} nodes a side; comparing with the fine grid.")
            }
            None => format!("{nodes} nodes a side."),
        }
    }
}

/// The choice of no second axis.
const NOTHING: &str = "Nothing: a curve";

fn quiet(ui: &mut Ui, words: &str) {
    ui.label(RichText::new(words).color(ui.visuals().weak_text_color()));
}

/// The error of an axis whose ends are equal, in the words of the chart.
fn empty_axis(axes: &[Axis]) -> Option<String> {
    let axis = axes.iter().find(|axis| (axis.to - axis.from).abs() < f64::MIN_POSITIVE)?;
    let words = Words::of(axis.field);
    Some(format!(
        "{} from {} to {}; allowed: two different numbers.",
        words.name,
        words.text(axis.from),
        words.text(axis.to)
    ))
}

/// A difference with one significant digit, rounded up, in the displayed unit.
pub(super) fn within_text(quantity: Quantity, difference: f64) -> String {
    let (factor, unit) = quantity.display();
    let shown = (factor * difference).max(1e-3);
    let power = 10f64.powf(shown.log10().floor());
    let rounded = (shown / power - 1e-9).ceil() * power;
    let decimals = (-power.log10().round()).max(0.0) as usize;
    let points = if unit == "%" { "% (points)" } else { unit };
    format!("{rounded:.decimals$} {points}")
}

impl App {
    /// The switch between picture and range, above the middle of a wide screen.
    pub(super) fn middle_switch(&mut self, ui: &mut Ui) {
        let frame = egui::Frame::new()
            .inner_margin(egui::Margin::symmetric(theme::SPACE as i8, theme::SPACE_SMALL as i8))
            .fill(ui.visuals().panel_fill);
        egui::Panel::top("middle").frame(frame).resizable(false).show(ui, |ui| {
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = theme::SPACE_SMALL;
                let is_open = self.range.is_open;
                if chip(ui, Hand::Mouse, !is_open, PICTURE, "This plan in three dimensions") {
                    self.range.is_open = false;
                }
                let tooltip = "A chart of many plans: width by projection, or any two numbers";
                if chip(ui, Hand::Mouse, is_open, &self.plan.device.words(RANGE), tooltip) {
                    self.range.is_open = true;
                }
                if is_open {
                    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                        self.range_files(ui);
                    });
                }
            });
        });
    }

    /// The files of the chart.
    fn range_files(&mut self, ui: &mut Ui) {
        let Some(map) = self.range.map.study() else { return };
        let is_done = !self.range.map.is_running();
        let (quantity, check) = (self.range.quantity, self.range.check.study());
        let check = check.filter(|_| !self.range.check.is_running());
        let mut notice = None;
        let menu = ui.menu_button("Save chart", |ui| {
            let ctx = ui.ctx().clone();
            let mut item = |name: &str| {
                let item = ui.add_enabled(is_done, Button::new(name));
                let is_clicked = item.clicked();
                item.on_disabled_hover_text("The chart is being computed");
                if is_clicked {
                    ui.close();
                }
                is_clicked
            };
            if item("Table (CSV)…") {
                self.files.save(&ctx, "range.csv", map.csv());
            }
            if item("Numbers (JSON)…")
                && let Ok(text) = serde_json::to_string_pretty(&map.file(quantity, check))
            {
                self.files.save(&ctx, "range.json", text + "\n");
            }
            if item("Picture (SVG)…") {
                match scene_map::draw(map, quantity) {
                    Ok(text) => self.files.save(&ctx, "range.svg", text),
                    Err(error) => {
                        notice = Some(Notice::error(format!("range.svg was not drawn: {error}")));
                    }
                }
            }
        });
        menu.response.on_hover_text("Save all values of the chart, or its picture");
        self.notice = notice.or(self.notice.take());
    }

    /// The chart with its controls, in place of the picture.
    pub(super) fn range_page(&mut self, ui: &mut Ui, scene: &mut Scene, layout: Layout) {
        let area = ui.available_rect_before_wrap();
        let margin = egui::Margin::symmetric(theme::SPACE as i8, theme::SPACE_SMALL as i8);
        let frame = egui::Frame::new().inner_margin(margin).fill(ui.visuals().panel_fill);
        let top = egui::Panel::top("range controls").frame(frame).resizable(false);
        top.show_separator_line(false).show(ui, |ui| {
            for reason in self.range.controls(ui, scene, layout) {
                rejection_label(ui, &reason);
            }
            if layout == Layout::Narrow && self.range.shows_axes {
                self.range_files(ui);
            }
        });
        let bottom = egui::Panel::bottom("range captions").frame(frame).resizable(false);
        let mut taken = None;
        bottom.show_separator_line(false).show(ui, |ui| {
            if layout == Layout::Narrow && self.range.chart.cursor().is_some() {
                let button = Button::new(self.plan.device.words("Take this implant"));
                let size = egui::vec2(ui.available_width(), theme::TOUCH - 8.0);
                if ui.add_sized(size, button).clicked() {
                    taken = self.range.chart.cursor();
                }
            }
            self.range.captions(ui);
        });
        egui::CentralPanel::default().frame(frame).show(ui, |ui| {
            let Range { map, chart, quantity, revision, .. } = &mut self.range;
            if let Some(map) = map.study() {
                taken = chart.show(ui, map, *quantity, *revision).or(taken);
            }
        });
        self.show_notice(ui, area);
        if let Some((i, j)) = taken {
            self.take(i, j, scene);
        }
    }

    /// Takes the implant of a point: one step of the history, as an edit of the plan.
    fn take(&mut self, i: usize, j: usize, scene: &mut Scene) {
        let Some(map) = self.range.map.study() else { return };
        let values: Vec<(Parameter, f64)> =
            map.axes().iter().zip([i, j]).map(|(a, k)| (a.field, a.value(k))).collect();
        let taken = match map.status(i, j) {
            PointStatus::Invalid => {
                Err(readout::lines(map, i, j, self.range.quantity).swap_remove(0))
            }
            _ => with_values(scene, &values).map_err(|error| error.to_string()),
        };
        match taken {
            Ok(taken) => *scene = taken,
            Err(reason) => {
                let place = readout::place(map, i, j);
                self.notice = Some(Notice::caution(format!("{place} was not taken. {reason}")));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_that_set_the_same_field_change_places() {
        let scene = Scene::opening();
        let mut range = Range::default();
        range.set_field(true, Some(Parameter::Projection), &scene);
        assert_eq!(range.up.map(|up| up.field), Some(Parameter::BaseWidth));
        // Volume and projection go together with the width as the third.
        range.set_field(false, Some(Parameter::Volume), &scene);
        assert_eq!(range.axes(&scene).len(), 2);
        range.set_field(true, Some(Parameter::Pinch), &scene);
        assert_eq!(range.up.map(|up| up.field), Some(Parameter::Volume));
        range.set_field(false, None, &scene);
        assert_eq!(range.axes(&scene).len(), 1);
        range.set_field(true, Some(Parameter::Thickness), &scene);
        assert_eq!(range.up, None);
    }

    #[test]
    fn an_axis_without_length_is_one_line_in_the_words_of_the_chart() {
        let axis = Axis { field: Parameter::BaseWidth, from: 120.0, to: 120.0, count: 20 };
        let line = empty_axis(&[axis]).unwrap();
        assert_eq!(line, "Width from 12 cm to 12 cm; allowed: two different numbers.");
        assert_eq!(empty_axis(&[Axis { to: 130.0, ..axis }]), None);
    }

    #[test]
    fn differences_are_rounded_up_to_one_digit() {
        assert_eq!(within_text(Quantity::GreatestStrain, 0.0031), "0.4 % (points)");
        assert_eq!(within_text(Quantity::LeastCoverMm, 0.02), "0.02 mm");
        assert_eq!(within_text(Quantity::GreatestPressureMmhg, 12.0), "20 mmHg");
        assert_eq!(within_text(Quantity::ForceN, 0.0), "0.001 N");
    }
}

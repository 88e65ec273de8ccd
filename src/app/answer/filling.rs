//! The filling of an expander: pressure, force and gained skin against the fill, each point one solved scene; `fill_steps` reads
//! the curves at each visit.

use super::fill_steps::{self, Curves, FillSteps};
use super::plots::fixed_plot;
use crate::app::frame::action::Action;
use crate::app::frame::files;
use crate::app::frame::shared::Shared;
use crate::app::frame::studies::{Driver, Studies};
use crate::app::plan::volumes::{COUNT, volumes};
use crate::app::plan::{self, Device};
use crate::app::range::{marks, within_text};
use crate::app::texts::{MOST_PRESSURE, fixed, mmhg, tr};
use crate::app::widgets::theme::{self, Palette, SPACE, SPACE_SMALL};
use crate::app::widgets::{group, remark};
use crate::clinical::When;
use crate::export;
use crate::measure::bands::{FILLING_PRESSURE_MMHG, REALISED_AREA_GAIN};
use crate::scene::{Scene, Side};
use crate::study::{Map, MapCheck, MapSettings, Parameter, Quantity};
use eframe::egui::{self, RichText, Ui};
use egui_plot::{GridMark, HoverPosition, Line, LineStyle, PlotUi, Points, Polygon, VLine};

/// Projection / half base width of the greatest fill \[-\].
const MOST_RATIO: f64 = 1.0;
/// Grid and tolerance of the fills.
const SETTINGS: MapSettings = MapSettings { nodes_per_side: 65, tolerance: 1e-3 };
/// Height of a chart, and width of the numbers beside it \[points\].
const HEIGHT: f32 = 118.0;
const AXIS_WIDTH: f32 = 24.0;
/// About so many numbers beside a chart.
const NUMBERS: usize = 3;

/// A chart: its quantity with a thick line, and a second one with a thin line.
struct Chart {
    name: &'static str,
    quantity: Quantity,
    second: Option<Quantity>,
    legend: &'static str,
}

const CHARTS: [Chart; 3] = [
    Chart {
        name: "Pressure (mmHg)",
        quantity: Quantity::GreatestPressureMmhg,
        second: Some(Quantity::MeanPressureMmhg),
        legend: "Greatest (thick) and mean. 30–60 mmHg (shaded where the chart reaches so far) were measured right after \
                 clinical filling.",
    },
    Chart { name: "Force (N)", quantity: Quantity::ForceN, second: None, legend: "" },
    Chart {
        name: "Skin gained (cm²)",
        quantity: Quantity::SkinAreaGainCm2,
        second: None,
        legend: "Right after filling. Dotted: the third (35 %) of such a gain that remained with tissue expanders.",
    },
];

/// The study behind the charts, one curve over the fill.
#[derive(Default)]
pub(crate) struct Filling {
    curve: Driver<Map>,
    check: Driver<MapCheck>,
    /// The curve a week after filling.
    later: Driver<Map>,
    /// The scene of the present curve.
    started: Option<Scene>,
    /// Why there is no curve.
    error: Option<String>,
}

/// A table to save: the results of all fills (CSV), or the rows of the steps.
enum Saved {
    Curve(String),
    Steps(Vec<Vec<String>>),
}

/// Rows for a file: before them the date and, as far as the plan states them, patient's number and side; behind them what a row is.
fn with_patient(mut rows: Vec<Vec<String>>, scene: &Scene) -> Vec<Vec<String>> {
    let date = files::date_of_visit(scene);
    let stated = [
        ("Patient no.", plan::patient_number(scene)),
        ("Breast", scene.side.map(Side::word)),
        ("Date", Some(&*date)),
    ];
    for (head, value) in stated.into_iter().rev() {
        let Some(value) = value else { continue };
        let cells = std::iter::once(head).chain(std::iter::repeat(value));
        for (row, cell) in rows.iter_mut().zip(cells) {
            row.insert(0, cell.to_owned());
        }
    }
    let notes = std::iter::once("Note").chain(std::iter::repeat(fill_steps::NOTE_OF_ROW));
    for (row, note) in rows.iter_mut().zip(notes) {
        row.push(note.to_owned());
    }
    rows
}

/// The table of fill steps of a plan.
fn steps_of(scene: &Scene) -> FillSteps {
    FillSteps(scene.visit.as_ref().and_then(|visit| visit.fill_steps).unwrap_or_default())
}

impl Filling {
    /// Starts, continues or cancels the study, once a frame. `device`: an implant has no curve. `is_busy`: the plan is
    /// being solved or edited.
    pub(crate) fn advance(
        &mut self,
        scene: &Scene,
        device: Device,
        studies: &mut Studies,
        is_busy: bool,
    ) {
        if device == Device::Implant {
            if self.started.take().is_some() {
                self.curve.cancel(studies);
                self.check.cancel(studies);
                self.later.cancel(studies);
            }
            return;
        }
        if !is_busy && self.started.as_ref() != Some(scene) {
            self.restart(scene, studies);
        }
        self.curve.advance(studies);
        if self.check.study().is_none()
            && let Some(curve) = self.curve.finished()
            && let Some(check) = curve.check()
        {
            self.check.start(check, studies);
        }
        self.check.advance(studies);
        if self.later.study().is_none()
            && self.check.finished().is_some()
            && let Some(curve) = self.curve.finished()
            && let Some(base) = &self.started
            && let Ok(later) =
                Map::new(&Scene { insertion: 1.0, ..base.at(When::Week) }, curve.axes(), SETTINGS)
        {
            self.later.start(later, studies);
        }
        self.later.advance(studies);
    }

    /// The curves that are solved.
    fn curves<'a>(&'a self, curve: &'a Map) -> Curves<'a> {
        Curves { curve, later: self.later.finished() }
    }

    /// Starts the curve of a scene. Another fill leaves the curve as it is.
    fn restart(&mut self, scene: &Scene, studies: &mut Studies) {
        self.started = Some(scene.clone());
        let mut base = scene.clone();
        base.insertion = 1.0;
        let axis = volumes(&scene.implant, MOST_RATIO);
        let is_equal = |curve: &mut Map| curve.axes() == [axis] && curve.move_to(&base);
        if self.curve.study_mut().is_some_and(is_equal) {
            return;
        }
        self.check.cancel(studies);
        self.curve.cancel(studies);
        self.later.cancel(studies);
        match Map::new(&base, &[axis], SETTINGS) {
            Ok(curve) => {
                self.error = None;
                self.curve.start(curve, studies);
            }
            Err(error) => self.error = Some(error.to_string()),
        }
    }

    /// The fill and a value at each solved fill.
    fn line(&self, quantity: Quantity) -> Vec<[f64; 2]> {
        let Some(curve) = self.curve.study() else { return Vec::new() };
        let factor = quantity.display().0;
        let point = |i| Some([curve.axes()[0].value(i), factor * curve.value(quantity, i, 0)?]);
        (0..COUNT).filter_map(point).collect()
    }

    /// The fill steps up to the fill of a plan, heads first; empty before the curve of that plan is solved.
    pub(crate) fn steps(&self, scene: &Scene) -> Vec<Vec<String>> {
        let is_of_plan = self.started.as_ref().is_some_and(|started| started.same_physics(scene));
        let full_ml = Parameter::Volume.value(scene).filter(|_| is_of_plan);
        let solved = self.curve.finished().zip(full_ml);
        solved.map_or_else(Vec::new, |(curve, full)| steps_of(scene).rows(self.curves(curve), full))
    }

    /// The section of the curves over the fill; nothing for an implant.
    pub(crate) fn section(&self, ui: &mut Ui, shared: &Shared, actions: &mut Vec<Action>) {
        if shared.choices.device != Device::Expander {
            return;
        }
        let scene = shared.session.scene();
        let fill = Parameter::Volume.value(scene).unwrap_or_default();
        let before = steps_of(scene);
        let (mut saved, mut steps) = (None, before);
        group(ui, tr("Filling"), |ui| saved = self.show(ui, fill, &mut steps));
        if steps != before {
            let mut scene = scene.clone();
            plan::set_fill_steps(&mut scene, steps.0);
            actions.push(Action::Replace(scene));
        }
        let device = shared.choices.device;
        actions.extend(saved.map(|saved| match saved {
            Saved::Curve(csv) => {
                let name = files::name_with_size(scene, device, "filling", "csv");
                Action::Save(name, csv.into())
            }
            Saved::Steps(rows) => {
                let name = files::name_with_visit(scene, device, "fill-steps", "csv");
                Action::Save(name, export::csv(&with_patient(rows, scene)).into())
            }
        }));
    }

    /// Shows the steps up to the present fill \[ml\], and the charts with that fill; returns what should be saved.
    fn show(&self, ui: &mut Ui, fill: f64, steps: &mut FillSteps) -> Option<Saved> {
        let palette = theme::palette(ui.visuals());
        if let Some(error) = &self.error {
            ui.add(egui::Label::new(RichText::new(error).color(palette.bad)).wrap());
            return None;
        }
        // The table a surgeon works by comes first.
        let solved = self.curve.finished();
        let table = self
            .curve
            .study()
            .and_then(|curve| steps.show(ui, self.curves(curve), fill, solved.is_some()));
        ui.add_space(SPACE);
        for chart in &CHARTS {
            ui.label(RichText::new(tr(chart.name)).small().strong());
            self.chart(ui, chart, fill, palette);
            if !chart.legend.is_empty() {
                remark(ui, tr(chart.legend));
            }
            ui.add_space(SPACE_SMALL);
        }
        remark(ui, self.caption());
        if let Some(failure) = self.curve.failure().or_else(|| self.check.failure()) {
            ui.add(egui::Label::new(RichText::new(failure).small().color(palette.bad)).wrap());
        }
        let save = ui.add_enabled(solved.is_some(), egui::Button::new(tr("Save table (CSV)…")));
        let is_saved = save.on_hover_text(tr("All results of all fills")).clicked();
        table.map(Saved::Steps).or_else(|| Some(Saved::Curve(solved.filter(|_| is_saved)?.csv())))
    }

    fn chart(&self, ui: &mut Ui, chart: &Chart, fill: f64, palette: &Palette) {
        let line = self.line(chart.quantity);
        let name = tr(chart.name).to_owned();
        let is_pressure = chart.quantity == Quantity::GreatestPressureMmhg;
        let read = move |at: &HoverPosition<'_>| match at {
            HoverPosition::NearDataPoint { position: at, .. } => {
                let value = if is_pressure { mmhg(at.y) } else { fixed(at.y, 1) };
                Some(format!("{:.0} ml\n{name}: {value}", at.x))
            }
            HoverPosition::Elsewhere { .. } => None,
        };
        let plot = fixed_plot(chart.name, HEIGHT)
            .width(ui.available_width() - SPACE)
            .y_axis_min_width(AXIS_WIDTH)
            .include_y(0.0)
            .x_axis_label(tr("fill (ml)"))
            .y_grid_spacer(|input| {
                // Some numbers at any height of the curve.
                let (low, high) = input.bounds;
                let mark = |value| GridMark { value, step_size: (high - low) / NUMBERS as f64 };
                marks((low, high), NUMBERS).into_iter().map(mark).collect()
            })
            .label_formatter(read)
            // One point has no range for the numbers of an axis.
            .show_axes(line.len() > 1)
            .show_grid(line.len() > 1);
        plot.show(ui, |plot| {
            let ends = line.first().zip(line.last()).map(|(a, b)| (a[0], b[0]));
            if is_pressure {
                let (least, most) = FILLING_PRESSURE_MMHG;
                let top = line.iter().fold(0.0, |top: f64, point| top.max(point[1]));
                // The numbers beside the chart end where the pressure is no number.
                if top > MOST_PRESSURE {
                    plot.set_plot_bounds_y(0.0..=MOST_PRESSURE);
                }
                // A range far above the curve would flatten the curve.
                if let Some((from, to)) = ends.filter(|_| top > 0.5 * least) {
                    let corners = [[from, least], [to, least], [to, most], [from, most]];
                    shade(plot, corners, palette);
                }
            }
            if chart.quantity == Quantity::SkinAreaGainCm2 {
                let part = |point: &[f64; 2]| [point[0], REALISED_AREA_GAIN * point[1]];
                let kept = Line::new("", line.iter().map(part).collect::<Vec<_>>());
                plot.line(kept.color(palette.curves[0]).style(LineStyle::dotted_dense()));
            }
            if let Some(second) = chart.second {
                plot.line(Line::new("", self.line(second)).color(palette.curves[0]).width(1.0));
            }
            plot.points(Points::new("", line.clone()).color(palette.curves[0]).radius(2.0));
            plot.line(Line::new("", line).color(palette.curves[0]).width(2.0));
            plot.vline(VLine::new("", fill).color(palette.accent).width(1.5));
        });
    }

    /// The curves in words: progress or ends, missing fills, and the difference from a finer grid.
    fn caption(&self) -> String {
        let (done, all) = self.curve.progress();
        let Some(curve) = self.curve.study().filter(|_| done == all) else {
            return tr!("{done} of {count} fills computed.", done, count = COUNT);
        };
        let line = self.line(Quantity::GreatestPressureMmhg);
        let mut words = Vec::new();
        if let (Some([least, low]), Some([most, high])) = (line.first(), line.last()) {
            words.push(tr!("From {least:.0} to {most:.0} ml the greatest pressure goes from {low} to {high} mmHg. The \
                 upright line is this plan's fill.", least, most, low = mmhg(*low), high = mmhg(*high)));
        }
        if line.len() < COUNT {
            let missing = COUNT - line.len();
            let has = if missing == 1 { tr("has") } else { tr("have") };
            words.push(tr!(
                "{missing} of {count} fills {has} no answer.",
                missing,
                count = COUNT,
                has
            ));
        }
        let check = self.check.finished();
        let differences = check.map(|check| curve.differences(check)).unwrap_or_default();
        let of = |quantity: Quantity| {
            let found = differences.iter().find(|found| found.quantity == quantity)?;
            Some(within_text(quantity, found.difference))
        };
        let found: Vec<String> = CHARTS.iter().filter_map(|chart| of(chart.quantity)).collect();
        if !found.is_empty() {
            words.push(tr!(
                "A finer computation differs by at most {differences}.",
                differences = found.join(", ")
            ));
        }
        words.join(" ")
    }
}

/// Shades a quadrilateral.
fn shade(plot: &mut PlotUi<'_>, corners: [[f64; 2]; 4], palette: &Palette) {
    let color = palette.caution.gamma_multiply(0.15);
    let area = Polygon::new("", corners.to_vec()).fill_color(color);
    plot.polygon(area.stroke(egui::Stroke::NONE).allow_hover(false));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Visit;

    #[test]
    fn the_saved_steps_have_patient_side_and_date_and_say_what_a_row_is() {
        let rows = || vec![vec!["Week".to_owned()], vec!["0".to_owned()], vec!["1".to_owned()]];
        let mut scene = Scene::opening();
        let note = fill_steps::NOTE_OF_ROW;
        assert!(note.contains("at once") && note.contains("no growth or relaxation"));
        let visit = |reference: &str| Visit {
            reference: reference.to_owned(),
            date: "2026-11-25".to_owned(),
            ..Visit::default()
        };
        scene.visit = Some(visit(""));
        let date = "2026-11-25";
        let expected = [["Date", "Week", "Note"], [date, "0", note], [date, "1", note]];
        assert_eq!(with_patient(rows(), &scene), expected);
        (scene.visit, scene.side) = (Some(visit(" P-014")), Some(Side::Right));
        let row = |week| ["P-014", "right", date, week, note];
        let heads = ["Patient no.", "Breast", "Date", "Week", "Note"];
        assert_eq!(with_patient(rows(), &scene), [heads, row("0"), row("1")]);
    }
}

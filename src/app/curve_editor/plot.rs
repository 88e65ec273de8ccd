//! A small plot of a preset curve with its scales: solid where the tissue was measured, dashed beyond.

use crate::app::answer::plots::{fixed_plot, sampled};
use crate::app::range::marks;
use crate::app::texts::{self, tr};
use crate::app::widgets::quantity::format_at_most;
use crate::app::widgets::theme::{self, SPACE};
use crate::app::widgets::{remark, set_accessible_name};
use crate::curve::{Curve, CurveSpec, ScaledCurve};
use eframe::egui::{self, Color32, Rangef, Ui};
use egui_plot::{GridMark, Line, LineStyle, PlotUi, VLine};

/// Height of the plot and width of its numbers \[points\].
const HEIGHT: f32 = 92.0;
const AXIS_WIDTH: f32 = 24.0;

/// Where the points of a preset come from; `None` for a curve that is no preset.
fn source(spec: &CurveSpec) -> Option<&'static str> {
    match spec {
        CurveSpec::Skin {} => Some(tr(
            "Slope 100 kPa, within the 56–344 kPa measured on breast skin in vivo; ten times as steep from 70 % on, as \
             skin stiffens in tests of strips (Hendriks, in Nikolaev 2013).",
        )),
        CurveSpec::Fat { .. } => Some(tr(
            "At rest: mean of Alkhouli et al. 2013 (1.6 kPa), Sims et al. 2010 (1.6), elastography (2.25) and breast fat in \
             vivo (3.04). To 30 %: tension of human fat, Alkhouli et al., Am. J. Physiol. Endocrinol. Metab. 305, 2013 (1.6 ± \
             0.8 to 11.7 ± 6.4 kPa), × 0.77 for tissue at rest. Beyond: no slow test was found; a line with the end \
             slope.",
        )),
        CurveSpec::Adipose {} => Some(tr(
            "The fat of Nikolaev 2013 (after Geerlings): 3 kPa at rest, breast fat in vivo 3.04 ± 1.17 kPa. Its plateau \
             beyond 60 % was found in no slow test of fat.",
        )),
        _ => None,
    }
}

/// Plots a preset with its scales; nothing for a curve of another kind. `tissue`: the name of the layer.
pub(super) fn show(ui: &mut Ui, scaled: &ScaledCurve, tissue: &str) {
    let (Some(source), Ok(curve)) = (source(&scaled.spec), Curve::scaled(scaled)) else { return };
    let color = theme::palette(ui.visuals()).curves[0];
    let end = curve.data_end();
    let [strains, stresses] = [end, curve.stress(end)].map(ticks);
    let plot = fixed_plot("preset", HEIGHT)
        .width(ui.available_width() - 2.0 * SPACE)
        .y_axis_min_width(AXIS_WIDTH)
        .show_crosshair(false)
        .label_formatter(|_| None)
        .grid_spacing(Rangef::new(8.0, 1200.0))
        .x_grid_spacer(move |_| strains.clone())
        .y_grid_spacer(move |_| stresses.clone())
        .x_axis_formatter(|mark, _| format!("{:.0} %", 100.0 * mark.value))
        .y_axis_formatter(|mark, _| format_at_most(mark.value, 0, 2))
        .y_axis_label("kPa")
        .show(ui, |plot| lines(plot, &curve, end, color));
    let measured = curve.measured_end();
    let is_extrapolated = measured < end;
    let words = if is_extrapolated {
        tr!(
            "Solid: measured, to {measured:.0} % strain. Dashed: extrapolated.",
            measured = 100.0 * measured
        )
    } else {
        tr!("Up to {end:.0} % strain", end = 100.0 * end)
    };
    let name = tr!("Curve of {tissue}. {words}", tissue = texts::tissue(tissue), words);
    set_accessible_name(&plot.response, egui::Role::Image, &name);
    plot.response.on_hover_text(source);
    if is_extrapolated {
        remark(ui, words).on_hover_text(source);
    }
}

/// A few round numbers up to `end`, all of them with a number.
fn ticks(end: f64) -> Vec<GridMark> {
    let mark = |value: f64| GridMark { value, step_size: end };
    marks((0.0, end), 4).into_iter().map(mark).collect()
}

/// Draws a curve up to a strain: solid up to the end of the measurements, dashed and faint beyond, with a line between.
fn lines(plot: &mut PlotUi<'_>, curve: &Curve, end: f64, color: Color32) {
    let measured = curve.measured_end();
    plot.line(Line::new("", sampled(curve, 0.0, end.min(measured))).color(color).width(2.0));
    if measured < end {
        let faint = color.gamma_multiply(0.7);
        let beyond = Line::new("", sampled(curve, measured, end));
        plot.line(beyond.color(faint).width(1.5).style(LineStyle::dashed_dense()));
        plot.vline(VLine::new("", measured).color(color.gamma_multiply(0.4)).width(1.0));
    }
}

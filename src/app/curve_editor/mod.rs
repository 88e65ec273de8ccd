//! Editor of a layer's stress–strain curve: its kind and its parameters here, the `plot` of a preset, its measured points in a
//! `window`, with the `import` of a tensile test.

mod import;
mod plot;
mod window;

pub(super) use window::CurveWindow;

use crate::app::texts::tr;
use crate::app::widgets::{Control, Kind, button_if, choice, labelled_box, remark};
use crate::curve::{Curve, CurveSpec, Fat, Interpolation, ScaledCurve};
use eframe::egui::Ui;
use std::ops::RangeInclusive;

/// Name and description of the kinds that the editor offers. Curves of sections come from a scene file.
const KINDS: [(&str, &str); 7] = [
    ("Skin preset", "Modulus 100 kPa up to strain 0.4, rising to 1000 kPa at 0.7"),
    ("Fat, as measured", "Fat as measured up to a strain of 30 %, a line beyond"),
    (
        "Adipose of Nikolaev 2013",
        "0.4 kPa · atan(7.5 ε): initial modulus 3 kPa, nearly flat beyond 60 %",
    ),
    ("Linear", "Young's modulus"),
    ("Arctangent", "scale · atan(rate · ε)"),
    ("Exponential (Fung)", "scale · (exp(rate · ε) − 1)"),
    ("Measured points", "Points joined by straight lines or a monotone spline"),
];

fn kind(spec: &CurveSpec) -> Option<usize> {
    Some(match spec {
        CurveSpec::Skin {} => 0,
        CurveSpec::Fat { .. } => 1,
        CurveSpec::Adipose {} => 2,
        CurveSpec::Linear { .. } => 3,
        CurveSpec::Arctangent { .. } => 4,
        CurveSpec::Exponential { .. } => 5,
        CurveSpec::Points { .. } => 6,
        CurveSpec::Sections { .. } => return None,
    })
}

/// Converts a curve to another kind, as close to the present curve as that kind allows.
fn converted(spec: &CurveSpec, kind: usize) -> CurveSpec {
    let curve = Curve::new(spec).ok();
    let slope = curve.as_ref().map_or(10.0, |c| c.slope(0.0)).clamp(0.01, 1e5);
    match kind {
        0 => CurveSpec::Skin {},
        1 => CurveSpec::Fat { variant: Fat::Mid },
        2 => CurveSpec::Adipose {},
        3 => CurveSpec::Linear { modulus_kpa: slope },
        4 => CurveSpec::Arctangent { scale_kpa: slope / 7.5, rate: 7.5 },
        5 => CurveSpec::Exponential { scale_kpa: slope / 4.0, rate: 4.0 },
        _ => {
            let stress = |e: f64| curve.as_ref().map_or(slope * e, |c| c.stress(e));
            // Breaks of the curve become points too.
            let breaks: Vec<f64> = curve.iter().flat_map(Curve::breaks).collect();
            let mut strains = vec![0.0, 0.2, 0.4, 0.6, 0.8, 1.0];
            strains.extend(breaks.into_iter().filter(|e| *e > 0.05 && *e < 0.95).take(6));
            strains.sort_by(f64::total_cmp);
            strains.dedup_by(|a, b| *a - *b < 0.01);
            let points = strains.into_iter().map(|e| [e, stress(e)]).collect();
            CurveSpec::Points { points, interpolation: Interpolation::Spline }
        }
    }
}

/// Edits kind and parameters of a curve in place and plots a preset. `tissue`: the name of the layer. Returns whether the
/// window of the curve's points is to be opened.
pub(super) fn show(ui: &mut Ui, curve: &mut ScaledCurve, tissue: &str) -> bool {
    let is_opened = edit(ui, &mut curve.spec);
    plot::show(ui, curve, tissue);
    is_opened
}

/// Edits kind and parameters. Returns whether the window of the points is to be opened.
fn edit(ui: &mut Ui, spec: &mut CurveSpec) -> bool {
    let present = kind(spec);
    let selected = present.map_or(tr("Sections (from a file)"), |k| tr(KINDS[k].0));
    let response = labelled_box(ui, tr("Stress–strain curve"), selected, |ui| {
        for (k, (name, tooltip)) in KINDS.iter().enumerate() {
            let choice = choice(ui, present == Some(k), tr(name));
            if choice.on_hover_text(tr(tooltip)).clicked() && present != Some(k) {
                *spec = converted(spec, k);
            }
        }
    });
    response.on_hover_text(tr("Nominal stress against engineering strain, as measured"));
    match spec {
        CurveSpec::Linear { modulus_kpa } => {
            stress(ui, tr("Young's modulus"), modulus_kpa, 100.0);
        }
        CurveSpec::Arctangent { scale_kpa, rate: value } => {
            stress(ui, tr("Scale"), scale_kpa, 0.4);
            rate(ui, value, 7.5, 0.1..=100.0);
        }
        CurveSpec::Exponential { scale_kpa, rate: value } => {
            stress(ui, tr("Scale"), scale_kpa, 2.0);
            rate(ui, value, 4.0, 0.1..=9.0);
        }
        CurveSpec::Points { points, interpolation } => {
            let end = points.last().map_or(0.0, |point| 100.0 * point[0]);
            let form = match interpolation {
                Interpolation::Line => tr("straight"),
                Interpolation::Spline => tr("smooth"),
            };
            remark(
                ui,
                tr!(
                    "{count} points up to {end:.0} % strain, {form} between",
                    count = points.len(),
                    end,
                    form
                ),
            );
            let tip = tr("Type or paste the points of a measured curve");
            return button_if(ui, true, tr("Edit points…"), tr("Edit points"), tip);
        }
        CurveSpec::Fat { variant } => fat(ui, variant),
        CurveSpec::Skin {} | CurveSpec::Adipose {} | CurveSpec::Sections { .. } => {}
    }
    false
}

/// The choice among the curves within the range of the measurements.
fn fat(ui: &mut Ui, variant: &mut Fat) {
    let name = |fat: Fat| match fat {
        Fat::Low => tr("Soft"),
        Fat::Mid => tr("Usual"),
        Fat::High => tr("Firm"),
    };
    let response = labelled_box(ui, tr("Firmness"), name(*variant), |ui| {
        for fat in Fat::ALL {
            if choice(ui, *variant == fat, name(fat)).clicked() {
                *variant = fat;
            }
        }
    });
    response.on_hover_text(tr("Low, middle and high end of what tests of human fat found"));
}

fn stress(ui: &mut Ui, label: &str, value: &mut f64, reset: f64) {
    Control {
        unit: "kPa",
        kind: Kind::Stress,
        tooltip: tr("In vivo: breast fat about 3 kPa, breast skin 56–344 kPa."),
        ..parameter(label, 0.01..=1e4, reset)
    }
    .show(ui, value);
}

fn rate(ui: &mut Ui, value: &mut f64, reset: f64, range: RangeInclusive<f64>) {
    Control {
        tooltip: tr("How quickly the slope changes with strain."),
        ..parameter(tr("Rate"), range, reset)
    }
    .show(ui, value);
}

/// A control of a curve's parameter, with a logarithmic rail.
fn parameter(label: &str, range: RangeInclusive<f64>, reset: f64) -> Control<'_> {
    Control { label, range, reset, decimals: 2, step: 0.0, logarithmic: true, ..Control::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_preset_made_points_keeps_every_point_on_its_curve() {
        for preset in
            [CurveSpec::Skin {}, CurveSpec::Adipose {}, CurveSpec::Fat { variant: Fat::Mid }]
        {
            let curve = Curve::new(&preset).unwrap();
            let CurveSpec::Points { points, .. } = converted(&preset, 6) else {
                panic!("no points")
            };
            assert_eq!(points.last().map(|p| p[0]), Some(1.0));
            for [strain, stress] in points {
                assert_eq!(stress.to_bits(), curve.stress(strain).to_bits(), "at {strain}");
            }
        }
    }
}

//! Choosing a layer's stress–strain curve: its kind, its numbers, its marked points.

use super::theme::SPACE;
use super::widgets::{
    Control, Kind, NumberField, button_if, choice, labelled_box, rejection_label,
};
use crate::curve::{Curve, CurveSpec, Interpolation};
use eframe::egui::{self, Ui};

/// What a marked point may be: strain \[-\] and stress \[kPa\].
const MAX_POINT: [f64; 2] = [10.0, 1e7];

/// The kinds that can be made here; sections come from a scene file.
const KINDS: [(&str, &str); 6] = [
    ("Skin preset", "Modulus 100 kPa up to strain 0.4, rising to 1000 kPa at 0.7"),
    ("Adipose preset", "0.4 kPa · atan(7.5 ε): initial modulus 3 kPa"),
    ("Linear", "Young's modulus"),
    ("Arctangent", "scale · atan(rate · ε)"),
    ("Exponential (Fung)", "scale · (exp(rate · ε) − 1)"),
    ("Measured points", "Points joined by straight lines or a monotone spline"),
];

fn kind(spec: &CurveSpec) -> Option<usize> {
    Some(match spec {
        CurveSpec::Skin {} => 0,
        CurveSpec::Adipose {} => 1,
        CurveSpec::Linear { .. } => 2,
        CurveSpec::Arctangent { .. } => 3,
        CurveSpec::Exponential { .. } => 4,
        CurveSpec::Points { .. } => 5,
        CurveSpec::Sections { .. } => return None,
    })
}

/// A curve of another kind, as near to the present one as that kind allows.
fn converted(spec: &CurveSpec, kind: usize) -> CurveSpec {
    let curve = Curve::new(spec).ok();
    let slope = curve.as_ref().map_or(10.0, |c| c.slope(0.0)).clamp(0.01, 1e5);
    match kind {
        0 => CurveSpec::Skin {},
        1 => CurveSpec::Adipose {},
        2 => CurveSpec::Linear { modulus_kpa: slope },
        3 => CurveSpec::Arctangent { scale_kpa: slope / 7.5, rate: 7.5 },
        4 => CurveSpec::Exponential { scale_kpa: slope / 4.0, rate: 4.0 },
        _ => {
            let stress = |e: f64| curve.as_ref().map_or(slope * e, |c| c.stress(e));
            // Where the curve changes its form there is a point too.
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

/// Edits a curve in place. What is refused is not taken over, and said below the table.
pub(super) fn show(ui: &mut Ui, spec: &mut CurveSpec) {
    let present = kind(spec);
    let selected = present.map_or("Sections (from a file)", |k| KINDS[k].0);
    let response = labelled_box(ui, "Stress–strain curve", selected, |ui| {
        for (k, (name, tooltip)) in KINDS.iter().enumerate() {
            let choice = choice(ui, present == Some(k), *name);
            if choice.on_hover_text(*tooltip).clicked() && present != Some(k) {
                *spec = converted(spec, k);
            }
        }
    });
    response.on_hover_text("Nominal stress against engineering strain, as measured");
    match spec {
        CurveSpec::Linear { modulus_kpa } => {
            stress(ui, "Young's modulus", modulus_kpa, 100.0);
        }
        CurveSpec::Arctangent { scale_kpa, rate: value } => {
            stress(ui, "Scale", scale_kpa, 0.4);
            rate(ui, value, 7.5, 0.1..=100.0);
        }
        CurveSpec::Exponential { scale_kpa, rate: value } => {
            stress(ui, "Scale", scale_kpa, 2.0);
            rate(ui, value, 4.0, 0.1..=9.0);
        }
        CurveSpec::Points { points, interpolation } => edit_points(ui, points, interpolation),
        CurveSpec::Skin {} | CurveSpec::Adipose {} | CurveSpec::Sections { .. } => {}
    }
}

fn stress(ui: &mut Ui, label: &str, value: &mut f64, reset: f64) {
    Control {
        label,
        unit: "kPa",
        kind: Kind::Stress,
        range: 0.01..=1e4,
        reset,
        decimals: 2,
        step: 0.0,
        logarithmic: true,
        tooltip: "In vivo: breast fat about 3 kPa, breast skin 56–344 kPa.",
        ..Control::default()
    }
    .show(ui, value);
}

fn rate(ui: &mut Ui, value: &mut f64, reset: f64, range: std::ops::RangeInclusive<f64>) {
    Control {
        label: "Rate",
        range,
        reset,
        decimals: 2,
        step: 0.0,
        logarithmic: true,
        tooltip: "How quickly the slope changes with strain.",
        ..Control::default()
    }
    .show(ui, value);
}

/// A table that is being filled in, of the points that it is to replace.
#[derive(Clone)]
struct PointTable {
    source: Vec<[f64; 2]>,
    points: Vec<[f64; 2]>,
}

/// Edits the points in a table of their own: the curve takes them over as soon as they are in order, and
/// stays as it was until then.
fn edit_points(ui: &mut Ui, points: &mut Vec<[f64; 2]>, interpolation: &mut Interpolation) {
    ui.horizontal(|ui| {
        ui.radio_value(interpolation, Interpolation::Line, "Lines");
        ui.radio_value(interpolation, Interpolation::Spline, "Spline");
    });
    let id = ui.scope_id().with("table");
    let kept =
        ui.data(|data| data.get_temp::<PointTable>(id)).filter(|table| table.source == *points);
    let mut table = kept.map_or_else(|| points.clone(), |table| table.points);
    let fault = first_non_increasing(&table);
    let (mut remove, mut rejections) = (None, Vec::new());
    egui::Grid::new("points").num_columns(3).spacing([SPACE, 2.0]).show(ui, |ui| {
        ui.small("Strain");
        ui.small("Stress (kPa)");
        ui.end_row();
        for k in 0..table.len() {
            if k == 0 {
                // The first point is the origin of every curve.
                for _ in 0..2 {
                    ui.monospace("0");
                }
                ui.end_row();
                continue;
            }
            for (axis, kind) in [Kind::Fraction, Kind::Stress].into_iter().enumerate() {
                let name = format!("{} of point {}", ["Strain", "Stress"][axis], k + 1);
                let typed = NumberField {
                    name: &name,
                    kind,
                    allowed: 0.0..=MAX_POINT[axis],
                    decimals: [2, 1][axis],
                    step: [0.01, 1.0][axis],
                    is_invalid: fault == Some((k, axis)),
                    ..NumberField::default()
                }
                .show(ui, &mut table[k][axis]);
                rejections.extend(typed.rejection.map(|reason| format!("{name}: {reason}")));
            }
            let name = format!("Remove point {}", k + 1);
            if button_if(ui, table.len() > 2, "×", &name, "") {
                remove = Some(k);
            }
            ui.end_row();
        }
    });
    rejections.iter().for_each(|reason| rejection_label(ui, reason));
    ui.small(
        "The curve passes through the points. Between the points it follows the lines or the spline \
         chosen above and may differ slightly from the original curve.",
    );
    if let Some(k) = remove {
        table.remove(k);
    }
    if button_if(
        ui,
        true,
        "Add point",
        "Add point",
        "Add a point on the line through the last two points",
    ) && let [.., [e0, s0], [e1, s1]] = table[..]
        && e1 < 9.0
        && e1 > e0
    {
        table.push([e1 + 0.1, s1 + 0.1 * (s1 - s0) / (e1 - e0)]);
    }
    match first_non_increasing(&table) {
        Some((k, axis)) => {
            let (name, unit) = [("strain", ""), ("stress", " kPa")][axis];
            let value = |k: usize| super::widgets::quantity::format(table[k][axis], 0);
            let (point, here, before) = (k + 1, value(k), value(k - 1));
            let reason = format!(
                "the {name} of point {point} ({here}{unit}) must be greater than that of point {k} \
                 ({before}{unit}). Until then the curve is unchanged."
            );
            rejection_label(ui, &reason);
        }
        None if table != *points => {
            let spec = CurveSpec::Points { points: table.clone(), interpolation: *interpolation };
            match Curve::new(&spec) {
                Ok(_) => points.clone_from(&table),
                Err(error) => {
                    rejection_label(ui, &format!("{error}. Until then the curve is unchanged."));
                }
            }
        }
        None => {}
    }
    ui.data_mut(|data| data.insert_temp(id, PointTable { source: points.clone(), points: table }));
}

/// The first point, and the axis in which it is not above the point before it.
fn first_non_increasing(points: &[[f64; 2]]) -> Option<(usize, usize)> {
    (1..points.len()).find_map(|k| {
        let axis = (0..2).find(|&axis| points[k][axis] <= points[k - 1][axis])?;
        Some((k, axis))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_preset_made_points_keeps_every_point_on_its_curve() {
        for preset in [CurveSpec::Skin {}, CurveSpec::Adipose {}] {
            let curve = Curve::new(&preset).unwrap();
            let CurveSpec::Points { points, .. } = converted(&preset, 5) else {
                panic!("no points")
            };
            assert_eq!(points.last().map(|p| p[0]), Some(1.0));
            for [strain, stress] in points {
                assert_eq!(stress.to_bits(), curve.stress(strain).to_bits(), "at {strain}");
            }
        }
    }

    #[test]
    fn points_that_do_not_rise_are_found() {
        assert_eq!(first_non_increasing(&[[0.0, 0.0], [0.4, 100.0], [0.5, 220.0]]), None);
        assert_eq!(first_non_increasing(&[[0.0, 0.0], [0.4, 100.0], [0.4, 220.0]]), Some((2, 0)));
        assert_eq!(first_non_increasing(&[[0.0, 0.0], [0.4, 100.0], [0.5, 90.0]]), Some((2, 1)));
    }
}

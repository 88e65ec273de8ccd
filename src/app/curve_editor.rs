//! Editor of a layer's stress–strain curve: its kind, its parameters, its measured points.

use super::theme::SPACE;
use super::widgets::{
    Control, Kind, NumberField, button_if, choice, labelled_box, quantity, rejection_label,
};
use crate::curve::{Curve, CurveSpec, Interpolation};
use eframe::egui::{self, Ui};
use std::ops::RangeInclusive;

/// Upper limits of a point: strain \[-\] and stress \[kPa\].
const MAX_POINT: [f64; 2] = [10.0, 1e7];

/// Name and description of the kinds that the editor offers. Curves of sections come from a scene file.
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

/// Converts a curve to another kind, as close to the present curve as that kind allows.
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

/// Edits a curve in place. Invalid input leaves the curve unchanged; the reason is below the table.
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
        unit: "kPa",
        kind: Kind::Stress,
        tooltip: "In vivo: breast fat about 3 kPa, breast skin 56–344 kPa.",
        ..parameter(label, 0.01..=1e4, reset)
    }
    .show(ui, value);
}

fn rate(ui: &mut Ui, value: &mut f64, reset: f64, range: RangeInclusive<f64>) {
    Control {
        tooltip: "How quickly the slope changes with strain.",
        ..parameter("Rate", range, reset)
    }
    .show(ui, value);
}

/// A control of a curve's parameter, with a logarithmic rail.
fn parameter(label: &str, range: RangeInclusive<f64>, reset: f64) -> Control<'_> {
    Control { label, range, reset, decimals: 2, step: 0.0, logarithmic: true, ..Control::default() }
}

/// A table of points being edited, with the points of the curve that it will replace.
#[derive(Clone)]
struct PointTable {
    source: Vec<[f64; 2]>,
    points: Vec<[f64; 2]>,
}

/// Edits the points in a separate table. The curve takes the points of the table as soon as they are
/// valid.
fn edit_points(ui: &mut Ui, points: &mut Vec<[f64; 2]>, interpolation: &mut Interpolation) {
    ui.horizontal(|ui| {
        ui.radio_value(interpolation, Interpolation::Line, "Lines");
        ui.radio_value(interpolation, Interpolation::Spline, "Spline");
    });
    let id = ui.scope_id().with("table");
    let kept = ui.data(|data| data.get_temp::<PointTable>(id));
    let kept = kept.filter(|table| table.source == *points);
    let mut table = kept.map_or_else(|| points.clone(), |table| table.points);
    let removed = point_grid(ui, &mut table);
    ui.small(
        "The curve passes through the points. Between the points it follows the lines or the spline \
         chosen above and may differ slightly from the original curve.",
    );
    if let Some(k) = removed {
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
    if table != *points {
        match invalid_reason(&table, *interpolation) {
            None => points.clone_from(&table),
            Some(reason) => {
                rejection_label(ui, &format!("{reason}. Until then the curve is unchanged."));
            }
        }
    }
    ui.data_mut(|data| {
        data.insert_temp(id, PointTable { source: points.clone(), points: table });
    });
}

/// Shows a row per point, and the reasons of rejected numbers. Returns the point to remove.
fn point_grid(ui: &mut Ui, table: &mut [[f64; 2]]) -> Option<usize> {
    let invalid = first_non_increasing(table);
    let is_removable = table.len() > 2;
    let (mut removed, mut rejections) = (None, Vec::new());
    egui::Grid::new("points").num_columns(3).spacing([SPACE, 2.0]).show(ui, |ui| {
        ui.small("Strain");
        ui.small("Stress (kPa)");
        ui.end_row();
        // The first point of every curve is the origin.
        for _ in 0..2 {
            ui.monospace("0");
        }
        ui.end_row();
        for (k, point) in table.iter_mut().enumerate().skip(1) {
            for (axis, kind) in [Kind::Fraction, Kind::Stress].into_iter().enumerate() {
                let name = format!("{} of point {}", ["Strain", "Stress"][axis], k + 1);
                let field = NumberField {
                    name: &name,
                    kind,
                    allowed: 0.0..=MAX_POINT[axis],
                    decimals: [2, 1][axis],
                    step: [0.01, 1.0][axis],
                    is_invalid: invalid == Some((k, axis)),
                    ..NumberField::default()
                };
                let response = field.show(ui, &mut point[axis]);
                rejections.extend(response.rejection.map(|reason| format!("{name}: {reason}")));
            }
            let name = format!("Remove point {}", k + 1);
            if button_if(ui, is_removable, "×", &name, "") {
                removed = Some(k);
            }
            ui.end_row();
        }
    });
    rejections.iter().for_each(|reason| rejection_label(ui, reason));
    removed
}

/// Reason why points are no valid curve; `None` for valid points.
fn invalid_reason(points: &[[f64; 2]], interpolation: Interpolation) -> Option<String> {
    let Some((k, axis)) = first_non_increasing(points) else {
        let spec = CurveSpec::Points { points: points.to_vec(), interpolation };
        return Curve::new(&spec).err().map(|error| error.to_string());
    };
    let (name, unit) = [("strain", ""), ("stress", " kPa")][axis];
    let value = |k: usize| quantity::format(points[k][axis], 0);
    let (point, here, before) = (k + 1, value(k), value(k - 1));
    Some(format!(
        "the {name} of point {point} ({here}{unit}) must be greater than that of point {k} ({before}{unit})"
    ))
}

/// Finds the first point that does not exceed the previous point, and the axis in which it does not.
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

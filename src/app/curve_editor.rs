//! Choosing a layer's stress–strain curve: its kind, its numbers, its marked points.

use super::controls::{Control, name_it};
use super::theme::SPACE;
use crate::curve::{Curve, CurveSpec, Interpolation};
use eframe::egui::{self, RichText, Ui};

/// The kinds that can be made here; sections come from a scene file.
const KINDS: [(&str, &str); 6] = [
    ("Skin preset", "Slope 100 kPa to strain 0.4, stiffening to 1000 kPa at 0.7"),
    ("Adipose preset", "0.4 kPa · atan(7.5 ε): initial modulus 3 kPa"),
    ("Linear", "Young's modulus"),
    ("Arctangent", "scale · atan(rate · ε)"),
    ("Exponential (Fung)", "scale · (exp(rate · ε) − 1)"),
    ("Measured points", "Marked points joined by lines or a monotone spline"),
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
            let points = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0].map(|e| [e, stress(e)]);
            CurveSpec::Points { points: points.to_vec(), interpolation: Interpolation::Spline }
        }
    }
}

/// Edits a curve in place. What is refused is not taken over, and said below the table.
pub(super) fn show(ui: &mut Ui, spec: &mut CurveSpec) {
    let label =
        ui.label(RichText::new("Stress–strain curve").color(ui.visuals().weak_text_color()));
    let present = kind(spec);
    egui::ComboBox::from_id_salt("curve")
        .width(ui.available_width() - SPACE)
        .selected_text(present.map_or("Sections (from a file)", |k| KINDS[k].0))
        .show_ui(ui, |ui| {
            for (k, (name, tooltip)) in KINDS.iter().enumerate() {
                let choice = ui.selectable_label(present == Some(k), *name);
                if choice.on_hover_text(*tooltip).clicked() && present != Some(k) {
                    *spec = converted(spec, k);
                }
            }
        })
        .response
        .labelled_by(label.id)
        .on_hover_text("Nominal stress against engineering strain, as measured");
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
        range: 0.01..=1e4,
        reset,
        decimals: 2,
        step: 0.0,
        logarithmic: true,
        tooltip: "In vivo: breast fat about 3 kPa, breast skin 56–344 kPa.",
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
        tooltip: "How fast the curve bends with strain.",
        ..Control::default()
    }
    .show(ui, value);
}

fn edit_points(ui: &mut Ui, points: &mut Vec<[f64; 2]>, interpolation: &mut Interpolation) {
    ui.horizontal(|ui| {
        ui.radio_value(interpolation, Interpolation::Line, "Lines");
        ui.radio_value(interpolation, Interpolation::Spline, "Spline");
    });
    let mut remove = None;
    egui::Grid::new("points").num_columns(3).spacing([SPACE, 2.0]).show(ui, |ui| {
        ui.small("Strain");
        ui.small("Stress (kPa)");
        ui.end_row();
        for k in 0..points.len() {
            // A point stays between its neighbours: no state in between is ever refused.
            let low = if k == 0 { [0.0; 2] } else { points[k - 1] };
            let high = points.get(k + 1).copied().unwrap_or([10.0, 1e7]);
            let is_origin = k == 0;
            for axis in 0..2 {
                let gap = 1e-4 * (high[axis] - low[axis]).max(1e-6);
                let range = if is_origin { 0.0..=0.0 } else { low[axis] + gap..=high[axis] - gap };
                let name = format!("{} of point {}", ["Strain", "Stress"][axis], k + 1);
                let field = egui::DragValue::new(&mut points[k][axis])
                    .range(range)
                    .speed([0.005, 0.2][axis])
                    .max_decimals(3);
                let response = ui.add_enabled(!is_origin, field);
                name_it(&response, egui::Role::SpinButton, &name);
            }
            let button = ui.add_enabled(!is_origin && points.len() > 2, egui::Button::new("×"));
            let name = format!("Remove point {}", k + 1);
            name_it(&button, egui::Role::Button, &name);
            if button.clicked() {
                remove = Some(k);
            }
            ui.end_row();
        }
    });
    if let Some(k) = remove {
        points.remove(k);
    }
    if ui.button("Add point").on_hover_text("Goes on as a line from the last two").clicked()
        && let [.., [e0, s0], [e1, s1]] = points[..]
        && e1 < 9.0
    {
        points.push([e1 + 0.1, s1 + 0.1 * (s1 - s0) / (e1 - e0)]);
    }
}

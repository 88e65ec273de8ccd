//! The right side: what a surgeon reads off, with units and where the limits come from.

use super::controls::{group, heading};
use super::theme::{self, SPACE};
use crate::measure::{Outcome, Pressure, Status};
use eframe::egui::{self, RichText, Ui};

/// Shows a result. While the solver works, it is the result of the scene before, and greyed.
pub(super) fn show(ui: &mut Ui, outcome: Option<&Outcome>, is_working: bool) {
    heading(ui, "Results");
    let Some(outcome) = outcome else {
        ui.label(RichText::new("Solving…").color(ui.visuals().weak_text_color()));
        return;
    };
    if outcome.status == Status::Unstable {
        ui.label(
            "These springs have no stable shape in this scene, so there is nothing to read off.",
        );
        return;
    }
    ui.scope(|ui| {
        if is_working {
            ui.set_opacity(0.55);
        }
        shape(ui, outcome);
        contact(ui, outcome);
        tissue(ui, outcome);
    });
}

fn shape(ui: &mut Ui, outcome: &Outcome) {
    group(ui, "Shape", |ui| {
        rows(ui, "shape", |ui| {
            row(ui, "Projection of the implant", outcome.projection_mm, 1, "mm");
            row(ui, "Projection of the skin", outcome.skin_projection_mm, 1, "mm");
            row(ui, "Implant volume", Some(outcome.implant_volume_ml), 0, "ml");
            row(ui, "Area before", Some(outcome.area_before_cm2), 1, "cm²");
            row(ui, "Area after", outcome.area_after_cm2, 1, "cm²");
            row(ui, "Area gained", outcome.area_gain_cm2, 1, "cm²");
            row(ui, "Area ratio", outcome.area_ratio, 3, "×");
        });
        hint(
            ui,
            "This is the geometric gain at once. Of an expander's geometric gain only about 35 % \
             was realised in vivo.",
        );
    });
}

fn contact(ui: &mut Ui, outcome: &Outcome) {
    group(ui, "Contact", |ui| {
        rows(ui, "contact", |ui| {
            let part = |p: Option<Pressure>, f: fn(Pressure) -> f64| p.map(f);
            let (kpa, mmhg) = (outcome.contact_pressure_kpa, outcome.contact_pressure_mmhg);
            row(ui, "Force, vertical", outcome.contact_force_n, 2, "N");
            row(ui, "Pressure, mean", part(kpa, |p| p.mean), 2, "kPa");
            row(ui, "", part(mmhg, |p| p.mean), 1, "mmHg");
            row(ui, "Pressure, greatest", part(kpa, |p| p.max), 2, "kPa");
            row(ui, "", part(mmhg, |p| p.max), 1, "mmHg");
            row(ui, "Contact ends at", outcome.contact_angle_deg, 1, "°");
            row(ui, "… of the tissue at", outcome.contact_material_radius_mm, 1, "mm");
        });
        hint(
            ui,
            "30–60 mmHg was measured right after clinical filling of expanders. One pig study saw \
             blood flow near zero above 80 mmHg, another only a moderate drop at 100 mmHg.",
        );
    });
}

fn tissue(ui: &mut Ui, outcome: &Outcome) {
    let palette = theme::palette(ui.visuals());
    group(ui, "Tissue", |ui| {
        rows(ui, "tissue", |ui| {
            row(ui, "Stretch at the apex", outcome.apex_stretch, 3, "×");
            if let Some(strain) = &outcome.strain {
                row(ui, "Greatest strain", Some(100.0 * strain.max_principal), 1, "%");
                for (limit, color) in
                    [("0.25", palette.caution), ("0.50", palette.bad), ("0.54", palette.bad)]
                {
                    let share = strain.fraction_above.get(limit).copied().unwrap_or(0.0);
                    let percent = limit.parse::<f64>().unwrap_or(0.0) * 100.0;
                    let name = RichText::new(format!("Area strained above {percent:.0} %"));
                    let name = if share > 0.0 { name.color(color) } else { name };
                    row(ui, name, Some(100.0 * share), 1, "%");
                }
            }
            for layer in &outcome.layers {
                let name = format!("Greatest stress, {}", layer.tissue);
                row(ui, name, layer.max_stress_kpa, 1, "kPa");
            }
        });
        hint(
            ui,
            "Strains below 25 % are usual, 25–50 % high; excised back skin failed at 54 ± 17 %.",
        );
    });
}

fn rows(ui: &mut Ui, id: &str, add: impl FnOnce(&mut Ui)) {
    egui::Grid::new(id).num_columns(3).spacing([SPACE, 3.0]).show(ui, add);
}

/// One line: name, value in figures of equal width, unit. What does not apply is a dash.
fn row(ui: &mut Ui, name: impl Into<RichText>, value: Option<f64>, decimals: usize, unit: &str) {
    let name: RichText = name.into();
    ui.add(egui::Label::new(name).wrap_mode(egui::TextWrapMode::Extend));
    let text = value.map_or_else(|| "–".to_owned(), |v| format!("{v:.decimals$}"));
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        ui.set_min_width(56.0);
        ui.monospace(text);
    });
    ui.label(RichText::new(if value.is_some() { unit } else { "" }).weak());
    ui.end_row();
}

fn hint(ui: &mut Ui, text: &str) {
    ui.add(egui::Label::new(RichText::new(text).small().weak()).wrap());
}

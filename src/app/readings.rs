//! The right panel: results with units, and the sources of the limits.

use super::theme::{self, SPACE};
use super::widgets::quantity::without_negative_zero;
use super::widgets::{group, heading};
use crate::measure::bands::{pressure_band, pressure_word, strain_band, strain_word};
use crate::measure::{Outcome, Pressure, STRAIN_BANDS, Status};
use crate::session::Session;
use crate::springs::Springs;
use eframe::egui::{self, Color32, RichText, Ui};

/// Results of the previous scene during a solve: shown during a short one, hidden during a long one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PreviousResults {
    Shown,
    Hidden,
}

/// Shows a result. During a short solve the previous results stay visible. During a long one (`previous`)
/// only a provisional result of the present scene close to its equilibrium is shown.
pub(super) fn show(ui: &mut Ui, session: &Session, previous: PreviousResults) {
    heading(ui, "Results");
    let is_near = session.is_outcome_present() && session.scene().springs == Springs::Coupled;
    let outcome = session.outcome().filter(|_| is_near || previous == PreviousResults::Shown);
    let Some(outcome) = outcome.filter(|_| !session.is_stopped()) else {
        let words = if session.is_stopped() { "Not computed." } else { "Updating…" };
        ui.label(RichText::new(words).color(ui.visuals().weak_text_color()));
        return;
    };
    if outcome.status == Status::Unstable {
        ui.label("This scene has no stable shape, so there are no results.");
        return;
    }
    warnings(ui, session.result());
    cover(ui, outcome);
    shape(ui, outcome);
    contact(ui, outcome);
    tissue(ui, outcome);
}

/// Shows warnings, which apply to all numbers below.
fn warnings(ui: &mut Ui, result: Option<&Outcome>) {
    let palette = theme::palette(ui.visuals());
    let Some(outcome) = result else { return };
    if outcome.status == Status::NotConverged {
        let words = RichText::new("! Not finished: do not use these numbers.").strong();
        ui.add(egui::Label::new(words.color(palette.bad)).wrap());
    }
    for warning in &outcome.warnings {
        let words = RichText::new(format!("! {warning}")).color(palette.caution);
        ui.add(egui::Label::new(words).wrap());
    }
}

/// Colour of a band, counted from the lowest.
fn band_color(ui: &Ui, band: usize) -> Color32 {
    let palette = theme::palette(ui.visuals());
    [palette.text, palette.caution, palette.bad, palette.bad][band.min(3)]
}

/// Shows the word of a band in its colour, in a separate row.
fn band_row(ui: &mut Ui, band: usize, word: &str) {
    let text = RichText::new(word).small().color(band_color(ui, band));
    ui.add(egui::Label::new(text).wrap_mode(egui::TextWrapMode::Extend));
    ui.end_row();
}

fn position_error(outcome: &Outcome) -> f64 {
    outcome.solver.estimated_position_error.unwrap_or(f64::INFINITY)
}

fn shape(ui: &mut Ui, outcome: &Outcome) {
    let error = position_error(outcome);
    group(ui, "Shape", |ui| {
        rows(ui, "shape", |ui| {
            row(ui, error, "Projection of the implant", outcome.projection_mm, 1, "mm");
            row(ui, error, "Projection of the skin", outcome.skin_projection_mm, 1, "mm");
            row(ui, error, "Implant volume", Some(outcome.implant_volume_ml), 0, "ml");
            row(ui, error, "Area before", Some(outcome.area_before_cm2), 1, "cm²");
            row(ui, error, "Area after", outcome.area_after_cm2, 1, "cm²");
            row(ui, error, "Area gained", outcome.area_gain_cm2, 1, "cm²");
            row(ui, error, "Area ratio", outcome.area_ratio, 3, "×");
        });
        hint(
            ui,
            "Geometric gain directly after insertion. With tissue expanders about 35 % of the geometric \
             gain was realised in vivo.",
        );
    });
}

/// What only layered tissue has: cover over the implant, thickness of the layers, pull at the pocket's edge.
fn cover(ui: &mut Ui, outcome: &Outcome) {
    let Some(skin) = outcome.skin_area else { return };
    let error = position_error(outcome);
    group(ui, "Cover", |ui| {
        rows(ui, "cover", |ui| {
            row(ui, error, "Cover over the apex", outcome.cover_mm.map(|c| c.apex), 1, "mm");
            row(ui, error, "Least cover", outcome.cover_mm.map(|c| c.least), 1, "mm");
            for layer in &outcome.layers {
                let name = format!("Thinnest {}", layer.tissue);
                row(ui, error, name, layer.thickness_mm.map(|t| t.least), 1, "mm");
            }
            let drawn = (skin.patch_after_cm2 - skin.patch_before_cm2)
                - (skin.pocket_after_cm2 - skin.pocket_before_cm2);
            row(ui, error, "Skin area gained beyond the pocket", Some(drawn), 1, "cm²");
            let pull = outcome.attachment_traction_kpa.map(|t| t.max);
            row(ui, error, "Pull at the pocket's edge", pull, 2, "kPa");
        });
        hint(
            ui,
            "Skin and the tissue under it deform separately; the skin over the pocket draws on the skin \
             beyond the pocket.",
        );
    });
}

fn contact(ui: &mut Ui, outcome: &Outcome) {
    let error = position_error(outcome);
    group(ui, "Contact", |ui| {
        rows(ui, "contact", |ui| {
            let part = |p: Option<Pressure>, f: fn(Pressure) -> f64| p.map(f);
            let (kpa, mmhg) = (outcome.contact_pressure_kpa, outcome.contact_pressure_mmhg);
            row(ui, error, "Force, vertical", outcome.contact_force_n, 2, "N");
            row(ui, error, "Pressure, mean", part(kpa, |p| p.mean), 2, "kPa");
            row(ui, error, "", part(mmhg, |p| p.mean), 1, "mmHg");
            row(ui, error, "Pressure, greatest", part(kpa, |p| p.max), 2, "kPa");
            row(ui, error, "", part(mmhg, |p| p.max), 1, "mmHg");
            if let Some(most) = mmhg.map(|p| p.max) {
                band_row(ui, pressure_band(most), pressure_word(most));
            }
            row(ui, error, "Contact angle", outcome.contact_angle_deg, 1, "°");
            row(ui, error, "Contact radius, at rest", outcome.contact_material_radius_mm, 1, "mm");
        });
        hint(
            ui,
            "In patients, 30–60 mmHg was measured directly after filling an expander. In one study of \
             pigs blood flow was near zero above 80 mmHg; in another it fell only moderately at 100 mmHg.",
        );
    });
}

fn tissue(ui: &mut Ui, outcome: &Outcome) {
    let error = position_error(outcome);
    let [high, very_high, failure] = STRAIN_BANDS.map(|limit| 100.0 * limit);
    group(ui, "Tissue", |ui| {
        rows(ui, "tissue", |ui| {
            row(ui, error, "Stretch at the apex", outcome.apex_stretch, 3, "×");
            if let Some(strain) = &outcome.strain {
                let greatest = strain.max_principal;
                row(ui, error, "Greatest strain", Some(100.0 * greatest), 1, "%");
                band_row(ui, strain_band(greatest), strain_word(greatest));
                for (k, limit) in STRAIN_BANDS.into_iter().enumerate() {
                    let key = format!("{limit:.2}");
                    let fraction = strain.fraction_above.get(&key).copied().unwrap_or(0.0);
                    let name = RichText::new(format!("Area strained above {:.0} %", 100.0 * limit));
                    let color = band_color(ui, if fraction > 0.0 { k + 1 } else { 0 });
                    row(ui, error, name.color(color), Some(100.0 * fraction), 1, "%");
                }
            }
            for layer in &outcome.layers {
                let name = format!("Greatest stress, {}", layer.tissue);
                row(ui, error, name, layer.max_stress_kpa, 1, "kPa");
            }
        });
        hint(
            ui,
            "These stresses are for biaxial stretch, as over an implant. They are higher than the \
             curve's at the same strain, because the curve is measured under uniaxial stretch.",
        );
        hint(
            ui,
            &format!(
                "Strains below {high:.0} % are usual, {high:.0}–{very_high:.0} % are high. Excised back \
                 skin failed at {failure:.0} ± 17 %.",
            ),
        );
    });
}

fn rows(ui: &mut Ui, id: &str, add: impl FnOnce(&mut Ui)) {
    egui::Grid::new(id).num_columns(3).spacing([SPACE, 3.0]).show(ui, add);
}

/// Shows one row: name, right-aligned value in digits of equal width, unit. A missing value is a dash.
fn row(
    ui: &mut Ui,
    error: f64,
    name: impl Into<RichText>,
    value: Option<f64>,
    decimals: usize,
    unit: &str,
) {
    let name: RichText = name.into();
    ui.add(egui::Label::new(name).wrap_mode(egui::TextWrapMode::Extend));
    let text = value.map_or_else(|| "–".to_owned(), |v| figures(v, decimals, error));
    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
        ui.set_min_width(56.0);
        ui.monospace(text);
    });
    ui.label(RichText::new(if value.is_some() { unit } else { "" }).weak());
    ui.end_row();
}

/// Formats a value with at most the given decimals, and no more digits than its error allows. Strains and
/// forces are derivatives of the shape: their relative error is assumed to be ten times that of
/// positions.
fn figures(value: f64, decimals: usize, position_error: f64) -> String {
    let open = (10.0 * position_error * value.abs()).max(1e-12);
    let known = (-open.log10()).floor().max(0.0) as usize;
    let decimals = decimals.min(known);
    without_negative_zero(format!("{value:.decimals$}"))
}

fn hint(ui: &mut Ui, text: &str) {
    ui.add(egui::Label::new(RichText::new(text).small().weak()).wrap());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_more_digits_than_the_error_allows() {
        assert_eq!(figures(62.57, 1, 1e-6), "62.6");
        assert_eq!(figures(62.57, 1, 1e-3), "63");
        assert_eq!(figures(2.9712, 2, 1e-3), "3.0");
        assert_eq!(figures(2.9712, 2, f64::INFINITY), "3");
        assert_eq!(figures(-1e-17, 1, 1e-6), "0.0");
        assert_eq!(figures(-0.4, 1, 1e-6), "-0.4");
    }
}

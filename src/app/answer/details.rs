//! Details of the answer: all numbers with units.

use super::band_color;
use super::before_after;
use super::measured::Measured;
use super::uncertainty::Findings;
use crate::app::frame::research;
use crate::app::plan::device::Device;
use crate::app::texts::{self, localized, tr};
use crate::app::widgets::quantity::without_negative_zero;
use crate::app::widgets::{group, remark};
use crate::clinical::When;
use crate::measure::{Outcome, STRAIN_BANDS};
use crate::scene::Scene;
use crate::session::Session;
use crate::study::Quantity;
use eframe::egui::{self, RichText, Ui};

/// Bands of the results, if there are any.
type Bands<'a> = Option<&'a Findings>;

/// Shows the measures of her body, if the plan has it, and the numbers of a result, each with its band.
pub(crate) fn show(
    ui: &mut Ui,
    outcome: &Outcome,
    bands: Bands<'_>,
    (session, measured): (&Session, &Measured),
) {
    if let Some(table) = before_after::table(measured, session, before_after::Of::Plan) {
        group(ui, tr(before_after::TITLE), |ui| before_after::show(ui, table, "measures"));
    }
    cover(ui, outcome, bands);
    shape(ui, outcome, bands, session.scene());
    contact(ui, outcome, bands);
    tissue(ui, outcome, bands);
}

/// The error estimate of positions, relative to the base radius.
pub(crate) fn position_error(outcome: &Outcome) -> f64 {
    outcome.solver.estimated_position_error.unwrap_or(f64::INFINITY)
}

fn shape(ui: &mut Ui, outcome: &Outcome, bands: Bands<'_>, scene: &Scene) {
    let error = position_error(outcome);
    group(ui, tr("Shape"), |ui| {
        let device = Device::of(ui.ctx());
        let words = |text: &str| device.words(text);
        rows(ui, |ui| {
            let catalogue = scene.implant.projection_mm;
            row(ui, error, tr("Projection in the catalogue"), Some(catalogue), 1, "mm");
            row(ui, error, tr("Projection in the body"), outcome.projection_mm, 1, "mm");
            if let Some(body) = outcome.implant_in_body {
                let width = 2.0 * body.half_width_mm[0];
                row(ui, error, tr("Width in the body"), Some(width), 1, "mm");
            }
            of(ui, outcome, bands, Quantity::SkinProjectionMm, 1);
            row(ui, error, words(tr("Implant volume")), Some(outcome.implant_volume_ml), 0, "ml");
            row(ui, error, tr("Skin area before"), Some(outcome.area_before_cm2), 1, "cm²");
            row(ui, error, tr("Skin area after"), outcome.area_after_cm2, 1, "cm²");
            of(ui, outcome, bands, Quantity::SkinAreaGainCm2, 1);
            of(ui, outcome, bands, Quantity::SkinAreaGain, 1);
            if outcome.void_ml.is_some() {
                of(ui, outcome, bands, Quantity::VoidMl, 0);
            }
        });
        if scene.when() == Some(When::OnTheTable) {
            remark(
                ui,
                tr(
                    "Right after surgery. With tissue expanders about a third (35 %) of such a gain remained.",
                ),
            );
        }
    });
}

/// What only layered tissue has: cover over the implant, thickness of the layers, pull at the pocket's edge.
fn cover(ui: &mut Ui, outcome: &Outcome, bands: Bands<'_>) {
    let Some(skin) = outcome.skin_area else { return };
    let error = position_error(outcome);
    group(ui, tr("Cover"), |ui| {
        rows(ui, |ui| {
            of(ui, outcome, bands, Quantity::ApexCoverMm, 1);
            of(ui, outcome, bands, Quantity::LeastCoverMm, 1);
            if let Some(thin) = outcome.cover_mm.and_then(|cover| cover.without_muscle) {
                row(ui, error, tr("Least cover without the muscle"), Some(thin.least), 1, "mm");
            }
            for layer in &outcome.layers {
                let name = tr!("Thinnest {tissue}", tissue = texts::tissue(&layer.tissue));
                row(ui, error, name, layer.thickness_mm.map(|t| t.least), 1, "mm");
            }
            let drawn = Some(skin.gained_beyond_cm2());
            row(ui, error, tr("Skin gained beyond the pocket"), drawn, 1, "cm²");
            if research::is_on(ui.ctx()) {
                of(ui, outcome, bands, Quantity::AttachmentTractionKpa, 2);
            }
        });
        remark(
            ui,
            tr(
                "Skin and the tissue under it deform separately; the skin over the pocket draws on the skin \
             beyond the pocket.",
            ),
        );
    });
}

fn contact(ui: &mut Ui, outcome: &Outcome, bands: Bands<'_>) {
    let error = position_error(outcome);
    group(ui, tr("Contact"), |ui| {
        rows(ui, |ui| {
            let is_research = research::is_on(ui.ctx());
            for (quantity, decimals, is_for_research) in [
                (Quantity::ForceN, 2, true),
                (Quantity::MeanPressureKpa, 2, true),
                (Quantity::MeanPressureMmhg, 0, false),
                (Quantity::GreatestPressureKpa, 2, true),
                (Quantity::GreatestPressureMmhg, 0, false),
            ] {
                if is_research || !is_for_research {
                    of(ui, outcome, bands, quantity, decimals);
                }
            }
            if outcome.suction_kpa.is_some() {
                row(ui, error, tr("Suction of the void"), outcome.suction_kpa, 2, "kPa");
            }
            row(ui, error, tr("Contact angle"), outcome.contact_angle_deg, 1, "°");
            row(
                ui,
                error,
                tr("Contact radius, at rest"),
                outcome.contact_material_radius_mm,
                1,
                "mm",
            );
        });
        if let Some(radius) = outcome.contact_material_radius_mm {
            remark(
                ui,
                Device::of(ui.ctx()).words(&tr!("The tissue rests on the implant out to {radius:.1} cm from its centre, measured at rest.", radius = 0.1 * radius)),
            );
        }
    });
}

fn tissue(ui: &mut Ui, outcome: &Outcome, bands: Bands<'_>) {
    let (error, is_research) = (position_error(outcome), research::is_on(ui.ctx()));
    group(ui, tr("Tissue"), |ui| {
        rows(ui, |ui| {
            row(ui, error, tr("Stretch at the apex"), outcome.apex_stretch, 3, "×");
            if let Some(strain) = &outcome.strain {
                of(ui, outcome, bands, Quantity::GreatestStrain, 1);
                if let Some(added) = strain.added {
                    let percent = Some(100.0 * added.max_principal);
                    row(ui, error, tr("Against before the operation"), percent, 1, "%");
                }
                if outcome.skin_reserve_used.is_some() {
                    of(ui, outcome, bands, Quantity::SkinReserveUsed, 0);
                }
                for (k, limit) in STRAIN_BANDS.into_iter().enumerate() {
                    let key = format!("{limit:.2}");
                    let fraction = strain.fraction_above.get(&key).copied().unwrap_or(0.0);
                    let name = RichText::new(tr!(
                        "Area stretched above {limit:.0} %",
                        limit = 100.0 * limit
                    ));
                    let color = band_color(ui, if fraction > 0.0 { k + 1 } else { 0 });
                    row(ui, error, name.color(color), Some(100.0 * fraction), 1, "%");
                    if let Some(quantity) = AREAS.get(k) {
                        band(ui, bands, *quantity);
                    }
                }
            }
            if let Some(wrinkled) = outcome.wrinkled {
                row(ui, error, tr("Skin wrinkled or slack"), Some(100.0 * wrinkled), 1, "%");
            }
            let layers = outcome.layers.iter().enumerate();
            for (k, layer) in layers.filter(|_| is_research) {
                let name = tr!("Greatest stress, {tissue}", tissue = texts::tissue(&layer.tissue));
                row(ui, error, name, layer.max_stress_kpa, 1, "kPa");
                if k == 0 {
                    band(ui, bands, Quantity::SkinStressKpa);
                }
            }
        });
        if is_research {
            remark(
                ui,
                tr(
                    "These stresses are for biaxial stretch, as over a dome. They are higher than the \
             curve's at the same strain, because the curve is measured under uniaxial stretch.",
                ),
            );
        }
    });
}

/// Areas above the limits of [`STRAIN_BANDS`], as far as they have a band.
const AREAS: [Quantity; 2] = [Quantity::AreaOver25, Quantity::AreaOver50];

/// Shows the row of a quantity of studies with its band.
fn of(ui: &mut Ui, outcome: &Outcome, bands: Bands<'_>, quantity: Quantity, decimals: usize) {
    let (factor, unit) = quantity.display();
    let value = quantity.of(outcome).map(|value| factor * value);
    row(ui, position_error(outcome), tr(quantity.title()), value, decimals, unit);
    band(ui, bands, quantity);
}

/// Shows the band of the row above.
fn band(ui: &mut Ui, bands: Bands<'_>, quantity: Quantity) {
    let Some(band) = bands.and_then(|bands| bands.band(quantity)) else { return };
    let quiet = |text: &str| RichText::new(text).small().weak();
    ui.horizontal(|ui| {
        ui.label(quiet(tr(BAND_ROW))).on_hover_text(tr("10th to 90th percentile"));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.allocate_ui_with_layout(
                egui::vec2(UNIT_WIDTH, 0.0),
                egui::Layout::left_to_right(egui::Align::Center),
                |ui| {
                    ui.set_min_width(UNIT_WIDTH);
                    ui.label(quiet(quantity.display().1));
                },
            );
            let (factor, unit) = quantity.display();
            ui.label(quiet(&match unit {
                "mmHg" => texts::pressures([band.p10, band.p90].map(|value| factor * value)),
                _ => localized(band.range()),
            }));
        });
    });
}

/// Name of a row with a band.
const BAND_ROW: &str = "    8 in 10 patients";

fn rows(ui: &mut Ui, add: impl FnOnce(&mut Ui)) {
    ui.scope(|ui| {
        ui.spacing_mut().item_spacing.y = 2.0;
        add(ui);
    });
}

/// Widths of values and units \[points\]; the name has the rest.
const VALUE_WIDTH: f32 = 52.0;
const UNIT_WIDTH: f32 = 46.0;

/// Shows one row: name, right-aligned value in digits of equal width, unit. A missing value is a dash. All rows have
/// the same columns.
fn row(
    ui: &mut Ui,
    error: f64,
    name: impl Into<RichText>,
    value: Option<f64>,
    decimals: usize,
    unit: &str,
) {
    let name: RichText = name.into();
    let text = value.map_or_else(|| "–".to_owned(), |value| in_unit(value, decimals, error, unit));
    ui.horizontal(|ui| {
        let height = ui.spacing().interact_size.y - 6.0;
        let space = 2.0 * ui.spacing().item_spacing.x;
        let name_width = ui.available_width() - VALUE_WIDTH - UNIT_WIDTH - space;
        let left = egui::Layout::left_to_right(egui::Align::Center);
        let right = egui::Layout::right_to_left(egui::Align::Center);
        let mut cell = |width: f32, layout, add: &mut dyn FnMut(&mut Ui)| {
            ui.allocate_ui_with_layout(egui::vec2(width, height), layout, |ui| {
                ui.set_min_width(width);
                add(ui);
            });
        };
        cell(name_width, left, &mut |ui| {
            ui.add(egui::Label::new(name.clone()).truncate());
        });
        cell(VALUE_WIDTH, right, &mut |ui| {
            ui.monospace(&text);
        });
        cell(UNIT_WIDTH, left, &mut |ui| {
            ui.label(RichText::new(if value.is_some() { unit } else { "" }).weak());
        });
    });
}

/// Formats a value with at most the given decimals, and no more digits than its error allows. Strains and
/// forces are derivatives of the shape: their relative error is assumed to be ten times that of
/// positions.
pub(crate) fn figures(value: f64, decimals: usize, position_error: f64) -> String {
    let decimals = known_decimals(value, decimals, position_error);
    localized(without_negative_zero(format!("{value:.decimals$}")))
}

/// [`figures`] of a value with a unit. A pressure of more than the card has is none here, in the width of the column.
fn in_unit(value: f64, decimals: usize, position_error: f64, unit: &str) -> String {
    match unit {
        "mmHg" if value.round() > texts::MOST_PRESSURE => {
            format!("> {:.0}", texts::MOST_PRESSURE)
        }
        _ => figures(value, decimals, position_error),
    }
}

/// Number of decimals of [`figures`].
pub(crate) fn known_decimals(value: f64, decimals: usize, position_error: f64) -> usize {
    let open = (10.0 * position_error * value.abs()).max(1e-12);
    let known = (-open.log10()).floor().max(0.0) as usize;
    decimals.min(known)
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

    #[test]
    fn a_pressure_has_two_digits_and_no_number_above_what_the_card_has() {
        assert_eq!(in_unit(12.34, 0, 1e-6, "mmHg"), "12");
        assert_eq!(in_unit(100.4, 0, 1e-6, "mmHg"), "100");
        assert_eq!(in_unit(216.0, 0, 1e-6, "mmHg"), "> 100");
        assert_eq!(in_unit(216.0, 0, 1e-6, "kPa"), "216");
    }
}

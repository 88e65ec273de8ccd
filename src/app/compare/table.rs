//! The table of the comparison: a column for each pin and one for the current scene.

use crate::app::details::{figures, known_decimals, position_error};
use crate::measure::bands::{pressure_word, strain_word};
use crate::measure::{Outcome, Status};
use crate::scene::Scene;
use crate::session::{Pin, Session};
use eframe::egui::{self, RichText, Ui};

/// A row: a quantity of a scene and its result.
struct Row {
    name: &'static str,
    unit: &'static str,
    decimals: usize,
    value: fn(&Scene, &Outcome) -> Option<f64>,
    /// Word for a value.
    word: Option<fn(f64) -> &'static str>,
}

const ROWS: [Row; 10] = [
    Row::new("Width", "cm", 1, |scene, _| Some(0.2 * scene.implant.base_radius_mm)),
    Row::new("Volume", "ml", 0, |_, outcome| Some(outcome.implant_volume_ml)),
    Row::new("Projection", "mm", 0, |scene, _| Some(scene.implant.projection_mm)),
    Row {
        word: Some(|percent| strain_word(0.01 * percent)),
        ..Row::new("Most stretch", "%", 0, |_, outcome| {
            Some(100.0 * outcome.strain.as_ref()?.max_principal)
        })
    },
    Row::new("Least cover", "mm", 1, |_, outcome| Some(outcome.cover_mm?.least)),
    Row::new("Cover at the top", "mm", 1, |_, outcome| Some(outcome.cover_mm?.apex)),
    Row::new("Mean pressure", "mmHg", 0, |_, outcome| Some(outcome.contact_pressure_mmhg?.mean)),
    Row {
        word: Some(pressure_word),
        ..Row::new("Most pressure", "mmHg", 0, |_, outcome| {
            Some(outcome.contact_pressure_mmhg?.max)
        })
    },
    Row::new("Skin gained", "cm²", 0, |_, outcome| outcome.area_gain_cm2),
    Row::new("Mound height", "mm", 1, |_, outcome| outcome.skin_projection_mm),
];

impl Row {
    const fn new(
        name: &'static str,
        unit: &'static str,
        decimals: usize,
        value: fn(&Scene, &Outcome) -> Option<f64>,
    ) -> Self {
        Self { name, unit, decimals, value, word: None }
    }

    /// The value of a converged result.
    fn of(&self, scene: &Scene, outcome: Option<&Outcome>) -> Option<Entry> {
        let outcome = outcome.filter(|outcome| outcome.status == Status::Converged)?;
        let value = (self.value)(scene, outcome)?;
        Some(Entry { value, error: position_error(outcome), band: None })
    }

    fn text(&self, entry: Option<&Entry>) -> String {
        let figures = |e: &Entry| figures(e.value, self.decimals, e.error);
        entry.map_or_else(|| "–".to_owned(), figures)
    }

    /// Now minus pin, with its sign and the decimals that both values have.
    fn difference(&self, now: Option<&Entry>, pin: Option<&Entry>) -> String {
        let Some((now, pin)) = now.zip(pin) else { return "–".to_owned() };
        let known = |e: &Entry| known_decimals(e.value, self.decimals, e.error);
        let (decimals, difference) = (known(now).min(known(pin)), now.value - pin.value);
        let text = format!("{:.decimals$}", difference.abs());
        let is_zero = text.chars().all(|c| c == '0' || c == '.');
        let sign = if is_zero {
            ""
        } else if difference < 0.0 {
            "−"
        } else {
            "+"
        };
        format!("{sign}{text}")
    }
}

/// A value with its relative position error and, where it is known, the band between 10 % and 90 % of all cases.
struct Entry {
    value: f64,
    error: f64,
    band: Option<[f64; 2]>,
}

/// Shows the table; `has_differences` replaces the pins' values by now minus pin.
pub(super) fn show(ui: &mut Ui, session: &Session, has_differences: bool) {
    let pins = session.pins();
    egui::ScrollArea::horizontal().id_salt("comparison").show(ui, |ui| {
        egui::Grid::new("comparison").num_columns(pins.len() + 2).spacing([10.0, 3.0]).show(
            ui,
            |ui| {
                ui.label("");
                for pin in pins {
                    let letter = pin.letter();
                    let head = if has_differences {
                        format!("now − {letter}")
                    } else {
                        letter.to_string()
                    };
                    header(ui, &head).on_hover_text(name_of(pin));
                }
                header(ui, "now");
                ui.end_row();
                for row in &ROWS {
                    show_row(ui, row, session, has_differences);
                }
            },
        );
    });
}

fn show_row(ui: &mut Ui, row: &Row, session: &Session, has_differences: bool) {
    let name = format!("{}, {}", row.name, row.unit);
    ui.add(egui::Label::new(name).wrap_mode(egui::TextWrapMode::Extend));
    let now = row.of(session.scene(), session.result());
    for pin in session.pins() {
        let entry = row.of(pin.scene(), pin.outcome());
        if has_differences {
            cell(ui, row.difference(now.as_ref(), entry.as_ref()), None, row);
        } else {
            cell(ui, row.text(entry.as_ref()), entry.as_ref(), row);
        }
    }
    cell(ui, row.text(now.as_ref()), now.as_ref(), row);
    ui.end_row();
}

/// A right-aligned value; below it its band, if the band is known.
fn cell(ui: &mut Ui, text: String, entry: Option<&Entry>, row: &Row) {
    ui.with_layout(egui::Layout::top_down(egui::Align::Max), |ui| {
        let response = ui.monospace(text);
        if let Some((entry, word)) = entry.zip(row.word) {
            response.on_hover_text(word(entry.value));
        }
        if let Some(Entry { error, band: Some([low, high]), .. }) = entry {
            let [low, high] = [low, high].map(|value| figures(*value, row.decimals, *error));
            ui.small(format!("{low}–{high}"));
        }
    });
}

fn header(ui: &mut Ui, text: &str) -> egui::Response {
    let layout = egui::Layout::top_down(egui::Align::Max);
    ui.with_layout(layout, |ui| ui.label(RichText::new(text).strong())).inner
}

fn name_of(pin: &Pin) -> String {
    if pin.name().is_empty() { format!("Pin {}", pin.letter()) } else { pin.name().to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_has_a_sign_and_no_more_digits_than_both_values() {
        let row = &ROWS[4];
        let entry = |(value, error)| Entry { value, error, band: None };
        let difference = |now, pin| row.difference(Some(&entry(now)), Some(&entry(pin)));
        assert_eq!(difference((6.9, 1e-6), (7.3, 1e-6)), "−0.4");
        assert_eq!(difference((7.34, 1e-6), (7.3, 1e-6)), "0.0");
        assert_eq!(difference((12.0, 1e-6), (7.3, 1e-6)), "+4.7");
        assert_eq!(difference((12.0, 1e-6), (7.3, 2e-2)), "+5");
        assert_eq!(row.difference(None, Some(&entry((7.3, 1e-6)))), "–");
    }
}

//! The table of the comparison: a column for each pin and one for the current scene.

use crate::app::details::{figures, known_decimals, position_error};
use crate::app::texts::{fixed, tr, word_of};
use crate::measure::{Outcome, Status, bands};
use crate::scene::Scene;
use crate::session::{Pin, Session};
use crate::study::{Quantity, Samples};
use eframe::egui::{self, RichText, Ui};

/// A row: a quantity of a scene and its result.
struct Row {
    name: &'static str,
    unit: &'static str,
    decimals: usize,
    /// The quantity of a study with the same value; none for what is given.
    quantity: Option<Quantity>,
    value: fn(&Scene, &Outcome) -> Option<f64>,
    /// The word of a result, that of the cards.
    word: Option<fn(&Outcome) -> Option<&'static str>>,
}

const ROWS: [Row; 11] = [
    Row::new("Width", "cm", 1, None, |scene, _| Some(0.2 * scene.implant.base_radius_mm)),
    Row::new("Volume", "ml", 0, None, |_, outcome| Some(outcome.implant_volume_ml)),
    Row::new("Projection", "cm", 1, None, |scene, _| Some(0.1 * scene.implant.projection_mm)),
    Row {
        word: Some(|outcome| {
            let strain = outcome.strain.as_ref()?.max_principal;
            Some(tr(bands::stretch(strain, outcome.skin_reserve_used).1))
        }),
        ..Row::new("Most stretch", "%", 0, Some(Quantity::GreatestStrain), |_, outcome| {
            Some(100.0 * outcome.strain.as_ref()?.max_principal)
        })
    },
    Row::new("Reserve used", "%", 0, Some(Quantity::SkinReserveUsed), |_, outcome| {
        Some(100.0 * outcome.skin_reserve_used?)
    }),
    Row {
        word: Some(|outcome| bands::cover(outcome.cover_mm?.least).map(|(_, word)| tr(word))),
        ..Row::new("Least cover", "mm", 1, Some(Quantity::LeastCoverMm), |_, outcome| {
            Some(outcome.cover_mm?.least)
        })
    },
    Row::new("Cover at the top", "mm", 1, Some(Quantity::ApexCoverMm), |_, outcome| {
        Some(outcome.cover_mm?.apex)
    }),
    Row::new("Mean pressure", "mmHg", 0, Some(Quantity::MeanPressureMmhg), |_, outcome| {
        Some(outcome.contact_pressure_mmhg?.mean)
    }),
    Row {
        word: Some(|outcome| {
            let mmhg = outcome.contact_pressure_mmhg?.max;
            Some(word_of(&bands::PRESSURE, bands::pressure_word(mmhg)))
        }),
        ..Row::new(
            "Most pressure",
            "mmHg",
            0,
            Some(Quantity::GreatestPressureMmhg),
            |_, outcome| Some(outcome.contact_pressure_mmhg?.max),
        )
    },
    Row::new("Skin gained", "cm²", 0, Some(Quantity::SkinAreaGainCm2), |_, outcome| {
        outcome.area_gain_cm2
    }),
    Row::new("Mound height", "mm", 1, Some(Quantity::SkinProjectionMm), |_, outcome| {
        outcome.skin_projection_mm
    }),
];

impl Row {
    const fn new(
        name: &'static str,
        unit: &'static str,
        decimals: usize,
        quantity: Option<Quantity>,
        value: fn(&Scene, &Outcome) -> Option<f64>,
    ) -> Self {
        Self { name, unit, decimals, quantity, value, word: None }
    }

    /// The value of a converged result.
    fn of(&self, scene: &Scene, outcome: Option<&Outcome>) -> Option<Entry> {
        let outcome = outcome.filter(|outcome| outcome.status == Status::Converged)?;
        let value = (self.value)(scene, outcome)?;
        let word = self.word.and_then(|word| word(outcome));
        Some(Entry { value, error: position_error(outcome), word })
    }

    /// The band of a sampled scene, or of its differences from another one, in the unit of the row.
    fn band(&self, samples: Option<&Samples>, less: Option<&Samples>) -> Option<[f64; 2]> {
        let (samples, quantity) = (samples?, self.quantity?);
        let [low, _, high] = match less {
            Some(other) => samples.difference(other, quantity)?,
            None => samples.band(quantity)?,
        };
        let factor = quantity.display().0;
        Some([factor * low, factor * high])
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
        let text = signed(difference, decimals);
        if is_zero(&text) || difference < 0.0 { text } else { format!("+{text}") }
    }
}

/// A value with its relative position error and its word.
struct Entry {
    value: f64,
    error: f64,
    word: Option<&'static str>,
}

/// Shows the table, with the bands of the `sampled` scenes; `has_differences` replaces the pins' values by now minus pin.
pub(super) fn show<'a>(
    ui: &mut Ui,
    session: &Session,
    has_differences: bool,
    sampled: &dyn Fn(&Scene) -> Option<&'a Samples>,
) {
    let pins = session.pins();
    egui::ScrollArea::horizontal().id_salt("comparison").show(ui, |ui| {
        egui::Grid::new("comparison")
            .num_columns(pins.len() + 3)
            .min_col_width(0.0)
            .spacing([8.0, 3.0])
            .show(ui, |ui| {
                ui.label("");
                // The present plan first: a narrow panel scrolls to further pins.
                header(ui, tr("now"));
                for pin in pins {
                    let letter = pin.letter();
                    let head = if has_differences {
                        tr!("now − {letter}", letter)
                    } else {
                        letter.to_string()
                    };
                    header(ui, &head).on_hover_text(name_of(pin));
                }
                ui.end_row();
                for row in &ROWS {
                    show_row(ui, row, session, has_differences, sampled);
                }
            });
    });
}

/// The table as texts, heads first, with the words of the cards; a band stands in brackets.
pub(in crate::app) fn rows<'a>(
    session: &Session,
    sampled: &dyn Fn(&Scene) -> Option<&'a Samples>,
) -> Vec<Vec<String>> {
    let columns: Vec<(&Scene, Option<&Outcome>)> = [(session.scene(), session.result())]
        .into_iter()
        .chain(session.pins().iter().map(|pin| (pin.scene(), pin.outcome())))
        .collect();
    let pins = session.pins().iter().map(|pin| {
        let letter = pin.letter().to_string();
        match pin.name() {
            name if name.is_empty() || name == letter => letter,
            name => format!("{letter}: {name}"),
        }
    });
    let head = ["".to_owned(), tr("this plan").to_owned()].into_iter().chain(pins).collect();
    let cell = |row: &Row, (scene, outcome): (&Scene, Option<&Outcome>)| {
        let entry = row.of(scene, outcome);
        let text = row.text(entry.as_ref());
        let word = entry.and_then(|entry| entry.word).map(|word| format!(", {word}"));
        let band = row.band(sampled(scene), None);
        let band = band.map(|band| format!(" ({})", range(band, row.decimals)));
        format!("{text}{}{}", word.unwrap_or_default(), band.unwrap_or_default())
    };
    let row = |row: &Row| {
        let name = format!("{}, {}", tr(row.name), row.unit);
        [name].into_iter().chain(columns.iter().map(|column| cell(row, *column))).collect()
    };
    [head].into_iter().chain(ROWS.iter().map(row)).collect()
}

fn show_row<'a>(
    ui: &mut Ui,
    row: &Row,
    session: &Session,
    has_differences: bool,
    sampled: &dyn Fn(&Scene) -> Option<&'a Samples>,
) {
    let name = format!("{}, {}", tr(row.name), row.unit);
    ui.add(egui::Label::new(RichText::new(name).small()).wrap_mode(egui::TextWrapMode::Extend));
    let now = row.of(session.scene(), session.result());
    let of_now = sampled(session.scene());
    cell(ui, row, row.text(now.as_ref()), now.as_ref(), row.band(of_now, None));
    for pin in session.pins() {
        let (entry, of_pin) = (row.of(pin.scene(), pin.outcome()), sampled(pin.scene()));
        if has_differences {
            let band = of_pin.and_then(|of_pin| row.band(of_now, Some(of_pin)));
            let text = row.difference(now.as_ref(), entry.as_ref());
            cell(ui, row, text, None, band.filter(|_| now.is_some() && entry.is_some()));
        } else {
            let band = row.band(of_pin, None);
            cell(ui, row, row.text(entry.as_ref()), entry.as_ref(), band);
        }
    }
    // Room for the scroll bar.
    ui.label("");
    ui.end_row();
}

/// A right-aligned value; below it its band, if the band is known.
fn cell(ui: &mut Ui, row: &Row, text: String, entry: Option<&Entry>, band: Option<[f64; 2]>) {
    ui.with_layout(egui::Layout::top_down(egui::Align::Max), |ui| {
        let response = ui.monospace(text);
        if let Some(word) = entry.and_then(|entry| entry.word) {
            response.on_hover_text(word);
        }
        if let Some(band) = band {
            let text = RichText::new(range(band, row.decimals)).small();
            ui.add(egui::Label::new(text).extend()).on_hover_text(
                tr("10th to 90th percentile of the sampled patients; of a difference, of the same patients"),
            );
        }
    });
}

/// A band, as "4.5–6.1".
fn range(band: [f64; 2], decimals: usize) -> String {
    let [low, high] = band.map(|value| signed(value, decimals));
    // A minus after the dash of a range would not be read.
    let dash = if high.starts_with('−') { tr(" to ") } else { "–" };
    format!("{low}{dash}{high}")
}

/// A number with a true minus.
fn signed(value: f64, decimals: usize) -> String {
    let text = fixed(value.abs(), decimals);
    let is_zero = is_zero(&text);
    if value < 0.0 && !is_zero { format!("−{text}") } else { text }
}

fn is_zero(number: &str) -> bool {
    !number.contains(|c: char| ('1'..='9').contains(&c))
}

fn header(ui: &mut Ui, text: &str) -> egui::Response {
    let layout = egui::Layout::top_down(egui::Align::Max);
    let label = egui::Label::new(RichText::new(text).strong()).extend();
    ui.with_layout(layout, |ui| ui.add(label)).inner
}

fn name_of(pin: &Pin) -> String {
    if pin.name().is_empty() {
        tr!("Pin {letter}", letter = pin.letter())
    } else {
        pin.name().to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::solve::Progress;

    #[test]
    fn a_difference_has_a_sign_and_no_more_digits_than_both_values() {
        let row = &ROWS[5];
        let entry = |(value, error)| Entry { value, error, word: None };
        let difference = |now, pin| row.difference(Some(&entry(now)), Some(&entry(pin)));
        assert_eq!(difference((6.9, 1e-6), (7.3, 1e-6)), "−0.4");
        assert_eq!(difference((7.34, 1e-6), (7.3, 1e-6)), "0.0");
        assert_eq!(difference((12.0, 1e-6), (7.3, 1e-6)), "+4.7");
        assert_eq!(difference((12.0, 1e-6), (7.3, 2e-2)), "+5");
        assert_eq!(row.difference(None, Some(&entry((7.3, 1e-6)))), "–");
    }

    #[test]
    fn the_texts_have_the_words_of_the_cards_and_the_reserve() {
        let mut scene = Scene::opening();
        (scene.solver.nodes_per_side, scene.solver.tolerance) = (33, 1e-3);
        // Much volume under thin cover.
        scene.implant.projection_mm = 52.0;
        let mut session = Session::new(scene.clone()).unwrap();
        while session.advance(&mut || false) == Progress::Working {}
        let outcome = session.result().unwrap();
        let rows = rows(&session, &|_| None);
        let cell = |name: &str| rows.iter().find(|row| row[0] == name).unwrap()[1].clone();
        let strain = outcome.strain.as_ref().unwrap().max_principal;
        let reserve = outcome.skin_reserve_used.unwrap();
        let (band, word) = bands::stretch(strain, Some(reserve));
        // The reserve decides, not the strain alone.
        assert!(band > 0 && bands::strain_word(strain) == "usual", "{strain} {reserve}");
        assert_eq!(cell("Most stretch, %"), format!("{:.0}, {word}", 100.0 * strain));
        assert_eq!(cell("Reserve used, %"), format!("{:.0}", 100.0 * reserve));
        assert!(cell("Most pressure, mmHg").ends_with(", usual"), "{rows:?}");
    }
}

//! The table of the comparison: a column for each pin and one for the current scene.

use crate::app::answer::columns::{Cell, Columns, Line, cell};
use crate::app::answer::details::{figures, known_decimals, position_error};
use crate::app::answer::differing;
use crate::app::answer::practice::{Against, Practices};
use crate::app::plan::device::Device;
use crate::app::plan::side_in_a_word;
use crate::app::texts::{MOST_PRESSURE, fixed, mmhg, pressures, tr, word_of};
use crate::app::widgets::theme::SPACE_SMALL;
use crate::measure::{Outcome, Status, bands};
use crate::scene::{Field, Scene};
use crate::session::{Pin, Session};
use crate::study::{Parameter, Quantity, Samples};
use eframe::egui::{self, RichText, Ui, vec2};

/// A row: a number of the plan or a quantity of its result.
struct Row {
    name: &'static str,
    unit: &'static str,
    decimals: usize,
    value: Value,
    /// The word of a result, that of the cards.
    word: Option<fn(&Outcome, Against) -> Option<&'static str>>,
    /// What the name means; empty for a plain one.
    about: &'static str,
}

/// The value of a row.
#[derive(Clone, Copy)]
enum Value {
    /// Given, in the unit of the row.
    Plan(fn(&Scene) -> Option<f64>),
    /// A quantity of studies, which may have a band.
    Result(Quantity),
}

const ROWS: [Row; 12] = [
    Row::new("Width", "cm", 1, Value::Plan(|scene| Field::BaseRadius.shown(scene))),
    Row::new("Volume", "ml", 0, Value::Plan(|scene| Parameter::Volume.value(scene))),
    Row::new("Projection", "cm", 1, Value::Plan(|scene| Field::Projection.shown(scene))),
    Row {
        word: Some(|outcome, against| {
            let strain = outcome.strain.as_ref()?.max_principal;
            against.word(strain, outcome.skin_reserve_used)
        }),
        ..Row::new("Most stretch", "%", 0, Value::Result(Quantity::GreatestStrain))
    },
    Row {
        about: "The reserve is the stretch at which this skin gets twice as stiff as at rest.",
        ..Row::new("Skin's reserve used", "%", 0, Value::Result(Quantity::SkinReserveUsed))
    },
    Row {
        word: Some(|outcome, _| bands::cover(outcome.cover_mm?.least).map(|(_, word)| tr(word))),
        ..Row::new("Least cover", "mm", 1, Value::Result(Quantity::LeastCoverMm))
    },
    Row::new("Cover, highest point", "mm", 1, Value::Result(Quantity::ApexCoverMm)),
    Row::new("Mean pressure", "mmHg", 0, Value::Result(Quantity::MeanPressureMmhg)),
    Row {
        word: Some(|outcome, _| {
            let mmhg = outcome.contact_pressure_mmhg?.max;
            Some(word_of(&bands::PRESSURE, bands::pressure_word(mmhg)))
        }),
        ..Row::new(PRESSURE, "mmHg", 0, Value::Result(Quantity::GreatestPressureMmhg))
    },
    Row::new("Skin gained", "cm²", 0, Value::Result(Quantity::SkinAreaGainCm2)),
    Row::new("Mound height", "mm", 1, Value::Result(Quantity::SkinProjectionMm)),
    Row {
        about: "Room that neither implant nor tissue fills, between the implant's rim and the pocket's edge.",
        ..Row::new("Void of the pocket", "ml", 0, Value::Result(Quantity::VoidMl))
    },
];

/// What stands in place of a difference without a number.
const NO_DIFFERENCE: &str = "–";

/// The rows in sight: the size and the figures of the answer.
const FIRST: [&str; 4] = ["Volume", "Most stretch", "Least cover", PRESSURE];
/// The row whose word has the numbers of the sampled patients in a report.
const PRESSURE: &str = "Most pressure";

impl Row {
    const fn new(name: &'static str, unit: &'static str, decimals: usize, value: Value) -> Self {
        Self { name, unit, decimals, value, word: None, about: "" }
    }

    /// The value of a converged result.
    fn of(&self, scene: &Scene, outcome: Option<&Outcome>, practices: &Practices) -> Option<Entry> {
        let outcome = outcome.filter(|outcome| outcome.status == Status::Converged)?;
        let value = match self.value {
            Value::Plan(value) => value(scene)?,
            Value::Result(quantity) => quantity.display().0 * quantity.of(outcome)?,
        };
        let word = self.word.and_then(|word| word(outcome, practices.against(scene)));
        Some(Entry { value, error: position_error(outcome), word })
    }

    /// The band of a sampled scene, or of its differences from another one, in the unit of the row.
    fn band(&self, samples: Option<&Samples>, less: Option<&Samples>) -> Option<[f64; 2]> {
        let (samples, Value::Result(quantity)) = (samples?, self.value) else { return None };
        let [low, _, high] = match less {
            Some(other) => samples.difference(other, quantity)?,
            None => samples.band(quantity)?,
        };
        let factor = quantity.display().0;
        Some([factor * low, factor * high])
    }

    /// The cell of a value with its band.
    fn cell(&self, entry: Option<&Entry>, band: Option<[f64; 2]>) -> Cell {
        Cell {
            text: self.text(entry),
            word: entry.and_then(|entry| entry.word),
            band: band.map(|band| self.range(band)),
        }
    }

    fn is_pressure(&self) -> bool {
        self.unit == "mmHg"
    }

    /// A band of values in words.
    fn range(&self, band: [f64; 2]) -> String {
        if self.is_pressure() { pressures(band) } else { range(band, self.decimals) }
    }

    fn text(&self, entry: Option<&Entry>) -> String {
        let figures = |e: &Entry| match self.is_pressure() {
            true => mmhg(e.value),
            false => figures(e.value, self.decimals, e.error),
        };
        entry.map_or_else(|| "–".to_owned(), figures)
    }

    /// Plan minus pin of the values as they are shown, with its sign and the decimals that both values have; a pressure that is not
    /// shown as a number has none.
    fn difference(&self, own: Option<&Entry>, pin: Option<&Entry>) -> String {
        let is_number = |e: &Entry| !self.is_pressure() || e.value.round() <= MOST_PRESSURE;
        let both = own.zip(pin).filter(|(own, pin)| is_number(own) && is_number(pin));
        let Some((own, pin)) = both else { return NO_DIFFERENCE.to_owned() };
        let known = |e: &Entry| known_decimals(e.value, self.decimals, e.error);
        let decimals = known(own).min(known(pin));
        let shown = |e: &Entry| format!("{:.decimals$}", e.value).parse().unwrap_or(e.value);
        let difference: f64 = shown(own) - shown(pin);
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

/// The rows of the table: a cell for the plan, one for each pin, and behind it the difference, if the table `has_differences`.
fn lines<'a>(
    session: &Session,
    has_differences: bool,
    sampled: &dyn Fn(&Scene) -> Option<&'a Samples>,
    practices: &Practices,
) -> Vec<Line> {
    let line = |row: &Row| {
        let own = row.of(session.scene(), session.result(), practices);
        let of_own = sampled(session.scene());
        let mut cells = vec![row.cell(own.as_ref(), row.band(of_own, None))];
        cells.extend(session.other_side().map(|other| {
            row.cell(row.of(other.scene(), other.outcome(), practices).as_ref(), None)
        }));
        for pin in session.pins() {
            let entry = row.of(pin.scene(), pin.outcome(), practices);
            let of_pin = sampled(pin.scene());
            cells.push(row.cell(entry.as_ref(), row.band(of_pin, None)));
            if has_differences {
                let band = of_pin.and_then(|of_pin| row.band(of_own, Some(of_pin)));
                let text = row.difference(own.as_ref(), entry.as_ref());
                let band = band.filter(|_| text != NO_DIFFERENCE);
                let band = band.map(|band| range(band, row.decimals));
                cells.push(Cell { text, word: None, band });
            }
        }
        let name = format!("{}, {}", tr(row.name), row.unit);
        let about = if row.about.is_empty() { "" } else { tr(row.about) };
        Line { name, about, cells, is_first: FIRST.contains(&row.name) }
    };
    ROWS.iter().map(line).collect()
}

/// The heads of the plan, and of the other side's where each side has one.
fn heads(session: &Session) -> impl Iterator<Item = String> {
    let sides = session.other_side().map(|other| [session.scene(), other.scene()]);
    let plan = sides.is_none().then(|| tr("this plan").to_owned());
    let sides = sides.into_iter().flatten().map(|scene| side_in_a_word(scene).to_owned());
    plan.into_iter().chain(sides)
}

/// What differs beside the numbers, as lines: "Skin: this plan lax; A tight".
fn words(session: &Session, device: Device) -> impl Iterator<Item = String> {
    let pins = session.pins().iter().map(|pin| pin.letter().to_string());
    let heads: Vec<String> = heads(session).chain(pins).collect();
    differing::rows(session, device).into_iter().map(move |(name, values)| {
        let values: Vec<String> =
            heads.iter().zip(values).map(|(head, value)| format!("{head} {value}")).collect();
        format!("{name}: {}", values.join("; "))
    })
}

/// Shows what differs in words, and the table with the bands of the `sampled` scenes: the figures of the answer, the further rows in
/// a fold.
pub(super) fn show<'a>(
    ui: &mut Ui,
    session: &Session,
    has_differences: bool,
    sampled: &dyn Fn(&Scene) -> Option<&'a Samples>,
    practices: &Practices,
) {
    let mut heads: Vec<_> = heads(session).map(|head| (head, String::new())).collect();
    for pin in session.pins() {
        let letter = pin.letter();
        heads.push((letter.to_string(), name_of(pin)));
        if has_differences {
            let tip = tr!("This plan minus {letter}, of the numbers as shown", letter);
            heads.push((format!("− {letter}"), tip));
        }
    }
    for line in words(session, practices.device()) {
        ui.add(egui::Label::new(RichText::new(line).small()).wrap());
    }
    let lines = lines(session, has_differences, sampled, practices);
    let columns = Columns::fitting(ui, &heads, &lines);
    egui::ScrollArea::horizontal().id_salt("comparison").show(ui, |ui| {
        ui.spacing_mut().item_spacing = vec2(columns.space, 3.0);
        columns.row(ui, ["", ""], heads.iter(), |ui, (head, tip)| {
            let head = ui.add(egui::Label::new(RichText::new(head).strong()).extend());
            if !tip.is_empty() {
                head.on_hover_text(tip);
            }
        });
        let (first, further): (Vec<&Line>, Vec<&Line>) = lines.iter().partition(|it| it.is_first);
        for line in first {
            columns.row(ui, [&line.name, line.about], line.cells.iter(), cell);
        }
        let fold = egui::CollapsingHeader::new(tr("More numbers")).id_salt("further rows");
        fold.show_unindented(ui, |ui| {
            for line in further {
                columns.row(ui, [&line.name, line.about], line.cells.iter(), cell);
            }
        });
        // Room for the scroll bar.
        ui.add_space(SPACE_SMALL);
    });
}

/// The table as texts, a row each of the name and of cells: number and word. Heads first, with the words of the cards; a band stands
/// in brackets. `of_pressure`: the words of the plan's sampled patients, in place of the plan's own.
pub(crate) fn rows<'a>(
    session: &Session,
    sampled: &dyn Fn(&Scene) -> Option<&'a Samples>,
    practices: &Practices,
    of_pressure: Option<String>,
) -> Vec<(String, Vec<[String; 2]>)> {
    // A pin of this plan stands in its column.
    let is_equal = |pin: &Pin| pin.scene().is_same_plan(session.scene());
    let own = session.pins().iter().find(|pin| is_equal(pin));
    let own = own.map_or_else(String::new, |pin| format!(" = {}", pin.letter()));
    let pins = session.pins().iter().filter(|pin| !is_equal(pin)).map(|pin| {
        let letter = pin.letter().to_string();
        match pin.name() {
            name if name.is_empty() || name == letter => letter,
            name => format!("{letter}: {name}"),
        }
    });
    let mut plans: Vec<String> = heads(session).collect();
    plans[0].push_str(&own);
    let count = plans.len();
    let head = plans.into_iter().chain(pins);
    let head = (String::new(), head.map(|text| [text, String::new()]).collect());
    let is_printed: Vec<bool> = vec![true; count]
        .into_iter()
        .chain(session.pins().iter().map(|pin| !is_equal(pin)))
        .collect();
    let is_number = |text: &str| text.starts_with(|c: char| c.is_ascii_digit() || "−–".contains(c));
    let cell = |Cell { text, word, band }: Cell| {
        let band = band.map_or_else(String::new, |band| format!(" ({band})"));
        [format!("{text}{band}"), word.unwrap_or_default().to_owned()]
    };
    let row = |line: Line| {
        let cells = line.cells.into_iter().zip(&is_printed).filter(|(_, is_printed)| **is_printed);
        (line.name, cells.map(|(of, _)| cell(of)).collect::<Vec<_>>())
    };
    let device = practices.device();
    // A value that is a word stands with the words.
    let given = differing::rows(session, device).into_iter().map(|(name, values)| {
        let values = values.into_iter().zip(&is_printed).filter(|(_, is_printed)| **is_printed);
        let cells = values.map(|(text, _)| match is_number(&text) {
            true => [text, String::new()],
            false => [String::new(), text],
        });
        (name, cells.collect::<Vec<_>>())
    });
    let given: Vec<_> = given.collect();
    let mut numbers: Vec<_> =
        lines(session, false, sampled, practices).into_iter().map(row).collect();
    let pressure = ROWS.iter().position(|row| row.name == PRESSURE);
    if let Some((_, cells)) = pressure.and_then(|k| numbers.get_mut(k))
        && let Some((own, words)) = cells.first_mut().zip(of_pressure)
    {
        own[1] = words;
    }
    [head].into_iter().chain(given).chain(numbers).collect()
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

fn name_of(pin: &Pin) -> String {
    match (pin.name(), pin.scene().implant_reference.as_str()) {
        ("", "") => tr!("Pin {letter}", letter = pin.letter()),
        ("", name) | (name, _) => name.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::Command;
    use crate::solve::Progress;

    #[test]
    fn a_difference_has_a_sign_and_no_more_digits_than_both_values() {
        let of = |name: &str| ROWS.iter().find(|row| row.name == name).unwrap();
        let row = of("Least cover");
        let entry = |(value, error)| Entry { value, error, word: None };
        let difference = |now, pin| row.difference(Some(&entry(now)), Some(&entry(pin)));
        assert_eq!(difference((6.9, 1e-6), (7.3, 1e-6)), "−0.4");
        assert_eq!(difference((7.34, 1e-6), (7.3, 1e-6)), "0.0");
        // 4.6 − 4.0 as they are shown, not 4.64 − 3.96.
        assert_eq!(difference((4.64, 1e-6), (3.96, 1e-6)), "+0.6");
        assert_eq!(difference((4.56, 1e-6), (4.64, 1e-6)), "0.0");
        assert_eq!(difference((12.0, 1e-6), (7.3, 1e-6)), "+4.7");
        assert_eq!(difference((12.0, 1e-6), (7.3, 2e-2)), "+5");
        assert_eq!(row.difference(None, Some(&entry((7.3, 1e-6)))), "–");
        let pressure = of("Most pressure");
        let [low, high] = [(40.4, 1e-6), (161.0, 1e-6)].map(entry);
        assert_eq!([Some(&low), Some(&high)].map(|e| pressure.text(e)), ["40", "over 100"]);
        assert_eq!(pressure.difference(Some(&high), Some(&low)), "–");
        assert_eq!(pressure.range([60.0, 161.0]), "60 to over 100");
        assert_eq!(pressure.range([120.0, 161.0]), "over 100");
    }

    #[test]
    fn the_texts_have_the_words_of_the_cards_and_the_reserve() {
        let mut scene = Scene::opening();
        (scene.solver.nodes_per_side, scene.solver.tolerance) = (33, 1e-3);
        // Much volume under thin cover.
        scene.implant.projection_mm = 40.0;
        let mut session = Session::new(scene.clone()).unwrap();
        while session.advance(&mut || false) == Progress::Working {}
        let outcome = session.result().unwrap();
        let none = Err(crate::study::NoPractice::Volume);
        let practices = Practices::of_known(scene.clone(), none);
        let rows = rows(&session, &|_| None, &practices, None);
        let cell = |name: &str| {
            let (_, cells) = rows.iter().find(|(of, _)| of == name).unwrap();
            cells[0].clone()
        };
        let strain = outcome.strain.as_ref().unwrap().max_principal;
        let reserve = outcome.skin_reserve_used.unwrap();
        let (band, word) = bands::stretch(strain, Some(reserve));
        // The reserve decides, not the strain alone.
        assert!(band > 0 && bands::strain_word(strain) == "usual", "{strain} {reserve}");
        assert_eq!(cell("Most stretch, %"), [format!("{:.0}", 100.0 * strain), word.to_owned()]);
        assert_eq!(
            cell("Skin's reserve used, %"),
            [format!("{:.0}", 100.0 * reserve), String::new()]
        );
        assert_eq!(cell("Most pressure, mmHg")[1], "usual", "{rows:?}");
        let shares = "usual in 6 of 10 such patients, very high 4".to_owned();
        let rows = super::rows(&session, &|_| None, &practices, Some(shares.clone()));
        let pressure = rows.iter().find(|(name, _)| name == "Most pressure, mmHg");
        assert_eq!(pressure.unwrap().1[0][1], shares);
        // A pin of this plan is its column.
        session.apply(Command::Pin).unwrap();
        let rows = super::rows(&session, &|_| None, &practices, None);
        assert_eq!(rows[0].1, [["this plan = A", ""]]);
        assert!(rows.iter().all(|(_, cells)| cells.len() == 1), "{rows:?}");
    }
}

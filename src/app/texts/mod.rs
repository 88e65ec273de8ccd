//! The texts of the app in English and Spanish.
//!
//! The English text stays in the code and is the key, as with gettext: `tr("Skin stretch")`, with values
//! `tr!("Up to {volume} ml stays usual", volume)`. `table.tsv` has the Spanish text of each English one, a row a text. A text
//! without a row stays English. The modules below the app have English words and sentences; the app translates them where it
//! shows them, sentences with values by [`shown`]. Files, errors of files and the command line are English.
//!
//! No library: those at hand return a new text for every label of every frame, have no precision (`{:.1}`) in a template, and
//! do not translate a finished sentence of another module.
//!
//! `choice` (the user's language, kept for the next start) | `number` (numbers with the decimal sign of the language).

mod choice;
mod number;

pub(super) use number::{fixed, localized};

use crate::measure::bands::{Limits, PRESSURE};
use crate::scene::tissue_in_words;
use std::collections::HashMap;
use std::fmt::{Display, Write as _};
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

/// A language of the texts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Language {
    English,
    Spanish,
}

/// The language of the process; a window has one user.
static IS_SPANISH: AtomicBool = AtomicBool::new(false);

/// A row a text: English, tab, Spanish. `\n` is a line break; lines with # are titles.
const TABLE: &str = include_str!("table.tsv");

/// The language of the texts.
pub(super) fn language() -> Language {
    if IS_SPANISH.load(Ordering::Relaxed) { Language::Spanish } else { Language::English }
}

/// Sets the language of the texts.
pub(super) fn set_language(language: Language) {
    IS_SPANISH.store(language == Language::Spanish, Ordering::Relaxed);
}

/// The rows of the table: English and Spanish.
fn rows() -> impl Iterator<Item = (String, String)> {
    let rows = TABLE.lines().filter_map(|line| line.split_once('\t'));
    rows.map(|(english, spanish)| (english.replace("\\n", "\n"), spanish.replace("\\n", "\n")))
}

/// The table, read once.
struct Table {
    /// Spanish by English.
    texts: HashMap<String, String>,
    /// The rows with places.
    templates: Vec<(String, String)>,
}

fn table() -> &'static Table {
    static READ: OnceLock<Table> = OnceLock::new();
    READ.get_or_init(|| Table {
        texts: rows().collect(),
        templates: rows().filter(|(english, _)| english.contains('{')).collect(),
    })
}

/// The Spanish text of an English one.
fn spanish(english: &str) -> Option<&'static str> {
    table().texts.get(english).map(String::as_str)
}

/// An English text in the present language.
pub(super) fn tr(english: &str) -> &str {
    match language() {
        Language::English => english,
        Language::Spanish => spanish(english).unwrap_or(english),
    }
}

/// The name of a tissue in the present language: surgeons read fat for adipose, the name in files.
pub(super) fn tissue(name: &str) -> &str {
    tr(tissue_in_words(name))
}

/// The name of a tissue in files from a typed one.
pub(super) fn tissue_of_file(typed: &str) -> &str {
    let known = ["skin", "adipose", "muscle"];
    known.into_iter().find(|name| tissue(name) == typed.trim()).unwrap_or(typed)
}

/// Greatest contact pressure that is shown as a number \[mmHg\].
pub(super) const MOST_PRESSURE: f64 = 100.0;

/// A contact pressure \[mmHg\]; above [`MOST_PRESSURE`] no number: the model is a guess there.
pub(super) fn mmhg(value: f64) -> String {
    match value.round() {
        number if number > MOST_PRESSURE => tr!("over {most:.0}", most = MOST_PRESSURE),
        number => format!("{:.0}", number + 0.0),
    }
}

/// A contact pressure with its unit.
pub(super) fn pressure(value: f64) -> String {
    format!("{} mmHg", mmhg(value))
}

/// A range of contact pressures \[mmHg\], as "14–33" or "60 to over 100".
pub(super) fn pressures([low, high]: [f64; 2]) -> String {
    match [low, high].map(|value| value.round() > MOST_PRESSURE) {
        [true, _] => mmhg(low),
        [_, true] => format!("{}{}{}", mmhg(low), tr(" to "), mmhg(high)),
        _ => format!("{}–{}", mmhg(low), mmhg(high)),
    }
}

/// The word of a band of limits in the present language; words of the pressure are feminine in Spanish.
pub(super) fn word_of(limits: &Limits, word: &'static str) -> &'static str {
    if language() == Language::Spanish && limits.quantity == PRESSURE.quantity {
        return spanish(&format!("pressure: {word}")).unwrap_or(tr(word));
    }
    tr(word)
}

/// A text with values in the present language: `tr!("{done} of {all} plans computed.", done, all = plans.len())`. A place may have a
/// sign and a number of decimals, as `{gain:+.1}`. Without values: as the function of the same name.
macro_rules! tr_with_values {
    ($english:literal $(, $name:ident $(= $value:expr)?)* $(,)?) => {
        $crate::app::texts::filled(
            $crate::app::texts::tr($english),
            &[$((stringify!($name), &$crate::app::texts::tr!(@ $name $($value)?) as &dyn std::fmt::Display)),*],
        )
    };
    (@ $name:ident) => { $name };
    (@ $name:ident $value:expr) => { $value };
}
pub(super) use tr_with_values as tr;

/// A template with the values of its places. A value with a number of decimals has the decimal sign of the language.
pub(super) fn filled(template: &str, values: &[(&str, &dyn Display)]) -> String {
    let mut text = String::with_capacity(template.len() + 16);
    for part in parts(template) {
        match part {
            Part::Text(words) => text.push_str(words),
            Part::Place(name, format) => {
                let value = values.iter().find(|(known, _)| *known == name).map(|(_, value)| value);
                let Some(value) = value else { continue };
                let decimals = format.trim_start_matches(['+', '.']).parse::<usize>();
                match (format.starts_with('+'), decimals) {
                    (false, Ok(decimals)) => text += &localized(format!("{value:.decimals$}")),
                    (true, Ok(decimals)) => text += &localized(format!("{value:+.decimals$}")),
                    // Writing to a text does not fail.
                    (true, Err(_)) => drop(write!(text, "{value:+}")),
                    (false, Err(_)) => drop(write!(text, "{value}")),
                }
            }
        }
    }
    text
}

/// A part of a template.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part<'a> {
    Text(&'a str),
    /// A place with its name and its format.
    Place(&'a str, &'a str),
}

/// The parts of a template in their order.
fn parts(template: &str) -> impl Iterator<Item = Part<'_>> {
    template.split_inclusive(['{', '}']).map(|part| match part.strip_suffix('}') {
        Some(place) => {
            let (name, format) = place.split_once(':').unwrap_or((place, ""));
            Part::Place(name, format)
        }
        None => Part::Text(part.strip_suffix('{').unwrap_or(part)),
    })
}

/// A finished English sentence of a module below the app in the present language: the row with the same words, whatever its
/// values, which are translated too. The row with most words counts.
pub(super) fn shown(english: &str) -> String {
    match language() {
        Language::English => english.to_owned(),
        Language::Spanish => sentence(english),
    }
}

/// A finished English sentence in Spanish.
fn sentence(english: &str) -> String {
    if let Some(text) = spanish(english) {
        return text.to_owned();
    }
    let matching = table().templates.iter().filter_map(|(template, spanish)| {
        let words: usize =
            parts(template).map(|p| if let Part::Text(t) = p { t.len() } else { 0 }).sum();
        Some((words, spanish, values_of(template, english)?))
    });
    let Some((_, spanish, values)) = matching.max_by_key(|(words, ..)| *words) else {
        return english.to_owned();
    };
    let value = |name: &str| values.iter().find(|(known, _)| *known == name);
    // The values have their digits already; a base has two numbers, as "12 × 10.8".
    let is_number = |value: &str| value.split(" × ").all(|part| part.parse::<f64>().is_ok());
    let shown = |value: &str| if is_number(value) { localized(value) } else { sentence(value) };
    let part = |part| match part {
        Part::Text(words) => words.to_owned(),
        Part::Place(name, _) => value(name).map(|(_, value)| shown(value)).unwrap_or_default(),
    };
    parts(spanish).map(part).collect()
}

/// The values of the places of a template in a finished text; `None` if the words differ.
fn values_of<'a, 't>(template: &'t str, text: &'a str) -> Option<Vec<(&'t str, &'a str)>> {
    let mut values = Vec::new();
    let mut rest = text;
    let mut open = None;
    for part in parts(template) {
        match part {
            Part::Place(name, _) => open = Some(name),
            Part::Text("") => {}
            Part::Text(words) => {
                let at = if open.is_some() {
                    rest.find(words)?
                } else {
                    rest.starts_with(words).then_some(0)?
                };
                if let Some(name) = open.take() {
                    values.push((name, &rest[..at]));
                }
                rest = &rest[at + words.len()..];
            }
        }
    }
    match open {
        Some(name) => values.push((name, rest)),
        None if !rest.is_empty() => return None,
        None => {}
    }
    Some(values)
}

#[cfg(test)]
mod tests;

//! A field of the plan's form.

use serde::Serialize;

/// A field of the form.
#[derive(Debug, Serialize)]
pub(crate) struct Field {
    pub(super) name: &'static str,
    pub(super) label: &'static str,
    pub(super) unit: &'static str,
    /// The value as the screen shows it; empty: none of the choices, or a text that is not stated.
    pub(super) text: String,
    /// What the field means.
    pub(super) hint: String,
    /// The allowed numbers, or the greatest length of a text, in words; empty for a choice.
    pub(super) range: String,
    #[serde(flatten)]
    pub(super) values: Values,
}

/// The values that a field allows.
#[derive(Debug, Serialize)]
#[serde(untagged)]
pub(super) enum Values {
    Numbers {
        least: f64,
        most: f64,
    },
    /// The choices, which are English as in files, and their words on the screen.
    Words {
        choices: Vec<&'static str>,
        words: Vec<&'static str>,
    },
    /// A text of so many characters and lines at most.
    Text {
        characters: usize,
        lines: usize,
    },
}

//! What is implanted, and its name in the texts of the screen.

use crate::app::texts::{Language, language, tr};
use eframe::egui::{Context, Id};
use serde::{Deserialize, Serialize};

/// What is implanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Device {
    #[default]
    Implant,
    Expander,
}

impl Device {
    /// Notes the device of the plan for the texts of a context.
    pub(crate) fn note(self, ctx: &Context) {
        ctx.data_mut(|data| data.insert_temp(Self::key(), self));
    }

    /// The device of the texts of a context.
    pub(crate) fn of(ctx: &Context) -> Self {
        ctx.data(|data| data.get_temp(Self::key())).unwrap_or_default()
    }

    fn key() -> Id {
        Id::unique("device of the plan")
    }

    /// A text of the program about the implant, with the name of the device. Texts of the user stay as they are: only texts of
    /// the program belong here.
    pub(crate) fn words(self, text: &str) -> String {
        match (self, language()) {
            (Self::Implant, _) => text.to_owned(),
            (Self::Expander, Language::English) => self.english(text),
            (Self::Expander, Language::Spanish) => {
                // The longer word first: its end differs.
                let words = [
                    ("implantes", "expansores"),
                    ("implante", "expansor"),
                    ("Implante", "Expansor"),
                ];
                words.into_iter().fold(text.to_owned(), |text, (from, to)| text.replace(from, to))
            }
        }
    }

    /// An English text, as [`Self::words`], for the name of a file.
    pub(crate) fn english(self, text: &str) -> String {
        match self {
            Self::Implant => text.to_owned(),
            Self::Expander => text.replace("implant", "expander").replace("Implant", "Expander"),
        }
    }

    /// A warning of the result, which may contain the names of layers: only "the implant" is replaced.
    pub(crate) fn warning(self, text: &str) -> String {
        let replaced = |text: String, named: &str| text.replace(named, &self.words(named));
        [tr("The implant"), tr("the implant")].into_iter().fold(text.to_owned(), replaced)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_expander_is_called_an_expander_and_the_users_words_stay() {
        let text = "An implant. Implant volume: implants";
        assert_eq!(Device::Implant.words(text), text);
        assert_eq!(Device::Expander.words(text), "An expander. Expander volume: expanders");
        let warnings = [
            "The implant's base is on the implant.",
            "The curve of implant capsule was extrapolated.",
        ];
        assert_eq!(
            warnings.map(|warning| Device::Expander.warning(warning)),
            ["The expander's base is on the expander.", warnings[1]]
        );
        assert_eq!(warnings.map(|warning| Device::Implant.warning(warning)), warnings);
    }
}

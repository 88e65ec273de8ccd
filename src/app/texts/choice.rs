//! The language of a user: chosen by a button of the toolbar or a command, else that of the system. The platform keeps the choice.

use super::{Language, language, set_language};
use crate::app::App;

/// The choice, and whether the platform is to store it.
#[derive(Debug, Default)]
pub(in crate::app) struct LanguageChoice {
    is_to_store: bool,
}

impl Language {
    /// All languages.
    const ALL: [Self; 2] = [Self::English, Self::Spanish];

    /// The subtag of the language (BCP 47).
    pub(in crate::app) fn subtag(self) -> &'static str {
        match self {
            Self::English => "en",
            Self::Spanish => "es",
        }
    }

    /// The other language.
    pub(in crate::app) fn other(self) -> Self {
        match self {
            Self::English => Self::Spanish,
            Self::Spanish => Self::English,
        }
    }

    /// The language's own name.
    pub(in crate::app) fn name(self) -> &'static str {
        match self {
            Self::English => "English",
            Self::Spanish => "Español",
        }
    }

    /// The language of a locale, as "es-ES" or "es_MX.UTF-8"; `None` for another one.
    fn of(locale: &str) -> Option<Self> {
        let subtag = locale.split(['-', '_', '.']).next()?;
        Self::ALL.into_iter().find(|language| language.subtag().eq_ignore_ascii_case(subtag))
    }
}

impl App {
    /// Sets the language of the texts: the kept choice of [`Self::take_language_to_store`], else that of the system's locale;
    /// English for every other one.
    pub fn restore_language(&mut self, kept: Option<&str>) {
        let system = || sys_locale::get_locale().and_then(|locale| Language::of(&locale));
        set_language(kept.and_then(Language::of).or_else(system).unwrap_or(Language::English));
    }

    /// The chosen language as text for the storage, once after each choice.
    pub fn take_language_to_store(&mut self) -> Option<String> {
        let is_to_store = std::mem::take(&mut self.language.is_to_store);
        is_to_store.then(|| language().subtag().to_owned())
    }

    /// The subtag of the present language, as "es".
    #[must_use]
    pub fn language(&self) -> &'static str {
        language().subtag()
    }

    /// Shows the texts in a language, which the platform keeps.
    pub(in crate::app) fn choose_language(&mut self, choice: Language) {
        if choice != language() {
            set_language(choice);
            self.language.is_to_store = true;
        }
        self.request_frame();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_locale_has_the_language_of_its_first_subtag() {
        for (locale, language) in [
            ("es-ES", Some(Language::Spanish)),
            ("es", Some(Language::Spanish)),
            ("ES_mx.UTF-8", Some(Language::Spanish)),
            ("en-GB", Some(Language::English)),
            ("et-EE", None),
            ("", None),
        ] {
            assert_eq!(Language::of(locale), language, "{locale}");
        }
    }
}

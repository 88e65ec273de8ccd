//! The language of a user: chosen by a button of the toolbar or a command, else that of the system. The platform keeps the choice.

use super::Language;

impl Language {
    /// All languages.
    const ALL: [Self; 2] = [Self::English, Self::Spanish];

    /// The subtag of the language (BCP 47).
    pub(crate) fn subtag(self) -> &'static str {
        match self {
            Self::English => "en",
            Self::Spanish => "es",
        }
    }

    /// The other language.
    pub(crate) fn other(self) -> Self {
        match self {
            Self::English => Self::Spanish,
            Self::Spanish => Self::English,
        }
    }

    /// The language's own name.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::English => "English",
            Self::Spanish => "Español",
        }
    }

    /// The language of a locale, as "es-ES" or "es_MX.UTF-8"; `None` for another one.
    pub(crate) fn of(locale: &str) -> Option<Self> {
        let subtag = locale.split(['-', '_', '.']).next()?;
        Self::ALL.into_iter().find(|language| language.subtag().eq_ignore_ascii_case(subtag))
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

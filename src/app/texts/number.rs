//! Numbers on the screen, in the report and in the summary: the decimal sign is that of the language. Files, links and tables
//! (JSON, CSV) have points; fields read both signs.

use super::{Language, language};

/// A value with a number of decimals, in the present language.
pub(crate) fn fixed(value: f64, decimals: usize) -> String {
    localized(format!("{value:.decimals$}"))
}

/// Finished numbers with a decimal point, as "7.2" or "4.5–6.1", in the present language.
pub(crate) fn localized(numbers: impl Into<String>) -> String {
    in_language(numbers.into(), language())
}

fn in_language(numbers: String, language: Language) -> String {
    match language {
        Language::English => numbers,
        Language::Spanish => numbers.replace('.', ","),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn spanish_has_decimal_commas() {
        for (english, spanish) in [("7.2", "7,2"), ("−0.4–6.15", "−0,4–6,15"), ("300", "300")]
        {
            assert_eq!(in_language(english.to_owned(), Language::Spanish), spanish);
            assert_eq!(in_language(english.to_owned(), Language::English), english);
        }
    }
}

//! Numbers as text: decimal commas, units, exact values.

use crate::app::texts::{localized, tr};
use std::ops::RangeInclusive;

/// Kind of a number, which determines the accepted units.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Length \[mm\].
    Length,
    /// Length \[cm\].
    Centimetres,
    /// Volume \[ml\].
    Volume,
    /// Stress \[kPa\].
    Stress,
    /// Fraction in percent \[%\].
    Percent,
    /// Fraction without unit \[-\]; percent are accepted.
    Fraction,
    /// Angle \[degrees\].
    Angle,
    /// Number without unit.
    #[default]
    Plain,
}

impl Kind {
    /// Description of a unit of this kind in messages.
    fn name(self) -> &'static str {
        match self {
            Self::Length | Self::Centimetres => tr("a unit of length"),
            Self::Volume => tr("a unit of volume"),
            Self::Stress => tr("a unit of stress"),
            Self::Percent | Self::Fraction => tr("a percentage"),
            Self::Angle => tr("a unit of angle"),
            Self::Plain => tr("a unit of this number"),
        }
    }

    /// Accepted units with their factors; the first unit is the default.
    fn units(self) -> &'static [(&'static str, f64)] {
        match self {
            Self::Length => &[
                ("mm", 1.0),
                ("cm", 10.0),
                ("m", 1000.0),
                ("in", 25.4),
                ("inch", 25.4),
                ("\"", 25.4),
            ],
            Self::Centimetres => &[
                ("cm", 1.0),
                ("mm", 0.1),
                ("m", 100.0),
                ("in", 2.54),
                ("inch", 2.54),
                ("\"", 2.54),
            ],
            Self::Volume => &[("ml", 1.0), ("cc", 1.0), ("cm³", 1.0), ("cm3", 1.0), ("l", 1000.0)],
            Self::Stress => {
                &[("kPa", 1.0), ("Pa", 1e-3), ("MPa", 1e3), ("mmHg", 0.133_322), ("N/mm²", 1e3)]
            }
            Self::Percent => &[("%", 1.0)],
            Self::Fraction => &[("", 1.0), ("%", 0.01)],
            Self::Angle => &[("°", 1.0), ("deg", 1.0)],
            Self::Plain => &[("", 1.0)],
        }
    }

    /// The kind of the numbers in a unit of the table of a scene's numbers.
    pub(crate) fn of_unit(unit: &str) -> Self {
        match unit {
            "mm" => Self::Length,
            "cm" => Self::Centimetres,
            "ml" => Self::Volume,
            "kPa" => Self::Stress,
            unit if unit.starts_with('%') => Self::Percent,
            _ => Self::Plain,
        }
    }

    /// Unit of the stored number.
    pub(crate) fn unit(self) -> &'static str {
        self.units()[0].0
    }
}

/// Parses a number with decimal point or comma and an optional unit. Returns the value in the first unit
/// of its kind, with all typed digits.
///
/// # Errors
/// Returns one line with the reason and the accepted units.
pub(crate) fn parse(text: &str, kind: Kind) -> Result<f64, String> {
    let text = text.trim();
    if text.is_empty() {
        return Err(tr("enter a number").to_owned());
    }
    let ends = text.char_indices().map(|(at, _)| at).skip(1).chain([text.len()]);
    let longest = ends.filter_map(|end| Some((end, number(&text[..end])?))).last();
    let Some((end, value)) = longest else {
        return Err(tr!("“{typed}” is not a number", typed = truncated(text)));
    };
    let typed = text[end..].trim();
    let is_meant = |unit: &str| unit.to_lowercase() == typed.to_lowercase();
    let factor = match kind.units().iter().find(|(unit, _)| is_meant(unit)) {
        _ if typed.is_empty() => 1.0,
        Some((_, factor)) => *factor,
        None if typed.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '.' | ',' | '-')) => {
            return Err(tr!("“{typed}” is not a number", typed = truncated(text)));
        }
        None => {
            let known: Vec<&str> = kind.units().iter().map(|(unit, _)| *unit).collect();
            let known = known.join(" ");
            let known = if known.is_empty() { tr("none").to_owned() } else { known };
            return Err(tr!(
                "“{typed}” is not {kind}; allowed: {known}",
                typed = truncated(typed),
                kind = kind.name(),
                known
            ));
        }
    };
    let value = significant(value * factor);
    if value.is_finite() {
        Ok(value)
    } else {
        Err(tr!("“{typed}” is too large", typed = truncated(text)))
    }
}

/// Parses a number like [`parse`] and checks the allowed values.
///
/// # Errors
/// Returns one line: the error of [`parse`], or the reason of the limits, or, without a reason, the limit.
pub(crate) fn parse_within(
    text: &str,
    kind: Kind,
    allowed: &RangeInclusive<f64>,
    limit_reason: &str,
) -> Result<f64, String> {
    let number = parse(text, kind)?;
    if allowed.contains(&number) {
        return Ok(number);
    }
    if !limit_reason.is_empty() {
        return Err(limit_reason.to_owned());
    }
    let unit = kind.unit();
    let end = |value: f64| {
        let text = format(value, 0);
        if unit.is_empty() { text } else { format!("{text} {unit}") }
    };
    let (least, most) = (*allowed.start(), *allowed.end());
    Err(if number < least {
        tr!("at least {least}", least = end(least))
    } else {
        tr!("at most {most}", most = end(most))
    })
}

/// Parses a number with a decimal point or one decimal comma.
fn number(text: &str) -> Option<f64> {
    let text = text.trim().replace('−', "-");
    if !text.starts_with(|c: char| c.is_ascii_digit() || matches!(c, '+' | '-' | '.' | ',')) {
        return None; // "inf" and "nan" are no numbers here.
    }
    let text = match (text.matches(',').count(), text.contains('.')) {
        (0, _) => text,
        (1, false) => text.replace(',', "."),
        _ => return None,
    };
    let digits = text.trim_start_matches(['+', '-']);
    digits.starts_with(|c: char| c.is_ascii_digit() || c == '.').then(|| text.parse().ok())?
}

/// Rounds to twelve significant digits: 4.64 cm are 46.4 mm, not 46.400000000000006.
pub(crate) fn significant(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

fn truncated(text: &str) -> String {
    const MOST: usize = 16;
    let line: String = text.chars().filter(|c| !c.is_control()).collect();
    if line.chars().count() <= MOST {
        return line;
    }
    line.chars().take(MOST).chain(['…']).collect()
}

/// The value after a number of steps, a multiple of the step. A value between two multiples moves to the
/// next multiple first.
pub(super) fn stepped(value: f64, step: f64, steps: f64) -> f64 {
    let whole = if steps > 0.0 { f64::floor } else { f64::ceil };
    (whole(value / step + steps.signum() * 1e-9) + steps) * step
}

/// Formats a value with at least the given decimals and, up to six, all further digits that it has, with the decimal sign of
/// the language.
pub(crate) fn format(value: f64, decimals: usize) -> String {
    localized(digits(value, decimals))
}

/// A value with a decimal point, as [`format`].
fn digits(value: f64, decimals: usize) -> String {
    let is_exact = |text: &str| {
        let read: f64 = text.parse().unwrap_or(f64::NAN);
        (read - value).abs() <= 1e-9 * value.abs()
    };
    let shown = |d: usize| format!("{value:.d$}");
    let text = (decimals..6).map(shown).find(|text| is_exact(text)).unwrap_or_else(|| shown(6));
    without_negative_zero(text)
}

/// Formats a value like [`format`] with at most the given number of decimals.
pub(crate) fn format_at_most(value: f64, decimals: usize, most: usize) -> String {
    let exact = digits(value, decimals);
    let count = exact.split_once('.').map_or(0, |(_, digits)| digits.len());
    let is_short = count <= most;
    localized(if is_short { exact } else { without_negative_zero(format!("{value:.most$}")) })
}

/// Removes the minus sign of a number that is rounded to zero.
pub(crate) fn without_negative_zero(text: String) -> String {
    if text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.')) { text.replace('-', "") } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typed_numbers_are_exact() {
        for (text, kind, value) in [
            ("39.8", Kind::Length, 39.8),
            (" 46,42 ", Kind::Length, 46.42),
            ("4,5", Kind::Length, 4.5),
            ("45 mm", Kind::Length, 45.0),
            ("4.5cm", Kind::Length, 45.0),
            ("4.64 CM", Kind::Length, 46.4),
            ("1 in", Kind::Length, 25.4),
            ("−5", Kind::Length, -5.0),
            ("1e1", Kind::Plain, 10.0),
            ("1e2 mm", Kind::Length, 100.0),
            ("12,5", Kind::Centimetres, 12.5),
            ("125 mm", Kind::Centimetres, 12.5),
            ("5 in", Kind::Centimetres, 12.7),
            ("300 cc", Kind::Volume, 300.0),
            ("0,35 l", Kind::Volume, 350.0),
            ("20 %", Kind::Fraction, 0.2),
            ("0,5", Kind::Fraction, 0.5),
            ("220 kPa", Kind::Stress, 220.0),
            ("0.22 MPa", Kind::Stress, 220.0),
            ("-50°", Kind::Angle, -50.0),
            (".5", Kind::Plain, 0.5),
        ] {
            let read = parse(text, kind).unwrap();
            assert_eq!(read.to_bits(), f64::to_bits(value), "{text}: {read}");
        }
    }

    #[test]
    fn invalid_numbers_are_rejected_in_one_line() {
        for (text, kind, words) in [
            ("", Kind::Length, "enter a number"),
            ("abc", Kind::Length, "“abc” is not a number"),
            ("nan", Kind::Plain, "“nan” is not a number"),
            ("inf", Kind::Plain, "“inf” is not a number"),
            ("-inf", Kind::Plain, "“-inf” is not a number"),
            ("1e999", Kind::Plain, "“1e999” is too large"),
            ("1,234.5", Kind::Length, "“1,234.5” is not a number"),
            ("1 2", Kind::Length, "“1 2” is not a number"),
            ("45 kg", Kind::Length, "“kg” is not a unit of length; allowed: mm cm m in inch \""),
            ("45 mm", Kind::Percent, "“mm” is not a percentage; allowed: %"),
        ] {
            assert_eq!(parse(text, kind).unwrap_err(), words);
        }
        let long = parse(&"x".repeat(1000), Kind::Plain).unwrap_err();
        assert!(long.chars().count() < 60 && !long.contains('\n'));
    }

    #[test]
    fn a_value_is_formatted_with_all_its_digits() {
        assert_eq!(format(46.0, 1), "46.0");
        assert_eq!(format(46.42, 1), "46.42");
        assert_eq!(format(46.400_000_000_000_006, 1), "46.4");
        assert_eq!(format(1.0 / 3.0, 1), "0.333333");
        assert_eq!(format(-0.0, 1), "0.0");
        assert_eq!(format_at_most(3.978_874, 1, 1), "4.0");
        assert_eq!(format_at_most(12.25, 1, 2), "12.25");
        assert_eq!(format_at_most(318.7, 0, 0), "319");
    }
}

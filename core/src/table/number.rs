//! Numbers of cells: a decimal point or comma, and a unit behind the number.

use std::borrow::Cow;
use std::fmt;

/// The decimal sign of a table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Decimals {
    /// A point, as 12.5.
    Point,
    /// A comma, as 12,5.
    Comma,
    /// No cell shows the sign, or cells show both: 12,5 and 12.5 are read, 1,250 and 1.250 are refused.
    #[default]
    Unknown,
}

/// A number of a cell and the unit behind it.
#[derive(Clone, Debug, PartialEq)]
pub struct Quantity<'a> {
    /// The number as it stands in the cell, with a decimal point.
    pub digits: Cow<'a, str>,
    /// The number.
    pub value: f64,
    /// The text behind the number, as `cm`; empty without one.
    pub unit: &'a str,
}

/// A cell that is not one number, in one line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NumberError {
    /// The first characters of the cell.
    cell: String,
    fault: Fault,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Fault {
    NoNumber,
    /// The number without its separators.
    Thousands(String),
    /// The two readings.
    Ambiguous([String; 2]),
}

/// Greatest number of characters of a cell in a message.
const SHOWN: usize = 40;

impl fmt::Display for NumberError {
    fn fmt(&self, text: &mut fmt::Formatter) -> fmt::Result {
        let cell = &self.cell;
        match &self.fault {
            Fault::NoNumber => write!(text, "{cell:?}; allowed: a number, as 12.5"),
            Fault::Thousands(plain) => {
                write!(text, "{cell:?}, with a separator of thousands; allowed: {plain}")
            }
            Fault::Ambiguous([decimal, whole]) => {
                write!(
                    text,
                    "{cell:?}, which is {decimal} or {whole}; allowed: {decimal}0 or {whole}"
                )
            }
        }
    }
}

impl std::error::Error for NumberError {}

/// A cell taken apart.
struct Parts<'a> {
    /// Sign, digits and separators.
    body: &'a str,
    /// With its letter; empty without one.
    exponent: &'a str,
    unit: &'a str,
    reading: Reading,
}

#[derive(Clone, Copy, PartialEq)]
enum Reading {
    Whole,
    /// One decimal sign.
    Decimal(char),
    /// Digits in groups of three behind this separator, and the decimal sign, if one is there.
    Thousands(char, Option<char>),
    /// One point or comma before three digits: a decimal sign or a separator of thousands.
    Either(char),
}

fn is_minus(letter: char) -> bool {
    letter == '-' || letter == '\u{2212}'
}

/// Separators of thousands besides point and comma: spaces, apostrophes.
fn is_spacer(letter: char) -> bool {
    matches!(letter, ' ' | '\u{a0}' | '\u{202f}' | '\u{2009}' | '\'' | '\u{2019}')
}

impl<'a> Parts<'a> {
    fn of(cell: &'a str) -> Option<Self> {
        let cell = cell.trim();
        let unsigned = cell.strip_prefix(|c| is_minus(c) || c == '+').unwrap_or(cell);
        let is_digit = |at: &str| at.starts_with(|c: char| c.is_ascii_digit());
        // A separator belongs to the number before a digit, a decimal sign behind a digit too.
        let mut end = 0;
        for (k, letter) in unsigned.char_indices() {
            let next = &unsigned[k + letter.len_utf8()..];
            let is_sign = letter == '.' || letter == ',';
            let is_last = is_sign && k > 0 && next.is_empty();
            let is_inside = (is_sign || is_spacer(letter) && k > 0) && is_digit(next);
            if !(letter.is_ascii_digit() || is_last || is_inside) {
                break;
            }
            end = k + letter.len_utf8();
        }
        let (number, rest) = unsigned.split_at(end);
        let power = rest
            .strip_prefix(['e', 'E'])
            .filter(|power| is_digit(power.strip_prefix(['+', '-']).unwrap_or(power)));
        let exponent = power.map_or(0, |power| {
            let sign = usize::from(power.starts_with(['+', '-']));
            1 + sign + power[sign..].bytes().take_while(u8::is_ascii_digit).count()
        });
        let (exponent, unit) = rest.split_at(exponent);
        let unit = unit.trim();
        let is_unit =
            |unit: &str| unit.starts_with(|c: char| c.is_alphabetic() || "%°‰\"".contains(c));
        if !(unit.is_empty() || is_unit(unit)) {
            return None;
        }
        let reading = reading(number, !exponent.is_empty())?;
        Some(Self { body: &cell[..cell.len() - rest.len()], exponent, unit, reading })
    }

    /// The digits with a point for the decimal sign; other separators are left out.
    fn digits(&self, sign: Option<char>) -> Cow<'a, str> {
        let is_plain = |c: char| c.is_ascii_digit() || c == '-' || Some(c) == sign && c == '.';
        if self.exponent.is_empty() && self.body.chars().all(is_plain) {
            return Cow::Borrowed(self.body);
        }
        let point = |letter: char| match letter {
            letter if Some(letter) == sign => Some('.'),
            letter if is_minus(letter) => Some('-'),
            letter => letter.is_ascii_digit().then_some(letter),
        };
        self.body.chars().filter_map(point).chain(self.exponent.chars()).collect()
    }
}

/// How the digits and separators of a number can be read.
fn reading(number: &str, has_exponent: bool) -> Option<Reading> {
    let mut separators = number.char_indices().filter(|(_, c)| !c.is_ascii_digit());
    if !number.contains(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let Some((at, first)) = separators.next() else { return Some(Reading::Whole) };
    let last = separators.next_back();
    let whole = &number[..at];
    let is_group = |digits: &str| digits.len() == 3 && digits.bytes().all(|c| c.is_ascii_digit());
    // Groups of three behind one to three digits.
    let is_grouped = |digits: &str| {
        let mut groups = digits.split(first);
        (1..=3).contains(&whole.len()) && groups.next().is_some() && groups.all(is_group)
    };
    let is_sign = first == '.' || first == ',';
    match last {
        None if !is_sign => is_grouped(number).then_some(Reading::Thousands(first, None)),
        None => {
            let may_be_thousands = is_grouped(number) && !whole.starts_with('0') && !has_exponent;
            Some(if may_be_thousands { Reading::Either(first) } else { Reading::Decimal(first) })
        }
        Some((_, last)) if last == first => {
            is_grouped(number).then_some(Reading::Thousands(first, None))
        }
        Some((end, last)) => ((last == '.' || last == ',') && is_grouped(&number[..end]))
            .then_some(Reading::Thousands(first, Some(last))),
    }
}

impl Decimals {
    /// The number of a cell and the unit behind it.
    ///
    /// # Errors
    /// The cell is no number, has separators of thousands, or may have one.
    pub fn read(self, cell: &str) -> Result<Quantity<'_>, NumberError> {
        let shown = || {
            let (cell, mut length) = (cell.trim(), 0);
            // A sign that is not printed has up to ten characters in the message.
            let mut letters = cell.char_indices();
            let cut = letters.find(|(_, letter)| {
                length += letter.escape_debug().len();
                length > SHOWN
            });
            match cut {
                Some((end, _)) => format!("{}…", &cell[..end]),
                None => cell.to_owned(),
            }
        };
        let error = |fault| NumberError { cell: shown(), fault };
        let parts = Parts::of(cell).ok_or_else(|| error(Fault::NoNumber))?;
        let sign = match (parts.reading, self) {
            (Reading::Whole, _) => None,
            (Reading::Decimal(sign), _)
            | (Reading::Either(sign @ '.'), Self::Point)
            | (Reading::Either(sign @ ','), Self::Comma) => Some(sign),
            (Reading::Either(_), Self::Point | Self::Comma) => {
                return Err(error(Fault::Thousands(parts.digits(None).into_owned())));
            }
            (Reading::Thousands(_, sign), _) => {
                return Err(error(Fault::Thousands(parts.digits(sign).into_owned())));
            }
            (Reading::Either(sign), Self::Unknown) => {
                let readings = [Some(sign), None].map(|sign| parts.digits(sign).into_owned());
                return Err(error(Fault::Ambiguous(readings)));
            }
        };
        let digits = parts.digits(sign);
        let value = digits.parse().ok().filter(|value: &f64| value.is_finite());
        let value = value.ok_or_else(|| error(Fault::NoNumber))?;
        Ok(Quantity { digits, value, unit: parts.unit })
    }

    /// The decimal sign that a cell shows; unknown for a cell that does not.
    #[must_use]
    pub fn shown_by(cell: &str) -> Self {
        if !cell.contains(['.', ',']) {
            return Self::Unknown;
        }
        match Parts::of(cell).map(|parts| parts.reading) {
            Some(
                Reading::Decimal('.')
                | Reading::Thousands(_, Some('.'))
                | Reading::Thousands(',', None),
            ) => Self::Point,
            Some(
                Reading::Decimal(_)
                | Reading::Thousands(_, Some(_))
                | Reading::Thousands('.', None),
            ) => Self::Comma,
            _ => Self::Unknown,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_their_value_digits_and_unit() {
        for (cell, digits, value, unit) in [
            ("60,5", "60.5", 60.5, ""),
            (" 60.5 ", "60.5", 60.5, ""),
            ("33", "33", 33.0, ""),
            ("-0,1279", "-0.1279", -0.1279, ""),
            ("\u{2212}3,5", "-3.5", -3.5, ""),
            ("+3", "3", 3.0, ""),
            ("3.3e1", "3.3e1", 33.0, ""),
            ("1,234E-2", "1.234E-2", 0.01234, ""),
            ("0,125", "0.125", 0.125, ""),
            (".5", ".5", 0.5, ""),
            ("5,", "5.", 5.0, ""),
            ("1250,125", "1250.125", 1250.125, ""),
            ("1,2345", "1.2345", 1.2345, ""),
            ("12.0 cm", "12.0", 12.0, "cm"),
            ("300cc", "300", 300.0, "cc"),
            ("300 cm³", "300", 300.0, "cm³"),
            ("11,5\u{a0}cm", "11.5", 11.5, "cm"),
            ("20 %", "20", 20.0, "%"),
            ("12e", "12", 12.0, "e"),
            ("0x10", "0", 0.0, "x10"),
        ] {
            for decimals in [Decimals::Point, Decimals::Comma, Decimals::Unknown] {
                let expected = Quantity { digits: digits.into(), value, unit };
                assert_eq!(decimals.read(cell), Ok(expected), "{cell:?}");
            }
        }
    }

    #[test]
    fn a_separator_of_thousands_never_gives_another_number() {
        for (cell, plain) in [
            ("1.234,5", "1234.5"),
            ("1,234.5", "1234.5"),
            ("1 234,5", "1234.5"),
            ("1\u{202f}234", "1234"),
            ("1'234.5", "1234.5"),
            ("1\u{2019}234", "1234"),
            ("-1,234,567", "-1234567"),
            ("1.234.567,25", "1234567.25"),
        ] {
            for decimals in [Decimals::Point, Decimals::Comma, Decimals::Unknown] {
                let error = decimals.read(cell).unwrap_err().to_string();
                let expected = format!("{cell:?}, with a separator of thousands; allowed: {plain}");
                assert_eq!(error, expected);
            }
        }
        let value = |decimals: Decimals, cell| decimals.read(cell).map(|found| found.value);
        assert_eq!(value(Decimals::Point, "1.250"), Ok(1.25));
        assert_eq!(value(Decimals::Comma, "1,250 cm"), Ok(1.25));
        for (decimals, cell) in [(Decimals::Point, "1,250"), (Decimals::Comma, "1.250")] {
            let error = value(decimals, cell).unwrap_err().to_string();
            assert!(error.ends_with("with a separator of thousands; allowed: 1250"), "{error}");
        }
        for cell in ["1,250", "1.250"] {
            let error = value(Decimals::Unknown, cell).unwrap_err().to_string();
            let expected = "which is 1.250 or 1250; allowed: 1.2500 or 1250";
            assert!(error.ends_with(expected), "{error}");
        }
    }

    #[test]
    fn other_cells_are_no_numbers() {
        for cell in [
            "",
            " ",
            "x",
            "cm 12",
            "NaN",
            "inf",
            "-",
            "--3",
            "1e999",
            "01.02.2024",
            "2024-01-05",
            "12-14",
            "1,2,3",
            "12 30",
            "1..5",
            "1.2345,6",
            "1234 567",
            "12/5",
            ",",
            "1_000",
            "12, cm",
            "٣",
        ] {
            let error = Decimals::Point.read(cell).unwrap_err().to_string();
            assert!(error.ends_with("; allowed: a number, as 12.5"), "{cell}: {error}");
        }
        let error = Decimals::Point.read(&"x".repeat(100)).unwrap_err().to_string();
        assert!(error.chars().count() < 80, "{error}");
    }

    #[test]
    fn a_message_is_short_whatever_the_cell_has() {
        let error = Decimals::Point.read(&"\u{ffff}".repeat(60)).unwrap_err().to_string();
        assert!(error.starts_with(r#""\u{ffff}"#) && error.chars().count() < 100, "{error}");
    }

    #[test]
    fn a_cell_shows_the_sign_that_it_needs() {
        for (cell, sign) in [
            ("60,5 cm", Decimals::Comma),
            ("0,125", Decimals::Comma),
            ("1.234,5", Decimals::Comma),
            ("1.234.567", Decimals::Comma),
            ("1 234,5", Decimals::Comma),
            ("60.5", Decimals::Point),
            ("1,234.5", Decimals::Point),
            ("1,234,567", Decimals::Point),
            ("1,234", Decimals::Unknown),
            ("1.234", Decimals::Unknown),
            ("1234", Decimals::Unknown),
            ("01.02.2024", Decimals::Unknown),
            ("Miller, A.", Decimals::Unknown),
        ] {
            assert_eq!(Decimals::shown_by(cell), sign, "{cell}");
        }
    }
}

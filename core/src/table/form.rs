//! The form of a table: separator of columns and decimal sign, found by its beginning.

use super::{BEGINNING_BYTES, Decimals, RawRow, Rows, cells};
use std::borrow::Cow;
use std::fmt;

/// What separates the columns of a table, and its decimal sign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Form {
    /// Separator of the columns (ASCII); `None` for a table of one column.
    pub separator: Option<u8>,
    /// The decimal sign.
    pub decimals: Decimals,
    /// Does the first line name the separator, as `sep=;`?
    pub has_separator_line: bool,
}

/// The decimal signs that cells of a table show.
#[derive(Clone, Copy, Debug, Default)]
pub struct Shown {
    points: bool,
    commas: bool,
}

impl Shown {
    /// Adds a cell.
    pub fn add(&mut self, cell: &str) {
        match Decimals::shown_by(cell) {
            Decimals::Point => self.points = true,
            Decimals::Comma => self.commas = true,
            Decimals::Unknown => {}
        }
    }
}

/// Most rows that determine the separator.
const MOST_ROWS: usize = 100;
/// In the order of preference.
const SEPARATORS: [u8; 3] = [b'\t', b';', b','];

impl Form {
    /// Columns by commas, decimals by points.
    pub const PLAIN: Self =
        Self { separator: Some(b','), decimals: Decimals::Point, has_separator_line: false };

    /// The form of a table by its beginning, in UTF-8 without a byte order mark. The longer the beginning, the surer the decimal sign.
    #[must_use]
    pub fn of(beginning: &[u8]) -> Self {
        let named = named_separator(beginning);
        let has_separator_line = named.is_some();
        let separator = named.or_else(|| separator(beginning));
        let form = Self { separator, decimals: Decimals::Unknown, has_separator_line };
        form.with_decimals(form.shown_by(beginning))
    }

    /// The decimal signs that the cells of a beginning show.
    #[must_use]
    pub fn shown_by(self, beginning: &[u8]) -> Shown {
        let mut shown = Shown::default();
        self.visit(beginning, |row| {
            cells(&text_of(row), self.separator()).for_each(|cell| shown.add(&cell));
            true
        });
        shown
    }

    /// The form with the decimal sign that the cells of its table show.
    #[must_use]
    pub fn with_decimals(self, shown: Shown) -> Self {
        let decimals = match (shown.points, shown.commas) {
            (true, false) => Decimals::Point,
            (false, true) => Decimals::Comma,
            (false, false) if self.separator == Some(b',') => Decimals::Point,
            _ => Decimals::Unknown,
        };
        Self { decimals, ..self }
    }

    /// The separator of the columns; of a table of one column a byte that no row contains.
    #[must_use]
    pub fn separator(&self) -> u8 {
        self.separator.unwrap_or(b'\n')
    }

    /// Visits the rows of the beginning that have no fault and are not empty, as long as the visit returns `true`.
    fn visit(self, beginning: &[u8], mut visit: impl FnMut(&RawRow) -> bool) {
        let mut rows = Rows::new(beginning, self.separator());
        let (mut row, mut is_first) = (RawRow::default(), self.has_separator_line);
        // Memory is always read.
        while rows.read_row(&mut row).unwrap_or_default() {
            let is_left_out = std::mem::take(&mut is_first)
                || row.fault.is_some()
                || row.is_empty(self.separator());
            if !is_left_out && !visit(&row) {
                break;
            }
        }
    }
}

/// The cells of a table's first row that is not empty.
#[must_use]
pub fn first_row(text: &str) -> Vec<String> {
    let beginning = beginning(text);
    let form = Form::of(beginning);
    let mut found = Vec::new();
    form.visit(beginning, |row| {
        found = cells(&text_of(row), form.separator()).map(Cow::into_owned).collect();
        false
    });
    found
}

/// The beginning of a text that shows the form of its table, without a byte order mark.
pub(super) fn beginning(text: &str) -> &[u8] {
    let bytes = text.trim_start_matches('\u{feff}').as_bytes();
    &bytes[..bytes.len().min(BEGINNING_BYTES)]
}

impl fmt::Display for Form {
    fn fmt(&self, text: &mut fmt::Formatter) -> fmt::Result {
        match self.separator {
            Some(b'\t') => text.write_str("columns by tabs")?,
            Some(separator) => write!(text, "columns by `{}`", char::from(separator))?,
            None => text.write_str("one column")?,
        }
        match self.decimals {
            Decimals::Point => text.write_str(", decimals by point"),
            Decimals::Comma => text.write_str(", decimals by comma"),
            Decimals::Unknown => Ok(()),
        }
    }
}

fn text_of(row: &RawRow) -> Cow<'_, str> {
    String::from_utf8_lossy(&row.bytes)
}

/// The separator that a first line names, as spreadsheets read it: `sep=;`.
fn named_separator(beginning: &[u8]) -> Option<u8> {
    let line = beginning.split(|byte| matches!(byte, b'\n' | b'\r')).next()?;
    let line =
        line.strip_prefix(b"\"").map_or(line, |line| line.strip_suffix(b"\"").unwrap_or(line));
    match line.strip_prefix(b"sep=").or_else(|| line.strip_prefix(b"SEP="))? {
        // A row of cells has separators behind it where the table was saved again.
        [separator, rest @ ..] if rest.iter().all(|byte| byte == separator) => Some(*separator),
        _ => None,
    }
    .filter(|byte| byte.is_ascii_punctuation() && *byte != b'"' || *byte == b'\t')
}

/// The separator that gives the most rows one number of cells.
fn separator(beginning: &[u8]) -> Option<u8> {
    let rows_alike = |separator: u8| {
        let form = Form { separator: Some(separator), ..Form::PLAIN };
        let mut counts = std::collections::BTreeMap::new();
        let mut rows = 0;
        form.visit(beginning, |row| {
            *counts.entry(cells(&text_of(row), separator).count()).or_insert(0) += 1;
            rows += 1;
            rows < MOST_ROWS
        });
        counts.into_iter().filter(|(cells, _)| *cells > 1).map(|(_, rows)| rows).max()
    };
    let mut best = None;
    for separator in SEPARATORS {
        if let Some(rows) = rows_alike(separator)
            && best.is_none_or(|(_, most)| rows > most)
        {
            best = Some((separator, rows));
        }
    }
    best.map(|(separator, _)| separator)
        .filter(|separator| *separator != b',' || !is_one_column_of_commas(beginning))
}

/// Is a table one column of numbers with decimal commas below a name?
fn is_one_column_of_commas(beginning: &[u8]) -> bool {
    let (mut rows, mut is_column) = (0, true);
    Form { separator: None, ..Form::PLAIN }.visit(beginning, |row| {
        let text = text_of(row);
        is_column = if rows == 0 {
            !text.contains(',') && text.contains(char::is_alphabetic)
        } else {
            text.matches(',').count() <= 1 && Decimals::Comma.read(&text).is_ok()
        };
        rows += 1;
        is_column && rows < MOST_ROWS
    });
    is_column
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_form_is_recognised_by_the_beginning() {
        for (text, words) in [
            ("a,b\n60.5,30.2\n", "columns by `,`, decimals by point"),
            ("a,b\n60,30\n", "columns by `,`, decimals by point"),
            ("a,b\n\"60,5\",\"30,2\"\n", "columns by `,`, decimals by comma"),
            ("a;b\r\n60,5;30,2\r\n55;28\r\n", "columns by `;`, decimals by comma"),
            ("a;b\r60.5;30,250\r", "columns by `;`, decimals by point"),
            ("a;b\n60;30\n", "columns by `;`"),
            ("a;b\n60,5;30.2\n", "columns by `;`"),
            ("a;b\n1,250;3\n", "columns by `;`"),
            ("a\tb\n60,5\t30; x, y\n", "columns by tabs, decimals by comma"),
            ("sep=;\r\na;b\n60,5;3,2", "columns by `;`, decimals by comma"),
            ("\"sep=|\"\na|b;c\n6.5|3", "columns by `|`, decimals by point"),
            ("sep=;;;\na;b\n6.5;3", "columns by `;`, decimals by point"),
            ("name,price\n\"A; flat\",\"1;2\"\n", "columns by `,`, decimals by point"),
            ("name,width\nA; flat,12\nB,13", "columns by `,`, decimals by point"),
            ("width, mm;height, mm\n12,5;3,5\n", "columns by `;`, decimals by comma"),
            (
                "Sizes, 2024\nname;width;volume\nA;12,5;300\nB;13,5;320",
                "columns by `;`, decimals by comma",
            ),
            ("a\n60,5\n55\n", "one column, decimals by comma"),
            ("a\n60.5\n", "one column, decimals by point"),
            ("0,0\n1,2\n", "columns by `,`, decimals by point"),
            ("", "one column"),
        ] {
            assert_eq!(Form::of(text.as_bytes()).to_string(), words, "{text:?}");
        }
        assert_eq!(Form::of(b"a,b\n1,2"), Form::PLAIN);
        assert!(Form::of(b"sep=;\na;b").has_separator_line);
        assert!(!Form::of(b"sep=x\na;b").has_separator_line);
    }
}

//! Rows of a table, from bytes that come in pieces.

use std::borrow::Cow;
use std::io::{self, BufRead};

/// Greatest length of a row \[bytes\].
pub const MAX_ROW_BYTES: usize = 10_000_000;

/// A row as it stands in the table, without its end.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RawRow {
    /// The line on which the row begins, from 1. A carriage return, a line feed, or both end a line.
    pub line: usize,
    /// The text; of a row with an unpaired quotation mark the line alone.
    pub bytes: Vec<u8>,
    /// What is wrong with the row.
    pub fault: Option<RowFault>,
}

/// A row that cannot be divided into cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RowFault {
    /// A quoted cell without its end.
    #[error("a quotation mark is not closed; allowed: each mark within a cell twice, as \"\"")]
    Unclosed,
    /// Text between the end of a quoted cell and the next separator.
    #[error("text behind a quoted cell; allowed: each mark within a cell twice, as \"\"")]
    Behind,
    /// The row is longer than [`MAX_ROW_BYTES`].
    #[error("the row is longer than 10 MB; allowed: up to 10 MB")]
    TooLong,
}

impl RawRow {
    /// Is the row blank, or are all its cells empty?
    #[must_use]
    pub fn is_empty(&self, separator: u8) -> bool {
        let is_ignored = |byte: &u8| byte.is_ascii_whitespace() || *byte == separator;
        let is_quoted = |byte: &u8| is_ignored(byte) || *byte == b'"';
        self.fault.is_none()
            && (self.bytes.iter().all(is_ignored)
                || self.bytes.iter().all(is_quoted)
                    && std::str::from_utf8(&self.bytes).is_ok_and(|text| {
                        cells(text, separator).all(|cell| cell.trim().is_empty())
                    }))
    }
}

/// The rows of a table. A carriage return, a line feed, or both end a row, but not within a quoted cell; a quotation mark without its
/// partner ends with its own line.
pub struct Rows<R> {
    input: R,
    separator: u8,
    /// Bytes that are read again, from the index on.
    again: (Vec<u8>, usize),
    /// Number of lines before the next byte.
    lines: usize,
    /// Was the last byte a carriage return, which a line feed may follow?
    is_behind_return: bool,
}

/// Where the last byte stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Place {
    /// At the beginning of a cell, or behind spaces there.
    Start,
    Cell,
    Quoted,
    /// Behind a mark in a quoted cell: the end of the cell, or the first of two marks.
    Mark,
    /// Behind a quoted cell and a space.
    Space,
}

impl Place {
    /// The place behind the next byte, which ends no row.
    fn next(self, byte: u8, separator: u8) -> Result<Self, RowFault> {
        match (self, byte) {
            (Self::Quoted, b'"') => Ok(Self::Mark),
            (Self::Quoted, _) | (Self::Mark | Self::Start, b'"') => Ok(Self::Quoted),
            (_, byte) if byte == separator => Ok(Self::Start),
            (Self::Start, b' ') => Ok(Self::Start),
            (Self::Mark | Self::Space, b' ' | b'\t') => Ok(Self::Space),
            (Self::Mark | Self::Space, _) => Err(RowFault::Behind),
            (Self::Start | Self::Cell, _) => Ok(Self::Cell),
        }
    }
}

impl<R: BufRead> Rows<R> {
    /// The rows of a text in UTF-8 without a byte order mark, with this separator of cells (ASCII).
    pub fn new(input: R, separator: u8) -> Self {
        Self { input, separator, again: (Vec::new(), 0), lines: 0, is_behind_return: false }
    }

    /// The next row, a blank one too; `None` at the end.
    ///
    /// # Errors
    /// Of the reader.
    pub fn next_row(&mut self) -> io::Result<Option<RawRow>> {
        let mut row = RawRow::default();
        Ok(self.read_row(&mut row)?.then_some(row))
    }

    /// Reads the next row into another row's memory; `false` at the end.
    ///
    /// # Errors
    /// Of the reader.
    pub fn read_row(&mut self, row: &mut RawRow) -> io::Result<bool> {
        row.line = self.lines + 1;
        row.bytes.clear();
        let bytes = &mut row.bytes;
        let (mut place, mut fault) = (Place::Start, None);
        // Length and number of the row's first line, where a quoted cell goes on behind it.
        let mut first_line = None;
        // The row ends, or the text (false).
        let is_ended = 'row: loop {
            let (again, at) = &self.again;
            let is_again = *at < again.len();
            let piece = if is_again { &again[*at..] } else { self.input.fill_buf()? };
            if piece.is_empty() {
                break 'row false;
            }
            let mut used = 0;
            let mut is_end = false;
            for byte in piece {
                used += 1;
                let is_pair = std::mem::take(&mut self.is_behind_return) && *byte == b'\n';
                let is_break = matches!(byte, b'\n' | b'\r');
                self.is_behind_return = *byte == b'\r';
                self.lines += usize::from(is_break && !is_pair);
                if is_pair && place != Place::Quoted {
                    continue;
                }
                if is_break && (fault.is_some() || place != Place::Quoted) {
                    is_end = true;
                    break;
                }
                if is_break {
                    first_line.get_or_insert((bytes.len(), self.lines));
                }
                if fault.is_none() {
                    match place.next(*byte, self.separator) {
                        _ if bytes.len() == MAX_ROW_BYTES => fault = Some(RowFault::TooLong),
                        Ok(next) => place = next,
                        Err(found) => fault = Some(found),
                    }
                }
                if bytes.len() < MAX_ROW_BYTES || first_line.is_some() {
                    bytes.push(*byte);
                }
                if fault.is_some() && first_line.is_some() {
                    is_end = true;
                    break;
                }
            }
            if is_again {
                self.again.1 += used;
            } else {
                self.input.consume(used);
            }
            if is_end {
                break 'row true;
            }
        };
        if !is_ended && bytes.is_empty() && fault.is_none() {
            return Ok(false);
        }
        if !is_ended && fault.is_none() && place == Place::Quoted {
            fault = Some(RowFault::Unclosed);
        }
        if let (Some(_), Some((end, lines))) = (fault, first_line) {
            // The quoted cell has no end: the other lines are rows of their own.
            fault = Some(RowFault::Unclosed);
            self.read_again(bytes, end, lines);
        }
        row.fault = fault;
        Ok(true)
    }

    /// Keeps the first line of a row; the others are read once more.
    fn read_again(&mut self, bytes: &mut Vec<u8>, end: usize, lines: usize) {
        let (again, at) = &mut self.again;
        let is_return = bytes[end] == b'\r';
        let skipped = if is_return && bytes.get(end + 1) == Some(&b'\n') { 2 } else { 1 };
        let mut rest = bytes.split_off(end);
        rest.drain(..skipped.min(rest.len()));
        rest.extend_from_slice(&again[*at..]);
        self.is_behind_return = is_return && skipped == 1 && rest.is_empty();
        self.lines = lines;
        self.again = (rest, 0);
    }
}

/// The cells of a row without a fault.
pub fn cells(row: &str, separator: u8) -> impl Iterator<Item = Cow<'_, str>> {
    let mut rest = Some(row);
    std::iter::from_fn(move || {
        let row = rest?;
        let mut place = Place::Start;
        let end = row.bytes().position(|byte| {
            let is_end = byte == separator && place != Place::Quoted;
            place = place.next(byte, separator).unwrap_or(Place::Cell);
            is_end
        });
        let (cell, behind) = match end {
            Some(end) => (&row[..end], Some(&row[end + 1..])),
            None => (row, None),
        };
        rest = behind;
        let quoted = cell
            .trim_start_matches(' ')
            .strip_prefix('"')
            .and_then(|cell| cell.trim_end().strip_suffix('"'));
        Some(match quoted {
            Some(text) if text.contains('"') => Cow::Owned(text.replace("\"\"", "\"")),
            Some(text) => Cow::Borrowed(text),
            None => Cow::Borrowed(cell),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::BufReader;

    /// The cells of all rows with their lines, or the fault; the text comes in pieces of this length.
    fn read(text: &str, piece: usize) -> Vec<(usize, Result<Vec<String>, RowFault>)> {
        let mut rows = Rows::new(BufReader::with_capacity(piece, text.as_bytes()), b';');
        let mut found = Vec::new();
        while let Some(RawRow { line, bytes, fault }) = rows.next_row().unwrap() {
            let text = String::from_utf8(bytes).unwrap();
            let cells = cells(&text, b';').map(Cow::into_owned).collect();
            found.push((line, fault.map_or(Ok(cells), Err)));
        }
        found
    }

    fn in_pieces(text: &str) -> Vec<(usize, Result<Vec<String>, RowFault>)> {
        let found = read(text, 1000);
        for piece in [1, 2, 3, 7] {
            assert_eq!(read(text, piece), found, "{text:?}");
        }
        found
    }

    fn row(line: usize, cells: &[&str]) -> (usize, Result<Vec<String>, RowFault>) {
        (line, Ok(cells.iter().map(|cell| (*cell).to_owned()).collect()))
    }

    #[test]
    fn rows_joined_in_any_way_are_all_read() {
        let ends = ["\n", "\r", "\r\n"];
        let last = ["", "\n", "\r", "\r\n"];
        for (first, second) in ends.into_iter().flat_map(|a| ends.map(|b| (a, b))) {
            for last in last {
                let text = format!("a;1{first}\"b\";2{second}c;3{last}");
                let expected = [row(1, &["a", "1"]), row(2, &["b", "2"]), row(3, &["c", "3"])];
                assert_eq!(in_pieces(&text), expected, "{text:?}");
            }
        }
        assert_eq!(in_pieces(""), []);
        assert_eq!(in_pieces("\r\r\na"), [row(1, &[""]), row(2, &[""]), row(3, &["a"])]);
    }

    #[test]
    fn quoted_cells_have_separators_marks_and_line_breaks() {
        let text = "\"a;\"\"b\"\"\" ; \"c\r\nd\re\";f\" g\n\"\";;\n";
        let expected = [row(1, &["a;\"b\"", "c\r\nd\re", "f\" g"]), row(4, &["", "", ""])];
        assert_eq!(in_pieces(text), expected);
    }

    #[test]
    fn a_mark_without_its_partner_hides_only_its_own_line() {
        let unclosed = |line| (line, Err(RowFault::Unclosed));
        let behind = |line| (line, Err(RowFault::Behind));
        for end in ["\n", "\r", "\r\n"] {
            for (text, expected) in [
                ("a;\"b|c;1|", vec![unclosed(1), row(2, &["c", "1"])]),
                ("\"b|\"c\";1|d", vec![unclosed(1), row(2, &["c", "1"]), row(3, &["d"])]),
                (
                    "x;\"b||c;\"d\"|e",
                    vec![unclosed(1), row(2, &[""]), row(3, &["c", "d"]), row(4, &["e"])],
                ),
                ("\"a\"b;1|c|", vec![behind(1), row(2, &["c"])]),
                ("\"|\"|\"|d", vec![row(1, &["|"]), unclosed(3), row(4, &["d"])]),
                ("\"", vec![unclosed(1)]),
            ] {
                let expected: Vec<_> = expected
                    .into_iter()
                    .map(|(line, cells)| {
                        let joined = |cell: String| cell.replace('|', end);
                        (line, cells.map(|cells| cells.into_iter().map(joined).collect()))
                    })
                    .collect();
                assert_eq!(in_pieces(&text.replace('|', end)), expected, "{text:?} {end:?}");
            }
        }
    }

    #[test]
    fn a_long_row_is_one_fault_and_the_next_one_is_read() {
        let long = "x".repeat(MAX_ROW_BYTES + 3);
        let found = read(&format!("{long}\na;1\n"), 8192);
        assert_eq!(found, [(1, Err(RowFault::TooLong)), row(2, &["a", "1"])]);
        let found = read(&format!("\"a\nb;{long}\nc"), 8192);
        let expected = [(1, Err(RowFault::Unclosed)), (2, Err(RowFault::TooLong)), row(3, &["c"])];
        assert_eq!(found, expected);
    }

    #[test]
    fn rows_without_content_are_empty() {
        let mut rows = Rows::new(&b"\n;;\n\"\"; \n\t\n\"\"\"\"\nx;\n\"\"x\n"[..], b';');
        let mut found = Vec::new();
        while let Some(row) = rows.next_row().unwrap() {
            found.push(row.is_empty(b';'));
        }
        assert_eq!(found, [true, true, true, true, false, false, false]);
    }
}

//! Tables of any length: encoding and form by the beginning, then row for row.

use super::file::{Reader, is_file, open};
use super::utf16::Utf16;
use super::{output, parquet};
use crate::table::{
    BEGINNING_BYTES, Decimals, Encoding, Form, NotText, RawRow, Rows, Shown, cells, decode,
    encoding,
};
use std::io::{self, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// The rows of a table that are not empty.
pub(super) struct TableRows {
    path: PathBuf,
    rows: Rows<BufReader<Reader>>,
    form: Form,
    /// Of the beginning and of the rows so far.
    shown: Shown,
    /// Number of rows that were read, the header among them.
    taken: u64,
    /// Number of blank rows behind the last one with content.
    blank: u64,
    empty_rows: Arc<AtomicU64>,
    /// Are the bytes those of the file?
    pub(super) is_as_stored: bool,
}

impl TableRows {
    /// Opens a table, a Parquet file by its name. Of a pipe only the header is waited for.
    pub(super) fn open(path: &Path) -> Result<Self, super::InputError> {
        if parquet::is_parquet(path) {
            let lines: Reader = Box::new(parquet::Lines::open(path)?);
            return Ok(Self::new(path, lines, Form::PLAIN, Shown::default()));
        }
        let read = Self::read_beginning(path);
        let opened =
            read.map_err(|error| output::input_error(path, format!("cannot be read: {error}")))?;
        opened.map_err(|error| output::input_error(path, format!("the table {error}")))
    }

    fn new(path: &Path, input: Reader, form: Form, shown: Shown) -> Self {
        Self {
            path: path.to_owned(),
            rows: Rows::new(BufReader::new(input), form.separator()),
            form,
            shown,
            taken: 0,
            blank: 0,
            empty_rows: Arc::default(),
            is_as_stored: false,
        }
    }

    fn read_beginning(path: &Path) -> io::Result<Result<Self, NotText>> {
        let mut input = open(path)?;
        let mut start = Vec::new();
        while start.len() < 4 && read_piece(&mut input, &mut start)? {}
        let found = match encoding(&start) {
            Ok(found) => found,
            Err(error) => return Ok(Err(error)),
        };
        let mark = match found {
            Encoding::Utf8 if !start.starts_with(b"\xef\xbb\xbf") => 0,
            Encoding::Utf8 => 3,
            Encoding::Utf16Le | Encoding::Utf16Be => 2,
        };
        let stored = Cursor::new(start.split_off(mark)).chain(input);
        let mut input: Reader = match found {
            Encoding::Utf8 => Box::new(stored),
            Encoding::Utf16Le => Box::new(Utf16::new(stored, u16::from_le_bytes)),
            Encoding::Utf16Be => Box::new(Utf16::new(stored, u16::from_be_bytes)),
        };
        let mut beginning = Vec::new();
        let is_enough = |beginning: &[u8]| {
            beginning.len() >= BEGINNING_BYTES || !is_file(path) && header_end(beginning).is_some()
        };
        while !is_enough(&beginning) && read_piece(&mut input, &mut beginning)? {}
        // Of a pipe the rows that came with the header are left out: what is recognised does not depend on when they come.
        let end = header_end(&beginning).filter(|_| !is_file(path)).unwrap_or(beginning.len());
        if let Some(error) = unreadable(&beginning[..end], found) {
            return Ok(Err(error));
        }
        let form = Form::of(&beginning[..end]);
        let shown = form.shown_by(&beginning[..end]);
        let input = Box::new(Cursor::new(beginning).chain(input));
        let is_as_stored = found == Encoding::Utf8;
        Ok(Ok(Self { is_as_stored, ..Self::new(path, input, form, shown) }))
    }

    pub(super) fn separator(&self) -> u8 {
        self.form.separator()
    }

    /// The decimal sign that the rows so far show.
    pub(super) fn decimals(&self) -> Decimals {
        self.form.with_decimals(self.shown).decimals
    }

    /// Number of blank rows and rows of empty cells so far; blank lines at the end are not counted.
    pub(super) fn empty_rows(&self) -> Arc<AtomicU64> {
        Arc::clone(&self.empty_rows)
    }

    /// The next row that is not empty.
    pub(super) fn next_row(&mut self) -> io::Result<Option<RawRow>> {
        let separator = self.separator();
        loop {
            let Some(row) = self.rows.next_row()? else { return Ok(None) };
            if self.taken == 0 && row.line == 1 && self.form.has_separator_line {
                continue;
            }
            if row.is_empty(separator) {
                self.blank += 1;
                if row.bytes.contains(&separator) {
                    self.count_blank();
                }
                continue;
            }
            self.count_blank();
            if row.fault.is_none() {
                let text = String::from_utf8_lossy(&row.bytes);
                cells(&text, separator).for_each(|cell| self.shown.add(&cell));
            }
            self.taken += 1;
            if self.taken == 2 {
                self.say_form();
            }
            return Ok(Some(row));
        }
    }

    fn count_blank(&mut self) {
        self.empty_rows.fetch_add(std::mem::take(&mut self.blank), Ordering::Relaxed);
    }

    /// Says the form before the first solve, where it is not the plain one.
    fn say_form(&self) {
        let form = self.form.with_decimals(self.shown);
        let is_plain = form.separator.is_none_or(|separator| separator == b',');
        if !is_plain || form.decimals == Decimals::Comma {
            output::warn(&output::input_error(&self.path, form).to_string());
        }
    }
}

/// Reads a piece behind the others; `false` at the end.
fn read_piece(input: &mut impl Read, to: &mut Vec<u8>) -> io::Result<bool> {
    let from = to.len();
    to.resize(from + 8192, 0);
    let read = input.read(&mut to[from..]);
    to.truncate(from + *read.as_ref().unwrap_or(&0));
    match read {
        Err(error) if error.kind() == io::ErrorKind::Interrupted => Ok(true),
        read => Ok(read? > 0),
    }
}

/// The end of the first row that is not blank, behind a line that names the separator.
fn header_end(beginning: &[u8]) -> Option<usize> {
    let (mut start, mut is_quoted) = (0, false);
    for (k, byte) in beginning.iter().enumerate() {
        is_quoted ^= *byte == b'"';
        if matches!(byte, b'\n' | b'\r') && !is_quoted {
            let line = beginning[start..k].trim_ascii();
            let text = line.strip_prefix(b"\"").unwrap_or(line);
            if !line.is_empty() && !text.starts_with(b"sep=") {
                return Some(k + 1);
            }
            start = k + 1;
        }
    }
    None
}

/// The first letter of a beginning that cannot be read; its end may cut a letter.
fn unreadable(beginning: &[u8], encoding: Encoding) -> Option<NotText> {
    std::str::from_utf8(beginning).err()?.error_len()?;
    decode(beginning).err().map(|error| match error {
        NotText::NotUtf8 { line } if encoding != Encoding::Utf8 => NotText::NotUtf16 { line },
        error => error,
    })
}

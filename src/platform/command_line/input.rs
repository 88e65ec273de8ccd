//! Scenes as they come in: one a file, one per line, one behind the other, or a row each.

use super::InputError;
use super::file::{Reader, cannot_be_read, is_file, open};
use super::output::input_error;
use super::rows::TableRows;
use crate::scene::values::{Values, has_several};
use crate::scene::{MAX_SCENE_BYTES, read};
use crate::table::{Decimals, RawRow};
use std::collections::VecDeque;
use std::fs::{File, metadata};
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A file of scenes.
pub(super) struct Source {
    path: PathBuf,
    kind: Kind,
    /// Has a file of one scene per line no line that is not blank?
    pub(super) is_empty: bool,
    /// What was opened and is read on: it cannot be opened again, as standard input, or its beginning was taken.
    opened: Option<Opened>,
    /// Number of lines or scenes that were taken; 1 after a whole text.
    taken: usize,
    /// Length of the text, of a file of text \[bytes\].
    length: Option<u64>,
}

/// How scenes stand in a source.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// The whole text is one scene.
    One,
    /// One scene behind the other, each over any number of lines.
    Values,
    Lines,
    Rows,
}

enum Opened {
    Bytes(BufReader<Reader>),
    Values(Values<BufReader<Reader>>),
    Rows(Box<TableRows>),
}

/// Greatest length of what is read of a line or a scene \[bytes\]: one more than the parser accepts.
const MOST_BYTES: u64 = MAX_SCENE_BYTES as u64 + 1;

impl Source {
    /// Opens a file; `is_lines` for one scene per line, `None` to find out by the beginning.
    pub(super) fn open(path: &Path, is_lines: Option<bool>) -> Result<Self, InputError> {
        let begin = || {
            let mut reader = BufReader::new(open(path)?);
            let (mut start, mut lines) = (Vec::new(), Vec::new());
            // Without a need for two lines the first one is not waited for.
            let wanted = if is_lines == Some(true) && !is_file(path) { 0 } else { 2 };
            while lines.len() < wanted && start.len() as u64 <= 2 * MOST_BYTES {
                let from = start.len();
                if reader.by_ref().take(MOST_BYTES).read_until(b'\n', &mut start)? == 0 {
                    break;
                }
                if !start[from..].trim_ascii().is_empty() {
                    lines.push(from..start.len());
                }
            }
            if let Err(error) = read::is_json_text(&start) {
                return Ok(Err(input_error(path, error)));
            }
            let text =
                |k: usize| lines.get(k).and_then(|line| read::utf8(&start[line.clone()]).ok());
            let found = text(0).zip(text(1)).is_some_and(|(a, b)| read::begin_lines(a, b));
            let is_empty = wanted > 0 && lines.is_empty();
            let kind = if is_lines.unwrap_or(found) {
                Kind::Lines
            } else {
                reader.by_ref().take(MOST_BYTES).read_to_end(&mut start)?;
                if has_several(&start)? { Kind::Values } else { Kind::One }
            };
            let all: Reader = Box::new(Cursor::new(start).chain(reader));
            let opened = (!is_file(path)).then(|| Opened::of(all, kind));
            let length = if is_file(path) { Some(metadata(path)?.len()) } else { None };
            Ok(Ok(Self { path: path.to_owned(), kind, is_empty, opened, taken: 0, length }))
        };
        begin().map_err(|error| cannot_be_read(path, &error))?
    }

    /// Opens a table, CSV or a Parquet file.
    pub(super) fn of_table(path: &Path) -> Result<Self, InputError> {
        let rows = TableRows::open(path)?;
        let length = metadata(path).ok().filter(|_| rows.is_as_stored && is_file(path));
        let length = length.map(|found| found.len());
        let opened = Some(Opened::Rows(Box::new(rows)));
        let path = path.to_owned();
        Ok(Self { path, kind: Kind::Rows, is_empty: false, opened, taken: 0, length })
    }

    /// Is the whole text one scene?
    pub(super) fn is_one(&self) -> bool {
        self.kind == Kind::One
    }

    /// One scene per line?
    pub(super) fn is_lines(&self) -> bool {
        self.kind == Kind::Lines
    }

    /// The whole text, of a file of one scene.
    pub(super) fn whole(&mut self) -> Result<Vec<u8>, InputError> {
        self.read_whole().map_err(|error| cannot_be_read(&self.path, &error))
    }

    fn read_whole(&mut self) -> io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        match self.opened.take() {
            Some(Opened::Bytes(reader)) => reader.take(MOST_BYTES).read_to_end(&mut bytes)?,
            _ => File::open(&self.path)?.take(MOST_BYTES).read_to_end(&mut bytes)?,
        };
        Ok(bytes)
    }

    /// The first row of a table that is not empty, and the separator of its cells.
    pub(super) fn header(&mut self) -> Result<(Option<RawRow>, u8), InputError> {
        let Some(Opened::Rows(rows)) = &mut self.opened else { return Ok((None, b',')) };
        let header = rows.next_row().map_err(|error| cannot_be_read(&self.path, &error))?;
        Ok((header, rows.separator()))
    }

    /// Number of empty rows of a table that were left out so far.
    pub(super) fn empty_rows(&self) -> Option<Arc<AtomicU64>> {
        let Some(Opened::Rows(rows)) = &self.opened else { return None };
        Some(rows.empty_rows())
    }

    /// The next text with its line; `None` at the end.
    fn next_text(&mut self) -> io::Result<Option<(usize, Content)>> {
        if self.kind == Kind::One {
            if self.taken > 0 {
                return Ok(None);
            }
            let text = self.read_whole()?;
            self.taken = 1;
            return Ok(Some((1, Content::Json(text))));
        }
        if self.opened.is_none() {
            self.opened = Some(Opened::of(open(&self.path)?, self.kind));
        }
        let (taken, opened) = (&mut self.taken, &mut self.opened);
        match opened {
            Some(Opened::Bytes(reader)) => {
                let line = next_line(reader, taken)?;
                Ok(line.map(|bytes| (*taken, Content::Json(bytes))))
            }
            Some(Opened::Values(values)) => {
                let value = values.next_value()?;
                Ok(value.map(|(line, bytes)| {
                    *taken = line;
                    (line, Content::Json(bytes))
                }))
            }
            Some(Opened::Rows(rows)) => {
                let row = rows.next_row()?;
                Ok(row.map(|row| {
                    *taken = row.line;
                    (row.line, Content::Row(row, rows.decimals()))
                }))
            }
            None => Ok(None),
        }
    }

    /// Can the source be read again?
    pub(super) fn is_file(&self) -> bool {
        is_file(&self.path)
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }
}

impl Opened {
    fn of(reader: Reader, kind: Kind) -> Self {
        let reader = BufReader::new(reader);
        match kind {
            Kind::Values => {
                Self::Values(Values::new(reader, usize::try_from(MOST_BYTES).unwrap_or(usize::MAX)))
            }
            _ => Self::Bytes(reader),
        }
    }
}

/// Takes the next line that is not blank, and counts the lines.
fn next_line(reader: &mut BufReader<Reader>, taken: &mut usize) -> io::Result<Option<Vec<u8>>> {
    loop {
        let mut bytes = Vec::new();
        if reader.by_ref().take(MOST_BYTES).read_until(b'\n', &mut bytes)? == 0 {
            return Ok(None);
        }
        if *taken == 0
            && let Err(error) = read::is_json_text(&bytes)
        {
            return Err(io::Error::other(format!("the input {error}")));
        }
        *taken += 1;
        if bytes.len() as u64 == MOST_BYTES && !bytes.ends_with(b"\n") {
            reader.skip_until(b'\n')?;
        }
        if !bytes.trim_ascii().is_empty() {
            return Ok(Some(bytes));
        }
    }
}

/// What is read of a scene.
pub(super) enum Content {
    /// JSON text.
    Json(Vec<u8>),
    /// A row of a table, and the decimal sign of the rows so far.
    Row(RawRow, Decimals),
}

impl Content {
    fn len(&self) -> usize {
        match self {
            Self::Json(bytes) => bytes.len(),
            // The row's end is a byte at least.
            Self::Row(row, _) => row.bytes.len() + 1,
        }
    }
}

/// The text of a scene and its place.
pub(super) struct Text {
    /// Index of the source.
    pub(super) source: usize,
    /// The line, from 1; 1 for a file of one scene.
    pub(super) line: usize,
    /// What was read, or why nothing can be read.
    pub(super) content: Result<Content, String>,
}

/// The texts of the scenes of several sources, one source after the other.
pub(super) struct Texts {
    waiting: VecDeque<Source>,
    source: usize,
    /// Bytes of the texts so far, for progress.
    bytes: Arc<AtomicU64>,
}

impl Texts {
    /// The texts, the number of bytes that were read so far, and of all where the sources are files.
    pub(super) fn new(sources: Vec<Source>) -> (Self, Arc<AtomicU64>, Option<u64>) {
        let total = sources.iter().map(|source| source.length).sum();
        let bytes = Arc::new(AtomicU64::new(0));
        let texts = Self { waiting: sources.into(), source: 0, bytes: Arc::clone(&bytes) };
        (texts, bytes, total)
    }
}

impl Iterator for Texts {
    type Item = Text;

    fn next(&mut self) -> Option<Text> {
        loop {
            let source = self.waiting.front_mut()?;
            let found = source.next_text();
            let ends = !matches!(found, Ok(Some(_)));
            let (line, index) = (source.taken, self.source);
            let text = match found.transpose() {
                Some(Ok((line, content))) => {
                    self.bytes.fetch_add(content.len() as u64, Ordering::Relaxed);
                    Some(Text { source: index, line, content: Ok(content) })
                }
                Some(Err(error)) => {
                    let content = Err(format!("cannot be read: {error}"));
                    Some(Text { source: index, line: line + 1, content })
                }
                None => None,
            };
            if ends {
                self.waiting.pop_front();
                self.source += 1;
            }
            if text.is_some() {
                return text;
            }
        }
    }
}

//! Input: whole files up to a size, and scenes one per line for as long as lines come.

use super::output::{input_error, is_standard};
use super::{InputError, parquet, standard};
use crate::scene::{MAX_SCENE_BYTES, read};
use std::collections::VecDeque;
use std::fs::{File, metadata};
use std::io::{self, BufRead, BufReader, Cursor, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// Reads a file, and at most one byte more than `max_bytes`, so that the parser rejects longer files.
pub(super) fn read(path: &Path, max_bytes: usize) -> Result<Vec<u8>, InputError> {
    let mut bytes = Vec::new();
    let file = open(path).map_err(|error| cannot_be_read(path, &error))?;
    let read = file.take(max_bytes as u64 + 1).read_to_end(&mut bytes);
    read.map_err(|error| cannot_be_read(path, &error))?;
    Ok(bytes)
}

fn cannot_be_read(path: &Path, error: &io::Error) -> InputError {
    input_error(path, format!("cannot be read: {error}"))
}

type Reader = Box<dyn Read + Send>;

fn open(path: &Path) -> io::Result<Reader> {
    if is_standard(path) && standard::is_input_closed() {
        return Err(io::Error::other("it is closed"));
    }
    Ok(if is_standard(path) { Box::new(io::stdin()) } else { Box::new(File::open(path)?) })
}

/// A file of one scene, or of one scene per line.
pub(super) struct Source {
    path: PathBuf,
    /// One scene per line?
    pub(super) is_lines: bool,
    /// Has the file a line that is not blank?
    pub(super) is_empty: bool,
    /// What was opened and is read on: it cannot be opened again, as standard input, or its first lines were taken.
    opened: Option<BufReader<Reader>>,
    /// Number of lines that were taken; 1 after a whole text.
    taken: usize,
    /// Length of the text, of a file of text \[bytes\].
    length: Option<u64>,
}

/// Greatest length of what is read of a line or a scene \[bytes\]: one more than the parser accepts.
const MOST_BYTES: u64 = MAX_SCENE_BYTES as u64 + 1;

impl Source {
    /// Opens a file; `is_lines` for one scene per line, `None` to find out by the first two lines.
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
            let text =
                |k: usize| lines.get(k).and_then(|line| read::utf8(&start[line.clone()]).ok());
            let found = text(0).zip(text(1)).is_some_and(|(a, b)| read::begin_lines(a, b));
            let is_empty = wanted > 0 && lines.is_empty();
            let all: Reader = Box::new(Cursor::new(start).chain(reader));
            let opened = (!is_file(path)).then(|| BufReader::new(all));
            let length = if is_file(path) { Some(metadata(path)?.len()) } else { None };
            let (path, is_lines) = (path.to_owned(), is_lines.unwrap_or(found));
            Ok(Self { path, is_lines, is_empty, opened, taken: 0, length })
        };
        begin().map_err(|error| cannot_be_read(path, &error))
    }

    /// Opens a table, CSV or a Parquet file, as lines.
    pub(super) fn of_table(path: &Path) -> Result<Self, InputError> {
        if !parquet::is_parquet(path) {
            return Self::open(path, Some(true));
        }
        let lines: Reader = Box::new(parquet::Lines::open(path)?);
        let opened = Some(BufReader::new(lines));
        let path = path.to_owned();
        Ok(Self { path, is_lines: true, is_empty: false, opened, taken: 0, length: None })
    }

    /// The whole text, of a file of one scene.
    pub(super) fn whole(&mut self) -> Result<Vec<u8>, InputError> {
        let Self { path, opened, .. } = self;
        let read = whole(opened.take(), path);
        read.map_err(|error| cannot_be_read(path, &error))
    }

    /// Takes the next line that is not blank; empty at the end.
    pub(super) fn take_line(&mut self) -> Result<Vec<u8>, InputError> {
        let line = self.next_line().map_err(|error| cannot_be_read(&self.path, &error))?;
        Ok(line.unwrap_or_default())
    }

    fn next_line(&mut self) -> io::Result<Option<Vec<u8>>> {
        if self.opened.is_none() {
            self.opened = Some(BufReader::new(open(&self.path)?));
        }
        let Some(reader) = &mut self.opened else { return Ok(None) };
        loop {
            let mut bytes = Vec::new();
            if reader.by_ref().take(MOST_BYTES).read_until(b'\n', &mut bytes)? == 0 {
                return Ok(None);
            }
            self.taken += 1;
            if bytes.len() as u64 == MOST_BYTES && !bytes.ends_with(b"\n") {
                reader.skip_until(b'\n')?;
            }
            if !bytes.trim_ascii().is_empty() {
                return Ok(Some(bytes));
            }
        }
    }

    /// The next text, a line or the whole of a file of one scene; `None` at the end.
    fn next_text(&mut self) -> io::Result<Option<Vec<u8>>> {
        if self.is_lines {
            return self.next_line();
        }
        if self.taken > 0 {
            return Ok(None);
        }
        let text = whole(self.opened.take(), &self.path)?;
        self.taken = 1;
        Ok(Some(text))
    }

    /// Can the source be read again?
    pub(super) fn is_file(&self) -> bool {
        is_file(&self.path)
    }

    pub(super) fn path(&self) -> &Path {
        &self.path
    }
}

fn is_file(path: &Path) -> bool {
    !is_standard(path) && metadata(path).is_ok_and(|found| found.is_file())
}

fn whole(opened: Option<BufReader<Reader>>, path: &Path) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    match opened {
        Some(reader) => reader.take(MOST_BYTES).read_to_end(&mut bytes)?,
        None => File::open(path)?.take(MOST_BYTES).read_to_end(&mut bytes)?,
    };
    Ok(bytes)
}

/// The text of a scene and its place.
pub(super) struct Text {
    /// Index of the source.
    pub(super) source: usize,
    /// The line, from 1; 1 for a file of one scene.
    pub(super) line: usize,
    /// The text, or why it cannot be read.
    pub(super) bytes: Result<Vec<u8>, String>,
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
                Some(Ok(bytes)) => {
                    self.bytes.fetch_add(bytes.len() as u64, Ordering::Relaxed);
                    Some(Text { source: index, line, bytes: Ok(bytes) })
                }
                Some(Err(error)) => {
                    let bytes = Err(format!("cannot be read: {error}"));
                    Some(Text { source: index, line: line + 1, bytes })
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

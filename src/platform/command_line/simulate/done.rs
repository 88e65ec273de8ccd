//! The scenes that the lines of an earlier run hold.

use super::super::InputError;
use super::super::output::input_error;
use super::form::LineFormat;
use super::key::Key;
use std::collections::HashMap;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// The scenes of an earlier run, each as often as it has a line.
#[derive(Default)]
pub(super) struct Done {
    lines: HashMap<Key, u32>,
    /// Length of the whole lines \[bytes\].
    pub(super) whole_bytes: u64,
}

impl Done {
    /// Reads the lines of an earlier run; a last line without its end holds nothing. A missing file holds nothing. A file with
    /// anything else is refused, and a table with other columns.
    pub(super) fn read(path: &Path, format: &LineFormat) -> Result<Self, InputError> {
        let mut done = Self::default();
        let error = |error| input_error(path, format!("--skip-done: cannot be read: {error}"));
        if !path.exists() {
            return Ok(done);
        }
        let mut reader = BufReader::new(File::open(path).map_err(error)?);
        let mut line = Vec::new();
        for number in 1.. {
            line.clear();
            if reader.read_until(b'\n', &mut line).map_err(error)? == 0 {
                break;
            }
            let other = || {
                let words = "is no line of a result; allowed: a file that `simulate` has written in this format";
                input_error(path, format!("--skip-done: line {number} {words}"))
            };
            if !line.ends_with(b"\n") {
                return format.is_begun(number, &line).then_some(done).ok_or_else(other);
            }
            done.whole_bytes += line.len() as u64;
            if number == 1
                && let Some(header) = format.header()
            {
                if line != header.as_bytes() {
                    let words = format!("has other columns; allowed: {}", header.trim_end());
                    return Err(input_error(path, format!("--skip-done: the file {words}")));
                }
            } else if !line.trim_ascii().is_empty() {
                *done.lines.entry(format.key(&line).ok_or_else(other)?).or_default() += 1;
            }
        }
        Ok(done)
    }

    /// Removes one line of a scene; is there one?
    pub(super) fn take(&mut self, key: &Key) -> bool {
        let Some(count) = self.lines.get_mut(key) else { return false };
        *count -= 1;
        if *count == 0 {
            self.lines.remove(key);
        }
        true
    }
}

//! The scenes that the lines of an earlier run hold.

use super::super::InputError;
use super::super::output::input_error;
use super::form::{Earlier, LineFormat};
use super::key::Key;
use std::collections::HashMap;
use std::fs::File;
use std::hash::Hash;
use std::io::{BufRead, BufReader};
use std::path::Path;
use std::sync::Arc;

/// The scenes of an earlier run, each as often as it has a line.
#[derive(Default)]
pub(super) struct Done {
    /// By `id`, if the scene has one, and by the hash of its content.
    lines: HashMap<(Option<Arc<str>>, Option<u128>), u32>,
    /// The number of lines of each `id`.
    ids: HashMap<Arc<str>, u32>,
    /// Length of the whole lines \[bytes\].
    pub(super) whole_bytes: u64,
}

/// What an earlier run has of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Found {
    /// A line.
    Line,
    /// Lines of its `id`, of other content.
    Changed,
    Nothing,
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
        // Of a table the header tells the fields.
        let (mut is_unknown, mut other_fields) = (format.header().is_none(), None);
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
                if !format.is_begun(number, &line) {
                    return Err(other());
                }
                break;
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
                done.add(format.earlier(&line).ok_or_else(other)?);
                if is_unknown && let Some(compared) = format.compared(&line) {
                    is_unknown = false;
                    other_fields = compared.err().map(|field| (number, field));
                }
            }
        }
        if let Some((number, field)) = other_fields {
            let line = format!(
                "--skip-done: line {number} has other fields ({field}); allowed: lines of the same --fields"
            );
            return Err(input_error(path, line));
        }
        Ok(done)
    }

    fn add(&mut self, Earlier { id, hash }: Earlier) {
        let id = id.map(|id| match self.ids.get_key_value(&*id) {
            Some((known, _)) => Arc::clone(known),
            None => Arc::from(id),
        });
        if let Some(id) = &id {
            *self.ids.entry(Arc::clone(id)).or_default() += 1;
        }
        *self.lines.entry((id, hash)).or_default() += 1;
    }

    /// Removes one line of a scene, if there is one. A line with an `id` and without a hash is of any content.
    pub(super) fn take(&mut self, key: &Key) -> Found {
        let id = match key.id_text().map(|id| self.ids.get_key_value(id)) {
            Some(Some((known, _))) => Some(Arc::clone(known)),
            Some(None) => return Found::Nothing,
            None => None,
        };
        let hashes = [Some(key.content()), None];
        let found = hashes.into_iter().any(|hash| is_taken(&mut self.lines, &(id.clone(), hash)));
        match (found, id) {
            (true, Some(id)) => _ = is_taken(&mut self.ids, &id),
            (true, None) => {}
            (false, Some(_)) => return Found::Changed,
            (false, None) => return Found::Nothing,
        }
        Found::Line
    }
}

/// Removes one of what is counted; is there one?
fn is_taken<K: Eq + Hash>(counts: &mut HashMap<K, u32>, key: &K) -> bool {
    let Some(count) = counts.get_mut(key) else { return false };
    *count -= 1;
    if *count == 0 {
        counts.remove(key);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_done_by_id_and_content_as_often_as_it_has_a_line() {
        let mut done = Done::default();
        let [one, changed] = ["{\"id\":1,\"a\":1}", "{\"id\":1,\"a\":2}"].map(Key::of);
        let anonymous = Key::of("{\"a\":1}");
        let add = |done: &mut Done, id: Option<&str>, hash| {
            done.add(Earlier { id: id.map(Box::from), hash });
        };
        add(&mut done, Some("1"), Some(one.content()));
        add(&mut done, Some("1"), Some(one.content()));
        add(&mut done, None, Some(anonymous.content()));
        // A line without a hash.
        add(&mut done, Some("2"), None);
        assert_eq!(done.take(&changed), Found::Changed);
        assert_eq!([done.take(&one), done.take(&one)], [Found::Line; 2]);
        // All lines of the id are taken.
        assert_eq!([done.take(&one), done.take(&changed)], [Found::Nothing; 2]);
        assert_eq!([&anonymous; 2].map(|key| done.take(key)), [Found::Line, Found::Nothing]);
        let two = Key::of("{\"id\":2}");
        assert_eq!([&two; 2].map(|key| done.take(key)), [Found::Line, Found::Nothing]);
    }
}

//! Which scene a line is, and the scenes that the lines of an earlier run hold.

use super::super::InputError;
use super::super::output::input_error;
use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;
use serde_json::value::RawValue;
use std::collections::HashMap;
use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// What a scene is known by: its `id`, else a hash of its content.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Key {
    /// The JSON text of the scene's `id`.
    Id(Box<str>),
    /// Of the scene's JSON with sorted fields.
    Hash(u128),
}

/// The fields of a scene, or of a line of an earlier run, that name the scene.
#[derive(Deserialize)]
struct Names<'a> {
    #[serde(borrow)]
    id: Option<&'a RawValue>,
    scene_hash: Option<&'a str>,
    /// Of a result, or of an error in its place.
    status: Option<IgnoredAny>,
    error: Option<IgnoredAny>,
}

impl Key {
    /// The key of a scene's text, valid or not.
    pub(super) fn of(text: &str) -> Self {
        let text = text.trim_start_matches('\u{feff}');
        if let Ok(Names { id: Some(id), .. }) = serde_json::from_str(text) {
            return Self::of_id(id);
        }
        let content = serde_json::from_str::<Value>(text).map(|value| value.to_string());
        Self::Hash(hash(content.as_deref().unwrap_or(text.trim())))
    }

    /// A line break in JSON is white space.
    fn of_id(id: &RawValue) -> Self {
        Self::Id(id.get().replace(['\n', '\r'], " ").into())
    }

    /// The value of `id`.
    pub(super) fn id(&self) -> Option<Box<RawValue>> {
        match self {
            Self::Id(id) => RawValue::from_string(id.to_string()).ok(),
            Self::Hash(_) => None,
        }
    }

    /// The value of `scene_hash`.
    pub(super) fn hash(&self) -> Option<String> {
        match self {
            Self::Id(_) => None,
            Self::Hash(hash) => Some(format!("{hash:032x}")),
        }
    }
}

/// FNV-1a with 128 bits: equal in every version of this program.
fn hash(text: &str) -> u128 {
    text.bytes().fold(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d, |hash, byte| {
        (hash ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b)
    })
}

/// How each line of a result begins.
const BEGINNINGS: [&[u8]; 2] = [br#"{"id":"#, br#"{"scene_hash":"#];

/// The scenes of an earlier run, each as often as it has a line.
#[derive(Default)]
pub(super) struct Done {
    lines: HashMap<Key, u32>,
    /// Length of the whole lines \[bytes\].
    pub(super) whole_bytes: u64,
}

impl Done {
    /// Reads the lines of an earlier run; a last line without its end holds nothing. A missing file holds nothing. A file with
    /// anything else is refused.
    pub(super) fn read(path: &Path) -> Result<Self, InputError> {
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
                let words = "is no line of a result; allowed: a file that `simulate` has written";
                input_error(path, format!("--skip-done: line {number} {words}"))
            };
            if !line.ends_with(b"\n") {
                let is_begun = |start: &&[u8]| line.starts_with(start) || start.starts_with(&line);
                return BEGINNINGS.iter().any(is_begun).then_some(done).ok_or_else(other);
            }
            done.whole_bytes += line.len() as u64;
            if !line.trim_ascii().is_empty() {
                *done.lines.entry(key_of_result(&line).ok_or_else(other)?).or_default() += 1;
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

fn key_of_result(line: &[u8]) -> Option<Key> {
    let Names { id, scene_hash, status, error } = serde_json::from_slice(line).ok()?;
    status.or(error)?;
    match id {
        Some(id) => Some(Key::of_id(id)),
        None => Some(Key::Hash(u128::from_str_radix(scene_hash?, 16).ok()?)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_that_of_the_published_vectors() {
        // The test vectors of the authors of FNV for the texts "", "a" and "foobar".
        assert_eq!(hash(""), 0x6c62_272e_07bb_0142_62b8_2175_6295_c58d);
        assert_eq!(hash("a"), 0xd228_cb69_6f1a_8caf_7891_2b70_4e4a_8964);
        assert_eq!(hash("foobar"), 0x343e_1662_793c_64bf_6f0d_3597_ba44_6f18);
    }

    #[test]
    fn a_scene_is_known_by_its_id_else_by_its_content() {
        let key = Key::of(r#"{"id":{"a":"1"},"insertion":1}"#);
        assert_eq!(key, Key::of(r#"{"insertion":2,"id":{"a":"1"}}"#));
        assert_eq!(key.id().unwrap().get(), r#"{"a":"1"}"#);
        let content = Key::of(r#"{"insertion":1,"implant":{"base_radius_mm":50}}"#);
        assert_eq!(content, Key::of(r#" {"implant": {"base_radius_mm": 50}, "insertion": 1} "#));
        assert_ne!(content, Key::of(r#"{"insertion":1,"implant":{"base_radius_mm":51}}"#));
        assert_eq!(Key::of(" {broken "), Key::of("{broken"));
        assert_eq!(
            Key::of(r#"{"id":123456789012345678901}"#).id().unwrap().get(),
            "123456789012345678901"
        );
    }
}

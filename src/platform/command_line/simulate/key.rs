//! Which scene a line is.

use serde::Deserialize;
use serde_json::Value;
use serde_json::value::RawValue;

/// What a scene is known by: its `id`, if it has one, and a hash of its content.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Key {
    /// The JSON text of the scene's `id`.
    id: Option<Box<str>>,
    /// Of the scene's JSON without `id`, with sorted fields; of a row of a table, of template and cells.
    hash: u128,
}

/// The fields of a scene that name it.
#[derive(Deserialize)]
struct Names<'a> {
    #[serde(borrow)]
    id: Option<&'a RawValue>,
}

impl Key {
    /// The key of a scene's text, valid or not.
    pub(super) fn of(text: &str) -> Self {
        let text = text.trim_start_matches('\u{feff}');
        let names = serde_json::from_str::<Names>(text).ok();
        let id = names.and_then(|Names { id }| Some(id?.get()));
        let content = serde_json::from_str::<Value>(text).map(|mut value| {
            if let (Some(fields), Some(_)) = (value.as_object_mut(), id) {
                fields.remove("id");
            }
            value.to_string()
        });
        Self::new(id, content.as_deref().unwrap_or(text.trim()))
    }

    /// The key of the JSON text of an `id`, and of what the scene consists of.
    pub(super) fn new(id: Option<&str>, content: &str) -> Self {
        Self { id: id.map(one_line), hash: hash(content) }
    }

    /// The JSON text of `id`.
    pub(super) fn id_text(&self) -> Option<&str> {
        self.id.as_deref()
    }

    /// The value of `id`.
    pub(super) fn id(&self) -> Option<Box<RawValue>> {
        self.id.as_ref().and_then(|id| RawValue::from_string(id.to_string()).ok())
    }

    /// The hash of the content.
    pub(super) fn content(&self) -> u128 {
        self.hash
    }

    /// The value of `scene_hash`.
    pub(super) fn hash(&self) -> String {
        format!("{:032x}", self.hash)
    }
}

/// A line break in JSON is white space.
pub(super) fn one_line(json: &str) -> Box<str> {
    json.replace(['\n', '\r'], " ").into()
}

/// The hash of a written `scene_hash`.
pub(super) fn written_hash(text: &str) -> Option<u128> {
    u128::from_str_radix(text, 16).ok()
}

/// FNV-1a with 128 bits: equal in every version of this program.
fn hash(text: &str) -> u128 {
    text.bytes().fold(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d, |hash, byte| {
        (hash ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b)
    })
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
    fn a_scene_is_known_by_its_id_and_by_its_content_without_it() {
        let key = Key::of(r#"{"id":{"a":"1"},"insertion":1}"#);
        let changed = Key::of(r#"{"insertion":2,"id":{"a":"1"}}"#);
        assert!(key.id_text() == changed.id_text() && key.content() != changed.content());
        assert_eq!(key.id().unwrap().get(), r#"{"a":"1"}"#);
        let other = Key::of(r#"{"id":2,"insertion":1}"#);
        assert!(other.content() == key.content() && other != key);
        let content = Key::of(r#"{"insertion":1,"implant":{"base_radius_mm":50}}"#);
        assert_eq!(content, Key::of(r#" {"implant": {"base_radius_mm": 50}, "insertion": 1} "#));
        assert_ne!(content, Key::of(r#"{"insertion":1,"implant":{"base_radius_mm":51}}"#));
        assert_eq!(Key::of(" {broken "), Key::of("{broken"));
        assert_eq!(written_hash(&key.hash()), Some(key.content()));
        assert_eq!(
            Key::of(r#"{"id":123456789012345678901}"#).id().unwrap().get(),
            "123456789012345678901"
        );
    }
}

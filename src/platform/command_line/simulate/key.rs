//! Which scene a line is.

use serde::Deserialize;
use serde::de::IgnoredAny;
use serde_json::Value;
use serde_json::value::RawValue;

/// What a scene is known by: its `id`, else a hash of its content.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) enum Key {
    /// The JSON text of the scene's `id`.
    Id(Box<str>),
    /// Of the scene's JSON with sorted fields; of a row of a table, of template and cells.
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
            return Self::of_id(id.get());
        }
        let content = serde_json::from_str::<Value>(text).map(|value| value.to_string());
        Self::of_content(content.as_deref().unwrap_or(text.trim()))
    }

    /// The key of a line of an earlier run; `None` for another line.
    pub(super) fn of_result(line: &[u8]) -> Option<Self> {
        let Names { id, scene_hash, status, error } = serde_json::from_slice(line).ok()?;
        status.or(error)?;
        match id {
            Some(id) => Some(Self::of_id(id.get())),
            None => Self::of_hash(scene_hash?),
        }
    }

    /// The key of the JSON text of an `id`; a line break in JSON is white space.
    pub(super) fn of_id(json: &str) -> Self {
        Self::Id(json.replace(['\n', '\r'], " ").into())
    }

    /// The key of what a scene consists of.
    pub(super) fn of_content(content: &str) -> Self {
        Self::Hash(hash(content))
    }

    /// The key of a written `scene_hash`.
    pub(super) fn of_hash(text: &str) -> Option<Self> {
        u128::from_str_radix(text, 16).ok().map(Self::Hash)
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

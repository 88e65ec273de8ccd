//! Pins: scenes kept beside the current scene for comparison, in a scene file and in a list of their own.

use super::{CheckedScene, Scene, SceneError, SceneFile, check_words, out_of_range, read};
use crate::curve::{List, given, object, present};
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize};
use std::fmt;

/// The schema of a list of pins without a current scene.
pub const PINS_SCHEMA: &str = "implant-preview/pins/1";

/// Greatest number of pins.
pub const MAX_PINS: usize = Letter::ALL.len();

/// Greatest length of a pin's name \[bytes\].
pub const MAX_NAME_BYTES: usize = 100;

/// The letter of a pin.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
)]
#[allow(missing_docs, reason = "a letter is its own description")]
pub enum Letter {
    A,
    B,
    C,
    D,
}

impl Letter {
    /// All letters in order.
    pub const ALL: [Self; 4] = [Self::A, Self::B, Self::C, Self::D];
}

impl fmt::Display for Letter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Debug::fmt(self, f)
    }
}

/// A pinned scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PinnedScene {
    /// The letter, different for every pin.
    pub letter: Letter,
    /// The user's name; may be empty.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// The scene, without a visit.
    pub scene: Scene,
}

/// A scene file: the scene and the pins beside it.
#[derive(Clone, Debug)]
pub struct Document {
    /// The scene.
    pub scene: CheckedScene,
    /// The pins in the order of their letters; `None` without the field `pins`.
    pub pins: Option<Vec<PinnedScene>>,
}

/// A pin in a file.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "one JSON object")]
#[schemars(rename = "Pin")]
pub(super) struct PinFile {
    /// Default: the first letter without a pin.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "Letter")]
    letter: Option<Letter>,
    /// Up to 100 bytes. Default: no name.
    #[serde(default, deserialize_with = "present")]
    name: String,
    /// A scene without pins and without a visit.
    #[serde(deserialize_with = "boxed")]
    scene: Box<SceneFile>,
}

fn boxed<'de, D: Deserializer<'de>>(reader: D) -> Result<Box<SceneFile>, D::Error> {
    object(reader).map(Box::new)
}

/// Reads the plan of the other side.
pub(super) fn boxed_or_none<'de, D: Deserializer<'de>>(
    reader: D,
) -> Result<Option<Box<SceneFile>>, D::Error> {
    boxed(reader).map(Some)
}

/// Reads the field `pins`.
pub(super) fn list<'de, D: Deserializer<'de>>(reader: D) -> Result<Option<Vec<PinFile>>, D::Error> {
    #[derive(Deserialize)]
    struct Entry(#[serde(deserialize_with = "object")] PinFile);
    let list: List<Entry, MAX_PINS> = present(reader)?;
    Ok(Some(list.0.into_iter().map(|entry| entry.0).collect()))
}

/// Checks the pins of a file; returns the pins in the order of their letters.
fn checked(files: Vec<PinFile>) -> Result<Vec<PinnedScene>, SceneError> {
    let mut taken: Vec<Letter> = Vec::new();
    for (k, file) in files.iter().enumerate() {
        if let Some(letter) = file.letter {
            if taken.contains(&letter) {
                let field = format!("pins[{k}].letter");
                return Err(out_of_range(&field, letter.to_string(), "a letter of one pin only"));
            }
            taken.push(letter);
        }
    }
    let mut free = Letter::ALL.into_iter().filter(|letter| !taken.contains(letter));
    let mut pins = Vec::new();
    for (k, PinFile { letter, name, scene }) in files.into_iter().enumerate() {
        check_name(&format!("pins[{k}].name"), &name)?;
        let at_pin = |source| SceneError::Pin { pin: k, source: Box::new(source) };
        if scene.pins.is_some() {
            let allowed = "a scene without pins in a pin";
            return Err(at_pin(out_of_range("pins", "a list".to_owned(), allowed)));
        }
        if scene.visit.is_some() {
            let allowed = "a visit beside the scene of the file only, not in a pin";
            return Err(at_pin(out_of_range("visit", "an object".to_owned(), allowed)));
        }
        let scene = CheckedScene::new(scene.filled().map_err(at_pin)?).map_err(at_pin)?;
        // At most as many pins as letters: a letter is left.
        if let Some(letter) = letter.or_else(|| free.next()) {
            pins.push(PinnedScene { letter, name, scene: scene.into_scene() });
        }
    }
    pins.sort_by_key(|pin| pin.letter);
    Ok(pins)
}

/// Checks the name of a pin; messages name `field`.
pub(crate) fn check_name(field: &str, name: &str) -> Result<(), SceneError> {
    check_words(field, name, MAX_NAME_BYTES)
}

impl SceneFile {
    /// Takes the checked pins out of the file.
    pub(super) fn take_pins(&mut self) -> Result<Option<Vec<PinnedScene>>, SceneError> {
        self.pins.take().map(checked).transpose()
    }
}

impl Document {
    /// Reads a scene file with its pins.
    ///
    /// # Errors
    /// One line with the field, its value and the allowed range.
    pub fn from_json(json: &str) -> Result<Self, SceneError> {
        let mut file: SceneFile = read::json(json, "scene")?;
        let pins = file.take_pins()?;
        Ok(Self { scene: CheckedScene::new(file.filled()?)?, pins })
    }
}

/// A scene file as JSON text, indented.
#[must_use]
pub fn document_json(scene: &Scene, pins: &[PinnedScene]) -> String {
    #[derive(Serialize)]
    struct File<'a> {
        #[serde(flatten)]
        scene: &'a Scene,
        pins: &'a [PinnedScene],
    }
    if pins.is_empty() {
        return scene.to_json();
    }
    serde_json::to_string_pretty(&File { scene, pins }).unwrap_or_default()
}

/// A list of pins as JSON text.
#[must_use]
pub fn pins_json(pins: &[PinnedScene]) -> String {
    #[derive(Serialize)]
    struct File<'a> {
        schema: &'a str,
        pins: &'a [PinnedScene],
    }
    serde_json::to_string(&File { schema: PINS_SCHEMA, pins }).unwrap_or_default()
}

/// Reads a list of pins written by [`pins_json`].
///
/// # Errors
/// One line with the field, its value and the allowed range.
pub fn pins_from_json(json: &str) -> Result<Vec<PinnedScene>, SceneError> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields, expecting = "one JSON object")]
    struct File {
        schema: String,
        #[serde(deserialize_with = "list")]
        pins: Option<Vec<PinFile>>,
    }
    let File { schema, pins } = read::json(json, "pins")?;
    if schema != PINS_SCHEMA {
        let schema = super::one_line(&format!("{schema:?}"), 40);
        return Err(out_of_range("schema", schema, PINS_SCHEMA));
    }
    checked(pins.unwrap_or_default())
}

//! From bytes to scenes and curves: text, JSON, JSON lines. Invalid input of any length is rejected with one short
//! line; reading stops at the first surplus entry of a list.

use super::{CheckedScene, SceneError, SceneFile, out_of_range, problem};
use crate::curve::{Curve, ScaledCurve};
use serde::de::{DeserializeOwned, IgnoredAny};

/// Greatest size of a scene or a curve \[bytes\].
pub const MAX_SCENE_BYTES: usize = 10_000_000;

/// Greatest size of a JSON-lines file \[bytes\].
pub const MAX_LINES_BYTES: usize = 100_000_000;

/// Greatest number of scenes in a JSON-lines file.
pub const MAX_SCENES: usize = 100_000;

/// The format of a file of scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// One scene; or one scene per line if the first line is a whole value and more lines follow.
    Json,
    /// One scene per line.
    JsonLines,
}

/// Reads and checks the scenes of a file.
///
/// # Errors
/// One line with the line, the field, its value and the allowed range.
pub fn scenes(bytes: &[u8], format: Format) -> Result<Vec<CheckedScene>, SceneError> {
    if bytes.len() > MAX_LINES_BYTES {
        return Err(out_of_range("file", format!("{} bytes long", bytes.len()), "up to 100 MB"));
    }
    let text = unmarked(utf8(bytes)?);
    if format == Format::Json && !starts_with_a_value(text) {
        return Ok(vec![checked_scene(text, None)?]);
    }
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let at_line = |k, error| SceneError::Line { line: k + 1, source: Box::new(error) };
    // Before any scene is built: checked scenes contain curves and need much memory.
    if let Some((k, _)) = lines.clone().nth(MAX_SCENES) {
        let allowed = format!("up to {MAX_SCENES} scenes");
        return Err(at_line(k, out_of_range("file", "too long".to_owned(), &allowed)));
    }
    let mut scenes = Vec::new();
    for (k, line) in lines {
        scenes.push(checked_scene(line, scenes.last()).map_err(|error| at_line(k, error))?);
    }
    if scenes.is_empty() {
        return Err(out_of_range("file", "empty".to_owned(), "one scene per line"));
    }
    Ok(scenes)
}

/// Reads a file with one curve in the format of a scene's curve.
///
/// # Errors
/// One line with the field, its value and the allowed range.
pub fn curve(bytes: &[u8]) -> Result<Curve, SceneError> {
    let curve: ScaledCurve = json(utf8(bytes)?, "curve")?;
    Curve::scaled(&curve).map_err(SceneError::CurveFile)
}

/// Is the first line that is not blank a whole value, and do more lines follow?
fn starts_with_a_value(text: &str) -> bool {
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    let whole = |line: &str| serde_json::from_str::<IgnoredAny>(line).is_ok();
    lines.next().is_some_and(whole) && lines.next().is_some()
}

/// The text without the byte-order mark that some editors put before it.
fn unmarked(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

fn utf8(bytes: &[u8]) -> Result<&str, SceneError> {
    std::str::from_utf8(bytes)
        .map_err(|error| problem("file", &format!("{error}; allowed: JSON in UTF-8")))
}

pub(super) fn checked_scene(
    text: &str,
    earlier: Option<&CheckedScene>,
) -> Result<CheckedScene, SceneError> {
    CheckedScene::like(json::<SceneFile>(text, "scene")?.filled()?, earlier)
}

/// Reads one JSON object; messages name the object `whole`.
pub(crate) fn json<T: DeserializeOwned>(text: &str, whole: &str) -> Result<T, SceneError> {
    let text = unmarked(text);
    if text.len() > MAX_SCENE_BYTES {
        return Err(out_of_range(whole, format!("{} bytes long", text.len()), "up to 10 MB"));
    }
    if text.trim_start().starts_with('[') {
        return Err(problem(whole, "is a list; allowed: one JSON object"));
    }
    let mut reader = serde_json::Deserializer::from_str(text);
    let read = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        let path = match error.path().to_string() {
            path if path == "." || path == "?" => whole.to_owned(),
            path => path,
        };
        let text = error.into_inner().to_string();
        // Names of Rust types mean nothing to a reader.
        let text = text.replace("expected f64", "expected a number");
        problem(&path, &text.replace("expected usize", "expected a whole number"))
    })?;
    reader.end().map_err(|error| problem(whole, &error.to_string()))?;
    Ok(read)
}

//! From bytes to scenes and curves: text, JSON, JSON lines. Invalid input of any length is rejected with one short
//! line; reading stops at the first surplus entry of a list.

use super::values::{Values, has_several};
use super::{CheckedScene, Field, SceneError, SceneFile, one_line, out_of_range, problem};
use crate::curve::{Curve, GAP, List, ScaledCurve};
use crate::table::{Encoding, NotText, encoding, line_at};
use serde::Deserialize;
use serde::de::{DeserializeOwned, IgnoredAny};
use serde_json::error::Category;
use serde_json::value::RawValue;
use std::borrow::Cow;

/// Greatest size of a scene or a curve \[bytes\].
pub const MAX_SCENE_BYTES: usize = 10_000_000;

/// Greatest size of a JSON-lines file \[bytes\].
pub const MAX_LINES_BYTES: usize = 100_000_000;

/// Greatest number of scenes in a JSON-lines file.
pub const MAX_SCENES: usize = 100_000;

/// The format of a file of scenes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// One scene; or one scene per line if the first line is a whole value and more lines follow; or one scene behind the other, each
    /// over any number of lines.
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
    let Some(texts) = (match format {
        Format::Json => several(text),
        Format::JsonLines => Some(lines(text)),
    }) else {
        return Ok(vec![checked_scene(text, None)?]);
    };
    let at_line = |line, error| SceneError::Line { line, source: Box::new(error) };
    // Before any scene is built: checked scenes contain curves and need much memory.
    if let Some((line, _)) = texts.get(MAX_SCENES) {
        let allowed = format!("up to {MAX_SCENES} scenes");
        return Err(at_line(*line, out_of_range("file", "too long".to_owned(), &allowed)));
    }
    let mut scenes = Vec::new();
    for (line, text) in texts {
        scenes.push(checked_scene(&text, scenes.last()).map_err(|error| at_line(line, error))?);
    }
    if scenes.is_empty() {
        return Err(out_of_range("file", "empty".to_owned(), "one scene per line"));
    }
    Ok(scenes)
}

/// The texts of scenes one per line or one behind the other with their lines, one text more than allowed at most; `None` for one
/// scene.
fn several(text: &str) -> Option<Vec<(usize, Cow<'_, str>)>> {
    if starts_with_a_value(text) {
        return Some(lines(text));
    }
    // Memory is always read.
    has_several(text.as_bytes()).unwrap_or_default().then(|| {
        let mut values = Values::new(text.as_bytes(), MAX_SCENE_BYTES + 1);
        let next = || values.next_value().unwrap_or_default();
        let found = std::iter::from_fn(next).take(MAX_SCENES + 1);
        let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned().into();
        found.map(|(line, bytes)| (line, text(bytes))).collect()
    })
}

/// The lines that are not blank with their numbers, one more than allowed at most.
fn lines(text: &str) -> Vec<(usize, Cow<'_, str>)> {
    let lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    lines.take(MAX_SCENES + 1).map(|(k, line)| (k + 1, line.into())).collect()
}

/// Splits a list of scenes (JSON), scenes one per line or one behind the other, into the texts of the scenes, which stay unchecked.
///
/// # Errors
/// One line if the text is not a list or is too long.
pub fn texts(text: &str) -> Result<Vec<String>, SceneError> {
    if text.len() > MAX_LINES_BYTES {
        return Err(out_of_range("scenes", format!("{} bytes long", text.len()), "up to 100 MB"));
    }
    let text = unmarked(text);
    let texts: Vec<Cow<'_, str>> = if text.trim_start().starts_with('[') {
        let list: List<&RawValue, MAX_SCENES> =
            serde_json::from_str(text).map_err(|error| problem("scenes", &error.to_string()))?;
        list.0.into_iter().map(|scene| scene.get().into()).collect()
    } else {
        let texts = several(text).unwrap_or_else(|| vec![(1, text.into())]);
        texts.into_iter().map(|(_, text)| text).collect()
    };
    if texts.len() > MAX_SCENES {
        let allowed = format!("up to {MAX_SCENES} scenes");
        return Err(out_of_range("scenes", "too long".to_owned(), &allowed));
    }
    Ok(texts.into_iter().map(Cow::into_owned).collect())
}

/// Reads a file with one curve in the format of a scene's curve.
///
/// # Errors
/// One line with the field, its value and the allowed range.
pub fn curve(bytes: &[u8]) -> Result<Curve, SceneError> {
    let curve: ScaledCurve = json(utf8(bytes)?, "curve")?;
    Curve::scaled(&curve).map_err(SceneError::CurveFile)
}

/// Do the first two lines that are not blank begin scenes one per line? The first is a whole value, or the second a scene.
#[must_use]
pub fn begin_lines(first: &str, second: &str) -> bool {
    #[derive(Deserialize)]
    struct Part {
        #[serde(rename = "implant")]
        _implant: IgnoredAny,
    }
    serde_json::from_str::<IgnoredAny>(unmarked(first)).is_ok()
        || second.trim_start().starts_with('{') && serde_json::from_str::<Part>(second).is_ok()
}

fn starts_with_a_value(text: &str) -> bool {
    let mut lines = text.lines().filter(|line| !line.trim().is_empty());
    let pair = lines.next().zip(lines.next());
    pair.is_some_and(|(first, second)| begin_lines(first, second))
}

/// The text without the byte-order mark that some editors put before it.
fn unmarked(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// Checks by the beginning of a file that JSON may follow.
///
/// # Errors
/// What the file is instead: UTF-16, UTF-32, a compressed file, a workbook.
pub fn is_json_text(beginning: &[u8]) -> Result<(), NotText> {
    match encoding(beginning)? {
        Encoding::Utf8 => Ok(()),
        Encoding::Utf16Le | Encoding::Utf16Be => Err(NotText::Other("UTF-16", "save it as UTF-8")),
    }
}

/// The text of bytes.
///
/// # Errors
/// One line if the bytes are not UTF-8.
pub fn utf8(bytes: &[u8]) -> Result<&str, SceneError> {
    let in_words = |error: NotText| problem("file", &error.to_string());
    is_json_text(bytes).map_err(in_words)?;
    std::str::from_utf8(bytes).map_err(|error| {
        in_words(NotText::NotUtf8 { line: line_at(&bytes[..error.valid_up_to()]) })
    })
}

pub(super) fn checked_scene(
    text: &str,
    earlier: Option<&CheckedScene>,
) -> Result<CheckedScene, SceneError> {
    CheckedScene::like(json::<SceneFile>(text, "scene")?.filled()?, earlier)
}

/// Reads one JSON object; messages name the object `whole`.
pub fn json<T: DeserializeOwned>(text: &str, whole: &str) -> Result<T, SceneError> {
    let text = unmarked(text);
    if text.len() > MAX_SCENE_BYTES {
        return Err(out_of_range(whole, format!("{} bytes long", text.len()), "up to 10 MB"));
    }
    if text.trim().is_empty() {
        return Err(problem(whole, "is empty; allowed: one JSON object"));
    }
    if text.trim_start().starts_with('[') {
        return Err(problem(whole, "is a list; allowed: one JSON object"));
    }
    of_any_size(text, whole)
}

/// Reads JSON of any length, as workers exchange it; messages name the value `whole`.
///
/// # Errors
/// One line with the place and what is allowed.
pub fn of_any_size<T: DeserializeOwned>(text: &str, whole: &str) -> Result<T, SceneError> {
    let mut reader = serde_json::Deserializer::from_str(text);
    let read = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        let path = error.path().to_string();
        // A question mark stands for a part without a name.
        let path = match path.trim_end_matches(['.', '?']) {
            "" => whole,
            named => named,
        };
        let error = error.into_inner();
        if let Some(gap) = gap(path, text, &error) {
            return gap;
        }
        let text = match error.classify() {
            Category::Syntax if is_no_word(&error, text) => NO_WORD.to_owned(),
            Category::Syntax => format!("{error}; allowed: JSON, numbers as 12.5"),
            Category::Eof => {
                format!("ends too early, in line {}; allowed: one whole JSON object", error.line())
            }
            // The path is the place.
            Category::Data | Category::Io => in_words(&without_place(&error.to_string())),
        };
        problem(path, &text)
    })?;
    reader.end().map_err(|error| problem(whole, &error.to_string()))?;
    Ok(read)
}

/// The error of another value than a word where one of some words is expected.
const NO_WORD: &str = "is not a text; allowed: a word in quotation marks";

/// Is the error at another value in whole JSON? The parser expects one of some words to be a text.
fn is_no_word(error: &serde_json::Error, text: &str) -> bool {
    error.to_string().starts_with("expected value")
        && serde_json::from_str::<IgnoredAny>(text).is_ok()
}

/// The error of `null` where a value is expected, or of a number that JSON does not have, as other languages write it.
fn gap(path: &str, text: &str, error: &serde_json::Error) -> Option<SceneError> {
    let (value, allowed) = if error.is_data() {
        let line = without_place(&error.to_string());
        let found = line.strip_prefix(GAP).or_else(|| line.strip_prefix(NULL));
        ("null", found?.to_owned())
    } else {
        (no_value(text, error.line(), error.column())?, "a number or a text".to_owned())
    };
    let optional = allowed.find(OPTIONAL).map_or("", |at| &allowed[at..]);
    // Also in the scene of a pin.
    let in_scene = path.rsplit_once(".scene.").map_or(path, |(_, path)| path);
    let field = Field::of_path(in_scene);
    let limits = field.map(|(field, _)| field.allowed(field.limits) + optional);
    let path = one_line(path, 30);
    Some(out_of_range(&path, value.to_owned(), &limits.unwrap_or_else(|| in_words(&allowed))))
}

/// An error of serde at `null`, before what is expected.
const NULL: &str = "invalid type: null, expected ";
/// The end of an error of `null` in an optional field.
const OPTIONAL: &str = ", or leave it out";

/// What stands at a place of a text instead of a value: `null` instead of a word, or a number that is not finite, as Python and
/// JavaScript write it.
fn no_value(text: &str, line: usize, column: usize) -> Option<&'static str> {
    let line = text.split('\n').nth(line.checked_sub(1)?)?;
    let names = [("null", "null", "null"), ("NaN", "nan", "nan"), ("Infinity", "inf", "-inf")];
    // The parser counts up to the sign, the first letter or the letter before.
    (column.saturating_sub(1)..=column + 1).find_map(|start| {
        let (before, at) = line.split_at_checked(start)?;
        let (_, plain, negative) = names.into_iter().find(|(name, ..)| at.starts_with(name))?;
        Some(if before.ends_with('-') { negative } else { plain })
    })
}

/// Names of Rust types mean nothing to a reader.
fn in_words(text: &str) -> String {
    let text = text.replace("f64", "a number").replace("usize", "a whole number");
    text.replace("an array of length", "a list of length")
}

/// A message of the parser without its place, with the names of what is allowed.
fn without_place(message: &str) -> String {
    let message = message.rfind(" at line ").map_or(message, |end| &message[..end]);
    if !message.starts_with("unknown ") {
        return message.to_owned();
    }
    let allowed = message.replacen(", expected one of ", "; allowed: ", 1);
    allowed.replacen(", expected ", "; allowed: ", 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::marks::Marks;

    #[test]
    fn texts_of_scenes_are_split_from_lists_and_lines() {
        let list = texts("\u{feff} [ {\"a\": 0.10} , 5,\n{}]").unwrap();
        assert_eq!(list, ["{\"a\": 0.10}", "5", "{}"]);
        assert_eq!(texts("{}\n\n{\r\n").unwrap(), ["{}", "{"]);
        assert_eq!(texts("{\n}").unwrap(), ["{\n}"]);
        assert_eq!(texts("\u{feff}{\n\"a\": 1\n}\n{\n}").unwrap(), ["{\n\"a\": 1\n}", "{\n}"]);
        assert_eq!(texts("[]").unwrap(), [""; 0]);
    }

    #[test]
    fn scenes_behind_one_another_over_any_number_of_lines_are_read() {
        let implant = "\"implant\": {\"base_radius_mm\": 60, \"projection_mm\": 40}";
        let scene = format!("{{\n  {implant}, \"insertion\": 0.5\n}}");
        let read = |text: &str| scenes(text.as_bytes(), Format::Json);
        let found = read(&format!("{scene}\n{scene}{scene}\n")).unwrap();
        assert!(found.len() == 3 && found.iter().all(|scene| scene.scene().insertion < 1.0));
        assert_eq!(read(&scene).unwrap().len(), 1);
        let error = read(&format!("{scene}\n{{\n{implant}, \"insertion\": 5}}")).err().unwrap();
        let error = error.to_string();
        assert!(error.starts_with("line 4: insertion"), "{error}");
    }

    #[test]
    fn a_broken_or_long_list_of_scenes_is_one_line() {
        let long = format!("[{}1]", "1,".repeat(MAX_SCENES));
        let lines = "{}\n".repeat(MAX_SCENES + 1);
        let allowed = format!("up to {MAX_SCENES} scenes");
        for (text, expected) in [
            ("[{}, {]", "scenes: key must be a string at line 1 column 7"),
            ("[{}] 5", "scenes: trailing characters"),
            (&long, "a list of at most 100000 entries"),
            (&lines, &allowed),
        ] {
            let line = texts(text).unwrap_err().to_string();
            assert!(line.contains(expected) && !line.contains('\n'), "{line}");
        }
    }

    #[test]
    fn an_error_names_what_is_wrong_where_and_what_is_allowed() {
        let error = |text: &str| json::<SceneFile>(text, "scene").err().unwrap().to_string();
        assert_eq!(error(" \n"), "scene: is empty; allowed: one JSON object");
        assert_eq!(
            error("{\n\"insertion\": 1"),
            "scene: ends too early, in line 2; allowed: one whole JSON object"
        );
        let unknown = error(r#"{ "scene": {} }"#);
        assert!(
            unknown.starts_with("scene: unknown field `scene`; allowed: `schema`"),
            "{unknown}"
        );
        let unknown = error(r#"{ "implant": { "width": 1 } }"#);
        assert!(
            unknown.starts_with("implant.width: unknown field `width`; allowed: `"),
            "{unknown}"
        );
        let number = error(r#"{ "insertion": "a" }"#);
        assert!(number.starts_with("insertion: ") && !number.contains("at line"), "{number}");
    }

    #[test]
    fn an_error_in_marks_names_the_mark() {
        for (point, expected) in [
            ("[0, null, 1]", "navel[1] is null; allowed: a number"),
            ("[0, NaN, 1]", "navel[1] is nan; allowed: a number or a text"),
            ("[0, \"a\", 1]", "navel[1]: invalid type: string \"a\", expected a number"),
            ("[0, 1e400, 2]", "navel[1]: number out of range at line 1 column 20; allowed: JSON"),
            ("[0, 1]", "navel: invalid length 2, expected a list of length 3"),
            ("3", "navel: invalid type: integer `3`, expected a list of length 3"),
            ("null", "navel is null; allowed: a list of length 3, or leave it out"),
            ("[0, 1, 2]", "marks: sternal_notch is missing; allowed: a point [x, y, z]"),
            ("[0, 1, 2], \"navel\": 1", "marks: duplicate field `navel`"),
        ] {
            let text = format!("{{ \"navel\": {point} }}");
            let line = json::<Marks>(&text, "marks").unwrap_err().to_string();
            assert!(line.starts_with(expected), "{line}");
        }
        assert_eq!(
            json::<Marks>("[]", "marks").unwrap_err().to_string(),
            "marks: is a list; allowed: one JSON object"
        );
    }
}

//! The error of an invalid scene, and the checks that several parts of a scene share.

use crate::clinical::ClinicalError;
use crate::curve::CurveError;

/// Error of an invalid scene, in one line: field, value, allowed range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SceneError {
    /// Not JSON, or a field is unknown, missing or of the wrong type.
    #[error("{path}: {problem}")]
    Json {
        /// The field's path, or `scene`.
        path: String,
        /// Description of the error, with line and column.
        problem: String,
    },
    /// A value is out of range.
    #[error("{field} is {value}; allowed: {allowed}")]
    OutOfRange {
        /// The field's path.
        field: String,
        /// The given value.
        value: String,
        /// The allowed range, with its unit.
        allowed: String,
    },
    /// A layer's curve is invalid.
    #[error("layers[{layer}].curve: {source}{}", way(source))]
    Curve {
        /// The layer, counted from the skin, from 0.
        layer: usize,
        /// The error of the curve.
        source: CurveError,
    },
    /// A measurement of the patient is invalid, or gives a value out of its range.
    #[error("patient.{field}: {source}")]
    Patient {
        /// The field in `patient`.
        field: &'static str,
        /// The error of the measurement.
        source: ClinicalError,
    },
    /// The scene of a pin is invalid.
    #[error("pins[{pin}].scene: {source}")]
    Pin {
        /// The pin in its list, from 0.
        pin: usize,
        /// The error of its scene.
        source: Box<SceneError>,
    },
    /// The plan of the other side is invalid.
    #[error("other_side.{0}")]
    OtherSide(Box<SceneError>),
    /// A curve in a file of its own is invalid.
    #[error("{}{}", .0, way(.0))]
    CurveFile(CurveError),
    /// A scene in a file of several scenes is invalid.
    #[error("line {line}: {source}")]
    Line {
        /// The line, from 1.
        line: usize,
        /// The error of the scene in that line.
        source: Box<SceneError>,
    },
}

/// What to do with points that are no curve yet.
fn way(error: &CurveError) -> &'static str {
    match error {
        CurveError::Entry { field: "points", .. } => {
            "; a raw tensile test becomes a curve by `implant-preview curve FILE`"
        }
        _ => "",
    }
}

/// Checks a name or words of a user.
pub(super) fn check_words(field: &str, text: &str, most_bytes: usize) -> Result<(), SceneError> {
    if text.len() > most_bytes {
        let allowed = format!("up to {most_bytes} bytes");
        return Err(out_of_range(field, format!("{} bytes long", text.len()), &allowed));
    }
    if text.contains(char::is_control) {
        let allowed = "text without line breaks and control characters";
        return Err(out_of_range(field, one_line(text, 40), allowed));
    }
    Ok(())
}

pub(super) fn out_of_range(field: &str, value: String, allowed: &str) -> SceneError {
    SceneError::OutOfRange { field: field.to_owned(), value, allowed: allowed.to_owned() }
}

pub(super) fn problem(path: &str, problem: &str) -> SceneError {
    SceneError::Json { path: one_line(path, 30), problem: one_line(problem, 90) }
}

/// The text in one line without control characters and marks of direction; a long text is shortened to its first
/// `start` characters and its end.
pub(super) fn one_line(text: &str, start: usize) -> String {
    let is_mark = |c: char| matches!(c, '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let is_blank = |c: char| c.is_whitespace() || c.is_control() || is_mark(c);
    let words: Vec<&str> = text.split(is_blank).filter(|word| !word.is_empty()).collect();
    let line = words.join(" ");
    let (count, end) = (line.chars().count(), start + start / 3);
    if count <= start + end {
        return line;
    }
    let first: String = line.chars().take(start).collect();
    let last: String = line.chars().skip(count - end).collect();
    format!("{first} … {last}")
}

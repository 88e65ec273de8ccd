//! Side, and patient and visit in words, for the file: reference, date, surgeon, remarks. No number of a result depends on them.

use super::{Scene, SceneError, one_line, out_of_range};
use crate::curve::{given, present};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Greatest length of reference, surgeon and remarks \[characters\], and of the remarks \[lines\].
pub const MAX_REFERENCE: usize = 40;
#[allow(missing_docs, reason = "described above")]
pub const MAX_SURGEON: usize = 60;
#[allow(missing_docs, reason = "described above")]
pub const MAX_REMARKS: usize = 500;
#[allow(missing_docs, reason = "described above")]
pub const MAX_REMARK_LINES: usize = 12;

/// A date of a visit, in words.
pub const DATE: &str = "a date as 2026-01-31 (year-month-day), 1900 to 2199";

/// The visit of a patient; an empty text is not stated.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "one JSON object")]
pub struct Visit {
    /// The patient's number or initials, up to 40 characters in one line.
    #[serde(skip_serializing_if = "String::is_empty", deserialize_with = "present")]
    pub reference: String,
    /// Date of the visit, as 2026-01-31; 1900 to 2199.
    #[serde(skip_serializing_if = "String::is_empty", deserialize_with = "present")]
    pub date: String,
    /// The surgeon, up to 60 characters in one line.
    #[serde(skip_serializing_if = "String::is_empty", deserialize_with = "present")]
    pub surgeon: String,
    /// Remarks, up to 500 characters in up to 12 lines.
    #[serde(skip_serializing_if = "String::is_empty", deserialize_with = "present")]
    pub remarks: String,
    /// Schedule of the fills of an expander. Default: not stated.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    #[schemars(with = "FillSchedule")]
    pub fill_steps: Option<FillSchedule>,
}

/// The schedule of the fills of an expander.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "one JSON object")]
pub struct FillSchedule {
    /// Fill at operation \[ml\], 0 to 2000. Default: 100.
    #[serde(deserialize_with = "present")]
    pub start_ml: f64,
    /// Fill of a visit \[ml\], 5 to 500; the last visit fills the rest. Default: 50.
    #[serde(deserialize_with = "present")]
    pub visit_ml: f64,
    /// Time between visits \[weeks\], 0.5 to 12. Default: 1.
    #[serde(deserialize_with = "present")]
    pub weeks: f64,
}

impl FillSchedule {
    /// Allowed fills at operation \[ml\], fills of a visit \[ml\] and times between visits \[weeks\].
    pub const START_ML: (f64, f64) = (0.0, 2000.0);
    #[allow(missing_docs, reason = "described above")]
    pub const VISIT_ML: (f64, f64) = (5.0, 500.0);
    #[allow(missing_docs, reason = "described above")]
    pub const WEEKS: (f64, f64) = (0.5, 12.0);

    fn check(&self) -> Result<(), SceneError> {
        for (field, value, (least, most)) in [
            ("visit.fill_steps.start_ml", self.start_ml, Self::START_ML),
            ("visit.fill_steps.visit_ml", self.visit_ml, Self::VISIT_ML),
            ("visit.fill_steps.weeks", self.weeks, Self::WEEKS),
        ] {
            if !(least..=most).contains(&value) {
                return Err(out_of_range(field, value.to_string(), &format!("{least} to {most}")));
            }
        }
        Ok(())
    }
}

impl Default for FillSchedule {
    fn default() -> Self {
        Self { start_ml: 100.0, visit_ml: 50.0, weeks: 1.0 }
    }
}

/// The patient's side of the breast; a plan of both sides is drawn as that of the left one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs, reason = "a side is its own description")]
pub enum Side {
    Left,
    Right,
    Both,
}

impl Side {
    /// All sides.
    pub const ALL: [Self; 3] = [Self::Left, Self::Right, Self::Both];

    /// The side in a word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
            Self::Both => "both",
        }
    }

    /// The side in words, as "left side".
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Left => "left side",
            Self::Right => "right side",
            Self::Both => "both sides",
        }
    }
}

impl Visit {
    /// Does the visit state nothing?
    #[must_use]
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Checks texts and date.
    ///
    /// # Errors
    /// One line with the field, its value and what is allowed.
    pub(super) fn check(&self) -> Result<(), SceneError> {
        let Self { reference, date, surgeon, remarks, fill_steps } = self;
        fill_steps.as_ref().map_or(Ok(()), FillSchedule::check)?;
        check_line("visit.reference", reference, MAX_REFERENCE)?;
        if !(date.is_empty() || is_date(date)) {
            return Err(out_of_range("visit.date", one_line(&format!("{date:?}"), 40), DATE));
        }
        check_line("visit.surgeon", surgeon, MAX_SURGEON)?;
        check_length("visit.remarks", remarks, MAX_REMARKS)?;
        let lines = remarks.split('\n').count();
        if lines > MAX_REMARK_LINES {
            let allowed = format!("up to {MAX_REMARK_LINES} lines");
            return Err(out_of_range("visit.remarks", format!("{lines} lines long"), &allowed));
        }
        check_signs("visit.remarks", &remarks.replace('\n', " "))
    }
}

pub(super) fn check_line(field: &str, text: &str, most: usize) -> Result<(), SceneError> {
    check_length(field, text, most)?;
    check_signs(field, text)
}

fn check_length(field: &str, text: &str, most: usize) -> Result<(), SceneError> {
    let count = text.chars().count();
    if count <= most {
        return Ok(());
    }
    let allowed = format!("up to {most} characters");
    Err(out_of_range(field, format!("{count} characters long"), &allowed))
}

fn check_signs(field: &str, text: &str) -> Result<(), SceneError> {
    if text.contains(char::is_control) {
        let allowed = if field == "visit.remarks" {
            "text without control characters but line breaks (\\n)"
        } else {
            "text without line breaks and control characters"
        };
        return Err(out_of_range(field, one_line(text, 40), allowed));
    }
    Ok(())
}

/// Is the text a date of the calendar as 2026-01-31, from 1900 to 2199?
#[must_use]
pub fn is_date(text: &str) -> bool {
    let bytes = text.as_bytes();
    let number = |from: usize, to: usize| -> Option<u32> {
        let digits = bytes.get(from..to)?;
        digits.iter().try_fold(0, |sum, digit| {
            digit.is_ascii_digit().then(|| 10 * sum + u32::from(digit - b'0'))
        })
    };
    let [Some(year), Some(month), Some(day)] = [number(0, 4), number(5, 7), number(8, 10)] else {
        return false;
    };
    let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let days = match month {
        4 | 6 | 9 | 11 => 30,
        2 if is_leap => 29,
        2 => 28,
        _ => 31,
    };
    bytes.len() == 10
        && (bytes[4], bytes[7]) == (b'-', b'-')
        && (1900..2200).contains(&year)
        && (1..=12).contains(&month)
        && (1..=days).contains(&day)
}

impl Scene {
    /// The scene without its visit and its place on a body, for everything that leaves the plan's file: links, pins, stores.
    #[must_use]
    pub fn without_visit(&self) -> Self {
        let mut scene = Self { visit: None, placement: None, ..self.clone() };
        if let Some(other) = &mut scene.other_side {
            other.placement = None;
        }
        scene
    }

    /// Are two scenes equal but for their visits and for a place on a body that only one of them has?
    #[must_use]
    pub fn is_same_plan(&self, other: &Self) -> bool {
        let is_one_placed = self.placement.is_some() != other.placement.is_some();
        self == other
            || is_one_placed && self.without_visit() == other.without_visit()
            || self.visit != other.visit
                && Self { visit: other.visit.clone(), ..self.clone() } == *other
    }

    /// Is the breast the patient's right one? Numbers and coordinates are those of a left one; pictures and meshes are mirrored in x.
    #[must_use]
    pub fn is_right(&self) -> bool {
        self.side == Some(Side::Right)
    }

    /// Checks the visit.
    pub(super) fn check_visit(&self) -> Result<(), SceneError> {
        self.visit.as_ref().map_or(Ok(()), Visit::check)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{ChestGrid, ChestShape, HeightsGrid, ThicknessGrid};
    use serde_json::json;

    fn read(visit: &serde_json::Value) -> Result<Scene, String> {
        let scene = json!({ "implant": { "base_radius_mm": 60.0 }, "visit": visit });
        Scene::from_json(&scene.to_string()).map_err(|error| error.to_string())
    }

    #[test]
    fn a_visit_is_read_and_written_as_it_is() {
        let visit = json!({
            "reference": "K. M., 4711 <b>", "date": "2024-02-29", "surgeon": "Dr Ý",
            "remarks": "line one\nline two",
            "fill_steps": { "start_ml": 120.0, "visit_ml": 60.0, "weeks": 2.0 }
        });
        let scene = read(&visit).unwrap();
        let written: serde_json::Value = serde_json::from_str(&scene.to_json()).unwrap();
        assert_eq!(written["visit"], visit);
        assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
        let without = scene.without_visit();
        assert!(scene.same_physics(&without) && scene.is_same_plan(&without));
        assert!(scene != without && !without.to_json().contains("visit"));
        for edit in [
            |scene: &mut Scene| scene.insertion = 0.5,
            |scene: &mut Scene| scene.side = Some(Side::Right),
            |scene: &mut Scene| scene.layers[0].tissue.push('x'),
            |scene: &mut Scene| scene.patient = Some(crate::scene::Patient::default()),
            |scene: &mut Scene| scene.chest = Some(ChestShape::ROUND),
            |scene: &mut Scene| {
                let factors = [1.0; 16].into();
                let even = ThicknessGrid { spacing_mm: 10.0, columns: 4, rows: 4, factors };
                scene.thickness_field = Some(even);
            },
            |scene: &mut Scene| {
                let heights_mm = [Some(0.0); 16].into();
                let grid = HeightsGrid {
                    spacing_mm: 10.0,
                    columns: 4,
                    rows: 4,
                    heights_mm,
                    smooth_mm: 0.0,
                };
                scene.chest_grid = Some(ChestGrid { grid });
            },
        ] {
            let mut other = scene.clone();
            edit(&mut other);
            assert!(!other.is_same_plan(&scene));
        }
        // An absent field is not stated.
        assert!(read(&json!({})).unwrap().visit.is_some_and(|visit| visit.is_empty()));
    }

    #[test]
    fn the_side_stands_beside_the_visit_and_stays_in_links() {
        let file = |side: &str| {
            let json = format!(r#"{{"implant":{{"base_radius_mm":60}}{side}}}"#);
            Scene::from_json(&json).map_err(|error| error.to_string())
        };
        let scene = file(r#","side":"right""#).unwrap();
        let written: serde_json::Value = serde_json::from_str(&scene.to_json()).unwrap();
        assert_eq!(written["side"], "right");
        assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
        // A link and a pin keep the side; no solve depends on it.
        assert!(scene.is_right() && scene.without_visit().is_right());
        assert!(scene.same_physics(&file("").unwrap()));
        assert!(file(r#","side":"up""#).unwrap_err().starts_with("side: unknown variant `up`"));
        assert!(file(r#","side":null"#).unwrap_err().starts_with("side is null; allowed: "));
        assert_eq!(file("").unwrap().side, None);
    }

    #[test]
    fn an_invalid_visit_is_one_line_with_field_and_what_is_allowed() {
        let many = "\n".repeat(MAX_REMARK_LINES);
        for (visit, expected) in [
            (
                json!({ "reference": "é".repeat(41) }),
                "visit.reference is 41 characters long; allowed: up to 40",
            ),
            (
                json!({ "reference": "a\nb" }),
                "visit.reference is a b; allowed: text without line breaks",
            ),
            (
                json!({ "surgeon": "s".repeat(61) }),
                "visit.surgeon is 61 characters long; allowed: up to 60",
            ),
            (
                json!({ "remarks": "r".repeat(501) }),
                "visit.remarks is 501 characters long; allowed: up to 500",
            ),
            (json!({ "remarks": many }), "visit.remarks is 13 lines long; allowed: up to 12 lines"),
            (json!({ "remarks": "a\tb" }), "visit.remarks is a b; allowed: text without control"),
            (json!({ "date": "2026-02-30" }), "visit.date is \"2026-02-30\"; allowed: a date as"),
            (
                json!({ "fill_steps": { "visit_ml": 4.0 } }),
                "visit.fill_steps.visit_ml is 4; allowed: 5 to 500",
            ),
            (json!({ "fill_steps": { "weeks": 13 } }), "visit.fill_steps.weeks is 13; allowed"),
            (json!({ "fill_steps": null }), "visit.fill_steps is null; allowed: "),
            (json!({ "fill_steps": { "a": 1 } }), "visit.fill_steps.a: unknown field `a`"),
            (json!({ "name": "x" }), "visit.name: unknown field `name`"),
            (json!([]), "visit: invalid type: sequence, expected one JSON object"),
        ] {
            let error = read(&visit).unwrap_err();
            assert!(error.starts_with(expected) && !error.contains('\n'), "{error}");
        }
    }

    #[test]
    fn a_date_is_a_day_of_the_calendar() {
        for date in ["2026-01-31", "2024-02-29", "2000-02-29", "1900-01-01", "2199-12-31"] {
            assert!(is_date(date), "{date}");
        }
        for text in [
            "",
            "2026",
            "2026-1-31",
            "2026-13-01",
            "2026-00-01",
            "2026-04-31",
            "2025-02-29",
            "2100-02-29",
            "2026-01-00",
            "1899-12-31",
            "2200-01-01",
            "2026/01/31",
            "2026-01-311",
            "+026-01-31",
            "２026-01-31",
        ] {
            assert!(!is_date(text), "{text}");
        }
    }
}

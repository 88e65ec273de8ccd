//! Marks of a surgeon on a body's surface: a JSON object of points.

use glam::DVec3;
use implant_preview_solver::curve::given;
use serde::{Deserialize, Serialize};

/// The patient's side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs, reason = "a side is its own description")]
pub enum Side {
    Left,
    Right,
}

impl Side {
    /// The side in a word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }

    /// +1 towards the patient's left, −1 towards the right.
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

impl std::str::FromStr for Side {
    type Err = MarksError;

    fn from_str(word: &str) -> Result<Self, MarksError> {
        let found = [Self::Left, Self::Right].into_iter().find(|side| side.word() == word);
        let wrong = || format!("side is \"{word}\"; allowed: \"left\" or \"right\"");
        found.ok_or_else(|| MarksError(wrong()))
    }
}

/// Marks of one breast, in the surface's coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BreastMarks {
    /// Lowest point of the fold under the breast.
    pub fold: DVec3,
    /// Upper end of the breast.
    pub upper: DVec3,
    /// End of the breast towards the midline.
    pub medial: DVec3,
    /// End of the breast towards the flank.
    pub lateral: DVec3,
    /// Centre of the planned implant's base on the skin; `None`: proposed ([`Marks::implant_centre`]).
    pub implant_centre: Option<DVec3>,
}

/// Marks of a body, in the surface's coordinates; at least one breast has its own.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "MarksFile", into = "MarksFile")]
pub struct Marks {
    /// The notch above the breastbone.
    pub sternal_notch: DVec3,
    /// The navel.
    pub navel: DVec3,
    /// Nipples, the left one first.
    pub nipples: [DVec3; 2],
    /// Marks of the breasts, the left one first.
    pub breasts: [Option<BreastMarks>; 2],
}

/// Why marks are rejected, in one line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct MarksError(String);

/// Names of the marks in a file but for the implant's centres: both breasts', then those of the left and of the right breast.
pub const NAMES: [&str; 12] = [
    "sternal_notch",
    "navel",
    "nipple_left",
    "nipple_right",
    "fold_left",
    "upper_left",
    "medial_left",
    "lateral_left",
    "fold_right",
    "upper_right",
    "medial_right",
    "lateral_right",
];
/// Greatest coordinate of a mark.
const GREATEST: f64 = 1e7;
/// Least and greatest height of the implant's lower edge over the fold in a proposed plan \[mm\].
const EDGE_ABOVE_FOLD_MM: [f64; 2] = [-14.0, 5.0];

type Point = Option<[f64; 3]>;

/// Marks in a file.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "one JSON object of points [x, y, z]")]
#[allow(clippy::missing_docs_in_private_items, reason = "names of the marks")]
struct MarksFile {
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    sternal_notch: Point,
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    navel: Point,
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    nipple_left: Point,
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    nipple_right: Point,
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    fold_left: Point,
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    upper_left: Point,
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    medial_left: Point,
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    lateral_left: Point,
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    implant_centre_left: Point,
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    fold_right: Point,
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    upper_right: Point,
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    medial_right: Point,
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    lateral_right: Point,
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    implant_centre_right: Point,
}

/// The point of a mark.
fn point(name: &str, side: &str, point: Point) -> Result<DVec3, MarksError> {
    let Some(at) = point else {
        return Err(MarksError(format!("{name}{side} is missing; allowed: a point [x, y, z]")));
    };
    if at.iter().any(|x| x.is_nan() || x.abs() > GREATEST) {
        let [x, y, z] = at;
        let words = format!("{name}{side} is [{x}, {y}, {z}]; allowed: numbers up to {GREATEST}");
        return Err(MarksError(words));
    }
    Ok(at.into())
}

impl TryFrom<MarksFile> for Marks {
    type Error = MarksError;

    fn try_from(file: MarksFile) -> Result<Self, MarksError> {
        let left = [file.fold_left, file.upper_left, file.medial_left, file.lateral_left];
        let right = [file.fold_right, file.upper_right, file.medial_right, file.lateral_right];
        let breast = |side: &str, [fold, upper, medial, lateral]: [Point; 4], centre: Point| {
            if [fold, upper, medial, lateral, centre].iter().all(Option::is_none) {
                return Ok(None);
            }
            Ok(Some(BreastMarks {
                fold: point("fold", side, fold)?,
                upper: point("upper", side, upper)?,
                medial: point("medial", side, medial)?,
                lateral: point("lateral", side, lateral)?,
                implant_centre: match centre {
                    None => None,
                    given => Some(point("implant_centre", side, given)?),
                },
            }))
        };
        Ok(Self {
            sternal_notch: point("sternal_notch", "", file.sternal_notch)?,
            navel: point("navel", "", file.navel)?,
            nipples: [
                point("nipple", "_left", file.nipple_left)?,
                point("nipple", "_right", file.nipple_right)?,
            ],
            breasts: [
                breast("_left", left, file.implant_centre_left)?,
                breast("_right", right, file.implant_centre_right)?,
            ],
        })
    }
}

impl From<Marks> for MarksFile {
    fn from(marks: Marks) -> Self {
        let [left, right] = marks.breasts;
        let of = |breast: Option<BreastMarks>, mark: fn(&BreastMarks) -> DVec3| {
            breast.map(|breast| mark(&breast).to_array())
        };
        let centre = |breast: Option<BreastMarks>| Some(breast?.implant_centre?.to_array());
        Self {
            sternal_notch: Some(marks.sternal_notch.to_array()),
            navel: Some(marks.navel.to_array()),
            nipple_left: Some(marks.nipples[0].to_array()),
            nipple_right: Some(marks.nipples[1].to_array()),
            fold_left: of(left, |b| b.fold),
            upper_left: of(left, |b| b.upper),
            medial_left: of(left, |b| b.medial),
            lateral_left: of(left, |b| b.lateral),
            implant_centre_left: centre(left),
            fold_right: of(right, |b| b.fold),
            upper_right: of(right, |b| b.upper),
            medial_right: of(right, |b| b.medial),
            lateral_right: of(right, |b| b.lateral),
            implant_centre_right: centre(right),
        }
    }
}

/// Directions of a body from its marks, as unit vectors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyAxes {
    /// Towards the patient's left.
    pub across: DVec3,
    /// Towards the head.
    pub head: DVec3,
    /// Forwards.
    pub front: DVec3,
}

impl Marks {
    /// The marks in another unit of length.
    #[must_use]
    pub fn scaled(&self, factor: f64) -> Self {
        self.mapped(|point| point * factor)
    }

    /// The marks after a map of their points.
    #[must_use]
    pub fn mapped(&self, map: impl Fn(DVec3) -> DVec3) -> Self {
        let breast = |breast: BreastMarks| BreastMarks {
            fold: map(breast.fold),
            upper: map(breast.upper),
            medial: map(breast.medial),
            lateral: map(breast.lateral),
            implant_centre: breast.implant_centre.map(&map),
        };
        Self {
            sternal_notch: map(self.sternal_notch),
            navel: map(self.navel),
            nipples: self.nipples.map(&map),
            breasts: self.breasts.map(|found| found.map(breast)),
        }
    }

    /// The marks of a breast.
    ///
    /// # Errors
    /// The breast has no marks.
    pub fn breast(&self, side: Side) -> Result<&BreastMarks, MarksError> {
        let word = side.word();
        let words = format!(
            "no marks of the {word} breast; allowed: fold_{word}, upper_{word}, medial_{word}, lateral_{word}"
        );
        self.breasts[side as usize].as_ref().ok_or(MarksError(words))
    }

    /// The nipple of a side.
    #[must_use]
    pub fn nipple(&self, side: Side) -> DVec3 {
        self.nipples[side as usize]
    }

    /// The marks that a side needs, with their names in a file; those of the navel and the notch last.
    ///
    /// # Errors
    /// The breast has no marks.
    pub fn named(&self, side: Side) -> Result<Vec<(String, DVec3)>, MarksError> {
        let BreastMarks { fold, upper, medial, lateral, implant_centre } = *self.breast(side)?;
        let nipple = self.nipple(side);
        let own = [
            ("nipple", nipple),
            ("fold", fold),
            ("upper", upper),
            ("medial", medial),
            ("lateral", lateral),
        ];
        let centre = implant_centre.map(|centre| ("implant_centre", centre));
        let own = own.into_iter().chain(centre);
        let common = [("sternal_notch", self.sternal_notch), ("navel", self.navel)];
        Ok(own
            .map(|(name, at)| (format!("{name}_{}", side.word()), at))
            .chain(common.map(|(name, at)| (name.to_owned(), at)))
            .collect())
    }

    /// The body's axes: towards the head from navel to notch, across from the right to the left nipple without its part along the head.
    ///
    /// # Errors
    /// Marks at one place.
    pub fn axes(&self) -> Result<BodyAxes, MarksError> {
        let same = |names: &str| MarksError(format!("{names} are at one place"));
        let head = (self.sternal_notch - self.navel).try_normalize();
        let head = head.ok_or_else(|| same("sternal_notch and navel"))?;
        let across = (self.nipples[0] - self.nipples[1]).reject_from_normalized(head);
        let across = across.try_normalize().ok_or_else(|| same("nipple_left and nipple_right"))?;
        Ok(BodyAxes { across, head, front: across.cross(head) })
    }

    /// Checks the order of the marks that a side needs.
    ///
    /// # Errors
    /// One line with the two marks in the wrong order.
    pub fn check(&self, side: Side) -> Result<(), MarksError> {
        let (BodyAxes { across, head, front }, breast) = (self.axes()?, *self.breast(side)?);
        let (word, outwards) = (side.word(), across * side.sign());
        let nipple = self.nipple(side);
        let is_after = |a: DVec3, b: DVec3, way: DVec3| (a - b).dot(way) > 0.0;
        let middle = self.nipples[0].midpoint(self.nipples[1]);
        let is_aside = |centre: DVec3| is_after(centre, middle, outwards);
        let wrong = [
            (
                is_after(breast.upper, breast.fold, head),
                format!("upper_{word} is below fold_{word} in the direction from navel to notch"),
            ),
            (
                is_after(self.sternal_notch, nipple, head),
                format!("sternal_notch is below nipple_{word}"),
            ),
            (is_after(nipple, self.navel, head), format!("navel is above nipple_{word}")),
            (
                is_after(breast.lateral, breast.medial, outwards),
                format!(
                    "lateral_{word} is nearer to the midline than medial_{word}, or the marks are those of the other side"
                ),
            ),
            (
                is_after(breast.medial, breast.lateral, front),
                format!("medial_{word} is behind lateral_{word}: left and right are exchanged"),
            ),
            (
                breast.implant_centre.is_none_or(is_aside),
                format!("implant_centre_{word} is on the other side of the midline"),
            ),
        ];
        match wrong.into_iter().find(|(is_right, _)| !is_right) {
            Some((_, words)) => Err(MarksError(format!("marks in the wrong order: {words}"))),
            None => Ok(()),
        }
    }

    /// Centre of the implant: marked, or proposed on the middle of the breast's width as high as the nipple, on no surface (a fit moves it to
    /// the middle as seen along the chest's normal). The lower edge of its base then lies at most 5 mm above the fold, and at most 14 mm
    /// below it: by so much folds drop within six months (Eder, J Plast Reconstr Aesthet Surg, 2011).
    ///
    /// # Errors
    /// The breast has no marks.
    pub fn implant_centre(&self, side: Side, base_radius_mm: f64) -> Result<DVec3, MarksError> {
        let breast = self.breast(side)?;
        if let Some(centre) = breast.implant_centre {
            return Ok(centre);
        }
        let BodyAxes { across, head, front } = self.axes()?;
        let middle = 0.5 * (breast.medial + breast.lateral);
        let (nipple, fold) = (self.nipple(side), breast.fold.dot(head));
        let [least, most] = EDGE_ABOVE_FOLD_MM.map(|edge| fold + edge + base_radius_mm);
        let height = nipple.dot(head).clamp(least, most);
        let depth = nipple.dot(front).max(middle.dot(front));
        Ok(across * middle.dot(across) + head * height + front * depth)
    }

    /// Distance from the notch to the nipple of a side.
    #[must_use]
    pub fn notch_nipple(&self, side: Side) -> f64 {
        self.sternal_notch.distance(self.nipple(side))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEFT: &str = r#"{ "sternal_notch": [0, 500, 90], "navel": [0, 120, 154], "nipple_left": [113, 347, 180],
        "nipple_right": [-113, 347, 180], "fold_left": [108, 300, 120], "upper_left": [80, 441, 124],
        "medial_left": [24, 346, 152], "lateral_left": [140, 371, 85] }"#;

    #[test]
    fn marks_are_read_and_written() {
        let marks: Marks = serde_json::from_str(LEFT).unwrap();
        assert_eq!(marks.breast(Side::Left).unwrap().upper, DVec3::new(80.0, 441.0, 124.0));
        assert_eq!(marks.check(Side::Left), Ok(()));
        let text = serde_json::to_string(&marks).unwrap();
        assert!(!text.contains("right\":null") && !text.contains("implant_centre"), "{text}");
        assert_eq!(serde_json::from_str::<Marks>(&text).unwrap(), marks);
        let axes = marks.axes().unwrap();
        assert!(axes.across.distance(DVec3::X) < 1e-12 && axes.front.z > 0.9);
        // Proposed as high and as far forward as the nipple, with an edge near the fold.
        let (fold, nipple) = (marks.breasts[0].unwrap().fold, marks.nipples[0]);
        let of_nipple = (nipple - fold).dot(axes.head);
        assert!((36.0..37.0).contains(&of_nipple), "{of_nipple}");
        for (base_radius_mm, above_fold) in [(40.0, of_nipple), (30.0, 35.0), (60.0, 46.0)] {
            let centre = marks.implant_centre(Side::Left, base_radius_mm).unwrap();
            assert!(((centre - fold).dot(axes.head) - above_fold).abs() < 1e-9, "{above_fold}");
            assert!((centre.x - 82.0).abs() < 1e-9);
            assert!((centre - nipple).dot(axes.front).abs() < 1e-9);
        }
        let distance = marks.scaled(0.1).notch_nipple(Side::Left);
        assert!((10.0 * distance - marks.notch_nipple(Side::Left)).abs() < 1e-9);
    }

    #[test]
    fn bad_marks_are_one_line() {
        let line = |from: &str, to: &str| {
            let text = LEFT.replacen(from, to, 1);
            assert_ne!(text, LEFT, "{from}");
            let line = serde_json::from_str::<Marks>(&text).unwrap_err().to_string();
            assert!(!line.contains('\n') && line.len() < 400, "{line}");
            line
        };
        for (from, to, expected) in [
            ("navel", "nabel", "unknown field `nabel`, expected one of `sternal_notch`, `navel`"),
            (r#""navel": [0, 120, 154],"#, "", "navel is missing; allowed: a point [x, y, z]"),
            (r#", "lateral_left": [140, 371, 85]"#, "", "lateral_left is missing"),
            ("500", "2e7", "sternal_notch is [0, 20000000, 90]; allowed: numbers up to 10000000"),
            ("navel", "sternal_notch", "duplicate field `sternal_notch`"),
        ] {
            let found = line(from, to);
            assert!(found.contains(expected), "{found}");
        }
    }
}

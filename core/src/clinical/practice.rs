//! The practice table: the volume that a common rule of practice takes for a breast, by base width, pull of the skin, nipple–fold
//! distance under stretch, and how much of the stretched envelope the breast fills.
//!
//! The table is data with a source: a clinic edits it as a CSV ([`PracticeTable::to_csv`], [`PracticeTable::from_csv`]).

use super::{Measurements, SkinClass};

/// Step of the rule \[ml\]: volumes within a step of practice's are those of practice.
pub const STEP_ML: f64 = 30.0;

/// Where the built-in table comes from.
pub const BUILT_IN_SOURCE: &str = "Tebbetts and Adams, Plast Reconstr Surg 116, 2005 (five measurements; 1664 cases, 3 % \
    reoperations by their own count), as commonly printed; check against your copy";

/// Rows of the built-in table: base width \[mm\] and volume \[ml\].
const STARTS: [[f64; 2]; 10] = [
    [105.0, 200.0],
    [110.0, 250.0],
    [115.0, 275.0],
    [120.0, 300.0],
    [125.0, 300.0],
    [130.0, 325.0],
    [135.0, 350.0],
    [140.0, 375.0],
    [145.0, 375.0],
    [150.0, 400.0],
];

/// A measurement that corrects the volume.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Corrected {
    /// Anterior pull of the skin \[mm\].
    Pull,
    /// Nipple–fold distance under stretch \[mm\].
    Fold,
    /// Part of the stretched envelope that the breast fills \[%\].
    Fill,
}

impl Corrected {
    /// All of them, in the order of the table.
    pub const ALL: [Self; 3] = [Self::Pull, Self::Fold, Self::Fill];

    fn row(self) -> (&'static str, &'static str) {
        match self {
            Self::Pull => ("pull", "pull of the skin"),
            Self::Fold => ("fold", "nipple–fold distance under stretch"),
            Self::Fill => ("fill", "envelope filled by the breast"),
        }
    }

    /// Name in a table.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().0
    }

    /// The measurement in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        self.row().1
    }

    /// The measured value, if there is one. A class is the middle of its pulls.
    pub(crate) fn value(self, measured: &Measurements) -> Option<f64> {
        match self {
            Self::Pull => measured.skin_pull_mm.or(measured.skin_class.map(SkinClass::pull_mm)),
            Self::Fold => measured.fold_stretched_mm,
            Self::Fill => measured.envelope_fill.map(EnvelopeFill::percent),
        }
    }
}

/// How much of the envelope, stretched by the planned implant, the existing breast fills.
#[derive(
    Clone,
    Copy,
    Debug,
    PartialEq,
    Eq,
    Hash,
    serde::Serialize,
    serde::Deserialize,
    schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum EnvelopeFill {
    /// Less than 20 %.
    Little,
    /// 20 to 80 %.
    Usual,
    /// More than 80 %.
    Much,
}

impl EnvelopeFill {
    /// All of them, from the least.
    pub const ALL: [Self; 3] = [Self::Little, Self::Usual, Self::Much];

    /// Word and middle of the class \[%\].
    fn row(self) -> (&'static str, f64) {
        match self {
            Self::Little => ("little", 10.0),
            Self::Usual => ("usual", 50.0),
            Self::Much => ("much", 90.0),
        }
    }

    /// The class in a word.
    #[must_use]
    pub fn word(self) -> &'static str {
        self.row().0
    }

    /// The middle of the class \[%\].
    fn percent(self) -> f64 {
        self.row().1
    }
}

/// On which side of its limit a correction counts, the limit itself excluded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bound {
    /// Values below the limit.
    Below,
    /// Values above the limit.
    Above,
}

/// A correction of the volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// The measurement.
    pub of: Corrected,
    /// The side of the limit.
    pub bound: Bound,
    /// The limit \[mm or %\].
    pub limit: f64,
    /// The correction \[ml\].
    pub volume_ml: f64,
}

/// Start volumes by base width, and corrections.
#[derive(Clone, Debug, PartialEq)]
pub struct PracticeTable {
    /// Base width \[mm\] and volume \[ml\], widths rising.
    pub(super) starts: Vec<[f64; 2]>,
    pub(super) corrections: Vec<Correction>,
    /// Where the numbers come from.
    pub(super) source: String,
}

impl Default for PracticeTable {
    /// The built-in table.
    fn default() -> Self {
        let correction = |of, bound, limit, volume_ml| Correction { of, bound, limit, volume_ml };
        Self {
            starts: STARTS.to_vec(),
            corrections: vec![
                correction(Corrected::Pull, Bound::Below, 20.0, -STEP_ML),
                correction(Corrected::Pull, Bound::Above, 30.0, STEP_ML),
                correction(Corrected::Pull, Bound::Above, 40.0, 2.0 * STEP_ML),
                correction(Corrected::Fold, Bound::Above, 95.0, STEP_ML),
                correction(Corrected::Fill, Bound::Below, 20.0, STEP_ML),
                correction(Corrected::Fill, Bound::Above, 80.0, -STEP_ML),
            ],
            source: BUILT_IN_SOURCE.to_owned(),
        }
    }
}

/// The volume that practice takes, with its parts.
#[derive(Clone, Debug, PartialEq)]
pub struct PracticeVolume {
    /// Volume by the base width alone \[ml\].
    pub start_ml: f64,
    /// The corrections that apply.
    pub corrections: Vec<Correction>,
}

impl PracticeVolume {
    /// Start volume with its corrections \[ml\].
    #[must_use]
    pub fn volume_ml(&self) -> f64 {
        self.start_ml + self.corrections.iter().map(|it| it.volume_ml).sum::<f64>()
    }
}

impl PracticeTable {
    /// Where the numbers come from, in up to 300 characters.
    #[must_use]
    pub fn source(&self) -> &str {
        &self.source
    }

    /// Is this the built-in table?
    #[must_use]
    pub fn is_built_in(&self) -> bool {
        *self == Self::default()
    }

    /// Least and greatest base width of the table \[mm\].
    #[must_use]
    pub fn widths_mm(&self) -> (f64, f64) {
        let width = |row: Option<&[f64; 2]>| row.map_or(0.0, |row| row[0]);
        (width(self.starts.first()), width(self.starts.last()))
    }

    /// Base width \[mm\] and start volume \[ml\] of each row.
    #[must_use]
    pub fn starts(&self) -> &[[f64; 2]] {
        &self.starts
    }

    /// The corrections in the order of the table.
    #[must_use]
    pub fn corrections(&self) -> &[Correction] {
        &self.corrections
    }

    /// The volume for a base width \[mm\] and measurements: linear between the rows, `None` outside of their widths. Of the
    /// corrections of one measurement and side the one with the farthest limit that is exceeded counts.
    #[must_use]
    pub fn volume(&self, base_width_mm: f64, measured: &Measurements) -> Option<PracticeVolume> {
        let start_ml = self.start_ml(base_width_mm)?;
        let mut corrections = Vec::new();
        for of in Corrected::ALL {
            let Some(value) = of.value(measured) else { continue };
            for bound in [Bound::Below, Bound::Above] {
                let exceeds = |it: &&Correction| match bound {
                    Bound::Below => value < it.limit,
                    Bound::Above => value > it.limit,
                };
                let of_bound =
                    self.corrections.iter().filter(|it| it.of == of && it.bound == bound);
                let farthest = of_bound
                    .filter(exceeds)
                    .min_by(|a, b| (a.limit - value).abs().total_cmp(&(b.limit - value).abs()));
                corrections.extend(farthest.copied());
            }
        }
        Some(PracticeVolume { start_ml, corrections })
    }

    fn start_ml(&self, base_width_mm: f64) -> Option<f64> {
        // A width of a row may be off by a rounding error.
        let is_row = |row: &&[f64; 2]| (row[0] - base_width_mm).abs() < 1e-6;
        if let Some([_, volume]) = self.starts.iter().find(is_row) {
            return Some(*volume);
        }
        let is_between =
            |pair: &&[[f64; 2]]| pair[0][0] < base_width_mm && base_width_mm < pair[1][0];
        let pair = self.starts.windows(2).find(is_between)?;
        let [[from, low], [to, high]] = [pair[0], pair[1]];
        Some(low + (high - low) * (base_width_mm - from) / (to - from))
    }
}

/// Greatest length of the source \[characters\].
const SOURCE_CHARACTERS: usize = 300;

/// A source as it stands in a table: one line of up to [`SOURCE_CHARACTERS`].
pub(super) fn source_of(text: &str) -> String {
    let is_space = |letter: char| letter.is_whitespace() || letter.is_control();
    let words: Vec<&str> = text.split(is_space).filter(|word| !word.is_empty()).collect();
    words.join(" ").chars().take(SOURCE_CHARACTERS).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tenths of a millilitre.
    fn volume(width: f64, measured: &Measurements) -> Option<i32> {
        let volume = PracticeTable::default().volume(width, measured)?;
        Some((10.0 * volume.volume_ml()).round() as i32)
    }

    #[test]
    fn the_rule_gives_the_printed_volumes_and_is_linear_between_them() {
        let none = Measurements::default();
        let printed = [200, 250, 275, 300, 300, 325, 350, 375, 375, 400];
        for (k, expected) in printed.into_iter().enumerate() {
            assert_eq!(volume(105.0 + 5.0 * k as f64, &none), Some(10 * expected));
        }
        assert_eq!(volume(107.5, &none), Some(2250));
        assert_eq!(volume(132.0, &none), Some(3350));
        assert_eq!((volume(104.9, &none), volume(150.1, &none)), (None, None));
        assert_eq!(volume(f64::NAN, &none), None);
        // A width from a radius in cm.
        assert_eq!(volume(2.0 * (10.0 * 6.0), &none), Some(3000));
    }

    #[test]
    fn corrections_follow_pull_class_fold_and_fill() {
        let of = |measured: Measurements| volume(120.0, &measured).unwrap();
        let pull = |mm: f64| of(Measurements { skin_pull_mm: Some(mm), ..Measurements::default() });
        let pulls = [19.9, 20.0, 30.0, 30.1, 40.0, 40.1].map(pull);
        assert_eq!(pulls, [2700, 3000, 3000, 3300, 3300, 3600]);
        let class = |class| of(Measurements { skin_class: Some(class), ..Measurements::default() });
        assert_eq!(SkinClass::ALL.map(class), [2700, 3000, 3300, 3600]);
        let fold =
            |mm: f64| of(Measurements { fold_stretched_mm: Some(mm), ..Measurements::default() });
        assert_eq!([95.0, 95.5].map(fold), [3000, 3300]);
        let fill = |fill| of(Measurements { envelope_fill: Some(fill), ..Measurements::default() });
        assert_eq!(EnvelopeFill::ALL.map(fill), [3300, 3000, 2700]);
        let all = Measurements {
            skin_class: Some(SkinClass::VeryLax),
            fold_stretched_mm: Some(100.0),
            envelope_fill: Some(EnvelopeFill::Much),
            ..Measurements::default()
        };
        let parts = PracticeTable::default().volume(120.0, &all).unwrap();
        assert_eq!((parts.corrections.len(), volume(120.0, &all)), (3, Some(3600)));
    }
}

//! The time after an operation: what of the skin's tension has relaxed, what of its stretch has grown, how far the fold has moved.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A time after the operation.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum When {
    /// Within the hour, as every result without a state of the skin.
    OnTheTable,
    /// After a week.
    Week,
    /// From the third month on.
    SixMonths,
}

/// A number that a time gives, with its spread between people.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Expected {
    /// The middle.
    pub value: f64,
    /// One standard deviation; null where the source has none.
    pub deviation: Option<f64>,
}

impl Expected {
    const fn known(value: f64) -> Self {
        Self { value, deviation: Some(0.0) }
    }

    const fn within(value: f64, deviation: f64) -> Self {
        Self { value, deviation: Some(deviation) }
    }

    /// The value, and the values a standard deviation below and above, within limits.
    #[must_use]
    pub fn range(self, (least, most): (f64, f64)) -> [f64; 2] {
        let deviation = self.deviation.unwrap_or(0.0);
        [self.value - deviation, self.value + deviation].map(|value| value.clamp(least, most))
    }
}

impl When {
    /// All times.
    pub const ALL: [Self; 3] = [Self::OnTheTable, Self::Week, Self::SixMonths];

    /// The time in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::OnTheTable => "on the table",
            Self::Week => "after a week",
            Self::SixMonths => "after six months",
        }
    }

    /// What is left of the skin's tension above the natural one, by relaxation within hours to days \[-\].
    #[must_use]
    pub fn relaxed(self) -> Expected {
        match self {
            Self::OnTheTable => Expected::known(1.0),
            Self::Week | Self::SixMonths => Expected::within(0.5, 0.1),
        }
    }

    /// Fraction of the skin's stretch that has become growth \[-\].
    #[must_use]
    pub fn grown(self) -> Expected {
        match self {
            Self::OnTheTable => Expected::known(0.0),
            Self::Week => Expected::within(0.3, 0.2),
            Self::SixMonths => Expected::within(0.8, 0.2),
        }
    }

    /// How far the inframammary fold has moved down \[mm\]; no computed shape has it.
    #[must_use]
    pub fn fold_drop_mm(self) -> Expected {
        match self {
            Self::OnTheTable => Expected::known(0.0),
            Self::Week => Expected { value: 0.0, deviation: None },
            Self::SixMonths => Expected { value: 14.0, deviation: None },
        }
    }

    /// Where the numbers are from.
    #[must_use]
    pub fn source(self) -> &'static str {
        match self {
            Self::OnTheTable => "within the hour nothing has relaxed or grown",
            Self::Week => {
                "relaxation: excised skin of dogs and pigs loses 39 to 54 % of its stress (abstracts); growth: an estimate \
                 between skin under expanders in dogs, 34 % in 2 weeks, and no growth"
            }
            Self::SixMonths => {
                "relaxation as after a week; growth: an estimate, 85 % of the changes after augmentation are over in the first \
                 month (Eder et al. 2011, 14 women; Ji et al. 2014, 13 women; abstracts); fold: 14 mm lower by month 6 (Eder et \
                 al. 2011, no spread in the abstract)"
            }
        }
    }
}

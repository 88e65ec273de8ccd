//! The figures of a result that a study compares.

use crate::measure::bands::{Limits, PRESSURE, RESERVE, strain_limits};
use crate::measure::{MMHG_PER_KPA, Outcome};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A figure of a result. Names in files: snake case, with the unit at the end.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Greatest principal strain of the skin \[-\].
    GreatestStrain,
    /// Fraction of the skin over the pocket whose strain is above 0.25 \[-\].
    #[serde(rename = "area_over_25")]
    AreaOver25,
    /// Fraction of the skin over the pocket whose strain is above 0.50 \[-\].
    #[serde(rename = "area_over_50")]
    AreaOver50,
    /// Mean contact pressure \[mmHg\].
    MeanPressureMmhg,
    /// Greatest contact pressure \[mmHg\].
    GreatestPressureMmhg,
    /// Mean contact pressure \[kPa\].
    MeanPressureKpa,
    /// Greatest contact pressure \[kPa\].
    GreatestPressureKpa,
    /// Vertical force between implant and tissue \[N\].
    ForceN,
    /// Greatest principal stress of the skin \[kPa\].
    SkinStressKpa,
    /// Layered tissue: least thickness of the tissue over the implant \[mm\].
    LeastCoverMm,
    /// Layered tissue: thickness of the tissue over the implant's highest point \[mm\].
    ApexCoverMm,
    /// Height of the outer skin surface above the wall \[mm\].
    SkinProjectionMm,
    /// Area gained by the skin over the pocket, relative to its area at rest \[-\].
    SkinAreaGain,
    /// Area gained by the skin over the pocket \[cm²\].
    SkinAreaGainCm2,
    /// Layered tissue: greatest pull of the attachment around the pocket \[kPa\].
    AttachmentTractionKpa,
    /// Volume of the implant \[ml\].
    ImplantVolumeMl,
    /// Skin that wrinkles: greatest strain / strain at which the skin's curve turns steep \[-\].
    SkinReserveUsed,
}

/// Name, label, unit in files, factor and unit on display.
struct Words(&'static str, &'static str, &'static str, f64, &'static str);

impl Quantity {
    /// Number of quantities.
    pub const COUNT: usize = 17;

    /// All quantities.
    pub const ALL: [Self; Self::COUNT] = [
        Self::GreatestStrain,
        Self::AreaOver25,
        Self::AreaOver50,
        Self::MeanPressureMmhg,
        Self::GreatestPressureMmhg,
        Self::MeanPressureKpa,
        Self::GreatestPressureKpa,
        Self::ForceN,
        Self::SkinStressKpa,
        Self::LeastCoverMm,
        Self::ApexCoverMm,
        Self::SkinProjectionMm,
        Self::SkinAreaGain,
        Self::SkinAreaGainCm2,
        Self::AttachmentTractionKpa,
        Self::ImplantVolumeMl,
        Self::SkinReserveUsed,
    ];

    fn words(self) -> Words {
        match self {
            Self::GreatestStrain => {
                Words("greatest_strain", "greatest stretch of the skin", "", 100.0, "%")
            }
            Self::AreaOver25 => {
                Words("area_over_25", "skin stretched by more than 25 %", "", 100.0, "%")
            }
            Self::AreaOver50 => {
                Words("area_over_50", "skin stretched by more than 50 %", "", 100.0, "%")
            }
            Self::MeanPressureMmhg => {
                Words("mean_pressure_mmhg", "mean contact pressure", "mmHg", 1.0, "mmHg")
            }
            Self::GreatestPressureMmhg => {
                Words("greatest_pressure_mmhg", "greatest contact pressure", "mmHg", 1.0, "mmHg")
            }
            Self::MeanPressureKpa => {
                Words("mean_pressure_kpa", "mean contact pressure", "kPa", 1.0, "kPa")
            }
            Self::GreatestPressureKpa => {
                Words("greatest_pressure_kpa", "greatest contact pressure", "kPa", 1.0, "kPa")
            }
            Self::ForceN => Words("force_n", "contact force", "N", 1.0, "N"),
            Self::SkinStressKpa => {
                Words("skin_stress_kpa", "greatest stress of the skin", "kPa", 1.0, "kPa")
            }
            Self::LeastCoverMm => Words("least_cover_mm", "least cover", "mm", 1.0, "mm"),
            Self::ApexCoverMm => Words("apex_cover_mm", "cover at the apex", "mm", 1.0, "mm"),
            Self::SkinProjectionMm => {
                Words("skin_projection_mm", "projection of the skin", "mm", 1.0, "mm")
            }
            Self::SkinAreaGain => {
                Words("skin_area_gain", "area gained by the skin", "", 100.0, "%")
            }
            Self::SkinAreaGainCm2 => {
                Words("skin_area_gain_cm2", "area gained by the skin", "cm²", 1.0, "cm²")
            }
            Self::AttachmentTractionKpa => Words(
                "attachment_traction_kpa",
                "greatest pull of the attachment",
                "kPa",
                1.0,
                "kPa",
            ),
            Self::ImplantVolumeMl => {
                Words("implant_volume_ml", "volume of the implant", "ml", 1.0, "ml")
            }
            Self::SkinReserveUsed => {
                Words("skin_reserve_used", "share of the skin's reserve", "", 100.0, "%")
            }
        }
    }

    /// The name in files and arguments.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.words().0
    }

    /// The quantity of a name.
    ///
    /// # Errors
    /// One line with the allowed names.
    pub fn of_name(name: &str) -> Result<Self, String> {
        let named = Self::ALL.into_iter().find(|quantity| quantity.name() == name);
        named.ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            format!("{:?} is not a quantity; allowed: {names}", short(name))
        })
    }

    /// The quantity in words, without its unit.
    #[must_use]
    pub fn label(self) -> &'static str {
        self.words().1
    }

    /// Unit of the values; empty for fractions.
    #[must_use]
    pub fn unit(self) -> &'static str {
        self.words().2
    }

    /// Factor from a value to the displayed number, and the displayed unit: fractions are displayed in %.
    #[must_use]
    pub fn display(self) -> (f64, &'static str) {
        let Words(.., factor, unit) = self.words();
        (factor, unit)
    }

    /// The limits with words and sources, if the quantity has any, and the factor from a value to the unit of the limits.
    /// `knee`: strain at which the curve of the skin turns steep \[-\], if the skin has a reserve
    /// ([`Scene::skin_knee`](crate::scene::Scene::skin_knee)).
    #[must_use]
    pub fn limits(self, knee: Option<f64>) -> Option<(&'static Limits, f64)> {
        match self {
            Self::GreatestStrain => Some(strain_limits(knee)),
            Self::SkinReserveUsed => Some((&RESERVE, 1.0)),
            Self::MeanPressureMmhg | Self::GreatestPressureMmhg => Some((&PRESSURE, 1.0)),
            Self::MeanPressureKpa | Self::GreatestPressureKpa => Some((&PRESSURE, MMHG_PER_KPA)),
            _ => None,
        }
    }

    /// The value in a result; `None` if the result does not contain the quantity.
    #[must_use]
    pub fn of(self, outcome: &Outcome) -> Option<f64> {
        let fraction = |limit: &str| outcome.strain.as_ref()?.fraction_above.get(limit).copied();
        let value = match self {
            Self::GreatestStrain => outcome.strain.as_ref()?.max_principal,
            Self::AreaOver25 => fraction("0.25")?,
            Self::AreaOver50 => fraction("0.50")?,
            Self::MeanPressureMmhg => outcome.contact_pressure_mmhg?.mean,
            Self::GreatestPressureMmhg => outcome.contact_pressure_mmhg?.max,
            Self::MeanPressureKpa => outcome.contact_pressure_kpa?.mean,
            Self::GreatestPressureKpa => outcome.contact_pressure_kpa?.max,
            Self::ForceN => outcome.contact_force_n?,
            Self::SkinStressKpa => outcome.layers.first()?.max_stress_kpa?,
            Self::LeastCoverMm => outcome.cover_mm?.least,
            Self::ApexCoverMm => outcome.cover_mm?.apex,
            Self::SkinProjectionMm => outcome.skin_projection_mm?,
            Self::SkinAreaGain => outcome.area_ratio? - 1.0,
            Self::SkinAreaGainCm2 => outcome.area_gain_cm2?,
            Self::AttachmentTractionKpa => outcome.attachment_traction_kpa?.max,
            Self::ImplantVolumeMl => outcome.implant_volume_ml,
            Self::SkinReserveUsed => outcome.skin_reserve_used?,
        };
        value.is_finite().then_some(value)
    }
}

/// The first 40 characters of a text.
pub(super) fn short(text: &str) -> String {
    text.chars().take(40).collect()
}

/// All quantities of one result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(with = "BTreeMap<Quantity, f64>")]
#[serde(into = "BTreeMap<Quantity, f64>", from = "BTreeMap<Quantity, f64>")]
pub struct Values([Option<f64>; Quantity::COUNT]);

impl Values {
    /// The quantities of a result.
    #[must_use]
    pub fn new(outcome: &Outcome) -> Self {
        Self(Quantity::ALL.map(|quantity| quantity.of(outcome)))
    }

    /// The value of a quantity \[unit of the quantity\]; `None` where the quantity does not apply.
    #[must_use]
    pub fn get(&self, quantity: Quantity) -> Option<f64> {
        self.0[quantity as usize]
    }
}

impl From<Values> for BTreeMap<Quantity, f64> {
    fn from(values: Values) -> Self {
        let value = |quantity: Quantity| Some((quantity, values.get(quantity)?));
        Quantity::ALL.into_iter().filter_map(value).collect()
    }
}

impl From<BTreeMap<Quantity, f64>> for Values {
    fn from(map: BTreeMap<Quantity, f64>) -> Self {
        Self(Quantity::ALL.map(|quantity| map.get(&quantity).copied()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_files_and_indices_those_of_the_list() {
        for (k, quantity) in Quantity::ALL.into_iter().enumerate() {
            assert_eq!(quantity as usize, k);
            assert_eq!(Quantity::of_name(quantity.name()), Ok(quantity));
            let name = serde_json::to_value(quantity).unwrap();
            assert_eq!(name, quantity.name());
        }
        let error = Quantity::of_name(&"x".repeat(1000)).unwrap_err();
        assert!(error.len() < 500 && error.contains("greatest_strain"), "{error}");
    }

    #[test]
    fn limits_are_in_the_unit_of_the_values() {
        let word = |quantity: Quantity, knee: Option<f64>, value: f64| {
            let (limits, factor) = quantity.limits(knee).unwrap();
            limits.word(factor * value)
        };
        let pressures = [(7.99, "usual"), (8.01, "high"), (10.66, "high"), (10.67, "very high")];
        for (kpa, expected) in pressures {
            assert_eq!(word(Quantity::GreatestPressureKpa, None, kpa), expected);
            assert_eq!(word(Quantity::GreatestPressureMmhg, None, MMHG_PER_KPA * kpa), expected);
        }
        for (strain, expected) in [(0.25, "usual"), (0.26, "high"), (0.55, "beyond")] {
            assert_eq!(word(Quantity::GreatestStrain, None, strain), expected);
        }
        // A skin with a reserve: 80 and 100 % of the strain at which its curve turns steep.
        for (strain, expected) in [(0.159, "usual"), (0.161, "high"), (0.201, "very high")] {
            assert_eq!(word(Quantity::GreatestStrain, Some(0.2), strain), expected);
        }
        assert!(Quantity::ForceN.limits(None).is_none());
    }
}

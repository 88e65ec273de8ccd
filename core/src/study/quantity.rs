//! The figures of a result that a study compares.

use crate::measure::bands::{Limits, PRESSURE, RESERVE, SkinLimits};
use crate::measure::{MMHG_PER_KPA, Outcome};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What is common to a quantity of all results.
struct Row {
    name: &'static str,
    words: &'static str,
    /// The name on a screen, in a surgeon's words.
    title: &'static str,
    /// The unit in files; empty for fractions.
    unit: &'static str,
    of: Of,
    value: fn(&Outcome) -> Option<f64>,
}

/// Which tissue has a quantity.
#[derive(PartialEq)]
enum Of {
    Any,
    /// Layered tissue alone.
    Layers,
}

macro_rules! quantities {
    ($($(#[$about:meta])+ $quantity:ident: $name:literal, $words:literal, $title:literal, $unit:literal, $of:ident, $value:expr;)+) => {
        /// A figure of a result. Names in files: snake case, with the unit at the end.
        #[derive(
            Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
        )]
        pub enum Quantity {
            $($(#[$about])+ #[serde(rename = $name)] $quantity,)+
        }

        impl Quantity {
            /// All quantities.
            pub const ALL: [Self; Self::COUNT] = [$(Self::$quantity),+];
            /// Number of quantities.
            pub const COUNT: usize = [$($name),+].len();
        }

        static ROWS: [Row; Quantity::COUNT] = [
            $(Row { name: $name, words: $words, title: $title, unit: $unit, of: Of::$of, value: $value }),+
        ];
    };
}

quantities! {
    /// Greatest principal strain of the skin \[-\].
    GreatestStrain: "greatest_strain", "greatest stretch of the skin", "Skin stretch", "", Any, |of| Some(of.strain.as_ref()?.max_principal);
    /// Fraction of the skin over the pocket whose strain is above 0.25 \[-\].
    AreaOver25: "area_over_25", "skin stretched by more than 25 %", "Skin stretched above 25 %", "", Any, |of| strained(of, "0.25");
    /// Fraction of the skin over the pocket whose strain is above 0.50 \[-\].
    AreaOver50: "area_over_50", "skin stretched by more than 50 %", "Skin stretched above 50 %", "", Any, |of| strained(of, "0.50");
    /// Mean contact pressure \[mmHg\].
    MeanPressureMmhg: "mean_pressure_mmhg", "mean contact pressure", "Pressure, mean", "mmHg", Any, |of| Some(of.contact_pressure_mmhg?.mean);
    /// Greatest contact pressure \[mmHg\].
    GreatestPressureMmhg: "greatest_pressure_mmhg", "greatest contact pressure", "Pressure, greatest", "mmHg", Any, |of| Some(of.contact_pressure_mmhg?.max);
    /// Mean contact pressure \[kPa\].
    MeanPressureKpa: "mean_pressure_kpa", "mean contact pressure", "Pressure, mean", "kPa", Any, |of| Some(of.contact_pressure_kpa?.mean);
    /// Greatest contact pressure \[kPa\].
    GreatestPressureKpa: "greatest_pressure_kpa", "greatest contact pressure", "Pressure, greatest", "kPa", Any, |of| Some(of.contact_pressure_kpa?.max);
    /// Vertical force between implant and tissue \[N\].
    ForceN: "force_n", "contact force", "Force, vertical", "N", Any, |of| of.contact_force_n;
    /// Greatest principal stress of the skin \[kPa\].
    SkinStressKpa: "skin_stress_kpa", "greatest stress of the skin", "Greatest stress, skin", "kPa", Any, |of| of.layers.first()?.max_stress_kpa;
    /// Layered tissue: least thickness of the tissue over the implant \[mm\].
    LeastCoverMm: "least_cover_mm", "least cover", "Least cover", "mm", Layers, |of| Some(of.cover_mm?.least);
    /// Layered tissue: thickness of the tissue over the implant's highest point \[mm\].
    ApexCoverMm: "apex_cover_mm", "cover at the apex", "Cover over the apex", "mm", Layers, |of| Some(of.cover_mm?.apex);
    /// Layered tissue: void between tissue, implant and wall \[ml\].
    VoidMl: "void_ml", "void of the pocket", "Void of the pocket", "ml", Layers, |of| of.void_ml;
    /// Height of the outer skin surface above the wall \[mm\].
    SkinProjectionMm: "skin_projection_mm", "projection of the skin", "Height of the breast mound", "mm", Any, |of| of.skin_projection_mm;
    /// Area gained by the skin over the pocket, relative to its area at rest \[-\].
    SkinAreaGain: "skin_area_gain", "area gained by the skin", "Skin area gained, of the pocket", "", Any, |of| Some(of.area_ratio? - 1.0);
    /// Area gained by the skin over the pocket \[cm²\].
    SkinAreaGainCm2: "skin_area_gain_cm2", "area gained by the skin", "Skin area gained", "cm²", Any, |of| of.area_gain_cm2;
    /// Layered tissue: greatest pull of the attachment around the pocket \[kPa\].
    AttachmentTractionKpa: "attachment_traction_kpa", "greatest pull of the attachment", "Pull at the pocket's edge", "kPa", Layers, |of| Some(of.attachment_traction_kpa?.max);
    /// Volume of the implant \[ml\].
    ImplantVolumeMl: "implant_volume_ml", "volume of the implant", "Volume", "ml", Any, |of| Some(of.implant_volume_ml);
    /// Layered tissue: greatest strain / strain at which the skin's curve turns steep \[-\].
    SkinReserveUsed: "skin_reserve_used", "share of the skin's reserve", "Skin stretch, of its reserve", "", Layers, |of| of.skin_reserve_used;
}

/// Fraction of the skin over the pocket above a strain.
fn strained(outcome: &Outcome, strain: &str) -> Option<f64> {
    outcome.strain.as_ref()?.fraction_above.get(strain).copied()
}

impl Quantity {
    fn row(self) -> &'static Row {
        &ROWS[self as usize]
    }

    /// The name in files and arguments.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().name
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

    /// Does layered tissue alone have the quantity?
    #[must_use]
    pub fn is_of_layers(self) -> bool {
        self.row().of == Of::Layers
    }

    /// The quantity in words, without its unit.
    #[must_use]
    pub fn label(self) -> &'static str {
        self.row().words
    }

    /// The name on a screen, in a surgeon's words.
    #[must_use]
    pub fn title(self) -> &'static str {
        self.row().title
    }

    /// Unit of the values; empty for fractions.
    #[must_use]
    pub fn unit(self) -> &'static str {
        self.row().unit
    }

    /// Factor from a value to the displayed number, and the displayed unit: fractions are displayed in %.
    #[must_use]
    pub fn display(self) -> (f64, &'static str) {
        match self.unit() {
            "" => (100.0, "%"),
            unit => (1.0, unit),
        }
    }

    /// The limits with words and sources, if the quantity has any, and the factor from a value to the unit of the limits.
    /// `skin`: what the strain is compared with.
    #[must_use]
    pub fn limits(self, skin: SkinLimits) -> Option<(Limits, f64)> {
        match self {
            Self::GreatestStrain => Some(skin.limits()),
            Self::SkinReserveUsed => Some((RESERVE.clone(), 1.0)),
            Self::MeanPressureMmhg | Self::GreatestPressureMmhg => Some((PRESSURE.clone(), 1.0)),
            Self::MeanPressureKpa | Self::GreatestPressureKpa => {
                Some((PRESSURE.clone(), MMHG_PER_KPA))
            }
            _ => None,
        }
    }

    /// The value in a result; `None` if the result does not contain the quantity.
    #[must_use]
    pub fn of(self, outcome: &Outcome) -> Option<f64> {
        (self.row().value)(outcome).filter(|value| value.is_finite())
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

    /// Does no quantity apply?
    pub(super) fn is_empty(&self) -> bool {
        self.0.iter().all(Option::is_none)
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
            let (limits, factor) = quantity.limits(SkinLimits::of_skin(knee)).unwrap();
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
        for (strain, expected) in
            [(0.159, "reserve left"), (0.161, "little reserve"), (0.201, "no reserve")]
        {
            assert_eq!(word(Quantity::GreatestStrain, Some(0.2), strain), expected);
        }
        assert!(Quantity::ForceN.limits(SkinLimits::Tearing).is_none());
    }
}

//! Pinch, pull and class of the skin, and the values that they become.

use super::{ClinicalError, EnvelopeFill, checked, limits, pull_strain_scale, rounded};
use crate::curve::{SCALES, number};
use crate::measure::PatientValue;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Thickness of the skin within the cover \[mm\].
pub const SKIN_THICKNESS_MM: f64 = 1.5;

/// How far measurements by hand reproduce between raters.
pub const REPRODUCIBILITY: &str = "28 women, 4 raters: intraclass correlation 0.76 for the base width, 0.70 for the \
    stretched nipple–fold distance, below 0.2 for both pinches and the anterior pull (Aesthet Surg J 2016;36:431)";

const PINCH_SOURCE: &str = "A fold contains the cover twice; within a factor 1.3 (1 standard deviation). Pinches of two \
    raters correlate below 0.2 (Aesthet Surg J 2016;36:431).";
const SKIN_SOURCE: &str =
    "Skin of the breast: 1.55 ± 0.25 mm (1 standard deviation between people).";
const PULL_SOURCE: &str = "Flat sheet of skin lifted at its centre, radial fibres, grip of 15 mm radius, 5 N; within a \
    factor 2 (1 standard deviation), most of it from the unknown force of the pull (2–10 N). Pulls of two raters \
    correlate below 0.2 (Aesthet Surg J 2016;36:431).";
const CLASS_SOURCE: &str = "Classes of the anterior pull (Tebbetts, Plast Reconstr Surg 2002;109:1396: limits at 2, 3 and \
    4 cm); strain scale of the class within a factor 2 (1 standard deviation).";

/// Standard deviation of the cover's thickness, as a factor.
const COVER_FACTOR: f64 = 1.3;
/// Standard deviation of the skin's thickness \[mm\].
const SKIN_SD_MM: f64 = 0.25;
/// Standard deviation of the strain scale from a pull or a class, as a factor.
const STRAIN_SCALE_FACTOR: f64 = 2.0;

/// How far a derived value may be off: one standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Uncertainty {
    /// Lognormal: value × factor, value / factor.
    Factor(f64),
    /// Normal: value ± deviation.
    Deviation(f64),
    /// The sum of the value and a fixed part is lognormal: a layer of the cover.
    FactorOfSum {
        /// One standard deviation of the sum.
        factor: f64,
        /// The fixed part.
        fixed: f64,
    },
}

/// A value that was derived from a measurement.
#[derive(Clone, Debug, PartialEq)]
pub struct Derived {
    /// The measurement in words, as "pinch 20 mm".
    pub measured: String,
    /// The derived value.
    pub value: f64,
    /// Unit of the value, empty without one.
    pub unit: &'static str,
    /// How far the value may be off.
    pub uncertainty: Uncertainty,
    /// The class in a word, if the measurement has classes.
    pub word: Option<&'static str>,
    /// Origin of the rule and of its uncertainty.
    pub source: &'static str,
}

impl Derived {
    /// Range of the true value within a number of standard deviations: 1 contains 68 %, 1.28 the 10th to the 90th
    /// percentile, 2 contains 95 %. Never below zero.
    #[must_use]
    pub fn range(&self, deviations: f64) -> (f64, f64) {
        let value = self.value;
        match self.uncertainty {
            Uncertainty::Factor(factor) => {
                let factor = factor.powf(deviations);
                (value / factor, value * factor)
            }
            Uncertainty::Deviation(deviation) => {
                let distance = deviation * deviations;
                ((value - distance).max(0.0), value + distance)
            }
            Uncertainty::FactorOfSum { factor, fixed } => {
                let (sum, factor) = (value + fixed, factor.powf(deviations));
                ((sum / factor - fixed).max(0.0), sum * factor - fixed)
            }
        }
    }
}

/// Thicknesses from a pinch \[mm\].
#[derive(Clone, Debug, PartialEq)]
pub struct Cover {
    /// All tissue over the implant: half the pinch, within a factor 1.3.
    pub whole: Derived,
    /// The skin: 1.5 mm of the cover.
    pub skin: Derived,
    /// The fat: the rest of the cover.
    pub fat: Derived,
}

/// Thickness of cover, skin and fat from a pinch \[mm\]: the cover is half the pinch, the skin 1.5 mm of the cover.
///
/// Uncertainty: a factor 1.3 (1 standard deviation) of the cover, ± 0.25 mm of the skin.
///
/// # Errors
/// A pinch outside of 4–120 mm.
pub fn cover(pinch_mm: f64) -> Result<Cover, ClinicalError> {
    let pinch = checked("pinch", pinch_mm, limits::PINCH_MM, " mm")?;
    let measured = format!("pinch {} mm", number(pinch));
    let whole = 0.5 * pinch;
    let derived = |value, uncertainty, source| Derived {
        measured: measured.clone(),
        value,
        unit: "mm",
        uncertainty,
        word: None,
        source,
    };
    let of_sum = Uncertainty::FactorOfSum { factor: COVER_FACTOR, fixed: SKIN_THICKNESS_MM };
    Ok(Cover {
        whole: derived(whole, Uncertainty::Factor(COVER_FACTOR), PINCH_SOURCE),
        skin: derived(SKIN_THICKNESS_MM, Uncertainty::Deviation(SKIN_SD_MM), SKIN_SOURCE),
        fat: derived(whole - SKIN_THICKNESS_MM, of_sum, PINCH_SOURCE),
    })
}

/// Class of the skin by its anterior pull.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SkinClass {
    /// Pull below 20 mm.
    Tight,
    /// Pull of 20 to 30 mm.
    Normal,
    /// Pull above 30 to 40 mm.
    Lax,
    /// Pull above 40 mm.
    VeryLax,
}

impl SkinClass {
    /// All classes, from the tightest.
    pub const ALL: [Self; 4] = [Self::Tight, Self::Normal, Self::Lax, Self::VeryLax];

    /// The class of a pull \[mm\].
    ///
    /// # Errors
    /// A pull outside of 5–80 mm.
    pub fn of_pull(pull_mm: f64) -> Result<Self, ClinicalError> {
        let pull = checked("pull of the skin", pull_mm, limits::PULL_MM, " mm")?;
        Ok(match pull {
            pull if pull < 20.0 => Self::Tight,
            pull if pull <= 30.0 => Self::Normal,
            pull if pull <= 40.0 => Self::Lax,
            _ => Self::VeryLax,
        })
    }

    /// Word, strain scale of the skin preset \[-\], and pull \[mm\]: the middle of its range; half a centimetre beyond the outer limits.
    fn row(self) -> (&'static str, f64, f64) {
        match self {
            Self::Tight => ("tight", 0.25, 15.0),
            Self::Normal => ("normal", 0.5, 25.0),
            Self::Lax => ("lax", 1.0, 35.0),
            Self::VeryLax => ("very lax", 1.7, 45.0),
        }
    }

    /// The class in a word.
    #[must_use]
    pub fn word(self) -> &'static str {
        self.row().0
    }

    /// Strain scale of the skin preset \[-\].
    #[must_use]
    pub fn strain_scale(self) -> f64 {
        self.row().1
    }

    /// The middle of the pulls \[mm\].
    pub(super) fn pull_mm(self) -> f64 {
        self.row().2
    }
}

/// Base width for which the classes' strain scales of skin under a natural tension are derived \[mm\].
const CLASS_WIDTH_MM: f64 = 120.0;

/// Strain scale of the skin preset \[-\] of a class; of skin under a natural tension \[N/m\] times what the tension does to the scale of the
/// class's pull.
///
/// # Errors
/// A strain scale outside of 0.05–20.
pub fn strain_scale_of_class(
    class: SkinClass,
    natural_tension_n_per_m: f64,
) -> Result<Derived, ClinicalError> {
    let measured = format!("skin class {}", class.word());
    let scale = |tension| pull_strain_scale(class.pull_mm(), CLASS_WIDTH_MM, tension);
    let value = match natural_tension_n_per_m {
        tension if tension > 0.0 => class.strain_scale() * scale(tension) / scale(0.0),
        _ => class.strain_scale(),
    };
    let value = within_scales(&measured, natural_tension_n_per_m, value)?;
    Ok(Derived {
        measured,
        value,
        unit: "",
        uncertainty: Uncertainty::Factor(STRAIN_SCALE_FACTOR),
        word: Some(class.word()),
        source: CLASS_SOURCE,
    })
}

/// A strain scale that may be.
fn within_scales(measured: &str, tension: f64, value: f64) -> Result<f64, ClinicalError> {
    if (SCALES.0..=SCALES.1).contains(&value) {
        return Ok(value);
    }
    Err(ClinicalError::Derived {
        given: if tension > 0.0 {
            format!("{measured} of skin under {} N/m", number(tension))
        } else {
            measured.to_owned()
        },
        quantity: "strain scale",
        value,
        allowed: SCALES,
        unit: "",
    })
}

/// Strain scale of the skin preset \[-\] from an anterior pull and the base width \[mm\] of skin under a natural tension \[N/m\]:
/// [`pull_strain_scale`], within a factor 2 (1 standard deviation).
///
/// # Errors
/// A pull outside of 5–80 mm, a base width outside of 60–240 mm, or a strain scale outside of 0.05–20.
pub fn strain_scale_of_pull(
    pull_mm: f64,
    base_width_mm: f64,
    natural_tension_n_per_m: f64,
) -> Result<Derived, ClinicalError> {
    let class = SkinClass::of_pull(pull_mm)?;
    let width = checked("base width", base_width_mm, limits::MEASURED_WIDTH_MM, " mm")?;
    let measured = format!("skin pull {} mm, base width {} mm", number(pull_mm), number(width));
    let value = pull_strain_scale(pull_mm, width, natural_tension_n_per_m);
    let value = within_scales(&measured, natural_tension_n_per_m, value)?;
    Ok(Derived {
        measured,
        value,
        unit: "",
        uncertainty: Uncertainty::Factor(STRAIN_SCALE_FACTOR),
        word: Some(class.word()),
        source: PULL_SOURCE,
    })
}

/// What was measured on a person. Reproducibility: [`REPRODUCIBILITY`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Measurements {
    /// Base width of the breast \[mm\], 60 to 240.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base_width_mm: Option<f64>,
    /// Pinch: thickness of a fold of skin and fat \[mm\], 4 to 120.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pinch_mm: Option<f64>,
    /// Anterior pull: how far a grip of the fingertips lifts the skin \[mm\], 5 to 80; with `base_width_mm`, without
    /// `skin_class`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skin_pull_mm: Option<f64>,
    /// Class of the skin.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub skin_class: Option<SkinClass>,
    /// Nipple–fold distance under stretch \[mm\], 30 to 200; for the practice table alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fold_stretched_mm: Option<f64>,
    /// How much of the stretched envelope the existing breast fills; for the practice table alone.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub envelope_fill: Option<EnvelopeFill>,
}

impl Measurements {
    /// Checks the measurements and that they fit together.
    ///
    /// # Errors
    /// The name of the field and its error.
    pub fn check(&self) -> Result<(), (&'static str, ClinicalError)> {
        for (field, quantity, value, allowed) in [
            ("base_width_mm", "base width", self.base_width_mm, limits::MEASURED_WIDTH_MM),
            ("pinch_mm", "pinch", self.pinch_mm, limits::PINCH_MM),
            ("skin_pull_mm", "pull of the skin", self.skin_pull_mm, limits::PULL_MM),
            (
                "fold_stretched_mm",
                "nipple–fold distance",
                self.fold_stretched_mm,
                limits::FOLD_STRETCHED_MM,
            ),
        ] {
            if let Some(value) = value {
                checked(quantity, value, allowed, " mm").map_err(|error| (field, error))?;
            }
        }
        match (self.skin_pull_mm, self.skin_class, self.base_width_mm) {
            (Some(_), Some(_), _) => Err(("skin_class", ClinicalError::PullAndClass)),
            (Some(_), None, None) => Err(("skin_pull_mm", ClinicalError::PullWithoutWidth)),
            _ => Ok(()),
        }
    }

    /// Thicknesses from the pinch, if there is one.
    ///
    /// # Errors
    /// As of [`cover`].
    pub fn cover(&self) -> Result<Option<Cover>, ClinicalError> {
        self.pinch_mm.map(cover).transpose()
    }

    /// Strain scale of the skin from its pull or class, if there is one, under a natural tension \[N/m\].
    ///
    /// # Errors
    /// As of [`strain_scale_of_pull`] and [`Self::check`].
    pub fn strain_scale(
        &self,
        natural_tension_n_per_m: f64,
    ) -> Result<Option<Derived>, ClinicalError> {
        match (self.skin_pull_mm, self.skin_class) {
            (Some(_), Some(_)) => Err(ClinicalError::PullAndClass),
            (Some(pull), None) => {
                let width = self.base_width_mm.ok_or(ClinicalError::PullWithoutWidth)?;
                strain_scale_of_pull(pull, width, natural_tension_n_per_m).map(Some)
            }
            (None, class) => {
                class.map(|class| strain_scale_of_class(class, natural_tension_n_per_m)).transpose()
            }
        }
    }
}

impl Derived {
    /// The value of a field beside this one, which its measurement gives.
    #[must_use]
    pub fn beside(&self, field: String, value: f64, set_by_hand: bool) -> PatientValue {
        let (least, most) = self.range(1.0);
        let measured = self.measured.clone();
        PatientValue {
            field,
            value,
            set_by_hand,
            measured,
            derived: self.value,
            range: [least, most],
        }
    }
}

/// A sentence if a value set by hand lies outside of the range of its measurement.
#[must_use]
pub fn inconsistency(of: &PatientValue) -> Option<String> {
    let PatientValue { field, value, measured, derived, range: [least, most], .. } = of;
    let is_inconsistent = of.set_by_hand && !(*least..=*most).contains(value);
    is_inconsistent.then(|| {
        format!(
            "{field} is {}, set by hand; the measurement ({measured}) gives {}, {} to {} within one standard \
             deviation.",
            rounded(*value),
            rounded(*derived),
            rounded(*least),
            rounded(*most)
        )
    })
}

//! What a hand measures, and what it becomes: pinch, pull, base width, sizes of implants and expanders.
//!
//! Pure functions with their sources; lengths in mm, volumes in ml. Every derived value carries the range in which the
//! true value may lie ([`Derived::range`]).
//!
//! `measures` (pinch → thicknesses, pull → strain scale) | `pull` (the model of the anterior pull) | `sizes` (base width,
//! projection, volume, profile class, expander) | `shelf` (the sizes of a clinic) |
//! `practice` (the volume that a rule of practice takes), `practice_csv` (its table) | `spread` (how tissue differs between people) | `when` (the time after the operation).
//!
//! Uses `curve`. Used by `measure`, `scene` and all to their right.

mod measures;
mod practice;
mod practice_csv;
mod pull;
mod shelf;
mod sizes;
pub mod spread;
mod when;

pub use measures::{
    Cover, Derived, Measurements, REPRODUCIBILITY, SKIN_THICKNESS_MM, SkinClass, Uncertainty,
    cover, inconsistency, strain_scale_of_class, strain_scale_of_pull,
};
pub use practice::{
    BUILT_IN_SOURCE, Bound, Corrected, Correction, EnvelopeFill, PracticeTable, PracticeVolume,
    STEP_ML,
};
pub use practice_csv::is_practice_table;
pub use pull::{GRIP_FORCE_N, GRIP_RADIUS_MM, pull_strain_scale};
pub use shelf::{
    Column, Draft, DraftColumn, LengthUnit, MAX_SIZES, Reading, Shelf, ShelfSize, Skipped,
    UnitOrigin,
};
pub use sizes::{Dimension, Expander, ProfileClass, Size, typical_sizes};
pub use when::{Expected, When};

use crate::curve::number;

/// Allowed ranges, as inclusive bounds.
pub mod limits {
    /// Base width of an implant, and of a breast \[mm\].
    pub const BASE_WIDTH_MM: (f64, f64) = (20.0, 240.0);
    /// Projection of an implant \[mm\].
    pub const PROJECTION_MM: (f64, f64) = (2.0, 120.0);
    /// Fullness of an implant: volume by that of the cylinder around it \[-\].
    pub const FULLNESS: (f64, f64) = (0.55, 0.8);
    /// Height by width of the base of an implant \[-\].
    pub const ASPECT: (f64, f64) = (0.5, 2.0);
    /// Measured base width of a breast \[mm\].
    pub const MEASURED_WIDTH_MM: (f64, f64) = (60.0, 240.0);
    /// Pinch: thickness of a fold of skin and fat \[mm\].
    pub const PINCH_MM: (f64, f64) = (4.0, 120.0);
    /// Nipple–fold distance under stretch \[mm\].
    pub const FOLD_STRETCHED_MM: (f64, f64) = (30.0, 200.0);
    /// Anterior pull of the skin \[mm\].
    pub const PULL_MM: (f64, f64) = (5.0, 80.0);
    /// Base width of typical round implants \[mm\].
    pub const TYPICAL_WIDTH_MM: (f64, f64) = (78.0, 180.0);
    /// Projection of typical round implants \[mm\].
    pub const TYPICAL_PROJECTION_MM: (f64, f64) = (20.0, 75.0);
    /// Volume of typical round implants \[ml\].
    pub const TYPICAL_VOLUME_ML: (f64, f64) = (95.0, 965.0);
    /// Projection / half base width of typical round implants \[-\].
    pub const TYPICAL_RATIO: (f64, f64) = (0.39, 1.07);
}

/// Error of a measurement or a size, in one line: quantity, value, allowed range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ClinicalError {
    /// A given value is out of its range or not a number.
    #[error("the {quantity} is {}{unit}; allowed: {} to {}{unit}", number(*value), number(allowed.0), number(allowed.1))]
    OutOfRange {
        /// What was measured.
        quantity: &'static str,
        /// The given value.
        value: f64,
        /// The allowed range.
        allowed: (f64, f64),
        /// Unit, with a space before it.
        unit: &'static str,
    },
    /// The values are in their ranges, and a value derived from them is not.
    #[error("{given} gives a {quantity} of {}{unit}; allowed: {} to {}{unit}", derived(*value, allowed.1), number(allowed.0), number(allowed.1))]
    Derived {
        /// The given values, in words.
        given: String,
        /// The derived quantity.
        quantity: &'static str,
        /// The derived value.
        value: f64,
        /// The allowed range of the derived quantity.
        allowed: (f64, f64),
        /// Unit, with a space before it.
        unit: &'static str,
    },
    /// Two measurements exclude each other.
    #[error("skin_pull_mm and skin_class are both given; allowed: one of them")]
    PullAndClass,
    /// The pull was measured without the base width.
    #[error("skin_pull_mm is given without base_width_mm; allowed: both, or skin_class")]
    PullWithoutWidth,
}

/// A derived value; one without a bound is above the greatest one.
fn derived(value: f64, most: f64) -> String {
    if value.is_finite() { rounded(value) } else { format!("more than {}", number(most)) }
}

/// Three significant digits.
fn rounded(value: f64) -> String {
    let digits = 2 - value.abs().max(1e-9).log10().floor() as i32;
    if (0..=6).contains(&digits) {
        let text = format!("{value:.*}", digits as usize);
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    } else {
        number(value.round())
    }
}

/// Checks a given value.
fn checked(
    quantity: &'static str,
    value: f64,
    allowed: (f64, f64),
    unit: &'static str,
) -> Result<f64, ClinicalError> {
    if (allowed.0..=allowed.1).contains(&value) {
        Ok(value)
    } else {
        Err(ClinicalError::OutOfRange { quantity, value, allowed, unit })
    }
}

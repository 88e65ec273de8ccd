//! Description of a curve in a scene file, and its errors.

use super::read::number;
use super::{COEFFICIENT, MAX_COEFFICIENTS, RATE, SLOPE, STRESS_SCALE, Shape, checked, hermite};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A stress–strain curve of a scene file. Stresses in kPa, strains without unit.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum CurveSpec {
    /// Skin preset: slope 100 kPa up to 0.4, cubic to (0.7; 205 kPa), slope 1000 kPa beyond.
    Skin {},
    /// Adipose preset of the paper: 0.4 kPa · atan(7.5 ε), initial modulus 3 kPa, nearly flat beyond strain 0.6.
    Adipose {},
    /// Subcutaneous fat as measured up to strain 0.3, a line with the end slope beyond; see [`Fat`].
    Fat {
        /// The curve within the range of the measurements.
        #[serde(default)]
        variant: Fat,
    },
    /// `modulus_kpa · ε`.
    Linear {
        /// Young's modulus \[kPa\], > 0.
        modulus_kpa: f64,
    },
    /// `scale_kpa · atan(rate · ε)`.
    Arctangent {
        /// Stress scale \[kPa\], > 0; the stress tends to π/2 of it.
        scale_kpa: f64,
        /// Rate \[-\], > 0; the initial modulus is `scale_kpa · rate`.
        rate: f64,
    },
    /// Fung's exponential, `scale_kpa · (exp(rate · ε) − 1)`.
    Exponential {
        /// Stress scale \[kPa\], > 0.
        scale_kpa: f64,
        /// Rate \[-\], > 0 and at most 100.
        rate: f64,
    },
    /// Marked points, the first at (0, 0), joined by `interpolation`.
    Points {
        /// `[strain, stress_kpa]` pairs, both strictly increasing.
        points: Vec<[f64; 2]>,
        /// Straight lines or a monotone cubic spline.
        #[serde(default)]
        interpolation: Interpolation,
    },
    /// Consecutive sections from strain 0; each section starts at the end stress of the previous section.
    Sections {
        /// The sections; `from` is 0 in the first section and the previous `to` in the others.
        sections: Vec<Section>,
    },
}

/// Curves of subcutaneous fat, `scale · (exp(rate · ε) − 1)` up to strain [`Fat::MEASURED_STRAIN`]; beyond it no
/// quasi-static test was found, and the curve is a line.
///
/// Initial modulus: geometric mean of Alkhouli et al. 2013 (1.6 kPa), Sims et al. 2010 (1.6), magnetic resonance elastography
/// (2.25) and breast fat in vivo (3.04). Slope at 30 %: the only tensile test of human fat (N. Alkhouli et al., Am. J. Physiol.
/// Endocrinol. Metab. 305, 2013: tangent 1.6 ± 0.8 → 11.7 ± 6.4 kPa) times 0.77 for tissue at rest.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "lowercase")]
pub enum Fat {
    /// 0.43 kPa · (exp(3.5 ε) − 1); slope 4.3 kPa beyond strain 0.3.
    Low,
    /// 0.40 kPa · (exp(5 ε) − 1); slope 8.96 kPa beyond strain 0.3.
    #[default]
    Mid,
    /// 0.89 kPa · (exp(4.5 ε) − 1); slope 15.4 kPa beyond strain 0.3.
    High,
}

impl Fat {
    /// All variants, from the softest to the stiffest.
    pub const ALL: [Self; 3] = [Self::Low, Self::Mid, Self::High];
    /// Strain up to which fat was measured \[-\].
    pub const MEASURED_STRAIN: f64 = 0.3;

    /// Scale \[kPa\] and rate \[-\] of the exponential.
    #[must_use]
    pub const fn scale_and_rate(self) -> (f64, f64) {
        match self {
            Self::Low => (0.43, 3.5),
            Self::Mid => (0.40, 5.0),
            Self::High => (0.89, 4.5),
        }
    }
}

/// Interpolation between marked points.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Interpolation {
    /// Straight lines between the points.
    #[default]
    Line,
    /// Monotone piecewise cubic (C¹, no overshoot).
    Spline,
}

/// One section of a curve; `x = ε − from` is the strain relative to the start of the section.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "lowercase", deny_unknown_fields)]
pub enum Section {
    /// Adds `modulus_kpa · x`.
    Linear {
        /// Start strain \[-\].
        from: f64,
        /// End strain \[-\].
        to: f64,
        /// Slope \[kPa\], > 0.
        modulus_kpa: f64,
    },
    /// Cubic Hermite piece from the end stress and end slope of the previous section.
    Cubic {
        /// Start strain \[-\].
        from: f64,
        /// End strain \[-\].
        to: f64,
        /// Stress at `to` \[kPa\].
        end_stress_kpa: f64,
        /// Slope at `to` \[kPa\].
        end_slope_kpa: f64,
    },
    /// Adds `Σ coefficients_kpa[k] · x^(k+1)`.
    Polynomial {
        /// Start strain \[-\].
        from: f64,
        /// End strain \[-\].
        to: f64,
        /// Coefficients of x, x², … \[kPa\], 1 to 8 numbers.
        coefficients_kpa: Vec<f64>,
    },
    /// Adds `scale_kpa · atan(rate · x)`.
    Arctangent {
        /// Start strain \[-\].
        from: f64,
        /// End strain \[-\].
        to: f64,
        /// Stress scale \[kPa\], > 0.
        scale_kpa: f64,
        /// Rate \[-\], > 0.
        rate: f64,
    },
    /// Adds `scale_kpa · sin(rate · x)`, increasing while `rate · x < π/2`.
    Sine {
        /// Start strain \[-\].
        from: f64,
        /// End strain \[-\].
        to: f64,
        /// Stress scale \[kPa\], > 0.
        scale_kpa: f64,
        /// Rate \[-\], > 0.
        rate: f64,
    },
    /// Adds `scale_kpa · (exp(rate · x) − 1)`.
    Exponential {
        /// Start strain \[-\].
        from: f64,
        /// End strain \[-\].
        to: f64,
        /// Stress scale \[kPa\], > 0.
        scale_kpa: f64,
        /// Rate \[-\], > 0.
        rate: f64,
    },
}

/// Error of an invalid curve. The message names the point or field and the allowed range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CurveError {
    /// A parameter is outside of its range or not a number.
    #[error("{field} is {}; allowed: {allowed}", number(*value))]
    Parameter {
        /// Name of the field in the curve.
        field: String,
        /// Given value.
        value: f64,
        /// The allowed range, in words.
        allowed: &'static str,
    },
    /// Fewer than two points, no section, or too many entries.
    #[error("{field} has {count} entries; allowed: {allowed}")]
    Count {
        /// `points` or `sections`.
        field: &'static str,
        /// Given number of entries.
        count: usize,
        /// The allowed range, in words.
        allowed: &'static str,
    },
    /// A marked point or section is invalid.
    #[error("{field}[{index}] {problem}")]
    Entry {
        /// `points` or `sections`.
        field: &'static str,
        /// Index in the list, from 0.
        index: usize,
        /// Description of the error and the allowed range.
        problem: String,
    },
}

impl Section {
    pub(super) fn interval(&self) -> (f64, f64) {
        match *self {
            Self::Linear { from, to, .. }
            | Self::Cubic { from, to, .. }
            | Self::Polynomial { from, to, .. }
            | Self::Arctangent { from, to, .. }
            | Self::Sine { from, to, .. }
            | Self::Exponential { from, to, .. } => (from, to),
        }
    }

    /// Stress increment of this section for the given stress and slope at its start.
    pub(super) fn shape(
        &self,
        length: f64,
        start: f64,
        start_slope: f64,
    ) -> Result<Shape, CurveError> {
        Ok(match self {
            Self::Linear { modulus_kpa, .. } => {
                Shape::Polynomial(vec![checked("modulus_kpa", *modulus_kpa, STRESS_SCALE)?])
            }
            Self::Cubic { end_stress_kpa, end_slope_kpa, .. } => {
                let end = checked("end_stress_kpa", *end_stress_kpa, STRESS_SCALE)?;
                let slope = checked("end_slope_kpa", *end_slope_kpa, SLOPE)?;
                hermite(length, end - start, start_slope, slope)
            }
            Self::Polynomial { coefficients_kpa, .. } => {
                if !(1..=MAX_COEFFICIENTS).contains(&coefficients_kpa.len()) {
                    return Err(CurveError::Count {
                        field: "coefficients_kpa",
                        count: coefficients_kpa.len(),
                        allowed: "1 to 8",
                    });
                }
                for &c in coefficients_kpa {
                    checked("coefficients_kpa", c, COEFFICIENT)?;
                }
                Shape::Polynomial(coefficients_kpa.clone())
            }
            Self::Arctangent { scale_kpa, rate, .. } => Shape::Arctangent {
                scale: checked("scale_kpa", *scale_kpa, STRESS_SCALE)?,
                rate: checked("rate", *rate, RATE)?,
            },
            Self::Sine { scale_kpa, rate, .. } => Shape::Sine {
                scale: checked("scale_kpa", *scale_kpa, STRESS_SCALE)?,
                rate: checked("rate", *rate, RATE)?,
            },
            Self::Exponential { scale_kpa, rate, .. } => Shape::Exponential {
                scale: checked("scale_kpa", *scale_kpa, STRESS_SCALE)?,
                rate: checked("rate", *rate, RATE)?,
            },
        })
    }
}

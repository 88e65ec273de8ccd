//! The implant: its numbers, in memory and in a file, and what follows from them.

use super::fill::FillFile;
use super::{Fill, Posture, SceneError, problem};
use crate::clinical::{ClinicalError, Size};
use crate::contact::{Deformed, Dome, HALF_ELLIPSOID, HalfBall, Shape};
use crate::curve::{Pair, given, number, present};
use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Greatest relative difference of two volumes that count as equal: finished digits of a volume and a fullness.
const SAME_VOLUME: f64 = 2e-3;

/// A dome: half-ellipsoid of revolution; a hemisphere when projection = base radius; anatomical with another height of
/// the base or a lower apex; of another fullness.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Implant {
    /// Base radius R \[mm\], 10 to 120; of an anatomical implant half of the base's width.
    pub base_radius_mm: f64,
    /// Projection p (height) \[mm\], 2 to 120.
    pub projection_mm: f64,
    /// Centre of the base in the pocket \[mm\]; (0, 0) is the pocket's centre.
    pub center_mm: [f64; 2],
    /// Height of the base along the body \[mm\], half to twice the width; `None`: a round base.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base_height_mm: Option<f64>,
    /// Way of the apex towards the feet (−y) \[mm\], up to 0.6 of half the base's height.
    #[serde(skip_serializing_if = "is_zero")]
    pub apex_shift_mm: f64,
    /// Volume by π a b p of the half-axes of the base and the projection \[-\], 0.55 to 0.8; `None`: ⅔, half of an ellipsoid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fullness: Option<f64>,
    /// How far its body yields; `None`: it is rigid.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fill: Option<Fill>,
}

/// Greatest way of the apex \[half of the base's height\]: it stays over the base.
pub(super) const MAX_APEX_SHIFT: f64 = 0.6;

#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "one JSON object")]
#[schemars(rename = "Implant")]
pub(super) struct ImplantFile {
    base_radius_mm: f64,
    /// Default: the base radius (a hemisphere).
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "f64")]
    projection_mm: Option<f64>,
    #[serde(default, deserialize_with = "present")]
    #[schemars(with = "[f64; 2]")]
    center_mm: Pair,
    /// Height of the base along the body \[mm\], half to twice the width. Default: twice the base radius (round).
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "f64")]
    base_height_mm: Option<f64>,
    /// Way of the apex towards the feet (−y) \[mm\], up to 0.6 of half the base's height. Default: 0.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "f64")]
    apex_shift_mm: Option<f64>,
    /// Volume by π a b p of the half-axes of the base and the projection, 0.55 to 0.8. Default: 2/3 (half of an ellipsoid).
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "f64")]
    fullness: Option<f64>,
    /// Volume \[ml\], instead of the fullness, which follows.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "f64")]
    volume_ml: Option<f64>,
    /// `"rigid"`, `"form_stable"`, `"cohesive"`, `"soft"`, `"saline"`, or the moduli of gel and shell. Default: rigid.
    #[serde(default, deserialize_with = "present")]
    fill: FillFile,
    /// The maker's name of the size, up to 60 characters in one line; no computation depends on it, the result has it as
    /// `implant_reference`. Default: not stated.
    #[serde(default, deserialize_with = "present")]
    pub(super) reference: String,
}

impl ImplantFile {
    /// The implant without its reference.
    ///
    /// # Errors
    /// A volume that gives no fullness within the limits, or another one than the given.
    pub(super) fn shape(&self) -> Result<Implant, SceneError> {
        let radius = self.base_radius_mm;
        let mut implant = Implant {
            base_radius_mm: radius,
            projection_mm: self.projection_mm.unwrap_or(radius),
            center_mm: self.center_mm.0,
            base_height_mm: self.base_height_mm,
            apex_shift_mm: self.apex_shift_mm.unwrap_or_default(),
            fullness: self.fullness,
            fill: self.fill.0,
        };
        if let Some(volume) = self.volume_ml {
            let with = |fullness| Implant { fullness, ..implant }.size();
            let filled = with(None).and_then(|size| size.filled_to(volume));
            let filled =
                filled.map_err(|error| problem("implant.volume_ml", &error.to_string()))?;
            match self.fullness.map(|fullness| with(Some(fullness))) {
                None => implant.fullness = Some(filled.fullness()),
                // Both may have finished digits.
                Some(Ok(size)) if (size.volume_ml() / volume - 1.0).abs() > SAME_VOLUME => {
                    let given = number((10.0 * size.volume_ml()).round() / 10.0);
                    let both = format!(
                        "{} ml, and implant.fullness gives {given} ml; allowed: one of the two, or equal volumes",
                        number(volume)
                    );
                    return Err(problem("implant.volume_ml", &both));
                }
                Some(_) => {}
            }
        }
        Ok(implant.in_few_words())
    }
}

/// An implant with its reference, as it is written.
#[derive(Serialize)]
pub(super) struct Named<'a> {
    #[serde(flatten)]
    pub(super) implant: Implant,
    #[serde(skip_serializing_if = "str::is_empty")]
    pub(super) reference: &'a str,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

impl Implant {
    /// Height of the base along the body \[mm\]; twice the base radius of a round base.
    #[must_use]
    pub fn base_height(&self) -> f64 {
        self.base_height_mm.unwrap_or(2.0 * self.base_radius_mm)
    }

    /// Volume by π a b p \[-\]; ⅔ of half of an ellipsoid.
    #[must_use]
    pub fn fullness(&self) -> f64 {
        self.fullness.unwrap_or(HALF_ELLIPSOID)
    }

    /// The shape at rest.
    #[must_use]
    pub fn shape(&self) -> HalfBall {
        HalfBall::round(self.base_radius_mm, self.projection_mm)
            .anatomical(0.5 * self.base_height(), self.apex_shift_mm)
            .filled(self.fullness())
    }

    /// The shape as the tissue meets it: one that yields by its fill, under its weight in a posture.
    #[must_use]
    pub fn body(&self, posture: Posture) -> Shape {
        let Some(fill) = self.fill else { return self.shape().into() };
        let body = Deformed::at_rest(self.shape(), fill.modulus_kpa(self.base_radius_mm));
        body.of_weight(posture.weight(fill)).into()
    }

    /// Is the implant a solid of revolution?
    #[must_use]
    pub fn is_round(&self) -> bool {
        let Self { base_height_mm, apex_shift_mm, .. } = self.in_few_words();
        base_height_mm.is_none() && apex_shift_mm == 0.0
    }

    /// Makes the implant a solid of revolution of its width and projection.
    pub fn make_round(&mut self) {
        (self.base_height_mm, self.apex_shift_mm) = (None, 0.0);
    }

    /// Half of the base's width or height, whichever is greater \[mm\].
    #[must_use]
    pub fn greatest_half_axis_mm(&self) -> f64 {
        self.base_radius_mm.max(0.5 * self.base_height())
    }

    /// Least radius of a pocket that holds the base \[mm\].
    #[must_use]
    pub fn least_pocket_mm(&self) -> f64 {
        self.greatest_half_axis_mm() + self.center_mm[0].hypot(self.center_mm[1])
    }

    /// Does the base cover a place over the plane, from the pocket's centre \[mm\]?
    pub(crate) fn covers(&self, place: DVec2) -> bool {
        let dome = Dome::new(DVec2::from(self.center_mm), self.shape(), 1.0);
        dome.gauge(place.extend(0.0)) < 0.0
    }

    /// Does another implant have the same size and shape, in whatever place?
    #[must_use]
    pub fn has_size_of(&self, other: &Self) -> bool {
        let alike = Self { center_mm: other.center_mm, fill: other.fill, ..self.in_few_words() };
        alike == other.in_few_words()
    }

    /// Sets the base radius \[mm\]; an anatomical implant keeps its proportions.
    pub fn set_base_radius(&mut self, radius_mm: f64) {
        let factor = radius_mm / self.base_radius_mm;
        if let Some(height) = &mut self.base_height_mm {
            *height *= factor;
        }
        if self.apex_shift_mm != 0.0 {
            self.apex_shift_mm *= factor;
        }
        self.base_radius_mm = radius_mm;
    }

    /// The same implant without a height of its base that is that of a round base, and without a fullness that is that of half of an
    /// ellipsoid.
    #[must_use]
    pub fn in_few_words(&self) -> Self {
        let round = 2.0 * self.base_radius_mm;
        let base_height_mm =
            self.base_height_mm.filter(|height| (height - round).abs() > 1e-9 * round);
        let fullness = self.fullness.filter(|of| (of - HALF_ELLIPSOID).abs() > 1e-9);
        Self { base_height_mm, fullness, ..*self }
    }

    /// Base width, projection and volume.
    ///
    /// # Errors
    /// One line if base, projection or fullness is out of its limits.
    pub fn size(&self) -> Result<Size, ClinicalError> {
        let width = 2.0 * self.base_radius_mm;
        let few = self.in_few_words();
        let size = Size::of_width_and_projection(width, self.projection_mm)?
            .with_fullness(few.fullness())?;
        Ok(match few.base_height_mm {
            Some(height) => size.with_aspect(height / width),
            None => size,
        })
    }
}

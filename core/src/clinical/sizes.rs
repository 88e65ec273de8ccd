//! Sizes of implants and expanders: base width, projection, volume, profile class.
//!
//! The volume is that of the shape ([`HalfBall`]), which is linear in the projection, quadratic in the base width, and linear in the fullness, the
//! volume by that of the cylinder around the dome.

use super::{ClinicalError, checked, limits, rounded};
use crate::contact::{Geometry, HALF_ELLIPSOID, HalfBall};
use serde::{Deserialize, Serialize};

/// mm³ per ml (= cm³).
const MM3_PER_ML: f64 = 1000.0;

/// Volumes of all domes within the limits of base width, projection and fullness, rounded outwards \[ml\].
const VOLUME_ML: (f64, f64) = (0.3, 4350.0);

/// Ratio projection / half base width above which a dome is no half sphere any more: as far from 1 as the lower limit of
/// the class.
const BEYOND_HALF_SPHERE: f64 = 1.05;

/// Base width, projection and volume of a dome; with the aspect of the base and the fullness any two give the third.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Size {
    base_width_mm: f64,
    projection_mm: f64,
    /// Height by width of the base \[-\]; 1 is round.
    aspect: f64,
    /// Volume by π a b p \[-\].
    fullness: f64,
}

/// One of the three dimensions of a [`Size`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Dimension {
    /// Base width \[mm\].
    BaseWidth,
    /// Projection \[mm\].
    Projection,
    /// Volume \[ml\].
    Volume,
}

impl Size {
    /// A hemisphere of 1 mm, whose proportions a size takes that states no others.
    const HEMISPHERE: Self =
        Self { base_width_mm: 2.0, projection_mm: 1.0, aspect: 1.0, fullness: HALF_ELLIPSOID };

    /// The round size of a base width and a projection \[mm\].
    ///
    /// # Errors
    /// A base width outside of 20–240 mm or a projection outside of 2–120 mm.
    pub fn of_width_and_projection(
        base_width_mm: f64,
        projection_mm: f64,
    ) -> Result<Self, ClinicalError> {
        Ok(Self {
            base_width_mm: checked("base width", base_width_mm, limits::BASE_WIDTH_MM, " mm")?,
            projection_mm: checked("projection", projection_mm, limits::PROJECTION_MM, " mm")?,
            aspect: 1.0,
            fullness: HALF_ELLIPSOID,
        })
    }

    /// The size with another fullness \[-\]; width and projection stay.
    ///
    /// # Errors
    /// A fullness outside of 0.55–0.8.
    pub fn with_fullness(self, fullness: f64) -> Result<Self, ClinicalError> {
        let fullness = checked("fullness", fullness, limits::FULLNESS, "")?;
        Ok(Self { fullness, ..self })
    }

    /// The size with the fullness that gives a volume \[ml\]; width and projection stay.
    ///
    /// # Errors
    /// A volume that gives a fullness outside of 0.55–0.8.
    pub fn filled_to(self, volume_ml: f64) -> Result<Self, ClinicalError> {
        let cylinder = Self { fullness: 1.0, ..self }.volume_ml();
        let given = || {
            let [width, height, projection] =
                [self.base_width_mm, self.base_height_mm(), self.projection_mm].map(rounded);
            let base = if (self.aspect - 1.0).abs() < 1e-9 {
                width
            } else {
                format!("{width} × {height}")
            };
            let volume = rounded(volume_ml);
            format!("{volume} ml on a base of {base} mm at a projection of {projection} mm")
        };
        let of = ("fullness", "");
        let fullness = derived(of, volume_ml / cylinder, limits::FULLNESS, volume_ml, given)?;
        // A volume in finished digits of half of an ellipsoid.
        let is_half_ellipsoid = (fullness - HALF_ELLIPSOID).abs() < 1e-9;
        Ok(Self { fullness: if is_half_ellipsoid { HALF_ELLIPSOID } else { fullness }, ..self })
    }

    /// The size with another height of the base than its width: height by width \[-\].
    #[must_use]
    pub fn with_aspect(self, aspect: f64) -> Self {
        Self { aspect, ..self }
    }

    /// The round size of a base width \[mm\] and a volume \[ml\].
    ///
    /// # Errors
    /// A base width out of its range, or a volume that gives a projection outside of 2–120 mm.
    pub fn of_width_and_volume(base_width_mm: f64, volume_ml: f64) -> Result<Self, ClinicalError> {
        Self::HEMISPHERE.with_volume(base_width_mm, volume_ml)
    }

    fn with_volume(self, base_width_mm: f64, volume_ml: f64) -> Result<Self, ClinicalError> {
        let width = checked("base width", base_width_mm, limits::BASE_WIDTH_MM, " mm")?;
        let flat = Self { base_width_mm: width, projection_mm: 1.0, ..self };
        let projection = volume_ml / flat.volume_ml();
        let given = || format!("{} ml on a base of {} mm", rounded(volume_ml), rounded(width));
        let allowed = limits::PROJECTION_MM;
        let of = ("projection", " mm");
        let projection_mm = derived(of, projection, allowed, volume_ml, given)?;
        Ok(Self { projection_mm, ..flat })
    }

    fn with_projection(self, projection_mm: f64, volume_ml: f64) -> Result<Self, ClinicalError> {
        let projection = checked("projection", projection_mm, limits::PROJECTION_MM, " mm")?;
        let narrow = Self { base_width_mm: 1.0, projection_mm: projection, ..self };
        let width = (volume_ml / narrow.volume_ml()).sqrt();
        let given =
            || format!("{} ml at a projection of {} mm", rounded(volume_ml), rounded(projection));
        let of = ("base width", " mm");
        let base_width_mm = derived(of, width, limits::BASE_WIDTH_MM, volume_ml, given)?;
        Ok(Self { base_width_mm, ..narrow })
    }

    /// The size after a change of one dimension \[mm or ml\], with another dimension locked and the same aspect and fullness. With the changed dimension
    /// as the locked one, base width is locked, and projection for a change of the base width.
    ///
    /// # Errors
    /// As of the constructors.
    pub fn changed(
        self,
        dimension: Dimension,
        value: f64,
        locked: Dimension,
    ) -> Result<Self, ClinicalError> {
        use Dimension::{BaseWidth, Projection, Volume};
        let (width, projection, volume) =
            (self.base_width_mm, self.projection_mm, self.volume_ml());
        let size = |width, projection| {
            let size = Self::of_width_and_projection(width, projection)?;
            Ok(Self { aspect: self.aspect, fullness: self.fullness, ..size })
        };
        match (dimension, locked) {
            (BaseWidth, Volume) => self.with_volume(value, volume),
            (BaseWidth, _) => size(value, projection),
            (Projection, Volume) => self.with_projection(value, volume),
            (Projection, _) => size(width, value),
            (Volume, Projection) => self.with_projection(projection, value),
            (Volume, _) => self.with_volume(width, value),
        }
    }

    /// The size with another height of the base \[mm\]; one of the three dimensions follows.
    ///
    /// # Errors
    /// As of the constructors.
    pub fn with_base_height(
        self,
        height_mm: f64,
        follows: Dimension,
    ) -> Result<Self, ClinicalError> {
        let (width, volume) = (self.base_width_mm, self.volume_ml());
        match follows {
            Dimension::Volume => Ok(self.with_aspect(height_mm / width)),
            Dimension::Projection => self.with_aspect(height_mm / width).with_volume(width, volume),
            Dimension::BaseWidth => {
                let width = width * self.base_height_mm() / height_mm;
                let size = Self::of_width_and_projection(width, self.projection_mm)?;
                Ok(Self { aspect: height_mm / width, fullness: self.fullness, ..size })
            }
        }
    }

    /// Base width \[mm\], twice the base radius.
    #[must_use]
    pub fn base_width_mm(self) -> f64 {
        self.base_width_mm
    }

    /// Height of the base along the body \[mm\].
    #[must_use]
    pub fn base_height_mm(self) -> f64 {
        self.base_width_mm * self.aspect
    }

    /// Height by width of the base \[-\]; 1 is round.
    #[must_use]
    pub fn aspect(self) -> f64 {
        self.aspect
    }

    /// Volume by that of the elliptic cylinder around the dome, π a b p \[-\]; ⅔ is half of an ellipsoid.
    #[must_use]
    pub fn fullness(self) -> f64 {
        self.fullness
    }

    /// Projection \[mm\].
    #[must_use]
    pub fn projection_mm(self) -> f64 {
        self.projection_mm
    }

    /// Volume \[ml\].
    #[must_use]
    pub fn volume_ml(self) -> f64 {
        let half_width = 0.5 * self.base_width_mm;
        let shape = HalfBall::round(half_width, self.projection_mm)
            .anatomical(half_width * self.aspect, 0.0)
            .filled(self.fullness);
        shape.volume() / MM3_PER_ML
    }

    /// Projection \[cm\].
    #[must_use]
    pub fn projection_cm(self) -> f64 {
        self.projection_mm / 10.0
    }

    /// Projection / half base width \[-\]; 1 is a half sphere.
    #[must_use]
    pub fn ratio(self) -> f64 {
        self.projection_mm / (0.5 * self.base_width_mm)
    }

    /// The profile class.
    #[must_use]
    pub fn profile(self) -> ProfileClass {
        ProfileClass::of_ratio(self.ratio())
    }

    /// The profile in words: that of the class, beyond a half sphere with its own.
    #[must_use]
    pub fn profile_in_words(self) -> &'static str {
        if self.is_beyond_half_sphere() { "beyond a half sphere" } else { self.profile().word() }
    }

    /// Is the dome clearly steeper than a half sphere: projection / half base width above 1.05?
    #[must_use]
    pub fn is_beyond_half_sphere(self) -> bool {
        self.ratio() > BEYOND_HALF_SPHERE
    }

    /// Does the size lie within the range of typical round implants: base 78–180 mm, projection 20–75 mm, 95–965 ml,
    /// projection / half base width 0.39–1.07?
    #[must_use]
    pub fn is_typical(self) -> bool {
        let is_in = |value: f64, (least, most): (f64, f64)| (least..=most).contains(&value);
        is_in(self.base_width_mm, limits::TYPICAL_WIDTH_MM)
            && is_in(self.projection_mm, limits::TYPICAL_PROJECTION_MM)
            && is_in(self.volume_ml(), limits::TYPICAL_VOLUME_ML)
            && is_in(self.ratio(), limits::TYPICAL_RATIO)
    }
}

/// Checks a volume and the quantity, with its unit, that the volume gives.
fn derived(
    (quantity, unit): (&'static str, &'static str),
    value: f64,
    allowed: (f64, f64),
    volume_ml: f64,
    given: impl Fn() -> String,
) -> Result<f64, ClinicalError> {
    checked("volume", volume_ml, VOLUME_ML, " ml")?;
    if (allowed.0 * (1.0 - 1e-12)..=allowed.1 * (1.0 + 1e-12)).contains(&value) {
        return Ok(value.clamp(allowed.0, allowed.1));
    }
    Err(ClinicalError::Derived { given: given(), quantity, value, allowed, unit })
}

/// Profile class of a round implant by projection / half base width.
///
/// The limits 0.50, 0.72 and 0.95 lie between what makers call low, moderate or moderate plus, high and extra high; their
/// names have no common limits (docs/theory.md, Sizes). Typical round implants have ratios of 0.39–1.07.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProfileClass {
    /// Ratio below 0.50.
    Low,
    /// Ratio of 0.50 to below 0.72.
    Moderate,
    /// Ratio of 0.72 to below 0.95.
    High,
    /// Ratio of 0.95 or more.
    HalfSphere,
}

impl ProfileClass {
    /// All classes, from the flattest.
    pub const ALL: [Self; 4] = [Self::Low, Self::Moderate, Self::High, Self::HalfSphere];

    /// The class of a ratio projection / half base width \[-\].
    #[must_use]
    pub fn of_ratio(ratio: f64) -> Self {
        match ratio {
            ratio if ratio < 0.50 => Self::Low,
            ratio if ratio < 0.72 => Self::Moderate,
            ratio if ratio < 0.95 => Self::High,
            _ => Self::HalfSphere,
        }
    }

    /// Words and a ratio in the middle of the class \[-\].
    fn row(self) -> (&'static str, f64) {
        match self {
            Self::Low => ("low", 0.45),
            Self::Moderate => ("moderate", 0.57),
            Self::High => ("high", 0.78),
            Self::HalfSphere => ("half sphere", 1.0),
        }
    }

    /// A ratio in the middle of the class \[-\], for a choice of the class.
    #[must_use]
    pub fn ratio(self) -> f64 {
        self.row().1
    }

    /// The class in words.
    #[must_use]
    pub fn word(self) -> &'static str {
        self.row().0
    }
}

/// Typical round sizes without brands, in the order of base width and projection: base widths in steps of 6 mm, the
/// ratios of the profile classes, projections in whole mm.
///
/// The table is generated: the volumes are those of the half-ellipsoid dome, not of a catalogue. Every size is typical
/// ([`Size::is_typical`]).
#[must_use]
pub fn typical_sizes() -> Vec<Size> {
    let (least, most) = limits::TYPICAL_WIDTH_MM;
    let widths = (0_u32..).map(|k| least + 6.0 * f64::from(k)).take_while(|width| *width <= most);
    let sizes = widths.flat_map(|base_width_mm| {
        ProfileClass::ALL.map(|class| Size {
            base_width_mm,
            projection_mm: (0.5 * base_width_mm * class.ratio()).round(),
            ..Size::HEMISPHERE
        })
    });
    sizes.filter(|size| size.is_typical()).collect()
}

/// A tissue expander on a base of fixed width: the fill raises the dome.
///
/// The pocket fixes the base; the shell is a half-ellipsoid at every fill. An expander with a built-in shape differs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expander {
    base_width_mm: f64,
}

impl Expander {
    /// An expander on a base of a width \[mm\].
    ///
    /// # Errors
    /// A base width outside of 20–240 mm.
    pub fn new(base_width_mm: f64) -> Result<Self, ClinicalError> {
        checked("base width", base_width_mm, limits::BASE_WIDTH_MM, " mm")
            .map(|base_width_mm| Self { base_width_mm })
    }

    /// Base width \[mm\].
    #[must_use]
    pub fn base_width_mm(self) -> f64 {
        self.base_width_mm
    }

    /// The dome at a fill volume \[ml\].
    ///
    /// # Errors
    /// A fill that gives a projection outside of 2–120 mm.
    pub fn dome(self, fill_ml: f64) -> Result<Size, ClinicalError> {
        Size::of_width_and_volume(self.base_width_mm, fill_ml)
    }

    /// Least and greatest fill \[ml\]: projections of 2 and 120 mm.
    #[must_use]
    pub fn fills_ml(self) -> (f64, f64) {
        let (least, most) = limits::PROJECTION_MM;
        let fill = |projection_mm| Size { projection_mm, ..self.flat() }.volume_ml();
        (fill(least), fill(most))
    }

    /// The domes of `steps` equal fills up to a volume \[ml\]; the last one is the full expander. Fills below the least
    /// fill are left out.
    ///
    /// # Errors
    /// A volume that gives a projection outside of 2–120 mm.
    pub fn filling(self, full_ml: f64, steps: u16) -> Result<Vec<Size>, ClinicalError> {
        self.dome(full_ml)?;
        let (least, _) = self.fills_ml();
        let fills = (1..=steps).map(|k| full_ml * f64::from(k) / f64::from(steps));
        fills.filter(|fill| *fill >= least).map(|fill| self.dome(fill)).collect()
    }

    fn flat(self) -> Size {
        Size {
            base_width_mm: self.base_width_mm,
            projection_mm: limits::PROJECTION_MM.0,
            ..Size::HEMISPHERE
        }
    }
}

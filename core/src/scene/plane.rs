//! The plane of the pocket: above the muscle, below it, or below its upper part.
//!
//! Above there is no muscle over the implant. Below, the innermost layer is the muscle, of a thickness of its own. In a dual plane it ends at a line across the
//! body: at the fold (I), at the lower edge of the areola (II) or at its upper edge (III); towards the feet only fat and skin lie over the implant.

use super::{Field, Layer, Scene, SceneError, out_of_range, problem};
use crate::curve::{CurveSpec, number, present};
use crate::mesh::Taper;
use crate::springs::Material;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where the pocket is, of those with a muscle over the implant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
pub enum Plane {
    /// Below the muscle, which covers the implant down to the fold.
    #[serde(rename = "dual_1")]
    DualPlaneI,
    /// Below the muscle, which covers the implant down to the lower edge of the areola.
    #[serde(rename = "dual_2")]
    DualPlaneIi,
    /// Below the muscle, which covers the implant down to the upper edge of the areola.
    #[serde(rename = "dual_3")]
    DualPlaneIii,
    /// Below the muscle, which covers all of the implant.
    #[serde(rename = "below")]
    Below,
}

/// The plane of the pocket in a file.
#[derive(Clone, Copy, Debug, Default, Deserialize, JsonSchema)]
#[schemars(rename = "PocketPlane")]
pub(super) enum PlaneFile {
    /// Above the muscle: no layer over the implant is one.
    #[default]
    #[serde(rename = "above")]
    Above,
    /// Below the muscle, which covers the implant down to the fold.
    #[serde(rename = "dual_1")]
    DualPlaneI,
    /// Below the muscle, which covers the implant down to the lower edge of the areola.
    #[serde(rename = "dual_2")]
    DualPlaneIi,
    /// Below the muscle, which covers the implant down to the upper edge of the areola.
    #[serde(rename = "dual_3")]
    DualPlaneIii,
    /// Below the muscle, which covers all of the implant.
    #[serde(rename = "below")]
    Below,
}

impl From<PlaneFile> for Option<Plane> {
    fn from(file: PlaneFile) -> Self {
        match file {
            PlaneFile::Above => None,
            PlaneFile::DualPlaneI => Some(Plane::DualPlaneI),
            PlaneFile::DualPlaneIi => Some(Plane::DualPlaneIi),
            PlaneFile::DualPlaneIii => Some(Plane::DualPlaneIii),
            PlaneFile::Below => Some(Plane::Below),
        }
    }
}

/// The muscle in a file.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "one JSON object")]
pub(super) struct Muscle {
    /// Thickness of its belly \[mm\], 0.2 to 60; women have 6 to 12.
    #[serde(deserialize_with = "present")]
    thickness_mm: f64,
    /// Young's modulus at rest \[kPa\], 0.1 to 1000: about 3 across its fibres and 10 and more along them.
    #[serde(deserialize_with = "present")]
    modulus_kpa: f64,
}

impl Default for Muscle {
    fn default() -> Self {
        Self { thickness_mm: THICKNESS_MM, modulus_kpa: MODULUS_KPA }
    }
}

/// Radius of the areola about the pocket's centre \[mm\].
const AREOLA_MM: f64 = 20.0;
/// Width of the step at the muscle's edge \[mm\].
const STEP_MM: f64 = 15.0;
/// Thickness of the muscle's belly \[mm\]; women have 6 to 12.
const THICKNESS_MM: f64 = 8.0;
/// Young's modulus of the muscle at rest \[kPa\], about 3 across its fibres and 10 and more along them.
const MODULUS_KPA: f64 = 5.0;
/// Allowed moduli \[kPa\].
const MODULI_KPA: (f64, f64) = (0.1, 1000.0);
/// Rate of its exponential curve \[-\], as that of fat as measured.
const RATE: f64 = 5.0;

impl Plane {
    /// All planes with a muscle over the implant, from the one that covers least.
    pub const ALL: [Self; 4] =
        [Self::DualPlaneIii, Self::DualPlaneIi, Self::DualPlaneI, Self::Below];

    /// The plane in words.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::DualPlaneI => "dual plane I",
            Self::DualPlaneIi => "dual plane II",
            Self::DualPlaneIii => "dual plane III",
            Self::Below => "below the muscle",
        }
    }

    /// The muscle's edge in a pocket that reaches so far down \[mm\], under a layer of a modulus by its own.
    fn taper(self, pocket_reach_mm: f64, modulus_above: f64) -> Taper {
        let at = |at_mm: f64| Taper { at_mm, width_mm: STEP_MM, modulus_above };
        match self {
            Self::DualPlaneI => at(-pocket_reach_mm),
            Self::DualPlaneIi => at(-AREOLA_MM),
            Self::DualPlaneIii => at(AREOLA_MM),
            Self::Below => Taper::WHOLE,
        }
    }
}

impl Layer {
    /// Is the layer a muscle, by its name?
    pub(crate) fn is_muscle(&self) -> bool {
        self.tissue == MUSCLE
    }

    /// Muscle, exponential, ν = 0.49.
    fn muscle(Muscle { thickness_mm, modulus_kpa }: Muscle) -> Self {
        let curve = CurveSpec::Exponential { scale_kpa: modulus_kpa / RATE, rate: RATE };
        Self { tissue: MUSCLE.to_owned(), thickness_mm, poisson_ratio: 0.49, curve: curve.into() }
    }
}

/// Name of the muscle among the layers.
const MUSCLE: &str = "muscle";

impl Scene {
    /// Has the scene a muscle as its innermost layer?
    fn has_muscle(&self) -> bool {
        self.layers.last().is_some_and(Layer::is_muscle)
    }

    /// Thickness of the muscle's belly \[mm\], the innermost layer below the muscle; 0 above it.
    #[must_use]
    pub fn muscle_mm(&self) -> f64 {
        let muscle = self.layers.last().filter(|_| self.body.plane.is_some());
        muscle.map_or(0.0, |layer| layer.thickness_mm)
    }

    /// Adds the muscle of a plane to a scene without one.
    fn add_muscle(&mut self, muscle: Muscle) {
        if self.body.plane.is_some() && self.is_layered() && !self.has_muscle() {
            self.layers.push(Layer::muscle(muscle));
        }
    }

    /// Adds the muscle of a file, by default 8 mm of 5 kPa.
    ///
    /// # Errors
    /// A muscle without a plane below it, beside a layer of that name, or out of its limits.
    pub(super) fn read_muscle(&mut self, given: Option<Muscle>) -> Result<(), SceneError> {
        if let Some(Muscle { thickness_mm, modulus_kpa }) = given {
            let refused = |allowed: &str| Err(problem("muscle", allowed));
            if self.body.plane.is_none() {
                return refused("given without its plane; allowed: with a `pocket_plane` below it");
            }
            if self.has_muscle() {
                return refused("given beside a layer `muscle`; allowed: one of both");
            }
            for (path, value, (least, most)) in [
                ("muscle.thickness_mm", thickness_mm, Field::Thickness.limits),
                ("muscle.modulus_kpa", modulus_kpa, MODULI_KPA),
            ] {
                if !(least..=most).contains(&value) {
                    let allowed = format!("{} to {}", number(least), number(most));
                    return Err(out_of_range(path, number(value), &allowed));
                }
            }
        }
        self.add_muscle(given.unwrap_or_default());
        Ok(())
    }

    /// Sets the plane of the pocket; `None`: above the muscle, which is then no layer of the tissue over the implant.
    pub fn set_plane(&mut self, plane: Option<Plane>) {
        let before = std::mem::replace(&mut self.body.plane, plane);
        if plane.is_some() {
            self.add_muscle(Muscle::default());
        } else if before.is_some() && self.has_muscle() {
            self.layers.pop();
        }
    }

    /// The edge of the muscle among materials from the skin inwards.
    pub(super) fn muscle_taper(&self, materials: &[Material]) -> Option<Taper> {
        let [.., above, muscle] = materials else { return None };
        let modulus = |of: &Material| of.curve.small_strain_modulus();
        Some(self.body.plane?.taper(self.pocket_reach_mm(), modulus(above) / modulus(muscle)))
    }

    /// Checks that the scene may have a plane.
    pub(super) fn check_plane(&self) -> Result<(), SceneError> {
        let Some(plane) = self.body.plane else { return Ok(()) };
        let refused =
            |allowed: &str| Err(out_of_range("pocket_plane", plane.words().to_owned(), allowed));
        if !self.is_layered() {
            return refused("in layered tissue only");
        }
        if !self.has_muscle() || self.layers.len() < 3 {
            return refused("with a layer `muscle` under skin and another layer");
        }
        Ok(())
    }
}

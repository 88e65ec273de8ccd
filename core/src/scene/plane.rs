//! The plane of the pocket: above the muscle, below it, or below its upper part.
//!
//! Above there is no muscle over the implant. Below, the innermost layer is the muscle, of a thickness of its own. In a dual plane it ends at a line across the
//! body: at the fold (I), at the lower edge of the areola (II) or at its upper edge (III); towards the feet only fat and skin lie over the implant.

use super::{Layer, Scene, SceneError, out_of_range};
use crate::curve::CurveSpec;
use crate::mesh::Taper;
use crate::springs::Material;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where the pocket is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Plane {
    /// Below the muscle, which covers the implant down to the fold.
    DualPlaneI,
    /// Below the muscle, which covers the implant down to the lower edge of the areola.
    DualPlaneIi,
    /// Below the muscle, which covers the implant down to the upper edge of the areola.
    DualPlaneIii,
    /// Below the muscle, which covers all of the implant.
    Below,
}

/// Radius of the areola about the pocket's centre \[mm\].
const AREOLA_MM: f64 = 20.0;
/// Width of the step at the muscle's edge \[mm\].
const STEP_MM: f64 = 15.0;
/// Thickness of the muscle's belly \[mm\]; women have 6 to 12.
const THICKNESS_MM: f64 = 8.0;
/// Young's modulus of the muscle at rest \[kPa\], about 3 across its fibres and 10 and more along them.
const MODULUS_KPA: f64 = 5.0;
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

    /// The muscle's edge in a pocket of a radius \[mm\], under a layer of a modulus by its own.
    fn taper(self, pocket_radius_mm: f64, modulus_above: f64) -> Taper {
        let at = |at_mm: f64| Taper { at_mm, width_mm: STEP_MM, modulus_above };
        match self {
            Self::DualPlaneI => at(-pocket_radius_mm),
            Self::DualPlaneIi => at(-AREOLA_MM),
            Self::DualPlaneIii => at(AREOLA_MM),
            Self::Below => Taper::WHOLE,
        }
    }
}

impl Layer {
    /// Muscle, 8 mm of 5 kPa, exponential, ν = 0.49.
    #[must_use]
    pub fn muscle() -> Self {
        let curve = CurveSpec::Exponential { scale_kpa: MODULUS_KPA / RATE, rate: RATE };
        Self {
            tissue: MUSCLE.to_owned(),
            thickness_mm: THICKNESS_MM,
            poisson_ratio: 0.49,
            curve: curve.into(),
        }
    }
}

/// Name of the muscle among the layers.
const MUSCLE: &str = "muscle";

impl Scene {
    /// Has the scene a muscle as its innermost layer?
    fn has_muscle(&self) -> bool {
        self.layers.last().is_some_and(|layer| layer.tissue == MUSCLE)
    }

    /// Adds the muscle of a plane to a scene without one.
    pub(super) fn add_muscle(&mut self) {
        if self.body.plane.is_some() && self.is_layered() && !self.has_muscle() {
            self.layers.push(Layer::muscle());
        }
    }

    /// Sets the plane of the pocket; `None`: above the muscle, which is then no layer of the tissue over the implant.
    pub fn set_plane(&mut self, plane: Option<Plane>) {
        let before = std::mem::replace(&mut self.body.plane, plane);
        if plane.is_some() {
            self.add_muscle();
        } else if before.is_some() && self.has_muscle() {
            self.layers.pop();
        }
    }

    /// The edge of the muscle among materials from the skin inwards.
    pub(super) fn muscle_taper(&self, materials: &[Material]) -> Option<Taper> {
        let [.., above, muscle] = materials else { return None };
        let modulus = |of: &Material| of.curve.small_strain_modulus();
        Some(self.body.plane?.taper(self.pocket_radius_mm, modulus(above) / modulus(muscle)))
    }

    /// Checks that the scene may have a plane.
    pub(super) fn check_plane(&self) -> Result<(), SceneError> {
        let Some(plane) = self.body.plane else { return Ok(()) };
        let refused = |allowed: &str| Err(out_of_range("plane", plane.words().to_owned(), allowed));
        if !self.is_layered() {
            return refused("in layered tissue only");
        }
        if !self.has_muscle() || self.layers.len() < 3 {
            return refused("with a layer `muscle` under skin and another layer");
        }
        Ok(())
    }
}

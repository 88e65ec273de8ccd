//! The implant as it is in the body, if it yields.

use crate::solve::Solution;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The implant in the body: of one that yields.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ImplantInBody {
    /// Height of its apex above its base \[mm\]; the catalogue's is the projection.
    pub height_mm: f64,
    /// Greatest half of its width and of its height along the body \[mm\].
    pub half_width_mm: [f64; 2],
    /// Share of its volume above the centre of its base, towards the head \[-\].
    pub upper_pole_share: f64,
    /// Young's modulus of its body, the shell's part included \[kPa\].
    pub modulus_kpa: f64,
    /// Elastic energy of its body \[mJ\].
    pub energy_mj: f64,
    /// Its deformation.
    pub deformation: Yielded,
}

/// The numbers of the deformation of an implant's body \[-\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Yielded {
    /// Flattening of the body.
    pub flattening: f64,
    /// Widening of the upper sections.
    pub taper: f64,
    /// Volume moved from the middle to the shoulders.
    pub shoulder: f64,
    /// Widening across the body, narrowing along it.
    pub widening: f64,
    /// Shears across and along the body.
    pub shear: [f64; 2],
    /// Tilts across and along the body: thicker towards +x, towards +y, by so much at half the width.
    pub tilt: [f64; 2],
}

/// Flattening up to which the deformations describe a body \[-\] (docs/theory.md, limits of the soft implant).
const TRUSTED_FLATTENING: f64 = 0.3;

/// A warning for an implant that lies flatter than its deformations are trusted.
pub(super) fn warning(solution: &Solution) -> Option<String> {
    let [flattening, ..] = solution.problem().obstacle.dome.shape.soft()?.modes();
    (flattening > TRUSTED_FLATTENING).then(|| {
        format!(
            "The implant is flattened by {:.0} %; its computed shape is not trusted beyond {:.0} %.",
            100.0 * flattening,
            100.0 * TRUSTED_FLATTENING
        )
    })
}

/// Of a solution; `None` of an implant that does not yield.
pub(super) fn of(solution: &Solution) -> Option<ImplantInBody> {
    let dome = &solution.problem().obstacle.dome;
    let soft = dome.shape.soft()?;
    let [flattening, taper, shoulder, widening, across, along, tilt @ ..] = soft.modes();
    Some(ImplantInBody {
        height_mm: dome.projection(),
        half_width_mm: soft.greatest_half_axes().to_array(),
        upper_pole_share: soft.upper_share(),
        modulus_kpa: soft.modulus_kpa(),
        // kPa·mm³ are µJ.
        energy_mj: soft.energy() / 1000.0,
        deformation: Yielded {
            flattening,
            taper,
            shoulder,
            widening,
            shear: [across, along],
            tilt,
        },
    })
}

//! The posture in which a body was measured and is shown: the direction of the weight of an implant that yields.
//!
//! Tissue is measured under its own weight, which moves with it: the load at rest and that of a shape are equal, and cancel. The implant's weight
//! is new. Its base stays on the wall, so that a rigid implant has the same shape and place in every posture.

use super::Fill;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Gravity \[m/s²\].
const GRAVITY: f64 = 9.81;
/// Densities of gel and of saline \[kg/m³\].
const GEL: f64 = 970.0;
const SALINE: f64 = 1005.0;

/// The posture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Posture {
    /// No weight.
    #[default]
    None,
    /// On the back: weight towards the wall, along −z.
    Lying,
    /// Upright: weight towards the feet, along −y.
    Standing,
}

impl Posture {
    /// All postures.
    pub const ALL: [Self; 3] = [Self::None, Self::Lying, Self::Standing];

    /// Weight per volume of an implant's fill \[kPa/mm\].
    pub(super) fn weight(self, fill: Fill) -> DVec3 {
        let down = match self {
            Self::None => DVec3::ZERO,
            Self::Lying => DVec3::NEG_Z,
            Self::Standing => DVec3::NEG_Y,
        };
        let density = if fill == Fill::Saline { SALINE } else { GEL };
        // kg/m³ · m/s² = 1e-6 kPa/mm.
        down * (1e-6 * density * GRAVITY)
    }
}

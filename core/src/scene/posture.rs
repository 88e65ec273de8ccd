//! The posture in which a body is shown: the direction of weight.
//!
//! The body was measured standing, under the weight of its tissue: that load is in equilibrium, and standing it does not change. Lying the
//! tissue has the difference of both weights as a load. The weight of an implant that yields is new in either posture. Its base stays on the wall, so that a
//! rigid implant has the same shape and place in every posture.

use super::Fill;
use crate::mesh::Weight;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Gravity \[m/s²\].
const GRAVITY: f64 = 9.81;
/// Densities of gel, of saline and of tissue \[kg/m³\]; adipose tissue has 950, mammary tissue 1020, skin 1090 (ICRU Report 44, 1989).
const GEL: f64 = 970.0;
const SALINE: f64 = 1005.0;
const TISSUE: f64 = 980.0;

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

    /// Direction of weight; zero without weight.
    fn down(self) -> DVec3 {
        match self {
            Self::None => DVec3::ZERO,
            Self::Lying => DVec3::NEG_Z,
            Self::Standing => DVec3::NEG_Y,
        }
    }

    /// Weight per volume of an implant's fill \[kPa/mm\].
    pub(super) fn weight(self, fill: Fill) -> DVec3 {
        weight(self.down(), if fill == Fill::Saline { SALINE } else { GEL })
    }

    /// Change of the tissue's weight since the body was measured, standing, under skin of a thickness \[mm\].
    pub(super) fn change_of_weight(self, skin_mm: f64) -> Weight {
        let from = if self == Self::None { DVec3::ZERO } else { Self::Standing.down() };
        Weight { per_volume: weight(self.down() - from, TISSUE), skin_mm }
    }
}

/// Weight per volume \[kPa/mm\]: 1 kg/m³ · m/s² is 1e-6 kPa/mm.
fn weight(down: DVec3, density: f64) -> DVec3 {
    down * (1e-6 * density * GRAVITY)
}

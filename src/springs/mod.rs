//! Spring laws: how hard a spring of the sheet pulls, given the curve `Ef` and Poisson's ratio ν.
//!
//! Pure functions, each beside the equation it comes from. Uses `curve`; used by `solve`,
//! `measure`, `scene` and `experiment`.

pub(crate) mod closed_form;
pub mod coupled;
mod layer;
pub mod paper;
pub mod stability;
pub mod table;

pub use layer::Material;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which spring law carries the sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Springs {
    /// Springs of a triangle coupled through its metric: exact, isotropic, stable in tension.
    #[default]
    Coupled,
    /// The paper's equations (3) and (6) as published.
    Nikolaev,
}

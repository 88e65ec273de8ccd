//! Laws of the tissue from the curve `Ef` and Poisson's ratio ν: tension of a sheet's springs, energy of [`solids`].
//!
//! Pure functions, each beside its equation. Uses `curve`, `number`. Used by `model`, `solve`, `measure` and all to their
//! right.

pub(crate) mod closed_form;
pub mod coupled;
mod layer;
pub mod paper;
pub mod solids;
pub mod stability;
pub mod table;
pub mod tension_field;

pub use layer::Material;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The spring law of a sheet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Springs {
    /// Springs of a triangle coupled through its metric: exact, isotropic, stable in tension.
    #[default]
    Coupled,
    /// The paper's equations (3) and (6) as published.
    Nikolaev,
}

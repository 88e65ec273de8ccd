//! Bands in a file.

use super::map::MapSettings;
use super::{Index, Quantity, Unknown};
use crate::clinical::spread::Distribution;
use crate::scene::Scene;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// The schema of [`BandsReport`].
pub const BANDS_SCHEMA: &str = "implant-preview/bands/1";

/// A quantity over the samples \[unit of the quantity\].
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Band {
    /// The quantity.
    pub quantity: Quantity,
    /// The quantity in words.
    pub label: &'static str,
    /// Unit of the values.
    pub unit: &'static str,
    /// Value of the scene itself, on the grid of the samples.
    pub scene: Option<f64>,
    /// 10th percentile.
    pub p10: f64,
    /// Median.
    pub p50: f64,
    /// 90th percentile.
    pub p90: f64,
    /// Median and percentiles in words, as "22 mmHg, 14–33".
    pub text: String,
    /// Scenarios of the method of measurement.
    pub scenarios: Vec<Scenario>,
    /// Sobol indices by unknown.
    pub importance: BTreeMap<Unknown, Index>,
    /// Part of the variance that the polynomial behind the importance misses in samples without which it is fitted \[-\]; `None` for an
    /// importance from rows.
    pub importance_error: Option<f64>,
}

impl Band {
    /// The 10th and 90th percentile in words, without the unit, as "14–33".
    #[must_use]
    pub fn range(&self) -> &str {
        self.text.rsplit_once(", ").map_or("", |(_, range)| range)
    }
}

/// All stresses times a factor, all unknowns at their medians.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Scenario {
    /// Factor on all stresses \[-\].
    pub stress_factor: f64,
    /// The value; `None` if the solve has not converged.
    pub value: Option<f64>,
}

/// Percentiles (10, 50, 90) of the skin's outer surface at one material radius.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ProfileBand {
    /// Material radius \[mm\].
    pub s_mm: f64,
    /// Distance from the pocket's axis \[mm\].
    pub r_mm: [f64; 3],
    /// Height above the wall \[mm\].
    pub z_mm: [f64; 3],
}

/// An unknown in a report.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct UnknownReport {
    /// The name.
    pub name: Unknown,
    /// The unknown in words.
    pub quantity: &'static str,
    /// Unit of the distribution, or how the distribution acts on the value of the scene.
    pub acts_as: &'static str,
    /// The distribution.
    pub distribution: Distribution,
}

/// Bands in a file.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct BandsReport {
    /// `implant-preview/bands/1`.
    pub schema: &'static str,
    /// Sentences that belong to every band.
    pub notes: [&'static str; 3],
    /// Number of samples.
    pub samples: usize,
    /// Seed.
    pub seed: u32,
    /// Rows of the importance.
    pub importance_rows: usize,
    /// Grid and tolerance of the samples.
    pub grid: MapSettings,
    /// The scene.
    pub scene: Scene,
    /// The unknowns that vary.
    pub unknowns: Vec<UnknownReport>,
    /// Samples by state.
    pub counts: BTreeMap<&'static str, usize>,
    /// What the samples did not allow, as an importance from polynomials, in one line each.
    pub remarks: Vec<String>,
    /// Scenes solved or reused, with those of scenarios and importance.
    pub scenes_solved: usize,
    /// All scenes of the study.
    pub scenes_planned: usize,
    /// One entry for each quantity that applies.
    pub bands: Vec<Band>,
    /// Section of the skin, 41 points.
    pub profile: Vec<ProfileBand>,
    /// Warnings of the samples, with the number of samples.
    pub warnings: BTreeMap<String, usize>,
}

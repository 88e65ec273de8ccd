//! Bands: the results of one scene over what is not known about a person.
//!
//! The unknowns vary as between people ([`crate::clinical::spread`]), independently: no correlations are known. The
//! samples are those of a seeded low-discrepancy sequence; equal seeds give equal samples on every platform.

use super::bands_report::{BANDS_SCHEMA, Band, BandsReport, ProfileBand, Scenario, UnknownReport};
use super::fits::Fits;
use super::importance::MIN_ROWS;
use super::map::{MapSettings, base_scene};
use super::percentile;
use super::queue::{Queue, Queued};
use super::section_band::{SectionBand, section_band};
use super::sequence::{MAX_SAMPLES, quantile, unit_sample};
use super::{Case, PointStatus, Profile, Quantity, Unknown, same_words};
use crate::clinical::spread::{Distribution, METHOD_SCALES, Spread};
use crate::curve::{SCALES, given, whole};
use crate::measure::PROFILE_POINTS;
use crate::scene::{Scene, SceneError, read};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What every output of bands contains.
pub const NOTES: [&str; 3] = [
    "An illustration from a simplified model, not a prediction for a person.",
    "Correlations between the unknowns are not known; the unknowns vary independently.",
    "Methods of measurement differ more than people: the scenarios with all stresses × 0.4, × 1 and × 2.5, all unknowns at \
     their medians, stand beside the band, not in it.",
];

/// Choices of bands; absent fields have their defaults.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct BandsSettings {
    /// Number of samples, 16 to 16384.
    #[serde(deserialize_with = "whole")]
    pub samples: usize,
    /// Seed of the samples.
    #[serde(deserialize_with = "whole")]
    pub seed: u32,
    /// Rows of the importance, 0 (no importance) to `samples`, 16 at least. The importance is that of polynomials of the samples; rows
    /// are solved for a quantity whose polynomial misses more than 5 % of the variance. A row costs one scene more than there are
    /// unknowns.
    #[serde(deserialize_with = "whole")]
    pub importance_rows: usize,
    /// Grid and tolerance; default: 65 nodes of a sheet, 33 of layered tissue, 0.1 %.
    #[serde(deserialize_with = "given", skip_serializing_if = "Option::is_none")]
    #[schemars(with = "MapSettings")]
    pub grid: Option<MapSettings>,
    /// Other distributions of unknowns; `null` switches an unknown off.
    pub unknowns: BTreeMap<Unknown, Option<Distribution>>,
}

impl Default for BandsSettings {
    fn default() -> Self {
        Self { samples: 256, seed: 1, importance_rows: 64, grid: None, unknowns: BTreeMap::new() }
    }
}

impl BandsSettings {
    /// Reads choices from JSON; [`Bands::new`] checks their numbers.
    ///
    /// # Errors
    /// One line with the field and the error.
    pub fn from_json(json: &str) -> Result<Self, SceneError> {
        read::json(json, "choices")
    }
}

/// Allowed numbers of samples.
pub const SAMPLES: (usize, usize) = (16, MAX_SAMPLES / 4);

/// Error of the choices of bands, in one line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BandsError {
    /// A number is out of its range.
    #[error("{field} is {value}; allowed: {allowed}")]
    OutOfRange {
        /// The field.
        field: String,
        /// The given value.
        value: String,
        /// The allowed values.
        allowed: String,
    },
    /// The grid is out of its range.
    #[error("{0}")]
    Grid(String),
    /// The scene is out of its limits.
    #[error("{0}")]
    Scene(String),
    /// All unknowns are switched off.
    #[error("no unknown is left; allowed: one unknown or more")]
    NoUnknown,
}

/// Bands as a state machine.
#[derive(Debug)]
pub struct Bands {
    base: Scene,
    pub(super) settings: BandsSettings,
    grid: MapSettings,
    pub(super) unknowns: Vec<(Unknown, Spread)>,
    /// Items: the scene, the scenarios of the method, the samples (rows of A); where the importance needs rows, rows of B, then for
    /// each unknown rows of A with the unknown of B.
    pub(super) queue: Queue,
    pub(super) fits: Fits,
    scenes_per_job: usize,
}

/// Items before the samples: the scene and the scenarios.
pub(super) const FIRST_SAMPLE: usize = 1 + METHOD_SCALES.len();

impl Bands {
    /// Bands of a scene.
    ///
    /// # Errors
    /// One line with the number that is out of its range.
    pub fn new(scene: &Scene, settings: BandsSettings) -> Result<Self, BandsError> {
        let (least, most) = SAMPLES;
        let range = |field: &str, value: usize, allowed: String| BandsError::OutOfRange {
            field: field.to_owned(),
            value: value.to_string(),
            allowed,
        };
        if !(least..=most).contains(&settings.samples) {
            let allowed = format!("{least} to {most}");
            return Err(range("samples", settings.samples, allowed));
        }
        let rows = settings.importance_rows;
        if rows != 0 && !(MIN_ROWS..=settings.samples).contains(&rows) {
            let allowed = format!("0, {MIN_ROWS} to {} (samples)", settings.samples);
            return Err(range("importance_rows", rows, allowed));
        }
        let nodes = if scene.is_layered() { 33 } else { 65 };
        let default = MapSettings { nodes_per_side: nodes, ..MapSettings::default() };
        let grid = settings.grid.unwrap_or(default);
        grid.check().map_err(BandsError::Grid)?;
        scene.validate().map_err(|error| BandsError::Scene(error.to_string()))?;
        let base = base_scene(scene);
        let mut unknowns = Vec::new();
        for unknown in Unknown::ALL {
            let Some(mut spread) = unknown.spread(&base) else { continue };
            match settings.unknowns.get(&unknown) {
                Some(None) => continue,
                Some(Some(distribution)) => spread.distribution = *distribution,
                None => {}
            }
            check_distribution(unknown, spread.distribution)?;
            unknowns.push((unknown, spread));
        }
        if unknowns.is_empty() {
            return Err(BandsError::NoUnknown);
        }
        let queue = Queue::new((0..FIRST_SAMPLE + settings.samples).collect());
        let fits = Fits::default();
        Ok(Self { base, settings, grid, unknowns, queue, fits, scenes_per_job: 8 })
    }

    /// The samples of a scene alone, without the scene itself, the scenarios and the importance, each a job of its own: few samples
    /// are spread over all workers, and end soon after a cancellation.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn samples_only(scene: &Scene, settings: BandsSettings) -> Result<Self, BandsError> {
        let mut bands = Self::new(scene, BandsSettings { importance_rows: 0, ..settings })?;
        let end = FIRST_SAMPLE + bands.settings.samples;
        bands.queue = Queue::new((FIRST_SAMPLE..end).collect());
        bands.scenes_per_job = 1;
        Ok(bands)
    }

    /// The unknowns with their distributions.
    #[must_use]
    pub fn unknowns(&self) -> &[(Unknown, Spread)] {
        &self.unknowns
    }

    /// The choices.
    #[must_use]
    pub fn settings(&self) -> &BandsSettings {
        &self.settings
    }

    /// Grid and tolerance of the samples.
    #[must_use]
    pub fn grid(&self) -> MapSettings {
        self.grid
    }

    /// The scene of an item.
    fn scene(&self, item: usize) -> Result<Scene, String> {
        let mut scene = self.base.clone();
        let count = self.unknowns.len();
        let mut set = |probability: &dyn Fn(usize) -> f64| {
            for (k, (unknown, spread)) in self.unknowns.iter().enumerate() {
                let value = quantile(spread.distribution, probability(k));
                unknown.apply(&mut scene, &self.base, value);
            }
        };
        let point = |row: usize, dimension: usize| unit_sample(row, dimension, self.settings.seed);
        let (samples, rows) = (self.settings.samples, self.settings.importance_rows);
        match item {
            0 => {}
            item if item < FIRST_SAMPLE => {
                set(&|_| 0.5);
                let factor = METHOD_SCALES[item - 1];
                for layer in &mut scene.layers {
                    let scale = layer.curve.stress_scale * factor;
                    layer.curve.stress_scale = scale.clamp(SCALES.0, SCALES.1);
                }
            }
            item if item < FIRST_SAMPLE + samples => set(&|k| point(item - FIRST_SAMPLE, k)),
            item => {
                let item = item - FIRST_SAMPLE - samples;
                let (block, row) = (item / rows, item % rows);
                // Block 0 is B, block k + 1 is A with the unknown k of B.
                let of_b = |k: usize| block == 0 || block == k + 1;
                set(&|k| point(row, if of_b(k) { count + k } else { k }));
            }
        }
        scene.patient = None;
        scene.lower_tension();
        self.grid.apply(&mut scene);
        scene.validate().map_err(|error| error.to_string())?;
        Ok(scene)
    }

    /// The scene of a sampled patient.
    pub(super) fn patient(&self, sample: usize) -> Result<Scene, String> {
        self.scene(FIRST_SAMPLE + sample)
    }

    fn samples(&self) -> impl Iterator<Item = &Case> {
        let cases = &self.queue.cases()[FIRST_SAMPLE..FIRST_SAMPLE + self.settings.samples];
        cases.iter().flatten()
    }

    /// Value of a quantity in a converged item.
    pub(super) fn value(&self, quantity: Quantity, item: usize) -> Option<f64> {
        self.queue.case(item).filter(|case| case.is_converged())?.values.get(quantity)
    }

    /// Value of a quantity in each sample.
    pub(super) fn sample_values(&self, quantity: Quantity) -> impl Iterator<Item = Option<f64>> {
        let samples = FIRST_SAMPLE..FIRST_SAMPLE + self.settings.samples;
        samples.map(move |item| self.value(quantity, item))
    }

    /// Percentiles, scenarios and importance of every quantity that applies, from the samples solved so far.
    #[must_use]
    pub fn bands(&self) -> Vec<Band> {
        let band = |quantity: Quantity| {
            let cases = self.samples().filter(|case| case.is_converged());
            let values = cases.filter_map(|case| case.values.get(quantity)).collect();
            let [p10, p50, p90] = percentile::band(values)?;
            let scenario = |k: usize| Scenario {
                stress_factor: METHOD_SCALES[k],
                value: self.value(quantity, k + 1),
            };
            let importance = self.importance(quantity).into_iter().zip(&self.unknowns);
            Some(Band {
                quantity,
                label: quantity.label(),
                unit: quantity.unit(),
                scene: self.value(quantity, 0),
                p10,
                p50,
                p90,
                text: text(quantity, p10, p50, p90),
                scenarios: (0..METHOD_SCALES.len()).map(scenario).collect(),
                importance: importance
                    .filter_map(|(index, (unknown, _))| Some((*unknown, index?)))
                    .collect(),
                importance_error: self.importance_error(quantity),
            })
        };
        Quantity::ALL.into_iter().filter_map(band).collect()
    }

    fn profiles(&self) -> Vec<&Profile> {
        let converged = self.samples().filter(|case| case.is_converged());
        converged.filter_map(|case| case.profile.as_ref()).collect()
    }

    /// The band of the skin's section at equal distances from the pocket's axis, as drawn. Empty before a sample is solved.
    #[must_use]
    pub fn section(&self) -> Vec<SectionBand> {
        section_band(&self.profiles())
    }

    /// The band of the skin's section: percentiles of distance and height at equal material radii, over the samples that
    /// have converged. Empty before a sample is solved.
    #[must_use]
    pub fn profile(&self) -> Vec<ProfileBand> {
        let converged = self.profiles();
        let radius = converged.iter().map(|profile| profile.radius_mm).fold(0.0, f64::max);
        let at = |point: usize| {
            let s_mm = radius * point as f64 / (PROFILE_POINTS - 1) as f64;
            let points: Vec<[f64; 2]> = converged
                .iter()
                .filter_map(|profile| {
                    // Beyond the edge of a sheet the tissue is at rest.
                    let rest = || Some([s_mm, *profile.z_mm.last()?]);
                    profile.at(s_mm).or_else(rest)
                })
                .collect();
            let of = |k: usize| percentile::band(points.iter().map(|point| point[k]).collect());
            Some(ProfileBand { s_mm, r_mm: of(0)?, z_mm: of(1)? })
        };
        (0..PROFILE_POINTS).filter_map(at).collect()
    }

    /// Number of samples of each state, without those of no sample.
    #[must_use]
    pub fn counts(&self) -> BTreeMap<&'static str, usize> {
        let all = &self.queue.cases()[FIRST_SAMPLE..FIRST_SAMPLE + self.settings.samples];
        let mut counts = BTreeMap::new();
        for case in all {
            *counts.entry(PointStatus::of(case.as_ref()).word()).or_insert(0) += 1;
        }
        counts
    }

    /// Number of solved scenes that change the bands apart from their importance.
    #[must_use]
    pub fn solved(&self) -> usize {
        self.queue.cases()[..FIRST_SAMPLE + self.settings.samples].iter().flatten().count()
    }

    /// The whole report, for a file.
    #[must_use]
    pub fn report(&self) -> BandsReport {
        let warnings = same_words::counted(self.samples().flat_map(|case| &case.warnings));
        let (done, all) = self.queue.progress();
        let unknown = |(unknown, spread): &(Unknown, Spread)| UnknownReport {
            name: *unknown,
            quantity: spread.quantity,
            acts_as: spread.unit,
            distribution: spread.distribution,
        };
        BandsReport {
            schema: BANDS_SCHEMA,
            notes: NOTES,
            samples: self.settings.samples,
            seed: self.settings.seed,
            importance_rows: self.settings.importance_rows,
            grid: self.grid,
            scene: self.base.clone(),
            unknowns: self.unknowns.iter().map(unknown).collect(),
            counts: self.counts(),
            remarks: self.remarks(),
            scenes_solved: done,
            scenes_planned: all,
            bands: self.bands(),
            profile: self.profile(),
            warnings,
        }
    }
}

impl Queued for Bands {
    const HAS_PROFILE: bool = true;

    fn queue(&self) -> &Queue {
        &self.queue
    }

    fn scenes_per_job(&self) -> usize {
        self.scenes_per_job
    }

    fn queue_mut(&mut self) -> &mut Queue {
        &mut self.queue
    }

    fn scene_of(&self, item: usize) -> Result<Scene, String> {
        self.scene(item)
    }

    fn is_concluded(&self) -> bool {
        self.settings.importance_rows == 0 || self.fits.is_complete()
    }

    fn conclude(&mut self) {
        self.fit();
    }
}

/// Checks the numbers of a distribution: the middle or the bounds are possible values of the unknown.
fn check_distribution(unknown: Unknown, distribution: Distribution) -> Result<(), BandsError> {
    const MOST_SD: f64 = 1e6;
    let (low, high) = unknown.allowed();
    let is_in = |value: f64| (low..=high).contains(&value);
    let (is_valid, allowed) = match distribution {
        Distribution::LogNormal { median, gsd } => (
            is_in(median) && median > 0.0 && (1.0..=100.0).contains(&gsd),
            format!("log_normal with a median above 0 of {low} to {high} and a gsd of 1 to 100"),
        ),
        Distribution::Normal { mean, sd } => (
            is_in(mean) && (0.0..=MOST_SD).contains(&sd),
            format!("normal with a mean of {low} to {high} and an sd of 0 or more"),
        ),
        Distribution::Uniform { least, most } => (
            is_in(least) && is_in(most) && least <= most,
            format!("uniform with {low} ≤ least ≤ most ≤ {high}"),
        ),
    };
    if is_valid {
        return Ok(());
    }
    Err(BandsError::OutOfRange {
        field: format!("unknowns.{}", unknown.name()),
        value: serde_json::to_string(&distribution).unwrap_or_default(),
        allowed,
    })
}

/// "22 mmHg, 14–33": median and 10th to 90th percentile, with two digits of the width of the band.
fn text(quantity: Quantity, p10: f64, p50: f64, p90: f64) -> String {
    let (factor, unit) = quantity.display();
    let values = [p50, p10, p90].map(|value| value * factor);
    let width = (values[2] - values[1]).abs();
    let digits =
        if width > 0.0 { (1.0 - width.log10().floor()).clamp(0.0, 4.0) as usize } else { 0 };
    let [median, low, high] = values.map(|value| format!("{value:.digits$}"));
    // A minus after the dash of a range would not be read.
    let dash = if high.starts_with('-') { " to " } else { "–" };
    format!("{median} {unit}, {low}{dash}{high}")
}

//! Random patients under round implants: solved once each, without comparisons.
//!
//! Distributions: spread between people as in `clinical::spread`; base radius 45–75 mm and volume 120–600 ml with
//! projection/base radius 0.4–1; pinch 10–50 mm; pocket 10 ± 2.5 mm beyond the implant. With chests: those of `chest`; with terrain: 150–500 ml and
//! the bodies of `terrain`. With tension: skin under a natural tension of 20 N/m within a factor of 2.2, an assumption, up to twice as
//! great along any direction as across it.

use super::{
    Case, Ending, Endings, Population, check_layered, chest, nodes, random, scenes::uniform, solve,
    terrain,
};
use fastrand::Rng;
use implant_preview_core::clinical::Size;
use implant_preview_core::curve::{CurveSpec, Fat};
use implant_preview_core::scene::{Field, Fill, Plane, Posture, Scene, SkinState};
use implant_preview_core::solve::{Method, Options, Solver, Verdict};
use implant_preview_core::study::{normal_quantile, percentiles};
use serde::Serialize;

/// New fold below the old one \[mm\].
const FOLD_MM: (f64, f64) = (0.0, 20.0);
/// Greatest void of a pocket that holds fluid \[ml\].
const VOID_ML: (f64, f64) = (0.0, 30.0);
/// Thickness of the muscle's belly \[mm\].
const MUSCLE_MM: (f64, f64) = (6.0, 12.0);
/// Logarithm of the scale of the muscle's stress \[-\]: 3 to 30 kPa.
const MUSCLE_LOG_SCALE: (f64, f64) = (-0.510_8, 1.791_8);
/// Base radius \[mm\].
const BASE_RADIUS_MM: (f64, f64) = (45.0, 75.0);
/// Volume of the implant \[ml\].
const VOLUME_ML: (f64, f64) = (120.0, 600.0);
/// Projection relative to the base radius \[-\].
const PROJECTION: (f64, f64) = (0.4, 1.0);
/// Pinch \[mm\]; half of it is the cover.
const PINCH_MM: (f64, f64) = (10.0, 50.0);
/// Pocket beyond the implant: mean and standard deviation \[mm\].
const MARGIN_MM: (f64, f64) = (10.0, 2.5);
/// Thickness of the skin: mean and standard deviation \[mm\].
const SKIN_MM: (f64, f64) = (1.55, 0.25);
/// Strain scale of the skin: median, geometric standard deviation \[-\].
const STRAIN_SCALE: (f64, f64) = (0.65, 1.9);
/// Bounds of the strain scale \[-\].
const STRAIN_SCALES: (f64, f64) = (0.15, 3.0);
/// Stress scale of the skin, factor of the cover: median, geometric standard deviation \[-\].
const FACTOR: (f64, f64) = (1.0, 1.3);
/// Stress scale of the fat: median, geometric standard deviation \[-\].
const FAT_SCALE: (f64, f64) = (1.0, 1.6);
/// Initial modulus of an exponential fat: median \[kPa\], geometric standard deviation \[-\].
const MODULUS_KPA: (f64, f64) = (4.0, 1.8);

/// Natural tension of the skin: median \[N/m\], geometric standard deviation.
const TENSION: (f64, f64) = (20.0, 2.2);
/// Anisotropy of the natural tension \[-\], and its direction \[°\].
const ANISOTROPY: (f64, f64) = (1.0, 2.0);
const DIRECTION_DEG: (f64, f64) = (-90.0, 90.0);

/// What all scenes of a run share.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Clinical {
    /// Poisson ratio of the fat \[-\].
    pub fat_poisson_ratio: f64,
    /// Rate of an exponential in place of the curve `fat` \[-\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fat_rate: Option<f64>,
    /// Has every patient a curved chest, half of them another implant or a mound?
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub has_chest: bool,
    /// Has every patient the wall and the mound of a body, half of them an anatomical implant?
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub has_terrain: bool,
    /// Has the skin of every patient a natural tension?
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub has_tension: bool,
    /// Has that skin grown by any part of its stretch?
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub has_growth: bool,
    /// Has every implant one of the fills, or is rigid?
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub has_fill: bool,
    /// Is every pocket above, partly or wholly below a muscle of any thickness and stiffness?
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub has_plane: bool,
    /// Has every pocket a new fold of its own?
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub has_fold: bool,
    /// Does half of the pockets hold a limited void?
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub has_void: bool,
    /// Is every patient lying, standing, or without weight?
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub has_posture: bool,
    /// Nodes per side.
    pub nodes_per_side: usize,
    /// Is every converged case solved again to [`FINE_TOLERANCE`], to measure its error?
    pub measures_errors: bool,
}

/// Patients on a flat wall, at 65 nodes per side.
impl Default for Clinical {
    fn default() -> Self {
        Self {
            fat_poisson_ratio: 0.49,
            fat_rate: None,
            has_chest: false,
            has_terrain: false,
            has_tension: false,
            has_growth: false,
            has_fill: false,
            has_plane: false,
            has_fold: false,
            has_void: false,
            has_posture: false,
            nodes_per_side: 65,
            measures_errors: false,
        }
    }
}

/// Tolerance of the solution that errors are measured against \[base radius\].
pub const FINE_TOLERANCE: f64 = 1e-5;

fn normal(rng: &mut Rng, (mean, deviation): (f64, f64)) -> f64 {
    mean + deviation * normal_quantile(rng.f64().clamp(1e-9, 1.0 - 1e-9))
}

fn log_normal(rng: &mut Rng, (median, factor): (f64, f64)) -> f64 {
    median * factor.powf(normal(rng, (0.0, 1.0)))
}

impl Clinical {
    /// Patients with all that a person and an operation may have at once, over the walls and the thickness of bodies.
    #[must_use]
    pub fn with_everything() -> Self {
        Self {
            has_terrain: true,
            has_tension: true,
            has_growth: true,
            has_fill: true,
            has_plane: true,
            has_fold: true,
            has_void: true,
            has_posture: true,
            ..Self::default()
        }
    }

    /// The random scene of a case, of tolerance 1e-3.
    #[must_use]
    pub fn scene(self, seed: u64, case: u64) -> Scene {
        let rng = &mut random(seed, case);
        let mut scene = Scene { chest: None, patient: None, ..Scene::opening() };
        scene.implant.fill = None;
        let volumes = if self.has_terrain { terrain::VOLUME_ML } else { VOLUME_ML };
        let (radius, projection) = loop {
            let radius = uniform(rng, BASE_RADIUS_MM);
            let volume = uniform(rng, volumes);
            let Ok(size) = Size::of_width_and_volume(2.0 * radius, volume) else { continue };
            let projection = size.projection_mm();
            if (PROJECTION.0..=PROJECTION.1).contains(&(projection / radius)) {
                break (radius, projection);
            }
        };
        scene.implant.base_radius_mm = radius;
        scene.implant.projection_mm = projection;
        let cover = 0.5 * uniform(rng, PINCH_MM) * log_normal(rng, FACTOR);
        let skin = normal(rng, SKIN_MM).max(0.5);
        scene.layers[0].thickness_mm = skin;
        scene.layers[0].curve.strain_scale =
            log_normal(rng, STRAIN_SCALE).clamp(STRAIN_SCALES.0, STRAIN_SCALES.1);
        scene.layers[0].curve.stress_scale = log_normal(rng, FACTOR);
        let fat = &mut scene.layers[1];
        let (least, most) = Field::Thickness.limits;
        fat.thickness_mm = (cover - skin).clamp(least, most);
        fat.poisson_ratio = self.fat_poisson_ratio;
        match self.fat_rate {
            None => {
                fat.curve.spec = CurveSpec::Fat { variant: Fat::Mid };
                fat.curve.stress_scale = log_normal(rng, FAT_SCALE);
            }
            Some(rate) => {
                let scale_kpa = log_normal(rng, MODULUS_KPA) / rate;
                fat.curve.spec = CurveSpec::Exponential { scale_kpa, rate };
            }
        }
        scene.set_pocket_radius(radius + normal(rng, MARGIN_MM).max(0.0));
        scene.solver.nodes_per_side = self.nodes_per_side;
        scene.solver.tolerance = 1e-3;
        if self.has_fold {
            scene.body.pocket_lowered_mm = uniform(rng, FOLD_MM);
        }
        if self.has_plane {
            let plane = rng.usize(0..=Plane::ALL.len());
            scene.set_plane(Plane::ALL.get(plane).copied());
            if let (Some(muscle), true) = (scene.layers.last_mut(), scene.body.plane.is_some()) {
                muscle.thickness_mm = uniform(rng, MUSCLE_MM);
                muscle.curve.stress_scale = uniform(rng, MUSCLE_LOG_SCALE).exp();
            }
        }
        if self.has_chest {
            chest::patient(rng, &mut scene);
            chest::fullness(rng, &mut scene);
        }
        if self.has_terrain {
            terrain::patient(rng, &mut scene);
        }
        if self.has_tension {
            tension(rng, &mut scene);
        }
        if self.has_growth {
            scene.body.skin_state.grown = uniform(rng, Field::Grown.limits);
        }
        if self.has_fill {
            let fill = rng.usize(0..=Fill::NAMED.len());
            scene.implant.fill = Fill::NAMED.get(fill).map(|(_, fill)| *fill);
        }
        if self.has_void {
            scene.body.pocket_void_ml = rng.bool().then(|| uniform(rng, VOID_ML));
        }
        if self.has_posture {
            scene.body.posture = Posture::ALL[rng.usize(..Posture::ALL.len())];
        }
        scene
    }

    /// Solves the scene of a case and checks its invariants.
    #[must_use]
    pub fn run(self, seed: u64, case: u64, clock: super::Clock) -> ClinicalCase {
        let scene = self.scene(seed, case);
        let start = clock.map(|clock| clock());
        let solver = solve(&scene, Options::default());
        let time_ms = clock.zip(start).map(|(clock, start)| clock() - start);
        let mut outcome =
            Case { case, time_ms, population: Population::Realistic, ..Case::of(scene) };
        let Some(solver) = solver else {
            return ClinicalCase { case: outcome, attempts: 0, by_newton: false, error: None };
        };
        let checked = check_layered::check(&solver);
        outcome.findings = checked.findings;
        outcome.least_volume_ratio = checked.least_volume_ratio;
        outcome.inverted_corners = checked.inverted_corners;
        outcome.end(&solver, false);
        let by_newton = solver.report().method == Method::Newton;
        let is_measured = self.measures_errors && outcome.ending == Ending::Converged;
        let error = is_measured.then(|| error(&outcome.scene, &solver)).flatten();
        ClinicalCase { case: outcome, attempts: solver.attempts(), by_newton, error }
    }
}

/// Gives the skin a tension that it bears.
fn tension(rng: &mut Rng, scene: &mut Scene) {
    let (least, most) = Field::NaturalTension.limits;
    loop {
        scene.body.skin_state = SkinState {
            natural_tension_n_per_m: log_normal(rng, TENSION).clamp(least, most),
            anisotropy: uniform(rng, ANISOTROPY),
            direction_deg: uniform(rng, DIRECTION_DEG),
            ..SkinState::default()
        };
        if scene.validate().is_ok() {
            return;
        }
    }
}

/// Greatest distance of a node from the solution of a smaller tolerance on the same grid \[base radius\]; `None` if that solve
/// does not converge.
fn error(scene: &Scene, solver: &Solver) -> Option<f64> {
    let mut fine = scene.clone();
    fine.solver.tolerance = FINE_TOLERANCE;
    let fine = solve(&fine, Options::default()).filter(|s| s.verdict() == Verdict::Converged)?;
    let distances = nodes(solver).into_iter().zip(nodes(&fine)).map(|(a, b)| a.distance(b));
    Some(distances.fold(0.0, f64::max) / scene.implant.base_radius_mm)
}

/// A case of a clinical run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClinicalCase {
    /// The case.
    #[serde(flatten)]
    pub case: Case,
    /// Attempts of the solver; 0 of a rejected scene.
    pub attempts: u32,
    /// Did Newton's method end the solve?
    pub by_newton: bool,
    /// Greatest position error \[base radius\], if measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<f64>,
}

/// The summary of a clinical run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ClinicalSummary {
    /// The seed.
    pub seed: u64,
    /// What all scenes share.
    #[serde(flatten)]
    pub clinical: Clinical,
    /// Numbers of cases by outcome.
    #[serde(flatten)]
    pub endings: Endings,
    /// Cases that converged in the first attempt.
    pub first_attempt: u64,
    /// Cases that converged by multigrid.
    pub by_multigrid: u64,
    /// Work \[force evaluations of the finest grid\]: median, 95th percentile, greatest.
    pub work_units: [f64; 3],
    /// Time of a solve \[ms\]: median, 95th percentile, greatest; `None` without a clock.
    pub time_ms: Option<[f64; 3]>,
    /// Measured position error \[base radius\]: median, 95th percentile, greatest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<[f64; 3]>,
    /// Measured error relative to its estimate \[-\]: median, 95th percentile, greatest.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_per_estimate: Option<[f64; 3]>,
    /// Cases whose measured error is above the tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub above_tolerance: Option<u64>,
    /// Cases that did not converge or failed a check, and the case of most work.
    pub worst: Vec<ClinicalCase>,
}

/// Median, 95th percentile and greatest number.
fn spread(numbers: Vec<f64>) -> Option<[f64; 3]> {
    percentiles(numbers, [0.5, 0.95, 1.0])
}

impl ClinicalSummary {
    /// Summarises cases in their order.
    #[must_use]
    pub fn new(seed: u64, clinical: Clinical, cases: &[ClinicalCase]) -> Self {
        let mut endings = Endings::default();
        cases.iter().for_each(|case| endings.add(&case.case));
        let is_converged = |c: &&ClinicalCase| c.case.ending == Ending::Converged;
        let converged = || cases.iter().filter(is_converged);
        let errors = || cases.iter().filter_map(|c| Some((c, c.error?)));
        let is_above = |(c, error): &(&ClinicalCase, f64)| *error > c.case.scene.solver.tolerance;
        let per_estimate =
            |(c, error): (&ClinicalCase, f64)| Some(error / c.case.estimated_position_error?);
        let costliest = cases.iter().max_by(|a, b| a.case.work_units.total_cmp(&b.case.work_units));
        Self {
            seed,
            clinical,
            endings,
            first_attempt: converged().filter(|c| c.attempts == 1).count() as u64,
            by_multigrid: converged().filter(|c| !c.by_newton).count() as u64,
            work_units: spread(cases.iter().map(|c| c.case.work_units).collect())
                .unwrap_or_default(),
            time_ms: spread(cases.iter().filter_map(|c| c.case.time_ms).collect()),
            error: spread(errors().map(|(_, error)| error).collect()),
            error_per_estimate: spread(errors().filter_map(per_estimate).collect()),
            above_tolerance: clinical
                .measures_errors
                .then(|| errors().filter(is_above).count() as u64),
            worst: cases.iter().filter(|c| !is_converged(c)).chain(costliest).cloned().collect(),
        }
    }

    /// Did every case converge?
    #[must_use]
    pub fn all_converged(&self) -> bool {
        self.endings.converged == self.endings.cases
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_is_valid_and_within_the_distributions() {
        for (fat_rate, has_chest) in [(None, false), (Some(10.0), false), (None, true)] {
            let clinical = Clinical { fat_rate, has_chest, ..Clinical::default() };
            let flat = Clinical { has_chest: false, ..clinical };
            let mut counts = [0; 4];
            for case in 0..500 {
                let scene = clinical.scene(7, case);
                assert_eq!(scene.validate(), Ok(()), "{}", scene.to_json());
                let slope = scene.implant.projection_mm / scene.implant.base_radius_mm;
                assert!((PROJECTION.0..=PROJECTION.1).contains(&slope));
                assert!(scene.is_layered() && scene.chest.is_some() == has_chest);
                counts[0] += usize::from(!scene.implant.is_round());
                counts[1] += usize::from(scene.implant.center_mm.iter().any(|at| at.abs() > 0.0));
                counts[2] += usize::from(scene.thickness_field.is_some());
                let (mut without, flat) = (scene, flat.scene(7, case));
                (without.chest, without.thickness_field) = (None, None);
                (without.implant.center_mm, without.implant.base_height_mm) = ([0.0; 2], None);
                counts[3] += usize::from(without.implant.fullness.is_some());
                (without.implant.apex_shift_mm, without.implant.fullness) = (0.0, None);
                without.set_pocket_radius(flat.pocket_radius_mm);
                assert_eq!(without, flat);
            }
            // A third, a third, half and half of 500.
            let wanted = if has_chest { [167, 167, 250, 250] } else { [0; 4] };
            assert!(
                counts.iter().zip(wanted).all(|(a, b): (&usize, _)| a.abs_diff(b) < 40),
                "{counts:?}"
            );
        }
    }

    #[test]
    fn a_tension_is_all_that_differs() {
        let given = Clinical { has_chest: true, ..Clinical::default() };
        let tense = Clinical { has_tension: true, ..given };
        let mut tensions = Vec::new();
        for case in 0..200 {
            let (scene, mut tense) = (given.scene(7, case), tense.scene(7, case));
            assert_eq!(tense.validate(), Ok(()), "{}", tense.to_json());
            let state = std::mem::take(&mut tense.body.skin_state);
            assert_eq!(tense, scene);
            tensions.push(state.natural_tension_n_per_m);
        }
        let [least, median, most] = percentiles(tensions, [0.16, 0.5, 0.84]).unwrap();
        assert!((16.0..23.0).contains(&median), "{median}");
        assert!((1.8..2.6).contains(&(most / median)) && (1.8..2.6).contains(&(median / least)));
    }

    /// All that a person and an operation may have at once.
    #[test]
    fn a_scene_with_everything_is_valid() {
        let terrain = Clinical::with_everything();
        for all in [terrain, Clinical { has_terrain: false, has_chest: true, ..terrain }] {
            let scenes: Vec<Scene> = (0..100).map(|case| all.scene(7, case)).collect();
            for scene in &scenes {
                assert_eq!(scene.validate(), Ok(()), "{}", scene.to_json());
                assert!(scene.body.pocket_lowered_mm > 0.0);
            }
            let with = |has: fn(&Scene) -> bool| scenes.iter().filter(|scene| has(scene)).count();
            assert!((35..=65).contains(&with(|scene| scene.body.pocket_void_ml.is_some())));
            assert!((50..=83).contains(&with(|scene| scene.body.posture != Posture::None)));
        }
    }

    #[test]
    fn a_body_has_a_wall_with_bumps_and_a_mound() {
        let clinical = Clinical { has_terrain: true, nodes_per_side: 33, ..Clinical::default() };
        let scenes: Vec<Scene> = (0..60).map(|case| clinical.scene(7, case)).collect();
        assert!(scenes.iter().all(|scene| scene.validate().is_ok()));
        assert!(scenes.iter().all(|scene| scene.chest_grid.is_some()));
        let anatomical = scenes.iter().filter(|scene| !scene.implant.is_round()).count();
        assert!((20..=40).contains(&anatomical), "{anatomical}");
        let thickest = |scene: &Scene| {
            let field = scene.thickness_field.as_ref().unwrap();
            field.factors.iter().copied().fold(0.0, f64::max) * scene.layers[1].thickness_mm
        };
        assert!(scenes.iter().any(|scene| thickest(scene) > 60.0));
    }
}

//! Scenes in, cases out: the unit of work of all studies.

use super::Values;
use super::runner::twice;
use crate::measure::{Outcome, PROFILE_POINTS, Selection, Status, skin_surface};
use crate::scene::{CheckedScene, Scene};
use crate::simulate::{Simulation, Simulator};
use crate::solve::{Options, Solution};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Scenes that one solver computes one after the other. Scenes with equal layers share tables, scenes of one grid share
/// the grids.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Job {
    /// The scenes.
    pub scenes: Vec<Scene>,
    /// Do the cases contain the profile of the skin?
    #[serde(default)]
    pub profile: bool,
    /// Are the scenes solved as a plan is, with Newton's method for layered tissue that multigrid does not solve?
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub full: bool,
}

/// What a study keeps of a solved scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// How the solve ended; `None` for a scene out of its limits.
    pub status: Option<Status>,
    /// The quantities of the result; none without a shape.
    pub values: Values,
    /// Greatest pressure over the middle of the implant and around it \[kPa\]: [`Outcome::pressure_peaks_kpa`].
    #[serde(default)]
    pub pressure_peaks_kpa: [f64; 2],
    /// Section of the skin's outer surface, if the job contains the request and the scene has a shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub profile: Option<Profile>,
    /// The error of a scene out of its limits, in one line.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
    /// Work \[evaluations of all nodal forces on the finest grid\].
    pub evaluations: f64,
    /// Warnings of the result, without those on the patient's measurements.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
}

/// Section of the skin's outer surface along +x from the pocket's centre: 41 points at equal steps of the material radius.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Profile {
    /// Material radius of the last point \[mm\]: the radius of the simulated tissue.
    pub radius_mm: f64,
    /// Distances from the pocket's axis \[mm\], shape (41, ).
    pub r_mm: Vec<f64>,
    /// Heights above the wall \[mm\], shape (41, ).
    pub z_mm: Vec<f64>,
}

impl Scene {
    /// The scene without what its case does not depend on and takes much room in a job: its place on a body and the plan of the other side.
    pub(super) fn for_job(self) -> Self {
        Self { placement: None, other_side: None, ..self }
    }
}

impl Case {
    /// The case of a scene out of its limits.
    #[must_use]
    pub fn invalid(error: impl ToString) -> Self {
        Self { error: Some(error.to_string()), ..Self::default() }
    }

    /// The case of a result, without a profile.
    #[must_use]
    pub fn of(outcome: &Outcome, scene: &Scene) -> Self {
        let on_patient = scene.patient_warnings();
        let warnings = outcome.warnings.iter().filter(|warning| !on_patient.contains(warning));
        let has_shape = outcome.strain.is_some();
        Self {
            status: Some(outcome.status),
            values: if has_shape { Values::new(outcome) } else { Values::default() },
            pressure_peaks_kpa: outcome.pressure_peaks_kpa,
            profile: None,
            error: None,
            evaluations: outcome.solver.work_units,
            warnings: warnings.cloned().collect(),
        }
    }

    /// Did the solve converge?
    #[must_use]
    pub fn is_converged(&self) -> bool {
        self.status == Some(Status::Converged)
    }
}

impl Profile {
    /// Material radius of a point \[mm\].
    #[must_use]
    pub fn material_radius_mm(&self, point: usize) -> f64 {
        self.radius_mm * point as f64 / (PROFILE_POINTS - 1) as f64
    }

    /// Distance from the pocket's axis and height \[mm\] at a material radius within the profile, between two points on a
    /// line; `None` beyond the profile.
    #[must_use]
    pub fn at(&self, material_radius_mm: f64) -> Option<[f64; 2]> {
        let position = material_radius_mm / self.radius_mm * (PROFILE_POINTS - 1) as f64;
        if !(0.0..=(PROFILE_POINTS - 1) as f64 + 1e-9).contains(&position) {
            return None;
        }
        let low = (position as usize).min(PROFILE_POINTS - 2);
        let part = position - low as f64;
        let between =
            |values: &[f64]| Some(values.get(low)? * (1.0 - part) + values.get(low + 1)? * part);
        Some([between(&self.r_mm)?, between(&self.z_mm)?])
    }
}

/// Greatest number of cells that Newton's method computes in a study: those of 17 nodes per side. A study of hundreds of scenes
/// has no seconds for one of them: on finer grids, unless a job is [full](Job::full), layered tissue that multigrid does not solve has the status `not_converged`
/// or `unstable`.
const MAX_NEWTON_CELLS: usize = 1000;

/// Solves the scenes of a job one after the other; a scene out of its limits gives a case with an error.
///
/// A case depends on its scene alone, not on the scenes before it.
#[must_use]
pub fn evaluate(job: &Job) -> Vec<Case> {
    Evaluator::default().evaluate(job)
}

/// Solves job after job with the tables and grids that they share.
#[derive(Default)]
pub struct Evaluator {
    simulator: Simulator,
    scene: Option<CheckedScene>,
}

impl Evaluator {
    /// Ends the solve that runs, and all further ones, once the flag is true.
    pub fn stop_at(&mut self, flag: &Arc<AtomicBool>) {
        self.simulator.stop = Some(Arc::clone(flag));
    }

    /// As [`evaluate`].
    #[must_use]
    pub fn evaluate(&mut self, job: &Job) -> Vec<Case> {
        job.scenes.iter().map(|scene| self.case(scene, job)).collect()
    }

    /// As [`evaluate`]; a scene that panics is solved once more from scratch. After a second panic its case is an error in one line.
    #[must_use]
    pub fn evaluate_guarded(&mut self, job: &Job) -> Vec<Case> {
        let case = |scene| twice(self, |solver| solver.case(scene, job));
        let invalid = |line| Case::invalid(format!("internal error, twice: {line}"));
        job.scenes.iter().map(case).map(|case| case.unwrap_or_else(invalid)).collect()
    }

    /// Solves one scene by the choices of a job.
    pub fn case(&mut self, scene: &Scene, job: &Job) -> Case {
        match CheckedScene::like(scene.clone(), self.scene.as_ref()) {
            Ok(scene) => {
                let case = self.solve(&scene, job);
                self.scene = Some(scene);
                case
            }
            Err(error) => Case::invalid(error),
        }
    }

    fn solve(&mut self, scene: &CheckedScene, job: &Job) -> Case {
        let options = match job.full {
            true => Options::default(),
            false => Options { max_newton_cells: MAX_NEWTON_CELLS, ..Options::default() },
        };
        let selection = Selection::all().without_profile();
        let Simulation { outcome, solution } = self.simulator.run(scene, options, &selection, None);
        let has_profile = job.profile && outcome.strain.is_some();
        Case {
            profile: has_profile.then(|| profile(&solution)),
            ..Case::of(&outcome, scene.scene())
        }
    }
}

fn profile(solution: &Solution) -> Profile {
    let points = skin_surface(solution);
    Profile {
        radius_mm: points.last().map_or(0.0, |point| point.s_mm),
        r_mm: points.iter().map(|point| point.r_mm).collect(),
        z_mm: points.iter().map(|point| point.z_mm).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::read;
    use crate::simulate;
    use crate::study::Quantity;

    fn scene(is_sheet: bool, projection_mm: f64) -> Scene {
        let mut scene = if is_sheet { Scene::sheet() } else { Scene::default() };
        scene.implant.projection_mm = projection_mm;
        scene.solver.nodes_per_side = 33;
        scene
    }

    /// Sheets and layered tissue, several layers, off-centre domes and an invalid scene in one job.
    fn mixed() -> Job {
        let mut off_centre = scene(false, 40.0);
        off_centre.implant.center_mm = [6.0, 0.0];
        let mut stiff = scene(false, 40.0);
        stiff.layers[1].curve.stress_scale = 2.0;
        let mut thick = scene(false, 40.0);
        thick.layers[1].thickness_mm = 14.0;
        let mut invalid = scene(true, 40.0);
        invalid.implant.base_radius_mm = f64::NAN;
        let scenes = vec![
            scene(false, 55.0),
            scene(false, 35.0),
            invalid,
            off_centre,
            stiff,
            thick,
            scene(true, 55.0),
            scene(true, 30.0),
            scene(false, 35.0),
        ];
        Job { scenes, profile: true, full: false }
    }

    #[test]
    fn a_case_depends_on_its_scene_alone() {
        let job = mixed();
        let together = evaluate(&job);
        assert_eq!(together[1], together[8]);
        for (scene, case) in job.scenes.iter().zip(&together) {
            let alone = evaluate(&Job { scenes: vec![scene.clone()], profile: true, full: false });
            assert_eq!(alone[0], *case);
        }
    }

    #[test]
    fn a_case_contains_the_values_of_the_result() {
        let scene = scene(false, 45.0);
        let outcome = simulate::simulate(&scene).unwrap();
        let case = &evaluate(&Job { scenes: vec![scene], ..Job::default() })[0];
        assert!(case.is_converged() && case.profile.is_none() && case.evaluations > 1.0);
        let of = |quantity| case.values.get(quantity);
        assert_eq!(of(Quantity::ForceN), outcome.contact_force_n);
        assert_eq!(of(Quantity::LeastCoverMm), outcome.cover_mm.map(|cover| cover.least));
        assert_eq!(of(Quantity::SkinAreaGain), outcome.area_ratio.map(|ratio| ratio - 1.0));
        assert_eq!(case.values, Values::new(&outcome));
    }

    #[test]
    fn a_scene_out_of_its_limits_is_one_line() {
        let case = &evaluate(&mixed())[2];
        let error = case.error.as_deref().unwrap();
        assert!(error.starts_with("implant.base_radius_mm is NaN; allowed: "), "{error}");
        assert_eq!((case.status, case.values), (None, Values::default()));
    }

    #[test]
    fn jobs_and_cases_are_equal_after_json() {
        let mut job = mixed();
        job.scenes.remove(2);
        let text = serde_json::to_string(&job).unwrap();
        let read: Job = read::of_any_size(&text, "job").unwrap();
        assert_eq!(read, job);
        let cases = evaluate(&job);
        let text = serde_json::to_string(&cases).unwrap();
        assert_eq!(read::of_any_size::<Vec<Case>>(&text, "cases").unwrap(), cases);
    }

    #[test]
    fn the_profile_is_the_outer_surface_of_the_skin() {
        for is_sheet in [false, true] {
            let scene = scene(is_sheet, 45.0);
            let case =
                &evaluate(&Job { scenes: vec![scene.clone()], profile: true, full: false })[0];
            let profile = case.profile.as_ref().unwrap();
            assert_eq!((profile.r_mm.len(), profile.z_mm.len()), (PROFILE_POINTS, PROFILE_POINTS));
            let radius = if is_sheet { 70.0 } else { 130.0 };
            assert!((profile.radius_mm - radius).abs() < 1e-9);
            let apex = case.values.get(Quantity::SkinProjectionMm).unwrap();
            assert!((profile.z_mm[0] - apex).abs() < 0.02, "{} {apex}", profile.z_mm[0]);
            let [r, z] = profile.at(profile.material_radius_mm(3)).unwrap();
            assert!((r - profile.r_mm[3]).abs() + (z - profile.z_mm[3]).abs() < 1e-9);
            assert!(profile.at(radius).is_some() && profile.at(1.01 * radius).is_none());
        }
    }
}

//! The largest volume that stays usual, over sampled patients: a bisection for each patient.

use super::bands::{Bands, BandsError, BandsSettings};
use super::cache::Key;
use super::first_usual::is_usual;
use super::{Case, Cases, Job, MapSettings, Parameter, Study, with_values};
use crate::scene::Scene;
use std::collections::BTreeMap;

/// Number of sampled patients.
pub const PATIENTS: usize = 32;
/// Step of the volumes \[ml\], and more where this makes more than 64 steps.
pub const USUAL_STEP_ML: f64 = 10.0;
/// Greatest number of steps between the least and the greatest volume.
const MOST_STEPS: f64 = 64.0;

/// The search as a state machine, a [`Study`] whose jobs are one scene each.
#[derive(Debug)]
pub struct UsualRange {
    /// Least and greatest volume \[ml\].
    ends: (f64, f64),
    steps: usize,
    patients: Vec<Patient>,
    /// Patient, step and key of the running jobs.
    running: BTreeMap<usize, (usize, usize, Key)>,
    jobs: usize,
}

/// A sampled patient with the bracket of the search.
#[derive(Debug)]
struct Patient {
    /// Without a value: the sample is out of the limits of a scene, or a job has failed.
    scene: Option<Scene>,
    /// Number of steps that are known to stay usual, from the least volume on.
    usual: usize,
    /// Number of steps from which on no volume stays usual.
    end: usize,
    solved: usize,
    is_running: bool,
}

/// The largest volumes that stay usual for 8 of 10 sampled patients: 10th and 90th percentile.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UsualVolumes {
    /// 10th percentile \[ml\]; `None`: no volume of the search stays usual.
    pub low_ml: Option<f64>,
    /// 90th percentile \[ml\]; `None`: no volume of the search stays usual.
    pub high_ml: Option<f64>,
    /// Is the 90th percentile the greatest volume of the search?
    pub is_open: bool,
}

impl UsualRange {
    /// The search at the base width of a scene between two volumes \[ml\], on a grid of 33 nodes per side. The patients are the
    /// first [`PATIENTS`] samples of the bands of these settings.
    ///
    /// # Errors
    /// One line with the setting that is out of its range.
    pub fn new(
        scene: &Scene,
        settings: &BandsSettings,
        ends: (f64, f64),
    ) -> Result<Self, BandsError> {
        let grid = Some(MapSettings::default());
        let settings =
            BandsSettings { samples: PATIENTS, importance_rows: 0, grid, ..settings.clone() };
        let bands = Bands::new(scene, settings)?;
        let steps = ((ends.1 - ends.0) / USUAL_STEP_ML).round().clamp(1.0, MOST_STEPS) as usize;
        let patient = |sample: usize| Patient {
            scene: bands.patient(sample).ok(),
            usual: 0,
            end: steps + 2,
            solved: 0,
            is_running: false,
        };
        let patients = (0..PATIENTS).map(patient).collect();
        Ok(Self { ends, steps, patients, running: BTreeMap::new(), jobs: 0 })
    }

    /// Volume of a step \[ml\].
    fn volume(&self, step: usize) -> f64 {
        self.ends.0 + (self.ends.1 - self.ends.0) * step as f64 / self.steps as f64
    }

    /// The percentiles over the patients that were solved; `None` before the end, and without such a patient.
    #[must_use]
    pub fn found(&self) -> Option<UsualVolumes> {
        if !self.is_done() {
            return None;
        }
        let known = self.patients.iter().filter(|patient| patient.scene.is_some());
        let mut usual: Vec<usize> = known.map(|patient| patient.usual).collect();
        usual.sort_unstable();
        let last = usual.len().checked_sub(1)?;
        // Volumes are steps: no value lies between two of them.
        let at = |p: f64| usual[(p * last as f64).round() as usize];
        let volume = |usual: usize| usual.checked_sub(1).map(|step| self.volume(step));
        let (low, high) = (at(0.1), at(0.9));
        Some(UsualVolumes {
            low_ml: volume(low),
            high_ml: volume(high),
            is_open: high == self.steps + 1,
        })
    }

    /// The next scene of a patient with its step; drops a patient whose scene is out of its limits.
    fn next_scene(&mut self, patient: usize) -> Option<(usize, Scene)> {
        let Patient { scene, usual, end, is_running, .. } = &self.patients[patient];
        if *is_running || end - usual <= 1 {
            return None;
        }
        let step = (usual + end) / 2 - 1;
        let volume = (Parameter::Volume, self.volume(step));
        let scene = with_values(scene.as_ref()?, &[volume]).ok();
        if scene.is_none() {
            self.patients[patient].scene = None;
        }
        Some((step, scene?))
    }
}

impl Patient {
    /// Halves the bracket.
    fn take(&mut self, step: usize, is_usual: bool) {
        self.solved += 1;
        if is_usual {
            self.usual = step + 1;
        } else {
            self.end = step + 1;
        }
    }

    fn is_done(&self) -> bool {
        self.scene.is_none() || self.end - self.usual <= 1
    }
}

impl Study for UsualRange {
    fn next_job(&mut self, store: &mut Cases) -> Option<(usize, Job)> {
        for patient in 0..self.patients.len() {
            while let Some((step, scene)) = self.next_scene(patient) {
                let key = store.key(&scene);
                if let Some(case) = store.reuse(&key, false) {
                    let is_usual = is_usual(case);
                    self.patients[patient].take(step, is_usual);
                    continue;
                }
                self.patients[patient].is_running = true;
                self.running.insert(self.jobs, (patient, step, key));
                self.jobs += 1;
                return Some((self.jobs - 1, Job { scenes: vec![scene], ..Job::default() }));
            }
        }
        None
    }

    fn receive(&mut self, job: usize, cases: Vec<Case>, store: &mut Cases) {
        let Some((patient, step, key)) = self.running.remove(&job) else { return };
        let patient = &mut self.patients[patient];
        patient.is_running = false;
        match cases.into_iter().next().filter(|case| case.status.is_some()) {
            Some(case) => {
                patient.take(step, is_usual(&case));
                store.insert(key, case);
            }
            None => patient.scene = None,
        }
    }

    fn progress(&self) -> (usize, usize) {
        // The greatest number of halvings of a patient.
        let most = (self.steps + 2).next_power_of_two().ilog2() as usize;
        let done = |patient: &Patient| if patient.is_done() { most } else { patient.solved };
        (self.patients.iter().map(done).sum(), most * self.patients.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{Unknown, evaluate};

    /// The search over the opening plan, with the number of solves.
    fn search(settings: &BandsSettings, store: &mut Cases) -> (UsualRange, usize) {
        let scene = Scene::opening();
        let mut search = UsualRange::new(&scene, settings, (100.0, 600.0)).unwrap();
        let mut solved = 0;
        while let Some((index, job)) = search.next_job(store) {
            assert!(search.found().is_none() && !search.is_done());
            search.receive(index + 1000, Vec::new(), store);
            search.receive(index, evaluate(&job), store);
            solved += 1;
        }
        (search, solved)
    }

    #[test]
    fn a_patient_ends_where_the_next_step_is_no_longer_usual() {
        let mut store = Cases::default();
        // A spread of the skin alone, so that patients differ.
        let others = Unknown::ALL.into_iter().filter(|u| *u != Unknown::SkinStrainScale);
        let unknowns = others.map(|unknown| (unknown, None)).collect();
        let settings = BandsSettings { unknowns, ..BandsSettings::default() };
        let (search, solved) = search(&settings, &mut store);
        assert!(search.is_done() && solved <= 6 * PATIENTS, "{solved} solves");
        let found = search.found().unwrap();
        assert!(found.low_ml < found.high_ml && !found.is_open, "{found:?}");
        for patient in search.patients.iter().step_by(9) {
            let stays_usual = |step: usize| {
                let volume = (Parameter::Volume, search.volume(step));
                let scene = with_values(patient.scene.as_ref().unwrap(), &[volume]).unwrap();
                is_usual(&evaluate(&Job { scenes: vec![scene], ..Job::default() })[0])
            };
            assert!(patient.usual == 0 || stays_usual(patient.usual - 1));
            assert!(patient.usual > search.steps || !stays_usual(patient.usual));
        }
        // An equal search solves nothing.
        let mut again = UsualRange::new(&Scene::opening(), &settings, (100.0, 600.0)).unwrap();
        assert!(again.next_job(&mut store).is_none());
        assert_eq!(again.found(), Some(found));
    }

    #[test]
    fn a_failed_job_drops_its_patient_only() {
        let mut store = Cases::default();
        let settings = BandsSettings::default();
        let mut search = UsualRange::new(&Scene::opening(), &settings, (100.0, 600.0)).unwrap();
        let (first, _) = search.next_job(&mut store).unwrap();
        search.receive(first, Vec::new(), &mut store);
        assert!(search.patients[0].scene.is_none());
        let (_, job) = search.next_job(&mut store).unwrap();
        assert_eq!(job.scenes.len(), 1);
        assert!(search.patients[1].is_running && !search.is_done());
    }
}

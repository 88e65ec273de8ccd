//! The largest volume that stays usual, over sampled patients: a bisection for each patient. Where the stretch is compared with
//! practice, practice's volume is first solved in the tissue of that patient.

use super::bands::{Bands, BandsError, BandsSettings};
use super::first_usual::is_usual;
use super::one_by_one::OneByOne;
use super::{Case, Cases, Job, MapSettings, Parameter, Quantity, Study, with_values};
use crate::measure::bands::PracticeStretch;
use crate::scene::Scene;

/// Number of sampled patients.
pub const PATIENTS: usize = 32;
/// Step of the largest usual volumes \[ml\], of a plan and of sampled patients, and more where this makes more than 128 steps.
pub const USUAL_STEP_ML: f64 = 5.0;
/// Greatest number of steps between the least and the greatest volume.
const MOST_STEPS: f64 = 128.0;

/// The search as a state machine, a [`Study`] whose jobs are one scene each.
#[derive(Debug)]
pub struct UsualRange {
    /// Least and greatest volume \[ml\].
    ends: (f64, f64),
    steps: usize,
    patients: Vec<Patient>,
    /// The running jobs, by patient and plan.
    jobs: OneByOne<(usize, Solved)>,
}

/// The plan of a job.
#[derive(Clone, Copy, Debug)]
enum Solved {
    /// A step of the search.
    Step(usize),
    /// Practice's greatest volume.
    Practice,
}

/// What the stretch of a patient is compared with.
#[derive(Debug)]
enum Against {
    /// The limits of the skin by itself.
    Skin,
    /// Practice's greatest volume, not solved yet.
    Waiting(Box<Scene>),
    /// Practice's greatest volume, solved.
    Practice(PracticeStretch),
}

/// A sampled patient with the bracket of the search.
#[derive(Debug)]
struct Patient {
    against: Against,
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
    /// first [`PATIENTS`] samples of the bands of these settings. `practice`: the plan of practice's greatest volume
    /// ([`Practice::scenes`](super::Practice::scenes)), if the stretch is compared with practice.
    ///
    /// # Errors
    /// One line with the setting that is out of its range.
    pub fn new(
        scene: &Scene,
        settings: &BandsSettings,
        ends: (f64, f64),
        practice: Option<&Scene>,
    ) -> Result<Self, BandsError> {
        let grid = Some(MapSettings::default());
        let settings =
            BandsSettings { samples: PATIENTS, importance_rows: 0, grid, ..settings.clone() };
        let practice = practice.map(|plan| Bands::new(plan, settings.clone())).transpose()?;
        let bands = Bands::new(scene, settings)?;
        let steps = ((ends.1 - ends.0) / USUAL_STEP_ML).round().clamp(1.0, MOST_STEPS) as usize;
        let patient = |sample: usize| {
            let against = practice.as_ref().map(|practice| practice.patient(sample));
            let scene = bands.patient(sample).ok();
            Patient {
                // A patient whose practice is out of the limits of a scene is left out.
                scene: scene.filter(|_| !matches!(against, Some(Err(_)))),
                against: match against {
                    Some(Ok(plan)) => Against::Waiting(Box::new(plan)),
                    _ => Against::Skin,
                },
                usual: 0,
                end: steps + 2,
                solved: 0,
                is_running: false,
            }
        };
        let patients = (0..PATIENTS).map(patient).collect();
        Ok(Self { ends, steps, patients, jobs: OneByOne::new() })
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

    /// The next plan of a patient; drops a patient whose plan is out of its limits.
    fn next_scene(&mut self, patient: usize) -> Option<(Solved, Scene)> {
        let Patient { scene, against, usual, end, is_running, .. } = &self.patients[patient];
        if *is_running || end - usual <= 1 {
            return None;
        }
        let scene = scene.as_ref()?;
        if let Against::Waiting(plan) = against {
            return Some((Solved::Practice, (**plan).clone()));
        }
        let step = (usual + end) / 2 - 1;
        let volume = (Parameter::Volume, self.volume(step));
        let scene = with_values(scene, &[volume]).ok();
        if scene.is_none() {
            self.patients[patient].scene = None;
        }
        Some((Solved::Step(step), scene?))
    }
}

impl Patient {
    /// Takes a solved plan: halves the bracket, or sets what the stretch is compared with.
    fn take(&mut self, solved: Solved, case: &Case) {
        self.solved += 1;
        match solved {
            Solved::Step(step) => {
                let practice = match self.against {
                    Against::Practice(practice) => Some(practice),
                    Against::Skin | Against::Waiting(_) => None,
                };
                if is_usual(case, practice) {
                    self.usual = step + 1;
                } else {
                    self.end = step + 1;
                }
            }
            Solved::Practice => {
                let strain = case.values.get(Quantity::GreatestStrain);
                match strain.filter(|_| case.is_converged()) {
                    // Of the words only "above practice" counts.
                    Some(more) => {
                        let practice = PracticeStretch { less: more, same: more, more };
                        self.against = Against::Practice(practice);
                    }
                    None => self.scene = None,
                }
            }
        }
    }

    fn is_done(&self) -> bool {
        self.scene.is_none() || self.end - self.usual <= 1
    }
}

impl Study for UsualRange {
    fn next_job(&mut self, store: &mut Cases) -> Option<(usize, Job)> {
        for patient in 0..self.patients.len() {
            while let Some((solved, scene)) = self.next_scene(patient) {
                match self.jobs.ask((patient, solved), scene, store) {
                    Ok(case) => self.patients[patient].take(solved, &case),
                    Err(job) => {
                        self.patients[patient].is_running = true;
                        return Some(job);
                    }
                }
            }
        }
        None
    }

    fn receive(&mut self, job: usize, cases: Vec<Case>, store: &mut Cases) {
        let Some(((patient, solved), case)) = self.jobs.receive(job, cases, store) else { return };
        let patient = &mut self.patients[patient];
        patient.is_running = false;
        match case {
            Some(case) => patient.take(solved, &case),
            None => patient.scene = None,
        }
    }

    fn progress(&self) -> (usize, usize) {
        // The greatest number of halvings of a patient, and practice's plan.
        let most = 1 + (self.steps + 2).next_power_of_two().ilog2() as usize;
        let done = |patient: &Patient| if patient.is_done() { most } else { patient.solved };
        (self.patients.iter().map(done).sum(), most * self.patients.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clinical::PracticeTable;
    use crate::study::{Practice, Unknown, evaluate};

    /// The search over the opening plan, with the number of solves.
    fn search(settings: &BandsSettings, store: &mut Cases) -> (UsualRange, usize) {
        let scene = Scene::opening();
        let mut search = UsualRange::new(&scene, settings, (100.0, 600.0), None).unwrap();
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
        // A spread of the skin alone, so that patients differ. 101 volumes are seven halvings.
        let others = Unknown::ALL.into_iter().filter(|u| *u != Unknown::SkinStrainScale);
        let unknowns = others.map(|unknown| (unknown, None)).collect();
        let settings = BandsSettings { unknowns, ..BandsSettings::default() };
        let (search, solved) = search(&settings, &mut store);
        assert!(search.is_done() && solved <= 7 * PATIENTS, "{solved} solves");
        let found = search.found().unwrap();
        assert!(found.low_ml < found.high_ml && !found.is_open, "{found:?}");
        for patient in search.patients.iter().step_by(9) {
            let stays_usual = |step: usize| {
                let volume = (Parameter::Volume, search.volume(step));
                let scene = with_values(patient.scene.as_ref().unwrap(), &[volume]).unwrap();
                is_usual(&evaluate(&Job { scenes: vec![scene], ..Job::default() })[0], None)
            };
            assert!(patient.usual == 0 || stays_usual(patient.usual - 1));
            assert!(patient.usual > search.steps || !stays_usual(patient.usual));
        }
        // An equal search solves nothing.
        let mut again =
            UsualRange::new(&Scene::opening(), &settings, (100.0, 600.0), None).unwrap();
        assert!(again.next_job(&mut store).is_none());
        assert_eq!(again.found(), Some(found));
    }

    #[test]
    fn a_failed_job_drops_its_patient_only() {
        let mut store = Cases::default();
        let settings = BandsSettings::default();
        let mut search =
            UsualRange::new(&Scene::opening(), &settings, (100.0, 600.0), None).unwrap();
        let (first, _) = search.next_job(&mut store).unwrap();
        search.receive(first, Vec::new(), &mut store);
        assert!(search.patients[0].scene.is_none());
        let (_, job) = search.next_job(&mut store).unwrap();
        assert_eq!(job.scenes.len(), 1);
        assert!(search.patients[1].is_running && !search.is_done());
    }
    #[test]
    fn against_practice_every_patient_carries_practices_greatest_volume() {
        let plan = Scene::opening();
        let practice = Practice::new(&plan, &PracticeTable::default()).unwrap();
        let [.., more] = practice.scenes();
        // Steps of 5 ml, to 30 ml more than practice's 300.
        let (ends, settings) = ((230.0, 430.0), BandsSettings::default());
        let mut search = UsualRange::new(&plan, &settings, ends, Some(more)).unwrap();
        let mut store = Cases::default();
        while let Some((index, job)) = search.next_job(&mut store) {
            search.receive(index, evaluate(&job), &mut store);
        }
        assert!(search.found().is_some_and(|found| found.high_ml >= Some(310.0)));
        let practice =
            Bands::new(more, BandsSettings { samples: PATIENTS, importance_rows: 0, ..settings })
                .unwrap();
        let solve = |mut scene: Scene| {
            MapSettings::default().apply(&mut scene);
            evaluate(&Job { scenes: vec![scene], ..Job::default() }).swap_remove(0)
        };
        for (sample, patient) in search.patients.iter().enumerate().step_by(9) {
            let more = solve(practice.patient(sample).unwrap());
            let more = more.values.get(Quantity::GreatestStrain).unwrap();
            let practice = PracticeStretch { less: 0.0, same: 0.0, more };
            let stays_usual = |step: usize| {
                let volume = (Parameter::Volume, search.volume(step));
                let scene = with_values(patient.scene.as_ref().unwrap(), &[volume]).unwrap();
                is_usual(&solve(scene), Some(practice))
            };
            assert!(patient.usual == 0 || stays_usual(patient.usual - 1), "{sample}");
            assert!(patient.usual > search.steps || !stays_usual(patient.usual), "{sample}");
        }
    }
}

//! The first plan of a list that stays usual: one scene after the other, until all words of its cards are calm.

use super::one_by_one::OneByOne;
use super::{Case, Cases, Job, Quantity, Study};
use crate::measure::bands::{self, PracticeStretch};
use crate::scene::Scene;

/// The search as a state machine, a [`Study`] of one scene at a time.
#[derive(Debug)]
pub struct FirstUsual {
    plans: Vec<(Scene, Option<PracticeStretch>)>,
    /// The scene that is solved next, or was found.
    place: usize,
    is_found: bool,
    jobs: OneByOne<()>,
}

impl FirstUsual {
    /// The search in these plans with what practice's volumes give in their tissue, in their order, each on its own grid: the words
    /// of a found plan are those of its cards.
    #[must_use]
    pub fn new(mut plans: Vec<(Scene, Option<PracticeStretch>)>) -> Self {
        plans.iter_mut().for_each(|(scene, _)| scene.patient = None);
        Self { plans, place: 0, is_found: false, jobs: OneByOne::new() }
    }

    /// Index of the first plan that stays usual; `None` before the end, and if none does.
    #[must_use]
    pub fn found(&self) -> Option<usize> {
        self.is_found.then_some(self.place)
    }

    fn take(&mut self, case: Option<&Case>) {
        let practice = self.plans.get(self.place).and_then(|(_, practice)| *practice);
        self.is_found = case.is_some_and(|case| is_usual(case, practice));
        self.place += usize::from(!self.is_found);
    }
}

/// Has a case an answer in which the words of stretch, cover and pressure are calm? The stretch is compared with `practice`, if
/// that is known.
pub(super) fn is_usual(case: &Case, practice: Option<PracticeStretch>) -> bool {
    let value = |quantity: Quantity| case.values.get(quantity);
    let reserve = value(Quantity::SkinReserveUsed);
    let stretch = value(Quantity::GreatestStrain)
        .map(|strain| bands::stretch_by(practice, strain, reserve).0);
    let pressure = value(Quantity::GreatestPressureMmhg).map(bands::pressure_band);
    let is_thin = value(Quantity::LeastCoverMm).and_then(bands::cover).is_some();
    case.is_converged() && (stretch, pressure) == (Some(0), Some(0)) && !is_thin
}

impl Study for FirstUsual {
    fn next_job(&mut self, store: &mut Cases) -> Option<(usize, Job)> {
        while !self.is_found && self.jobs.is_idle() {
            let (scene, _) = self.plans.get(self.place)?.clone();
            match self.jobs.ask((), scene, store) {
                Ok(case) => self.take(Some(&case)),
                Err(job) => return Some(job),
            }
        }
        None
    }

    fn receive(&mut self, job: usize, cases: Vec<Case>, store: &mut Cases) {
        if let Some(((), case)) = self.jobs.receive(job, cases, store) {
            self.take(case.as_ref());
        }
    }

    fn progress(&self) -> (usize, usize) {
        match self.is_found {
            true => (self.place + 1, self.place + 1),
            false => (self.place, self.plans.len()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{MapSettings, Parameter, evaluate, with_values};

    /// The opening plan with another volume on a coarse grid.
    fn coarse(volume: f64) -> Scene {
        let values = [(Parameter::Volume, volume)];
        let mut plan = with_values(&Scene::opening(), &values).unwrap();
        MapSettings::default().apply(&mut plan);
        plan
    }

    #[test]
    fn the_first_usual_plan_of_a_list_is_found_and_stored() {
        // The second is usual, as the opening plan; a flat third is never solved.
        let plans = [700.0, 225.0, 200.0].map(|volume| (coarse(volume), None)).to_vec();
        let (mut search, mut store) = (FirstUsual::new(plans.clone()), Cases::default());
        let mut solved = 0;
        while let Some((index, job)) = search.next_job(&mut store) {
            assert!(search.next_job(&mut store).is_none() && !search.is_done());
            search.receive(index + 7, Vec::new(), &mut store);
            search.receive(index, evaluate(&job), &mut store);
            solved += 1;
        }
        assert_eq!((search.found(), solved, search.is_done()), (Some(1), 2, true));
        let mut again = FirstUsual::new(plans);
        assert!(again.next_job(&mut store).is_none());
        assert_eq!(again.found(), Some(1));
        // A failed job is no usual plan.
        let mut failed = FirstUsual::new(vec![(coarse(250.0), None)]);
        let (index, _) = failed.next_job(&mut store).unwrap();
        failed.receive(index, Vec::new(), &mut store);
        assert_eq!((failed.found(), failed.is_done()), (None, true));
    }

    #[test]
    fn a_stretch_as_practice_is_calm_and_one_above_is_not() {
        let volumes = [350.0, 300.0];
        let plans = volumes.map(coarse);
        let strain = |plan: &Scene| {
            let outcome = crate::simulate::simulate(plan).unwrap();
            Quantity::GreatestStrain.of(&outcome).unwrap()
        };
        let [greater, less] = [strain(&plans[0]), strain(&plans[1])];
        let found = |more: f64| {
            let practice = PracticeStretch { less: 0.1, same: 0.5 * (0.1 + more), more };
            let plans = plans.iter().map(|plan| (plan.clone(), Some(practice))).collect();
            let (mut search, mut store) = (FirstUsual::new(plans), Cases::default());
            while let Some((index, job)) = search.next_job(&mut store) {
                search.receive(index, evaluate(&job), &mut store);
            }
            search.found()
        };
        assert_eq!(found(greater + 1e-6), Some(0));
        assert_eq!(found(0.5 * (greater + less)), Some(1));
        assert_eq!(found(less - 1e-6), None);
    }

    /// The stretch of the opening patient's skin is within a percent of the limit at 243 ml: a coarse grid takes the volume as usual.
    #[test]
    fn a_plan_that_is_usual_on_its_own_grid_has_usual_cards() {
        let volumes = [250.0, 245.0, 240.0, 235.0];
        let plan =
            |volume: &f64| with_values(&Scene::opening(), &[(Parameter::Volume, *volume)]).unwrap();
        let mut search = FirstUsual::new(volumes.iter().map(|v| (plan(v), None)).collect());
        let mut store = Cases::default();
        while let Some((index, job)) = search.next_job(&mut store) {
            search.receive(index, evaluate(&job), &mut store);
        }
        let largest = volumes[search.found().unwrap()];
        let band = |volume: f64| {
            let outcome = crate::simulate::simulate(&plan(&volume)).unwrap();
            let value = |quantity: Quantity| quantity.of(&outcome);
            bands::stretch(
                value(Quantity::GreatestStrain).unwrap(),
                value(Quantity::SkinReserveUsed),
            )
            .0
        };
        assert_eq!((band(largest), band(largest + 5.0)), (0, 1), "{largest}");
    }
}

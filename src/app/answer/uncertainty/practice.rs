//! Practice's volumes in the tissue of the few sampled patients: what their stretches are compared with.

use super::sampling::{Findings, Sampling};
use crate::app::answer::practice::Practices;
use crate::app::frame::studies::Studies;
use crate::measure::bands::PracticeStretch;
use crate::scene::Scene;
use crate::study::{Bands, BandsSettings, Quantity};
use eframe::egui;

/// The patients under practice's volume less a step, and plus a step.
pub(super) struct PracticeSamples {
    samplings: [Sampling; 2],
    /// The plans of these volumes; `None` for a plan that is not compared with practice.
    plans: Option<[Scene; 2]>,
    /// The plan, and the number of practice's changes, to which the volumes belong.
    key: Option<(Scene, u64)>,
    /// Is there something that the findings do not have yet?
    is_new: bool,
}

impl Default for PracticeSamples {
    fn default() -> Self {
        let sampling = || Sampling::new(Bands::samples_only);
        Self { samplings: [sampling(), sampling()], plans: None, key: None, is_new: false }
    }
}

impl PracticeSamples {
    /// Starts, continues or cancels the studies of a plan, once a frame. `may_start`: are the patients of the plan itself solved?
    pub(super) fn advance(
        &mut self,
        (plan, settings): (&Scene, BandsSettings),
        practices: &Practices,
        studies: &mut Studies,
        ctx: &egui::Context,
        may_start: bool,
    ) {
        let is_of = |(of, changes): &(Scene, u64)| of == plan && *changes == practices.changes();
        if !self.key.as_ref().is_some_and(is_of) {
            self.key = Some((plan.clone(), practices.changes()));
            self.plans = practices.least_and_greatest(plan);
            self.is_new = true;
        }
        match &self.plans {
            Some(plans) => {
                for (sampling, plan) in self.samplings.iter_mut().zip(plans) {
                    self.is_new |=
                        sampling.advance((plan, settings.clone()), studies, ctx, may_start);
                }
            }
            None => self.samplings.iter_mut().for_each(|sampling| sampling.stop(studies)),
        }
    }

    /// Have the studies ended, or is there none?
    pub(super) fn is_at_end(&self) -> bool {
        self.plans.is_none() || self.samplings.iter().all(Sampling::is_at_end)
    }

    /// Compares the patients of the findings, once all are solved, with practice.
    pub(super) fn read(&mut self, findings: [&mut Findings; 2]) {
        let [less, more] = &self.samplings;
        let complete = self.plans.as_ref().and(less.complete()).zip(more.complete());
        for findings in findings {
            let Some((less, more)) = complete.filter(|_| findings.is_sampled()) else {
                findings.practice.clear();
                continue;
            };
            if findings.practice.is_empty() || self.is_new {
                findings.practice = compared(findings, [less, more]);
            }
        }
        self.is_new = false;
    }
}

/// The strain of each patient with those of practice's volumes in its tissue.
fn compared(own: &Findings, practice: [&Findings; 2]) -> Vec<(f64, PracticeStretch)> {
    let others = practice.map(Findings::values);
    let strains = own.values().beside(others, Quantity::GreatestStrain);
    let of_patient = |[own, less, more]: [f64; 3]| {
        (own, PracticeStretch { less, same: 0.5 * (less + more), more })
    };
    strains.into_iter().flatten().map(of_patient).collect()
}

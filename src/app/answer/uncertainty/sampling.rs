//! The sampled patients of the present plan: their study, which starts once the plan rests and ends with the plan, and what it has found.

use crate::app::frame::studies::{Driver, Studies};
use crate::measure::bands::PracticeStretch;
use crate::scene::Scene;
use crate::study::{
    Band, Bands, BandsError, BandsSettings, LEAST_ANSWERS, PointStatus, Quantity, Samples,
    SectionBand, has_same_patients,
};
use eframe::egui;
use std::collections::BTreeMap;
use std::time::Duration;

/// Number of the few patients, which are the first of all patients.
pub(crate) const FEW: usize = 16;
/// Time after an edit before the study starts \[s\].
const QUIET: f64 = 0.3;

/// A study of sampled patients and its findings.
pub(super) struct Sampling {
    study_of: fn(&Scene, BandsSettings) -> Result<Bands, BandsError>,
    pub(super) driver: Driver<Bands>,
    /// Scene and settings of the study, or of the study that waits for its start.
    subject: Option<(Scene, BandsSettings)>,
    /// Time of the edit after which the study waits for its start \[s\].
    waits_since: Option<f64>,
    /// Number of solved scenes whose bands are read.
    read: usize,
    /// Why the study has not started.
    pub(super) error: Option<String>,
    pub(super) findings: Findings,
}

/// The bands so far.
#[derive(Default)]
pub(crate) struct Findings {
    /// Number of samples.
    pub(super) samples: usize,
    /// Solved samples by state.
    pub(super) counts: BTreeMap<&'static str, usize>,
    pub(super) bands: Vec<Band>,
    pub(super) values: Samples,
    pub(super) section: Vec<SectionBand>,
    /// Strains \[-\] of a few patients, and those of practice's volumes in the tissue of each.
    pub(super) practice: Vec<(f64, PracticeStretch)>,
}

impl Findings {
    /// Bands of a few patients, of whom some have no answer, for tests of words.
    #[cfg(test)]
    pub(crate) fn of_bands(bands: Vec<Band>, without_answer: usize) -> Self {
        let counts = [
            (PointStatus::Converged.word(), FEW - without_answer),
            (PointStatus::NoShape.word(), without_answer),
        ];
        Self { samples: FEW, counts: counts.into(), bands, ..Self::default() }
    }

    /// The band of a quantity; `None` if the quantity does not apply.
    pub(crate) fn band(&self, quantity: Quantity) -> Option<&Band> {
        self.bands.iter().find(|band| band.quantity == quantity)
    }

    /// The values of the samples.
    pub(crate) fn values(&self) -> &Samples {
        &self.values
    }

    /// The band of the skin's section.
    pub(crate) fn section(&self) -> &[SectionBand] {
        &self.section
    }

    /// Strains \[-\] of a few patients with answers, and those of practice's volumes in the tissue of each; empty while they are not known.
    pub(crate) fn practice(&self) -> &[(f64, PracticeStretch)] {
        &self.practice
    }

    /// Number of samples with an answer.
    pub(crate) fn answers(&self) -> usize {
        self.count(PointStatus::Converged)
    }

    /// Are there no bands?
    pub(crate) fn is_empty(&self) -> bool {
        self.bands.is_empty()
    }

    /// Share of the solved samples without an answer \[-\].
    pub(crate) fn without_answer(&self) -> f64 {
        let solved = self.solved();
        (solved - self.answers()) as f64 / solved.max(1) as f64
    }

    /// Number of solved samples.
    pub(crate) fn solved(&self) -> usize {
        self.counts.values().sum()
    }

    /// Are all samples solved?
    pub(super) fn is_sampled(&self) -> bool {
        self.samples > 0 && self.solved() == self.samples
    }

    pub(super) fn count(&self, status: PointStatus) -> usize {
        self.counts.get(status.word()).copied().unwrap_or(0)
    }
}

impl Sampling {
    /// A study that `study_of` makes of a scene and its settings.
    pub(super) fn new(study_of: fn(&Scene, BandsSettings) -> Result<Bands, BandsError>) -> Self {
        Self {
            study_of,
            driver: Driver::default(),
            subject: None,
            waits_since: None,
            read: 0,
            error: None,
            findings: Findings::default(),
        }
    }

    /// Starts, continues or cancels the study of a scene, once a frame. `may_start`: is the plan at rest, and all that comes before
    /// the study done? Returns whether scenes were solved.
    pub(super) fn advance(
        &mut self,
        (scene, settings): (&Scene, BandsSettings),
        studies: &mut Studies,
        ctx: &egui::Context,
        may_start: bool,
    ) -> bool {
        let now = ctx.input(|input| input.time);
        if !self.is_of(scene) || self.settings() != Some(&settings) {
            self.stop(studies);
            self.subject = Some((scene.clone(), settings));
            self.waits_since = Some(now);
        } else if let Some((of, _)) = self.subject.as_mut().filter(|(of, _)| of != scene) {
            // At rest equal scenes are compared, which builds none.
            of.clone_from(scene);
        }
        if let Some(since) = self.waits_since
            && may_start
        {
            let left = since + QUIET - now;
            if left > 0.0 {
                ctx.request_repaint_after(Duration::from_secs_f64(left));
            } else {
                self.waits_since = None;
                self.start(studies);
            }
        }
        let is_new = self.driver.advance(studies);
        if is_new {
            self.read();
        }
        is_new
    }

    /// Is the study that of a plan? Side and visit are none of it.
    pub(super) fn is_of(&self, scene: &Scene) -> bool {
        self.subject.as_ref().is_some_and(|(of, _)| has_same_patients(of, scene))
    }

    /// The settings of the study; `None` without one.
    pub(super) fn settings(&self) -> Option<&BandsSettings> {
        self.subject.as_ref().map(|(_, settings)| settings)
    }

    fn start(&mut self, studies: &mut Studies) {
        let Some((scene, settings)) = &self.subject else { return };
        match (self.study_of)(scene, settings.clone()) {
            Ok(bands) => {
                self.findings.samples = settings.samples;
                self.driver.start(bands, studies);
            }
            Err(error) => self.error = Some(error.to_string()),
        }
    }

    /// Cancels the study; its bands are those of another plan.
    pub(super) fn stop(&mut self, studies: &mut Studies) {
        if self.subject.take().is_none() {
            return;
        }
        self.driver.cancel(studies);
        (self.findings, self.read) = (Findings::default(), 0);
        self.waits_since = None;
        self.error = None;
    }

    /// Reads what the study has found.
    fn read(&mut self) {
        let Some(study) = self.driver.study() else { return };
        self.findings.counts = study.counts();
        self.findings.counts.remove(PointStatus::Waiting.word());
        let before = std::mem::replace(&mut self.read, study.solved());
        if self.read != before && self.findings.answers() >= LEAST_ANSWERS {
            self.findings.bands = study.bands();
            self.findings.values = study.values();
            self.findings.section = study.section();
        }
    }

    /// Does the study wait for its start?
    pub(super) fn is_waiting(&self) -> bool {
        self.waits_since.is_some()
    }

    /// Has the study ended, or can it not start?
    pub(super) fn is_at_end(&self) -> bool {
        self.driver.finished().is_some() || self.error.is_some()
    }

    /// The bands so far; `None` without enough samples.
    pub(super) fn findings(&self) -> Option<&Findings> {
        Some(&self.findings).filter(|findings| !findings.is_empty())
    }

    /// The bands once all samples are solved.
    pub(super) fn complete(&self) -> Option<&Findings> {
        self.findings().filter(|findings| findings.is_sampled())
    }
}

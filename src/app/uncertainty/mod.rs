//! Uncertainty: bands of the plan's results over what is not known about a person.
//!
//! This file runs the study: after the plan is solved, again after each edit; then one for each pin. `panel` (the section
//! of the answer) | `unknowns` (what varies, and how much) | `chart` (which unknown matters most) | `pins` (the samples of
//! the pins).

mod chart;
mod panel;
mod pins;
mod unknowns;

pub(super) use panel::figure;

use super::studies::{Driver, Studies};
use crate::app::texts::tr;
use crate::measure::Status;
use crate::scene::Scene;
use crate::session::Session;
use crate::study::{
    Band, Bands, BandsSettings, Index, LEAST_ANSWERS, PointStatus, Quantity, Samples, SectionBand,
    Unknown,
};
use eframe::egui;
use pins::PinSamples;
use std::collections::BTreeMap;
use std::time::Duration;
use unknowns::Choices;

/// Time after an edit before the study starts \[s\].
const QUIET: f64 = 0.3;

/// The study of what is not known, and its choices.
pub(super) struct Uncertainty {
    is_on: bool,
    /// Does the picture contain the envelopes of the skin?
    is_in_picture: bool,
    choices: Choices,
    /// The quantity of the chart.
    explained: Quantity,
    driver: Driver<Bands>,
    /// Scene and settings of the study, or of the study that waits for its start.
    subject: Option<(Scene, BandsSettings)>,
    /// Time of the edit after which the study waits for its start \[s\].
    waits_since: Option<f64>,
    /// Why the study has not started.
    error: Option<String>,
    findings: Findings,
    pins: PinSamples,
}

/// The bands so far.
#[derive(Default)]
pub(super) struct Findings {
    /// Number of samples.
    samples: usize,
    /// Solved samples by state.
    counts: BTreeMap<&'static str, usize>,
    bands: Vec<Band>,
    values: Samples,
    section: Vec<SectionBand>,
    /// Importance for the chart's quantity.
    importance: Vec<(Unknown, Index)>,
}

impl Findings {
    /// The band of a quantity; `None` if the quantity does not apply.
    pub(super) fn band(&self, quantity: Quantity) -> Option<&Band> {
        self.bands.iter().find(|band| band.quantity == quantity)
    }

    /// The values of the samples.
    pub(super) fn values(&self) -> &Samples {
        &self.values
    }

    /// The band of the skin's section.
    pub(super) fn section(&self) -> &[SectionBand] {
        &self.section
    }

    /// Number of samples with an answer.
    pub(super) fn answers(&self) -> usize {
        self.count(PointStatus::Converged)
    }

    /// Are there no bands?
    pub(super) fn is_empty(&self) -> bool {
        self.bands.is_empty()
    }

    /// Share of the solved samples without an answer \[-\].
    pub(super) fn without_answer(&self) -> f64 {
        let solved = self.solved();
        (solved - self.answers()) as f64 / solved.max(1) as f64
    }

    /// The number of samples without an answer in a sentence, with a space after it; `None` if all have one.
    pub(super) fn missing(&self) -> Option<String> {
        let (none, of) = (self.solved() - self.answers(), self.solved());
        (none > 0).then(|| tr!("{none} of {of} such patients without an answer. ", none, of))
    }

    /// Number of solved samples.
    pub(super) fn solved(&self) -> usize {
        self.counts.values().sum()
    }

    /// Are all samples solved?
    fn is_sampled(&self) -> bool {
        self.samples > 0 && self.solved() == self.samples
    }

    fn count(&self, status: PointStatus) -> usize {
        self.counts.get(status.word()).copied().unwrap_or(0)
    }
}

impl Default for Uncertainty {
    fn default() -> Self {
        Self {
            is_on: false,
            is_in_picture: false,
            choices: Choices::default(),
            explained: Quantity::GreatestStrain,
            driver: Driver::default(),
            subject: None,
            waits_since: None,
            error: None,
            findings: Findings::default(),
            pins: PinSamples::default(),
        }
    }
}

impl Uncertainty {
    /// Starts, continues or cancels the study, once a frame. `is_busy`: the plan is being solved or edited.
    pub(super) fn advance(
        &mut self,
        session: &Session,
        studies: &mut Studies,
        ctx: &egui::Context,
        is_busy: bool,
    ) {
        if !self.is_on {
            if self.subject.take().is_some() {
                self.stop(studies);
                self.pins.cancel(studies);
            }
            return;
        }
        let (scene, settings) = (session.scene(), self.choices.settings(session.scene()));
        let now = ctx.input(|input| input.time);
        if self.subject.as_ref().is_none_or(|(of, by)| !of.is_same_plan(scene) || *by != settings) {
            self.stop(studies);
            self.subject = Some((scene.clone(), settings));
            self.waits_since = Some(now);
        }
        if let Some(since) = self.waits_since
            && !is_busy
            && has_answer(session)
        {
            let left = since + QUIET - now;
            if left > 0.0 {
                ctx.request_repaint_after(Duration::from_secs_f64(left));
            } else {
                self.waits_since = None;
                self.start(studies);
            }
        }
        if self.driver.advance(studies) {
            self.read();
        }
        // The present plan first, the pins at rest.
        let is_free = self.driver.finished().is_some() && !is_busy;
        self.pins.advance(session, |scene| self.choices.settings(scene), studies, is_free);
    }

    fn start(&mut self, studies: &mut Studies) {
        let Some((scene, settings)) = &self.subject else { return };
        match Bands::new(scene, settings.clone()) {
            Ok(bands) => {
                self.findings.samples = settings.samples;
                self.driver.start(bands, studies);
            }
            Err(error) => self.error = Some(error.to_string()),
        }
    }

    /// Cancels the study; its bands are those of another plan.
    fn stop(&mut self, studies: &mut Studies) {
        self.driver.cancel(studies);
        self.findings = Findings::default();
        self.waits_since = None;
        self.error = None;
    }

    /// Reads what the study has found. Bands change with the samples, the importance after the samples.
    fn read(&mut self) {
        let Some(study) = self.driver.study() else { return };
        let before = self.findings.solved();
        self.findings.counts = study.counts();
        self.findings.counts.remove(PointStatus::Waiting.word());
        if self.findings.solved() != before && self.findings.answers() >= LEAST_ANSWERS {
            self.findings.bands = study.bands();
            self.findings.values = study.values();
            self.findings.section = study.section();
        }
        if self.findings.is_sampled() {
            self.explain();
        }
    }

    /// Reads the importance for the chart's quantity, greatest first.
    fn explain(&mut self) {
        let Some(study) = self.driver.study() else { return };
        let unknowns = study.unknowns().iter().map(|(unknown, _)| *unknown);
        let found = unknowns.zip(study.importance(self.explained));
        let mut found: Vec<_> =
            found.filter_map(|(unknown, index)| Some((unknown, index?))).collect();
        found.sort_by(|(_, a), (_, b)| b.first_order.total_cmp(&a.first_order));
        self.findings.importance = found;
    }

    /// The choices of the bands of a plan while they are on, and whether the bands are complete; the importance takes longer.
    pub(super) fn choices(&self, scene: &Scene) -> Option<(BandsSettings, bool)> {
        self.is_on.then(|| (self.choices.settings(scene), self.findings.is_sampled()))
    }

    /// [`Self::progress`] while the study runs.
    pub(super) fn running(&self) -> Option<(usize, usize)> {
        self.driver.is_running().then(|| self.progress())
    }

    /// Numbers of computed plans and of all plans of the study; both 0 without one.
    pub(super) fn progress(&self) -> (usize, usize) {
        self.driver.progress()
    }

    /// The bands of the present plan; `None` without enough samples.
    pub(super) fn findings(&self) -> Option<&Findings> {
        Some(&self.findings).filter(|findings| !findings.bands.is_empty())
    }

    /// The sampled values of a plan that is the present one or a pin; `None` before its samples.
    pub(super) fn values(&self, scene: &Scene) -> Option<&Samples> {
        let (subject, _) = self.subject.as_ref()?;
        if subject.is_same_plan(scene) {
            return self.findings().map(|findings| &findings.values);
        }
        self.pins.values(scene)
    }

    /// The band of the skin's section, if the picture should contain its envelopes.
    pub(super) fn envelope(&self) -> Option<&[SectionBand]> {
        self.findings().filter(|_| self.is_in_picture).map(Findings::section)
    }

    /// What the bands are, in a few sentences; `None` without bands.
    pub(super) fn about_bands(&self) -> Option<String> {
        let findings = self.findings()?;
        let count = match (findings.solved(), findings.samples) {
            (solved, all) if solved == all => all.to_string(),
            (solved, all) => tr!("{solved} of {all}", solved, all),
        };
        let mut words =
            tr!("In brackets: 10th to 90th percentile of {count} sampled patients.", count);
        if let Some(missing) = panel::without_answer(findings) {
            words += " ";
            words += &missing;
        }
        Some(words)
    }

    /// What repeats the sampled patients, in a sentence; `None` without bands.
    pub(super) fn seed_in_words(&self) -> Option<String> {
        let seed = self.findings().and(self.driver.study())?.settings().seed;
        Some(tr!("Seed of the sampled patients: {seed}.", seed))
    }

    /// The bands of the answer in one sentence, for screen readers; empty without bands.
    pub(super) fn summary(&self) -> String {
        if self.driver.is_running() {
            return tr(" Patients are being computed.").to_owned();
        }
        let Some(findings) = self.findings() else { return String::new() };
        if findings.solved() < findings.samples {
            return String::new();
        }
        let list: Vec<String> = panel::ANSWER
            .iter()
            .filter_map(|(quantity, name)| {
                let words = panel::band_in_words(*quantity, findings.band(*quantity)?);
                Some(format!("{} {words}", tr(name).to_lowercase()))
            })
            .collect();
        tr!(
            " Of {count} sampled patients 8 in 10 lie between: {list}. {note}",
            count = findings.samples,
            list = list.join("; "),
            note = tr(panel::ILLUSTRATION)
        )
    }
}

/// Has the present plan an answer within its tolerance?
fn has_answer(session: &Session) -> bool {
    session.result().is_some_and(|outcome| outcome.status == Status::Converged)
}

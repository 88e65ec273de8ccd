//! Uncertainty: bands of the plan's results over what is not known about a person.
//!
//! This file runs the studies: of a few patients after each edit, once the plan and its largest usual volume are known; while the section
//! is on, then of all patients, and one for each pin. `sampling` (a study of the plan and its findings) | `practice` (practice's volumes in the tissue of the sampled patients) | `panel` (the section of the
//! answer) | `unknowns` (what varies, and how much) | `chart` (which unknown matters most) | `pins` (the samples of the pins).

mod chart;
mod panel;
mod pins;
mod practice;
mod sampling;
mod unknowns;

pub(crate) use panel::{figure, without_answer};
pub(crate) use sampling::{FEW, Findings};

use super::practice::Practices;
use crate::app::frame::studies::Studies;
use crate::app::texts::tr;
use crate::measure::Status;
use crate::scene::Scene;
use crate::session::Session;
use crate::study::{Bands, BandsSettings, Index, Quantity, Samples, SectionBand, Unknown};
use eframe::egui;
use pins::PinSamples;
use practice::PracticeSamples;
use sampling::Sampling;
use unknowns::Choices;

/// The study of what is not known, and its choices.
pub(crate) struct Uncertainty {
    is_on: bool,
    /// Does the picture contain the envelopes of the skin?
    is_in_picture: bool,
    choices: Choices,
    /// The quantity of the chart.
    explained: Quantity,
    /// Importance of the unknowns for that quantity, greatest first.
    importance: Vec<(Unknown, Index)>,
    /// A few patients, at any time.
    few: Sampling,
    /// Practice's volumes in the tissue of these.
    practice: PracticeSamples,
    /// All patients, while the section is on.
    all: Sampling,
    pins: PinSamples,
}

impl Default for Uncertainty {
    fn default() -> Self {
        Self {
            is_on: false,
            is_in_picture: false,
            choices: Choices::default(),
            explained: Quantity::GreatestStrain,
            importance: Vec::new(),
            few: Sampling::new(Bands::samples_only),
            practice: PracticeSamples::default(),
            all: Sampling::new(Bands::new),
            pins: PinSamples::default(),
        }
    }
}

impl Uncertainty {
    /// Starts, continues or cancels the studies, once a frame. `is_busy`: the plan is being solved or edited; `is_known`: the largest
    /// usual volume of the plan is known, before which no study starts that the user has not switched on.
    pub(crate) fn advance(
        &mut self,
        session: &Session,
        studies: &mut Studies,
        ctx: &egui::Context,
        practices: &Practices,
        is_busy: bool,
        is_known: bool,
    ) {
        let (scene, settings) = (session.scene(), self.choices.settings(session.scene()));
        let is_solved = !is_busy && has_answer(session);
        let few = BandsSettings { samples: FEW, importance_rows: 0, ..settings.clone() };
        let may_start = is_solved && (self.is_on || is_known);
        self.few.advance((scene, few.clone()), studies, ctx, may_start);
        let may_start = is_solved && self.few.is_at_end();
        self.practice.advance((scene, few), practices, studies, ctx, may_start);
        self.practice.read([&mut self.few.findings, &mut self.all.findings]);
        if !self.is_on {
            self.all.stop(studies);
            self.pins.cancel(studies);
            return;
        }
        // The solved patients are taken from those stored.
        let may_start = is_solved && self.few.is_at_end();
        if self.all.advance((scene, settings), studies, ctx, may_start) {
            self.explain();
        }
        // The present plan first, the pins at rest.
        let is_free = self.all.driver.finished().is_some() && !is_busy;
        self.pins.advance(session, |scene| self.choices.settings(scene), studies, is_free);
    }

    /// Reads the importance for the chart's quantity, greatest first: empty before the study ends, half of it is none.
    fn explain(&mut self) {
        self.importance.clear();
        let Some(study) = self.all.driver.finished() else { return };
        let unknowns = study.unknowns().iter().map(|(unknown, _)| *unknown);
        let found = unknowns.zip(study.importance(self.explained));
        self.importance.extend(found.filter_map(|(unknown, index)| Some((unknown, index?))));
        self.importance.sort_by(|(_, a), (_, b)| b.first_order.total_cmp(&a.first_order));
    }

    /// The choices of the bands of a plan while they are on, and whether the bands are complete; the importance takes longer.
    pub(crate) fn choices(&self, scene: &Scene) -> Option<(BandsSettings, bool)> {
        self.is_on.then(|| (self.choices.settings(scene), self.all.findings.is_sampled()))
    }

    /// Are the ranges of the cards of a plan known, or can they not be computed?
    pub(crate) fn is_known(&self, scene: &Scene) -> bool {
        self.few.is_of(scene) && self.few.is_at_end() && self.practice.is_at_end()
    }

    /// [`Self::progress`] while the study runs.
    pub(crate) fn running(&self) -> Option<(usize, usize)> {
        self.all.driver.is_running().then(|| self.progress())
    }

    /// Numbers of computed plans and of all plans of the study; both 0 without one.
    pub(crate) fn progress(&self) -> (usize, usize) {
        self.all.driver.progress()
    }

    /// The bands of the present plan; `None` without enough samples.
    pub(crate) fn findings(&self) -> Option<&Findings> {
        self.all.findings()
    }

    /// The bands of the cards of a plan: those of all patients once all are solved, else those of the few; `None` before.
    pub(crate) fn of_cards(&self, scene: &Scene) -> Option<&Findings> {
        let found = self.all.complete().or_else(|| self.few.complete());
        found.filter(|_| self.few.is_of(scene))
    }

    /// The sampled values of a plan that is the present one or a pin; `None` before its samples.
    pub(crate) fn values(&self, scene: &Scene) -> Option<&Samples> {
        self.all.settings()?;
        if self.all.is_of(scene) {
            return self.findings().map(Findings::values);
        }
        self.pins.values(scene)
    }

    /// The band of the skin's section, if the picture should contain its envelopes.
    pub(crate) fn envelope(&self) -> Option<&[SectionBand]> {
        self.findings().filter(|_| self.is_in_picture).map(Findings::section)
    }

    /// What the bands of the cards of a plan are, in a few sentences; `None` without bands.
    pub(crate) fn about_bands(&self, scene: &Scene) -> Option<String> {
        let findings = self.of_cards(scene)?;
        let mut words = tr!(
            "In brackets: 10th to 90th percentile of {count} sampled patients.",
            count = findings.samples
        );
        if let Some(missing) = without_answer(findings) {
            words += " ";
            words += &missing;
        }
        Some(words)
    }

    /// What repeats the sampled patients of a plan, in a sentence; `None` without bands.
    pub(crate) fn seed_in_words(&self, scene: &Scene) -> Option<String> {
        let seed = self.of_cards(scene).and(self.few.settings())?.seed;
        Some(tr!("Seed of the sampled patients: {seed}.", seed))
    }

    /// The bands of the answer in one sentence, for screen readers; empty without bands.
    pub(crate) fn summary(&self) -> String {
        if self.all.driver.is_running() {
            return tr(" Patients are being computed.").to_owned();
        }
        let Some(findings) = self.all.complete() else { return String::new() };
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::frame::studies::tests::{Log, solved_and_reused, studies};
    use crate::scene::{Side, TissueModel, Visit};
    use crate::session::Command;
    use std::cell::RefCell;
    use std::rc::Rc;

    /// The studies beside a session, frame by frame.
    struct Frames {
        ctx: egui::Context,
        time: f64,
        session: Session,
        studies: Studies,
        log: Rc<RefCell<Log>>,
        uncertainty: Uncertainty,
    }

    impl Frames {
        /// A solved sheet.
        fn new() -> Self {
            let mut scene = Scene::opening();
            scene.set_tissue_model(TissueModel::Sheet);
            let (studies, log) = studies(&[]);
            let (ctx, uncertainty) = (egui::Context::default(), Uncertainty::default());
            let session = Session::new(scene).unwrap();
            let mut frames = Self { ctx, time: 0.0, session, studies, log, uncertainty };
            frames.solve();
            frames
        }

        fn solve(&mut self) {
            while self.session.is_working() {
                self.session.solve(&mut || false);
                self.session.conclude();
            }
        }

        fn edit(&mut self, edit: impl FnOnce(&mut Scene)) {
            let mut scene = Box::new(self.session.scene().clone());
            edit(&mut scene);
            self.session.apply(Command::Edit { scene, gesture: 1 }).unwrap();
            self.solve();
        }

        /// A frame after a tenth of a second.
        fn next(&mut self, is_known: bool) {
            self.time += 0.1;
            self.ctx.begin_pass(egui::RawInput { time: Some(self.time), ..Default::default() });
            self.studies.poll(&self.ctx, false);
            let Self { session, studies, ctx, .. } = self;
            self.uncertainty.advance(session, studies, ctx, &Practices::default(), false, is_known);
            self.ctx.end_pass().textures_delta.clear();
        }

        /// Number of patients in the cards.
        fn in_cards(&self) -> Option<usize> {
            self.uncertainty.of_cards(self.session.scene()).map(Findings::solved)
        }

        fn until(&mut self, is_reached: impl Fn(&Self) -> bool) {
            for _ in 0..1000 {
                if is_reached(self) {
                    return;
                }
                self.next(true);
            }
            panic!("{:?} of {:?}", solved_and_reused(&self.studies), self.uncertainty.progress());
        }
    }

    #[test]
    fn a_few_patients_are_solved_after_the_largest_volume_and_an_edit_cancels_them() {
        let mut frames = Frames::new();
        (0..10).for_each(|_| frames.next(false));
        assert_eq!(frames.log.borrow().submitted, 0);
        // A frame submits one job or two.
        frames.until(|frames| frames.log.borrow().submitted >= 6);
        let begun = frames.log.borrow().submitted;
        let before = frames.studies.jobs();
        let (solved, _) = solved_and_reused(&frames.studies);
        assert!(before > 0 && begun < FEW && solved + before == begun, "{solved} {before} {begun}");
        frames.edit(|scene| scene.pocket_radius_mm += 2.0);
        assert_eq!(frames.in_cards(), None);
        frames.next(true);
        assert_eq!(frames.studies.jobs(), 0);
        // Nothing begins before the edited plan rests.
        frames.next(true);
        assert_eq!(frames.log.borrow().submitted, begun);
        frames.until(|frames| frames.in_cards().is_some());
        assert_eq!(frames.in_cards(), Some(FEW));
        // A scene each.
        let (all, reused) = solved_and_reused(&frames.studies);
        assert_eq!((all - solved, reused), (FEW, 0));
        assert_eq!(frames.log.borrow().submitted, begun + FEW);
        (0..10).for_each(|_| frames.next(true));
        assert_eq!(frames.log.borrow().submitted, begun + FEW);
        // Side, visit and names are none of the patients': nothing is solved, and nothing leaves the cards.
        frames.edit(|scene| {
            scene.side = Some(Side::Right);
            scene.visit = Some(Visit { reference: "4711".to_owned(), ..Visit::default() });
            scene.implant_reference = "A 1".to_owned();
            scene.layers[0].tissue = "cutis".to_owned();
        });
        for _ in 0..5 {
            assert_eq!(frames.in_cards(), Some(FEW));
            frames.next(true);
        }
        assert_eq!(frames.log.borrow().submitted, begun + FEW);
        // The present plan's cards have no patients of another plan, in the frame of the edit either.
        frames.edit(|scene| scene.pocket_radius_mm += 2.0);
        assert_eq!(frames.in_cards(), None);
    }

    #[test]
    fn all_patients_contain_the_few_and_take_their_place_at_the_end() {
        let mut frames = Frames::new();
        frames.until(|frames| frames.in_cards().is_some());
        assert_eq!(solved_and_reused(&frames.studies), (FEW, 0));
        (frames.uncertainty.is_on, frames.uncertainty.choices) = (true, Choices::of_samples(32));
        frames.until(|frames| frames.uncertainty.progress().0 > 10);
        assert_eq!(frames.in_cards(), Some(FEW));
        assert!(frames.uncertainty.findings().is_some());
        frames.until(|frames| frames.in_cards() != Some(FEW));
        assert_eq!(frames.in_cards(), Some(32));
        // The importance takes longer: nothing of it is shown before its end.
        frames.until(|frames| {
            let (done, all) = frames.uncertainty.progress();
            done < all && done > (32 + all) / 2
        });
        assert!(frames.uncertainty.importance.is_empty());
        frames.until(|frames| frames.uncertainty.all.driver.finished().is_some());
        assert!(!frames.uncertainty.importance.is_empty());
        let (_, reused) = solved_and_reused(&frames.studies);
        assert_eq!(reused, FEW);
        // Off, the few are there at once.
        frames.uncertainty.is_on = false;
        frames.next(true);
        assert_eq!((frames.in_cards(), frames.uncertainty.progress()), (Some(FEW), (0, 0)));
    }
}

//! Words against practice: the practice table, and the stretch that practice's volumes give in the tissue of each plan on the screen.
//!
//! `panel` (the rule in words, and the buttons of its table). This file contains the table, what is known of each plan, and the study behind it.

mod panel;

pub(crate) use panel::{rule, rule_in_short};

use crate::app::frame::studies::{Driver, Studies};
use crate::app::plan::device::Device;
use crate::app::texts::tr;
use crate::clinical::{PracticeTable, PracticeVolume};
use crate::measure::bands::{self, PracticeStretch, SkinLimits};
use crate::scene::Scene;
use crate::study::{
    Cases, NoPractice, Practice, Study, evaluate, has_same_practice, practice_volume,
};

/// Greatest number of plans whose practice is kept.
const MOST: usize = 128;

/// What the stretch of a plan is compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Against {
    /// The strains of practice's volumes.
    Practice(PracticeStretch),
    /// Practice, whose volumes are being solved.
    Waiting,
    /// The limits of the skin by itself, and why; an expander has no practice.
    Skin(Option<NoPractice>),
}

impl Against {
    /// The strains of practice's volumes, once they are known.
    pub(crate) fn practice(self) -> Option<PracticeStretch> {
        match self {
            Self::Practice(practice) => Some(practice),
            Self::Waiting | Self::Skin(_) => None,
        }
    }

    /// The word of a strain \[-\] of a skin, which uses a share of its reserve \[-\]; `None` while practice is not known.
    pub(crate) fn word(self, strain: f64, reserve: Option<f64>) -> Option<&'static str> {
        let word = || tr(bands::stretch_by(self.practice(), strain, reserve).1);
        (self != Self::Waiting).then(word)
    }
}

/// The practice table and what is known of the plans.
#[derive(Default)]
pub(crate) struct Practices {
    table: PracticeTable,
    /// Number of changes of the table.
    revision: u64,
    /// Number of changes of what is known.
    changes: u64,
    device: Device,
    /// The plans with what practice's volumes give in their tissue, the oldest first.
    known: Vec<(Scene, Result<PracticeStretch, NoPractice>)>,
    search: Driver<Practice>,
    /// The plan of the search.
    searched: Option<Scene>,
    /// The strains that were found last, for the colours of a plan whose own are not known yet.
    last: Option<PracticeStretch>,
}

impl Practices {
    pub(crate) fn table(&self) -> &PracticeTable {
        &self.table
    }

    /// What is implanted in all plans.
    pub(crate) fn device(&self) -> Device {
        self.device
    }

    /// Replaces the table.
    pub(crate) fn set_table(&mut self, table: PracticeTable) {
        self.table = table;
        self.revision += 1;
        self.changes += 1;
        self.known.clear();
        self.searched = None;
    }

    /// Takes the table of a text. The present table stays if the text is none.
    ///
    /// # Errors
    /// One line with what is wrong.
    pub(crate) fn read(&mut self, text: &str) -> Result<(), String> {
        self.set_table(PracticeTable::from_csv(text)?);
        Ok(())
    }

    /// Number of changes of the table.
    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    /// Number of changes of what [`Self::against`] returns.
    pub(crate) fn changes(&self) -> u64 {
        self.changes
    }

    /// What the stretch of a plan is compared with.
    pub(crate) fn against(&self, plan: &Scene) -> Against {
        if self.device == Device::Expander {
            return Against::Skin(None);
        }
        let known = self.known.iter().rev().find(|(other, _)| has_same_practice(other, plan));
        match known {
            Some((_, Ok(practice))) => Against::Practice(*practice),
            Some((_, Err(reason))) => Against::Skin(Some(*reason)),
            None => Against::Waiting,
        }
    }

    /// The limits for the colours of a plan's skin. `knee`: strain at which its curve turns steep \[-\], if it has a reserve. While
    /// practice's volumes are being solved, those of the plan before.
    pub(crate) fn skin(&self, plan: &Scene, knee: Option<f64>) -> SkinLimits {
        let practice = match self.against(plan) {
            Against::Practice(practice) => Some(practice),
            Against::Waiting => self.last,
            Against::Skin(_) => None,
        };
        practice.map_or(SkinLimits::of_skin(knee), SkinLimits::Practice)
    }

    /// Are the words of [`Self::skin`] those of the plan? Before practice of any plan is known, the limits of the skin by itself stand for it.
    pub(crate) fn has_words(&self, plan: &Scene) -> bool {
        self.last.is_some() || self.against(plan) != Against::Waiting
    }

    /// The volume that practice takes for a plan, with its parts; `None` for a plan that is not compared with practice.
    pub(crate) fn volume(&self, plan: &Scene) -> Option<PracticeVolume> {
        if matches!(self.against(plan), Against::Skin(_)) {
            return None;
        }
        practice_volume(plan, &self.table)
    }

    /// The plans of practice's least and greatest volume in the tissue of a plan that is compared with practice.
    pub(crate) fn least_and_greatest(&self, plan: &Scene) -> Option<[Scene; 2]> {
        let practice = self.against(plan).practice().and(Practice::new(plan, &self.table).ok())?;
        let [less, _, more] = practice.scenes();
        Some([less.clone(), more.clone()])
    }

    /// The second one of [`Self::least_and_greatest`].
    pub(crate) fn greatest(&self, plan: &Scene) -> Option<Scene> {
        self.least_and_greatest(plan).map(|[_, greatest]| greatest)
    }

    /// Solves practice's volumes for the `wanted` plans, the first unknown one first, once a frame. `is_busy`: a plan is being edited
    /// or solved, and no search starts.
    pub(crate) fn advance(
        &mut self,
        wanted: &[&Scene],
        device: Device,
        studies: &mut Studies,
        is_busy: bool,
    ) {
        if self.device != device {
            self.device = device;
            self.changes += 1;
        }
        let next = wanted.iter().find(|plan| self.against(plan) == Against::Waiting);
        let is_searched = |plan: &Scene| {
            self.searched.as_ref().is_some_and(|searched| has_same_practice(searched, plan))
        };
        match next {
            Some(plan) if !is_searched(plan) => {
                self.searched = None;
                self.search.cancel(studies);
                if is_busy {
                    return;
                }
                match Practice::new(plan, &self.table) {
                    Ok(practice) => {
                        self.searched = Some((*plan).clone());
                        self.search.start(practice, studies);
                    }
                    Err(reason) => {
                        self.note((*plan).clone(), Err(reason));
                        studies.request_frame();
                    }
                }
            }
            Some(_) => {}
            None if self.searched.take().is_some() => self.search.cancel(studies),
            None => {}
        }
        self.search.advance(studies);
        let found = self.search.study().map(Practice::stretch);
        let found = match found {
            Some(Ok(practice)) => Ok(practice),
            Some(Err(Some(reason))) => Err(reason),
            Some(Err(None)) | None => return,
        };
        if let Some(plan) = self.searched.take() {
            self.search.cancel(studies);
            self.note(plan, found);
            // Further plans, and what shows this one.
            studies.request_frame();
        }
    }

    /// Solves practice's volumes for a plan at once, if they are not known: a report does not wait for frames.
    pub(crate) fn know(&mut self, plan: &Scene) {
        if self.against(plan) != Against::Waiting {
            return;
        }
        let found = Practice::new(plan, &self.table).and_then(|mut practice| {
            let mut store = Cases::default();
            while let Some((index, job)) = practice.next_job(&mut store) {
                practice.receive(index, evaluate(&job), &mut store);
            }
            practice.stretch().map_err(|reason| reason.unwrap_or(NoPractice::Volume))
        });
        self.note(plan.clone(), found);
    }

    fn note(&mut self, plan: Scene, found: Result<PracticeStretch, NoPractice>) {
        self.changes += 1;
        self.last = found.ok().or(self.last);
        self.known.push((plan, found));
        if self.known.len() > MOST {
            drop(self.known.remove(0));
        }
    }

    /// Practice as known, for tests of words.
    #[cfg(test)]
    pub(crate) fn of_known(plan: Scene, found: Result<PracticeStretch, NoPractice>) -> Self {
        let mut practices = Self::default();
        practices.note(plan, found);
        practices
    }
}

//! What the cards would say of each size in stock for the present patient, beside the list of sizes while that is in sight.

use super::{Sizes, readout, with_size};
use crate::app::answer::band_color;
use crate::app::answer::practice::{Against, Practices};
use crate::app::frame::studies::{Driver, Studies};
use crate::app::texts::tr;
use crate::scene::Scene;
use crate::study::{Case, Each, MapSettings, Quantity};
use eframe::egui::{RichText, Ui};

/// The three cards, in their order.
const CARDS: [Quantity; 3] =
    [Quantity::GreatestStrain, Quantity::LeastCoverMm, Quantity::GreatestPressureMmhg];

/// The study of all sizes in stock.
#[derive(Default)]
pub(super) struct ShelfVerdicts {
    /// Is the list in sight?
    is_listed: bool,
    each: Driver<Each>,
    /// The plan and the revision of the shelf to which the study belongs.
    started: Option<(Scene, u64)>,
    /// The plans of the sizes, in the order of the list, or why there is none.
    plans: Vec<Result<Scene, String>>,
    /// What the stretches of the plans are compared with, and the number of changes of practice to which that belongs.
    against: Vec<Against>,
    changes: Option<u64>,
}

impl ShelfVerdicts {
    /// The list is in sight in this frame.
    pub(super) fn list(&mut self) {
        self.is_listed = true;
    }

    /// Starts and continues the study, once a frame; a list out of sight costs nothing. `is_busy`: the plan is being solved or edited.
    pub(super) fn advance(
        &mut self,
        scene: &Scene,
        sizes: &Sizes,
        practices: &Practices,
        studies: &mut Studies,
        is_busy: bool,
    ) {
        if !std::mem::take(&mut self.is_listed) {
            if self.each.is_running() {
                *self = Self { each: std::mem::take(&mut self.each), ..Self::default() };
                self.each.cancel(studies);
            }
            return;
        }
        let is_started = |(of, revision): &(Scene, u64)| of == scene && *revision == sizes.revision;
        if !is_busy && !self.started.as_ref().is_some_and(is_started) {
            self.started = Some((scene.clone(), sizes.revision));
            let mut base = Scene { insertion: 1.0, ..scene.clone() };
            MapSettings::default().apply(&mut base);
            self.plans = sizes.shelf.sizes().iter().map(|size| with_size(&base, size)).collect();
            self.changes = None;
            self.each.start(Each::new(self.plans.clone()), studies);
        }
        if self.changes != Some(practices.changes()) {
            self.changes = Some(practices.changes());
            let against = |plan: &Result<Scene, String>| {
                plan.as_ref().map_or(Against::Skin(None), |plan| practices.against(plan))
            };
            self.against = self.plans.iter().map(against).collect();
        }
        self.each.advance(studies);
    }

    /// The plan whose practice is wanted next; sizes of one breast have the same.
    pub(super) fn wanted(&self) -> Option<&Scene> {
        let waiting = self.against.iter().position(|against| *against == Against::Waiting)?;
        self.plans.get(waiting)?.as_ref().ok()
    }

    /// Shows the worst of the three cards of a size, all three under the pointer.
    pub(super) fn cell(&self, ui: &mut Ui, index: usize) {
        let case = self.each.study().and_then(|each| each.case(index));
        let against = self.against.get(index).filter(|against| **against != Against::Waiting);
        let Some((case, against)) = case.zip(against) else {
            ui.weak("…");
            return;
        };
        let value = |quantity| case.values.get(quantity).map(|value| (value, true));
        let worst = readout::worst(against.practice(), &value).filter(|_| case.is_converged());
        let Some(worst) = worst else {
            ui.colored_label(band_color(ui, 1), tr("no answer"));
            return;
        };
        let words = RichText::new(worst.words).color(band_color(ui, worst.level));
        ui.label(words).on_hover_text(figures(case));
    }
}

/// The figures of the three cards, a line each.
fn figures(case: &Case) -> String {
    let line = |quantity: Quantity| {
        let value = case.values.get(quantity)?;
        Some(format!("{}: {}", tr(quantity.title()), readout::text(quantity, value)))
    };
    CARDS.into_iter().filter_map(line).collect::<Vec<_>>().join("\n")
}

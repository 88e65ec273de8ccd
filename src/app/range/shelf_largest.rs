//! The largest size of the clinic's shelf that stays usual for the present patient, by name. Sizes wider than the breast do not
//! count: the base as measured, else the width of the plan.

use crate::app::answer::practice::{Against, Practices};
use crate::app::frame::action::Action;
use crate::app::frame::studies::{Driver, Studies};
use crate::app::range::{Sizes, take_size, width_in_words, with_size};
use crate::app::texts::{self, tr};
use crate::app::widgets::remark;
use crate::clinical::ShelfSize;
use crate::scene::Scene;
use crate::study::{FirstUsual, MapSettings, breast_width_mm, size_in_words};
use eframe::egui::{Link, RichText, Ui};

/// Width above that of the breast that still counts as its width \[mm\].
const ROUNDING_MM: f64 = 0.5;

/// The study of the shelf's sizes.
#[derive(Default)]
pub(crate) struct ShelfLargest {
    search: Driver<FirstUsual>,
    /// The plan and the revision of the shelf to which the search belongs.
    started: Option<(Scene, u64)>,
    /// Sizes and plans of the search, in its order.
    sizes: Vec<ShelfSize>,
    scenes: Vec<Scene>,
    /// What the stretches of the plans are compared with.
    against: Vec<Against>,
    /// Number of changes of practice to which that belongs.
    changes: Option<u64>,
}

impl ShelfLargest {
    /// Starts and continues the study, once a frame. `is_busy`: the plan is being solved or edited.
    pub(crate) fn advance(
        &mut self,
        scene: &Scene,
        sizes: &Sizes,
        practices: &Practices,
        studies: &mut Studies,
        is_busy: bool,
    ) {
        let is_started = |(of, revision): &(Scene, u64)| of == scene && *revision == sizes.revision;
        if !is_busy && !self.started.as_ref().is_some_and(is_started) {
            self.started = Some((scene.clone(), sizes.revision));
            self.restart(scene, sizes, studies);
        }
        if self.changes.replace(practices.changes()) != Some(practices.changes()) {
            self.compare(practices, studies);
        }
        self.search.advance(studies);
    }

    /// Starts the search, unless that is in the same plans.
    fn restart(&mut self, scene: &Scene, sizes: &Sizes, studies: &mut Studies) {
        let width = breast_width_mm(scene) + ROUNDING_MM;
        let mut fitting: Vec<&ShelfSize> = sizes.shelf.sizes().iter().collect();
        fitting.retain(|size| size.width_mm() <= width);
        fitting.sort_by(|a, b| b.volume_ml().total_cmp(&a.volume_ml()));
        let mut base = Scene { insertion: 1.0, ..scene.clone() };
        MapSettings::default().apply(&mut base);
        let plan = |size: &ShelfSize| Some((size.clone(), with_size(&base, size).ok()?));
        let (fitting, scenes): (Vec<ShelfSize>, Vec<Scene>) =
            fitting.into_iter().filter_map(plan).unzip();
        if (&fitting, &scenes) == (&self.sizes, &self.scenes) {
            return;
        }
        self.search.cancel(studies);
        (self.sizes, self.scenes) = (fitting, scenes);
        (self.against, self.changes) = (Vec::new(), None);
    }

    /// Starts the search once practice of all plans is known.
    fn compare(&mut self, practices: &Practices, studies: &mut Studies) {
        let against: Vec<Against> =
            self.scenes.iter().map(|plan| practices.against(plan)).collect();
        if against == self.against {
            return;
        }
        self.against = against;
        self.search.cancel(studies);
        if !self.against.contains(&Against::Waiting) {
            let practice = self.against.iter().map(|against| against.practice());
            let plans = self.scenes.iter().cloned().zip(practice).collect();
            self.search.start(FirstUsual::new(plans), studies);
        }
    }

    /// The plans whose practice is wanted: none once all of it is known.
    pub(crate) fn wanted(&self) -> &[Scene] {
        if self.against.contains(&Against::Waiting) { &self.scenes } else { &[] }
    }

    /// Shows the largest size in a sentence, which is a link that takes the size; nothing while that is not known or without a shelf.
    pub(crate) fn show(&self, ui: &mut Ui, scene: &Scene, actions: &mut Vec<Action>) {
        let Some((search, (plan, _))) = self.search.finished().zip(self.started.as_ref()) else {
            return;
        };
        let largest = search.found().and_then(|k| self.sizes.get(k).zip(self.scenes.get(k)));
        let is_practice = self.against.iter().all(|against| against.practice().is_some());
        let words = words(breast_width_mm(plan), largest, is_practice);
        let response = match largest {
            Some(_) => ui.add(Link::new(RichText::new(words).small())),
            None => remark(ui, words),
        };
        if let Some((size, _)) = largest.filter(|_| response.clicked()) {
            take_size(size, scene, actions);
        }
        response.on_hover_text(tr(
            "No word of the cards is above usual for this size, this patient and this margin of the pocket; no larger size of \
             the shelf up to this width stays usual. A quick, coarse computation.",
        ));
    }
}

/// The largest size up to a width \[mm\] with its plan, in a sentence.
fn words(width_mm: f64, largest: Option<(&ShelfSize, &Scene)>, is_practice: bool) -> String {
    let width = width_in_words(width_mm);
    let Some((size, plan)) = largest else {
        return if is_practice {
            tr!("No size in stock up to {width} has practice's stretch or less.", width)
        } else {
            tr!("No size in stock up to {width} stays usual.", width)
        };
    };
    let (name, size) = (size.label(), texts::shown(&size_in_words(plan)));
    if is_practice {
        tr!(
            "Largest in stock up to {width} within practice's stretch: {name} ({size}).",
            width,
            name,
            size
        )
    } else {
        tr!("Largest in stock up to {width} that stays usual: {name} ({size}).", width, name, size)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clinical::Shelf;

    #[test]
    fn the_sentence_says_up_to_which_width() {
        let shelf = Shelf::from_csv("name;width_mm;volume_ml\nSR-275H;110;275").unwrap();
        let size = &shelf.sizes()[0];
        let plan = with_size(&Scene::opening(), size).unwrap();
        let largest = Some((size, &plan));
        assert_eq!(
            [(largest, true), (largest, false), (None, true), (None, false)]
                .map(|(largest, is_practice)| words(120.0, largest, is_practice)),
            [
                "Largest in stock up to 12 cm within practice's stretch: SR-275H · 275 cc (275 ml on 11 cm).",
                "Largest in stock up to 12 cm that stays usual: SR-275H · 275 cc (275 ml on 11 cm).",
                "No size in stock up to 12 cm has practice's stretch or less.",
                "No size in stock up to 12 cm stays usual.",
            ]
        );
    }

    /// As the switch to an anatomical implant has it: no maker's implant of a height of its own has its apex in the middle.
    #[test]
    fn a_size_with_a_height_has_the_usual_apex_and_a_round_one_none() {
        let shelf = "name;width_mm;height_mm;projection_mm\nSA;120;108;45\nSR;120;120;45";
        let shelf = Shelf::from_csv(shelf).unwrap();
        let of = |size: &ShelfSize| with_size(&Scene::opening(), size).unwrap().implant;
        let implants: Vec<_> = shelf.sizes().iter().map(of).collect();
        let found = implants.iter().map(|of| (of.base_height_mm, of.apex_shift_mm));
        assert_eq!(found.collect::<Vec<_>>(), [(Some(108.0), 11.0), (None, 0.0)]);
    }
}

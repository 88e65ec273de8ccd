//! The largest size of the clinic's shelf that stays usual for the present patient, by name. Sizes wider than the plan do not
//! count: the width is that of the breast.

use super::practice::{Against, Practices};
use super::range::{Sizes, with_size};
use super::studies::{Driver, Studies};
use super::texts::{self, tr};
use crate::clinical::ShelfSize;
use crate::scene::Scene;
use crate::study::{FirstUsual, MapSettings, size_in_words};

/// Width above that of the plan that still counts as its width \[mm\].
const ROUNDING_MM: f64 = 0.5;

/// The study of the shelf's sizes.
#[derive(Default)]
pub(super) struct ShelfLargest {
    search: Driver<FirstUsual>,
    /// The plan and the revision of the shelf to which the search belongs.
    started: Option<(Scene, u64)>,
    /// Names and plans of the search, in its order.
    names: Vec<String>,
    scenes: Vec<Scene>,
    /// What the stretches of the plans are compared with.
    against: Vec<Against>,
    /// Number of changes of practice to which that belongs.
    changes: Option<u64>,
}

impl ShelfLargest {
    /// Starts and continues the study, once a frame. `is_busy`: the plan is being solved or edited.
    pub(super) fn advance(
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
        let width = 2.0 * scene.implant.base_radius_mm + ROUNDING_MM;
        let mut fitting: Vec<&ShelfSize> = sizes.shelf.sizes().iter().collect();
        fitting.retain(|size| size.width_mm() <= width);
        fitting.sort_by(|a, b| b.volume_ml().total_cmp(&a.volume_ml()));
        let mut base = Scene { insertion: 1.0, ..scene.clone() };
        MapSettings::default().apply(&mut base);
        let plan = |size: &ShelfSize| Some((size.label().to_owned(), with_size(&base, size).ok()?));
        let (names, scenes): (Vec<String>, Vec<Scene>) =
            fitting.into_iter().filter_map(plan).unzip();
        if (&names, &scenes) == (&self.names, &self.scenes) {
            return;
        }
        self.search.cancel(studies);
        (self.names, self.scenes) = (names, scenes);
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
    pub(super) fn wanted(&self) -> &[Scene] {
        if self.against.contains(&Against::Waiting) { &self.scenes } else { &[] }
    }

    /// The name of the size with its numbers, in words; empty while that is not known or without a shelf.
    pub(super) fn words(&self) -> String {
        let Some(search) = self.search.finished() else {
            return String::new();
        };
        let is_practice = self.against.iter().all(|against| against.practice().is_some());
        match search.found() {
            Some(k) => {
                let size = self
                    .scenes
                    .get(k)
                    .map(|scene| texts::shown(&size_in_words(scene)))
                    .unwrap_or_default();
                let name = self.names.get(k).map_or("", String::as_str);
                match is_practice {
                    true => tr!(
                        "Largest of the shelf with practice's stretch: {name} ({size}).",
                        name,
                        size
                    ),
                    false => {
                        tr!("Largest of the shelf that stays usual: {name} ({size}).", name, size)
                    }
                }
            }
            None if is_practice => {
                tr("No size of the shelf up to this width has practice's stretch or less.")
                    .to_owned()
            }
            None => tr("No size of the shelf up to this width stays usual.").to_owned(),
        }
    }
}

//! The largest size of the clinic's shelf that stays usual for the present patient, by name. Sizes wider than the plan do not
//! count: the width is that of the breast.

use super::range::{Sizes, with_size};
use super::studies::{Driver, Studies};
use super::texts::{self, tr};
use crate::clinical::ShelfSize;
use crate::scene::Scene;
use crate::study::{FirstUsual, size_in_words};

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
}

impl ShelfLargest {
    /// Starts and continues the study, once a frame. `is_busy`: the plan is being solved or edited.
    pub(super) fn advance(
        &mut self,
        scene: &Scene,
        sizes: &Sizes,
        studies: &mut Studies,
        is_busy: bool,
    ) {
        let is_started = |(of, revision): &(Scene, u64)| of == scene && *revision == sizes.revision;
        if !is_busy && !self.started.as_ref().is_some_and(is_started) {
            self.started = Some((scene.clone(), sizes.revision));
            self.restart(scene, sizes, studies);
        }
        self.search.advance(studies);
    }

    /// Starts the search, unless that is in the same plans.
    fn restart(&mut self, scene: &Scene, sizes: &Sizes, studies: &mut Studies) {
        let width = 2.0 * scene.implant.base_radius_mm + ROUNDING_MM;
        let mut fitting: Vec<&ShelfSize> = sizes.shelf.sizes().iter().collect();
        fitting.retain(|size| size.width_mm() <= width);
        fitting.sort_by(|a, b| b.volume_ml().total_cmp(&a.volume_ml()));
        let base = Scene { insertion: 1.0, ..scene.clone() };
        let plan = |size: &ShelfSize| Some((size.label().to_owned(), with_size(&base, size).ok()?));
        let (names, scenes): (Vec<String>, Vec<Scene>) =
            fitting.into_iter().filter_map(plan).unzip();
        if (&names, &scenes) == (&self.names, &self.scenes) {
            return;
        }
        if scenes.is_empty() {
            self.search.cancel(studies);
        } else {
            self.search.start(FirstUsual::new(scenes.clone()), studies);
        }
        (self.names, self.scenes) = (names, scenes);
    }

    /// The name of the size with its numbers, in words; empty while that is not known or without a shelf.
    pub(super) fn words(&self) -> String {
        let Some(search) = self.search.finished() else {
            return String::new();
        };
        match search.found() {
            Some(k) => {
                let size = self
                    .scenes
                    .get(k)
                    .map(|scene| texts::shown(&size_in_words(scene)))
                    .unwrap_or_default();
                let name = self.names.get(k).map_or("", String::as_str);
                tr!("Largest of the shelf that stays usual: {name} ({size}).", name, size)
            }
            None => tr("No size of the shelf up to this width stays usual.").to_owned(),
        }
    }
}

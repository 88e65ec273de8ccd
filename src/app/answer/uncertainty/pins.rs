//! The samples of the pins: one study after the other, beside that of the present plan.

use crate::app::frame::studies::{Driver, Studies};
use crate::scene::Scene;
use crate::session::{Pin, Session};
use crate::study::{Bands, BandsSettings, Samples, has_same_patients};

/// The sampled values of the pins.
#[derive(Default)]
pub(super) struct PinSamples {
    /// Finished studies of pinned scenes; the values are empty if the study could not start.
    done: Vec<(Subject, Samples)>,
    /// The study in progress.
    subject: Option<Subject>,
    driver: Driver<Bands>,
}

/// A pinned scene and the choices of its study.
type Subject = (Scene, BandsSettings);

impl PinSamples {
    /// Continues the study of a pin, or starts that of the next one if `is_free`; once a frame. `choose` gives the choices
    /// for a scene.
    pub(super) fn advance(
        &mut self,
        session: &Session,
        choose: impl Fn(&Scene) -> BandsSettings,
        studies: &mut Studies,
        is_free: bool,
    ) {
        // The importance of the unknowns is that of the present plan.
        let settings = |scene: &Scene| BandsSettings { importance_rows: 0, ..choose(scene) };
        let pins = || session.pins().iter().filter(|pin| pin.has_shape()).map(Pin::scene);
        let is_wanted =
            |(scene, by): &Subject| pins().any(|s| s == scene) && settings(scene) == *by;
        self.done.retain(|(subject, _)| is_wanted(subject));
        if self.subject.as_ref().is_some_and(|subject| !is_wanted(subject)) {
            self.cancel(studies);
        }
        if self.subject.is_none() && is_free {
            let next = pins().find(|scene| self.values(scene).is_none());
            self.subject = next.map(|scene| (scene.clone(), settings(scene)));
            if let Some((scene, settings)) = &self.subject
                && let Ok(bands) = Bands::new(scene, settings.clone())
            {
                self.driver.start(bands, studies);
            }
        }
        self.driver.advance(studies);
        if !self.driver.is_running()
            && let Some(subject) = self.subject.take()
        {
            let values = self.driver.study().map(Bands::values).unwrap_or_default();
            self.done.push((subject, values));
            self.driver.cancel(studies);
        }
    }

    /// Cancels the study in progress; finished ones stay.
    pub(super) fn cancel(&mut self, studies: &mut Studies) {
        self.driver.cancel(studies);
        self.subject = None;
    }

    /// The values of a pinned scene.
    pub(super) fn values(&self, scene: &Scene) -> Option<&Samples> {
        self.done
            .iter()
            .find(|((pinned, _), _)| has_same_patients(pinned, scene))
            .map(|(_, values)| values)
    }
}

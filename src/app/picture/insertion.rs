//! The push of the implant into its place, to be watched: a few shapes are solved once, on a grid of their own, and played in two
//! seconds. Plan, history and answer stay as they are.
//!
//! Uses `session`. Used by `logic`, `strip`, `ui`.

use crate::measure::Fields;
use crate::scene::Scene;
use crate::session::{Command, Session};
use crate::view::subject::Between;
use std::rc::Rc;

/// Number of steps from flat to in place; between two of them the picture is interpolated.
const STEPS: usize = 10;
/// Duration of the playback \[s\].
const SECONDS: f32 = 2.0;
/// Greatest number of nodes per side of the shapes: all of them are solved within a second.
const NODES: usize = 65;
/// Numbers of the shapes start here, beyond those of any session.
const REVISIONS: u64 = 1 << 48;

/// A shape of the push has no answer.
#[derive(Debug)]
pub(crate) struct NoAnswer;

/// The insertion at the end of the push of a plan \[-\].
fn last_of(scene: &Scene) -> f64 {
    if scene.insertion > 0.0 { scene.insertion } else { 1.0 }
}

/// The playback of the insertion.
#[derive(Default)]
pub(crate) struct Insertion {
    /// The plan of the shapes.
    plan: Option<Scene>,
    /// Solves the shapes that are missing.
    session: Option<Session>,
    /// The shapes so far, from flat on.
    shapes: Vec<Rc<Fields>>,
    is_playing: bool,
    /// Time since the start of the playback \[s\].
    time: f32,
    /// Number of the shape of this frame.
    revision: u64,
}

impl Insertion {
    /// Is the push being solved or played?
    pub(crate) fn is_playing(&self) -> bool {
        self.is_playing
    }

    /// Are shapes of the push being solved?
    pub(crate) fn is_solving(&self) -> bool {
        self.is_playing && self.shapes.len() <= STEPS
    }

    /// Stops the playback.
    pub(crate) fn stop(&mut self) {
        self.is_playing = false;
    }

    /// Starts the playback of a plan from flat on, or stops it.
    pub(crate) fn toggle(&mut self, scene: &Scene) {
        self.is_playing = !self.is_playing;
        self.time = 0.0;
        if self.is_playing && self.plan.as_ref() != Some(scene) {
            (self.session, self.shapes, self.plan) = (None, Vec::new(), Some(scene.clone()));
        }
    }

    /// Advances the playback of a plan by a frame; another plan ends it. `pause` ends a slice of solving.
    ///
    /// # Errors
    /// Returns [`NoAnswer`], after which nothing is played, if a shape has no answer.
    pub(crate) fn advance(
        &mut self,
        scene: &Scene,
        seconds: f32,
        pause: &mut dyn FnMut() -> bool,
    ) -> Result<(), NoAnswer> {
        self.is_playing &= self.plan.as_ref() == Some(scene);
        if !self.is_playing {
            return Ok(());
        }
        self.revision += 1;
        if self.is_solving() {
            self.is_playing = self.solve(scene, pause);
            return if self.is_playing { Ok(()) } else { Err(NoAnswer) };
        }
        self.time += seconds;
        self.is_playing = self.time < SECONDS;
        Ok(())
    }

    /// Solves a slice of the missing shapes. Returns `false` if a shape has no answer.
    fn solve(&mut self, scene: &Scene, pause: &mut dyn FnMut() -> bool) -> bool {
        let step = |step: usize| {
            let mut scene = scene.clone();
            scene.insertion = last_of(&scene) * step as f64 / STEPS as f64;
            scene.solver.nodes_per_side = scene.solver.nodes_per_side.min(NODES);
            scene
        };
        let session = match &mut self.session {
            Some(session) => session,
            None => match Session::new(step(0)) {
                Ok(session) => self.session.insert(session),
                Err(_) => return false,
            },
        };
        while self.shapes.len() <= STEPS {
            session.advance(pause);
            if session.is_working() {
                return true;
            }
            if session.has_no_shape() {
                return false;
            }
            self.shapes.push(Rc::clone(session.fields()));
            let next = Command::Edit {
                scene: Box::new(step(self.shapes.len().min(STEPS))),
                gesture: self.shapes.len() as u64,
            };
            if session.apply(next).is_err() {
                return false;
            }
        }
        self.session = None;
        true
    }

    /// The insertion of the shape of this frame in whole percent; `None` without one.
    pub(crate) fn percent(&self) -> Option<f64> {
        let Between { scene, .. } = self.shown()?;
        Some((100.0 * last_of(scene) * f64::from(self.time / SECONDS)).round())
    }

    /// The shape of this frame; `None` while the shapes are being solved and without a playback.
    pub(crate) fn shown(&self) -> Option<Between<'_>> {
        let is_played = self.is_playing && self.shapes.len() > STEPS;
        let scene = self.plan.as_ref().filter(|_| is_played)?;
        let at = (self.time / SECONDS).min(1.0) * STEPS as f32;
        let before = (at as usize).min(STEPS - 1);
        let [from, to] = [self.shapes.get(before)?, self.shapes.get(before + 1)?];
        let revision = REVISIONS + self.revision;
        Some(Between { scene, from, to, part: at - before as f32, revision })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::view::subject::Subject as _;

    #[test]
    fn the_push_rises_from_flat_to_the_place_in_two_seconds_and_another_plan_ends_it() {
        let mut scene = Scene::opening();
        (scene.solver.nodes_per_side, scene.solver.tolerance) = (33, 1e-3);
        let mut insertion = Insertion::default();
        insertion.toggle(&scene);
        while insertion.shown().is_none() {
            assert!(insertion.is_solving() && insertion.percent().is_none());
            insertion.advance(&scene, 0.1, &mut || false).unwrap();
        }
        assert!(!insertion.is_solving());
        let height = |between: &Between<'_>| {
            let apex = |fields: &Rc<Fields>| {
                let shape = fields.solution().inner();
                shape.iter().map(|p| p.z as f32).fold(0.0, f32::max)
            };
            let (to, part) = between.toward().unwrap();
            apex(between.fields()) * (1.0 - part) + apex(to) * part
        };
        let mut heights = vec![height(&insertion.shown().unwrap())];
        let (mut frames, mut percents) = (0, vec![insertion.percent().unwrap()]);
        loop {
            insertion.advance(&scene, 0.05, &mut || false).unwrap();
            if !insertion.is_playing() {
                break;
            }
            heights.extend(insertion.shown().as_ref().map(height));
            percents.extend(insertion.percent());
            frames += 1;
        }
        assert_eq!((percents[0], percents.len()), (0.0, heights.len()));
        assert!(percents.windows(2).all(|pair| pair[0] < pair[1]), "{percents:?}");
        assert!(percents.iter().all(|p| p.fract() == 0.0 && *p <= 100.0), "{percents:?}");
        assert!((38..=41).contains(&frames), "{frames} frames of 0.05 s");
        assert!(heights.windows(2).all(|pair| pair[1] > pair[0]), "{heights:?}");
        assert!(
            heights[0] < 1.0 && *heights.last().unwrap() > 0.9 * scene.implant.projection_mm as f32
        );
        // Again without a solve; another plan stops it.
        insertion.toggle(&scene);
        insertion.advance(&scene, 0.1, &mut || false).unwrap();
        assert!(insertion.shown().is_some());
        scene.implant.projection_mm += 1.0;
        insertion.advance(&scene, 0.1, &mut || false).unwrap();
        assert!(!insertion.is_playing() && insertion.shown().is_none());
    }
}

//! The torso in place of the tissue, and the cameras before it.

use super::{Options, Viewport};
use crate::session::Session;
use crate::view::camera::{Camera, Standing, View};
use crate::view::torso::Torso;
use std::rc::Rc;

/// The camera of a standard pose before a torso.
pub(super) fn standing(torso: &Torso, aspect: f32, standing: Standing) -> Camera {
    let (ball, middle, azimuth) = torso.seen();
    Camera::standing(ball, aspect, standing).moved_to(middle).turned_by(azimuth)
}

impl Viewport {
    /// The torso, if these options draw it: uncut.
    pub(super) fn torso(&mut self, options: &Options) -> Option<Rc<Torso>> {
        if !options.has_torso() {
            return None;
        }
        if self.torso.is_none() {
            self.torso = Torso::new().map(Rc::new);
        }
        self.torso.clone()
    }

    /// Changes the options; with or without a torso from now on, the camera moves to its first view.
    pub(crate) fn change(
        &mut self,
        session: &Session,
        options: &mut Options,
        change: impl FnOnce(&mut Options),
    ) {
        let had_torso = options.has_torso();
        change(options);
        if options.has_torso() != had_torso {
            self.look(session, options, View::All);
        }
    }

    /// Moves the camera to a standard view, before a torso if these options draw it.
    pub(crate) fn look(&mut self, session: &Session, options: &Options, view: View) {
        let pose = match view {
            View::Front => Standing::Front,
            View::Side => Standing::Side,
            View::All => Standing::ThreeQuarter,
            View::Top => return self.fit(session, view),
        };
        let Some(torso) = self.torso(options) else { return self.fit(session, view) };
        self.camera = standing(&torso, self.aspect, pose);
        // A new aspect ratio restores the three-quarter view only.
        self.fitted = (view == View::All).then(|| self.ball_to_fit(session));
    }
}

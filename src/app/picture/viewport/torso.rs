//! The lines of a torso behind the tissue, and the camera that shows them.

use super::{Viewport, overlay};
use crate::session::Session;
use crate::view::camera::{Ball, View};
use crate::view::torso;
use eframe::egui::{Painter, Rect, Ui};

/// Radius of what the camera shows of a torso, relative to that of the tissue \[-\].
const ROOM: f32 = 2.0;

impl Viewport {
    /// Turns to the front of the torso, or back to the tissue.
    pub(crate) fn look_at_torso(&mut self, session: &Session, is_shown: bool) {
        if !is_shown {
            return self.fit(session, View::All);
        }
        let ball = self.ball_to_fit(session);
        let ball = Ball { radius_mm: ROOM * ball.radius_mm, ..ball };
        self.camera.fit(ball, self.aspect, View::Front);
        self.fitted = None;
    }

    /// Draws the lines; the tissue drawn later hides those behind it.
    pub(super) fn draw_torso(&self, ui: &Ui, painter: &Painter, area: Rect) {
        for line in torso::lines() {
            let points = line.iter().filter_map(|point| self.point(*point, area)).collect();
            overlay::torso(ui, painter, points);
        }
    }
}

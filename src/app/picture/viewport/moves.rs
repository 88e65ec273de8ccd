//! Movements of the camera by pointer, fingers and keys.

use super::Viewport;
use super::torso::{pose_of, standing};
use crate::app::widgets::arrow_keys;
use crate::view::camera::{Ball, Camera, Standing, View};
use crate::view::torso::Torso;
use eframe::egui::{self, Key, Modifiers, PointerButton, Pos2, Rect, Response, Ui};
use glam::Vec2;

/// Motion of the camera by an arrow key, as the length of a drag \[points\].
const KEY_ORBIT: f32 = 14.0;
/// Least distance of the eye from the tissue \[mm\].
const CLEARANCE_MM: f32 = 50.0;

impl Viewport {
    /// Fits the camera in its standard view to a new aspect ratio or body, unless the user has moved the camera. On paper it has a standard pose.
    pub(super) fn place_camera(
        &mut self,
        ball: Ball,
        aspect: f32,
        torso: Option<&Torso>,
        on_paper: Option<Standing>,
    ) {
        if !self.is_placed {
            self.fitted = Some((ball, self.fitted.map_or(View::All, |(_, view)| view)));
        }
        let is_other_body =
            torso.is_some_and(|torso| self.stood.replace(torso.seen()) != Some(torso.seen()));
        let reformed = !self.is_placed || (aspect - self.aspect).abs() > 1e-4 || is_other_body;
        if let Some((ball, view)) = self.fitted.filter(|_| reformed && !self.camera.is_easing()) {
            self.camera = match torso.zip(pose_of(view)) {
                Some((torso, pose)) => standing(torso, aspect, pose),
                None => {
                    let mut camera = Camera::new(ball, aspect);
                    camera.fit(ball, aspect, view);
                    // The end of the animation.
                    camera.ease(f32::INFINITY);
                    camera
                }
            };
        }
        (self.is_placed, self.aspect) = (true, aspect);
        if let Some(pose) = on_paper {
            self.camera = match torso {
                Some(torso) => standing(torso, aspect, pose),
                None => Camera::standing(ball, aspect, pose),
            };
        }
    }

    pub(super) fn move_camera(&mut self, ui: &Ui, response: &Response, area: Rect) -> bool {
        let seconds = ui.input(|i| i.stable_dt.min(0.1));
        let eased = self.camera.ease(seconds);
        let mut moved = false;
        if response.clicked() || response.drag_started() {
            ui.memory_mut(|memory| memory.request_focus(self.id.unwrap_or(response.id)));
        }
        let to_glam = |v: egui::Vec2| Vec2::new(v.x, v.y);
        let delta = to_glam(response.drag_delta());
        let (shift, touch) = ui.input(|i| (i.modifiers.shift, i.multi_touch()));
        if let Some(touch) = touch
            && area.contains(touch.center_pos)
        {
            let at = viewport_point(area, touch.center_pos);
            moved |= self.zoom(touch.zoom_delta, at);
            moved |= self.camera.pan(to_glam(touch.translation_delta), area.height());
        } else if response.dragged_by(PointerButton::Primary) && !shift {
            moved |= self.camera.drag(delta);
        } else if response.dragged() {
            moved |= self.camera.pan(delta, area.height());
        }
        if let Some(pointer) = response.hover_pos().filter(|_| response.hovered()) {
            let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
            let at = viewport_point(area, pointer);
            moved |= self.zoom((scroll * 0.003).exp() * pinch, at);
        }
        if response.has_focus() {
            ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrow_keys()));
            moved |= self.keys(ui);
        }
        if moved {
            let (radius, height) = self.surroundings();
            self.camera.keep_outside(radius, height);
            self.fitted = None;
        }
        moved || eased
    }

    /// Radius and height of a cylinder around the drawn tissue that the eye does not enter \[mm\].
    fn surroundings(&self) -> (f32, f32) {
        let pictures = self.panes.iter().map(|pane| &pane.picture).chain([&self.picture]);
        let (radius, height) = pictures.fold((0.0_f32, 0.0_f32), |(radius, height), picture| {
            (radius.max(picture.body.block_radius), height.max(picture.body.height()))
        });
        (radius + CLEARANCE_MM, height + CLEARANCE_MM)
    }

    /// Zooms to a point of the viewport, as near as the tissue allows. Returns whether the view changed.
    fn zoom(&mut self, factor: f32, at: Vec2) -> bool {
        let mut factor = factor;
        // Every frame under the pointer comes here, most of them with 1.
        if factor > 1.0 {
            let (radius, height) = self.surroundings();
            factor = self.camera.zoom_outside(factor, at, self.aspect, radius, height);
        }
        self.camera.zoom(factor, at, self.aspect)
    }

    /// Shift with arrow keys rotates the camera, plus and minus zoom.
    fn keys(&mut self, ui: &Ui) -> bool {
        let mut moved = false;
        ui.input_mut(|input| {
            for (key, x, y) in [
                (Key::ArrowLeft, 1.0, 0.0),
                (Key::ArrowRight, -1.0, 0.0),
                (Key::ArrowUp, 0.0, 1.0),
                (Key::ArrowDown, 0.0, -1.0),
            ] {
                let count = input.count_and_consume_key(Modifiers::SHIFT, key) as f32;
                moved |= count > 0.0 && self.camera.drag(count * KEY_ORBIT * Vec2::new(x, y));
            }
            for (key, factor) in
                [(Key::Plus, 1.15_f32), (Key::Equals, 1.15), (Key::Minus, 1.0 / 1.15)]
            {
                let count = input.count_and_consume_key(Modifiers::NONE, key);
                let factor = factor.powi(count as i32);
                moved |= self.zoom(factor, Vec2::ZERO);
            }
        });
        moved
    }
}

/// A position as coordinates of the area, −1 to 1, y up.
pub(super) fn viewport_point(area: Rect, at: Pos2) -> Vec2 {
    let x = 2.0 * (at.x - area.left()) / area.width() - 1.0;
    Vec2::new(x, 1.0 - 2.0 * (at.y - area.top()) / area.height())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{self, Scene};

    /// A torso of this width of the chest \[mm\].
    fn torso(chest_width_mm: f64) -> Torso {
        let mut scene = Scene::opening();
        scene.torso = Some(scene::Torso { chest_width_mm, ..scene::Torso::default() });
        Torso::of_torso(&scene.fitted_torso().unwrap().unwrap())
    }

    #[test]
    fn the_camera_follows_another_body_in_its_view_until_it_is_moved() {
        let (ball, aspect) = (Ball::from(80.0), 1.2);
        let [narrow, wide] = [240.0, 300.0].map(torso);
        let in_front = |torso| standing(torso, aspect, Standing::Front);
        assert_ne!(in_front(&narrow), in_front(&wide));
        let mut viewport = Viewport::new(None);
        viewport.fitted = Some((ball, View::Front));
        (viewport.is_placed, viewport.aspect) = (true, aspect);
        for torso in [&narrow, &wide, &narrow] {
            viewport.place_camera(ball, aspect, Some(torso), None);
            assert_eq!(viewport.camera, in_front(torso));
        }
        viewport.camera.drag(Vec2::new(30.0, 0.0));
        viewport.fitted = None;
        let moved = viewport.camera;
        viewport.place_camera(ball, aspect, Some(&wide), None);
        assert_eq!(viewport.camera, moved);
    }
}

//! The volume of a dome over the wall, and its height over a place of the wall.

use super::Dome;
use glam::DVec2;
use std::f64::consts::PI;

/// Steps of Simpson's rule over the height, even.
const SECTIONS: usize = 200;
/// Halvings of a height.
const HALVINGS: usize = 40;

impl Dome {
    /// Volume of the part over the wall \[mm³\].
    #[must_use]
    pub fn volume_over_wall(&self) -> f64 {
        if self.base_height >= 0.0 {
            return self.volume();
        }
        // The height by a square: sections near the apex of a flat-topped dome change as a root.
        let (top, least) = (self.projection(), -self.base_height);
        let section = |t: f64| {
            let height = top - (top - least).max(0.0) * t * t;
            let angle = (height / top).clamp(0.0, 1.0).acos();
            PI * self.shape.half_widths(angle).element_product() * 2.0 * t
        };
        let step = 1.0 / SECTIONS as f64;
        let weight = |k: usize| match k {
            0 | SECTIONS => 1.0,
            k if k % 2 == 1 => 4.0,
            _ => 2.0,
        };
        let sum: f64 = (0..=SECTIONS).map(|k| weight(k) * section(k as f64 * step)).sum();
        (top - least).max(0.0) * sum * step / 3.0
    }

    /// Height of the surface over a place of the wall \[mm\], zero beside the dome.
    pub(crate) fn height_over(&self, place: DVec2) -> f64 {
        let (draped, wall) = (self.draped::<f64>(), self.chest.height(place));
        let is_inside =
            |height: f64| draped.length_squared(place.extend(wall + height).to_array()) < 1.0;
        // First, as the top of a deformed shape is searched for.
        if !is_inside(0.0) {
            return 0.0;
        }
        let (mut inside, mut outside) = (0.0, self.base_height + self.shape.top());
        if outside <= 0.0 {
            return 0.0;
        }
        for _ in 0..HALVINGS {
            let height = 0.5 * (inside + outside);
            *(if is_inside(height) { &mut inside } else { &mut outside }) = height;
        }
        inside
    }
}

#[cfg(test)]
mod tests {
    use super::super::dome::tests::{anatomical, others};
    use super::*;
    use crate::contact::HalfBall;
    use glam::DVec3;

    #[test]
    fn the_volume_over_the_wall_is_that_of_a_cap_and_of_the_whole() {
        let cap = Dome::new(DVec2::ZERO, HalfBall::round(40.0, 40.0), 0.6);
        let closed = PI * 24.0_f64.powi(2) * (40.0 - 24.0 / 3.0);
        assert!((cap.volume_over_wall() / closed - 1.0).abs() < 1e-9);
        for dome in anatomical().into_iter().chain(others()) {
            let whole = Dome { base_height: -1e-9, ..dome.clone() };
            let ratio = whole.volume_over_wall() / dome.volume();
            assert!((ratio - 1.0).abs() < 1e-4, "{ratio}");
            let gone = Dome { base_height: -dome.projection(), ..dome };
            assert!(gone.volume_over_wall().abs() < 1e-9);
        }
    }

    #[test]
    fn the_height_over_a_place_leads_to_the_surface() {
        for dome in anatomical().into_iter().chain(others()) {
            for point in dome.circles(9, 16) {
                let DVec3 { x, y, z } = point;
                let place = DVec2::new(x, y);
                // Not below an overhang, nor at the rim.
                let height = z - dome.chest.height(place);
                if height > 0.2 * dome.projection() && dome.normal(point).z > 0.1 {
                    assert!((dome.height_over(place) - height).abs() < 1e-6);
                }
            }
            assert!(dome.height_over(dome.center + DVec2::new(200.0, 0.0)).abs() < 1e-12);
        }
    }
}

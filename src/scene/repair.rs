//! Makes a scene that an edit has made impossible possible again, and says what was moved.

use super::{Scene, limits};

/// What had to move so that the implant fits into its pocket.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Repair {
    /// The pocket was widened to this radius \[mm\].
    PocketWidened {
        /// The new pocket radius \[mm\].
        radius_mm: f64,
    },
    /// The implant was moved towards the pocket's centre: a pocket has a greatest radius.
    ImplantMovedInwards,
}

impl std::fmt::Display for Repair {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::PocketWidened { radius_mm } => write!(
                f,
                "The pocket was enlarged to a radius of {radius_mm:.1} mm to hold the implant: the \
                 tissue is stretched over a larger area."
            ),
            Self::ImplantMovedInwards => write!(
                f,
                "The implant was moved towards the pocket's centre: a pocket's radius is at most {} mm.",
                limits::POCKET_RADIUS_MAX_MM
            ),
        }
    }
}

impl Scene {
    /// The farthest that the implant's centre may lie from the pocket's centre \[mm\].
    #[must_use]
    pub fn room_mm(&self) -> f64 {
        (self.pocket_radius_mm - self.implant.base_radius_mm).max(0.0)
    }

    /// Moves what keeps the implant from fitting into its pocket: the implant where no pocket is large
    /// enough, else the pocket.
    pub fn repair(&mut self) -> Option<Repair> {
        let mut repair = None;
        let [x, y] = self.implant.center_mm;
        let room = limits::POCKET_RADIUS_MAX_MM - self.implant.base_radius_mm;
        let distance = x.hypot(y);
        if distance > room {
            let share = (room / distance) * (1.0 - 1e-12);
            self.implant.center_mm = [x * share, y * share];
            repair = Some(Repair::ImplantMovedInwards);
        }
        let [x, y] = self.implant.center_mm;
        let least = (self.implant.base_radius_mm + x.hypot(y)).min(limits::POCKET_RADIUS_MAX_MM);
        // A shift to the pocket's rim is allowed, and rounding with it.
        if self.pocket_radius_mm < least * (1.0 - 1e-9) {
            self.pocket_radius_mm = least;
            repair = Some(Repair::PocketWidened { radius_mm: least });
        }
        repair
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_that_fits_stays_as_it_is() {
        let mut scene = Scene::default();
        scene.implant.center_mm = [9.0, 12.0]; // 15 mm: at the pocket's rim
        let before = scene.clone();
        assert_eq!((scene.repair(), &scene), (None, &before));
    }

    #[test]
    fn a_larger_implant_widens_its_pocket_and_the_largest_pocket_moves_it() {
        let mut scene = Scene::default();
        scene.implant.base_radius_mm = 80.0;
        assert_eq!(scene.repair(), Some(Repair::PocketWidened { radius_mm: 80.0 }));
        scene.implant.base_radius_mm = 120.0;
        scene.implant.center_mm = [150.0, 0.0];
        scene.repair();
        assert!(scene.validate().is_ok() && scene.implant.center_mm[0] <= 80.0);
    }
}

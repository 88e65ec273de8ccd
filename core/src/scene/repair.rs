//! Repairs a scene whose implant does not fit into its pocket, or whose tissue does not fit onto its chest, after an edit, and
//! reports the change.

use super::{Body, Field, Implant, Scene, ThicknessGrid, field, limits};

/// The change that made the scene valid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Repair {
    /// The pocket was enlarged.
    PocketWidened {
        /// The new pocket radius \[mm\].
        radius_mm: f64,
    },
    /// The implant was moved towards the pocket's centre: the pocket has its greatest radius.
    ImplantMovedInwards,
    /// The chest was made flatter.
    ChestFlattened {
        /// The least radius of curvature \[mm\].
        radius_mm: f64,
    },
}

impl std::fmt::Display for Repair {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::PocketWidened { radius_mm } => write!(
                f,
                "The pocket was enlarged to a radius of {radius_mm:.1} mm to fit the implant; the tissue \
                 stretches over a larger area."
            ),
            Self::ImplantMovedInwards => write!(
                f,
                "The implant was moved towards the pocket's centre; the pocket's radius is at most {} mm.",
                limits::POCKET_RADIUS_MAX_MM
            ),
            Self::ChestFlattened { radius_mm } => write!(
                f,
                "The chest was made flatter, with a radius of {radius_mm:.0} mm, to carry the simulated tissue."
            ),
        }
    }
}

impl Scene {
    /// Greatest distance between the centres of implant and pocket \[mm\].
    #[must_use]
    pub fn room_mm(&self) -> f64 {
        (self.pocket_radius_mm - self.implant.greatest_half_axis_mm()).max(0.0)
    }

    /// Sets the pocket's radius \[mm\]. A patch of the default radius becomes the default patch of the new pocket; a
    /// patch of another radius stays.
    pub fn set_pocket_radius(&mut self, radius_mm: f64) {
        let [before, after] = [self.pocket_radius_mm, radius_mm].map(|it| self.default_patch(it));
        // An equal radius changes no bit of the scene.
        if self.has_default_patch() && before.to_bits() != after.to_bits() {
            self.body.patch_radius_mm = after;
        }
        self.pocket_radius_mm = radius_mm;
    }

    /// Has the patch the default radius, which follows the pocket?
    pub(crate) fn has_default_patch(&self) -> bool {
        (self.body.patch_radius_mm - self.default_patch(self.pocket_radius_mm)).abs() < 1e-9
    }

    /// Default radius of the patch around a pocket \[mm\], at most as far as the thickness of a body is known.
    fn default_patch(&self, pocket_radius_mm: f64) -> f64 {
        let around = Body::around(pocket_radius_mm, self.body.tissue_model).patch_radius_mm;
        around.min(self.thickness_field.as_ref().map_or(f64::INFINITY, ThicknessGrid::reach_mm))
    }

    /// Enlarges the patch to the least around the pocket.
    pub(crate) fn widen_patch(&mut self) {
        let (least, _) = Body::patch_range(self.pocket_reach_mm());
        self.body.patch_radius_mm = self.body.patch_radius_mm.max(least);
    }

    /// Makes the implant fit into its pocket: enlarges the pocket, or moves the implant where no pocket is large
    /// enough. Makes a chest flatter that is too curved for the tissue.
    pub fn repair(&mut self) -> Option<Repair> {
        let mut repair = None;
        // A round base has no height of its own to move.
        let Implant { base_height_mm, apex_shift_mm, .. } = self.implant;
        if base_height_mm.is_some() || apex_shift_mm != 0.0 {
            for number in [Field::BaseHeight, Field::ApexShift] {
                number.set(self, 0, number.value(self, 0).unwrap_or_default());
            }
        }
        let [x, y] = self.implant.center_mm;
        let room = limits::POCKET_RADIUS_MAX_MM - self.implant.greatest_half_axis_mm();
        let distance = x.hypot(y);
        if distance > room {
            let factor = (room / distance) * (1.0 - 1e-12);
            self.implant.center_mm = [x * factor, y * factor];
            repair = Some(Repair::ImplantMovedInwards);
        }
        let least = self.implant.least_pocket_mm().min(limits::POCKET_RADIUS_MAX_MM);
        // The implant may touch the pocket's rim; the bound allows for rounding.
        if self.pocket_radius_mm < least * (1.0 - 1e-9) {
            self.set_pocket_radius(least);
            repair = Some(Repair::PocketWidened { radius_mm: least });
        }
        self.widen_patch();
        for field in field::CHEST {
            let Some(radius) = field.value(self, 0) else {
                continue;
            };
            field.set(self, 0, radius);
            let is_new = |new: &f64| new.to_bits() != radius.to_bits();
            if let Some(radius_mm) = field.value(self, 0).filter(is_new) {
                repair = Some(Repair::ChestFlattened { radius_mm });
            }
        }
        repair
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_valid_scene_is_unchanged() {
        let mut scene = Scene::default();
        scene.implant.center_mm = [9.0, 12.0]; // 15 mm: at the pocket's rim
        let before = scene.clone();
        assert_eq!((scene.repair(), &scene), (None, &before));
    }

    #[test]
    fn a_larger_implant_enlarges_the_pocket_and_is_moved_inside_of_the_largest_pocket() {
        let mut scene = Scene::default();
        scene.implant.base_radius_mm = 80.0;
        assert_eq!(scene.repair(), Some(Repair::PocketWidened { radius_mm: 80.0 }));
        let patch = |scene: &Scene| scene.body.patch_radius_mm;
        assert!((patch(&scene) - 140.0).abs() < 1e-9);
        scene.implant.base_radius_mm = 120.0;
        scene.implant.center_mm = [150.0, 0.0];
        scene.repair();
        assert!(scene.validate().is_ok() && scene.implant.center_mm[0] <= 80.0);
        assert!((patch(&scene) - 260.0).abs() < 1e-9);
    }

    #[test]
    fn a_patch_of_the_default_radius_follows_the_pocket_and_another_patch_stays() {
        let mut scene = Scene::default();
        let patch = |scene: &Scene| scene.body.patch_radius_mm;
        for (pocket, wanted) in [(90.0, 150.0), (200.0, 260.0), (70.0, 130.0)] {
            scene.set_pocket_radius(pocket);
            assert!((patch(&scene) - wanted).abs() < 1e-9, "{pocket}: {}", patch(&scene));
        }
        scene.body.patch_radius_mm = 120.0;
        for pocket in [90.0, 65.0] {
            scene.set_pocket_radius(pocket);
            assert!((patch(&scene) - 120.0).abs() < 1e-9);
        }
        // A patch that is too small for the pocket is enlarged.
        scene.set_pocket_radius(110.0);
        assert_eq!((scene.repair(), patch(&scene)), (None, 130.0));
        // The tissue of a body is known up to an edge, which a patch passes only where the pocket needs it.
        let mut fitted = Scene::opening();
        let factors = vec![1.5; 65 * 65].into();
        fitted.thickness_field =
            Some(ThicknessGrid { spacing_mm: 4.0625, columns: 65, rows: 65, factors });
        for (pocket, wanted) in [(82.0, 130.0), (60.0, 120.0), (70.0, 130.0)] {
            fitted.set_pocket_radius(pocket);
            assert!(fitted.validate().is_ok(), "{pocket}");
            assert!((patch(&fitted) - wanted).abs() < 1e-9, "{pocket}: {}", patch(&fitted));
        }
        let mut sheet = Scene::sheet();
        sheet.set_pocket_radius(90.0);
        assert_eq!((sheet.pocket_radius_mm, patch(&sheet)), (90.0, 150.0));
    }
}

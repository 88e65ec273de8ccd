//! The chest wall of a scene: flat where the scene has none, otherwise curved by two radii.

use super::{Field, Plane, Scene, SceneError, field, out_of_range};
use crate::curve::number;
use crate::mesh::Chest;
use glam::DVec2;
use serde::Serialize;
use std::f64::consts::TAU;

/// The chest wall by its radii of curvature at the pocket's centre.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ChestShape {
    /// Radius across the body, along x \[mm\]; negative: hollow.
    pub radius_across_mm: f64,
    /// Radius along the body, along y \[mm\]; `None`: straight, negative: hollow.
    pub radius_along_mm: Option<f64>,
}

/// Least radius of curvature \[patch radii\]: the wall turns by 76° at most between the pocket's centre and the patch's edge,
/// below the 90° at which a height field ends.
const LEAST_OF_PATCH: f64 = 0.75;
/// Least radius of curvature \[distances of the implant's edge from the pocket's centre\]: the implant is draped over walls of at
/// most 65° of slope.
const LEAST_OF_IMPLANT: f64 = 1.1;
/// Least radius of a hollow \[thicknesses of the tissue\]: cells shrink outwards, to nothing where both are equal.
pub(super) const LEAST_OF_TISSUE: f64 = 2.0;

const BEYOND_POCKET: &str = "The base of the implant reaches beyond the pocket, whose radius is a length along the curved chest.";

impl ChestShape {
    /// The usual chest: its radius across the breasts, straight along the body.
    pub const USUAL: Self = Self { radius_across_mm: 140.0, radius_along_mm: None };
    /// A round (barrel) chest: more curved across the body, a little along it.
    pub const ROUND: Self = Self { radius_across_mm: 120.0, radius_along_mm: Some(600.0) };

    /// The radius across (0) or along the body (1) \[mm\].
    pub(super) fn radius(&self, axis: usize) -> Option<f64> {
        if axis == 0 { Some(self.radius_across_mm) } else { self.radius_along_mm }
    }

    /// The place of the radius across (0) or along the body (1).
    pub(super) fn place(&mut self, axis: usize) -> Option<&mut f64> {
        if axis == 0 { Some(&mut self.radius_across_mm) } else { self.radius_along_mm.as_mut() }
    }

    /// Sets a number of the chest \[mm\]; a straight chest becomes curved along the body.
    pub(crate) fn set(&mut self, field: Field, radius_mm: f64) {
        match field {
            Field::ChestAcross => self.radius_across_mm = radius_mm,
            Field::ChestAlong => self.radius_along_mm = Some(radius_mm),
            _ => {}
        }
    }

    /// Least radius of a hollow \[mm\]; infinite without one.
    pub(super) fn least_hollow_mm(&self) -> f64 {
        let radii = [Some(self.radius_across_mm), self.radius_along_mm].into_iter().flatten();
        radii.filter(|radius| *radius < 0.0).fold(f64::INFINITY, |a, b| a.min(-b))
    }

    fn wall(&self) -> Chest {
        let along_mm = self.radius_along_mm.unwrap_or(f64::INFINITY);
        Chest::Curved { across_mm: self.radius_across_mm, along_mm }
    }
}

impl Scene {
    /// The wall.
    pub(super) fn wall(&self) -> Chest {
        self.chest.as_ref().map_or(Chest::Flat, ChestShape::wall)
    }

    /// Sets the radii of the chest, `None` for a flat one, in place of radii, a torso, a grid, or the chest and the thickness of a fitted body.
    pub fn set_chest(&mut self, chest: Option<ChestShape>) {
        (self.chest, self.torso, self.chest_grid) = (chest, None, None);
        if self.placement.take().is_some() {
            self.thickness_field = None;
        }
    }

    /// Is the tissue at rest with the implant one of revolution about the pocket's centre: a centred round implant under
    /// even tissue on a flat or spherical chest?
    #[must_use]
    pub fn is_round(&self) -> bool {
        let is_centred = self.implant.center_mm.iter().all(|at| at.abs() <= 0.0);
        let is_even =
            self.torso.is_none() && self.chest_grid.is_none() && self.thickness_field.is_none();
        let is_turned = self.chest.is_none() || self.is_sphere();
        let is_skin_turned = self.body.skin_state.is_turned();
        let is_whole = self.body.plane.is_none_or(|plane| plane == Plane::Below);
        is_centred
            && is_whole
            && !self.is_lowered()
            && is_even
            && self.implant.is_round()
            && is_turned
            && is_skin_turned
    }

    /// Is the pocket's lower edge lowered?
    fn is_lowered(&self) -> bool {
        self.body.pocket_lowered_mm > 0.0
    }

    /// Is the chest a sphere?
    #[must_use]
    pub fn is_sphere(&self) -> bool {
        let is_equal = |chest: &ChestShape| chest.radius_along_mm == Some(chest.radius_across_mm);
        self.chest.as_ref().is_some_and(is_equal)
    }

    /// Least radius of curvature of the chest \[mm\], as a number outwards or hollow.
    #[must_use]
    pub fn least_chest_radius_mm(&self, is_hollow: bool) -> f64 {
        let edge = self.implant.least_pocket_mm();
        let least = (LEAST_OF_PATCH * self.patch_radius()).max(LEAST_OF_IMPLANT * edge);
        if is_hollow { least.max(LEAST_OF_TISSUE * self.tissue_mm()) } else { least }
    }

    /// Range of a number of the chest, of the sign of its value \[mm\].
    pub(super) fn chest_range(&self, field: Field) -> (f64, f64) {
        let is_hollow = field.value(self, 0).is_some_and(|radius| radius < 0.0);
        let (least, most) = (self.least_chest_radius_mm(is_hollow), Field::ChestAcross.limits.1);
        if is_hollow { (-most, -least) } else { (least, most) }
    }

    /// What a result says about a base beyond the pocket, whose radius is a length along the wall.
    pub(crate) fn pocket_warning(&self, wall: &Chest) -> Option<String> {
        const DIRECTIONS: usize = 64;
        let is_within_base = |k: usize| {
            let way = DVec2::from_angle(TAU * k as f64 / DIRECTIONS as f64);
            let (edge, _) = wall.foot_and_normal(way * self.pocket_radius_mm);
            self.implant.covers(edge.truncate())
        };
        let is_beyond = !matches!(wall, Chest::Flat) && (0..DIRECTIONS).any(is_within_base);
        is_beyond.then(|| BEYOND_POCKET.to_owned())
    }

    /// Checks that the scene may have a chest.
    pub(super) fn check_may_have_chest(&self) -> Result<(), SceneError> {
        if !self.is_layered() {
            let allowed = "no chest with tissue_model sheet, which is flat";
            return Err(out_of_range("chest", "curved".to_owned(), allowed));
        }
        Ok(())
    }

    /// Radius of the simulated tissue \[mm\].
    #[must_use]
    pub fn patch_radius(&self) -> f64 {
        self.body.patch_radius_mm
    }

    /// Thickness of all layers, where the solids have their own \[mm\].
    #[must_use]
    pub fn tissue_mm(&self) -> f64 {
        self.layers.iter().map(|layer| layer.thickness_mm).sum()
    }

    /// Checks the chest, and that the scene may have one.
    pub(super) fn check_chest(&self) -> Result<(), SceneError> {
        if self.chest.is_none() {
            return Ok(());
        }
        self.check_may_have_chest()?;
        for field in field::CHEST {
            let Some(radius) = field.value(self, 0) else {
                continue;
            };
            let (least, most) = self.chest_range(field);
            if !(least..=most).contains(&radius) {
                let [outwards, hollow] = [false, true].map(|is| self.least_chest_radius_mm(is));
                let up = |least: f64| number((10.0 * least).ceil() / 10.0);
                let (outwards, hollow, most) = (up(outwards), up(hollow), field.limits.1);
                let allowed = format!(
                    "{outwards} to {most} mm, hollow -{most} to -{hollow} mm (3/4 of patch_radius_mm, 1.1 of the implant's reach; hollow: twice the tissue)"
                );
                return Err(out_of_range(field.path, number(radius), &allowed));
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::TissueModel;

    fn scene(chest: &str) -> Result<Scene, SceneError> {
        let implant = r#""implant": { "base_radius_mm": 60, "projection_mm": 40 }"#;
        Scene::from_json(&format!("{{ {implant}, {chest} }}"))
    }

    #[test]
    fn a_base_beyond_the_pocket_along_the_wall_is_a_warning() {
        // The pocket's edge is 80 sin(60/80) = 54.5 mm, then 80 sin(68/80) = 60.1 mm from the axis.
        let warning = |pocket: f64| {
            let chest = r#""chest": { "radius_across_mm": 80, "radius_along_mm": 80 }"#;
            let scene =
                scene(&format!(r#""pocket_radius_mm": {pocket}, "patch_radius_mm": 106, {chest}"#));
            let scene = scene.unwrap();
            scene.pocket_warning(&scene.wall())
        };
        assert_eq!(warning(60.0).as_deref(), Some(BEYOND_POCKET));
        assert_eq!(warning(68.0), None);
        let opening = Scene::opening();
        assert_eq!(opening.pocket_warning(&opening.wall()), None);
        assert_eq!(Scene::default().pocket_warning(&Chest::Flat), None);
    }

    #[test]
    fn a_chest_is_read_and_written_and_a_flat_one_is_not_in_the_text() {
        let flat = scene(r#""insertion": 1"#).unwrap();
        assert!(flat.chest.is_none() && !flat.to_json().contains("chest"));
        assert_eq!(flat.problem().unwrap().obstacle.wall.0, Chest::Flat);
        for (text, along) in [
            (r#""chest": { "radius_across_mm": 140 }"#, f64::INFINITY),
            (r#""chest": { "radius_across_mm": 140, "radius_along_mm": null }"#, f64::INFINITY),
            (r#""chest": { "radius_across_mm": 140, "radius_along_mm": -300 }"#, -300.0),
        ] {
            let scene = scene(text).unwrap();
            let wall = Chest::Curved { across_mm: 140.0, along_mm: along };
            let problem = scene.problem().unwrap();
            assert_eq!(problem.obstacle.wall.0, wall);
            assert_eq!(problem.obstacle.dome.chest, wall);
            assert!(!problem.rest.is_even());
            assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
        }
    }

    #[test]
    fn a_chest_out_of_its_limits_is_one_line() {
        let with = |rest: &str| {
            let line = scene(rest).unwrap_err().to_string();
            assert!(!line.contains('\n'), "{line}");
            line
        };
        for radius in ["100", "-100", "0", "-0.0", "2e6", "1e308"] {
            let line = with(&format!(r#""chest": {{ "radius_across_mm": {radius} }}"#));
            // 3/4 of 135 mm.
            assert!(line.starts_with("chest.radius_across_mm is "), "{line}");
            assert!(line.contains("allowed: 101.3 to 1000000 mm"), "{line}");
        }
        for (rest, expected) in [
            (
                r#""chest": { "radius_across_mm": 140, "radius_along_mm": 90 }"#,
                "chest.radius_along_mm is 90; allowed: 101.3",
            ),
            (
                r#""patch_radius_mm": 96, "chest": { "radius_across_mm": 72 }"#,
                "allowed: 72 to 1000000 mm",
            ),
            (r#""chest": null"#, "chest is null; allowed: one JSON object, or leave it out"),
            (r#""chest": {}"#, "chest: missing field `radius_across_mm`"),
            (
                r#""chest": { "radius_across_mm": null }"#,
                "chest.radius_across_mm is null; allowed: ",
            ),
            (r#""chest": { "radius_across_mm": 140, "radius": 1 }"#, "chest.radius: unknown field"),
            (
                r#""tissue_model": "sheet", "chest": { "radius_across_mm": 140 }"#,
                "chest is curved; allowed: no chest with tissue_model sheet",
            ),
        ] {
            // 72 mm of curvature carry a patch of 96 mm.
            if rest.contains("72") {
                assert!(scene(rest).is_ok());
                let line = with(&rest.replace("72", "71"));
                assert!(line.contains(expected), "{line}");
                continue;
            }
            let line = with(rest);
            assert!(line.contains(expected), "{line}");
        }
        // Thick tissue in a hollow: cells would shrink to nothing.
        let thick = r#""layers": [{ "thickness_mm": 1.5, "curve": { "kind": "skin" }, "tissue": "skin" }, { "tissue": "adipose", "thickness_mm": 59, "curve": { "kind": "fat" } }]"#;
        let hollow = format!(r#"{thick}, "chest": {{ "radius_across_mm": -110 }}"#);
        assert!(with(&hollow).contains("hollow -1000000 to -121 mm"));
        assert!(scene(&hollow.replace("-110", "-121")).is_ok());
    }

    #[test]
    fn the_wall_is_a_height_field_as_far_as_the_patch_reaches() {
        for along in [None, Some(110.0), Some(-110.0), Some(1e6)] {
            for across in [110.0, -110.0] {
                let chest = ChestShape { radius_across_mm: across, radius_along_mm: along }.wall();
                for k in 0..24 {
                    let place = DVec2::from_angle(0.27 * f64::from(k)) * (110.0 / LEAST_OF_PATCH);
                    let (foot, normal) = chest.foot_and_normal(place);
                    assert!(foot.is_finite() && normal.z > 0.2, "{along:?} {place} {normal}");
                }
            }
        }
    }

    #[test]
    fn a_larger_pocket_makes_a_chest_flatter_and_a_sheet_is_flat() {
        let mut scene =
            scene(r#""chest": { "radius_across_mm": 110, "radius_along_mm": -150 }"#).unwrap();
        assert_eq!(scene.repair(), None);
        scene.set_pocket_radius(120.0);
        assert_eq!(scene.repair(), Some(crate::scene::Repair::ChestFlattened { radius_mm: 135.0 }));
        assert_eq!((scene.repair(), scene.validate()), (None, Ok(())));
        scene.set_tissue_model(TissueModel::Sheet);
        assert!(scene.chest.is_none() && scene.validate().is_ok());
    }
}

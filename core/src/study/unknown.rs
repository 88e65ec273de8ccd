//! What is not known about a person: the spread of each unknown and its effect on a scene.

use super::quantity::short;
use crate::clinical::spread::{self, Spread};
use crate::curve::{Curve, CurveSpec, SCALES};
use crate::scene::{Body, Layer, Scene, field, limits};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is not known about a person.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Unknown {
    /// Thickness of the first layer \[mm\].
    SkinThickness,
    /// Factor on the stress scale of the first layer \[-\].
    SkinStressScale,
    /// Strain scale of the skin preset; with a measured or set scale a factor on it \[-\].
    SkinStrainScale,
    /// Initial modulus of the layers named adipose \[kPa\] whose curve is not `fat`, by their stress scale.
    FatModulus,
    /// Factor on the thickness of the layers below the first \[-\].
    CoverThickness,
    /// Added to the radius of the pocket \[mm\].
    PocketRadius,
    /// Relative change of the projection \[-\].
    Projection,
    /// Poisson ratio of all layers \[-\] but those whose curve is `fat`.
    PoissonRatio,
    /// Factor on the stress scale of the layers whose curve is `fat` \[-\].
    FatStressScale,
    /// Poisson ratio of the layers whose curve is `fat` \[-\].
    FatPoissonRatio,
    /// Added to the radius of the chest across \[mm\]; a spherical chest stays one.
    ChestRadius,
}

impl Unknown {
    /// All unknowns.
    pub const ALL: [Self; 11] = [
        Self::SkinThickness,
        Self::SkinStressScale,
        Self::SkinStrainScale,
        Self::FatModulus,
        Self::CoverThickness,
        Self::PocketRadius,
        Self::Projection,
        Self::PoissonRatio,
        Self::FatStressScale,
        Self::FatPoissonRatio,
        Self::ChestRadius,
    ];

    /// The name in files and arguments.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::SkinThickness => "skin_thickness",
            Self::SkinStressScale => "skin_stress_scale",
            Self::SkinStrainScale => "skin_strain_scale",
            Self::FatModulus => "fat_modulus",
            Self::CoverThickness => "cover_thickness",
            Self::PocketRadius => "pocket_radius",
            Self::Projection => "projection",
            Self::PoissonRatio => "poisson_ratio",
            Self::FatStressScale => "fat_stress_scale",
            Self::FatPoissonRatio => "fat_poisson_ratio",
            Self::ChestRadius => "chest_radius",
        }
    }

    /// The unknown of a name.
    ///
    /// # Errors
    /// One line with the allowed names.
    pub fn of_name(name: &str) -> Result<Self, String> {
        Self::ALL.into_iter().find(|unknown| unknown.name() == name).ok_or_else(|| {
            let names = Self::ALL.map(Self::name).join(", ");
            format!("{:?} is not an unknown; allowed: {names}", short(name))
        })
    }

    /// The spread between people in a scene; `None` if the unknown does not apply to the scene.
    #[must_use]
    pub fn spread(self, scene: &Scene) -> Option<Spread> {
        let skin = &scene.layers.first()?.curve;
        match self {
            Self::SkinThickness => Some(spread::SKIN_THICKNESS),
            Self::SkinStressScale => Some(spread::SKIN_STRESS_SCALE),
            Self::SkinStrainScale if has_own_scale(scene) => {
                Some(spread::SKIN_STRAIN_SCALE_MEASURED)
            }
            Self::SkinStrainScale => {
                (skin.spec == CurveSpec::Skin {}).then_some(spread::SKIN_STRAIN_SCALE)
            }
            Self::FatModulus => {
                scene.layers.iter().any(is_other_fat).then_some(spread::FAT_MODULUS)
            }
            Self::CoverThickness => (scene.layers.len() > 1).then_some(spread::COVER_THICKNESS),
            Self::PocketRadius => Some(spread::POCKET_RADIUS),
            Self::Projection => Some(spread::PROJECTION),
            Self::PoissonRatio => {
                let has_other = !scene.layers.iter().all(has_fat_curve);
                has_other.then_some(spread::POISSON_RATIO)
            }
            Self::FatStressScale => {
                scene.layers.iter().any(has_fat_curve).then_some(spread::FAT_STRESS_SCALE)
            }
            Self::FatPoissonRatio => {
                scene.layers.iter().any(has_fat_curve).then_some(spread::FAT_POISSON_RATIO)
            }
            Self::ChestRadius => field::CHEST_ACROSS.value(scene, 0).map(|_| spread::CHEST_RADIUS),
        }
    }

    /// Allowed medians, means and bounds of a distribution \[unit of the distribution\].
    #[must_use]
    pub fn allowed(self) -> (f64, f64) {
        match self {
            Self::SkinThickness => field::THICKNESS.limits,
            Self::SkinStressScale
            | Self::SkinStrainScale
            | Self::CoverThickness
            | Self::FatStressScale => SCALES,
            Self::FatModulus => (0.01, 1e4),
            Self::PocketRadius | Self::ChestRadius => (-50.0, 50.0),
            Self::Projection => (-0.9, 0.9),
            Self::PoissonRatio | Self::FatPoissonRatio => field::POISSON_RATIO.limits,
        }
    }

    /// Sets the sampled value in a scene; values beyond the limits of a scene become the limit.
    pub(super) fn apply(self, scene: &mut Scene, base: &Scene, value: f64) {
        let of_base = |wanted: fn(&Layer) -> bool| {
            base.layers.iter().enumerate().filter(move |(_, layer)| wanted(layer))
        };
        match self {
            Self::SkinThickness => field::THICKNESS.set(scene, 0, value),
            Self::SkinStressScale => {
                field::STRESS_SCALE.set(scene, 0, base.layers[0].curve.stress_scale * value);
            }
            Self::SkinStrainScale => {
                let own = if has_own_scale(base) { base.layers[0].curve.strain_scale } else { 1.0 };
                field::STRAIN_SCALE.set(scene, 0, own * value);
            }
            Self::FatModulus => {
                for (k, base) in of_base(is_other_fat) {
                    let modulus = Curve::scaled(&base.curve).map_or(0.0, |curve| curve.slope(0.0));
                    if modulus > 0.0 {
                        let scale = base.curve.stress_scale * value / modulus;
                        field::STRESS_SCALE.set(scene, k, scale);
                    }
                }
            }
            Self::CoverThickness => {
                for (k, base) in base.layers.iter().enumerate().skip(1) {
                    field::THICKNESS.set(scene, k, base.thickness_mm * value);
                }
            }
            Self::PocketRadius => {
                // The patch stays, so that all samples of layered tissue have one grid.
                let least = base.implant.least_pocket_mm();
                let most = limits::POCKET_RADIUS_MAX_MM;
                scene.pocket_radius_mm = (base.pocket_radius_mm + value).max(least).min(most);
                if let Some(body) = &mut scene.body {
                    let (least, _) = Body::patch_range(scene.pocket_radius_mm);
                    body.patch_radius_mm = body.patch_radius_mm.max(least);
                }
            }
            Self::Projection => {
                field::PROJECTION.set(scene, 0, base.implant.projection_mm * (1.0 + value));
            }
            Self::PoissonRatio => {
                for (k, _) in of_base(|layer| !has_fat_curve(layer)) {
                    field::POISSON_RATIO.set(scene, k, value);
                }
            }
            Self::FatStressScale => {
                for (k, base) in of_base(has_fat_curve) {
                    field::STRESS_SCALE.set(scene, k, base.curve.stress_scale * value);
                }
            }
            Self::FatPoissonRatio => {
                for (k, _) in of_base(has_fat_curve) {
                    field::POISSON_RATIO.set(scene, k, value);
                }
            }
            Self::ChestRadius => {
                let across = field::CHEST_ACROSS.value(base, 0);
                let along = field::CHEST_ALONG.value(base, 0).filter(|_| base.is_sphere());
                for (field, radius) in [(field::CHEST_ACROSS, across), (field::CHEST_ALONG, along)]
                {
                    if let Some(radius) = radius {
                        field.set(scene, 0, radius + value);
                    }
                }
            }
        }
    }
}

fn has_fat_curve(layer: &Layer) -> bool {
    matches!(layer.curve.spec, CurveSpec::Fat { .. })
}

/// Is the layer fat with another curve, as the paper's?
fn is_other_fat(layer: &Layer) -> bool {
    layer.tissue == "adipose" && !has_fat_curve(layer)
}

/// Is the strain scale of the skin measured, or set by hand?
#[allow(clippy::float_cmp, reason = "the default exactly")]
fn has_own_scale(scene: &Scene) -> bool {
    let measured = scene.patient.as_ref().map(|patient| patient.measured);
    measured.is_some_and(|m| m.skin_pull_mm.is_some() || m.skin_class.is_some())
        || scene.layers.first().is_some_and(|skin| skin.curve.strain_scale != 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clinical::spread::Distribution;
    use crate::scene::ChestShape;
    use crate::study::{Parameter, with_values};

    #[test]
    fn the_radius_of_a_chest_is_unknown_by_15_mm_about_the_plan_and_a_flat_chest_has_none() {
        let mut base = Scene::opening();
        base.chest = None;
        assert_eq!(Unknown::ChestRadius.spread(&base), None);
        let sampled = |chest, value| {
            let base = Scene { chest: Some(chest), ..base.clone() };
            let spread = Unknown::ChestRadius.spread(&base).unwrap();
            assert_eq!(spread.distribution, Distribution::Normal { mean: 0.0, sd: 15.0 });
            let mut scene = base.clone();
            Unknown::ChestRadius.apply(&mut scene, &base, value);
            assert_eq!(scene.validate(), Ok(()));
            let chest = scene.chest.unwrap();
            (chest.radius_across_mm, chest.radius_along_mm)
        };
        assert_eq!(sampled(ChestShape::USUAL, 12.0), (152.0, None));
        assert_eq!(sampled(ChestShape::ROUND, -10.0), (110.0, Some(110.0)));
        // Not below the limit of the scene, 3/4 of the patch.
        assert_eq!(sampled(ChestShape::USUAL, -60.0), (97.5, None));
        let hollow = ChestShape { radius_across_mm: -200.0, radius_along_mm: Some(500.0) };
        assert_eq!(sampled(hollow, 15.0), (-185.0, Some(500.0)));
    }

    #[test]
    fn a_radius_of_the_chest_is_an_axis_and_makes_a_flat_chest_curved() {
        let flat = Scene { chest: None, ..Scene::opening() };
        let curved = |name: &str, value: f64| {
            let parameter = Parameter::of_name(name).unwrap();
            assert_eq!(parameter.value(&flat), None);
            let scene = with_values(&flat, &[(parameter, value)]).unwrap();
            assert_eq!(parameter.value(&scene), Some(value));
            scene.chest.unwrap()
        };
        let across = curved("chest.radius_across_mm", 160.0);
        assert_eq!(across, ChestShape { radius_across_mm: 160.0, ..ChestShape::USUAL });
        let along = curved("chest.radius_along_mm", 300.0);
        assert_eq!(along, ChestShape { radius_along_mm: Some(300.0), ..ChestShape::USUAL });
        assert!(with_values(&Scene::sheet(), &[(Parameter::ChestAcross, 150.0)]).is_err());
    }
}

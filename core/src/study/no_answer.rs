//! Why a plan may have no answer, in a surgeon's words, from what the scene shows.

use crate::clinical::Size;
use crate::curve::Curve;
use crate::scene::{Layer, Scene};
use crate::solve::Invalid;
use crate::springs::Springs;

/// Projection / base radius above which a dome is steep \[-\]: more than a half sphere.
const STEEP_RATIO: f64 = 1.05;
/// Stress \[kPa\] at a strain of 30 % below which a layer is soft: a third of what was measured on human fat (1.5 kPa).
const SOFT_KPA: f64 = 0.5;
/// Strain up to which fat was measured, and a strain of fat beside the implant \[-\].
const SOFT_STRAIN: f64 = 0.3;
const GREAT_STRAIN: f64 = 0.6;
/// Slope of a curve at [`GREAT_STRAIN`] / initial slope below which the layer gives way \[-\].
const SOFTENING: f64 = 0.5;
/// Slope of the skin's curve at the strain of the plan / initial slope from which the skin is tight \[-\].
const STIFFENING: f64 = 2.0;
/// Stress of the skin \[kPa\] from which the skin is tight whatever its slope.
const TIGHT_KPA: f64 = 150.0;

/// The probable reason why a plan has no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoAnswer {
    /// The springs of Nikolaev 2013 are unstable at these strains.
    PaperSprings,
    /// The dome is steeper than a half sphere, or protrudes through the tissue.
    SteepDome,
    /// The skin is in the stiff part of its curve, and a layer below the skin is soft.
    TightSkinOverSoftFat,
    /// The skin is in the stiff part of its curve.
    TightSkin,
    /// A layer below the skin is soft or gives way at great strains.
    SoftFat,
    /// The scene shows none of the other reasons.
    Unexplained,
}

impl NoAnswer {
    /// The reason that a scene shows; `invalid`: why its last shape was invalid.
    #[must_use]
    pub fn of(scene: &Scene, invalid: Option<Invalid>) -> Self {
        let rise = scene.insertion * scene.implant.projection_mm;
        if scene.springs == Springs::Nikolaev {
            return Self::PaperSprings;
        }
        if rise > STEEP_RATIO * scene.implant.base_radius_mm {
            return Self::SteepDome;
        }
        let strain = (rise / scene.pocket_radius_mm).hypot(1.0) - 1.0;
        let is_tight = scene.layers.first().is_some_and(|skin| is_tight(skin, strain));
        let is_soft = scene.layers.iter().skip(1).any(is_soft);
        match (is_tight, is_soft) {
            (true, true) => Self::TightSkinOverSoftFat,
            (true, false) => Self::TightSkin,
            (false, true) => Self::SoftFat,
            (false, false) if invalid == Some(Invalid::Penetrated) => Self::SteepDome,
            (false, false) => Self::Unexplained,
        }
    }

    /// The reason in one sentence, of two lines of a panel at most.
    #[must_use]
    pub fn words(self, scene: &Scene) -> String {
        let size = size_in_words(scene);
        match self {
            Self::PaperSprings => "The 2013 model has no answer for this much stretch.".to_owned(),
            Self::SteepDome => {
                "The implant is too steep for its width: the model has no answer.".to_owned()
            }
            Self::TightSkinOverSoftFat => {
                format!("The skin is too tight for {size}, and fat this soft gives way under it.")
            }
            Self::TightSkin => {
                format!("The skin is too tight for {size}: it does not stretch over this height.")
            }
            Self::SoftFat => {
                format!("Fat this soft gives way between the skin and {size}.")
            }
            Self::Unexplained => format!("The model has no answer for {size}."),
        }
    }
}

/// Is a skin, strained by the plan \[-\], in the stiff part of its curve?
fn is_tight(skin: &Layer, strain: f64) -> bool {
    Curve::scaled(&skin.curve).is_ok_and(|curve| {
        curve.stress(strain) > TIGHT_KPA || curve.slope(strain) > STIFFENING * curve.slope(0.0)
    })
}

/// Is a layer soft, or does the layer give way at great strains?
fn is_soft(layer: &Layer) -> bool {
    Curve::scaled(&layer.curve).is_ok_and(|curve| {
        curve.stress(SOFT_STRAIN) < SOFT_KPA
            || curve.slope(GREAT_STRAIN) < SOFTENING * curve.slope(0.0)
    })
}

/// Volume \[ml\] and width \[cm\] of the implant of a scene, as "300" and "12"; of an anatomical base width and height, as "12 × 10.8".
#[must_use]
pub fn volume_and_width(scene: &Scene) -> [String; 2] {
    let implant = &scene.implant;
    let volume = implant.size().map_or(0.0, Size::volume_ml);
    let cm = |mm: f64| format!("{:.1}", 0.1 * mm).trim_end_matches(".0").to_owned();
    let (width, height) = (cm(2.0 * implant.base_radius_mm), cm(implant.base_height()));
    [format!("{volume:.0}"), if height == width { width } else { format!("{width} × {height}") }]
}

/// The implant of a scene by its maker's name, as "RD-275 · 275 cc"; without one by its volume, as "300 ml".
#[must_use]
pub fn implant_in_words(scene: &Scene) -> String {
    reference_or(scene, |scene| format!("{} ml", volume_and_width(scene)[0]))
}

/// The implant of a scene by its maker's name; without one in a few words, as [`size_in_words`].
#[must_use]
pub fn name_in_words(scene: &Scene) -> String {
    reference_or(scene, size_in_words)
}

/// The maker's name of the implant; without one other words.
fn reference_or(scene: &Scene, words: fn(&Scene) -> String) -> String {
    match scene.implant_reference.as_str() {
        "" => words(scene),
        name => name.to_owned(),
    }
}

/// The implant of a scene in a few words, as "300 ml on 12 cm".
#[must_use]
pub fn size_in_words(scene: &Scene) -> String {
    let [volume, width] = volume_and_width(scene);
    format!("{volume} ml on {width} cm")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::{CurveSpec, Fat};
    use crate::study::flat_plan;

    /// The reason of the opening plan after an edit.
    fn reason(edit: impl FnOnce(&mut Scene)) -> NoAnswer {
        let mut scene = Scene::opening();
        edit(&mut scene);
        NoAnswer::of(&scene, None)
    }

    #[test]
    fn the_reason_is_what_the_scene_shows() {
        let paper = |scene: &mut Scene| scene.layers[1].curve = CurveSpec::Adipose {}.into();
        let tight = |scene: &mut Scene| scene.layers[0].curve.strain_scale = 0.15;
        assert_eq!(reason(|_| {}), NoAnswer::Unexplained);
        assert_eq!(reason(paper), NoAnswer::SoftFat);
        assert_eq!(reason(tight), NoAnswer::TightSkin);
        let both = reason(|scene| {
            paper(scene);
            tight(scene);
        });
        assert_eq!(both, NoAnswer::TightSkinOverSoftFat);
        for variant in Fat::ALL {
            let measured = CurveSpec::Fat { variant };
            let reason = reason(|scene| scene.layers[1].curve = measured.into());
            assert_eq!(reason, NoAnswer::Unexplained, "{variant:?}");
        }
        assert_eq!(reason(|scene| scene.implant.projection_mm = 70.0), NoAnswer::SteepDome);
        assert_eq!(reason(|scene| scene.set_springs(Springs::Nikolaev)), NoAnswer::PaperSprings);
        let protruding = NoAnswer::of(&Scene::opening(), Some(Invalid::Penetrated));
        assert_eq!(protruding, NoAnswer::SteepDome);
    }

    #[test]
    fn the_words_have_the_size_and_fit_in_two_lines() {
        let scene = flat_plan();
        assert_eq!(
            NoAnswer::Unexplained.words(&scene),
            "The model has no answer for 300 ml on 12 cm."
        );
        for reason in [
            NoAnswer::PaperSprings,
            NoAnswer::SteepDome,
            NoAnswer::TightSkinOverSoftFat,
            NoAnswer::TightSkin,
            NoAnswer::SoftFat,
        ] {
            let words = reason.words(&scene);
            assert!(words.len() <= 84 && words.ends_with('.'), "{words}");
        }
    }
}

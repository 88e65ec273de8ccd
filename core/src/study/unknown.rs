//! What is not known about a person: the spread of each unknown and its effect on a scene.

use super::quantity::short;
use crate::clinical::spread::{self, Spread};
use crate::curve::{Curve, CurveSpec, SCALES};
use crate::scene::field::CHEST;
use crate::scene::{Field, Layer, Scene, limits};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What is common to an unknown of all scenes.
struct Row {
    name: &'static str,
    /// Allowed medians, means and bounds of a distribution.
    allowed: fn() -> (f64, f64),
    /// The spread between people; `None` if the unknown does not apply to a scene.
    spread: fn(&Scene) -> Option<Spread>,
    /// Sets a sampled value in a scene like the base.
    apply: fn(&mut Scene, &Scene, f64),
}

macro_rules! unknowns {
    ($($(#[$about:meta])+ $unknown:ident: $name:literal, $allowed:expr, $spread:expr, $apply:expr;)+) => {
        /// What is not known about a person.
        #[derive(
            Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema,
        )]
        pub enum Unknown {
            $($(#[$about])+ #[serde(rename = $name)] $unknown,)+
        }

        const COUNT: usize = [$($name),+].len();

        impl Unknown {
            /// All unknowns.
            pub const ALL: [Self; COUNT] = [$(Self::$unknown),+];
        }

        static ROWS: [Row; COUNT] =
            [$(Row { name: $name, allowed: || $allowed, spread: $spread, apply: $apply }),+];
    };
}

unknowns! {
    /// Thickness of the first layer \[mm\].
    SkinThickness: "skin_thickness", Field::Thickness.limits,
        |_| Some(spread::SKIN_THICKNESS),
        |scene, _, value| Field::Thickness.set(scene, 0, value);
    /// Factor on the stress scale of the first layer \[-\].
    SkinStressScale: "skin_stress_scale", SCALES,
        |_| Some(spread::SKIN_STRESS_SCALE),
        |scene, base, value| Field::StressScale.set(scene, 0, base.layers[0].curve.stress_scale * value);
    /// Strain scale of the skin preset; with a measured or set scale a factor on it \[-\].
    SkinStrainScale: "skin_strain_scale", SCALES,
        |scene| match scene.layers.first()?.curve.spec {
            _ if has_own_scale(scene) => Some(spread::SKIN_STRAIN_SCALE_MEASURED),
            CurveSpec::Skin {} => Some(spread::SKIN_STRAIN_SCALE),
            _ => None,
        },
        |scene, base, value| {
            let own = if has_own_scale(base) { base.layers[0].curve.strain_scale } else { 1.0 };
            Field::StrainScale.set(scene, 0, own * value);
        };
    /// Initial modulus of the layers named adipose \[kPa\] whose curve is not `fat`, by their stress scale.
    FatModulus: "fat_modulus", (0.01, 1e4),
        |scene| scene.layers.iter().any(is_other_fat).then_some(spread::FAT_MODULUS),
        |scene, base, value| set_moduli(scene, base, is_other_fat, value);
    /// Factor on the thickness of the layers below the first \[-\].
    CoverThickness: "cover_thickness", SCALES,
        |scene| (scene.layers.len() > 1).then_some(spread::COVER_THICKNESS),
        |scene, base, value| {
            for (k, base) in layers(base, |_| true).skip(1) {
                Field::Thickness.set(scene, k, base.thickness_mm * value);
            }
        };
    /// Added to the radius of the pocket \[mm\].
    PocketRadius: "pocket_radius", (-50.0, 50.0),
        |_| Some(spread::POCKET_RADIUS),
        |scene, base, value| {
            // The patch stays, so that all samples of layered tissue have one grid.
            let least = base.implant.least_pocket_mm();
            let most = limits::POCKET_RADIUS_MAX_MM;
            scene.pocket_radius_mm = (base.pocket_radius_mm + value).max(least).min(most);
            scene.widen_patch();
        };
    /// Relative change of the projection \[-\]; that of an implant that yields follows from its fill.
    Projection: "projection", (-0.9, 0.9),
        |scene| scene.implant.fill.is_none().then_some(spread::PROJECTION),
        |scene, base, value| Field::Projection.set(scene, 0, base.implant.projection_mm * (1.0 + value));
    /// Poisson ratio of all layers \[-\] but those whose curve is `fat`.
    PoissonRatio: "poisson_ratio", Field::PoissonRatio.limits,
        |scene| scene.layers.iter().any(has_other_curve).then_some(spread::POISSON_RATIO),
        |scene, base, value| set_ratios(scene, base, has_other_curve, value);
    /// Factor on the stress scale of the layers whose curve is `fat` \[-\].
    FatStressScale: "fat_stress_scale", SCALES,
        |scene| scene.layers.iter().any(has_fat_curve).then_some(spread::FAT_STRESS_SCALE),
        |scene, base, value| {
            for (k, base) in layers(base, has_fat_curve) {
                Field::StressScale.set(scene, k, base.curve.stress_scale * value);
            }
        };
    /// Poisson ratio of the layers whose curve is `fat` \[-\].
    FatPoissonRatio: "fat_poisson_ratio", Field::PoissonRatio.limits,
        |scene| scene.layers.iter().any(has_fat_curve).then_some(spread::FAT_POISSON_RATIO),
        |scene, base, value| set_ratios(scene, base, has_fat_curve, value);
    /// Added to the radius of the chest across \[mm\]; a spherical chest stays one.
    ChestRadius: "chest_radius", (-50.0, 50.0),
        |scene| Field::ChestAcross.value(scene, 0).map(|_| spread::CHEST_RADIUS),
        |scene, base, value| {
            let sides = if base.is_sphere() { &CHEST[..] } else { &CHEST[..1] };
            for field in sides {
                if let Some(radius) = field.value(base, 0) {
                    field.set(scene, 0, radius + value);
                }
            }
        };
    /// Factor on the natural tension of the skin \[-\].
    NaturalTension: "natural_tension", SCALES,
        |scene| (natural_tension(scene) > 0.0).then_some(spread::NATURAL_TENSION),
        |scene, base, value| Field::NaturalTension.set(scene, 0, natural_tension(base) * value);
    /// Added to the growth of the skin \[-\].
    Grown: "grown", (-1.0, 1.0),
        |scene| (scene.body.skin_state.grown > 0.0).then_some(spread::GROWN),
        |scene, base, value| {
            // A skin that does not grow is another study's scene: the least growth stays.
            let grown = base.body.skin_state.grown + value;
            Field::Grown.set(scene, 0, grown.max(LEAST_GROWN));
        };
    /// Factor on the moduli of the implant's gel and shell \[-\].
    FillModulus: "fill_modulus", SCALES,
        |scene| scene.implant.fill.map(|_| spread::FILL_MODULUS),
        |scene, base, value| scene.implant.fill = base.implant.fill.map(|fill| fill.stiffer(value));
    /// Initial modulus of the muscle over the implant \[kPa\], by its stress scale.
    MuscleModulus: "muscle_modulus", (0.01, 1e4),
        |scene| scene.layers.iter().any(Layer::is_muscle).then_some(spread::MUSCLE_MODULUS),
        |scene, base, value| set_moduli(scene, base, Layer::is_muscle, value);
}

/// Least sampled growth \[-\].
const LEAST_GROWN: f64 = 0.01;

impl Unknown {
    fn row(self) -> &'static Row {
        &ROWS[self as usize]
    }

    /// The name in files and arguments.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().name
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
        if scene.layers.is_empty() { None } else { (self.row().spread)(scene) }
    }

    /// Allowed medians, means and bounds of a distribution \[unit of the distribution\].
    #[must_use]
    pub fn allowed(self) -> (f64, f64) {
        (self.row().allowed)()
    }

    /// Sets the sampled value in a scene; values beyond the limits of a scene become the limit.
    pub(super) fn apply(self, scene: &mut Scene, base: &Scene, value: f64) {
        (self.row().apply)(scene, base, value);
    }
}

/// The layers of a kind with their indices.
fn layers(base: &Scene, is_wanted: fn(&Layer) -> bool) -> impl Iterator<Item = (usize, &Layer)> {
    base.layers.iter().enumerate().filter(move |(_, layer)| is_wanted(layer))
}

fn set_ratios(scene: &mut Scene, base: &Scene, is_wanted: fn(&Layer) -> bool, value: f64) {
    layers(base, is_wanted).for_each(|(k, _)| Field::PoissonRatio.set(scene, k, value));
}

/// Sets the initial modulus \[kPa\] of the layers of a kind by their stress scale.
fn set_moduli(scene: &mut Scene, base: &Scene, is_wanted: fn(&Layer) -> bool, value: f64) {
    for (k, base) in layers(base, is_wanted) {
        let modulus = Curve::scaled(&base.curve).map_or(0.0, |curve| curve.slope(0.0));
        if modulus > 0.0 {
            Field::StressScale.set(scene, k, base.curve.stress_scale * value / modulus);
        }
    }
}

fn natural_tension(scene: &Scene) -> f64 {
    scene.body.skin_state.natural_tension_n_per_m
}

/// Have two scenes the same sampled patients? The sides, the visits, the implant's references, and names and measurements that no
/// unknown depends on may differ.
#[must_use]
pub fn has_same_patients(a: &Scene, b: &Scene) -> bool {
    let kind = |layer: &Layer| (is_other_fat(layer), layer.is_muscle());
    let kinds = |scene: &Scene| scene.layers.iter().map(kind).collect::<Vec<_>>();
    let has_same_spreads = || Unknown::ALL.into_iter().all(|it| it.spread(a) == it.spread(b));
    a == b || a.same_physics(b) && kinds(a) == kinds(b) && has_same_spreads()
}

fn has_other_curve(layer: &Layer) -> bool {
    !has_fat_curve(layer)
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
    let measured = scene.measured();
    measured.skin_pull_mm.is_some()
        || measured.skin_class.is_some()
        || scene.layers.first().is_some_and(|skin| skin.curve.strain_scale != 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clinical::spread::Distribution;
    use crate::scene::{ChestShape, Plane, Side, Visit};
    use crate::study::{Parameter, with_values};

    #[test]
    fn entries_for_the_file_leave_the_sampled_patients_and_a_measured_pull_is_another_spread() {
        let scene = Scene::opening();
        let mut other = Scene { side: Some(Side::Right), ..scene.clone() };
        other.visit = Some(Visit { reference: "4711".to_owned(), ..Visit::default() });
        other.implant_reference = "A 1".to_owned();
        other.layers[0].tissue = "cutis".to_owned();
        let measured = &mut other.patient.get_or_insert_default().measured;
        measured.base_width_mm = Some(120.0);
        assert!(has_same_patients(&scene, &other));
        for edit in [
            |scene: &mut Scene| scene.layers[0].thickness_mm += 0.1,
            |scene: &mut Scene| {
                let measured = &mut scene.patient.get_or_insert_default().measured;
                measured.skin_pull_mm = Some(measured.skin_pull_mm.unwrap_or(20.0) + 1.0);
                measured.skin_class = None;
                scene.layers[0].curve.strain_scale = 1.0;
            },
        ] {
            let mut edited = other.clone();
            edited.layers[0].curve.strain_scale = 1.0;
            edit(&mut edited);
            let mut before = other.clone();
            before.layers[0].curve.strain_scale = 1.0;
            before.patient = None;
            assert!(!has_same_patients(&before, &edited));
        }
        let mut paper = scene.clone();
        paper.layers[1].curve = CurveSpec::Adipose {}.into();
        paper.layers[1].tissue = "adipose".to_owned();
        let mut unnamed = paper.clone();
        unnamed.layers[1].tissue = "fat of her".to_owned();
        assert!(!has_same_patients(&paper, &unnamed));
    }

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
        let sphere = ChestShape { radius_across_mm: 120.0, radius_along_mm: Some(120.0) };
        assert_eq!(sampled(sphere, -10.0), (110.0, Some(110.0)));
        // Not below the limit of the scene, 3/4 of the patch.
        assert_eq!(sampled(ChestShape::USUAL, -60.0), (97.5, None));
        let hollow = ChestShape { radius_across_mm: -200.0, radius_along_mm: Some(500.0) };
        assert_eq!(sampled(hollow, 15.0), (-185.0, Some(500.0)));
    }

    #[test]
    fn tension_growth_fill_and_muscle_are_unknown_where_a_plan_has_them() {
        let living =
            [Unknown::NaturalTension, Unknown::Grown, Unknown::FillModulus, Unknown::MuscleModulus];
        let opening = Scene::opening();
        assert!(living.iter().all(|unknown| unknown.spread(&opening).is_none()));
        assert!(Unknown::Projection.spread(&opening).is_some());
        let mut base = Scene::first_plan();
        base.body.skin_state.natural_tension_n_per_m = 20.0;
        base.body.skin_state.grown = 0.3;
        base.set_plane(Some(Plane::Below));
        assert_eq!(base.validate(), Ok(()));
        assert!(living.iter().all(|unknown| unknown.spread(&base).is_some()));
        // The projection of an implant that yields is a result.
        assert_eq!(Unknown::Projection.spread(&base), None);
        let sampled = |unknown: Unknown, value: f64| {
            let mut scene = base.clone();
            unknown.apply(&mut scene, &base, value);
            assert_eq!(scene.validate(), Ok(()), "{unknown:?} {value}");
            scene
        };
        for (value, tension) in [(2.0, 40.0), (0.5, 10.0), (20.0, 300.0)] {
            let state = sampled(Unknown::NaturalTension, value).body.skin_state;
            assert!((state.natural_tension_n_per_m - tension).abs() < 1e-12);
        }
        // A skin of 1.55 mm bears less where it is softer.
        let mut soft = base.clone();
        soft.layers[0].curve.stress_scale = 0.2;
        soft.body.skin_state.natural_tension_n_per_m = 300.0;
        assert!(soft.validate().is_err());
        soft.lower_tension();
        let borne = soft.body.skin_state.natural_tension_n_per_m;
        assert!(soft.validate().is_ok() && borne > 100.0, "{borne}");
        soft.lower_tension();
        assert!((soft.body.skin_state.natural_tension_n_per_m - borne).abs() < 1e-12);
        for (value, grown) in [(0.2, 0.5), (-0.5, LEAST_GROWN), (1.0, 1.0)] {
            let state = sampled(Unknown::Grown, value).body.skin_state;
            assert!((state.grown - grown).abs() < 1e-12);
        }
        // A factor on both moduli is one on the modulus of the whole body.
        let modulus = |scene: &Scene| scene.implant.fill.unwrap().modulus_kpa(60.0);
        for factor in [0.5, 1.6] {
            let ratio = modulus(&sampled(Unknown::FillModulus, factor)) / modulus(&base);
            assert!((ratio - factor).abs() < 1e-12, "{ratio}");
        }
        sampled(Unknown::FillModulus, 20.0);
        sampled(Unknown::FillModulus, 0.05);
        let muscle = sampled(Unknown::MuscleModulus, 12.0).layers.pop().unwrap();
        assert!((Curve::scaled(&muscle.curve).unwrap().slope(0.0) - 12.0).abs() < 1e-9);
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
        assert!(
            with_values(&Scene::sheet(), &[(Parameter::of(Field::ChestAcross), 150.0)]).is_err()
        );
    }
}

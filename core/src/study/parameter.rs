//! The numbers of a scene that a map varies: paths of the scene and a surgeon's names.

use super::quantity;
use crate::clinical::{ClinicalError, Dimension, Measurements};
use crate::curve::number;
use crate::scene::field::{Change, Part};
use crate::scene::{ChestShape, Field, Scene, SceneError, Torso, limits};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A number of a scene, by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String")]
pub enum Parameter {
    /// `base_width_mm`: twice the base radius \[mm\].
    BaseWidth,
    /// `volume_ml`: changes the projection; on a map over projection and volume the base width \[ml\].
    Volume,
    /// `pocket_margin_mm`: pocket radius less base radius and distance of the implant's centre \[mm\].
    PocketMargin,
    /// `thickness_mm`, `thickness`: of all layers; the layers below the skin change in proportion \[mm\].
    Thickness,
    /// `poisson_ratio`: of all layers \[-\].
    PoissonRatio,
    /// A number that the scene stores, by its path, and its layer, from the skin from 0. A chest's radius makes a flat chest a curved
    /// one; a measurement determines the thickness of skin and fat, or the strain scale of the skin.
    Number(Field, u8),
}

/// Short names, in the order of help and messages.
const SHORT: [(&str, Parameter); 10] = [
    ("base_width_mm", Parameter::BaseWidth),
    ("projection_mm", Parameter::of(Field::Projection)),
    ("volume_ml", Parameter::Volume),
    ("pocket_margin_mm", Parameter::PocketMargin),
    ("pinch_mm", Parameter::of(Field::Pinch)),
    ("skin_pull_mm", Parameter::of(Field::SkinPull)),
    ("thickness_mm", Parameter::Thickness),
    ("strain_scale", Parameter::of(Field::StrainScale)),
    ("stress_scale", Parameter::of(Field::StressScale)),
    ("poisson_ratio", Parameter::PoissonRatio),
];
/// Names that are accepted and not listed.
const OTHERS: [(&str, Parameter); 2] =
    [("thickness", Parameter::Thickness), ("implant.base_width_mm", Parameter::BaseWidth)];

/// Numbers that no study varies: the measured width acts through the pull, and a study has a tolerance of its own.
const FIXED: [Field; 2] = [Field::BreastWidth, Field::Tolerance];

fn varied() -> impl Iterator<Item = Field> {
    Field::ALL.iter().copied().filter(|field| !FIXED.contains(field))
}

impl Parameter {
    /// A number that the scene stores, of a layer's number that of the skin.
    #[must_use]
    pub const fn of(field: Field) -> Self {
        Self::Number(field, 0)
    }

    /// The parameter of a name.
    ///
    /// # Errors
    /// One line with the allowed names.
    pub fn of_name(name: &str) -> Result<Self, String> {
        let named = SHORT.into_iter().chain(OTHERS).find(|(known, _)| *known == name);
        let found = named.map(|(_, parameter)| parameter).or_else(|| Self::of_path(name));
        found.ok_or_else(|| {
            let short = SHORT.map(|(name, _)| name.to_owned());
            let is_listed = |field: &Field| !SHORT.contains(&(field.path, Self::of(*field)));
            let paths = varied().filter(|field| field.part != Part::Patient && is_listed(field));
            let paths = paths.map(|field| field.path.replace("[]", "[k]"));
            let names: Vec<String> = short.into_iter().chain(paths).collect();
            format!("{:?} is not a field; allowed: {}", quantity::short(name), names.join(", "))
        })
    }

    /// The number of a path, of a layer's number with the index of the layer.
    fn of_path(path: &str) -> Option<Self> {
        let (field, layer) = Field::of_path(path)?;
        let is_varied = !FIXED.contains(&field) && layer < limits::LAYERS.1;
        is_varied.then_some(Self::Number(field, layer as u8))
    }

    /// The shortest name.
    #[must_use]
    pub fn name(self) -> String {
        let (field, layer) = self.row();
        let short = SHORT.into_iter().find(|(_, parameter)| *parameter == self);
        short.map_or_else(|| field.path(layer), |(name, _)| name.to_owned())
    }

    /// The number that the parameter sets, and its layer; of several layers the first.
    #[must_use]
    pub fn row(self) -> (Field, usize) {
        match self {
            Self::BaseWidth => (Field::BaseRadius, 0),
            Self::Volume => (Field::Projection, 0),
            Self::PocketMargin => (Field::PocketRadius, 0),
            Self::Thickness => (Field::Thickness, 0),
            Self::PoissonRatio => (Field::PoissonRatio, 0),
            Self::Number(field, layer) => (field, usize::from(layer)),
        }
    }

    /// The parameter in words and its unit.
    #[must_use]
    pub fn label(self) -> (String, &'static str) {
        let (field, layer) = self.row();
        let words = match self {
            Self::BaseWidth => "base width",
            Self::Volume => return ("volume".to_owned(), "ml"),
            Self::PocketMargin => "margin of the pocket",
            Self::Thickness => "thickness of the cover",
            Self::Number(Field::PoissonRatio, _) => return (self.name(), field.unit),
            _ if layer > 0 => return (self.name(), field.unit),
            _ => field.words,
        };
        (words.to_owned(), field.unit)
    }

    /// The value in a scene; `None` if the scene has no such value.
    #[must_use]
    pub fn value(self, scene: &Scene) -> Option<f64> {
        Some(match self {
            Self::BaseWidth => 2.0 * scene.implant.base_radius_mm,
            Self::Volume => scene.implant.size().ok()?.volume_ml(),
            Self::PocketMargin => margin(scene),
            Self::Thickness => scene.tissue_mm(),
            Self::PoissonRatio => {
                let first = scene.layers.first()?.poisson_ratio;
                let is_first = |other: f64| other.to_bits() == first.to_bits();
                let is_common = scene.layers.iter().all(|layer| is_first(layer.poisson_ratio));
                is_common.then_some(first)?
            }
            Self::Number(field, layer) => field.value(scene, usize::from(layer))?,
        })
    }

    /// Does the pocket follow the implant when this parameter changes?
    #[must_use]
    pub fn moves_implant(self) -> bool {
        use Field::{BaseHeight, BaseRadius, CenterX, CenterY};
        let of_implant = [BaseRadius, BaseHeight, CenterX, CenterY].map(Self::of);
        matches!(self, Self::BaseWidth | Self::Volume) || of_implant.contains(&self)
    }

    /// Do two parameters set the same field? Projection and volume do not: together they set the base width.
    #[must_use]
    pub fn excludes(self, other: Self, scene: &Scene) -> bool {
        const SIZE: [Parameter; 2] = [Parameter::of(Field::Projection), Parameter::Volume];
        if self != other && SIZE.contains(&self) && SIZE.contains(&other) {
            return false;
        }
        let others = other.fields(scene);
        self.fields(scene).iter().any(|field| others.contains(field))
    }

    /// The numbers of a scene that the parameter sets; two axes that set the same number exclude each other.
    fn fields(self, scene: &Scene) -> Vec<(Field, usize)> {
        let of_all = |field| (0..scene.layers.len()).map(|layer| (field, layer)).collect();
        match self {
            Self::Number(Field::Pinch, _) | Self::Thickness => of_all(Field::Thickness),
            Self::Number(Field::SkinPull, _) => vec![(Field::StrainScale, 0)],
            Self::PoissonRatio => of_all(Field::PoissonRatio),
            _ => vec![self.row()],
        }
    }

    /// Checks that a scene has the number.
    ///
    /// # Errors
    /// The scene is a sheet, or has too few layers.
    pub(super) fn check(self, scene: &Scene) -> Result<(), ParameterError> {
        let layers = scene.layers.len();
        let (field, layer) = self.row();
        let is_missing = match field.part {
            Part::Chest | Part::Torso | Part::Body => !scene.is_layered(),
            _ => false,
        };
        if is_missing {
            return Err(ParameterError::Sheet(self.name()));
        }
        if self == Self::Thickness && layers < 2 {
            return Err(ParameterError::OneLayer(self.name()));
        }
        if layer >= layers {
            return Err(ParameterError::NoLayer { name: self.name(), layers });
        }
        Ok(())
    }

    /// The cost of a change; a volume may set the base width, too.
    pub(super) fn change(self) -> Change {
        if self == Self::Volume { Change::Grid } else { self.row().0.change }
    }
}

impl TryFrom<String> for Parameter {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        Self::of_name(&name)
    }
}

impl From<Parameter> for String {
    fn from(parameter: Parameter) -> Self {
        parameter.name()
    }
}

/// Pocket radius less half of the implant's base and distance of its centre \[mm\], 0 or more. Rounded to 1e-9 mm, so that the
/// margin is the same for every implant that keeps it.
fn margin(scene: &Scene) -> f64 {
    let [x, y] = scene.implant.center_mm;
    let margin = scene.pocket_radius_mm - scene.implant.greatest_half_axis_mm() - x.hypot(y);
    ((1e9 * margin).round() / 1e9).max(0.0)
}

/// Why a parameter has no such value.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ParameterError {
    /// The scene has no such layer.
    #[error("{name}: the scene has {layers} layers; allowed: layers[0] to layers[{}]", layers - 1)]
    NoLayer {
        /// The parameter.
        name: String,
        /// Number of layers.
        layers: usize,
    },
    /// The scene has one layer: no layer follows the thickness of the cover.
    #[error("{0}: the scene has one layer; allowed: layers[0].thickness_mm")]
    OneLayer(String),
    /// The parameter belongs to layered tissue.
    #[error("{0}: the scene is a sheet; allowed: layered tissue")]
    Sheet(String),
    /// The measurement has no effect in this scene.
    #[error("{0}: the measurement determines no value of this scene")]
    NoEffect(String),
    /// A size of the implant is impossible.
    #[error("{0}")]
    Size(#[from] ClinicalError),
    /// A measurement is invalid.
    #[error("{0}")]
    Scene(#[from] SceneError),
    /// The cover is not thicker than the skin.
    #[error("thickness_mm is {} mm; allowed: more than the skin's {} mm", number(*.0), number(*.1))]
    TooThin(f64, f64),
}

/// The scene with parameters set, in the order implant, pocket, tissue, whatever the order of the list. The pocket keeps
/// its margin around an implant that a parameter changes; as the repair of a scene does, the pocket and the patch are
/// enlarged where the implant does not fit. The limits of the scene are not checked.
///
/// # Errors
/// The scene has no such field, or the values give no size of an implant.
pub fn with_values(base: &Scene, values: &[(Parameter, f64)]) -> Result<Scene, ParameterError> {
    let mut scene = base.clone();
    let base_margin = margin(base);
    let of = |wanted: Parameter| values.iter().find(|(p, _)| *p == wanted).map(|(_, value)| *value);
    // The proportions of an anatomical implant, which its sizes keep, and the measurements over it are set after these.
    let late = [Field::BaseHeight, Field::ApexShift, Field::Pinch, Field::SkinPull];
    let is_late = |parameter| late.map(Parameter::of).contains(&parameter);
    for &(parameter, value) in values.iter().filter(|(parameter, _)| !is_late(*parameter)) {
        set(&mut scene, parameter, value)?;
    }
    if let Some(volume) = of(Parameter::Volume) {
        let locked = if of(Parameter::of(Field::Projection)).is_some() {
            Dimension::Projection
        } else {
            Dimension::BaseWidth
        };
        let size = scene.implant.size()?.changed(Dimension::Volume, volume, locked)?;
        scene.implant.set_base_radius(0.5 * size.base_width_mm());
        scene.implant.projection_mm = size.projection_mm();
    }
    for &(parameter, value) in values.iter().filter(|(parameter, _)| is_late(*parameter)) {
        set(&mut scene, parameter, value)?;
    }
    let sets_pocket = of(Parameter::of(Field::PocketRadius)).is_some();
    let moves_implant = values.iter().any(|(parameter, _)| parameter.moves_implant());
    let margin = of(Parameter::PocketMargin).or_else(|| moves_implant.then_some(base_margin));
    if let Some(margin) = margin.filter(|_| !sets_pocket) {
        let radius = scene.implant.least_pocket_mm() + margin;
        // A pocket of the margin may be larger than the largest pocket; a margin that was asked for is not changed.
        let is_wanted = of(Parameter::PocketMargin).is_some();
        let most = if is_wanted { f64::INFINITY } else { limits::POCKET_RADIUS_MAX_MM };
        scene.set_pocket_radius(radius.min(most));
    }
    match of(Parameter::of(Field::PatchRadius)) {
        Some(radius) => scene.body.patch_radius_mm = radius,
        None => scene.widen_patch(),
    }
    scene.drop_reference_of(base);
    Ok(scene)
}

/// Sets one parameter; volume and margin are set after the others.
fn set(scene: &mut Scene, parameter: Parameter, value: f64) -> Result<(), ParameterError> {
    parameter.check(scene)?;
    match parameter {
        Parameter::BaseWidth => scene.implant.set_base_radius(0.5 * value),
        Parameter::Volume | Parameter::PocketMargin => {}
        Parameter::Number(Field::BaseRadius, _) => scene.implant.set_base_radius(value),
        Parameter::Number(Field::PocketRadius, _) => scene.set_pocket_radius(value),
        Parameter::Number(field @ (Field::Pinch | Field::SkinPull), _) => {
            let mut measured = scene.patient.take().map(|patient| patient.measured);
            let measured = measured.get_or_insert_with(Measurements::default);
            if field == Field::Pinch {
                measured.pinch_mm = Some(value);
            } else {
                measured.skin_pull_mm = Some(value);
                measured.skin_class = None;
                // The base width of the person, or of the implant where none was measured.
                let width = 2.0 * scene.implant.base_radius_mm;
                measured.base_width_mm = measured.base_width_mm.or(Some(width));
            }
            let only = Measurements {
                pinch_mm: measured.pinch_mm.filter(|_| field == Field::Pinch),
                skin_pull_mm: measured.skin_pull_mm.filter(|_| field == Field::SkinPull),
                base_width_mm: measured.base_width_mm,
                ..Measurements::default()
            };
            scene.apply_patient(only)?;
            let has_effect = scene.patient.as_ref().is_some_and(|p| !p.derived.is_empty());
            if !has_effect {
                return Err(ParameterError::NoEffect(parameter.name()));
            }
            if let Some(patient) = &mut scene.patient {
                patient.measured = *measured;
            }
        }
        Parameter::Thickness => {
            let skin = scene.layers.first().map_or(0.0, |skin| skin.thickness_mm);
            let below: f64 = scene.layers.iter().skip(1).map(|layer| layer.thickness_mm).sum();
            let factor = (value - skin) / below;
            if factor.is_nan() || factor <= 0.0 {
                return Err(ParameterError::TooThin(value, skin));
            }
            scene.layers.iter_mut().skip(1).for_each(|layer| layer.thickness_mm *= factor);
        }
        // The usual chest in place of a flat one.
        Parameter::Number(field, _) if field.part == Part::Chest => {
            let mut chest = scene.chest.unwrap_or(ChestShape::USUAL);
            chest.set(field, value);
            scene.set_chest(Some(chest));
        }
        Parameter::Number(Field::PocketVoid, _) => scene.body.pocket_void_ml = Some(value),
        Parameter::PoissonRatio => {
            scene.layers.iter_mut().for_each(|layer| layer.poisson_ratio = value);
        }
        Parameter::Number(field, layer) => {
            // The usual torso in place of another chest.
            if field.part == Part::Torso && scene.torso.is_none() {
                scene.set_torso(Torso::default());
            }
            if let Some(place) = field.place(scene, usize::from(layer)) {
                *place = value;
            }
        }
    }
    Ok(())
}

//! The numbers of a scene that a map varies: paths of the scene and a surgeon's names.

use super::quantity::short;
use crate::clinical::{ClinicalError, Dimension, Measurements};
use crate::curve::number;
use crate::scene::field::{self, Change, Field, Part};
use crate::scene::{Body, ChestShape, Scene, SceneError, limits};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A number of a scene, by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(try_from = "String", into = "String")]
#[schemars(with = "String")]
pub enum Parameter {
    /// `base_width_mm`: twice the base radius \[mm\].
    BaseWidth,
    /// `implant.base_radius_mm`.
    BaseRadius,
    /// `projection_mm`, `implant.projection_mm`.
    Projection,
    /// `volume_ml`: changes the projection; on a map over projection and volume the base width \[ml\].
    Volume,
    /// `implant.base_height_mm`.
    BaseHeight,
    /// `implant.apex_shift_mm`.
    ApexShift,
    /// `implant.center_mm[0]`.
    CenterX,
    /// `implant.center_mm[1]`.
    CenterY,
    /// `pocket_margin_mm`: pocket radius less base radius and distance of the implant's centre \[mm\].
    PocketMargin,
    /// `pocket_radius_mm`.
    PocketRadius,
    /// `insertion`.
    Insertion,
    /// `patch_radius_mm`.
    PatchRadius,
    /// `attachment.stiffness_kpa_per_mm`.
    AttachmentStiffness,
    /// `attachment.ramp_mm`.
    AttachmentRamp,
    /// `pinch_mm`: determines the thickness of skin and fat \[mm\].
    Pinch,
    /// `skin_pull_mm`: determines the strain scale of the skin \[mm\].
    SkinPull,
    /// `thickness_mm`, `thickness`: of all layers; the layers below the skin change in proportion \[mm\].
    Thickness,
    /// `poisson_ratio`: of all layers \[-\].
    PoissonRatio,
    /// `strain_scale`: of the skin; `layers[k].curve.strain_scale` \[-\].
    StrainScale(u8),
    /// `stress_scale`: of the skin; `layers[k].curve.stress_scale` \[-\].
    StressScale(u8),
    /// `chest.radius_across_mm`; a flat chest becomes a curved one, straight along the body.
    ChestAcross,
    /// `chest.radius_along_mm`; a flat chest becomes the usual one.
    ChestAlong,
    /// `layers[k].thickness_mm`.
    LayerThickness(u8),
    /// `layers[k].poisson_ratio`.
    LayerPoissonRatio(u8),
}

/// Names without an index, in the order of help and messages.
const NAMES: [(&str, Parameter); 27] = [
    ("base_width_mm", Parameter::BaseWidth),
    ("projection_mm", Parameter::Projection),
    ("volume_ml", Parameter::Volume),
    ("pocket_margin_mm", Parameter::PocketMargin),
    (field::POCKET_RADIUS.path, Parameter::PocketRadius),
    (field::INSERTION.path, Parameter::Insertion),
    ("pinch_mm", Parameter::Pinch),
    ("skin_pull_mm", Parameter::SkinPull),
    ("thickness_mm", Parameter::Thickness),
    ("strain_scale", Parameter::StrainScale(0)),
    ("stress_scale", Parameter::StressScale(0)),
    ("poisson_ratio", Parameter::PoissonRatio),
    (field::BASE_RADIUS.path, Parameter::BaseRadius),
    (field::PROJECTION.path, Parameter::Projection),
    (field::BASE_HEIGHT.path, Parameter::BaseHeight),
    (field::APEX_SHIFT.path, Parameter::ApexShift),
    (field::CENTER_X.path, Parameter::CenterX),
    (field::CENTER_Y.path, Parameter::CenterY),
    (field::PATCH_RADIUS.path, Parameter::PatchRadius),
    (field::ATTACHMENT_STIFFNESS.path, Parameter::AttachmentStiffness),
    (field::ATTACHMENT_RAMP.path, Parameter::AttachmentRamp),
    (field::CHEST_ACROSS.path, Parameter::ChestAcross),
    (field::CHEST_ALONG.path, Parameter::ChestAlong),
    ("thickness", Parameter::Thickness),
    (field::PINCH.path, Parameter::Pinch),
    (field::SKIN_PULL.path, Parameter::SkinPull),
    ("implant.base_width_mm", Parameter::BaseWidth),
];

/// The numbers of a layer, by the index of the layer.
const OF_LAYER: [fn(u8) -> Parameter; 4] = [
    Parameter::LayerThickness,
    Parameter::LayerPoissonRatio,
    Parameter::StrainScale,
    Parameter::StressScale,
];

impl Parameter {
    /// The parameter of a name.
    ///
    /// # Errors
    /// One line with the allowed names.
    pub fn of_name(name: &str) -> Result<Self, String> {
        if let Some((_, parameter)) = NAMES.into_iter().find(|(known, _)| *known == name) {
            return Ok(parameter);
        }
        let of_layer = || {
            let (index, field) = name.strip_prefix("layers[")?.split_once("].")?;
            let layer = index.parse().ok().filter(|k| usize::from(*k) < limits::LAYERS.1)?;
            let is_named =
                |known: &Self| known.row().0.path.strip_prefix("layers[].") == Some(field);
            OF_LAYER.map(|of| of(layer)).into_iter().find(is_named)
        };
        of_layer().ok_or_else(|| {
            let names: Vec<&str> = NAMES[..23].iter().map(|(name, _)| *name).collect();
            let layers = OF_LAYER.map(|of| of(0).row().0.path.replace("[]", "[k]"));
            format!(
                "{:?} is not a field; allowed: {}, {}",
                short(name),
                names.join(", "),
                layers.join(", ")
            )
        })
    }

    /// The shortest name.
    #[must_use]
    pub fn name(self) -> String {
        if let Some((name, _)) = NAMES.into_iter().find(|(_, parameter)| *parameter == self) {
            return name.to_owned();
        }
        let (field, layer) = self.row();
        field.path(layer)
    }

    /// The row of the number that the parameter sets, and its layer; of several layers the first.
    #[must_use]
    pub fn row(self) -> (&'static Field, usize) {
        let (field, layer) = match self {
            Self::BaseWidth | Self::BaseRadius => (field::BASE_RADIUS, 0),
            Self::Projection | Self::Volume => (field::PROJECTION, 0),
            Self::BaseHeight => (field::BASE_HEIGHT, 0),
            Self::ApexShift => (field::APEX_SHIFT, 0),
            Self::CenterX => (field::CENTER_X, 0),
            Self::CenterY => (field::CENTER_Y, 0),
            Self::PocketMargin | Self::PocketRadius => (field::POCKET_RADIUS, 0),
            Self::Insertion => (field::INSERTION, 0),
            Self::PatchRadius => (field::PATCH_RADIUS, 0),
            Self::AttachmentStiffness => (field::ATTACHMENT_STIFFNESS, 0),
            Self::AttachmentRamp => (field::ATTACHMENT_RAMP, 0),
            Self::ChestAcross => (field::CHEST_ACROSS, 0),
            Self::ChestAlong => (field::CHEST_ALONG, 0),
            Self::Pinch => (field::PINCH, 0),
            Self::SkinPull => (field::SKIN_PULL, 0),
            Self::Thickness => (field::THICKNESS, 0),
            Self::PoissonRatio => (field::POISSON_RATIO, 0),
            Self::StrainScale(k) => (field::STRAIN_SCALE, k),
            Self::StressScale(k) => (field::STRESS_SCALE, k),
            Self::LayerThickness(k) => (field::THICKNESS, k),
            Self::LayerPoissonRatio(k) => (field::POISSON_RATIO, k),
        };
        (field, usize::from(layer))
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
            Self::LayerPoissonRatio(_) => return (self.name(), field.unit),
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
            Self::Thickness => scene.layers.iter().map(|layer| layer.thickness_mm).sum(),
            Self::PoissonRatio => {
                let first = scene.layers.first()?.poisson_ratio;
                let is_first = |other: f64| other.to_bits() == first.to_bits();
                let is_common = scene.layers.iter().all(|layer| is_first(layer.poisson_ratio));
                is_common.then_some(first)?
            }
            _ => {
                let (field, layer) = self.row();
                field.value(scene, layer)?
            }
        })
    }

    /// Does the pocket follow the implant when this parameter changes?
    #[must_use]
    pub fn moves_implant(self) -> bool {
        let sizes = [Self::BaseWidth, Self::BaseRadius, Self::BaseHeight, Self::Volume];
        sizes.contains(&self) || matches!(self, Self::CenterX | Self::CenterY)
    }

    /// Do two parameters set the same field? Projection and volume do not: together they set the base width.
    #[must_use]
    pub fn excludes(self, other: Self, scene: &Scene) -> bool {
        let pair = (self, other);
        if matches!(pair, (Self::Projection, Self::Volume) | (Self::Volume, Self::Projection)) {
            return false;
        }
        let others = other.fields(scene);
        self.fields(scene).iter().any(|field| others.contains(field))
    }

    /// The numbers of a scene that the parameter sets; two axes that set the same number exclude each other.
    fn fields(self, scene: &Scene) -> Vec<(&'static Field, usize)> {
        let of_all = |field| (0..scene.layers.len()).map(|layer| (field, layer)).collect();
        match self {
            Self::Pinch | Self::Thickness => of_all(field::THICKNESS),
            Self::SkinPull => vec![(field::STRAIN_SCALE, 0)],
            Self::PoissonRatio => of_all(field::POISSON_RATIO),
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
        let is_chest = matches!(self, Self::ChestAcross | Self::ChestAlong);
        if is_chest && !scene.may_have_chest() || field.part == Part::Body && !scene.is_layered() {
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
    let is_late = |parameter| {
        use Parameter::{ApexShift, BaseHeight, Pinch, SkinPull};
        matches!(parameter, BaseHeight | ApexShift | Pinch | SkinPull)
    };
    for &(parameter, value) in values.iter().filter(|(parameter, _)| !is_late(*parameter)) {
        set(&mut scene, parameter, value)?;
    }
    if let Some(volume) = of(Parameter::Volume) {
        let locked = if of(Parameter::Projection).is_some() {
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
    let sets_pocket = of(Parameter::PocketRadius).is_some();
    let moves_implant = values.iter().any(|(parameter, _)| parameter.moves_implant());
    let margin = of(Parameter::PocketMargin).or_else(|| moves_implant.then_some(base_margin));
    if let Some(margin) = margin.filter(|_| !sets_pocket) {
        let radius = scene.implant.least_pocket_mm() + margin;
        // A pocket of the margin may be larger than the largest pocket; a margin that was asked for is not changed.
        let is_wanted = of(Parameter::PocketMargin).is_some();
        let most = if is_wanted { f64::INFINITY } else { limits::POCKET_RADIUS_MAX_MM };
        scene.set_pocket_radius(radius.min(most));
    }
    if let (Some(radius), Some(body)) = (of(Parameter::PatchRadius), &mut scene.body) {
        body.patch_radius_mm = radius;
    } else if let Some(body) = &mut scene.body {
        let (least, _) = Body::patch_range(scene.pocket_radius_mm);
        body.patch_radius_mm = body.patch_radius_mm.max(least);
    }
    Ok(scene)
}

/// Sets one parameter; volume and margin are set after the others.
fn set(scene: &mut Scene, parameter: Parameter, value: f64) -> Result<(), ParameterError> {
    parameter.check(scene)?;
    match parameter {
        Parameter::BaseWidth => scene.implant.set_base_radius(0.5 * value),
        Parameter::BaseRadius => scene.implant.set_base_radius(value),
        Parameter::PocketRadius => scene.set_pocket_radius(value),
        Parameter::Volume | Parameter::PocketMargin => {}
        Parameter::Pinch | Parameter::SkinPull => {
            let mut measured = scene.patient.take().map(|patient| patient.measured);
            let measured = measured.get_or_insert_with(Measurements::default);
            if parameter == Parameter::Pinch {
                measured.pinch_mm = Some(value);
            } else {
                measured.skin_pull_mm = Some(value);
                measured.skin_class = None;
                // The base width of the person, or of the implant where none was measured.
                let width = 2.0 * scene.implant.base_radius_mm;
                measured.base_width_mm = measured.base_width_mm.or(Some(width));
            }
            let only = Measurements {
                pinch_mm: measured.pinch_mm.filter(|_| parameter == Parameter::Pinch),
                skin_pull_mm: measured.skin_pull_mm.filter(|_| parameter == Parameter::SkinPull),
                base_width_mm: measured.base_width_mm,
                skin_class: None,
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
        Parameter::ChestAcross | Parameter::ChestAlong => {
            let mut chest = scene.chest.unwrap_or(ChestShape::USUAL);
            if parameter == Parameter::ChestAcross {
                chest.radius_across_mm = value;
            } else {
                chest.radius_along_mm = Some(value);
            }
            scene.set_chest(Some(chest));
        }
        Parameter::PoissonRatio => {
            scene.layers.iter_mut().for_each(|layer| layer.poisson_ratio = value);
        }
        _ => {
            let (field, layer) = parameter.row();
            if let Some(place) = field.place(scene, layer) {
                *place = value;
            }
        }
    }
    Ok(())
}

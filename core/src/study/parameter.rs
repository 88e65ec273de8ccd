//! The numbers of a scene that a map varies: paths of the scene and a surgeon's names.

use super::quantity::short;
use crate::clinical::{ClinicalError, Measurements, Size};
use crate::curve::number;
use crate::scene::{Body, Scene, SceneError, limits};
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
    /// `layers[k].thickness_mm`.
    LayerThickness(u8),
    /// `layers[k].poisson_ratio`.
    LayerPoissonRatio(u8),
}

/// What a change of a parameter costs a solver that goes from scene to scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Change {
    /// Neither grid nor tables.
    Dome,
    /// Another grid.
    Grid,
    /// Other tables.
    Tables,
}

/// A field that a parameter sets; two axes that set the same field exclude each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slot {
    Width,
    Projection,
    CenterX,
    CenterY,
    Pocket,
    Insertion,
    Patch,
    Stiffness,
    Ramp,
    Thickness(u8),
    PoissonRatio(u8),
    StrainScale(u8),
    StressScale(u8),
}

/// Names without an index, in the order of help and messages.
const NAMES: [(&str, Parameter); 23] = [
    ("base_width_mm", Parameter::BaseWidth),
    ("projection_mm", Parameter::Projection),
    ("volume_ml", Parameter::Volume),
    ("pocket_margin_mm", Parameter::PocketMargin),
    ("pocket_radius_mm", Parameter::PocketRadius),
    ("insertion", Parameter::Insertion),
    ("pinch_mm", Parameter::Pinch),
    ("skin_pull_mm", Parameter::SkinPull),
    ("thickness_mm", Parameter::Thickness),
    ("strain_scale", Parameter::StrainScale(0)),
    ("stress_scale", Parameter::StressScale(0)),
    ("poisson_ratio", Parameter::PoissonRatio),
    ("implant.base_radius_mm", Parameter::BaseRadius),
    ("implant.projection_mm", Parameter::Projection),
    ("implant.center_mm[0]", Parameter::CenterX),
    ("implant.center_mm[1]", Parameter::CenterY),
    ("patch_radius_mm", Parameter::PatchRadius),
    ("attachment.stiffness_kpa_per_mm", Parameter::AttachmentStiffness),
    ("attachment.ramp_mm", Parameter::AttachmentRamp),
    ("thickness", Parameter::Thickness),
    ("patient.pinch_mm", Parameter::Pinch),
    ("patient.skin_pull_mm", Parameter::SkinPull),
    ("implant.base_width_mm", Parameter::BaseWidth),
];

/// Name of a field of a layer, and its parameter by the index of the layer.
type LayerName = (&'static str, fn(u8) -> Parameter);

/// Fields of a layer.
const LAYER_NAMES: [LayerName; 4] = [
    ("thickness_mm", Parameter::LayerThickness),
    ("poisson_ratio", Parameter::LayerPoissonRatio),
    ("curve.strain_scale", Parameter::StrainScale),
    ("curve.stress_scale", Parameter::StressScale),
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
            let (_, parameter) = LAYER_NAMES.into_iter().find(|(known, _)| *known == field)?;
            Some(parameter(layer))
        };
        of_layer().ok_or_else(|| {
            let names: Vec<&str> = NAMES[..19].iter().map(|(name, _)| *name).collect();
            let layers = LAYER_NAMES.map(|(name, _)| format!("layers[k].{name}"));
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
        let named = |(name, parameter): LayerName| {
            let of = |k| parameter(k) == self;
            let layer = (0..limits::LAYERS.1 as u8).find(|k| of(*k))?;
            Some(format!("layers[{layer}].{name}"))
        };
        LAYER_NAMES.into_iter().find_map(named).unwrap_or_default()
    }

    /// The parameter in words and its unit.
    #[must_use]
    pub fn label(self) -> (String, &'static str) {
        let (words, unit) = match self {
            Self::BaseWidth => ("base width", "mm"),
            Self::BaseRadius => ("base radius", "mm"),
            Self::Projection => ("projection", "mm"),
            Self::Volume => ("volume", "ml"),
            Self::CenterX => ("centre of the implant, x", "mm"),
            Self::CenterY => ("centre of the implant, y", "mm"),
            Self::PocketMargin => ("margin of the pocket", "mm"),
            Self::PocketRadius => ("radius of the pocket", "mm"),
            Self::Insertion => ("insertion", ""),
            Self::PatchRadius => ("radius of the simulated tissue", "mm"),
            Self::AttachmentStiffness => ("stiffness of the attachment", "kPa/mm"),
            Self::AttachmentRamp => ("ramp of the attachment", "mm"),
            Self::Pinch => ("pinch", "mm"),
            Self::SkinPull => ("pull of the skin", "mm"),
            Self::Thickness => ("thickness of the cover", "mm"),
            Self::PoissonRatio => ("Poisson ratio", ""),
            Self::StrainScale(0) => ("strain scale of the skin", ""),
            Self::StressScale(0) => ("stress scale of the skin", ""),
            Self::LayerThickness(0) => ("thickness of the skin", "mm"),
            Self::LayerThickness(_) => return (self.name(), "mm"),
            _ => return (self.name(), ""),
        };
        (words.to_owned(), unit)
    }

    /// The value in a scene; `None` if the scene has no such value.
    #[must_use]
    pub fn value(self, scene: &Scene) -> Option<f64> {
        let implant = &scene.implant;
        let layer = |k: u8| scene.layers.get(usize::from(k));
        let measured = || scene.patient.as_ref().map(|patient| &patient.measured);
        Some(match self {
            Self::BaseWidth => 2.0 * implant.base_radius_mm,
            Self::BaseRadius => implant.base_radius_mm,
            Self::Projection => implant.projection_mm,
            Self::Volume => implant.size().ok()?.volume_ml(),
            Self::CenterX => implant.center_mm[0],
            Self::CenterY => implant.center_mm[1],
            Self::PocketMargin => margin(scene),
            Self::PocketRadius => scene.pocket_radius_mm,
            Self::Insertion => scene.insertion,
            Self::PatchRadius => scene.body?.patch_radius_mm,
            Self::AttachmentStiffness => scene.body?.attachment.stiffness_kpa_per_mm,
            Self::AttachmentRamp => scene.body?.attachment.ramp_mm,
            Self::Pinch => measured()?.pinch_mm?,
            Self::SkinPull => measured()?.skin_pull_mm?,
            Self::Thickness => scene.layers.iter().map(|layer| layer.thickness_mm).sum(),
            Self::PoissonRatio => {
                let first = layer(0)?.poisson_ratio;
                let is_first = |other: f64| other.to_bits() == first.to_bits();
                let is_common = scene.layers.iter().all(|layer| is_first(layer.poisson_ratio));
                is_common.then_some(first)?
            }
            Self::StrainScale(k) => layer(k)?.curve.strain_scale,
            Self::StressScale(k) => layer(k)?.curve.stress_scale,
            Self::LayerThickness(k) => layer(k)?.thickness_mm,
            Self::LayerPoissonRatio(k) => layer(k)?.poisson_ratio,
        })
    }

    /// Does the pocket follow the implant when this parameter changes?
    #[must_use]
    pub fn moves_implant(self) -> bool {
        let sizes = [Self::BaseWidth, Self::BaseRadius, Self::Volume];
        sizes.contains(&self) || matches!(self, Self::CenterX | Self::CenterY)
    }

    /// Do two parameters set the same field? Projection and volume do not: together they set the base width.
    #[must_use]
    pub fn excludes(self, other: Self, scene: &Scene) -> bool {
        let pair = (self, other);
        if matches!(pair, (Self::Projection, Self::Volume) | (Self::Volume, Self::Projection)) {
            return false;
        }
        let slots = other.slots(scene);
        self.slots(scene).iter().any(|slot| slots.contains(slot))
    }

    fn slots(self, scene: &Scene) -> Vec<Slot> {
        let layers = 0..scene.layers.len() as u8;
        match self {
            Self::BaseWidth | Self::BaseRadius => vec![Slot::Width],
            Self::Projection | Self::Volume => vec![Slot::Projection],
            Self::CenterX => vec![Slot::CenterX],
            Self::CenterY => vec![Slot::CenterY],
            Self::PocketMargin | Self::PocketRadius => vec![Slot::Pocket],
            Self::Insertion => vec![Slot::Insertion],
            Self::PatchRadius => vec![Slot::Patch],
            Self::AttachmentStiffness => vec![Slot::Stiffness],
            Self::AttachmentRamp => vec![Slot::Ramp],
            Self::Pinch | Self::Thickness => layers.map(Slot::Thickness).collect(),
            Self::SkinPull => vec![Slot::StrainScale(0)],
            Self::PoissonRatio => layers.map(Slot::PoissonRatio).collect(),
            Self::StrainScale(k) => vec![Slot::StrainScale(k)],
            Self::StressScale(k) => vec![Slot::StressScale(k)],
            Self::LayerThickness(k) => vec![Slot::Thickness(k)],
            Self::LayerPoissonRatio(k) => vec![Slot::PoissonRatio(k)],
        }
    }

    /// The cost of a change.
    pub(super) fn change(self) -> Change {
        match self {
            Self::Projection | Self::Insertion | Self::AttachmentStiffness => Change::Dome,
            Self::Volume | Self::CenterX | Self::CenterY | Self::AttachmentRamp => Change::Grid,
            Self::BaseWidth | Self::BaseRadius => Change::Grid,
            Self::PocketMargin | Self::PocketRadius | Self::PatchRadius => Change::Grid,
            Self::Pinch | Self::SkinPull | Self::Thickness | Self::PoissonRatio => Change::Tables,
            Self::StrainScale(_) | Self::StressScale(_) => Change::Tables,
            Self::LayerThickness(_) | Self::LayerPoissonRatio(_) => Change::Tables,
        }
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

/// Pocket radius less base radius and distance of the implant's centre \[mm\], 0 or more. Rounded to 1e-9 mm, so that the
/// margin is the same for every implant that keeps it.
fn margin(scene: &Scene) -> f64 {
    let [x, y] = scene.implant.center_mm;
    let margin = scene.pocket_radius_mm - scene.implant.base_radius_mm - x.hypot(y);
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
    for &(parameter, value) in values {
        set(&mut scene, parameter, value)?;
    }
    if let Some(volume) = of(Parameter::Volume) {
        let size = match of(Parameter::Projection) {
            Some(projection) => Size::of_projection_and_volume(projection, volume)?,
            None => Size::of_width_and_volume(2.0 * scene.implant.base_radius_mm, volume)?,
        };
        scene.implant.base_radius_mm = 0.5 * size.base_width_mm();
        scene.implant.projection_mm = size.projection_mm();
    }
    let sets_pocket = of(Parameter::PocketRadius).is_some();
    let moves_implant = values.iter().any(|(parameter, _)| parameter.moves_implant());
    let margin = of(Parameter::PocketMargin).or_else(|| moves_implant.then_some(base_margin));
    if let Some(margin) = margin.filter(|_| !sets_pocket) {
        let [x, y] = scene.implant.center_mm;
        let radius = scene.implant.base_radius_mm + x.hypot(y) + margin;
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

/// Sets one parameter; volume, margin and patch are set after the others.
fn set(scene: &mut Scene, parameter: Parameter, value: f64) -> Result<(), ParameterError> {
    let count = scene.layers.len();
    let name = || parameter.name();
    match parameter {
        Parameter::BaseWidth => scene.implant.base_radius_mm = 0.5 * value,
        Parameter::BaseRadius => scene.implant.base_radius_mm = value,
        Parameter::Projection => scene.implant.projection_mm = value,
        Parameter::CenterX => scene.implant.center_mm[0] = value,
        Parameter::CenterY => scene.implant.center_mm[1] = value,
        Parameter::PocketRadius => scene.set_pocket_radius(value),
        Parameter::Insertion => scene.insertion = value,
        Parameter::Volume | Parameter::PocketMargin => {}
        Parameter::PatchRadius | Parameter::AttachmentStiffness | Parameter::AttachmentRamp => {
            let is_layered = scene.is_layered();
            let body = scene.body.as_mut().filter(|_| is_layered);
            let body = body.ok_or_else(|| ParameterError::Sheet(name()))?;
            match parameter {
                Parameter::AttachmentStiffness => body.attachment.stiffness_kpa_per_mm = value,
                Parameter::AttachmentRamp => body.attachment.ramp_mm = value,
                _ => {}
            }
        }
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
                return Err(ParameterError::NoEffect(name()));
            }
            if let Some(patient) = &mut scene.patient {
                patient.measured = *measured;
            }
        }
        Parameter::Thickness => {
            let skin = scene.layers.first().map_or(0.0, |skin| skin.thickness_mm);
            let below: f64 = scene.layers.iter().skip(1).map(|layer| layer.thickness_mm).sum();
            if count < 2 {
                return Err(ParameterError::OneLayer(name()));
            }
            let factor = (value - skin) / below;
            if factor.is_nan() || factor <= 0.0 {
                return Err(ParameterError::TooThin(value, skin));
            }
            scene.layers.iter_mut().skip(1).for_each(|layer| layer.thickness_mm *= factor);
        }
        Parameter::PoissonRatio => {
            scene.layers.iter_mut().for_each(|layer| layer.poisson_ratio = value);
        }
        Parameter::StrainScale(k)
        | Parameter::StressScale(k)
        | Parameter::LayerThickness(k)
        | Parameter::LayerPoissonRatio(k) => {
            let layer = scene.layers.get_mut(usize::from(k));
            let layer =
                layer.ok_or_else(|| ParameterError::NoLayer { name: name(), layers: count })?;
            match parameter {
                Parameter::StrainScale(_) => layer.curve.strain_scale = value,
                Parameter::StressScale(_) => layer.curve.stress_scale = value,
                Parameter::LayerThickness(_) => layer.thickness_mm = value,
                _ => layer.poisson_ratio = value,
            }
        }
    }
    Ok(())
}

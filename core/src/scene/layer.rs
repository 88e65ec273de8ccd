//! One layer of tissue, and its format in a file.

use super::Scene;
use crate::curve::{Curve, CurveError, CurveSpec, Fat, GivenCurve, ScaledCurve, given, present};
use crate::springs::Material;
use crate::tensile;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// One tissue layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(from = "LayerFile")]
#[schemars(with = "LayerFile")]
pub struct Layer {
    /// Free text; `skin`, `adipose` and `muscle` have colours of their own.
    pub tissue: String,
    /// Thickness at rest \[mm\], 0.2 to 60.
    pub thickness_mm: f64,
    /// Poisson ratio ν \[-\], 0 to 0.5.
    pub poisson_ratio: f64,
    /// Stress–strain curve.
    pub curve: ScaledCurve,
}

/// A layer in a file; a field that the file does not contain is `None`.
#[derive(Clone, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "one JSON object")]
#[schemars(rename = "Layer")]
pub(super) struct LayerFile {
    /// Free text; `skin`, `adipose` and `muscle` have colours of their own.
    #[serde(default = "default_tissue", deserialize_with = "present")]
    tissue: String,
    /// Thickness at rest \[mm\], 0.2 to 60. Default: from `patient`, or 1.5.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "f64")]
    pub(super) thickness_mm: Option<f64>,
    /// Poisson ratio ν \[-\], 0 to 0.5.
    #[serde(default = "default_poisson_ratio", deserialize_with = "present")]
    poisson_ratio: f64,
    /// Stress–strain curve. Default: the skin preset.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "ScaledCurve")]
    curve: Option<GivenCurve>,
}

impl From<LayerFile> for Layer {
    fn from(file: LayerFile) -> Self {
        Self {
            tissue: file.tissue,
            thickness_mm: file.thickness_mm.unwrap_or(DEFAULT_THICKNESS_MM),
            poisson_ratio: file.poisson_ratio,
            curve: file.curve.map_or_else(|| CurveSpec::Skin {}.into(), ScaledCurve::from),
        }
    }
}

impl LayerFile {
    /// The strain scale, if the file contains the field.
    pub(super) fn strain_scale(&self) -> Option<f64> {
        self.curve.as_ref().and_then(|curve| curve.strain_scale)
    }
}

/// Thickness of a layer without a thickness \[mm\].
const DEFAULT_THICKNESS_MM: f64 = 1.5;

fn default_tissue() -> String {
    "skin".to_owned()
}

fn default_poisson_ratio() -> f64 {
    0.45
}

/// The layers of a scene without layers.
pub(super) fn default_layers() -> Vec<Layer> {
    vec![Layer::skin(), Layer::adipose()]
}

impl Layer {
    /// The material of a valid curve.
    pub(super) fn material(&self) -> Result<Material, CurveError> {
        Ok(Material::new(Curve::scaled(&self.curve)?, self.poisson_ratio, self.thickness_mm))
    }

    /// Skin, 1.5 mm, ν = 0.45.
    #[must_use]
    pub fn skin() -> Self {
        Self {
            tissue: default_tissue(),
            thickness_mm: DEFAULT_THICKNESS_MM,
            poisson_ratio: default_poisson_ratio(),
            curve: CurveSpec::Skin {}.into(),
        }
    }

    /// Adipose as measured, 10 mm: curve `fat`, ν = 0.49.
    #[must_use]
    pub fn adipose() -> Self {
        Self {
            tissue: ADIPOSE.to_owned(),
            thickness_mm: 10.0,
            poisson_ratio: 0.49,
            curve: CurveSpec::Fat { variant: Fat::Mid }.into(),
        }
    }

    /// The paper's adipose, 10 mm: curve `adipose`, ν = 0.45.
    #[must_use]
    pub fn paper_adipose() -> Self {
        Self {
            poisson_ratio: default_poisson_ratio(),
            curve: CurveSpec::Adipose {}.into(),
            ..Self::adipose()
        }
    }

    /// A sentence on a curve of points whose unit may be another one.
    fn curve_warning(&self) -> Option<String> {
        let CurveSpec::Points { .. } = self.curve.spec else { return None };
        tensile::unlikely(&Curve::scaled(&self.curve).ok()?, &self.tissue)
    }
}

impl Scene {
    /// Sentences on curves of points whose unit may be another one.
    pub(crate) fn curve_warnings(&self) -> Vec<String> {
        self.layers.iter().filter_map(Layer::curve_warning).collect()
    }
}

/// The name of a tissue as surgeons read it: fat for adipose, the name in files.
#[must_use]
pub fn tissue_in_words(tissue: &str) -> &str {
    if tissue == ADIPOSE { "fat" } else { tissue }
}

/// Name of the tissue between skin and implant that a pinch measures.
pub(super) const ADIPOSE: &str = "adipose";

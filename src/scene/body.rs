//! What a scene of layered tissue adds: the tissue model, the patch around the pocket, its attachment to the wall.

use super::limits;
use crate::mesh::{Attachment, Edge, Patch};
use crate::model::layered::automatic_cells;
use crate::solve::Tissue;
use crate::springs::Material;
use schemars::JsonSchema;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// How the tissue is modelled.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum TissueModel {
    /// The skin is a membrane on solid layers, which are attached to the wall beyond the pocket.
    #[default]
    Layered,
    /// All layers are one membrane, clamped at the pocket's edge.
    Sheet,
}

/// The fields of a scene that `scene/2` adds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Body {
    /// The tissue model.
    pub tissue_model: TissueModel,
    /// Radius of the simulated tissue \[mm\]; its edge is clamped.
    pub patch_radius_mm: f64,
    /// What holds the inner face beyond the pocket.
    pub attachment: AttachmentSettings,
}

/// Springs between the inner face beyond the pocket and the wall.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "one JSON object")]
pub struct AttachmentSettings {
    /// Stiffness per area \[kPa/mm\], 0.1 to 50.
    pub stiffness_kpa_per_mm: f64,
    /// Width over which the stiffness rises from zero at the pocket's edge \[mm\], 1 to 40.
    pub ramp_mm: f64,
}

impl Default for AttachmentSettings {
    fn default() -> Self {
        Self { stiffness_kpa_per_mm: 2.0, ramp_mm: 10.0 }
    }
}

/// Cells through the thickness of the solid layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CellsThrough {
    /// Chosen from the thickness.
    #[default]
    Auto,
    /// This number, 1 to 8; each solid layer has one at least.
    Count(usize),
}

impl Serialize for CellsThrough {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Auto => to.serialize_str("auto"),
            Self::Count(count) => to.serialize_u64(*count as u64),
        }
    }
}

impl<'de> Deserialize<'de> for CellsThrough {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl serde::de::Visitor<'_> for Visitor {
            type Value = CellsThrough;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("\"auto\" or a whole number from 1 to 8")
            }
            fn visit_u64<E: serde::de::Error>(self, count: u64) -> Result<CellsThrough, E> {
                match usize::try_from(count) {
                    Ok(count @ 1..=8) => Ok(CellsThrough::Count(count)),
                    _ => Err(E::invalid_value(serde::de::Unexpected::Unsigned(count), &self)),
                }
            }
            fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<CellsThrough, E> {
                match text {
                    "auto" => Ok(CellsThrough::Auto),
                    _ => Err(E::invalid_value(serde::de::Unexpected::Str(text), &self)),
                }
            }
        }
        from.deserialize_any(Visitor)
    }
}

impl JsonSchema for CellsThrough {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "CellsThrough".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({
            "description": "Cells through the thickness of the solid layers.",
            "anyOf": [{ "const": "auto" }, { "type": "integer", "minimum": 1, "maximum": 8 }],
        })
    }
}

/// Width of the patch around the pocket by default \[mm\].
const MARGIN_MM: f64 = 60.0;
/// The least width of the patch around the pocket \[mm\].
const LEAST_MARGIN_MM: f64 = 20.0;

impl Body {
    /// The default body around a pocket.
    #[must_use]
    pub fn around(pocket_radius_mm: f64, tissue_model: TissueModel) -> Self {
        Self {
            tissue_model,
            patch_radius_mm: (pocket_radius_mm + MARGIN_MM).min(limits::PATCH_RADIUS_MAX_MM),
            attachment: AttachmentSettings::default(),
        }
    }

    /// Range of the patch's radius around a pocket \[mm\].
    #[must_use]
    pub fn patch_range(pocket_radius_mm: f64) -> (f64, f64) {
        let most = limits::PATCH_RADIUS_MAX_MM;
        ((pocket_radius_mm + LEAST_MARGIN_MM).min(most), most)
    }

    /// The patch of layered tissue.
    pub(super) fn patch(&self, pocket_radius_mm: f64) -> Patch {
        let AttachmentSettings { stiffness_kpa_per_mm, ramp_mm } = self.attachment;
        Patch {
            radius_mm: self.patch_radius_mm,
            pocket_radius_mm,
            edge: Edge::Attached(Attachment { stiffness_kpa_per_mm, ramp_mm }),
        }
    }
}

impl CellsThrough {
    /// Layered tissue of these materials.
    pub(super) fn tissue(self, materials: &[Material]) -> Tissue {
        let cells_through = match self {
            Self::Auto => automatic_cells(materials),
            Self::Count(count) => count,
        };
        Tissue::Layered { cells_through }
    }
}

//! What a scene of layered tissue adds: the tissue model, the patch around the pocket, its attachment to the wall.

use super::{Field, Plane, Posture, Scene, SceneError, SkinState, field, limits, out_of_range};
use crate::curve::{Curve, whole_of};
use crate::mesh::{Attachment, Edge, Patch, balanced_cells};
use crate::springs::Springs;
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

/// Tissue model, patch and attachment of a scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Body {
    /// The tissue model.
    pub tissue_model: TissueModel,
    /// Radius of the simulated tissue \[mm\]; its edge is clamped.
    pub patch_radius_mm: f64,
    /// What holds the inner face beyond the pocket.
    pub attachment: Attachment,
    /// The tension of the skin at rest.
    #[serde(skip_serializing_if = "is_default")]
    pub skin_state: SkinState,
    /// The plane of the pocket; `None`: above the muscle, or below an innermost layer that is as the others.
    #[serde(rename = "pocket_plane", skip_serializing_if = "Option::is_none")]
    pub plane: Option<Plane>,
    /// How much lower than the circle the pocket's lower edge is, the new fold below the old one \[mm\].
    #[serde(skip_serializing_if = "is_default")]
    pub pocket_lowered_mm: f64,
    /// Greatest void between tissue, implant and wall within the pocket \[ml\]; `None`: as large as it gets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub pocket_void_ml: Option<f64>,
    /// The posture in which the body is shown; it was measured standing.
    #[serde(skip_serializing_if = "is_default")]
    pub posture: Posture,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Cells through the thickness of the solid layers.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CellsThrough {
    /// Chosen so that the error through the thickness is about that of the grid.
    #[default]
    Auto,
    /// This number, 1 to 8 in layered tissue; each solid layer has one at least.
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
                // The limits are checked with all others: a sheet ignores the number.
                u32::try_from(count)
                    .map(|count| CellsThrough::Count(count as usize))
                    .map_err(|_| E::invalid_value(serde::de::Unexpected::Unsigned(count), &self))
            }
            fn visit_f64<E: serde::de::Error>(self, count: f64) -> Result<CellsThrough, E> {
                let whole = whole_of(count)
                    .ok_or_else(|| E::invalid_value(serde::de::Unexpected::Float(count), &self))?;
                self.visit_u64(whole)
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
            attachment: Attachment::default(),
            skin_state: SkinState::default(),
            plane: None,
            pocket_lowered_mm: 0.0,
            pocket_void_ml: None,
            posture: Posture::None,
        }
    }

    /// Range of the patch's radius around a pocket that reaches so far from its centre \[mm\].
    #[must_use]
    pub fn patch_range(pocket_reach_mm: f64) -> (f64, f64) {
        let most = limits::PATCH_RADIUS_MAX_MM;
        ((pocket_reach_mm + LEAST_MARGIN_MM).min(most), most)
    }

    /// The patch of layered tissue.
    pub(super) fn patch(&self, pocket_radius_mm: f64) -> Patch {
        Patch {
            radius_mm: self.patch_radius_mm,
            pocket_radius_mm,
            pocket_lowered_mm: self.pocket_lowered_mm,
            edge: Edge::Attached(self.attachment),
        }
    }
}

impl Scene {
    /// Is the tissue layered?
    #[must_use]
    pub fn is_layered(&self) -> bool {
        self.body.tissue_model == TissueModel::Layered
    }

    /// Greatest distance of the pocket's edge from its centre \[mm\]; a sheet's pocket is round.
    #[must_use]
    pub fn pocket_reach_mm(&self) -> f64 {
        self.pocket_radius_mm + self.body.pocket_lowered_mm
    }

    /// Strain at which the curve of the skin turns steep \[-\], the skin's reserve ([`Curve::knee`]); `None` for a sheet, or a
    /// skin whose curve does not stiffen so far.
    #[must_use]
    pub fn skin_knee(&self) -> Option<f64> {
        let skin = self.layers.first().filter(|_| self.is_layered())?;
        Curve::scaled(&skin.curve).ok()?.knee()
    }

    /// Sets the tissue model. Layered tissue has the coupled springs, and
    /// its patch, attachment and cells are moved into their limits, which a sheet does not check. A sheet has a flat chest,
    /// layers of even thickness and no natural tension.
    pub fn set_tissue_model(&mut self, tissue_model: TissueModel) {
        self.body.tissue_model = tissue_model;
        if tissue_model == TissueModel::Sheet {
            self.set_chest(None);
            self.thickness_field = None;
            self.body.plane = None;
            self.body.pocket_lowered_mm = 0.0;
            self.body.pocket_void_ml = None;
            self.body.skin_state = SkinState::default();
        }
        if tissue_model == TissueModel::Layered {
            for number in field::of_body() {
                number.set(self, 0, number.value(self, 0).unwrap_or_default());
            }
            if let Some(CellsThrough::Count(count)) = &mut self.solver.cells_through {
                let (least, most) = limits::CELLS_THROUGH;
                *count = (*count).clamp(least, most);
            }
            self.springs = Springs::Coupled;
        }
    }

    /// Sets the springs; the paper's springs make layered tissue a sheet.
    pub fn set_springs(&mut self, springs: Springs) {
        if springs == Springs::Nikolaev && self.is_layered() {
            self.set_tissue_model(TissueModel::Sheet);
        }
        self.springs = springs;
    }

    /// Checks cells and springs of layered tissue.
    pub(super) fn check_body(&self) -> Result<(), SceneError> {
        self.check_skin_state()?;
        self.check_plane()?;
        if !self.is_layered() {
            let refused = |field: Field| {
                Err(out_of_range(field.path, "given".to_owned(), "in layered tissue only"))
            };
            return match self.body {
                Body { pocket_void_ml: Some(_), .. } => refused(Field::PocketVoid),
                body if body.pocket_lowered_mm > 0.0 => refused(Field::PocketLowered),
                _ => Ok(()),
            };
        }
        let (least, most) = limits::CELLS_THROUGH;
        if let Some(CellsThrough::Count(count)) = self.solver.cells_through
            && !(least..=most).contains(&count)
        {
            let allowed = format!("\"auto\" or {least} to {most}");
            return Err(out_of_range("solver.cells_through", count.to_string(), &allowed));
        }
        if self.springs == Springs::Nikolaev {
            return Err(out_of_range(
                "springs",
                "nikolaev".to_owned(),
                "coupled in layered tissue, the default; nikolaev with tissue_model sheet",
            ));
        }
        Ok(())
    }
}

/// Least number of automatic cells through tissue of uneven thickness: on a torso, 7 to 65 mm thick over the pocket, three cells give
/// the force within 0.4 % and the skin within 0.1 % of the base radius of eight cells, two within 1 % and 0.3 %.
const LEAST_UNEVEN: usize = 3;

impl CellsThrough {
    /// The number for solids of these thicknesses \[mm\], times a factor from the least in the pocket to the greatest: automatic as
    /// many as the thinnest place needs, where the implant presses most, and [`LEAST_UNEVEN`].
    pub(super) fn count(
        self,
        solids_mm: &[f64],
        [least, greatest]: [f64; 2],
        spacing_mm: f64,
    ) -> usize {
        let balanced = |factor: f64| {
            let solids_mm: Vec<f64> = solids_mm.iter().map(|solid| solid * factor).collect();
            balanced_cells(&solids_mm, spacing_mm)
        };
        match self {
            Self::Auto => balanced(least).max(LEAST_UNEVEN).min(balanced(greatest)),
            Self::Count(count) => count,
        }
    }
}

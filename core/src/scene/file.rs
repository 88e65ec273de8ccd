//! The members of a scene: in memory and as they are written, by default, in a file, whose fields are optional.

use super::chest_grid::BOTH;
use super::implant::{ImplantFile, Named};
use super::layer::{LayerFile, default_layers};
use super::patient::PatientFile;
use super::plane::{Muscle, PlaneFile};
use super::{
    Body, CheckedScene, ChestGrid, ChestShape, HeightsGrid, Implant, Layer, Patient, Placement,
    Posture, SCENE_SCHEMA, SceneError, Side, SkinState, SolverSettings, ThicknessGrid, TissueModel,
    Torso, Visit, limits, one_line, patient, pins, problem, torso,
};
use crate::clinical::When;
use crate::curve::{List, given, given_object, object, present, present_object};
use crate::mesh::Attachment;
use crate::springs::Springs;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{Error, IgnoredAny};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use serde_json::{Map, Value};
use std::borrow::Cow;

/// A scene: one implant in one pocket under a stack of tissue layers.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(remote = "Self")]
pub struct Scene {
    /// The dome.
    #[serde(skip)]
    pub implant: Implant,
    /// The maker's name of the implant's size, up to 60 characters in one line, in a file `reference` in `implant`; empty: not stated. No
    /// result depends on it.
    #[serde(skip)]
    pub implant_reference: String,
    /// Radius a of the surgeon's pocket \[mm\]: a sheet is clamped on this circle.
    pub pocket_radius_mm: f64,
    /// Tissue model and patch.
    #[serde(flatten)]
    pub body: Body,
    /// The chest wall; `None`: flat. Layered tissue only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chest: Option<ChestShape>,
    /// The chest by the built-in torso, instead of radii: in a file `torso` in `chest`.
    #[serde(
        rename = "chest",
        skip_serializing_if = "Option::is_none",
        serialize_with = "torso::written"
    )]
    pub torso: Option<Torso>,
    /// The chest wall by a grid of heights, instead of radii: in a file `grid` in `chest`.
    #[serde(rename = "chest", skip_serializing_if = "Option::is_none")]
    pub chest_grid: Option<ChestGrid>,
    /// Insertion t \[-\], 0 (flat) to 1 (full height).
    pub insertion: f64,
    /// Layers from the skin inwards, 1 to 8.
    pub layers: Vec<Layer>,
    /// Factors of the thickness of all solid layers from place to place; `None`: even. Layered tissue only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub thickness_field: Option<ThicknessGrid>,
    /// Measurements of a person, and the fields that were derived from them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub patient: Option<Patient>,
    /// The patient's side of the breast; `None`: not stated, drawn as a left one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub side: Option<Side>,
    /// Patient and visit in words; no result depends on the visit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub visit: Option<Visit>,
    /// The place on a body's surface, in a file `body`; no result depends on it.
    #[serde(rename = "body", skip_serializing_if = "Option::is_none")]
    pub placement: Option<Box<Placement>>,
    /// The plan of the other side; `None`: both sides have this one. In a file what differs from this scene.
    #[serde(skip)]
    pub other_side: Option<Box<Scene>>,
    /// The spring law.
    pub springs: Springs,
    /// Grid and tolerance.
    pub solver: SolverSettings,
}

impl Default for Scene {
    /// The scene of the defaults of a file: a 55 mm hemisphere fully under layered skin and fat.
    fn default() -> Self {
        let pocket_radius_mm = 70.0;
        Self {
            implant: Implant { base_radius_mm: 55.0, projection_mm: 55.0, ..Implant::default() },
            implant_reference: String::new(),
            pocket_radius_mm,
            body: Body::around(pocket_radius_mm, TissueModel::Layered),
            chest: None,
            torso: None,
            chest_grid: None,
            insertion: full_insertion(),
            layers: default_layers(),
            thickness_field: None,
            patient: None,
            side: None,
            visit: None,
            placement: None,
            other_side: None,
            springs: Springs::default(),
            solver: SolverSettings::default(),
        }
    }
}

impl Serialize for Scene {
    /// Writes the schema, the implant with its reference, the other members in their order, then the other side.
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        #[derive(Serialize)]
        struct Written<'a> {
            schema: &'static str,
            implant: Named<'a>,
            #[serde(flatten, serialize_with = "Scene::serialize")]
            others: &'a Scene,
            #[serde(skip_serializing_if = "Option::is_none")]
            other_side: Option<Map<String, Value>>,
        }
        let implant =
            Named { implant: self.implant.in_few_words(), reference: &self.implant_reference };
        let other_side = self.other_side_written();
        Written { schema: SCENE_SCHEMA, implant, others: self, other_side }.serialize(to)
    }
}

impl<'de> Deserialize<'de> for Scene {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        let scene = SceneFile::deserialize(from)?.filled().and_then(CheckedScene::new);
        scene.map(CheckedScene::into_scene).map_err(D::Error::custom)
    }
}

/// A scene in a file; fields with a default are optional.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "one JSON object")]
#[schemars(rename = "Scene")]
pub(super) struct SceneFile {
    /// `implant-preview/scene/1`, the default.
    #[serde(default, rename = "schema", deserialize_with = "known_schema")]
    #[schemars(with = "String")]
    _schema: (),
    /// Any JSON value; no computation depends on it. The command line copies it to the result.
    #[serde(default, rename = "id")]
    #[schemars(with = "serde_json::Value")]
    _id: IgnoredAny,
    #[serde(deserialize_with = "object")]
    pub(super) implant: ImplantFile,
    /// Default: base radius + distance of the centre + 15 mm (at most 200 mm).
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "f64")]
    pub(super) pocket_radius_mm: Option<f64>,
    /// Default: layered.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "TissueModel")]
    pub(super) tissue_model: Option<TissueModel>,
    /// Radius of the simulated tissue \[mm\], pocket + 20 to 260. Default: pocket + 60, at most 260.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "f64")]
    pub(super) patch_radius_mm: Option<f64>,
    #[serde(default, deserialize_with = "given_object")]
    pub(super) attachment: Option<Attachment>,
    /// Of layered tissue: tension of the skin at rest. Default: none.
    #[serde(default, deserialize_with = "given_object")]
    pub(super) skin_state: Option<SkinState>,
    /// Of layered tissue: the plane of the pocket, below a muscle that is the innermost layer; added where the layers end without one. Default: `above`
    /// the muscle.
    #[serde(default, deserialize_with = "present")]
    pub(super) pocket_plane: PlaneFile,
    /// The muscle that a `pocket_plane` adds. A written scene has it as its innermost layer.
    #[serde(default, deserialize_with = "given_object")]
    pub(super) muscle: Option<Muscle>,
    /// Of layered tissue: how much lower than the circle the pocket's lower edge is, the new fold below the old one \[mm\], 0 to 40. Default: 0.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "f64")]
    pub(super) pocket_lowered_mm: Option<f64>,
    /// Of layered tissue: greatest void between tissue, implant and wall within the pocket \[ml\], 0 to 200. Default: as large as it gets.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "f64")]
    pub(super) pocket_void_ml: Option<f64>,
    /// Direction of weight: of an implant that yields, and of the tissue, which was measured standing. Default: `none`, no weight.
    #[serde(default, deserialize_with = "present")]
    pub(super) posture: Posture,
    /// Time after the operation, in place of `skin_state.relaxed` and `skin_state.grown`. A written scene has those.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "When")]
    pub(super) when: Option<When>,
    /// Of layered tissue: the chest wall. Default: flat.
    #[serde(default, deserialize_with = "given_object")]
    pub(super) chest: Option<ChestFile>,
    #[serde(default = "full_insertion", deserialize_with = "present")]
    pub(super) insertion: f64,
    /// Default: skin and adipose, whose curve is `fat` and whose ν is 0.49.
    #[serde(default, deserialize_with = "layers")]
    #[schemars(with = "Vec<LayerFile>")]
    pub(super) layers: Option<Vec<LayerFile>>,
    /// Of layered tissue: factors of the thickness of all solid layers. Default: even.
    #[serde(default, deserialize_with = "given_object")]
    pub(super) thickness_field: Option<ThicknessGrid>,
    /// What was measured on a person.
    #[serde(default, deserialize_with = "given_object")]
    pub(super) patient: Option<PatientFile>,
    /// The patient's side of the breast. Default: drawn as `left`.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "Side")]
    pub(super) side: Option<Side>,
    /// Reference, date of the visit, surgeon, remarks; a computation ignores them.
    #[serde(default, deserialize_with = "given_object")]
    pub(super) visit: Option<Visit>,
    /// The place of the scene on a body's surface, as `scan` writes it; a computation ignores it.
    #[serde(default, deserialize_with = "given_object")]
    #[schemars(with = "Placement")]
    pub(super) body: Option<Placement>,
    /// The plan of the other side where it differs: a scene without `side`, `visit` and `pins`, whose other missing fields are those of this scene.
    #[serde(default, deserialize_with = "pins::boxed_or_none")]
    #[schemars(with = "SceneFile")]
    pub(super) other_side: Option<Box<SceneFile>>,
    #[serde(default, deserialize_with = "present")]
    pub(super) springs: Springs,
    #[serde(default, deserialize_with = "present_object")]
    pub(super) solver: SolverSettings,
    /// Up to 4 scenes for comparison; a computation ignores them.
    #[serde(default, deserialize_with = "pins::list")]
    #[schemars(with = "Vec<pins::PinFile>")]
    pub(super) pins: Option<Vec<pins::PinFile>>,
}

/// The chest wall by radii, by a grid or by the built-in torso.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "one JSON object")]
#[schemars(rename = "Chest")]
pub(super) struct ChestFile {
    /// Radius across the body, along x \[mm\]; negative: hollow.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "f64")]
    radius_across_mm: Option<f64>,
    /// Radius along the body, along y \[mm\]; absent or null: straight, negative: hollow.
    radius_along_mm: Option<f64>,
    /// Heights over a plane, instead of radii.
    #[serde(default, deserialize_with = "given_object")]
    grid: Option<HeightsGrid>,
    /// The built-in torso, shaped by a tape, instead of radii and `thickness_field`. Missing numbers are those of a small breast.
    #[serde(default, deserialize_with = "given_object")]
    torso: Option<Torso>,
}

/// Radii, torso and grid of a chest, one of them.
type Wall = (Option<ChestShape>, Option<Torso>, Option<ChestGrid>);

impl ChestFile {
    fn wall(self) -> Result<Wall, SceneError> {
        let Self { radius_across_mm, radius_along_mm, grid, torso } = self;
        match (radius_across_mm, grid, torso) {
            (Some(radius_across_mm), None, None) => {
                Ok((Some(ChestShape { radius_across_mm, radius_along_mm }), None, None))
            }
            (None, Some(grid), None) if radius_along_mm.is_none() => {
                Ok((None, None, Some(ChestGrid { grid })))
            }
            (None, None, Some(torso)) if radius_along_mm.is_none() => Ok((None, Some(torso), None)),
            (None, None, None) => {
                Err(problem("chest", "missing field `radius_across_mm`, `grid` or `torso`"))
            }
            (_, _, Some(_)) => {
                Err(problem("chest", "torso beside radii or a grid; allowed: one of them"))
            }
            _ => Err(problem("chest", BOTH)),
        }
    }
}

fn layers<'de, D: Deserializer<'de>>(reader: D) -> Result<Option<Vec<LayerFile>>, D::Error> {
    #[derive(Deserialize)]
    struct Entry(#[serde(deserialize_with = "object")] LayerFile);
    let list: List<Entry, { limits::LAYERS.1 }> = present(reader)?;
    Ok(Some(list.0.into_iter().map(|entry| entry.0).collect()))
}

/// Reads the schema, the only one.
fn known_schema<'de, D: Deserializer<'de>>(reader: D) -> Result<(), D::Error> {
    let schema: String = present(reader)?;
    if schema == SCENE_SCHEMA {
        return Ok(());
    }
    let schema = one_line(&format!("{schema:?}"), 40);
    Err(D::Error::custom(format!("is {schema}; allowed: {SCENE_SCHEMA}")))
}

fn full_insertion() -> f64 {
    1.0
}

impl JsonSchema for Scene {
    fn schema_name() -> Cow<'static, str> {
        SceneFile::schema_name()
    }

    /// A scene as it is read, in files that are written too: fields with a default are optional.
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut reader = SchemaGenerator::default();
        let schema = SceneFile::json_schema(&mut reader);
        generator.definitions_mut().extend(reader.take_definitions(false));
        schema
    }
}

/// The state of the skin at the time of a file.
fn skin_state(given: SkinState, when: Option<When>) -> Result<SkinState, SceneError> {
    let Some(when) = when else { return Ok(given) };
    if given != given.at(When::OnTheTable) {
        return Err(problem(
            "when",
            "given with skin_state.relaxed or skin_state.grown; allowed: one of them",
        ));
    }
    Ok(given.at(when))
}

impl SceneFile {
    /// Fills omitted fields with defaults; checks the pins and drops them.
    ///
    /// # Errors
    /// An invalid pin, volume or patient; all other checks are those of [`CheckedScene::new`].
    pub(super) fn filled(self) -> Result<Scene, SceneError> {
        let mut file = self;
        file.take_pins()?;
        let other_side = file.other_side.take();
        let mut scene = file.filled_beside(None)?;
        if let Some(other_side) = other_side {
            scene.read_other_side(*other_side)?;
        }
        Ok(scene)
    }

    /// Fills omitted fields: those of a side with the numbers `beside` it, else with defaults.
    pub(super) fn filled_beside(self, beside: Option<&Scene>) -> Result<Scene, SceneError> {
        let file = self;
        let implant = file.implant.shape()?;
        let pocket_radius_mm = file.pocket_radius_mm.or(beside.map(|it| it.pocket_radius_mm));
        let pocket_radius_mm = pocket_radius_mm.unwrap_or_else(|| {
            (implant.least_pocket_mm() + 15.0).min(limits::POCKET_RADIUS_MAX_MM)
        });
        let default = Body::around(pocket_radius_mm, file.tissue_model.unwrap_or_default());
        let patch_radius_mm = file.patch_radius_mm.or(beside.map(|it| it.body.patch_radius_mm));
        let body = Body {
            patch_radius_mm: patch_radius_mm.unwrap_or(default.patch_radius_mm),
            attachment: file.attachment.unwrap_or_default(),
            skin_state: skin_state(file.skin_state.unwrap_or_default(), file.when)?,
            plane: file.pocket_plane.into(),
            pocket_lowered_mm: file
                .pocket_lowered_mm
                .or(beside.map(|it| it.body.pocket_lowered_mm))
                .unwrap_or_default(),
            pocket_void_ml: file.pocket_void_ml,
            posture: file.posture,
            ..default
        };
        // For each layer of the file the fields that a patient may fill.
        let given = file.layers.iter().flatten().map(patient::Given::of).collect::<Vec<_>>();
        let layers = match (file.layers, beside) {
            (Some(layers), _) => layers.into_iter().map(Layer::from).collect(),
            (None, Some(beside)) => beside.layers.clone(),
            (None, None) => default_layers(),
        };
        let (chest, torso, mut chest_grid) =
            file.chest.map(ChestFile::wall).transpose()?.unwrap_or_default();
        let (mut thickness_field, mut placement) = (file.thickness_field, file.body.map(Box::new));
        if let Some(beside) = beside {
            chest_grid = chest_grid.or_else(|| beside.chest_grid.clone());
            thickness_field = thickness_field.or_else(|| beside.thickness_field.clone());
            placement = placement.or_else(|| beside.placement.clone());
        }
        let mut scene = Scene {
            implant,
            implant_reference: file.implant.reference,
            pocket_radius_mm,
            body,
            chest,
            torso,
            chest_grid,
            insertion: file.insertion,
            layers,
            thickness_field,
            patient: None,
            side: file.side,
            visit: file.visit,
            placement,
            other_side: None,
            springs: file.springs,
            solver: file.solver,
        };
        scene.read_muscle(file.muscle)?;
        match file.patient {
            Some(patient) => patient.fill(&mut scene, &given)?,
            None => scene.patient = beside.and_then(|beside| beside.patient.clone()),
        }
        Ok(scene)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scene_is_written_with_its_schema_and_its_members_in_the_order_of_a_file() {
        let mut scene = Scene::opening();
        (scene.side, scene.visit) = (Some(Side::Left), Some(Visit::default()));
        scene.implant_reference = "RD-275".to_owned();
        let json = scene.to_json();
        let names = json.lines().filter_map(|line| line.strip_prefix("  \"")?.split('"').next());
        assert_eq!(
            names.collect::<Vec<_>>(),
            [
                "schema",
                "implant",
                "pocket_radius_mm",
                "tissue_model",
                "patch_radius_mm",
                "attachment",
                "chest",
                "insertion",
                "layers",
                "patient",
                "side",
                "visit",
                "springs",
                "solver"
            ]
        );
        assert!(
            json.contains("    \"reference\": \"RD-275\"\n  },\n  \"pocket_radius_mm\""),
            "{json}"
        );
    }
}

//! The input: a scene as versioned JSON, checked before any computation.
//!
//! [`Scene`] is the contract with files, the command line, the JS API and the app. Lengths in mm,
//! stresses in kPa. Every field but `implant.base_radius_mm` has a default; an unknown or out-of-range field is
//! rejected with one line that names the field.
//!
//! `body` (tissue model, patch) | `chest` (the wall), `chest_grid` (of a scan), `continued` (where the scan has no data), `open` (its gaps), `smooth` (its Gaussian mean), `hollow` (its curvature under the tissue), `thickness` (from place to place), `torso` (both of the built-in torso), `grid` (the form of both) | `checked` (a scene with its curves) | `error` | `field` (the numbers, a row each) | `file` (the members of a scene: in memory, in a file, by default) | `fill` (how far an implant yields) | `implant` (its numbers, in memory and in a file) | `layer` (a layer and its file format) | `other_side` (plans of their own for both sides) | `patient`
//! (measurements and the values derived from them) | `pins` (scenes beside the scene of a file) | `read`  (bytes and JSON) |
//! `repair` (scenes that an edit made invalid) | `skin_state` (its natural tension), `kept_surface` (the body's surface in a file), `placement` (the place on a body, the scene of a fitted body), `plane` (of the pocket: the muscle over the implant), `posture` (the weight of an implant that yields) | `visit` (patient and visit in words).
//!
//! Uses `curve`, `clinical`, `springs`, `mesh`, `contact`, `solve`. Used by `simulate` and all to its right.

mod body;
mod checked;
mod chest;
mod chest_grid;
mod continued;
mod error;
pub mod field;
mod file;
mod fill;
#[cfg(test)]
mod gaps;
mod grid;
mod hollow;
mod implant;
mod kept_surface;
mod layer;
mod open;
mod other_side;
mod patient;
pub mod pins;
mod placement;
mod plane;
mod posture;
pub mod read;
mod repair;
mod skin_state;
mod smooth;
mod thickness;
mod torso;
pub mod values;
pub mod visit;

use crate::clinical::Size;
use crate::curve::{given, number, present, present_whole};
use crate::solve::Problem;
pub use crate::springs::Springs;
pub use body::{Body, CellsThrough, TissueModel};
pub use checked::CheckedScene;
pub use chest::ChestShape;
pub use chest_grid::{ChestGrid, HeightsGrid};
pub use error::SceneError;
use error::{check_words, one_line, out_of_range, problem};
pub use field::Field;
use field::Part;
pub use file::Scene;
use file::SceneFile;
pub use fill::{Fill, Gel};
pub use implant::Implant;
pub use kept_surface::KeptSurface;
pub use layer::{Layer, tissue_in_words};
pub use patient::Patient;
pub use pins::{Document, Letter, PinnedScene};
pub use placement::{COVER_MM, LengthUnit, Placement};
pub use plane::Plane;
pub use posture::Posture;
pub use read::MAX_SCENE_BYTES;
pub use repair::Repair;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
pub use skin_state::SkinState;
pub use thickness::ThicknessGrid;
pub use torso::{FittedTorso, Shaped, Torso};

pub use visit::{FillSchedule, Side, Visit};

/// The schema of a scene, and that of a scene without schema.
pub const SCENE_SCHEMA: &str = "implant-preview/scene/1";

/// Inclusive bounds of whole numbers, and bounds that other numbers narrow; those of all other numbers are in [`field`].
pub mod limits {
    /// Greatest pocket radius \[mm\]; the least is base radius + distance of the centre.
    pub const POCKET_RADIUS_MAX_MM: f64 = 200.0;
    /// Sheet nodes per side.
    pub const NODES_PER_SIDE: (usize, usize) = (17, 1025);
    /// Greatest radius of the patch of layered tissue \[mm\]; the least is pocket + 20 mm.
    pub const PATCH_RADIUS_MAX_MM: f64 = 260.0;
    /// Radii of curvature of the chest \[mm\], negative in a hollow; other numbers bound them away from 0.
    pub const CHEST_RADIUS_MM: (f64, f64) = (-1e6, 1e6);
    /// Cells through the thickness of the solid layers.
    pub const CELLS_THROUGH: (usize, usize) = (1, 8);
    /// Layers in a scene.
    pub const LAYERS: (usize, usize) = (1, 8);
}

/// Greatest length of an implant's reference \[characters\].
pub const MAX_IMPLANT_REFERENCE: usize = 60;
/// Path of an implant's reference in a file.
const REFERENCE: &str = "implant.reference";

/// Grid and tolerance of the solver.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "one JSON object")]
pub struct SolverSettings {
    /// Nodes per side of the square grid, 17 to 1025; rounded to m·2ᵏ+1 with 8 ≤ m ≤ 15.
    #[serde(deserialize_with = "present_whole")]
    pub nodes_per_side: usize,
    /// Greatest node position error allowed, relative to the dome's base radius, 1e-7 to 1e-2.
    #[serde(deserialize_with = "present")]
    pub tolerance: f64,
    /// Cells through the thickness of the solid layers of layered tissue: "auto", or 1 to 8.
    #[serde(skip_serializing_if = "Option::is_none", deserialize_with = "given")]
    #[schemars(with = "CellsThrough")]
    pub cells_through: Option<CellsThrough>,
}

impl Default for SolverSettings {
    fn default() -> Self {
        Self { nodes_per_side: 129, tolerance: 1e-4, cells_through: None }
    }
}

/// The patient and the implant that the app opens with.
const OPENING: &str = r#"{
    "implant": { "base_radius_mm": 60.0 },
    "pocket_radius_mm": 70.0,
    "layers": [
        { "tissue": "skin", "curve": { "kind": "skin" } },
        { "tissue": "adipose", "poisson_ratio": 0.49, "curve": { "kind": "fat" } }
    ],
    "patient": { "pinch_mm": 20.0, "skin_class": "normal" }
}"#;

/// The chest of the patient that the app opens with.
const OPENING_CHEST: ChestShape = ChestShape::USUAL;

/// Volume of the implant that the app opens with \[ml\].
const OPENING_VOLUME_ML: f64 = 225.0;

impl Scene {
    /// A usual plan, of the tables of the docs: a rigid implant of 12 cm and 225 ml in a pocket 1 cm wider all round,
    /// pinch 2 cm, normal skin, the chest of `OPENING_CHEST`.
    ///
    /// [`Scene::default`] keeps the defaults of files; the app opens with [`Self::first_plan`].
    #[must_use]
    pub fn opening() -> Self {
        let mut scene = Self::from_json(OPENING).unwrap_or_default();
        let width_mm = 2.0 * scene.implant.base_radius_mm;
        if let Ok(size) = Size::of_width_and_volume(width_mm, OPENING_VOLUME_ML) {
            scene.implant.projection_mm = size.projection_mm();
        }
        scene.chest = Some(OPENING_CHEST);
        scene
    }

    /// The plan that the app opens with: the usual one, of an implant filled with cohesive gel.
    #[must_use]
    pub fn first_plan() -> Self {
        let mut scene = Self::opening();
        scene.implant.fill = Some(Fill::Cohesive);
        scene
    }

    /// The sheet of the paper: skin and its adipose in one membrane over the implant of the default scene.
    #[must_use]
    pub fn sheet() -> Self {
        let mut scene =
            Self { layers: vec![Layer::skin(), Layer::paper_adipose()], ..Self::default() };
        scene.set_tissue_model(TissueModel::Sheet);
        scene
    }

    /// Reads a scene from JSON and checks it.
    ///
    /// # Errors
    /// One line with the field, its value and the allowed range.
    pub fn from_json(json: &str) -> Result<Self, SceneError> {
        CheckedScene::from_json(json).map(CheckedScene::into_scene)
    }

    /// The scene as JSON text, indented, with every field.
    #[must_use]
    pub fn to_json(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    /// Checks every field against its range.
    ///
    /// # Errors
    /// The first field that is out of range.
    pub fn validate(&self) -> Result<(), SceneError> {
        CheckedScene::new(self.clone()).map(drop)
    }

    /// Checks every field but the curves.
    fn check_limits(&self) -> Result<(), SceneError> {
        visit::check_line(REFERENCE, &self.implant_reference, MAX_IMPLANT_REFERENCE)?;
        self.check_numbers(Part::Scene)?;
        self.implant.fill.map_or(Ok(()), Fill::check)?;
        let (implant, most) = (&self.implant, limits::POCKET_RADIUS_MAX_MM);
        let half = if implant.is_round() { "base radius" } else { "half of the base" };
        let [x, y] = implant.center_mm;
        let (distance, room) = (x.hypot(y), most - implant.greatest_half_axis_mm());
        if distance > room * (1.0 + 1e-9) {
            return Err(out_of_range(
                "implant.center_mm",
                format!("{} mm from the pocket's centre", number((10.0 * distance).ceil() / 10.0)),
                &format!("0 to {} mm ({most} mm - {half})", number(room)),
            ));
        }
        let least = implant.least_pocket_mm();
        if !(self.pocket_radius_mm >= least * (1.0 - 1e-9) && self.pocket_radius_mm <= most) {
            return Err(out_of_range(
                "pocket_radius_mm",
                number(self.pocket_radius_mm),
                &format!(
                    "{} ({half} + distance of the implant's centre) to {most} mm",
                    number(least)
                ),
            ));
        }
        self.check_body()?;
        // The limits of the patch depend on it.
        Field::PocketLowered.check(self, 0)?;
        self.check_numbers(Part::Body)?;
        self.check_patient()?;
        self.check_visit()?;
        self.check_placement()?;
        let (least, most) = limits::LAYERS;
        if !(least..=most).contains(&self.layers.len()) {
            return Err(out_of_range(
                "layers",
                format!("a list of {}", self.layers.len()),
                &format!("{least} to {most} layers"),
            ));
        }
        self.check_numbers(Part::Layer)?;
        for (k, layer) in self.layers.iter().enumerate() {
            check_words(&format!("layers[{k}].tissue"), &layer.tissue, 100)?;
        }
        let (least, most) = limits::NODES_PER_SIDE;
        if !(least..=most).contains(&self.solver.nodes_per_side) {
            return Err(out_of_range(
                "solver.nodes_per_side",
                self.solver.nodes_per_side.to_string(),
                &format!("{least} to {most}"),
            ));
        }
        self.check_chest()?;
        self.check_torso()?;
        self.check_other_side()
    }

    /// Checks the numbers of a part; the pocket has a check of its own.
    fn check_numbers(&self, part: Part) -> Result<(), SceneError> {
        let is_meant = |field: &&Field| field.part == part && **field != Field::PocketRadius;
        let layers = if part == Part::Layer { self.layers.len() } else { 1 };
        let mut numbers = Field::ALL.iter().filter(is_meant);
        numbers.try_for_each(|field| (0..layers).try_for_each(|k| field.check(self, k)))
    }
}

impl Scene {
    /// Drops the implant's reference after a change of its size: the maker's name of a size is not that of another.
    pub fn drop_reference_of(&mut self, before: &Self) {
        let is_kept = self.implant_reference == before.implant_reference;
        if is_kept && !self.implant.has_size_of(&before.implant) {
            self.implant_reference.clear();
        }
    }

    /// The problem of the scene, for the solver.
    ///
    /// # Errors
    /// The first field that is out of its range.
    pub fn problem(&self) -> Result<Problem, SceneError> {
        Ok(CheckedScene::new(self.clone())?.problem())
    }

    /// Do two scenes have the same equilibrium? The names of their tissues, the patients, sides and visits may differ.
    #[must_use]
    pub fn same_physics(&self, other: &Self) -> bool {
        self == other || self.physics() == other.physics()
    }

    /// Does the scene lie on the same chest of the same body as another one?
    pub(crate) fn has_body_of(&self, other: &Self) -> bool {
        (self.chest, self.torso, &self.chest_grid, &self.placement)
            == (other.chest, other.torso, &other.chest_grid, &other.placement)
    }

    /// The scene without what its equilibrium does not depend on.
    fn physics(&self) -> Self {
        let mut scene = Self {
            implant: self.implant.in_few_words(),
            implant_reference: String::new(),
            patient: None,
            side: None,
            visit: None,
            placement: None,
            other_side: None,
            ..self.clone()
        };
        scene.layers.iter_mut().for_each(|layer| layer.tissue.clear());
        let cells = scene.solver.cells_through.unwrap_or_default();
        scene.solver.cells_through = scene.is_layered().then_some(cells);
        if !scene.is_layered() {
            // Patch and attachment belong to layered tissue.
            scene.body = Body::around(scene.pocket_radius_mm, scene.body.tissue_model);
        }
        scene
    }
}

/// The JSON Schema (draft 2020-12) of the scene, generated from the types.
#[must_use]
pub fn schema() -> String {
    let schema = schemars::schema_for!(Scene);
    serde_json::to_string_pretty(&schema).unwrap_or_default()
}

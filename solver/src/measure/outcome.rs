//! The result of a scene: its fields, as in files.

use super::in_body::ImplantInBody;
use super::layered::{Cover, SkinArea, Thickness, Traction};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// How a solve ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The estimated position error is within the tolerance.
    Converged,
    /// The estimated position error is above the tolerance; the figures are those of the last iterate, of layered tissue of the one with the
    /// least error, 1 % of the base radius at most.
    NotConverged,
    /// The paper's springs have no stable shape in this scene, the implant protrudes between the nodes, or no shape of
    /// layered tissue was found; the result has no shape.
    Unstable,
}

/// The result of a scene. Fields that do not apply are `None`, null or absent in a file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Outcome {
    /// `implant-preview/result/1`.
    pub schema: String,
    /// How the solve ended.
    pub status: Status,
    /// Stretch of the membrane (the sheet, or the skin of layered tissue) at the dome's apex \[-\] (off centre: √(area stretch) at the highest point).
    pub apex_stretch: Option<f64>,
    /// Polar angle from the apex at which contact ends \[degrees\]; centred hemisphere only.
    pub contact_angle_deg: Option<f64>,
    /// Material radius at which contact ends \[mm\]; centred dome only.
    pub contact_material_radius_mm: Option<f64>,
    /// Force between dome and tissue along z \[N\].
    pub contact_force_n: Option<f64>,
    /// Layered tissue: resultant of the dome's forces on the tissue, \[x, y, z\] \[N\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub contact_resultant_n: Option<[f64; 3]>,
    /// Contact pressure \[kPa\].
    pub contact_pressure_kpa: Option<Pressure>,
    /// Contact pressure \[mmHg\].
    pub contact_pressure_mmhg: Option<Pressure>,
    /// Greatest pressure over the middle of the implant, to half of its base's radius, and around it \[kPa\]: each changes smoothly with a
    /// scene, the greatest of both has a kink where they change places. In no file.
    #[serde(skip)]
    pub pressure_peaks_kpa: [f64; 2],
    /// Height of the implant's tip above the wall, over which the tissue is highest \[mm\].
    pub projection_mm: Option<f64>,
    /// Height of the outer skin surface over the implant's tip above the wall \[mm\]: of layered tissue `projection_mm` and the cover
    /// over the tip.
    pub skin_projection_mm: Option<f64>,
    /// The implant in the body, if it yields: its height beside the catalogue's projection.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub implant_in_body: Option<ImplantInBody>,
    /// Volume of the whole implant, the fullness (⅔ unless stated) times π a b p \[ml\].
    pub implant_volume_ml: f64,
    /// The maker's name of the implant's size, as in the scene; empty and absent without one.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub implant_reference: String,
    /// Area of the pocket πa² \[cm²\]; over a curved wall that of the skin over the pocket at rest.
    pub area_before_cm2: f64,
    /// Area of the deformed membrane over the pocket \[cm²\].
    pub area_after_cm2: Option<f64>,
    /// After / before \[-\].
    pub area_ratio: Option<f64>,
    /// After − before \[cm²\].
    pub area_gain_cm2: Option<f64>,
    /// Strains of the membrane.
    pub strain: Option<Strains>,
    /// Layered tissue: greatest principal strain / strain at which the skin's curve turns steep \[-\];
    /// absent for a curve that does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub skin_reserve_used: Option<f64>,
    /// With a natural tension or growth of the skin: what the implant adds to `skin_reserve_used`; otherwise absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub skin_reserve_added: Option<f64>,
    /// One entry a layer, from the skin inwards.
    pub layers: Vec<LayerOutcome>,
    /// 41 points along +x from the pocket's centre, material radius 0 … pocket radius.
    pub profile: Vec<ProfilePoint>,
    /// Layered tissue: 41 points of the skin's membrane along +x, material radius 0 … patch radius.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub profile_skin: Vec<ProfilePoint>,
    /// Layered tissue: as `profile`, along +y.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub profile_y: Vec<ProfilePoint>,
    /// Layered tissue: as `profile_skin`, along +y.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub profile_skin_y: Vec<ProfilePoint>,
    /// Layered tissue: thickness between implant and outer skin surface \[mm\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cover_mm: Option<Cover>,
    /// Layered tissue: void between tissue, implant and wall within the pocket \[ml\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub void_ml: Option<f64>,
    /// With a greatest void of the pocket: the suction that holds it \[kPa\], zero where the void is smaller by itself; otherwise absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub suction_kpa: Option<f64>,
    /// Layered tissue: area of the skin before and after.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub skin_area: Option<SkinArea>,
    /// Layered tissue: greatest pull of the attachment around the pocket \[kPa\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attachment_traction_kpa: Option<Traction>,
    /// Layered tissue: fraction of the skin of the whole patch, by area at rest, that is wrinkled or slack \[-\], 0 to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub wrinkled: Option<f64>,
    /// What the solver did.
    pub solver: SolverOutcome,
    /// Values of the scene that the patient's measurements determine; without a patient empty and absent.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub patient_values: Vec<PatientValue>,
    /// Warnings in plain sentences.
    pub warnings: Vec<String>,
}

/// Mean and greatest contact pressure.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Pressure {
    /// Normal force / contact area.
    pub mean: f64,
    /// Greatest value at the nodes in contact.
    pub max: f64,
}

/// Strains of the membrane over the pocket \[-\]; the greatest strain is that of the whole patch. With a natural tension or growth against skin
/// without stress.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Strains {
    /// Greatest principal engineering strain, λ₁ − 1.
    pub max_principal: f64,
    /// Mean area strain; without a natural tension area ratio − 1.
    pub mean_area: f64,
    /// Fraction of the membrane (by area at rest) whose greatest principal strain is above 0.25, 0.50, 0.54.
    pub fraction_above: BTreeMap<String, f64>,
    /// With a natural tension or growth: the strains that the implant adds, against the tissue at rest; otherwise absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub added: Option<AddedStrains>,
}

/// Strains of the membrane against the tissue at rest \[-\].
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AddedStrains {
    /// Greatest principal engineering strain of the whole patch.
    pub max_principal: f64,
    /// Mean area strain over the pocket, area ratio − 1.
    pub mean_area: f64,
}

/// The result of one layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LayerOutcome {
    /// As in the scene.
    pub tissue: String,
    /// Greatest principal nominal (Biot) stress \[kPa\].
    pub max_stress_kpa: Option<f64>,
    /// Of skin with a natural tension or growth: `max_stress_kpa` above the greatest stress at rest \[kPa\]; otherwise absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub added_stress_kpa: Option<f64>,
    /// Does a strain lie on the line beyond the curve's data?
    pub beyond_curve_data: bool,
    /// Layered tissue: least and greatest deformed thickness \[mm\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thickness_mm: Option<Thickness>,
    /// Layered tissue: greatest principal stretch \[-\].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_stretch: Option<f64>,
}

/// A point of the profile.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ProfilePoint {
    /// Material radius \[mm\], a length along the wall.
    pub s_mm: f64,
    /// Deformed distance from the pocket's axis \[mm\], on either side.
    pub r_mm: f64,
    /// Deformed height \[mm\] over the plane z = 0, which touches a curved wall at the pocket's centre.
    pub z_mm: f64,
    /// Stretch along the profile \[-\].
    pub stretch_meridional: f64,
    /// Stretch across the profile \[-\].
    pub stretch_hoop: f64,
}

/// A method of solution.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SolverMethod {
    /// Full multigrid, full approximation scheme, in f32.
    Multigrid,
    /// Newton's method on nested grids, in f64.
    Newton,
}

/// What the solver did.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SolverOutcome {
    /// Nodes per side after rounding.
    pub nodes_per_side: usize,
    /// Free nodes of the finest level that were solved for: those of one quarter or half where symmetry
    /// allows it.
    pub nodes_solved: usize,
    /// The method that the shape comes from.
    pub method: SolverMethod,
    /// Multigrid cycles of the finest level.
    pub cycles: u32,
    /// Did multigrid not converge at first? Then Newton's method replaced it; for layered tissue a further attempt
    /// of multigrid with other constants, and Newton's method after the last attempt (`method`).
    pub fell_back: bool,
    /// Work \[evaluations of all nodal forces on the finest grid\].
    pub work_units: f64,
    /// Wall-clock time of the solve \[ms\], grids and tables included; `None` without a clock.
    pub time_ms: Option<f64>,
    /// Norm of the residual forces / norm of the summed spring forces \[-\]; `None` where the solve ended without
    /// a residual.
    pub relative_residual: Option<f64>,
    /// Estimated greatest node position error / base radius \[-\], against this grid's own equilibrium;
    /// `None` where the solve ended without an estimate.
    pub estimated_position_error: Option<f64>,
    /// Estimated greatest position error of the skin's nodes / base radius \[-\], against the equilibrium on ever finer grids,
    /// mostly right within a factor of 2 ([`Report::estimated_discretisation_error`]); of skin that wrinkles only, `None` and
    /// absent without an estimate.
    ///
    /// [`Report::estimated_discretisation_error`]: crate::solve::Report::estimated_discretisation_error
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub estimated_discretisation_error: Option<f64>,
    /// Cells through the thickness of all solids together; of skin that wrinkles only, otherwise `None` and absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cells_through: Option<usize>,
}

/// A value of a scene that a measurement determines.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PatientValue {
    /// The field's path in the scene.
    pub field: String,
    /// The value in the scene \[the field's unit\].
    pub value: f64,
    /// Was the value set by hand? Otherwise it was derived from the measurement.
    pub set_by_hand: bool,
    /// The measurement in words, as "pinch 20 mm".
    pub measured: String,
    /// The value that the measurement gives \[the field's unit\].
    pub derived: f64,
    /// Range of the derived value within one standard deviation \[the field's unit\].
    pub range: [f64; 2],
}

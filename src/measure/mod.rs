//! What a surgeon reads off: the result of a solved scene.
//!
//! Strains are recovered at the nodes from the triangles around them, areas and forces are sums over the sheet;
//! the contact's edge is found between nodes, from how the gap opens. Everything is read off a
//! [`Solution`](crate::solve::Solution).
//!
//! `layers` (stresses) | `contact` (pressure, edge) | `profile` | `fields` (what is drawn, each when it is first
//! read) | `surface` (closed surfaces) | `bands` (words of limits).
//!
//! Uses `curve`, `springs`, `mesh`, `contact`, `model`, `solve`. Used by `scene` and all to its right.

pub mod bands;
mod contact;
mod fields;
mod layers;
mod profile;
mod surface;

pub use crate::model::membrane::deformation::Deformation;
pub use crate::model::membrane::stack::Stack;
pub use fields::{Field, Fields};
#[cfg(all(test, feature = "command-line"))]
pub(crate) use surface::of_faces;
pub use surface::{Surfaces, surfaces};

use crate::model::membrane::deformation::Summary;
use crate::solve::{Invalid, Method, Problem, Report, Verdict};
use crate::springs::Springs;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::f64::consts::PI;

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
    /// The springs have no stable shape here (the paper's springs), or the implant sticks out of the
    /// sheet between its nodes; no shape is shown.
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
    /// Height of the implant's tip above the wall, over which the sheet is highest \[mm\].
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
    /// Deformed distance from the pocket's axis \[mm\], to whichever side the tissue was pushed.
    pub r_mm: f64,
    /// Deformed height \[mm\].
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
    /// Did the slower, sure method take over because a cycle did not lead to the solution?
    pub fell_back: bool,
    /// One unit = one evaluation of all nodal forces on the finest grid.
    pub work_units: f64,
    /// Wall-clock time \[ms\] of solving, grids and tables included, where a clock was at hand.
    pub time_ms: Option<f64>,
    /// Norm of the residual force / norm of the spring forces it is the sum of \[-\]; `None` where the
    /// solve ended before it was known.
    pub relative_residual: Option<f64>,
    /// Estimated greatest node position error / base radius \[-\], against this grid's own equilibrium;
    /// `None` where the solve ended without an estimate.
    pub estimated_position_error: Option<f64>,
}

/// Strains above which the share of the sheet is reported \[-\]: 0.25 and 0.50 bound the clinical
/// bands, 0.54 is the mean failure strain of excised back skin (54 ± 17 %).
pub const STRAIN_BANDS: [f64; 3] = [0.25, 0.50, 0.54];

/// Measures the solution of a finished solve. `tissues` are the layers' names, from the skin inwards.
#[must_use]
pub fn measure(fields: &Fields, tissues: &[String]) -> Outcome {
    let solution = fields.solution();
    let (problem, report) = (solution.problem(), solution.report());
    let mut outcome = Outcome::without_shape(problem, report, tissues);
    if outcome.status == Status::Unstable || report.invalid.is_some() {
        outcome.warnings.push(no_shape(report.invalid).to_owned());
        return outcome;
    }
    let summary = solution.deformation().summary(&problem.sheet, STRAIN_BANDS);
    outcome.measure_shape(fields, &summary);
    outcome.warn(problem, &summary, fields.contact().nodes());
    if report.is_left_at_rest {
        outcome.warnings.push(
            "The insertion is below the solver tolerance; the tissue was left undeformed. Reduce the \
             tolerance to resolve it."
                .to_owned(),
        );
    }
    outcome
}

/// Why no shape is given.
#[must_use]
pub fn no_shape(invalid: Option<Invalid>) -> &'static str {
    match invalid {
        None => {
            "These springs have no stable shape in this scene; no shape is given. The coupled \
             springs do not lose theirs in tension."
        }
        Some(Invalid::Penetrated) => {
            "The implant sticks out of the sheet between its nodes: the grid is too coarse for it, or \
             the tissue gives way under its tip. No shape is given; take more nodes a side, a flatter \
             implant or tissue whose stress rises with strain."
        }
        Some(Invalid::Inverted) => "The sheet came out folded over; no shape is given.",
        Some(Invalid::NotFinite) => "A node's place came out as not a number; no shape is given.",
    }
}

impl Outcome {
    /// The result of a solve of which no shape is measured yet.
    fn without_shape(problem: &Problem, report: &Report, tissues: &[String]) -> Self {
        let layer = |tissue: &String| LayerOutcome {
            tissue: tissue.clone(),
            max_stress_kpa: None,
            beyond_curve_data: false,
        };
        Self {
            schema: RESULT_SCHEMA.to_owned(),
            status: match report.verdict {
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
            implant_volume_ml: problem.obstacle.dome.volume() / 1000.0,
            area_before_cm2: pocket_area(problem) / 100.0,
            area_after_cm2: None,
            area_ratio: None,
            area_gain_cm2: None,
            strain: None,
            layers: tissues.iter().map(layer).collect(),
            profile: Vec::new(),
            solver: SolverOutcome {
                nodes_per_side: problem.sheet.nodes_per_side(),
                nodes_solved: report.nodes_solved,
                method: match report.method {
                    Method::Newton => SolverMethod::Newton,
                    _ => SolverMethod::Multigrid,
                },
                cycles: report.cycles,
                fell_back: report.fell_back,
                work_units: report.work_units,
                time_ms: None,
                relative_residual: report.relative_residual,
                estimated_position_error: report.estimated_position_error,
            },
            warnings: Vec::new(),
        }
    }

    fn measure_shape(&mut self, fields: &Fields, summary: &Summary<{ STRAIN_BANDS.len() }>) {
        let solution = fields.solution();
        let problem = solution.problem();
        let (dome, sheet, x) = (&problem.obstacle.dome, &problem.sheet, solution.inner());
        let deformation = solution.deformation();
        let area_before = pocket_area(problem);

        let apex = deformation.at_apex(sheet, dome, x);
        self.apex_stretch = Some(apex.area_stretch().sqrt());
        let height = dome.apex().z;
        let thickness: f64 = problem
            .materials
            .iter()
            .map(|m| m.thickness_mm * apex.thickness_stretch(m.poisson_ratio))
            .sum();
        self.projection_mm = Some(height);
        self.skin_projection_mm = Some(height + thickness);

        let contact = fields.contact();
        self.contact_force_n = Some(contact.vertical_force() / 1000.0);
        self.contact_pressure_kpa = contact.pressure();
        self.contact_pressure_mmhg = self
            .contact_pressure_kpa
            .map(|p| Pressure { mean: p.mean * MMHG_PER_KPA, max: p.max * MMHG_PER_KPA });
        if let Some(edge) = contact.edge(solution) {
            self.contact_material_radius_mm = Some(edge.material_radius);
            self.contact_angle_deg = dome.is_hemisphere().then(|| edge.angle.to_degrees());
        }

        let ratio = summary.area_ratio;
        self.area_ratio = Some(ratio);
        self.area_after_cm2 = Some(area_before * ratio / 100.0);
        self.area_gain_cm2 = Some(area_before * (ratio - 1.0) / 100.0);
        let shares = STRAIN_BANDS.iter().zip(summary.share_above);
        self.strain = Some(Strains {
            max_principal: summary.greatest,
            mean_area: ratio - 1.0,
            fraction_above: shares.map(|(limit, share)| (format!("{limit:.2}"), share)).collect(),
        });
        for (layer, load) in
            self.layers.iter_mut().zip(layers::loads(&problem.materials, deformation))
        {
            layer.max_stress_kpa = Some(load.max_stress);
            layer.beyond_curve_data = load.is_beyond_data;
        }
        self.profile = profile::along_x(solution);
    }

    fn warn(
        &mut self,
        problem: &Problem,
        summary: &Summary<{ STRAIN_BANDS.len() }>,
        contact_nodes: usize,
    ) {
        if self.status == Status::NotConverged {
            self.warnings.push(
                "The solver stopped above the tolerance: read the figures with the estimated \
                 position error."
                    .to_owned(),
            );
        }
        for layer in self.layers.iter().filter(|layer| layer.beyond_curve_data) {
            self.warnings.push(format!(
                "{}: strains lie beyond the data of its curve, which was extended.",
                layer.tissue
            ));
        }
        let (sheet, springs) = (&problem.sheet, problem.springs);
        if let Some(part) = unresolved_part(problem, contact_nodes) {
            self.warnings.push(format!(
                "The grid is coarse for {part}: nodes lie {:.2} mm apart. Strain, stress, pressure and \
                 force there are rough; take more nodes a side.",
                sheet.spacing_mm()
            ));
        }
        if springs == Springs::Nikolaev && summary.greatest > UNEVEN_STRAIN {
            self.warnings.push(
                "The paper's springs have no even shape at large strains: what they show instead \
                 depends on the grid. The coupled springs do not."
                    .to_owned(),
            );
        }
        if summary.least < -WRINKLING_STRAIN {
            self.warnings.push(
                "Part of the sheet is compressed: real tissue may wrinkle there, which a sheet \
                 without bending stiffness does not resolve."
                    .to_owned(),
            );
        }
    }
}

/// Cells across a radius of curvature from which on it counts as resolved.
const LEAST_CELLS: f64 = 2.0;
/// The least strain at which an even stretch of the paper's springs was found unstable (adipose, ν 0.5).
const UNEVEN_STRAIN: f64 = 0.1;

/// What of the implant, or of its contact with so many nodes, is too small for the grid, if anything is.
fn unresolved_part(problem: &Problem, contact_nodes: usize) -> Option<&'static str> {
    let Problem { sheet, patch, obstacle, .. } = problem;
    let dome = &obstacle.dome;
    let least = LEAST_CELLS * sheet.spacing_mm();
    let (radius, projection) = (dome.base_radius, dome.projection);
    let is_fully_in = dome.base_height >= 0.0;
    let room = patch.pocket_radius_mm - dome.center.length() - radius;
    if dome.apex().z <= 0.0 {
        None
    } else if radius * radius / projection < least {
        Some("the implant's tip")
    } else if dome.wall_radius() < least {
        Some("the part of the implant that is in")
    } else if is_fully_in && projection * projection / radius < least && room < least {
        Some("the implant's rim")
    } else if contact_nodes > 0 && (contact_nodes as f64) < PI * LEAST_CELLS * LEAST_CELLS {
        Some("the small part of the sheet that touches the implant")
    } else {
        None
    }
}

/// Compression from which on a warning of wrinkles is given \[-\].
const WRINKLING_STRAIN: f64 = 0.02;

/// Area of the pocket at rest \[mm²\].
fn pocket_area(problem: &Problem) -> f64 {
    PI * problem.patch.pocket_radius_mm.powi(2)
}

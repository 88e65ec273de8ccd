//! The result of a solved scene: strain, stress, pressure, area, profile.
//!
//! Strains are recovered at the nodes from the adjacent triangles; areas and forces are sums over the sheet. The
//! contact edge is located between nodes, from the opening gap. The only input is a [`Solution`].
//!
//! `outcome` (the fields of a result) | `layers` (stresses) | `contact` (pressure, edge), `contact_area/` (between the nodes) | `profile` | `fields` (nodal fields, computed on demand) |
//! `in_body` (an implant that yields) | `selection` (the fields asked for) | `column` (of a table of results) | `wrinkles` (state of skin that wrinkles) | `surface` (closed surfaces) | `bands` (limits of strain and pressure, with words and sources).
//!
//! Uses `curve`, `clinical`, `springs`, `mesh`, `contact`, `model`, `solve`. Used by `scene` and all to its right.

pub mod bands;
mod column;
mod contact;
mod contact_area;
mod fields;
mod in_body;
pub(crate) mod layered;
mod layers;
mod outcome;
mod profile;
mod selection;
mod surface;
mod wrinkles;

pub use crate::model::membrane::deformation::Deformation;
pub use crate::model::membrane::stack::Stack;
pub use column::{Column, ColumnError, Kind};
pub use fields::{Field, Fields};
pub use in_body::{ImplantInBody, Yielded};
pub use layered::{
    Cover, CoverWithoutMuscle, SkinArea, Thickness, Traction, cover_without_innermost,
    least_thickness_at_rest, thickness_at_rest,
};
pub use outcome::{
    AddedStrains, LayerOutcome, Outcome, PatientValue, Pressure, ProfilePoint, SolverMethod,
    SolverOutcome, Status, Strains,
};
pub use profile::{Direction, Meridian, meridians, skin_surface};
pub use selection::{Selected, Selection, UnknownField, Written};
#[cfg(test)]
pub(crate) use surface::of_faces;
pub use surface::{Surfaces, surfaces};

use crate::mesh::NaturalStretch;
use crate::model::membrane::deformation::Summary;
use crate::solve::{Invalid, Method, Problem, Report, Solution, Tissue, Verdict};
use crate::springs::Springs;
use crate::springs::coupled::biot_stress;
use crate::springs::solids::MAX_POISSON_RATIO;
use glam::DVec3;
use std::f64::consts::PI;

/// The schema of [`Outcome`].
pub const RESULT_SCHEMA: &str = "implant-preview/result/1";

/// 1 kPa in mmHg (conventional millimetres of mercury, 133.322 Pa).
pub const MMHG_PER_KPA: f64 = 7.500_62;

/// Points of a profile: material radius 0 … pocket radius in equal steps.
pub const PROFILE_POINTS: usize = 41;

/// Strains above which the fraction of the sheet is reported \[-\]: 0.25 and 0.50 bound the clinical
/// bands, 0.54 is the mean failure strain of excised back skin (54 ± 17 %).
pub const STRAIN_BANDS: [f64; 3] = [0.25, 0.50, 0.54];

/// Measures the solution of a finished solve: the selected fields, and fields at no cost. `tissues` are the layers'
/// names, from the skin inwards.
#[must_use]
pub fn measure(fields: &Fields, tissues: &[String], selection: &Selection) -> Outcome {
    let solution = fields.solution();
    let (problem, report) = (solution.problem(), solution.report());
    let [pocket_area, patch_area] = layered::rest_areas(problem);
    let mut outcome = Outcome::without_shape(problem, report, tissues, pocket_area);
    if problem.tissue == Tissue::Layered {
        outcome.solver.cells_through = Some(solution.cells().len());
        outcome.solver.estimated_discretisation_error = report.estimated_discretisation_error;
    }
    if outcome.status == Status::Unstable || report.invalid.is_some() {
        outcome.warnings.push(no_shape(report.invalid).to_owned());
        return outcome;
    }
    let weight = |k: usize| match problem.tissue {
        Tissue::Sheet => 1.0,
        Tissue::Layered => layered::pocket_weight(problem.sheet(), problem.patch.pocket(), k),
    };
    outcome.measure_contact(fields, selection);
    outcome.measure_void(solution, selection);
    if selection.wants("profile") {
        outcome.profile = profile::along_x(solution);
    }
    if selection.wants_any(&OF_MEMBRANE) {
        let summary = solution.elastic_deformation().summary(STRAIN_BANDS, weight);
        let added = problem.rest.has_own_skin().then(|| solution.deformation().summary([], weight));
        outcome.measure_shape(fields, &summary, added, pocket_area);
        outcome.skin_reserve_used = reserve_used(problem, outcome.strain.as_ref());
        if selection.wants_any(&["layers", "warnings"]) {
            outcome.measure_loads(solution);
        }
        if problem.tissue == Tissue::Layered {
            outcome.measure_layers(solution, selection, patch_area);
            outcome.measure_added(problem);
        }
        let wants_warnings = selection.wants("warnings");
        let shares = (wants_warnings || selection.wants("wrinkled"))
            .then(|| wrinkles::Shares::new(solution))
            .flatten();
        outcome.wrinkled = shares.map(|shares| shares.wrinkled);
        if wants_warnings {
            outcome.warn(problem, &summary, fields.contact().nodes());
            outcome.warnings.extend(in_body::warning(solution));
            outcome.warnings.extend(match shares {
                Some(shares) => shares.warning(),
                None => layers::compression(solution),
            });
        }
    }
    if report.is_left_at_rest {
        outcome.warnings.push(
            "The insertion is too small for this accuracy; the tissue was left undeformed. Choose a finer \
             accuracy (tolerance)."
                .to_owned(),
        );
    }
    outcome
}

/// Greatest strain of the skin of layered tissue, relative to the strain at which its curve turns steep.
fn reserve_used(problem: &Problem, strain: Option<&Strains>) -> Option<f64> {
    Some(strain?.max_principal.max(0.0) / problem.skin_knee()?)
}

/// Fields that depend on the membrane's deformation.
const OF_MEMBRANE: [&str; 17] = [
    "apex_stretch",
    "skin_projection_mm",
    "area_after_cm2",
    "area_ratio",
    "area_gain_cm2",
    "strain",
    "skin_reserve_used",
    "skin_reserve_added",
    "layers",
    "profile_skin",
    "profile_y",
    "profile_skin_y",
    "cover_mm",
    "skin_area",
    "attachment_traction_kpa",
    "wrinkled",
    "warnings",
];

/// Fields that depend on the contact.
const OF_CONTACT: [&str; 6] = [
    "contact_angle_deg",
    "contact_material_radius_mm",
    "contact_force_n",
    "contact_resultant_n",
    "contact_pressure_kpa",
    "contact_pressure_mmhg",
];

/// The reason why a result has no shape.
#[must_use]
pub fn no_shape(invalid: Option<Invalid>) -> &'static str {
    match invalid {
        None => {
            "The springs have no stable equilibrium in this scene; no result is available. Coupled \
             springs are stable in tension."
        }
        Some(Invalid::Penetrated) => {
            "The implant protrudes through the tissue between the nodes: the grid is too coarse for the \
             implant, or the tissue yields at the implant's tip. No result is available. Use more nodes \
             per side, a flatter implant or tissue whose stress rises with strain."
        }
        Some(Invalid::Inverted) => {
            "The solver produced an inverted surface; no result is available."
        }
        Some(Invalid::NotFound) => {
            "The solver found no shape of this tissue; no result is available. Use another number of nodes \
             per side, less insertion, a flatter implant or a smaller patch."
        }
        Some(Invalid::NotFinite) => {
            "The solver produced a non-finite position; no result is available."
        }
    }
}

impl Outcome {
    /// The result of a solve without measured quantities.
    fn without_shape(
        problem: &Problem,
        report: &Report,
        tissues: &[String],
        pocket_area: f64,
    ) -> Self {
        let layer = |tissue: &String| LayerOutcome {
            tissue: tissue.clone(),
            max_stress_kpa: None,
            added_stress_kpa: None,
            beyond_curve_data: false,
            thickness_mm: None,
            max_stretch: None,
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
            contact_resultant_n: None,
            contact_pressure_kpa: None,
            contact_pressure_mmhg: None,
            pressure_peaks_kpa: [0.0; 2],
            projection_mm: None,
            skin_projection_mm: None,
            implant_in_body: None,
            implant_volume_ml: problem.obstacle.dome.volume() / 1000.0,
            implant_reference: String::new(),
            area_before_cm2: pocket_area / 100.0,
            area_after_cm2: None,
            area_ratio: None,
            area_gain_cm2: None,
            strain: None,
            skin_reserve_used: None,
            skin_reserve_added: None,
            layers: tissues.iter().map(layer).collect(),
            profile: Vec::new(),
            profile_skin: Vec::new(),
            profile_y: Vec::new(),
            profile_skin_y: Vec::new(),
            cover_mm: None,
            void_ml: None,
            suction_kpa: None,
            skin_area: None,
            attachment_traction_kpa: None,
            wrinkled: None,
            solver: SolverOutcome {
                nodes_per_side: problem.sheet().nodes_per_side(),
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
                estimated_discretisation_error: None,
                cells_through: None,
            },
            patient_values: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// Adds the void, the suction of one that is limited, and a warning where it is larger.
    fn measure_void(&mut self, solution: &Solution, selection: &Selection) {
        let limit = solution.problem().void;
        self.suction_kpa = limit.map(|void| void.suction_kpa);
        let wants_warnings = limit.is_some() && selection.wants("warnings");
        if !selection.wants("void_ml") && !wants_warnings {
            return;
        }
        let void = solution.void_mm3();
        self.void_ml = void.map(|void| void / 1000.0).filter(|_| selection.wants("void_ml"));
        if let (Some(void), Some(limit)) = (void, limit)
            && void > LARGER * limit.most_mm3 + LEAST_VOID_MM3
        {
            let (ml, kpa) = (void / 1000.0, limit.suction_kpa);
            let is_corner = void <= LARGER * solution.problem().least_void_mm3() + LEAST_VOID_MM3;
            self.warnings.push(if is_corner || limit.has_greatest_suction() {
                format!(
                    "The void of the pocket stays at {ml:.1} ml: under a suction of {kpa:.1} kPa, and on this grid, the tissue \
                     does not reach further into the corner at the implant's rim."
                )
            } else {
                format!(
                    "The void of the pocket stays at {ml:.1} ml: under more suction than {kpa:.1} kPa the solver finds no shape \
                     on this grid. Force and pressure depend on the grid: choose a finer accuracy or a larger void."
                )
            });
        }
    }

    fn measure_shape(
        &mut self,
        fields: &Fields,
        summary: &Summary<{ STRAIN_BANDS.len() }>,
        added: Option<Summary<0>>,
        area_before: f64,
    ) {
        let solution = fields.solution();
        let problem = solution.problem();
        let (dome, sheet, x) = (&problem.obstacle.dome, problem.sheet(), solution.inner());
        let deformation = solution.deformation();

        let apex = deformation.at_apex(sheet, dome, x);
        self.apex_stretch = Some(apex.area_stretch().sqrt());
        let height = dome.top();
        let thickness: f64 = problem
            .materials
            .iter()
            .map(|m| m.thickness_mm * apex.thickness_stretch(m.poisson_ratio))
            .sum();
        self.skin_projection_mm = Some(height + thickness);

        let ratio = added.as_ref().map_or(summary.area_ratio, |added| added.area_ratio);
        self.area_ratio = Some(ratio);
        self.area_after_cm2 = Some(area_before * ratio / 100.0);
        self.area_gain_cm2 = Some(area_before * (ratio - 1.0) / 100.0);
        let fractions = STRAIN_BANDS.iter().zip(summary.fraction_above);
        self.strain = Some(Strains {
            max_principal: summary.greatest,
            mean_area: summary.area_ratio - 1.0,
            fraction_above: fractions
                .map(|(limit, fraction)| (format!("{limit:.2}"), fraction))
                .collect(),
            added: added.map(|added| AddedStrains {
                max_principal: added.greatest,
                mean_area: added.area_ratio - 1.0,
            }),
        });
    }

    /// Adds the loads of the membrane's layers.
    fn measure_loads(&mut self, solution: &Solution) {
        let loads = layers::loads(
            solution.problem().membrane(),
            solution.elastic_deformation(),
            solution.problem().wrinkles(),
        );
        for (layer, load) in self.layers.iter_mut().zip(loads) {
            layer.max_stress_kpa = Some(load.max_stress);
            layer.beyond_curve_data = load.is_beyond_data;
        }
    }

    /// Adds what the implant adds to the reserve and the stress of skin that has a state of its own.
    fn measure_added(&mut self, problem: &Problem) {
        if !problem.rest.has_own_skin() {
            return;
        }
        let natural = problem.rest.natural().map_or([1.0; 2], NaturalStretch::stretches);
        let strain = natural.map(|stretch| stretch - 1.0);
        let (skin, greatest) = (&problem.materials[0], strain[0].max(strain[1]));
        let used = self.skin_reserve_used.zip(problem.skin_knee());
        self.skin_reserve_added = used.map(|(used, knee)| used - greatest / knee);
        let [one, two] = biot_stress(&skin.curve, skin.poisson_ratio, strain);
        let layer = &mut self.layers[0];
        layer.added_stress_kpa = layer.max_stress_kpa.map(|stress| stress - one.max(two));
    }

    fn measure_contact(&mut self, fields: &Fields, selection: &Selection) {
        let solution = fields.solution();
        let dome = &solution.problem().obstacle.dome;
        self.projection_mm = Some(dome.top());
        self.implant_in_body =
            selection.wants("implant_in_body").then(|| in_body::of(solution)).flatten();
        if !selection.wants_any(&OF_CONTACT) {
            return;
        }
        let contact = fields.contact();
        // Without contact the sum of the forces is a negative zero.
        self.contact_force_n = Some(contact.vertical_force() / 1000.0 + 0.0);
        if solution.problem().tissue == Tissue::Layered {
            let resultant = contact.resultant() / 1000.0 + DVec3::ZERO;
            self.contact_resultant_n = Some(resultant.to_array());
        }
        self.contact_pressure_kpa = contact.pressure();
        self.pressure_peaks_kpa = contact.peaks();
        self.contact_pressure_mmhg = self
            .contact_pressure_kpa
            .map(|p| Pressure { mean: p.mean * MMHG_PER_KPA, max: p.max * MMHG_PER_KPA });
        if let Some(edge) = contact.edge(solution) {
            self.contact_material_radius_mm = Some(edge.material_radius);
            self.contact_angle_deg = dome.is_hemisphere().then(|| edge.angle.to_degrees());
        }
    }

    fn warn(
        &mut self,
        problem: &Problem,
        summary: &Summary<{ STRAIN_BANDS.len() }>,
        contact_nodes: usize,
    ) {
        if self.status == Status::NotConverged {
            self.warnings.push(
                "The computation is not finished; the estimated position error applies to all values. \
                 Without an estimate the error is unknown."
                    .to_owned(),
            );
        }
        for layer in self.layers.iter().filter(|layer| layer.beyond_curve_data) {
            self.warnings.push(format!(
                "The stress–strain curve of {} was extrapolated: the strains exceed its data.",
                layer.tissue
            ));
        }
        if problem.tissue == Tissue::Layered {
            let solids = self.layers.iter().zip(&problem.materials).skip(1);
            for (layer, _) in solids.filter(|(_, m)| m.poisson_ratio > MAX_POISSON_RATIO) {
                self.warnings.push(format!(
                    "The Poisson ratio of {} was computed as {MAX_POISSON_RATIO}; nearly incompressible solids \
                     are out of reach.",
                    layer.tissue
                ));
            }
        }
        let (sheet, springs) = (problem.sheet(), problem.springs);
        if let Some(part) = unresolved_part(problem, contact_nodes) {
            self.warnings.push(format!(
                "The computation is too coarse for {part} (points {:.2} mm apart). Stretch, stress, \
                 pressure and force are inaccurate there. Choose a finer accuracy (nodes per side).",
                sheet.spacing_mm()
            ));
        }
        if springs == Springs::Nikolaev && summary.greatest > UNEVEN_STRAIN {
            self.warnings.push(
                "The paper's springs have no stable homogeneous state at large strains; the shape \
                 depends on the grid. Coupled springs are stable in tension."
                    .to_owned(),
            );
        }
    }
}

/// Cells across a radius of curvature above which the grid resolves the curvature.
const LEAST_CELLS: f64 = 2.0;
/// Void above its greatest volume that a warning names \[greatest volume; mm³\].
const LARGER: f64 = 1.01;
const LEAST_VOID_MM3: f64 = 50.0;
/// The least strain at which a homogeneous stretch of the paper's springs is unstable \[-\] (adipose, ν 0.5).
const UNEVEN_STRAIN: f64 = 0.1;

/// The part of the implant, or its contact with `contact_nodes` nodes, that the grid does not resolve.
fn unresolved_part(problem: &Problem, contact_nodes: usize) -> Option<&'static str> {
    let Problem { rest, patch, obstacle, .. } = problem;
    let dome = &obstacle.dome;
    let least = LEAST_CELLS * rest.sheet().spacing_mm();
    let is_fully_in = dome.base_height >= 0.0;
    let room = patch.pocket_radius_mm - dome.center.length() - dome.reference_length();
    if dome.top() <= 0.0 {
        None
    } else if dome.shape.apex_radius() < least {
        Some("the implant's tip")
    } else if dome.wall_axes().min_element() < least {
        Some("the inserted part of the implant")
    } else if is_fully_in && dome.shape.rim_radius() < least && room < least {
        Some("the implant's rim")
    } else if contact_nodes > 0 && (contact_nodes as f64) < PI * LEAST_CELLS * LEAST_CELLS {
        Some("the small contact area")
    } else {
        None
    }
}

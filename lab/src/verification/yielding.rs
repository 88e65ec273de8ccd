//! Checks of implants that yield, against axisymmetric elements of gel, shell and tissue in contact.
//!
//! Uses `check`, `scene`, `simulate`. Used by `mod`.

use super::check::{Bound, Check};
use crate::solved;
use implant_preview_core::scene::{Scene, SceneError};
use implant_preview_core::simulate::{Simulation, Simulator};
use serde::Deserialize;
use serde_json::{Value, json};

/// The scenes of `tests/reference/soft.json`, each on two meshes, the finer one after the coarser one.
const CASES: &str = include_str!("../../../tests/reference/soft.json");
/// Nodes per side, and cells through the thickness.
const NODES: usize = 65;
const CELLS: usize = 3;
/// Spacing of a mound's grid \[mm\], and nodes from its centre to its edge.
const SPACING_MM: f64 = 4.0;
const HALF: u32 = 33;

#[derive(Deserialize)]
struct Case {
    name: String,
    base_radius_mm: f64,
    projection_mm: f64,
    pocket_radius_mm: f64,
    patch_radius_mm: f64,
    layers: Value,
    gel: Value,
    attachment_kpa_per_mm: f64,
    attachment_ramp_mm: f64,
    wall: Option<Wall>,
    mound: Option<Mound>,
    result: Expected,
}

#[derive(Deserialize)]
struct Wall {
    radius_mm: f64,
}

#[derive(Deserialize)]
struct Mound {
    height_mm: f64,
    width_mm: f64,
}

#[derive(Deserialize)]
struct Expected {
    force_n: f64,
    implant_height_mm: f64,
    implant_half_width_mm: f64,
    skin: Vec<[f64; 2]>,
}

/// An error of the file, which is a part of the program.
fn wrong(error: &serde_json::Error) -> SceneError {
    SceneError::Json { path: "soft.json".to_owned(), problem: error.to_string() }
}

impl Case {
    fn scene(&self, fill: &Value) -> Result<Scene, SceneError> {
        let mut scene = json!({
            "implant": {
                "base_radius_mm": self.base_radius_mm, "projection_mm": self.projection_mm, "fill": fill,
            },
            "pocket_radius_mm": self.pocket_radius_mm,
            "patch_radius_mm": self.patch_radius_mm,
            "attachment": {
                "stiffness_kpa_per_mm": self.attachment_kpa_per_mm, "ramp_mm": self.attachment_ramp_mm,
            },
            "layers": self.layers,
            "solver": { "nodes_per_side": NODES, "cells_through": CELLS },
        });
        if let Some(Wall { radius_mm }) = self.wall {
            scene["chest"] = json!({ "radius_across_mm": radius_mm, "radius_along_mm": radius_mm });
        }
        if let Some(Mound { height_mm, width_mm }) = self.mound {
            let fat_mm = self.layers[1]["thickness_mm"].as_f64().unwrap_or(f64::NAN);
            let side = 2 * HALF + 1;
            let factor = |k: u32| {
                let [x, y] = [k % side, k / side]
                    .map(|index| SPACING_MM * (f64::from(index) - f64::from(HALF)));
                1.0 + height_mm / fat_mm * (-(x * x + y * y) / (width_mm * width_mm)).exp()
            };
            let factors: Vec<f64> = (0..side * side).map(factor).collect();
            scene["thickness_field"] = json!({ "spacing_mm": SPACING_MM, "columns": side, "rows": side, "factors": factors });
        }
        Scene::from_json(&scene.to_string())
    }

    /// Relative errors of height, half width, force, and of the skin over the base radius.
    fn errors(&self, found: &Simulation) -> Option<[f64; 4]> {
        let (outcome, expected) = (&found.outcome, &self.result);
        let body = outcome.implant_in_body?;
        let apart = outcome.profile_skin.iter().zip(&expected.skin);
        let apart = apart.map(|(point, [r, z])| (point.r_mm - r).hypot(point.z_mm - z));
        Some([
            (body.height_mm / expected.implant_height_mm - 1.0).abs(),
            (body.half_width_mm[0] / expected.implant_half_width_mm - 1.0).abs(),
            (outcome.contact_force_n? / expected.force_n - 1.0).abs(),
            apart.fold(0.0, f64::max) / self.base_radius_mm,
        ])
    }
}

/// The result of an implant that yields against that of elements, and what it costs more than a rigid one.
pub(super) fn references() -> Result<Vec<Check>, SceneError> {
    let cases: Vec<Case> = serde_json::from_str(CASES).map_err(|error| wrong(&error))?;
    let mut simulator = Simulator::default();
    let mut checks = Vec::new();
    for case in cases.iter().skip(1).step_by(2) {
        let soft = solved(&mut simulator, case.scene(&case.gel)?)?;
        let rigid = solved(&mut simulator, case.scene(&json!("rigid"))?)?;
        let place = format!("{}; {NODES} nodes per side; {CELLS} cells", case.name);
        let figures = soft.as_ref().and_then(|found| case.errors(found));
        let names = ["height of the implant", "half width of the implant", "force", "skin"];
        let bounds = [0.02, 0.03, 0.02, 0.01];
        for ((name, figure), bound) in
            names.into_iter().zip(figures.unwrap_or([f64::NAN; 4])).zip(bounds)
        {
            let property = format!("{name} = elements of gel and shell in contact");
            checks.push(Check::at_most(&property, &place, figure, bound));
        }
        let work = |of: &Option<Simulation>| of.as_ref().map(|of| of.outcome.solver.work_units);
        let dearer = work(&soft).zip(work(&rigid)).map(|(soft, rigid)| soft / rigid);
        checks.push(Check {
            property: "work of an implant that yields / of a rigid one".to_owned(),
            place,
            figure: dearer.unwrap_or(f64::NAN),
            bound: Bound::AtMost(1.4),
        });
    }
    Ok(checks)
}

//! A case of the references of layered tissue as the input of the axisymmetric solver.

use implant_preview::curve::{Curve, ScaledCurve};
use implant_preview::mesh::Attachment;
use implant_preview::springs::Material;
use implant_preview_lab::axisymmetric_layers::{Input, RestShape};
use serde_json::{Value, json};

pub(crate) fn number(of: &Value, name: &str) -> f64 {
    of[name].as_f64().unwrap()
}

fn material(layer: &Value) -> Material {
    let curve = match &layer["curve"] {
        Value::String(kind) => json!({ "kind": kind }),
        curve => curve.clone(),
    };
    let curve: ScaledCurve = serde_json::from_value(curve).unwrap();
    let [poisson_ratio, thickness_mm] =
        ["poisson_ratio", "thickness_mm"].map(|name| number(layer, name));
    Material::new(Curve::scaled(&curve).unwrap(), poisson_ratio, thickness_mm)
}

/// The input on the mesh of the case, without wrinkles and flat.
pub(crate) fn input(case: &Value) -> Input {
    let count = |name: &str| usize::try_from(case["result"][name].as_u64().unwrap()).unwrap();
    Input {
        base_radius_mm: number(case, "base_radius_mm"),
        projection_mm: number(case, "projection_mm"),
        fullness: 2.0 / 3.0,
        insertion: number(case, "insertion"),
        pocket_radius_mm: number(case, "pocket_radius_mm"),
        patch_radius_mm: number(case, "patch_radius_mm"),
        attachment: Attachment {
            stiffness_kpa_per_mm: number(case, "attachment_kpa_per_mm"),
            ramp_mm: number(case, "attachment_ramp_mm"),
        },
        layers: case["layers"].as_array().unwrap().iter().map(material).collect(),
        skin_wrinkles: false,
        void_mm3: None,
        rest: RestShape::default(),
        cells: [count("nr"), count("nz")],
    }
}

//! Independent reference solutions of a membrane over a dome, and their scenes.

use implant_preview::scene::Scene;
use serde_json::{Value, json};

/// The reference cases, each with `scene` and `result`.
pub(crate) fn cases() -> Vec<Value> {
    let file: Value = serde_json::from_str(include_str!("../reference/membrane.json")).unwrap();
    file.as_array().unwrap().clone()
}

/// The scene of one of [`cases`].
pub(crate) fn scene_of(case: &Value) -> Scene {
    let layers: Vec<Value> = case["layers"]
        .as_array()
        .unwrap()
        .iter()
        .map(|layer| {
            let curve = match layer["curve"].as_str().unwrap() {
                "linear10" => json!({ "kind": "linear", "modulus_kpa": 10.0 }),
                kind => json!({ "kind": kind }),
            };
            json!({
                "tissue": layer["tissue"], "thickness_mm": layer["thickness_mm"],
                "poisson_ratio": layer["poisson"], "curve": curve,
            })
        })
        .collect();
    let radius = case["dome_radius_mm"].as_f64().unwrap();
    let scene = json!({
        "tissue_model": "sheet",
        "implant": { "base_radius_mm": radius },
        "pocket_radius_mm": case["pocket_radius_mm"],
        "insertion": case["apex_height_mm"].as_f64().unwrap() / radius,
        "layers": layers,
    });
    Scene::from_json(&scene.to_string()).unwrap()
}

//! What tests of the void share.

use implant_preview_core::scene::Scene;
use serde_json::{Value, json};

/// The scene of the opening plan's size with some members, over a flat wall.
pub(crate) fn scene(members: &Value) -> Scene {
    let mut scene = json!({
        "implant": { "base_radius_mm": 60.0, "projection_mm": 29.842 },
        "pocket_radius_mm": 70.0,
        "layers": [
            { "tissue": "skin", "thickness_mm": 1.5, "curve": { "kind": "skin" } },
            { "tissue": "adipose", "thickness_mm": 8.5, "poisson_ratio": 0.49, "curve": { "kind": "fat" } },
        ],
        "solver": { "nodes_per_side": 65 },
    });
    for (name, value) in members.as_object().unwrap() {
        scene[name] = value.clone();
    }
    Scene::from_json(&scene.to_string()).unwrap()
}

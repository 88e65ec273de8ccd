//! Scenes shared by the native and the wasm tests, and the native solutions.

use serde_json::{Value, json};

/// Small scenes that exercise every part of the solver.
pub(crate) fn scenes() -> Vec<(&'static str, Value)> {
    vec![
        (
            "layered",
            json!({ "implant": { "base_radius_mm": 55 }, "solver": { "nodes_per_side": 33 } }),
        ),
        (
            "layered-second",
            json!({ "schema": "implant-preview/scene/2", "implant": { "base_radius_mm": 55 },
                    "solver": { "nodes_per_side": 33 } }),
        ),
        (
            "sheet",
            json!({ "schema": "implant-preview/scene/2", "tissue_model": "sheet",
                    "implant": { "base_radius_mm": 55 }, "solver": { "nodes_per_side": 65 } }),
        ),
        (
            "off-centre",
            json!({ "schema": "implant-preview/scene/2", "tissue_model": "sheet",
                    "implant": { "base_radius_mm": 50, "center_mm": [12, -7] }, "pocket_radius_mm": 75,
                    "insertion": 0.7, "solver": { "nodes_per_side": 33 } }),
        ),
        (
            "flat-ellipsoid",
            json!({ "schema": "implant-preview/scene/2", "tissue_model": "sheet", "implant": { "base_radius_mm": 60, "projection_mm": 25 },
                    "layers": [
                        { "poisson_ratio": 0.3, "thickness_mm": 2,
                          "curve": { "kind": "exponential", "scale_kpa": 2, "rate": 5 } },
                        { "tissue": "adipose", "poisson_ratio": 0.5, "thickness_mm": 20,
                          "curve": { "kind": "points", "points": [[0, 0], [0.2, 1], [0.5, 1.5]],
                                     "interpolation": "spline" } } ],
                    "solver": { "nodes_per_side": 33 } }),
        ),
        (
            "paper-springs",
            json!({ "schema": "implant-preview/scene/2", "tissue_model": "sheet",
                    "implant": { "base_radius_mm": 40 }, "insertion": 0.5, "springs": "nikolaev",
                    "layers": [ { "poisson_ratio": 0.3 } ], "solver": { "nodes_per_side": 33 } }),
        ),
    ]
}

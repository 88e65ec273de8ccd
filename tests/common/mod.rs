//! Scenes shared by the native and the wasm tests, and the native solutions.

use serde_json::{Value, json};

/// Small scenes that exercise every part of the solver.
pub(crate) fn scenes() -> Vec<(&'static str, Value)> {
    let paper =
        json!([{}, { "tissue": "adipose", "thickness_mm": 10, "curve": { "kind": "adipose" } }]);
    vec![
        (
            "layered",
            json!({ "implant": { "base_radius_mm": 55 }, "solver": { "nodes_per_side": 33 } }),
        ),
        (
            "sheet",
            json!({ "tissue_model": "sheet", "layers": paper,
                    "implant": { "base_radius_mm": 55 }, "solver": { "nodes_per_side": 65 } }),
        ),
        (
            "off-centre",
            json!({ "tissue_model": "sheet", "layers": paper,
                    "implant": { "base_radius_mm": 50, "center_mm": [12, -7] }, "pocket_radius_mm": 75,
                    "insertion": 0.7, "solver": { "nodes_per_side": 33 } }),
        ),
        (
            "flat-ellipsoid",
            json!({ "tissue_model": "sheet", "implant": { "base_radius_mm": 60, "projection_mm": 25 },
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
            json!({ "tissue_model": "sheet",
                    "implant": { "base_radius_mm": 40 }, "insertion": 0.5, "springs": "nikolaev",
                    "layers": [ { "poisson_ratio": 0.3 } ], "solver": { "nodes_per_side": 33 } }),
        ),
    ]
}

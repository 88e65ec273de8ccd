//! A gap in a file of a scene is no value: `null` and numbers that are not finite are refused wherever the format names no `null`.

use super::pins::document_json;
use super::{Document, Scene};
use serde_json::{Value, json};

/// The only fields in which the format has `null`, and one that is any value.
const ALLOWED: [&str; 4] =
    ["chest.radius_along_mm", "chest.grid.heights_mm[0]", "chest.grid.heights_mm[1]", "id"];

/// Scenes that have every field of the format between them.
fn scenes() -> Vec<Value> {
    let curves = [
        json!({ "kind": "skin", "strain_scale": 1.1, "stress_scale": 0.9 }),
        json!({ "kind": "adipose" }),
        json!({ "kind": "fat", "variant": "mid" }),
        json!({ "kind": "linear", "modulus_kpa": 20 }),
        json!({ "kind": "arctangent", "scale_kpa": 10, "rate": 2 }),
        json!({ "kind": "exponential", "scale_kpa": 10, "rate": 2 }),
        json!({ "kind": "points", "points": [[0, 0], [1, 10]], "interpolation": "spline" }),
        json!({ "kind": "sections", "sections": [{ "kind": "linear", "from": 0, "to": 1, "modulus_kpa": 10 }] }),
    ];
    let layers: Vec<Value> = curves
        .iter()
        .map(|curve| json!({ "tissue": "skin", "thickness_mm": 2, "poisson_ratio": 0.45, "curve": curve }))
        .collect();
    let grid = |values: &str, value: f64| json!({ "spacing_mm": 50, "columns": 13, "rows": 13, values: vec![value; 169] });
    let full = json!({
        "schema": "implant-preview/scene/1", "id": 7,
        "implant": { "base_radius_mm": 60, "projection_mm": 40, "center_mm": [0, 0], "base_height_mm": 130, "apex_shift_mm": 5,
            "fill": { "modulus_kpa": 10, "shell_kpa_mm": 500 } },
        "pocket_radius_mm": 70, "tissue_model": "layered", "patch_radius_mm": 130,
        "attachment": { "stiffness_kpa_per_mm": 2, "ramp_mm": 10 },
        "skin_state": { "natural_tension_n_per_m": 2, "anisotropy": 1.5, "direction_deg": 30, "relaxed": 0.6, "grown": 0.3 },
        "pocket_lowered_mm": 14, "pocket_void_ml": 5, "posture": "standing", "chest": { "radius_across_mm": 140, "radius_along_mm": 400 },
        "insertion": 1, "layers": layers, "thickness_field": grid("factors", 1.0),
        "patient": { "base_width_mm": 120, "pinch_mm": 30, "skin_pull_mm": 20, "derived": [] },
        "pocket_plane": "dual_2", "side": "left", "visit": { "reference": "a", "date": "2024-02-29", "surgeon": "b", "remarks": "c",
            "fill_steps": { "start_ml": 100, "visit_ml": 50, "weeks": 1 } },
        "body": { "unit": "mm", "cover_mm": 10, "origin_mm": [80, 340, 120], "axes": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
            "marks": { "sternal_notch": [0, 500, 90], "navel": [0, 120, 154], "nipple_left": [113, 347, 180],
                "nipple_right": [-113, 347, 180], "fold_left": [108, 300, 120], "upper_left": [80, 441, 124],
                "medial_left": [24, 346, 152], "lateral_left": [140, 371, 85], "implant_centre_left": [86, 347, 180] },
            "proposed_marks": ["navel"] },
        "springs": "coupled", "solver": { "nodes_per_side": 33, "tolerance": 1e-3, "cells_through": "auto" },
        "pins": [{ "letter": "A", "name": "d", "scene": { "implant": { "base_radius_mm": 60, "projection_mm": 40 } } }],
    });
    let mut full = full;
    full["layers"][7]["tissue"] = json!("muscle");
    let mut scanned = full.clone();
    scanned["chest"] = json!({ "grid": grid("heights_mm", 0.0) });
    let mut sections = full.clone();
    sections["layers"] = ["linear", "cubic", "polynomial", "arctangent", "sine", "exponential"]
        .map(|kind| {
            let mut section = json!({ "kind": kind, "from": 0, "to": 1 });
            let fields = match kind {
                "linear" => json!({ "modulus_kpa": 10 }),
                "cubic" => json!({ "end_stress_kpa": 10, "end_slope_kpa": 20 }),
                "polynomial" => json!({ "coefficients_kpa": [10, 1] }),
                _ => json!({ "scale_kpa": 10, "rate": 1 }),
            };
            for (name, value) in fields.as_object().unwrap() {
                section[name] = value.clone();
            }
            json!({ "curve": { "kind": "sections", "sections": [section] } })
        })
        .into();
    vec![full, scanned, sections]
}

/// The schemas of an object: itself, behind a reference, and those of its kinds that fit.
fn schemas<'a>(schema: &'a Value, root: &'a Value, of: &Value, found: &mut Vec<&'a Value>) {
    if let Some(reference) = schema["$ref"].as_str() {
        schemas(root.pointer(reference.trim_start_matches('#')).unwrap(), root, of, found);
    }
    for list in ["allOf", "anyOf", "oneOf"] {
        for kind in schema[list].as_array().into_iter().flatten() {
            let name = &kind["properties"]["kind"]["const"];
            if name.is_null() || *name == of["kind"] {
                schemas(kind, root, of, found);
            }
        }
    }
    found.push(schema);
}

/// The paths of all fields of an object and its parts, and of all entries of lists, with their JSON pointers.
fn places(schema: &Value, root: &Value, of: &Value, at: [&str; 2], found: &mut Vec<[String; 2]>) {
    let [path, pointer] = at;
    let mut own = Vec::new();
    schemas(schema, root, of, &mut own);
    for (name, schema) in own.iter().filter_map(|schema| schema["properties"].as_object()).flatten()
    {
        let path = format!("{path}.{name}").trim_start_matches('.').to_owned();
        let pointer = format!("{pointer}/{name}");
        // A plan holds one of its own form.
        if name != "other_side" || of[name].is_object() {
            places(schema, root, &of[name], [&path, &pointer], found);
        }
        found.push([path, pointer]);
    }
    for (k, entry) in of.as_array().into_iter().flatten().enumerate().take(2) {
        let (path, pointer) = (format!("{path}[{k}]"), format!("{pointer}/{k}"));
        for schema in own.iter().filter(|schema| schema["items"].is_object()) {
            places(&schema["items"], root, entry, [&path, &pointer], found);
        }
        found.push([path, pointer]);
    }
}

/// A scene with a value at a pointer, whose object is there.
fn with(scene: &Value, pointer: &str, value: Value) -> Option<String> {
    let mut scene = scene.clone();
    let (parent, name) = pointer.rsplit_once('/')?;
    match scene.pointer_mut(parent)? {
        Value::Object(fields) => _ = fields.insert(name.to_owned(), value),
        Value::Array(list) => *list.get_mut(name.parse::<usize>().ok()?)? = value,
        _ => return None,
    }
    Some(scene.to_string())
}

#[test]
fn a_gap_in_any_field_of_a_scene_is_one_line_with_the_field() {
    let schema: Value = serde_json::from_str(&super::schema()).unwrap();
    let mut tried = Vec::new();
    for scene in scenes() {
        let mut found = Vec::new();
        places(&schema, &schema, &scene, ["", ""], &mut found);
        for [path, pointer] in found {
            let Some(text) = with(&scene, &pointer, Value::Null) else { continue };
            let error = Document::from_json(&text).err().map(|error| error.to_string());
            if ALLOWED.contains(&path.trim_start_matches("pins[0].scene.")) {
                assert!(error.is_none_or(|error| !error.contains("null")), "{path}");
                continue;
            }
            let error = error.unwrap_or_else(|| panic!("{path}: null is a value"));
            assert!(error.starts_with(&format!("{path} is null; allowed: ")), "{path}: {error}");
            assert!(
                !error.contains("f64") && !error.contains("usize") && !error.contains("enum"),
                "{error}"
            );
            for (number, word) in [("NaN", "nan"), ("-Infinity", "-inf"), ("Infinity", "inf")] {
                let text =
                    with(&scene, &pointer, json!("here")).unwrap().replacen("\"here\"", number, 1);
                let error = Document::from_json(&text).unwrap_err().to_string();
                assert!(
                    error.starts_with(&format!("{path} is {word}; allowed: ")),
                    "{path}: {error}"
                );
            }
            tried.push(path);
        }
    }
    tried.sort();
    tried.dedup();
    assert!(tried.len() > 90, "{}: {tried:?}", tried.len());
}

#[test]
fn the_line_of_a_gap_has_the_limits_of_the_field() {
    for (path, scene, wanted) in [
        ("implant.projection_mm", json!({ "projection_mm": null }), "2 to 120 mm, or leave it out"),
        (
            "implant.base_height_mm",
            json!({ "base_height_mm": null }),
            "20 to 240 mm, or leave it out",
        ),
        ("implant.center_mm", json!({ "center_mm": null }), "a list of 2 numbers, or leave it out"),
    ] {
        let mut scene = scene;
        scene["base_radius_mm"] = json!(60);
        let error = Scene::from_json(&json!({ "implant": scene }).to_string()).unwrap_err();
        assert_eq!(error.to_string(), format!("{path} is null; allowed: {wanted}"));
    }
    let scene = |text: &str| Scene::from_json(text).unwrap_err().to_string();
    assert_eq!(
        scene(r#"{"implant":{"base_radius_mm":null}}"#),
        "implant.base_radius_mm is null; allowed: 10 to 120 mm"
    );
    assert_eq!(
        scene(r#"{"implant":{"base_radius_mm":60},"tissue_model":null}"#),
        "tissue_model is null; allowed: `layered` or `sheet`, or leave it out"
    );
    assert_eq!(
        scene("{\"implant\":{\"base_radius_mm\":60,\n\"projection_mm\":NaN}}"),
        "implant.projection_mm is nan; allowed: 2 to 120 mm"
    );
}

#[test]
fn a_written_scene_has_no_null_but_that_of_a_straight_chest_and_is_read_again() {
    for mut scene in scenes() {
        scene["chest"] = json!({ "radius_across_mm": 140, "radius_along_mm": null });
        let document = Document::from_json(&scene.to_string()).unwrap();
        let scene = document.scene.into_scene();
        let text = document_json(&scene, &document.pins.unwrap_or_default());
        let nulls = text.matches("null").count();
        assert!(nulls == text.matches("\"radius_along_mm\": null").count() && nulls > 0, "{text}");
        assert_eq!(Document::from_json(&text).unwrap().scene.into_scene(), scene);
    }
}

//! The JavaScript API in a browser: equal results as natively.

#![cfg(target_arch = "wasm32")]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

mod common;
#[path = "common/samples.rs"]
mod samples;

use implant_preview::platform::js;
use serde_json::Value;
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;
use wasm_bindgen_test::{wasm_bindgen_test, wasm_bindgen_test_configure};

wasm_bindgen_test_configure!(run_in_browser);

fn message(error: wasm_bindgen::JsError) -> String {
    let value: JsValue = error.into();
    assert!(js_sys::Reflect::has(&value, &"stack".into()).unwrap(), "not an Error");
    js_sys::Reflect::get(&value, &"message".into()).unwrap().as_string().unwrap()
}

#[wasm_bindgen_test]
fn the_browser_computes_what_the_native_program_computes() {
    let native: Value = serde_json::from_str(include_str!("fixtures/profiles.json")).unwrap();
    for (name, scene) in common::scenes() {
        let result: Value =
            serde_json::from_str(&js::simulate(&scene.to_string().into()).unwrap_or_default())
                .unwrap();
        assert_eq!(result["status"], "converged", "{name}");
        assert!(result["solver"]["time_ms"].as_f64().unwrap() > 0.0);
        let radius = scene["implant"]["base_radius_mm"].as_f64().unwrap();
        let profile = result["profile"].as_array().unwrap();
        assert_eq!(profile.len(), native[name].as_array().unwrap().len());
        for (point, expected) in profile.iter().zip(native[name].as_array().unwrap()) {
            for (axis, field) in ["r_mm", "z_mm"].into_iter().enumerate() {
                let difference = point[field].as_f64().unwrap() - expected[axis].as_f64().unwrap();
                assert!(difference.abs() < 1e-5 * radius, "{name}: off by {difference:.1e} mm");
            }
        }
    }
}

#[wasm_bindgen_test]
fn invalid_input_throws_an_error_of_one_line() {
    for (scene, expected) in [
        ("{", "ends too early"),
        ("{}", "implant"),
        (
            r#"{"implant":{"base_radius_mm":500}}"#,
            "implant.base_radius_mm is 500; allowed: 10 to 120 mm",
        ),
        (r#"{"implant":{"base_radius_mm":50,"colour":1}}"#, "colour"),
        (r#"{"implant":{"base_radius_mm":50},"springs":"steel"}"#, "springs"),
    ] {
        let text = message(js::simulate(&scene.into()).err().unwrap());
        assert!(text.contains(expected), "{text}");
        assert!(!text.contains('\n'), "{text}");
    }
}

/// These inputs had ended in "memory access out of bounds".
#[wasm_bindgen_test]
fn input_other_than_text_is_rejected_with_a_message() {
    for value in [5.into(), JsValue::NULL, JsValue::TRUE, js_sys::Object::new().into()] {
        let text = message(js::simulate(&value).err().unwrap());
        assert_eq!(text, "scene is not text; allowed: a string");
    }
}

#[wasm_bindgen_test]
fn the_default_scene_and_the_version_are_valid() {
    let scene: Value = serde_json::from_str(&js::default_scene()).unwrap();
    assert_eq!(scene["schema"], "implant-preview/scene/1");
    assert_eq!(scene["tissue_model"], "layered");
    assert_eq!(scene["solver"]["nodes_per_side"], 129);
    let opening: Value = serde_json::from_str(&js::opening_scene()).unwrap();
    assert_eq!(opening["patient"]["pinch_mm"], 20.0);
    assert_eq!(opening["pocket_radius_mm"], 70.0);
    assert_eq!(js::version(), env!("CARGO_PKG_VERSION"));
}

#[wasm_bindgen_test]
fn the_schema_is_that_of_a_scene() {
    let schema: Value = serde_json::from_str(&js::schema()).unwrap();
    assert!(schema["properties"]["implant"].is_object());
}

#[wasm_bindgen_test]
fn the_benchmark_runs_piece_by_piece() {
    let options =
        r#"{"quick": true, "nodes_per_side": [17], "methods": ["newton", "multigrid_8"]}"#;
    let mut benchmark = js::Benchmark::new(&options.into()).ok().unwrap();
    let progress: Value = serde_json::from_str(&benchmark.progress()).unwrap();
    let next = serde_json::json!({"scene": "default", "nodes_per_side": 17, "method": "newton"});
    assert_eq!(progress, serde_json::json!({"done": 0, "all": 2, "next": next}));
    assert!(benchmark.advance().ok().unwrap());
    assert!(benchmark.advance().ok().unwrap());
    assert!(!benchmark.advance().ok().unwrap());
    let progress: Value = serde_json::from_str(&benchmark.progress()).unwrap();
    assert_eq!(progress, serde_json::json!({"done": 2, "all": 2, "next": null}));
    assert_eq!(benchmark.csv().lines().count(), 1 + 3 + 1);
    let times: Value = serde_json::from_str(&benchmark.times_to(1e-3)).unwrap();
    assert_eq!(times[1]["method"], "multigrid_8");
    assert!(times[1]["time_ms"].as_f64().unwrap() > 0.0);
    assert!(benchmark.svg(&JsValue::UNDEFINED).ok().unwrap().contains("17 nodes a side"));
    let text = message(benchmark.svg(&"moon".into()).err().unwrap());
    assert!(text.starts_with("scene is \"moon\"; allowed: default, "), "{text}");
    let text = message(js::Benchmark::new(&"{".into()).err().unwrap());
    assert!(text.starts_with("options: ") && !text.contains('\n'), "{text}");
    let text = message(js::Benchmark::new(&5.into()).err().unwrap());
    assert_eq!(text, "options is not text; allowed: a string");
}

/// Yields to the browser, which stops a page without response.
async fn rest() {
    let soon = js_sys::Promise::new(&mut |resolve, _| {
        let timer = js_sys::Reflect::get(&js_sys::global(), &"setTimeout".into()).unwrap();
        timer.unchecked_into::<js_sys::Function>().call1(&JsValue::NULL, &resolve).unwrap();
    });
    JsFuture::from(soon).await.unwrap();
}

#[wasm_bindgen_test]
async fn random_scenes_satisfy_all_invariants() {
    use implant_preview_lab::robustness::{Ending, run};
    for number in 0..500 {
        let case = run(5, number, 25);
        assert!(case.ending != Ending::Failed, "{case:?}");
        rest().await;
    }
}

#[wasm_bindgen_test]
fn samples_are_equal_to_the_native_samples() {
    assert_eq!(samples::samples(), samples::SAMPLES);
}

//! `fixtures/profiles.json` contains the native solutions of the shared scenes for the wasm tests. This test compares
//! the file with the solver: after a change of the physics, run
//! `cargo test --release --test native_profiles -- --ignored` to rewrite the file.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

mod common;

use implant_preview::scene::Scene;
use implant_preview::simulate::simulate;
use serde_json::{Map, Value};

fn profiles() -> Value {
    let mut all = Map::new();
    for (name, scene) in common::scenes() {
        let outcome = simulate(&Scene::from_json(&scene.to_string()).unwrap()).unwrap();
        let profile: Vec<[f64; 2]> = outcome.profile.iter().map(|p| [p.r_mm, p.z_mm]).collect();
        all.insert(name.to_owned(), serde_json::to_value(profile).unwrap());
    }
    Value::Object(all)
}

#[test]
fn the_fixture_equals_the_native_solutions() {
    let fixture: Value = serde_json::from_str(include_str!("fixtures/profiles.json")).unwrap();
    for (name, profile) in profiles().as_object().unwrap() {
        for (a, b) in profile.as_array().unwrap().iter().zip(fixture[name].as_array().unwrap()) {
            for axis in 0..2 {
                let difference = a[axis].as_f64().unwrap() - b[axis].as_f64().unwrap();
                assert!(difference.abs() < 1e-6, "{name}: off by {difference:.1e} mm");
            }
        }
    }
}

#[test]
#[ignore = "writes the fixture"]
fn write_the_fixture() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/profiles.json");
    std::fs::write(path, serde_json::to_string(&profiles()).unwrap() + "\n").unwrap();
}

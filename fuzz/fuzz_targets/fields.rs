//! Scenes with all fields, their values mostly in range.
#![no_main]

#[path = "../../tests/common/hostile.rs"]
#[allow(dead_code)]
mod hostile;

use implant_preview::scene::Scene;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    hostile::check_scene(&Scene::from_json(&hostile::Choices(bytes).scene()));
});

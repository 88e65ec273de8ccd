//! Any bytes as a scene and as a list of pins; layered tissue is solved on a coarse grid.
#![no_main]

#[path = "../../tests/common/hostile.rs"]
#[allow(dead_code)]
mod hostile;

use implant_preview::scene::Scene;
use implant_preview::scene::pins::pins_from_json;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Ok(text) = std::str::from_utf8(bytes) {
        let read = Scene::from_json(text);
        hostile::check_scene(&read);
        if let Ok(scene) = &read {
            hostile::check_layered_solve(scene);
        }
        if let Err(error) = pins_from_json(text) {
            hostile::check_message(&error);
        }
    }
});

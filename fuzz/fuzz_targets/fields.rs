//! Scenes with all fields, their values mostly in range, of sheets and of layered tissue, also over a curved chest; the latter
//! are solved on a coarse grid.
#![no_main]

#[path = "../../tests/common/hostile.rs"]
#[allow(dead_code)]
mod hostile;

use implant_preview::scene::Scene;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    hostile::check_scene(&Scene::from_json(&hostile::choices::Choices(bytes).scene()));
    hostile::check_scene(&Scene::from_json(&hostile::choices::Choices(bytes).scanned_scene()));
    let layered = hostile::choices::Choices(bytes).layered_scene();
    for text in [layered, hostile::choices::Choices(bytes).chest_scene()] {
        let read = Scene::from_json(&text);
        hostile::check_scene(&read);
        if let Ok(scene) = &read {
            hostile::check_layered_solve(scene);
        }
    }
});

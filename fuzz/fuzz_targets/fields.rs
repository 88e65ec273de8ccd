//! Scenes with all fields, their values mostly in range, of sheets and of layered tissue; the latter are solved on a coarse
//! grid.
#![no_main]

#[path = "../../tests/common/hostile.rs"]
#[allow(dead_code)]
mod hostile;

use implant_preview::scene::Scene;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    hostile::check_scene(&Scene::from_json(&hostile::Choices(bytes).scene()));
    hostile::check_scene(&Scene::from_json(&hostile::Choices(bytes).scanned_scene()));
    let layered = Scene::from_json(&hostile::Choices(bytes).layered_scene());
    hostile::check_scene(&layered);
    if let Ok(scene) = &layered {
        hostile::check_layered_solve(scene);
    }
});

//! Axes of maps and choices of bands from any text.
#![no_main]

use implant_preview::scene::Scene;
use implant_preview::study::{Axis, Bands, BandsSettings, Map, MapSettings};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let scene = Scene::sheet();
    if let Ok(axis) = Axis::parse(text) {
        let _ = Map::new(&scene, &[axis], MapSettings::default());
    }
    if let Ok(choices) = BandsSettings::from_json(text) {
        let _ = Bands::new(&scene, choices);
    }
});

//! Solves one scene and prints some of its results.
//!
//! Run: `cargo run --release --no-default-features --example simulate [SCENE.json]`
//!
//! Without an argument the scene is a hemisphere of 55 mm under skin and adipose, 80 % inserted. Fields
//! and units of scene and result: `docs/formats.md`.

#![allow(clippy::print_stdout, reason = "an example prints")]

use implant_preview::scene::Scene;
use implant_preview::simulate::simulate;
use std::error::Error;

const SCENE: &str = r#"{
    "implant": { "base_radius_mm": 55.0 },
    "insertion": 0.8,
    "solver": { "nodes_per_side": 65 }
}"#;

fn main() -> Result<(), Box<dyn Error>> {
    let json = match std::env::args().nth(1) {
        Some(path) => std::fs::read_to_string(path)?,
        None => SCENE.to_owned(),
    };
    let scene = Scene::from_json(&json)?;
    let outcome = simulate(&scene)?;

    println!("status          {:?}", outcome.status);
    print("contact force", outcome.contact_force_n, "N");
    print("skin projection", outcome.skin_projection_mm, "mm");
    print("area gain", outcome.area_gain_cm2, "cm²");
    print("greatest strain", outcome.strain.map(|strain| 100.0 * strain.max_principal), "%");
    for layer in &outcome.layers {
        print(&layer.tissue, layer.max_stress_kpa, "kPa");
    }
    for warning in &outcome.warnings {
        println!("warning         {warning}");
    }
    Ok(())
}

/// Prints one line; a quantity without a shape to be computed from is `None`.
fn print(name: &str, value: Option<f64>, unit: &str) {
    match value {
        Some(value) => println!("{name:15} {value:.3} {unit}"),
        None => println!("{name:15} -"),
    }
}

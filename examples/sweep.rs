//! Sweeps the insertion from 0 to 1 and prints a table: force, skin projection and area ratio.
//!
//! Run: `cargo run --release --no-default-features --example sweep [STEPS]` (default: 10 steps)
//!
//! Every row is a solve from scratch, so that the rows do not depend on their order.

#![allow(clippy::print_stdout, reason = "an example prints")]

use implant_preview::scene::Scene;
use implant_preview::simulate::simulate;
use std::error::Error;

fn main() -> Result<(), Box<dyn Error>> {
    let steps: u32 = match std::env::args().nth(1) {
        Some(steps) => steps.parse()?,
        None => 10,
    };
    let mut scene = Scene::default();
    scene.solver.nodes_per_side = 65;

    println!("insertion  force [N]  projection [mm]  area ratio [-]  status");
    for step in 0..=steps {
        scene.insertion = f64::from(step) / f64::from(steps.max(1));
        let outcome = simulate(&scene)?;
        println!(
            "{:9.2}  {:>9}  {:>15}  {:>14}  {:?}",
            scene.insertion,
            text(outcome.contact_force_n, 2),
            text(outcome.skin_projection_mm, 1),
            text(outcome.area_ratio, 4),
            outcome.status
        );
    }
    Ok(())
}

/// A number with so many digits after the point; a quantity that does not apply is `-`.
fn text(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "-".to_owned(), |value| format!("{value:.digits$}"))
}

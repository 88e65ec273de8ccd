//! Times of a fit of a torso of 104 000 triangles: `cargo bench -p implant-preview-body`.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a bench prints")]

#[path = "../tests/common/torso.rs"]
mod torso;

use implant_preview_body::fit::{Settings, fit};
use implant_preview_body::marks::Side;
use std::time::Instant;

fn main() {
    let (surface, marks) = (torso::torso(62.3, 228, 228), torso::marks(62.3));
    let mut times: Vec<f64> = (0..21)
        .map(|_| {
            let start = Instant::now();
            let found = fit(&surface, &marks, Side::Left, &Settings::default());
            assert!(found.is_ok());
            1e3 * start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_unstable_by(f64::total_cmp);
    println!("{} triangles: fit {:.1} ms (median of 21)", surface.triangles.len(), times[10]);
}

//! Times of a fit, of proposed marks and of picking on a torso of 104 000 triangles: `cargo bench -p implant-preview-body`.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a bench prints")]

#[path = "../tests/common/torso.rs"]
mod torso;

use glam::DVec3;
use implant_preview_body::fit::{Settings, fit};
use implant_preview_body::marks::Side;
use implant_preview_body::pick::{first_hit, snap};
use implant_preview_body::propose::propose;
use std::time::Instant;

fn main() {
    let (surface, marks) = (torso::torso(62.3, 228, 228), torso::marks(62.3));
    let fitted = || fit(&surface, &marks, Side::Left, &Settings::default()).is_ok();
    println!("{} triangles, medians of 21:", surface.triangles.len());
    println!("fit {:.1} ms", median_ms(fitted));
    println!("propose {:.1} ms", median_ms(|| propose(&surface).is_ok()));
    println!("snap {:.1} ms", median_ms(|| snap(&surface, marks.navel).is_some()));
    let from = marks.nipples[0] + DVec3::Z * 500.0;
    println!("first hit {:.1} ms", median_ms(|| first_hit(&surface, from, -DVec3::Z).is_some()));
}

/// The median time of a call that succeeds \[ms\].
fn median_ms(call: impl Fn() -> bool) -> f64 {
    let mut times: Vec<f64> = (0..21)
        .map(|_| {
            let start = Instant::now();
            assert!(call());
            1e3 * start.elapsed().as_secs_f64()
        })
        .collect();
    times.sort_unstable_by(f64::total_cmp);
    times[10]
}

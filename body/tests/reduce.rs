//! Surfaces with fewer vertices.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test stops where something is missing"
)]

#[path = "common/torso.rs"]
mod formula;

use implant_preview_body::pick::snap;
use implant_preview_body::reduce::reduced;
use implant_preview_body::torso::builtin;

#[test]
fn a_trunk_keeps_its_shape_with_a_quarter_of_its_vertices() {
    let surface = formula::torso(62.3, 228, 228);
    let found = reduced(&surface, 12_000, 24_000);
    let (vertices, triangles) = (found.positions.len(), found.triangles.len());
    println!("{vertices} vertices, {triangles} triangles");
    assert!((9_000..=12_000).contains(&vertices) && triangles <= 24_000);
    assert!(found.triangles.iter().flatten().all(|k| (*k as usize) < vertices));
    let apart =
        surface.positions.iter().step_by(37).map(|p| snap(&found, *p).unwrap().point.distance(*p));
    let apart: Vec<f64> = apart.collect();
    let rms = (apart.iter().map(|x| x * x).sum::<f64>() / apart.len() as f64).sqrt();
    let most = apart.iter().copied().fold(0.0, f64::max);
    println!("{rms:.3} mm root mean square, {most:.3} mm at most");
    assert!(rms < 0.3 && most < 3.0, "{rms} {most}");
    assert!((found.signed_volume() / surface.signed_volume() - 1.0).abs() < 0.005);
    assert_eq!(found.parts(), 1);
}

#[test]
fn a_small_surface_keeps_its_vertices_and_a_limit_holds() {
    let surface = builtin().surface;
    assert_eq!(reduced(&surface, 12_000, 24_000), surface);
    for most in [3000, 100, 3] {
        let found = reduced(&surface, most, 2 * most);
        assert!(found.positions.len() <= most && found.triangles.len() <= 2 * most);
    }
}

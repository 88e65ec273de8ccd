//! Comparison with theory: small strain, the limit of fine grids, bitwise reproducibility.

#![cfg(not(target_arch = "wasm32"))] // threads
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use glam::{DMat2, DVec2};
use implant_preview::curve::{Curve, CurveSpec};
use implant_preview::scene::Scene;
use implant_preview::simulate::simulate;
use implant_preview::solve::{Method, Options, Problem, Progress, Solver};
use implant_preview::springs::Springs;
use implant_preview_lab::axisymmetric;
use implant_preview_lab::sample::Sample;
use serde_json::json;
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

const MODULUS_KPA: f64 = 10.0;

/// Greatest force of a sample under `stress` with a homogeneous small strain, relative to the load; both along and
/// across the tension, at an angle to the grid.
fn imbalance(springs: Springs, nu: f64, angle: f64, strain: [f64; 2], stress: f64) -> f64 {
    let curve = Curve::new(&CurveSpec::Linear { modulus_kpa: MODULUS_KPA }).unwrap();
    let sample = Sample::new(3, springs, &curve, nu);
    let turn = DMat2::from_angle(angle);
    let tensor = |along: f64, across: f64| {
        turn * DMat2::from_diagonal(DVec2::new(along, across)) * turn.transpose()
    };
    let stretch = tensor(1.0 + strain[0], 1.0 + strain[1]);
    let x: Vec<DVec2> = sample.rest().iter().map(|p| stretch * *p).collect();
    let loads = sample.border_loads(tensor(stress, 0.0));
    let greatest = loads.iter().map(|load| load.length()).fold(0.0, f64::max);
    let forces = sample.forces(&x);
    forces.iter().zip(&loads).map(|(f, load)| (*f + *load).length()).fold(0.0, f64::max) / greatest
}

/// At small strain the coupled law is Hooke's for plane stress: E and ν in every direction.
#[test]
fn coupled_springs_are_isotropic_at_small_strain() {
    let small = 1e-7;
    for nu in [0.0, 0.2, 1.0 / 3.0, 0.45, 0.5] {
        for degrees in (0..180).step_by(15) {
            let angle = f64::from(degrees).to_radians();
            let at = |nu_shown: f64, modulus: f64| {
                let strain = [small, -nu_shown * small];
                imbalance(Springs::Coupled, nu, angle, strain, modulus * small)
            };
            assert!(at(nu, MODULUS_KPA) < 1e-6, "ν {nu} at {degrees}°");
            assert!(at(nu + 0.01, MODULUS_KPA) > 1e-3 && at(nu, 1.01 * MODULUS_KPA) > 1e-3);
        }
    }
}

/// The paper's lattice at small strain and Ef = Eε. Per Sq the tensions are, from (3) and (6),
///
/// * edges: E(1 − ν)ε stretched, Eε compressed;
/// * diagonals: kε stretched with k = 2√2 E ν/(1 − ν), because J = 2ε/(1 − ν); Eε compressed.
///
/// With Sq = Lh/2 in each cell the stresses are, edges t₁, t₂ and diagonals d₁, d₂,
///
/// > P₁₁ = t₁ + (d₁ + d₂)/√8, P₂₂ = t₂ + (d₁ + d₂)/√8, P₁₂ = (d₁ − d₂)/√8.
///
/// Along an edge: t₁ = E(1 − ν)ε, t₂ = −Eνε, d = k(1 − ν)ε/2 give P₁₁ = Eε, P₂₂ = 0: E and ν as given.
/// Along a diagonal P₁₁ = P₂₂ = P₁₂ = σ/2; the edges have the mean strain e = (1 − ν₄₅)ε/2, the diagonal
/// along is stretched, the diagonal across compressed by ν₄₅ε. P₁₁ = P₁₂ is E(1 − ν)e + d₂/√2 = 0, so that
///
/// > ν₄₅ = a/(1 + a) with a = (1 − ν)/√2, E₄₅ = P₁₁ + P₁₂ over ε = E(1 − ν)(1 − ν₄₅)/2 + k/√2.
///
/// At ν = 1/3 that is ν₄₅ = 0.320 and E₄₅ = 1.227 E: the lattice is stiffer along its diagonals.
fn paper_lattice_at_45_degrees(nu: f64) -> [f64; 2] {
    let a = (1.0 - nu) * FRAC_1_SQRT_2;
    let nu_45 = a / (1.0 + a);
    let k = 2.0 * SQRT_2 * nu / (1.0 - nu);
    [nu_45, 0.5 * (1.0 - nu) * (1.0 - nu_45) + k * FRAC_1_SQRT_2]
}

#[test]
fn the_papers_lattice_has_its_small_strain_stiffness_along_edges_and_diagonals() {
    let small = 1e-7;
    for nu in [0.0, 0.1, 0.2, 1.0 / 3.0, 0.45, 0.49] {
        let [nu_45, share] = paper_lattice_at_45_degrees(nu);
        for (degrees, nu_shown, modulus) in
            [(0.0, nu, MODULUS_KPA), (90.0, nu, MODULUS_KPA), (45.0, nu_45, share * MODULUS_KPA)]
        {
            let at = |nu_shown: f64, modulus: f64| {
                let angle = f64::to_radians(degrees);
                let strain = [small, -nu_shown * small];
                imbalance(Springs::Nikolaev, nu, angle, strain, modulus * small)
            };
            assert!(at(nu_shown, modulus) < 1e-6, "ν {nu} at {degrees}°");
            assert!(at(nu_shown + 0.01, modulus) > 1e-3 && at(nu_shown, 1.01 * modulus) > 1e-3);
        }
    }
    let [nu_45, share] = paper_lattice_at_45_degrees(1.0 / 3.0);
    assert!((nu_45 - 0.320).abs() < 5e-4 && (share - 1.227).abs() < 5e-4, "{nu_45} {share}");
}

/// Second order: (4·fine − coarse)/3 cancels the second-order error.
#[test]
fn shapes_extrapolated_to_zero_spacing_agree_with_the_axisymmetric_reference() {
    let layer = |kind: &str| json!([{ "thickness_mm": 2, "curve": { "kind": kind } }]);
    for (pocket, projection, insertion, layers) in [
        (70.0, 50.0, 1.0, layer("skin")),
        (68.0, 35.0, 1.0, layer("adipose")),
        (50.0, 50.0, 1.0, layer("skin")),
        (90.0, 50.0, 0.6, json!([{ "curve": { "kind": "linear", "modulus_kpa": 10 } }])),
    ] {
        // The 41 points of a profile are nodes of these grids, without interpolation.
        let [coarse, fine] = [81, 161].map(|nodes| {
            let scene = json!({
                "tissue_model": "sheet",
                "implant": { "base_radius_mm": 50, "projection_mm": projection },
                "pocket_radius_mm": pocket, "insertion": insertion, "layers": layers,
                "solver": { "nodes_per_side": nodes, "tolerance": 1e-7 },
            });
            Scene::from_json(&scene.to_string()).unwrap()
        });
        let Problem { obstacle, patch, materials, .. } = coarse.problem().unwrap();
        let reference =
            axisymmetric::solve(&obstacle.dome, patch.pocket_radius_mm, &materials).unwrap();
        let [coarse, fine] = [coarse, fine].map(|scene| simulate(&scene).unwrap());
        let error = |share: f64| {
            let pairs = coarse.profile.iter().zip(&fine.profile);
            let squares: f64 = pairs
                .map(|(coarse, fine)| {
                    let point = reference.point(fine.s_mm);
                    let r = fine.r_mm + share * (fine.r_mm - coarse.r_mm) - point.r_mm;
                    let z = fine.z_mm + share * (fine.z_mm - coarse.z_mm) - point.z_mm;
                    r * r + z * z
                })
                .sum();
            (squares / fine.profile.len() as f64).sqrt() / 50.0
        };
        let (before, after) = (error(0.0), error(1.0 / 3.0));
        println!("root of the mean square {before:.1e}, extrapolated {after:.1e}");
        assert!(after < 0.4 * before && after < 5e-6, "{before:.1e} {after:.1e}");
        let areas = [&coarse, &fine].map(|outcome| outcome.area_ratio.unwrap());
        let errors = [areas[1], (4.0 * areas[1] - areas[0]) / 3.0]
            .map(|area| (area / reference.area_ratio - 1.0).abs());
        println!("area {:.1e}, extrapolated {:.1e}", errors[0], errors[1]);
        assert!(errors[1] < 0.5 * errors[0] && errors[1] < 1e-5, "{errors:?}");
    }
}

/// Strain energy \[kPa·mm³\] of a solver's shape, from the triangles' metrics alone.
fn energy(solver: &Solver) -> f64 {
    let (sheet, x) = (solver.problem().sheet(), solver.positions());
    let law = solver.coupled_law().unwrap();
    let triangle = |([a, b, c], weight): ([usize; 3], f64)| {
        let rest =
            DMat2::from_cols(sheet.rest()[b] - sheet.rest()[a], sheet.rest()[c] - sheet.rest()[a]);
        let (p, q) = (x[b] - x[a], x[c] - x[a]);
        let metric = DMat2::from_cols_array(&[p.dot(p), p.dot(q), p.dot(q), q.dot(q)]);
        let inverse = rest.inverse();
        let metric = inverse.transpose() * metric * inverse;
        let mean = 0.5 * (metric.x_axis.x + metric.y_axis.y);
        let radius = (mean * mean - metric.determinant()).max(0.0).sqrt();
        let strain = [mean + radius, mean - radius].map(|square| square.max(0.0).sqrt() - 1.0);
        weight * 0.5 * rest.determinant() * law.energy(strain)
    };
    sheet.triangles().map(triangle).sum()
}

/// Up to the contact offsets, which change the constraints.
#[test]
fn every_step_of_newtons_method_lowers_the_energy() {
    for mut scene in ten_scenes() {
        scene.springs = Springs::Coupled;
        let options = Options { method: Method::Newton, ..Options::default() };
        let mut solver = Solver::with_options(scene.problem().unwrap(), options);
        let (mut moves, mut energies) = (solver.revision(), Vec::new());
        while solver.advance(&mut || true) == Progress::Working && solver.offset_nodes().is_empty()
        {
            if solver.revision() != moves {
                moves = solver.revision();
                energies.push(energy(&solver));
            }
        }
        assert!(energies.len() >= 2, "{energies:?}");
        for pair in energies.windows(2) {
            assert!(pair[1] <= pair[0] * (1.0 + 1e-12), "{energies:?}");
        }
    }
}

/// Ten different scenes.
fn ten_scenes() -> Vec<Scene> {
    (0..10_u8)
        .map(|k| {
            let t = f64::from(k);
            let curves = [
                json!({ "kind": "skin" }),
                json!({ "kind": "adipose" }),
                json!({ "kind": "linear", "modulus_kpa": 5.0 + t }),
                json!({ "kind": "points", "interpolation": "spline",
                    "points": [[0, 0], [0.2, 2], [0.5, 9 + k], [1, 60]] }),
                json!({ "kind": "exponential", "scale_kpa": 2, "rate": 3 }),
            ];
            let curve = |k: u8| curves[usize::from(k) % curves.len()].clone();
            let layer = |k: u8| {
                json!({ "thickness_mm": 1 + k % 3, "poisson_ratio": 0.05 * f64::from(k % 10),
                    "curve": curve(k) })
            };
            let is_paper = k == 7;
            let layers = if is_paper {
                json!([{ "poisson_ratio": 0.2 }])
            } else {
                json!([layer(k), layer(k + 3)])
            };
            let offset = if k % 2 == 0 { [0.0, 0.0] } else { [1.5 * t, -t] };
            let scene = json!({
                "tissue_model": "sheet",
                "implant": { "base_radius_mm": 30.0 + 4.0 * t, "center_mm": offset,
                    "projection_mm": 25.0 + 3.0 * t },
                "insertion": 1.0 - 0.06 * t,
                "springs": if is_paper { "nikolaev" } else { "coupled" },
                "layers": layers,
                "solver": { "nodes_per_side": 33, "tolerance": 1e-5 },
            });
            Scene::from_json(&scene.to_string()).unwrap()
        })
        .collect()
}

/// FNV-1a over the bits of all positions.
fn digest(scene: &Scene) -> u64 {
    let mut solver = Solver::new(scene.problem().unwrap());
    while solver.advance(&mut || true) == Progress::Working {}
    let coordinates = solver.positions().iter().flat_map(glam::DVec3::to_array);
    coordinates.flat_map(|c| c.to_bits().to_le_bytes()).fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

#[test]
fn ten_scenes_have_the_same_bits_on_every_run_and_on_any_number_of_threads() {
    let scenes = ten_scenes();
    let first: Vec<u64> = scenes.iter().map(digest).collect();
    for k in 1..first.len() {
        assert!(!first[..k].contains(&first[k]), "scene {k} is like one before");
    }
    for threads in [1, 2, 4] {
        let mut found = vec![0; scenes.len()];
        std::thread::scope(|scope| {
            let share = scenes.len().div_ceil(threads);
            for (scenes, found) in scenes.chunks(share).zip(found.chunks_mut(share)) {
                scope.spawn(move || {
                    for (scene, found) in scenes.iter().zip(found) {
                        *found = digest(scene);
                    }
                });
            }
        });
        assert_eq!(found, first, "{threads} threads");
    }
}

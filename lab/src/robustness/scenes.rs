//! Random sheets within all limits of a scene file, realistic and extreme.

use fastrand::Rng;
use implant_preview_core::curve::{CurveSpec, Interpolation, Section};
use implant_preview_core::scene::{
    Body, Field, Implant, Layer, Scene, SolverSettings, Springs, TissueModel, limits,
};
use std::f64::consts::TAU;

/// Range of the layers' moduli \[kPa\]: from much softer than fat to much stiffer than tendon.
const MODULUS_KPA: (f64, f64) = (1e-2, 1e5);

/// A uniform random number of a range.
pub(super) fn uniform(rng: &mut Rng, (least, most): (f64, f64)) -> f64 {
    least + (most - least) * rng.f64()
}

/// A random number of a range with a uniform logarithm.
pub(super) fn log_uniform(rng: &mut Rng, (least, most): (f64, f64)) -> f64 {
    // exp ∘ ln may exceed a bound by rounding.
    uniform(rng, (least.ln(), most.ln())).exp().clamp(least, most)
}

/// A random sheet within all limits.
pub(super) fn scene(rng: &mut Rng) -> Scene {
    let mut scene = Scene {
        body: Body::around(70.0, TissueModel::Sheet),
        insertion: insertion(rng),
        layers: layers(rng),
        springs: if rng.u8(0..100) < 85 { Springs::Coupled } else { Springs::Nikolaev },
        solver: SolverSettings {
            nodes_per_side: nodes(rng),
            tolerance: tolerance(rng),
            cells_through: None,
        },
        ..Scene::default()
    };
    dome_and_pocket(rng, &mut scene);
    scene
}

/// Replaces the scene's dome and pocket by random ones.
pub(super) fn dome_and_pocket(rng: &mut Rng, scene: &mut Scene) {
    let most = limits::POCKET_RADIUS_MAX_MM;
    let radius = log_uniform(rng, Field::BaseRadius.limits);
    let (least_projection, most_projection) = Field::Projection.limits;
    let projection = if rng.u8(0..10) < 4 {
        // Aspect ratios of real implants.
        (radius * uniform(rng, (0.39, 1.07))).clamp(least_projection, most_projection)
    } else {
        log_uniform(rng, Field::Projection.limits)
    };
    let pocket = match rng.u8(0..5) {
        0 => radius,
        1 => uniform(rng, (radius, most)),
        _ => (radius * uniform(rng, (1.0, 2.0))).min(most),
    };
    // Half of the domes are centred; a third of the others touch the pocket's rim.
    let room = pocket - radius;
    let distance = match rng.u8(0..6) {
        0..3 => 0.0,
        3..5 => room * rng.f64(),
        _ => room,
    };
    let angle = if rng.u8(0..3) == 0 { 0.0 } else { TAU * rng.f64() };
    scene.implant = Implant {
        base_radius_mm: radius,
        projection_mm: projection,
        center_mm: [distance * angle.cos(), distance * angle.sin()],
        ..Implant::default()
    };
    let [x, y] = scene.implant.center_mm;
    scene.pocket_radius_mm = pocket.max(radius + x.hypot(y)).min(most);
}

/// A random insertion: often full, sometimes small.
pub(super) fn insertion(rng: &mut Rng) -> f64 {
    match rng.u8(0..10) {
        0..3 => 1.0,
        3 => 0.0,
        4 => log_uniform(rng, (1e-6, 0.1)),
        _ => rng.f64(),
    }
}

/// One to eight random layers.
pub(super) fn layers(rng: &mut Rng) -> Vec<Layer> {
    let count = match rng.u8(0..10) {
        0..4 => 1,
        4..7 => 2,
        _ => rng.usize(limits::LAYERS.0..=limits::LAYERS.1),
    };
    (0..count).map(|_| layer(rng)).collect()
}

fn layer(rng: &mut Rng) -> Layer {
    Layer {
        tissue: if rng.bool() { "skin" } else { "adipose" }.to_owned(),
        thickness_mm: log_uniform(rng, Field::Thickness.limits),
        poisson_ratio: match rng.u8(0..6) {
            0 => Field::PoissonRatio.limits.0,
            1 => Field::PoissonRatio.limits.1,
            _ => uniform(rng, Field::PoissonRatio.limits),
        },
        curve: curve(rng).into(),
    }
}

fn curve(rng: &mut Rng) -> CurveSpec {
    let modulus = log_uniform(rng, MODULUS_KPA);
    match rng.u8(0..9) {
        0 => CurveSpec::Skin {},
        1 => CurveSpec::Adipose {},
        2 | 3 => CurveSpec::Linear { modulus_kpa: modulus },
        4 => {
            let rate = log_uniform(rng, (0.1, 50.0));
            CurveSpec::Arctangent { scale_kpa: (modulus / rate).max(1e-6), rate }
        }
        5 => {
            let rate = log_uniform(rng, (0.1, 12.0));
            CurveSpec::Exponential { scale_kpa: (modulus / rate).clamp(1e-6, 50.0), rate }
        }
        6 | 7 => points(rng, modulus),
        _ => sections(rng, modulus),
    }
}

/// Marked points whose slopes change by factors of up to a thousand between neighbouring intervals: kinks
/// and plateaus.
fn points(rng: &mut Rng, modulus: f64) -> CurveSpec {
    let count = rng.usize(2..=12);
    let mut points = vec![[0.0, 0.0]];
    let [mut strain, mut stress] = [0.0, 0.0];
    for _ in 1..count {
        let step = log_uniform(rng, (1e-3, 0.3));
        strain += step;
        stress += step * modulus * log_uniform(rng, (0.03, 30.0));
        points.push([strain, stress]);
    }
    let interpolation = if rng.bool() { Interpolation::Line } else { Interpolation::Spline };
    CurveSpec::Points { points, interpolation }
}

/// Consecutive sections of random kinds.
fn sections(rng: &mut Rng, modulus: f64) -> CurveSpec {
    let mut from = 0.0;
    let sections = (0..rng.usize(1..=4))
        .map(|_| {
            let start = from;
            from += uniform(rng, (0.05, 0.4));
            let (from, to) = (start, from);
            let slope = modulus * log_uniform(rng, (0.1, 10.0));
            match rng.u8(0..5) {
                0 => Section::Linear { from, to, modulus_kpa: slope },
                1 => Section::Polynomial { from, to, coefficients_kpa: vec![slope, slope, slope] },
                2 => Section::Arctangent { from, to, scale_kpa: slope / 5.0, rate: 5.0 },
                3 => Section::Sine { from, to, scale_kpa: slope / 2.0, rate: 2.0 },
                _ => Section::Exponential { from, to, scale_kpa: slope / 3.0, rate: 3.0 },
            }
        })
        .collect();
    CurveSpec::Sections { sections }
}

/// A random number of nodes per side: mostly coarse grids (hundreds of solves per second), rarely the finest.
pub(super) fn nodes(rng: &mut Rng) -> usize {
    match rng.u8(0..200) {
        0..160 => rng.usize(17..=65),
        160..190 => rng.usize(66..=129),
        190..198 => rng.usize(130..=257),
        _ => rng.usize(258..=513),
    }
}

pub(super) fn tolerance(rng: &mut Rng) -> f64 {
    match rng.u8(0..4) {
        0 => 1e-3,
        1 => 1e-5,
        _ => 1e-4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_is_valid_and_survives_json() {
        let mut rng = Rng::with_seed(1);
        for _ in 0..5000 {
            let scene = scene(&mut rng);
            assert_eq!(scene.validate(), Ok(()), "{}", scene.to_json());
            assert_eq!(Scene::from_json(&scene.to_json()), Ok(scene));
        }
    }
}

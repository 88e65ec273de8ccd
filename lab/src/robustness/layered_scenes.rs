//! Random scenes of layered tissue, within realistic ranges and within all limits of a scene file.

use super::scenes::{self, log_uniform, uniform};
use fastrand::Rng;
use implant_preview_core::curve::{CurveSpec, Fat};
use implant_preview_core::mesh::Attachment;
use implant_preview_core::scene::{
    Body, CellsThrough, Field, Implant, Layer, Scene, SolverSettings, TissueModel, limits,
};
use std::f64::consts::TAU;

/// Base radius of a realistic implant \[mm\].
const BASE_RADIUS_MM: (f64, f64) = (40.0, 90.0);
/// Projection of a realistic implant \[base radius\].
const PROJECTION: (f64, f64) = (0.39, 1.07);
/// Pocket radius in realistic scenes \[base radius\].
const POCKET: (f64, f64) = (1.0, 1.3);
/// Thickness of realistic skin \[mm\].
const SKIN_MM: (f64, f64) = (1.0, 4.0);
/// Thickness of all solids together in realistic scenes \[mm\].
const SOLIDS_MM: (f64, f64) = (5.0, 40.0);
/// Poisson ratios of realistic scenes \[-\].
const POISSON_RATIO: (f64, f64) = (0.3, 0.495);
/// Insertions of realistic scenes \[-\].
const INSERTION: (f64, f64) = (0.2, 1.0);
/// Modulus of gland \[kPa\].
const GLAND_KPA: (f64, f64) = (2.0, 20.0);

/// A random realistic scene: an implant of a usual size and shape under skin and one to three solids.
pub(super) fn realistic(rng: &mut Rng) -> Scene {
    let mut scene = start();
    realistic_dome(rng, &mut scene);
    scene.insertion = realistic_insertion(rng);
    scene.layers = realistic_layers(rng);
    scene.solver.nodes_per_side = rng.usize(17..=65);
    scene.solver.tolerance = if rng.bool() { 1e-3 } else { 1e-4 };
    scene
}

/// A scene within all limits: needles, flat domes, up to eight layers, any attachment, patch and number of cells.
pub(super) fn extreme(rng: &mut Rng) -> Scene {
    let mut scene = start();
    extreme_dome(rng, &mut scene);
    scene.insertion = scenes::insertion(rng);
    scene.layers = extreme_layers(rng);
    scene.solver.nodes_per_side = scenes::nodes(rng);
    scene.solver.tolerance = scenes::tolerance(rng);
    body(rng, &mut scene);
    scene
}

/// The scene that both populations start from.
fn start() -> Scene {
    Scene {
        solver: SolverSettings {
            nodes_per_side: 33,
            tolerance: 1e-4,
            cells_through: Some(CellsThrough::Auto),
        },
        ..Scene::default()
    }
}

/// Replaces dome and pocket by realistic ones; half of the domes are off centre.
pub(super) fn realistic_dome(rng: &mut Rng, scene: &mut Scene) {
    let radius = uniform(rng, BASE_RADIUS_MM);
    let pocket = radius * uniform(rng, POCKET);
    let distance = if rng.bool() { 0.0 } else { (pocket - radius) * rng.f64() };
    let angle = if rng.u8(0..3) == 0 { 0.0 } else { TAU * rng.f64() };
    scene.implant = Implant {
        base_radius_mm: radius,
        projection_mm: radius * uniform(rng, PROJECTION),
        center_mm: [distance * angle.cos(), distance * angle.sin()],
        ..Implant::default()
    };
    scene.pocket_radius_mm = pocket;
    fit_patch(scene);
}

pub(super) fn realistic_insertion(rng: &mut Rng) -> f64 {
    if rng.u8(0..3) == 0 { 1.0 } else { uniform(rng, INSERTION) }
}

/// Skin over adipose alone, or with gland, muscle or both below.
pub(super) fn realistic_layers(rng: &mut Rng) -> Vec<Layer> {
    let nu = |rng: &mut Rng| uniform(rng, POISSON_RATIO);
    let skin =
        Layer { thickness_mm: uniform(rng, SKIN_MM), poisson_ratio: nu(rng), ..Layer::skin() };
    let mut names = vec!["adipose"];
    match rng.u8(0..6) {
        0..3 => {}
        3 => names.push("gland"),
        4 => names.push("muscle"),
        _ => names.extend(["gland", "muscle"]),
    }
    let shares: Vec<f64> = names.iter().map(|_| uniform(rng, (0.5, 1.5))).collect();
    let per_share = uniform(rng, SOLIDS_MM) / shares.iter().sum::<f64>();
    let solid = |(name, share): (&str, f64), rng: &mut Rng| Layer {
        tissue: name.to_owned(),
        thickness_mm: share * per_share,
        poisson_ratio: nu(rng),
        curve: match name {
            "adipose" if rng.u8(0..4) == 0 => CurveSpec::Adipose {},
            "adipose" => CurveSpec::Fat { variant: Fat::ALL[rng.usize(0..3)] },
            "gland" => CurveSpec::Linear { modulus_kpa: uniform(rng, GLAND_KPA) },
            // That of the case with muscle in `tests/reference/layered.json`.
            _ => CurveSpec::Exponential { scale_kpa: 3.0, rate: 3.0 },
        }
        .into(),
    };
    let mut layers = vec![skin];
    for solid_of in names.into_iter().zip(shares) {
        layers.push(solid(solid_of, rng));
    }
    layers
}

/// Replaces dome and pocket by any, as of a sheet.
pub(super) fn extreme_dome(rng: &mut Rng, scene: &mut Scene) {
    scenes::dome_and_pocket(rng, scene);
    fit_patch(scene);
}

/// One to eight layers of any tissue; a single layer is a skin without solids.
pub(super) fn extreme_layers(rng: &mut Rng) -> Vec<Layer> {
    let mut layers = scenes::layers(rng);
    // Mostly with a solid at least.
    if layers.len() == 1 && rng.u8(0..8) != 0 {
        layers.extend(scenes::layers(rng));
        layers.truncate(limits::LAYERS.1);
    }
    layers
}

/// Replaces patch, attachment and cells by any within their limits.
pub(super) fn body(rng: &mut Rng, scene: &mut Scene) {
    let range = Body::patch_range(scene.pocket_reach_mm());
    let patch_radius_mm = match rng.u8(0..4) {
        0 => range.0,
        1 => range.1,
        _ => uniform(rng, range),
    };
    let attachment = Attachment {
        stiffness_kpa_per_mm: log_uniform(rng, Field::AttachmentStiffness.limits),
        ramp_mm: log_uniform(rng, Field::AttachmentRamp.limits),
    };
    (scene.body.patch_radius_mm, scene.body.attachment) = (patch_radius_mm, attachment);
    let count = rng.usize(1..=8);
    let cells = if rng.bool() { CellsThrough::Auto } else { CellsThrough::Count(count) };
    scene.solver.cells_through = Some(cells);
}

/// Gives the patch the default radius around the pocket.
fn fit_patch(scene: &mut Scene) {
    let default = Body::around(scene.pocket_radius_mm, TissueModel::Layered);
    scene.body.patch_radius_mm = default.patch_radius_mm;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_is_valid_layered_and_survives_json() {
        let mut rng = Rng::with_seed(1);
        for k in 0..2000 {
            let scene = if k % 2 == 0 { realistic(&mut rng) } else { extreme(&mut rng) };
            assert_eq!(scene.validate(), Ok(()), "{}", scene.to_json());
            assert!(scene.is_layered());
            assert_eq!(Scene::from_json(&scene.to_json()), Ok(scene));
        }
    }
}

//! Random chests, with anatomical implants, implants off centre and mounds of thickness.

use super::scenes::{log_uniform, uniform};
use crate::axisymmetric_layers::Mound;
use fastrand::Rng;
use implant_preview_core::scene::{ChestShape, Field, Scene, ThicknessGrid, limits};
use std::f64::consts::TAU;

/// Radius of a patient's chest across \[mm\], and along \[radii across\].
const CHEST_MM: (f64, f64) = (110.0, 250.0);
const ALONG: (f64, f64) = (1.0, 4.0);
/// Height of the base \[width\], and way of the apex \[height of the base\].
const BASE_HEIGHT: (f64, f64) = (0.8, 1.25);
const APEX_SHIFT: (f64, f64) = (0.0, 0.15);
/// Height and width of a mound \[mm\].
const MOUND_MM: (f64, f64) = (0.0, 40.0);
const MOUND_WIDTH_MM: (f64, f64) = (30.0, 60.0);
/// Factors a side of a mound's grid.
const COLUMNS: usize = 25;
/// Solids of less are none \[mm\].
const THINNEST_MM: f64 = 0.1;
/// Greatest factor of the thickness under a mound \[-\].
const MOST_FACTOR: f64 = 20.0;

/// Gives a scene of round implants the chest of a patient; half of the implants are anatomical, off centre or both, half of the patients have a
/// mound.
pub(super) fn patient(rng: &mut Rng, scene: &mut Scene) {
    scene.thickness_field = None;
    let across = uniform(rng, CHEST_MM);
    let along = rng.bool().then(|| across * uniform(rng, ALONG));
    let margin = scene.room_mm();
    let (is_anatomical, is_off_centre) = [(true, false), (false, true), (true, true)]
        .get(rng.usize(0..6))
        .copied()
        .unwrap_or_default();
    if is_anatomical {
        let height = 2.0 * scene.implant.base_radius_mm * uniform(rng, BASE_HEIGHT);
        scene.implant.base_height_mm = Some(height);
        scene.implant.apex_shift_mm = height * uniform(rng, APEX_SHIFT);
        scene.set_pocket_radius(scene.implant.greatest_half_axis_mm() + margin);
    }
    if is_off_centre {
        let (angle, distance) = (TAU * rng.f64(), scene.room_mm() * rng.f64());
        scene.implant.center_mm = [distance * angle.cos(), distance * angle.sin()];
    }
    let least = scene.least_chest_radius_mm(false);
    scene.chest = Some(ChestShape {
        radius_across_mm: across.max(least),
        radius_along_mm: along.map(|along| along.max(least)),
    });
    if rng.bool() {
        scene.thickness_field = Some(mound(rng, scene));
    }
}

/// Gives a scene a chest within all limits, hollow ones included, and half of the scenes an anatomical implant or a mound.
pub(super) fn any(rng: &mut Rng, scene: &mut Scene) {
    scene.thickness_field = None;
    if rng.bool() {
        let least = scene.implant.greatest_half_axis_mm();
        for number in [Field::BaseHeight, Field::ApexShift] {
            number.set(scene, 0, uniform(rng, number.range(scene)));
        }
        let grown = scene.implant.greatest_half_axis_mm() - least;
        scene.set_pocket_radius((scene.pocket_radius_mm + grown).min(limits::POCKET_RADIUS_MAX_MM));
        scene.repair();
    }
    let mut radius = || {
        let is_hollow = rng.u8(0..4) == 0;
        let least = scene.least_chest_radius_mm(is_hollow);
        let radius = log_uniform(rng, (least, limits::CHEST_RADIUS_MM.1));
        if is_hollow { -radius } else { radius }
    };
    let radius_across_mm = radius();
    let along = radius();
    let radius_along_mm = rng.bool().then_some(along);
    scene.chest = Some(ChestShape { radius_across_mm, radius_along_mm });
    if rng.bool() {
        scene.thickness_field = Some(mound(rng, scene));
        // A mound may fill a hollow.
        if scene.validate().is_err() {
            scene.thickness_field = None;
        }
    }
}

/// Gives half of the implants another fullness, drawn last: the scene is otherwise that of the same numbers without one.
pub(super) fn fullness(rng: &mut Rng, scene: &mut Scene) {
    if rng.bool() {
        scene.implant.fullness = Some(uniform(rng, Field::Fullness.limits));
    }
}

/// A smooth mound of thickness under the implant's apex, where the nipple is.
fn mound(rng: &mut Rng, scene: &Scene) -> ThicknessGrid {
    let height_mm = uniform(rng, MOUND_MM);
    let mound = Mound { height_mm, width_mm: uniform(rng, MOUND_WIDTH_MM) };
    let [x, y] = scene.implant.center_mm;
    mound_at(scene, mound, [x, y - scene.implant.apex_shift_mm])
}

/// A mound of thickness about a place on the wall \[mm\].
pub(super) fn mound_at(scene: &Scene, mound: Mound, center: [f64; 2]) -> ThicknessGrid {
    let solids: f64 = scene.layers.iter().skip(1).map(|layer| layer.thickness_mm).sum();
    let mound = Mound { height_mm: mound.height_mm.min((MOST_FACTOR - 1.0) * solids), ..mound };
    let half = (COLUMNS / 2) as f64;
    let spacing_mm = scene.patch_radius() / half;
    let factor = |k: usize| {
        let at = [k % COLUMNS, k / COLUMNS].map(|index| (index as f64 - half) * spacing_mm);
        let distance = (at[0] - center[0]).hypot(at[1] - center[1]);
        let factor = mound.factor(distance, solids.max(THINNEST_MM));
        // Few digits keep the files of a run small.
        (1e4 * factor).round() / 1e4
    };
    let factors = (0..COLUMNS * COLUMNS).map(factor).collect();
    ThicknessGrid { spacing_mm, columns: COLUMNS, rows: COLUMNS, factors }
}

#[cfg(test)]
mod tests {
    use super::super::Population;
    use super::*;

    #[test]
    fn every_scene_over_a_chest_is_valid_and_survives_json() {
        let mut rng = Rng::with_seed(1);
        let (mut hollow, mut mounds, mut filled) = (0, 0, 0);
        for k in 0..1000 {
            let population = Population::of_layered(k, true);
            let mut scene = population.scene(&mut rng);
            filled += usize::from(scene.implant.fullness.is_some());
            for _ in 0..2 {
                assert_eq!(scene.validate(), Ok(()), "{}", scene.to_json());
                assert_eq!(Scene::from_json(&scene.to_json()).as_ref(), Ok(&scene));
                hollow += usize::from(scene.chest.unwrap().radius_across_mm < 0.0);
                mounds += usize::from(scene.thickness_field.is_some());
                // Another chest on the same scene.
                population.put_on_chest(&mut rng, &mut scene);
            }
        }
        assert!(filled.abs_diff(500) < 60, "{filled}");
        assert!(hollow > 150 && mounds > 800, "{hollow} {mounds}");
    }
}

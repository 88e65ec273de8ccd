//! Random walls and tissue as bodies have them: the usual chest with bumps, a mound off centre, round and anatomical implants.

use super::chest::mound_at;
use super::scenes::uniform;
use crate::axisymmetric_layers::Mound;
use fastrand::Rng;
use glam::DVec2;
use implant_preview_core::mesh::{Chest, HeightGrid, ThicknessField};
use implant_preview_core::scene::{ChestGrid, ChestShape, HeightsGrid, Scene};
use std::f64::consts::TAU;

/// Volume of the implant \[ml\].
pub(super) const VOLUME_ML: (f64, f64) = (150.0, 500.0);
/// The most bumps of the wall, and their height and width \[mm\].
const BUMPS: usize = 6;
const BUMP_MM: (f64, f64) = (-8.0, 8.0);
const BUMP_WIDTH_MM: (f64, f64) = (20.0, 60.0);
/// Height and width of a mound, and the greatest way of its centre from the pocket's \[mm\].
const MOUND_MM: (f64, f64) = (0.0, 70.0);
const MOUND_WIDTH_MM: (f64, f64) = (35.0, 60.0);
const MOUND_OFF_MM: f64 = 30.0;
/// Height of the base \[width\], and way of the apex \[height of the base\].
const BASE_HEIGHT: (f64, f64) = (0.85, 1.15);
const APEX_SHIFT: (f64, f64) = (0.0, 0.19);
/// Distance of neighbouring heights \[mm\], and the margin of the grid beyond the patch \[mm\].
const SPACING_MM: f64 = 5.0;
const MARGIN_MM: f64 = 10.0;
/// Draws of a wall before bumps are left out.
const DRAWS: usize = 8;
/// Least radius of a hollow by the second derivatives of the heights, at places of as many rings and directions \[thicknesses of the tissue there\].
const HOLLOW: f64 = 2.0;
const PLACES: [usize; 2] = [8, 48];

/// A bump of the wall.
struct Bump {
    at: DVec2,
    height_mm: f64,
    width_mm: f64,
}

/// Gives a scene of a round implant a body: half of the implants are anatomical.
pub(super) fn patient(rng: &mut Rng, scene: &mut Scene) {
    let margin = scene.room_mm();
    if rng.bool() {
        let height = 2.0 * scene.implant.base_radius_mm * uniform(rng, BASE_HEIGHT);
        scene.implant.base_height_mm = Some(height);
        scene.implant.apex_shift_mm = height * uniform(rng, APEX_SHIFT);
        scene.set_pocket_radius(scene.implant.greatest_half_axis_mm() + margin);
    }
    let mound = Mound { height_mm: uniform(rng, MOUND_MM), width_mm: uniform(rng, MOUND_WIDTH_MM) };
    let off = DVec2::from_angle(TAU * rng.f64()) * (MOUND_OFF_MM * rng.f64());
    scene.thickness_field = Some(mound_at(scene, mound, off.to_array()));
    let most = rng.usize(0..=BUMPS);
    // Bumps within the limits of hollows and slopes.
    for count in (0..=most).rev() {
        for _ in 0..DRAWS {
            let bumps: Vec<Bump> = (0..count).map(|_| bump(rng, scene)).collect();
            scene.chest_grid = Some(wall(scene, &bumps));
            if is_shallow(scene) && scene.validate().is_ok() {
                return;
            }
        }
    }
}

fn bump(rng: &mut Rng, scene: &Scene) -> Bump {
    let distance = scene.patch_radius() * rng.f64().sqrt();
    Bump {
        at: DVec2::from_angle(TAU * rng.f64()) * distance,
        height_mm: uniform(rng, BUMP_MM),
        width_mm: uniform(rng, BUMP_WIDTH_MM),
    }
}

/// Are the wall's hollows as shallow as those of bodies?
fn is_shallow(scene: &Scene) -> bool {
    let (Some(ChestGrid { grid }), Some(field)) = (&scene.chest_grid, &scene.thickness_field)
    else {
        return true;
    };
    let heights = grid.heights_mm.iter().map(|height| height.unwrap_or(0.0)).collect();
    let heights = HeightGrid::new(grid.spacing_mm, [grid.columns, grid.rows], heights);
    let factors = field.factors.to_vec();
    let factors = ThicknessField::new(field.spacing_mm, [field.columns, field.rows], factors);
    let (Some(wall), Some(factors)) = (heights.map(Chest::Grid), factors) else { return false };
    let muscle = scene.layers.last().filter(|_| scene.body.plane.is_some());
    let even = scene.layers[0].thickness_mm + muscle.map_or(0.0, |muscle| muscle.thickness_mm);
    let [rings, directions] = PLACES;
    (0..rings * directions).all(|k| {
        let (ring, way) = ((k / directions + 1) as f64, (k % directions) as f64);
        let way = DVec2::from_angle(TAU * way / directions as f64);
        let place = way * (scene.patch_radius() * ring / rings as f64);
        let [xx, xy, yy] = wall.curvature(wall.foot_and_normal(place).0.truncate());
        let bend = 0.5 * (xx + yy) + (0.5 * (xx - yy)).hypot(xy);
        let tissue = even + (scene.tissue_mm() - even) * factors.factor(place);
        bend * HOLLOW * tissue <= 1.0
    })
}

/// The usual chest with bumps.
fn wall(scene: &Scene, bumps: &[Bump]) -> ChestGrid {
    let half = ((scene.patch_radius() + MARGIN_MM) / SPACING_MM).ceil();
    let columns = 2 * half as usize + 1;
    let across_mm = ChestShape::USUAL.radius_across_mm;
    let usual = Chest::Curved { across_mm, along_mm: f64::INFINITY };
    let height = |k: usize| {
        let at = DVec2::new((k % columns) as f64 - half, (k / columns) as f64 - half) * SPACING_MM;
        let bump = |bump: &Bump| {
            bump.height_mm * (-at.distance_squared(bump.at) / bump.width_mm.powi(2)).exp()
        };
        let height: f64 = usual.height(at) + bumps.iter().map(bump).sum::<f64>();
        Some((1e4 * height).round() / 1e4)
    };
    let heights_mm = (0..columns * columns).map(height).collect();
    let grid =
        HeightsGrid { spacing_mm: SPACING_MM, columns, rows: columns, heights_mm, smooth_mm: 0.0 };
    ChestGrid { grid }
}

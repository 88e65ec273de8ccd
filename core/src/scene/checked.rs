//! A scene within its limits, with its curves built.

use super::{Scene, SceneError, read};
use crate::contact::{Dome, Obstacle};
use crate::mesh::{
    Chest, NaturalStretch, Patch, Rest, Sheet, ThicknessField, rounded_nodes_per_side,
};
use crate::solve::{Problem, Tissue, Void};
use crate::springs::Material;
use glam::DVec2;
use std::sync::Arc;

/// A checked scene, with the curves, the wall and the thickness that the check built.
#[derive(Clone, Debug)]
pub struct CheckedScene {
    scene: Scene,
    materials: Arc<[Material]>,
    wall: Chest,
    thickness: Option<ThicknessField>,
    natural: Option<NaturalStretch>,
}

/// Greatest shift of the implant from the pocket's centre along x or y that is solved as none \[tolerance\]: the error that a solve without
/// the shift adds, where half or a quarter of the nodes are then enough.
const LEAST_SHIFT: f64 = 0.1;

/// What wall and thickness, and their limits, depend on.
fn ground(scene: &Scene) -> impl PartialEq + '_ {
    let Scene { body, pocket_radius_mm, layers, .. } = scene;
    let grids = (&scene.chest, &scene.torso, &scene.chest_grid, &scene.thickness_field);
    (body, pocket_radius_mm, layers, grids)
}

impl CheckedScene {
    /// Checks a scene.
    ///
    /// # Errors
    /// The first field that is out of its range.
    pub fn new(scene: Scene) -> Result<Self, SceneError> {
        Self::like(scene, None)
    }

    /// Checks a scene; curves of an `earlier` scene with the same layers are shared, and wall and thickness of one with the same
    /// grids under the same tissue.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn like(scene: Scene, earlier: Option<&Self>) -> Result<Self, SceneError> {
        scene.check_limits()?;
        let same_ground = earlier.filter(|earlier| ground(&earlier.scene) == ground(&scene));
        let (wall, thickness) = match same_ground {
            Some(earlier) => (earlier.wall.clone(), earlier.thickness.clone()),
            None => {
                let laid = scene.laid()?;
                let thickness = laid.thickness()?;
                let scanned = laid.scanned_wall(thickness.as_ref());
                let scanned = scanned.map_err(|error| scene.named_by_torso(error))?;
                (scanned.unwrap_or_else(|| laid.wall()), thickness)
            }
        };
        if let Some(earlier) = earlier.filter(|earlier| earlier.scene.layers == scene.layers) {
            let materials = Arc::clone(&earlier.materials);
            let natural = scene.body.skin_state.stretch(&materials[0])?;
            return Ok(Self { scene, materials, wall, thickness, natural });
        }
        let material = |(k, layer): (usize, &super::Layer)| {
            layer.material().map_err(|source| SceneError::Curve { layer: k, source })
        };
        let materials =
            scene.layers.iter().enumerate().map(material).collect::<Result<Arc<[_]>, _>>()?;
        let natural = scene.body.skin_state.stretch(&materials[0])?;
        Ok(Self { scene, materials, wall, thickness, natural })
    }

    /// Reads a scene from JSON and checks it.
    ///
    /// # Errors
    /// One line with the field, its value and the allowed range.
    pub fn from_json(json: &str) -> Result<Self, SceneError> {
        Self::from_json_after(json, None)
    }

    /// As [`Self::from_json`]; what the scene has in common with an `earlier` one is shared, not built again.
    ///
    /// # Errors
    /// As [`Self::from_json`].
    pub fn from_json_after(json: &str, earlier: Option<&Self>) -> Result<Self, SceneError> {
        read::checked_scene(json, earlier)
    }

    /// The scene.
    #[must_use]
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// The scene without its curves.
    #[must_use]
    pub fn into_scene(self) -> Scene {
        self.scene
    }

    /// The same scene on a grid with this number of nodes per side, to this tolerance \[base radius\].
    pub(crate) fn on_grid(&self, nodes_per_side: usize, tolerance: f64) -> Self {
        let mut other = self.clone();
        (other.scene.solver.nodes_per_side, other.scene.solver.tolerance) =
            (nodes_per_side, tolerance);
        other
    }

    /// The layers from the skin inwards.
    #[must_use]
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The problem of the scene, for the solver.
    #[must_use]
    pub fn problem(&self) -> Problem {
        let Scene { implant, pocket_radius_mm, insertion, springs, solver, .. } = &self.scene;
        let negligible = LEAST_SHIFT * solver.tolerance * implant.base_radius_mm;
        let shift = |at: f64| if at.abs() <= negligible { 0.0 } else { at };
        let center = DVec2::from(implant.center_mm.map(shift));
        let dome = Dome::new(center, implant.body(self.scene.body.posture), *insertion);
        let body = Some(self.scene.body).filter(|_| self.scene.is_layered());
        let patch = match body {
            None => Patch::clamped_at_pocket(*pocket_radius_mm),
            Some(body) => body.patch(*pocket_radius_mm),
        };
        let nodes_per_side = rounded_nodes_per_side(solver.nodes_per_side);
        let sheet = Sheet::new(nodes_per_side, patch.radius_mm);
        let mut materials = self.materials.to_vec();
        if let (Some(body), Some(skin)) = (body, materials.first_mut()) {
            body.skin_state.relax(skin, self.natural.as_ref());
        }
        let (tissue, rest) = match body {
            None => (Tissue::Sheet, Rest::of_sheet(sheet)),
            Some(body) => {
                let solids = self.materials[1..].iter().rev();
                let solids_mm: Vec<f64> = solids.map(|solid| solid.thickness_mm).collect();
                let cells = solver.cells_through.unwrap_or_default();
                let factors = self.thickness.as_ref().map_or([1.0; 2], |field| {
                    let pocket = patch.pocket();
                    let within = |at: &&DVec2| pocket.beyond(at.length(), at.y) <= 0.0;
                    let in_pocket = sheet.rest().iter().filter(within);
                    let least = in_pocket.map(|place| field.factor(*place));
                    [least.fold(f64::INFINITY, f64::min), field.greatest()]
                });
                let cells = cells.count(&solids_mm, factors, sheet.spacing_mm());
                let mut rest = Rest::layered(sheet, &solids_mm, cells);
                if let Some(field) = &self.thickness {
                    rest = rest.thickened(field.clone());
                }
                let skin_mm = materials.first().map_or(0.0, |skin| skin.thickness_mm);
                let rest = rest
                    .tapered(self.scene.muscle_taper(&self.materials))
                    .weighed(body.posture.change_of_weight(skin_mm));
                (
                    Tissue::Layered,
                    rest.stretched(self.natural)
                        .growing(body.skin_state.growth(self.natural.as_ref())),
                )
            }
        };
        Problem {
            rest: rest.over(self.wall.clone()),
            tissue,
            patch,
            obstacle: Obstacle::on_flat_wall(dome).over(self.wall.clone()),
            materials,
            springs: *springs,
            tolerance: solver.tolerance,
            void: body
                .and_then(|body| body.pocket_void_ml)
                .map(|most_ml| Void { most_mm3: 1000.0 * most_ml, suction_kpa: 0.0 }),
        }
    }
}
